/* Meshes by one word: closed shapes, files in the scene's folder, refused words and paths. */
#define _XOPEN_SOURCE 700
#include "check.h"

#include "scene/word_mesh.h"

#include "failing_malloc.h"
#include "pellicle/mesh_io.h"
#include "pellicle/shape.h"
#include "pellicle/topology.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static const char text[] =
    "version: 1\nbodies: [ { mesh: { shape: geodesic-sphere, frequency: 1 }, springs: { stiffness: 1 } } ]\n"
    "solver: { method: quasi-static, dt: 0.01 }\nduration: 1\n";

static char folder[PATH_MAX];
static pel_scene *scene;

static int start(void **unused)
{
    (void)unused;
    char made[] = "/tmp/pellicle-words-XXXXXX", path[PATH_MAX + 32];
    if (mkdtemp(made) == NULL || realpath(made, folder) == NULL)
        return 1;
    pel_shape_def def = pel_shape_def_default(PEL_SHAPE_TORUS);
    pel_mesh *mesh = NULL;
    pel_shape_create(&def, &mesh, NULL);
    const char *const files[] = {"a spoon.ply", "ring.obj"};
    for (int i = 0; i < 2; i++) {
        snprintf(path, sizeof path, "%s/%s", folder, files[i]);
        pel_mesh_write(path, PEL_FORMAT_AUTO, mesh, NULL, NULL);
    }
    pel_mesh_destroy(mesh);
    snprintf(path, sizeof path, "%s/scene.yaml", folder);
    return pel_scene_parse(path, text, strlen(text), NULL, 0, NULL, &scene, NULL) != PEL_OK;
}

static int stop(void **unused)
{
    (void)unused;
    const char *const files[] = {"a spoon.ply", "ring.obj"};
    char path[PATH_MAX + 32];
    for (int i = 0; i < 2; i++) {
        snprintf(path, sizeof path, "%s/%s", folder, files[i]);
        remove(path);
    }
    pel_scene_destroy(scene);
    return rmdir(folder);
}

static void test_shapes(void **unused)
{
    (void)unused;
    const char *const words[] = {"torus", "cylinder", "blend"};
    for (int i = 0; i < 3; i++) {
        pel_mesh *mesh = NULL;
        pel_topology *topology = NULL;
        char full[100];
        assert_true(pel_word_mesh_is_one(words[i]));
        assert_int_equal(pel_word_mesh_create(scene, words[i], &mesh, full, sizeof full, NULL), PEL_OK);
        assert_string_equal(full, words[i]);
        assert_int_equal(pel_topology_create(mesh, &topology, NULL), PEL_OK);
        assert_int_equal(topology->boundary_edge_count, 0);
        pel_topology_destroy(topology);
        pel_mesh_destroy(mesh);
    }
    assert_false(pel_word_mesh_is_one("sphere"));
    assert_false(pel_word_mesh_is_one("grid"));
    assert_true(pel_word_mesh_is_one("../a%20spoon.stl"));
    assert_false(pel_word_mesh_is_one("/dev/../dev/zero"));
}

static void test_files(void **unused)
{
    (void)unused;
    pel_mesh *mesh = NULL, *again = NULL;
    char full[PATH_MAX], twice[PATH_MAX], expected[PATH_MAX + 32];
    assert_int_equal(pel_word_mesh_create(scene, "a%20spoon.ply", &mesh, full, sizeof full, NULL), PEL_OK);
    snprintf(expected, sizeof expected, "%s/a%%20spoon.ply", folder);
    assert_string_equal(full, expected);
    /* the absolute name is one from everywhere */
    assert_int_equal(pel_word_mesh_create(scene, full, &again, twice, sizeof twice, NULL), PEL_OK);
    assert_string_equal(full, twice);
    assert_int_equal(mesh->vertex_count, again->vertex_count);
    pel_mesh_destroy(mesh);
    pel_mesh_destroy(again);
}

static void test_refusals(void **unused)
{
    (void)unused;
    pel_mesh *mesh = NULL;
    pel_error error;
    char full[PATH_MAX], *word = calloc(2 * PATH_MAX, 1);
    assert_int_equal(pel_word_mesh_create(scene, "nothing.ply", &mesh, full, sizeof full, &error), PEL_BAD_FILE);
    assert_null(mesh);
    assert_non_null(strstr(error.what, "nothing.ply"));
    assert_non_null(strstr(error.remedy, folder));
    assert_int_equal(pel_word_mesh_create(scene, "ring.obj", &mesh, full, 10, &error), PEL_BAD_ARGUMENT);
    memset(word, 'x', 2 * PATH_MAX - 1);
    word[0] = '.';
    assert_int_equal(pel_word_mesh_create(scene, word, &mesh, full, sizeof full, &error), PEL_BAD_ARGUMENT);
    free(word);
}

static void note(void *seen, const char *word)
{
    strcat(strcat(seen, word), " ");
}

static void test_list(void **unused)
{
    (void)unused;
    char seen[1000] = "";
    pel_word_mesh_list(scene, note, seen);
    assert_non_null(strstr(seen, "torus cylinder blend "));
    assert_non_null(strstr(seen, "a%20spoon.ply "));
    assert_non_null(strstr(seen, "ring.obj "));
    assert_null(strstr(seen, "yaml"));
    /* of many files only some are offered */
    char *many = calloc(200, 32), path[PATH_MAX + 32];
    assert_non_null(many);
    for (int made = 1; made >= 0; made--)
        for (int i = 0; i < 120; i++) {
            snprintf(path, sizeof path, "%s/many-%03d.obj", folder, i);
            FILE *file = made == 1 ? fopen(path, "w") : NULL;
            if (file != NULL)
                fclose(file);
            else
                remove(path);
            if (made == 1 && i == 119)
                pel_word_mesh_list(scene, note, many);
        }
    int count = 0;
    for (const char *at = many; *at != '\0'; at++)
        count += *at == ' ';
    assert_int_equal(count, 4 + 100);
    free(many);
}

static pel_status create_ring(const void *unused, pel_error *error)
{
    (void)unused;
    pel_mesh *mesh = NULL;
    char full[PATH_MAX];
    pel_status status = pel_word_mesh_create(scene, "ring.obj", &mesh, full, sizeof full, error);
    assert_true((status == PEL_OK) == (mesh != NULL));
    pel_mesh_destroy(mesh);
    return status;
}

static void test_memory(void **unused)
{
    (void)unused;
    for_every_allocation_failure(create_ring, NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_shapes), cmocka_unit_test(test_files),  cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_list),   cmocka_unit_test(test_memory),
    };
    return cmocka_run_group_tests(tests, start, stop);
}
