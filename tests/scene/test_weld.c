/* Seams of mesh files in scenes. */
#include "check.h"
#include "failing_malloc.h"

#include "pellicle/scene.h"

#include <unistd.h>

#define FILE_NAME "scene-weld.obj"

/* two triangles that share the edge from (0, 0) to (1, 0), given twice */
static void write_mesh(void)
{
    FILE *stream = fopen(FILE_NAME, "wb");
    assert_non_null(stream);
    fputs("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 0 0\nv 0 0 0\nv 0 -1 0\nf 1 2 3\nf 4 5 6\n", stream);
    fclose(stream);
}

static pel_status load(const char *mesh_keys, const char *pinned, pel_scene **scene, pel_error *error)
{
    char text[500];
    snprintf(text, sizeof text,
             "version: 1\nbodies:\n  - mesh: { file: " FILE_NAME "%s }\n    membrane: { preset: rubber }\n"
             "    pinned: { vertices: %s }\nduration: 1\n",
             mesh_keys, pinned);
    return pel_scene_parse("weld.yaml", text, strlen(text), NULL, 0, NULL, scene, error);
}

static void test_weld(void **unused)
{
    (void)unused;
    pel_scene *scene;
    pel_error error;
    write_mesh();
    assert_int_equal(load("", "[3, 5]", &scene, &error), PEL_OK);
    const pel_body_def *body = &scene->model.bodies[0];
    assert_int_equal(body->mesh->vertex_count, 4);
    /* vertices 3 and 5 of the file are 1 and 3 of the mesh */
    assert_int_equal(body->pinned_count, 2);
    assert_true(body->pinned[0] == 1 && body->pinned[1] == 3);
    const pel_field *first = pel_mesh_field(body->mesh, "file_vertex");
    assert_non_null(first);
    assert_true(first->values[1] == 1 && first->values[3] == 5);
    assert_non_null(strstr(pel_scene_text(scene), "weld: true"));
    pel_scene_destroy(scene);
    assert_int_equal(load(", weld: false", "[3, 5]", &scene, &error), PEL_OK);
    assert_int_equal(scene->model.bodies[0].mesh->vertex_count, 6);
    assert_true(scene->model.bodies[0].pinned[0] == 3);
    assert_null(pel_mesh_field(scene->model.bodies[0].mesh, "file_vertex"));
    pel_scene_destroy(scene);
    assert_int_equal(load("", "[6]", &scene, &error), PEL_BAD_SCENE);
    assert_non_null(strstr(error.what, "no vertex 6"));
    assert_non_null(strstr(error.remedy, "0 to 5"));
    unlink(FILE_NAME);
}

static pel_status load_case(const void *unused, pel_error *error)
{
    (void)unused;
    pel_scene *scene;
    pel_status status = load("", "[3]", &scene, error);
    pel_scene_destroy(scene);
    return status;
}

static void test_allocation_failures(void **unused)
{
    (void)unused;
    write_mesh();
    assert_true(for_every_allocation_failure(load_case, NULL) >= 20);
    unlink(FILE_NAME);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_weld),
        cmocka_unit_test(test_allocation_failures),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
