/* Refinement of a body: verdicts of the criteria (criterion.c) become requests, requests become marks of the
   front.

   A vertex above a threshold becomes hot and requests the rings around it, on every level finer than its own; a hot
   vertex of the finest level requests its two adjacent triangles. A vertex below all lower thresholds for the dwell
   time becomes cold and cancels its requests. A triangle is marked while a request includes it.

   Each step tests a part of the vertices, all of them in `interval` steps (a round). Requests are executed from the end
   of the list, so that the strongest of a round come first, in portions: an event changes a limited number of
   triangles, and the rest waits for the next step. This bounds the time of a step for any tool.

   With a budget a candidate that would make too many triangles replaces hot vertices that are less than half as strong,
   the weakest first; if that does not make enough room they stay, and the candidate is skipped until the next round.
   The factor keeps two equal places from replacing each other repeatedly. */
#include "adapt/refine.h"

#include "adapt/criterion.h"
#include "adapt/energy.h"
#include "base/assert.h"
#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "boundary/loads.h"
#include "math/vec3.h"
#include "observe/ledger.h"
#include "pellicle/sim_surface.h"
#include "stage/shells.h"
#include "stage/stepper.h"
#include "stage/surface_view.h"
#include "tool/refine.h"

/* triangles that one event changes, roughly: at least, and the surface over this share */
enum { PORTION_LEAST = 24, PORTION_SHARE = 1024 };
/* candidates of one event that find no place in the budget, and vertices that one candidate displaces */
enum { FAILURE_LIMIT = 4, DISPLACED_LIMIT = 64 };
/* portions before one load step */
enum { SETTLING_PORTIONS = 640 };
/* how much stronger a candidate has to be than those it displaces */
#define DISPLACING_RATIO 2.0

/* ---- creation ---- */

static pel_status create_body(const pel_sim *sim, int32_t body, pel_error *error)
{
    const pel_front *front = sim->model->bodies[body].front;
    if (front == NULL)
        return PEL_OK;
    pel_refine_body *refine = &sim->refine[body];
    const pel_refined_body *own = &sim->active->bodies[body];
    const pel_topology *finest = front->forest->levels[front->forest->depth];
    size_t fine = (size_t)finest->vertex_count, coarse = (size_t)front->forest->levels[0]->vertex_count;
    int32_t **lists[] = {&refine->visited, &refine->queue, &refine->candidates,
                         &refine->leaving, &refine->hot,   &refine->hot_place};
    bool room = true;
    for (size_t i = 0; i < sizeof lists / sizeof *lists; i++)
        room &= (*lists[i] = pel_allocate(fine, sizeof **lists[i])) != NULL;
    refine->mark_counts = pel_allocate((size_t)front->red_limit, sizeof *refine->mark_counts);
    refine->requests = pel_allocate(fine, sizeof *refine->requests);
    refine->warm_step = pel_allocate(fine, sizeof *refine->warm_step);
    refine->strengths = pel_allocate(fine, sizeof *refine->strengths);
    refine->asked_level = pel_allocate(coarse, sizeof *refine->asked_level);
    if (sim->model->bodies[body].detail->def.curvature_above > 0) {
        refine->curvature_count = own->fine_limit - sim->model->bodies[body].slice_begin * PEL_WIDTH;
        refine->rest_curvatures = pel_allocate((size_t)refine->curvature_count, sizeof *refine->rest_curvatures);
        room &= refine->rest_curvatures != NULL;
    }
    if (!room || refine->mark_counts == NULL || refine->requests == NULL || refine->warm_step == NULL ||
        refine->strengths == NULL || refine->asked_level == NULL)
        return pel_fail_memory(error);
    pel_refine_criterion_forget(sim, body);
    return PEL_OK;
}

pel_status pel_refine_create(pel_sim *sim, pel_error *error)
{
    if (sim->active == NULL)
        return PEL_OK;
    sim->refine = pel_allocate((size_t)sim->model->body_count, sizeof *sim->refine);
    if (sim->refine == NULL)
        return pel_fail_memory(error);
    pel_status status = PEL_OK;
    for (int32_t b = 0; status == PEL_OK && b < sim->model->body_count; b++)
        status = create_body(sim, b, error);
    return status;
}

