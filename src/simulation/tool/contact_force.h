/* Forces of contacts on vertices and tools. */
#ifndef PEL_TOOL_CONTACT_FORCE_H
#define PEL_TOOL_CONTACT_FORCE_H

#include "sweep/contact.h"
#include "tool/tool.h"

/* Adds it to the forces of the step. */
void pel_contact_act(pel_sim *sim, const pel_contact_action *action);
/* Adds the load and the friction of a contact: its multipliers times the rate [1/s2]. tool: its other side, which
   receives the reaction and the touch; -1 = none. */
void pel_contact_take(pel_sim *sim, int32_t tool, const pel_contact *contact, double rate);
/* The same for the impulses over a time [s] that have stopped its points (pel_contacts_stop). */
void pel_contact_take_stop(pel_sim *sim, int32_t tool, const pel_contact *contact, double dt);

#endif
