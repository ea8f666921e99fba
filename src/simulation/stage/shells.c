/* Shells under the methods that use forces, and for all methods the volume of bodies under pressure. */
#include "stage/shells.h"

#include "base/assert.h"
#include "base/status.h"
#include "force/mechanics.h"
#include "force/pressure.h"
#include "math/vec3.h"
#include "pellicle/bending.h"
#include "pellicle/sim_surface.h"
#include "solve/shell_stability.h"
#include "stage/surface_view.h"

#include <math.h>
#include <string.h>

/* rad, between triangles of a flat mesh */
#define FLAT_ANGLE 1e-5

static const char *mode_refusal(const pel_sim *sim, const pel_shell *shell)
{
    for (int32_t r = 0; r < shell->region_count; r++)
        if (shell->regions[r].def.mode == PEL_FIBRE_CAVE && !pel_sim_projects_elements(sim))
            return "anisotropy that caves in is a rule of position-based methods, not a force";
    return NULL;
}

/* The energy of isometric-rest is that of isometric less its value at rest: as a constraint it holds the rest shape,
   but as an energy it flattens it. */
static bool would_flatten(const pel_sim *sim, const pel_shell *shell)
{
    bool is_energy = shell->bending->has_hinges && !shell->bending->is_angle &&
                     shell->bending->form == PEL_BENDING_REST_SUBTRACTED && !pel_sim_projects_elements(sim);
    for (int32_t i = 0; is_energy && i < shell->hinge_count; i++) {
        const pel_shell_hinge hinge = pel_shell_hinge_of(shell, i);
        double x[4][3];
        pel_load_points(sim->model->rest, hinge.vertices, 4, x);
        if (fabs(pel_dihedral_angle((const double(*)[3])x, NULL)) > FLAT_ANGLE)
            return true;
    }
    return false;
}

static pel_status check_damping(const pel_sim *sim, int32_t b, pel_error *error)
{
    if (!pel_body_is_viscous(&sim->model->bodies[b]) || !sim->stepper->has_velocity || sim->stepper->damps)
        return PEL_OK;
    return pel_refuse_element(error, PEL_BAD_ARGUMENT, "body", b,
                              "use the method implicit or xpbd, or solver.drag, which also brakes rigid motion",
                              "damping of the material exists only for the methods implicit and xpbd");
}

static pel_status check_shells(const pel_sim *sim, pel_error *error)
{
    for (int32_t b = 0; b < sim->model->body_count; b++) {
        const pel_body *body = &sim->model->bodies[b];
        pel_status status = check_damping(sim, b, error);
        if (status != PEL_OK)
            return status;
        if (body->shell == NULL)
            continue;
        const char *refusal = mode_refusal(sim, body->shell);
        if (pel_shell_has_mode(body->shell, PEL_FIBRE_MUSCLE) && !pel_stepper_knows_material(sim->stepper))
            return pel_refuse_element(error, PEL_BAD_ARGUMENT, "body", b, "use the method xpbd, implicit or static",
                                      "muscles pull with a tension, and pbd knows no forces");
        if (refusal != NULL)
            return pel_refuse_element(error, PEL_BAD_ARGUMENT, "body", b,
                                      "use the method pbd, or one of the modes strain, active and curl", "%s", refusal);
        if (body->shell->strain_limit > 0 && !sim->stepper->limits_strain)
            return pel_refuse_element(
                error, PEL_BAD_ARGUMENT, "body", b,
                "use the method xpbd, or leave strain_limit out and take the material fung or gent, which "
                "stiffen",
                "strain_limit is a constraint of the methods pbd and xpbd");
        if ((body->shell->yield_angles != NULL || body->shell->yields) && !pel_stepper_knows_material(sim->stepper))
            return pel_refuse_element(error, PEL_BAD_ARGUMENT, "body", b, "use the method xpbd, or leave `yield` out",
                                      "what yields follows stresses, which pbd does not know");
        if (body->shell->stars != NULL && sim->stepper->is_compliant)
            return pel_refuse_element(error, PEL_BAD_ARGUMENT, "body", b,
                                      "use the method implicit, static or explicit, or volume: { element: linear }",
                                      "smooth tetrahedra have no sweeps: xpbd takes linear ones");
        if (would_flatten(sim, body->shell))
            return pel_refuse_element(
                error, PEL_BAD_ARGUMENT, "body", b, "use the bending model hinge or midedge, or the method xpbd",
                "bending model isometric-rest holds a curved rest shape as a constraint only: as an "
                "energy it flattens it");
        if (body->shell->bending->turns_edges && !sim->stepper->turns_edges)
            return pel_refuse_element(
                error, PEL_BAD_ARGUMENT, "body", b,
                "use the method implicit or static, or the bending model hinge, which ignores Poisson's ratio",
                "bending model midedge has a rotation on each edge, which only static and implicit solve for");
    }
    return PEL_OK;
}

pel_status pel_shells_create(pel_sim *sim, pel_error *error)
{
    pel_status status = check_shells(sim, error);
    if (status == PEL_OK)
        status = pel_batches_create(sim->model, sim->solver.method, &sim->batches, error);
    if (status == PEL_OK)
        status = pel_shell_forces_create(sim->batches, &sim->shells, error);
    if (status == PEL_OK)
        pel_shell_forces_set_plastic(sim->shells, &sim->state->plastic_next);
    for (int32_t b = 0; status == PEL_OK && b < sim->model->body_count; b++) {
        const pel_body *body = &sim->model->bodies[b];
        /* the criterion of refinement looks at single vertices */
        if (body->shell != NULL && body->detail != NULL && body->detail->def.above > 0)
            status = pel_shell_forces_list(sim->shells, b, error);
    }
    return status;
}

