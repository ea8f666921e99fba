/* Forces of contacts. Every push of a contact passes here, whatever the method, so that each vertex, body, tool and pin
   knows what acted on it: a contact with the force f on the weighted sum of its points acts on each point by its weight
   times f (the transpose of the sum), so that forces inside a body and between two of them add up to zero, and against
   a tool to what the tool feels. */
#include "base/memory.h"
#include "base/status.h"
#include "sim/tool.h"

#include <string.h>

/* slices of a flag each: which of them a force was written to */
static size_t flag_count(const pel_sim *sim)
{
    return (size_t)sim->model->vertex_count / PEL_WIDTH;
}

static size_t pair_count(const pel_sim *sim)
{
    return (size_t)sim->model->body_count * (size_t)sim->contact_forces.group_count;
}

pel_status pel_contact_forces_create(pel_sim *sim, pel_error *error)
{
    pel_contact_forces *forces = &sim->contact_forces;
    size_t count = (size_t)sim->model->vertex_count;
    forces->group_count = sim->model->body_count + sim->tool_count;
    forces->vertex = pel_allocate_aligned(count, sizeof *forces->vertex);
    forces->vertex_next = pel_allocate_aligned(count, sizeof *forces->vertex_next);
    forces->is_touched = pel_allocate(flag_count(sim), 1);
    forces->is_touched_next = pel_allocate(flag_count(sim), 1);
    forces->pair = pel_allocate(pair_count(sim), sizeof *forces->pair);
    forces->pair_next = pel_allocate(pair_count(sim), sizeof *forces->pair_next);
    bool made = forces->vertex != NULL && forces->vertex_next != NULL && forces->is_touched != NULL &&
                forces->is_touched_next != NULL && forces->pair != NULL && forces->pair_next != NULL;
    return made ? PEL_OK : pel_fail_memory(error);
}

void pel_contact_forces_destroy(pel_sim *sim)
{
    pel_contact_forces *forces = &sim->contact_forces;
    pel_free(forces->vertex);
    pel_free(forces->vertex_next);
    pel_free(forces->is_touched);
    pel_free(forces->is_touched_next);
    pel_free(forces->pair);
    pel_free(forces->pair_next);
    pel_contact_records_destroy(forces);
}

void pel_contact_forces_begin(pel_sim *sim)
{
    pel_contact_forces *forces = &sim->contact_forces;
    if (forces->vertex == NULL)
        return;
    for (size_t slice = 0; slice < flag_count(sim); slice++)
        if (forces->is_touched_next[slice])
            memset(forces->vertex_next + slice * PEL_WIDTH, 0, PEL_WIDTH * sizeof *forces->vertex_next);
    memset(forces->is_touched_next, 0, flag_count(sim));
    memset(forces->pair_next, 0, pair_count(sim) * sizeof *forces->pair_next);
    pel_contact_records_begin(forces);
}

/* forces of a step in parts are means over its parts */
static void add_part(pel_sim *sim, double share)
{
    pel_contact_forces *forces = &sim->contact_forces;
    bool is_first = sim->parts.at == 0;
    double *sum = (double *)forces->pair;
    const double *own = (const double *)forces->pair_next;
    for (int32_t v = 0; v < sim->model->vertex_count; v++) {
        pel_record before = is_first ? (pel_record){0} : forces->vertex[v];
        forces->vertex[v] = before + (pel_real)share * forces->vertex_next[v];
    }
    for (size_t slice = 0; slice < flag_count(sim); slice++)
        forces->is_touched[slice] =
            (uint8_t)((!is_first && forces->is_touched[slice]) | forces->is_touched_next[slice]);
    for (size_t i = 0; i < pair_count(sim) * sizeof *forces->pair / sizeof *sum; i++)
        sum[i] = (is_first ? 0 : sum[i]) + share * own[i];
}

void pel_contact_forces_accept(pel_sim *sim)
{
    pel_contact_forces *forces = &sim->contact_forces;
    bool is_part = sim->parts.step_size < PEL_PART_LIMIT;
    pel_contact_records_accept(forces, is_part ? pel_part_share(sim) : 1, !is_part || sim->parts.at == 0);
    if (forces->vertex != NULL && is_part) {
        add_part(sim, pel_part_share(sim));
        return;
    }
    pel_record *vertex = forces->vertex;
    uint8_t *is_touched = forces->is_touched;
    pel_pair_force *pair = forces->pair;
    forces->vertex = forces->vertex_next;
    forces->vertex_next = vertex;
    forces->is_touched = forces->is_touched_next;
    forces->is_touched_next = is_touched;
    forces->pair = forces->pair_next;
    forces->pair_next = pair;
}

