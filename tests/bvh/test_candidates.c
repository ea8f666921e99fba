/* Candidates that are kept from step to step: nothing that touches is lost, nothing comes twice, memory settles. */
#include "check.h"
#include "failing_malloc.h"

#include "bvh/candidates.h"
#include "pellicle/geometry.h"
#include "sample.h"

static pel_candidates *make_candidates(const surface *s, double margin)
{
    pel_candidates *c;
    assert_int_equal(pel_candidates_create((const double(*)[3])s->start, s->vertex_count,
                                           (const int32_t(*)[3])s->triangles, s->triangle_count, margin, INT64_MAX, &c,
                                           NULL),
                     PEL_OK);
    return c;
}

static void update(pel_candidates *c, const surface *s, double thickness, pel_pool *pool)
{
    assert_int_equal(
        pel_candidates_update(c, (const double(*)[3])s->start, (const double(*)[3])s->end, thickness, pool, NULL),
        PEL_OK);
}

static bool same_list(const pel_pair *pairs, size_t count, pair_set *expected)
{
    pair_set found = {0};
    for (size_t i = 0; i < count; i++)
        add_pair(&found, pairs[i]);
    bool same = pairs_equal(&found, expected);
    clear_pairs(&found);
    clear_pairs(expected);
    return same;
}

/* the list is exactly the set of all overlapping pairs of boxes, kept or not */
static void check_lists(const pel_candidates *c)
{
    feature_boxes boxes = make_feature_boxes(c->tree);
    memcpy(boxes.vertices, c->vertex_boxes, (size_t)c->tree->vertex_count * sizeof *c->vertex_boxes);
    fill_feature_boxes(c->tree, &boxes);
    pair_set vertex_face = brute_vertex_face(c->tree, &boxes), edge_edge = brute_edge_edge(c->tree, &boxes);
    assert_true(same_list(c->vertex_face, c->vertex_face_count, &vertex_face));
    assert_true(same_list(c->edge_edge, c->edge_edge_count, &edge_edge));
    free_feature_boxes(&boxes);
}

/* every pair that comes within the thickness at some time is on the list: checked by distances, without any box */
static void check_near_pairs(const pel_candidates *c, const surface *s, double thickness)
{
    pair_set list = {0};
    for (size_t i = 0; i < c->edge_edge_count; i++)
        add_pair(&list, c->edge_edge[i]);
    if (list.count > 0)
        qsort(list.pairs, list.count, sizeof *list.pairs, compare_pairs);
    for (int32_t e = 0; e < 3 * c->tree->triangle_count; e++)
        for (int32_t f = e + 1; f < 3 * c->tree->triangle_count; f++) {
            int32_t a[2], b[2];
            pel_tree_edge_ends(c->tree, e, a);
            pel_tree_edge_ends(c->tree, f, b);
            if (pel_tree_edge(c->tree, e) != e || pel_tree_edge(c->tree, f) != f || shares_vertex(a, 2, b, 2))
                continue;
            bool near = false;
            for (int i = 0; i <= 4 && !near; i++) {
                double p[4][3], weights[4];
                for (int corner = 0; corner < 4; corner++)
                    for (int k = 0; k < 3; k++) {
                        int32_t v = corner < 2 ? a[corner] : b[corner - 2];
                        p[corner][k] = (1 - 0.25 * i) * s->start[v][k] + 0.25 * i * s->end[v][k];
                    }
                near = pel_closest_segment_segment(p[0], p[1], p[2], p[3], weights) < 0.999 * thickness * thickness;
            }
            pel_pair pair = {e, f};
            if (near)
                assert_true(list.count > 0 &&
                            bsearch(&pair, list.pairs, list.count, sizeof pair, compare_pairs) != NULL);
        }
    clear_pairs(&list);
}

/* the sphere turns, shrinks and wobbles at the same time; the end of a step is the start of the next */
static void move(surface *s, const double (*rest)[3], int step, double wobble)
{
    random_state random = {(uint64_t)step};
    double angle = 0.1 * step, scale = pow(0.95, step), c = cos(angle), d = sin(angle);
    for (int32_t v = 0; v < s->vertex_count; v++) {
        const double *x = rest[v];
        memcpy(s->start[v], s->end[v], sizeof s->end[v]);
        double place[3] = {scale * (c * x[0] - d * x[1]) + step, scale * (d * x[0] + c * x[1]), scale * x[2]};
        for (int k = 0; k < 3; k++)
            s->end[v][k] = place[k] + wobble * random_between(&random, -1, 1);
    }
}

