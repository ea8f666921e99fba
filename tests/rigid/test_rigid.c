/* The motion of one body: what a free rotation conserves, pins, pushes, places. */
#include "math/pose.h"
#include "rigid/rigid.h"
#include "rigid_scene.h"

static const double origin[3] = {0}, none[3] = {0};

static pel_rigid_shape shape_of(const double size[3], const int32_t *pinned, int32_t pinned_count)
{
    pel_mesh *mesh = make_box(size[0], size[1], size[2], origin);
    pel_inertia inertia;
    pel_rigid_shape shape;
    pel_inertia_of_solid(mesh, 1000, &inertia);
    pel_rigid_shape_set(&shape, &inertia, mesh, pinned, pinned_count);
    pel_mesh_destroy(mesh);
    return shape;
}

static pel_rigid body_of(const pel_rigid_shape *shape, const double velocity[3], const double spin[3])
{
    pel_rigid rigid = {.shape = shape};
    pel_rigid_state at_start;
    pel_rigid_state_start(shape, velocity, spin, &at_start);
    pel_rigid_begin(&rigid, &at_start);
    return rigid;
}

/* Dzhanibekov: rotation about the middle axis turns over again and again; energy and angular momentum stay */
static void test_tumbling(void **state)
{
    (void)state;
    static const double size[3] = {0.1, 0.2, 0.4}, spin[3] = {0.01, 10, 0};
    pel_rigid_shape shape = shape_of(size, NULL, 0);
    pel_rigid rigid = body_of(&shape, none, spin);
    double energy = pel_rigid_kinetic_energy(&shape, &rigid.state), angular[3], least = 1, most = -1;
    pel_vec3_copy(rigid.state.angular_momentum, angular);
    for (int i = 0; i < 20000; i++) {
        pel_rigid_drift(&rigid, 1e-3);
        double axis[3] = {rigid.matrix[0][1], rigid.matrix[1][1], rigid.matrix[2][1]};
        least = fmin(least, axis[1]);
        most = fmax(most, axis[1]);
    }
    assert_near(pel_rigid_kinetic_energy(&shape, &rigid.state) / energy, 1, 1e-11);
    assert_memory_equal(rigid.state.angular_momentum, angular, sizeof angular);
    assert_true(least < -0.999 && most > 0.999);
}

/* A symmetric body wobbles about its angular momentum at |L| / I. */
static void test_precession(void **state)
{
    (void)state;
    static const double size[3] = {0.2, 0.2, 0.05}, spin[3] = {3, 0, 40};
    pel_rigid_shape shape = shape_of(size, NULL, 0);
    pel_rigid rigid = body_of(&shape, none, spin);
    const double *l = rigid.state.angular_momentum;
    double rate = pel_vec3_length(l) / shape.inertia[0][0], time = 0, turned = 0, along[3], u[3], w[3], last = 0;
    pel_vec3_scale(l, 1 / pel_vec3_length(l), along);
    pel_vec3_set(u, 0, 1, 0);
    pel_vec3_cross(along, u, w);
    for (int i = 0; i < 5000; i++, time += 1e-3) {
        double axis[3] = {rigid.matrix[0][2], rigid.matrix[1][2], rigid.matrix[2][2]};
        double angle = atan2(pel_vec3_dot(axis, w), pel_vec3_dot(axis, u));
        double way = remainder(angle - last, 2 * 3.14159265358979323846);
        turned += i > 0 ? way : 0;
        last = angle;
        pel_rigid_drift(&rigid, 1e-3);
    }
    assert_near(fabs(turned) / (rate * (time - 1e-3)), 1, 1e-3);
}

/* a push moves the grip as its mobility says, and momenta by the same over the time */
static void test_push(void **state)
{
    (void)state;
    static const double size[3] = {0.1, 0.2, 0.4}, spin[3] = {1, 2, 3}, arm[3] = {0.05, 0.1, -0.2};
    static const double direction[3] = {0.6, 0, 0.8};
    pel_rigid_shape shape = shape_of(size, NULL, 0);
    pel_rigid rigid = body_of(&shape, none, spin);
    pel_rigid_drift(&rigid, 0.3);
    pel_rigid_grip grip = {.rigid = &rigid, .weight = -1};
    pel_vec3_copy(arm, grip.arm);
    double mobility = pel_rigid_mobility(&grip, direction), push[3], before[3], after[3], local[3];
    double momentum[3];
    const double d = 1e-7 / mobility, rate = 100;
    pel_rotate_back(rigid.state.rotation, arm, local);
    pel_vec3_along(arm, -1, rigid.state.pivot, before);
    pel_vec3_copy(rigid.state.momentum, momentum);
    pel_vec3_scale(direction, d, push);
    pel_rigid_push(&grip, push, rate);
    pel_rotate(rigid.state.rotation, local, after);
    pel_vec3_along(after, -1, rigid.state.pivot, after);
    pel_vec3_subtract(after, before, after);
    assert_near(pel_vec3_dot(after, direction) / (mobility * d), 1, 1e-5);
    for (int k = 0; k < 3; k++)
        assert_near(rigid.state.momentum[k] - momentum[k], -rate * push[k], 1e-12);
}

