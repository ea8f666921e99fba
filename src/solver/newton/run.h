/* Inside of Newton's method: one run at work, and what full steps, steps of least energy and paths are made of. */
#ifndef PEL_NEWTON_RUN_H
#define PEL_NEWTON_RUN_H

#include "linear/minres.h"
#include "linear/pairs.h"
#include "newton/newton.h"

/* (skew.c) */
typedef struct pel_newton_skew pel_newton_skew;

/* constraints that change in one space of kinks.c */
enum { PEL_NEWTON_TOUCHED = 48, PEL_NEWTON_VOLUMES = 8 };

/* What constraints do to a step and to each other, by one matrix. */
typedef struct pel_newton_space {
    int32_t count;
    int32_t kinks[PEL_NEWTON_TOUCHED];
    double excess[PEL_NEWTON_TOUCHED];                   /* N, that they push more than in the matrix */
    double gaps[PEL_NEWTON_TOUCHED][PEL_NEWTON_TOUCHED]; /* m/N, of each by each */
    double system[PEL_NEWTON_TOUCHED][PEL_NEWTON_TOUCHED];
    double *reduced; /* (count x unknown_count) L^-1 of the derivatives of their gaps, root of m/N */
    size_t capacity;
    /* the first terms of volumes, which the factor does not have: of each by each, and responses to their gradients */
    int32_t volume_count, volumes[PEL_NEWTON_VOLUMES];
    double volume_gaps[PEL_NEWTON_VOLUMES][PEL_NEWTON_VOLUMES];
    double volume_rates[PEL_NEWTON_VOLUMES][PEL_NEWTON_TOUCHED]; /* of the gaps by these responses */
    double *volume_responses;                                    /* (volume_count x unknown_count) */
    size_t volume_capacity;
} pel_newton_space;

struct pel_newton {
    const pel_model *model;
    pel_pool *pool;
    pel_tangent *tangent;
    const pel_tangent_pattern *pattern;
    pel_matrix *matrix;
    pel_factor_plan *plan;
    pel_factor *factors[2]; /* by precision; that in double is made when one in float does not carry */
    pel_factor_precision precision;
    bool has_factor;
    bool is_prepared; /* the factor in float is the one that was prepared */
    bool is_new;      /* and was made in a run */
    bool is_smooth;   /* the last step of the exact matrix went all its way, and no constraint began or ceased to act */
    double *prepared_at;    /* (unknown_count) */
    double (*rotations)[9]; /* (vertex_count) by rows: of the surroundings of vertices since then (carry.c) */
    bool is_carried;        /* the factor is carried along with them */
    bool is_kept;           /* the last system was solved with an older factor */
    bool is_proven;         /* the last factor is that of a stable balance */
    uint64_t proven;        /* hash of its exact tangent */
    pel_factor_precision proven_precision;
    uint64_t couplings;    /* hash of those in the pattern */
    int32_t (*coupled)[4]; /* (coupled_count) those in the pattern */
    int32_t coupled_count;
    size_t coupled_capacity;
    int32_t (*owned)[4]; /* scratch: couplings with those of rigid bodies (rigid.c) */
    size_t owned_capacity;
    double *blocks; /* scratch: of their vertices */
    size_t block_capacity;
    bool is_outdated; /* the pattern is that of an older surface, or there was no memory for one */
    bool is_stale;    /* the pattern may have other couplings than the present run */
    pel_pcg *pcg;
    pel_minres *minres;                                       /* of paths, made when first needed */
    pel_newton_skew *skew;                                    /* of systems that are not symmetric, likewise */
    double *gradient, *right, *step, *start, *start_gradient; /* (unknown_count) */
    double *walked;                                           /* (unknown_count) sum of the steps of a run */
    double *best, *best_walked;                               /* (unknown_count) with the least residual of a run */
    double *path, *load, *answer;     /* (unknown_count) of a path: its direction, dF/dfactor, the step under that */
    double *move;                     /* (unknown_count) the step along x, y, z */
    double *balance;                  /* (unknown_count) N, forces that balance the start */
    double *begin;                    /* (unknown_count) unknowns when the run began */
    double *part_start, *part_walked; /* (unknown_count) unknowns, walked before a part */
    double *way;                      /* (unknown_count) of fixed ones from start to target */
    int32_t *frame;                   /* (node_count) number of its axes, or -1 */
    double *stresses;                 /* (stress_count) */
    double *first, *left, *product, *sum; /* (unknown_count) of steps across kinks (kinks.c) */
    pel_newton_space *space;              /* likewise, made when first needed */
    double *plain;                        /* values of the matrix without terms, for steps that foresee others */
    size_t plain_capacity;
    bool has_plain;
    pel_pairs pairs;                         /* of steps with one factor (quasi.c) */
    double *before_terms;                    /* (unknown_count) gradient without terms, of a run's start */
    double *before_walked, *before_gradient; /* (unknown_count) where the last of them began; free unknowns */
    bool has_before;
    int64_t work;         /* of all runs, in evaluations */
    int32_t volume_count; /* of the first terms that the factor lacks */
    double *volumes;      /* (volume_count x unknown_count) responses to their gradients */
    size_t volume_capacity;
    double volume_weights[PEL_NEWTON_VOLUMES];
    double *masses;     /* (unknown_count) kg, 0 on edges */
    uint8_t *fixed;     /* (unknown_count) */
    double size;        /* m, of the model */
    double edge;        /* m, mean length of edges with an unknown */
    bool has_potential; /* no pressure without one */
};

