/* Pellicle: regions: the vertices of a mesh that a load or property acts on, with weights. */
#ifndef PELLICLE_REGION_H
#define PELLICLE_REGION_H

#include "mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum pel_region_kind {
    PEL_REGION_ALL,      /* every vertex */
    PEL_REGION_NEAREST,  /* the vertex nearest to `point` (the first of several) and, with falloff, those around it */
    PEL_REGION_SPHERE,   /* within `radius` of `center` */
    PEL_REGION_BOX,      /* low <= position <= high */
    PEL_REGION_VERTICES, /* the listed vertices */
    PEL_REGION_FIELD,    /* where the scalar field `field` is greater than `above` */
    PEL_REGION_BOUNDARY, /* the vertices on the boundary of an open mesh, or on one of its loops */
    PEL_REGION_PLANE     /* on the side of a plane to which its normal points, and on the plane */
} pel_region_kind;

/* A region. Members of other kinds are ignored. Pointers must be valid only during the call. */
typedef struct pel_region {
    pel_region_kind kind;
    double point[3];         /* m, nearest; plane: a point of it */
    double normal[3];        /* plane; of any length but 0 */
    double center[3];        /* m, sphere */
    double radius;           /* m, sphere, >= 0 */
    double low[3], high[3];  /* m, box, low <= high */
    const int32_t *vertices; /* (vertex_count) vertices; duplicates are allowed */
    int32_t vertex_count;
    const char *field; /* name of a scalar field of the mesh */
    double above;      /* field; 0.5 by default */
    int32_t loop;      /* boundary: the loop of this number, from 0, the longest first; -1 (default) = all */
    double
        falloff; /* m, >= 0; nearest, sphere, box and plane only: outside the region, up to this distance from it, the
                    weight falls smoothly from 1 to 0 (cubic, with slope 0 at both ends). The distance is measured
                    along a straight line in space to the sphere, the box, the plane or the nearest vertex */
    uint32_t cookie; /* set by pel_region_default */
} pel_region;

/* All vertices: kind PEL_REGION_ALL, no falloff. */
PEL_API pel_region pel_region_default(void);

/* The vertices of a region in ascending order. */
typedef struct pel_selection {
    int32_t count;
    int32_t *vertices; /* (count) */
    double *weights;   /* (count) 1 inside, less in the falloff; > 0 */
} pel_selection;

/* Finds the vertices of a region in linear time. PEL_BAD_ARGUMENT: the region contains no vertex (the message has the
   nearest vertex and its distance, or the range of the field), a number out of range, a vertex or field that does not
   exist, a vector field. On failure *selection is null. Free with pel_selection_destroy. */
PEL_API pel_status pel_mesh_select(const pel_mesh *mesh, const pel_region *region, pel_selection **selection,
                                   pel_error *error);

/* Frees a selection; null is permitted. */
PEL_API void pel_selection_destroy(pel_selection *selection);

#ifdef __cplusplus
}
#endif
#endif
