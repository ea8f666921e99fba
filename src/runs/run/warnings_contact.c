/* Warnings about contact: jams, tools that were held back, grasps that lost vertices. */
#include "run/warnings_contact.h"

#include "geom/solid.h"
#include "math/extremes.h"
#include "math/functions.h"
#include "math/pose.h"
#include "math/record.h"
#include "math/vec3.h"
#include "mesh/figures.h"
#include "pellicle/sim_contact.h"
#include "run/state.h"
#include "scene/build.h"
#include "tool/tool.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* of the mean edge of a body: a thicker contact layer fills its folds */
#define THICK_SHARE 0.25
/* of the size of the first body, by which a tool is away from its keys at the end: it will not reach them */
#define LAG_SHARE 1e-3

/* ---- tools ---- */

/* the tool to which a state happened first, and how many others it happened to */
typedef struct first_tool {
    pel_tool_reading reading;
    const char *name;
    int32_t other_count;
} first_tool;

static bool is_before(double time, const first_tool *first, double first_time)
{
    return first->name == NULL || time < first_time;
}

static first_tool find_first_tool(const pel_sim *sim, bool lost)
{
    first_tool first = {.other_count = -1};
    for (int32_t t = 0; t < pel_sim_tool_count(sim); t++) {
        pel_tool_reading now;
        pel_sim_get_tool(sim, t, &now);
        if ((lost ? now.lost_count : now.held_back_count) == 0)
            continue;
        first.other_count++;
        if (is_before(lost ? now.lost_time : now.held_back_time, &first,
                      lost ? first.reading.lost_time : first.reading.held_back_time)) {
            first.reading = now;
            first.name = pel_sim_tool_name(sim, t);
        }
    }
    return first;
}

/* " (and 2 other tools)", or nothing */
static const char *others_text(const first_tool *first, char text[40])
{
    text[0] = '\0';
    if (first->other_count > 0)
        snprintf(text, 40, " (and %d other tool%s)", (int)first->other_count, first->other_count > 1 ? "s" : "");
    return text;
}

/* m, how far a tool is from where its keys are at present */
static double lag_of(const pel_run_state *run, const char *tool)
{
    const pel_sim_def *def = &run->scene->sim;
    for (int32_t t = 0; t < def->tool_count; t++) {
        double wanted[3], rotation[4];
        pel_tool_reading now;
        if (tool == NULL || strcmp(def->tools[t].name, tool) != 0 || def->tools[t].key_count == 0)
            continue;
        pel_tool_def_pose(&def->tools[t], pel_sim_time(run->sim), wanted, rotation);
        pel_sim_get_tool(run->sim, t, &now);
        return pel_vec3_distance(wanted, now.position);
    }
    return 0;
}

/* of the size of a body: a tool so far from it touches it */
#define NEAR_SHARE 1e-3
/* of a tool's motion, at which it is looked whether it is in pinned vertices */
enum { WAY_POINTS = 64 };

/* how many of these vertices, all if null, are inside a tool where its keys lead it by now */
static int32_t count_in(const pel_tool_def *tool, double time, const pel_mesh *mesh, const int32_t *vertices,
                        int32_t count)
{
    const pel_solid solid = pel_solid_of(tool);
    double position[3], rotation[4], normal[3], p[3];
    int32_t inside = 0;
    pel_tool_def_pose(tool, time, position, rotation);
    for (int32_t i = 0; i < count; i++) {
        pel_vec3_subtract(mesh->positions[vertices != NULL ? vertices[i] : i], position, p);
        pel_rotate_back(rotation, p, p);
        inside += pel_solid_distance(&solid, p, normal) < 0;
    }
    return inside;
}

/* the body of which a tool holds pinned vertices alone at that time, or null */
static const char *pinned_body_at(const pel_run_state *run, int32_t t, double time)
{
    const pel_model_def *model = &run->scene->model;
    const pel_tool_def *tool = &run->scene->sim.tools[t];
    const char *name = NULL;
    for (int32_t b = 0; b < model->body_count && tool->shape != PEL_TOOL_MESH; b++) {
        const pel_body_def *body = &model->bodies[b];
        int32_t pinned = count_in(tool, time, body->mesh, body->pinned, body->pinned_count);
        if (tool->body >= 0 && tool->body != b)
            continue;
        if (pinned < count_in(tool, time, body->mesh, NULL, body->mesh->vertex_count))
            return NULL;
        name = name == NULL && pinned > 0 ? body->name : name;
    }
    return name;
}

