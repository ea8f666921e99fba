/* Pairs of convex bodies without a tree against distances of all pairs: none that comes near is lost, none comes twice.
 */
#include "check.h"
#include "failing_malloc.h"
#include "random.h"

#include "base/memory.h"
#include "base/status.h"
#include "bvh/candidates.h"
#include "pellicle/geometry.h"
#include "sample.h"

enum { BODIES = 6 };

/* spheres and a box, of which the last sphere may have a dent, about to meet */
typedef struct heap {
    surface s;
    double (*rest)[3];
    int32_t *group_of_vertex;
    uint8_t may_meet[BODIES * BODIES];
    pel_collision_groups groups;
} heap;

static surface make_box(void)
{
    pel_shape_def def = pel_shape_def_default(PEL_SHAPE_BOX);
    pel_mesh *mesh;
    def.size_x = def.size_y = def.size_z = 1.6;
    def.nx = def.ny = def.nz = 2;
    assert_int_equal(pel_shape_create(&def, &mesh, NULL), PEL_OK);
    return surface_of_mesh(mesh, 0);
}

static void add_body(heap *h, const surface *one, int32_t group, int32_t *vertex, int32_t *triangle)
{
    for (int32_t v = 0; v < one->vertex_count; v++) {
        memcpy(h->rest[*vertex + v], one->start[v], sizeof one->start[v]);
        h->group_of_vertex[*vertex + v] = group;
    }
    for (int32_t t = 0; t < one->triangle_count; t++, (*triangle)++)
        for (int i = 0; i < 3; i++)
            h->s.triangles[*triangle][i] = *vertex + one->triangles[t][i];
    *vertex += one->vertex_count;
}

static void make_heap(heap *h, bool has_dent)
{
    surface ball = make_sphere(3, 0), box = make_box();
    int32_t vertices = 0, triangles = 0;
    h->s = make_surface((BODIES - 1) * ball.vertex_count + box.vertex_count,
                        (BODIES - 1) * ball.triangle_count + box.triangle_count);
    h->rest = calloc((size_t)h->s.vertex_count, sizeof *h->rest);
    h->group_of_vertex = calloc((size_t)h->s.vertex_count, sizeof *h->group_of_vertex);
    for (int32_t g = 0; g < BODIES; g++)
        add_body(h, g == 2 ? &box : &ball, g, &vertices, &triangles);
    for (int k = 0; k < 3 && has_dent; k++)
        h->rest[vertices - 1][k] *= 0.5;
    for (int i = 0; i < BODIES * BODIES; i++)
        h->may_meet[i] = i / BODIES != i % BODIES;
    h->groups = (pel_collision_groups){h->group_of_vertex, h->may_meet, BODIES, NULL};
    free_surface(&ball);
    free_surface(&box);
}

static void free_heap(heap *h)
{
    free_surface(&h->s);
    free(h->rest);
    free(h->group_of_vertex);
}

/* bodies side by side, turned and shifted at random, at the end of a step a little farther on a common way */
static void move_heap(heap *h, random_state *random, double way)
{
    double angle[BODIES], place[BODIES][3], turn[BODIES], common = 5 * random_between(random, -1, 1);
    for (int g = 0; g < BODIES; g++) {
        angle[g] = random_between(random, 0, 6);
        turn[g] = 0.1 * random_between(random, -1, 1);
        for (int k = 0; k < 3; k++)
            place[g][k] = (k == 0 ? 1.9 * (g % 3) : k == 1 ? 1.9 * (g / 3) : 0) + 0.15 * random_between(random, -1, 1);
    }
    for (int32_t v = 0; v < h->s.vertex_count; v++) {
        int g = h->group_of_vertex[v];
        for (int end = 0; end < 2; end++) {
            const double *x = h->rest[v];
            double *y = end == 0 ? h->s.start[v] : h->s.end[v], a = angle[g] + end * turn[g];
            y[0] = place[g][0] + cos(a) * x[0] - sin(a) * x[2] + end * common;
            y[1] = place[g][1] + x[1] + end * way * (g % 2);
            y[2] = place[g][2] + sin(a) * x[0] + cos(a) * x[2];
        }
    }
}

