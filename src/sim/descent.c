/* The method `descent`: each step minimises the energy of springs, shells, pressure and loads at the step's end, from
   where the bodies are. A pressure that has no potential (vertex-normal form, a part of the surface, open meshes) acts
   as it is at the begin of the step: the steps together find the balance. */
#include "base/memory.h"
#include "base/status.h"
#include "math/vec3.h"
#include "sim/sim.h"
#include "solve/shell_stability.h"

#include <math.h>
#include <string.h>

enum { DEFAULT_ITERATIONS = 50 };

/* forces are balanced when what is left of them is this share of the loads, or of what it takes to move every vertex by
   an edge */
#ifdef PEL_SINGLE
#define LOAD_SHARE 1e-3
#define STIFFNESS_SHARE 1e-6
#else
#define LOAD_SHARE 1e-6
#define STIFFNESS_SHARE 1e-11
#endif
/* of the mean edge that a vertex goes in one iteration at most */
#define MOVE_SHARE 0.3

struct pel_sim_descent {
    pel_descent *minimiser;
    pel_record *external; /* (vertex_count) forces that stay during a step */
    double mean_edge;     /* m */
    double stiff_force;   /* N */
    pel_descent_result result;
};

/* what the energy is evaluated with */
typedef struct step_context {
    pel_sim *sim;
    pel_state state; /* a copy that looks at other positions */
    double time;
} step_context;

static double spring_energy(const step_context *at)
{
    double sum = 0;
    const pel_model *model = at->sim->model;
    for (int32_t b = 0; b < model->body_count; b++) {
        const pel_body *body = &model->bodies[b];
        bool has_springs = body->uniform_spring != 0 || body->has_volumetric;
        for (int32_t slice = body->slice_begin; has_springs && slice < body->slice_end; slice++) {
            pel_wide spring, volumetric;
            pel_slice_energy(model, &at->state, slice, &spring, &volumetric);
            for (int lane = 0; lane < PEL_WIDTH; lane++)
                if (model->mesh_vertex[slice * PEL_WIDTH + lane] >= 0)
                    sum += (double)spring[lane] + (double)volumetric[lane];
        }
    }
    return sum;
}

static double energy_of(void *context, pel_record *position, pel_record *force)
{
    step_context *at = context;
    const pel_sim *sim = at->sim;
    const pel_model *model = sim->model;
    const pel_record *external = sim->descent->external;
    at->state.position = position;
    pel_body_forces(model, &at->state, NULL, sim->pool, force);
    pel_shell_energy shells = pel_shell_forces_add(sim->shells, position, at->time,
                                                   PEL_SHELL_ELASTIC | PEL_SHELL_CONSERVATIVE, sim->pool, force);
    double energy = spring_energy(at) + shells.membrane + shells.bending + shells.fibres + shells.pressure;
    for (int32_t v = 0; v < model->vertex_count; v++) {
        for (int c = 0; c < 3; c++)
            energy -= (double)external[v][c] * ((double)position[v][c] - (double)model->rest[v][c]);
        force[v] += external[v];
    }
    return energy;
}

/* the forces that stay; returns the root of the sum of squares of all that is not elastic */
static double find_external(pel_sim *sim, double time)
{
    pel_record *external = sim->descent->external, *force = sim->force;
    int32_t count = sim->model->vertex_count;
    double square = 0;
    memset(external, 0, (size_t)count * sizeof *external);
    pel_loads_add(sim, time, external);
    pel_shell_forces_add(sim->shells, sim->state->position, time, PEL_SHELL_FOLLOWER, sim->pool, external);
    memcpy(force, external, (size_t)count * sizeof *force);
    pel_shell_forces_add(sim->shells, sim->state->position, time, PEL_SHELL_CONSERVATIVE, sim->pool, force);
    for (int32_t v = 0; v < count; v++)
        for (int c = 0; c < 3; c++)
            square += sim->model->inverse_mass[v] > 0 ? (double)force[v][c] * (double)force[v][c] : 0;
    return sqrt(square);
}

void pel_sim_descent_step(pel_sim *sim, pel_step_result *step)
{
    pel_sim_descent *descent = sim->descent;
    pel_state *state = sim->state;
    size_t count = (size_t)sim->model->vertex_count;
    step_context context = {sim, *state, (double)(state->step + 1) * sim->step.dt};
    pel_shell_forces_follow(sim->shells, state->position);
    double loads = find_external(sim, context.time);
    const pel_descent_problem problem = {
        .inverse_mass = sim->model->inverse_mass,
        .energy = energy_of,
        .context = &context,
        .longest_move = MOVE_SHARE * descent->mean_edge,
        .tolerance = LOAD_SHARE * loads + STIFFNESS_SHARE * descent->stiff_force,
        .iterations = sim->solver.iterations > 0 ? sim->solver.iterations : DEFAULT_ITERATIONS,
        .gradient_only = sim->solver.gradient_only,
    };
    memcpy(state->position_next, state->position, count * sizeof *state->position);
    pel_descent_run(descent->minimiser, &problem, state->position_next, &descent->result);
    *step = (pel_step_result){.diverged = !pel_sim_all_inside(sim)};
}

/* ---- creation ---- */

/* of the body with the shortest edges */
static double find_mean_edge(const pel_model *model)
{
    double least = HUGE_VAL;
    for (int32_t b = 0; b < model->body_count; b++) {
        const pel_mesh *mesh = model->bodies[b].mesh;
        double sum = 0;
        for (int32_t t = 0; t < mesh->triangle_count; t++)
            for (int i = 0; i < 3; i++)
                sum += pel_vec3_distance(mesh->positions[mesh->triangles[t][i]],
                                         mesh->positions[mesh->triangles[t][(i + 1) % 3]]);
        least = fmin(least, sum / (3.0 * mesh->triangle_count));
    }
    return least;
}

/* what it takes to move every vertex by an edge, by the bound of the stiffness */
static double find_stiff_force(const pel_sim *sim, double edge)
{
    pel_stability stability;
    double square = 0;
    pel_stability_bound(sim->model, &stability);
    pel_shell_stability_bound(sim->shells, &stability);
    for (int32_t v = 0; v < sim->model->vertex_count; v++)
        square += (double)sim->model->mass[v] * (double)sim->model->mass[v];
    return stability.stiffness_bound * edge * sqrt(square);
}

pel_status pel_sim_descent_create(pel_sim *sim, pel_error *error)
{
    pel_sim_descent *descent = sim->descent = pel_allocate(1, sizeof *descent);
    if (descent == NULL)
        return pel_fail_memory(error);
    descent->external = pel_allocate_aligned((size_t)sim->model->vertex_count, sizeof *descent->external);
    if (descent->external == NULL)
        return pel_fail_memory(error);
    descent->mean_edge = find_mean_edge(sim->model);
    descent->stiff_force = find_stiff_force(sim, descent->mean_edge);
    return pel_descent_create(sim->model->vertex_count, &descent->minimiser, error);
}

void pel_sim_descent_destroy(pel_sim *sim)
{
    if (sim->descent == NULL)
        return;
    pel_descent_destroy(sim->descent->minimiser);
    pel_free(sim->descent->external);
    pel_free(sim->descent);
}

void pel_sim_get_solver(const pel_sim *sim, pel_solver_reading *reading)
{
    *reading = (pel_solver_reading){0};
    if (sim->descent == NULL)
        return;
    const pel_descent_result *result = &sim->descent->result;
    *reading = (pel_solver_reading){result->iterations, result->evaluations, result->energy, result->residual,
                                    result->converged};
}
