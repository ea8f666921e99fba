/* The quick bound of the stiffness of shells is above the true one whatever the shell is made of, and not far above. */
#include "failing_malloc.h"
#include "shell_fixture.h"

#include "solve/shell_stability.h"

/* bound and power iteration on a model */
static pel_stability stability_of(const pel_model *model)
{
    pel_state *state = make_state(model);
    pel_batches *batches;
    pel_shell_forces *forces;
    assert_int_equal(pel_batches_create(model, PEL_METHOD_EXPLICIT, &batches, NULL), PEL_OK);
    pel_stability stability;
    assert_int_equal(pel_shell_forces_create(batches, &forces, NULL), PEL_OK);
    pel_stability_bound(model, &stability);
    pel_shell_stability_bound(forces, &stability);
    assert_true(stability.stiffness == stability.stiffness_bound);
    assert_int_equal(pel_shell_stability_refine(model, state, forces, NULL, &stability, NULL), PEL_OK);
    pel_shell_forces_destroy(forces);
    pel_batches_destroy(batches);
    pel_state_destroy(state);
    return stability;
}

/* 1/s2, of a model stretched in its plane */
static double stiffness_at(const pel_model *model, double stretch)
{
    pel_state *state = make_state(model);
    pel_batches *batches;
    pel_shell_forces *forces;
    double stiffness;
    assert_int_equal(pel_batches_create(model, PEL_METHOD_EXPLICIT, &batches, NULL), PEL_OK);
    assert_int_equal(pel_shell_forces_create(batches, &forces, NULL), PEL_OK);
    for (int32_t v = 0; v < model->vertex_count; v++)
        for (int c = 0; c < 2; c++)
            state->position[v][c] *= (pel_real)stretch;
    assert_int_equal(pel_shell_stability_now(model, state, forces, NULL, &stiffness), PEL_OK);
    pel_shell_forces_destroy(forces);
    pel_batches_destroy(batches);
    pel_state_destroy(state);
    return stiffness;
}

/* the refined number is the bound where it would be above it */
static void check_bound(const pel_body_def *body, double most, const char *name)
{
    pel_model *model = make_model(body);
    pel_stability stability = stability_of(model);
    print_message("%s: bound over stiffness %.3g\n", name, stability.stiffness_bound / stability.stiffness);
    assert_true(stability.stiffness > 0);
    /* in float the margin of the power iteration is larger than what some bounds leave */
    assert_true(sizeof(pel_real) == 4 || stability.stiffness_bound > 1.001 * stability.stiffness);
    assert_true(stability.stiffness_bound < most * stability.stiffness);
    pel_model_destroy(model);
}

/* a sheet of long triangles, on which no number is near 1, with a membrane too soft to count */
static pel_body_def soft_sheet(const pel_mesh *mesh)
{
    pel_body_def body = shell_body(mesh, PEL_MEMBRANE_STVK);
    body.shell.membrane.young.value = 1e-3;
    return body;
}

static void test_parts(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_grid(6, 6, 10, 1, PEL_GRID_UNION_JACK);
    static const pel_bending_model models[] = {PEL_BENDING_HINGE, PEL_BENDING_ISOMETRIC, PEL_BENDING_ISOMETRIC_REST};
    for (int i = 0; i < 3; i++) {
        pel_body_def body = soft_sheet(mesh);
        body.shell.bending.model = models[i];
        body.shell.bending.stiffness.value = 7;
        check_bound(&body, 4, "bending");
    }
    for (int kind = PEL_FIBRE_ARAP; kind <= PEL_FIBRE_SQRT; kind++) {
        pel_anisotropy_def fibres = pel_anisotropy_def_default();
        fibres.mode = PEL_FIBRE_STRAIN;
        fibres.kind = (pel_fibre_kind)kind;
        fibres.direction = PEL_FIBRE_ALONG;
        fibres.axis[0] = 0;
        fibres.axis[1] = 1;
        fibres.axis[2] = 0;
        fibres.stiffness = 1000;
        pel_body_def body = soft_sheet(mesh);
        body.shell.anisotropies = &fibres;
        body.shell.anisotropy_count = 1;
        check_bound(&body, 4, "fibres");
    }
    pel_mesh_destroy(mesh);
}

