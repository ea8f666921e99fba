#include "closed_form.h"
#include "gradient.h"

typedef struct cone {
    int32_t triangle_count;
    const int32_t *triangles;
    const double *origin;
} cone;

static double volume_of(const void *context, const double *x)
{
    const cone *data = context;
    return pel_surface_volume(x, data->triangles, data->triangle_count, data->origin);
}

static const int32_t *triangles_of(const curved_mesh *curved)
{
    return curved->mesh->triangles[0];
}

static void move(curved_mesh *curved, double scale, double shift)
{
    for (int32_t v = 0; v < curved->mesh->vertex_count; v++)
        for (int c = 0; c < 3; c++)
            curved->mesh->positions[v][c] = scale * curved->mesh->positions[v][c] + shift * (c + 1);
}

/* the unit cube, with each corner of its sides once */
static const double cube[24] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, 1, 1, 0, 1, 1, 1, 1, 0, 1, 1};
static const int32_t cube_triangles[36] = {0, 2, 1, 0, 3, 2, 4, 5, 6, 4, 6, 7, 0, 1, 5, 0, 5, 4,
                                           1, 2, 6, 1, 6, 5, 2, 3, 7, 2, 7, 6, 3, 0, 4, 3, 4, 7};

static void test_cube(void **unused)
{
    (void)unused;
    const double far[3] = {5, -3, 8};
    assert_near(pel_surface_area(cube, cube_triangles, 12), 6, 1e-15);
    assert_near(pel_surface_volume(cube, cube_triangles, 12, NULL), 1, 1e-15);
    assert_near(pel_surface_volume(cube, cube_triangles, 12, far), 1, 1e-13);
    /* one side alone, seen from the middle of the cube and from outside */
    const double middle[3] = {0.5, 0.5, 0.5}, below[3] = {0.5, 0.5, -1};
    assert_near(pel_surface_volume(cube, cube_triangles, 2, middle), 1.0 / 6, 1e-15);
    assert_near(pel_surface_volume(cube, cube_triangles, 2, below), -1.0 / 3, 1e-15);
    assert_true(pel_surface_volume(cube, cube_triangles, 0, NULL) == 0);
}

/* a sphere of 1 cm, a million metres from the origin: the error is that of its coordinates, 1e-10 m */
static void test_far_from_the_origin(void **unused)
{
    (void)unused;
    curved_mesh near = make_sphere(10, 0.01), far = make_sphere(10, 0.01);
    move(&far, 1, 1e6);
    double *gradient = malloc(sizeof *gradient * 3 * (size_t)near.mesh->vertex_count);
    double *far_gradient = malloc(sizeof *gradient * 3 * (size_t)near.mesh->vertex_count);
    double volume = pel_surface_volume(near.positions, triangles_of(&near), near.mesh->triangle_count, NULL);
    double far_volume = pel_surface_volume_gradient(far.positions, far.mesh->vertex_count, triangles_of(&far),
                                                    far.mesh->triangle_count, NULL, far_gradient);
    pel_surface_volume_gradient(near.positions, near.mesh->vertex_count, triangles_of(&near), near.mesh->triangle_count,
                                NULL, gradient);
    assert_near(volume, 4.0 / 3 * pi * 1e-6, 0.03e-6);
    assert_near(far_volume / volume, 1, 1e-7);
    double largest = 0;
    for (int32_t i = 0; i < 3 * near.mesh->vertex_count; i++)
        largest = fmax(largest, fabs(gradient[i]));
    for (int32_t i = 0; i < 3 * near.mesh->vertex_count; i++)
        assert_near(far_gradient[i], gradient[i], 1e-6 * largest);
    free(far_gradient);
    free(gradient);
    destroy_mesh(&far);
    destroy_mesh(&near);
}

static void check_gradient(curved_mesh *curved, const double *origin)
{
    double *x = curved->mesh->positions[0];
    double *gradient = malloc(sizeof *gradient * 3 * (size_t)curved->mesh->vertex_count);
    const cone data = {curved->mesh->triangle_count, triangles_of(curved), origin};
    double volume = pel_surface_volume_gradient(x, curved->mesh->vertex_count, data.triangles, data.triangle_count,
                                                origin, gradient);
    assert_true(volume == volume_of(&data, x));
    for (int i = 0; i < 3 * curved->mesh->vertex_count; i += 7)
        assert_near(gradient[i], numeric_derivative(volume_of, &data, x, i, 1e-2), 1e-11);
    free(gradient);
}

static void test_gradient(void **unused)
{
    (void)unused;
    const double origin[3] = {0.3, -0.2, 2};
    curved_mesh closed = make_irregular(5);
    pel_shape_def def = pel_shape_def_default(PEL_SHAPE_GRID);
    def.nx = def.ny = 4;
    curved_mesh open = make_shape(&def);
    check_gradient(&closed, origin);
    check_gradient(&open, origin);

    /* on a closed surface the point does not matter, and the gradient is the area vector */
    double *x = closed.mesh->positions[0];
    double *gradient = malloc(sizeof *gradient * 3 * (size_t)closed.mesh->vertex_count);
    pel_surface_volume_gradient(x, closed.mesh->vertex_count, triangles_of(&closed), closed.mesh->triangle_count, NULL,
                                gradient);
    for (int32_t v = 0; v < closed.mesh->vertex_count; v++) {
        pel_vertex_measure measure;
        pel_vertex_measure_fill(closed.topology, x, v, &measure);
        for (int c = 0; c < 3; c++)
            assert_near(measure.area_vector[c], gradient[3 * v + c], 1e-15);
    }
    free(gradient);
    destroy_mesh(&open);
    destroy_mesh(&closed);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_cube),
        cmocka_unit_test(test_far_from_the_origin),
        cmocka_unit_test(test_gradient),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
