/* Warnings of runs: each is reported once, is in the summary, and disappears with its remedy. */
#define _XOPEN_SOURCE 700 /* nftw */
#include "random.h"
#include "run/warned.h"

#include "pellicle/shape.h"
#include "pellicle/sim_surface.h"
#include "run/state.h"
#include "run/warnings.h"

#include <ctype.h>

static void test_clean_run(void **unused)
{
    (void)unused;
    const char *fall[] = {"gravity=[0, 0, -1]", "solver.method=explicit"};
    pel_run_summary summary;
    run_scene(small, fall, 2, NULL, 0, &summary);
    assert_int_equal(summary.warning_count, 0);
    check_contains("warned", "summary.json", "\"warnings\": []");
    check_contains("warned", "summary.json", "\"energy\": {\"elastic_start\": ");
}

/* the number of substeps in the text is enough, and two fifths of it are not */
static void test_softness(void **unused)
{
    (void)unused;
    const char *overrides[2] = {"solver={ method: xpbd, dt: 0.001, substeps: 2 }", NULL};
    char substeps[64];
    pel_run_summary summary;
    run_scene(SHELL, overrides, 1, NULL, 0, &summary);
    const pel_run_warning *warning = find_warning(&summary, "softer-than-material");
    assert_non_null(warning);
    assert_int_equal(warning->first_frame, 0);
    const char *factor = strstr(warning->text, "stretches up to ");
    assert_non_null(factor);
    double softness = strtod(factor + strlen("stretches up to "), NULL) - 1;
    assert_near(softness, summary.solver.most_softness, 0.02 * (1 + softness));
    const char *remedy = strstr(warning->text, "use substeps >= ");
    assert_non_null(remedy);
    int needed = (int)strtol(remedy + strlen("use substeps >= "), NULL, 10);
    assert_true(needed > 4);
    overrides[1] = substeps;
    snprintf(substeps, sizeof substeps, "solver.substeps=%d", 2 * needed / 5);
    run_scene(SHELL, overrides, 2, NULL, 1, &summary);
    assert_non_null(find_warning(&summary, "softer-than-material"));
    snprintf(substeps, sizeof substeps, "solver.substeps=%d", needed);
    run_scene(SHELL, overrides, 2, NULL, 1, &summary);
    assert_null(find_warning(&summary, "softer-than-material"));
}

/* springs that stiffen: the warning begins in the frame in which the sweeps fall behind, and counts from there */
static void test_softness_begins(void **unused)
{
    (void)unused;
    const char *overrides[3] = {"solver={ method: xpbd, dt: 0.001, substeps: 3 }",
                                "bodies.ball.springs={ stiffness: { keys: [[0, 0.001], [0.02, 5000]] } }",
                                "stop.frames=16"};
    pel_run_summary summary;
    run_scene(SHELL, overrides, 3, NULL, 0, &summary);
    const pel_run_warning *warning = find_warning(&summary, "softer-than-material");
    assert_non_null(warning);
    assert_true(warning->first_frame > 1 && warning->first_frame < 12);
    assert_int_equal(warning->count, 16 - warning->first_frame + 1);
    assert_true(summary.solver.most_softness > 0.05);
    overrides[2] = "stop.frames=4";
    run_scene(SHELL, overrides, 3, NULL, 0, &summary);
    assert_null(find_warning(&summary, "softer-than-material"));
}

/* steps are counted over a run and its continuation */
static void test_unconverged(void **unused)
{
    (void)unused;
    const char *overrides[2] = {"solver={ method: descent, iterations: 1 }", "output.checkpoint=0"};
    pel_run_summary summary;
    run_scene(SHELL, overrides, 1, NULL, 0, &summary);
    const pel_run_warning *warning = find_warning(&summary, "unconverged");
    assert_non_null(warning);
    assert_true(warning->first_frame == 1 && warning->count == 4 && summary.unconverged_steps == 4);
    pel_run_warning whole = *warning;
    run_scene(SHELL, overrides, 1, NULL, 2, &summary);
    assert_int_equal(find_warning(&summary, "unconverged")->count, 2);
    run_scene(SHELL, overrides, 1, "checkpoint", 0, &summary);
    warning = find_warning(&summary, "unconverged");
    assert_true(warning->first_frame == 1 && warning->count == 4);
    assert_string_equal(warning->text, whole.text);
    overrides[0] = "solver={ method: descent, iterations: 2000 }";
    run_scene(SHELL, overrides, 1, NULL, 0, &summary);
    assert_null(find_warning(&summary, "unconverged"));
}

/* a twisted strip: the moment on the grasp, bending included, does the work that the strip holds */
static void test_twist(void **unused)
{
    (void)unused;
    skip_if_slow();
    const char *text =
        "version: 1\nbodies:\n  - name: strip\n    mesh: { shape: grid, nx: 20, ny: 4, size_x: 0.2, size_y: 0.04 }\n"
        "    membrane: { preset: silicone }\n    bending: { model: midedge }\n"
        "    pinned: { box: { min: [-1, -1, -1], max: [-0.0999, 1, 1] } }\ntools:\n"
        "  - { name: grip, shape: box, size: [0.004, 0.1, 0.02], press: false, grasp: { from: 0, reach: 0.002 },\n"
        "      motion: [{ position: [0.1, 0, 0] }, { time: 0.5, position: [0.1, 0, 0],\n"
        "                 rotation: { axis: [1, 0, 0], angle: 20 } }] }\n"
        "solver: { method: static, dt: 0.02 }\nstop: { frames: 25 }\n";
    pel_run_summary summary;
    run_scene(text, NULL, 0, NULL, 0, &summary);
    assert_int_equal(summary.warning_count, 0);
    assert_near(summary.ledger.work_tools / summary.ledger.elastic, 1, 0.02);
}

/* a sheet of paper that swings and crumples under the method that is chosen for it: no energy appears */
static void test_swing(void **unused)
{
    (void)unused;
    skip_if_long();
    const char *text =
        "version: 1\nbodies:\n  - name: sheet\n    mesh: { shape: grid, nx: 12, ny: 12, size_x: 0.3, size_y: 0.3 }\n"
        "    membrane: { preset: paper }\n    pinned: { box: { min: [-1, -1, -1], max: [-0.149, 1, 1] } }\n"
        "gravity: [0, 0, -9.81]\nsolver: { dt: 0.01 }\nduration: 1\n";
    pel_run_summary summary;
    run_scene(text, NULL, 0, NULL, 0, &summary);
    assert_null(find_warning(&summary, "energy-appears"));
    assert_true(summary.ledger.energy_error < 0.01 * summary.ledger.supplied);
    assert_true(summary.ledger.dissipated_solver < 0.6 * summary.ledger.supplied);
}

