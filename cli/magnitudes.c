/* Closed forms of thin shells, with the volume V, the area A and the radius R = 3 V / A at rest:

     strain     of a sphere by a pressure: p R (1 - nu) / (2 E h); of an open sheet in one direction: T / (E h)
     buckling   of a sphere by an outer pressure: 2 E (h / R)^2 / sqrt(3 (1 - nu^2)) (Zoelly 1915); real ones, with
                dents, buckle earlier
     sinking    of an elastic foundation: p depth / E

   They are exact for spheres, and magnitudes for other shapes. */
#include "magnitudes.h"

#include <pellicle/measure.h>
#include <pellicle/sim_reading.h>
#include <pellicle/sim_rigid.h>

#include <math.h>
#include <stdio.h>

/* the strain that is spoken of */
#define STRAIN 0.01
/* s, and steps, that the estimate of the cost may take; a body with more vertices has no modal analysis */
#define COST_SECONDS 0.3
enum { COST_STEPS = 20, ANALYSED_VERTICES = 3000 };

/* NaN where it does not apply */
typedef struct magnitudes {
    double mass;                /* kg */
    double weight;              /* N */
    double strain_pressure;     /* Pa, for 1 % */
    double strain_tension;      /* N/m, for 1 % */
    double buckling_pressure;   /* Pa */
    double foundation_pressure; /* Pa, for 1 % of the depth */
    double size, fall_time;     /* m, the diagonal; s to fall so far */
    double frequency;           /* Hz, the lowest */
} magnitudes;

static double mean_of(const pel_quantity *quantity, int32_t count)
{
    double sum = 0;
    for (int32_t v = 0; quantity->field != NULL && v < count; v++)
        sum += quantity->field[v] / count;
    return quantity->field != NULL ? sum : quantity->value;
}

