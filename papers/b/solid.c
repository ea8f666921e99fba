#include "papers/b/solid.h"

#include <pellicle/error.h>
#include <pellicle/measure.h>

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

typedef struct tetrahedron {
    int32_t nodes[4];
    double inverse[3][3]; /* of the matrix of the edges from node 3 at rest, by columns */
    double volume;
} tetrahedron;

/* where a vertex of the surface lies */
typedef struct anchor {
    int32_t nodes[4];
    double weights[4];
} anchor;

struct b_solid {
    const pel_mesh *surface;
    double scale, rest_volume;
    int counts[3];
    double low[3], spacing;
    uint8_t *filled;  /* (cells) */
    int32_t *node_of; /* (points of the lattice), -1 = none */
    int32_t node_count, tetrahedron_count;
    double (*x)[3], (*before)[3], (*velocity)[3], (*force)[3], *weight; /* (node_count) */
    tetrahedron *tetrahedra;
    anchor *anchors;         /* (vertex_count) */
    double (*skin)[3];       /* (vertex_count) scaled */
    double (*skin_force)[3]; /* (vertex_count) */
};

/* corners of a cube by bits; each way from corner 0 to 7 is a tetrahedron */
static const int ways[6][4] = {{0, 1, 3, 7}, {0, 1, 5, 7}, {0, 2, 3, 7}, {0, 2, 6, 7}, {0, 4, 5, 7}, {0, 4, 6, 7}};

static size_t cell_at(const b_solid *solid, const int at[3])
{
    return ((size_t)at[2] * (size_t)solid->counts[1] + (size_t)at[1]) * (size_t)solid->counts[0] + (size_t)at[0];
}

static size_t point_at(const b_solid *solid, const int cell[3], int corner)
{
    size_t x = (size_t)(cell[0] + (corner & 1)), y = (size_t)(cell[1] + (corner >> 1 & 1)),
           z = (size_t)(cell[2] + (corner >> 2 & 1));
    return (z * (size_t)(solid->counts[1] + 1) + y) * (size_t)(solid->counts[0] + 1) + x;
}

static void cell_of(const b_solid *solid, const double x[3], int cell[3])
{
    for (int i = 0; i < 3; i++)
        cell[i] = (int)floor((x[i] - solid->low[i]) / solid->spacing);
}

/* whether the middle of a cell is inside: parity of the triangles above it */
static bool is_inside(const b_solid *solid, const int cell[3])
{
    /* off the middle, so that no edge is met exactly */
    double p[3];
    int above = 0;
    for (int i = 0; i < 3; i++)
        p[i] = solid->low[i] + solid->spacing * (cell[i] + 0.5 + 1.234e-4 * (i + 1));
    for (int32_t t = 0; t < solid->surface->triangle_count; t++) {
        const int32_t *corners = solid->surface->triangles[t];
        const double *a = solid->skin[corners[0]], *b = solid->skin[corners[1]], *c = solid->skin[corners[2]];
        double area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        double u = ((p[0] - a[0]) * (c[1] - a[1]) - (p[1] - a[1]) * (c[0] - a[0])) / area;
        double v = ((b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0])) / area;
        if (area != 0 && u >= 0 && v >= 0 && u + v <= 1 && a[2] + u * (b[2] - a[2]) + v * (c[2] - a[2]) > p[2])
            above++;
    }
    return above % 2 == 1;
}

static void fill_cells(b_solid *solid)
{
    int cell[3];
    for (cell[2] = 0; cell[2] < solid->counts[2]; cell[2]++)
        for (cell[1] = 0; cell[1] < solid->counts[1]; cell[1]++)
            for (cell[0] = 0; cell[0] < solid->counts[0]; cell[0]++)
                solid->filled[cell_at(solid, cell)] = is_inside(solid, cell);
    for (int32_t v = 0; v < solid->surface->vertex_count; v++) {
        cell_of(solid, solid->skin[v], cell);
        solid->filled[cell_at(solid, cell)] = 1;
    }
}

