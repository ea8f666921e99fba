#include "sequence/sequence.h"

#include "base/assert.h"
#include "base/hash.h"
#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "math/extremes.h"
#include "math/vec3.h"

#include <math.h>
#include <stdatomic.h>
#include <string.h>

/* ---- creation ---- */

pel_status pel_sequence_allocate(int32_t frame_count, int32_t vertex_count, pel_sequence **sequence, pel_error *error)
{
    PEL_ASSERT(frame_count > 0 && vertex_count > 0);
    pel_sequence *made = *sequence = pel_allocate(1, sizeof *made);
    if (made == NULL)
        return pel_fail_memory(error);
    made->frame_count = frame_count;
    made->vertex_count = vertex_count;
    atomic_init(&made->owner_count, 1);
    if (PEL_ALLOCATE_ALL(PEL_ROOM(made->times, frame_count),
                         PEL_ROOM(made->positions, (size_t)frame_count * (size_t)vertex_count)))
        return PEL_OK;
    pel_sequence_destroy(made);
    *sequence = NULL;
    return pel_fail_memory(error);
}

void pel_sequence_finish(pel_sequence *sequence)
{
    size_t vertices = (size_t)sequence->vertex_count, count = vertices * (size_t)sequence->frame_count;
    double fastest = 0;
    for (int32_t f = 1; f < sequence->frame_count; f++) {
        double square = 0;
        const double(*now)[3] = (const double(*)[3])sequence->positions + (size_t)f * vertices;
        for (size_t v = 0; v < vertices; v++) {
            double way[3];
            pel_vec3_subtract(now[v], (now - vertices)[v], way);
            square = pel_max(square, pel_vec3_squared_length(way));
        }
        fastest = pel_max(fastest, sqrt(square) / (sequence->times[f] - sequence->times[f - 1]));
    }
    sequence->speed = fastest;
    uint64_t sum = pel_hash_block(PEL_HASH_START, sequence->times, (size_t)sequence->frame_count * sizeof(double));
    sequence->fingerprint = pel_hash_block(sum, sequence->positions, count * sizeof *sequence->positions);
}

static pel_status check_frame(const pel_sequence *sequence, int32_t frame, pel_error *error)
{
    const double *at = sequence->positions[(size_t)frame * (size_t)sequence->vertex_count], *times = sequence->times;
    bool is_later = isfinite(times[frame]) && (frame == 0 || times[frame] > times[frame - 1]);
    if (!is_later)
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "frame", frame, "give finite times that rise",
                                  "the time of a frame is %g s, not after the one before", times[frame]);
    for (size_t i = 0; i < 3 * (size_t)sequence->vertex_count; i++)
        if (!isfinite(at[i]))
            return pel_refuse_element(error, PEL_BAD_ARGUMENT, "frame", frame, "give finite positions",
                                      "the position of vertex %d of a frame is not finite", (int)(i / 3));
    return PEL_OK;
}

pel_status pel_sequence_create(const double *positions, const double *times, int32_t frame_count, int32_t vertex_count,
                               pel_sequence **sequence, pel_error *error)
{
    PEL_REFUSE_NULL(positions, error);
    PEL_REFUSE_NULL(times, error);
    PEL_REFUSE_NULL(sequence, error);
    *sequence = NULL;
    if (frame_count < 1 || vertex_count < 1)
        return pel_refuse(error, PEL_BAD_ARGUMENT, "give at least one frame of one vertex",
                          "the sequence has %d frames of %d vertices", (int)frame_count, (int)vertex_count);
    pel_sequence *made;
    pel_status status = pel_sequence_allocate(frame_count, vertex_count, &made, error);
    if (status != PEL_OK)
        return status;
    memcpy(made->times, times, (size_t)frame_count * sizeof *times);
    memcpy(made->positions, positions, (size_t)frame_count * (size_t)vertex_count * sizeof *made->positions);
    for (int32_t f = 0; status == PEL_OK && f < frame_count; f++)
        status = check_frame(made, f, error);
    if (status != PEL_OK) {
        pel_sequence_destroy(made);
        return status;
    }
    pel_sequence_finish(made);
    *sequence = made;
    return PEL_OK;
}

const pel_sequence *pel_sequence_share(const pel_sequence *sequence)
{
    atomic_fetch_add(&((pel_sequence *)(uintptr_t)sequence)->owner_count, 1);
    return sequence;
}

