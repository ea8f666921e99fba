/* Warnings about shells: rows of vertices that are hinges, loads and modes that a mesh is too coarse for. */
#define _XOPEN_SOURCE 700 /* nftw */
#include "run/run_fixture.h"

static const char *const no_change[1];

/* the text of a warning of a run, or null */
static const char *warning_of(const char *text, const char *const *overrides, int32_t count, const char *code,
                              pel_run_summary *summary)
{
    pel_scene *scene = load_scene(text, overrides, count);
    pel_run_def def = pel_run_def_default();
    pel_error error;
    def.skip_intersections = true;
    pel_status status = pel_run(scene, &def, summary, &error);
    if (status != PEL_OK)
        print_error("%s\n", error.what);
    assert_int_equal(status, PEL_OK);
    pel_scene_destroy(scene);
    for (int32_t i = 0; i < summary->warning_count; i++)
        if (strcmp(summary->warnings[i].code, code) == 0)
            return summary->warnings[i].text;
    return NULL;
}

static bool warns(const char *text, const char *const *overrides, int32_t count, const char *code)
{
    pel_run_summary summary;
    return warning_of(text, overrides, count, code, &summary) != NULL;
}

/* a strip 0.5 m long of 4 mm of aluminium */
#define STRIP(held, more)                                                                                              \
    "version: 1\nbodies:\n  - name: shelf\n"                                                                           \
    "    mesh: { shape: grid, nx: 10, ny: 4, size_x: 0.5, size_y: 0.2 }\n"                                             \
    "    membrane: { young: 7.0e10, poisson: 0.3, thickness: 0.004 }\n"                                                \
    "    mass: { density: 2700 }\n    " held "\n" more
#define ROW "pinned: { box: { min: [-1, -1, -1], max: [-0.249, 1, 1] } }"
#define TWO_ROWS "pinned: { box: { min: [-1, -1, -1], max: [-0.199, 1, 1] } }"
#define CORNERS "pinned: { vertices: [0, 44] }"
#define CLAMP "supports: [ { at: { box: { min: [-1, -1, -1], max: [-0.249, 1, 1] } }, rotation: fixed } ]"
#define WEIGHT "gravity: [0, 0, -9.81]\n"
#define STATIC "solver: { method: static }\n"
#define SHORT "solver: { method: implicit, dt: 0.001 }\nstop: { frames: 2 }\noutput: { every_frame: 1 }\n"

static void test_hinge_row(void **unused)
{
    (void)unused;
    pel_run_summary summary;
    const char *text = warning_of(STRIP(ROW, WEIGHT STATIC), no_change, 0, "hinge-row", &summary);
    assert_true(text != NULL && strstr(text, "'shelf'") != NULL && strstr(text, "rotation: fixed") != NULL);
    /* under every method that knows the material, and by every kind of load */
    assert_true(warns(STRIP(ROW, WEIGHT SHORT), no_change, 0, "hinge-row"));
    const char *xpbd[] = {"solver={ method: xpbd, dt: 0.001 }", "bodies.0.membrane.young=7e6"};
    assert_true(warns(STRIP(ROW, SHORT "loads: [ { force: [0, 0, -1.0e-3] } ]\n"), xpbd, 2, "hinge-row"));
    assert_true(warns(STRIP(ROW "\n    pressure: { outside: 1 }", SHORT), no_change, 0, "hinge-row"));
}

