/* Input and output of a membrane law, a function of the strain of a triangle alone: energy density psi, stress t = d
   psi / ds and tangent D = d2 psi / ds2 for the strain vector s = (e11, e22, 2 e12), in units of its shear modulus. It
   is written once over pel_lane (base/lane.h), without branches.

   An isotropic law needs no more than psi(tr C, J) and its derivatives by these two invariants. With C^-1 = adj C / J^2

       t = 2 psi_t I + psi_J J C^-1

   and in the principal axes of C, with the principal values C1 and C2, the tangent is a 2 x 2 block for the normal
   strains and a shear stiffness:

       D_ij  = 4 psi_tt + 2 psi_tJ J (1/Ci + 1/Cj) + (psi_JJ J^2 + psi_J J) / (Ci Cj) - 2 psi_J J / Ci^2 [i = j]
       D_33  = -psi_J J / J^2

   so that its positive semi-definite part is known in closed form. */
#ifndef PEL_LAW_STRAIN_H
#define PEL_LAW_STRAIN_H

#include "base/lane.h"
#include "law/membrane.h"

/* symmetric 2 x 2: components 11, 22, 12 (twice 12 for strains) */
typedef struct pel_symmetric2 {
    pel_lane a, b, c;
} pel_symmetric2;

/* symmetric 3 x 3 */
typedef struct pel_symmetric3 {
    pel_lane a11, a12, a13, a22, a23, a33;
} pel_symmetric3;

typedef struct pel_strain {
    pel_symmetric2 strain; /* s: the Green strain (C - I) / 2, or the strain of the triangle factor of F */
    pel_symmetric2 cauchy; /* C = F^T F */
    pel_lane area_ratio;   /* J = sqrt det C, from the area itself: exact for needles */
    pel_lane area_square;  /* J^2 */
} pel_strain;

/* Laws with PEL_LAW_COMPLIANT: t = I - c C^-1, and the tangent is positive definite with the inverse
   scale (C x C - part C (x) C), (C x C) t = C t C. */
typedef struct pel_compliance {
    pel_lane scale, part, c;
} pel_compliance;

typedef struct pel_response {
    pel_lane energy;
    pel_symmetric2 stress;            /* t: second Piola-Kirchhoff stress */
    pel_symmetric3 tangent, positive; /* D and its positive semi-definite part */
    pel_compliance compliance;
    pel_lane by_trace, by_area; /* laws of tr C and J: psi_t and psi_J, P = 2 psi_t F + psi_J dJ/dF */
} pel_response;

/* ---- invariants ---- */

#define PEL_LEAST_AREA_RATIO 0.01

/* Barriers are tangents below this J, and have no effect above 1000. */
typedef struct pel_area {
    pel_lane ratio, bounded; /* J, and J within these bounds */
    pel_lane excess;         /* bounded J^2 - 1 */
    pel_lane trace;          /* (tr C - 2) / 2 */
    pel_lane determinant;    /* of the Green strain */
    pel_lane_mask is_low;    /* J below its bound */
} pel_area;

PEL_INLINE pel_area pel_area_of(const pel_strain *s)
{
    const pel_lane one = pel_lane_splat(1), half = PEL_CONSTANT(0.5), two = pel_lane_splat(2), four = pel_lane_splat(4);
    pel_area area;
    area.ratio = s->area_ratio;
    area.bounded = pel_lane_min(pel_lane_max(area.ratio, PEL_CONSTANT(PEL_LEAST_AREA_RATIO)), pel_lane_splat(1000));
    area.is_low = pel_lane_above(area.bounded, area.ratio);
    area.trace = s->strain.a + s->strain.b;
    pel_lane shear = half * s->strain.c;
    area.determinant = s->strain.a * s->strain.b - shear * shear;
    /* from the strains it is exact near rest */
    pel_lane fine = two * area.trace + four * area.determinant;
    pel_lane coarse = (area.bounded - one) * (area.bounded + one);
    area.excess = pel_lane_select(pel_lane_above(PEL_CONSTANT(0.1), pel_lane_abs(coarse)), fine, coarse);
    return area;
}

/* the same for laws that read no J but J^2 */
typedef struct pel_square_area {
    pel_lane square, excess; /* J^2 within the bounds, and J^2 - 1 */
} pel_square_area;

PEL_INLINE pel_square_area pel_square_area_of(const pel_strain *s)
{
    const pel_lane one = pel_lane_splat(1), two = pel_lane_splat(2), half = PEL_CONSTANT(0.5);
    const pel_lane least = PEL_CONSTANT(PEL_LEAST_AREA_RATIO * PEL_LEAST_AREA_RATIO);
    pel_square_area area;
    area.square = pel_lane_min(pel_lane_max(s->area_square, least), PEL_CONSTANT(1e6));
    pel_lane shear = half * s->strain.c, determinant = s->strain.a * s->strain.b - shear * shear;
    pel_lane fine = two * (s->strain.a + s->strain.b) + pel_lane_splat(4) * determinant, coarse = area.square - one;
    area.excess = pel_lane_select(pel_lane_above(PEL_CONSTANT(0.1), pel_lane_abs(coarse)), fine, coarse);
    return area;
}

/* 1 / J^2 of an incompressible sheet, the square of its thickness stretch, and I1 - 3 and I2 - 3. Near rest they are
   written with J^2 - 1 and the Green strain instead of as differences of numbers near 3:
       I1 - 3 = (2 tr e (J^2 - 1) - 4 det e) / J^2,   I2 - 3 = ((J^2 - 1)^2 - 4 det e) / J^2 */
typedef struct pel_incompressible {
    pel_lane thickness, slope, curvature; /* h = 1 / J^2 and its derivatives by J */
    pel_lane i1, i2;
} pel_incompressible;