void pel_shells_destroy(pel_sim *sim)
{
    pel_shell_forces_destroy(sim->shells);
    pel_batches_destroy(sim->batches);
}

/* new position and velocity of a vertex by the force of its shell; fine vertices have no inverse mass there */
static void push_vertex(pel_sim *sim, int32_t v, pel_real position_gain, pel_real velocity_gain)
{
    PEL_ASSERT_INDEX(v, sim->model->vertex_count);
    pel_record acceleration = sim->state->position[v][3] * sim->force[v];
    sim->state->position_next[v] += position_gain * acceleration;
    if (sim->state->velocity_next != NULL)
        sim->state->velocity_next[v] += velocity_gain * acceleration;
}

void pel_shells_apply(pel_sim *sim, pel_span span, pel_gains gains)
{
    const pel_record *positions = sim->state->position;
    if (sim->shells == NULL)
        return;
    memset(sim->force, 0, (size_t)sim->model->vertex_count * sizeof *sim->force);
    pel_shell_forces_follow(sim->shells, positions);
    pel_shell_forces_add(sim->shells, positions, span, PEL_SHELL_ALL, sim->pool, sim->force);
    for (int32_t v = 0; v < sim->model->vertex_count; v++)
        push_vertex(sim, v, (pel_real)gains.position, (pel_real)gains.velocity);
}

pel_status pel_shells_check_volume(const pel_sim *sim, pel_error *error)
{
    for (int32_t b = 0; sim->shells != NULL && b < sim->model->body_count; b++) {
        const pel_body *body = &sim->model->bodies[b];
        if (body->shell == NULL || !body->has_volume || body->shell->pressure.kind == PEL_PRESSURE_NONE)
            continue;
        double volume = pel_body_volume(sim->model, b, sim->state->position_next), ratio = volume / body->rest_volume;
        sim->checked_volumes[b] = volume;
        if (ratio > 0)
            continue;
        int64_t step = sim->state->step + 1;
        return pel_refuse_element(error, PEL_DIVERGED, "body", b,
                                  "lower the pressure, stop earlier (stop: volume_ratio_below), or switch contact on",
                                  "the pressure turned it inside out in frame %lld (t = %g s)", (long long)step,
                                  (double)step * sim->step.dt);
    }
    return PEL_OK;
}

pel_tangent *pel_sim_settle_edges(const pel_sim *sim, const double **unknowns)
{
    return sim->stepper->settle_edges != NULL ? sim->stepper->settle_edges(sim, unknowns) : NULL;
}

bool pel_sim_has_shells(const pel_sim *sim)
{
    if (sim == NULL)
        return false;
    return sim->shells != NULL;
}

void pel_sim_get_shell_energies(const pel_sim *sim, int32_t body, double *membrane, double *bending, double *fibre)
{
    if (!pel_sim_has_body(sim, body) || membrane == NULL || bending == NULL || fibre == NULL)
        return;
    pel_shell_forces_follow(sim->shells, sim->state->position);
    pel_shell_vertex_energies(sim->shells, body, pel_output_count(sim, body), pel_output_numbers(sim, body),
                              sim->state->position, pel_sim_time(sim), membrane, bending, fibre);
    const double *unknowns;
    pel_tangent *tangent = pel_sim_settle_edges(sim, &unknowns);
    if (tangent != NULL)
        pel_mechanics_share_midedge(tangent, unknowns, sim->pool, body, pel_output_numbers(sim, body), bending);
}

void pel_sim_get_mechanics(pel_sim *sim, int32_t body, pel_triangle_mechanics *triangles)
{
    if (!pel_sim_has_body(sim, body) || triangles == NULL)
        return;
    const pel_record *positions = sim->state->position;
    const double *unknowns;
    pel_shell_forces_follow(sim->shells, positions);
    pel_mechanics_fill(sim->shells, body, pel_sim_triangle_count(sim, body), positions, pel_sim_time(sim), triangles);
    pel_tangent *tangent = pel_sim_settle_edges(sim, &unknowns);
    if (tangent != NULL)
        pel_mechanics_add_midedge(tangent, unknowns, sim->pool, body, triangles);
    pel_mechanics_finish(sim->shells, body, positions, triangles);
}

double pel_sim_bending_error(const pel_sim *sim, int32_t body)
{
    const double *unknowns;
    pel_tangent *tangent = pel_sim_settle_edges(sim, &unknowns);
    return tangent != NULL ? pel_mechanics_midedge_error(tangent, unknowns, sim->pool, body) : 0;
}

void pel_sim_get_pressure_forces(pel_sim *sim, int32_t body, double *forces)
{
    if (!pel_sim_has_body(sim, body) || forces == NULL)
        return;
    int32_t count = pel_output_count(sim, body);
    sim->present.has_force = false;
    memset(sim->force, 0, (size_t)sim->model->vertex_count * sizeof *sim->force);
    pel_shell_forces_add(sim->shells, sim->state->position, pel_instant(pel_sim_time(sim)), PEL_SHELL_PRESSURE,
                         sim->pool, sim->force);
    for (int32_t r = 0; r < count; r++)
        for (int c = 0; c < 3; c++)
            forces[3 * (size_t)r + (size_t)c] = (double)sim->force[pel_output_model_index(sim, body, r)][c];
}

void pel_shells_follow(pel_sim *sim, int32_t body)
{
    PEL_ASSERT_INDEX(body, sim->model->body_count);
    sim->state->older_is_known = false;
    pel_batches_rebuild(sim->batches, body);
    pel_shell_forces_rebuild(sim->shells, body);
    if (sim->stepper->follow_surface != NULL)
        sim->stepper->follow_surface(sim);
}