/* static finds no way down for a sheet above a ball; its warning names the body and a method that does */
static void test_fall(void **unused)
{
    (void)unused;
    const char *text =
        "version: 1\nbodies:\n  - name: cloth\n    mesh: { shape: grid, nx: 6, ny: 6, size_x: 0.3, size_y: 0.3,\n"
        "            translate: [0, 0, 0.12] }\n    membrane: { preset: rubber }\ntools:\n"
        "  - { name: ball, shape: sphere, radius: 0.1, motion: [{ position: [0, 0, 0] }] }\n"
        "gravity: [0, 0, -9.81]\nsolver: { method: static }\n";
    const char *falls[2] = {"solver={ method: implicit, drag: 5, dt: 0.01 }", "stop.frames=12"};
    pel_run_summary summary;
    run_scene(text, NULL, 0, NULL, 0, &summary);
    const pel_run_warning *warning = find_warning(&summary, "unconverged");
    assert_non_null(warning);
    assert_non_null(strstr(warning->text, "nothing but contact holds 'cloth'"));
    assert_non_null(strstr(warning->text, "method implicit"));
    run_scene(text, falls, 2, NULL, 0, &summary);
    assert_null(find_warning(&summary, "unconverged"));
    assert_true(summary.max_displacement > 0.02);
}

/* a ball between two plates without friction has no place that it must stay at */
static void test_stray(void **unused)
{
    (void)unused;
    skip_if_long();
    const char *text =
        "version: 1\nbodies:\n  - name: ball\n    mesh: { shape: geodesic-sphere, frequency: 4, radius: 0.05 }\n"
        "    membrane: { preset: rubber }\n    pressure: { gas: {} }\ntools:\n"
        "  - { name: floor, shape: box, size: [0.3, 0.3, 0.02], motion: [{ position: [0, 0, -0.0605] }] }\n"
        "  - { name: plate, shape: box, size: [0.3, 0.3, 0.02],\n"
        "      motion: [{ position: [0, 0, 0.0605] }, { time: 1, position: [0, 0, 0.0505] }] }\n"
        "contact: { self: true, friction: 0 }\nsolver: { method: static, dt: 0.02 }\nstop: { frames: 36 }\n";
    const char *held = "contact.friction=0.3";
    pel_run_summary summary;
    run_scene(text, NULL, 0, NULL, 0, &summary);
    const pel_run_warning *warning = find_warning(&summary, "stray-body");
    assert_non_null(warning);
    assert_non_null(strstr(warning->text, "body 'ball'"));
    run_scene(text, &held, 1, NULL, 0, &summary);
    assert_null(find_warning(&summary, "stray-body"));
}

/* a plate pushes a ball about that nothing holds: its forces vanish, and are not asked to balance to their digits */
static void test_pushed_about(void **unused)
{
    (void)unused;
    const char *text =
        "version: 1\nbodies:\n  - name: ball\n    mesh: { shape: geodesic-sphere, frequency: 4, radius: 0.05 }\n"
        "    membrane: { preset: rubber }\n    pressure: { gas: {} }\ntools:\n"
        "  - { name: floor, shape: box, size: [0.3, 0.3, 0.02], motion: [{ position: [0, 0, -0.0605] }] }\n"
        "  - { name: plate, shape: box, size: [0.3, 0.3, 0.02],\n"
        "      motion: [{ position: [0, 0, 0.0605], rotation: { axis: [0, 1, 0], angle: 3 } },\n"
        "        { time: 0.2, position: [0, 0, 0.0595], rotation: { axis: [0, 1, 0], angle: 3 } }] }\n"
        "contact: { self: true, friction: 0.3 }\nsolver: { method: static, dt: 0.02 }\nstop: { frames: 5 }\n";
    pel_run_summary summary;
    run_scene(text, NULL, 0, NULL, 0, &summary);
    assert_null(find_warning(&summary, "unconverged"));
    assert_true(summary.solver.iterations > 0 && summary.solver.iterations < 500);
}

/* a sheet above a ball that a static step does not bring down: the forces that are left are its weight, not a part of
   it; a step that converged would have put it down */
static void test_left_forces(void **unused)
{
    (void)unused;
    const char *text = "version: 1\nbodies:\n  - name: sheet\n"
                       "    mesh: { shape: grid, nx: 6, ny: 6, size_x: 0.2, size_y: 0.2, translate: [0, 0, 0.03] }\n"
                       "    membrane: { preset: paper }\ntools:\n"
                       "  - { name: ball, shape: sphere, radius: 0.029, motion: [{ position: [0, 0, 0] }] }\n"
                       "  - { name: floor, shape: box, size: [1, 1, 0.02], motion: [{ position: [0, 0, -0.06] }] }\n"
                       "gravity: [0, 0, -9.81]\ncontact: { self: true }\nsolver: { method: static, steps: 1 }\n";
    pel_run_summary summary;
    run_scene(text, NULL, 0, NULL, 0, &summary);
    /* 49 vertices that share it */
    double weight = 800 * 1e-4 * 0.2 * 0.2 * 9.81;
    if (summary.solver.converged)
        assert_true(summary.max_tool_force > 0.9 * weight);
    else
        assert_true(summary.solver.residual > weight / 49);
}

/* a grasp that tears out is reported with its tool, vertices and time; the count is kept in checkpoints */
static void test_lost_grasp(void **unused)
{
    (void)unused;
    const char *overrides[] = {"tools.1.grasp.max_force=0.05"};
    pel_run_summary summary;
    run_scene(busy, overrides, 1, NULL, 0, &summary);
    const pel_run_warning *warning = find_warning(&summary, "grasp-lost");
    assert_non_null(warning);
    const pel_run_warning whole = *warning;
    const char *lost_text = strstr(whole.text, "tool 'clamp' lost ");
    assert_non_null(lost_text);
    assert_non_null(strstr(lost_text, " vertices at t = "));
    assert_true(warning->first_frame >= 1 && warning->count >= 1);
    check_contains("warned", "summary.json", "{\"name\": \"clamp\", \"max_force\": ");
    char lost[40];
    snprintf(lost, sizeof lost, "\"lost\": %ld, \"lost_time\": 0.",
             strtol(lost_text + strlen("tool 'clamp' lost "), NULL, 10));
    check_contains("warned", "summary.json", lost);
    check_contains("warned", "summary.json", "\"lost\": 0, \"lost_time\": null, \"held_back_steps\": 0");
    run_scene(busy, overrides, 1, NULL, 4, &summary);
    run_scene(busy, overrides, 1, "checkpoint", 0, &summary);
    warning = find_warning(&summary, "grasp-lost");
    assert_true(warning->first_frame == whole.first_frame && warning->count == whole.count);
    assert_string_equal(warning->text, whole.text);
    run_scene(busy, NULL, 0, NULL, 0, &summary);
    assert_null(find_warning(&summary, "grasp-lost"));
}

