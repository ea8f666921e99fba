/* Warnings of energy that the method takes, with steps and methods that would do. */
#define _XOPEN_SOURCE 700 /* nftw */
#include "run/warned.h"

/* what nothing damps keeps its energy, or the run says so, with a step that would do */
static void test_unresolved(void **unused)
{
    (void)unused;
    const char *const balloon =
        "version: 1\nbodies:\n"
        "  - name: balloon\n    mesh: { shape: geodesic-sphere, frequency: 4, radius: 0.1 }\n"
        "    membrane: { material: neo-hookean, young: 1.0e6, poisson: 0.5, thickness: 0.001 }\n"
        "    pressure: { inside: 2500 }\nduration: 0.3\n";
    const char *overrides[] = {"solver.drag=20", "solver.dt=0.01"};
    static const struct {
        const char *method;
        bool warns;
    } cases[] = {{"solver.method=xpbd", true}, {"solver.method=implicit", false}};
    pel_run_summary summary;
    for (int i = 0; i < 2; i++) {
        const char *own[] = {cases[i].method, overrides[i == 0 ? 0 : 1]};
        run_scene(balloon, own, 1, NULL, 0, &summary);
        const pel_run_warning *warning = find_warning(&summary, "unresolved-motion");
        assert_true((warning != NULL) == cases[i].warns);
        assert_true(warning == NULL || strstr(warning->text, "solver: { method: explicit, dt: 0.000") != NULL);
        assert_true(warning == NULL || strstr(warning->text, "(implicit with dt: 0.000") != NULL);
        run_scene(balloon, own, 2, NULL, 0, &summary);
        warning = find_warning(&summary, "unresolved-motion");
        assert_true((warning != NULL) == !cases[i].warns);
        assert_true(warning == NULL ||
                    strstr(warning->text, "40 steps in the slowest vibration of body 'balloon'") != NULL);
        /* with the method, for the program may choose another one at another step */
        assert_true(warning == NULL || strstr(warning->text, "use solver: { method: implicit, dt: ") != NULL);
    }
}

/* A heavy ball on which nothing acts, in short steps: velocities are differences of rounded positions. */
static void test_rounding(void **unused)
{
    (void)unused;
    static const char ball[] = "version: 1\nbodies:\n  - name: ball\n    mesh: { shape: geodesic-sphere, frequency: 5, "
                               "radius: 100 }\n    volumetric: {}\nduration: 0.2\n";
    static const char *const steps[] = {"solver.dt=0.005", "solver.dt=0.001", "solver.dt=0.0003"};
    for (size_t i = 0; i < sizeof steps / sizeof *steps; i++) {
        pel_run_summary summary;
        run_scene(ball, &steps[i], 1, NULL, 0, &summary);
        print_message("%s: %.2g J of %.2g\n", steps[i], summary.ledger.energy_error, summary.ledger.tolerance);
        assert_null(find_warning(&summary, "energy-appears"));
        assert_true(summary.ledger.tolerance < 1);
    }
}

/* Bodies that a pressure swings faster than steps show: its work is that of the substeps, whatever the step. */
static void test_work_in_substeps(void **unused)
{
    (void)unused;
#define PULSED(body)                                                                                                   \
    "version: 1\nbodies:\n  - name: body\n    " body "\n    membrane: { young: 1.0e5, thickness: 0.001 }\n    "        \
    "pressure: { inside: { keys: [[0, 0], [0.012, 200], [0.053, 100], [0.07, 0]] } }\nsolver: { method: xpbd }\n"      \
    "duration: 0.12\n"
    static const char *const scenes[] = {PULSED("mesh: { shape: geodesic-sphere, frequency: 4, radius: 0.05 }"),
                                         PULSED("mesh: { shape: disk, radius: 0.05, rings: 5 }\n    pinned: boundary")};
    static const char *const steps[] = {"solver.dt=0.007", "solver.dt=0.01", "solver.dt=0.015", "solver.dt=0.03"};
    for (int k = 0; k < 2; k++) {
        double expected = 0;
        for (size_t i = 0; i < sizeof steps / sizeof *steps; i++) {
            pel_run_summary summary;
            run_scene(scenes[k], &steps[i], 1, NULL, 0, &summary);
            print_message("%s: %.3g J\n", steps[i], summary.ledger.work_pressure);
            expected = i == 0 ? summary.ledger.work_pressure : expected;
            assert_near(summary.ledger.work_pressure / expected, 1, 0.02);
            assert_null(find_warning(&summary, "energy-appears"));
        }
    }
#undef PULSED
}

