/* Warnings about bodies: their size, material and filling, and whether anything acts on them. */
#define _XOPEN_SOURCE 700 /* nftw */
#include "run/state.h"
#include "run/warned.h"
#include "run/warnings_bodies.h"

static void test_millimetres(void **unused)
{
    (void)unused;
    static const char large[] =
        "version: 1\nbodies: [{ mesh: { shape: geodesic-sphere, frequency: 1, radius: 50 } }]\nduration: 1\n";
    const char *overrides[] = {"bodies.0.mesh.scale=0.001"};
    pel_run_summary summary;
    run_scene(large, NULL, 0, NULL, 1, &summary);
    assert_non_null(find_warning(&summary, "millimetres"));
    run_scene(large, overrides, 1, NULL, 1, &summary);
    assert_null(find_warning(&summary, "millimetres"));
    /* an organ of 9 m is none, a ball of 4 m may be a number without unit */
    overrides[0] = "bodies.0.mesh.scale=0.1";
    run_scene(large, overrides, 1, NULL, 1, &summary);
    assert_non_null(find_warning(&summary, "millimetres"));
    overrides[0] = "bodies.0.mesh.scale=0.02";
    run_scene(large, overrides, 1, NULL, 1, &summary);
    assert_null(find_warning(&summary, "millimetres"));
    /* a thick shell may be large; one of rubber and a thin one as large are doubtful */
    const char *shell[] = {"bodies.0.mesh.radius=50", "bodies.0.membrane={ young: 3e10, thickness: 0.1 }",
                           "solver.method=pbd"};
    run_scene(SHELL, shell, 3, NULL, 1, &summary);
    assert_null(find_warning(&summary, "millimetres"));
    shell[1] = "bodies.0.membrane={ young: 1e6, thickness: 0.1 }";
    run_scene(SHELL, shell, 3, NULL, 1, &summary);
    assert_non_null(find_warning(&summary, "millimetres"));
    shell[1] = "bodies.0.membrane={ young: 3e10, thickness: 0.001 }";
    run_scene(SHELL, shell, 3, NULL, 1, &summary);
    assert_non_null(find_warning(&summary, "millimetres"));
    /* the capsule of a lens of 9 m, and a weather balloon as large */
    shell[0] = "bodies.0.mesh.radius=4.5";
    shell[1] = "bodies.0.membrane={ preset: lens-capsule }";
    run_scene(SHELL, shell, 3, NULL, 1, &summary);
    assert_non_null(strstr(find_warning(&summary, "millimetres")->text, "and its shell 1.5e-05 m thick"));
    shell[1] = "bodies.0.membrane={ young: 1e8, thickness: 5e-5 }";
    run_scene(SHELL, shell, 3, NULL, 1, &summary);
    assert_null(find_warning(&summary, "millimetres"));
    /* a thickness in millimetres beside a size in metres */
    shell[0] = "bodies.0.mesh.radius=0.05";
    shell[1] = "bodies.0.membrane={ young: 1e6, thickness: 0.3 }";
    run_scene(SHELL, shell, 3, NULL, 1, &summary);
    assert_non_null(strstr(find_warning(&summary, "millimetres")->text, "thickness: 0.0003"));
    shell[1] = "bodies.0.membrane={ young: 1e6, thickness: 0.01 }";
    run_scene(SHELL, shell, 3, NULL, 1, &summary);
    assert_null(find_warning(&summary, "millimetres"));
}

static void test_poisson(void **unused)
{
    (void)unused;
    const char *shell[] = {"bodies.0.membrane={ material: stvk, young: 1e6, thickness: 0.001, poisson: 0.6 }",
                           "solver.method=pbd"};
    pel_run_summary summary;
    run_scene(SHELL, shell, 2, NULL, 1, &summary);
    const pel_run_warning *warning = find_warning(&summary, "poisson-above-half");
    assert_true(warning != NULL && warning->first_frame == 0);
    assert_non_null(strstr(warning->text, "Poisson's ratio of body 'ball' is 0.6"));
    shell[0] = "bodies.0.membrane={ material: stvk, young: 1e6, thickness: 0.001, poisson: 0.5 }";
    run_scene(SHELL, shell, 2, NULL, 1, &summary);
    assert_null(find_warning(&summary, "poisson-above-half"));
}

