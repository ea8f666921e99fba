/* Woven cloth and tension fields as bodies: a sheet pulled off its axes, the warp from a vector, a coordinate and a
   refined surface, bending along warp and weft, and a sheet that wrinkles. */
#include "shell_fixture.h"

#include "pellicle/shape.h"
#include "pellicle/sim_ledger.h"

enum { CELLS = 6, SIDE = CELLS + 1, SHEET = SIDE * SIDE };

static const double young = 8e5, weft = 3e5, shear = 4e4, poisson = 0.25, thickness = 0.01;

static pel_body_def woven_body(const pel_mesh *mesh, double angle)
{
    pel_body_def body = shell_body(mesh, PEL_MEMBRANE_ORTHOTROPIC);
    body.shell.membrane.young.value = young;
    body.shell.membrane.weft = weft;
    body.shell.membrane.shear = shear;
    body.shell.membrane.poisson = poisson;
    body.shell.membrane.direction[0] = cos(angle);
    body.shell.membrane.direction[1] = sin(angle);
    return body;
}

/* Elastic energy of a body whose vertices are at F X. */
static double energy_at(const pel_body_def *body, pel_method method, const double f[2][2])
{
    pel_model *model = make_model(body);
    pel_sim_def def = pel_sim_def_default();
    def.model = model;
    def.solver.method = method;
    def.solver.dt = 1e-4;
    pel_sim *sim = make_sim(&def);
    const pel_mesh *mesh = body->mesh;
    double(*x)[3] = malloc((size_t)mesh->vertex_count * sizeof *x);
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        for (int c = 0; c < 3; c++)
            x[v][c] = c == 2 ? 0 : f[c][0] * mesh->positions[v][0] + f[c][1] * mesh->positions[v][1];
    assert_int_equal(pel_sim_set_positions(sim, 0, x[0], NULL), PEL_OK);
    pel_sim_measures sums;
    pel_sim_measure(sim, &sums);
    pel_sim_destroy(sim);
    pel_model_destroy(model);
    free(x);
    return sums.membrane_energy;
}

/* Energy of a stretch along the warp, per area: the law's, at any angle of the warp to the mesh. */
static void test_energy_follows_the_warp(void **unused)
{
    (void)unused;
    static const pel_method methods[] = {PEL_METHOD_EXPLICIT, PEL_METHOD_XPBD, PEL_METHOD_IMPLICIT, PEL_METHOD_STATIC};
    const double tolerance = sizeof(pel_real) == 8 ? 1e-9 : 1e-2;
    random_state random = {3};
    pel_mesh *mesh = make_irregular_patch(CELLS, &random);
    const double n = 1 - poisson * poisson * weft / young, e = 0.5 * (1.1 * 1.1 - 1);
    for (double angle = 0; angle < 3; angle += 0.4) {
        const pel_body_def body = woven_body(mesh, angle);
        const double c = cos(angle), s = sin(angle);
        /* 1.1 along the warp; the same along the weft; a shear of both */
        const double along[2][2] = {{1 + 0.1 * c * c, 0.1 * c * s}, {0.1 * c * s, 1 + 0.1 * s * s}};
        const double across[2][2] = {{1 + 0.1 * s * s, -0.1 * c * s}, {-0.1 * c * s, 1 + 0.1 * c * c}};
        for (size_t m = 0; m < sizeof methods / sizeof *methods; m++) {
            assert_near(energy_at(&body, methods[m], along), 0.5 * young * thickness / n * e * e, tolerance);
            assert_near(energy_at(&body, methods[m], across), 0.5 * weft * thickness / n * e * e, tolerance);
        }
    }
    pel_mesh_destroy(mesh);
}

