/* The process that reads foreign formats: what it may say, and how it may end. Scripts stand in for the program. */
#define _GNU_SOURCE /* setenv, mkfifo */
#include "check.h"
#include "failing_malloc.h"

#include "../io/parse.h"
#include "base/memory.h"
#include "foreign/child.h"
#include "io/file.h"
#include "pellicle/import.h"
#include "random.h"
#include "source_dir.h"

#include <fcntl.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#define MESH "child-test.dae"

static const char *const formats[] = {"dae", "amf", "x3d", "dxf", "3mf", "3ds", "fbx"};
enum { FORMATS = sizeof formats / sizeof *formats };

static void put_file(const char *path, const void *bytes, size_t size, mode_t mode)
{
    FILE *stream = fopen(path, "wb");
    assert_non_null(stream);
    assert_int_equal(fwrite(bytes, 1, size, stream), size);
    fclose(stream);
    assert_int_equal(chmod(path, mode), 0);
}

static void sample_path(size_t format, char path[600])
{
    snprintf(path, 600, "%s/tests/fuzz_scene/corpus_foreign/square.%s", PEL_SOURCE_DIR, formats[format]);
}

/* a square in each format */
static void test_formats(void **unused)
{
    (void)unused;
    for (size_t f = 0; f < FORMATS; f++) {
        char path[600], text[700];
        pel_mesh *mesh;
        pel_error error;
        sample_path(f, path);
        if (pel_mesh_import(path, NULL, &mesh, &error) != PEL_OK)
            fail_msg("%s", pel_error_text(&error, text, sizeof text));
        check_counts(mesh, 4, 2);
        pel_mesh_destroy(mesh);
    }
}

/* damaged files end with a mesh or an error, whatever becomes of their reader */
static void test_damage(void **unused)
{
    (void)unused;
    random_state random = {.seed = 5};
    for (int round = 0; round < ROUNDS(42, 14); round++) {
        char path[600], *bytes, name[32];
        size_t size;
        pel_mesh *mesh;
        pel_error error = {0};
        sample_path((size_t)round % FORMATS, path);
        assert_int_equal(pel_file_read(path, &bytes, &size, NULL), PEL_OK);
        for (int i = 0; i < 4; i++)
            bytes[random_integer(&random, 0, (int64_t)size - 1)] = (char)random_integer(&random, 0, 255);
        snprintf(name, sizeof name, "child-damage.%s", formats[(size_t)round % FORMATS]);
        put_file(name, bytes, size, 0666);
        pel_status status = pel_mesh_import(name, NULL, &mesh, &error);
        assert_true(status == PEL_OK ||
                    (status == PEL_BAD_FORMAT && error.what[0] != '\0' && strcmp(error.file, name) == 0));
        pel_mesh_destroy(mesh);
        pel_free(bytes);
        unlink(name);
    }
}

static void refuse(const char *script, double seconds, const char *words)
{
    char path[700], folder[500], text[700];
    pel_mesh *mesh;
    pel_error error = {0};
    put_file(MESH, "", 0, 0666);
    if (script != NULL) {
        put_file("child-program", script, strlen(script), 0777);
        snprintf(path, sizeof path, "%s/child-program", getcwd(folder, sizeof folder));
    } else {
        snprintf(path, sizeof path, "/not-there");
    }
    setenv("PELLICLE_PROGRAM", path, 1);
    pel_status status = pel_foreign_read(MESH, seconds, NULL, &mesh, &error);
    unsetenv("PELLICLE_PROGRAM");
    pel_error_text(&error, text, sizeof text);
    if (status != PEL_BAD_FORMAT || mesh != NULL || strstr(text, words) == NULL || strstr(text, MESH) == NULL ||
        error.remedy[0] == '\0')
        fail_msg("'%s' does not say '%s'", text, words);
    unlink("child-program");
    unlink(MESH);
}

#define HEAD(vertices, triangles, length)                                                                              \
    "printf 'pelmesh1\\0\\0\\0\\0\\" vertices "\\0\\0\\0\\" triangles "\\0\\0\\0\\" length "\\0\\0\\0"

