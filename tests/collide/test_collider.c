/* Detection through the tree against the narrow phase on all pairs: no tunnelling and no other pair, for any margin. */
#include "check.h"
#include "collide/collider.h"
#include "failing_malloc.h"
#include "random.h"

#include "pellicle/collide.h"
#include "pellicle/shape.h"

#include <stdlib.h>

typedef struct moving {
    int32_t vertex_count, triangle_count;
    double (*start)[3], (*end)[3];
    int32_t (*triangles)[3];
} moving;

static moving make_moving(int32_t vertex_count, int32_t triangle_count)
{
    return (moving){vertex_count, triangle_count, calloc((size_t)vertex_count, sizeof(double[3])),
                    calloc((size_t)vertex_count, sizeof(double[3])),
                    calloc((size_t)triangle_count, sizeof(int32_t[3]))};
}

static void free_moving(moving *m)
{
    free(m->start);
    free(m->end);
    free(m->triangles);
}

/* rows x rows vertices over the unit square, from vertex and triangle number `first` on, at a height */
static void add_sheet(moving *m, int32_t vertex, int32_t triangle, int32_t rows, double height)
{
    for (int32_t i = 0; i < rows * rows; i++) {
        m->start[vertex + i][0] = (double)(i % rows) / (rows - 1);
        m->start[vertex + i][1] = (double)(i / rows) / (rows - 1);
        m->start[vertex + i][2] = height;
    }
    for (int32_t i = 0; i < (rows - 1) * (rows - 1); i++) {
        int32_t v = vertex + i / (rows - 1) * rows + i % (rows - 1);
        const int32_t corners[2][3] = {{v, v + 1, v + rows + 1}, {v, v + rows + 1, v + rows}};
        memcpy(m->triangles[triangle + 2 * i], corners, sizeof corners);
    }
}

/* two bumpy sheets; the upper one falls through the lower one within the step */
static moving make_falling_sheet(int32_t rows, double bump, double fall)
{
    random_state random = {4};
    int32_t half = rows * rows, triangles = 2 * (rows - 1) * (rows - 1);
    moving m = make_moving(2 * half, 2 * triangles);
    add_sheet(&m, 0, 0, rows, 0);
    add_sheet(&m, half, triangles, rows, 0.3);
    for (int32_t v = 0; v < m.vertex_count; v++) {
        m.start[v][2] += bump * random_between(&random, -1, 1);
        memcpy(m.end[v], m.start[v], sizeof m.end[v]);
        m.end[v][2] -= v >= half ? fall : 0;
    }
    return m;
}

static moving make_random_sphere(int32_t frequency, double shrink, double noise)
{
    random_state random = {6};
    pel_shape_def def = pel_shape_def_default(PEL_SHAPE_GEODESIC_SPHERE);
    def.frequency = frequency;
    pel_mesh *mesh;
    assert_int_equal(pel_shape_create(&def, &mesh, NULL), PEL_OK);
    moving m = make_moving(mesh->vertex_count, mesh->triangle_count);
    memcpy(m.triangles, mesh->triangles, (size_t)m.triangle_count * sizeof *m.triangles);
    for (int32_t v = 0; v < m.vertex_count; v++)
        for (int k = 0; k < 3; k++) {
            m.start[v][k] = mesh->positions[v][k];
            m.end[v][k] = shrink * mesh->positions[v][k] + noise * random_between(&random, -1, 1);
        }
    pel_mesh_destroy(mesh);
    return m;
}

static pel_collider *make_collider(const moving *m, double margin, int threads)
{
    const pel_mesh mesh = {.vertex_count = m->vertex_count,
                           .triangle_count = m->triangle_count,
                           .positions = m->start,
                           .triangles = m->triangles};
    pel_collider_def def = pel_collider_def_default();
    def.mesh = &mesh;
    def.margin = margin;
    def.thread_count = threads;
    pel_collider *collider;
    assert_int_equal(pel_collider_create(&def, &collider, NULL), PEL_OK);
    return collider;
}

static pel_collision_query make_query(const moving *m, double separation)
{
    pel_collision_query query = pel_collision_query_default();
    query.start = m->start[0];
    query.end = m->end[0];
    query.min_separation = separation;
    query.tolerance = 1e-6;
    return query;
}

static bool is_hit(const moving *m, const int32_t v[4], bool edge_edge, double separation)
{
    double start[4][3], end[4][3];
    for (int i = 0; i < 4; i++) {
        memcpy(start[i], m->start[v[i]], sizeof start[i]);
        memcpy(end[i], m->end[v[i]], sizeof end[i]);
    }
    const double(*s)[3] = (const double(*)[3])start, (*e)[3] = (const double(*)[3])end;
    return edge_edge ? pel_ccd_edge_edge(s, e, separation, 1e-6, NULL)
                     : pel_ccd_vertex_face(s, e, separation, 1e-6, NULL);
}

