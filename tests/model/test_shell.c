/* The shell of a body: counts, rest data, hinges, regions, fields, refusals. */
#include "failing_malloc.h"
#include "shell_fixture.h"

#include "pellicle/topology.h"

static const pel_shell *shell_of(const pel_model *model)
{
    return model->bodies[0].shell;
}

static void test_nothing_is_no_shell(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_sphere(3);
    pel_body_def body = ball_body(mesh);
    pel_model *model = make_model(&body);
    assert_null(shell_of(model));
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

static void mesh_corners(const pel_model *model, const int32_t *places, int count, double x[][3])
{
    const pel_body *body = &model->bodies[0];
    for (int i = 0; i < count; i++)
        memcpy(x[i], body->mesh->positions[model->mesh_vertex[places[i]]], sizeof x[i]);
}

/* the triangles are those of the mesh in its order, undeformed at rest */
static void test_triangles(void **unused)
{
    (void)unused;
    random_state random = {1};
    pel_mesh *mesh = make_irregular_ball(5, &random);
    pel_body_def def = shell_body(mesh, PEL_MEMBRANE_COROTATED);
    pel_model *model = make_model(&def);
    const pel_shell *shell = shell_of(model);
    double area = 0;
    assert_int_equal(shell->triangle_count, mesh->triangle_count);
    assert_true(shell->has_membrane && shell->hinge_count == 0 && shell->region_count == 0);
    for (int32_t t = 0; t < shell->triangle_count; t++) {
        double x[3][3], f[6];
        for (int i = 0; i < 3; i++)
            assert_int_equal(model->mesh_vertex[shell->corners[t][i]], mesh->triangles[t][i]);
        mesh_corners(model, shell->corners[t], 3, x);
        const pel_rest_triangle rest = pel_shell_rest(shell, t);
        pel_deformation_gradient(&rest, (const double(*)[3])x, f);
        for (int a = 0; a < 2; a++)
            for (int b = 0; b < 2; b++)
                assert_near(f[a] * f[b] + f[2 + a] * f[2 + b] + f[4 + a] * f[4 + b], a == b, 1e-12);
        assert_true(pel_shell_sheet_of(shell, t).young == 1e5 && pel_shell_sheet_of(shell, t).thickness == 0.01);
        area += rest.area;
    }
    assert_near(area, model->bodies[0].rest_area, 1e-12);
    assert_near(shell->mean_edge, 0.25, 0.1);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

static bool has_corner(const int32_t triangle[3], int32_t v)
{
    return triangle[0] == v || triangle[1] == v || triangle[2] == v;
}

/* one hinge for each edge between two triangles, turned as the mesh is; ridges of a convex body are positive */
static void check_hinges(const pel_mesh *mesh, bool convex)
{
    pel_body_def def = shell_body(mesh, PEL_MEMBRANE_STVK);
    def.shell.bending.model = PEL_BENDING_HINGE;
    pel_model *model = make_model(&def);
    pel_topology *topology;
    assert_int_equal(pel_topology_create(mesh, &topology, NULL), PEL_OK);
    const pel_shell *shell = shell_of(model);
    assert_int_equal(shell->hinge_count, topology->edge_count - topology->boundary_edge_count);
    for (int32_t i = 0; i < shell->hinge_count; i++) {
        const pel_shell_hinge hinge = pel_shell_hinge_of(shell, i);
        double rest_angle = pel_shell_rest_angle(shell, i);
        int32_t v[4];
        double x[4][3], normal[3], edge[3];
        for (int k = 0; k < 4; k++)
            v[k] = model->mesh_vertex[hinge.vertices[k]];
        const int32_t *left = mesh->triangles[hinge.triangles[0]], *right = mesh->triangles[hinge.triangles[1]];
        assert_true(has_corner(left, v[0]) && has_corner(left, v[1]) && has_corner(left, v[2]));
        assert_true(has_corner(right, v[0]) && has_corner(right, v[1]) && has_corner(right, v[3]));
        mesh_corners(model, hinge.vertices, 4, x);
        /* (v0, v1, v2) has the winding of the left triangle */
        pel_vec3_triangle_normal(x[0], x[1], x[2], normal);
        pel_vec3_triangle_normal(mesh->positions[left[0]], mesh->positions[left[1]], mesh->positions[left[2]], edge);
        assert_true(pel_vec3_dot(normal, edge) > 0);
        assert_int_equal(hinge.number, i);
        assert_true(rest_angle == pel_dihedral_angle((const double(*)[3])x, NULL));
        assert_true(!convex || rest_angle > 0);
        assert_near(hinge.stiffness, 1e5 * 1e-6 / (12 * 0.91), 1e-15);
        assert_true(pel_shell_isometric(model->rest, &hinge).factor > 0);
        assert_true(pel_shell_angle(shell, model->rest, &hinge).factor > 0);
        assert_true(pel_shell_angle(shell, model->rest, &hinge).rest_angle == rest_angle);
    }
    pel_topology_destroy(topology);
    pel_model_destroy(model);
}

static void test_hinges(void **unused)
{
    (void)unused;
    pel_mesh *ball = make_sphere(4), *sheet = make_grid(4, 3, 1, 1, PEL_GRID_ONE_DIAGONAL);
    check_hinges(ball, true);
    check_hinges(sheet, false);
    pel_mesh_destroy(ball);
    pel_mesh_destroy(sheet);
}

/* numbers on vertices become means of corners and ends */
static void test_fields(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_grid(2, 2, 1, 1, PEL_GRID_ONE_DIAGONAL);
    double young[9], thickness[9], stiffness[9], outside[9], weights[9];
    for (int v = 0; v < 9; v++) {
        young[v] = 1000 * (1 + v);
        thickness[v] = 0.001 * (9 - v);
        stiffness[v] = v;
        outside[v] = 10 * v;
        weights[v] = v % 2;
    }
    pel_body_def def = shell_body(mesh, PEL_MEMBRANE_NEO_HOOKEAN);
    def.shell.membrane.young.field = young;
    def.shell.membrane.thickness.field = thickness;
    def.shell.bending.model = PEL_BENDING_ISOMETRIC;
    def.shell.bending.stiffness.field = stiffness;
    def.shell.pressure.kind = PEL_PRESSURE_GIVEN;
    def.shell.pressure.outside.field = outside;
    def.shell.pressure.weights = weights;
    pel_model *model = make_model(&def);
    const pel_shell *shell = shell_of(model);
    for (int32_t t = 0; t < shell->triangle_count; t++) {
        const int32_t *v = mesh->triangles[t];
        double mean = (v[0] + v[1] + v[2]) / 3.0, inside = (v[0] % 2 + v[1] % 2 + v[2] % 2) / 3.0;
        assert_near(pel_shell_sheet_of(shell, t).young, 1000 * (1 + mean), 1e-9);
        assert_near(pel_shell_sheet_of(shell, t).thickness, 0.001 * (9 - mean), 1e-15);
        assert_near(shell->pressure_weights[t], 10 * mean * inside, 1e-12);
        const pel_membrane_material material = {.kind = PEL_MEMBRANE_NEO_HOOKEAN,
                                                .young = 1000 * (1 + mean),
                                                .poisson = 0.3,
                                                .thickness = 0.001 * (9 - mean)};
        const pel_membrane_law law = pel_shell_law(shell, t), exact = pel_membrane_law_of(&material);
        assert_near(law.modulus, exact.modulus, 1e-14 * exact.modulus);
        assert_true(law.kind == exact.kind && law.poisson == 0.3 && law.numbers[0] == exact.numbers[0]);
    }
    for (int32_t i = 0; i < shell->hinge_count; i++) {
        const pel_shell_hinge hinge = pel_shell_hinge_of(shell, i);
        assert_near(hinge.stiffness,
                    0.5 * (model->mesh_vertex[hinge.vertices[0]] + model->mesh_vertex[hinge.vertices[1]]), 1e-12);
    }
    assert_true(shell->pressure.outside.value == 1);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

/* without a membrane bending has the ratio that is given, whatever the law */
static void test_poisson_of_bending(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_grid(2, 2, 1, 1, PEL_GRID_ONE_DIAGONAL);
    for (int on = 0; on < 2; on++) {
        pel_body_def def = shell_body(mesh, PEL_MEMBRANE_GENT);
        def.shell.membrane.on = on == 1;
        def.shell.bending.model = PEL_BENDING_MIDEDGE;
        def.shell.bending.stiffness.value = 1;
        pel_model *model = make_model(&def);
        assert_true(shell_of(model)->law.poisson == (on == 1 ? 0.5 : def.shell.membrane.poisson));
        pel_model_destroy(model);
    }
    pel_mesh_destroy(mesh);
}

static void test_regions(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_sphere(5);
    double *weights = calloc((size_t)mesh->vertex_count, sizeof *weights);
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        weights[v] = mesh->positions[v][2] > 0.7 ? 0.5 : 0;
    static const pel_key keys[2] = {{0, 1}, {2, 0.5}};
    pel_anisotropy_def regions[2] = {pel_anisotropy_def_default(), pel_anisotropy_def_default()};
    regions[0].mode = PEL_FIBRE_ACTIVE;
    regions[0].rest_length = (pel_quantity){.keys = keys, .key_count = 2};
    regions[0].weights = weights;
    regions[0].center[2] = 1;
    regions[1].mode = PEL_FIBRE_CURL;
    regions[1].weights = weights;
    pel_body_def def = shell_body(mesh, PEL_MEMBRANE_STVK);
    def.shell.anisotropies = regions;
    def.shell.anisotropy_count = 2;
    def.shell.bending.model = PEL_BENDING_HINGE;
    pel_model *model = make_model(&def);
    const pel_shell *shell = shell_of(model);
    const pel_shell_region *active = &shell->regions[0];
    int32_t count = 0;
    for (int32_t t = 0; t < mesh->triangle_count; t++) {
        double sum = 0;
        for (int i = 0; i < 3; i++)
            sum += weights[mesh->triangles[t][i]];
        count += sum > 0;
    }
    assert_true(count > 10);
    assert_int_equal(active->fibre_count, count);
    for (int32_t i = 0; i < active->fibre_count; i++) {
        const pel_shell_fibre fibre = pel_shell_fibre_of(shell, active, i);
        const pel_rest_triangle rest = pel_shell_rest(shell, fibre.triangle);
        double x[3][3], f[6], along = 0, toward[3] = {0, 0, 1};
        assert_true(i == 0 || fibre.triangle > pel_shell_fibre_triangle(active, i - 1));
        assert_near(hypot(fibre.direction[0], fibre.direction[1]), 1, 1e-12);
        mesh_corners(model, shell->corners[fibre.triangle], 3, x);
        pel_deformation_gradient(&rest, (const double(*)[3])x, f);
        for (int c = 0; c < 3; c++) {
            toward[c] -= (x[0][c] + x[1][c] + x[2][c]) / 3;
            along += (f[2 * c] * fibre.direction[0] + f[2 * c + 1] * fibre.direction[1]) * toward[c];
        }
        assert_true(along > 0);
    }
    assert_near(pel_curve_value(active->course.keys, active->course.key_count, 1), 0.75, 1e-15);
    /* hinges inside turn round, those outside stay */
    assert_int_equal(shell->regions[1].fibre_count, 0);
    for (int32_t i = 0; i < shell->hinge_count; i++) {
        const pel_shell_hinge hinge = pel_shell_hinge_of(shell, i);
        double x[4][3], w = 0;
        mesh_corners(model, hinge.vertices, 4, x);
        for (int k = 0; k < 2; k++)
            w += 0.5 * weights[model->mesh_vertex[hinge.vertices[k]]];
        assert_near(pel_shell_rest_angle(shell, i), (1 - 2 * w) * pel_dihedral_angle((const double(*)[3])x, NULL),
                    1e-14);
    }
    pel_model_destroy(model);
    free(weights);
    pel_mesh_destroy(mesh);
}

typedef struct refusal {
    void (*change)(pel_body_def *body);
    const char *what;
} refusal;

static void poisson_of_one(pel_body_def *body)
{
    body->shell.membrane.poisson = 1;
}
static void negative_young(pel_body_def *body)
{
    body->shell.membrane.young.value = -1;
}
static void no_thickness(pel_body_def *body)
{
    body->shell.membrane.thickness.value = 0;
}
static void not_a_number(pel_body_def *body)
{
    body->shell.membrane.young.value = (double)NAN;
}
static void bad_field(pel_body_def *body)
{
    static double young[12];
    for (int v = 0; v < 12; v++)
        young[v] = v - 5;
    body->shell.membrane.young.field = young;
}
static void keyed_thickness(pel_body_def *body)
{
    static const pel_key keys[1] = {{0, 1}};
    body->shell.membrane.thickness = (pel_quantity){.keys = keys, .key_count = 1};
}
static void large_weight(pel_body_def *body)
{
    body->shell.bending.model = PEL_BENDING_HINGE;
    body->shell.bending.weight = 2;
}
static void infinite_pressure(pel_body_def *body)
{
    body->shell.pressure.kind = PEL_PRESSURE_GIVEN;
    body->shell.pressure.outside.value = HUGE_VAL;
}
static void bad_gas(pel_body_def *body)
{
    body->shell.pressure.kind = PEL_PRESSURE_GAS;
    body->shell.pressure.value = -1;
}
static void gas_in_varying_outside(pel_body_def *body)
{
    static const double outside[12];
    body->shell.pressure.kind = PEL_PRESSURE_GAS;
    body->shell.pressure.outside.field = outside;
}
static void bad_gamma(pel_body_def *body)
{
    body->shell.pressure.kind = PEL_PRESSURE_GAS;
    body->shell.pressure.gamma = 0.5;
}
static void bad_target(pel_body_def *body)
{
    body->shell.pressure.kind = PEL_PRESSURE_VOLUME;
    body->shell.pressure.target.value = -1;
}
static void empty_region(pel_body_def *body)
{
    static const double weights[12];
    body->shell.pressure.kind = PEL_PRESSURE_GIVEN;
    body->shell.pressure.weights = weights;
}
static void weights_above_one(pel_body_def *body)
{
    static const double weights[12] = {2};
    body->shell.pressure.kind = PEL_PRESSURE_GIVEN;
    body->shell.pressure.weights = weights;
}

static pel_anisotropy_def *one_region(pel_body_def *body)
{
    static pel_anisotropy_def region;
    region = pel_anisotropy_def_default();
    region.mode = PEL_FIBRE_STRAIN;
    body->shell.anisotropies = &region;
    body->shell.anisotropy_count = 1;
    return &region;
}
static void soft_fibres(pel_body_def *body)
{
    one_region(body)->stiffness = 0;
}
static void no_axis(pel_body_def *body)
{
    pel_anisotropy_def *region = one_region(body);
    region->direction = PEL_FIBRE_ALONG;
    region->axis[2] = 0;
}
static void no_strength(pel_body_def *body)
{
    one_region(body)->mode = PEL_FIBRE_CAVE;
}
static void curl_without_hinges(pel_body_def *body)
{
    one_region(body)->mode = PEL_FIBRE_CURL;
}

static void test_refusals(void **unused)
{
    (void)unused;
    static const refusal refusals[] = {
        {poisson_of_one, "poisson"},
        {negative_young, "young"},
        {no_thickness, "thickness"},
        {not_a_number, "young"},
        {bad_field, "young"},
        {keyed_thickness, "thickness"},
        {large_weight, "bending weight is 2"},
        {infinite_pressure, "pressure"},
        {bad_gas, "gas pressure is -1"},
        {gas_in_varying_outside, "varies over the body"},
        {bad_gamma, "gamma"},
        {bad_target, "target volume is -1"},
        {empty_region, "0 on every vertex"},
        {weights_above_one, "pressure weights is 2"},
        {soft_fibres, "fibre stiffness is 0"},
        {no_axis, "axis"},
        {no_strength, "strength"},
        {curl_without_hinges, "no hinges"},
    };
    pel_mesh *mesh = make_sphere(1);
    for (size_t i = 0; i < sizeof refusals / sizeof refusals[0]; i++) {
        pel_body_def body = shell_body(mesh, PEL_MEMBRANE_STVK);
        refusals[i].change(&body);
        assert_refused(&body, PEL_BAD_ARGUMENT, refusals[i].what);
    }
    pel_mesh_destroy(mesh);
}

/* an open sheet has no volume */
static void test_open_meshes(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_grid(2, 2, 1, 1, PEL_GRID_ONE_DIAGONAL);
    pel_body_def body = shell_body(mesh, PEL_MEMBRANE_STVK);
    body.shell.pressure.kind = PEL_PRESSURE_VOLUME;
    assert_refused(&body, PEL_BAD_ARGUMENT, "encloses no volume");
    body.shell.pressure.kind = PEL_PRESSURE_GAS;
    assert_refused(&body, PEL_BAD_ARGUMENT, "encloses no volume");
    body.shell.pressure.kind = PEL_PRESSURE_GIVEN;
    body.shell.pressure.outside.value = 3;
    pel_model_destroy(make_model(&body));
    pel_mesh_destroy(mesh);
}

/* two triangles on top of each other have no dihedral angle to keep */
static void test_folded_rest_shape(void **unused)
{
    (void)unused;
    static const double positions[12] = {0, 0, 0, 1, 0, 0, 0.5, 1, 0, 0.5, 0.9, 0};
    static const int32_t triangles[6] = {0, 1, 2, 1, 0, 3};
    pel_mesh *mesh;
    assert_int_equal(pel_mesh_create(positions, 4, triangles, 2, &mesh, NULL), PEL_OK);
    pel_body_def body = shell_body(mesh, PEL_MEMBRANE_STVK);
    pel_model_destroy(make_model(&body));
    body.shell.bending.model = PEL_BENDING_HINGE;
    assert_refused(&body, PEL_BAD_MESH, "folded");
    pel_mesh_destroy(mesh);
}

static pel_status create_shell(const void *mesh, pel_error *error)
{
    static const pel_key keys[2] = {{0, 1}, {1, 0.5}};
    static double weights[12];
    for (int v = 0; v < 12; v++)
        weights[v] = v / 11.0;
    pel_anisotropy_def regions[2] = {pel_anisotropy_def_default(), pel_anisotropy_def_default()};
    regions[0].mode = regions[1].mode = PEL_FIBRE_ACTIVE;
    regions[0].rest_length = (pel_quantity){.keys = keys, .key_count = 2};
    regions[1].weights = weights;
    pel_body_def body = shell_body(mesh, PEL_MEMBRANE_STVK);
    body.shell.bending.model = PEL_BENDING_HINGE;
    body.shell.anisotropies = regions;
    body.shell.anisotropy_count = 2;
    body.shell.pressure.kind = PEL_PRESSURE_GIVEN;
    body.shell.pressure.outside = (pel_quantity){.keys = keys, .key_count = 2};
    body.shell.pressure.weights = weights;
    pel_model_def def = pel_model_def_default();
    def.bodies = &body;
    def.body_count = 1;
    pel_model *model;
    pel_status status = pel_model_create(&def, &model, error);
    assert_true((model == NULL) == (status != PEL_OK));
    pel_model_destroy(model);
    return status;
}

static void test_allocation_failure(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_sphere(1);
    assert_true(for_every_allocation_failure(create_shell, mesh) > 20);
    pel_mesh_destroy(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_nothing_is_no_shell),
        cmocka_unit_test(test_triangles),
        cmocka_unit_test(test_hinges),
        cmocka_unit_test(test_fields),
        cmocka_unit_test(test_poisson_of_bending),
        cmocka_unit_test(test_regions),
        cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_open_meshes),
        cmocka_unit_test(test_folded_rest_shape),
        cmocka_unit_test(test_allocation_failure),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
