/* Runs of all methods that are stopped in the middle and continued: run/stops.h. */
#include "run/stops.h"

/* two bodies that touch, one of which refines, under a tool that presses, a box that turns and a clamp that loses hold
 */
static const char crowd[] =
    "version: 1\n"
    "bodies:\n"
    "  - { name: a, mesh: { shape: geodesic-sphere, frequency: 4 }, mass: { per_vertex: 1 }, scale_with_area: true,\n"
    "      volumetric: { stiffness: 1.5 }, refine: { levels: 1, near_tools: 0.1, dwell: 5 } }\n"
    "  - { name: b, mesh: { shape: geodesic-sphere, frequency: 3, translate: [0, 0, -2.02] },\n"
    "      mass: { per_vertex: 1 }, volumetric: { stiffness: { keys: [[0, 1.5], [0.3, 1]] } } }\n"
    "loads:\n"
    "  - { body: a, force: [0, 0, -4], from: 0.05, until: 0.3 }\n"
    "tools:\n"
    "  - { name: probe, shape: sphere, radius: 0.3,\n"
    "      motion: [{ position: [0, 0, 1.35] }, { time: 0.2, position: [0, 0, 1] },\n"
    "               { time: 0.4, position: [0, 0, 1.5] }] }\n"
    "  - { name: box, shape: box, size: [0.4, 0.4, 0.4],\n"
    "      motion: [{ position: [1.25, 0, 0] },\n"
    "               { time: 0.3, position: [1, 0, 0.1], rotation: { axis: [0, 1, 0], angle: 30 } }] }\n"
    "  - { name: clamp, shape: sphere, radius: 0.3, press: false,\n"
    "      grasp: { from: 0.05, until: 0.3, reach: 0.2, max_force: 2 },\n"
    "      motion: [{ position: [0, -1.2, -2] }, { time: 0.4, position: [0, -1.6, -1.8] }] }\n"
    "contact: { friction: 0.3 }\n"
    "solver: { method: quasi-static, dt: 0.01 }\n"
    "duration: 0.4\n"
    "output: { every_frame: 3, fields: [contact, velocity] }\n";

/* a shell that refines, with fibres that contract and a gas, between plates */
static const char shell[] =
    "version: 1\n"
    "bodies:\n"
    "  - { name: a, mesh: { shape: geodesic-sphere, frequency: 4, radius: 0.1 },\n"
    "      mass: { density: 1000, thickness: 0.002 }, membrane: { material: neo-hookean, young: 1.0e4 },\n"
    "      bending: { model: hinge }, pressure: { gas: { pressure: 1000 } },\n"
    "      anisotropy: { mode: active, stiffness: 1, rest_length: { keys: [[0, 1], [0.2, 0.8]] },\n"
    "                    region: { sphere: { center: [0, 0, 0.1], radius: 0.08 } } } }\n"
    "tools:\n"
    "  - { name: probe, mesh: { shape: geodesic-sphere, frequency: 2, radius: 0.025 },\n"
    "      motion: [{ position: [0, 0, 0.13] }, { time: 0.1, position: [0, 0, 0.11] }] }\n"
    "  - { name: low, shape: box, size: [0.4, 0.4, 0.02], motion: [{ position: [0, 0, -0.112] }] }\n"
    "contact: { friction: 0.3 }\n"
    "gravity: [0, 0, -9.81]\n"
    "solver: { method: xpbd, dt: 0.005 }\n"
    "duration: 0.15\n"
    "output: { every_frame: 4, fields: [contact, pressure] }\n";

static void check_methods(const char *text, const char *name, const char *const *overrides, int32_t count)
{
    for (int32_t i = 0; i < count; i += ROUNDS(1, 3)) {
        char run[64];
        const char *pair[2];
        snprintf(run, sizeof run, "%s-%d", name, (int)i);
        pair[0] = overrides[2 * i];
        pair[1] = overrides[2 * i + 1];
        pel_scene *scene = load_scene(text, pair, pair[1] != NULL ? 2 : 1);
        check_stops(scene, run, 0);
        pel_scene_destroy(scene);
    }
}

static void test_methods(void **unused)
{
    (void)unused;
    static const char *const crowds[][2] = {
        {"solver.method=quasi-static", NULL},
        {"solver.method=explicit", "contact.restitution=0.5"},
        {"solver.method=pbd", NULL},
        {"solver.method=pbd", "bodies.a.pressure={ outside: 30 }"},
        {"solver.method=pbd-distance", NULL},
        {"solver.method=xpbd", "solver.substeps=7"},
        {"solver={ method: descent, dt: 0.01, iterations: 4 }", "bodies.b.mesh.frequency=2"},
        {"contact.start=tangled", "bodies.b.mesh.translate=[0, 0, -1.95]"},
        {"solver.method=xpbd", "contact.method=bridson"}};
    static const char *const shells[][2] = {{"solver={ method: explicit, dt: 0.0004 }", "duration=0.06"},
                                            {"solver.method=pbd", NULL},
                                            {"solver.method=xpbd", NULL},
                                            {"solver={ method: descent, dt: 0.005, iterations: 10 }", NULL}};
    check_methods(crowd, "crowd", crowds[0], sizeof crowds / sizeof *crowds);
    check_methods(shell, "shell", shells[0], sizeof shells / sizeof *shells);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_methods)};
    thread_count = 1;
    return cmocka_run_group_tests(tests, make_folder, clear_folder);
}
