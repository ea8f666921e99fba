/* Readers of glTF and its JSON: each file is made here, number by number. */
#include "check.h"
#include "failing_malloc.h"

#include "../fuzz_scene/fuzz_gltf.h"
#include "../io/parse.h"
#include "base/memory.h"
#include "foreign/gltf.h"
#include "gltf_text.h"
#include "io/file.h"
#include "source_dir.h"

#include <dirent.h>
#include <sys/stat.h>
#include <unistd.h>

enum { BYTE = 5120, UNSIGNED_BYTE, SHORT, UNSIGNED_SHORT, UNSIGNED_INT = 5125, FLOAT };

/* two triangles of a square of 2 */
static const double square[4][3] = {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 1}};

#define HEAD "{\"asset\":{\"version\":\"2.0\"},"
#define SCENE "\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0}],"
#define MESH(primitive) "\"meshes\":[{\"primitives\":[" primitive "]}],"
#define PLAIN MESH("{\"attributes\":{\"POSITION\":0},\"indices\":1}")

static pel_mesh *parse_gltf(const char *text, notes *said)
{
    pel_mesh *mesh;
    pel_error error;
    char words[700];
    pel_log log = {0};
    if (said != NULL)
        log = log_to(said);
    if (pel_gltf_parse("a.gltf", text, strlen(text), &log, &mesh, &error) != PEL_OK)
        fail_msg("%s\n%.1500s", pel_error_text(&error, words, sizeof words), text);
    return mesh;
}

static void refuse_gltf(const char *text, const char *words)
{
    pel_mesh *mesh = (pel_mesh *)(uintptr_t)1;
    pel_error error = {0};
    char said[700] = "";
    pel_status status = pel_gltf_parse("a.gltf", text, strlen(text), NULL, &mesh, &error);
    if (status != PEL_OK)
        pel_error_text(&error, said, sizeof said);
    if (status != PEL_BAD_FORMAT || mesh != NULL || strstr(said, words) == NULL || strstr(said, "a.gltf") == NULL ||
        error.remedy[0] == '\0')
        fail_msg("expected '%s', got '%s' for\n%.1500s", words, said, text);
}

/* puts `count` whole or other numbers of a component type */
static void put_numbers(gltf_text *file, int type, const double *numbers, size_t count, size_t stride, size_t width)
{
    for (size_t i = 0; i < count; i++) {
        const size_t size = type <= UNSIGNED_BYTE ? 1 : type <= UNSIGNED_SHORT ? 2 : 4;
        char *at = file->bytes + file->size;
        if (type == FLOAT)
            pel_store_float(at, false, (float)numbers[i]);
        else
            pel_store_bytes(at, size, false, (uint64_t)(int64_t)numbers[i]);
        file->size += size;
        if ((i + 1) % width == 0 && stride > size * width)
            file->size += stride - size * width;
    }
}

/* the square with positions of a type, between other bytes, and indices of a type */
static const char *square_of(gltf_text *file, int type, int index_type, bool is_normalised, size_t stride)
{
    static const double indices[6] = {0, 1, 2, 0, 2, 3}, largest[] = {127, 255, 32767, 65535};
    char middle[700];
    double positions[12];
    *file = (gltf_text){.size = 5};
    for (int i = 0; i < 12; i++)
        positions[i] = square[i / 3][i % 3] * (is_normalised ? largest[type - BYTE] / 2 : 1);
    put_numbers(file, type, positions, 12, stride, 3);
    const size_t index_begin = file->size;
    put_numbers(file, index_type, indices, 6, 0, 1);
    snprintf(middle, sizeof middle,
             HEAD SCENE PLAIN
             "\"accessors\":[{\"bufferView\":0,\"byteOffset\":2,\"componentType\":%d,\"normalized\":%s,\"count\":4,"
             "\"type\":\"VEC3\"},{\"bufferView\":1,\"componentType\":%d,\"count\":6,\"type\":\"SCALAR\"}],"
             "\"bufferViews\":[{\"buffer\":0,\"byteOffset\":3,\"byteLength\":%zu,\"byteStride\":%zu},{\"buffer\":0,"
             "\"byteOffset\":%zu,\"byteLength\":%zu}]",
             type, is_normalised ? "true" : "false", index_type, index_begin - 3, stride, index_begin,
             file->size - index_begin);
    return gltf_text_end(file, middle);
}

