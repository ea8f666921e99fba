/* Times reading a mesh of 100,000 vertices from OBJ and PLY files that it writes itself.
   usage: bench_mesh_io [folder] */
#include "bench.h"
#include "pellicle/mesh_io.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { ROWS = 250, COLUMNS = 400, ROUNDS = 15 };

/* a wavy sheet; coordinates of full precision, or rounded to floats as scans have them */
static pel_mesh *make_sheet(bool floats)
{
    double *positions = bench_allocate(3 * ROWS * COLUMNS, sizeof *positions);
    int32_t *triangles = bench_allocate(6 * ROWS * COLUMNS, sizeof *triangles);
    int32_t triangle_count = 0;
    for (int r = 0; r < ROWS; r++) {
        for (int c = 0; c < COLUMNS; c++) {
            double *p = positions + 3 * (r * COLUMNS + c), x = c * 0.00071, y = r * 0.00093;
            const double point[3] = {x, y, 0.02 * sin(40 * x) * cos(30 * y)};
            for (int i = 0; i < 3; i++)
                p[i] = floats ? (double)(float)point[i] : point[i];
        }
    }
    for (int32_t r = 0; r + 1 < ROWS; r++) {
        for (int32_t c = 0; c + 1 < COLUMNS; c++) {
            const int32_t v = r * COLUMNS + c, quad[6] = {v, v + 1, v + COLUMNS + 1, v, v + COLUMNS + 1, v + COLUMNS};
            memcpy(triangles + 3 * triangle_count, quad, sizeof quad);
            triangle_count += 2;
        }
    }
    pel_mesh *mesh;
    pel_error error;
    bench_check(pel_mesh_create(positions, ROWS * COLUMNS, triangles, triangle_count, &mesh, &error), &error);
    free(positions);
    free(triangles);
    return mesh;
}

static void time_format(const char *label, const char *path, pel_mesh_format format, const pel_mesh *mesh)
{
    double times[ROUNDS], started = pel_seconds();
    pel_error error;
    struct stat information;
    bench_check(pel_mesh_write(path, format, mesh, NULL, &error), &error);
    const double write_time = pel_seconds() - started;
    if (stat(path, &information) != 0)
        exit(1);
    for (int i = 0; i < ROUNDS; i++) {
        started = pel_seconds();
        pel_mesh *read = bench_read(path);
        times[i] = pel_seconds() - started;
        pel_mesh_destroy(read);
    }
    const bench_spread time = bench_spread_of(times, ROUNDS);
    const double megabytes = (double)information.st_size * 1e-6;
    printf("%-24s %6.1f MB   read min %7.2f ms  median %7.2f ms  %7.0f MB/s   write %7.2f ms\n", label, megabytes,
           1e3 * time.least, 1e3 * time.median, megabytes / time.median, 1e3 * write_time);
    unlink(path);
}

int main(int argc, char **argv)
{
    char path[600];
    snprintf(path, sizeof path, "%s/bench-mesh-io.tmp", argc > 1 ? argv[1] : ".");
    pel_mesh *full = make_sheet(false), *floats = make_sheet(true);
    printf("%d vertices, %d triangles, %d rounds\n", (int)full->vertex_count, (int)full->triangle_count, (int)ROUNDS);
    time_format("OBJ (17 digits)", path, PEL_FORMAT_OBJ, full);
    time_format("OBJ (floats)", path, PEL_FORMAT_OBJ, floats);
    time_format("PLY binary", path, PEL_FORMAT_PLY, full);
    time_format("PLY binary, big endian", path, PEL_FORMAT_PLY_BIG, full);
    time_format("PLY ASCII", path, PEL_FORMAT_PLY_ASCII, full);
    time_format("OFF", path, PEL_FORMAT_OFF, full);
    time_format("STL binary", path, PEL_FORMAT_STL, floats);
    time_format("STL ASCII", path, PEL_FORMAT_STL_ASCII, floats);
    pel_mesh_destroy(full);
    pel_mesh_destroy(floats);
    return 0;
}
