/* Contacts: plain records, written by the simulation from what `collide` finds, read by the solvers, which never look
   for collisions themselves. A contact asks that

       sum_i weights[i] x_i . normal >= separation

   with weights (1, -a, -b, -c) for a vertex against a triangle and (1 - s, s, t - 1, -t) for edge against edge. Against
   a tool, whose motion is given, only the body's points stand here: the tool's share of the sum is in `separation`, and
   what it moved since the start of the step in `drift`. The normal points to the side on which the first one was in the
   last free state (paper B, section 4; theory page, section 7). */
#ifndef PEL_SWEEP_CONTACT_H
#define PEL_SWEEP_CONTACT_H

#include "math/record.h"
#include "rigid/rigid.h"

#include <stdbool.h>
#include <stdint.h>

typedef struct pel_contact {
    int32_t vertices[4]; /* places in the model's order; all valid, with weight 0 where unused */
    pel_real weights[4];
    pel_real normal[3];  /* unit */
    pel_real separation; /* m */
    pel_real friction;   /* Coulomb's coefficient */
    pel_real compliance; /* m/N of the layer between the two; 0 = rigid */
    pel_real multiplier; /* N s2: load of the layer times the squared substep, >= 0 */
    pel_real earlier;    /* N s2: the multiplier of the substep before */
    pel_real drag[3];    /* N s2: the same of friction, across the normal */
    pel_real drift[3];   /* m: motion of the tool's share of the sum since the start of the (sub)step; else 0 */
    pel_real stopped[3]; /* m/s: sum of the changes of velocity by pel_contacts_stop */
    double settled;      /* m: sweeps pass over it while 1 + the unrest of its rigid bodies is at most this */
    int32_t row, round;  /* its row (rigid/row.h), in this round of them */
} pel_contact;

/* what a solver sweeps over */
typedef struct pel_contact_list {
    pel_contact *contacts; /* in a fixed order; may be null when count is 0 */
    int32_t count;
    const int32_t *active; /* (active_count) rising: those that may push at present, all others carry nothing; null =
                              all may */
    int32_t active_count;
    double substep;         /* s, whose square is in the multipliers */
    double carried;         /* m: the largest way that a load moved its gap by, in the last sweep */
    pel_rigids *rigids;     /* null = all vertices move by themselves */
    pel_contact **supports; /* (2 vertex_count) see sweep/backing.h; null = none are known */
    bool is_uneven;         /* something heavy presses something light, since the substep began */
    double rigid_moved;     /* m: the largest correction of a gap where nothing but rigid bodies gives way, in the last
                               sweep */
    double calm;            /* m: a contact that a sweep moves by less rests until its rigid bodies have moved by more;
                               negative = none rests */
    bool is_rubbed;         /* friction uses much of what it can hold somewhere, since the substep began */
} pel_contact_list;

/* how many a sweep looks at, and the i-th of them */
static inline int32_t pel_contact_list_length(const pel_contact_list *list)
{
    return list->active != NULL ? list->active_count : list->count;
}

/* the number of that one in the list */
static inline int32_t pel_contact_list_number(const pel_contact_list *list, int32_t i)
{
    return list->active != NULL ? list->active[i] : i;
}

static inline pel_contact *pel_contact_list_at(const pel_contact_list *list, int32_t i)
{
    return &list->contacts[pel_contact_list_number(list, i)];
}

#endif
