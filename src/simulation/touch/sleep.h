/* Sleep: bodies that rest in contact are left out of steps, until something changes for them (pbd, xpbd).

   An island is what pairs within the reach of contact connect, fixed bodies and tools excepted. It falls asleep when
   all of its bodies have rested for a while (sleep.c says what rest is). In steps its positions stay, its velocities
   are 0, and its contacts and pins keep the loads that they had; forces are read as before. It wakes as a whole, before
   a step, when something that moves comes within the reach of contact, or when what its state depends on differs:
   positions, velocities, loads, pressure, numbers with keys, vertices that a tool holds. Other changes make another
   simulation, in which all are awake. */
#ifndef PEL_TOUCH_SLEEP_H
#define PEL_TOUCH_SLEEP_H

#include "stage/transfer.h"

/* Nothing where contact has no sleep, the method no layers, or a body supports of single components.
   PEL_OUT_OF_MEMORY. */
pel_status pel_sleep_create(pel_sim *sim, pel_error *error);
void pel_sleep_destroy(pel_sim *sim);
/* After pel_tools_begin and pel_projector_begin: wakes what has changed. */
void pel_sleep_begin_step(pel_sim *sim);
/* After a search: wakes what something that moves may meet. True = it was asleep, so that the search is to be repeated.
 */
bool pel_sleep_meet(pel_sim *sim);
/* The same after pel_solids_find, for tools that move. */
bool pel_sleep_meet_tools(pel_sim *sim);
/* After grasps have closed within a step: what they hold is awake. */
void pel_sleep_follow_held(pel_sim *sim);
/* Whether nothing can move in this step. */
bool pel_sleep_is_everywhere(const pel_sim *sim);
/* After a part of a step was accepted by the state: looks for rest. */
void pel_sleep_end_step(pel_sim *sim);
/* After an event of refinement: all bodies are awake. */
void pel_sleep_follow_surface(pel_sim *sim);

/* a pel_transfer_part */
void pel_sleep_transfer(pel_cursor *at, const pel_sim *sim, int32_t unused);
/* After it was loaded; false = numbers are out of range, and all are awake. */
bool pel_sleep_restore(pel_sim *sim);

#endif
