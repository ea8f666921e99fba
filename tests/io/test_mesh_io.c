#include "failing_malloc.h"
#include "parse.h"
#include "random.h"
#include "source_dir.h"

#include <sys/stat.h>
#include <unistd.h>

#define DATA PEL_SOURCE_DIR "/../shared/data/"

static const char *const scratch_file = "mesh-io-test.tmp";

static void test_format_of_path(void **unused)
{
    (void)unused;
    assert_int_equal(pel_mesh_format_of_path("a.obj"), PEL_FORMAT_OBJ);
    assert_int_equal(pel_mesh_format_of_path("a.b/c.PLY"), PEL_FORMAT_PLY);
    assert_int_equal(pel_mesh_format_of_path(".Stl"), PEL_FORMAT_STL);
    assert_int_equal(pel_mesh_format_of_path("x.off"), PEL_FORMAT_OFF);
    assert_int_equal(pel_mesh_format_of_path("x.offs"), PEL_FORMAT_AUTO);
    assert_int_equal(pel_mesh_format_of_path("x.of"), PEL_FORMAT_AUTO);
    assert_int_equal(pel_mesh_format_of_path("x.obj.gz"), PEL_FORMAT_AUTO);
    assert_int_equal(pel_mesh_format_of_path("x.obj#"), PEL_FORMAT_AUTO);
    assert_int_equal(pel_mesh_format_of_path("obj"), PEL_FORMAT_AUTO);
    assert_int_equal(pel_mesh_format_of_path(""), PEL_FORMAT_AUTO);
}

/* positions of all sizes (floats when asked for), each vertex used, in the order of their numbers */
static pel_mesh *random_mesh(random_state *random, bool floats)
{
    double positions[300];
    int32_t triangles[300], vertex_count = 3 * (int32_t)random_integer(random, 1, 33);
    for (int32_t i = 0; i < 3 * vertex_count; i++) {
        double value = random_normal(random) * pow(10, random_between(random, -20, 20));
        positions[i] = floats ? (double)(float)value : value;
    }
    for (int32_t i = 0; i < vertex_count; i++)
        triangles[i] = i;
    pel_mesh *mesh;
    assert_int_equal(pel_mesh_create(positions, vertex_count, triangles, vertex_count / 3, &mesh, NULL), PEL_OK);
    return mesh;
}

static pel_mesh *write_and_read(const pel_mesh *mesh, pel_mesh_format format)
{
    pel_error error;
    char text[700];
    pel_mesh *back = NULL;
    if (pel_mesh_write(scratch_file, format, mesh, NULL, &error) != PEL_OK ||
        pel_mesh_read(scratch_file, PEL_FORMAT_AUTO, NULL, &back, &error) != PEL_OK)
        fail_msg("%s", pel_error_text(&error, text, sizeof text));
    return back;
}

/* bit for bit, detected by content alone */
static void test_round_trips(void **unused)
{
    (void)unused;
    random_state random = {.seed = 5};
    for (int i = 0; i < 200; i++) {
        for (int format = PEL_FORMAT_OBJ; format < PEL_FORMAT_COUNT; format++) {
            pel_mesh *mesh = random_mesh(&random, format == PEL_FORMAT_STL);
            pel_mesh *back = write_and_read(mesh, (pel_mesh_format)format);
            check_same_mesh(back, mesh);
            pel_mesh_destroy(back);
            pel_mesh_destroy(mesh);
        }
    }
    unlink(scratch_file);
}

static void test_fields_round_trip(void **unused)
{
    (void)unused;
    random_state random = {.seed = 6};
    const pel_mesh_format formats[3] = {PEL_FORMAT_PLY, PEL_FORMAT_PLY_ASCII, PEL_FORMAT_PLY_BIG};
    for (int i = 0; i < 60; i++) {
        pel_mesh *mesh = random_mesh(&random, false);
        double values[1000], bytes[100];
        for (int k = 0; k < 1000; k++)
            values[k] = random_normal(&random);
        for (int k = 0; k < 100; k++)
            bytes[k] = (double)random_integer(&random, 0, 255);
        assert_int_equal(pel_mesh_add_field(mesh, "thickness", 1, values, NULL), PEL_OK);
        assert_int_equal(pel_mesh_add_field(mesh, "fibre", 3, values + 100, NULL), PEL_OK);
        assert_int_equal(pel_mesh_add_field(mesh, "red", 1, bytes, NULL), PEL_OK);
        assert_int_equal(pel_mesh_add_field(mesh, "blue", 1, values + 400, NULL), PEL_OK);
        pel_mesh *back = write_and_read(mesh, formats[i % 3]);
        check_same_mesh(back, mesh);
        assert_int_equal(back->field_count, mesh->field_count);
        for (int32_t f = 0; f < mesh->field_count; f++) {
            const pel_field *field = &mesh->fields[f], *read = &back->fields[f];
            assert_string_equal(read->name, field->name);
            assert_int_equal(read->component_count, field->component_count);
            assert_memory_equal(read->values, field->values,
                                sizeof(double) * (size_t)(mesh->vertex_count * field->component_count));
        }
        pel_mesh_destroy(back);
        pel_mesh_destroy(mesh);
    }
    unlink(scratch_file);
}

