/* The vertices of a rigid body in a sum are one point of it times a weight W, its grip: with the pivot p and the arm a
   the sum moves by

       W^2 / M d n + (I^-1 (a x d n)) x a

   under a push d n (Mueller et al. 2020, "Detailed rigid body simulation with extended position based dynamics",
   section 3.3). Momenta are kept beside positions, and change by the same push over the substep.

   Two free bodies that push each other conserve angular momentum: both feel the push at one point, in the middle
   between them, and its arms are those to the pivots at the start of the substep, for a body that goes from p0 by h P /
   M has p x P = p0 x P at the end. */
#include "rigid/sum.h"

#include "math/pose.h"

#include <math.h>

static pel_rigid_grip *find_grip(pel_rigid_sum *sum, pel_rigid *rigid)
{
    for (int i = 0; i < sum->grip_count; i++)
        if (sum->grips[i].rigid == rigid)
            return &sum->grips[i];
    PEL_ASSERT(sum->grip_count < PEL_SUM_GRIPS);
    pel_rigid_settle(rigid);
    sum->grips[sum->grip_count] = (pel_rigid_grip){.rigid = rigid};
    return &sum->grips[sum->grip_count++];
}

static bool are_two_free(const pel_rigid_sum *sum)
{
    const pel_rigid_grip *a = &sum->grips[0], *b = &sum->grips[1];
    return sum->grip_count == 2 && sum->looseness <= 0 && a->weight * b->weight < 0 && a->rigid->shape->is_free &&
           b->rigid->shape->is_free && !a->rigid->is_fixed && !b->rigid->is_fixed;
}

/* m, from the point of the first grip to that of the second, and what they moved apart in this substep */
static void find_between(const pel_rigid_sum *sum, double between[3])
{
    pel_vec3_set(between, 0, 0, 0);
    for (int i = 0; i < 2; i++) {
        const pel_rigid_grip *grip = &sum->grips[i];
        double sign = i == 0 ? -1 : 1;
        pel_vec3_along(between, sign / grip->weight, grip->arm, between);
        pel_vec3_along(between, sign, grip->rigid->started.pivot, between);
    }
}

static void share_point(pel_rigid_sum *sum)
{
    double between[3];
    find_between(sum, between);
    for (int i = 0; i < 2; i++)
        pel_vec3_along(sum->grips[i].arm, (i == 0 ? 0.5 : -0.5) * sum->grips[i].weight, between, sum->grips[i].arm);
}

/* grips, value and looseness */
static void set_grips(pel_rigid_sum *sum, const pel_rigids *rigids, const int32_t *vertices, const double *weights,
                      int count, const pel_record *positions)
{
    *sum = (pel_rigid_sum){.vertices = vertices};
    for (int i = 0; i < count; i++) {
        int32_t v = vertices[i];
        double x[3];
        sum->weights[i] = weights[i];
        if (weights[i] == 0)
            continue;
        pel_rigid *rigid = pel_rigid_of(rigids, v);
        if (rigid != NULL) {
            pel_rigid_grip_add(find_grip(sum, rigid), rigids, v, weights[i]);
            continue;
        }
        pel_vertex_position(positions, v, x);
        pel_vec3_along(sum->value, weights[i], x, sum->value);
        sum->looseness += (double)positions[v][3] * weights[i] * weights[i];
    }
    for (int i = 0; i < sum->grip_count; i++) {
        pel_rigid_grip *grip = &sum->grips[i];
        pel_rigid_grip_turn(grip);
        pel_vec3_add(sum->value, grip->arm, sum->value);
        pel_vec3_along(sum->value, grip->weight, grip->rigid->state.pivot, sum->value);
    }
}

void pel_rigid_sum_set(pel_rigid_sum *sum, const pel_rigids *rigids, const int32_t *vertices, const double *weights,
                       int count, const pel_record *positions)
{
    set_grips(sum, rigids, vertices, weights, count, positions);
    if (are_two_free(sum))
        share_point(sum);
}

