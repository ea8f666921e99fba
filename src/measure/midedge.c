/* Bending by angles: the hinge, and mid-edge bending with rotations of edges. */
#include "measure/midedge.h"

#include "math/functions.h"
#include "measure/face_turn.h"
#include "measure/strain_point.h"

#include <math.h>
#include <string.h>

/* ---- hinge ---- */

/* adds scale times the Hessian of gamma of a triangle with the corners a, b, c of the element, the last of which is
   skipped if it is 3 */
PEL_ELEMENT_INLINE void add_turn_hessian(const pel_face_turn *turn, int a, int b, int c, double scale,
                                         pel_lead_matrix *lead)
{
    const int corners[3] = {a, b, c}, count = c < 3 ? 3 : 2;
    double v[3][3][3];
    for (int i = 0; i < count; i++)
        for (int j = 0; j < count; j++) {
            pel_vec3_set(v[i][j], 0, 0, 0);
            pel_face_turn_add_second(turn, scale, i, j, v[i][j]);
        }
    for (int i = 0; i < count; i++)
        for (int j = 0; j < count; j++) {
            pel_lead_add_product(lead, corners[i], corners[j], v[i][j], turn->normal);
            pel_lead_add_product(lead, corners[i], corners[j], turn->normal, v[j][i]);
        }
}

double pel_angle_from_rest(const double *x, double rest_angle)
{
    const double turn = 6.283185307179586;
    double p[4][3];
    memcpy(p, x, sizeof p);
    double angle = pel_dihedral_angle((const double(*)[3])p, NULL) - rest_angle;
    return fabs(rest_angle) <= 0.25 * turn || fabs(angle) <= 0.5 * turn ? angle : remainder(angle, turn);
}

/* the triangle of a hinge with the corners a, b, c: its part of B, and of the geometric part where a lead is given */
PEL_ELEMENT_INLINE void add_side(const double *x, int a, int b, int c, double stress, pel_strain_point *point,
                                 pel_lead_matrix *lead)
{
    const pel_face_turn turn = pel_face_turn_of(x + 3 * a, x + 3 * b, x + 3 * c);
    const int corners[3] = {a, b, c};
    for (int i = 0; i < 3; i++) {
        double *row = &point->gradient[0][3 * corners[i]];
        pel_vec3_along(row, pel_face_turn_slope(&turn, i), turn.normal, row);
    }
    if (lead != NULL)
        add_turn_hessian(&turn, a, b, c, stress, lead);
}

double pel_hinge_tangent(const pel_hinge *hinge, double stiffness, const double *x, const pel_tangent_request *request,
                         const pel_tangent_sum *sum)
{
    double factor = stiffness * hinge->factor, angle = pel_angle_from_rest(x, hinge->rest_angle);
    pel_strain_point point;
    point.energy = 0.5 * factor * angle * angle;
    if (sum->gradient == NULL && sum->hessian == NULL && request->extrapolated == NULL)
        return point.energy;
    point.stress[0] = factor * angle;
    point.tangent[0][0] = factor;
    memset(point.gradient[0], 0, sizeof point.gradient[0]);
    pel_lead_matrix lead;
    if (sum->hessian != NULL)
        pel_lead_clear(&lead, 4);
    bool is_geometric = sum->hessian != NULL && request->kind != PEL_TANGENT_POSITIVE;
    double stress = is_geometric ? pel_strain_geometric(&point, request)[0] : 0;
    add_side(x, 0, 1, 2, stress, &point, is_geometric ? &lead : NULL);
    add_side(x, 1, 0, 3, stress, &point, is_geometric ? &lead : NULL);
    pel_strain_add(&point, PEL_HINGE_STRAINS, 4, 0, &lead, request, sum);
    return point.energy;
}

/* ---- mid-edge ---- */

pel_midedge pel_midedge_setup(const pel_rest_triangle *rest, double stiffness, double poisson)
{
    /* corners in the rest frame, from the inverse of [X0 - X2, X1 - X2] */
    const double *inverse = rest->inverse;
    const double corner[3][2] = {
        {1 / inverse[0], 0}, {-inverse[1] / (inverse[0] * inverse[2]), 1 / inverse[2]}, {0, 0}};
    double edge[3][2], length[3];
    for (int i = 0; i < 3; i++) {
        for (int c = 0; c < 2; c++)
            edge[i][c] = corner[(i + 1) % 3][c] - corner[i][c];
        length[i] = pel_hypot(edge[i][0], edge[i][1]);
    }
    pel_midedge element;
    for (int i = 0, k = 0; i < 3; i++)
        for (int j = i; j < 3; j++) {
            double size = length[i] * length[j], cosine = (edge[i][0] * edge[j][0] + edge[i][1] * edge[j][1]) / size;
            element.stiffness[k++] = stiffness * size / rest->area * ((1 - poisson) * cosine * cosine + poisson);
        }
    return element;
}

