/* Newton's method on the balance of forces of a model: states of rest, and steps in time, where inertia is a spring of
   each vertex to a point (theory page, section 16).

   The tangent is that of mixed integration points: its geometric part takes the stresses that the last step predicted.
   It goes in full steps and gets by with some ten of them where membrane and bending stiffness are far apart, but
   nothing makes it go downhill. Under constraints, which begin and cease to act, it would run to and fro between far
   states: there steps of the exact tangent, of its positive part where it has no factor, go as far as the energy
   falls. Where it finds no end, steps of least energy follow: the tangent plus a multiple of
   the masses (a step of implicit Euler from rest, of Levenberg and Marquardt), smaller whenever the energy falls. Those
   end in a minimum; a balance whose exact tangent is not positive definite is left along them. Where they find no end
   either (moments on edges have no energy), the loads come in parts of automatic size: forces that balance the start
   fade out.

   Linear systems are solved by conjugate gradients with a Cholesky factor in float, in double where float does not
   carry; the factor may be kept from one run to the next. */
#ifndef PEL_NEWTON_NEWTON_H
#define PEL_NEWTON_NEWTON_H

#include "force/tangent.h"
#include "linear/factor.h"
#include "rigid/rigid.h"

/* A part of the energy that acts only on one side, max(0, load - stiffness gap)^2 / (2 stiffness), with a gap that is
   nearly linear: it changes with the weighted sum of the ways of its vertices along the normal. */
typedef struct pel_newton_kink {
    int32_t vertices[4];
    double weights[4], normal[3];
    double gap, load, stiffness; /* m, N, N/m */
    bool acts;
    double begin, first_rate, rate; /* (kinks.c) m */
} pel_newton_kink;

/* What the caller adds to the energy of the model: contacts, friction. */
typedef struct pel_newton_terms {
    void *context;
    /* Energy [J] at unknowns; adds its gradient. */
    double (*evaluate)(void *context, const double *unknowns, double *gradient);
    /* Renews what stays between linear systems, such as limits of friction; false where nothing has changed. Null =
     * none.
     */
    bool (*renew)(void *context, const double *unknowns);
    /* Adds a positive semi-definite Hessian at the unknowns of the last evaluation to the blocks of the matrix. */
    void (*add_matrix)(void *context, pel_matrix *matrix);
    /* The same of the parts that begin and cease to act; a factor that many runs share lacks them. Null = none. */
    void (*add_kinks)(void *context, pel_matrix *matrix);
    /* Vertices that these two have blocks for at the unknowns of the last evaluation, and after them those that it may
       have some for soon: (returned count). acting = number of the first. Null = it adds to the blocks of the model. */
    int32_t (*list_couplings)(void *context, const int32_t (**vertices)[4], int32_t *acting);
    /* y += S x at the unknowns of the last evaluation, both (unknown_count): what the derivative of the gradient has
       beyond its symmetric part. Null = nothing. */
    void (*add_skew)(void *context, const double *x, double *y);
    /* The parts that begin and cease to act (count), at the unknowns of the last evaluation. From then on to the next
       evaluation add_kinks and list_couplings follow what the caller sets to act. Null = none. */
    pel_newton_kink *(*list_kinks)(void *context, int32_t *count);
    bool has_kinks; /* what it adds begins and ceases to act: steps go as far as the energy falls */
} pel_newton_terms;

/* What terms add to a matrix; null = nothing. */
void pel_newton_add_terms(const pel_newton_terms *terms, bool has_kinks, pel_matrix *matrix);

/* A row of a joint between rigid bodies, that its error is 0. A load goes with the error, load + stiffness error within
   bounds, and the energy is the integral of that (augmented Lagrangian): what calls takes it over into `load`. */
typedef struct pel_newton_row {
    const pel_rigid *bodies[2]; /* null = none */
    double points[2][3];        /* m, where it acts on both */
    double force[3];            /* of the error, by the way of the first point less that of the second */
    double torque[3];           /* by the turn of the first body less that of the second, beside the levers */
    double directors[2][3];     /* unit, each turns with its body: the error has their product; 0 = none */
    double error;               /* m or rad */
    double stiffness, load, least, most;
    double present; /* N or N m, of the last evaluation */
} pel_newton_row;