/* the first body of which a tool meets pinned vertices alone between two times, or null */
static const char *pinned_body_between(const pel_run_state *run, int32_t t, double from, double to)
{
    const char *name = NULL;
    for (int i = 0; i <= WAY_POINTS && name == NULL; i++)
        name = pinned_body_at(run, t, from + (to - from) * i / WAY_POINTS);
    return name;
}

const char *pel_pinned_body_on_way(const pel_run_state *run, int32_t t)
{
    return pinned_body_between(run, t, 0, pel_sim_time(run->sim));
}

/* within a thousandth of the size of a body from its surface; a mesh never is */
static bool is_at_surface(const pel_run_state *run, int32_t t)
{
    const pel_solid solid = pel_solid_of(&run->scene->sim.tools[t]);
    const pel_model *model = run->sim->model;
    bool any = false;
    pel_tool_reading pose;
    pel_sim_get_tool(run->sim, t, &pose);
    for (int32_t b = 0; b < model->body_count && pel_solid_rows[run->scene->sim.tools[t].shape].depth != NULL; b++) {
        const pel_solid grown = pel_solid_grown(&solid, NEAR_SHARE * model->bodies[b].diameter);
        for (int32_t i = model->triangle_begin[b]; i < model->triangle_begin[b + 1] && !any; i++) {
            double x[3][3], weights[3], normal[3];
            for (int c = 0; c < 3; c++) {
                pel_vertex_position(run->sim->state->position, model->triangles[i][c], x[c]);
                pel_vec3_subtract(x[c], pose.position, x[c]);
                pel_rotate_back(pose.rotation, x[c], x[c]);
            }
            any = pel_solid_depth(&grown, x[0], x[1], x[2], weights, normal) > 0;
        }
    }
    return any;
}

bool pel_tool_is_idle(const pel_run_state *run, int32_t t)
{
    const pel_tool_def *tool = &run->scene->sim.tools[t];
    pel_tool_reading reading;
    pel_sim_get_tool(run->sim, t, &reading);
    return tool->press && !tool->grasp && tool->shape != PEL_TOOL_SUPPORT && tool->key_count > 1 &&
           reading.held_back_count == 0 && !(run->tool_force[run->tool_count + t] > 0) &&
           (!is_at_surface(run, t) || pel_pinned_body_on_way(run, t) != NULL);
}

/* the body whose pinned vertices alone were in the way of a tool when it was first held back, or null */
static const char *pinned_body_of(const pel_run_state *run, const first_tool *first)
{
    const double time = first->reading.held_back_time, dt = run->scene->sim.solver.dt;
    for (int32_t t = 0; first->name != NULL && t < run->scene->sim.tool_count; t++)
        if (strcmp(run->scene->sim.tools[t].name, first->name) == 0)
            return pinned_body_between(run, t, time - 2 * dt, time + dt);
    return NULL;
}

void pel_tell_held_tool(const pel_warning_text *at)
{
    char others[40], remedy[200];
    first_tool first = find_first_tool(at->run->sim, false);
    double lag = lag_of(at->run, first.name);
    const char *pinned = pinned_body_of(at->run, &first);
    if (pinned != NULL)
        snprintf(remedy, sizeof remedy,
                 "its keys lead it into vertices of body '%.60s' that are all pinned: pin fewer, or press elsewhere",
                 pinned);
    else if (lag > LAG_SHARE * pel_mesh_diagonal(at->run->scene->model.bodies[0].mesh))
        snprintf(remedy, sizeof remedy, "it ends %.3g m away from its keys: let them lead less far, or around the body",
                 lag);
    else
        snprintf(remedy, sizeof remedy, "it caught up with its keys: move it more slowly");
    snprintf(at->text, at->size,
             "tool '%s'%s was held back in %" PRId64
             " steps, first at t = %.6g s, because it trapped a body; its force "
             "is unknown where %s_force_known in series.csv is 0. %s",
             first.name, others_text(&first, others), first.reading.held_back_count, first.reading.held_back_time,
             first.name, remedy);
}

