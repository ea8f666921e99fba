/* Moments on boundary edges: loads on the rotations of mid-edge bending. */
#ifndef PEL_BOUNDARY_EDGE_LOAD_H
#define PEL_BOUNDARY_EDGE_LOAD_H

#include "stage/stage.h"

/* Lists the edges of loads of PEL_LOAD_MOMENT. PEL_BAD_ARGUMENT for a method or body without rotations of edges, or no
   edge; PEL_OUT_OF_MEMORY. */
pel_status pel_edge_loads_create(pel_sim *sim, const pel_sim_def *def, pel_error *error);
void pel_edge_loads_destroy(pel_sim *sim);

/* the product of the moments of a load with numbers on edges */
double pel_edge_load_product(const pel_sim *sim, int32_t load, pel_span span, const double *turns);
/* Adds the moments [N m] of a span to the loads of edges (edge_count). */
void pel_edge_loads_add(const pel_sim *sim, pel_span span, double *moments);
/* Adds the work of moments over turns of edges (edge_count) in a run at a span. */
void pel_edge_loads_add_work(pel_sim *sim, pel_span span, const double *turns);

#endif