void pel_refine_destroy(pel_sim *sim)
{
    for (int32_t b = 0; sim->refine != NULL && b < sim->model->body_count; b++) {
        pel_refine_body *refine = &sim->refine[b];
        PEL_FREE_ALL(refine->mark_counts, refine->requests, refine->warm_step, refine->strengths, refine->asked_level,
                     refine->visited, refine->queue, refine->candidates, refine->leaving, refine->hot,
                     refine->hot_place, refine->rest_curvatures);
    }
    pel_free(sim->refine);
}

/* ---- requests ---- */

static void ask(pel_refine_body *refine, pel_front *front, int32_t node, bool asked)
{
    PEL_ASSERT_INDEX(node, front->node_count);
    int32_t count = refine->mark_counts[node] += asked ? 1 : -1;
    if (count == (asked ? 1 : 0))
        pel_front_mark(front, node, asked);
}

/* asks for the triangles around a vertex of a level; fills the queue with the vertices around when it is to grow */
static int32_t ask_around(pel_refine_body *refine, pel_front *front, int32_t level, int32_t v, bool asked,
                          int32_t queue_count, bool grow)
{
    PEL_ASSERT_INDEX(level, front->forest->depth + 1);
    const pel_topology *topology = front->forest->levels[level];
    int32_t first = topology->corner_of_vertex[v], h = first;
    while (h >= 0) {
        ask(refine, front, front->node_begin[level] + h / 3, asked);
        int32_t around[2] = {pel_half_edge_target(topology, h),
                             pel_half_edge_origin(topology, pel_half_edge_previous(h))};
        for (int i = 0; grow && i < 2; i++)
            if (refine->visited[around[i]] != refine->walk) {
                refine->visited[around[i]] = refine->walk;
                refine->queue[queue_count++] = around[i];
            }
        h = pel_half_edge_turn(topology, h);
        if (h == first)
            break;
    }
    return queue_count;
}

/* asks for, or takes back, the rings around a vertex on one level */
static void ask_rings(pel_refine_body *refine, pel_front *front, int32_t level, int32_t v, int32_t rings, bool asked)
{
    PEL_ASSERT_INDEX(level, front->forest->depth + 1);
    int32_t begin = 0, end = 1, count = 1;
    refine->walk++;
    refine->queue[0] = v;
    refine->visited[v] = refine->walk;
    for (int32_t ring = 1; ring <= rings; ring++) {
        for (int32_t i = begin; i < end; i++)
            count = ask_around(refine, front, level, refine->queue[i], asked, count, ring < rings);
        begin = end;
        end = count;
    }
}

static void ask_for_hot(pel_refine_body *refine, pel_front *front, int32_t v, int32_t rings, bool asked)
{
    const pel_lod_forest *forest = front->forest;
    int32_t own = pel_lod_forest_vertex_level(forest, v);
    for (int32_t level = own; level < forest->depth; level++)
        ask_rings(refine, front, level, v, rings, asked);
    if (own < forest->depth)
        return;
    const pel_topology *coarse = forest->levels[own - 1];
    int32_t h = coarse->half_edge_of_edge[v - coarse->vertex_count];
    ask(refine, front, front->node_begin[own - 1] + h / 3, asked);
    if (coarse->twin[h] >= 0)
        ask(refine, front, front->node_begin[own - 1] + coarse->twin[h] / 3, asked);
}

