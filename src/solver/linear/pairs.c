#include "linear/pairs.h"

#include "base/room.h"
#include "base/status.h"

#include <math.h>

/* cosine between a step and the change of the gradient, below which they are no pair */
#define LEAST_COSINE 1e-12

pel_status pel_pairs_create(pel_pairs *pairs, int32_t limit, size_t size, pel_error *error)
{
    *pairs = (pel_pairs){.limit = limit};
    bool room =
        PEL_ALLOCATE_ALL(PEL_ROOM(pairs->steps, (size_t)limit * size), PEL_ROOM(pairs->changes, (size_t)limit * size));
    return room ? PEL_OK : pel_fail_memory(error);
}

void pel_pairs_release(pel_pairs *pairs)
{
    PEL_FREE_ALL(pairs->steps, pairs->changes);
}

void pel_pairs_forget(pel_pairs *pairs)
{
    pairs->count = pairs->newest = 0;
}

void pel_pairs_keep(pel_pairs *pairs, size_t size, const double *const points[2], const double *const gradients[2])
{
    double step_square = 0, change_square = 0, product = 0;
    for (size_t i = 0; i < size; i++) {
        double s = points[1][i] - points[0][i], y = gradients[1][i] - gradients[0][i];
        step_square += s * s;
        change_square += y * y;
        product += s * y;
    }
    if (!(product > LEAST_COSINE * sqrt(step_square * change_square)))
        return;
    int32_t at = (pairs->newest + 1) % pairs->limit;
    double *s = pairs->steps + (size_t)at * size, *y = pairs->changes + (size_t)at * size;
    for (size_t i = 0; i < size; i++) {
        s[i] = points[1][i] - points[0][i];
        y[i] = gradients[1][i] - gradients[0][i];
    }
    pairs->inverse_products[at] = 1 / product;
    pairs->newest = at;
    pairs->count += pairs->count < pairs->limit;
}

/* of the k-th pair from the newest one on */
static int32_t place_of(const pel_pairs *pairs, int32_t k)
{
    return (pairs->newest - k + pairs->limit) % pairs->limit;
}

void pel_pairs_begin(pel_pairs *pairs, size_t size, double *d)
{
    for (int32_t k = 0; k < pairs->count; k++) {
        int32_t at = place_of(pairs, k);
        const double *s = pairs->steps + (size_t)at * size, *y = pairs->changes + (size_t)at * size;
        pairs->factors[at] = pairs->inverse_products[at] * pel_pairs_dot(size, s, d);
        for (size_t i = 0; i < size; i++)
            d[i] -= pairs->factors[at] * y[i];
    }
}

void pel_pairs_end(pel_pairs *pairs, size_t size, double *d)
{
    for (int32_t k = pairs->count - 1; k >= 0; k--) {
        int32_t at = place_of(pairs, k);
        const double *s = pairs->steps + (size_t)at * size, *y = pairs->changes + (size_t)at * size;
        double factor = pairs->factors[at] - pairs->inverse_products[at] * pel_pairs_dot(size, y, d);
        for (size_t i = 0; i < size; i++)
            d[i] += factor * s[i];
    }
}

double pel_pairs_scale(const pel_pairs *pairs, size_t size)
{
    if (pairs->count == 0)
        return 0;
    const double *newest = pairs->changes + (size_t)pairs->newest * size;
    return 1 / (pairs->inverse_products[pairs->newest] * pel_pairs_dot(size, newest, newest));
}
