/* Dense symmetric systems for tests: Cholesky factor in place (lower triangle, row-major). */
#ifndef PEL_TESTS_DENSE_H
#define PEL_TESTS_DENSE_H

#include <math.h>
#include <stdbool.h>
#include <stddef.h>

/* false when the matrix is not positive definite */
static inline bool dense_factor(double *a, int n)
{
    for (int i = 0; i < n; i++) {
        double *row = a + (size_t)i * (size_t)n;
        for (int j = 0; j <= i; j++) {
            const double *other = a + (size_t)j * (size_t)n;
            double sum = row[j];
            for (int k = 0; k < j; k++)
                sum -= row[k] * other[k];
            if (j < i)
                row[j] = sum / other[j];
            else if (sum > 0)
                row[i] = sqrt(sum);
            else
                return false;
        }
    }
    return true;
}

static inline void dense_solve(const double *a, int n, double *x)
{
    for (int i = 0; i < n; i++) {
        for (int k = 0; k < i; k++)
            x[i] -= a[(size_t)i * (size_t)n + (size_t)k] * x[k];
        x[i] /= a[(size_t)i * (size_t)n + (size_t)i];
    }
    for (int i = n - 1; i >= 0; i--) {
        for (int k = i + 1; k < n; k++)
            x[i] -= a[(size_t)k * (size_t)n + (size_t)i] * x[k];
        x[i] /= a[(size_t)i * (size_t)n + (size_t)i];
    }
}

#endif
