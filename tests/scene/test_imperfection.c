/* Columns that buckle: the imperfection of a scene, equilibria that are left along their lowest mode, and paths that
   cross another one. The elastica has the truth: a column of length L with hinges under P = 1.2 pi^2 E I / L^2, where
   the complete elliptic integral K(k) = pi / 2 sqrt(1.2), k = 0.5575, goes aside by 2 k L / (pi sqrt(1.2)) in the
   middle and shortens by 2 (1 - E(k) / K(k)) L. */
#include "check.h"

#include "failing_malloc.h"
#include "pellicle/scene.h"
#include "pellicle/sim.h"

#include <string.h>

#define COLUMN                                                                                                         \
    "version: 1\nbodies:\n  - name: strip\n"                                                                           \
    "    mesh: { shape: grid, nx: 40, ny: 4, size_x: 0.5, size_y: 0.05, diagonals: union-jack }\n"                     \
    "    membrane: { material: stvk, young: 1.0e9, poisson: 0, thickness: 0.001 }\n"                                   \
    "    supports:\n"                                                                                                  \
    "      - { name: left, at: { box: { min: [-1, -1, -1], max: [-0.2499, 1, 1] } } }\n"                               \
    "      - { name: right, at: { box: { min: [0.2499, -1, -1], max: [1, 1, 1] } }, fix: [y, z] }\n"                   \
    "loads:\n  - { force: [-0.197392, 0, 0], at: { box: { min: [0.2499, -1, -1], max: [1, 1, 1] } } }\n"
#define STATIC "solver: { method: static }\n"
#define PATH "solver: { path: arc-length, steps: 60 }\n"
#define BRANCH "solver: { path: arc-length, branch: lowest, steps: 60 }\n"
#define IMPERFECTION "imperfection: { amplitude: 1.0e-5 }\n"

/* of the middle, in the plane: aside and half of the shortening */
#define ELASTICA 0.1815
#define ELASTICA_ERROR 0.005
/* the same under 1.02 times Euler's load, where 0.1 % of the load is 2.5 % of the way */
#define SMALL_ELASTICA 0.0629
#define SMALL_ELASTICA_ERROR 0.04
/* of Euler's load, on this mesh */
#define EULER_ERROR 0.002

typedef struct made {
    pel_scene *scene;
    pel_model *model;
    pel_sim *sim;
} made;

static pel_status make(const char *text, made *m, pel_error *error)
{
    *m = (made){NULL, NULL, NULL};
    pel_status status = pel_scene_parse("test.yaml", text, strlen(text), NULL, 0, NULL, &m->scene, error);
    if (status == PEL_OK)
        status = pel_model_create(&m->scene->model, &m->model, error);
    if (status != PEL_OK)
        return status;
    pel_sim_def def = m->scene->sim;
    def.model = m->model;
    return pel_sim_create(&def, &m->sim, error);
}

static void destroy(made *m)
{
    pel_sim_destroy(m->sim);
    pel_model_destroy(m->model);
    pel_scene_destroy(m->scene);
}

static double largest_displacement(pel_sim *sim)
{
    pel_sim_measures measures;
    pel_sim_measure(sim, &measures);
    return measures.max_displacement;
}

static bool is_unstable(const pel_sim *sim)
{
    pel_solver_reading reading;
    pel_sim_get_solver(sim, &reading);
    return reading.unstable;
}