/* A rigid body among the unknowns (rigid.c). All vectors have its vertices; in linear systems two of these stand for
   all: the unknowns of one are the way of the pivot, those of the other the rotation vector times a length. */
typedef struct pel_newton_rigid {
    pel_rigid *body;   /* where it is; follows the unknowns */
    int32_t at, turn;  /* the two vertices */
    double axes[3][3]; /* rows, orthonormal: of the components of the rotation vector */
    double length;     /* m */
    /* Its way is that of a point at rest, the pivot or that of a joint, so that the body turns about it. Ways of
       vertices with the shares mass (share + tilt . (X - middle)) are that of the point; share 0 = of the pivot. */
    double origin[3], middle[3], tilt[3], share;
    /* inertia that its vertices, whose springs to points it has, lack or have too much: the energy is half the trace of
       (R - target) lack (R - target)^T */
    double lack[3][3], target[3][3]; /* N m; a rotation */
    /* at the last evaluation */
    double torque[3];    /* N m, of that energy and rows */
    double force[3];     /* N, of rows */
    double moment[3][3]; /* N m, sum of arms times gradient: of the second derivative of a turn */
} pel_newton_rigid;

typedef struct pel_newton_rigids {
    int32_t count;
    pel_newton_rigid *items; /* (count) those that move */
    const pel_rigids *bodies;
    const pel_real *masses; /* (vertex_count) kg */
    double (*arms)[3];      /* (vertex_count) m, of vertices from the origin, at the last evaluation */
    int32_t row_count;
    pel_newton_row *rows;              /* (row_count) of joints */
    void (*place_rows)(void *context); /* sets points, directions and errors of the rows where the bodies are */
    void *rows_context;
} pel_newton_rigids;

/* in `fixed` of a problem: unknowns that rigid bodies own, which have no target */
enum { PEL_NEWTON_OWNED = 2 };

/* The unknowns of a vertex along axes of its own. */
typedef struct pel_newton_frames {
    int32_t count;
    const int32_t *vertices;         /* (count) each once */
    const double (*axes)[3][3];      /* (count) rows, orthonormal */
    const pel_newton_rigids *rigids; /* null = none */
} pel_newton_frames;

/* Forces on unknowns from x, y, z to these axes and to rigid bodies; ways back from there; gradients of volumes to
   axes. Forces of rigid bodies are spread over their vertices, or their pins. */
void pel_newton_frames_turn(const pel_newton_frames *frames, double *vector);
void pel_newton_frames_turn_back(const pel_newton_frames *frames, double *vector);
void pel_newton_frames_turn_forces_back(const pel_newton_frames *frames, double *vector);
void pel_newton_frames_turn_rank_ones(const pel_newton_frames *frames, const pel_tangent_pattern *pattern);

typedef struct pel_newton_problem {
    pel_span span;             /* of loads, see pel_tangent_input */
    const pel_state *state;    /* factors of keyed parameters */
    const double *force;       /* (unknown_count) N, loads that stay; null = none */
    const double *load_factor; /* of force and given pressure; null = 1 */
    /* inertia: springs of the vertices to points; both null in statics */
    const double *point_stiffness; /* (vertex_count) N/m */
    const double (*points)[3];     /* (vertex_count) m */
    const double *viscous;         /* of strains, with their rate [1/s]; null = elastic (force/tangent.h) */
    double rate;
    const uint8_t *fixed;          /* (unknown_count) 1 = goes to its target and stays there; PEL_NEWTON_OWNED */
    const double *target;          /* (unknown_count) of positions where fixed [m]; of psi its increment in this run */
    pel_newton_frames frames;      /* vertices for which fixed and target are along axes of their own */
    const pel_newton_terms *terms; /* null = none */
    double tolerance;              /* N, root of the sum of squares of all forces at which it has converged */
    double held_share;     /* that tolerance grows, as the root of the sum of squares, by this share of held_force */
    double inertia_share;  /* and by this share of inertia_force */
    double reduction;      /* also converged at this share of the initial residual; 0 = off */
    double enough;         /* N, when it is no more than this */
    double short_move;     /* m, and after a full step in which no vertex goes farther than this */
    int32_t iterations;    /* of full steps, and as many of steps of least energy after them */
    int64_t work;          /* in evaluations, after which a run takes the state that it has reached; 0 = any */
    double (*clock)(void); /* s; null = no deadline */
    double deadline;       /* s by the clock: after the first step that ends later the best state by then is taken */
    bool keeps_factor;     /* conjugate gradients with an older factor, while they need few iterations */
    bool is_in_motion;     /* the positive part of a tangent serves as well as one that float does not carry */
    bool is_quasi;         /* steps of L-BFGS between those of Newton's method, with the last factor (quasi.c) */
    bool is_prepared;      /* the run begins with steps of L-BFGS with the prepared factor */
    double rest_share; /* Has converged before one step only where each body rests: forces below the tolerance move what
                          is light. This share of the forces that act on a body, or `rounding` [N]; 0 = off */
    double rounding;
    int32_t settles; /* under constraints a step in time may end before that, where little energy is left: systems from
                        which on; 0 = never */
    bool is_dynamic; /* no steps of least energy: masses hold the matrix; else a state of rest that is stable */
} pel_newton_problem;

