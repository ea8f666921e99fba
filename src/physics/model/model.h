/* Internals of the model: immutable arrays laid out for the force loops. Vertices of all bodies are in one order: body
   after body, within a body by breadth-first order over the edges (so that neighbours are close in memory), padded to
   whole slices of PEL_WIDTH. Springs are in "sliced ELLPACK" form: slot s of a slice holds one spring of each of its
   vertices; vertices with fewer springs are padded with springs to themselves, which give no force. Each spring is
   stored at both ends: a vertex gathers its whole force alone, nothing is scattered, and the sum has the same order for
   any number of threads. */
#ifndef PEL_MODEL_MODEL_H
#define PEL_MODEL_MODEL_H

#include "base/assert.h"
#include "base/wide.h"
#include "def/copy.h"
#include "def/fingerprint.h"
#include "pellicle/model.h"
#include "rigid/rigid.h"
#include "subdivide/front.h"

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

/* numbers of a vertex that are proportional to area */
typedef struct pel_nodal {
    double mass, damping, volumetric_stiffness, volumetric_damping;
} pel_nodal;

/* Levels of detail of a body (levels.h). */
typedef struct pel_body_levels {
    pel_refine_def def; /* its region is the copy below */
    int32_t *region;
    pel_lod_forest *forest;
    double *areas;        /* (base triangles) rest area */
    double *vertex_areas; /* (base vertices) of the triangles around */
    pel_nodal *densities; /* (vertices of the finest level) over the area of the triangles around */
    double *stiffnesses;  /* (base edges) as given */
    double *moduli; /* (base edges) stiffness = sum of modulus x area / squared length over the triangles at the edge */
    uint8_t *pinned; /* (vertices of the finest level) 1 = never moves */
} pel_body_levels;

typedef struct pel_shell pel_shell;

typedef struct pel_body {
    char name[PEL_NAME_SIZE];
    pel_mesh *mesh;                 /* at rest */
    double (*start)[3];             /* (mesh vertex_count) where it starts; null = at rest */
    int32_t slice_begin, slice_end; /* its slices; vertices are PEL_WIDTH times that */
    int32_t *model_index;           /* (mesh vertex_count) place of a mesh vertex in the model's order */
    double *shares;     /* (mesh vertex_count) of each vertex in what it was before cuts (origin.h); null = no cuts */
    double *lip_shares; /* (3 mesh triangle_count) of a half-edge in the edge that it was; likewise */
    bool has_volumetric;
    bool is_foundation; /* its volumetric springs follow from a material: by area over depth */
    bool closed;
    bool has_volume;      /* it is closed and not flat at rest */
    int32_t turned_count; /* triangles of the mesh as given that were inside out */
    double rest_volume, rest_area;
    double diameter;                         /* diagonal of the rest bounding box */
    double velocity[3], angular_velocity[3]; /* m/s, rad/s: at the start */
    double friction;                         /* Coulomb's coefficient; below 0: the value of contact */
    double restitution;                      /* below 0: that of contact */
    double contact_thickness;                /* m; below 0: the value of contact */
    double uniform_spring; /* stiffness of every spring, when model->stiffnesses is not used for this body; else -1 */
    double plain_spring;   /* the same in slices that are plain */
    double fluid_density, fluid_level; /* kg/m3, 0 = none; m against gravity, HUGE_VAL = it fills the closed body */
    double fluid_share;                /* of each mass that is the filling */
    double spring_retardation;         /* s: viscous over elastic force of springs, by the rate of their lengths */
    pel_curve curves[PEL_PARAMETER_COUNT];
    pel_body_levels *detail; /* null = no refinement */
    pel_shell *shell;        /* (shell.h) null = no membrane, bending, fibres or pressure */
    pel_rigid_shape *rigid;  /* null = deformable */
    const pel_front *front;  /* the surface, in an active model (refined_model.h) of a body with detail; else null */
} pel_body;

/* whether it has a velocity at the start */
static inline bool pel_body_moves(const pel_body *body)
{
    for (int k = 0; k < 3; k++)
        if (body->velocity[k] != 0 || body->angular_velocity[k] != 0)
            return true;
    return false;
}

/* of a vertex of the mesh, and of a half-edge, in what they were before cuts */
static inline double pel_vertex_share(const pel_body *body, int32_t v)
{
    return body->shares != NULL ? body->shares[v] : 1;
}
static inline double pel_lip_share(const pel_body *body, int32_t half_edge)
{
    return body->lip_shares != NULL ? body->lip_shares[half_edge] : 1;
}
/* whether a half-edge without twin is a lip, and no border of the mesh before it was cut */
static inline bool pel_is_lip(const pel_body *body, int32_t half_edge)
{
    return pel_lip_share(body, half_edge) < 1;
}

struct pel_model {
    int32_t body_count;
    pel_body *bodies;
    double gravity[3];
    pel_fingerprint fingerprint; /* of the def */
    pel_model_def def;           /* a copy with the bodies' own meshes; empty in an active model */
    pel_copies copies;           /* their arrays */

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
    uint8_t *plain_slices;        /* (slice_count) of an active model: 1 = no vertex is off the base; else null */
    int32_t *mesh_vertex;         /* (vertex_count) number in the body's mesh, -1 = padding */

    /* by slot */
    int32_t *slot_begin; /* (slice_count + 1) */
    int32_t *slot_end;   /* (slice_count) at least one slot in each; an active model has spare slots after it */
    int32_t (*neighbours)[PEL_WIDTH]; /* (slot_count) */
    pel_wide *rest_lengths;           /* (slot_count) null where no body has springs: pel_model_rest_length */
    pel_wide *stiffnesses;            /* (slot_count), null when every body has a uniform one */
    pel_wide *products;               /* (slot_count) stiffness x rest length, null likewise */

