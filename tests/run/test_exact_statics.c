/* Thirty equilibria whose answer is known in closed form: each is met, and none has a warning. */
#define _XOPEN_SOURCE 700 /* nftw */
#include "law_forms.h"
#include "run/warned.h"

static int scene_count;

/* a scene without a warning, and its summary */
static pel_run_summary run_quietly(const char *text)
{
    pel_run_summary summary;
    run_scene(text, NULL, 0, NULL, 0, &summary);
    scene_count++;
    if (summary.warning_count > 0)
        print_error("%s\n%s: %s\n", text, summary.warnings[0].code, summary.warnings[0].text), fail();
    return summary;
}

static void check_near(const char *text, double found, double truth, double error)
{
    if (!(fabs(found - truth) <= error * fabs(truth)))
        fail_msg("%s\nis %.9g, not %.9g", text, found, truth);
}

#define SHEET "version: 1\nbodies:\n  - name: sheet\n"
#define STATIC "solver: { method: static }\n"

/* J: the work of stretching a unit area in one direction while the other is held, by Simpson's rule */
static double work_of(const pel_membrane_material *material, double stretch)
{
    enum { PARTS = 200 };
    double sum = 0, step = (stretch - 1) / PARTS;
    for (int i = 0; i <= PARTS; i++)
        sum += (i == 0 || i == PARTS ? 1 : i % 2 == 1 ? 4 : 2) * law_tension(material, 1 + i * step, 1);
    return sum * step / 3;
}

static void stretch_sheet(int kind, double stretch)
{
    char text[1200];
    pel_membrane_material material = law_material(kind, 2e5, 0.3, 0.001);
    if (pel_membrane_law_of(&material).poisson == 0.5)
        material.poisson = 0.5;
    const char *numbers = kind == PEL_MEMBRANE_MOONEY_RIVLIN ? ", mooney_ratio: 0.2"
                          : kind == PEL_MEMBRANE_GENT        ? ", extension_limit: 20"
                          : kind == PEL_MEMBRANE_FUNG        ? ", stiffening: 6"
                          : kind == PEL_MEMBRANE_WEAVE
                              ? ", shear: 76923.0769230769, warp_curve: [[0.15, 3e4], [0.3, 9e4], [0.5, 25e4]]"
                          : kind == PEL_MEMBRANE_ELASTOPLASTIC ? ", yield: 7e4, hardening: 2e4"
                                                               : "";
    snprintf(text, sizeof text,
             SHEET "    mesh: { shape: grid, nx: 8, ny: 6, size_x: 0.2, size_y: 0.1 }\n"
                   "    membrane: { material: %s, young: 2.0e5, poisson: %g, thickness: 0.001%s }\n    supports:\n"
                   "      - { name: left, at: { box: { min: [-1, -1, -1], max: [-0.0999, 1, 1] } }, fix: [x] }\n"
                   "      - { name: flat, at: all, fix: [y, z] }\n"
                   "      - { name: right, at: { box: { min: [0.0999, -1, -1], max: [1, 1, 1] } }, fix: [x], "
                   "displacement: [%.17g, 0, 0] }\n" STATIC,
             pel_membrane_kind_name((pel_membrane_kind)kind), material.poisson, numbers, 0.2 * (stretch - 1));
    const pel_run_summary summary = run_quietly(text);
    check_near(text, summary.ledger.elastic, 0.02 * work_of(&material, stretch), 1e-5);
}

static void test_stretched(void **unused)
{
    (void)unused;
    static const double stretches[] = {1.05, 1.1, 1.3};
    for (int kind = 0; kind < PEL_MEMBRANE_COUNT; kind++)
        /* strains of the linear law are those in the frame of an edge: no function of the stretches */
        for (int i = 0; i < 3 && kind != PEL_MEMBRANE_LINEAR; i++)
            stretch_sheet(kind, stretches[i]);
}

/* F L / (E h w) */
static void test_pulled(void **unused)
{
    (void)unused;
    for (int kind = 0; kind < PEL_MEMBRANE_COUNT; kind++) {
        char text[1000];
        double poisson = pel_membrane_law_of(&(pel_membrane_material){.kind = (pel_membrane_kind)kind}).poisson;
        const char *numbers = kind == PEL_MEMBRANE_WEAVE           ? ", shear: 1e7, warp_curve: [[0.1, 1e8]]"
                              : kind == PEL_MEMBRANE_ELASTOPLASTIC ? ", yield: 1e7"
                                                                   : "";
        snprintf(text, sizeof text,
                 SHEET
                 "    mesh: { shape: grid, nx: 10, ny: 4, size_x: 0.2, size_y: 0.05 }\n"
                 "    membrane: { material: %s, young: 1.0e9, poisson: %g, thickness: 0.001%s }\n    supports:\n"
                 "      - { at: { box: { min: [-1, -1, -1], max: [-0.0999, 1, 1] } }, fix: [x] }\n      - { at: all, "
                 "fix: [z] }\n"
                 "      - { at: { nearest: [-0.1, 0, 0] } }\n"
                 "loads: [ { force: [100, 0, 0], per: length, at: { box: { min: [0.0999, -1, -1], max: [1, 1, 1] } "
                 "} } ]\n" STATIC,
                 pel_membrane_kind_name((pel_membrane_kind)kind), poisson == 0.5 ? 0.5 : 0.3, numbers);
        check_near(text, 2 * run_quietly(text).ledger.elastic / 5, 100 / 1e6 * 0.2, 1e-3);
    }
}

