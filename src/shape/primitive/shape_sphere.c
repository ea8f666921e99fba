/* Geodesic sphere, class I: each face of an icosahedron is cut into frequency^2 triangles, whose corners are pushed out
   to the sphere. The icosahedron lies on an edge, as three golden rectangles in the coordinate planes (the usual
   orientation, so that "nearest to (0, 0, 1)" selects the same vertex as in other programs), or has a vertex on top for
   shapes with a pole. Vertices are numbered corners first, then the inner points of the 30 sides, then of the 20 faces.
   Only sqrt is used, so the positions are the same bits everywhere. */
#include "primitive/shape_build.h"

#include "base/status.h"
#include "math/vec3.h"
#include "mesh/allocate.h"

#include <math.h>
#include <string.h>

enum { CORNERS = 12, SIDES = 30, FACES = 20 };

/* counter-clockwise seen from outside */
static const int8_t faces[FACES][3] = {
    {0, 1, 2},  {0, 2, 3},  {0, 3, 4},  {0, 4, 5},  {0, 5, 1},   {1, 6, 2},   {2, 7, 3},
    {3, 8, 4},  {4, 9, 5},  {5, 10, 1}, {6, 7, 2},  {7, 8, 3},   {8, 9, 4},   {9, 10, 5},
    {10, 6, 1}, {11, 7, 6}, {11, 8, 7}, {11, 9, 8}, {11, 10, 9}, {11, 6, 10},
};

typedef struct icosahedron {
    double corners[CORNERS][3];
    int8_t sides[SIDES][2];           /* lower corner first */
    int8_t side_of[CORNERS][CORNERS]; /* -1 = none */
} icosahedron;

/* (0, +-a, +-b) and its cyclic permutations; an order that suits the faces */
static void fill_lying_corners(double corners[CORNERS][3])
{
    double root = sqrt(5.0), a = sqrt((5 - root) / 10), b = sqrt((5 + root) / 10);
    const double lying[CORNERS][3] = {
        {0, a, b},  {0, -a, b}, {b, 0, a},  {a, b, 0},   {-a, b, 0},  {-b, 0, a},
        {a, -b, 0}, {b, 0, -a}, {0, a, -b}, {-b, 0, -a}, {-a, -b, 0}, {0, -a, -b},
    };
    memcpy(corners, lying, sizeof lying);
}

/* pole, five vertices at height 1/sqrt(5), five at -1/sqrt(5) turned by 36 degrees, pole */
static void fill_standing_corners(double corners[CORNERS][3])
{
    /* cosine and sine of 0, 36, ... 324 degrees */
    double root = sqrt(5.0);
    double c36 = (root + 1) / 4, c72 = (root - 1) / 4;
    double s36 = sqrt(10 - 2 * root) / 4, s72 = sqrt(10 + 2 * root) / 4;
    const double cosines[10] = {1, c36, c72, -c72, -c36, -1, -c36, -c72, c72, c36};
    const double sines[10] = {0, s36, s72, s72, s36, 0, -s36, -s72, -s72, -s36};
    double height = 1 / root, width = 2 / root;
    pel_vec3_set(corners[0], 0, 0, 1);
    for (int k = 0; k < 5; k++) {
        pel_vec3_set(corners[1 + k], width * cosines[2 * k], width * sines[2 * k], height);
        pel_vec3_set(corners[6 + k], width * cosines[2 * k + 1], width * sines[2 * k + 1], -height);
    }
    pel_vec3_set(corners[11], 0, 0, -1);
}

static void fill_sides(icosahedron *base)
{
    int8_t count = 0;
    memset(base->side_of, -1, sizeof base->side_of);
    for (int f = 0; f < FACES; f++) {
        for (int i = 0; i < 3; i++) {
            int8_t a = faces[f][i], b = faces[f][(i + 1) % 3];
            if (base->side_of[a][b] >= 0)
                continue;
            base->sides[count][0] = a < b ? a : b;
            base->sides[count][1] = a < b ? b : a;
            base->side_of[a][b] = base->side_of[b][a] = count++;
        }
    }
}

