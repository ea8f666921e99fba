#include "collide/clearance.h"

#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "geom/wide4.h"
#include "math/extremes.h"
#include "math/vec3.h"
#include "pellicle/geometry.h"

#include <math.h>
#include <string.h>

enum { PARTS = 64, WORTH_STEPS = 16, WORTH_USES = 8, PAUSE_LIMIT = 64 };

/* of lengths: more than the rounding of distances */
#define SLACK 1e-6
/* of the distance of the nearest pair: from this approach on it may be worth to measure that anew */
#define SETTLE_SHARE 0.05

pel_status pel_clearance_create(int32_t point_count, pel_clearance *clearance, pel_error *error)
{
    *clearance = (pel_clearance){.point_count = point_count};
    /* one more: points are read four numbers at once */
    clearance->positions = pel_allocate((size_t)point_count + 1, sizeof *clearance->positions);
    return clearance->positions != NULL ? PEL_OK : pel_fail_memory(error);
}

void pel_clearance_clear(pel_clearance *clearance)
{
    PEL_FREE_ALL(clearance->positions, clearance->vertex_face.pairs, clearance->edge_edge.pairs);
    *clearance = (pel_clearance){0};
}

/* ---- motion ---- */

/* boxes around the displacements of all points from one set of positions to one or two others, whose first points may
   be records */
typedef struct motion_job {
    const double (*from)[3], (*to[2])[3];
    const pel_record *records[2]; /* (record_count) */
    int32_t point_count, record_count, target_count;
    double low[2][PARTS][3], high[2][PARTS][3];
    bool is_finite[2][PARTS];
} motion_job;

/* the j-th four of the twelve numbers of four points */
static wide4 load_four(const double points[4][3], int j)
{
    wide4 four;
    memcpy(&four, (const char *)points + (size_t)j * sizeof four, sizeof four);
    return four;
}

/* the points that are records; reads the number behind a point as well */
static void measure_records(motion_job *job, int32_t target, int32_t part, int64_t begin, int64_t end)
{
    const pel_record *to = job->records[target];
    wide4 least = wide4_set(HUGE_VAL), most = wide4_set(-HUGE_VAL), bad = wide4_set(0);
    for (int64_t p = begin; p < end; p++) {
        wide4 from;
        memcpy(&from, job->from[p], sizeof from);
        wide4 way = __builtin_convertvector(to[p], wide4) - from;
        least = wide4_min(way, least);
        most = wide4_max(way, most);
        bad += way - way;
    }
    for (int k = 0; k < 3; k++) {
        job->low[target][part][k] = least[k];
        job->high[target][part][k] = most[k];
    }
    job->is_finite[target][part] = bad[0] + bad[1] + bad[2] == 0;
}

/* The others, added. Four points are twelve numbers side by side: lane l of the j-th vector is coordinate
   (4 j + l) % 3. */
static void measure_points(motion_job *job, int32_t target, int32_t part, int64_t p, int64_t end)
{
    const double(*from)[3] = job->from, (*to)[3] = job->to[target];
    double *low = job->low[target][part], *high = job->high[target][part], lost = 0;
    wide4 least[3], most[3], bad = wide4_set(0);
    for (int j = 0; j < 3; j++) {
        least[j] = wide4_set(HUGE_VAL);
        most[j] = wide4_set(-HUGE_VAL);
    }
    for (; p + 4 <= end; p += 4)
        for (int j = 0; j < 3; j++) {
            wide4 way = load_four(&to[p], j) - load_four(&from[p], j);
            least[j] = wide4_min(way, least[j]);
            most[j] = wide4_max(way, most[j]);
            bad += way - way;
        }
    for (int j = 0; j < 12; j++) {
        double a = least[j / 4][j % 4], b = most[j / 4][j % 4];
        low[j % 3] = a < low[j % 3] ? a : low[j % 3];
        high[j % 3] = b > high[j % 3] ? b : high[j % 3];
    }
    for (; p < end; p++)
        for (int k = 0; k < 3; k++) {
            double way = to[p][k] - from[p][k];
            low[k] = way < low[k] ? way : low[k];
            high[k] = way > high[k] ? way : high[k];
            lost += way - way;
        }
    job->is_finite[target][part] &= lost + (bad[0] + bad[1]) + (bad[2] + bad[3]) == 0;
}

