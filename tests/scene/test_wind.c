/* Air: terminal velocity, a taut strip along the wind, drag and lift of plates, energies, snapshots, bad input. */
#include "failing_malloc.h"
#include "scene_run.h"

#include <math.h>
#include <stdlib.h>

/* ---- a sheet that falls ---- */

#define SHEET(solver, more)                                                                                            \
    "version: 1\ngravity: [0, 0, -9.81]\nbodies:\n  - name: sheet\n    mesh: { shape: grid, nx: 4, ny: 4, size_x: 1, " \
    "size_y: 1 }\n    membrane: { young: 1e6, thickness: 1e-4 }\n    mass: { density: 1000 }\n" more                   \
    "duration: 1\nsolver: { " solver " }\n"
#define AIR "wind: { density: 1.2, drag: 1.5, lift: 0.7 }\n"

static double terminal_speed(void)
{
    return sqrt(2 * 0.1 * 9.81 / (1.2 * 1.5));
}

static void fall(const char *text, int steps, double balance, double *height, double *speed)
{
    run r;
    double x[25][3], v[25][3];
    check_begin(&r, text);
    for (int s = 0; s < steps; s++)
        assert_int_equal(pel_sim_step(r.sim, NULL), PEL_OK);
    pel_sim_get_positions(r.sim, 0, x[0]);
    pel_sim_get_velocities(r.sim, 0, v[0]);
    pel_sim_ledger ledger;
    pel_sim_get_ledger(r.sim, &ledger);
    assert_near(ledger.work_gravity + ledger.work_loads, ledger.kinetic, balance * ledger.work_gravity);
    assert_true(ledger.work_loads < 0);
    *height = x[12][2];
    *speed = v[12][2];
    end(&r);
}

/* v = v_t tanh(g t / v_t), way v_t^2 / g ln cosh(g t / v_t): the terminal speed to 1e-5 under all methods, the way
   within 1 % of steps of 10 ms; the sheet stays flat */
static void test_terminal(void **unused)
{
    (void)unused;
    static const struct {
        const char *text;
        double dt, balance; /* s; of the energies after .15 s: free fall in steps of dt gains dt / (2 t) too much */
    } runs[] = {
        {SHEET("method: xpbd, dt: 0.01, substeps: 20", AIR), 0.01, 0.005},
        {SHEET("method: pbd, dt: 0.01", AIR), 0.01, 0.08},
        {SHEET("method: pbd-distance, dt: 0.01", AIR), 0.01, 0.08},
        {SHEET("method: implicit, dt: 0.01", AIR), 0.01, 0.02},
        {SHEET("method: explicit, dt: 0.0001", AIR), 0.0001, 0.005},
        {SHEET("method: xpbd, dt: 0.01, substeps: 20, second_order: true", AIR), 0.01, 0.005},
    };
    double terminal = terminal_speed();
    for (size_t i = 0; i < sizeof runs / sizeof *runs; i++)
        for (int k = 0; k < 2; k++) {
            double time = k == 0 ? 0.15 : 1.5, height, speed;
            fall(runs[i].text, (int)(time / runs[i].dt + 0.5), runs[i].balance, &height, &speed);
            double way = terminal * terminal / 9.81 * log(cosh(9.81 * time / terminal));
            assert_near(-height, way, 0.01 * way + 0.5 * 9.81 * time * (k == 0 ? runs[i].dt : 0));
            assert_near(-speed, terminal * tanh(9.81 * time / terminal), k == 0 ? 0.02 * terminal : 1e-5);
        }
}

/* ---- a stiff page ---- */

/* A page that the wind throws over and that its clamp stops: what the wind does is what the page has. */
static void test_page(void **unused)
{
    (void)unused;
    run r;
    pel_sim_ledger ledger;
    check_begin(&r,
                "version: 1\ngravity: [0, 0, -9.81]\nwind: { velocity: [-6, 0, 3] }\nduration: 1\nbodies: [ { name: "
                "page, mesh: { shape: grid, nx: 10, ny: 10, size_x: 0.2, size_y: 0.2 }, membrane: { young: 1e7, "
                "thickness: 1e-4 }, bending: { stiffness: 1e-4 }, mass: { density: 800 }, pinned: { box: { min: [-1, "
                "-1, -1], max: [-0.079, 1, 1] } } } ]\nsolver: { method: implicit, dt: 0.0005 }\n");
    for (int s = 0; s < 600; s++)
        assert_int_equal(pel_sim_step(r.sim, NULL), PEL_OK);
    pel_sim_get_ledger(r.sim, &ledger);
    assert_true(ledger.supplied > 0.03);
    assert_near((ledger.energy_error + ledger.dissipated_solver) / ledger.supplied, 0, 0.01);
    end(&r);
}

