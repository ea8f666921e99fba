/* Colours are given greedily, the lowest one that none of an element's vertices has yet, with a mask of 64 bits at each
   vertex; elements without a free colour wait for another round of 64. Elements are taken by their first vertex in the
   model's order, which traverses the surface in rings, so that elements of one colour are near each other in memory. */
#include "batch/layout.h"

#include "base/assert.h"
#include "base/memory.h"
#include "base/patience.h"
#include "base/room.h"
#include "base/status.h"

#include <string.h>

enum { COLORS = 64 };

pel_status pel_build_scratch_create(pel_build_scratch *scratch, const pel_pieces *pieces, int32_t count_limit,
                                    pel_error *error)
{
    *scratch = (pel_build_scratch){.count_limit = count_limit};
    size_t count = (size_t)count_limit, places = (size_t)pieces->place_count;
    bool made = PEL_ALLOCATE_ALL(
        PEL_ROOM(scratch->vertices, 4 * count), PEL_ROOM(scratch->origins, count), PEL_ROOM(scratch->order, count),
        PEL_ROOM(scratch->sorted, count), PEL_ROOM(scratch->color, count),
        PEL_ROOM(scratch->counts, (places > count ? places : count) + COLORS + 2), PEL_ROOM(scratch->masks, places),
        PEL_ROOM(scratch->bundles, (size_t)pel_bundle_count(pieces) + 1));
    return made ? PEL_OK : pel_fail_memory(error);
}

void pel_build_scratch_destroy(pel_build_scratch *scratch)
{
    PEL_FREE_ALL(scratch->vertices, scratch->origins, scratch->order, scratch->sorted, scratch->color, scratch->counts,
                 scratch->masks, scratch->bundles);
    *scratch = (pel_build_scratch){0};
}

/* turns counts of the keys 0 .. key_count - 1 in begin[1 ..] into begin[key], the first place of a key */
static void sum_counts(int32_t *begin, int32_t key_count)
{
    begin[0] = 0;
    for (int32_t k = 0; k < key_count; k++)
        begin[k + 1] += begin[k];
}

typedef struct build {
    const int32_t *vertices;
    int arity;
    int32_t count, bundle_count;
    const pel_pieces *pieces;
    pel_build_scratch *scratch;
} build;

static int32_t lowest_place(const build *job, int32_t c)
{
    PEL_ASSERT_INDEX(c, job->count);
    const int32_t *v = job->vertices + (size_t)c * (size_t)job->arity;
    int32_t least = v[0];
    for (int k = 1; k < job->arity; k++)
        least = v[k] < least ? v[k] : least;
    return least - job->pieces->first_place;
}

static int32_t bundle_of(const build *job, int32_t c)
{
    PEL_ASSERT_INDEX(c, job->count);
    const int32_t *v = job->vertices + (size_t)c * (size_t)job->arity, pieces = job->pieces->piece_count;
    int32_t low = job->pieces->piece_of_place[v[0] - job->pieces->first_place], high = low;
    for (int k = 1; k < job->arity; k++) {
        int32_t piece = job->pieces->piece_of_place[v[k] - job->pieces->first_place];
        low = piece < low ? piece : low;
        high = piece > high ? piece : high;
    }
    return high == low ? low : high == low + 1 ? pieces + low : 2 * pieces - 1;
}

/* counting sort by place into order, then by bundle into sorted; begin (bundle_count + 1) */
static void sort_elements(const build *job, int32_t *begin)
{
    pel_build_scratch *s = job->scratch;
    memset(s->counts, 0, ((size_t)job->pieces->place_count + 1) * sizeof *s->counts);
    for (int32_t c = 0; c < job->count; c++)
        s->counts[lowest_place(job, c) + 1]++;
    sum_counts(s->counts, job->pieces->place_count);
    for (int32_t c = 0; c < job->count; c++)
        s->order[s->counts[lowest_place(job, c)]++] = c;
    memset(s->counts, 0, ((size_t)job->bundle_count + 1) * sizeof *s->counts);
    for (int32_t c = 0; c < job->count; c++)
        s->counts[bundle_of(job, c) + 1]++;
    sum_counts(s->counts, job->bundle_count);
    memcpy(begin, s->counts, ((size_t)job->bundle_count + 1) * sizeof *begin);
    for (int32_t i = 0; i < job->count; i++)
        s->sorted[s->counts[bundle_of(job, s->order[i])]++] = s->order[i];
}

