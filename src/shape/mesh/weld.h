/* Points at the same place get the same number. */
#ifndef PEL_MESH_WELD_H
#define PEL_MESH_WELD_H

#include "pellicle/base.h"

/* Numbers points (count x 3) by place: index_of (count) receives the number of each point's place, counted in order of
   first appearance, so point i is the first of its place when index_of[i] is larger than all before it.
   tolerance 0: same place = exactly equal (-0 equals 0, NaN equals nothing), by hashing: 300,000 points in about 10 ms.
   tolerance > 0 [m]: also points linked by steps of at most that length; it must be well above the resolution of the
   coordinates and well below the size of the whole, or the search becomes slow (see pel_weld_tolerance_allowed).
   Returns PEL_OK or PEL_OUT_OF_MEMORY. */
pel_status pel_weld_points(const double (*points)[3], int32_t count, double tolerance, int32_t *index_of,
                           int32_t *place_count);

/* Whether pel_weld_points takes this tolerance for these points: 0, or between 1e-14 of the largest coordinate and a
   twentieth of the bounding box's diagonal. */
bool pel_weld_tolerance_allowed(const double (*points)[3], int32_t count, double tolerance);

#endif
