/* Checks of a gradient on a few points: against finite differences, and that it neither moves nor turns the whole. */
#ifndef PEL_TESTS_ELEMENT_STENCIL_H
#define PEL_TESTS_ELEMENT_STENCIL_H

#include "check.h"
#include "gradient.h"
#include "random.h"

#include "math/vec3.h"

enum { STENCIL_LIMIT = 4 };

/* moves n points by a random rotation and shift */
static inline void stencil_move(random_state *random, int n, const double (*x)[3], double (*moved)[3])
{
    double r[9], shift[3];
    random_rotation(random, r);
    for (int i = 0; i < 3; i++)
        shift[i] = random_normal(random);
    for (int a = 0; a < n; a++)
        for (int i = 0; i < 3; i++)
            moved[a][i] = shift[i] + r[3 * i] * x[a][0] + r[3 * i + 1] * x[a][1] + r[3 * i + 2] * x[a][2];
}

static inline double stencil_scale(int n, const double (*gradient)[3])
{
    double scale = 0;
    for (int a = 0; a < n; a++)
        scale = fmax(scale, pel_vec3_length(gradient[a]));
    return scale;
}

/* the worst difference between gradient and finite differences of the energy, relative to the largest row */
static inline double stencil_gradient_error(function_of_array energy, const void *context, int n, const double (*x)[3],
                                            const double (*gradient)[3], double step)
{
    double copy[3 * STENCIL_LIMIT], worst = 0;
    memcpy(copy, x, 3 * (size_t)n * sizeof *copy);
    for (int k = 0; k < 3 * n; k++)
        worst = fmax(worst, fabs(numeric_derivative(energy, context, copy, k, step) - gradient[k / 3][k % 3]));
    return worst / (stencil_scale(n, gradient) + 1e-300);
}

/* net force and net torque about the first point, relative to the largest row and the size of the stencil */
static inline double stencil_net_load(int n, const double (*x)[3], const double (*gradient)[3])
{
    double force[3] = {0}, torque[3] = {0}, size = 0;
    for (int a = 0; a < n; a++) {
        double arm[3], moment[3];
        pel_vec3_subtract(x[a], x[0], arm);
        pel_vec3_cross(arm, gradient[a], moment);
        pel_vec3_add(force, gradient[a], force);
        pel_vec3_add(torque, moment, torque);
        size = fmax(size, pel_vec3_length(arm));
    }
    double scale = stencil_scale(n, gradient) + 1e-300;
    return fmax(pel_vec3_length(force) / scale, pel_vec3_length(torque) / (scale * size));
}

#endif
