/* Warnings about nets of springs: strips that are pulled and sheared, against the stiffness of the net by the sum of
   its springs over a cell. */
#define _XOPEN_SOURCE 700 /* nftw */
#include "run/warned.h"
#include "run/warnings_springs.h"

#define STRIP                                                                                                          \
    "version: 1\nbodies: [ { name: net, mesh: { shape: grid, nx: 16, ny: 8, size_x: 0.2, size_y: 0.1, diagonals: "     \
    "union-jack }, springs: { young: 1e5, thickness: 0.001 }, supports: [ { at: all, fix: [z] }, { at: { nearest: "    \
    "[-0.1, 0, 0] } }, { at: { box: { min: [-1, -1, -1], max: [-0.0999, 1, 1] } }, fix: [x] }, { at: { box: { min: "   \
    "[0.0999, -1, -1], max: [1, 1, 1] } }, fix: [x], displacement: [0.0002, 0, 0] } ] } ]\nsolver: { method: static "  \
    "}\n"

/* of the first warning; 0 = none */
static double factor(const char *const *changes, int32_t count)
{
    pel_run_summary summary;
    run_scene(STRIP, changes, count, NULL, 100, &summary);
    const pel_run_warning *warning = find_warning(&summary, "spring-net");
    double found = 0;
    if (warning != NULL)
        assert_int_equal(sscanf(warning->text, "the springs of body 'net' are %lf times", &found), 1);
    return found;
}

static void test_tension(void **unused)
{
    (void)unused;
    /* squares: 1.25 - 0.25^2 / 1.25 of E; twice as long as wide, 2 + 0.4 along and across 0.5 + 0.4, 0.4 between */
    assert_near(factor(NULL, 0), 1.2, 0.02);
    const char *const flat[] = {"bodies.0.mesh.nx=8"};
    assert_near(factor(flat, 1), 1.6, 0.07);
    /* as stiff as the sheet along the cells, but sheared; right on equilateral triangles */
    const char *const alike[] = {"bodies.0.mesh.diagonals=one-diagonal"};
    assert_near(factor(alike, 1), 1, 0.02);
    const char *const equilateral[] = {"bodies.0.mesh.diagonals=equilateral", "bodies.0.mesh.ny=9"};
    assert_near(factor(equilateral, 2), 0, 0);
    /* the remedy */
    const char *const sheet[] = {"bodies.0.springs=null",
                                 "bodies.0.membrane={ young: 1e5, poisson: 0.33, thickness: 0.001 }"};
    assert_near(factor(sheet, 2), 0, 0);
    /* no strain but that of rounding */
    const char *const still[] = {"bodies.0.supports.3.displacement=[1e-8, 0, 0]"};
    assert_near(factor(still, 1), 0, 0);
}

/* diagonals that all run one way let a net that hangs freely go sideways by as much as it stretches */
static void test_skew(void **unused)
{
    (void)unused;
    const char *const hung[] = {"bodies.0.mesh={ shape: grid, nx: 4, ny: 20, size_x: 0.05, size_y: 0.25 }",
                                "bodies.0.supports=[ { at: { box: { min: [-1, 0.1249, -1], max: [1, 1, 1] } } }, { at: "
                                "all, fix: [z] } ]",
                                "gravity=[0, -9.81, 0]", "bodies.0.springs.young=1e6",
                                "bodies.0.mesh.diagonals=union-jack"};
    assert_near(factor(hung, 4), 1, 0.03);
    pel_run_summary summary;
    run_scene(STRIP, hung, 4, NULL, 100, &summary);
    assert_non_null(strstr(find_warning(&summary, "spring-net")->text, "shear by 0.9"));
    run_scene(STRIP, hung, 5, NULL, 100, &summary);
    assert_null(strstr(find_warning(&summary, "spring-net")->text, "shear"));
}

/* a net that hangs by two corners is strained otherwise everywhere: .86 of the way of a membrane */
static void test_uneven(void **unused)
{
    (void)unused;
    const char *const hung[] = {"bodies.0.mesh={ shape: grid, nx: 10, ny: 10, size_x: 0.2, size_y: 0.2, rotate: { "
                                "axis: [1, 0, 0], angle: 90 } }",
                                "bodies.0.supports=null", "bodies.0.pinned={ vertices: [110, 120] }",
                                "gravity=[0, 0, -9.81]", "bodies.0.mesh.diagonals=equilateral"};
    pel_run_summary summary;
    run_scene(STRIP, hung, 4, NULL, 100, &summary);
    double part = 0;
    const char *text = find_warning(&summary, "spring-net")->text;
    assert_int_equal(sscanf(text, "the springs of body 'net' store %lf times the energy of a sheet", &part), 1);
    assert_in_range(100 * part, 50, 75);
    run_scene(STRIP, hung, 5, NULL, 100, &summary);
    assert_null(find_warning(&summary, "spring-net"));
}

static void test_shear(void **unused)
{
    (void)unused;
    /* the diagonals alone: 0.25 of E for 0.375 */
    const char *const sheared[] = {"bodies.0.mesh={ shape: grid, nx: 4, ny: 16, size_x: 0.2, size_y: 0.8, diagonals: "
                                   "union-jack }",
                                   "bodies.0.supports.2.fix=[x, y]",
                                   "bodies.0.supports.3={ at: { box: { min: [0.0999, -1, -1], max: [1, 1, 1] } }, fix: "
                                   "[x, y], displacement: [0, 0.0004, 0] }",
                                   "bodies.0.supports.1.at={ nearest: [0, 0, 0] }", "bodies.0.supports.1.fix=[z]"};
    assert_near(factor(sheared, 5), 0.67, 0.03);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_tension), cmocka_unit_test(test_skew),
                                       cmocka_unit_test(test_shear), cmocka_unit_test(test_uneven)};
    return cmocka_run_group_tests(tests, make_folder, clear_folder);
}
