/* Sound tables pass; a table with any one number changed does not. */
#include "sample.h"

#include "mesh/topology_check.h"
#include "pellicle/shape.h"
#include "random.h"

static pel_topology *make_topology(pel_shape_kind kind)
{
    pel_shape_def def = pel_shape_def_default(kind);
    pel_mesh *mesh;
    pel_topology *topology;
    assert_int_equal(pel_shape_create(&def, &mesh, NULL), PEL_OK);
    assert_int_equal(pel_topology_create(mesh, &topology, NULL), PEL_OK);
    pel_mesh_destroy(mesh);
    return topology;
}

/* one number after the other becomes a bigger one, a smaller one, or one out of range; then it is put back */
static void damage(const pel_topology *topology, int32_t *numbers, int32_t count)
{
    for (int32_t i = 0; i < count; i++) {
        int32_t kept = numbers[i];
        const int32_t others[4] = {kept + 1, kept - 1, INT32_MAX, -2};
        for (int k = 0; k < 4; k++) {
            numbers[i] = others[k];
            assert_false(pel_topology_is_valid(topology));
        }
        numbers[i] = kept;
    }
    assert_true(pel_topology_is_valid(topology));
}

static void test_damage(void **unused)
{
    (void)unused;
    static const pel_shape_kind kinds[3] = {PEL_SHAPE_GRID, PEL_SHAPE_TORUS, PEL_SHAPE_DISK};
    for (int i = 0; i < 3; i++) {
        pel_topology *t = make_topology(kinds[i]);
        assert_true(pel_topology_is_valid(t));
        int32_t half_edges = 3 * t->triangle_count < 100 ? 3 * t->triangle_count : 100;
        damage(t, t->triangles[0], half_edges);
        damage(t, t->twin, half_edges);
        damage(t, t->edge_of_half_edge, half_edges);
        damage(t, t->half_edge_of_edge, t->edge_count < 100 ? t->edge_count : 100);
        damage(t, &t->edge_count, 1);
        damage(t, &t->boundary_edge_count, 1);
        pel_topology_destroy(t);
    }
}

/* inside, a vertex may begin with any of its half-edges; on the boundary with one */
static void test_corners(void **unused)
{
    (void)unused;
    pel_topology *t = make_topology(PEL_SHAPE_GRID);
    int32_t moved = 0;
    for (int32_t v = 0; v < t->vertex_count; v++) {
        int32_t kept = t->corner_of_vertex[v], next = pel_half_edge_turn(t, kept);
        bool is_boundary = t->twin[kept] < 0;
        if (next >= 0) {
            t->corner_of_vertex[v] = next;
            assert_true(pel_topology_is_valid(t) == !is_boundary);
            moved++;
        }
        const int32_t wrong[3] = {-1, -2, pel_half_edge_next(kept)};
        for (int k = 0; k < 3; k++) {
            t->corner_of_vertex[v] = wrong[k];
            assert_false(pel_topology_is_valid(t));
        }
        t->corner_of_vertex[v] = kept;
    }
    assert_true(moved > t->vertex_count / 2);
    pel_topology_destroy(t);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_damage), cmocka_unit_test(test_corners)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
