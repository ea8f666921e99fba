/* Bending by angles: the hinge, and mid-edge bending with rotations of edges. */
#define PEL_LANE_DOUBLE
#include "measure/midedge.h"

#include "math/functions.h"
#include "measure/tangent_triangle.h"

#include <math.h>
#include <string.h>

/* ---- hinge ---- */

static pel_lane3 point_of(const double x[3])
{
    return (pel_lane3){x[0], x[1], x[2]};
}

/* adds scale times the Hessian of gamma of a triangle with the corners a, b, c of the element, the last of which is
   skipped if it is 3 */
PEL_INLINE void add_turn_hessian(const pel_face_turn *turn, int a, int b, int c, double scale, pel_lead_matrix *lead)
{
    const int corners[3] = {a, b, c}, count = c < 3 ? 3 : 2;
    pel_lane3 v[3][3];
    for (int i = 0; i < count; i++)
        for (int j = 0; j < count; j++)
            v[i][j] = pel_face_turn_add_second(turn, scale, i, j, (pel_lane3){0, 0, 0});
    for (int i = 0; i < count; i++)
        for (int j = 0; j < count; j++) {
            pel_lead_add_product(lead, corners[i], corners[j], v[i][j], turn->normal);
            pel_lead_add_product(lead, corners[i], corners[j], turn->normal, v[j][i]);
        }
}

double pel_angle_the_short_way(double angle, double rest_angle)
{
    const double turn = 6.283185307179586, difference = angle - rest_angle;
    return fabs(rest_angle) <= 0.25 * turn || fabs(difference) <= 0.5 * turn ? difference : remainder(difference, turn);
}

double pel_angle_from_rest(const double *x, double rest_angle)
{
    double p[4][3];
    memcpy(p, x, sizeof p);
    return pel_angle_the_short_way(pel_dihedral_angle((const double(*)[3])p, NULL), rest_angle);
}

/* the triangle of a hinge with the corners a, b, c: its part of B, and of the geometric part where a lead is given */
PEL_INLINE void add_side(const double *x, int a, int b, int c, double stress, pel_strain_point *point,
                         pel_lead_matrix *lead)
{
    const pel_face_turn turn = pel_face_turn_of(point_of(x + 3 * a), point_of(x + 3 * b), point_of(x + 3 * c));
    const int corners[3] = {a, b, c};
    for (int i = 0; i < 3; i++) {
        double *row = &point->gradient[0][3 * corners[i]];
        const pel_lane3 part = pel_lane3_scale(turn.normal, pel_face_turn_slope(&turn, i));
        pel_strain_row_set(row, pel_lane3_add(point_of(row), part));
    }
    if (lead != NULL)
        add_turn_hessian(&turn, a, b, c, stress, lead);
}

/* the rest of a hinge, with energy, strain, stress and tangent at its angle */
static double add_angle(const double *x, pel_strain_point *point, const pel_tangent_request *request,
                        const pel_tangent_sum *sum)
{
    pel_strain_damp(point, PEL_HINGE_STRAINS, request);
    if (sum->gradient == NULL && sum->hessian == NULL && request->extrapolated == NULL)
        return point->energy;
    memset(point->gradient[0], 0, sizeof point->gradient[0]);
    pel_lead_matrix lead;
    if (sum->hessian != NULL)
        pel_lead_clear(&lead, 4);
    bool is_geometric = sum->hessian != NULL && request->kind != PEL_TANGENT_POSITIVE;
    double stress = is_geometric ? pel_strain_geometric(point, request)[0] : 0;
    add_side(x, 0, 1, 2, stress, point, is_geometric ? &lead : NULL);
    add_side(x, 1, 0, 3, stress, point, is_geometric ? &lead : NULL);
    pel_strain_add(point, PEL_HINGE_STRAINS, 4, 0, &lead, request, sum);
    return point->energy;
}

