/* Continuous collision on contacts that are exact by construction: all points lie on dyadic grids, so that the place
   and the time of a contact are known without rounding. `make nightly` runs 20 times as many.
 */
#include "check.h"

#include <stdbool.h>
#include <stdlib.h>

#include "geom/ccd.h"
#include "geom/ccd_pair.h"
#include "pellicle/geometry.h"
#include "random.h"

typedef struct query {
    double start[4][3], end[4][3];
    bool edge_edge;
    double time; /* of the constructed contact; there may be an earlier one */
    double min_separation;
} query;

static int query_count(int usual)
{
    return LONG(20 * usual, ROUNDS(usual, usual / 20));
}

static bool solve(const query *q, double tolerance, pel_ccd_hit *hit)
{
    const double(*s)[3] = (const double(*)[3])q->start, (*e)[3] = (const double(*)[3])q->end;
    return q->edge_edge ? pel_ccd_edge_edge(s, e, q->min_separation, tolerance, hit)
                        : pel_ccd_vertex_face(s, e, q->min_separation, tolerance, hit);
}

static bool filter(const query *q)
{
    return pel_ccd_filter((const double(*)[3])q->start, (const double(*)[3])q->end, q->edge_edge, q->min_separation);
}

/* ---- contacts by construction ---- */

/* weights of up to three points, multiples of 1/64 of sum 1; the ends are likely */
static void random_weights(random_state *random, int count, double *weights)
{
    double left = 1;
    for (int i = 0; i + 1 < count; i++) {
        weights[i] = left * (double)random_integer(random, 0, 8) / 8;
        left -= weights[i];
    }
    weights[count - 1] = left;
}

/* a whole vector of whole length up to 21, or zero */
static double random_gap(random_state *random, double gap[3])
{
    static const double triples[5][4] = {{0, 0, 0, 0}, {0, 0, 1, 1}, {1, 2, 2, 3}, {2, 3, 6, 7}, {0, 3, 4, 5}};
    const double *triple = triples[random_integer(random, 0, 4)];
    int turn = (int)random_integer(random, 0, 2);
    double factor = (double)random_integer(random, 1, 3);
    for (int k = 0; k < 3; k++)
        gap[k] = factor * triple[(k + turn) % 3] * (random_integer(random, 0, 1) ? 1 : -1);
    return factor * triple[3];
}

/* Random whole positions at the time of contact and whole motions; then the first point is put where it touches (or has
   a gap of whole length), and all points are moved back to the start and on to the end. */
static void make_contact(random_state *random, bool with_gap, query *q)
{
    static const double times[8] = {0, 1, 0.5, 0.25, 0.75, 0.125, 0.9375, 0x1p-10};
    double contact[4][3], motion[4][3], weights[4], gap[3] = {0, 0, 0};
    q->edge_edge = random_integer(random, 0, 1);
    q->time = times[random_integer(random, 0, 7)];
    q->min_separation = with_gap ? random_gap(random, gap) : 0;
    bool still = random_integer(random, 0, 7) == 0;
    int flat = (int)random_integer(random, 0, 7);
    double place = random_integer(random, 0, 3) ? 0 : 0x1p30;
    for (int i = 0; i < 4; i++) {
        int64_t range = (int64_t)1 << random_integer(random, 0, random_integer(random, 0, 1) ? 3 : 16);
        for (int k = 0; k < 3; k++) {
            contact[i][k] = flat == k ? 0 : (double)random_integer(random, -range, range);
            motion[i][k] = flat == k || still ? 0 : (double)random_integer(random, -range, range);
        }
    }
    /* own x0 + (1 - own) x1 = the place on edge 2,3, or x0 = the place on face 1,2,3 */
    double own = q->edge_edge ? ldexp(1, -(int)random_integer(random, 0, 3)) : 1;
    weights[1] = own - 1;
    random_weights(random, q->edge_edge ? 2 : 3, q->edge_edge ? weights + 2 : weights + 1);
    for (int k = 0; k < 3; k++) {
        double sum = weights[1] * contact[1][k] + (weights[2] * contact[2][k] + weights[3] * contact[3][k]);
        contact[0][k] = (sum + gap[k]) / own;
    }
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 3; k++) {
            q->start[i][k] = place + contact[i][k] - q->time * motion[i][k];
            q->end[i][k] = q->start[i][k] + motion[i][k];
        }
}