/* A free sheet that a load on its edges shakes within a step: the load turns with the edges, and so does its work. */
static void test_work_of_followers(void **unused)
{
    (void)unused;
    static const char scene[] =
        "version: 1\nbodies: [{ name: sheet, mesh: { shape: grid, nx: 6, ny: 6, size_x: 0.02, size_y: 0.02 }, "
        "membrane: "
        "{ young: 1e6, poisson: 0.45, thickness: 0.002 }, mass: { density: 1000 } }]\nloads: [{ force: [0, 0, 0.2], "
        "per: "
        "length, follower: true, keys: [[0, 0], [0.002, 1], [0.0041, 0]], at: boundary }]\nduration: 0.12\n";
    static const char *const solvers[] = {"solver={ method: explicit }", "solver={ method: xpbd, dt: 0.01 }",
                                          "solver={ method: xpbd, dt: 0.007 }", "solver={ method: xpbd, dt: 0.003 }"};
    double expected = 0;
    for (size_t i = 0; i < sizeof solvers / sizeof *solvers; i++) {
        pel_run_summary summary;
        run_scene(scene, &solvers[i], 1, NULL, 0, &summary);
        print_message("%s: %.4g J\n", solvers[i], summary.ledger.work_loads);
        expected = i == 0 ? summary.ledger.work_loads : expected;
        assert_near(summary.ledger.work_loads / expected, 1, 0.03);
        assert_null(find_warning(&summary, "energy-appears"));
    }
}

/* A drum, which its rest shape stretches, and a ball that strikes it and goes away: xpbd is of second order
   until it touches and after, and keeps what it swings with. First order takes most of it, which is little of the
   energy of the stretched drum. */
static void test_struck_drum(void **unused)
{
    (void)unused;
    static const char drum[] =
        "version: 1\nbodies:\n  - name: skin\n    mesh: { shape: grid, nx: 12, ny: 12, size_x: 0.3, size_y: 0.3 }\n"
        "    mass: { density: 1100 }\n    membrane: { young: 1.0e6, poisson: 0.5, thickness: 0.001, rest_scale: 0.95 "
        "}\n"
        "    pinned: boundary\ntools:\n  - { name: stick, shape: sphere, radius: 0.02, motion: [ { position: [0, 0, "
        "0.03] }, { time: 0.05, position: [0, 0, 0.015] }, { time: 0.1, position: [0, 0, 0.05] } ] }\n"
        "duration: 1\noutput: { every: 0.005 }\n";
    const char *first[] = {"solver.second_order=false"};
    pel_run_summary summary;
    run_scene(drum, NULL, 0, NULL, 0, &summary);
    assert_null(find_warning(&summary, "unresolved-motion"));
    run_scene(drum, first, 1, NULL, 0, &summary);
    const pel_run_warning *warning = find_warning(&summary, "unresolved-motion");
    assert_non_null(warning);
    double share;
    assert_int_equal(sscanf(strstr(warning->text, "has taken"), "has taken %lf %%", &share), 1);
    assert_true(share > 40 && share <= 100);
    assert_true(summary.ledger.dissipated_solver < 0.05 * summary.ledger.supplied);
}

/* A box stops above a pinned vertex, within the thickness of contact: the gaps beside it close while it stands. The
   work is the mean load times the ways of the surface, once for all tries of a step; the springs harden, so that it is
   more than they store: 1.3 times (3.6 if each try counted). */
