/* Benchmarks of whole steps: paper A's 500 steps, and a million vertices against this machine's memory bandwidth. */
#include "bench.h"

#include <pellicle/parallel.h>
#include <pellicle/shape.h>
#include <pellicle/sim_step.h>

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

typedef struct stepping {
    pel_mesh *mesh;
    pel_model *model;
    pel_sim *sim;
    void *start; /* snapshot to restore */
    size_t start_size;
    pel_method method;
    int thread_count;
    int steps; /* of one repeat */
} stepping;

static pel_status make_sim(stepping *s, int32_t frequency, pel_error *error)
{
    pel_shape_def shape = pel_shape_def_default(PEL_SHAPE_GEODESIC_SPHERE);
    shape.frequency = frequency;
    pel_status status = pel_shape_create(&shape, &s->mesh, error);
    if (status != PEL_OK)
        return status;
    pel_body_def body = pel_body_def_default();
    body.name = "ball";
    body.mesh = s->mesh;
    body.volumetric_by_area = true;
    pel_model_def model = pel_model_def_default();
    model.bodies = &body;
    model.body_count = 1;
    status = pel_model_create(&model, &s->model, error);
    if (status != PEL_OK)
        return status;
    const int32_t pole = 5;
    pel_load_def load = pel_load_def_default();
    load.force[2] = -1;
    load.vertices = &pole;
    load.vertex_count = 1;
    pel_sim_def def = pel_sim_def_default();
    def.model = s->model;
    def.solver.method = s->method;
    def.solver.alpha = s->method == PEL_METHOD_QUASI_STATIC ? 50 : def.solver.alpha;
    def.loads = &load;
    def.load_count = 1;
    def.thread_count = s->thread_count;
    return pel_sim_create(&def, &s->sim, error);
}

static pel_status begin(void **inner, int32_t frequency, pel_method method, int steps, int thread_count,
                        pel_error *error)
{
    stepping *s = calloc(1, sizeof *s);
    *inner = s;
    if (s == NULL)
        return pel_fail_memory(error);
    s->method = method;
    s->steps = steps;
    s->thread_count = thread_count;
    pel_status status = make_sim(s, frequency, error);
    if (status != PEL_OK)
        return status;
    s->start_size = pel_sim_save_size(s->sim);
    s->start = malloc(s->start_size);
    if (s->start == NULL)
        return pel_fail_memory(error);
    pel_sim_save(s->sim, s->start);
    return PEL_OK;
}

static pel_status begin_paper(void **inner, pel_error *error)
{
    return begin(inner, 5, PEL_METHOD_QUASI_STATIC, 500, 1, error);
}

static pel_status begin_springs(void **inner, pel_error *error)
{
    return begin(inner, 32, PEL_METHOD_QUASI_STATIC, 100, 1, error);
}

static pel_status begin_springs_explicit(void **inner, pel_error *error)
{
    return begin(inner, 32, PEL_METHOD_EXPLICIT, 100, 1, error);
}

static pel_status begin_million(void **inner, pel_error *error)
{
    return begin(inner, 316, PEL_METHOD_QUASI_STATIC, 5, 1, error);
}

static pel_status begin_million_threads(void **inner, pel_error *error)
{
    return begin(inner, 316, PEL_METHOD_QUASI_STATIC, 5, 0, error);
}

static pel_status rewind_sim(void *inner, pel_error *error)
{
    stepping *s = inner;
    return pel_sim_load(s->sim, s->start, s->start_size, error);
}

static pel_status step(void *inner, pel_error *error)
{
    stepping *s = inner;
    pel_status status = PEL_OK;
    for (int n = 0; status == PEL_OK && n < s->steps; n++)
        status = pel_sim_step(s->sim, error);
    return status;
}

static void end(void *inner)
{
    stepping *s = inner;
    if (s == NULL)
        return;
    pel_sim_destroy(s->sim);
    pel_model_destroy(s->model);
    pel_mesh_destroy(s->mesh);
    free(s->start);
    free(s);
}

/* a part of the triad for one thread */
typedef struct triad_part {
    double *a;
    const double *b, *c;
    size_t count;
} triad_part;

static void *triad(void *argument)
{
    const triad_part *part = argument;
    for (size_t i = 0; i < part->count; i++)
        part->a[i] = part->b[i] + 3 * part->c[i];
    return NULL;
}

enum { TRIAD_THREADS = 64, TRIAD_COUNT = 1 << 24, TRIAD_TRIES = 9 };

