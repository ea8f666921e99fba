/* Getters between the model's vertex order and the mesh's, and sums over everything. */
#include "observe/observe.h"

#include "boundary/forces.h"
#include "boundary/loads.h"
#include "math/extremes.h"
#include "math/functions.h"
#include "math/vec3.h"
#include "pellicle/sim_contact.h"
#include "pellicle/sim_forces.h"
#include "pellicle/sim_surface.h"
#include "stage/rigids.h"
#include "stage/shells.h"
#include "stage/surface_view.h"

/* velocities of the last step: stored by the explicit method, else the displacement over dt */
static void vertex_velocity(const pel_sim *sim, int32_t i, double velocity[3])
{
    const pel_state *state = sim->state;
    for (int c = 0; c < 3; c++)
        velocity[c] = state->velocity != NULL
                          ? (double)state->velocity[i][c]
                          : ((double)state->position[i][c] - (double)state->position_before[i][c]) / sim->step.dt;
}

static void copy_out(const pel_sim *sim, int32_t body, const pel_record *records, double *out)
{
    int32_t count = pel_output_count(sim, body);
    for (int32_t r = 0; r < count; r++) {
        int32_t place = pel_output_model_index(sim, body, r);
        for (int c = 0; c < 3; c++)
            out[3 * (size_t)r + (size_t)c] = (double)records[place][c];
    }
}

void pel_sim_get_positions(const pel_sim *sim, int32_t body, double *positions)
{
    if (!pel_sim_has_body(sim, body) || positions == NULL)
        return;
    copy_out(sim, body, sim->state->position, positions);
}

void pel_sim_get_velocities(const pel_sim *sim, int32_t body, double *velocities)
{
    if (!pel_sim_has_body(sim, body) || velocities == NULL)
        return;
    int32_t count = pel_output_count(sim, body);
    for (int32_t r = 0; r < count; r++)
        vertex_velocity(sim, pel_output_model_index(sim, body, r), velocities + 3 * (size_t)r);
}

double pel_sim_next_energy(pel_sim *sim)
{
    pel_sim_measures sums = {0};
    pel_state *state = sim->state;
    pel_record *position = state->position, *velocity = state->velocity;
    state->position = state->position_next;
    state->velocity = state->velocity_next;
    pel_rigid_state *rigids = state->rigids;
    state->rigids = state->rigids_next;
    sim->present.has_force = false;
    pel_sim_sum_energies(sim, &sums);
    sim->present.has_force = false;
    state->position = position;
    state->velocity = velocity;
    state->rigids = rigids;
    return sums.elastic_energy + sums.kinetic_energy;
}

void pel_sim_get_forces(pel_sim *sim, int32_t body, double *forces)
{
    if (!pel_sim_has_body(sim, body) || forces == NULL)
        return;
    pel_sim_compute_forces(sim);
    copy_out(sim, body, sim->force, forces);
}

double pel_sim_max_speed(const pel_sim *sim)
{
    if (sim == NULL)
        return 0;
    double largest = 0;
    for (int32_t b = 0; b < sim->model->body_count; b++) {
        int32_t count = pel_output_count(sim, b);
        for (int32_t r = 0; r < count; r++) {
            double velocity[3];
            vertex_velocity(sim, pel_output_model_index(sim, b, r), velocity);
            largest = pel_max(largest, pel_vec3_squared_length(velocity));
        }
    }
    return sqrt(largest);
}

void pel_sim_get_energies(const pel_sim *sim, int32_t body, double *spring, double *volumetric)
{
    if (!pel_sim_has_body(sim, body) || spring == NULL || volumetric == NULL)
        return;
    const pel_body *b = &sim->model->bodies[body];
    for (int32_t slice = b->slice_begin; slice < b->slice_end; slice++) {
        pel_wide s, w;
        pel_slice_energy(sim->model, sim->state, slice, &s, &w);
        for (int32_t lane = 0; lane < PEL_WIDTH; lane++) {
            int32_t v = sim->model->mesh_vertex[slice * PEL_WIDTH + lane];
            if (v < 0)
                continue;
            int32_t row = pel_output_vertex(sim, body, v);
            spring[row] = (double)s[lane];
            volumetric[row] = (double)w[lane];
        }
    }
}

void pel_sim_get_contacts(const pel_sim *sim, int32_t body, double *contact)
{
    if (!pel_sim_has_body(sim, body) || contact == NULL)
        return;
    int32_t count = pel_output_count(sim, body);
    for (int32_t r = 0; r < count; r++)
        contact[r] = sim->state->contact[pel_output_model_index(sim, body, r)];
}

