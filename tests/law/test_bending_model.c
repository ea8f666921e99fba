/* What the row of a bending model says, against the shell and the energy of a folded strip of two triangles. */
#include "shell_fixture.h"

#include "force/shell_body.h"
#include "law/bending_model.h"
#include "model/shell.h"

#include <string.h>

static pel_model *make_strip(pel_bending_model model, pel_mesh **mesh)
{
    static const double positions[4][3] = {{0, 0, 0}, {0, 1, 0}, {-1, 0.5, -0.3}, {1, 0.5, -0.3}};
    static const int32_t triangles[2][3] = {{0, 1, 2}, {1, 0, 3}};
    assert_int_equal(pel_mesh_create(positions[0], 4, triangles[0], 2, mesh, NULL), PEL_OK);
    pel_body_def body = shell_body(*mesh, PEL_MEMBRANE_STVK);
    body.shell.bending.model = model;
    return make_model(&body);
}

static void test_words(void **unused)
{
    (void)unused;
    for (int i = 0; i < PEL_BENDING_COUNT; i++) {
        assert_non_null(pel_bending_words[i]);
        for (int k = 0; k < i; k++)
            assert_string_not_equal(pel_bending_words[i], pel_bending_words[k]);
    }
    assert_null(pel_bending_words[PEL_BENDING_COUNT]);
}

static void test_rows(void **unused)
{
    (void)unused;
    for (int i = 0; i < PEL_BENDING_COUNT; i++) {
        const pel_bending_traits *traits = pel_bending_traits_of((pel_bending_model)i);
        assert_int_equal(pel_bending_is_on(traits), i != PEL_BENDING_NONE);
        assert_false(traits->has_hinges && traits->turns_edges);
        assert_false(traits->is_angle && !traits->has_hinges);
        pel_mesh *mesh;
        pel_model *model = make_strip((pel_bending_model)i, &mesh);
        const pel_shell *shell = model->bodies[0].shell;
        assert_ptr_equal(shell->bending, traits);
        assert_int_equal(shell->hinge_count, pel_bending_is_on(traits) ? 1 : 0);
        assert_int_equal(pel_shell_elastic_hinges(shell), traits->has_hinges ? 1 : 0);
        assert_int_equal(shell->parts != NULL, traits->turns_edges);
        pel_model_destroy(model);
        pel_mesh_destroy(mesh);
    }
    /* a value that is no model bends nothing; pel_shell_check refuses it */
    assert_false(pel_bending_is_on(pel_bending_traits_of((pel_bending_model)77)));
}

/* only paper B's own model has an energy in the rest shape (pellicle/shell.h) */
static void test_energy_at_rest(void **unused)
{
    (void)unused;
    for (int i = 0; i < PEL_BENDING_COUNT; i++) {
        pel_mesh *mesh;
        pel_model *model = make_strip((pel_bending_model)i, &mesh);
        const pel_shell *shell = model->bodies[0].shell;
        for (int32_t h = 0; h < pel_shell_elastic_hinges(shell); h++) {
            const pel_shell_hinge hinge = pel_shell_hinge_of(shell, h);
            double x[4][3];
            pel_load_points(model->rest, hinge.vertices, 4, x);
            double energy = pel_shell_hinge_energy(shell, model->rest, &hinge, (const double(*)[3])x, NULL);
            if (i == PEL_BENDING_ISOMETRIC)
                assert_true(energy > 0.1);
            else
                assert_near(energy, 0, sizeof(pel_real) == 8 ? 1e-15 : 1e-6);
        }
        pel_model_destroy(model);
        pel_mesh_destroy(mesh);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_words),
        cmocka_unit_test(test_rows),
        cmocka_unit_test(test_energy_at_rest),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
