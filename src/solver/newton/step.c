/* What the runs of Newton's method are made of: energy, forces and matrix of a problem, its linear systems, steps. */
#include "base/memory.h"
#include "base/status.h"
#include "math/extremes.h"
#include "newton/run.h"

#include <math.h>
#include <string.h>

/* no vertex goes farther than this share of the model's size in one step */
#define LONGEST_SHARE 0.5
/* fixed unknowns this near to their targets, of the size, are there: rounding */
#define SHORT_SHARE 1e-12
/* of conjugate gradients, relative: in statics, and of a step in time, where the next system mends what one leaves
   (Dembo, Eisenstat, Steihaug 1982) */
#define SOLVE_TOLERANCE 1e-8
#define DYNAMIC_SOLVE_TOLERANCE 1e-2
/* Products with a kept factor; more of them cost as much as a new one, which is made as well when the relative residual
   is above KEPT_MIDWAY after half of them. */
enum { KEPT_PRODUCTS = 8 };
#define KEPT_MIDWAY 0.2
/* on the diagonal of a float factor near its limit of condition */
#define FLOAT_SHIFT 1e-7
/* a pivot in float, over its diagonal, that is below minus this is none of rounding */
#define ROUGH_PIVOT 1e-3

/* What the parts of a step cost, in evaluations: measured on 1,280 and 5,120 triangles. A product with its solve is
 * one.
 */
enum { ASSEMBLY_WORK = 2, FACTOR_WORK = 5 };

/* Of the work in a step: energy that constraints may leave. Of what they press: change by the last step; of the forces
   on fixed unknowns: what these may lack. */
#define SETTLED_SHARE 4e-3
#define PRESS_SHARE 0.02
/* of the tolerance, that a step of L-BFGS may leave */
#define QUASI_SHARE 0.1
/* multiples of the masses under the matrix of the preconditioner, of stiffness over mass; their growth */
#define LEAST_SHIFT 1e-9
#define MOST_SHIFT 1e3
#define SHIFT_GROWTH 4.0
/* ---- energy, forces, matrix ---- */

/* loads are constant forces on positions and moments on edges; a moment has no part in the energy */
static double add_loads(const newton_run *run)
{
    const pel_newton *newton = run->newton;
    double sum = 0;
    for (int32_t u = 0; u < newton->pattern->unknown_count; u++) {
        double force = run->problem->force != NULL ? run->factor * run->problem->force[u] : 0;
        if (run->share > 0)
            force += run->share * newton->balance[u];
        newton->gradient[u] -= force;
        if (u < 3 * newton->pattern->vertex_count)
            sum -= force * (run->unknowns[u] - (double)newton->model->rest[u / 3][u % 3]);
    }
    return sum;
}

void pel_newton_frames_turn_rank_ones(const pel_newton_frames *frames, const pel_tangent_pattern *pattern)
{
    for (int32_t r = 0; r < pattern->rank_one_count; r++)
        for (int32_t f = 0; f < frames->count; f++) {
            const pel_rank_one *one = &pattern->rank_ones[r];
            int32_t v = frames->vertices[f] - one->first_vertex;
            if (v < 0 || v >= one->vertex_count)
                continue;
            double *x = one->gradient + 3 * (size_t)v, turned[3];
            for (int k = 0; k < 3; k++)
                turned[k] = pel_vec3_dot(frames->axes[f][k], x);
            pel_vec3_copy(turned, x);
        }
}

/* a moment as the force that it is at the end of an edge */
static double force_of(const pel_newton *newton, int32_t u)
{
    return u < 3 * newton->pattern->vertex_count ? newton->gradient[u] : newton->gradient[u] / newton->edge;
}

static void measure_forces(const newton_run *run)
{
    const pel_newton *newton = run->newton;
    double free = 0, held = 0;
    for (int32_t u = 0; u < newton->pattern->unknown_count; u++) {
        double force = force_of(newton, u);
        *(newton->fixed[u] ? &held : &free) += force * force;
    }
    run->result->residual = sqrt(free);
    run->result->held_force = sqrt(held);
}

