/* Steps across kinks. Constraints begin and cease to act along a step, and the step of the tangent is good up to the
   first of them. With the tangent K of everything else and linear gaps the energy is convex and quadratic in pieces,

     q(d) = g . d + d . K d / 2 + sum of max(0, load - stiffness gap(d))^2 / (2 stiffness).

   Newton's method on the pieces seeks its minimum: each step goes to the minimum of the piece where it begins, as far
   as q falls, which is found exactly. Pieces differ by few constraints. With the factored matrix H = L L^T of the first
   piece, its step d0 = - H^-1 g and the responses z = H^-1 J^T of those that changed (J: the derivative of a gap), all
   others are found in the space of d0 and z: what constraints push more or less than in the first piece are the
   unknowns of a small system, by the formula of Sherman, Morrison and Woodbury. What they do to the gaps of each other,
   J H^-1 J^T, are products of L^-1 J^T, which are few numbers; the step to a piece takes one solve. When too many have
   changed, the matrix of the present piece takes over. */
#include "base/memory.h"
#include "base/status.h"
#include "math/extremes.h"
#include "math/vec3.h"
#include "newton/run.h"

#include <math.h>
#include <string.h>

/* changed constraints in one space; matrices; steps on the pieces of one; evaluations along such a step */
enum { TOUCHED = PEL_NEWTON_TOUCHED, SPACES = 2, PIECES = 40, EVALUATIONS = 60 };
/* of the gradient at the start, that may be left of it: the next matrix is another */
#define ENOUGH 0.1
/* a slope below this share of that at the start is none; longest step, where q falls on and on */
#define FLAT 1e-3
#define LONGEST 8
/* cuts of regula falsi from the ends of a range */
#define LEAST_CUT 0.01

typedef struct crossing {
    newton_run *run;
    pel_newton *newton;
    pel_newton_space *space;
    pel_newton_kink *kinks;
    int32_t count, unknowns;
    double way; /* share of d0 */
} crossing;

/* ---- one constraint ---- */

static double rate_of(const pel_newton_kink *kink, const double *move)
{
    double rate = 0;
    for (int i = 0; i < 4; i++)
        if (kink->weights[i] != 0)
            rate += kink->weights[i] * pel_vec3_dot(kink->normal, move + 3 * (size_t)kink->vertices[i]);
    return rate;
}

static void push(const pel_newton_kink *kink, double force, double *gradient)
{
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 3 && kink->weights[i] != 0; k++)
            gradient[3 * (size_t)kink->vertices[i] + (size_t)k] += kink->weights[i] * force * kink->normal[k];
}

static double load_at(const pel_newton_kink *kink, double share)
{
    return kink->load - kink->stiffness * (kink->gap + share * kink->rate);
}

/* what it pushes more than in the piece of the matrix, where it acts without a sign or not at all */
static double excess(const pel_newton_kink *kink, double load)
{
    return pel_max(0, load) - (kink->acts ? load : 0);
}

static bool has_changed(const pel_newton_kink *kink)
{
    return (load_at(kink, 0) > 0) != kink->acts;
}

/* ---- responses ---- */

/* A x = b by elimination with pivots, x in b; false where A is singular */
static bool eliminate(double a[TOUCHED][TOUCHED], double *b, int32_t count)
{
    for (int32_t p = 0; p < count; p++) {
        int32_t pivot = p;
        for (int32_t i = p + 1; i < count; i++)
            pivot = fabs(a[i][p]) > fabs(a[pivot][p]) ? i : pivot;
        for (int32_t j = p; j < count && pivot != p; j++) {
            double kept = a[p][j];
            a[p][j] = a[pivot][j];
            a[pivot][j] = kept;
        }
        double kept = b[p];
        b[p] = b[pivot];
        b[pivot] = kept;
        if (!(fabs(a[p][p]) > 0))
            return false;
        for (int32_t i = p + 1; i < count; i++) {
            double factor = a[i][p] / a[p][p];
            for (int32_t j = p; j < count; j++)
                a[i][j] -= factor * a[p][j];
            b[i] -= factor * b[p];
        }
    }
    for (int32_t p = count - 1; p >= 0; p--) {
        for (int32_t j = p + 1; j < count; j++)
            b[p] -= a[p][j] * b[j];
        b[p] /= a[p][p];
    }
    return true;
}

