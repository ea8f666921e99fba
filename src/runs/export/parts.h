/* Bodies and tools of an exported mesh, one after the other. */
#ifndef PEL_EXPORT_PARTS_H
#define PEL_EXPORT_PARTS_H

#include "pellicle/mesh.h"

/* a body or a tool */
typedef struct pel_export_part {
    size_t vertex_begin, vertex_count; /* in the order of parts */
    size_t index_begin, index_count;
} pel_export_part;

typedef struct pel_export_parts {
    int32_t count;
    pel_export_part *parts; /* (count) */
    int32_t *part_of;       /* (vertex_count) of the mesh */
    int32_t *place;         /* (vertex_count) of each vertex, parts one after the other */
    uint32_t *indices;      /* (3 x triangle_count) by parts, numbered within each */
} pel_export_parts;

/* Sorts vertices and triangles by the field `body`, invalid numbers first. Where a triangle has corners in two parts,
   or a number has no vertices or triangles, all is one part. Free also on failure. Errors: PEL_OUT_OF_MEMORY. */
pel_status pel_export_parts_create(const pel_mesh *mesh, pel_export_parts *parts, pel_error *error);
void pel_export_parts_free(pel_export_parts *parts);

/* Unit normals (vertex_count x 3), weighted by area; up where a vertex has none. */
void pel_export_normals(const pel_mesh *mesh, double (*normals)[3]);

#endif
