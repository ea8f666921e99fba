/* A node nearer to a crossing than these shares of the edge moves there (Labelle and Shewchuk 2007, table 1, "safe"
   parameters for dihedral angles from 10.7 to 164.8 degrees). */
#include "tetra/lattice.h"

#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "bvh/ray.h"
#include "math/vec3.h"
#include "pellicle/mesh_check.h"

#include <math.h>
#include <string.h>

#define NEAR_LONG 0.24999
#define NEAR_SHORT 0.41189
/* of an edge: an end may lie on the surface but for rounding, and count as outside */
#define ROUNDING 1e-6

/* what crossings are searched with */
typedef struct probe {
    const pel_mesh *surface;
    pel_mesh_query *query;
    pel_tree *tree;
    pel_box *boxes;
    double centre[3];
} probe;

/* ---- numbers ---- */

double pel_lattice_cells(const double low[3], const double high[3], double edge, int32_t cells[3])
{
    double count = 1;
    for (int k = 0; k < 3; k++) {
        double most = floor((high[k] - low[k]) / edge + 0.5);
        most = most < 1 ? 1 : most;
        cells[k] = most < PEL_LATTICE_MOST_CELLS ? (int32_t)most + 2 : PEL_LATTICE_MOST_CELLS + 2;
        count *= cells[k];
    }
    return count;
}

int32_t pel_lattice_corner(const pel_lattice *lattice, int32_t x, int32_t y, int32_t z)
{
    return x + (lattice->cells[0] + 1) * (y + (lattice->cells[1] + 1) * z);
}

int32_t pel_lattice_centre(const pel_lattice *lattice, int32_t x, int32_t y, int32_t z)
{
    return lattice->corner_count + x + lattice->cells[0] * (y + lattice->cells[1] * z);
}

void pel_lattice_place(const pel_lattice *lattice, int32_t node, int32_t place[3])
{
    PEL_ASSERT_INDEX(node, lattice->node_count);
    int32_t is_corner = node < lattice->corner_count, at = is_corner ? node : node - lattice->corner_count;
    int32_t width = lattice->cells[0] + is_corner, height = lattice->cells[1] + is_corner;
    place[0] = at % width;
    place[1] = at / width % height;
    place[2] = at / width / height;
}

/* long edges by their lower node and axis, then short ones by centre and corner */
static size_t edge_between(const pel_lattice *lattice, int32_t a, int32_t b)
{
    if (pel_lattice_is_long(lattice, a, b)) {
        int32_t lower = a < b ? a : b, step = a < b ? b - a : a - b;
        int32_t width = lattice->cells[0] + (a < lattice->corner_count);
        return 3 * (size_t)lower + (step == 1 ? 0 : step == width ? 1 : 2);
    }
    int32_t centre = a < b ? b : a, corner = a < b ? a : b, low[3], high[3];
    pel_lattice_place(lattice, centre, low);
    pel_lattice_place(lattice, corner, high);
    size_t number = 0;
    for (int k = 0; k < 3; k++)
        number += (size_t)(high[k] - low[k]) << k;
    return 3 * (size_t)lattice->node_count + 8 * (size_t)(centre - lattice->corner_count) + number;
}

int32_t pel_lattice_cut(const pel_lattice *lattice, int32_t a, int32_t b)
{
    return lattice->cuts[edge_between(lattice, a, b)] - 1;
}