/* a vector of forces along x, y, z as the right side of a system */
static void set_right(const crossing *c, double *force)
{
    pel_newton_frames_turn(&c->run->problem->frames, force);
    for (int32_t u = 0; u < c->unknowns; u++)
        c->newton->right[u] = c->newton->fixed[u] ? 0 : force[u];
}

static double *reduced(const crossing *c, int32_t i)
{
    return c->space->reduced + (size_t)i * (size_t)c->unknowns;
}

static double *volume_response(const crossing *c, int32_t i)
{
    return c->space->volume_responses + (size_t)i * (size_t)c->unknowns;
}

/* of the gradient of a volume and a vector that is 0 where unknowns are fixed */
static double volume_product(const crossing *c, int32_t i, const double *x)
{
    const pel_rank_one *one = &c->newton->pattern->rank_ones[c->space->volumes[i]];
    double product = 0;
    for (int32_t k = 0; k < 3 * one->vertex_count; k++)
        product += one->gradient[k] * x[3 * one->first_vertex + k];
    return product;
}

/* the small system of the first terms of volumes */
static void set_volume_system(const crossing *c)
{
    pel_newton_space *space = c->space;
    for (int32_t i = 0; i < space->volume_count; i++) {
        for (int32_t j = 0; j < space->volume_count; j++)
            space->system[i][j] = space->volume_gaps[i][j];
        space->system[i][i] += 1 / c->newton->pattern->rank_ones[space->volumes[i]].coefficient;
    }
}

/* newton->step of newton->right, by the factor: nearly */
static bool answer(crossing *c)
{
    pel_newton *newton = c->newton;
    pel_newton_space *space = c->space;
    double products[TOUCHED];
    newton->work++;
    pel_factor_solve(newton->factors[newton->precision], newton->pool, newton->right, newton->step);
    c->run->status = pel_pool_check(newton->pool, c->run->error);
    if (c->run->status != PEL_OK)
        return false;
    for (int32_t i = 0; i < space->volume_count; i++)
        products[i] = volume_product(c, i, newton->step);
    set_volume_system(c);
    if (!eliminate(space->system, products, space->volume_count))
        return false;
    for (int32_t i = 0; i < space->volume_count; i++)
        for (int32_t u = 0; u < c->unknowns; u++)
            newton->step[u] -= products[i] * volume_response(c, i)[u];
    return true;
}

/* responses to the gradients of volumes, whose terms are no part of the factor; of more than there is room for none */
static bool respond_to_volumes(crossing *c)
{
    pel_newton *newton = c->newton;
    pel_newton_space *space = c->space;
    int32_t count = 0;
    space->volume_count = 0;
    for (int32_t r = 0; r < newton->pattern->rank_one_count && count < PEL_NEWTON_VOLUMES; r++) {
        const pel_rank_one *one = &newton->pattern->rank_ones[r];
        size_t size = (size_t)(count + 1) * (size_t)c->unknowns;
        if (!(one->coefficient > 0))
            continue;
        if (!pel_reserve((void **)&space->volume_responses, &space->volume_capacity, size, sizeof(double))) {
            c->run->status = pel_fail_memory(c->run->error);
            return false;
        }
        memset(newton->right, 0, (size_t)c->unknowns * sizeof *newton->right);
        for (int32_t k = 0; k < 3 * one->vertex_count; k++)
            newton->right[3 * one->first_vertex + k] = newton->fixed[3 * one->first_vertex + k] ? 0 : one->gradient[k];
        if (!answer(c))
            return false;
        memcpy(volume_response(c, count), newton->step, (size_t)c->unknowns * sizeof(double));
        space->volumes[count++] = r;
    }
    for (int32_t i = 0; i < count; i++)
        for (int32_t j = 0; j < count; j++)
            space->volume_gaps[i][j] = volume_product(c, i, volume_response(c, j));
    space->volume_count = count;
    return true;
}

