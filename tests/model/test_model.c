/* The model: order and springs complete, masses, refusals. */
#include "sim/fixture.h"

#include "math/extremes.h"
#include "model/model.h"
#include "model/vertex_order.h"
#include "pellicle/topology.h"

static void test_order_is_a_permutation(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_sphere(9);
    pel_topology *topology;
    assert_int_equal(pel_topology_create(mesh, &topology, NULL), PEL_OK);
    int32_t count = mesh->vertex_count, *order = calloc((size_t)count, 4), *valence = calloc((size_t)count, 4);
    char *seen = calloc((size_t)count, 1);
    assert_int_equal(pel_vertex_order_vertices(topology, NULL, order, valence, NULL), PEL_OK);
    int64_t sum = 0;
    for (int32_t i = 0; i < count; i++) {
        assert_true(order[i] >= 0 && order[i] < count && !seen[order[i]]);
        seen[order[i]] = 1;
        sum += valence[i];
    }
    assert_int_equal(sum, 2 * (int64_t)topology->edge_count);
    free(order);
    free(valence);
    free(seen);
    pel_topology_destroy(topology);
    pel_mesh_destroy(mesh);
}

/* where no body has springs their lengths are not stored, and are the same */
static void test_lengths_without_springs(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_sphere(4);
    pel_body_def body = ball_body(mesh);
    body.spring_stiffness.value = 1;
    pel_model *with = make_model(&body);
    body.spring_stiffness.value = 0;
    pel_model *without = make_model(&body);
    assert_non_null(with->rest_lengths);
    assert_null(without->rest_lengths);
    for (int32_t i = 0; i < with->vertex_count; i++)
        for (int32_t slot = with->slot_begin[i / PEL_WIDTH]; slot < with->slot_end[i / PEL_WIDTH]; slot++)
            assert_true(pel_model_rest_length(with, slot, i) == pel_model_rest_length(without, slot, i));
    pel_model_destroy(with);
    pel_model_destroy(without);
    pel_mesh_destroy(mesh);
}

/* each edge is stored once at both ends, with its length and stiffness; the rest is padding */
static void test_springs_are_the_edges(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_sphere(4);
    double *stiffness = calloc((size_t)mesh->vertex_count, sizeof *stiffness);
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        stiffness[v] = 1 + v;
    pel_body_def body = ball_body(mesh);
    body.spring_stiffness.field = stiffness;
    pel_model *model = make_model(&body);
    int32_t springs = 0;
    for (int32_t slice = 0; slice < model->slice_count; slice++)
        for (int32_t slot = model->slot_begin[slice]; slot < model->slot_begin[slice + 1]; slot++)
            for (int lane = 0; lane < PEL_WIDTH; lane++) {
                int32_t i = slice * PEL_WIDTH + lane, j = model->neighbours[slot][lane];
                if (i == j)
                    continue;
                springs++;
                int32_t a = model->mesh_vertex[i], b = model->mesh_vertex[j];
                const double *p = mesh->positions[a], *q = mesh->positions[b];
                double length =
                    sqrt((p[0] - q[0]) * (p[0] - q[0]) + (p[1] - q[1]) * (p[1] - q[1]) + (p[2] - q[2]) * (p[2] - q[2]));
                assert_near((double)pel_model_rest_length(model, slot, i), length, 1e-6);
                assert_true(length < 0.4);
                assert_near((double)model->stiffnesses[slot][lane], 1 + 0.5 * (a + b), 1e-4);
            }
    assert_int_equal(springs, 3 * mesh->triangle_count);
    free(stiffness);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

static double total_mass(const pel_body_def *body)
{
    pel_model *model = make_model(body);
    double sum = 0;
    for (int32_t i = 0; i < model->vertex_count; i++)
        sum += (double)model->mass[i];
    pel_model_destroy(model);
    return sum;
}

static void test_masses(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_sphere(10);
    pel_body_def body = ball_body(mesh);
    body.mass = 2;
    assert_near(total_mass(&body), 2 * 1002, 1e-3);
    body.mass_kind = PEL_MASS_TOTAL;
    assert_near(total_mass(&body), 2, 1e-5);
    body.mass_kind = PEL_MASS_DENSITY;
    body.mass = 1000;
    body.thickness.value = 0.01;
    /* area of the polyhedron is a little below 4 pi */
    assert_near(total_mass(&body), 1000 * 0.01 * 12.5663706, 0.5);
    pel_mesh_destroy(mesh);
}

/* a total mass is distributed by area: a sheet with a dense root has its mean mass in the middle */
static void test_total_by_area(void **unused)
{
    (void)unused;
    pel_shape_def shape = pel_shape_def_default(PEL_SHAPE_GRID);
    pel_mesh *mesh;
    double moment = 0, sum = 0;
    assert_int_equal(pel_shape_create(&shape, &mesh, NULL), PEL_OK);
    double low = mesh->positions[0][0], high = low;
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        low = pel_min(low, mesh->positions[v][0]);
        high = pel_max(high, mesh->positions[v][0]);
    }
    /* x in [0, 1], denser towards 0 */
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        double x = (mesh->positions[v][0] - low) / (high - low);
        mesh->positions[v][0] = x * x + 0.01 * x;
    }
    pel_body_def body = ball_body(mesh);
    body.mass_kind = PEL_MASS_TOTAL;
    body.mass = 3;
    pel_model *model = make_model(&body);
    for (int32_t i = 0; i < model->vertex_count; i++) {
        moment += (double)model->mass[i] * (double)model->rest[i][0];
        sum += (double)model->mass[i];
    }
    assert_near(sum, 3, 1e-5);
    assert_near(moment / sum, 1.01 / 2, 0.01);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

