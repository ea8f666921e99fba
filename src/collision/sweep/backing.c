/* A light vertex between a tool and a heavy body gives way to both: sweeps that solve its contacts one by one move it
   to and fro, and the load on the heavy body grows by the mass of the light one in a sweep. What is left of it acts in
   the next substeps, late, and a load that follows a gap late makes energy: half a kilogram on a cloth jumped higher
   from bounce to bounce. Here the layer of the tool answers within the change of a load. With the inverse mass m of the
   vertex, its weight w in the contact, the compliance c of the support and the product s of both normals, a multiplier
   that grows by d lets the support answer by -m w s d / (m + c), so that the contact gives way by (m w s)^2 / (m + c)
   less than without it.

   Under something heavy the load goes on: through the triangle that a vertex lies on to its corners, to what they lie
   on, and so to the tool, as a force chain that leaves hardly a force on any of the light vertices between. A contact
   moves all multipliers p of its chain at once, by the change d that makes the least of the energy which sweeps lower:

       d = -(sum_s p_s r_s) / (sum_v m_v |F_v|^2 + sum_s c_s p_s^2),

   with the rest r_s = gap + c_s multiplier of the equation of each contact of the chain, and the force F_v that
   they leave on a vertex. That is exact for whatever chain is taken, which only has to be a good one. */
#include "sweep/backing.h"

#include "math/vec3.h"
#include "sweep/sweep_rigid.h"

enum { MOST_NODES = 128 };

/* of the mobilities of the sides of a contact */
#define UNEVEN 8.0
/* of a load: what less of it comes to a vertex goes no farther */
#define LEAST_SHARE 0.01

bool pel_contact_is_uneven(double one, double other)
{
    return one > UNEVEN * other || other > UNEVEN * one;
}

/* ---- supports ---- */

static bool is_alone(const pel_contact *contact)
{
    return contact->weights[0] == 1 && contact->weights[1] == 0 && contact->weights[2] == 0 && contact->weights[3] == 0;
}

/* a vertex goes back to where the layer of a tool holds it, if it does */
static void settle(pel_contact *contact, double rate, pel_record *positions)
{
    pel_record *x = &positions[contact->vertices[0]];
    double normal[3], place[3], load = (double)contact->multiplier, loose = (double)(*x)[3];
    double compliance = rate * (double)contact->compliance;
    pel_contact_read_normal(contact, normal);
    pel_vertex_position(positions, contact->vertices[0], place);
    double change =
        -(pel_vec3_dot(place, normal) - (double)contact->separation + compliance * load) / (loose + compliance);
    change = change > -load ? change : -load;
    contact->multiplier = (pel_real)(load + change);
    for (int k = 0; k < 3; k++)
        (*x)[k] = (pel_real)(place[k] + loose * change * normal[k]);
}

/* the one that carries most, and the one that carries most against it */
static void keep_support(pel_contact *contact, pel_contact *kept[2])
{
    double own[3], normal[3];
    int side = 0;
    if (kept[0] != NULL) {
        pel_contact_read_normal(contact, own);
        pel_contact_read_normal(kept[0], normal);
        side = pel_vec3_dot(own, normal) < 0;
    }
    if (kept[side] == NULL || contact->multiplier > kept[side]->multiplier)
        kept[side] = contact;
    if (kept[1] != NULL && kept[1]->multiplier > kept[0]->multiplier) {
        kept[1] = kept[0];
        kept[0] = contact;
    }
}

void pel_contacts_find_supports(pel_contact_list *list, pel_record *positions, pel_contact **supports)
{
    double rate = 1 / (list->substep * list->substep);
    for (int32_t i = 0, count = pel_contact_list_length(list); i < count; i++) {
        pel_contact *contact = pel_contact_list_at(list, i);
        int32_t v = contact->vertices[0];
        bool alone = is_alone(contact);
        if (!alone && (!list->is_uneven || contact->weights[0] != 1 || !(contact->multiplier > 0)))
            continue;
        if (!(positions[v][3] > 0) || pel_contact_is_rigid(list->rigids, contact))
            continue;
        if (alone)
            settle(contact, rate, positions);
        if (contact->multiplier > 0)
            keep_support(contact, supports + 2 * (size_t)v);
    }
}

/* ---- chains ---- */

/* a vertex and the force that a chain leaves on it, of 1 N s2 on its first contact */
typedef struct node {
    int32_t vertex;
    double force[3];
} node;

typedef struct chain {
    const pel_contact_list *list;
    const pel_contact *contact; /* the first */
    const pel_record *positions;
    pel_backing *back;
    node nodes[MOST_NODES];
    int count;
} chain;

static double looseness(const pel_contact_list *list, const pel_record *positions, int32_t vertex)
{
    return pel_rigid_of(list->rigids, vertex) != NULL ? 0 : (double)positions[vertex][3];
}

/* a contact pushes its vertices by a share of the load; false = there is no room */
static bool push(chain *all, const pel_contact *contact, double share)
{
    double normal[3];
    pel_contact_read_normal(contact, normal);
    if (all->count > MOST_NODES - 4)
        return false;
    for (int i = 0; i < 4; i++) {
        int at = 0;
        if (contact->weights[i] == 0)
            continue;
        while (at < all->count && all->nodes[at].vertex != contact->vertices[i])
            at++;
        if (at == all->count)
            all->nodes[all->count++] = (node){contact->vertices[i], {0, 0, 0}};
        double *force = all->nodes[at].force;
        pel_vec3_along(force, share * (double)contact->weights[i], normal, force);
    }
    return true;
}

/* The contact that holds a vertex against a force, null = there is none. Of two tools the one that carries more holds
   it. */