static void measure_part(void *context, int32_t part)
{
    motion_job *job = context;
    int64_t count = job->point_count, begin = count * part / PARTS, end = count * (part + 1) / PARTS;
    int64_t middle = job->record_count < begin ? begin : job->record_count < end ? job->record_count : end;
    for (int32_t target = 0; target < job->target_count; target++) {
        measure_records(job, target, part, begin, middle);
        measure_points(job, target, part, middle, end);
    }
}

static double approach_of(const motion_job *job, int32_t target)
{
    double square = 0;
    for (int k = 0; k < 3; k++) {
        double low = HUGE_VAL, high = -HUGE_VAL;
        for (int part = 0; part < PARTS; part++) {
            low = pel_min(low, job->low[target][part][k]);
            high = pel_max(high, job->high[target][part][k]);
            if (!job->is_finite[target][part])
                return HUGE_VAL;
        }
        square += high > low ? (high - low) * (high - low) : 0;
    }
    return sqrt(square);
}

/* Largest approach of any two points on the path to one of the targets; infinite if a displacement is not finite. */
static double longest_approach(motion_job *job, pel_pool *pool)
{
    pel_pool_run(pool, PARTS, measure_part, job);
    double longest = approach_of(job, 0);
    return job->target_count > 1 ? pel_max(longest, approach_of(job, 1)) : longest;
}

/* m, approach of two points that brings a pair of this distance as near as `needed` */
static double room_of(double distance, double needed)
{
    return distance - needed * (1 + SLACK);
}

static bool stays_below(pel_clearance *clearance, motion_job *job, double room, pel_pool *pool)
{
    if (!(room > 0))
        return false;
    job->from = (const double(*)[3])clearance->positions;
    job->point_count = clearance->point_count;
    bool is_below = longest_approach(job, pool) < room;
    clearance->uses += is_below;
    return is_below;
}

bool pel_clearance_serves(pel_clearance *clearance, const double (*start)[3], const double (*end)[3], double needed,
                          pel_pool *pool)
{
    motion_job job = {.to = {end, start}, .target_count = start != end ? 2 : 1};
    return stays_below(clearance, &job, room_of(clearance->reach, needed), pool);
}

/* approach that brings the nearest of all pairs as near as `needed` */
static double clear_room(const pel_clearance *clearance, double needed)
{
    return room_of(pel_min(clearance->reach, clearance->nearest), needed);
}

bool pel_clearance_is_clear(pel_clearance *clearance, const pel_clearance_way *way, double needed, pel_pool *pool)
{
    double room = clear_room(clearance, needed);
    if (way->start_records == NULL && !(clearance->approach < room))
        return false;
    motion_job job = {.to = {way->end, way->start},
                      .records = {way->end_records, way->start_records},
                      .record_count = way->record_count,
                      .target_count = way->start_records != NULL ? 2 : 1};
    bool is_clear = stays_below(clearance, &job, room, pool);
    if (is_clear)
        clearance->approach = approach_of(&job, 0);
    return is_clear;
}

bool pel_clearance_stays_clear(pel_clearance *clearance, double longest, bool ends, double needed)
{
    double approach = clearance->approach + 2 * longest * (1 + SLACK);
    bool is_clear = approach < clear_room(clearance, needed);
    if (is_clear && ends)
        clearance->approach = approach;
    clearance->uses += is_clear;
    return is_clear;
}

void pel_clearance_go(pel_clearance *clearance, const pel_record *positions, double needed, pel_pool *pool)
{
    motion_job job = {.from = (const double(*)[3])clearance->positions,
                      .records = {positions},
                      .point_count = clearance->point_count,
                      .record_count = clearance->point_count,
                      .target_count = 1};
    /* where pairs are near in any case it is not worth a look */
    clearance->approach = clear_room(clearance, needed) > 0 ? longest_approach(&job, pool) : HUGE_VAL;
}

/* ---- pairs ---- */

/* m2, distance of a pair at the positions */
static double squared_distance(const pel_clearance *clearance, const pel_tree *tree, bool edge_edge, pel_pair pair)
{
    const double(*x)[3] = (const double(*)[3])clearance->positions;
    double weights[4];
    if (edge_edge) {
        int32_t a[2], b[2];
        pel_tree_edge_ends(tree, pair.first, a);
        pel_tree_edge_ends(tree, pair.second, b);
        return pel_closest_segment_segment(x[a[0]], x[a[1]], x[b[0]], x[b[1]], weights);
    }
    const int32_t *c = tree->triangles[pair.second];
    return pel_closest_point_triangle(x[pair.first], x[c[0]], x[c[1]], x[c[2]], weights);
}

