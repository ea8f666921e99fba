/* The shipped scenes of surfaces that are cut, torn and burst: lengths, gapes and energies. */
#include "scene/scene_run.h"

#include "pellicle/observe.h"
#include "pellicle/tear.h"
#include "source_dir.h"

#include <math.h>
#include <stdlib.h>

static run open_scene(const char *name)
{
    run r = {0};
    char path[1000], message[1000];
    pel_error error;
    snprintf(path, sizeof path, PEL_SOURCE_DIR "/scenes/%s.yaml", name);
    if (pel_scene_load(path, NULL, 0, NULL, &r.scene, &error) != PEL_OK)
        fail_msg("%s", pel_error_text(&error, message, sizeof message));
    assert_int_equal(pel_model_create(&r.scene->model, &r.model, NULL), PEL_OK);
    r.scene->sim.model = r.model;
    assert_int_equal(pel_sim_create(&r.scene->sim, &r.sim, NULL), PEL_OK);
    return r;
}

static void step_until(run *r, double time)
{
    pel_error error;
    while (pel_sim_time(r->sim) < time - 1e-9)
        if (pel_sim_step(r->sim, &error) != PEL_OK)
            fail_msg("%s: %s", error.what, error.remedy);
}

static pel_cut_reading cuts_of(const run *r)
{
    pel_cut_reading reading;
    assert_int_equal(pel_sim_get_cuts(r->sim, 0, &reading, NULL), PEL_OK);
    return reading;
}

static pel_sim_ledger ledger_of(const run *r)
{
    pel_sim_ledger ledger;
    pel_sim_get_ledger(r->sim, &ledger);
    return ledger;
}

/* the gape is 2 length stress / E, and the slit releases pi length^2 stress^2 thickness / (4 E), but for the edges at
   both ends; the stress is that of the force of 2.255 N before */
static void test_skin(void **unused)
{
    (void)unused;
    run r = open_scene("skin-incision");
    step_until(&r, 1);
    pel_sim_ledger before = ledger_of(&r), after;
    step_until(&r, 1.25);
    after = ledger_of(&r);
    int32_t count = pel_sim_vertex_count(r.sim, 0);
    double(*x)[3] = calloc((size_t)count, sizeof *x), left = -1, right = 1;
    pel_sim_get_positions(r.sim, 0, x[0]);
    for (int32_t v = 0; v < count; v++) {
        if (fabs(x[v][1]) > 3e-4)
            continue;
        left = x[v][0] < 0 ? fmax(left, x[v][0]) : left;
        right = x[v][0] > 0 ? fmin(right, x[v][0]) : right;
        assert_near(x[v][2], 0, 1e-3);
    }
    free(x);
    assert_near(right - left, 5.83e-3, 0.05 * 5.83e-3);
    assert_near(cuts_of(&r).length, 0.03, 1e-9);
    double released = before.elastic - after.elastic + after.work_tools - before.work_tools;
    assert_near(released, 1.29e-3, 0.06 * 1.29e-3);
    end(&r);
}

/* a blade without sharpness opens its way over the surface without a force */
static void test_liver(void **unused)
{
    (void)unused;
    run r = open_scene("liver-cut");
    step_until(&r, 1.6);
    pel_tool_reading tool;
    pel_sim_get_tool(r.sim, 0, &tool);
    assert_near(cuts_of(&r).length, 0.084, 0.006);
    assert_true(fabs(tool.force[0]) + fabs(tool.force[1]) + fabs(tool.force[2]) == 0);
    assert_int_equal(cuts_of(&r).island_count, 0);
    end(&r);
}

/* the slit of 12 mm takes toughness times thickness for each new metre */
static void test_balloon(void **unused)
{
    (void)unused;
    run r = open_scene("balloon-burst");
    step_until(&r, 0.06);
    assert_near(cuts_of(&r).length, 0, 0);
    step_until(&r, 0.068);
    pel_sim_ledger ledger = ledger_of(&r);
    double length = cuts_of(&r).length, energy = 2000 * 0.25e-3 * (length - 0.012);
    assert_true(length > 0.15);
    assert_near(ledger.dissipated_fracture, energy, 0.02 * energy);
    end(&r);
}

#define PEEL(solver)                                                                                                   \
    "version: 1\nduration: 1\nbodies:\n  - name: sheet\n"                                                              \
    "    mesh: { shape: grid, nx: 20, ny: 8, size_x: 0.1, size_y: 0.04 }\n"                                            \
    "    membrane: { young: 1e6, thickness: 1e-3, poisson: 0.3 }\n    bending: { model: none }\n"                      \
    "    pinned: { box: { min: [0.0499, -1, -1], max: [1, 1, 1] } }\n    supports:\n"                                  \
    "      - { at: { box: { min: [-1, 0.0199, -1], max: [-0.0499, 1, 1] } }, displacement: [0, 0.01, 0],\n"            \
    "          keys: [[0, 0], [1, 1]] }\n"                                                                             \
    "      - { at: { box: { min: [-1, -1, -1], max: [-0.0499, -0.0199, 1] } }, displacement: [0, -0.01, 0],\n"         \
    "          keys: [[0, 0], [1, 1]] }\n"                                                                             \
    "      - { at: { box: { min: [-0.0498, -1, -1], max: [0.0498, 1, 1] } }, fix: [z] }\n"                             \
    "seams:\n  - { path: [[-0.05, 0, 0], [0.04, 0, 0]], strength: 60 }\nsolver: " solver "\n"

/* a sheet drawn apart along a seam: what the supports do is stored, or taken by the edges that open */
static void test_peel(void **unused)
{
    (void)unused;
    static const struct {
        const char *text;
        double share; /* of the work, that is lost otherwise */
    } cases[] = {
        {PEEL("{ method: static, dt: 0.02 }"), 0.002},
        {PEEL("{ method: implicit, dt: 0.01, drag: 10 }"), 0.02},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        run r;
        check_begin(&r, cases[i].text);
        step_until(&r, 1);
        pel_sim_ledger ledger = ledger_of(&r);
        assert_near(cuts_of(&r).length, 0.045, 0.0001);
        assert_true(ledger.dissipated_fracture > 0.6 * ledger.work_tools);
        assert_true(ledger.dissipated_solver + ledger.energy_error < cases[i].share * ledger.work_tools);
        end(&r);
    }
}

/* the perforation opens from the side of the hand; what it takes is booked, and waves take the rest */
static void test_paper(void **unused)
{
    (void)unused;
    run r = open_scene("torn-paper");
    step_until(&r, 0.05);
    assert_near(cuts_of(&r).length, 0, 0);
    step_until(&r, 0.1);
    double length = cuts_of(&r).length;
    assert_true(length > 0.1 && length < 0.2);
    pel_sim_ledger ledger = ledger_of(&r);
    assert_true(ledger.dissipated_fracture > 0.4 * ledger.work_tools);
    assert_true(ledger.dissipated_solver < 0.1 * ledger.work_tools && ledger.energy_error == 0);
    end(&r);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_skin), cmocka_unit_test(test_liver), cmocka_unit_test(test_balloon),
        cmocka_unit_test(test_peel), cmocka_unit_test(test_paper),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
