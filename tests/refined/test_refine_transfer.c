/* Where new vertices of a surface that refines go. */
#include "pellicle/shape.h"
#include "random.h"
#include "sim/refine_fixture.h"
#include "stage/stage.h"

/* A flat, uneven sheet under a pure stretch: no triangle turns, whichever way its edges turn. So new vertices keep
   their offsets from the middles of their edges, which lie in the plane. */
static void test_stretch_does_not_turn(void **unused)
{
    (void)unused;
    pel_shape_def shape = pel_shape_def_default(PEL_SHAPE_GRID);
    shape.nx = shape.ny = 6;
    shape.size_x = shape.size_y = 1;
    pel_mesh *mesh;
    random_state random = {3};
    assert_int_equal(pel_shape_create(&shape, &mesh, NULL), PEL_OK);
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        for (int k = 0; k < 2; k++)
            mesh->positions[v][k] += random_between(&random, -0.05, 0.05);
    pel_body_def body = ball(mesh, 1);
    pel_sim_def def = pel_sim_def_default();
    bench made = begin(mesh, &body, &def);
    pel_sim *sim = made.sim;
    const double stretch[3] = {1.6, 0.6, 1};
    for (int32_t v = 0; v < sim->model->vertex_count; v++)
        for (int k = 0; k < 3; k++)
            sim->state->position[v][k] *= (pel_real)stretch[k];
    const pel_refined_body *own = &sim->active->bodies[0];
    for (int32_t t = 0; t < mesh->triangle_count; t++)
        pel_front_mark(own->front, t, true);
    pel_front_close(own->front);
    pel_refined_commit(sim->active, 0, sim->state);
    const double(*rest)[3] = (const double(*)[3])own->front->forest->rest_positions;
    const pel_topology *base = own->front->forest->levels[0];
    double largest = 0;
    for (int32_t e = 0; e < base->edge_count; e++) {
        int32_t h = base->half_edge_of_edge[e], v = base->vertex_count + e;
        int32_t a = pel_half_edge_origin(base, h), b = pel_half_edge_target(base, h);
        assert_true(pel_front_has_vertex(own->front, v));
        for (int k = 0; k < 3; k++) {
            double middle = (rest[a][k] + rest[b][k]) / 2, offset = rest[v][k] - middle;
            largest = fmax(largest, fabs(offset));
            assert_near((double)sim->state->position[own->model_index[v]][k], stretch[k] * middle + offset,
                        rounding(1e-13, 1e-6));
        }
    }
    assert_true(largest > 0.001);
    end(&made);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_stretch_does_not_turn)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
