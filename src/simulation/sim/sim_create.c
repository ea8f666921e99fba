/* Creation: all parts of a simulation from its def. */
#include "adapt/refine.h"
#include "attach/joint.h"
#include "attach/tie.h"
#include "base/memory.h"
#include "base/patience.h"
#include "base/room.h"
#include "base/status.h"
#include "blade/check.h"
#include "boundary/edge_load.h"
#include "boundary/fluid.h"
#include "boundary/follower.h"
#include "boundary/hold.h"
#include "boundary/wind.h"
#include "math/extremes.h"
#include "method/bending_weight.h"
#include "method/step_explicit.h"
#include "minimise/rounds.h"
#include "minimise/step_modes.h"
#include "minimise/step_path.h"
#include "observe/observe_field.h"
#include "observe/pick.h"
#include "pellicle/parallel.h"
#include "sim/contact_event.h"
#include "sim/cut.h"
#include "sim/own_def.h"
#include "sim/parts.h"
#include "sim/sim.h"
#include "solve/project.h"
#include "solve/relax.h"
#include "stage/layer.h"
#include "stage/rigids.h"
#include "stage/shells.h"
#include "stage/stepper.h"
#include "stage/surface_view.h"
#include "stage/viscous.h"
#include "tear/growth.h"
#include "tear/loose.h"
#include "tool/create.h"
#include "tool/solid.h"
#include "tool/support.h"
#include "touch/lips.h"
#include "touch/restitution.h"
#include "touch/sleep.h"
#include "touch/tangle.h"

enum { SIM_COOKIE = 0x73696d21 };

/* below this many chunks (of 512 vertices) threads cost more than they give; vertices, where steps solve systems */
enum { CHUNKS_WORTH_THREADS = 4, VERTICES_WORTH_THREADS = 128 };

/* positions farther than this many model sizes from the model count as diverged */
#define BOUND_SIZES 1e3

pel_sim_def pel_sim_def_default(void)
{
    pel_sim_def def = {.cookie = SIM_COOKIE};
    pel_def_reset(PEL_DEF_SIM, &def);
    pel_def_reset(PEL_DEF_SOLVER, &def.solver);
    pel_def_reset(PEL_DEF_CONTACT, &def.contact);
    return def;
}

/* ---- creation ---- */

/* iterations and substeps beyond which a step would seem to hang; s, whose square is a number also in substeps */
enum { MOST_SWEEPS = 1000000 };
#define SHORTEST_DT 1e-100

static pel_status check_solver(const pel_solver_def *solver, pel_error *error)
{
    if (!(solver->dt >= SHORTEST_DT && isfinite(solver->dt)))
        return pel_refuse(error, PEL_BAD_ARGUMENT, "give a time step from 1e-100 s on", "solver dt is %g", solver->dt);
    if (!(solver->alpha >= 0 && isfinite(solver->alpha)))
        return pel_refuse(error, PEL_BAD_ARGUMENT, "give a number above 0, or omit it for a stable value",
                          "solver alpha is %g", solver->alpha);
    if (PEL_IS_NO_CHOICE(solver->method, PEL_METHOD_COUNT))
        return pel_fail(error, PEL_BAD_ARGUMENT, "solver method %d is unknown", (int)solver->method);
    if (solver->analysis != PEL_ANALYSIS_NONE && !pel_stepper_of(solver->method)->is_static)
        return pel_refuse(error, PEL_BAD_ARGUMENT, "use method static, or no analysis",
                          "only the method static has an analysis");
    const struct {
        const char *name;
        int32_t count;
    } counts[] = {
        {"iterations", solver->iterations}, {"substeps", solver->substeps}, {"max_substeps", solver->max_substeps}};
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++)
        if (counts[i].count < 0 || counts[i].count > MOST_SWEEPS) {
            pel_fail(error, PEL_BAD_ARGUMENT, "solver %s is %d", counts[i].name, (int)counts[i].count);
            pel_fail_remedy(error, "give 1 to %d, or 0 for the usual number of the method", (int)MOST_SWEEPS);
            return PEL_BAD_ARGUMENT;
        }
    if (PEL_IS_NO_CHOICE((int)solver->second_order - PEL_AUTO, PEL_YES - PEL_AUTO + 1))
        return pel_fail(error, PEL_BAD_ARGUMENT, "solver second_order is %d", (int)solver->second_order);
    if (!(solver->budget >= 0 && isfinite(solver->budget)))
        return pel_refuse(error, PEL_BAD_ARGUMENT, "give a time above 0 s, or 0 for none", "solver budget is %g",
                          solver->budget);
    if (solver->budget > 0 && !pel_stepper_of(solver->method)->has_budget)
        return pel_refuse(error, PEL_BAD_ARGUMENT, "use method implicit, or leave the budget out",
                          "only the methods static and implicit have a budget of time");
    if (!(solver->drag >= 0 && isfinite(solver->drag)))
        return pel_refuse(error, PEL_BAD_ARGUMENT, "give a finite number of at least 0", "solver drag is %g",
                          solver->drag);
    return PEL_OK;
}