/* a ball under a tool; %s: more of it */
#define PRESSED                                                                                                        \
    "version: 1\nbodies:\n  - name: ball\n    mesh: { shape: geodesic-sphere, frequency: 3, radius: 0.05 }\n"          \
    "    membrane: { preset: rubber }\n    pinned: { box: { min: [-1, -1, -1], max: [1, 1, 0] } }\n"                   \
    "tools:\n  - { shape: sphere, radius: 0.02, motion: [{ position: [0, 0, 0.07] }, { time: 0.3, position: [0, 0, "   \
    "0.06] }] }\nstop: { frames: 4 }\noutput: { every_frame: 1 }\n"

/* Frequency 3: edges of 0.39 R; sqrt(R h) is as long at a thickness of about 0.15 R. A tool bends the shell in a layer
   of that width; a pressure stretches it, and it needs no such edges. */
static void test_coarse_mesh(void **unused)
{
    (void)unused;
    const char *overrides[] = {"bodies.0.membrane={ young: 1e6, thickness: 0.006 }",
                               "bodies.0.bending={ model: hinge }", "solver={ method: descent, dt: 0.1 }",
                               "bodies.0.refine={ levels: 1, everywhere: true }"};
    pel_run_summary summary;
    run_scene(PRESSED, overrides, 3, NULL, 4, &summary);
    const pel_run_warning *warning = find_warning(&summary, "coarse-mesh");
    assert_true(warning != NULL && warning->first_frame > 0 &&
                strstr(warning->text, "pellicle subdivide -n 1") != NULL);
    run_scene(SHELL, overrides, 3, NULL, 4, &summary);
    assert_null(find_warning(&summary, "coarse-mesh"));
    run_scene(PRESSED, overrides, 4, NULL, 4, &summary);
    assert_null(find_warning(&summary, "coarse-mesh"));
    overrides[0] = "bodies.0.membrane={ young: 1e6, thickness: 0.01 }";
    run_scene(PRESSED, overrides, 3, NULL, 4, &summary);
    assert_null(find_warning(&summary, "coarse-mesh"));
}

static void test_inverted_mesh(void **unused)
{
    (void)unused;
    char path[256], text[600];
    pel_shape_def def = pel_shape_def_default(PEL_SHAPE_GEODESIC_SPHERE);
    pel_mesh *mesh;
    pel_run_summary summary;
    def.frequency = 2;
    for (int inverted = 0; inverted < 2; inverted++) {
        assert_int_equal(pel_shape_create(&def, &mesh, NULL), PEL_OK);
        for (int32_t t = 0; inverted && t < mesh->triangle_count; t++) {
            int32_t *v = mesh->triangles[t], other = v[1];
            v[1] = v[2];
            v[2] = other;
        }
        in_folder(path, "ball.obj", "");
        assert_int_equal(pel_mesh_write(path, PEL_FORMAT_AUTO, mesh, NULL, NULL), PEL_OK);
        pel_mesh_destroy(mesh);
        snprintf(text, sizeof text, "version: 1\nbodies: [{ mesh: { file: %s } }]\nstop: { frames: 1 }\n", path);
        run_scene(text, NULL, 0, NULL, 0, &summary);
        assert_true((find_warning(&summary, "inverted-mesh") != NULL) == inverted);
    }
}

/* a membrane of the constraints of paper B stores more than its material could have been given */
static void test_energy_appears(void **unused)
{
    (void)unused;
    const char *overrides[] = {"bodies.0.pressure={ inside: 20 }", "bodies.0.membrane={ young: 1e7, thickness: 0.001 }",
                               "solver={ method: pbd, dt: 0.01 }"};
    pel_run_summary summary;
    run_scene(SHELL, overrides, 3, NULL, 0, &summary);
    const pel_run_warning *warning = find_warning(&summary, "energy-appears");
    assert_non_null(warning);
    assert_true(summary.ledger.energy_error > 0.05 * summary.ledger.supplied);
    /* the material itself accepts any value */
    overrides[2] = "solver={ method: descent, iterations: 2000 }";
    run_scene(SHELL, overrides, 3, NULL, 0, &summary);
    assert_null(find_warning(&summary, "energy-appears"));
}

/* A sheet that supports stretch in one step of statics: the mean of their force is not its path, so the ledger does not
   balance, but the sheet is in equilibrium, and the force of the supports is right. */
static void test_energy_of_supports(void **unused)
{
    (void)unused;
    const char *const scene =
        "version: 1\nbodies:\n  - name: sheet\n    mesh: { shape: grid, nx: 3, ny: 2, size_x: 1, size_y: 0.5 }\n"
        "    membrane: { material: neo-hookean, young: 1.0e6, poisson: 0.5, thickness: 0.001 }\n"
        "    supports:\n"
        "      - { at: { box: { min: [-0.6, -1, -1], max: [-0.4, 1, 1] } } }\n"
        "      - { at: { box: { min: [0.4, -1, -1], max: [0.6, 1, 1] } }, displacement: [1, 0, 0] }\n"
        "solver: { method: static }\n";
    const char *overrides[] = {"bodies.0.supports.1.keys=[[0, 0], [1, 1]]", "solver.steps=10"};
    pel_run_summary summary;
    run_scene(scene, NULL, 0, NULL, 0, &summary);
    assert_true(summary.ledger.energy_error > summary.ledger.tolerance);
    assert_int_equal(summary.warning_count, 0);
    run_scene(scene, overrides, 2, NULL, 0, &summary);
    assert_true(summary.ledger.energy_error < summary.ledger.tolerance);
}