static double square_of(const double x[3])
{
    return x[0] * x[0] + x[1] * x[1] + x[2] * x[2];
}

/* Sums of squares of forces on a body: those that are left, and those that act: loads, inertia, supports where the
   tolerance counts them, and with what balances the terms. */
typedef struct body_forces {
    double left, act;
} body_forces;

static void add_forces(const newton_run *run, int32_t v, body_forces *sum)
{
    const pel_newton_problem *problem = run->problem;
    const double *gradient = run->newton->gradient + 3 * (size_t)v;
    double held = problem->held_share > 0 ? 1 : 0;
    double loads[3] = {0, 0, 0};
    for (int k = 0; k < 3; k++) {
        bool is_fixed = run->newton->fixed[3 * v + k];
        *(is_fixed ? &sum->act : &sum->left) += (is_fixed ? held : 1) * gradient[k] * gradient[k];
        double way = problem->points != NULL ? problem->points[v][k] - run->unknowns[3 * v + k] : 0;
        double inertia = problem->points != NULL ? problem->point_stiffness[v] * way : 0;
        loads[k] = problem->force != NULL ? problem->force[3 * v + k] : 0;
        sum->act += inertia * inertia;
    }
    sum->act += square_of(loads) + square_of(run->newton->before_terms + 3 * (size_t)v);
}

/* whether the forces that are left on each body are small next to those that act on it */
static bool rests(const newton_run *run)
{
    const pel_model *model = run->newton->model;
    double share = run->problem->rest_share, rounding = run->problem->rounding;
    for (int32_t b = 0; b < model->body_count; b++) {
        body_forces sum = {0, 0};
        for (int32_t v = model->bodies[b].slice_begin * PEL_WIDTH; v < pel_body_place_end(model, b); v++)
            add_forces(run, v, &sum);
        if (!(sum.left <= pel_max(share * share * sum.act, rounding * rounding)))
            return false;
    }
    return true;
}

static void measure_inertia(const newton_run *run)
{
    const pel_newton_problem *problem = run->problem;
    double square = 0;
    for (int32_t u = 0; problem->points != NULL && u < 3 * run->newton->pattern->vertex_count; u++) {
        double force = problem->point_stiffness[u / 3] * (problem->points[u / 3][u % 3] - run->unknowns[u]);
        square += run->newton->fixed[u] ? 0 : force * force;
    }
    run->result->inertia_force = sqrt(square);
}

static void find_way(const newton_run *run, int32_t v, double way[3])
{
    double from[3];
    pel_vertex_position(run->problem->state->position, v, from);
    pel_vec3_subtract(run->unknowns + 3 * (size_t)v, from, way);
}

/* m, of the masses of a body since the start of the step */
static void find_drift(const newton_run *run, int32_t begin, int32_t end, double drift[3])
{
    double mass = 0, way[3];
    pel_vec3_set(drift, 0, 0, 0);
    for (int32_t v = begin; v < end; v++) {
        find_way(run, v, way);
        pel_vec3_along(drift, run->problem->point_stiffness[v], way, drift);
        mass += run->problem->point_stiffness[v];
    }
    pel_vec3_scale(drift, mass > 0 ? 1 / mass : 0, drift);
}

/* Under constraints: the work of what acts on a body since the start of the step, beside its drift, so that it is the
   same in every frame that moves uniformly; how much constraints press; and whether the forces on fixed unknowns lack
   what is left on the others, since both add up to loads, inertia and constraints. The gradient is along x, y, z, with
   that before the terms in newton->before_terms. */
