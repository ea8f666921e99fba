/* Warnings about bodies: what they are made of, what fills them, and whether anything acts on them. */
#include "run/warnings_bodies.h"

#include "geom/solid.h"
#include "math/bounds.h"
#include "math/extremes.h"
#include "math/pose.h"
#include "math/vec3.h"
#include "mesh/figures.h"
#include "model/model.h"
#include "model/quantity.h"
#include "pellicle/tear.h"
#include "run/state.h"

#include <math.h>
#include <stdio.h>

/* thickness over size from which a shell of more than 20 m, or of more than a metre, is probably in millimetres */
#define THIN_SHARE 1e-4
#define THINNEST_SHARE 2e-6
#define THINNEST_SIZE 1.0
/* thickness over size from which no body is a shell */
#define SOLID_SHARE 0.25
/* Pa: nobody makes shells of more than 20 m of rubber or tissue */
#define SOFT_YOUNG 1e8
/* m: organs are smaller */
#define LARGE_ORGAN 5.0
/* of the size of a body: motion below is rounding */
#define STILL_SHARE 1e-9
/* sizes of the scene that a body may go, and one that a tool was to stop */
#define FALL_SIZES 10
#define MISS_SIZES 2
/* kg/m3, of the filling that a text proposes */
#define WATER 1000.0
/* of a filling of water: a body that weighs more is filled, of fat for example */
#define FILLED_SHARE 0.8

static double mean_of(const pel_quantity *quantity, const pel_body_def *body)
{
    return pel_quantity_mean(quantity, body->mesh->vertex_count);
}

static bool has_volumetric(const pel_body_def *body)
{
    return body->volumetric_stiffness.key_count > 0 || mean_of(&body->volumetric_stiffness, body) > 0;
}

void pel_warn_body(pel_run_state *run, pel_warning_kind kind, int32_t b, double value, double limit)
{
    if (run->totals.warnings.of[kind].count == 0)
        run->flagged[kind] = (pel_flagged_body){b, value, limit};
    pel_warn(&run->totals.warnings, kind, 0, value);
}

/* ---- the scene ---- */

static void check_size(pel_run_state *run, int32_t b)
{
    const pel_body_def *body = &run->scene->model.bodies[b];
    const pel_membrane_def *membrane = &body->shell.membrane;
    double size = pel_mesh_diagonal(body->mesh), share = mean_of(&membrane->thickness, body) / size;
    bool is_thin = (size > PEL_LARGE_BODY && (share <= THIN_SHARE || mean_of(&membrane->young, body) < SOFT_YOUNG)) ||
                   (size > THINNEST_SIZE && share <= THINNEST_SHARE);
    if (membrane->on ? is_thin || share > SOLID_SHARE : size > LARGE_ORGAN)
        pel_warn_body(run, PEL_WARN_MILLIMETRES, b, size, 0);
}

/* an isotropic solid has at most 0.5 */
static void check_poisson(pel_run_state *run, int32_t b)
{
    const pel_body_def *body = &run->scene->model.bodies[b];
    double poisson = body->shell.membrane.poisson;
    if (body->shell.membrane.on && poisson > 0.5)
        pel_warn_body(run, PEL_WARN_POISSON, b, poisson, 0.5);
}

/* gravity acts on the skin alone */
static void check_filling(pel_run_state *run, int32_t b)
{
    const pel_model_def *model = &run->scene->model;
    const pel_body *body = &run->model->bodies[b];
    if (model->bodies[b].fluid_density > 0 || model->bodies[b].shell.pressure.kind != PEL_PRESSURE_VOLUME ||
        !(pel_vec3_length(model->gravity) > 0))
        return;
    double mass = 0, filling = WATER * fabs(body->rest_volume);
    for (int32_t i = body->slice_begin * PEL_WIDTH; i < body->slice_end * PEL_WIDTH; i++)
        mass += (double)run->model->mass[i];
    if (mass < FILLED_SHARE * filling)
        pel_warn_body(run, PEL_WARN_WEIGHTLESS, b, mass, mass + filling);
}