static void test_tool_that_stands(void **unused)
{
    (void)unused;
    static const char stopped[] =
        "version: 1\nbodies:\n"
        "  - mesh: { shape: capsule, slices: 5 }\n"
        "    pinned: { box: { min: [-1000, -0.095, -1000], max: [1000, 1000, 1000] } }\n"
        "  - mesh: { shape: grid, nx: 3, ny: 3, diagonals: union-jack, translate: [0, 0, 2.366] }\n"
        "    membrane: { material: mooney-rivlin, young: 172600, thickness: 0.01479, poisson: 0.415 }\n"
        "solver: { dt: 0.001919, method: static }\ntools:\n"
        "  - shape: box\n    size: [1.125, 0.5132, 0.7489]\n    motion: [ { position: [0, 0, 1.42445] }, "
        "{ time: 0.011514, position: [0.0789, 0.073, 1.07945] } ]\n";
    pel_run_summary summary;
    run_scene(stopped, NULL, 0, NULL, 0, &summary);
    const pel_sim_ledger *ledger = &summary.ledger;
    assert_non_null(find_warning(&summary, "tool-held-back"));
    assert_true(ledger->elastic > 0.25);
    assert_true(ledger->energy_error < 1e-6 * ledger->elastic);
    assert_true(ledger->work_tools < 1.5 * ledger->elastic);
}

/* A ball that presses a page of paper on a table, deeper than both leave room for: its forces are not known while it is
   held back, so the balance tells its work (48 J were taken out by forces read), and the run says how much. */
static void test_work_of_what_jams(void **unused)
{
    (void)unused;
    static const char page[] =
        "version: 1\nbodies:\n  - name: page\n    mesh: { shape: grid, nx: 10, ny: 10, size_x: 0.1, size_y: 0.1, "
        "translate: [0, 0, 0.0006] }\n    membrane: { preset: paper }\ngravity: [0, 0, -9.81]\ntools:\n"
        "  - { name: finger, shape: sphere, radius: 0.01, motion: [ { position: [0, 0, 0.014] }, { time: 0.1, "
        "position: "
        "[0, 0, 0.009] }, { time: 0.2, position: [0, 0, 0.014] } ] }\n"
        "  - { name: table, shape: box, size: [0.5, 0.5, 0.1], motion: [ { position: [0, 0, -0.05] } ] }\n"
        "contact: { friction: 0.3 }\nsolver: { dt: 0.005 }\nduration: 0.22\noutput: { every: 0.005 }\n";
    static const char *const methods[] = {"solver.method=implicit", "solver.method=descent"};
    for (int i = 0; i < 2; i++) {
        pel_run_summary summary, resumed;
        const pel_sim_ledger *ledger = &summary.ledger;
        const char *overrides[] = {methods[i], "output.checkpoint=0"};
        run_scene(page, overrides, 1, NULL, 0, &summary);
        print_message("%s: %g J of tools, %g of them estimated, %g of %g appeared\n", methods[i], ledger->work_tools,
                      ledger->work_estimated, ledger->energy_error, ledger->supplied);
        assert_true(summary.max_tool_force > 1e4 && ledger->work_estimated > 0);
        assert_true(ledger->energy_error <= 0.01 * ledger->supplied);
        const bool is_large = ledger->work_estimated > 0.1 * ledger->supplied;
        assert_int_equal(find_warning(&summary, "work-estimated") != NULL, is_large);
        assert_true(i > 0 || (is_large && fabs(ledger->work_tools) < 1e-3));
        run_scene(page, overrides, 2, NULL, 29, &resumed);
        run_scene(page, overrides, 2, "checkpoint", 0, &resumed);
        assert_memory_equal(&resumed.ledger, ledger, sizeof *ledger);
    }
}

/* Two balls that press a sheet between them, and go away again: what they are known to have put into its layers they
   take out again, although they were held back between. */
