/* Newton's method in the frame of constraint/frame.h; shared by static and implicit. */
#ifndef PEL_MINIMISE_STEP_NEWTON_H
#define PEL_MINIMISE_STEP_NEWTON_H

#include "constraint/frame.h"
#include "minimise/rigid_part.h"
#include "newton/newton.h"
#include "newton/run.h"

/* of a state of rest, at most */
enum { PEL_STATIC_ITERATIONS = 200 };

/* Whether steps in time go by L-BFGS with a factor that many steps share (prepared.h), by L-BFGS between systems
   (newton/quasi.c), or by systems alone. Which is cheapest is not known beforehand: the first is in smooth motion
   without contact, by up to 10 times; of the others by up to 4 times one or the other, L-BFGS for shells with a volume,
   systems for stiff sheets. Constraints rule out the first. */
typedef enum pel_newton_way { PEL_PREPARED, PEL_QUASI, PEL_SYSTEMS, PEL_WAY_COUNT } pel_newton_way;
typedef struct pel_newton_base pel_newton_base;
typedef struct pel_newton_choice {
    double cost[PEL_WAY_COUNT]; /* mean of late steps, in evaluations; 0 = not known */
    int32_t way;                /* of the next step */
    int32_t tried;              /* another way than the cheapest, that was tried last */
    int32_t age;                /* steps since then */
} pel_newton_choice;

/* a step of rest that goes by tries (step_static.c) */
typedef struct pel_settling {
    double rate;   /* 1/s2, stiffness over mass of the springs to where the try begins; 0 = none */
    double least;  /* at which no try has failed so far; 0 = none has */
    int32_t tries; /* of the step in progress */
} pel_settling;

struct pel_sim_newton {
    double *unknowns;         /* (unknown_count) positions at the end of the step, and the xi of edges */
    double *target;           /* (unknown_count) of fixed ones */
    double *loads;            /* (unknown_count) N */
    uint8_t *fixed;           /* (unknown_count) */
    pel_newton_frames frames; /* of supports and rigid bodies, since the last gathering */
    pel_rigid_parts rigid;    /* bodies */
    pel_record *force;        /* (vertex_count) N, of loads */
    double *point_stiffness;  /* (vertex_count) N/m, inertia and drag; null in statics */
    double (*points)[3];      /* (vertex_count) m */
    pel_settling settling;    /* of statics */
    double *anchor_stiffness; /* (vertex_count) N/m, of its springs; null in motion */
    double (*anchors)[3];     /* (vertex_count) m, their ends */
    double (*radial)[4]; /* (vertex_count) damping along volumetric springs, root of N/m: the energy of positions x is
                            half the square of radial . x - radial[3]; null = none */
    double *viscous; /* strains at the start of the step, for rates of strain (force/tangent.h); null = elastic, and in
                        statics */
    double rate;     /* 1/s, of these */
    struct newton_group *groups; /* (body_count) bodies that move together; null in statics */
    int32_t (*couplings)[4];     /* scratch: vertices of constraints */
    size_t coupling_capacity;
    pel_newton_kink *kinks; /* scratch: constraints */
    size_t kink_capacity;
    bool has_stepped; /* since the state was loaded: the springs of inertia belong to a step that led to it */
    const struct pel_implicit_scheme *scheme; /* of the last step in time */
    struct pel_sim_turn *turns;               /* (body_count) frames of the step in time; null in statics */
    uint8_t *collided;                        /* (body_count) groups whose velocities jump in the step in progress */
    pel_newton_choice choice;                 /* in snapshots */
    pel_newton_base *base;                    /* of the prepared factor; null in statics */
    int32_t way;                              /* that the step in progress goes */
    int64_t work;                             /* of the solver when the step began */
    pel_record *stage[2]; /* (vertex_count) positions and velocities of the first stage of the step in progress; null in
                             statics */
    bool is_exact;        /* steps in time are solved to rounding, for derivatives */
    bool goes_on;         /* the unknowns belong to the step in progress */
    const pel_newton_lead *lead; /* of a step beside another simulation (step_beside.c); null = none */
    bool leads;                  /* another one steps beside this one */
};

/* Unknowns, matrix and room, after sim->minimise was made. Errors of pel_newton_create. */
pel_status pel_sim_newton_create(pel_sim *sim, bool is_dynamic, pel_error *error);
void pel_sim_newton_destroy(pel_sim *sim);

/* Unknowns, fixed ones, targets and loads of a run, the axes of supports; with supports of three vertices for bodies
   that nothing holds. */
pel_newton_frames pel_sim_newton_gather(pel_sim *sim, pel_span span, bool supports_free);
/* The same at the present state, which the unknowns are at. */
pel_newton_frames pel_sim_newton_gather_at(pel_sim *sim, pel_span span, bool supports_free);
/* The group of bodies that pressed against each other in the last run of a step in time, by its first body; whether a
   tool, pins or supports hold it. */
int32_t pel_sim_newton_group(const pel_sim *sim, int32_t body);
bool pel_sim_newton_group_is_held(const pel_sim *sim, int32_t group);
/* whether pins, supports, tools or volumetric springs hold a body; contact may touch it */
bool pel_sim_newton_is_free(const pel_sim *sim, int32_t body);
/* Before the first run of a step, which goes the same way after a snapshot. */
void pel_sim_newton_begin(pel_sim *sim);
/* After an accepted step: the way of the next one. */
void pel_sim_newton_choose(pel_sim *sim);
/* pel_descent_run by Newton's method. PEL_OUT_OF_MEMORY. */
pel_status pel_sim_newton_minimise(pel_minimise_context *context, const pel_descent_problem *problem,
                                   pel_descent_result *result, pel_error *error);
/* Prepares the preconditioner of a minimisation without constraints from position_next; false if there is none: for an
   unsupported body, rounding of forces would drive its rigid motions. */
bool pel_sim_newton_approximate(pel_minimise_context *context);
/* a pel_descent_precondition; the context belongs to the minimisation */
void pel_sim_newton_precondition(void *context, double *vector);
/* the follow_surface of a stepper */
void pel_sim_newton_follow_surface(pel_sim *sim);
/* the settle_edges of a stepper */
pel_tangent *pel_sim_newton_settle_edges(const pel_sim *sim, const double **unknowns);
/* Edges as they bend least, where the vertices are that the unknowns have. */
void pel_sim_newton_settle_at(const pel_sim *sim);
/* Elastic supports, follower loads, damping along volumetric springs, and constraints: terms added to the energy of the
   model. The context has to outlive it. */
pel_newton_terms pel_sim_newton_terms(pel_minimise_context *context);
/* whether there is any without constraints */
bool pel_sim_newton_has_terms(const pel_sim *sim);
/* N, force of the bodies on a fixed vertex */
void pel_sim_newton_held_force(const pel_sim *sim, int32_t v, double force[3]);

#endif
