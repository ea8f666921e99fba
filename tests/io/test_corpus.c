/* Replays the corpora of the fuzz targets: every file parses or fails cleanly, as itself and cut off at every length.
 */
#include "check.h"

#include "../fuzz/fuzz_mesh.h"
#include "base/memory.h"
#include "io/file.h"
#include "source_dir.h"

#include <dirent.h>
#include <stdlib.h>

static void replay_file(const char *path, pel_mesh_format format)
{
    char *bytes;
    size_t size;
    assert_int_equal(pel_file_read(path, &bytes, &size, NULL), PEL_OK);
    fuzz_parse("corpus", (const uint8_t *)bytes, size, format);
    fuzz_parse("corpus", (const uint8_t *)bytes, size, PEL_FORMAT_AUTO);
    for (size_t length = 0; length < size && length < 1500; length++) {
        /* a block of just this size shows every read beyond its end */
        uint8_t *cut = pel_allocate(length, 1);
        assert_non_null(cut);
        memcpy(cut, bytes, length);
        fuzz_parse("corpus", cut, length, format);
        pel_free(cut);
    }
    pel_free(bytes);
}

static void replay_folder(const char *name, pel_mesh_format format, int least)
{
    char folder[600], path[1000];
    snprintf(folder, sizeof folder, "%s/tests/fuzz/corpus/%s", PEL_SOURCE_DIR, name);
    DIR *stream = opendir(folder);
    assert_non_null(stream);
    int count = 0;
    for (struct dirent *entry = readdir(stream); entry != NULL; entry = readdir(stream)) {
        if (entry->d_name[0] == '.')
            continue;
        snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
        replay_file(path, format);
        count++;
    }
    closedir(stream);
    assert_true(count >= least);
}

static void test_obj(void **unused)
{
    (void)unused;
    replay_folder("obj", PEL_FORMAT_OBJ, 20);
}

static void test_ply(void **unused)
{
    (void)unused;
    replay_folder("ply", PEL_FORMAT_PLY, 20);
}

static void test_stl(void **unused)
{
    (void)unused;
    replay_folder("stl", PEL_FORMAT_STL, 15);
}

static void test_off(void **unused)
{
    (void)unused;
    replay_folder("off", PEL_FORMAT_OFF, 15);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_obj),
        cmocka_unit_test(test_ply),
        cmocka_unit_test(test_stl),
        cmocka_unit_test(test_off),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