/* a frequency of 0; not that of a body that is free, clamped, or held at two ends */
static void test_hinge_mode(void **unused)
{
    (void)unused;
    static const char modal[] = "solver: { analysis: modal, modes: 8 }\n";
    char held[400], free_body[400], clamped[400], both[500], rows[400];
    snprintf(held, sizeof held, STRIP(ROW, "%s"), modal);
    snprintf(free_body, sizeof free_body, STRIP("", "%s"), modal);
    snprintf(clamped, sizeof clamped, STRIP(CLAMP, "%s"), modal);
    snprintf(both, sizeof both,
             STRIP("supports: [ { at: { vertices: [0, 11, 22, 33, 44] } }, { at: { vertices: [10, "
                   "21, 32, 43, 54] } } ]",
                   "%s"),
             modal);
    const char *lowest[] = {"solver.modes=1"};
    assert_true(warns(held, no_change, 0, "hinge-row"));
    assert_true(warns(held, lowest, 1, "hinge-row"));
    assert_false(warns(clamped, lowest, 1, "hinge-row"));
    /* as far as a deflection, by two thirds: 3/2 of a ninth */
    pel_run_summary summary;
    snprintf(rows, sizeof rows, STRIP(TWO_ROWS, "%s"), modal);
    const char *text = warning_of(rows, lowest, 1, "hinge-row", &summary);
    assert_true(text != NULL && strstr(text, "about 11 % too slowly") != NULL);
    assert_false(warns(free_body, no_change, 0, "hinge-row"));
    assert_false(warns(clamped, no_change, 0, "hinge-row"));
    assert_false(warns(both, no_change, 0, "hinge-row"));
}

static void test_no_hinge_row(void **unused)
{
    (void)unused;
    const char *cloth[] = {"bodies.0.membrane={ young: 1e6, thickness: 0.0005 }"};
    const char *down[] = {"gravity=[9.81, 0, 0]"}, *up[] = {"gravity=[0, 9.81, 0]"};
    const char *none[] = {"bodies.0.bending={ model: none }"};
    assert_false(warns(STRIP(CLAMP, WEIGHT STATIC), no_change, 0, "hinge-row"));
    /* hung by two corners, not by a row */
    assert_false(warns(STRIP(CORNERS, WEIGHT SHORT), no_change, 0, "hinge-row"));
    /* a clamp could not hold it up, or nothing turns it */
    assert_false(warns(STRIP(ROW, WEIGHT SHORT), cloth, 1, "hinge-row"));
    assert_false(warns(STRIP(ROW, WEIGHT SHORT), none, 1, "hinge-row"));
    assert_false(warns(STRIP(ROW, WEIGHT SHORT), down, 1, "hinge-row"));
    assert_false(warns(STRIP(ROW, WEIGHT SHORT), up, 1, "hinge-row"));
    assert_false(warns(STRIP(ROW, SHORT), no_change, 0, "hinge-row"));
    /* another line beside the first */
    assert_false(warns(STRIP("pinned: boundary", WEIGHT STATIC), no_change, 0, "hinge-row"));
}

/* Two rows clamp half a cell behind the inner one: told with the error, up to cells that do not matter, and not of
   bending by hinges, nor beside a clamp. */
static void test_two_rows(void **unused)
{
    (void)unused;
    pel_run_summary summary;
    const char *fine[] = {"bodies.0.mesh.nx=80", "bodies.0.pinned={ box: { min: [-1, -1, -1], max: [-0.243, 1, 1] } }"};
    const char *hinges[] = {"bodies.0.bending={ model: hinge }"};
    const char *wide[] = {"bodies.0.pinned={ box: { min: [-1, -1, -1], max: [-0.099, 1, 1] } }"};
    const char *text = warning_of(STRIP(TWO_ROWS, WEIGHT STATIC), no_change, 0, "hinge-row", &summary);
    assert_true(text != NULL && strstr(text, "about 17 % too far") != NULL);
    text = warning_of(STRIP(TWO_ROWS, WEIGHT STATIC), wide, 1, "hinge-row", &summary);
    assert_true(text != NULL && strstr(text, "about 21 % too far") != NULL);
    assert_false(warns(STRIP(TWO_ROWS, WEIGHT STATIC), fine, 2, "hinge-row"));
    assert_false(warns(STRIP(TWO_ROWS, WEIGHT STATIC), hinges, 1, "hinge-row"));
    assert_false(warns(STRIP(TWO_ROWS "\n    " CLAMP, WEIGHT STATIC), no_change, 0, "hinge-row"));
}