/* the work of gravity on a slab held by friction is rounding */
static void test_energy_of_rest(void **unused)
{
    (void)unused;
    skip_if_slow();
    pel_run_summary summary;
    run_scene("version: 1\n"
              "bodies:\n"
              "  - mesh: { shape: grid, nx: 5, ny: 12, size_x: 0.3, size_y: 0.8, translate: [0.011, 0.013, 0.001] }\n"
              "    membrane: { young: 2e5, poisson: 0.4, thickness: 0.004 }\n"
              "gravity: [2.379, 0, -9.517]\n"
              "contact: { self: true, friction: 0.3, thickness: 0.001 }\n"
              "tools: [{ name: ground, shape: box, size: [40, 40, 1], motion: [{ position: [0, 0, -0.5] }] }]\n"
              "solver: { dt: 0.005 }\n"
              "duration: 0.5\n",
              NULL, 0, NULL, 0, &summary);
    assert_null(find_warning(&summary, "energy-appears"));
}

/* nor do sweeps over a body at rest supply energy; in float rounding keeps it moving, which is told */
static void test_energy_of_sweeps(void **unused)
{
    (void)unused;
    if (sizeof(pel_real) == sizeof(float))
        skip();
    pel_run_summary summary;
    run_scene("version: 1\n"
              "bodies:\n"
              "  - mesh: { shape: geodesic-sphere, frequency: 4, radius: 0.07, translate: [0.1, 0.2, 0.3] }\n"
              "    volumetric: {}\n"
              "duration: 3\n",
              NULL, 0, NULL, 0, &summary);
    assert_null(find_warning(&summary, "energy-appears"));
}

/* a run that is over before anything could swing shows no motion that steps would not resolve; a longer one does */
static void test_short_run(void **unused)
{
    (void)unused;
    const char *const ball =
        "version: 1\nbodies:\n  - mesh: { shape: geodesic-sphere, frequency: 4, radius: 0.1 }\n"
        "    springs: { drag: 0 }\ngravity: [0, 0, -9.81]\nsolver: { method: xpbd, dt: 0.01, second_order: false }\n"
        "duration: 0.01\n";
    const char *const balloon = "version: 1\nbodies:\n  - mesh: { shape: geodesic-sphere, frequency: 6, radius: 0.1 }\n"
                                "    membrane: { preset: rubber }\n    pressure: { inside: 100 }\nsolver: { method: "
                                "xpbd, dt: 0.01, second_order: false }\n"
                                "duration: 0.01\n";
    pel_run_summary summary;
    run_scene(ball, NULL, 0, NULL, 0, &summary);
    assert_null(find_warning(&summary, "unresolved-motion"));
    assert_true(summary.ledger.dissipated_solver > 0.05 * summary.ledger.work_gravity);
    /* one step of 0.4 of its slowest vibration: .095 mm for .067 mm with 400 substeps */
    run_scene(balloon, NULL, 0, NULL, 0, &summary);
    assert_non_null(find_warning(&summary, "unresolved-motion"));
}

/* A load that is sudden for the motion it starts: steps that keep its energy may still miss its frequency. */
static void test_sudden_load(void **unused)
{
    (void)unused;
    const char *const balloon = "version: 1\nbodies:\n  - mesh: { shape: geodesic-sphere, frequency: 4, radius: 0.1 }\n"
                                "    membrane: { preset: rubber }\n    pressure: { inside: 100 }\n"
                                "solver: { method: implicit }\nduration: 0.02\n";
    const char *const fall = "version: 1\nbodies:\n  - mesh: { shape: geodesic-sphere, frequency: 3, radius: 0.1 }\n"
                             "    membrane: { preset: rubber }\ngravity: [0, 0, -9.81]\n"
                             "solver: { method: implicit, dt: 0.02 }\nduration: 0.4\n";
    static const struct {
        const char *dt, *duration, *told; /* null = nothing is told */
    } cases[] = {
        {"solver.dt=0.002", "duration=0.02", "a vibration has "},
        {"solver.dt=0.0025", "duration=0.0075", "a vibration has "},
        {"solver.dt=0.005", "duration=0.005", "a vibration has "},
        {"solver.dt=0.0005", "duration=0.02", NULL},
    };
    pel_run_summary summary;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const char *overrides[] = {cases[i].dt, cases[i].duration};
        run_scene(balloon, overrides, 2, NULL, 0, &summary);
        const pel_run_warning *warning = find_warning(&summary, "unresolved-motion");
        assert_true((warning != NULL) == (cases[i].told != NULL));
        assert_true(warning == NULL || strstr(warning->text, cases[i].told) != NULL);
    }
    run_scene(fall, NULL, 0, NULL, 0, &summary);
    assert_null(find_warning(&summary, "unresolved-motion"));
}

/* a grasp that closes beside the body, or before the tool is there, is reported; one that holds is not */
static void test_grasp_empty(void **unused)
{
    (void)unused;
    const char *overrides[] = {"tools=[{ name: grip, shape: sphere, radius: 0.02, press: false, grasp: { reach: 0.001, "
                               "from: 0.01 }, motion: [{ position: [0, 0, 0.08] }] }]",
                               "tools.0.motion.0.position=[0, 0, 0.06]"};
    pel_run_summary summary;
    run_scene(SHELL, overrides, 1, NULL, 0, &summary);
    const pel_run_warning *warning = find_warning(&summary, "grasp-empty");
    assert_non_null(warning);
    assert_true(warning->first_frame == 2 && warning->count == 3);
    assert_non_null(strstr(warning->text, "'grip'"));
    run_scene(SHELL, overrides, 2, NULL, 0, &summary);
    assert_null(find_warning(&summary, "grasp-empty"));
}

/* sheets nearer than the thickness of the shells are told, with a thickness that they keep */
static void test_close_start(void **unused)
{
    (void)unused;
    const char *const scene =
        "version: 1\nbodies:\n"
        "  - { name: low, mesh: { shape: grid, nx: 3, ny: 3 }, membrane: { young: 1e4, thickness: 0.002 } }\n"
        "  - { name: high, mesh: { shape: grid, nx: 3, ny: 3, translate: [0.01, 0.02, 0.001] },\n"
        "      membrane: { young: 1e4, thickness: 0.004 } }\n"
        "contact: { thickness: shell }\nsolver: { dt: 1.0e-3 }\nstop: { frames: 2 }\n";
    const char *override = "contact.thickness=0.001";
    pel_run_summary summary;
    run_scene(scene, NULL, 0, NULL, 0, &summary);
    const pel_run_warning *warning = find_warning(&summary, "close-start");
    assert_non_null(warning);
    assert_int_equal(warning->first_frame, 0);
    assert_non_null(strstr(warning->text, "body 'low' and body 'high' start 0.001 m apart"));
    assert_non_null(strstr(warning->text, "thickness of 0.003 m"));
    assert_non_null(strstr(warning->text, "contact: { thickness: 0.001 }"));
    check_contains("warned", "summary.json", "\"thickness_of\": {\"low\": 0.002, \"high\": 0.004}");
    check_contains("warned", "scene.yaml", "# contact thickness of 'high': 0.004 m\n");
    run_scene(scene, &override, 1, NULL, 0, &summary);
    assert_null(find_warning(&summary, "close-start"));
}

