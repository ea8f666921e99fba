/* Isotropic remeshing of a closed mesh on an implicit surface (Botsch and Kobbelt 2004, "A remeshing approach to
   multiresolution modeling"): split edges longer than 4/3 of the target, collapse edges shorter than 4/5 of it, flip
   towards six triangles at each vertex, move vertices to the middle of their neighbours along the surface. Each pass
   works on the topology at its start and changes disjoint edges, so that changes do not interfere; the passes repeat.
   Only sums, products and roots are used: same bits everywhere. */
#include "base/memory.h"
#include "base/room.h"
#include "base/sort.h"
#include "base/status.h"
#include "math/vec3.h"
#include "mesh/allocate.h"
#include "pellicle/topology.h"
#include "primitive/implicit.h"

#include <math.h>
#include <string.h>

/* passes of one kind in a row while they change more than this share of the edges */
#define STILL 0.002
enum { ROUNDS = 6, FINISHING = 4, FLIPS = 2, SMOOTHINGS = 3, REPEATS = 60 };

#define LONGEST (4.0 / 3)
#define SHORTEST 0.8

typedef struct edge_length {
    double length;
    int32_t edge;
} edge_length;

static inline bool is_shorter(const edge_length *a, const edge_length *b)
{
    return a->length < b->length || (a->length == b->length && a->edge < b->edge);
}

PEL_DEFINE_SORT(sort_lengths, edge_length, is_shorter)

/* a mesh with its topology while a pass works on it */
typedef struct pass {
    const pel_implicit *surface;
    double edge; /* target */
    pel_mesh *mesh;
    pel_topology *topology;
    edge_length *edges;  /* (topology->edge_count), shortest first */
    uint8_t *taken;      /* (vertex_count) by an edge of this pass */
    int32_t *degree;     /* (vertex_count) */
    int32_t *moved_to;   /* (vertex_count) the vertex that one was collapsed into, itself if none */
    double (*target)[3]; /* (vertex_count) */
    int32_t changes;     /* edges changed */
} pass;

static void end(pass *work)
{
    pel_topology_destroy(work->topology);
    PEL_FREE_ALL(work->edges, work->taken, work->degree, work->moved_to, work->target);
}

static void edge_ends(const pass *work, int32_t e, int32_t ends[2])
{
    int32_t h = work->topology->half_edge_of_edge[e];
    ends[0] = pel_half_edge_origin(work->topology, h);
    ends[1] = pel_half_edge_target(work->topology, h);
}

/* the corners across an edge, left and right */
static void edge_corners(const pass *work, int32_t e, int32_t corners[2])
{
    int32_t h = work->topology->half_edge_of_edge[e];
    corners[0] = pel_half_edge_origin(work->topology, pel_half_edge_previous(h));
    corners[1] = pel_half_edge_origin(work->topology, pel_half_edge_previous(work->topology->twin[h]));
}

static pel_status begin(pass *work, pel_error *error)
{
    size_t count = (size_t)work->mesh->vertex_count;
    work->topology = NULL;
    pel_status status = pel_topology_create(work->mesh, &work->topology, error);
    if (status != PEL_OK)
        return status;
    int32_t edge_count = work->topology->edge_count;
    if (!PEL_ALLOCATE_ALL(PEL_ROOM(work->edges, edge_count), PEL_ROOM(work->taken, count),
                          PEL_ROOM(work->degree, count), PEL_ROOM(work->moved_to, count),
                          PEL_ROOM(work->target, count)))
        return pel_fail_memory(error);
    for (int32_t v = 0; v < work->mesh->vertex_count; v++)
        work->moved_to[v] = v;
    for (int32_t e = 0; e < edge_count; e++) {
        int32_t ends[2];
        edge_ends(work, e, ends);
        work->edges[e] =
            (edge_length){pel_vec3_distance(work->mesh->positions[ends[0]], work->mesh->positions[ends[1]]), e};
        work->degree[ends[0]]++;
        work->degree[ends[1]]++;
    }
    sort_lengths(work->edges, (size_t)edge_count);
    return PEL_OK;
}

/* the point of the surface between two vertices */
static void middle(const pass *work, const int32_t ends[2], double point[3])
{
    double normal[3];
    pel_vec3_add(work->mesh->positions[ends[0]], work->mesh->positions[ends[1]], point);
    pel_vec3_scale(point, 0.5, point);
    pel_implicit_project(work->surface, point, normal);
}