typedef struct pel_newton_result {
    int32_t iterations;    /* linear systems solved */
    double energy;         /* J, terms, loads and inertia included */
    double residual;       /* N, root of the sum of squares of all forces */
    double first_residual; /* N, that at the start, held vertices at their targets apart */
    double held_force;     /* N, root of the sum of squares of the forces on fixed vertices */
    double inertia_force;  /* N, root of the sum of squares of the forces of the springs to points on free unknowns */
    bool converged;
    bool is_near;  /* by short_move, or by `settles` */
    bool is_late;  /* by the deadline */
    bool stuck;    /* no step makes the energy fall: as near as rounding allows */
    bool unstable; /* a balance, but no minimum of the energy, and no minimum was found beside it */
} pel_newton_result;

typedef struct pel_newton pel_newton;

/* Pattern, order and room for a model. PEL_BAD_ARGUMENT as pel_tangent_create; PEL_OUT_OF_MEMORY, with the size that
   the factor needs. */
pel_status pel_newton_create(const pel_model *model, pel_pool *pool, pel_newton **newton, pel_error *error);
/* After the surface of the model has changed: the tangent has its edges and unknowns at once, the next run makes
   pattern and order. */
void pel_newton_rebuild(pel_newton *newton);
void pel_newton_destroy(pel_newton *newton);

const pel_tangent_pattern *pel_newton_pattern(const pel_newton *newton);
pel_tangent *pel_newton_tangent(const pel_newton *newton);
/* (unknown_count) N, the gradient at the end of the last run: the reactions where unknowns are fixed */
const double *pel_newton_gradient(const pel_newton *newton);
/* (edge_count) sums of psi that the edges went through in the last run */
const double *pel_newton_turns(const pel_newton *newton);

/* N, root of the sum of squares of moments (those of unknown_count loads on edges), as forces at the ends of edges */
double pel_newton_moment_force(const pel_newton *newton, const double *loads);

/* What other solvers of the same unknowns share: between two runs they may use the matrix. */
typedef struct pel_newton_system {
    const pel_model *model;
    pel_tangent *tangent;
    pel_matrix *matrix;
    const pel_factor_plan *plan;
    pel_pool *pool;
    const double *masses; /* (unknown_count) kg, 0 on edges */
} pel_newton_system;
pel_newton_system pel_newton_system_of(const pel_newton *newton);
/* One more matrix of the same pattern. PEL_OUT_OF_MEMORY. */
pel_status pel_newton_create_matrix(const pel_newton *newton, pel_matrix **matrix, pel_error *error);

/* Moves unknowns (unknown_count; positions of vertices, xi of edges) to the balance. Allocates where a factor in double
   is needed for the first time, and where the terms couple vertices that the pattern has no blocks for:
   PEL_OUT_OF_MEMORY.
 */
pel_status pel_newton_run(pel_newton *newton, const pel_newton_problem *problem, double *unknowns,
                          pel_newton_result *result, pel_error *error);

/* Where a path of balances under growing loads stands. */
typedef struct pel_newton_path {
    double factor;       /* of loads and given pressure */
    double length;       /* m, of the next step: root of the mean square of the displacements, in the metric of masses;
                            0 = not begun */
    double first_change; /* of the factor, that sets the length of the first step */
    double most_length;  /* m, of the first step; 0 = any */
    double stiffness;    /* N/m along the path when it began */
    double *direction;   /* (unknown_count) m, the last step */
    int32_t iterations;  /* of the last step */
    double slope;        /* 1/m, of the factor over the length at its end; NAN = not known */
    bool is_stable;      /* so is the balance there, under loads that stay */
} pel_newton_path;