/* three borders that meet are told, and two that are a little apart; a seam is sewn, also one that differs by rounding,
   and one that shall stay open is not told */
static void test_open_seam(void **unused)
{
    (void)unused;
    static const struct {
        const char *vertices, *override, *tolerance; /* null = not told */
    } cases[] = {{"v 1 0 0\nv 0 0 0\nv 0 -1 0\nf 1 2 3\nf 4 5 6\n", "duration=0.01", NULL},
                 {"v 1 0 0\nv 0 0 0\nv 0 -1 0\nf 1 2 3\nf 4 5 6\n", "bodies.0.mesh.weld=false", NULL},
                 {"v 1 1e-9 0\nv 0 0 0\nv 0 -1 0\nf 1 2 3\nf 4 5 6\n", "duration=0.01", NULL},
                 {"v 1 1e-9 0\nv 0 0 0\nv 0 -1 0\nf 1 2 3\nf 4 5 6\n", "bodies.0.mesh.weld=false", NULL},
                 {"v 1 1e-4 0\nv 0 0 0\nv 0 -1 0\nf 1 2 3\nf 4 5 6\n", "duration=0.01", NULL},
                 {"v 1 2e-5 0\nv 0 0 0\nv 0 -1 0\nf 1 2 3\nf 4 5 6\n", "duration=0.01", "--tolerance 6."},
                 {"v 1 0 0\nv 0 0 0\nv 0 -1 0\nv 1 0 0\nv 0 0 0\nv 0 0 1\nf 1 2 3\nf 4 5 6\nf 7 8 9\n", "duration=0.01",
                  "--tolerance 2."}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        pel_run_summary summary;
        char text[600], path[256];
        FILE *stream = fopen(in_folder(path, "", "seam.obj"), "wb");
        assert_non_null(stream);
        fprintf(stream, "v 0 0 0\nv 1 0 0\nv 0 1 0\n%s", cases[i].vertices);
        fclose(stream);
        snprintf(
            text, sizeof text,
            "version: 1\nbodies:\n  - { name: sheet, mesh: { file: %s }, membrane: { young: 1e4, thickness: 0.01 } }\n"
            "stop: { frames: 2 }\n",
            path);
        run_scene(text, &cases[i].override, 1, NULL, 0, &summary);
        const pel_run_warning *warning = find_warning(&summary, "open-seam");
        if ((warning != NULL) != (cases[i].tolerance != NULL))
            fail_msg("case %zu: %s", i, warning != NULL ? warning->text : "no warning");
        if (warning != NULL) {
            assert_non_null(strstr(warning->text, "body 'sheet' is open along 1 edges"));
            assert_non_null(strstr(warning->text, cases[i].tolerance));
        }
    }
}

/* a tool that moves beside the body is told, with where it ends and where the body is; one that stands still is not,
 * nor one that presses */
static void test_idle_tool(void **unused)
{
    (void)unused;
    const char *overrides[] = {
        "tools=[{ name: still, shape: sphere, radius: 0.01, motion: [{ position: [0, 0, 1] }] }, { name: probe, "
        "shape: sphere, radius: 0.01, motion: [{ position: [0, 0, 1] }, { time: 0.001, position: [0, 0, 0.75] }] }]",
        "tools.1.motion.1.position=[0, 0, 0.0599]"};
    pel_run_summary summary;
    run_scene(SHELL, overrides, 1, NULL, 0, &summary);
    const pel_run_warning *warning = find_warning(&summary, "tool-touches-nothing");
    assert_non_null(warning);
    assert_int_equal(warning->count, 1);
    assert_non_null(strstr(warning->text, "tool 'probe' moves but touches nothing"));
    assert_non_null(strstr(warning->text, "its last position is (0, 0, 0.75) m"));
    assert_non_null(strstr(warning->text, "body 'ball' begins within (-0.0"));
    run_scene(SHELL, overrides, 2, NULL, 0, &summary);
    assert_null(find_warning(&summary, "tool-touches-nothing"));
}

/* a net that gives way by itself has no force on the tool that dents it */
static void test_giving_net(void **unused)
{
    (void)unused;
    pel_run_summary summary;
    run_scene(
        "version: 1\nbodies: [{ mesh: { shape: capsule, rings: 1 } }]\nsolver: { method: static, dt: 0.008 }\n"
        "tools: [{ shape: sphere, radius: 0.2844, motion: [{ position: [0, 0, -1.3344] }, { time: 0.08, position: "
        "[-0.1, 0.009, -1] }] }]\n",
        NULL, 0, NULL, 0, &summary);
    assert_true(summary.max_displacement > 0.2);
    assert_null(find_warning(&summary, "tool-touches-nothing"));
}

/* a tool that its keys lead into pinned vertices only is told these, with contact as what holds it back */
static void test_pinned_under_tool(void **unused)
{
    (void)unused;
    const char *overrides[] = {
        "tools=[{ name: probe, shape: sphere, radius: 0.02, motion: [{ position: [0, 0, 0.08] }, { time: 0.004, "
        "position: [0, 0, 0.06] }] }]",
        "stop.frames=6", "bodies.0.pinned={ box: { min: [-1, -1, 0.03], max: [1, 1, 1] } }", "contact={}"};
    static const char *const codes[] = {"tool-touches-nothing", "tool-held-back"};
    pel_run_summary summary;
    for (int c = 0; c < 2; c++) {
        run_scene(SHELL, overrides, 3 + c, NULL, 0, &summary);
        const pel_run_warning *warning = find_warning(&summary, codes[c]);
        assert_non_null(warning);
        assert_non_null(strstr(warning->text, "vertices of body 'ball' that are"));
        assert_non_null(strstr(warning->text, "pin fewer, or press elsewhere"));
        assert_null(find_warning(&summary, codes[1 - c]));
        assert_null(find_warning(&summary, "nothing-acts"));
    }
    /* one that is out again at the end */
    overrides[3] = "tools.0.motion.2={ time: 0.006, position: [0, 0, 0.08] }";
    run_scene(SHELL, overrides, 4, NULL, 0, &summary);
    const pel_run_warning *passed = find_warning(&summary, codes[0]);
    assert_true(passed != NULL && strstr(passed->text, "pin fewer") != NULL);
    /* a vertex that is free is pressed */
    overrides[2] = "bodies.0.pinned={ box: { min: [-1, -1, -1], max: [1, 1, 0.03] } }";
    run_scene(SHELL, overrides, 3, NULL, 0, &summary);
    assert_null(find_warning(&summary, codes[0]));
}

