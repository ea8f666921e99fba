/* Paper A's table 1 (500 steps of a sphere: base, refined everywhere, refined locally), and what an event costs. */
#include "bench.h"
#include "pellicle/sim_surface.h"

#include <stdio.h>

enum { ROUNDS = 31, STEPS = 500, EVENTS = 200 };

typedef struct sphere {
    pel_mesh *mesh;
    pel_model *model;
    pel_sim *sim;
} sphere;

static sphere make_sphere(int32_t frequency, int32_t levels, bool everywhere)
{
    sphere made = {.mesh = bench_sphere(frequency)};
    pel_error error;
    pel_body_def body = pel_body_def_default();
    body.name = "ball";
    body.mesh = made.mesh;
    body.volumetric_by_area = true;
    body.refine.levels = levels;
    body.refine.everywhere = everywhere;
    made.model = bench_model(&body);
    const int32_t pole = 5;
    pel_load_def load = pel_load_def_default();
    load.force[2] = -1;
    load.vertices = &pole;
    load.vertex_count = 1;
    pel_sim_def def = pel_sim_def_default();
    def.model = made.model;
    def.solver.alpha = 50;
    def.loads = &load;
    def.load_count = 1;
    def.thread_count = 1;
    bench_check(pel_sim_create(&def, &made.sim, &error), &error);
    return made;
}

static void end_sphere(sphere *made)
{
    pel_sim_destroy(made->sim);
    pel_model_destroy(made->model);
    pel_mesh_destroy(made->mesh);
}

/* the first vertex whose 2-ring gives the paper's 294 vertices */
static void refine_as_paper(pel_sim *sim)
{
    pel_error error;
    for (int32_t v = 12; pel_sim_vertex_count(sim, 0) != 294; v++) {
        if (v > 12)
            bench_check(pel_sim_refine(sim, 0, v - 1, 0, &error), &error);
        bench_check(pel_sim_refine(sim, 0, v, 1, &error), &error);
    }
}

static double run(sphere *made)
{
    pel_error error;
    double start = pel_seconds();
    for (int n = 0; n < STEPS; n++)
        bench_check(pel_sim_step(made->sim, &error), &error);
    return pel_seconds() - start;
}

static void table(void)
{
    sphere spheres[3] = {make_sphere(5, 0, false), make_sphere(5, 1, true), make_sphere(5, 1, false)};
    const char *names[3] = {"base", "everywhere", "local"};
    double times[3][ROUNDS];
    refine_as_paper(spheres[2].sim);
    for (int round = 0; round < ROUNDS; round++)
        for (int i = 0; i < 3; i++)
            times[i][round] = run(&spheres[i]);
    for (int i = 0; i < 3; i++) {
        const bench_spread time = bench_spread_of(times[i], ROUNDS);
        printf("%-12s %5d vertices %5d triangles   min %7.3f ms  median %7.3f ms of %d steps   %.2f of the base\n",
               names[i], (int)pel_sim_vertex_count(spheres[i].sim, 0), (int)pel_sim_triangle_count(spheres[i].sim, 0),
               1e3 * time.least, 1e3 * time.median, STEPS, time.least / times[0][0]);
        end_sphere(&spheres[i]);
    }
}

static void events(int32_t frequency)
{
    sphere made = make_sphere(frequency, 2, false);
    pel_error error;
    double refine[EVENTS], coarsen[EVENTS];
    int32_t v = made.mesh->vertex_count / 2;
    for (int n = 0; n < EVENTS; n++) {
        double start = pel_seconds();
        bench_check(pel_sim_refine(made.sim, 0, v, 1, &error), &error);
        double middle = pel_seconds();
        bench_check(pel_sim_refine(made.sim, 0, v, 0, &error), &error);
        coarsen[n] = pel_seconds() - middle;
        refine[n] = middle - start;
    }
    const bench_spread there = bench_spread_of(refine, EVENTS), back = bench_spread_of(coarsen, EVENTS);
    printf("event on %6d triangles   refine min %6.1f us median %6.1f us   coarsen min %6.1f us median %6.1f us\n",
           (int)made.mesh->triangle_count, 1e6 * there.least, 1e6 * there.median, 1e6 * back.least, 1e6 * back.median);
    end_sphere(&made);
}

int main(void)
{
    table();
    events(5);
    events(32);
    return 0;
}
