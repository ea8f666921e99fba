/* Resultants follow from the forces of the elements by virtual work, and so hold for every law and bending model.

   Membrane and fibres: the gradients g_a on the corners x_a of a triangle have the virial sum_a g_a x_a^T = A N, with
   the present area A and the resultant N.

   Bending: a moment m, conjugate to the angle of an edge, does the work m d theta = A M : d kappa. With the quadratic
   displacement -1/2 x^T kappa x on the unfolded rest triangles of a hinge, whose angle is sum_a w_a h_a of the heights,
   its part of A M is -1/2 m sum_a w_a x_a x_a^T; each of its two triangles takes half. In mid-edge bending the three
   moments of a triangle are |e| times the normal moments on its edges, which determine M. */
#include "force/mechanics.h"

#include "base/assert.h"
#include "force/shell_body.h"
#include "force/tangent_body.h"
#include "math/functions.h"
#include "math/vec3.h"
#include "measure/tangent.h"

#include <string.h>

/* ---- membrane and fibres ---- */

static void add_virial(const double x[3][3], const double gradient[3][3], double force[6])
{
    static const int at[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {0, 2}};
    for (int a = 0; a < 2; a++) {
        double side[3];
        pel_vec3_subtract(x[a], x[2], side);
        for (int k = 0; k < 6; k++)
            force[k] += 0.5 * (gradient[a][at[k][0]] * side[at[k][1]] + gradient[a][at[k][1]] * side[at[k][0]]);
    }
}

static void fill_triangle(const pel_shell_forces *forces, const pel_shell_body *own, int32_t t,
                          const pel_record *position, double time, pel_triangle_mechanics *out)
{
    const pel_shell *shell = own->shell;
    double x[3][3], gradient[3][3];
    pel_load_points(position, shell->corners[t], 3, x);
    if (shell->has_membrane) {
        out->membrane_energy = pel_shell_membrane_energy(forces, own, t, (const double(*)[3])x, gradient);
        add_virial((const double(*)[3])x, (const double(*)[3])gradient, out->force);
    }
    for (int32_t r = 0; r < shell->region_count; r++) {
        int32_t fibre = pel_shell_find_fibre(&shell->regions[r], t);
        if (fibre < 0)
            continue;
        out->fibre_energy +=
            pel_shell_fibre_energy(shell, &shell->regions[r], fibre, time, (const double(*)[3])x, gradient);
        add_virial((const double(*)[3])x, (const double(*)[3])gradient, out->force);
    }
}

/* ---- bending ---- */

/* corners in the rest frame, from the inverse of [X0 - X2, X1 - X2] */
static void rest_corners(const pel_rest_triangle *rest, double corner[3][2])
{
    const double *inverse = rest->inverse;
    corner[0][0] = 1 / inverse[0];
    corner[0][1] = corner[2][0] = corner[2][1] = 0;
    corner[1][0] = -inverse[1] / (inverse[0] * inverse[2]);
    corner[1][1] = 1 / inverse[2];
}

/* adds scale (a b^T + b a^T) / 2 */
static void add_product(double scale, const double a[2], const double b[2], double moment[6])
{
    moment[0] += scale * a[0] * b[0];
    moment[1] += scale * a[1] * b[1];
    moment[2] += scale * 0.5 * (a[0] * b[1] + a[1] * b[0]);
}

/* the place of a vertex of the tip opposite of an edge: along the edge, and away from it */
static void foot_and_height(const double tail[3], const double head[3], const double tip[3], double at[2])
{
    double edge[3], side[3], normal[3];
    pel_vec3_subtract(head, tail, edge);
    pel_vec3_subtract(tip, tail, side);
    double length = pel_vec3_normalize(edge);
    pel_vec3_cross(edge, side, normal);
    at[0] = length > 0 ? pel_vec3_dot(edge, side) : 0;
    at[1] = pel_vec3_length(normal);
}

/* the moment of a hinge that is conjugate to its angle: for the isometric model, whose |K x| is 2 |e| sin (theta / 2),
   that to first order */
