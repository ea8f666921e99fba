#include "check.h"

#include "base/memory.h"
#include "failing_malloc.h"
#include "io/file.h"

#include <dirent.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

static char folder[64];

static void path_in_folder(char *path, size_t size, const char *name)
{
    snprintf(path, size, "%s/%s", folder, name);
}

static int file_count(void)
{
    int count = 0;
    DIR *stream = opendir(folder);
    for (struct dirent *entry = readdir(stream); entry != NULL; entry = readdir(stream))
        count += strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0;
    closedir(stream);
    return count;
}

static void write_text(const char *path, const char *text)
{
    pel_file_writer writer;
    pel_error error;
    assert_int_equal(pel_file_writer_open(&writer, path, &error), PEL_OK);
    pel_file_writer_write(&writer, text, strlen(text));
    assert_int_equal(pel_file_writer_commit(&writer, &error), PEL_OK);
}

static void check_text(const char *path, const char *text)
{
    char *bytes;
    size_t size;
    assert_int_equal(pel_file_read(path, &bytes, &size, NULL), PEL_OK);
    assert_int_equal(size, strlen(text));
    assert_string_equal(bytes, text);
    pel_free(bytes);
}

static int make_folder(void **unused)
{
    (void)unused;
    snprintf(folder, sizeof folder, "file-test-XXXXXX");
    return mkdtemp(folder) == NULL;
}

static int remove_folder(void **unused)
{
    (void)unused;
    char path[512];
    DIR *stream = opendir(folder);
    for (struct dirent *entry = readdir(stream); entry != NULL; entry = readdir(stream)) {
        path_in_folder(path, sizeof path, entry->d_name);
        unlink(path);
    }
    closedir(stream);
    return rmdir(folder);
}

static void test_round_trip(void **unused)
{
    (void)unused;
    char path[128];
    path_in_folder(path, sizeof path, "a.txt");
    write_text(path, "hello\nworld");
    check_text(path, "hello\nworld");
    write_text(path, "");
    check_text(path, "");
    assert_int_equal(file_count(), 1);
}

static void test_read_failures(void **unused)
{
    (void)unused;
    pel_error error;
    char *bytes;
    size_t size;
    assert_int_equal(pel_file_read("does/not/exist", &bytes, &size, &error), PEL_BAD_FILE);
    assert_null(bytes);
    assert_non_null(strstr(error.what, "No such file"));
    assert_string_equal(error.file, "does/not/exist");
    assert_true(error.line == 0 && error.column == 0);
    assert_int_equal(pel_file_read(folder, &bytes, &size, &error), PEL_BAD_FILE);
    assert_non_null(strstr(error.what, "directory"));
}

/* pipes and devices are refused, without waiting for a writer */
static void test_read_pipe_or_device(void **unused)
{
    (void)unused;
    char *bytes, path[128];
    size_t size;
    pel_error error;
    assert_int_equal(pel_file_read("/dev/zero", &bytes, &size, &error), PEL_BAD_FILE);
    assert_null(bytes);
    assert_non_null(strstr(error.what, "device"));
    path_in_folder(path, sizeof path, "pipe");
    assert_int_equal(mkfifo(path, 0600), 0);
    assert_int_equal(pel_file_read(path, &bytes, &size, &error), PEL_BAD_FILE);
    assert_non_null(strstr(error.what, "pipe"));
    assert_int_equal(pel_file_check(path, &error), PEL_BAD_FILE);
    unlink(path);
}

/* links and names that lead out of a folder are refused, those that stay in it are not */
static void test_inside(void **unused)
{
    (void)unused;
    char path[128], link[128], out[128], up[200];
    pel_error error;
    path_in_folder(path, sizeof path, "inside.txt");
    path_in_folder(link, sizeof link, "inside-link");
    path_in_folder(out, sizeof out, "outside-link");
    snprintf(up, sizeof up, "%s/../%s/inside.txt", folder, folder);
    write_text(path, "text");
    assert_int_equal(symlink("inside.txt", link), 0);
    assert_int_equal(symlink("/etc/passwd", out), 0);
    assert_int_equal(pel_file_check_inside(folder, path, &error), PEL_OK);
    assert_int_equal(pel_file_check_inside(folder, link, &error), PEL_OK);
    assert_int_equal(pel_file_check_inside(folder, up, &error), PEL_OK);
    assert_int_equal(pel_file_check_inside(folder, out, &error), PEL_BAD_FORMAT);
    assert_string_equal(error.file, out);
    snprintf(up, sizeof up, "%s/..", folder);
    assert_int_equal(pel_file_check_inside(folder, up, &error), PEL_BAD_FORMAT);
    assert_int_equal(pel_file_check_inside(folder, "/etc/passwd", &error), PEL_BAD_FORMAT);
    /* a folder that is not there says so when it is read */
    assert_int_equal(pel_file_check_inside("does/not/exist", "/etc/passwd", &error), PEL_OK);
    unlink(link);
    unlink(out);
}