/* the rest shape has the mode, as far as it was asked for, and the path follows it */
static void test_imperfect_path(void **unused)
{
    (void)unused;
    if (sizeof(pel_real) == 4)
        skip();
    made m;
    double aside = 0;
    bool unstable = false;
    assert_int_equal(make(COLUMN IMPERFECTION PATH, &m, NULL), PEL_OK);
    const pel_mesh *mesh = m.scene->model.bodies[0].mesh;
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        aside = fmax(aside, fabs(mesh->positions[v][2]));
    assert_near(aside, 1e-5, 1e-9);
    for (int i = 0; i < 60 && pel_sim_get_path_end(m.sim) == PEL_PATH_GOES_ON; i++) {
        assert_int_equal(pel_sim_step(m.sim, NULL), PEL_OK);
        unstable |= is_unstable(m.sim);
    }
    assert_int_equal(pel_sim_get_path_end(m.sim), PEL_PATH_END_FULL_LOAD);
    assert_near(largest_displacement(m.sim), ELASTICA, ELASTICA_ERROR * ELASTICA);
    assert_false(unstable);
    destroy(&m);
}

/* the path has met Euler's load, as a bifurcation, within the error of the mesh */
static void check_crossing(const pel_sim *sim)
{
    pel_limit_point points[PEL_LIMIT_POINTS];
    assert_int_equal(pel_sim_get_limit_points(sim, points), 1);
    assert_int_equal(points[0].kind, PEL_LIMIT_BIFURCATION);
    assert_near(points[0].load_factor, 1 / 1.2, EULER_ERROR / 1.2);
}

/* without one the path stays straight, and says that it is unstable beyond Euler's load */
static void test_straight_path(void **unused)
{
    (void)unused;
    if (sizeof(pel_real) == 4)
        skip();
    made m;
    assert_int_equal(make(COLUMN PATH, &m, NULL), PEL_OK);
    for (int i = 0; i < 60 && pel_sim_get_path_end(m.sim) == PEL_PATH_GOES_ON; i++) {
        assert_int_equal(pel_sim_step(m.sim, NULL), PEL_OK);
        assert_true(is_unstable(m.sim) == (pel_sim_load_factor(m.sim) > (1 - EULER_ERROR) / 1.2));
    }
    assert_true(is_unstable(m.sim) && largest_displacement(m.sim) < 1e-4);
    check_crossing(m.sim);
    destroy(&m);
}

/* the path leaves the straight column where it crosses that of the bent one, and follows the elastica */
static void test_lowest_branch(void **unused)
{
    (void)unused;
    if (sizeof(pel_real) == 4)
        skip();
    made m;
    bool unstable = false;
    assert_int_equal(make(COLUMN BRANCH, &m, NULL), PEL_OK);
    for (int i = 0; i < 60 && pel_sim_get_path_end(m.sim) == PEL_PATH_GOES_ON; i++) {
        assert_int_equal(pel_sim_step(m.sim, NULL), PEL_OK);
        unstable |= is_unstable(m.sim);
    }
    assert_int_equal(pel_sim_get_path_end(m.sim), PEL_PATH_END_FULL_LOAD);
    assert_near(largest_displacement(m.sim), ELASTICA, ELASTICA_ERROR * ELASTICA);
    assert_false(unstable);
    check_crossing(m.sim);
    destroy(&m);
}

/* 2 % above Euler's load, where the lowest curvature of the energy is 1e-8 of the highest, which float does not see */
static void test_leaves_just_above(void **unused)
{
    (void)unused;
    if (sizeof(pel_real) == 4)
        skip();
    made m;
    assert_int_equal(make(COLUMN STATIC, &m, NULL), PEL_OK);
    pel_sim_destroy(m.sim);
    pel_load_def load = m.scene->sim.loads[0];
    load.force[0] *= 1.02 / 1.2;
    pel_sim_def def = m.scene->sim;
    def.model = m.model;
    def.loads = &load;
    assert_int_equal(pel_sim_create(&def, &m.sim, NULL), PEL_OK);
    assert_int_equal(pel_sim_step(m.sim, NULL), PEL_OK);
    assert_false(is_unstable(m.sim));
    assert_near(largest_displacement(m.sim), SMALL_ELASTICA, SMALL_ELASTICA_ERROR * SMALL_ELASTICA);
    destroy(&m);
}