static void scale_query(query *q, double scale)
{
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 3; k++) {
            q->start[i][k] *= scale;
            q->end[i][k] *= scale;
        }
    q->min_separation *= scale;
}

/* another order of the points of the same two features */
static void permute_query(random_state *random, query *q)
{
    query old = *q;
    int order[4] = {0, 1, 2, 3};
    if (q->edge_edge) {
        int a = (int)random_integer(random, 0, 1), b = (int)random_integer(random, 0, 1);
        int c = (int)random_integer(random, 0, 1);
        const int edges[4] = {2 * c + a, 2 * c + 1 - a, 2 - 2 * c + b, 3 - 2 * c - b};
        memcpy(order, edges, sizeof order);
    } else {
        int turn = (int)random_integer(random, 0, 2), flip = (int)random_integer(random, 0, 1);
        for (int i = 0; i < 3; i++)
            order[1 + i] = 1 + (flip ? 2 * 3 + turn - i : turn + i) % 3;
    }
    for (int i = 0; i < 4; i++) {
        memcpy(q->start[i], old.start[order[i]], sizeof q->start[i]);
        memcpy(q->end[i], old.end[order[i]], sizeof q->end[i]);
    }
}

static double query_size(const query *q)
{
    double size = 0;
    for (int i = 1; i < 4; i++)
        for (int k = 0; k < 3; k++) {
            size = fmax(size, fabs(q->start[i][k] - q->start[0][k]));
            size = fmax(size, fabs(q->end[i][k] - q->end[0][k]));
        }
    return size;
}

/* the contract of a hit in pellicle/geometry.h; differences from point 2, so that the place does not matter */
static void check_hit(const query *q, double tolerance, const pel_ccd_hit *hit)
{
    double vector[3] = {0, 0, 0}, t = hit->time_of_impact, sum = 0, size = query_size(q), along = 0, length = 0;
    assert_true(t >= 0 && t <= 1);
    for (int i = 0; i < 4; i++) {
        bool positive = q->edge_edge ? i < 2 : i < 1;
        assert_true(positive ? hit->weight[i] >= 0 && hit->weight[i] <= 1
                             : hit->weight[i] <= 0 && hit->weight[i] >= -1);
        sum += hit->weight[i];
        for (int k = 0; k < 3; k++)
            vector[k] += hit->weight[i] / size *
                         ((1 - t) * (q->start[i][k] - q->start[2][k]) + t * (q->end[i][k] - q->end[2][k]));
    }
    for (int k = 0; k < 3 && size > 0; k++) {
        along += hit->normal[k] * vector[k];
        length += vector[k] * vector[k];
    }
    assert_near(sum, 0, 1e-15);
    assert_near(hit->normal[0] * hit->normal[0] + hit->normal[1] * hit->normal[1] + hit->normal[2] * hit->normal[2], 1,
                1e-12);
    if (size == 0)
        return;
    /* nearly parallel edges and thin faces leave the closest place to rounding: the square root of its 1e-16 */
    assert_true(sqrt(length) <= (q->min_separation + tolerance) / size + 1e-7);
    assert_true(along >= -1e-10);
}

/* counts the hits that a used-up budget gave */
static void check_contact(const query *q, double tolerance, int *fall_backs)
{
    pel_ccd_hit hit;
    bool hits = solve(q, tolerance, &hit);
    assert_true(hits);
    assert_true(filter(q));
    if (!(hit.time_of_impact <= q->time))
        print_error("time of impact %.17g, contact at %.17g\n", hit.time_of_impact, q->time);
    assert_true(hit.time_of_impact <= q->time);
    pel_ccd_statistics statistics = {0};
    pel_ccd_hit again;
    pel_ccd_batch batch = {.start = q->start[0],
                           .end = q->end[0],
                           .query_count = 1,
                           .edge_edge = q->edge_edge,
                           .min_separation = q->min_separation,
                           .tolerance = tolerance};
    int32_t number;
    assert_int_equal(pel_ccd_solve_batch(&batch, &number, &again, &statistics), 1);
    assert_memory_equal(&again, &hit, sizeof hit);
    *fall_backs += (int)statistics.fall_backs;
    if (statistics.fall_backs == 0)
        check_hit(q, tolerance, &hit);
}

