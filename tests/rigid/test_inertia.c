/* Integrals over meshes against closed forms of boxes, balls and shells. */
#include "rigid/inertia.h"
#include "rigid_scene.h"

#define ROUNDING 1e-12

static const double far_away[3] = {3, -2, 5};

static void test_box(void **state)
{
    (void)state;
    const double size[3] = {0.1, 0.2, 0.4}, mass = 1000 * 0.1 * 0.2 * 0.4;
    pel_mesh *mesh = make_box(size[0], size[1], size[2], far_away);
    pel_inertia inertia;
    pel_inertia_of_solid(mesh, 1000, &inertia);
    assert_near(inertia.mass, mass, ROUNDING * mass);
    for (int i = 0; i < 3; i++) {
        double a = size[(i + 1) % 3], b = size[(i + 2) % 3];
        assert_near(inertia.center[i], far_away[i], ROUNDING);
        assert_near(inertia.tensor[i][i], mass * (a * a + b * b) / 12, ROUNDING);
        assert_near(inertia.tensor[i][(i + 1) % 3], 0, ROUNDING);
    }
    pel_mesh_destroy(mesh);
}

/* a turned box has the turned tensor */
static void test_turned_box(void **state)
{
    (void)state;
    static const double origin[3] = {0}, axis[3] = {0, 0, 1};
    const double mass = 2, along = mass * (0.04 + 0.16) / 12, across = mass * (0.01 + 0.16) / 12;
    const double c = cos(0.5), s = sin(0.5);
    pel_mesh *mesh = make_box(0.1, 0.2, 0.4, origin);
    turn_mesh(mesh, axis, 0.5 * 180 / 3.14159265358979323846);
    pel_inertia inertia;
    pel_inertia_of_solid(mesh, mass / 0.008, &inertia);
    assert_near(inertia.tensor[0][0], c * c * along + s * s * across, ROUNDING);
    assert_near(inertia.tensor[1][1], s * s * along + c * c * across, ROUNDING);
    assert_near(inertia.tensor[0][1], c * s * (along - across), ROUNDING);
    pel_mesh_destroy(mesh);
}

/* polyhedra of many faces: the error falls with the square of the edges */
static void test_ball(void **state)
{
    (void)state;
    const double r = 0.3;
    double errors[2];
    for (int k = 0; k < 2; k++) {
        pel_mesh *mesh = make_ball(r, 10 * (k + 1), 1, 2, 3);
        pel_inertia inertia;
        pel_inertia_of_solid(mesh, 1, &inertia);
        errors[k] = 1 - inertia.tensor[0][0] / (inertia.mass * 0.4 * r * r);
        pel_mesh_destroy(mesh);
    }
    assert_near(errors[1], 0, 2e-3);
    assert_near(errors[0] / errors[1], 4, 0.05);
}

static void test_shell(void **state)
{
    (void)state;
    const double r = 0.3;
    pel_mesh *mesh = make_ball(r, 20, 1, 2, 3);
    pel_inertia inertia;
    pel_inertia_of_sheet(mesh, 2, &inertia);
    assert_near(inertia.tensor[0][0] / (inertia.mass * r * r * 2 / 3), 1, 4e-3);
    assert_near(inertia.mass / (2 * 4 * 3.14159265358979 * r * r), 1, 4e-3);
    assert_near(inertia.center[2], 3, ROUNDING);
    pel_mesh_destroy(mesh);
}

static void test_inverse(void **state)
{
    (void)state;
    static const double tensor[3][3] = {{3, 1, 0.5}, {1, 2, -0.2}, {0.5, -0.2, 4}}, line[3][3] = {{1, 0, 0}, {0, 1, 0}};
    double inverse[3][3];
    assert_true(pel_inertia_invert(tensor, inverse));
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) {
            double sum = 0;
            for (int j = 0; j < 3; j++)
                sum += tensor[i][j] * inverse[j][k];
            assert_near(sum, i == k, 1e-14);
        }
    assert_false(pel_inertia_invert(line, inverse));
    assert_true(inverse[0][0] == 0);
}

/* a cone, whose filling has another center than its surface: masses are above 0, and have the filling's center */
static void test_lump(void **state)
{
    (void)state;
    enum { SIDES = 12 };
    double positions[SIDES + 2][3] = {{0, 0, 1}, {0, 0, 0}}, shares[SIDES + 2], masses[SIDES + 2], sum = 0,
                             center[3] = {0};
    int32_t triangles[2 * SIDES][3];
    for (int i = 0; i < SIDES; i++) {
        double angle = 2 * 3.14159265358979323846 * i / SIDES;
        pel_vec3_set(positions[2 + i], 0.3 * cos(angle), 0.3 * sin(angle), 0);
        const int32_t next = 2 + (i + 1) % SIDES, here = 2 + i;
        memcpy(triangles[2 * i], ((int32_t[3]){0, here, next}), sizeof triangles[0]);
        memcpy(triangles[2 * i + 1], ((int32_t[3]){1, next, here}), sizeof triangles[0]);
    }
    pel_mesh *mesh;
    assert_int_equal(pel_mesh_create(positions[0], SIDES + 2, triangles[0], 2 * SIDES, &mesh, NULL), PEL_OK);
    for (int i = 0; i < SIDES + 2; i++)
        shares[i] = 1;
    pel_inertia inertia;
    pel_inertia_of_solid(mesh, 500, &inertia);
    assert_near(inertia.center[2], 0.25, ROUNDING);
    assert_true(pel_inertia_lump(mesh, &inertia, shares, masses));
    for (int i = 0; i < SIDES + 2; i++) {
        assert_true(masses[i] > 0);
        sum += masses[i];
        pel_vec3_along(center, masses[i] / inertia.mass, positions[i], center);
    }
    assert_near(sum, inertia.mass, ROUNDING);
    for (int k = 0; k < 3; k++)
        assert_near(center[k], inertia.center[k], ROUNDING);
    /* no masses above 0 have a center outside */
    inertia.center[2] = 1.5;
    assert_false(pel_inertia_lump(mesh, &inertia, shares, masses));
    pel_mesh_destroy(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_box),   cmocka_unit_test(test_turned_box), cmocka_unit_test(test_ball),
        cmocka_unit_test(test_shell), cmocka_unit_test(test_inverse),    cmocka_unit_test(test_lump),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
