/* Stiffness of springs and pins of the active model on a refined surface. */
#include "sim/refine_fixture.h"
#include "stage/stage.h"

/* stiffness of the spring between two vertices of the forest, 0 = none */
static double stiffness_between(const pel_sim *sim, int32_t v, int32_t w)
{
    const pel_model *model = sim->model;
    int32_t i = sim->active->bodies[0].model_index[v], j = sim->active->bodies[0].model_index[w];
    for (int32_t slot = model->slot_begin[i / PEL_WIDTH]; slot < model->slot_end[i / PEL_WIDTH]; slot++)
        if (model->neighbours[slot][i % PEL_WIDTH] == j)
            return (double)model->stiffnesses[slot][i % PEL_WIDTH];
    return 0;
}

/* springs that are to stay as they are: halves of an edge have its number, a bisector the mean of its triangle's */
static void test_unchanged(void **unused)
{
    (void)unused;
    const double tolerance = rounding(1e-14, 1e-5);
    double field[252];
    pel_mesh *mesh = make_sphere(5);
    for (int v = 0; v < 252; v++)
        field[v] = 1 + 0.01 * v;
    pel_body_def body = ball(mesh, 1);
    body.spring_stiffness.field = field;
    body.refine.springs = PEL_REFINE_UNCHANGED;
    pel_sim_def def = pel_sim_def_default();
    bench made = begin(mesh, &body, &def);
    refine(&made, 13, 1);
    const pel_front *front = made.sim->model->bodies[0].front;
    const pel_topology *base = front->forest->levels[0];
    int bisected = 0, split = 0;
    for (int32_t i = 0; i < front->triangle_count; i++) {
        const pel_front_triangle *half = &front->triangles[i];
        if (!pel_front_is_green(front->shapes[half->node]) || half->half != 0)
            continue;
        const int32_t *v = base->triangles[half->node];
        double mean = (field[v[0]] + field[v[1]] + field[v[2]]) / 3;
        assert_near(stiffness_between(made.sim, half->vertices[1], half->vertices[2]), mean, tolerance * mean);
        bisected++;
    }
    for (int32_t e = 0; e < base->edge_count; e++) {
        int32_t h = base->half_edge_of_edge[e], middle = base->vertex_count + e;
        int32_t a = pel_half_edge_origin(base, h), b = pel_half_edge_target(base, h);
        double given = (field[a] + field[b]) / 2;
        bool whole = !pel_front_has_vertex(front, middle);
        assert_near(stiffness_between(made.sim, a, whole ? b : middle), given, tolerance * given);
        split += !whole;
    }
    assert_int_equal(bisected, 12);
    assert_int_equal(split, 42);
    end(&made);
}

/* a new vertex is pinned when both ends of its edge are */
static void test_pins(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_sphere(5);
    const int32_t *triangle = mesh->triangles[100];
    pel_body_def body = ball(mesh, 2);
    body.refine.everywhere = true;
    body.pinned = triangle;
    body.pinned_count = 3;
    pel_sim_def def = pel_sim_def_default();
    bench made = begin(mesh, &body, &def);
    int count = 0;
    for (int32_t i = 0; i < made.sim->model->vertex_count; i++)
        count += made.sim->model->mesh_vertex[i] >= 0 && made.sim->model->inverse_mass[i] == 0;
    /* the vertices of one triangle on level 2 */
    assert_int_equal(count, 15);
    end(&made);
}

/* a surface that is coarsened to its mesh has the vertices and springs of its mesh, in the same places */
static void test_coarsened(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_sphere(5);
    pel_body_def body = ball(mesh, 2);
    pel_sim_def def = pel_sim_def_default();
    bench made = begin(mesh, &body, &def);
    const pel_model *model = made.sim->model;
    const pel_body before = model->bodies[0];
    const size_t bytes = (size_t)model->vertex_count * sizeof *model->rest;
    pel_record *rest = malloc(bytes);
    assert_non_null(rest);
    memcpy(rest, model->rest, bytes);
    refine(&made, 13, 2);
    refine(&made, 200, 1);
    assert_true(model->bodies[0].slice_end > before.slice_end);
    refine(&made, 200, 0);
    refine(&made, 13, 0);
    assert_int_equal(model->bodies[0].front->vertex_count, mesh->vertex_count);
    assert_int_equal(model->bodies[0].slice_end, before.slice_end);
    /* also places that are free again: a simulation that continues from a snapshot never had them */
    assert_memory_equal(model->rest, rest, bytes);
    free(rest);
    end(&made);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_unchanged),
        cmocka_unit_test(test_pins),
        cmocka_unit_test(test_coarsened),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