static void measure_work(newton_run *run, int32_t begin, int32_t end)
{
    const pel_newton *newton = run->newton;
    const pel_newton_problem *problem = run->problem;
    double drift[3], left[3] = {0}, held = 0, work = 0;
    find_drift(run, begin, end, drift);
    for (int32_t v = begin; v < end; v++) {
        const double *gradient = newton->gradient + 3 * (size_t)v, *before = newton->before_terms + 3 * (size_t)v;
        double push[3], way[3], inertia[3];
        find_way(run, v, way);
        pel_vec3_subtract(way, drift, way);
        pel_vec3_subtract(gradient, before, push);
        pel_vec3_subtract(run->unknowns + 3 * (size_t)v, problem->points[v], inertia);
        run->press += pel_vec3_length(push);
        run->work += fabs(pel_vec3_dot(push, way)) + fabs(problem->point_stiffness[v] * pel_vec3_dot(inertia, way));
        for (int k = 0; k < 3; k++) {
            bool is_fixed = newton->fixed[3 * v + k];
            left[k] += is_fixed ? 0 : gradient[k];
            held += is_fixed ? fabs(gradient[k]) : 0;
            work += is_fixed ? gradient[k] * way[k] : 0;
        }
    }
    run->work += fabs(work);
    run->lacks |= held > 0 && pel_vec3_length(left) > PRESS_SHARE * held;
}

static void measure_works(newton_run *run)
{
    const pel_model *model = run->newton->model;
    run->work = run->press = 0;
    run->lacks = false;
    for (int32_t b = 0; b < model->body_count; b++)
        measure_work(run, model->bodies[b].slice_begin * PEL_WIDTH, pel_body_place_end(model, b));
}

/* energy at the unknowns, and gradient along the axes of the vertices; nothing once the pool is stopped, where line
   searches would evaluate on */
void pel_newton_evaluate(newton_run *run)
{
    pel_newton *newton = run->newton;
    const pel_newton_problem *problem = run->problem;
    if (pel_pool_is_stopped(newton->pool)) {
        run->status = pel_pool_check(newton->pool, run->error);
        return;
    }
    pel_newton_rigids_follow(run);
    const pel_tangent_input input = {
        .unknowns = run->unknowns,
        .span = problem->span,
        .state = problem->state,
        .kind = run->kind,
        .stresses = run->has_stresses ? newton->stresses : NULL,
        .point_stiffness = problem->point_stiffness,
        .points = problem->points,
        .load_factor = &run->factor,
        .viscous = problem->viscous,
        .rate = problem->rate,
    };
    pel_tangent_energy energy = pel_tangent_evaluate(newton->tangent, &input, newton->pool, newton->gradient);
    double loads = add_loads(run), terms = 0, bodies;
    bool asks = problem->rest_share > 0 && run->result->iterations == 0;
    bool may_settle = problem->settles && problem->terms != NULL && problem->terms->has_kinks;
    if (asks || may_settle)
        memcpy(newton->before_terms, newton->gradient, 3 * (size_t)newton->pattern->vertex_count * sizeof(double));
    newton->work++;
    if (problem->terms != NULL)
        terms = problem->terms->evaluate(problem->terms->context, run->unknowns, newton->gradient);
    if (may_settle)
        measure_works(run);
    bodies = pel_newton_rigids_measure(run);
    run->parts = fabs(energy.membrane) + fabs(energy.volume) + fabs(energy.fibres) + fabs(energy.bending) +
                 fabs(energy.edges) + fabs(energy.springs) + fabs(energy.points) + fabs(energy.pressure) + fabs(loads) +
                 fabs(terms) + fabs(bodies);
    run->result->energy = pel_tangent_energy_sum(&energy) + loads + terms + bodies;
    pel_newton_frames_turn(&problem->frames, newton->gradient);
    pel_newton_rigids_add_torques(run);
    pel_newton_frames_turn_rank_ones(&problem->frames, newton->pattern);
    measure_forces(run);
    measure_inertia(run);
    run->rests = asks && rests(run);
}

bool pel_newton_is_finite(const newton_run *run)
{
    return isfinite(run->result->energy) && isfinite(run->result->residual) && isfinite(run->result->held_force);
}

/* of a position, along the axes of its vertex */
static double coordinate(const newton_run *run, int32_t u)
{
    int32_t frame = run->newton->frame[u / 3];
    if (frame < 0)
        return run->unknowns[u];
    return pel_vec3_dot(run->problem->frames.axes[frame][u % 3], run->unknowns + 3 * (size_t)(u / 3));
}

