/* `tear.level`: bodies that tear have a finer mesh where they do. Paths, lengths, energies, mass and states are those
   of meshes that are as fine everywhere. */
#include "scene/scene_run.h"

#include "pellicle/live.h"
#include "pellicle/tear.h"

#include <math.h>
#include <stdlib.h>

#define HEAD "version: 1\nsolver: { method: static, dt: 0.02 }\nduration: 1\n"
#define BODY(cells)                                                                                                    \
    "bodies:\n  - name: sheet\n"                                                                                       \
    "    mesh: { shape: grid, nx: " cells ", ny: " cells ", size_x: 0.1, size_y: 0.1 }\n"
#define MEMBRANE(toughness)                                                                                            \
    "    membrane: { young: 1e6, thickness: 1e-3, poisson: 0.3, toughness: " toughness " }\n"                          \
    "    bending: { model: none }\n"
#define REST                                                                                                           \
    "    pinned: { box: { min: [-1, -1, -1], max: [1, -0.0499, 1] } }\n"                                               \
    "    supports:\n"                                                                                                  \
    "      - { at: { box: { min: [-1, 0.0499, -1], max: [1, 1, 1] } }, displacement: [0.012, 0.02, 0],\n"              \
    "          keys: [[0, 0], [1, 1]] }\n"                                                                             \
    "      - { at: { box: { min: [-1, -0.0498, -1], max: [1, 0.0498, 1] } }, fix: [z] }\n"                             \
    "cuts:\n  - path: [[-0.05, 0.003, 0], [-0.02, 0.003, 0]]\n"
#define BAND(level) "tear: { level: " level ", region: { box: { min: [-1, -0.016, -1], max: [1, 0.006, 1] } } }\n"
#define SHEET(cells, toughness) HEAD BODY(cells) MEMBRANE(toughness) REST

enum { SAMPLES = 12 };

/* a tear at the end of a run */
typedef struct path {
    double length, mass;
    double y[SAMPLES]; /* at places from the end of the cut on */
} path;

typedef struct point {
    double x, y;
} point;

static int compare_points(const void *a, const void *b)
{
    double d = ((const point *)a)->x - ((const point *)b)->x;
    return (d > 0) - (d < 0);
}

static void read_path(const run *r, path *found)
{
    const pel_mesh *mesh = pel_model_mesh(pel_sim_model(r->sim), 0);
    pel_cut_reading cuts;
    point *points = calloc((size_t)mesh->vertex_count, sizeof *points);
    int32_t *origins = calloc((size_t)mesh->vertex_count, sizeof *origins), count = 0;
    assert_int_equal(pel_sim_get_cuts(r->sim, 0, &cuts, NULL), PEL_OK);
    pel_sim_get_origins(r->sim, 0, origins);
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        if (origins[v] != v)
            points[count++] = (point){mesh->positions[v][0], mesh->positions[v][1]};
    qsort(points, (size_t)count, sizeof *points, compare_points);
    double *masses = calloc((size_t)mesh->vertex_count, sizeof *masses);
    pel_sim_get_masses(r->sim, 0, masses);
    *found = (path){.length = cuts.length};
    long double mass = 0;
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        mass += (long double)masses[v];
    found->mass = (double)mass;
    free(masses);
    for (int32_t i = 0, p = 0; i < SAMPLES; i++) {
        double x = -0.019 + 0.067 * i / (SAMPLES - 1);
        while (p + 2 < count && points[p + 1].x < x)
            p++;
        const point *a = &points[p], *b = &points[p + 1];
        found->y[i] = a->y + (b->y - a->y) * (x - a->x) / (b->x - a->x);
    }
    free(origins);
    free(points);
}

static void tear_until(pel_sim *sim, double time)
{
    pel_error error;
    while (pel_sim_time(sim) < time - 1e-9)
        if (pel_sim_step(sim, &error) != PEL_OK)
            fail_msg("%s", error.what);
}

static path tear_scene(const char *text)
{
    run r;
    path found;
    check_begin(&r, text);
    tear_until(r.sim, 1);
    read_path(&r, &found);
    end(&r);
    return found;
}

/* within a tenth of the edges there, and half a percent */
static void compare_paths(const path *fine, const path *all, double edge)
{
    assert_near(fine->length / all->length, 1, 0.005);
    for (int i = 0; i < SAMPLES; i++)
        assert_near(fine->y[i], all->y[i], 0.1 * edge);
}

