/* One tree over the triangles of a surface, with the vertices and edges of the surface in its leaves.

   The tree is a balanced binary tree of boxes, built by splitting at the median along the longest side of the
   centroids. Every leaf but the last holds eight triangles: one wide comparison tests a box against all of them. Each
   vertex and each edge belongs to the first triangle that has it, hence to one leaf: so a search over pairs of leaves
   meets every pair of features exactly once. The box of a triangle contains the boxes of its vertices and edges, so no
   overlapping pair is lost. Nodes are in preorder: the left child of node n over leaves begin..end follows it, the
   right child comes 2 (middle - begin) later. Only boxes of nodes are stored. A search computes the boxes of a leaf's
   features from those of the vertices when it reaches the leaf (search.c): stored boxes took 135 bytes a triangle. An
   edge is named by the first half-edge 3 t + i along it (pellicle/topology.h).

   Triangles of a group that does not meet itself, such as a rigid body, are sorted by the mean of all of the group, as
   long as a node has others too: so most nodes have one group alone, and a search skips pairs of nodes whose groups do
   not meet. A heap of 100 marbles spent most of its searches inside each marble.

   Tried and rejected: normal cones (a smooth patch that turns by less than a right angle does not touch itself). The
   theorem needs a patch whose outline, seen along the axis of its cone, does not cross itself, at all times of the
   step, and it speaks of contact only: with a thickness, pairs of a gently bent patch are near each other and must be
   found. So culling by normals would lose pairs that this search promises. */
#ifndef PEL_BVH_TREE_H
#define PEL_BVH_TREE_H

#include "base/assert.h"
#include "base/pool.h"
#include "bvh/box.h"
#include "pellicle/topology.h"

/* Groups of vertices, and which of them can meet at all; a triangle and an edge belong to the group of their first
   vertex. */
typedef struct pel_collision_groups {
    const int32_t *group_of_vertex; /* (vertex_count) null = everything may meet */
    const uint8_t *may_meet;        /* (group_count x group_count) symmetric */
    int32_t group_count;
    const double (*shape)[3]; /* (vertex_count) positions at which groups are convex or not; null = the present ones */
} pel_collision_groups;

typedef struct pel_tree {
    int32_t vertex_count, triangle_count;
    const int32_t (*triangles)[3]; /* (triangle_count x 3) not owned */
    /* none when only triangles are asked for: */
    int32_t *next_in_edge; /* (3 triangle_count) the next half-edge on the same edge, after the last one the first */
    uint8_t *features;     /* (triangle_count) bit i: edge i belongs to the triangle, bit 3 + i: its corner i does */

    int32_t leaf_count, node_count;
    pel_box *nodes;               /* (node_count) */
    int32_t (*leaves)[PEL_LANES]; /* (leaf_count) triangles, -1 = none */
    const pel_box *vertex_boxes;  /* (vertex_count) not owned: the boxes that the tree was fitted to */
    pel_collision_groups groups;  /* not owned; without an array of groups all are one: */
    int32_t *node_groups;     /* (node_count) the group of all triangles below, -1 = several; null = not asked for */
    float (*group_places)[4]; /* (group_count) mean and number of their triangles, in the last build */
    bool is_stale;            /* the build knows other groups: it is due again */
    double built_cost;        /* pel_tree_cost after the first refit since the last build; 0 = not yet */
} pel_tree;

/* content of the leaves */
typedef enum pel_tree_content {
    PEL_TREE_TRIANGLES, /* triangles only: for searches of pairs of triangles */
    PEL_TREE_FEATURES   /* vertices and edges too */
} pel_tree_content;

/* A tree over any triangles with three different vertices 0 .. vertex_count - 1, at least one, which have to live on;
   positions (vertex_count x 3), finite. Its boxes are empty until the first refit. PEL_OUT_OF_MEMORY, PEL_BAD_ARGUMENT
   (no triangle, too many). */
pel_status pel_tree_create(const double (*positions)[3], int32_t vertex_count, const int32_t (*triangles)[3],
                           int32_t triangle_count, pel_tree_content content, pel_tree **tree, pel_error *error);
void pel_tree_destroy(pel_tree *tree);

/* Searches pass over subtrees of groups (not owned) that do not meet, after the next rebuild, which keeps groups that
   do not meet themselves together. PEL_OUT_OF_MEMORY. */