static void check_square(pel_mesh *mesh, double size)
{
    check_counts(mesh, 4, 2);
    for (int32_t v = 0; v < 4; v++)
        for (int i = 0; i < 3; i++)
            assert_near(mesh->positions[v][i], square[v][i] * size / 2, 1e-15);
    check_triangle(mesh, 0, 0, 1, 2);
    check_triangle(mesh, 1, 0, 2, 3);
    pel_mesh_destroy(mesh);
}

static void test_component_types(void **unused)
{
    (void)unused;
    static const int types[] = {BYTE, UNSIGNED_BYTE, SHORT, UNSIGNED_SHORT, FLOAT};
    static const int index_types[] = {UNSIGNED_BYTE, UNSIGNED_SHORT, UNSIGNED_INT};
    gltf_text file;
    for (size_t t = 0; t < 5; t++)
        for (size_t i = 0; i < 3; i++) {
            check_square(parse_gltf(square_of(&file, types[t], index_types[i], false, 16), NULL), 2);
            check_square(parse_gltf(square_of(&file, types[t], index_types[i], false, 0), NULL), 2);
        }
    /* half of the numbers' range is 1 to their rounding */
    pel_mesh *mesh = parse_gltf(square_of(&file, SHORT, UNSIGNED_SHORT, true, 8), NULL);
    assert_near(mesh->positions[2][0], 1, 1e-15);
    assert_near(mesh->positions[3][2], 16383 / 32767.0, 1e-15);
    pel_mesh_destroy(mesh);
    mesh = parse_gltf(square_of(&file, UNSIGNED_BYTE, UNSIGNED_SHORT, true, 4), NULL);
    assert_near(mesh->positions[3][2], 127 / 255.0, 1e-15);
    pel_mesh_destroy(mesh);
    /* of all whole numbers that a type may be */
    for (int type = BYTE - 3; type <= FLOAT + 3; type++) {
        bool is_type = (type >= BYTE && type <= UNSIGNED_SHORT) || type == UNSIGNED_INT || type == FLOAT;
        if (!is_type)
            refuse_gltf(square_of(&file, type, UNSIGNED_INT, false, 0), "component");
    }
    refuse_gltf(square_of(&file, FLOAT, FLOAT, false, 0), "indices of component type 5126");
    refuse_gltf(square_of(&file, FLOAT, SHORT, false, 0), "indices of component type 5122");
}

/* -128 / 127 is -1 */
static void test_normalised_floor(void **unused)
{
    (void)unused;
    static const double numbers[9] = {-128, -127, 127, 0, 0, 0, 127, 0, 0};
    gltf_text file = {.size = 0};
    put_numbers(&file, BYTE, numbers, 9, 0, 3);
    pel_mesh *mesh = parse_gltf(
        gltf_text_end(
            &file,
            HEAD SCENE MESH("{\"attributes\":{\"POSITION\":0}}") "\"accessors\":[{\"bufferView\":0,"
                                                                 "\"componentType\":5120,\"normalized\":true,\"count\":"
                                                                 "3,\"type\":\"VEC3\"}],"
                                                                 "\"bufferViews\":[{\"buffer\":0,\"byteLength\":9}]"),
        NULL);
    check_position(mesh, 0, -1, -1, 1);
    check_position(mesh, 2, 1, 0, 0);
    pel_mesh_destroy(mesh);
}

#define POSITIONS(count)                                                                                               \
    "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":" count ",\"type\":\"VEC3\"}"
#define VIEW(length) "\"bufferViews\":[{\"buffer\":0,\"byteLength\":" length "}]"

/* six points on a zigzag, with the middle as JSON says */
static const char *points(gltf_text *file, const char *middle)
{
    static const double numbers[18] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0, 1, 2, 0};
    *file = (gltf_text){.size = 0};
    put_numbers(file, FLOAT, numbers, 18, 0, 3);
    return gltf_text_end(file, middle);
}