/* a program that ends in the middle leaves no file behind */
static void test_killed_writer(void **unused)
{
    (void)unused;
    char path[128];
    path_in_folder(path, sizeof path, "killed.txt");
    int before = file_count();
    pel_file_writer probe;
    assert_int_equal(pel_file_writer_open(&probe, path, NULL), PEL_OK);
    bool nameless = probe.nameless;
    pel_file_writer_abandon(&probe);
    if (!nameless)
        skip();
    pid_t child = fork();
    if (child == 0) {
        pel_file_writer writer;
        if (pel_file_writer_open(&writer, path, NULL) == PEL_OK)
            pel_file_writer_printf(&writer, "half");
        kill(getpid(), SIGKILL);
    }
    int result;
    assert_int_equal(waitpid(child, &result, 0), child);
    assert_true(WIFSIGNALED(result));
    assert_int_equal(file_count(), before);
}

/* reading fails midway: nothing is left behind */
static void test_read_error(void **unused)
{
    (void)unused;
    char *bytes;
    size_t size;
    pel_error error;
    if (access("/proc/self/mem", R_OK) != 0)
        skip();
    failing_malloc_begin(0);
    assert_int_equal(pel_file_read("/proc/self/mem", &bytes, &size, &error), PEL_BAD_FILE);
    assert_int_equal(failing_malloc_end().live, 0);
    assert_null(bytes);
    assert_string_equal(error.file, "/proc/self/mem");
}

/* the name of the temporary file is taken, as by a program that was killed: another one is found, that one stays */
static void test_taken_temporary(void **unused)
{
    (void)unused;
    char path[128], taken[2][128], name[64];
    for (int i = 0; i < 2; i++) {
        snprintf(name, sizeof name, ".pellicle-%ld-%d.tmp", (long)getpid(), i);
        path_in_folder(taken[i], sizeof taken[i], name);
        FILE *file = fopen(taken[i], "w");
        assert_non_null(file);
        fputs("left over", file);
        fclose(file);
    }
    path_in_folder(path, sizeof path, "e.txt");
    write_text(path, "new");
    check_text(path, "new");
    for (int i = 0; i < 2; i++) {
        check_text(taken[i], "left over");
        unlink(taken[i]);
    }
}

/* files are always closed: the next free descriptor is the same as before */
static void test_descriptors(void **unused)
{
    (void)unused;
    char path[128], missing[128], *bytes;
    size_t size;
    path_in_folder(path, sizeof path, "f.txt");
    path_in_folder(missing, sizeof missing, "none/f.txt");
    write_text(path, "text");
    int before = dup(0);
    assert_true(before >= 0);
    close(before);
    for (int i = 0; i < 20; i++) {
        pel_file_writer writer;
        assert_int_equal(pel_file_check(path, NULL), PEL_OK);
        assert_int_equal(pel_file_check(folder, NULL), PEL_BAD_FILE);
        assert_int_equal(pel_file_read(folder, &bytes, &size, NULL), PEL_BAD_FILE);
        check_text(path, "text");
        assert_int_equal(pel_file_writer_open(&writer, missing, NULL), PEL_BAD_FILE);
        assert_int_equal(pel_file_writer_open(&writer, path, NULL), PEL_OK);
        pel_file_writer_abandon(&writer);
    }
    int after = dup(0);
    assert_int_equal(after, before);
    close(after);
}

