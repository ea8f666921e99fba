/* USD as text; check_usd.py reads the files by the grammar and the schema of meshes. */
#include "check.h"

#include "export_folder.h"
#include "failing_malloc.h"
#include "pellicle/export.h"
#include "source_dir.h"

/* what the independent reader says of a file */
static const char *ask(const char *path, const char *question)
{
    static char said[4000];
    char command[400];
    snprintf(command, sizeof command, "python3 " PEL_SOURCE_DIR "/tests/export/check_usd.py %s %s", path, question);
    FILE *stream = popen(command, "r");
    assert_non_null(stream);
    assert_non_null(fgets(said, sizeof said, stream));
    assert_int_equal(pclose(stream), 0);
    said[strcspn(said, "\n")] = '\0';
    return said;
}

static void check_numbers(const char *text, const double *expected, int count, double tolerance)
{
    char *end = (char *)(uintptr_t)text;
    for (int i = 0; i < count; i++)
        assert_near(strtod(end, &end), expected[i], tolerance);
    assert_int_equal(*end, '\0');
}

/* points of every frame are those of the run; normals are those of a tetrahedron with right angles at vertex 0 */
static void test_frames(void **unused)
{
    (void)unused;
    char path[FOLDER_PATH], question[100];
    assert_int_equal(pel_export_usd(folder_path(path, folder, "a.usda"), frames, NULL), PEL_OK);
    assert_string_equal(ask(path, ""), "body_0: 4 vertices, 4 triangles, 4 frames at 2 codes/s to 3");
    for (int f = 0; f < FOLDER_FRAMES; f++) {
        double positions[12], scalar[4], vector[12];
        folder_values(f, positions, scalar, vector);
        snprintf(question, sizeof question, "body_0 points.timeSamples %d", f);
        check_numbers(ask(path, question), positions, 12, 1e-6 * 12);
    }
    const double a = sqrt(1 / 3.0), normals[12] = {-a, -a, -a, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    check_numbers(ask(path, "body_0 normals.timeSamples 2"), normals, 12, 1e-6);
}

/* a mesh alone has values without times */
static void test_mesh(void **unused)
{
    (void)unused;
    char path[FOLDER_PATH];
    double positions[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {0, 0, 0.1}};
    int32_t triangles[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
    pel_mesh mesh = {.vertex_count = 4, .triangle_count = 4, .positions = positions, .triangles = triangles};
    pel_error error;
    assert_int_equal(pel_export_usd_mesh(folder_path(path, folder, "m.usda"), &mesh, NULL), PEL_OK);
    assert_string_equal(ask(path, ""), "body_0: 4 vertices, 4 triangles");
    positions[2][1] = 1e39;
    unlink(path);
    assert_int_equal(pel_export_usd_mesh(path, &mesh, &error), PEL_BAD_ARGUMENT);
    assert_non_null(strstr(error.what, "vertex 2"));
    assert_int_equal(access(path, F_OK), -1);
}

/* tools are meshes of their own; frames at unequal times keep them */
static void test_tools_and_times(void **unused)
{
    (void)unused;
    char path[FOLDER_PATH];
    pel_error error;
    pel_frames_close(frames);
    folder_add_tool(folder);
    assert_int_equal(pel_frames_open(folder, &frames, NULL), PEL_OK);
    assert_int_equal(pel_export_usd(folder_path(path, folder, "a.usda"), frames, NULL), PEL_OK);
    assert_string_equal(ask(path, ""),
                        "body_0: 4 vertices, 4 triangles; tool_0_tip_1: 8 vertices, 12 triangles, 4 frames "
                        "at 2 codes/s to 3");
    double corners[24];
    for (int i = 0; i < 24; i++)
        corners[i] = (i / 3 >> i % 3 & 1) + (i % 3 == 2 ? 3 : 0);
    check_numbers(ask(path, "tool_0_tip_1 points.timeSamples 3"), corners, 24, 0);
    frames->times[3] = 1.75;
    assert_int_equal(pel_export_usd(path, frames, NULL), PEL_OK);
    assert_non_null(strstr(ask(path, ""), ", 4 frames at 24 codes/s to 42"));
    frames->times[3] = frames->times[2];
    unlink(path);
    assert_int_equal(pel_export_usd(path, frames, &error), PEL_BAD_FORMAT);
    assert_non_null(strstr(error.what, "not later"));
    assert_int_equal(access(path, F_OK), -1);
}

/* a frame with two fields, as the coordinates of a texture */
static void write_fields(const char *a, const char *b, int components)
{
    static const double s[8] = {0, 0.25, 0.5, 0.75, 1, 0.125, 0.375, 0.625}, t[4] = {1, 0, 0.5, 0.25};
    double positions[12], scalar[4], vector[12];
    char path[FOLDER_PATH];
    folder_values(0, positions, scalar, vector);
    const pel_vtp_field fields[2] = {{a, components, s}, {b, 1, t}};
    const pel_vtp vtp = {.vertex_count = FOLDER_VERTICES,
                         .triangle_count = 4,
                         .positions = positions,
                         .triangles = folder_triangles,
                         .fields = fields,
                         .field_count = 2,
                         .float64 = true};
    assert_int_equal(pel_vtp_write(folder_path(path, folder, "frames/f00000.vtp"), &vtp, NULL), PEL_OK);
}

static void test_texture_coordinates(void **unused)
{
    (void)unused;
    static const struct {
        const char *a, *b;
        int components;
        bool found;
    } cases[] = {{"s", "t", 1, true},  {"u", "v", 1, true},  {"texture_u", "texture_v", 1, true},
                 {"st", "x", 2, true}, {"uv", "x", 2, true}, {"uv", "x", 1, false},
                 {"s", "x", 1, false}, {"s", "v", 1, false}};
    const double pairs[8] = {0, 1, 0.25, 0, 0.5, 0.5, 0.75, 0.25},
                 vectors[8] = {0, 0.25, 0.5, 0.75, 1, 0.125, 0.375, 0.625};
    char path[FOLDER_PATH];
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        write_fields(cases[i].a, cases[i].b, cases[i].components);
        assert_int_equal(pel_export_usd(folder_path(path, folder, "a.usda"), frames, NULL), PEL_OK);
        assert_int_equal(strstr(ask(path, ""), ", st") != NULL, cases[i].found);
        if (cases[i].found)
            check_numbers(ask(path, "body_0 primvars:st 0"), cases[i].components == 2 ? vectors : pairs, 8, 0);
    }
}

/* damage is named, and nothing is left */
static void test_refused(void **unused)
{
    (void)unused;
    char path[FOLDER_PATH];
    pel_error error;
    folder_path(path, folder, "a.usda");
    folder_write_frame(folder, 2, 3, 0);
    assert_int_equal(pel_export_usd(path, frames, &error), PEL_BAD_FORMAT);
    assert_non_null(strstr(error.file, "f00002.vtp"));
    assert_int_equal(access(path, F_OK), -1);
    double positions[12], scalar[4], vector[12];
    folder_values(2, positions, scalar, vector);
    positions[4] = -1e39;
    const pel_vtp vtp = {.vertex_count = FOLDER_VERTICES,
                         .triangle_count = 4,
                         .positions = positions,
                         .triangles = folder_triangles,
                         .time = 1,
                         .float64 = true};
    char frame[FOLDER_PATH];
    assert_int_equal(pel_vtp_write(folder_path(frame, folder, "frames/f00002.vtp"), &vtp, NULL), PEL_OK);
    assert_int_equal(pel_export_usd(path, frames, &error), PEL_BAD_FORMAT);
    assert_non_null(strstr(error.what, "too large"));
    assert_int_equal(access(path, F_OK), -1);
    folder_write_frame(folder, 2, 4, 0);
    assert_int_equal(pel_export_usd("no/such/folder/a.usda", frames, &error), PEL_BAD_FILE);
}

static pel_status export_usd(const void *path, pel_error *error)
{
    return pel_export_usd(path, frames, error);
}

static void test_allocation_failures(void **unused)
{
    (void)unused;
    char path[FOLDER_PATH];
    assert_true(for_every_allocation_failure(export_usd, folder_path(path, folder, "d.usda")) > 10);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_frames, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_mesh, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_tools_and_times, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_texture_coordinates, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_refused, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_allocation_failures, set_up, tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
