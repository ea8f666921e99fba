/* Paths over surfaces: where they run, how long they are, and the triangles that they leave. */
#include "sample.h"

#include "base/memory.h"
#include "math/vec3.h"
#include "mesh/opening.h"
#include "mesh/path.h"
#include "pellicle/shape.h"
#include "random.h"

#define DEGREE 0.017453292519943295

static pel_mesh *make_surface(const pel_shape_def *def)
{
    pel_mesh *mesh;
    assert_int_equal(pel_shape_create(def, &mesh, NULL), PEL_OK);
    return mesh;
}

/* a unit sheet whose inner vertices are moved about */
static pel_mesh *make_sheet(int32_t n, int variant, random_state *random)
{
    static const pel_grid_diagonals diagonals[3] = {PEL_GRID_UNION_JACK, PEL_GRID_ONE_DIAGONAL, PEL_GRID_EQUILATERAL};
    pel_shape_def def = pel_shape_def_default(PEL_SHAPE_GRID);
    def.nx = def.ny = n;
    def.size_x = def.size_y = 1;
    def.diagonals = diagonals[variant % 3];
    pel_mesh *mesh = make_surface(&def);
    double low[3], high[3], rough = variant < 3 ? 0 : 0.2;
    pel_mesh_box(mesh, low, high);
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        for (int c = 0; c < 2; c++) {
            double *x = mesh->positions[v];
            if (x[c] > low[c] + 0.1 / n && x[c] < high[c] - 0.1 / n && x[1 - c] > low[1 - c] + 0.1 / n &&
                x[1 - c] < high[1 - c] - 0.1 / n)
                x[c] += random_between(random, -rough, rough) / n;
        }
    return mesh;
}

typedef struct traced {
    pel_mesh *mesh;
    pel_topology *topology;
    uint8_t *marks;
    pel_path_trace trace;
    pel_error error;
} traced;

static pel_status trace_on(pel_mesh *mesh, const double (*points)[3], int32_t count, traced *t)
{
    memset(t, 0, sizeof *t);
    t->mesh = mesh;
    assert_int_equal(pel_topology_create(mesh, &t->topology, NULL), PEL_OK);
    t->marks = calloc((size_t)mesh->vertex_count, 1);
    return pel_path_trace_points(mesh, t->topology, points, count, t->marks, &t->trace, &t->error);
}

static void end_trace(traced *t)
{
    pel_free(t->trace.vertices);
    free(t->marks);
    pel_topology_destroy(t->topology);
    pel_mesh_destroy(t->mesh);
}

static double angle(const double a[3], const double b[3], const double c[3])
{
    double u[3], v[3];
    pel_vec3_subtract(b, a, u);
    pel_vec3_subtract(c, a, v);
    return acos(pel_vec3_dot(u, v) / pel_vec3_length(u) / pel_vec3_length(v));
}

/* edges join the vertices, each of which is in the path once, and no triangle is thin or turned */
static void check_path(const traced *t, bool is_shut, double least)
{
    int32_t count = t->trace.count;
    for (int32_t i = 0; i + 1 < count; i++) {
        int32_t e = pel_topology_edge_between(t->topology, t->trace.vertices[i], t->trace.vertices[i + 1]);
        assert_true(e >= 0 && t->topology->twin[t->topology->half_edge_of_edge[e]] >= 0);
        for (int32_t j = i + 1; j < count; j++)
            assert_true(t->trace.vertices[i] != t->trace.vertices[j] || (is_shut && i == 0 && j == count - 1));
    }
    assert_true((t->trace.vertices[0] == t->trace.vertices[count - 1]) == is_shut);
    for (int32_t k = 0; k < t->mesh->triangle_count; k++) {
        const int32_t *v = t->mesh->triangles[k];
        for (int c = 0; c < 3; c++)
            assert_true(angle(t->mesh->positions[v[c]], t->mesh->positions[v[(c + 1) % 3]],
                              t->mesh->positions[v[(c + 2) % 3]]) >= least * DEGREE);
    }
}

