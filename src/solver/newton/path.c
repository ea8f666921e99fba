/* A step along the path of balances of a model whose loads grow in proportion (Riks 1979; Crisfield 1981; mixed
   integration points along a path: Magisano, Leonetti, Garcea 2017). Unknown are the positions x and the load factor f:

       g(x, f) = 0,     a . (x - x_0) = length

   with a direction a in which the path goes on. At a limit point the matrix K = dg/dx is singular, and beyond it has
   negative eigenvalues. K + s a a^T, K with a spring along the path, is regular; it is symmetric, and so minimal
   residuals serve, with a factor of K or, where that is not positive, of K and a multiple of the masses. With L =
   dF/df, the load, each step is

       x_1 = (K + s a a^T)^-1 (s c a - g),   x_2 = (K + s a a^T)^-1 L,   df = (c - a . x_1) / (a . x_2),
       dx = x_1 + df x_2

   where c is what the way lacks. With M = K + s a a^T, y = M^-1 a and M symmetric, the path at a balance has the slope

       df / dc = (1 - s a . y) / (L . y)

   which changes its sign at a limit point. */
#include "base/status.h"
#include "newton/run.h"

#include <math.h>
#include <string.h>

/* of the spring along the path, over the stiffness of the body there when it began */
#define SPRING 10.0
/* systems in one step of a path; products in one system */
enum { STEP_ITERATIONS = 14, MOST_PRODUCTS = 100 };
#define SOLVE_TOLERANCE 1e-9

/* the gradient is linear in the factor */
void pel_newton_find_load(newton_run *run)
{
    pel_newton *newton = run->newton;
    double factor = run->factor;
    run->factor = factor + 1;
    pel_newton_evaluate(run);
    memcpy(newton->load, newton->gradient, (size_t)newton->pattern->unknown_count * sizeof(double));
    run->factor = factor;
    pel_newton_evaluate(run);
    for (int32_t u = 0; u < newton->pattern->unknown_count; u++)
        newton->load[u] = newton->fixed[u] ? 0 : newton->gradient[u] - newton->load[u];
}

bool pel_newton_solve_indefinite(newton_run *run, const double *right, double *solution)
{
    pel_newton *newton = run->newton;
    const pel_pcg_def def = {
        .matrix = newton->matrix,
        .add_product = pel_newton_add_product,
        .added = run,
        .precondition = pel_factor_solve,
        .preconditioner = newton->factors[newton->precision],
        .tolerance = SOLVE_TOLERANCE,
        .iterations = MOST_PRODUCTS,
    };
    pel_pcg_end end = pel_minres_solve(newton->minres, &def, newton->pool, right, solution).end;
    run->status = pel_pool_check(newton->pool, run->error);
    return run->status == PEL_OK && (end == PEL_PCG_CONVERGED || end == PEL_PCG_LIMIT);
}

/* newton->step and the change of the factor for a way of `lacks` along the path */
static bool find_bordered_step(newton_run *run, double lacks, double *change)
{
    pel_newton *newton = run->newton;
    double *right = newton->start_gradient;
    for (int32_t u = 0; u < newton->pattern->unknown_count; u++)
        right[u] = newton->fixed[u] ? 0 : run->path_stiffness * lacks * newton->path[u] - newton->gradient[u];
    if (!pel_newton_solve_indefinite(run, newton->load, newton->answer) ||
        !pel_newton_solve_indefinite(run, right, newton->step))
        return false;
    double slope = pel_newton_dot(newton, newton->path, newton->answer);
    *change = (lacks - pel_newton_dot(newton, newton->path, newton->step)) / slope;
    for (int32_t u = 0; u < newton->pattern->unknown_count; u++)
        newton->step[u] += *change * newton->answer[u];
    return isfinite(*change);
}

static bool find_path_step(newton_run *run, double lacks, double *change)
{
    pel_newton_assemble(run);
    return run->status == PEL_OK && pel_newton_make_preconditioner(run) && find_bordered_step(run, lacks, change);
}

/* a of a direction in x: masses times it, of length 1 in the metric of masses over their sum */
static bool set_direction(newton_run *run, const double *direction)
{
    pel_newton *newton = run->newton;
    double mass = 0, square = 0;
    for (int32_t u = 0; u < newton->pattern->unknown_count; u++) {
        double own = newton->fixed[u] ? 0 : newton->masses[u];
        mass += own / 3;
        square += own * direction[u] * direction[u];
    }
    double scale = 1 / sqrt(square * mass);
    for (int32_t u = 0; u < newton->pattern->unknown_count; u++)
        newton->path[u] = newton->fixed[u] ? 0 : newton->masses[u] * direction[u] * scale;
    return isfinite(scale);
}

/* m, root of the mean square of the displacements of a move in the metric of the masses */
static double length_of(const pel_newton *newton, const double *move)
{
    double mass = 0, square = 0;
    for (int32_t u = 0; u < newton->pattern->unknown_count; u++) {
        double own = newton->fixed[u] ? 0 : newton->masses[u];
        mass += own / 3;
        square += own * move[u] * move[u];
    }
    return sqrt(square / mass);
}

