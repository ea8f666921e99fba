/* Looks at the stiffness ahead. A material that stiffens, and edges that become short, make an explicit step too long
   that is stable at rest. The largest stretch of an edge tells cheaply when the stiffness may be another one; then it
   is found by power iteration, where the body will be. Between looks it is taken from the last one and its slope,
   twice that slope to be safe: the stiffness of Gent's rubber has a pole. */
#include "method/stiffening.h"

#include "base/memory.h"
#include "base/status.h"
#include "math/extremes.h"
#include "math/functions.h"
#include "solve/shell_stability.h"

#include <math.h>

/* whole steps at most between two measurements of the stretch where nothing is near */
enum { MOST_INTERVAL = 16 };
/* of the stretch that is left, that it may change by from one measurement to the next */
#define CALM_SHARE 0.25
/* that a longer part has to leave to the limit: sizes that change to and fro give and take energy */
#define GROWTH_ROOM 1.4
/* of the limit that a whole step and a part may have, and that a look has to leave for the next one to wait */
#define WHOLE_SHARE 0.9
#define PART_SHARE 0.36
#define LOOK_SHARE 0.85
/* of the limit at rest: below it what a body stores and gives back may change too fast for steps as long as stability
   would allow, where the limit falls as steeply as that; St. Venant's material, whose steps may be whole, has 1.5 */
#define STIFF_SHARE 0.7
#define STEEP_SLOPE 2
/* steps or parts after which a body in parts, or whose limit is below so many dt, is looked at again, as another place
   may be the stiffest while the largest stretch is the same */
#define NEAR_SHARE 1.2
enum { MOST_AGE = 48 };
/* slope before two looks have told it */
#define FIRST_SLOPE 1.5
/* stretch that changes nothing worth a look, and changes that are worth one at least and at most */
#define SMALL_STRETCH 0.02
#define LEAST_CHANGE 5e-4
#define MOST_CHANGE 0.2

pel_status pel_stiffening_create(pel_sim *sim, pel_error *error)
{
    if (sim->stiffening == NULL)
        sim->stiffening = pel_allocate(1, sizeof *sim->stiffening);
    if (sim->stiffening == NULL)
        return pel_fail_memory(error);
    pel_stiffening_forget(sim);
    return PEL_OK;
}

void pel_stiffening_destroy(pel_sim *sim)
{
    pel_free(sim->stiffening);
}

void pel_stiffening_forget(pel_sim *sim)
{
    pel_stiffening *own = sim->stiffening;
    if (own != NULL)
        *own = (pel_stiffening){.safe = SMALL_STRETCH, .slope = FIRST_SLOPE, .size = PEL_PART_LIMIT, .interval = 1};
}

static pel_real squared(pel_record d)
{
    return d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
}

/* of all edges, where the vertices will be after some time if nothing accelerates them */
static double stretch_ahead(const pel_sim *sim, double ahead)
{
    const pel_model *model = sim->model;
    const pel_record *x = sim->state->position, *v = sim->state->velocity;
    const pel_real h = (pel_real)ahead;
    pel_real most = 1, least = 1;
    for (int32_t slice = 0; slice < model->slice_count; slice++)
        for (int32_t slot = model->slot_begin[slice]; slot < model->slot_end[slice]; slot++)
            for (int32_t lane = 0; lane < PEL_WIDTH; lane++) {
                const int32_t i = slice * PEL_WIDTH + lane, j = model->neighbours[slot][lane];
                if (j <= i)
                    continue;
                const pel_real now = squared(x[j] - x[i] + h * (v[j] - v[i])),
                               rest = squared(model->rest[j] - model->rest[i]);
                if (now > most * rest)
                    most = now / rest;
                if (now < least * rest)
                    least = now / rest;
            }
    return 0.5 * pel_ln(pel_max((double)most, 1 / pel_max((double)least, 1e-12)));
}

/* how far the stretch may be from that of the last look, for a step or part of that length */
static double range_of(const pel_stiffening *own, double length)
{
    const double room = pel_ln(pel_max(LOOK_SHARE * own->limit / length, 1)) / (2 * own->slope);
    return pel_max(LEAST_CHANGE, pel_min(MOST_CHANGE, room));
}

/* false when out of memory */
static bool find_limit(const pel_sim *sim, const pel_state *state, double *limit)
{
    pel_stability stability;
    double stiffness;
    pel_stability_bound(sim->model, &stability);
    pel_status status = pel_shell_stability_near(sim->model, state, sim->shells, sim->pool, &stiffness);
    *limit = stiffness > 0 ? pel_stability_dt(&stability, stiffness, true) : 0;
    return status == PEL_OK;
}

static pel_status look_at_rest(pel_sim *sim, pel_error *error)
{
    pel_stiffening *own = sim->stiffening;
    pel_state there = *sim->state;
    there.position = sim->model->rest;
    if (!find_limit(sim, &there, &own->rest))
        return pel_fail_memory(error);
    own->limit = own->rest;
    own->stretch = 0;
    return PEL_OK;
}

/* where the body will be: nothing else has written the new positions yet */
static pel_status look(pel_sim *sim, double stretch, double ahead, pel_error *error)
{
    pel_stiffening *own = sim->stiffening;
    const pel_state *state = sim->state;
    for (int32_t v = 0; v < sim->model->vertex_count; v++) {
        const pel_real mass = state->position[v][3];
        state->position_next[v] = state->position[v] + (pel_real)ahead * state->velocity[v];
        state->position_next[v][3] = mass;
    }
    pel_state there = *state;
    there.position = state->position_next;
    double limit;
    if (!find_limit(sim, &there, &limit))
        return pel_fail_memory(error);
    const double change = stretch - own->stretch;
    const double slope = fabs(change) > LEAST_CHANGE && limit > 0 ? pel_ln(own->limit / limit) / change : FIRST_SLOPE;
    own->slope = pel_max(slope, FIRST_SLOPE);
    own->stretch = stretch;
    own->limit = limit;
    own->age = 0;
    return PEL_OK;
}

