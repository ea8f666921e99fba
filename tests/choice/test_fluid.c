/* Liquids in bodies: thrusts on walls and floors, weights on supports, the potential of a filling, free fall. */
#include "scene/scene_run.h"

#include <stdlib.h>

#include "boundary/fluid.h"
#include "newton/newton.h"

/* ---- walls ---- */

/* The thrust on a wall is rho g b H^2 / 2 at a third of the height H of the water, wherever the water cuts triangles;
   that on a floor the weight of the water above it. */
static void test_walls(void **unused)
{
    (void)unused;
    static const double levels[] = {0, 0.01, 0.2, 0.37, 0.6, 1.1};
    for (int i = 0; i < 6; i++)
        for (int is_floor = 0; is_floor < 2; is_floor++) {
            run r;
            char text[1000];
            pel_support_reading reading;
            snprintf(
                text, sizeof text,
                "version: 1\ngravity: [0, 0, -10]\nbodies:\n  - name: wall\n    mesh: { shape: grid, nx: 5, ny: 7, "
                "size_x: 0.4, size_y: 0.6, rotate: { axis: [1, 0, 0], angle: %d }, translate: [0, 0, %g] }\n"
                "    membrane: { young: 1e9, poisson: 0.3, thickness: 0.001 }\n    mass: { density: 1e-6 }\n"
                "    fluid: { density: 1000, level: %g }\n    supports: [ { at: all } ]\n"
                "solver: { method: static }\n",
                is_floor ? 0 : 90, is_floor ? 0.1 : 0.3, levels[i]);
            check_begin(&r, text);
            assert_int_equal(pel_sim_step(r.sim, NULL), PEL_OK);
            pel_sim_get_support_part(r.sim, 0, &reading);
            double wet = levels[i] < 0.6 ? levels[i] : 0.6, depth = fmax(levels[i] - 0.1, 0);
            double thrust = 1000 * 10 * 0.4 * wet * (levels[i] - 0.5 * wet);
            double moment = 1000 * 10 * 0.4 * wet * wet * (levels[i] / 2 - wet / 3);
            if (is_floor) {
                assert_near(reading.force[2], 1000 * 10 * depth * 0.24, 1e-7);
            } else {
                assert_near(reading.force[1], -thrust, 1e-9 * (1 + thrust));
                assert_near(reading.torque[0], moment, 1e-9 * (1 + moment));
            }
            end(&r);
        }
}

/* ---- a filled bag ---- */

#define BAG(solver, more)                                                                                              \
    "version: 1\ngravity: [0, 0, -9.81]\nbodies:\n  - name: bag\n    mesh: { shape: geodesic-sphere, frequency: 3, "   \
    "radius: 0.05 }\n    membrane: { young: 2e5, poisson: 0.45, thickness: 0.004 }\n    mass: { density: 1000 }\n"     \
    "    fluid: { density: 1200 }\n" more "duration: 1\nsolver: { " solver " }\n"
#define NAIL "    pinned: { box: { min: [-1, -1, 0.04], max: [1, 1, 1] } }\n"

static double mass_of(const run *r, double *filling)
{
    double mass = 0;
    const pel_body *body = &r->model->bodies[0];
    for (int32_t v = body->slice_begin * PEL_WIDTH; v < body->slice_end * PEL_WIDTH; v++)
        mass += (double)r->model->mass[v];
    *filling = 1200 * body->rest_volume;
    return mass;
}

/* a hanging bag weighs what is in it, and its volume stays; the same shape under all methods */
static void test_hanging(void **unused)
{
    (void)unused;
    static const char *const scenes[] = {BAG("method: static", NAIL),
                                         BAG("method: implicit, drag: 20, dt: 0.005", NAIL),
                                         BAG("method: xpbd, drag: 20, dt: 0.005, substeps: 40", NAIL)};
    static const int steps[] = {1, 200, 200};
    double lowest[3];
    for (int i = 0; i < 3; i++) {
        run r;
        pel_support_reading reading;
        double filling, x[200][3];
        check_begin(&r, scenes[i]);
        assert_non_null(strstr(r.told.text, "fluid of 'bag': its volume is kept"));
        double mass = mass_of(&r, &filling);
        assert_true(filling > 0.5);
        assert_near(mass - filling, 1000 * 0.004 * r.model->bodies[0].rest_area, 1e-9);
        for (int s = 0; s < steps[i]; s++)
            assert_int_equal(pel_sim_step(r.sim, NULL), PEL_OK);
        pel_sim_get_support(r.sim, 0, &reading);
        assert_near(reading.force[2], -9.81 * mass, 1e-3 * 9.81 * mass);
        assert_near(pel_sim_volume_ratio(r.sim), 1, 2e-3);
        assert_true(pel_sim_vertex_count(r.sim, 0) <= 200);
        pel_sim_get_positions(r.sim, 0, &x[0][0]);
        lowest[i] = 0;
        for (int32_t v = 0; v < pel_sim_vertex_count(r.sim, 0); v++)
            lowest[i] = fmin(lowest[i], x[v][2]);
        end(&r);
    }
    assert_true(lowest[0] < -0.051);
    assert_near(lowest[1], lowest[0], 5e-5);
    assert_near(lowest[2], lowest[0], 3e-4);
}

