#include "run/warnings.h"

#include "base/lane.h"
#include "base/memory.h"
#include "base/status.h"
#include "choice/element.h"
#include "choice/method.h"
#include "choice/time_step.h"
#include "def/row.h"
#include "field/radius.h"
#include "math/extremes.h"
#include "math/functions.h"
#include "math/vec3.h"
#include "mesh/figures.h"
#include "mesh/seam.h"
#include "minimise/rounds.h"
#include "minimise/step_newton.h"
#include "model/model.h"
#include "model/quantity.h"
#include "model/shell.h"
#include "pellicle/sim_surface.h"
#include "pellicle/tear.h"
#include "pellicle/topology.h"
#include "run/state.h"
#include "run/warnings_bodies.h"
#include "run/warnings_contact.h"
#include "run/warnings_hinges.h"
#include "run/warnings_rest.h"
#include "run/warnings_shell.h"
#include "run/warnings_springs.h"
#include "run/warnings_volume.h"
#include "stage/stepper.h"
#include "tear/loose.h"
#include "touch/tangle.h"

#include <float.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* stretch beyond the material's, as a share */
#define SOFTNESS_LIMIT 0.05
/* share of all vertices that the guard steps back in a step, and number of such steps, from which contact is jammed */
#define JAM_SHARE 0.1
/* share from which one step is enough */
#define JAM_AT_ONCE 0.5
enum { JAM_STEPS = 10 };
/* rounding errors of a position, in units of the last place; of the supplied energy: an excess that counts */
#define ROUNDING_ERRORS 8
#define EXCESS_SHARE 0.05
/* of the largest force: forces on free vertices of a quasi-static run at rest */
#define SETTLED_SHARE 0.05
/* of the size of a mesh: borders nearer than that are a seam that a file has rounded */
#define WIDE_SHARE 3e-5
/* a run of as many steps shows a motion; steps of a quarter of a vibration, at the step that resolves it */
enum { FEW_STEPS = 4, QUARTER = 10 };
/* of a given step: one that would do is at most so long */
#define LONG_SHARE 0.5
/* rad in a step, of which so many are a vibration */
#define GOOD_ANGLE 0.15708
#define GOOD_STEPS 40
/* of the energy that was supplied: more than that is told in joules alone */
#define MOST_SHARE 1000
/* of the largest kinetic energy, lost in bounces, of which impacts take up to 0.3; a share that means none */
#define BOUNCE_SHARE 0.33
#define TINY_SHARE 1e-3
/* of the energy lost while nothing touched: a loss that is told beside it */
#define TOUCH_SHARE 1.2

static const char *const codes[PEL_WARN_COUNT] = {
    [PEL_WARN_SOFT] = "softer-than-material",
    [PEL_WARN_COARSE] = "coarse-mesh",
    [PEL_WARN_MILLIMETRES] = "millimetres",
    [PEL_WARN_INVERTED_MESH] = "inverted-mesh",
    [PEL_WARN_INVERTED_VOLUME] = "inverted-volume",
    [PEL_WARN_UNCONVERGED] = "unconverged",
    [PEL_WARN_UNSTABLE] = "unstable-balance",
    [PEL_WARN_STRAY] = "stray-body",
    [PEL_WARN_ENERGY] = "energy-appears",
    [PEL_WARN_JAMMED] = "jammed",
    [PEL_WARN_TOOL_HELD] = "tool-held-back",
    [PEL_WARN_ESTIMATED] = "work-estimated",
    [PEL_WARN_CUT_HELD] = "cut-held-back",
    [PEL_WARN_GRASP_LOST] = "grasp-lost",
    [PEL_WARN_GRASP_EMPTY] = "grasp-empty",
    [PEL_WARN_TIE_LOST] = "tie-lost",
    [PEL_WARN_UNCOUNTED] = "intersections-not-counted",
    [PEL_WARN_CROSSING] = "surfaces-cross",
    [PEL_WARN_COARSE_CONTACT] = "coarse-contact",
    [PEL_WARN_UNSETTLED] = "unsettled",
    [PEL_WARN_UNRESOLVED] = "unresolved-motion",
    [PEL_WARN_HELD_IN_PLACE] = "held-in-place",
    [PEL_WARN_TOOL_IDLE] = "tool-touches-nothing",
    [PEL_WARN_CLOSE_START] = "close-start",
    [PEL_WARN_POISSON] = "poisson-above-half",
    [PEL_WARN_COARSE_VOLUME] = "coarse-volume",
    [PEL_WARN_FAST_BLADE] = "fast-blade",
    [PEL_WARN_WEIGHTLESS] = "weightless-filling",
    [PEL_WARN_HOLLOW] = "hollow-body",
    [PEL_WARN_FALLS] = "falls-away",
    [PEL_WARN_NOTHING] = "nothing-acts",
    [PEL_WARN_LOOSE] = "loose-piece",
    [PEL_WARN_HINGE_ROW] = "hinge-row",
    [PEL_WARN_OPEN_SEAM] = "open-seam",
    [PEL_WARN_COARSE_LOAD] = "coarse-load",
    [PEL_WARN_COARSE_MODE] = "coarse-mode",
    [PEL_WARN_COARSE_BENDING] = "coarse-bending",
    [PEL_WARN_SPRING_NET] = "spring-net",
    [PEL_WARN_HINGES] = "hinge-bending",
    [PEL_WARN_LARGEST_PRESSURE] = "largest-pressure",
};

/* s of one core: explicit runs that take longer are not proposed */
#define LONG_EXPLICIT 300
/* of the energy: what a method may take */
#define LITTLE_LOSS 0.04
/* of the energy that was supplied: the work of tools whose forces are not known that is told */
#define ESTIMATED_SHARE 0.1
/* of the energy of a stretched start: the rest covers what projections find anew of it */
#define STRETCHED_SHARE 0.95
/* of the supplied energy, in the tolerance of the ledger (sim_ledger.h) */
#define TOLERATED 0.05

/* ---- the scene ---- */

/* Edges against sqrt(R h), the width of the layer in which a load bends a shell as well as stretching it (Calladine
   1983, Theory of Shell Structures, sections 7.5 and 11.4). A body that refines has shorter edges where needed. Loads
   that only stretch need no such edges: frames show whether it bends (bends_locally). */