static void commit(pel_sim *sim, int32_t body)
{
    pel_refined_model *active = sim->active;
    pel_refined_body *own = &active->bodies[body];
    pel_refine_body *refine = &sim->refine[body];
    const double energy_before = sim->stepper->is_static ? pel_ledger_energy(sim) : 0;
    sim->present.has_force = false;
    double shells_before = pel_refine_energy_before(sim, body);
    pel_refined_commit(active, body, sim->state);
    if (own->front->change_count == 0)
        return;
    sim->rows[body].revision++;
    int32_t first = sim->model->bodies[body].slice_begin * PEL_WIDTH;
    for (int32_t d = 0; refine->rest_curvatures != NULL && d < active->dirty_count; d++)
        refine->rest_curvatures[own->model_index[active->dirty[d]] - first] = (double)NAN;
    pel_loads_update(sim, body);
    pel_tools_update(sim, body);
    pel_tool_search_update(sim->tools->search, body);
    pel_shells_follow(sim, body);
    pel_refine_keep_energy(sim, body, shells_before);
    /* a rest on another mesh has another energy, which nothing took or gave; of motion a change is an error */
    if (sim->stepper->is_static)
        pel_ledger_book_remesh(sim, energy_before);
    sim->present.has_force = false;
}

void pel_refine_everywhere(pel_sim *sim, int32_t body, bool everywhere)
{
    PEL_ASSERT_INDEX(body, sim->model->body_count);
    const pel_refined_body *own = &sim->active->bodies[body];
    if (own->front == NULL)
        return;
    int32_t finest = own->front->forest->levels[own->front->forest->depth]->triangle_count;
    if (everywhere && finest > own->triangle_limit)
        return;
    for (int32_t node = 0; node < own->front->red_limit; node++)
        ask(&sim->refine[body], own->front, node, everywhere);
    pel_front_close(own->front);
    commit(sim, body);
}

/* ---- hot and cold ---- */

static void heat_up(pel_sim *sim, int32_t body, int32_t v)
{
    pel_refine_body *refine = &sim->refine[body];
    ask_for_hot(refine, sim->active->bodies[body].front, v, sim->model->bodies[body].detail->def.rings, true);
    refine->requests[v] = PEL_REQUEST_MADE;
    refine->warm_step[v] = sim->state->step;
    refine->hot_place[v] = refine->hot_count;
    refine->hot[refine->hot_count++] = v;
}

static void cool_down(pel_sim *sim, int32_t body, int32_t v)
{
    pel_refine_body *refine = &sim->refine[body];
    ask_for_hot(refine, sim->active->bodies[body].front, v, sim->model->bodies[body].detail->def.rings, false);
    refine->requests[v] = PEL_REQUEST_NONE;
    int32_t last = refine->hot[--refine->hot_count];
    refine->hot[refine->hot_place[v]] = last;
    refine->hot_place[last] = refine->hot_place[v];
}

static bool has_cooled(const pel_sim *sim, int32_t body, int32_t v)
{
    int64_t since = sim->state->step - sim->refine[body].warm_step[v];
    return since > 0 && since >= sim->model->bodies[body].detail->def.dwell;
}

static void look_at(pel_sim *sim, int32_t body, int32_t v, const pel_verdict *verdict)
{
    pel_refine_body *refine = &sim->refine[body];
    uint8_t *requests = &refine->requests[v];
    refine->strengths[v] = verdict->strength;
    if (*requests == PEL_REQUEST_NONE && verdict->strength > 1) {
        *requests = PEL_REQUEST_WAITING;
        refine->candidates[refine->candidate_count++] = v;
        return;
    }
    if (*requests != PEL_REQUEST_MADE && *requests != PEL_REQUEST_ENDING)
        return;
    if (verdict->warm) {
        refine->warm_step[v] = sim->state->step;
    } else if (*requests == PEL_REQUEST_MADE && has_cooled(sim, body, v)) {
        *requests = PEL_REQUEST_ENDING;
        refine->leaving[refine->leaving_count++] = v;
    }
}

/* ---- candidates ---- */

static bool is_stronger(const pel_refine_body *refine, int32_t a, int32_t b)
{
    double p = refine->strengths[a], q = refine->strengths[b];
    return p > q || (p == q && a < b);
}