static void check_motion(surface s, double margin, double wobble, double thickness, int64_t most_searches)
{
    double(*rest)[3] = malloc((size_t)s.vertex_count * sizeof *rest);
    memcpy(rest, s.start, (size_t)s.vertex_count * sizeof *rest);
    memcpy(s.end, s.start, (size_t)s.vertex_count * sizeof *rest);
    pel_candidates *c = make_candidates(&s, margin);
    for (int step = 0; step < LONG(30, ROUNDS(12, 6)); step++) {
        move(&s, (const double(*)[3])rest, step, wobble);
        update(c, &s, thickness, NULL);
        check_lists(c);
        if (step % 5 == 0)
            check_near_pairs(c, &s, thickness);
    }
    assert_true(c->counts.searches <= most_searches);
    pel_candidates_destroy(c);
    free(rest);
    free_surface(&s);
}

static void test_motion(void **unused)
{
    (void)unused;
    check_motion(make_sphere(5, 0), 0, 0.01, 0.01, 30);
    /* a common motion does not use up the margin; relative motion does occasionally; with too much, nothing is kept */
    check_motion(make_sphere(5, 0), 0.1, 0.002, 0.01, 5);
    check_motion(make_sphere(5, 0), 0.05, 0.02, 0.01, 30);
    check_motion(make_sphere(5, 0), 0.02, 0.1, 0.05, 30);
    check_motion(make_folded_sheet(10, 0), 0.05, 0.005, 0.02, 20);
    check_motion(make_soup(120, 0.2, 4), 0.05, 0.01, 0.03, 30);
}

/* a dent runs around a sphere and stands out of its boxes: only there the tree is searched, and the list stays exact */
static void test_extension(void **unused)
{
    (void)unused;
    for (int threads = ROUNDS(1, 3); threads <= 3; threads += 2) {
        surface s = make_sphere(8, 0);
        pel_pool *pool;
        double(*rest)[3] = malloc((size_t)s.vertex_count * sizeof *rest);
        memcpy(rest, s.start, (size_t)s.vertex_count * sizeof *rest);
        memcpy(s.end, s.start, (size_t)s.vertex_count * sizeof *rest);
        pel_candidates *c = make_candidates(&s, 0.02);
        assert_int_equal(pel_pool_create(threads, &pool, NULL), PEL_OK);
        for (int step = 0; step < ROUNDS(40, 10); step++) {
            const double dent[3] = {cos(0.15 * step), sin(0.15 * step), 0};
            for (int32_t v = 0; v < s.vertex_count; v++) {
                const double *x = rest[v];
                double depth = exp(60 * (x[0] * dent[0] + x[1] * dent[1] - 1));
                memcpy(s.start[v], s.end[v], sizeof s.end[v]);
                for (int k = 0; k < 3; k++)
                    s.end[v][k] = (1 - 1.5 * depth) * x[k];
            }
            update(c, &s, 0.01, pool);
            if (step % LONG(5, 10) == 0)
                check_lists(c);
            if (step % 20 == 0)
                check_near_pairs(c, &s, 0.01);
        }
        assert_true(c->counts.extensions > ROUNDS(5, 1));
        assert_true(c->counts.searches < 20);
        pel_pool_destroy(pool);
        pel_candidates_destroy(c);
        free(rest);
        free_surface(&s);
    }
}

static int32_t group_of_pair(const pel_candidates *c, pel_pair pair, bool edges, bool second)
{
    int32_t feature = second ? pair.second : pair.first;
    bool is_vertex = !edges && !second;
    return (is_vertex ? feature : edges ? pel_tree_corner(c->tree, feature) : c->tree->triangles[feature][0]) / 3 % 2;
}

