/* Depth of triangles in rigid solids against dense sampling of the triangle. */
#include "check.h"

#include "geom/solid.h"
#include "math/pose.h"
#include "math/vec3.h"

#include <stdlib.h>

static double uniform(double low, double high)
{
    return low + (high - low) * (rand() / (double)RAND_MAX);
}

static const pel_solid solids[] = {
    {.shape = PEL_TOOL_SPHERE, .radius = 0.7},
    {.shape = PEL_TOOL_CAPSULE, .radius = 0.4, .half_length = 0.6},
    {.shape = PEL_TOOL_CAPSULE, .radius = 0.5, .half_length = 0},
    {.shape = PEL_TOOL_BOX, .half_extents = {0.3, 0.6, 0.9}},
};

static void combine(double corner[3][3], const double weights[3], double point[3])
{
    for (int i = 0; i < 3; i++)
        point[i] = weights[0] * corner[0][i] + weights[1] * corner[1][i] + weights[2] * corner[2][i];
}

/* depth of the deepest of many points; the box counts depth by its nearest face */
static double sampled_depth(const pel_solid *solid, double corner[3][3])
{
    enum { PARTS = 60 };
    double deepest = -HUGE_VAL;
    for (int i = 0; i <= PARTS; i++)
        for (int j = 0; i + j <= PARTS; j++) {
            double weights[3] = {1 - (i + j) / (double)PARTS, i / (double)PARTS, j / (double)PARTS}, p[3], normal[3];
            combine(corner, weights, p);
            double depth = -pel_solid_distance(solid, p, normal);
            deepest = depth > deepest ? depth : deepest;
        }
    return deepest;
}

static void test_depth_against_samples(void **unused)
{
    (void)unused;
    srand(3);
    for (size_t s = 0; s < sizeof solids / sizeof *solids; s++) {
        int hits = 0;
        for (int n = 0; n < 400; n++) {
            double corner[3][3], weights[3], normal[3], p[3], out[3];
            for (int i = 0; i < 9; i++)
                corner[i / 3][i % 3] = uniform(-1.5, 1.5);
            double depth = pel_solid_depth(&solids[s], corner[0], corner[1], corner[2], weights, normal);
            double sampled = sampled_depth(&solids[s], corner);
            double deepest = depth;
            if (depth > 0) {
                combine(corner, weights, p);
                deepest = -pel_solid_distance(&solids[s], p, out);
            }
            /* samples lie at most one cell from the deepest point */
            assert_true(fmax(deepest, 0) >= sampled - 1e-9);
            assert_true(fmax(deepest, 0) <= fmax(sampled, 0) + 0.08);
            if (depth <= 0)
                continue;
            hits++;
            assert_near(weights[0] + weights[1] + weights[2], 1, 1e-9);
            assert_near(pel_vec3_length(normal), 1, 1e-9);
            /* moved out along the normal, the deepest point is outside, and not far: an axis across edges leans */
            pel_vec3_along(p, depth, normal, p);
            double left = pel_solid_distance(&solids[s], p, out);
            assert_true(left >= -1e-9 && left <= (solids[s].shape == PEL_TOOL_BOX ? depth : 1e-9));
            assert_true(depth >= deepest - 1e-9);
        }
        assert_true(hits > 50);
    }
}

/* a triangle that the axis goes through is pushed sideways, against its own normal; a level one anywhere sideways */
/* a corner is deepest, and stays so while corners move by less than the room */
static void test_corner_room(void **unused)
{
    (void)unused;
    srand(11);
    for (size_t s = 0; s < sizeof solids / sizeof *solids; s++) {
        int sure = 0, roomy = 0;
        for (int n = 0; n < 2000; n++) {
            double corner[3][3], center[3], normal[3], deepest = -HUGE_VAL;
            for (int k = 0; k < 3; k++)
                center[k] = uniform(-1, 1);
            for (int i = 0; i < 9; i++)
                corner[i / 3][i % 3] = center[i % 3] + uniform(-0.2, 0.2);
            double room = pel_solid_corner_room(&solids[s], (const double(*)[3])corner);
            if (room < 0)
                continue;
            for (int i = 0; i < 9; i++)
                corner[i / 3][i % 3] += uniform(-1, 1) * room / sqrt(3);
            for (int c = 0; c < 3; c++)
                deepest = fmax(deepest, -pel_solid_distance(&solids[s], corner[c], normal));
            /* outside, distances to edges and corners are no depths below faces */
            if (deepest > 0)
                assert_true(deepest >= sampled_depth(&solids[s], corner) - 1e-9);
            sure += deepest > 0;
            roomy += deepest > 0 && room > 0;
        }
        bool is_round = pel_solid_is_round(&solids[s]);
        assert_true(is_round ? sure == 0 : sure > 20 && roomy > 5);
    }
}

