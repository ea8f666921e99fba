/* What a force loop waits for: steps of a simulation with a tool in contact, syncs and updates of pel_haptic.
   usage: bench_haptic [steps [mesh file in metres]]; 20,000 steps by default. Times of steps are those of the thread,
   less that of reading its clock, which is a call of the system, and by the clock; how late the loop's own thread is
   measures `examples/haptic thread 60`. */
#include "bench.h"
#include "pellicle/haptic.h"
#include "pellicle/sim_surface.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { UPDATES = 10 };

static bench_spread print_times(const char *name, double *times, int32_t count)
{
    bench_spread spread = bench_spread_of(times, count);
    printf("  %-22s median %7.2f us  p99 %7.2f us  p99.9 %7.2f us  longest %7.2f us\n", name, 1e6 * spread.median,
           1e6 * spread.percentile_99, 1e6 * times[(int64_t)(0.999 * (count - 1))], 1e6 * spread.most);
    return spread;
}

/* least time between two readings of the thread's clock */
static double reading_seconds(void)
{
    double least = 1;
    for (int i = 0; i < 10000; i++) {
        double begin = pel_thread_seconds();
        least = fmin(least, pel_thread_seconds() - begin);
    }
    return least;
}

/* a ball of this radius presses the top of the mesh, in and out in 2 s of 100 Hz, by 1.5 times its depth */
static void press(const char *name, const pel_mesh *mesh, const pel_body_def *body, double radius, double depth,
                  int32_t steps)
{
    pel_error error;
    const double *top = mesh->positions[0];
    for (int32_t v = 1; v < mesh->vertex_count; v++)
        top = mesh->positions[v][2] > top[2] ? mesh->positions[v] : top;
    const pel_pose_key start = {0, {top[0], top[1], top[2] + 1.01 * radius}, {0, 0, 0, 1}, {0, 0, 0}};
    pel_model *model = bench_model(body);
    pel_tool_def tool = pel_tool_def_default();
    tool.name = "ball";
    tool.radius = radius;
    tool.keys = &start;
    tool.key_count = 1;
    pel_sim_def def = pel_sim_def_default();
    def.model = model;
    def.tools = &tool;
    def.tool_count = 1;
    def.thread_count = 1;
    pel_sim *sim;
    pel_haptic *haptic;
    bench_check(pel_sim_create(&def, &sim, &error), &error);
    pel_haptic_def loop = pel_haptic_def_default();
    loop.sim = sim;
    bench_check(pel_haptic_create(&loop, &haptic, &error), &error);
    double *by_thread = bench_allocate((size_t)steps, sizeof(double)),
           *by_clock = bench_allocate((size_t)steps, sizeof(double));
    double *syncs = bench_allocate((size_t)steps, sizeof(double)),
           *updates = bench_allocate((size_t)steps, sizeof(double));
    const double reading = reading_seconds();
    for (int32_t n = 0; n < steps; n++) {
        double force[3], hand[3] = {top[0], top[1], start.position[2] - depth * (0.5 - 0.5 * cos(0.01 * acos(-1) * n))};
        double begin = pel_thread_seconds(), clock;
        bench_check(pel_haptic_sync(haptic, &error), &error);
        syncs[n] = pel_thread_seconds() - begin - reading;
        begin = pel_thread_seconds();
        clock = pel_seconds();
        bench_check(pel_sim_step(sim, &error), &error);
        by_clock[n] = pel_seconds() - clock;
        by_thread[n] = pel_thread_seconds() - begin - reading;
        begin = pel_thread_seconds();
        for (int i = 0; i < UPDATES; i++)
            bench_check(pel_haptic_update(haptic, hand, NULL, force, &error), &error);
        updates[n] = (pel_thread_seconds() - begin - reading) / UPDATES;
    }
    printf("%s: %d triangles, %d at the end, %d steps\n", name, (int)mesh->triangle_count,
           (int)pel_sim_triangle_count(sim, 0), (int)steps);
    bench_spread step = print_times("step, of the thread", by_thread, steps);
    print_times("step, by the clock", by_clock, steps);
    print_times("sync", syncs, steps);
    print_times("update", updates, steps);
    printf("  %-22s %7.0f\n", "steps a second", 1 / step.median);
    free(by_thread);
    free(by_clock);
    free(syncs);
    free(updates);
    pel_haptic_destroy(haptic);
    pel_sim_destroy(sim);
    pel_model_destroy(model);
}

int main(int argc, char **argv)
{
    int32_t steps = argc > 1 ? atoi(argv[1]) : 20000;
    pel_body_def body = pel_body_def_default();
    body.name = "body";

    /* paper A's sphere */
    pel_mesh *ball = bench_sphere(5);
    body.mesh = ball;
    press("sphere of frequency 5", ball, &body, 0.4, 0.2, steps);
    pel_mesh_destroy(ball);

    /* tissue of the size of an organ, refined under the tool */
    pel_mesh *organ = argc > 2 ? bench_read(argv[2]) : bench_sphere(32);
    for (int32_t v = 0; argc <= 2 && v < organ->vertex_count; v++)
        for (int i = 0; i < 3; i++)
            organ->positions[v][i] *= 0.08;
    for (int32_t levels = 0; levels <= 2; levels++) {
        char name[32];
        snprintf(name, sizeof name, "tissue, %d levels", (int)levels);
        body = bench_organ(organ, levels);
        press(name, organ, &body, 0.02, 0.01, steps);
    }
    pel_mesh_destroy(organ);
    return 0;
}
