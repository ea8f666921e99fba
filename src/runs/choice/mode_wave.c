/* Per edge a mode u has the mean turn q = sum |u_i - u_j|^2 / sum (|u_i|^2 + |u_j|^2), which for a wave of n edges is
   (pi / n)^2, averaged over the directions of edges. Loads of buckling need about ten edges per wave (docs/statics.md:
   2 % with 16 on a sphere, and the error grows with the square of the edges). */
#include "choice/mode_wave.h"

#include "boundary/hold.h"
#include "math/extremes.h"
#include "math/vec3.h"
#include "model/shell.h"

#include <math.h>

/* of a body that is no shell. A frequency has half the error of a stiffness. */
#define LEAST_BUCKLING_WAVE 10.0
#define LEAST_WAVE 7.0
/* Of a shell a frequency with w edges in a wave is too low by about 5 / w^2, and by 6 to 20 / w^2 where clamps bend it
   sharply: squares of 8 to 32 cells on supports 4 to 6, clamped 8 to 21, cantilevers 6 to 7. What tension holds, or a
   curved shell that stretches, is off by less than 1 / w^2: square and round drums of 4 to 16 cells .6 to .8, spheres
   of 180 to 2,000 triangles .7 too high. */
#define MODE_ERROR 5.0
#define CLAMPED_MODE_ERROR 12.0
#define STRETCHED_MODE_ERROR 1.0
#define MOST_MODE_ERROR 0.05
/* of squared frequencies: that of a plate that bends to this wave alone */
#define BENT_SHARE 0.1
#define PI 3.14159265358979323846

static double count_edges(const pel_sim *sim, const double *mode)
{
    double turn = 0, sum = 0;
    for (int32_t t = 0; t < sim->model->triangle_count; t++)
        for (int i = 0; i < 3; i++) {
            const double *a = mode + 3 * (size_t)sim->model->triangles[t][i],
                         *b = mode + 3 * (size_t)sim->model->triangles[t][(i + 1) % 3];
            for (int k = 0; k < 3; k++) {
                turn += (a[k] - b[k]) * (a[k] - b[k]);
                sum += a[k] * a[k] + b[k] * b[k];
            }
        }
    return PI / sqrt(pel_max(turn, 1e-12 * sum) / sum);
}

/* kg/m2 at rest */
static double mass_per_area(const pel_sim *sim, int32_t body)
{
    const pel_model *model = sim->model;
    const pel_shell *shell = model->bodies[body].shell;
    double mass = 0, area = 0, x[3][3], across[3];
    for (int32_t v = model->bodies[body].slice_begin * PEL_WIDTH; v < pel_body_place_end(model, body); v++)
        mass += model->mesh_vertex[v] >= 0 ? (double)model->mass[v] : 0;
    for (int32_t t = 0; t < shell->triangle_count; t++) {
        for (int k = 0; k < 3; k++)
            pel_vertex_position(model->rest, shell->corners[t][k], x[k]);
        pel_vec3_subtract(x[1], x[0], x[1]);
        pel_vec3_subtract(x[2], x[0], x[2]);
        pel_vec3_cross(x[1], x[2], across);
        area += 0.5 * pel_vec3_length(across);
    }
    return mass / area;
}

static bool bends(const pel_shell *shell)
{
    return shell != NULL && shell->has_membrane && pel_bending_is_on(shell->bending) && shell->hinge_stiffness > 0;
}

/* tension or curvature makes the frequency, not bending */
static bool is_stretched(const pel_sim *sim, double edges, double frequency)
{
    bool all = true;
    for (int32_t b = 0; b < sim->model->body_count; b++) {
        const pel_shell *shell = sim->model->bodies[b].shell;
        if (!bends(shell))
            continue;
        const double wave = 2 * PI / (edges * shell->mean_edge), angular = 2 * PI * frequency;
        const double bent = shell->hinge_stiffness * wave * wave * wave * wave / mass_per_area(sim, b);
        all &= bent < BENT_SHARE * angular * angular;
    }
    return all;
}

static bool is_clamped(const pel_sim *sim)
{
    bool any = false;
    for (int32_t i = 0; sim->holds != NULL && i < sim->holds->hold_count; i++)
        any |= sim->holds->holds[i].fixes_rotation;
    return any;
}

pel_mode_wave pel_mode_wave_of(const pel_sim *sim, const double *mode, double value, bool buckles)
{
    pel_mode_wave wave = {.edges = count_edges(sim, mode), .least = buckles ? LEAST_BUCKLING_WAVE : LEAST_WAVE};
    bool any = false;
    for (int32_t b = 0; b < sim->model->body_count; b++)
        any |= bends(sim->model->bodies[b].shell);
    if (!any)
        return wave;
    double error = is_clamped(sim) ? CLAMPED_MODE_ERROR : MODE_ERROR;
    if (!buckles && is_stretched(sim, wave.edges, value))
        error = STRETCHED_MODE_ERROR;
    wave.least = sqrt(error * (buckles ? 2 : 1) / MOST_MODE_ERROR);
    return wave;
}