/* a skin of springs with nothing in it: whether it collapses is seen in the frames */
static bool is_hollow(const pel_run_state *run, int32_t b)
{
    const pel_body_def *body = &run->scene->model.bodies[b];
    return run->model->bodies[b].has_volume && body->spring_thickness > 0 && !body->shell.membrane.on &&
           body->shell.pressure.kind == PEL_PRESSURE_NONE && !(body->fluid_density > 0) && !has_volumetric(body);
}

void pel_warnings_check_body(pel_run_state *run, int32_t b)
{
    check_size(run, b);
    check_poisson(run, b);
    check_filling(run, b);
    if (is_hollow(run, b) && !(run->flagged[PEL_WARN_HOLLOW].limit > 0))
        run->flagged[PEL_WARN_HOLLOW] = (pel_flagged_body){b, 0, 1};
}

/* ---- the end ---- */

/* the box of the scene: bodies at rest and the ways of tools */
static double scene_size(const pel_scene *scene)
{
    double low[3], high[3];
    pel_bounds_clear(low, high);
    for (int32_t b = 0; b < scene->model.body_count; b++)
        pel_mesh_add_box(scene->model.bodies[b].mesh, low, high);
    for (int32_t t = 0; t < scene->sim.tool_count; t++)
        for (int32_t k = 0; k < scene->sim.tools[t].key_count; k++)
            pel_bounds_add(low, high, scene->sim.tools[t].keys[k].position);
    return pel_vec3_distance(low, high);
}

/* adds m from the mean of the vertices of the mesh at rest to that at present, and its place */
static void add_way(const pel_run_state *run, int32_t b, double way[3], double now[3])
{
    const pel_mesh *mesh = run->scene->model.bodies[b].mesh;
    const pel_model *model = run->sim->model;
    double x[3];
    for (int32_t i = model->bodies[b].slice_begin * PEL_WIDTH; i < model->bodies[b].slice_end * PEL_WIDTH; i++) {
        const int32_t v = model->mesh_vertex[i];
        if (v < 0 || v >= mesh->vertex_count)
            continue;
        pel_vertex_position(run->sim->state->position, i, x);
        pel_vec3_along(now, 1.0 / mesh->vertex_count, x, now);
        pel_vec3_subtract(x, mesh->positions[v], x);
        pel_vec3_along(way, 1.0 / mesh->vertex_count, x, way);
    }
}

/* a load that neither ends nor fades pushes the body */
static bool is_pushed(const pel_scene *scene, int32_t b)
{
    bool is = false;
    for (int32_t i = 0; i < scene->sim.load_count; i++) {
        const pel_load_def *load = &scene->sim.loads[i];
        is |= load->body == b && isinf(load->until) && load->key_count == 0 && pel_vec3_length(load->force) > 0;
    }
    return is;
}

/* along a unit vector, the end of all tools that bodies land on, or miss; negative and infinite without any */
static double find_bottom(const pel_scene *scene, const double down[3])
{
    double bottom = -HUGE_VAL, position[3], rotation[4];
    for (int32_t t = 0; t < scene->sim.tool_count; t++) {
        const pel_tool_def *tool = &scene->sim.tools[t];
        for (int32_t k = 0; tool->press && tool->shape != PEL_TOOL_SUPPORT && k < tool->key_count; k++) {
            pel_tool_def_pose(tool, tool->keys[k].time, position, rotation);
            bottom = pel_max(bottom, pel_vec3_dot(position, down) + pel_tool_def_reach(tool, rotation, down));
        }
    }
    return bottom;
}

