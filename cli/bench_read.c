/* How long a mesh of 100,000 vertices takes to load (warm from the page cache). */
#include "bench.h"

#include <pellicle/mesh_io.h>
#include <pellicle/shape.h>

#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

/* a temporary folder with a mesh file */
typedef struct reading {
    char folder[32], path[48];
    pel_mesh_format format;
} reading;

static pel_status begin(void **inner, pel_mesh_format format, const char *ending, pel_error *error)
{
    reading *r = calloc(1, sizeof *r);
    if (r == NULL)
        return pel_fail_memory(error);
    *inner = r;
    r->format = format;
    snprintf(r->folder, sizeof r->folder, "/tmp/pellicle-bench-XXXXXX");
    if (mkdtemp(r->folder) == NULL) {
        r->folder[0] = '\0';
        return pel_fail(error, PEL_BAD_FILE, "no temporary folder can be made in /tmp");
    }
    snprintf(r->path, sizeof r->path, "%s/sphere%s", r->folder, ending);
    /* frequency 100 has 100,002 vertices */
    pel_shape_def def = pel_shape_def_default(PEL_SHAPE_GEODESIC_SPHERE);
    def.frequency = 100;
    pel_mesh *mesh = NULL;
    pel_status status = pel_shape_create(&def, &mesh, error);
    if (status == PEL_OK)
        status = pel_mesh_write(r->path, format, mesh, NULL, error);
    pel_mesh_destroy(mesh);
    return status;
}

static pel_status begin_obj(void **inner, pel_error *error)
{
    return begin(inner, PEL_FORMAT_OBJ, ".obj", error);
}

static pel_status begin_ply(void **inner, pel_error *error)
{
    return begin(inner, PEL_FORMAT_PLY, ".ply", error);
}

static pel_status once(void *inner, pel_error *error)
{
    const reading *r = inner;
    pel_mesh *mesh = NULL;
    pel_status status = pel_mesh_read(r->path, r->format, NULL, &mesh, error);
    pel_mesh_destroy(mesh);
    return status;
}

static pel_status finish(void *inner, cli_bench_result *result, pel_error *error)
{
    (void)error;
    const reading *r = inner;
    FILE *file = fopen(r->path, "rb");
    if (file != NULL && fseek(file, 0, SEEK_END) == 0)
        cli_bench_add(result, "bytes_per_s", "B/s", (double)ftell(file) / result->min_s);
    if (file != NULL)
        fclose(file);
    return PEL_OK;
}

static void end(void *inner)
{
    const reading *r = inner;
    if (r != NULL && r->folder[0] != '\0') {
        remove(r->path);
        rmdir(r->folder);
    }
    free(inner);
}

const cli_bench_case cli_bench_read_obj = {
    .name = "read-obj",
    .doc = "load an OBJ of 100,002 vertices",
    .compare_s = 0.150,
    .compare_to = "aim",
    .repeats = 11,
    .begin = begin_obj,
    .once = once,
    .finish = finish,
    .end = end,
};

const cli_bench_case cli_bench_read_ply = {
    .name = "read-ply",
    .doc = "load a binary PLY of 100,002 vertices",
    .compare_s = 0.015,
    .compare_to = "aim",
    .repeats = 21,
    .begin = begin_ply,
    .once = once,
    .finish = finish,
    .end = end,
};
