#include "check.h"
#include "failing_malloc.h"
#include "random.h"

#include "base/memory.h"
#include "mesh/seam.h"
#include "pellicle/mesh_check.h"
#include "pellicle/shape.h"

static pel_mesh *make_shape(const char *name)
{
    pel_shape_def def;
    pel_mesh *mesh;
    assert_int_equal(pel_shape_def_of_name(name, &def, NULL), PEL_OK);
    assert_int_equal(pel_shape_create(&def, &mesh, NULL), PEL_OK);
    return mesh;
}

/* a copy in which corners have vertices of their own: all of them, or each with probability 1/2 */
static pel_mesh *explode(const pel_mesh *mesh, random_state *random, bool all, int32_t *source_of)
{
    const int32_t corner_count = 3 * mesh->triangle_count;
    double(*positions)[3] = pel_allocate((size_t)(mesh->vertex_count + corner_count), sizeof *positions);
    int32_t(*triangles)[3] = pel_allocate((size_t)mesh->triangle_count, sizeof *triangles);
    int32_t *copy_of = pel_allocate((size_t)mesh->vertex_count, sizeof *copy_of), count = 0;
    assert_true(positions != NULL && triangles != NULL && copy_of != NULL);
    for (int32_t h = 0; h < corner_count; h++) {
        const int32_t v = mesh->triangles[h / 3][h % 3];
        int32_t *copy = &triangles[h / 3][h % 3];
        *copy = copy_of[v] - 1;
        if (copy_of[v] > 0 && !all && random_between(random, 0, 1) < 0.5)
            continue;
        memcpy(positions[count], mesh->positions[v], sizeof *positions);
        source_of[count] = v;
        *copy = count++;
        copy_of[v] = count;
    }
    pel_mesh *made;
    assert_int_equal(pel_mesh_create(positions[0], count, triangles[0], mesh->triangle_count, &made, NULL), PEL_OK);
    pel_free(positions);
    pel_free(triangles);
    pel_free(copy_of);
    return made;
}

/* any surface comes back from its corners, with each vertex at the number of its first corner */
static void test_soups(void **unused)
{
    (void)unused;
    static const char *const shapes[] = {"geodesic-sphere", "uv-sphere", "grid",    "torus",
                                         "capsule",         "disk",      "cylinder"};
    random_state random = {.seed = 7};
    for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++)
        for (int round = 0; round < 4; round++) {
            pel_mesh *mesh = make_shape(shapes[i]);
            int32_t *source_of = pel_allocate((size_t)(4 * mesh->triangle_count), sizeof *source_of), *map;
            pel_mesh *soup = explode(mesh, &random, round == 0, source_of);
            const int32_t before = soup->vertex_count;
            assert_int_equal(pel_seams_weld(soup, &map, NULL, NULL), PEL_OK);
            assert_int_equal(soup->vertex_count, mesh->vertex_count);
            for (int32_t t = 0; t < mesh->triangle_count; t++)
                for (int k = 0; k < 3; k++)
                    assert_memory_equal(soup->positions[soup->triangles[t][k]], mesh->positions[mesh->triangles[t][k]],
                                        sizeof *mesh->positions);
            assert_true((map != NULL) == (before > mesh->vertex_count));
            for (int32_t v = 0, next = 0; map != NULL && v < before; v++) {
                assert_memory_equal(soup->positions[map[v]], mesh->positions[source_of[v]], sizeof *mesh->positions);
                assert_true(map[v] <= next);
                next += map[v] == next;
            }
            pel_free(map);
            /* nothing is left to weld */
            assert_int_equal(pel_seams_weld(soup, &map, NULL, NULL), PEL_OK);
            assert_null(map);
            pel_free(source_of);
            pel_mesh_destroy(soup);
            pel_mesh_destroy(mesh);
        }
}

/* a mesh of letters, one for each vertex, that stand for places in a plane grid; returns vertices left and seams */
static int32_t weld_of(const double (*positions)[3], int32_t vertex_count, const int32_t (*triangles)[3],
                       int32_t triangle_count, pel_seams *seams)
{
    int32_t map[64], count;
    assert_int_equal(pel_seams_find(positions, vertex_count, triangles, triangle_count, 0, map, &count, seams), PEL_OK);
    return count;
}