/* p R^2 (1 - nu) / (2 E h) */
static void test_balloons(void **unused)
{
    (void)unused;
    const double poisson[] = {0, 0.3, 0.45, 0.3, 0.3}, pressure[] = {1000, 1000, 1000, -100, 3000};
    for (int i = 0; i < 5; i++) {
        char text[600];
        snprintf(text, sizeof text,
                 SHEET
                 "    mesh: { shape: geodesic-sphere, frequency: 12, radius: 0.1 }\n"
                 "    membrane: { young: 1.0e9, poisson: %g, thickness: 0.001 }\n    pressure: { inside: %g }\n" STATIC,
                 poisson[i], pressure[i]);
        double stretch = pressure[i] * 0.01 * (1 - poisson[i]) / (2 * 1e9 * 1e-3) / 0.1;
        const pel_run_summary summary = run_quietly(text);
        check_near(text, summary.volume_ratio_final - 1, 3 * stretch, 0.02);
        /* nothing holds it: it stays where its center of mass was */
        check_near(text, summary.max_displacement, 0.1 * fabs(stretch), 0.02);
    }
}

/* plates and beams: q a^4 / (64 D), the wall of a cantilever under its weight, and by a force at its end */
static void test_bent(void **unused)
{
    (void)unused;
    const double rigidity = 1e9 * 1e-6 / 12 / 0.91;
    const char *const disc = SHEET "    mesh: { shape: disk, radius: 1, rings: 16 }\n"
                                   "    membrane: { young: 1.0e9, poisson: 0.3, thickness: 0.01 }\n"
                                   "    supports: [ { at: boundary, rotation: fixed } ]\n";
    char text[1000];
    snprintf(text, sizeof text, "%s    pressure: { outside: 0.01 }\n" STATIC, disc);
    check_near(text, run_quietly(text).max_displacement, 0.01 / 64 / rigidity, 0.02);
    /* a weight of as much */
    snprintf(text, sizeof text, "%s    mass: { density: 1.0 }\ngravity: [0, 0, -1]\n" STATIC, disc);
    check_near(text, run_quietly(text).max_displacement, 0.01 / 64 / rigidity, 0.02);
    const char *const beam =
        SHEET "    mesh: { shape: grid, nx: 30, ny: 3, size_x: 0.2, size_y: 0.02 }\n"
              "    membrane: { young: 2.0e9, poisson: 0, thickness: 0.001 }\n    mass: { density: 1000 }\n"
              "    supports: [ { at: { box: { min: [-1, -1, -1], max: [-0.0999, 1, 1] } }, rotation: fixed } ]\n";
    const double stiffness = 2e9 * 0.02 * 1e-9 / 12;
    snprintf(text, sizeof text, "%sgravity: [0, 0, -0.1]\n" STATIC, beam);
    check_near(text, run_quietly(text).max_displacement, 1000 * 0.02 * 0.001 * 0.1 * 0.0016 / 8 / stiffness, 0.01);
    snprintf(text, sizeof text,
             "%sloads: [ { force: [0, 0, 0.01], per: length, at: { box: { min: [0.0999, -1, -1], max: [1, 1, 1] } } } "
             "]\n" STATIC,
             beam);
    check_near(text, run_quietly(text).max_displacement, 0.01 * 0.02 * 0.008 / 3 / stiffness, 0.01);
}

/* a tube that stands on its rim, stiff enough that rounding is a part of the forces left over */
static void test_stood(void **unused)
{
    (void)unused;
    const char *const text =
        SHEET "    mesh: { shape: cylinder, radius: 0.03, height: 0.3, slices: 32, segments: 20, capped: false }\n"
              "    membrane: { young: 2.0e9, poisson: 0.3, thickness: 0.002 }\n    mass: { density: 1200 }\n"
              "    pinned: { box: { min: [-1, -1, -1], max: [1, 1, -0.149] } }\ngravity: [0, 0, -9.81]\n" STATIC;
    check_near(text, run_quietly(text).max_displacement, 1200 * 9.81 * 0.09 / 2 / 2e9, 0.01);
}

/* a strip that a moment at its end rolls up: sin(k L) / k along, (1 - cos(k L)) / k across */
static void test_rolled(void **unused)
{
    (void)unused;
    const double turns[] = {0.1, 0.2, 0.5, 1}, rigidity = 2e9 * 1e-9 / 12;
    for (int i = 0; i < 4; i++) {
        char text[700];
        double curvature = turns[i] * 2 * 3.14159265358979 / 0.3, angle = 0.3 * curvature;
        snprintf(text, sizeof text,
                 SHEET "    mesh: { shape: grid, nx: 40, ny: 4, size_x: 0.3, size_y: 0.03 }\n"
                       "    membrane: { young: 2.0e9, poisson: 0, thickness: 0.001 }\n    supports: [ { at: { box: { "
                       "min: [-1, -1, -1], max: [-0.1499, 1, 1] } }, rotation: fixed } ]\nloads: [ { per: moment, "
                       "force: [0, %.17g, 0], at: { box: { min: [0.1499, -1, -1], max: [1, 1, 1] } } } ]\n" STATIC,
                 rigidity * curvature);
        check_near(text, run_quietly(text).max_displacement,
                   hypot(0.3 - sin(angle) / curvature, (1 - cos(angle)) / curvature), 2e-3);
    }
}

static void test_count(void **unused)
{
    (void)unused;
    assert_true(scene_count >= 30);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_stretched), cmocka_unit_test(test_pulled), cmocka_unit_test(test_balloons),
        cmocka_unit_test(test_bent),      cmocka_unit_test(test_stood),  cmocka_unit_test(test_rolled),
        cmocka_unit_test(test_count),
    };
    return cmocka_run_group_tests(tests, make_folder, clear_folder);
}
