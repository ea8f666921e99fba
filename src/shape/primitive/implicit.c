#include "primitive/implicit.h"

#include "base/memory.h"
#include "base/status.h"
#include "math/extremes.h"
#include "math/vec3.h"
#include "mesh/allocate.h"

#include <math.h>

void pel_implicit_project(const pel_implicit *surface, double point[3], double normal[3])
{
    enum { STEPS = 3 };
    for (int i = 0; i < STEPS; i++) {
        double value = surface->value(surface->inner, point, normal);
        pel_vec3_along(point, -value / pel_vec3_squared_length(normal), normal, point);
    }
    pel_vec3_normalize(normal);
}

/* ---- marching tetrahedra ---- */

/* A point of the lattice owns the edges to the 7 points that lie 0 or 1 further along each axis: direction d has bit i
   set if it has a component along axis i. A vertex of the mesh lies on each edge whose ends differ in sign. */
enum { DIRECTIONS = 8 };

typedef struct lattice {
    const pel_implicit *surface;
    double spacing;
    int32_t counts[3];  /* points along each axis */
    double *values;     /* (points) */
    int32_t *vertex_of; /* (points x DIRECTIONS), -1 = none yet */
    pel_mesh *mesh;     /* null while vertices and triangles are counted */
    int64_t vertex_count, triangle_count;
} lattice;

static int64_t point_index(const lattice *grid, const int32_t at[3])
{
    return ((int64_t)at[2] * grid->counts[1] + at[1]) * grid->counts[0] + at[0];
}

static void point_position(const lattice *grid, const int32_t at[3], double position[3])
{
    for (int i = 0; i < 3; i++)
        position[i] = grid->surface->low[i] + grid->spacing * at[i];
}

/* the point that lies `direction` beyond one */
static void step(const int32_t at[3], int direction, int32_t to[3])
{
    for (int i = 0; i < 3; i++)
        to[i] = at[i] + (direction >> i & 1);
}

static pel_status sample(lattice *grid, pel_error *error)
{
    int64_t count = 1;
    for (int i = 0; i < 3; i++) {
        grid->counts[i] = (int32_t)ceil((grid->surface->high[i] - grid->surface->low[i]) / grid->spacing) + 1;
        count *= grid->counts[i];
    }
    grid->values = pel_allocate((size_t)count, sizeof *grid->values);
    grid->vertex_of = pel_allocate((size_t)count, DIRECTIONS * sizeof *grid->vertex_of);
    if (grid->values == NULL || grid->vertex_of == NULL)
        return pel_fail_memory(error);
    for (int64_t i = 0; i < DIRECTIONS * count; i++)
        grid->vertex_of[i] = -1;
    int32_t at[3];
    for (at[2] = 0; at[2] < grid->counts[2]; at[2]++)
        for (at[1] = 0; at[1] < grid->counts[1]; at[1]++)
            for (at[0] = 0; at[0] < grid->counts[0]; at[0]++) {
                double position[3], gradient[3];
                point_position(grid, at, position);
                grid->values[point_index(grid, at)] = grid->surface->value(grid->surface->inner, position, gradient);
            }
    return PEL_OK;
}

/* the vertex between two corners of a cell, given by their bits */
static int32_t vertex_between(lattice *grid, const int32_t cell[3], int a, int b)
{
    /* along the body diagonal's path one corner's bits are within the other's */
    int low = a & b, direction = a ^ b;
    int32_t from[3], to[3];
    step(cell, low, from);
    step(from, direction, to);
    int32_t *vertex = &grid->vertex_of[point_index(grid, from) * DIRECTIONS + direction];
    if (*vertex >= 0)
        return *vertex;
    *vertex = (int32_t)grid->vertex_count++;
    if (grid->mesh != NULL) {
        double p[3], q[3], difference[3];
        double f = grid->values[point_index(grid, from)], g = grid->values[point_index(grid, to)];
        point_position(grid, from, p);
        point_position(grid, to, q);
        pel_vec3_subtract(q, p, difference);
        /* away from the ends: no triangle without area */
        pel_vec3_along(p, pel_min(pel_max(f / (f - g), 0.1), 0.9), difference, p);
        pel_vec3_copy(p, grid->mesh->positions[*vertex]);
    }
    return *vertex;
}

