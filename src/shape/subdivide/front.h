/* The front: the triangles of a forest that form the present surface (paper A, sections 3.3 and 3.4). A node is a
   triangle of the forest, numbered over all levels: node_begin[level] + t. The caller marks nodes for refinement. The
   refined ("red") nodes are the smallest set that contains the marked ones and obeys

     1. the parent of a red node is red;
     2. so is the parent of each neighbour of a red node: at most one level lies between neighbours across an edge;
     3. a node with two or three split edges is red, an edge being split when a triangle next to it is red.

   Rules 1 and 2 lead from a level to the coarser one, rule 3 stays on its level. So the set is closed level by level,
   finest first, and depends on the set of marks alone, not on their order. A node whose parent is red and which is not
   red itself is a leaf. A leaf with no split edge is whole; one with a split edge is bisected ("green"):

              v2                 edge 0 is split at m:
             /|\                   half 0 is (v0 m v2)
            / | \                  half 1 is (m v1 v2)
           v0-m--v1

   The halves exist in the list of active triangles only: they are never marked or refined, and cannot leave a
   T-junction, as both sides of an edge look at the same counter.

   Removing marks: within a level red nodes may depend on each other in cycles (rule 3). So all nodes that could depend
   on a node that is no longer requested are removed first, then those that follow from the rest are added back. Both
   spread over nodes that are neither marked nor required by a finer level; these lie in narrow bands at the rim, so the
   cost is proportional to the change. Everything is allocated at creation; events allocate nothing. */
#ifndef PEL_SUBDIVIDE_FRONT_H
#define PEL_SUBDIVIDE_FRONT_H

#include "subdivide/forest.h"

typedef enum pel_front_shape {
    PEL_FRONT_ABSENT,   /* the parent is not red */
    PEL_FRONT_WHOLE,    /* a leaf without a split edge */
    PEL_FRONT_BISECTED, /* a leaf whose edge 0 is split; + k for edge k */
    PEL_FRONT_RED = PEL_FRONT_BISECTED + 3
} pel_front_shape;

/* A triangle of the surface. */
typedef struct pel_front_triangle {
    int32_t node;
    int32_t half; /* of a bisected node: 0 or 1, see above; else 0 */
    int32_t vertices[3];
} pel_front_triangle;

/* A triangle of the surface as seen from one of its vertices. Edges are numbered over all levels by the vertex in their
   middle minus the vertices of the base; edges of the finest level and the bisectors follow. */
typedef struct pel_front_corner {
    int32_t node, half;
    int32_t next, previous;           /* its other two vertices, counter-clockwise */
    int32_t next_edge, previous_edge; /* the edges to them */
} pel_front_corner;

/* A leaf that came, went or changed in the last event. */
typedef struct pel_front_change {
    int32_t node;
    uint8_t before, after; /* pel_front_shape */
} pel_front_change;

typedef struct pel_front {
    const pel_lod_forest *forest;
    int32_t node_begin[PEL_LOD_DEPTH_LIMIT + 2]; /* (depth + 2) */
    int32_t red_limit;                           /* nodes below it can be red: all except the finest level */
    int32_t node_count;
    int32_t bisector_begin; /* the edge of the bisector of node n is bisector_begin + n */

    uint8_t *flags;      /* (node_count) front.c */
    uint8_t *shapes;     /* (node_count) pel_front_shape as of the last commit */
    uint8_t *old_shapes; /* (node_count) the same as of the commit before */
    uint8_t *red_counts; /* (edges of all levels but the finest) red triangles next to the edge: 0 to 2 */
    int32_t marked_count, red_count;

    /* the surface as of the last commit, in no particular order; places are -1 if not active */
    pel_front_triangle *triangles;
    int32_t (*place_of_node)[2]; /* (node_count x 2) by half */
    int32_t triangle_count;
    int32_t *vertices;
    int32_t *index_in_front; /* (vertices of the finest level) */
    int32_t vertex_count;
    int32_t *edges;
    int32_t *place_of_edge; /* (bisector_begin + node_count) */
    int32_t edge_count;

    /* changes of the last commit; vertices ascending, so that coarser levels come first */
    pel_front_change *changes;
    int32_t *added_vertices, *removed_vertices;
    int32_t change_count, added_count, removed_count;

    /* of the event in progress */
    int32_t next_triangle_count; /* triangles after the next commit */
    int32_t *pending;            /* nodes whose mark changed */
    int32_t *touched;            /* nodes whose redness changed since the last commit, at least for a while */
    int32_t *candidates, *coarser, *deleted, *stack;
    int32_t pending_count, touched_count, candidate_count, coarser_count;
} pel_front;

/* A front without marks: its surface is the base. The forest has to live as long. Errors: PEL_OUT_OF_MEMORY. */
pel_status pel_front_create(const pel_lod_forest *forest, pel_front **front, pel_error *error);
void pel_front_destroy(pel_front *front);

/* ---- an event: any number of marks, then close, then commit ---- */

/* Asks that a node be refined, or not any more. Nodes of the finest level cannot be. */
void pel_front_mark(pel_front *front, int32_t node, bool marked);
/* The same for all triangles around vertex v on level - 1, so that they reach `level`. Does nothing if the vertex does
   not exist below `level`. */
void pel_front_mark_vertex(pel_front *front, int32_t v, int32_t level, bool marked);

/* Finds the red nodes of the present marks. Returns the number of triangles that the surface will have; more marks may
   be set or taken away, and close called again, before the commit. */
int32_t pel_front_close(pel_front *front);
/* Makes the closed front the surface and lists the changes. */
void pel_front_commit(pel_front *front);

/* ---- questions ---- */

int32_t pel_front_level(const pel_front *front, int32_t node);
static inline bool pel_front_is_green(uint8_t shape)
{
    return shape >= PEL_FRONT_BISECTED && shape < PEL_FRONT_RED;
}
bool pel_front_is_marked(const pel_front *front, int32_t node);
static inline bool pel_front_has_vertex(const pel_front *front, int32_t v)
{
    return front->index_in_front[v] >= 0;
}
static inline int32_t pel_front_parent(const pel_front *front, int32_t level, int32_t node)
{
    return front->node_begin[level - 1] + pel_lod_parent(node - front->node_begin[level]);
}

/* The triangles of the surface at an active vertex, counter-clockwise; on the boundary from its first edge to its last
   one. At most twice the number on the vertex's own level. Returns their number. */
int32_t pel_front_fan(const pel_front *front, int32_t v, pel_front_corner *fan);
/* The two vertices of an active edge. */
void pel_front_edge_ends(const pel_front *front, int32_t edge, int32_t ends[2]);

/* All triangles of the surface (triangle_count) in an order that depends on the marks alone: the order of the base,
   each refined triangle replaced by its children. Without marks these are the base's triangles. */
void pel_front_surface(const pel_front *front, pel_front_triangle *triangles);

/* Checks the whole structure against the rules and its lists against each other (front_check.c). Takes time and memory
   in proportion to the forest; true as well when out of memory. */
bool pel_front_is_valid(const pel_front *front);

#endif
