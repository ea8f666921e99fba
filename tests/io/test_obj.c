#include "failing_malloc.h"
#include "parse.h"

#include <unistd.h>

static void test_square(void **unused)
{
    (void)unused;
    pel_mesh *mesh =
        parse_text("a.obj", "# a square\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1e0 0.5\nf 1 2 3\nf 1 3 4\n", NULL);
    check_counts(mesh, 4, 2);
    check_position(mesh, 3, 0, 1, 0.5);
    check_triangle(mesh, 0, 0, 1, 2);
    check_triangle(mesh, 1, 0, 2, 3);
    pel_mesh_destroy(mesh);
}

/* every way to write a corner, in every way to end a line */
static void test_corners_and_lines(void **unused)
{
    (void)unused;
    static const char *const faces[] = {
        "f 1/1 2/1 3/1",   "f 1//1 2//1 3//1", "f 1/1/1 2/1/1 3/1/1", "f -3 -2 -1",  "f -3//-1 -2//-1 -1//-1",
        "f\t1 2  3 # end", "f 1 \\\n2 3",      "f 1 2 \\\r\n 3",      "  f 1 2 3  ", "f 1/ 2/ 3/",
        "f 1 2\\\r3"};
    static const char *const ends[] = {"\n", "\r\n", "\r", "\n\n\n"};
    for (size_t i = 0; i < sizeof faces / sizeof *faces; i++) {
        for (size_t e = 0; e < sizeof ends / sizeof *ends; e++) {
            char text[256];
            snprintf(text, sizeof text, "v 0 0 0%sv 1 0 0%sv 0 1 0%s%s%s", ends[e], ends[e], ends[e], faces[i],
                     e % 2 != 0 ? "" : ends[e]);
            pel_mesh *mesh = parse_text("a.obj", text, NULL);
            check_counts(mesh, 3, 1);
            check_triangle(mesh, 0, 0, 1, 2);
            pel_mesh_destroy(mesh);
        }
    }
}

static void test_negative_indices_count_back(void **unused)
{
    (void)unused;
    pel_mesh *mesh = parse_text("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 5 5 5\nf -1 -2 -3\n", NULL);
    check_triangle(mesh, 0, 0, 1, 2);
    check_triangle(mesh, 1, 3, 2, 1);
    pel_mesh_destroy(mesh);
}

static void test_faces_before_vertices(void **unused)
{
    (void)unused;
    pel_mesh *mesh = parse_text("a.obj", "f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\n", NULL);
    check_triangle(mesh, 0, 0, 1, 2);
    pel_mesh_destroy(mesh);
}

static void test_ignored_data_is_noted(void **unused)
{
    (void)unused;
    notes said;
    pel_mesh *mesh = parse_text("a.obj",
                                "mtllib a.mtl\no thing\ng one two\ns off\nusemtl red\nv 0 0 0 1 0 0\nv 1 0 0 1.0\n"
                                "v 0 1 0\nvt 0 0\nvn 0 0 1\nvn 0 \\\n 0 1\np 1\nl 1 2 3\nf 1/1/1 2/1/1 3/1/1\n"
                                "f 1 2\ncstype bezier\n",
                                &said);
    check_counts(mesh, 3, 1);
    assert_non_null(strstr(said.text, "2 points and lines ignored"));
    assert_non_null(strstr(said.text, "colours or weights of 2 vertices"));
    assert_non_null(strstr(said.text, "normals ignored"));
    assert_non_null(strstr(said.text, "1 faces with fewer than three corners ignored"));
    assert_non_null(strstr(said.text, "1 statements for curves"));
    pel_mesh_destroy(mesh);
}

