/* Rotations and poses against Rodrigues' formula. */
#include "check.h"
#include "random.h"

#include "math/pose.h"

enum { TRIALS = 500 };

static const double rounding = 1e-13;

static void random_vector(random_state *random, double length, double vector[3])
{
    for (int i = 0; i < 3; i++)
        vector[i] = random_normal(random);
    pel_vec3_scale(vector, length / pel_vec3_length(vector), vector);
}

static void random_turn(random_state *random, double q[4])
{
    double vector[3];
    random_vector(random, random_between(random, 0, 6), vector);
    pel_rotation_exp(vector, q);
}

static void check_vector(const double actual[3], const double expected[3], double tolerance)
{
    for (int i = 0; i < 3; i++)
        assert_near(actual[i], expected[i], tolerance);
}

/* turns x by a rotation vector: x cos + (k x x) sin + k (k . x) (1 - cos) */
static void rodrigues(const double vector[3], const double x[3], double turned[3])
{
    double angle = pel_vec3_length(vector), axis[3] = {0, 0, 0}, across[3];
    if (angle > 0)
        pel_vec3_scale(vector, 1 / angle, axis);
    pel_vec3_cross(axis, x, across);
    for (int i = 0; i < 3; i++)
        turned[i] = x[i] * cos(angle) + across[i] * sin(angle) + axis[i] * pel_vec3_dot(axis, x) * (1 - cos(angle));
}

static void test_rotations(void **unused)
{
    (void)unused;
    random_state random = {1};
    for (int trial = 0; trial < TRIALS; trial++) {
        double vector[3], x[3], q[4], turned[3], expected[3];
        random_vector(&random, trial == 0 ? 0 : random_between(&random, 0, 20), vector);
        random_vector(&random, 1, x);
        pel_rotation_exp(vector, q);
        assert_near(pel_vec3_dot(q, q) + q[3] * q[3], 1, rounding);
        pel_rotate(q, x, turned);
        rodrigues(vector, x, expected);
        check_vector(turned, expected, rounding);
        pel_rotate_back(q, turned, turned);
        check_vector(turned, x, rounding);
    }
    const double none[3] = {0, 0, 0};
    double q[4];
    pel_rotation_exp(none, q);
    check_vector(q, none, 0);
    assert_near(q[3], 1, 0);
}

/* first b, then a; also in place */
static void test_products(void **unused)
{
    (void)unused;
    random_state random = {2};
    for (int trial = 0; trial < TRIALS; trial++) {
        double a[4], b[4], product[4], left[4], right[4], x[3], turned[3], expected[3];
        random_turn(&random, a);
        random_turn(&random, b);
        random_vector(&random, 1, x);
        pel_rotate(b, x, expected);
        pel_rotate(a, expected, expected);
        memcpy(left, a, sizeof a);
        memcpy(right, b, sizeof b);
        pel_rotation_product(a, b, product);
        pel_rotation_product(left, b, left);
        pel_rotation_product(a, right, right);
        assert_memory_equal(left, product, sizeof product);
        assert_memory_equal(right, product, sizeof product);
        pel_rotate(product, x, turned);
        check_vector(turned, expected, rounding);
    }
}

/* the rotation vector that leads from one to another, with as many whole turns as expected */
static void test_between(void **unused)
{
    (void)unused;
    const double tolerance = 1e-10;
    random_state random = {3};
    for (int trial = 0; trial < TRIALS; trial++) {
        double a[4], b[4], vector[3], found[3], near[3];
        const double none[3] = {0, 0, 0};
        random_turn(&random, a);
        random_vector(&random, random_between(&random, 0.1, 20), vector);
        pel_rotation_turn(a, vector, 1, b);
        random_vector(&random, 0.3, near);
        pel_vec3_add(near, vector, near);
        pel_rotation_between(a, b, near, found);
        check_vector(found, vector, tolerance);
        pel_rotation_between(a, b, none, found);
        assert_true(pel_vec3_length(found) < 3.1416);
        double x[3], turned[3], expected[3];
        random_vector(&random, 1, x);
        pel_rotate_back(a, x, turned);
        pel_rotate(b, turned, turned);
        rodrigues(found, x, expected);
        check_vector(turned, expected, tolerance);
    }
}

static pel_pose random_pose(random_state *random)
{
    pel_pose pose = {.spin = {1, 2, 3}};
    random_vector(random, 5, pose.position);
    random_turn(random, pose.rotation);
    return pose;
}

static void test_places(void **unused)
{
    (void)unused;
    random_state random = {4};
    for (int trial = 0; trial < TRIALS; trial++) {
        pel_pose pose = random_pose(&random);
        double local[3], world[3], expected[3], back[3];
        random_vector(&random, 2, local);
        pel_rotate(pose.rotation, local, expected);
        pel_vec3_add(expected, pose.position, expected);
        pel_pose_to_world(&pose, local, world);
        check_vector(world, expected, rounding);
        pel_pose_to_local(&pose, world, back);
        check_vector(back, local, 10 * rounding);
    }
}

/* the share of a motion: of the way along a line, and of the turn about one axis */
static void test_motion(void **unused)
{
    (void)unused;
    const double tolerance = 1e-10;
    random_state random = {5};
    for (int trial = 0; trial < TRIALS; trial++) {
        double vector[3], part[3], way[3], x[3], turned[3], expected[3];
        double share = random_between(&random, 0.01, 0.99);
        pel_pose a = random_pose(&random), b = a, pose;
        random_vector(&random, random_between(&random, 0.1, 15), vector);
        random_vector(&random, 3, way);
        pel_vec3_add(a.position, way, b.position);
        pel_vec3_add(a.spin, vector, b.spin);
        pel_rotation_turn(a.rotation, vector, 1, b.rotation);
        pel_pose_between(&a, &b, share, &pose);
        for (int i = 0; i < 3; i++) {
            assert_near(pose.position[i], a.position[i] + share * way[i], tolerance);
            assert_near(pose.spin[i], a.spin[i] + share * vector[i], tolerance);
        }
        random_vector(&random, 1, x);
        pel_vec3_scale(vector, share, part);
        pel_rotate(a.rotation, x, expected);
        rodrigues(part, expected, turned);
        pel_rotate(pose.rotation, x, expected);
        check_vector(turned, expected, tolerance);
        assert_near(pel_pose_way(&a, &b, 0.7), 3 + 0.7 * pel_vec3_length(vector), tolerance);
        for (int end = 0; end < 4; end++) {
            const double shares[4] = {0, -1, 1, 2};
            pel_pose_between(&a, &b, shares[end], &pose);
            assert_memory_equal(&pose, end < 2 ? &a : &b, sizeof pose);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_rotations), cmocka_unit_test(test_products), cmocka_unit_test(test_between),
        cmocka_unit_test(test_places),    cmocka_unit_test(test_motion),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
