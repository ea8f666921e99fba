/* Times a step of Newton's method: one linear system with forces before and after it, on a geodesic sphere with hinges
   and with mid-edge bending, with a factor of its own and with one that is kept; and the making of pattern and order,
   as after an event of refinement or where contact couples other vertices.
   usage: bench_newton [frequency, 32 by default] [threads, 2 by default] */
#include "base/pool.h"
#include "bench.h"
#include "pellicle/shape.h"
#include "solve/newton.h"

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
    pel_body_def body = pel_body_def_default();
    body.name = "ball";
    body.mesh = mesh;
    body.spring_stiffness.value = body.spring_damping.value = 0;
    body.volumetric_stiffness.value = body.volumetric_damping.value = 0;
    body.mass_kind = PEL_MASS_DENSITY;
    body.mass = 1000;
    body.thickness.value = 1e-3;
    body.shell.membrane.on = true;
    body.shell.membrane.young.value = 1e6;
    body.shell.membrane.thickness.value = 1e-2;
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
    return 0;
}