/* texture coordinates are the fields u and v, unless a vertex has none or several */
static void test_texture_coordinates(void **unused)
{
    (void)unused;
    static const double expected[3][2] = {{0.5, 0.25}, {1, 0}, {0, 2}};
    static const char *const without[][2] = {{"f 1/1 2/2 3/3\nf 3/4 2/2 1/1\n", "seams"},
                                             {"f 1/1 2/2 3\n", "some vertices have none"},
                                             {"f 1/1 2/2 3/9\n", "some vertices have none"},
                                             {"f 1/1 2/2 3/5\n", "some vertices have none"},
                                             {"f 1//1 2//1 3//1\n", "normals"}};
    static const char points[] =
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0.5 0.25\nvt 1\nvt 0 2 0.5\nvt 0 0\nvt nan 0\nvn 0 0 1\n";
    char text[300];
    notes said;
    snprintf(text, sizeof text, "%sf 1/-5 2/2/1 3/3\n", points);
    pel_mesh *mesh = parse_text("a.obj", text, &said);
    for (int v = 0; v < 3; v++) {
        assert_near(pel_mesh_field(mesh, "u")->values[v], expected[v][0], 0);
        assert_near(pel_mesh_field(mesh, "v")->values[v], expected[v][1], 0);
    }
    assert_null(strstr(said.text, "texture"));
    pel_mesh_destroy(mesh);
    for (size_t i = 0; i < sizeof without / sizeof *without; i++) {
        snprintf(text, sizeof text, "%s%s", points, without[i][0]);
        mesh = parse_text("a.obj", text, &said);
        assert_null(pel_mesh_field(mesh, "u"));
        assert_non_null(strstr(said.text, without[i][1]));
        pel_mesh_destroy(mesh);
    }
}

/* colours of all vertices are the fields red, green and blue; where one has none, or a weight, they are ignored */
static void test_colours(void **unused)
{
    (void)unused;
    static const char *const fields[3] = {"red", "green", "blue"};
    static const double expected[3][3] = {{1, 0, 0.5}, {0, 0.25, 0}, {0, 1, 1}};
    static const char *const without[] = {
        "v 0 0 0 1 0 0\nv 1 0 0\nv 0 1 0 0 1 1\n", "v 0 0 0 1 0 0\nv 1 0 0 1\nv 0 1 0 0 1 1\n",
        "v 0 0 0 1 1 0 0\nv 1 0 0 1 0 1 0\nv 0 1 0 1 0 1 1\n", "v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 nan 1 1\n"};
    notes said;
    pel_mesh *mesh =
        parse_text("a.obj", "v 0 0 0 1 0 0.5\nv 1 0 0 0 0.25 0\nv 0 1 0 0 1 1\no a\nf 1 2 3\no b\nf 1 3 2\n", &said);
    for (int v = 0; v < 3; v++)
        for (int i = 0; i < 3; i++)
            assert_near(pel_mesh_field(mesh, fields[i])->values[v], expected[v][i], 0);
    assert_null(strstr(said.text, "colours"));
    pel_mesh_destroy(mesh);
    for (size_t i = 0; i < sizeof without / sizeof *without; i++) {
        char text[200];
        snprintf(text, sizeof text, "%sf 1 2 3\n", without[i]);
        mesh = parse_text("a.obj", text, &said);
        assert_null(pel_mesh_field(mesh, "red"));
        assert_non_null(strstr(said.text, "colours or weights of"));
        pel_mesh_destroy(mesh);
    }
}

static void test_polygons_are_cut(void **unused)
{
    (void)unused;
    notes said;
    /* a convex quad, then an arrow head whose first diagonal lies outside */
    pel_mesh *mesh = parse_text("a.obj",
                                "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 1 0\nv 0.5 0.5 0\nf 1 2 3 4\nf 1 3 5\n"
                                "f 4 6 2 5\n",
                                &said);
    check_counts(mesh, 6, 5);
    check_triangle(mesh, 0, 0, 1, 2);
    check_triangle(mesh, 1, 0, 2, 3);
    check_triangle(mesh, 2, 0, 2, 4);
    assert_non_null(strstr(said.text, "2 faces with more than three corners cut into 4 triangles"));
    pel_mesh_destroy(mesh);
}

