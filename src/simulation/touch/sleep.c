/* When a body rests. Layers carry their loads by few sweeps, so that vertices at rest still tremble, by up to some
   thousandths of the thickness; a limit of the velocity would either never hold or hold for slow motion as well. So
   positions are compared over time: within a window of half a second every vertex stays within a hundredth of the
   contact thickness of its mean place in the window before, and the mean place moves by less than a thousandth.
   Tremor has no mean motion. What creeps, swings or settles more slowly than that, two thousandths of the thickness per
   second, is at rest for any other purpose of contact too. */
#include "touch/sleep.h"

#include "attach/joint.h"
#include "base/assert.h"
#include "base/hash.h"
#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "boundary/loads.h"
#include "math/extremes.h"
#include "stage/accessors.h"
#include "tool/solid.h"
#include "tool/tool.h"
#include "touch/contact.h"

#include <string.h>

/* s; steps at least */
#define WINDOW 0.5
enum { LEAST_STEPS = 8 };
/* of the contact thickness: around the mean place, and of the mean place between two windows */
#define STAY_SHARE 1e-2
#define CREEP_SHARE 1e-3
/* relative: sums of loads that differ by less are the same */
#define LOAD_TOLERANCE 1e-9

/* what the state of a sleeping body depends on */
typedef struct sleep_cause {
    uint64_t state;    /* hash of positions, velocities and numbers that change with time */
    double load, size; /* N: sum of the loads with a weight for each component, and of their sizes */
} sleep_cause;

typedef struct sleep_body {
    sleep_cause cause;
    int32_t island; /* of a sleeping body: the lowest number in it */
    int32_t count;  /* steps of the present window */
    uint8_t is_asleep, is_still, unused[6];
} sleep_body;

struct pel_sleep {
    sleep_body *bodies;     /* (body_count) */
    pel_record *mean, *sum; /* (vertex_count) m: mean place in the last window, sum of the ways from it in this one */
    uint8_t *is_asleep;     /* (body_count) for the method */
    uint8_t *can_move;      /* (body_count) has vertices that are not pinned */
    int32_t *parents;       /* (body_count) scratch: forest of islands */
    uint8_t *is_awake;      /* (body_count) scratch: by the root of an island, it stays awake */
    uint8_t *fell_asleep;   /* (body_count) scratch: in this step */
    int32_t mobile_count;   /* bodies that can move */
};

/* ---- creation ---- */

static void find_pins(const pel_sim *sim, pel_sleep *sleep)
{
    const pel_model *model = sim->model;
    sleep->mobile_count = 0;
    for (int32_t b = 0; b < model->body_count; b++) {
        sleep->can_move[b] = false;
        for (int32_t v = model->bodies[b].slice_begin * PEL_WIDTH; v < pel_body_place_end(model, b); v++)
            sleep->can_move[b] |= model->inverse_mass[v] > 0;
        sleep->mobile_count += sleep->can_move[b];
    }
}

pel_status pel_sleep_create(pel_sim *sim, pel_error *error)
{
    if (sim->contacts == NULL || !sim->touch->def.sleep || sim->loads->wind != NULL || !sim->contacts->def.has_layers ||
        pel_sim_is_explicit(sim) || sim->holds != NULL || sim->def.tie_count > 0 || sim->ties != NULL)
        return PEL_OK;
    pel_sleep *sleep = sim->touch->sleep = pel_allocate(1, sizeof *sleep);
    if (sleep == NULL)
        return pel_fail_memory(error);
    int32_t count = sim->model->body_count, vertices = sim->model->vertex_count;
    if (!PEL_ALLOCATE_ALL(PEL_ROOM(sleep->bodies, count), PEL_ROOM(sleep->is_asleep, count),
                          PEL_ROOM(sleep->can_move, count), PEL_ROOM(sleep->parents, count),
                          PEL_ROOM(sleep->is_awake, count), PEL_ROOM(sleep->fell_asleep, count),
                          PEL_ROOM_ALIGNED(sleep->mean, vertices), PEL_ROOM_ALIGNED(sleep->sum, vertices)))
        return pel_fail_memory(error);
    find_pins(sim, sleep);
    return PEL_OK;
}

