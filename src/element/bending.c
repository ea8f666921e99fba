/* Bending of an edge. With e = x1 - x0 and the normals n1 = e x (x2 - x0), n2 = (x3 - x0) x e, whose lengths are twice
   the areas,

       theta    = atan2((n1 x n2) . e / |e|, n1 . n2)
       d theta / d x2 = -|e| n1 / |n1|^2,     d theta / d x3 = -|e| n2 / |n2|^2
       d theta / d x0 = -(1 - t2) d2 - (1 - t3) d3,   d theta / d x1 = -t2 d2 - t3 d3

   where t2, t3 place the feet of x2, x3 on the edge (theory page, section 5). The isometric weights are

       (c03 + c04, c01 + c02, -c01 - c03, -c02 - c04),  |K X| = 2 |e| sin(theta / 2) on any isometry

   with c_jk the cotangent of the angle between the edges e_j and e_k: c01 at x0 and c03 at x1 in the left triangle, c02
   and c04 in the right one. */
#include "pellicle/bending.h"

#include "math/vec3.h"

#include <math.h>
#include <string.h>

/* cotangent of the angle at a between b and c, positive when acute; the triangle must have an area */
static double cotangent(const double a[3], const double b[3], const double c[3])
{
    double ab[3], ac[3], cross[3];
    pel_vec3_subtract(b, a, ab);
    pel_vec3_subtract(c, a, ac);
    pel_vec3_cross(ab, ac, cross);
    return pel_vec3_dot(ab, ac) / pel_vec3_length(cross);
}

/* the sum of both areas, 0 when one of them is */
static double area_of_pair(const double x[4][3])
{
    double left[3], right[3];
    pel_vec3_triangle_normal(x[0], x[1], x[2], left);
    pel_vec3_triangle_normal(x[1], x[0], x[3], right);
    double left_length = pel_vec3_length(left), right_length = pel_vec3_length(right);
    return left_length > 0 && right_length > 0 ? 0.5 * (left_length + right_length) : 0;
}

double pel_bending_stiffness(double young, double poisson, double thickness)
{
    return young * thickness * thickness * thickness / (12 * (1 - poisson * poisson));
}

bool pel_bending_isometric_setup(const double rest[4][3], pel_bending_isometric *stencil)
{
    memset(stencil, 0, sizeof *stencil);
    double area = area_of_pair(rest);
    if (!(area > 0))
        return false;
    double left0 = cotangent(rest[0], rest[1], rest[2]), left1 = cotangent(rest[1], rest[0], rest[2]);
    double right0 = cotangent(rest[0], rest[1], rest[3]), right1 = cotangent(rest[1], rest[0], rest[3]);
    stencil->weight[0] = left1 + right1;
    stencil->weight[1] = left0 + right0;
    stencil->weight[2] = -left0 - left1;
    stencil->weight[3] = -right0 - right1;
    stencil->factor = 3 / area;
    stencil->rest_energy = pel_bending_isometric_energy(stencil, PEL_BENDING_LITERAL, rest, NULL);
    return true;
}

/* K x from differences to x0: exact far from the origin, as the weights add up to zero */
static void weighted_sum(const double weight[4], const double x[4][3], double sum[3])
{
    for (int i = 0; i < 3; i++)
        sum[i] = weight[1] * (x[1][i] - x[0][i]) + weight[2] * (x[2][i] - x[0][i]) + weight[3] * (x[3][i] - x[0][i]);
}

double pel_bending_isometric_energy(const pel_bending_isometric *stencil, pel_bending_form form, const double x[4][3],
                                    double gradient[4][3])
{
    double sum[3];
    weighted_sum(stencil->weight, x, sum);
    if (gradient != NULL)
        for (int a = 0; a < 4; a++)
            pel_vec3_scale(sum, stencil->factor * stencil->weight[a], gradient[a]);
    double energy = 0.5 * stencil->factor * pel_vec3_squared_length(sum);
    return form == PEL_BENDING_REST_SUBTRACTED ? energy - stencil->rest_energy : energy;
}

/* -|e| n / |n|^2, the gradient on a tip */
static void tip_gradient(const double normal[3], double edge_length, double gradient[3])
{
    double square = pel_vec3_squared_length(normal);
    pel_vec3_scale(normal, square > 0 ? -edge_length / square : 0, gradient);
}

double pel_dihedral_angle(const double x[4][3], double gradient[4][3])
{
    double edge[3], to_left[3], to_right[3], left[3], right[3], cross[3];
    pel_vec3_subtract(x[1], x[0], edge);
    pel_vec3_subtract(x[2], x[0], to_left);
    pel_vec3_subtract(x[3], x[0], to_right);
    pel_vec3_cross(edge, to_left, left);
    pel_vec3_cross(to_right, edge, right);
    pel_vec3_cross(left, right, cross);
    double length = pel_vec3_length(edge);
    if (gradient != NULL) {
        double inverse = length > 0 ? 1 / (length * length) : 0;
        double t2 = inverse * pel_vec3_dot(to_left, edge), t3 = inverse * pel_vec3_dot(to_right, edge);
        tip_gradient(left, length, gradient[2]);
        tip_gradient(right, length, gradient[3]);
        for (int i = 0; i < 3; i++) {
            gradient[0][i] = -(1 - t2) * gradient[2][i] - (1 - t3) * gradient[3][i];
            gradient[1][i] = -t2 * gradient[2][i] - t3 * gradient[3][i];
        }
    }
    double sine = length > 0 ? pel_vec3_dot(cross, edge) / length : 0, cosine = pel_vec3_dot(left, right);
    return atan2(sine, cosine);
}

bool pel_hinge_setup(const double rest[4][3], pel_hinge *hinge)
{
    memset(hinge, 0, sizeof *hinge);
    double area = area_of_pair(rest), length = pel_vec3_distance(rest[0], rest[1]);
    if (!(area > 0))
        return false;
    hinge->factor = length * length / area;
    hinge->rest_angle = pel_dihedral_angle(rest, NULL);
    return true;
}

double pel_hinge_energy(const pel_hinge *hinge, const double x[4][3], double gradient[4][3])
{
    const double half_turn = 3.141592653589793238;
    double difference = pel_dihedral_angle(x, gradient) - hinge->rest_angle;
    if (fabs(difference) > half_turn)
        difference -= copysign(2 * half_turn, difference);
    if (gradient != NULL)
        for (int a = 0; a < 4; a++)
            pel_vec3_scale(gradient[a], hinge->factor * difference, gradient[a]);
    return 0.5 * hinge->factor * difference * difference;
}
