/* Balls: rigid bodies that collide as the sphere about their mesh, which lies inside. A ball is one point, its middle,
   that keeps its radius from all else. A ball before a triangle is a vertex before it, whose gap is less by the radius:
   corners and edges are nearest points of the triangle too, so that one pair is all there is. Two balls are a vertex
   before another one, written as a triangle of three equal corners; the feature of the second one has the number of
   triangles plus its own. Tools that are boxes or meshes have triangles; spheres and capsules are a point or a segment
   with a radius.

   So lists, sweeps, loads, sleep and the guard know nothing of balls but the radius that a gap has less. Normals of
   spheres turn smoothly: a ball rolls without bumps. What touches is not the middle, though: friction acts, and slips,
   at the arm -r n (rigid/sum.c). */
#include "contact/set.h"

#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"

pel_status pel_contact_balls_create(pel_contact_set *set, pel_error *error)
{
    int32_t count = set->def.rigids != NULL && set->def.has_layers ? set->def.rigids->count : 0;
    if (!PEL_ALLOCATE_ALL(PEL_ROOM(set->balls, count), PEL_ROOM(set->ball_order, count)))
        return pel_fail_memory(error);
    for (int32_t i = 0; i < count; i++) {
        pel_rigid *rigid = &set->def.rigids->items[i];
        rigid->radius = rigid->shape->radius;
        if (!(rigid->radius > 0))
            continue;
        set->balls[set->ball_count] = (pel_contact_ball){.point = rigid->middle, .radius = rigid->radius};
        set->ball_order[set->ball_count] = set->ball_count;
        set->ball_count++;
    }
    return PEL_OK;
}

double pel_contact_pair_radius(const pel_contact_set *set, const int32_t points[4])
{
    double radius = 0;
    for (int i = 0; i < 4 && set->ball_count > 0; i += 3)
        if (points[i] < set->vertex_count)
            radius += pel_rigid_radius(set->def.rigids, points[i]);
    return radius;
}

int32_t pel_contact_ball_point(const pel_contact_set *set, int32_t second)
{
    return set->balls[second - set->triangle_count].point;
}