/* nodes that share an edge with a node; returns how many */
static int neighbours_of(const pel_lattice *lattice, int32_t node, int32_t neighbours[PEL_LATTICE_DEGREE])
{
    const bool is_corner = node < lattice->corner_count;
    int32_t at[3], count = 0;
    pel_lattice_place(lattice, node, at);
    for (int k = 0; k < 3; k++)
        for (int side = -1; side <= 1; side += 2) {
            int32_t to[3] = {at[0], at[1], at[2]};
            to[k] += side;
            if (to[k] >= 0 && to[k] < lattice->cells[k] + is_corner)
                neighbours[count++] = is_corner ? pel_lattice_corner(lattice, to[0], to[1], to[2])
                                                : pel_lattice_centre(lattice, to[0], to[1], to[2]);
        }
    for (int bits = 0; bits < 8; bits++) {
        int32_t to[3];
        bool is_inside = true;
        for (int k = 0; k < 3; k++) {
            to[k] = at[k] + (is_corner ? (bits >> k & 1) - 1 : bits >> k & 1);
            is_inside &= to[k] >= 0 && to[k] < lattice->cells[k] + !is_corner;
        }
        if (is_inside)
            neighbours[count++] = is_corner ? pel_lattice_centre(lattice, to[0], to[1], to[2])
                                            : pel_lattice_corner(lattice, to[0], to[1], to[2]);
    }
    return count;
}

/* ---- crossings ---- */

static pel_status open_probe(const pel_mesh *surface, probe *made, pel_error *error)
{
    const size_t count = (size_t)surface->vertex_count;
    double low[3], high[3];
    made->surface = surface;
    made->boxes = pel_allocate_aligned(count, sizeof *made->boxes);
    if (made->boxes == NULL)
        return pel_fail_memory(error);
    pel_mesh_box(surface, low, high);
    for (int k = 0; k < 3; k++)
        made->centre[k] = 0.5 * (low[k] + high[k]);
    for (size_t v = 0; v < count; v++)
        for (int k = 0; k < 3; k++) {
            float x = (float)(surface->positions[v][k] - made->centre[k]);
            made->boxes[v].low[k] = nextafterf(x, -HUGE_VALF);
            made->boxes[v].high[k] = nextafterf(x, HUGE_VALF);
        }
    pel_status status = pel_tree_create((const double(*)[3])surface->positions, surface->vertex_count,
                                        (const int32_t(*)[3])surface->triangles, surface->triangle_count,
                                        PEL_TREE_TRIANGLES, &made->tree, error);
    if (status != PEL_OK)
        return status;
    pel_tree_refit(made->tree, made->boxes, NULL);
    return pel_mesh_query_create(surface, &made->query, error);
}

static void close_probe(probe *made)
{
    pel_mesh_query_destroy(made->query);
    pel_tree_destroy(made->tree);
    pel_free(made->boxes);
}

/* share of the way from a node inside to one outside at which the surface is crossed first; a node that counts as
   inside but lies on the surface itself may see nothing on its way */
static double crossing(const probe *made, const double inside[3], const double outside[3])
{
    pel_ray ray;
    pel_vec3_copy(inside, ray.origin);
    pel_vec3_subtract(outside, inside, ray.direction);
    pel_ray_hit hit = pel_tree_cast(made->tree, (const double(*)[3])made->surface->positions, made->centre, &ray);
    if (hit.triangle < 0 || hit.distance > 1 + ROUNDING)
        return 0;
    return hit.distance < 1 ? hit.distance : 1;
}

static pel_status add_cut(pel_lattice *lattice, const probe *made, int32_t a, int32_t b, pel_error *error)
{
    int32_t inside = lattice->signs[a] > 0 ? a : b, outside = inside == a ? b : a;
    if (!pel_reserve((void **)&lattice->cut_positions, &lattice->cut_room, (size_t)lattice->cut_count + 1,
                     sizeof *lattice->cut_positions))
        return pel_fail_memory(error);
    const double *from = lattice->positions[inside], *to = lattice->positions[outside];
    double share = crossing(made, from, to), *cut = lattice->cut_positions[lattice->cut_count++];
    for (int k = 0; k < 3; k++)
        cut[k] = from[k] + share * (to[k] - from[k]);
    lattice->cuts[edge_between(lattice, a, b)] = lattice->cut_count;
    return PEL_OK;
}

