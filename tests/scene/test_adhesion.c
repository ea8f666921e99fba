/* Adhesion: which vertices leave their springs, what the ledger books, snapshots. */
#include "scene_run.h"

#include "pellicle/live.h"
#include "pellicle/tear.h"

/* a sheet of 1 m2 on a filling of 1e4 N/m3; a tool carries all of its vertices at 0.1 m/s */
#define SHEET                                                                                                          \
    "version: 1\n"                                                                                                     \
    "bodies:\n"                                                                                                        \
    "  - mesh: {shape: grid, nx: 4, ny: 4}\n"                                                                          \
    "    springs: {young: 1e5, thickness: 1e-3}\n"                                                                     \
    "    volumetric: {young: 1e4, depth: 1, drag: 0, adhesion: 500}\n"
#define TOOL(motion)                                                                                                   \
    "tools:\n"                                                                                                         \
    "  - {name: hand, shape: box, size: [2, 2, 1], press: false, max_force: 1e9, grasp: {reach: 0.1}, motion: " motion \
    "}\n"                                                                                                              \
    "duration: 1\n"
#define UP "[{position: [0, 0, 0]}, {time: 1, position: [0, 0, 0.1]}]"
#define ALONG "[{position: [0, 0, 0]}, {time: 1, position: [0.1, 0, 0]}]"
#define DOWN "[{position: [0, 0, 0]}, {time: 1, position: [0, 0, -0.1]}]"

static int32_t released(const pel_sim *sim)
{
    pel_cut_reading reading;
    assert_int_equal(pel_sim_get_cuts(sim, -1, &reading, NULL), PEL_OK);
    return reading.released_count;
}

static void go(pel_sim *sim, int count)
{
    for (int i = 0; i < count; i++)
        assert_int_equal(pel_sim_step(sim, NULL), PEL_OK);
}

/* all vertices leave beyond 500 Pa / 1e4 N/m3 = 0.05 m, lifted or drawn along, and never when they are pressed in */
static void test_strength(void **unused)
{
    (void)unused;
    static const char *const methods[] = {"quasi-static", "explicit", "xpbd", "implicit", "static"};
    static const char *const motions[] = {TOOL(UP), TOOL(ALONG), TOOL(DOWN)};
    for (size_t m = 0; m < sizeof methods / sizeof *methods; m++)
        for (int i = 0; i < 3; i++) {
            char text[2000];
            run r;
            snprintf(text, sizeof text, SHEET "solver: {method: %s, dt: 0.01}\n%s", methods[m], motions[i]);
            check_begin(&r, text);
            go(r.sim, 49);
            assert_int_equal(released(r.sim), 0);
            go(r.sim, 4);
            assert_int_equal(released(r.sim), i < 2 ? 25 : 0);
            end(&r);
        }
}

/* The springs of 1 m2 took k d^2 / 2; that is booked, and what the tool did is balanced. */
static void test_energy(void **unused)
{
    (void)unused;
    run r;
    check_begin(&r, SHEET "solver: {method: static, dt: 0.01}\n" TOOL(UP));
    go(r.sim, 60);
    pel_sim_ledger ledger;
    pel_sim_get_ledger(r.sim, &ledger);
    double expected = 0.5 * 1e4 * 0.05 * 0.05;
    /* they leave in the first step beyond it */
    assert_true(ledger.dissipated_fracture >= expected && ledger.dissipated_fracture < 1.05 * expected);
    assert_near(ledger.elastic, 0, 1e-9);
    assert_near(ledger.work_tools, ledger.dissipated_fracture, 0.03 * expected);
    end(&r);
}

/* a snapshot says who is released: loaded before and after the release, steps have the same bits */
static void test_snapshots(void **unused)
{
    (void)unused;
    run r;
    check_begin(&r, SHEET "solver: {method: quasi-static, dt: 0.01}\n" TOOL(UP));
    void *bytes[2];
    size_t sizes[2];
    uint64_t hash[2];
    for (int i = 0; i < 2; i++) {
        go(r.sim, i == 0 ? 45 : 10);
        sizes[i] = pel_sim_save_size(r.sim);
        bytes[i] = malloc(sizes[i]);
        pel_sim_save(r.sim, bytes[i]);
        hash[i] = pel_sim_hash(r.sim);
    }
    assert_int_equal(released(r.sim), 25);
    assert_true(sizes[1] > sizes[0]);
    for (int i = 0; i < 2; i++) {
        assert_int_equal(pel_sim_load(r.sim, bytes[i], sizes[i], NULL), PEL_OK);
        assert_int_equal(released(r.sim), i == 0 ? 0 : 25);
        assert_true(pel_sim_hash(r.sim) == hash[i]);
        if (i == 0)
            go(r.sim, 10);
        assert_true(pel_sim_hash(r.sim) == hash[1]);
        free(bytes[i]);
    }
    end(&r);
}

static void test_refusals(void **unused)
{
    (void)unused;
    static const refusal cases[] = {
        {"version: 1\nbodies: [{mesh: {shape: grid}, volumetric: {young: 0, adhesion: 1}}]\nduration: 1\n", "adhesion"},
        {"version: 1\nbodies: [{mesh: {shape: grid}, volumetric: {adhesion: 0}}]\nduration: 1\n", "adhesion"},
        {"version: 1\nbodies: [{mesh: {shape: grid}, volumetric: {adhesion: 1}, refine: {levels: 1, everywhere: "
         "true}}]\nduration: 1\n",
         "adhesion"},
    };
    check_refusals(cases, sizeof cases / sizeof *cases);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_strength),
        cmocka_unit_test(test_energy),
        cmocka_unit_test(test_snapshots),
        cmocka_unit_test(test_refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