#define BARE(mesh, more, rest)                                                                                         \
    "version: 1\nbodies:\n  - name: organ\n    mesh: { " mesh " }\n" more "duration: 1\n" rest
#define BALL "shape: geodesic-sphere, frequency: 3, radius: 0.05"
#define FALLING "gravity: [0, 0, -9.81]\n"
#define TABLE                                                                                                          \
    "tools:\n  - { name: table, shape: box, size: [1, 1, 0.1], motion: [{ position: [0, 0, -0.101] }] }\ncontact: "    \
    "{}\n"

/* A mesh alone is tissue that lies on a table without collapsing, and the scene that is written says of what. What
   gives a material, is held, has no gravity or no volume stays as it was. */
static void test_bare(void **unused)
{
    (void)unused;
    run r;
    check_begin(&r, BARE(BALL, "", FALLING TABLE));
    assert_non_null(strstr(r.told.text, "body 'organ': no material is given"));
    assert_non_null(strstr(pel_scene_text(r.scene), "bulk: 1.0e5"));
    for (int s = 0; s < 40; s++)
        assert_int_equal(pel_sim_step(r.sim, NULL), PEL_OK);
    assert_near(pel_sim_volume_ratio(r.sim), 1, 0.03);
    end(&r);
    static const char *const others[] = {
        BARE(BALL, "", ""),
        BARE(BALL, "    springs: { young: 5000 }\n", FALLING),
        BARE(BALL, "    pinned: { box: { min: [-1, -1, 0.04], max: [1, 1, 1] } }\n", FALLING),
        BARE("shape: grid, nx: 3, ny: 3", "", FALLING),
        BARE(BALL, "", FALLING "solver: { method: quasi-static }\n"),
    };
    for (size_t i = 0; i < sizeof others / sizeof *others; i++) {
        check_begin(&r, others[i]);
        assert_null(strstr(r.told.text, "no material is given"));
        assert_null(strstr(pel_scene_text(r.scene), "bulk:"));
        assert_int_equal(r.scene->model.bodies[0].shell.pressure.kind, PEL_PRESSURE_NONE);
        end(&r);
    }
}

/* the forces of a filling are those of its potential, sum to zero, and turn the body as its weight at its centre does
 */
static void test_potential(void **unused)
{
    (void)unused;
    run r;
    enum { MOST = 600 };
    double x[MOST], gradient[MOST] = {0}, other[MOST], sum[3] = {0, 0, 0};
    check_begin(&r, BAG("method: implicit", ""));
    int32_t count = 3 * r.model->vertex_count;
    assert_true(count <= MOST);
    for (int32_t u = 0; u < count; u++)
        x[u] = (double)r.model->rest[u / 3][u % 3] + 0.004 * sin(7 * u + 0.3 * u * u);
    /* padding repeats a vertex */
    pel_fluids_evaluate(r.sim, x, gradient);
    for (int32_t u = 0; u < count; u++) {
        double kept = x[u], step = 1e-6, energy[2];
        for (int side = 0; side < 2; side++) {
            memset(other, 0, sizeof other);
            x[u] = kept + (side ? step : -step);
            energy[side] = pel_fluids_evaluate(r.sim, x, other);
        }
        x[u] = kept;
        assert_near((energy[1] - energy[0]) / (2 * step), gradient[u], 2e-8);
        sum[u % 3] += gradient[u];
    }
    for (int k = 0; k < 3; k++)
        assert_near(sum[k], 0, 1e-12);
    end(&r);
}

/* thrown, it falls as any body does, and the ledger balances */
static void test_fall(void **unused)
{
    (void)unused;
    static const char *const methods[] = {BAG("method: implicit, dt: 0.002", "    velocity: [1, 0, 0]\n"),
                                          BAG("method: xpbd, dt: 0.002", "    velocity: [1, 0, 0]\n"),
                                          BAG("method: explicit, dt: 2e-5", "    bending: { model: hinge }\n")};
    for (int i = 0; i < 3; i++) {
        run r;
        double filling, x[200][3], masses[200], height = 0, time = i == 2 ? 0.02 : 0.1;
        pel_sim_ledger ledger;
        check_begin(&r, methods[i]);
        double mass = mass_of(&r, &filling);
        for (int s = 0; s < (int)(time / r.scene->sim.solver.dt + 0.5); s++)
            assert_int_equal(pel_sim_step(r.sim, NULL), PEL_OK);
        pel_sim_get_positions(r.sim, 0, &x[0][0]);
        pel_sim_get_masses(r.sim, 0, masses);
        for (int32_t v = 0; v < pel_sim_vertex_count(r.sim, 0); v++)
            height += masses[v] * x[v][2] / mass;
        assert_near(height, -0.5 * 9.81 * time * time, 0.05 * 0.5 * 9.81 * time * time);
        pel_sim_get_ledger(r.sim, &ledger);
        assert_near(ledger.work_gravity, -9.81 * mass * height, 1e-6);
        assert_true(ledger.energy_error <= 0.002 * ledger.supplied);
        end(&r);
    }
}

