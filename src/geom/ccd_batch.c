/* Batches: blocks of queries go through the filter and the separating axes four at a time; what is left goes one by
   one. A block's list of survivors lies on the stack; nothing is allocated. */
#include "geom/ccd.h"

enum { BLOCK = 512 };

static void query_points(const pel_ccd_batch *batch, int32_t query, ccd_points *points)
{
    for (int i = 0; i < 4; i++) {
        ptrdiff_t point = batch->points != NULL ? batch->points[4 * (ptrdiff_t)query + i] : 4 * (ptrdiff_t)query + i;
        points->start[i] = batch->start + 3 * point;
        points->end[i] = batch->end + 3 * point;
    }
}

/* the differences of four queries */
static void wide_load(const pel_ccd_batch *batch, const int32_t queries[4], wide_ccd_pair *pair)
{
    wide4 start[4][3], end[4][3];
    ccd_points points[4];
    for (int lane = 0; lane < WIDE4_WIDTH; lane++)
        query_points(batch, queries[lane], &points[lane]);
    for (int i = 0; i < 4; i++) {
        const double *const starts[4] = {points[0].start[i], points[1].start[i], points[2].start[i],
                                         points[3].start[i]};
        const double *const ends[4] = {points[0].end[i], points[1].end[i], points[2].end[i], points[3].end[i]};
        wide4_load_points(starts, start[i]);
        wide4_load_points(ends, end[i]);
    }
    wide_ccd_pair_set(pair, 0, start, batch->edge_edge);
    wide_ccd_pair_set(pair, 1, end, batch->edge_edge);
}

typedef wide4 (*wide_stage)(const wide_ccd_pair *pair, bool edge_edge, double min_separation);

static inline wide4 stage_filter(const wide_ccd_pair *pair, bool edge_edge, double min_separation)
{
    (void)edge_edge;
    wide_ccd_cubic cubic;
    wide_ccd_pair_cubic(pair, min_separation, &cubic);
    return wide_ccd_cubic_margin(cubic.coefficient, cubic.band);
}

static inline wide4 stage_hull(const wide_ccd_pair *pair, bool edge_edge, double min_separation)
{
    return wide_ccd_hull_margin(pair, edge_edge, min_separation);
}

/* Keeps the queries that a stage does not prove free; kept may be queries. Returns how many. */
static inline int32_t run_stage(const pel_ccd_batch *batch, wide_stage stage, const int32_t *queries, int32_t count,
                                int32_t *kept)
{
    int32_t kept_count = 0;
    for (int32_t i = 0; i < count; i += WIDE4_WIDTH) {
        wide_ccd_pair pair;
        int32_t lanes[WIDE4_WIDTH];
        for (int lane = 0; lane < WIDE4_WIDTH; lane++)
            lanes[lane] = queries[i + lane < count ? i + lane : count - 1];
        wide_load(batch, lanes, &pair);
        wide4 margin = stage(&pair, batch->edge_edge, batch->min_separation);
        for (int lane = 0; lane < WIDE4_WIDTH && i + lane < count; lane++) {
            kept[kept_count] = lanes[lane];
            kept_count += !(margin[lane] > 0);
        }
    }
    return kept_count;
}

/* the same over `count` queries in a row from `first` on */
static int32_t filter_row(const pel_ccd_batch *batch, int32_t first, int32_t count, int32_t *kept)
{
    int32_t row[BLOCK];
    for (int32_t i = 0; i < count; i++)
        row[i] = first + i;
    return run_stage(batch, stage_filter, row, count, kept);
}

/* negative counts as zero, NaN proves nothing */
static pel_ccd_batch cleaned(const pel_ccd_batch *batch)
{
    pel_ccd_batch clean = *batch;
    if (clean.min_separation < 0)
        clean.min_separation = 0;
    if (clean.min_separation != clean.min_separation)
        clean.min_separation = INFINITY;
    return clean;
}

static int32_t block_size(const pel_ccd_batch *batch, int32_t first)
{
    int32_t left = batch->query_count - first;
    return left < BLOCK ? left : BLOCK;
}

int32_t pel_ccd_filter_batch(const pel_ccd_batch *batch, int32_t *survivors)
{
    pel_ccd_batch clean = cleaned(batch);
    int32_t survivor_count = 0;
    for (int32_t first = 0; first < batch->query_count; first += BLOCK)
        survivor_count += filter_row(&clean, first, block_size(batch, first), survivors + survivor_count);
    return survivor_count;
}

static bool solve_one(const pel_ccd_batch *batch, int32_t query, pel_ccd_hit *hit, pel_ccd_statistics *statistics)
{
    ccd_points points;
    ccd_counts counts = {0};
    query_points(batch, query, &points);
    bool hits;
    if (batch->method == PEL_CCD_BRIDSON)
        hits = ccd_solve_bridson(&points, batch->edge_edge, batch->min_separation, batch->tolerance, hit);
    else
        hits = ccd_solve(&points, batch->edge_edge, batch->min_separation, batch->tolerance, hit, &counts);
    statistics->intervals += counts.intervals;
    statistics->fall_backs += counts.fall_back;
    statistics->hits += hits;
    return hits;
}

static void add_statistics(pel_ccd_statistics *sum, const pel_ccd_statistics *more)
{
    if (sum == NULL)
        return;
    sum->queries += more->queries;
    sum->passed_filter += more->passed_filter;
    sum->passed_hull += more->passed_hull;
    sum->hits += more->hits;
    sum->intervals += more->intervals;
    sum->fall_backs += more->fall_backs;
}

int32_t pel_ccd_solve_batch(const pel_ccd_batch *batch, int32_t *queries, pel_ccd_hit *hits,
                            pel_ccd_statistics *statistics)
{
    pel_ccd_batch clean = cleaned(batch);
    pel_ccd_statistics counted = {0};
    int32_t hit_count = 0, kept[BLOCK];
    for (int32_t first = 0; first < batch->query_count; first += BLOCK) {
        int32_t count = block_size(batch, first);
        counted.queries += count;
        count = filter_row(&clean, first, count, kept);
        counted.passed_filter += count;
        if (batch->method == PEL_CCD_CONSERVATIVE)
            count = run_stage(&clean, stage_hull, kept, count, kept);
        counted.passed_hull += count;
        for (int32_t i = 0; i < count; i++)
            if (solve_one(&clean, kept[i], hits != NULL ? &hits[hit_count] : NULL, &counted))
                queries[hit_count++] = kept[i];
    }
    add_statistics(statistics, &counted);
    return hit_count;
}