static double length_of(const traced *t)
{
    double sum = 0;
    for (int32_t i = 0; i + 1 < t->trace.count; i++)
        sum +=
            pel_vec3_distance(t->mesh->positions[t->trace.vertices[i]], t->mesh->positions[t->trace.vertices[i + 1]]);
    return sum;
}

/* six kinds of meshes of three sizes: vertices lie within 0.1 of an edge of the line, but for one line of ten */
static void test_lines(void **unused)
{
    (void)unused;
    random_state random = {7};
    int off = 0, rounds = ROUNDS(36, 9);
    for (int round = 0; round < rounds; round++) {
        int32_t n = 8 << round % 3;
        pel_mesh *mesh = make_sheet(n, round / 3 % 6, &random);
        double turn = random_between(&random, 0, 6.28), across[3] = {-sin(turn), cos(turn), 0}, worst = 0;
        const double points[2][3] = {{-0.35 * cos(turn), -0.35 * sin(turn), 0},
                                     {0.35 * cos(turn), 0.35 * sin(turn), 0}};
        traced t;
        assert_int_equal(trace_on(mesh, points, 2, &t), PEL_OK);
        check_path(&t, false, 6);
        for (int32_t i = 0; i < t.trace.count; i++)
            worst = fmax(worst, fabs(pel_vec3_dot(across, mesh->positions[t.trace.vertices[i]])));
        off += worst > 0.1 / n;
        assert_true(worst < 0.3 / n);
        assert_near(length_of(&t), 0.7, 0.5 / n);
        end_trace(&t);
    }
    assert_true(10 * off <= rounds);
}

/* from border to border: the ends slide along it */
static void test_borders(void **unused)
{
    (void)unused;
    random_state random = {9};
    for (int round = 0; round < ROUNDS(24, 4); round++) {
        int32_t n = 10 << round % 2;
        pel_mesh *mesh = make_sheet(n, 3 * (round % 2) + round / 2 % 2, &random);
        const double points[2][3] = {{random_between(&random, -0.4, 0.4), -0.5, 0},
                                     {random_between(&random, -0.4, 0.4), 0.5, 0}};
        traced t;
        assert_int_equal(trace_on(mesh, points, 2, &t), PEL_OK);
        check_path(&t, false, 6);
        int32_t ends[2] = {t.trace.vertices[0], t.trace.vertices[t.trace.count - 1]};
        for (int e = 0; e < 2; e++) {
            assert_true(t.topology->twin[t.topology->corner_of_vertex[ends[e]]] < 0);
            assert_near(pel_vec3_distance(mesh->positions[ends[e]], points[e]), 0, 0.3 / n);
        }
        end_trace(&t);
    }
}

/* circles in a sheet and on a ball come back to their first vertex */
static void test_circles(void **unused)
{
    (void)unused;
    random_state random = {2};
    for (int round = 0; round < ROUNDS(12, 3); round++) {
        enum { POINTS = 33 };
        double points[POINTS][3], height = round % 2 == 0 ? 0 : 0.8, radius = round % 2 == 0 ? 0.3 : 0.6;
        pel_shape_def ball = pel_shape_def_default(PEL_SHAPE_GEODESIC_SPHERE);
        ball.frequency = 12;
        pel_mesh *mesh = round % 2 == 0 ? make_sheet(16, round / 2 % 6, &random) : make_surface(&ball);
        double turn = random_between(&random, 0, 6.28);
        for (int i = 0; i < POINTS; i++) {
            double at = turn + 6.283185307179586 * i / (POINTS - 1);
            pel_vec3_set(points[i], radius * cos(at), radius * sin(at), height);
        }
        pel_vec3_copy(points[0], points[POINTS - 1]);
        traced t;
        pel_status status = trace_on(mesh, (const double(*)[3])(void *)points, POINTS, &t);
        if (status != PEL_OK)
            fail_msg("round %d: %s", round, t.error.what);
        check_path(&t, true, 6);
        assert_near(length_of(&t) / (6.283185307179586 * radius), 1, 0.03);
        end_trace(&t);
    }
}