/* seconds of one triad, split over the threads */
static double time_triad(double *a, const double *b, const double *c, int thread_count)
{
    pthread_t threads[TRIAD_THREADS];
    triad_part parts[TRIAD_THREADS];
    size_t share = TRIAD_COUNT / (size_t)thread_count;
    double start = pel_seconds();
    int started = 1;
    for (int i = 0; i < thread_count; i++) {
        size_t first = share * (size_t)i;
        parts[i] = (triad_part){a + first, b + first, c + first, share};
    }
    while (started < thread_count && pthread_create(&threads[started], NULL, triad, &parts[started]) == 0)
        started++;
    triad(&parts[0]);
    for (int i = 1; i < started; i++)
        pthread_join(threads[i], NULL);
    return pel_seconds() - start;
}

/* best bandwidth of a[i] = b[i] + 3 c[i] over arrays far larger than the caches (STREAM triad, McCalpin: 24 bytes a
   number) */
static double triad_bandwidth(int thread_count)
{
    size_t bytes = TRIAD_COUNT * sizeof(double);
    double *a = malloc(bytes), *b = malloc(bytes), *c = malloc(bytes), best = 0;
    thread_count = thread_count < TRIAD_THREADS ? thread_count : TRIAD_THREADS;
    if (a != NULL && b != NULL && c != NULL) {
        memset(a, 0, bytes);
        memset(b, 0, bytes);
        memset(c, 0, bytes);
        for (int n = 0; n < TRIAD_TRIES; n++) {
            double rate = 24.0 * TRIAD_COUNT / time_triad(a, b, c, thread_count);
            best = rate > best ? rate : best;
        }
    }
    free(a);
    free(b);
    free(c);
    return best;
}

static pel_status finish_paper(void *inner, cli_bench_result *result, pel_error *error)
{
    (void)error;
    const stepping *s = inner;
    cli_bench_add(result, "step_us", "us", 1e6 * result->min_s / s->steps);
    cli_bench_add(result, "faster_than_paper", "times", 0.060 / result->median_s);
    return PEL_OK;
}

static pel_status finish_springs(void *inner, cli_bench_result *result, pel_error *error)
{
    (void)error;
    const stepping *s = inner;
    double steps_s = result->min_s / s->steps;
    cli_bench_add(result, "step_us", "us", 1e6 * steps_s);
    cli_bench_add(result, "spring_ns", "ns", 1e9 * steps_s / (1.5 * s->mesh->triangle_count));
    return PEL_OK;
}

static pel_status finish_million(void *inner, cli_bench_result *result, pel_error *error)
{
    (void)error;
    const stepping *s = inner;
    double bytes = (double)pel_sim_step_bytes(s->sim), rate = bytes * s->steps / result->min_s;
    double triad = triad_bandwidth(s->thread_count > 0 ? s->thread_count : pel_thread_limit());
    cli_bench_add(result, "vertices", "", s->mesh->vertex_count);
    cli_bench_add(result, "step_ms", "ms", 1e3 * result->min_s / s->steps);
    cli_bench_add(result, "bytes_per_step", "B", bytes);
    cli_bench_add(result, "bytes_per_s", "B/s", rate);
    cli_bench_add(result, "triad_bytes_per_s", "B/s", triad);
    cli_bench_add(result, "share_of_triad", "", rate / triad);
    return PEL_OK;
}

const cli_bench_case cli_bench_sphere_500 = {
    .name = "sphere-500",
    .doc = "500 steps of paper A's sphere (252 vertices, 500 triangles), one thread",
    .compare_s = 0.060,
    .compare_to = "paper A (Pentium 4, 2006)",
    .repeats = 21,
    .begin = begin_paper,
    .rewind = rewind_sim,
    .once = step,
    .finish = finish_paper,
    .end = end,
};

const cli_bench_case cli_bench_springs = {
    .name = "springs",
    .doc = "100 quasi-static steps of a sphere of springs (10,242 vertices), one thread",
    .repeats = 21,
    .begin = begin_springs,
    .rewind = rewind_sim,
    .once = step,
    .finish = finish_springs,
    .end = end,
};

const cli_bench_case cli_bench_springs_explicit = {
    .name = "springs-explicit",
    .doc = "the same, explicit",
    .repeats = 21,
    .begin = begin_springs_explicit,
    .rewind = rewind_sim,
    .once = step,
    .finish = finish_springs,
    .end = end,
};

const cli_bench_case cli_bench_million = {
    .name = "million",
    .doc = "5 steps of a sphere of a million vertices, one thread, beside this machine's STREAM triad",
    .repeats = 9,
    .begin = begin_million,
    .once = step,
    .finish = finish_million,
    .end = end,
};

const cli_bench_case cli_bench_million_threads = {
    .name = "million-threads",
    .doc = "the same with all threads, beside the triad with all threads",
    .repeats = 9,
    .begin = begin_million_threads,
    .once = step,
    .finish = finish_million,
    .end = end,
};
