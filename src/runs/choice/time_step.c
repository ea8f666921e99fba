/* The longest step, of those that the default is a multiple of, that resolves what moves: the lowest vibration of each
   body at rest, by a modal analysis, and the times between the keys of loads and pressures. 40 steps in a vibration
   give its frequency within 0.2 % and keep its amplitude, 8 in a load the motion that it starts (docs/solvers.md);
   supports are where they are at the end of the run. Where that would cost too much the default stays, which damps what
   it does not resolve. */
#include "choice/time_step.h"

#include "base/memory.h"
#include "base/number.h"
#include "base/status.h"
#include "choice/method.h"
#include "keys/arena.h"
#include "math/extremes.h"
#include "minimise/step_modes.h"
#include "pellicle/sim_step.h"
#include "stage/stepper.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { STEPS_A_PERIOD = 40, STEPS_A_LOAD = 8 };
/* s of one core, for a whole run */
#define MOST_COST 10
/* those of a free body and one that is none */
enum { MODE_COUNT = 7 };
/* of the largest of these: lower frequencies are rigid motions */
#define RIGID_SHARE 1e-3

static const int32_t divisors[] = {1, 2, 4, 5, 8, 10, 16, 20, 25, 32, 40, 50, 64, 80, 100};

static bool is_damped(const pel_body_def *body)
{
    const pel_quantity *numbers[] = {&body->spring_damping, &body->volumetric_damping};
    bool any = false;
    for (int i = 0; i < 2; i++)
        any |= numbers[i]->value > 0 || numbers[i]->field != NULL || numbers[i]->key_count > 0;
    return any;
}

bool pel_scene_is_undamped(const pel_scene *scene)
{
    bool any = scene->sim.tool_count > 0 || scene->sim.solver.drag > 0;
    any |= scene->sim.contact.enabled && !scene->contact_is_implied;
    for (int32_t b = 0; b < scene->model.body_count; b++)
        any |= is_damped(&scene->model.bodies[b]);
    return !any;
}

/* the program may choose, and motion goes on */
static bool is_open(const pel_scene_value *root, const pel_scene *scene)
{
    const pel_stepper *stepper = pel_stepper_of(scene->sim.solver.method);
    bool vibrates = stepper->minimises && stepper->has_velocity && pel_scene_is_undamped(scene);
    bool counts = !(scene->output.every > 0) || scene->frame_limit > 0 || scene->sim.solver.budget > 0;
    for (int32_t b = 0; b < scene->model.body_count; b++)
        vibrates &= scene->model.bodies[b].refine.levels == 0;
    return vibrates && !counts && pel_scene_value_at(root, "solver.dt")->is_implied;
}

/* ---- loads ---- */

static void take(pel_fastest_motion *most, double dt, const char *format, const char *name, double number)
{
    if (!(dt > 0 && dt < most->dt))
        return;
    most->dt = dt;
    snprintf(most->reason, sizeof most->reason, format, name, number);
}

static void take_keys(pel_fastest_motion *most, const pel_key *keys, int32_t count, const char *name)
{
    for (int32_t k = 1; k < count; k++)
        if (keys[k].value != keys[k - 1].value)
            take(most, (keys[k].time - keys[k - 1].time) / STEPS_A_LOAD, "8 steps in what %s does in %.3g s", name,
                 keys[k].time - keys[k - 1].time);
}

