#include "solve/descent.h"

#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "linear/pairs.h"
#include "math/extremes.h"

#include <math.h>
#include <string.h>

enum { PAIR_COUNT = 8, MOST_TRIALS = 30 };

/* of the decrease that the slope promises, and of the slope, a step has to reach (Armijo, Wolfe) */
#define DECREASE 1e-4
#define FLATNESS 0.9
/* changes of the energy below this share of it may be rounding of its parts, which nearly cancel where a stiff body is
   loaded lightly (Hager, Zhang 2005 take 1e-6) */
#define ROUNDING 1e-9

struct pel_descent {
    int32_t vertex_count, movable_count;
    int32_t *movable;               /* (movable_count) vertices that may move: padding and free places are many */
    size_t size;                    /* 3 movable_count */
    double *x, *gradient;           /* (size) accepted */
    double *trial, *trial_gradient; /* (size) */
    double *direction;              /* (size) */
    double *spread;                 /* (3 vertex_count) scratch: a vector over all vertices */
    pel_pairs pairs;
    double *position, *force; /* (3 vertex_count) arguments of the energy */
    double last_length;       /* of gradient descent: the step that was taken last, over the gradient */
};

/* a point on the way: how far, energy, slope */
typedef struct descent_point {
    double length, energy, slope;
} descent_point;

pel_status pel_descent_create(int32_t vertex_count, pel_descent **descent, pel_error *error)
{
    *descent = NULL;
    pel_descent *made = pel_allocate(1, sizeof *made);
    if (made == NULL)
        return pel_fail_memory(error);
    size_t size = 3 * (size_t)vertex_count;
    made->vertex_count = vertex_count;
    if (!PEL_ALLOCATE_ALL(PEL_ROOM(made->movable, vertex_count), PEL_ROOM(made->x, size),
                          PEL_ROOM(made->gradient, size), PEL_ROOM(made->trial, size),
                          PEL_ROOM(made->trial_gradient, size), PEL_ROOM(made->direction, size),
                          PEL_ROOM(made->spread, size), PEL_ROOM(made->position, size), PEL_ROOM(made->force, size)) ||
        pel_pairs_create(&made->pairs, PAIR_COUNT, size, NULL) != PEL_OK) {
        pel_descent_destroy(made);
        return pel_fail_memory(error);
    }
    *descent = made;
    return PEL_OK;
}

void pel_descent_destroy(pel_descent *descent)
{
    if (descent == NULL)
        return;
    PEL_FREE_ALL(descent->x, descent->gradient, descent->trial, descent->trial_gradient, descent->direction,
                 descent->position, descent->force, descent->movable, descent->spread);
    pel_pairs_release(&descent->pairs);
    pel_free(descent);
}

/* a vector over movable vertices into one over all of them */
static void scatter(const pel_descent *descent, const double *from, double *to)
{
    for (int32_t i = 0; i < descent->movable_count; i++)
        memcpy(to + 3 * (size_t)descent->movable[i], from + 3 * (size_t)i, 3 * sizeof *to);
}

/* energy and gradient at a vector of positions */
static double evaluate(pel_descent *descent, const pel_descent_problem *problem, const double *x, double *gradient)
{
    scatter(descent, x, descent->position);
    double energy = problem->energy(problem->context, descent->position, descent->force);
    for (int32_t i = 0; i < descent->movable_count; i++)
        for (int c = 0; c < 3; c++)
            gradient[3 * (size_t)i + (size_t)c] = -descent->force[3 * (size_t)descent->movable[i] + (size_t)c];
    return energy;
}

/* ---- directions ---- */

static void precondition(pel_descent *descent, const pel_descent_problem *problem, double *d)
{
    memset(descent->spread, 0, 3 * (size_t)descent->vertex_count * sizeof *descent->spread);
    scatter(descent, d, descent->spread);
    problem->precondition(problem->context, descent->spread);
    for (int32_t i = 0; i < descent->movable_count; i++)
        memcpy(d + 3 * (size_t)i, descent->spread + 3 * (size_t)descent->movable[i], 3 * sizeof *d);
}