static void test_refusals(void **unused)
{
    (void)unused;
#define CORNERS "v 0 0 0\nv 1 0 0\nv 0 1 0\n"
    refuse_text("a.obj", "v 0 0 0\nv 1 zero 0\n", "a.obj:2:5: error: 'zero' is not a finite coordinate");
    refuse_text("a.obj", "v 0 0 0\nv nan 0 0\n", "a.obj:2:3: error: 'nan' is not a finite");
    refuse_text("a.obj", "v 0 0 0\r\nv 0 -inf 0\r\n", "a.obj:2:5: ");
    refuse_text("a.obj", "v 0 0 0\rv 0 1e999 0\r", "a.obj:2:5: ");
    /* long words and those with other signs are not shown: a file that is no mesh may hold secrets */
    refuse_text("a.obj", "v 0 0 abcdefghijklmnopqrstuvwxyz\n", "a.obj:1:7: error: this word is not a finite");
    refuse_text("a.obj", "v 0 0 abcdefghijklmnopqrstu\n", "a.obj:1:7: error: 'abcdefghijklmnopqrstu' is not");
    refuse_text("a.obj", "root:$6$ab:0\n", "a.obj:1:1: error: this word is not an OBJ statement");
    refuse_text("a.obj", "v 0 0 1,5\n", "a.obj:1:7: error: '1,5' is not");
    refuse_text("a.obj", "v 0 0\n", "a.obj:1:6: error: the line ends");
    refuse_text("a.obj", "v 0 0", "the file ends");
    refuse_text("a.obj", "v 0 0 0x\n", "a.obj:1:7: error: '0x' is not");
    refuse_text("a.obj", CORNERS "f 0 1 2\n", "a.obj:4:3: error: a face uses vertex 0");
    refuse_text("a.obj", CORNERS "f 1 2 3\nf 1 2 4\nf 1 2 3\n", "a.obj:5:7: error: a face uses vertex 4");
    refuse_text("a.obj", CORNERS "f 1 2 -4\n", "a.obj:4:7: error: a face uses vertex -4");
    refuse_text("a.obj", CORNERS "f 1 2 99999999999\n", "a.obj:4:7: error: a face uses vertex 99999999999");
    refuse_text("a.obj", CORNERS "f 1 2 99999999999999999999999\n", "a.obj:4:7: ");
    refuse_text("a.obj", CORNERS "f 1 2 -9223372036854775808\n", "a.obj:4:7: ");
    refuse_text("a.obj", CORNERS "f 1 2 3.5\n", "a.obj:4:7: error: '3.5' is not a face corner");
    refuse_text("a.obj", CORNERS "f 1/1/1/1 2 3\n", "a.obj:4:3: ");
    refuse_text("a.obj", CORNERS "f 1 2 x\n", "a.obj:4:7: error: 'x' is not a vertex number");
    refuse_text("a.obj", CORNERS "bogus\nf 1 2 3\n", "a.obj:4:1: error: 'bogus' is not an OBJ statement");
    refuse_text("a.obj", CORNERS, "3 vertices and no triangles");
    refuse_text("a.obj", "f 1 2 3\n", "a face uses vertex 3 but the file has 0 vertices");
    refuse_text("a.obj", "# nothing\n", "no triangles");
    refuse_text("a.obj", "\\", "not an OBJ statement");
    refuse_bytes("a.obj", "v 0 0 0\0\nf 1 1 1\n", 17, "a.obj:1:7: ");
    pel_error error = refuse_bytes("a.obj", "", 0, "empty");
    assert_true(error.line == 0 && error.column == 0 && strcmp(error.file, "a.obj") == 0);
}

/* every prefix of a file either parses or fails; none crashes (run under the address sanitizer) */
static void test_truncated(void **unused)
{
    (void)unused;
    const char *text = "v 0 0 0 1 \\\n0 0\r\nv 1.5e-3 0 0\nv 0 1 0\nvn 1 0 \\\r\n 0\nf 1/2/3 2//3 \\\n3/1\nl 1 2 # end";
    for (size_t length = 0; length <= strlen(text); length++) {
        char copy[128];
        pel_mesh *mesh;
        memcpy(copy, text, length);
        pel_status status = pel_mesh_parse("a.obj", copy, length, PEL_FORMAT_OBJ, NULL, &mesh, NULL);
        assert_true(status == PEL_OK || status == PEL_BAD_FORMAT);
        assert_true((status == PEL_OK) == (mesh != NULL));
        pel_mesh_destroy(mesh);
    }
}

