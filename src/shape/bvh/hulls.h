/* Pairs of features of convex bodies that are rigid, or do not meet themselves for another reason: such as marbles,
   boxes and tools with flat faces. Two of them come near each other only where both face each other, so that no tree is
   needed to find the pairs there.

   Let n be any direction, from body a to body b, and h = n . x the heights of points, all of which go straight in a
   step. A point of a and one of b that come within `reach` have heights at most `reach` apart then. The least height of
   b over time is that of linear functions, concave, so it lies above the line between its values at both ends: a vertex
   of a can be part of what comes near only if at the start or at the end it is higher than the least height of b there,
   less `reach`. The same holds for b. Features with such a vertex are the near ones, a few of each marble, and pairs of
   them are candidates where their boxes overlap, in a frame that goes with a. This holds for any bodies and directions;
   for convex ones, and the direction between their centers or along which their boxes are farthest apart, it leaves
   little.
 */
#ifndef PEL_BVH_HULLS_H
#define PEL_BVH_HULLS_H

#include "bvh/frame.h"
#include "bvh/search.h"

enum { PEL_HULL_PARTS = 16 };

/* a body in a search */
typedef struct pel_hull {
    int32_t group, begin, end;    /* its vertices among those of all hulls */
    double low[2][3], high[2][3]; /* m, at the start and the end */
} pel_hull;

typedef struct pel_hull_order {
    double low;
    int32_t hull;
} pel_hull_order;

/* scratch of a thread */
typedef struct pel_hull_part pel_hull_part;

typedef struct pel_hulls {
    const pel_tree *tree; /* not owned: the features */
    int32_t count, vertex_count;
    bool are_all;                /* nothing else meets */
    pel_hull *items;             /* (count) */
    int32_t *vertices;           /* (vertex_count) of one hull after the other */
    int32_t *place;              /* (vertices of the tree) where one is among these; -1 = nowhere */
    int32_t *fan_begin;          /* (vertex_count + 1) triangles around each of them: */
    int32_t *fans;               /* (fan_begin[vertex_count]) */
    uint8_t *may_meet;           /* (group_count x group_count) which groups meet elsewhere than here */
    pel_collision_groups groups; /* not owned: all that meet */
    pel_hull_order *order;       /* (count) scratch */
    pel_pair *pairs;             /* hulls that may come near each other */
    size_t pair_count, pair_capacity;
    pel_hull_part *parts; /* (PEL_HULL_PARTS) */
} pel_hulls;

/* The hulls among the groups of a tree, by positions of its vertices; null where no two of them meet. The arrays of the
   groups have to live on. PEL_OUT_OF_MEMORY. */
pel_status pel_hulls_create(const pel_tree *tree, const double (*positions)[3], const pel_collision_groups *groups,
                            pel_hulls **hulls);
void pel_hulls_destroy(pel_hulls *hulls);

/* Adds the pairs of hulls that come within `reach` [m] in a step to lists of vertices with triangles and of edges, and
   some that do not. sought (group_count): one side is of these; null = all. pool is nullable; the order of the pairs
   does not depend on it. PEL_OUT_OF_MEMORY, PEL_BAD_ARGUMENT with the vertex if a position is not finite, or for more
   pairs than the limit. */
pel_status pel_hulls_find(pel_hulls *hulls, const pel_motion *motion, double reach, const uint8_t *sought,
                          int64_t limit, pel_pool *pool, pel_pair_list *const lists[2], pel_error *error);

#endif
