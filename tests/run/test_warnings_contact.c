/* Warnings about tools: blades that open less than they pass, before the first step; energy that contact must not make;
   tools that contact holds back. */
#define _XOPEN_SOURCE 700 /* nftw */
#include "pellicle/frames.h"
#include "run/warned.h"
#include "run/warnings_contact.h"

/* a knife at 0.45 m/s in a sheet with edges of about 7.6 mm */
#define KNIFE(sharpness)                                                                                               \
    "version: 1\nbodies: [ { name: sheet, mesh: { shape: grid, nx: 15, ny: 9, size_x: 0.1, size_y: 0.06 }, membrane: " \
    "{ young: 1.0e6, thickness: 0.001 }, pinned: boundary } ]\ntools: [ { name: knife, shape: blade, edge: [[0, 0, "   \
    "-0.01], [0, 0, 0.01]]" sharpness ", motion: [{ position: [-0.06, 0.001, 0] }, { time: 0.2, position: [0.03, "     \
    "0.001, 0] }] } ]\nsolver: { method: implicit, dt: 0.01 }\nduration: 0.02\n"

static const pel_run_warning *fast(const char *text, const char *change, pel_run_summary *summary)
{
    run_scene(text, &change, change != NULL, NULL, 1, summary);
    return find_warning(summary, "fast-blade");
}

static void test_fast_blade(void **unused)
{
    (void)unused;
    pel_run_summary summary;
    double edges, dt;
    char change[60];
    const pel_run_warning *warning = fast(KNIFE(", sharpness: 300"), NULL, &summary);
    assert_true(warning != NULL && warning->first_frame == 0);
    assert_non_null(strstr(warning->text, "blade 'knife' moves by "));
    assert_int_equal(sscanf(strstr(warning->text, "moves by"), "moves by %lf edges", &edges), 1);
    assert_near(edges, 0.45 * 0.01 / 0.0076, 0.02);
    /* the step that it names, and a blade without a force */
    assert_int_equal(sscanf(strstr(warning->text, "{ dt:"), "{ dt: %lf }", &dt), 1);
    snprintf(change, sizeof change, "solver.dt=%g", dt);
    assert_null(fast(KNIFE(", sharpness: 300"), change, &summary));
    assert_null(fast(KNIFE(""), NULL, &summary));
}

/* A blade whose sharpness is low for its sheet makes no energy: its force stays at its limit in short steps. The error
   of the ledger is a sawtooth of one edge, 0.9 mJ, since an edge opens as a whole; the end is between two of them. */
static void test_low_sharpness(void **unused)
{
    (void)unused;
    const char *const methods[] = {"solver={ method: implicit, dt: 0.001 }", "solver={ method: static, dt: 0.001 }"};
    for (int m = 0; m < 2; m++) {
        const char *changes[] = {methods[m], "bodies.0.mesh.nx=30", "bodies.0.mesh.ny=18", "duration=0.058"};
        pel_run_summary summary;
        run_scene(KNIFE(", sharpness: 300"), changes, 4, NULL, 1, &summary);
        assert_null(find_warning(&summary, "energy-appears"));
    }
}

/* A stiff sheet thrown at the corner of a cube, at four places. The straight way of a step cuts the corner although the
   substeps went around it: corrections that moved the sheet off that way made .13 to 1.5 of its energy. */
static void test_sheet_over_corner(void **unused)
{
    (void)unused;
    static const char *const places[] = {"0.012, 0.007", "0.005, 0.003", "0.02, 0.011", "-0.013, 0.004"};
    for (int i = 0; i < 4; i++) {
        char text[900];
        pel_run_summary summary;
        snprintf(text, sizeof text,
                 "version: 1\nbodies: [ { name: sheet, mesh: { shape: grid, nx: 10, ny: 10, size_x: 0.1, size_y: 0.1, "
                 "translate: [%s, 0.04] }, membrane: { young: 1.0e6, thickness: 0.0005 }, mass: { density: 300 }, "
                 "velocity: [1, 0, -0.3] } ]\ntools: [ { name: corner, mesh: { shape: box, size_x: 0.04, size_y: 0.04, "
                 "size_z: 0.04, nx: 1, ny: 1, nz: 1, rotate: { axis: [1, -1, 0], angle: 54.7 } }, motion: [ { "
                 "position: [0, 0, 0] } ] } ]\ngravity: [0, 0, -9.81]\ncontact: { friction: 0.1 }\nduration: "
                 "0.08\noutput: { every: 0.01 }\n",
                 places[i]);
        run_scene(text, NULL, 0, NULL, 0, &summary);
        assert_null(find_warning(&summary, "energy-appears"));
        assert_int_equal(summary.self_intersections_final, 0);
    }
}

