/* The arithmetic of the loop: the proxy against its conditions and closed forms, and energy over random motions. */
#include "check.h"
#include "haptic/proxy.h"
#include "math/vec3.h"
#include "random.h"

/* a def with all automatic numbers resolved */
static pel_haptic_def make_def(double stiffness, bool control)
{
    pel_haptic_def def = pel_haptic_def_default();
    def.coupling_stiffness = stiffness;
    def.surface_stiffness = 10;
    def.passivity_control = control;
    def.energy_budget = 0;
    def.max_force = def.max_force_rate = 1e6;
    return def;
}

static pel_haptic_plane random_plane(random_state *random)
{
    pel_haptic_plane plane = {.offset = random_between(random, -0.01, 0.01),
                              .stiffness = pow(10, random_between(random, 0, 4))};
    for (int i = 0; i < 3; i++)
        plane.normal[i] = random_between(random, -1, 1);
    pel_vec3_normalize(plane.normal);
    return plane;
}

static void random_point(random_state *random, double size, double x[3])
{
    for (int i = 0; i < 3; i++)
        x[i] = random_between(random, -size, size);
}

static double depth_of(const pel_haptic_plane *plane, const double p[3])
{
    double depth = plane->offset - pel_vec3_dot(plane->normal, p);
    return plane->is_two_sided ? depth : fmax(depth, 0);
}

/* ---- the proxy ---- */

/* forces balance at the proxy: K (x - p) + sum k depth n = 0 */
static void test_proxy_is_in_balance(void **unused)
{
    (void)unused;
    random_state random = {1};
    for (int n = 0; n < 2000; n++) {
        pel_haptic_plane planes[PEL_PROXY_PLANES];
        int32_t count = (int32_t)random_integer(&random, 1, PEL_PROXY_PLANES);
        double x[3], p[3], sum[3], stiffness = pow(10, random_between(&random, 1, 4));
        for (int32_t i = 0; i < count; i++) {
            planes[i] = random_plane(&random);
            planes[i].is_two_sided = random_between(&random, 0, 1) < 0.2;
        }
        random_point(&random, 0.02, x);
        pel_proxy_find(planes, count, stiffness, x, p);
        pel_vec3_subtract(x, p, sum);
        pel_vec3_scale(sum, stiffness, sum);
        for (int32_t i = 0; i < count; i++)
            pel_vec3_along(sum, planes[i].stiffness * depth_of(&planes[i], p), planes[i].normal, sum);
        /* N; forces are up to some hundreds, and energies that differ by rounding end the search */
        assert_near(pel_vec3_length(sum), 0, 1e-4);
    }
}

/* one plane: coupling and surface are springs in series */
static void test_springs_in_series(void **unused)
{
    (void)unused;
    const pel_haptic_plane plane = {.normal = {0, 0, 1}, .offset = 0.01, .stiffness = 300};
    const double x[3] = {0.5, -0.25, 0.006};
    double p[3];
    assert_true(pel_proxy_find(&plane, 1, 700, x, p));
    assert_near(700 * (p[2] - x[2]), 0.004 / (1 / 300.0 + 1 / 700.0), 1e-9);
    assert_true(p[0] == x[0] && p[1] == x[1]);
    assert_false(pel_proxy_find(&plane, 1, 700, (const double[3]){0, 0, 0.011}, p));
}

/* rigid planes: the nearest point outside, here on the edge of two of them (Zilles and Salisbury) */
static void test_god_object_on_an_edge(void **unused)
{
    (void)unused;
    const pel_haptic_plane planes[] = {{.normal = {0, 0, 1}, .offset = 0, .stiffness = 1e9},
                                       {.normal = {0.6, 0, 0.8}, .offset = 0, .stiffness = 1e9}};
    const double x[3] = {-0.02, 0.03, -0.03};
    double p[3];
    pel_proxy_find(planes, 2, 1000, x, p);
    assert_near(p[0], 0, 1e-6);
    assert_near(p[1], 0.03, 1e-9);
    assert_near(p[2], 0, 1e-6);
}

/* ---- energy ---- */

