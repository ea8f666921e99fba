/* Damping of materials: decay against exp(-z w t) with z = retardation w / 2, rigid motion, the ledger, loss factors.
 */
#include "scene/scene_run.h"

#include <stdlib.h>

#define TWO_PI 6.283185307179586

static double energy_of(pel_sim *sim)
{
    pel_sim_ledger ledger;
    pel_sim_get_ledger(sim, &ledger);
    return ledger.elastic + ledger.kinetic;
}

/* 1/s: rate of the logarithm of the energy over whole steps from one time to another, by least squares */
static double decay_of(run *r, double from, double to)
{
    double dt = r->scene->sim.solver.dt, n = 0, t = 0, e = 0, tt = 0, te = 0;
    for (int i = 1; i * dt <= to + 1e-9; i++) {
        assert_int_equal(pel_sim_step(r->sim, NULL), PEL_OK);
        if (i * dt < from)
            continue;
        double value = log(energy_of(r->sim));
        n += 1;
        t += i * dt;
        e += value;
        tt += i * dt * i * dt;
        te += i * dt * value;
    }
    return -(n * te - t * e) / (n * tt - t * t);
}

/* ---- decay ---- */

#define RULER                                                                                                          \
    "version: 1\nbodies:\n  - name: ruler\n"                                                                           \
    "    mesh: { shape: grid, nx: 16, ny: 3, size_x: 0.2, size_y: 0.02 }\n    membrane: { preset: steel-sheet }\n"     \
    "    supports: [ { at: { box: { min: [-0.1001, -1, -1], max: [-0.0999, 1, 1] } }, rotation: fixed } ]\n"
#define THUMB                                                                                                          \
    "loads: [ { force: [0, 0, -0.02], until: 0.1, at: { box: { min: [0.0999, -1, -1], max: [0.1001, 1, 1] } } } ]\n"

/* a ruler that a thumb lets go decays by its loss factor, for each step that resolves it */
static void test_ruler(void **unused)
{
    (void)unused;
    static const char *const steps[] = {"", "solver: { dt: 0.004 }\n"};
    for (int i = 0; i < 2; i++) {
        char text[1000];
        run r;
        double frequency;
        snprintf(text, sizeof text, "%s    bending: { damping: { loss_factor: 0.1 } }\n%s%sduration: 0.6\n", RULER,
                 THUMB, steps[i]);
        check_begin(&r, text);
        assert_int_equal(pel_scene_frequency(r.scene, 0, &frequency), PEL_OK);
        assert_near(frequency, 10.44, 0.1);
        assert_non_null(strstr(r.told.text, "loss factor 0.1 of the bending of 'ruler' at its lowest frequency, 10.4"));
        assert_null(strstr(r.told.text, "tension"));
        assert_near(r.scene->model.bodies[0].shell.bending.retardation, 0.1 / (TWO_PI * frequency), 1e-12);
        /* the energy decays by twice z w, with z = 0.05 */
        double expected = 0.1 * TWO_PI * frequency;
        assert_near(decay_of(&r, 0.15, 0.15 + 4 / frequency), expected, 0.02 * expected);
        end(&r);
    }
}

/* hinges of a strip under both methods */
static void test_hinges(void **unused)
{
    (void)unused;
    static const char *const methods[] = {"implicit", "xpbd, substeps: 500"};
    for (int m = 0; m < 2; m++) {
        char text[1000];
        run r;
        double frequency;
        snprintf(
            text, sizeof text,
            "version: 1\nbodies:\n  - name: strip\n    mesh: { shape: grid, nx: 8, ny: 2, size_x: 0.1, size_y: 0.02 "
            "}\n    mass: { density: 1000 }\n    membrane: { young: 1e6, poisson: 0.3, thickness: 0.01 }\n"
            "    bending: { model: hinge, damping: { loss_factor: 0.1 } }\n"
            "    pinned: { box: { min: [-1, -1, -1], max: [-0.037, 1, 1] } }\nloads: [ { force: [0, 0, -0.002], "
            "until: 0.05, at: { box: { min: [0.049, -1, -1], max: [1, 1, 1] } } } ]\n"
            "solver: { method: %s, dt: 0.004 }\nduration: 0.5\n",
            methods[m]);
        check_begin(&r, text);
        assert_int_equal(pel_scene_frequency(r.scene, 0, &frequency), PEL_OK);
        double expected = 0.1 * TWO_PI * frequency, found = decay_of(&r, 0.06, 0.06 + 2 / frequency);
        if (!(fabs(found - expected) <= 0.03 * expected))
            fail_msg("%s: %g for %g 1/s", methods[m], found, expected);
        end(&r);
    }
}

/* A closed ball breathes with w^2 = 2 E / (rho R^2 (1 - nu)), all strain alike; one of springs with the frequency that
   its kinetic energy shows. */
#define BALL(parts, solver)                                                                                            \
    "version: 1\nbodies:\n  - name: ball\n    mesh: { shape: geodesic-sphere, frequency: 3, radius: 0.05 }\n"          \
    "    mass: { density: 1000, thickness: 0.001 }\n" parts                                                            \
    "    pressure: { inside: { keys: [[0, 20], [0.002, 0]] } }\nsolver: { dt: 0.0002, " solver " }\nduration: 0.06\n"