static void run_contacts(uint64_t seed, bool with_gap)
{
    static const double tolerances[4] = {1e-6, 1e-3, 1e-9, 1e-12};
    random_state random = {seed};
    int count = query_count(40000), fall_backs = 0;
    for (int trial = 0; trial < count; trial++) {
        query q;
        make_contact(&random, with_gap, &q);
        permute_query(&random, &q);
        double scale = trial % 3 == 0 ? ldexp(1, (int)random_integer(&random, -20, 20)) : 1;
        if (trial % 64 == 0)
            scale = ldexp(1, (int)random_integer(&random, -1000, 980));
        scale_query(&q, scale);
        check_contact(&q, trial % 32 ? scale * tolerances[trial % 4] : 0, &fall_backs);
    }
    assert_true(fall_backs <= count / 10000);
}

static void test_exact_contacts(void **unused)
{
    (void)unused;
    run_contacts(1, false);
}

static void test_exact_gaps(void **unused)
{
    (void)unused;
    run_contacts(2, true);
}

/* coordinates that are no dyadic numbers: the first point is the rounded place, the gap of a few units in the last
   place is the minimum separation */
static void test_rounded_contacts(void **unused)
{
    (void)unused;
    random_state random = {3};
    int count = query_count(40000), fall_backs = 0;
    for (int trial = 0; trial < count; trial++) {
        query q = {.edge_edge = false};
        double scale = pow(10, (double)random_integer(&random, -6, 6)), w[3];
        w[0] = random_between(&random, 0, 1);
        w[1] = random_between(&random, 0, 1 - w[0]);
        w[2] = 1 - w[0] - w[1];
        for (int i = 0; i < 4; i++)
            for (int k = 0; k < 3; k++) {
                q.start[i][k] = scale * random_between(&random, -1, 1);
                q.end[i][k] = scale * random_between(&random, -1, 1);
            }
        bool at_end = trial % 2;
        double(*x)[3] = at_end ? q.end : q.start;
        for (int k = 0; k < 3; k++)
            x[0][k] = w[0] * x[1][k] + w[1] * x[2][k] + w[2] * x[3][k];
        q.time = at_end;
        q.min_separation = 8 * DBL_EPSILON * scale;
        permute_query(&random, &q);
        check_contact(&q, scale * 1e-6, &fall_backs);
    }
    assert_int_equal(fall_backs, 0);
}

/* ---- against sampling ---- */

static double distance_at(const query *q, double t)
{
    double x[4][3], weights[4];
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 3; k++)
            x[i][k] = (1 - t) * q->start[i][k] + t * q->end[i][k];
    return sqrt(q->edge_edge ? pel_closest_segment_segment(x[0], x[1], x[2], x[3], weights)
                             : pel_closest_point_triangle(x[0], x[1], x[2], x[3], weights));
}

static void random_query(random_state *random, double motion, query *q)
{
    q->edge_edge = random_integer(random, 0, 1);
    q->min_separation = random_integer(random, 0, 1) ? 0 : random_between(random, 0, 0.1);
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 3; k++) {
            q->start[i][k] = random_between(random, -1, 1);
            q->end[i][k] = q->start[i][k] + motion * random_between(random, -1, 1);
        }
}

/* no sampled time before the hit, or of a whole free step, is as near as the minimum separation */
static void test_against_sampling(void **unused)
{
    (void)unused;
    enum { SAMPLES = 40 };
    random_state random = {4};
    int hit_count = 0, count = query_count(20000);
    for (int trial = 0; trial < count; trial++) {
        query q;
        pel_ccd_hit hit;
        random_query(&random, trial % 2 ? 1 : 0.1, &q);
        bool hits = solve(&q, 1e-6, &hit);
        double until = hits ? hit.time_of_impact : 1;
        for (int i = 0; i <= SAMPLES; i++)
            assert_true(until == 0 || distance_at(&q, until * i / SAMPLES) > q.min_separation - 1e-14);
        if (hits) {
            check_hit(&q, 1e-6, &hit);
            assert_true(filter(&q));
        }
        hit_count += hits;
    }
    assert_true(hit_count > count / 50);
}