/* a hand that does anything: steps of random size, now and then to the other side */
static double walk(double stiffness, bool control, bool changes, uint64_t seed)
{
    pel_haptic_def def = make_def(stiffness, control);
    pel_proxy proxy;
    pel_proxy_create(&proxy, &def);
    random_state random = {seed};
    double x[3] = {0, 0, 0.02}, most = -HUGE_VAL;
    for (int update = 0; update < 5000; update++) {
        if (update == 0 || (changes && update % 10 == 0)) {
            pel_local_model model = {.plane_count = 3, .reach = 1, .stiffness = 100};
            for (int i = 0; i < model.plane_count; i++)
                do
                    model.planes[i] = random_plane(&random);
                while (update == 0 && depth_of(&model.planes[i], x) > 0);
            pel_proxy_set_model(&proxy, &model);
        }
        double way[3], size = pow(10, random_between(&random, -5, -2.5));
        random_point(&random, size, way);
        if (update > 0)
            pel_vec3_add(x, way, x);
        if (pel_vec3_length(x) > 0.02)
            pel_vec3_scale(x, 0.5, x);
        pel_proxy_update(&proxy, x);
        most = fmax(most, proxy.energy);
    }
    assert_true(most <= proxy.most_energy);
    return proxy.most_energy;
}

/* J, rounding of energies up to some J */
#define ROUNDING 1e-9

/* in and out of a rigid wall: the motion to which a held force gives most, and at the limit just what damping takes */
static double knock(double stiffness)
{
    pel_haptic_def def = make_def(stiffness, false);
    pel_proxy proxy;
    pel_proxy_create(&proxy, &def);
    pel_local_model wall = {.plane_count = 1, .planes = {{.normal = {0, 0, 1}, .stiffness = 1e12}}, .reach = 1};
    pel_proxy_set_model(&proxy, &wall);
    for (int update = 0; update < 100; update++)
        pel_proxy_update(&proxy, (const double[3]){0, 0, update % 2 == 0 ? 0 : -0.01});
    return proxy.most_energy;
}

static void test_static_planes_give_no_energy(void **unused)
{
    (void)unused;
    double limit = pel_haptic_passive_stiffness(0.5, 0, 1000);
    assert_near(limit, 1000, 1e-9);
    assert_true(knock(limit) <= ROUNDING && knock(0.5 * limit) <= ROUNDING);
    for (uint64_t seed = 1; seed <= 20; seed++) {
        assert_true(walk(limit, false, false, seed) <= ROUNDING);
        assert_true(walk(0.5 * limit, false, false, seed) <= ROUNDING);
    }
}

/* J, observed over one stroke into a rigid wall and out: the held force gives K m^2, the device's damping takes at each
   stroke what holding needs and half of what it has beyond that */
static void test_energy_of_a_stroke(void **unused)
{
    (void)unused;
    const double stroke = 0.01, limit = pel_haptic_passive_stiffness(0.5, 0, 1000);
    for (int half = 0; half < 2; half++) {
        pel_haptic_def def = make_def(half ? limit / 2 : limit, false);
        def.device_damping = 0.5;
        def.rate = 1000;
        pel_proxy proxy;
        pel_proxy_create(&proxy, &def);
        pel_local_model wall = {.plane_count = 1, .planes = {{.normal = {0, 0, 1}, .stiffness = 1e12}}, .reach = 1};
        pel_proxy_set_model(&proxy, &wall);
        for (int update = 0; update < 3; update++)
            pel_proxy_update(&proxy, (const double[3]){0, 0, update == 1 ? -stroke : 0});
        assert_near(proxy.energy, half ? -limit * stroke * stroke / 4 : 0, 1e-9);
    }
}

/* J that the second of two contacts supplies: the device was pushed in and out of a wall for long, which its damping
   paid for, and left; then, in a soft wall, it meets a stiff one that comes late */
