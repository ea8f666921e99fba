/* Pellicle: triangle surface meshes, their checks, repair and topology, and generated shapes.
   Index letters: v vertex, t triangle, e edge, h half-edge. All indices count from 0. */
#ifndef PELLICLE_MESH_H
#define PELLICLE_MESH_H

#include "base.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A named quantity on the vertices: thickness, stiffness, region weight, ... */
typedef struct pel_field {
    char name[PEL_NAME_SIZE];
    int32_t component_count; /* 1 = scalar, 3 = vector */
    double *values;          /* (vertex_count x component_count) */
} pel_field;

/* An indexed triangle mesh: plain arrays, owned by the mesh. Read them directly; do not change them after creation.
   Positions are in metres, unless the file or the caller uses another unit; triangles are counter-clockwise seen from
   outside. */
typedef struct pel_mesh {
    int32_t vertex_count;
    int32_t triangle_count;
    int32_t field_count;
    double (*positions)[3];  /* (vertex_count x 3) */
    int32_t (*triangles)[3]; /* (triangle_count x 3), each 0 .. vertex_count - 1 */
    pel_field *fields;       /* (field_count) */
    /* of a mesh that is filled (pel_mesh_fill in pellicle/volume.h), else 0 and null */
    int32_t tetrahedron_count;
    int32_t (*tetrahedra)[4]; /* (tetrahedron_count x 4), of positive volume: seen from the fourth corner the first
                                 three are clockwise. The triangles are their outer faces; vertices inside, which no
                                 triangle has, come last */
} pel_mesh;

/* Copies positions (vertex_count x 3) and triangles (triangle_count x 3) into a new mesh.
   Refuses NaN, infinity, indices out of range and counts below 1 (PEL_BAD_ARGUMENT with the element).
   The topology is not checked: see pel_mesh_check. On failure *mesh is null. Free with pel_mesh_destroy. */
PEL_API pel_status pel_mesh_create(const double *positions, int32_t vertex_count, const int32_t *triangles,
                                   int32_t triangle_count, pel_mesh **mesh, pel_error *error);

/* Frees a mesh and its fields; null is permitted. */
PEL_API void pel_mesh_destroy(pel_mesh *mesh);

/* Adds (or replaces) the field `name`; values (vertex_count x component_count) are copied, null means zeros. Use it
   right after creation, before other code reads the mesh. */
PEL_API pel_status pel_mesh_add_field(pel_mesh *mesh, const char *name, int32_t component_count, const double *values,
                                      pel_error *error);

/* The field with this name, or null. Lives as long as the mesh. */
PEL_API const pel_field *pel_mesh_field(const pel_mesh *mesh, const char *name);

/* Corners of the box along the axes around all vertices, in units of the mesh; of no mesh infinity and
   -infinity. */
PEL_API void pel_mesh_box(const pel_mesh *mesh, double low[3], double high[3]);

/* The map x -> rotation (scale x) + translation. */
typedef struct pel_transform {
    double scale[3];       /* factor along each axis, not 0; an odd number of negative ones mirrors */
    double rotation[4];    /* quaternion x, y, z, w, normalized when used */
    double translation[3]; /* m */
} pel_transform;

/* Scale 1, no rotation, no translation. */
PEL_API pel_transform pel_transform_default(void);

/* Moves all vertices; use it right after creation. Fields do not change. A transform that mirrors also reverses the
   winding of the triangles, so their outer side stays outside. PEL_BAD_ARGUMENT (mesh unchanged): a number that is NaN
   or infinite, a zero scale or rotation, a vertex that would not be finite. */
PEL_API pel_status pel_mesh_transform(pel_mesh *mesh, const pel_transform *transform, pel_error *error);

#ifdef __cplusplus
}
#endif
#endif