/* what stands between the two loops: the first guess of H */
static void apply_guess(pel_descent *descent, const pel_descent_problem *problem, double *d)
{
    size_t size = descent->size;
    if (problem->precondition != NULL) {
        precondition(descent, problem, d);
        return;
    }
    double scale = pel_pairs_scale(&descent->pairs, size);
    for (size_t i = 0; i < size && scale > 0; i++)
        d[i] *= scale;
}

/* the two loops: direction = - H gradient */
static void find_direction(pel_descent *descent, const pel_descent_problem *problem)
{
    size_t size = descent->size;
    double *d = descent->direction;
    for (size_t i = 0; i < size; i++)
        d[i] = -descent->gradient[i];
    if (problem->gradient_only)
        return;
    pel_pairs_begin(&descent->pairs, size, d);
    apply_guess(descent, problem, d);
    pel_pairs_end(&descent->pairs, size, d);
}

/* ---- line search ---- */

/* m, of a vertex along the direction */
static double farthest_move(const pel_descent *descent)
{
    double largest = 0;
    for (size_t i = 0; i < descent->size; i += 3)
        largest = pel_max(largest, pel_pairs_dot(3, descent->direction + i, descent->direction + i));
    return sqrt(largest);
}

/* the length at which some vertex goes as far as it may */
static double longest_length(const pel_descent *descent, double longest_move)
{
    double farthest = farthest_move(descent);
    return farthest > 0 ? longest_move / farthest : 0;
}

static descent_point look(pel_descent *descent, const pel_descent_problem *problem, double length)
{
    for (size_t i = 0; i < descent->size; i++)
        descent->trial[i] = descent->x[i] + length * descent->direction[i];
    descent_point point = {length, evaluate(descent, problem, descent->trial, descent->trial_gradient), 0};
    point.slope = pel_pairs_dot(descent->size, descent->trial_gradient, descent->direction);
    return point;
}

static bool is_low_enough(const descent_point *from, const descent_point *to)
{
    if (!isfinite(to->energy) || !isfinite(to->slope))
        return false;
    double change = to->energy - from->energy;
    if (change <= DECREASE * to->length * from->slope)
        return true;
    /* near the minimum the change drowns in rounding, the slope does not */
    return change <= ROUNDING * fabs(from->energy) && fabs(to->slope) <= FLATNESS * fabs(from->slope);
}

/* where the parabola through both points is lowest, within bounds */
static double shorter(const descent_point *from, const descent_point *to)
{
    double change = to->energy - from->energy, bend = change - from->slope * to->length;
    double length = bend > 0 ? -0.5 * from->slope * to->length * to->length / bend : 0.5 * to->length;
    if (!isfinite(length))
        length = 0.1 * to->length;
    return pel_min(pel_max(length, 0.1 * to->length), 0.5 * to->length);
}

/* goes downhill along the direction; false when no length was good enough, and then the trial means nothing */
static bool search(pel_descent *descent, const pel_descent_problem *problem, descent_point *from, double first,
                   int32_t *evaluations)
{
    double longest = longest_length(descent, problem->longest_move);
    descent_point to = look(descent, problem, pel_min(first, longest));
    ++*evaluations;
    int trial = 0;
    for (; trial < MOST_TRIALS && !is_low_enough(from, &to) && !pel_pool_is_stopped(problem->pool);
         trial++, ++*evaluations)
        to = look(descent, problem, shorter(from, &to));
    if (trial == MOST_TRIALS)
        return false;
    /* far too short: the slope is as steep as before */
    for (; trial == 0 && to.slope < FLATNESS * from->slope && 2 * to.length <= longest; ++*evaluations) {
        descent_point farther = look(descent, problem, 2 * to.length);
        bool better = is_low_enough(from, &farther) && farther.energy < to.energy;
        if (!better) {
            look(descent, problem, to.length);
            ++*evaluations;
            break;
        }
        to = farther;
    }
    *from = to;
    return true;
}

/* ---- the loop ---- */

