/* A mesh that is finer at some places: the front of its levels of detail, as a mesh of its own. Vertices keep their
   places and numbers; new ones follow. Triangles between two levels are bisected. */
#ifndef PEL_SUBDIVIDE_LOCAL_H
#define PEL_SUBDIVIDE_LOCAL_H

#include "pellicle/mesh.h"

typedef struct pel_local_def {
    /* whether to divide a triangle of a level (forest.h), which has the longest edge and the centre */
    bool (*divides)(const void *user, int32_t level, int32_t triangle, double edge, const double center[3]);
    const void *user;
    bool is_flat;  /* new vertices and their fields are the means of edges: the surface keeps its shape and area */
    int32_t depth; /* levels above the mesh, up to 12 */
    size_t memory_limit; /* bytes of the levels; fewer are made where they would take more */
    bool all_levels;     /* PEL_BAD_ARGUMENT where they would */
} pel_local_def;

/* Fields are interpolated in their range. Errors: as pel_lod_forest_create. On failure *fine is null. */
pel_status pel_mesh_subdivide_locally(const pel_mesh *mesh, const pel_local_def *def, pel_mesh **fine,
                                      pel_error *error);

#endif