static void test_modes(void **unused)
{
    (void)unused;
    static const struct {
        const char *mode;
        int32_t count, triangles[4][3];
    } cases[] = {{"4", 2, {{0, 1, 2}, {3, 4, 5}}},
                 {"5", 4, {{0, 1, 2}, {1, 3, 2}, {2, 3, 4}, {3, 5, 4}}},
                 {"6", 4, {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}}}};
    gltf_text file;
    char middle[600];
    for (size_t c = 0; c < 3; c++) {
        snprintf(middle, sizeof middle,
                 HEAD SCENE MESH("{\"attributes\":{\"POSITION\":0},\"mode\":%s}") POSITIONS("6") "]," VIEW("72"),
                 cases[c].mode);
        pel_mesh *mesh = parse_gltf(points(&file, middle), NULL);
        check_counts(mesh, 6, cases[c].count);
        for (int32_t t = 0; t < mesh->triangle_count; t++)
            for (int i = 0; i < 3; i++) {
                const double *p = mesh->positions[mesh->triangles[t][i]];
                const int32_t v = cases[c].triangles[t][i];
                assert_true(p[0] == v % 2 && p[1] == v / 2);
            }
        pel_mesh_destroy(mesh);
    }
    notes said;
    pel_mesh *mesh =
        parse_gltf(points(&file, HEAD SCENE MESH("{\"attributes\":{\"POSITION\":0},\"mode\":1},{"
                                                 "\"attributes\":{\"POSITION\":0}}") POSITIONS("6") "]," VIEW("72")),
                   &said);
    check_counts(mesh, 6, 2);
    assert_non_null(strstr(said.text, "1 sets of points or lines ignored"));
    pel_mesh_destroy(mesh);
    refuse_gltf(
        points(&file, HEAD SCENE MESH("{\"attributes\":{\"POSITION\":0},\"mode\":7}") POSITIONS("6") "]," VIEW("72")),
        "'mode' is no whole number from 0 to 6");
}

/* a strip that turns back, by doubled indices as exporters write them */
static void test_strip_of_strips(void **unused)
{
    (void)unused;
    static const double numbers[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0}, indices[9] = {0, 1, 2, 2, 0, 0, 1, 2, 3};
    gltf_text file = {.size = 0};
    put_numbers(&file, FLOAT, numbers, 12, 0, 3);
    put_numbers(&file, UNSIGNED_BYTE, indices, 9, 0, 1);
    pel_mesh *mesh = parse_gltf(
        gltf_text_end(&file,
                      HEAD SCENE MESH("{\"attributes\":{\"POSITION\":0},\"indices\":1,\"mode\":5}") POSITIONS(
                          "4") ",{\"bufferView\":1,\"componentType\":5121,\"count\":9,\"type\":\"SCALAR\"}],"
                               "\"bufferViews\":[{\"buffer\":0,\"byteLength\":48},{\"buffer\":0,\"byteOffset\":48,"
                               "\"byteLength\":9}]"),
        NULL);
    check_counts(mesh, 4, 3);
    check_triangle(mesh, 1, 0, 2, 1);
    check_triangle(mesh, 2, 1, 2, 3);
    pel_mesh_destroy(mesh);
}

#define TARGETS(sparse)                                                                                                \
    ",{\"componentType\":5126,\"count\":6,\"type\":\"VEC3\",\"sparse\":" sparse "}],\"bufferViews\":[{\"buffer\":0,"   \
    "\"byteLength\":72},{\"buffer\":0,\"byteOffset\":72,\"byteLength\":2},{\"buffer\":0,\"byteOffset\":74,"            \
    "\"byteLength\":24}]"
#define SPARSE "{\"count\":2,\"indices\":{\"bufferView\":1,\"componentType\":5121},\"values\":{\"bufferView\":2}}"
#define MORPHED(weights)                                                                                               \
    HEAD "\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0" weights "}],\"meshes\":[{\"weights\":[0.5],"            \
         "\"primitives\":[{\"attributes\":{\"POSITION\":0},\"targets\":[{\"POSITION\":1}]}]}],"

/* a target that moves vertices 2 and 5 alone by (1, 2, 4) and (0, 0, -8) */
static const char *morphed(gltf_text *file, const char *middle)
{
    static const double numbers[18] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0, 1, 2, 0}, at[2] = {2, 5},
                        moves[6] = {1, 2, 4, 0, 0, -8};
    *file = (gltf_text){.size = 0};
    put_numbers(file, FLOAT, numbers, 18, 0, 3);
    put_numbers(file, UNSIGNED_BYTE, at, 2, 0, 1);
    put_numbers(file, FLOAT, moves, 6, 0, 3);
    return gltf_text_end(file, middle);
}

