/* Sweeps of xpbd and angular momentum: what they take or add is given back; bodies that something holds are left alone;
   an inflated ball that nothing holds does not turn. */
#include "solve/spin.h"

#include "shell_fixture.h"

#include <string.h>

static void angular_of(const pel_model *model, const pel_record *base, const pel_record *x, double sum[3])
{
    pel_vec3_set(sum, 0, 0, 0);
    for (int32_t v = 0; v < model->vertex_count; v++) {
        double y[3], at[3], turn[3];
        if (model->mesh_vertex[v] < 0)
            continue;
        pel_vertex_position(base, v, y);
        pel_vertex_position(x, v, at);
        pel_vec3_cross(y, at, turn);
        pel_vec3_along(sum, (double)model->mass[v], turn, sum);
    }
}

/* Random ways of the vertices stand for a sweep. */
static void test_angular_momentum_returns(void **unused)
{
    (void)unused;
    random_state random = {7};
    for (int i = 0; i < 3; i++) {
        const bool is_pinned = i == 1, is_second = i == 2;
        pel_mesh *mesh = make_irregular_ball(16, &random);
        pel_body_def body = shell_body(mesh, PEL_MEMBRANE_NEO_HOOKEAN);
        const int32_t pin = 5;
        body.pinned = &pin;
        body.pinned_count = is_pinned;
        pel_model *model = make_model(&body);
        pel_state *state = make_state(model);
        pel_record *base = make_records(model), *given = make_records(model);
        pel_spin *spin;
        double before[3], swept[3], after[3], moved = 0;
        assert_int_equal(pel_spin_create(model, &spin), PEL_OK);
        memcpy(base, state->position, (size_t)model->vertex_count * sizeof *base);
        shake(model, state->position, 1e-3, &random);
        /* of second order, about the positions before the sweep, where the sum is 0 */
        if (is_second)
            memcpy(base, state->position, (size_t)model->vertex_count * sizeof *base);
        angular_of(model, base, state->position, before);
        pel_spin_begin(spin, is_second ? NULL : base, state->position, NULL);
        shake(model, state->position, 1e-3, &random);
        angular_of(model, base, state->position, swept);
        memcpy(given, state->position, (size_t)model->vertex_count * sizeof *given);
        pel_spin_end(spin, state->position, NULL);
        angular_of(model, base, state->position, after);
        for (int32_t v = 0; v < model->vertex_count; v++)
            for (int c = 0; c < 3; c++)
                moved = fmax(moved, fabs((double)(state->position[v][c] - given[v][c])));
        pel_vec3_subtract(swept, before, swept);
        pel_vec3_subtract(after, before, after);
        if (is_pinned)
            assert_true(moved == 0);
        else
            assert_true(pel_vec3_length(after) < IN_FLOAT(3e-3, 0.05) * pel_vec3_length(swept));
        assert_true(is_pinned || (moved > 0 && moved < 1e-3));
        pel_spin_destroy(spin);
        free(base);
        free(given);
        pel_state_destroy(state);
        pel_model_destroy(model);
        pel_mesh_destroy(mesh);
    }
}

/* Its membrane is under a tension that each sweep finds anew: it turned by a quarter in 3 s. */
static void test_inflated_ball(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_sphere(6);
    pel_body_def body = shell_body(mesh, PEL_MEMBRANE_NEO_HOOKEAN);
    body.shell.membrane.young.value = 1e8;
    body.shell.pressure = (pel_pressure_def){.kind = PEL_PRESSURE_GIVEN, .outside.value = -3e5};
    pel_model *model = make_model(&body);
    pel_sim_def def = lone_sim(model, PEL_METHOD_XPBD, 0.01);
    def.solver.substeps = 54;
    def.solver.drag = 3;
    pel_sim *sim = make_sim(&def);
    double(*x)[3] = calloc((size_t)mesh->vertex_count, sizeof *x), turned = 0;
    for (int i = 0; i < 100; i++)
        assert_int_equal(pel_sim_step(sim, NULL), PEL_OK);
    pel_sim_get_positions(sim, 0, x[0]);
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        double turn[3];
        pel_vec3_cross(mesh->positions[v], x[v], turn);
        turned = fmax(turned, pel_vec3_length(turn) / pel_vec3_length(x[v]));
    }
    print_message("turned by %.2e rad\n", turned);
    assert_true(pel_vec3_length(x[0]) > 1.001);
    assert_true(turned < 2e-3);
    free(x);
    pel_sim_destroy(sim);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_angular_momentum_returns),
        cmocka_unit_test(test_inflated_ball),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