/* ---- split ---- */

/* replaces the triangle of half-edge h by the half at its origin and appends the other one */
static void halve(pel_mesh *mesh, int32_t h, int32_t vertex)
{
    int32_t t = h / 3, from = h % 3, to = (from + 1) % 3;
    int32_t *appended = mesh->triangles[mesh->triangle_count++];
    memcpy(appended, mesh->triangles[t], 3 * sizeof *appended);
    mesh->triangles[t][to] = vertex;
    appended[from] = vertex;
}

/* a copy with room for one vertex and two triangles an edge */
static pel_mesh *with_room(const pel_mesh *mesh, int32_t edge_count)
{
    pel_mesh *roomy = pel_mesh_allocate(mesh->vertex_count + edge_count, mesh->triangle_count + 2 * edge_count);
    if (roomy == NULL)
        return NULL;
    memcpy(roomy->positions, mesh->positions, (size_t)mesh->vertex_count * sizeof *mesh->positions);
    memcpy(roomy->triangles, mesh->triangles, (size_t)mesh->triangle_count * sizeof *mesh->triangles);
    roomy->vertex_count = mesh->vertex_count;
    roomy->triangle_count = mesh->triangle_count;
    return roomy;
}

/* longest first; of the edges of a triangle one at most */
static pel_status split(pass *work, pel_error *error)
{
    const pel_topology *topology = work->topology;
    pel_mesh *made = with_room(work->mesh, topology->edge_count);
    uint8_t *halved = pel_allocate((size_t)topology->triangle_count, sizeof *halved);
    if (made == NULL || halved == NULL) {
        pel_mesh_destroy(made);
        pel_free(halved);
        return pel_fail_memory(error);
    }
    for (int32_t i = topology->edge_count - 1; i >= 0 && work->edges[i].length > LONGEST * work->edge; i--) {
        int32_t h = topology->half_edge_of_edge[work->edges[i].edge], twin = topology->twin[h], ends[2];
        if (halved[h / 3] || halved[twin / 3])
            continue;
        halved[h / 3] = halved[twin / 3] = 1;
        edge_ends(work, work->edges[i].edge, ends);
        middle(work, ends, made->positions[made->vertex_count]);
        halve(made, h, made->vertex_count);
        halve(made, twin, made->vertex_count);
        made->vertex_count++;
        work->changes++;
    }
    pel_free(halved);
    pel_mesh_destroy(work->mesh);
    work->mesh = made;
    return PEL_OK;
}

/* ---- collapse ---- */

/* how many neighbours two vertices share */
static int shared_neighbours(const pel_topology *topology, int32_t a, int32_t b)
{
    int count = 0;
    int32_t first = topology->corner_of_vertex[a], start = topology->corner_of_vertex[b], h = first;
    do {
        int32_t g = start, neighbour = pel_half_edge_target(topology, h);
        do {
            count += pel_half_edge_target(topology, g) == neighbour;
            g = pel_half_edge_turn(topology, g);
        } while (g != start);
        h = pel_half_edge_turn(topology, h);
    } while (h != first);
    return count;
}

/* whether the triangles about v, but those at the other end, keep their side and stay short with v moved to a point */
static bool may_move(const pass *work, int32_t v, int32_t other, const double point[3])
{
    const pel_topology *topology = work->topology;
    double(*x)[3] = work->mesh->positions;
    int32_t first = topology->corner_of_vertex[v], h = first;
    do {
        int32_t a = pel_half_edge_target(topology, h), b = pel_half_edge_origin(topology, pel_half_edge_previous(h));
        if (a != other && pel_vec3_distance(x[a], point) > LONGEST * work->edge)
            return false;
        if (a != other && b != other) {
            double before[3], after[3];
            pel_vec3_triangle_normal(x[v], x[a], x[b], before);
            pel_vec3_triangle_normal(point, x[a], x[b], after);
            if (pel_vec3_dot(before, after) < 0.5 * pel_vec3_length(before) * pel_vec3_length(after))
                return false;
        }
        h = pel_half_edge_turn(topology, h);
    } while (h != first);
    return true;
}

