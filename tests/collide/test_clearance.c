/* Known pairs against all pairs: while the clearance holds, no other pair comes near, for any motion. */
#include "check.h"
#include "failing_malloc.h"
#include "random.h"

#include "collide/clearance.h"
#include "collide/collider.h"
#include "pellicle/geometry.h"
#include "pellicle/shape.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { FREQUENCY = 4, STEPS = 60 };

static const double needed = 0.05, margin = 0.1;

typedef struct pieces {
    pel_mesh *mesh; /* a sphere whose opposite sides are pressed together, so that pairs are near */
    pel_candidates *candidates;
    pel_clearance clearance;
} pieces;

static void begin(pieces *p)
{
    pel_shape_def def = pel_shape_def_default(PEL_SHAPE_GEODESIC_SPHERE);
    def.frequency = FREQUENCY;
    assert_int_equal(pel_shape_create(&def, &p->mesh, NULL), PEL_OK);
    for (int32_t v = 0; v < p->mesh->vertex_count; v++)
        p->mesh->positions[v][2] *= 0.1;
    assert_int_equal(pel_candidates_create((const double(*)[3])p->mesh->positions, p->mesh->vertex_count,
                                           (const int32_t(*)[3])p->mesh->triangles, p->mesh->triangle_count, margin,
                                           INT64_MAX, &p->candidates, NULL),
                     PEL_OK);
    assert_int_equal(pel_clearance_create(p->mesh->vertex_count, &p->clearance, NULL), PEL_OK);
}

static void end(pieces *p)
{
    pel_clearance_clear(&p->clearance);
    pel_candidates_destroy(p->candidates);
    pel_mesh_destroy(p->mesh);
}

static bool has_pair(const pel_pair_list *list, int32_t first, int32_t second)
{
    for (size_t i = 0; i < list->count; i++)
        if (list->pairs[i].first == first && list->pairs[i].second == second)
            return true;
    return false;
}

static bool shares(const int32_t *a, int count_a, const int32_t *b, int count_b)
{
    for (int i = 0; i < count_a; i++)
        for (int k = 0; k < count_b; k++)
            if (a[i] == b[k])
                return true;
    return false;
}

/* every pair nearer than `distance` is known; returns how many there are */
static int64_t check_known(const pieces *p, const double (*x)[3], double distance)
{
    const pel_tree *tree = p->candidates->tree;
    double weights[4];
    int64_t count = 0;
    for (int32_t v = 0; v < tree->vertex_count; v++)
        for (int32_t t = 0; t < tree->triangle_count; t++) {
            const int32_t *c = tree->triangles[t];
            if (shares(&v, 1, c, 3) ||
                !(pel_closest_point_triangle(x[v], x[c[0]], x[c[1]], x[c[2]], weights) < distance * distance))
                continue;
            assert_true(has_pair(&p->clearance.vertex_face, v, t));
            count++;
        }
    for (int32_t e = 0; e < 3 * tree->triangle_count; e++)
        for (int32_t f = e + 1; f < 3 * tree->triangle_count; f++) {
            int32_t a[2], b[2];
            pel_tree_edge_ends(tree, e, a);
            pel_tree_edge_ends(tree, f, b);
            if (pel_tree_edge(tree, e) != e || pel_tree_edge(tree, f) != f || shares(a, 2, b, 2) ||
                !(pel_closest_segment_segment(x[a[0]], x[a[1]], x[b[0]], x[b[1]], weights) < distance * distance))
                continue;
            assert_true(has_pair(&p->clearance.edge_edge, e, f));
            count++;
        }
    return count;
}

static void move(const pel_mesh *mesh, double (*x)[3], double noise, const double shift[3], random_state *random)
{
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        for (int k = 0; k < 3; k++)
            x[v][k] += shift[k] + noise * random_between(random, -1, 1);
}

