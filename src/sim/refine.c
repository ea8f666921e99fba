/* Where a body refines: paper A's criterion (section 3.2).

   The measure of a vertex is its elastic force, springs and volumetric spring, over its share of the area [N/m2]. At
   rest it balances what acts on the vertex from outside, tools and loads, per area; it is nothing where nothing acts,
   and it does not change with the level, so that refinement does not take away its own reason. A vertex above the
   threshold becomes hot and asks for the rings around it, on every level finer than its own; a hot vertex of the finest
   level asks for the two triangles between which it lies. One that stays below the lower threshold for the dwell time
   becomes cold and takes its requests back. A triangle is marked while anybody asks for it.

   Vertices are looked at a part each step, all of them in `interval` steps (a round), so that no step is much longer
   than another; at the end of a round the front changes once. With a budget the candidates are tried one by one, the
   strongest first, and one that would make too many triangles is passed over. */
#include "base/memory.h"
#include "base/status.h"
#include "math/vec3.h"
#include "sim/sim.h"

#include <string.h>

/* ---- creation ---- */

static pel_status create_body(const pel_sim *sim, int32_t body, pel_error *error)
{
    const pel_front *front = sim->model->bodies[body].front;
    if (front == NULL)
        return PEL_OK;
    pel_refine_body *refine = &sim->refine[body];
    const pel_topology *finest = front->forest->levels[front->forest->depth];
    size_t fine = (size_t)finest->vertex_count, coarse = (size_t)front->forest->levels[0]->vertex_count;
    refine->mark_counts = pel_allocate((size_t)front->red_limit, sizeof *refine->mark_counts);
    refine->is_hot = pel_allocate(fine, sizeof *refine->is_hot);
    refine->warm_step = pel_allocate(fine, sizeof *refine->warm_step);
    refine->asked_level = pel_allocate(coarse, sizeof *refine->asked_level);
    refine->visited = pel_allocate(fine, sizeof *refine->visited);
    refine->queue = pel_allocate(fine, sizeof *refine->queue);
    refine->candidates = pel_allocate(fine, sizeof *refine->candidates);
    refine->strengths = pel_allocate(fine, sizeof *refine->strengths);
    refine->cooled = pel_allocate(fine, sizeof *refine->cooled);
    refine->row_vertices = pel_allocate(fine, sizeof *refine->row_vertices);
    refine->row_of_vertex = pel_allocate(fine, sizeof *refine->row_of_vertex);
    refine->surface = pel_allocate((size_t)finest->triangle_count, sizeof *refine->surface);
    refine->row_revision = -1;
    if (refine->mark_counts == NULL || refine->is_hot == NULL || refine->warm_step == NULL ||
        refine->asked_level == NULL || refine->visited == NULL || refine->queue == NULL || refine->candidates == NULL ||
        refine->strengths == NULL || refine->cooled == NULL || refine->row_vertices == NULL ||
        refine->row_of_vertex == NULL || refine->surface == NULL)
        return pel_fail_memory(error);
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
        void *arrays[] = {refine->mark_counts, refine->is_hot,       refine->warm_step,     refine->asked_level,
                          refine->visited,     refine->queue,        refine->candidates,    refine->strengths,
                          refine->cooled,      refine->row_vertices, refine->row_of_vertex, refine->surface};
        for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++)
            pel_free(arrays[i]);
    }
    pel_free(sim->refine);
}

/* ---- requests ---- */

static void ask(pel_refine_body *refine, pel_front *front, int32_t node, bool asked)
{
    int32_t count = refine->mark_counts[node] += asked ? 1 : -1;
    if (count == (asked ? 1 : 0))
        pel_front_mark(front, node, asked);
}

/* asks for the triangles around a vertex of a level; fills the queue with the vertices around when it is to grow */
static int32_t ask_around(pel_refine_body *refine, pel_front *front, int32_t level, int32_t v, bool asked,
                          int32_t queue_count, bool grow)
{
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
    sim->force_is_present = false;
    pel_active_commit(sim->active, body, sim->state);
    if (sim->active->bodies[body].front->change_count == 0)
        return;
    sim->refine[body].revision++;
    pel_loads_update(sim, body);
    pel_tools_update(sim, body);
}