static void take_ring(pass *work, int32_t v)
{
    int32_t first = work->topology->corner_of_vertex[v], h = first;
    work->taken[v] = 1;
    do {
        work->taken[pel_half_edge_target(work->topology, h)] = 1;
        h = pel_half_edge_turn(work->topology, h);
    } while (h != first);
}

static void collapse_edge(pass *work, int32_t e)
{
    int32_t ends[2], corners[2];
    double point[3];
    edge_ends(work, e, ends);
    edge_corners(work, e, corners);
    if (work->taken[ends[0]] || work->taken[ends[1]] || work->taken[corners[0]] || work->taken[corners[1]])
        return;
    if (work->degree[corners[0]] < 5 || work->degree[corners[1]] < 5 ||
        work->degree[ends[0]] + work->degree[ends[1]] > 12 || shared_neighbours(work->topology, ends[0], ends[1]) != 2)
        return;
    middle(work, ends, point);
    if (!may_move(work, ends[0], ends[1], point) || !may_move(work, ends[1], ends[0], point))
        return;
    take_ring(work, ends[0]);
    take_ring(work, ends[1]);
    pel_vec3_copy(point, work->mesh->positions[ends[0]]);
    work->moved_to[ends[1]] = ends[0];
    work->changes++;
}

/* drops the triangles without area and the vertices that were collapsed */
static void compact(pass *work)
{
    pel_mesh *mesh = work->mesh;
    int32_t *number = work->degree, vertex_count = 0, triangle_count = 0;
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        if (work->moved_to[v] == v) {
            pel_vec3_copy(mesh->positions[v], mesh->positions[vertex_count]);
            number[v] = vertex_count++;
        }
    for (int32_t t = 0; t < mesh->triangle_count; t++) {
        int32_t corners[3];
        for (int i = 0; i < 3; i++)
            corners[i] = number[work->moved_to[mesh->triangles[t][i]]];
        if (corners[0] != corners[1] && corners[1] != corners[2] && corners[2] != corners[0])
            memcpy(mesh->triangles[triangle_count++], corners, sizeof corners);
    }
    mesh->vertex_count = vertex_count;
    mesh->triangle_count = triangle_count;
}

static pel_status collapse(pass *work, pel_error *error)
{
    (void)error;
    for (int32_t i = 0; i < work->topology->edge_count && work->edges[i].length < SHORTEST * work->edge; i++)
        collapse_edge(work, work->edges[i].edge);
    compact(work);
    return PEL_OK;
}

/* ---- flip ---- */

static int excess(int degree)
{
    return (degree - 6) * (degree - 6);
}

/* whether the two triangles stay on their side of the surface when the edge goes between the corners */
static bool may_flip(const pass *work, const int32_t ends[2], const int32_t corners[2])
{
    double(*x)[3] = work->mesh->positions;
    double sides[2][3], after[3];
    pel_vec3_triangle_normal(x[ends[0]], x[ends[1]], x[corners[0]], sides[0]);
    pel_vec3_triangle_normal(x[ends[1]], x[ends[0]], x[corners[1]], sides[1]);
    for (int i = 0; i < 2; i++) {
        if (i == 0)
            pel_vec3_triangle_normal(x[corners[1]], x[corners[0]], x[ends[0]], after);
        else
            pel_vec3_triangle_normal(x[corners[0]], x[corners[1]], x[ends[1]], after);
        for (int k = 0; k < 2; k++)
            if (pel_vec3_dot(after, sides[k]) < 0.5 * pel_vec3_length(after) * pel_vec3_length(sides[k]))
                return false;
    }
    return true;
}

