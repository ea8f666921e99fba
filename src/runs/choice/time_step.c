/* The longest step, of those that the default is a multiple of, that resolves what moves: the lowest vibration of each
   body at rest, by a modal analysis, and the times between the keys of loads, pressures and moving pins. 40 steps in a
   vibration give its frequency within 0.2 % and keep its amplitude, 8 in a load the motion that it starts
   (docs/solvers.md); supports are where they are at the end of the run. What would cost too much is left out: longer
   steps damp what they do not resolve. */
#include "choice/time_step.h"

#include "base/memory.h"
#include "base/number.h"
#include "base/room.h"
#include "base/status.h"
#include "choice/method.h"
#include "geom/solid.h"
#include "keys/arena.h"
#include "keys/validate.h"
#include "math/extremes.h"
#include "math/functions.h"
#include "math/pose.h"
#include "math/vec3.h"
#include "mesh/figures.h"
#include "minimise/step_modes.h"
#include "pellicle/sim_step.h"
#include "stage/stepper.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { STEPS_A_PERIOD = 40, STEPS_A_LOAD = 8, STEPS_A_POSE = 4 };
/* what a load starts counts beside the slowest vibration from here on: 20 steps in its period are 0.8 % too slow */
#define FASTER 1.5
/* s of one core, for a whole run */
#define MOST_COST 10
/* s of one core: explicit runs that take longer are refused */
#define MOST_EXPLICIT 600
/* and for one system of equations: an analysis solves dozens */
#define MOST_SYSTEM 2
/* those of a free body and one that is none */
enum { MODE_COUNT = 7 };
/* drag in a run, that leaves more than a third of an amplitude at its end: vibrations are to be seen all the time */
#define MOST_BRAKING 2
/* of the largest of these: lower frequencies are rigid motions */
#define RIGID_SHARE 1e-3

static const int32_t divisors[] = {1,  2,  4,   5,   8,   10,  16,  20,  25,  32,  40,  50,
                                   64, 80, 100, 125, 160, 200, 250, 320, 400, 500, 800, 1000};
#define LAST_DIVISOR 1000

static bool has(const pel_quantity *quantity)
{
    return quantity->value > 0 || quantity->field != NULL || quantity->key_count > 0;
}

/* 1/s, at most, that drag takes of the momentum of a body; infinite where it is not known, or springs damp otherwise */
static double braking_of(const pel_scene *scene, const pel_body_def *body)
{
    const pel_quantity *drag = &body->spring_damping;
    bool is_rate = body->spring_thickness > 0 && drag->field == NULL && drag->key_count == 0;
    if (has(&body->volumetric_damping) || (has(drag) && !is_rate))
        return (double)HUGE_VAL;
    return scene->sim.solver.drag + drag->value;
}

bool pel_scene_is_undamped(const pel_scene *scene)
{
    double most = 0;
    for (int32_t b = 0; b < scene->model.body_count; b++)
        most = pel_max(most, braking_of(scene, &scene->model.bodies[b]));
    return !(most * scene->duration > MOST_BRAKING);
}

/* the surface of a body at rest crosses a tool at its last pose, of a mesh the box about it */
static bool ends_in(const pel_tool_def *tool, const pel_mesh *mesh)
{
    pel_solid solid = pel_solid_of(tool);
    const pel_pose_key *pose = &tool->keys[tool->key_count - 1];
    double low[3], high[3], middle[3] = {0}, x[3][3], weights[3], normal[3];
    bool any = false;
    if (tool->shape == PEL_TOOL_MESH) {
        pel_mesh_box(tool->mesh, low, high);
        solid.shape = PEL_TOOL_BOX;
        for (int k = 0; k < 3; k++) {
            middle[k] = 0.5 * (low[k] + high[k]);
            solid.half_extents[k] = 0.5 * (high[k] - low[k]);
        }
    }
    for (int32_t t = 0; t < mesh->triangle_count; t++) {
        for (int i = 0; i < 3; i++) {
            pel_vec3_subtract(mesh->positions[mesh->triangles[t][i]], pose->position, x[i]);
            pel_rotate_back(pose->rotation, x[i], x[i]);
            pel_vec3_subtract(x[i], middle, x[i]);
        }
        any |= pel_solid_depth(&solid, x[0], x[1], x[2], weights, normal) > 0;
    }
    return any;
}

