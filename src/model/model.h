/* Inside of the model: immutable arrays laid out for the force loops.

   Vertices of all bodies stand in one order: body after body, within a body by breadth-first order over the edges (so
   that neighbours are close in memory), padded to whole slices of PEL_WIDTH. Springs stand in "sliced ELLPACK" form:
   slot s of a slice holds one spring of each of its vertices; shorter vertices are filled up with springs to
   themselves, which give no force. Each spring is stored at both ends: a vertex gathers its whole force alone, nothing
   is scattered, and the sum has the same order for any number of threads. */
#ifndef PEL_MODEL_MODEL_H
#define PEL_MODEL_MODEL_H

#include "base/wide.h"
#include "pellicle/model.h"

/* parameters that may be keyed in time; the state holds the present factor of each */
typedef enum pel_parameter {
    PEL_SPRING_STIFFNESS,
    PEL_SPRING_DAMPING,
    PEL_VOLUMETRIC_STIFFNESS,
    PEL_VOLUMETRIC_DAMPING,
    PEL_PARAMETER_COUNT
} pel_parameter;

typedef struct pel_curve {
    pel_key *keys; /* null = constant 1 */
    int32_t key_count;
} pel_curve;

typedef struct pel_body {
    char name[PEL_NAME_SIZE];
    pel_mesh *mesh;
    int32_t slice_begin, slice_end; /* its slices; vertices are PEL_WIDTH times that */
    int32_t *slot_of_vertex;        /* (mesh vertex_count) place of a mesh vertex in the model's order */
    bool has_volumetric;
    bool closed;
    double rest_volume, rest_area;
    double diameter;       /* diagonal of the rest bounding box */
    double uniform_spring; /* stiffness of every spring, when model->stiffnesses is not used for this body; else -1 */
    pel_curve curves[PEL_PARAMETER_COUNT];
} pel_body;

struct pel_model {
    int32_t body_count;
    pel_body *bodies;
    double gravity[3];

    int32_t vertex_count; /* padded, all bodies */
    int32_t slice_count;
    int32_t triangle_count;

    /* by vertex; padding has no mass, no springs and repeats the body's first vertex */
    pel_record *rest;             /* (vertex_count) rest position, volumetric stiffness */
    pel_real *inverse_mass;       /* (vertex_count) 0 = pinned or padding */
    pel_real *mass;               /* (vertex_count) 0 = padding */
    pel_real *damping;            /* (vertex_count) */
    pel_real *volumetric_damping; /* (vertex_count) */
    int32_t *body_of_slice;       /* (slice_count) */
    int32_t *mesh_vertex;         /* (vertex_count) number in the body's mesh, -1 = padding */

    /* by slot */
    int32_t *slot_begin;              /* (slice_count + 1) */
    int32_t (*neighbours)[PEL_WIDTH]; /* (slot_count) */
    pel_wide *rest_lengths;           /* (slot_count) */
    pel_wide *stiffnesses;            /* (slot_count), null when every body has a uniform one */

    /* by triangle of all bodies, in model vertex order */
    int32_t (*triangles)[3];
    int32_t *triangle_begin; /* (body_count + 1) */
    /* triangles at a vertex, for the tools */
    int32_t *fan_begin; /* (vertex_count + 1) */
    int32_t *fans;      /* (3 triangle_count) */
};

/* value of a curve at a time: linear between keys, constant outside; 1 without keys */
double pel_curve_value(const pel_key *keys, int32_t key_count, double time);

#endif