/* ---- measures ---- */

/* corners of a triangle about an origin */
static void corners_at(const pel_record *records, const int32_t v[3], const double origin[3], double x[3][3])
{
    for (int k = 0; k < 3; k++) {
        pel_record r = records[v[k]];
        pel_vec3_set(x[k], (double)r[0] - origin[0], (double)r[1] - origin[1], (double)r[2] - origin[2]);
    }
}

/* area and enclosed volume of a body, about its first vertex, at the given positions */
static void measure_surface(const pel_sim *sim, const pel_record *records, int32_t body, double *area, double *volume)
{
    const pel_model *model = sim->model;
    const pel_front_triangle *surface = pel_surface_in_order(sim, body);
    const int32_t(*triangles)[3] = (const int32_t(*)[3])model->triangles + model->triangle_begin[body];
    int32_t count = pel_surface_count(model, body);
    pel_record first = records[model->bodies[body].model_index[0]];
    const double origin[3] = {(double)first[0], (double)first[1], (double)first[2]};
    double area_sum = 0, volume_sum = 0;
    for (int32_t i = 0; i < count; i++) {
        double x[3][3], u[3], w[3], n[3];
        corners_at(records, triangles[surface != NULL ? pel_surface_number(&surface[i]) : i], origin, x);
        pel_vec3_subtract(x[1], x[0], u);
        pel_vec3_subtract(x[2], x[0], w);
        pel_vec3_cross(u, w, n);
        area_sum += pel_vec3_length(n) / 2;
        volume_sum += pel_vec3_dot(x[0], n) / 6;
    }
    *area = area_sum;
    *volume = volume_sum;
}

static void measure_surfaces(const pel_sim *sim, pel_sim_measures *measures)
{
    double area = 0, rest_area = 0, volume = 0, rest_volume = 0;
    measures->least_volume_ratio = HUGE_VAL;
    for (int32_t b = 0; b < sim->model->body_count; b++) {
        const pel_body *body = &sim->model->bodies[b];
        double body_area, body_volume, body_rest_area = body->rest_area, body_rest_volume = body->rest_volume;
        measure_surface(sim, sim->state->position, b, &body_area, &body_volume);
        if (body->front != NULL && body->front->red_count > 0)
            measure_surface(sim, sim->model->rest, b, &body_rest_area, &body_rest_volume);
        area += body_area;
        rest_area += body_rest_area;
        measures->volume += body->closed ? body_volume : 0;
        volume += body->has_volume ? body_volume : 0;
        rest_volume += body->has_volume ? body_rest_volume : 0;
        if (body->has_volume)
            measures->least_volume_ratio = pel_min(measures->least_volume_ratio, body_volume / body_rest_volume);
        measures->vertex_count += pel_sim_vertex_count(sim, b);
        measures->triangle_count += pel_sim_triangle_count(sim, b);
    }
    measures->area_ratio = area / rest_area;
    bool has_volume = isfinite(measures->least_volume_ratio);
    measures->volume_ratio = has_volume ? volume / rest_volume : (double)NAN;
    measures->least_volume_ratio = has_volume ? measures->least_volume_ratio : (double)NAN;
}

double pel_sim_volume_ratio(const pel_sim *sim)
{
    if (sim == NULL)
        return 0;
    pel_sim_measures measures = {0};
    measure_surfaces(sim, &measures);
    return measures.volume_ratio;
}

/* Velocity at the time of the positions. The leapfrog's belongs to the middle of the last step: half a kick of the
   present forces is missing, except where a tool or contact takes it, or before the first step. */
static void present_velocity(const pel_sim *sim, int32_t i, double velocity[3])
{
    const pel_state *state = sim->state;
    bool is_held = state->contact[i] || (sim->held != NULL && sim->held[i]);
    bool is_first = state->step == 0 && sim->shells != NULL;
    vertex_velocity(sim, i, velocity);
    if (!pel_sim_is_explicit(sim) || !sim->solver.symplectic || is_held || is_first ||
        pel_rigid_of(sim->rigids, i) != NULL)
        return;
    double dt = sim->step.dt, kept = pel_exp(-0.5 * sim->solver.drag * dt);
    double gain = 0.5 * dt * (double)sim->model->inverse_mass[i];
    for (int c = 0; c < 3; c++)
        velocity[c] = kept * velocity[c] + gain * (double)sim->force[i][c];
}