/* goes away from all bodies before the end of the run, or lets go of what it grasps */
static bool lets_go(const pel_scene *scene, const pel_tool_def *tool)
{
    if (tool->grasp)
        return tool->grasp_until < scene->duration;
    bool goes = tool->press && tool->key_count > 1 && tool->keys[tool->key_count - 1].time < scene->duration &&
                !pel_solid_rows[tool->shape].has_edge;
    for (int32_t b = 0; goes && b < scene->model.body_count; b++)
        goes = !ends_in(tool, scene->model.bodies[b].mesh);
    return goes;
}

static bool any_lets_go(const pel_scene *scene)
{
    bool any = false;
    for (int32_t t = 0; t < scene->sim.tool_count; t++)
        any |= scene->sim.tools[t].shape != PEL_TOOL_SUPPORT && lets_go(scene, &scene->sim.tools[t]);
    return any;
}

/* not by pins that move, nor in the end by tools that let go */
static bool is_held_by_tools(const pel_scene *scene)
{
    bool any = false;
    for (int32_t t = 0; t < scene->sim.tool_count; t++)
        any |= scene->sim.tools[t].shape != PEL_TOOL_SUPPORT;
    return any && !any_lets_go(scene);
}

/* the program may choose, and motion goes on */
static bool is_open(const pel_scene_value *root, const pel_scene *scene)
{
    const pel_stepper *stepper = pel_stepper_of(scene->sim.solver.method);
    bool vibrates = stepper->minimises && stepper->has_velocity && pel_scene_is_undamped(scene);
    vibrates &= !is_held_by_tools(scene);
    bool counts = !(scene->output.every > 0) || scene->frame_limit > 0 || scene->sim.solver.budget > 0;
    for (int32_t b = 0; b < scene->model.body_count; b++)
        vibrates &= scene->model.bodies[b].refine.levels == 0;
    return vibrates && !counts && pel_scene_value_at(root, "solver.dt")->is_implied;
}

/* ---- loads ---- */

static void take(pel_motions *motions, double dt, const char *format, const char *name, double number)
{
    pel_fastest_motion *places[] = {&motions->fastest, &motions->chosen};
    for (int i = 0; i < 2; i++) {
        if (!(dt > 0 && dt < places[i]->dt) || (i == 1 && dt < motions->shortest))
            continue;
        places[i]->dt = dt;
        snprintf(places[i]->reason, sizeof places[i]->reason, format, name, number);
    }
}

/* by a factor over time */
static void take_keys(pel_motions *motions, const pel_key *keys, int32_t count, const char *name)
{
    for (int32_t k = 1; k < count; k++)
        if (keys[k].value != keys[k - 1].value)
            take(motions, (keys[k].time - keys[k - 1].time) / STEPS_A_LOAD, "8 steps in what %s does in %.3g s", name,
                 keys[k].time - keys[k - 1].time);
}

static void take_loads(pel_motions *motions, const pel_scene *scene)
{
    for (int32_t l = 0; l < scene->sim.load_count; l++) {
        const pel_load_def *load = &scene->sim.loads[l];
        char name[PEL_NAME_SIZE + 8];
        snprintf(name, sizeof name, "load '%s'", load->name);
        if (isfinite(load->until))
            take(motions, (load->until - pel_max(load->from, 0)) / STEPS_A_LOAD, "8 steps in what %s does in %.3g s",
                 name, load->until - pel_max(load->from, 0));
        take_keys(motions, load->keys, load->key_count, name);
    }
    for (int32_t b = 0; b < scene->model.body_count; b++) {
        const pel_quantity *outside = &scene->model.bodies[b].shell.pressure.outside;
        take_keys(motions, outside->keys, outside->key_count, "a pressure");
    }
}