/* a plate that hangs from its row, 20 degrees off, is a pendulum, whatever pushes it less than its weight holds */
static void test_pendulum(void **unused)
{
    (void)unused;
    const char *hangs[] = {"bodies.0.mesh.rotate={ axis: [0, 1, 0], angle: 70 }",
                           "bodies.0.pinned={ box: { min: [-1, -1, 0.2345], max: [1, 1, 1] } }",
                           "loads=[ { force: [3, 0, 0] } ]"};
    const char *flat[] = {"bodies.0.mesh.rotate={ axis: [0, 1, 0], angle: 20 }",
                          "bodies.0.pinned={ box: { min: [-1, -1, 0.085], max: [1, 1, 1] } }"};
    assert_false(warns(STRIP(ROW, WEIGHT SHORT), hangs, 2, "hinge-row"));
    /* nor does it only stay because it is symmetric: it has just begun to swing */
    assert_false(warns(STRIP(ROW, WEIGHT SHORT), hangs, 2, "unstable-balance"));
    /* it weighs 10.6 N, and at an end that is 20 degrees off a load of as much in the middle turns it to 45 degrees */
    assert_false(warns(STRIP(ROW, WEIGHT SHORT), hangs, 3, "hinge-row"));
    hangs[2] = "loads=[ { force: [15, 0, 0] } ]";
    assert_true(warns(STRIP(ROW, WEIGHT SHORT), hangs, 3, "hinge-row"));
    assert_true(warns(STRIP(ROW, WEIGHT SHORT), flat, 2, "hinge-row"));
}

#define BALLOON                                                                                                        \
    "version: 1\nbodies:\n  - name: balloon\n    mesh: { shape: geodesic-sphere, frequency: 4, radius: 0.1 }\n"        \
    "    membrane: { material: neo-hookean, young: 1.0e6, poisson: 0.5, thickness: 0.001 }\n"                          \
    "    pressure: { inside: { keys: [[0, 0], [100, 5000]] } }\n" SHORT

static void test_largest_pressure(void **unused)
{
    (void)unused;
    const char *less[] = {"bodies.0.pressure={ inside: { keys: [[0, 0], [100, 4000]] } }"},
               *stiff[] = {"bodies.0.membrane.material=stvk", "bodies.0.membrane.poisson=0.4"};
    const char *kept[] = {"bodies.0.pressure={ volume: { target: 9, bulk: 10 } }"};
    pel_run_summary summary;
    double times;
    const char *text = warning_of(BALLOON, no_change, 0, "largest-pressure", &summary);
    /* 2 mu h / R (1 / l - 1 / l^7) at l = 7^(1/6): 4.13 kPa */
    assert_true(text != NULL && strstr(text, "5000 Pa") != NULL && strstr(text, "about 41") != NULL);
    assert_non_null(strstr(text, "at 2.65 times its volume: beyond it grows without bound"));
    assert_false(warns(BALLOON, less, 1, "largest-pressure"));
    assert_false(warns(BALLOON, stiff, 2, "largest-pressure"));
    assert_false(warns(BALLOON, kept, 1, "largest-pressure"));
    /* rubber with two terms holds any pressure, but jumps there */
    const char *latex[] = {"bodies.0.membrane={ preset: latex-balloon, thickness: 0.001 }"};
    text = warning_of(BALLOON, latex, 1, "largest-pressure", &summary);
    assert_true(text != NULL && strstr(text, "jumps to a far larger size") != NULL);
    assert_int_equal(sscanf(strstr(text, " at "), " at %lf times its volume", &times), 1);
    assert_true(times > 2 && times < 5);
    /* 0.95 of the largest at once: it swings past it; grown in time, as the text has it, it stays */
    const char *sudden[] = {"bodies.0.membrane={ preset: latex-balloon, thickness: 0.001 }",
                            "bodies.0.pressure={ inside: 4350 }", "stop.frames=110", "solver.dt=0.002"};
    text = warning_of(BALLOON, sudden, 4, "largest-pressure", &summary);
    assert_true(text != NULL && strstr(text, "jumped to a far larger size: 4350 Pa is near") != NULL);
    assert_non_null(strstr(text, "let it grow in time (inside: { keys: [[0, 0], [1, 4350]] })"));
    sudden[1] = "bodies.0.pressure={ inside: { keys: [[0, 0], [0.15, 4350]] } }";
    assert_false(warns(BALLOON, sudden, 4, "largest-pressure"));
}

