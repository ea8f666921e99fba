/* Steps in parts. Contacts are tested along straight ways from the start to the end of a step. If surfaces move
   far in a step, or around each other, the guard would step back feasible motion; an implicit step may have no
   solution near its start. Such a step is repeated in halves, each with its own search, substeps and guard, and divided
   again if necessary. Parts grow after a number of good ones. */
#include "sim/parts.h"

#include "attach/tie.h"
#include "base/memory.h"
#include "base/status.h"
#include "method/softness.h"
#include "sim/sim.h"
#include "sim/snapshot.h"
#include "tool/tool.h"
#include "touch/contact.h"

#include <math.h>
#include <string.h>

void pel_parts_create(pel_sim *sim)
{
    pel_parts *parts = &pel_house_of(sim)->parts;
    sim->part.step_size = PEL_PART_LIMIT;
    parts->now = (pel_parts_now){.size = PEL_PART_LIMIT, .patience = PEL_LEAST_PATIENCE};
    sim->part.substeps = sim->solver.substeps;
    /* restitution detects collisions by whole steps, and a budget of work applies to a whole step */
    bool is_bounded = sim->solver.budget > 0 || (!pel_sim_is_projected(sim) && sim->solver.iterations > 0);
    bool divides = pel_sim_is_projected(sim) ? sim->contacts != NULL : sim->stepper->divides;
    parts->divides = divides && sim->touch->collisions == NULL;
    sim->part.can_halve = parts->divides && !is_bounded;
}

void pel_parts_destroy(pel_sim *sim)
{
    pel_free(pel_house_of(sim)->parts.before);
}

/* The state before the step. Most runs never halve one, so that the first step that is halved finds the memory for it;
   pairs in contact, and forces of the caller that come or go, change its size. */
static pel_status save_before(pel_sim *sim, pel_error *error)
{
    pel_parts *parts = &pel_house_of(sim)->parts;
    parts->before_size = pel_sim_save_size(sim);
    if (!pel_reserve(&parts->before, &parts->before_room, parts->before_size, 1))
        return pel_fail_memory(error);
    pel_sim_save(sim, parts->before);
    return PEL_OK;
}

/* Substeps from which on, and s of a step from which on, a snapshot takes 3 % of it at most. */
enum { LONG_SUBSTEPS = 32 };
#define LONG_SECONDS 0.03
/* s for each vertex in a substep in a jam, for the first step, of which nothing is known yet */
#define VERTEX_SECONDS 3e-5

static bool is_long(const pel_sim *sim)
{
    const pel_parts *parts = &pel_house_of(sim)->parts;
    double substeps = sim->stepper->has_substeps ? sim->solver.substeps : 1;
    double expected = parts->seconds > 0 ? parts->seconds : VERTEX_SECONDS * sim->model->vertex_count * substeps;
    bool is_divided = parts->now.size < PEL_PART_LIMIT;
    return sim->stepper->minimises || substeps >= LONG_SUBSTEPS || is_divided || expected >= LONG_SECONDS;
}

/* Contact or many iterations make single steps long that are short as a rule: only a caller who says so pays for a
   snapshot of each. A step in parts has one in any case; one that is halved on its way goes back to the state of
   its start only if that was kept before anything looked for contacts. */
pel_status pel_parts_keep(pel_sim *sim, pel_error *error)
{
    pel_parts *parts = &pel_house_of(sim)->parts;
    parts->is_kept = false;
    pel_pool_watch(sim->pool, NULL, NULL);
    if (sim->def.wanted == NULL)
        return PEL_OK;
    parts->began = pel_seconds();
    if (!is_long(sim) && !sim->def.stops_short_steps)
        return PEL_OK;
    pel_status status = save_before(sim, error);
    parts->is_kept = status == PEL_OK;
    if (status == PEL_OK)
        pel_pool_watch(sim->pool, sim->def.wanted, sim->def.user);
    return status;
}

