/* The rotation gamma of a triangle's normal about one of its edges, towards the tip, in a frame carried along with the
   edge. With the edge's direction e, the unit normal m, u = m x e towards the tip, the height h, the length L, the foot
   s of the tip on the edge, and for tail, head, tip the weights a = (s - 1, -s, 1) and b = (-1, 1, 0):

       d gamma_i       = -(a_i / h) m
       d2 gamma_ij     = v_ij m^T + m v_ji^T,   v_ij = (a_i a_j / h^2 + b_i b_j / (2 L^2)) u + (a_i b_j / (h L)) e

   from d m = -sum_i (m . d_i) grad lambda_i with grad lambda_i = b_i / L e + a_i / h u. The antisymmetric part of the
   derivative of d gamma, the rotation of the frame, is omitted: it cancels with the triangle across the edge. So the
   dihedral angle has the gradient and Hessian of the sum over both triangles. */
#ifndef PEL_MEASURE_FACE_TURN_H
#define PEL_MEASURE_FACE_TURN_H

#include "math/vec3.h"

typedef struct pel_face_turn {
    double normal[3], inward[3], along[3]; /* m, u, e */
    double inverse_height, inverse_length; /* 0 if there is none */
    double a[3], b[3];
} pel_face_turn;

static inline double pel_inverse_or_zero(double value)
{
    return value > 0 ? 1 / value : 0;
}

static inline pel_face_turn pel_face_turn_of(const double *tail, const double *head, const double *tip)
{
    pel_face_turn turn = {.b = {-1, 1, 0}};
    double to_tip[3];
    pel_vec3_subtract(head, tail, turn.along);
    pel_vec3_subtract(tip, tail, to_tip);
    pel_vec3_cross(turn.along, to_tip, turn.normal);
    double area = pel_vec3_normalize(turn.normal), length = pel_vec3_normalize(turn.along);
    turn.inverse_length = pel_inverse_or_zero(length);
    turn.inverse_height = length * pel_inverse_or_zero(area);
    pel_vec3_cross(turn.normal, turn.along, turn.inward);
    double foot = pel_vec3_dot(to_tip, turn.along) * turn.inverse_length;
    pel_vec3_set(turn.a, foot - 1, -foot, 1);
    return turn;
}

/* d gamma on corner i is this times the normal */
static inline double pel_face_turn_slope(const pel_face_turn *turn, int i)
{
    return -turn->a[i] * turn->inverse_height;
}

/* adds scale v_ij */
static inline void pel_face_turn_add_second(const pel_face_turn *turn, double scale, int i, int j, double v[3])
{
    double h = turn->inverse_height, l = turn->inverse_length;
    double inward = scale * (turn->a[i] * turn->a[j] * h * h + 0.5 * turn->b[i] * turn->b[j] * l * l);
    pel_vec3_along(v, inward, turn->inward, v);
    pel_vec3_along(v, scale * turn->a[i] * turn->b[j] * h * l, turn->along, v);
}

#endif
