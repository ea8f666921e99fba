/* Files with tetrahedra: the same two in each format, errors with their places, whole files and files cut off at every
   length, and memory that runs out. */
#include "check.h"

#include "../fuzz/fuzz_filled.h"
#include "../io/parse.h"
#include "base/memory.h"
#include "failing_malloc.h"
#include "io/file.h"
#include "source_dir.h"

#include <dirent.h>
#include <stdlib.h>
#include <unistd.h>

#define CORPUS PEL_SOURCE_DIR "/tests/fuzz/corpus/"

/* the tetrahedra (0, 1, 2, 3) and (1, 4, 2, 3) on the corners of a cube: volumes of 1/6 and 1/3 */
static void check_two(const char *path)
{
    pel_mesh *mesh;
    pel_error error;
    if (pel_mesh_read_filled(path, NULL, &mesh, &error) != PEL_OK)
        fail_msg("%s: %s", path, error.what);
    double volumes[2], sum = 0;
    assert_int_equal(mesh->tetrahedron_count, 2);
    assert_int_equal(mesh->vertex_count, 5);
    assert_int_equal(mesh->triangle_count, 6);
    for (int t = 0; t < 2; t++) {
        double x[4][3];
        for (int k = 0; k < 4; k++)
            memcpy(x[k], mesh->positions[mesh->tetrahedra[t][k]], sizeof x[k]);
        volumes[t] = pel_tetrahedron_volume((const double(*)[3])x);
        sum += volumes[t];
    }
    assert_near(volumes[0], 1.0 / 6, 1e-15);
    assert_near(sum, 0.5, 1e-15);
    pel_mesh_destroy(mesh);
}

static void test_formats(void **unused)
{
    (void)unused;
    static const char *const files[] = {"msh/two.msh",        "msh/new.msh",       "msh/inverted.msh", "vtk/two.vtk",
                                        "vtk/five.vtk",       "vtu/two.vtu",       "vtu/binary.vtu",   "vtu/packed.vtu",
                                        "msh/two_binary.msh", "msh/new_binary.msh"};
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        char path[1000];
        snprintf(path, sizeof path, "%s%s", CORPUS, files[i]);
        check_two(path);
    }
    pel_mesh *quadratic;
    assert_int_equal(pel_mesh_read_filled(CORPUS "msh/quadratic.msh", NULL, &quadratic, NULL), PEL_OK);
    assert_true(quadratic->vertex_count == 4 && quadratic->tetrahedron_count == 1);
    pel_mesh_destroy(quadratic);
    assert_true(pel_mesh_is_filled_file("a.b/c.ele") && !pel_mesh_is_filled_file("a.msh/c") &&
                !pel_mesh_is_filled_file(NULL));
}

static void test_errors(void **unused)
{
    (void)unused;
    static const struct {
        const char *file, *what;
        int32_t line;
    } cases[] = {{"msh/one_inverted.msh", "tetrahedron 1 of the file is turned inside out", 20},
                 {"msh/missing_node.msh", "node 6, which does not exist", 21},
                 {"msh/flat.msh", "tetrahedron 2 of the file has no volume", 21},
                 {"msh/hexahedron.msh", "hexahedron", 21},
                 {"msh/twice.msh", "two nodes have the tag 40", 0},
                 {"msh/binary_short.msh", "ends too early", 0},
                 {"msh/binary_order.msh", "another order", 0},
                 {"msh/binary_nan.msh", "coordinate", 0},
                 {"msh/binary_count.msh", "more than the file can hold", 0},
                 {"msh/version_1.msh", "$MeshFormat", 1},
                 {"msh/version_40.msh", "version of the format is 4", 2},
                 {"msh/surface.msh", "no tetrahedra", 1},
                 {"msh/billion.msh", "more than the file can hold", 9},
                 {"msh/three_on_a_face.msh", "more than two tetrahedra", 0},
                 {"msh/no_surface.msh", "has no surface", 0},
                 {"vtk/binary.vtk", "binary", 3},
                 {"vtk/polydata.vtk", "no unstructured grid", 4},
                 {"vtk/voxel.vtk", "another shape", 10},
                 {"vtk/short.vtk", "longer than CELLS says", 11},
                 {"vtk/types.vtk", "not as many as the cells", 12},
                 {"vtk/no_types.vtk", "ends before the types", 0},
                 {"vtk/wrong_index.vtk", "tetrahedron 2 of the file has a node that does not exist", 10},
                 {"vtk/negative.vtk", "tetrahedron 2 of the file has a node that does not exist", 10},
                 {"vtk/offsets.vtk", "offset 2", 0},
                 {"vtu/polydata.vtu", "no", 0},
                 {"vtu/no_types.vtu", "types of the cells are missing", 0},
                 {"vtu/voxel.vtu", "another shape", 0},
                 {"vtu/three_corners.vtu", "has 3 points", 0},
                 {"vtu/wrong_index.vtu", "tetrahedron 2 of the file has a node that does not exist", 0}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char path[1000];
        pel_mesh *mesh;
        pel_error error = {0};
        snprintf(path, sizeof path, "%s%s", CORPUS, cases[i].file);
        assert_int_equal(pel_mesh_read_filled(path, NULL, &mesh, &error), PEL_BAD_FORMAT);
        if (strstr(error.what, cases[i].what) == NULL || (cases[i].line > 0 && error.line != cases[i].line))
            fail_msg("%s:%d: %s", cases[i].file, (int)error.line, error.what);
        assert_true(error.remedy[0] != '\0' && strcmp(error.file, path) == 0 && mesh == NULL);
    }
}

