/* Pellicle: supports of vertices and edges. */
#ifndef PELLICLE_SUPPORT_H
#define PELLICLE_SUPPORT_H

#include "quantity.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A support of vertices: holds components of their positions, rigidly or by springs, and the rotation of edges. For the
   methods static and implicit. Pins and grasps take precedence. */
typedef struct pel_support_def {
    const char *name;
    int32_t body;            /* one that does not refine */
    const int32_t *vertices; /* (vertex_count) of the mesh; copied */
    int32_t vertex_count;
    double axes[3][3];      /* rows are orthonormal axes; default: x, y, z */
    bool fix[3];            /* held components along the axes; default: all */
    double displacement[3]; /* m, along the axes, from the rest position; of held components */
    double foundation;   /* N/m3, Winkler foundation: springs of this stiffness per rest area of the triangles with all
                            corners among the vertices, a third for each corner; replaces stiffness; 0 = none */
    const pel_key *keys; /* (key_count) factor on the displacement over time; null = 1 */
    int32_t key_count;
    double stiffness;  /* N/m of each vertex: springs hold the components; 0 = rigid */
    bool fix_rotation; /* edges with both ends among the vertices keep their normals (PEL_BENDING_MIDEDGE): an edge
                          held in space is clamped, one in a plane of symmetry keeps the surface normal to it */
} pel_support_def;

PEL_API pel_support_def pel_support_def_default(void);

#ifdef __cplusplus
}
#endif
#endif
