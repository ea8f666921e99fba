/* Outline of the human eye lens: half of the section through the axis, from the front pole to the back pole. */
#ifndef PEL_PRIMITIVE_LENS_H
#define PEL_PRIMITIVE_LENS_H

#include <stdbool.h>
#include <stdint.h>

enum { PEL_LENS_PANELS = 32 };

/* One polynomial profile z(r) with the length of its curve from r = 0, tabulated at equal steps of r. */
typedef struct pel_lens_profile {
    double coefficients[5];             /* of r^5, r^4, r^3, r^2, 1 */
    double end;                         /* mm, radius where the equatorial arc begins */
    double length[PEL_LENS_PANELS + 1]; /* mm, at r = end i / PEL_LENS_PANELS */
} pel_lens_profile;

/* All lengths in mm, heights along the axis, front positive. */
typedef struct pel_lens_outline {
    pel_lens_profile front, back;
    double arc_centre[2]; /* r, z */
    double arc_radius;
    double arc_begin, arc_end; /* angle of the arc's normal above the equatorial plane at its front and back end */
    double length_to_equator;  /* along the outline from the front pole */
    double length;             /* to the back pole */
} pel_lens_outline;

/* False when there is no outline for that age [years]. */
bool pel_lens_outline_of_age(int32_t age, pel_lens_outline *outline);

/* The point (r, z) at a length along the outline, 0 .. outline->length. */
void pel_lens_outline_point(const pel_lens_outline *outline, double along, double *r, double *z);

/* Length along the outline from the front pole to radius r of the front profile, 0 <= r <= front.end. */
double pel_lens_outline_front_length(const pel_lens_outline *outline, double r);

/* Capsule thickness [m] at a length along the outline (see shape.h). */
double pel_lens_thickness(const pel_lens_outline *outline, double along);

#endif
