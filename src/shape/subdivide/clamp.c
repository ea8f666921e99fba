#include "subdivide/clamp.h"

#include "math/extremes.h"

#include <math.h>
#include <stddef.h>

void pel_clamp_rows(double *values, int32_t component_count, int32_t given_count, int32_t row_count)
{
    const size_t n = (size_t)component_count;
    for (size_t c = 0; c < n; c++) {
        double least = (double)HUGE_VAL, greatest = -(double)HUGE_VAL;
        for (size_t row = 0; row < (size_t)given_count; row++) {
            least = pel_min(least, values[row * n + c]);
            greatest = pel_max(greatest, values[row * n + c]);
        }
        for (size_t row = (size_t)given_count; row < (size_t)row_count; row++)
            values[row * n + c] = pel_min(pel_max(values[row * n + c], least), greatest);
    }
}