/* one pin: the pivot stays; two: only the line; three: nothing moves */
static void test_pins(void **state)
{
    (void)state;
    static const double size[3] = {0.1, 0.2, 0.4}, push[3] = {1e-3, 2e-3, 5e-4}, spin[3] = {1, 2, 3};
    static const int32_t pins[3] = {0, 4, 6};
    for (int count = 1; count <= 3; count++) {
        pel_rigid_shape shape = shape_of(size, pins, count);
        pel_rigid rigid = body_of(&shape, none, spin);
        double start[3], other[3], axis[3] = {0, 0, 1}, turned[3];
        pel_vec3_copy(rigid.state.pivot, start);
        pel_rigid_grip grip = {.rigid = &rigid, .weight = 1, .arm = {0.1, 0.2, 0.3}};
        pel_rigid_push(&grip, push, 10);
        pel_rigid_drift(&rigid, 0.1);
        assert_memory_equal(rigid.state.pivot, start, sizeof start);
        pel_rotate(rigid.state.rotation, axis, turned);
        pel_vec3_subtract(turned, axis, other);
        assert_int_equal(shape.has_joint, count < 3);
        assert_int_equal(shape.has_axis, count == 2);
        assert_int_equal(pel_vec3_length(other) > 1e-3, count == 1);
        assert_int_equal(fabs(rigid.state.rotation[3]) < 1 - 1e-6, count < 3);
        assert_int_equal(pel_rigid_kinetic_energy(&shape, &rigid.state) > 0, count < 3);
    }
}

/* a bar that swings about its end has the inertia about that */
static void test_hinge_inertia(void **state)
{
    (void)state;
    static const double size[3] = {0.02, 0.02, 0.4}, spin[3] = {0, 2, 0};
    static const int32_t pins[2] = {4, 7}; /* an edge along y */
    pel_rigid_shape shape = shape_of(size, pins, 2);
    pel_rigid rigid = body_of(&shape, none, spin);
    double mass = 0.16, about = mass * (0.4 * 0.4 + 0.02 * 0.02) / 12, arm = 0.2 * 0.2 + 0.01 * 0.01;
    assert_near(fabs(shape.axis[1]), 1, 1e-12);
    /* of the velocities at the start stays what the hinge leaves: J w about the center, over that about the hinge */
    double left = 2 * about / (about + mass * arm), velocity[3], turn[3];
    pel_rigid_center(&shape, &rigid.state, NULL, velocity, turn, NULL);
    assert_near(turn[1], left, 1e-12);
    assert_near(velocity[0], -0.2 * left, 1e-12);
}

/* a cube, whose tensor is the same about all axes but for rounding, has exactly that; a bar keeps its own */
static void test_roundness(void **state)
{
    (void)state;
    static const double cube[3] = {0.3, 0.3, 0.3}, bar[3] = {0.3, 0.3, 0.31};
    pel_rigid_shape shape = shape_of(cube, NULL, 0);
    double inertia = 1000 * 0.027 * 0.3 * 0.3 / 6;
    assert_near(shape.roundness * inertia, 1, 1e-12);
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++) {
            assert_near(shape.inertia[a][b], a == b ? inertia : 0, 1e-12);
            assert_true(a == b || shape.inertia[a][b] == 0);
        }
    shape = shape_of(bar, NULL, 0);
    assert_true(shape.roundness == 0);
    assert_near(shape.inertia[2][2], 1000 * 0.3 * 0.3 * 0.31 * 0.3 * 0.3 / 6, 1e-12);
}

/* the angle of a path to and fro is that of all its parts */
static void test_turned(void **state)
{
    (void)state;
    static const double size[3] = {1, 2, 3}, angles[4] = {0.1, 0.5, 0.2, 0.4};
    pel_rigid_shape shape = shape_of(size, NULL, 0);
    pel_rigid_state path[3];
    pel_rigid rigid = body_of(&shape, none, none);
    rigid.path = path;
    rigid.before = rigid.state;
    for (int32_t count = 0; count <= 3; count++) {
        double sum = 0;
        rigid.path_count = count;
        for (int32_t i = 0; i <= count; i++) {
            pel_rigid_state *to = i < count ? &path[i] : &rigid.state;
            *to = rigid.before;
            pel_vec3_set(to->rotation, 0, 0, sin(angles[i] / 2));
            to->rotation[3] = cos(angles[i] / 2);
            sum += fabs(angles[i] - (i > 0 ? angles[i - 1] : 0));
        }
        assert_near(pel_rigid_turned(&rigid), sum, 1e-12);
    }
}