/* a triangle turned so that its normal points along `outward` */
static void put(lattice *grid, int32_t a, int32_t b, int32_t c, const double outward[3])
{
    int64_t t = grid->triangle_count++;
    if (grid->mesh == NULL)
        return;
    double normal[3];
    double(*x)[3] = grid->mesh->positions;
    pel_vec3_triangle_normal(x[a], x[b], x[c], normal);
    bool turned = pel_vec3_dot(normal, outward) < 0;
    int32_t *triangle = grid->mesh->triangles[t];
    triangle[0] = a;
    triangle[1] = turned ? c : b;
    triangle[2] = turned ? b : c;
}

static void march_tetrahedron(lattice *grid, const int32_t cell[3], const int corners[4])
{
    int inside[4], outside[4], inside_count = 0, outside_count = 0;
    double outward[3] = {0, 0, 0};
    for (int i = 0; i < 4; i++) {
        int32_t at[3];
        step(cell, corners[i], at);
        if (grid->values[point_index(grid, at)] < 0)
            inside[inside_count++] = corners[i];
        else
            outside[outside_count++] = corners[i];
    }
    if (inside_count == 0 || outside_count == 0)
        return;
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < inside_count; k++)
            outward[i] -= (double)(inside[k] >> i & 1) / inside_count;
        for (int k = 0; k < outside_count; k++)
            outward[i] += (double)(outside[k] >> i & 1) / outside_count;
    }
    int32_t v[4];
    if (inside_count == 2) {
        v[0] = vertex_between(grid, cell, inside[0], outside[0]);
        v[1] = vertex_between(grid, cell, inside[0], outside[1]);
        v[2] = vertex_between(grid, cell, inside[1], outside[1]);
        v[3] = vertex_between(grid, cell, inside[1], outside[0]);
        put(grid, v[0], v[1], v[2], outward);
        put(grid, v[0], v[2], v[3], outward);
        return;
    }
    for (int k = 0; k < 3; k++)
        v[k] = inside_count == 1 ? vertex_between(grid, cell, inside[0], outside[k])
                                 : vertex_between(grid, cell, inside[k], outside[0]);
    put(grid, v[0], v[1], v[2], outward);
}

static void march_cells(lattice *grid)
{
    /* the six paths from corner 0 to corner 7, one axis at a time */
    static const int tetrahedra[6][4] = {{0, 1, 3, 7}, {0, 1, 5, 7}, {0, 2, 3, 7},
                                         {0, 2, 6, 7}, {0, 4, 5, 7}, {0, 4, 6, 7}};
    int32_t cell[3];
    for (cell[2] = 0; cell[2] + 1 < grid->counts[2]; cell[2]++)
        for (cell[1] = 0; cell[1] + 1 < grid->counts[1]; cell[1]++)
            for (cell[0] = 0; cell[0] + 1 < grid->counts[0]; cell[0]++)
                for (int k = 0; k < 6; k++)
                    march_tetrahedron(grid, cell, tetrahedra[k]);
}

pel_status pel_implicit_march(const pel_implicit *surface, double spacing, pel_mesh **mesh, pel_error *error)
{
    lattice grid = {.surface = surface, .spacing = spacing};
    *mesh = NULL;
    pel_status status = sample(&grid, error);
    if (status == PEL_OK)
        march_cells(&grid);
    if (status == PEL_OK && grid.triangle_count == 0)
        status = pel_fail(error, PEL_BAD_ARGUMENT, "the surface is smaller than a cell of the lattice");
    if (status == PEL_OK) {
        grid.mesh = pel_mesh_allocate((int32_t)grid.vertex_count, (int32_t)grid.triangle_count);
        if (grid.mesh == NULL)
            status = pel_fail_memory(error);
    }
    if (status == PEL_OK) {
        int64_t slots = (int64_t)grid.counts[0] * grid.counts[1] * grid.counts[2] * DIRECTIONS;
        for (int64_t i = 0; i < slots; i++)
            grid.vertex_of[i] = -1;
        grid.vertex_count = grid.triangle_count = 0;
        march_cells(&grid);
        *mesh = grid.mesh;
    }
    pel_free(grid.values);
    pel_free(grid.vertex_of);
    return status;
}
