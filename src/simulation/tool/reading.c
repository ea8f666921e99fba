/* Forces of the surface on tools. Quasi-static method: the part of the force F_i of eq. A-2 on each touched vertex that
   presses against the tool (held vertices: all of it); at rest this balances the push exactly, and friction carries the
   tangential part up to its limit. Explicit method: the momentum taken from the vertices over dt. Minimisation: the sum
   of the loads of its contacts (descent.h), and all of F_i on held vertices. */
#include "tool/reading.h"

#include "base/assert.h"
#include "boundary/loads.h"
#include "math/extremes.h"
#include "tool/press.h"

#include <string.h>

/* ---- forces of the methods without velocities ---- */

/* forces of loads and shells at the new positions on the touched vertices, into sim->force */
static void find_load_and_shell_forces(pel_sim *sim, double time)
{
    for (int32_t i = 0; i < sim->tools->count; i++)
        for (int32_t k = 0; k < sim->tools->items[i].touch_count; k++)
            sim->force[sim->tools->items[i].touches[k].vertex] = (pel_record){0};
    pel_loads_add(sim, pel_instant(time), sim->state->position_next, sim->force);
    pel_shell_forces_add(sim->shells, sim->state->position_next, pel_instant(time), PEL_SHELL_ALL, sim->pool,
                         sim->force);
}

/* force on a touched vertex at the new positions, other contacts included */
static void static_force(const pel_sim *sim, int32_t v, double force[3])
{
    PEL_ASSERT_INDEX(v, sim->model->vertex_count);
    const pel_state *state = sim->state;
    pel_record elastic = pel_elastic_force_at(sim->model, state, state->position_next, v);
    double contact[3];
    pel_contact_force_at(&sim->contact_forces.vertex_next, v, contact);
    for (int i = 0; i < 3; i++)
        force[i] = (double)(elastic[i] + sim->force[v][i] + (pel_real)contact[i]);
}

/* normal part of a force, which cannot pull, and the tangential part that friction holds */
static void hold_against(const pel_sim *sim, const pel_tool *tool, int32_t v, const double push[3], double force[3])
{
    PEL_ASSERT_INDEX(v, sim->model->vertex_count);
    double square = pel_vec3_squared_length(push), pressing[3], across[3];
    double along = square > 0 ? pel_min(pel_vec3_dot(force, push) / square, 0) : 0;
    double friction = pel_sim_friction(sim, tool, v);
    pel_vec3_scale(push, along, pressing);
    pel_vec3_subtract(force, pressing, across);
    double limit = friction * pel_vec3_length(pressing), length = pel_vec3_length(across);
    pel_vec3_along(pressing, length > limit ? limit / length : 1, across, force);
}

static void read_forces(pel_sim *sim, pel_tool *tool)
{
    for (int32_t i = 0; i < tool->touch_count; i++) {
        const pel_contact_vertex *touch = &tool->touches[i];
        double force[3], x[3];
        if (sim->held[touch->vertex] && sim->stepper->get_held_force != NULL)
            continue;
        /* of the rest the minimisation knows the loads, but of meshes that only a correction after it keeps out */
        if (sim->stepper->read_tools != NULL && !sim->held[touch->vertex] &&
            (tool->mesh == NULL || pel_sim_has_loop_contacts(sim)))
            continue;
        static_force(sim, touch->vertex, force);
        pel_vertex_position(sim->state->position_next, touch->vertex, x);
        if (sim->held[touch->vertex]) {
            pel_tool_add_grip(sim, tool, touch->vertex, x, force);
        } else {
            hold_against(sim, tool, touch->vertex, touch->push, force);
            pel_tool_add_reaction(tool, x, force);
            pel_vec3_scale(force, -1, force);
            pel_contact_forces_add_at(&sim->contact_forces, touch->vertex, (int32_t)(tool - sim->tools->items), force);
        }
    }
}

/* ---- all methods ---- */