/* One step along the path, from a balance (path.c). The factor of the problem is that of the path. Where it does
   not converge, unknowns and factor stay: a shorter step may. Errors as of a run. */
pel_status pel_newton_follow(pel_newton *newton, const pel_newton_problem *problem, double *unknowns,
                             pel_newton_path *path, pel_newton_result *result, pel_error *error);

/* A run that has ended: its matrix solves the systems of runs beside it, whose problems differ by small changes of
   numbers (beside.c). */
typedef struct pel_newton_lead {
    pel_newton *newton;
    const pel_newton_problem *problem;
    double *unknowns;            /* (unknown_count) at its end */
    const pel_newton_path *path; /* null = the load factor stays */
    double path_stiffness;       /* of the spring along the path; set by pel_newton_take_lead */
} pel_newton_lead;

/* The exact matrix at the end of the run, factored; with a path that pel_newton_follow has just gone along the load
   factor is unknown as well. The factor serves until the next run of lead->newton. PEL_BAD_ARGUMENT where the matrix is
   singular; PEL_OUT_OF_MEMORY. */
pel_status pel_newton_take_lead(pel_newton_lead *lead, pel_error *error);
/* What pel_newton_run does, from the unknowns of the lead by chord iterations with its factor. load_factor: of the
   balance that has no displacement from the lead's along the path; null without a path. PEL_BAD_ARGUMENT where they do
   not converge. */
pel_status pel_newton_run_beside(pel_newton *newton, const pel_newton_problem *problem, const pel_newton_lead *lead,
                                 double *unknowns, double *load_factor, pel_newton_result *result, pel_error *error);

/* Solves K m = gradient (unknown_count) at a balance, K exact, and fixed unknowns 0: multipliers m (unknown_count). On
   fixed ones, held = gradient - K m, the derivative by their places, elsewhere 0. gradient is written over.
   PEL_BAD_ARGUMENT where the balance is not stable; PEL_OUT_OF_MEMORY. */
pel_status pel_newton_adjoint(pel_newton *newton, const pel_newton_problem *problem, double *unknowns, double *gradient,
                              double *multipliers, double *held, pel_error *error);

/* What the runs so far have cost, in evaluations: the same for any number of threads. */
int64_t pel_newton_work(const pel_newton *newton);

/* Forgets the factor that is kept, unless it is the prepared one, and takes the pattern of the couplings of the next
   run, so that what follows does not depend on the runs before. */
void pel_newton_forget(pel_newton *newton);

/* Prepares a factor for many runs, of a positive approximation of the second derivatives at unknowns: time, state,
   inertia, terms, fixed as in the problem. It serves until another one is made or the fixed unknowns change.
   PEL_OUT_OF_MEMORY. */
pel_status pel_newton_prepare(pel_newton *newton, const pel_newton_problem *problem, const double *unknowns,
                              pel_error *error);
bool pel_newton_is_prepared(const pel_newton *newton);
/* Runs prepare another factor where that one does not serve: true once after each, and its unknowns (unknown_count). */
bool pel_newton_take_prepared(pel_newton *newton, double *unknowns);

/* What runs by the prepared factor have cost, in evaluations. */
typedef struct pel_newton_wear {
    int64_t spent, last; /* by all, by the last one */
    int64_t runs;
} pel_newton_wear;
/* After a run of this work. Runs become dearer the farther they are from where the factor was made; their mean with its
   price is least where the last ones cost as much as it: true where another factor pays. */
bool pel_newton_wears(pel_newton_wear *wear, int64_t work);

/* A positive definite approximation of the second derivatives at unknowns, factored, as a preconditioner: time, state,
   terms, fixed as in the problem, shift on the diagonal as in pel_factor_compute: for what no energy holds. False where
   it has no factor. pel_newton_precondition multiplies a vector (3 vertex_count) by its inverse, with edges free to
   follow. */
bool pel_newton_approximate(pel_newton *newton, const pel_newton_problem *problem, const double *unknowns,
                            double shift);
void pel_newton_precondition(pel_newton *newton, double *vector);

#endif
