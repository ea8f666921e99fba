/* Meshes for code that fills the arrays itself. */
#ifndef PEL_MESH_ALLOCATE_H
#define PEL_MESH_ALLOCATE_H

#include "pellicle/mesh.h"

/* A mesh of zeros without fields, or null when out of memory. Counts may be 0. */
pel_mesh *pel_mesh_allocate(int32_t vertex_count, int32_t triangle_count);

#endif