/* the least distance of a pair on its way, nearly: at nine times */
static double nearest(const surface *s, const int32_t points[4], bool edges)
{
    double least = HUGE_VAL;
    for (int i = 0; i <= 8; i++) {
        double p[4][3], weights[4], square;
        for (int c = 0; c < 4; c++)
            for (int k = 0; k < 3; k++)
                p[c][k] = (1 - i / 8.0) * s->start[points[c]][k] + i / 8.0 * s->end[points[c]][k];
        square = edges ? pel_closest_segment_segment(p[0], p[1], p[2], p[3], weights)
                       : pel_closest_point_triangle(p[0], p[1], p[2], p[3], weights);
        least = fmin(least, sqrt(square));
    }
    return least;
}

static pel_pair_list sorted(const pel_pair *pairs, size_t count)
{
    pel_pair_list list = {malloc((count + 1) * sizeof *pairs), count, count};
    if (count > 0)
        memcpy(list.pairs, pairs, count * sizeof *pairs);
    qsort(list.pairs, count, sizeof *pairs, compare_pairs);
    for (size_t i = 1; i < count; i++)
        assert_true(compare_pairs(&list.pairs[i - 1], &list.pairs[i]) < 0);
    return list;
}

/* of a list of one kind: every pair of two bodies that meet, of which one is sought, if it comes near, and no others;
   returns how many come near */
static int32_t check_list(const heap *h, const pel_tree *tree, const pel_pair_list *found, bool edges, double reach,
                          const uint8_t *sought)
{
    pel_pair_list list = sorted(found->pairs, found->count);
    int32_t firsts = edges ? 3 * tree->triangle_count : tree->vertex_count, count = 0;
    int32_t seconds = edges ? 3 * tree->triangle_count : tree->triangle_count;
    for (int32_t a = 0; a < firsts; a++)
        for (int32_t b = edges ? a + 1 : 0; b < seconds; b++) {
            int32_t points[4] = {a};
            if (edges && (pel_tree_edge(tree, a) != a || pel_tree_edge(tree, b) != b))
                continue;
            if (edges) {
                pel_tree_edge_ends(tree, a, points);
                pel_tree_edge_ends(tree, b, points + 2);
            } else
                memcpy(points + 1, tree->triangles[b], sizeof(int32_t[3]));
            int32_t g = h->group_of_vertex[points[0]], o = h->group_of_vertex[points[3]];
            const pel_pair pair = {a, b};
            bool has = bsearch(&pair, list.pairs, list.count, sizeof pair, compare_pairs) != NULL;
            if (!h->may_meet[g * BODIES + o] || (sought != NULL && !sought[g] && !sought[o])) {
                assert_false(has);
                continue;
            }
            if (nearest(&h->s, points, edges) < 0.999 * reach) {
                assert_true(has);
                count++;
            }
        }
    free(list.pairs);
    return count;
}

static pel_candidates *make_candidates(const heap *h)
{
    pel_candidates *c;
    assert_int_equal(pel_candidates_create((const double(*)[3])h->rest, h->s.vertex_count,
                                           (const int32_t(*)[3])h->s.triangles, h->s.triangle_count, 0.05, INT64_MAX,
                                           &c, NULL),
                     PEL_OK);
    assert_int_equal(pel_candidates_use_groups(c, &h->groups, (const double(*)[3])h->rest), PEL_OK);
    return c;
}