/* gives the elements sorted[from .. to - 1] colours; returns their number */
static int32_t color_bundle(const build *job, int32_t from, int32_t to)
{
    PEL_ASSERT(from >= 0 && from <= to && to <= job->count);
    pel_build_scratch *s = job->scratch;
    int32_t left = to - from, color_count = 0, first = job->pieces->first_place;
    for (int32_t i = from; i < to; i++)
        s->color[s->sorted[i]] = -1;
    for (int32_t round = 0; left > 0; round += COLORS) {
        for (int32_t i = from; i < to; i++) {
            int32_t c = s->sorted[i];
            const int32_t *v = job->vertices + (size_t)c * (size_t)job->arity;
            uint64_t taken = 0;
            for (int k = 0; k < job->arity; k++)
                taken |= s->masks[v[k] - first];
            if (s->color[c] >= 0 || taken == UINT64_MAX)
                continue;
            int32_t color = __builtin_ctzll(~taken);
            for (int k = 0; k < job->arity; k++)
                s->masks[v[k] - first] |= (uint64_t)1 << color;
            s->color[c] = round + color;
            color_count = round + color >= color_count ? round + color + 1 : color_count;
            left--;
        }
        for (int32_t i = from; i < to; i++)
            for (int k = 0; k < job->arity; k++)
                s->masks[job->vertices[(size_t)s->sorted[i] * (size_t)job->arity + (size_t)k] - first] = 0;
    }
    return color_count;
}

/* sorts a coloured bundle by colour into order, counts (color_count + 1) being where colours begin; returns blocks */
static int32_t sort_colors(const build *job, int32_t from, int32_t to, int32_t color_count)
{
    PEL_ASSERT(from >= 0 && from <= to && to <= job->count && color_count >= 0);
    pel_build_scratch *s = job->scratch;
    int32_t blocks = 0;
    memset(s->counts, 0, ((size_t)color_count + 1) * sizeof *s->counts);
    for (int32_t i = from; i < to; i++)
        s->counts[s->color[s->sorted[i]] + 1]++;
    for (int32_t c = 1; c <= color_count; c++)
        blocks += (s->counts[c] + PEL_BLOCK - 1) / PEL_BLOCK;
    sum_counts(s->counts, color_count);
    for (int32_t i = from; i < to; i++)
        s->order[from + s->counts[s->color[s->sorted[i]]]++] = s->sorted[i];
    return blocks;
}

static void fill_block(pel_batch *batch, const build *job, int32_t block, const int32_t *members, int32_t member_count)
{
    PEL_ASSERT_INDEX(block, batch->capacity);
    PEL_ASSERT(member_count >= 1 && member_count <= PEL_BLOCK);
    batch->lane_counts[block] = (uint8_t)member_count;
    for (int32_t lane = 0; lane < PEL_BLOCK; lane++) {
        int32_t c = members[lane < member_count ? lane : member_count - 1];
        batch->sources[(size_t)block * PEL_BLOCK + (size_t)lane] = job->scratch->origins[c];
        for (int k = 0; k < job->arity; k++)
            batch->steps[((size_t)block * (size_t)job->arity + (size_t)k) * PEL_BLOCK + (size_t)lane] =
                PEL_STEP * job->vertices[(size_t)c * (size_t)job->arity + (size_t)k];
    }
}

/* the blocks of a bundle, colour after colour (sorted in order, counts at the ends of colours); returns the next one */
static int32_t fill_bundle(pel_batch *batch, const build *job, int32_t block, int32_t from, int32_t color_count)
{
    const pel_build_scratch *s = job->scratch;
    int32_t begin = from;
    for (int32_t c = 0; c < color_count; c++) {
        int32_t end = from + s->counts[c];
        for (; begin < end; begin += PEL_BLOCK) {
            int32_t left = end - begin, next = (left - 1) / PEL_BLOCK;
            batch->followers[block] = (uint8_t)(next < PEL_BATCH_GROUP ? next : PEL_BATCH_GROUP - 1);
            fill_block(batch, job, block++, s->order + begin, left < PEL_BLOCK ? left : PEL_BLOCK);
        }
        begin = end;
    }
    return block;
}