void pel_contact_forces_loaded(pel_sim *sim)
{
    if (sim->contact_forces.vertex != NULL)
        memset(sim->contact_forces.is_touched, 1, flag_count(sim));
    pel_contact_records_forget(&sim->contact_forces);
}

/* ---- actions ---- */

static int32_t body_of(const pel_sim *sim, int32_t v)
{
    return sim->model->body_of_slice[v / PEL_WIDTH];
}

static void add_to_vertex(pel_sim *sim, int32_t v, double share, const double force[3])
{
    sim->contact_forces.is_touched_next[v / PEL_WIDTH] = 1;
    for (int k = 0; k < 3; k++)
        sim->contact_forces.vertex_next[v][k] += (pel_real)(share * force[k]);
}

/* the two groups of an action, the lower one first, and the sum of weights of that one; false inside a body */
static bool find_groups(const pel_sim *sim, const pel_contact_action *action, int32_t groups[2], double *side)
{
    groups[0] = groups[1] = -1;
    if (action->tool >= 0)
        groups[1] = sim->model->body_count + action->tool;
    for (int i = 0; i < 4; i++) {
        int32_t body = body_of(sim, action->vertices[i]);
        if (action->weights[i] == 0 || body == groups[0])
            continue;
        groups[1] = groups[0] > body ? groups[0] : groups[0] < 0 ? groups[1] : body;
        groups[0] = groups[0] < 0 || body < groups[0] ? body : groups[0];
    }
    *side = 0;
    for (int i = 0; i < 4; i++)
        *side += body_of(sim, action->vertices[i]) == groups[0] ? action->weights[i] : 0;
    return groups[0] >= 0 && groups[1] >= 0;
}

/* way of the weighted sum since the start of the step, less that of the tool on its other side */
static void find_way(const pel_sim *sim, const pel_contact_action *action, const double point[3], double side,
                     double way[3])
{
    pel_vec3_set(way, 0, 0, 0);
    for (int i = 0; i < 4; i++) {
        double x[3], start[3];
        pel_vertex_position(sim->state->position_next, action->vertices[i], x);
        pel_vertex_position(sim->state->position, action->vertices[i], start);
        pel_vec3_subtract(x, start, x);
        pel_vec3_along(way, action->weights[i], x, way);
    }
    if (action->tool < 0)
        return;
    const pel_tool *tool = &sim->tools[action->tool];
    double local[3], before[3];
    pel_pose_to_local(&tool->pose, point, local);
    pel_pose_to_world(&tool->pose_before, local, before);
    pel_vec3_subtract(point, before, before);
    pel_vec3_along(way, -side, before, way);
}

void pel_contact_forces_add(pel_sim *sim, const pel_contact_action *action)
{
    int32_t groups[2];
    double side, point[3] = {0, 0, 0}, sum = 0, way[3], x[3], load = pel_vec3_length(action->load);
    pel_contact_records_add(&sim->contact_forces, action);
    for (int i = 0; i < 4; i++)
        if (action->weights[i] != 0)
            add_to_vertex(sim, action->vertices[i], action->weights[i], action->force);
    if (!find_groups(sim, action, groups, &side))
        return;
    for (int i = 0; i < 4; i++) {
        pel_vertex_position(sim->state->position_next, action->vertices[i], x);
        pel_vec3_along(point, fabs(action->weights[i]), x, point);
        sum += fabs(action->weights[i]);
    }
    pel_vec3_scale(point, 1 / sum, point);
    find_way(sim, action, point, side, way);
    pel_pair_force *pair = &sim->contact_forces.pair_next[groups[0] * sim->contact_forces.group_count + groups[1]];
    pel_vec3_along(pair->force, side, action->force, pair->force);
    pel_vec3_along(pair->load, side, action->load, pair->load);
    pel_vec3_along(pair->point, load, point, pair->point);
    /* the load points away from the other side */
    pair->approach -= pel_vec3_dot(way, action->load);
    pair->load_size += load;
}