void pel_sleep_destroy(pel_sim *sim)
{
    pel_sleep *sleep = sim->touch->sleep;
    if (sleep == NULL)
        return;
    PEL_FREE_ALL(sleep->bodies, sleep->is_asleep, sleep->can_move, sleep->parents, sleep->is_awake, sleep->fell_asleep,
                 sleep->mean, sleep->sum);
    pel_free(sleep);
    sim->asleep = NULL;
}

/* ---- what is asleep ---- */

/* it stays where it is in this step */
static bool is_still(const pel_tool *tool)
{
    return memcmp(tool->pose_before.position, tool->pose_wanted.position, sizeof tool->pose.position) == 0 &&
           memcmp(tool->pose_before.rotation, tool->pose_wanted.rotation, sizeof tool->pose.rotation) == 0 &&
           !(tool->pose_before.along < tool->pose_wanted.along);
}

/* for the set, the method and supports */
static void write_sleep(pel_sim *sim)
{
    pel_sleep *sleep = sim->touch->sleep;
    pel_contact_set *contacts = sim->contacts;
    int32_t body_count = sim->model->body_count;
    contacts->asleep_count = 0;
    for (int32_t b = 0; b < body_count; b++) {
        sleep->is_asleep[b] = sleep->bodies[b].is_asleep;
        contacts->asleep_count += sleep->is_asleep[b];
        contacts->is_asleep[b] = sleep->is_asleep[b] || !sleep->can_move[b];
    }
    for (int32_t i = 0; i < sim->tools->count; i++)
        contacts->is_asleep[body_count + i] = is_still(&sim->tools->items[i]);
    sim->asleep = contacts->asleep_count > 0 ? sleep->is_asleep : NULL;
}

/* pairs of what sleeps are not searched: the list does not serve where that has changed */
static void tell(pel_sim *sim)
{
    pel_sleep *sleep = sim->touch->sleep;
    for (int32_t b = 0; b < sim->model->body_count; b++)
        sim->contacts->has_home &= sleep->is_asleep[b] == sleep->bodies[b].is_asleep;
    write_sleep(sim);
}

static void wake(pel_sleep *sleep, int32_t body, int32_t body_count)
{
    int32_t island = sleep->bodies[body].island;
    for (int32_t b = 0; b < body_count; b++)
        if (sleep->bodies[b].is_asleep && sleep->bodies[b].island == island) {
            sleep->bodies[b].is_asleep = sleep->bodies[b].is_still = false;
            sleep->bodies[b].count = 0;
        }
}

static void wake_all(pel_sim *sim)
{
    pel_sleep *sleep = sim->touch->sleep;
    for (int32_t b = 0; sleep != NULL && b < sim->model->body_count; b++)
        if (sleep->bodies[b].is_asleep)
            wake(sleep, b, sim->model->body_count);
    if (sleep != NULL)
        tell(sim);
}

void pel_sleep_follow_surface(pel_sim *sim)
{
    if (sim->touch->sleep == NULL)
        return;
    find_pins(sim, sim->touch->sleep);
    wake_all(sim);
}

/* ---- causes ---- */

static uint64_t hash_law(const pel_sim *sim, int32_t body, uint64_t hash)
{
    const pel_body_batches *own = &sim->batches->bodies[body];
    for (int32_t i = 0; i < own->batch_count; i++) {
        hash = pel_hash_block(hash, &own->batches[i].law.rest_length, sizeof own->batches[i].law.rest_length);
        hash = pel_hash_word(hash, own->batches[i].is_on);
    }
    const pel_shell *shell = sim->model->bodies[body].shell;
    const double growth = shell != NULL ? pel_shell_growth(shell, pel_sim_next_time(sim)) : 0;
    hash = pel_hash_block(hash, &growth, sizeof growth);
    return pel_hash_block(hash, &sim->state->bending[body].weight, sizeof sim->state->bending[body].weight);
}