/* A flat pillow is blown up: its volume grows to some times what it was, but its cloth is hardly stretched. */
static void test_pillow_unfolds(void **unused)
{
    (void)unused;
    const char *pillow[] = {"bodies.0.mesh={ shape: box, size_x: 0.3, size_y: 0.3, size_z: 0.01, nx: 6, ny: 6, nz: 1 }",
                            "bodies.0.pressure={ inside: 500 }", "stop.frames=60", "solver.dt=0.005"};
    pel_run_summary summary;
    assert_null(warning_of(BALLOON, pillow, 4, "largest-pressure", &summary));
    print_message("volume %.3g, area %.3g\n", summary.volume_ratio_final, summary.area_ratio_final);
    assert_true(summary.volume_ratio_final > 5 && summary.area_ratio_final < 1.2);
}

/* ---- loads ---- */

#define DISC                                                                                                           \
    "version: 1\nbodies:\n  - name: disc\n    mesh: { shape: disk, radius: 1, rings: 4 }\n"                            \
    "    membrane: { young: 1.0e9, poisson: 0.3, thickness: 0.01 }\n"                                                  \
    "    supports: [ { at: boundary, rotation: fixed } ]\n"                                                            \
    "loads: [ { name: finger, force: [0, 0, -1.0e-3], at: { nearest: [0, 0, 0] } } ]\n" STATIC

static void test_coarse_load(void **unused)
{
    (void)unused;
    const char *fine[] = {"bodies.0.mesh.rings=16"};
    const char *wide[] = {"bodies.0.mesh.rings=8", "loads.0.at={ sphere: { center: [0, 0, 0], radius: 0.6 } }"};
    const char *along[] = {"loads.0.force=[1, 0, 0]"};
    pel_run_summary summary;
    const char *text = warning_of(DISC, no_change, 0, "coarse-load", &summary);
    assert_true(text != NULL && strstr(text, "'finger'") != NULL && strstr(text, "'disc'") != NULL);
    /* F a^2 / (16 pi D): the warning is right */
    double exact = 1e-3 / (16 * 3.14159265 * 1e9 * 1e-6 / 12 / 0.91);
    assert_true(summary.max_displacement > 1.2 * exact);
    assert_null(warning_of(DISC, fine, 1, "coarse-load", &summary));
    assert_true(fabs(summary.max_displacement - exact) < 0.035 * exact);
    /* from 3 % on */
    fine[0] = "bodies.0.mesh.rings=12";
    assert_non_null(warning_of(DISC, fine, 1, "coarse-load", &summary));
    assert_true(summary.max_displacement > 1.03 * exact && summary.max_displacement < 1.06 * exact);
    assert_false(warns(DISC, wide, 2, "coarse-load"));
    /* and the remedy of its text works */
    const char *automatic[] = {"bodies.disc.refine=auto"};
    assert_non_null(strstr(warning_of(DISC, no_change, 0, "coarse-load", &summary), automatic[0]));
    assert_null(warning_of(DISC, automatic, 1, "coarse-load", &summary));
    assert_true(fabs(summary.max_displacement - exact) < 0.03 * exact);
    assert_false(warns(DISC, along, 1, "coarse-load"));
    /* a drum carries it by tension: with 40 rings 15.38 mm, 2 % less */
    const char *drum[] = {"bodies.0.mesh={ shape: disk, radius: 0.1, rings: 16 }",
                          "bodies.0.membrane={ young: 1.0e6, poisson: 0.5, thickness: 0.0005 }",
                          "bodies.0.supports=[ { at: boundary } ]",
                          "loads.0={ force: [0, 0, -0.5], at: { sphere: { center: [0, 0, 0], radius: 0.03 } } }"};
    assert_null(warning_of(DISC, drum, 4, "coarse-load", &summary));
    assert_near(summary.max_displacement, 0.01538, 0.0005);
    /* a point load at the end of a clamped strip bends the whole strip */
    assert_false(warns(STRIP(CLAMP, STATIC "loads: [ { force: [0, 0, -0.1], at: { nearest: [0.25, 0, 0] } } ]\n"),
                       no_change, 0, "coarse-load"));
}

/* ---- modes ---- */

