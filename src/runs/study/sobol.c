#include "study/sobol.h"

/* A primitive polynomial over GF(2) and the first direction numbers of a dimension, from Joe and Kuo's table of 2008;
   dimension 0 is the van der Corput sequence. */
typedef struct sobol_dimension {
    int32_t degree;
    uint32_t inner;    /* coefficients between the first and the last, a_1 ... a_(degree-1) as bits */
    uint32_t first[7]; /* (degree) m_1, m_2, ... */
} sobol_dimension;

static const sobol_dimension dimensions[PEL_SOBOL_DIMENSIONS - 1] = {
    {1, 0, {1}},
    {2, 1, {1, 3}},
    {3, 1, {1, 3, 1}},
    {3, 2, {1, 1, 1}},
    {4, 1, {1, 1, 3, 3}},
    {4, 4, {1, 3, 5, 13}},
    {5, 2, {1, 1, 5, 5, 17}},
    {5, 4, {1, 1, 5, 5, 5}},
    {5, 7, {1, 1, 7, 11, 19}},
    {5, 11, {1, 1, 5, 1, 1}},
    {5, 13, {1, 1, 1, 3, 11}},
    {5, 14, {1, 3, 5, 5, 31}},
    {6, 1, {1, 3, 3, 9, 7, 49}},
    {6, 13, {1, 1, 1, 15, 21, 21}},
    {6, 16, {1, 3, 1, 13, 27, 49}},
    {6, 19, {1, 1, 1, 15, 7, 5}},
    {6, 22, {1, 3, 1, 15, 13, 25}},
    {6, 25, {1, 1, 5, 5, 19, 61}},
    {7, 1, {1, 3, 7, 11, 23, 15, 103}},
    {7, 4, {1, 3, 7, 13, 13, 15, 69}},
};

enum { BITS = 32 };

/* v_k = m_k / 2^k as fractions of 32 bits */
static void direction_numbers(int32_t dimension, uint32_t v[BITS])
{
    if (dimension == 0) {
        for (int k = 0; k < BITS; k++)
            v[k] = UINT32_C(1) << (BITS - 1 - k);
        return;
    }
    const sobol_dimension *row = &dimensions[dimension - 1];
    int s = row->degree;
    for (int k = 0; k < s; k++)
        v[k] = row->first[k] << (BITS - 1 - k);
    /* the recurrence of the polynomial */
    for (int k = s; k < BITS; k++) {
        v[k] = v[k - s] ^ (v[k - s] >> s);
        for (int i = 1; i < s; i++)
            if ((row->inner >> (s - 1 - i) & 1) != 0)
                v[k] ^= v[k - i];
    }
}

double pel_sobol(int32_t dimension, uint32_t index)
{
    uint32_t v[BITS], gray = index ^ (index >> 1), x = 0;
    direction_numbers(dimension, v);
    for (int k = 0; k < BITS; k++)
        if ((gray >> k & 1) != 0)
            x ^= v[k];
    return (double)x / 4294967296.0;
}
