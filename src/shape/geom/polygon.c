#include "geom/polygon.h"

#include <stdbool.h>
#include <stddef.h>
#include <string.h>

enum { EAR_LIMIT = 64 };

typedef struct outline {
    const double (*positions)[3];
    double normal[3]; /* of the whole polygon, times twice its area */
} outline;

/* twice the area of triangle abc as seen along the normal of the polygon, negative when turned over */
static double signed_area(const outline *polygon, int32_t a, int32_t b, int32_t c)
{
    const double *p = polygon->positions[a], *q = polygon->positions[b], *r = polygon->positions[c];
    double u[3], v[3];
    for (int i = 0; i < 3; i++) {
        u[i] = q[i] - p[i];
        v[i] = r[i] - p[i];
    }
    return polygon->normal[0] * (u[1] * v[2] - u[2] * v[1]) + polygon->normal[1] * (u[2] * v[0] - u[0] * v[2]) +
           polygon->normal[2] * (u[0] * v[1] - u[1] * v[0]);
}

/* Newell's normal: the sum of the cross products of a fan, which no choice of the first corner changes */
static void find_normal(outline *polygon, const int32_t *corners, int32_t count)
{
    memset(polygon->normal, 0, sizeof polygon->normal);
    const double *origin = polygon->positions[corners[0]];
    for (int32_t i = 1; i + 1 < count; i++) {
        const double *q = polygon->positions[corners[i]], *r = polygon->positions[corners[i + 1]];
        for (int k = 0; k < 3; k++) {
            int l = (k + 1) % 3, m = (k + 2) % 3;
            polygon->normal[k] += (q[l] - origin[l]) * (r[m] - origin[m]) - (q[m] - origin[m]) * (r[l] - origin[l]);
        }
    }
}

static void cut_fan(const int32_t *corners, int32_t count, int32_t (*triangles)[3])
{
    for (int32_t i = 0; i + 2 < count; i++) {
        triangles[i][0] = corners[0];
        triangles[i][1] = corners[i + 1];
        triangles[i][2] = corners[i + 2];
    }
}

static bool fan_fits(const outline *polygon, const int32_t *corners, int32_t count)
{
    for (int32_t i = 1; i + 1 < count; i++)
        if (!(signed_area(polygon, corners[0], corners[i], corners[i + 1]) > 0))
            return false;
    return true;
}

/* true when corner `at` can be cut off: it is convex and no other corner lies in its triangle */
static bool is_ear(const outline *polygon, const int32_t *corners, int32_t count, int32_t at)
{
    int32_t a = corners[(at + count - 1) % count], b = corners[at], c = corners[(at + 1) % count];
    if (!(signed_area(polygon, a, b, c) > 0))
        return false;
    for (int32_t i = 0; i < count; i++) {
        int32_t p = corners[i];
        if (p != a && p != b && p != c && signed_area(polygon, a, b, p) >= 0 && signed_area(polygon, b, c, p) >= 0 &&
            signed_area(polygon, c, a, p) >= 0)
            return false;
    }
    return true;
}

/* cuts ears off; a remainder without ears (of a polygon that crosses itself) becomes a fan */
static void cut_ears(const outline *polygon, const int32_t *corners, int32_t count, int32_t (*triangles)[3])
{
    int32_t left[EAR_LIMIT];
    memcpy(left, corners, (size_t)count * sizeof *left);
    while (count > 3) {
        int32_t ear = 0;
        while (ear < count && !is_ear(polygon, left, count, ear))
            ear++;
        if (ear == count)
            break;
        int32_t *triangle = *triangles++;
        triangle[0] = left[(ear + count - 1) % count];
        triangle[1] = left[ear];
        triangle[2] = left[(ear + 1) % count];
        count--;
        memmove(left + ear, left + ear + 1, (size_t)(count - ear) * sizeof *left);
    }
    cut_fan(left, count, triangles);
}

void pel_polygon_cut(const double (*positions)[3], const int32_t *corners, int32_t count, int32_t (*triangles)[3])
{
    outline polygon = {.positions = positions};
    if (count > 3 && count <= EAR_LIMIT) {
        find_normal(&polygon, corners, count);
        if (!fan_fits(&polygon, corners, count)) {
            cut_ears(&polygon, corners, count, triangles);
            return;
        }
    }
    cut_fan(corners, count, triangles);
}
