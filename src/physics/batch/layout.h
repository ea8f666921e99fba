/* Lays elements out in blocks: bundles by the pieces that their vertices lie in, colours within a bundle, blocks within
   a colour. Everything follows from the lists alone, so that it is the same on every machine. */
#ifndef PEL_BATCH_LAYOUT_H
#define PEL_BATCH_LAYOUT_H

#include "batch/batch.h"

/* the places that elements may have, and the piece of each: pieces are bundles, and seams (piece_count - 1) between
   neighbouring pieces, and one for the rest */
typedef struct pel_pieces {
    int32_t piece_count;
    int32_t *piece_of_place; /* (place_count) */
    int32_t first_place, place_count;
} pel_pieces;

static inline int32_t pel_bundle_count(const pel_pieces *pieces)
{
    return 2 * pieces->piece_count;
}

/* room for the list of elements that is to be laid out, and scratch */
typedef struct pel_build_scratch {
    int32_t *vertices;               /* (4 x count_limit) room for a list of elements */
    int32_t *origins;                /* (count_limit) their numbers */
    int32_t *order, *sorted, *color; /* (count_limit) */
    int32_t *counts;                 /* (place or element number + 2, whichever is more) */
    uint64_t *masks;                 /* (place_count) colours taken at a vertex */
    int32_t *bundles;                /* (bundle_count + 1) */
    int32_t count_limit;
} pel_build_scratch;

/* PEL_OUT_OF_MEMORY */
pel_status pel_build_scratch_create(pel_build_scratch *scratch, const pel_pieces *pieces, int32_t count_limit,
                                    pel_error *error);
void pel_build_scratch_destroy(pel_build_scratch *scratch);

/* Room for `capacity` blocks of a batch, whose arity and number_count are set. PEL_OUT_OF_MEMORY. */
pel_status pel_batch_reserve(pel_batch *batch, int32_t capacity, int32_t bundle_count, pel_error *error);
/* Makes a batch share the elements of another one, which outlives it; its numbers are its own. */
void pel_batch_share(pel_batch *batch, const pel_batch *other);
void pel_batch_destroy(pel_batch *batch);

/* Blocks that suffice for count_limit elements on any surface on which no vertex has more than `most` of them. */
int32_t pel_batch_bound(const pel_batch *batch, int32_t count_limit, int32_t bundle_count, int32_t most);

/* Fills bundles and blocks of a batch from scratch->vertices (count x arity); sources are scratch->origins. Allocates
   first if necessary. The caller fills the numbers. PEL_OUT_OF_MEMORY. */
pel_status pel_batch_build(pel_batch *batch, const pel_pieces *pieces, int32_t count, pel_build_scratch *scratch,
                           pel_error *error);

#endif