static void test_targets(void **unused)
{
    (void)unused;
    gltf_text file;
    pel_mesh *mesh = parse_gltf(morphed(&file, MORPHED("") POSITIONS("6") TARGETS(SPARSE)), NULL);
    check_position(mesh, 2, 0.5, 2, 2);
    check_position(mesh, 5, 1, 2, -4);
    check_position(mesh, 1, 1, 0, 0);
    pel_mesh_destroy(mesh);
    /* the node's weights come first */
    mesh = parse_gltf(morphed(&file, MORPHED(",\"weights\":[-1]") POSITIONS("6") TARGETS(SPARSE)), NULL);
    check_position(mesh, 2, -1, -1, -4);
    pel_mesh_destroy(mesh);
    mesh = parse_gltf(morphed(&file, MORPHED(",\"weights\":[0]") POSITIONS("6") TARGETS(SPARSE)), NULL);
    check_position(mesh, 2, 0, 1, 0);
    pel_mesh_destroy(mesh);
    static const char *const wrong[][2] = {
        {MORPHED("") POSITIONS("6") TARGETS("{\"count\":3,\"indices\":{\"bufferView\":1,\"componentType\":5121},"
                                            "\"values\":{\"bufferView\":2}}"),
         "3 elements do not fit"},
        {MORPHED("") POSITIONS("6") TARGETS("{\"count\":2,\"indices\":{\"bufferView\":1,\"componentType\":5126},"
                                            "\"values\":{\"bufferView\":2}}"),
         "indices of component type 5126"},
        {MORPHED("") POSITIONS("6") TARGETS("{\"count\":1,\"indices\":{\"bufferView\":2,\"componentType\":5121,"
                                            "\"byteOffset\":3},\"values\":{\"bufferView\":2}}"),
         "changes element 63 of 6"},
        {MORPHED("") POSITIONS("6") TARGETS("{\"count\":1,\"indices\":{},\"values\":{\"bufferView\":2}}"),
         "indices of component type 0"},
        {MORPHED("") POSITIONS("5") TARGETS(SPARSE), "a target moves 6 vertices of 5"},
    };
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++)
        refuse_gltf(morphed(&file, wrong[i][0]), wrong[i][1]);
}

#define NODES(nodes)                                                                                                   \
    HEAD "\"scene\":0,\"scenes\":[{\"nodes\":[0]}],\"nodes\":[" nodes "]," MESH("{\"attributes\":{\"POSITION\":0}}")   \
        POSITIONS("3") "]," VIEW("36")