static void test_work_of_two_balls(void **unused)
{
    (void)unused;
    static const char sheet[] =
        "version: 1\nbodies:\n  - name: sheet\n    mesh: { shape: grid, nx: 20, ny: 20, size_x: 0.2, size_y: 0.2 }\n"
        "    membrane: { preset: rubber }\n    pinned: boundary\ntools:\n"
        "  - { name: up, shape: sphere, radius: 0.02, motion: [ { position: [0, 0, -0.03] }, { time: 0.3, position: "
        "[0, 0, -0.015] }, { time: 0.6, position: [0, 0, -0.04] } ] }\n"
        "  - { name: down, shape: sphere, radius: 0.02, motion: [ { position: [0.003, 0, 0.03] }, { time: 0.3, "
        "position: [0.003, 0, 0.015] }, { time: 0.6, position: [0.003, 0, 0.04] } ] }\n"
        "contact: { friction: 0.3 }\nduration: 0.5\n";
    pel_run_summary summary;
    run_scene(sheet, NULL, 0, NULL, 0, &summary);
    const pel_sim_ledger *ledger = &summary.ledger;
    print_message("%g of %g J lost, %g appeared\n", ledger->dissipated_solver, ledger->supplied, ledger->energy_error);
    assert_non_null(find_warning(&summary, "tool-held-back"));
    assert_true(ledger->energy_error < 0.05 * ledger->supplied);
    assert_true(ledger->dissipated_solver < 0.1 * ledger->supplied);
}

/* A strip that is thrown out of its clamp swings far: gains of energy in many steps, each less than 1 %, do not add up.
 */
static void test_thrown_strip(void **unused)
{
    (void)unused;
    static const char strip[] =
        "version: 1\nbodies:\n  - name: strip\n    mesh: { shape: grid, nx: 40, ny: 4, size_x: 0.2, size_y: 0.02 }\n"
        "    membrane: { young: 1.0e6, poisson: 0, thickness: 0.002 }\n    mass: { density: 1000 }\n"
        "    supports: [ { at: { box: { min: [-1, -1, -1], max: [-0.0999, 1, 1] } }, rotation: fixed } ]\n"
        "    velocity: [0, 0, 0.05]\nsolver: { dt: 0.01 }\nduration: 4\noutput: { every: 0.1 }\n";
    pel_run_summary summary;
    run_scene(strip, NULL, 0, NULL, 0, &summary);
    assert_null(find_warning(&summary, "energy-appears"));
    assert_true(summary.ledger.energy_error < 0.02 * summary.ledger.supplied);
}

/* The force on a ball that a stretched sheet presses against is the same in second order: each substep in which it
   pressed was followed by one in which it did not, and the force read up to 1.9 times too large. */
static void test_pressed_in_second_order(void **unused)
{
    (void)unused;
    static const char drum[] =
        "version: 1\nbodies:\n  - name: skin\n    mesh: { shape: grid, nx: 24, ny: 24, size_x: 1, size_y: 1, "
        "diagonals: "
        "union-jack }\n    mass: { density: 300 }\n    membrane: { material: stvk, young: 1.0e6, thickness: 0.001 }\n"
        "    bending: { model: hinge }\n    pinned: boundary\ntools:\n  - { name: ball, shape: sphere, radius: 0.2, "
        "motion: [ { position: [0.01, 0.02, 0.21] }, { time: 0.5, position: [0.01, 0.02, 0.1] } ] }\n"
        "contact: { friction: 0 }\nsolver: { method: xpbd, dt: 0.01, drag: 5 }\nduration: 0.8\n";
    const char *second[] = {"solver.second_order=true"};
    pel_run_summary summary;
    run_scene(drum, NULL, 0, NULL, 0, &summary);
    const double force = summary.max_tool_force;
    run_scene(drum, second, 1, NULL, 0, &summary);
    assert_near(summary.max_tool_force, force, 0.02 * force);
    /* nor does it tremble against the ball with energy from nothing */
    const char *fine[] = {"solver.dt=0.005"};
    run_scene(drum, fine, 1, NULL, 0, &summary);
    print_message("appeared %g of %g J\n", summary.ledger.energy_error, summary.ledger.supplied);
    assert_true(summary.ledger.energy_error < 1e-3 * summary.ledger.supplied);
}

