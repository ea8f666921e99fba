/* Forces of contacts on vertices and tools. */
#ifndef PEL_TOOL_CONTACT_FORCE_H
#define PEL_TOOL_CONTACT_FORCE_H

#include "contact/contact.h"
#include "tool/tool.h"

/* Adds it to the forces of the step. */
void pel_contact_act(pel_sim *sim, const pel_contact_action *action);
/* Adds the force that changed the sum of a contact by `change`: `change` times rate over its mobility; with
   displacements in m the rate is in 1/s2, with velocities in 1/s. tool: its other side, which receives the reaction and
   the touch; -1 = none. */
void pel_contact_take(pel_sim *sim, int32_t tool, const pel_contact *contact, const double change[3], double rate);
/* the same for the push and friction of a substep */
void pel_contact_take_push(pel_sim *sim, int32_t tool, const pel_contact *contact, double rate);

#endif
