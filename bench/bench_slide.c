/* How even the steps are while a tool slides over an organ that refines under it: median, 99th percentile and longest
   step, beside the same slide without refinement.
   usage: bench_slide [mesh file]; without one, an uneven closed body of 20,480 triangles */
#include "bench.h"
#include "pellicle/sim_surface.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { STEPS = 3000 };

/* a ball with three lobes, flattened like a liver */
static pel_mesh *make_organ(void)
{
    pel_mesh *mesh = bench_sphere(32);
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        double *x = mesh->positions[v];
        double lobe = 1 + 0.15 * cos(3 * atan2(x[1], x[0])) * (1 - x[2] * x[2]) + 0.05 * sin(5 * x[0]);
        x[0] *= 1.2 * lobe;
        x[1] *= lobe;
        x[2] *= 0.7 * lobe;
    }
    return mesh;
}

/* the tool's centre, so that a ball of this radius dips into the top of the body while it slides along x */
static void slide_path(const pel_mesh *mesh, double radius, double depth, pel_pose_key *keys, int count,
                       double duration)
{
    double low = HUGE_VAL, high = -HUGE_VAL;
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        low = fmin(low, mesh->positions[v][0]);
        high = fmax(high, mesh->positions[v][0]);
    }
    for (int k = 0; k < count; k++) {
        double x = low + (high - low) * (0.3 + 0.4 * k / (count - 1)), top = -HUGE_VAL;
        for (int32_t v = 0; v < mesh->vertex_count; v++) {
            const double *p = mesh->positions[v];
            double square = (p[0] - x) * (p[0] - x) + p[1] * p[1];
            if (square < radius * radius)
                top = fmax(top, p[2] + sqrt(radius * radius - square));
        }
        double lift = k == 0 ? radius : -depth;
        keys[k] = (pel_pose_key){duration * k / (count - 1), {x, 0, top + lift}, {0, 0, 0, 1}, {0}};
    }
}

static void slide(const pel_mesh *mesh, const char *name, const pel_refine_def *refine)
{
    enum { KEYS = 30 };
    pel_error error;
    pel_body_def body = pel_body_def_default();
    body.name = "organ";
    body.mesh = mesh;
    body.volumetric_by_area = true;
    body.refine = *refine;
    pel_model *model = bench_model(&body);
    pel_pose_key keys[KEYS];
    slide_path(mesh, 0.15, 0.05, keys, KEYS, 0.01 * STEPS);
    pel_tool_def tool = pel_tool_def_default();
    tool.name = "probe";
    tool.radius = 0.15;
    tool.keys = keys;
    tool.key_count = KEYS;
    pel_sim *sim;
    pel_sim_def def = pel_sim_def_default();
    def.model = model;
    def.tools = &tool;
    def.tool_count = 1;
    def.thread_count = 1;
    bench_check(pel_sim_create(&def, &sim, &error), &error);
    static double times[STEPS];
    int32_t most = 0;
    for (int n = 0; n < STEPS; n++) {
        double start = pel_thread_seconds();
        bench_check(pel_sim_step(sim, &error), &error);
        times[n] = pel_thread_seconds() - start;
        int32_t count = pel_sim_triangle_count(sim, 0);
        most = count > most ? count : most;
    }
    int64_t events = pel_sim_surface_revision(sim, 0);
    const bench_spread time = bench_spread_of(times, STEPS);
    printf("%-22s %6d to %6d triangles  %4lld events  step median %6.0f us  p99 %6.0f us (%.2f x)  longest %6.0f us\n",
           name, (int)mesh->triangle_count, (int)most, (long long)events, 1e6 * time.median, 1e6 * time.percentile_99,
           time.percentile_99 / time.median, 1e6 * time.most);
    pel_sim_destroy(sim);
    pel_model_destroy(model);
}

int main(int argc, char **argv)
{
    pel_mesh *mesh = argc > 1 ? bench_read(argv[1]) : make_organ();
    pel_refine_def refine = pel_body_def_default().refine;
    slide(mesh, "no refinement", &refine);
    refine.levels = 2;
    refine.above = 1;
    refine.below = 0.5;
    slide(mesh, "by force", &refine);
    refine.near_tools = 0.03;
    slide(mesh, "by force and near tools", &refine);
    refine.above = 0;
    refine.near_tools = 0;
    refine.curvature_above = 0.5;
    refine.curvature_below = 0.25;
    slide(mesh, "by curvature", &refine);
    pel_mesh_destroy(mesh);
    return 0;
}
