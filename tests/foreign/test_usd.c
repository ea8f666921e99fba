/* The reader of USD: prims, places, samples; what is left out is told, what is damaged is refused with its place. */
#include "check.h"
#include "failing_malloc.h"

#include "../export/export_folder.h"
#include "../fuzz_scene/fuzz_usd.h"
#include "../io/parse.h"
#include "base/memory.h"
#include "foreign/usd.h"
#include "io/file.h"
#include "pellicle/export.h"
#include "pellicle/import.h"
#include "source_dir.h"

#include <dirent.h>

#define HEAD "#usda 1.0\n(\n metersPerUnit = 1\n)\n"
#define FACE "int[] faceVertexCounts = [3]\nint[] faceVertexIndices = [0, 1, 2]\n"
#define POINTS "point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]\n"
#define MESH(more) "def Mesh \"m\"\n{\n" FACE POINTS more "\n}\n"

static pel_mesh *parse_usd(const char *text, notes *said)
{
    pel_mesh *mesh;
    pel_error error;
    char words[700];
    pel_log log = {0};
    if (said != NULL)
        log = log_to(said);
    if (pel_usd_parse("a.usda", text, strlen(text), &log, &mesh, &error) != PEL_OK)
        fail_msg("%s\n%.1500s", pel_error_text(&error, words, sizeof words), text);
    return mesh;
}

/* line: where the error must be; 0 = anywhere in the file */
static void refuse_usd(const char *text, int line, const char *words)
{
    pel_mesh *mesh = (pel_mesh *)(uintptr_t)1;
    pel_error error = {0};
    char said[700] = "";
    pel_status status = pel_usd_parse("a.usda", text, strlen(text), NULL, &mesh, &error);
    if (status != PEL_OK)
        pel_error_text(&error, said, sizeof said);
    if (status != PEL_BAD_FORMAT || mesh != NULL || strstr(said, words) == NULL || strstr(said, "a.usda") == NULL ||
        error.remedy[0] == '\0' || (line > 0 && error.line != line))
        fail_msg("expected '%s' in line %d, got '%s' for\n%.1500s", words, line, said, text);
}

static void check_vertex(const pel_mesh *mesh, int32_t v, double x, double y, double z)
{
    assert_near(mesh->positions[v][0], x, 1e-14);
    assert_near(mesh->positions[v][1], y, 1e-14);
    assert_near(mesh->positions[v][2], z, 1e-14);
}

/* text of a file of the corpus; to be freed */
static char *read_corpus(const char *name, size_t *size)
{
    char path[1000], *bytes;
    snprintf(path, sizeof path, PEL_SOURCE_DIR "/tests/fuzz_scene/corpus_usd/%s", name);
    assert_int_equal(pel_file_read(path, &bytes, size, NULL), PEL_OK);
    return bytes;
}

/* ---- meshes ---- */

/* centimetres, scaled by 2, turned by 90 degrees about x then z, shifted: (x, y, 0) goes to (1, x, y) 2 cm + (1, 0, 0)
 * m */
static void test_blender(void **unused)
{
    (void)unused;
    size_t size;
    char *text = read_corpus("blender.usda", &size);
    notes said;
    pel_mesh *mesh = parse_usd(text, &said);
    assert_int_equal(mesh->vertex_count, 4);
    assert_int_equal(mesh->triangle_count, 2);
    check_vertex(mesh, 0, 1, 0, 0);
    check_vertex(mesh, 1, 1, 0.02, 0);
    check_vertex(mesh, 2, 1, 0.02, 0.02);
    check_vertex(mesh, 3, 1, 0, 0.02);
    assert_non_null(strstr(said.text, "coordinates multiplied by metersPerUnit = 0.01"));
    assert_non_null(strstr(said.text, "upAxis = \"Y\""));
    pel_mesh_destroy(mesh);
    pel_free(text);
}

