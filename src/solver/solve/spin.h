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

/* Around a sweep over elements, nothing for null: turns each body that nothing holds so that the momenta of the
   positions over `base`, of which the way since is velocity times time, have the angular momentum of before. The fourth
   numbers of positions are inverse masses; a body with one of 0 is held, or asleep. */
void pel_spin_begin(pel_spin *spin, const pel_record *base, const pel_record *positions, pel_pool *pool);
void pel_spin_end(pel_spin *spin, const pel_record *base, pel_record *positions, pel_pool *pool);

#endif
