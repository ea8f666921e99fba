/* Random numbers with a fixed seed for property tests (splitmix64): the same everywhere. */
#ifndef PEL_TESTS_GEOM_RANDOM_H
#define PEL_TESTS_GEOM_RANDOM_H

#include <stdint.h>

typedef struct random_state {
    uint64_t seed;
} random_state;

static inline uint64_t random_bits(random_state *random)
{
    uint64_t z = random->seed += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

static inline double random_between(random_state *random, double low, double high)
{
    return low + (high - low) * ((double)(random_bits(random) >> 11) * 0x1p-53);
}

/* low .. high, both included */
static inline int64_t random_integer(random_state *random, int64_t low, int64_t high)
{
    return low + (int64_t)(random_bits(random) % (uint64_t)(high - low + 1));
}

/* fewer trials where the compiler does not optimize (sanitizers, coverage) */
static inline int trial_count(int usual)
{
#ifdef __OPTIMIZE__
    return usual;
#else
    return usual / 10;
#endif
}

#endif
