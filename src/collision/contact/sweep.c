/* A correction along a direction d by a distance c gives each point

       dx_i = m_i w_i / (sum_k m_k w_k^2) c d,        m inverse mass,

   so that the weighted sum moves by exactly c d. Friction has the same mobility along every direction: Coulomb's cone
   on impulses is one on the sums of these distances, |tangential| <= friction push. */
#include "contact/sweep.h"

#include <math.h>

/* a record in double whatever the preset is */
typedef double record4 __attribute__((vector_size(32)));

static inline record4 record_in_double(pel_record a)
{
    return __builtin_convertvector(a, record4);
}

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
static inline record4 combine(const pel_contact *contact, const pel_record *positions)
{
    record4 sum = {0};
    for (int i = 0; i < 4; i++)
        sum += (double)contact->weights[i] * record_in_double(positions[contact->vertices[i]]);
    return sum;
}

/* moves the points so that the weighted sum goes by `way`, the fourth number of which is 0 */
static inline void move(const pel_contact *contact, pel_record *positions, double inverse, record4 way)
{
    for (int i = 0; i < 4; i++) {
        pel_record *x = &positions[contact->vertices[i]];
        double share = (double)(*x)[3] * (double)contact->weights[i] * inverse;
        *x = __builtin_convertvector(record_in_double(*x) + share * way, pel_record);
    }
}

/* takes back as much of the way across the normal as friction can hold */
static void rub(pel_contact *contact, pel_record *positions, const pel_record *start, double inverse)
{
    double slip[3], along = 0, wanted[3], square = 0;
    record4 now = combine(contact, positions), before = combine(contact, start), way = {0};
    for (int k = 0; k < 3; k++) {
        slip[k] = now[k] - before[k] - (double)contact->drift[k];
        along += slip[k] * (double)contact->normal[k];
    }
    for (int k = 0; k < 3; k++) {
        wanted[k] = (double)contact->tangential[k] - (slip[k] - along * (double)contact->normal[k]);
        square += wanted[k] * wanted[k];
    }
    double limit = (double)contact->friction * (double)contact->push;
    double scale = square > limit * limit ? limit / sqrt(square) : 1;
    for (int k = 0; k < 3; k++) {
        way[k] = scale * wanted[k] - (double)contact->tangential[k];
        contact->tangential[k] = (pel_real)(scale * wanted[k]);
    }
    move(contact, positions, inverse, way);
}

/* most contacts of a sweep neither push nor rub: they are told before anything else is found of them */
double pel_contacts_project(pel_contact_list *list, pel_record *positions, const pel_record *start)
{
    double deepest = 0;
    for (int32_t c = 0; c < list->count; c++) {
        pel_contact *contact = &list->contacts[c];
        double gap = -(double)contact->separation;
        record4 sum = combine(contact, positions), way = {0};
        for (int k = 0; k < 3; k++)
            gap += sum[k] * (double)contact->normal[k];
        if (!(gap < 0) && !(contact->friction > 0 && contact->push > 0))
            continue;
        double free = mobility(contact, positions);
        if (!(free > 0))
            continue;
        if (gap < 0 && list->recovery < HUGE_VAL) {
            record4 first = combine(contact, start);
            double gap0 = -(double)contact->separation;
            for (int k = 0; k < 3; k++)
                gap0 += (first[k] + (double)contact->drift[k]) * (double)contact->normal[k];
            double aim = gap0 + list->recovery;
            aim = aim < 0 ? aim : 0;
            gap -= aim;
        }
        if (gap < 0) {
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
            contact->tangential[k] = contact->stopped[k] = 0;
    }
}

/* one contact that pushed */
static void stop(pel_contact *contact, const pel_record *positions, pel_record *velocities, double dt)
{
    double free = mobility(contact, positions), along = 0, across[3], square = 0;
    if (!(free > 0))
        return;
    record4 relative = combine(contact, velocities), change = {0};
    for (int k = 0; k < 3; k++) {
        relative[k] -= (double)contact->drift[k] / dt;
        along += relative[k] * (double)contact->normal[k];
    }
    if (!(along < 0))
        return;
    for (int k = 0; k < 3; k++) {
        across[k] = relative[k] - along * (double)contact->normal[k];
        square += across[k] * across[k];
    }
    double limit = -(double)contact->friction * along, length = sqrt(square);
    double share = length > limit ? limit / length : 1;
    for (int k = 0; k < 3; k++) {
        change[k] = -along * (double)contact->normal[k] - share * across[k];
        contact->stopped[k] = (pel_real)((double)contact->stopped[k] + change[k]);
    }
    for (int i = 0; i < 4; i++) {
        int32_t v = contact->vertices[i];
        double part = (double)positions[v][3] * (double)contact->weights[i] / free;
        velocities[v] = __builtin_convertvector(record_in_double(velocities[v]) + part * change, pel_record);
    }
}

void pel_contacts_stop(pel_contact_list *list, const pel_record *positions, pel_record *velocities, double dt,
                       int32_t sweeps)
{
    for (int32_t sweep = 0; sweep < sweeps; sweep++)
        for (int32_t c = 0; c < list->count; c++)
            if (list->contacts[c].push > 0)
                stop(&list->contacts[c], positions, velocities, dt);
}