/* what fixed unknowns have before them */
double pel_newton_way_to_target(const newton_run *run, int32_t u)
{
    const pel_newton *newton = run->newton;
    bool is_position = u < 3 * newton->pattern->vertex_count;
    if (run->problem->fixed == NULL || !run->problem->fixed[u] || run->problem->fixed[u] == PEL_NEWTON_OWNED)
        return 0;
    double left = run->share > 0 ? run->share * newton->way[u] : 0;
    return run->problem->target[u] - left - (is_position ? coordinate(run, u) : newton->walked[u]);
}

/* ---- linear systems ---- */

void pel_newton_add_product(void *context, pel_pool *pool, const double *x, double *y)
{
    const newton_run *run = context;
    const pel_newton *newton = run->newton;
    (void)pool;
    pel_tangent_add_rank_ones(newton->pattern, newton->fixed, x, y);
    if (!(run->path_stiffness > 0))
        return;
    double along = run->path_stiffness * pel_newton_dot(newton, newton->path, x);
    for (int32_t u = 0; u < newton->pattern->unknown_count; u++)
        y[u] += along * newton->path[u];
}

/* what the ways of fixed unknowns do through these */
static void shift_rank_ones(const newton_run *run)
{
    pel_newton *newton = run->newton;
    for (int32_t r = 0; r < newton->pattern->rank_one_count; r++) {
        const pel_rank_one *one = &newton->pattern->rank_ones[r];
        const int32_t begin = 3 * one->first_vertex, count = 3 * one->vertex_count;
        double product = 0;
        for (int32_t i = 0; i < count; i++)
            product += newton->fixed[begin + i] ? one->gradient[i] * newton->step[begin + i] : 0;
        for (int32_t i = 0; i < count; i++)
            newton->right[begin + i] -= newton->fixed[begin + i] ? 0 : one->coefficient * product * one->gradient[i];
    }
}

static bool has_volume_terms(const pel_newton *newton)
{
    for (int32_t r = 0; r < newton->pattern->rank_one_count; r++)
        if (newton->pattern->rank_ones[r].coefficient > 0)
            return true;
    return false;
}

/* the stresses that the last step predicts: none are needed where it was the last one of the run */
static void fill_stresses(newton_run *run)
{
    pel_newton *newton = run->newton;
    const pel_tangent_input input = {
        .unknowns = newton->start,
        .span = run->problem->span,
        .state = run->problem->state,
        .viscous = run->problem->viscous,
        .rate = run->problem->rate,
    };
    if (run->has_stresses && run->predicted > 0)
        pel_tangent_extrapolate(newton->tangent, &input, pel_newton_find_move(run, run->predicted), newton->pool,
                                newton->stresses);
    run->predicted = 0;
}

bool pel_newton_has_kinks(const newton_run *run)
{
    const pel_newton_terms *terms = run->problem->terms;
    return terms != NULL && terms->list_kinks != NULL;
}

static size_t value_bytes(const pel_newton *newton)
{
    return (size_t)newton->matrix->block_start[newton->matrix->block_count] * sizeof(double);
}

static void keep_plain(newton_run *run)
{
    pel_newton *newton = run->newton;
    if (!pel_newton_has_kinks(run))
        return;
    if (!pel_reserve((void **)&newton->plain, &newton->plain_capacity, value_bytes(newton), 1)) {
        run->status = pel_fail_memory(run->error);
        return;
    }
    memcpy(newton->plain, newton->matrix->values, value_bytes(newton));
    newton->has_plain = true;
}

static bool take_plain(newton_run *run)
{
    pel_newton *newton = run->newton;
    if (!run->reuses || !newton->has_plain)
        return false;
    memcpy(newton->matrix->values, newton->plain, value_bytes(newton));
    return true;
}

void pel_newton_add_terms(const pel_newton_terms *terms, bool has_kinks, pel_matrix *matrix)
{
    if (terms == NULL)
        return;
    terms->add_matrix(terms->context, matrix);
    if (has_kinks && terms->add_kinks != NULL)
        terms->add_kinks(terms->context, matrix);
}

