/* Stability of explicit methods on models with shells: the stiffness of shells is added to that of springs. */
#ifndef PEL_SOLVE_SHELL_STABILITY_H
#define PEL_SOLVE_SHELL_STABILITY_H

#include "force/shell_force.h"
#include "solve/stability.h"

/* Adds the bound of the shells to the stiffness bound. */
void pel_shell_stability_bound(const pel_shell_forces *forces, pel_stability *stability);

/* As pel_stability_refine, of springs and shells together: power iteration on differences of the forces at rest. */
pel_status pel_shell_stability_refine(const pel_model *model, const pel_state *state, pel_shell_forces *forces,
                                      pel_pool *pool, pel_stability *stability, pel_error *error);

/* The largest eigenvalue of K/m [1/s2], stretched as the state is, where materials that stiffen have more of it than at
   rest; 0 when out of memory. */
pel_status pel_shell_stability_now(const pel_model *model, const pel_state *state, pel_shell_forces *forces,
                                   pel_pool *pool, double *stiffness);

#endif
