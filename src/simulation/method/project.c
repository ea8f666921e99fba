/* The step of position-based methods: loads and pressure at the start of each substep, then solve/project.h. */
#include "solve/project.h"
#include "attach/joint.h"
#include "attach/tie.h"
#include "base/assert.h"
#include "base/status.h"
#include "boundary/loads.h"
#include "boundary/wind.h"
#include "contact/backing.h"
#include "contact/sweep.h"
#include "math/extremes.h"
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

/* sweeps over contacts after one over elements, and the corrections at which they may end: of the thickness, and of
   what loads have moved where friction holds much */
enum { SWEEP_LIMIT = 8, RIGID_SWEEP_LIMIT = 60 };
#define SWEEP_TOLERANCE 0.1
#define DEPTH_TOLERANCE 0.01
/* of the thickness, and of what loads have moved; rigid bodies have nothing that takes a tremor out: a stack of ten
   boxes stands still at 2e-4 and trembles with 10 % of its weight at 1e-2 */
#define RIGID_TOLERANCE 2e-4
#define RIGID_SHARE 1e-3
/* of the size of the bodies */
#define JOINT_TOLERANCE 1e-8
/* of the thickness: larger corrections update the contacts between two sweeps */
#define REFRESH_SHARE 0.25

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
static void find_forces(pel_sim *sim, pel_span span, const pel_record *positions)
{
    pel_loads_add(sim, span, positions, sim->force);
    pel_wind_add(sim, sim->force);
    pel_shell_forces_press(sim->shells, positions, span, sim->pool, sim->force);
}

/* contacts of one kind or the other that act in the substeps; null = none */
static pel_contact_list *loop_contacts(const pel_sim *sim)
{
    return pel_sim_has_loop_contacts(sim) ? &sim->contacts->list : NULL;
}

/* m, of the layers in the loop */
static double least_thickness(const pel_sim *sim)
{
    double least = HUGE_VAL;
    if (sim->contacts != NULL)
        least = sim->rigids != NULL ? sim->contacts->least : sim->contacts->def.thickness;
    return sim->tools->solids != NULL ? pel_min(least, pel_solids_thickness(sim)) : least;
}

/* update the contacts at the predicted positions and apply the kept loads */
static void begin_contacts(pel_sim *sim, const pel_record *start)
{
    pel_record *positions = sim->state->position_next;
    pel_contact_list *pairs = loop_contacts(sim);
    double most = DEPTH_TOLERANCE * least_thickness(sim);
    if (pairs != NULL) {
        pel_contacts_begin_substep(sim, sim->projector->tau);
        pel_contacts_refresh(sim, start, true);
        pel_contacts_begin(&sim->contacts->heights.list, sim->projector->tau);
        pel_contacts_load(pairs, positions, most);
    }
    if (sim->tools->solids != NULL) {
        pel_solids_begin_substep(sim, sim->projector->tau);
        pel_solids_refresh(sim, start, true);
        pel_contacts_load(&sim->tools->solids->list, positions, most);
    }
}

/* whether a sweep has hardly changed the gaps, or the loads on which much friction counts */
static bool has_settled(const pel_sim *sim, const pel_contact_list *list, double moved)
{
    double depth = DEPTH_TOLERANCE * least_thickness(sim);
    return !(moved > (list->is_rubbed ? pel_min(SWEEP_TOLERANCE * list->carried, depth) : depth));
}

/* update the contacts between two sweeps */
static void follow_contacts(pel_sim *sim, const pel_record *start)
{
    pel_rigids_place(sim->rigids, sim->state->position_next);
    if (loop_contacts(sim) != NULL)
        pel_contacts_refresh(sim, start, false);
    if (sim->tools->solids != NULL)
        pel_solids_refresh(sim, start, false);
}

/* what tools hold, in both lists, against what presses it */
static void find_supports(pel_sim *sim, pel_contact_list *const lists[2])
{
    pel_contact **supports = lists[0] != NULL && sim->tools->count > 0 ? sim->touch->supports : NULL;
    if (supports != NULL)
        memset(supports, 0, (size_t)sim->model->vertex_count * sizeof *supports);
    for (int k = 0; k < 2 && supports != NULL; k++)
        if (lists[k] != NULL) {
            pel_contacts_find_supports(lists[k], sim->state->position_next, supports);
            lists[k]->supports = supports;
        }
}

