/* The functions of math/functions.h beside those of the C library: ns a call, median of 15 rounds over 1000 arguments.
   usage: bench_functions
 */
#include "bench.h"
#include "math/functions.h"
#include "tests/random.h"

#include <stdio.h>

enum { COUNT = 1000, ROUNDS = 15, REPEATS = 100 };

typedef double unary(double x);
typedef double binary(double x, double y);

/* the sum keeps the calls */
static double sum;

static double time_calls(unary *one, binary *two, const double *x, const double *y)
{
    double times[ROUNDS];
    for (int r = 0; r < ROUNDS; r++) {
        double start = pel_thread_seconds();
        for (int n = 0; n < REPEATS; n++)
            for (int i = 0; i < COUNT; i++)
                sum += one != NULL ? one(x[i]) : two(x[i], y[i]);
        times[r] = pel_thread_seconds() - start;
    }
    return bench_spread_of(times, ROUNDS).median / (COUNT * REPEATS) * 1e9;
}

int main(void)
{
    static const struct {
        const char *name;
        unary *own, *library;
        binary *own_two, *library_two;
        double low, high;
    } rows[] = {
        {"sin", pel_sin, sin, NULL, NULL, -0.7, 0.7},   {"sin", pel_sin, sin, NULL, NULL, -100, 100},
        {"cos", pel_cos, cos, NULL, NULL, -100, 100},   {"exp", pel_exp, exp, NULL, NULL, -20, 20},
        {"log", pel_ln, log, NULL, NULL, 1e-3, 1e3},    {"tanh", pel_tanh, tanh, NULL, NULL, -2, 2},
        {"acos", pel_acos, acos, NULL, NULL, -1, 1},    {"pow", NULL, NULL, pel_pow, pow, 0.1, 5},
        {"hypot", NULL, NULL, pel_hypot, hypot, -1, 1}, {"atan2", NULL, NULL, pel_atan2, atan2, -1, 1},
    };
    static double x[COUNT], y[COUNT];
    random_state random = {1};
    printf("%-8s %-14s %8s %12s\n", "function", "arguments", "own [ns]", "library [ns]");
    for (size_t r = 0; r < sizeof rows / sizeof *rows; r++) {
        char range[32];
        for (int i = 0; i < COUNT; i++) {
            x[i] = random_between(&random, rows[r].low, rows[r].high);
            y[i] = random_between(&random, rows[r].low, rows[r].high);
        }
        snprintf(range, sizeof range, "%g .. %g", rows[r].low, rows[r].high);
        double own = time_calls(rows[r].own, rows[r].own_two, x, y);
        printf("%-8s %-14s %8.1f %12.1f\n", rows[r].name, range, own,
               time_calls(rows[r].library, rows[r].library_two, x, y));
    }
    return sum == 0; /* the calls are not left out */
}
