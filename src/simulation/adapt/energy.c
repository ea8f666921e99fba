#include "adapt/energy.h"

#include "base/assert.h"
#include "math/extremes.h"
#include "refined/event_energy.h"

#include <float.h>
#include <string.h>

enum { TRIAL_LIMIT = 24 };
/* permitted change, relative to the energy of the changed elements */
#define TOLERANCE 1e-3
/* share of the energy of the whole body that is ignored, so that a recovered surface is unchanged. Lost energy is
   restored only up to it: moving vertices against their forces creates new ones */
#define ALLOWANCE 5e-3
/* displacements below this many roundings of a position are ignored, those beyond this share of an edge are refused */
#define ROUNDINGS 16
#define MOST_MOVE 0.2

typedef struct keeper {
    pel_sim *sim;
    int32_t body;
    bool only_new;      /* new vertices move, else all of the event */
    double least, most; /* m: largest displacement of a vertex per iteration */
    double force_square;
    /* of active->event_direction: its largest part, and the forces along it */
    double largest, slope;
} keeper;

double pel_refine_energy_before(pel_sim *sim, int32_t body)
{
    PEL_ASSERT_INDEX(body, sim->model->body_count);
    if (sim->model->bodies[body].shell == NULL)
        return 0;
    pel_shell_energy energy = pel_shell_forces_add(sim->shells, sim->state->position, pel_instant(pel_sim_time(sim)),
                                                   PEL_SHELL_ELASTIC, sim->pool, NULL);
    return energy.membrane + energy.bending + energy.fibres + energy.volume;
}

/* the vertices of the event, and the moving ones */
static int32_t place_count(const keeper *k, bool moving)
{
    return moving && k->only_new ? k->sim->model->bodies[k->body].front->added_count : k->sim->active->dirty_count;
}

static int32_t place_at(const keeper *k, int32_t i, bool moving)
{
    const pel_refined_body *own = &k->sim->active->bodies[k->body];
    return own->model_index[moving && k->only_new ? own->front->added_vertices[i] : k->sim->active->dirty[i]];
}

static bool moves(const keeper *k, int32_t place)
{
    const pel_sim *sim = k->sim;
    return sim->model->inverse_mass[place] > 0 && (sim->held == NULL || !sim->held[place]);
}

/* energy, and the forces into sim->force */
static double evaluate(keeper *k)
{
    pel_sim *sim = k->sim;
    int32_t *places = sim->active->event_places, count = place_count(k, false);
    bool has_shell = sim->model->bodies[k->body].shell != NULL;
    double energy = 0;
    if (has_shell)
        memset(sim->force, 0, (size_t)sim->model->vertex_count * sizeof *sim->force);
    for (int32_t i = 0; i < count; i++) {
        places[i] = place_at(k, i, false);
        sim->force[places[i]] = (pel_record){0};
    }
    energy = pel_event_energy(sim->active, k->body, sim->state, places, count, sim->force);
    if (has_shell) {
        pel_shell_energy shells =
            pel_shell_forces_add(sim->shells, sim->state->position, pel_instant(pel_sim_time(sim)), PEL_SHELL_ELASTIC,
                                 sim->pool, sim->force);
        energy += shells.membrane + shells.bending + shells.fibres + shells.volume;
    }
    k->force_square = 0;
    for (int32_t i = 0; i < place_count(k, true); i++) {
        int32_t place = place_at(k, i, true);
        double force[3];
        pel_vertex_position(sim->force, place, force);
        k->force_square += moves(k, place) ? pel_vec3_squared_length(force) : 0;
    }
    return energy;
}

/* The forces, and `share` of the direction before: conjugate directions (Fletcher and Reeves 1964) find the least
   energy of a bent sheet some ten times sooner than forces alone. */
static void set_direction(keeper *k, double share)
{
    pel_record *direction = k->sim->active->event_direction;
    double square = 0;
    k->slope = 0;
    for (int32_t i = 0; i < place_count(k, true); i++) {
        int32_t place = place_at(k, i, true);
        double force[3], each[3];
        pel_vertex_position(k->sim->force, place, force);
        for (int c = 0; c < 3; c++) {
            each[c] = moves(k, place) ? force[c] + (share > 0 ? share * (double)direction[i][c] : 0) : 0;
            direction[i][c] = (pel_real)each[c];
        }
        k->slope += pel_vec3_dot(force, each);
        square = pel_max(square, pel_vec3_squared_length(each));
    }
    k->largest = sqrt(square);
}

static void move(const keeper *k, double way)
{
    pel_state *state = k->sim->state;
    const pel_record *direction = k->sim->active->event_direction;
    for (int32_t i = 0; i < place_count(k, true); i++) {
        int32_t place = place_at(k, i, true);
        for (int c = 0; c < 3; c++) {
            pel_real step = (pel_real)way * direction[i][c];
            state->position[place][c] += step;
            state->position_before[place][c] += step;
        }
    }
}

