/* Warnings about bodies of tetrahedra: slender ones with few edges in their thickness, and ratios that lock. */
#define _XOPEN_SOURCE 700 /* nftw */
#include "run/warned.h"
#include "run/warnings_volume.h"

/* a rod of 20 mm and a ball; a box with the rod's inertia is 17 mm thick */
#define ROD                                                                                                            \
    "version: 1\nbodies: [ { name: rod, mesh: { shape: cylinder, radius: 0.01, height: 0.1, slices: 12, segments: 12 " \
    "}, volume: { young: 1e5, edge: 0.01, element: linear } } ]\ngravity: [0, 0, -1]\nsolver: { method: implicit "     \
    "}\nduration: 0.01\n"
#define BALL                                                                                                           \
    "version: 1\nbodies: [ { name: ball, mesh: { shape: geodesic-sphere, frequency: 3, radius: 0.05 }, "               \
    "volume: { young: 1e5, element: linear } } ]\ngravity: [0, 0, -1]\nsolver: { method: implicit }\nduration: 0.01\n"

static const pel_run_warning *coarse(const char *text, const char *change, pel_run_summary *summary)
{
    run_scene(text, &change, change != NULL, NULL, 1, summary);
    return find_warning(summary, "coarse-volume");
}

static void test_slender(void **unused)
{
    (void)unused;
    pel_run_summary summary;
    const pel_run_warning *warning = coarse(ROD, NULL, &summary);
    assert_true(warning != NULL && warning->first_frame == 0);
    double thickness, edge, factor, better;
    const char *text = strstr(warning->text, "body 'rod' is about ");
    assert_non_null(text);
    assert_int_equal(sscanf(text,
                            "body 'rod' is about %lf m thick, and the edges of its tetrahedra are %lf m long: it bends "
                            "about %lf times too stiffly. use volume: { element: smooth } or { edge: %lf }",
                            &thickness, &edge, &factor, &better),
                     4);
    /* sqrt(3) radii, less what so large tetrahedra cut off; they have diagonals */
    assert_near(thickness, 0.0162, 0.0015);
    assert_near(edge, 0.012, 0.0015);
    assert_near(factor, 1 + 1.1 * edge * edge / (thickness * thickness), 0.1);
    assert_near(better, thickness / 4, 1e-4);
    /* both remedies help */
    assert_null(coarse(ROD, "bodies.0.volume.edge=0.0043", &summary));
    assert_null(coarse(ROD, "bodies.0.volume.element=smooth", &summary));
    /* a plate of one flat layer */
    assert_non_null(
        coarse(ROD, "bodies.0.mesh={ shape: cylinder, radius: 0.1, height: 0.01, slices: 32, segments: 2 }", &summary));
    /* far from the origin */
    warning = coarse(ROD, "bodies.0.mesh.translate=[1000, 0, 0]", &summary);
    assert_true(warning != NULL && strstr(warning->text, "about 0.015 m thick") != NULL);
}

/* a cube of 0.1 m pulled aside: its stiffness over that with so short edges that more would change little */
static double stiffness(const char *edge)
{
    static const char cube[] =
        "version: 1\nbodies: [ { name: cube, mesh: { shape: box, size_x: 0.1, size_y: 0.1, size_z: 0.1 }, volume: { "
        "young: 1e4, poisson: 0.3, element: linear }, pinned: { box: { min: [-1, -1, -1], max: [1, 1, -0.049] } } } "
        "]\nloads: [ { force: [0.02, 0, 0], at: { box: { min: [-1, -1, 0.049], max: [1, 1, 1] } } } ]\ngravity: [0, 0, "
        "0]\nsolver: { method: static, dt: 1 }\nduration: 1\n";
    pel_run_summary summary;
    const char *change = edge;
    run_scene(cube, &change, 1, NULL, 1, &summary);
    double energy = summary.ledger.elastic, told = 0;
    const pel_run_warning *warning = find_warning(&summary, "coarse-volume");
    const char *text = warning != NULL ? strstr(warning->text, "it is up to ") : NULL;
    assert_true(text == NULL || sscanf(text, "it is up to %lf", &told) == 1);
    return told > 0 ? -energy : energy;
}

/* stubby bodies are told where they shear more than 10 % too stiffly, by not less and not much more */
static void test_stubby(void **unused)
{
    (void)unused;
    const double fine = stiffness("bodies.0.volume.edge=0.0125");
    assert_true(fine > 0);
    assert_true(stiffness("bodies.0.volume.edge=0.025") > 0.93 * fine);
    const double two = stiffness("bodies.0.volume.edge=0.05"), one = stiffness("bodies.0.volume.edge=0.1");
    assert_true(two < 0 && one < 0);
    assert_near(fine / -two, 1.17, 0.03);
    assert_near(fine / -one, 1.45, 0.04);
}

static void test_locking(void **unused)
{
    (void)unused;
    pel_run_summary summary;
    assert_null(coarse(BALL, NULL, &summary));
    assert_null(coarse(BALL, "bodies.0.volume.poisson=0.45", &summary));
    const pel_run_warning *warning = coarse(BALL, "bodies.0.volume.poisson=0.49", &summary);
    assert_true(warning != NULL && strstr(warning->text, "Poisson's ratio of body 'ball' is 0.49") != NULL);
}

/* a probe that touches few vertices is told with the remedy, which helps */
static void test_pressed(void **unused)
{
    (void)unused;
    pel_run_summary summary;
    static const char pressed[] = BALL "tools: [ { name: probe, shape: sphere, radius: 0.02, motion: [ { position: [0, "
                                       "0, 0.0701] }, { time: 0.01, position: [0, 0, 0.067] } ] } ]\n";
    const char *remedy = "bodies.ball.refine=auto";
    run_scene(pressed, NULL, 0, NULL, 1, &summary);
    const pel_run_warning *warning = find_warning(&summary, "coarse-contact");
    assert_true(warning != NULL && strstr(warning->text, remedy) != NULL);
    run_scene(pressed, &remedy, 1, NULL, 1, &summary);
    assert_null(find_warning(&summary, "coarse-contact"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_slender), cmocka_unit_test(test_stubby),
                                       cmocka_unit_test(test_locking), cmocka_unit_test(test_pressed)};
    return cmocka_run_group_tests(tests, make_folder, clear_folder);
}
