/* Loose vertices that a tool holds while something heavier presses them: the two contacts of such a vertex are solved
   together. */
#ifndef PEL_CONTACT_BACKING_H
#define PEL_CONTACT_BACKING_H

#include "contact/contact.h"

/* How the supports of a contact answer 1 N s2 on it, and by how much less it gives way with them. */
typedef struct pel_backing {
    pel_contact *supports[4]; /* null = none */
    double answers[4];        /* of their multipliers */
    double stiffened;         /* 1/kg */
} pel_backing;

static inline void pel_contact_read_normal(const pel_contact *contact, double normal[3])
{
    for (int k = 0; k < 3; k++)
        normal[k] = (double)contact->normal[k];
}

/* Of each vertex the contact with a tool that carries most of it, null = none; supports (vertex_count) is all null
   before the first list. Valid until contacts are refreshed. */
void pel_contacts_find_supports(pel_contact_list *list, pel_record *positions, pel_contact **supports);

/* The supports that a contact presses, but for itself; false = there are none, or tools hold both of its sides: `back`
   says nothing then. */
bool pel_contact_find_backing(const pel_contact_list *list, const pel_contact *contact, const pel_record *positions,
                              pel_backing *back);
/* Their loads follow a change of its multiplier [N s2], as far as they do not pull. */
void pel_contact_answer(const pel_backing *back, pel_record *positions, double change);

#endif
