#include "collide/clearance.h"

#include "base/memory.h"
#include "base/status.h"
#include "geom/wide4.h"
#include "math/vec3.h"

#include <math.h>
#include <string.h>

enum { PARTS = 64, WORTH_STEPS = 16, WORTH_USES = 8, PAUSE_LIMIT = 64 };

/* of lengths: more than the rounding of distances */
#define SLACK 1e-6

pel_status pel_clearance_create(int32_t point_count, pel_clearance *clearance, pel_error *error)
{
    *clearance = (pel_clearance){.point_count = point_count};
    clearance->positions = pel_allocate((size_t)point_count, sizeof *clearance->positions);
    return clearance->positions != NULL ? PEL_OK : pel_fail_memory(error);
}

void pel_clearance_clear(pel_clearance *clearance)
{
    pel_free(clearance->positions);
    pel_free(clearance->vertex_face.pairs);
    pel_free(clearance->edge_edge.pairs);
    *clearance = (pel_clearance){0};
}

/* ---- motion ---- */

/* boxes around the displacements of all points from one set of positions to one or two others */
typedef struct motion_job {
    const double (*from)[3], (*to[2])[3];
    int32_t point_count, target_count;
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

/* Four points are twelve numbers side by side: lane l of the j-th vector is coordinate (4 j + l) % 3. */
static void measure_target(motion_job *job, int32_t target, int32_t part)
{
    int64_t count = job->point_count, p = count * part / PARTS, end = count * (part + 1) / PARTS;
    const double(*from)[3] = job->from, (*to)[3] = job->to[target];
    double *low = job->low[target][part], *high = job->high[target][part], lost = 0;
    wide4 least[3], most[3], bad = wide4_set(0);
    for (int j = 0; j < 3; j++) {
        least[j] = wide4_set(HUGE_VAL);
        most[j] = wide4_set(-HUGE_VAL);
        low[j] = HUGE_VAL;
        high[j] = -HUGE_VAL;
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
    job->is_finite[target][part] = lost + (bad[0] + bad[1]) + (bad[2] + bad[3]) == 0;
}

static void measure_part(void *context, int32_t part)
{
    motion_job *job = context;
    for (int32_t target = 0; target < job->target_count; target++)
        measure_target(job, target, part);
}

static double approach_of(const motion_job *job, int32_t target)
{
    double square = 0;
    for (int k = 0; k < 3; k++) {
        double low = HUGE_VAL, high = -HUGE_VAL;
        for (int part = 0; part < PARTS; part++) {
            low = fmin(low, job->low[target][part][k]);
            high = fmax(high, job->high[target][part][k]);
            if (!job->is_finite[target][part])
                return HUGE_VAL;
        }
        square += high > low ? (high - low) * (high - low) : 0;
    }
    return sqrt(square);
}

/* Largest approach of any two points on the path to `to`, or to one of two; infinite if a displacement is not
   finite. */
static double longest_approach(const double (*from)[3], const double (*to)[3], const double (*other)[3],
                               int32_t point_count, pel_pool *pool)
{
    motion_job job = {.from = from, .to = {to, other}, .point_count = point_count, .target_count = other != to ? 2 : 1};
    pel_pool_run(pool, PARTS, measure_part, &job);
    double longest = approach_of(&job, 0);
    return other != to ? fmax(longest, approach_of(&job, 1)) : longest;
}

bool pel_clearance_serves(pel_clearance *clearance, const double (*start)[3], const double (*end)[3], double needed,
                          pel_pool *pool)
{
    double room = clearance->reach - needed * (1 + SLACK);
    if (!(room > 0))
        return false;
    const double(*from)[3] = (const double(*)[3])clearance->positions;
    bool serves = longest_approach(from, start, end, clearance->point_count, pool) < room;
    clearance->uses += serves;
    return serves;
}

/* ---- pairs ---- */

/* counts slow steps in which a try is put off, longer each time that the last one served few */
static bool is_worth_it(pel_clearance *clearance, const double (*start)[3], const double (*end)[3], double margin,
                        pel_pool *pool)
{
    if (!(margin > 0) || !(WORTH_STEPS * longest_approach(start, end, end, clearance->point_count, pool) < margin))
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
    if (status == PEL_OK)
        clearance->reach = reach;
    return status;
}