/* way along the direction to energy `target`, or to the least energy, by the parabola that has energy `tried` at
   `trial` */
static double way_of_parabola(const keeper *k, double energy, double target, double trial, double tried)
{
    double slope = k->slope, curvature = 2 * (tried - energy + trial * slope) / (trial * trial);
    if (!(curvature > 0))
        return trial;
    double root = slope * slope - 2 * curvature * (energy - target);
    return root > 0 ? (slope - sqrt(root)) / curvature : slope / curvature;
}

/* by the shortest edge at the vertices that move, and the rounding of their positions */
static void set_range(keeper *k)
{
    const pel_model *model = k->sim->model;
    double edge = HUGE_VAL, far = 0, x[3];
    for (int32_t i = 0; i < place_count(k, true); i++) {
        int32_t place = place_at(k, i, true), slice = place / PEL_WIDTH, lane = place % PEL_WIDTH;
        for (int32_t slot = model->slot_begin[slice]; slot < model->slot_end[slice]; slot++)
            if (model->neighbours[slot][lane] != place)
                edge = pel_min(edge, (double)model->rest_lengths[slot][lane]);
        pel_vertex_position(k->sim->state->position, place, x);
        for (int c = 0; c < 3; c++)
            far = pel_max(far, fabs(x[c]));
    }
    k->least = ROUNDINGS * far * (sizeof(pel_real) == 8 ? DBL_EPSILON : (double)FLT_EPSILON);
    k->most = MOST_MOVE * edge;
}

/* one trial and the parabola through it; the new energy, or the old one and false when that is no better */
static bool improve(keeper *k, double target, double *energy)
{
    double trial = (*energy - target) / k->slope, limit = k->most / k->largest;
    trial = pel_max(pel_min(trial, limit), -limit);
    if (!(k->slope > 0 && fabs(trial) * k->largest > k->least))
        return false;
    move(k, trial);
    double tried = evaluate(k), way = way_of_parabola(k, *energy, target, trial, tried);
    way = pel_max(pel_min(way, limit), -limit);
    move(k, way - trial);
    double reached = evaluate(k);
    if (fabs(reached - target) < fabs(*energy - target)) {
        *energy = reached;
        return true;
    }
    move(k, -way);
    *energy = evaluate(k);
    return false;
}

/* ends where the energy is the target, or no direction leads nearer to it */
static void approach(keeper *k, double target, double *energy)
{
    double share = 0, before = 0;
    for (int n = 0; n < TRIAL_LIMIT && fabs(*energy - target) > TOLERANCE * target; n++) {
        before = k->force_square;
        set_direction(k, share);
        bool better = improve(k, target, energy);
        /* again along the forces alone */
        if (!better && share == 0)
            return;
        share = better && *energy > target && before > 0 ? k->force_square / before : 0;
    }
}

/* springs of the slices from begin to end - 1, until they have more energy than is asked for */
static double spring_energy(const pel_sim *sim, int32_t begin, int32_t end, double enough)
{
    double sum = 0;
    for (int32_t slice = begin; slice < end && sum <= enough; slice++)
        sum = pel_slice_energy_add(sim->model, sim->state, slice, false, sum);
    return sum;
}

/* Whether the body has surely more energy than an event has lost or gained times 1 / ALLOWANCE. The energy stands most
   of all where the surface is fine. */
static bool is_allowed(const pel_sim *sim, int32_t body, double change)
{
    const pel_body *b = &sim->model->bodies[body];
    int32_t fine = sim->active->bodies[body].fine_begin / PEL_WIDTH;
    double enough = fabs(change) / ALLOWANCE * (1 + 1e-9);
    return spring_energy(sim, fine, b->slice_end, enough) > enough;
}

void pel_refine_keep_energy(pel_sim *sim, int32_t body, double shells_before)
{
    PEL_ASSERT_INDEX(body, sim->model->body_count);
    keeper k = {.sim = sim, .body = body, .only_new = sim->model->bodies[body].front->added_count > 0};
    double target = sim->active->event_energy + shells_before, energy = evaluate(&k);
    if (fabs(energy - target) <= TOLERANCE * target)
        return;
    if (is_allowed(sim, body, energy - target))
        return;
    const pel_body *b = &sim->model->bodies[body];
    double springs = spring_energy(sim, b->slice_begin, b->slice_end, HUGE_VAL);
    double allowance = ALLOWANCE * (springs + shells_before);
    if (fabs(energy - target) <= allowance)
        return;
    target -= energy < target ? allowance : 0;
    set_range(&k);
    approach(&k, target, &energy);
    if (!k.only_new || fabs(energy - target) <= TOLERANCE * target)
        return;
    k.only_new = false;
    energy = evaluate(&k);
    set_range(&k);
    approach(&k, target, &energy);
}
