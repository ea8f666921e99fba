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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_material),
        cmocka_unit_test(test_fast),
        cmocka_unit_test(test_unknown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