/* A vertex on a path in parts of equal times, about the z axis and along: at a share of each part, and at both ends. */
static void test_place_between(void **state)
{
    (void)state;
    static const double size[3] = {1, 2, 3}, angles[5] = {0, 0.4, -0.3, 0.9, 1.1}, ways[5] = {0, 1, 3, -2, 5};
    pel_rigid_shape shape = shape_of(size, NULL, 0);
    pel_vec3_set(shape.pivot, 0.1, 0.2, 0.3);
    pel_rigid_state path[3];
    const pel_record rest[1] = {{(pel_real)0.6, (pel_real)-0.8, (pel_real)1.3}};
    const pel_rigids all = {.rest = rest};
    double arm[3];
    pel_vertex_position(rest, 0, arm);
    pel_vec3_subtract(arm, shape.pivot, arm);
    pel_rigid rigid = body_of(&shape, none, none);
    rigid.path = path;
    for (int32_t count = 0; count <= 3; count++) {
        rigid.path_count = count;
        for (int32_t i = 0; i <= count + 1; i++) {
            pel_rigid_state *at = i == 0 ? &rigid.before : i <= count ? &path[i - 1] : &rigid.state;
            *at = (pel_rigid_state){.pivot = {ways[i], 2, -ways[i]},
                                    .rotation = {0, 0, sin(angles[i] / 2), cos(angles[i] / 2)}};
        }
        for (int k = 0; k <= 40; k++) {
            double share = k / 40.0, x[3], parts = share * (count + 1);
            int part = parts < count ? (int)parts : count;
            double rest_of = parts - part, angle = angles[part] + rest_of * (angles[part + 1] - angles[part]);
            double way = ways[part] + rest_of * (ways[part + 1] - ways[part]);
            pel_rigid_place_between(&rigid, &all, 0, share, x);
            assert_near(x[0], way + cos(angle) * arm[0] - sin(angle) * arm[1], 1e-12);
            assert_near(x[1], 2 + sin(angle) * arm[0] + cos(angle) * arm[1], 1e-12);
            assert_near(x[2], -way + arm[2], 1e-12);
        }
    }
}

/* vertices of a turned body, and a body of turned vertices */
static void test_fit(void **state)
{
    (void)state;
    static const double size[3] = {0.1, 0.2, 0.4}, spin[3] = {1, 2, 3}, velocity[3] = {1, 0, 0};
    pel_record rest[8], places[8] = {{0}};
    pel_real inverse[8], masses[8];
    int32_t of_slice[8 / PEL_WIDTH + 1] = {0};
    pel_mesh *mesh = make_box(size[0], size[1], size[2], origin);
    for (int v = 0; v < 8; v++) {
        rest[v] = (pel_record){(pel_real)mesh->positions[v][0], (pel_real)mesh->positions[v][1],
                               (pel_real)mesh->positions[v][2], 1};
        inverse[v] = masses[v] = (pel_real)(1 + 0.1 * v);
    }
    pel_rigid_shape shape = shape_of(size, NULL, 0);
    pel_rigid rigid = body_of(&shape, velocity, spin), other = body_of(&shape, none, none);
    pel_rigids rigids = {.count = 1, .items = &rigid, .of_slice = of_slice, .rest = rest, .inverse_mass = inverse};
    rigid.end = other.end = 8;
    pel_rigid_drift(&rigid, 0.7);
    pel_rigids_place(&rigids, places);
    assert_false(rigid.is_moved);
    pel_rigid_fit(&other, &rigids, masses, places);
    const double tolerance = sizeof(pel_real) == sizeof(double) ? 1e-12 : 1e-5;
    for (int i = 0; i < 3; i++)
        assert_near(other.state.pivot[i], rigid.state.pivot[i], tolerance);
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            assert_near(other.matrix[i][k], rigid.matrix[i][k], tolerance);
    /* back by half of the way */
    pel_rigid_state end = rigid.state;
    rigid.before = (pel_rigid_state){.rotation = {0, 0, 0, 1}};
    pel_rigid_go_back(&rigid, &end, 0.5);
    assert_near(rigid.state.pivot[0], 0.5 * end.pivot[0], 1e-12);
    for (int i = 0; i < 3; i++) {
        double axis[3] = {i == 0, i == 1, i == 2}, turned[3];
        pel_rotate(rigid.state.rotation, axis, turned);
        for (int k = 0; k < 3; k++)
            assert_near(rigid.matrix[k][i], turned[k], 1e-12);
        assert_near(rigid.state.momentum[i], 0.5 * end.momentum[i], 1e-12);
        assert_near(rigid.state.angular_momentum[i], 0.5 * end.angular_momentum[i], 1e-12);
    }
    assert_near(2 * acos(rigid.state.rotation[3]), 0.5 * 2 * acos(fabs(end.rotation[3])), 1e-9);
    pel_mesh_destroy(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_tumbling),  cmocka_unit_test(test_precession),    cmocka_unit_test(test_push),
        cmocka_unit_test(test_pins),      cmocka_unit_test(test_hinge_inertia), cmocka_unit_test(test_fit),
        cmocka_unit_test(test_roundness), cmocka_unit_test(test_turned),        cmocka_unit_test(test_place_between),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