static pel_status check_tear(const pel_tear_def *tear, pel_error *error)
{
    if (PEL_IS_NO_CHOICE(tear->start, PEL_TEAR_ANYWHERE + 1))
        return pel_fail(error, PEL_BAD_ARGUMENT, "start of tears is %d", (int)tear->start);
    if (tear->max_tips < 1)
        return pel_refuse(error, PEL_BAD_ARGUMENT, "give 1 or more", "max_tips of tears is %d", (int)tear->max_tips);
    return PEL_OK;
}

static pel_status check_def(const pel_sim_def *def, pel_error *error)
{
    if (def->cookie != SIM_COOKIE)
        return pel_fail(error, PEL_BAD_ARGUMENT, "sim def was not made by pel_sim_def_default()");
    if (def->model == NULL)
        return pel_fail(error, PEL_BAD_ARGUMENT, "sim has no model");
    pel_status status = check_solver(&def->solver, error);
    if (status == PEL_OK)
        status = check_tear(&def->tear, error);
    if (status != PEL_OK)
        return status;
    if (def->thread_count < 0 || def->thread_count > PEL_THREADS_MOST)
        return pel_fail(error, PEL_BAD_ARGUMENT, "thread_count is %d", (int)def->thread_count);
    const struct {
        const char *name;
        int32_t count;
        const void *array;
    } arrays[] = {{"load", def->load_count, def->loads},          {"tool", def->tool_count, def->tools},
                  {"support", def->support_count, def->supports}, {"tie", def->tie_count, def->ties},
                  {"joint", def->joint_count, def->joints},       {"cut", def->cut_count, def->cuts},
                  {"seam", def->seam_count, def->seams}};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++)
        if (arrays[i].count < 0 || (arrays[i].count > 0 && arrays[i].array == NULL))
            return pel_fail(error, PEL_BAD_ARGUMENT, "%s_count is %d, and %ss is null or the count below 0",
                            arrays[i].name, (int)arrays[i].count, arrays[i].name);
    return PEL_OK;
}

static double position_bound(const pel_model *model)
{
    double size = 0, far = 0;
    for (int32_t b = 0; b < model->body_count; b++)
        size = pel_max(size, model->bodies[b].diameter);
    for (int32_t v = 0; v < model->vertex_count; v++)
        for (int i = 0; i < 3; i++)
            far = pel_max(far, fabs((double)model->rest[v][i]));
    return 2 * far + BOUND_SIZES * size;
}