void pel_tell_estimated(const pel_warning_text *at)
{
    const pel_sim_ledger *ledger = &at->run->ledger;
    snprintf(
        at->text, at->size,
        "%.3g J of the work of tools, for %.3g J that were supplied, are not measured: in steps in which the force "
        "of a tool was not known they are what closed the energy balance, with any energy that contact made. move "
        "tools that trap a body less far or more slowly",
        ledger->work_estimated, ledger->supplied);
}

/* a limit of its force by the scene, not by the material */
static const pel_tool_def *find_def(const pel_run_state *run, const char *tool)
{
    const pel_sim_def *def = &run->scene->sim;
    for (int32_t t = 0; t < def->tool_count; t++)
        if (tool != NULL && strcmp(def->tools[t].name, tool) == 0)
            return &def->tools[t];
    return NULL;
}

/* of vertices that follow an animation */
static void tell_lost_follow(const pel_warning_text *at, const first_tool *first, const pel_tool_def *def)
{
    char others[40];
    snprintf(at->text, at->size,
             "the animation '%s'%s let %" PRId64 " vertices go at t = %.6g s%s: their forces exceeded %.3g N, its "
             "strength. if they should follow on, raise bodies.%s.follow.strength",
             first->name, others_text(first, others), first->reading.lost_count, first->reading.lost_time,
             at->tally->count > 1 ? " and later" : "", first->reading.lost_limit,
             at->run->scene->model.bodies[def->body].name);
}

void pel_tell_lost_grasp(const pel_warning_text *at)
{
    char others[40], why[120];
    first_tool first = find_first_tool(at->run->sim, true);
    double limit = first.reading.lost_limit;
    const pel_tool_def *def = find_def(at->run, first.name);
    if (def != NULL && def->strength > 0) {
        tell_lost_follow(at, &first, def);
        return;
    }
    if (limit > 0)
        snprintf(why, sizeof why, "their forces exceeded %.3g N, %s", limit,
                 def != NULL && def->grasp_max_force > 0 ? "its max_force" : "what the material bears there");
    else
        snprintf(why, sizeof why, "contact had stopped it, and no force would have moved it on");
    snprintf(at->text, at->size,
             "tool '%s'%s lost %" PRId64 " vertices at t = %.6g s%s: %s. %s, or set tools.%s.max_force%s", first.name,
             others_text(&first, others), first.reading.lost_count, first.reading.lost_time,
             at->tally->count > 1 ? " and later" : "", why,
             limit > 0 ? "pull more slowly, raise grasp.reach" : "move it around the body", first.name,
             limit > 0 ? " higher" : " to hold on");
}

static const char *tie_kind(pel_tie_target target)
{
    if (target == PEL_TIE_SEQUENCE)
        return "spring of the animation";
    return target == PEL_TIE_VERTICES ? "stitch" : "attachment";
}

/* of the first one; the count is of all */
void pel_tell_lost_tie(const pel_warning_text *at)
{
    const pel_sim *sim = at->run->sim;
    pel_tie_reading first = {.lost_count = 0}, now;
    int32_t which = 0, others = 0;
    for (int32_t t = 0; t < pel_sim_tie_count(sim); t++) {
        pel_sim_get_tie(sim, t, &now);
        if (now.lost_count == 0)
            continue;
        others += first.lost_count > 0;
        if (first.lost_count > 0 && !(now.lost_time < first.lost_time))
            continue;
        first = now;
        which = t;
    }
    char more[40] = "";
    if (others > 0)
        snprintf(more, sizeof more, " (and %d other%s)", (int)others, others > 1 ? "s" : "");
    const pel_tie_def *def = &at->run->scene->sim.ties[which];
    snprintf(
        at->text, at->size,
        "%s '%s'%s let %d of %d vertices go, the first at t = %.6g s under %.3g N, more than its strength of %.3g N. "
        "if it should hold, raise strength, or tie more vertices",
        tie_kind(def->target), pel_sim_tie_name(sim, which), more, (int)first.lost_count, (int)def->vertex_count,
        first.lost_time, first.lost_force, def->strength);
}

/* ---- coarse contact ---- */

/* meshes of shells that became finer there have edges for a point of contact: few vertices are enough, as of what is
   rigid */
