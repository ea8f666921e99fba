/* Steps of L-BFGS with a kept factor as its first guess of the inverse Hessian. A step needs no matrix: it costs an
   evaluation and a solve, about a quarter of a step of Newton's method. It carries on while the residual falls fast
   enough for that price; where it does not, a matrix at the present state takes over.

   The factor lacks the first terms of volumes, c g g^T. With z = H^-1 g, by the formula of Sherman and Morrison, the
   inverse of H + c g g^T is that of H minus z z^T c / (1 + c g . z). */
#include "base/memory.h"
#include "base/status.h"
#include "newton/run.h"

#include <string.h>

/* Steps with one factor; mean reduction of the residual by each of them, after the first ones, above which a new factor
   is cheaper. */
enum { MOST_STEPS = 12, FIRST_STEPS = 3 };
#define RATE 0.7
/* The same of a factor that was prepared: another one costs a matrix as well, and several of them where the exact
   tangent is indefinite. */
enum { MOST_PREPARED_STEPS = 30, FIRST_PREPARED_STEPS = 6 };
#define PREPARED_RATE 0.85
/* of another factor, in evaluations: one, an assembly and the factor */
enum { FACTOR_PRICE = 8 };

void pel_newton_forget_pairs(pel_newton *newton)
{
    pel_pairs_forget(&newton->pairs);
    newton->has_before = false;
}

/* what volumes add to the factor that was just made */
bool pel_newton_meet_volumes(newton_run *run)
{
    pel_newton *newton = run->newton;
    const pel_tangent_pattern *pattern = newton->pattern;
    size_t size = (size_t)pattern->unknown_count;
    newton->volume_count = 0;
    for (int32_t r = 0; r < pattern->rank_one_count && newton->volume_count < PEL_NEWTON_VOLUMES; r++) {
        const pel_rank_one *one = &pattern->rank_ones[r];
        if (!(one->coefficient > 0))
            continue;
        if (!pel_reserve((void **)&newton->volumes, &newton->volume_capacity, (size_t)(newton->volume_count + 1) * size,
                         sizeof *newton->volumes)) {
            run->status = pel_fail_memory(run->error);
            return false;
        }
        double *z = newton->volumes + (size_t)newton->volume_count * size;
        memset(z, 0, size * sizeof *z);
        for (int32_t i = 0; i < 3 * one->vertex_count; i++)
            z[3 * one->first_vertex + i] = newton->fixed[3 * one->first_vertex + i] ? 0 : one->gradient[i];
        memcpy(newton->before_gradient, z, size * sizeof *z);
        pel_factor_solve(newton->factors[newton->precision], newton->pool, z, z);
        double product = pel_pairs_dot(size, newton->before_gradient, z);
        newton->volume_weights[newton->volume_count++] = one->coefficient / (1 + one->coefficient * product);
    }
    return true;
}

static void precondition(pel_newton *newton, double *d)
{
    double *solved = newton->move;
    size_t size = (size_t)newton->pattern->unknown_count;
    pel_newton_carry_back(newton, d);
    pel_factor_solve(newton->factors[newton->precision], newton->pool, d, solved);
    for (int32_t r = 0; r < newton->volume_count; r++) {
        const double *z = newton->volumes + (size_t)r * size;
        double share = newton->volume_weights[r] * pel_pairs_dot(size, z, d);
        for (size_t u = 0; u < size; u++)
            solved[u] -= share * z[u];
    }
    pel_newton_carry_on(newton, solved);
    memcpy(d, solved, size * sizeof *d);
}

/* Whether the steps since the factor was made have been worth their price. */
bool pel_newton_quasi_pays(const newton_run *run)
{
    const pel_newton *newton = run->newton;
    int32_t most = run->is_prepared ? MOST_PREPARED_STEPS : MOST_STEPS;
    int32_t first = run->is_prepared ? FIRST_PREPARED_STEPS : FIRST_STEPS;
    if (!newton->has_factor || run->quasi_steps >= most)
        return false;
    return run->quasi_steps < first || run->result->residual <= run->quasi_goal;
}

/* newton->step, from the gradient of the last evaluation */
void pel_newton_find_quasi_step(newton_run *run)
{
    pel_newton *newton = run->newton;
    size_t size = (size_t)newton->pattern->unknown_count;
    double *d = newton->step;
    for (size_t u = 0; u < size; u++)
        newton->right[u] = newton->fixed[u] ? 0 : newton->gradient[u];
    if (newton->has_before)
        pel_pairs_keep(&newton->pairs, size, (const double *const[]){newton->before_walked, newton->walked},
                       (const double *const[]){newton->before_gradient, newton->right});
    memcpy(newton->before_walked, newton->walked, size * sizeof *d);
    memcpy(newton->before_gradient, newton->right, size * sizeof *d);
    newton->has_before = true;
    memcpy(d, newton->right, size * sizeof *d);
    pel_pairs_begin(&newton->pairs, size, d);
    precondition(newton, d);
    pel_pairs_end(&newton->pairs, size, d);
    for (size_t u = 0; u < size; u++)
        d[u] = newton->fixed[u] ? 0 : -d[u];
    double rate = run->is_prepared ? PREPARED_RATE : RATE;
    run->quasi_goal = rate * (run->quasi_steps++ == 0 ? run->result->residual : run->quasi_goal);
}

bool pel_newton_wears(pel_newton_wear *wear, int64_t work)
{
    const int64_t last_two = wear->last + work;
    wear->spent += work;
    wear->last = work;
    wear->runs++;
    return wear->runs > 1 && last_two * wear->runs > 2 * (FACTOR_PRICE + wear->spent);
}
