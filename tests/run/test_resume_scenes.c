/* Runs of all shipped scenes that are stopped in the middle and continued: run/stops.h. `make nightly` runs the scenes
   to their ends, with more stops. */
#include "run/stops.h"
#include "source_dir.h"

/* frames of the quick form */
static int64_t frames_of(const char *name)
{
    static const struct {
        const char *name;
        int64_t frames;
    } scenes[] = {{"balloon", 4},       {"caving-ball", 2},         {"hanging-sheet", 1},    {"lens-capsule", 5},
                  {"organ-press", 15},  {"shell-crushed", 5},       {"shrinking-torus", 24}, {"sphere-explicit", 9},
                  {"sphere-press", 12}, {"sphere-press-hollow", 9}, {"sphere-refine", 15},   {"twisted-tube", 2}};
    if (is_all())
        return 0;
    for (size_t i = 0; i < sizeof scenes / sizeof *scenes; i++)
        if (strcmp(scenes[i].name, name) == 0)
            return (scenes[i].frames + 1) / 2;
    return 3;
}

static void test_shipped_scenes(void **unused)
{
    (void)unused;
    DIR *stream = opendir(PEL_SOURCE_DIR "/scenes");
    assert_non_null(stream);
    int count = 0;
    for (struct dirent *entry = readdir(stream); entry != NULL; entry = readdir(stream)) {
        char path[512], name[64];
        const char *end = strstr(entry->d_name, ".yaml");
        if (end == NULL)
            continue;
        pel_scene *scene;
        snprintf(path, sizeof path, PEL_SOURCE_DIR "/scenes/%.200s", entry->d_name);
        snprintf(name, sizeof name, "%.*s", (int)(end - entry->d_name), entry->d_name);
        assert_int_equal(pel_scene_load(path, NULL, 0, NULL, &scene, NULL), PEL_OK);
        if (count % ROUNDS(1, 2) == 0)
            check_stops(scene, name, frames_of(name));
        pel_scene_destroy(scene);
        count++;
    }
    closedir(stream);
    assert_true(count >= 11);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_shipped_scenes)};
    thread_count = 1;
    return cmocka_run_group_tests(tests, make_folder, clear_folder);
}