/* The matrix of the last evaluation, with fixed unknowns taken out, and the right side. */
void pel_newton_assemble(newton_run *run)
{
    pel_newton *newton = run->newton;
    run->status = pel_pool_check(newton->pool, run->error);
    if (run->status == PEL_OK)
        run->status = pel_newton_couple(run);
    if (run->status != PEL_OK)
        return;
    if (!take_plain(run)) {
        fill_stresses(run);
        newton->work += ASSEMBLY_WORK;
        pel_matrix_assemble(newton->matrix, newton->pool, pel_tangent_matrices, newton->tangent);
        keep_plain(run);
    }
    if (run->status != PEL_OK)
        return;
    pel_newton_add_terms(run->problem->terms, !run->is_prepared, newton->matrix);
    if (run->shift > 0)
        pel_matrix_add_diagonal(newton->matrix, run->shift, newton->masses);
    pel_newton_rigids_reduce(run);
    if (run->problem->frames.count > 0)
        pel_matrix_turn(newton->matrix, newton->pool, newton->frame, run->problem->frames.axes);
    for (int32_t u = 0; u < newton->pattern->unknown_count; u++) {
        newton->step[u] = newton->fixed[u] ? pel_newton_way_to_target(run, u) : 0;
        newton->right[u] = newton->fixed[u] ? 0 : -newton->gradient[u];
    }
    shift_rank_ones(run);
    pel_matrix_fix(newton->matrix, newton->pool, newton->fixed, newton->step, newton->right);
}

void pel_newton_take_factor(newton_run *run, pel_factor_precision precision)
{
    pel_newton *newton = run->newton;
    newton->precision = precision;
    newton->has_factor = true;
    newton->is_prepared = newton->is_carried = false;
    run->quasi_steps = 0;
    pel_newton_forget_pairs(newton);
}

bool pel_newton_compute_factor(newton_run *run, double shift, double *pivot)
{
    pel_newton *newton = run->newton;
    pel_factor_result made =
        pel_factor_compute(newton->factors[newton->precision], newton->matrix, shift, newton->pool);
    run->status = pel_pool_check(newton->pool, run->error);
    newton->work += FACTOR_WORK;
    newton->is_proven = false;
    pel_newton_take_factor(run, newton->precision);
    newton->has_factor = made.positive_definite;
    *pivot = made.pivot;
    return made.positive_definite;
}

/* in float, with a little on the diagonal, then in double from now on; false where the matrix is not positive */
bool pel_newton_make_factor(newton_run *run)
{
    pel_newton *newton = run->newton;
    double pivot;
    if (pel_newton_compute_factor(run, 0, &pivot))
        return true;
    if (run->status != PEL_OK || newton->precision == PEL_FACTOR_DOUBLE || pivot < -ROUGH_PIVOT)
        return false;
    if (pel_newton_compute_factor(run, FLOAT_SHIFT, &pivot))
        return true;
    if (run->status != PEL_OK || pivot < -ROUGH_PIVOT || (run->problem->is_in_motion && run->kind == PEL_TANGENT_EXACT))
        return false;
    pel_factor **factor = &newton->factors[PEL_FACTOR_DOUBLE];
    if (*factor == NULL)
        run->status = pel_factor_create(newton->plan, PEL_FACTOR_DOUBLE, factor, run->error);
    if (run->status != PEL_OK)
        return false;
    newton->precision = PEL_FACTOR_DOUBLE;
    return pel_newton_compute_factor(run, 0, &pivot);
}

bool pel_newton_make_preconditioner(newton_run *run)
{
    pel_newton *newton = run->newton;
    double scale = pel_newton_stiffness_scale(newton), shift = 0;
    bool made = pel_newton_make_factor(run);
    for (double next = LEAST_SHIFT * scale; !made && run->status == PEL_OK && next < MOST_SHIFT * scale;
         next *= SHIFT_GROWTH) {
        pel_matrix_add_diagonal(newton->matrix, next - shift, newton->masses);
        shift = next;
        made = pel_newton_make_factor(run);
    }
    if (shift > 0)
        pel_matrix_add_diagonal(newton->matrix, -shift, newton->masses);
    run->is_shifted = shift > 0;
    return made;
}

