/* Dense kernels of a front, over `number` (float or double), which the including source defines with its square_root
   and LEAST_PIVOT.

   A front is column-major with its columns on cache lines. One tile, two vectors high and TILE wide, stays in registers
   while it runs over k: a column of the left factor is loaded once, entries of the right one are broadcast. Nothing is
   packed: 16 floats of a column are one line. Without contraction a multiplication and an addition issue side by side
   on current processors, so the peak is that of fused ones; results are the same bits for all targets. */
#ifndef PEL_LINEAR_FACTOR_KERNEL_H
#define PEL_LINEAR_FACTOR_KERNEL_H

#include "linear/factor_plan.h"

#include <math.h>
#include <string.h>

typedef number lanes __attribute__((vector_size(32), may_alias));

enum {
    LANES = 32 / (int)sizeof(number),
    TALL = 2 * LANES, /* rows of a tile; divides PEL_FRONT_PAD */
    TILE = 6,         /* columns of a tile */
    BLOCK = 96,       /* pivots between two updates of the rest: whole tiles and whole pads */
    STRIP = 48,       /* columns and rows of one piece of an update, so that both factors stay in the cache */
    ROWS = 256
};

#define KERNEL static inline __attribute__((always_inline))

KERNEL lanes load(const number *a)
{
    return *(const lanes *)(const void *)a;
}
KERNEL void store(number *a, lanes b)
{
    *(lanes *)(void *)a = b;
}

/* c -= sum over k of a's rows times b's entries; `width` columns of c. fresh: c is not read but taken as 0 */
KERNEL void multiply(const number *a, const number *b, ptrdiff_t stride, int32_t k, const number *c, ptrdiff_t c_stride,
                     const int width, const bool fresh, lanes sum[][2])
{
    for (int j = 0; j < width; j++) {
        sum[j][0] = fresh ? (lanes){0} : load(c + j * c_stride);
        sum[j][1] = fresh ? (lanes){0} : load(c + j * c_stride + LANES);
    }
    for (int32_t i = 0; i < k; i++, a += stride, b += stride) {
        lanes low = load(a), high = load(a + LANES);
        for (int j = 0; j < width; j++) {
            sum[j][0] -= low * b[j];
            sum[j][1] -= high * b[j];
        }
    }
}

/* one tile of an update: c (-)= a b^T */
KERNEL void update_tile(const number *a, const number *b, ptrdiff_t stride, int32_t k, number *c, ptrdiff_t c_stride,
                        const int width, const bool fresh)
{
    lanes sum[TILE][2];
    multiply(a, b, stride, k, c, c_stride, width, fresh, sum);
    for (int j = 0; j < width; j++) {
        store(c + j * c_stride, sum[j][0]);
        store(c + j * c_stride + LANES, sum[j][1]);
    }
}

/* one tile of a panel: subtracts k columns before it and divides by the triangle of its pivots (row-major TILE x TILE,
   reciprocals on the diagonal) */
KERNEL void solve_tile(const number *a, const number *b, ptrdiff_t stride, int32_t k, number *c,
                       number triangle[TILE][TILE], const int width)
{
    lanes sum[TILE][2];
    multiply(a, b, stride, k, c, stride, width, false, sum);
    for (int j = 0; j < width; j++) {
        for (int i = 0; i < j; i++) {
            sum[j][0] -= sum[i][0] * triangle[j][i];
            sum[j][1] -= sum[i][1] * triangle[j][i];
        }
        sum[j][0] *= triangle[j][j];
        sum[j][1] *= triangle[j][j];
        store(c + j * stride, sum[j][0]);
        store(c + j * stride + LANES, sum[j][1]);
    }
}

/* calls one of the kernels with its width as a constant */
#define FOR_WIDTH(width, call)                                                                                         \
    do {                                                                                                               \
        switch (width) {                                                                                               \
        case 6:                                                                                                        \
            call(6);                                                                                                   \
            break;                                                                                                     \
        case 5:                                                                                                        \
            call(5);                                                                                                   \
            break;                                                                                                     \
        case 4:                                                                                                        \
            call(4);                                                                                                   \
            break;                                                                                                     \
        case 3:                                                                                                        \
            call(3);                                                                                                   \
            break;                                                                                                     \
        case 2:                                                                                                        \
            call(2);                                                                                                   \
            break;                                                                                                     \
        default:                                                                                                       \
            call(1);                                                                                                   \
            break;                                                                                                     \
        }                                                                                                              \
    } while (0)

