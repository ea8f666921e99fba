/* The whole of a set of contacts, checked. */
#include "contact/set.h"

/* weights of a side add up to 1 or -1, normals have the length 1 */
#define ROUNDING ((sizeof(pel_real) == sizeof(double)) ? 1e-9 : 1e-4)

static bool check_groups(const pel_contact_set *set)
{
    int32_t groups = set->def.body_count + set->def.obstacle_count;
    for (int32_t g = 0; g < groups; g++)
        if (!(set->groups[g].thickness > 0) || !(set->groups[g].friction >= 0))
            return false;
    for (int32_t p = 0; p < set->point_count; p++) {
        int32_t group = set->group_of_point[p];
        if (group < 0 || group >= groups || (group >= set->def.body_count) != (p >= set->vertex_count))
            return false;
    }
    return set->point_count >= set->vertex_count;
}

static bool is_before(const pel_contact_key *a, const pel_contact_key *b)
{
    if (a->edge_edge != b->edge_edge)
        return b->edge_edge;
    return a->first < b->first || (a->first == b->first && a->second < b->second);
}

/* points of bodies stand in the contact, those of obstacles weigh nothing there */
static bool check_points(const pel_contact_set *set, const pel_contact_key *key, const pel_contact *contact)
{
    if (key->obstacle < -1 || key->obstacle >= set->def.obstacle_count)
        return false;
    double sum = 0;
    for (int i = 0; i < 4; i++) {
        int32_t point = key->points[i];
        if (point < 0 || point >= set->point_count || contact->vertices[i] < 0 ||
            contact->vertices[i] >= set->vertex_count)
            return false;
        if (point < set->vertex_count ? contact->vertices[i] != point : (double)contact->weights[i] != 0)
            return false;
        sum += (double)contact->weights[i];
    }
    return key->obstacle >= 0 || !(fabs(sum) > ROUNDING);
}

static bool check_contact(const pel_contact_set *set, const pel_contact_key *key, const pel_contact *contact)
{
    double square = 0;
    for (int k = 0; k < 3; k++)
        square += (double)contact->normal[k] * (double)contact->normal[k];
    return check_points(set, key, contact) && !(fabs(square - 1) > ROUNDING) && contact->friction >= 0;
}

bool pel_contact_set_is_valid(const pel_contact_set *set)
{
    const pel_contact_list *list = &set->list;
    if (!check_groups(set) || list->count < 0 || (size_t)list->count > set->capacity ||
        (size_t)list->count > set->key_capacity || list->count > set->def.limit)
        return false;
    for (int32_t c = 0; c < list->count; c++)
        if ((c > 0 && !is_before(&set->keys[c - 1], &set->keys[c])) ||
            !check_contact(set, &set->keys[c], &list->contacts[c]))
            return false;
    return true;
}