/* what is solved for the skew part goes on from step to step, and so do its errors */
static double solve_tolerance(const newton_run *run)
{
    return run->problem->is_dynamic && !pel_newton_has_skew(run) ? DYNAMIC_SOLVE_TOLERANCE : SOLVE_TOLERANCE;
}

pel_pcg_end pel_newton_solve(newton_run *run, int32_t products)
{
    pel_newton *newton = run->newton;
    const pel_pcg_def def = {
        .matrix = newton->matrix,
        .add_product = has_volume_terms(newton) ? pel_newton_add_product : NULL,
        .added = run,
        .precondition = pel_factor_solve,
        .preconditioner = newton->factors[newton->precision],
        .tolerance = solve_tolerance(run),
        .iterations = products,
        .midway = products == KEPT_PRODUCTS ? KEPT_MIDWAY : 0,
    };
    pel_pcg_result solved = pel_pcg_solve(newton->pcg, &def, newton->pool, newton->right, newton->step);
    run->status = pel_pool_check(newton->pool, run->error);
    newton->work += solved.iterations;
    return solved.end;
}

/* newton->step of newton->right by the matrix alone; across constraints that begin and cease to act an older factor is
   seldom of use */
bool pel_newton_solve_symmetric(newton_run *run)
{
    bool keeps = run->problem->keeps_factor && (!pel_newton_has_kinks(run) || run->newton->is_smooth);
    run->newton->is_kept =
        keeps && run->newton->has_factor && pel_newton_solve(run, KEPT_PRODUCTS) == PEL_PCG_CONVERGED;
    if (run->newton->is_kept)
        return true;
    if (!pel_newton_make_factor(run) || (run->problem->is_quasi && !pel_newton_meet_volumes(run)))
        return false;
    pel_pcg_end end = pel_newton_solve(run, PEL_NEWTON_PRODUCTS);
    return run->status == PEL_OK && (end == PEL_PCG_CONVERGED || end == PEL_PCG_LIMIT);
}

/* fixed unknowns go all of their way, whatever the solve leaves */
static void set_fixed_steps(newton_run *run)
{
    pel_newton *newton = run->newton;
    for (int32_t u = 0; u < newton->pattern->unknown_count; u++)
        if (newton->fixed[u])
            newton->step[u] = pel_newton_way_to_target(run, u);
}

/* The step of the matrix; false where that is not positive definite. */
bool pel_newton_find_step(newton_run *run)
{
    pel_newton_assemble(run);
    if (run->status != PEL_OK || !pel_newton_solve_symmetric(run))
        return false;
    run->newton->is_smooth = run->kind == PEL_TANGENT_EXACT;
    if (pel_newton_has_kinks(run) && pel_newton_is_at_targets(run) && !pel_newton_cross_kinks(run))
        return false;
    set_fixed_steps(run);
    return !pel_newton_has_skew(run) || pel_newton_solve_skew(run);
}

double pel_newton_dot(const pel_newton *newton, const double *a, const double *b)
{
    double sum = 0;
    for (int32_t u = 0; u < newton->pattern->unknown_count; u++)
        sum += a[u] * b[u];
    return sum;
}

/* ---- steps ---- */

double pel_newton_longest_move(const pel_newton *newton)
{
    double longest = 0;
    for (int32_t v = 0; v < newton->pattern->vertex_count; v++)
        longest = pel_max(longest, pel_vec3_length(newton->step + 3 * (size_t)v));
    return longest;
}

/* the step along x, y, z, times a scale */
const double *pel_newton_find_move(const newton_run *run, double scale)
{
    pel_newton *newton = run->newton;
    for (int32_t u = 0; u < newton->pattern->unknown_count; u++)
        newton->move[u] = scale * newton->step[u];
    pel_newton_frames_turn_back(&run->problem->frames, newton->move);
    return newton->move;
}

/* of the step, as far as it is good for */
double pel_newton_find_share(const pel_newton *newton)
{
    double longest = pel_newton_longest_move(newton), limit = LONGEST_SHARE * newton->size;
    return longest > limit ? limit / longest : 1;
}

