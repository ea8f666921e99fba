/* Loose vertices that are held from below while something heavier presses them: contacts on the way of a load to what
   holds it are solved together. */
#ifndef PEL_SWEEP_BACKING_H
#define PEL_SWEEP_BACKING_H

#include "sweep/contact.h"

enum { PEL_BACKING_MOST = 48 };

/* How the supports of a contact answer 1 N s2 on it, and by how much less it gives way with them. */
typedef struct pel_backing {
    pel_contact *supports[PEL_BACKING_MOST]; /* (count) */
    double answers[PEL_BACKING_MOST];        /* (count) of their multipliers */
    int count;
    double stiffened; /* 1/kg */
    double owed;      /* m, what their gaps lack, times their answers */
} pel_backing;

static inline void pel_contact_read_normal(const pel_contact *contact, double normal[3])
{
    for (int k = 0; k < 3; k++)
        normal[k] = (double)contact->normal[k];
}

/* whether one side of a contact is so much heavier than the other that its load goes on through several sheets; the
   arguments are the mobilities of both sides [1/kg] */
bool pel_contact_is_uneven(double one, double other);

/* Of each vertex the contacts that carry most of it to either side, null = none: those with a tool, and in a list that
   is uneven those before a triangle. supports (2 vertex_count) is all null before the first list. Valid until contacts
   are refreshed. */
void pel_contacts_find_supports(pel_contact_list *list, pel_record *positions, pel_contact **supports);

/* The supports that a contact presses, but for itself; false = there are none, or tools hold both of its sides: `back`
   says nothing then. */
bool pel_contact_find_backing(const pel_contact_list *list, const pel_contact *contact, const pel_record *positions,
                              pel_backing *back);
/* Their loads follow a change of its multiplier [N s2], as far as they do not pull. */
void pel_contact_answer(const pel_backing *back, pel_record *positions, double change);

#endif