static bool has(const int32_t *list, int count, int32_t v)
{
    for (int i = 0; i < count; i++)
        if (list[i] == v)
            return true;
    return false;
}

static void ends_of(const moving *m, int32_t h, int32_t ends[2])
{
    ends[0] = m->triangles[h / 3][h % 3];
    ends[1] = m->triangles[h / 3][(h + 1) % 3];
}

/* the half-edges that name edges, rising: no earlier one has the same ends; returns how many */
static int32_t list_edges(const moving *m, int32_t *edges)
{
    int32_t count = 0, ends[2], other[2];
    for (int32_t h = 0; h < 3 * m->triangle_count; h++) {
        bool is_first = true;
        ends_of(m, h, ends);
        for (int32_t i = 0; i < count && is_first; i++) {
            ends_of(m, edges[i], other);
            is_first = !has(other, 2, ends[0]) || !has(other, 2, ends[1]);
        }
        edges[count] = h;
        count += is_first;
    }
    return count;
}

/* all pairs of the surface that hit, in the order of the result */
static int64_t check_against_all_pairs(const moving *m, const pel_collision_result *result, double separation)
{
    int64_t next = 0;
    for (int32_t v = 0; v < m->vertex_count; v++)
        for (int32_t t = 0; t < m->triangle_count; t++) {
            const int32_t *f = m->triangles[t], points[4] = {v, f[0], f[1], f[2]};
            if (has(f, 3, v) || !is_hit(m, points, false, separation))
                continue;
            assert_true(next < result->collision_count);
            const pel_collision *found = &result->collisions[next++];
            assert_true(!found->edge_edge && found->first == v && found->second == t);
            assert_memory_equal(found->vertices, points, sizeof points);
        }
    int32_t *edges = malloc(3 * (size_t)m->triangle_count * sizeof *edges), edge_count = list_edges(m, edges);
    for (int32_t i = 0; i < edge_count; i++)
        for (int32_t k = i + 1; k < edge_count; k++) {
            int32_t points[4], e = edges[i], f = edges[k];
            ends_of(m, e, points);
            ends_of(m, f, points + 2);
            if (has(points, 2, points[2]) || has(points, 2, points[3]) || !is_hit(m, points, true, separation))
                continue;
            assert_true(next < result->collision_count);
            const pel_collision *found = &result->collisions[next++];
            assert_true(found->edge_edge && found->first == e && found->second == f);
            assert_memory_equal(found->vertices, points, sizeof points);
        }
    free(edges);
    assert_int_equal(next, result->collision_count);
    return next;
}

static void check_motion(moving m, double separation, bool expect_some)
{
    const double margins[] = {0, 0.1, -1};
    for (int i = 0; i < 3; i++) {
        pel_collider *collider = make_collider(&m, margins[i], 1);
        pel_collision_query query = make_query(&m, separation);
        pel_collision_candidates candidates;
        pel_collision_result result;
        for (int again = 0; again < 2; again++) {
            assert_int_equal(pel_collider_detect(collider, &query, &result, NULL), PEL_OK);
            pel_collision_result copy = result;
            pel_collision *collisions = malloc((size_t)(result.collision_count + 1) * sizeof *collisions);
            if (result.collision_count > 0)
                memcpy(collisions, result.collisions, (size_t)result.collision_count * sizeof *collisions);
            copy.collisions = collisions;
            assert_int_equal(pel_collider_candidates(collider, &query, &candidates, NULL), PEL_OK);
            int64_t count = copy.collision_count;
            if (ROUNDS(true, i == 2 && again == 0))
                count = check_against_all_pairs(&m, &copy, separation);
            assert_int_equal(count > 0, expect_some);
            assert_int_equal(copy.vertex_face.hits + copy.edge_edge.hits, count);
            free(collisions);
        }
        /* at rest the pairs of the first query are searched separately from candidates */
        assert_true(i == 0 ? candidates.searches == 4 : candidates.searches <= 2);
        pel_collider_destroy(collider);
    }
    free_moving(&m);
}

static void test_no_tunnelling(void **unused)
{
    (void)unused;
    check_motion(make_falling_sheet(7, 0, 0.6), 0, true);
    check_motion(make_falling_sheet(7, 0.05, 0.6), 0, true);
    check_motion(make_falling_sheet(7, 0.05, 50), 0, true);
    check_motion(make_falling_sheet(7, 0, 0.29), 0, false);
    check_motion(make_falling_sheet(7, 0, 0.29), 0.02, true);
    check_motion(make_random_sphere(3, 1, 0), 0, false);
    check_motion(make_random_sphere(3, -1, 0.01), 0, true);
    check_motion(make_random_sphere(3, 0.9, 0.2), 0, true);
}

