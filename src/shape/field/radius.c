#include "field/radius.h"

#include "math/functions.h"
#include "math/vec3.h"
#include "pellicle/mesh.h"

#include <math.h>

/* edges of a mesh that turn by less than this are flat */
#define FLAT_ANGLE 1e-6

static void triangle_normal(const pel_mesh *mesh, int32_t t, double normal[3])
{
    const int32_t *v = mesh->triangles[t];
    double a[3], b[3];
    pel_vec3_subtract(mesh->positions[v[1]], mesh->positions[v[0]], a);
    pel_vec3_subtract(mesh->positions[v[2]], mesh->positions[v[0]], b);
    pel_vec3_cross(a, b, normal);
}

static bool is_near(const pel_mesh *mesh, int32_t t, const double point[3], double reach)
{
    double center[3] = {0};
    for (int i = 0; i < 3; i++)
        pel_vec3_along(center, 1.0 / 3, mesh->positions[mesh->triangles[t][i]], center);
    return isinf(reach) || pel_vec3_distance(center, point) <= reach;
}

void pel_mesh_mean_radius(const pel_mesh *mesh, const pel_topology *topology, const double point[3], double reach,
                          double *radius, double *edge)
{
    double area = 0, turn = 0, length_sum = 0;
    int64_t count = 0;
    for (int32_t t = 0; t < mesh->triangle_count; t++) {
        double n[3], m[3], cross[3];
        if (!is_near(mesh, t, point, reach))
            continue;
        triangle_normal(mesh, t, n);
        area += pel_vec3_length(n) / 2;
        count++;
        for (int i = 0; i < 3; i++) {
            int32_t twin = topology->twin[3 * t + i];
            const int32_t *v = mesh->triangles[t];
            double length = pel_vec3_distance(mesh->positions[v[i]], mesh->positions[v[(i + 1) % 3]]);
            length_sum += length;
            if (twin < 0)
                continue;
            triangle_normal(mesh, twin / 3, m);
            pel_vec3_cross(n, m, cross);
            double angle = pel_atan2(pel_vec3_length(cross), pel_vec3_dot(n, m));
            /* each inner edge comes twice */
            turn += angle > FLAT_ANGLE ? length * angle / 4 : 0;
        }
    }
    *radius = turn > 0 ? area / turn : (double)HUGE_VAL;
    *edge = count > 0 ? length_sum / (3.0 * (double)count) : 0;
}
