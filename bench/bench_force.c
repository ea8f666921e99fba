/* Times the forces of shells on a geodesic sphere: membrane, bending, pressure, with one thread and more.
   usage: bench_force [frequency, 32 by default] [threads, 2 by default] */
#include "bench.h"
#include "force/shell_force.h"
#include "model/state.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ROUNDS = 60, CALLS = 3 };

static pel_model *make_model(int32_t frequency, pel_bending_model bending, bool pressed)
{
    pel_mesh *mesh = bench_sphere(frequency);
    pel_body_def body = pel_body_def_sheet("sphere", mesh, 1e6, 0.01, 1000);
    body.shell.membrane.kind = PEL_MEMBRANE_STVK;
    body.shell.bending.model = bending;
    body.shell.pressure.kind = pressed ? PEL_PRESSURE_VOLUME : PEL_PRESSURE_NONE;
    body.shell.pressure.bulk = 1e4;
    pel_model *model = bench_model(&body);
    pel_mesh_destroy(mesh);
    return model;
}

/* the rest shape moved by up to half of a thousandth of its radius */
static void disturb(const pel_model *model, pel_record *position)
{
    uint32_t seed = 1;
    for (int32_t v = 0; v < model->vertex_count; v++) {
        position[v] = model->rest[v];
        for (int i = 0; i < 3; i++) {
            seed = seed * 1664525u + 1013904223u;
            position[v][i] += (pel_real)((seed / 4294967296.0 - 0.5) * 1e-3);
        }
    }
}

static bench_spread time_forces(pel_shell_forces *forces, const pel_record *position, pel_pool *pool, pel_record *force)
{
    double times[ROUNDS];
    for (int round = 0; round < ROUNDS; round++) {
        double begin = pel_seconds();
        for (int i = 0; i < CALLS; i++)
            pel_shell_forces_add(forces, position, pel_instant(0), PEL_SHELL_ALL, pool, force);
        times[round] = (pel_seconds() - begin) / CALLS;
    }
    return bench_spread_of(times, ROUNDS);
}

static void bench(const char *name, int32_t frequency, pel_bending_model bending, bool pressed, int threads)
{
    pel_error error;
    pel_model *model = make_model(frequency, bending, pressed);
    pel_state *state;
    pel_batches *batches;
    pel_shell_forces *forces;
    pel_pool *pool;
    bench_check(pel_state_create(model, false, &state, &error), &error);
    bench_check(pel_batches_create(model, PEL_METHOD_EXPLICIT, &batches, &error), &error);
    bench_check(pel_shell_forces_create(batches, &forces, &error), &error);
    bench_check(pel_pool_create(threads, &pool, &error), &error);
    disturb(model, state->position);
    bench_spread one = time_forces(forces, state->position, NULL, state->position_next);
    bench_spread more = time_forces(forces, state->position, pool, state->position_next);
    double count = 20.0 * frequency * frequency;
    printf("%-24s  %7.3f %7.3f %6.2f  %7.3f %7.3f %6.2f\n", name, 1e3 * one.least, 1e3 * one.median,
           1e9 * one.least / count, 1e3 * more.least, 1e3 * more.median, 1e9 * more.least / count);
    pel_pool_destroy(pool);
    pel_shell_forces_destroy(forces);
    pel_batches_destroy(batches);
    pel_state_destroy(state);
    pel_model_destroy(model);
}

int main(int argc, char **argv)
{
    int32_t frequency = argc > 1 ? atoi(argv[1]) : 32;
    int threads = argc > 2 ? atoi(argv[2]) : 2;
    printf("%d triangles, %s\n", 20 * frequency * frequency, sizeof(pel_real) == 8 ? "double" : "float");
    printf("%-24s  one thread: min ms  median  ns a triangle | %d threads\n", "", threads);
    bench("stvk", frequency, PEL_BENDING_NONE, false, threads);
    bench("stvk + isometric", frequency, PEL_BENDING_ISOMETRIC, false, threads);
    bench("stvk + hinge", frequency, PEL_BENDING_HINGE, false, threads);
    bench("stvk + hinge + pressure", frequency, PEL_BENDING_HINGE, true, threads);
    return 0;
}