/* sim->force holds the loads */
static sleep_cause cause_of(const pel_sim *sim, int32_t body)
{
    const pel_model *model = sim->model;
    const pel_state *state = sim->state;
    int32_t begin = model->bodies[body].slice_begin * PEL_WIDTH, end = pel_body_place_end(model, body);
    size_t size = (size_t)(end - begin) * sizeof *state->position;
    sleep_cause cause = {pel_hash_block(PEL_HASH_START, state->position + begin, size), 0, 0};
    cause.state = pel_hash_block(cause.state, state->velocity + begin, size);
    cause.state = pel_hash_block(cause.state, state->factors[body], sizeof *state->factors);
    cause.state = hash_law(sim, body, cause.state);
    for (int32_t v = begin; v < end; v++)
        for (int k = 0; k < 3; k++) {
            double force = (double)sim->force[v][k];
            cause.load += (1 + 0.25 * ((7 * (v - begin) + 3 * k) % 11)) * force;
            cause.size += fabs(force);
        }
    return cause;
}

static bool is_same(const sleep_cause *a, const sleep_cause *b)
{
    double limit = LOAD_TOLERANCE * pel_max(a->size, b->size);
    return a->state == b->state && fabs(a->load - b->load) <= limit && fabs(a->size - b->size) <= limit;
}

/* the mean loads and pressures of the step that ends at a time, in sim->force */
static void find_loads(pel_sim *sim, double end)
{
    const pel_span span = {.time = end, .back = sim->step.dt};
    memset(sim->force, 0, (size_t)sim->model->vertex_count * sizeof *sim->force);
    pel_loads_add(sim, span, sim->state->position, sim->force);
    pel_shell_forces_press(sim->shells, sim->state->position, span, sim->pool, sim->force);
    sim->present.has_force = false;
}

static bool is_held(const pel_sim *sim, int32_t body)
{
    for (int32_t i = 0; i < sim->tools->count; i++) {
        const pel_tool *tool = &sim->tools->items[i];
        for (int32_t k = 0; k < tool->held_count; k++)
            if (sim->model->body_of_slice[tool->held[k] / PEL_WIDTH] == body)
                return true;
    }
    return false;
}

void pel_sleep_follow_held(pel_sim *sim)
{
    pel_sleep *sleep = sim->touch->sleep;
    if (sleep == NULL || sim->contacts->asleep_count == 0)
        return;
    for (int32_t b = 0; b < sim->model->body_count; b++)
        if (sleep->bodies[b].is_asleep && is_held(sim, b))
            wake(sleep, b, sim->model->body_count);
    tell(sim);
}

void pel_sleep_begin_step(pel_sim *sim)
{
    pel_sleep *sleep = sim->touch->sleep;
    if (sleep == NULL)
        return;
    tell(sim);
    if (sim->contacts->asleep_count == 0)
        return;
    if (sim->contacts->tangles.count > 0) {
        wake_all(sim);
        return;
    }
    find_loads(sim, pel_sim_next_time(sim));
    for (int32_t b = 0; b < sim->model->body_count; b++) {
        if (!sleep->bodies[b].is_asleep)
            continue;
        sleep_cause now = cause_of(sim, b);
        if (!is_same(&now, &sleep->bodies[b].cause))
            wake(sleep, b, sim->model->body_count);
    }
    memset(sim->force, 0, (size_t)sim->model->vertex_count * sizeof *sim->force);
    pel_sleep_follow_held(sim);
}

/* ---- touch ---- */

/* wakes the body of a pair whose other side moves */
static void meet(pel_sim *sim, int32_t a, int32_t b)
{
    const uint8_t *is_asleep = sim->contacts->is_asleep;
    if (is_asleep[a] == is_asleep[b])
        return;
    int32_t body = is_asleep[a] ? a : b;
    if (body < sim->model->body_count && sim->touch->sleep->bodies[body].is_asleep)
        wake(sim->touch->sleep, body, sim->model->body_count);
}