static void test_pierced(void **unused)
{
    (void)unused;
    srand(4);
    for (int n = 0; n < 600; n++) {
        const pel_solid *solid = &solids[n % 3];
        bool level = n % 5 == 0;
        double corner[3][3], weights[3], found[3], normal[3], own[3], shares[3] = {0.2, 0.3, 0.5};
        double z = uniform(-0.9, 0.9) * solid->half_length;
        for (int i = 0; i < 6; i++)
            corner[i / 3][i % 3] = i % 3 == 2 && level ? z : uniform(-1.5, 1.5);
        for (int i = 0; i < 3; i++)
            corner[2][i] = ((i == 2 ? z : 0) - shares[0] * corner[0][i] - shares[1] * corner[1][i]) / shares[2];
        double depth = pel_solid_depth(solid, corner[0], corner[1], corner[2], weights, normal);
        assert_near(depth, solid->radius, 1e-9);
        combine(corner, weights, found);
        assert_near(hypot(found[0], found[1]), 0, 1e-9);
        assert_near(pel_vec3_length(normal), 1, 1e-12);
        assert_near(normal[2], 0, 1e-12);
        if (level)
            continue;
        pel_vec3_triangle_normal(corner[0], corner[1], corner[2], own);
        own[2] = 0;
        pel_vec3_normalize(own);
        assert_near(pel_vec3_dot(own, normal), -1, 1e-9);
    }
}

static void test_distance_outside_and_inside(void **unused)
{
    (void)unused;
    double normal[3];
    const double corner_point[3] = {1.3, 1.6, 0.9}, inside[3] = {0.1, -0.55, 0.2}, middle[3] = {0, 0, 0};
    assert_near(pel_solid_distance(&solids[3], corner_point, normal), sqrt(2), 1e-12);
    assert_near(pel_solid_distance(&solids[3], inside, normal), -0.05, 1e-12);
    assert_near(normal[1], -1, 1e-12);
    assert_near(pel_solid_distance(&solids[0], middle, normal), -0.7, 1e-12);
    assert_near(pel_vec3_length(normal), 1, 1e-12);
}

/* of a turned box and of a mesh that lies beside its center, against their corners */
static void test_reach(void **unused)
{
    (void)unused;
    double corners[8][3], rotation[4] = {0.1, -0.5, 0.7, 0.5}, length = sqrt(0.01 + 0.25 + 0.49 + 0.25);
    pel_tool_def def = pel_tool_def_default();
    def.shape = PEL_TOOL_BOX;
    pel_mesh mesh = {.positions = corners, .vertex_count = 8};
    for (int i = 0; i < 4; i++)
        rotation[i] /= length;
    for (int k = 0; k < 3; k++)
        def.half_extents[k] = 0.2 + 0.15 * k;
    for (int is_mesh = 0; is_mesh < 2; is_mesh++) {
        double farthest[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}, turned[3];
        for (int i = 0; i < 8; i++) {
            for (int k = 0; k < 3; k++)
                corners[i][k] = (i >> k & 1 ? 1 : -1) * def.half_extents[k] - 3 * is_mesh;
            pel_rotate(rotation, corners[i], turned);
            for (int k = 0; k < 3; k++)
                farthest[k] = fmax(farthest[k], turned[k]);
        }
        def.mesh = is_mesh ? &mesh : NULL;
        for (int k = 0; k < 3; k++) {
            const double along[3] = {k == 0, k == 1, k == 2};
            assert_near(pel_tool_def_reach(&def, rotation, along), farthest[k], 1e-14);
        }
    }
}

static void test_half_box(void **unused)
{
    (void)unused;
    double half[3];
    pel_solid_half_box(&solids[1], half);
    assert_near(half[0], 0.4, 0);
    assert_near(half[2], 1.0, 1e-15);
}

/* the normal of a point within a box is that of the nearest face */
static void test_box_faces(void **unused)
{
    (void)unused;
    const pel_solid *box = &solids[3];
    for (int face = 0; face < 6; face++) {
        double p[3] = {0.01, -0.02, 0.03}, normal[3], side = face % 2 == 0 ? 1 : -1;
        p[face / 2] = side * (box->half_extents[face / 2] - 0.05);
        assert_near(pel_solid_distance(box, p, normal), -0.05, 1e-12);
        for (int i = 0; i < 3; i++)
            assert_near(normal[i], i == face / 2 ? side : 0, 1e-12);
    }
}

/* of scissors the tips and, around the pivot, two points to the sides and one across, by which both blades are drawn */
static void test_scissors_corners(void **unused)
{
    (void)unused;
    pel_solid solid = {.shape = PEL_TOOL_SCISSORS, .edge = {{0.1, 0.03, 0}, {0.1, -0.03, 0}}};
    for (int blade = 0; blade < 2; blade++) {
        int tips = 0, sides = 0, across = 0;
        const double *tip = solid.edge[blade];
        double width = 0;
        for (int32_t i = 4 * blade; i < 4 * blade + 4; i++) {
            double x[3];
            pel_solid_corner(&solid, i, x);
            tips += pel_vec3_distance(x, tip) < 1e-12;
            sides += fabs(x[2]) > 1e-6 && fabs(x[0]) + fabs(x[1]) < 1e-12;
            across +=
                x[2] == 0 && fabs(pel_vec3_dot(x, tip)) < 1e-12 && pel_vec3_length(x) < 0.1 * pel_vec3_length(tip);
            width += fabs(x[2]) > 0 ? x[2] / fabs(x[2]) * pel_vec3_length(x) : 0;
        }
        assert_true(tips == 1 && sides == 2 && across == 1);
        assert_near(width, 0, 1e-12); /* as wide on one side as on the other */
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_scissors_corners),
        cmocka_unit_test(test_box_faces),
        cmocka_unit_test(test_depth_against_samples),
        cmocka_unit_test(test_distance_outside_and_inside),
        cmocka_unit_test(test_half_box),
        cmocka_unit_test(test_reach),
        cmocka_unit_test(test_corner_room),
        cmocka_unit_test(test_pierced),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