/* one run */
typedef struct newton_run {
    pel_newton *newton;
    const pel_newton_problem *problem;
    double *unknowns;
    pel_newton_result *result;
    pel_error *error;
    pel_status status;
    pel_tangent_kind kind;
    bool has_stresses;     /* newton->stresses are those of the geometric parts */
    double predicted;      /* share of the step from newton->start that the next matrix takes them from; 0 = taken */
    double shift;          /* 1/s2, of the masses */
    double parts;          /* J, sum of the sizes of the energy's parts */
    double work;           /* J, of terms, inertia and fixed unknowns since the start of the step, each part positive */
    double slope;          /* J, of the energy along the last step that went by it */
    double press;          /* N, sum over vertices of the sizes of the forces of terms */
    bool lacks;            /* forces on the fixed unknowns of a body are not what it takes to hold it yet */
    double share;          /* of the forces that balance the start, and of the ways of fixed unknowns, that is left */
    double longest;        /* m, that a step downhill moves any vertex by; 0 = any */
    int32_t limit;         /* of iterations so far */
    int64_t most_work;     /* of newton->work */
    double loose;          /* N, residual that is enough in a part of the loads; 0 at the last one */
    double factor;         /* of loads and given pressure */
    double path_stiffness; /* N/m along newton->path; 0 = none */
    bool is_shifted;       /* the last matrix of a path was not positive definite */
    bool has_best;
    bool rests;            /* at the last evaluation, where it was asked */
    int32_t quasi_steps;   /* with the present factor (quasi.c) */
    double quasi_goal;     /* N, residual at which they have been worth their price */
    int32_t positive_left; /* systems until the exact tangent is asked again */
    bool is_prepared;      /* the factor is one that was prepared for many runs */
    bool reuses;           /* the matrix of the elements is newton->plain */
} newton_run;

/* a run with all loads at once */
static inline newton_run pel_newton_run_of(pel_newton *newton, const pel_newton_problem *problem, double *unknowns,
                                           pel_newton_result *result, pel_error *error)
{
    return (newton_run){.newton = newton,
                        .problem = problem,
                        .unknowns = unknowns,
                        .result = result,
                        .error = error,
                        .factor = problem->load_factor != NULL ? *problem->load_factor : 1,
                        .limit = problem->iterations,
                        .most_work = problem->work > 0 ? newton->work + problem->work : INT64_MAX};
}

/* ---- newton.c ---- */
/* Blocks of the matrix for the couplings of the terms of the problem. PEL_OUT_OF_MEMORY. */
pel_status pel_newton_couple(newton_run *run);
/* whether the work of the run is done: it takes the state that it has reached, with fixed unknowns at their targets */
static inline bool pel_newton_is_spent(const newton_run *run)
{
    return run->newton->work >= run->most_work;
}
/* whether the deadline is over, after a system */
bool pel_newton_is_late(newton_run *run);
/* fixed unknowns are at their targets from here on */
void pel_newton_go_to_targets(newton_run *run);
/* Goes along a step of L-BFGS as far as the energy falls. False where the next one needs another factor. */
bool pel_newton_go_down_quasi_step(newton_run *run);
/* back to where the run began */
void pel_newton_return_to_begin(newton_run *run);
/* from where the run stands to its end */
void pel_newton_run_systems(newton_run *run);

/* ---- step.c: energy, forces, matrix, linear systems ---- */
/* whether there are constraints that begin and cease to act */
bool pel_newton_has_kinks(const newton_run *run);
/* energy at the unknowns, and gradient along the axes of the vertices */
void pel_newton_evaluate(newton_run *run);
bool pel_newton_is_finite(const newton_run *run);
/* what fixed unknowns have before them */
double pel_newton_way_to_target(const newton_run *run, int32_t u);
/* The matrix of the last evaluation, with fixed unknowns taken out, and the right side. */
void pel_newton_assemble(newton_run *run);
bool pel_newton_compute_factor(newton_run *run, double shift, double *pivot);
/* in float, with a little on the diagonal, then in double from now on; false where the matrix is not positive */
bool pel_newton_make_factor(newton_run *run);
/* The factor of a precision is that of the present matrix. */
void pel_newton_take_factor(newton_run *run, pel_factor_precision precision);
/* A factor of the matrix, or of that plus the least multiple of the masses which makes it positive; the matrix stays.
 */