/* what the force of a constraint does to the gap of another one: the matrix with the first terms of volumes */
static double gap_of(const crossing *c, int32_t i, int32_t j)
{
    pel_newton_space *space = c->space;
    double change[TOUCHED], gap = pel_newton_dot(c->newton, reduced(c, i), reduced(c, j));
    for (int32_t k = 0; k < space->volume_count; k++)
        change[k] = space->volume_rates[k][j];
    set_volume_system(c);
    if (!eliminate(space->system, change, space->volume_count))
        return gap;
    for (int32_t k = 0; k < space->volume_count; k++)
        gap -= change[k] * space->volume_rates[k][i];
    return gap;
}

/* meets a constraint: what it does to the gaps of the others; false where the solve fails */
static bool respond(crossing *c, int32_t number)
{
    pel_newton *newton = c->newton;
    pel_newton_space *space = c->space;
    int32_t own = space->count;
    size_t size = (size_t)(own + 1) * (size_t)c->unknowns;
    if (!pel_reserve((void **)&space->reduced, &space->capacity, size, sizeof *space->reduced)) {
        c->run->status = pel_fail_memory(c->run->error);
        return false;
    }
    if (own == 0 && !respond_to_volumes(c))
        return false;
    memset(newton->product, 0, (size_t)c->unknowns * sizeof *newton->product);
    push(&c->kinks[number], 1, newton->product);
    set_right(c, newton->product);
    newton->work++;
    pel_factor_reduce(newton->factors[newton->precision], newton->pool, newton->right, reduced(c, own));
    c->run->status = pel_pool_check(newton->pool, c->run->error);
    if (c->run->status != PEL_OK)
        return false;
    for (int32_t k = 0; k < space->volume_count; k++)
        space->volume_rates[k][own] = pel_newton_dot(newton, newton->right, volume_response(c, k));
    space->kinks[own] = number;
    space->excess[own] = 0;
    space->count++;
    for (int32_t i = 0; i < space->count; i++)
        space->gaps[i][own] = space->gaps[own][i] = gap_of(c, i, own);
    return true;
}

static bool is_touched(const pel_newton_space *space, int32_t number)
{
    for (int32_t i = 0; i < space->count; i++)
        if (space->kinks[i] == number)
            return true;
    return false;
}

/* meets all that have changed; false where there are too many, or a solve fails */
static bool touch_changed(crossing *c)
{
    for (int32_t k = 0; k < c->count; k++)
        if (has_changed(&c->kinks[k]) && !is_touched(c->space, k) && (c->space->count == TOUCHED || !respond(c, k)))
            return false;
    return true;
}

/* ---- the minimum of a piece ---- */

/* What constraints push in excess (count of the space) at the minimum of the present piece. */
static bool find_target(const crossing *c, double *target)
{
    pel_newton_space *space = c->space;
    int32_t changed[TOUCHED], count = 0;
    double b[TOUCHED];
    for (int32_t i = 0; i < space->count; i++) {
        target[i] = 0;
        if (has_changed(&c->kinks[space->kinks[i]]))
            changed[count++] = i;
    }
    for (int32_t i = 0; i < count; i++) {
        const pel_newton_kink *kink = &c->kinks[space->kinks[changed[i]]];
        double sign = kink->acts ? -1 : 1;
        for (int32_t j = 0; j < count; j++)
            space->system[i][j] = (i == j) + sign * kink->stiffness * space->gaps[changed[i]][changed[j]];
        double gap = kink->begin + kink->first_rate;
        b[i] = sign * (kink->load - kink->stiffness * gap);
    }
    if (!eliminate(space->system, b, count))
        return false;
    for (int32_t i = 0; i < count; i++)
        target[changed[i]] = b[i];
    return true;
}