/* Rows first_row to last_row (multiples of TALL) of columns first to last of c -= a b^T over k columns, where on and
   below the diagonal. a and b are columns of the same panel: row i of c is row i of a, column j of c row j of b. */
static void update_rows(const number *a, const number *b, ptrdiff_t stride, int32_t k, number *c, ptrdiff_t c_stride,
                        int32_t first, int32_t last, int32_t first_row, int32_t last_row, bool fresh)
{
    for (int32_t j = first; j < last; j += TILE) {
        int32_t width = last - j < TILE ? last - j : TILE, top = j / TALL * TALL;
        for (int32_t i = top > first_row ? top : first_row; i < last_row; i += TALL) {
#define UPDATE(w)                                                                                                      \
    if (fresh)                                                                                                         \
        update_tile(a + i, b + j, stride, k, c + i + j * c_stride, c_stride, w, true);                                 \
    else                                                                                                               \
        update_tile(a + i, b + j, stride, k, c + i + j * c_stride, c_stride, w, false)
            FOR_WIDTH(width, UPDATE);
#undef UPDATE
        }
    }
}

/* rows of columns first to last of a panel, by the pivots first to last, which are factored */
static void solve_rows(number *panel, ptrdiff_t stride, int32_t first, int32_t last, int32_t first_row,
                       int32_t last_row)
{
    for (int32_t j = first; j < last; j += TILE) {
        int32_t width = last - j < TILE ? last - j : TILE;
        number triangle[TILE][TILE];
        for (int32_t r = 0; r < width; r++)
            for (int32_t s = 0; s <= r; s++)
                triangle[r][s] = panel[j + r + (j + s) * stride];
        number *a = panel + first * stride;
        for (int32_t i = first_row; i < last_row; i += TALL) {
#define SOLVE(w) solve_tile(a + i, a + j, stride, j - first, panel + i + j * stride, triangle, w)
            FOR_WIDTH(width, SOLVE);
#undef SOLVE
        }
    }
}

/* Cholesky of a small block in place, row-major, reciprocals on the diagonal. Returns the first pivot that is not above
   the least one, or the width. */
static int32_t factor_triangle(number triangle[TILE][TILE], int32_t width, number least, number *smallest)
{
    for (int32_t j = 0; j < width; j++) {
        number pivot = triangle[j][j];
        for (int32_t k = 0; k < j; k++)
            pivot -= triangle[j][k] * triangle[j][k];
        if (pivot < *smallest || !(pivot > least))
            *smallest = pivot;
        if (!(pivot > least && pivot < (number)HUGE_VAL))
            return j;
        number inverse = 1 / square_root(pivot);
        triangle[j][j] = inverse;
        for (int32_t i = j + 1; i < width; i++) {
            number sum = triangle[i][j];
            for (int32_t k = 0; k < j; k++)
                sum -= triangle[i][k] * triangle[j][k];
            triangle[i][j] = sum * inverse;
        }
    }
    return width;
}

/* Factors pivots first to last of a panel, and the rows of these columns down to last_row (a multiple of TALL).
   Returns the pivot that failed, or last. What lies above the diagonal is left undefined. */
static int32_t factor_pivots(number *panel, ptrdiff_t stride, int32_t first, int32_t last, int32_t last_row,
                             number least, number *smallest)
{
    for (int32_t j = first; j < last; j += TILE) {
        int32_t width = last - j < TILE ? last - j : TILE, top = j / TALL * TALL;
        int32_t below = (j + width + TALL - 1) / TALL * TALL;
        number *a = panel + first * stride, triangle[TILE][TILE];
        update_rows(a, a, stride, j - first, panel, stride, j, j + width, top, below, false);
        for (int32_t r = 0; r < width; r++)
            for (int32_t s = 0; s <= r; s++)
                triangle[r][s] = panel[j + r + (j + s) * stride];
        int32_t done = factor_triangle(triangle, width, least, smallest);
        if (done < width)
            return j + done;
        for (int32_t i = top; i < last_row; i += TALL) {
            int32_t k = i < below ? 0 : j - first;
#define SOLVE(w) solve_tile(a + i, a + j, stride, k, panel + i + j * stride, triangle, w)
            FOR_WIDTH(width, SOLVE);
#undef SOLVE
        }
        /* the tiles have run over the triangle itself */
        for (int32_t r = 0; r < width; r++)
            for (int32_t s = 0; s <= r; s++)
                panel[j + r + (j + s) * stride] = triangle[r][s];
    }
    return last;
}

#endif
