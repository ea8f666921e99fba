/* The quasi-static step of fine vertices (refined/refined_model.h).

   The method x += alpha dt^2 M^-1 F (eq. A-5) is gradient flow in a pseudo time that does not depend on the mesh:
   smooth modes have the same K / M on all levels. One step of it is stable below z = alpha dt^2 (K / M) = 2, and z
   grows by some 4.4 from level to level. So the vertices that are stable move as on the base, by the same operations,
   and then the fine ones make the same pseudo time in s stages of the Runge-Kutta-Legendre method of first order
   (Meyer, Balsara and Aslam 2014, J. Comput. Phys. 257, eq. 10):

       Y_j = Y_(j-1) + (j-1)/j (Y_(j-1) - Y_(j-2)) + (2j-1)/j 2/(s^2+s) alpha dt^2 M^-1 F(Y_(j-1))

   Its factor for a mode is the Legendre polynomial P_s(1 - 2z / (s^2+s)): 1 - z for smooth modes, and less than 1 in
   size up to z = s^2+s. s stages reach as far as (s^2+s)/2 plain substeps. Chebyshev polynomials reach up to twice as
   far, but leave the fastest modes nearly undamped; one solution of a linear system would not end for buckled springs.

   Each of both halves lowers the energy with the other half at rest, so the whole is stable whatever is fine, and rests
   where all forces vanish. Velocities of the step before (keep_velocity) act on fine vertices as the drag they amount
   to for slow modes: the displacement is divided by 1 + b, b = alpha dt d / m, and by 1 + b + b' along volumetric
   springs.
 */
#ifndef PEL_SOLVE_RELAX_H
#define PEL_SOLVE_RELAX_H

#include "base/pool.h"
#include "refined/refined_model.h"

typedef struct pel_relax {
    const pel_refined_model *active;
    int64_t revision;     /* of the active model for which the lists stand */
    int32_t *slices;      /* (slice_count) those with fine vertices, body after body */
    int32_t *slice_begin; /* (body_count + 1) */
    int32_t *border;      /* (border_count) vertices at springs of fine ones that are not fine */
    int32_t border_count;
    uint8_t *is_border; /* (vertex_count) scratch */
    pel_record *stage;  /* (vertex_count) every second Y; only fine vertices and the border are valid */
    double rate;        /* largest of fine vertices, by their springs [1/s2] */
    double shell_rate;  /* of the caller: bound of the stiffness of shells over mass on this surface [1/s2] */
    bool *inside;       /* (chunks) scratch */
} pel_relax;

/* For an active model whose relaxation is set. Errors: PEL_OUT_OF_MEMORY. */
pel_status pel_relax_create(const pel_refined_model *active, pel_relax **relax, pel_error *error);
void pel_relax_destroy(pel_relax *relax);

/* Brings the lists after the active model. False when no vertex is fine. */
bool pel_relax_follow(pel_relax *relax);

/* Stages of a step; shell_rate: bound of the shells' K / m [1/s2]. */
int32_t pel_relax_stage_count(const pel_relax *relax, double shell_rate);

/* Y_0: puts fine vertices back to where the step began. The stages follow with j = 1 .. s; the last of them leaves the
   new positions in state->position_next. whole: forces from outside the springs need the positions of all vertices. */
void pel_relax_begin(pel_relax *relax, pel_state *state, bool whole);

/* Y_(j-1), which the forces of stage j have to come from: valid for fine vertices and the border, or whole */
pel_record *pel_relax_positions(const pel_relax *relax, const pel_state *state, int32_t stage_count, int32_t j);

/* Stage j. force: on each fine vertex from outside its springs; held (nullable): 1 = does not move. False when a vertex
   is farther than `bound` from the origin, or nowhere. */
bool pel_relax_stage(pel_relax *relax, pel_state *state, const pel_record *force, const uint8_t *held, pel_pool *pool,
                     double bound, int32_t stage_count, int32_t j);

#endif