/* of pins */
static void take_poses(pel_motions *motions, const pel_scene *scene)
{
    for (int32_t t = 0; t < scene->sim.tool_count; t++) {
        const pel_tool_def *tool = &scene->sim.tools[t];
        for (int32_t k = 1; tool->shape == PEL_TOOL_SUPPORT && k < tool->key_count; k++)
            take(motions, (tool->keys[k].time - tool->keys[k - 1].time) / STEPS_A_POSE,
                 "4 steps in what %s does in %.3g s", tool->name, tool->keys[k].time - tool->keys[k - 1].time);
    }
}

/* ---- vibrations ---- */

/* 1 s where a material is damped, or is to be by a loss factor that is not known yet */
static bool mark_damped(pel_body_def *body)
{
    double *numbers[] = {&body->shell.membrane.retardation, &body->shell.bending.retardation,
                         &body->spring_retardation};
    bool any = false;
    for (int i = 0; i < 3; i++) {
        *numbers[i] = *numbers[i] > 0;
        any |= *numbers[i] > 0;
    }
    return any;
}

/* moves pins, and holds them to the end */
static bool is_pin(const pel_tool_def *tool, int32_t b)
{
    return tool->shape == PEL_TOOL_SUPPORT && tool->body == b && !(tool->grasp_from > 0) &&
           !isfinite(tool->grasp_until);
}

/* The pinned vertices of a body, those that move among them: (count), to be freed. Null when out of memory. */
static int32_t *join_pins(const pel_scene *scene, int32_t b, int32_t *count)
{
    const pel_body_def *body = &scene->model.bodies[b];
    size_t room = (size_t)body->pinned_count + 1;
    for (int32_t t = 0; t < scene->sim.tool_count; t++)
        room += is_pin(&scene->sim.tools[t], b) ? (size_t)scene->sim.tools[t].vertex_count : 0;
    int32_t *pins = pel_allocate(room, sizeof *pins);
    *count = 0;
    if (pins == NULL)
        return NULL;
    for (int32_t i = 0; i < body->pinned_count; i++)
        pins[(*count)++] = body->pinned[i];
    for (int32_t t = 0; t < scene->sim.tool_count; t++)
        for (int32_t i = 0; is_pin(&scene->sim.tools[t], b) && i < scene->sim.tools[t].vertex_count; i++)
            pins[(*count)++] = scene->sim.tools[t].vertices[i];
    return pins;
}

/* by a modal analysis of def; 0 where there is none */
static pel_status analyse(const pel_scene *scene, int32_t b, pel_sim_def *def, pel_vibration *found)
{
    pel_body_def body = scene->model.bodies[b];
    int32_t *pins = join_pins(scene, b, &body.pinned_count);
    if (pins == NULL)
        return PEL_OUT_OF_MEMORY;
    body.pinned = pins;
    /* of a state of rest */
    for (int i = 0; i < 3; i++)
        body.velocity[i] = body.angular_velocity[i] = 0;
    pel_model_def own = scene->model;
    double values[MODE_COUNT];
    pel_model *model = NULL;
    pel_sim *sim = NULL;
    /* a gas is stiff at rest too */
    if (body.shell.pressure.kind != PEL_PRESSURE_GAS)
        body.shell.pressure.kind = PEL_PRESSURE_NONE;
    body.shell.pressure.outside = (pel_quantity){0};
    bool is_viscous = mark_damped(&body);
    own.bodies = &body;
    own.body_count = 1;
    for (int i = 0; i < 3; i++)
        own.gravity[i] = 0;
    pel_status status = pel_model_create(&own, &model, NULL);
    def->model = model;
    if (status == PEL_OK)
        status = pel_sim_create(def, &sim, NULL);
    if (status == PEL_OK)
        status = pel_sim_step(sim, NULL);
    int32_t count = status == PEL_OK ? pel_sim_get_modes(sim, values) : 0;
    for (int32_t i = 0; i < count && found->frequency == 0; i++)
        if (values[i] > RIGID_SHARE * values[count - 1])
            *found = (pel_vibration){
                .frequency = values[i],
                .strain = is_viscous ? pel_sim_mode_retardation(sim, i) : 0,
                .wave = pel_mode_wave_of(sim, pel_modes_vector(sim->modes->modes, i), values[i], false),
            };
    if (status == PEL_OK && count > 0)
        status = pel_excited_find(scene, b, sim, &found->excited);
    if (found->strain < 0)
        status = PEL_OUT_OF_MEMORY;
    pel_sim_destroy(sim);
    pel_model_destroy(model);
    pel_free(pins);
    return status;
}

