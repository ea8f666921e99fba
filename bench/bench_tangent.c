/* Times energy and gradient, element matrices, extrapolated stresses and finite steps of a whole model in double, on a
   geodesic sphere, with hinges and with mid-edge bending.
   usage: bench_tangent [frequency, 32 by default] [threads, 1 by default] */
#include "bench.h"
#include "force/tangent.h"

#include <stdio.h>
#include <stdlib.h>

enum { ROUNDS = 40, GROUP = 8, CHUNK = 32 };

typedef struct run {
    pel_tangent *tangent;
    const pel_tangent_pattern *pattern;
    pel_tangent_input input;
    pel_pool *pool;
    double *unknowns, *gradient, *step, *stresses;
    double *sums; /* (chunks) so that matrices are used */
} run;

static void matrix_chunk(void *context, int32_t chunk)
{
    const run *on = context;
    double blocks[GROUP * 144], sum = 0;
    int32_t elements[GROUP], end = (chunk + 1) * CHUNK * GROUP;
    for (int32_t e = chunk * CHUNK * GROUP; e < end && e < on->pattern->element_count;) {
        int32_t count = 0, first = e;
        while (count < GROUP && e < on->pattern->element_count &&
               on->pattern->element_kind[e] == on->pattern->element_kind[first])
            elements[count++] = e++;
        pel_tangent_matrices(on->tangent, elements, count, blocks);
        sum += blocks[0];
    }
    on->sums[chunk] = sum;
}

static void part_energy(void *context)
{
    run *on = context;
    pel_tangent_evaluate(on->tangent, &on->input, on->pool, NULL);
}
static void part_gradient(void *context)
{
    run *on = context;
    pel_tangent_evaluate(on->tangent, &on->input, on->pool, on->gradient);
}
static void part_matrices(void *context)
{
    run *on = context;
    pel_pool_run(on->pool, on->pattern->element_count / (CHUNK * GROUP) + 1, matrix_chunk, on);
}
static void part_extrapolate(void *context)
{
    run *on = context;
    pel_tangent_extrapolate(on->tangent, &on->input, on->step, on->pool, on->stresses);
    pel_tangent_evaluate(on->tangent, &on->input, on->pool, NULL);
}
static void part_advance(void *context)
{
    run *on = context;
    pel_tangent_advance(on->tangent, on->unknowns, on->step, 1e-3, on->pool);
}

static void time_model(const char *name, int32_t frequency, pel_bending_model bending, pel_pool *pool)
{
    pel_mesh *mesh = bench_sphere(frequency);
    pel_body_def body = pel_body_def_sheet("sphere", mesh, 1e6, 0.01, 1000);
    body.shell.membrane.kind = PEL_MEMBRANE_STVK;
    body.shell.bending.model = bending;
    pel_model *model = bench_model(&body);
    run on = {.pool = pool};
    pel_error error;
    bench_check(pel_tangent_create(model, &on.tangent, &error), &error);
    on.pattern = pel_tangent_pattern_of(on.tangent);
    size_t count = (size_t)on.pattern->unknown_count;
    on.unknowns = bench_allocate(count, sizeof(double));
    on.gradient = bench_allocate(count, sizeof(double));
    on.step = bench_allocate(count, sizeof(double));
    on.stresses = bench_allocate((size_t)on.pattern->stress_count, sizeof(double));
    on.sums = bench_allocate((size_t)on.pattern->element_count / (CHUNK * GROUP) + 1, sizeof(double));
    uint32_t seed = 1;
    for (size_t i = 0; i < count; i++) {
        seed = seed * 1664525u + 1013904223u;
        on.step[i] = 1e-3 * (seed / 4294967296.0 - 0.5);
        on.unknowns[i] = i < 3 * (size_t)model->vertex_count ? (double)model->rest[i / 3][i % 3] + on.step[i] : 0;
    }
    on.input.unknowns = on.unknowns;
    printf("%s: %d triangles, %d elements, %d unknowns\n", name, (int)mesh->triangle_count,
           (int)on.pattern->element_count, (int)count);
    bench_part("energy", ROUNDS, part_energy, &on);
    bench_part("gradient", ROUNDS, part_gradient, &on);
    bench_part("matrices", ROUNDS, part_matrices, &on);
    bench_part("extrapolate", ROUNDS, part_extrapolate, &on);
    bench_part("advance", ROUNDS, part_advance, &on);
    double *arrays[] = {on.unknowns, on.gradient, on.step, on.stresses, on.sums};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++)
        free(arrays[i]);
    pel_tangent_destroy(on.tangent);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

int main(int argc, char **argv)
{
    int32_t frequency = argc > 1 ? atoi(argv[1]) : 32;
    pel_pool *pool;
    pel_error error;
    bench_check(pel_pool_create(argc > 2 ? atoi(argv[2]) : 1, &pool, &error), &error);
    time_model("hinge", frequency, PEL_BENDING_HINGE, pool);
    time_model("midedge", frequency, PEL_BENDING_MIDEDGE, pool);
    pel_pool_destroy(pool);
    return 0;
}
