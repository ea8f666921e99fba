/* The step of position-based methods: loads and pressure at the start of each substep, then solve/project.h. */
#include "solve/project.h"

#include "attach/joint.h"
#include "base/assert.h"
#include "base/status.h"
#include "boundary/loads.h"
#include "boundary/wind.h"
#include "method/meet.h"
#include "method/softness.h"
#include "stage/accessors.h"
#include "stage/growth.h"
#include "stage/plastic.h"
#include "stage/rigids.h"
#include "stage/viscous.h"
#include "tool/reading.h"
#include "tool/solid.h"
#include "tool/tools.h"
#include "touch/contact.h"
#include "touch/sleep.h"

#include <string.h>

static pel_status create(pel_sim *sim, pel_error *error)
{
    pel_solver_def *solver = &sim->solver;
    sim->contact_in_loop = true;
    pel_status status = pel_substeps_create(sim, error);
    if (status == PEL_OK && solver->second_order)
        status = pel_state_add_history(sim->model, sim->state, error);
    if (status == PEL_OK)
        status = pel_projector_create(sim->batches, solver, &sim->projector, error);
    if (status == PEL_OK)
        status = pel_viscous_create(sim, error);
    if (status == PEL_OK)
        sim->projector->pool = sim->pool;
    return status;
}

/* adds loads and pressure over a span to sim->force, which is 0: a substep clears it after use */
static void find_forces(pel_sim *sim, pel_span span, const pel_record *positions, bool is_first)
{
    const pel_state *state = sim->state;
    const pel_record *before = is_first || sim->solver.second_order ? NULL : pel_project_substep_start(sim->projector);
    pel_loads_add(sim, span, positions, sim->force);
    pel_wind_add(sim, sim->force);
    /* positions are those of the start, and so is the volume that is asked for */
    const pel_span start = {.time = span.time - span.back, .ahead = span.back, .extrapolates = span.extrapolates};
    pel_loads_press(sim, positions, before, is_first ? state->velocity : state->velocity_next, start);
}

/* what may touch, or is rigid, starts in first order */
static bool starts_plainly(const pel_sim *sim, int32_t number)
{
    bool may_touch = pel_sim_has_loop_contacts(sim) || sim->tools->solids != NULL || sim->rigids != NULL;
    return number == 0 && !sim->state->older_is_known && may_touch;
}

static pel_substep_place place_of(const pel_sim *sim, int32_t number)
{
    return (pel_substep_place)((number == 0 ? PEL_SUBSTEP_FIRST : 0) |
                               (number == sim->solver.substeps - 1 ? PEL_SUBSTEP_LAST : 0));
}

/* Bodies that are pressed, or were since the step before began, and those beside them: what trembles against something
   would else take elastic forces at 4/9 whenever it meets it. */
static void find_pressed(const pel_sim *sim, int32_t number)
{
    const pel_projector *projector = sim->projector;
    if (!sim->solver.second_order)
        return;
    memset(projector->is_pressed, starts_plainly(sim, number), (size_t)sim->model->body_count);
    for (int32_t b = 0; b < sim->model->body_count; b++) {
        const bool is_stiff = sim->substeps->keeps_stiff_plain && pel_has_stiff_pressure(&sim->model->bodies[b]);
        projector->is_pressed[b] |= projector->touched[b] | sim->state->touched[b] | (uint8_t)is_stiff;
    }
    pel_meet_mark_pressed(sim, projector->is_pressed);
    pel_meet_spread(sim, projector->is_pressed);
}

static void run_substep(pel_sim *sim, int32_t number)
{
    pel_state *state = sim->state;
    pel_projector *projector = sim->projector;
    int32_t count = sim->solver.substeps;
    pel_substep_place place = place_of(sim, number);
    find_pressed(sim, number);
    pel_project_choose_orders(projector, state, place);
    /* second order: forces belong to the end of a substep */
    double h = projector->substep, end = pel_sim_time(sim) + (number + 1) * h;
    const pel_span span = {.time = end, .back = h, .extrapolates = projector->has_past};
    if (number > 0) {
        pel_tools_follow_grasps(sim, end - 0.5 * h);
        pel_sleep_follow_held(sim);
    }
    pel_tools_place(sim, (double)(number + 1) / count);
    projector->is_asleep = sim->asleep;
    pel_growth_follow(sim, (double)(number + 1) / count);
    const pel_record *positions = number == 0 ? state->position : state->position_next;
    find_forces(sim, span, positions, number == 0);
    pel_rigids_kick(sim, positions, h, projector->air);
    pel_project_predict(projector, state, sim->force, &sim->tools->boundary, place);
    pel_rigids_drift(sim, h);
    const pel_meeting meeting = {
        .end = end, .length = h, .tau = projector->tau, .start = pel_project_substep_start(projector)};
    pel_meet_begin(sim, &meeting);
    for (int32_t i = 0; i < sim->solver.iterations && !pel_pool_is_stopped_now(sim->pool); i++) {
        pel_project_sweep(projector, state->position_next);
        pel_meet_sweep(sim, &meeting);
    }
    pel_meet_tally(sim, &meeting, projector->reaction);
    pel_contact_list *lists[2];
    pel_meet_lists(sim, lists);
    pel_project_finish(projector, state, (const pel_contact_list *const *)lists, 2, &sim->tools->boundary, place);
    pel_rigids_finish(sim, h, projector->reaction, place & PEL_SUBSTEP_LAST || sim->solver.second_order);
    pel_plastic_follow(sim, state->position_next);
    pel_loads_tally(sim, span, meeting.start);
    pel_wind_tally(sim, meeting.start, h);
}

