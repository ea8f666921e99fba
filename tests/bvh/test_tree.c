/* Trees and searches against brute force. */
#include "check.h"
#include "failing_malloc.h"
#include "random.h"

#include "base/memory.h"
#include "bvh/candidates.h"
#include "sample.h"

#include <stdlib.h>

/* ---- structure ---- */

static pel_tree *make_tree(const surface *s, pel_tree_content content)
{
    pel_tree *tree;
    assert_int_equal(pel_tree_create((const double(*)[3])s->start, s->vertex_count, (const int32_t(*)[3])s->triangles,
                                     s->triangle_count, content, &tree, NULL),
                     PEL_OK);
    return tree;
}

/* every triangle is in exactly one lane, and every vertex and edge belongs to exactly one triangle that has it */
static void check_members(const pel_tree *tree)
{
    int32_t count = tree->triangle_count;
    uint8_t *triangles = calloc((size_t)count, 1), *vertices = calloc((size_t)tree->vertex_count, 1);
    uint8_t *edges = calloc(3 * (size_t)count, 1);
    for (int32_t i = 0; i < PEL_LANES * tree->leaf_count; i++) {
        int32_t t = tree->leaves[i / PEL_LANES][i % PEL_LANES];
        assert_int_equal(t < 0, i >= count);
        if (t >= 0)
            triangles[t]++;
    }
    for (int32_t t = 0; t < count; t++)
        assert_int_equal(triangles[t], 1);
    for (int32_t h = 0; tree->features != NULL && h < 3 * count; h++) {
        edges[pel_tree_edge(tree, h)] += tree->features[h / 3] >> h % 3 & 1;
        vertices[pel_tree_corner(tree, h)] += tree->features[h / 3] >> (3 + h % 3) & 1;
    }
    for (int32_t h = 0; tree->features != NULL && h < 3 * count; h++) {
        assert_int_equal(edges[h], pel_tree_edge(tree, h) == h);
        assert_int_equal(vertices[pel_tree_corner(tree, h)], 1);
    }
    free(triangles);
    free(vertices);
    free(edges);
}

/* an edge has one name, the first half-edge along it, and the opposite corners of its first two triangles */
static void test_edges(void **unused)
{
    (void)unused;
    /* three triangles on the edge 0, 1, and a border */
    const int32_t triangles[4][3] = {{2, 0, 1}, {1, 0, 3}, {0, 1, 4}, {2, 5, 0}};
    const double positions[6][3] = {{0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, -1, 0}, {-1, 1, 0}};
    pel_tree *tree;
    assert_int_equal(pel_tree_create(positions, 6, triangles, 4, PEL_TREE_FEATURES, &tree, NULL), PEL_OK);
    int32_t ends[2], across[2];
    const int32_t shared[3] = {1, 3, 6};
    for (int i = 0; i < 3; i++)
        assert_int_equal(pel_tree_edge(tree, shared[i]), 1);
    pel_tree_edge_ends(tree, 1, ends);
    pel_tree_edge_opposites(tree, 1, across);
    assert_true(ends[0] == 0 && ends[1] == 1 && across[0] == 2 && across[1] == 3);
    assert_int_equal(pel_tree_edge(tree, 11), 0);
    pel_tree_edge_opposites(tree, 0, across);
    assert_true(across[0] == 1 && across[1] == 5);
    assert_int_equal(pel_tree_edge(tree, 2), 2);
    pel_tree_edge_opposites(tree, 2, across);
    assert_true(across[0] == 0 && across[1] == -1);
    pel_tree_destroy(tree);
}

static void test_members(void **unused)
{
    (void)unused;
    for (int32_t count = 1; count < 60; count++) {
        surface s = make_soup(count, 0.3, (uint64_t)count);
        pel_tree *tree = make_tree(&s, PEL_TREE_FEATURES);
        check_members(tree);
        pel_tree_rebuild(tree, (const double(*)[3])s.end);
        check_members(tree);
        pel_tree_destroy(tree);
        tree = make_tree(&s, PEL_TREE_TRIANGLES);
        check_members(tree);
        pel_tree_destroy(tree);
        free_surface(&s);
    }
}

/* ---- frames and boxes ---- */

