/* The distances that pairs keep. Kin are pairs whose parts had a vertex in common before a cut. The lips of a fresh cut
   lie side by side, nearer than any thickness, and may stay so: of the thickness kin keep only a share, a small part of
   the shortest edge. Pairs across a cut that are no kin were apart before it and keep what all others do. */
#include "contact/set.h"

#include "base/assert.h"
#include "math/extremes.h"

/* of the shortest edge: opening a cut by it strains the body little, and single precision resolves it */
#define KIN_SHARE 1e-3
/* of the thickness at most: half of it is less than what the guard keeps free around each lip */
#define MOST_SHARE 0.4

double pel_contact_thickness(const pel_contact_set *set, int32_t a, int32_t b)
{
    PEL_ASSERT_INDEX(a, set->def.body_count + set->def.obstacle_count);
    PEL_ASSERT_INDEX(b, set->def.body_count + set->def.obstacle_count);
    return 0.5 * (set->groups[a].thickness + set->groups[b].thickness);
}

static bool is_kin(const pel_contact_set *set, const int32_t points[4])
{
    const int32_t *origins = set->def.origin_of_vertex;
    for (int i = 0; origins != NULL && i < 4; i++)
        for (int k = 0; k < i; k++)
            if (points[i] < set->vertex_count && points[k] < set->vertex_count &&
                origins[points[i]] == origins[points[k]])
                return true;
    return false;
}

double pel_contact_kin_share(const pel_contact_set *set, int32_t body)
{
    return pel_min(MOST_SHARE, KIN_SHARE * set->def.shortest_edge / set->groups[body].thickness);
}

double pel_contact_pair_share(const pel_contact_set *set, const int32_t points[4])
{
    return is_kin(set, points) ? pel_contact_kin_share(set, set->group_of_point[points[0]]) : 1;
}

double pel_contact_pair_thickness(const pel_contact_set *set, const int32_t points[4])
{
    const int32_t *group = set->group_of_point;
    return pel_contact_pair_share(set, points) * pel_contact_thickness(set, group[points[0]], group[points[3]]);
}

bool pel_contact_sleeps(const pel_contact_set *set, const int32_t points[4])
{
    const int32_t *group = set->group_of_point;
    return set->asleep_count > 0 && set->is_asleep[group[points[0]]] && set->is_asleep[group[points[3]]];
}

double pel_contact_friction(const pel_contact_set *set, int32_t a, int32_t b)
{
    PEL_ASSERT_INDEX(a, set->def.body_count + set->def.obstacle_count);
    PEL_ASSERT_INDEX(b, set->def.body_count + set->def.obstacle_count);
    double first = set->groups[a].friction, second = set->groups[b].friction;
    return first == second ? first : sqrt(first * second);
}