/* water in a balloon: the mass of the text gives its weight, and without gravity it has none */
static void test_weightless_filling(void **unused)
{
    (void)unused;
    const char *overrides[] = {"bodies.0.pressure={ volume: { target: 1, bulk: 1e5 } }", "gravity=[0, 0, -9.81]",
                               "solver.method=pbd", NULL};
    char mass[80];
    pel_run_summary summary;
    run_scene(SHELL, overrides, 3, NULL, 1, &summary);
    const pel_run_warning *warning = find_warning(&summary, "weightless-filling");
    assert_non_null(warning);
    const char *total = strstr(warning->text, "{ total: ");
    assert_non_null(total);
    double kilograms = strtod(total + strlen("{ total: "), NULL);
    /* of the ball and a skin of less than a tenth of that */
    assert_true(kilograms > 0.45 && kilograms < 0.6);
    snprintf(mass, sizeof mass, "bodies.0.mass={ total: %.5g }", kilograms);
    overrides[3] = mass;
    run_scene(SHELL, overrides, 4, NULL, 1, &summary);
    assert_null(find_warning(&summary, "weightless-filling"));
    overrides[1] = "gravity=[0, 0, 0]";
    run_scene(SHELL, overrides, 3, NULL, 1, &summary);
    assert_null(find_warning(&summary, "weightless-filling"));
    /* defaults of organs fill them, and so does fat */
    const char *masses[] = {"bodies.0.mass.density=1000", "bodies.0.mass.density=900"};
    for (int i = 0; i < 2; i++) {
        run_scene("version: 1\nbodies: [{ name: cube, mesh: { shape: box, size_x: 0.1, size_y: 0.1, size_z: 0.1 } }]\n"
                  "gravity: [0, 0, -9.81]\nstop: { frames: 2 }\n",
                  &masses[i], 1, NULL, 0, &summary);
        assert_null(find_warning(&summary, "weightless-filling"));
    }
}

/* an organ without filling collapses on a table; each remedy of the text keeps it up */
static void test_hollow(void **unused)
{
    (void)unused;
    skip_if_slow();
    static const char organ[] =
        "version: 1\nbodies: [{ name: organ, mesh: { shape: geodesic-sphere, frequency: 5, radius: 0.05 }, springs: {} "
        "}]\n"
        "tools: [{ name: table, shape: box, size: [1, 1, 0.1], motion: [{ position: [0, 0, -0.101] }] }]\n"
        "gravity: [0, 0, -9.81]\ncontact: {}\nduration: 0.3\noutput: { every: 0.02 }\n";
    const char *const remedies[] = {"bodies.0.volumetric={}", "bodies.0.pressure={ volume: { target: 1, bulk: 1e5 } }"};
    pel_run_summary summary;
    run_scene(organ, NULL, 0, NULL, 0, &summary);
    const pel_run_warning *warning = find_warning(&summary, "hollow-body");
    assert_true(warning != NULL && warning->first_frame > 0);
    assert_non_null(strstr(warning->text, "nothing fills body 'organ'"));
    assert_true(summary.volume_ratio_final < 0.7);
    for (int i = 0; i < 2; i++) {
        run_scene(organ, &remedies[i], 1, NULL, 0, &summary);
        assert_null(find_warning(&summary, "hollow-body"));
        assert_true(summary.volume_ratio_final > 0.9);
    }
}