/* each operation against the point (1, 0, 0) */
static void test_places(void **unused)
{
    (void)unused;
    static const struct {
        const char *ops, *order;
        double x, y, z;
    } cases[] = {
        {"double big = 1e+20\nfloat xformOp:rotateZ = +9e+1", "\"xformOp:rotateZ\"", 0, 1, 0},
        {"float xformOp:rotateY = 90", "\"xformOp:rotateY\"", 0, 0, -1},
        {"float3 xformOp:rotateXYZ = (90, 0, 90)", "\"xformOp:rotateXYZ\"", 0, 1, 0},
        {"float3 xformOp:rotateZYX = (90, 0, 90)", "\"xformOp:rotateZYX\"", 0, 0, 1},
        {"quatf xformOp:orient = (1, 0, 0, 1)", "\"xformOp:orient\"", 0, 1, 0},
        {"double3 xformOp:scale = (-3, 1, 1)", "\"xformOp:scale\"", -3, 0, 0},
        {"matrix4d xformOp:transform = ((0, 2, 0, 0), (1, 0, 0, 0), (0, 0, 1, 0), (5, 6, 7, 1))",
         "\"xformOp:transform\"", 5, 8, 7},
        {"double3 xformOp:translate = (4, 0, 0)\nfloat3 xformOp:scale = (3, 1, 1)",
         "\"xformOp:translate\", \"xformOp:scale\"", 7, 0, 0},
        {"double3 xformOp:translate = (4, 0, 0)\nfloat3 xformOp:scale = (3, 1, 1)",
         "\"xformOp:scale\", \"xformOp:translate\"", 15, 0, 0},
        {"float3 xformOp:translate:pivot = (1, 1, 0)\nfloat xformOp:rotateZ = 90",
         "'xformOp:translate:pivot', \"xformOp:rotateZ\", '!invert!xformOp:translate:pivot'", 2, 1, 0},
        {"float3 xformOp:translate = (9, 9, 9)", "", 1, 0, 0}, /* what the order does not name is not applied */
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[1000];
        snprintf(text, sizeof text, HEAD MESH("%s\nuniform token[] xformOpOrder = [%s]"), cases[i].ops, cases[i].order);
        pel_mesh *mesh = parse_usd(text, NULL);
        check_vertex(mesh, 1, cases[i].x, cases[i].y, cases[i].z);
        pel_mesh_destroy(mesh);
    }
}

/* prims in prims; the prim that resets stands in the stage, whose unit stays */
static void test_nesting(void **unused)
{
    (void)unused;
    static const char shift[] = "double3 xformOp:translate = (1, 0, 0)\n";
    char text[2000];
    snprintf(text, sizeof text,
             "#usda 1.0\n( metersPerUnit = 0.5 )\ndef Xform \"a\" {\n%suniform token[] xformOpOrder = "
             "[\"xformOp:translate\"]\ndef \"b\" {\n" MESH(
                 "") "def Mesh \"n\" {\n" FACE POINTS
                     "%suniform token[] xformOpOrder = [\"!resetXformStack!\", \"xformOp:translate\"]\n}\n}\n}\n",
             shift, shift);
    notes said;
    pel_mesh *mesh = parse_usd(text, &said);
    assert_int_equal(mesh->vertex_count, 6);
    check_vertex(mesh, 0, 0.5, 0, 0);
    check_vertex(mesh, 1, 1, 0, 0);
    check_vertex(mesh, 4, 1, 0, 0);
    check_triangle(mesh, 1, 3, 4, 5);
    assert_non_null(strstr(said.text, "2 meshes of the stage joined"));
    pel_mesh_destroy(mesh);
}

/* turned by a mirror, by orientation, by both */
static void test_orientation(void **unused)
{
    (void)unused;
    static const char mirror[] = "float3 xformOp:scale = (1, 1, -1)\ntoken[] xformOpOrder = [\"xformOp:scale\"]\n",
                      left[] = "uniform token orientation = \"leftHanded\"\n";
    for (int i = 0; i < 4; i++) {
        char text[1000];
        snprintf(text, sizeof text, HEAD MESH("%s%s"), i & 1 ? mirror : "", i & 2 ? left : "");
        pel_mesh *mesh = parse_usd(text, NULL);
        if (i == 1 || i == 2)
            check_triangle(mesh, 0, 2, 1, 0);
        else
            check_triangle(mesh, 0, 0, 1, 2);
        pel_mesh_destroy(mesh);
    }
}

