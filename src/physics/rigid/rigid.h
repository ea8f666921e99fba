/* Rigid bodies: six unknowns that own the vertices of a body, which stay in the arrays by vertex like any other's.

   A body turns about its pivot: the center of mass, or, if vertices of it are pinned, the first one of them. With one
   pinned point it swings about that (a ball joint), with several on a line it turns about the line (a hinge), else it
   stands. Its vertices are x = p + R (X - P), with the pivot p now and P at rest. */
#ifndef PEL_RIGID_RIGID_H
#define PEL_RIGID_RIGID_H

#include "base/assert.h"
#include "base/wide.h"
#include "math/record.h"
#include "math/vec3.h"
#include "rigid/inertia.h"

#include <stdbool.h>
#include <stdint.h>

enum { PEL_RIGID_KNOTS = 15 };

/* constant numbers of a body, at rest */
typedef struct pel_rigid_shape {
    double mass, inverse_mass; /* kg; 1/kg of the pivot, 0 where it is pinned */
    double center[3], pivot[3];
    bool is_free;                 /* nothing is pinned */
    bool has_joint, has_axis;     /* it can turn; about an axis alone, a hinge */
    double axis[3];               /* unit, of a hinge */
    double inertia[3][3];         /* kg m2, about the pivot */
    double inverse_inertia[3][3]; /* of the rotations that pins leave */
    double roundness;             /* 1/(kg m2), of a body with the same inertia about all axes, else 0 */
    double radius, middle[3];     /* m, of the sphere about its mesh, if it is a ball; else radius 0 */
} pel_rigid_shape;

typedef struct pel_rigid_state {
    double pivot[3], rotation[4];
    double momentum[3], angular_momentum[3]; /* N s, of a free body; N m s, about the pivot */
    int64_t is_touched;                      /* something pushed it in the last substep */
} pel_rigid_state;

/* one body in a step */
typedef struct pel_rigid {
    const pel_rigid_shape *shape;
    int32_t begin, end; /* its vertices */
    int32_t middle;     /* the place of the middle of a ball, which is no vertex of the mesh; */
    double radius;      /* m, of the sphere about it that collides; 0 = its triangles do */
    pel_rigid_state state;
    double matrix[3][3];          /* the rotation of the state */
    pel_rigid_state started;      /* at the start of the substep */
    pel_rigid_state before;       /* at the start of the step, or of a part of it */
    pel_rigid_state *path;        /* (PEL_RIGID_KNOTS) states between them, at equal times: */
    int32_t path_count;           /* as many, 0 = it went straight */
    double force[3], torque[3];   /* N, N m about the pivot: loads in this substep */
    double impulse[3], moment[3]; /* N s and N m s about the pivot, of all pushes in this substep */
    bool is_fixed;                /* it moves only as it is told in this step: held, or asleep */
    bool is_moved;                /* its vertices are not where it is */
    double unrest;                /* m: all ways that sweeps moved points of it in this substep */
    double way[3], turned[3];     /* m, rad: of the pivot and of the body, by pushes in this substep, or since they */
    int32_t far_turns;            /* began anew in it, as often as this tells */
    bool is_owed;                 /* the state lacks: */
    double owed_turn[3], owed_impulse[3], owed_moment[3]; /* rad, N s, N m s */
} pel_rigid;

/* see rigid/row.h */
typedef struct pel_rigid_row pel_rigid_row;

/* all of a simulation */
typedef struct pel_rigids {
    int32_t count;
    pel_rigid *items;             /* (count) */
    bool are_all;                 /* nothing else is in the simulation */
    int32_t *of_slice;            /* (slices) -1 = the body of the slice is not rigid */
    const pel_record *rest;       /* (vertex_count) */
    const pel_real *inverse_mass; /* (vertex_count) 0 = pinned */
    double rate;                  /* 1/s: impulses over the numbers that move the bodies, 0 = momenta stay */
    pel_rigid_state *path;        /* (count x PEL_RIGID_KNOTS) theirs */
    int32_t substep;              /* of the step */
    pel_rigid_row *rows;          /* (row_count) of contacts that were pushed since rows began anew, as often as */
    int32_t row_count, row_round; /* this tells */
    size_t row_capacity;
} pel_rigids;

/* the rigid body of a vertex; null = none */
static inline pel_rigid *pel_rigid_of(const pel_rigids *rigids, int32_t v)
{
    int32_t i = rigids != NULL ? rigids->of_slice[v / PEL_WIDTH] : -1;
    return i >= 0 ? &rigids->items[i] : NULL;
}

/* m, of the ball that this place is the middle of; 0 = of none that collides as a sphere */
static inline double pel_rigid_radius(const pel_rigids *rigids, int32_t v)
{
    const pel_rigid *rigid = pel_rigid_of(rigids, v);
    return rigid != NULL && rigid->middle == v ? rigid->radius : 0;
}

/* Shape of a body with this inertia, whose vertices `pinned` (pinned_count) of the mesh stay where they are. */
void pel_rigid_shape_set(pel_rigid_shape *shape, const pel_inertia *inertia, const pel_mesh *mesh,
                         const int32_t *pinned, int32_t pinned_count);