/* goes a share of the step */
void pel_newton_go(newton_run *run, double scale)
{
    pel_newton *newton = run->newton;
    pel_tangent_advance(newton->tangent, run->unknowns, pel_newton_find_move(run, 1), scale, newton->pool);
    for (int32_t u = 0; u < newton->pattern->unknown_count; u++)
        newton->walked[u] += scale * newton->step[u];
    run->result->iterations++;
}

void pel_newton_extrapolate(newton_run *run, double scale)
{
    const pel_newton *newton = run->newton;
    memcpy(newton->start, run->unknowns, (size_t)newton->pattern->unknown_count * sizeof *newton->start);
    run->predicted = scale;
    run->has_stresses = true;
}

bool pel_newton_is_at_targets(const newton_run *run)
{
    for (int32_t u = 0; u < run->newton->pattern->unknown_count; u++)
        if (run->newton->fixed[u] && fabs(pel_newton_way_to_target(run, u)) > SHORT_SHARE * run->newton->size)
            return false;
    return true;
}

bool pel_newton_has_converged(newton_run *run)
{
    const pel_newton_problem *problem = run->problem;
    pel_newton_result *result = run->result;
    if (!pel_newton_is_at_targets(run))
        return false;
    if (problem->rest_share > 0 && result->iterations == 0 && !run->rests)
        return false;
    double held = problem->held_share * result->held_force, inertia = problem->inertia_share * result->inertia_force;
    bool reduced = result->residual <= problem->reduction * result->first_residual;
    /* a step of Newton's method leaves far less than it is asked for, one of L-BFGS just that */
    double share = run->quasi_steps > 0 && run->quasi_steps < INT32_MAX ? QUASI_SHARE : 1;
    result->converged =
        result->residual <= share * sqrt(problem->tolerance * problem->tolerance + held * held + inertia * inertia) ||
        (reduced && result->residual <= problem->enough) || result->residual <= run->loose;
    return result->converged;
}

bool pel_newton_has_settled(const newton_run *run, double slope, double press)
{
    return run->problem->settles > 0 && run->result->iterations >= run->problem->settles && run->press > 0 &&
           -0.5 * slope <= SETTLED_SHARE * run->work && fabs(run->press - press) <= PRESS_SHARE * run->press &&
           !run->lacks;
}

void pel_newton_fix_unknowns(newton_run *run)
{
    pel_newton *newton = run->newton;
    bool changed = false;
    for (int32_t u = 0; u < newton->pattern->unknown_count; u++) {
        bool is_vertex = u < 3 * newton->pattern->vertex_count;
        bool rests = is_vertex && !(newton->model->inverse_mass[u / 3] > 0);
        uint8_t fixed = rests || (run->problem->fixed != NULL && run->problem->fixed[u]);
        changed |= fixed != newton->fixed[u];
        newton->fixed[u] = fixed;
        newton->walked[u] = 0;
    }
    if (changed)
        newton->has_factor = newton->is_prepared = false;
    for (int32_t n = 0; n < newton->pattern->vertex_count + newton->pattern->edge_count; n++)
        newton->frame[n] = -1;
    for (int32_t f = 0; f < run->problem->frames.count; f++)
        newton->frame[run->problem->frames.vertices[f]] = f;
}

/* stiffness over mass, a bound of what the shift has to do with */
double pel_newton_stiffness_scale(const pel_newton *newton)
{
    double stiffness = 0, mass = 0;
    for (int32_t v = 0; v < newton->pattern->vertex_count; v++) {
        int32_t block = pel_matrix_block(newton->matrix, v, v);
        const double *diagonal = newton->matrix->values + newton->matrix->block_start[block];
        double own_stiffness = 0, own_mass = 0;
        for (int k = 0; k < 3; k++) {
            own_stiffness += newton->fixed[3 * v + k] ? 0 : diagonal[4 * k];
            own_mass += newton->fixed[3 * v + k] ? 0 : newton->masses[3 * v + k];
        }
        stiffness += own_stiffness;
        mass += own_mass;
    }
    return mass > 0 ? stiffness / mass : 0;
}
