/* Searches of a tree: pairs of features whose boxes overlap, within one surface or between two, and features in a box.

   A search over pairs is cut into many pairs of subtrees, from the trees alone; each of a fixed number of chunks takes
   its share of them and writes its own lists. So the lists, read chunk after chunk, are the same for any number of
   threads. Lists keep their memory from search to search: once they are large enough nothing is allocated. */
#ifndef PEL_BVH_SEARCH_H
#define PEL_BVH_SEARCH_H

#include "base/pool.h"
#include "bvh/tree.h"
#include "pellicle/intersect.h"

/* Kinds of pairs. Pairs of neighbours (a common vertex) are skipped, except of triangles; within one surface no pair is
   found twice. */
typedef enum pel_pair_kind {
    PEL_PAIR_VERTEX_FACE, /* vertex of the first surface, triangle of the second */
    PEL_PAIR_FACE_VERTEX, /* triangle of the first, vertex of the second; two surfaces only */
    PEL_PAIR_EDGE_EDGE,   /* in one surface first < second */
    PEL_PAIR_FACE_FACE,   /* in one surface first < second; neighbours too */
    PEL_PAIR_KIND_COUNT
} pel_pair_kind;

typedef struct pel_pair_list {
    pel_pair *pairs;
    size_t count, capacity;
} pel_pair_list;

/* lists of one chunk */
typedef struct pel_pair_chunk {
    pel_pair_list lists[PEL_PAIR_KIND_COUNT];
    pel_status status;
} pel_pair_chunk;

enum { PEL_SEARCH_CHUNKS = 64 };

typedef struct pel_pair_search {
    pel_pair_chunk chunks[PEL_SEARCH_CHUNKS];
    int64_t limit; /* the most pairs that may be found, of all kinds, those that `keep` turned down included; beyond it
                      the search is given up */
    const uint8_t
        *marks; /* (node_count) within one tree: of the nodes of a pair at least one is marked; null = all are */
    /* false = the pair is not put on the list of this chunk; called from several threads; nullable */
    bool (*keep)(void *context, int32_t chunk, pel_pair_kind kind, pel_pair pair);
    void *context;
} pel_pair_search;

/* With empty lists. */
void pel_pair_search_begin(pel_pair_search *search, int64_t limit);
void pel_pair_search_clear(pel_pair_search *search);

/* Finds the pairs of the kinds asked for (bits 1 << kind) between two trees, or within one when both are the same.
   PEL_OUT_OF_MEMORY when memory is out, PEL_BAD_ARGUMENT beyond the limit. pool is nullable. */
pel_status pel_find_pairs(const pel_tree *first, const pel_tree *second, unsigned kinds, pel_pool *pool,
                          pel_pair_search *search, pel_error *error);

/* Boxes of one surface that have grown since its pairs were found: boxes of vertices only grow between two searches. */
typedef struct pel_pair_growth {
    const uint8_t *node_grew; /* (node_count) 1 = something below did */
    const pel_box *before;    /* (vertex_count) boxes of the vertices at the last search */
} pel_pair_growth;

/* Adds the pairs within a tree that overlap now and did not before to the lists, looking only where boxes grew. After
   a failure, as above, the lists are of no use. */
pel_status pel_find_new_pairs(const pel_tree *tree, unsigned kinds, const pel_pair_growth *growth, pel_pool *pool,
                              pel_pair_search *search, pel_error *error);

/* Refuses a search with more pairs than a limit. */
pel_status pel_pairs_refuse(int64_t limit, pel_error *error);

/* pairs of one kind in all chunks */
size_t pel_pair_search_count(const pel_pair_search *search, pel_pair_kind kind);

/* Numbers of triangles whose boxes overlap a box, in the order of the tree. */
typedef struct pel_element_list {
    int32_t *elements;
    size_t count, capacity;
} pel_element_list;

/* Refills the list. PEL_OUT_OF_MEMORY. */
pel_status pel_find_in_box(const pel_tree *tree, const pel_box *box, pel_element_list *list, pel_error *error);

#endif