static void test_endings(void **unused)
{
    (void)unused;
    refuse(NULL, 10, "is not found");
    refuse("#!/bin/sh\nkill -SEGV $$\n", 10, "the reader of dae died of the file: signal 11");
    refuse("#!/bin/sh\nkill -XCPU $$\n", 10, "the reader of dae took more than 60 s");
    refuse("#!/bin/sh\nsleep 100\n", 0.2, "the reader of dae took more than 0.2 s");
    refuse("#!/bin/sh\nexit 0\n", 10, "the reader of dae gave no mesh");
    refuse("#!/bin/sh\necho 'unknown command'\nexit 2\n", 10, "gave no mesh");
    refuse("not a program", 10, "cannot start");
    /* heads with too little behind, too much, or numbers that are none */
    refuse("#!/bin/sh\n" HEAD("3", "1", "1") "\\0'\n", 10, "gave no mesh");
    refuse("#!/bin/sh\n" HEAD("0", "0", "1") "\\0\\0'\n", 10, "gave no mesh");
    refuse("#!/bin/sh\n" HEAD("0", "0", "1") "a'\n", 10, "gave no mesh");
    refuse("#!/bin/sh\n" HEAD("0", "0", "0") "'\n", 10, "gave no mesh");
    refuse("#!/bin/sh\n" HEAD("0", "0", "1") "\\0'\n", 10, "gave no mesh");
    refuse(
        "#!/bin/sh\n" HEAD("1", "1", "1") "\\0'\nhead -c 24 /dev/zero\nprintf '\\0\\0\\0\\0\\0\\0\\0\\0\\7\\0\\0\\0'\n",
        10, "gave no mesh");
}

/* the limits of the process that reads, asked of it after it has read: 0 = as documented, else the first that is not */
static int read_under_limits(const char *path, off_t size)
{
    const struct {
        int resource;
        rlim_t most;
    } limits[] = {{RLIMIT_CPU, PEL_CHILD_CPU_SECONDS},
                  {RLIMIT_AS, PEL_CHILD_MEMORY(size)},
                  {RLIMIT_FSIZE, 0},
                  {RLIMIT_NOFILE, 16},
                  {RLIMIT_CORE, 0}};
    enum { INHERITED = 9 };
    int null = open("/dev/null", O_WRONLY);
    if (dup2(null, 1) != 1 || dup2(null, INHERITED) != INHERITED || pel_mesh_import_child(path) != 0)
        return 100;
    for (int i = 0; i < (int)(sizeof limits / sizeof *limits); i++) {
        struct rlimit now;
        /* the address sanitizer needs them all */
        bool has_addresses = is_slow() && limits[i].resource == RLIMIT_AS;
        if (getrlimit((__rlimit_resource_t)limits[i].resource, &now) != 0 ||
            (now.rlim_max != limits[i].most && !has_addresses))
            return 1 + i;
    }
    return fcntl(INHERITED, F_GETFD) == -1 ? 0 : 50;
}

static void test_limits(void **unused)
{
    (void)unused;
    struct stat information;
    char path[600];
    int status = 0;
    sample_path(0, path);
    assert_int_equal(stat(path, &information), 0);
    assert_true(PEL_CHILD_CPU_SECONDS == 60 && PEL_CHILD_MEMORY(1000) == (1u << 30) + 100000);
    pid_t child = fork();
    if (child == 0)
        _exit(read_under_limits(path, information.st_size));
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFEXITED(status));
    assert_int_equal(WEXITSTATUS(status), 0);
}

/* one that does not end is stopped once it has said as much as it may have memory: a GiB */
static void test_endless_answer(void **unused)
{
    (void)unused;
    skip_if_slow();
    refuse("#!/bin/sh\nexec cat /dev/zero\n", 60, "the reader of dae made more than 1073741824 bytes");
}

static void test_files(void **unused)
{
    (void)unused;
    pel_mesh *mesh;
    pel_error error;
    unlink(MESH);
    assert_int_equal(mkfifo(MESH, 0666), 0);
    assert_int_equal(pel_mesh_import(MESH, NULL, &mesh, &error), PEL_BAD_FILE);
    assert_non_null(strstr(error.what, "a pipe"));
    unlink(MESH);
    assert_int_equal(pel_mesh_import(MESH, NULL, &mesh, &error), PEL_BAD_FILE);
    /* formats of assimp that nobody has */
    static const char *const others[] = {"raw", "blend", "ifc", "md5mesh", "q3o", "irr"};
    for (size_t i = 0; i < sizeof others / sizeof *others; i++) {
        char name[40];
        snprintf(name, sizeof name, "child-test.%s", others[i]);
        put_file(name, "0 0 0 1 0 0 0 1 0\n", 18, 0666);
        assert_int_equal(pel_mesh_import(name, NULL, &mesh, &error), PEL_BAD_FORMAT);
        assert_false(pel_foreign_is(name));
        unlink(name);
    }
}

static pel_status import_case(const void *path, pel_error *error)
{
    pel_mesh *mesh;
    pel_status status = pel_mesh_import(path, NULL, &mesh, error);
    pel_mesh_destroy(mesh);
    return status;
}

static void test_allocation_failures(void **unused)
{
    (void)unused;
    char path[600];
    sample_path(0, path);
    assert_true(for_every_allocation_failure(import_case, path) >= 5);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_formats),
        cmocka_unit_test(test_damage),
        cmocka_unit_test(test_endings),
        cmocka_unit_test(test_files),
        cmocka_unit_test(test_limits),
        cmocka_unit_test(test_endless_answer),
        cmocka_unit_test(test_allocation_failures),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