/* inverse of a matrix of columns; returns the determinant */
static double invert(const double m[3][3], double inverse[3][3])
{
    double determinant = 0;
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        for (int c = 0; c < 3; c++) {
            int d = (c + 1) % 3, e = (c + 2) % 3;
            inverse[c][i] = m[j][d] * m[k][e] - m[j][e] * m[k][d];
        }
    }
    for (int c = 0; c < 3; c++)
        determinant += m[0][c] * inverse[c][0];
    for (int i = 0; i < 9; i++)
        inverse[i / 3][i % 3] /= determinant;
    return determinant;
}

/* numbers the corners of the filled cells */
static void number_nodes(b_solid *solid)
{
    int cell[3];
    for (cell[2] = 0; cell[2] < solid->counts[2]; cell[2]++)
        for (cell[1] = 0; cell[1] < solid->counts[1]; cell[1]++)
            for (cell[0] = 0; cell[0] < solid->counts[0]; cell[0]++) {
                if (!solid->filled[cell_at(solid, cell)])
                    continue;
                solid->tetrahedron_count += 6;
                for (int corner = 0; corner < 8; corner++) {
                    int32_t *node = &solid->node_of[point_at(solid, cell, corner)];
                    if (*node < 0)
                        *node = solid->node_count++;
                }
            }
}

static void make_tetrahedra(b_solid *solid, double density)
{
    int32_t count = 0;
    int cell[3];
    for (cell[2] = 0; cell[2] < solid->counts[2]; cell[2]++)
        for (cell[1] = 0; cell[1] < solid->counts[1]; cell[1]++)
            for (cell[0] = 0; cell[0] < solid->counts[0]; cell[0]++) {
                if (!solid->filled[cell_at(solid, cell)])
                    continue;
                for (int way = 0; way < 6; way++) {
                    tetrahedron *made = &solid->tetrahedra[count++];
                    double edges[3][3];
                    for (int k = 0; k < 4; k++) {
                        int corner = ways[way][k];
                        made->nodes[k] = solid->node_of[point_at(solid, cell, corner)];
                        for (int i = 0; i < 3; i++)
                            solid->x[made->nodes[k]][i] =
                                solid->low[i] + solid->spacing * (cell[i] + (corner >> i & 1));
                    }
                    for (int i = 0; i < 3; i++)
                        for (int k = 0; k < 3; k++)
                            edges[i][k] = solid->x[made->nodes[k]][i] - solid->x[made->nodes[3]][i];
                    made->volume = fabs(invert((const double(*)[3])edges, made->inverse)) / 6;
                    for (int k = 0; k < 4; k++)
                        solid->weight[made->nodes[k]] += density * made->volume / 4;
                }
            }
    for (int32_t n = 0; n < solid->node_count; n++)
        solid->weight[n] = 1 / solid->weight[n];
}

/* ties a vertex to the tetrahedron of its cell: the axes by falling coordinate in the cell are the way */
static void tie(b_solid *solid, int32_t v)
{
    int cell[3], corner = 0;
    double at[3], last = 1;
    anchor *tied = &solid->anchors[v];
    cell_of(solid, solid->skin[v], cell);
    for (int i = 0; i < 3; i++)
        at[i] = (solid->skin[v][i] - solid->low[i]) / solid->spacing - cell[i];
    for (int k = 0; k < 4; k++) {
        int next = -1;
        for (int i = 0; i < 3; i++)
            if (!(corner >> i & 1) && (next < 0 || at[i] > at[next]))
                next = i;
        double coordinate = next >= 0 ? at[next] : 0;
        tied->nodes[k] = solid->node_of[point_at(solid, cell, corner)];
        tied->weights[k] = last - coordinate;
        last = coordinate;
        corner |= next >= 0 ? 1 << next : 0;
    }
}

static void carry(b_solid *solid)
{
    for (int32_t v = 0; v < solid->surface->vertex_count; v++)
        for (int i = 0; i < 3; i++) {
            solid->skin[v][i] = 0;
            for (int k = 0; k < 4; k++)
                solid->skin[v][i] += solid->anchors[v].weights[k] * solid->x[solid->anchors[v].nodes[k]][i];
        }
}

