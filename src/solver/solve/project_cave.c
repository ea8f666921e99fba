/* Regions that cave in (paper B, section 3): the gradient of the fibres' energy is replaced by the normal, so that a
   triangle whose fibres are strained goes inward.

   Taken literally, projection by projection, this rule has no rest: going in strains the surface, and the strain drives
   it further, so that a head grew to twice its area. Here a corner of a triangle has a depth for a step,

       depth = strength (strain / PEL_CAVE_STRAIN)^2,  at most max_step of the edge less the way that it goes inward
                                                       in a step by its velocity,

   found once, before the step, of which it takes the share that the triangle has of the area around the corner. With
   n substeps a projection goes depth / n^2 over the iterations, because what a substep goes the others go on with: so
   the inward speed grows by depth over dt. All triangles, sweeps, substeps and steps together give no vertex more than
   max_step of an edge a step. Only fibres that are shorter than at rest drive: outside pressure shortens them, and so
   does going in, up to the mirror image of the cap; the stretch beyond it does not count. */
#include "math/extremes.h"
#include "math/vec3.h"
#include "solve/project.h"

#include <math.h>

/* strain of a fibre whose image has the squared length: of its length, or (stvk) Green's; the same for small ones */
static double strain_of(pel_fibre_kind kind, double square)
{
    return kind == PEL_FIBRE_STVK ? 0.5 * (square - 1) : sqrt(square) - 1;
}

/* depth [m] of each corner of a triangle in a step */
static void find_depths(const pel_batch *batch, const pel_anisotropy_def *def, int32_t i, const int32_t corners[3],
                        double edge, const pel_state *state, double dt, double depth[3])
{
    double x[3][3], v[3][3], image[3], normal[3];
    double c0 = (double)*pel_batch_number(batch, i, 0), c1 = (double)*pel_batch_number(batch, i, 1);
    pel_load_points(state->position, corners, 3, x);
    pel_load_points(state->velocity, corners, 3, v);
    for (int c = 0; c < 3; c++)
        image[c] = c0 * (x[0][c] - x[2][c]) + c1 * (x[1][c] - x[2][c]);
    double strain = strain_of(def->kind, pel_vec3_squared_length(image)) / PEL_CAVE_STRAIN;
    pel_vec3_triangle_normal(x[0], x[1], x[2], normal);
    double size = pel_vec3_length(normal);
    double most = def->max_step * edge;
    for (int k = 0; k < 3; k++) {
        double inward = size > 0 ? pel_max(-dt * pel_vec3_dot(v[k], normal) / size, 0) : 0;
        depth[k] = strain < 0 && size > 0 ? pel_max(pel_min(def->strength * strain * strain, most - inward), 0) : 0;
    }
}

void pel_project_cave_begin(const pel_batch *batch, const pel_shell *shell, const pel_state *state,
                            const pel_solver_def *solver)
{
    const pel_shell_region *region = &shell->regions[batch->region];
    double projections = (double)solver->substeps * solver->substeps * solver->iterations;
    for (int32_t i = 0; i < batch->block_count * PEL_BLOCK; i++) {
        int32_t t = pel_shell_fibre_triangle(region, batch->sources[i]);
        /* of a regular triangle of its area */
        double edge = sqrt(4 / sqrt(3.0) * pel_shell_rest(shell, t).area);
        double depth[3], weight = (double)*pel_batch_number(batch, i, PEL_CAVE_WEIGHT);
        find_depths(batch, &region->def, i, shell->corners[t], edge, state, solver->dt, depth);
        for (int k = 0; k < 3; k++)
            *pel_batch_number(batch, i, PEL_CAVE_WAY + k) =
                (pel_real)(weight / projections * (double)*pel_batch_number(batch, i, PEL_CAVE_SHARE + k) * depth[k]);
    }
}
