#include "bench.h"

#include "pellicle/mesh_io.h"
#include "pellicle/shape.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

void bench_check(pel_status status, const pel_error *error)
{
    char text[1000];
    if (status == PEL_OK)
        return;
    fprintf(stderr, "%s\n", pel_error_text(error, text, sizeof text));
    exit(1);
}

void *bench_allocate(size_t count, size_t size)
{
    void *memory = calloc(count, size);
    if (memory == NULL) {
        fputs("out of memory\n", stderr);
        exit(1);
    }
    return memory;
}

pel_mesh *bench_sphere(int32_t frequency)
{
    pel_error error;
    pel_mesh *mesh;
    pel_shape_def def = pel_shape_def_default(PEL_SHAPE_GEODESIC_SPHERE);
    def.frequency = frequency;
    bench_check(pel_shape_create(&def, &mesh, &error), &error);
    return mesh;
}

pel_body_def bench_organ(const pel_mesh *mesh, int32_t levels)
{
    pel_body_def body = pel_body_def_default();
    body.name = "organ";
    body.mesh = mesh;
    body.mass_kind = PEL_MASS_TOTAL;
    body.mass = 1.5;
    body.spring_stiffness.value = 60;
    body.spring_damping.value = 0.1;
    body.volumetric_stiffness.value = 120;
    body.volumetric_damping.value = 0.1;
    body.volumetric_by_area = true;
    body.refine.levels = levels;
    body.refine.near_tools = levels > 0 ? 0.003 : 0;
    return body;
}

pel_mesh *bench_read(const char *path)
{
    pel_error error;
    pel_mesh *mesh;
    bench_check(pel_mesh_read(path, PEL_FORMAT_AUTO, NULL, &mesh, &error), &error);
    return mesh;
}

pel_model *bench_model(const pel_body_def *body)
{
    pel_error error;
    pel_model *model;
    pel_model_def def = pel_model_def_default();
    def.bodies = body;
    def.body_count = 1;
    bench_check(pel_model_create(&def, &model, &error), &error);
    return model;
}

static int by_size(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

bench_spread bench_spread_of(double *times, int count)
{
    qsort(times, (size_t)count, sizeof *times, by_size);
    return (bench_spread){times[0], times[count / 2], times[count * 99 / 100], times[count - 1]};
}

void bench_part(const char *name, int rounds, void (*part)(void *context), void *context)
{
    double *times = bench_allocate((size_t)rounds, sizeof *times), least = HUGE_VAL;
    for (int round = 0; round < rounds; round++) {
        double begin = pel_seconds(), own = pel_thread_seconds();
        part(context);
        times[round] = 1e3 * (pel_seconds() - begin);
        least = fmin(least, 1e3 * (pel_thread_seconds() - own));
    }
    bench_spread spread = bench_spread_of(times, rounds);
    printf("  %-28s %8.3f ms, median %8.3f; processor, calling thread %8.3f\n", name, spread.least, spread.median,
           least);
    free(times);
}
