/* Forces on the supports of bodies: vertices that are pinned, and keyed supports, which are tools. */
#include "base/memory.h"
#include "base/status.h"
#include "sim/hold.h"
#include "sim/tool.h"

#include <string.h>

static bool is_pinned(const pel_sim *sim, int32_t v)
{
    return sim->model->mesh_vertex[v] >= 0 && !(sim->model->inverse_mass[v] > 0);
}

static void add_force(pel_support_reading *reading, const double point[3], const double force[3])
{
    double torque[3];
    pel_vec3_cross(point, force, torque);
    pel_vec3_add(reading->force, force, reading->force);
    pel_vec3_add(reading->torque, torque, reading->torque);
}

/* forces (vertex_count) times a factor, and those of contacts, at the pinned vertices of a body, which are at
 * `positions`
 */
static void sum_pins(const pel_sim *sim, int32_t body, const pel_record *positions, const pel_record *forces,
                     double factor, const pel_record *contacts, pel_support_reading *reading)
{
    *reading = (pel_support_reading){0};
    for (int32_t v = sim->model->bodies[body].slice_begin * PEL_WIDTH; v < pel_body_place_end(sim->model, body); v++) {
        double point[3], force[3], contact[3] = {0, 0, 0};
        if (!is_pinned(sim, v))
            continue;
        pel_vertex_position(positions, v, point);
        pel_vertex_position(forces, v, force);
        if (contacts != NULL)
            pel_vertex_position(contacts, v, contact);
        pel_vec3_along(contact, factor, force, force);
        add_force(reading, point, force);
        reading->vertex_count++;
    }
}

static bool has_pins(const pel_sim *sim)
{
    for (int32_t v = 0; v < sim->model->vertex_count; v++)
        if (is_pinned(sim, v))
            return true;
    return false;
}

pel_status pel_supports_create(pel_sim *sim, pel_error *error)
{
    if ((sim->projector == NULL && sim->stepper->get_held_force == NULL) || !has_pins(sim))
        return PEL_OK;
    sim->supports = pel_allocate((size_t)sim->model->body_count, sizeof *sim->supports);
    if (sim->supports == NULL)
        return pel_fail_memory(error);
    return sim->projector != NULL ? pel_projector_record_reactions(sim->projector, error) : PEL_OK;
}

void pel_supports_destroy(pel_sim *sim)
{
    pel_free(sim->supports);
}

/* what the balance of the step says, contacts included */
static void read_balance(pel_sim *sim, int32_t body, pel_support_reading *reading)
{
    *reading = (pel_support_reading){0};
    for (int32_t v = sim->model->bodies[body].slice_begin * PEL_WIDTH; v < pel_body_place_end(sim->model, body); v++) {
        double point[3], force[3];
        if (!is_pinned(sim, v))
            continue;
        pel_vertex_position(sim->state->position_next, v, point);
        sim->stepper->get_held_force(sim, v, force);
        add_force(reading, point, force);
        reading->vertex_count++;
    }
}

/* the force of the substeps of a part; that of a step in parts is the mean */
static void read_substeps(pel_sim *sim, int32_t body, pel_support_reading *reading)
{
    const pel_support_reading before = sim->parts.at > 0 ? *reading : (pel_support_reading){0};
    sum_pins(sim, body, sim->state->position_next, sim->projector->reaction, 1.0 / sim->solver.substeps,
             sim->contact_forces.vertex_next, reading);
    pel_vec3_along(before.force, pel_part_share(sim), reading->force, reading->force);
    pel_vec3_along(before.torque, pel_part_share(sim), reading->torque, reading->torque);
}

void pel_supports_read(pel_sim *sim, double time)
{
    pel_holds_read(sim, time);
    for (int32_t b = 0; sim->supports != NULL && b < sim->model->body_count; b++)
        if (sim->projector == NULL)
            read_balance(sim, b, &sim->supports[b]);
        else
            read_substeps(sim, b, &sim->supports[b]);
}

static int32_t count_pins(const pel_sim *sim, int32_t body)
{
    int32_t count = 0;
    for (int32_t v = sim->model->bodies[body].slice_begin * PEL_WIDTH; v < pel_body_place_end(sim->model, body); v++)
        count += is_pinned(sim, v);
    return count;
}

void pel_sim_get_support(pel_sim *sim, int32_t body, pel_support_reading *reading)
{
    if (!pel_sim_has_body(sim, body) || reading == NULL)
        return;
    *reading = (pel_support_reading){0};
    if (sim->supports != NULL)
        *reading = sim->supports[body];
    reading->vertex_count = count_pins(sim, body);
    if (reading->vertex_count > 0 && sim->supports == NULL) {
        pel_sim_compute_forces(sim);
        sum_pins(sim, body, sim->state->position, sim->force, 1, sim->contact_forces.vertex, reading);
    }
    pel_holds_add_readings(sim, body, reading);
    for (int32_t t = 0; t < sim->tool_count; t++) {
        const pel_tool *tool = &sim->tools[t];
        if (tool->support == NULL || tool->body != body)
            continue;
        add_force(reading, tool->pose.position, tool->force);
        pel_vec3_add(reading->torque, tool->torque, reading->torque);
        reading->vertex_count += tool->held_count;
    }
}
