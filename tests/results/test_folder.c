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

/* folders of others are refused as they are; those of runs move aside, or stay to be cleared */
static void test_claim(void **unused)
{
    (void)unused;
    char path[FOLDER_PATH], here[4096];
    pel_error error;
    /* files like those of a run, without its mark */
    assert_int_equal(pel_run_folder_claim(folder, NULL, false, NULL, &error), PEL_BAD_FILE);
    assert_non_null(strstr(error.what, "none that says that they are of a run"));
    assert_int_equal(pel_run_folder_claim(folder, NULL, true, NULL, &error), PEL_BAD_FILE);
    assert_int_equal(pel_run_folder_claim("/", NULL, true, NULL, &error), PEL_BAD_FILE);
    assert_true(is_there("series.csv") && is_there("summary.json") && !is_there(".pellicle-run"));
    /* its own checkpoint makes it that of a run, another one does not */
    folder_write_text(folder, "checkpoint-1.pel", "");
    assert_int_equal(pel_run_folder_claim(folder, folder_path(path, folder, "checkpoint-1.pel"), false, NULL, NULL),
                     PEL_OK);
    assert_int_equal(pel_run_folder_claim(folder, "/etc/passwd", false, NULL, NULL), PEL_BAD_FILE);
    /* what a killed program left is nothing */
    char other[FOLDER_PATH], file[2 * FOLDER_PATH];
    assert_int_equal(mkdir(folder_path(other, folder, "other"), 0777), 0);
    folder_write_text(folder, "other/.pellicle-lock", "");
    folder_write_text(folder, "other/.pellicle-1-2.tmp", "");
    assert_int_equal(pel_run_folder_claim(other, NULL, false, NULL, NULL), PEL_OK);
    assert_int_equal(pel_run_folder_open(other, NULL), PEL_OK);
    snprintf(file, sizeof file, "%s/.pellicle-run", other);
    assert_int_equal(access(file, F_OK), 0);
    /* a run that is at work is left alone */
    int lock;
    assert_int_equal(pel_run_folder_lock(other, &lock, NULL), PEL_OK);
    assert_int_equal(pel_run_folder_claim(other, NULL, false, NULL, &error), PEL_BAD_FILE);
    assert_non_null(strstr(error.what, "another run"));
    pel_run_folder_unlock(other, lock);
    /* aside to the first free number */
    assert_int_equal(pel_run_folder_claim(other, NULL, true, NULL, NULL), PEL_OK);
    assert_int_equal(access(file, F_OK), 0);
    for (int number = 1; number <= 2; number++) {
        assert_int_equal(pel_run_folder_open(other, NULL), PEL_OK);
        folder_write_text(folder, "other/mine", "mine");
        assert_int_equal(pel_run_folder_claim(other, NULL, false, NULL, NULL), PEL_OK);
        assert_int_equal(access(other, F_OK), -1);
        snprintf(file, sizeof file, "%s.%d/mine", other, number);
        assert_int_equal(access(file, F_OK), 0);
    }
    /* not from inside */
    assert_int_equal(pel_run_folder_open(other, NULL), PEL_OK);
    assert_non_null(getcwd(here, sizeof here));
    assert_int_equal(chdir(other), 0);
    assert_int_equal(pel_run_folder_claim(".", NULL, false, NULL, &error), PEL_BAD_FILE);
    assert_int_equal(pel_run_folder_claim(".", NULL, true, NULL, &error), PEL_OK);
    assert_int_equal(chdir(here), 0);
    assert_non_null(strstr(error.remedy, "--overwrite"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_names),
        cmocka_unit_test_setup_teardown(test_lock, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_clear, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_claim, set_up, tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
