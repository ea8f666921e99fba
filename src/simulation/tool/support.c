/* Forces on the supports of bodies: vertices that are pinned, and keyed supports, which are tools. */
#include "tool/support.h"

#include "base/assert.h"
#include "base/memory.h"
#include "base/status.h"
#include "boundary/forces.h"
#include "boundary/hold.h"
#include "stage/surface_view.h"

#include <string.h>

static bool is_pinned(const pel_sim *sim, int32_t v)
{
    PEL_ASSERT_INDEX(v, sim->model->vertex_count);
    return sim->model->mesh_vertex[v] >= 0 && !(sim->model->inverse_mass[v] > 0);
}

static int32_t count_pins(const pel_sim *sim, int32_t body)
{
    int32_t count = 0;
    for (int32_t v = sim->model->bodies[body].slice_begin * PEL_WIDTH; v < pel_body_place_end(sim->model, body); v++)
        count += is_pinned(sim, v);
    return count;
}

static bool has_pins(const pel_sim *sim)
{
    for (int32_t v = 0; v < sim->model->vertex_count; v++)
        if (is_pinned(sim, v))
            return true;
    return false;
}

static bool has_support_tools(const pel_sim *sim)
{
    for (int32_t t = 0; t < sim->tools->count; t++)
        if (sim->tools->items[t].support != NULL)
            return true;
    return false;
}

pel_status pel_supports_create(pel_sim *sim, pel_error *error)
{
    bool records = sim->stepper->get_held_force != NULL && has_pins(sim);
    if (!records && sim->holds == NULL && !has_support_tools(sim))
        return PEL_OK;
    sim->reactions = pel_allocate((size_t)sim->model->vertex_count, sizeof *sim->reactions);
    if (sim->reactions == NULL)
        return pel_fail_memory(error);
    return records && sim->stepper->record_held != NULL ? sim->stepper->record_held(sim, error) : PEL_OK;
}

void pel_supports_destroy(pel_sim *sim)
{
    pel_free(sim->reactions);
}

/* ---- after a part of a step ---- */

/* pins of bodies that sleep keep their loads */
static bool sleeps(const pel_sim *sim, int32_t v)
{
    return sim->asleep != NULL && sim->asleep[sim->model->body_of_slice[v / PEL_WIDTH]];
}

/* reactions of a step in parts are means */
void pel_supports_read(pel_sim *sim, double time)
{
    double share = -pel_part_share(sim);
    if (sim->reactions == NULL)
        return;
    for (int32_t v = 0; sim->part.at == 0 && v < sim->model->vertex_count; v++)
        if (!sleeps(sim, v))
            pel_vec3_set(sim->reactions[v], 0, 0, 0);
    pel_holds_read(sim, time);
    for (int32_t v = 0; sim->stepper->get_held_force != NULL && v < sim->model->vertex_count; v++) {
        double force[3];
        if (!is_pinned(sim, v) || !pel_sim_records_pin(sim, v) || sleeps(sim, v))
            continue;
        sim->stepper->get_held_force(sim, v, force);
        pel_vec3_along(sim->reactions[v], share, force, sim->reactions[v]);
    }
    for (int32_t t = 0; t < sim->tools->count; t++) {
        const pel_tool *tool = &sim->tools->items[t];
        for (int32_t i = 0; tool->support != NULL && i < tool->held_count; i++) {
            double *at = sim->reactions[tool->held[i]];
            pel_vec3_along(at, share, sim->tools->grip_forces[tool->held[i]], at);
        }
    }
}

/* ---- readings ---- */

/* the force of a support on a vertex; of methods that record none at pins: against the present forces, computed before
 */
static void find_reaction(const pel_sim *sim, int32_t v, double force[3])
{
    PEL_ASSERT_INDEX(v, sim->model->vertex_count);
    double contact[3];
    pel_vec3_set(force, 0, 0, 0);
    if (sim->reactions != NULL)
        pel_vec3_copy(sim->reactions[v], force);
    if (pel_sim_records_pin(sim, v) || !is_pinned(sim, v))
        return;
    pel_vertex_position(sim->force, v, force);
    pel_contact_force_at(&sim->contact_forces.vertex, v, contact);
    pel_vec3_add(force, contact, force);
    pel_vec3_scale(force, -1, force);
}

void pel_supports_get_reactions(pel_sim *sim, int32_t body, double *reactions)
{
    PEL_ASSERT_INDEX(body, sim->model->body_count);
    int32_t first = sim->model->bodies[body].slice_begin * PEL_WIDTH;
    if (count_pins(sim, body) > 0 && !pel_sim_records_pin(sim, first))
        pel_sim_compute_forces(sim);
    for (int32_t r = 0; r < pel_output_count(sim, body); r++)
        find_reaction(sim, pel_output_model_index(sim, body, r), reactions + 3 * (size_t)r);
}

static void add_force(pel_support_reading *reading, const double point[3], const double force[3])
{
    double torque[3];
    pel_vec3_cross(point, force, torque);
    pel_vec3_add(reading->force, force, reading->force);
    pel_vec3_add(reading->torque, torque, reading->torque);
}

static void add_pins(pel_sim *sim, int32_t body, pel_support_reading *reading)
{
    int32_t first = sim->model->bodies[body].slice_begin * PEL_WIDTH;
    if (!pel_sim_records_pin(sim, first))
        pel_sim_compute_forces(sim);
    for (int32_t v = first; v < pel_body_place_end(sim->model, body); v++) {
        double point[3], force[3];
        if (!is_pinned(sim, v))
            continue;
        pel_vertex_position(sim->state->position, v, point);
        find_reaction(sim, v, force);
        pel_vec3_scale(force, -1, force);
        add_force(reading, point, force);
    }
}

void pel_sim_get_support(pel_sim *sim, int32_t body, pel_support_reading *reading)
{
    if (!pel_sim_has_body(sim, body) || reading == NULL)
        return;
    *reading = (pel_support_reading){0};
    reading->vertex_count = count_pins(sim, body);
    if (reading->vertex_count > 0)
        add_pins(sim, body, reading);
    pel_holds_add_readings(sim, body, reading);
    for (int32_t t = 0; t < sim->tools->count; t++) {
        const pel_tool *tool = &sim->tools->items[t];
        if (tool->support == NULL || tool->body != body)
            continue;
        add_force(reading, tool->pose.position, tool->force);
        pel_vec3_add(reading->torque, tool->torque, reading->torque);
        reading->vertex_count += tool->held_count;
    }
}

/* ---- snapshots ---- */

void pel_supports_transfer(pel_cursor *at, const pel_sim *sim, int32_t unused)
{
    if (sim->reactions != NULL)
        pel_transfer_vertices(at, sim->reactions, (size_t)sim->model->vertex_count, sizeof *sim->reactions);
    pel_holds_transfer(at, sim, unused);
}

/* vertices that are no longer pinned have no reaction */
void pel_supports_release(const pel_sim *from, const pel_sim *to)
{
    for (int32_t v = 0; to->reactions != NULL && v < to->model->vertex_count; v++)
        if (to->model->inverse_mass[v] > 0 && !(from->model->inverse_mass[v] > 0))
            memset(to->reactions[v], 0, sizeof *to->reactions);
}
