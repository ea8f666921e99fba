#include "geom/solid_surface.h"

#include "math/functions.h"
#include "math/vec3.h"

#include <string.h>

/* of a ball: rings of vertices between the poles, and vertices of a ring */
enum { RINGS = 11, SIDES = 24 };
static const double PI = 3.14159265358979323846;

static int ring_count(const pel_solid *solid)
{
    return pel_solid_is_ball(solid) ? RINGS : RINGS + 1;
}

pel_solid_surface pel_solid_surface_size(const pel_solid *solid)
{
    const pel_solid_row *row = &pel_solid_rows[solid->shape];
    if (!row->is_round)
        return (pel_solid_surface){row->corner_count, row->triangle_count};
    return (pel_solid_surface){ring_count(solid) * SIDES + 2, 2 * ring_count(solid) * SIDES};
}

static void set_triangle(int32_t *triangle, int32_t a, int32_t b, int32_t c)
{
    triangle[0] = a;
    triangle[1] = b;
    triangle[2] = c;
}

/* two half balls apart, from the lower pole to the upper one; of a capsule the ring in the middle stands twice */
static void fill_round(const pel_solid *solid, double (*vertices)[3], int32_t (*triangles)[3])
{
    const int rings = ring_count(solid);
    const double half = solid->half_length;
    for (int r = 0; r < rings; r++) {
        int upper = half > 0 && r >= rings / 2;
        double latitude = PI * ((r - upper + 1.0) / (RINGS + 1.0) - 0.5);
        for (int s = 0; s < SIDES; s++) {
            double longitude = 2 * PI * s / SIDES, across = solid->radius * pel_cos(latitude);
            pel_vec3_set(vertices[r * SIDES + s], across * pel_cos(longitude), across * pel_sin(longitude),
                         solid->radius * pel_sin(latitude) + (upper ? half : -half));
        }
    }
    int32_t low = rings * SIDES, high = low + 1, t = 0;
    pel_vec3_set(vertices[low], 0, 0, -half - solid->radius);
    pel_vec3_set(vertices[high], 0, 0, half + solid->radius);
    for (int s = 0; s < SIDES; s++) {
        int next = (s + 1) % SIDES, last = (rings - 1) * SIDES;
        set_triangle(triangles[t++], low, next, s);
        set_triangle(triangles[t++], high, last + s, last + next);
        for (int r = 0; r + 1 < rings; r++) {
            int a = r * SIDES + s, b = r * SIDES + next;
            set_triangle(triangles[t++], a, b, b + SIDES);
            set_triangle(triangles[t++], a, b + SIDES, a + SIDES);
        }
    }
}

void pel_solid_surface_fill(const pel_solid *solid, double (*vertices)[3], int32_t (*triangles)[3])
{
    const pel_solid_row *row = &pel_solid_rows[solid->shape];
    if (row->is_round) {
        fill_round(solid, vertices, triangles);
        return;
    }
    for (int32_t i = 0; i < row->corner_count; i++)
        pel_solid_corner(solid, i, vertices[i]);
    memcpy(triangles, row->triangles, (size_t)row->triangle_count * sizeof *triangles);
}