pel_method pel_scene_static_method(void)
{
    int method = 0;
    while (method + 1 < PEL_METHOD_COUNT && !pel_stepper_of((pel_method)method)->is_static)
        method++;
    return (pel_method)method;
}

pel_status pel_scene_frequency(const pel_scene *scene, int32_t body, double *frequency)
{
    pel_vibration found;
    if (scene == NULL || frequency == NULL || body < 0 || body >= scene->model.body_count)
        return PEL_BAD_ARGUMENT;
    pel_status status = pel_scene_find_vibration(scene, body, &found);
    *frequency = found.frequency;
    return status;
}

pel_status pel_scene_find_vibration(const pel_scene *scene, int32_t body, pel_vibration *vibration)
{
    pel_sim_def def = scene->sim;
    pel_support_def *supports = pel_allocate((size_t)scene->sim.support_count + 1, sizeof *supports);
    pel_load_def *loads = pel_allocate((size_t)scene->sim.load_count + 1, sizeof *loads);
    *vibration = (pel_vibration){0};
    if (supports == NULL || loads == NULL) {
        PEL_FREE_ALL(supports, loads);
        return PEL_OUT_OF_MEMORY;
    }
    pel_excited_lay_out(scene, body, scene->duration, loads, &def.load_count);
    def.loads = loads;
    def.tool_count = def.cut_count = def.seam_count = def.tie_count = 0;
    def.wind = pel_sim_def_default().wind;
    def.contact.enabled = false;
    def.supports = supports;
    def.support_count = 0;
    for (int32_t i = 0; i < scene->sim.support_count; i++)
        if (scene->sim.supports[i].body == body) {
            supports[def.support_count] = scene->sim.supports[i];
            supports[def.support_count++].body = 0;
        }
    def.solver = pel_sim_def_default().solver;
    def.solver.method = pel_scene_static_method();
    def.solver.analysis = PEL_ANALYSIS_MODAL;
    def.solver.mode_count = MODE_COUNT;
    def.solver.dt = scene->duration;
    pel_status status = analyse(scene, body, &def, vibration);
    /* of a body that nothing holds loads may be refused */
    if (status != PEL_OUT_OF_MEMORY && def.load_count > 0 && !(vibration->frequency > 0)) {
        *vibration = (pel_vibration){0};
        def.load_count = 0;
        status = analyse(scene, body, &def, vibration);
    }
    PEL_FREE_ALL(supports, loads);
    return status;
}