/* takes a waiting candidate off the list: the strongest where that matters */
static int32_t take_candidate(pel_refine_body *refine, bool strongest)
{
    int32_t *list = refine->candidates, at = refine->waiting_count - 1;
    for (int32_t i = at - 1; strongest && i >= 0; i--)
        at = is_stronger(refine, list[i], list[at]) ? i : at;
    int32_t v = list[at];
    /* waiting ones first, followed by those found in this round */
    list[at] = list[--refine->waiting_count];
    list[refine->waiting_count] = list[--refine->candidate_count];
    refine->requests[v] = PEL_REQUEST_NONE;
    return v;
}

/* the weakest hot vertex that is not leaving anyway, -1 when none is below the strength */
static int32_t weakest_hot(const pel_refine_body *refine, double below)
{
    int32_t weakest = -1;
    for (int32_t i = 0; i < refine->hot_count; i++) {
        int32_t v = refine->hot[i];
        if (refine->requests[v] == PEL_REQUEST_MADE && refine->strengths[v] < below &&
            (weakest < 0 || is_stronger(refine, weakest, v)))
            weakest = v;
    }
    return weakest;
}

/* vertices that a candidate replaced */
typedef struct displacement {
    int32_t vertices[DISPLACED_LIMIT];
    int64_t warm_steps[DISPLACED_LIMIT];
    int count;
} displacement;

/* cools up to `most` vertices that are weaker than the strength; false if there are none */
static bool displace(pel_sim *sim, int32_t body, double below, int most, displacement *gone)
{
    pel_refine_body *refine = &sim->refine[body];
    int before = gone->count;
    while (gone->count < DISPLACED_LIMIT && gone->count - before < most) {
        int32_t v = weakest_hot(refine, below);
        if (v < 0)
            break;
        gone->warm_steps[gone->count] = refine->warm_step[v];
        gone->vertices[gone->count++] = v;
        cool_down(sim, body, v);
    }
    return gone->count > before;
}

/* makes a candidate hot if the budget allows it, if need be in the place of much weaker ones: one, then two more, then
   four, as closing the front costs more than finding the weakest */
static bool heat_within_budget(pel_sim *sim, int32_t body, int32_t v)
{
    const pel_refined_body *own = &sim->active->bodies[body];
    pel_refine_body *refine = &sim->refine[body];
    displacement gone = {.count = 0};
    heat_up(sim, body, v);
    for (int most = 1; pel_front_close(own->front) > own->triangle_limit; most *= 2) {
        if (displace(sim, body, refine->strengths[v] / DISPLACING_RATIO, most, &gone))
            continue;
        cool_down(sim, body, v);
        for (int i = 0; i < gone.count; i++) {
            heat_up(sim, body, gone.vertices[i]);
            refine->warm_step[gone.vertices[i]] = gone.warm_steps[i];
        }
        pel_front_close(own->front);
        return false;
    }
    return true;
}

/* triangles to be refined or joined that have piled up since the last event, roughly */
static int32_t work_of(const pel_front *front)
{
    return front->pending_count + front->touched_count;
}

/* with contact, an event that would make the surface cut itself was taken back: hot vertices stay for as long as they
   would anyway, candidates may come again */
static void put_off(pel_sim *sim, int32_t body)
{
    pel_refine_body *refine = &sim->refine[body];
    while (refine->leaving_count > 0) {
        int32_t v = refine->leaving[--refine->leaving_count];
        refine->requests[v] = PEL_REQUEST_MADE;
        refine->warm_step[v] = sim->state->step;
    }
    while (refine->waiting_count > 0)
        take_candidate(refine, false);
}

