/* Bending of an edge. With e = x1 - x0 and the normals n1 = e x (x2 - x0), n2 = (x3 - x0) x e, whose lengths are twice
   the areas,

       theta    = atan2((n1 x n2) . e / |e|, n1 . n2)
       d theta / d x2 = -|e| n1 / |n1|^2,     d theta / d x3 = -|e| n2 / |n2|^2
       d theta / d x0 = -(1 - t2) d2 - (1 - t3) d3,   d theta / d x1 = -t2 d2 - t3 d3

   where t2, t3 place the feet of x2, x3 on the edge (theory page, section 5). The isometric weights are

       (c03 + c04, c01 + c02, -c01 - c03, -c02 - c04),  |K X| = 2 |e| sin(theta / 2) on any isometry

   with c_jk the cotangent of the angle between the edges e_j and e_k: c01 at x0 and c03 at x1 in the left triangle, c02
   and c04 in the right one. */
#define PEL_LANE_DOUBLE
#include "pellicle/bending.h"

#include "math/functions.h"
#include "math/vec3.h"
#include "measure/hinge.h"

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

static void load_points(const double x[4][3], pel_particle p[4])
{
    for (int k = 0; k < 4; k++)
        p[k] = (pel_particle){{x[k][0], x[k][1], x[k][2]}, 0};
}

double pel_bending_isometric_energy(const pel_bending_isometric *stencil, pel_bending_form form, const double x[4][3],
                                    double gradient[4][3])
{
    pel_particle p[4];
    load_points(x, p);
    pel_lane3 sum = pel_isometric_of(p, stencil->weight);
    for (int a = 0; gradient != NULL && a < 4; a++) {
        double scale = stencil->factor * stencil->weight[a];
        pel_vec3_set(gradient[a], scale * sum.x, scale * sum.y, scale * sum.z);
    }
    double energy = 0.5 * stencil->factor * pel_lane3_dot(sum, sum);
    return form == PEL_BENDING_REST_SUBTRACTED ? energy - stencil->rest_energy : energy;
}

/* angle minus the angle of this cosine and sine, along the shorter arc */
static double turned_angle(const double x[4][3], double cosine, double sine, double gradient[4][3])
{
    pel_particle p[4];
    load_points(x, p);
    if (gradient == NULL)
        return pel_hinge_angle_of(p, cosine, sine).difference;
    pel_hinge_lanes h = pel_hinge_of(p, cosine, sine);
    pel_lane3 g[4];
    pel_hinge_gradients(&h, -h.length, g);
    for (int a = 0; a < 4; a++)
        pel_vec3_set(gradient[a], g[a].x, g[a].y, g[a].z);
    return h.difference;
}

double pel_dihedral_angle(const double x[4][3], double gradient[4][3])
{
    return turned_angle(x, 1, 0, gradient);
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
    double difference = turned_angle(x, pel_cos(hinge->rest_angle), pel_sin(hinge->rest_angle), gradient);
    for (int a = 0; gradient != NULL && a < 4; a++)
        pel_vec3_scale(gradient[a], hinge->factor * difference, gradient[a]);
    return 0.5 * hinge->factor * difference * difference;
}