/* The first direction: that of the loads. The spring is as stiff as the body along it. */
static bool begin_path(newton_run *run, pel_newton_path *path)
{
    pel_newton *newton = run->newton;
    pel_newton_find_load(run);
    pel_newton_assemble(run);
    run->path_stiffness = 0;
    if (run->status != PEL_OK || !pel_newton_make_preconditioner(run) ||
        !pel_newton_solve_indefinite(run, newton->load, newton->answer))
        return false;
    double length = length_of(newton, newton->answer);
    if (!(length > 0) || !set_direction(run, newton->answer))
        return false;
    path->stiffness = pel_newton_dot(newton, newton->load, newton->answer) / (length * length);
    path->length = path->first_change * length;
    if (path->most_length > 0 && path->length > path->most_length)
        path->length = path->most_length;
    return path->stiffness > 0 && isfinite(path->length);
}

/* goes the step at hand and adds its part along the path */
static double go_along(newton_run *run, double change)
{
    pel_newton *newton = run->newton;
    double share = pel_newton_find_share(newton);
    double way = share * pel_newton_dot(newton, newton->path, newton->step);
    pel_newton_extrapolate(run, share);
    pel_newton_go(run, share);
    run->factor += share * change;
    return way;
}

/* of the factor over the way, at the balance where the last evaluation was */
static double find_slope(newton_run *run)
{
    pel_newton *newton = run->newton;
    pel_newton_assemble(run);
    /* that of the last step may have been on the other side of a point where the balance becomes unstable */
    if (run->status != PEL_OK || !pel_newton_make_preconditioner(run) ||
        !pel_newton_solve_indefinite(run, newton->path, newton->answer))
        return (double)NAN;
    double lacks = 1 - run->path_stiffness * pel_newton_dot(newton, newton->path, newton->answer);
    return lacks / pel_newton_dot(newton, newton->load, newton->answer);
}

/* true at a balance, a way of `length` along the path */
static bool go_to_balance(newton_run *run, double length)
{
    double left = length, change;
    run->has_stresses = false;
    for (int i = 0; i < STEP_ITERATIONS; i++) {
        run->kind = PEL_TANGENT_EXACT;
        pel_newton_find_load(run);
        if (!pel_newton_is_finite(run))
            return false;
        if (i > 0 && fabs(left) <= 1e-6 * length && pel_newton_has_converged(run))
            return true;
        if (!find_path_step(run, left, &change))
            return false;
        left -= go_along(run, change);
    }
    return false;
}

double pel_newton_path_stiffness(const pel_newton_path *path)
{
    return SPRING * path->stiffness;
}

static void take_direction(newton_run *run, pel_newton_path *path)
{
    const pel_newton *newton = run->newton;
    for (int32_t u = 0; u < newton->pattern->unknown_count; u++)
        path->direction[u] = run->unknowns[u] - newton->begin[u];
}

/* along the axes of the vertices, and on edges nothing: they follow */
static bool take_last_direction(newton_run *run, const pel_newton_path *path)
{
    pel_newton *newton = run->newton;
    memcpy(newton->answer, path->direction, (size_t)newton->pattern->unknown_count * sizeof(double));
    for (int32_t u = 3 * newton->pattern->vertex_count; u < newton->pattern->unknown_count; u++)
        newton->answer[u] = 0;
    pel_newton_frames_turn(&run->problem->frames, newton->answer);
    return set_direction(run, newton->answer);
}

/* minimal residuals need a preconditioner that rounds little */
pel_status pel_newton_make_path_room(pel_newton *newton, pel_error *error)
{
    pel_factor **factor = &newton->factors[PEL_FACTOR_DOUBLE];
    pel_status status = PEL_OK;
    if (*factor == NULL)
        status = pel_factor_create(newton->plan, PEL_FACTOR_DOUBLE, factor, error);
    if (status == PEL_OK && newton->minres == NULL)
        status = pel_minres_create(newton->pattern->unknown_count, &newton->minres, error);
    return status;
}

pel_status pel_newton_follow(pel_newton *newton, const pel_newton_problem *problem, double *unknowns,
                             pel_newton_path *path, pel_newton_result *result, pel_error *error)
{
    newton_run run = pel_newton_run_of(newton, problem, unknowns, result, error);
    size_t bytes = (size_t)newton->pattern->unknown_count * sizeof(double);
    double start = path->factor;
    *result = (pel_newton_result){0};
    run.factor = start;
    pel_newton_fix_unknowns(&run);
    run.status = pel_newton_make_path_room(newton, error);
    if (run.status != PEL_OK)
        return run.status;
    newton->has_factor = false;
    newton->precision = PEL_FACTOR_DOUBLE;
    memcpy(newton->begin, unknowns, bytes);
    bool goes = path->length > 0 ? take_last_direction(&run, path) : begin_path(&run, path);
    run.path_stiffness = pel_newton_path_stiffness(path);
    if (goes)
        result->converged = go_to_balance(&run, path->length);
    if (result->converged)
        path->slope = find_slope(&run);
    path->is_stable = !run.is_shifted;
    result->converged &= run.status == PEL_OK;
    path->iterations = result->iterations;
    if (result->converged) {
        path->factor = run.factor;
        take_direction(&run, path);
    } else {
        memcpy(unknowns, newton->begin, bytes);
    }
    pel_newton_frames_turn_back(&problem->frames, newton->gradient);
    return run.status;
}