/* What has gone far beside or down a tool, as a ball that rolls does, falls once it is below all of them. */
static void check_falls(pel_run_state *run, int64_t frame)
{
    const pel_model_def *model = &run->scene->model;
    double down[3];
    pel_vec3_copy(model->gravity, down);
    const bool falls = pel_vec3_normalize(down) > 0;
    const double size = scene_size(run->scene), bottom = falls ? find_bottom(run->scene, down) : -HUGE_VAL;
    const double most = bottom > -HUGE_VAL ? MISS_SIZES : FALL_SIZES;
    for (int32_t b = 0; b < model->body_count; b++) {
        double shift[3] = {0}, now[3] = {0};
        add_way(run, b, shift, now);
        const double way = falls ? pel_vec3_dot(shift, down) : is_pushed(run->scene, b) ? pel_vec3_length(shift) : 0;
        if (!(way >= most * size) || pel_vec3_dot(now, down) < bottom || pel_vec3_length(model->bodies[b].velocity) > 0)
            continue;
        if (run->totals.warnings.of[PEL_WARN_FALLS].count == 0)
            run->flagged[PEL_WARN_FALLS] = (pel_flagged_body){b, way, size};
        pel_warn(&run->totals.warnings, PEL_WARN_FALLS, frame, way);
    }
}

/* the least diagonal of a body */
static double least_size(const pel_scene *scene)
{
    double least = HUGE_VAL;
    for (int32_t b = 0; b < scene->model.body_count; b++)
        least = pel_min(least, pel_mesh_diagonal(scene->model.bodies[b].mesh));
    return least;
}

/* a cut in a sheet without stress moves nothing */
static bool is_cut(const pel_run_state *run)
{
    pel_cut_reading cuts;
    return pel_sim_get_cuts(run->sim, -1, &cuts, NULL) == PEL_OK && cuts.length > 0;
}

/* A tool that touches nothing has a warning of its own, and so have one that is held back and steps that failed. */
static void check_action(pel_run_state *run, int64_t frame)
{
    double most = pel_run_max_displacement(run);
    bool is_still = run->ledger.supplied <= run->ledger.tolerance && most <= STILL_SHARE * least_size(run->scene);
    const pel_warning_tally *tallies = run->totals.warnings.of;
    bool is_idle = tallies[PEL_WARN_TOOL_IDLE].count > 0 || tallies[PEL_WARN_TOOL_HELD].count > 0 ||
                   tallies[PEL_WARN_UNCONVERGED].count > 0;
    if (is_still && !is_idle && !is_cut(run) && run->session == NULL && pel_sim_analysis(run->sim) == PEL_ANALYSIS_NONE)
        pel_warn(&run->totals.warnings, PEL_WARN_NOTHING, frame, 0);
}

void pel_warnings_check_bodies_end(pel_run_state *run, int64_t frame)
{
    check_falls(run, frame);
    check_action(run, frame);
}

/* ---- texts ---- */

static const pel_flagged_body *flagged_of(const pel_warning_text *at, pel_warning_kind kind, const char **name)
{
    const pel_flagged_body *flagged = &at->run->flagged[kind];
    *name = at->run->scene->model.bodies[flagged->body].name;
    return flagged;
}

void pel_tell_millimetres(const pel_warning_text *at)
{
    const char *name;
    const pel_flagged_body *flagged = flagged_of(at, PEL_WARN_MILLIMETRES, &name);
    const pel_body_def *body = &at->run->scene->model.bodies[flagged->body];
    const double thick = mean_of(&body->shell.membrane.thickness, body);
    char thickness[80] = "";
    if (body->shell.membrane.on && thick > SOLID_SHARE * flagged->value) {
        snprintf(at->text, at->size,
                 "body '%s' is %.3g m across, and its shell %.3g m thick: that is no shell. if the thickness is in "
                 "millimetres, write membrane: { ..., thickness: %.3g }; a solid body has a `volume`",
                 name, flagged->value, thick, 1e-3 * thick);
        return;
    }
    if (body->shell.membrane.on)
        snprintf(thickness, sizeof thickness, ", and its shell %.3g m thick", thick);
    snprintf(at->text, at->size,
             "body '%s' is %.4g m across%s. if its mesh is in millimetres, write mesh: { ..., "
             "scale: 0.001 }",
             name, flagged->value, thickness);
}

