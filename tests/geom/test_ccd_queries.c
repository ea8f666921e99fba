/* The handcrafted queries with exact ground truth in ../shared/data/ccd, if available (see its README.md). */
#include "check.h"

#include <stdbool.h>
#include <stdlib.h>

#include "pellicle/geometry.h"
#include "source_dir.h"

#define QUERY_FOLDER PEL_SOURCE_DIR "/../shared/data/ccd/"

enum { RECORD_SIZE = 208, HANDCRAFTED_COUNT = 10 };

static const char *const handcrafted[HANDCRAFTED_COUNT] = {
    "erleben-cube-cliff-edges", "erleben-cube-internal-edges",
    "erleben-sliding-spike",    "erleben-sliding-wedge",
    "erleben-spike-crack",      "erleben-spike-hole",
    "erleben-spike-wedge",      "erleben-spikes",
    "erleben-wedge-crack",      "erleben-wedges",
};

typedef struct query {
    double start[4][3], end[4][3];
    double time_of_impact; /* NaN = none or unknown */
    bool edge_edge, touches;
} query;

typedef struct query_set {
    query *queries;
    int count;
} query_set;

static bool set_exists(const char *name)
{
    char path[1024];
    snprintf(path, sizeof path, QUERY_FOLDER "%s.ccdq.xz", name);
    FILE *file = fopen(path, "rb");
    if (file == NULL)
        return false;
    fclose(file);
    return true;
}

/* count 0 when the file or xz is absent */
static query_set read_set(const char *name)
{
    query_set set = {NULL, 0};
    char command[1100];
    uint32_t header[4];
    if (!set_exists(name))
        return set;
    snprintf(command, sizeof command, "xz -dc '" QUERY_FOLDER "%s.ccdq.xz' 2>/dev/null", name);
    FILE *pipe = popen(command, "r");
    if (pipe == NULL)
        return set;
    if (fread(header, sizeof header, 1, pipe) == 1 && header[0] == 0x51444343 && header[3] == RECORD_SIZE) {
        set.queries = calloc(header[2], sizeof *set.queries);
        for (uint32_t i = 0; i < header[2]; i++) {
            unsigned char record[RECORD_SIZE];
            if (fread(record, RECORD_SIZE, 1, pipe) != 1)
                break;
            query *q = &set.queries[set.count++];
            memcpy(q->start, record, 96);
            memcpy(q->end, record + 96, 96);
            memcpy(&q->time_of_impact, record + 192, 8);
            q->edge_edge = record[204] == 1;
            q->touches = record[205] == 1;
        }
    }
    pclose(pipe);
    return set;
}

typedef struct tally {
    int queries, touching, false_positives, false_negatives, late, far_early;
} tally;

static bool answer(const query *q, const int order[4], double min_separation, double tolerance, pel_ccd_hit *hit)
{
    double start[4][3], end[4][3];
    for (int i = 0; i < 4; i++) {
        memcpy(start[i], q->start[order[i]], sizeof start[i]);
        memcpy(end[i], q->end[order[i]], sizeof end[i]);
    }
    const double(*s)[3] = (const double(*)[3])start, (*e)[3] = (const double(*)[3])end;
    bool hits = q->edge_edge ? pel_ccd_edge_edge(s, e, min_separation, tolerance, hit)
                             : pel_ccd_vertex_face(s, e, min_separation, tolerance, hit);
    if (hits)
        assert_true(pel_ccd_filter(s, e, q->edge_edge, min_separation));
    return hits;
}

static const int same_order[4] = {0, 1, 2, 3};
static const int face_orders[5][4] = {{0, 1, 3, 2}, {0, 2, 1, 3}, {0, 2, 3, 1}, {0, 3, 1, 2}, {0, 3, 2, 1}};
static const int edge_orders[7][4] = {{0, 1, 3, 2}, {1, 0, 2, 3}, {1, 0, 3, 2}, {2, 3, 0, 1},
                                      {2, 3, 1, 0}, {3, 2, 0, 1}, {3, 2, 1, 0}};

/* every order of the points gives the same bits */
static void check_orders(const query *q, bool expected, const pel_ccd_hit *hit)
{
    for (int i = 0; i < (q->edge_edge ? 7 : 5); i++) {
        pel_ccd_hit again;
        const int *order = q->edge_edge ? edge_orders[i] : face_orders[i];
        assert_int_equal(answer(q, order, 0, 1e-6, &again), expected);
        if (!expected)
            continue;
        assert_memory_equal(&again.time_of_impact, &hit->time_of_impact, sizeof(double));
        for (int k = 0; k < 3; k++)
            assert_near(fabs(again.normal[k]), fabs(hit->normal[k]), 0);
    }
}

static void run_set(const char *name, double tolerance, tally *sum)
{
    query_set set = read_set(name);
    for (int i = 0; i < set.count; i++) {
        const query *q = &set.queries[i];
        pel_ccd_hit hit;
        bool hits = answer(q, same_order, 0, tolerance, &hit);
        if (tolerance == 1e-6)
            check_orders(q, hits, &hit);
        sum->queries++;
        sum->touching += q->touches;
        sum->false_positives += hits && !q->touches;
        sum->false_negatives += !hits && q->touches;
        sum->late += hits && q->touches && hit.time_of_impact > q->time_of_impact;
        sum->far_early += hits && q->touches && hit.time_of_impact < q->time_of_impact - 1e-3;
    }
    free(set.queries);
}

static void report(const char *name, const tally *sum)
{
    print_message("%s: %d queries, %d touching, false positives %d, false negatives %d, late %d, early by 1e-3 %d\n",
                  name, sum->queries, sum->touching, sum->false_positives, sum->false_negatives, sum->late,
                  sum->far_early);
}

static void test_handcrafted(void **unused)
{
    (void)unused;
    tally sum = {0};
    for (int i = 0; i < HANDCRAFTED_COUNT; i++)
        run_set(handcrafted[i], 1e-6, &sum);
    if (sum.queries == 0)
        skip();
    report("handcrafted", &sum);
    assert_int_equal(sum.false_negatives, 0);
    assert_int_equal(sum.late, 0);
    assert_true(sum.false_positives <= 250);
}

static void test_unit_cases(void **unused)
{
    (void)unused;
    const double tolerances[3] = {1e-6, 0, 1e-3};
    for (int i = 0; i < 3; i++) {
        tally sum = {0};
        run_set("unit-tests", tolerances[i], &sum);
        if (sum.queries == 0)
            skip();
        report("unit tests", &sum);
        assert_int_equal(sum.false_negatives, 0);
        assert_int_equal(sum.late, 0);
        assert_true(sum.false_positives == 0 || i == 2);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_handcrafted),
        cmocka_unit_test(test_unit_cases),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
