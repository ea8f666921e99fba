/* The layer between two features has the load f = -gap / compliance. A change of its multiplier lambda = f h^2 by d
   along the normal n moves each point by

       dx_i = m_i w_i d n,        m inverse mass,

   so that the gap grows by d sum_k m_k w_k^2 (Macklin, Mueller and Chentanez 2016, XPBD, eq. 18). Multipliers are kept
   from substep to substep: the last load acts before the first sweep (warm start), and sweeps add or remove the
   difference. Half of it is left to them, unless that moves the gap too far: where one sweep does not solve all
   contacts at once, the whole load of the last substep acts like an explicit force on a stiff layer, and stacks tremble
   for ever; with half of it six sheets come to rest at one sweep per substep, and carry their weight to 5 digits. The
   sweep finds the load again contact by contact, so that friction near its limit would creep: such contacts keep the
   smaller one of their last two loads. Tried and lost: half of it there too, with two or three sweeps. Without
   compliance an infeasible load would grow without bound; with it the load is the stiffness times the depth, and hardly
   depends on the length of a step. Friction has the same mobility along every direction, and Coulomb's cone is one on
   the multipliers: |drag| <= friction multiplier. */
#include "sweep/sweep.h"

#include "rigid/row.h"
#include "sweep/backing.h"
#include "sweep/sweep_rigid.h"

#include <math.h>

/* of the load of the last substep: the most that the sweeps have to find again */
#define FOUND_AGAIN 0.5
/* of what friction can hold: contacts that use more of it keep their loads */
#define USED 0.5

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

/* whether one side is much heavier, given the mobility of both */
static bool is_uneven(const pel_contact *contact, const pel_record *positions, double both)
{
    double one = 0;
    for (int i = 0; i < 4; i++) {
        double weight = (double)contact->weights[i];
        one += weight > 0 ? (double)positions[contact->vertices[i]][3] * weight * weight : 0;
    }
    return one > 0 && one < both && pel_contact_is_uneven(one, both - one);
}

/* sum of weights times positions */
static inline record4 combine(const pel_contact *contact, const pel_record *positions)
{
    record4 sum = {0};
    for (int i = 0; i < 4; i++)
        sum += (double)contact->weights[i] * record_in_double(positions[contact->vertices[i]]);
    return sum;
}

/* moves the points by an impulse times the substep, the fourth number of which is 0 [N s2] */
static inline void move(const pel_contact *contact, pel_record *positions, record4 impulse)
{
    for (int i = 0; i < 4; i++) {
        pel_record *x = &positions[contact->vertices[i]];
        double share = (double)(*x)[3] * (double)contact->weights[i];
        if (share == 0)
            continue;
        *x = __builtin_convertvector(record_in_double(*x) + share * impulse, pel_record);
    }
}

/* three numbers of a contact, and 0 */
static inline record4 vector_of(const pel_real v[3])
{
    return (record4){(double)v[0], (double)v[1], (double)v[2], 0};
}

static inline double dot(record4 a, record4 b)
{
    record4 product = a * b;
    return product[0] + product[1] + product[2];
}

/* the change of the drag that takes back as much of a slip across the normal as friction can hold */
static record4 rub(pel_contact *contact, record4 slip, record4 normal, double free)
{
    record4 drag = vector_of(contact->drag), wanted = drag - (slip - dot(slip, normal) * normal) / free;
    wanted[3] = 0;
    double square = dot(wanted, wanted), limit = (double)contact->friction * (double)contact->multiplier;
    if (square > limit * limit)
        wanted *= limit / sqrt(square);
    for (int k = 0; k < 3; k++)
        contact->drag[k] = (pel_real)wanted[k];
    return wanted - drag;
}

/* Most contacts of a sweep neither push nor rub: they are told before anything else is found of them. The others read
   and write their points once; the normal's share of their way is known without another look. */
double pel_contacts_project(pel_contact_list *list, pel_record *positions, const pel_record *start)
{
    double largest = 0, carried = 0, rate = 1 / (list->substep * list->substep);
    list->rigid_moved = 0;
    for (int32_t i = 0, count = pel_contact_list_length(list); i < count; i++) {
        pel_contact *contact = pel_contact_list_at(list, i);
        if (pel_contact_is_rigid(list->rigids, contact)) {
            if (pel_rigid_contact_rests(list, contact, positions)) {
                carried = list->carried > carried ? list->carried : carried;
                continue;
            }
            double own, moved = pel_rigid_contact_project(list, contact, positions, start, &own);
            largest = moved > largest ? moved : largest;
            carried = own > carried ? own : carried;
            continue;
        }
        double load = (double)contact->multiplier;
        record4 sum = combine(contact, positions), normal = vector_of(contact->normal);
        double gap = dot(sum, normal) - (double)contact->separation;
        if (!(gap < 0) && !(load > 0))
            continue;
        pel_backing back;
        double whole = mobility(contact, positions);
        /* what has gone through its layer is jammed, and solved together its load would be without bound */
        bool is_backed =
            gap + (double)contact->separation > 0 && pel_contact_find_backing(list, contact, positions, &back);
        double free = whole - (is_backed ? back.stiffened : 0);
        double compliance = rate * (double)contact->compliance, rest = gap + (is_backed ? back.owed : 0);
        if (!(free > 0))
            continue;
        double change = -(rest + compliance * load) / (free + compliance);
        change = change > -load ? change : -load;
        contact->multiplier = (pel_real)(load + change);
        list->is_uneven = list->is_uneven || is_uneven(contact, positions, whole);
        record4 impulse = change * normal;
        if (contact->friction > 0) {
            record4 slip = sum + free * impulse - combine(contact, start) - vector_of(contact->drift);
            impulse += rub(contact, slip, normal, whole);
        }
        move(contact, positions, impulse);
        if (is_backed)
            pel_contact_answer(&back, positions, change);
        double moved = free * (change < 0 ? -change : change);
        largest = moved > largest ? moved : largest;
        carried = free * (load + change) > carried ? free * (load + change) : carried;
    }
    list->carried = carried;
    return largest;
}