/* a ball that falls past all of the scene, and the same ball above a table or thrown on purpose */
static void test_falls_away(void **unused)
{
    (void)unused;
    const char *overrides[] = {"gravity=[0, 0, -9.81]",      "stop={ time: 0.6 }",
                               "output.every_frame=100",     "solver={ method: pbd, dt: 0.01 }",
                               "bodies.0.pressure.inside=0", NULL};
    pel_run_summary summary;
    run_scene(SHELL, overrides, 5, NULL, 0, &summary);
    const pel_run_warning *warning = find_warning(&summary, "falls-away");
    assert_non_null(warning);
    const char *way = strstr(warning->text, "body 'ball' fell ");
    assert_non_null(way);
    assert_near(strtod(way + strlen("body 'ball' fell "), NULL), 9.81 * 0.36 / 2, 0.1);
    overrides[5] = "bodies.0.velocity=[0, 0, -1]";
    run_scene(SHELL, overrides, 6, NULL, 0, &summary);
    assert_null(find_warning(&summary, "falls-away"));
    overrides[5] = "tools=[{ name: table, shape: box, size: [1, 1, 0.1], motion: [{ position: [0, 0, -0.11] }] }]";
    run_scene(SHELL, overrides, 6, NULL, 0, &summary);
    assert_null(find_warning(&summary, "falls-away"));
    /* one that it misses, in a scene of 0.5 m */
    overrides[5] =
        "tools=[{ name: table, shape: box, size: [0.1, 0.1, 0.1], motion: [{ position: [0.4, 0, -0.11] }] }]";
    run_scene(SHELL, overrides, 6, NULL, 0, &summary);
    assert_non_null(find_warning(&summary, "falls-away"));
}

/* a ball that rolls a long way on a floor, or down a ramp, lies on it; past the end of the ramp it falls */
static void test_rolls_far(void **unused)
{
    (void)unused;
    static const char *const grounds[] = {
        "tools=[{ name: floor, shape: box, size: [20, 1, 0.1], motion: [{ position: [0, 0, -0.0702] }] }]",
        "tools=[{ name: ramp, shape: box, size: [20, 1, 0.1], motion: [{ position: [-0.0351, 0, -0.0608], rotation: "
        "{ axis: [0, 1, 0], angle: 30 } }] }]",
        "tools=[{ name: ramp, shape: box, size: [0.5, 1, 0.1], motion: [{ position: [-0.0351, 0, -0.0608], rotation: "
        "{ axis: [0, 1, 0], angle: 30 } }] }]"};
    static const char ball[] =
        "version: 1\nbodies: [{ name: ball, mesh: { shape: geodesic-sphere, frequency: 2, radius: 0.02 }, rigid: { "
        "sphere: true } }]\ngravity: [0, 0, -9.81]\ncontact: { friction: 0.5 }\nduration: 1\nloads: [{ force: [0.4, "
        "0, 0] }]\n";
    pel_run_summary summary;
    for (int i = 0; i < 3; i++) {
        run_scene(ball, &grounds[i], 1, NULL, 0, &summary);
        assert_true(summary.max_displacement > 1);
        assert_int_equal(find_warning(&summary, "falls-away") != NULL, i == 2);
    }
}

/* a box that starts on the floor itself is lifted by the layer, and no energy is told */
static void test_lies_at_start(void **unused)
{
    (void)unused;
    static const char box[] =
        "version: 1\nbodies: [{ name: box, mesh: { shape: box, size_x: 0.1, size_y: 0.1, size_z: 0.1, translate: [0, "
        "0, "
        "0.05] }, rigid: {} }]\ntools: [{ name: floor, shape: box, size: [1, 1, 0.1], motion: [{ position: [0, 0, "
        "-0.05] }] }]\ngravity: [0, 0, -9.81]\nduration: 0.3\n";
    static const char *const methods[] = {"solver.method=xpbd", "solver.method=implicit", "solver.method=explicit"};
    pel_run_summary summary;
    for (int i = 0; i < 3; i++) {
        run_scene(box, &methods[i], 1, NULL, 0, &summary);
        assert_true(summary.max_displacement > 1e-6 && summary.max_displacement < 1e-4);
        assert_null(find_warning(&summary, "energy-appears"));
    }
}