static void test_what_stays_open(void **unused)
{
    (void)unused;
    static const double o[3] = {0, 0, 0}, x[3] = {1, 0, 0}, y[3] = {0, 1, 0}, z[3] = {0, 0, 1}, w[3] = {0, 0, -1},
                        m[3] = {0, -1, 0};
    pel_seams seams;
    double p[12][3];
    const double *const hinge[] = {o, x, y, x, o, m, x, o, z, x, o, w};
    for (int i = 0; i < 12; i++)
        memcpy(p[i], hinge[i], sizeof p[i]);
    static const int32_t triangles[4][3] = {{0, 1, 2}, {3, 4, 5}, {6, 7, 8}, {9, 10, 11}};
    /* two sheets at an edge are one; a third one makes it a choice, and so does a fourth */
    assert_int_equal(weld_of((const double(*)[3])p, 6, triangles, 2, &seams), 4);
    assert_true(seams.closed_count == 1 && seams.open_count == 0);
    assert_int_equal(weld_of((const double(*)[3])p, 9, triangles, 3, &seams), 9);
    assert_true(seams.closed_count == 0 && seams.open_count == 1);
    assert_int_equal(weld_of((const double(*)[3])p, 12, triangles, 4, &seams), 12);
    assert_true(seams.closed_count == 0 && seams.open_count == 1);
    /* two that run alike, such as a sheet that stands twice */
    static const int32_t alike[2][3] = {{0, 1, 2}, {7, 6, 5}};
    assert_int_equal(weld_of((const double(*)[3])p, 8, alike, 2, &seams), 8);
    assert_true(seams.closed_count == 0 && seams.open_count == 1);
    /* vertices that touch, without an edge */
    static const int32_t touch[2][3] = {{0, 1, 2}, {4, 8, 5}};
    assert_int_equal(weld_of((const double(*)[3])p, 9, touch, 2, &seams), 9);
    assert_true(seams.closed_count == 0 && seams.open_count == 0);
    /* not equal but near */
    p[3][0] = nextafter(1, 2);
    assert_int_equal(weld_of((const double(*)[3])p, 6, triangles, 2, &seams), 6);
    int32_t map[12], count;
    assert_int_equal(pel_seams_find((const double(*)[3])p, 6, triangles, 2, 1e-9, map, &count, &seams), PEL_OK);
    assert_true(count == 4 && seams.closed_count == 1);
}

/* The two sides of a seam differ by the rounding of a file, at any place: sewn. A slit that is wider, or as wide as a
   detail of the mesh, is a slit. */
static void test_rounding(void **unused)
{
    (void)unused;
    const struct {
        double place, gap, detail;
        int32_t count;
    } cases[] = {{0, 1e-6, 1, 4},    {0, 1e-5, 1, 6},   {0, 1e-6, 5e-6, 6},
                 {0, 2e-7, 5e-6, 4}, {1e4, 1e-6, 1, 4}, {1e9, 2e-7, 1, 6}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const double at = cases[i].place, gap = cases[i].gap, detail = cases[i].detail;
        const double positions[6][3] = {{at, 0, 0},       {at + 1, 0, 0}, {at, detail, 0},
                                        {at + 1, gap, 0}, {at, gap, 0},   {at, -1, 0}};
        static const int32_t triangles[2][3] = {{0, 1, 2}, {3, 4, 5}};
        pel_mesh *mesh;
        assert_int_equal(pel_mesh_create(positions[0], 6, triangles[0], 2, &mesh, NULL), PEL_OK);
        assert_int_equal(pel_seams_weld(mesh, NULL, NULL, NULL), PEL_OK);
        if (mesh->vertex_count != cases[i].count)
            fail_msg("case %zu: %d vertices", i, (int)mesh->vertex_count);
        pel_mesh_destroy(mesh);
    }
}

/* two closed bodies that share a face, and one that touches itself */
static void test_closed_bodies(void **unused)
{
    (void)unused;
    static const double p[5][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, -1}};
    static const int32_t up[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
    static const int32_t down[4][3] = {{0, 1, 2}, {1, 0, 4}, {2, 1, 4}, {0, 2, 4}};
    double positions[10][3];
    int32_t triangles[8][3];
    pel_seams seams;
    for (int i = 0; i < 10; i++)
        memcpy(positions[i], p[i % 5], sizeof positions[i]);
    for (int t = 0; t < 8; t++)
        for (int k = 0; k < 3; k++)
            triangles[t][k] = t < 4 ? up[t][k] : 5 + down[t - 4][k];
    assert_int_equal(weld_of((const double(*)[3])positions, 10, (const int32_t(*)[3])triangles, 8, &seams), 10);
    assert_true(seams.closed_count == 0 && seams.open_count == 0);
    /* without the faces between them, their borders are sewn: one body */
    int32_t outer[6][3];
    memcpy(outer, triangles + 1, 3 * sizeof *outer);
    memcpy(outer + 3, triangles + 5, 3 * sizeof *outer);
    assert_int_equal(weld_of((const double(*)[3])positions, 10, (const int32_t(*)[3])outer, 6, &seams), 7);
    assert_int_equal(seams.closed_count, 3);
}