static pel_status check_edges(pel_run_state *run, int32_t b, pel_error *error)
{
    const pel_body_def *body = &run->scene->model.bodies[b];
    const pel_membrane_def *membrane = &body->shell.membrane;
    double radius, edge;
    if (!membrane->on || body->shell.bending.model == PEL_BENDING_NONE ||
        !pel_stepper_knows_material(pel_stepper_of(run->scene->sim.solver.method)))
        return PEL_OK;
    pel_topology *topology;
    pel_status status = pel_topology_create(body->mesh, &topology, error);
    if (status != PEL_OK)
        return status;
    pel_mesh_mean_radius(body->mesh, topology, body->mesh->positions[0], (double)HUGE_VAL, &radius, &edge);
    pel_topology_destroy(topology);
    edge = ldexp(edge, -body->refine.levels);
    double limit = sqrt(radius * pel_quantity_mean(&membrane->thickness, body->mesh->vertex_count));
    if (edge > limit && !(run->flagged[PEL_WARN_COARSE].limit > 0))
        run->flagged[PEL_WARN_COARSE] = (pel_flagged_body){b, edge, limit};
    return PEL_OK;
}

/* the model turned inside-out parts, so that pressure and volume have their usual sign */
static void check_orientation(pel_run_state *run, int32_t b)
{
    int32_t turned = pel_model_turned_count(run->model, b);
    if (turned > 0)
        pel_warn_body(run, PEL_WARN_INVERTED_MESH, b, turned, 0);
}

/* at a place by something other than its filling */
static bool is_supported(const pel_scene *scene, int32_t b)
{
    bool is_held = scene->model.bodies[b].pinned_count > 0;
    for (int32_t s = 0; s < scene->sim.support_count; s++)
        is_held |= scene->sim.supports[s].body == b;
    for (int32_t t = 0; t < scene->sim.tool_count; t++) {
        const pel_tool_def *tool = &scene->sim.tools[t];
        is_held |= (tool->shape == PEL_TOOL_SUPPORT || tool->grasp) && (tool->body == b || tool->body < 0);
    }
    return is_held;
}

/* volumetric springs lead to fixed places (paper A, eq. A-4): a body with them does not move freely */
static void check_filling(pel_run_state *run, int32_t b)
{
    const pel_body_def *body = &run->scene->model.bodies[b];
    double stiffness = pel_quantity_mean(&body->volumetric_stiffness, body->mesh->vertex_count);
    double motion = pel_vec3_length(run->scene->model.gravity) + pel_vec3_length(body->velocity);
    if (stiffness > 0 && motion > 0 && !is_supported(run->scene, b))
        pel_warn_body(run, PEL_WARN_HELD_IN_PLACE, b, stiffness, 0);
    else if (pel_scene_is_carried(run->scene, run->model, b))
        pel_warn_body(run, PEL_WARN_HELD_IN_PLACE, b, stiffness, stiffness);
}

/* elements nearer to each other than the thickness; intersections that the scene accepts are another matter */
static pel_status check_start(pel_run_state *run, pel_error *error)
{
    const pel_contact_def *contact = &run->scene->sim.contact;
    if (!contact->enabled || contact->allow_tangled || run->def->resume != NULL)
        return PEL_OK;
    pel_status status = pel_contacts_find_start_gap(run->sim, &run->start_gap, error);
    if (status == PEL_OK && run->start_gap.count > 0)
        pel_warn(&run->totals.warnings, PEL_WARN_CLOSE_START, 0, run->start_gap.gap);
    return status;
}

/* Borders that lie on each other and were not sewn: which belong together is not clear, or they are a little apart.
   What would be sewn as it is was left open on purpose (mesh.weld). */
static pel_status check_seams(pel_run_state *run, int32_t b, pel_error *error)
{
    const pel_mesh *mesh = run->scene->model.bodies[b].mesh;
    int32_t count, *index_of = pel_allocate((size_t)mesh->vertex_count, sizeof *index_of);
    const double gaps[] = {pel_seams_tolerance(mesh, PEL_SEAM_SHARE), pel_seams_tolerance(mesh, WIDE_SHARE)};
    pel_seams seams[2] = {{0}};
    pel_status status = index_of != NULL ? PEL_OK : PEL_OUT_OF_MEMORY;
    for (int i = 0; status == PEL_OK && i < 2; i++)
        status = pel_seams_find((const double(*)[3])mesh->positions, mesh->vertex_count,
                                (const int32_t(*)[3])mesh->triangles, mesh->triangle_count, gaps[i], index_of, &count,
                                &seams[i]);
    pel_free(index_of);
    if (status != PEL_OK)
        return pel_fail_memory(error);
    const int32_t apart = seams[1].closed_count - seams[0].closed_count;
    if (apart > 0 || seams[0].open_count > 0)
        pel_warn_body(run, PEL_WARN_OPEN_SEAM, b, pel_max(apart, 0) + seams[0].open_count, gaps[apart > 0]);
    return PEL_OK;
}

pel_status pel_warnings_check_scene(pel_run_state *run, pel_error *error)
{
    double softness = pel_sim_softness(run->sim);
    pel_status status = check_start(run, error);
    if (status == PEL_OK && run->scene->sim.solver.analysis == PEL_ANALYSIS_NONE)
        status = pel_warnings_check_rows(run, error);
    pel_warnings_check_pressures(run, 0);
    pel_warnings_check_blades(run);
    if (softness > SOFTNESS_LIMIT)
        pel_warn(&run->totals.warnings, PEL_WARN_SOFT, 0, softness);
    for (int32_t b = 0; status == PEL_OK && b < run->scene->model.body_count; b++) {
        status = check_edges(run, b, error);
        if (status == PEL_OK)
            status = check_seams(run, b, error);
        pel_warnings_check_body(run, b);
        pel_warnings_check_volume(run, b);
        check_orientation(run, b);
        check_filling(run, b);
    }
    return status;
}

/* ---- steps and frames ---- */

/* closed grasps of tools that touch nothing; the value is the number of the tool, negated so that the first is kept */
static void check_grasps(pel_run_state *run, int64_t frame)
{
    const pel_sim_def *def = &run->scene->sim;
    /* a grasp closes in the step that is nearest to its time */
    double time = pel_sim_time(run->sim), closed = time - 0.75 * def->solver.dt;
    for (int32_t t = 0; t < def->tool_count; t++) {
        pel_tool_reading reading;
        /* one that leads a tear goes to the flap by itself */
        if (!def->tools[t].grasp || def->tools[t].leads || closed < def->tools[t].grasp_from ||
            time >= def->tools[t].grasp_until)
            continue;
        pel_sim_get_tool(run->sim, t, &reading);
        if (reading.contact_count == 0 && reading.lost_count == 0)
            pel_warn(&run->totals.warnings, PEL_WARN_GRASP_EMPTY, frame, -(double)t);
    }
}

