/* The weight of bending that is chosen while a body shrinks: it shrinks further than with the paper's, with less
   jitter, and the same bits again. */
#include "pellicle/shape.h"
#include "pellicle/sim_ledger.h"
#include "shell_fixture.h"
#include "stage/stage.h"

typedef struct shrinking {
    pel_mesh *mesh;
    pel_model *model;
    pel_sim *sim;
} shrinking;

static shrinking start(double weight)
{
    shrinking made = {.mesh = make_sphere(8)};
    pel_body_def body = shell_body(made.mesh, PEL_MEMBRANE_STVK);
    body.shell.bending.model = PEL_BENDING_ISOMETRIC;
    body.shell.bending.weight = weight;
    body.shell.pressure.kind = PEL_PRESSURE_GIVEN;
    body.shell.pressure.outside.value = 24;
    made.model = make_model(&body);
    pel_sim_def def = pel_sim_def_default();
    def.model = made.model;
    def.solver.method = PEL_METHOD_PBD;
    def.solver.dt = 1.0 / 60;
    def.thread_count = 1;
    made.sim = make_sim(&def);
    return made;
}

static void end(shrinking *made)
{
    pel_sim_destroy(made->sim);
    pel_model_destroy(made->model);
    pel_mesh_destroy(made->mesh);
}

/* rises of the volume over the steps */
static int shrink(pel_sim *sim, int steps)
{
    int rises = 0;
    double before = pel_sim_volume_ratio(sim);
    for (int i = 0; i < steps; i++) {
        run_steps(sim, 1);
        double ratio = pel_sim_volume_ratio(sim);
        rises += ratio > before + 1e-7;
        before = ratio;
    }
    return rises;
}

static void test_less_jitter(void **unused)
{
    (void)unused;
    static const double weights[] = {1, 0.01, -1};
    int rises[3];
    double ratios[3];
    for (int i = 0; i < 3; i++) {
        shrinking body = start(weights[i]);
        rises[i] = shrink(body.sim, 100);
        ratios[i] = pel_sim_volume_ratio(body.sim);
        end(&body);
    }
    assert_true(rises[0] > 35 && rises[1] > 15);
    assert_true(rises[2] < 12 && 2 * rises[2] < rises[1]);
    assert_true(ratios[0] > 0.95 && ratios[2] < 0.75 * ratios[1]);
}

/* the weight falls by half when the volume turns round and slowly else, not below the least */
static void test_falls(void **unused)
{
    (void)unused;
    shrinking body = start(-1);
    const double *weight = &body.sim->state->bending[0].weight;
    double before = pel_sim_volume_ratio(body.sim), change = 0, expected = *weight;
    int turns = 0;
    assert_true(expected == 0.01);
    for (int step = 0; step < 100; step++) {
        shrink(body.sim, 1);
        double last = change;
        change = pel_sim_volume_ratio(body.sim) - before;
        before += change;
        bool turned = change * last < 0;
        expected = fmax(expected * (turned ? 0.5 : 0.99), 1e-3);
        turns += turned;
        assert_near(*weight, expected, 1e-9);
    }
    assert_true(turns > 0 && expected == 1e-3);
    end(&body);
}

/* the volume of an open sheet says nothing */
static void test_open_body(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_grid(6, 6, 1, 1, PEL_GRID_UNION_JACK);
    pel_body_def body = shell_body(mesh, PEL_MEMBRANE_STVK);
    body.shell.bending.model = PEL_BENDING_ISOMETRIC;
    body.shell.bending.weight = -1;
    body.shell.pressure.kind = PEL_PRESSURE_GIVEN;
    body.shell.pressure.outside.value = 24;
    pel_model *model = make_model(&body);
    pel_sim_def def = pel_sim_def_default();
    def.model = model;
    def.solver.method = PEL_METHOD_PBD;
    pel_sim *sim = make_sim(&def);
    run_steps(sim, 30);
    assert_true(sim->state->bending[0].weight == 0.01);
    pel_sim_destroy(sim);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

static void test_snapshot(void **unused)
{
    (void)unused;
    shrinking one = start(-1), other = start(-1);
    shrink(one.sim, 40);
    size_t size = pel_sim_save_size(one.sim);
    void *bytes = malloc(size);
    pel_sim_save(one.sim, bytes);
    assert_int_equal(pel_sim_load(other.sim, bytes, size, NULL), PEL_OK);
    shrink(one.sim, 30);
    shrink(other.sim, 30);
    assert_true(pel_sim_hash(one.sim) == pel_sim_hash(other.sim));
    free(bytes);
    end(&one);
    end(&other);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_less_jitter),
        cmocka_unit_test(test_falls),
        cmocka_unit_test(test_open_body),
        cmocka_unit_test(test_snapshot),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