static double length_of(const double v[3])
{
    return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

static double mass_of(const pel_body_def *body, double area)
{
    int32_t count = body->mesh->vertex_count;
    if (body->mass_kind == PEL_MASS_TOTAL)
        return body->mass;
    return body->mass_kind == PEL_MASS_PER_VERTEX ? body->mass * count
                                                  : body->mass * mean_of(&body->thickness, count) * area;
}

/* nothing keeps it from falling but other bodies and tools */
static int is_free(const pel_scene *scene, int32_t b)
{
    const pel_body_def *body = &scene->model.bodies[b];
    int held = body->pinned_count > 0 || body->volumetric_stiffness.key_count > 0 ||
               mean_of(&body->volumetric_stiffness, body->mesh->vertex_count) > 0;
    for (int32_t s = 0; s < scene->sim.support_count; s++)
        held |= scene->sim.supports[s].body == b;
    for (int32_t t = 0; t < scene->sim.tool_count; t++) {
        const pel_tool_def *tool = &scene->sim.tools[t];
        held |= (tool->grasp || tool->shape == PEL_TOOL_SUPPORT) && (tool->body == b || tool->body < 0);
    }
    return !held;
}

static void judge_membrane(const pel_body_def *body, int is_closed, double radius, magnitudes *found)
{
    const pel_membrane_def *membrane = &body->shell.membrane;
    int32_t count = body->mesh->vertex_count;
    double thickness = mean_of(&membrane->thickness, count), stiffness = mean_of(&membrane->young, count) * thickness;
    double poisson = membrane->poisson;
    if (!is_closed) {
        found->strain_tension = STRAIN * stiffness;
        return;
    }
    found->strain_pressure = 2 * STRAIN * stiffness / (radius * (1 - poisson));
    if (body->shell.bending.model != PEL_BENDING_NONE)
        found->buckling_pressure = 2 * stiffness * thickness / (radius * radius * sqrt(3 * (1 - poisson * poisson)));
}

/* Hz; NaN where it is not known */
static double find_frequency(const pel_scene *scene, int32_t b)
{
    const pel_body_def *body = &scene->model.bodies[b];
    double frequency = 0;
    if (body->mesh->vertex_count <= ANALYSED_VERTICES && body->refine.levels == 0)
        pel_scene_frequency(scene, b, &frequency);
    return frequency > 0 ? frequency : (double)NAN;
}

static magnitudes judge(const pel_scene *scene, const pel_sim *sim, int32_t b)
{
    const double none = (double)NAN;
    const pel_body_def *body = &scene->model.bodies[b];
    const pel_mesh *mesh = body->mesh;
    double area = pel_surface_area(mesh->positions[0], mesh->triangles[0], mesh->triangle_count), low[3], high[3];
    double volume =
        fabs(pel_surface_volume(mesh->positions[0], mesh->triangles[0], mesh->triangle_count, mesh->positions[0]));
    int is_closed = pel_model_is_closed(pel_sim_model(sim), b) && volume > 1e-6 * area * sqrt(area);
    double gravity = length_of(scene->model.gravity);
    magnitudes found = {.weight = none,
                        .strain_pressure = none,
                        .strain_tension = none,
                        .buckling_pressure = none,
                        .foundation_pressure = none,
                        .fall_time = none};
    pel_mesh_box(mesh, low, high);
    for (int i = 0; i < 3; i++)
        high[i] -= low[i];
    found.size = length_of(high);
    pel_rigid_reading rigid;
    found.mass = pel_sim_get_rigid(sim, b, &rigid) ? rigid.mass : mass_of(body, area);
    if (gravity > 0)
        found.weight = found.mass * gravity;
    if (gravity > 0 && is_free(scene, b))
        found.fall_time = sqrt(2 * found.size / gravity);
    if (body->shell.membrane.on)
        judge_membrane(body, is_closed, is_closed ? 3 * volume / area : 0, &found);
    if (body->volumetric_depth > 0 && mean_of(&body->volumetric_stiffness, mesh->vertex_count) > 0)
        found.foundation_pressure = STRAIN * mean_of(&body->volumetric_stiffness, mesh->vertex_count);
    found.frequency = find_frequency(scene, b);
    return found;
}

static void print_number(double number, const char *format)
{
    if (isfinite(number))
        printf(format, number);
}

static void print_body(const char *name, const magnitudes *found)
{
    printf("  %s: %.3g kg", name, found->mass);
    print_number(found->weight, ", weighs %.3g N");
    print_number(found->strain_pressure, "; 1 %% strain at %.3g Pa inside");
    print_number(found->strain_tension, "; 1 %% strain at %.3g N/m");
    print_number(found->buckling_pressure, "; buckles near %.3g Pa outside");
    print_number(found->foundation_pressure, "; %.3g Pa press it in by 1 %% of its depth");
    if (isfinite(found->fall_time))
        printf("; falls its size of %.3g m in %.3g s", found->size, found->fall_time);
    print_number(found->frequency, "; lowest frequency %.3g Hz");
    putchar('\n');
}

static void write_body(pel_json *json, const char *name, const magnitudes *found)
{
    pel_json_open(json, NULL, '{');
    pel_json_text(json, "name", name);
    pel_json_number(json, "mass", found->mass);
    pel_json_number(json, "weight", found->weight);
    pel_json_number(json, "strain_pressure", found->strain_pressure);
    pel_json_number(json, "strain_tension", found->strain_tension);
    pel_json_number(json, "buckling_pressure", found->buckling_pressure);
    pel_json_number(json, "foundation_pressure", found->foundation_pressure);
    pel_json_number(json, "fall_time", found->fall_time);
    pel_json_number(json, "lowest_frequency", found->frequency);
    pel_json_close(json, '}');
}

/* steps of a whole run */
static double step_count(const pel_scene *scene)
{
    double time = scene->duration;
    if (scene->time_limit > 0 && scene->time_limit < time)
        time = scene->time_limit;
    double steps = ceil(time / scene->sim.solver.dt - 1e-9);
    return scene->frame_limit > 0 && (double)scene->frame_limit < steps ? (double)scene->frame_limit : steps;
}

/* s of a step; NaN where the first steps fail, or say nothing of later ones */
static double time_steps(const pel_scene *scene, pel_sim *sim)
{
    pel_method method = scene->sim.solver.method;
    if (method == PEL_METHOD_STATIC || method == PEL_METHOD_DESCENT)
        return (double)NAN;
    double start = pel_seconds(), seconds = 0;
    int count = 0;
    for (; count < COST_STEPS && seconds < COST_SECONDS; count++) {
        if (pel_sim_step(sim, NULL) != PEL_OK)
            return (double)NAN;
        seconds = pel_seconds() - start;
    }
    return seconds / count;
}

void cli_tell_magnitudes(const pel_scene *scene, pel_sim *sim, pel_json *json)
{
    double steps = step_count(scene);
    if (json != NULL)
        pel_json_open(json, "bodies", '[');
    for (int32_t b = 0; b < scene->model.body_count; b++) {
        magnitudes found = judge(scene, sim, b);
        if (json != NULL)
            write_body(json, scene->model.bodies[b].name, &found);
        else
            print_body(scene->model.bodies[b].name, &found);
    }
    double seconds = time_steps(scene, sim);
    if (json != NULL) {
        pel_json_close(json, ']');
        pel_json_number(json, "steps", steps);
        pel_json_number(json, "step_ms", 1e3 * seconds);
    } else if (isfinite(seconds)) {
        printf("  %.0f steps of about %.2g ms: %.2g s, if the rest is like the start\n", steps, 1e3 * seconds,
               steps * seconds);
    }
}
