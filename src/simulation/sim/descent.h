/* Internals of the method `descent`: contacts of a minimisation.

   A step seeks positions x of least energy E(x) with every gap c_k(x) >= 0: of triangles to round tools, of points to
   planes of other tools, of vertices and edges to surfaces. The minimiser sees the augmented Lagrangian (Powell 1969;
   Nocedal, Wright 2006, section 17.4)

       L(x) = E(x) + sum_k max(0, load_k - stiffness_k c_k(x))^2 / (2 stiffness_k),

   whose gradient is that of the Lagrangian with the next loads, load_k = max(0, load_k - stiffness_k c_k): a minimum of
   L is at rest under forces that press and never pull, and round by round the gaps close as well. A tool feels the sum
   of its loads.

   Friction resists the tangential displacement u of a point since the start of the step, in the same way: with t = drag
   - stiffness u the energy is that of a spring, |t|^2 / (2 stiffness), up to |t| = friction load and proportional to
     |t| beyond. The load of the last round is used, so that this is a potential. */
#ifndef PEL_SIM_DESCENT_H
#define PEL_SIM_DESCENT_H

#include "sim/sim.h"
#include "solve/newton.h"

/* Where something touches, or may soon. Slack is in the gap: nothing has to be corrected after the step. */
typedef struct pel_descent_contact {
    int32_t vertices[4];
    double weights[4], normal[3]; /* where it was found; the normal points out of the tool */
    double offset;                /* m: gap = sum of weights x . normal - offset; against a round tool the slack */
    double stiffness;             /* N/m */
    double tolerance;             /* m, of the gap */
    double load;                  /* N, along the normal */
    double drag[3];               /* N, across it */
    double drift[3];              /* m, way of the tool there since the step began */
    double friction;
    int32_t tool;   /* -1 = none */
    int32_t points; /* vertices of a feature whose gap to a round tool is recomputed as it moves; 0 = a plane */
    int32_t end;    /* of the capsule that a triangle has its gap to: -1, 1; 0 = middle of a sphere */
    int32_t number; /* of tools: the triangle, or -1 - vertex; of surfaces: in the list of contacts */
} pel_descent_contact;

/* Gaps between surfaces exceed the thickness by this share of it, with a slightly smaller tolerance: nothing has to be
   corrected after a step, and surfaces that start at the thickness are lifted by at most that. */
#define PEL_SLACK_SHARE 0.05

typedef struct pel_descent_context pel_descent_context;

/* Moves sim->descent->position downhill: pel_descent_run, or Newton's method (step_newton.h). PEL_OUT_OF_MEMORY. */
typedef pel_status pel_descent_minimise(pel_descent_context *context, const pel_descent_problem *problem,
                                        pel_descent_result *result, pel_error *error);

/* (step_newton.h) of the methods static and implicit */
typedef struct pel_sim_newton pel_sim_newton;

struct pel_sim_descent {
    pel_descent_minimise *minimise;
    pel_descent *minimiser;      /* of the method descent, else null */
    pel_sim_newton *newton;      /* of the others, else null */
    pel_tangent *tangent;        /* of the method descent where the state is float: energies in double; else null */
    double *position;            /* (3 vertex_count) m, at the end of the step: position_next is their rounding */
    double *force;               /* (3 vertex_count) N, scratch */
    pel_record *record;          /* (vertex_count) scratch: positions for batches of elements */
    pel_record *external;        /* (vertex_count) forces that stay during a step */
    double mean_edge;            /* m */
    double size;                 /* m, of the largest body */
    double stiff_force;          /* N, moves every vertex by an edge, by the bound of the stiffness */
    double acted, step_acted;    /* N, largest force that has acted since the start: before the step in progress, and in
                                    it. The first is in snapshots */
    double stiffness;            /* 1/s2, bound of the stiffness of the bodies over mass */
    const double *inertia;       /* (vertex_count) N/m, springs that inertia is; null = none */
    double penalty;              /* stiffness of constraints relative to bodies and inertia */
    double force_time;           /* share of the step at which forces act: 1, or 1/2 under the midpoint rule */
    int32_t stray_body;          /* has got away by the last step (pel_descent_find_stray); -1 = none */
    double stray_way;            /* m */
    double tool_way, step_way;   /* m, farthest that any tool went, summed over the steps; in the step in progress. The
                                    sum is in snapshots */
    pel_descent_result result;   /* of the step at work */
    pel_descent_result accepted; /* of the last step that was accepted; in snapshots */

    /* constraints of tools, then of surfaces; the others are known from the last search */
    pel_descent_contact *constraints, *others;
    size_t capacity, other_capacity;
    int32_t count, tool_count;
    const pel_newton_kink *kinks;  /* (count) say which constraints act; null = their gaps do */
    int32_t *constraint_of_vertex; /* (vertex_count) scratch of one tool: its number plus 1, 0 = none */
    double *shares;                /* (vertex_count) scratch: of its way up to where it runs into something */
};