/* at rest, with velocities of the center [m/s, rad/s] */
void pel_rigid_state_start(const pel_rigid_shape *shape, const double velocity[3], const double spin[3],
                           pel_rigid_state *state);
/* The place and motion of the center: position, velocity [m/s], angular velocity [rad/s] and angular momentum [N m s]
   about it; each may be null. */
void pel_rigid_center(const pel_rigid_shape *shape, const pel_rigid_state *state, double center[3], double velocity[3],
                      double spin[3], double angular_momentum[3]);
/* J */
double pel_rigid_kinetic_energy(const pel_rigid_shape *shape, const pel_rigid_state *state);

/* takes a state, which becomes the start of a substep */
void pel_rigid_begin(pel_rigid *rigid, const pel_rigid_state *state);
/* Goes back to a share of the way from `before` to a state, which may be its own: places and momenta. */
void pel_rigid_go_back(pel_rigid *rigid, const pel_rigid_state *state, double share);
/* rad, by which a body has turned since `before` */
double pel_rigid_turned(const pel_rigid *rigid);
/* the place of a vertex after a share of the path from `before` to the state now */
void pel_rigid_place_between(const pel_rigid *rigid, const pel_rigids *rigids, int32_t v, double share, double x[3]);
/* Takes the place of its vertices, as far as they are a rigid image of those at rest; masses (vertex_count). */
void pel_rigid_fit(pel_rigid *rigid, const pel_rigids *rigids, const pel_real *masses, const pel_record *positions);
/* The same of positions (3 vertex_count) in double; a body on a hinge that nothing else holds turns about it alone. */
void pel_rigid_fit_to(pel_rigid *rigid, const pel_rigids *rigids, const pel_real *masses, const double *positions,
                      bool is_held);
/* Its vertices, in positions (3 vertex_count), go where it is; those that are pinned stay. */
void pel_rigid_place_in(const pel_rigid *rigid, const pel_rigids *rigids, double *positions);
/* Takes momenta from a motion: of the center [m/s], and angular [rad/s]. */
void pel_rigid_set_motion(pel_rigid *rigid, const double velocity[3], const double spin[3]);
/* the vertices of bodies that have moved go where they are; with velocities, where these are not null */
void pel_rigids_place(pel_rigids *rigids, pel_record *positions);
void pel_rigid_place_velocities(const pel_rigid *rigid, const pel_rigids *rigids, const pel_record *positions,
                                pel_record *velocities);

/* momenta by a force and a torque about the pivot over a time */
void pel_rigid_kick(pel_rigid *rigid, const double force[3], const double torque[3], double time);
/* Moves freely over a time: energy and angular momentum stay to the last digits, for any inertia. */
void pel_rigid_drift(pel_rigid *rigid, double time);

/* A sum of points of a body: weight times the pivot plus an arm, both turn with the body. */
typedef struct pel_rigid_grip {
    pel_rigid *rigid;
    double weight, arm[3];
    double touch[3]; /* of the arm, from the middle of a ball to where it touches */
} pel_rigid_grip;

/* Adds a vertex times a weight, with the arm in the axes of the body; after the last one it turns to where the body is.
 */
static inline void pel_rigid_grip_add(pel_rigid_grip *grip, const pel_rigids *rigids, int32_t v, double weight)
{
    const double *pivot = grip->rigid->shape->pivot;
    grip->weight += weight;
    for (int k = 0; k < 3; k++)
        grip->arm[k] += weight * ((double)rigids->rest[v][k] - pivot[k]);
}

static inline void pel_rigid_grip_turn(pel_rigid_grip *grip)
{
    const double(*m)[3] = (const double(*)[3])grip->rigid->matrix, *a = grip->arm;
    pel_vec3_set(grip->arm, pel_vec3_dot(m[0], a), pel_vec3_dot(m[1], a), pel_vec3_dot(m[2], a));
}

/* how the sum moves by 1 N s2, or 1 N s, on it along a direction */
double pel_rigid_mobility(const pel_rigid_grip *grip, const double direction[3]);
/* Moves the body by an impulse times a time [N s2] on the sum; its momenta change by rate times that. */
void pel_rigid_push(const pel_rigid_grip *grip, const double push[3], double rate);
/* the rotation vector of a moment [N m s2] about the pivot */
void pel_rigid_turn_by(const pel_rigid *rigid, const double moment[3], double turn[3]);
/* Moves the body by a push [N s2] on its pivot and a moment [N m s2] about it; its momenta change by rate times those.
 */
void pel_rigid_shift(pel_rigid *rigid, const double push[3], const double moment[3], double rate);
/* The same, but that the body turns, and its momenta change, only with the next pel_rigid_settle. */
void pel_rigid_shift_later(pel_rigid *rigid, const double push[3], const double moment[3], double rate);
void pel_rigid_settle(pel_rigid *rigid);
/* momenta alone, by an impulse [N s] on the sum; or on the pivot with a moment [N m s] about it */
void pel_rigid_hit_by(pel_rigid *rigid, const double impulse[3], const double moment[3]);
void pel_rigid_hit(const pel_rigid_grip *grip, const double impulse[3]);
/* m/s, of the sum */
void pel_rigid_grip_velocity(const pel_rigid_grip *grip, double velocity[3]);

#endif
