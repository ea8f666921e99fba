#include "collide/travel.h"

#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "geom/wide4.h"
#include "math/extremes.h"

#include <math.h>
#include <string.h>

enum { VERTICES_OF_CHUNK = 2048 };

/* writes the begins where there is room for them; returns how many chunks there are */
static int32_t make_chunks(const pel_travel_def *def, int32_t *begins)
{
    int32_t count = 0, begin = 0;
    for (int32_t v = 0; v <= def->vertex_count; v += PEL_WIDTH) {
        bool is_end = v >= def->vertex_count;
        bool is_full = v - begin >= VERTICES_OF_CHUNK;
        if (v == 0 ||
            (!is_end && !is_full && def->body_of_slice[v / PEL_WIDTH] == def->body_of_slice[begin / PEL_WIDTH]))
            continue;
        if (begins != NULL) {
            begins[count] = begin;
            begins[count + 1] = v;
        }
        count++;
        begin = v;
    }
    return count;
}

pel_status pel_travel_create(const pel_travel_def *def, pel_travel *travel, pel_error *error)
{
    *travel = (pel_travel){.def = *def, .chunk_count = make_chunks(def, NULL)};
    if (!PEL_ALLOCATE_ALL(PEL_ROOM(travel->way, def->body_count), PEL_ROOM_ALIGNED(travel->last, def->vertex_count),
                          PEL_ROOM(travel->chunk_begin, travel->chunk_count + 1),
                          PEL_ROOM(travel->low, travel->chunk_count), PEL_ROOM(travel->high, travel->chunk_count)))
        return pel_fail_memory(error);
    make_chunks(def, travel->chunk_begin);
    return PEL_OK;
}

void pel_travel_destroy(pel_travel *travel)
{
    PEL_FREE_ALL(travel->way, travel->last, travel->chunk_begin, travel->low, travel->high);
    *travel = (pel_travel){0};
}

void pel_travel_restart(pel_travel *travel)
{
    memset(travel->way, 0, (size_t)travel->def.body_count * sizeof *travel->way);
    travel->approach = 0;
    travel->is_measured = false;
}

typedef struct travel_job {
    pel_travel *travel;
    const pel_record *positions;
} travel_job;

/* moves the last positions along */
static void measure_chunk(void *context, int32_t chunk)
{
    const travel_job *job = context;
    pel_travel *travel = job->travel;
    wide4 low = wide4_set(HUGE_VAL), high = wide4_set(-HUGE_VAL);
    for (int32_t v = travel->chunk_begin[chunk]; v < travel->chunk_begin[chunk + 1]; v++) {
        wide4 way = __builtin_convertvector(job->positions[v] - travel->last[v], wide4);
        travel->last[v] = job->positions[v];
        if (!(travel->def.mass[v] > 0))
            continue;
        low = wide4_min(way, low);
        high = wide4_max(way, high);
    }
    for (int k = 0; k < 3; k++) {
        travel->low[chunk][k] = low[k];
        travel->high[chunk][k] = high[k];
    }
}

/* the box around the ways of the chunks from one on, as far as they are of one body; returns the next chunk */
static int32_t box_of_body(const pel_travel *travel, int32_t chunk, double low[3], double high[3])
{
    const int32_t *body = travel->def.body_of_slice, first = body[travel->chunk_begin[chunk] / PEL_WIDTH];
    for (int k = 0; k < 3; k++) {
        low[k] = HUGE_VAL;
        high[k] = -HUGE_VAL;
    }
    for (; chunk < travel->chunk_count && body[travel->chunk_begin[chunk] / PEL_WIDTH] == first; chunk++)
        for (int k = 0; k < 3; k++) {
            low[k] = pel_min(low[k], travel->low[chunk][k]);
            high[k] = pel_max(high[k], travel->high[chunk][k]);
        }
    return chunk;
}

void pel_travel_follow(pel_travel *travel, const pel_record *positions, double other, pel_pool *pool)
{
    travel_job job = {travel, positions};
    double all_low[3], all_high[3], diagonal = 0, begin = other < 0 ? HUGE_VAL : 0;
    bool is_known = travel->is_measured;
    pel_pool_run(pool, travel->chunk_count, measure_chunk, &job);
    travel->is_measured = true;
    for (int k = 0; k < 3; k++) {
        all_low[k] = begin;
        all_high[k] = -begin;
    }
    for (int32_t c = 0; c < travel->chunk_count && is_known;) {
        double low[3], high[3], square = 0;
        int32_t body = travel->def.body_of_slice[travel->chunk_begin[c] / PEL_WIDTH];
        c = box_of_body(travel, c, low, high);
        for (int k = 0; k < 3; k++) {
            square += low[k] <= high[k] ? pel_max(low[k] * low[k], high[k] * high[k]) : 0;
            all_low[k] = pel_min(all_low[k], low[k]);
            all_high[k] = pel_max(all_high[k], high[k]);
        }
        travel->way[body] += sqrt(square) + pel_max(other, 0);
    }
    for (int k = 0; k < 3; k++)
        diagonal += all_low[k] < all_high[k] ? (all_high[k] - all_low[k]) * (all_high[k] - all_low[k]) : 0;
    travel->approach += sqrt(diagonal) + pel_max(other, 0);
}