/* steps in which any tool was held back or lost vertices, and the largest number of lost vertices of a tool */
static void check_tools(pel_run_state *run, int64_t frame)
{
    pel_warning_tallies *tallies = &run->totals.warnings;
    double end = pel_sim_time(run->sim), most_lost = 0;
    bool is_held_back = false;
    int64_t lost_count = 0;
    for (int32_t t = 0; t < pel_sim_tool_count(run->sim); t++) {
        pel_tool_reading reading;
        pel_sim_get_tool(run->sim, t, &reading);
        is_held_back |= reading.is_held_back;
        lost_count += reading.lost_count;
        most_lost = pel_max(most_lost, (double)reading.lost_count);
    }
    if (is_held_back)
        pel_warn(tallies, PEL_WARN_TOOL_HELD, frame, end);
    if (lost_count > run->totals.lost_count)
        pel_warn(tallies, PEL_WARN_GRASP_LOST, frame, most_lost);
    run->totals.lost_count = lost_count;
}

/* steps in which attachments or stitches let vertices go */
static void check_ties(pel_run_state *run, int64_t frame)
{
    int64_t lost_count = 0;
    for (int32_t t = 0; t < pel_sim_tie_count(run->sim); t++) {
        pel_tie_reading reading;
        pel_sim_get_tie(run->sim, t, &reading);
        lost_count += reading.lost_count;
    }
    if (lost_count > run->totals.tie_lost_count)
        pel_warn(&run->totals.warnings, PEL_WARN_TIE_LOST, frame, (double)lost_count);
    run->totals.tie_lost_count = lost_count;
}

void pel_warnings_check_step(pel_run_state *run)
{
    pel_warning_tallies *tallies = &run->totals.warnings;
    int64_t frame = run->totals.frame_count, vertex_count = 0;
    pel_solver_reading solver;
    pel_contact_statistics now;
    pel_sim_get_solver(run->sim, &solver);
    if (solver.solves && !solver.converged)
        pel_warn(tallies, PEL_WARN_UNCONVERGED, frame, solver.residual);
    if (solver.unstable)
        pel_warn(tallies, PEL_WARN_UNSTABLE, frame, 0);
    if (solver.stray_body >= 0) {
        run->flagged[PEL_WARN_STRAY] = (pel_flagged_body){solver.stray_body, solver.stray_way, 0};
        pel_warn(tallies, PEL_WARN_STRAY, frame, solver.stray_way);
    }
    if (pel_loose_body(run->sim) >= 0)
        pel_warn(tallies, PEL_WARN_LOOSE, frame, pel_sim_time(run->sim));
    if (solver.softness > SOFTNESS_LIMIT)
        pel_warn(tallies, PEL_WARN_SOFT, frame, solver.softness);
    pel_sim_get_contact_statistics(run->sim, &now);
    for (int32_t b = 0; b < run->scene->model.body_count; b++)
        vertex_count += pel_sim_vertex_count(run->sim, b);
    double share = (now.stepped_back - run->contact_before.stepped_back) / (double)vertex_count;
    if (share >= JAM_SHARE)
        pel_warn(tallies, PEL_WARN_JAMMED, frame, share);
    if (pel_sim_cut_is_held(run->sim))
        pel_warn(tallies, PEL_WARN_CUT_HELD, frame, pel_sim_cuts_done(run->sim));
    check_grasps(run, frame);
    pel_swing_add(run);
    pel_warnings_check_mode(run);
    run->contact_before = now;
    check_tools(run, frame);
    check_ties(run, frame);
}

/* ---- the end ---- */

/* unbalanced forces exclude vertices in contact */
static void check_rest(pel_run_state *run, int64_t frame)
{
    const pel_sim_def *sim = &run->scene->sim;
    /* of tools and of unbalanced forces at a frame, such as a load that has just started */
    double largest = pel_max(run->totals.unbalanced_force, pel_run_max_tool_force(run));
    double share = run->measures.unbalanced_force / pel_max(largest, DBL_MIN);
    /* where nothing acts there is only rounding */
    bool acts = run->ledger.supplied > run->ledger.tolerance;
    if (pel_stepper_of(sim->solver.method)->relaxes && acts && share > SETTLED_SHARE) {
        run->flagged[PEL_WARN_UNSETTLED] = (pel_flagged_body){0, run->measures.unbalanced_force, share};
        pel_warn(&run->totals.warnings, PEL_WARN_UNSETTLED, frame, share);
    }
}

/* Whether a run of few steps is long enough to show a motion: a quarter of the slowest vibration of a body, or an
   eighth of what a load does. Before that, steps of first order have lost energy, and no amplitude. */
static bool shows_motion(const pel_run_state *run)
{
    pel_motions motions;
    if (pel_sim_step_count(run->sim) >= FEW_STEPS)
        return true;
    return pel_scene_find_motions(run->scene, HUGE_VAL, 0, &motions) == PEL_OK &&
           pel_sim_time(run->sim) > QUARTER * motions.fastest.dt;
}

/* and not that of a scene which leaves it to the program */
static bool is_dt_long(const pel_run_state *run, double dt)
{
    pel_motions motions;
    return pel_scene_find_motions(run->scene, dt, 0, &motions) == PEL_OK && motions.fastest.dt < LONG_SHARE * dt;
}

/* J, by which bodies have been stretched from the start, and still are */
static double held_energy(const pel_sim_ledger *ledger)
{
    return pel_max(pel_min(ledger->elastic, ledger->elastic_start), 0);
}

/* of what was supplied to the motion */
static double share_of_motion(const pel_sim_ledger *ledger, double loss)
{
    return pel_min(loss / pel_max(ledger->supplied - held_energy(ledger), DBL_MIN), 1);
}

/* Where neither friction nor restitution can take energy, the method has taken what is lost in contact too. */
static bool takes_in_contact(const pel_scene *scene)
{
    const pel_contact_def *contact = &scene->sim.contact;
    bool takes = !(contact->friction > 0) && !(contact->restitution >= 0);
    for (int32_t b = 0; b < scene->model.body_count; b++)
        takes &= !(scene->model.bodies[b].friction > 0) && !(scene->model.bodies[b].restitution >= 0);
    for (int32_t t = 0; t < scene->sim.tool_count; t++)
        takes &= !(scene->sim.tools[t].friction > 0) && !(scene->sim.tools[t].restitution >= 0);
    return takes;
}

