#include "linear/pcg.h"

#include "base/assert.h"
#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"

#include <math.h>
#include <string.h>

/* sums are cut into pieces by the count alone: the same bits for any number of threads */
enum { CHUNK = 2048, SUMS = 3 };
/* a direction whose curvature is below this share of |p| |A p| counts as flat: 100 roundings */
static const double FLAT = 2e-14;

struct pel_pcg {
    int32_t unknown_count, chunk_count;
    double *residual, *former, *preconditioned, *direction, *product; /* (unknown_count) each */
    double (*sums)[SUMS];                                             /* (chunk_count) */
};

void pel_pcg_destroy(pel_pcg *pcg)
{
    if (pcg == NULL)
        return;
    PEL_FREE_ALL(pcg->residual, pcg->sums, pcg);
}

pel_status pel_pcg_create(int32_t unknown_count, pel_pcg **pcg, pel_error *error)
{
    *pcg = NULL;
    pel_pcg *made = pel_allocate(1, sizeof *made);
    if (made == NULL)
        return pel_fail_memory(error);
    /* each array on a cache line */
    size_t stride = ((size_t)unknown_count + 7) / 8 * 8;
    made->unknown_count = unknown_count;
    made->chunk_count = (unknown_count + CHUNK - 1) / CHUNK;
    if (!PEL_ALLOCATE_ALL(PEL_ROOM_ALIGNED(made->residual, 5 * stride), PEL_ROOM(made->sums, made->chunk_count))) {
        pel_pcg_destroy(made);
        return pel_fail_memory(error);
    }
    made->former = made->residual + stride;
    made->preconditioned = made->residual + 2 * stride;
    made->direction = made->residual + 3 * stride;
    made->product = made->residual + 4 * stride;
    *pcg = made;
    return PEL_OK;
}

static void multiply(const pel_pcg_def *def, pel_pool *pool, const double *x, double *y)
{
    PEL_ASSERT(x != y);
    pel_matrix_multiply(def->matrix, pool, x, y);
    if (def->add_product != NULL)
        def->add_product(def->added, pool, x, y);
}

/* one pass over all unknowns */
typedef struct pass {
    pel_pcg *pcg;
    const double *right;
    double *solution;
    double factor;
} pass;

static int32_t end_of(const pel_pcg *pcg, int32_t chunk)
{
    return (chunk + 1) * CHUNK < pcg->unknown_count ? (chunk + 1) * CHUNK : pcg->unknown_count;
}

/* runs a pass and adds the sums of its chunks in their order */
static void run_pass(pass *p, pel_pool *pool, pel_chunk_function *function, double sums[SUMS])
{
    const pel_pcg *pcg = p->pcg;
    pel_pool_run(pool, pcg->chunk_count, function, p);
    for (int k = 0; k < SUMS; k++) {
        sums[k] = 0;
        for (int32_t chunk = 0; chunk < pcg->chunk_count; chunk++)
            sums[k] += pcg->sums[chunk][k];
    }
}

/* r = b - A x (the product is there); |r|^2, |b|^2 */
static void begin_chunk(void *context, int32_t chunk)
{
    const pass *p = context;
    pel_pcg *pcg = p->pcg;
    double rr = 0, bb = 0;
    for (int32_t i = chunk * CHUNK; i < end_of(pcg, chunk); i++) {
        double r = p->right[i] - pcg->product[i];
        pcg->residual[i] = r;
        rr += r * r;
        bb += p->right[i] * p->right[i];
    }
    pcg->sums[chunk][0] = rr;
    pcg->sums[chunk][1] = bb;
}

/* z.r, z.(former r) */
static void compare_chunk(void *context, int32_t chunk)
{
    pel_pcg *pcg = ((const pass *)context)->pcg;
    double now = 0, before = 0;
    for (int32_t i = chunk * CHUNK; i < end_of(pcg, chunk); i++) {
        now += pcg->preconditioned[i] * pcg->residual[i];
        before += pcg->preconditioned[i] * pcg->former[i];
    }
    pcg->sums[chunk][0] = now;
    pcg->sums[chunk][1] = before;
}

/* p = z + beta p */
static void turn_chunk(void *context, int32_t chunk)
{
    const pass *p = context;
    pel_pcg *pcg = p->pcg;
    for (int32_t i = chunk * CHUNK; i < end_of(pcg, chunk); i++)
        pcg->direction[i] = pcg->preconditioned[i] + p->factor * pcg->direction[i];
}

