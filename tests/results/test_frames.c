#include "check.h"

#include "failing_malloc.h"
#include "pellicle/frames.h"
#include "run_folder.h"

static char folder[FOLDER_SIZE];

static int set_up(void **unused)
{
    (void)unused;
    strcpy(folder, "frames_XXXXXX");
    folder_make(folder);
    return 0;
}

static int tear_down(void **unused)
{
    (void)unused;
    folder_remove(folder);
    return 0;
}

static void test_reads(void **unused)
{
    (void)unused;
    pel_frames *frames;
    assert_int_equal(pel_frames_open(folder, &frames, NULL), PEL_OK);
    assert_int_equal(frames->frame_count, FOLDER_FRAMES);
    for (int f = 0; f < FOLDER_FRAMES; f++) {
        pel_mesh *mesh;
        double positions[12], scalar[4], vector[12];
        folder_values(f, positions, scalar, vector);
        assert_near(frames->times[f], 0.5 * f, 0);
        assert_int_equal(pel_frames_read(frames, f, &mesh, NULL), PEL_OK);
        assert_memory_equal(mesh->positions, positions, sizeof positions);
        assert_memory_equal(pel_mesh_field(mesh, "energy")->values, scalar, sizeof scalar);
        pel_mesh_destroy(mesh);
    }
    pel_mesh *none;
    assert_int_equal(pel_frames_read(frames, FOLDER_FRAMES, &none, NULL), PEL_BAD_ARGUMENT);
    assert_null(none);
    pel_frames_close(frames);
    pel_frames_close(NULL);
}

static void test_outline(void **unused)
{
    (void)unused;
    pel_frames *frames;
    pel_frames_outline outline;
    assert_int_equal(pel_frames_open(folder, &frames, NULL), PEL_OK);
    assert_int_equal(pel_frames_check(frames, &outline, NULL), PEL_OK);
    assert_int_equal(outline.vertex_count, 4);
    assert_int_equal(outline.triangle_count, 4);
    assert_int_equal(outline.changed_frame, -1);
    for (int i = 0; i < 3; i++) {
        assert_near(outline.low[i], 10, 0);
        assert_near(outline.high[i], 11.3, 1e-12);
    }
    folder_write_frame(folder, 2, 3, 0);
    assert_int_equal(pel_frames_check(frames, &outline, NULL), PEL_OK);
    assert_int_equal(outline.changed_frame, 2);
    pel_frames_close(frames);
}

/* opening fails with the status and a message that holds the text */
static void assert_refused(const char *name, pel_status expected, const char *text)
{
    pel_frames *frames;
    pel_error error;
    char message[1200];
    assert_int_equal(pel_frames_open(name, &frames, &error), expected);
    assert_null(frames);
    pel_error_text(&error, message, sizeof message);
    if (strstr(message, text) == NULL)
        fail_msg("'%s' is not in: %s", text, message);
}

static void test_bad_folders(void **unused)
{
    (void)unused;
    char path[FOLDER_PATH];
    assert_refused("no-such-folder", PEL_BAD_FILE, "no such folder");
    folder_write_text(folder, "summary.json", "{\"version\": \"7.0.0\"}");
    assert_refused(folder, PEL_BAD_FORMAT, "the run is of pellicle 7.0.0 and this is " PEL_VERSION);
    folder_write_text(folder, "summary.json", "{}");
    folder_write_text(folder, "scene.yaml", "# a scene of pellicle 0.999.0 with all defaults\n");
    assert_refused(folder, PEL_BAD_FORMAT, "scene.yaml: error: the run is of pellicle 0.999.0");
    folder_write_text(folder, "scene.yaml", "");
    folder_write_text(folder, "frames.pvd", "<VTKFile></VTKFile>");
    assert_refused(folder, PEL_BAD_FORMAT, "it names no frame");
    folder_write_text(folder, "frames.pvd", "<VTKFile><DataSet timestep=\"0\"/></VTKFile>");
    assert_refused(folder, PEL_BAD_FORMAT, "names no file");
    folder_write_text(folder, "frames.pvd", "<VTKFile><DataSet timestep=\"soon\" file=\"a.vtp\"/></VTKFile>");
    assert_refused(folder, PEL_BAD_FORMAT, "has no time");
    static const char *const parts[] = {"4097", "-1", "nan", "x", "1e300"};
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++) {
        char list[200];
        snprintf(list, sizeof list, "<VTKFile><DataSet timestep=\"0\" part=\"%s\" file=\"a.vtp\"/></VTKFile>",
                 parts[i]);
        folder_write_text(folder, "frames.pvd", list);
        assert_refused(folder, PEL_BAD_FORMAT, "has no number as its part");
    }
    folder_write_text(folder, "frames.pvd", "<VTKFile><DataSet timestep=\"0\" file=\"a.vtp\"/>");
    assert_refused(folder, PEL_BAD_FORMAT, "cut off");
    remove(folder_path(path, folder, "frames.pvd"));
    assert_refused(folder, PEL_BAD_FILE, "frames.pvd");
}

static void test_bad_frames(void **unused)
{
    (void)unused;
    char path[FOLDER_PATH];
    pel_frames *frames;
    pel_mesh *mesh;
    pel_error error;
    assert_int_equal(pel_frames_open(folder, &frames, NULL), PEL_OK);
    folder_write_frame(folder, 1, 4, (double)NAN);
    assert_int_equal(pel_frames_read(frames, 1, &mesh, &error), PEL_BAD_FORMAT);
    assert_null(mesh);
    assert_int_equal(error.element, 2);
    assert_string_equal(error.what, "field 'energy' is not a number (NaN)");
    assert_int_equal(truncate(folder_path(path, folder, "frames/f00002.vtp"), 900), 0);
    assert_int_equal(pel_frames_read(frames, 2, &mesh, &error), PEL_BAD_FORMAT);
    assert_string_equal(error.file, path);
    remove(path);
    assert_int_equal(pel_frames_read(frames, 2, &mesh, &error), PEL_BAD_FILE);
    assert_string_equal(error.file, path);
    pel_frames_close(frames);
}

static pel_status read_all(const void *data, pel_error *error)
{
    pel_frames *frames;
    pel_frames_outline outline;
    pel_status status = pel_frames_open(data, &frames, error);
    if (status != PEL_OK) {
        assert_null(frames);
        return status;
    }
    status = pel_frames_check(frames, &outline, error);
    pel_frames_close(frames);
    return status;
}

static void test_allocation_failures(void **unused)
{
    (void)unused;
    assert_true(for_every_allocation_failure(read_all, folder) > 10);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_reads, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_outline, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_bad_folders, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_bad_frames, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_allocation_failures, set_up, tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