bool pel_sleep_meet(pel_sim *sim)
{
    const pel_contact_set *contacts = sim->contacts;
    int32_t before = contacts != NULL ? contacts->asleep_count : 0;
    if (before == 0)
        return false;
    for (int32_t c = 0; c < contacts->list.count; c++)
        meet(sim, contacts->group_of_point[contacts->keys[c].points[0]],
             contacts->group_of_point[contacts->keys[c].points[3]]);
    tell(sim);
    return contacts->asleep_count < before;
}

bool pel_sleep_meet_tools(pel_sim *sim)
{
    const pel_sim_solids *solids = sim->tools->solids;
    int32_t before = sim->contacts != NULL ? sim->contacts->asleep_count : 0;
    if (before == 0 || solids == NULL)
        return false;
    for (int32_t c = 0; c < solids->list.count; c++)
        meet(sim, sim->model->body_of_slice[solids->list.contacts[c].vertices[0] / PEL_WIDTH],
             sim->model->body_count + solids->pairs[c].tool);
    tell(sim);
    return sim->contacts->asleep_count < before;
}

bool pel_sleep_is_everywhere(const pel_sim *sim)
{
    const pel_sleep *sleep = sim->touch->sleep;
    if (sleep == NULL || sim->contacts->asleep_count == 0 || sim->contacts->asleep_count < sleep->mobile_count)
        return false;
    /* pins of bodies that cannot move have loads in each step */
    if (sim->reactions != NULL && sleep->mobile_count < sim->model->body_count)
        return false;
    for (int32_t i = 0; i < sim->tools->count; i++) {
        const pel_tool *tool = &sim->tools->items[i];
        bool may_grasp = tool->grasp && tool->phase == PEL_GRASP_WAITING;
        if (!is_still(tool) || may_grasp)
            return false;
    }
    return true;
}

/* ---- rest ---- */

static double distance(pel_record a, pel_record b)
{
    double square = 0;
    for (int k = 0; k < 3; k++) {
        double way = (double)(a[k] - b[k]);
        square += way * way;
    }
    return sqrt(square);
}

/* the window of a body is over: whether its mean place has stayed */
static bool end_window(const pel_sim *sim, int32_t body, double limit)
{
    pel_sleep *sleep = sim->touch->sleep;
    pel_real share = (pel_real)(1.0 / sleep->bodies[body].count);
    double most = 0;
    for (int32_t v = sim->model->bodies[body].slice_begin * PEL_WIDTH; v < pel_body_place_end(sim->model, body); v++) {
        pel_record mean = sleep->mean[v] + share * sleep->sum[v];
        most = pel_max(most, distance(mean, sleep->mean[v]));
        sleep->mean[v] = mean;
    }
    sleep->bodies[body].count = 0;
    return most <= limit;
}

static void follow(const pel_sim *sim, int32_t body)
{
    pel_sleep *sleep = sim->touch->sleep;
    sleep_body *own = &sleep->bodies[body];
    const pel_record *x = sim->state->position;
    int32_t begin = sim->model->bodies[body].slice_begin * PEL_WIDTH, end = pel_body_place_end(sim->model, body);
    double thickness = sim->contacts->groups[body].thickness, most = 0;
    if (own->count == 0)
        memset(sleep->sum + begin, 0, (size_t)(end - begin) * sizeof *x);
    for (int32_t v = begin; v < end; v++) {
        most = pel_max(most, distance(x[v], sleep->mean[v]));
        sleep->sum[v] += x[v] - sleep->mean[v];
    }
    own->count++;
    if (!(most <= STAY_SHARE * thickness)) {
        memcpy(sleep->mean + begin, x + begin, (size_t)(end - begin) * sizeof *x);
        own->count = 0;
        own->is_still = false;
    } else if (own->count >= LEAST_STEPS && own->count * sim->solver.dt >= WINDOW)
        own->is_still = end_window(sim, body, CREEP_SHARE * thickness);
}

/* of islands */
static int32_t root_of(const pel_sleep *sleep, int32_t body)
{
    while (sleep->parents[body] != body)
        body = sleep->parents[body];
    return body;
}

static void connect(pel_sleep *sleep, int32_t a, int32_t b)
{
    if (!sleep->can_move[a] || !sleep->can_move[b])
        return;
    a = root_of(sleep, a);
    b = root_of(sleep, b);
    sleep->parents[a < b ? b : a] = a < b ? a : b;
}