/* motion along one line towards a known place: the time is known */
static void test_known_times(void **unused)
{
    (void)unused;
    query q = {.start = {{0.25, 0.25, 3}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
               .end = {{0.25, 0.25, -1}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}}};
    pel_ccd_hit hit;
    assert_true(solve(&q, 1e-9, &hit));
    assert_near(hit.time_of_impact, 0.75, 1e-9);
    assert_near(hit.normal[2], 1, 1e-12);
    assert_near(hit.weight[0], 1, 0);
    assert_near(hit.weight[1], -0.5, 1e-9);
    assert_near(hit.weight[2], -0.25, 1e-9);
    q.min_separation = 1;
    assert_true(solve(&q, 1e-9, &hit));
    assert_true(hit.time_of_impact <= 0.5);
    assert_near(hit.time_of_impact, 0.5, 1e-9);
    q.end[0][2] = 1.0 + 1e-12;
    assert_false(solve(&q, 1e-13, &hit));
    q.end[0][2] = 1.0;
    assert_true(solve(&q, 1e-13, &hit));
    query e = {.start = {{-1, 0, -2}, {1, 0, -2}, {0, -1, 0}, {0, 1, 0}},
               .end = {{-1, 0, 2}, {1, 0, 2}, {0, -1, 0}, {0, 1, 0}},
               .edge_edge = true};
    assert_true(solve(&e, 1e-9, &hit));
    assert_near(hit.time_of_impact, 0.5, 1e-9);
    assert_near(hit.normal[2], -1, 1e-12);
    assert_near(hit.weight[1], 0.5, 1e-12);
    assert_near(hit.weight[3], -0.5, 1e-12);
}

/* touching from the start: the normal is against the motion */
static void test_touching_start(void **unused)
{
    (void)unused;
    query q = {.start = {{0.25, 0.25, 0}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
               .end = {{0.25, 0.25, 1}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}}};
    pel_ccd_hit hit;
    assert_true(solve(&q, 1e-6, &hit));
    assert_near(hit.time_of_impact, 0, 0);
    assert_near(hit.normal[2], -1, 0);
    q.end[0][2] = -1;
    assert_true(solve(&q, 1e-6, &hit));
    assert_near(hit.normal[2], 1, 0);
}

static void test_bad_input(void **unused)
{
    (void)unused;
    static const double bad[3] = {(double)NAN, HUGE_VAL, -HUGE_VAL};
    for (int kind = 0; kind < 2; kind++)
        for (int place = 0; place < 24; place++)
            for (int i = 0; i < 3; i++) {
                query q = {.start = {{0, 0, 9}, {1, 0, 7}, {0, 1, 0}, {1, 1, 0}},
                           .end = {{0, 0, 9}, {1, 0, 7}, {0, 1, 0}, {1, 1, 0}},
                           .edge_edge = kind};
                pel_ccd_hit hit;
                assert_false(solve(&q, 1e-6, &hit));
                (place < 12 ? q.start : q.end)[place / 3 % 4][place % 3] = bad[i];
                assert_true(solve(&q, 1e-6, &hit));
                assert_true(filter(&q));
                assert_near(hit.time_of_impact, 0, 0);
                assert_near(hit.weight[0] + hit.weight[1] + hit.weight[2] + hit.weight[3], 0, 1e-15);
                pel_ccd_batch batch = {
                    .start = q.start[0], .end = q.end[0], .query_count = 1, .edge_edge = kind, .tolerance = 1e-6};
                int32_t number = -1;
                assert_int_equal(pel_ccd_filter_batch(&batch, &number), 1);
                assert_int_equal(pel_ccd_solve_batch(&batch, &number, &hit, NULL), 1);
            }
    query far = {.start = {{0, 0, 9}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}},
                 .end = {{0, 0, 9}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}};
    pel_ccd_hit hit;
    far.min_separation = (double)NAN;
    assert_true(solve(&far, 1e-6, NULL));
    far.min_separation = HUGE_VAL;
    assert_true(solve(&far, 1e-6, &hit));
    far.min_separation = -1;
    assert_false(solve(&far, (double)NAN, &hit));
}