/* ---- a taut strip ---- */

#define STRIP(solver)                                                                                                  \
    "version: 1\nbodies:\n  - name: strip\n    mesh: { shape: grid, nx: 24, ny: 2, size_x: 1, size_y: 0.1 }\n"         \
    "    membrane: { material: stvk, young: 5e6, poisson: 0, thickness: 1e-4 }\n    mass: { density: 1000 }\n"         \
    "    bending: { model: none }\n    pinned: { vertices: [0, 24, 25, 49, 50, 74] }\n"                                \
    "wind: { velocity: [10, 0, 0], drag: 0.3, lift: 0.3 }\nduration: 1\nsolver: { " solver " }\n"

/* With the tension T, the mass s and the drag b = density lift U / 2 per area, T y'' = s y.. + b (y. + U y') between
   two pins is solved by exp(b U x / (2 T)) sin(pi x / L) exp(-b t / (2 s)) cos(w t). */
static void vibrate(const char *text, double dt)
{
    enum { COUNT = 75 };
    const double stretch = 1.02, length = stretch, pi = acos(-1.0);
    const double tension = 500 * stretch * (stretch * stretch - 1) / 2, mass = 0.1 / stretch,
                 drag = 0.5 * 1.2 * 0.3 * 10;
    const double tilt = drag * 10 / (2 * tension), rate = drag / (2 * mass);
    const double frequency = sqrt(tension / mass * (pi * pi / (length * length) + tilt * tilt) - rate * rate);
    run r;
    double x[COUNT][3], v[COUNT][3] = {{0}}, times[3] = {0}, before = 0, speeds[3] = {0};
    check_begin(&r, text);
    pel_sim_get_positions(r.sim, 0, x[0]);
    for (int i = 0; i < COUNT; i++) {
        double at = (x[i][0] + 0.5) * stretch;
        x[i][0] *= stretch;
        v[i][2] = i % 25 == 0 || i % 25 == 24 ? 0 : 0.01 * exp(tilt * at) * sin(pi * at / length);
    }
    assert_int_equal(pel_sim_set_positions(r.sim, 0, x[0], NULL), PEL_OK);
    assert_int_equal(pel_sim_set_velocities(r.sim, 0, v[0], NULL), PEL_OK);
    int found = 0;
    for (int s = 1; found < 3 && s < 2 / dt; s++) {
        assert_int_equal(pel_sim_step(r.sim, NULL), PEL_OK);
        pel_sim_get_positions(r.sim, 0, x[0]);
        double now = x[37][2];
        if (before * now < 0) {
            times[found] = dt * (s - now / (now - before));
            speeds[found++] = fabs(now - before) / dt;
        }
        before = now;
    }
    end(&r);
    assert_int_equal(found, 3);
    assert_near(2 * pi / (times[2] - times[0]), frequency, 0.02 * frequency);
    assert_near(log(speeds[0] / speeds[2]) / (times[2] - times[0]), rate, 0.02 * rate);
}

static void test_strip(void **unused)
{
    (void)unused;
    vibrate(STRIP("method: implicit, dt: 0.001"), 0.001);
    vibrate(STRIP("method: explicit, dt: 0.0002"), 0.0002);
    vibrate(STRIP("method: xpbd, dt: 0.002, substeps: 40, iterations: 4"), 0.002);
}

/* ---- plates ---- */

/* N, of the air on a body at rest */
static void force_on(const char *text, double sum[3])
{
    run r;
    check_begin(&r, text);
    int32_t count = pel_sim_vertex_count(r.sim, 0);
    double *forces = calloc(3 * (size_t)count, sizeof *forces);
    pel_sim_get_forces(r.sim, 0, forces);
    for (int k = 0; k < 3; k++) {
        sum[k] = 0;
        for (int32_t v = 0; v < count; v++)
            sum[k] += forces[3 * v + k];
    }
    free(forces);
    end(&r);
}

#define PLATE(mesh, velocity)                                                                                          \
    "version: 1\nbodies:\n  - name: plate\n    mesh: { " mesh " }\n    membrane: { young: 1e9, thickness: 1e-3 }\n"    \
    "wind: { velocity: [" velocity "], density: 1.3, drag: 1.1, lift: 0.8 }\nduration: 1\nsolver: { method: xpbd }\n"
#define GRID "shape: grid, nx: 5, ny: 3, size_x: 0.8, size_y: 0.5"

