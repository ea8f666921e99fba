#include "sweep/sweep_rigid.h"

#include "rigid/row.h"
#include "sweep/backing.h"

#include <math.h>

/* of the mobility: less gives way beside rigid bodies */
#define LOOSE 0.5

static void sum_contact(pel_rigid_sum *sum, const pel_rigids *rigids, const pel_contact *contact,
                        const pel_record *positions)
{
    const double weights[4] = {(double)contact->weights[0], (double)contact->weights[1], (double)contact->weights[2],
                               (double)contact->weights[3]};
    double normal[3];
    pel_contact_read_normal(contact, normal);
    pel_rigid_sum_set_contact(sum, rigids, contact->vertices, weights, normal, positions);
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

/* ---- a sweep ---- */

/* its row of this round, which may have to be found; null = something of it is loose */
static const pel_rigid_row *row_of(pel_rigids *rigids, pel_contact *contact, const pel_record *positions,
                                   const pel_record *start)
{
    pel_rigid_sum sum;
    double weights[4], normal[3];
    bool is_known = contact->round == rigids->row_round && contact->row < rigids->row_count;
    for (int i = 0; i < 4; i++)
        weights[i] = (double)contact->weights[i];
    pel_contact_read_normal(contact, normal);
    if (is_known && pel_rigid_row_is_of(&rigids->rows[contact->row], contact->vertices, weights, normal))
        return &rigids->rows[contact->row];
    for (int i = 0; i < 4; i++)
        if (weights[i] != 0 && positions[contact->vertices[i]][3] > 0 &&
            pel_rigid_of(rigids, contact->vertices[i]) == NULL)
            return NULL;
    pel_rigid_sum_set_contact(&sum, rigids, contact->vertices, weights, normal, positions);
    pel_rigid_row *row = is_known ? &rigids->rows[contact->row] : pel_rigid_rows_add(rigids);
    if (row == NULL || !pel_rigid_row_set(row, rigids, &sum, start))
        return NULL;
    contact->row = (int32_t)(row - rigids->rows);
    contact->round = rigids->row_round;
    return row;
}

/* The change of the drag that takes back as much of the way across the normal since the start as friction can hold, by
   the mobility along it; returns the change of the way [m]. A slip loses its share of the normal. */
static double rub(pel_contact *contact, const pel_rigid_row *row, const pel_rigid_sum *sum, const double normal[3],
                  double slip[3], double change[3])
{
    double way[3], drag[3];
    pel_vec3_set(change, 0, 0, 0);
    pel_vec3_along(slip, -pel_vec3_dot(slip, normal), normal, slip);
    pel_vec3_copy(slip, way);
    if (!(pel_vec3_normalize(way) > 0))
        return 0;
    double free = row != NULL ? pel_rigid_row_mobility(row, way) : pel_rigid_sum_mobility(sum, way);
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
    return free * pel_vec3_length(change);
}

/* m, by how much a sum slid in this substep, less what a tool did */
static void find_slip(const pel_contact *contact, const double place[3], const double from[3], double slip[3])
{
    for (int k = 0; k < 3; k++)
        slip[k] = place[k] - from[k] - (double)contact->drift[k];
}

/* friction of what is not rigid alone */
static double rub_sum(const pel_rigids *rigids, pel_contact *contact, pel_record *positions, const pel_record *start,
                      const double normal[3])
{
    pel_rigid_sum sum;
    double slip[3], x[3], from[3] = {0}, change[3];
    sum_contact(&sum, rigids, contact, positions);
    for (int i = 0; i < 4; i++) {
        pel_vertex_position(start, contact->vertices[i], x);
        pel_vec3_along(from, sum.weights[i], x, from);
    }
    pel_rigid_sum_turn_start(&sum, rigids, from);
    find_slip(contact, sum.value, from, slip);
    double slid = rub(contact, NULL, &sum, normal, slip, change);
    pel_rigid_sum_push(&sum, rigids, positions, change);
    return slid;
}

/* The change of the load of a contact that lacks `rest` of its gap: it gives way by `free`. */
static double load_more(pel_contact_list *list, pel_contact *contact, double rest, double free, double *carried)
{
    double load = (double)contact->multiplier;
    double compliance = (double)contact->compliance / (list->substep * list->substep);
    double change = -(rest + compliance * load) / (free + compliance);
    change = change > -load ? change : -load;
    contact->multiplier = (pel_real)(load + change);
    *carried = free * (load + change);
    return change;
}

/* whether it neither pushes nor has to: until its bodies may have closed half of the gap */
static bool is_open(const pel_contact_list *list, pel_contact *contact, const pel_record *positions, double gap)
{
    if (gap < 0 || contact->multiplier > 0)
        return false;
    contact->settled = list->calm < 0 ? 0 : 1 + unrest_of(list->rigids, contact, positions) + 0.5 * gap;
    return true;
}

/* adds a way [m] to the unrest of the bodies of a contact, which rests until they have moved by more */
static void tell_way(const pel_contact_list *list, pel_contact *contact, const pel_record *positions, double way)
{
    contact->settled = way <= list->calm ? 1 + unrest_of(list->rigids, contact, positions) + list->calm : 0;
}

static double project_row(pel_contact_list *list, pel_contact *contact, const pel_rigid_row *row,
                          const pel_record *positions, double *carried)
{
    double normal[3], place[3], push[3], slip[3], change[3], slid = 0, rate = list->rigids->rate;
    pel_contact_read_normal(contact, normal);
    pel_rigid_row_place(row, place);
    double gap = pel_vec3_dot(place, normal) - (double)contact->separation;
    if (is_open(list, contact, positions, gap))
        return 0;
    double free = pel_rigid_row_mobility(row, normal);
    if (!(free > 0))
        return 0;
    double more = load_more(list, contact, gap, free, carried), moved = free * fabs(more);
    pel_vec3_scale(normal, more, push);
    if (contact->friction > 0) {
        pel_rigid_row_follow(row, push, place);
        find_slip(contact, place, row->start, slip);
        slid = rub(contact, row, NULL, normal, slip, change);
        pel_vec3_add(push, change, push);
    }
    pel_rigid_row_push(row, push, rate);
    for (int i = 0; i < 2; i++)
        if (row->sides[i].rigid != NULL)
            row->sides[i].rigid->unrest += moved + slid;
    tell_way(list, contact, positions, moved + slid);
    list->rigid_moved = moved > list->rigid_moved ? moved : list->rigid_moved;
    return moved;
}

double pel_rigid_contact_project(pel_contact_list *list, pel_contact *contact, pel_record *positions,
                                 const pel_record *start, double *carried)
{
    pel_rigid_sum sum;
    double normal[3], impulse[3];
    *carried = 0;
    const pel_rigid_row *row = row_of(list->rigids, contact, positions, start);
    if (row != NULL)
        return project_row(list, contact, row, positions, carried);
    sum_contact(&sum, list->rigids, contact, positions);
    pel_contact_read_normal(contact, normal);
    double gap = pel_vec3_dot(sum.value, normal) - (double)contact->separation;
    if (is_open(list, contact, positions, gap))
        return 0;
    double whole = pel_rigid_sum_mobility(&sum, normal);
    if (!(whole > 0))
        return 0;
    list->is_uneven |= pel_contact_is_uneven(sum.looseness, whole - sum.looseness);
    pel_backing back;
    bool is_backed = pel_contact_find_backing(list, contact, positions, &back);
    double stiffened = is_backed ? back.stiffened : 0, free = whole - stiffened;
    double change = load_more(list, contact, gap + (is_backed ? back.owed : 0), free, carried);
    pel_vec3_scale(normal, change, impulse);
    pel_rigid_sum_push(&sum, list->rigids, positions, impulse);
    if (is_backed)
        pel_contact_answer(&back, positions, change);
    double slid = contact->friction > 0 ? rub_sum(list->rigids, contact, positions, start, normal) : 0;
    double moved = free * fabs(change);
    for (int i = 0; i < sum.grip_count; i++)
        sum.grips[i].rigid->unrest += moved + slid;
    tell_way(list, contact, positions, moved + slid);
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
