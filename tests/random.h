/* Random numbers with a fixed seed for property tests (splitmix64): the same everywhere. */
#ifndef PEL_TESTS_RANDOM_H
#define PEL_TESTS_RANDOM_H

#include <math.h>
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

/* mean 0, deviation 1 (Box-Muller) */
static inline double random_normal(random_state *random)
{
    double radius = sqrt(-2 * log(1 - random_between(random, 0, 1)));
    return radius * cos(6.283185307179586 * random_between(random, 0, 1));
}

/* rotation matrix (3 x 3) row-major, uniform over all rotations (from a random unit quaternion) */
static inline void random_rotation(random_state *random, double rotation[9])
{
    double w = random_normal(random), x = random_normal(random), y = random_normal(random), z = random_normal(random);
    double s = 2 / (w * w + x * x + y * y + z * z);
    const double entries[9] = {1 - s * (y * y + z * z), s * (x * y - w * z),     s * (x * z + w * y),
                               s * (x * y + w * z),     1 - s * (x * x + z * z), s * (y * z - w * x),
                               s * (x * z - w * y),     s * (y * z + w * x),     1 - s * (x * x + y * y)};
    for (int i = 0; i < 9; i++)
        rotation[i] = entries[i];
}

#endif