/* an inclined plate, from both sides */
static void test_plates(void **unused)
{
    (void)unused;
    const double half = 0.5 * 1.3 * 0.4 * 25, c = 0.6, s = 0.8; /* cosine to the normal, and sine */
    double force[3];
    force_on(PLATE(GRID, "4, 0, 3"), force);
    /* drag along (s, 0, c), lift along the normal less its part along the wind */
    double drag = half * 1.1 * c * c, lift = half * 0.8 * c;
    assert_near(force[0], drag * s - lift * c * s, 1e-5);
    assert_near(force[1], 0, 1e-5);
    assert_near(force[2], drag * c + lift * (1 - c * c), 1e-5);
    force_on(PLATE(GRID, "4, 0, -3"), force);
    assert_near(force[0], drag * s - lift * c * s, 1e-5);
    assert_near(force[2], -drag * c - lift * (1 - c * c), 1e-5);
    force_on(PLATE(GRID, "5, 0, 0"), force);
    assert_near(force[0], 0, 1e-5);
    assert_near(force[2], 0, 1e-5);
    /* a ball has the force of the half that faces the wind: drag times density U^2 pi R^2 / 3, whatever its lift */
    force_on(PLATE("shape: geodesic-sphere, frequency: 16, radius: 0.5", "5, 0, 0"), force);
    double ball = 1.1 * 1.3 * 25 * acos(-1.0) * 0.25 / 3;
    assert_near(force[0], ball, 0.01 * ball);
    assert_near(force[2], 0, 0.01 * ball);
}

/* the wind follows its keys: none at the start */
/* A sheet that flutters in a strong wind, under explicit: its vibrations down to the mesh take as many steps as are
   stable, and the work of the wind is that on the velocities between two steps (the balance was off by 7 times the
   supplied energy). */
static void test_flutter(void **unused)
{
    (void)unused;
    run r;
    check_begin(&r, "version: 1\ngravity: [0, 0, -9.81]\nbodies:\n  - name: flag\n    mesh: { shape: grid, nx: 12, ny: "
                    "8, size_x: 0.9, size_y: 0.6, rotate: { axis: [1, 0, 0], angle: 90 } }\n"
                    "    membrane: { young: 1e6, thickness: 2e-4 }\n    mass: { density: 500 }\n"
                    "    pinned: { box: { min: [-1, -1, -1], max: [-0.449, 1, 1] } }\n"
                    "wind: { velocity: [12, 1, 0] }\nsolver: { method: explicit }\nduration: 1\n");
    pel_sim_ledger ledger;
    while (pel_sim_time(r.sim) < 1)
        assert_int_equal(pel_sim_step(r.sim, NULL), PEL_OK);
    pel_sim_get_ledger(r.sim, &ledger);
    assert_true(ledger.supplied > 0.2);
    double gained = ledger.elastic - ledger.elastic_start + ledger.kinetic - ledger.kinetic_start;
    assert_near(gained, ledger.work_loads + ledger.work_gravity, 0.2 * ledger.supplied);
    end(&r);
}

static void test_keys(void **unused)
{
    (void)unused;
    run r;
    double v[25][3], before[2] = {0};
    check_begin(&r,
                SHEET("method: implicit, dt: 0.01", "wind: { velocity: [0, 0, 3], keys: [[0.1, 0], [0.2, 1]] }\n") "");
    for (int s = 1; s <= 30; s++) {
        assert_int_equal(pel_sim_step(r.sim, NULL), PEL_OK);
        pel_sim_get_velocities(r.sim, 0, v[0]);
        if (s == 10 || s == 30)
            before[s == 30] = v[12][2];
    }
    assert_true(before[0] < -0.6);
    assert_true(before[1] > 0.5);
    end(&r);
}

/* a sheet that lies still for two seconds does not sleep through the wind that lifts it */
static void test_wakes(void **unused)
{
    (void)unused;
    run r;
    double x[25][3], lowest[2] = {0};
    check_begin(&r, SHEET("method: xpbd, dt: 0.02", "wind: { velocity: [0, 0, 6], keys: [[2, 0], [2.1, 1]] }\n"
                                                    "contact: {}\ntools:\n  - { name: table, shape: box, size: [2, 2, "
                                                    "0.1], motion: [{ position: [0, 0, -0.051] }] }\n"));
    for (int s = 1; s <= 130; s++) {
        assert_int_equal(pel_sim_step(r.sim, NULL), PEL_OK);
        pel_sim_get_positions(r.sim, 0, x[0]);
        if (s == 100 || s == 130)
            lowest[s == 130] = x[12][2];
    }
    assert_true(lowest[0] < 0.001);
    assert_true(lowest[1] > 0.5);
    end(&r);
}

/* ---- snapshots ---- */