/* static leaves the straight column along its lowest mode and ends beside it, not turned over */
static void test_leaves_straight(void **unused)
{
    (void)unused;
    if (sizeof(pel_real) == 4)
        skip();
    made m;
    assert_int_equal(make(COLUMN STATIC, &m, NULL), PEL_OK);
    assert_int_equal(pel_sim_step(m.sim, NULL), PEL_OK);
    assert_false(is_unstable(m.sim));
    assert_near(largest_displacement(m.sim), ELASTICA, ELASTICA_ERROR * ELASTICA);
    destroy(&m);
}

/* A sheet of 2.5 : 1 that is stretched by 5 % between clamps wrinkles along the stretch: out of its plane by more than
   its thickness. */
static void test_wrinkles(void **unused)
{
    (void)unused;
    if (sizeof(pel_real) == 4)
        skip();
    made m;
    assert_int_equal(
        make("version: 1\nbodies:\n  - name: sheet\n"
             "    mesh: { shape: grid, nx: 40, ny: 20, size_x: 0.25, size_y: 0.1, diagonals: union-jack }\n"
             "    membrane: { young: 1.0e6, poisson: 0.5, thickness: 0.0001 }\n"
             "    supports:\n"
             "      - { name: left, at: { box: { min: [-1, -1, -1], max: [-0.1249, 1, 1] } } }\n"
             "      - { name: right, at: { box: { min: [0.1249, -1, -1], max: [1, 1, 1] } }, displacement: [0.0125, 0, "
             "0] }\n" STATIC,
             &m, NULL),
        PEL_OK);
    assert_int_equal(pel_sim_step(m.sim, NULL), PEL_OK);
    assert_false(is_unstable(m.sim));
    int32_t count = pel_sim_vertex_count(m.sim, 0);
    double *x = malloc(3 * (size_t)count * sizeof *x), aside = 0;
    pel_sim_get_positions(m.sim, 0, x);
    for (int32_t v = 0; v < count; v++)
        aside = fmax(aside, fabs(x[3 * v + 2]));
    assert_true(aside > 1e-4 && aside < 2e-3);
    free(x);
    destroy(&m);
}

static void check_refusal(const char *text, const char *what)
{
    made m;
    pel_error error;
    assert_int_equal(make(text, &m, &error), PEL_BAD_SCENE);
    assert_non_null(strstr(error.what, what));
    assert_true(error.remedy[0] != '\0' && error.line > 0);
    assert_null(m.scene);
}

static void test_refusals(void **unused)
{
    (void)unused;
    check_refusal("version: 1\nbodies: [ { mesh: { shape: grid }, membrane: { young: 1e6, thickness: 0.01 } } ]\n"
                  "imperfection: { mode: 1, amplitude: 0.001 }\n" STATIC,
                  "no buckling mode 1");
    check_refusal(COLUMN "solver: { method: static, branch: lowest }\n", "needs a path by arc length");
    check_refusal(COLUMN "imperfection: { mode: 1 }\n" STATIC, "amplitude");
}

static pel_status parse(const void *data, pel_error *error)
{
    const char *text = data;
    pel_scene *scene;
    pel_status status = pel_scene_parse("test.yaml", text, strlen(text), NULL, 0, NULL, &scene, error);
    if (status == PEL_OK)
        pel_scene_destroy(scene);
    return status;
}

static void test_allocation_failures(void **unused)
{
    (void)unused;
    skip_if_slow();
    assert_true(for_allocation_failures(parse, COLUMN IMPERFECTION STATIC, 7) > 100);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_imperfect_path),  cmocka_unit_test(test_straight_path),
        cmocka_unit_test(test_leaves_straight), cmocka_unit_test(test_wrinkles),
        cmocka_unit_test(test_lowest_branch),   cmocka_unit_test(test_leaves_just_above),
        cmocka_unit_test(test_refusals),        cmocka_unit_test(test_allocation_failures),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