/* p.A p, p.p, A p.A p */
static void curve_chunk(void *context, int32_t chunk)
{
    pel_pcg *pcg = ((const pass *)context)->pcg;
    double sums[SUMS] = {0};
    for (int32_t i = chunk * CHUNK; i < end_of(pcg, chunk); i++) {
        sums[0] += pcg->direction[i] * pcg->product[i];
        sums[1] += pcg->direction[i] * pcg->direction[i];
        sums[2] += pcg->product[i] * pcg->product[i];
    }
    memcpy(pcg->sums[chunk], sums, sizeof sums);
}

/* x += alpha p, r -= alpha A p; |r|^2 */
static void advance_chunk(void *context, int32_t chunk)
{
    const pass *p = context;
    pel_pcg *pcg = p->pcg;
    double rr = 0;
    for (int32_t i = chunk * CHUNK; i < end_of(pcg, chunk); i++) {
        p->solution[i] += p->factor * pcg->direction[i];
        pcg->former[i] = pcg->residual[i];
        pcg->residual[i] -= p->factor * pcg->product[i];
        rr += pcg->residual[i] * pcg->residual[i];
    }
    pcg->sums[chunk][0] = rr;
}

/* the first residual and the size of the right side, both squared */
static void begin(pass *p, const pel_pcg_def *def, pel_pool *pool, double sums[SUMS])
{
    pel_pcg *pcg = p->pcg;
    size_t bytes = (size_t)pcg->unknown_count * sizeof(double);
    if (def->has_start) {
        multiply(def, pool, p->solution, pcg->product);
    } else {
        memset(p->solution, 0, bytes);
        memset(pcg->product, 0, bytes);
    }
    memset(pcg->direction, 0, bytes);
    memset(pcg->former, 0, bytes);
    run_pass(p, pool, begin_chunk, sums);
}

/* no more iterations, or too little after half of them */
static bool is_at_limit(const pel_pcg_def *def, const pel_pcg_result *result)
{
    bool is_slow = def->midway > 0 && 2 * result->iterations == def->iterations && result->residual > def->midway;
    return is_slow || result->iterations == def->iterations;
}

pel_pcg_result pel_pcg_solve(pel_pcg *pcg, const pel_pcg_def *def, pel_pool *pool, const double *right,
                             double *solution)
{
    pass p = {.pcg = pcg, .right = right, .solution = solution};
    pel_pcg_result result = {.end = PEL_PCG_LIMIT};
    double sums[SUMS], energy = 0;
    begin(&p, def, pool, sums);
    double size = sqrt(sums[1]), residual = sqrt(sums[0]);
    for (;; result.iterations++) {
        result.residual = size > 0 ? residual / size : residual;
        if (!isfinite(residual))
            result.end = PEL_PCG_BROKEN;
        else if (residual <= def->tolerance * size)
            result.end = PEL_PCG_CONVERGED;
        if (result.end != PEL_PCG_LIMIT || is_at_limit(def, &result) || pel_pool_is_stopped(pool))
            return result;
        if (def->precondition != NULL)
            def->precondition(def->preconditioner, pool, pcg->residual, pcg->preconditioned);
        else
            memcpy(pcg->preconditioned, pcg->residual, (size_t)pcg->unknown_count * sizeof(double));
        run_pass(&p, pool, compare_chunk, sums);
        if (!(sums[0] > 0 && isfinite(sums[0]))) {
            result.end = PEL_PCG_BROKEN;
            return result;
        }
        p.factor = result.iterations > 0 ? (sums[0] - sums[1]) / energy : 0;
        energy = sums[0];
        pel_pool_run(pool, pcg->chunk_count, turn_chunk, &p);
        multiply(def, pool, pcg->direction, pcg->product);
        run_pass(&p, pool, curve_chunk, sums);
        double curvature = sums[0] / sums[1];
        if (result.iterations == 0 || curvature < result.curvature)
            result.curvature = curvature;
        if (sums[0] <= FLAT * sqrt(sums[1]) * sqrt(sums[2])) {
            result.end = PEL_PCG_INDEFINITE;
            result.direction = pcg->direction;
            result.iterations++;
            return result;
        }
        p.factor = energy / sums[0];
        run_pass(&p, pool, advance_chunk, sums);
        residual = sqrt(sums[0]);
    }
}