#define FLAG                                                                                                           \
    "version: 1\ngravity: [0, 0, -9.81]\nbodies:\n  - name: flag\n    mesh: { shape: grid, nx: 8, ny: 6, size_x: "     \
    "0.4, size_y: 0.3 }\n    membrane: { young: 1e5, thickness: 2e-4 }\n    pinned: { box: { min: [-1, -1, -1], max: " \
    "[-0.19, 1, 1] } }\nwind: { velocity: [4, 1, 2], gusts: { speed: 1, length: 0.3, seed: 3 } }\ncontact: {}\n"       \
    "duration: 1\nsolver: { method: %s, dt: 0.005 }\n"

static void test_snapshot(void **unused)
{
    (void)unused;
    static const char *const methods[] = {"xpbd", "implicit", "pbd"};
    for (int i = 0; i < 3; i++) {
        run r;
        char text[900];
        snprintf(text, sizeof text, FLAG, methods[i]);
        check_begin(&r, text);
        for (int s = 0; s < 20; s++)
            assert_int_equal(pel_sim_step(r.sim, NULL), PEL_OK);
        size_t size = pel_sim_save_size(r.sim);
        void *kept = malloc(size);
        pel_sim_save(r.sim, kept);
        for (int s = 0; s < 10; s++)
            assert_int_equal(pel_sim_step(r.sim, NULL), PEL_OK);
        uint64_t hash = pel_sim_hash(r.sim);
        assert_int_equal(pel_sim_load(r.sim, kept, size, NULL), PEL_OK);
        for (int s = 0; s < 10; s++)
            assert_int_equal(pel_sim_step(r.sim, NULL), PEL_OK);
        assert_true(pel_sim_hash(r.sim) == hash);
        free(kept);
        end(&r);
    }
}

/* ---- bad input ---- */

static void test_refused(void **unused)
{
    (void)unused;
    static const refusal cases[] = {
        {SHEET("method: static", "wind: {}\n"), "wind acts by velocities"},
        {SHEET("method: descent", "wind: {}\n"), "use method implicit or xpbd"},
        {SHEET("method: xpbd", "wind: { density: -1 }\n"), "wind.density"},
        {SHEET("method: xpbd", "wind: { drag: -1 }\n"), "wind.drag"},
        {SHEET("method: xpbd", "wind: { velocity: [1, 2] }\n"), "wind.velocity"},
        {SHEET("method: xpbd", "wind: { gusts: { speed: 1 } }\n"), "length"},
        {SHEET("method: xpbd", "wind: { gusts: { speed: 1, length: 0 } }\n"), "length"},
        {SHEET("method: xpbd", "wind: { keys: [[1, 0], [0, 1]] }\n"), "do not increase"},
        {SHEET("method: xpbd", "wind: { speed: 1 }\n"), "speed"},
    };
    check_refusals(cases, sizeof cases / sizeof *cases);
}

/* numbers that a scene cannot have */
static void test_defs(void **unused)
{
    (void)unused;
    run r;
    pel_error error;
    pel_sim *sim;
    const pel_key late[2] = {{1, 0}, {1, 1}};
    check_begin(&r, SHEET("method: xpbd", AIR));
    const pel_wind_def good = r.scene->sim.wind;
    pel_wind_def bad[] = {good, good, good, good, good, good, good};
    bad[0].density = (double)NAN;
    bad[1].velocity[1] = (double)INFINITY;
    bad[2].lift = -0.1;
    bad[3].gusts = (pel_gust_def){.speed = 1, .length = 0};
    bad[4].key_count = 1;
    bad[5].keys = late;
    bad[5].key_count = 2;
    bad[6].drag = (double)INFINITY;
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        pel_sim_def def = r.scene->sim;
        def.wind = bad[i];
        assert_int_equal(pel_sim_create(&def, &sim, &error), PEL_BAD_ARGUMENT);
    }
    end(&r);
}

static pel_status make(const void *def, pel_error *error)
{
    pel_sim *sim = NULL;
    pel_status status = pel_sim_create(def, &sim, error);
    if (status == PEL_OK)
        status = pel_sim_step(sim, error);
    pel_sim_destroy(sim);
    return status;
}

static void test_out_of_memory(void **unused)
{
    (void)unused;
    run r;
    char text[900];
    snprintf(text, sizeof text, FLAG, "pbd");
    check_begin(&r, text);
    assert_true(for_allocation_failures(make, &r.scene->sim, 1) > 10);
    end(&r);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_terminal), cmocka_unit_test(test_page),          cmocka_unit_test(test_strip),
        cmocka_unit_test(test_plates),   cmocka_unit_test(test_flutter),       cmocka_unit_test(test_keys),
        cmocka_unit_test(test_wakes),    cmocka_unit_test(test_snapshot),      cmocka_unit_test(test_refused),
        cmocka_unit_test(test_defs),     cmocka_unit_test(test_out_of_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