/* sewing both seams of this strip would leave an edge with three triangles */
static void test_transitive(void **unused)
{
    (void)unused;
    random_state random = {.seed = 11};
    for (int round = 0; round < 3000; round++) {
        double positions[14][3];
        int32_t triangles[10][3];
        for (int v = 0; v < 14; v++)
            for (int i = 0; i < 3; i++)
                positions[v][i] = floor(2 * random_between(&random, 0, 1));
        for (int t = 0; t < 10; t++)
            for (int k = 0; k < 3; k++)
                triangles[t][k] = (int32_t)(14 * random_between(&random, 0, 1));
        int32_t map[14], count;
        pel_seams seams;
        assert_int_equal(pel_seams_find((const double(*)[3])positions, 14, (const int32_t(*)[3])triangles, 10, 0, map,
                                        &count, &seams),
                         PEL_OK);
        /* brute force: no edge gets worse */
        for (int a = 0; a < 14; a++) {
            for (int b = 0; b < 14; b++)
                if (map[a] == map[b])
                    assert_memory_equal(positions[a], positions[b], sizeof *positions);
            for (int b = 0; b < count; b++) {
                int after = 0, most = 0, own[14][14] = {{0}};
                for (int h = 0; h < 30; h++) {
                    const int32_t *t = triangles[h / 3], from = t[h % 3], to = t[(h + 1) % 3];
                    if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0] || map[from] != map[a] || map[to] != b)
                        continue;
                    after++;
                    own[from][to]++;
                    most = own[from][to] > most ? own[from][to] : most;
                }
                /* at most one half-edge in each direction, unless they were one before */
                assert_true(after <= 1 || after == most);
            }
        }
        for (int t = 0; t < 10; t++) {
            const int32_t *v = triangles[t];
            bool was = v[0] == v[1] || v[1] == v[2] || v[2] == v[0];
            assert_true(was || (map[v[0]] != map[v[1]] && map[v[1]] != map[v[2]] && map[v[2]] != map[v[0]]));
        }
    }
}

static void take_note(void *user, const char *text)
{
    char *to = user;
    strncat(to, text, 900 - strlen(to));
}

static void test_fields_and_notes(void **unused)
{
    (void)unused;
    static const double positions[6][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0, 0}, {0, 0, 0}, {0, -1, 0}};
    static const int32_t triangles[2][3] = {{0, 1, 2}, {3, 4, 5}};
    static const double same[6] = {1, 2, 3, 2, 1, 4}, other[12] = {1, 1, 2, 2, 3, 3, 2, 9, 1, 1, 4, 4};
    char said[1000] = "";
    const pel_log log = {take_note, said};
    pel_mesh *mesh;
    assert_int_equal(pel_mesh_create(positions[0], 6, triangles[0], 2, &mesh, NULL), PEL_OK);
    assert_int_equal(pel_mesh_add_field(mesh, "same", 1, same, NULL), PEL_OK);
    assert_int_equal(pel_mesh_add_field(mesh, "other", 2, other, NULL), PEL_OK);
    assert_int_equal(pel_seams_weld(mesh, NULL, &log, NULL), PEL_OK);
    assert_int_equal(mesh->vertex_count, 4);
    assert_near(pel_mesh_field(mesh, "same")->values[3], 4, 0);
    assert_near(pel_mesh_field(mesh, "other")->values[3], 2, 0);
    assert_near(pel_mesh_field(mesh, "other")->values[6], 4, 0);
    assert_non_null(strstr(said, "6 vertices on seams welded into 4"));
    assert_non_null(strstr(said, "field 'other' differs across the seams at 1 vertices"));
    assert_null(strstr(said, "'same'"));
    assert_null(strstr(said, "open seams"));
    pel_mesh_destroy(mesh);
}

static pel_status weld_case(const void *unused, pel_error *error)
{
    (void)unused;
    static const double positions[6][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0, 0}, {0, 0, 0}, {0, -1, 0}};
    static const int32_t triangles[2][3] = {{0, 1, 2}, {3, 4, 5}};
    pel_mesh *mesh;
    int32_t *map = NULL;
    pel_status status = pel_mesh_create(positions[0], 6, triangles[0], 2, &mesh, error);
    if (status == PEL_OK)
        status = pel_seams_weld(mesh, &map, NULL, error);
    assert_true((map != NULL) == (status == PEL_OK));
    pel_free(map);
    pel_mesh_destroy(mesh);
    return status;
}

static void test_allocation_failures(void **unused)
{
    (void)unused;
    assert_true(for_every_allocation_failure(weld_case, NULL) >= 15);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_soups),
        cmocka_unit_test(test_what_stays_open),
        cmocka_unit_test(test_closed_bodies),
        cmocka_unit_test(test_rounding),
        cmocka_unit_test(test_transitive),
        cmocka_unit_test(test_fields_and_notes),
        cmocka_unit_test(test_allocation_failures),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
