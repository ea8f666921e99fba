/* The folder of a run: names of its files, one run at a time, and what an older run leaves. */
#include "run_folder.h"

#include "results/folder.h"

static char folder[FOLDER_SIZE];

static int set_up(void **unused)
{
    (void)unused;
    strcpy(folder, "folder_XXXXXX");
    folder_make(folder);
    return 0;
}

static int tear_down(void **unused)
{
    (void)unused;
    folder_remove(folder);
    return 0;
}

static void test_names(void **unused)
{
    (void)unused;
    char path[PEL_RUN_FILE_SIZE];
    assert_string_equal(pel_run_path(path, "a/b", PEL_RUN_SERIES), "a/b/series.csv");
    assert_string_equal(pel_run_frame_path(path, "a", 12), "a/frames/f00012.vtp");
    assert_string_equal(pel_run_frame_path(path, NULL, 123456), "frames/f123456.vtp");
    assert_string_equal(pel_run_tool_path(path, NULL, 3, 10), "frames/t00003-10.vtp");
    assert_string_equal(pel_run_checkpoint_path(path, "a", 120), "a/checkpoint-120.pel");
}

/* a second run is refused with the first one's process until that has ended */
static void test_lock(void **unused)
{
    (void)unused;
    int first, second;
    char holder[40], path[FOLDER_PATH];
    pel_error error;
    assert_int_equal(pel_run_folder_open(folder, NULL), PEL_OK);
    assert_int_equal(pel_run_folder_lock(folder, &first, NULL), PEL_OK);
    assert_true(first >= 0);
    assert_int_equal(pel_run_folder_lock(folder, &second, &error), PEL_BAD_FILE);
    assert_int_equal(second, -1);
    snprintf(holder, sizeof holder, "process %ld on ", (long)getpid());
    assert_non_null(strstr(error.what, holder));
    assert_string_equal(error.file, folder);
    pel_run_folder_unlock(folder, second);
    assert_int_equal(access(folder_path(path, folder, ".pellicle-lock"), F_OK), 0);
    pel_run_folder_unlock(folder, first);
    assert_int_equal(access(path, F_OK), -1);
    assert_int_equal(pel_run_folder_lock(folder, &second, &error), PEL_OK);
    pel_run_folder_unlock(folder, second);
}

static bool is_there(const char *name)
{
    char path[FOLDER_PATH];
    return access(folder_path(path, folder, name), F_OK) == 0;
}

/* a resumed run keeps the frames before it, a new one none; files that are not of a run stay */
static void test_clear(void **unused)
{
    (void)unused;
    bool removed;
    folder_write_text(folder, "frames/f00001.txt", "mine");
    folder_write_text(folder, "notes.txt", "mine");
    assert_int_equal(pel_run_folder_clear(folder, 2, true, &removed, NULL), PEL_OK);
    assert_true(removed && is_there("frames/f00001.vtp") && !is_there("frames/f00002.vtp"));
    assert_true(!is_there("summary.json") && is_there("series.csv"));
    assert_int_equal(pel_run_folder_clear(folder, 0, false, &removed, NULL), PEL_OK);
    assert_true(removed && !is_there("frames/f00000.vtp") && !is_there("series.csv"));
    assert_int_equal(pel_run_folder_clear(folder, 0, false, &removed, NULL), PEL_OK);
    assert_true(!removed && is_there("notes.txt") && is_there("frames/f00001.txt"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_names),
        cmocka_unit_test_setup_teardown(test_lock, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_clear, set_up, tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
