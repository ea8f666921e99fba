#include "failing_malloc.h"
#include "parse.h"

#include "base/memory.h"
#include "io/bytes.h"
#include "io/file.h"

#define FACET(a, b, c)                                                                                                 \
    "facet normal 0 0 1\n outer loop\n  vertex " a "\n  vertex " b "\n  vertex " c "\n endloop\nendfacet\n"
#define TWO_FACETS FACET("0 0 0", "1 0 0", "1 1 0.5") FACET("-0 0 0", "1 1 0.5", "0 1 0")

enum { START = 84, FACET_SIZE = 50, LARGEST = START + 8 * FACET_SIZE };

/* a binary file of the same two facets; returns its size */
static size_t make_binary(char *bytes, const char *title, uint32_t claimed)
{
    static const float corners[2][9] = {{0, 0, 0, 1, 0, 0, 1, 1, 0.5f}, {0, 0, 0, 1, 1, 0.5f, 0, 1, 0}};
    memset(bytes, 0, LARGEST);
    memcpy(bytes, title, strlen(title));
    pel_store_bytes(bytes + 80, 4, false, claimed);
    for (int f = 0; f < 2; f++)
        for (int i = 0; i < 9; i++)
            pel_store_float(bytes + START + FACET_SIZE * f + 12 + 4 * i, false, corners[f][i]);
    return START + 2 * FACET_SIZE;
}

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
    notes said;
    check_square(parse_text("a.stl", "solid a b c\n" TWO_FACETS "endsolid a\n", &said));
    assert_non_null(strstr(said.text, "6 corners welded into 4 vertices"));
    assert_null(strstr(said.text, "cut off"));
    check_square(parse_text("a", " SOLID\r\n" TWO_FACETS "ENDSOLID\r\n", NULL));
    check_square(parse_text("a.stl",
                            "solid one\n" FACET("0 0 0", "1 0 0", "1 1 .5") "endsolid\nsolid two\n" FACET(
                                "0 0 0", "1 1 5e-1", "0 1 0") "endsolid",
                            NULL));
    check_square(parse_text("a.stl", "solid\n" TWO_FACETS, &said));
    assert_non_null(strstr(said.text, "may be cut off"));
    check_square(parse_text("a.stl",
                            "solid\nfacet normal -nan(ind) nan 1.#IND outer loop vertex 0 0 0 vertex 1 0 0 "
                            "vertex 1 1 .5 endloop endfacet facet outer loop vertex 0 0 0 vertex 1 1 .5 vertex 0 1 0 "
                            "endloop endfacet endsolid",
                            NULL));
}

#define LINE_FACET(a, b, c) " facet normal 0 0 1 outer loop vertex " a " vertex " b " vertex " c " endloop endfacet"

/* a whole file in one line, with titles of any words */
static void test_one_line(void **unused)
{
    (void)unused;
    static const char *const titles[] = {"", " a", " made of facets", " facet", " the facet\tof a solid endsolid"};
    notes said;
    for (size_t i = 0; i < sizeof titles / sizeof *titles; i++) {
        char text[600];
        snprintf(text, sizeof text,
                 "solid%s" LINE_FACET("0 0 0", "1 0 0", "1 1 .5") " endsolid%s solid" LINE_FACET("0 0 0", "1 1 .5",
                                                                                                 "0 1 0") " endsolid%s",
                 titles[i], titles[i], titles[i]);
        check_square(parse_text("a.stl", text, &said));
        assert_null(strstr(said.text, "cut off"));
    }
    check_square(parse_text("a.stl",
                            "solid a facet outer loop vertex 0 0 0 vertex 1 0 0 vertex 1 1 .5 endloop endfacet "
                            "facet outer loop vertex 0 0 0 vertex 1 1 .5 vertex 0 1 0 endloop endfacet endsolid",
                            NULL));
}

