/* Pages that have the simulation in them: scene and meshes inside, no path of this machine, nothing left on failure. */
#include "check.h"
#include "failing_malloc.h"

#include <pellicle/mesh_io.h>
#include <pellicle/server.h>
#include <pellicle/shape.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static const char template_path[] = "page-template.html";
static const char template_text[] = "<body>before<!--pellicle scene, format 1-->after</body>";

static void write_text(const char *path, const char *text)
{
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    assert_true(fputs(text, file) >= 0);
    assert_int_equal(fclose(file), 0);
}

/* the whole file, to be freed; null if there is none */
static char *read_text(const char *path)
{
    FILE *file = fopen(path, "r");
    if (file == NULL)
        return NULL;
    char *text = calloc(1, 1 << 20);
    assert_non_null(text);
    assert_true(fread(text, 1, (1 << 20) - 1, file) > 0);
    fclose(file);
    return text;
}

static void write_mesh(const char *path, int32_t frequency)
{
    pel_shape_def def;
    pel_mesh *mesh;
    assert_int_equal(pel_shape_def_of_name("geodesic-sphere", &def, NULL), PEL_OK);
    assert_int_equal(pel_shape_set_number(&def, "frequency", frequency, NULL), PEL_OK);
    assert_int_equal(pel_shape_create(&def, &mesh, NULL), PEL_OK);
    assert_int_equal(pel_mesh_write(path, PEL_FORMAT_AUTO, mesh, NULL, NULL), PEL_OK);
    pel_mesh_destroy(mesh);
}

static pel_scene *parse(const char *text)
{
    pel_scene *scene;
    pel_error error;
    if (pel_scene_parse("page.yaml", text, strlen(text), NULL, 0, NULL, &scene, &error) != PEL_OK)
        fail_msg("%s", error.what);
    return scene;
}

static const char spheres[] =
    "version: 1\ntitle: \"</script>\"\nbodies:\n"
    "  - { name: a, mesh: { file: one/ball.ply }, springs: { stiffness: 3, damping: 0.01 } }\n"
    "  - { name: b, mesh: { file: two/ball.ply, translate: [5, 0, 0] }, springs: { stiffness: 3, damping: 0.01 } }\n"
    "  - { name: c, mesh: { file: one/ball.ply, translate: [10, 0, 0] }, springs: { stiffness: 3, damping: 0.01 } }\n"
    "solver: { method: quasi-static, dt: 0.01 }\nduration: 1\n";

static void make_files(void)
{
    (void)mkdir("one", 0777);
    (void)mkdir("two", 0777);
    write_mesh("one/ball.ply", 2);
    write_mesh("two/ball.ply", 3);
    write_text(template_path, template_text);
}

static int count_of(const char *text, const char *words)
{
    int count = 0;
    for (const char *at = text; (at = strstr(at, words)) != NULL; at++)
        count++;
    return count;
}

static void test_what_is_inside(void **unused)
{
    (void)unused;
    char folder[4096];
    make_files();
    pel_scene *scene = parse(spheres);
    assert_int_equal(pel_page_write("page.html", template_path, scene, true, NULL), PEL_OK);
    char *text = read_text("page.html");
    assert_non_null(text);
    assert_true(strncmp(text, "<body>before<script type=\"application/json\" id=\"scene\">{\"scene\":\"", 60) == 0);
    assert_non_null(strstr(text, "</script>\nafter</body>"));
    /* equal files are inside once; another file of the same name has its own name */
    assert_non_null(strstr(text, "\"files\":[\"meshes/ball.ply\",\"meshes/2-ball.ply\"],\"paused\":true}"));
    assert_int_equal(count_of(text, "class=\"mesh\""), 2);
    assert_int_equal(count_of(text, "file: meshes/ball.ply"), 2);
    assert_int_equal(count_of(text, "file: meshes/2-ball.ply"), 1);
    /* three ends of tags, none from the title, and no path of this machine */
    assert_int_equal(count_of(text, "</script>"), 3);
    assert_non_null(getcwd(folder, sizeof folder));
    assert_null(strstr(text, folder));
    free(text);
    pel_scene_destroy(scene);
}