/* a whole fall in many small steps: the step in which the sheets meet is found, for any kept pairs */
static void test_kept_over_steps(void **unused)
{
    (void)unused;
    moving m = make_falling_sheet(9, 0.01, 0);
    pel_collider *kept = make_collider(&m, 0.05, 1), *fresh = make_collider(&m, 0, 1);
    int hits = 0;
    for (int step = 0; step < 60; step++) {
        for (int32_t v = 0; v < m.vertex_count; v++) {
            memcpy(m.start[v], m.end[v], sizeof m.end[v]);
            m.end[v][2] -= v >= m.vertex_count / 2 ? 0.006 : 0;
        }
        pel_collision_query query = make_query(&m, 1e-3);
        pel_collision_result a, b;
        assert_int_equal(pel_collider_detect(kept, &query, &a, NULL), PEL_OK);
        assert_int_equal(pel_collider_detect(fresh, &query, &b, NULL), PEL_OK);
        assert_int_equal(a.collision_count, b.collision_count);
        for (int64_t i = 0; i < a.collision_count; i++)
            assert_true(a.collisions[i].first == b.collisions[i].first &&
                        a.collisions[i].second == b.collisions[i].second &&
                        a.collisions[i].hit.time_of_impact == b.collisions[i].hit.time_of_impact);
        hits += a.collision_count > 0;
    }
    assert_true(hits > 2 && hits < 30);
    pel_collision_candidates candidates;
    pel_collision_query query = make_query(&m, 1e-3);
    assert_int_equal(pel_collider_candidates(kept, &query, &candidates, NULL), PEL_OK);
    assert_true(candidates.searches < 30);
    pel_collider_destroy(kept);
    pel_collider_destroy(fresh);
    free_moving(&m);
}

static void test_threads(void **unused)
{
    (void)unused;
    moving m = make_falling_sheet(12, 0.01, 0.35);
    pel_collider *one = make_collider(&m, -1, 1), *many = make_collider(&m, -1, 3);
    pel_collision_query query = make_query(&m, 0.001);
    pel_collision_result a, b;
    assert_int_equal(pel_collider_detect(one, &query, &a, NULL), PEL_OK);
    assert_int_equal(pel_collider_detect(many, &query, &b, NULL), PEL_OK);
    assert_true(a.collision_count > 20);
    assert_int_equal(a.collision_count, b.collision_count);
    for (int64_t i = 0; i < a.collision_count; i++) {
        assert_int_equal(a.collisions[i].first, b.collisions[i].first);
        assert_int_equal(a.collisions[i].second, b.collisions[i].second);
        assert_memory_equal(&a.collisions[i].hit, &b.collisions[i].hit, sizeof a.collisions[i].hit);
    }
    assert_memory_equal(&a.edge_edge, &b.edge_edge, sizeof a.edge_edge);
    failing_malloc_begin(0);
    for (int i = 0; i < 5; i++)
        assert_int_equal(pel_collider_detect(one, &query, &a, NULL), PEL_OK);
    assert_int_equal(failing_malloc_end().calls, 0);
    pel_collider_destroy(one);
    pel_collider_destroy(many);
    free_moving(&m);
}

/* the straight way comes within the separation of the query */
static bool comes_near(const void *context, pel_collision *pair)
{
    return is_hit(context, pair->vertices, pair->edge_edge, 0.06);
}

/* Where most pairs come near, further searches measure all of them: they list the same. */
static void test_measure(void **unused)
{
    (void)unused;
    moving m = make_falling_sheet(8, 0.004, 0.28);
    pel_collider *collider = make_collider(&m, -1, 1);
    const pel_pair_test test = {.measure = comes_near, .context = &m};
    int64_t found = 0;
    for (int step = 0; step < 12; step++) {
        pel_collider *own = make_collider(&m, -1, 1);
        pel_collision_query query = make_query(&m, 0.06);
        pel_collision_result a, b;
        assert_int_equal(pel_collider_list(collider, &query, &test, &a, NULL), PEL_OK);
        assert_int_equal(pel_collider_list(own, &query, &test, &b, NULL), PEL_OK);
        assert_int_equal(a.collision_count, b.collision_count);
        for (int64_t i = 0; i < a.collision_count; i++)
            assert_true(a.collisions[i].edge_edge == b.collisions[i].edge_edge &&
                        a.collisions[i].first == b.collisions[i].first &&
                        a.collisions[i].second == b.collisions[i].second);
        found += a.collision_count;
        pel_collider_destroy(own);
        for (int32_t v = m.vertex_count / 2; v < m.vertex_count; v++) {
            m.start[v][2] = m.end[v][2];
            m.start[v][0] = m.end[v][0] += 0.01;
        }
    }
    assert_true(found > 1000);
    pel_collider_destroy(collider);
    free_moving(&m);
}