#define SKIN "membrane: { material: stvk, young: 1e6, poisson: 0.3, thickness: 0.001"

static void test_breathing(void **unused)
{
    (void)unused;
    static const char *const scenes[] = {
        BALL("    " SKIN ", damping: { stiffness: 8e-5 } }\n    bending: { model: none }\n", "method: implicit"),
        BALL("    " SKIN ", damping: { stiffness: 8e-5 } }\n    bending: { model: none }\n",
             "method: xpbd, substeps: 24"),
        BALL("    membrane: { material: neo-hookean, young: 1e6, poisson: 0.3, thickness: 0.001, damping: { stiffness: "
             "8e-5 } }\n    bending: { model: none }\n",
             "method: xpbd, substeps: 24"),
        BALL("    membrane: { material: fung, young: 1e6, poisson: 0.3, thickness: 0.001, damping: { stiffness: "
             "8e-5 } }\n    bending: { model: none }\n",
             "method: xpbd, substeps: 24"),
        BALL("    membrane: { material: linear, young: 1e6, poisson: 0.3, thickness: 0.001, damping: { stiffness: "
             "8e-5 } }\n    bending: { model: none }\n",
             "method: xpbd, substeps: 24"),
    };
    for (size_t i = 0; i < sizeof scenes / sizeof *scenes; i++) {
        run r;
        check_begin(&r, scenes[i]);
        double square = 2 * 1e6 / (1000 * 0.05 * 0.05 * (1 - 0.3)), expected = 8e-5 * square;
        double found = decay_of(&r, 0.005, 0.005 + 8 * TWO_PI / sqrt(square));
        if (!(fabs(found - expected) <= 0.02 * expected))
            fail_msg("scene %d: %g for %g 1/s", (int)i, found, expected);
        /* what it has lost is booked */
        pel_sim_ledger ledger;
        pel_sim_get_ledger(r.sim, &ledger);
        assert_true(ledger.dissipated_drag > 0.5 * ledger.supplied);
        assert_near(ledger.dissipated_drag, ledger.supplied, 0.05 * ledger.supplied);
        end(&r);
    }
}

/* springs by the words of membranes; the same damping under both methods */
static void test_springs(void **unused)
{
    (void)unused;
    static const char *const solvers[] = {"method: implicit", "method: xpbd, substeps: 24"};
    double found[2], square = 0;
    for (int i = 0; i < 2; i++) {
        run r;
        char text[1000];
        snprintf(text, sizeof text,
                 BALL("    springs: { young: 1e6, thickness: 0.001, drag: 0, damping: { stiffness: 8e-5 } }\n", "%s"),
                 solvers[i]);
        check_begin(&r, text);
        assert_near(r.scene->model.bodies[0].spring_retardation, 8e-5, 1e-18);
        found[i] = decay_of(&r, 0.005, 0.03);
        end(&r);
    }
    /* a network of springs with the stiffness of a sheet with nu = 1/3 */
    square = 2 * 1e6 / (1000 * 0.05 * 0.05 * (1 - 1.0 / 3));
    assert_near(found[0], 8e-5 * square, 0.2 * 8e-5 * square);
    assert_near(found[1], found[0], 0.03 * found[0]);
}

/* ---- rigid motion ---- */

/* momentum, angular momentum about the origin, and kinetic energy */
typedef struct motion {
    double linear[3], angular[3], kinetic;
} motion;

static motion motion_of(pel_sim *sim)
{
    enum { MOST = 500 };
    double x[MOST][3], u[MOST][3], mass[MOST];
    motion m = {0};
    int32_t count = pel_sim_vertex_count(sim, 0);
    assert_true(count <= MOST);
    pel_sim_get_positions(sim, 0, &x[0][0]);
    pel_sim_get_velocities(sim, 0, &u[0][0]);
    pel_sim_get_masses(sim, 0, mass);
    for (int32_t v = 0; v < count; v++)
        for (int k = 0; k < 3; k++) {
            int i = (k + 1) % 3, j = (k + 2) % 3;
            m.linear[k] += mass[v] * u[v][k];
            m.angular[k] += mass[v] * (x[v][i] * u[v][j] - x[v][j] * u[v][i]);
            m.kinetic += 0.5 * mass[v] * u[v][k] * u[v][k];
        }
    return m;
}