/* a load that does not end, on a body that nothing holds; a kick sends it as far on purpose */
static void test_pushed_away(void **unused)
{
    (void)unused;
    const char *overrides[] = {"loads=[{ force: [0.5, 0, 0] }]", "stop={ time: 0.6 }", "output.every_frame=100",
                               "solver={ method: pbd, dt: 0.01 }", "bodies.0.pressure.inside=0"};
    pel_run_summary summary;
    run_scene(SHELL, overrides, 5, NULL, 0, &summary);
    const pel_run_warning *warning = find_warning(&summary, "falls-away");
    assert_non_null(warning);
    assert_non_null(strstr(warning->text, "body 'ball' was pushed 3."));
    overrides[0] = "loads=[{ force: [2, 0, 0], until: 0.05 }]";
    run_scene(SHELL, overrides, 5, NULL, 0, &summary);
    assert_null(find_warning(&summary, "falls-away"));
}

/* a scene in which nothing acts is told, not its rounding; so is a load that begins after the end */
static void test_nothing_acts(void **unused)
{
    (void)unused;
    static const char ball[] = "version: 1\nbodies: [{ name: ball, mesh: { shape: geodesic-sphere, frequency: 4, "
                               "radius: 1, translate: [30, 40, 50] }, volumetric: {} }]\nduration: 0.1\n";
    const char *late = "loads=[{ name: push, force: [1, 0, 0], from: 3 }]", *gravity = "gravity=[0, 0, -0.001]";
    pel_run_summary summary;
    run_scene(ball, NULL, 0, NULL, 0, &summary);
    assert_int_equal(summary.warning_count, 1);
    const pel_run_warning *warning = find_warning(&summary, "nothing-acts");
    assert_non_null(warning);
    assert_non_null(strstr(warning->text, "add gravity, a load"));
    run_scene(ball, &late, 1, NULL, 0, &summary);
    warning = find_warning(&summary, "nothing-acts");
    assert_non_null(warning);
    assert_non_null(strstr(warning->text, "load 'push' begins at t = 3 s, and the run ends at 0.1 s"));
    run_scene(ball, &gravity, 1, NULL, 0, &summary);
    assert_null(find_warning(&summary, "nothing-acts"));
    /* energies of solids are rounded by their stiffness, and shells at rest do not vibrate */
    const char *kinds[] = {"bodies.0.volume={ young: 1e4 }", "bodies.0.membrane={ preset: rubber }"};
    for (int i = 0; i < 2; i++) {
        run_scene("version: 1\nbodies: [{ name: ball, mesh: { shape: geodesic-sphere, frequency: 4, radius: 0.1 } }]\n"
                  "duration: 0.2\n",
                  &kinds[i], 1, NULL, 0, &summary);
        assert_int_equal(summary.warning_count, 1);
        assert_non_null(find_warning(&summary, "nothing-acts"));
    }
    /* a cut acts, though nothing moves */
    static const char sheet[] = "version: 1\nbodies: [{ name: sheet, mesh: { shape: grid, nx: 8, ny: 8 }, membrane: { "
                                "preset: rubber }, pinned: boundary }]\nduration: 0.02\n";
    const char *cut = "cuts=[{ at: 0, path: [[-0.3, 0, 0], [0.3, 0, 0]] }]";
    run_scene(sheet, NULL, 0, NULL, 0, &summary);
    assert_non_null(find_warning(&summary, "nothing-acts"));
    run_scene(sheet, &cut, 1, NULL, 0, &summary);
    assert_null(find_warning(&summary, "nothing-acts"));
    /* a liquid needs gravity */
    static const char tub[] = "version: 1\nbodies: [{ name: tub, mesh: { shape: grid }, membrane: { preset: rubber }, "
                              "pinned: boundary, fluid: { level: 0.5 } }]\nduration: 0.02\n";
    run_scene(tub, NULL, 0, NULL, 0, &summary);
    warning = find_warning(&summary, "nothing-acts");
    assert_non_null(warning);
    assert_non_null(strstr(warning->text, "fluid of body 'tub' presses by its weight"));
    run_scene(tub, &gravity, 1, NULL, 0, &summary);
    assert_null(find_warning(&summary, "nothing-acts"));
}