static void test_known_pairs(void **unused)
{
    (void)unused;
    pieces p;
    begin(&p);
    random_state random = {7};
    size_t size = (size_t)p.mesh->vertex_count * sizeof(double[3]);
    double(*start)[3] = malloc(size), (*next)[3] = malloc(size);
    const double shift[3] = {0.4, -1, 0.1};
    memcpy(start, p.mesh->positions, size);
    assert_false(pel_clearance_serves(&p.clearance, (const double(*)[3])start, (const double(*)[3])start, 0, NULL));
    assert_true(pel_clearance_renew(&p.clearance, p.candidates, (const double(*)[3])start, (const double(*)[3])start,
                                    needed, margin, NULL));
    assert_true(check_known(&p, (const double(*)[3])start, needed + margin) > 100);
    int served = 0;
    for (int n = 0; n < STEPS; n++) {
        memcpy(next, start, size);
        move(p.mesh, next, 0.006, shift, &random);
        if (!pel_clearance_serves(&p.clearance, (const double(*)[3])start, (const double(*)[3])next, needed, NULL))
            break;
        check_known(&p, (const double(*)[3])next, needed);
        memcpy(start, next, size);
        served++;
    }
    /* noise adds up until they no longer hold, and the common translation does not count */
    assert_true(served > 2 && served < STEPS);
    assert_false(pel_clearance_serves(&p.clearance, (const double(*)[3])start, (const double(*)[3])next, needed, NULL));
    free(start);
    free(next);
    end(&p);
}

/* two points that approach each other by exactly the remaining distance end it, at the start or the end of a step; so
   do values that are not finite */
static void test_bound(void **unused)
{
    (void)unused;
    pieces p;
    begin(&p);
    const double(*rest)[3] = (const double(*)[3])p.mesh->positions;
    size_t size = (size_t)p.mesh->vertex_count * sizeof(double[3]);
    double(*moved)[3] = malloc(size);
    memcpy(moved, rest, size);
    assert_true(pel_clearance_renew(&p.clearance, p.candidates, rest, rest, needed, margin, NULL));
    moved[3][1] += 0.5 * margin;
    moved[8][1] -= 0.499 * margin;
    assert_true(pel_clearance_serves(&p.clearance, rest, (const double(*)[3])moved, needed, NULL));
    assert_false(pel_clearance_serves(&p.clearance, rest, (const double(*)[3])moved, 1.01 * needed, NULL));
    moved[8][1] -= 0.002 * margin;
    assert_false(pel_clearance_serves(&p.clearance, rest, (const double(*)[3])moved, needed, NULL));
    assert_false(pel_clearance_serves(&p.clearance, (const double(*)[3])moved, rest, needed, NULL));
    memcpy(moved, rest, size);
    moved[5][0] = nan("");
    assert_false(pel_clearance_serves(&p.clearance, rest, (const double(*)[3])moved, needed, NULL));
    moved[5][0] = HUGE_VAL;
    assert_false(pel_clearance_serves(&p.clearance, (const double(*)[3])moved, rest, needed, NULL));
    free(moved);
    end(&p);
}

static void set_records(const double (*x)[3], int32_t count, pel_record *records)
{
    for (int32_t v = 0; v < count; v++)
        records[v] = (pel_record){(pel_real)x[v][0], (pel_real)x[v][1], (pel_real)x[v][2], 0};
}

/* the nearest pair by all pairs */
static double nearest(const pieces *p, const double (*x)[3])
{
    double below = 0, above = 10;
    pel_pair_list vertex_face = {0}, edge_edge = {0};
    for (int i = 0; i < 40; i++) {
        double middle = 0.5 * (below + above);
        assert_int_equal(pel_candidates_near(p->candidates, x, middle, NULL, &vertex_face, &edge_edge, NULL), PEL_OK);
        *(vertex_face.count + edge_edge.count > 0 ? &above : &below) = middle;
    }
    free(vertex_face.pairs);
    free(edge_edge.pairs);
    return above;
}

/* a way is clear while no pair can be near, the nearest known one included, at its start, its end, by bounds of
   displacements; the last points are no records */