static void sum_energies(pel_sim *sim)
{
    const pel_model *model = sim->model;
    double spring_sum = 0, volumetric_sum = 0, kinetic_sum = 0;
    for (int32_t slice = 0; slice < model->slice_count; slice++) {
        pel_wide spring, volumetric;
        pel_slice_energy(model, sim->state, slice, &spring, &volumetric);
        for (int32_t lane = 0; lane < PEL_WIDTH; lane++) {
            int32_t i = slice * PEL_WIDTH + lane;
            double velocity[3];
            if (model->mesh_vertex[i] < 0)
                continue;
            present_velocity(sim, i, velocity);
            spring_sum += (double)spring[lane];
            volumetric_sum += (double)volumetric[lane];
            kinetic_sum += 0.5 * (double)model->mass[i] * pel_vec3_squared_length(velocity);
        }
    }
    if (sim->rigids != NULL)
        kinetic_sum += pel_rigids_extra_energy(sim, sim->state->rigids, sim->state->velocity);
    sim->present.spring_energy = spring_sum;
    sim->present.volumetric_energy = volumetric_sum;
    sim->present.kinetic_energy = kinetic_sum;
}

void pel_sim_sum_energies(pel_sim *sim, pel_sim_measures *measures)
{
    pel_sim_compute_forces(sim);
    if (!sim->present.has_energies)
        sum_energies(sim);
    sim->present.has_energies = true;
    measures->spring_energy = sim->present.spring_energy;
    measures->volumetric_energy = sim->present.volumetric_energy;
    measures->kinetic_energy = sim->present.kinetic_energy;
    measures->membrane_energy = sim->present.shell_energy.membrane;
    measures->bending_energy = sim->present.shell_energy.bending;
    measures->fibre_energy = sim->present.shell_energy.fibres;
    measures->elastic_energy = sim->present.spring_energy + sim->present.volumetric_energy + measures->membrane_energy +
                               measures->bending_energy + measures->fibre_energy + sim->present.shell_energy.volume;
}

/* the largest one, and the number of vertices in contact */
static void measure_displacements(const pel_sim *sim, pel_sim_measures *measures)
{
    const pel_model *model = sim->model;
    double largest = 0; /* square */
    for (int32_t i = 0; i < model->vertex_count; i++) {
        double offset[3];
        if (model->mesh_vertex[i] < 0)
            continue;
        for (int c = 0; c < 3; c++)
            offset[c] = (double)sim->state->position[i][c] - (double)model->rest[i][c];
        double square = pel_vec3_squared_length(offset);
        largest = square > largest ? square : largest;
        measures->contact_count += sim->state->contact[i];
    }
    measures->max_displacement = sqrt(largest);
}

/* the largest one, and the sum over free vertices */
static void measure_forces(const pel_sim *sim, pel_sim_measures *measures)
{
    const pel_model *model = sim->model;
    double largest = 0; /* square */
    for (int32_t i = 0; i < model->vertex_count; i++) {
        double force[3];
        if (model->mesh_vertex[i] < 0)
            continue;
        for (int c = 0; c < 3; c++)
            force[c] = (double)sim->force[i][c];
        double square = pel_vec3_squared_length(force);
        largest = square > largest ? square : largest;
        bool is_held = sim->state->contact[i] || (sim->held != NULL && sim->held[i]);
        if (!is_held && model->inverse_mass[i] > 0)
            measures->unbalanced_force += sqrt(square);
    }
    measures->max_force = sqrt(largest);
}

void pel_sim_measure_parts(pel_sim *sim, bool has_surfaces, bool has_energies, pel_sim_measures *measures)
{
    *measures = (pel_sim_measures){0};
    if (has_surfaces)
        measure_surfaces(sim, measures);
    if (has_energies)
        pel_sim_sum_energies(sim, measures);
    measure_displacements(sim, measures);
    if (has_energies)
        measure_forces(sim, measures);
}

void pel_sim_measure(pel_sim *sim, pel_sim_measures *measures)
{
    if (sim != NULL && measures != NULL)
        pel_sim_measure_parts(sim, true, true, measures);
}

/* ---- the solver ---- */

void pel_sim_get_solver(const pel_sim *sim, pel_solver_reading *reading)
{
    if (sim == NULL || reading == NULL)
        return;
    *reading = (pel_solver_reading){.stray_body = -1};
    if (sim->stepper->get_solver != NULL)
        sim->stepper->get_solver(sim, reading);
}