double pel_hinge_tangent(const pel_hinge *hinge, double stiffness, const double *x, const pel_tangent_request *request,
                         const pel_tangent_sum *sum)
{
    const double factor = stiffness * hinge->factor, angle = pel_angle_from_rest(x, hinge->rest_angle);
    pel_strain_point point = {
        .energy = 0.5 * factor * angle * angle, .strain = {angle}, .stress = {factor * angle}, .tangent = {{factor}}};
    return add_angle(x, &point, request, sum);
}

double pel_fold_tangent(const pel_hinge *hinge, const pel_yield *yield, double stiffness, const double *x,
                        const pel_tangent_request *request, const pel_tangent_sum *sum)
{
    const double factor = stiffness * hinge->factor, angle = pel_angle_from_rest(x, hinge->rest_angle);
    const pel_fold_response r = pel_fold_respond(angle, yield->angle, yield->share);
    pel_strain_point point = {.energy = factor * r.energy,
                              .strain = {angle},
                              .stress = {factor * r.moment},
                              .tangent = {{fabs(angle) > yield->angle ? yield->share * factor : factor}}};
    return add_angle(x, &point, request, sum);
}

/* ---- mid-edge ---- */

/* |e| (m1^2, m2^2, 2 m1 m2) of edge i in the axes of a plate; returns |e| */
static double edge_curvature(const pel_rest_triangle *rest, int i, const pel_plate *plate, double v[3])
{
    /* corners in the rest frame, from the inverse of [X0 - X2, X1 - X2] */
    const double *inverse = rest->inverse, *axis = plate->axis;
    const double corner[3][2] = {
        {1 / inverse[0], 0}, {-inverse[1] / (inverse[0] * inverse[2]), 1 / inverse[2]}, {0, 0}};
    const double x = corner[(i + 1) % 3][0] - corner[i][0], y = corner[(i + 1) % 3][1] - corner[i][1];
    const double length = pel_hypot(x, y), along = axis[0] * x + axis[1] * y, across = axis[0] * y - axis[1] * x;
    v[0] = across * across / length;
    v[1] = along * along / length;
    v[2] = -2 * along * across / length;
    return length;
}

static double plate_product(const pel_plate *plate, const double v[3], const double w[3])
{
    return v[0] * w[0] + plate->across * v[1] * w[1] + plate->coupling * (v[0] * w[1] + v[1] * w[0]) +
           plate->twist * v[2] * w[2];
}

pel_midedge pel_midedge_setup(const pel_rest_triangle *rest, double stiffness, const pel_plate *plate)
{
    pel_midedge element;
    double v[3][3];
    for (int i = 0; i < 3; i++)
        edge_curvature(rest, i, plate, v[i]);
    for (int i = 0, k = 0; i < 3; i++)
        for (int j = i; j < 3; j++)
            element.stiffness[k++] = stiffness / rest->area * plate_product(plate, v[i], v[j]);
    return element;
}

double pel_plate_about_edge(const pel_rest_triangle *rest, int side, const pel_plate *plate)
{
    double v[3], length = edge_curvature(rest, side, plate, v);
    return plate_product(plate, v, v) / (length * length);
}

void pel_midedge_moments(const pel_midedge *element, const double alpha[3], double moment[3])
{
    pel_plate_moments(element->stiffness, alpha, moment);
}

double pel_midedge_tangent(const pel_midedge *element, const double alpha[3], const double sign[3], const double *x,
                           const pel_tangent_request *request, const pel_tangent_sum *sum)
{
    const pel_lane3 corners[3] = {point_of(x), point_of(x + 3), point_of(x + 6)};
    return pel_plate_tangent(element->stiffness, alpha, sign, corners, request, sum);
}

double pel_midedge_angle(const double x[3][3], const double normal[3])
{
    const pel_face_turn turn = pel_face_turn_of(point_of(x[0]), point_of(x[1]), point_of(x[2]));
    return pel_face_turn_from(point_of(normal), &turn);
}
