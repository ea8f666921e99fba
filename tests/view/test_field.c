#include "check.h"

#include "view/field.h"

static pel_mesh *make_mesh(void)
{
    static const double positions[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    static const int32_t triangles[2][3] = {{0, 1, 2}, {0, 2, 3}};
    static const double force[4][3] = {{3, 4, 0}, {0, 0, -2}, {0, 0, 0}, {1, 2, 2}}, energy[4] = {1, -2, 3, 0};
    pel_mesh *mesh;
    assert_int_equal(pel_mesh_create(positions[0], 4, triangles[0], 2, &mesh, NULL), PEL_OK);
    assert_int_equal(pel_mesh_add_field(mesh, "force", 3, force[0], NULL), PEL_OK);
    assert_int_equal(pel_mesh_add_field(mesh, "energy", 1, energy, NULL), PEL_OK);
    return mesh;
}

static void test_take(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_mesh();
    double values[4], range[2] = {HUGE_VAL, -HUGE_VAL};
    assert_int_equal(view_field_take(mesh, "force", -1, "here", values, range, NULL), PEL_OK);
    assert_true(values[0] == 5 && values[1] == 2 && values[2] == 0 && values[3] == 3);
    assert_true(range[0] == 0 && range[1] == 5);
    assert_int_equal(view_field_take(mesh, "force", 2, "here", values, range, NULL), PEL_OK);
    assert_true(values[1] == -2 && range[0] == -2 && range[1] == 5);
    assert_int_equal(view_field_take(mesh, "energy", -1, "here", values, range, NULL), PEL_OK);
    assert_true(values[1] == -2 && values[2] == 3);
    pel_mesh_destroy(mesh);
}

static void test_refuses(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_mesh();
    double values[4], range[2] = {0, 0};
    pel_error error;
    assert_int_equal(view_field_take(mesh, "forse", -1, "f.vtp", values, range, &error), PEL_BAD_ARGUMENT);
    assert_string_equal(error.what, "there is no field 'forse'");
    assert_string_equal(error.remedy, "did you mean 'force'?");
    assert_string_equal(error.file, "f.vtp");
    assert_int_equal(view_field_take(mesh, "temperature", -1, "f.vtp", values, range, &error), PEL_BAD_ARGUMENT);
    assert_string_equal(error.remedy, "choose one of force, energy");
    assert_int_equal(view_field_take(mesh, "force", 3, "f.vtp", values, range, &error), PEL_BAD_ARGUMENT);
    assert_string_equal(error.what, "field 'force' has no component 3");
    assert_int_equal(view_field_take(mesh, "energy", 1, "f.vtp", values, range, &error), PEL_BAD_ARGUMENT);
    mesh->fields[1].values[2] = (double)NAN;
    assert_int_equal(view_field_take(mesh, "energy", -1, "f.vtp", values, range, &error), PEL_BAD_FORMAT);
    assert_string_equal(error.what, "field 'energy' is not a number (NaN)");
    assert_int_equal(error.element, 2);
    pel_mesh_destroy(mesh);
}

static void check_scale(const char *name, int32_t component, const char *unit, double low, double high,
                        const char *title, const char *shown, int count, const char *first, const char *last)
{
    view_scale scale;
    view_scale_make(&scale, name, component, 3, unit, (double[]){low, high});
    assert_string_equal(scale.title, title);
    assert_string_equal(scale.unit, shown);
    assert_int_equal(scale.count, count);
    assert_string_equal(scale.text[0], first);
    assert_string_equal(scale.text[count - 1], last);
    for (int i = 0; i < count; ++i)
        assert_true(scale.at[i] >= 0 && scale.at[i] <= 1 && (i == 0 || scale.at[i] > scale.at[i - 1]));
}

static void test_scales(void **unused)
{
    (void)unused;
    check_scale("displacement", -1, NULL, 0, 0.283, "displacement", "m", 6, "0.00", "0.25");
    check_scale("displacement", -1, NULL, 0, 0.0011, "displacement", "mm", 6, "0.0", "1.0");
    check_scale("force", 2, NULL, -12000, 12000, "force z", "kN", 5, "−10", "10");
    check_scale("mean_curvature", -1, NULL, 0, 4e5, "mean curvature", "×10³ 1/m", 5, "0", "400");
    check_scale("gaussian_curvature", -1, NULL, 0, 1e-12, "gaussian curvature", "×10⁻¹² 1/m²", 6, "0.0", "1.0");
    check_scale("energy_bending", -1, NULL, 0, 3e-6, "energy bending", "µJ", 7, "0.0", "3.0");
    check_scale("contact", -1, NULL, 0, 1, "contact", "", 6, "0.0", "1.0");
    check_scale("contact", -1, "%", 0, 100, "contact", "%", 6, "0", "100");
    check_scale("displacement", -1, "", 0, 1e-300, "displacement", "×10⁻³⁰⁰", 6, "0.0", "1.0");
    check_scale("level", -1, NULL, 1e300, 2e300, "level", "×10³⁰⁰", 6, "1.0", "2.0");
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_take), cmocka_unit_test(test_refuses),
                                       cmocka_unit_test(test_scales)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