/* one sweep over the elements, then over contacts until their loads hardly change */
static void sweep(pel_sim *sim, double end, const pel_record *start)
{
    pel_record *positions = sim->state->position_next;
    pel_contact_list *lists[] = {loop_contacts(sim), sim->tools->solids != NULL ? &sim->tools->solids->list : NULL};
    pel_project_sweep(sim->projector, positions);
    pel_ties_project(sim, end, sim->projector->tau, positions);
    if (lists[0] != NULL)
        pel_contact_heights_refresh(sim->contacts, positions);
    double least = least_thickness(sim), most = REFRESH_SHARE * least, moved = 0;
    bool is_over = false, is_stacked = false;
    for (int i = 0; i < (is_stacked ? RIGID_SWEEP_LIMIT : SWEEP_LIMIT) && !is_over; i++) {
        if (moved > most)
            follow_contacts(sim, start);
        find_supports(sim, lists);
        moved = 0;
        is_stacked = pel_joints_project(sim, sim->projector->substep) > JOINT_TOLERANCE;
        is_over = !is_stacked;
        for (int k = 0; k < 2; k++) {
            if (lists[k] == NULL)
                continue;
            double way = pel_contacts_project(lists[k], positions, start);
            bool is_loose =
                !(lists[k]->rigid_moved > pel_max(RIGID_TOLERANCE * least, RIGID_SHARE * lists[k]->carried));
            is_over &= (has_settled(sim, lists[k], way) || (i >= SWEEP_LIMIT && sim->rigids != NULL)) && is_loose;
            is_stacked |= !is_loose;
            moved = pel_max(moved, way);
        }
        if (lists[0] != NULL)
            pel_contacts_project(&sim->contacts->heights.list, positions, start);
    }
    pel_rigids_place(sim->rigids, positions);
    for (int k = 0; k < 2; k++)
        if (lists[k] != NULL)
            lists[k]->supports = NULL;
}

/* whether contacts carry loads from the substep before */
static bool is_pressed(const pel_sim *sim)
{
    const pel_contact_list *pairs = loop_contacts(sim);
    for (int32_t i = 0; pairs != NULL && i < pel_contact_list_length(pairs); i++)
        if (pel_contact_list_at(pairs, i)->multiplier > 0)
            return true;
    return sim->tools->solids != NULL && pel_solids_carry(sim);
}

/* what may touch, or is rigid, starts in first order */
static bool starts_plainly(const pel_sim *sim, int32_t number)
{
    bool may_touch = loop_contacts(sim) != NULL || sim->tools->solids != NULL || sim->rigids != NULL;
    return number == 0 && !sim->state->older_is_known && may_touch;
}

static pel_substep_place place_of(const pel_sim *sim, int32_t number)
{
    int place = (number == 0 ? PEL_SUBSTEP_FIRST : 0) | (number == sim->solver.substeps - 1 ? PEL_SUBSTEP_LAST : 0);
    if (sim->solver.second_order && (is_pressed(sim) || starts_plainly(sim, number)))
        place |= PEL_SUBSTEP_PRESSED;
    return (pel_substep_place)place;
}

