#include "contact/sweep_rigid.h"

#include "contact/backing.h"
#include "rigid/sum.h"

#include <math.h>

/* of the mobility: less gives way beside rigid bodies */
#define LOOSE 0.5

static void sum_contact(pel_rigid_sum *sum, const pel_rigids *rigids, const pel_contact *contact,
                        const pel_record *positions)
{
    const double weights[4] = {(double)contact->weights[0], (double)contact->weights[1], (double)contact->weights[2],
                               (double)contact->weights[3]};
    pel_rigid_sum_set(sum, rigids, contact->vertices, weights, 4, positions);
}

void pel_rigid_contact_move(const pel_rigids *rigids, const pel_contact *contact, pel_record *positions,
                            const double impulse[3])
{
    pel_rigid_sum sum;
    sum_contact(&sum, rigids, contact, positions);
    pel_rigid_sum_push(&sum, rigids, positions, impulse);
}

/* m, of the bodies of a contact, each as often as it has vertices of it; infinite where something loose gives way */
static double unrest_of(const pel_rigids *rigids, const pel_contact *contact, const pel_record *positions)
{
    double sum = 0;
    for (int i = 0; i < 4; i++) {
        int32_t v = contact->vertices[i];
        const pel_rigid *rigid = contact->weights[i] != 0 ? pel_rigid_of(rigids, v) : NULL;
        if (rigid != NULL)
            sum += rigid->unrest;
        else if (contact->weights[i] != 0 && positions[v][3] > 0)
            return HUGE_VAL;
    }
    return sum;
}

bool pel_rigid_contact_rests(const pel_contact_list *list, const pel_contact *contact, const pel_record *positions)
{
    return contact->settled > 0 && 1 + unrest_of(list->rigids, contact, positions) <= contact->settled;
}

/* friction: takes back as much of the way across the normal since the start as it can hold; returns the change of the
   way [m] */
static double rub(const pel_rigids *rigids, pel_contact *contact, pel_record *positions, const pel_record *start,
                  const double normal[3])
{
    pel_rigid_sum sum;
    double slip[3], x[3], way[3], drag[3], change[3];
    sum_contact(&sum, rigids, contact, positions);
    for (int k = 0; k < 3; k++)
        slip[k] = sum.value[k] - (double)contact->drift[k];
    for (int i = 0; i < 4; i++) {
        pel_vertex_position(start, contact->vertices[i], x);
        pel_vec3_along(slip, -sum.weights[i], x, slip);
    }
    pel_vec3_along(slip, -pel_vec3_dot(slip, normal), normal, slip);
    pel_vec3_copy(slip, way);
    double length = pel_vec3_normalize(way), free = length > 0 ? pel_rigid_sum_mobility(&sum, way) : 1;
    if (!(free > 0))
        return 0;
    for (int k = 0; k < 3; k++)
        drag[k] = (double)contact->drag[k] - slip[k] / free;
    double limit = (double)contact->friction * (double)contact->multiplier, size = pel_vec3_length(drag);
    if (size > limit)
        pel_vec3_scale(drag, limit / size, drag);
    for (int k = 0; k < 3; k++) {
        change[k] = drag[k] - (double)contact->drag[k];
        contact->drag[k] = (pel_real)drag[k];
    }
    pel_rigid_sum_push(&sum, rigids, positions, change);
    return free * pel_vec3_length(change);
}

/* adds a way [m] to the unrest of the bodies of a contact, which rests until they have moved by more */
static void tell_way(const pel_contact_list *list, const pel_rigid_sum *sum, pel_contact *contact,
                     const pel_record *positions, double way)
{
    for (int i = 0; i < sum->grip_count; i++)
        sum->grips[i].rigid->unrest += way;
    contact->settled = way <= list->calm ? 1 + unrest_of(list->rigids, contact, positions) + list->calm : 0;
}

double pel_rigid_contact_project(pel_contact_list *list, pel_contact *contact, pel_record *positions,
                                 const pel_record *start, double *carried)
{
    const pel_rigids *rigids = list->rigids;
    double rate = 1 / (list->substep * list->substep);
    pel_rigid_sum sum;
    double normal[3], impulse[3];
    sum_contact(&sum, rigids, contact, positions);
    pel_contact_read_normal(contact, normal);
    double load = (double)contact->multiplier, compliance = rate * (double)contact->compliance;
    double gap = pel_vec3_dot(sum.value, normal) - (double)contact->separation;
    *carried = 0;
    if (!(gap < 0) && !(load > 0)) {
        /* until its bodies may have closed half of the gap */
        contact->settled = list->calm < 0 ? 0 : 1 + unrest_of(rigids, contact, positions) + 0.5 * gap;
        return 0;
    }
    double whole = pel_rigid_sum_mobility(&sum, normal);
    if (!(whole > 0))
        return 0;
    list->is_uneven |= pel_contact_is_uneven(sum.looseness, whole - sum.looseness);
    pel_backing back;
    bool is_backed = pel_contact_find_backing(list, contact, positions, &back);
    double stiffened = is_backed ? back.stiffened : 0, free = whole - stiffened;
    double change = -(gap + (is_backed ? back.owed : 0) + compliance * load) / (free + compliance);
    change = change > -load ? change : -load;
    contact->multiplier = (pel_real)(load + change);
    pel_vec3_scale(normal, change, impulse);
    pel_rigid_sum_push(&sum, rigids, positions, impulse);
    if (is_backed)
        pel_contact_answer(&back, positions, change);
    double slid = contact->friction > 0 ? rub(rigids, contact, positions, start, normal) : 0;
    *carried = free * (load + change);
    double moved = free * fabs(change);
    tell_way(list, &sum, contact, positions, moved + slid);
    if (sum.looseness <= LOOSE * free + stiffened && moved > list->rigid_moved)
        list->rigid_moved = moved;
    return moved;
}

/* the velocities that an impulse would take from the vertices alone: forces are found from them (tool/contact_force.c)
 */
static void tell_impulse(pel_contact *contact, const pel_record *positions, const double impulse[3])
{
    double free = 0;
    for (int i = 0; i < 4; i++)
        free += (double)positions[contact->vertices[i]][3] * (double)contact->weights[i] * (double)contact->weights[i];
    for (int k = 0; k < 3; k++)
        contact->stopped[k] = (pel_real)((double)contact->stopped[k] + free * impulse[k]);
}

void pel_rigid_contact_stop(const pel_rigids *rigids, pel_contact *contact, const pel_record *positions,
                            pel_record *velocities, double dt)
{
    pel_rigid_sum sum;
    double normal[3], relative[3], across[3], impulse[3];
    sum_contact(&sum, rigids, contact, positions);
    pel_contact_read_normal(contact, normal);
    pel_rigid_sum_velocity(&sum, rigids, velocities, relative);
    for (int k = 0; k < 3; k++)
        relative[k] -= (double)contact->drift[k] / dt;
    double free = pel_rigid_sum_mobility(&sum, normal), along = pel_vec3_dot(relative, normal);
    if (!(free > 0) || !(along < 0))
        return;
    pel_vec3_along(relative, -along, normal, across);
    double length = pel_vec3_normalize(across), push = -along / free;
    double drag = length > 0 ? length / pel_rigid_sum_mobility(&sum, across) : 0;
    double limit = (double)contact->friction * push;
    pel_vec3_scale(normal, push, impulse);
    pel_vec3_along(impulse, -(drag < limit ? drag : limit), across, impulse);
    pel_rigid_sum_hit(&sum, rigids, positions, velocities, impulse);
    tell_impulse(contact, positions, impulse);
}
