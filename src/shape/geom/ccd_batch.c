/* Batches: blocks of queries go through the filter and the separating axes four at a time; survivors go one by one. A
   block's list of survivors is on the stack; nothing is allocated. */
#include "geom/ccd.h"

enum { BLOCK = 512 };

/* where the coordinates of point i of a query begin; points is nullable */
WIDE4_INLINE ptrdiff_t point_offset(const int32_t *points, int32_t query, int i)
{
    ptrdiff_t place = 4 * (ptrdiff_t)query + i;
    return 3 * (points != NULL ? (ptrdiff_t)points[place] : place);
}

static void query_points(const pel_ccd_batch *batch, int32_t query, ccd_points *points)
{
    for (int i = 0; i < 4; i++) {
        points->start[i] = batch->start + point_offset(batch->points, query, i);
        points->end[i] = batch->end + point_offset(batch->points, query, i);
    }
}

/* the points i of four queries at one time */
WIDE4_INLINE void load_points(const double *positions, const ptrdiff_t offsets[4], wide4 xyz[3])
{
    const double *const points[4] = {positions + offsets[0], positions + offsets[1], positions + offsets[2],
                                     positions + offsets[3]};
    wide4_load_points(points, xyz);
}

/* the differences of four queries */
WIDE4_INLINE void wide_load(const pel_ccd_batch *batch, const int32_t *numbers, const int32_t queries[4],
                            bool edge_edge, wide_ccd_pair *pair)
{
    wide4 start[4][3], end[4][3];
    for (int i = 0; i < 4; i++) {
        ptrdiff_t offsets[WIDE4_WIDTH];
        for (int lane = 0; lane < WIDE4_WIDTH; lane++)
            offsets[lane] = point_offset(numbers, queries[lane], i);
        load_points(batch->start, offsets, start[i]);
        load_points(batch->end, offsets, end[i]);
    }
    wide_ccd_pair_set(pair, 0, start, edge_edge);
    wide_ccd_pair_set(pair, 1, end, edge_edge);
}

typedef enum wide_stage { STAGE_FILTER, STAGE_HULL } wide_stage;

typedef struct query_list {
    const int32_t *queries;
    int32_t count;
} query_list;

/* Keeps the queries that a stage does not prove free; kept may be the list itself. Returns how many. The arguments
   before the list are constants at each call: no branches are left in the kernel. */
WIDE4_INLINE int32_t run_stage_of(wide_stage stage, bool edge_edge, const int32_t *numbers, const pel_ccd_batch *batch,
                                  query_list list, int32_t *kept)
{
    const double min_separation = batch->min_separation;
    int32_t kept_count = 0;
    for (int32_t i = 0; i < list.count; i += WIDE4_WIDTH) {
        wide_ccd_pair pair;
        wide_ccd_cubic cubic;
        wide4 margin;
        int32_t lanes[WIDE4_WIDTH];
        for (int lane = 0; lane < WIDE4_WIDTH; lane++)
            lanes[lane] = list.queries[i + lane < list.count ? i + lane : list.count - 1];
        wide_load(batch, numbers, lanes, edge_edge, &pair);
        if (stage == STAGE_FILTER) {
            wide_ccd_pair_cubic(&pair, min_separation, &cubic);
            margin = wide_ccd_cubic_margin(cubic.coefficient, cubic.band);
        } else {
            wide4 corners[8][3];
            int count = wide_ccd_pair_corners(&pair, edge_edge, corners);
            margin = wide_ccd_hull_margin(&pair, corners, count, wide_ccd_pair_error(&pair), min_separation);
        }
        for (int lane = 0; lane < WIDE4_WIDTH && i + lane < list.count; lane++) {
            kept[kept_count] = lanes[lane];
            kept_count += !(margin[lane] > 0);
        }
    }
    return kept_count;
}

