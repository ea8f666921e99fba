/* The surface of a body that refines, as the public interface shows it. */
#include "pellicle/model.h"
#include "pellicle/shape.h"
#include "pellicle/sim_surface.h"
#include "pellicle/topology.h"
#include "sim/refine_fixture.h"

/* rows: triangles are within the rows, levels and places in the mesh fit the rest positions of a flat body */
static void test_rows(void **unused)
{
    (void)unused;
    pel_shape_def shape = pel_shape_def_default(PEL_SHAPE_GRID);
    shape.nx = shape.ny = 12;
    pel_mesh *mesh;
    assert_int_equal(pel_shape_create(&shape, &mesh, NULL), PEL_OK);
    pel_body_def body = ball(mesh, 3);
    body.refine.rings = 3; /* to the middle of a triangle of the mesh */
    pel_sim_def def = pel_sim_def_default();
    bench made = begin(mesh, &body, &def);
    refine(&made, nearest_vertex(mesh, 0, 0, 0), 3);
    int32_t n = pel_sim_vertex_count(made.sim, 0), m = pel_sim_triangle_count(made.sim, 0), finest = 0;
    assert_true(n > mesh->vertex_count);
    double *rest = calloc((size_t)n * 3, sizeof *rest), *weights = calloc((size_t)n * 3, sizeof *weights);
    double *x = calloc((size_t)n * 3, sizeof *x);
    int32_t *levels = calloc((size_t)n, sizeof *levels), *in = calloc((size_t)n, sizeof *in);
    int32_t *triangles = calloc((size_t)m * 3, sizeof *triangles);
    pel_sim_get_rest_positions(made.sim, 0, rest);
    pel_sim_get_positions(made.sim, 0, x);
    pel_sim_get_levels(made.sim, 0, levels);
    pel_sim_get_mesh_places(made.sim, 0, in, weights);
    pel_sim_get_triangles(made.sim, 0, triangles);
    for (int32_t r = 0; r < n; r++) {
        assert_int_equal(levels[r] == 0, r < mesh->vertex_count);
        finest = levels[r] > finest ? levels[r] : finest;
        /* away from the rim, butterfly keeps a flat regular grid */
        bool inner = fabs(rest[3 * r]) < 0.2 && fabs(rest[3 * r + 1]) < 0.2;
        for (int c = 0; c < 3; c++) {
            double sum = 0;
            for (int k = 0; k < 3; k++)
                sum += weights[3 * r + k] * mesh->positions[mesh->triangles[in[r]][k]][c];
            if (inner)
                assert_near(rest[3 * r + c], sum, rounding(1e-14, 1e-7));
            assert_near(x[3 * r + c], rest[3 * r + c], rounding(1e-15, 1e-7));
        }
    }
    assert_int_equal(finest, 3);
    for (int32_t i = 0; i < 3 * m; i++)
        assert_true(triangles[i] >= 0 && triangles[i] < n);
    pel_mesh *surface;
    pel_topology *topology;
    assert_int_equal(pel_mesh_create(rest, n, triangles, m, &surface, NULL), PEL_OK);
    assert_int_equal(pel_topology_create(surface, &topology, NULL), PEL_OK);
    assert_int_equal(n - topology->edge_count + m, 1);
    pel_topology_destroy(topology);
    pel_mesh_destroy(surface);
    free(rest);
    free(weights);
    free(x);
    free(levels);
    free(in);
    free(triangles);
    end(&made);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_rows)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
