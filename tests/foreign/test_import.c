#include "check.h"
#include "failing_malloc.h"

#include "../io/parse.h"
#include "gltf_text.h"
#include "pellicle/import.h"

#include <unistd.h>

static const char *const scratch_file = "import-test.gltf";

/* A square of two triangles that share no vertex (6 corners at 4 places), used by two nodes: one moved by 10 in x and
   doubled, one below it mirrored in x and moved by 1 in z. */
static void write_gltf(void)
{
    static const float corners[6][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    char bytes[84], text[200];
    for (int i = 0; i < 18; i++)
        pel_store_float(bytes + 4 * i, false, corners[i / 3][i % 3]);
    for (int i = 0; i < 6; i++)
        pel_store_bytes(bytes + 72 + 2 * i, 2, false, (uint64_t)i);
    gltf_base64(bytes, sizeof bytes, text);
    FILE *stream = fopen(scratch_file, "wb");
    assert_non_null(stream);
    fprintf(stream,
            "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],"
            "\"nodes\":[{\"mesh\":0,\"translation\":[10,0,0],\"scale\":[2,2,2],\"children\":[1]},"
            "{\"mesh\":0,\"scale\":[-1,1,1],\"translation\":[0,0,1]}],"
            "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1}]}],"
            "\"buffers\":[{\"byteLength\":84,\"uri\":\"data:application/octet-stream;base64,%s\"}],"
            "\"bufferViews\":[{\"buffer\":0,\"byteLength\":72},{\"buffer\":0,\"byteOffset\":72,\"byteLength\":12}],"
            "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":6,\"type\":\"VEC3\",\"min\":[0,0,0],"
            "\"max\":[1,1,0]},{\"bufferView\":1,\"componentType\":5123,\"count\":6,\"type\":\"SCALAR\"}]}",
            text);
    fclose(stream);
}

static void test_gltf(void **unused)
{
    (void)unused;
    notes said;
    pel_log log = log_to(&said);
    pel_mesh *mesh;
    pel_error error;
    char text[700];
    write_gltf();
    if (pel_mesh_import(scratch_file, &log, &mesh, &error) != PEL_OK)
        fail_msg("%s", pel_error_text(&error, text, sizeof text));
    check_counts(mesh, 8, 4);
    check_position(mesh, 0, 10, 0, 0);
    check_position(mesh, 2, 12, 2, 0);
    check_triangle(mesh, 0, 0, 1, 2);
    check_triangle(mesh, 1, 0, 2, 3);
    /* the mirrored square turns its triangles, so that they face the same way */
    for (int32_t t = 0; t < 4; t++) {
        const double *p = mesh->positions[mesh->triangles[t][0]], *q = mesh->positions[mesh->triangles[t][1]],
                     *r = mesh->positions[mesh->triangles[t][2]];
        assert_near(p[2], t < 2 ? 0 : 2, 0);
        assert_near((q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]), 4, 0);
    }
    assert_non_null(strstr(said.text, "2 meshes of the scene joined"));
    assert_non_null(strstr(said.text, "12 vertices on seams welded into 8"));
    pel_mesh_destroy(mesh);
    unlink(scratch_file);
}

static void check_failure(const char *path, pel_status expected, const char *words)
{
    pel_error error = {0};
    char text[700];
    pel_mesh *mesh = (pel_mesh *)(uintptr_t)1;
    assert_int_equal(pel_mesh_import(path, NULL, &mesh, &error), expected);
    assert_null(mesh);
    pel_error_text(&error, text, sizeof text);
    if (strstr(text, words) == NULL || strstr(text, path) == NULL || error.remedy[0] == '\0')
        fail_msg("'%s' does not say '%s' and '%s'", text, path, words);
}

static void write_text(const char *path, const char *text)
{
    FILE *stream = fopen(path, "wb");
    assert_non_null(stream);
    fputs(text, stream);
    fclose(stream);
}

static void test_failures(void **unused)
{
    (void)unused;
    check_failure("not-there.gltf", PEL_BAD_FILE, "No such file");
    check_failure("not-there.obj", PEL_BAD_FILE, "No such file");
    write_text(scratch_file, "{}");
    check_failure(scratch_file, PEL_BAD_FORMAT, "error: ");
    write_text(scratch_file, "");
    check_failure(scratch_file, PEL_BAD_FORMAT, "error: ");
    write_text(scratch_file,
               "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{}]}");
    check_failure(scratch_file, PEL_BAD_FORMAT, "no triangles");
    unlink(scratch_file);
    write_text("import-test.xyz", "nothing");
    check_failure("import-test.xyz", PEL_BAD_FORMAT, "neither the extension nor the content");
    unlink("import-test.xyz");
}

/* our own formats are read by our own readers: vertices keep their order and are not welded */
static void test_own_formats(void **unused)
{
    (void)unused;
    pel_mesh *mesh;
    write_text("import-test.obj", "v 5 0 0\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 0\nf 2 3 4\n");
    assert_int_equal(pel_mesh_import("import-test.obj", NULL, &mesh, NULL), PEL_OK);
    check_counts(mesh, 5, 1);
    pel_mesh_destroy(mesh);
    unlink("import-test.obj");
}

static pel_status import_case(const void *unused, pel_error *error)
{
    (void)unused;
    pel_mesh *mesh;
    pel_status status = pel_mesh_import(scratch_file, NULL, &mesh, error);
    if (status != PEL_OK)
        assert_null(mesh);
    pel_mesh_destroy(mesh);
    return status;
}

static void test_allocation_failures(void **unused)
{
    (void)unused;
    write_gltf();
    assert_true(for_every_allocation_failure(import_case, NULL) >= 7);
    unlink(scratch_file);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_gltf),
        cmocka_unit_test(test_failures),
        cmocka_unit_test(test_own_formats),
        cmocka_unit_test(test_allocation_failures),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