static void test_refusals(void **unused)
{
    (void)unused;
    moving m = make_falling_sheet(4, 0, 0.1);
    pel_mesh mesh = {.vertex_count = m.vertex_count,
                     .triangle_count = m.triangle_count,
                     .positions = m.start,
                     .triangles = m.triangles};
    pel_collider_def def = {0};
    pel_collider *collider;
    pel_error error;
    assert_int_equal(pel_collider_create(&def, &collider, &error), PEL_BAD_ARGUMENT);
    def = pel_collider_def_default();
    assert_int_equal(pel_collider_create(&def, &collider, &error), PEL_BAD_ARGUMENT);
    def.mesh = &mesh;
    def.margin = nan("");
    assert_int_equal(pel_collider_create(&def, &collider, &error), PEL_BAD_ARGUMENT);
    def.margin = -1;
    m.triangles[3][1] = m.triangles[3][0];
    assert_int_equal(pel_collider_create(&def, &collider, &error), PEL_BAD_MESH);
    assert_int_equal(error.element, 3);
    m.triangles[3][1] = m.triangles[3][2] + 1;
    def.memory_limit = 320;
    assert_int_equal(pel_collider_create(&def, &collider, &error), PEL_OK);

    pel_collision_result result;
    pel_collision_query query = make_query(&m, -1);
    assert_int_equal(pel_collider_detect(collider, &query, &result, &error), PEL_BAD_ARGUMENT);
    query = make_query(&m, 100);
    assert_int_equal(pel_collider_detect(collider, &query, &result, &error), PEL_BAD_ARGUMENT);
    assert_non_null(strstr(error.what, "more than 10 pairs"));
    query = make_query(&m, 0);
    query.tolerance = nan("");
    assert_int_equal(pel_collider_detect(collider, &query, &result, &error), PEL_BAD_ARGUMENT);
    query = make_query(&m, 0);
    query.near = nan("");
    assert_int_equal(pel_collider_detect(collider, &query, &result, &error), PEL_BAD_ARGUMENT);
    query = make_query(&m, 0);
    query.end = NULL;
    assert_int_equal(pel_collider_detect(collider, &query, &result, &error), PEL_BAD_ARGUMENT);
    m.end[5][0] = HUGE_VAL;
    query = make_query(&m, 0);
    assert_int_equal(pel_collider_detect(collider, &query, &result, &error), PEL_BAD_ARGUMENT);
    assert_int_equal(error.element, 5);
    assert_int_equal(result.collision_count, 0);
    pel_collider_destroy(collider);
    pel_collider_destroy(NULL);
    free_moving(&m);
}

/* a sheet that crumples into a point, so that all its parts come near each other: a million pairs and more */
static void test_crumpled_sheet(void **unused)
{
    (void)unused;
    enum { ROWS = 24 };
    moving m = make_moving(ROWS * ROWS, 2 * (ROWS - 1) * (ROWS - 1));
    add_sheet(&m, 0, 0, ROWS, 0);
    for (int32_t v = 0; v < m.vertex_count; v++)
        for (int k = 0; k < 3; k++)
            m.end[v][k] = 0.5 - 0.01 * m.start[v][k];
    pel_collider *collider = make_collider(&m, -1, 1);
    pel_collision_query query = make_query(&m, 0);
    pel_collision_candidates candidates;
    assert_int_equal(pel_collider_candidates(collider, &query, &candidates, NULL), PEL_OK);
    assert_true(candidates.vertex_face_count + candidates.edge_edge_count > 1000000);
    pel_collider_destroy(collider);
    free_moving(&m);
}

static pel_status detect_case(const void *data, pel_error *error)
{
    const moving *m = data;
    const pel_mesh mesh = {.vertex_count = m->vertex_count,
                           .triangle_count = m->triangle_count,
                           .positions = m->start,
                           .triangles = m->triangles};
    pel_collider_def def = pel_collider_def_default();
    def.mesh = &mesh;
    pel_collider *collider;
    pel_status status = pel_collider_create(&def, &collider, error);
    if (status != PEL_OK) {
        assert_null(collider);
        return status;
    }
    pel_collision_query query = make_query(m, 0);
    pel_collision_result result;
    status = pel_collider_detect(collider, &query, &result, error);
    assert_int_equal(result.collision_count > 0, status == PEL_OK);
    pel_collider_destroy(collider);
    return status;
}

static void test_allocations(void **unused)
{
    (void)unused;
    moving m = make_falling_sheet(5, 0, 0.6);
    assert_true(for_every_allocation_failure(detect_case, &m) > 20);
    free_moving(&m);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_no_tunnelling), cmocka_unit_test(test_kept_over_steps),
        cmocka_unit_test(test_threads),       cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_measure),       cmocka_unit_test(test_crumpled_sheet),
        cmocka_unit_test(test_allocations),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
