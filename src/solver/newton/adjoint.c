/* Adjoint solutions: with the balance g(x, p) = 0 and K = dg/dx, a function f(x) of the state changes with a number p
   by df/dp = -m . dg/dp, where K m = df/dx. */
#include "base/memory.h"
#include "base/status.h"
#include "newton/run.h"

#include <string.h>

/* relative; of conjugate gradients with a factor in double */
#define SOLVE_TOLERANCE 1e-14
enum { MOST_PRODUCTS = 30 };

static pel_status fail_unstable(pel_error *error)
{
    return pel_refuse(error, PEL_BAD_ARGUMENT, "make the loads smaller, or support the bodies that can move freely",
                      "the state is not a stable equilibrium: its derivatives do not exist");
}

static pel_status solve_adjoint(newton_run *run, double *multipliers)
{
    pel_newton *newton = run->newton;
    pel_factor **factor = &newton->factors[PEL_FACTOR_DOUBLE];
    if (*factor == NULL)
        run->status = pel_factor_create(newton->plan, PEL_FACTOR_DOUBLE, factor, run->error);
    if (run->status != PEL_OK)
        return run->status;
    newton->has_factor = false;
    if (!pel_factor_compute(*factor, newton->matrix, 0, newton->pool).positive_definite)
        return fail_unstable(run->error);
    const pel_pcg_def def = {
        .matrix = newton->matrix,
        .add_product = pel_newton_add_product,
        .added = run,
        .precondition = pel_factor_solve,
        .preconditioner = *factor,
        .tolerance = SOLVE_TOLERANCE,
        .iterations = MOST_PRODUCTS,
    };
    pel_pcg_end end = pel_pcg_solve(newton->pcg, &def, newton->pool, newton->right, multipliers).end;
    return end == PEL_PCG_CONVERGED || end == PEL_PCG_LIMIT ? PEL_OK : fail_unstable(run->error);
}

/* df/dx - K m where unknowns are fixed: how f follows what holds them */
static void find_held(newton_run *run, const double *gradient, const double *multipliers, double *held)
{
    pel_newton *newton = run->newton;
    size_t count = (size_t)newton->pattern->unknown_count;
    pel_matrix_assemble(newton->matrix, newton->pool, pel_tangent_matrices, newton->tangent);
    pel_newton_add_terms(run->problem->terms, true, newton->matrix);
    pel_matrix_turn(newton->matrix, newton->pool, newton->frame, run->problem->frames.axes);
    pel_matrix_multiply(newton->matrix, newton->pool, multipliers, newton->right);
    memset(newton->step, 0, count);
    pel_tangent_add_rank_ones(newton->pattern, (const uint8_t *)newton->step, multipliers, newton->right);
    for (size_t u = 0; u < count; u++)
        held[u] = newton->fixed[u] ? gradient[u] - newton->right[u] : 0;
}

pel_status pel_newton_adjoint(pel_newton *newton, const pel_newton_problem *problem, double *unknowns, double *gradient,
                              double *multipliers, double *held, pel_error *error)
{
    pel_newton_result result = {0};
    newton_run run = pel_newton_run_of(newton, problem, unknowns, &result, error);
    run.kind = PEL_TANGENT_EXACT;
    pel_newton_fix_unknowns(&run);
    pel_newton_evaluate(&run);
    pel_newton_assemble(&run);
    if (run.status != PEL_OK)
        return run.status;
    pel_newton_frames_turn(&problem->frames, gradient);
    for (int32_t u = 0; u < newton->pattern->unknown_count; u++)
        newton->right[u] = newton->fixed[u] ? 0 : gradient[u];
    pel_status status = solve_adjoint(&run, multipliers);
    if (status != PEL_OK)
        return status;
    find_held(&run, gradient, multipliers, held);
    pel_newton_frames_turn_back(&problem->frames, multipliers);
    pel_newton_frames_turn_back(&problem->frames, held);
    return PEL_OK;
}