    /* by triangle of all bodies, in model vertex order */
    int32_t (*triangles)[3];
    int32_t *triangle_begin; /* (body_count + 1) */
    /* triangles at a vertex, for the tools */
    int32_t *fan_begin; /* (vertex_count + 1) */
    int32_t *fans;      /* (3 triangle_count) */
};

/* past the last place of a body, including places unused while it is coarse */
static inline int32_t pel_body_place_end(const pel_model *model, int32_t body)
{
    PEL_ASSERT_INDEX(body, model->body_count);
    int32_t end = model->bodies[body].slice_end;
    if (model->bodies[body].front != NULL)
        end = body + 1 < model->body_count ? model->bodies[body + 1].slice_begin : model->slice_count;
    return end * PEL_WIDTH;
}

/* The arrays by vertex, slice and triangle, for the counts of the model; false if out of memory. Free with
   pel_model_free_arrays, also on failure. */
bool pel_model_allocate(pel_model *model);
/* Properties of the springs of a model. */
typedef enum pel_spring_room {
    PEL_SPRINGS_OFF,     /* which vertices are neighbours */
    PEL_SPRINGS_UNIFORM, /* rest lengths too */
    PEL_SPRINGS_OWN      /* and stiffnesses */
} pel_spring_room;
/* Those by slot, for the slots up to slot_begin[slice_count], and fans. */
bool pel_model_allocate_slots(pel_model *model, pel_spring_room room, int32_t fan_count);
/* All of them; names, meshes and the like belong to the bodies. */
void pel_model_free_arrays(pel_model *model);

/* Recomputes all arrays of numbers after the caller has changed numbers of model->def; the order of vertices and the
   springs stay. The result has the same bits as that of pel_model_create. False if the model must be created anew: it
   has a shell, levels of detail or springs of several stiffnesses, needs other arrays, or the numbers are refused. It
   must be destroyed then. */
bool pel_model_refill(pel_model *model);

/* Stiffness of the spring on an edge of the body's mesh [N/m], but for cuts; of keyed springs that at the factor 1. */
double pel_model_rest_stiffness(const pel_body_def *def, const pel_topology *topology, int32_t edge);

/* by the very operations of the force loop */
static inline pel_real pel_model_distance_at_rest(const pel_model *model, int32_t i, int32_t j)
{
    pel_record d = model->rest[j] - model->rest[i];
    return pel_sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2] + PEL_REAL_TINY);
}

/* Rest length of the spring, or of the edge, in a slot of place i. */
static inline pel_real pel_model_rest_length(const pel_model *model, int32_t slot, int32_t i)
{
    PEL_ASSERT_INDEX(slot, model->slot_begin[model->slice_count]);
    return model->rest_lengths != NULL ? model->rest_lengths[slot][i % PEL_WIDTH]
                                       : pel_model_distance_at_rest(model, i, model->neighbours[slot][i % PEL_WIDTH]);
}

/* Writes the spring from place i to j into a slot of i; from i to itself, with stiffness 0, it pads the slot. The rest
   length is computed by the same operations as in the force loop, and the stiffness, in its last bit, by the product:
   so the rest shape is free of force to the last bit. */
static inline void pel_model_set_spring(pel_model *model, int32_t slot, int32_t i, int32_t j, double stiffness)
{
    PEL_ASSERT_INDEX(slot, model->slot_begin[model->slice_count]);
    pel_real length = pel_model_distance_at_rest(model, i, j);
    int32_t lane = i % PEL_WIDTH;
    model->neighbours[slot][lane] = j;
    if (model->rest_lengths != NULL)
        model->rest_lengths[slot][lane] = length;
    if (model->stiffnesses == NULL)
        return;
    pel_real product = (pel_real)stiffness * length;
    model->products[slot][lane] = product;
    model->stiffnesses[slot][lane] = product / length;
}

/* The triangles of a body's surface: their number, and which of model->triangles is the i-th. With refinement the
   triangle of a node and half has the fixed number 2 node + half in its body, so that it can be named over events. */
static inline int32_t pel_surface_count(const pel_model *model, int32_t body)
{
    PEL_ASSERT_INDEX(body, model->body_count);
    const pel_front *front = model->bodies[body].front;
    return front != NULL ? front->triangle_count : model->triangle_begin[body + 1] - model->triangle_begin[body];
}
static inline int32_t pel_surface_number(const pel_front_triangle *triangle)
{
    return 2 * triangle->node + triangle->half;
}
static inline int32_t pel_surface_triangle(const pel_model *model, int32_t body, int32_t i)
{
    PEL_ASSERT_INDEX(body, model->body_count);
    const pel_front *front = model->bodies[body].front;
    return model->triangle_begin[body] + (front != NULL ? pel_surface_number(&front->triangles[i]) : i);
}

/* largest factor that a keyed parameter takes */
double pel_curve_largest(const pel_curve *curve);
/* value of a curve at a time: linear between keys, constant outside; 1 without keys */
double pel_curve_value(const pel_key *keys, int32_t key_count, double time);

/* When keyed loads act: at a time, or by their mean from `back` before it to `ahead` after it. Extrapolated: what means
   over two steps of that length, up to the time, lead to at the time. */
typedef struct pel_span {
    double time, back, ahead; /* s */
    bool extrapolates;
} pel_span;

static inline pel_span pel_instant(double time)
{
    return (pel_span){.time = time};
}

/* mean value of a curve over a span, counted as 0 outside of from <= time < until */
double pel_curve_mean(const pel_key *keys, int32_t key_count, pel_span span, double from, double until);

#endif
