/* Modified butterfly stencils: values on the vertices of a level give values on its edges. */
#ifndef PEL_SUBDIVIDE_BUTTERFLY_H
#define PEL_SUBDIVIDE_BUTTERFLY_H

#include "pellicle/topology.h"

/* Vertices that need a special rule: inner, with a number of triangles other than six. New vertices of subdivision are
   regular, so the list of the base serves all levels. Holds scratch: one thread at a time. */
typedef struct pel_butterfly {
    int32_t base_vertex_count;
    int32_t irregular_count;
    int32_t *irregular; /* (irregular_count) ascending */
    int32_t *ring_size; /* (base_vertex_count) triangles around an irregular vertex, 0 for all others */
    int32_t *ring;      /* scratch (ring_limit x 2): vertices and edges around some vertices */
    int32_t ring_limit; /* at least the longest ring */
    double *wave;       /* cosine and sine tables, see butterfly.c */
    int32_t long_ring;  /* size of the ring whose table is the last one */
} pel_butterfly;

pel_status pel_butterfly_create(const pel_topology *base, pel_butterfly **butterfly, pel_error *error);
void pel_butterfly_destroy(pel_butterfly *butterfly);
/* an upper bound of the bytes that pel_butterfly_create takes */
size_t pel_butterfly_bytes(const pel_topology *base);

/* values (vertex_count + edge_count x component_count): fills the row vertex_count + e of each edge e of a level that
   descends from the base (or is it) from the rows of its vertices */
void pel_butterfly_edge_values(pel_butterfly *butterfly, const pel_topology *level, int32_t component_count,
                               double *values);

#endif
