/* What each vertex of a load takes of its force. A force in total is spread evenly over the region that its vertices
   make up, as linear elements have it: over its tetrahedra, its triangles, its part of the border, or its edges; the
   first of these with all vertices of the region, else the triangles or tetrahedra around them. Vertices without any
   edge between them have equal parts. */
#ifndef PEL_BOUNDARY_SHARE_H
#define PEL_BOUNDARY_SHARE_H

#include "model/model.h"
#include "pellicle/load.h"

/* Multiplies the weights of the vertices that a load in total or per vertex names (vertex_count, or all of the mesh) by
   their shares: of a force in total their sum is 1, else each has 1. Copies of a vertex that was cut have its share by
   the areas around them, like its mass; a vertex that is named twice has it once. PEL_OUT_OF_MEMORY. */
pel_status pel_load_share(const pel_model *given, const pel_load_def *def, double *weights, pel_error *error);

#endif