/* of another's list those of two groups */
static void check_between(const pel_candidates *c, const pel_candidates *all, bool edges)
{
    const pel_pair *pairs = edges ? all->edge_edge : all->vertex_face;
    size_t count = edges ? all->edge_edge_count : all->vertex_face_count;
    pair_set expected = {0};
    for (size_t i = 0; i < count; i++)
        if (group_of_pair(all, pairs[i], edges, false) != group_of_pair(all, pairs[i], edges, true))
            add_pair(&expected, pairs[i]);
    assert_true(expected.count > 0 && expected.count < count);
    assert_true(
        same_list(edges ? c->edge_edge : c->vertex_face, edges ? c->edge_edge_count : c->vertex_face_count, &expected));
}

/* pairs inside the two groups of a soup are neither found nor kept */
static void test_groups(void **unused)
{
    (void)unused;
    surface s = make_soup(150, 0.3, 9);
    double(*rest)[3] = malloc((size_t)s.vertex_count * sizeof *rest);
    int32_t *group_of_vertex = malloc((size_t)s.vertex_count * sizeof *group_of_vertex);
    const uint8_t may_meet[4] = {0, 1, 1, 0};
    memcpy(rest, s.start, (size_t)s.vertex_count * sizeof *rest);
    memcpy(s.end, s.start, (size_t)s.vertex_count * sizeof *rest);
    for (int32_t v = 0; v < s.vertex_count; v++)
        group_of_vertex[v] = v / 3 % 2;
    pel_candidates *c = make_candidates(&s, 0.05), *all = make_candidates(&s, 0.05);
    pel_candidates_use_groups(c, &(pel_collision_groups){group_of_vertex, may_meet, 2, NULL},
                              (const double(*)[3])s.start);
    for (int step = 0; step < 10; step++) {
        /* no common motion, so that the boxes of both are the same whenever they search */
        for (int32_t v = 0; v < s.vertex_count; v++)
            for (int k = 0; k < 3; k++) {
                s.start[v][k] = s.end[v][k];
                s.end[v][k] = rest[v][k] + 0.002 * sin(step + v + k);
            }
        update(c, &s, 0.02, NULL);
        update(all, &s, 0.02, NULL);
        check_between(c, all, false);
        check_between(c, all, true);
        assert_true(10 * c->counts.kept < 6 * all->counts.kept);
    }
    assert_true(c->counts.searches < 5);
    /* what may meet from now on is found */
    const uint8_t every[4] = {1, 1, 1, 1};
    pel_candidates_use_groups(c, &(pel_collision_groups){group_of_vertex, every, 2, NULL}, (const double(*)[3])s.start);
    update(c, &s, 0.02, NULL);
    check_lists(c);
    pel_candidates_destroy(c);
    pel_candidates_destroy(all);
    free(group_of_vertex);
    free(rest);
    free_surface(&s);
}

/* the k-th of some spheres, each a group that does not meet itself */
static void place_spheres(const surface *one, int count, double angle, double (*places)[3])
{
    for (int k = 0; k < count; k++)
        for (int32_t v = 0; v < one->vertex_count; v++) {
            double *x = places[k * one->vertex_count + v];
            const double *y = one->start[v];
            double turn = (k % 2 == 0 ? 1 : -1) * angle;
            x[0] = cos(turn) * y[0] - sin(turn) * y[1] + 1.98 * (k % 3);
            x[1] = sin(turn) * y[0] + cos(turn) * y[1] + 1.98 * (k / 3);
            x[2] = y[2];
        }
}