/* Of methods that follow a motion and the material, in frames in which nothing touched. A volume that is driven is
   followed, not resolved; a limit of a joint stops a body as contact does. */
static void check_motion(pel_run_state *run, int64_t frame)
{
    const pel_scene *scene = run->scene;
    const pel_stepper *stepper = pel_stepper_of(scene->sim.solver.method);
    const pel_sim_ledger *ledger = &run->ledger;
    bool moves = stepper->has_velocity && !stepper->is_explicit && pel_stepper_knows_material(stepper), yields = false;
    for (int32_t b = 0; b < scene->model.body_count; b++) {
        const pel_pressure_def *p = &scene->model.bodies[b].shell.pressure;
        moves &= p->kind != PEL_PRESSURE_VOLUME || (p->target.key_count == 0 && p->target.value == 1);
        yields |= !scene->model.bodies[b].rigid.on;
    }
    for (int32_t i = 0; i < scene->sim.joint_count; i++)
        moves &= isinf(scene->sim.joints[i].least) && isinf(scene->sim.joints[i].most);
    if (!moves || !(ledger->supplied > ledger->tolerance) || !pel_scene_is_undamped(scene))
        return;
    const double angle = pel_swing_angle(run);
    run->flagged[PEL_WARN_UNRESOLVED] = (pel_flagged_body){0, angle, 0};
    const double tolerance = ledger->tolerance - TOLERATED * STRETCHED_SHARE * held_energy(ledger);
    const double bounced = yields && takes_in_contact(scene) ? run->totals.bounce_loss : 0;
    const bool loses =
        (run->totals.free_loss > tolerance || bounced > BOUNCE_SHARE * run->totals.most_kinetic) && shows_motion(run);
    if (loses || (angle > 0 && is_dt_long(run, scene->sim.solver.dt)))
        pel_warn(&run->totals.warnings, PEL_WARN_UNRESOLVED, frame,
                 loses ? pel_max(share_of_motion(ledger, run->totals.free_loss), TINY_SHARE) : 0);
}

void pel_warnings_check_end(pel_run_state *run)
{
    int64_t frame = run->totals.frame_count - 1;
    for (int32_t t = 0;
         t < run->tool_count && pel_stepper_knows_material(pel_stepper_of(run->scene->sim.solver.method)); t++) {
        int32_t count = pel_pressed_count(run, t);
        if (count > 0 && count < PEL_LEAST_CONTACTS)
            pel_warn(&run->totals.warnings, PEL_WARN_COARSE_CONTACT, frame, 0);
    }
    for (int32_t t = 0; t < run->tool_count; t++)
        if (pel_tool_is_idle(run, t))
            pel_warn(&run->totals.warnings, PEL_WARN_TOOL_IDLE, frame, -(double)t);
    if (run->intersection_count > 0 && (!run->scene->sim.contact.enabled || run->scene->contact_is_implied) &&
        run->scene->sim.solver.analysis == PEL_ANALYSIS_NONE)
        pel_warn(&run->totals.warnings, PEL_WARN_CROSSING, frame, (double)run->intersection_count);
    pel_warnings_check_loads(run);
    pel_warnings_check_bending(run, frame);
    pel_warnings_check_pressures(run, frame);
    check_rest(run, frame);
    pel_warnings_check_bodies_end(run, frame);
    pel_warnings_check_springs(run, frame);
    pel_warnings_check_hinges(run, frame);
    check_motion(run, frame);
    pel_warnings_check_vibrations(run);
    pel_warnings_check_balance(run, frame);
}

/* ---- texts ---- */

static void tell_softness(const pel_warning_text *at)
{
    const pel_scene *scene = at->run->scene;
    bool has_other = true;
    pel_solver_reading reading;
    pel_sim_get_solver(at->run->sim, &reading);
    for (int32_t b = 0; b < at->run->model->body_count; b++)
        has_other &= !pel_shell_needs_projection(at->run->model->bodies[b].shell);
    snprintf(
        at->text, at->size, "xpbd with %d substeps stretches up to %.3g times as far as the material. use %s >= %d%s%s",
        (int)reading.most_substeps, 1 + at->tally->worst, scene->sim.solver.substeps > 0 ? "substeps" : "max_substeps",
        (int)reading.needed_substeps, has_other ? ", or method implicit" : "",
        has_other && pel_scene_has_balls(scene) ? " without rigid.sphere" : "");
}

static const pel_flagged_body *flagged_of(const pel_warning_text *at, pel_warning_kind kind, const char **name)
{
    const pel_flagged_body *flagged = &at->run->flagged[kind];
    *name = at->run->scene->model.bodies[flagged->body].name;
    return flagged;
}

static void tell_coarseness(const pel_warning_text *at)
{
    const char *name;
    const pel_flagged_body *flagged = flagged_of(at, PEL_WARN_COARSE, &name);
    snprintf(at->text, at->size,
             "the edges of body '%s' are %.3g m long on average, but its shell bends within a length of sqrt(R h) = "
             "%.3g m. subdivide the mesh (pellicle subdivide -n %.0f), or use bodies.%s.refine",
             name, flagged->value, flagged->limit, pel_max(ceil(pel_log2(flagged->value / flagged->limit)), 1), name);
}

static void tell_open_seam(const pel_warning_text *at)
{
    const char *name;
    const pel_flagged_body *flagged = flagged_of(at, PEL_WARN_OPEN_SEAM, &name);
    snprintf(at->text, at->size,
             "body '%s' is open along %.0f edges where borders lie within %.2g m of each other and were not welded: "
             "they do not meet exactly, three or more meet there, or they run alike. weld the mesh: pellicle check "
             "FILE --fix OUT --tolerance %.2g",
             name, flagged->value, flagged->limit, flagged->limit);
}

static void tell_inverted_mesh(const pel_warning_text *at)
{
    const char *name;
    const pel_flagged_body *flagged = flagged_of(at, PEL_WARN_INVERTED_MESH, &name);
    snprintf(at->text, at->size,
             "the mesh of body '%s' is inside out: %.0f triangles were turned outward. turn them in the file with "
             "pellicle check --fix",
             name, flagged->value);
}

