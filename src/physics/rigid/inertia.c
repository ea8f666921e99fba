/* A simplex of n corners x_i with the measure m has

       integral of x     = m / n sum x_i
       integral of x x^T = m / (n (n + 1)) (sum x_i x_i^T + (sum x_i) (sum x_i)^T).

   A closed surface is the sum of tetrahedra from its triangles to any origin, with their signs (Lien and Kajiya 1984,
   "A symbolic method for calculating the integral properties of arbitrary nonconvex polyhedra"); the origin is a corner
   of the mesh, so that few digits cancel far from 0.

   Masses of vertices: among all w_i > 0 with the given center the ones nearest to given shares a_i in entropy are
   a_i exp(b . (x_i - c)); the sum of these has its minimum in b where their center is c (Newton's method, convex). */
#include "rigid/inertia.h"

#include "math/functions.h"
#include "math/vec3.h"

#include <string.h>

/* of the cube of the trace: below it a tensor has no inverse */
#define LEAST_DETERMINANT 1e-18
/* Newton's steps, and the distance of centers that is none, in diameters */
enum { MOST_STEPS = 100 };
#define CENTER_TOLERANCE 1e-14

typedef struct moments {
    double measure, first[3], second[3][3];
} moments;

static void add_simplex(moments *sum, double measure, const double (*corners)[3], int corner_count, int n)
{
    double total[3] = {0};
    for (int i = 0; i < corner_count; i++)
        pel_vec3_add(total, corners[i], total);
    sum->measure += measure;
    pel_vec3_along(sum->first, measure / n, total, sum->first);
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++) {
            double product = total[a] * total[b];
            for (int i = 0; i < corner_count; i++)
                product += corners[i][a] * corners[i][b];
            sum->second[a][b] += measure / (n * (n + 1)) * product;
        }
}

static void finish(const moments *sum, const double origin[3], double density, pel_inertia *inertia)
{
    double c[3], trace = 0;
    pel_vec3_scale(sum->first, 1 / sum->measure, c);
    inertia->mass = density * sum->measure;
    for (int k = 0; k < 3; k++)
        trace += sum->second[k][k] - sum->measure * c[k] * c[k];
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++)
            inertia->tensor[a][b] = density * ((a == b ? trace : 0) - (sum->second[a][b] - sum->measure * c[a] * c[b]));
    pel_vec3_add(origin, c, inertia->center);
}

static void sum_moments(const pel_mesh *mesh, bool is_filled, moments *sum)
{
    static const double zero[3] = {0};
    memset(sum, 0, sizeof *sum);
    for (int32_t t = 0; t < mesh->triangle_count; t++) {
        double x[3][3];
        for (int i = 0; i < 3; i++)
            pel_vec3_subtract(mesh->positions[mesh->triangles[t][i]], mesh->positions[0], x[i]);
        double measure =
            is_filled ? pel_vec3_cone_volume(zero, x[0], x[1], x[2]) : pel_vec3_triangle_area(x[0], x[1], x[2]);
        add_simplex(sum, measure, (const double(*)[3])x, 3, is_filled ? 4 : 3);
    }
}

void pel_inertia_of_solid(const pel_mesh *mesh, double density, pel_inertia *inertia)
{
    moments sum;
    sum_moments(mesh, true, &sum);
    finish(&sum, mesh->positions[0], density, inertia);
}

void pel_inertia_of_sheet(const pel_mesh *mesh, double density, pel_inertia *inertia)
{
    moments sum;
    sum_moments(mesh, false, &sum);
    finish(&sum, mesh->positions[0], density, inertia);
}

bool pel_inertia_invert(const double m[3][3], double inverse[3][3])
{
    return pel_inertia_invert_above(m, LEAST_DETERMINANT, inverse);
}

bool pel_inertia_invert_above(const double m[3][3], double least, double inverse[3][3])
{
    double trace = m[0][0] + m[1][1] + m[2][2], determinant = 0;
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) {
            int a = (i + 1) % 3, b = (i + 2) % 3, c = (k + 1) % 3, d = (k + 2) % 3;
            inverse[k][i] = m[a][c] * m[b][d] - m[a][d] * m[b][c];
        }
    for (int k = 0; k < 3; k++)
        determinant += m[0][k] * inverse[k][0];
    bool has_inverse = determinant > least * trace * trace * trace;
    for (int i = 0; i < 3; i++)
        pel_vec3_scale(inverse[i], has_inverse ? 1 / determinant : 0, inverse[i]);
    return has_inverse;
}

/* ---- masses of vertices ---- */

/* sum, center about c and spread of the tilted shares */
static double tilt(const pel_mesh *mesh, const double c[3], const double *shares, const double b[3], double center[3],
                   double spread[3][3])
{
    double sum = 0, x[3];
    pel_vec3_set(center, 0, 0, 0);
    memset(spread, 0, 9 * sizeof(double));
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        pel_vec3_subtract(mesh->positions[v], c, x);
        double w = shares[v] * pel_exp(pel_vec3_dot(b, x));
        sum += w;
        pel_vec3_along(center, w, x, center);
        for (int i = 0; i < 3; i++)
            pel_vec3_along(spread[i], w * x[i], x, spread[i]);
    }
    pel_vec3_scale(center, 1 / sum, center);
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            spread[i][k] = spread[i][k] / sum - center[i] * center[k];
    return sum;
}

/* b -= share of the Newton step; in a plane or on a line the spread has no inverse across it, where nothing is to do */
static void step_tilt(double spread[3][3], const double center[3], double size, double b[3])
{
    double inverse[3][3], change[3], length;
    for (int k = 0; k < 3; k++)
        spread[k][k] += 1e-9 * size * size;
    pel_inertia_invert((const double(*)[3])spread, inverse);
    for (int i = 0; i < 3; i++)
        change[i] = pel_vec3_dot(inverse[i], center);
    length = size * pel_vec3_length(change);
    pel_vec3_along(b, length > 1 ? -1 / length : -1, change, b);
}

bool pel_inertia_lump(const pel_mesh *mesh, const pel_inertia *inertia, const double *shares, double *masses)
{
    double b[3] = {0}, center[3], spread[3][3], size = 0, sum = 0, x[3];
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        double distance = pel_vec3_distance(mesh->positions[v], inertia->center);
        size = distance > size ? distance : size;
    }
    for (int step = 0; step < MOST_STEPS; step++) {
        sum = tilt(mesh, inertia->center, shares, b, center, spread);
        if (!isfinite(sum))
            return false;
        if (!(pel_vec3_length(center) > CENTER_TOLERANCE * size))
            break;
        step_tilt(spread, center, size, b);
    }
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        pel_vec3_subtract(mesh->positions[v], inertia->center, x);
        masses[v] = inertia->mass / sum * shares[v] * pel_exp(pel_vec3_dot(b, x));
    }
    return pel_vec3_length(center) < 1e-6 * size;
}