/* Contact and tools that nothing touches damp nothing, and what touches makes no energy. */
static void test_touches_nothing(void **unused)
{
    (void)unused;
    static const char drum[] =
        "version: 1\ngravity: [0, 0, -9.81]\nbodies:\n  - name: skin\n    mesh: { shape: grid, nx: 12, ny: 12, size_x: "
        "1, size_y: 1 }\n    mass: { density: 1000 }\n    membrane: { young: 1.0e6, thickness: 0.001, rest_scale: 0.95 "
        "}\n    pinned: boundary\n";
    static const char *const more[] = {"contact: {}\n",
                                       "tools:\n  - { name: far, shape: sphere, radius: 0.1, motion: [ { position: [0, "
                                       "0, 5] } ] }\n",
                                       "tools:\n  - { name: near, shape: sphere, radius: 0.1, motion: [ { position: "
                                       "[0.01, 0.02, -0.12] } ] }\n"};
    for (int i = 0; i < 3; i++) {
        char scene[1024];
        const char *first[] = {"solver.second_order=false"};
        pel_run_summary plain, summary;
        snprintf(scene, sizeof scene, "%s%ssolver: { method: xpbd, dt: 0.01 }\nduration: 1\n", drum, more[i]);
        run_scene(scene, first, 1, NULL, 0, &plain);
        run_scene(scene, NULL, 0, NULL, 0, &summary);
        print_message("lost %g of %g J, in first order %g; appeared %g\n", summary.ledger.dissipated_solver,
                      summary.ledger.kinetic, plain.ledger.dissipated_solver, summary.ledger.energy_error);
        const double lost = plain.ledger.dissipated_solver;
        assert_true(summary.ledger.dissipated_solver < (i < 2 ? 0.05 : 0.6) * lost);
        assert_true(summary.ledger.energy_error < 0.15 * lost);
    }
}

/* Motion that goes down to the mesh, of a sheet in the wind: the step of explicit that is proposed keeps the energy; a
   material with damping, which explicit lacks, is told to do without. */
static void test_unresolved_flutter(void **unused)
{
    (void)unused;
    static const char flag[] =
        "version: 1\ngravity: [0, 0, -9.81]\nbodies:\n  - name: flag\n    mesh: { shape: grid, nx: 12, ny: 8, size_x: "
        "0.9, size_y: 0.6, rotate: { axis: [1, 0, 0], angle: 90 } }\n    membrane: { young: 1e6, thickness: 2e-4 }\n"
        "    mass: { density: 500 }\n    pinned: { box: { min: [-1, -1, -1], max: [-0.449, 1, 1] } }\n"
        "wind: { velocity: [12, 1, 0] }\nsolver: { method: xpbd, dt: 0.01 }\nduration: 1\n";
    pel_run_summary summary;
    run_scene(flag, NULL, 0, NULL, 0, &summary);
    const pel_run_warning *warning = find_warning(&summary, "unresolved-motion");
    assert_non_null(warning);
    const char *remedy = strstr(warning->text, "use solver: { method: explicit, dt: ");
    char dt[40];
    assert_non_null(remedy);
    snprintf(dt, sizeof dt, "solver.dt=%.*s", (int)strcspn(strstr(remedy, "dt: ") + 4, " }"),
             strstr(remedy, "dt: ") + 4);
    const char *overrides[] = {"solver.method=explicit", dt};
    const double lost = summary.ledger.dissipated_solver / summary.ledger.supplied;
    run_scene(flag, overrides, 2, NULL, 0, &summary);
    assert_null(find_warning(&summary, "energy-appears"));
    assert_true(lost > 0.2 && summary.ledger.dissipated_solver < 0.06 * summary.ledger.supplied);
    const char *damped[] = {"bodies.flag.membrane.damping.stiffness=0.0001"};
    run_scene(flag, damped, 1, NULL, 0, &summary);
    warning = find_warning(&summary, "unresolved-motion");
    assert_true(warning != NULL && strstr(warning->text, "explicit, without the damping") != NULL);
}