static void connect_islands(const pel_sim *sim)
{
    const pel_contact_set *contacts = sim->contacts;
    pel_sleep *sleep = sim->touch->sleep;
    for (int32_t b = 0; b < sim->model->body_count; b++)
        sleep->parents[b] = b;
    for (int32_t c = 0; c < contacts->list.count; c++) {
        const pel_contact_key *key = &contacts->keys[c];
        int32_t a = contacts->group_of_point[key->points[0]], b = contacts->group_of_point[key->points[3]];
        if (pel_max(a, b) < sim->model->body_count)
            connect(sleep, a, b);
    }
    for (int32_t i = 0; i < pel_sim_joint_count(sim); i++)
        if (sim->joints->items[i].def.to_body >= 0)
            connect(sleep, sim->joints->items[i].def.body, sim->joints->items[i].def.to_body);
}

/* in a collision with restitution, driven by a motor, or caving in */
static bool is_busy(const pel_sim *sim, int32_t body)
{
    int32_t group_count = sim->contact_forces.group_count;
    const pel_body_batches *own = &sim->batches->bodies[body];
    for (int32_t g = 0; sim->touch->collisions != NULL && g < group_count; g++)
        if (sim->touch->collisions[body * group_count + g].is_on ||
            (g < sim->model->body_count && sim->touch->collisions[g * group_count + body].is_on))
            return true;
    for (int32_t i = 0; i < pel_sim_joint_count(sim); i++) {
        const pel_joint *joint = &sim->joints->items[i];
        if (pel_joint_is_running(joint) && (joint->def.body == body || joint->def.to_body == body))
            return true;
    }
    for (int32_t i = 0; i < own->batch_count; i++)
        if (own->batches[i].kind == PEL_CONSTRAINT_CAVE && own->batches[i].is_on)
            return true;
    return false;
}

static void fall_asleep(pel_sim *sim, int32_t body)
{
    pel_state *state = sim->state;
    int32_t begin = sim->model->bodies[body].slice_begin * PEL_WIDTH, end = pel_body_place_end(sim->model, body);
    size_t size = (size_t)(end - begin) * sizeof *state->position;
    sleep_body *own = &sim->touch->sleep->bodies[body];
    memset(state->velocity + begin, 0, size);
    memcpy(state->position_before + begin, state->position + begin, size);
    sim->stepper->restart(sim, body);
    own->is_asleep = true;
    own->island = root_of(sim->touch->sleep, body);
    own->cause = cause_of(sim, body);
    sim->state_number++;
}

/* a substep trembles more than the mean of a step */
static void keep_means(const pel_sim *sim)
{
    const uint8_t *fell_asleep = sim->touch->sleep->fell_asleep;
    pel_contact_set *contacts = sim->contacts;
    int32_t body_count = sim->model->body_count;
    for (int32_t c = 0; c < contacts->list.count; c++) {
        pel_contact_key *key = &contacts->keys[c];
        int32_t a = contacts->group_of_point[key->points[0]], b = contacts->group_of_point[key->points[3]];
        if (!(a < body_count && fell_asleep[a]) && !(b < body_count && fell_asleep[b]))
            continue;
        key->load = key->earlier = key->mean_load;
        pel_vec3_copy(key->mean_drag, key->drag);
    }
    pel_solids_keep_means(sim, fell_asleep);
}