/* volumetric springs: under gravity, or with a velocity, the body does not move freely, unless it is held in any case
 */
static void test_held_in_place(void **unused)
{
    (void)unused;
    const char *overrides[] = {"gravity=[0, 0, -9.81]",
                               "bodies.0.pinned={ box: { min: [-1, -1, -1], max: [1, 1, -0.045] } }"};
    static const char organ[] =
        "version: 1\nbodies: [{ name: organ, mesh: { shape: geodesic-sphere, frequency: 3, radius: 0.05 }, "
        "volumetric: {} }]\nstop: { frames: 2 }\n";
    pel_run_summary summary;
    run_scene(organ, NULL, 0, NULL, 0, &summary);
    assert_null(find_warning(&summary, "held-in-place"));
    run_scene(organ, overrides, 2, NULL, 0, &summary);
    assert_null(find_warning(&summary, "held-in-place"));
    run_scene(organ, overrides, 1, NULL, 0, &summary);
    const pel_run_warning *warning = find_warning(&summary, "held-in-place");
    assert_non_null(warning);
    assert_true(warning->first_frame == 0 && warning->count == 1);
    const char *flies[] = {"solver={ method: explicit, dt: 0.0001 }", "bodies.0.velocity=[1, 0, 0]"};
    run_scene(organ, flies, 2, NULL, 0, &summary);
    warning = find_warning(&summary, "held-in-place");
    assert_non_null(warning);
    assert_non_null(strstr(warning->text, "body 'organ' does not move freely"));
}

/* slender bodies whose weight volumetric springs carry from vertex to vertex; not compact or stiff ones, nor with
   stiffnesses in N/m, nor without gravity */
static void test_carried(void **unused)
{
    (void)unused;
    static const char beam[] =
        "version: 1\ngravity: [0, 0, -9.81]\nbodies: [{ name: beam, mesh: { shape: box, nx: 12, ny: 2, nz: 2, size_x: "
        "0.2, size_y: 0.03, size_z: 0.03 }, volumetric: {}, pinned: { box: { min: [-1, -1, -1], max: [-0.09, 1, 1] } } "
        "}]\nstop: { frames: 1 }\n";
    static const char both[] = "bodies.0.pinned={ not: { box: { min: [-0.09, -1, -1], max: [0.09, 1, 1] } } }";
    static const struct {
        const char *overrides[2];
        bool tells;
    } cases[] = {
        {{NULL}, true},
        {{both}, true},
        {{"bodies.0.volumetric.young=120000"}, true},
        {{"bodies.0.volumetric.young=1000000"}, false},
        {{"bodies.0.volumetric.young=120000", both}, false},
        {{"bodies.0.volumetric={ stiffness: 1 }"}, false},
        {{"gravity=[0, 0, 0]"}, false},
        /* it hangs */
        {{"gravity=[9.81, 0, 0]"}, true},
        {{"gravity=[9.81, 0, 0]", "bodies.0.volumetric.young=20000"}, false},
        {{"bodies.0.mesh.size_x=0.025", "bodies.0.pinned={ box: { min: [-1, -1, -1], max: [-0.012, 1, 1] } }"}, false},
        {{"bodies.0.pinned={ box: { min: [-1, -1, -1], max: [1, 1, -0.014] } }"}, false},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        pel_run_summary summary;
        int count = (cases[i].overrides[0] != NULL) + (cases[i].overrides[1] != NULL);
        run_scene(beam, (const char **)(uintptr_t)cases[i].overrides, count, NULL, 0, &summary);
        const pel_run_warning *warning = find_warning(&summary, "held-in-place");
        if ((warning != NULL) != cases[i].tells)
            fail_msg("case %d", (int)i);
        if (warning != NULL)
            assert_non_null(strstr(warning->text, "use volume: { young: "));
    }
}

/* a ball that touches too few vertices is told with the refinement under it that helps */
static void test_coarse_contact(void **unused)
{
    (void)unused;
    skip_if_slow();
    static const char pressed[] =
        "version: 1\nbodies: [{ name: ball, mesh: { shape: geodesic-sphere, frequency: 10, radius: 0.05 }, "
        "volumetric: {} }]\n"
        "tools: [{ name: tip, shape: sphere, radius: 0.02, motion: [{ position: [0, 0, 0.071] }, "
        "{ time: 0.5, position: [0, 0, 0.06] }] }]\nduration: 0.5\n";
    pel_run_summary summary;
    run_scene(pressed, NULL, 0, NULL, 0, &summary);
    const pel_run_warning *warning = find_warning(&summary, "coarse-contact");
    assert_true(warning != NULL && warning->count == 1);
    assert_non_null(strstr(warning->text, "tool 'tip' touches "));
    /* the remedy of the text */
    char remedy[120];
    const char *begin = strstr(warning->text, "bodies.ball.refine='{");
    assert_non_null(begin);
    const char *end = strchr(begin, '}');
    snprintf(remedy, sizeof remedy, "bodies.ball.refine=%.*s", (int)(end + 1 - strchr(begin, '{')), strchr(begin, '{'));
    /* under static in two large steps, too: refinement settles before each */
    const char *overrides[] = {remedy, "solver.method=static", "solver.dt=0.25"};
    run_scene(pressed, overrides, 1, NULL, 0, &summary);
    assert_null(find_warning(&summary, "coarse-contact"));
    run_scene(pressed, overrides, 3, NULL, 0, &summary);
    assert_null(find_warning(&summary, "coarse-contact"));
    assert_true(summary.steps == 2 && summary.vertices_final > 1200);
    /* a refinement under the tool that is too coarse: more levels of it */
    const char *coarse[] = {"bodies.ball.mesh.frequency=4", "bodies.ball.refine={ levels: 1, near_tools: 0.02 }"};
    run_scene(pressed, coarse, 2, NULL, 0, &summary);
    warning = find_warning(&summary, "coarse-contact");
    assert_non_null(warning);
    assert_non_null(strstr(warning->text, "use bodies.ball.refine.levels="));
    assert_null(strstr(warning->text, "with near_tools"));
}