/* a sheet folded through itself, beside another body: contact between bodies does not keep it apart */
static void test_folds_cross(void **unused)
{
    (void)unused;
    static const char *const texts[] = {"", "contact: { self: false }\n"};
    for (int i = 0; i < 2; i++) {
        char scene[1200];
        snprintf(
            scene, sizeof scene,
            "version: 1\nbodies:\n  - { name: strip, mesh: { shape: grid, nx: 12, ny: 2, size_x: 1, size_y: 0.2 }, "
            "membrane: { preset: rubber }, mass: { density: 300 }, bending: { model: none }, pinned: boundary }\n"
            "  - { name: far, mesh: { shape: grid, nx: 2, ny: 2, translate: [0, 0, 9] }, membrane: { preset: rubber "
            "}, pinned: boundary }\n"
            "loads: [{ name: fold, body: strip, force: [2000, 0, 0], at: { nearest: [-0.2, 0, 0] }, from: 0, until: 1 "
            "}]\n"
            "%ssolver: { method: implicit, dt: 0.01 }\nduration: 0.2\n",
            texts[i]);
        pel_run_summary summary;
        run_scene(scene, NULL, 0, NULL, 0, &summary);
        assert_true(summary.self_intersections_final > 0);
        const pel_run_warning *warning = find_warning(&summary, "surfaces-cross");
        if (i == 0)
            assert_true(warning != NULL && strstr(warning->text, "parts of one body") != NULL);
        else
            assert_null(warning);
    }
}

/* sheets through each other, which nothing keeps apart */
static void test_surfaces_cross(void **unused)
{
    (void)unused;
    static const char sheets[] =
        "version: 1\nbodies:\n  - { name: a, mesh: { shape: grid, nx: 4, ny: 4 }, membrane: { preset: rubber } }\n"
        "  - { name: b, mesh: { shape: grid, nx: 3, ny: 3, rotate: { axis: [1, 0, 0], angle: 90 } }, membrane: { "
        "preset: rubber } }\nsolver: { method: implicit, dt: 0.01 }\nduration: 0.02\n";
    const char *apart = "bodies.b.mesh.translate=[0, 0, 2]", *modes = "solver={ analysis: modal, modes: 1 }";
    pel_run_summary summary;
    run_scene(sheets, NULL, 0, NULL, 0, &summary);
    const pel_run_warning *warning = find_warning(&summary, "surfaces-cross");
    assert_true(warning != NULL && strstr(warning->text, "contact: { self: true }") != NULL);
    run_scene(sheets, &apart, 1, NULL, 0, &summary);
    assert_null(find_warning(&summary, "surfaces-cross"));
    run_scene(sheets, &modes, 1, NULL, 0, &summary);
    assert_null(find_warning(&summary, "surfaces-cross"));
}