static pel_status find_cuts(pel_lattice *lattice, const probe *made, pel_error *error)
{
    pel_status status = PEL_OK;
    for (int32_t node = 0; node < lattice->node_count; node++)
        lattice->signs[node] = pel_mesh_query_winding(made->query, lattice->positions[node]) != 0 ? 1 : -1;
    for (int32_t node = 0; status == PEL_OK && node < lattice->node_count; node++) {
        int32_t next[PEL_LATTICE_DEGREE], count = neighbours_of(lattice, node, next);
        for (int i = 0; status == PEL_OK && i < count; i++)
            if (next[i] > node && lattice->signs[node] != lattice->signs[next[i]])
                status = add_cut(lattice, made, node, next[i], error);
    }
    return status;
}

/* moves a node to the nearest crossing that is too near */
static void warp(pel_lattice *lattice, int32_t node)
{
    int32_t next[PEL_LATTICE_DEGREE], count = neighbours_of(lattice, node, next), best = -1;
    double least = 1;
    for (int i = 0; i < count; i++) {
        if (lattice->signs[node] * lattice->signs[next[i]] >= 0)
            continue;
        int32_t cut = pel_lattice_cut(lattice, node, next[i]);
        double length = pel_vec3_distance(lattice->positions[node], lattice->positions[next[i]]);
        double limit = pel_lattice_is_long(lattice, node, next[i]) ? NEAR_LONG : NEAR_SHORT;
        double share = pel_vec3_distance(lattice->positions[node], lattice->cut_positions[cut]) / (limit * length);
        if (share < least) {
            least = share;
            best = cut;
        }
    }
    if (best < 0)
        return;
    pel_vec3_copy(lattice->cut_positions[best], lattice->positions[node]);
    lattice->signs[node] = 0;
}

/* ---- creation ---- */

static void place_nodes(pel_lattice *lattice)
{
    for (int32_t node = 0; node < lattice->node_count; node++) {
        int32_t at[3];
        double half = node < lattice->corner_count ? 0 : 0.5;
        pel_lattice_place(lattice, node, at);
        for (int k = 0; k < 3; k++)
            lattice->positions[node][k] = lattice->low[k] + (at[k] + half - 1) * lattice->spacing[k];
    }
}

pel_status pel_lattice_create(const pel_mesh *surface, double edge, pel_lattice *lattice, pel_error *error)
{
    double high[3];
    probe made = {0};
    *lattice = (pel_lattice){0};
    pel_mesh_box(surface, lattice->low, high);
    pel_lattice_cells(lattice->low, high, edge, lattice->cells);
    const int32_t *n = lattice->cells;
    for (int k = 0; k < 3; k++)
        lattice->spacing[k] = (high[k] - lattice->low[k]) / (n[k] - 2);
    lattice->corner_count = (n[0] + 1) * (n[1] + 1) * (n[2] + 1);
    lattice->node_count = lattice->corner_count + n[0] * n[1] * n[2];
    const size_t nodes = (size_t)lattice->node_count;
    const size_t edges = 3 * nodes + 8 * (nodes - (size_t)lattice->corner_count);
    if (!PEL_ALLOCATE_ALL(PEL_ROOM(lattice->positions, nodes), PEL_ROOM(lattice->signs, nodes),
                          PEL_ROOM(lattice->cuts, edges)))
        return pel_fail_memory(error);
    place_nodes(lattice);
    pel_status status = open_probe(surface, &made, error);
    if (status == PEL_OK)
        status = find_cuts(lattice, &made, error);
    for (int32_t node = 0; status == PEL_OK && node < lattice->node_count; node++)
        warp(lattice, node);
    close_probe(&made);
    return status;
}

void pel_lattice_destroy(pel_lattice *lattice)
{
    PEL_FREE_ALL(lattice->positions, lattice->signs, lattice->cuts, lattice->cut_positions);
    *lattice = (pel_lattice){0};
}