/* inputs of the energy */
struct pel_descent_context {
    pel_sim *sim;
    pel_state state; /* a copy that looks at other positions */
    double time;
    bool is_constrained;
};

/* where a constraint stands */
typedef struct pel_gap_sample {
    double gap; /* m */
    double weights[4], normal[3];
} pel_gap_sample;

/* how a minimisation changes the constraints */
typedef struct pel_contact_change {
    double gap; /* largest error of a gap over its tolerance */
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

/* ---- descent.c ---- */
/* Allocates the data of all methods that minimise. PEL_OUT_OF_MEMORY. */
pel_status pel_sim_descent_create(pel_sim *sim, pel_descent_minimise *minimise, pel_error *error);
/* Where a step begins: sim->descent->position and position_next from the state. */
void pel_descent_begin_at_state(pel_sim *sim);
/* One step. */
pel_status pel_sim_descent_step(pel_sim *sim, pel_step_result *result, pel_error *error);

/* Tolerances of a minimisation without constraints: N, by the loads at a time (N, and the share of holding forces), or
   m. Clears sim->force and the external forces. */
double pel_descent_tolerance(pel_sim *sim, double time);
double pel_descent_held_share(void);
double pel_descent_short_move(const pel_sim *sim);

/* Forces on tools: loads of constraints, and holding forces of grasped vertices. */
void pel_sim_descent_read_tools(pel_sim *sim);
/* After an accepted step or part of one: readings of a step are sums over the parts, and the worst of residuals. */
void pel_sim_descent_accept(pel_sim *sim);
/* the get_solver of the steppers that minimise */
void pel_sim_descent_get_solver(const pel_sim *sim, pel_solver_reading *reading);

/* ---- descent_free.c ---- */
/* Refuses a body that nothing holds against the net of some forces (vertex_count) at a time. PEL_BAD_ARGUMENT. */
pel_status pel_descent_check_held(const pel_sim *sim, const pel_record *force, double time, pel_error *error);
/* The same for the loads of the first step, and at the times of later ones. Clears sim->force. */
pel_status pel_descent_check_start(pel_sim *sim, pel_error *error);
/* Finds a body that only contact holds and that has got away by the end of the step of a static method. */
void pel_descent_find_stray(pel_sim *sim);

/* ---- descent_contact.c: positions and forces are (3 vertex_count) ---- */
/* the weighted sum of its points: their position, or against a surface the vector between both sides */
void pel_descent_contact_point(const pel_descent_contact *constraint, const double *position, double point[3]);
void pel_descent_contact_meet(const pel_sim *sim, const pel_descent_contact *constraint, const double *position,
                              pel_gap_sample *meeting);
/* One more constraint; false when nothing at it can move. PEL_OUT_OF_MEMORY. */
pel_status pel_descent_contact_add(pel_sim *sim, const pel_descent_contact *constraint, pel_error *error);
/* Adds energy [J] and forces at positions. */
double pel_descent_contacts_evaluate(pel_sim *sim, const double *position, double *force);
/* Second derivatives of a constraint's part. False where it does not act. */
bool pel_descent_contact_stiffness(const pel_sim *sim, const pel_descent_contact *constraint, const double *position,
                                   pel_contact_stiffness *stiffness);
/* Constraints as kinks (count) at positions; until pel_descent_contacts_evaluate stiffnesses are of those that act. */
void pel_descent_contacts_list_kinks(pel_sim *sim, const double *position, pel_newton_kink *kinks);
/* Loads and drags after a minimisation. */
pel_contact_change pel_descent_contacts_update(pel_sim *sim);
/* Loads that best balance `force`, the forces of the bodies at the end of the step, which is overwritten. stiffness
   (vertex_count): N/m of the springs of inertia, whose forces are in `force`; null = none. */
void pel_descent_contacts_estimate(pel_sim *sim, double *force, double reach, const double *stiffness);
/* N, root of the sum of squares of the constraint forces on vertices */
double pel_descent_contacts_force(const pel_sim *sim);
/* Constraints of surfaces from the list of contacts, after those of tools, with the loads stored by their keys. */
pel_status pel_descent_contacts_add_surfaces(pel_sim *sim, pel_error *error);
/* Writes these loads into the keys. */
void pel_descent_contacts_keep_loads(pel_sim *sim);
/* Flags of the vertices of surfaces that press against each other. */
void pel_descent_contacts_mark(const pel_sim *sim);

/* ---- descent_tool.c ---- */
/* Constraints against all tools at the end of the step and the present poses, in place of all that were known; those
   that were known keep their loads. */
pel_status pel_descent_contacts_find_tools(pel_sim *sim, pel_error *error);
/* Vertices that tools touch, and reactions. */
void pel_descent_contacts_read(pel_sim *sim);

#endif
