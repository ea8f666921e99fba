/* The plain method of Bridson, Fedkiw and Anderson, "Robust treatment of collisions, contact and friction for cloth
   animation", 2002, as Sun et al. 2021 use it: the times at which the four points are coplanar are roots of a cubic; at
   each root, and at the end of the step, the features hit when they are closer than a tolerance. Roots are bracketed
   between the cubic's extrema and found by Newton's method with bisection as a guard. */
#include <string.h>

#include "geom/ccd.h"
#include "math/vec3.h"

static double cubic_value(const double a[4], double t)
{
    return ((a[3] * t + a[2]) * t + a[1]) * t + a[0];
}

/* root between low and high, where the cubic has different signs */
static double refine_root(const double a[4], double low, double high)
{
    double low_value = cubic_value(a, low), t = 0.5 * (low + high);
    for (int step = 0; step < 60 && high - low > 1e-15; step++) {
        double value = cubic_value(a, t), slope = (3 * a[3] * t + 2 * a[2]) * t + a[1];
        if (value == 0)
            return t;
        if ((value < 0) == (low_value < 0))
            low = t;
        else
            high = t;
        double next = t - value / slope;
        if (!(next > low && next < high))
            next = 0.5 * (low + high);
        if (fabs(next - t) < 1e-16)
            return next;
        t = next;
    }
    return t;
}

/* extrema of the cubic inside (0, 1), rising; returns how many */
static int find_extrema(const double a[4], double extrema[2])
{
    int count = 0;
    double quadratic = 3 * a[3], half = a[2], constant = a[1];
    double discriminant = half * half - quadratic * constant;
    if (!(discriminant >= 0))
        return 0;
    double q = -(half + (half < 0 ? -sqrt(discriminant) : sqrt(discriminant)));
    double roots[2] = {q / quadratic, constant / q};
    if (roots[0] > roots[1]) {
        double swapped = roots[0];
        roots[0] = roots[1];
        roots[1] = swapped;
    }
    for (int i = 0; i < 2; i++)
        if (roots[i] > 0 && roots[i] < 1)
            extrema[count++] = roots[i];
    return count;
}

/* times to look at, rising: roots, extrema (double roots) and the end of the step; returns how many */
static int find_times(const ccd_cubic *cubic, double times[6])
{
    const double *b = cubic->coefficient;
    const double a[4] = {b[0], 3 * (b[1] - b[0]), 3 * (b[2] - 2 * b[1] + b[0]), b[3] - 3 * (b[2] - b[1]) - b[0]};
    double knots[4] = {0, 1, 1, 1};
    int knot_count = 1 + find_extrema(a, knots + 1), count = 0;
    knots[knot_count] = 1;
    for (int i = 0; i < knot_count; i++) {
        double low = cubic_value(a, knots[i]), high = cubic_value(a, knots[i + 1]);
        if (i > 0)
            times[count++] = knots[i];
        if ((low < 0) != (high < 0))
            times[count++] = refine_root(a, knots[i], knots[i + 1]);
    }
    times[count++] = 1;
    return count;
}

bool ccd_solve_bridson(const ccd_points *points, bool edge_edge, double min_separation, double tolerance,
                       pel_ccd_hit *hit)
{
    ccd_query query;
    ccd_cubic cubic;
    double times[6], s, u, vector[3];
    if (!ccd_query_set(points, edge_edge, &(ccd_lengths){min_separation, tolerance, 0}, &query)) {
        ccd_hit_unknown(edge_edge, hit);
        return true;
    }
    double reach = query.min_separation + query.tolerance;
    ccd_pair_cubic(&query.pair, reach, &cubic);
    if (ccd_cubic_margin(cubic.coefficient, cubic.band) > 0)
        return false;
    int count = find_times(&cubic, times);
    for (int i = 0; i < count; i++) {
        ccd_closest(&query, times[i], &s, &u, vector);
        if (pel_vec3_dot(vector, vector) <= reach * reach) {
            ccd_hit_set(&query, times[i], hit);
            return true;
        }
    }
    return false;
}
