/* What snapshots contain of refinement, and its way into a changed simulation. */
#ifndef PEL_ADAPT_TRANSFER_H
#define PEL_ADAPT_TRANSFER_H

#include "stage/transfer.h"

/* of one body: the criterion's memory, and which vertex has which place; the front follows from the marks */
pel_transfer_part pel_refine_transfer;
/* After it was loaded: rebuilds front, places and loads; false when the numbers do not fit. */
bool pel_refine_restore(pel_sim *sim, int32_t body);
/* Refuses a changed simulation whose budget the present surface does not fit. PEL_BAD_ARGUMENT. */
pel_status pel_refine_check_room(const pel_sim *from, const pel_sim *to, int32_t body, pel_error *error);

#endif