/* many bodies: nodes have one of them alone, and the pairs between them are those of a search without groups */
static void test_bodies(void **unused)
{
    (void)unused;
    enum { BODIES = 6 };
    surface one = make_sphere(4, 0), s = make_surface(BODIES * one.vertex_count, BODIES * one.triangle_count);
    int32_t *group_of_vertex = malloc((size_t)s.vertex_count * sizeof *group_of_vertex), own = 0;
    uint8_t may_meet[BODIES * BODIES];
    for (int i = 0; i < BODIES * BODIES; i++)
        may_meet[i] = i / BODIES != i % BODIES;
    for (int32_t v = 0; v < s.vertex_count; v++)
        group_of_vertex[v] = v / one.vertex_count;
    for (int32_t h = 0; h < 3 * s.triangle_count; h++) {
        int32_t k = h / (3 * one.triangle_count);
        s.triangles[h / 3][h % 3] = one.triangles[h / 3 - k * one.triangle_count][h % 3] + k * one.vertex_count;
    }
    place_spheres(&one, BODIES, 0, s.end);
    memcpy(s.start, s.end, (size_t)s.vertex_count * sizeof *s.start);
    pel_candidates *c = make_candidates(&s, 0.02), *all = make_candidates(&s, 0.02);
    /* of convex bodies no tree would be needed */
    for (int k = 0; k < BODIES; k++)
        s.start[k * one.vertex_count][2] *= 0.5;
    assert_int_equal(pel_candidates_use_groups(c, &(pel_collision_groups){group_of_vertex, may_meet, BODIES, NULL},
                                               (const double(*)[3])s.start),
                     PEL_OK);
    assert_null(c->hulls);
    for (int step = 1; step < 5; step++) {
        memcpy(s.start, s.end, (size_t)s.vertex_count * sizeof *s.start);
        place_spheres(&one, BODIES, 0.02 * step, s.end);
        update(c, &s, 0.01, NULL);
        update(all, &s, 0.01, NULL);
        for (int edges = 0; edges < 2; edges++) {
            pair_set expected = {0};
            const pel_pair *pairs = edges ? all->edge_edge : all->vertex_face;
            for (size_t i = 0; i < (edges ? all->edge_edge_count : all->vertex_face_count); i++) {
                int32_t a = edges ? pel_tree_corner(c->tree, pairs[i].first) : pairs[i].first;
                int32_t b = edges ? pel_tree_corner(c->tree, pairs[i].second) : c->tree->triangles[pairs[i].second][0];
                if (group_of_vertex[a] != group_of_vertex[b])
                    add_pair(&expected, pairs[i]);
            }
            assert_true(expected.count > 0);
            assert_true(same_list(edges ? c->edge_edge : c->vertex_face,
                                  edges ? c->edge_edge_count : c->vertex_face_count, &expected));
        }
    }
    for (int32_t n = 0; n < c->tree->node_count; n++)
        own += c->tree->node_groups[n] >= 0;
    assert_true(own > 0.8 * c->tree->node_count);
    assert_null(all->tree->node_groups);
    pel_candidates_destroy(c);
    pel_candidates_destroy(all);
    free(group_of_vertex);
    free_surface(&one);
    free_surface(&s);
}

/* a search that kept nothing useful is not repeated every time */
static void test_pause(void **unused)
{
    (void)unused;
    surface s = make_sphere(6, 0);
    double(*rest)[3] = malloc((size_t)s.vertex_count * sizeof *rest);
    memcpy(rest, s.start, (size_t)s.vertex_count * sizeof *rest);
    pel_candidates *c = make_candidates(&s, 1e-3);
    int kept = 0;
    for (int step = 0; step < 60; step++) {
        random_state random = {(uint64_t)step};
        for (int32_t v = 0; v < s.vertex_count; v++)
            s.end[v][0] = rest[v][0] + 0.1 * random_between(&random, -1, 1);
        update(c, &s, 0, NULL);
        kept += c->has_kept;
    }
    assert_true(kept > 0 && kept < 12);
    pel_candidates_destroy(c);
    free(rest);
    free_surface(&s);
}

/* pairs of a long way, as of a whole step, are not carried along by the short ways of its parts */
static void test_waste(void **unused)
{
    (void)unused;
    surface s = make_sphere(8, 0);
    pel_candidates *c = make_candidates(&s, 1e-3);
    for (int32_t v = 0; v < s.vertex_count; v++)
        for (int k = 0; k < 3; k++)
            s.end[v][k] = -0.5 * s.start[v][k];
    update(c, &s, 0, NULL);
    int64_t many = c->counts.kept, last = 0;
    for (int part = 0; part < 4; part++) {
        for (int32_t v = 0; v < s.vertex_count; v++)
            for (int k = 0; k < 3; k++)
                s.end[v][k] = 0.999 * s.start[v][k];
        update(c, &s, 0, NULL);
        check_lists(c);
        last = c->counts.kept;
    }
    assert_true(many > 200 * (int64_t)s.vertex_count && last < many / 10 && c->counts.searches == 2 && c->has_kept);
    pel_candidates_destroy(c);
    free_surface(&s);
}