/* pairs of one kind, measured at once: chunks of the list are kept where they stand until all are measured */
typedef struct measure_job {
    pel_clearance *clearance;
    const pel_tree *tree;
    pel_pair_list *list;
    bool edge_edge;
    size_t kept[PARTS];
    double least[PARTS];
} measure_job;

static size_t part_begin(const measure_job *job, int32_t part)
{
    return job->list->count * (size_t)part / (size_t)PARTS;
}

static void measure_pairs(void *context, int32_t part)
{
    measure_job *job = context;
    double reach = job->clearance->reach, least = HUGE_VAL;
    pel_pair *pairs = job->list->pairs;
    size_t kept = part_begin(job, part);
    for (size_t i = kept; i < part_begin(job, part + 1); i++) {
        double square = squared_distance(job->clearance, job->tree, job->edge_edge, pairs[i]);
        least = pel_min(least, square);
        pairs[kept] = pairs[i];
        if (!(square > reach * reach))
            kept++;
    }
    job->kept[part] = kept - part_begin(job, part);
    job->least[part] = least;
}

/* drops the pairs of one kind that are beyond the reach; returns the least distance of the others [m] */
static double measure_kind(pel_clearance *clearance, const pel_tree *tree, bool edge_edge, pel_pool *pool)
{
    pel_pair_list *list = edge_edge ? &clearance->edge_edge : &clearance->vertex_face;
    measure_job job = {.clearance = clearance, .tree = tree, .list = list, .edge_edge = edge_edge};
    double least = HUGE_VAL;
    size_t count = 0;
    if (list->count == 0)
        return HUGE_VAL;
    pel_pool_run(pool, PARTS, measure_pairs, &job);
    for (int32_t part = 0; part < PARTS; part++) {
        memmove(list->pairs + count, list->pairs + part_begin(&job, part), job.kept[part] * sizeof *list->pairs);
        count += job.kept[part];
        least = pel_min(least, job.least[part]);
    }
    list->count = count;
    return sqrt(least);
}

/* the pairs within the reach of the positions, and the nearest of them; infinite without pairs */
static void measure_all(pel_clearance *clearance, const pel_tree *tree, pel_pool *pool)
{
    double nearest = measure_kind(clearance, tree, false, pool);
    clearance->nearest = pel_min(nearest, measure_kind(clearance, tree, true, pool));
    clearance->approach = HUGE_VAL;
}

/* counts slow steps in which a try is put off, longer each time that the last one served few */
static bool is_worth_it(pel_clearance *clearance, const double (*start)[3], const double (*end)[3], double margin,
                        pel_pool *pool)
{
    motion_job job = {.from = start, .to = {end}, .point_count = clearance->point_count, .target_count = 1};
    if (!(margin > 0) || !(WORTH_STEPS * longest_approach(&job, pool) < margin))
        return false;
    if (clearance->reach > 0) {
        int32_t length = clearance->pause_length == 0 ? 2 : 2 * clearance->pause_length;
        clearance->pause_length = clearance->uses >= WORTH_USES ? 0 : length < PAUSE_LIMIT ? length : PAUSE_LIMIT;
        clearance->pause = clearance->pause_length;
        clearance->reach = 0;
    }
    clearance->pause -= clearance->pause > 0;
    return clearance->pause == 0;
}

bool pel_clearance_renew(pel_clearance *clearance, pel_candidates *candidates, const double (*start)[3],
                         const double (*end)[3], double needed, double margin, pel_pool *pool)
{
    if (!is_worth_it(clearance, start, end, margin, pool))
        return false;
    double reach = needed * (1 + 2 * SLACK) + margin;
    clearance->uses = 0;
    if (pel_candidates_near(candidates, start, reach, pool, &clearance->vertex_face, &clearance->edge_edge, NULL) !=
        PEL_OK)
        return false;
    memcpy(clearance->positions, start, (size_t)clearance->point_count * sizeof *start);
    clearance->reach = reach;
    measure_all(clearance, candidates->tree, pool);
    return true;
}

