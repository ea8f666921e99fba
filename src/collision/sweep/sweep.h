/* Contacts in a position-based solver: compliant layers whose gap C = sum_i w_i x_i . n - separation is kept open
   (paper B, section 4, with the side remembered), met by sweeps of Gauss-Seidel, and Coulomb's friction on the way
   across the normal. */
#ifndef PEL_SWEEP_SWEEP_H
#define PEL_SWEEP_SWEEP_H

#include "sweep/contact.h"

/* At the start of a step or substep of this length [s]: no contact carries a load. */
void pel_contacts_begin(pel_contact_list *list, double substep);
/* After the normal of a contact has turned within a step: the drag of one without friction takes up the part of its
   push along the normal before that is not along the new one, so that multiplier and drag are all that has pushed. */
void pel_contact_keep_push(pel_contact *contact, const pel_real before[3]);
/* The loads in the multipliers act, before the first sweep, but for a part of at most half that moves the gap by at
   most `most` [m]: positions (vertex_count) position and inverse mass, what has inverse mass 0 stays. */
void pel_contacts_load(pel_contact_list *list, pel_record *positions, double most);
/* No contact rests; sets list->calm. */
void pel_contacts_rouse(pel_contact_list *list, double calm);
/* One sweep over the contacts in their order; start: positions at the start of the substep, from which friction counts
   the way. Returns the largest correction of a gap [m], 0 = nothing changed. Vertices of rigid bodies are left to
   pel_rigids_place. */
double pel_contacts_project(pel_contact_list *list, pel_record *positions, const pel_record *start);
/* It carries nothing, and no sweep gives it a load. */
void pel_contact_switch_off(pel_contact *contact);

/* Sweeps over the contacts that pushed: impulses take away the velocity with which the points still approach each
   other, and what friction can hold of the velocity across. Momentum stays, kinetic energy never grows. positions give
   the inverse masses; dt [s] is the time over which `drift` was gone. Changes are summed in `stopped`. */
void pel_contacts_stop(pel_contact_list *list, const pel_record *positions, pel_record *velocities, double dt,
                       int32_t sweeps);

#endif