#define TUBE                                                                                                           \
    "version: 1\nbodies:\n  - name: tube\n"                                                                            \
    "    mesh: { shape: cylinder, radius: 0.03, height: 0.03, slices: 24, segments: 8, capped: false }\n"              \
    "    membrane: { material: stvk, young: 5.0e9, poisson: 0.3, thickness: 0.0005 }\n"                                \
    "    supports:\n"                                                                                                  \
    "      - { at: { box: { min: [-1, -1, -0.0151], max: [1, 1, -0.0149] } }, fix: [x, y, z] }\n"                      \
    "      - { at: { box: { min: [-1, -1, 0.0149], max: [1, 1, 0.0151] } }, fix: [x, y] }\n"                           \
    "loads:\n"                                                                                                         \
    "  - { force: [0, 0, -1], at: { box: { min: [-1, -1, 0.0149], max: [1, 1, 0.0151] } } }\n"                         \
    "solver: { analysis: buckling, modes: 2 }\n"

static void test_coarse_mode(void **unused)
{
    (void)unused;
    pel_run_summary summary;
    const char *text = warning_of(TUBE, no_change, 0, "coarse-mode", &summary);
    assert_true(text != NULL && strstr(text, "mode 1") != NULL && strstr(text, "load factors") != NULL);
    /* a free plate: 20 edges a wave, and 4 */
    const char *plate[] = {"solver={ analysis: modal, modes: 8 }", "bodies.0.supports=[]", "loads=[]",
                           "bodies.0.mesh={ shape: grid, nx: 16, ny: 16 }"};
    const char *coarse[] = {"solver={ analysis: modal, modes: 14 }", "bodies.0.supports=[]", "loads=[]",
                            "bodies.0.mesh={ shape: grid, nx: 4, ny: 4 }"};
    assert_false(warns(TUBE, plate, 4, "coarse-mode"));
    text = warning_of(TUBE, coarse, 4, "coarse-mode", &summary);
    assert_true(text != NULL && strstr(text, "frequencies") != NULL && strstr(text, "subdivide") != NULL);
    /* a clamped square of 16 cells: 18 edges a wave and 4.7 % too low, then 13 and 8 % */
    static const char square[] =
        "version: 1\nbodies: [{mesh: {shape: grid, nx: 16, ny: 16}, membrane: {preset: steel-sheet}, supports: [{at: "
        "boundary, rotation: fixed}]}]\nsolver: {method: static, analysis: modal, modes: 1}\n";
    const char *second[] = {"solver.modes=2"}, *hinged[] = {"bodies.0.supports.0.rotation=free", "solver.modes=3"};
    assert_false(warns(square, no_change, 0, "coarse-mode"));
    text = warning_of(square, second, 1, "coarse-mode", &summary);
    assert_true(text != NULL && strstr(text, "mode 2: its waves are 13 edges long") != NULL);
    assert_false(warns(square, hinged, 2, "coarse-mode"));
    /* of a filled body */
    text = warning_of("version: 1\nbodies: [{mesh: {shape: geodesic-sphere, frequency: 2}, volume: {young: 1000}}]\n"
                      "solver: {method: static, analysis: modal, modes: 8}\n",
                      no_change, 0, "coarse-mode", &summary);
    assert_true(text != NULL && strstr(text, "volume.edge smaller by a factor of 2") != NULL);
}

/* clamped plates that swing have the frequencies of their meshes, too: 22 and 4 % too low; what tension holds needs
   fewer edges */
