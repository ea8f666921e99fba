/* Angular momentum of Gauss-Seidel sweeps. A constraint corrects its vertices without a torque at the positions that it
   finds, which earlier constraints have moved. So a sweep leaves a small spin on a body under stress, in the same
   direction in each substep. */
#ifndef PEL_SOLVE_SPIN_H
#define PEL_SOLVE_SPIN_H

#include "base/pool.h"
#include "model/state.h"

typedef struct pel_spin pel_spin;

/* *spin stays null if the model has no deformable body. Errors: PEL_OUT_OF_MEMORY. */
pel_status pel_spin_create(const pel_model *model, pel_spin **spin);
void pel_spin_destroy(pel_spin *spin);

/* Call before and after a sweep over elements; a null spin does nothing. The end rotates each free body so that the
   corrections of the sweep have no net torque about these reference points:
   base (first order, kept until the end): positions at the start of the substep, which conserves angular momentum.
   null (second order, BDF2): the new positions, which conserves that of a rotation by the angle a per substep up to
   a^4 / 6; about the base of BDF2 it would grow by 4 a^2 / 9.
   The fourth numbers of positions are inverse masses; a body with one of 0 is held or asleep, and stays as it is. */
void pel_spin_begin(pel_spin *spin, const pel_record *base, const pel_record *positions, pel_pool *pool);
void pel_spin_end(pel_spin *spin, pel_record *positions, pel_pool *pool);

#endif