static void random_frame(random_state *random, pel_frame *frame)
{
    for (int k = 0; k < 3; k++) {
        frame->origin[0][k] = random_between(random, -1, 1);
        frame->origin[1][k] = random_between(random, -1, 1);
        for (int j = 0; j < 3; j++)
            frame->matrix[k][j] = random_between(random, -1.5, 1.5);
    }
}

/* points along the path, in long double, and points at most reach away from each other */
static void test_boxes_hold_points(void **unused)
{
    (void)unused;
    random_state random = {7};
    const double scales[] = {1e-30, 1e-6, 1, 1e6, 1e30};
    for (int trial = 0; trial < 20000; trial++) {
        double scale = scales[trial % 5], place[2][2][3];
        pel_frame frame;
        random_frame(&random, &frame);
        for (int k = 0; k < 3; k++)
            frame.origin[0][k] *= scale, frame.origin[1][k] *= scale;
        for (int i = 0; i < 12; i++)
            (&place[0][0][0])[i] = scale * random_between(&random, -1, 1);
        /* the second point comes within reach of the first at the end of the step */
        double direction[3], length = 0, reach = scale * random_between(&random, 0, 0.5);
        for (int k = 0; k < 3; k++) {
            direction[k] = random_normal(&random);
            length += direction[k] * direction[k];
        }
        for (int k = 0; k < 3; k++)
            place[1][1][k] = place[1][0][k] + 0.999999 * reach * direction[k] / sqrt(length);
        pel_motion motion = {(const double(*)[3])place[0], (const double(*)[3])place[1], 2};
        pel_box boxes[2];
        assert_int_equal(pel_boxes_of_motion(&frame, &motion, reach, NULL, boxes), -1);
        assert_true(pel_box_overlaps(&boxes[0], &boxes[1]));
        for (int i = 0; i < 2; i++) {
            double t = random_between(&random, 0, 1);
            for (int k = 0; k < 3; k++) {
                long double y = 0;
                for (int j = 0; j < 3; j++)
                    y += (long double)frame.matrix[k][j] *
                         ((1 - (long double)t) * ((long double)place[0][i][j] - (long double)frame.origin[0][j]) +
                          (long double)t * ((long double)place[1][i][j] - (long double)frame.origin[1][j]));
                assert_true((long double)boxes[i].low[k] <= y && y <= (long double)boxes[i].high[k]);
            }
        }
    }
}

static void test_not_finite(void **unused)
{
    (void)unused;
    double points[3][3] = {{0, 0, 0}, {1, 1, 1}, {0, nan(""), 0}};
    pel_motion motion = {(const double(*)[3])points, (const double(*)[3])points, 3};
    pel_box boxes[3];
    pel_frame frame = pel_frame_at((double[3]){0, 0, 0});
    assert_int_equal(pel_boxes_of_motion(&frame, &motion, 0, NULL, boxes), 2);
    points[1][0] = HUGE_VAL;
    assert_int_equal(pel_boxes_of_motion(&frame, &motion, 0, NULL, boxes), 1);
}

/* an affine motion is followed: in the frame the points are where they were */
static void test_follow(void **unused)
{
    (void)unused;
    random_state random = {3};
    surface s = make_soup(100, 0.2, 5);
    double(*before)[3] = malloc((size_t)s.vertex_count * sizeof *before);
    pel_motion rest = {(const double(*)[3])s.start, (const double(*)[3])s.start, s.vertex_count};
    pel_motion now = {(const double(*)[3])s.end, (const double(*)[3])s.end, s.vertex_count};
    pel_frame frame = pel_frame_centre(&rest);
    assert_int_equal(pel_frame_sample_count(s.vertex_count), s.vertex_count);
    pel_frame_sample(&frame, &rest, before);
    for (int trial = 0; trial < 20; trial++) {
        double rotation[9], scale = random_between(&random, 0.2, 3);
        random_rotation(&random, rotation);
        for (int32_t v = 0; v < s.vertex_count; v++)
            for (int k = 0; k < 3; k++) {
                const double *x = s.start[v];
                s.end[v][k] =
                    scale * (rotation[3 * k] * x[0] + rotation[3 * k + 1] * x[1] + rotation[3 * k + 2] * x[2]) + 10;
            }
        frame = pel_frame_follow(&now, (const double(*)[3])before);
        for (int32_t v = 0; v < s.vertex_count; v++)
            for (int k = 0; k < 3; k++) {
                double y = 0;
                for (int j = 0; j < 3; j++)
                    y += frame.matrix[k][j] * (s.end[v][j] - frame.origin[0][j]);
                assert_near(y, before[v][k], 1e-2);
            }
    }
    /* a flat sheet and a point can be followed too */
    for (int32_t v = 0; v < s.vertex_count; v++)
        before[v][2] = s.end[v][2] = 0;
    frame = pel_frame_follow(&now, (const double(*)[3])before);
    for (int i = 0; i < 9; i++)
        assert_true(isfinite(frame.matrix[i / 3][i % 3]));
    now.vertex_count = 1;
    memset(before[0], 0, sizeof before[0]);
    frame = pel_frame_follow(&now, (const double(*)[3])before);
    assert_true(frame.matrix[0][0] == 1 && frame.matrix[0][1] == 0);
    free(before);
    free_surface(&s);
}