static double hinge_moment(const pel_shell *shell, const pel_record *rest, const pel_shell_hinge *hinge,
                           const double x[4][3])
{
    const pel_hinge stencil = pel_shell_angle(shell, rest, hinge);
    if (shell->bending->is_angle)
        return hinge->stiffness * stencil.factor * pel_angle_from_rest(x[0], stencil.rest_angle);
    return hinge->stiffness * stencil.factor * 2 * pel_sin(0.5 * pel_dihedral_angle(x, NULL));
}

static int corner_of(const int32_t corners[3], int32_t vertex)
{
    return corners[0] == vertex ? 0 : corners[1] == vertex ? 1 : 2;
}

/* adds a tensor with components along the edge, across it and mixed, to the tensor of the triangle on one side */
static void add_along_edge(const pel_shell *shell, const pel_shell_hinge *hinge, int side, const double tensor[3],
                           double moment[6])
{
    const int32_t *corners = shell->corners[hinge->triangles[side]];
    const pel_rest_triangle rest = pel_shell_rest(shell, hinge->triangles[side]);
    double corner[3][2], along[2];
    rest_corners(&rest, corner);
    const double *tail = corner[corner_of(corners, hinge->vertices[0])];
    const double *head = corner[corner_of(corners, hinge->vertices[1])];
    double length = pel_hypot(head[0] - tail[0], head[1] - tail[1]);
    for (int c = 0; c < 2; c++)
        along[c] = (head[c] - tail[c]) / length;
    const double across[2] = {-along[1], along[0]};
    add_product(tensor[0], along, along, moment);
    add_product(tensor[1], across, across, moment);
    add_product(2 * tensor[2], along, across, moment);
}

static void add_hinge(const pel_shell *shell, const pel_record *rest, const pel_shell_hinge *hinge,
                      const pel_record *position, pel_triangle_mechanics *triangles)
{
    double x[4][3], flat[4][3], left[2], right[2];
    pel_load_points(position, hinge->vertices, 4, x);
    pel_load_points(rest, hinge->vertices, 4, flat);
    foot_and_height(flat[0], flat[1], flat[2], left);
    foot_and_height(flat[0], flat[1], flat[3], right);
    double length = pel_vec3_distance(flat[0], flat[1]);
    if (!(left[1] > 0) || !(right[1] > 0) || !(length > 0))
        return;
    /* weights of the angle: -1 / height at the tips, and none for a plane, whatever its slope */
    double m = hinge_moment(shell, rest, hinge, (const double(*)[3])x), w2 = -1 / left[1], w3 = -1 / right[1];
    double w1 = -(w2 * left[0] + w3 * right[0]) / length;
    const double half[3] = {
        -0.25 * m * (w1 * length * length + w2 * left[0] * left[0] + w3 * right[0] * right[0]),
        0.25 * m * (left[1] + right[1]),
        0.25 * m * (left[0] - right[0]),
    };
    double energy =
        pel_shell_hinge_factor(shell, hinge) * pel_shell_hinge_energy(shell, rest, hinge, (const double(*)[3])x, NULL);
    for (int side = 0; side < 2; side++) {
        pel_triangle_mechanics *out = &triangles[hinge->triangles[side]];
        add_along_edge(shell, hinge, side, half, out->moment);
        out->bending_energy += 0.5 * energy;
    }
}

/* from the normal moments on edges, m_k / |e_k|: n_k^T M n_k is met by products of the other two edges */
static void add_midedge(const pel_rest_triangle *rest, const double moment[3], double out[6])
{
    double corner[3][2], edge[3][2];
    rest_corners(rest, corner);
    for (int k = 0; k < 3; k++)
        for (int c = 0; c < 2; c++)
            edge[k][c] = corner[(k + 1) % 3][c] - corner[k][c];
    for (int k = 0; k < 3; k++)
        add_product(-moment[k] * pel_hypot(edge[k][0], edge[k][1]) / (4 * rest->area), edge[(k + 1) % 3],
                    edge[(k + 2) % 3], out);
}

