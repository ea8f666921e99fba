#include "bvh/ray.h"

#include "math/extremes.h"

#include <math.h>

enum { DEPTH_LIMIT = 128 };

/* boxes are of floats: examine boxes that a ray misses by less than this share of the coordinates */
#define SLACK 1e-6

/* ---- triangle ---- */

/* the ray along z: axes so that its direction is largest along the third, then sheared */
static void look_along(const pel_ray *ray, const double point[3], int axis, double seen[3])
{
    const double *d = ray->direction;
    int x = (axis + 1) % 3, y = (axis + 2) % 3;
    double depth = point[axis] - ray->origin[axis];
    seen[0] = point[x] - ray->origin[x] - d[x] / d[axis] * depth;
    seen[1] = point[y] - ray->origin[y] - d[y] / d[axis] * depth;
    seen[2] = depth / d[axis];
}

static int largest_axis(const double d[3])
{
    int axis = 0;
    for (int k = 1; k < 3; k++)
        if (fabs(d[k]) > fabs(d[axis]))
            axis = k;
    return axis;
}

bool pel_ray_triangle(const pel_ray *ray, const double a[3], const double b[3], const double c[3], pel_ray_hit *hit)
{
    int axis = largest_axis(ray->direction);
    double p[3], q[3], r[3];
    look_along(ray, a, axis, p);
    look_along(ray, b, axis, q);
    look_along(ray, c, axis, r);
    /* the same two products for both triangles at an edge: no ray slips through */
    double u = r[0] * q[1] - r[1] * q[0], v = p[0] * r[1] - p[1] * r[0], w = q[0] * p[1] - q[1] * p[0];
    bool is_inside = (u >= 0 && v >= 0 && w >= 0) || (u <= 0 && v <= 0 && w <= 0);
    double sum = u + v + w;
    if (!is_inside || sum == 0)
        return false;
    hit->weights[0] = u / sum;
    hit->weights[1] = v / sum;
    hit->weights[2] = w / sum;
    hit->distance = hit->weights[0] * p[2] + hit->weights[1] * q[2] + hit->weights[2] * r[2];
    return hit->distance >= 0;
}

/* ---- tree ---- */

typedef struct cast {
    const pel_tree *tree;
    const double (*positions)[3];
    const pel_ray *ray;
    double origin[3]; /* less the center of the boxes */
    pel_ray_hit nearest;
} cast;

/* where the ray enters a box, infinite where it misses it or enters behind the nearest hit */
static double entry(const cast *c, const pel_box *box)
{
    double from = 0, to = c->nearest.distance;
    for (int k = 0; k < 3; k++) {
        double low = (double)box->low[k], high = (double)box->high[k], d = c->ray->direction[k];
        double slack = SLACK * (fabs(low) + fabs(high) + fabs(c->origin[k]));
        low -= slack + c->origin[k];
        high += slack - c->origin[k];
        if (d == 0 && (low > 0 || high < 0))
            return HUGE_VAL;
        if (d == 0)
            continue;
        from = pel_max(from, (d > 0 ? low : high) / d);
        to = pel_min(to, (d > 0 ? high : low) / d);
    }
    return from <= to ? from : HUGE_VAL;
}

static void meet_leaf(cast *c, int32_t leaf)
{
    const int32_t *triangles = c->tree->leaves[leaf];
    for (int lane = 0; lane < PEL_LANES && triangles[lane] >= 0; lane++) {
        int32_t t = triangles[lane];
        const int32_t *v = c->tree->triangles[t];
        pel_ray_hit hit = {.triangle = t};
        if (!pel_ray_triangle(c->ray, c->positions[v[0]], c->positions[v[1]], c->positions[v[2]], &hit))
            continue;
        if (hit.distance < c->nearest.distance ||
            (hit.distance == c->nearest.distance && (c->nearest.triangle < 0 || t < c->nearest.triangle)))
            c->nearest = hit;
    }
}

/* a node over leaves begin .. end */
typedef struct subtree {
    int32_t node, begin, end;
} subtree;

pel_ray_hit pel_tree_cast(const pel_tree *tree, const double (*positions)[3], const double center[3],
                          const pel_ray *ray)
{
    cast c = {.tree = tree, .positions = positions, .ray = ray, .nearest = {.triangle = -1, .distance = HUGE_VAL}};
    for (int k = 0; k < 3; k++)
        c.origin[k] = ray->origin[k] - center[k];
    subtree stack[DEPTH_LIMIT];
    int depth = 0;
    stack[depth++] = (subtree){0, 0, tree->leaf_count};
    while (depth > 0) {
        subtree s = stack[--depth];
        if (entry(&c, &tree->nodes[s.node]) == HUGE_VAL)
            continue;
        if (s.end - s.begin == 1) {
            meet_leaf(&c, s.begin);
            continue;
        }
        int32_t middle = pel_tree_middle(s.begin, s.end);
        subtree left = {s.node + 1, s.begin, middle};
        subtree right = {s.node + 2 * (middle - s.begin), middle, s.end};
        bool left_first = entry(&c, &tree->nodes[left.node]) <= entry(&c, &tree->nodes[right.node]);
        stack[depth++] = left_first ? right : left;
        stack[depth++] = left_first ? left : right;
    }
    return c.nearest;
}