static bool is_fine(const pel_run_state *run, int32_t t)
{
    bool is_fine = true, is_rigid = false;
    for (int32_t b = 0; b < run->scene->model.body_count; b++)
        if (run->scene->sim.tools[t].body < 0 || run->scene->sim.tools[t].body == b) {
            is_fine &= pel_scene_is_fine(run->scene, b);
            is_rigid |= run->scene->model.bodies[b].rigid.on;
        }
    return is_fine || is_rigid;
}

int32_t pel_pressed_count(const pel_run_state *run, int32_t t)
{
    const pel_tool_def *tool = &run->scene->sim.tools[t];
    bool presses =
        !tool->grasp && !is_fine(run, t) && tool->shape < PEL_TOOL_SUPPORT && run->tool_force[run->tool_count + t] > 0;
    return presses ? (int32_t)run->tool_force[2 * run->tool_count + t] : 0;
}

/* the tool that touched the fewest vertices */
static int32_t find_coarsest(const pel_run_state *run)
{
    int32_t coarsest = 0, least = INT32_MAX;
    for (int32_t t = 0; t < run->tool_count; t++) {
        int32_t count = pel_pressed_count(run, t);
        if (count > 0 && count < least) {
            least = count;
            coarsest = t;
        }
    }
    return coarsest;
}

static double mean_edge(const pel_mesh *mesh)
{
    double sum = 0;
    for (int32_t t = 0; t < mesh->triangle_count; t++)
        for (int i = 0; i < 3; i++)
            sum += pel_vec3_distance(mesh->positions[mesh->triangles[t][i]],
                                     mesh->positions[mesh->triangles[t][(i + 1) % 3]]);
    return sum / (3.0 * mesh->triangle_count);
}

/* a level has four times the vertices */
static void write_refinement(const pel_run_state *run, int32_t contacts, char *text, size_t size)
{
    const pel_body_def *body = &run->scene->model.bodies[0];
    int levels = contacts > 0 ? (int)ceil(pel_log2(2.0 * PEL_LEAST_CONTACTS / contacts) / 2) : 1;
    bool bends = body->shell.membrane.on && body->shell.bending.model != PEL_BENDING_NONE;
    if (run->scene->model.body_count > 1)
        snprintf(
            text, size,
            "refine the body that it touches (refine: auto for shells and solids, near_tools for tissue), or use a "
            "finer mesh");
    else if (body->volume.on)
        snprintf(text, size, "use bodies.%s.refine=auto, which is within 3 %%, or bodies.%s.volume.edge=%.2g",
                 body->name, body->name,
                 mean_edge(body->mesh) * (contacts > 0 ? sqrt(contacts / (1.25 * PEL_LEAST_CONTACTS)) : 0.5));
    else if (bends && body->refine.levels == 0)
        snprintf(text, size, "use bodies.%s.refine=auto, or a finer mesh", body->name);
    else if (body->refine.levels > 0)
        snprintf(text, size, "use bodies.%s.refine.levels=%d%s", body->name, (int)body->refine.levels + levels,
                 body->refine.near_tools > 0 ? "" : ", with near_tools");
    else
        snprintf(text, size, "use bodies.%s.refine='{ levels: %d, near_tools: %.2g }', or a finer mesh", body->name,
                 levels, 2.5 * mean_edge(body->mesh));
}

void pel_tell_coarse_contact(const pel_warning_text *at)
{
    char remedy[200];
    int32_t t = find_coarsest(at->run), contacts = at->run->tool_count > 0 ? pel_pressed_count(at->run, t) : 0;
    write_refinement(at->run, contacts, remedy, sizeof remedy);
    snprintf(at->text, at->size,
             "tool '%s' touches %d vertices where its force is largest; with fewer than %d the force depends on the "
             "mesh. %s",
             at->run->tool_count > 0 ? at->run->scene->sim.tools[t].name : "", (int)contacts, (int)PEL_LEAST_CONTACTS,
             remedy);
}

/* ---- jams ---- */

/* a body whose law lets triangles collapse in their plane; -1 = none */
static int32_t find_collapsing(const pel_run_state *run)
{
    for (int32_t b = 0; b < run->scene->model.body_count; b++) {
        const pel_membrane_def *membrane = &run->scene->model.bodies[b].shell.membrane;
        bool collapses = membrane->kind == PEL_MEMBRANE_STVK || membrane->kind == PEL_MEMBRANE_LINEAR ||
                         membrane->kind == PEL_MEMBRANE_COROTATED;
        if (membrane->on && collapses)
            return b;
    }
    return -1;
}