static void tell_held_in_place(const pel_warning_text *at)
{
    const char *name;
    const pel_flagged_body *flagged = flagged_of(at, PEL_WARN_HELD_IN_PLACE, &name);
    if (flagged->limit > 0) {
        snprintf(at->text, at->size,
                 "body '%s' does not sag under its weight: its volumetric springs hold each vertex near its rest "
                 "position, while a solid of their modulus, pinned so, would sag by more than a tenth of its length. "
                 "use volume: { young: %.4g } in place of springs and volumetric",
                 name, flagged->limit);
        return;
    }
    snprintf(at->text, at->size,
             "body '%s' does not move freely: its volumetric springs pull each vertex back to its rest position. for a "
             "body that falls or flies, omit volumetric and use a membrane, with pressure: { volume: { target: "
             "1, bulk: 1e5 } } if it is filled",
             name);
}

static void tell_inverted_volume(const pel_warning_text *at)
{
    snprintf(at->text, at->size,
             "a body turned inside out: its volume is %.3g times that at rest. use smaller loads, switch contact on, "
             "or stop earlier (stop: volume_ratio_below)",
             -at->tally->worst);
}

/* the first body that contact alone may hold; null if there is none */
static const char *free_body(const pel_warning_text *at, bool has_contact)
{
    const pel_model_def *model = &at->run->scene->model;
    for (int32_t b = 0; has_contact && b < model->body_count; b++)
        if (pel_sim_newton_is_free(at->run->sim, b))
            return model->bodies[b].name;
    return NULL;
}

/* implicit steps are divided before they fail; static steps have more iterations than they can use, and find equilibria
   that are near */
static void write_remedy(const pel_warning_text *at, bool has_contact, int32_t automatic, char *text, size_t size)
{
    const pel_solver_def *solver = &at->run->scene->sim.solver;
    const pel_stepper *stepper = pel_stepper_of(solver->method);
    const char *body = free_body(at, has_contact);
    if (solver->budget > 0)
        snprintf(text, size, "use a larger solver.budget");
    else if (at->run->totals.warnings.of[PEL_WARN_LARGEST_PRESSURE].count > 0)
        snprintf(text, size, "use a smaller pressure, or prescribe the volume");
    else if (stepper->divides && solver->iterations <= 0)
        snprintf(text, size, "use a smaller solver.dt");
    else if (stepper->is_static && body != NULL)
        snprintf(text, size,
                 "nothing but contact holds '%.40s': if it has to fall or slide before it rests, use method implicit "
                 "with solver.drag; otherwise use more steps (solver.steps)",
                 body);
    else if (stepper->is_static && solver->iterations <= 0)
        snprintf(text, size, "use more steps (solver.steps, with a duration a smaller solver.dt)");
    else
        snprintf(text, size, "use solver.iterations above %d",
                 (int)(solver->iterations > 0 ? solver->iterations : automatic));
}

static void tell_unconverged(const pel_warning_text *at)
{
    const pel_sim_def *sim = &at->run->scene->sim;
    if (pel_sim_get_path_end(at->run->sim) == PEL_PATH_END_LOST) {
        snprintf(
            at->text, at->size,
            "the path ends at load factor %.6g: even the shortest step finds no equilibrium beyond it. two paths may "
            "cross there (buckling): add an imperfection or a small load that selects one, or find the factor with "
            "analysis: buckling",
            pel_sim_load_factor(at->run->sim));
        return;
    }
    bool in_rounds = sim->tool_count > 0 || (sim->contact.enabled && sim->contact.response == PEL_CONTACT_IN_LOOP);
    char remedy[240];
    write_remedy(at, in_rounds, in_rounds ? PEL_ROUND_ITERATIONS : PEL_FREE_ITERATIONS, remedy, sizeof remedy);
    snprintf(at->text, at->size,
             "%" PRId64 " of %" PRId64 " steps did not converge: the residual is up to %.3g N%s. %s, or let "
             "loads and tools move over more steps",
             at->tally->count, pel_sim_step_count(at->run->sim), at->tally->worst,
             in_rounds ? ", or contacts are not settled" : "", remedy);
}

static void tell_unstable(const pel_warning_text *at)
{
    if (!pel_stepper_of(at->run->scene->sim.solver.method)->is_static) {
        snprintf(
            at->text, at->size,
            "the equilibrium at the end is unstable: the body buckles, but it and its loads are so symmetric that "
            "nothing pushes it aside. use the method static, or add an imperfection ({ mode: 1, amplitude: a tenth "
            "of the thickness }) or a small load that selects a direction");
        return;
    }
    bool is_path = pel_sim_path_kind(at->run->sim) == PEL_PATH_ARC_LENGTH;
    snprintf(at->text, at->size,
             "%" PRId64 " of %" PRId64
             " states are unstable equilibria: %s. %sadd an imperfection ({ mode: 1, amplitude: a "
             "tenth of the thickness }), or a small load that selects a direction",
             at->tally->count, pel_sim_step_count(at->run->sim),
             is_path ? "another path crosses this one (buckling), and leads on with less energy"
                     : "the body buckles, and no stable equilibrium was found near them",
             is_path ? "set solver.branch: lowest, " : "");
}

static void tell_loose(const pel_warning_text *at)
{
    int32_t body = pel_loose_body(at->run->sim);
    snprintf(
        at->text, at->size,
        "nothing holds a piece that cuts or tears have parted from body '%s': %s has no balance for it, and keeps it "
        "as it came off, with its stress. use the method implicit or xpbd, which let it move, pin a vertex of it, or "
        "end the run before (stop: { time: ... })",
        at->run->scene->model.bodies[body >= 0 ? body : 0].name, pel_method_words[at->run->scene->sim.solver.method]);
}

static void tell_stray(const pel_warning_text *at)
{
    const char *name;
    const pel_flagged_body *flagged = flagged_of(at, PEL_WARN_STRAY, &name);
    snprintf(at->text, at->size,
             "only contact holds body '%s', and it slid by %.3g m, farther than the tools moved: without friction it "
             "can rest at many positions. set contact.friction, pin it against sliding, or use the method implicit",
             name, flagged->value);
}

