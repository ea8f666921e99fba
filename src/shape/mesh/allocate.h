/* Meshes for code that fills the arrays itself. */
#ifndef PEL_MESH_ALLOCATE_H
#define PEL_MESH_ALLOCATE_H

#include "pellicle/mesh.h"

/* A mesh of zeros without fields, or null when out of memory. Counts may be 0. */
pel_mesh *pel_mesh_allocate(int32_t vertex_count, int32_t triangle_count);

/* Gives a copy of a mesh, which has the same vertices and no tetrahedra, those of the mesh. PEL_OUT_OF_MEMORY. */
pel_status pel_mesh_copy_tetrahedra(const pel_mesh *mesh, pel_mesh *copy, pel_error *error);

#endif
