/* The blade of a session: it cuts along the edges that lead from hit to hit. */
#ifndef PEL_SESSION_BLADE_H
#define PEL_SESSION_BLADE_H

#include "pellicle/live.h"

typedef struct pel_blade {
    int32_t body;
    int32_t *path; /* (count) vertices that wait to be cut: its last one is where the blade is */
    int32_t count;
    size_t room;
} pel_blade;

/* Sets the blade on a hit. PEL_OUT_OF_MEMORY. */
pel_status pel_blade_begin(pel_blade *blade, const pel_pick_hit *hit, pel_error *error);
/* Leads the blade towards a hit on the same body: to the neighbour on the straightest way as long as that comes nearer
   at rest, and through older cuts, but along no border. An edge inside the surface waits for the next one. *moved:
   it has left its vertex. Errors of pel_cut leave the blade where it is, with nothing that waits. */
pel_status pel_blade_lead(pel_blade *blade, pel_sim *sim, const pel_pick_hit *hit, bool *moved, pel_error *error);
void pel_blade_end(pel_blade *blade);

#endif