static const char *energy_remedy(const pel_run_state *run)
{
    const pel_sim_def *sim = &run->scene->sim;
    const pel_stepper *stepper = pel_stepper_of(sim->solver.method);
    /* far fewer than a damping of the material asks for make energy at any length of a step */
    if (stepper->is_compliant && run->totals.warnings.of[PEL_WARN_SOFT].count > 0)
        return "use the method implicit: the substeps are softer than the material";
    /* pairs that touch are found once a step: substeps do not add any */
    bool is_step = stepper->energy_remedy == NULL || (stepper->is_compliant && sim->contact.enabled);
    return is_step ? "use a smaller solver.dt" : stepper->energy_remedy;
}

static void tell_cut(const pel_warning_text *at)
{
    snprintf(at->text, at->size,
             "cut %.0f was held back in %" PRId64
             " steps, because its lips would have intersected. cut where the surface is not folded, or earlier",
             at->tally->worst + 1, at->tally->count);
}

static void tell_energy(const pel_warning_text *at)
{
    double supplied = at->run->ledger.supplied, worst = at->tally->worst;
    const char *remedy = energy_remedy(at->run);
    if (worst <= MOST_SHARE * supplied)
        snprintf(at->text, at->size, "%.3g J appeared: %.3g %% of the %.3g J that were supplied. %s", worst,
                 100 * worst / supplied, supplied, remedy);
    else
        snprintf(at->text, at->size, "%.3g J appeared, though only %.3g J were supplied. %s", worst, supplied, remedy);
}

static void tell_empty_grasp(const pel_warning_text *at)
{
    const pel_sim_def *def = &at->run->scene->sim;
    int32_t t = (int32_t)-pel_min(at->tally->worst, 0);
    snprintf(at->text, at->size,
             "the grasp of tool '%s' holds nothing in %" PRId64
             " steps: when it closed, no vertex was inside the tool or "
             "within grasp.reach of it. move the tool there before grasp.from, or raise grasp.reach",
             t < def->tool_count ? def->tools[t].name : "", at->tally->count);
}

static void tell_uncounted(const pel_warning_text *at)
{
    snprintf(at->text, at->size,
             "self-intersections at the end are not counted: too many triangles overlap, as around a vertex of "
             "thousands of triangles. divide the triangles around it in a mesh editor");
}

static void tell_crossing(const pel_warning_text *at)
{
    snprintf(at->text, at->size,
             "%s, and %.0f pairs of triangles intersect at the end. use contact: { self: true }, or pellicle check if "
             "the mesh intersects itself at rest",
             at->run->scene->contact_is_implied ? "nothing keeps parts of one body apart"
                                                : "nothing keeps the surfaces apart",
             at->tally->worst);
}

/* of the tool that is told, and of the bodies that it may touch */
static void tell_idle_tool(const pel_warning_text *at)
{
    const pel_scene *scene = at->run->scene;
    int32_t t = (int32_t)-pel_min(at->tally->worst, 0);
    if (t >= scene->sim.tool_count)
        t = 0;
    const pel_tool_def *tool = scene->sim.tool_count > 0 ? &scene->sim.tools[t] : NULL;
    double last[3] = {0}, rotation[4];
    if (tool != NULL)
        pel_tool_def_pose(tool, HUGE_VAL, last, rotation);
    const pel_body_def *body = &scene->model.bodies[tool != NULL && tool->body > 0 ? tool->body : 0];
    const char *pinned = tool != NULL ? pel_pinned_body_on_way(at->run, t) : NULL;
    double low[3], high[3];
    if (pinned != NULL) {
        snprintf(at->text, at->size,
                 "tool '%s' meets only vertices of body '%s' that are pinned, so its force is 0. pin fewer, or press "
                 "elsewhere",
                 tool->name, pinned);
        return;
    }
    pel_mesh_box(body->mesh, low, high);
    snprintf(
        at->text, at->size,
        "tool '%s' moves but touches nothing: its force is 0 throughout. its last position is (%.3g, %.3g, %.3g) m; "
        "body '%s' begins within (%.3g, %.3g, %.3g) to (%.3g, %.3g, %.3g) m. correct its motion or its size, or run "
        "longer",
        tool != NULL ? tool->name : "", last[0], last[1], last[2], body->name, low[0], low[1], low[2], high[0], high[1],
        high[2]);
}

static void tell_close_start(const pel_warning_text *at)
{
    const pel_start_gap *gap = &at->run->start_gap;
    char first[PEL_NAME_SIZE + 16], second[PEL_NAME_SIZE + 16];
    pel_contacts_name_group(at->run->sim, gap->groups[0], first, sizeof first);
    pel_contacts_name_group(at->run->sim, gap->groups[1], second, sizeof second);
    bool same = gap->groups[0] == gap->groups[1];
    snprintf(
        at->text, at->size,
        "%s%s%s%s start %.3g m apart, nearer than their contact thickness of %.3g m: contact pushes them apart. use "
        "contact: { thickness: %.3g }, or a larger gap",
        same ? "parts of " : "", first, same ? "" : " and ", same ? "" : second, gap->gap, gap->thickness, gap->gap);
}

static void tell_unsettled(const pel_warning_text *at)
{
    const pel_flagged_body *end = &at->run->flagged[PEL_WARN_UNSETTLED];
    int64_t before = at->tally->count - (end->limit > 0);
    size_t length = 0;
    if (before > 0)
        length =
            (size_t)snprintf(at->text, at->size,
                             "in %" PRId64 " of %" PRId64
                             " frames the body is not at rest under the tools: net forces are up to %.0f %% of "
                             "theirs, which are off by about as much. move tools more slowly, or use method "
                             "static%s",
                             before, at->run->totals.frame_count, 100 * at->tally->worst, end->limit > 0 ? ". " : "");
    if (end->limit > 0 && length < at->size)
        snprintf(at->text + length, at->size - length,
                 "the run ended before it settled: a net force of %.3g N remains, %.0f %% of the largest force. use a "
                 "longer duration, or method static",
                 end->value, 100 * end->limit);
}

/* most of the energy stayed, but not the frequency */
static void tell_coarse_steps(const pel_warning_text *at, double dt)
{
    const double steps = GOOD_STEPS * GOOD_ANGLE / at->run->flagged[PEL_WARN_UNRESOLVED].value;
    snprintf(
        at->text, at->size,
        "the steps do not resolve the motion: a vibration has %.2g of them, so that frequencies, phases and "
        "amplitudes are off. use solver: { method: implicit, dt: %.2g }, or drag if the state of rest is asked for",
        steps, dt);
}

