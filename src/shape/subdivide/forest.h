/* All levels of detail of a body, built once before simulation (paper A section 3.3, offline stage): one quadtree per
   base triangle by index arithmetic, and one array of rest positions for all levels, as a vertex keeps its number on
   all finer levels.

   Triangle t of level l has the children 4 t .. 4 t + 3 on level l + 1 and the parent t >> 2 on level l - 1; edge e of
   level l has the midpoint vertex levels[l]->vertex_count + e. split.h has the half-edges of a child. */
#ifndef PEL_SUBDIVIDE_FOREST_H
#define PEL_SUBDIVIDE_FOREST_H

#include "base/assert.h"
#include "subdivide/butterfly.h"

#include "pellicle/mesh.h"

enum { PEL_LOD_DEPTH_LIMIT = 12 };

/* Immutable once created. */
typedef struct pel_lod_forest {
    int32_t depth;                                 /* levels above the base */
    pel_topology *levels[PEL_LOD_DEPTH_LIMIT + 1]; /* levels[0] is the base, levels[depth] the finest */
    double (*rest_positions)[3]; /* (levels[depth]->vertex_count x 3); rows of coarser levels come first */
} pel_lod_forest;

/* Builds base and `depth` levels by modified butterfly. PEL_BAD_ARGUMENT with the numbers when depth is negative,
   beyond PEL_LOD_DEPTH_LIMIT, or when the forest would take more than memory_limit bytes (0 = no limit) or 2^31
   half-edges; PEL_BAD_MESH as pel_topology_create. Free with pel_lod_forest_destroy. */
pel_status pel_lod_forest_create(const pel_mesh *mesh, int32_t depth, size_t memory_limit, pel_lod_forest **forest,
                                 pel_error *error);
void pel_lod_forest_destroy(pel_lod_forest *forest);

/* The bytes of a forest, exactly; about 71 for each triangle of its finest level. SIZE_MAX when it is too large to be
   numbered. */
size_t pel_lod_forest_bytes(const pel_topology *base, int32_t depth);

/* Interpolates values (levels[depth]->vertex_count x component_count), whose rows of the base's vertices are given, on
   all levels; clamp keeps each component in its range on the base. */
pel_status pel_lod_forest_interpolate(const pel_lod_forest *forest, int32_t component_count, bool clamp, double *values,
                                      pel_error *error);

/* The level on which vertex v appears, 0 for the base's vertices. */
int32_t pel_lod_forest_vertex_level(const pel_lod_forest *forest, int32_t v);

/* The ends of the edge whose midpoint vertex v is, on the level before the one it appears on; false for a vertex of the
   base. */
bool pel_lod_forest_vertex_parents(const pel_lod_forest *forest, int32_t v, int32_t parents[2]);

static inline int32_t pel_lod_parent(int32_t t)
{
    return t >> 2;
}
static inline int32_t pel_lod_child(int32_t t, int32_t i)
{
    return 4 * t + i;
}
static inline int32_t pel_lod_midpoint(const pel_topology *level, int32_t h)
{
    PEL_ASSERT_INDEX(h, 3 * level->triangle_count);
    return level->vertex_count + level->edge_of_half_edge[h];
}

#endif
