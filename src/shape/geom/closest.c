/* Closest points by candidates: the minimum of a convex quadratic over a triangle or a square lies at its stationary
   point when that is inside, and on one of the sides otherwise. Where the stationary point is ill-conditioned (a thin
   triangle, nearly parallel segments) the sides are tried as well and the nearest candidate is kept, so that rounding
   in the stationary point can never give an answer worse than the best point of the boundary. */
#include "pellicle/geometry.h"

#include <math.h>
#include <string.h>

#include "math/vec3.h"

/* below this ratio to its largest possible value a determinant is not trusted alone */
#define ILL_CONDITIONED 1e-6

static double squared_length(const double a[3])
{
    return pel_vec3_dot(a, a);
}

static double clamp01(double x)
{
    /* NaN becomes 0 */
    return x > 0 ? (x < 1 ? x : 1) : 0;
}

/* squared distance of the points (1-s) a + s b and (1-t) c + t d, formed from differences */
static double between(const double a[3], const double b[3], double s, const double c[3], const double d[3], double t)
{
    double ab[3], cd[3], ca[3], p[3], q[3];
    pel_vec3_subtract(b, a, ab);
    pel_vec3_subtract(d, c, cd);
    pel_vec3_subtract(a, c, ca);
    pel_vec3_along(ca, s, ab, p);
    pel_vec3_along(p, -t, cd, q);
    return squared_length(q);
}

/* in line where it is asked for several ends or sides */
static inline double closest_on_segment(const double p[3], const double a[3], const double b[3], double weights[2])
{
    double ab[3], ap[3], bp[3], q[3];
    pel_vec3_subtract(b, a, ab);
    pel_vec3_subtract(p, a, ap);
    double length2 = squared_length(ab);
    double from_a = length2 > 0 ? pel_vec3_dot(ap, ab) / length2 : 0;
    if (from_a > 0.5) {
        /* from the nearer end: a short distance must not drown in the rounding of a long one */
        pel_vec3_subtract(p, b, bp);
        double from_b = clamp01(-pel_vec3_dot(bp, ab) / length2);
        weights[0] = from_b;
        weights[1] = 1 - from_b;
        pel_vec3_along(bp, from_b, ab, q);
        return squared_length(q);
    }
    from_a = clamp01(from_a);
    weights[0] = 1 - from_a;
    weights[1] = from_a;
    pel_vec3_along(ap, -from_a, ab, q);
    return squared_length(q);
}

double pel_closest_point_segment(const double p[3], const double a[3], const double b[3], double weights[2])
{
    return closest_on_segment(p, a, b, weights);
}

/* nearest point of the three sides; weights (3) */
static double closest_side(const double p[3], const double *const corners[3], double weights[3])
{
    double best = HUGE_VAL, nearest[2] = {1, 0};
    int side = 0;
    for (int i = 0; i < 3; i++) {
        double own[2];
        double distance2 = closest_on_segment(p, corners[i], corners[(i + 1) % 3], own);
        if (distance2 < best) {
            best = distance2;
            side = i;
            memcpy(nearest, own, sizeof nearest);
        }
    }
    weights[side] = nearest[0];
    weights[(side + 1) % 3] = nearest[1];
    weights[(side + 2) % 3] = 0;
    return best;
}

/* foot of the perpendicular when it lies inside the triangle; ratio = (2 area)^2 / product of two squared edges */
static bool foot_inside(const double p[3], const double a[3], const double b[3], const double c[3], double weights[3],
                        double *distance2, double *ratio)
{
    double ab[3], ac[3], ap[3], n[3], m[3];
    pel_vec3_subtract(b, a, ab);
    pel_vec3_subtract(c, a, ac);
    pel_vec3_subtract(p, a, ap);
    pel_vec3_cross(ab, ac, n);
    double n2 = squared_length(n), edges2 = squared_length(ab) * squared_length(ac);
    if (!(n2 > 0))
        return false;
    pel_vec3_cross(ap, ac, m);
    double wb = pel_vec3_dot(m, n) / n2;
    pel_vec3_cross(ab, ap, m);
    double wc = pel_vec3_dot(m, n) / n2;
    if (!(wb >= 0 && wc >= 0 && wb + wc <= 1))
        return false;
    weights[0] = 1 - (wb + wc);
    weights[1] = wb;
    weights[2] = wc;
    double q[3], r[3];
    pel_vec3_along(ap, -wb, ab, q);
    pel_vec3_along(q, -wc, ac, r);
    *distance2 = squared_length(r);
    *ratio = n2 / edges2;
    return true;
}

double pel_closest_point_triangle(const double p[3], const double a[3], const double b[3], const double c[3],
                                  double weights[3])
{
    double inside2 = HUGE_VAL, ratio = 0, inside[3];
    bool found = foot_inside(p, a, b, c, inside, &inside2, &ratio);
    if (found && ratio > ILL_CONDITIONED) {
        memcpy(weights, inside, sizeof inside);
        return inside2;
    }
    const double *corners[3] = {a, b, c};
    double side2 = closest_side(p, corners, weights);
    if (!found || !(inside2 < side2))
        return side2;
    memcpy(weights, inside, sizeof inside);
    return inside2;
}

