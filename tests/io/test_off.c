#include "failing_malloc.h"
#include "parse.h"

static void check_square(const char *text)
{
    pel_mesh *mesh = parse_text("a.off", text, NULL);
    check_counts(mesh, 4, 2);
    check_position(mesh, 2, 1, 1, 0.25);
    check_triangle(mesh, 0, 0, 1, 2);
    check_triangle(mesh, 1, 0, 2, 3);
    pel_mesh_destroy(mesh);
}

static void test_layouts(void **unused)
{
    (void)unused;
    check_square("OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 .25\n0 1 0\n3 0 1 2\n3 0 2 3\n");
    check_square("OFF 4 2 0\r\n0 0 0\r\n1 0 0\r\n1 1 .25\r\n0 1 0\r\n3 0 1 2\r\n3 0 2 3");
    check_square(
        "# made by hand\nOFF # header\n\n# counts\n4 2\n0 0 0 # first\n1 0 0\n\n1 1 .25\n0 1 0\n3 0 1 2\n3 0 2 3\n");
    check_square("COFF\n4 2 5\n0 0 0 255 0 0 255\n1 0 0 0 0 0 0\n1 1 .25 1 1 1 1\n0 1 0 .5 .5 .5 1\n3 0 1 2 255 0 0\n"
                 "3 0 2 3\n");
    check_square("NOFF\n4 1 0\n0 0 0 0 0 1\n1 0 0 0 0 1\n1 1 .25 0 0 1\n0 1 0 0 0 1\n4 0 1 2 3\n");
}

static void test_notes(void **unused)
{
    (void)unused;
    notes said;
    pel_mesh *mesh = parse_text("a", "COFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n2 0 1\n", &said);
    check_counts(mesh, 4, 2);
    assert_non_null(strstr(said.text, "1 faces with more than three corners"));
    assert_non_null(strstr(said.text, "1 faces with fewer than three corners ignored"));
    assert_non_null(strstr(said.text, "colours"));
    pel_mesh_destroy(mesh);
}

static void test_refusals(void **unused)
{
    (void)unused;
#define START "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n"
    refuse_text("a.off", "OF\n3 1 0\n", "does not begin with OFF");
    refuse_text("a.off", "4OFF\n3 1 0\n", "four or n coordinates");
    refuse_text("a.off", "nOFF\n3 1 0\n", "four or n coordinates");
    refuse_text("a.off", "OFF BINARY\n", "binary OFF");
    refuse_text("a.off", "OFF\n", "the file ends where a number of vertices should be");
    refuse_text("a.off", "OFF\n-3 1 0\n", "a.off:2:1: error: '-3' is not a number of vertices");
    refuse_text("a.off", "OFF\n1000000000 1 0\n0 0 0\n", "a.off:2:1: error: number of vertices is 1000000000");
    refuse_text("a.off", "OFF\n3 1000000000 0\n0 0 0\n1 0 0\n0 1 0\n", "a.off:2:3: error: number of faces is");
    refuse_text("a.off", "OFF\n99999999999999999999 1 0\n", "a.off:2:1: ");
    refuse_text("a.off", "OFF\n3 1 0\n0 0 0\n1 0 inf\n0 1 0\n3 0 1 2\n", "a.off:4:5: error: 'inf' is not");
    refuse_text("a.off", START, "the file ends where a number of corners");
    refuse_text("a.off", START "3 0 1 3\n", "a.off:6:7: error: a face uses vertex 3 but the file has 3 vertices");
    refuse_text("a.off", START "3 0 1 -1\n", "a.off:6:7: error: '-1' is not a vertex index");
    refuse_text("a.off", START "3 0 1 4294967296\n", "a.off:6:7: ");
    refuse_text("a.off", START "1000000 0 1 2\n", "a.off:6:1: error: number of corners is 1000000");
    refuse_text("a.off", START "3 0 1 #c\n", "the file ends where a vertex index");
    refuse_text("a.off", START "2 0 1\n", "no triangles");
    refuse_text("a.off", "OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0\n", "3 vertices and no triangles");
    refuse_text("a.off", "OFF\n0 1 0\n3 0 1 2\n", "0 vertices");
}

static void test_truncated(void **unused)
{
    (void)unused;
    const char *text = "# a\nCOFF\n4 2 0\n0 0 0 1 1 1\n1 0 0 #c\n1 1 0\n0 1 0\n4 0 1 2 3 0.5\n3 0 1 2";
    for (size_t length = 0; length < strlen(text); length++) {
        char copy[128];
        pel_mesh *mesh;
        memcpy(copy, text, length);
        assert_int_equal(pel_mesh_parse("a.off", copy, length, PEL_FORMAT_OFF, NULL, &mesh, NULL), PEL_BAD_FORMAT);
        assert_null(mesh);
    }
}

static void test_allocation_failures(void **unused)
{
    (void)unused;
    assert_true(for_every_allocation_failure(parse_case, (const char *const[]){"a.off", START "3 0 1 2\n"}) >= 4);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_layouts),
        cmocka_unit_test(test_notes),
        cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_truncated),
        cmocka_unit_test(test_allocation_failures),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