pel_status pel_batch_reserve(pel_batch *batch, int32_t capacity, int32_t bundle_count, pel_error *error)
{
    PEL_ASSERT(batch->steps == NULL && capacity >= 0);
    size_t lanes = (size_t)capacity * PEL_BLOCK;
    batch->capacity = capacity;
    bool room = PEL_ALLOCATE_ALL(PEL_ROOM(batch->bundle_begin, (size_t)bundle_count + 1),
                                 PEL_ROOM_ALIGNED(batch->steps, lanes * (size_t)batch->arity),
                                 PEL_ROOM_ALIGNED(batch->numbers, lanes * (size_t)batch->number_count),
                                 PEL_ROOM(batch->sources, lanes), PEL_ROOM(batch->lane_counts, capacity),
                                 PEL_ROOM(batch->followers, capacity));
    return room ? PEL_OK : pel_fail_memory(error);
}

int32_t pel_batch_bound(const pel_batch *batch, int32_t count_limit, int32_t bundle_count, int32_t most)
{
    /* greedy colours: one more than an element has neighbours; each may leave one block unfilled in each bundle */
    int64_t colors = (int64_t)batch->arity * (most - 1) + 1;
    int64_t bound = count_limit / PEL_BLOCK + bundle_count * colors;
    return bound < count_limit ? (int32_t)bound : count_limit;
}

static int32_t count_blocks(const build *job, const int32_t *begin)
{
    int32_t blocks = 0;
    for (int32_t b = 0; b < job->bundle_count && !pel_patience_is_lost(); b++)
        blocks += sort_colors(job, begin[b], begin[b + 1], color_bundle(job, begin[b], begin[b + 1]));
    return blocks;
}

pel_status pel_batch_build(pel_batch *batch, const pel_pieces *pieces, int32_t count, pel_build_scratch *scratch,
                           pel_error *error)
{
    PEL_ASSERT(count >= 0 && count <= scratch->count_limit);
    build job = {scratch->vertices, batch->arity, count, pel_bundle_count(pieces), pieces, scratch};
    int32_t *begin = scratch->bundles;
    sort_elements(&job, begin);
    if (batch->steps == NULL) {
        pel_status status = pel_batch_reserve(batch, count_blocks(&job, begin), job.bundle_count, error);
        if (status != PEL_OK)
            return status;
    }
    int32_t block = 0;
    for (int32_t b = 0; b < job.bundle_count; b++) {
        if (pel_patience_is_lost())
            return pel_fail_memory(error);
        int32_t colors = color_bundle(&job, begin[b], begin[b + 1]);
        sort_colors(&job, begin[b], begin[b + 1], colors);
        batch->bundle_begin[b] = block;
        block = fill_bundle(batch, &job, block, begin[b], colors);
    }
    batch->bundle_begin[job.bundle_count] = batch->block_count = block;
    return PEL_OK;
}

void pel_batch_share(pel_batch *batch, const pel_batch *other)
{
    PEL_ASSERT(batch->steps == NULL && batch->arity == other->arity);
    batch->is_shared = true;
    batch->capacity = other->capacity;
    batch->block_count = other->block_count;
    batch->bundle_begin = other->bundle_begin;
    batch->steps = other->steps;
    batch->sources = other->sources;
    batch->lane_counts = other->lane_counts;
    batch->followers = other->followers;
}

void pel_batch_destroy(pel_batch *batch)
{
    PEL_FREE_ALL(batch->numbers, batch->multipliers, batch->has_fixed);
    if (!batch->is_shared)
        PEL_FREE_ALL(batch->bundle_begin, batch->steps, batch->sources, batch->lane_counts, batch->followers);
}