/* pairs that slide along each other in a plane, turn about each other, or stay: an answer after bounded work */
static void test_hard_motions(void **unused)
{
    (void)unused;
    random_state random = {5};
    for (int trial = 0; trial < ROUNDS(2000, 200); trial++) {
        query q = {.edge_edge = trial % 2};
        pel_ccd_hit hit;
        double gap = ldexp(1, -(int)random_integer(&random, 0, 50));
        for (int i = 0; i < 4; i++) {
            double angle = 2.0 * i + random_between(&random, 0, 1), height = i == 0 || (i == 1 && trial % 2) ? gap : 0;
            const double start[3] = {cos(angle), sin(angle), height}, end[3] = {-cos(angle), sin(2 * angle), height};
            memcpy(q.start[i], start, sizeof start);
            memcpy(q.end[i], trial % 5 ? end : start, sizeof end);
        }
        pel_ccd_batch batch = {.start = q.start[0], .end = q.end[0], .query_count = 1, .edge_edge = q.edge_edge};
        pel_ccd_statistics statistics = {0};
        int32_t number;
        pel_ccd_solve_batch(&batch, &number, &hit, &statistics);
        assert_true(statistics.intervals <= 2048);
        assert_false(gap > 1e-12 && statistics.hits > 0);
    }
}

/* ---- batches ---- */

static void fill_batch(random_state *random, query *queries, int count, bool edge_edge, double *start, double *end)
{
    for (int i = 0; i < count; i++) {
        query *q = &queries[i];
        do {
            if (i % 5 == 0)
                make_contact(random, false, q);
            else
                random_query(random, 0.5, q);
        } while (q->edge_edge != edge_edge);
        q->min_separation = 0;
        memcpy(start + 12 * (ptrdiff_t)i, q->start, sizeof q->start);
        memcpy(end + 12 * (ptrdiff_t)i, q->end, sizeof q->end);
    }
}

/* it keeps what hits, and only what the filter keeps */
static void check_near_batch(const pel_ccd_batch *batch, const int32_t *hits, int32_t hit_count,
                             const int32_t *filtered, int32_t filtered_count)
{
    static int32_t near[1500];
    int32_t count = pel_ccd_near_batch(batch, near), hit = 0, passed = 0;
    assert_true(count <= filtered_count);
    for (int32_t i = 0; i < count; i++) {
        while (passed < filtered_count && filtered[passed] != near[i])
            passed++;
        assert_true(passed < filtered_count);
        hit += hit < hit_count && hits[hit] == near[i];
    }
    assert_int_equal(hit, hit_count);
}

/* a batch of any size, with point numbers or without, finds what single queries find */
static void test_batches(void **unused)
{
    (void)unused;
    enum { LIMIT = 1500 };
    static query queries[LIMIT];
    static double start[12 * LIMIT], end[12 * LIMIT];
    static int32_t found[LIMIT], survivors[LIMIT], points[4 * LIMIT];
    static pel_ccd_hit hits[LIMIT];
    static const int sizes[8] = {0, 1, 3, 4, 5, 511, 513, LIMIT};
    random_state random = {6};
    for (int32_t i = 0; i < 4 * LIMIT; i++)
        points[i] = i;
    for (int round = 0; round < 32; round++) {
        int count = sizes[round % 8], expected = 0, survivor = 0;
        bool edge_edge = round / 8 % 2;
        fill_batch(&random, queries, count, edge_edge, start, end);
        pel_ccd_batch batch = {.start = start,
                               .end = end,
                               .points = round < 16 ? NULL : points,
                               .query_count = count,
                               .edge_edge = edge_edge,
                               .tolerance = 1e-6};
        pel_ccd_statistics statistics = {0};
        int32_t found_count = pel_ccd_solve_batch(&batch, found, hits, &statistics);
        int32_t survivor_count = pel_ccd_filter_batch(&batch, survivors);
        for (int i = 0; i < count; i++) {
            pel_ccd_hit hit;
            bool passes = survivor < survivor_count && survivors[survivor] == i;
            assert_int_equal(passes, filter(&queries[i]));
            survivor += passes;
            if (!solve(&queries[i], 1e-6, &hit))
                continue;
            assert_true(expected < found_count);
            assert_int_equal(found[expected], i);
            assert_memory_equal(&hits[expected], &hit, sizeof hit);
            expected++;
        }
        assert_int_equal(expected, found_count);
        assert_int_equal(survivor, survivor_count);
        assert_int_equal(statistics.queries, count);
        assert_int_equal(statistics.hits, found_count);
        assert_int_equal(statistics.passed_filter, survivor_count);
        assert_true(statistics.passed_hull >= found_count && statistics.passed_hull <= survivor_count);
        batch.points = points;
        check_near_batch(&batch, found, found_count, survivors, survivor_count);
    }
}

