/* Candidate pairs of a step within one surface: all pairs of a vertex and a triangle, and of two edges, whose boxes,
   swept over the step and grown by the thickness, overlap; each once.

   Most steps do not search the whole tree. The tree is fitted to larger boxes: each vertex box is grown by the vertex's
   displacement and by a margin, and the pairs found with these are kept. As long as the swept box of every vertex lies
   within its larger box, every overlapping pair of features is among the kept ones, so examining those is enough. If
   some vertices have left their boxes, these grow and only the grown boxes are searched; new pairs are added. A frame
   that follows the surface (bvh/frame.h) removes its common motion (translation, rotation, stretch) before the
   comparison, so that only relative motion counts.

   When many vertices leave their boxes in a single step, keeping pairs does not pay: the search then runs without a
   margin for some steps, twice as many each time, before a margin is tried again. All decisions depend on positions,
   none on clocks: the list does not depend on the machine. Its order depends on the step of the last search. */
#ifndef PEL_BVH_CANDIDATES_H
#define PEL_BVH_CANDIDATES_H

#include "bvh/frame.h"
#include "bvh/hulls.h"
#include "bvh/search.h"

/* counts since creation */
typedef struct pel_candidate_counts {
    int64_t updates, searches, rebuilds;
    int64_t extensions; /* searches of grown boxes only */
    int64_t kept;       /* pairs that are kept at present */
} pel_candidate_counts;

/* A piece of memory that is saved as it stands. */
typedef struct pel_memory_part {
    void *data;
    size_t size;
} pel_memory_part;

enum { PEL_CANDIDATES_PARTS = 8 };

typedef struct pel_candidates {
    pel_tree *tree;              /* own */
    pel_hulls *hulls;            /* own: pairs of these are found apart from the tree; null = there are none */
    pel_collision_groups groups; /* not owned; all, those of the tree are without pairs of hulls */
    double margin;               /* m; 0 = keep nothing */

    pel_pair *vertex_face, *edge_edge; /* of the last update: vertex and triangle, edge and edge */
    size_t vertex_face_count, edge_edge_count;
    size_t vertex_face_capacity, edge_edge_capacity;

    pel_box *vertex_boxes;    /* (vertex_count) of the last update */
    pel_box *kept_boxes;      /* (vertex_count) that the kept pairs allow for */
    uint8_t *left;            /* (vertex_count) 1 = it is not in its box any more */
    uint8_t *node_grew;       /* (nodes of the tree) */
    const uint8_t *sought;    /* (group_count) of this search: one side of a pair is of these groups; null = all */
    uint64_t *overlaps;       /* a bit for each kept pair of one kind: its boxes overlap in this update */
    size_t overlap_capacity;  /* words */
    size_t kept_limit;        /* more pairs than this: search again */
    double (*kept_places)[3]; /* (pel_frame_sample_count x 3) points that the frame follows */
    bool has_kept;
    int32_t kept_uses;           /* updates served by the kept pairs */
    int32_t pause, pause_length; /* updates to go without a margin; length of the last such pause */
    pel_pair_search search;
    pel_candidate_counts counts;
} pel_candidates;

/* A surface as for pel_tree_create, whose triangles have to live on. margin [m] >= 0; limit: the most pairs; margins
   shrink to 0 before it is exceeded. Free with pel_candidates_destroy. */
pel_status pel_candidates_create(const double (*positions)[3], int32_t vertex_count, const int32_t (*triangles)[3],
                                 int32_t triangle_count, double margin, int64_t limit, pel_candidates **candidates,
                                 pel_error *error);
void pel_candidates_destroy(pel_candidates *candidates);
/* Only pairs of these groups are found from now on. The arrays have to live on; their values stay while the surface
   stays. positions (vertex_count x 3): at which groups are convex. PEL_OUT_OF_MEMORY. */
pel_status pel_candidates_use_groups(pel_candidates *candidates, const pel_collision_groups *groups,
                                     const double (*positions)[3]);

/* The candidates of a step from start to end (vertex_count x 3) that come within `thickness` (>= 0). Allocates only for
   more candidates than ever before. pool is nullable; the result does not depend on it. PEL_BAD_ARGUMENT with the
   vertex if a position is not finite, or beyond the limit; PEL_OUT_OF_MEMORY. After a failure there are no candidates,
   and the next update starts from scratch. */
pel_status pel_candidates_update(pel_candidates *candidates, const double (*start)[3], const double (*end)[3],
                                 double thickness, pel_pool *pool, pel_error *error);

/* Instead of an update: the pairs nearer to each other than `reach` at these positions, by their distances, put on the
   lists of vertices with triangles and of edges. Kept pairs are discarded. Errors as for an update. */
pel_status pel_candidates_near(pel_candidates *candidates, const double (*positions)[3], double reach, pel_pool *pool,
                               pel_pair_list *vertex_face, pel_pair_list *edge_edge, pel_error *error);

/* Instead of an update: only pairs of which one is of these groups (group_count, 1 = it is one). Kept pairs are
   discarded. */
pel_status pel_candidates_seek(pel_candidates *candidates, const double (*start)[3], const double (*end)[3],
                               double thickness, const uint8_t *groups, pel_pool *pool, pel_pair_list *vertex_face,
                               pel_pair_list *edge_edge, pel_error *error);

/* State that past updates leave for later ones, apart from the surface; the kept pairs follow from it. The sizes of the
   pieces depend only on the number of vertices. */
void pel_candidates_memory(pel_candidates *candidates, pel_memory_part parts[PEL_CANDIDATES_PARTS]);
/* Finds the kept pairs again after the pieces were overwritten. PEL_BAD_FORMAT if they cannot have been saved from
   here; other errors as for an update. */
pel_status pel_candidates_recall(pel_candidates *candidates, pel_pool *pool, pel_error *error);

#endif