static pel_mesh *small_mesh(void)
{
    const double positions[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    const int32_t triangle[3] = {0, 1, 2};
    pel_mesh *mesh;
    assert_int_equal(pel_mesh_create(positions, 3, triangle, 1, &mesh, NULL), PEL_OK);
    return mesh;
}

static void test_fields_dropped_with_a_note(void **unused)
{
    (void)unused;
    notes said;
    pel_log log = log_to(&said);
    pel_mesh *mesh = small_mesh(), *back;
    pel_mesh_add_field(mesh, "x", 1, NULL, NULL);
    pel_mesh_add_field(mesh, "two words", 1, NULL, NULL);
    pel_mesh_add_field(mesh, "kept", 1, NULL, NULL);
    assert_int_equal(pel_mesh_write(scratch_file, PEL_FORMAT_PLY, mesh, &log, NULL), PEL_OK);
    assert_non_null(strstr(said.text, "field 'x' dropped"));
    assert_non_null(strstr(said.text, "field 'two words' dropped"));
    assert_int_equal(pel_mesh_read(scratch_file, PEL_FORMAT_AUTO, NULL, &back, NULL), PEL_OK);
    assert_int_equal(back->field_count, 1);
    pel_mesh_destroy(back);
    assert_int_equal(pel_mesh_write(scratch_file, PEL_FORMAT_OBJ, mesh, &log, NULL), PEL_OK);
    assert_non_null(strstr(said.text, "3 vertex fields dropped: only PLY and VTP hold them"));
    pel_mesh_destroy(mesh);
    unlink(scratch_file);
}

static void check_write_failure(const char *path, pel_mesh_format format, const pel_mesh *mesh, pel_status expected,
                                const char *words)
{
    pel_error error = {0};
    char text[700];
    assert_int_equal(pel_mesh_write(path, format, mesh, NULL, &error), expected);
    pel_error_text(&error, text, sizeof text);
    if (strstr(text, words) == NULL || error.remedy[0] == '\0')
        fail_msg("'%s' does not say '%s'", text, words);
}

static void test_write_failures(void **unused)
{
    (void)unused;
    pel_mesh *mesh = small_mesh();
    check_write_failure("a.xyz", PEL_FORMAT_AUTO, mesh, PEL_BAD_ARGUMENT, "extension");
    check_write_failure("a.obj", PEL_FORMAT_COUNT, mesh, PEL_BAD_ARGUMENT, "extension");
    check_write_failure("not/there/a.obj", PEL_FORMAT_AUTO, mesh, PEL_BAD_FILE, "No such file");
    if (access("/dev/full", W_OK) == 0)
        for (int format = PEL_FORMAT_OBJ; format < PEL_FORMAT_COUNT; format++)
            check_write_failure("/dev/full", (pel_mesh_format)format, mesh, PEL_BAD_FILE, "No space left");
    mesh->positions[1][0] = 1e300;
    check_write_failure("never.stl", PEL_FORMAT_AUTO, mesh, PEL_BAD_ARGUMENT, "vertex 1: coordinate 1e+300");
    mesh->positions[1][0] = (double)NAN;
    check_write_failure("never.ply", PEL_FORMAT_AUTO, mesh, PEL_BAD_ARGUMENT,
                        "vertex 1: a value of 'positions' is nan");
    assert_int_equal(access("never.stl", F_OK), -1);
    assert_int_equal(access("never.ply", F_OK), -1);
    pel_mesh_destroy(mesh);
}

static void check_read_failure(const char *path, pel_status expected, const char *words)
{
    pel_error error = {0};
    char text[700];
    pel_mesh *mesh = (pel_mesh *)(uintptr_t)1;
    assert_int_equal(pel_mesh_read(path, PEL_FORMAT_AUTO, NULL, &mesh, &error), expected);
    assert_null(mesh);
    pel_error_text(&error, text, sizeof text);
    if (strstr(text, words) == NULL || strstr(text, path) == NULL || error.remedy[0] == '\0')
        fail_msg("'%s' does not say '%s' and '%s'", text, path, words);
}

static void test_read_failures(void **unused)
{
    (void)unused;
    check_read_failure("not/there.obj", PEL_BAD_FILE, "No such file");
    check_read_failure(".", PEL_BAD_FILE, "directory");
    check_read_failure("/dev/null", PEL_BAD_FILE, "it is a device");
    FILE *stream = fopen(scratch_file, "wb");
    fclose(stream);
    check_read_failure(scratch_file, PEL_BAD_FORMAT, "empty");
    stream = fopen(scratch_file, "wb");
    fputs("what is this", stream);
    fclose(stream);
    check_read_failure(scratch_file, PEL_BAD_FORMAT, "neither the extension nor the content");
    unlink(scratch_file);
}

/* content beats the name, the name beats a guess, a byte order mark is no matter */
static void test_detection(void **unused)
{
    (void)unused;
    const char *obj = "\xef\xbb\xbf# x\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    const char *off = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    pel_mesh_destroy(parse_text("a", obj, NULL));
    pel_mesh_destroy(parse_text("a.obj", obj, NULL));
    pel_mesh_destroy(parse_text("a.obj", off, NULL));
    pel_mesh_destroy(parse_text("a.stl", off, NULL));
    refuse_text("a.ply", obj, "does not begin with 'ply'");
    pel_mesh *mesh;
    assert_int_equal(pel_mesh_parse("a.ply", obj, strlen(obj), PEL_FORMAT_OBJ, NULL, &mesh, NULL), PEL_OK);
    pel_mesh_destroy(mesh);
}

static void check_file(const char *name, int32_t vertex_count, int32_t triangle_count)
{
    char path[600], text[700];
    pel_mesh *mesh;
    pel_error error;
    snprintf(path, sizeof path, PEL_SOURCE_DIR "/%s", name);
    if (pel_mesh_read(path, PEL_FORMAT_AUTO, NULL, &mesh, &error) != PEL_OK)
        fail_msg("%s", pel_error_text(&error, text, sizeof text));
    check_counts(mesh, vertex_count, triangle_count);
    pel_mesh_destroy(mesh);
}

/* files of the tree, and real ones where they are at hand */
static void test_real_files(void **unused)
{
    (void)unused;
    check_file("tests/data/bean.obj", 812, 1620);
    check_file("tests/data/sac.obj", 492, 980);
    check_file("tests/data/flap.obj", 305, 562);
    if (access(DATA "README.md", R_OK) != 0)
        return;
    check_file("../shared/data/liver.obj", 17951, 35898);
    check_file("../shared/data/spleen.obj", 4274, 8544);
    check_file("../shared/data/membrane.obj", 6368, 12448);
    check_file("../shared/data/sphere-252.obj", 252, 500);
    check_file("../shared/data/nefertiti-head.obj", 12442, 24880);
    check_file("../shared/data/gallbladder.obj", 997, 1990);
    check_file("../shared/data/formats/gallbladder.stl", 997, 1990);
    check_file("../shared/data/formats/gallbladder.ply", 997, 1990);
    check_file("../shared/data/formats/gallbladder-ascii.ply", 997, 1990);
    check_file("../shared/data/formats/gallbladder.off", 997, 1990);
    check_file("../shared/data/formats/spot-quads.obj", 188, 372);
}

static pel_status write_case(const void *format, pel_error *error)
{
    /* made here, so that its allocations are counted too */
    const double positions[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    const int32_t triangle[3] = {0, 1, 2};
    pel_mesh *mesh, *back = NULL;
    pel_status status = pel_mesh_create(positions, 3, triangle, 1, &mesh, error);
    if (status == PEL_OK)
        status = pel_mesh_add_field(mesh, "a", 2, positions, error);
    if (status == PEL_OK)
        status = pel_mesh_write(scratch_file, *(const pel_mesh_format *)format, mesh, NULL, error);
    if (status == PEL_OK)
        status = pel_mesh_read(scratch_file, PEL_FORMAT_AUTO, NULL, &back, error);
    pel_mesh_destroy(mesh);
    pel_mesh_destroy(back);
    return status;
}

static void test_allocation_failures(void **unused)
{
    (void)unused;
    for (int format = PEL_FORMAT_OBJ; format < PEL_FORMAT_COUNT; format++) {
        const pel_mesh_format tried = (pel_mesh_format)format;
        assert_true(for_every_allocation_failure(write_case, &tried) >= 10);
    }
    unlink(scratch_file);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_format_of_path),      cmocka_unit_test(test_round_trips),
        cmocka_unit_test(test_fields_round_trip),   cmocka_unit_test(test_fields_dropped_with_a_note),
        cmocka_unit_test(test_write_failures),      cmocka_unit_test(test_read_failures),
        cmocka_unit_test(test_detection),           cmocka_unit_test(test_real_files),
        cmocka_unit_test(test_allocation_failures),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
