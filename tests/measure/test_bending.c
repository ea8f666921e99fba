#include "stencil.h"

#include "measure/tangent.h"
#include "pellicle/bending.h"
#include "pellicle/shape.h"
#include "pellicle/subdivide.h"
#include "pellicle/topology.h"

enum { TRIALS = 200 };

/* two triangles that share an edge of the given length; the right one is turned down by `angle`, both irregular */
static void folded_pair(random_state *random, double edge_length, double angle, double x[4][3])
{
    pel_vec3_set(x[0], 0, 0, 0);
    pel_vec3_set(x[1], 0, edge_length, 0);
    double left = random_between(random, 0.5, 1.5), right = random_between(random, 0.5, 1.5);
    pel_vec3_set(x[2], -left, random_between(random, -0.3, 1.3), 0);
    pel_vec3_set(x[3], right * cos(angle), random_between(random, -0.3, 1.3), -right * sin(angle));
}

/* the same pair folded by another angle: an isometry */
static void refold(const double flat[4][3], double angle, double x[4][3])
{
    memcpy(x, flat, 12 * sizeof(double));
    double right = hypot(flat[3][0], flat[3][2]);
    pel_vec3_set(x[3], right * cos(angle), flat[3][1], -right * sin(angle));
}

static void disturb(random_state *random, double amount, double x[4][3])
{
    for (int a = 0; a < 4; a++)
        for (int i = 0; i < 3; i++)
            x[a][i] += amount * random_normal(random);
}

static void test_isometric_identities(void **unused)
{
    (void)unused;
    random_state random = {51};
    for (int trial = 0; trial < TRIALS; trial++) {
        double length = random_between(&random, 0.5, 2), angle = random_between(&random, -3.1, 3.1);
        double flat[4][3], folded[4][3], area = 0, normal[3];
        folded_pair(&random, length, 0, flat);
        pel_bending_isometric stencil;
        assert_true(pel_bending_isometric_setup((const double(*)[3])flat, &stencil));
        assert_near(stencil.rest_energy, 0, 1e-28);
        assert_near(stencil.weight[0] + stencil.weight[1] + stencil.weight[2] + stencil.weight[3], 0, 1e-14);
        refold((const double(*)[3])flat, angle, folded);
        pel_vec3_triangle_normal(flat[0], flat[1], flat[2], normal);
        area += 0.5 * pel_vec3_length(normal);
        pel_vec3_triangle_normal(flat[1], flat[0], flat[3], normal);
        area += 0.5 * pel_vec3_length(normal);
        assert_near(stencil.factor, 3 / area, 1e-13);
        /* |K x| = 2 |e| sin(theta / 2), so E = 6 |e|^2 sin^2(theta / 2) / (A0 + A1) */
        double energy = pel_bending_isometric_energy(&stencil, PEL_BENDING_LITERAL, (const double(*)[3])folded, NULL);
        assert_near(energy, 6 * pow(length * sin(angle / 2), 2) / area, 1e-12 * (1 + energy));
        assert_near(pel_dihedral_angle((const double(*)[3])folded, NULL), angle, 1e-14);
        /* the weights depend on lengths alone: a stencil set up in the folded state is the same, but for its rest */
        pel_bending_isometric other;
        assert_true(pel_bending_isometric_setup((const double(*)[3])folded, &other));
        for (int a = 0; a < 4; a++)
            assert_near(other.weight[a], stencil.weight[a], 1e-13);
        assert_near(other.rest_energy, energy, 1e-12 * (1 + energy));
        assert_near(pel_bending_isometric_energy(&other, PEL_BENDING_REST_SUBTRACTED, (const double(*)[3])folded, NULL),
                    0, 0);
    }
}

static double isometric_only(const void *context, const double *x)
{
    return pel_bending_isometric_energy(context, PEL_BENDING_REST_SUBTRACTED, (const double(*)[3])x, NULL);
}

static double angle_only(const void *unused, const double *x)
{
    (void)unused;
    return pel_dihedral_angle((const double(*)[3])x, NULL);
}

static double hinge_only(const void *context, const double *x)
{
    return pel_hinge_energy(context, (const double(*)[3])x, NULL);
}