/* a pool when the largest body has work for more than one thread */
static pel_status start_threads(pel_sim *sim, const pel_sim_def *def, pel_error *error)
{
    int32_t most = 0;
    for (int32_t b = 0; b < sim->model->body_count; b++) {
        const pel_body *body = &sim->model->bodies[b];
        int32_t end = sim->active != NULL ? sim->active->bodies[b].fine_limit / PEL_WIDTH : body->slice_end;
        int32_t chunk_count = pel_slice_chunk_count(body->slice_begin, end);
        most = chunk_count > most ? chunk_count : most;
    }
    sim->chunk_longest = pel_allocate((size_t)most, 2 * sizeof *sim->chunk_longest);
    if (sim->chunk_longest == NULL)
        return pel_fail_memory(error);
    sim->step.longest = sim->chunk_longest;
    sim->step.ways = def->contact.enabled ? sim->chunk_longest + most : NULL;
    int threads = def->thread_count > 0 ? def->thread_count : pel_thread_limit();
    bool solves = sim->stepper->minimises && sim->model->vertex_count >= VERTICES_WORTH_THREADS;
    bool helps = threads > 1 && (most >= CHUNKS_WORTH_THREADS || solves);
    /* a pool without helpers asks whether the step is wanted */
    if (!helps && def->wanted == NULL)
        return PEL_OK;
    pel_status status = pel_pool_create(helps ? threads : 1, &sim->pool, error);
    sim->step.pool = sim->pool;
    return status;
}

/* a copy of the def, for changes; meshes of tools belong to the sim */
static pel_status keep_def(pel_house *house, const pel_sim_def *def, pel_error *error)
{
    pel_sim *sim = &house->sim;
    sim->def = *def;
    pel_status status = pel_sim_def_copy(&house->copies, &sim->def, error);
    pel_tool_def *tools = (pel_tool_def *)(uintptr_t)sim->def.tools;
    for (int32_t t = 0; status == PEL_OK && t < def->tool_count; t++)
        tools[t].mesh = sim->tools->items[t].mesh;
    return status;
}

/* tetrahedra need a method that knows their material */
static pel_status check_volumes(const pel_sim *sim, pel_error *error)
{
    for (int32_t b = 0; b < sim->model->body_count; b++) {
        const pel_shell *shell = sim->model->bodies[b].shell;
        if (shell != NULL && shell->tetrahedron_count > 0 && !pel_stepper_knows_material(sim->stepper))
            return pel_refuse(error, PEL_BAD_ARGUMENT, "use the method implicit, static, xpbd or explicit",
                              "body '%s' has a volume, which this method does not know", sim->model->bodies[b].name);
    }
    return PEL_OK;
}

/* a velocity at the start needs a method that has velocities */
static pel_status check_start(const pel_sim *sim, pel_error *error)
{
    for (int32_t b = 0; b < sim->model->body_count; b++) {
        if (pel_sim_has_velocity(sim) || !pel_body_moves(&sim->model->bodies[b]))
            continue;
        return pel_refuse(
            error, PEL_BAD_ARGUMENT, "use the method implicit, xpbd, pbd or explicit, or omit the velocity",
            "body '%s' has a velocity at the start, but this method has no velocities", sim->model->bodies[b].name);
    }
    return PEL_OK;
}

void pel_house_link(pel_house *house)
{
    pel_sim *sim = &house->sim;
    sim->loads = &house->loads;
    sim->tools = &house->tools;
    sim->ledger = &house->ledger;
    sim->touch = &house->touch;
    sim->substeps = &house->substeps;
}

