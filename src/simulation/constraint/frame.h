/* The frame of all methods that minimise: contacts of a minimisation.

   A step seeks positions x of least energy E(x) with every gap c_k(x) >= 0: of triangles to round tools, of points to
   planes of other tools, of vertices and edges to surfaces. The minimiser sees the augmented Lagrangian (Powell 1969;
   Nocedal, Wright 2006, section 17.4)

       L(x) = E(x) + sum_k max(0, load_k - stiffness_k c_k(x))^2 / (2 stiffness_k),

   whose gradient is that of the Lagrangian with the next loads, load_k = max(0, load_k - stiffness_k c_k): a minimum of
   L is at rest under forces that press and never pull, and round by round the gaps close as well. A tool feels the sum
   of its loads. A layer gives way by a depth d(load), so that its gap has to be -d(load): with the tangent at the load
   of the last round, load_k + share_k (-stiffness_k) (c_k + d(load_k)) with share_k = 1 / (1 + stiffness_k d'(load_k))
   takes the place of load_k - stiffness_k c_k. Since d is concave this is Newton's method from below.

   Friction resists the tangential displacement u of a point since the start of the step, in the same way: with t = drag
   - stiffness u the energy is that of a spring, |t|^2 / (2 stiffness), up to |t| = friction load and proportional to
     |t| beyond. The load at the last linear system or update is used, so that this is a potential. */
#ifndef PEL_CONSTRAINT_FRAME_H
#define PEL_CONSTRAINT_FRAME_H

#include "force/tangent_body.h"
#include "newton/newton.h"
#include "solve/descent.h"
#include "stage/stage.h"
#include "stage/transfer.h"

/* Numbers that name a pair. */
enum { PEL_MINIMISE_PAIR = 6 };

/* Pairs of a vertex that are kept from step to step, in the mean. */
enum { PEL_KEPT_PAIRS = 4 };

/* what a pair carried at the end of a step */
typedef struct pel_minimise_load {
    int32_t pair[PEL_MINIMISE_PAIR];
    double load, drag[3]; /* N */
} pel_minimise_load;

/* What presses a vertex: towards the side where the first of its loads goes, and against that. */
typedef struct pel_minimise_pressed {
    double direction[3], load[2], pairs[2]; /* unit; N, sum of loads; how many pairs these are of */
} pel_minimise_pressed;

/* Where something touches, or may soon. Slack is in the gap: nothing has to be corrected after the step. */
typedef struct pel_minimise_contact {
    int32_t vertices[4];
    double weights[4], normal[3]; /* where it was found; the normal points out of the tool */
    double offset;                /* m: gap = sum of weights x . normal - offset; against a round tool the slack */
    double stiffness, across;     /* N/m, along the normal and of friction */
    double share;                 /* of the force that stiffness gives, by the slope of the layer at the load */
    double depth;                 /* m, by which the layer gives way under the load */
    double compliance, thickness; /* m/N and m, of the layer (contact/layer.h); 0 = rigid */
    double tolerance;             /* m, of the gap */
    double load;                  /* N, along the normal */
    double grip;                  /* N, the load that limits friction: that at the last update or linear system */
    double regrip;                /* N, how far the load was from it there */
    int32_t swings;               /* times that this turned */
    double drag[3];               /* N, across it */
    double drift[3];              /* m, way of the tool there since the step began */
    double friction;
    int32_t tool;   /* -1 = none */
    int32_t points; /* vertices of a feature whose gap to a round tool is recomputed as it moves; 0 = a plane */
    int32_t end;    /* of the capsule that a triangle has its gap to: -1, 1; 0 = middle of a sphere */
    int32_t pair[PEL_MINIMISE_PAIR]; /* names it over steps: kind, tool, features */
    int32_t number;                  /* of tools: the triangle, or -1 - vertex; of surfaces: in the list of contacts */
    int32_t before;                  /* scratch: its number plus 1, of the one before it at the same vertex; 0 = none */
} pel_minimise_contact;

typedef struct pel_minimise_context pel_minimise_context;

