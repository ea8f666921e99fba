/* Fields by name: all of the table, kept for one state and no longer, on triangles where they are of mechanics. */
#include "failing_malloc.h"
#include "pellicle/observe.h"
#include "pellicle/sim_surface.h"
#include "sim/fixture.h"
#include "stage/stage.h"

static stage make_stage(void)
{
    stage s;
    s.mesh = make_sphere(4);
    pel_body_def body = ball_body(s.mesh);
    body.shell.membrane.on = true;
    body.shell.membrane.young.value = 1000;
    body.shell.membrane.thickness.value = 0.01;
    body.shell.bending.model = PEL_BENDING_HINGE;
    body.shell.pressure.kind = PEL_PRESSURE_GIVEN;
    body.shell.pressure.outside.value = 100;
    s.model = make_model(&body);
    pel_sim_def def = lone_sim(s.model, PEL_METHOD_XPBD, 1e-3);
    s.sim = make_sim(&def);
    return s;
}

static double sum_of(pel_sim *sim, const char *name)
{
    int32_t field = pel_field_find(name);
    static double values[6 * 400];
    assert_true(6 * pel_sim_vertex_count(sim, 0) <= 6 * 400);
    assert_int_equal(pel_observe(sim, field, 0, values, NULL), PEL_OK);
    double sum = 0;
    for (int32_t i = 0; i < pel_sim_vertex_count(sim, 0) * pel_field_at(field)->component_count; i++)
        sum += fabs(values[i]);
    return sum;
}

static void test_table(void **unused)
{
    (void)unused;
    assert_true(pel_field_count() >= 30);
    assert_null(pel_field_at(-1));
    assert_null(pel_field_at(pel_field_count()));
    assert_int_equal(pel_field_find("mood"), -1);
    for (int32_t f = 0; f < pel_field_count(); f++)
        assert_int_equal(pel_field_find(pel_field_at(f)->name), f);
    assert_string_equal(pel_field_at(pel_field_find("pressure"))->unit, "N");
    assert_string_equal(pel_field_at(pel_field_find("stress"))->unit, "N/m");
}

/* setters, steps and snapshots make another state of it */
static void test_follows_the_state(void **unused)
{
    (void)unused;
    stage s = make_stage();
    double *positions = malloc(3 * (size_t)s.mesh->vertex_count * sizeof *positions);
    size_t size = pel_sim_save_size(s.sim);
    void *bytes = malloc(size);
    pel_sim_save(s.sim, bytes);
    double area = sum_of(s.sim, "area"), curvature = sum_of(s.sim, "mean_curvature");
    assert_true(sum_of(s.sim, "von_mises_top") < IN_FLOAT(1e-3, 10));
    /* the sum of the sizes of components: 3 2 pi on a sphere */
    assert_near(sum_of(s.sim, "pressure"), 600 * 3.14159265, 100);
    pel_sim_get_positions(s.sim, 0, positions);
    for (int32_t i = 0; i < 3 * s.mesh->vertex_count; i++)
        positions[i] *= 2;
    assert_int_equal(pel_sim_set_positions(s.sim, 0, positions, NULL), PEL_OK);
    assert_near(sum_of(s.sim, "area"), 4 * area, 1e-9 + IN_FLOAT(0, 1e-4));
    assert_near(sum_of(s.sim, "mean_curvature"), 0.5 * curvature, IN_FLOAT(1e-9, 1e-3));
    assert_true(sum_of(s.sim, "von_mises_top") > 1000);
    assert_true(sum_of(s.sim, "energy") > 0 && sum_of(s.sim, "stress") > 0);
    assert_int_equal(pel_sim_load(s.sim, bytes, size, NULL), PEL_OK);
    assert_near(sum_of(s.sim, "area"), area, 1e-12);
    run_steps(s.sim, 20);
    assert_true(sum_of(s.sim, "area") < area);
    assert_true(sum_of(s.sim, "displacement") > 0);
    free(bytes);
    free(positions);
    end_stage(&s);
}

/* vertices around a refined vertex have its level, the rest of the ball level 0 */
static void test_level(void **unused)
{
    (void)unused;
    stage s = {.mesh = make_sphere(4)};
    const int32_t region[] = {0};
    pel_body_def body = ball_body(s.mesh);
    body.refine.levels = 2;
    body.refine.region = region;
    body.refine.region_count = 1;
    s.model = make_model(&body);
    pel_sim_def def = lone_sim(s.model, PEL_METHOD_QUASI_STATIC, 1e-2);
    s.sim = make_sim(&def);
    int32_t count = pel_sim_vertex_count(s.sim, 0), far = 0;
    double *values = malloc((size_t)count * sizeof *values);
    int32_t *levels = malloc((size_t)count * sizeof *levels);
    assert_int_equal(pel_observe(s.sim, pel_field_find("level"), 0, values, NULL), PEL_OK);
    pel_sim_get_levels(s.sim, 0, levels);
    assert_true(values[0] == 2 && levels[0] == 0);
    for (int32_t v = 0; v < count; v++) {
        assert_true(values[v] >= levels[v] && values[v] <= 2);
        far += values[v] == 0;
    }
    assert_true(far > s.mesh->vertex_count / 2);
    free(levels);
    free(values);
    end_stage(&s);
}

static void test_refusals(void **unused)
{
    (void)unused;
    stage s = make_stage();
    double value[1];
    assert_int_equal(pel_observe(s.sim, -1, 0, value, NULL), PEL_BAD_ARGUMENT);
    assert_int_equal(pel_observe(s.sim, pel_field_count(), 0, value, NULL), PEL_BAD_ARGUMENT);
    assert_int_equal(pel_observe(s.sim, 0, 1, value, NULL), PEL_BAD_ARGUMENT);
    assert_int_equal(pel_observe_triangles(s.sim, pel_field_find("force"), 0, value, NULL), PEL_BAD_ARGUMENT);
    end_stage(&s);
}

static pel_status observe_all(const void *data, pel_error *error)
{
    (void)data;
    static double values[6 * 2000];
    pel_sim *sim;
    pel_sim_def def = lone_sim(data, PEL_METHOD_XPBD, 1e-3);
    pel_status status = pel_sim_create(&def, &sim, error);
    for (int32_t f = 0; status == PEL_OK && f < pel_field_count(); f++) {
        status = pel_observe(sim, f, 0, values, error);
        if (status == PEL_OK && pel_field_at(f)->place == PEL_FIELD_ON_BOTH)
            status = pel_observe_triangles(sim, f, 0, values, error);
    }
    pel_sim_destroy(sim);
    return status;
}

static void test_out_of_memory(void **unused)
{
    (void)unused;
    stage s = make_stage();
    assert_true(for_every_allocation_failure(observe_all, s.model) > 10);
    end_stage(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_table),    cmocka_unit_test(test_follows_the_state), cmocka_unit_test(test_level),
        cmocka_unit_test(test_refusals), cmocka_unit_test(test_out_of_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