/* the corner (0, 1, 0) of a triangle under a tree of nodes */
static void test_places(void **unused)
{
    (void)unused;
    static const struct {
        const char *nodes;
        double corner[3];
    } cases[] = {
        {NODES("{\"mesh\":0}"), {0, 1, 0}},
        {NODES("{\"mesh\":0,\"translation\":[1,2,3],\"scale\":[5,4,3]}"), {1, 6, 3}},
        /* a quarter turn about z, not of unit length */
        {NODES("{\"mesh\":0,\"rotation\":[0,0,2,2],\"translation\":[0,0,7]}"), {-1, 0, 7}},
        /* the same by columns */
        {NODES("{\"mesh\":0,\"matrix\":[0,1,0,0,-1,0,0,0,0,0,1,0,0,0,7,1]}"), {-1, 0, 7}},
        {NODES("{\"scale\":[2,2,2],\"children\":[1]},{\"translation\":[0,0,1],\"children\":[2]},"
               "{\"mesh\":0,\"rotation\":[0,0,1,1]}"),
         {-2, 0, 2}},
    };
    gltf_text file;
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        pel_mesh *mesh = parse_gltf(points(&file, cases[c].nodes), NULL);
        check_counts(mesh, 3, 1);
        for (int i = 0; i < 3; i++)
            assert_near(mesh->positions[2][i], cases[c].corner[i], 1e-15);
        pel_mesh_destroy(mesh);
    }
    /* a mirror turns the triangle */
    pel_mesh *mesh = parse_gltf(points(&file, NODES("{\"mesh\":0,\"scale\":[1,1,-1]}")), NULL);
    check_position(mesh, mesh->triangles[0][0], 0, 1, 0);
    pel_mesh_destroy(mesh);
    /* an instance on each side of the edge x = 0 is sewn to it; a third one is not read: it is in no scene */
    notes said;
    mesh = parse_gltf(points(&file, HEAD "\"scene\":0,\"scenes\":[{\"nodes\":[0,1]}],\"nodes\":[{\"mesh\":0},"
                                         "{\"mesh\":0,\"scale\":[-1,1,1]},{\"mesh\":0}]," MESH(
                                             "{\"attributes\":{\"POSITION\":0}}") POSITIONS("3") "]," VIEW("36")),
                      &said);
    check_counts(mesh, 4, 2);
    assert_non_null(strstr(said.text, "2 meshes of the scene joined"));
    pel_mesh_destroy(mesh);
    /* without scenes all meshes are read */
    mesh =
        parse_gltf(points(&file, HEAD MESH("{\"attributes\":{\"POSITION\":0}}") POSITIONS("3") "]," VIEW("36")), NULL);
    check_counts(mesh, 3, 1);
    pel_mesh_destroy(mesh);
    static const char *const wrong[][2] = {
        {NODES("{\"children\":[0]}"), "node 0 stands twice"},
        {NODES("{\"children\":[1]},{\"mesh\":0,\"children\":[2]},{\"children\":[1]}"), "node 1 stands twice"},
        {NODES("{\"children\":[1]}"), "there is no such node"},
        {NODES("{\"children\":[0.5]}"), "there is no such node"},
        {NODES("{\"mesh\":1}"), "'mesh' is no whole number from 0 to 0"},
        {NODES("{\"mesh\":0,\"rotation\":[0,0,0,0]}"), "has no length"},
        {NODES("{\"mesh\":0,\"rotation\":[0,0,1]}"), "'rotation' of a node has not 4 numbers"},
        {NODES("{\"mesh\":0,\"scale\":[1,\"2\",1]}"), "something else than at most 3 numbers"},
        {NODES("{\"mesh\":0,\"scale\":[1e308,1e308,1],\"translation\":[0,1e308,0]}"), "a coordinate is not finite"},
        {NODES("{\"mesh\":0,\"extensions\":{\"EXT_mesh_gpu_instancing\":{}}}"), "EXT_mesh_gpu_instancing"},
        {NODES("{}"), "no triangles"},
    };
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++)
        refuse_gltf(points(&file, wrong[i][0]), wrong[i][1]);
}

#define REST SCENE MESH("{\"attributes\":{\"POSITION\":0}}") POSITIONS("3") "]," VIEW("36")

static void test_extensions(void **unused)
{
    (void)unused;
    gltf_text file;
    pel_mesh_destroy(
        parse_gltf(points(&file, HEAD "\"extensionsRequired\":[\"KHR_mesh_quantization\","
                                      "\"KHR_materials_unlit\"],\"extensionsUsed\":[\"XYZ_unheard_of\"]," REST),
                   NULL));
    refuse_gltf(points(&file, HEAD "\"extensionsRequired\":[\"KHR_draco_mesh_compression\"]," REST),
                "requires the extension KHR_draco_mesh_compression");
    refuse_gltf(points(&file, HEAD "\"extensionsRequired\":[\"KHR_texture_transform\",\"XYZ_unheard_of\"]," REST),
                "requires the extension XYZ_unheard_of");
    refuse_gltf(points(&file, HEAD "\"extensionsRequired\":[7]," REST), "requires the extension ?");
    refuse_gltf(points(&file, "{\"asset\":{\"version\":\"1.0\"}," REST), "version 1.0");
    refuse_gltf(points(&file, "{" REST), "no version");
}