/* classes, variants, references, skeletons and shapes are left out and told; holes are open; faces of two corners go */
static void test_left_out(void **unused)
{
    (void)unused;
    size_t size;
    char *text = read_corpus("composed.usda", &size);
    notes said;
    pel_mesh *mesh = parse_usd(text, &said);
    assert_int_equal(mesh->vertex_count, 5);
    assert_int_equal(mesh->triangle_count, 2);
    check_vertex(mesh, 0, 1, -1, 0);
    assert_non_null(strstr(said.text, "1 meshes left out"));
    assert_non_null(strstr(said.text, "1 skeletons left out"));
    assert_non_null(strstr(said.text, "3 references, layers or variants not followed"));
    assert_non_null(strstr(said.text, "no metersPerUnit"));
    pel_mesh_destroy(mesh);
    pel_free(text);
    static const char *const hidden[] = {"token visibility = \"invisible\"", "uniform token purpose = \"proxy\""};
    for (size_t i = 0; i < sizeof hidden / sizeof *hidden; i++) {
        char both[1000];
        snprintf(both, sizeof both, HEAD "def \"a\" {\n" MESH("") "%s\n}\n" MESH(""), hidden[i]);
        mesh = parse_usd(both, NULL);
        assert_int_equal(mesh->vertex_count, 3);
        pel_mesh_destroy(mesh);
    }
}

/* ---- time ---- */

/* points until code 5, a prim until code 10, at 10 codes a second; a matrix that turns x to y */
static void test_samples(void **unused)
{
    (void)unused;
    size_t size;
    char *text = read_corpus("moving.usda", &size);
    pel_sequence *sequence;
    double x[3][3];
    assert_int_equal(pel_usd_parse_sequence("a.usda", text, size, &sequence, NULL), PEL_OK);
    assert_int_equal(pel_sequence_frame_count(sequence), 3);
    assert_int_equal(pel_sequence_vertex_count(sequence), 3);
    static const double times[] = {0, 0.5, 1}, along[] = {0, 1, 1}, high[] = {0, 2.5, 5};
    for (int f = 0; f < 3; f++) {
        assert_near(pel_sequence_time(sequence, f), times[f], 1e-15);
        pel_sequence_at(sequence, times[f], x[0]);
        assert_near(x[1][0], 0, 1e-15);
        assert_near(x[1][1], 1 + along[f], 1e-15);
        assert_near(x[1][2], high[f], 1e-15);
    }
    pel_sequence_destroy(sequence);
    pel_mesh *mesh = parse_usd(text, NULL);
    check_vertex(mesh, 2, -1, 0, 0);
    check_triangle(mesh, 0, 2, 1, 0);
    pel_mesh_destroy(mesh);
    pel_free(text);
    pel_error error;
    assert_int_equal(pel_usd_parse_sequence("a.usda", HEAD MESH(""), strlen(HEAD MESH("")), &sequence, &error),
                     PEL_BAD_FORMAT);
    assert_null(sequence);
    assert_non_null(strstr(error.what, "nothing has samples over time"));
}

/* a prim that no mesh stands in, such as a camera, gives no frames */
static void test_camera(void **unused)
{
    (void)unused;
    static const char text[] = HEAD "def Camera \"c\" {\ndouble3 xformOp:translate.timeSamples = { 0: (0, 0, 0), 1: "
                                    "(0, 0, 1) }\n}\n" MESH("");
    pel_sequence *sequence;
    assert_int_equal(pel_usd_parse_sequence("a.usda", text, strlen(text), &sequence, NULL), PEL_BAD_FORMAT);
}

/* ---- what we write ---- */