/* points far apart on a ball: the line between them is deep inside, the path goes over the surface above it */
static void test_chords(void **unused)
{
    (void)unused;
    random_state random = {5};
    for (int round = 0; round < ROUNDS(12, 4); round++) {
        pel_shape_def ball = pel_shape_def_default(PEL_SHAPE_GEODESIC_SPHERE);
        ball.frequency = 30;
        double turn = random_between(&random, 0, 6.28), height = random_between(&random, -0.1, 0.1), arc = 0.86;
        const double points[2][3] = {{cos(turn), sin(turn), height}, {cos(turn + arc), sin(turn + arc), height}};
        traced t;
        pel_status status = trace_on(make_surface(&ball), points, 2, &t);
        if (status != PEL_OK)
            fail_msg("round %d: %s", round, t.error.what);
        check_path(&t, false, 6);
        assert_near(length_of(&t) / arc, 1, 0.03);
        end_trace(&t);
    }
}

/* a bend has a vertex */
static void test_bends(void **unused)
{
    (void)unused;
    random_state random = {4};
    const double points[4][3] = {{-0.31, -0.2, 0}, {0.21, -0.23, 0}, {0.17, 0.28, 0}, {-0.22, 0.13, 0}};
    for (int variant = 0; variant < 6; variant++) {
        traced t;
        assert_int_equal(trace_on(make_sheet(14, variant, &random), points, 4, &t), PEL_OK);
        check_path(&t, false, 6);
        for (int p = 0; p < 4; p++) {
            double least = HUGE_VAL;
            for (int32_t i = 0; i < t.trace.count; i++)
                least = fmin(least, pel_vec3_distance(t.mesh->positions[t.trace.vertices[i]], points[p]));
            assert_true(least < 0.3 / 14);
        }
        end_trace(&t);
    }
}

static void test_refusals(void **unused)
{
    (void)unused;
    random_state random = {1};
    const struct {
        double points[3][3];
        const char *words, *remedy;
    } faults[] = {
        {{{2, 0, 0}, {0, 0, 0}, {0, 0.2, 0}}, "begins off the surface", "1.5 m away"},
        {{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, "leaves the surface", "end it at the border"},
        {{{-0.3, 0, 0}, {0, 0, 3}, {0.3, 0, 0}}, "the point (0, 0, 3) of the path lies 3 m off the surface", "at rest"},
        {{{-0.3, 0, 0}, {0, 0, 0.26}, {0.3, 0, 0}}, "the point (0, 0, 0.26) of the path lies 0.26 m off", "at rest"},
        {{{-0.3, 0, 0}, {0, 0, 0}, {0.2, 0, -0.4}}, "the point (0.2, 0, -0.4) of the path lies 0.4 m off", "at rest"},
        {{{-0.3, 0, 0}, {0.3, 0, 0}, {-0.3, 0.001, 0}}, "finds no edge", "refine the mesh"}};
    for (size_t f = 0; f < sizeof faults / sizeof *faults; f++) {
        traced t;
        assert_int_equal(trace_on(make_sheet(10, 0, &random), faults[f].points, 3, &t), PEL_BAD_ARGUMENT);
        if (strstr(t.error.what, faults[f].words) == NULL || strstr(t.error.remedy, faults[f].remedy) == NULL)
            fail_msg("%s. %s", t.error.what, t.error.remedy);
        end_trace(&t);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_lines), cmocka_unit_test(test_borders), cmocka_unit_test(test_circles),
        cmocka_unit_test(test_bends), cmocka_unit_test(test_chords),  cmocka_unit_test(test_refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
