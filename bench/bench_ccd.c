/* Continuous collision: ns a query of each stage, conservative method beside the plain cubic, one thread.
   Queries are random pairs whose swept boxes overlap, as a broad phase would hand them over; "small" motion is 5 % of
   the features' size, "large" 50 %. Misses and hits are timed apart, one query a call
   and in a batch. usage: bench_ccd [queries a set]
 */
#include "bench.h"
#include "pellicle/geometry.h"
#include "tests/random.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { REPEATS = 9 };

typedef struct query_set {
    const char *name;
    bool edge_edge;
    int count;
    double (*start)[4][3], (*end)[4][3];
} query_set;

static bool boxes_overlap(const double start[4][3], const double end[4][3], int first)
{
    for (int k = 0; k < 3; k++) {
        double low[2] = {1e30, 1e30}, high[2] = {-1e30, -1e30};
        for (int i = 0; i < 4; i++)
            for (int time = 0; time < 2; time++) {
                int part = i >= first;
                double x = time ? end[i][k] : start[i][k];
                low[part] = x < low[part] ? x : low[part];
                high[part] = x > high[part] ? x : high[part];
            }
        if (low[0] > high[1] || low[1] > high[0])
            return false;
    }
    return true;
}

static query_set make_set(const char *name, bool edge_edge, double motion, int count, random_state *random)
{
    query_set set = {name, edge_edge, count, bench_allocate((size_t)count, sizeof *set.start),
                     bench_allocate((size_t)count, sizeof *set.end)};
    for (int q = 0; q < count;) {
        double size = 0.6;
        for (int i = 0; i < 4; i++)
            for (int k = 0; k < 3; k++) {
                set.start[q][i][k] = random_between(random, 0, size);
                set.end[q][i][k] = set.start[q][i][k] + motion * size * random_between(random, -1, 1);
            }
        q += boxes_overlap((const double(*)[3])set.start[q], (const double(*)[3])set.end[q], edge_edge ? 2 : 1);
    }
    return set;
}

static bool solve(const query_set *set, int q, bool plain, pel_ccd_hit *hit)
{
    const double(*start)[3] = (const double(*)[3])set->start[q], (*end)[3] = (const double(*)[3])set->end[q];
    if (plain)
        return pel_ccd_bridson(start, end, set->edge_edge, 0, 1e-6, hit);
    return set->edge_edge ? pel_ccd_edge_edge(start, end, 0, 1e-6, hit) : pel_ccd_vertex_face(start, end, 0, 1e-6, hit);
}

static void print_times(const query_set *set, const char *what, int count, double times[REPEATS])
{
    const bench_spread time = bench_spread_of(times, REPEATS);
    printf("%-12s %-28s %8d queries %9.1f ns min %9.1f ns median\n", set->name, what, count, 1e9 * time.least / count,
           1e9 * time.median / count);
}

static void time_one_by_one(const query_set *set, const int *queries, int count, bool plain, const char *what)
{
    double times[REPEATS];
    pel_ccd_hit hit;
    volatile int hits = 0;
    if (count == 0)
        return;
    for (int repeat = 0; repeat < REPEATS; repeat++) {
        double begin = pel_seconds();
        int found = 0;
        for (int i = 0; i < count; i++)
            found += solve(set, queries[i], plain, &hit);
        times[repeat] = pel_seconds() - begin;
        hits = found;
    }
    (void)hits;
    print_times(set, what, count, times);
}

/* the chosen queries in one batch */
static void time_chosen(const query_set *set, const int32_t *chosen, int count, const char *what)
{
    double times[REPEATS];
    int32_t *points = bench_allocate((size_t)count, sizeof(int32_t[4]));
    int32_t *queries = bench_allocate((size_t)count, sizeof *queries);
    for (int32_t i = 0; i < 4 * count; i++)
        points[i] = 4 * chosen[i / 4] + i % 4;
    const pel_ccd_batch batch = {.start = &set->start[0][0][0],
                                 .end = &set->end[0][0][0],
                                 .points = points,
                                 .query_count = count,
                                 .edge_edge = set->edge_edge,
                                 .tolerance = 1e-6};
    for (int repeat = 0; repeat < REPEATS; repeat++) {
        double begin = pel_seconds();
        pel_ccd_solve_batch(&batch, queries, NULL, NULL);
        times[repeat] = pel_seconds() - begin;
    }
    print_times(set, what, count, times);
    free(points);
    free(queries);
}

static void time_batch(const query_set *set, pel_ccd_method method, bool filter_only, const char *what,
                       int32_t *queries, pel_ccd_hit *hits)
{
    double times[REPEATS];
    pel_ccd_statistics statistics;
    pel_ccd_batch batch = {.start = &set->start[0][0][0],
                           .end = &set->end[0][0][0],
                           .query_count = set->count,
                           .edge_edge = set->edge_edge,
                           .method = method,
                           .tolerance = 1e-6};
    for (int repeat = 0; repeat < REPEATS; repeat++) {
        memset(&statistics, 0, sizeof statistics);
        double begin = pel_seconds();
        if (filter_only)
            statistics.passed_filter = pel_ccd_filter_batch(&batch, queries);
        else
            pel_ccd_solve_batch(&batch, queries, hits, &statistics);
        times[repeat] = pel_seconds() - begin;
    }
    print_times(set, what, set->count, times);
    if (filter_only)
        return;
    double percent = 100.0 / set->count;
    printf("%-12s   passed filter %.2f %%, passed axes %.2f %%, hits %.2f %%, intervals %lld, fall-backs %lld\n", "",
           percent * (double)statistics.passed_filter, percent * (double)statistics.passed_hull,
           percent * (double)statistics.hits, (long long)statistics.intervals, (long long)statistics.fall_backs);
}

static void run_set(query_set set)
{
    int32_t *chosen = bench_allocate((size_t)set.count, sizeof *chosen);
    pel_ccd_hit hit, *hits = bench_allocate((size_t)set.count, sizeof *hits);
    time_batch(&set, PEL_CCD_CONSERVATIVE, true, "batched filter", chosen, hits);
    time_batch(&set, PEL_CCD_CONSERVATIVE, false, "batch, conservative", chosen, hits);
    time_batch(&set, PEL_CCD_BRIDSON, false, "batch, plain cubic", chosen, hits);
    for (int hitting = 0; hitting < 2; hitting++) {
        int count = 0;
        for (int q = 0; q < set.count; q++)
            if (solve(&set, q, false, &hit) == hitting)
                chosen[count++] = q;
        time_one_by_one(&set, chosen, count, false, hitting ? "hits, conservative" : "misses, conservative");
        time_one_by_one(&set, chosen, count, true, hitting ? "hits, plain cubic" : "misses, plain cubic");
        time_chosen(&set, chosen, count, hitting ? "hits, conservative, batch" : "misses, conservative, batch");
    }
    free(chosen);
    free(hits);
    free(set.start);
    free(set.end);
}

int main(int argument_count, char **arguments)
{
    int count = argument_count > 1 ? atoi(arguments[1]) : 100000;
    random_state random = {1};
    run_set(make_set("vf small", false, 0.05, count, &random));
    run_set(make_set("vf large", false, 0.5, count, &random));
    run_set(make_set("ee small", true, 0.05, count, &random));
    run_set(make_set("ee large", true, 0.5, count, &random));
    return 0;
}
