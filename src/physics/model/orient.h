/* Closed surfaces that are inside out. */
#ifndef PEL_MODEL_ORIENT_H
#define PEL_MODEL_ORIENT_H

#include "pellicle/topology.h"

/* Turns each closed part of a mesh whose signed volume is below 0 and that no other part encloses, together with the
   closed parts that it encloses: cavities stay cavities. The last two corners of a turned triangle are swapped, so
   create the topology again if turned_count is not 0. PEL_OUT_OF_MEMORY. */
pel_status pel_orient_outward(pel_mesh *mesh, const pel_topology *topology, int32_t *turned_count, pel_error *error);

#endif