static void place(b_solid *solid, int cells)
{
    double high[3], size = 0;
    for (int i = 0; i < 3; i++) {
        solid->low[i] = HUGE_VAL;
        high[i] = -HUGE_VAL;
        for (int32_t v = 0; v < solid->surface->vertex_count; v++) {
            solid->skin[v][i] = solid->scale * solid->surface->positions[v][i];
            solid->low[i] = fmin(solid->low[i], solid->skin[v][i]);
            high[i] = fmax(high[i], solid->skin[v][i]);
        }
        size = fmax(size, high[i] - solid->low[i]);
    }
    solid->spacing = size / cells;
    for (int i = 0; i < 3; i++) {
        solid->low[i] -= 0.01 * solid->spacing;
        solid->counts[i] = (int)ceil((high[i] - solid->low[i]) / solid->spacing) + 1;
    }
}

static double skin_volume(const b_solid *solid)
{
    return pel_surface_volume(solid->skin[0], solid->surface->triangles[0], solid->surface->triangle_count, NULL);
}

pel_status b_solid_create(const pel_mesh *surface, double scale, int cells, double density, b_solid **solid,
                          pel_error *error)
{
    size_t count = (size_t)surface->vertex_count;
    b_solid *made = *solid = calloc(1, sizeof *made);
    if (made == NULL)
        return pel_fail_memory(error);
    *made = (b_solid){.surface = surface, .scale = scale};
    made->skin = calloc(count, sizeof *made->skin);
    made->skin_force = calloc(count, sizeof *made->skin_force);
    made->anchors = calloc(count, sizeof *made->anchors);
    if (made->skin != NULL)
        place(made, cells);
    size_t points = (size_t)(made->counts[0] + 1) * (size_t)(made->counts[1] + 1) * (size_t)(made->counts[2] + 1);
    made->filled = calloc(points, 1);
    made->node_of = malloc(points * sizeof *made->node_of);
    bool whole = made->skin != NULL && made->skin_force != NULL && made->anchors != NULL && made->filled != NULL &&
                 made->node_of != NULL;
    if (whole) {
        memset(made->node_of, -1, points * sizeof *made->node_of);
        made->rest_volume = skin_volume(made);
        fill_cells(made);
        number_nodes(made);
        size_t nodes = (size_t)made->node_count;
        made->x = calloc(nodes, sizeof *made->x);
        made->before = calloc(nodes, sizeof *made->before);
        made->velocity = calloc(nodes, sizeof *made->velocity);
        made->force = calloc(nodes, sizeof *made->force);
        made->weight = calloc(nodes, sizeof *made->weight);
        made->tetrahedra = calloc((size_t)made->tetrahedron_count, sizeof *made->tetrahedra);
        whole = made->x != NULL && made->before != NULL && made->velocity != NULL && made->force != NULL &&
                made->weight != NULL && made->tetrahedra != NULL;
    }
    if (!whole) {
        b_solid_destroy(made);
        *solid = NULL;
        return pel_fail_memory(error);
    }
    make_tetrahedra(made, density);
    for (int32_t v = 0; v < surface->vertex_count; v++)
        tie(made, v);
    return PEL_OK;
}

void b_solid_destroy(b_solid *solid)
{
    if (solid == NULL)
        return;
    void *const blocks[] = {solid->skin,    solid->skin_force, solid->anchors,    solid->filled,
                            solid->node_of, solid->x,          solid->before,     solid->velocity,
                            solid->force,   solid->weight,     solid->tetrahedra, solid};
    for (size_t i = 0; i < sizeof blocks / sizeof *blocks; i++)
        free(blocks[i]);
}

