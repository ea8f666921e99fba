#include "check.h"

#include "field/radius.h"
#include "pellicle/shape.h"

static const double origin[3] = {0}, all = (double)HUGE_VAL;

static void measure(const char *shape, const char *const *keys, const double *numbers, const double point[3],
                    double reach, double found[2])
{
    pel_shape_def def;
    pel_mesh *mesh;
    pel_topology *topology;
    assert_int_equal(pel_shape_def_of_name(shape, &def, NULL), PEL_OK);
    for (int i = 0; keys[i] != NULL; i++)
        assert_int_equal(pel_shape_set_number(&def, keys[i], numbers[i], NULL), PEL_OK);
    assert_int_equal(pel_shape_create(&def, &mesh, NULL), PEL_OK);
    assert_int_equal(pel_topology_create(mesh, &topology, NULL), PEL_OK);
    pel_mesh_mean_radius(mesh, topology, point, reach, &found[0], &found[1]);
    pel_topology_destroy(topology);
    pel_mesh_destroy(mesh);
}

static void test_radius(void **unused)
{
    (void)unused;
    const char *const ball[] = {"radius", "frequency", NULL}, *const none[] = {NULL};
    const char *const tube[] = {"radius", "slices", "segments", "capped", NULL}, *const ring[] = {"major_radius", NULL};
    double found[2];
    measure("geodesic-sphere", ball, (const double[]){0.3, 12}, origin, all, found);
    assert_true(fabs(found[0] - 0.3) < 0.01 * 0.3);
    /* 2880 equal triangles would have edges of 0.3 sqrt(16 pi / (sqrt(3) 2880)) */
    assert_true(fabs(found[1] - 0.0301) < 0.05 * found[1]);
    measure("cylinder", tube, (const double[]){0.2, 60, 30, 0}, origin, all, found);
    assert_true(fabs(found[0] - 0.4) < 0.02 * 0.4);
    measure("grid", none, NULL, origin, all, found);
    assert_true(isinf(found[0]));
    /* outside of a torus 1/r and 1/(R + r) */
    measure("torus", ring, (const double[]){1}, (const double[]){1.25, 0, 0}, 0.15, found);
    assert_true(fabs(found[0] - 2 / (1 / 0.25 + 1 / 1.25)) < 0.1 * found[0]);
    /* nothing is there */
    measure("grid", none, NULL, (const double[]){9, 0, 0}, 0.1, found);
    assert_true(isinf(found[0]) && found[1] == 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_radius)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
