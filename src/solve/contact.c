/* A correction along a direction d by a distance c gives each point

       dx_i = m_i w_i / (sum_k m_k w_k^2) c d,        m inverse mass,

   so that the weighted sum moves by exactly c d. Friction has the same mobility along every direction: Coulomb's cone
   on impulses is one on the sums of these distances, |tangential| <= friction push. */
#include "solve/contact.h"

static double mobility(const pel_contact *contact, const pel_record *positions)
{
    double sum = 0;
    for (int i = 0; i < 4; i++) {
        double weight = (double)contact->weights[i];
        sum += (double)positions[contact->vertices[i]][3] * weight * weight;
    }
    return sum;
}

/* sum of weights times positions */
static void combine(const pel_contact *contact, const pel_record *positions, double sum[3])
{
    sum[0] = sum[1] = sum[2] = 0;
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 3; k++)
            sum[k] += (double)contact->weights[i] * (double)positions[contact->vertices[i]][k];
}

/* moves the points so that the weighted sum goes by `way` */
static void move(const pel_contact *contact, pel_record *positions, double inverse, const double way[3])
{
    for (int i = 0; i < 4; i++) {
        pel_record *x = &positions[contact->vertices[i]];
        double share = (double)(*x)[3] * (double)contact->weights[i] * inverse;
        for (int k = 0; k < 3; k++)
            (*x)[k] = (pel_real)((double)(*x)[k] + share * way[k]);
    }
}

/* takes back as much of the way across the normal as friction can hold */
static void rub(pel_contact *contact, pel_record *positions, const pel_record *start, double inverse)
{
    double now[3], before[3], slip[3], along = 0, wanted[3], square = 0;
    combine(contact, positions, now);
    combine(contact, start, before);
    for (int k = 0; k < 3; k++) {
        slip[k] = now[k] - before[k] - (double)contact->drift[k];
        along += slip[k] * (double)contact->normal[k];
    }
    for (int k = 0; k < 3; k++) {
        wanted[k] = (double)contact->tangential[k] - (slip[k] - along * (double)contact->normal[k]);
        square += wanted[k] * wanted[k];
    }
    double limit = (double)contact->friction * (double)contact->push;
    double scale = square > limit * limit ? limit / sqrt(square) : 1, way[3];
    for (int k = 0; k < 3; k++) {
        way[k] = scale * wanted[k] - (double)contact->tangential[k];
        contact->tangential[k] = (pel_real)(scale * wanted[k]);
    }
    move(contact, positions, inverse, way);
}

double pel_contacts_project(pel_contact_list *list, pel_record *positions, const pel_record *start)
{
    double deepest = 0;
    for (int32_t c = 0; c < list->count; c++) {
        pel_contact *contact = &list->contacts[c];
        double sum[3], gap = -(double)contact->separation, free = mobility(contact, positions);
        combine(contact, positions, sum);
        for (int k = 0; k < 3; k++)
            gap += sum[k] * (double)contact->normal[k];
        if (!(free > 0))
            continue;
        if (gap < 0) {
            double way[3];
            for (int k = 0; k < 3; k++)
                way[k] = -gap * (double)contact->normal[k];
            move(contact, positions, 1 / free, way);
            contact->push = (pel_real)((double)contact->push - gap);
            deepest = -gap > deepest ? -gap : deepest;
        }
        if (contact->friction > 0 && contact->push > 0)
            rub(contact, positions, start, 1 / free);
    }
    return deepest;
}

void pel_contacts_begin(pel_contact_list *list)
{
    for (int32_t c = 0; c < list->count; c++) {
        pel_contact *contact = &list->contacts[c];
        contact->push = 0;
        for (int k = 0; k < 3; k++)
            contact->tangential[k] = 0;
    }
}
