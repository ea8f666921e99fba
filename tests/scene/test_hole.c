/* The hole of a tear against known cuts: circles beside the axis, arcs, a branch that runs out. */
#include "scene_run.h"

#include "pellicle/tear.h"

#define RADIUS 0.0025
#define PI 3.14159265358979323846

static const double middle[2] = {0, 0};

/* a disk in the plane of the axis' normal that a path of `count` points opens; forceps lead a tear around the middle */
static void open_disk(run *r, const char *path, bool leads)
{
    char text[8000];
    snprintf(text, sizeof text,
             "version: 1\n"
             "bodies:\n"
             "  - mesh: {shape: disk, radius: 0.004, rings: 30}\n"
             "    mass: {per_vertex: 1.0e-6}\n"
             "    springs: {young: 1.5e6, thickness: 13e-6, toughness: 1300}\n"
             "    pinned: boundary\n"
             "cuts: [%s]\n"
             "tools:\n"
             "  - {name: forceps, shape: sphere, radius: 0.0001, press: false, grasp: {reach: 1e-5%s}, motion: "
             "[{position: [0, 0, 0.01]}]}\n"
             "solver: {method: quasi-static, dt: 0.0005}\n"
             "duration: 1\n",
             path, leads ? ", lead: {radius: 0.0025, speed: 0.001, regrasp: 0.003}" : "");
    check_begin(r, text);
    assert_int_equal(pel_sim_step(r->sim, NULL), PEL_OK);
}

/* from one angle to another around a centre; the ends are the same where they meet */
static void write_arc(const double center[2], double radius, double from, double to, char *path, size_t size)
{
    const int count = 48;
    size_t used = (size_t)snprintf(path, size, "{path: [");
    for (int i = 0; i <= count; i++) {
        double a = i == count && to - from > 6.28 ? from : from + (to - from) * i / count;
        used += (size_t)snprintf(path + used, size - used, "%s[%.9g, %.9g, 0]", i > 0 ? ", " : "",
                                 center[0] + radius * cos(a), center[1] + radius * sin(a));
    }
    snprintf(path + used, size - used, "]}");
}

/* the mesh has edges of 0.13 mm, and paths keep within a tenth of that; a sector has 0.2 mm of the circle */
static void test_circles(void **unused)
{
    (void)unused;
    static const double shifts[][2] = {{0, 0}, {0.0005, 0}, {-0.0003, 0.0004}};
    for (int i = 0; i < 3; i++) {
        const double shift = hypot(shifts[i][0], shifts[i][1]);
        char path[4000];
        run r;
        pel_hole_reading hole;
        write_arc(shifts[i], RADIUS, 0, 2 * PI, path, sizeof path);
        open_disk(&r, path, true);
        assert_true(pel_sim_get_hole(r.sim, &hole));
        assert_true(hole.is_whole && hole.aim == RADIUS);
        assert_near(hole.swept, 2 * PI, 1e-9);
        assert_near(hole.diameter, 2 * RADIUS, 0.00008);
        assert_near(hole.offset, shift, 0.00004);
        assert_true(hole.roundness > 0.95 && hole.roundness <= 1);
        assert_near(hole.largest, RADIUS + shift, 0.00004);
        assert_int_equal(hole.run_out_count, i > 0);
        /* the direction of sector 0, and that of a quarter of a turn */
        double x[2] = {hole.along[0], hole.along[1]};
        assert_near(hole.across[0], -x[1], 1e-15);
        assert_near(hole.across[1], x[0], 1e-15);
        assert_near(hole.radius[0] - hole.radius[PEL_HOLE_SECTORS / 2], 2 * (shifts[i][0] * x[0] + shifts[i][1] * x[1]),
                    0.00012);
        end(&r);
    }
}

/* half a circle, which comes from the middle */
static void test_arc(void **unused)
{
    (void)unused;
    char path[4000], whole[4200];
    run r;
    pel_hole_reading hole;
    write_arc(middle, RADIUS, 0, PI, path, sizeof path);
    snprintf(whole, sizeof whole, "{path: [[0, 0, 0], [0.0025, 0, 0]]}, %s", path);
    open_disk(&r, whole, true);
    assert_true(pel_sim_get_hole(r.sim, &hole));
    assert_true(!hole.is_whole && isnan(hole.offset) && isnan(hole.roundness));
    assert_near(hole.swept, PI, 0.2);
    assert_near(hole.diameter, 2 * RADIUS, 0.00008);
    assert_int_equal(hole.run_out_count, 0);
    end(&r);
}

/* two cuts outward from the circle, one of them where the sectors begin */
static void test_run_out(void **unused)
{
    (void)unused;
    char path[4000], whole[4200];
    run r;
    pel_hole_reading hole;
    write_arc(middle, RADIUS, 0, 2 * PI, path, sizeof path);
    snprintf(whole, sizeof whole,
             "%s, {path: [[0.0025, 0, 0], [0.0036, 0, 0]]}, {path: [[0, 0.0025, 0], [0, 0.0036, 0]]}", path);
    open_disk(&r, whole, true);
    assert_true(pel_sim_get_hole(r.sim, &hole));
    assert_int_equal(hole.run_out_count, 2);
    assert_near(hole.largest, 0.0036, 0.0001);
    assert_true(hole.is_whole && hole.roundness < 0.8);
    end(&r);
}

/* two arcs that together go around, beside each other at their ends; a circle that has run out everywhere */
static void test_around(void **unused)
{
    (void)unused;
    char inner[3000], outer[3000], both[6100];
    run r;
    pel_hole_reading hole;
    write_arc(middle, 0.0024, 0, PI + 0.2, inner, sizeof inner);
    write_arc(middle, 0.0027, PI - 0.2, 2 * PI + 0.2, outer, sizeof outer);
    snprintf(both, sizeof both, "%s, %s", inner, outer);
    open_disk(&r, both, true);
    assert_true(pel_sim_get_hole(r.sim, &hole));
    assert_near(hole.swept, 2 * PI, 1e-9);
    assert_true(!hole.is_whole && hole.roundness > 0.8);
    end(&r);
    write_arc(middle, 0.0032, 0, 2 * PI, outer, sizeof outer);
    open_disk(&r, outer, true);
    assert_true(pel_sim_get_hole(r.sim, &hole));
    assert_true(hole.is_whole);
    assert_int_equal(hole.run_out_count, 1);
    end(&r);
}

static void test_nothing(void **unused)
{
    (void)unused;
    char path[4000];
    run r;
    pel_hole_reading hole;
    write_arc(middle, RADIUS, 0, PI, path, sizeof path);
    open_disk(&r, path, false);
    assert_false(pel_sim_get_hole(r.sim, &hole));
    assert_true(hole.aim == 0 && hole.swept == 0);
    end(&r);
    /* a first cut in the middle */
    open_disk(&r, "{path: [[0, 0, 0], [0.001, 0, 0]]}", true);
    assert_true(pel_sim_get_hole(r.sim, &hole));
    assert_true(hole.swept == 0 && hole.diameter == 0 && hole.largest == 0 && isnan(hole.roundness));
    end(&r);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_circles), cmocka_unit_test(test_arc),     cmocka_unit_test(test_run_out),
        cmocka_unit_test(test_around),  cmocka_unit_test(test_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
