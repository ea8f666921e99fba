/* Contacts in a position-based solver: inequality constraints C = sum_i w_i x_i . n - separation >= 0 (paper B, section
   4, with the side remembered), met by sweeps of Gauss-Seidel, and Coulomb's friction on the way across the normal. */
#ifndef PEL_CONTACT_SWEEP_H
#define PEL_CONTACT_SWEEP_H

#include "contact/contact.h"

/* One sweep over the contacts in their order. positions: (vertex_count) position and inverse mass, what has inverse
   mass 0 stays; start: positions at the start of the step, from which friction counts the way. Corrections add to push
   and tangential of each contact, which have to be 0 when a step begins (pel_contacts_begin). Returns the largest
   depth that was met, 0 = all were satisfied [m]. */
double pel_contacts_project(pel_contact_list *list, pel_record *positions, const pel_record *start);

/* Sweeps over the contacts that pushed: impulses take away the velocity with which the points still approach each
   other, and what friction can hold of the velocity across. Momentum stays, kinetic energy never grows. positions give
   the inverse masses; dt [s] is the time over which `drift` was gone. Changes are summed in `stopped`. */
void pel_contacts_stop(pel_contact_list *list, const pel_record *positions, pel_record *velocities, double dt,
                       int32_t sweeps);

/* Forgets push, tangential and stopped, before the first sweep of a step or substep. */
void pel_contacts_begin(pel_contact_list *list);

#endif