static size_t append(char *bytes, size_t length, const void *data, size_t size)
{
    memcpy(bytes + length, data, size);
    return length + size;
}

/* binary, as Gmsh writes a mesh of second order: triangles of six nodes, then tetrahedra of ten, of which the corners
 * count */
static void test_second_order(void **unused)
{
    (void)unused;
    static const double corners[5][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}};
    static const int32_t triangles[2][8] = {{1, 7, 1, 2, 3, 6, 6, 6}, {2, 7, 2, 5, 3, 6, 6, 6}};
    static const int32_t tetra[2][12] = {{3, 7, 1, 2, 3, 4, 6, 6, 6, 6, 6, 6}, {4, 7, 2, 5, 3, 4, 6, 6, 6, 6, 6, 6}};
    static const int32_t one = 1, heads[2][3] = {{9, 2, 1}, {11, 2, 1}};
    static const char text[] = "$MeshFormat\n2.2 1 8\n";
    char bytes[2000], middle[] = "\n$EndMeshFormat\n$Nodes\n6\n", elements[] = "\n$EndNodes\n$Elements\n4\n";
    size_t length = append(bytes, 0, text, strlen(text));
    length = append(bytes, length, &one, sizeof one);
    length = append(bytes, length, middle, strlen(middle));
    for (int32_t v = 1; v <= 6; v++) {
        length = append(bytes, length, &v, sizeof v);
        length = append(bytes, length, corners[v < 6 ? v - 1 : 0], sizeof *corners);
    }
    length = append(bytes, length, elements, strlen(elements));
    length = append(bytes, length, heads[0], sizeof *heads);
    length = append(bytes, length, triangles, sizeof triangles);
    length = append(bytes, length, heads[1], sizeof *heads);
    length = append(bytes, length, tetra, sizeof tetra);
    length = append(bytes, length, "\n$EndElements\n", 14);
    FILE *file = fopen("test_read.msh", "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, length, file), length);
    fclose(file);
    check_two("test_read.msh");
    unlink("test_read.msh");
    notes said = {0};
    const pel_log log = log_to(&said);
    pel_mesh *mesh;
    assert_int_equal(pel_mesh_parse_filled("a.msh", bytes, length, &log, &mesh, NULL), PEL_OK);
    assert_non_null(strstr(said.text, "2 tetrahedra have nodes on their edges"));
    assert_non_null(strstr(said.text, "1 nodes that belong to no tetrahedron"));
    pel_mesh_destroy(mesh);
}

/* of Gmsh's formats only 2 and 4.1 are read */
static void test_versions(void **unused)
{
    (void)unused;
    static const char *const versions[] = {"1.9", "2", "2.2", "2.9", "3", "4", "4.1", "4.9", "5"};
    static const bool reads[] = {false, true, true, true, false, false, true, true, false};
    for (size_t i = 0; i < sizeof versions / sizeof *versions; i++) {
        char text[60];
        pel_mesh *mesh;
        pel_error error;
        snprintf(text, sizeof text, "$MeshFormat\n%s 0 8\n$EndMeshFormat\n", versions[i]);
        assert_int_equal(pel_mesh_parse_filled("a.msh", text, strlen(text), NULL, &mesh, &error), PEL_BAD_FORMAT);
        assert_true((strstr(error.what, "version") == NULL) == reads[i]);
    }
}

/* from version 5 on cells are offsets and connectivity, before they are lists */
static void test_versions_of_vtk(void **unused)
{
    (void)unused;
    static const struct {
        const char *file, *version;
        pel_status status;
    } cases[] = {{"vtk/two.vtk", "1.0", PEL_OK},         {"vtk/two.vtk", "4.2", PEL_OK},
                 {"vtk/two.vtk", "5.0", PEL_BAD_FORMAT}, {"vtk/five.vtk", "4.9", PEL_BAD_FORMAT},
                 {"vtk/five.vtk", "5.0", PEL_OK},        {"vtk/five.vtk", "5.1", PEL_OK}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char path[1000], *bytes;
        size_t size;
        pel_mesh *mesh;
        snprintf(path, sizeof path, "%s%s", CORPUS, cases[i].file);
        assert_int_equal(pel_file_read(path, &bytes, &size, NULL), PEL_OK);
        memcpy(strstr(bytes, "Version ") + 8, cases[i].version, 3);
        assert_int_equal(pel_mesh_parse_filled("a.vtk", bytes, size, NULL, &mesh, NULL), cases[i].status);
        pel_mesh_destroy(mesh);
        pel_free(bytes);
    }
}

