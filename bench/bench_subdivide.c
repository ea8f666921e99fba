/* Times one level of modified butterfly from triangle soup to positions, and its stages.
   usage: bench_subdivide [mesh file or frequency of a geodesic sphere, 128 by default] */
#include "pellicle/mesh_io.h"
#include "pellicle/shape.h"
#include "pellicle/subdivide.h"
#include "pellicle/topology.h"

#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { ROUNDS = 15 };

static double seconds(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static int by_size(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static void check(pel_status status, const pel_error *error)
{
    char text[800];
    if (status == PEL_OK)
        return;
    fprintf(stderr, "%s\n", pel_error_text(error, text, sizeof text));
    exit(1);
}

static pel_mesh *make_mesh(const char *argument)
{
    pel_mesh *mesh;
    pel_error error;
    char *end;
    pel_shape_def def = pel_shape_def_default(PEL_SHAPE_GEODESIC_SPHERE);
    def.frequency = (int32_t)strtol(argument, &end, 10);
    if (*end == '\0')
        check(pel_shape_create(&def, &mesh, &error), &error);
    else
        check(pel_mesh_read(argument, PEL_FORMAT_AUTO, NULL, &mesh, &error), &error);
    return mesh;
}

static void report(const char *stage, double *times, double triangle_count)
{
    qsort(times, ROUNDS, sizeof *times, by_size);
    printf("%-24s min %8.2f ms  median %8.2f ms  %6.1f million triangles/s\n", stage, 1e3 * times[0],
           1e3 * times[ROUNDS / 2], 1e-6 * triangle_count / times[ROUNDS / 2]);
}

int main(int argc, char **argv)
{
    pel_mesh *mesh = make_mesh(argc > 1 ? argv[1] : "128");
    double topology_times[ROUNDS], all_times[ROUNDS], rest_times[ROUNDS];
    for (int round = 0; round < ROUNDS; round++) {
        pel_topology *topology;
        pel_mesh *fine;
        pel_error error;
        double begin = seconds();
        check(pel_topology_create(mesh, &topology, &error), &error);
        double middle = seconds();
        pel_topology_destroy(topology);
        double again = seconds();
        check(pel_mesh_subdivide(mesh, 1, &fine, &error), &error);
        all_times[round] = seconds() - again;
        pel_mesh_destroy(fine);
        topology_times[round] = middle - begin;
        rest_times[round] = all_times[round] - topology_times[round];
    }
    double count = 4.0 * mesh->triangle_count;
    printf("%d triangles to %.0f\n", (int)mesh->triangle_count, count);
    report("topology", topology_times, count);
    report("positions and triangles", rest_times, count);
    report("all, from triangle soup", all_times, count);
    pel_mesh_destroy(mesh);
    return 0;
}