/* the model's own numbers, by any way to give the warp */
static void test_ways_to_give_the_warp(void **unused)
{
    (void)unused;
    random_state random = {4};
    pel_mesh *mesh = make_irregular_patch(CELLS, &random);
    static double along[SHEET], around[SHEET];
    const double point[3] = {5, 0.3, 0};
    assert_int_equal(mesh->vertex_count, SHEET);
    for (int32_t v = 0; v < SHEET; v++) {
        along[v] = 3 + 0.7 * (cos(0.6) * mesh->positions[v][0] + sin(0.6) * mesh->positions[v][1]);
        around[v] = pel_vec3_distance(mesh->positions[v], point);
    }
    pel_body_def vector = woven_body(mesh, 0.6), coordinate = woven_body(mesh, 2), radial = coordinate;
    coordinate.shell.membrane.coordinate = along;
    radial.shell.membrane.coordinate = around;
    pel_model *a = make_model(&vector), *b = make_model(&coordinate), *c = make_model(&radial);
    for (int32_t t = 0; t < mesh->triangle_count; t++) {
        double x[3][3], outward[3], direction[2];
        for (int i = 0; i < PEL_LAW_AXIS; i++)
            assert_near(a->bodies[0].shell->axes[t][i], b->bodies[0].shell->axes[t][i], 1e-12);
        for (int k = 0; k < 3; k++)
            pel_vec3_copy(mesh->positions[mesh->triangles[t][k]], x[k]);
        for (int k = 0; k < 3; k++)
            outward[k] = (x[0][k] + x[1][k] + x[2][k]) / 3 - point[k];
        pel_rest_triangle_direction((const double(*)[3])x, outward, direction);
        for (int i = 0; i < PEL_LAW_AXIS; i++)
            assert_near(c->bodies[0].shell->axes[t][i], direction[i], 0.03); /* edges over the distance */
    }
    pel_model_destroy(a);
    pel_model_destroy(b);
    pel_model_destroy(c);
    /* nowhere to go: a constant, a normal, nothing */
    for (int32_t v = 0; v < SHEET; v++)
        along[v] = 2;
    assert_refused(&coordinate, PEL_BAD_ARGUMENT, "warp");
    vector.shell.membrane.direction[0] = vector.shell.membrane.direction[1] = 0;
    assert_refused(&vector, PEL_BAD_ARGUMENT, "direction");
    vector.shell.membrane.direction[2] = 1;
    assert_refused(&vector, PEL_BAD_ARGUMENT, "warp");
    vector.shell.membrane.direction[0] = 1;
    for (int32_t v = 0; v < SHEET; v++)
        around[v] += young;
    vector.shell.membrane.young.field = around;
    assert_refused(&vector, PEL_BAD_ARGUMENT, "young");
    pel_mesh_destroy(mesh);
}