/* update quantities that depend on the length of a part */
static void set_size(pel_sim *sim, int32_t size)
{
    double before = sim->step.dt;
    sim->part.step_size = size;
    sim->step.dt = sim->solver.dt * size / PEL_PART_LIMIT;
    if (sim->stepper->set_time != NULL)
        sim->stepper->set_time(sim, before);
}

/* Grasps and ties end between parts. Where that is inside an implicit step, it has parts that end there, to a share of
   the step, and the part after it, which Euler takes, is short: else a body that is let go would fall half a step too
   early or too late. Where they begin, they stop what moves: the shorter the part, the larger that force, which they
   may not stand. */
enum { EVENT_PART = PEL_PART_LIMIT / 16 };

/* the end of the next part is at the time of what is to end, or soon after it if that is now */
static void take_event(const pel_sim *sim, double time, int32_t *next)
{
    const double share = time / sim->solver.dt - (double)sim->state->step;
    if (!(time > 0 && share < 1))
        return;
    const int32_t at = (int32_t)floor(share * PEL_PART_LIMIT / EVENT_PART + 0.5) * EVENT_PART;
    const int32_t end = at > sim->part.at ? at : sim->part.at + EVENT_PART;
    *next = end < *next ? end : *next;
}

/* the end of the next part at most */
static int32_t next_event(const pel_sim *sim)
{
    int32_t next = PEL_PART_LIMIT;
    if (!sim->part.can_halve || pel_sim_is_projected(sim))
        return next;
    for (int32_t t = 0; t < sim->tools->count; t++) {
        const pel_tool *tool = &sim->tools->items[t];
        if (tool->grasp && tool->phase == PEL_GRASP_HOLDING)
            take_event(sim, tool->grasp_until, &next);
    }
    for (int32_t i = 0; sim->ties != NULL && i < sim->ties->count; i++) {
        const pel_tie *tie = &sim->ties->items[i];
        if (tie->phase == PEL_TIE_HOLDING)
            take_event(sim, sim->ties->groups[tie->group].def.until, &next);
    }
    return next;
}

/* a size up to the one that the contacts have room for, that ends no later than the next grasp or tie */
static int32_t next_size(const pel_sim *sim)
{
    const int32_t event = next_event(sim);
    int32_t size = pel_house_of(sim)->parts.now.size;
    while (sim->part.at % size != 0 || sim->part.at + size > event)
        size /= 2;
    return size;
}

pel_status pel_parts_begin(pel_sim *sim, pel_error *error)
{
    pel_parts *parts = &pel_house_of(sim)->parts;
    sim->part.at = sim->part.systems = 0;
    sim->part.is_refused = false;
    sim->part.conflict_count = sim->part.repeat_count = 0;
    if (pel_sim_is_projected(sim))
        pel_substeps_follow(sim);
    sim->part.substeps = sim->solver.substeps;
    for (int32_t t = 0; t < sim->tools->count; t++) {
        sim->tools->items[t].hold_is_counted = sim->tools->items[t].was_held_back = sim->tools->items[t].was_stopped =
            false;
        memset(sim->tools->items[t].force_sum, 0, sizeof sim->tools->items[t].force_sum);
        memset(sim->tools->items[t].torque_sum, 0, sizeof sim->tools->items[t].torque_sum);
    }
    const int32_t size = next_size(sim);
    if (size == PEL_PART_LIMIT)
        return PEL_OK;
    pel_status status = parts->is_kept ? PEL_OK : save_before(sim, error);
    if (status == PEL_OK)
        set_size(sim, size);
    return status;
}

pel_status pel_parts_halve(pel_sim *sim, pel_error *error)
{
    pel_parts *parts = &pel_house_of(sim)->parts;
    sim->part.is_refused = false;
    bool is_first = sim->part.step_size == PEL_PART_LIMIT && !parts->is_kept;
    pel_status status = is_first ? save_before(sim, error) : PEL_OK;
    if (status != PEL_OK)
        return status;
    if (parts->now.calm == 0)
        parts->now.patience = parts->now.patience < PEL_MOST_PATIENCE ? 2 * parts->now.patience : PEL_MOST_PATIENCE;
    /* 0 = has just grown: what is halved several times at once was not grown too early */
    parts->now.calm = 1;
    parts->now.size = sim->part.step_size / 2;
    set_size(sim, parts->now.size);
    return PEL_OK;
}