static void test_damage(void **unused)
{
    (void)unused;
    gltf_text file;
    static const char *const wrong[][2] = {
        {HEAD SCENE MESH("{\"attributes\":{\"POSITION\":3}}") POSITIONS("3") "]," VIEW("36"), "'POSITION' is no whole"},
        {HEAD SCENE MESH("{\"attributes\":{\"POSITION\":0},\"indices\":0}") POSITIONS("3") "]," VIEW("36"),
         "type SCALAR that its use asks for"},
        {HEAD SCENE PLAIN POSITIONS("3") ",{\"bufferView\":0,\"byteOffset\":14,\"componentType\":5121,\"count\":3,"
                                         "\"type\":\"SCALAR\"}]," VIEW("36"),
         "index 128 of a mesh with 3 vertices"},
        {HEAD SCENE MESH("{\"attributes\":{\"POSITION\":0}}") POSITIONS("7") "]," VIEW("72"), "7 elements do not fit"},
        {HEAD SCENE MESH("{\"attributes\":{\"POSITION\":0}}") POSITIONS("3") "]," VIEW("73"), "beyond the 72 bytes"},
        {HEAD SCENE MESH("{\"attributes\":{\"POSITION\":0}}") POSITIONS("2147483647") "]," VIEW("72"), "too many for"},
        {HEAD SCENE MESH("{\"attributes\":{\"POSITION\":0}}") POSITIONS("-1") "]," VIEW("72"), "'count' is no whole"},
        {HEAD SCENE MESH("{\"attributes\":{\"POSITION\":0}}") "\"accessors\":[{\"componentType\":5126,\"count\":100000,"
                                                              "\"type\":\"VEC3\"}]," VIEW("72"),
         "100000 elements has no view"},
        {HEAD SCENE MESH("{\"attributes\":{\"POSITION\":0}}") "\"accessors\":[{\"bufferView\":0,\"componentType\":5124,"
                                                              "\"count\":3,\"type\":\"VEC3\"}]," VIEW("72"),
         "no component type"},
        {HEAD SCENE MESH("{\"attributes\":{\"POSITION\":0}}") "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,"
                                                              "\"count\":3,\"type\":\"VEC2\"}]," VIEW("72"),
         "type VEC3"},
        {HEAD SCENE MESH("{\"attributes\":{\"POSITION\":0}}") POSITIONS("3") "],\"bufferViews\":[{\"byteLength\":36}]",
         "does not say of which"},
        {HEAD "\"nodes\":{}", "'nodes' is no list"},
    };
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++)
        refuse_gltf(points(&file, wrong[i][0]), wrong[i][1]);
    /* cut off anywhere, the JSON is damaged or a buffer too short */
    const char *whole = points(&file, HEAD REST);
    for (size_t length = 1; length < strlen(whole); length++) {
        pel_mesh *mesh;
        assert_int_equal(pel_gltf_parse("a.gltf", whole, length, NULL, &mesh, NULL), PEL_BAD_FORMAT);
    }
    refuse_gltf(HEAD REST ",\"buffers\":[{\"byteLength\":72,\"uri\":\"data:,abc\"}]}", "something else than base64");
    refuse_gltf(HEAD REST ",\"buffers\":[{\"byteLength\":72,\"uri\":\"data:;base64,AAAA\"}]}", "has 3 bytes, not 72");
    refuse_gltf(HEAD REST ",\"buffers\":[{\"byteLength\":72,\"uri\":\"a.bin\"}]}", "in another file, 'a.bin'");
    refuse_gltf(HEAD REST ",\"buffers\":[{\"byteLength\":72}]}", "has 0 bytes, not 72");
}

/* many instances of one mesh make a scene of any size of a small file */
static void test_amplification(void **unused)
{
    (void)unused;
    static char nodes[60000], middle[70000];
    gltf_text file;
    int length = 0;
    file.size = 0;
    for (int i = 0; i < 3000; i++)
        length += snprintf(nodes + length, sizeof nodes - (size_t)length, "%s{\"mesh\":0}", i > 0 ? "," : "");
    length = snprintf(middle, sizeof middle, HEAD "\"scenes\":[{\"nodes\":[");
    for (int i = 0; i < 3000; i++)
        length += snprintf(middle + length, sizeof middle - (size_t)length, "%s%d", i > 0 ? "," : "", i);
    snprintf(middle + length, sizeof middle - (size_t)length,
             "]}],\"nodes\":[%s],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],"
             "\"accessors\":[{\"componentType\":5126,\"count\":40000,\"type\":\"VEC3\"}]",
             nodes);
    refuse_gltf(gltf_text_end(&file, middle), "too many for a file of");
}

static void put_file(const char *path, const void *bytes, size_t size)
{
    FILE *stream = fopen(path, "wb");
    assert_non_null(stream);
    assert_int_equal(fwrite(bytes, 1, size, stream), size);
    fclose(stream);
}

