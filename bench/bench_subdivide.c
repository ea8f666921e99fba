/* Times one level of modified butterfly from triangle soup to positions, and its stages.
   usage: bench_subdivide [mesh file or frequency of a geodesic sphere, 128 by default] */
#include "bench.h"
#include "pellicle/subdivide.h"
#include "pellicle/topology.h"

#include <stdio.h>
#include <stdlib.h>

enum { ROUNDS = 15 };

static pel_mesh *make_mesh(const char *argument)
{
    char *end;
    const int32_t frequency = (int32_t)strtol(argument, &end, 10);
    return *end == '\0' ? bench_sphere(frequency) : bench_read(argument);
}

static void report(const char *stage, double *times, double triangle_count)
{
    const bench_spread time = bench_spread_of(times, ROUNDS);
    printf("%-24s min %8.2f ms  median %8.2f ms  %6.1f million triangles/s\n", stage, 1e3 * time.least,
           1e3 * time.median, 1e-6 * triangle_count / time.median);
}

int main(int argc, char **argv)
{
    pel_mesh *mesh = make_mesh(argc > 1 ? argv[1] : "128");
    double topology_times[ROUNDS], all_times[ROUNDS], rest_times[ROUNDS];
    for (int round = 0; round < ROUNDS; round++) {
        pel_topology *topology;
        pel_mesh *fine;
        pel_error error;
        double begin = pel_seconds();
        bench_check(pel_topology_create(mesh, &topology, &error), &error);
        double middle = pel_seconds();
        pel_topology_destroy(topology);
        double again = pel_seconds();
        bench_check(pel_mesh_subdivide(mesh, 1, &fine, &error), &error);
        all_times[round] = pel_seconds() - again;
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
