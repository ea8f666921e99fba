/* Deflections w = f(x) sum of c_ij P_i(x) P_j(y), f = x^2 where the plate is clamped. With

       K = int w_xx^2 + w_yy^2 + 2 nu w_xx w_yy + 2 (1 - nu) w_xy^2       M = int w^2

   frequencies are K c = w^2 M c. A strip that a force P bends in its plane has the stresses sigma = 12 P (1 - x) y /
   b^3 and tau = -6 P (b^2 / 4 - y^2) / b^3 times the thickness, and buckles at the least P with K c = P G c, G = int
   sigma w_x^2 + 2 tau w_x w_y. Eigenvalues by Cholesky and Jacobi. */
#include "papers/own/ritz.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { ALONG = 12, ACROSS = 10, TERMS = ALONG * ACROSS, POINTS = 24, DERIVATIVES = 3 };

/* P_0 .. P_(count-1) and two derivatives at t */
static void legendre(int count, double t, double values[][DERIVATIVES])
{
    memset(values, 0, (size_t)count * sizeof *values);
    values[0][0] = 1;
    if (count > 1) {
        values[1][0] = t;
        values[1][1] = 1;
    }
    for (int n = 1; n + 1 < count; n++)
        for (int d = 0; d < DERIVATIVES; d++) {
            double product = t * values[n][d] + (d > 0 ? d * values[n][d - 1] : 0);
            values[n + 1][d] = ((2 * n + 1) * product - n * values[n - 1][d]) / (n + 1);
        }
}

/* Gauss and Legendre on -1 .. 1, by Newton's method */
static void quadrature(double places[POINTS], double weights[POINTS])
{
    double values[POINTS + 1][DERIVATIVES];
    for (int i = 0; i < POINTS; i++) {
        double t = cos(3.14159265358979323846 * (i + 0.75) / (POINTS + 0.5));
        for (int round = 0; round < 20; round++) {
            legendre(POINTS + 1, t, values);
            t -= values[POINTS][0] / values[POINTS][1];
        }
        legendre(POINTS + 1, t, values);
        places[i] = t;
        weights[i] = 2 / ((1 - t * t) * values[POINTS][1] * values[POINTS][1]);
    }
}

/* functions of x in 0 .. 1, of y in -b/2 .. b/2, with their derivatives */
static void functions_along(bool is_clamped, double x, double values[ALONG][DERIVATIVES])
{
    legendre(ALONG, 2 * x - 1, values);
    for (int i = 0; i < ALONG; i++) {
        double p = values[i][0], p1 = 2 * values[i][1], p2 = 4 * values[i][2];
        values[i][0] = is_clamped ? x * x * p : p;
        values[i][1] = is_clamped ? 2 * x * p + x * x * p1 : p1;
        values[i][2] = is_clamped ? 2 * p + 4 * x * p1 + x * x * p2 : p2;
    }
}

static void functions_across(double width, double y, double values[ACROSS][DERIVATIVES])
{
    legendre(ACROSS, 2 * y / width, values);
    for (int j = 0; j < ACROSS; j++) {
        values[j][1] *= 2 / width;
        values[j][2] *= 4 / (width * width);
    }
}

typedef struct sample {
    double w, x, y, xx, yy, xy;
} sample;

static void add_point(const ritz_plate *plate, double x, double y, double weight, double *stiffness, double *other)
{
    double along[ALONG][DERIVATIVES], across[ACROSS][DERIVATIVES], nu = plate->poisson, b = plate->width;
    sample at[TERMS];
    functions_along(plate->is_clamped, x, along);
    functions_across(b, y, across);
    for (int i = 0; i < ALONG; i++)
        for (int j = 0; j < ACROSS; j++) {
            const double *f = along[i], *g = across[j];
            at[i * ACROSS + j] = (sample){f[0] * g[0], f[1] * g[0], f[0] * g[1], f[2] * g[0], f[0] * g[2], f[1] * g[1]};
        }
    double sigma = 12 * (1 - x) * y / (b * b * b), tau = -6 * (b * b / 4 - y * y) / (b * b * b);
    for (int m = 0; m < TERMS; m++)
        for (int n = 0; n <= m; n++) {
            const sample *p = &at[m], *q = &at[n];
            double bending =
                p->xx * q->xx + p->yy * q->yy + nu * (p->xx * q->yy + p->yy * q->xx) + 2 * (1 - nu) * p->xy * q->xy;
            double stress = sigma * p->x * q->x + tau * (p->x * q->y + p->y * q->x);
            stiffness[m * TERMS + n] += weight * bending;
            other[m * TERMS + n] += weight * (plate->buckles ? stress : p->w * q->w);
        }
}