static void check_heap(bool has_dent)
{
    const uint8_t sought[BODIES] = {0, 0, 1, 0, 0, 1};
    heap h;
    random_state random = {3};
    pel_pool *pool;
    make_heap(&h, has_dent);
    h.may_meet[1] = h.may_meet[BODIES] = 0;
    pel_candidates *c = make_candidates(&h), *one = make_candidates(&h);
    pel_pair_list lists[2] = {{0}, {0}};
    int32_t near = 0, near_sought = 0;
    assert_int_equal(pel_pool_create(3, &pool, NULL), PEL_OK);
    assert_non_null(c->hulls);
    assert_int_equal(c->hulls->count, has_dent ? BODIES - 1 : BODIES);
    assert_int_equal(c->hulls->are_all, !has_dent);
    for (int step = 0; step < ROUNDS(6, 2); step++) {
        double reach = step % 2 == 0 ? 0.05 : 0.2;
        move_heap(&h, &random, 0.3);
        const double(*start)[3] = (const double(*)[3])h.s.start, (*end)[3] = (const double(*)[3])h.s.end;
        assert_int_equal(pel_candidates_update(c, start, end, reach, pool, NULL), PEL_OK);
        assert_int_equal(pel_candidates_update(one, start, end, reach, NULL, NULL), PEL_OK);
        assert_int_equal(c->edge_edge_count, one->edge_edge_count);
        assert_memory_equal(c->edge_edge, one->edge_edge, c->edge_edge_count * sizeof *c->edge_edge);
        assert_memory_equal(c->vertex_face, one->vertex_face, c->vertex_face_count * sizeof *c->vertex_face);
        for (int edges = 0; edges < 2; edges++) {
            const pel_pair_list found = {edges ? c->edge_edge : c->vertex_face,
                                         edges ? c->edge_edge_count : c->vertex_face_count, 0};
            int32_t count = check_list(&h, c->tree, &found, edges, reach, NULL);
            /* of boxes of the features, with corners */
            assert_true(found.count < 400 + 40 * (size_t)count);
            near += count;
        }
        assert_int_equal(pel_candidates_seek(c, start, end, reach, sought, pool, &lists[0], &lists[1], NULL), PEL_OK);
        for (int edges = 0; edges < 2; edges++)
            near_sought += check_list(&h, c->tree, &lists[edges], edges, reach, sought);
    }
    assert_true(near > near_sought && near_sought > 0);
    for (int i = 0; i < 2; i++)
        pel_free(lists[i].pairs);
    pel_candidates_destroy(c);
    pel_candidates_destroy(one);
    pel_pool_destroy(pool);
    free_heap(&h);
}

static void test_pairs(void **unused)
{
    (void)unused;
    check_heap(false);
}

/* a body that is not convex goes through the tree, against all others */
static void test_dent(void **unused)
{
    (void)unused;
    check_heap(true);
}

/* nor does one with a hole: sheets are flat at rest, and bend */
static void test_hole(void **unused)
{
    (void)unused;
    heap h;
    make_heap(&h, false);
    h.s.triangle_count--;
    pel_candidates *c = make_candidates(&h);
    assert_int_equal(c->hulls->count, BODIES - 1);
    pel_candidates_destroy(c);
    h.s.triangle_count++;
    free_heap(&h);
}

static void test_refusals(void **unused)
{
    (void)unused;
    heap h;
    random_state random = {5};
    pel_error error = {0};
    make_heap(&h, false);
    move_heap(&h, &random, 0);
    pel_candidates *c = make_candidates(&h);
    const double(*start)[3] = (const double(*)[3])h.s.start, (*end)[3] = (const double(*)[3])h.s.end;
    c->search.limit = 10;
    assert_int_equal(pel_candidates_update(c, start, end, 0.2, NULL, &error), PEL_BAD_ARGUMENT);
    assert_non_null(strstr(error.what, "more than 10 pairs"));
    assert_int_equal(c->edge_edge_count + c->vertex_face_count, 0);
    c->search.limit = INT64_MAX;
    h.s.end[7][1] = (double)NAN;
    assert_int_equal(pel_candidates_update(c, start, end, 0.2, NULL, &error), PEL_BAD_ARGUMENT);
    assert_int_equal(error.element, 7);
    pel_candidates_destroy(c);
    free_heap(&h);
}

static pel_status heap_case(const void *data, pel_error *error)
{
    const heap *h = data;
    pel_candidates *c;
    pel_status status =
        pel_candidates_create((const double(*)[3])h->rest, h->s.vertex_count, (const int32_t(*)[3])h->s.triangles,
                              h->s.triangle_count, 0.05, INT64_MAX, &c, error);
    if (status != PEL_OK)
        return status;
    status = pel_candidates_use_groups(c, &h->groups, (const double(*)[3])h->rest);
    if (status != PEL_OK)
        pel_fail_memory(error);
    else
        status =
            pel_candidates_update(c, (const double(*)[3])h->s.start, (const double(*)[3])h->s.end, 0.1, NULL, error);
    pel_candidates_destroy(c);
    return status;
}

static void test_memory(void **unused)
{
    (void)unused;
    heap h;
    random_state random = {7};
    make_heap(&h, false);
    move_heap(&h, &random, 0.2);
    assert_true(for_every_allocation_failure(heap_case, &h) > 30);
    free_heap(&h);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_pairs), cmocka_unit_test(test_dent),
                                       cmocka_unit_test(test_hole), cmocka_unit_test(test_refusals),
                                       cmocka_unit_test(test_memory)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