/* without times every hit is still found; queries that start far away, or on a border, keep their bits */
static void check_near(const pel_ccd_batch *batch, double near)
{
    enum { LIMIT = 1000 };
    static int32_t all[LIMIT], found[LIMIT];
    static pel_ccd_hit all_hits[LIMIT], hits[LIMIT];
    pel_ccd_batch with = *batch;
    pel_ccd_statistics statistics = {0}, with_statistics = {0};
    with.near = near;
    int32_t count = pel_ccd_solve_batch(batch, all, all_hits, &statistics), next = 0, untimed = 0;
    int32_t found_count = pel_ccd_solve_batch(&with, found, hits, &with_statistics);
    for (int32_t i = 0; i < found_count; i++) {
        const pel_ccd_hit *hit = &hits[i];
        bool known = next < count && all[next] == found[i];
        if (known && memcmp(hit, &all_hits[next], sizeof *hit) == 0) {
            next++;
            continue;
        }
        query q = {.edge_edge = batch->edge_edge};
        memcpy(q.start, batch->start + 12 * (ptrdiff_t)found[i], sizeof q.start);
        memcpy(q.end, batch->end + 12 * (ptrdiff_t)found[i], sizeof q.end);
        double distance = distance_at(&q, 0), vector[3] = {0, 0, 0};
        assert_true(distance > batch->min_separation && distance <= near);
        assert_near(hit->time_of_impact, 0, 0);
        for (int p = 0; p < 4; p++) {
            assert_true(hit->weight[p] != 0);
            for (int k = 0; k < 3; k++)
                vector[k] += hit->weight[p] * q.start[p][k];
        }
        for (int k = 0; k < 3; k++)
            assert_near(vector[k], distance * hit->normal[k], 1e-9);
        next += known;
        untimed++;
    }
    assert_int_equal(next, count);
    assert_true(untimed > 10);
    assert_int_equal(with_statistics.cubics, statistics.cubics - untimed);
    assert_int_equal(with_statistics.passed_hull, statistics.passed_hull);
    assert_int_equal(with_statistics.hits, found_count);
}

static void test_near(void **unused)
{
    (void)unused;
    enum { COUNT = 1000 };
    static double start[12 * COUNT], end[12 * COUNT];
    random_state random = {11};
    for (int kind = 0; kind < 2; kind++) {
        for (int i = 0; i < COUNT;) {
            query q;
            random_query(&random, 0.5, &q);
            if (q.edge_edge != kind)
                continue;
            memcpy(start + 12 * (ptrdiff_t)i, q.start, sizeof q.start);
            memcpy(end + 12 * (ptrdiff_t)i++, q.end, sizeof q.end);
        }
        const pel_ccd_batch batch = {.start = start,
                                     .end = end,
                                     .query_count = COUNT,
                                     .edge_edge = kind,
                                     .min_separation = 0.01,
                                     .tolerance = 1e-6};
        check_near(&batch, 0.3);
        check_near(&batch, HUGE_VAL);
    }
}

/* ---- the kernel ---- */

