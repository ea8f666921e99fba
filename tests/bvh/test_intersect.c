/* The certificate against all pairs, on surfaces that cut themselves and on real meshes that do not. */
#include "check.h"
#include "failing_malloc.h"

#include "base/status.h"
#include "bvh/intersect.h"
#include "pellicle/geometry.h"
#include "pellicle/mesh_io.h"
#include "sample.h"
#include "source_dir.h"

static pel_mesh mesh_of(const surface *s, double (*positions)[3])
{
    return (pel_mesh){.vertex_count = s->vertex_count,
                      .triangle_count = s->triangle_count,
                      .positions = positions,
                      .triangles = s->triangles};
}

/* without a tree, corners put in order in another way than in the library */
static bool intersect(const pel_mesh *mesh, int32_t s, int32_t t)
{
    double a[3][3], b[3][3];
    bool a_used[3] = {false}, b_used[3] = {false};
    int shared = 0, a_next, b_next;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            if (mesh->triangles[s][i] == mesh->triangles[t][j]) {
                memcpy(a[shared], mesh->positions[mesh->triangles[s][i]], sizeof a[0]);
                memcpy(b[shared], mesh->positions[mesh->triangles[s][i]], sizeof b[0]);
                a_used[i] = b_used[j] = true;
                shared++;
            }
    a_next = b_next = shared;
    for (int i = 0; i < 3; i++) {
        if (!a_used[i])
            memcpy(a[a_next++], mesh->positions[mesh->triangles[s][i]], sizeof a[0]);
        if (!b_used[i])
            memcpy(b[b_next++], mesh->positions[mesh->triangles[t][i]], sizeof b[0]);
    }
    return pel_triangles_intersect_beyond((const double(*)[3])a, (const double(*)[3])b, shared);
}

/* of the pairs of a mesh, those that cross a split */
static void check_parts(const pel_mesh *mesh, const pair_set *all)
{
    for (int32_t split = 1; split < mesh->triangle_count; split += 1 + mesh->triangle_count / 7) {
        bool expected = false, found;
        for (size_t i = 0; i < all->count; i++)
            expected |= all->pairs[i].first < split && all->pairs[i].second >= split;
        assert_int_equal(pel_mesh_parts_intersect(mesh, split, &found), PEL_OK);
        assert_int_equal(found, expected);
    }
}

/* of the pairs of a mesh, those of triangles that count as changed: none, some, all */
static void check_changed(const pel_mesh *mesh, const pair_set *all)
{
    random_state random = {(uint64_t)mesh->triangle_count};
    uint8_t *changed = malloc((size_t)mesh->triangle_count);
    for (int round = 0; round < 40; round++) {
        double share = round == 0   ? 0
                       : round == 1 ? 1
                                    : random_between(&random, 0, 0.3) * random_between(&random, 0, 1);
        bool expected = false, found;
        for (int32_t t = 0; t < mesh->triangle_count; t++)
            changed[t] = random_between(&random, 0, 1) < share;
        for (size_t i = 0; i < all->count; i++)
            expected |= changed[all->pairs[i].first] || changed[all->pairs[i].second];
        assert_int_equal(pel_mesh_changed_intersect(mesh, changed, &found), PEL_OK);
        assert_int_equal(found, expected);
    }
    free(changed);
}

static void check_mesh(const pel_mesh *mesh, bool expect_some)
{
    pair_set expected = {0}, found = {0};
    for (int32_t s = 0; s < mesh->triangle_count; s++)
        for (int32_t t = s + 1; t < mesh->triangle_count; t++)
            if (intersect(mesh, s, t))
                add_pair(&expected, (pel_pair){s, t});
    assert_true(!expect_some || expected.count > 0);
    size_t room = expected.count + 10;
    found.pairs = malloc(room * sizeof *found.pairs);
    int64_t count;
    assert_int_equal(pel_mesh_self_intersections(mesh, found.pairs, (int32_t)room, &count, NULL), PEL_OK);
    assert_int_equal(count, expected.count);
    for (int64_t i = 1; i < count; i++)
        assert_true(compare_pairs(&found.pairs[i - 1], &found.pairs[i]) < 0);
    found.count = found.capacity = (size_t)count;
    assert_true(pairs_equal(&found, &expected));
    check_parts(mesh, &expected);
    check_changed(mesh, &expected);
    /* the list may be short, the count is exact */
    assert_int_equal(pel_mesh_self_intersections(mesh, found.pairs, count < 3 ? (int32_t)count : 3, &count, NULL),
                     PEL_OK);
    assert_int_equal(count, expected.count);
    assert_int_equal(pel_mesh_self_intersections(mesh, NULL, 0, &count, NULL), PEL_OK);
    assert_int_equal(count, expected.count);
    clear_pairs(&expected);
    clear_pairs(&found);
}

