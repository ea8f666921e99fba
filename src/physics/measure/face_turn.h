/* The rotation gamma of a triangle's normal about one of its edges, towards the tip, in a frame carried along with the
   edge. With the edge's direction e, the unit normal m, u = m x e towards the tip, the height h, the length L, the foot
   s of the tip on the edge, and for tail, head, tip the weights a = (s - 1, -s, 1) and b = (-1, 1, 0):

       d gamma_i       = -(a_i / h) m
       d2 gamma_ij     = v_ij m^T + m v_ji^T,   v_ij = (a_i a_j / h^2 + b_i b_j / (2 L^2)) u + (a_i b_j / (h L)) e

   from d m = -sum_i (m . d_i) grad lambda_i with grad lambda_i = b_i / L e + a_i / h u. The antisymmetric part of the
   derivative of d gamma, the rotation of the frame, is omitted: it cancels with the triangle across the edge. So the
   dihedral angle has the gradient and Hessian of the sum over both triangles. In lanes (base/lane.h). */
#ifndef PEL_MEASURE_FACE_TURN_H
#define PEL_MEASURE_FACE_TURN_H

#include "base/lane.h"

typedef struct pel_face_turn {
    pel_lane3 normal, inward, along;         /* m, u, e */
    pel_lane inverse_height, inverse_length; /* 0 if there is none */
    pel_lane a[3], b[3];
} pel_face_turn;

PEL_INLINE pel_face_turn pel_face_turn_of(pel_lane3 tail, pel_lane3 head, pel_lane3 tip)
{
    const pel_lane one = pel_lane_splat(1), zero = pel_lane_splat(0);
    pel_face_turn turn = {.b = {-one, one, zero}};
    const pel_lane3 edge = pel_lane3_subtract(head, tail), to_tip = pel_lane3_subtract(tip, tail);
    const pel_lane3 normal = pel_lane3_cross(edge, to_tip);
    const pel_lane area = pel_lane_sqrt(pel_lane3_dot(normal, normal)),
                   length = pel_lane_sqrt(pel_lane3_dot(edge, edge));
    const pel_lane inverse_area = pel_lane_quotient(one, area);
    turn.inverse_length = pel_lane_quotient(one, length);
    turn.inverse_height = length * inverse_area;
    turn.normal = pel_lane3_scale(normal, inverse_area);
    turn.along = pel_lane3_scale(edge, turn.inverse_length);
    turn.inward = pel_lane3_cross(turn.normal, turn.along);
    const pel_lane foot = pel_lane3_dot(to_tip, turn.along) * turn.inverse_length;
    turn.a[0] = foot - one;
    turn.a[1] = -foot;
    turn.a[2] = one;
    return turn;
}

/* d gamma on corner i is this times the normal */
PEL_INLINE pel_lane pel_face_turn_slope(const pel_face_turn *turn, int i)
{
    return -turn->a[i] * turn->inverse_height;
}

/* v plus scale v_ij */
PEL_INLINE pel_lane3 pel_face_turn_add_second(const pel_face_turn *turn, pel_lane scale, int i, int j, pel_lane3 v)
{
    const pel_lane h = turn->inverse_height, l = turn->inverse_length;
    const pel_lane inward =
        scale * (turn->a[i] * turn->a[j] * h * h + PEL_CONSTANT(0.5) * turn->b[i] * turn->b[j] * l * l);
    v = pel_lane3_add(v, pel_lane3_scale(turn->inward, inward));
    return pel_lane3_add(v, pel_lane3_scale(turn->along, scale * turn->a[i] * turn->b[j] * h * l));
}

/* the direction that `vector`, normal to the unit vector `from`, takes when the frame goes from there to `to` by the
   shortest rotation */
PEL_INLINE pel_lane3 pel_face_turn_transport(pel_lane3 vector, pel_lane3 from, pel_lane3 to)
{
    const pel_lane one = pel_lane_splat(1), along = one + pel_lane3_dot(from, to);
    const pel_lane3 axis = pel_lane3_cross(from, to), turned = pel_lane3_cross(axis, vector);
    const pel_lane lift = pel_lane3_dot(axis, vector) * pel_lane_quotient(one, along);
    return pel_lane3_add(pel_lane3_combine(along - one, vector, one, turned), pel_lane3_scale(axis, lift));
}

/* the angle from a direction to the normal of a triangle about its edge, towards the tip; a part of the direction along
   the edge does not count */
PEL_INLINE pel_lane pel_face_turn_from(pel_lane3 direction, const pel_face_turn *turn)
{
    const pel_lane3 side = pel_lane3_cross(direction, turn->along);
    return pel_lane_atan2(pel_lane3_dot(turn->normal, side), pel_lane3_dot(turn->normal, direction));
}

/* gamma of a finite step: the rotation of the normal about the edge in the frame that is transported with it */
PEL_INLINE pel_lane pel_face_turn_between(const pel_face_turn *first, const pel_face_turn *last)
{
    return pel_face_turn_from(pel_face_turn_transport(first->normal, first->along, last->along), last);
}

#endif
