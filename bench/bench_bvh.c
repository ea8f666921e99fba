/* Broad phase of self-collision: ms a step over 100 steps of a sphere in motion, all edge-edge and vertex-face
   candidates, processor time of one thread, with pairs kept from step to step and without; then the cost per triangle
   of a large sphere, and the certificate of a mesh at rest. usage: bench_bvh [steps] */
#include "bench.h"
#include "pellicle/collide.h"
#include "tests/random.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { REPEATS = 5, STEP_LIMIT = 1000 };

typedef enum motion {
    NOISE,  /* each vertex is thrown about its place by a share of the edge length: no two ways are alike */
    SHRINK, /* the whole sphere shrinks by a share of its radius in each step */
    WAVE    /* bulges of a tenth of the radius run around the sphere; a vertex moves by a share of the radius a step */
} motion;

typedef struct scenario {
    const char *name;
    motion motion;
    double share;
} scenario;

/* a number in -1 .. 1 that depends on two others */
static double scatter(uint64_t a, uint64_t b)
{
    random_state random = {(a * 0x9e3779b97f4a7c15u) ^ (b * 0xbf58476d1ce4e5b9u)};
    return random_between(&random, -1, 1);
}

static void place(const scenario *s, const pel_mesh *mesh, double edge, int step, double (*positions)[3])
{
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        const double *x = mesh->positions[v];
        double factor = s->motion == SHRINK ? pow(1 - s->share, step) : 1;
        if (s->motion == WAVE)
            factor = 1 + 0.1 * sin(4 * atan2(x[1], x[0]) + 10 * s->share * step) * (1 - x[2] * x[2]);
        for (int k = 0; k < 3; k++) {
            positions[v][k] = factor * x[k];
            if (s->motion == NOISE)
                positions[v][k] += 0.5 * s->share * edge * scatter((uint64_t)(3 * v + k), (uint64_t)step);
        }
    }
}

/* ms a step of one pass over all steps; times (steps) of each, the candidates and searches are those of the end */
static double run(const scenario *s, const pel_mesh *mesh, double margin, int steps, double *worst,
                  pel_collision_candidates *candidates)
{
    pel_error error;
    pel_collider *collider;
    pel_collider_def def = pel_collider_def_default();
    def.mesh = mesh;
    def.margin = margin;
    bench_check(pel_collider_create(&def, &collider, &error), &error);
    double edge = sqrt(16 * acos(-1.0) / (sqrt(3.0) * mesh->triangle_count)), sum = 0;
    double(*start)[3] = bench_allocate((size_t)mesh->vertex_count, sizeof *start);
    double(*end)[3] = bench_allocate((size_t)mesh->vertex_count, sizeof *end);
    *worst = 0;
    place(s, mesh, edge, 0, end);
    for (int step = 0; step < steps; step++) {
        memcpy(start, end, (size_t)mesh->vertex_count * sizeof *start);
        place(s, mesh, edge, step + 1, end);
        pel_collision_query query = pel_collision_query_default();
        query.start = start[0];
        query.end = end[0];
        double begin = pel_thread_seconds();
        bench_check(pel_collider_candidates(collider, &query, candidates, &error), &error);
        double time = pel_thread_seconds() - begin;
        sum += time;
        *worst = time > *worst ? time : *worst;
    }
    pel_collider_destroy(collider);
    free(start);
    free(end);
    return 1e3 * sum / steps;
}

/* returns the least average */
static double report(const scenario *s, const pel_mesh *mesh, double margin, int steps)
{
    double times[REPEATS], worst, least_worst = 1e9;
    pel_collision_candidates c;
    for (int repeat = 0; repeat < REPEATS; repeat++) {
        times[repeat] = run(s, mesh, margin, steps, &worst, &c);
        least_worst = worst < least_worst ? worst : least_worst;
    }
    const bench_spread time = bench_spread_of(times, REPEATS);
    printf("%7d triangles  %-34s %-8s %7.3f ms min %7.3f ms median a step, worst step %7.3f ms; last step: %8lld "
           "vertex-face, %8lld edge-edge of %8lld; %lld searches in %d steps\n",
           (int)mesh->triangle_count, s->name, margin == 0 ? "search" : "kept", time.least, time.median,
           1e3 * least_worst, (long long)c.vertex_face_count, (long long)c.edge_edge_count, (long long)c.kept,
           (long long)c.searches, steps);
    return time.least;
}

static void report_certificate(const pel_mesh *mesh)
{
    double times[REPEATS];
    int64_t count = 0;
    pel_error error;
    for (int repeat = 0; repeat < REPEATS; repeat++) {
        double begin = pel_thread_seconds();
        bench_check(pel_mesh_self_intersections(mesh, NULL, 0, &count, &error), &error);
        times[repeat] = 1e3 * (pel_thread_seconds() - begin);
    }
    const bench_spread time = bench_spread_of(times, REPEATS);
    printf("%7d triangles  certificate: %lld intersections in %.2f ms min %.2f ms median\n", (int)mesh->triangle_count,
           (long long)count, time.least, time.median);
}

int main(int argument_count, char **arguments)
{
    const scenario scenarios[] = {
        {"noise, 2 % of the edge length", NOISE, 0.02},         {"shrinks by 2 % of its radius", SHRINK, 0.02},
        {"waves, 2 % of the edge length", WAVE, 0.02 * 0.0376}, {"waves, 2 % of the radius", WAVE, 0.02},
        {"noise, 2 % of the radius", NOISE, 0.02 / 0.0376},
    };
    int steps = argument_count > 1 ? atoi(arguments[1]) : 100;
    if (steps < 1 || steps > STEP_LIMIT)
        return 1;
    pel_mesh *small = bench_sphere(32), *large = bench_sphere(128);
    double least[2] = {0, 0};
    for (size_t i = 0; i < sizeof scenarios / sizeof *scenarios; i++)
        for (int kept = 0; kept < 2; kept++) {
            double time = report(&scenarios[i], small, kept ? -1 : 0, steps);
            least[kept] = i == 0 ? time : least[kept];
        }
    int large_steps = steps / 10 > 0 ? steps / 10 : 1;
    for (int kept = 0; kept < 2; kept++) {
        double time = report(&scenarios[0], large, kept ? -1 : 0, kept ? steps : large_steps);
        printf("        cost per triangle, %s: %.2f times that of the small sphere\n", kept ? "kept" : "search",
               time / least[kept] / 16);
    }
    report_certificate(small);
    report_certificate(large);
    pel_mesh_destroy(small);
    pel_mesh_destroy(large);
    return 0;
}