void pel_refine_everywhere(pel_sim *sim, int32_t body, bool everywhere)
{
    const pel_active_body *own = &sim->active->bodies[body];
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

/* ---- the criterion ---- */

static void look_at(pel_sim *sim, int32_t body, int32_t place, double strength)
{
    const pel_refine_def *def = &sim->model->bodies[body].detail->def;
    pel_refine_body *refine = &sim->refine[body];
    int32_t v = sim->model->mesh_vertex[place];
    if (refine->is_hot[v]) {
        if (strength >= def->below)
            refine->warm_step[v] = sim->state->step;
        else if (sim->state->step - refine->warm_step[v] >= def->dwell)
            refine->cooled[refine->cooled_count++] = v;
    } else if (strength > def->above) {
        refine->strengths[v] = strength;
        refine->candidates[refine->candidate_count++] = v;
    }
}

static void look_at_slice(pel_sim *sim, int32_t body, int32_t slice, const pel_body_force *numbers)
{
    const pel_model *model = sim->model;
    pel_slice own = pel_slice_load(sim->state->position, slice);
    pel_wide longest = pel_wide_splat(0);
    pel_wide3 force = pel_elastic_force(model, sim->state->position, slice, &own.position, numbers, &longest);
    pel_wide square = pel_wide3_dot(force, force);
    for (int32_t lane = 0; lane < PEL_WIDTH; lane++) {
        int32_t place = slice * PEL_WIDTH + lane;
        if (model->mesh_vertex[place] < 0 || model->inverse_mass[place] <= 0)
            continue;
        look_at(sim, body, place, 3 * sqrt((double)square[lane]) / sim->active->areas[place]);
    }
}

static bool is_stronger(const pel_refine_body *refine, int32_t a, int32_t b)
{
    double p = refine->strengths[a], q = refine->strengths[b];
    return p > q || (p == q && a < b);
}

static void sink(pel_refine_body *refine, int32_t root, int32_t count)
{
    int32_t *heap = refine->candidates, v = heap[root];
    for (int32_t child = 2 * root + 1; child < count; child = 2 * root + 1) {
        if (child + 1 < count && is_stronger(refine, heap[child + 1], heap[child]))
            child++;
        if (!is_stronger(refine, heap[child], v))
            break;
        heap[root] = heap[child];
        root = child;
    }
    heap[root] = v;
}

/* takes the strongest candidate off the heap */
static int32_t pop_candidate(pel_refine_body *refine)
{
    int32_t v = refine->candidates[0];
    refine->candidates[0] = refine->candidates[--refine->candidate_count];
    if (refine->candidate_count > 0)
        sink(refine, 0, refine->candidate_count);
    return v;
}

/* candidates become hot, the strongest first, as far as the budget goes */
static void heat(pel_sim *sim, int32_t body)
{
    const pel_active_body *own = &sim->active->bodies[body];
    pel_refine_body *refine = &sim->refine[body];
    int32_t rings = sim->model->bodies[body].detail->def.rings;
    bool limited = own->triangle_limit < INT32_MAX;
    for (int32_t root = refine->candidate_count / 2 - 1; root >= 0; root--)
        sink(refine, root, refine->candidate_count);
    while (refine->candidate_count > 0) {
        int32_t v = pop_candidate(refine);
        ask_for_hot(refine, own->front, v, rings, true);
        if (limited && pel_front_close(own->front) > own->triangle_limit) {
            ask_for_hot(refine, own->front, v, rings, false);
            pel_front_close(own->front);
            continue;
        }
        refine->is_hot[v] = 1;
        refine->warm_step[v] = sim->state->step;
    }
}

static void end_round(pel_sim *sim, int32_t body)
{
    const pel_active_body *own = &sim->active->bodies[body];
    pel_refine_body *refine = &sim->refine[body];
    if (refine->candidate_count + refine->cooled_count == 0)
        return;
    int32_t rings = sim->model->bodies[body].detail->def.rings;
    for (int32_t i = 0; i < refine->cooled_count; i++) {
        refine->is_hot[refine->cooled[i]] = 0;
        ask_for_hot(refine, own->front, refine->cooled[i], rings, false);
    }
    refine->cooled_count = 0;
    if (own->triangle_limit < INT32_MAX)
        pel_front_close(own->front);
    heat(sim, body);
    pel_front_close(own->front);
    commit(sim, body);
}

static void step_body(pel_sim *sim, int32_t body)
{
    const pel_body *b = &sim->model->bodies[body];
    pel_refine_body *refine = &sim->refine[body];
    if (b->detail == NULL || b->detail->def.everywhere || b->detail->def.above <= 0)
        return;
    int32_t count = b->slice_end - b->slice_begin, interval = b->detail->def.interval;
    int32_t end = refine->next_slice + (count + interval - 1) / interval;
    pel_body_force numbers = pel_body_force_of(sim->model, sim->state, body);
    for (; refine->next_slice < end && refine->next_slice < count; refine->next_slice++)
        look_at_slice(sim, body, b->slice_begin + refine->next_slice, &numbers);
    if (refine->next_slice < count)
        return;
    refine->next_slice = 0;
    end_round(sim, body);
}

void pel_refine_step(pel_sim *sim)
{
    for (int32_t b = 0; b < sim->model->body_count; b++)
        step_body(sim, b);
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
    if (body < 0 || body >= sim->model->body_count || sim->model->bodies[body].detail == NULL)
        return pel_fail(error, PEL_BAD_ARGUMENT, "body %d does not exist or does not refine", (int)body);
    const pel_body *b = &sim->model->bodies[body];
    if (vertex < 0 || vertex >= b->mesh->vertex_count || level < 0 || level > b->detail->def.levels)
        return pel_fail(error, PEL_BAD_ARGUMENT, "vertex %d or level %d does not exist in body '%s'", (int)vertex,
                        (int)level, b->name);
    const pel_active_body *own = &sim->active->bodies[body];
    int32_t before = sim->refine[body].asked_level[vertex];
    ask_to_level(sim, body, vertex, before, false);
    ask_to_level(sim, body, vertex, level, true);
    int32_t count = pel_front_close(own->front);
    if (count > own->triangle_limit) {
        ask_to_level(sim, body, vertex, level, false);
        ask_to_level(sim, body, vertex, before, true);
        pel_front_close(own->front);
        pel_fail(error, PEL_BAD_ARGUMENT, "refinement of body '%s' would have %d triangles, the budget is %d", b->name,
                 (int)count, (int)own->triangle_limit);
        pel_fail_remedy(error, "ask for a coarser level, or raise the budget");
        return PEL_BAD_ARGUMENT;
    }
    sim->refine[body].asked_level[vertex] = (uint8_t)level;
    commit(sim, body);
    return PEL_OK;
}