void pel_sequence_destroy(pel_sequence *sequence)
{
    if (sequence == NULL || atomic_fetch_sub(&sequence->owner_count, 1) > 1)
        return;
    PEL_FREE_ALL(sequence->times, sequence->positions);
    pel_free(sequence);
}

/* rows of a frame, moved like a mesh */
static pel_status map_frame(const pel_sequence *sequence, int32_t frame, const int32_t *rows,
                            const pel_transform *transform, pel_sequence *mapped, pel_error *error)
{
    const double(*from)[3] = (const double(*)[3])sequence->positions + (size_t)frame * (size_t)sequence->vertex_count;
    pel_mesh points = {.vertex_count = mapped->vertex_count};
    points.positions = mapped->positions + (size_t)frame * (size_t)mapped->vertex_count;
    for (int32_t i = 0; i < mapped->vertex_count; i++) {
        if (rows[i] < 0 || rows[i] >= sequence->vertex_count)
            return pel_refuse_element(error, PEL_BAD_ARGUMENT, "row", i, "give vertices of the sequence",
                                      "row names vertex %d of a sequence of %d", (int)rows[i],
                                      (int)sequence->vertex_count);
        pel_vec3_copy(from[rows[i]], points.positions[i]);
    }
    return transform != NULL ? pel_mesh_transform(&points, transform, error) : PEL_OK;
}

pel_status pel_sequence_map(const pel_sequence *sequence, const int32_t *rows, int32_t row_count,
                            const pel_transform *transform, double shift, pel_sequence **mapped, pel_error *error)
{
    PEL_REFUSE_NULL(sequence, error);
    PEL_REFUSE_NULL(rows, error);
    PEL_REFUSE_NULL(mapped, error);
    *mapped = NULL;
    if (row_count < 1 || !isfinite(shift))
        return pel_refuse(error, PEL_BAD_ARGUMENT, "give at least one row and a finite shift",
                          "%d rows of a sequence, shifted by %g s", (int)row_count, shift);
    pel_sequence *made;
    pel_status status = pel_sequence_allocate(sequence->frame_count, row_count, &made, error);
    for (int32_t f = 0; status == PEL_OK && f < sequence->frame_count; f++) {
        made->times[f] = sequence->times[f] + shift;
        status = map_frame(sequence, f, rows, transform, made, error);
        if (status == PEL_OK)
            status = check_frame(made, f, error);
    }
    if (status != PEL_OK) {
        pel_sequence_destroy(made);
        return status;
    }
    pel_sequence_finish(made);
    *mapped = made;
    return PEL_OK;
}

/* ---- questions ---- */

int32_t pel_sequence_frame_count(const pel_sequence *sequence)
{
    return sequence != NULL ? sequence->frame_count : 0;
}

int32_t pel_sequence_vertex_count(const pel_sequence *sequence)
{
    return sequence != NULL ? sequence->vertex_count : 0;
}

double pel_sequence_time(const pel_sequence *sequence, int32_t frame)
{
    return sequence != NULL && frame >= 0 && frame < sequence->frame_count ? sequence->times[frame] : 0;
}

double pel_sequence_clamp(const pel_sequence *sequence, double time)
{
    return pel_min(pel_max(time, sequence->times[0]), sequence->times[sequence->frame_count - 1]);
}

pel_sequence_moment pel_sequence_find(const pel_sequence *sequence, double time)
{
    int32_t low = 0, high = sequence->frame_count - 1;
    time = pel_sequence_clamp(sequence, time);
    /* the last frame at or before the time */
    while (low < high) {
        int32_t middle = low + (high - low + 1) / 2;
        if (sequence->times[middle] <= time)
            low = middle;
        else
            high = middle - 1;
    }
    int32_t next = low + 1 < sequence->frame_count ? low + 1 : low;
    double length = sequence->times[next] - sequence->times[low];
    const double(*frames)[3] = (const double(*)[3])sequence->positions;
    size_t size = (size_t)sequence->vertex_count;
    return (pel_sequence_moment){frames + (size_t)low * size, frames + (size_t)next * size,
                                 length > 0 ? (time - sequence->times[low]) / length : 0};
}

void pel_sequence_at(const pel_sequence *sequence, double time, double *positions)
{
    if (sequence == NULL || positions == NULL || isnan(time))
        return;
    pel_sequence_moment moment = pel_sequence_find(sequence, time);
    for (int32_t v = 0; v < sequence->vertex_count; v++)
        pel_sequence_point(&moment, v, positions + 3 * (size_t)v);
}
