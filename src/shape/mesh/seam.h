/* Seams: borders that lie on each other, where a file gives vertices twice because texture coordinates, normals
   or colours differ. */
#ifndef PEL_MESH_SEAM_H
#define PEL_MESH_SEAM_H

#include "pellicle/mesh.h"

/* What became of the edges that borders share. */
typedef struct pel_seams {
    int32_t closed_count; /* edges that were sewn */
    int32_t open_count;   /* places of edges where no single pair fits: three borders or more, or two that run alike */
} pel_seams;

/* Numbers the vertices so that the two sides of a seam get the same numbers: index_of (vertex_count) in order of first
   appearance, count of numbers. Two edges on the border of the surface are a seam when their ends are exactly equal,
   they run against each other, and no third one lies there. Vertices that merely touch stay apart, and so do closed
   surfaces that share a face. Where sewing would leave an edge with three triangles or a triangle with a vertex twice,
   nothing is sewn. tolerance: 0 = exactly equal; otherwise as in pel_weld_points. triangles (triangle_count x 3) with
   indices in range. PEL_OK or PEL_OUT_OF_MEMORY. */
pel_status pel_seams_find(const double (*positions)[3], int32_t vertex_count, const int32_t (*triangles)[3],
                          int32_t triangle_count, double tolerance, int32_t *index_of, int32_t *count,
                          pel_seams *seams);

/* Borders this far apart belong together: a share of the size of the mesh, PEL_SEAM_SHARE as far as files round
   coordinates, and at most a tenth of its shortest edge; 0 = exactly equal where coordinates do not resolve that. */
#define PEL_SEAM_SHARE 1e-6
double pel_seams_tolerance(const pel_mesh *mesh, double share);

/* Welds the seams of a mesh within that tolerance, with a note in log (nullable) of what was welded and of what stays
   open. Positions and fields are those of the first vertex. seams is nullable. index_of: nullable; receives a block
   (vertex_count before), the new number of each vertex; to be freed with pel_free; null where nothing was welded. Right
   after creation only. */
pel_status pel_seams_weld(pel_mesh *mesh, int32_t **index_of, const pel_log *log, pel_error *error);

#endif