/* two hooks of which one is too weak; the count and the force are kept in checkpoints */
static void test_lost_tie(void **unused)
{
    (void)unused;
    const char *text = "version: 1\nbodies:\n  - name: cloth\n"
                       "    mesh: { shape: grid, nx: 6, ny: 6, size_x: 0.3, size_y: 0.3 }\n"
                       "    membrane: { young: 1e5, thickness: 0.0005 }\n    mass: { density: 400 }\n"
                       "attachments:\n"
                       "  - { name: weak, body: cloth, at: { vertices: [42, 43] }, strength: 0.02 }\n"
                       "  - { name: strong, body: cloth, at: { vertices: [48] }, strength: 50 }\n"
                       "gravity: [0, 0, -9.81]\nsolver: { method: implicit, dt: 0.01 }\n"
                       "duration: 0.4\noutput: { every: 0.1 }\n";
    const char *firm[] = {"attachments.0.strength=50"};
    pel_run_summary summary;
    run_scene(text, NULL, 0, NULL, 0, &summary);
    const pel_run_warning *warning = find_warning(&summary, "tie-lost");
    assert_non_null(warning);
    const pel_run_warning whole = *warning;
    const char *force = strstr(whole.text, " s under ");
    assert_non_null(strstr(whole.text, "attachment 'weak' let 2 of 2 vertices go, the first at t = 0."));
    assert_non_null(force);
    assert_true(strtod(force + strlen(" s under "), NULL) > 0.02 && strtod(force + strlen(" s under "), NULL) < 1);
    assert_non_null(strstr(whole.text, " N, more than its strength of 0.02 N. "));
    assert_true(warning->count == 1 || warning->count == 2);
    run_scene(text, NULL, 0, NULL, 2, &summary);
    run_scene(text, NULL, 0, "checkpoint", 0, &summary);
    warning = find_warning(&summary, "tie-lost");
    assert_true(warning->first_frame == whole.first_frame && warning->count == whole.count);
    assert_string_equal(warning->text, whole.text);
    run_scene(text, firm, 1, NULL, 0, &summary);
    assert_null(find_warning(&summary, "tie-lost"));
}

/* the same of an animation, whose remedy is a key of the body */
static void test_lost_follow(void **unused)
{
    (void)unused;
    char text[1000], frames[256], pattern[256];
    snprintf(text, sizeof text,
             "version: 1\nbodies:\n  - name: cloth\n    mesh: { file: '%s' }\n"
             "    membrane: { young: 1e5, thickness: 0.0005 }\n    mass: { density: 400 }\n"
             "    follow: { file: '%s*.obj', at: { vertices: [0] }, strength: 1e-4 }\n"
             "gravity: [0, 0, -9.81]\nsolver: { method: implicit, dt: 0.01 }\nduration: 0.1\n",
             in_folder(frames, ".", "still.obj"), in_folder(pattern, ".", "still"));
    static const char still[] = "v 0 0 0\nv 0.1 0 0\nv 0.1 0.1 0\nv 0 0.1 0\nf 1 2 3\nf 1 3 4\n";
    FILE *file = fopen(frames, "w");
    assert_non_null(file);
    assert_true(fputs(still, file) >= 0 && fclose(file) == 0);
    pel_run_summary summary;
    run_scene(text, NULL, 0, NULL, 0, &summary);
    const pel_run_warning *warning = find_warning(&summary, "grasp-lost");
    assert_non_null(warning);
    assert_non_null(strstr(warning->text, "the animation 'cloth_follow' let 1 vertices go at t = 0."));
    assert_non_null(strstr(warning->text, "exceeded 0.0001 N, its strength. "));
    assert_non_null(strstr(warning->text, "raise bodies.cloth.follow.strength"));
}

static int two_threads(void **unused)
{
    (void)unused;
    thread_count = 2;
    return make_folder(NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_millimetres),        cmocka_unit_test(test_poisson),
        cmocka_unit_test(test_weightless_filling), cmocka_unit_test(test_hollow),
        cmocka_unit_test(test_falls_away),         cmocka_unit_test(test_pushed_away),
        cmocka_unit_test(test_rolls_far),          cmocka_unit_test(test_lies_at_start),
        cmocka_unit_test(test_nothing_acts),       cmocka_unit_test(test_surfaces_cross),
        cmocka_unit_test(test_folds_cross),        cmocka_unit_test(test_lost_tie),
        cmocka_unit_test(test_lost_follow),
    };
    return cmocka_run_group_tests(tests, two_threads, clear_folder);
}
