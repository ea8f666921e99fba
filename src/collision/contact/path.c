/* Ways of points in a step: straight, and along the path of rigid bodies through the substeps. */
#include "contact/set.h"
#include "geom/wide4.h"

#include <string.h>

/* what both sides have in common brings them no nearer: closest points are means of the points of either side */
double pel_contact_longest_approach(const pel_contact_set *set, const pel_collision *hit)
{
    wide4 way[4];
    double most = 0;
    int middle = hit->edge_edge ? 2 : 1;
    /* points are read four numbers at once */
    for (int i = 0; i < 4; i++) {
        wide4 start, end;
        memcpy(&start, set->start[hit->vertices[i]], sizeof start);
        memcpy(&end, set->end[hit->vertices[i]], sizeof end);
        way[i] = end - start;
    }
    for (int i = 0; i < middle; i++)
        for (int j = middle; j < 4; j++) {
            wide4 apart = way[i] - way[j], squares = apart * apart;
            double square = squares[0] + squares[1] + squares[2];
            most = square > most ? square : most;
        }
    return sqrt(most);
}

double pel_contact_longest_way(const pel_contact_set *set)
{
    double square = 0;
    for (int32_t p = 0; p < set->point_count; p++) {
        double way[3];
        pel_vec3_subtract(set->end[p], set->start[p], way);
        double own = pel_vec3_squared_length(way);
        square = own > square ? own : square;
    }
    return sqrt(square);
}

void pel_contact_place_between(const pel_contact_set *set, const int32_t points[4], double share, double x[4][3])
{
    for (int i = 0; i < 4; i++) {
        int32_t v = points[i];
        const pel_rigid *rigid = v < set->vertex_count ? pel_rigid_of(set->def.rigids, v) : NULL;
        if (rigid != NULL && share > 0 && share < 1)
            pel_rigid_place_between(rigid, set->def.rigids, v, share, x[i]);
        else
            for (int k = 0; k < 3; k++)
                x[i][k] = share < 1 ? set->start[v][k] + share * (set->end[v][k] - set->start[v][k]) : set->end[v][k];
    }
}

int pel_contact_count_knots(const pel_contact_set *set, const int32_t points[4])
{
    int knots = 0;
    for (int i = 0; i < 4 && set->def.rigids != NULL; i++) {
        const pel_rigid *rigid = points[i] < set->vertex_count ? pel_rigid_of(set->def.rigids, points[i]) : NULL;
        if (rigid != NULL && rigid->path_count >= knots)
            knots = rigid->path_count + 1;
    }
    return knots;
}