static void test_binary(void **unused)
{
    (void)unused;
    char bytes[LARGEST];
    static const char *const titles[] = {"",  "made by hand", "solid made by hand", "solid\nfacet normal", "OFF\n",
                                         "v "};
    static const char *const names[] = {"a.stl", "a", "a.obj", "a.off"};
    for (size_t t = 0; t < sizeof titles / sizeof *titles; t++)
        for (size_t n = 0; n < sizeof names / sizeof *names; n++)
            check_square(parse_bytes(names[n], bytes, make_binary(bytes, titles[t], 2), NULL));
    notes said;
    check_square(parse_bytes("a.stl", bytes, make_binary(bytes, "longer than it says", 2) + 7, &said));
    assert_non_null(strstr(said.text, "7 bytes behind the last facet ignored"));
}

/* each facet is written with the unit normal on the side from which its corners run counter-clockwise */
static void test_normals(void **unused)
{
    (void)unused;
    double positions[6][3] = {{0, 0, 0}, {2, 0, 0}, {0, 3, 0}, {0, 0, 4}, {4, 0, 0}, {1e200, 0, 1e200}};
    const int32_t triangles[6][3] = {{0, 1, 2}, {0, 2, 1}, {0, 3, 1}, {1, 2, 3}, {0, 1, 4}, {0, 2, 5}};
    const double edge = 1 / sqrt(36 + 16 + 9);
    const double expected[6][3] = {{0, 0, 1}, {0, 0, -1}, {0, 1, 0}, {6 * edge, 4 * edge, 3 * edge},
                                   {0, 0, 0}, {0, 0, 0}};
    const pel_mesh_format formats[2] = {PEL_FORMAT_STL_ASCII, PEL_FORMAT_STL};
    for (int f = 0; f < 2; f++) {
        /* numbers too large for binary files are accepted in ASCII only */
        int32_t count = f == 0 ? 6 : 5;
        positions[5][0] = positions[5][2] = f == 0 ? 1e200 : 1;
        pel_mesh *mesh;
        char *bytes;
        size_t size;
        assert_int_equal(pel_mesh_create(positions[0], 6, triangles[0], count, &mesh, NULL), PEL_OK);
        assert_int_equal(pel_mesh_write("normals.stl", formats[f], mesh, NULL, NULL), PEL_OK);
        assert_int_equal(pel_file_read("normals.stl", &bytes, &size, NULL), PEL_OK);
        const char *at = bytes;
        for (int32_t t = 0; t < count; t++) {
            double normal[3];
            if (f == 0) {
                at = strstr(at, "facet normal ");
                assert_non_null(at);
                assert_int_equal(sscanf(at, "facet normal %lf %lf %lf", &normal[0], &normal[1], &normal[2]), 3);
                at++;
            }
            for (int i = 0; i < 3; i++) {
                if (f == 1)
                    normal[i] = pel_load_float(bytes + START + FACET_SIZE * t + 4 * i, false);
                assert_near(normal[i], expected[t][i], 1e-7);
            }
        }
        pel_mesh_destroy(mesh);
        /* nothing is missing at its end */
        notes said;
        mesh = parse_bytes("normals.stl", bytes, size, &said);
        assert_null(strstr(said.text, "cut off"));
        assert_null(strstr(said.text, "behind the last facet"));
        pel_mesh_destroy(mesh);
        pel_free(bytes);
        remove("normals.stl");
    }
}

static void test_degenerate_facets_are_dropped(void **unused)
{
    (void)unused;
    notes said;
    check_square(parse_text("a.stl",
                            "solid\n" FACET("9 9 9", "9 9 9", "1 0 0") TWO_FACETS FACET("8 0 0", "7 0 0", "8 0 -0")
                                FACET("0 0 0", "6 6 6", "6 6 6") "endsolid",
                            &said));
    assert_non_null(strstr(said.text, "3 triangles with equal corners dropped"));
    refuse_text("a.stl", "solid\n" FACET("0 0 0", "1 0 0", "1 0 0") "endsolid", "no triangles");
}

