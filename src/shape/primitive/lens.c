/* The human lens after Burd, Judge and Cross 2002, "Numerical modelling of the accommodating lens", Vision Research 42:
   each side of the outline is z = a r^5 + b r^4 + c r^3 + d r^2 + f (mm). The two sides meet in a kink; its last 0.3 mm
   (in r, on the front) are replaced by the circular arc that touches both sides:

            front              the centre lies on the normals of both sides, at the same distance from both;
       ------___               one unknown, the radius at which the arc leaves the back, found by bisection
                ''\.
                    )  arc
          ___----'/'
       ---  back

   Thickness of the capsule: 13 um at the front pole, 25 um at r = 3 mm on the front, 3 um at the back pole, between
   them smoothly along the outline. */
#include "primitive/lens.h"

#include "math/extremes.h"
#include "math/functions.h"

#include <math.h>
#include <string.h>

static const struct {
    int32_t age;
    double front[5], back[5];
} outlines[] = {
    {11,
     {-0.00153004454939, 0.01191111565048, -0.02032562095557, -0.07692307692308, 2.04},
     {0.00375558685672, -0.03036516318799, 0.06955483582257, 0.09433962264151, -2.09}},
    {29,
     {-0.00048433393427, 0.00528772036011, -0.01383693844808, -0.07352941176471, 2.18},
     {0.00300182571400, -0.02576464843559, 0.06916082660799, 0.08928571428571, -2.13}},
    {45,
     {-0.00026524088453, 0.00449862869630, -0.01657250977510, -0.06578947368424, 2.42},
     {0.00266482873720, -0.02666997217562, 0.08467905191557, 0.06172839506173, -2.42}},
};

static const double arc_reach = 0.3;                        /* mm */
static const double thickest_radius = 3;                    /* mm */
static const double thickness_at[3] = {13e-6, 25e-6, 3e-6}; /* m: front pole, thickest_radius, back pole */

static double height(const double c[5], double r)
{
    return (((c[0] * r + c[1]) * r + c[2]) * r + c[3]) * r * r + c[4];
}

static double slope(const double c[5], double r)
{
    return (((5 * c[0] * r + 4 * c[1]) * r + 3 * c[2]) * r + 2 * c[3]) * r;
}

/* where the two sides meet */
static double meeting_radius(const double front[5], const double back[5])
{
    double low = 4, high = 5;
    for (int i = 0; i < 60; i++) {
        double r = (low + high) / 2;
        if (height(front, r) > height(back, r))
            low = r;
        else
            high = r;
    }
    return low;
}

/* distances from the crossing of the two inward normals, at radius p of the front and q of the back, to their feet */
static void normal_lengths(const double front[5], double p, const double back[5], double q, double *from_front,
                           double *from_back)
{
    double m = slope(front, p), n = slope(back, q);
    double front_scale = sqrt(1 + m * m), back_scale = sqrt(1 + n * n);
    /* inward normals: (m, -1) / front_scale at the front, (-n, 1) / back_scale at the back */
    double dr = q - p, dz = height(back, q) - height(front, p);
    /* (p, front) + u (m, -1) = (q, back) + w (-n, 1) */
    double determinant = m - n;
    double u = (dr + n * dz) / determinant;
    double w = -(dz * m + dr) / determinant;
    *from_front = u * front_scale;
    *from_back = w * back_scale;
}

static void fit_arc(pel_lens_outline *outline)
{
    const double *front = outline->front.coefficients, *back = outline->back.coefficients;
    double meeting = meeting_radius(front, back);
    double p = meeting - arc_reach, low = meeting - 2 * arc_reach, high = meeting, from_front, from_back;
    for (int i = 0; i < 60; i++) {
        double q = (low + high) / 2;
        normal_lengths(front, p, back, q, &from_front, &from_back);
        if (from_front > from_back)
            low = q;
        else
            high = q;
    }
    normal_lengths(front, p, back, low, &from_front, &from_back);
    double m = slope(front, p), n = slope(back, low);
    outline->front.end = p;
    outline->back.end = low;
    outline->arc_radius = from_front;
    outline->arc_centre[0] = p + from_front * m / sqrt(1 + m * m);
    outline->arc_centre[1] = height(front, p) - from_front / sqrt(1 + m * m);
    outline->arc_begin = pel_atan2(1, -m);
    outline->arc_end = pel_atan2(-1, n);
}

