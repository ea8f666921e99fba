/* Pellicle: modified butterfly subdivision (Zorin, Schroeder, Sweldens 1996), paper A section 3.1. It interpolates:
   existing vertices do not move, each edge gets a new vertex, and each triangle becomes four. */
#ifndef PELLICLE_SUBDIVIDE_H
#define PELLICLE_SUBDIVIDE_H

#include "mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct pel_subdivide_def {
    int32_t levels;      /* number of levels; each level splits every triangle into four. 0 = a copy */
    bool clamp_fields;   /* true (default): clamps new values of a field to the range of the component on the mesh, so
                            a thickness stays positive and a weight within 0 .. 1 */
    size_t memory_limit; /* bytes, including the result; default: 2 GiB; 0 = no limit */
    uint32_t cookie;     /* set by pel_subdivide_def_default */
} pel_subdivide_def;

/* One level, clamped fields. */
PEL_API pel_subdivide_def pel_subdivide_def_default(void);

/* Subdivides with the defaults above. */
PEL_API pel_status pel_mesh_subdivide(const pel_mesh *mesh, int32_t levels, pel_mesh **fine, pel_error *error);

/* Subdivides an oriented manifold, with or without boundary, of any valence.
   Numbering: the vertices of the mesh come first, then one vertex per edge in the order of pel_topology's edges, level
   by level. Triangle t of a level becomes 4 t + i at corner i and 4 t + 3 in the middle, whose corner i is the new
   vertex of the edge from corner i to corner i + 1. Winding is kept; fields are interpolated by the same stencils.

   Position of a new vertex. If both ends of its edge have six triangles or are on the boundary: from the eight points
   around the edge (weights 1/2, 1/8, -1/16); a point that is missing beyond a boundary edge p q of a triangle p q r is
   p + q - r. If an inner end has another number of triangles: from the ring of this end (mean of both rings if both
   ends are irregular). On a boundary edge: from the four nearest boundary vertices (-1/16, 9/16, 9/16, -1/16), so
   patches with a common boundary stay joined.

   Errors: PEL_BAD_ARGUMENT for negative levels and for results beyond memory_limit or 2^31 half-edges, with the
   numbers; PEL_BAD_MESH as pel_topology_create; PEL_OUT_OF_MEMORY. On failure *fine is null. Linear time. */
PEL_API pel_status pel_mesh_subdivide_with(const pel_mesh *mesh, const pel_subdivide_def *def, pel_mesh **fine,
                                           pel_error *error);

#ifdef __cplusplus
}
#endif
#endif
