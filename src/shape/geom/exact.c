/* Signs of determinants, exact for all finite doubles.

   A double is an integer times a power of two, so the points of a predicate become integers over one common power, as
   long as their range of exponents asks for: two 64-bit limbs for differences in the usual case, 33 at the very most.
   The determinant is then computed as it stands. This is only reached when the sign of the rounded determinant is in
   doubt: with u = 2^-53, each rounded term carries at most 7 (three dimensions) or 3 (two) factors 1 + u (Shewchuk,
   "Adaptive precision floating-point arithmetic and fast robust geometric predicates", 1997). Underflow is covered by
   the tiny constants; an overflow makes the bound infinite and the sign doubtful. */
#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "pellicle/geometry.h"

enum { LIMB_BITS = 64, MANTISSA_BITS = 53, LIMB_LIMIT = 104 };

#define BOUND_2D 0x1p-50
#define BOUND_3D 0x1p-49
#define TINY 0x1p-1000

__extension__ typedef unsigned __int128 uint128;

/* sign and magnitude; limbs from the lowest, all of `length` defined */
typedef struct integer {
    int sign, length;
    uint64_t limb[LIMB_LIMIT];
} integer;

/* the power of two and the length that hold the differences of some doubles */
typedef struct integer_format {
    int exponent, length;
} integer_format;

/* ---- integers ---- */

static integer_format find_format(const double *const *points, int point_count, int dimension)
{
    int lowest = 2000, highest = -2000;
    for (int i = 0; i < point_count; i++)
        for (int k = 0; k < dimension; k++)
            if (points[i][k] != 0) {
                int exponent;
                frexp(points[i][k], &exponent);
                lowest = exponent < lowest ? exponent : lowest;
                highest = exponent > highest ? exponent : highest;
            }
    if (lowest > highest)
        return (integer_format){0, 1};
    /* one bit more for the difference of opposite signs */
    int bits = highest - lowest + MANTISSA_BITS + 1;
    return (integer_format){lowest - MANTISSA_BITS, (bits + LIMB_BITS - 1) / LIMB_BITS};
}

static void integer_set(integer *a, double value, integer_format format)
{
    int exponent;
    double fraction = frexp(fabs(value), &exponent);
    memset(a->limb, 0, (size_t)format.length * sizeof *a->limb);
    a->sign = (value > 0) - (value < 0);
    a->length = format.length;
    if (a->sign == 0)
        return;
    uint64_t mantissa = (uint64_t)ldexp(fraction, MANTISSA_BITS);
    int shift = exponent - MANTISSA_BITS - format.exponent, limb = shift / LIMB_BITS, bit = shift % LIMB_BITS;
    a->limb[limb] = mantissa << bit;
    if (bit > 0 && limb + 1 < a->length)
        a->limb[limb + 1] = mantissa >> (LIMB_BITS - bit);
}

static int compare_magnitudes(const integer *a, const integer *b)
{
    for (int i = a->length - 1; i >= 0; i--)
        if (a->limb[i] != b->limb[i])
            return a->limb[i] < b->limb[i] ? -1 : 1;
    return 0;
}

/* magnitude a + b, of one length; there is room for the carry */
static void add_magnitudes(const integer *a, const integer *b, integer *sum)
{
    uint128 carry = 0;
    for (int i = 0; i < a->length; i++) {
        carry += (uint128)a->limb[i] + b->limb[i];
        sum->limb[i] = (uint64_t)carry;
        carry >>= LIMB_BITS;
    }
}

/* magnitude a - b, a not the smaller */
static void subtract_magnitudes(const integer *a, const integer *b, integer *difference)
{
    uint64_t borrow = 0;
    for (int i = 0; i < a->length; i++) {
        uint128 taken = (uint128)b->limb[i] + borrow;
        borrow = a->limb[i] < taken;
        difference->limb[i] = (uint64_t)(a->limb[i] - taken);
    }
}

/* a + sign * b; sum may be a or b */
static void integer_add(const integer *a, int sign, const integer *b, integer *sum)
{
    int b_sign = sign * b->sign;
    sum->length = a->length;
    if (a->sign * b_sign >= 0) {
        add_magnitudes(a, b, sum);
        sum->sign = a->sign != 0 ? a->sign : b_sign;
        return;
    }
    int order = compare_magnitudes(a, b);
    int a_sign = a->sign;
    if (order >= 0)
        subtract_magnitudes(a, b, sum);
    else
        subtract_magnitudes(b, a, sum);
    sum->sign = order == 0 ? 0 : (order > 0 ? a_sign : b_sign);
}

