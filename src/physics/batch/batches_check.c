/* The whole of a layout, checked. */
#include "base/memory.h"
#include "batch/batches.h"

#include <string.h>

/* the places of a lane */
static int32_t step_of(const pel_batch *batch, int32_t block, int k, int32_t lane)
{
    return batch->steps[((size_t)block * (size_t)batch->arity + (size_t)k) * PEL_BLOCK + (size_t)lane];
}

static bool are_equal_lanes(const pel_batch *batch, int32_t block, int32_t a, int32_t b)
{
    for (int k = 0; k < batch->arity; k++)
        if (step_of(batch, block, k, a) != step_of(batch, block, k, b))
            return false;
    return true;
}

/* lanes in use have places of the body; the others repeat the last one of these */
static bool check_block(const pel_batch *batch, const pel_pieces *pieces, int32_t block)
{
    int32_t used = batch->lane_counts[block];
    if (used < 1 || used > PEL_BLOCK || batch->followers[block] >= PEL_BATCH_GROUP)
        return false;
    for (int32_t lane = 0; lane < PEL_BLOCK; lane++) {
        for (int k = 0; k < batch->arity; k++) {
            int32_t place = step_of(batch, block, k, lane) / PEL_STEP - pieces->first_place;
            if (step_of(batch, block, k, lane) % PEL_STEP != 0 || place < 0 || place >= pieces->place_count)
                return false;
        }
        if (lane >= used && !are_equal_lanes(batch, block, lane, used - 1))
            return false;
    }
    return true;
}

/* stamp: (places of the model) which group had a vertex last */
static bool check_group(const pel_batch *batch, int32_t begin, int32_t last, int32_t *stamp)
{
    for (int32_t block = begin; block <= last; block++)
        for (int32_t lane = 0; lane < batch->lane_counts[block]; lane++)
            for (int k = 0; k < batch->arity; k++) {
                int32_t *seen = &stamp[step_of(batch, block, k, lane) / PEL_STEP];
                if (*seen == begin + 1)
                    return false;
                *seen = begin + 1;
            }
    return true;
}

static bool check_batch(const pel_batch *batch, const pel_pieces *pieces, int32_t *stamp)
{
    int32_t bundles = pel_bundle_count(pieces);
    if (batch->bundle_begin[0] != 0 || batch->bundle_begin[bundles] != batch->block_count ||
        batch->block_count > batch->capacity ||
        (pieces->piece_count == 1 && batch->bundle_begin[1] != batch->block_count))
        return false;
    for (int32_t i = 0; i < bundles; i++)
        if (batch->bundle_begin[i + 1] < batch->bundle_begin[i])
            return false;
    for (int32_t block = 0; block < batch->block_count; block++)
        if (!check_block(batch, pieces, block))
            return false;
    for (int32_t i = 0; i < bundles; i++)
        for (int32_t block = batch->bundle_begin[i]; block < batch->bundle_begin[i + 1];) {
            int32_t last = block + batch->followers[block];
            if (last >= batch->bundle_begin[i + 1] || !check_group(batch, block, last, stamp))
                return false;
            block = last + 1;
        }
    return true;
}

static bool check_bodies(const pel_batches *batches, int32_t *stamp)
{
    for (int32_t b = 0; b < batches->model->body_count; b++) {
        const pel_body_batches *body = &batches->bodies[b];
        for (int32_t i = 0; i < body->pieces.place_count; i++)
            if (body->pieces.piece_of_place[i] < 0 || body->pieces.piece_of_place[i] >= body->pieces.piece_count)
                return false;
        for (int32_t i = 0; i < body->batch_count; i++) {
            memset(stamp, 0, (size_t)batches->model->vertex_count * sizeof *stamp);
            if (!check_batch(&body->batches[i], &body->pieces, stamp))
                return false;
        }
    }
    return true;
}

/* owner: (places of the model) the bundle that had a vertex last, by its place in the list, plus 1 */
static bool check_bundle(const pel_batches *batches, int32_t n, int32_t phase_begin, int32_t *owner)
{
    const pel_bundle *bundle = &batches->bundles[n];
    if (bundle->body < 0 || bundle->body >= batches->model->body_count)
        return false;
    const pel_body_batches *body = &batches->bodies[bundle->body];
    if (bundle->number < 0 || bundle->number >= pel_bundle_count(&body->pieces))
        return false;
    for (int32_t i = 0; i < body->batch_count; i++) {
        const pel_batch *batch = &body->batches[i];
        size_t width = (size_t)batch->arity * PEL_BLOCK, end = (size_t)batch->bundle_begin[bundle->number + 1] * width;
        for (size_t at = (size_t)batch->bundle_begin[bundle->number] * width; at < end; at++) {
            int32_t *seen = &owner[batch->steps[at] / PEL_STEP];
            if (*seen > phase_begin && *seen != n + 1)
                return false;
            *seen = n + 1;
        }
    }
    return true;
}

/* every bundle is in one phase, in which it meets no other; one piece has nothing but itself */
static bool check_phases(const pel_batches *batches, int32_t *owner)
{
    int32_t count = 0;
    for (int32_t b = 0; b < batches->model->body_count; b++)
        count += batches->bodies[b].pieces.piece_count == 1 ? 1 : pel_bundle_count(&batches->bodies[b].pieces);
    if (batches->phase_begin[0] != 0 || batches->phase_begin[PEL_PHASE_COUNT] != count)
        return false;
    for (int phase = 0; phase < PEL_PHASE_COUNT; phase++)
        if (batches->phase_begin[phase + 1] < batches->phase_begin[phase])
            return false;
    memset(owner, 0, (size_t)batches->model->vertex_count * sizeof *owner);
    for (int phase = 0; phase < PEL_PHASE_COUNT; phase++)
        for (int32_t n = batches->phase_begin[phase]; n < batches->phase_begin[phase + 1]; n++)
            if (!check_bundle(batches, n, batches->phase_begin[phase], owner))
                return false;
    return true;
}

bool pel_batches_is_valid(const pel_batches *batches)
{
    int32_t *scratch = pel_allocate((size_t)batches->model->vertex_count, sizeof *scratch);
    bool good = scratch == NULL || (check_bodies(batches, scratch) && check_phases(batches, scratch));
    pel_free(scratch);
    return good;
}