/* four lanes have the bits of four single computations */
static void test_wide_is_scalar(void **unused)
{
    (void)unused;
    random_state random = {7};
    for (int trial = 0; trial < ROUNDS(2000, 200); trial++) {
        wide_ccd_pair wide;
        ccd_pair single[4];
        wide_ccd_cubic wide_cubic;
        bool edge_edge = trial % 2;
        double separation = trial % 3 ? 0 : 0.01;
        for (int lane = 0; lane < 4; lane++) {
            query q;
            random_query(&random, 1, &q);
            ccd_pair_set(&single[lane], 0, q.start, edge_edge);
            ccd_pair_set(&single[lane], 1, q.end, edge_edge);
            for (int time = 0; time < 2; time++)
                for (int k = 0; k < 3; k++) {
                    wide.offset[time][k][lane] = single[lane].offset[time][k];
                    wide.edge1[time][k][lane] = single[lane].edge1[time][k];
                    wide.edge2[time][k][lane] = single[lane].edge2[time][k];
                }
        }
        wide_ccd_pair_cubic(&wide, separation, &wide_cubic);
        wide4 corners[8][3], error = wide_ccd_pair_error(&wide);
        wide_ccd_pair wide_part;
        const double begin = 0.25, end = random_between(&random, 0.25, 1);
        wide_ccd_pair_part(&wide, wide4_set(begin), wide4_set(end), &wide_part);
        int count = wide_ccd_pair_corners(&wide_part, edge_edge, corners);
        wide4 margin = wide_ccd_hull_margin(&wide_part, corners, count, error, separation);
        wide4 descent = wide_ccd_descent_margin(corners, count, error, separation);
        for (int lane = 0; lane < 4; lane++) {
            ccd_cubic cubic;
            ccd_pair_cubic(&single[lane], separation, &cubic);
            for (int i = 0; i < 4; i++)
                assert_near(wide_cubic.coefficient[i][lane], cubic.coefficient[i], 0);
            assert_near(wide_cubic.band[lane], cubic.band, 0);
            ccd_pair part;
            double own[8][3], own_error = ccd_pair_error(&single[lane]);
            ccd_pair_part(&single[lane], begin, end, &part);
            ccd_pair_corners(&part, edge_edge, own);
            assert_near(margin[lane], ccd_hull_margin(&part, own, count, own_error, separation), 0);
            assert_near(descent[lane], ccd_descent_margin(own, count, own_error, separation), 0);
        }
    }
}

/* pairs separated by an axis are apart at all times, and the descent separates most pairs that are apart */
static void test_axes_are_true(void **unused)
{
    (void)unused;
    enum { SAMPLES = 20 };
    random_state random = {10};
    int apart = 0, proved = 0, count = ROUNDS(20000, 2000);
    for (int trial = 0; trial < count; trial++) {
        query q;
        ccd_pair pair;
        double corners[8][3], least = HUGE_VAL;
        random_query(&random, 0.2, &q);
        ccd_pair_set(&pair, 0, q.start, q.edge_edge);
        ccd_pair_set(&pair, 1, q.end, q.edge_edge);
        int corner_count = ccd_pair_corners(&pair, q.edge_edge, corners);
        double error = ccd_pair_error(&pair);
        bool is_free = ccd_descent_margin(corners, corner_count, error, q.min_separation) > 0;
        bool is_hull_free = ccd_hull_margin(&pair, corners, corner_count, error, q.min_separation) > 0;
        for (int i = 0; i <= SAMPLES; i++)
            least = fmin(least, distance_at(&q, (double)i / SAMPLES));
        assert_true(!(is_free || is_hull_free) || least > q.min_separation - 1e-14);
        apart += least > q.min_separation;
        proved += is_free;
    }
    assert_true(proved > 0.7 * apart);
}

/* a * b - c * d with equal products is zero, unless the compiler contracts it into a fused multiply-add */
static void test_no_contraction(void **unused)
{
    (void)unused;
    volatile double x = 1 + 0x1p-30;
    const double a[3] = {x, x, x};
    double product[3];
    cross(a, a, product);
    for (int k = 0; k < 3; k++)
        assert_near(product[k], 0, 0);
    assert_near(dot(a, (const double[3]){x, -x, 0}), 0, 0);
}

/* ---- the plain cubic ---- */

/* agrees on random queries, where nothing is degenerate */
static void test_plain_cubic(void **unused)
{
    (void)unused;
    random_state random = {8};
    int hit_count = 0;
    for (int trial = 0; trial < ROUNDS(20000, 2000); trial++) {
        query q;
        pel_ccd_hit hit, plain;
        random_query(&random, 1, &q);
        q.min_separation = 0;
        bool hits = solve(&q, 1e-9, &hit);
        bool plain_hits =
            pel_ccd_bridson((const double(*)[3])q.start, (const double(*)[3])q.end, q.edge_edge, 0, 1e-9, &plain);
        assert_int_equal(plain_hits, hits);
        if (hits)
            assert_near(plain.time_of_impact, hit.time_of_impact, 1e-5);
        hit_count += hits;
    }
    assert_true(hit_count > ROUNDS(1000, 100));
}

