/* Contact over an event of refinement. */
#ifndef PEL_SIM_CONTACT_EVENT_H
#define PEL_SIM_CONTACT_EVENT_H

#include "stage/stage.h"

/* Room for that, and the guard of events, where bodies refine under contact. PEL_OUT_OF_MEMORY. */
pel_status pel_contacts_create_event(pel_sim *sim, pel_error *error);

#endif