/* the hollow ball of paper A creeps; with volumetric springs, or long after the force ended, it is at rest */
static void test_unsettled(void **unused)
{
    (void)unused;
    skip_if_slow();
    static const char pushed[] =
        "version: 1\nbodies: [{ name: ball, mesh: { shape: geodesic-sphere, frequency: 5 }, preset: paper-a, "
        "volumetric: { stiffness: 0.01 } }]\n"
        "loads: [{ body: ball, force: [0, 0, -1], at: { nearest: [0, 0, 1] }, until: 1 }]\n"
        "solver: { method: quasi-static, alpha: 50, dt: 0.01, velocity: ignore }\nduration: 2\n";
    const char *overrides[] = {"bodies.ball.volumetric.stiffness=1.5", "duration=6"};
    pel_run_summary summary;
    run_scene(pushed, NULL, 0, NULL, 0, &summary);
    const pel_run_warning *warning = find_warning(&summary, "unsettled");
    assert_true(warning != NULL && warning->first_frame == summary.frames - 1);
    run_scene(pushed, overrides, 2, NULL, 0, &summary);
    assert_null(find_warning(&summary, "unsettled"));
}

/* a ball that a tool presses faster than it relaxes is not at rest in the frames before it stands still */
static void test_restless(void **unused)
{
    (void)unused;
    skip_if_slow();
    static const char pressed[] =
        "version: 1\nbodies: [{ name: ball, mesh: { shape: geodesic-sphere, frequency: 5 }, preset: paper-a, "
        "volumetric: {} }]\n"
        "tools: [{ name: probe, shape: sphere, radius: 0.5, motion: [ { position: [0, 0, 1.5] }, { time: 0.5, "
        "position: "
        "[0, 0, 1.2] } ] }]\n"
        "solver: { method: quasi-static, alpha: 50, dt: 0.01, velocity: ignore }\nduration: 6\noutput: { every: 0.25 "
        "}\n";
    const char *balance[] = {"solver.method=static", "solver.dt=0.25"};
    pel_run_summary summary;
    run_scene(pressed, NULL, 0, NULL, 0, &summary);
    const pel_run_warning *warning = find_warning(&summary, "unsettled");
    assert_non_null(warning);
    assert_true(warning->first_frame == 1 && warning->count == 2);
    assert_non_null(strstr(warning->text, "not at rest under the tools"));
    assert_null(strstr(warning->text, "the run ended"));
    run_scene(pressed, balance, 2, NULL, 0, &summary);
    assert_null(find_warning(&summary, "unsettled"));
}

/* ---- without a run ---- */

static void test_tallies(void **unused)
{
    (void)unused;
    pel_warning_tallies tallies = {0}, more = {0};
    pel_warn(&tallies, PEL_WARN_JAMMED, 5, 0.2);
    pel_warn(&more, PEL_WARN_JAMMED, 3, 0.1);
    pel_warn(&more, PEL_WARN_JAMMED, 4, 0.4);
    pel_warn(&more, PEL_WARN_TOOL_HELD, 7, 1);
    pel_warnings_merge(&tallies, &more);
    const pel_warning_tally *jam = &tallies.of[PEL_WARN_JAMMED];
    assert_true(jam->first_frame == 3 && jam->count == 3 && jam->worst == 0.4);
    assert_true(tallies.of[PEL_WARN_TOOL_HELD].first_frame == 7 && more.of[PEL_WARN_JAMMED].count == 0);
}

static void test_frames(void **unused)
{
    (void)unused;
    pel_warning_tallies tallies = {0};
    pel_sim_measures measures = {.least_volume_ratio = 1e-6};
    pel_sim_ledger ledger = {.energy_error = 1, .tolerance = 1};
    pel_warnings_check_frame(&tallies, 1, &measures, &ledger);
    assert_true(tallies.of[PEL_WARN_ENERGY].count == 0 && tallies.of[PEL_WARN_INVERTED_VOLUME].count == 0);
    measures.least_volume_ratio = -0.5;
    ledger.energy_error = 1.01;
    pel_warnings_check_frame(&tallies, 2, &measures, &ledger);
    assert_int_equal(tallies.of[PEL_WARN_ENERGY].first_frame, 2);
    assert_true(tallies.of[PEL_WARN_INVERTED_VOLUME].worst == 0.5);
}

static void shake(pel_sim *sim, int32_t body, double speed, random_state *random)
{
    int32_t count = pel_sim_vertex_count(sim, body);
    double *velocities = malloc(3 * (size_t)count * sizeof *velocities);
    for (int32_t i = 0; i < 3 * count; i++)
        velocities[i] = random_between(random, -speed, speed);
    assert_int_equal(pel_sim_set_velocities(sim, body, velocities, NULL), PEL_OK);
    free(velocities);
}

/* steps count as jammed by the vertices that they stepped back themselves, not by those before them */
static void test_jam(void **unused)
{
    (void)unused;
    static const char spheres[] =
        "version: 1\nbodies:\n"
        "  - { name: a, mesh: { shape: geodesic-sphere, frequency: 3 }, mass: { per_vertex: 1 }, springs: { stiffness: "
        "3 } }\n"
        "  - { name: b, mesh: { shape: geodesic-sphere, frequency: 3, translate: [2.02, 0.1, 0] },\n"
        "      mass: { per_vertex: 1 }, springs: { stiffness: 3 } }\n"
        "contact: { self: true }\nsolver: { method: explicit, dt: 0.01 }\nduration: 1\n";
    pel_scene *scene = load_scene(spheres, NULL, 0);
    pel_run_state run = {.scene = scene};
    random_state random = {7};
    assert_int_equal(pel_model_create(&scene->model, &run.model, NULL), PEL_OK);
    pel_sim_def def = scene->sim;
    def.model = run.model;
    assert_int_equal(pel_sim_create(&def, &run.sim, NULL), PEL_OK);
    int32_t vertex_count = pel_sim_vertex_count(run.sim, 0) + pel_sim_vertex_count(run.sim, 1);
    int64_t jammed = 0;
    double before = 0;
    for (int n = 0; n < LONG(40, 20); n++) {
        shake(run.sim, 0, n % 4 == 0 ? 300 : 0, &random);
        shake(run.sim, 1, n % 4 == 0 ? 300 : 0, &random);
        assert_int_equal(pel_sim_step(run.sim, NULL), PEL_OK);
        pel_contact_statistics now;
        pel_sim_get_contact_statistics(run.sim, &now);
        jammed += 10 * (now.stepped_back - before) >= vertex_count;
        before = now.stepped_back;
        assert_true((double)now.fall_backs == now.stepped_back);
        pel_warnings_check_step(&run);
        assert_int_equal(run.totals.warnings.of[PEL_WARN_JAMMED].count, jammed);
    }
    print_message("%d steps jammed\n", (int)jammed);
    assert_true(jammed > 0 && jammed < LONG(30, 15));
    pel_sim_destroy(run.sim);
    pel_model_destroy(run.model);
    pel_scene_destroy(scene);
}