/* readings of the step are means of its parts */
static void sum_readings(pel_sim *sim)
{
    double share = pel_part_share(sim);
    for (int32_t t = 0; t < sim->tools->count; t++) {
        pel_tool *tool = &sim->tools->items[t];
        pel_vec3_along(tool->force_sum, share, tool->force, tool->force_sum);
        pel_vec3_along(tool->torque_sum, share, tool->torque, tool->torque_sum);
        tool->was_held_back |= tool->is_held_back;
        tool->was_stopped |= tool->is_stopped;
    }
}

void pel_parts_accept(pel_sim *sim)
{
    pel_parts *parts = &pel_house_of(sim)->parts;
    pel_parts_now *now = &parts->now;
    if (sim->part.step_size < PEL_PART_LIMIT)
        sum_readings(sim);
    sim->part.at += sim->part.step_size;
    sim->part.conflict_count = sim->part.repeat_count = 0;
    if (now->size < PEL_PART_LIMIT)
        now->calm++;
    const bool grows = now->size < PEL_PART_LIMIT && (now->calm >= now->patience || pel_parts_are_spent(sim));
    if (grows && sim->part.at % (2 * now->size) == 0) {
        now->size *= 2;
        now->calm = 0;
        if (now->size == PEL_PART_LIMIT)
            now->patience = PEL_LEAST_PATIENCE;
    }
    const int32_t size = sim->part.at < PEL_PART_LIMIT ? next_size(sim) : sim->part.step_size;
    if (size != sim->part.step_size)
        set_size(sim, size);
}

void pel_parts_end(pel_sim *sim, pel_status status)
{
    pel_parts *parts = &pel_house_of(sim)->parts;
    bool is_whole = sim->part.step_size == PEL_PART_LIMIT;
    bool goes_back = status != PEL_OK && (!is_whole || (status == PEL_STOPPED && parts->is_kept));
    sim->part.at = 0;
    parts->is_kept = false;
    if (sim->def.wanted != NULL && status == PEL_OK)
        parts->seconds = pel_seconds() - parts->began;
    pel_pool_watch(sim->pool, NULL, NULL);
    if (!is_whole)
        set_size(sim, PEL_PART_LIMIT);
    if (goes_back)
        pel_snapshot_load(sim, parts->before, parts->before_size, NULL);
    if (is_whole)
        return;
    if (status == PEL_OK && sim->contacts != NULL)
        sim->contacts->statistics.steps_divided++;
    for (int32_t t = 0; t < sim->tools->count && status == PEL_OK; t++) {
        pel_tool *tool = &sim->tools->items[t];
        pel_vec3_copy(tool->force_sum, tool->force);
        pel_vec3_copy(tool->torque_sum, tool->torque);
        tool->is_held_back = tool->was_held_back;
        tool->is_stopped = tool->was_stopped;
    }
}

/* ---- snapshots ---- */

void pel_parts_transfer(pel_cursor *at, const pel_sim *sim, int32_t unused)
{
    (void)unused;
    pel_parts *parts = &pel_house_of(sim)->parts;
    if (parts->divides)
        pel_transfer(at, &parts->now, sizeof parts->now);
}

bool pel_parts_restore(pel_sim *sim)
{
    pel_parts_now *now = &pel_house_of(sim)->parts.now;
    bool is_size = now->size > 0 && now->size <= PEL_PART_LIMIT && (now->size & (now->size - 1)) == 0;
    if (is_size && now->calm >= 0 && now->patience >= PEL_LEAST_PATIENCE && now->patience <= PEL_MOST_PATIENCE) {
        now->size = sim->part.can_halve ? now->size : PEL_PART_LIMIT;
        return true;
    }
    *now = (pel_parts_now){.size = PEL_PART_LIMIT, .patience = PEL_LEAST_PATIENCE};
    return false;
}