static pel_contact *find_support(const chain *all, const node *from, bool only_tools)
{
    for (int side = 0; side < (only_tools ? 1 : 2); side++) {
        pel_contact *support = all->list->supports[2 * (size_t)from->vertex + (size_t)side];
        double own[3];
        if (support == NULL || support == all->contact || !(support->multiplier > 0))
            continue;
        pel_contact_read_normal(support, own);
        /* two that push to the same side share a load, and share it badly if one takes it all */
        if (pel_vec3_dot(from->force, own) < 0 && (!only_tools || is_alone(support)))
            return support;
    }
    return NULL;
}

/* m, of the equation of a contact */
static double rest_of(const pel_contact *contact, double compliance, const pel_record *positions)
{
    double rest = compliance * (double)contact->multiplier - (double)contact->separation, normal[3], x[3];
    pel_contact_read_normal(contact, normal);
    for (int i = 0; i < 4; i++) {
        if (contact->weights[i] == 0)
            continue;
        pel_vertex_position(positions, contact->vertices[i], x);
        rest += (double)contact->weights[i] * pel_vec3_dot(x, normal);
    }
    return rest;
}

/* the load on a vertex goes on to its support */
static void pass_on(chain *all, int from, bool only_tools)
{
    pel_backing *back = all->back;
    double loose = looseness(all->list, all->positions, all->nodes[from].vertex), normal[3];
    pel_contact *support = loose > 0 ? find_support(all, &all->nodes[from], only_tools) : NULL;
    if (support == NULL || back->count == PEL_BACKING_MOST)
        return;
    pel_contact_read_normal(support, normal);
    double compliance = (double)support->compliance / (all->list->substep * all->list->substep);
    double share = -pel_vec3_dot(all->nodes[from].force, normal) * loose / (loose + compliance);
    if (share < LEAST_SHARE || !push(all, support, share))
        return;
    back->supports[back->count] = support;
    back->answers[back->count++] = share;
    back->stiffened -= compliance * share * share;
    /* tools have just been settled */
    if (!is_alone(support))
        back->owed += share * rest_of(support, compliance, all->positions);
}

/* whether a vertex is on the side of a contact with positive weights, or on the other */
static bool has_weight(const pel_contact *contact, int32_t vertex, bool is_positive)
{
    for (int i = 0; i < 4; i++)
        if (contact->vertices[i] == vertex && contact->weights[i] != 0)
            return (contact->weights[i] > 0) == is_positive;
    return false;
}

/* whether tools hold a side of the contact, the one with positive weights or the other */
static void find_sides(const chain *all, bool sides[2])
{
    for (int i = 0; i < all->count; i++)
        sides[has_weight(all->contact, all->nodes[i].vertex, true)] |= find_support(all, &all->nodes[i], true) != NULL;
}

/* whether a chain may begin: something holds a vertex of the contact, a tool if both sides are alike */
static bool is_held(const chain *all, bool is_uneven)
{
    for (int i = 0; i < 4; i++) {
        pel_contact *const *kept = all->list->supports + 2 * (size_t)all->contact->vertices[i];
        if (all->contact->weights[i] != 0 && kept[0] != NULL && (is_uneven || is_alone(kept[0])))
            return true;
    }
    return false;
}

static void find_chain(chain *all, const double mobilities[2], bool is_uneven)
{
    pel_backing *back = all->back;
    int first = all->count;
    for (int i = 0; i < (is_uneven ? all->count : first); i++)
        if (!is_uneven || i >= first || has_weight(all->contact, all->nodes[i].vertex, mobilities[1] > mobilities[0]))
            pass_on(all, i, !is_uneven);
    back->stiffened += mobilities[0] + mobilities[1];
    for (int i = 0; i < all->count; i++)
        back->stiffened -=
            looseness(all->list, all->positions, all->nodes[i].vertex) * pel_vec3_squared_length(all->nodes[i].force);
}

bool pel_contact_find_backing(const pel_contact_list *list, const pel_contact *contact, const pel_record *positions,
                              pel_backing *back)
{
    double mobilities[2] = {0, 0};
    bool sides[2] = {false, false}, has_side[2] = {false, false};
    chain all;
    if (list->supports == NULL)
        return false;
    all.list = list;
    all.contact = contact;
    all.positions = positions;
    all.back = back;
    all.count = back->count = 0;
    back->stiffened = back->owed = 0;
    for (int i = 0; i < 4; i++)
        if (contact->weights[i] != 0) {
            double weight = (double)contact->weights[i];
            mobilities[weight > 0] += weight * weight * looseness(list, positions, contact->vertices[i]);
            has_side[weight > 0] = true;
        }
    /* a tool presses by itself, and is no load that goes on */
    bool is_uneven = has_side[0] && has_side[1] && pel_contact_is_uneven(mobilities[0], mobilities[1]);
    if (!is_held(&all, is_uneven))
        return false;
    push(&all, contact, 1);
    find_sides(&all, sides);
    /* between two tools there is nothing heavy, and no more room than they leave */
    if (sides[0] && sides[1])
        return false;
    find_chain(&all, mobilities, is_uneven);
    return back->count > 0;
}

void pel_contact_answer(const pel_backing *back, pel_record *positions, double change)
{
    for (int i = 0; i < back->count; i++) {
        pel_contact *support = back->supports[i];
        double load = (double)support->multiplier, more = back->answers[i] * change;
        more = more > -load ? more : -load;
        support->multiplier = (pel_real)(load + more);
        for (int j = 0; j < 4; j++) {
            pel_record *x = &positions[support->vertices[j]];
            double way = (double)(*x)[3] * (double)support->weights[j] * more;
            for (int k = 0; k < 3 && way != 0; k++)
                (*x)[k] = (pel_real)((double)(*x)[k] + way * (double)support->normal[k]);
        }
    }
}
