#include "minimise/step_modes.h"

#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "boundary/fluid.h"
#include "boundary/follower.h"
#include "boundary/hold.h"
#include "boundary/loads.h"
#include "math/extremes.h"
#include "minimise/rounds.h"
#include "minimise/step_newton.h"
#include "stage/accessors.h"
#include "tool/tool.h"

#include <math.h>
#include <string.h>

#define PI 3.141592653589793

/* of the largest body, that strains of modes are measured with */
#define SMALL_SHARE 1e-5
/* of the largest body, that modes are drawn with */
#define DRAWN_SHARE 0.05
enum { MOST_MODES = 1000 };

pel_status pel_sim_modes_create(pel_sim *sim, pel_error *error)
{
    int32_t count = sim->solver.mode_count;
    if (count < 1 || count > MOST_MODES) {
        pel_fail(error, PEL_BAD_ARGUMENT, "an analysis of %d modes", (int)count);
        pel_fail_remedy(error, "ask for 1 to %d modes", (int)MOST_MODES);
        return PEL_BAD_ARGUMENT;
    }
    pel_sim_modes *made = sim->modes = pel_allocate(1, sizeof *made);
    if (made == NULL)
        return pel_fail_memory(error);
    if (!PEL_ALLOCATE_ALL(PEL_ROOM_ALIGNED(made->base, sim->model->vertex_count), PEL_ROOM(made->values, count),
                          PEL_ROOM_ALIGNED(made->present, sim->model->vertex_count)))
        return pel_fail_memory(error);
    return pel_modes_create(sim->newton, sim->solver.analysis, count, &made->modes, error);
}

pel_status pel_sim_modes_check(const pel_sim *sim, pel_error *error)
{
    if (sim->active != NULL)
        return pel_refuse(error, PEL_BAD_ARGUMENT, "leave refine out, and subdivide the mesh (pellicle subdivide)",
                          "an analysis does not support bodies that refine");
    if (sim->solver.analysis == PEL_ANALYSIS_BUCKLING && !pel_loads_act(sim))
        return pel_modes_fail_unloaded(error);
    if (sim->solver.analysis == PEL_ANALYSIS_BUCKLING && sim->loads->fluid_count > 0)
        return pel_fluids_refuse(sim, "buckling", error);
    if (sim->tools->count == 0 && sim->contacts == NULL)
        return pel_followers_refuse(sim, "modes and buckling need", error);
    pel_fail(error, PEL_BAD_ARGUMENT, "an analysis does not support %s", sim->tools->count > 0 ? "tools" : "contact");
    pel_fail_remedy(error, "remove the %s or the analysis", sim->tools->count > 0 ? "tools" : "contact");
    return PEL_BAD_ARGUMENT;
}

void pel_sim_modes_destroy(pel_sim *sim)
{
    if (sim->modes == NULL)
        return;
    pel_modes_destroy(sim->modes->modes);
    PEL_FREE_ALL(sim->modes->base, sim->modes->present, sim->modes->values, sim->modes);
}

/* bodies that start in another shape than that at rest: what holds them there stretches them */
static void place_starts(const pel_sim *sim, pel_record *positions)
{
    for (int32_t b = 0; b < sim->model->body_count; b++) {
        const pel_body *body = &sim->model->bodies[b];
        for (int32_t v = 0; body->start != NULL && v < body->mesh->vertex_count; v++)
            for (int k = 0; k < 3; k++)
                positions[body->model_index[v]][k] = (pel_real)body->start[v][k];
    }
}

/* About the state at rest, or that under the loads of the first step: which step asks first makes no difference. */
static pel_status find_base(pel_sim *sim, pel_step_result *result, pel_error *error)
{
    pel_state *state = sim->state;
    size_t bytes = (size_t)sim->model->vertex_count * sizeof *state->position;
    memcpy(sim->modes->present, state->position, bytes);
    memcpy(state->position, sim->model->rest, bytes);
    bool buckles = sim->solver.analysis == PEL_ANALYSIS_BUCKLING;
    if (!buckles)
        place_starts(sim, state->position);
    memcpy(state->position_next, state->position, bytes);
    int64_t step = state->step;
    state->step = 0;
    pel_sim_update_factors(sim, sim->step.dt);
    pel_sim_newton_begin(sim);
    if (buckles)
        sim->minimise->result = (pel_descent_result){.converged = true};
    pel_status status = buckles ? PEL_OK : pel_minimise_step(sim, result, error);
    memcpy(sim->modes->base, state->position_next, bytes);
    state->step = step;
    if (status != PEL_OK || result->diverged || sim->minimise->result.converged)
        return status;
    return pel_refuse(error, PEL_BAD_ARGUMENT, "make the loads smaller",
                      "no equilibrium under the loads was found, so there are no modes");
}

static void add_springs(void *context, pel_matrix *matrix)
{
    pel_holds_add_matrix(context, matrix);
}

