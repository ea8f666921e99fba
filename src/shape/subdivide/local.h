/* A mesh that is finer at some places: the front of its levels of detail, as a mesh of its own. Vertices keep their
   places and numbers; new ones follow. Triangles between two levels are bisected. */
#ifndef PEL_SUBDIVIDE_LOCAL_H
#define PEL_SUBDIVIDE_LOCAL_H

#include "pellicle/mesh.h"

typedef struct pel_local_def {
    /* whether to divide a triangle of a level, which has the longest edge and the centre */
    bool (*divides)(const void *user, int32_t level, double edge, const double center[3]);
    const void *user;
    int32_t depth;       /* levels above the mesh, up to 12 */
    size_t memory_limit; /* bytes of the levels; fewer are made where they would take more */
} pel_local_def;

/* Fields are interpolated in their range. Errors: as pel_lod_forest_create. On failure *fine is null. */
pel_status pel_mesh_subdivide_locally(const pel_mesh *mesh, const pel_local_def *def, pel_mesh **fine,
                                      pel_error *error);

#endif