static void refuse(pel_body_def body, const char *word, pel_status expected)
{
    pel_model_def def = pel_model_def_default();
    def.bodies = &body;
    def.body_count = 1;
    pel_model *model;
    pel_error error;
    assert_int_equal(pel_model_create(&def, &model, &error), expected);
    assert_null(model);
    if (strstr(error.what, word) == NULL)
        print_error("'%s' lacks '%s'\n", error.what, word);
    assert_non_null(strstr(error.what, word));
}

static void test_refusals(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_sphere(2);
    pel_body_def good = pel_body_def_default(), body;
    good.name = "ball";
    good.mesh = mesh;
    body = good;
    body.name = "";
    refuse(body, "no name", PEL_BAD_ARGUMENT);
    body = good;
    body.mass = 0;
    refuse(body, "mass", PEL_BAD_ARGUMENT);
    body = good;
    body.cookie = 0;
    refuse(body, "cookie", PEL_BAD_ARGUMENT);
    body = good;
    body.spring_stiffness.value = -1;
    refuse(body, "spring stiffness", PEL_BAD_ARGUMENT);
    body = good;
    body.volumetric_damping.value = nan("");
    refuse(body, "volumetric damping", PEL_BAD_ARGUMENT);
    const int32_t pinned = 42;
    body = good;
    body.pinned = &pinned;
    body.pinned_count = 1;
    refuse(body, "pinned", PEL_BAD_ARGUMENT);
    const pel_key keys[2] = {{1, 1}, {1, 2}};
    body = good;
    body.spring_damping = (pel_quantity){.keys = keys, .key_count = 2};
    refuse(body, "spring damping", PEL_BAD_ARGUMENT);
    for (int32_t v = 0; v < 42; v++)
        memcpy(mesh->positions[v], mesh->positions[0], sizeof mesh->positions[0]);
    refuse(good, "no area", PEL_BAD_MESH);
    pel_mesh_destroy(mesh);
}