/* s: a step of explicit that is stable, in a run that is not too long; 0 where there is none */
static double explicit_dt(const pel_run_state *run)
{
    pel_sim_def def = run->scene->sim;
    double dt;
    def.model = run->model;
    bool has = pel_sim_stable_dt(&def, &dt, NULL) == PEL_OK && dt > 0;
    return has && 1e-3 * pel_scene_substep_cost(run->scene) * run->scene->duration / dt < LONG_EXPLICIT ? dt : 0;
}

static bool is_viscous(const pel_scene *scene)
{
    bool any = false;
    for (int32_t b = 0; b < scene->model.body_count; b++)
        any |= pel_max(scene->model.bodies[b].shell.membrane.retardation,
                       scene->model.bodies[b].shell.bending.retardation) > 0;
    return any;
}

/* Motion that goes down to the size of the mesh, as in sheets that crumple or that wind feeds: implicit steps a quarter
   as long take nearly as much of it, and only those that are stable without damping resolve it; substeps of xpbd take
   as the inverse square of their number. */
static void write_fine_remedy(const pel_run_state *run, double good_dt, char *text, size_t size)
{
    const pel_stepper *stepper = pel_stepper_of(run->scene->sim.solver.method);
    const double dt = explicit_dt(run), kept = pel_max(run->ledger.supplied - run->totals.loss, run->ledger.tolerance);
    pel_solver_reading solver;
    pel_sim_get_solver(run->sim, &solver);
    if (dt > 0)
        snprintf(text, size, "the motion goes down to the size of the mesh: use solver: { method: explicit, dt: %.2g }",
                 pel_min(dt, run->scene->sim.solver.dt));
    else if (is_viscous(run->scene))
        snprintf(text, size,
                 "the motion goes down to the size of the mesh: use the method explicit, without the damping of the "
                 "material, which it does not have");
    else if (!stepper->minimises)
        snprintf(text, size, "use solver: { substeps: %.0f }",
                 ceil(solver.most_substeps * pel_max(2, sqrt(run->totals.loss / (LITTLE_LOSS * kept)))));
    else
        snprintf(text, size, "use solver: { method: implicit, dt: %.2g } or less", good_dt);
}

/* Implicit resolves a vibration that is known; where the stable step of explicit costs less, that does more. */
static void write_known_remedy(const pel_run_state *run, const pel_fastest_motion *motion, char *text, size_t size)
{
    const pel_scene *scene = run->scene;
    const double dt = explicit_dt(run), implicit = pel_scene_step_cost(scene) / motion->dt;
    if (dt > 0 && pel_scene_substep_cost(scene) / dt < implicit)
        snprintf(text, size,
                 "use solver: { method: explicit, dt: %.2g }, about %.2g s of one core (implicit with dt: "
                 "%.2g takes %.2g s)",
                 dt, 1e-3 * pel_scene_substep_cost(scene) * scene->duration / dt, motion->dt,
                 1e-3 * implicit * scene->duration);
    else
        snprintf(text, size, "use solver: { method: implicit, dt: %.2g }: %s", motion->dt, motion->reason);
}

/* a step that would do where a vibration or a load is known that is so fast */
static void tell_unresolved(const pel_warning_text *at)
{
    const pel_scene *scene = at->run->scene;
    const double dt = scene->sim.solver.dt, angle = at->run->flagged[PEL_WARN_UNRESOLVED].value;
    pel_motions motions;
    bool is_known = pel_scene_find_motions(scene, dt, 0, &motions) == PEL_OK && motions.fastest.dt < 0.25 * dt;
    const double good_dt = is_known ? motions.fastest.dt : 0.25 * dt;
    if (at->tally->worst == 0) {
        tell_coarse_steps(at, pel_min(good_dt, dt * GOOD_ANGLE / angle));
        return;
    }
    double whole = share_of_motion(&at->run->ledger, at->run->totals.loss);
    char part[40] = "", remedy[300];
    if (takes_in_contact(scene) && whole > TOUCH_SHARE * at->tally->worst)
        snprintf(part, sizeof part, ", %.2g %% while nothing touched", 100 * at->tally->worst);
    if (is_known)
        write_known_remedy(at->run, &motions.fastest, remedy, sizeof remedy);
    else
        write_fine_remedy(at->run, good_dt, remedy, sizeof remedy);
    snprintf(
        at->text, at->size,
        "little damps the motion, but the steps do not resolve it: the method has taken %.2g %% of the energy that "
        "was supplied%s. %s, or drag if the state of rest is asked for",
        100 * (part[0] != '\0' ? whole : at->tally->worst), part, remedy);
}

static void tell_row(const pel_warning_text *at)
{
    pel_warnings_tell_row(at->run, at->text, at->size);
}

static void tell_pressure(const pel_warning_text *at)
{
    pel_warnings_tell_pressure(at->run, at->text, at->size);
}

static void tell_load(const pel_warning_text *at)
{
    pel_warnings_tell_load(at->run, at->text, at->size);
}

static void tell_mode(const pel_warning_text *at)
{
    pel_warnings_tell_mode(at->run, at->text, at->size);
}