/* the stage but for its elements; the method may give numbers to the solver */
static pel_status build_stage(pel_sim *sim, const pel_sim_def *def, pel_error *error)
{
    sim->model = sim->given = def->model;
    sim->solver = def->solver;
    sim->clock = pel_seconds;
    sim->deadline = HUGE_VAL;
    sim->stepper = pel_stepper_for(def->solver.method, def->model);
    pel_status status = check_start(sim, error);
    if (status == PEL_OK)
        status = check_volumes(sim, error);
    if (status != PEL_OK)
        return status;
    pel_substeps_configure(sim, def);
    if (pel_model_refines(def->model)) {
        status = pel_refined_create(def->model, &sim->active, error);
        if (status != PEL_OK)
            return status;
        sim->model = &sim->active->model;
    }
    sim->step = (pel_step){
        .dt = def->solver.dt,
        .keep_velocity = def->solver.keep_velocity,
        .symplectic = def->solver.symplectic,
        .bound = position_bound(def->model),
    };
    sim->force = pel_allocate_aligned((size_t)sim->model->vertex_count, sizeof *sim->force);
    if (sim->force == NULL)
        return pel_fail_memory(error);
    status = start_threads(sim, def, error);
    if (status == PEL_OK)
        status = pel_state_create(sim->model, pel_sim_has_velocity(sim), &sim->state, error);
    if (status == PEL_OK)
        status = pel_rigids_create(sim, error);
    return status == PEL_OK ? pel_surface_rows_create(sim, error) : status;
}

/* elements, refinement and the data of the method; the surface has its first level then */
static pel_status build_method(pel_sim *sim, pel_error *error)
{
    pel_status status = pel_refine_create(sim, error);
    if (status == PEL_OK)
        status = pel_shells_create(sim, error);
    if (status != PEL_OK)
        return status;
    pel_bending_weights_start(sim);
    status = sim->stepper->create(sim, error);
    if (status == PEL_OK && sim->active != NULL)
        status = pel_refine_start(sim, error);
    if (status == PEL_OK && pel_sim_has_velocity(sim))
        pel_state_start(sim->model, sim->state);
    if (status == PEL_OK && !sim->goes_on)
        pel_substeps_follow(sim);
    return status;
}

static pel_status build_boundary(pel_sim *sim, const pel_sim_def *def, pel_error *error)
{
    pel_status status = pel_loads_create(sim, def->loads, def->load_count, error);
    if (status == PEL_OK)
        status = pel_edge_loads_create(sim, def, error);
    if (status == PEL_OK)
        status = pel_followers_create(sim, def, error);
    if (status == PEL_OK)
        status = pel_fluids_create(sim, error);
    if (status == PEL_OK)
        status = pel_wind_create(sim, &def->wind, error);
    if (status == PEL_OK)
        status = pel_tools_create(sim, def->tools, def->tool_count, error);
    if (status == PEL_OK)
        status = pel_holds_create(sim, def, error);
    if (status == PEL_OK)
        status = pel_supports_create(sim, error);
    return status == PEL_OK ? pel_solids_create(sim, error) : status;
}

static pel_status build_contact(pel_sim *sim, const pel_sim_def *def, pel_error *error)
{
    pel_status status = PEL_OK;
    if (sim->tools->count > 0 || def->contact.enabled)
        status = pel_contact_forces_create(sim->model->vertex_count, sim->model->body_count, sim->tools->count,
                                           sim->model->body_of_slice, &sim->contact_forces, error);
    if (status == PEL_OK && def->record_contacts && sim->contact_forces.is_kept)
        status = pel_contact_records_create(&sim->contact_forces, error);
    if (status == PEL_OK)
        status = pel_layers_create(sim, error);
    if (status == PEL_OK && def->contact.enabled)
        status = pel_lips_find_origins(sim, error);
    if (status == PEL_OK)
        status = pel_contacts_create(sim, &def->contact, error);
    if (status == PEL_OK && !sim->goes_on)
        status = pel_contacts_refuse_buried(sim, def, error);
    if (status == PEL_OK)
        status = pel_ties_create(sim, def, error);
    if (status == PEL_OK)
        status = pel_joints_create(sim, def, error);
    if (status == PEL_OK)
        status = pel_restitution_create(sim, error);
    if (status == PEL_OK)
        status = pel_sleep_create(sim, error);
    if (status != PEL_OK)
        return status;
    pel_parts_create(sim);
    return pel_contacts_create_event(sim, error);
}

/* Whether anything may ever touch: a body itself or another one, tools, lips of cuts, seams and tears. Contact without
   that would change steps, their number and order. */