/* the shell of a body with mid-edge bending, else null */
static const pel_tangent_shell *midedge_shell(const pel_tangent *tangent, int32_t body)
{
    for (int32_t b = 0; b < tangent->shell_count; b++)
        if (tangent->shells[b].body == body && tangent->shells[b].midedges != NULL)
            return &tangent->shells[b];
    return NULL;
}

/* of a triangle */
static void find_alphas(const pel_tangent *tangent, const pel_tangent_shell *own, int32_t t, const double *unknowns,
                        double alpha[3])
{
    PEL_ASSERT_INDEX(t, own->shell->triangle_count);
    const double *xi = unknowns + 3 * (size_t)tangent->pattern.vertex_count;
    double sign;
    for (int k = 0; k < 3; k++) {
        int32_t e = pel_tangent_edge_of(own->edges[t][k], &sign);
        alpha[k] = tangent->half_angles[e] + sign * xi[e];
    }
}

/* the moments of a triangle; returns its energy */
static double midedge_moments(const pel_tangent *tangent, const pel_tangent_shell *own, int32_t t,
                              const double *unknowns, double moment[3])
{
    double alpha[3];
    find_alphas(tangent, own, t, unknowns, alpha);
    pel_midedge_moments(&own->midedges[t], alpha, moment);
    return 0.5 * pel_vec3_dot(alpha, moment);
}

/* adds the curvature along edge `side` of a triangle, and the twist about it, times a sign; returns its length */
static double add_curvatures(const pel_rest_triangle *rest, const double alpha[3], int side, double sign,
                             double curvature[2])
{
    double corner[3][2], along[3][2], length[3];
    rest_corners(rest, corner);
    for (int k = 0; k < 3; k++) {
        for (int c = 0; c < 2; c++)
            along[k][c] = corner[(k + 1) % 3][c] - corner[k][c];
        length[k] = pel_hypot(along[k][0], along[k][1]);
    }
    for (int k = 0; k < 3; k++) {
        const double scale = 1 / (length[k] * length[side]), share = sign * alpha[k] * length[k] / rest->area;
        const double sine = scale * (along[k][1] * along[side][0] - along[k][0] * along[side][1]);
        curvature[0] += share * sine * sine;
        curvature[1] += share * sine * scale * (along[k][0] * along[side][0] + along[k][1] * along[side][1]);
    }
    return length[side];
}

double pel_mechanics_midedge_error(pel_tangent *tangent, const double *unknowns, pel_pool *pool, int32_t body)
{
    const pel_tangent_shell *own = midedge_shell(tangent, body);
    double energy = 0, jumps = 0, alpha[3], sign;
    pel_tangent_find_angles(tangent, unknowns, pool);
    for (int32_t t = 0; own != NULL && t < own->shell->triangle_count; t++)
        energy += midedge_moments(tangent, own, t, unknowns, alpha);
    for (int32_t e = 0; own != NULL && e < tangent->pattern.edge_count; e++) {
        const pel_tangent_edge *edge = &tangent->edges[e];
        double jump[2] = {0}, stiffness = 0, length = 0;
        if (edge->body != body || edge->triangles[1] < 0)
            continue;
        for (int i = 0; i < 2; i++) {
            const int32_t t = edge->triangles[i];
            int side = 0;
            while (side < 2 && pel_tangent_edge_of(own->edges[t][side], &sign) != e)
                side++;
            find_alphas(tangent, own, t, unknowns, alpha);
            length = add_curvatures(&own->rests[t], alpha, side, 1 - 2 * i, jump);
            stiffness += 0.5 * own->shell->parts[t].stiffness;
        }
        jumps += stiffness * length * length * (jump[0] * jump[0] / 120 + jump[1] * jump[1] / 12);
    }
    return energy > 0 ? 0.5 * jumps / energy : 0;
}

