/* What snapshots contain of contacts. */
#ifndef PEL_TOUCH_TRANSFER_H
#define PEL_TOUCH_TRANSFER_H

#include "stage/transfer.h"

/* forces on vertices; sums of pairs (rows of bodies, columns of bodies and tools) with their collisions; statistics of
   the set; the collider, with which the statistics continue */
pel_transfer_part pel_touch_transfer_forces, pel_touch_transfer_pairs, pel_touch_transfer_statistics,
    pel_touch_transfer_collider;
/* Lists whose length changes from step to step: pairs of triangles that intersect; pairs in reach, with what their
   layers keep. */
pel_transfer_part pel_touch_transfer_tangles, pel_touch_transfer_layers;
/* After all was loaded: false, and what is at fault forgotten, when numbers of these are out of range. */
bool pel_touch_restore(const pel_sim *sim);

#endif