static void run_substep(pel_sim *sim, int32_t number)
{
    pel_state *state = sim->state;
    pel_projector *projector = sim->projector;
    int32_t count = sim->solver.substeps;
    pel_substep_place place = place_of(sim, number);
    pel_contact_list *pairs = loop_contacts(sim);
    /* second order: forces belong to the end of a substep */
    double h = projector->substep, end = pel_sim_time(sim) + (number + 1) * h;
    const pel_span span = {.time = end, .back = h, .extrapolates = pel_project_has_past(projector, state, place)};
    if (number > 0) {
        pel_tools_follow_grasps(sim, end - 0.5 * h);
        pel_sleep_follow_held(sim);
    }
    pel_tools_place(sim, (double)(number + 1) / count);
    projector->is_asleep = sim->asleep;
    pel_growth_follow(sim, (double)(number + 1) / count);
    const pel_record *positions = number == 0 ? state->position : state->position_next;
    find_forces(sim, span, positions);
    pel_rigids_kick(sim, positions, h, projector->air);
    pel_project_predict(projector, state, sim->force, &sim->tools->boundary, place);
    pel_rigids_drift(sim, h);
    const pel_record *start = pel_project_substep_start(projector);
    begin_contacts(sim, start);
    pel_ties_begin_substep(sim);
    pel_joints_begin_substep(sim);
    for (int32_t i = 0; i < sim->solver.iterations && !pel_pool_is_stopped_now(sim->pool); i++)
        sweep(sim, end, start);
    pel_ties_tally(sim, projector->tau, projector->reaction);
    pel_joints_tally(sim, h);
    double rate = 1 / (projector->tau * projector->tau * count);
    if (pairs != NULL)
        pel_contacts_tally(sim, rate);
    if (sim->tools->solids != NULL)
        pel_solids_tally(sim, rate);
    const pel_contact_list *lists[] = {pairs, sim->tools->solids != NULL ? &sim->tools->solids->list : NULL};
    pel_project_finish(projector, state, lists, 2, &sim->tools->boundary, place);
    pel_rigids_finish(sim, h, projector->reaction, place & PEL_SUBSTEP_LAST || sim->solver.second_order);
    pel_plastic_follow(sim, state->position_next);
    pel_loads_tally(sim, span, start);
    pel_wind_tally(sim, start, h);
}

static pel_status run_substeps(pel_sim *sim, pel_error *error)
{
    pel_status status = PEL_OK;
    memset(sim->force, 0, (size_t)sim->model->vertex_count * sizeof *sim->force);
    pel_tools_place(sim, 0);
    pel_loads_begin_tally(sim, sim->projector->substep);
    if (pel_sim_has_loop_contacts(sim))
        pel_contact_set_recall_loads(sim->contacts, sim->projector->substep);
    if (sim->tools->solids != NULL)
        pel_solids_recall_loads(sim, sim->projector->substep);
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
    if (status != PEL_OK)
        return status;
    if (sim->tools->solids != NULL)
        pel_solids_keep_loads(sim);
    if (!pel_sim_has_loop_contacts(sim))
        return PEL_OK;
    pel_contacts_end_search(sim, sim->state->position_next);
    pel_contacts_tell(sim);
    pel_contact_set_keep_loads(sim->contacts);
    pel_contacts_tally_asleep(sim);
    return PEL_OK;
}

/* nothing can move: a substep as long as the step, without sweeps */
static void rest(pel_sim *sim)
{
    pel_substep_place place = (pel_substep_place)(PEL_SUBSTEP_FIRST | PEL_SUBSTEP_LAST);
    pel_tools_place(sim, 1);
    pel_loads_begin_tally(sim, sim->projector->substep);
    sim->projector->is_asleep = sim->asleep;
    pel_project_predict(sim->projector, sim->state, sim->force, &sim->tools->boundary, place);
    pel_project_finish(sim->projector, sim->state, NULL, 0, &sim->tools->boundary, place);
    pel_rigids_finish(sim, sim->projector->substep, NULL, true);
    pel_contacts_tally_asleep(sim);
}

/* what may touch in this step; what wakes by it is searched anew */
static pel_status find_contacts(pel_sim *sim, bool has_pairs, pel_error *error)
{
    pel_status status;
    do {
        status = has_pairs ? pel_contacts_find(sim, 0, error) : PEL_OK;
        if (status == PEL_OK && has_pairs)
            status = pel_contact_heights_find(sim->contacts, sim->state->position, error);
        if (status == PEL_OK && sim->tools->solids != NULL)
            status = pel_solids_find(sim, error);
    } while (status == PEL_OK && pel_sleep_meet_tools(sim));
    return status;
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
    pel_status status = find_contacts(sim, pel_sim_has_loop_contacts(sim) && !rests, error);
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