static double first_length(const pel_descent *descent, const pel_descent_problem *problem)
{
    if (!problem->gradient_only && (descent->pairs.count > 0 || problem->precondition != NULL))
        return 1;
    /* twice the last one, or a tenth of the longest move */
    if (problem->gradient_only && descent->last_length > 0)
        return 2 * descent->last_length;
    return 0.1 * longest_length(descent, problem->longest_move);
}

static void accept_trial(pel_descent *descent)
{
    double *x = descent->x, *gradient = descent->gradient;
    descent->x = descent->trial;
    descent->gradient = descent->trial_gradient;
    descent->trial = x;
    descent->trial_gradient = gradient;
}

/* forces at the accepted point, which is the one that was evaluated last */
static void find_residual(pel_descent *descent, const pel_descent_problem *problem, pel_descent_result *result)
{
    double square = 0;
    for (int32_t v = 0; problem->held != NULL && v < descent->vertex_count; v++)
        for (int c = 0; problem->held[v] && c < 3; c++)
            square += descent->force[3 * (size_t)v + (size_t)c] * descent->force[3 * (size_t)v + (size_t)c];
    result->held_force = sqrt(square);
    result->residual = sqrt(pel_pairs_dot(descent->size, descent->gradient, descent->gradient));
    double held = problem->held_share * result->held_force;
    result->converged = result->residual <= sqrt(problem->tolerance * problem->tolerance + held * held);
}

static void iterate(pel_descent *descent, const pel_descent_problem *problem, pel_descent_result *result)
{
    double rough = pel_min(problem->reduction * result->residual, problem->enough);
    descent_point at = {0, result->energy, 0};
    while (!result->converged && !result->stuck && result->iterations < problem->iterations &&
           !pel_pool_is_stopped(problem->pool)) {
        find_direction(descent, problem);
        if (problem->precondition != NULL && farthest_move(descent) <= problem->short_move) {
            result->converged = result->is_near = true;
            break;
        }
        at.slope = pel_pairs_dot(descent->size, descent->gradient, descent->direction);
        bool found =
            at.slope < 0 && search(descent, problem, &at, first_length(descent, problem), &result->evaluations);
        if (!found) {
            /* once more along the gradient before giving up */
            result->stuck = descent->pairs.count == 0 && !(descent->last_length > 0);
            pel_pairs_forget(&descent->pairs);
            descent->last_length = 0;
            continue;
        }
        if (!problem->gradient_only)
            pel_pairs_keep(&descent->pairs, descent->size, (const double *const[]){descent->x, descent->trial},
                           (const double *const[]){descent->gradient, descent->trial_gradient});
        descent->last_length = at.length;
        accept_trial(descent);
        result->iterations++;
        result->energy = at.energy;
        find_residual(descent, problem, result);
        result->converged |= result->residual <= rough;
    }
}

void pel_descent_run(pel_descent *descent, const pel_descent_problem *problem, double *position,
                     pel_descent_result *result)
{
    descent->movable_count = 0;
    for (int32_t v = 0; v < descent->vertex_count; v++) {
        memcpy(descent->position + 3 * (size_t)v, position + 3 * (size_t)v, 3 * sizeof *position);
        if (!(problem->inverse_mass[v] > 0) || (problem->held != NULL && problem->held[v]))
            continue;
        memcpy(descent->x + 3 * (size_t)descent->movable_count, position + 3 * (size_t)v, 3 * sizeof *position);
        descent->movable[descent->movable_count++] = v;
    }
    descent->size = 3 * (size_t)descent->movable_count;
    if (!problem->goes_on) {
        pel_pairs_forget(&descent->pairs);
        descent->last_length = 0;
    }
    *result = (pel_descent_result){.evaluations = 1};
    result->energy = evaluate(descent, problem, descent->x, descent->gradient);
    find_residual(descent, problem, result);
    result->first_residual = result->residual;
    iterate(descent, problem, result);
    /* the last evaluation was elsewhere if its search found nothing lower */
    if (result->stuck) {
        evaluate(descent, problem, descent->x, descent->gradient);
        result->evaluations++;
    }
    scatter(descent, descent->x, position);
}

const double *pel_descent_force(const pel_descent *descent)
{
    return descent->force;
}
