/* Functions whose rounding C libraries may choose, with the same bits on every platform: sums, products, quotients and
   square roots of doubles alone. Within 1 ulp of the exact value; NaN gives NaN. sqrt, floor, rint, fmod, remainder,
   frexp and ldexp are exact everywhere and stay those of the C library. */
#ifndef PEL_MATH_FUNCTIONS_H
#define PEL_MATH_FUNCTIONS_H

/* ---- exponential.c ---- */
double pel_exp(double x);
double pel_tanh(double x);
/* natural logarithm; -infinity for 0, NaN below */
double pel_ln(double x);
/* exact for powers of 2 */
double pel_log2(double x);
/* x^y for x >= 0, NaN below; 1 for y = 0 and for x = 1 */
double pel_pow(double x, double y);
/* sqrt(x^2 + y^2) without overflow */
double pel_hypot(double x, double y);

/* ---- circular.c: angles in rad ---- */
double pel_sin(double x);
double pel_cos(double x);
/* angle of (x, y) in -pi .. pi, with the signs of zeros as in C */
double pel_atan2(double y, double x);
/* NaN beyond -1 .. 1 */
double pel_acos(double x);

#endif