/* length of the curve between two radii: Gauss-Legendre, five points */
static double curve_length(const double c[5], double from, double to)
{
    static const double nodes[5] = {-0.9061798459386640, -0.5384693101056831, 0, 0.5384693101056831,
                                    0.9061798459386640};
    static const double weights[5] = {0.2369268850561891, 0.4786286704993665, 0.5688888888888889, 0.4786286704993665,
                                      0.2369268850561891};
    double middle = (from + to) / 2, half = (to - from) / 2, sum = 0;
    for (int i = 0; i < 5; i++) {
        double s = slope(c, middle + half * nodes[i]);
        sum += weights[i] * sqrt(1 + s * s);
    }
    return half * sum;
}

static void tabulate(pel_lens_profile *profile)
{
    double step = profile->end / PEL_LENS_PANELS;
    for (int i = 0; i < PEL_LENS_PANELS; i++)
        profile->length[i + 1] = profile->length[i] + curve_length(profile->coefficients, step * i, step * (i + 1));
}

static double length_to_radius(const pel_lens_profile *profile, double r)
{
    double step = profile->end / PEL_LENS_PANELS;
    int panel = (int)(r / step);
    if (panel >= PEL_LENS_PANELS)
        panel = PEL_LENS_PANELS - 1;
    return profile->length[panel] + curve_length(profile->coefficients, step * panel, r);
}

/* radius at a length from the axis: Newton's method, the length is a smooth convex function of r */
static double radius_at_length(const pel_lens_profile *profile, double length)
{
    double r = profile->end * length / profile->length[PEL_LENS_PANELS];
    for (int i = 0; i < 8; i++) {
        double s = slope(profile->coefficients, r);
        r -= (length_to_radius(profile, r) - length) / sqrt(1 + s * s);
        r = pel_min(pel_max(r, 0), profile->end);
    }
    return r;
}

bool pel_lens_outline_of_age(int32_t age, pel_lens_outline *outline)
{
    memset(outline, 0, sizeof *outline);
    for (size_t i = 0; i < sizeof outlines / sizeof *outlines; i++) {
        if (outlines[i].age != age)
            continue;
        memcpy(outline->front.coefficients, outlines[i].front, sizeof outlines[i].front);
        memcpy(outline->back.coefficients, outlines[i].back, sizeof outlines[i].back);
        fit_arc(outline);
        tabulate(&outline->front);
        tabulate(&outline->back);
        double front = outline->front.length[PEL_LENS_PANELS], back = outline->back.length[PEL_LENS_PANELS];
        outline->length_to_equator = front + outline->arc_radius * outline->arc_begin;
        outline->length = outline->length_to_equator - outline->arc_radius * outline->arc_end + back;
        return true;
    }
    return false;
}

void pel_lens_outline_point(const pel_lens_outline *outline, double along, double *r, double *z)
{
    double front = outline->front.length[PEL_LENS_PANELS], back = outline->back.length[PEL_LENS_PANELS];
    if (along <= front) {
        *r = radius_at_length(&outline->front, along);
        *z = height(outline->front.coefficients, *r);
    } else if (along >= outline->length - back) {
        *r = radius_at_length(&outline->back, outline->length - along);
        *z = height(outline->back.coefficients, *r);
    } else {
        double angle = (outline->length_to_equator - along) / outline->arc_radius;
        *r = outline->arc_centre[0] + outline->arc_radius * pel_cos(angle);
        *z = outline->arc_centre[1] + outline->arc_radius * pel_sin(angle);
    }
}

double pel_lens_outline_front_length(const pel_lens_outline *outline, double r)
{
    return length_to_radius(&outline->front, r);
}

/* from a to b as t goes from 0 to 1, level at both ends */
static double ease(double a, double b, double t)
{
    return a + (b - a) * t * t * (3 - 2 * t);
}

double pel_lens_thickness(const pel_lens_outline *outline, double along)
{
    double thickest = length_to_radius(&outline->front, thickest_radius);
    if (along <= thickest)
        return ease(thickness_at[0], thickness_at[1], along / thickest);
    return ease(thickness_at[1], thickness_at[2], (along - thickest) / (outline->length - thickest));
}