static void test_gradients(void **unused)
{
    (void)unused;
    random_state random = {52};
    double worst[3] = {0}, load = 0;
    for (int trial = 0; trial < TRIALS; trial++) {
        double rest[4][3], x[4][3], gradient[4][3];
        folded_pair(&random, random_between(&random, 0.7, 1.5), random_between(&random, -2, 2), rest);
        pel_bending_isometric stencil;
        pel_hinge hinge;
        assert_true(pel_bending_isometric_setup((const double(*)[3])rest, &stencil));
        assert_true(pel_hinge_setup((const double(*)[3])rest, &hinge));
        stencil_move(&random, 4, (const double(*)[3])rest, x);
        disturb(&random, 0.05, x);
        const double(*points)[3] = (const double(*)[3])x, (*rows)[3] = (const double(*)[3])gradient;
        pel_bending_isometric_energy(&stencil, PEL_BENDING_REST_SUBTRACTED, points, gradient);
        worst[0] = fmax(worst[0], stencil_gradient_error(isometric_only, &stencil, 4, points, rows, 1e-2));
        pel_dihedral_angle(points, gradient);
        worst[1] = fmax(worst[1], stencil_gradient_error(angle_only, NULL, 4, points, rows, 2e-3));
        load = fmax(load, stencil_net_load(4, points, rows));
        hinge.rest_angle += 0.3;
        pel_hinge_energy(&hinge, points, gradient);
        worst[2] = fmax(worst[2], stencil_gradient_error(hinge_only, &hinge, 4, points, rows, 2e-3));
        load = fmax(load, stencil_net_load(4, points, rows));
        pel_bending_isometric_energy(&stencil, PEL_BENDING_LITERAL, points, gradient);
        load = fmax(load, stencil_net_load(4, points, rows));
    }
    print_message("gradient errors: isometric %.1e, angle %.1e, hinge %.1e; net load %.1e\n", worst[0], worst[1],
                  worst[2], load);
    for (int i = 0; i < 3; i++)
        assert_true(worst[i] < 1e-8);
    assert_true(load < 1e-13);
}

static void test_invariance_and_rest(void **unused)
{
    (void)unused;
    random_state random = {53};
    for (int trial = 0; trial < TRIALS; trial++) {
        double rest[4][3], x[4][3], moved[4][3], gradient[4][3];
        folded_pair(&random, 1, random_between(&random, -2, 2), rest);
        pel_bending_isometric stencil;
        pel_hinge hinge;
        assert_true(pel_bending_isometric_setup((const double(*)[3])rest, &stencil));
        assert_true(pel_hinge_setup((const double(*)[3])rest, &hinge));
        stencil_move(&random, 4, (const double(*)[3])rest, moved);
        const double(*points)[3] = (const double(*)[3])moved;
        assert_near(pel_hinge_energy(&hinge, points, gradient), 0, 1e-27);
        assert_true(stencil_scale(4, (const double(*)[3])gradient) < 1e-12);
        assert_near(pel_bending_isometric_energy(&stencil, PEL_BENDING_REST_SUBTRACTED, points, NULL), 0, 1e-12);
        memcpy(x, rest, sizeof x);
        disturb(&random, 0.2, x);
        double isometric = pel_bending_isometric_energy(&stencil, PEL_BENDING_LITERAL, (const double(*)[3])x, NULL);
        double angular = pel_hinge_energy(&hinge, (const double(*)[3])x, NULL);
        stencil_move(&random, 4, (const double(*)[3])x, moved);
        assert_near(pel_bending_isometric_energy(&stencil, PEL_BENDING_LITERAL, points, NULL), isometric,
                    1e-12 * (1 + isometric));
        assert_near(pel_hinge_energy(&hinge, points, NULL), angular, 1e-12 * (1 + angular));
    }
}

/* sharp folds at rest go the short way past half a turn, others never do; the two energies agree for small folds as 3
   to 1 */
static void test_hinge(void **unused)
{
    (void)unused;
    const double flat[4][3] = {{0, 0, 0}, {0, 1, 0}, {-1, 0.5, 0}, {1, 0.5, 0}};
    double x[4][3];
    pel_hinge hinge;
    pel_bending_isometric stencil;
    assert_true(pel_hinge_setup(flat, &hinge));
    assert_true(pel_bending_isometric_setup(flat, &stencil));
    assert_near(hinge.factor, 1, 1e-15);
    assert_near(hinge.rest_angle, 0, 0);
    refold(flat, 1e-3, x);
    double ratio = pel_bending_isometric_energy(&stencil, PEL_BENDING_LITERAL, (const double(*)[3])x, NULL) /
                   pel_hinge_energy(&hinge, (const double(*)[3])x, NULL);
    assert_near(ratio, 3, 1e-6);
    hinge.rest_angle = -3;
    refold(flat, 3, x);
    assert_near(pel_hinge_energy(&hinge, (const double(*)[3])x, NULL), 0.5 * pow(2 * 3.141592653589793 - 6, 2), 1e-13);
    const double folds[][2] = {{0.4, -3}, {-0.4, 3}, {1.5, -2}, {-1.5, 2}, {0.4, 3}, {-1, -3}};
    for (size_t i = 0; i < sizeof folds / sizeof *folds; i++) {
        double points[12], difference = folds[i][1] - folds[i][0];
        hinge.rest_angle = folds[i][0];
        refold(flat, folds[i][1], x);
        memcpy(points, x, sizeof points);
        assert_near(pel_hinge_energy(&hinge, (const double(*)[3])x, NULL), 0.5 * difference * difference, 1e-13);
        assert_near(pel_angle_from_rest(points, hinge.rest_angle), difference, 1e-14);
    }
    assert_near(pel_bending_stiffness(12, 0.5, 2), 12 * 8 / (12 * 0.75), 1e-14);
}

