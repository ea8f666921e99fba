/* Rotations as unit quaternions (x, y, z, w), and poses of rigid things. */
#ifndef PEL_MATH_POSE_H
#define PEL_MATH_POSE_H

#include "math/functions.h"
#include "math/vec3.h"

/* rotated (3) = q v q^-1; may be v itself */
static inline void pel_rotate(const double q[4], const double v[3], double rotated[3])
{
    double t[3], u[3];
    pel_vec3_cross(q, v, t);
    pel_vec3_scale(t, 2, t);
    pel_vec3_cross(q, t, u);
    for (int i = 0; i < 3; i++)
        rotated[i] = v[i] + q[3] * t[i] + u[i];
}

static inline void pel_rotate_back(const double q[4], const double v[3], double rotated[3])
{
    const double inverse[4] = {-q[0], -q[1], -q[2], q[3]};
    pel_rotate(inverse, v, rotated);
}

/* product (4) = a b: first b, then a; may be either of them */
static inline void pel_rotation_product(const double a[4], const double b[4], double product[4])
{
    const double w = a[3] * b[3] - pel_vec3_dot(a, b);
    double v[3];
    pel_vec3_cross(a, b, v);
    for (int i = 0; i < 3; i++)
        product[i] = a[3] * b[i] + b[3] * a[i] + v[i];
    product[3] = w;
}

/* quaternion of a rotation vector: axis times angle [rad], of any length */
static inline void pel_rotation_exp(const double vector[3], double q[4])
{
    double angle = pel_vec3_length(vector), scale = angle > 0 ? pel_sin(0.5 * angle) / angle : 0.5;
    pel_vec3_scale(vector, scale, q);
    q[3] = pel_cos(0.5 * angle);
}

/* Rotation vector [rad] from a to b. Its angle is known up to whole turns: of all that lead from a to b the one nearest
   to `expected` is taken, so a null vector gives the shorter arc. */
static inline void pel_rotation_between(const double a[4], const double b[4], const double expected[3],
                                        double vector[3])
{
    const double full = 6.283185307179586476925, back[4] = {-a[0], -a[1], -a[2], a[3]};
    double q[4], axis[3];
    pel_rotation_product(b, back, q);
    double sine = pel_vec3_length(q), angle = 2 * pel_atan2(sine, q[3]), length = pel_vec3_length(expected);
    if (sine > 1e-12)
        pel_vec3_scale(q, 1 / sine, axis);
    else if (length > 0)
        pel_vec3_scale(expected, 1 / length, axis); /* whole turns, about any axis */
    else
        pel_vec3_set(axis, 0, 0, 0);
    pel_vec3_scale(axis, angle + full * rint((pel_vec3_dot(expected, axis) - angle) / full), vector);
}

/* rotated (4) = q turned by share times a rotation vector; may be q itself */
static inline void pel_rotation_turn(const double q[4], const double vector[3], double share, double rotated[4])
{
    double part[3], turn[4];
    pel_vec3_scale(vector, share, part);
    pel_rotation_exp(part, turn);
    pel_rotation_product(turn, q, rotated);
    double length = sqrt(pel_vec3_dot(rotated, rotated) + rotated[3] * rotated[3]);
    for (int i = 0; i < 4; i++)
        rotated[i] /= length;
}

typedef struct pel_pose {
    double position[3];
    double rotation[4]; /* x, y, z, w */
    double spin[3];     /* sum of the rotation vectors [rad] up to this pose: distinguishes whole turns from none */
    double along;       /* m, of what changes its shape: the way of its fastest point up to this pose */
} pel_pose;

static inline void pel_pose_to_local(const pel_pose *pose, const double world[3], double local[3])
{
    pel_vec3_subtract(world, pose->position, local);
    pel_rotate_back(pose->rotation, local, local);
}

static inline void pel_pose_to_world(const pel_pose *pose, const double local[3], double world[3])
{
    pel_rotate(pose->rotation, local, world);
    pel_vec3_add(world, pose->position, world);
}

/* As pel_pose_to_world, but between two poses the point stays behind along a line (two points of the frame). */
static inline void pel_pose_slide(const pel_pose *from, const pel_pose *to, const double line[2][3],
                                  const double local[3], double world[3])
{
    double along[3], way[3];
    pel_vec3_subtract(line[1], line[0], along);
    pel_rotate(to->rotation, along, along);
    pel_vec3_normalize(along);
    pel_pose_to_world(from, local, way);
    pel_pose_to_world(to, local, world);
    pel_vec3_subtract(way, world, way);
    pel_vec3_along(world, pel_vec3_dot(way, along), along, world);
}

/* rotation vector [rad] from a to b, whole turns included */
static inline void pel_pose_turn(const pel_pose *a, const pel_pose *b, double turn[3])
{
    double spin[3];
    pel_vec3_subtract(b->spin, a->spin, spin);
    pel_rotation_between(a->rotation, b->rotation, spin, turn);
}

/* a pose between two; share 0 and 1 give them exactly */
static inline void pel_pose_between(const pel_pose *a, const pel_pose *b, double share, pel_pose *pose)
{
    if (share >= 1 || share <= 0) {
        *pose = share >= 1 ? *b : *a;
        return;
    }
    double turn[3];
    pel_pose_turn(a, b, turn);
    pel_rotation_turn(a->rotation, turn, share, pose->rotation);
    for (int i = 0; i < 3; i++) {
        pose->spin[i] = a->spin[i] + share * turn[i];
        pose->position[i] = a->position[i] + share * (b->position[i] - a->position[i]);
    }
    pose->along = a->along + share * (b->along - a->along);
}

/* m: displacement of the position, plus those by rotation of a point at a distance `radius` from it and by the shape */
static inline double pel_pose_way(const pel_pose *a, const pel_pose *b, double radius)
{
    double turn[3];
    pel_pose_turn(a, b, turn);
    return pel_vec3_distance(a->position, b->position) + pel_vec3_length(turn) * radius + fabs(b->along - a->along);
}

#endif