static double supply_of_second_contact(int strokes)
{
    const double stroke = 0.01;
    pel_haptic_def def = make_def(0.5 * pel_haptic_passive_stiffness(0.5, 0, 1000), true);
    pel_proxy proxy;
    pel_proxy_create(&proxy, &def);
    pel_local_model soft = {.plane_count = 1, .planes = {{.normal = {0, 0, 1}, .stiffness = 1}}, .reach = 1},
                    hard = soft;
    hard.planes[0].stiffness = 1e6;
    pel_proxy_set_model(&proxy, &hard);
    for (int update = 0; update < 2 * strokes; update++)
        pel_proxy_update(&proxy, (const double[3]){0, 0, update % 2 == 0 ? 0.001 : -stroke});
    pel_proxy_set_model(&proxy, &soft);
    for (int update = 0; update < 300; update++)
        pel_proxy_update(&proxy, (const double[3]){0, 0, 0.001});
    /* work on the device less what its damping took; in slowly, out at once */
    double supply = 0, z = 0.001, force = 0, most = 0;
    for (int update = 0; update < 2200; update++) {
        double next = update < 1000 ? 0.001 - 1.1e-5 * update : update < 2000 ? z : fmin(z + 1e-4, 0.001);
        if (update == 1000)
            pel_proxy_set_model(&proxy, &hard);
        supply += force * (next - z) - proxy.taken * (next - z) * (next - z);
        z = next;
        pel_proxy_update(&proxy, (const double[3]){0, 0, z});
        force = proxy.force[2];
        most = fmax(most, supply);
    }
    return most;
}

/* what the damping took in one contact is no credit for the next one */
static void test_each_contact_is_bounded(void **unused)
{
    (void)unused;
    assert_true(supply_of_second_contact(0) <= ROUNDING);
    assert_true(supply_of_second_contact(1000) <= ROUNDING);
}

/* models that change at random put energy in; the control withdraws planes until they do not */
static void test_control_bounds_energy_of_changes(void **unused)
{
    (void)unused;
    double most = 0;
    for (uint64_t seed = 1; seed <= 20; seed++) {
        most = fmax(most, walk(1000, false, true, seed));
        assert_true(walk(1000, true, true, seed) <= ROUNDING);
    }
    assert_true(most > 1e-3);
}

/* J, of a mass that was pushed against a stiff wall for 3 s, after a start with 0.1 m/s */
static double bounce(double stiffness)
{
    pel_haptic_def def = make_def(stiffness, false);
    pel_proxy proxy;
    pel_proxy_create(&proxy, &def);
    pel_local_model wall = {.plane_count = 1, .planes = {{.normal = {0, 0, 1}, .stiffness = 1e7}}, .reach = 1};
    pel_proxy_set_model(&proxy, &wall);
    const double mass = 0.05, h = 1e-5, push = 1;
    double z = 1e-4, v = -0.1;
    for (int update = 0; update < 3000; update++) {
        pel_proxy_update(&proxy, (const double[3]){0, 0, z});
        for (int n = 0; n < 100; n++) {
            v += h * (proxy.force[2] - push - def.device_damping * v) / mass;
            z += h * v;
        }
    }
    return 0.5 * mass * v * v;
}

/* below the limit a mass comes to rest on a wall, not far above it never does */
static void test_limit_of_colgate_and_schenkel(void **unused)
{
    (void)unused;
    double limit = pel_haptic_passive_stiffness(0.5, 0, 1000);
    assert_true(bounce(0.5 * limit) < 1e-9);
    assert_true(bounce(2 * limit) > 1e-6);
}

/* ---- models ---- */

/* a new model is blended in without a jump, over the number of updates between two models */
static void test_models_are_blended(void **unused)
{
    (void)unused;
    pel_haptic_def def = make_def(1000, false);
    pel_proxy proxy;
    pel_proxy_create(&proxy, &def);
    pel_local_model soft = {.plane_count = 1, .planes = {{.normal = {0, 0, 1}, .stiffness = 100}}, .reach = 1},
                    hard = soft;
    hard.planes[0].stiffness = 900;
    const double x[3] = {0, 0, -0.01};
    pel_proxy_set_model(&proxy, &soft);
    for (int n = 0; n < 20; n++)
        pel_proxy_update(&proxy, x);
    double start = 0.01 / (1 / 100.0 + 1 / 1000.0), end = 0.01 / (1 / 900.0 + 1 / 1000.0), last = proxy.force[2];
    assert_near(last, start, 1e-9);
    pel_proxy_set_model(&proxy, &hard);
    for (int n = 0; n < 20; n++) {
        pel_proxy_update(&proxy, x);
        assert_true(proxy.force[2] > last && proxy.force[2] - last < 0.2 * (end - start));
        last = proxy.force[2];
    }
    assert_near(last, end, 1e-9);
}

