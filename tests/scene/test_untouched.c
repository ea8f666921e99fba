/* Contact and tools that nothing meets leave a vibration as it is. */
#include "scene_run.h"

#define RULER                                                                                                          \
    "version: 1\ngravity: [0, 0, -9.81]\nduration: 2\nsolver: { method: implicit, dt: 0.005 }\nbodies:\n"              \
    "  - { name: ruler, mesh: { shape: grid, nx: 20, ny: 2, size_x: 0.3, size_y: 0.03 }, membrane: { young: 2e11, "    \
    "thickness: 0.001 }, bending: {}, mass: { density: 7800 }, pinned: { box: { min: [-1, -1, -1], max: [-0.134, "     \
    "1, 1] } } }\n"

/* J, largest elastic energy in the last second */
static double vibrate(const char *text)
{
    run r;
    double most = 0;
    check_begin(&r, text);
    for (int s = 0; s < 400; s++) {
        pel_sim_measures measures;
        assert_int_equal(pel_sim_step(r.sim, NULL), PEL_OK);
        pel_sim_measure(r.sim, &measures);
        most = s >= 200 && measures.elastic_energy > most ? measures.elastic_energy : most;
    }
    end(&r);
    return most;
}

/* 20 steps in a period; steps of BDF2 leave 0.71 of the energy */
static void test_vibration(void **unused)
{
    (void)unused;
    const char *const beside[] = {RULER "contact: {}\n", RULER "contact: { self: true }\n",
                                  RULER "tools: [ { name: floor, shape: box, size: [1, 1, 0.1], motion: [ { position: "
                                        "[0, 0, -0.2] } ] } ]\n"};
    const double alone = vibrate(RULER);
    assert_true(alone > 1e-4);
    for (size_t i = 0; i < sizeof beside / sizeof *beside; i++)
        assert_near(vibrate(beside[i]) / alone, 1, 0.06);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_vibration)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