/* leapfrog balances the work of the liquid with the energies */
static void test_ledger(void **unused)
{
    (void)unused;
    run r;
    pel_sim_ledger ledger;
    check_begin(&r, BAG("method: explicit, dt: 2e-5", NAIL "    bending: { model: hinge }\n"));
    for (int s = 0; s < 2500; s++)
        assert_int_equal(pel_sim_step(r.sim, NULL), PEL_OK);
    pel_sim_get_ledger(r.sim, &ledger);
    assert_true(ledger.work_loads > 0.01 * ledger.supplied);
    assert_true(ledger.energy_error + ledger.dissipated_solver <= 1e-4 * ledger.supplied);
    end(&r);
}

/* the matrix has the symmetric part of the slopes of the forces under a level, and the bag converges with it */
static void test_slopes(void **unused)
{
    (void)unused;
    run r;
    enum { MOST = 200 };
    double x[MOST], jacobian[MOST][MOST], gradient[2][MOST];
    pel_matrix *matrix;
    check_begin(&r,
                "version: 1\ngravity: [0, 1, -10]\nbodies:\n  - name: floor\n    mesh: { shape: grid, nx: 3, ny: 3, "
                "size_x: 0.4, size_y: 0.4 }\n    membrane: { young: 1e5, poisson: 0.3, thickness: 0.001 }\n    mass: { "
                "density: 1000 }\n    fluid: { density: 1000, level: 0.5 }\n    pinned: boundary\nsolver: { method: "
                "static }\n");
    int32_t count = 3 * r.model->vertex_count;
    assert_true(count <= MOST);
    for (int32_t u = 0; u < count; u++)
        x[u] = (double)r.model->rest[u / 3][u % 3] + 0.03 * sin(7 * u + 0.3 * u * u);
    for (int32_t u = 0; u < count; u++) {
        double kept = x[u], step = 1e-5;
        for (int side = 0; side < 2; side++) {
            memset(gradient[side], 0, sizeof gradient[side]);
            x[u] = kept + (side ? step : -step);
            pel_fluids_evaluate(r.sim, x, gradient[side]);
        }
        x[u] = kept;
        for (int32_t i = 0; i < count; i++)
            jacobian[i][u] = (gradient[1][i] - gradient[0][i]) / (2 * step);
    }
    assert_int_equal(pel_newton_create_matrix(r.sim->newton, &matrix, NULL), PEL_OK);
    memset(matrix->values, 0, (size_t)matrix->block_start[matrix->block_count] * sizeof *matrix->values);
    pel_fluids_add_matrix(r.sim, x, matrix);
    for (int32_t t = 0; t < r.model->triangle_count; t++)
        for (int a = 0; a < 9; a++)
            for (int b = 0; b < 9; b++) {
                int32_t v = r.model->triangles[t][a / 3], w = r.model->triangles[t][b / 3];
                double entry =
                    matrix->values[matrix->block_start[pel_matrix_block(matrix, v, w)] + a % 3 + 3 * (b % 3)];
                int32_t i = 3 * v + a % 3, j = 3 * w + b % 3;
                assert_near(entry, 0.5 * (jacobian[i][j] + jacobian[j][i]), 1e-6);
            }
    pel_matrix_destroy(matrix);
    end(&r);
}

static void test_iterations(void **unused)
{
    (void)unused;
    run r;
    pel_solver_reading reading;
    check_begin(&r, BAG("method: static", NAIL));
    assert_int_equal(pel_sim_step(r.sim, NULL), PEL_OK);
    pel_sim_get_solver(r.sim, &reading);
    assert_true(reading.converged && reading.iterations <= 20);
    end(&r);
}

static void test_refusals(void **unused)
{
    (void)unused;
    static const refusal cases[] = {
        {"version: 1\nbodies:\n  - mesh: { shape: grid, nx: 2, ny: 2, size_x: 1, size_y: 1 }\n    membrane: { preset: "
         "rubber }\n    fluid: {}\nduration: 1\n",
         "a liquid cannot fill an open body. give fluid.level"},
        {BAG("method: descent", NAIL), "does not support `fluid`"},
        {BAG("method: quasi-static", NAIL), "does not support `fluid`"},
        {BAG("method: static, path: arc-length", NAIL), "does not support `fluid`"},
        {BAG("method: static, analysis: buckling", NAIL), "does not support `fluid`"},
    };
    check_refusals(cases, sizeof cases / sizeof *cases);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_walls),     cmocka_unit_test(test_hanging),    cmocka_unit_test(test_bare),
        cmocka_unit_test(test_potential), cmocka_unit_test(test_fall),       cmocka_unit_test(test_ledger),
        cmocka_unit_test(test_slopes),    cmocka_unit_test(test_iterations), cmocka_unit_test(test_refusals)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
