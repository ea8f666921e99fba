/* Sound fronts pass; a front with any one number changed does not. */
#include "sample.h"

#include "subdivide/front.h"

static void refuse(const pel_front *front)
{
    assert_false(pel_front_is_valid(front));
}

static void damage(const pel_front *front, int32_t *numbers, int32_t count, int32_t other)
{
    for (int32_t i = 0; i < count; i++) {
        int32_t kept = numbers[i];
        numbers[i] = kept == other ? other + 1 : other;
        refuse(front);
        numbers[i] = kept;
    }
    assert_true(pel_front_is_valid(front));
}

static void test_damage(void **unused)
{
    (void)unused;
    pel_mesh *mesh = sample_sphere(2);
    pel_lod_forest *forest;
    pel_front *front;
    assert_int_equal(pel_lod_forest_create(mesh, 2, 0, &forest, NULL), PEL_OK);
    assert_int_equal(pel_front_create(forest, &front, NULL), PEL_OK);
    assert_true(pel_front_is_valid(front));
    pel_front_mark(front, front->node_begin[1] + 5, true);
    (void)pel_front_close(front);
    pel_front_commit(front);
    assert_true(pel_front_is_valid(front) && front->triangle_count > mesh->triangle_count);
    damage(front, front->vertices, front->vertex_count, 0);
    damage(front, front->index_in_front, forest->levels[2]->vertex_count, -1 + front->vertex_count);
    damage(front, front->edges, front->edge_count, 0);
    damage(front, front->place_of_edge, front->bisector_begin + front->node_count, -1 + front->edge_count);
    damage(front, &front->vertex_count, 1, front->vertex_count - 1);
    damage(front, &front->edge_count, 1, front->edge_count - 1);
    damage(front, &front->triangle_count, 1, front->triangle_count - 1);
    for (int32_t t = 0; t < front->triangle_count; t++) {
        int32_t kept = front->triangles[t].node;
        front->triangles[t].node = kept > 0 ? kept - 1 : 1;
        refuse(front);
        front->triangles[t].node = kept;
    }
    assert_true(pel_front_is_valid(front));
    pel_front_destroy(front);
    pel_lod_forest_destroy(forest);
    pel_mesh_destroy(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_damage)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