static void test_soups(void **unused)
{
    (void)unused;
    for (int32_t count = 1; count < 300; count = 2 + count * 3 / 2) {
        surface s = make_soup(count, 0.3, (uint64_t)count);
        pel_mesh mesh = mesh_of(&s, s.start);
        check_mesh(&mesh, count > 20);
        /* far from the origin, and tiny */
        for (int32_t v = 0; v < s.vertex_count; v++)
            for (int k = 0; k < 3; k++)
                s.end[v][k] = count % 2 == 0 ? 1e6 + s.start[v][k] : 1e-20 * s.start[v][k];
        mesh = mesh_of(&s, s.end);
        check_mesh(&mesh, count > 20);
        free_surface(&s);
    }
}

static void test_sheet_and_sphere(void **unused)
{
    (void)unused;
    surface sheet = make_folded_sheet(14, 0.02), sphere = make_sphere(7, 0.3);
    pel_mesh mesh = mesh_of(&sheet, sheet.start);
    check_mesh(&mesh, false);
    mesh = mesh_of(&sheet, sheet.end);
    check_mesh(&mesh, true);
    mesh = mesh_of(&sphere, sphere.end);
    check_mesh(&mesh, true);
    mesh = mesh_of(&sphere, sphere.start);
    int64_t count = -1;
    assert_int_equal(pel_mesh_self_intersections(&mesh, NULL, 0, &count, NULL), PEL_OK);
    assert_int_equal(count, 0);
    free_surface(&sheet);
    free_surface(&sphere);
}

/* triangles that are no triangles take no part; those without area and those that come twice count */
static void test_bad_triangles(void **unused)
{
    (void)unused;
    double positions[7][3] = {{0, 0, 0},      {1, 0, 0},     {0, 1, 0},    {nan(""), 0, 0},
                              {0.2, 0.2, -1}, {0.2, 0.2, 1}, {0.3, 0.2, 1}};
    int32_t triangles[5][3] = {{0, 1, 2}, {0, 1, 9}, {0, 1, 1}, {0, 1, 3}, {4, 5, 6}};
    pel_mesh mesh = {.vertex_count = 7, .triangle_count = 5, .positions = positions, .triangles = triangles};
    pel_pair pairs[4];
    int64_t count;
    assert_int_equal(pel_mesh_self_intersections(&mesh, pairs, 4, &count, NULL), PEL_OK);
    assert_int_equal(count, 1);
    assert_true(pairs[0].first == 0 && pairs[0].second == 4);
    int32_t twice[2][3] = {{0, 1, 2}, {2, 1, 0}}, flat[2][3] = {{0, 1, 2}, {0, 1, 4}};
    mesh.triangle_count = 2;
    mesh.triangles = twice;
    assert_int_equal(pel_mesh_self_intersections(&mesh, pairs, 4, &count, NULL), PEL_OK);
    assert_int_equal(count, 1);
    mesh.triangles = flat;
    memcpy(positions[4], (double[3]){3, 0, 0}, sizeof positions[4]);
    assert_int_equal(pel_mesh_self_intersections(&mesh, pairs, 4, &count, NULL), PEL_OK);
    assert_int_equal(count, 1);
    mesh.triangle_count = 0;
    assert_int_equal(pel_mesh_self_intersections(&mesh, pairs, 4, &count, NULL), PEL_OK);
    assert_int_equal(count, 0);
    mesh.triangle_count = -1;
    assert_int_equal(pel_mesh_self_intersections(&mesh, pairs, 4, &count, NULL), PEL_BAD_ARGUMENT);
}

