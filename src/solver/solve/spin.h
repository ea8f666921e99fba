/* The angular momentum of sweeps. Each constraint pushes its vertices without a torque, but about where they are when
   its turn comes; after all of them a body under stress has got a spin, in the same direction in each substep. */
#ifndef PEL_SOLVE_SPIN_H
#define PEL_SOLVE_SPIN_H

#include "base/pool.h"
#include "model/state.h"

typedef struct pel_spin pel_spin;

/* *spin stays null if the model has no deformable body. Errors: PEL_OUT_OF_MEMORY. */
pel_status pel_spin_create(const pel_model *model, pel_spin **spin);
void pel_spin_destroy(pel_spin *spin);

/* Around a sweep over elements, nothing for null: turns each body that nothing holds so that the pushes of the sweep
   have no torque about some points. base (kept until the end): of first order, where the substep starts; with
   velocities by the way from there, the angular momentum of before stays. null: of second order, the new positions; by
   the formula of three positions a free turn by the angle a in a substep then keeps it up to a^4 / 6, and about the
   base it would grow by 4 a^2 / 9. The fourth numbers of positions are inverse masses; a body with one of 0 is held, or
   asleep. */
void pel_spin_begin(pel_spin *spin, const pel_record *base, const pel_record *positions, pel_pool *pool);
void pel_spin_end(pel_spin *spin, pel_record *positions, pel_pool *pool);

#endif
