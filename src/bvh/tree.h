/* One tree over the triangles of a surface, with the vertices and edges of the surface in its leaves.

   The tree is a balanced binary tree of boxes, built by splitting at the median along the longest side of the
   centroids. Every leaf but the last holds eight triangles: one wide comparison tests a box against all of them. Each
   vertex and each edge belongs to one triangle that has it (its representative, the first in the order of the leaves),
   hence to one leaf: so a search over pairs of leaves meets every pair of features exactly once. The box of a triangle
   holds those of its vertices and edges, so no pair that overlaps is lost.

   Nodes stand in preorder: the left child of node n over leaves begin..end follows it, the right child stands
   2 (middle - begin) further on. Only boxes are stored.

   Tried and left out: normal cones (a smooth patch that turns by less than a right angle does not touch itself). The
   theorem needs a patch whose outline, seen along the axis of its cone, does not cross itself, at all times of the
   step, and it speaks of contact only: with a thickness, pairs of a gently bent patch are near each other and must be
   found. So culling by normals would lose pairs that this search promises. */
#ifndef PEL_BVH_TREE_H
#define PEL_BVH_TREE_H

#include "base/pool.h"
#include "bvh/box.h"

/* groups of a leaf: one of triangles, then those of its edges, up to group_end; its vertices */
typedef struct pel_leaf {
    int32_t group, group_end;
    int32_t vertex_begin, vertex_end; /* in leaf_vertices */
} pel_leaf;

/* what is in the lanes of a group: a triangle or edge, -1 = nothing; and its vertices, of an edge the last one
   repeated */
typedef struct pel_member_group {
    pel_box8_mask element, vertices[3];
} pel_member_group;

typedef struct pel_tree {
    int32_t vertex_count, triangle_count, edge_count;
    int32_t (*triangles)[3];      /* (triangle_count x 3) a copy */
    int32_t (*edges)[2];          /* (edge_count x 2) vertices; none when only triangles are asked for */
    int32_t (*triangle_edges)[3]; /* (triangle_count x 3) edge i joins corners i and i + 1 */
    int32_t (*opposite)[2]; /* (edge_count x 2) vertices across from an edge in its first two triangles, -1 = none */

    int32_t leaf_count, node_count;
    pel_box *nodes;              /* (node_count) */
    pel_leaf *leaves;            /* (leaf_count) */
    pel_box_group *groups;       /* (leaves[leaf_count - 1].group_end) */
    pel_member_group *members;   /* (as groups) */
    int32_t *leaf_vertices;      /* (used vertices) leaf after leaf; none when only triangles are asked for */
    uint8_t *vertex_seen;        /* (vertex_count) scratch of a build */
    const pel_box *vertex_boxes; /* (vertex_count) not owned: what the tree was fitted to, as long as it is searched */
    double built_cost;           /* pel_tree_cost after the first refit since the last build; 0 = not yet */
} pel_tree;

/* what is in the leaves */
typedef enum pel_tree_content {
    PEL_TREE_TRIANGLES, /* triangles only: for searches of pairs of triangles */
    PEL_TREE_FEATURES   /* vertices and edges too */
} pel_tree_content;

/* A tree over any triangles with three different vertices 0 .. vertex_count - 1, at least one; positions
   (vertex_count x 3), finite. Its boxes are empty until the first refit. PEL_OUT_OF_MEMORY, PEL_BAD_ARGUMENT (no
   triangle, too many). */
pel_status pel_tree_create(const double (*positions)[3], int32_t vertex_count, const int32_t (*triangles)[3],
                           int32_t triangle_count, pel_tree_content content, pel_tree **tree, pel_error *error);
void pel_tree_destroy(pel_tree *tree);

/* Sorts the triangles anew; no memory is allocated. Boxes are to be refitted. */
void pel_tree_rebuild(pel_tree *tree, const double (*positions)[3]);

/* All boxes from those of the vertices (vertex_count), which have to live on while pairs with vertices are searched.
   pool is nullable. */
void pel_tree_refit(pel_tree *tree, const pel_box *vertex_boxes, pel_pool *pool);

/* The same where a vertex changed (vertex_count, 1 = it did); marks the nodes that were fitted (node_count). */
void pel_tree_refit_changed(pel_tree *tree, const pel_box *vertex_boxes, const uint8_t *vertex_changed,
                            uint8_t *node_changed);

/* Area of the nodes' boxes over that of the root: grows as the tree gets worse. */
double pel_tree_cost(const pel_tree *tree);

/* The box of an edge or triangle from those of the vertices (vertex_count). */
static inline pel_box pel_tree_edge_box(const pel_tree *tree, const pel_box *vertex_boxes, int32_t e)
{
    return pel_box_join(vertex_boxes[tree->edges[e][0]], vertex_boxes[tree->edges[e][1]]);
}

static inline pel_box pel_tree_triangle_box(const pel_tree *tree, const pel_box *vertex_boxes, int32_t t)
{
    const int32_t *v = tree->triangles[t];
    return pel_box_join(pel_box_join(vertex_boxes[v[0]], vertex_boxes[v[1]]), vertex_boxes[v[2]]);
}

static inline int32_t pel_tree_middle(int32_t begin, int32_t end)
{
    return begin + (end - begin) / 2;
}

#endif