static pel_status run_substeps(pel_sim *sim, pel_error *error)
{
    pel_status status = PEL_OK;
    memset(sim->force, 0, (size_t)sim->model->vertex_count * sizeof *sim->force);
    pel_tools_place(sim, 0);
    pel_loads_begin_tally(sim, sim->projector->substep);
    sim->loads->is_plain = sim->projector->is_pressed;
    pel_meet_recall(sim, sim->projector->substep);
    for (int32_t s = 0; status == PEL_OK && s < sim->solver.substeps; s++) {
        if (s > 0 && pel_sim_has_loop_contacts(sim))
            status = pel_contacts_follow(sim, sim->state->position_next, pel_project_substep_start(sim->projector),
                                         (double)s / sim->solver.substeps, error);
        if (status == PEL_OK)
            run_substep(sim, s);
        if (status == PEL_OK)
            status = pel_pool_check(sim->pool, error);
    }
    /* pairs that were not found are in no order */
    if (status == PEL_OK)
        pel_meet_end(sim);
    return status;
}

/* nothing can move: a substep as long as the step, without sweeps */
static void rest(pel_sim *sim)
{
    pel_substep_place place = (pel_substep_place)(PEL_SUBSTEP_FIRST | PEL_SUBSTEP_LAST);
    memset(sim->projector->is_pressed, 0, (size_t)sim->model->body_count);
    pel_project_choose_orders(sim->projector, sim->state, place);
    pel_tools_place(sim, 1);
    pel_loads_begin_tally(sim, sim->projector->substep);
    sim->projector->is_asleep = sim->asleep;
    pel_project_predict(sim->projector, sim->state, sim->force, &sim->tools->boundary, place);
    pel_project_finish(sim->projector, sim->state, NULL, 0, &sim->tools->boundary, place);
    pel_rigids_finish(sim, sim->projector->substep, NULL, true);
    pel_contacts_tally_asleep(sim);
}

static pel_status step(pel_sim *sim, pel_step_result *result, pel_error *error)
{
    pel_tools_begin(sim, pel_sim_next_time(sim));
    pel_wind_begin(sim);
    sim->projector->air = pel_wind_forces(sim);
    pel_projector_begin(sim->projector, sim->state, pel_sim_time(sim));
    pel_rigids_begin(sim);
    pel_joints_begin(sim);
    pel_sleep_begin_step(sim);
    bool rests = pel_sleep_is_everywhere(sim);
    pel_status status = pel_meet_find(sim, pel_sim_has_loop_contacts(sim) && !rests, error);
    if (status == PEL_OK && rests)
        rest(sim);
    else if (status == PEL_OK) {
        status = run_substeps(sim, error);
        result->diverged = !pel_sim_all_inside(sim);
    }
    sim->viscous_loss = status == PEL_OK && !rests ? pel_viscous_find_loss(sim) : 0;
    return status;
}

static void follow_held(pel_sim *sim)
{
    pel_projector_hold(sim->projector, sim->tools->boundary.is_held);
}

/* the length of a substep stays */
static void set_time(pel_sim *sim, double before)
{
    (void)before;
    int32_t count = PEL_PART_LIMIT / sim->part.step_size;
    sim->solver.substeps = (sim->part.substeps + count - 1) / count;
    pel_projector_set_time(sim->projector, sim->state, sim->step.dt, sim->solver.substeps);
}

static void restart(pel_sim *sim, int32_t body)
{
    pel_projector_restart(sim->projector, sim->state, body);
}

static void accept(pel_sim *sim)
{
    pel_projector_accept(sim->projector, sim->state);
    pel_sleep_end_step(sim);
}

/* ---- held vertices ---- */

static pel_status record_held(pel_sim *sim, pel_error *error)
{
    return pel_projector_record_reactions(sim->projector, error);
}