/* the point (wa a + wb b + wc c), pushed out to the sphere */
static void place(const double a[3], int32_t wa, const double b[3], int32_t wb, const double c[3], int32_t wc,
                  double radius, double point[3])
{
    for (int i = 0; i < 3; i++)
        point[i] = (double)wa * a[i] + (double)wb * b[i] + (double)wc * c[i];
    pel_vec3_scale(point, radius / pel_vec3_length(point), point);
}

static int32_t side_vertex(const icosahedron *base, int32_t frequency, int8_t a, int8_t b, int32_t step_from_a)
{
    int32_t step = a < b ? step_from_a : frequency - step_from_a;
    return CORNERS + base->side_of[a][b] * (frequency - 1) + step - 1;
}

/* number of the point i steps from corner 0 towards corner 1 and j towards corner 2 of a face */
static int32_t face_vertex(const icosahedron *base, int32_t frequency, int f, int32_t i, int32_t j)
{
    int8_t a = faces[f][0], b = faces[f][1], c = faces[f][2];
    if (i == 0 && j == 0)
        return a;
    if (i == frequency)
        return b;
    if (j == frequency)
        return c;
    if (j == 0)
        return side_vertex(base, frequency, a, b, i);
    if (i == 0)
        return side_vertex(base, frequency, a, c, j);
    if (i + j == frequency)
        return side_vertex(base, frequency, b, c, j);
    int32_t inner = (frequency - 1) * (frequency - 2) / 2;
    int32_t before_row = (i - 1) * (frequency - 1) - i * (i - 1) / 2;
    return CORNERS + SIDES * (frequency - 1) + f * inner + before_row + j - 1;
}

static void fill_positions(const icosahedron *base, int32_t frequency, double radius, double (*positions)[3])
{
    for (int k = 0; k < CORNERS; k++)
        pel_vec3_scale(base->corners[k], radius, positions[k]);
    for (int k = 0; k < SIDES; k++) {
        int8_t a = base->sides[k][0], b = base->sides[k][1];
        for (int32_t i = 1; i < frequency; i++)
            place(base->corners[a], frequency - i, base->corners[b], i, base->corners[a], 0, radius,
                  positions[side_vertex(base, frequency, a, b, i)]);
    }
    for (int f = 0; f < FACES; f++)
        for (int32_t i = 1; i < frequency - 1; i++)
            for (int32_t j = 1; i + j < frequency; j++)
                place(base->corners[faces[f][0]], frequency - i - j, base->corners[faces[f][1]], i,
                      base->corners[faces[f][2]], j, radius, positions[face_vertex(base, frequency, f, i, j)]);
}

static void fill_triangles(const icosahedron *base, int32_t frequency, int32_t (*triangles)[3])
{
    for (int f = 0; f < FACES; f++) {
        for (int32_t i = 0; i < frequency; i++) {
            for (int32_t j = 0; i + j < frequency; j++) {
                int32_t right = face_vertex(base, frequency, f, i + 1, j);
                int32_t left = face_vertex(base, frequency, f, i, j + 1);
                pel_shape_put_triangle(&triangles, face_vertex(base, frequency, f, i, j), right, left);
                if (i + j + 1 < frequency)
                    pel_shape_put_triangle(&triangles, right, face_vertex(base, frequency, f, i + 1, j + 1), left);
            }
        }
    }
}

pel_status pel_shape_geodesic_sphere(int32_t frequency, double radius, bool standing, pel_mesh **mesh, pel_error *error)
{
    int32_t squared = frequency * frequency;
    pel_mesh *made = pel_mesh_allocate(10 * squared + 2, FACES * squared);
    if (made == NULL)
        return pel_fail_memory(error);
    icosahedron base;
    if (standing)
        fill_standing_corners(base.corners);
    else
        fill_lying_corners(base.corners);
    fill_sides(&base);
    fill_positions(&base, frequency, radius, made->positions);
    fill_triangles(&base, frequency, made->triangles);
    *mesh = made;
    return PEL_OK;
}