/* by what is known; that falls the faster the further from the last look */
static bool holds(const pel_stiffening *own, double length, double stretch, bool is_whole)
{
    const double limit = own->limit * pel_exp(-2 * own->slope * pel_max(stretch - own->stretch, 0));
    const bool is_steep = (own->slope > STEEP_SLOPE || own->size < PEL_PART_LIMIT) && limit < STIFF_SHARE * own->rest;
    return length <= (is_whole && !is_steep ? WHOLE_SHARE : PART_SHARE) * limit;
}

/* whether a step or part of that length is stable until `ahead`; looks there where that is not known */
static pel_status check(pel_sim *sim, double length, double ahead, bool *is_stable, pel_error *error)
{
    pel_stiffening *own = sim->stiffening;
    const bool is_whole = length >= sim->solver.dt;
    const double stretch = stretch_ahead(sim, ahead);
    own->seen = stretch;
    const bool is_close = own->size < PEL_PART_LIMIT || own->limit < NEAR_SHARE * sim->solver.dt;
    const bool is_old = own->age >= MOST_AGE && is_close;
    *is_stable = stretch <= own->safe && !is_old;
    if (*is_stable)
        return PEL_OK;
    pel_status status = own->rest > 0 ? PEL_OK : look_at_rest(sim, error);
    const double change = fabs(stretch - own->stretch);
    const bool is_far = is_old || !(change <= pel_max(range_of(own, length), is_whole ? SMALL_STRETCH : 0));
    const bool is_doubtful = !holds(own, length, stretch, is_whole) || !holds(own, length, stretch, false);
    if (status == PEL_OK && (is_far || (change > SMALL_STRETCH && is_doubtful)))
        status = look(sim, stretch, ahead, error);
    *is_stable = status == PEL_OK && holds(own, length, stretch, is_whole);
    if (status == PEL_OK && !*is_stable && is_whole && ahead <= 2 * length)
        own->safe = pel_min(own->safe, stretch);
    if (*is_stable && is_whole)
        own->safe = pel_max(stretch, own->stretch + 0.5 * range_of(own, length));
    return status;
}

static pel_status refuse(const pel_sim *sim, pel_error *error)
{
    const double limit = sim->stiffening->limit;
    pel_fail(error, PEL_DIVERGED, "the bodies have stiffened: the limit of dt is %.3g now, too far below dt %g", limit,
             sim->solver.dt);
    if (limit > 0)
        pel_fail_remedy(error, "use solver.dt: %.2g, or method implicit: a step is taken in %d parts at most",
                        pel_min(PART_SHARE * limit * PEL_PART_LIMIT / 2, sim->solver.dt / 4), PEL_PART_LIMIT);
    return PEL_DIVERGED;
}

pel_status pel_stiffening_find(pel_sim *sim, int32_t *size, pel_error *error)
{
    pel_stiffening *own = sim->stiffening;
    const double dt = sim->solver.dt;
    bool is_stable = true;
    pel_status status = PEL_OK;
    *size = PEL_PART_LIMIT;
    if (own == NULL)
        return PEL_OK;
    own->age += own->age < MOST_AGE;
    if (own->size == PEL_PART_LIMIT && sim->part.at == 0 && sim->state->step >= own->next) {
        const double before = own->seen;
        status = check(sim, dt, own->interval * dt, &is_stable, error);
        own->is_near = !is_stable;
        const bool is_calm =
            fabs(own->seen - before) < CALM_SHARE * pel_max(own->safe - own->seen, 0.5 * SMALL_STRETCH);
        const int32_t wanted = is_calm ? 2 * own->interval : own->interval / 4;
        own->interval = wanted < 1 ? 1 : wanted > MOST_INTERVAL ? MOST_INTERVAL : wanted;
        own->next = sim->state->step + own->interval;
    }
    if (status != PEL_OK || (own->size == PEL_PART_LIMIT && !own->is_near))
        return status;
    int32_t next = own->size < PEL_PART_LIMIT ? 2 * own->size : PEL_PART_LIMIT;
    for (is_stable = false; status == PEL_OK && next > 0; next /= 2) {
        const double length = dt * next / PEL_PART_LIMIT;
        status = check(sim, next > own->size ? GROWTH_ROOM * length : length, 2 * length, &is_stable, error);
        if (status != PEL_OK || is_stable)
            break;
    }
    if (status == PEL_OK && next == 0)
        return refuse(sim, error);
    own->size = *size = status == PEL_OK ? next : own->size;
    return status;
}

/* ---- snapshots ---- */

void pel_stiffening_transfer(pel_cursor *at, const pel_sim *sim, int32_t unused)
{
    (void)unused;
    if (sim->stiffening != NULL)
        pel_transfer(at, sim->stiffening, sizeof *sim->stiffening);
}

bool pel_stiffening_restore(pel_sim *sim)
{
    const pel_stiffening *own = sim->stiffening;
    if (own == NULL)
        return true;
    const bool is_size = own->size > 0 && own->size <= PEL_PART_LIMIT && (own->size & (own->size - 1)) == 0;
    if (is_size && own->safe >= 0 && own->limit >= 0 && own->slope >= FIRST_SLOPE && own->interval > 0 &&
        own->interval <= MOST_INTERVAL && own->age >= 0 && own->age <= MOST_AGE && isfinite(own->stretch))
        return true;
    pel_stiffening_forget(sim);
    return false;
}