static int32_t run_filter(const pel_ccd_batch *batch, query_list list, int32_t *kept)
{
    if (batch->points != NULL)
        return batch->edge_edge ? run_stage_of(STAGE_FILTER, true, batch->points, batch, list, kept)
                                : run_stage_of(STAGE_FILTER, false, batch->points, batch, list, kept);
    return batch->edge_edge ? run_stage_of(STAGE_FILTER, true, NULL, batch, list, kept)
                            : run_stage_of(STAGE_FILTER, false, NULL, batch, list, kept);
}

static int32_t run_hull(const pel_ccd_batch *batch, query_list list, int32_t *kept)
{
    return batch->edge_edge ? run_stage_of(STAGE_HULL, true, batch->points, batch, list, kept)
                            : run_stage_of(STAGE_HULL, false, batch->points, batch, list, kept);
}

/* the filter over `count` queries in a row from `first` on */
static int32_t filter_row(const pel_ccd_batch *batch, int32_t first, int32_t count, int32_t *kept)
{
    int32_t row[BLOCK];
    for (int32_t i = 0; i < count; i++)
        row[i] = first + i;
    return run_filter(batch, (query_list){row, count}, kept);
}

/* negative counts as zero, NaN proves nothing */
static pel_ccd_batch cleaned(const pel_ccd_batch *batch)
{
    pel_ccd_batch clean = *batch;
    if (clean.min_separation < 0)
        clean.min_separation = 0;
    if (clean.min_separation != clean.min_separation)
        clean.min_separation = HUGE_VAL;
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

int32_t pel_ccd_near_batch(const pel_ccd_batch *batch, int32_t *survivors)
{
    pel_ccd_batch clean = cleaned(batch);
    int32_t survivor_count = 0;
    for (int32_t first = 0; first < batch->query_count; first += BLOCK) {
        int32_t *kept = survivors + survivor_count;
        int32_t count = filter_row(&clean, first, block_size(batch, first), kept);
        survivor_count += run_hull(&clean, (query_list){kept, count}, kept);
    }
    return survivor_count;
}

static bool solve_one(const pel_ccd_batch *batch, int32_t query, pel_ccd_hit *hit, pel_ccd_statistics *statistics)
{
    ccd_points points;
    ccd_counts counts = {0};
    const ccd_lengths lengths = {batch->min_separation, batch->tolerance, batch->near};
    query_points(batch, query, &points);
    bool hits;
    if (batch->method == PEL_CCD_BRIDSON)
        hits = ccd_solve_bridson(&points, batch->edge_edge, batch->min_separation, batch->tolerance, hit);
    else
        hits = ccd_solve(&points, batch->edge_edge, &lengths, hit, &counts);
    const bool is_solved = batch->method == PEL_CCD_BRIDSON || counts.intervals > 0;
    statistics->passed_hull += hits || is_solved;
    statistics->cubics += is_solved;
    statistics->intervals += counts.intervals;
    statistics->fall_backs += counts.fall_back;
    statistics->hits += hits;
    return hits;
}

int32_t pel_ccd_solve_batch(const pel_ccd_batch *batch, int32_t *queries, pel_ccd_hit *hits,
                            pel_ccd_statistics *statistics)
{
    pel_ccd_batch clean = cleaned(batch), filtered = clean;
    pel_ccd_statistics counted = {0};
    if (batch->method == PEL_CCD_BRIDSON && batch->tolerance > 0)
        filtered.min_separation += batch->tolerance;
    int32_t hit_count = 0, kept[BLOCK];
    for (int32_t first = 0; first < batch->query_count; first += BLOCK) {
        int32_t count = block_size(batch, first);
        counted.queries += count;
        count = filter_row(&filtered, first, count, kept);
        counted.passed_filter += count;
        if (batch->method == PEL_CCD_CONSERVATIVE)
            count = run_hull(&clean, (query_list){kept, count}, kept);
        for (int32_t i = 0; i < count; i++)
            if (solve_one(&clean, kept[i], hits != NULL ? &hits[hit_count] : NULL, &counted))
                queries[hit_count++] = kept[i];
    }
    if (statistics != NULL)
        pel_ccd_statistics_add(statistics, &counted);
    return hit_count;
}