static void set_substeps(pel_sim *sim, int32_t count, bool is_loaded)
{
    pel_projector_set_substeps(sim->projector, is_loaded ? NULL : sim->state, count);
}

/* the mean of the substeps and the contacts */
static void get_held_force(const pel_sim *sim, int32_t v, double force[3])
{
    PEL_ASSERT_INDEX(v, sim->model->vertex_count);
    double contact[3];
    pel_vertex_position(sim->projector->reaction, v, force);
    pel_vec3_scale(force, 1.0 / sim->solver.substeps, force);
    pel_contact_force_at(&sim->contact_forces.vertex_next, v, contact);
    if (pel_rigid_of(sim->rigids, v) == NULL)
        pel_vec3_add(force, contact, force);
}

/* adds drag and damping of a held vertex, by its mean velocity in the step */
static void add_damping(const pel_sim *sim, int32_t v, const double *factors, double force[3])
{
    PEL_ASSERT_INDEX(v, sim->model->vertex_count);
    const pel_model *model = sim->model;
    const pel_record next = sim->state->position_next[v], before = sim->state->position[v];
    double drag = factors[PEL_SPRING_DAMPING] * (double)model->damping[v] + sim->solver.drag * (double)model->mass[v];
    double radial = factors[PEL_VOLUMETRIC_DAMPING] * (double)model->volumetric_damping[v], velocity[3], offset[3];
    for (int k = 0; k < 3; k++) {
        velocity[k] = (double)(next[k] - before[k]) / sim->step.dt;
        offset[k] = (double)(next[k] - model->rest[v][k]);
    }
    double square = pel_vec3_squared_length(offset);
    double along = square > 0 ? radial * pel_vec3_dot(velocity, offset) / square : 0;
    pel_vec3_along(force, -drag, velocity, force);
    pel_vec3_along(force, -along, offset, force);
}

/* recorded multipliers on held vertices, volumetric springs, damping and inertia */
static void read_grip(pel_sim *sim, pel_tool *tool)
{
    const pel_model *model = sim->model;
    const pel_state *state = sim->state;
    for (int32_t i = 0; i < tool->held_count; i++) {
        int32_t v = tool->held[i];
        const double *factors = state->factors[model->body_of_slice[v / PEL_WIDTH]];
        double spring = factors[PEL_VOLUMETRIC_STIFFNESS] * (double)model->rest[v][3], force[3], x[3], point[3];
        for (int k = 0; k < 3; k++) {
            x[k] = (double)state->position_next[v][k];
            force[k] =
                (double)sim->projector->reaction[v][k] / sim->solver.substeps -
                spring * (x[k] - (double)model->rest[v][k]) -
                (double)model->mass[v] * (double)(state->velocity_next[v][k] - state->velocity[v][k]) / sim->step.dt;
        }
        add_damping(sim, v, factors, force);
        pel_tool_mean_point(sim, tool, v, point);
        pel_tool_add_grip(sim, tool, v, point, force);
        pel_tool_touch(tool, v);
    }
}

static void read_grips(pel_sim *sim)
{
    for (int32_t i = 0; i < sim->tools->count; i++)
        read_grip(sim, &sim->tools->items[i]);
}

static void advise(const pel_sim *sim, pel_error *error)
{
    if (pel_sim_softness(sim) > 1)
        pel_substeps_remedy(sim, error);
    else
        pel_fail_remedy(error, "make solver dt (%g) smaller, or use more substeps, or smaller loads", sim->step.dt);
}

static void follow_surface(pel_sim *sim)
{
    pel_substeps_follow_surface(sim);
    pel_viscous_follow_surface(sim);
    follow_held(sim);
}

#define PROJECTS                                                                                                       \
    .has_velocity = true, .has_substeps = true, .moves_rigid = true, .moves_tools = true, .create = create,            \
    .step = step, .follow_surface = follow_surface, .restart = restart, .set_time = set_time, .accept = accept,        \
    .advise = advise, .get_held_force = get_held_force, .record_held = record_held, .follow_held = follow_held,        \
    .read_grips = read_grips, .set_substeps = set_substeps, .get_solver = pel_substeps_read

#define NO_MATERIAL .energy_remedy = "use the method xpbd: pbd does not follow the material"

const pel_stepper pel_step_pbd_kind = {PROJECTS, NO_MATERIAL, .weighs = true, .limits_strain = true};
const pel_stepper pel_step_pbd_distance_kind = {PROJECTS, NO_MATERIAL, .has_lengths = true};
const pel_stepper pel_step_xpbd_kind = {PROJECTS, .is_compliant = true, .damps = true, .limits_strain = true,
                                        .energy_remedy = "use more solver.substeps"};