static void (*const tellers[PEL_WARN_COUNT])(const pel_warning_text *at) = {
    [PEL_WARN_SOFT] = tell_softness,
    [PEL_WARN_COARSE] = tell_coarseness,
    [PEL_WARN_MILLIMETRES] = pel_tell_millimetres,
    [PEL_WARN_POISSON] = pel_tell_poisson,
    [PEL_WARN_SPRING_NET] = pel_tell_springs,
    [PEL_WARN_HINGES] = pel_tell_hinges,
    [PEL_WARN_COARSE_VOLUME] = pel_tell_coarse_volume,
    [PEL_WARN_FAST_BLADE] = pel_tell_fast_blade,
    [PEL_WARN_WEIGHTLESS] = pel_tell_weightless,
    [PEL_WARN_HOLLOW] = pel_tell_hollow,
    [PEL_WARN_FALLS] = pel_tell_falls,
    [PEL_WARN_NOTHING] = pel_tell_nothing,
    [PEL_WARN_INVERTED_MESH] = tell_inverted_mesh,
    [PEL_WARN_HELD_IN_PLACE] = tell_held_in_place,
    [PEL_WARN_INVERTED_VOLUME] = tell_inverted_volume,
    [PEL_WARN_UNCONVERGED] = tell_unconverged,
    [PEL_WARN_UNSTABLE] = tell_unstable,
    [PEL_WARN_STRAY] = tell_stray,
    [PEL_WARN_LOOSE] = tell_loose,
    [PEL_WARN_ENERGY] = tell_energy,
    [PEL_WARN_JAMMED] = pel_tell_jam,
    [PEL_WARN_TOOL_HELD] = pel_tell_held_tool,
    [PEL_WARN_ESTIMATED] = pel_tell_estimated,
    [PEL_WARN_CUT_HELD] = tell_cut,
    [PEL_WARN_GRASP_LOST] = pel_tell_lost_grasp,
    [PEL_WARN_GRASP_EMPTY] = tell_empty_grasp,
    [PEL_WARN_TIE_LOST] = pel_tell_lost_tie,
    [PEL_WARN_UNCOUNTED] = tell_uncounted,
    [PEL_WARN_CROSSING] = tell_crossing,
    [PEL_WARN_COARSE_CONTACT] = pel_tell_coarse_contact,
    [PEL_WARN_TOOL_IDLE] = tell_idle_tool,
    [PEL_WARN_UNSETTLED] = tell_unsettled,
    [PEL_WARN_UNRESOLVED] = tell_unresolved,
    [PEL_WARN_OPEN_SEAM] = tell_open_seam,
    [PEL_WARN_CLOSE_START] = tell_close_start,
    [PEL_WARN_HINGE_ROW] = tell_row,
    [PEL_WARN_LARGEST_PRESSURE] = tell_pressure,
    [PEL_WARN_COARSE_LOAD] = tell_load,
    [PEL_WARN_COARSE_MODE] = tell_mode,
    [PEL_WARN_COARSE_BENDING] = pel_tell_coarse_bending,
};

/* J: positions are rounded in each substep, the velocity takes that over its length; layers lift what lies by a fall */
static double motion_noise(const pel_run_state *run)
{
    double mass = 0, farthest = 0, shortest = run->plan.dt, g = pel_vec3_length(run->scene->model.gravity);
    pel_solver_reading solver;
    pel_sim_get_solver(run->sim, &solver);
    shortest /= pel_max(solver.most_substeps, 1);
    for (int32_t v = 0; v < run->model->vertex_count; v++) {
        mass += (double)run->model->mass[v];
        for (int c = 0; c < 3; c++)
            farthest = pel_max(farthest, fabs((double)run->model->rest[v][c]));
    }
    double speed = ROUNDING_ERRORS * (double)PEL_REAL_EPSILON * farthest / shortest;
    return 0.5 * mass * (speed * speed * pel_sim_time(run->sim) / shortest + g * g * run->plan.dt * run->plan.dt);
}

/* Created energy is compared with all energy supplied until the end of the run. Steps of statics that converged are
   equilibria, whatever lies between them: there the ledger only shows that the work between them is that of the mean of
   both forces. */
static bool has_energy_appeared(const pel_run_state *run)
{
    const pel_warning_tally *tally = &run->totals.warnings.of[PEL_WARN_ENERGY];
    const pel_stepper *stepper = pel_stepper_of(run->scene->sim.solver.method);
    if (tally->count == 0 || !(tally->worst > run->ledger.tolerance))
        return false;
    if (stepper->is_static)
        return run->totals.warnings.of[PEL_WARN_UNCONVERGED].count > 0;
    return !stepper->has_velocity || tally->worst > EXCESS_SHARE * run->ledger.supplied + motion_noise(run);
}

static bool holds(const pel_run_state *run, pel_warning_kind kind)
{
    const pel_warning_tally *tally = &run->totals.warnings.of[kind];
    if (kind == PEL_WARN_COARSE || kind == PEL_WARN_HOLLOW)
        return tally->count > 0 && run->flagged[kind].limit > 0;
    /* checkpoints do not contain the body: it is found again while it is away */
    if (kind == PEL_WARN_STRAY)
        return tally->count > 0 && run->flagged[kind].value > 0;
    if (kind == PEL_WARN_JAMMED)
        return tally->count >= JAM_STEPS || (tally->count > 0 && tally->worst >= JAM_AT_ONCE);
    if (kind == PEL_WARN_ENERGY)
        return has_energy_appeared(run);
    if (kind == PEL_WARN_ESTIMATED)
        return tally->count > 0 && run->ledger.work_estimated > ESTIMATED_SHARE * run->ledger.supplied;
    return tally->count > 0;
}

int32_t pel_warnings_list(const pel_run_state *run, pel_run_warning *warnings)
{
    int32_t count = 0;
    for (int k = 0; k < PEL_WARN_COUNT; k++) {
        const pel_warning_tally *tally = &run->totals.warnings.of[k];
        if (!holds(run, (pel_warning_kind)k))
            continue;
        pel_run_warning *warning = &warnings[count++];
        *warning = (pel_run_warning){.code = codes[k], .first_frame = tally->first_frame, .count = tally->count};
        pel_warning_text at = {run, tally, warning->text, sizeof warning->text};
        tellers[k](&at);
    }
    return count;
}

/* known before the first step */
static bool is_of_scene(int kind)
{
    return kind == PEL_WARN_SOFT || kind == PEL_WARN_MILLIMETRES || kind == PEL_WARN_INVERTED_MESH ||
           kind == PEL_WARN_HELD_IN_PLACE || kind == PEL_WARN_CLOSE_START || kind == PEL_WARN_HINGE_ROW ||
           kind == PEL_WARN_OPEN_SEAM || kind == PEL_WARN_LARGEST_PRESSURE || kind == PEL_WARN_POISSON ||
           kind == PEL_WARN_WEIGHTLESS || kind == PEL_WARN_COARSE_VOLUME || kind == PEL_WARN_FAST_BLADE;
}

void pel_warnings_tell(pel_run_state *run, bool is_over)
{
    pel_run_warning warnings[PEL_RUN_WARNING_LIMIT];
    int32_t count = pel_warnings_list(run, warnings);
    for (int32_t i = 0; i < count; i++) {
        int kind = 0;
        while (codes[kind] != warnings[i].code)
            kind++;
        if (run->told[kind] || !(is_over || is_of_scene(kind)))
            continue;
        run->told[kind] = true;
        pel_log_line(run->def->warnings, "%s", warnings[i].text);
    }
}

_Static_assert((int)PEL_WARN_COUNT <= (int)PEL_RUN_WARNING_LIMIT, "the summary has room for one warning of each kind");
