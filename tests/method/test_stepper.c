/* The rows of the methods: words, traits that go together, and the live parameters that follow from them. */
#include "sim/fixture.h"

#include "def/row.h"
#include "pellicle/live.h"
#include "stage/stepper.h"

static void test_words(void **unused)
{
    (void)unused;
    static const char *const words[] = {"quasi-static", "explicit", "pbd",    "pbd-distance",
                                        "xpbd",         "descent",  "static", "implicit"};
    const int count = (int)(sizeof words / sizeof *words);
    assert_true(count <= PEL_METHOD_COUNT);
    for (int i = 0; i < PEL_METHOD_COUNT; i++) {
        if (i < count)
            assert_string_equal(pel_method_words[i], words[i]);
        assert_ptr_equal(pel_stepper_find(pel_method_words[i]), pel_stepper_of((pel_method)i));
    }
    assert_null(pel_method_words[PEL_METHOD_COUNT]);
    assert_null(pel_stepper_find("newton"));
}

static void test_traits_go_together(void **unused)
{
    (void)unused;
    for (int i = 0; i < PEL_METHOD_COUNT; i++) {
        const pel_stepper *s = pel_stepper_of((pel_method)i);
        assert_true(s->create != NULL && s->step != NULL && s->advise != NULL);
        assert_true(s->has_substeps || !(s->is_compliant || s->weighs || s->limits_strain || s->has_lengths));
        assert_true(s->minimises || !(s->descends || s->is_static || s->has_budget || s->turns_edges));
        assert_true(s->seeks_rest || !(s->descends || s->is_static));
        assert_false(s->has_velocity && (s->relaxes || s->seeks_rest));
        assert_true(pel_stepper_knows_material(s) || s->energy_remedy != NULL);
    }
}

static bool is_live(pel_sim *sim, const char *path)
{
    pel_parameter_info info;
    return pel_parameter_find(sim, path, &info, NULL) == PEL_OK;
}

static void test_live_parameters(void **unused)
{
    (void)unused;
    int readers[4] = {0};
    pel_mesh *mesh = make_sphere(2);
    pel_body_def body = ball_body(mesh);
    pel_model *model = make_model(&body);
    for (int i = 0; i < PEL_METHOD_COUNT; i++) {
        const pel_stepper *s = pel_stepper_of((pel_method)i);
        pel_sim_def def = pel_sim_def_default();
        def.model = model;
        def.solver.method = (pel_method)i;
        def.solver.dt = 1e-3;
        pel_sim *sim = make_sim(&def);
        assert_int_equal(is_live(sim, "solver.alpha"), s->relaxes);
        assert_int_equal(is_live(sim, "solver.substeps"), s->has_substeps);
        assert_int_equal(is_live(sim, "solver.max_substeps"), s->is_compliant);
        assert_int_equal(is_live(sim, "solver.descent"), s->descends);
        readers[0] += s->relaxes;
        readers[1] += s->has_substeps;
        readers[2] += s->is_compliant;
        readers[3] += s->descends;
        assert_int_equal(is_live(sim, "solver.drag"), s->has_substeps || s->is_explicit);
        pel_sim_destroy(sim);
        /* a budget and an analysis are refused by the other methods */
        def.solver.budget = 0.01;
        assert_int_equal(pel_sim_create(&def, &sim, NULL) == PEL_OK, s->has_budget);
        pel_sim_destroy(sim);
        def.solver.budget = 0;
        def.solver.analysis = PEL_ANALYSIS_MODAL;
        def.solver.mode_count = 7;
        assert_int_equal(pel_sim_create(&def, &sim, NULL) == PEL_OK, s->is_static);
        pel_sim_destroy(sim);
    }
    for (int i = 0; i < 4; i++)
        assert_true(readers[i] > 0);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_words),
        cmocka_unit_test(test_traits_go_together),
        cmocka_unit_test(test_live_parameters),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
