/* Gusts are a sum of plane waves whose amplitudes are perpendicular to their wave vectors k, so that they have no
   sources (Kraichnan 1970). The wind carries them, and each changes at a rate of at most |k| times their speed. */
#include "boundary/gusts.h"

#include "math/functions.h"
#include "math/vec3.h"

#include <math.h>

#define PI 3.14159265358979323846

/* between 0 and 1, never either (splitmix64) */
static double next_number(uint64_t *state)
{
    uint64_t z = *state += UINT64_C(0x9e3779b97f4a7c15);
    z = (z ^ z >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ z >> 27) * UINT64_C(0x94d049bb133111eb);
    return ((double)((z ^ z >> 31) >> 12) + 0.5) / 4503599627370496.0;
}

static void next_direction(uint64_t *random, double direction[3])
{
    double z = 2 * next_number(random) - 1, angle = 2 * PI * next_number(random), r = sqrt(1 - z * z);
    pel_vec3_set(direction, r * pel_cos(angle), r * pel_sin(angle), z);
}

void pel_gusts_make(const pel_gust_def *def, pel_gusts *gusts)
{
    uint64_t random = (uint64_t)(uint32_t)def->seed << 32;
    gusts->count = def->speed > 0 ? PEL_GUST_WAVES : 0;
    for (int i = 0; i < gusts->count; i++) {
        pel_gust_wave *wave = &gusts->waves[i];
        double other[3], length;
        /* lengths from twice to half of the eddies' */
        double number = 2 * PI / def->length * pel_pow(2, 2 * next_number(&random) - 1);
        next_direction(&random, wave->vector);
        do {
            next_direction(&random, other);
            pel_vec3_cross(wave->vector, other, wave->amplitude);
            length = pel_vec3_length(wave->amplitude);
        } while (length < 0.1);
        /* the mean square of a cosine is a half, that of a component of a unit vector a third */
        pel_vec3_scale(wave->amplitude, def->speed * sqrt(6.0 / PEL_GUST_WAVES) / length, wave->amplitude);
        wave->rate = number * def->speed * (2 * next_number(&random) - 1);
        wave->phase = 2 * PI * next_number(&random);
        pel_vec3_scale(wave->vector, number, wave->vector);
    }
}

void pel_gusts_add(const pel_gusts *gusts, const double wind[3], const double x[3], double time, double factor,
                   double flow[3])
{
    for (int i = 0; i < gusts->count; i++) {
        const pel_gust_wave *wave = &gusts->waves[i];
        double carried = pel_vec3_dot(wave->vector, wind) * time;
        double angle = pel_vec3_dot(wave->vector, x) - carried + wave->rate * time + wave->phase;
        pel_vec3_along(flow, factor * pel_cos(angle), wave->amplitude, flow);
    }
}