void pel_contact_switch_off(pel_contact *contact)
{
    contact->separation = (pel_real)-HUGE_VAL;
    contact->multiplier = contact->earlier = 0;
    for (int k = 0; k < 3; k++)
        contact->drag[k] = 0;
}

/* project the drag onto the present tangent plane */
static void turn_drag(pel_contact *contact)
{
    double along = 0;
    for (int k = 0; k < 3; k++)
        along += (double)contact->drag[k] * (double)contact->normal[k];
    for (int k = 0; k < 3; k++)
        contact->drag[k] -= (pel_real)(along * (double)contact->normal[k]);
}

void pel_contacts_begin(pel_contact_list *list, double substep)
{
    list->substep = substep;
    for (int32_t c = 0; c < list->count; c++) {
        pel_contact *contact = &list->contacts[c];
        contact->multiplier = 0;
        for (int k = 0; k < 3; k++)
            contact->drag[k] = contact->stopped[k] = 0;
    }
}

void pel_contact_keep_push(pel_contact *contact, const pel_real before[3])
{
    for (int k = 0; k < 3 && contact->friction == 0; k++)
        contact->drag[k] += contact->multiplier * (before[k] - contact->normal[k]);
}

/* share of a load that acts first, of which the whole moves the gap by a way [m] */
static pel_real leave(double way, double most)
{
    return (pel_real)(1 - (FOUND_AGAIN * way > most ? most / way : FOUND_AGAIN));
}

/* whether friction uses more of what it can hold than USED */
static bool is_rubbed(const pel_contact *contact)
{
    double square = 0, limit = USED * (double)contact->friction * (double)contact->multiplier;
    for (int k = 0; k < 3; k++)
        square += (double)contact->drag[k] * (double)contact->drag[k];
    return square > limit * limit;
}

void pel_contacts_rouse(pel_contact_list *list, double calm)
{
    list->calm = calm;
    if (list->rigids != NULL && calm < 0)
        pel_rigid_rows_begin(list->rigids);
    for (int32_t c = 0; list->rigids != NULL && c < list->count; c++)
        list->contacts[c].settled = 0;
}

void pel_contacts_load(pel_contact_list *list, pel_record *positions, double most)
{
    list->is_rubbed = list->is_uneven = false;
    list->carried = 0;
    pel_contacts_rouse(list, -1);
    for (int32_t i = 0, count = pel_contact_list_length(list); i < count; i++) {
        pel_contact *contact = pel_contact_list_at(list, i);
        bool is_rigid = pel_contact_is_rigid(list->rigids, contact);
        record4 way = {0};
        pel_real last = contact->multiplier, kept = last < contact->earlier ? last : contact->earlier;
        contact->earlier = last;
        if (!(last > 0))
            continue;
        double whole = mobility(contact, positions);
        list->is_uneven = list->is_uneven || (!is_rigid && is_uneven(contact, positions, whole));
        if (is_rubbed(contact))
            list->is_rubbed = true;
        /* sweeps over rigid bodies go on until they have settled */
        else if (!is_rigid)
            kept = last * leave(whole * (double)last, most);
        contact->multiplier = kept;
        turn_drag(contact);
        for (int k = 0; k < 3; k++) {
            contact->drag[k] *= kept / last;
            way[k] = (double)(kept * contact->normal[k] + contact->drag[k]);
        }
        const double impulse[3] = {way[0], way[1], way[2]};
        if (kept > 0 && is_rigid)
            pel_rigid_contact_move(list->rigids, contact, positions, impulse);
        else if (kept > 0)
            move(contact, positions, way);
    }
    pel_rigids_place(list->rigids, positions);
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
        for (int32_t c = 0; c < list->count; c++) {
            pel_contact *contact = &list->contacts[c];
            if (contact->multiplier > 0 && pel_contact_is_rigid(list->rigids, contact))
                pel_rigid_contact_stop(list->rigids, contact, positions, velocities, dt);
            else if (contact->multiplier > 0)
                stop(contact, positions, velocities, dt);
        }
    for (int32_t i = 0; list->rigids != NULL && i < list->rigids->count; i++)
        pel_rigid_place_velocities(&list->rigids->items[i], list->rigids, positions, velocities);
}
