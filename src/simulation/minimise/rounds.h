/* The rounds of a minimisation under constraints, shared by all methods that minimise. */
#ifndef PEL_MINIMISE_ROUNDS_H
#define PEL_MINIMISE_ROUNDS_H

#include "constraint/frame.h"

/* of descent where a scene leaves them to the method: without constraints, and in each round with them */
enum { PEL_FREE_ITERATIONS = 500, PEL_ROUND_ITERATIONS = 50 };

/* Allocates the data of all methods that minimise. PEL_OUT_OF_MEMORY. */
pel_status pel_minimise_create(pel_sim *sim, pel_minimise_run *minimise, pel_error *error);
/* Where a step begins: sim->minimise->position and position_next from the state. */
void pel_minimise_begin_at_state(pel_sim *sim);
/* In a step in time, or one that goes towards rest (step_static.c). */
bool pel_minimise_is_in_motion(const pel_sim *sim);
/* One step. */
pel_status pel_minimise_step(pel_sim *sim, pel_step_result *result, pel_error *error);

/* J, elastic, with conservative pressure and loads, at sim->minimise->position in a step. */
double pel_minimise_energy(pel_sim *sim);
/* Linear systems that a run under constraints may take; those of a step in time are bounded. */
int32_t pel_minimise_systems_left(const pel_sim *sim);
/* What a system may cost with all that belongs to it, in evaluations of forces; in the mean 16. What costs more counts
   as several. */
enum { PEL_SYSTEM_WORK = 32 };

/* Tolerances of a minimisation without constraints: N, by the loads at a time (N, and the share of holding forces), or
   m. Clears sim->force and the external forces. */
double pel_minimise_tolerance(pel_sim *sim, double time);
double pel_minimise_held_share(void);
double pel_minimise_short_move(const pel_sim *sim);

/* Forces on tools: loads of constraints, and holding forces of grasped vertices. */
void pel_minimise_read_tools(pel_sim *sim);
/* After an accepted step or part of one: readings of a step are sums over the parts, and the worst of residuals. */
void pel_minimise_accept(pel_sim *sim);
/* whether contacts have slid or turned so far in the last step at rest that it is not in balance */
bool pel_minimise_slides(const pel_sim *sim);
/* Updates the stiffness of constraints after the surface has changed: constraints are as stiff as the finest vertices.
   With the bound of the base, which is 4 times lower per level, rounds close gaps slowly. Only shells in motion keep
   the bound of the base: there stiffer constraints take 1.3 to 1.7 times the time. */
void pel_minimise_follow_surface(pel_sim *sim);
/* a pel_transfer_part: what snapshots contain */
/* The loads of contacts of the last step, by features that no longer have their numbers. */
void pel_minimise_forget_contacts(pel_sim *sim);
void pel_minimise_transfer(pel_cursor *at, const pel_sim *sim, int32_t unused);
/* Before a snapshot is loaded; also where nothing is minimised. */
void pel_minimise_forget(pel_sim *sim);
/* the get_solver of the steppers that minimise */
void pel_minimise_get_solver(const pel_sim *sim, pel_solver_reading *reading);
void pel_minimise_destroy(pel_sim *sim);

#endif
