#include "check.h"

#include "primitive/lens.h"

static const int32_t ages[3] = {11, 29, 45};

/* the profile as published, r^5, r^4, r^3, r^2, 1 */
static double published_front(int32_t age, double r)
{
    const double c[3][5] = {{-0.00153004454939, 0.01191111565048, -0.02032562095557, -0.07692307692308, 2.04},
                            {-0.00048433393427, 0.00528772036011, -0.01383693844808, -0.07352941176471, 2.18},
                            {-0.00026524088453, 0.00449862869630, -0.01657250977510, -0.06578947368424, 2.42}};
    const double *a = c[age == 11 ? 0 : age == 29 ? 1 : 2];
    return a[0] * pow(r, 5) + a[1] * pow(r, 4) + a[2] * pow(r, 3) + a[3] * r * r + a[4];
}

static void test_poles_and_ages(void **unused)
{
    (void)unused;
    const double front[3] = {2.04, 2.18, 2.42}, back[3] = {-2.09, -2.13, -2.42}, meeting[3] = {4.522, 4.390, 4.700};
    pel_lens_outline outline;
    for (int k = 0; k < 3; k++) {
        double r, z;
        assert_true(pel_lens_outline_of_age(ages[k], &outline));
        pel_lens_outline_point(&outline, 0, &r, &z);
        assert_near(r, 0, 0);
        assert_near(z, front[k], 1e-15);
        pel_lens_outline_point(&outline, outline.length, &r, &z);
        assert_near(r, 0, 0);
        assert_near(z, back[k], 1e-15);
        /* the arc begins 0.3 mm before the published profiles meet, and rounds the kink off inside it */
        assert_near(outline.front.end, meeting[k] - 0.3, 1e-3);
        assert_true(outline.back.end > outline.front.end && outline.back.end < meeting[k]);
        pel_lens_outline_point(&outline, outline.length_to_equator, &r, &z);
        assert_near(r, outline.arc_centre[0] + outline.arc_radius, 1e-12);
        assert_true(r < meeting[k] && r > meeting[k] - 0.3);
    }
    assert_false(pel_lens_outline_of_age(30, &outline));
}

static void test_follows_the_published_profile(void **unused)
{
    (void)unused;
    for (int k = 0; k < 3; k++) {
        pel_lens_outline outline;
        assert_true(pel_lens_outline_of_age(ages[k], &outline));
        for (int i = 0; i <= 100; i++) {
            double r = outline.front.end * i / 100, along = pel_lens_outline_front_length(&outline, r), found, z;
            pel_lens_outline_point(&outline, along, &found, &z);
            assert_near(found, r, 1e-12);
            assert_near(z, published_front(ages[k], r), 1e-12);
        }
    }
}

/* unit speed everywhere: `along` is the length, and neither the outline nor its direction jumps (C1) */
static void test_smooth_and_by_length(void **unused)
{
    (void)unused;
    for (int k = 0; k < 3; k++) {
        pel_lens_outline outline;
        enum { COUNT = 20000 };
        double r0 = 0, z0 = 0, dr0 = 0, dz0 = 0;
        assert_true(pel_lens_outline_of_age(ages[k], &outline));
        double step = outline.length / COUNT;
        for (int i = 0; i <= COUNT; i++) {
            double r, z;
            pel_lens_outline_point(&outline, step * i, &r, &z);
            double dr = (r - r0) / step, dz = (z - z0) / step;
            if (i > 0)
                assert_near(hypot(dr, dz), 1, 1e-5);
            /* the arc turns by step / radius per step; a kink of the profiles would be 1.5 rad */
            if (i > 1)
                assert_true(fabs(dr * dz0 - dz * dr0) < 1.1 * step / outline.arc_radius);
            r0 = r, z0 = z, dr0 = dr, dz0 = dz;
        }
    }
}

static void test_arc_touches_both_sides(void **unused)
{
    (void)unused;
    for (int k = 0; k < 3; k++) {
        pel_lens_outline outline;
        assert_true(pel_lens_outline_of_age(ages[k], &outline));
        double front = outline.front.length[PEL_LENS_PANELS],
               back = outline.length - outline.back.length[PEL_LENS_PANELS];
        const double joints[2] = {front, back};
        for (int j = 0; j < 2; j++) {
            double r[2], z[2], tiny = 1e-9;
            pel_lens_outline_point(&outline, joints[j] - tiny, &r[0], &z[0]);
            pel_lens_outline_point(&outline, joints[j] + tiny, &r[1], &z[1]);
            /* no gap, and the tangent is at right angles to the radius of the arc */
            assert_near(hypot(r[1] - r[0], z[1] - z[0]), 2 * tiny, 1e-12);
            double out[2] = {(r[0] - outline.arc_centre[0]) / outline.arc_radius,
                             (z[0] - outline.arc_centre[1]) / outline.arc_radius};
            assert_near(hypot(out[0], out[1]), 1, 1e-9);
            double before[2], apart = 1e-5;
            pel_lens_outline_point(&outline, joints[j] + (j == 0 ? -apart : apart), &before[0], &before[1]);
            double along = ((before[0] - r[0]) * out[0] + (before[1] - z[0]) * out[1]) / apart;
            assert_near(along, 0, 1e-4);
        }
    }
}

static void test_thickness(void **unused)
{
    (void)unused;
    pel_lens_outline outline;
    assert_true(pel_lens_outline_of_age(29, &outline));
    double thickest = pel_lens_outline_front_length(&outline, 3), last = 0;
    assert_near(pel_lens_thickness(&outline, 0), 13e-6, 1e-18);
    assert_near(pel_lens_thickness(&outline, thickest), 25e-6, 1e-18);
    assert_near(pel_lens_thickness(&outline, outline.length), 3e-6, 1e-18);
    for (int i = 0; i <= 1000; i++) {
        double along = outline.length * i / 1000, thickness = pel_lens_thickness(&outline, along);
        assert_true(i == 0 || (along <= thickest ? thickness > last
                                                 : thickness < last || along - outline.length / 1000 < thickest));
        last = thickness;
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_poles_and_ages),
        cmocka_unit_test(test_follows_the_published_profile),
        cmocka_unit_test(test_smooth_and_by_length),
        cmocka_unit_test(test_arc_touches_both_sides),
        cmocka_unit_test(test_thickness),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