bool pel_newton_make_preconditioner(newton_run *run);
/* newton->step of newton->right by conjugate gradients with the factor */
pel_pcg_end pel_newton_solve(newton_run *run, int32_t products);
/* terms of the system of a run (context) besides the matrix: volumes, and the stiffness along the direction of a path
 */
void pel_newton_add_product(void *context, pel_pool *pool, const double *x, double *y);
/* newton->step of newton->right by the matrix alone; false where that is not positive definite. */
bool pel_newton_solve_symmetric(newton_run *run);
/* The step of the matrix; false where that is not positive definite. */
bool pel_newton_find_step(newton_run *run);

/* ---- quasi.c ---- */
/* Begins with a factor that was just made. False without memory. */
bool pel_newton_meet_volumes(newton_run *run);
void pel_newton_forget_pairs(pel_newton *newton);
/* whether a step with the present factor is worth its price */
bool pel_newton_quasi_pays(const newton_run *run);
/* newton->step from the gradient of the last evaluation, by the factor and the pairs */
void pel_newton_find_quasi_step(newton_run *run);

/* ---- carry.c ---- */
/* The prepared factor serves with the rotations from where it was made to the unknowns, until another one is made. */
void pel_newton_carry(newton_run *run);
/* A vector (unknown_count) to where the factor was made, and from there. */
void pel_newton_carry_back(const pel_newton *newton, double *vector);
void pel_newton_carry_on(const pel_newton *newton, double *vector);

/* ---- kinks.c ---- */
/* Goes on with the step of the matrix across what begins and ceases to act along it. False where a solve fails. */
bool pel_newton_cross_kinks(newton_run *run);
void pel_newton_space_destroy(pel_newton_space *space);

/* ---- rigid.c ---- */
/* Rigid bodies go where the unknowns have them, and the unknowns to their places. */
void pel_newton_rigids_follow(newton_run *run);
/* Sums at the gradient of the last evaluation, along x, y, z; returns J, the energy of the inertia that vertices lack
   and of joints. */
double pel_newton_rigids_measure(newton_run *run);
/* adds its torques and those of joints, with their forces, to the gradient after it was turned to the bodies */
void pel_newton_rigids_add_torques(newton_run *run);
/* The matrix from the blocks of vertices to those of bodies. */
void pel_newton_rigids_reduce(newton_run *run);
/* 1/s2: the forces that are left, over the masses and sizes of rigid bodies; 0 without any. Where nothing else is stiff
   it is the scale of the matrix. */
double pel_newton_rigids_scale(const newton_run *run);
/* Couplings (count) of vertices, with those of the bodies that own some: to newton->owned, from `at`. Returns how many
   there are then; -1 without memory. */
int32_t pel_newton_rigids_couple(newton_run *run, int32_t at, int32_t count, const int32_t (*couplings)[4]);

/* ---- path.c ---- */
/* newton->load = dF/dfactor along the axes of the vertices, 0 where fixed; evaluates at the unknowns. */
void pel_newton_find_load(newton_run *run);
/* stiffness of the spring along a path */
double pel_newton_path_stiffness(const pel_newton_path *path);
/* Room for paths: a factor in double, and that of minimal residuals. PEL_OUT_OF_MEMORY. */
pel_status pel_newton_make_path_room(pel_newton *newton, pel_error *error);
/* The solution of the matrix, which may be indefinite, volumes and the spring along the path included. */
bool pel_newton_solve_indefinite(newton_run *run, const double *right, double *solution);

/* ---- skew.c ---- */
/* newton->step of the system with the skew part of the terms, from that without; false where a solve fails. */
bool pel_newton_solve_skew(newton_run *run);
/* whether there is such a part */
bool pel_newton_has_skew(const newton_run *run);
void pel_newton_skew_destroy(pel_newton_skew *skew);

/* ---- step.c ---- */
/* sum over all unknowns */
double pel_newton_dot(const pel_newton *newton, const double *a, const double *b);
/* the step along x, y, z, times a scale */
const double *pel_newton_find_move(const newton_run *run, double scale);
double pel_newton_longest_move(const pel_newton *newton);
/* of the step, as far as it is good for */
double pel_newton_find_share(const pel_newton *newton);
/* goes a share of the step */
void pel_newton_go(newton_run *run, double scale);
/* mixed integration points: the next matrix takes the stresses that a share of the step predicts, from here */
void pel_newton_extrapolate(newton_run *run, double scale);
bool pel_newton_has_converged(newton_run *run);
/* Whether a step in time is found well enough, by the slope of the energy along the last step and `press` before it. */
bool pel_newton_has_settled(const newton_run *run, double slope, double press);
bool pel_newton_is_at_targets(const newton_run *run);
/* stiffness over mass, 1/s2, of the free vertices and the last matrix */
double pel_newton_stiffness_scale(const pel_newton *newton);
/* flags of fixed unknowns, frames; sums of the run at zero */
void pel_newton_fix_unknowns(newton_run *run);
/* products with a new factor at most */
enum { PEL_NEWTON_PRODUCTS = 200 };

#endif
