/* Folds that slip: angles of blocks in lanes, and the few hinges beyond their yield angle one by one. */
#include "base/assert.h"
#include "force/shell_body.h"
#include "measure/hinge.h"

#include <math.h>

/* angles of a block's hinges from their rest angles */
static pel_lane find_angles(const pel_batch *batch, int32_t block, const pel_record *position)
{
    PEL_ASSERT_INDEX(block, batch->block_count);
    const pel_real *number = pel_batch_number(batch, block * PEL_BLOCK, 0);
    pel_particle x[4];
    for (int k = 0; k < 4; k++)
        x[k] = pel_particle_load(position, batch->steps + ((size_t)block * 4 + (size_t)k) * PEL_BLOCK, 0);
    return pel_hinge_angle_of(x, pel_lane_load(number, 0), pel_lane_load(number + PEL_BLOCK, 0)).difference;
}

/* lets a block slip; returns the work, 0 if none of its hinges is beyond its yield angle */
static double slip_block(const pel_batch *batch, int32_t block, const pel_shell *shell, pel_lane angle, pel_fold *folds)
{
    double work = 0;
    for (int32_t l = 0; l < batch->lane_counts[block]; l++) {
        const int32_t at = block * PEL_BLOCK + l, i = batch->sources[at];
        if (fabs((double)angle[l]) > (double)*pel_batch_number(batch, at, 3))
            work += pel_fold_slip(&folds[shell->first_fold + i], (double)angle[l], shell->yield_angles[i],
                                  shell->hardening) /
                    (double)*pel_batch_number(batch, at, 2);
    }
    return work;
}

double pel_shell_forces_slip(pel_shell_forces *forces, const pel_record *position, pel_fold *folds)
{
    double work = 0;
    for (int32_t b = 0; forces != NULL && folds != NULL && b < forces->model->body_count; b++) {
        const pel_body_batches *own = &forces->batches->bodies[b];
        for (int32_t i = 0; i < own->batch_count; i++) {
            const pel_batch *batch = &own->batches[i];
            for (int32_t block = 0; batch->kind == PEL_CONSTRAINT_FOLD && block < batch->block_count; block++) {
                const double slip =
                    slip_block(batch, block, forces->bodies[b].shell, find_angles(batch, block, position), folds);
                if (slip > 0)
                    pel_batch_fold(forces->batches, b, batch, block, folds);
                work += slip;
            }
        }
    }
    return work;
}

void pel_shell_forces_fold(pel_shell_forces *forces, const pel_fold *folds)
{
    if (forces == NULL || folds == NULL)
        return;
    forces->folds = folds;
    for (int32_t b = 0; b < forces->model->body_count; b++)
        for (int32_t i = 0; i < forces->batches->bodies[b].batch_count; i++) {
            const pel_batch *batch = &forces->batches->bodies[b].batches[i];
            for (int32_t block = 0; batch->kind == PEL_CONSTRAINT_FOLD && block < batch->block_count; block++)
                pel_batch_fold(forces->batches, b, batch, block, folds);
        }
}
