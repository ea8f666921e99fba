/* What the benchmarks share: meshes, times in order. A failure prints what is wrong and ends the program. */
#ifndef PEL_BENCH_BENCH_H
#define PEL_BENCH_BENCH_H

#include "pellicle/mesh.h"
#include "pellicle/model.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ends the program unless status is PEL_OK */
void bench_check(pel_status status, const pel_error *error);

/* ends the program when memory runs out */
void *bench_allocate(size_t count, size_t size);

/* geodesic sphere of radius 1 with 20 frequency^2 triangles */
pel_mesh *bench_sphere(int32_t frequency);

/* tissue of scenes/organ-press.yaml, refined under a tool; the mesh lives on */
pel_body_def bench_organ(const pel_mesh *mesh, int32_t levels);

/* mesh of a file */
pel_mesh *bench_read(const char *path);

/* model of one body */
pel_model *bench_model(const pel_body_def *body);

typedef struct bench_spread {
    double least, median, percentile_99, most;
} bench_spread;

/* puts the times in order */
bench_spread bench_spread_of(double *times, int count);

/* calls `part` with `context` `rounds` times, and prints its least and median time on the wall, and the least processor
   time of the calling thread, on which other jobs on the machine count less */
void bench_part(const char *name, int rounds, void (*part)(void *context), void *context);

#ifdef __cplusplus
}
#endif

#endif