static void test_clear(void **unused)
{
    (void)unused;
    pieces p;
    begin(&p);
    int32_t count = p.mesh->vertex_count, record_count = count - 5;
    const double(*rest)[3] = (const double(*)[3])p.mesh->positions;
    double least = nearest(&p, rest), near = 0.5 * least;
    size_t size = (size_t)count * sizeof(double[3]);
    double(*moved)[3] = malloc(size);
    pel_record *start = aligned_alloc(64, ((size_t)count * sizeof *start + 63) / 64 * 64);
    pel_record *next = aligned_alloc(64, ((size_t)count * sizeof *next + 63) / 64 * 64);
    set_records(rest, count, start);
    memcpy(moved, rest, size);
    pel_clearance_way way = {start, next, record_count, rest, (const double(*)[3])moved};
    set_records(rest, count, next);
    assert_false(pel_clearance_is_clear(&p.clearance, &way, near, NULL));
    assert_false(pel_clearance_stays_clear(&p.clearance, 0, true, near));
    assert_true(pel_clearance_renew(&p.clearance, p.candidates, rest, rest, near, margin, NULL));
    assert_true(p.clearance.vertex_face.count + p.clearance.edge_edge.count > 0);
    assert_true(fabs(p.clearance.nearest - least) < 1e-6);
    assert_false(pel_clearance_stays_clear(&p.clearance, 0, true, near));
    assert_false(pel_clearance_is_clear(&p.clearance, &way, 1.01 * least, NULL));
    assert_true(pel_clearance_is_clear(&p.clearance, &way, near, NULL));
    const int32_t vertices[] = {3, count - 1};
    for (int i = 0; i < 2; i++)
        for (int k = 0; k < 3; k++) {
            moved[vertices[i]][k] += 0.51 * least;
            set_records((const double(*)[3])moved, record_count, next);
            assert_false(pel_clearance_is_clear(&p.clearance, &way, near, NULL));
            const pel_clearance_way back = {next, start, record_count, (const double(*)[3])moved, rest};
            assert_false(pel_clearance_is_clear(&p.clearance, &back, near, NULL));
            moved[vertices[i]][k] -= 0.02 * least;
            set_records((const double(*)[3])moved, record_count, next);
            assert_true(pel_clearance_is_clear(&p.clearance, &way, near, NULL));
            /* from there, 0.01 of it are left: for two points that meet */
            assert_false(pel_clearance_stays_clear(&p.clearance, 0.0051 * least, true, near));
            assert_true(pel_clearance_stays_clear(&p.clearance, 0.0049 * least, false, near));
            assert_true(pel_clearance_stays_clear(&p.clearance, 0.0049 * least, true, near));
            assert_false(pel_clearance_stays_clear(&p.clearance, 0.0049 * least, true, near));
            memcpy(moved, rest, size);
        }
    set_records(rest, count, next);
    next[7][1] = (pel_real)NAN;
    assert_false(pel_clearance_is_clear(&p.clearance, &way, near, NULL));
    free(start);
    free(next);
    free(moved);
    end(&p);
}

/* after slow steps that added up the known pairs are those of the present, the nearest of them included; not after
   fast ones, and not where they would not serve the step */
