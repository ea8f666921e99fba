#include "failing_malloc.h"
#include "parse.h"

#include "io/bytes.h"

/* one element line and its properties */
#define ASCII "ply\nformat ascii 1.0\n"
#define XYZ "property float x\nproperty float y\nproperty float z\n"
#define FACES "property list uchar int vertex_indices\n"
#define SQUARE_POSITIONS "0 0 0\n1 0 0\n1 1 0.5\n0 1 0\n"
#define HEADER_4_2 ASCII "element vertex 4\n" XYZ "element face 2\n" FACES "end_header\n"
#define SQUARE HEADER_4_2 SQUARE_POSITIONS "3 0 1 2\n3 0 2 3\n"

static void check_square(pel_mesh *mesh)
{
    check_counts(mesh, 4, 2);
    check_position(mesh, 2, 1, 1, 0.5);
    check_triangle(mesh, 0, 0, 1, 2);
    check_triangle(mesh, 1, 0, 2, 3);
    pel_mesh_destroy(mesh);
}

static void test_ascii(void **unused)
{
    (void)unused;
    check_square(parse_text("a.ply", SQUARE, NULL));
    check_square(parse_text("a",
                            "ply\r\ncomment format bogus\r\nformat ascii 1.0\r\nobj_info x\r\nelement vertex 4\r\n"
                            "property double z\r\nproperty double x\r\nproperty double y\r\nelement face 2\r\n"
                            "property list int32 uint32 vertex_index\r\nend_header\r\n0 0 0\r\n0 1 0\r\n"
                            ".5 1 1\r\n0 0 1\r\n3 0 1 2\r\n3 0 2 3",
                            NULL));
    /* faces first, extra elements and properties everywhere, values not in lines */
    check_square(parse_text("a.ply",
                            ASCII "element camera 2\nproperty float a\nproperty list char short b\nelement face 2\n"
                                  "property uchar flag\n" FACES "property list uchar float texcoord\n"
                                  "element nothing 7\nelement vertex 4\n" XYZ
                                  "element edge 1\nproperty int vertex1\nend_header\n"
                                  "1.5 2 7 8\nnan 0\n1 3 0 1 2 2 .5 .5 0 3 0 2 3\n0\n0 0 0 1 0 0 1 1 0.5 0 1 0\n5\n",
                            NULL));
}

static void test_polygons(void **unused)
{
    (void)unused;
    notes said;
    check_square(parse_text("a.ply",
                            ASCII "element vertex 4\n" XYZ "element face 2\n" FACES "end_header\n" SQUARE_POSITIONS
                                  "4 0 1 2 3\n2 0 1\n",
                            &said));
    assert_non_null(strstr(said.text, "1 faces with more than three corners cut into 2 triangles"));
    assert_non_null(strstr(said.text, "1 faces with fewer than three corners ignored"));
}

static void test_fields(void **unused)
{
    (void)unused;
    notes said;
    pel_mesh *mesh = parse_text(
        "a.ply",
        ASCII "element vertex 3\nproperty float thickness\n" XYZ "property float nx\nproperty uchar red\n"
              "property float v_0\nproperty float v_1\nproperty float v_2\nproperty float w_0\n"
              "property list uchar int neighbours\nproperty float u\nproperty float u_0\nproperty float u_1\n"
              "property float _0\nproperty float _1\nelement face 1\n" FACES "end_header\n"
              "0.25 0 0 0 9 255 1 2 3 7 0 40 41 42 1 2\n"
              "0.5  1 0 0 8 254 4 5 6 7 2 5 6 40 41 42 3 4\n"
              "0.75 0 1 0 7 253 7 8 9 7 1 1 40 41 42 5 6\n3 0 1 2\n",
        &said);
    check_counts(mesh, 3, 1);
    const double thickness[3] = {0.25, 0.5, 0.75}, red[3] = {255, 254, 253}, v[9] = {1, 2, 3, 4, 5, 6, 7, 8, 9};
    assert_memory_equal(pel_mesh_field(mesh, "thickness")->values, thickness, sizeof thickness);
    assert_memory_equal(pel_mesh_field(mesh, "red")->values, red, sizeof red);
    assert_int_equal(pel_mesh_field(mesh, "v")->component_count, 3);
    assert_memory_equal(pel_mesh_field(mesh, "v")->values, v, sizeof v);
    assert_non_null(pel_mesh_field(mesh, "nx"));
    assert_non_null(pel_mesh_field(mesh, "w_0"));
    /* "u" is taken by a scalar, and "" is no name */
    assert_int_equal(pel_mesh_field(mesh, "u")->component_count, 1);
    assert_int_equal(pel_mesh_field(mesh, "u_1")->component_count, 1);
    assert_int_equal(pel_mesh_field(mesh, "_0")->component_count, 1);
    assert_non_null(strstr(said.text, "1 list properties of vertices ignored"));
    assert_int_equal(mesh->field_count, 10);
    pel_mesh_destroy(mesh);
}