/* A ball that is thrown and spins keeps its momenta under strong damping, which takes from its strains alone. */
static void test_rigid_motion(void **unused)
{
    (void)unused;
    static const char *const methods[] = {"implicit", "xpbd, substeps: 20"};
    for (int m = 0; m < 2; m++) {
        char text[1000];
        run r;
        snprintf(text, sizeof text,
                 "version: 1\ngravity: [0, 0, -10]\nbodies:\n  - name: ball\n    mesh: { shape: geodesic-sphere, "
                 "frequency: 3, radius: 1, scale: [0.05, 0.05, 0.08] }\n    mass: { density: 1000 }\n    " SKIN
                 ", damping: { stiffness: 1e-3 } }\n    bending: { model: hinge, damping: { stiffness: 1e-3 } }\n"
                 "    velocity: [1, 0, 0]\n    angular_velocity: [0, 0, 6]\n"
                 "solver: { method: %s, dt: 0.0002 }\nduration: 0.02\n",
                 methods[m]);
        check_begin(&r, text);
        const motion before = motion_of(r.sim);
        for (int step = 0; step < 100; step++)
            assert_int_equal(pel_sim_step(r.sim, NULL), PEL_OK);
        const motion after = motion_of(r.sim);
        double mass = before.linear[0], fall = mass * 10 * 0.02, spin = 0.5 * before.angular[2] * 6;
        assert_near(after.linear[0], before.linear[0], 1e-9 * mass);
        assert_near(after.linear[2], before.linear[2] - fall, 1e-9 * fall);
        assert_near(after.angular[2], before.angular[2], 2e-6 * before.angular[2]);
        /* the spin keeps its energy but for what stretches the ball */
        assert_near(after.kinetic - 0.5 * fall * fall / mass - 0.5 * mass, spin, 2e-4 * spin);
        end(&r);
    }
}

/* ---- what is refused, and told ---- */

/* tension holds the vibrations of a stretched skin: the run says so, and how to brake them */
static void test_dilution(void **unused)
{
    (void)unused;
    run r;
    check_begin(
        &r,
        "version: 1\nbodies:\n  - name: skin\n    mesh: { shape: grid, nx: 6, ny: 6, size_x: 0.3, size_y: 0.3 }\n"
        "    mass: { density: 1100 }\n    membrane: { young: 1e6, poisson: 0.5, thickness: 0.001, damping: { "
        "loss_factor: 0.05 } }\n    supports:\n"
        "      - { at: { box: { min: [-1, -1, -1], max: [-0.149, 1, 1] } }, fix: [x, z], displacement: [-0.01, 0, "
        "0] }\n"
        "      - { at: { box: { min: [0.149, -1, -1], max: [1, 1, 1] } }, fix: [x, z], displacement: [0.01, 0, 0] }\n"
        "      - { at: { box: { min: [-1, -1, -1], max: [1, -0.149, 1] } }, fix: [y, z] }\n"
        "      - { at: { box: { min: [-1, 0.149, -1], max: [1, 1, 1] } }, fix: [y, z] }\nduration: 1\n");
    assert_non_null(strstr(r.told.text, "the rest is tension"));
    assert_non_null(strstr(r.told.text, "solver.drag"));
    end(&r);
}

/* the choice of the method counts damping as stiffness, also where it was given as a loss factor */
static void test_method(void **unused)
{
    (void)unused;
    static const char *const dampings[] = {"", ", damping: { stiffness: 0.05 }", ", damping: { loss_factor: 1 }"};
    for (int i = 0; i < 3; i++) {
        run r;
        char text[600];
        snprintf(
            text, sizeof text,
            "version: 1\nbodies:\n  - name: ball\n    mesh: { shape: geodesic-sphere, frequency: 4, radius: 0.1 }\n"
            "    membrane: { young: 1e6, thickness: 0.001%s }\n    bending: { model: hinge }\n"
            "    volumetric: { stiffness: 0.001 }\nduration: 1\nsolver: { dt: 0.01 }\n",
            dampings[i]);
        check_begin(&r, text);
        assert_int_equal(r.scene->sim.solver.method, i == 0 ? PEL_METHOD_XPBD : PEL_METHOD_IMPLICIT);
        end(&r);
    }
}

static void test_refusals(void **unused)
{
    (void)unused;
    static const refusal cases[] = {
        {BALL("    " SKIN ", damping: { stiffness: 8e-5 } }\n    bending: { model: hinge }\n", "method: explicit"),
         "damping of the material exists only for the methods implicit and xpbd"},
        {BALL("    " SKIN ", damping: { stiffness: 8e-5 } }\n", "method: pbd"), "exists only for the methods"},
        {BALL("    springs: { young: 1e6, damping: { stiffness: 8e-5 } }\n", "method: pbd-distance"),
         "exists only for the methods"},
        {BALL("    " SKIN " }\n    bending: { model: isometric, damping: { stiffness: 8e-5 } }\n", "method: xpbd"),
         "isometric bending has no angle"},
        {BALL("    " SKIN ", damping: { stiffness: -1 } }\n", "method: xpbd"), "-1"},
        {BALL("    " SKIN ", damping: { loss_factor: 3 } }\n", "method: xpbd"), "3"},
        {BALL("    " SKIN ", damping: { loss_factor: 0.1, stiffness: 1 } }\n", "method: xpbd"), "stiffness"},
    };
    check_refusals(cases, sizeof cases / sizeof *cases);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_ruler),        cmocka_unit_test(test_hinges),
                                       cmocka_unit_test(test_breathing),    cmocka_unit_test(test_springs),
                                       cmocka_unit_test(test_rigid_motion), cmocka_unit_test(test_dilution),
                                       cmocka_unit_test(test_method),       cmocka_unit_test(test_refusals)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
