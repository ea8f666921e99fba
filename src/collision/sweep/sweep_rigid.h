/* The sweeps of sweep.c for contacts that touch rigid bodies, whose vertices follow six unknowns. */
#ifndef PEL_SWEEP_SWEEP_RIGID_H
#define PEL_SWEEP_SWEEP_RIGID_H

#include "sweep/contact.h"

/* whether a vertex of the contact belongs to a rigid body */
static inline bool pel_contact_is_rigid(const pel_rigids *rigids, const pel_contact *contact)
{
    for (int i = 0; rigids != NULL && i < 4; i++)
        if (contact->weights[i] != 0 && rigids->of_slice[contact->vertices[i] / PEL_WIDTH] >= 0)
            return true;
    return false;
}

/* Whether a sweep need not look at a contact that touches rigid bodies, and nothing loose. */
bool pel_rigid_contact_rests(const pel_contact_list *list, const pel_contact *contact, const pel_record *positions);
/* Finds the load that keeps the gap open, and friction; returns the correction of the gap [m] and, in carried, how far
   the load moves it; list->rigid_moved follows. */
double pel_rigid_contact_project(pel_contact_list *list, pel_contact *contact, pel_record *positions,
                                 const pel_record *start, double *carried);
/* moves what it touches by an impulse times the substep [N s2] */
void pel_rigid_contact_move(const pel_rigids *rigids, const pel_contact *contact, pel_record *positions,
                            const double impulse[3]);
/* takes away the velocity of approach, see pel_contacts_stop */
void pel_rigid_contact_stop(const pel_rigids *rigids, pel_contact *contact, const pel_record *positions,
                            pel_record *velocities, double dt);

#endif