static pel_status flip(pass *work, pel_error *error)
{
    (void)error;
    const pel_topology *topology = work->topology;
    for (int32_t i = topology->edge_count - 1; i >= 0; i--) {
        int32_t e = work->edges[i].edge, ends[2], corners[2];
        const int32_t *degree = work->degree;
        edge_ends(work, e, ends);
        edge_corners(work, e, corners);
        if (work->taken[ends[0]] || work->taken[ends[1]] || work->taken[corners[0]] || work->taken[corners[1]])
            continue;
        int before =
            excess(degree[ends[0]]) + excess(degree[ends[1]]) + excess(degree[corners[0]]) + excess(degree[corners[1]]);
        int after = excess(degree[ends[0]] - 1) + excess(degree[ends[1]] - 1) + excess(degree[corners[0]] + 1) +
                    excess(degree[corners[1]] + 1);
        if (after >= before || degree[ends[0]] < 4 || degree[ends[1]] < 4 || !may_flip(work, ends, corners))
            continue;
        /* the corners must not be neighbours already: around one of them */
        bool neighbours = false;
        int32_t first = topology->corner_of_vertex[corners[0]], h = first;
        do {
            neighbours = neighbours || pel_half_edge_target(topology, h) == corners[1];
            h = pel_half_edge_turn(topology, h);
        } while (h != first);
        if (neighbours)
            continue;
        int32_t g = topology->half_edge_of_edge[e], twin = topology->twin[g];
        work->mesh->triangles[g / 3][(g + 1) % 3] = corners[1];
        work->mesh->triangles[twin / 3][(twin + 1) % 3] = corners[0];
        work->changes++;
        for (int k = 0; k < 2; k++)
            work->taken[ends[k]] = work->taken[corners[k]] = 1;
    }
    return PEL_OK;
}

/* ---- smooth ---- */

static void relax_vertex(pass *work, int32_t v)
{
    const pel_topology *topology = work->topology;
    double sum[3] = {0, 0, 0}, *at = work->target[v], normal[3], areas = 0;
    int32_t first = topology->corner_of_vertex[v], h = first;
    do {
        /* centres of the triangles about v by their area: even areas */
        int32_t a = pel_half_edge_target(topology, h), b = pel_half_edge_origin(topology, pel_half_edge_previous(h));
        double centre[3], twice[3];
        pel_vec3_triangle_normal(work->mesh->positions[v], work->mesh->positions[a], work->mesh->positions[b], twice);
        double area = pel_vec3_length(twice);
        pel_vec3_add(work->mesh->positions[a], work->mesh->positions[b], centre);
        pel_vec3_along(sum, 0.5 * area, centre, sum);
        areas += area;
        h = pel_half_edge_turn(topology, h);
    } while (h != first);
    for (int i = 0; i < 3; i++)
        at[i] = 0.4 * work->mesh->positions[v][i] + 0.6 * sum[i] / areas;
    pel_implicit_project(work->surface, at, normal);
}

static pel_status smooth(pass *work, pel_error *error)
{
    (void)error;
    for (int n = 0; n < SMOOTHINGS; n++) {
        for (int32_t v = 0; v < work->mesh->vertex_count; v++)
            relax_vertex(work, v);
        memcpy(work->mesh->positions, work->target, (size_t)work->mesh->vertex_count * sizeof *work->target);
    }
    return PEL_OK;
}

/* ---- all ---- */

typedef pel_status pass_kind(pass *work, pel_error *error);

/* repeats a pass until it changes almost nothing, up to a limit */
static pel_status repeat(const pel_implicit *surface, double edge, pass_kind *kind, int most, pel_mesh **mesh,
                         pel_error *error)
{
    for (int i = 0; i < most; i++) {
        pass work = {.surface = surface, .edge = edge, .mesh = *mesh};
        pel_status status = begin(&work, error);
        if (status == PEL_OK)
            status = kind(&work, error);
        bool still = work.topology != NULL && work.changes <= STILL * work.topology->edge_count;
        end(&work);
        *mesh = work.mesh;
        if (status != PEL_OK)
            return status;
        if (still && kind != smooth)
            break;
    }
    return PEL_OK;
}

pel_status pel_implicit_remesh(const pel_implicit *surface, double edge, pel_mesh **mesh, pel_error *error)
{
    pel_status status = PEL_OK;
    for (int i = 0; status == PEL_OK && i < ROUNDS + FINISHING; i++) {
        if (i < ROUNDS)
            status = repeat(surface, edge, split, REPEATS, mesh, error);
        if (status == PEL_OK && i < ROUNDS)
            status = repeat(surface, edge, collapse, REPEATS, mesh, error);
        if (status == PEL_OK)
            status = repeat(surface, edge, flip, FLIPS, mesh, error);
        if (status == PEL_OK)
            status = repeat(surface, edge, smooth, 1, mesh, error);
    }
    if (status != PEL_OK) {
        pel_mesh_destroy(*mesh);
        *mesh = NULL;
    }
    return status;
}