pel_status pel_tree_use_groups(pel_tree *tree, const pel_collision_groups *groups);

/* Sorts the triangles again, without allocation. Refit the boxes afterwards. */
void pel_tree_rebuild(pel_tree *tree, const double (*positions)[3]);

/* All boxes from those of the vertices (vertex_count), which must live as long as the tree is searched. pool is
   nullable. */
void pel_tree_refit(pel_tree *tree, const pel_box *vertex_boxes, pel_pool *pool);

/* The same after some of those boxes have changed (vertex_count, 1 = it did); marks the nodes that were fitted
   (node_count). */
void pel_tree_refit_changed(pel_tree *tree, const uint8_t *vertex_changed, uint8_t *node_changed);

/* Marks the nodes (node_count) below which a triangle is of one of these groups (group_count, 1 = it is one). */
void pel_tree_mark_groups(const pel_tree *tree, const uint8_t *groups, uint8_t *marks);

/* Area of the nodes' boxes over that of the root: grows as the tree gets worse. */
double pel_tree_cost(const pel_tree *tree);

/* Whether each triangle is in one lane, each vertex and edge belongs to one triangle, and the box of each node contains
   those below it (not yet fitted boxes are empty). */
bool pel_tree_is_valid(const pel_tree *tree);

/* ---- edges ---- */

static inline int32_t pel_tree_corner(const pel_tree *tree, int32_t h)
{
    PEL_ASSERT_INDEX(h, 3 * tree->triangle_count);
    const int32_t *corners = *tree->triangles;
    return corners[h];
}

/* the edge along which a half-edge runs */
static inline int32_t pel_tree_edge(const pel_tree *tree, int32_t h)
{
    PEL_ASSERT_INDEX(h, 3 * tree->triangle_count);
    int32_t first = h;
    for (int32_t g = tree->next_in_edge[h]; g != h; g = tree->next_in_edge[g])
        first = g < first ? g : first;
    return first;
}

static inline void pel_tree_edge_ends(const pel_tree *tree, int32_t e, int32_t ends[2])
{
    PEL_ASSERT_INDEX(e, 3 * tree->triangle_count);
    ends[0] = pel_tree_corner(tree, e);
    ends[1] = pel_tree_corner(tree, pel_half_edge_next(e));
}

/* the vertices across from an edge in its first two triangles, -1 = none */
static inline void pel_tree_edge_opposites(const pel_tree *tree, int32_t e, int32_t opposites[2])
{
    PEL_ASSERT_INDEX(e, 3 * tree->triangle_count);
    int32_t second = tree->next_in_edge[e];
    opposites[0] = pel_tree_corner(tree, pel_half_edge_previous(e));
    opposites[1] = second != e ? pel_tree_corner(tree, pel_half_edge_previous(second)) : -1;
}

/* The box of an edge or triangle from those of the vertices (vertex_count). */
static inline pel_box pel_tree_edge_box(const pel_tree *tree, const pel_box *vertex_boxes, int32_t e)
{
    PEL_ASSERT_INDEX(e, 3 * tree->triangle_count);
    int32_t ends[2];
    pel_tree_edge_ends(tree, e, ends);
    return pel_box_join(vertex_boxes[ends[0]], vertex_boxes[ends[1]]);
}

static inline pel_box pel_tree_triangle_box(const pel_tree *tree, const pel_box *vertex_boxes, int32_t t)
{
    PEL_ASSERT_INDEX(t, tree->triangle_count);
    const int32_t *v = tree->triangles[t];
    return pel_box_join(pel_box_join(vertex_boxes[v[0]], vertex_boxes[v[1]]), vertex_boxes[v[2]]);
}

/* whether the groups of two nodes may meet; of nodes with several groups, and in two trees, all may */
static inline bool pel_tree_nodes_may_meet(const pel_tree *a, int32_t m, const pel_tree *b, int32_t n)
{
    if (a != b || a->node_groups == NULL || a->node_groups[m] < 0 || a->node_groups[n] < 0)
        return true;
    return a->groups.may_meet[a->node_groups[m] * a->groups.group_count + a->node_groups[n]];
}

static inline int32_t pel_tree_middle(int32_t begin, int32_t end)
{
    return begin + (end - begin) / 2;
}

#endif