static bool solve_plain(const query *q, double tolerance, pel_ccd_hit *hit)
{
    return pel_ccd_bridson((const double(*)[3])q->start, (const double(*)[3])q->end, q->edge_edge, q->min_separation,
                           tolerance, hit);
}

/* through a face, past it, and stopping before it: there only the end of the step counts */
static void test_plain_cubic_known(void **unused)
{
    (void)unused;
    query q = {.start = {{0.25, 0.25, 3}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
               .end = {{0.25, 0.25, -1}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}}};
    pel_ccd_hit hit;
    assert_true(solve_plain(&q, 1e-9, &hit));
    assert_near(hit.time_of_impact, 0.75, 1e-12);
    assert_near(hit.normal[2], 1, 1e-9);
    assert_near(hit.weight[2], -0.25, 1e-9);
    q.start[0][0] = q.end[0][0] = 1.5;
    assert_false(solve_plain(&q, 1e-9, &hit));
    q.start[0][0] = q.end[0][0] = 0.25;
    q.end[0][2] = 0.05;
    assert_false(solve_plain(&q, 1e-9, &hit));
    assert_true(solve_plain(&q, 0.06, &hit));
    q.min_separation = 0.1;
    assert_true(solve_plain(&q, 1e-9, &hit));
    assert_near(hit.time_of_impact, 1, 0);
    q.end[0][2] = 0.11;
    assert_false(solve_plain(&q, 1e-9, &hit));
    q.end[0][2] = (double)NAN;
    assert_true(solve_plain(&q, 1e-9, &hit));
    assert_near(hit.time_of_impact, 0, 0);
    /* onto an edge that turns */
    query e = {.start = {{-1, 0, 1}, {1, 0, 1}, {0, -1, 0}, {0, 1, 0}},
               .end = {{-1, 0, -3}, {1, 0, -3}, {0, -1, -4}, {0, 1, 4}},
               .edge_edge = true};
    assert_true(solve_plain(&e, 1e-9, &hit));
    assert_near(hit.time_of_impact, 0.25, 1e-12);
    assert_near(hit.normal[2], sqrt(0.5), 1e-4);
}

/* a batch finds what single queries find, in any number */
static void test_plain_batches(void **unused)
{
    (void)unused;
    enum { COUNT = 600 };
    static query queries[COUNT];
    static double start[12 * COUNT], end[12 * COUNT];
    static int32_t found[COUNT];
    static pel_ccd_hit hits[COUNT];
    random_state random = {9};
    for (int kind = 0; kind < 2; kind++) {
        fill_batch(&random, queries, COUNT, kind, start, end);
        pel_ccd_batch batch = {.start = start,
                               .end = end,
                               .query_count = COUNT,
                               .edge_edge = kind,
                               .method = PEL_CCD_BRIDSON,
                               .tolerance = 1e-6};
        pel_ccd_statistics statistics = {0};
        int32_t next = 0, count = pel_ccd_solve_batch(&batch, found, hits, &statistics);
        for (int i = 0; i < COUNT; i++) {
            pel_ccd_hit hit;
            if (!solve_plain(&queries[i], 1e-6, &hit))
                continue;
            assert_true(next < count);
            assert_int_equal(found[next], i);
            assert_memory_equal(&hits[next++], &hit, sizeof hit);
        }
        assert_int_equal(next, count);
        assert_int_equal(statistics.hits, count);
        assert_int_equal(statistics.passed_hull, statistics.passed_filter);
        assert_true(count > COUNT / 20 && count < COUNT / 2);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_exact_contacts),
        cmocka_unit_test(test_exact_gaps),
        cmocka_unit_test(test_rounded_contacts),
        cmocka_unit_test(test_against_sampling),
        cmocka_unit_test(test_known_times),
        cmocka_unit_test(test_touching_start),
        cmocka_unit_test(test_bad_input),
        cmocka_unit_test(test_hard_motions),
        cmocka_unit_test(test_batches),
        cmocka_unit_test(test_wide_is_scalar),
        cmocka_unit_test(test_near),
        cmocka_unit_test(test_axes_are_true),
        cmocka_unit_test(test_no_contraction),
        cmocka_unit_test(test_plain_cubic),
        cmocka_unit_test(test_plain_cubic_known),
        cmocka_unit_test(test_plain_batches),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
