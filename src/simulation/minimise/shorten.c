/* Newton's method may reach the bound of a step's work before the forces balance. The state that it has reached lies
   downhill of where it began, but there gaps were open and tools had gone all of their way at once, so that it may have
   more energy than the start of the step; contacts that were found last are left to the guard, which steps single
   vertices back and strains what lies between. So the way to it is gone as far as the sum of all energies does not
   grow and nothing meets. In the limit everything that touches stands still: the jam then has no more energy than it
   began with, and the next step begins at rest, with tools that have less of a way before them. */
#include "minimise/shorten.h"

#include "math/extremes.h"
#include "minimise/rounds.h"
#include "minimise/step_newton.h"
#include "stage/accessors.h"
#include "tool/grip.h"
#include "tool/tools.h"
#include "touch/contact.h"

#include <math.h>

/* shares that are tried, each half of the one before; the last one is 0 */
enum { TRIES = 6 };
/* of the way up to an impact */
#define SAFE_SHARE 0.9
/* of its stride, that a tool tries next at least */
#define LEAST_CUT 0.1
/* of the energies, that may be rounding */
#define ROUNDING 1e-12

static bool is_body_shortened(const pel_sim *sim, int32_t body)
{
    return sim->minimise->newton->collided[pel_sim_newton_group(sim, body)];
}

static bool is_shortened(const pel_sim *sim, int32_t v)
{
    return sim->model->mesh_vertex[v] >= 0 && is_body_shortened(sim, sim->model->body_of_slice[v / PEL_WIDTH]);
}

/* J, of what is shortened */
static double kinetic_energy(const pel_sim *sim, const pel_record *velocity)
{
    double sum = 0;
    for (int32_t v = 0; v < sim->model->vertex_count; v++)
        for (int k = 0; k < 3 && is_shortened(sim, v); k++)
            sum += 0.5 * (double)sim->model->mass[v] * (double)velocity[v][k] * (double)velocity[v][k];
    return sum;
}

/* positions after a share of the way; velocities of that */
static void go(pel_sim *sim, double share)
{
    pel_state *state = sim->state;
    for (int32_t v = 0; v < sim->model->vertex_count; v++)
        for (int k = 0; k < 3 && is_shortened(sim, v); k++) {
            double x = (double)state->position[v][k], way = share * (sim->minimise->newton->unknowns[3 * v + k] - x);
            bool moves = state->position[v][3] > 0 || (sim->held != NULL && sim->held[v]);
            state->position_next[v][k] = (pel_real)(x + way);
            state->velocity_next[v][k] = moves ? (pel_real)(way / sim->step.dt) : 0;
        }
    pel_rigid_parts_go(sim, &sim->minimise->newton->rigid, share, is_body_shortened);
    for (int32_t v = 0; v < sim->model->vertex_count; v++)
        if (is_shortened(sim, v))
            pel_vertex_position(state->position_next, v, sim->minimise->position + 3 * (size_t)v);
}

static void move_tools(pel_sim *sim, double share)
{
    for (int32_t i = 0; i < sim->tools->count; i++) {
        pel_tool *tool = &sim->tools->items[i];
        pel_pose_between(&tool->pose_before, &tool->pose_wanted, share, &tool->pose);
    }
    pel_tools_carry(sim);
    for (int32_t v = 0; sim->held != NULL && v < sim->model->vertex_count; v++)
        if (sim->held[v])
            pel_vertex_position(sim->state->position_next, v, sim->minimise->position + 3 * (size_t)v);
}

/* the share of the way on which nothing meets */
static pel_status find_free_share(pel_sim *sim, double *share, pel_error *error)
{
    *share = 1;
    if (sim->contacts == NULL)
        return PEL_OK;
    pel_status status = pel_contacts_find_on_way(sim, error);
    for (size_t c = 0; status == PEL_OK && c < sim->contacts->conflict_count; c++)
        *share = pel_min(*share, SAFE_SHARE * sim->contacts->conflicts[c].time);
    sim->contacts->list.count = 0;
    *share = pel_max(*share, 0);
    return status;
}

static void shorten_strides(pel_sim *sim, double share)
{
    for (int32_t i = 0; i < sim->tools->count && share < 1; i++) {
        pel_tool *tool = &sim->tools->items[i];
        if (pel_tool_way(tool, &tool->pose_before, &tool->pose_wanted) > 0) {
            tool->stride = pel_max(tool->stride * pel_max(share, LEAST_CUT), PEL_LEAST_STRIDE);
            tool->blocked = true;
        }
    }
}

pel_status pel_minimise_shorten(pel_sim *sim, pel_error *error)
{
    double share;
    go(sim, 0);
    double before = pel_minimise_energy(sim) + kinetic_energy(sim, sim->state->velocity);
    go(sim, 1);
    move_tools(sim, 1);
    pel_status status = find_free_share(sim, &share, error);
    for (int n = 0; status == PEL_OK && n < TRIES && share > 0; n++) {
        go(sim, share);
        move_tools(sim, share);
        if (pel_minimise_energy(sim) + kinetic_energy(sim, sim->state->velocity_next) <=
            before + ROUNDING * fabs(before))
            break;
        share = n + 2 < TRIES ? 0.5 * share : 0;
    }
    go(sim, share);
    move_tools(sim, share);
    shorten_strides(sim, share);
    return status;
}
