/* The compliance of a layer, in closed form. */
#include "check.h"

#include "contact/layer.h"

/* E A / l over the mass, whatever the speed, as long as half the layer stops what comes on */
static void test_material(void **unused)
{
    (void)unused;
    const pel_contact_layer layer = {1e-3, 2e7};
    for (double mass = 1e-4; mass < 1; mass *= 10) {
        double compliance = pel_contact_layer_compliance(&layer, mass, 0, 0.01);
        assert_near(compliance * mass * 2e7, 1, 1e-12);
        /* 4 (v / h)^2 = hardness at v = 2.236 m/s */
        assert_near(pel_contact_layer_compliance(&layer, mass, 2.2, 0.01), compliance, 1e-12 * compliance);
        /* the length of a step says nothing of a material */
        assert_near(pel_contact_layer_compliance(&layer, mass, 0, 1e-4), compliance, 1e-12 * compliance);
    }
}

/* what comes on faster is stopped within half of the thickness: 1/2 m v^2 = 1/2 k (h / 2)^2 */
static void test_fast(void **unused)
{
    (void)unused;
    const pel_contact_layer layer = {1e-3, 2e7};
    for (double speed = 3; speed < 500; speed *= 3) {
        double stiffness = 1 / pel_contact_layer_compliance(&layer, 0.02, speed, 0.01);
        assert_near(0.5 * stiffness * 0.5e-3 * 0.5e-3, 0.5 * 0.02 * speed * speed, 1e-9 * speed * speed);
    }
}

/* without a modulus gravity presses it in by little: g dt^2 / 1000 */
static void test_unknown(void **unused)
{
    (void)unused;
    const pel_contact_layer layer = {1e-3, 0};
    for (double dt = 1e-3; dt < 0.1; dt *= 3)
        assert_near(0.5 * 9.81 * pel_contact_layer_compliance(&layer, 0.5, 0, dt), 9.81e-3 * dt * dt, 1e-12);
}

/* The depth under a load against its derivative by central differences, the load at that depth, and the energy against
   the work of the load by Simpson's rule; also beyond the depth where the law goes on straight. */
static void test_law(void **unused)
{
    (void)unused;
    const double compliance = 3e-6, thickness = 1e-3, unit = thickness / compliance;
    const double edge = PEL_LAYER_STRAIN / (1 - PEL_LAYER_STRAIN);
    for (double u = 1e-3; u < 100; u *= 1.7) {
        double load = u * unit, step = 1e-5 * load;
        const pel_layer_state at = pel_contact_layer_state(compliance, thickness, load);
        double over = pel_contact_layer_state(compliance, thickness, load + step).depth;
        double under = pel_contact_layer_state(compliance, thickness, load - step).depth;
        assert_near(at.slope, (over - under) / (2 * step), 1e-8 * compliance);
        assert_near(pel_contact_layer_load(compliance, thickness, at.depth), load, 1e-12 * load);
        if (u < edge)
            assert_near(at.depth, compliance * load / (1 + compliance * load / thickness), 1e-12 * thickness);
        enum { PARTS = 2000 };
        double sum = 0, width = at.depth / PARTS;
        for (int i = 0; i <= PARTS; i++)
            sum += (i == 0 || i == PARTS ? 1
                    : i % 2 == 1         ? 4
                                         : 2) *
                   pel_contact_layer_load(compliance, thickness, i * width);
        assert_near(pel_contact_layer_energy(compliance, thickness, load), sum * width / 3, 1e-6 * sum * width);
    }
    assert_near(pel_contact_layer_state(compliance, thickness, 0).slope, compliance, 0);
    assert_near(pel_contact_layer_state(0, thickness, 5).depth, 0, 0);
    assert_near(pel_contact_layer_load(compliance, thickness, -1e-4), 0, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_material),
        cmocka_unit_test(test_fast),
        cmocka_unit_test(test_unknown),
        cmocka_unit_test(test_law),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