/* newton->step from the present place to a target, and the rates of all gaps along it; false where the solve fails */
static bool find_way(crossing *c, const double *target)
{
    pel_newton *newton = c->newton;
    double left = 1 - c->way;
    memset(newton->product, 0, (size_t)c->unknowns * sizeof *newton->product);
    for (int32_t i = 0; i < c->space->count; i++)
        push(&c->kinks[c->space->kinks[i]], target[i] - c->space->excess[i], newton->product);
    set_right(c, newton->product);
    if (!answer(c))
        return false;
    for (int32_t u = 0; u < c->unknowns; u++)
        newton->step[u] += left * newton->first[u];
    const double *move = pel_newton_find_move(c->run, 1);
    for (int32_t k = 0; k < c->count; k++)
        c->kinks[k].rate = rate_of(&c->kinks[k], move);
    return true;
}

/* ---- along a step on the pieces ---- */

typedef struct line {
    const crossing *crossing;
    const double *target;
    double slope; /* of the gradient that the matrix began with */
} line;

static double slope_at(const line *l, double share)
{
    const crossing *c = l->crossing;
    const pel_newton_space *space = c->space;
    double sum = (1 - c->way) * (1 - share) * l->slope;
    for (int32_t i = 0; i < space->count; i++)
        sum += (space->excess[i] + share * (l->target[i] - space->excess[i])) * c->kinks[space->kinks[i]].rate;
    for (int32_t k = 0; k < c->count; k++)
        sum -= excess(&c->kinks[k], load_at(&c->kinks[k], share)) * c->kinks[k].rate;
    return sum;
}

/* where q is least: its slope rises all the way (Illinois variant of regula falsi: Dowell, Jarratt 1971) */
static double find_least(const line *l)
{
    double low = 0, high = 1, begin = slope_at(l, 0), low_slope = begin, high_slope;
    if (!(begin < 0))
        return 0;
    while ((high_slope = slope_at(l, high)) < FLAT * begin && high < LONGEST) {
        low = high;
        low_slope = high_slope;
        high *= 2;
    }
    double at = high, slope = high_slope;
    for (int n = 0; n < EVALUATIONS && high_slope > 0 && fabs(slope) > -FLAT * begin; n++) {
        double cut = low_slope / (low_slope - high_slope);
        at = low + (high - low) * pel_min(pel_max(cut, LEAST_CUT), 1 - LEAST_CUT);
        slope = slope_at(l, at);
        if (slope > 0) {
            high = at;
            high_slope = slope;
            low_slope *= 0.5;
        } else {
            low = at;
            low_slope = slope;
            high_slope *= 0.5;
        }
    }
    return at;
}

static void go(crossing *c, const double *target, double share)
{
    pel_newton_space *space = c->space;
    c->way += share * (1 - c->way);
    for (int32_t i = 0; i < space->count; i++)
        space->excess[i] += share * (target[i] - space->excess[i]);
    for (int32_t k = 0; k < c->count; k++)
        c->kinks[k].gap += share * c->kinks[k].rate;
    for (int32_t u = 0; u < c->unknowns; u++)
        c->newton->sum[u] += share * c->newton->step[u];
}

/* the gradient of q, along the axes of the vertices: newton->product; returns its size */
static double find_gradient(const crossing *c)
{
    pel_newton *newton = c->newton;
    const pel_newton_space *space = c->space;
    double square = 0;
    memset(newton->product, 0, (size_t)c->unknowns * sizeof *newton->product);
    for (int32_t i = 0; i < space->count; i++)
        push(&c->kinks[space->kinks[i]], space->excess[i], newton->product);
    for (int32_t k = 0; k < c->count; k++)
        if (has_changed(&c->kinks[k]))
            push(&c->kinks[k], -excess(&c->kinks[k], load_at(&c->kinks[k], 0)), newton->product);
    pel_newton_frames_turn(&c->run->problem->frames, newton->product);
    for (int32_t u = 0; u < c->unknowns; u++) {
        newton->product[u] = newton->fixed[u] ? 0 : newton->product[u] + (1 - c->way) * newton->left[u];
        square += newton->product[u] * newton->product[u];
    }
    return sqrt(square);
}