void pel_contact_forces_add_at(pel_sim *sim, int32_t v, int32_t tool, const double force[3])
{
    int32_t group = sim->model->body_count + tool;
    const int32_t vertices[4] = {v, v, v, v};
    pel_contact_action action = {.vertices = vertices, .weights = {1, 0, 0, 0}, .tool = tool};
    pel_vec3_copy(force, action.force);
    pel_contact_records_add(&sim->contact_forces, &action);
    pel_pair_force *pair = &sim->contact_forces.pair_next[body_of(sim, v) * sim->contact_forces.group_count + group];
    add_to_vertex(sim, v, 1, force);
    pel_vec3_add(pair->force, force, pair->force);
}

/* marks what a tool touches by a contact; the reaction is on the tool */
static void touch(pel_sim *sim, pel_tool *tool, const pel_contact *contact, double free, double side,
                  const double force[3])
{
    const pel_record *positions = sim->state->position_next;
    double point[3] = {0, 0, 0}, sum = 0, back[3], x[3];
    for (int i = 0; i < 4; i++) {
        double weight = (double)contact->weights[i];
        if (weight == 0)
            continue;
        pel_vertex_position(positions, contact->vertices[i], x);
        pel_vec3_along(point, fabs(weight), x, point);
        sum += fabs(weight);
    }
    for (int i = 0; i < 4; i++) {
        int32_t v = contact->vertices[i];
        double share = (double)(contact->weights[i] * contact->push * positions[v][3]) / free;
        if (share == 0)
            continue;
        pel_contact_vertex *touch = pel_tool_touch(tool, v);
        for (int k = 0; k < 3; k++)
            touch->push[k] += share * (double)contact->normal[k];
    }
    pel_vec3_scale(point, 1 / sum, point);
    /* of surfaces the tool may be the first or the second one */
    pel_vec3_scale(force, -copysign(1, side), back);
    pel_tool_add_reaction(tool, point, back);
}

void pel_contact_take(pel_sim *sim, int32_t tool, const pel_contact *contact, const double change[3], double rate)
{
    pel_contact_action action = {.vertices = contact->vertices, .tool = tool};
    double free = 0, side = 0, along = 0;
    for (int i = 0; i < 4; i++) {
        double weight = action.weights[i] = (double)contact->weights[i];
        free += (double)sim->state->position_next[contact->vertices[i]][3] * weight * weight;
        side += weight;
    }
    if (!(free > 0))
        return;
    for (int k = 0; k < 3; k++)
        along += change[k] * (double)contact->normal[k] * rate / free;
    for (int k = 0; k < 3; k++)
        action.load[k] = along * (double)contact->normal[k];
    pel_vec3_scale(change, rate / free, action.force);
    pel_contact_forces_add(sim, &action);
    if (tool >= 0)
        touch(sim, &sim->tools[tool], contact, free, side, action.force);
}

void pel_contact_take_push(pel_sim *sim, int32_t tool, const pel_contact *contact, double rate)
{
    double change[3];
    for (int k = 0; k < 3; k++)
        change[k] = (double)(contact->push * contact->normal[k] + contact->tangential[k]);
    pel_contact_take(sim, tool, contact, change, rate);
}

/* ---- readings ---- */

void pel_sim_get_contact_forces(const pel_sim *sim, int32_t body, double *forces)
{
    if (!pel_sim_has_body(sim, body) || forces == NULL)
        return;
    int32_t count = pel_output_count(sim, body);
    for (int32_t r = 0; r < count; r++) {
        double force[3] = {0, 0, 0};
        if (sim->contact_forces.vertex != NULL)
            pel_vertex_position(sim->contact_forces.vertex, pel_output_model_index(sim, body, r), force);
        pel_vec3_copy(force, forces + 3 * (size_t)r);
    }
}

void pel_sim_get_body_contact(const pel_sim *sim, int32_t body, double force[3])
{
    if (!pel_sim_has_body(sim, body) || force == NULL)
        return;
    const pel_contact_forces *forces = &sim->contact_forces;
    pel_vec3_set(force, 0, 0, 0);
    for (int32_t other = 0; forces->pair != NULL && other < sim->model->body_count; other++) {
        int32_t row = other < body ? other : body, column = other < body ? body : other;
        if (other != body)
            pel_vec3_along(force, other < body ? -1 : 1, forces->pair[row * forces->group_count + column].force, force);
    }
}
