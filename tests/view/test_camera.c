#include "check.h"
#include "random.h"

#include "view/camera.h"

#include <stdlib.h>

enum { POINTS = 60, CLOUDS = 200 };

/* where a point lands in the picture: -1 .. 1 across, up and in depth */
static void project(const view_camera *camera, const double point[3], double place[3])
{
    double turned[3];
    float matrix[16];
    view_camera_turn(camera, point, turned);
    view_camera_project(camera, matrix);
    double clip[4];
    for (int i = 0; i < 4; ++i)
        clip[i] = (double)matrix[i] * turned[0] + (double)matrix[4 + i] * turned[1] +
                  (double)matrix[8 + i] * turned[2] + (double)matrix[12 + i];
    for (int i = 0; i < 3; ++i)
        place[i] = clip[i] / clip[3];
}

/* everything is seen, and the picture is filled: some point is at the border on the tighter axis, on both sides */
static void test_fit(void **unused)
{
    (void)unused;
    random_state random = {7};
    for (int cloud = 0; cloud < CLOUDS; ++cloud) {
        double points[POINTS][3], far[3], place[3], low[2] = {9, 9}, high[2] = {-9, -9};
        double size = pow(10, random_between(&random, -4, 3));
        for (int i = 0; i < 3; ++i)
            far[i] = random_between(&random, -100, 100) * size;
        pel_camera_angle angle = {random_between(&random, -360, 360), random_between(&random, -90, 90), 1};
        view_camera camera;
        view_camera_begin(&camera, &angle, cloud % 3, 200 + cloud, 300);
        for (int p = 0; p < POINTS; ++p) {
            for (int i = 0; i < 3; ++i)
                points[p][i] = far[i] + size * random_between(&random, -1, 1);
            view_camera_see(&camera, points[p], 0);
        }
        view_camera_fit(&camera, 1);
        for (int p = 0; p < POINTS; ++p) {
            project(&camera, points[p], place);
            for (int i = 0; i < 2; ++i) {
                low[i] = fmin(low[i], place[i]);
                high[i] = fmax(high[i], place[i]);
            }
            assert_true(fabs(place[2]) < 1);
        }
        /* 0.94 of the picture is filled; floats of the matrix allow for the rest */
        double tolerance = 1e-4, filled[2] = {high[0] - low[0], high[1] - low[1]};
        assert_near(fmax(filled[0], filled[1]), 2 * 0.94, tolerance);
        for (int i = 0; i < 2; ++i)
            assert_true(low[i] > -0.9401 && high[i] < 0.9401);
    }
}

/* the surface of a ball that is to be seen is seen */
static void test_ball(void **unused)
{
    (void)unused;
    random_state random = {3};
    view_camera camera;
    pel_camera_angle angle = {30, 20, 1};
    const double center[3] = {1, 2, 3}, radius = 0.5;
    double most = 0;
    view_camera_begin(&camera, &angle, 2, 300, 200);
    view_camera_see(&camera, center, radius);
    view_camera_fit(&camera, 1);
    for (int n = 0; n < 20000; ++n) {
        double d[3], length = 0, place[3];
        for (int i = 0; i < 3; ++i) {
            d[i] = random_between(&random, -1, 1);
            length += d[i] * d[i];
        }
        for (int i = 0; i < 3; ++i)
            d[i] = center[i] + radius * d[i] / sqrt(length);
        project(&camera, d, place);
        most = fmax(most, fabs(place[1]));
        assert_true(fabs(place[0]) <= 1 && fabs(place[1]) <= 0.9401 && fabs(place[2]) < 1);
    }
    assert_near(most, 0.94, 0.002);
}

/* one point, a zoom and the sides of presets */
static void test_presets(void **unused)
{
    (void)unused;
    /* preset, axis of the world that points right, up and at the camera: 1 = x, ... */
    static const struct {
        const char *name;
        int axes[3];
    } cases[] = {{"front", {1, 3, -2}}, {"back", {-1, 3, 2}}, {"right", {2, 3, 1}},
                 {"left", {-2, 3, -1}}, {"top", {1, 2, 3}},   {"bottom", {1, -2, -3}}};
    for (size_t c = 0; c < sizeof cases / sizeof *cases; ++c) {
        pel_camera_angle angle;
        view_camera camera;
        assert_true(pel_camera_preset_find(cases[c].name, &angle));
        view_camera_begin(&camera, &angle, 2, 100, 100);
        for (int i = 0; i < 3; ++i) {
            int axis = cases[c].axes[i];
            assert_near(camera.axes[i][abs(axis) - 1], axis > 0 ? 1 : -1, 1e-15);
        }
        /* with y up the camera of "front" stands at +z */
        view_camera_begin(&camera, &angle, 1, 100, 100);
        if (c == 0)
            assert_near(camera.axes[2][2], 1, 1e-15);
        view_camera_see(&camera, (double[]){5, 6, 7}, 0);
        view_camera_fit(&camera, 2);
        double place[3];
        project(&camera, (double[]){5, 6, 7}, place);
        assert_true(fabs(place[0]) < 1e-6 && fabs(place[1]) < 1e-6 && fabs(place[2]) <= 1);
    }
    assert_null(pel_camera_preset_name(-1));
    for (int i = 0; pel_camera_preset_name(i) != NULL; ++i)
        assert_true(i < 7);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_fit), cmocka_unit_test(test_ball),
                                       cmocka_unit_test(test_presets)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