static void test_materials(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_grid(6, 6, 10, 1, PEL_GRID_UNION_JACK);
    for (int kind = PEL_MEMBRANE_STVK; kind < PEL_MEMBRANE_COUNT; kind++) {
        pel_body_def body = shell_body(mesh, (pel_membrane_kind)kind);
        check_bound(&body, 4, "membrane");
    }
    pel_mesh_destroy(mesh);
}

/* a pressure turns with the surface, and one that goes with the volume resists its change */
static void test_pressures(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_sphere(4);
    static const pel_pressure_kind kinds[] = {PEL_PRESSURE_GIVEN, PEL_PRESSURE_GAS, PEL_PRESSURE_VOLUME};
    for (int i = 0; i < 3; i++) {
        pel_body_def body = soft_sheet(mesh);
        body.shell.pressure.kind = kinds[i];
        body.shell.pressure.outside.value = body.shell.pressure.value = body.shell.pressure.bulk = 1000;
        body.shell.pressure.target.value = 1;
        check_bound(&body, 8, "pressure");
    }
    pel_mesh_destroy(mesh);
}

/* the corner with which a triangle begins does not change the bound */
static void test_corners(void **unused)
{
    (void)unused;
    static const pel_pressure_kind kinds[] = {PEL_PRESSURE_NONE, PEL_PRESSURE_GIVEN, PEL_PRESSURE_VOLUME};
    const double rounding = sizeof(pel_real) == 8 ? 1e-12 : 1e-5;
    for (int i = 0; i < 3; i++) {
        pel_mesh *mesh = make_sphere(3);
        double bounds[3];
        for (int turn = 0; turn < 3; turn++) {
            pel_body_def body = i == 0 ? shell_body(mesh, PEL_MEMBRANE_STVK) : soft_sheet(mesh);
            body.shell.pressure.kind = kinds[i];
            body.shell.pressure.outside.value = body.shell.pressure.bulk = 1000;
            body.shell.pressure.target.value = 1;
            pel_model *model = make_model(&body);
            bounds[turn] = stability_of(model).stiffness_bound;
            assert_near(bounds[turn], bounds[0], rounding * bounds[0]);
            pel_model_destroy(model);
            for (int32_t t = 0; t < mesh->triangle_count; t += 1 + turn) {
                int32_t *c = mesh->triangles[t], first = c[0];
                c[0] = c[1];
                c[1] = c[2];
                c[2] = first;
            }
        }
        pel_mesh_destroy(mesh);
    }
}

/* At rest it is that of the rest. At the stretch l waves along their direction have E (3 l^2 - 1) / 2 of stvk with nu =
   0, and waves across it E (2 l^2 - 1) / 2: 5.5 and 7 times that at rest, so that a mesh has a number between them. */
static void test_stretched(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_grid(6, 6, 1, 1, PEL_GRID_UNION_JACK);
    pel_body_def body = shell_body(mesh, PEL_MEMBRANE_STVK);
    body.shell.membrane.poisson = 0;
    pel_model *model = make_model(&body);
    const double rest = stability_of(model).stiffness, here = stiffness_at(model, 1), far = stiffness_at(model, 2);
    assert_near(here, rest, 1e-3 * rest);
    print_message("stretched: %.3g times the stiffness at rest\n", far / rest);
    assert_true(far > 5.5 * rest && far < 7 * rest);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_parts),   cmocka_unit_test(test_materials), cmocka_unit_test(test_pressures),
        cmocka_unit_test(test_corners), cmocka_unit_test(test_stretched),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