void pel_mechanics_add_midedge(pel_tangent *tangent, const double *unknowns, pel_pool *pool, int32_t body,
                               pel_triangle_mechanics *triangles)
{
    const pel_tangent_shell *own = midedge_shell(tangent, body);
    pel_tangent_find_angles(tangent, unknowns, pool);
    for (int32_t t = 0; own != NULL && t < own->shell->triangle_count; t++) {
        double moment[3];
        triangles[t].bending_energy += midedge_moments(tangent, own, t, unknowns, moment);
        add_midedge(&own->rests[t], moment, triangles[t].moment);
    }
}

void pel_mechanics_share_midedge(pel_tangent *tangent, const double *unknowns, pel_pool *pool, int32_t body,
                                 const int32_t *output_vertex, double *bending)
{
    const pel_tangent_shell *own = midedge_shell(tangent, body);
    pel_tangent_find_angles(tangent, unknowns, pool);
    for (int32_t t = 0; own != NULL && t < own->shell->triangle_count; t++) {
        double moment[3], energy = midedge_moments(tangent, own, t, unknowns, moment);
        for (int k = 0; k < 3; k++) {
            int32_t v = tangent->model->mesh_vertex[own->shell->corners[t][k]];
            bending[output_vertex != NULL ? output_vertex[v] : v] += energy / 3;
        }
    }
}

/* ---- fill and finish ---- */

void pel_mechanics_fill(const pel_shell_forces *forces, int32_t body, int32_t triangle_count,
                        const pel_record *position, double time, pel_triangle_mechanics *triangles)
{
    const pel_shell_body *own = forces != NULL ? pel_shell_body_of(forces, body) : NULL;
    memset(triangles, 0, (size_t)triangle_count * sizeof *triangles);
    if (own == NULL)
        return;
    for (int32_t t = 0; t < own->shell->triangle_count; t++)
        fill_triangle(forces, own, t, position, time, &triangles[t]);
    for (int32_t i = 0; i < pel_shell_elastic_hinges(own->shell); i++) {
        const pel_shell_hinge hinge = pel_shell_hinge_now(forces, own->shell, i);
        add_hinge(own->shell, forces->model->rest, &hinge, position, triangles);
    }
}

static void add_corners(const double part[3][3], double gradient[3][3])
{
    for (int c = 0; c < 3; c++)
        pel_vec3_add(gradient[c], part[c], gradient[c]);
}

double pel_mechanics_gradient(const pel_shell_forces *forces, int32_t body, int32_t t, const pel_record *position,
                              double time, double gradient[3][3])
{
    const pel_shell_body *own = forces != NULL ? pel_shell_body_of(forces, body) : NULL;
    double x[3][3], part[3][3], energy = 0;
    if (own == NULL)
        return 0;
    const pel_shell *shell = own->shell;
    pel_load_points(position, shell->corners[t], 3, x);
    if (shell->has_membrane) {
        energy += pel_shell_membrane_energy(forces, own, t, (const double(*)[3])x, part);
        add_corners((const double(*)[3])part, gradient);
    }
    for (int32_t r = 0; r < shell->region_count; r++) {
        int32_t fibre = pel_shell_find_fibre(&shell->regions[r], t);
        if (fibre < 0)
            continue;
        energy += pel_shell_fibre_energy(shell, &shell->regions[r], fibre, time, (const double(*)[3])x, part);
        add_corners((const double(*)[3])part, gradient);
    }
    return energy;
}

/* columns f1, f2 times a tensor in the plane (11, 22, 12) times their transpose: xx, yy, zz, xy, yz, xz */
static void to_space(const double f[6], double scale, const double plane[3], double out[6])
{
    static const int at[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {0, 2}};
    const double a = scale * plane[0], b = scale * plane[1], c = scale * plane[2];
    for (int k = 0; k < 6; k++) {
        const double *row = f + 2 * at[k][0], *column = f + 2 * at[k][1];
        out[k] = a * row[0] * column[0] + b * row[1] * column[1] + c * (row[0] * column[1] + row[1] * column[0]);
    }
}

