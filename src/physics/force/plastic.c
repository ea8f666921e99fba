/* What slips of a sheet that yields, and what grows: folds and flows. Blocks are looked at in lanes; hinges beyond
   their yield angle slip one by one, triangles beyond their yield stress together. */
#include "base/assert.h"
#include "force/shell_body.h"
#include "math/functions.h"
#include "measure/hinge.h"
#include "measure/membrane.h"

#include <math.h>

static void load_block(const pel_batch *batch, int32_t block, const pel_record *position, pel_particle *x)
{
    PEL_ASSERT_INDEX(block, batch->block_count);
    for (int k = 0; k < batch->arity; k++)
        x[k] = pel_particle_load(position,
                                 batch->steps + ((size_t)block * (size_t)batch->arity + (size_t)k) * PEL_BLOCK, 0);
}

static pel_lane number_of(const pel_batch *batch, int32_t block, int j)
{
    return pel_lane_load(pel_batch_number(batch, block * PEL_BLOCK, j), 0);
}

/* ---- hinges ---- */

/* lets a block slip; returns the work, 0 if none of its hinges is beyond its yield angle */
static double slip_hinges(const pel_batch *batch, int32_t block, const pel_shell *shell, const pel_record *position,
                          pel_fold *folds)
{
    pel_particle x[4];
    double work = 0;
    load_block(batch, block, position, x);
    const pel_lane angle = pel_hinge_angle_of(x, number_of(batch, block, 0), number_of(batch, block, 1)).difference;
    for (int32_t l = 0; l < batch->lane_counts[block]; l++) {
        const int32_t at = block * PEL_BLOCK + l, i = batch->sources[at];
        if (fabs((double)angle[l]) > (double)*pel_batch_number(batch, at, 3))
            work += pel_fold_slip(&folds[shell->first_fold + i], (double)angle[l], shell->yield_angles[i],
                                  shell->hardening) /
                    (double)*pel_batch_number(batch, at, 2);
    }
    return work;
}

/* ---- triangles ---- */

/* The inverse i of the shape without stress after plastic strains (uu, vv, uv) of its frame: i exp(-strain), turned so
   that it stays triangular. */
static void flow_shape(double inverse[3], double mean, double half, double cosine, double sine)
{
    const double first = pel_exp(-mean - half), second = pel_exp(half - mean);
    const double c = 0.5 * (first + second), s = 0.5 * (first - second);
    const double e11 = c + s * cosine, e22 = c - s * cosine, e12 = s * sine;
    const double a = inverse[0] * e11 + inverse[1] * e12, b = inverse[0] * e12 + inverse[1] * e22;
    const double x = inverse[2] * e12, y = inverse[2] * e22, length = sqrt(x * x + y * y);
    inverse[0] = (a * y - b * x) / length;
    inverse[1] = (a * x + b * y) / length;
    inverse[2] = length;
}

/* the same for a block of triangles */
static double slip_triangles(const pel_batch *batch, int32_t block, const pel_shell *shell, const pel_record *position,
                             pel_flow *flows)
{
    const pel_lane half = PEL_CONSTANT(0.5);
    pel_lane numbers[4];
    pel_particle x[3];
    load_block(batch, block, position, x);
    const pel_gradient f =
        pel_gradient_of(pel_lane3_subtract(x[0].at, x[2].at), pel_lane3_subtract(x[1].at, x[2].at),
                        number_of(batch, block, 0), number_of(batch, block, 1), number_of(batch, block, 2));
    const pel_strain strain = pel_green_strain(&f);
    for (int i = 0; i < 4; i++)
        numbers[i] = i == 0 ? number_of(batch, block, PEL_TRIANGLE_NUMBERS) : pel_lane_splat(batch->law.numbers[i]);
    const pel_return r = pel_return_of(numbers, &strain);
    const pel_lane slip = r.m * r.q, work = (r.yield + half * numbers[3] * slip) * slip;
    /* means and half differences of the principal plastic strains */
    const pel_lane mean = half * r.m * r.p, part = PEL_CONSTANT(1.5) * r.m * r.d;
    double sum = 0;
    for (int32_t l = 0; l < batch->lane_counts[block]; l++) {
        const int32_t at = block * PEL_BLOCK + l;
        if (!(slip[l] > 0))
            continue;
        pel_flow *flow = &flows[shell->first_flow + batch->sources[at]];
        flow_shape(flow->inverse, (double)mean[l], (double)part[l], (double)r.axes.cosine[l], (double)r.axes.sine[l]);
        flow->slip += (double)slip[l];
        sum += (double)work[l] * (double)*pel_batch_number(batch, at, 3);
    }
    return sum;
}

/* ---- all ---- */

double pel_shell_forces_slip(pel_shell_forces *forces, const pel_record *position, const pel_plastic *plastic)
{
    double work = 0;
    for (int32_t b = 0; forces != NULL && b < forces->model->body_count; b++) {
        const pel_body_batches *own = &forces->batches->bodies[b];
        const pel_shell *shell = forces->bodies[b].shell;
        for (int32_t i = 0; i < own->batch_count; i++) {
            const pel_batch *batch = &own->batches[i];
            const bool is_fold = batch->kind == PEL_CONSTRAINT_FOLD,
                       is_flow = pel_batch_is_membrane(batch) && shell->yields;
            for (int32_t block = 0; (is_fold || is_flow) && block < batch->block_count; block++) {
                const double slip = is_fold ? slip_hinges(batch, block, shell, position, plastic->folds)
                                            : slip_triangles(batch, block, shell, position, plastic->flows);
                if (slip > 0)
                    pel_batch_slip(forces->batches, b, batch, block, plastic);
                work += slip;
            }
        }
    }
    return work;
}

void pel_shell_forces_set_plastic(pel_shell_forces *forces, const pel_plastic *plastic)
{
    if (forces == NULL || (plastic->folds == NULL && plastic->flows == NULL))
        return;
    forces->plastic = *plastic;
    for (int32_t b = 0; b < forces->model->body_count; b++) {
        const pel_shell *shell = forces->bodies[b].shell;
        for (int32_t i = 0; i < forces->batches->bodies[b].batch_count; i++) {
            const pel_batch *batch = &forces->batches->bodies[b].batches[i];
            for (int32_t block = 0; pel_batch_is_plastic(batch, shell) && block < batch->block_count; block++)
                pel_batch_slip(forces->batches, b, batch, block, plastic);
        }
    }
}