/* an object begins where the body changes, to a higher or a lower number; negative numbers have none */
static void test_objects_of_bodies(void **unused)
{
    (void)unused;
    static const char path[] = "test_obj_bodies.obj", objects[] = "o body_0\nf 1 2 3\nf 1 2 3\n"
                                                                  "o body_2\nf 4 5 6\n"
                                                                  "o body_1\nf 7 8 9\n"
                                                                  "f 10 11 12\n"
                                                                  "o body_0\nf 1 2 3\n";
    static const int bodies[] = {0, 2, 1, -1}, order[] = {0, 0, 1, 2, 3, 0};
    double positions[12][3] = {{0}}, numbers[12];
    int32_t triangles[6][3];
    for (int v = 0; v < 12; v++) {
        positions[v][v % 3] = 1 + v / 3;
        numbers[v] = bodies[v / 3];
    }
    for (int t = 0; t < 6; t++)
        for (int i = 0; i < 3; i++)
            triangles[t][i] = 3 * order[t] + i;
    pel_mesh *mesh;
    assert_int_equal(pel_mesh_create(positions[0], 12, triangles[0], 6, &mesh, NULL), PEL_OK);
    assert_int_equal(pel_mesh_add_field(mesh, "body", 1, numbers, NULL), PEL_OK);
    assert_int_equal(pel_mesh_write(path, PEL_FORMAT_OBJ, mesh, NULL, NULL), PEL_OK);
    char text[1000] = "";
    FILE *file = fopen(path, "r");
    assert_non_null(file);
    text[fread(text, 1, sizeof text - 1, file)] = '\0';
    fclose(file);
    const char *first = strstr(text, "o body_0");
    assert_non_null(first);
    assert_string_equal(first, objects);
    pel_mesh_destroy(mesh);
    unlink(path);
}

/* the vertices of a group, as digits; "" if there is no such field */
static const char *vertices_of(const pel_mesh *mesh, const char *group, char text[16])
{
    char name[80];
    int length = 0;
    snprintf(name, sizeof name, "group:%s", group);
    const pel_field *field = pel_mesh_field(mesh, name);
    for (int32_t v = 0; field != NULL && v < mesh->vertex_count; v++)
        if (field->values[v] > 0.5)
            text[length++] = (char)('0' + v);
    text[length] = '\0';
    return text;
}

static void test_groups(void **unused)
{
    (void)unused;
    char text[16];
    pel_mesh *mesh =
        parse_text("a.obj",
                   "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\no whole\nusemtl red\ng one both\nf 1 2 3\n"
                   "g two both # a comment\nf 1 3 4\nusemtl blue\ng\nf 2 5 3\n",
                   NULL);
    assert_string_equal(vertices_of(mesh, "one", text), "012");
    assert_string_equal(vertices_of(mesh, "two", text), "023");
    assert_string_equal(vertices_of(mesh, "both", text), "0123");
    assert_string_equal(vertices_of(mesh, "red", text), "0123");
    assert_string_equal(vertices_of(mesh, "blue", text), "124");
    /* what holds for all faces selects nothing */
    assert_string_equal(vertices_of(mesh, "whole", text), "");
    assert_int_equal(mesh->field_count, 5);
    pel_mesh_destroy(mesh);
    /* more names than a reader keeps */
    char many[4000] = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    for (int i = 0; i < 70; i++)
        snprintf(many + strlen(many), sizeof many - strlen(many), "g part%d\nf 1 2 3\n", i);
    notes said;
    mesh = parse_text("a.obj", many, &said);
    assert_int_equal(mesh->field_count, 64);
    assert_non_null(strstr(said.text, "groups beyond the first 64 names ignored"));
    pel_mesh_destroy(mesh);
}

static void test_allocation_failures(void **unused)
{
    (void)unused;
    assert_true(for_every_allocation_failure(parse_case, (const char *const[]){"a.obj", CORNERS "f 1 2 3\n"}) >= 4);
    assert_true(
        for_every_allocation_failure(parse_case, (const char *const[]){"a.obj", CORNERS "v 1 1 0\nf 1 2 4 3\n"}) >= 5);
    assert_true(for_every_allocation_failure(
                    parse_case, (const char *const[]){"a.obj", CORNERS "v 1 1 0\nf 1 2 4\ng a\nf 1 4 3\n"}) >= 8);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_square),
        cmocka_unit_test(test_corners_and_lines),
        cmocka_unit_test(test_negative_indices_count_back),
        cmocka_unit_test(test_faces_before_vertices),
        cmocka_unit_test(test_ignored_data_is_noted),
        cmocka_unit_test(test_texture_coordinates),
        cmocka_unit_test(test_colours),
        cmocka_unit_test(test_polygons_are_cut),
        cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_truncated),
        cmocka_unit_test(test_objects_of_bodies),
        cmocka_unit_test(test_groups),
        cmocka_unit_test(test_allocation_failures),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