/* a fan of 3,000 triangles about one vertex: its boxes are too many to test, and the vertex is named */
static void test_too_many_pairs(void **unused)
{
    (void)unused;
    enum { COUNT = 3000 };
    double(*positions)[3] = calloc(COUNT + 1, sizeof *positions);
    int32_t(*triangles)[3] = calloc(COUNT, sizeof *triangles);
    assert_true(positions != NULL && triangles != NULL);
    for (int i = 0; i < COUNT; i++) {
        positions[i + 1][0] = 1 + 1e-6 * i;
        positions[i + 1][1] = 1;
        positions[i + 1][2] = 1e-3 * (i % 7);
        triangles[i][1] = 1 + i;
        triangles[i][2] = 1 + (i + 1) % COUNT;
    }
    pel_mesh mesh = {
        .vertex_count = COUNT + 1, .triangle_count = COUNT, .positions = positions, .triangles = triangles};
    pel_error error;
    int64_t count;
    assert_int_equal(pel_mesh_self_intersections(&mesh, NULL, 0, &count, &error), PEL_BAD_MESH);
    assert_non_null(strstr(error.what, "vertex 0 has 3000 triangles"));
    assert_true(error.element == 0 && error.remedy[0] != '\0');
    free(positions);
    free(triangles);
}

/* free at rest, as their makers say; one vertex pushed through makes them cut themselves */
static void check_file(const char *name)
{
    char path[1024];
    snprintf(path, sizeof path, PEL_SOURCE_DIR "/%s", name);
    FILE *file = fopen(path, "r");
    if (file == NULL)
        return;
    fclose(file);
    pel_mesh *mesh;
    assert_int_equal(pel_mesh_read(path, PEL_FORMAT_AUTO, NULL, &mesh, NULL), PEL_OK);
    int64_t count = -1;
    assert_int_equal(pel_mesh_self_intersections(mesh, NULL, 0, &count, NULL), PEL_OK);
    assert_int_equal(count, 0);
    double *x = mesh->positions[mesh->vertex_count / 2];
    double centre[3] = {0, 0, 0};
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        for (int k = 0; k < 3; k++)
            centre[k] += mesh->positions[v][k] / mesh->vertex_count;
    for (int k = 0; k < 3; k++)
        x[k] += 3 * (centre[k] - x[k]);
    assert_int_equal(pel_mesh_self_intersections(mesh, NULL, 0, &count, NULL), PEL_OK);
    assert_true(count > 0);
    pel_mesh_destroy(mesh);
}

static void test_files(void **unused)
{
    (void)unused;
    /* meshes of the repository, then larger ones if available */
    const char *const names[] = {"tests/data/bean.obj", "tests/data/sac.obj", "tests/data/flap.obj"};
    const char *const shared[] = {"cat",   "gallbladder",    "goat-head",  "koala",  "liver-coarse",
                                  "liver", "nefertiti-head", "sphere-252", "spleen", "spot"};
    for (size_t i = 0; i < sizeof shared / sizeof *shared; i++) {
        char path[100];
        snprintf(path, sizeof path, "../shared/data/%s.obj", shared[i]);
        check_file(path);
    }
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        check_file(names[i]);
}

static pel_status find_case(const void *data, pel_error *error)
{
    const surface *s = data;
    pel_mesh mesh = mesh_of(s, s->start);
    int64_t count;
    pel_status status = pel_mesh_self_intersections(&mesh, NULL, 0, &count, error);
    assert_int_equal(count > 0, status == PEL_OK);
    return status;
}

static pel_status look_case(const void *data, pel_error *error)
{
    const surface *s = data;
    pel_mesh mesh = mesh_of(s, s->start);
    uint8_t changed[60] = {[7] = 1, [50] = 1};
    bool found;
    pel_status status = pel_mesh_changed_intersect(&mesh, changed, &found);
    return status == PEL_OK ? PEL_OK : pel_fail_memory(error);
}

static void test_allocations(void **unused)
{
    (void)unused;
    surface s = make_soup(60, 0.3, 2);
    assert_true(for_every_allocation_failure(find_case, &s) > 6);
    assert_true(for_every_allocation_failure(look_case, &s) > 6);
    free_surface(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_soups),         cmocka_unit_test(test_sheet_and_sphere),
        cmocka_unit_test(test_bad_triangles), cmocka_unit_test(test_too_many_pairs),
        cmocka_unit_test(test_files),         cmocka_unit_test(test_allocations),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
