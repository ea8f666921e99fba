/* Surfaces that start nearer than their thickness, under methods whose contact is corrected after the step. */
#include "scene_run.h"

#define THICKNESS 1e-3
#define START 3e-4

static const char scene[] =
    "version: 1\n"
    "bodies:\n"
    "  - {name: low, mesh: {shape: grid, nx: 4, ny: 4, size_x: 0.1, size_y: 0.1},\n"
    "     springs: {young: 1e5, thickness: 1e-3}, mass: {per_vertex: 1e-3}}\n"
    "  - {name: high, mesh: {shape: grid, nx: 5, ny: 3, size_x: 0.07, size_y: 0.07, translate: [0.003, 0.002, 3e-4]},\n"
    "     springs: {young: 1e5, thickness: 1e-3}, mass: {per_vertex: 1e-3}}\n"
    "contact: {self: true, thickness: 1e-3}\n"
    "gravity: [0, 0, 0]\n"
    "solver: {method: %s, dt: 0.01}\n"
    "duration: 1\n";

static double mean_height(const pel_sim *sim, int32_t body)
{
    double positions[3 * 64], sum = 0;
    int32_t count = pel_sim_vertex_count(sim, body);
    assert_in_range(count, 1, 64);
    pel_sim_get_positions(sim, body, positions);
    for (int32_t v = 0; v < count; v++)
        sum += positions[3 * v + 2] / count;
    return sum;
}

/* they come apart by a tenth of what they lack in each step, from both sides, without a jump */
static void test_apart(void **unused)
{
    (void)unused;
    run r;
    char text[2000];
    snprintf(text, sizeof text, scene, "quasi-static");
    check_begin(&r, text);
    double last = START;
    for (int i = 0; i < 60; i++) {
        assert_int_equal(pel_sim_step(r.sim, NULL), PEL_OK);
        double gap = mean_height(r.sim, 1) - mean_height(r.sim, 0);
        assert_true(gap >= last - 1e-9 && gap - last <= 0.2 * (THICKNESS - START));
        last = gap;
    }
    /* vertices of the larger one that nothing covers stay */
    assert_true(last > 0.8 * THICKNESS && last < THICKNESS);
    assert_true(mean_height(r.sim, 0) < -1e-5 && mean_height(r.sim, 1) > START + 1e-5);
    end(&r);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_apart)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