/* a * b with `room` limbs more than it needs */
static void integer_multiply(const integer *a, const integer *b, int room, integer *product)
{
    product->length = a->length + b->length + room;
    product->sign = a->sign * b->sign;
    memset(product->limb, 0, (size_t)product->length * sizeof *product->limb);
    if (product->sign == 0)
        return;
    for (int i = 0; i < a->length; i++) {
        uint128 carry = 0;
        for (int j = 0; j < b->length; j++) {
            carry += (uint128)a->limb[i] * b->limb[j] + product->limb[i + j];
            product->limb[i + j] = (uint64_t)carry;
            carry >>= LIMB_BITS;
        }
        product->limb[i + b->length] = (uint64_t)carry;
    }
}

/* a d - b c */
static void integer_determinant2(const integer *a, const integer *b, const integer *c, const integer *d,
                                 integer *determinant)
{
    integer other;
    integer_multiply(a, d, 1, determinant);
    integer_multiply(b, c, 1, &other);
    integer_add(determinant, -1, &other, determinant);
}

static void integer_difference(double a, double b, integer_format format, integer *difference)
{
    integer other;
    integer_set(difference, a, format);
    integer_set(&other, b, format);
    integer_add(difference, -1, &other, difference);
}

/* ---- predicates ---- */

static bool all_finite(const double *const *points, int point_count, int dimension)
{
    for (int i = 0; i < point_count; i++)
        for (int k = 0; k < dimension; k++)
            if (!isfinite(points[i][k]))
                return false;
    return true;
}

/* a line or plane across a coordinate axis: common, and zero without computing anything */
static bool share_coordinate(const double *const *points, int point_count, int dimension)
{
    for (int k = 0; k < dimension; k++) {
        int equal = 1;
        while (equal < point_count && points[equal][k] == points[0][k])
            equal++;
        if (equal == point_count)
            return true;
    }
    return false;
}

static int exact_orient2d(const double *const points[3])
{
    integer edges[2][2], determinant;
    if (!all_finite(points, 3, 2) || share_coordinate(points, 3, 2))
        return 0;
    integer_format format = find_format(points, 3, 2);
    for (int i = 0; i < 2; i++)
        for (int k = 0; k < 2; k++)
            integer_difference(points[i + 1][k], points[0][k], format, &edges[i][k]);
    integer_determinant2(&edges[0][0], &edges[0][1], &edges[1][0], &edges[1][1], &determinant);
    return determinant.sign;
}

static int exact_orient3d(const double *const points[4])
{
    integer edges[3][3], minor, term, sum;
    if (!all_finite(points, 4, 3) || share_coordinate(points, 4, 3))
        return 0;
    integer_format format = find_format(points, 4, 3);
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            integer_difference(points[i + 1][k], points[0][k], format, &edges[i][k]);
    for (int k = 0; k < 3; k++) {
        int x = (k + 1) % 3, y = (k + 2) % 3;
        integer_determinant2(&edges[0][x], &edges[0][y], &edges[1][x], &edges[1][y], &minor);
        integer_multiply(&minor, &edges[2][k], 0, k == 0 ? &sum : &term);
        if (k > 0)
            integer_add(&sum, 1, &term, &sum);
    }
    return sum.sign;
}

int pel_orient2d(const double a[2], const double b[2], const double c[2])
{
    double left = (b[0] - a[0]) * (c[1] - a[1]), right = (b[1] - a[1]) * (c[0] - a[0]);
    double determinant = left - right, bound = BOUND_2D * (fabs(left) + fabs(right)) + TINY;
    if (fabs(determinant) > bound)
        return determinant > 0 ? 1 : -1;
    const double *points[3] = {a, b, c};
    return exact_orient2d(points);
}

int pel_orient3d(const double a[3], const double b[3], const double c[3], const double d[3])
{
    double determinant = 0, bound = TINY;
    for (int k = 0; k < 3; k++) {
        int x = (k + 1) % 3, y = (k + 2) % 3;
        double left = (b[x] - a[x]) * (c[y] - a[y]), right = (b[y] - a[y]) * (c[x] - a[x]), height = d[k] - a[k];
        determinant += (left - right) * height;
        bound += (fabs(left) + fabs(right) + TINY) * fabs(height) * BOUND_3D;
    }
    if (fabs(determinant) > bound)
        return determinant > 0 ? 1 : -1;
    const double *points[4] = {a, b, c, d};
    return exact_orient3d(points);
}