/* numbers in a file beside: only inside the folder */
static void test_siblings(void **unused)
{
    (void)unused;
    static const double numbers[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    static const struct {
        const char *name, *words; /* null = it is read */
    } cases[] = {
        {"a%20b.bin", NULL},
        {"sub/../a b.bin", NULL},
        {"sub\\/c.bin", NULL},
        {"../gltf-outside.bin", "is not in the folder"},
        {"%2e%2e/gltf-outside.bin", "is not in the folder"},
        {"%2fetc/passwd", "no file beside"},
        {"/etc/passwd", "no file beside"},
        {"file:///etc/passwd", "no file beside"},
        {"http://example.org/a.bin", "no file beside"},
        {"link.bin", "is not in the folder"},
        {"pipe.bin", "it is a pipe"},
        {"sub", "Is a directory"},
        {"none.bin", "No such file"},
        {"a%00b.bin", "no file beside"},
    };
    gltf_text file = {.size = 0};
    char text[900];
    put_numbers(&file, FLOAT, numbers, 9, 0, 3);
    mkdir("gltf-folder", 0777);
    mkdir("gltf-folder/sub", 0777);
    put_file("gltf-folder/a b.bin", file.bytes, 36);
    put_file("gltf-folder/sub/c.bin", file.bytes, 36);
    put_file("gltf-outside.bin", file.bytes, 36);
    unlink("gltf-folder/link.bin");
    unlink("gltf-folder/pipe.bin");
    assert_int_equal(symlink("../gltf-outside.bin", "gltf-folder/link.bin"), 0);
    assert_int_equal(mkfifo("gltf-folder/pipe.bin", 0666), 0);
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        int size =
            snprintf(text, sizeof text, HEAD REST ",\"buffers\":[{\"byteLength\":36,\"uri\":\"%s\"}]}", cases[c].name);
        put_file("gltf-folder/a.gltf", text, (size_t)size);
        pel_mesh *mesh;
        pel_error error = {0};
        char said[700] = "";
        pel_status status = pel_gltf_read("gltf-folder/a.gltf", NULL, &mesh, &error);
        if (status != PEL_OK)
            pel_error_text(&error, said, sizeof said);
        if ((status == PEL_OK) != (cases[c].words == NULL) ||
            (status != PEL_OK && strstr(said, cases[c].words) == NULL))
            fail_msg("%s: '%s'", cases[c].name, said);
        pel_mesh_destroy(mesh);
    }
}

static void test_binary(void **unused)
{
    (void)unused;
    static const double numbers[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    static const char json[] = HEAD REST ",\"buffers\":[{\"byteLength\":36}]}";
    enum { JSON_SIZE = sizeof json - 1 };
    char bytes[900];
    gltf_text file = {.size = 0};
    put_numbers(&file, FLOAT, numbers, 9, 0, 3);
    memcpy(bytes, "glTF", 4);
    pel_store_bytes(bytes + 4, 4, false, 2);
    pel_store_bytes(bytes + 12, 4, false, JSON_SIZE);
    memcpy(bytes + 16, "JSON", 4);
    memcpy(bytes + 20, json, JSON_SIZE);
    pel_store_bytes(bytes + 20 + JSON_SIZE, 4, false, 36);
    memcpy(bytes + 24 + JSON_SIZE, "BIN\0", 4);
    memcpy(bytes + 28 + JSON_SIZE, file.bytes, 36);
    const size_t size = 28 + JSON_SIZE + 36;
    pel_store_bytes(bytes + 8, 4, false, size);
    pel_mesh *mesh;
    for (size_t length = 1; length < size; length++)
        assert_int_equal(pel_gltf_parse("a.glb", bytes, length, NULL, &mesh, NULL), PEL_BAD_FORMAT);
    assert_int_equal(pel_gltf_parse("a.glb", bytes, size, NULL, &mesh, NULL), PEL_OK);
    check_counts(mesh, 3, 1);
    pel_mesh_destroy(mesh);
    pel_store_bytes(bytes + 4, 4, false, 1);
    pel_error error;
    assert_int_equal(pel_gltf_parse("a.glb", bytes, size, NULL, &mesh, &error), PEL_BAD_FORMAT);
    assert_non_null(strstr(error.what, "version 1 of GLB"));
}

static void test_json(void **unused)
{
    (void)unused;
    static const char *const wrong[][2] = {
        {"", "a value is missing"},
        {"{", "a name in quotes"},
        {"{\"a\"}", "a colon"},
        {"[1 2]", "a comma"},
        {"[1}", "a comma"},
        {"[1,]", "a value is missing"},
        {"\"a", "a text does not end"},
        {"{} {}", "behind its end"},
        {"tru", "a value is missing"},
        {"+1", "a value is missing"},
        {"nan", "a value is missing"},
        {"[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[", "deeper than 64"},
    };
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        const pel_text_cursor scan = {
            .name = "a.json", .begin = wrong[i][0], .at = wrong[i][0], .end = wrong[i][0] + strlen(wrong[i][0])};
        pel_json_tree tree;
        pel_error error = {0};
        assert_int_equal(pel_json_tree_read(&tree, &scan, &error), PEL_BAD_FORMAT);
        if (strstr(error.what, wrong[i][1]) == NULL)
            fail_msg("%s: %s", wrong[i][0], error.what);
        pel_json_tree_free(&tree);
    }
    static const char text[] =
        " {\"a\" : [ 1 , -2.5e1,true,null ] , \"b\\n\":\"x\\u00e9\\u20ac\\/\\t\", \"c\":\"\\ud800\"}\n";
    const pel_text_cursor scan = {.name = "a.json", .begin = text, .at = text, .end = text + strlen(text)};
    pel_json_tree tree;
    char copy[16];
    assert_int_equal(pel_json_tree_read(&tree, &scan, NULL), PEL_OK);
    const pel_json_node *a = pel_json_member(&tree, tree.nodes, "a"), *second;
    assert_int_equal(a->count, 4);
    second = pel_json_after(&tree, pel_json_first(&tree, a));
    assert_near(second->number, -25, 0);
    assert_null(pel_json_member(&tree, a, "a"));
    assert_null(pel_json_member(&tree, NULL, "a"));
    assert_true(pel_json_unescape(pel_json_after(&tree, a), copy, sizeof copy));
    assert_string_equal(copy, "x\xc3\xa9\xe2\x82\xac/\t");
    assert_false(pel_json_unescape(pel_json_after(&tree, a), copy, 8));
    assert_false(pel_json_unescape(pel_json_member(&tree, tree.nodes, "c"), copy, sizeof copy));
    assert_false(pel_json_unescape(a, copy, sizeof copy));
    pel_json_tree_free(&tree);
}