/* the energy as the constraint: dx = -E w grad E / sum w |grad E|^2 */
static void project(b_solid *solid, const tetrahedron *element)
{
    double edges[3][3], f[3][3] = {{0}}, strain[3][3], stress[3][3], trace = 0, density = 0;
    double gradients[4][3] = {{0}}, sum = 0;
    const double lambda = 2 * 0.3 / (1 - 2 * 0.3); /* over mu, for nu = 0.3 */
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            edges[i][k] = solid->x[element->nodes[k]][i] - solid->x[element->nodes[3]][i];
    for (int i = 0; i < 9; i++)
        for (int k = 0; k < 3; k++)
            f[i / 3][i % 3] += edges[i / 3][k] * element->inverse[k][i % 3];
    for (int i = 0; i < 9; i++) {
        int a = i / 3, b = i % 3;
        strain[a][b] = (f[0][a] * f[0][b] + f[1][a] * f[1][b] + f[2][a] * f[2][b] - (a == b)) / 2;
        density += strain[a][b] * strain[a][b];
        trace += a == b ? strain[a][b] : 0;
    }
    double energy = element->volume * (density + lambda / 2 * trace * trace);
    for (int i = 0; i < 9; i++)
        stress[i / 3][i % 3] = 2 * strain[i / 3][i % 3] + (i / 3 == i % 3 ? lambda * trace : 0);
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 3; i++) {
            for (int a = 0; a < 3; a++)
                for (int b = 0; b < 3; b++)
                    gradients[k][i] += element->volume * f[i][a] * stress[a][b] * element->inverse[k][b];
            gradients[3][i] -= gradients[k][i];
        }
    for (int k = 0; k < 4; k++)
        for (int i = 0; i < 3; i++)
            sum += solid->weight[element->nodes[k]] * gradients[k][i] * gradients[k][i];
    if (!(sum > 0) || !(energy > 1e-30))
        return;
    for (int k = 0; k < 4; k++)
        for (int i = 0; i < 3; i++)
            solid->x[element->nodes[k]][i] -= energy / sum * solid->weight[element->nodes[k]] * gradients[k][i];
}

static void load(b_solid *solid, double pressure)
{
    memset(solid->force, 0, (size_t)solid->node_count * sizeof *solid->force);
    pel_surface_volume_gradient(solid->skin[0], solid->surface->vertex_count, solid->surface->triangles[0],
                                solid->surface->triangle_count, NULL, solid->skin_force[0]);
    for (int32_t v = 0; v < solid->surface->vertex_count; v++)
        for (int k = 0; k < 4; k++)
            for (int i = 0; i < 3; i++)
                solid->force[solid->anchors[v].nodes[k]][i] -=
                    pressure * solid->anchors[v].weights[k] * solid->skin_force[v][i];
}

void b_solid_step(b_solid *solid, double pressure)
{
    enum { SWEEPS = 5 };
    const double dt = 1.0 / 60;
    carry(solid);
    load(solid, pressure);
    for (int32_t n = 0; n < solid->node_count; n++)
        for (int i = 0; i < 3; i++) {
            solid->before[n][i] = solid->x[n][i];
            solid->velocity[n][i] += dt * solid->weight[n] * solid->force[n][i];
            solid->x[n][i] += dt * solid->velocity[n][i];
        }
    for (int sweep = 0; sweep < SWEEPS; sweep++)
        for (int32_t t = 0; t < solid->tetrahedron_count; t++)
            project(solid, &solid->tetrahedra[t]);
    for (int32_t n = 0; n < solid->node_count; n++)
        for (int i = 0; i < 3; i++)
            solid->velocity[n][i] = (solid->x[n][i] - solid->before[n][i]) / dt;
    carry(solid);
}

double b_solid_volume(const b_solid *solid)
{
    return solid->rest_volume;
}

double b_solid_volume_ratio(const b_solid *solid)
{
    return skin_volume(solid) / solid->rest_volume;
}

void b_solid_surface(const b_solid *solid, double (*positions)[3])
{
    for (int32_t v = 0; v < solid->surface->vertex_count; v++)
        for (int i = 0; i < 3; i++)
            positions[v][i] = solid->skin[v][i] / solid->scale;
}