/* the device has to come near the tool before planes count, and again after it was lost */
static void test_engages_near_the_tool(void **unused)
{
    (void)unused;
    pel_haptic_def def = make_def(1000, true);
    pel_proxy proxy;
    pel_proxy_create(&proxy, &def);
    pel_local_model wall = {.plane_count = 1, .planes = {{.normal = {0, 0, 1}, .stiffness = 100}}, .reach = 0.01};
    pel_proxy_set_model(&proxy, &wall);
    pel_proxy_update(&proxy, (const double[3]){0, 0, -0.1});
    assert_near(proxy.force[2], 0, 0);
    def.passivity_control = false;
    pel_proxy_create(&proxy, &def);
    pel_proxy_set_model(&proxy, &wall);
    pel_proxy_update(&proxy, (const double[3]){0, 0, 0.005});
    pel_proxy_update(&proxy, (const double[3]){0, 0, -0.1});
    assert_true(proxy.force[2] > 1);
    pel_proxy_lose(&proxy);
    assert_true(proxy.force[2] == 0 && proxy.lost_count == 1);
    pel_proxy_update(&proxy, (const double[3]){0, 0, -0.1});
    assert_near(proxy.force[2], 0, 0);
}

static void test_limits_of_the_force(void **unused)
{
    (void)unused;
    pel_haptic_def def = make_def(1000, false);
    def.max_force = 3;
    def.max_force_rate = 500;
    pel_proxy proxy;
    pel_proxy_create(&proxy, &def);
    pel_local_model wall = {.plane_count = 1, .planes = {{.normal = {0, 0, 1}, .stiffness = 1e6}}, .reach = 1};
    pel_proxy_set_model(&proxy, &wall);
    for (int n = 1; n <= 10; n++) {
        pel_proxy_update(&proxy, (const double[3]){0, 0, -0.01});
        assert_near(proxy.force[2], fmin(0.5 * n, 3), 1e-9);
    }
    assert_int_equal(proxy.limited_count, 10);
    pel_proxy_update(&proxy, (const double[3]){0, 0, 0.01});
    assert_near(proxy.force[2], 0, 0);
}

/* the damper of the coupling adds to the force while it presses deeper, and never pulls */
static void test_coupling_damping(void **unused)
{
    (void)unused;
    pel_haptic_def def = make_def(500, false);
    pel_proxy plain, damped;
    pel_proxy_create(&plain, &def);
    def.coupling_damping = 0.2;
    pel_proxy_create(&damped, &def);
    pel_local_model wall = {.plane_count = 1, .planes = {{.normal = {0, 0, 1}, .stiffness = 500}}, .reach = 1};
    pel_proxy_set_model(&plain, &wall);
    pel_proxy_set_model(&damped, &wall);
    double z = 0.001;
    for (int n = 0; n < 20; n++, z -= 1e-4) {
        pel_proxy_update(&plain, (const double[3]){0, 0, z});
        pel_proxy_update(&damped, (const double[3]){0, 0, z});
    }
    /* half of the speed of 0.1 m/s is that of the coupling, the other half that of the surface */
    assert_near(damped.force[2] - plain.force[2], 0.2 * 0.05, 1e-9);
    pel_proxy_update(&damped, (const double[3]){0, 0, -1e-6});
    assert_true(damped.force[2] >= 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_each_contact_is_bounded),
                                       cmocka_unit_test(test_energy_of_a_stroke),
                                       cmocka_unit_test(test_proxy_is_in_balance),
                                       cmocka_unit_test(test_springs_in_series),
                                       cmocka_unit_test(test_god_object_on_an_edge),
                                       cmocka_unit_test(test_static_planes_give_no_energy),
                                       cmocka_unit_test(test_control_bounds_energy_of_changes),
                                       cmocka_unit_test(test_limit_of_colgate_and_schenkel),
                                       cmocka_unit_test(test_models_are_blended),
                                       cmocka_unit_test(test_engages_near_the_tool),
                                       cmocka_unit_test(test_limits_of_the_force),
                                       cmocka_unit_test(test_coupling_damping)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