static bool may_touch(const pel_sim_def *def)
{
    bool may = def->contact.self || (def->contact.between && def->model->body_count > 1) || def->tool_count > 0 ||
               def->cut_count > 0 || def->seam_count > 0;
    for (int32_t b = 0; b < def->model->body_count; b++) {
        const pel_body_def *body = &def->model->def.bodies[b];
        may |= body->shell.membrane.toughness.value > 0 || body->shell.membrane.toughness.field != NULL;
        may |= body->spring_toughness.value > 0 || body->spring_toughness.field != NULL;
    }
    return may;
}

pel_status pel_sim_build(pel_house *house, const pel_sim_def *given, pel_error *error)
{
    pel_sim_def own = *given;
    const pel_sim_def *def = &own;
    pel_sim *sim = &house->sim;
    pel_house_link(house);
    pel_status status = check_def(def, error);
    own.contact.enabled = status == PEL_OK && own.contact.enabled && may_touch(given);
    if (status == PEL_OK)
        status = build_stage(sim, def, error);
    if (status == PEL_OK)
        status = build_method(sim, error);
    if (status == PEL_OK)
        status = build_boundary(sim, def, error);
    if (status == PEL_OK)
        status = build_contact(sim, def, error);
    if (status == PEL_OK)
        status = pel_cuts_check(sim, def, error);
    if (status == PEL_OK && sim->stepper->check_start != NULL)
        status = sim->stepper->check_start(sim, error);
    if (status == PEL_OK)
        status = pel_ledger_create(sim, error);
    if (status == PEL_OK)
        status = keep_def(house, given, error);
    /* loops that were stopped on their way */
    if (status == PEL_OK && pel_patience_is_lost())
        return pel_fail_memory(error);
    if (status == PEL_OK)
        status = pel_blades_create(sim, error);
    if (status == PEL_OK)
        status = pel_tear_create(sim, error);
    if (status == PEL_OK)
        status = pel_loose_find(sim, error);
    if (status == PEL_OK && sim->tear != NULL)
        status = pel_cut_check_sim(sim, error);
    if (status == PEL_OK)
        pel_sim_take_fingerprint(sim);
    return status;
}

pel_status pel_sim_create(const pel_sim_def *def, pel_sim **sim, pel_error *error)
{
    PEL_REFUSE_NULL(def, error);
    PEL_REFUSE_NULL(sim, error);
    *sim = NULL;
    pel_house *made = pel_allocate(1, sizeof *made);
    if (made == NULL)
        return pel_fail_memory(error);
    pel_status status = pel_sim_build(made, def, error);
    if (status == PEL_OK)
        *sim = &made->sim;
    else
        pel_sim_destroy(&made->sim);
    return status;
}

/* nothing but the method and the ledger depends on numbers of the bodies and the solver */
static bool may_refill(const pel_sim *sim)
{
    bool has_parts = sim->active != NULL || sim->shells != NULL || sim->tools->count > 0 ||
                     sim->def.support_count > 0 || sim->loads->edge_load_count > 0 || sim->loads->follower_count > 0 ||
                     sim->contacts != NULL || sim->def.cut_count > 0 || sim->ties != NULL || sim->cut_revision > 0 ||
                     sim->tear != NULL;
    return sim->stepper->can_refill && !has_parts;
}

bool pel_sim_refill(pel_sim *sim, bool with_model)
{
    if (!may_refill(sim) || check_def(&sim->def, NULL) != PEL_OK)
        return false;
    sim->solver = sim->def.solver;
    sim->step.keep_velocity = sim->solver.keep_velocity;
    if (check_start(sim, NULL) != PEL_OK || sim->stepper->create(sim, NULL) != PEL_OK)
        return false;
    if (with_model) {
        pel_state_refill(sim->model, pel_sim_has_velocity(sim), sim->state);
        pel_ledger_refill(sim);
    }
    pel_parts_create(sim);
    pel_sim_take_fingerprint(sim);
    sim->present.has_force = false;
    sim->state_number++;
    return true;
}