/* a mesh that only assimp reads becomes PLY, and temporary files are removed */
static void test_foreign_mesh(void **unused)
{
    (void)unused;
    static const char gltf[] =
        "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0}],"
        "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],"
        "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\",\"min\":[0,0,0],"
        "\"max\":[1,1,0]}],\"bufferViews\":[{\"buffer\":0,\"byteLength\":36}],\"buffers\":[{\"byteLength\":36,\"uri\":"
        "\"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA\"}]}";
    make_files();
    write_text("triangle.gltf", gltf);
    pel_scene *scene = parse("version: 1\nbodies:\n  - { mesh: { file: triangle.gltf }, springs: { stiffness: 3 } }\n"
                             "solver: { method: quasi-static, dt: 0.01 }\nduration: 1\n");
    assert_int_equal(pel_page_write("foreign.html", template_path, scene, false, NULL), PEL_OK);
    char *text = read_text("foreign.html"), passing[100];
    assert_non_null(strstr(text, "\"files\":[\"meshes/triangle.gltf.ply\"],\"paused\":false}"));
    assert_int_equal(count_of(text, "file: meshes/triangle.gltf.ply"), 1);
    snprintf(passing, sizeof passing, "foreign.html.%ld.ply", (long)getpid());
    assert_int_not_equal(access(passing, F_OK), 0);
    free(text);
    pel_scene_destroy(scene);
}

static void test_refused(void **unused)
{
    (void)unused;
    pel_error error;
    make_files();
    pel_scene *scene = parse(spheres);
    (void)remove("none.html");
    assert_int_equal(pel_page_write("none.html", "no-such-page.html", scene, false, &error), PEL_BAD_FILE);
    assert_non_null(strstr(error.remedy, "make wasm"));
    write_text("other.html", "<body></body>");
    assert_int_equal(pel_page_write("none.html", "other.html", scene, false, &error), PEL_BAD_FORMAT);
    assert_non_null(strstr(error.remedy, "make wasm"));
    write_text("other.html", "<body><!--pellicle scene, format 0--></body>");
    assert_int_equal(pel_page_write("none.html", "other.html", scene, false, &error), PEL_BAD_FORMAT);
    assert_non_null(strstr(error.what, "another version"));
    assert_int_equal(pel_page_write("no-such-folder/none.html", template_path, scene, false, &error), PEL_BAD_FILE);
    /* a mesh that went away since */
    (void)remove("two/ball.ply");
    assert_int_equal(pel_page_write("none.html", template_path, scene, false, &error), PEL_BAD_FILE);
    assert_non_null(strstr(error.file, "two/ball.ply"));
    pel_scene_destroy(scene);
    /* a scene that reads well and cannot be simulated */
    scene = parse("version: 1\nbodies:\n  - { mesh: { shape: geodesic-sphere }, mass: { total: 1 }, springs: { "
                  "stiffness: 3e9 } }\n"
                  "solver: { method: explicit, dt: 0.01 }\nduration: 1\n");
    assert_int_equal(pel_page_write("none.html", template_path, scene, false, &error), PEL_UNSTABLE);
    assert_int_not_equal(access("none.html", F_OK), 0);
    pel_scene_destroy(scene);
}

static pel_status write_page(const void *scene, pel_error *error)
{
    return pel_page_write("page.html", template_path, scene, false, error);
}

static void test_allocations(void **unused)
{
    (void)unused;
    make_files();
    pel_scene *scene = parse(spheres);
    assert_true(for_every_allocation_failure(write_page, scene) > 10);
    pel_scene_destroy(scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_what_is_inside), cmocka_unit_test(test_foreign_mesh),
                                       cmocka_unit_test(test_refused), cmocka_unit_test(test_allocations)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
