/* Surfaces that start nearer than their thickness, under methods whose contact is corrected after the step; bodies that
   start inside of another one. */
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

#define FLESH                                                                                                          \
    "version: 1\nduration: 1\nbodies:\n  - {name: flesh, mesh: {shape: geodesic-sphere, frequency: 4, radius: 0.05}, "
#define BONE                                                                                                           \
    "  - {name: bone, mesh: {shape: box, size_x: 0.02, size_y: 0.02, size_z: 0.02, nx: 2, ny: 2, nz: 2}, rigid: {}}\n"
#define SOLID "volume: {young: 1e4, edge: 0.015}}\n"

/* tetrahedra have contact at their surface only: what starts inside of them would fall through, unless it is tied */
static void test_buried(void **unused)
{
    (void)unused;
    static const refusal bad[] = {
        {FLESH SOLID BONE, "body 'bone' starts inside body 'flesh', whose tetrahedra do not feel it"},
        {FLESH SOLID BONE "contact: {self: true}\n", "body 'bone' starts inside body 'flesh'"},
    };
    static const char *const good[] = {
        FLESH SOLID BONE "contact: none\n",
        FLESH SOLID BONE "contact: {start: tangled}\n",
        FLESH SOLID BONE
        "attachments: [{body: flesh, at: {sphere: {center: [0, 0, 0], radius: 0.02}}, to: {body: bone}}]\n",
        FLESH "membrane: {young: 1e5, thickness: 1e-3}}\n" BONE,
    };
    check_refusals(bad, sizeof bad / sizeof *bad);
    for (size_t i = 0; i < sizeof good / sizeof *good; i++) {
        run r;
        check_begin(&r, good[i]);
        end(&r);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_apart), cmocka_unit_test(test_buried)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