/* Moves sim->minimise->position downhill: pel_descent_run, or Newton's method (step_newton.h). PEL_OUT_OF_MEMORY. */
typedef pel_status pel_minimise_run(pel_minimise_context *context, const pel_descent_problem *problem,
                                    pel_descent_result *result, pel_error *error);

/* (step_newton.h) of the methods static and implicit */
typedef struct pel_sim_newton pel_sim_newton;

struct pel_minimise {
    pel_minimise_run *run;
    pel_descent *minimiser;   /* of the method descent, else null */
    pel_sim_newton *newton;   /* of the others, else null */
    pel_tangent *tangent;     /* of the method descent where the state is float: energies in double; else null */
    double *position;         /* (3 vertex_count) m, at the end of the step: position_next is their rounding */
    double *force;            /* (3 vertex_count) N, scratch */
    pel_record *record;       /* (vertex_count) scratch: positions for batches of elements */
    pel_record *external;     /* (vertex_count) forces that stay during a step */
    double mean_edge;         /* m */
    double size;              /* m, of the largest body */
    double stiff_force;       /* N, moves every vertex by an edge, by the bound of the stiffness */
    double acted, step_acted; /* N, largest force that has acted since the start: before the step in progress, and in
                                 it. The first is in snapshots */
    double stiffness;         /* 1/s2, bound of the stiffness of the bodies over mass */
    const double *inertia;    /* (vertex_count) N/m, springs that inertia is; null = none */
    /* in snapshots, for steps in time: what the next one begins with */
    pel_minimise_load *kept; /* (kept_count, room for PEL_KEPT_PAIRS of each vertex) ascending by pair */
    int32_t kept_count;
    bool prefers_kept;   /* to loads that balance the forces at the start of a step: they were nearer to its end */
    double begun[2];     /* N, sums of the latter and of kept loads when the step began; not in snapshots */
    double penalty;      /* stiffness of constraints relative to bodies and inertia */
    int32_t spent_steps; /* one after the other, whose work has reached its bound */
    pel_span acts;       /* when forces act, in steps after the start of the step: at its end, unless the scheme in time
                            tells */
    int32_t stray_body;  /* has got away by the last step (pel_minimise_find_stray); -1 = none */
    double stray_way;    /* m */
    double turned;       /* of the forces of surfaces, the share that has turned in the last step at rest */
    double tool_way, step_way;   /* m, farthest that any tool went, summed over the steps; in the step in progress. The
                                    sum is in snapshots */
    pel_descent_result result;   /* of the step at work */
    pel_descent_result accepted; /* of the last step that was accepted; in snapshots */

    /* constraints of tools, then of surfaces; the others are known from the last search */
    pel_minimise_contact *constraints, *others;
    size_t capacity, other_capacity;
    int32_t count, tool_count;
    const pel_newton_kink *kinks;  /* (count) say which constraints act; null = their gaps do */
    int32_t *constraint_of_vertex; /* (vertex_count) scratch: the number plus 1 of the last one there, 0 = none */
    pel_minimise_pressed *pressed; /* (vertex_count) scratch */
    double *shares;                /* (vertex_count) scratch: of its way up to where it runs into something */
};

/* inputs of the energy */
struct pel_minimise_context {
    pel_sim *sim;
    pel_state state; /* a copy that looks at other positions */
    pel_span span;   /* of loads; other keyed numbers have their values at its time */
    bool is_constrained;
};

/* where a constraint stands */
typedef struct pel_gap_sample {
    double gap; /* m */
    double weights[4], normal[3];
} pel_gap_sample;

/* how a minimisation changes the constraints */
typedef struct pel_contact_change {
    double gap, slip; /* largest errors along and across a normal, over the tolerance of the gap */
    double misfit,
        limit; /* N, sums: differences of the friction from Coulomb's limits under the new loads; the limits */
} pel_contact_change;

/* Second derivatives of a constraint's term, N/m: along and across its normal, for the weighted sum of the vertices. On
   a round tool the contact point of a triangle moves when the triangle turns: this adds the sum of the squares of
   rows. */
typedef struct pel_contact_stiffness {
    double weights[4], along[3][3], across[3][3]; /* across: of the sum with the constraint's own weights */
    int row_count;
    double rows[2][4][3]; /* root of N/m */
} pel_contact_stiffness;

#endif