/* appends a number of a PLY type */
static void put(char *bytes, size_t *length, const char *type, bool big, double value)
{
    size_t size = 4;
    if (strcmp(type, "float") == 0) {
        pel_store_float(bytes + *length, big, (float)value);
    } else if (strcmp(type, "double") == 0) {
        size = 8;
        pel_store_double(bytes + *length, big, value);
    } else {
        size = strstr(type, "char") != NULL ? 1 : strstr(type, "short") != NULL ? 2 : 4;
        pel_store_bytes(bytes + *length, size, big, (uint64_t)(int64_t)value);
    }
    *length += size;
}

/* every scalar type for coordinates, list counts and indices, in both byte orders */
static void test_binary_types(void **unused)
{
    (void)unused;
    static const char *const types[] = {"char", "uchar", "short", "ushort", "int", "uint", "float", "double"};
    for (int c = 0; c < 8; c++) {
        for (int n = 0; n < 64; n++) {
            const bool big = n % 2 != 0, is_unsigned = types[c][0] == 'u';
            const double low = is_unsigned ? 200 : -100;
            const char *count_type = types[n / 8], *index_type = types[(n + c) % 8];
            char bytes[1000];
            int header = snprintf(bytes, sizeof bytes,
                                  "ply\nformat binary_%s_endian 1.0\nelement vertex 3\nproperty %s x\nproperty %s y\n"
                                  "property float weight\nproperty %s z\nelement face 1\nproperty list %s %s "
                                  "vertex_indices\nend_header\n",
                                  big ? "big" : "little", types[c], types[c], types[c], count_type, index_type);
            size_t length = (size_t)header;
            for (int v = 0; v < 3; v++) {
                put(bytes, &length, types[c], big, v == 1);
                put(bytes, &length, types[c], big, v == 2);
                put(bytes, &length, "float", big, 0.125 * v);
                put(bytes, &length, types[c], big, low);
            }
            put(bytes, &length, count_type, big, 3);
            for (int v = 0; v < 3; v++)
                put(bytes, &length, index_type, big, 2 - v);
            pel_mesh *mesh = parse_bytes("a.ply", bytes, length, NULL);
            check_counts(mesh, 3, 1);
            check_position(mesh, 1, 1, 0, low);
            check_triangle(mesh, 0, 2, 1, 0);
            assert_near(pel_mesh_field(mesh, "weight")->values[2], 0.25, 0);
            pel_mesh_destroy(mesh);
            refuse_bytes("a.ply", bytes, length - 1, "byte ");
        }
    }
}

/* a data byte that looks like a line end belongs to the data */
static void test_line_end_before_data(void **unused)
{
    (void)unused;
    static const char *const ends[] = {"\n", "\r\n", "\r"};
    for (int e = 0; e < 3; e++) {
        char bytes[500];
        size_t length = (size_t)snprintf(
            bytes, sizeof bytes,
            "ply%sformat binary_little_endian 1.0%selement vertex 3%sproperty uchar x%sproperty uchar y%s"
            "property uchar z%selement face 1%sproperty list uchar uchar vertex_indices%send_header%s",
            ends[e], ends[e], ends[e], ends[e], ends[e], ends[e], ends[e], ends[e], ends[e]);
        const char data[] = {'\n', '\r', '\n', 1, 0, 0, 0, 1, 0, 3, 0, 1, 2};
        memcpy(bytes + length, data, sizeof data);
        pel_mesh *mesh = parse_bytes("a.ply", bytes, length + sizeof data, NULL);
        check_position(mesh, 0, 10, 13, 10);
        pel_mesh_destroy(mesh);
    }
}

