/* A run, by the prepared factor or by systems (newton.c).

   The prepared factor serves many runs: that of a positive matrix at unknowns of an earlier one, as the first guess of
   L-BFGS (quasi.c): a run needs no matrix while that serves. It begins at the unknowns, with fixed ones at their
   targets: velocities of wrinkles foresee nothing, and the inverse has inertia. A prediction x + v dt takes 1.5 to 3
   times the steps there. */
#include "newton/run.h"
#include "base/memory.h"
#include "base/status.h"

#include <math.h>
#include <string.h>

/* factors after the prepared one, before systems take over */
enum { POSITIVE_FACTORS = 5 };
/* what a run by the prepared factor may leave: energy, of the work of fixed vertices; the change of their forces by its
   last step, of these. Measured on a ball and a capsule of the eye that a grasp draws: forces within 0.5 %. */
#define SETTLED_SHARE 5e-3
#define REACTION_SHARE 5e-3
/* share of the diagonal of a prepared factor that rounding in float may remove */
#define PREPARED_SHIFT 1e-7

/* The energy that is left on each body is small next to the work of its fixed vertices in this run: the step that comes
   from the gradient g is nearly -H^-1 g, and that energy g . H^-1 g / 2. Forces on them converge with it, much before
   forces inside of wrinkles do. */
static bool has_settled(const newton_run *run)
{
    const pel_newton *newton = run->newton;
    const pel_model *model = newton->model;
    for (int32_t b = 0; b < model->body_count; b++) {
        double left = 0, work = 0;
        for (int32_t u = 3 * model->bodies[b].slice_begin * PEL_WIDTH; u < 3 * pel_body_place_end(model, b); u++)
            *(newton->fixed[u] ? &work : &left) +=
                newton->gradient[u] * (newton->fixed[u] ? newton->walked[u] : -newton->step[u]);
        if (!(0.5 * left <= SETTLED_SHARE * fabs(work)))
            return false;
    }
    return true;
}

/* N, root of the sum of squares of changes of forces on fixed unknowns */
static double change_of_reactions(const pel_newton *newton, const double *before)
{
    double square = 0;
    for (int32_t u = 0; u < newton->pattern->unknown_count; u++) {
        double change = newton->fixed[u] ? newton->gradient[u] - before[u] : 0;
        square += change * change;
    }
    return sqrt(square);
}

/* L-BFGS with the factor at hand. False where that does not pay. */
static bool go_settling_steps(newton_run *run)
{
    pel_newton *newton = run->newton;
    double *before = newton->left;
    pel_newton_result *result = run->result;
    while (pel_newton_is_finite(run) && !pel_newton_has_converged(run) && !pel_newton_is_late(run) &&
           pel_newton_quasi_pays(run)) {
        pel_newton_find_quasi_step(run);
        bool is_low = has_settled(run);
        memcpy(before, newton->gradient, (size_t)newton->pattern->unknown_count * sizeof *before);
        if (!pel_newton_go_down_quasi_step(run))
            break;
        result->iterations += result->iterations == 0;
        result->converged = is_low && change_of_reactions(newton, before) <= REACTION_SHARE * result->held_force;
        if (result->converged)
            break;
    }
    return result->converged || result->is_late;
}

/* a factor of the positive matrix at the unknowns; false where there is none */
static bool factor_positive(newton_run *run, double shift)
{
    double pivot;
    run->kind = PEL_TANGENT_POSITIVE;
    run->has_stresses = false;
    pel_newton_evaluate(run);
    pel_newton_assemble(run);
    return run->status == PEL_OK && pel_newton_compute_factor(run, shift, &pivot);
}

/* a factor that was made in a run for runs to come */
static void keep_prepared(pel_newton *newton, const double *unknowns)
{
    newton->is_prepared = newton->is_new = true;
    memcpy(newton->prepared_at, unknowns, (size_t)newton->pattern->unknown_count * sizeof *unknowns);
}

bool pel_newton_take_prepared(pel_newton *newton, double *unknowns)
{
    bool is_new = newton->is_prepared && newton->is_new;
    newton->is_new = false;
    if (is_new)
        memcpy(unknowns, newton->prepared_at, (size_t)newton->pattern->unknown_count * sizeof *unknowns);
    return is_new;
}

