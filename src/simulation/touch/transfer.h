/* What snapshots contain of contacts. */
#ifndef PEL_TOUCH_TRANSFER_H
#define PEL_TOUCH_TRANSFER_H

#include "stage/transfer.h"

/* forces on vertices; sums of pairs (rows of bodies, columns of bodies and tools) with their collisions; statistics of
   the set; the collider, with which the statistics continue */
pel_transfer_part pel_touch_transfer_forces, pel_touch_transfer_pairs, pel_touch_transfer_statistics,
    pel_touch_transfer_collider;

#endif