static void test_threads(void **unused)
{
    (void)unused;
    surface s = make_folded_sheet(24, 0.01);
    pel_candidates *one = make_candidates(&s, 0.03);
    for (int threads = 2; threads <= 4; threads++) {
        pel_pool *pool;
        pel_candidates *many = make_candidates(&s, 0.03);
        assert_int_equal(pel_pool_create(threads, &pool, NULL), PEL_OK);
        for (int step = 0; step < 3; step++) {
            update(one, &s, 0.02, NULL);
            update(many, &s, 0.02, pool);
            assert_true(one->edge_edge_count > 0);
            if (threads == 2) {
                assert_int_equal(one->vertex_face_count, many->vertex_face_count);
                assert_int_equal(one->edge_edge_count, many->edge_edge_count);
                assert_memory_equal(one->vertex_face, many->vertex_face, one->vertex_face_count * sizeof(pel_pair));
                assert_memory_equal(one->edge_edge, many->edge_edge, one->edge_edge_count * sizeof(pel_pair));
            }
        }
        pel_candidates_destroy(many);
        pel_candidates_destroy(one);
        one = make_candidates(&s, 0.03);
        pel_pool_destroy(pool);
    }
    pel_candidates_destroy(one);
    free_surface(&s);
}

/* a surface that crumples gets a new tree */
static void test_rebuild(void **unused)
{
    (void)unused;
    random_state random = {8};
    surface s = make_sphere(12, 0);
    pel_candidates *c = make_candidates(&s, 0);
    update(c, &s, 0, NULL);
    assert_int_equal(c->counts.rebuilds, 0);
    /* opposite points change places: the old order is no good */
    for (int32_t v = 0; v < s.vertex_count; v++) {
        double side = s.start[v][0] > 0 ? 1 : -1, turn = 3 * random_between(&random, 0.9, 1) * s.start[v][2];
        double x = s.start[v][0], y = s.start[v][1];
        s.end[v][0] = side * (cos(turn) * x - sin(turn) * y);
        s.end[v][1] = sin(turn) * x + cos(turn) * y;
        memcpy(s.start[v], s.end[v], sizeof s.end[v]);
    }
    update(c, &s, 0, NULL);
    assert_int_equal(c->counts.rebuilds, 1);
    check_lists(c);
    pel_candidates_destroy(c);
    free_surface(&s);
}

static void test_no_allocation(void **unused)
{
    (void)unused;
    surface s = make_folded_sheet(16, 0.01);
    pel_candidates *c = make_candidates(&s, 0.02);
    update(c, &s, 0.03, NULL);
    failing_malloc_begin(0);
    for (int step = 0; step < 20; step++)
        update(c, &s, step % 3 == 0 ? 0.03 : 0.01, NULL);
    assert_int_equal(failing_malloc_end().calls, 0);
    pel_candidates_destroy(c);
    free_surface(&s);
}

static void test_refusals(void **unused)
{
    (void)unused;
    surface s = make_folded_sheet(8, 0.01);
    pel_error error;
    pel_candidates *c = make_candidates(&s, 0.02);
    update(c, &s, 0.01, NULL);
    size_t before = c->edge_edge_count;
    double x = s.end[7][1];
    s.end[7][1] = nan("");
    assert_int_equal(
        pel_candidates_update(c, (const double(*)[3])s.start, (const double(*)[3])s.end, 0.01, NULL, &error),
        PEL_BAD_ARGUMENT);
    assert_int_equal(error.element, 7);
    assert_int_equal(c->edge_edge_count, 0);
    s.end[7][1] = x;
    /* thicker than everything is large: too many pairs, said and bounded */
    c->search.limit = 5000;
    assert_int_equal(pel_candidates_update(c, (const double(*)[3])s.start, (const double(*)[3])s.end, 10, NULL, &error),
                     PEL_BAD_ARGUMENT);
    assert_int_equal(c->edge_edge_count, 0);
    c->search.limit = INT64_MAX;
    update(c, &s, 0.01, NULL);
    assert_int_equal(c->edge_edge_count, before);
    pel_candidates_destroy(c);
    free_surface(&s);
}