void pel_tool_mean_point(const pel_sim *sim, const pel_tool *tool, int32_t v, double point[3])
{
    PEL_ASSERT_INDEX(v, sim->model->vertex_count);
    for (int k = 0; k < 3; k++) {
        double before = (double)sim->state->position[v][k] - tool->pose_before.position[k];
        double after = (double)sim->state->position_next[v][k] - tool->pose.position[k];
        point[k] = tool->pose.position[k] + 0.5 * (before + after);
    }
}

/* Contact forces on held vertices act on their tool; the explicit step needs their mass again. Where contacts are
   constraints of a minimisation, they are among its forces on held vertices. */
static void pass_contacts_on(pel_sim *sim, pel_tool *tool)
{
    const bool is_counted = sim->stepper->minimises && sim->contact_in_loop;
    for (int32_t i = 0; i < tool->held_count; i++) {
        int32_t v = tool->held[i];
        double force[3], point[3];
        /* the grip itself is among the forces of the step */
        pel_contact_force_at(&sim->contact_forces.vertex_next, v, force);
        pel_vec3_add(force, sim->tools->grip_forces[v], force);
        pel_tool_mean_point(sim, tool, v, point);
        if (!is_counted)
            pel_tool_add_grip(sim, tool, v, point, force);
        if (!pel_sim_projects_elements(sim))
            sim->state->position_next[v][3] = sim->model->inverse_mass[v];
    }
}

void pel_tools_read(pel_sim *sim, double time)
{
    int32_t touch_count = 0;
    if (sim->stepper->read_tools != NULL)
        sim->stepper->read_tools(sim);
    for (int32_t i = 0; i < sim->tools->count && sim->state->velocity_next != NULL; i++)
        pass_contacts_on(sim, &sim->tools->items[i]);
    if (sim->stepper->read_grips != NULL)
        sim->stepper->read_grips(sim);
    for (int32_t i = 0; i < sim->tools->count; i++)
        touch_count += sim->tools->items[i].touch_count;
    if (sim->state->velocity_next == NULL && touch_count > 0) {
        find_load_and_shell_forces(sim, time);
        for (int32_t i = 0; i < sim->tools->count; i++)
            read_forces(sim, &sim->tools->items[i]);
    }
    for (int32_t i = 0; i < sim->tools->count; i++) {
        sim->tools->items[i].contact_count = sim->tools->items[i].touch_count;
        sim->tools->items[i].is_on_its_way = false;
    }
}

/* ---- readings ---- */

int32_t pel_sim_tool_count(const pel_sim *sim)
{
    if (sim == NULL)
        return 0;
    return sim->tools->count;
}

int32_t pel_sim_find_tool(const pel_sim *sim, const char *name)
{
    for (int32_t t = 0; t < sim->tools->count; t++)
        if (strcmp(sim->tools->items[t].name, name) == 0)
            return t;
    return -1;
}

const char *pel_sim_tool_name(const pel_sim *sim, int32_t tool)
{
    if (sim == NULL || tool < 0 || tool >= sim->tools->count)
        return "";
    return sim->tools->items[tool].name;
}

void pel_sim_get_tool(const pel_sim *sim, int32_t tool, pel_tool_reading *reading)
{
    if (sim == NULL || reading == NULL || tool < 0 || tool >= sim->tools->count)
        return;
    const pel_tool *t = &sim->tools->items[tool];
    memcpy(reading->position, t->pose.position, sizeof reading->position);
    memcpy(reading->rotation, t->pose.rotation, sizeof reading->rotation);
    memcpy(reading->force, t->force, sizeof reading->force);
    memcpy(reading->torque, t->torque, sizeof reading->torque);
    reading->contact_count = t->contact_count;
    reading->held_count = t->held_count;
    reading->lost_count = t->tally.lost_count;
    reading->lost_time = t->tally.lost_time;
    reading->lost_limit = t->tally.lost_limit;
    reading->is_held_back = t->is_held_back;
    reading->force_known = !t->is_stopped;
    reading->held_back_count = t->tally.held_back_count;
    reading->held_back_time = t->tally.held_back_time;
}