static void test_ascii_refusals(void **unused)
{
    (void)unused;
    refuse_text("a.stl", "solid a\nendsolid a\n", "no triangles");
    refuse_text("a.stl", "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 nan\n", "a.stl:4:12: error: 'nan'");
    refuse_text("a.stl", "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0\n", "the file ends");
    refuse_text("a.stl", "solid a\nfacet normal 0 0 1\nvertex 0 0 0\n",
                "a.stl:3:1: error: 'vertex' is not 'outer loop'");
    refuse_text("a.stl", "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nendloop\n", "a.stl:5:1: ");
    refuse_text("a.stl",
                "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 0 0 0\nvertex 0 0 0\nvertex 1 1 1\n",
                "a.stl:7:1: error: 'vertex' is not 'endloop'");
    refuse_text("a.stl", "solid a\nbanana\n", "a.stl:2:1: error: 'banana' is not 'solid', 'facet' or 'endsolid'");
    refuse_text("a.stl", "solid", "no triangles");
    refuse_text("a.stl", "so", "neither 'solid' nor the 84 bytes");
}

static void test_binary_refusals(void **unused)
{
    (void)unused;
    char bytes[LARGEST];
    size_t size = make_binary(bytes, "", 3);
    pel_error error = refuse_bytes("a.stl", bytes, size, "3 facets take 234 bytes but the file has 184");
    assert_int_equal(error.byte_offset, 80);
    refuse_bytes("a.stl", bytes, make_binary(bytes, "", UINT32_MAX), "4294967295 facets take 214748364834 bytes");
    refuse_bytes("a.stl", bytes, make_binary(bytes, "", 2) - 1, "2 facets take");
    make_binary(bytes, "", 0);
    refuse_bytes("a.stl", bytes, START, "no triangles");
    size = make_binary(bytes, "", 2);
    pel_store_float(bytes + START + FACET_SIZE + 12 + 8, false, NAN);
    error = refuse_bytes("a.stl", bytes, size, "a coordinate of facet 1 is nan");
    assert_int_equal(error.byte_offset, START + FACET_SIZE + 12 + 8);
    /* a normal may be anything */
    size = make_binary(bytes, "", 2);
    pel_store_float(bytes + START, false, NAN);
    check_square(parse_bytes("a.stl", bytes, size, NULL));
}

static void test_truncated(void **unused)
{
    (void)unused;
    char bytes[LARGEST];
    size_t size = make_binary(bytes, "x", 2);
    for (size_t length = 1; length < size; length++) {
        pel_mesh *mesh;
        assert_int_equal(pel_mesh_parse("a.stl", bytes, length, PEL_FORMAT_STL, NULL, &mesh, NULL), PEL_BAD_FORMAT);
        assert_null(mesh);
    }
    const char *text = "solid\n" TWO_FACETS "endsolid\n";
    for (size_t length = 1; length < strlen(text); length++) {
        pel_mesh *mesh;
        pel_status status = pel_mesh_parse("a.stl", text, length, PEL_FORMAT_STL, NULL, &mesh, NULL);
        assert_true((status == PEL_OK) == (mesh != NULL));
        pel_mesh_destroy(mesh);
    }
}

static void test_allocation_failures(void **unused)
{
    (void)unused;
    assert_true(for_every_allocation_failure(parse_case,
                                             (const char *const[]){"a.stl", "solid\n" TWO_FACETS "endsolid\n"}) >= 6);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_ascii),
        cmocka_unit_test(test_one_line),
        cmocka_unit_test(test_binary),
        cmocka_unit_test(test_normals),
        cmocka_unit_test(test_degenerate_facets_are_dropped),
        cmocka_unit_test(test_ascii_refusals),
        cmocka_unit_test(test_binary_refusals),
        cmocka_unit_test(test_truncated),
        cmocka_unit_test(test_allocation_failures),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