static void test_settle(void **unused)
{
    (void)unused;
    pieces p;
    begin(&p);
    random_state random = {11};
    const double none[3] = {0, 0, 0};
    const double(*rest)[3] = (const double(*)[3])p.mesh->positions;
    size_t size = (size_t)p.mesh->vertex_count * sizeof(double[3]);
    double(*start)[3] = malloc(size), (*next)[3] = malloc(size);
    memcpy(start, rest, size);
    move(p.mesh, start, 0.004, none, &random);
    memcpy(next, start, size);
    next[3][2] += 0.02;
    assert_true(pel_clearance_renew(&p.clearance, p.candidates, rest, rest, needed, margin, NULL));
    const double reach = p.clearance.reach, before = p.clearance.nearest;
    const pel_tree *tree = p.candidates->tree;
    pel_clearance_settle(&p.clearance, tree, rest, rest, needed, NULL);
    pel_clearance_settle(&p.clearance, tree, (const double(*)[3])start, (const double(*)[3])next, needed, NULL);
    pel_clearance_settle(&p.clearance, tree, (const double(*)[3])start, (const double(*)[3])start, needed + margin,
                         NULL);
    assert_true(p.clearance.reach == reach && p.clearance.nearest == before);
    pel_clearance_settle(&p.clearance, tree, (const double(*)[3])start, (const double(*)[3])start, needed, NULL);
    assert_true(p.clearance.reach < reach && p.clearance.reach > needed);
    assert_memory_equal(p.clearance.positions, start, size);
    int64_t count = check_known(&p, (const double(*)[3])start, p.clearance.reach);
    assert_int_equal(count, p.clearance.vertex_face.count + p.clearance.edge_edge.count);
    double now = p.clearance.nearest;
    assert_true(now != before && fabs(now - nearest(&p, (const double(*)[3])start)) < 1e-6);
    free(start);
    free(next);
    end(&p);
}

/* fast steps are not worth a search, and slow ones after pairs that served little wait */
static void test_worth(void **unused)
{
    (void)unused;
    pieces p;
    begin(&p);
    const double(*rest)[3] = (const double(*)[3])p.mesh->positions;
    size_t size = (size_t)p.mesh->vertex_count * sizeof(double[3]);
    double(*moved)[3] = malloc(size);
    memcpy(moved, rest, size);
    moved[3][1] += 0.1 * margin;
    const double(*far)[3] = (const double(*)[3])moved;
    assert_false(pel_clearance_renew(&p.clearance, p.candidates, rest, far, needed, margin, NULL));
    assert_false(pel_clearance_renew(&p.clearance, p.candidates, rest, rest, needed, 0, NULL));
    assert_int_equal(p.candidates->counts.searches, 0);
    assert_true(pel_clearance_renew(&p.clearance, p.candidates, rest, rest, needed, margin, NULL));
    assert_false(pel_clearance_renew(&p.clearance, p.candidates, rest, rest, needed, margin, NULL));
    assert_true(pel_clearance_renew(&p.clearance, p.candidates, rest, rest, needed, margin, NULL));
    assert_int_equal(p.candidates->counts.searches, 2);
    /* pairs that served often are replaced at once, those that came then have served nothing yet */
    for (int i = 0; i < 8; i++)
        assert_true(pel_clearance_serves(&p.clearance, rest, rest, needed, NULL));
    assert_true(pel_clearance_renew(&p.clearance, p.candidates, rest, rest, needed, margin, NULL));
    assert_false(pel_clearance_renew(&p.clearance, p.candidates, rest, rest, needed, margin, NULL));
    free(moved);
    end(&p);
}

/* counts out of their ranges, as a damaged snapshot has them, are refused and forgotten */
static void test_damaged_memory(void **unused)
{
    (void)unused;
    pieces p;
    begin(&p);
    int32_t *const counts[] = {&p.clearance.uses, &p.clearance.pause, &p.clearance.pause_length};
    const int32_t bad[] = {-1, INT32_MAX};
    for (size_t i = 0; i < 6; i++) {
        int32_t kept = *counts[i / 2];
        *counts[i / 2] = bad[i % 2];
        pel_error error;
        if (pel_clearance_recall(&p.clearance, p.candidates, NULL, &error) != PEL_BAD_FORMAT)
            fail_msg("number %d is taken", (int)i);
        *counts[i / 2] = kept;
    }
    p.clearance.reach = (double)NAN;
    assert_int_equal(pel_clearance_recall(&p.clearance, p.candidates, NULL, NULL), PEL_BAD_FORMAT);
    assert_int_equal(pel_clearance_recall(&p.clearance, p.candidates, NULL, NULL), PEL_OK);
    end(&p);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_damaged_memory), cmocka_unit_test(test_known_pairs), cmocka_unit_test(test_bound),
        cmocka_unit_test(test_clear),          cmocka_unit_test(test_worth),       cmocka_unit_test(test_settle),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
