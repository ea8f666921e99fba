/* Opened surfaces: any set of edges against joined corners, the slow and simple way. */
#include "sample.h"

#include "failing_malloc.h"
#include "mesh/opening.h"
#include "mesh/union_find.h"
#include "pellicle/shape.h"
#include "random.h"

static pel_mesh *make_surface(int kind)
{
    static const pel_shape_kind kinds[4] = {PEL_SHAPE_GRID, PEL_SHAPE_TORUS, PEL_SHAPE_DISK, PEL_SHAPE_GEODESIC_SPHERE};
    pel_shape_def def = pel_shape_def_default(kinds[kind % 4]);
    pel_mesh *mesh;
    assert_int_equal(pel_shape_create(&def, &mesh, NULL), PEL_OK);
    return mesh;
}

/* corners at both ends of each edge that stays shut are joined: as many vertices as sets of corners */
static int32_t count_joined(const pel_topology *t, const uint8_t *marks, int32_t *parents)
{
    int32_t count = 0, corner_count = 3 * t->triangle_count;
    pel_union_find_reset(parents, corner_count);
    for (int32_t h = 0; h < corner_count; h++) {
        int32_t g = t->twin[h];
        if (g < 0 || marks[t->edge_of_half_edge[h]])
            continue;
        pel_union_find_join(parents, h, pel_half_edge_next(g));
        pel_union_find_join(parents, pel_half_edge_next(h), g);
    }
    for (int32_t h = 0; h < corner_count; h++)
        count += pel_union_find_root(parents, h) == h;
    return count;
}

static void check_opening(const pel_topology *t, const uint8_t *marks)
{
    pel_opening opening;
    int32_t corner_count = 3 * t->triangle_count, *parents = calloc((size_t)corner_count, sizeof *parents);
    assert_int_equal(pel_opening_find(t, marks, &opening, NULL), PEL_OK);
    assert_int_equal(opening.vertex_count, count_joined(t, marks, parents));
    int32_t *vertex_of_set = calloc((size_t)corner_count, sizeof *vertex_of_set), opened = 0;
    uint8_t *keeps = calloc((size_t)t->vertex_count, 1);
    for (int32_t h = 0; h < corner_count; h++) {
        int32_t v = opening.triangles[h / 3][h % 3], root = pel_union_find_root(parents, h);
        if (vertex_of_set[root] == 0)
            vertex_of_set[root] = v + 1;
        assert_int_equal(vertex_of_set[root], v + 1);
        assert_int_equal(opening.parents[v], t->triangles[h / 3][h % 3]);
        /* the lowest triangle keeps the vertex */
        if (!keeps[opening.parents[v]])
            assert_int_equal(v, opening.parents[v]);
        keeps[opening.parents[v]] = 1;
        opened += t->twin[h] > h && marks[t->edge_of_half_edge[h]] &&
                  (pel_union_find_root(parents, h) != pel_union_find_root(parents, pel_half_edge_next(t->twin[h])) ||
                   pel_union_find_root(parents, pel_half_edge_next(h)) != pel_union_find_root(parents, t->twin[h]));
    }
    assert_int_equal(opening.edge_count, opened);
    free(keeps);
    free(vertex_of_set);
    free(parents);
    pel_opening_clear(&opening);
}

static void test_random_edges(void **unused)
{
    (void)unused;
    random_state random = {17};
    for (int round = 0; round < ROUNDS(80, 8); round++) {
        pel_mesh *mesh = make_surface(round);
        pel_topology *t;
        assert_int_equal(pel_topology_create(mesh, &t, NULL), PEL_OK);
        uint8_t *marks = calloc((size_t)t->edge_count, 1);
        double share = random_between(&random, 0, round % 8 == 7 ? 1 : 0.2);
        for (int32_t e = 0; e < t->edge_count; e++)
            marks[e] = random_between(&random, 0, 1) < share;
        check_opening(t, marks);
        memset(marks, 1, (size_t)t->edge_count);
        check_opening(t, marks);
        memset(marks, 0, (size_t)t->edge_count);
        check_opening(t, marks);
        free(marks);
        pel_topology_destroy(t);
        pel_mesh_destroy(mesh);
    }
}

static void test_edges_between(void **unused)
{
    (void)unused;
    for (int kind = 0; kind < 4; kind++) {
        pel_mesh *mesh = make_surface(kind);
        pel_topology *t;
        assert_int_equal(pel_topology_create(mesh, &t, NULL), PEL_OK);
        int32_t found = 0, most = t->vertex_count < 60 ? t->vertex_count : 60;
        for (int32_t e = 0; e < t->edge_count; e++) {
            int32_t h = t->half_edge_of_edge[e], a = pel_half_edge_origin(t, h), b = pel_half_edge_target(t, h);
            assert_int_equal(pel_topology_edge_between(t, a, b), e);
            assert_int_equal(pel_topology_edge_between(t, b, a), e);
            found += a < most && b < most;
        }
        for (int32_t a = 0; a < most; a++)
            for (int32_t b = 0; b < a; b++)
                found -= pel_topology_edge_between(t, a, b) >= 0;
        assert_int_equal(found, 0);
        pel_topology_destroy(t);
        pel_mesh_destroy(mesh);
    }
}

static pel_status find(const void *context, pel_error *error)
{
    const pel_topology *t = context;
    static const uint8_t marks[100000] = {[5] = 1, [6] = 1};
    pel_opening opening;
    pel_status status = pel_opening_find(t, marks, &opening, error);
    pel_opening_clear(&opening);
    return status;
}

static void test_allocation_failures(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_surface(0);
    pel_topology *t;
    assert_int_equal(pel_topology_create(mesh, &t, NULL), PEL_OK);
    assert_true(for_every_allocation_failure(find, t) > 2);
    pel_topology_destroy(t);
    pel_mesh_destroy(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_random_edges),
        cmocka_unit_test(test_edges_between),
        cmocka_unit_test(test_allocation_failures),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
