/* Fields that are added after a run: the same as those of a run that had them from the start. */
#define _XOPEN_SOURCE 700 /* nftw */
#include "run/run_fixture.h"

#include "pellicle/frames.h"

#define SHELL(fields, more)                                                                                            \
    "version: 1\nbodies:\n  - { name: ball, mesh: { shape: geodesic-sphere, frequency: 3, radius: 0.1 },\n"            \
    "      membrane: { preset: rubber, thickness: 0.002 }, bending: { model: hinge }" more " }\n"                      \
    "  - { name: sheet, mesh: { shape: grid, nx: 3, ny: 3, translate: [2, 0, 0] }, membrane: { preset: rubber, "       \
    "thickness: 0.002 } }\n"                                                                                           \
    "loads: [{ body: ball, force: [0, 0, 2], at: { nearest: [0, 0, 1] } }]\n"                                          \
    "solver: { method: xpbd, dt: 0.01, substeps: 2 }\nduration: 0.05\n"                                                \
    "output: { every_frame: 2, precision: double, fields: [" fields "] }\n"

static void run_into(const char *name, const char *text, char path[256])
{
    pel_scene *scene = load_scene(text, NULL, 0);
    pel_run_def def = pel_run_def_default();
    pel_run_summary summary;
    pel_error error;
    char message[1000];
    in_folder(path, name, "");
    path[strlen(path) - 1] = '\0';
    def.folder = path;
    if (pel_run(scene, &def, &summary, &error) != PEL_OK)
        fail_msg("%s", pel_error_text(&error, message, sizeof message));
    pel_scene_destroy(scene);
}

static void test_same_values(void **unused)
{
    (void)unused;
    char with[256], without[256];
    static const char *const names[] = {"von_mises_top", "mean_curvature", "displacement"};
    run_into("with", SHELL("velocity, von_mises_top, mean_curvature, displacement", ""), with);
    run_into("without", SHELL("velocity", ""), without);
    pel_error error;
    char message[1000];
    if (pel_run_add_fields(without, names, 3, &error) != PEL_OK)
        fail_msg("%s", pel_error_text(&error, message, sizeof message));
    pel_frames *a, *b;
    assert_int_equal(pel_frames_open(with, &a, NULL), PEL_OK);
    assert_int_equal(pel_frames_open(without, &b, NULL), PEL_OK);
    assert_int_equal(a->frame_count, 4);
    double largest = 0;
    for (int32_t f = 0; f < a->frame_count; f++) {
        pel_mesh *expected, *found;
        assert_int_equal(pel_frames_read(a, f, &expected, NULL), PEL_OK);
        assert_int_equal(pel_frames_read(b, f, &found, NULL), PEL_OK);
        assert_int_equal(found->field_count, expected->field_count);
        for (int32_t k = 0; k < expected->field_count; k++) {
            const pel_field *field = &expected->fields[k], *other = pel_mesh_field(found, field->name);
            assert_non_null(other);
            for (int32_t i = 0; i < expected->vertex_count * field->component_count; i++)
                assert_true(other->values[i] == field->values[i]);
            if (strcmp(field->name, "von_mises_top") == 0)
                largest = field->values[0];
        }
        pel_mesh_destroy(expected);
        pel_mesh_destroy(found);
    }
    assert_true(largest > 100);
    pel_frames_close(a);
    pel_frames_close(b);
}

static void refuse(const char *path, const char *name, const char *words)
{
    pel_error error;
    assert_int_equal(pel_run_add_fields(path, &name, 1, &error), PEL_BAD_ARGUMENT);
    if (strstr(error.what, words) == NULL)
        fail_msg("%s", error.what);
    assert_true(error.remedy[0] != '\0');
}

static void test_refusals(void **unused)
{
    (void)unused;
    char path[256];
    pel_error error;
    run_into("plain", SHELL("velocity", ""), path);
    refuse(path, "von_misses_top", "there is no field 'von_misses_top'");
    refuse(path, "velocity", "field 'velocity' depends on more than the positions of a frame");
    refuse(path, "contact", "field 'contact' depends on");
    run_into("fibres", SHELL("velocity", ", anisotropy: { mode: active, rest_length: 0.9, stiffness: 1000 }"), path);
    refuse(path, "von_mises_top", "its fibres change over time");
    static const char soft[] =
        "version: 1\nbodies: [{ mesh: { shape: geodesic-sphere }, mass: { total: 1 },\n"
        "  springs: { stiffness: { keys: [[0, 1], [1, 2]] } } }]\nsolver: { dt: 0.01 }\nduration: 0.02\n";
    run_into("soft", soft, path);
    refuse(path, "spring_energy", "its material changes over time");
    assert_int_equal(pel_run_add_fields("no such folder", (const char *const[]){"area"}, 1, &error), PEL_BAD_FILE);
}

static pel_status add_case(const void *path, pel_error *error)
{
    static const char *const names[] = {"area"};
    return pel_run_add_fields(path, names, 1, error);
}

static void test_allocation_failures(void **unused)
{
    (void)unused;
    char path[256];
    static const char tiny[] =
        "version: 1\nbodies: [{ mesh: { shape: grid, nx: 1, ny: 1 }, mass: { total: 1 }, springs: { stiffness: 1 } }]\n"
        "solver: { method: quasi-static, dt: 0.01, threads: 1 }\nduration: 0.01\n";
    run_into("tiny", tiny, path);
    assert_true(for_every_allocation_failure(add_case, path) > 20);
}

int main(void)
{
    thread_count = 1;
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_same_values), cmocka_unit_test(test_refusals),
                                       cmocka_unit_test(test_allocation_failures)};
    return cmocka_run_group_tests(tests, make_folder, clear_folder);
}