static void test_header_refusals(void **unused)
{
    (void)unused;
    refuse_text("a.ply", "plyx\n", "does not begin with 'ply'");
    refuse_text("a.ply", "ply\n", "the file ends where 'end_header' should be");
    refuse_text("a.ply", "ply\nend_header\n", "no format line");
    refuse_text("a.ply", "ply\nformat binary 1.0\n", "a.ply:2:8: error: 'binary' is not a format");
    refuse_text("a.ply", "ply\nformat ascii 2.0\n", "version");
    refuse_text("a.ply", "ply\nwhatever\n", "a.ply:2:1: error: 'whatever' is not a line of a PLY header");
    refuse_text("a.ply", ASCII "property float x\n", "a property stands before any element");
    refuse_text("a.ply", ASCII "element vertex\n", "a.ply:3:15: error: the line ends where a number of elements");
    refuse_text("a.ply", ASCII "element vertex -1\n", "a.ply:3:16: error: '-1' is not");
    refuse_text("a.ply", ASCII "element vertex 3.5\n", "a.ply:3:16: error: '3.5' is not");
    refuse_text("a.ply", ASCII "element vertex 99999999999999999999\n", "a.ply:3:16: ");
    refuse_text("a.ply", ASCII "element vertex 3 4\n", "'4' is not the end of the line");
    refuse_text("a.ply", ASCII "element vertex 3\nelement vertex 3\n", "element 'vertex' stands twice");
    refuse_text("a.ply", ASCII "element vertex 3\nproperty long x\n", "a.ply:4:10: error: 'long' is not a type");
    refuse_text("a.ply", ASCII "element vertex 3\nproperty list uchar x\n", "'x' is not a type");
    refuse_text("a.ply", ASCII "element vertex 3\nproperty float\n", "the line ends where a name");
    refuse_text("a.ply", ASCII "element vertex 3\n" XYZ "property int x\n", "property 'x' stands twice");
    refuse_text("a.ply",
                ASCII "element vertex 3\nproperty int a234567890123456789012345678901234567890123456789012345"
                      "678901234\n",
                "a name is longer than 63 characters");
    char text[20000];
    int length = snprintf(text, sizeof text, ASCII);
    for (int i = 0; i < 40; i++)
        length += snprintf(text + length, sizeof text - (size_t)length, "element e%d 0\n", i);
    refuse_text("a.ply", text, "more than 32 elements");
    length = snprintf(text, sizeof text, ASCII "element vertex 3\n");
    for (int i = 0; i < 600; i++)
        length += snprintf(text + length, sizeof text - (size_t)length, "property int e%d\n", i);
    refuse_text("a.ply", text, "more than 512 properties");
}