/* no points, and points that are nowhere, leave the frame where it is */
static void test_centre_of_nothing(void **unused)
{
    (void)unused;
    const double nowhere[1][3] = {{(double)INFINITY, (double)NAN, 3}};
    for (int32_t count = 0; count < 2; count++) {
        pel_frame frame = pel_frame_centre(&(pel_motion){nowhere, nowhere, count});
        for (int i = 0; i < 2; i++) {
            assert_true(frame.origin[i][0] == 0 && frame.origin[i][1] == 0);
            assert_true(frame.origin[i][2] == 3.0 * count);
        }
    }
}

/* ---- searches ---- */

static void fit(pel_tree *tree, const surface *s, double reach, pel_box *boxes)
{
    pel_motion motion = {(const double(*)[3])s->start, (const double(*)[3])s->end, s->vertex_count};
    pel_frame frame = pel_frame_at((double[3]){0.5, 0.5, 0.5});
    assert_int_equal(pel_boxes_of_motion(&frame, &motion, reach, NULL, boxes), -1);
    pel_tree_refit(tree, boxes, NULL);
}

static bool list_equals(const pel_pair_search *search, pel_pair_kind kind, pair_set *expected)
{
    pair_set found = {0};
    for (int chunk = 0; chunk < PEL_SEARCH_CHUNKS; chunk++)
        for (size_t i = 0; i < search->chunks[chunk].lists[kind].count; i++)
            add_pair(&found, search->chunks[chunk].lists[kind].pairs[i]);
    bool same = pairs_equal(&found, expected);
    clear_pairs(&found);
    clear_pairs(expected);
    return same;
}

static void check_within(const surface *s, double reach)
{
    pel_tree *tree = make_tree(s, PEL_TREE_FEATURES);
    feature_boxes boxes = make_feature_boxes(tree);
    pel_pair_search search;
    pel_pair_search_begin(&search, INT64_MAX);
    for (int rebuilt = 0; rebuilt < 2; rebuilt++) {
        if (rebuilt)
            pel_tree_rebuild(tree, (const double(*)[3])s->end);
        fit(tree, s, reach, boxes.vertices);
        fill_feature_boxes(tree, &boxes);
        assert_int_equal(pel_find_pairs(tree, tree, 15u, NULL, &search, NULL), PEL_OK);
        pair_set vertex_face = brute_vertex_face(tree, &boxes), edge_edge = brute_edge_edge(tree, &boxes);
        pair_set face_face = brute_face_face(tree, &boxes);
        assert_true(vertex_face.count + edge_edge.count + face_face.count > 0 || s->triangle_count < 4);
        assert_true(list_equals(&search, PEL_PAIR_VERTEX_FACE, &vertex_face));
        assert_true(list_equals(&search, PEL_PAIR_EDGE_EDGE, &edge_edge));
        assert_true(list_equals(&search, PEL_PAIR_FACE_FACE, &face_face));
        assert_int_equal(pel_pair_search_count(&search, PEL_PAIR_FACE_VERTEX), 0);
    }
    pel_pair_search_clear(&search);
    free_feature_boxes(&boxes);
    pel_tree_destroy(tree);
}

