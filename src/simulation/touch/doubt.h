/* Forces of tools on what the guard has changed. */
#ifndef PEL_TOUCH_DOUBT_H
#define PEL_TOUCH_DOUBT_H

#include "stage/stage.h"

/* After the readings of a part: forces are those of the solver's state. Where the guard stepped back a vertex of a body
   that a tool presses or holds, or of one that such a body presses, the state is another one, and they are not known.
   has_stepped_back: it did so with any vertex in this part. */
void pel_contacts_doubt_forces(pel_sim *sim, bool has_stepped_back);

#endif