static void take_loads(pel_fastest_motion *most, const pel_scene *scene)
{
    for (int32_t l = 0; l < scene->sim.load_count; l++) {
        const pel_load_def *load = &scene->sim.loads[l];
        char name[PEL_NAME_SIZE + 8];
        snprintf(name, sizeof name, "load '%s'", load->name);
        if (isfinite(load->until))
            take(most, (load->until - pel_max(load->from, 0)) / STEPS_A_LOAD, "8 steps in what %s does in %.3g s", name,
                 load->until - pel_max(load->from, 0));
        take_keys(most, load->keys, load->key_count, name);
    }
    for (int32_t b = 0; b < scene->model.body_count; b++) {
        const pel_quantity *outside = &scene->model.bodies[b].shell.pressure.outside;
        take_keys(most, outside->keys, outside->key_count, "a pressure");
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

/* by a modal analysis of def; 0 where there is none */
static pel_status analyse(const pel_scene *scene, int32_t b, pel_sim_def *def, pel_vibration *found)
{
    pel_body_def body = scene->model.bodies[b];
    pel_model_def own = scene->model;
    double values[MODE_COUNT];
    pel_model *model = NULL;
    pel_sim *sim = NULL;
    body.shell.pressure.kind = PEL_PRESSURE_NONE;
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
            *found = (pel_vibration){values[i], is_viscous ? pel_sim_mode_retardation(sim, i) : 0};
    if (found->strain < 0)
        status = PEL_OUT_OF_MEMORY;
    pel_sim_destroy(sim);
    pel_model_destroy(model);
    return status;
}

/* the one that has analyses */
static pel_method static_method(void)
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
    *vibration = (pel_vibration){0};
    if (supports == NULL)
        return PEL_OUT_OF_MEMORY;
    def.load_count = def.tool_count = def.cut_count = def.seam_count = 0;
    def.contact.enabled = false;
    def.supports = supports;
    def.support_count = 0;
    for (int32_t i = 0; i < scene->sim.support_count; i++)
        if (scene->sim.supports[i].body == body) {
            supports[def.support_count] = scene->sim.supports[i];
            supports[def.support_count++].body = 0;
        }
    def.solver = pel_sim_def_default().solver;
    def.solver.method = static_method();
    def.solver.analysis = PEL_ANALYSIS_MODAL;
    def.solver.mode_count = MODE_COUNT;
    def.solver.dt = scene->duration;
    pel_status status = analyse(scene, body, &def, vibration);
    pel_free(supports);
    return status;
}

static pel_status take_vibrations(pel_fastest_motion *most, const pel_scene *scene)
{
    for (int32_t b = 0; b < scene->model.body_count; b++) {
        double frequency;
        if (pel_scene_frequency(scene, b, &frequency) == PEL_OUT_OF_MEMORY)
            return PEL_OUT_OF_MEMORY;
        char name[PEL_NAME_SIZE + 8];
        snprintf(name, sizeof name, "'%s'", scene->model.bodies[b].name);
        take(most, frequency > 0 ? 1 / (STEPS_A_PERIOD * frequency) : 0,
             "40 steps in the slowest vibration of body %s, %.3g Hz", name, frequency);
    }
    return PEL_OK;
}

pel_status pel_scene_find_motion(const pel_scene *scene, pel_fastest_motion *most)
{
    most->reason[0] = '\0';
    take_loads(most, scene);
    return take_vibrations(most, scene);
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

pel_status pel_scene_choose_dt(pel_scene_reader *reader, const pel_scene_value *root, pel_scene *scene)
{
    double dt = scene->sim.solver.dt, cost = 1e-3 * pel_scene_step_cost(scene) * scene->duration / dt;
    pel_fastest_motion most = {.dt = dt};
    int32_t last = (int32_t)(sizeof divisors / sizeof *divisors) - 1, chosen = 0;
    if (!is_open(root, scene) || divisors[1] * cost > MOST_COST)
        return PEL_OK;
    pel_status status = pel_scene_find_motion(scene, &most);
    while (status == PEL_OK && chosen < last && dt / divisors[chosen] > most.dt)
        chosen++;
    if (status != PEL_OK)
        return pel_fail_memory(reader->error);
    if (chosen == 0)
        return PEL_OK;
    double shorter = dt / divisors[chosen];
    cost *= divisors[chosen];
    /* far from what steps could resolve: nobody waits for that */
    if (shorter > most.dt)
        return PEL_OK;
    if (cost > MOST_COST) {
        pel_log_line(reader->log, "dt %.4g s: %s would take %.4g s, about %.2g s of one core; it is damped", dt,
                     most.reason, shorter, cost);
        return PEL_OK;
    }
    pel_log_line(reader->log, "dt %.4g s: %s; about %.2g s of one core", shorter, most.reason, cost);
    return set_dt(reader, root, scene, shorter);
}
