#include "linear/minres.h"

#include "base/memory.h"
#include "base/status.h"
#include "math/extremes.h"
#include "math/functions.h"

#include <math.h>
#include <string.h>

/* vectors of the Lanczos process and of the directions of x, two and three in turn */
enum { VECTORS = 8 };

struct pel_minres {
    int32_t unknown_count;
    double *vectors[VECTORS]; /* (unknown_count) each */
};

pel_status pel_minres_create(int32_t unknown_count, pel_minres **minres, pel_error *error)
{
    *minres = NULL;
    pel_minres *made = pel_allocate(1, sizeof *made);
    if (made == NULL)
        return pel_fail_memory(error);
    made->unknown_count = unknown_count;
    bool room = true;
    for (int i = 0; i < VECTORS; i++)
        room &= (made->vectors[i] = pel_allocate((size_t)unknown_count, sizeof(double))) != NULL;
    if (!room) {
        pel_minres_destroy(made);
        return pel_fail_memory(error);
    }
    *minres = made;
    return PEL_OK;
}

void pel_minres_destroy(pel_minres *minres)
{
    if (minres == NULL)
        return;
    for (int i = 0; i < VECTORS; i++)
        pel_free(minres->vectors[i]);
    pel_free(minres);
}

static double dot(const pel_minres *minres, const double *a, const double *b)
{
    double sum = 0;
    for (int32_t i = 0; i < minres->unknown_count; i++)
        sum += a[i] * b[i];
    return sum;
}

/* the two last and the next of a sequence */
typedef struct sequence {
    double *before, *now, *next;
} sequence;

static void advance(sequence *s)
{
    double *free = s->before;
    s->before = s->now;
    s->now = s->next;
    s->next = free;
}

/* The Lanczos process: v of length gamma in the metric of the preconditioner, z = M^-1 v / gamma. */
typedef struct lanczos {
    sequence v;
    double *z, *product;
    double gamma_before, gamma, gamma_next, delta;
} lanczos;

static void go_on(const pel_minres *minres, const pel_pcg_def *def, pel_pool *pool, lanczos *l)
{
    pel_matrix_multiply(def->matrix, pool, l->z, l->product);
    if (def->add_product != NULL)
        def->add_product(def->added, pool, l->z, l->product);
    l->delta = dot(minres, l->product, l->z);
    double older = l->gamma_before > 0 ? l->gamma / l->gamma_before : 0;
    for (int32_t i = 0; i < minres->unknown_count; i++)
        l->v.next[i] = l->product[i] - l->delta / l->gamma * l->v.now[i] - older * l->v.before[i];
    def->precondition(def->preconditioner, pool, l->v.next, l->product);
    l->gamma_next = sqrt(pel_max(dot(minres, l->product, l->v.next), 0));
}

static double begin(const pel_minres *minres, const pel_pcg_def *def, pel_pool *pool, const double *right, lanczos *l)
{
    size_t bytes = (size_t)minres->unknown_count * sizeof(double);
    memset(l->v.before, 0, bytes);
    memcpy(l->v.now, right, bytes);
    def->precondition(def->preconditioner, pool, right, l->z);
    l->gamma = sqrt(dot(minres, l->z, right));
    for (int32_t i = 0; i < minres->unknown_count; i++)
        l->z[i] /= l->gamma;
    return l->gamma;
}

pel_pcg_result pel_minres_solve(pel_minres *minres, const pel_pcg_def *def, pel_pool *pool, const double *right,
                                double *solution)
{
    double *const *at = minres->vectors;
    size_t bytes = (size_t)minres->unknown_count * sizeof(double);
    lanczos l = {.v = {at[0], at[1], at[2]}, .z = at[3], .product = at[4]};
    sequence w = {at[5], at[6], at[7]};
    pel_pcg_result result = {.end = PEL_PCG_LIMIT};
    memset(solution, 0, bytes);
    memset(w.before, 0, bytes);
    memset(w.now, 0, bytes);
    double size = begin(minres, def, pool, right, &l), residual = size;
    double c_before = 1, c = 1, s_before = 0, s = 0;
    if (!(size > 0))
        result.end = size == 0 ? PEL_PCG_CONVERGED : PEL_PCG_BROKEN;
    for (; result.end == PEL_PCG_LIMIT && result.iterations < def->iterations; result.iterations++) {
        if (pel_pool_is_stopped(pool))
            break;
        go_on(minres, def, pool, &l);
        /* the QR factors of the tridiagonal matrix, by rotations */
        double a0 = c * l.delta - c_before * s * l.gamma, a1 = pel_hypot(a0, l.gamma_next);
        double a2 = s * l.delta + c_before * c * l.gamma, a3 = s_before * l.gamma;
        double c_next = a0 / a1, s_next = l.gamma_next / a1;
        for (int32_t i = 0; i < minres->unknown_count; i++) {
            w.next[i] = (l.z[i] - a3 * w.before[i] - a2 * w.now[i]) / a1;
            solution[i] += c_next * residual * w.next[i];
            l.z[i] = l.gamma_next > 0 ? l.product[i] / l.gamma_next : 0;
        }
        residual *= -s_next;
        advance(&w);
        advance(&l.v);
        l.gamma_before = l.gamma;
        l.gamma = l.gamma_next;
        c_before = c;
        c = c_next;
        s_before = s;
        s = s_next;
        result.residual = fabs(residual) / size;
        if (!isfinite(residual) || !isfinite(a1))
            result.end = PEL_PCG_BROKEN;
        else if (result.residual <= def->tolerance)
            result.end = PEL_PCG_CONVERGED;
    }
    return result;
}