static void test_pairs_within(void **unused)
{
    (void)unused;
    for (int32_t count = 1; count < 400; count = 1 + count * 3 / 2) {
        surface soup = make_soup(count, 0.3, (uint64_t)count);
        check_within(&soup, 0);
        check_within(&soup, 0.05);
        free_surface(&soup);
    }
    surface sheet = make_folded_sheet(16, 0.02);
    check_within(&sheet, 0);
    check_within(&sheet, 0.1);
    free_surface(&sheet);
    surface sphere = make_sphere(8, 0.02);
    check_within(&sphere, 0.001);
    free_surface(&sphere);
}

static void test_pairs_between(void **unused)
{
    (void)unused;
    for (int32_t count = 1; count < 300; count = 2 + count * 2) {
        surface a = make_soup(count, 0.3, (uint64_t)count), b = make_soup(301 - count, 0.3, 99);
        pel_tree *first = make_tree(&a, PEL_TREE_FEATURES), *second = make_tree(&b, PEL_TREE_FEATURES);
        feature_boxes x = make_feature_boxes(first), y = make_feature_boxes(second);
        fit(first, &a, 0.01, x.vertices);
        fit(second, &b, 0.01, y.vertices);
        fill_feature_boxes(first, &x);
        fill_feature_boxes(second, &y);
        pel_pair_search search;
        pel_pair_search_begin(&search, INT64_MAX);
        assert_int_equal(pel_find_pairs(first, second, 15u, NULL, &search, NULL), PEL_OK);
        pair_set vf = brute_between(x.vertices, a.vertex_count, y.triangles, b.triangle_count);
        pair_set fv = brute_between(x.triangles, a.triangle_count, y.vertices, b.vertex_count);
        pair_set ee = brute_between(x.edges, 3 * a.triangle_count, y.edges, 3 * b.triangle_count);
        pair_set ff = brute_between(x.triangles, a.triangle_count, y.triangles, b.triangle_count);
        assert_true(ff.count > 0);
        assert_true(list_equals(&search, PEL_PAIR_VERTEX_FACE, &vf));
        assert_true(list_equals(&search, PEL_PAIR_FACE_VERTEX, &fv));
        assert_true(list_equals(&search, PEL_PAIR_EDGE_EDGE, &ee));
        assert_true(list_equals(&search, PEL_PAIR_FACE_FACE, &ff));
        pel_pair_search_clear(&search);
        free_feature_boxes(&x);
        free_feature_boxes(&y);
        pel_tree_destroy(first);
        pel_tree_destroy(second);
        free_surface(&a);
        free_surface(&b);
    }
}

static void test_in_box(void **unused)
{
    (void)unused;
    surface s = make_sphere(8, 0.02);
    pel_tree *tree = make_tree(&s, PEL_TREE_FEATURES);
    feature_boxes boxes = make_feature_boxes(tree);
    fit(tree, &s, 0, boxes.vertices);
    fill_feature_boxes(tree, &boxes);
    random_state random = {11};
    pel_element_list list = {0};
    for (int trial = 0; trial < 200; trial++) {
        pel_box box = pel_box_empty();
        for (int corner = 0; corner < 2; corner++)
            for (int k = 0; k < 3; k++) {
                float x = (float)random_between(&random, -1.5, 1.5);
                box.low[k] = x < box.low[k] ? x : box.low[k];
                box.high[k] = x > box.high[k] ? x : box.high[k];
            }
        size_t expected = 0;
        for (int32_t t = 0; t < s.triangle_count; t++)
            expected += pel_box_overlaps(&boxes.triangles[t], &box);
        assert_int_equal(pel_find_in_box(tree, &box, &list, NULL), PEL_OK);
        assert_int_equal(list.count, expected);
        for (size_t i = 0; i < list.count; i++)
            assert_true(pel_box_overlaps(&boxes.triangles[list.elements[i]], &box));
    }
    pel_free(list.elements);
    free_feature_boxes(&boxes);
    pel_tree_destroy(tree);
    free_surface(&s);
}

