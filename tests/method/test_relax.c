/* The quasi-static method has one time course on all levels of detail. */
#include "sim/refine_fixture.h"

#include "shell_fixture.h"

enum { TIMES = 5 };
/* seconds; released after the third */
static const double times[TIMES] = {0.1, 0.5, 2, 2.1, 2.5};

typedef struct course {
    double depth[TIMES];
    uint64_t hash;
} course;

typedef struct course_case {
    bool uneven, local, keep_velocity;
    double alpha;
    int32_t level;
    int threads;
} course_case;

static pel_mesh *mesh_of(const course_case *with)
{
    random_state random = {3};
    return with->uneven ? make_irregular_ball(6, &random) : make_sphere(5);
}

/* a ball that is pressed at its cap, and released */
static course run_course(const course_case *with)
{
    pel_mesh *mesh = mesh_of(with);
    int32_t cap[400], count = 0, pole = nearest_vertex(mesh, 0, 0, 1);
    for (int32_t v = 0; v < mesh->vertex_count && count < 400; v++)
        if (mesh->positions[v][2] > 0.6)
            cap[count++] = v;
    pel_body_def body = ball(mesh, with->level);
    body.refine.everywhere = !with->local;
    body.refine.region = cap;
    body.refine.region_count = with->local ? count : 0;
    pel_load_def load = pel_load_def_default();
    load.force[2] = -30;
    load.vertices = cap;
    load.vertex_count = count;
    load.until = times[2];
    pel_sim_def def = pel_sim_def_default();
    def.solver.keep_velocity = with->keep_velocity;
    def.solver.alpha = with->alpha;
    def.thread_count = with->threads;
    def.loads = &load;
    def.load_count = 1;
    bench made = begin(mesh, &body, &def);
    double start = height_of(made.sim, pole);
    course result;
    for (int t = 0; t < TIMES; t++) {
        run_steps(made.sim, (int)(times[t] / 0.01 + 0.5) - (int)pel_sim_step_count(made.sim));
        result.depth[t] = start - height_of(made.sim, pole);
    }
    result.hash = pel_sim_hash(made.sim);
    end(&made);
    return result;
}

/* the state at rest differs by some per cent, as finer nets of springs buckle otherwise */
static void assert_same_course(course_case with, double tolerance)
{
    with.level = 0;
    course base = run_course(&with);
    for (with.level = 1; with.level <= LONG(3, 2); with.level++) {
        course fine = run_course(&with);
        for (int t = 0; t < TIMES; t++)
            assert_near(fine.depth[t], base.depth[t], tolerance * base.depth[2]);
    }
}

static void test_levels(void **unused)
{
    (void)unused;
    assert_same_course((course_case){.local = false}, 0.06);
    assert_same_course((course_case){.local = true}, 0.06);
}

static void test_uneven(void **unused)
{
    (void)unused;
    assert_same_course((course_case){.uneven = true}, 0.06);
    assert_same_course((course_case){.uneven = true, .local = true}, 0.06);
}

/* where velocities act, as drag, and for a slow alpha */
static void test_kept_velocity(void **unused)
{
    (void)unused;
    assert_same_course((course_case){.keep_velocity = true, .alpha = 40}, 0.06);
    assert_same_course((course_case){.keep_velocity = true, .alpha = 70, .local = true}, 0.06);
    assert_same_course((course_case){.alpha = 40}, 0.06);
}

static void test_threads(void **unused)
{
    (void)unused;
    course_case with = {.level = 2, .local = true, .threads = 1};
    uint64_t hash = run_course(&with).hash;
    for (with.threads = 2; with.threads <= ROUNDS(4, 2); with.threads++)
        assert_true(run_course(&with).hash == hash);
}

/* a shell comes to the same shape in the same time, though plain steps of its finer levels would be unstable */
static void test_shell(void **unused)
{
    (void)unused;
    skip_if_slow();
    double volumes[3][2];
    for (int32_t level = 0; level <= 2; level++) {
        pel_mesh *mesh = make_sphere(5);
        pel_body_def body = shell_body(mesh, PEL_MEMBRANE_STVK);
        body.shell.bending.model = PEL_BENDING_HINGE;
        body.shell.pressure.kind = PEL_PRESSURE_GIVEN;
        body.shell.pressure.outside.value =
            -0.02 * body.shell.membrane.young.value * body.shell.membrane.thickness.value;
        body.refine.levels = level;
        body.refine.everywhere = true;
        pel_sim_def def = pel_sim_def_default();
        bench made = begin(mesh, &body, &def);
        for (int t = 0; t < 2; t++) {
            run_steps(made.sim, t == 0 ? 10 : 500);
            pel_sim_measures measures;
            pel_sim_measure(made.sim, &measures);
            volumes[level][t] = measures.volume_ratio - 1;
        }
        assert_true(volumes[level][1] > 0.02);
        for (int t = 0; t < 2; t++)
            assert_near(volumes[level][t], volumes[0][t], 0.06 * volumes[0][1]);
        end(&made);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_levels),  cmocka_unit_test(test_uneven), cmocka_unit_test(test_kept_velocity),
        cmocka_unit_test(test_threads), cmocka_unit_test(test_shell),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
