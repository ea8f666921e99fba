/* Times a step of Newton's method: one linear system with forces before and after it, on a geodesic sphere with hinges
   and with mid-edge bending, with a factor of its own and with one that is kept; and the making of pattern and order,
   as after an event of refinement or where contact couples other vertices. Then statics from rest: a sheet clamped at
   one edge, with about as many triangles, that bends under its weight.
   usage: bench_newton [frequency, 32 by default] [threads, 2 by default] */
#include "base/pool.h"
#include "bench.h"
#include "newton/newton.h"
#include "pellicle/shape.h"
#include "pellicle/sim_reading.h"

#include <stdio.h>
#include <stdlib.h>

enum { ROUNDS = 15 };

typedef struct run {
    pel_model *model;
    pel_newton *newton;
    pel_newton_problem problem;
    double *unknowns, *stiffness, (*points)[3];
    bool keeps;
} run;

/* masses of 1 kg/m2 in steps of 10 ms; forces that move the points by a thousandth of the radius */
static void prepare(run *on)
{
    int32_t count = on->model->vertex_count;
    on->unknowns = calloc((size_t)pel_newton_pattern(on->newton)->unknown_count, sizeof *on->unknowns);
    on->stiffness = calloc((size_t)count, sizeof *on->stiffness);
    on->points = calloc((size_t)count, sizeof *on->points);
    for (int32_t v = 0; v < count; v++) {
        on->stiffness[v] = (double)on->model->mass[v] / 1e-4;
        pel_vertex_position(on->model->rest, v, on->points[v]);
        pel_vec3_copy(on->points[v], on->unknowns + 3 * (size_t)v);
        for (int k = 0; k < 3; k++)
            on->points[v][k] *= 1 + 1e-3 * sin(7 * on->points[v][(k + 1) % 3]);
    }
    on->problem = (pel_newton_problem){
        .point_stiffness = on->stiffness,
        .points = (const double(*)[3])on->points,
        .iterations = 1,
        .is_dynamic = true,
    };
}

static void step(void *context)
{
    run *on = context;
    pel_newton_result result;
    on->problem.keeps_factor = on->keeps;
    if (!on->keeps)
        pel_newton_forget(on->newton);
    pel_newton_run(on->newton, &on->problem, on->unknowns, &result, NULL);
}

static void order(void *context)
{
    run *on = context;
    pel_newton_rebuild(on->newton);
    on->keeps = false;
    step(on);
}

static void time_model(const char *name, pel_bending_model bending, int32_t frequency, pel_pool *pool)
{
    run on = {.keeps = false};
    pel_shape_def shape = pel_shape_def_default(PEL_SHAPE_GEODESIC_SPHERE);
    pel_mesh *mesh;
    pel_error error;
    shape.frequency = frequency;
    if (pel_shape_create(&shape, &mesh, &error) != PEL_OK)
        return;
    pel_body_def body = pel_body_def_sheet("ball", mesh, 1e6, 1e-2, 1000);
    body.shell.membrane.kind = PEL_MEMBRANE_STVK;
    body.thickness.value = 1e-3;
    body.shell.bending.model = bending;
    pel_model_def def = pel_model_def_default();
    def.bodies = &body;
    def.body_count = 1;
    if (pel_model_create(&def, &on.model, &error) == PEL_OK &&
        pel_newton_create(on.model, pool, &on.newton, &error) == PEL_OK) {
        prepare(&on);
        printf("%s, %d triangles, %d unknowns\n", name, (int)mesh->triangle_count,
               (int)pel_newton_pattern(on.newton)->unknown_count);
        bench_part("step, factor of its own", ROUNDS, step, &on);
        on.keeps = true;
        bench_part("step, factor kept", ROUNDS, step, &on);
        bench_part("pattern, order and a step", ROUNDS, order, &on);
    }
    free(on.unknowns);
    free(on.stiffness);
    free(on.points);
    pel_newton_destroy(on.newton);
    pel_model_destroy(on.model);
    pel_mesh_destroy(mesh);
}

/* a sheet of steel, 0.2 m long, 0.5 mm thick, that goes down at its end by a fifth of its length */
typedef struct statics {
    pel_sim *sim;
    void *rest;
    size_t size;
    int32_t iterations;
} statics;

static void solve(void *context)
{
    statics *on = context;
    pel_solver_reading reading;
    pel_error error;
    bench_check(pel_sim_load(on->sim, on->rest, on->size, &error), &error);
    bench_check(pel_sim_step(on->sim, &error), &error);
    pel_sim_get_solver(on->sim, &reading);
    if (!reading.converged)
        printf("  not converged: %g N are left\n", reading.residual);
    on->iterations = reading.iterations;
}

static void time_statics(int32_t frequency, int threads)
{
    statics on = {.sim = NULL};
    int32_t cells = (int32_t)lround(sqrt(10.0) * frequency), edge_count = 0;
    pel_shape_def shape = pel_shape_def_default(PEL_SHAPE_GRID);
    pel_mesh *mesh;
    pel_error error;
    shape.nx = shape.ny = cells;
    shape.size_x = shape.size_y = 0.2;
    shape.diagonals = PEL_GRID_UNION_JACK;
    bench_check(pel_shape_create(&shape, &mesh, &error), &error);
    int32_t *edge = bench_allocate((size_t)cells + 1, sizeof *edge);
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        if (mesh->positions[v][0] < -0.0999 && edge_count <= cells)
            edge[edge_count++] = v;
    pel_body_def body = pel_body_def_sheet("sheet", mesh, 2e10, 5e-4, 7800);
    body.shell.membrane.kind = PEL_MEMBRANE_STVK;
    body.shell.membrane.poisson = 0.3;
    body.shell.bending.model = PEL_BENDING_MIDEDGE;
    pel_model *model;
    pel_model_def def = pel_model_def_default();
    def.bodies = &body;
    def.body_count = 1;
    def.gravity[2] = -9.81;
    bench_check(pel_model_create(&def, &model, &error), &error);
    pel_support_def clamp = pel_support_def_default();
    clamp.vertices = edge;
    clamp.vertex_count = edge_count;
    clamp.fix_rotation = true;
    pel_sim_def sim = pel_sim_def_default();
    sim.model = model;
    sim.supports = &clamp;
    sim.support_count = 1;
    sim.thread_count = threads;
    sim.solver.method = PEL_METHOD_STATIC;
    sim.solver.dt = 1;
    bench_check(pel_sim_create(&sim, &on.sim, &error), &error);
    on.size = pel_sim_save_size(on.sim);
    on.rest = bench_allocate(on.size, 1);
    pel_sim_save(on.sim, on.rest);
    printf("statics, %d triangles\n", (int)mesh->triangle_count);
    bench_part("from rest to the balance", 3, solve, &on);
    printf("  %d linear systems\n", (int)on.iterations);
    pel_sim_destroy(on.sim);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
    free(on.rest);
    free(edge);
}

int main(int argc, char **argv)
{
    int32_t frequency = argc > 1 ? atoi(argv[1]) : 32;
    int threads = argc > 2 ? atoi(argv[2]) : 2;
    pel_pool *pool = NULL;
    pel_error error;
    if (threads > 1 && pel_pool_create(threads, &pool, &error) != PEL_OK)
        return 1;
    time_model("hinges", PEL_BENDING_HINGE, frequency, pool);
    time_model("mid-edge", PEL_BENDING_MIDEDGE, frequency, pool);
    pel_pool_destroy(pool);
    time_statics(frequency, threads);
    return 0;
}
