/* Runs beside one that has ended. With its matrix K (exact, at its end) and the gradient g of the own problem each
   iteration is

       K dx = -g(x)

   from the unknowns of the lead: where the problems differ by a small h, the first one leaves an error of the order of
   h^2, and each one after it makes that smaller by h. So the differences of two runs on both sides of a lead are
   derivatives of its end, for one factor and a few solutions. Along a path by arc length the load factor f is unknown
   too, and the displacement from the lead has no part along the path (path.c): with L = dF/df

       x_1 = (K + s a a^T)^-1 (-g),   x_2 = (K + s a a^T)^-1 L,   df = -(a . x_1) / (a . x_2),   dx = x_1 + df x_2 */
#include "base/status.h"
#include "newton/run.h"

#include <math.h>
#include <string.h>

enum { MOST_ITERATIONS = 8 };
/* of the first residual: what is solved to; what has to be reached, for rounding ends some runs before */
#define REDUCTION 1e-7
#define NEEDED_REDUCTION 1e-4
/* of the tolerance of the problem: rounding, for numbers that do nothing */
#define SMALL_SHARE 1e-2

static pel_status fail(pel_error *error, const char *what)
{
    return pel_refuse(error, PEL_BAD_ARGUMENT, "take derivatives by differences of whole runs", "%s", what);
}

/* the lead as a run, at its end */
static newton_run run_of_lead(const pel_newton_lead *lead, pel_newton_result *scratch, pel_error *error)
{
    newton_run run = pel_newton_run_of(lead->newton, lead->problem, lead->unknowns, scratch, error);
    run.kind = PEL_TANGENT_EXACT;
    run.path_stiffness = lead->path_stiffness;
    return run;
}

pel_status pel_newton_take_lead(pel_newton_lead *lead, pel_error *error)
{
    pel_newton *newton = lead->newton;
    pel_newton_result scratch = {0};
    lead->path_stiffness = lead->path != NULL ? pel_newton_path_stiffness(lead->path) : 0;
    newton_run run = run_of_lead(lead, &scratch, error);
    pel_newton_fix_unknowns(&run);
    run.status = pel_newton_make_path_room(newton, error);
    if (run.status != PEL_OK)
        return run.status;
    newton->has_factor = false;
    newton->precision = PEL_FACTOR_DOUBLE;
    if (lead->path != NULL)
        pel_newton_find_load(&run);
    else
        pel_newton_evaluate(&run);
    pel_newton_assemble(&run);
    bool made = run.status == PEL_OK && pel_newton_make_preconditioner(&run);
    if (made && lead->path != NULL)
        made = pel_newton_solve_indefinite(&run, newton->load, newton->answer);
    if (run.status != PEL_OK)
        return run.status;
    return made ? PEL_OK : fail(error, "the matrix of the state is singular");
}

/* the step of the lead's matrix for the own gradient */
static bool find_step(newton_run *run, newton_run *lead_run, bool has_path)
{
    pel_newton *newton = run->newton, *lead = lead_run->newton;
    size_t count = (size_t)newton->pattern->unknown_count;
    double change = 0;
    for (size_t u = 0; u < count; u++)
        lead->right[u] = newton->fixed[u] ? 0 : -newton->gradient[u];
    if (!pel_newton_solve_indefinite(lead_run, lead->right, lead->step))
        return false;
    if (has_path)
        change = -pel_newton_dot(lead, lead->path, lead->step) / pel_newton_dot(lead, lead->path, lead->answer);
    for (size_t u = 0; u < count; u++)
        newton->step[u] = newton->fixed[u] ? 0 : lead->step[u] + (has_path ? change * lead->answer[u] : 0);
    run->factor += change;
    return isfinite(change);
}

/* places that are prescribed; edges are as those of the lead */
static void go_to_targets(newton_run *run)
{
    pel_newton *newton = run->newton;
    for (int32_t u = 0; u < newton->pattern->unknown_count; u++)
        newton->step[u] = u < 3 * newton->pattern->vertex_count ? pel_newton_way_to_target(run, u) : 0;
    pel_newton_go(run, 1);
}

pel_status pel_newton_run_beside(pel_newton *newton, const pel_newton_problem *problem, const pel_newton_lead *lead,
                                 double *unknowns, double *load_factor, pel_newton_result *result, pel_error *error)
{
    pel_newton_result scratch = {0};
    newton_run run = pel_newton_run_of(newton, problem, unknowns, result, error);
    newton_run lead_run = run_of_lead(lead, &scratch, error);
    double before = HUGE_VAL;
    *result = (pel_newton_result){0};
    run.kind = PEL_TANGENT_EXACT;
    run.factor = lead->path != NULL ? lead_run.factor : run.factor;
    memcpy(unknowns, lead->unknowns, (size_t)newton->pattern->unknown_count * sizeof(double));
    pel_newton_fix_unknowns(&run);
    go_to_targets(&run);
    for (int i = 0; i <= MOST_ITERATIONS; i++) {
        pel_newton_evaluate(&run);
        run.status = pel_pool_check(newton->pool, error);
        if (run.status != PEL_OK || !pel_newton_is_finite(&run))
            break;
        result->first_residual = i == 0 ? result->residual : result->first_residual;
        bool is_done = result->residual <= REDUCTION * result->first_residual || !(result->residual < 0.5 * before);
        before = result->residual;
        if (is_done || i == MOST_ITERATIONS || !find_step(&run, &lead_run, lead->path != NULL))
            break;
        pel_newton_go(&run, 1);
    }
    if (run.status != PEL_OK || lead_run.status != PEL_OK)
        return run.status != PEL_OK ? run.status : lead_run.status;
    result->converged = result->is_near = result->residual <= NEEDED_REDUCTION * result->first_residual ||
                                          result->residual <= SMALL_SHARE * problem->tolerance;
    if (load_factor != NULL)
        *load_factor = run.factor;
    pel_newton_frames_turn_back(&problem->frames, newton->gradient);
    return result->converged ? PEL_OK : fail(error, "a small change of the parameters leads to a distant state");
}