void pel_sim_release(pel_house *house)
{
    pel_sim *sim = &house->sim;
    pel_copies_free(&house->copies);
    pel_picker_destroy(sim->picker);
    pel_observer_destroy(sim->observer);
    PEL_FREE_ALL(sim->loads->external, sim->loads->dragged, sim->loose);
    pel_ledger_destroy(sim);
    pel_parts_destroy(sim);
    pel_free(sim->touch->collisions);
    pel_joints_destroy(sim);
    pel_ties_destroy(sim);
    pel_free(sim->layers);
    pel_contact_forces_destroy(&sim->contact_forces);
    pel_contacts_destroy(sim);
    pel_solids_destroy(sim);
    pel_holds_destroy(sim);
    pel_supports_destroy(sim);
    pel_tools_destroy(sim);
    pel_edge_loads_destroy(sim);
    pel_followers_destroy(sim);
    pel_loads_destroy(sim);
    pel_refine_destroy(sim);
    pel_surface_rows_destroy(sim);
    pel_sim_modes_destroy(sim);
    pel_sim_path_destroy(sim);
    pel_minimise_destroy(sim);
    pel_relax_destroy(sim->relax);
    pel_projector_destroy(sim->projector);
    pel_viscous_destroy(sim);
    pel_substeps_destroy(sim);
    pel_tear_destroy(sim);
    pel_shells_destroy(sim);
    pel_rigids_destroy(sim);
    pel_refined_destroy(sim->active);
    pel_state_destroy(sim->state);
    PEL_FREE_ALL(sim->force, sim->predicted, sim->pin_force, sim->chunk_longest);
    pel_pool_destroy(sim->pool);
    pel_model_destroy(house->own_model);
}

void pel_sim_destroy(pel_sim *sim)
{
    if (sim == NULL)
        return;
    pel_house *house = pel_house_of(sim);
    pel_sim_release(house);
    pel_free(house);
}

/* ---- before there is a simulation ---- */

/* s */
#define SHORT_DT 1e-15
/* of the limit at rest: materials stiffen, and edges become short, as a body moves */
#define MOVING_SHARE 0.5

pel_status pel_sim_needed_substeps(const pel_sim_def *def, int32_t *count, pel_error *error)
{
    PEL_REFUSE_NULL(def, error);
    PEL_REFUSE_NULL(count, error);
    pel_status status = check_def(def, error);
    *count = 0;
    if (status != PEL_OK)
        return status;
    pel_substeps substeps = {0};
    pel_sim sim = {.model = def->model,
                   .given = def->model,
                   .solver = def->solver,
                   .step.dt = def->solver.dt,
                   .substeps = &substeps};
    sim.solver.method = PEL_METHOD_XPBD;
    sim.stepper = pel_stepper_of(PEL_METHOD_XPBD);
    pel_substeps_configure(&sim, def);
    status = pel_state_create(sim.model, true, &sim.state, error);
    if (status == PEL_OK)
        status = pel_substeps_count(&sim, count, error);
    pel_substeps_destroy(&sim);
    pel_state_destroy(sim.state);
    return status;
}

/* of a simulation whose steps are short enough for anything */
pel_status pel_sim_stable_dt(const pel_sim_def *def, double *dt, pel_error *error)
{
    PEL_REFUSE_NULL(def, error);
    PEL_REFUSE_NULL(dt, error);
    pel_sim_def own = *def;
    pel_sim *sim;
    own.solver.method = PEL_METHOD_EXPLICIT;
    own.solver.dt = SHORT_DT;
    *dt = 0;
    pel_status status = pel_sim_create(&own, &sim, error);
    if (status != PEL_OK)
        return status;
    status = pel_explicit_limit(sim, dt, error);
    *dt *= MOVING_SHARE;
    pel_sim_destroy(sim);
    return status;
}
