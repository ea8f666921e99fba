/* A light vertex between a tool and a heavy body gives way to both: sweeps that solve its contacts one by one move it
   to and fro, and the load on the heavy body grows by the mass of the light one in a sweep. What is left of it acts in
   the next substeps, late, and a load that follows a gap late makes energy: half a kilogram on a cloth jumped higher
   from bounce to bounce. Here the layer of the tool answers within the change of a load. With the inverse mass m of the
   vertex, its weight w in the contact, the compliance c of the support and the product s of both normals, a multiplier
   that grows by d lets the support answer by -m w s d / (m + c), so that the contact gives way by (m w s)^2 / (m + c)
   less than without it. */
#include "contact/backing.h"

#include "math/vec3.h"

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

void pel_contacts_find_supports(pel_contact_list *list, pel_record *positions, pel_contact **supports)
{
    double rate = 1 / (list->substep * list->substep);
    for (int32_t i = 0, count = pel_contact_list_length(list); i < count; i++) {
        pel_contact *contact = pel_contact_list_at(list, i);
        int32_t v = contact->vertices[0];
        bool is_alone = contact->weights[0] == 1 && contact->weights[1] == 0 && contact->weights[2] == 0 &&
                        contact->weights[3] == 0;
        if (!is_alone || !(positions[v][3] > 0) || pel_rigid_of(list->rigids, v) != NULL)
            continue;
        settle(contact, rate, positions);
        if (!(contact->multiplier > 0))
            continue;
        if (supports[v] == NULL || contact->multiplier > supports[v]->multiplier)
            supports[v] = contact;
    }
}

bool pel_contact_find_backing(const pel_contact_list *list, const pel_contact *contact, const pel_record *positions,
                              pel_backing *back)
{
    double rate = 1 / (list->substep * list->substep), normal[3];
    pel_contact_read_normal(contact, normal);
    bool is_backed = false, sides[2] = {false, false};
    for (int i = 0; i < 4 && list->supports != NULL; i++) {
        int32_t v = contact->vertices[i];
        double weight = (double)contact->weights[i], loose = (double)positions[v][3], own[3];
        pel_contact *support = weight != 0 ? list->supports[v] : NULL;
        if (support == NULL || support == contact || !(support->multiplier > 0))
            continue;
        pel_contact_read_normal(support, own);
        double coupled = loose * weight * pel_vec3_dot(normal, own);
        double free = loose + rate * (double)support->compliance;
        /* two that push to the same side share a load, and share it badly if one takes it all */
        if (!(coupled < 0))
            continue;
        if (!is_backed)
            *back = (pel_backing){0};
        is_backed = true;
        back->supports[i] = support;
        back->answers[i] = -coupled / free;
        back->stiffened += coupled * coupled / free;
        sides[weight > 0] = true;
    }
    /* between two tools there is nothing heavy, and no more room than they leave */
    return is_backed && !(sides[0] && sides[1]);
}

void pel_contact_answer(const pel_backing *back, pel_record *positions, double change)
{
    for (int i = 0; i < 4; i++) {
        pel_contact *support = back->supports[i];
        if (support == NULL)
            continue;
        pel_record *x = &positions[support->vertices[0]];
        double load = (double)support->multiplier, more = back->answers[i] * change;
        more = more > -load ? more : -load;
        support->multiplier = (pel_real)(load + more);
        for (int k = 0; k < 3; k++)
            (*x)[k] = (pel_real)((double)(*x)[k] + (double)(*x)[3] * more * (double)support->normal[k]);
    }
}
