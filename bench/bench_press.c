/* Steps of paper A's press of an organ (scenes/organ-press.yaml) with one tool, on the base and refined under the tool
   to one and two levels: what tools near refined surfaces cost.
   usage: bench_press [mesh file in metres [levels]]; without one, an uneven closed body of 20,480 triangles */
#include "bench.h"
#include "pellicle/sim_surface.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { STEPS = 200, ROUNDS = 3 };

static pel_mesh *make_organ(void)
{
    pel_mesh *mesh = bench_sphere(32);
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        double *x = mesh->positions[v];
        double lobe = 1 + 0.15 * cos(3 * atan2(x[1], x[0])) * (1 - x[2] * x[2]) + 0.05 * sin(5 * x[0]);
        x[0] *= 0.096 * lobe;
        x[1] *= 0.08 * lobe;
        x[2] *= 0.06 * lobe;
    }
    return mesh;
}

/* a ball of 4 cm diameter, 1 cm into the top and out again */
static void press_path(const pel_mesh *mesh, double radius, pel_pose_key keys[3])
{
    const double *top = mesh->positions[0];
    for (int32_t v = 1; v < mesh->vertex_count; v++)
        top = mesh->positions[v][2] > top[2] ? mesh->positions[v] : top;
    const double lift[3] = {1e-3, -0.01, 1e-3};
    for (int k = 0; k < 3; k++)
        keys[k] =
            (pel_pose_key){0.005 * STEPS * k, {top[0], top[1], top[2] + radius + lift[k]}, {0, 0, 0, 1}, {0, 0, 0}};
}

static void press(const pel_mesh *mesh, int32_t levels)
{
    pel_error error;
    const pel_body_def body = bench_organ(mesh, levels);
    pel_model *model = bench_model(&body);
    pel_pose_key keys[3];
    press_path(mesh, 0.02, keys);
    pel_tool_def tool = pel_tool_def_default();
    tool.name = "ball";
    tool.radius = 0.02;
    tool.keys = keys;
    tool.key_count = 3;
    pel_sim_def def = pel_sim_def_default();
    def.model = model;
    def.tools = &tool;
    def.tool_count = 1;
    def.thread_count = 1;
    static double times[STEPS];
    int32_t most = 0;
    for (int round = 0; round < ROUNDS; round++) {
        pel_sim *sim;
        bench_check(pel_sim_create(&def, &sim, &error), &error);
        for (int n = 0; n < STEPS; n++) {
            double start = pel_thread_seconds(), time;
            bench_check(pel_sim_step(sim, &error), &error);
            time = pel_thread_seconds() - start;
            times[n] = round == 0 ? time : fmin(times[n], time);
            int32_t count = pel_sim_triangle_count(sim, 0);
            most = count > most ? count : most;
        }
        pel_sim_destroy(sim);
    }
    double sum = 0;
    for (int n = 0; n < STEPS; n++)
        sum += times[n];
    const bench_spread time = bench_spread_of(times, STEPS);
    printf("%d levels  %6d to %6d triangles (%+.0f %%)  step mean %5.0f us  median %5.0f us  p99 %5.0f us  longest "
           "%5.0f us\n",
           (int)levels, (int)mesh->triangle_count, (int)most, 100.0 * most / mesh->triangle_count - 100,
           1e6 * sum / STEPS, 1e6 * time.median, 1e6 * time.percentile_99, 1e6 * time.most);
    pel_model_destroy(model);
}

int main(int argc, char **argv)
{
    pel_mesh *mesh = argc > 1 ? bench_read(argv[1]) : make_organ();
    int32_t only = argc > 2 ? atoi(argv[2]) : -1;
    for (int32_t levels = 0; levels <= 2; levels++)
        if (only < 0 || levels == only)
            press(mesh, levels);
    pel_mesh_destroy(mesh);
    return 0;
}