static pel_status take_vibrations(pel_motions *motions, const pel_scene *scene)
{
    for (int32_t b = 0; b < scene->model.body_count; b++) {
        pel_vibration found;
        if (pel_scene_find_vibration(scene, b, &found) == PEL_OUT_OF_MEMORY)
            return PEL_OUT_OF_MEMORY;
        char name[PEL_NAME_SIZE + 8];
        snprintf(name, sizeof name, "'%s'", scene->model.bodies[b].name);
        take(motions, found.frequency > 0 ? 1 / (STEPS_A_PERIOD * found.frequency) : 0,
             "40 steps in the slowest vibration of body %s, %.3g Hz", name, found.frequency);
        if (found.excited.frequency > FASTER * found.frequency)
            take(motions, 1 / (STEPS_A_PERIOD * found.excited.frequency),
                 "40 steps in the vibration that %s starts, %.3g Hz", found.excited.by, found.excited.frequency);
    }
    return PEL_OK;
}

pel_status pel_scene_find_motions(const pel_scene *scene, double dt, double shortest, pel_motions *motions)
{
    *motions = (pel_motions){.shortest = shortest, .fastest.dt = dt, .chosen.dt = dt};
    take_loads(motions, scene);
    take_poses(motions, scene);
    return 1e-3 * pel_scene_step_cost(scene) > MOST_SYSTEM ? PEL_OK : take_vibrations(motions, scene);
}

/* ---- choice ---- */

static pel_status set_dt(pel_scene_reader *reader, const pel_scene_value *root, pel_scene *scene, double dt)
{
    char text[PEL_NUMBER_SIZE];
    pel_scene_value *value = pel_scene_value_at(root, "solver.dt");
    pel_number_print(text, dt);
    value->number = scene->sim.solver.dt = dt;
    value->text = pel_arena_text(reader->arena, text, strlen(text));
    return value->text != NULL ? PEL_OK : pel_fail_memory(reader->error);
}

/* the first of the divisors from which dt is short enough; the last where none is */
static int32_t divisor_of(double dt, double enough)
{
    int32_t last = (int32_t)(sizeof divisors / sizeof *divisors) - 1, i = 0;
    while (i < last && dt / divisors[i] > enough)
        i++;
    return divisors[i];
}

/* a frame shows a step, so steps are no longer than the time between frames */
static pel_status follow_frames(pel_scene_reader *reader, const pel_scene_value *root, pel_scene *scene)
{
    const pel_stepper *stepper = pel_stepper_of(scene->sim.solver.method);
    const double every = scene->output.every, dt = scene->sim.solver.dt;
    if (!(every > 0 && every < dt) || !stepper->has_velocity)
        return PEL_OK;
    bool may = pel_scene_value_at(root, "solver.dt")->is_implied && pel_stepper_knows_material(stepper);
    pel_log_line(reader->log, "dt %.4g s: %s", may ? every : dt,
                 may ? "output.every" : "longer than output.every, so each step is a frame");
    return may ? set_dt(reader, root, scene, every) : PEL_OK;
}

/* Only solids have systems that take long on usual meshes: the time grows with the sixth power of 1 / edge. */
static void tell_solid_cost(pel_scene_reader *reader, const pel_scene *scene)
{
    const pel_stepper *stepper = pel_stepper_of(scene->sim.solver.method);
    int32_t solid = 0;
    for (int32_t b = 0; b < scene->model.body_count; b++)
        if (scene->model.bodies[b].mesh->tetrahedron_count > scene->model.bodies[solid].mesh->tetrahedron_count)
            solid = b;
    const pel_body_def *body = &scene->model.bodies[solid];
    const double cost = 1e-3 * pel_scene_step_cost(scene) * (stepper->is_static ? PEL_STATIC_SYSTEMS : 1);
    if (stepper->turns_edges && body->mesh->tetrahedron_count > 0 && cost > MOST_COST)
        pel_log_line(reader->log,
                     "body '%s' has %d tetrahedra: a step of %s takes %.2g s of one core or more. use a volume.edge at "
                     "least %.1f times as long, or the method xpbd%s",
                     body->name, (int)body->mesh->tetrahedron_count, pel_method_words[scene->sim.solver.method], cost,
                     pel_pow(cost / MOST_COST, 1.0 / 6) + 0.05, stepper->is_static ? " with solver.drag" : "");
}