static void test_written_mesh(void **unused)
{
    (void)unused;
    char path[FOLDER_PATH];
    double positions[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {0, 0, 0.125}};
    int32_t triangles[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
    pel_mesh mesh = {.vertex_count = 4, .triangle_count = 4, .positions = positions, .triangles = triangles}, *back;
    assert_int_equal(pel_export_usd_mesh(folder_path(path, folder, "m.usda"), &mesh, NULL), PEL_OK);
    assert_int_equal(pel_mesh_import(path, NULL, &back, NULL), PEL_OK);
    assert_int_equal(back->vertex_count, 4);
    assert_int_equal(back->triangle_count, 4);
    assert_memory_equal(back->triangles, triangles, sizeof triangles);
    assert_memory_equal(back->positions, positions, sizeof positions);
    pel_mesh_destroy(back);
}

/* the frames of a run are a motion that reads back with its times, bodies before tools */
static void test_motion(void **unused)
{
    (void)unused;
    char path[FOLDER_PATH];
    pel_sequence *back;
    double x[4][3];
    assert_int_equal(pel_export_usd(folder_path(path, folder, "a.usda"), frames, NULL), PEL_OK);
    assert_int_equal(pel_sequence_read(path, NULL, 24, &back, NULL), PEL_OK);
    assert_int_equal(pel_sequence_frame_count(back), FOLDER_FRAMES);
    assert_int_equal(pel_sequence_vertex_count(back), 4);
    for (int f = 0; f < FOLDER_FRAMES; f++) {
        double positions[12], scalar[4], vector[12];
        folder_values(f, positions, scalar, vector);
        assert_near(pel_sequence_time(back, f), frames->times[f] - frames->times[0], 1e-12);
        pel_sequence_at(back, pel_sequence_time(back, f), x[0]);
        for (int i = 0; i < 12; i++)
            assert_near(x[i / 3][i % 3], positions[i], 1e-6 * 12);
    }
    pel_sequence_destroy(back);
}

/* ---- damage ---- */

static void test_damage(void **unused)
{
    (void)unused;
    refuse_usd("PXR-USDC............", 0, "usdcat -o");
    refuse_usd("PK\003\004.......", 0, "binary USD");
    refuse_usd("# usda\n", 1, "#usda 1.0");
    refuse_usd(HEAD, 0, "no visible mesh");
    refuse_usd(HEAD "def Xform \"a\" (\n references = @b.usda@\n)\n{\n}\n", 6, "flatten");
    refuse_usd(HEAD "mesh\n", 5, "a prim should begin here");
    refuse_usd(HEAD "def Mesh \"m\"\n", 0, "'{' is missing");
    refuse_usd(HEAD "def Mesh m {\n}\n", 5, "name of a prim");
    refuse_usd(HEAD "def Mesh \"m\" (\n a = { b", 6, "not closed");
    refuse_usd(HEAD "def Mesh \"m\"\n{\npoint3f[] points = N", 7, "'N' is not a number");
    refuse_usd(HEAD "def Mesh \"m\" {\n", 5, "not closed");
    refuse_usd(HEAD "def Mesh \"m\" {\nint[] faceVertexCounts = [3, x]\n}\n", 6, "is not a number");
    refuse_usd(HEAD "def Mesh \"m\" {\nint[] faceVertexCounts = [3\n", 6, "not closed");
    refuse_usd(HEAD "def Mesh \"m\" {\nstring a = \"b\n}\n", 6, "a text in quotes is not closed");
    refuse_usd(HEAD "def Mesh \"m\" {\nrel a = </b\n}\n", 6, "a path is not closed");
    refuse_usd(HEAD "def Mesh \"m\" {\nint a =\n}\n", 0, "a value is missing");
    refuse_usd(HEAD "def Mesh \"m\" {\n%%\n}\n", 6, "a property or a prim");
    refuse_usd("#usda 1.0\n( metersPerUnit = 0 )\n" MESH(""), 2, "above 0");
    refuse_usd("#usda 1.0\n( upAxis \"Y\" )\n", 2, "'=' is missing");
    refuse_usd("#usda 1.0\n( upAxis = \"Y\"\n", 0, "')' is missing");
    refuse_usd(HEAD MESH("float xformOp:rotateZ = (1, 2)\ntoken[] xformOpOrder = [\"xformOp:rotateZ\"]"), 10,
               "'xformOp:rotateZ' is no operation");
    refuse_usd(HEAD MESH("token[] xformOpOrder = [\"xformOp:scale\"]"), 10, "the prim has no 'xformOp:scale'");
    refuse_usd(HEAD MESH("quatf xformOp:orient = (0, 0, 0, 0)\ntoken[] xformOpOrder = [\"xformOp:orient\"]"), 10,
               "no operation");
    refuse_usd(HEAD MESH("float3 xformOp:scale = (0, 1, 1)\ntoken[] xformOpOrder = [\"!invert!xformOp:scale\"]"), 11,
               "cannot be inverted");
    refuse_usd(HEAD MESH("float3 xformOp:scale = (1e308, 1, 1)\nfloat3 xformOp:scale:b = (1e308, 1, 1)\ntoken[] "
                         "xformOpOrder = [\"xformOp:scale\", \"xformOp:scale:b\"]"),
               5, "not finite");
    refuse_usd(HEAD MESH("point3f[] points.timeSamples = { 1: [(0, 0, 0)], 1: [(0, 0, 0)] }"), 10, "numbers that rise");
    refuse_usd(HEAD MESH("point3f[] points.timeSamples = { 1 [(0, 0, 0)] }"), 10, "':' is missing");
    refuse_usd(HEAD MESH("point3f[] points.timeSamples = 3"), 10, "begin with '{'");
    refuse_usd(HEAD MESH("point3f[] points.timeSamples = { 1: [(0, 0, 0)], 2: [] }"), 5, "number of points");
    refuse_usd(HEAD MESH("point3f[] points = [(0, 0, 0), (1, 0, inf), (0, 1, 0)]"), 5, "not finite");
    refuse_usd(HEAD MESH("int[] faceVertexCounts = [4]"), 5, "the sum of faceVertexCounts");
    refuse_usd(HEAD MESH("int[] faceVertexCounts = [1.5, 1.5]"), 5, "whole numbers");
    refuse_usd(HEAD MESH("int[] faceVertexIndices = [0, 1, 3]"), 5, "no point of the mesh");
    refuse_usd(HEAD MESH("int[] holeIndices = [1]"), 5, "no face of the mesh");
    refuse_usd(HEAD MESH("int[] holeIndices = [0]"), 0, "no triangles");
    refuse_usd(HEAD MESH("int[] faceVertexIndices.timeSamples = { 0: [0, 1, 2], 1: [0, 2, 1] }"), 5,
               "faces of a mesh change");
}

static void test_depth(void **unused)
{
    (void)unused;
    static char text[20000];
    size_t length = (size_t)snprintf(text, sizeof text, HEAD);
    for (int i = 0; i < 1000; i++)
        length += (size_t)snprintf(text + length, sizeof text - length, "def \"a\" {\n");
    refuse_usd(text, 205, "more than 200 deep");
}

static size_t append(char *text, size_t length, const char *format, int number)
{
    return length + (size_t)snprintf(text + length, 100, format, number, number);
}

/* a mesh with some operations, its order with some */
static const char *many_ops(char *text, int op_count, int order_count)
{
    size_t length = (size_t)sprintf(text, HEAD "def Mesh \"m\"\n{\n" FACE POINTS);
    for (int i = 0; i < op_count; i++)
        length = append(text, length, "double xformOp:rotateX:a%d = 0\n", i);
    length = append(text, length, "token[] xformOpOrder = [", 0);
    for (int i = 0; i < order_count; i++)
        length = append(text, length, "\"xformOp:rotateX:a%d\",", i % op_count);
    append(text, length, "]\n}\n", 0);
    return text;
}

static pel_status parse_one(const void *text, pel_error *error);

/* what would take time with the square of the size of a file */
static void test_limits(void **unused)
{
    (void)unused;
    static char text[100000];
    pel_error error;
    pel_mesh_destroy(parse_usd(many_ops(text, 64, 64), NULL));
    refuse_usd(many_ops(text, 65, 1), 0, "more than 64 xformOps");
    refuse_usd(many_ops(text, 1, 65), 0, "more than 64 operations in its order");
    for (int codes = 1000; codes <= 2000; codes += 1000) {
        size_t length = (size_t)sprintf(text, HEAD);
        for (int i = 0; i < 3000; i++)
            length = append(text, length, "def \"a\" {}\n", i);
        length +=
            (size_t)sprintf(text + length, "def Mesh \"m\"\n{\n" FACE POINTS "double xformOp:rotateX.timeSamples = {");
        for (int i = 0; i < codes; i++)
            length = append(text, length, "%d: %d,", i);
        append(text, length, "}\n}\n", 0);
        assert_int_equal(parse_one(text, &error), codes == 1000 ? PEL_OK : PEL_BAD_FORMAT);
        assert_true(codes == 1000 || strstr(error.what, "2000 frames of 3 vertices and 3001 prims") != NULL);
    }
}

static pel_status parse_one(const void *text, pel_error *error)
{
    pel_sequence *sequence;
    pel_status status = pel_usd_parse_sequence("a.usda", text, strlen(text), &sequence, error);
    pel_sequence_destroy(sequence);
    return status;
}

static void test_allocation_failures(void **unused)
{
    (void)unused;
    size_t size;
    char *text = read_corpus("moving.usda", &size);
    assert_true(for_every_allocation_failure(parse_one, text) >= 20);
    pel_free(text);
}

/* the corpus of the fuzzer, whole and cut off at every length */
static void test_corpus(void **unused)
{
    (void)unused;
    static const char *const names[] = {"blender.usda", "moving.usda", "composed.usda"};
    for (size_t n = 0; n < sizeof names / sizeof *names; n++) {
        size_t size;
        char *bytes = read_corpus(names[n], &size);
        for (size_t length = 1; length <= size; length++) {
            /* a block of just this size shows every read beyond its end */
            char *cut = pel_allocate(length, 1);
            assert_non_null(cut);
            memcpy(cut, bytes, length);
            fuzz_parse_usd((const uint8_t *)cut, length);
            pel_free(cut);
        }
        pel_free(bytes);
    }
}

static void test_paths(void **unused)
{
    (void)unused;
    assert_true(pel_usd_is_path("a.usda") && pel_usd_is_path("b/C.USD") && pel_usd_is_path("d.usdc"));
    assert_false(pel_usd_is_path("usda") || pel_usd_is_path("a.usda.obj") || pel_usd_is_path("a.us"));
    pel_mesh *mesh;
    pel_error error;
    assert_int_equal(pel_mesh_import(PEL_SOURCE_DIR "/tests/fuzz_scene/corpus_usd/blender.usda", NULL, &mesh, &error),
                     PEL_OK);
    pel_mesh_destroy(mesh);
    assert_int_equal(pel_mesh_import(PEL_SOURCE_DIR "/tests/none.usda", NULL, &mesh, &error), PEL_BAD_FILE);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_written_mesh, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_motion, set_up, tear_down),
        cmocka_unit_test(test_blender),
        cmocka_unit_test(test_places),
        cmocka_unit_test(test_nesting),
        cmocka_unit_test(test_orientation),
        cmocka_unit_test(test_left_out),
        cmocka_unit_test(test_samples),
        cmocka_unit_test(test_camera),
        cmocka_unit_test(test_damage),
        cmocka_unit_test(test_depth),
        cmocka_unit_test(test_limits),
        cmocka_unit_test(test_allocation_failures),
        cmocka_unit_test(test_corpus),
        cmocka_unit_test(test_paths),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