static void settle_islands(pel_sim *sim)
{
    pel_sleep *sleep = sim->touch->sleep;
    int32_t body_count = sim->model->body_count, new_count = 0;
    connect_islands(sim);
    memset(sleep->is_awake, 0, (size_t)body_count);
    for (int32_t b = 0; b < body_count; b++) {
        bool rests = sleep->bodies[b].is_asleep || (sleep->bodies[b].is_still && !is_held(sim, b) && !is_busy(sim, b));
        sleep->is_awake[root_of(sleep, b)] |= !rests;
    }
    for (int32_t b = 0; b < body_count; b++)
        new_count += sleep->can_move[b] && !sleep->bodies[b].is_asleep && !sleep->is_awake[root_of(sleep, b)];
    if (new_count == 0)
        return;
    find_loads(sim, pel_sim_time(sim));
    memset(sleep->fell_asleep, 0, (size_t)body_count);
    for (int32_t b = 0; b < body_count; b++)
        if (sleep->can_move[b] && !sleep->is_awake[root_of(sleep, b)]) {
            sleep->bodies[b].island = root_of(sleep, b);
            sleep->fell_asleep[b] = !sleep->bodies[b].is_asleep;
            if (sleep->fell_asleep[b])
                fall_asleep(sim, b);
        }
    keep_means(sim);
    memset(sim->force, 0, (size_t)sim->model->vertex_count * sizeof *sim->force);
}

/* corrections after the solver may have moved it */
static void wake_moved(pel_sim *sim)
{
    const pel_state *state = sim->state;
    for (int32_t b = 0; b < sim->model->body_count; b++) {
        int32_t begin = sim->model->bodies[b].slice_begin * PEL_WIDTH, end = pel_body_place_end(sim->model, b);
        if (sim->touch->sleep->bodies[b].is_asleep && memcmp(state->position + begin, state->position_before + begin,
                                                             (size_t)(end - begin) * sizeof *state->position) != 0)
            wake(sim->touch->sleep, b, sim->model->body_count);
    }
}

static double share_asleep(const pel_sim *sim)
{
    int64_t asleep = 0, all = 0;
    for (int32_t b = 0; b < sim->model->body_count; b++) {
        int64_t count = pel_body_place_end(sim->model, b) - sim->model->bodies[b].slice_begin * PEL_WIDTH;
        all += sim->touch->sleep->can_move[b] ? count : 0;
        asleep += sim->touch->sleep->bodies[b].is_asleep ? count : 0;
    }
    return all > 0 ? (double)asleep / (double)all : 0;
}

void pel_sleep_end_step(pel_sim *sim)
{
    pel_sleep *sleep = sim->touch->sleep;
    if (sleep == NULL)
        return;
    if (sim->contacts->asleep_count > 0)
        wake_moved(sim);
    if (pel_parts_are_last(sim)) {
        sim->contacts->statistics.sleeping += share_asleep(sim);
        for (int32_t b = 0; b < sim->model->body_count; b++)
            if (sleep->can_move[b] && !sleep->bodies[b].is_asleep)
                follow(sim, b);
        bool any_still = false;
        for (int32_t b = 0; b < sim->model->body_count; b++)
            any_still |= sleep->bodies[b].is_still && !sleep->bodies[b].is_asleep;
        if (any_still && sim->contacts->tangles.count == 0)
            settle_islands(sim);
    }
    tell(sim);
}

/* ---- snapshots ---- */

void pel_sleep_transfer(pel_cursor *at, const pel_sim *sim, int32_t unused)
{
    (void)unused;
    const pel_sleep *sleep = sim->touch->sleep;
    if (sleep == NULL)
        return;
    pel_transfer(at, sleep->bodies, (size_t)sim->model->body_count * sizeof *sleep->bodies);
    pel_transfer(at, sleep->mean, (size_t)sim->model->vertex_count * sizeof *sleep->mean);
    pel_transfer(at, sleep->sum, (size_t)sim->model->vertex_count * sizeof *sleep->sum);
}

bool pel_sleep_restore(pel_sim *sim)
{
    pel_sleep *sleep = sim->touch->sleep;
    bool is_whole = true;
    for (int32_t b = 0; sleep != NULL && b < sim->model->body_count; b++) {
        const sleep_body *own = &sleep->bodies[b];
        is_whole &= own->is_asleep <= 1 && own->is_still <= 1 && own->count >= 0 && own->island >= 0 &&
                    own->island < sim->model->body_count && (!own->is_asleep || sleep->can_move[b]);
    }
    if (!is_whole)
        memset(sleep->bodies, 0, (size_t)sim->model->body_count * sizeof *sleep->bodies);
    if (sleep != NULL)
        write_sleep(sim);
    return is_whole;
}