static void test_coarse_vibration(void **unused)
{
    (void)unused;
    pel_run_summary summary;
    static const char plate[] =
        "version: 1\nbodies: [{name: plate, mesh: {shape: grid, nx: 6, ny: 6, size_x: 0.3, size_y: 0.3}, membrane: "
        "{preset: steel-sheet}, supports: [{at: boundary, rotation: fixed}]}]\n"
        "loads: [{force: [0, 0, -0.2], until: 0.01}]\nduration: 0.05\noutput: {every: 0.005}\n";
    /* of 16 cells 4.7 %, of 32 1.3 % too slow */
    const char *middle[] = {"bodies.0.mesh.nx=16", "bodies.0.mesh.ny=16"};
    const char *fine[] = {"bodies.0.mesh.nx=31", "bodies.0.mesh.ny=31"}, *calm[] = {"solver.drag=2000"};
    const char *text = warning_of(plate, no_change, 0, "coarse-mode", &summary);
    assert_true(text != NULL && strstr(text, "slowest vibration of body 'plate'") != NULL);
    text = warning_of(plate, middle, 2, "coarse-mode", &summary);
    assert_true(text != NULL && strstr(text, "too low by more than about 2 %") != NULL);
    assert_false(warns(plate, fine, 2, "coarse-mode"));
    assert_false(warns(plate, calm, 1, "coarse-mode"));
    static const char drum[] =
        "version: 1\nbodies: [{mesh: {shape: disk, rings: 6, radius: 0.15}, rest: {shape: disk, rings: 6, radius: "
        "0.143}, membrane: {young: 1.0e6, poisson: 0.5, thickness: 0.001}, pinned: boundary}]\n"
        "solver: {analysis: modal, modes: 3}\n";
    const char *coarse[] = {"bodies.0.mesh.rings=2", "bodies.0.rest.rings=2"};
    assert_false(warns(drum, no_change, 0, "coarse-mode"));
    assert_true(warns(drum, coarse, 2, "coarse-mode"));
}

/* Plates under a pressure: what is told is near what they give way too much, by theory (Timoshenko, Woinowsky-Krieger
   1959, tables 8 and 35), and less than 5 % is not told. */
static void test_coarse_bending(void **unused)
{
    (void)unused;
    static const struct {
        const char *mesh, *rotation;
        double deflection; /* D w / (p a^4) with a = 1 m */
    } cases[] = {
        {"{shape: grid, nx: 8, ny: 8}", "fixed", 0.00126532},
        {"{shape: grid, nx: 12, ny: 12, diagonals: union-jack}", "fixed", 0.00126532},
        {"{shape: grid, nx: 16, ny: 16}", "fixed", 0.00126532},
        {"{shape: grid, nx: 24, ny: 24}", "fixed", 0.00126532},
        {"{shape: disk, rings: 4, radius: 0.5}", "fixed", 1.0 / 1024},
        {"{shape: disk, rings: 8, radius: 0.5}", "fixed", 1.0 / 1024},
        {"{shape: grid, nx: 6, ny: 6}", "free", 0.00406235},
        {"{shape: grid, nx: 12, ny: 12}", "free", 0.00406235},
    };
    const double rigidity = 7e10 * 1e-6 / 12 / 0.91;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char scene[700];
        pel_run_summary summary;
        snprintf(scene, sizeof scene,
                 "version: 1\nbodies: [{name: plate, mesh: %s, membrane: {young: 7.0e10, poisson: 0.3, thickness: "
                 "0.01}, supports: [{at: boundary, rotation: %s}], pressure: {inside: %.9g}}]\nsolver: {method: "
                 "static}\n",
                 cases[i].mesh, cases[i].rotation, 1e-4 * rigidity / cases[i].deflection);
        const char *text = warning_of(scene, no_change, 0, "coarse-bending", &summary);
        const double error = summary.max_displacement / 1e-4 - 1;
        const char *percent = text != NULL ? strstr(text, "gives way by about ") : NULL;
        const double told = percent != NULL ? strtod(percent + strlen("gives way by about "), NULL) / 100 : 0;
        print_message("%s %s: %.3f, told %.3f\n", cases[i].mesh, cases[i].rotation, error, told);
        assert_true((text != NULL) == (error > 0.045));
        assert_true(text == NULL || fabs(told / error - 1) < 0.45);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_coarse_bending),   cmocka_unit_test(test_hinge_row),
        cmocka_unit_test(test_hinge_mode),       cmocka_unit_test(test_no_hinge_row),
        cmocka_unit_test(test_two_rows),         cmocka_unit_test(test_pendulum),
        cmocka_unit_test(test_coarse_load),      cmocka_unit_test(test_coarse_mode),
        cmocka_unit_test(test_coarse_vibration), cmocka_unit_test(test_largest_pressure),
        cmocka_unit_test(test_pillow_unfolds),
    };
    return cmocka_run_group_tests(tests, make_folder, clear_folder);
}