/* apply one event's portion of the requests of the last rounds */
static void do_portion(pel_sim *sim, int32_t body)
{
    const pel_refined_body *own = &sim->active->bodies[body];
    pel_refine_body *refine = &sim->refine[body];
    if (refine->leaving_count + refine->waiting_count == 0)
        return;
    if (sim->guards != NULL)
        sim->guards->before(sim);
    bool limited = own->triangle_limit < INT32_MAX;
    int32_t portion = PORTION_LEAST + own->front->triangle_count / PORTION_SHARE;
    while (refine->leaving_count > 0 && work_of(own->front) < portion) {
        int32_t v = refine->leaving[--refine->leaving_count];
        if (has_cooled(sim, body, v))
            cool_down(sim, body, v);
        else
            refine->requests[v] = PEL_REQUEST_MADE;
    }
    if (limited)
        pel_front_close(own->front);
    for (int failures = 0; failures < FAILURE_LIMIT && refine->waiting_count > 0 && work_of(own->front) < portion;) {
        int32_t v = take_candidate(refine, limited);
        if (refine->strengths[v] <= 1 || !pel_front_has_vertex(own->front, v))
            continue;
        if (!limited)
            heat_up(sim, body, v);
        else if (!heat_within_budget(sim, body, v))
            failures++;
    }
    pel_front_close(own->front);
    commit(sim, body);
    if (sim->guards != NULL && own->front->change_count > 0 && !sim->guards->accept(sim, body))
        put_off(sim, body);
}

static void step_body(pel_sim *sim, int32_t body)
{
    const pel_body *b = &sim->model->bodies[body];
    pel_refine_body *refine = &sim->refine[body];
    if (b->detail == NULL || !pel_refine_criterion_is_used(&b->detail->def))
        return;
    pel_refine_criterion_begin(sim, body);
    /* every interval-th slice: vertices near a tool are in nearby slices */
    for (int32_t slice = b->slice_begin + refine->part; slice < b->slice_end; slice += b->detail->def.interval) {
        pel_verdict verdicts[PEL_WIDTH];
        pel_body_force numbers = pel_slice_force_of(sim->model, sim->state, slice);
        pel_refine_criterion_slice(sim, body, slice, &numbers, verdicts);
        for (int32_t lane = 0; lane < PEL_WIDTH; lane++)
            if (sim->model->mesh_vertex[slice * PEL_WIDTH + lane] >= 0)
                look_at(sim, body, sim->model->mesh_vertex[slice * PEL_WIDTH + lane], &verdicts[lane]);
    }
    if (++refine->part >= b->detail->def.interval) {
        refine->part = 0;
        refine->waiting_count = refine->candidate_count;
    }
    do_portion(sim, body);
}

/* Repeat events until the surface near the tools has its level: load steps are few and large, so one portion per step
   would lag behind. Other criteria depend on the equilibrium and change once per step. */
static void settle_body(pel_sim *sim, int32_t body)
{
    const pel_refine_def *def = &sim->model->bodies[body].detail->def;
    int64_t revision = -1;
    for (int32_t done = 0; done < SETTLING_PORTIONS && sim->rows[body].revision != revision; done += def->interval) {
        revision = sim->rows[body].revision;
        for (int32_t i = 0; i < def->interval; i++)
            step_body(sim, body);
    }
}

void pel_refine_step(pel_sim *sim)
{
    for (int32_t b = 0; b < sim->model->body_count; b++) {
        const pel_body_levels *detail = sim->model->bodies[b].detail;
        if (sim->stepper->seeks_rest && detail != NULL && detail->def.near_tools > 0)
            settle_body(sim, b);
        else
            step_body(sim, b);
    }
}

/* ---- the start ---- */

/* asks for all triangles at the region's vertices, and their parts down to its level */
static void ask_for_region(pel_sim *sim, int32_t body)
{
    const pel_refine_def *def = &sim->model->bodies[body].detail->def;
    pel_refine_body *refine = &sim->refine[body];
    pel_front *front = sim->active->bodies[body].front;
    const pel_topology *base = front->forest->levels[0];
    int32_t levels = def->region_levels > 0 ? def->region_levels : def->levels;
    refine->walk++;
    for (int32_t i = 0; i < def->region_count; i++)
        refine->visited[def->region[i]] = refine->walk;
    for (int32_t t = 0; t < base->triangle_count; t++) {
        const int32_t *v = base->triangles[t];
        if (refine->visited[v[0]] != refine->walk && refine->visited[v[1]] != refine->walk &&
            refine->visited[v[2]] != refine->walk)
            continue;
        for (int32_t level = 0; level < levels; level++)
            for (int32_t i = 0; i < 1 << (2 * level); i++)
                ask(refine, front, front->node_begin[level] + (t << (2 * level)) + i, true);
    }
}