void pel_clearance_settle(pel_clearance *clearance, const pel_tree *tree, const double (*start)[3],
                          const double (*end)[3], double needed, pel_pool *pool)
{
    motion_job step = {.from = start, .to = {end}, .point_count = clearance->point_count, .target_count = 1};
    motion_job gone = {.from = (const double(*)[3])clearance->positions,
                       .to = {start},
                       .point_count = clearance->point_count,
                       .target_count = 1};
    double way = longest_approach(&gone, pool);
    if (!(way > SETTLE_SHARE * clearance->nearest))
        return;
    double reach = room_of(clearance->reach, way), own = longest_approach(&step, pool);
    if (!(WORTH_STEPS * own < way) || !(own < room_of(reach, needed)))
        return;
    memcpy(clearance->positions, start, (size_t)clearance->point_count * sizeof *start);
    clearance->reach = reach;
    measure_all(clearance, tree, pool);
}

/* of what the known pairs reach beyond what is needed; and how many steps like this one they have to serve */
#define INNER_SHARE 0.125
enum { INNER_STEPS = 8 };

static bool reserve_list(const pel_pair_list *from, pel_pair_list *to)
{
    return pel_reserve((void **)&to->pairs, &to->capacity, from->capacity, sizeof *to->pairs);
}

bool pel_clearance_reserve(pel_clearance *inner, const pel_clearance *outer)
{
    return reserve_list(&outer->vertex_face, &inner->vertex_face) && reserve_list(&outer->edge_edge, &inner->edge_edge);
}

static bool copy_list(const pel_pair_list *from, pel_pair_list *to)
{
    to->count = 0;
    if (!reserve_list(from, to))
        return false;
    if (from->count > 0)
        memcpy(to->pairs, from->pairs, from->count * sizeof *to->pairs);
    to->count = from->count;
    return true;
}

bool pel_clearance_narrow(pel_clearance *inner, const pel_clearance *outer, const pel_tree *tree,
                          const double (*start)[3], const double (*end)[3], double needed, pel_pool *pool)
{
    motion_job step = {.from = start, .to = {end}, .point_count = outer->point_count, .target_count = 1};
    motion_job gone = {.from = (const double(*)[3])outer->positions,
                       .to = {start},
                       .point_count = outer->point_count,
                       .target_count = 1};
    double most = room_of(outer->reach, longest_approach(&gone, pool));
    double reach = pel_min(needed * (1 + 2 * SLACK) + INNER_SHARE * (outer->reach - needed), most);
    inner->reach = 0;
    if (!(INNER_STEPS * longest_approach(&step, pool) < room_of(reach, needed)) ||
        !copy_list(&outer->vertex_face, &inner->vertex_face) || !copy_list(&outer->edge_edge, &inner->edge_edge))
        return false;
    memcpy(inner->positions, start, (size_t)inner->point_count * sizeof *start);
    inner->reach = reach;
    inner->uses = 0;
    measure_all(inner, tree, pool);
    return true;
}

/* ---- memory ---- */

void pel_clearance_memory(pel_clearance *clearance, pel_memory_part parts[PEL_CLEARANCE_PARTS])
{
    const pel_memory_part all[PEL_CLEARANCE_PARTS] = {
        {&clearance->reach, sizeof clearance->reach},
        {&clearance->uses, sizeof clearance->uses},
        {&clearance->pause, sizeof clearance->pause},
        {&clearance->pause_length, sizeof clearance->pause_length},
        {clearance->positions, (size_t)clearance->point_count * sizeof *clearance->positions},
    };
    memcpy(parts, all, sizeof all);
}

pel_status pel_clearance_recall(pel_clearance *clearance, pel_candidates *candidates, pel_pool *pool, pel_error *error)
{
    double reach = clearance->reach;
    clearance->reach = 0;
    if (!(reach >= 0 && isfinite(reach)) || clearance->uses < 0 || clearance->uses > INT32_MAX / 2 ||
        clearance->pause < 0 || clearance->pause > PAUSE_LIMIT || clearance->pause_length < 0 ||
        clearance->pause_length > PAUSE_LIMIT)
        return pel_fail(error, PEL_BAD_FORMAT, "the memory of the search for pairs is damaged");
    if (!(reach > 0))
        return PEL_OK;
    pel_status status = pel_candidates_near(candidates, (const double(*)[3])clearance->positions, reach, pool,
                                            &clearance->vertex_face, &clearance->edge_edge, error);
    if (status == PEL_OK) {
        clearance->reach = reach;
        measure_all(clearance, candidates->tree, pool);
    }
    return status;
}