static pel_status refuse_explicit(pel_scene_reader *reader, const pel_scene_value *root, double dt, double steps,
                                  double cost)
{
    const pel_scene_value *value = pel_scene_value_at(root, "solver.method");
    pel_scene_fail(reader, &value->place, "explicit would take %.3g steps of %.3g s, about %.2g s of one core", steps,
                   dt, cost);
    pel_fail_remedy(reader->error,
                    "use the method xpbd or implicit, or write solver.dt: %.3g if the run may take so long", dt);
    return PEL_BAD_SCENE;
}

/* Explicit steps are as long as is stable; what hinders the simulation itself is told when it is created. */
static pel_status choose_stable(pel_scene_reader *reader, const pel_scene_value *root, pel_scene *scene)
{
    const pel_stepper *stepper = pel_stepper_of(scene->sim.solver.method);
    const double dt = scene->sim.solver.dt;
    double enough = 0, scale = 1;
    if (!stepper->is_explicit || !pel_scene_value_at(root, "solver.dt")->is_implied)
        return PEL_OK;
    pel_model *model = NULL;
    pel_status status = pel_model_create(&scene->model, &model, NULL);
    pel_sim_def def = scene->sim;
    def.model = model;
    if (status == PEL_OK)
        status = pel_sim_stable_dt(&def, &enough, NULL);
    pel_model_destroy(model);
    if (status == PEL_OUT_OF_MEMORY)
        return pel_fail_memory(reader->error);
    if (status != PEL_OK || !(enough > 0) || enough >= dt)
        return PEL_OK;
    while (dt / (LAST_DIVISOR * scale) > enough)
        scale *= LAST_DIVISOR;
    const double chosen = dt / (scale * divisor_of(dt / scale, enough)), steps = scene->duration / chosen;
    const double cost = 1e-3 * pel_scene_substep_cost(scene) * steps;
    if (cost > MOST_EXPLICIT)
        return refuse_explicit(reader, root, chosen, steps, cost);
    pel_log_line(reader->log,
                 "dt %.4g s: half of what explicit is stable with at rest, %.3g s; about %.2g s of one core", chosen,
                 2 * enough, cost);
    return set_dt(reader, root, scene, chosen);
}

pel_status pel_scene_choose_dt(pel_scene_reader *reader, const pel_scene_value *root, pel_scene *scene)
{
    tell_solid_cost(reader, scene);
    pel_status status = follow_frames(reader, root, scene);
    if (status == PEL_OK)
        status = choose_stable(reader, root, scene);
    if (status != PEL_OK)
        return status;
    const double dt = scene->sim.solver.dt, cost = 1e-3 * pel_scene_step_cost(scene) * scene->duration / dt;
    pel_motions motions;
    if (!is_open(root, scene) || divisors[1] * cost > MOST_COST)
        return PEL_OK;
    if (pel_scene_find_motions(scene, dt, dt * cost / MOST_COST, &motions) != PEL_OK)
        return pel_fail_memory(reader->error);
    const int32_t needed = divisor_of(dt, motions.fastest.dt);
    int32_t chosen = divisor_of(dt, motions.chosen.dt);
    if (chosen * cost > MOST_COST)
        chosen = 1;
    /* far from what steps could resolve: nobody waits for that */
    if (needed > chosen && dt / needed <= motions.fastest.dt)
        pel_log_line(reader->log, "dt %.4g s: %s would take %.4g s, about %.2g s of one core; it is damped",
                     dt / chosen, motions.fastest.reason, dt / needed, needed * cost);
    if (chosen == 1)
        return PEL_OK;
    pel_log_line(reader->log, "dt %.4g s: %s; about %.2g s of one core", dt / chosen, motions.chosen.reason,
                 chosen * cost);
    return set_dt(reader, root, scene, dt / chosen);
}