static void write_text(const char *path, const char *text)
{
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fputs(text, file);
    fclose(file);
}

static const char nodes[] = "# nodes\n5 3 0 0\n0 0 0 0\n1 1 0 0\n2 0 1 0\n3 0 0 1\n4 1 1 1\n";
static const char tetrahedra[] = "2 4 0\n0 0 1 2 3\n1 1 4 2 3 # the larger\n";

static void test_tetgen(void **unused)
{
    (void)unused;
    pel_mesh *mesh;
    pel_error error;
    write_text("test_read.node", nodes);
    write_text("test_read.ele", tetrahedra);
    check_two("test_read.node");
    check_two("test_read.ele");
    write_text("test_read.node", "5 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 1 1 1\n");
    write_text("test_read.ele", "2 4 0\n1 1 2 3 4\n2 2 5 3 4\n");
    check_two("test_read.ele");
    write_text("test_read.ele", "2 4 0\n1 1 2 3 4\n2 2 6 3 4\n");
    assert_int_equal(pel_mesh_read_filled("test_read.node", NULL, &mesh, &error), PEL_BAD_FORMAT);
    assert_true(error.line == 3 && strcmp(error.file, "test_read.ele") == 0);
    write_text("test_read.ele", "2 3 0\n1 1 2 3\n2 2 6 3\n");
    assert_int_equal(pel_mesh_read_filled("test_read.node", NULL, &mesh, &error), PEL_BAD_FORMAT);
    assert_non_null(strstr(error.what, "3 corners"));
    write_text("test_read.node", "2 3 0 0\n1 0 0 0\n3 1 0 0\n");
    assert_int_equal(pel_mesh_read_filled("test_read.node", NULL, &mesh, &error), PEL_BAD_FORMAT);
    assert_true(error.line == 3 && strcmp(error.file, "test_read.node") == 0);
    unlink("test_read.ele");
    write_text("test_read.node", nodes);
    assert_int_equal(pel_mesh_read_filled("test_read.node", NULL, &mesh, &error), PEL_BAD_FILE);
    unlink("test_read.node");
    assert_int_equal(pel_mesh_parse_filled("a.node", nodes, sizeof nodes, NULL, &mesh, &error), PEL_BAD_FORMAT);
}

/* every file of a corpus, whole and cut off at every length */
static void test_corpus(void **unused)
{
    (void)unused;
    static const char *const folders[] = {"msh", "vtk", "vtu"};
    for (size_t f = 0; f < 3; f++) {
        char folder[600], path[1000], name[16];
        snprintf(folder, sizeof folder, "%s%s", CORPUS, folders[f]);
        snprintf(name, sizeof name, "cut.%s", folders[f]);
        DIR *stream = opendir(folder);
        int count = 0;
        assert_non_null(stream);
        for (struct dirent *entry = readdir(stream); entry != NULL; entry = readdir(stream)) {
            char *bytes;
            size_t size;
            if (entry->d_name[0] == '.')
                continue;
            snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
            assert_int_equal(pel_file_read(path, &bytes, &size, NULL), PEL_OK);
            for (size_t length = 0; length <= size; length++) {
                uint8_t *cut = pel_allocate(length, 1);
                assert_non_null(cut);
                memcpy(cut, bytes, length);
                fuzz_parse_filled(name, cut, length);
                pel_free(cut);
            }
            pel_free(bytes);
            count++;
        }
        closedir(stream);
        assert_true(count >= 8);
    }
}

static pel_status read_one(const void *path, pel_error *error)
{
    pel_mesh *mesh;
    pel_status status = pel_mesh_read_filled(path, NULL, &mesh, error);
    pel_mesh_destroy(mesh);
    return status;
}

static void test_memory(void **unused)
{
    (void)unused;
    static const char *const files[] = {CORPUS "msh/new.msh", CORPUS "vtk/five.vtk", CORPUS "vtu/packed.vtu",
                                        "test_read.node"};
    write_text("test_read.node", nodes);
    write_text("test_read.ele", tetrahedra);
    for (size_t i = 0; i < sizeof files / sizeof *files; i++)
        for_every_allocation_failure(read_one, files[i]);
    unlink("test_read.node");
    unlink("test_read.ele");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_formats),  cmocka_unit_test(test_errors),          cmocka_unit_test(test_second_order),
        cmocka_unit_test(test_versions), cmocka_unit_test(test_versions_of_vtk), cmocka_unit_test(test_tetgen),
        cmocka_unit_test(test_corpus),   cmocka_unit_test(test_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