/* ---- one matrix ---- */

/* Newton's method on the pieces, from newton->step. Returns the size of the gradient that is left. */
static double cross_in_space(crossing *c, double enough)
{
    pel_newton *newton = c->newton;
    double target[TOUCHED], left = 0;
    size_t bytes = (size_t)c->unknowns * sizeof(double);
    line l = {c, target, 0};
    memcpy(newton->first, newton->step, bytes);
    const double *move = pel_newton_find_move(c->run, 1);
    for (int32_t k = 0; k < c->count; k++) {
        c->kinks[k].begin = c->kinks[k].gap;
        c->kinks[k].first_rate = rate_of(&c->kinks[k], move);
    }
    c->way = 0;
    c->space->count = 0;
    for (int n = 0; n < PIECES && !(n > 0 && pel_newton_is_spent(c->run)); n++) {
        if (!touch_changed(c) || !find_target(c, target) || !find_way(c, target))
            break;
        l.slope = pel_newton_dot(newton, newton->left, newton->step);
        double share = find_least(&l);
        go(c, target, share);
        left = find_gradient(c);
        if (!(share > 0) || left <= enough)
            break;
    }
    left = find_gradient(c);
    memcpy(newton->left, newton->product, bytes);
    return left;
}

/* the matrix of the present piece, and its step */
static bool take_piece(crossing *c)
{
    pel_newton *newton = c->newton;
    for (int32_t k = 0; k < c->count; k++)
        c->kinks[k].acts = load_at(&c->kinks[k], 0) > 0;
    newton->has_factor = false;
    pel_newton_assemble(c->run);
    for (int32_t u = 0; u < c->unknowns; u++)
        newton->right[u] = -newton->left[u];
    return c->run->status == PEL_OK && pel_newton_solve_symmetric(c->run);
}

static bool crosses_any(const crossing *c)
{
    const double *move = pel_newton_find_move(c->run, 1);
    for (int32_t k = 0; k < c->count; k++) {
        pel_newton_kink *kink = &c->kinks[k];
        kink->rate = rate_of(kink, move);
        if ((load_at(kink, 1) > 0) != kink->acts)
            return true;
    }
    return false;
}

/* room, once; the factor is that of the matrix, whose responses it gives in few products */
static bool prepare(crossing *c)
{
    pel_newton *newton = c->newton;
    if (newton->space == NULL && (newton->space = pel_allocate(1, sizeof *newton->space)) == NULL) {
        c->run->status = pel_fail_memory(c->run->error);
        return false;
    }
    c->space = newton->space;
    return !newton->is_kept || pel_newton_make_factor(c->run);
}

bool pel_newton_cross_kinks(newton_run *run)
{
    pel_newton *newton = run->newton;
    crossing c = {.run = run, .newton = newton, .unknowns = newton->pattern->unknown_count};
    size_t bytes = (size_t)c.unknowns * sizeof(double);
    c.kinks = run->problem->terms->list_kinks(run->problem->terms->context, &c.count);
    if (!crosses_any(&c))
        return true;
    newton->is_smooth = false;
    if (!prepare(&c))
        return run->status == PEL_OK;
    for (int32_t u = 0; u < c.unknowns; u++)
        newton->left[u] = newton->fixed[u] ? 0 : newton->gradient[u];
    memset(newton->sum, 0, bytes);
    double enough = ENOUGH * sqrt(pel_newton_dot(newton, newton->left, newton->left));
    run->reuses = true;
    for (int n = 0; n < SPACES && !(n > 0 && pel_newton_is_spent(run)) && cross_in_space(&c, enough) > enough; n++)
        if (!take_piece(&c))
            break;
    run->reuses = false;
    memcpy(newton->step, newton->sum, bytes);
    return run->status == PEL_OK;
}

void pel_newton_space_destroy(pel_newton_space *space)
{
    if (space != NULL) {
        pel_free(space->reduced);
        pel_free(space->volume_responses);
    }
    pel_free(space);
}
