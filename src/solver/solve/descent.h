/* Minimisation of an energy over the positions of vertices: L-BFGS (Nocedal, Wright 2006, algorithm 7.4, eight pairs),
   preconditioned or not, or gradient descent, both with a line search that asks for enough decrease of the energy or,
   where rounding hides that, of its slope (Hager, Zhang 2005). Nothing is allocated while it runs. */
#ifndef PEL_SOLVE_DESCENT_H
#define PEL_SOLVE_DESCENT_H

#include "base/pool.h"
#include "model/state.h"

/* Returns the energy [J] at positions (3 vertex_count) and writes the forces, its negative gradient [N]: both in
   double, since changes of position that matter to stiff bodies are lost in float. */
typedef double pel_descent_energy(void *context, const double *position, double *force);

/* Multiplies a vector (3 vertex_count, 0 where vertices stay) by a positive definite matrix near the inverse of the
   second derivatives [m/N]. */
typedef void pel_descent_precondition(void *context, double *vector);

typedef struct pel_descent_problem {
    const pel_real *inverse_mass; /* (vertex_count) 0 = stays where it is */
    const uint8_t *held;          /* (vertex_count) 1 = stays as well; nullable */
    pel_descent_energy *energy;
    pel_descent_precondition *precondition; /* of L-BFGS; null = a multiple of the identity */
    void *context;
    const pel_pool *pool; /* that of the energy: a run ends early, anywhere, where it is stopped; nullable */
    double longest_move;  /* m, no vertex goes farther in one iteration */
    double tolerance;     /* N, root of the sum of squares of all forces at which it has converged */
    double held_share;    /* that tolerance grows, as the root of the sum of squares, by this share of held_force */
    double inertia_share; /* (Newton's method) that tolerance grows by this share of inertia_force */
    double reduction;     /* also converged at this share of the initial residual; 0 = off */
    double rounding;      /* (Newton's method) N, that rounding leaves of the forces of a body at rest */
    double enough;        /* N, when it is no more than this */
    double short_move;    /* m, preconditioned: it has converged where no vertex would go farther than this */
    int32_t iterations;   /* at most */
    bool gradient_only;
    bool goes_on; /* nearly the energy of the last run, from where that ended: what it learnt of the curvature stays */
} pel_descent_problem;

typedef struct pel_descent_result {
    int32_t iterations, evaluations;
    int64_t work;          /* in evaluations, of Newton's method */
    double energy;         /* J, at the end */
    double residual;       /* N, root of the sum of squares of all forces */
    double first_residual; /* N, that at the start */
    double held_force;     /* N, root of the sum of squares of the forces on the vertices that are held */
    double inertia_force;  /* N, (Newton's method) root of the sum of squares of the forces of inertia */
    double moment_force;   /* N, (Newton's method) that of moments on edges, each as a force at the end of its edge */
    bool converged;
    bool is_near;  /* by short_move */
    bool unstable; /* (Newton's method) no minimum was found beside the balance */
    bool stuck;    /* no step downhill could be found: as near as rounding allows, or the energy is not smooth */
} pel_descent_result;

typedef struct pel_descent pel_descent;

pel_status pel_descent_create(int32_t vertex_count, pel_descent **descent, pel_error *error);
void pel_descent_destroy(pel_descent *descent);

/* Moves positions (3 vertex_count) downhill. The energy never rises but by rounding. */
void pel_descent_run(pel_descent *descent, const pel_descent_problem *problem, double *position,
                     pel_descent_result *result);
/* (3 vertex_count) N, at the end of the last run, those on vertices that stay included */
const double *pel_descent_force(const pel_descent *descent);

#endif