/* a jam names the law, the thickness or the steps that are at fault */
static void test_fault_of_jam(void **unused)
{
    (void)unused;
    static const struct {
        const char *material, *thickness, *fault;
    } cases[] = {{"stvk", "0.001", "law of body 'sheet'"},
                 {"neo-hookean", "0.01", "contact thickness of body 'sheet'"},
                 {"neo-hookean", "0.001", "smaller solver.dt"}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char text[600];
        snprintf(
            text, sizeof text,
            "version: 1\nbodies:\n  - { name: sheet, mesh: { shape: grid, nx: 8, ny: 8, size_x: 0.2, size_y: 0.2 },\n"
            "      membrane: { material: %s, young: 1e6, thickness: 0.001 } }\ncontact: { thickness: %s }\n"
            "duration: 1\n",
            cases[i].material, cases[i].thickness);
        pel_scene *scene = load_scene(text, NULL, 0);
        pel_run_state run = {.scene = scene};
        pel_run_warning warnings[PEL_RUN_WARNING_LIMIT];
        assert_int_equal(pel_model_create(&scene->model, &run.model, NULL), PEL_OK);
        pel_sim_def def = scene->sim;
        def.model = run.model;
        assert_int_equal(pel_sim_create(&def, &run.sim, NULL), PEL_OK);
        run.totals.warnings.of[PEL_WARN_JAMMED] = (pel_warning_tally){2, 10, 0.4};
        assert_int_equal(pel_warnings_list(&run, warnings), 1);
        assert_non_null(strstr(warnings[0].text, cases[i].fault));
        pel_sim_destroy(run.sim);
        pel_model_destroy(run.model);
        pel_scene_destroy(scene);
    }
}

/* every kind has its own code, small letters and hyphens, and a text that ends without a full stop */
static void test_every_kind_has_a_text(void **unused)
{
    (void)unused;
    pel_scene *scene = load_scene(small, NULL, 0);
    pel_run_def def = pel_run_def_default();
    def.folder = "nowhere";
    pel_run_state run = {.scene = scene, .def = &def};
    pel_run_warning warnings[PEL_RUN_WARNING_LIMIT];
    assert_int_equal(pel_model_create(&scene->model, &run.model, NULL), PEL_OK);
    pel_sim_def sim_def = scene->sim;
    sim_def.model = run.model;
    assert_int_equal(pel_sim_create(&sim_def, &run.sim, NULL), PEL_OK);
    for (int k = 0; k < PEL_WARN_COUNT; k++) {
        run.totals.warnings.of[k] = (pel_warning_tally){2, 9, k == PEL_WARN_JAMMED ? 0.4 : 3};
        run.flagged[k] = (pel_flagged_body){0, 2, 1};
    }
    /* nine steps are no jam, ten are, and one that steps half of all vertices back; energy counts against all that was
     * supplied */
    run.ledger.tolerance = 3;
    run.ledger.work_estimated = 1;
    assert_int_equal(pel_warnings_list(&run, warnings), PEL_WARN_COUNT - 2);
    run.totals.warnings.of[PEL_WARN_JAMMED] = (pel_warning_tally){2, 1, 0.5};
    assert_int_equal(pel_warnings_list(&run, warnings), PEL_WARN_COUNT - 1);
    run.totals.warnings.of[PEL_WARN_JAMMED] = (pel_warning_tally){2, 10, 0.4};
    run.ledger.tolerance = 2.9;
    assert_int_equal(pel_warnings_list(&run, warnings), PEL_WARN_COUNT);
    for (int i = 0; i < PEL_WARN_COUNT; i++) {
        size_t length = strlen(warnings[i].text);
        for (const char *at = warnings[i].code; *at != '\0'; at++)
            assert_true(islower((unsigned char)*at) || *at == '-');
        for (int j = 0; j < i; j++)
            assert_string_not_equal(warnings[i].code, warnings[j].code);
        assert_true(length > 40 && length + 1 < sizeof warnings[i].text && warnings[i].text[length - 1] != '.');
        assert_null(strchr(warnings[i].text, '\n'));
    }
    pel_sim_destroy(run.sim);
    pel_model_destroy(run.model);
    pel_scene_destroy(scene);
}

static int one_thread(void **unused)
{
    thread_count = 1;
    return make_folder(unused);
}

static int two_threads(void **unused)
{
    thread_count = 2;
    return make_folder(unused);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_clean_run),
        cmocka_unit_test(test_softness),
        cmocka_unit_test(test_softness_begins),
        cmocka_unit_test(test_unconverged),
        cmocka_unit_test(test_fall),
        cmocka_unit_test(test_stray),
        cmocka_unit_test(test_pushed_about),
        cmocka_unit_test(test_left_forces),
        cmocka_unit_test(test_twist),
        cmocka_unit_test(test_swing),
        cmocka_unit_test(test_lost_grasp),
        cmocka_unit_test(test_coarse_mesh),
        cmocka_unit_test(test_inverted_mesh),
        cmocka_unit_test(test_energy_appears),
        cmocka_unit_test(test_energy_of_supports),
        cmocka_unit_test(test_energy_of_sweeps),
        cmocka_unit_test(test_energy_of_rest),
        cmocka_unit_test(test_short_run),
        cmocka_unit_test(test_sudden_load),
        cmocka_unit_test(test_grasp_empty),
        cmocka_unit_test(test_close_start),
        cmocka_unit_test(test_open_seam),
        cmocka_unit_test(test_idle_tool),
        cmocka_unit_test(test_giving_net),
        cmocka_unit_test(test_pinned_under_tool),
        cmocka_unit_test(test_held_in_place),
        cmocka_unit_test(test_carried),
        cmocka_unit_test(test_coarse_contact),
        cmocka_unit_test(test_unsettled),
        cmocka_unit_test(test_restless),
        cmocka_unit_test(test_tallies),
        cmocka_unit_test(test_frames),
        cmocka_unit_test(test_jam),
        cmocka_unit_test(test_fault_of_jam),
        cmocka_unit_test(test_every_kind_has_a_text),
    };
    int failures = is_all() ? cmocka_run_group_tests(tests, one_thread, clear_folder) : 0;
    return failures + cmocka_run_group_tests(tests, two_threads, clear_folder);
}
