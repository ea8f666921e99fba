/* Derivatives by central differences with two Richardson steps: error about 1e-11 of the function for smooth functions
   of order-one arguments. */
#ifndef PEL_TESTS_GRADIENT_H
#define PEL_TESTS_GRADIENT_H

typedef double (*function_of_array)(const void *context, const double *x);

static inline double central_difference(function_of_array f, const void *context, double *x, int i, double step)
{
    double kept = x[i];
    x[i] = kept + step;
    double above = f(context, x);
    x[i] = kept - step;
    double below = f(context, x);
    x[i] = kept;
    return (above - below) / (2 * step);
}

/* d f / d x[i] by steps h, h/2, h/4 */
static inline double numeric_derivative(function_of_array f, const void *context, double *x, int i, double step)
{
    double coarse = central_difference(f, context, x, i, step);
    double middle = central_difference(f, context, x, i, step / 2);
    double fine = central_difference(f, context, x, i, step / 4);
    double first = (4 * middle - coarse) / 3, second = (4 * fine - middle) / 3;
    return (16 * second - first) / 15;
}

#endif