/* A material whose damping takes many times more substeps than xpbd has: energy appears, and no few more help. */
static void test_damped_energy(void **unused)
{
    (void)unused;
    static const char sheet[] =
        "version: 1\ngravity: [0, 0, -9.81]\nbodies:\n  - name: sheet\n    mesh: { shape: grid, nx: 10, ny: 5, size_x: "
        "0.2, size_y: 0.1 }\n    membrane: { young: 1e6, thickness: 0.001, damping: { stiffness: 0.02 } }\n"
        "    mass: { density: 1000 }\n    pinned: { box: { min: [-1, -1, -1], max: [-0.09, 1, 1] } }\n"
        "solver: { method: xpbd, dt: 0.01, substeps: 4 }\nduration: 0.5\n";
    const char *implicit[] = {"solver={ method: implicit, dt: 0.01 }"};
    pel_run_summary summary;
    run_scene(sheet, NULL, 0, NULL, 0, &summary);
    const pel_run_warning *warning = find_warning(&summary, "energy-appears");
    assert_true(warning != NULL && strstr(warning->text, "use the method implicit: the substeps are softer") != NULL);
    run_scene(sheet, implicit, 1, NULL, 0, &summary);
    assert_null(find_warning(&summary, "energy-appears"));
}

/* A shell that bounces: what the method takes in contact is told as well, and not where friction may have taken it. */
static void test_unresolved_bounce(void **unused)
{
    (void)unused;
    const char *overrides[] = {"contact.friction=0.3"};
    for (int32_t rubs = 0; rubs < 2; rubs++) {
        pel_run_summary summary;
        run_scene("version: 1\nbodies:\n"
                  "  - mesh: { shape: geodesic-sphere, frequency: 5, radius: 0.1, translate: [0, 0, 0.101] }\n"
                  "    mass: { density: 1000, thickness: 0.005 }\n"
                  "    membrane: { material: neo-hookean, young: 1.0e6, poisson: 0.45, thickness: 0.005 }\n"
                  "    velocity: [0, 0, -2]\n"
                  "tools: [{ name: floor, shape: box, size: [1, 1, 0.1], motion: [{ position: [0, 0, -0.05] }] }]\n"
                  "contact: { self: true }\nsolver: { method: xpbd, dt: 0.002, second_order: false }\nduration: 0.15\n"
                  "output: { every: 0.002 }\n",
                  overrides, rubs, NULL, 0, &summary);
        const pel_run_warning *warning = find_warning(&summary, "unresolved-motion");
        double whole = 100 * summary.ledger.dissipated_solver / summary.ledger.supplied;
        char told[40];
        assert_non_null(warning);
        snprintf(told, sizeof told, "has taken %.2g %%", whole);
        print_message("%s\n", warning->text);
        assert_true(whole > 50);
        assert_true((strstr(warning->text, told) != NULL) == (rubs == 0));
        assert_true((strstr(warning->text, "while nothing touched") != NULL) == (rubs == 0));
    }
}

/* By default it is of second order until it touches and after, so that nearly all is lost in contact; a run that ends
   there shows no bounce, and friction may have taken it. */
static void test_silent_bounce(void **unused)
{
    (void)unused;
    const char *overrides[] = {"duration=0.03", "contact.friction=0.3"};
    static const bool warns[] = {true, false, false};
    for (int i = 0; i < 3; i++) {
        pel_run_summary summary;
        double dt = 0;
        run_scene("version: 1\nbodies:\n"
                  "  - mesh: { shape: geodesic-sphere, frequency: 8, radius: 0.1, translate: [0, 0, 0.101] }\n"
                  "    membrane: { young: 1.0e6, poisson: 0.45, thickness: 0.003 }\n    velocity: [0, 0, -1.5]\n"
                  "tools: [{ name: floor, shape: box, size: [1, 1, 0.1], motion: [{ position: [0, 0, -0.05] }] }]\n"
                  "contact: {}\nsolver: { method: xpbd }\nduration: 0.3\noutput: { every: 0.005 }\n",
                  i == 0 ? NULL : &overrides[i - 1], i > 0, NULL, 0, &summary);
        const pel_run_warning *warning = find_warning(&summary, "unresolved-motion");
        print_message("%d: %.3g of %.3g J lost, %s\n", i, summary.ledger.dissipated_solver, summary.ledger.supplied,
                      warning != NULL ? warning->text : "nothing told");
        assert_true((warning != NULL) == warns[i]);
        const char *remedy = warning != NULL ? strstr(warning->text, "method: explicit, dt: ") : NULL;
        assert_true(warning == NULL || (remedy != NULL && sscanf(remedy, "method: explicit, dt: %lf", &dt) == 1));
    }
}