static void test_body_refusals(void **unused)
{
    (void)unused;
    refuse_text("a.ply", ASCII "element vertex 1000000000\n" XYZ "end_header\n0 0 0\n",
                "a.ply:3:9: error: the header promises 1000000000 elements 'vertex'");
    refuse_text("a.ply", ASCII "element vertex 9000000000000000000\n" XYZ "end_header\n0 0 0\n", "more than the file");
    refuse_text("a.ply",
                ASCII "element vertex 3\n" XYZ "element face 1000000000\n" FACES
                      "end_header\n0 0 0 1 0 0 0 1 0\n3 0 1 2\n",
                "1000000000 elements 'face'");
    refuse_text("a.ply", ASCII "element x 1000000000\nelement vertex 1\n" XYZ "end_header\n0 0 0\n", "no triangles");
    refuse_text("a.ply", ASCII "element face 1\n" FACES "end_header\n3 0 1 2\n", "no vertices");
    refuse_text("a.ply", ASCII "element vertex 0\n" XYZ "element face 1\n" FACES "end_header\n3 0 1 2\n",
                "no vertices");
    refuse_text("a.ply", ASCII "element vertex 1\nproperty float x\nproperty float y\nend_header\n0 0\n",
                "no properties x, y and z");
    refuse_text("a.ply",
                ASCII "element vertex 1\nproperty list int float x\nproperty float y\nproperty float z\n"
                      "end_header\n1 0 0 0\n",
                "no properties x, y and z");
    refuse_text("a.ply",
                ASCII "element vertex 1\n" XYZ "element face 1\nproperty int vertex_indices\nend_header\n"
                      "0 0 0\n3\n",
                "no list property vertex_indices");
    refuse_text("a.ply", ASCII "element vertex 1\n" XYZ "end_header\n0 0 0\n", "1 vertices and no triangles");
    refuse_text("a.ply", HEADER_4_2 "0 0 0\n1 0 nan\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n",
                "property 'z' of vertex 1 is nan");
    refuse_text("a.ply", HEADER_4_2 "0 0 0\n1 0 1e999\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n", "a.ply:11:4: ");
    refuse_text("a.ply", HEADER_4_2 "0 0 0\n1 0 x\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n",
                "a.ply:11:5: error: 'x' is not a number");
    refuse_text("a.ply", HEADER_4_2 SQUARE_POSITIONS "3 0 1 2\n3 0 2 4\n", "a face uses vertex 4 but the file has 4");
    refuse_text("a.ply", HEADER_4_2 SQUARE_POSITIONS "3 0 1 2\n3 0 2 -1\n", "-1 is not a vertex index");
    refuse_text("a.ply", HEADER_4_2 SQUARE_POSITIONS "3 0 1 2\n3 0 2 1.5\n", "1.5 is not a vertex index");
    refuse_text("a.ply", HEADER_4_2 SQUARE_POSITIONS "3 0 1 2\n3 0 2 5000000000\n", "5e+09 is not a vertex index");
    refuse_text("a.ply", HEADER_4_2 SQUARE_POSITIONS "3 0 1 2\n3 0 2 2147483647\n",
                "2.14748e+09 is not a vertex index");
    refuse_text("a.ply", HEADER_4_2 SQUARE_POSITIONS "3 0 1 2\n3 0 2\n", "the file ends where a number should be");
    refuse_text("a.ply", HEADER_4_2 SQUARE_POSITIONS "1000000 0 1 2\n3 0 2 3\n",
                "list 'vertex_indices' has 1e+06 values");
    refuse_text("a.ply", HEADER_4_2 SQUARE_POSITIONS "-3 0 1 2\n3 0 2 3\n", "list 'vertex_indices' has -3 values");
    refuse_text("a.ply", HEADER_4_2 SQUARE_POSITIONS "nan 0 1 2\n3 0 2 3\n", "list 'vertex_indices' has nan values");
}

#define STRIPS_OF(type)                                                                                                \
    ASCII "element vertex 6\n" XYZ "element tristrips 1\nproperty list int " type                                      \
          " vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 2 0\n1 2 0\n"

/* each second triangle of a strip is turned, -1 begins anew, and a vertex twice makes no triangle */
static void check_strips(pel_mesh *mesh)
{
    static const int32_t expected[6][3] = {{0, 1, 2}, {2, 1, 3}, {2, 3, 4}, {2, 3, 4}, {4, 3, 5}, {5, 3, 4}};
    check_counts(mesh, 6, 6);
    for (int32_t t = 0; t < 6; t++)
        check_triangle(mesh, t, expected[t][0], expected[t][1], expected[t][2]);
    pel_mesh_destroy(mesh);
}

