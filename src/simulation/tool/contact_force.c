/* Forces of contacts on vertices and tools, and their readings. */
#include "tool/contact_force.h"

#include "base/assert.h"
#include "pellicle/sim_contact.h"
#include "stage/surface_view.h"

void pel_contact_act(pel_sim *sim, const pel_contact_action *action)
{
    const pel_tool *tool = action->obstacle >= 0 ? &sim->tools->items[action->obstacle] : NULL;
    const pel_contact_way way = {sim->state->position, sim->state->position_next,
                                 tool != NULL ? &tool->pose_before : NULL, tool != NULL ? &tool->pose : NULL};
    pel_contact_forces_add(&sim->contact_forces, &way, action);
}

/* marks the vertices that a tool touches by a contact; the reaction acts on the tool */
static void touch(pel_sim *sim, pel_tool *tool, const pel_contact *contact, const pel_contact_action *action)
{
    const pel_record *positions = sim->state->position_next;
    double point[3] = {0, 0, 0}, sum = 0, side = 0, back[3], x[3];
    for (int i = 0; i < 4; i++) {
        double weight = action->weights[i];
        if (weight == 0)
            continue;
        pel_vertex_position(positions, contact->vertices[i], x);
        for (int k = 0; k < 3; k++)
            x[k] -= pel_rigid_radius(sim->rigids, contact->vertices[i]) * (double)contact->normal[k];
        pel_vec3_along(point, fabs(weight), x, point);
        sum += fabs(weight);
        side += weight;
        double share = weight * (double)(contact->multiplier * positions[contact->vertices[i]][3]);
        if (share == 0)
            continue;
        pel_contact_vertex *touch = pel_tool_touch(tool, contact->vertices[i]);
        for (int k = 0; k < 3; k++)
            touch->push[k] += share * (double)contact->normal[k];
    }
    pel_vec3_scale(point, 1 / sum, point);
    /* of surfaces the tool may be the first or the second one */
    pel_vec3_scale(action->force, -copysign(1, side), back);
    pel_tool_add_reaction(tool, point, back);
}

static void act(pel_sim *sim, int32_t tool, const pel_contact *contact, pel_contact_action *action)
{
    action->vertices = contact->vertices;
    action->obstacle = tool;
    for (int i = 0; i < 4; i++)
        action->weights[i] = (double)contact->weights[i];
    pel_contact_act(sim, action);
    if (tool >= 0)
        touch(sim, &sim->tools->items[tool], contact, action);
}

void pel_contact_take(pel_sim *sim, int32_t tool, const pel_contact *contact, double rate)
{
    PEL_ASSERT(tool >= -1 && tool < sim->tools->count);
    pel_contact_action action = {0};
    for (int k = 0; k < 3; k++) {
        action.load[k] = rate * (double)(contact->multiplier * contact->normal[k]);
        action.force[k] = action.load[k] + rate * (double)contact->drag[k];
    }
    act(sim, tool, contact, &action);
}

void pel_contact_take_stop(pel_sim *sim, int32_t tool, const pel_contact *contact, double dt)
{
    PEL_ASSERT(tool >= -1 && tool < sim->tools->count);
    pel_contact_action action = {0};
    double free = 0, along = 0;
    for (int i = 0; i < 4; i++) {
        double weight = (double)contact->weights[i];
        free += (double)sim->state->position_next[contact->vertices[i]][3] * weight * weight;
    }
    if (!(free > 0))
        return;
    for (int k = 0; k < 3; k++) {
        action.force[k] = (double)contact->stopped[k] / (free * dt);
        along += action.force[k] * (double)contact->normal[k];
    }
    for (int k = 0; k < 3; k++)
        action.load[k] = along * (double)contact->normal[k];
    act(sim, tool, contact, &action);
}

/* ---- readings ---- */

void pel_sim_get_contact_forces(const pel_sim *sim, int32_t body, double *forces)
{
    if (!pel_sim_has_body(sim, body) || forces == NULL)
        return;
    int32_t count = pel_output_count(sim, body);
    for (int32_t r = 0; r < count; r++) {
        pel_contact_force_at(&sim->contact_forces.vertex, pel_output_model_index(sim, body, r), forces + 3 * (size_t)r);
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