/* lower factor of a matrix, in place */
static void factor(double *a)
{
    for (int i = 0; i < TERMS; i++)
        for (int j = 0; j <= i; j++) {
            double sum = a[i * TERMS + j];
            for (int k = 0; k < j; k++)
                sum -= a[i * TERMS + k] * a[j * TERMS + k];
            a[i * TERMS + j] = i == j ? sqrt(sum) : sum / a[j * TERMS + j];
        }
}

/* a = L^-1 a L^-T of a symmetric matrix given by its lower half */
static void transform(const double *lower, double *a)
{
    for (int i = 0; i < TERMS; i++)
        for (int j = i + 1; j < TERMS; j++)
            a[i * TERMS + j] = a[j * TERMS + i];
    for (int side = 0; side < 2; side++) {
        for (int column = 0; column < TERMS; column++)
            for (int i = 0; i < TERMS; i++) {
                double sum = a[i * TERMS + column];
                for (int k = 0; k < i; k++)
                    sum -= lower[i * TERMS + k] * a[k * TERMS + column];
                a[i * TERMS + column] = sum / lower[i * TERMS + i];
            }
        for (int i = 0; i < TERMS; i++)
            for (int j = 0; j < i; j++) {
                double swap = a[i * TERMS + j];
                a[i * TERMS + j] = a[j * TERMS + i];
                a[j * TERMS + i] = swap;
            }
    }
}

static void rotate(double *a, int p, int q)
{
    double off = a[p * TERMS + q], difference = a[q * TERMS + q] - a[p * TERMS + p];
    if (fabs(off) < 1e-300)
        return;
    double ratio = difference / (2 * off), t = copysign(1, ratio) / (fabs(ratio) + hypot(1, ratio));
    double c = 1 / hypot(1, t), s = t * c;
    for (int k = 0; k < TERMS; k++) {
        double x = a[k * TERMS + p], y = a[k * TERMS + q];
        a[k * TERMS + p] = c * x - s * y;
        a[k * TERMS + q] = s * x + c * y;
    }
    for (int k = 0; k < TERMS; k++) {
        double x = a[p * TERMS + k], y = a[q * TERMS + k];
        a[p * TERMS + k] = c * x - s * y;
        a[q * TERMS + k] = s * x + c * y;
    }
}

static int compare(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

bool ritz_solve(const ritz_plate *plate, int count, double *values)
{
    double places[POINTS], weights[POINTS], found[TERMS];
    double *stiffness = calloc(2 * TERMS * TERMS, sizeof *stiffness), *other = stiffness + TERMS * TERMS;
    int taken = 0;
    if (stiffness == NULL)
        return false;
    quadrature(places, weights);
    for (int i = 0; i < POINTS; i++)
        for (int j = 0; j < POINTS; j++)
            add_point(plate, (places[i] + 1) / 2, plate->width * places[j] / 2,
                      plate->width * weights[i] * weights[j] / 4, stiffness, other);
    /* the definite one is factored: masses, or of buckling the stiffness, whose eigenvalues are then the inverse */
    double *lower = plate->buckles ? stiffness : other, *inner = plate->buckles ? other : stiffness;
    factor(lower);
    transform(lower, inner);
    for (int sweep = 0; sweep < 12; sweep++)
        for (int p = 0; p < TERMS; p++)
            for (int q = p + 1; q < TERMS; q++)
                rotate(inner, p, q);
    for (int i = 0; i < TERMS; i++)
        found[i] = plate->buckles ? 1 / inner[i * TERMS + i] : inner[i * TERMS + i];
    qsort(found, TERMS, sizeof *found, compare);
    for (int i = 0; i < TERMS && taken < count; i++)
        if (found[i] > 1e-3)
            values[taken++] = found[i];
    free(stiffness);
    return taken == count;
}