PEL_INLINE pel_incompressible pel_incompressible_of(const pel_area *area)
{
    const pel_lane one = pel_lane_splat(1), two = pel_lane_splat(2), three = pel_lane_splat(3);
    pel_incompressible v;
    pel_lane j = area->ratio, h = one / (area->bounded * area->bounded), twice = two * area->trace;
    pel_lane determinant4 = pel_lane_splat(4) * area->determinant;
    v.slope = -(two * h / area->bounded);
    v.curvature = pel_lane_splat(6) * h * h;
    v.i1 = h * (twice * area->excess - determinant4);
    v.i2 = h * (area->excess * area->excess - determinant4);
    v.thickness = h + v.slope * (j - area->bounded);
    pel_lane trace = twice + two;
    v.i1 = pel_lane_select(area->is_low, trace + v.thickness - three, v.i1);
    v.i2 = pel_lane_select(area->is_low, j * j + trace * v.thickness - three, v.i2);
    return v;
}

/* ---- isotropic laws ---- */

/* psi and its derivatives by tr C (t) and J (j) */
typedef struct pel_isotropic {
    pel_lane energy, t, j, tt, tj, jj;
} pel_isotropic;

/* principal axes of C: cosine and sine of twice their angle, inverses of the principal values */
typedef struct pel_principal {
    pel_lane cosine, sine, inverse1, inverse2;
} pel_principal;

PEL_INLINE pel_principal pel_principal_of(const pel_symmetric2 *c, pel_lane j)
{
    const pel_lane half = PEL_CONSTANT(0.5), zero = pel_lane_splat(0);
    pel_principal p;
    pel_lane difference = half * (c->a - c->b), size = pel_lane_sqrt(difference * difference + c->c * c->c);
    p.cosine = pel_lane_select(pel_lane_above(size, zero), difference / size, pel_lane_splat(1));
    p.sine = pel_lane_quotient(c->c, size);
    pel_lane larger = pel_lane_max(half * (c->a + c->b) + size, j);
    p.inverse1 = pel_lane_splat(1) / larger;
    p.inverse2 = larger / (j * j);
    return p;
}

/* a tangent in principal axes: the block of the normal strains and the shear stiffness */
typedef struct pel_principal_tangent {
    pel_lane n11, n12, n22, shear;
} pel_principal_tangent;

PEL_INLINE pel_symmetric3 pel_tangent_from_principal(const pel_principal *p, const pel_principal_tangent *n)
{
    const pel_lane one = pel_lane_splat(1), two = pel_lane_splat(2), half = PEL_CONSTANT(0.5);
    /* squares and product of the cosine and sine of the angle */
    pel_lane cc = half * (one + p->cosine), ss = half * (one - p->cosine), cs = half * p->sine;
    pel_lane mixed = two * n->n12 * cc * ss, turned = two * two * n->shear * cs * cs;
    pel_lane along = n->n11 * cc - n->n12 * (cc - ss) - n->n22 * ss;
    pel_lane across = n->n11 * ss + n->n12 * (cc - ss) - n->n22 * cc;
    pel_lane twist = two * n->shear * p->cosine;
    return (pel_symmetric3){
        n->n11 * cc * cc + mixed + n->n22 * ss * ss + turned,
        (n->n11 + n->n22) * cc * ss + n->n12 * (cc * cc + ss * ss) - turned,
        cs * (along - twist),
        n->n11 * ss * ss + mixed + n->n22 * cc * cc + turned,
        cs * (across + twist),
        (n->n11 - two * n->n12 + n->n22) * cs * cs + n->shear * p->cosine * p->cosine,
    };
}

/* the positive semi-definite part: negative eigenvalues become 0 */
PEL_INLINE pel_principal_tangent pel_positive_part(const pel_principal_tangent *n)
{
    const pel_lane half = PEL_CONSTANT(0.5), zero = pel_lane_splat(0);
    pel_lane mean = half * (n->n11 + n->n22), difference = half * (n->n11 - n->n22);
    pel_lane size = pel_lane_sqrt(difference * difference + n->n12 * n->n12);
    pel_lane high = pel_lane_max(mean + size, zero), low = pel_lane_max(mean - size, zero);
    pel_lane centre = half * (high + low), scale = pel_lane_quotient(half * (high - low), size);
    return (pel_principal_tangent){centre + scale * difference, scale * n->n12, centre - scale * difference,
                                   pel_lane_max(n->shear, zero)};
}

PEL_INLINE void pel_respond_isotropic(const pel_strain *s, pel_lane j, const pel_isotropic *f, pel_response *r)
{
    const pel_lane two = pel_lane_splat(2), four = pel_lane_splat(4);
    r->energy = f->energy;
    r->by_trace = f->t;
    r->by_area = f->j;
    pel_lane twice = two * f->t, over = f->j / j;
    r->stress = (pel_symmetric2){twice + over * s->cauchy.b, twice + over * s->cauchy.a, -(over * s->cauchy.c)};
    pel_principal p = pel_principal_of(&s->cauchy, j);
    pel_lane pull = f->j * j, stiff = f->jj * j * j, mixed = two * f->tj * j, trace = four * f->tt;
    pel_lane i1 = p.inverse1, i2 = p.inverse2;
    const pel_principal_tangent n = {
        trace + two * mixed * i1 + (stiff - pull) * i1 * i1,
        trace + mixed * (i1 + i2) + (stiff + pull) * i1 * i2,
        trace + two * mixed * i2 + (stiff - pull) * i2 * i2,
        -(pull * i1 * i2),
    };
    const pel_principal_tangent positive = pel_positive_part(&n);
    r->tangent = pel_tangent_from_principal(&p, &n);
    r->positive = pel_tangent_from_principal(&p, &positive);
}

#endif