void pel_rigid_sum_set_contact(pel_rigid_sum *sum, const pel_rigids *rigids, const int32_t *vertices,
                               const double *weights, const double normal[3], const pel_record *positions)
{
    set_grips(sum, rigids, vertices, weights, PEL_SUM_MOST, positions);
    pel_vec3_copy(normal, sum->normal);
    /* the normal points to the first side: a ball of either weight touches on the side of the other one */
    for (int i = 0; i < PEL_SUM_MOST; i++) {
        double radius = weights[i] != 0 ? pel_rigid_radius(rigids, vertices[i]) : 0;
        for (int g = 0; radius > 0 && g < sum->grip_count; g++)
            if (sum->grips[g].rigid->middle == vertices[i])
                pel_vec3_along(sum->grips[g].touch, -radius * fabs(weights[i]), normal, sum->grips[g].touch);
        sum->has_ball |= radius > 0;
    }
    for (int g = 0; g < sum->grip_count; g++)
        pel_vec3_add(sum->grips[g].arm, sum->grips[g].touch, sum->grips[g].arm);
    if (are_two_free(sum))
        share_point(sum);
}

void pel_rigid_sum_turn_start(const pel_rigid_sum *sum, const pel_rigids *rigids, double start[3])
{
    for (int g = 0; sum->has_ball && g < sum->grip_count; g++) {
        const pel_rigid *rigid = sum->grips[g].rigid;
        /* what changes no momenta goes from the start of the step on */
        const double *rotation = rigids->rate > 0 ? rigid->started.rotation : rigid->before.rotation;
        double local[3] = {0}, was[3];
        for (int k = 0; k < 3; k++)
            pel_vec3_along(local, sum->grips[g].touch[k], rigid->matrix[k], local);
        pel_rotate(rotation, local, was);
        pel_vec3_add(start, was, start);
        pel_vec3_subtract(start, sum->grips[g].touch, start);
    }
}

double pel_rigid_sum_mobility(const pel_rigid_sum *sum, const double direction[3])
{
    double mobility = sum->looseness;
    for (int i = 0; i < sum->grip_count; i++)
        mobility += pel_rigid_mobility(&sum->grips[i], direction);
    return mobility;
}

/* records of loose vertices += inverse mass times weight times a vector */
static void move_loose(const pel_rigid_sum *sum, const pel_rigids *rigids, const pel_record *positions,
                       const double vector[3], pel_record *records)
{
    for (int i = 0; i < PEL_SUM_MOST; i++) {
        if (sum->weights[i] == 0)
            continue;
        int32_t v = sum->vertices[i];
        double share = (double)positions[v][3] * sum->weights[i];
        for (int k = 0; k < 3 && share != 0 && pel_rigid_of(rigids, v) == NULL; k++)
            records[v][k] = (pel_real)((double)records[v][k] + share * vector[k]);
    }
}

void pel_rigid_sum_push(const pel_rigid_sum *sum, const pel_rigids *rigids, pel_record *positions, const double push[3])
{
    move_loose(sum, rigids, positions, push, positions);
    for (int i = 0; i < sum->grip_count; i++)
        pel_rigid_push(&sum->grips[i], push, rigids->rate);
}

void pel_rigid_sum_hit(const pel_rigid_sum *sum, const pel_rigids *rigids, const pel_record *positions,
                       pel_record *velocities, const double impulse[3])
{
    move_loose(sum, rigids, positions, impulse, velocities);
    for (int i = 0; i < sum->grip_count; i++)
        pel_rigid_hit(&sum->grips[i], impulse);
}

void pel_rigid_sum_velocity(const pel_rigid_sum *sum, const pel_rigids *rigids, const pel_record *velocities,
                            double velocity[3])
{
    double own[3];
    pel_vec3_set(velocity, 0, 0, 0);
    for (int i = 0; i < PEL_SUM_MOST; i++) {
        if (sum->weights[i] == 0 || pel_rigid_of(rigids, sum->vertices[i]) != NULL)
            continue;
        pel_vertex_position(velocities, sum->vertices[i], own);
        pel_vec3_along(velocity, sum->weights[i], own, velocity);
    }
    for (int i = 0; i < sum->grip_count; i++) {
        pel_rigid_grip_velocity(&sum->grips[i], own);
        pel_vec3_add(velocity, own, velocity);
    }
}