/* near the limit the margin goes, and not a pair with it */
static void test_limit_shrinks_margin(void **unused)
{
    (void)unused;
    surface s = make_folded_sheet(12, 0.01);
    pel_candidates *tight = make_candidates(&s, 0), *c = make_candidates(&s, 0.3);
    update(tight, &s, 0.01, NULL);
    int64_t pairs = (int64_t)(tight->vertex_face_count + tight->edge_edge_count);
    update(c, &s, 0.01, NULL);
    assert_true(c->has_kept && c->counts.kept > pairs);
    pel_candidates_destroy(c);
    c = make_candidates(&s, 0.3);
    c->search.limit = tight->counts.kept;
    for (int n = 0; n < 3; n++) {
        update(c, &s, 0.01, NULL);
        assert_false(c->has_kept);
        assert_int_equal(c->vertex_face_count + c->edge_edge_count, pairs);
        check_lists(c);
    }
    /* the search with the margin is not tried in every step */
    assert_int_equal(c->counts.searches, 4);
    pel_candidates_destroy(c);
    /* kept pairs that would exceed the limit are searched again */
    c = make_candidates(&s, 0.02);
    update(c, &s, 0.01, NULL);
    c->search.limit = c->counts.kept;
    for (int32_t v = 0; v < s.vertex_count / 10; v++)
        s.end[v][2] += 0.5;
    update(c, &s, 0.01, NULL);
    check_lists(c);
    assert_false(c->has_kept);
    pel_candidates_destroy(c);
    pel_candidates_destroy(tight);
    free_surface(&s);
}

static pel_status update_case(const void *data, pel_error *error)
{
    const surface *s = data;
    pel_candidates *c;
    pel_status status =
        pel_candidates_create((const double(*)[3])s->start, s->vertex_count, (const int32_t(*)[3])s->triangles,
                              s->triangle_count, 0.01, INT64_MAX, &c, error);
    if (status != PEL_OK) {
        assert_null(c);
        return status;
    }
    status = pel_candidates_update(c, (const double(*)[3])s->start, (const double(*)[3])s->end, 0.02, NULL, error);
    if (status != PEL_OK)
        assert_true(c->vertex_face_count == 0 && c->edge_edge_count == 0);
    pel_candidates_destroy(c);
    return status;
}

static void test_allocations(void **unused)
{
    (void)unused;
    surface s = make_folded_sheet(6, 0.01);
    assert_true(for_every_allocation_failure(update_case, &s) > 20);
    free_surface(&s);
}

/* numbers out of their ranges, as a damaged snapshot has them, are refused and forgotten */
static void test_damaged_memory(void **unused)
{
    (void)unused;
    surface s = make_sphere(3, 0);
    pel_candidates *c = make_candidates(&s, 0.1);
    update(c, &s, 0.01, NULL);
    int32_t *const counts[] = {&c->kept_uses, &c->pause, &c->pause_length};
    const int32_t bad[] = {-1, INT32_MAX};
    for (size_t i = 0; i < 6; i++) {
        int32_t kept = *counts[i / 2];
        *counts[i / 2] = bad[i % 2];
        if (pel_candidates_recall(c, NULL, NULL) != PEL_BAD_FORMAT || c->has_kept)
            fail_msg("number %d is taken", (int)i);
        *counts[i / 2] = kept;
    }
    c->margin = (double)NAN;
    assert_int_equal(pel_candidates_recall(c, NULL, NULL), PEL_BAD_FORMAT);
    c->margin = 0.1;
    assert_int_equal(pel_candidates_recall(c, NULL, NULL), PEL_OK);
    pel_candidates_destroy(c);
    free_surface(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_damaged_memory),
        cmocka_unit_test(test_motion),
        cmocka_unit_test(test_extension),
        cmocka_unit_test(test_groups),
        cmocka_unit_test(test_bodies),
        cmocka_unit_test(test_pause),
        cmocka_unit_test(test_waste),
        cmocka_unit_test(test_threads),
        cmocka_unit_test(test_rebuild),
        cmocka_unit_test(test_no_allocation),
        cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_allocations),
        cmocka_unit_test(test_limit_shrinks_margin),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