/* Two shells at 10 m/s each: pairs that are found within a step, nearer than the guard permits, are corrected to where
   it lets them be, so that it steps back nothing. */
static void test_found_too_near(void **unused)
{
    (void)unused;
    pel_run_summary summary;
    run_scene(
        "version: 1\nbodies:\n"
        "  - { name: a, mesh: { shape: geodesic-sphere, frequency: 6, radius: 0.05, translate: [-0.07, 0.02, 0] }, "
        "mass: { total: 0.1 }, membrane: { young: 1.0e7, thickness: 0.003 }, velocity: [10, 0, 0] }\n"
        "  - { name: b, mesh: { shape: geodesic-sphere, frequency: 6, radius: 0.05, translate: [0.07, -0.02, 0] }, "
        "mass: { total: 0.1 }, membrane: { young: 1.0e7, thickness: 0.003 }, velocity: [-10, 0, 0] }\n"
        "contact: {}\nduration: 0.03\noutput: { every: 0.001, fields: [velocity] }\n",
        NULL, 0, NULL, 0, &summary);
    assert_int_equal(summary.self_intersections_final, 0);
    check_contains("warned", "summary.json", "\"fall_backs\": 0,");
}

/* Lips of a cut that has not opened lie on each other, which crosses nothing; a flap between three sides of a cut that
   is bent through the sheet does. */
static void test_lips_of_a_cut(void **unused)
{
    (void)unused;
    static const char *const cuts[] = {"[0, -0.02, 0], [0, 0.02, 0]", "[-0.02, -0.02, 0], [0.02, 0.02, 0]",
                                       "[-0.01, -0.02, 0], [0.02, -0.02, 0], [0.02, 0.02, 0], [-0.01, 0.02, 0]"};
    for (int i = 0; i < 4; i++) {
        char text[900];
        pel_run_summary summary;
        snprintf(
            text, sizeof text,
            "version: 1\nbodies: [ { name: sheet, mesh: { shape: grid, nx: 20, ny: 20, size_x: 0.1, size_y: 0.1 }, "
            "membrane: { preset: rubber, thickness: 0.001 }, bending: { model: none }, pinned: boundary } ]\n"
            "cuts: [ { at: 0.02, path: [ %s ] }%s ]\n%ssolver: { method: implicit, dt: 0.01 }\nduration: 0.3\n",
            cuts[i < 2 ? i : 2], i == 1 ? ", { at: 0.05, path: [ [0.02, -0.02, 0], [-0.02, 0.02, 0] ] }" : "",
            i == 3 ? "loads: [ { name: tweezers, force: [-0.5, 0, 0], at: { sphere: { center: [0.018, 0, 0], "
                     "radius: 0.004 } }, from: 0.05 } ]\n"
                   : "");
        run_scene(text, NULL, 0, NULL, 0, &summary);
        assert_int_equal(summary.self_intersections_final > 0, i == 3);
        assert_int_equal(find_warning(&summary, "surfaces-cross") != NULL, i == 3);
    }
}

/* a plate that presses a ball on another one by its keys, which lead it beyond both */
#define PRESS(keys)                                                                                                    \
    "version: 1\nbodies: [ { name: ball, mesh: { shape: geodesic-sphere, frequency: 1, radius: 0.05 }, membrane: { "   \
    "young: 1.0e6, thickness: 0.002 } } ]\ntools:\n"                                                                   \
    "  - { name: floor, shape: box, size: [0.3, 0.3, 0.02], motion: [ { position: [0, 0, -0.0605] } ] }\n"             \
    "  - { name: press, shape: box, size: [0.3, 0.3, 0.02], motion: [ { position: [0, 0, 0.0605] }, " keys " ] }\n"    \
    "contact: {}\nsolver: { dt: 0.01 }\n"

#define DOWN "{ time: 0.05, position: [0, 0, -0.09] }"

static const pel_run_warning *held(const char *text, pel_run_summary *summary)
{
    run_scene(text, NULL, 0, NULL, 0, summary);
    const pel_run_warning *warning = find_warning(summary, "tool-held-back");
    assert_non_null(warning);
    assert_non_null(strstr(warning->text, "tool 'press' was held back in "));
    return warning;
}