/* a rigid box rises from a trampoline to 0.24 m above its lowest place; steps of explicit to 0.26 m, whatever they are
 */
static void test_trampoline(void **unused)
{
    (void)unused;
    pel_run_summary summary;
    run_scene("version: 1\nbodies:\n  - name: bed\n    mesh: { shape: grid, size_x: 1, size_y: 1, nx: 12, ny: 12 }\n"
              "    membrane: { young: 1.0e6, poisson: 0.3, thickness: 0.002 }\n    pinned: boundary\n  - name: box\n"
              "    mesh: { shape: box, size_x: 0.2, size_y: 0.2, size_z: 0.1, translate: [0, 0, 0.26] }\n"
              "    rigid: { mass: 2 }\ncontact: {}\ngravity: [0, 0, -9.81]\nsolver: { method: xpbd }\nduration: 0.6\n"
              "output: { every: 0.01 }\n",
              NULL, 0, NULL, 0, &summary);
    const pel_run_warning *warning = find_warning(&summary, "unresolved-motion");
    assert_non_null(warning);
    print_message("%s\n", warning->text);
    assert_non_null(strstr(warning->text, "explicit, dt: "));
}

/* A bag that holds its volume swings: first order takes its motion. A volume that is driven is followed instead. */
static void test_swinging_bag(void **unused)
{
    (void)unused;
    const char *const bag =
        "version: 1\nbodies:\n  - name: bag\n"
        "    mesh: { shape: geodesic-sphere, frequency: 4, radius: 0.1 }\n"
        "    membrane: { young: 1.0e6, poisson: 0.45, thickness: 0.002 }\n"
        "    pressure: { volume: { target: 1, bulk: 1.0e5 } }\n    pinned: { nearest: [0, 0, 0.1] }\n"
        "    velocity: [0.3, 0, 0]\ngravity: [0, 0, -9.81]\nsolver: { method: xpbd }\nduration: 2\n"
        "output: { every: 0.01 }\n";
    const char *const driven = "bodies.bag.pressure.volume.target=1.1";
    pel_run_summary summary;
    run_scene(bag, NULL, 0, NULL, 0, &summary);
    const pel_run_warning *warning = find_warning(&summary, "unresolved-motion");
    assert_non_null(warning);
    print_message("%s\n", warning->text);
    assert_non_null(strstr(warning->text, "explicit, dt: "));
    run_scene(bag, &driven, 1, NULL, 0, &summary);
    assert_null(find_warning(&summary, "unresolved-motion"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_unresolved),        cmocka_unit_test(test_rounding),
        cmocka_unit_test(test_work_in_substeps),  cmocka_unit_test(test_work_of_followers),
        cmocka_unit_test(test_struck_drum),       cmocka_unit_test(test_tool_that_stands),
        cmocka_unit_test(test_work_of_what_jams), cmocka_unit_test(test_work_of_two_balls),
        cmocka_unit_test(test_thrown_strip),      cmocka_unit_test(test_pressed_in_second_order),
        cmocka_unit_test(test_touches_nothing),   cmocka_unit_test(test_unresolved_flutter),
        cmocka_unit_test(test_damped_energy),     cmocka_unit_test(test_unresolved_bounce),
        cmocka_unit_test(test_silent_bounce),     cmocka_unit_test(test_trampoline),
        cmocka_unit_test(test_swinging_bag),
    };
    return cmocka_run_group_tests(tests, make_folder, clear_folder);
}