static pel_status solve_about_base(pel_sim *sim, pel_error *error)
{
    pel_sim_newton *newton = sim->minimise->newton;
    pel_newton_problem problem = {.span = pel_instant(sim->step.dt), .state = sim->state, .force = newton->loads};
    problem.fixed = newton->fixed;
    problem.frames = pel_sim_newton_gather(sim, problem.span, sim->solver.analysis == PEL_ANALYSIS_BUCKLING);
    const pel_newton_terms springs = {.context = sim, .add_matrix = add_springs};
    problem.terms = &springs;
    return pel_modes_solve(sim->modes->modes, &problem, newton->unknowns, error);
}

static pel_status solve(pel_sim *sim, pel_step_result *result, pel_error *error)
{
    pel_sim_modes *own = sim->modes;
    pel_status status = find_base(sim, result, error);
    if (status == PEL_OK && !result->diverged)
        status = solve_about_base(sim, error);
    memcpy(sim->state->position, own->present, (size_t)sim->model->vertex_count * sizeof *own->present);
    pel_sim_update_factors(sim, pel_sim_next_time(sim));
    own->is_solved = status == PEL_OK && !result->diverged;
    own->count = own->is_solved ? sim->solver.mode_count : 0;
    for (int32_t m = 0; m < own->count; m++)
        own->values[m] = pel_modes_value(own->modes, m);
    return status;
}

pel_status pel_sim_modes_step(pel_sim *sim, pel_step_result *result, pel_error *error)
{
    pel_sim_modes *own = sim->modes;
    /* none are known to a snapshot from before the first step */
    bool is_known = own->is_solved && own->count > 0;
    pel_status status = is_known ? PEL_OK : solve(sim, result, error);
    if (status != PEL_OK || result->diverged)
        return status;
    int32_t number = (int32_t)(sim->state->step % own->count);
    const double *mode = pel_modes_vector(own->modes, number);
    for (int32_t v = 0; v < sim->model->vertex_count; v++)
        for (int k = 0; k < 3; k++)
            sim->state->position_next[v][k] =
                (pel_real)((double)own->base[v][k] + DRAWN_SHARE * sim->minimise->size * mode[3 * v + k]);
    return PEL_OK;
}

/* positions of the base and `scale` times a mode, with edges as they bend least */
static void place_at(pel_sim *sim, int32_t mode, double scale)
{
    const double *vector = pel_modes_vector(sim->modes->modes, mode);
    for (int32_t v = 0; v < sim->model->vertex_count; v++)
        for (int k = 0; k < 3; k++)
            sim->minimise->newton->unknowns[3 * v + k] = (double)sim->modes->base[v][k] + scale * vector[3 * v + k];
    pel_sim_newton_settle_at(sim);
}

double pel_sim_mode_retardation(pel_sim *sim, int32_t mode)
{
    PEL_ASSERT_INDEX(mode, sim->modes->count);
    pel_tangent *tangent = pel_newton_tangent(sim->newton);
    size_t count = (size_t)pel_newton_pattern(sim->newton)->stress_limit * PEL_VISCOUS_NUMBERS;
    double *numbers = pel_allocate(count, sizeof *numbers), largest = 0, kinetic = 0;
    const double *vector = pel_modes_vector(sim->modes->modes, mode);
    if (numbers == NULL)
        return -1;
    for (int32_t i = 0; i < 3 * sim->model->vertex_count; i++) {
        largest = pel_max(largest, fabs(vector[i]));
        kinetic += (double)sim->model->mass[i / 3] * vector[i] * vector[i];
    }
    double scale = SMALL_SHARE * sim->minimise->size / largest, rate = 2 * PI * sim->modes->values[mode] * scale;
    pel_tangent_input input = {
        .unknowns = sim->minimise->newton->unknowns, .span = pel_instant(sim->step.dt), .state = sim->state};
    place_at(sim, mode, 0);
    pel_tangent_refer_rates(tangent, &input, 1, false, sim->pool, numbers);
    input.viscous = numbers;
    input.rate = 1;
    place_at(sim, mode, scale);
    double loss = pel_tangent_viscous_loss(tangent, &input, sim->pool);
    pel_free(numbers);
    return loss / (rate * rate * kinetic);
}

pel_analysis pel_sim_analysis(const pel_sim *sim)
{
    if (sim == NULL)
        return PEL_ANALYSIS_NONE;
    return sim->solver.analysis;
}

int32_t pel_sim_get_modes(const pel_sim *sim, double *values)
{
    if (sim == NULL)
        return 0;
    if (sim->modes == NULL)
        return 0;
    if (values != NULL)
        memcpy(values, sim->modes->values, (size_t)sim->modes->count * sizeof *values);
    return sim->modes->count;
}

double pel_sim_mode_value(const pel_sim *sim)
{
    if (sim == NULL)
        return 0;
    if (sim->modes == NULL || sim->state->step == 0 || sim->modes->count == 0)
        return 0;
    return sim->modes->values[(sim->state->step - 1) % sim->modes->count];
}

/* ---- snapshots ---- */

void pel_sim_modes_transfer(pel_cursor *at, const pel_sim *sim, int32_t unused)
{
    (void)unused;
    if (sim->modes == NULL)
        return;
    pel_transfer(at, sim->modes->values, (size_t)sim->solver.mode_count * sizeof *sim->modes->values);
    pel_transfer(at, &sim->modes->count, sizeof sim->modes->count);
}