/* stationary point of the distance of two lines when inside both segments; ratio = sin^2 of their angle */
static bool lines_inside(const double a[3], const double b[3], const double c[3], const double d[3], double *s,
                         double *t, double *ratio)
{
    double ab[3], cd[3], ac[3], n[3], m[3];
    pel_vec3_subtract(b, a, ab);
    pel_vec3_subtract(d, c, cd);
    pel_vec3_subtract(c, a, ac);
    pel_vec3_cross(ab, cd, n);
    double n2 = squared_length(n);
    if (!(n2 > 0))
        return false;
    pel_vec3_cross(ac, cd, m);
    *s = pel_vec3_dot(m, n) / n2;
    pel_vec3_cross(ac, ab, m);
    *t = pel_vec3_dot(m, n) / n2;
    *ratio = n2 / (squared_length(ab) * squared_length(cd));
    return *s >= 0 && *s <= 1 && *t >= 0 && *t <= 1;
}

/* nearest pair with at least one end point in it; weights (4) */
static double closest_ends(const double *const ends[4], double weights[4])
{
    static const int point[4] = {0, 1, 2, 3}, from[4] = {2, 2, 0, 0};
    double best = HUGE_VAL, nearest[2] = {1, 0};
    int end = 0;
    for (int i = 0; i < 4; i++) {
        double own[2];
        double distance2 = closest_on_segment(ends[point[i]], ends[from[i]], ends[from[i] + 1], own);
        if (distance2 < best) {
            best = distance2;
            end = i;
            memcpy(nearest, own, sizeof nearest);
        }
    }
    memset(weights, 0, 4 * sizeof *weights);
    weights[point[end]] = 1;
    weights[from[end]] = nearest[0];
    weights[from[end] + 1] = nearest[1];
    return best;
}

double pel_closest_segment_segment(const double a[3], const double b[3], const double c[3], const double d[3],
                                   double weights[4])
{
    const double *ends[4] = {a, b, c, d};
    double s, t, ratio;
    if (!lines_inside(a, b, c, d, &s, &t, &ratio))
        return closest_ends(ends, weights);
    double inside2 = between(a, b, s, c, d, t);
    if (!(ratio > ILL_CONDITIONED)) {
        double end2 = closest_ends(ends, weights);
        if (!(inside2 < end2))
            return end2;
    }
    weights[0] = 1 - s;
    weights[1] = s;
    weights[2] = 1 - t;
    weights[3] = t;
    return inside2;
}

/* point where the segment pierces the triangle; weights (5) */
static bool crossing(const double a[3], const double b[3], const double *const corners[3], double weights[5],
                     double *distance2)
{
    double ab[3], e1[3], e2[3], ca[3], n[3], m[3];
    pel_vec3_subtract(b, a, ab);
    pel_vec3_subtract(corners[1], corners[0], e1);
    pel_vec3_subtract(corners[2], corners[0], e2);
    pel_vec3_subtract(a, corners[0], ca);
    pel_vec3_cross(e1, e2, n);
    double determinant = pel_vec3_dot(n, ab);
    if (determinant == 0)
        return false;
    double s = -pel_vec3_dot(n, ca) / determinant;
    pel_vec3_cross(ca, ab, m);
    double w1 = -pel_vec3_dot(m, e2) / determinant, w2 = pel_vec3_dot(m, e1) / determinant;
    if (!(s >= 0 && s <= 1 && w1 >= 0 && w2 >= 0 && w1 + w2 <= 1))
        return false;
    weights[0] = 1 - s;
    weights[1] = s;
    weights[2] = 1 - (w1 + w2);
    weights[3] = w1;
    weights[4] = w2;
    double p[3], q[3];
    pel_vec3_along(ca, s, ab, p);
    pel_vec3_along(p, -w1, e1, q);
    pel_vec3_along(q, -w2, e2, p);
    *distance2 = squared_length(p);
    return true;
}

double pel_closest_segment_triangle(const double a[3], const double b[3], const double c0[3], const double c1[3],
                                    const double c2[3], double weights[5])
{
    const double *corners[3] = {c0, c1, c2};
    double through[5], best = HUGE_VAL, distance2;
    memset(weights, 0, 5 * sizeof *weights);
    weights[0] = weights[2] = 1;
    if (crossing(a, b, corners, through, &distance2)) {
        memcpy(weights, through, sizeof through);
        best = distance2;
    }
    for (int end = 0; end < 2; end++) {
        double inside[3];
        distance2 = pel_closest_point_triangle(end ? b : a, c0, c1, c2, inside);
        if (distance2 < best) {
            best = distance2;
            weights[0] = end ? 0 : 1;
            weights[1] = end ? 1 : 0;
            memcpy(weights + 2, inside, sizeof inside);
        }
    }
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3;
        double sides[4];
        distance2 = pel_closest_segment_segment(a, b, corners[i], corners[j], sides);
        if (distance2 < best) {
            best = distance2;
            memcpy(weights, sides, 2 * sizeof *weights);
            memset(weights + 2, 0, 3 * sizeof *weights);
            weights[2 + i] = sides[2];
            weights[2 + j] = sides[3];
        }
    }
    return best;
}