static pel_status parse_one(const void *text, pel_error *error)
{
    pel_mesh *mesh;
    pel_status status = pel_gltf_parse("a.gltf", text, strlen(text), NULL, &mesh, error);
    pel_mesh_destroy(mesh);
    return status;
}

static void test_allocation_failures(void **unused)
{
    (void)unused;
    gltf_text file;
    assert_true(for_every_allocation_failure(parse_one, morphed(&file, MORPHED("") POSITIONS("6") TARGETS(SPARSE))) >=
                20);
}

/* the corpus of the fuzzer, whole and cut off at every length */
static void test_corpus(void **unused)
{
    (void)unused;
    int count = 0;
    DIR *stream = opendir(PEL_SOURCE_DIR "/tests/fuzz_scene/corpus_gltf");
    assert_non_null(stream);
    for (struct dirent *entry = readdir(stream); entry != NULL; entry = readdir(stream)) {
        char path[1000], *bytes;
        size_t size;
        if (entry->d_name[0] == '.')
            continue;
        snprintf(path, sizeof path, PEL_SOURCE_DIR "/tests/fuzz_scene/corpus_gltf/%s", entry->d_name);
        assert_int_equal(pel_file_read(path, &bytes, &size, NULL), PEL_OK);
        for (size_t length = 1; length <= size; length++) {
            /* a block of just this size shows every read beyond its end */
            char *cut = pel_allocate(length, 1);
            assert_non_null(cut);
            memcpy(cut, bytes, length);
            fuzz_parse_gltf((const uint8_t *)cut, length);
            pel_free(cut);
        }
        pel_free(bytes);
        count++;
    }
    closedir(stream);
    assert_true(count >= 12);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_component_types), cmocka_unit_test(test_normalised_floor),
        cmocka_unit_test(test_modes),           cmocka_unit_test(test_strip_of_strips),
        cmocka_unit_test(test_targets),         cmocka_unit_test(test_places),
        cmocka_unit_test(test_extensions),      cmocka_unit_test(test_damage),
        cmocka_unit_test(test_amplification),   cmocka_unit_test(test_siblings),
        cmocka_unit_test(test_binary),          cmocka_unit_test(test_json),
        cmocka_unit_test(test_corpus),          cmocka_unit_test(test_allocation_failures),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