static void test_degenerate(void **unused)
{
    (void)unused;
    const double cases[3][4][3] = {
        {{0}}, {{0, 0, 0}, {0, 1, 0}, {0, 2, 0}, {1, 0, 0}}, {{0, 0, 0}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}}};
    for (int c = 0; c < 3; c++) {
        pel_hinge hinge;
        pel_bending_isometric stencil;
        double gradient[4][3];
        assert_false(pel_hinge_setup(cases[c], &hinge));
        assert_false(pel_bending_isometric_setup(cases[c], &stencil));
        assert_near(hinge.factor, 0, 0);
        assert_near(stencil.factor, 0, 0);
        assert_near(pel_dihedral_angle(cases[c], gradient), 0, 0);
        assert_true(isfinite(stencil_scale(4, (const double(*)[3])gradient)));
    }
}

/* one split of a sphere, the new vertices pushed out to it */
static pel_mesh *split_sphere(pel_mesh *mesh)
{
    pel_mesh *fine;
    pel_topology *topology;
    assert_int_equal(pel_topology_create(mesh, &topology, NULL), PEL_OK);
    assert_int_equal(pel_mesh_subdivide(mesh, 1, &fine, NULL), PEL_OK);
    for (int32_t e = 0; e < topology->edge_count; e++) {
        int32_t h = topology->half_edge_of_edge[e];
        double *middle = fine->positions[mesh->vertex_count + e];
        pel_vec3_add(mesh->positions[pel_half_edge_origin(topology, h)],
                     mesh->positions[pel_half_edge_target(topology, h)], middle);
        pel_vec3_normalize(middle);
    }
    pel_topology_destroy(topology);
    pel_mesh_destroy(mesh);
    return fine;
}

static double rest_energy_of(const pel_mesh *mesh)
{
    pel_topology *topology;
    assert_int_equal(pel_topology_create(mesh, &topology, NULL), PEL_OK);
    double energy = 0;
    for (int32_t e = 0; e < topology->edge_count; e++) {
        int32_t h = topology->half_edge_of_edge[e], g = topology->twin[h];
        const int32_t v[4] = {pel_half_edge_origin(topology, h), pel_half_edge_target(topology, h),
                              pel_half_edge_origin(topology, pel_half_edge_previous(h)),
                              pel_half_edge_origin(topology, pel_half_edge_previous(g))};
        double x[4][3];
        for (int a = 0; a < 4; a++)
            pel_vec3_copy(mesh->positions[v[a]], x[a]);
        pel_bending_isometric stencil;
        assert_true(pel_bending_isometric_setup((const double(*)[3])x, &stencil));
        assert_true(pel_dihedral_angle((const double(*)[3])x, NULL) > 0);
        energy += stencil.rest_energy;
    }
    pel_topology_destroy(topology);
    return energy;
}

/* unit spheres of 1280 and 5120 triangles: 25.51 (theory page, section 5); the continuum has 8 pi = 25.13 */
static void test_sphere(void **unused)
{
    (void)unused;
    pel_shape_def def = pel_shape_def_default(PEL_SHAPE_GEODESIC_SPHERE);
    def.frequency = 1;
    pel_mesh *mesh;
    assert_int_equal(pel_shape_create(&def, &mesh, NULL), PEL_OK);
    for (int level = 1; level <= 4; level++) {
        mesh = split_sphere(mesh);
        if (level >= 3)
            assert_near(rest_energy_of(mesh), 25.51, 0.01);
    }
    pel_mesh_destroy(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_isometric_identities), cmocka_unit_test(test_gradients),
        cmocka_unit_test(test_invariance_and_rest),  cmocka_unit_test(test_hinge),
        cmocka_unit_test(test_degenerate),           cmocka_unit_test(test_sphere),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