/* the same lists, in the same order */
static void test_threads(void **unused)
{
    (void)unused;
    surface s = make_soup(700, 0.2, 17);
    pel_tree *tree = make_tree(&s, PEL_TREE_FEATURES);
    feature_boxes boxes = make_feature_boxes(tree);
    fit(tree, &s, 0.01, boxes.vertices);
    pel_pair_search one, many;
    pel_pair_search_begin(&one, INT64_MAX);
    pel_pair_search_begin(&many, INT64_MAX);
    assert_int_equal(pel_find_pairs(tree, tree, 15u, NULL, &one, NULL), PEL_OK);
    for (int threads = 1; threads <= 4; threads++) {
        pel_pool *pool;
        assert_int_equal(pel_pool_create(threads, &pool, NULL), PEL_OK);
        assert_int_equal(pel_find_pairs(tree, tree, 15u, pool, &many, NULL), PEL_OK);
        for (int chunk = 0; chunk < PEL_SEARCH_CHUNKS; chunk++)
            for (int kind = 0; kind < PEL_PAIR_KIND_COUNT; kind++) {
                const pel_pair_list *a = &one.chunks[chunk].lists[kind], *b = &many.chunks[chunk].lists[kind];
                assert_int_equal(a->count, b->count);
                assert_true(a->count == 0 || memcmp(a->pairs, b->pairs, a->count * sizeof *a->pairs) == 0);
            }
        pel_pool_destroy(pool);
    }
    pel_pair_search_clear(&one);
    pel_pair_search_clear(&many);
    free_feature_boxes(&boxes);
    pel_tree_destroy(tree);
    free_surface(&s);
}

static void test_limit(void **unused)
{
    (void)unused;
    surface s = make_soup(700, 0.5, 17);
    pel_tree *tree = make_tree(&s, PEL_TREE_FEATURES);
    feature_boxes boxes = make_feature_boxes(tree);
    fit(tree, &s, 0.01, boxes.vertices);
    pel_pair_search search;
    pel_error error;
    pel_pair_search_begin(&search, INT64_MAX);
    assert_int_equal(pel_find_pairs(tree, tree, 15u, NULL, &search, NULL), PEL_OK);
    int64_t count = 0;
    for (int kind = 0; kind < PEL_PAIR_KIND_COUNT; kind++)
        count += (int64_t)pel_pair_search_count(&search, (pel_pair_kind)kind);
    search.limit = count;
    assert_int_equal(pel_find_pairs(tree, tree, 15u, NULL, &search, NULL), PEL_OK);
    search.limit = count - 1;
    assert_int_equal(pel_find_pairs(tree, tree, 15u, NULL, &search, &error), PEL_BAD_ARGUMENT);
    assert_non_null(strstr(error.what, "pairs come near each other"));
    pel_pair_search_clear(&search);
    free_feature_boxes(&boxes);
    pel_tree_destroy(tree);
    free_surface(&s);
}

static pel_status search_case(const void *data, pel_error *error)
{
    const surface *s = data;
    pel_tree *tree;
    pel_status status =
        pel_tree_create((const double(*)[3])s->start, s->vertex_count, (const int32_t(*)[3])s->triangles,
                        s->triangle_count, PEL_TREE_FEATURES, &tree, error);
    if (status != PEL_OK) {
        assert_null(tree);
        return status;
    }
    pel_box boxes[300], all = {{-9, -9, -9, 0}, {9, 9, 9, 0}};
    pel_pair_search search;
    pel_element_list list = {0};
    fit(tree, s, 0, boxes);
    pel_pair_search_begin(&search, INT64_MAX);
    status = pel_find_pairs(tree, tree, 15u, NULL, &search, error);
    if (status == PEL_OK)
        status = pel_find_in_box(tree, &all, &list, error);
    pel_pair_search_clear(&search);
    pel_free(list.elements);
    pel_tree_destroy(tree);
    return status;
}

static void test_allocations(void **unused)
{
    (void)unused;
    surface s = make_soup(40, 0.3, 2);
    assert_true(for_every_allocation_failure(search_case, &s) > 10);
    free_surface(&s);
    pel_tree *tree;
    assert_int_equal(pel_tree_create(NULL, 0, NULL, 0, PEL_TREE_TRIANGLES, &tree, NULL), PEL_BAD_ARGUMENT);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_members),
        cmocka_unit_test(test_edges),
        cmocka_unit_test(test_boxes_hold_points),
        cmocka_unit_test(test_not_finite),
        cmocka_unit_test(test_follow),
        cmocka_unit_test(test_centre_of_nothing),
        cmocka_unit_test(test_pairs_within),
        cmocka_unit_test(test_pairs_between),
        cmocka_unit_test(test_in_box),
        cmocka_unit_test(test_threads),
        cmocka_unit_test(test_limit),
        cmocka_unit_test(test_allocations),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
