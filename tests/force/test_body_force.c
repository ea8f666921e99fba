/* Forces and energies of springs: the loop over slices, one vertex alone, and sums over the edges by hand. */
#include "sim/fixture.h"

#include "base/memory.h"
#include "force/body_force.h"
#include "random.h"

typedef struct body {
    pel_mesh *mesh;
    pel_model *model;
    pel_state *state;
    double *stiffness;
} body;

static void make_body(body *made, bool uniform)
{
    random_state random = {7};
    made->mesh = make_sphere(4);
    made->stiffness = calloc((size_t)made->mesh->vertex_count, sizeof *made->stiffness);
    for (int32_t v = 0; v < made->mesh->vertex_count; v++)
        made->stiffness[v] = random_between(&random, 1, 5);
    pel_body_def def = pel_body_def_default();
    def.name = "ball";
    def.mesh = made->mesh;
    if (!uniform)
        def.spring_stiffness.field = made->stiffness;
    def.volumetric_by_area = true;
    made->model = make_model(&def);
    assert_int_equal(pel_state_create(made->model, true, &made->state, NULL), PEL_OK);
    for (int32_t i = 0; i < made->model->vertex_count; i++)
        for (int c = 0; c < 3; c++) {
            made->state->position[i][c] += (pel_real)(0.05 * random_normal(&random));
            made->state->velocity[i][c] = (pel_real)random_normal(&random);
        }
}

static void free_body(body *made)
{
    pel_state_destroy(made->state);
    pel_model_destroy(made->model);
    pel_mesh_destroy(made->mesh);
    free(made->stiffness);
}

/* eq. from the mesh, with damping when velocities are given */
static void expected_force(const body *made, int32_t v, bool uniform, bool damped, double force[3])
{
    const pel_model *model = made->model;
    const pel_mesh *mesh = made->mesh;
    int32_t i = model->bodies[0].model_index[v];
    double x[3], e[3], velocity[3], along = 0;
    pel_vertex_position(made->state->position, i, x);
    pel_vertex_position(made->state->velocity, i, velocity);
    pel_vec3_set(force, 0, 0, 0);
    for (int32_t t = 0; t < mesh->triangle_count; t++)
        for (int k = 0; k < 3; k++) {
            /* of a closed mesh each edge leaves v once */
            int32_t w = mesh->triangles[t][(k + 1) % 3];
            double y[3], d[3];
            if (mesh->triangles[t][k] != v)
                continue;
            pel_vertex_position(made->state->position, model->bodies[0].model_index[w], y);
            pel_vec3_subtract(y, x, d);
            double rest = pel_vec3_distance(mesh->positions[v], mesh->positions[w]), length = pel_vec3_length(d);
            double stiffness = uniform ? 3 : 0.5 * (made->stiffness[v] + made->stiffness[w]);
            pel_vec3_along(force, stiffness * (length - rest) / length, d, force);
        }
    pel_vec3_subtract(x, mesh->positions[v], e);
    pel_vec3_along(force, -(double)model->rest[i][3], e, force);
    if (!damped)
        return;
    for (int c = 0; c < 3; c++)
        along += velocity[c] * e[c];
    pel_vec3_along(force, -(double)model->damping[i], velocity, force);
    pel_vec3_along(force, -(double)model->volumetric_damping[i] * along / pel_vec3_squared_length(e), e, force);
}

static void test_forces(void **unused)
{
    (void)unused;
    const double rounding = sizeof(pel_real) == 8 ? 1e-12 : 1e-3;
    for (int kind = 0; kind < 4; kind++) {
        bool uniform = kind % 2, damped = kind / 2;
        body made;
        make_body(&made, uniform);
        pel_record *force = pel_allocate_aligned((size_t)made.model->vertex_count, sizeof *force);
        pel_body_forces(made.model, made.state, damped ? made.state->velocity : NULL, NULL, force);
        for (int32_t v = 0; v < made.mesh->vertex_count; v++) {
            int32_t i = made.model->bodies[0].model_index[v];
            double expected[3];
            expected_force(&made, v, uniform, damped, expected);
            for (int c = 0; c < 3; c++)
                assert_near((double)force[i][c], expected[c], rounding);
            pel_record alone = pel_elastic_force_at(made.model, made.state, made.state->position, i);
            assert_true(damped || memcmp(&alone, &force[i], sizeof alone) == 0);
            assert_true(force[i][3] == 0);
        }
        pel_free(force);
        free_body(&made);
    }
}

/* exactly no force at rest, for any stiffnesses: not a bit of rounding */
static void test_rest(void **unused)
{
    (void)unused;
    for (int uniform = 0; uniform < 2; uniform++) {
        body made;
        make_body(&made, uniform);
        for (int32_t i = 0; i < made.model->vertex_count; i++) {
            pel_record f = pel_elastic_force_at(made.model, made.state, made.model->rest, i);
            assert_true(f[0] == 0 && f[1] == 0 && f[2] == 0);
        }
        free_body(&made);
    }
}

/* the keyed factors of both stiffnesses reach the energies */
static void test_factors(void **unused)
{
    (void)unused;
    body made;
    make_body(&made, false);
    double energies[3][2] = {{0}};
    for (int round = 0; round < 3; round++) {
        made.state->factors[0][PEL_SPRING_STIFFNESS] = round == 1 ? 2 : 1;
        made.state->factors[0][PEL_VOLUMETRIC_STIFFNESS] = round == 2 ? 3 : 1;
        for (int32_t slice = 0; slice < made.model->slice_count; slice++) {
            pel_wide spring, volumetric;
            pel_slice_energy(made.model, made.state, slice, &spring, &volumetric);
            for (int lane = 0; lane < PEL_WIDTH; lane++) {
                energies[round][0] += (double)spring[lane];
                energies[round][1] += (double)volumetric[lane];
            }
        }
    }
    const double rounding = sizeof(pel_real) == 8 ? 1e-13 : 1e-5;
    assert_near(energies[1][0] / energies[0][0], 2, rounding);
    assert_near(energies[1][1] / energies[0][1], 1, rounding);
    assert_near(energies[2][0] / energies[0][0], 1, rounding);
    assert_near(energies[2][1] / energies[0][1], 3, rounding);
    free_body(&made);
}

/* next to all sides of all triangles */
static void test_longest(void **unused)
{
    (void)unused;
    body made;
    make_body(&made, true);
    const pel_model *model = made.model;
    double expected = 0, scratch[8];
    assert_true(pel_slice_chunk_count(0, model->slice_count) <= 8);
    for (int32_t t = 0; t < model->triangle_count; t++)
        for (int k = 0; k < 3; k++) {
            double a[3], b[3];
            pel_vertex_position(made.state->position, model->triangles[t][k], a);
            pel_vertex_position(made.state->position, model->triangles[t][(k + 1) % 3], b);
            expected = fmax(expected, pel_vec3_distance(a, b));
        }
    assert_near(pel_longest_spring(model, made.state->position, NULL, scratch), expected,
                sizeof(pel_real) == 8 ? 1e-15 : 1e-6);
    free_body(&made);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_forces),
        cmocka_unit_test(test_rest),
        cmocka_unit_test(test_factors),
        cmocka_unit_test(test_longest),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