static void test_paths(void **unused)
{
    (void)unused;
    path all = tear_scene(SHEET("20", "300")), band = tear_scene(SHEET("10", "300") BAND("1"));
    /* it turns with the pull, by a quarter of its length */
    assert_true(all.y[0] > 0.002 && all.y[SAMPLES - 1] < -0.012);
    compare_paths(&band, &all, 0.005);
    assert_near(band.mass, 0.01, 1e-14 * 0.01);
    if (LONG(1, 0)) {
        all = tear_scene(SHEET("40", "300"));
        path one = tear_scene(SHEET("20", "300") BAND("1")), two = tear_scene(SHEET("10", "300") BAND("2"));
        compare_paths(&one, &all, 0.0025);
        compare_paths(&two, &all, 0.0025);
        one = tear_scene(SHEET("20", "300") "tear: { level: 1 }\n");
        compare_paths(&one, &all, 0.0025);
    }
}

/* energy release rate at the end of the cut, before it grows */
static double rate_of(const char *text)
{
    run r;
    pel_tip tips[2];
    int32_t count;
    check_begin(&r, text);
    tear_until(r.sim, 0.1);
    assert_int_equal(pel_sim_tips(r.sim, 0, tips, 2, &count, NULL), PEL_OK);
    assert_int_equal(count, 1);
    end(&r);
    return tips[0].rate;
}

static void test_rate(void **unused)
{
    (void)unused;
    double all = rate_of(SHEET("40", "1e6")), one = rate_of(SHEET("20", "1e6") BAND("1")),
           two = rate_of(SHEET("10", "1e6") BAND("2"));
    assert_near(one / all, 1, 0.02);
    assert_near(two / all, 1, 0.02);
}

/* the same bits with two threads, and again from a snapshot in the middle of a tear */
static void test_states(void **unused)
{
    (void)unused;
    run r, other;
    pel_snapshot *snapshot;
    check_begin(&r, SHEET("10", "300") BAND("1"));
    other = r;
    other.scene->sim.thread_count = 2;
    assert_int_equal(pel_sim_create(&other.scene->sim, &other.sim, NULL), PEL_OK);
    tear_until(r.sim, 0.9);
    tear_until(other.sim, 0.9);
    assert_true(pel_sim_hash(r.sim) == pel_sim_hash(other.sim));
    assert_int_equal(pel_snapshot_create(r.sim, &snapshot, NULL), PEL_OK);
    tear_until(r.sim, 1);
    uint64_t hash = pel_sim_hash(r.sim);
    assert_int_equal(pel_snapshot_restore(r.sim, snapshot, NULL), PEL_OK);
    assert_true(pel_sim_hash(r.sim) == pel_sim_hash(other.sim) && hash != pel_sim_hash(r.sim));
    tear_until(r.sim, 1);
    assert_true(pel_sim_hash(r.sim) == hash);
    pel_snapshot_destroy(snapshot);
    pel_sim_destroy(other.sim);
    end(&r);
}

static void test_refusals(void **unused)
{
    (void)unused;
    static const refusal cases[] = {
        {HEAD BODY("4") "    springs: { stiffness: 3 }\ntear: { level: 1 }\n", "no body has a toughness"},
        {SHEET("4", "300") "tear: { region: all }\n", "a region without tear.level"},
        {SHEET("4", "300") "tear: { level: 7 }\n", "tear.level is out of range: 7"},
        {SHEET("4", "300") "tear: { level: 1, region: { box: { min: [2, 2, 2], max: [3, 3, 3] } } }\n", "region"},
        {SHEET("70", "300") "tear: { level: 6 }\n", "6 levels of 9800 triangles need"},
        {HEAD BODY("4") MEMBRANE("300") "    refine: { levels: 1, everywhere: true }\ntear: { level: 1 }\n",
         "'refine' and tear.level exclude each other"},
        {HEAD BODY("4") MEMBRANE("300") "    rest: { shape: grid, nx: 4, ny: 4 }\ntear: { level: 1 }\n",
         "'rest' and tear.level exclude each other"},
        {HEAD BODY("4") MEMBRANE("300") "    mass: { per_vertex: 1 }\ntear: { level: 1 }\n",
         "give mass: { total: 25 }, that of its 25 vertices"},
        {HEAD BODY("4") MEMBRANE("300") "    volumetric: { stiffness: 1 }\ntear: { level: 1 }\n",
         "'volumetric.stiffness' and tear.level exclude each other"},
    };
    check_refusals(cases, sizeof cases / sizeof *cases);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_paths),
        cmocka_unit_test(test_rate),
        cmocka_unit_test(test_states),
        cmocka_unit_test(test_refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