/* Cloth around a box: where the warp is normal to a side, that side has the next axis. */
static void test_warp_around_a_box(void **unused)
{
    (void)unused;
    const pel_shape_def def = pel_shape_def_default(PEL_SHAPE_BOX);
    pel_mesh *mesh = NULL;
    assert_int_equal(pel_shape_create(&def, &mesh, NULL), PEL_OK);
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        for (int c = 0; c < 3; c++)
            mesh->positions[v][c] =
                (double)(float)mesh->positions[v][c] * (1 + 1e-8 * (v % 7)); /* as files have them */
    const pel_body_def body = woven_body(mesh, 0);
    pel_model *model = make_model(&body);
    int32_t ends = 0;
    for (int32_t t = 0; t < mesh->triangle_count; t++) {
        double x[3][3], expected[2];
        for (int k = 0; k < 3; k++)
            pel_vec3_copy(mesh->positions[mesh->triangles[t][k]], x[k]);
        const bool is_end = fabs(x[0][0] - x[1][0]) + fabs(x[0][0] - x[2][0]) < 1e-6;
        ends += is_end;
        pel_rest_triangle_direction((const double(*)[3])x, (const double[3]){!is_end, is_end, 0}, expected);
        for (int i = 0; i < PEL_LAW_AXIS; i++)
            assert_near(model->bodies[0].shell->axes[t][i], expected[i], 1e-12);
    }
    assert_true(ends > 0 && ends < mesh->triangle_count);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

/* the energy of a triangle with a uniform curvature (11, 22, twice 12), per area: the sum of the curvatures of its
   edges alpha |e| / A about their directions is that */
static double curved(const pel_shell *shell, const pel_shell_part_bending *part, int32_t t, const double curvature[3])
{
    const pel_rest_triangle rest = pel_shell_rest(shell, t);
    const pel_plate plate = pel_shell_plate(shell, t);
    const pel_midedge element = pel_midedge_setup(&rest, part->stiffness, &plate);
    const double *i = rest.inverse, corner[3][2] = {{1 / i[0], 0}, {-i[1] / (i[0] * i[2]), 1 / i[2]}, {0, 0}};
    double m[3][3], alpha[3], moment[3], determinant = 0;
    for (int l = 0; l < 3; l++) {
        const double x = corner[(l + 1) % 3][0] - corner[l][0], y = corner[(l + 1) % 3][1] - corner[l][1];
        const double scale = 1 / (hypot(x, y) * rest.area);
        m[0][l] = y * y * scale;
        m[1][l] = x * x * scale;
        m[2][l] = -2 * x * y * scale;
    }
    for (int l = 0; l < 3; l++) {
        double column[3], normal[3];
        const double first[3] = {m[0][(l + 1) % 3], m[1][(l + 1) % 3], m[2][(l + 1) % 3]};
        const double second[3] = {m[0][(l + 2) % 3], m[1][(l + 2) % 3], m[2][(l + 2) % 3]};
        pel_vec3_cross(first, second, normal);
        pel_vec3_set(column, m[0][l], m[1][l], m[2][l]);
        determinant = pel_vec3_dot(normal, column);
        alpha[l] = pel_vec3_dot(normal, curvature) / determinant;
    }
    pel_midedge_moments(&element, alpha, moment);
    return 0.5 * (alpha[0] * moment[0] + alpha[1] * moment[1] + alpha[2] * moment[2]) / rest.area;
}

/* D(a) = D1 cos^4 a + D2 sin^4 a + 2 (D12 + 2 D33) sin^2 a cos^2 a, of the membrane or as given, in every triangle */
static void test_bending_follows_the_warp(void **unused)
{
    (void)unused;
    random_state random = {8};
    pel_mesh *mesh = make_irregular_patch(CELLS, &random);
    const double cube = thickness * thickness * thickness / 12, n = 1 - poisson * poisson * weft / young;
    for (int given = 0; given < 2; given++) {
        pel_body_def body = woven_body(mesh, 0.5);
        body.shell.bending.model = PEL_BENDING_MIDEDGE;
        double d1 = young * cube / n, d2 = weft * cube / n, mixed = poisson * d2 + 2 * shear * cube;
        if (given) {
            body.shell.bending.stiffness.value = d1 = 0.02;
            body.shell.bending.weft = d2 = 0.003;
            mixed = sqrt(d1 * d2); /* Huber */
        }
        pel_model *model = make_model(&body);
        const pel_shell *shell = model->bodies[0].shell;
        for (int32_t t = 0; t < shell->triangle_count; t++)
            for (double angle = 0; angle < 1.6; angle += 0.26) {
                /* rolled at this angle to the warp */
                const double *axis = shell->axes[t], c = cos(angle), s = sin(angle);
                const double u = c * axis[0] - s * axis[1], v = s * axis[0] + c * axis[1];
                const double roll[3] = {u * u, v * v, 2 * u * v}, cc = c * c, ss = s * s;
                const double expected = 0.5 * (d1 * cc * cc + d2 * ss * ss + 2 * mixed * cc * ss);
                assert_near(curved(shell, &shell->parts[t], t, roll), expected, 1e-10 * d1);
            }
        pel_model_destroy(model);
    }
    pel_mesh_destroy(mesh);
}

/* hinges along the axes of a square grid bend with the stiffness of the yarns that cross them */
static void test_hinges_follow_the_warp(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_grid(4, 4, 1, 1, PEL_GRID_ONE_DIAGONAL);
    pel_body_def body = woven_body(mesh, 0);
    body.shell.bending.model = PEL_BENDING_HINGE;
    body.shell.bending.stiffness.value = 0.02;
    body.shell.bending.weft = 0.003;
    pel_model *model = make_model(&body);
    const pel_shell *shell = model->bodies[0].shell;
    int counts[3] = {0};
    for (int32_t i = 0; i < shell->hinge_count; i++) {
        const pel_shell_hinge hinge = pel_shell_hinge_of(shell, i);
        double x[4][3];
        pel_load_points(model->rest, hinge.vertices, 4, x);
        const double dx = fabs(x[1][0] - x[0][0]), dy = fabs(x[1][1] - x[0][1]);
        const double diagonal = 0.25 * (0.02 + 0.003 + 2 * sqrt(0.02 * 0.003));
        const int kind = dx < 1e-6 ? 0 : dy < 1e-6 ? 1 : 2;
        const double expected[3] = {0.02, 0.003, diagonal};
        assert_near(hinge.stiffness, expected[kind], 1e-12);
        counts[kind]++;
    }
    assert_true(counts[0] == 12 && counts[1] == 12 && counts[2] == 16);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

/* ---- a sheet that wrinkles ---- */

/* Sheared by g at constant height with its border held, as the web of a beam (Wagner 1929): a tension of E h g / 2 at
   45 degrees and nothing across, so the energy E h g^2 / 8 per area, to the first order; inner vertices that were moved
   away come back. */
static void test_sheared_web(void **unused)
{
    (void)unused;
    static const struct {
        pel_method method;
        double dt, tolerance;
        int steps;
    } runs[] = {
        {PEL_METHOD_STATIC, 1, 1e-3, 1}, {PEL_METHOD_IMPLICIT, 0.1, 5e-3, 40}, {PEL_METHOD_XPBD, 0.002, 1e-2, 1500}};
    if (sizeof(pel_real) == 4)
        skip();
    pel_mesh *mesh = make_grid(CELLS, CELLS, 1, 1, PEL_GRID_UNION_JACK);
    int32_t held[4 * CELLS];
    int count = 0;
    for (int32_t v = 0; v < SHEET; v++)
        if (v % SIDE == 0 || v % SIDE == CELLS || v / SIDE == 0 || v / SIDE == CELLS)
            held[count++] = v;
    assert_int_equal(count, 4 * CELLS);
    const double g = 0.01, share = 1e-3, nu = 0.3;
    const double expected = 1e5 * 0.01 * g * g * ((1 - share) / 8 + share / (4 * (1 + nu)));
    for (size_t r = 0; r < sizeof runs / sizeof *runs; r++) {
        pel_body_def body = shell_body(mesh, PEL_MEMBRANE_TENSION_FIELD);
        body.pinned = held;
        body.pinned_count = count;
        pel_model *model = make_model(&body);
        pel_sim_def def = lone_sim(model, runs[r].method, runs[r].dt);
        def.solver.drag = 20;
        if (runs[r].method == PEL_METHOD_XPBD)
            def.solver.substeps = 4;
        pel_sim *sim = make_sim(&def);
        double x[SHEET][3];
        for (int32_t v = 0; v < SHEET; v++) {
            const bool is_inner = v % SIDE > 0 && v % SIDE < CELLS && v / SIDE > 0 && v / SIDE < CELLS;
            pel_vec3_set(x[v], mesh->positions[v][0] + g * mesh->positions[v][1],
                         mesh->positions[v][1] + (is_inner ? 1e-3 * (v % 3) : 0), 0);
        }
        assert_int_equal(pel_sim_set_positions(sim, 0, x[0], NULL), PEL_OK);
        run_steps(sim, runs[r].steps);
        pel_sim_measures sums;
        pel_sim_measure(sim, &sums);
        print_message("method %d: %.6f of the energy of the web\n", (int)runs[r].method,
                      sums.membrane_energy / expected);
        assert_near(sums.membrane_energy / expected, 1, runs[r].tolerance + g);
        pel_sim_destroy(sim);
        pel_model_destroy(model);
    }
    pel_mesh_destroy(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_energy_follows_the_warp), cmocka_unit_test(test_ways_to_give_the_warp),
        cmocka_unit_test(test_warp_around_a_box),       cmocka_unit_test(test_bending_follows_the_warp),
        cmocka_unit_test(test_hinges_follow_the_warp),  cmocka_unit_test(test_sheared_web),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