/* rows u1, u2 (of 3 x 2) of a symmetric tensor in space: u^T T u */
static void to_plane(const double u[6], const double space[6], double plane[3])
{
    static const int at[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};
    double column[2][3];
    for (int j = 0; j < 2; j++)
        for (int i = 0; i < 3; i++)
            column[j][i] = space[at[i][0]] * u[j] + space[at[i][1]] * u[2 + j] + space[at[i][2]] * u[4 + j];
    plane[0] = u[0] * column[0][0] + u[2] * column[0][1] + u[4] * column[0][2];
    plane[1] = u[1] * column[1][0] + u[3] * column[1][1] + u[5] * column[1][2];
    plane[2] = u[0] * column[1][0] + u[2] * column[1][1] + u[4] * column[1][2];
}

static void finish_triangle(const pel_shell_body *own, int32_t t, const pel_flow *flows, const pel_record *rest,
                            const pel_record *position, pel_triangle_mechanics *out)
{
    const int32_t *corners = own->shell->corners[t];
    /* strains of what yields are those from the mesh, of what grows those from its shape without stress */
    const pel_rest_triangle mesh = pel_shell_rest(own->shell, t);
    const pel_rest_triangle shape = own->shell->growths != NULL ? pel_shell_rest_now(own->shell, t, flows) : mesh;
    double thickness = pel_shell_sheet_of(own->shell, t).thickness;
    double x[3][3], at_rest[3][3], axes[6], f[6], inverse[6], plane[3];
    pel_load_points(position, corners, 3, x);
    pel_load_points(rest, corners, 3, at_rest);
    pel_deformation_gradient(&mesh, (const double(*)[3])at_rest, axes);
    pel_deformation_gradient(&shape, (const double(*)[3])x, f);
    double c11 = 0, c22 = 0, c12 = 0;
    for (int i = 0; i < 3; i++) {
        c11 += f[2 * i] * f[2 * i];
        c22 += f[2 * i + 1] * f[2 * i + 1];
        c12 += f[2 * i] * f[2 * i + 1];
    }
    out->rest_area = shape.area;
    out->area = pel_vec3_triangle_area(x[0], x[1], x[2]);
    double ratio = out->area / out->rest_area, determinant = ratio * ratio, poisson = own->shell->law.poisson;
    const double green[3] = {0.5 * (c11 - 1), 0.5 * (c22 - 1), 0.5 * c12};
    to_space(axes, 1, green, out->strain);
    double moment[3] = {out->moment[0], out->moment[1], out->moment[2]}, per_area = 0;
    if (ratio > 0) {
        per_area = 1 / out->area;
        /* F C^-1, whose transpose brings tensors back to the rest frame */
        for (int i = 0; i < 3; i++) {
            inverse[2 * i] = (f[2 * i] * c22 - f[2 * i + 1] * c12) / determinant;
            inverse[2 * i + 1] = (f[2 * i + 1] * c11 - f[2 * i] * c12) / determinant;
        }
        to_plane(inverse, out->force, plane);
        if (thickness > 0)
            to_space(axes, 1 / (thickness * out->rest_area), plane, out->piola_stress);
        out->thickness = thickness * pel_pow(ratio, -poisson / (1 - poisson));
    }
    to_space(f, per_area, moment, out->moment);
    for (int k = 0; k < 6; k++)
        out->force[k] *= per_area;
    out->membrane_energy /= out->rest_area;
    out->fibre_energy /= out->rest_area;
    out->bending_energy /= out->rest_area;
}

void pel_mechanics_finish(const pel_shell_forces *forces, int32_t body, const pel_record *position,
                          pel_triangle_mechanics *triangles)
{
    const pel_shell_body *own = forces != NULL ? pel_shell_body_of(forces, body) : NULL;
    for (int32_t t = 0; own != NULL && t < own->shell->triangle_count; t++)
        finish_triangle(own, t, forces->plastic.flows, forces->model->rest, position, &triangles[t]);
}
