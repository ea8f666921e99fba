/* Meshes that were cut: what a vertex or an edge was before it was divided, and the share that each part has. Numbers
   of a vertex (mass, stiffness, damping, load) are divided by the areas around its parts, the stiffness of a spring on
   an edge by the areas beside its two lips. So sums stay as they were before the cut. */
#ifndef PEL_MODEL_ORIGIN_H
#define PEL_MODEL_ORIGIN_H

#include "pellicle/model.h"
#include "pellicle/topology.h"

/* PEL_BAD_ARGUMENT with the body and the vertex. */
pel_status pel_origins_check(const pel_body_def *def, int32_t body, pel_error *error);

/* The vertex before all cuts that a vertex of the body was. */
static inline int32_t pel_origin_of(const pel_body_def *def, int32_t vertex)
{
    return def->origins != NULL ? def->origins[vertex] : vertex;
}

/* The vertices before all cuts: copies come after them. */
int32_t pel_origins_base_count(const pel_body_def *def);

/* The share of each vertex (vertex_count) and each half-edge (3 triangle_count) in what it was, 1 where nothing was
   cut; areas (vertex_count) are those around the vertices. PEL_OUT_OF_MEMORY. */
pel_status pel_origins_find_shares(const pel_body_def *def, const pel_topology *topology, const double *areas,
                                   double *shares, double *lip_shares, pel_error *error);

#endif