/* Goes by the prepared factor, and by others of positive matrices where it does not serve. False where systems have to
   go on, from where the run began. */
static bool go_prepared_steps(newton_run *run)
{
    pel_newton *newton = run->newton;
    pel_newton_go_to_targets(run);
    run->kind = PEL_TANGENT_EXACT;
    run->is_prepared = newton->has_factor = true;
    run->quasi_steps = 0;
    pel_newton_carry(run);
    pel_newton_forget_pairs(newton);
    pel_newton_evaluate(run);
    run->result->first_residual = run->result->residual;
    bool is_done = go_settling_steps(run);
    for (int n = 0; n < POSITIVE_FACTORS && !is_done && pel_newton_is_finite(run); n++) {
        run->result->iterations++;
        if (!factor_positive(run, PREPARED_SHIFT) || !pel_newton_meet_volumes(run))
            break;
        keep_prepared(newton, run->unknowns);
        is_done = go_settling_steps(run);
    }
    run->is_prepared = newton->has_factor = newton->is_carried = false;
    return is_done || run->status != PEL_OK;
}

pel_status pel_newton_run(pel_newton *newton, const pel_newton_problem *problem, double *unknowns,
                          pel_newton_result *result, pel_error *error)
{
    newton_run run = pel_newton_run_of(newton, problem, unknowns, result, error);
    size_t bytes = (size_t)newton->pattern->unknown_count * sizeof(double);
    *result = (pel_newton_result){0};
    pel_newton_fix_unknowns(&run);
    memcpy(newton->start, unknowns, bytes);
    memcpy(newton->begin, unknowns, bytes);
    bool goes_prepared = problem->is_prepared && newton->is_prepared,
         is_done = goes_prepared && go_prepared_steps(&run);
    if (goes_prepared && !is_done) {
        pel_newton_return_to_begin(&run);
        *result = (pel_newton_result){0};
    }
    if (!is_done)
        pel_newton_run_systems(&run);
    pel_newton_frames_turn_forces_back(&problem->frames, newton->gradient);
    return run.status;
}

/* ---- a factor alone ---- */

bool pel_newton_approximate(pel_newton *newton, const pel_newton_problem *problem, const double *unknowns, double shift)
{
    pel_newton_result result = {0};
    memcpy(newton->start, unknowns, (size_t)newton->pattern->unknown_count * sizeof *unknowns);
    newton_run run = pel_newton_run_of(newton, problem, newton->start, &result, NULL);
    pel_newton_fix_unknowns(&run);
    return factor_positive(&run, shift);
}

pel_status pel_newton_prepare(pel_newton *newton, const pel_newton_problem *problem, const double *unknowns,
                              pel_error *error)
{
    pel_newton_result result = {0};
    memcpy(newton->start, unknowns, (size_t)newton->pattern->unknown_count * sizeof *unknowns);
    newton_run run = pel_newton_run_of(newton, problem, newton->start, &result, error);
    newton->precision = PEL_FACTOR_FLOAT;
    run.is_prepared = true;
    pel_newton_fix_unknowns(&run);
    newton->is_prepared = factor_positive(&run, PREPARED_SHIFT) && pel_newton_meet_volumes(&run);
    newton->has_factor = newton->is_new = false;
    memcpy(newton->prepared_at, unknowns, (size_t)newton->pattern->unknown_count * sizeof *unknowns);
    return run.status;
}

bool pel_newton_is_prepared(const pel_newton *newton)
{
    return newton->is_prepared;
}

void pel_newton_precondition(pel_newton *newton, double *vector)
{
    size_t vertices = 3 * (size_t)newton->pattern->vertex_count;
    memcpy(newton->right, vector, vertices * sizeof *vector);
    memset(newton->right + vertices, 0, (size_t)newton->pattern->edge_count * sizeof *vector);
    pel_factor_solve(newton->factors[newton->precision], newton->pool, newton->right, newton->step);
    memcpy(vector, newton->step, vertices * sizeof *vector);
}