/* an abandoned or uncommitted writer changes nothing under the path */
static void test_abandon_keeps_old(void **unused)
{
    (void)unused;
    char path[128];
    path_in_folder(path, sizeof path, "b.txt");
    write_text(path, "old");
    int before = file_count();
    pel_file_writer writer;
    assert_int_equal(pel_file_writer_open(&writer, path, NULL), PEL_OK);
    pel_file_writer_printf(&writer, "new %d", 1);
    check_text(path, "old");
    pel_file_writer_abandon(&writer);
    pel_file_writer_abandon(&writer);
    check_text(path, "old");
    assert_int_equal(file_count(), before);
}

static void test_mode_and_links_kept(void **unused)
{
    (void)unused;
    char path[128], link[128];
    struct stat information;
    path_in_folder(path, sizeof path, "c.txt");
    path_in_folder(link, sizeof link, "link.txt");
    write_text(path, "one");
    assert_int_equal(chmod(path, 0640), 0);
    assert_int_equal(symlink("c.txt", link), 0);
    write_text(link, "two");
    check_text(path, "two");
    assert_int_equal(lstat(link, &information), 0);
    assert_true(S_ISLNK(information.st_mode));
    assert_int_equal(stat(path, &information), 0);
    assert_int_equal(information.st_mode & 0777, 0640);
}

static void test_write_failures(void **unused)
{
    (void)unused;
    pel_error error;
    pel_file_writer writer;
    assert_int_equal(pel_file_writer_open(&writer, "does/not/exist", &error), PEL_BAD_FILE);
    assert_non_null(strstr(error.what, "No such file"));
    pel_file_writer_abandon(&writer);
    assert_int_equal(pel_file_writer_open(&writer, folder, &error), PEL_BAD_FILE);
    assert_non_null(strstr(error.what, "directory"));
    assert_true(strlen(error.remedy) > 0);
}

/* the kernel refuses every byte written to /dev/full: small files fail in commit, large ones before */
/* the limit on open files is named, not the folder */
static void test_too_many_open(void **unused)
{
    (void)unused;
    char path[200];
    struct rlimit before, none;
    pel_file_writer writer;
    pel_error error;
    path_in_folder(path, sizeof path, "many");
    assert_int_equal(getrlimit(RLIMIT_NOFILE, &before), 0);
    none = (struct rlimit){.rlim_cur = 0, .rlim_max = before.rlim_max};
    assert_int_equal(setrlimit(RLIMIT_NOFILE, &none), 0);
    pel_status status = pel_file_writer_open(&writer, path, &error);
    assert_int_equal(setrlimit(RLIMIT_NOFILE, &before), 0);
    assert_int_equal(status, PEL_BAD_FILE);
    assert_non_null(strstr(error.remedy, "ulimit -n"));
    path_in_folder(path, sizeof path, "none/many");
    assert_int_equal(pel_file_writer_open(&writer, path, &error), PEL_BAD_FILE);
    assert_non_null(strstr(error.remedy, "check that the folder exists"));
}

static void test_disk_full(void **unused)
{
    (void)unused;
    if (access("/dev/full", W_OK) != 0)
        skip();
    const int counts[2] = {1, 100000};
    for (int i = 0; i < 2; i++) {
        pel_error error;
        pel_file_writer writer;
        assert_int_equal(pel_file_writer_open(&writer, "/dev/full", &error), PEL_OK);
        for (int line = 0; line < counts[i]; line++)
            pel_file_writer_printf(&writer, "line %d\n", line);
        assert_int_equal(pel_file_writer_commit(&writer, &error), PEL_BAD_FILE);
        assert_non_null(strstr(error.what, "No space left"));
        assert_string_equal(error.file, "/dev/full");
    }
    struct stat information;
    assert_int_equal(stat("/dev/full", &information), 0);
    assert_true(S_ISCHR(information.st_mode));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_round_trip),          cmocka_unit_test(test_read_failures),
        cmocka_unit_test(test_read_pipe_or_device), cmocka_unit_test(test_inside),
        cmocka_unit_test(test_killed_writer),       cmocka_unit_test(test_abandon_keeps_old),
        cmocka_unit_test(test_mode_and_links_kept), cmocka_unit_test(test_write_failures),
        cmocka_unit_test(test_disk_full),           cmocka_unit_test(test_too_many_open),
        cmocka_unit_test(test_read_error),          cmocka_unit_test(test_taken_temporary),
        cmocka_unit_test(test_descriptors),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