/* a body with a contact thickness that fills its folds; -1 = none */
static int32_t find_thick(const pel_run_state *run)
{
    for (int32_t b = 0; b < run->scene->model.body_count; b++)
        if (pel_sim_body_contact_thickness(run->sim, b) > THICK_SHARE * mean_edge(run->scene->model.bodies[b].mesh))
            return b;
    return -1;
}

/* names the cause: a tool, else a law, else a thickness, else the step length */
static void write_fault(const pel_run_state *run, char *text, size_t size)
{
    const pel_body_def *bodies = run->scene->model.bodies;
    first_tool tool = find_first_tool(run->sim, false);
    int32_t collapsing = find_collapsing(run), thick = find_thick(run);
    if (tool.name != NULL)
        snprintf(text, size, "tool '%s' presses them together: move it less far, or more slowly", tool.name);
    else if (collapsing >= 0)
        snprintf(text, size,
                 "the law of body '%s' does not keep its triangles from collapsing: use membrane: { material: "
                 "neo-hookean }",
                 bodies[collapsing].name);
    else if (thick >= 0)
        snprintf(text, size, "the contact thickness of body '%s' fills its folds: use contact: { thickness: %.2g }",
                 bodies[thick].name, 0.5 * THICK_SHARE * mean_edge(bodies[thick].mesh));
    else
        snprintf(text, size, "use a smaller solver.dt, or slower loads");
}

void pel_tell_jam(const pel_warning_text *at)
{
    char fault[240];
    write_fault(at->run, fault, sizeof fault);
    snprintf(at->text, at->size,
             "contact stepped back up to %.0f %% of all vertices, and in %" PRId64
             " steps at least a tenth: bodies are jammed. %s",
             100 * at->tally->worst, at->tally->count, fault);
}

/* ---- fast blades ---- */

/* of an edge in a step: with 0.14 the work of the blade is within 4 % of the energy of its cut, with 1.4 it is 3 to 12
   times as much (docs/cuts.md) */
#define BLADE_SHARE 0.25

typedef struct fast_blade {
    const char *tool, *body;
    double share; /* of an edge, in a step */
} fast_blade;

/* m/s, between two of its keys */
static double greatest_speed(const pel_tool_def *tool)
{
    double speed = 0;
    for (int32_t k = 1; k < tool->key_count; k++) {
        const pel_pose_key *a = &tool->keys[k - 1], *b = &tool->keys[k];
        if (b->time > a->time)
            speed = pel_max(speed, pel_vec3_distance(a->position, b->position) / (b->time - a->time));
    }
    return speed;
}

static fast_blade find_fast_blade(const pel_run_state *run)
{
    const pel_scene *scene = run->scene;
    fast_blade fastest = {NULL, NULL, 0};
    for (int32_t t = 0; t < scene->sim.tool_count; t++) {
        const pel_tool_def *tool = &scene->sim.tools[t];
        const double way = greatest_speed(tool) * scene->sim.solver.dt;
        for (int32_t b = 0; b < scene->model.body_count && tool->shape == PEL_TOOL_BLADE && tool->sharpness > 0; b++) {
            const double share = way / mean_edge(scene->model.bodies[b].mesh);
            if ((tool->body < 0 || tool->body == b) && share > fastest.share)
                fastest = (fast_blade){tool->name, scene->model.bodies[b].name, share};
        }
    }
    return fastest;
}

void pel_warnings_check_blades(pel_run_state *run)
{
    const fast_blade fastest = find_fast_blade(run);
    if (fastest.share > BLADE_SHARE)
        pel_warn(&run->totals.warnings, PEL_WARN_FAST_BLADE, 0, fastest.share);
}

void pel_tell_fast_blade(const pel_warning_text *at)
{
    const fast_blade fastest = find_fast_blade(at->run);
    snprintf(
        at->text, at->size,
        "blade '%s' moves by %.2g edges of body '%s' in a step, and a cut under a force opens one edge in a step at "
        "most: its force and work are too large. use solver: { dt: %.2g }, move it more slowly, or omit sharpness",
        fastest.tool, fastest.share, fastest.body, at->run->scene->sim.solver.dt * 0.5 * BLADE_SHARE / fastest.share);
}