/* a triangle without an area: the remedy is a repair, or a scale where the areas of no triangle are numbers */
static void test_areas(void **unused)
{
    (void)unused;
    static const struct {
        double scale;
        const char *what, *remedy;
    } cases[] = {{1, "has no area", "check --fix"},
                 {1e-49, "has no area", "check --fix"},
                 {1e-200, "has no area: its mesh is 2e-200 m across", "scale: ..."},
                 {1e200, "has no area: its mesh is 2e+200 m across", "scale: ..."}};
    for (size_t c = 0; c < 2 * sizeof cases / sizeof *cases; c++) {
        pel_mesh *mesh = make_sphere(2);
        const double scale = cases[c / 2].scale;
        for (int i = 0; i < 3 * mesh->vertex_count; i++)
            mesh->positions[0][i] *= scale;
        memcpy(mesh->positions[mesh->triangles[5][0]], mesh->positions[mesh->triangles[5][1]], sizeof *mesh->positions);
        pel_body_def body = pel_body_def_default();
        body.name = "ball";
        body.mesh = mesh;
        if (c % 2 == 0) {
            body.mass_kind = PEL_MASS_TOTAL;
        } else {
            body.shell.membrane =
                (pel_membrane_def){.kind = PEL_MEMBRANE_STVK, .young.value = 1e6, .thickness.value = 0.01};
        }
        pel_model_def def = pel_model_def_default();
        def.bodies = &body;
        def.body_count = 1;
        pel_model *model;
        pel_error error;
        assert_int_equal(pel_model_create(&def, &model, &error), PEL_BAD_MESH);
        if (strstr(error.what, cases[c / 2].what) == NULL || strstr(error.remedy, cases[c / 2].remedy) == NULL)
            fail_msg("case %d: %s; %s", (int)c, error.what, error.remedy);
        pel_mesh_destroy(mesh);
    }
}

static void test_curves(void **unused)
{
    (void)unused;
    const pel_key keys[3] = {{1, 2}, {2, 4}, {4, 0}};
    assert_near(pel_curve_value(keys, 3, 0), 2, 0);
    assert_near(pel_curve_value(keys, 3, 1.5), 3, 1e-15);
    assert_near(pel_curve_value(keys, 3, 2), 4, 0);
    assert_near(pel_curve_value(keys, 3, 3), 2, 1e-15);
    assert_near(pel_curve_value(keys, 3, 9), 0, 0);
    assert_near(pel_curve_value(NULL, 0, 9), 1, 0);
}

/* each parameter of a body has its own curve, a copy */
static void test_curves_of_parameters(void **unused)
{
    (void)unused;
    pel_key keys[PEL_PARAMETER_COUNT][2];
    pel_mesh *mesh = make_sphere(2);
    pel_body_def body = ball_body(mesh);
    pel_quantity *quantities[PEL_PARAMETER_COUNT] = {
        [PEL_SPRING_STIFFNESS] = &body.spring_stiffness,
        [PEL_SPRING_DAMPING] = &body.spring_damping,
        [PEL_VOLUMETRIC_STIFFNESS] = &body.volumetric_stiffness,
        [PEL_VOLUMETRIC_DAMPING] = &body.volumetric_damping,
    };
    for (int p = 0; p < PEL_PARAMETER_COUNT; p++) {
        keys[p][0] = (pel_key){p, 2};
        keys[p][1] = (pel_key){p + 2, 4};
        *quantities[p] = (pel_quantity){.value = 1, .keys = keys[p], .key_count = 2};
    }
    pel_model *model = make_model(&body);
    memset(keys, 0, sizeof keys);
    for (int p = 0; p < PEL_PARAMETER_COUNT; p++) {
        const pel_curve *curve = &model->bodies[0].curves[p];
        assert_near(pel_curve_value(curve->keys, curve->key_count, p + 1), 3, 0);
    }
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_order_is_a_permutation),
        cmocka_unit_test(test_springs_are_the_edges),
        cmocka_unit_test(test_lengths_without_springs),
        cmocka_unit_test(test_masses),
        cmocka_unit_test(test_total_by_area),
        cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_areas),
        cmocka_unit_test(test_curves),
        cmocka_unit_test(test_curves_of_parameters),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