void pel_midedge_moments(const pel_midedge *element, const double alpha[3], double moment[3])
{
    const double *k = element->stiffness;
    moment[0] = k[0] * alpha[0] + k[1] * alpha[1] + k[2] * alpha[2];
    moment[1] = k[1] * alpha[0] + k[3] * alpha[1] + k[4] * alpha[2];
    moment[2] = k[2] * alpha[0] + k[4] * alpha[1] + k[5] * alpha[2];
}

/* sum over the edges of moment times the Hessian of gamma; all share one normal */
static void add_turns(const pel_face_turn turn[3], const double moment[3], pel_lead_matrix *lead)
{
    double v[2][2][3];
    memset(v, 0, sizeof v);
    /* edge l has tail l, head l + 1, tip l + 2 */
    for (int l = 0; l < 3; l++)
        for (int i = 0; i < 2; i++)
            for (int j = 0; j < 2; j++)
                pel_face_turn_add_second(&turn[l], moment[l], (i + 3 - l) % 3, (j + 3 - l) % 3, v[i][j]);
    for (int i = 0; i < 2; i++)
        for (int j = 0; j < 2; j++) {
            pel_lead_add_product(lead, i, j, v[i][j], turn[0].normal);
            pel_lead_add_product(lead, i, j, turn[0].normal, v[j][i]);
        }
}

double pel_midedge_tangent(const pel_midedge *element, const double alpha[3], const double sign[3], const double *x,
                           const pel_tangent_request *request, const pel_tangent_sum *sum)
{
    pel_face_turn turn[3];
    pel_strain_point point;
    pel_midedge_moments(element, alpha, point.stress);
    point.energy = 0.5 * pel_vec3_dot(alpha, point.stress);
    if (sum->gradient == NULL && sum->hessian == NULL && request->extrapolated == NULL)
        return point.energy;
    pel_lead_matrix lead;
    if (sum->hessian != NULL)
        pel_lead_clear(&lead, 3);
    pel_strain_tangent_set(element->stiffness, 1, &point);
    for (int l = 0; l < 3; l++) {
        turn[l] = pel_face_turn_of(x + 3 * l, x + 3 * ((l + 1) % 3), x + 3 * ((l + 2) % 3));
        for (int i = 0; i < 3; i++)
            pel_vec3_scale(turn[l].normal, pel_face_turn_slope(&turn[l], i), &point.gradient[l][3 * ((l + i) % 3)]);
        for (int k = 0; k < 3; k++)
            point.gradient[l][9 + k] = k == l ? sign[l] : 0;
    }
    if (sum->hessian != NULL && request->kind != PEL_TANGENT_POSITIVE)
        add_turns(turn, pel_strain_geometric(&point, request), &lead);
    pel_strain_add(&point, PEL_MIDEDGE_STRAINS, 3, 3, &lead, request, sum);
    return point.energy;
}

/* the direction that `vector`, normal to the unit vector `from`, takes when the frame goes from there to `to` by the
   shortest rotation */
static void transport(const double vector[3], const double from[3], const double to[3], double moved[3])
{
    double axis[3], turned[3], along = 1 + pel_vec3_dot(from, to);
    pel_vec3_cross(from, to, axis);
    pel_vec3_cross(axis, vector, turned);
    double lift = pel_vec3_dot(axis, vector) * pel_inverse_or_zero(along);
    for (int c = 0; c < 3; c++)
        moved[c] = (along - 1) * vector[c] + turned[c] + lift * axis[c];
}

/* the angle from a direction to the normal of a triangle about its edge, towards the tip; a part of the direction along
   the edge does not count */
static double turn_from(const double direction[3], const pel_face_turn *turn)
{
    double side[3];
    pel_vec3_cross(direction, turn->along, side);
    return pel_atan2(pel_vec3_dot(turn->normal, side), pel_vec3_dot(turn->normal, direction));
}

double pel_midedge_turn(const double before[3][3], const double after[3][3])
{
    const pel_face_turn first = pel_face_turn_of(before[0], before[1], before[2]);
    const pel_face_turn last = pel_face_turn_of(after[0], after[1], after[2]);
    double moved[3];
    transport(first.normal, first.along, last.along, moved);
    return turn_from(moved, &last);
}

double pel_midedge_angle(const double x[3][3], const double normal[3])
{
    const pel_face_turn turn = pel_face_turn_of(x[0], x[1], x[2]);
    return turn_from(normal, &turn);
}