static void test_strips(void **unused)
{
    (void)unused;
    /* at the end a strip with an index twice: 3 3 5 is none, but counts, so that 3 5 4 is turned */
    static const int32_t indices[] = {0, 1, 2, 3, 4, -1, 2, 3, 4, 5, -1, 3, 3, 5, 4, -1, 1, 2};
    enum { COUNT = sizeof indices / sizeof *indices };
    check_strips(parse_text("a.ply", STRIPS_OF("int") "18 0 1 2 3 4 -1 2 3 4 5 -1 3 3 5 4 -1 1 2\n", NULL));
    for (int big = 0; big < 2; big++)
        for (int is_signed = 0; is_signed < 2; is_signed++) {
            char bytes[1000];
            int size = snprintf(bytes, sizeof bytes,
                                "ply\nformat binary_%s_endian 1.0\nelement vertex 6\n" XYZ
                                "element tristrips 1\nproperty list int %s vertex_index\nend_header\n",
                                big ? "big" : "little", is_signed ? "int" : "uint");
            for (int i = 0; i < 18; i++, size += 4)
                pel_store_float(bytes + size, big, i % 3 == 0 ? (float)(i / 3 % 2) : i % 3 == 1 ? (float)(i / 6) : 0);
            pel_store_bytes(bytes + size, 4, big, COUNT);
            for (size_t i = 0; i < COUNT; i++)
                pel_store_bytes(bytes + size + 4 + 4 * i, 4, big, (uint32_t)indices[i]);
            check_strips(parse_bytes("a.ply", bytes, (size_t)size + 4 + 4 * COUNT, NULL));
        }
    refuse_text("a.ply", STRIPS_OF("int") "3 0 1 -2\n", "-2 is not a vertex index");
    refuse_text("a.ply", STRIPS_OF("int") "3 0 1 6\n", "a face uses vertex 6 but the file has 6");
    refuse_text("a.ply", STRIPS_OF("float") "3 0 1 1.5\n", "1.5 is not a vertex index");
    refuse_text("a.ply", STRIPS_OF("int") "2 0 1\n", "6 vertices and no triangles");
    refuse_text("a.ply", STRIPS_OF("int") "3 0 1\n", "the file ends where a number should be");
    refuse_text("a.ply",
                ASCII "element vertex 3\n" XYZ "element tristrips 1\nproperty int vertex_indices\nend_header\n"
                      "0 0 0\n1 0 0\n0 1 0\n3\n",
                "tristrips have no list property vertex_indices");
    /* faces and strips in one file */
    pel_mesh *mesh = parse_text("a.ply",
                                ASCII "element vertex 4\n" XYZ "element face 1\n" FACES "element tristrips 1\n" FACES
                                      "end_header\n" SQUARE_POSITIONS "3 0 1 2\n3 0 2 3\n",
                                NULL);
    check_square(mesh);
}

static void test_truncated(void **unused)
{
    (void)unused;
    /* the last number may lose digits and stay a number */
    for (size_t length = 1; length < strlen(SQUARE) - 2; length++) {
        pel_mesh *mesh;
        assert_int_equal(pel_mesh_parse("a.ply", SQUARE, length, PEL_FORMAT_PLY, NULL, &mesh, NULL), PEL_BAD_FORMAT);
        assert_null(mesh);
    }
}

static void test_allocation_failures(void **unused)
{
    (void)unused;
    assert_true(for_every_allocation_failure(parse_case, (const char *const[]){"a.ply", SQUARE}) >= 5);
    const char *with_fields =
        ASCII "element vertex 4\n" XYZ "property float a\nproperty float b_0\nproperty float b_1\n"
              "element face 1\n" FACES "end_header\n0 0 0 1 2 3 1 0 0 1 2 3 1 1 0 1 2 3 0 1 0 1 2 3 "
              "4 0 1 2 3\n";
    assert_true(for_every_allocation_failure(parse_case, (const char *const[]){"a.ply", with_fields}) >= 8);
    assert_true(
        for_every_allocation_failure(parse_case, (const char *const[]){"a.ply", STRIPS_OF("int") "4 0 1 2 3\n"}) >= 5);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_ascii),
        cmocka_unit_test(test_polygons),
        cmocka_unit_test(test_fields),
        cmocka_unit_test(test_binary_types),
        cmocka_unit_test(test_line_end_before_data),
        cmocka_unit_test(test_header_refusals),
        cmocka_unit_test(test_body_refusals),
        cmocka_unit_test(test_strips),
        cmocka_unit_test(test_truncated),
        cmocka_unit_test(test_allocation_failures),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
