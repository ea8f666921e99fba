/* Meshes for the tests of src/shape/mesh: small meshes from literal arrays, the shared real meshes. */
#ifndef PEL_TESTS_SAMPLE_H
#define PEL_TESTS_SAMPLE_H

#include "check.h"
#include "random.h"

#include "pellicle/mesh.h"
#include "pellicle/shape.h"
#include "source_dir.h"

#include <stdlib.h>

/* 0 .. bound - 1 */
static inline int32_t random_below(random_state *random, int32_t bound)
{
    return (int32_t)random_integer(random, 0, bound - 1);
}

/* random positions in the unit cube */
static inline pel_mesh *sample_mesh(int32_t vertex_count, const int32_t *triangles, int32_t triangle_count)
{
    random_state random = {77};
    double *positions = malloc(3 * sizeof *positions * (size_t)vertex_count);
    pel_mesh *mesh;
    assert_non_null(positions);
    for (int32_t i = 0; i < 3 * vertex_count; i++)
        positions[i] = random_between(&random, 0, 1);
    assert_int_equal(pel_mesh_create(positions, vertex_count, triangles, triangle_count, &mesh, NULL), PEL_OK);
    free(positions);
    return mesh;
}

static inline pel_mesh *sample_sphere(int32_t frequency)
{
    pel_shape_def def = pel_shape_def_default(PEL_SHAPE_GEODESIC_SPHERE);
    pel_mesh *mesh;
    def.frequency = frequency;
    assert_int_equal(pel_shape_create(&def, &mesh, NULL), PEL_OK);
    return mesh;
}

/* a triangle mesh of ../shared/data, or null when it is not there; reads "v x y z" and "f a b c" lines only */
static inline pel_mesh *sample_shared(const char *name)
{
    char path[512], line[512];
    snprintf(path, sizeof path, "%s/../shared/data/%s", PEL_SOURCE_DIR, name);
    FILE *file = fopen(path, "r");
    if (file == NULL)
        return NULL;
    enum { MOST = 40000 };
    double *positions = malloc(3 * MOST * sizeof *positions);
    int32_t *triangles = malloc(3 * MOST * sizeof *triangles), vertex_count = 0, triangle_count = 0;
    assert_true(positions != NULL && triangles != NULL);
    while (fgets(line, sizeof line, file) != NULL) {
        double *p = positions + 3 * vertex_count;
        int32_t *v = triangles + 3 * triangle_count;
        if (sscanf(line, "v %lf %lf %lf", &p[0], &p[1], &p[2]) == 3) {
            vertex_count++;
        } else if (sscanf(line, "f %d %d %d", &v[0], &v[1], &v[2]) == 3) {
            for (int i = 0; i < 3; i++)
                v[i]--;
            triangle_count++;
        }
        assert_true(vertex_count < MOST && triangle_count < MOST);
    }
    fclose(file);
    pel_mesh *mesh;
    assert_int_equal(pel_mesh_create(positions, vertex_count, triangles, triangle_count, &mesh, NULL), PEL_OK);
    free(positions);
    free(triangles);
    return mesh;
}

#endif
