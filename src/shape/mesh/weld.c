#include "mesh/weld.h"

#include "base/memory.h"
#include "math/extremes.h"
#include "math/vec3.h"
#include "mesh/union_find.h"

#include <math.h>
#include <string.h>

/* equal numbers give equal hashes: -0 becomes 0 */
static uint64_t hash_point(const double point[3])
{
    uint64_t hash = 0x9e3779b97f4a7c15u;
    for (int i = 0; i < 3; i++) {
        double value = point[i] + 0.0;
        uint64_t bits;
        memcpy(&bits, &value, sizeof bits);
        hash = (hash ^ bits) * 0xff51afd7ed558ccdu;
        hash ^= hash >> 32;
    }
    return hash;
}

static bool equal_points(const double a[3], const double b[3])
{
    return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

/* a power of two, at least twice the count */
static size_t table_size(int32_t count)
{
    size_t size = 16;
    while (size < 2 * (size_t)count)
        size *= 2;
    return size;
}

/* first_of[i] = lowest point equal to point i; table (size) is zeroed and holds point + 1 */
static void find_equal(const double (*points)[3], int32_t count, int32_t *table, size_t size, int32_t *first_of)
{
    for (int32_t i = 0; i < count; i++) {
        first_of[i] = i;
        if (!equal_points(points[i], points[i]))
            continue; /* NaN */
        size_t slot = hash_point(points[i]) & (size - 1);
        while (table[slot] != 0 && !equal_points(points[table[slot] - 1], points[i]))
            slot = (slot + 1) & (size - 1);
        if (table[slot] == 0)
            table[slot] = i + 1;
        first_of[i] = table[slot] - 1;
    }
}

typedef struct grid {
    const double (*points)[3];
    double tolerance;
    int32_t *heads; /* (size) last point + 1 put into each bucket */
    int32_t *next;  /* (count) point + 1 before it */
    size_t size;
} grid;

static size_t bucket_of(const grid *cells, const double point[3], int dx, int dy, int dz)
{
    const double cell[3] = {floor(point[0] / cells->tolerance) + dx, floor(point[1] / cells->tolerance) + dy,
                            floor(point[2] / cells->tolerance) + dz};
    return hash_point(cell) & (cells->size - 1);
}

static void join_bucket(const grid *cells, size_t bucket, int32_t i, int32_t *first_of)
{
    for (int32_t j = cells->heads[bucket]; j > 0; j = cells->next[j - 1])
        if (pel_vec3_distance(cells->points[j - 1], cells->points[i]) <= cells->tolerance)
            pel_union_find_join(first_of, i, j - 1);
}

/* joins the first points of all places with those in the same and the 26 cells around */
static void join_near(const grid *cells, int32_t count, int32_t *first_of)
{
    for (int32_t i = 0; i < count; i++) {
        if (first_of[i] != i || !equal_points(cells->points[i], cells->points[i]))
            continue;
        for (int k = 0; k < 27; k++)
            join_bucket(cells, bucket_of(cells, cells->points[i], k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1), i, first_of);
        size_t own = bucket_of(cells, cells->points[i], 0, 0, 0);
        cells->next[i] = cells->heads[own];
        cells->heads[own] = i + 1;
    }
}

/* replaces the first point of each place by the number of the place; number_of (count): scratch */
static int32_t number_places(int32_t count, int32_t *first_of, int32_t *number_of)
{
    int32_t place_count = 0;
    for (int32_t i = 0; i < count; i++)
        first_of[i] = pel_union_find_root(first_of, i);
    for (int32_t i = 0; i < count; i++) {
        if (first_of[i] == i)
            number_of[i] = place_count++;
        first_of[i] = number_of[first_of[i]];
    }
    return place_count;
}

pel_status pel_weld_points(const double (*points)[3], int32_t count, double tolerance, int32_t *index_of,
                           int32_t *place_count)
{
    size_t size = table_size(count);
    int32_t *table = pel_allocate(size, sizeof *table);
    int32_t *next = tolerance > 0 ? pel_allocate((size_t)count, sizeof *next) : NULL;
    if (table == NULL || (tolerance > 0 && next == NULL)) {
        pel_free(table);
        pel_free(next);
        return PEL_OUT_OF_MEMORY;
    }
    find_equal(points, count, table, size, index_of);
    if (tolerance > 0) {
        memset(table, 0, size * sizeof *table);
        const grid cells = {points, tolerance, table, next, size};
        join_near(&cells, count, index_of);
    }
    *place_count = number_places(count, index_of, table);
    pel_free(table);
    pel_free(next);
    return PEL_OK;
}

bool pel_weld_tolerance_allowed(const double (*points)[3], int32_t count, double tolerance)
{
    double low[3] = {(double)HUGE_VAL, (double)HUGE_VAL, (double)HUGE_VAL},
           high[3] = {-(double)HUGE_VAL, -(double)HUGE_VAL, -(double)HUGE_VAL}, largest = 0;
    for (int32_t i = 0; i < count; i++) {
        for (int k = 0; k < 3; k++) {
            if (!isfinite(points[i][k]))
                continue;
            low[k] = pel_min(low[k], points[i][k]);
            high[k] = pel_max(high[k], points[i][k]);
            largest = pel_max(largest, fabs(points[i][k]));
        }
    }
    double diagonal = pel_vec3_distance(low, high);
    return tolerance == 0 || (tolerance >= 1e-14 * largest && tolerance <= diagonal / 20);
}
