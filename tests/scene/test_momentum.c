/* Quasi-static steps with momentum: the same rest in fewer steps, a larger stable alpha, refusals. */
#include "scene_run.h"

#include "math/vec3.h"
#include "pellicle/live.h"

/* a sheet of springs between two pinned sides, under a force */
#define SHEET(solver, more)                                                                                            \
    "version: 1\n"                                                                                                     \
    "bodies:\n"                                                                                                        \
    "  - mesh: {shape: grid, nx: 24, ny: 24, size_x: 0.1, size_y: 0.1}\n"                                              \
    "    mass: {per_vertex: 1.0e-5}\n"                                                                                 \
    "    springs: {young: 1.0e6, thickness: 1.0e-3}\n"                                                                 \
    "    pinned: {box: {min: [-1, -1, -1], max: [-0.0499, 1, 1]}}\n" more                                              \
    "loads: [{name: pull, at: {box: {min: [0.0499, -1, -1], max: [1, 1, 1]}}, force: [0.5, 0, 0]}]\n"                  \
    "solver: {method: quasi-static, dt: 0.001" solver "}\n"                                                            \
    "duration: 10\n"

static void go(pel_sim *sim, int count)
{
    for (int i = 0; i < count; i++)
        assert_int_equal(pel_sim_step(sim, NULL), PEL_OK);
}

/* m, mean displacement along x */
static double pulled(pel_sim *sim)
{
    int32_t count = pel_sim_vertex_count(sim, 0);
    const pel_mesh *mesh = pel_model_mesh(pel_sim_model(sim), 0);
    double *x = calloc((size_t)count, 24), sum = 0;
    pel_sim_get_positions(sim, 0, x);
    for (int32_t v = 0; v < count; v++)
        sum += (x[3 * v] - mesh->positions[v][0]) / count;
    free(x);
    return sum;
}

/* from rest 400 steps with momentum come within 2 %, those without have a quarter */
static void test_rest(void **unused)
{
    (void)unused;
    run plain, heavy;
    check_begin(&plain, SHEET("", ""));
    check_begin(&heavy, SHEET(", momentum: 0.95", ""));
    /* the limit of a K from 2 to 2 (1 + m) */
    assert_near(pel_sim_alpha(heavy.sim) / pel_sim_alpha(plain.sim), 1.95, 1e-12);
    go(plain.sim, 400);
    double slow = pulled(plain.sim);
    go(plain.sim, 20000);
    double rest = pulled(plain.sim);
    assert_true(rest > 1e-4 && slow < 0.4 * rest);
    go(heavy.sim, 400);
    assert_near(pulled(heavy.sim) / rest, 1, 0.02);
    end(&plain);
    end(&heavy);
}

/* a snapshot knows the last displacement */
static void test_snapshot(void **unused)
{
    (void)unused;
    run r;
    check_begin(&r, SHEET(", momentum: 0.9", ""));
    go(r.sim, 50);
    size_t size = pel_sim_save_size(r.sim);
    void *bytes = malloc(size);
    pel_sim_save(r.sim, bytes);
    go(r.sim, 50);
    uint64_t hash = pel_sim_hash(r.sim);
    assert_int_equal(pel_sim_load(r.sim, bytes, size, NULL), PEL_OK);
    go(r.sim, 50);
    assert_true(pel_sim_hash(r.sim) == hash);
    free(bytes);
    end(&r);
}

static void test_refusals(void **unused)
{
    (void)unused;
    static const refusal cases[] = {
        {SHEET(", momentum: 1", ""), "momentum"},
        {SHEET(", momentum: -0.1", ""), "momentum"},
        {SHEET(", momentum: 0.9", "    refine: {levels: 1, above: 1e3}\n"), "momentum in bodies that refine"},
    };
    check_refusals(cases, sizeof cases / sizeof *cases);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_rest),
        cmocka_unit_test(test_snapshot),
        cmocka_unit_test(test_refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