static pel_status start_region(pel_sim *sim, int32_t body, pel_error *error)
{
    const pel_refined_body *own = &sim->active->bodies[body];
    ask_for_region(sim, body);
    int32_t count = pel_front_close(own->front);
    if (count > own->triangle_limit) {
        pel_fail(error, PEL_BAD_ARGUMENT, "refine: the region needs %d triangles, the budget is %d", (int)count,
                 (int)own->triangle_limit);
        pel_fail_element(error, "body", body);
        pel_fail_remedy(error, "give a budget of at least %d, a smaller region or fewer levels for it", (int)count);
        return PEL_BAD_ARGUMENT;
    }
    commit(sim, body);
    return PEL_OK;
}

pel_status pel_refine_start(pel_sim *sim, pel_error *error)
{
    pel_status status = PEL_OK;
    for (int32_t b = 0; status == PEL_OK && b < sim->model->body_count; b++) {
        const pel_body_levels *detail = sim->model->bodies[b].detail;
        if (detail != NULL && detail->def.everywhere)
            pel_refine_everywhere(sim, b, true);
        else if (detail != NULL && detail->def.region_count > 0)
            status = start_region(sim, b, error);
    }
    return status;
}

/* ---- by hand ---- */

static void ask_to_level(pel_sim *sim, int32_t body, int32_t vertex, int32_t level, bool asked)
{
    for (int32_t l = 0; l < level; l++)
        ask_rings(&sim->refine[body], sim->active->bodies[body].front, l, vertex,
                  sim->model->bodies[body].detail->def.rings, asked);
}

pel_status pel_sim_refine(pel_sim *sim, int32_t body, int32_t vertex, int32_t level, pel_error *error)
{
    PEL_REFUSE_NULL(sim, error);
    if (body < 0 || body >= sim->model->body_count || sim->model->bodies[body].detail == NULL)
        return pel_fail(error, PEL_BAD_ARGUMENT, "body %d does not exist or does not refine", (int)body);
    const pel_body *b = &sim->model->bodies[body];
    if (vertex < 0 || vertex >= b->mesh->vertex_count || level < 0 || level > b->detail->def.levels)
        return pel_fail(error, PEL_BAD_ARGUMENT, "vertex %d or level %d does not exist in body '%s'", (int)vertex,
                        (int)level, b->name);
    const pel_refined_body *own = &sim->active->bodies[body];
    pel_status status = sim->guards != NULL ? sim->guards->prepare(sim, error) : PEL_OK;
    if (status != PEL_OK)
        return status;
    if (sim->guards != NULL)
        sim->guards->before(sim);
    int32_t before = sim->refine[body].asked_level[vertex];
    ask_to_level(sim, body, vertex, before, false);
    ask_to_level(sim, body, vertex, level, true);
    int32_t count = pel_front_close(own->front);
    if (count > own->triangle_limit) {
        ask_to_level(sim, body, vertex, level, false);
        ask_to_level(sim, body, vertex, before, true);
        pel_front_close(own->front);
        return pel_refuse(error, PEL_BAD_ARGUMENT, "ask for a coarser level, or raise the budget",
                          "refinement of body '%s' would have %d triangles, the budget is %d", b->name, (int)count,
                          (int)own->triangle_limit);
    }
    sim->refine[body].asked_level[vertex] = (uint8_t)level;
    commit(sim, body);
    if (sim->guards == NULL || own->front->change_count == 0 || sim->guards->accept(sim, body))
        return PEL_OK;
    pel_fail(error, PEL_BAD_ARGUMENT, "body '%s' would intersect itself or another surface on that level", b->name);
    pel_fail_remedy(error, "try again when there is more space around vertex %d", (int)vertex);
    return PEL_BAD_ARGUMENT;
}
