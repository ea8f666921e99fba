/* Times of a step, keyed numbers, and looks at the new positions. */
#ifndef PEL_STAGE_ACCESSORS_H
#define PEL_STAGE_ACCESSORS_H

#include "stage/stage.h"

/* at the end of the present part [s] */
double pel_sim_next_time(const pel_sim *sim);
/* s, at a share of the present part of the step */
double pel_sim_part_time(const pel_sim *sim, double share);
/* whether a time [s] is that of the present state or before it; times that differ by a millionth of dt are equal */
bool pel_sim_has_come(const pel_sim *sim, double time);

/* keyed material numbers at a time */
void pel_sim_update_factors(pel_sim *sim, double time);

/* the first vertex of the new positions that is out of the bound, or -1 */
int32_t pel_sim_first_outside(const pel_sim *sim);
bool pel_sim_all_inside(const pel_sim *sim);
/* the longest edge of all surfaces at the new positions */
double pel_sim_longest_edge(const pel_sim *sim);
/* m, the longest way of a vertex in this step by its velocity */
double pel_sim_fastest_way(const pel_sim *sim);

#endif
