/* Mid-edge bending: the shape operator of a triangle from the rotations of its normal towards those of its edges, with
   one rotation per edge as an unknown (Grinspun et al. 2006, the Morley element; theory page, section 16). It is a
   plate's bending with its Poisson's ratio on every mesh.

   Strains. Edge i of a triangle runs from corner i to corner i + 1. alpha_i is the angle by which the normal of the
   triangle is turned about it from the normal of the edge, towards the tip, minus the rest angle. Between two triangles
   with the dihedral angle theta and the edge's unknown xi

       alpha = (theta - theta_rest) / 2 + xi in the first triangle, (theta - theta_rest) / 2 - xi in the second

   and alpha = xi on the boundary. The energy of a triangle is 1/2 alpha^T K alpha with the constant matrix

       K_ij = D |e_i| |e_j| / A ((1 - nu) cos^2(e_i, e_j) + nu)

   Unknowns. The state of an edge is xi; positions and xi determine the energy. The unknowns of an iteration are
   increments of positions and of psi, the rotation of the edge's normal about the edge in a frame that is carried along
   with the edge by parallel transport. With the rotation gamma of a triangle's normal about the edge in that frame

       d alpha = d gamma + d psi in the first triangle, d gamma - d psi in the second,
       d theta = d gamma_first + d gamma_second,     d xi = d psi + (d gamma_first - d gamma_second) / 2

   (d xi = d gamma + d psi on the boundary), so that the element of a triangle has 12 unknowns, its own vertices and
   edges, and no others. psi is not a function of the state (transported frames do not return to themselves): it starts
   at 0 in each iteration, and pel_face_turn_between gives the finite gamma of a step, from which xi follows. The
   Hessian is the exact second derivative along these finite steps.

   Conditions on psi: free on the boundary is a free edge. psi = 0 on an edge whose vertices are held is a clamped edge:
   its normal stays. A given increment turns the clamp. A moment M [N m] on a boundary edge is a force M on psi; unless
   the edge keeps its direction such a moment has no potential, and the derivative of the forces has a part that is not
   symmetric, too (newton/skew.c). */
#ifndef PEL_MEASURE_MIDEDGE_H
#define PEL_MEASURE_MIDEDGE_H

#include "measure/tangent.h"

enum { PEL_MIDEDGE_STRAINS = 3 };

typedef struct pel_midedge {
    double stiffness[6]; /* K, N m: 00, 01, 02, 11, 12, 22 */
} pel_midedge;

/* Bending of a sheet in its axes, over its stiffness D along the first: moments (1, coupling; coupling, across; twist)
   of the curvatures (11, 22, twice 12). The first axis is `axis` of the rest frame. */
typedef struct pel_plate {
    double across, coupling, twist;
    double axis[2];
} pel_plate;

static inline pel_plate pel_plate_isotropic(double poisson)
{
    return (pel_plate){1, poisson, 0.5 * (1 - poisson), {1, 0}};
}

/* K of a triangle with the bending stiffness D [N m] along the first axis of the plate:
   K_ij = |e_i| |e_j| / A v_i^T P v_j with v = (m1^2, m2^2, 2 m1 m2) of the normal m of an edge; for an isotropic plate
   the matrix above. */
pel_midedge pel_midedge_setup(const pel_rest_triangle *rest, double stiffness, const pel_plate *plate);

/* The stiffness against bending about edge `side` (from corner side to side + 1), over D. */
double pel_plate_about_edge(const pel_rest_triangle *rest, int side, const pel_plate *plate);

/* Moments t = K alpha. */
void pel_midedge_moments(const pel_midedge *element, const double alpha[3], double moment[3]);

/* Energy of a triangle at x (9) with its strains; unknowns are the corners (9) and psi of the three edges, whose sign
   is 1 where the triangle is the edge's first, -1 where it is its second. Strains for MIP: the moments. */
double pel_midedge_tangent(const pel_midedge *element, const double alpha[3], const double sign[3], const double *x,
                           const pel_tangent_request *request, const pel_tangent_sum *sum);

/* The angle about the edge of a triangle (tail, head, tip) from its tail to its head, from the triangle's normal to a
   given direction: the alpha of a boundary edge with this normal. */
double pel_midedge_angle(const double x[3][3], const double normal[3]);

#endif
