/* Times sweeps of position-based dynamics on a geodesic sphere: the wide kernels, with one thread and more, beside the
   plain ones, which run the same source lane by lane in the same order and give the same bits. Sweeps alone, without
   prediction, pressure and contacts; docs/performance.md has what other libraries need for the same work.
   usage: bench_project [frequency, 32 by default] [threads, 2 by default] */
#include "bench.h"
#include "model/state.h"
#include "solve/project.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ROUNDS = 25, SWEEPS = 5 };

#define DISTURBANCE 0.001

static pel_model *make_model(int32_t frequency, pel_membrane_kind material, pel_bending_model bending)
{
    pel_mesh *mesh = bench_sphere(frequency);
    pel_body_def body = pel_body_def_sheet("sphere", mesh, 1e6, 0.01, 1000);
    body.shell.membrane.kind = material;
    body.shell.bending.model = bending;
    pel_model *model = bench_model(&body);
    pel_mesh_destroy(mesh);
    return model;
}

/* the rest shape moved by up to half of size, DISTURBANCE being 2 % of an edge */
static void disturb(const pel_model *model, pel_state *state, double size)
{
    uint32_t seed = 1;
    for (int32_t v = 0; v < model->vertex_count; v++) {
        state->position_next[v] = model->rest[v];
        for (int i = 0; i < 3; i++) {
            seed = seed * 1664525u + 1013904223u;
            state->position_next[v][i] += (pel_real)((seed / 4294967296.0 - 0.5) * size);
        }
        state->position_next[v][3] = model->inverse_mass[v];
    }
}

static bench_spread time_sweeps(pel_projector *projector, const pel_model *model, pel_state *state, double size)
{
    double times[ROUNDS];
    const pel_project_time time = {projector->substep, 1, 1, projector->solver.iterations, projector->substep, NULL};
    for (int round = 0; round < ROUNDS; round++) {
        disturb(model, state, size);
        pel_projector_begin(projector, state, 0);
        pel_project_body_set_time(&projector->model->bodies[0], &projector->batches->bodies[0], state->factors[0],
                                  &time);
        double begin = pel_seconds();
        for (int i = 0; i < SWEEPS; i++)
            pel_project_sweep(projector, state->position_next);
        times[round] = pel_seconds() - begin;
    }
    return bench_spread_of(times, ROUNDS);
}

static double constraint_count(const pel_projector *projector)
{
    double count = 0;
    for (int32_t i = 0; i < projector->batches->bodies[0].batch_count; i++) {
        const pel_batch *batch = &projector->batches->bodies[0].batches[i];
        for (int32_t block = 0; batch->is_projected && block < batch->block_count; block++)
            count += batch->lane_counts[block];
    }
    return count;
}

static void bench_moved(const char *name, int32_t frequency, pel_method method, pel_membrane_kind material,
                        pel_bending_model bending, int threads, double size)
{
    pel_error error;
    pel_model *model = make_model(frequency, material, bending);
    const pel_solver_def solver = {.method = method, .dt = 1.0 / 60, .iterations = 1, .substeps = 1};
    pel_batches *batches;
    pel_projector *projector;
    pel_state *state;
    pel_pool *pool;
    bench_check(pel_batches_create(model, method, &batches, &error), &error);
    bench_check(pel_projector_create(batches, &solver, &projector, &error), &error);
    bench_check(pel_state_create(model, true, &state, &error), &error);
    state->bending[0].weight = 0.01;
    bench_check(pel_pool_create(threads, &pool, &error), &error);
    const double count = constraint_count(projector) * SWEEPS;
    bench_spread times[3];
    projector->is_plain = true;
    times[0] = time_sweeps(projector, model, state, size);
    projector->is_plain = false;
    times[1] = time_sweeps(projector, model, state, size);
    projector->pool = pool;
    times[2] = time_sweeps(projector, model, state, size);
    printf("%-34s", name);
    for (int i = 0; i < 3; i++)
        printf("  %7.3f %7.3f %6.2f", 1e3 * times[i].least, 1e3 * times[i].median, 1e9 * times[i].median / count);
    printf("\n");
    pel_pool_destroy(pool);
    pel_state_destroy(state);
    pel_projector_destroy(projector);
    pel_batches_destroy(batches);
    pel_model_destroy(model);
}

static void bench(const char *name, int32_t frequency, pel_method method, pel_membrane_kind material,
                  pel_bending_model bending, int threads)
{
    bench_moved(name, frequency, method, material, bending, threads, DISTURBANCE);
}

int main(int argc, char **argv)
{
    int32_t frequency = argc > 1 ? atoi(argv[1]) : 32;
    int threads = argc > 2 ? atoi(argv[2]) : 2;
    printf("%d vertices, %d triangles, %d sweeps, %s, blocks of %d\n", 10 * frequency * frequency + 2,
           20 * frequency * frequency, SWEEPS, sizeof(pel_real) == 8 ? "double" : "float", PEL_BLOCK);
    printf("%-34s  plain min  median ms  ns | wide min median ms  ns | %d threads\n", "", threads);
    const pel_membrane_kind stvk = PEL_MEMBRANE_STVK;
    bench("pbd-distance", frequency, PEL_METHOD_PBD_DISTANCE, stvk, PEL_BENDING_NONE, threads);
    bench("pbd stvk", frequency, PEL_METHOD_PBD, stvk, PEL_BENDING_NONE, threads);
    bench("pbd stvk + isometric", frequency, PEL_METHOD_PBD, stvk, PEL_BENDING_ISOMETRIC, threads);
    bench("pbd stvk + hinge", frequency, PEL_METHOD_PBD, stvk, PEL_BENDING_HINGE, threads);
    bench("pbd corotated + isometric", frequency, PEL_METHOD_PBD, PEL_MEMBRANE_COROTATED, PEL_BENDING_ISOMETRIC,
          threads);
    bench("pbd neo-hookean + isometric", frequency, PEL_METHOD_PBD, PEL_MEMBRANE_NEO_HOOKEAN, PEL_BENDING_ISOMETRIC,
          threads);
    /* a surface at rest, where angles are what rounding leaves of zero */
    bench_moved("pbd stvk + hinge at rest", frequency, PEL_METHOD_PBD, stvk, PEL_BENDING_HINGE, threads, 0);
    bench("xpbd stvk + isometric", frequency, PEL_METHOD_XPBD, stvk, PEL_BENDING_ISOMETRIC, threads);
    bench("xpbd stvk + hinge", frequency, PEL_METHOD_XPBD, stvk, PEL_BENDING_HINGE, threads);
    bench("xpbd neo-hookean + hinge", frequency, PEL_METHOD_XPBD, PEL_MEMBRANE_NEO_HOOKEAN, PEL_BENDING_HINGE, threads);
    bench("xpbd mooney-rivlin + hinge", frequency, PEL_METHOD_XPBD, PEL_MEMBRANE_MOONEY_RIVLIN, PEL_BENDING_HINGE,
          threads);
    return 0;
}
