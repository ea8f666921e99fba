/* Pellicle: forces on the vertices of a body. */
#ifndef PELLICLE_LOAD_H
#define PELLICLE_LOAD_H

#include "quantity.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Meaning of a load's force. */
typedef enum pel_load_kind {
    PEL_LOAD_TOTAL, /* N, spread evenly over the tetrahedra, triangles, boundary edges or other edges whose vertices
                       it has all: the first of these with all of its vertices, else over the triangles or
                       tetrahedra around them; equal parts for vertices that no edge joins */
    PEL_LOAD_PER_VERTEX, /* N on each vertex */
    PEL_LOAD_PER_LENGTH, /* N/m at rest, on boundary edges with both ends among them; half of each edge to each end */
    PEL_LOAD_MOMENT /* N m per metre of these edges: the component of `force` along each rest edge turns the surface
                       about the edge. For static and implicit with PEL_BENDING_MIDEDGE, on edges that keep
                       their direction */
} pel_load_kind;

/* A force on vertices during an interval of time. */
typedef struct pel_load_def {
    const char *name; /* nullable */
    int32_t body;
    pel_load_kind kind;
    double force[3];
    bool follower; /* PEL_LOAD_PER_LENGTH: the force rotates with each edge and its triangle, relative to rest;
                      quasi-static and descent hold it at its value from the start of the step. It has no potential, so
                      paths, modes and derivatives refuse it */
    const int32_t *vertices; /* (vertex_count); null = all vertices of the body */
    int32_t vertex_count;
    const double *weights; /* (vertex_count) factor per vertex (falloff); null = 1 */
    double from, until;    /* s; acts while from <= t < until */
    const pel_key *keys;   /* (key_count) factor over time; nullable */
    int32_t key_count;
} pel_load_def;

PEL_API pel_load_def pel_load_def_default(void);

#ifdef __cplusplus
}
#endif
#endif
