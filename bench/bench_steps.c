/* Whole steps, as users make them. With two threads: a shell of 20,480 triangles that outside pressure dents
   (scenes/shell-crushed.yaml), under xpbd and pbd with contact, and under xpbd without. With one: six sheets on
   a table, tissue of as many triangles that refines under a tool at 1 kHz, and paper A's sphere of 500 triangles,
   pressed. usage: bench_steps [rounds, 3 by default [begin of a name [threads of the shell]]] A line for each: name,
   mean, 99th and 99.9th percentile of the steps [us], by the clock, or with one thread by its processor time. All
   rounds make the same steps, and of each step the least time counts. The public interface of version 0.2.0 suffices:
   tools/bench-steps builds this file against the last release too. */
#include "pellicle/pellicle.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { MOST_STEPS = 20000 };

/* what is asked for */
static int rounds = 3, shell_threads = 2;
static const char *begin = "";

static double seconds(int threads)
{
    struct timespec now;
    clock_gettime(threads == 1 ? CLOCK_THREAD_CPUTIME_ID : CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* least time between two readings of the clock */
static double reading_seconds(int threads)
{
    double least = 1;
    for (int i = 0; i < 10000; i++) {
        double first = seconds(threads);
        least = fmin(least, seconds(threads) - first);
    }
    return least;
}

static void check(pel_status status, const pel_error *error)
{
    char text[1000];
    if (status == PEL_OK)
        return;
    fprintf(stderr, "%s\n", pel_error_text(error, text, sizeof text));
    exit(1);
}

static int by_size(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static void print_line(const char *name, double *times, int steps)
{
    double sum = 0;
    for (int n = 0; n < steps; n++)
        sum += times[n];
    qsort(times, (size_t)steps, sizeof *times, by_size);
    printf("%-16s %10.2f %10.2f %10.2f\n", name, 1e6 * sum / steps, 1e6 * times[(int)(0.99 * (steps - 1))],
           1e6 * times[(int)(0.999 * (steps - 1))]);
    fflush(stdout);
}

static pel_mesh *make_sphere(int32_t frequency, double radius)
{
    pel_error error;
    pel_mesh *mesh;
    pel_shape_def def = pel_shape_def_default(PEL_SHAPE_GEODESIC_SPHERE);
    def.frequency = frequency;
    def.radius = radius;
    check(pel_shape_create(&def, &mesh, &error), &error);
    return mesh;
}

static pel_model *make_model(const pel_body_def *body)
{
    pel_error error;
    pel_model *model;
    pel_model_def def = pel_model_def_default();
    def.bodies = body;
    def.body_count = 1;
    check(pel_model_create(&def, &model, &error), &error);
    return model;
}

/* follow: moves tools before a step; null = nothing moves */
static void time_steps(const char *name, const pel_sim_def *def, int steps, void (*follow)(pel_sim *sim, int step))
{
    static double times[MOST_STEPS];
    pel_error error;
    double reading = reading_seconds(def->thread_count);
    if (strncmp(name, begin, strlen(begin)) != 0)
        return;
    for (int round = 0; round < rounds; round++) {
        pel_sim *sim;
        check(pel_sim_create(def, &sim, &error), &error);
        for (int n = 0; n < steps; n++) {
            if (follow != NULL)
                follow(sim, n);
            double first = seconds(def->thread_count);
            check(pel_sim_step(sim, &error), &error);
            double time = seconds(def->thread_count) - first - reading;
            times[n] = round == 0 ? time : fmin(times[n], time);
        }
        pel_sim_destroy(sim);
    }
    print_line(name, times, steps);
}

/* ---- a shell that is dented ---- */

static pel_body_def make_shell(const pel_mesh *mesh)
{
    static const pel_key pressure[2] = {{0, 0}, {0.2, 50}};
    pel_body_def body = pel_body_def_default();
    body.name = "shell";
    body.mesh = mesh;
    body.mass_kind = PEL_MASS_DENSITY;
    body.mass = 1000;
    body.thickness.value = 0.01;
    body.spring_stiffness.value = body.spring_damping.value = 0;
    body.volumetric_stiffness.value = body.volumetric_damping.value = 0;
    body.shell.membrane.on = true;
    body.shell.membrane.kind = PEL_MEMBRANE_STVK;
    body.shell.membrane.young.value = 1e5;
    body.shell.membrane.poisson = 0.3;
    body.shell.membrane.thickness.value = 0.01;
    body.shell.bending.model = PEL_BENDING_HINGE;
    body.shell.bending.weight = -1;
    body.shell.pressure.kind = PEL_PRESSURE_GIVEN;
    body.shell.pressure.outside.keys = pressure;
    body.shell.pressure.outside.key_count = 2;
    return body;
}

/* the plates of the scene, which do not move yet */
static pel_tool_def make_plate(const char *name, const pel_pose_key *place)
{
    pel_tool_def plate = pel_tool_def_default();
    plate.name = name;
    plate.shape = PEL_TOOL_BOX;
    plate.half_extents[0] = plate.half_extents[1] = 1.5;
    plate.half_extents[2] = 0.05;
    plate.keys = place;
    plate.key_count = 1;
    return plate;
}

static void dent(const char *name, pel_method method, bool contact)
{
    enum { STEPS = 48 };
    pel_mesh *mesh = make_sphere(32, 1);
    const pel_body_def body = make_shell(mesh);
    const pel_pose_key above = {0, {0, 0, 1.2}, {0, 0, 0, 1}, {0, 0, 0}};
    const pel_pose_key below = {0, {0, 0, -1.2}, {0, 0, 0, 1}, {0, 0, 0}};
    const pel_tool_def plates[] = {make_plate("upper", &above), make_plate("lower", &below)};
    pel_model *model = make_model(&body);
    pel_sim_def def = pel_sim_def_default();
    def.model = model;
    def.thread_count = shell_threads;
    def.solver.method = method;
    def.solver.dt = 0.01;
    def.solver.drag = 1;
    def.solver.iterations = method == PEL_METHOD_PBD ? 5 : 1;
    def.solver.substeps = method == PEL_METHOD_PBD ? 1 : 16;
    def.contact.enabled = def.contact.self = contact;
    def.contact.friction = 0.2;
    def.tools = plates;
    def.tool_count = contact ? 2 : 0;
    time_steps(name, &def, STEPS, NULL);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

/* ---- sheets on each other ---- */

enum { SHEETS = 6, CELLS = 12 };

/* above each other and above the plane z = 0, as one body, so that they do not sleep before they rest */
static pel_mesh *make_sheets(double size, double gap)
{
    enum { ROW = CELLS + 1, OWN = ROW * ROW };
    static double points[SHEETS * OWN][3];
    static int32_t triangles[SHEETS * CELLS * CELLS * 2][3];
    pel_error error;
    pel_mesh *mesh;
    for (int i = 0; i < SHEETS * OWN; i++) {
        points[i][0] = size * (i % OWN % ROW) / CELLS;
        points[i][1] = size * (i % OWN / ROW) / CELLS;
        points[i][2] = gap * (i / OWN + 1);
    }
    for (int i = 0; i < SHEETS * CELLS * CELLS; i++) {
        int cell = i % (CELLS * CELLS), v = i / (CELLS * CELLS) * OWN + cell / CELLS * ROW + cell % CELLS;
        const int32_t halves[2][3] = {{v, v + 1, v + ROW + 1}, {v, v + ROW + 1, v + ROW}};
        memcpy(triangles[2 * i], halves, sizeof halves);
    }
    check(pel_mesh_create(points[0], SHEETS * OWN, triangles[0], SHEETS * CELLS * CELLS * 2, &mesh, &error), &error);
    return mesh;
}

/* Six sheets of 288 triangles of rubber fall by a fifth of their thickness on a table, and rest. */
static void stack_sheets(void)
{
    enum { STEPS = 45 };
    pel_mesh *mesh = make_sheets(0.2, 6e-4);
    pel_body_def body = make_shell(mesh);
    body.mass = 300;
    body.thickness.value = body.shell.membrane.thickness.value = 5e-4;
    body.shell.membrane.young.value = 2e5;
    body.shell.pressure.kind = PEL_PRESSURE_NONE;
    const pel_pose_key below = {0, {0.1, 0.1, -0.05}, {0, 0, 0, 1}, {0, 0, 0}};
    const pel_tool_def table = make_plate("table", &below);
    pel_model_def model_def = pel_model_def_default();
    model_def.bodies = &body;
    model_def.body_count = 1;
    model_def.gravity[2] = -9.81;
    pel_error error;
    pel_model *model;
    check(pel_model_create(&model_def, &model, &error), &error);
    pel_sim_def def = pel_sim_def_default();
    def.model = model;
    def.thread_count = 1;
    def.solver.method = PEL_METHOD_XPBD;
    def.solver.dt = 0.01;
    def.solver.substeps = 48;
    def.contact.enabled = def.contact.self = true;
    def.contact.thickness = 5e-4;
    def.contact.friction = 0.3;
    def.tools = &table;
    def.tool_count = 1;
    time_steps("six sheets", &def, STEPS, NULL);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

/* ---- a ball presses the top of a body ---- */

typedef struct press {
    const char *name;
    double top[3];        /* where the ball touches at first */
    double radius, depth; /* m */
} press;

static press pressed;

/* in and out in 100 steps */
static void move_ball(pel_sim *sim, int step)
{
    pel_error error;
    const double rotation[4] = {0, 0, 0, 1}, down = pressed.depth * (0.5 - 0.5 * cos(0.02 * acos(-1) * step));
    const double place[3] = {pressed.top[0], pressed.top[1], pressed.top[2] + pressed.radius - down};
    check(pel_sim_set_tool_pose(sim, 0, place, rotation, &error), &error);
}

static void press_body(const press *how, const pel_body_def *body, int steps)
{
    pel_model *model = make_model(body);
    const double *top = body->mesh->positions[0];
    for (int32_t v = 1; v < body->mesh->vertex_count; v++)
        top = body->mesh->positions[v][2] > top[2] ? body->mesh->positions[v] : top;
    pressed = *how;
    for (int i = 0; i < 3; i++)
        pressed.top[i] = top[i];
    const pel_pose_key start = {0, {top[0], top[1], top[2] + 1.01 * how->radius}, {0, 0, 0, 1}, {0, 0, 0}};
    pel_tool_def tool = pel_tool_def_default();
    tool.name = "ball";
    tool.radius = how->radius;
    tool.keys = &start;
    tool.key_count = 1;
    pel_sim_def def = pel_sim_def_default();
    def.model = model;
    def.tools = &tool;
    def.tool_count = 1;
    def.thread_count = 1;
    time_steps(how->name, &def, steps, move_ball);
    pel_model_destroy(model);
}

/* tissue of scenes/organ-press.yaml */
static void press_tissue(void)
{
    const press how = {.name = "refined tissue", .radius = 0.02, .depth = 0.01};
    pel_mesh *mesh = make_sphere(32, 0.08);
    pel_body_def body = pel_body_def_default();
    body.name = "tissue";
    body.mesh = mesh;
    body.mass_kind = PEL_MASS_TOTAL;
    body.mass = 1.5;
    body.spring_stiffness.value = 60;
    body.spring_damping.value = 0.1;
    body.volumetric_stiffness.value = 120;
    body.volumetric_damping.value = 0.1;
    body.volumetric_by_area = true;
    body.refine.levels = 2;
    body.refine.near_tools = 0.003;
    press_body(&how, &body, 3000);
    pel_mesh_destroy(mesh);
}

static void press_sphere(void)
{
    const press how = {.name = "sphere of 500", .radius = 0.4, .depth = 0.2};
    pel_mesh *mesh = make_sphere(5, 1);
    pel_body_def body = pel_body_def_default();
    body.name = "sphere";
    body.mesh = mesh;
    press_body(&how, &body, MOST_STEPS);
    pel_mesh_destroy(mesh);
}

int main(int argc, char **argv)
{
    rounds = argc > 1 ? atoi(argv[1]) : rounds;
    begin = argc > 2 ? argv[2] : begin;
    shell_threads = argc > 3 ? atoi(argv[3]) : shell_threads;
    printf("%-16s %10s %10s %10s\n", "steps [us]", "mean", "p99", "p99.9");
    dent("xpbd, contact", PEL_METHOD_XPBD, true);
    dent("xpbd, free", PEL_METHOD_XPBD, false);
    dent("pbd, contact", PEL_METHOD_PBD, true);
    stack_sheets();
    press_tissue();
    press_sphere();
    return 0;
}