void pel_tell_poisson(const pel_warning_text *at)
{
    const char *name;
    const pel_flagged_body *flagged = flagged_of(at, PEL_WARN_POISSON, &name);
    snprintf(at->text, at->size,
             "Poisson's ratio of body '%s' is %.3g: an isotropic solid has at most 0.5, which is incompressible. use "
             "bodies.%s.membrane.poisson=0.5 or less, unless it is a sheet that is no solid, such as a net",
             name, flagged->value, name);
}

void pel_tell_weightless(const pel_warning_text *at)
{
    const char *name;
    const pel_flagged_body *flagged = flagged_of(at, PEL_WARN_WEIGHTLESS, &name);
    snprintf(at->text, at->size,
             "the filling of body '%s' has no weight: gravity acts on its skin of %.3g kg. with water in it use "
             "fluid: {}, which presses by depth, or mass: { total: %.4g }",
             name, flagged->value, flagged->limit);
}

void pel_tell_hollow(const pel_warning_text *at)
{
    const char *name;
    flagged_of(at, PEL_WARN_HOLLOW, &name);
    snprintf(at->text, at->size,
             "nothing fills body '%s': it is a skin of springs, and it collapsed to %.2g of its volume. fill it: "
             "volumetric: {} if it is pinned or held, pressure: { volume: { target: 1, bulk: 1e5 } } if it lies or "
             "falls",
             name, -at->tally->worst);
}

void pel_tell_falls(const pel_warning_text *at)
{
    const char *name;
    const pel_flagged_body *flagged = flagged_of(at, PEL_WARN_FALLS, &name);
    const bool falls = pel_vec3_length(at->run->scene->model.gravity) > 0;
    snprintf(at->text, at->size,
             "body '%s' %s %.3g m, %.0f times the size of the scene: nothing holds it. pin it, put a tool %s it, "
             "or use a shorter duration",
             name, falls ? "fell" : "was pushed", flagged->value, flagged->value / flagged->limit,
             falls ? "under" : "before");
}

/* a load that begins later; null if there is none */
static const pel_load_def *late_load(const pel_run_state *run)
{
    for (int32_t i = 0; i < run->scene->sim.load_count; i++)
        if (run->scene->sim.loads[i].from >= pel_sim_time(run->sim))
            return &run->scene->sim.loads[i];
    return NULL;
}

/* the body with a liquid, where there is no gravity; null if there is none */
static const char *weightless_fluid(const pel_run_state *run)
{
    const pel_model_def *model = &run->scene->model;
    for (int32_t b = 0; b < model->body_count; b++)
        if (model->bodies[b].fluid_density > 0 && !(pel_vec3_length(model->gravity) > 0))
            return model->bodies[b].name;
    return NULL;
}

void pel_tell_nothing(const pel_warning_text *at)
{
    const pel_load_def *late = late_load(at->run);
    const char *fluid = weightless_fluid(at->run);
    if (late != NULL)
        snprintf(at->text, at->size,
                 "nothing acts: no vertex moved. load '%s' begins at t = %.6g s, and the run ends at %.6g s. use a "
                 "longer duration",
                 late->name, late->from, pel_sim_time(at->run->sim));
    else if (fluid != NULL)
        snprintf(
            at->text, at->size,
            "nothing acts: no vertex moved. the fluid of body '%s' presses by its weight, and there is no gravity: "
            "add gravity: [0, 0, -9.81]",
            fluid);
    else
        snprintf(at->text, at->size,
                 "nothing acts: no vertex moved, and no work was done. add gravity, a load, a pressure, a velocity, "
                 "a tool that moves into a body, or hold less: a rigid body with pinned vertices off a line is held");
}