/* A ball that has pressed a sheet on a table deeper than there is room for goes up with its keys: what comes after it
   stays, not the ball (which kept its 244 N until the end of the run). */
static void test_leaves_jam(void **unused)
{
    (void)unused;
    pel_run_summary summary;
    const pel_run_warning *warning = held(
        "version: 1\ngravity: [0, 0, -9.81]\nbodies: [ { name: sheet, mesh: { shape: grid, nx: 10, ny: 10, size_x: "
        "0.1, size_y: 0.1, translate: [0, 0, 0.0006] }, membrane: { preset: paper, young: 3.0e6 } } ]\ntools:\n"
        "  - { name: press, shape: sphere, radius: 0.01, motion: [ { position: [0, 0, 0.014] }, { time: 0.1, "
        "position: [0, 0, 0.009] }, { time: 0.2, position: [0, 0, 0.014] } ] }\n"
        "  - { name: table, shape: box, size: [0.5, 0.5, 0.1], motion: [ { position: [0, 0, -0.05] } ] }\n"
        "contact: { friction: 0.3 }\nsolver: { method: xpbd, dt: 0.005 }\nduration: 0.22\n",
        &summary);
    assert_non_null(strstr(warning->text, "it caught up with its keys"));
    assert_true(summary.ledger.elastic < 1e-6 && summary.self_intersections_final == 0);
}

/* what to do depends on where a tool that was held back ends: away from its keys, at them, or within pinned vertices */
static void test_held_back(void **unused)
{
    (void)unused;
    static const char *const column = "press_z";
    char path[256];
    double lag;
    pel_run_summary summary;
    pel_series *series;
    const pel_run_warning *warning = held(PRESS(DOWN) "duration: 0.05\n", &summary);
    const char *ends = strstr(warning->text, "it ends ");
    assert_non_null(ends);
    assert_int_equal(sscanf(ends, "it ends %lf m away", &lag), 1);
    assert_int_equal(pel_series_read(in_folder(path, "warned", "series.csv"), &column, 1, &series, NULL), PEL_OK);
    assert_near(lag, pel_series_value(series, 0, series->row_count - 1) + 0.09, 5e-3 * lag);
    assert_true(lag > 0.03);
    pel_series_destroy(series);
    warning = held(PRESS(DOWN ", { time: 0.1, position: [0, 0, 0.0605] }") "duration: 0.12\n", &summary);
    assert_non_null(strstr(warning->text, "it caught up with its keys"));
    warning =
        held("version: 1\nbodies: [ { name: stone, mesh: { shape: geodesic-sphere, frequency: 3, radius: 0.05 }, "
             "membrane: { young: 1.0e6, thickness: 0.002 }, pinned: all } ]\ntools: [ { name: press, shape: "
             "sphere, radius: 0.02, motion: [ { position: [0, 0, 0.08] }, { time: 0.1, position: [0, 0, 0.05] } ] "
             "} ]\ncontact: {}\nsolver: { dt: 0.01 }\nduration: 0.1\n",
             &summary);
    assert_non_null(strstr(warning->text, "vertices of body 'stone' that are all pinned"));
    /* the rim that stopped it, though its keys lead on among vertices that are free */
    warning = held("version: 1\nbodies: [ { name: pipe, mesh: { shape: cylinder, radius: 0.04, height: 0.1, capped: "
                   "false }, membrane: { young: 1.0e6, thickness: 0.001 }, pinned: { plane: { point: [0, 0, 0.049], "
                   "normal: [0, 0, 1] } } } ]\ntools: [ { name: press, shape: sphere, radius: 0.05, motion: [ { "
                   "position: [0, 0, 0.1] }, { time: 0.1, position: [0, 0, 0] } ] } ]\ncontact: {}\nsolver: { dt: "
                   "0.01 }\nduration: 0.1\n",
                   &summary);
    assert_non_null(strstr(warning->text, "vertices of body 'pipe' that are all pinned"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_fast_blade),        cmocka_unit_test(test_low_sharpness),
                                       cmocka_unit_test(test_sheet_over_corner), cmocka_unit_test(test_found_too_near),
                                       cmocka_unit_test(test_lips_of_a_cut),     cmocka_unit_test(test_held_back),
                                       cmocka_unit_test(test_leaves_jam)};
    return cmocka_run_group_tests(tests, make_folder, clear_folder);
}
