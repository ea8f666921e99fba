/* Isosurface stuffing: each tetrahedron of the lattice keeps its part inside the surface. With p, q nodes inside, z on
   the surface, m outside, and c_pm the crossing between p and m:

       no m                    the whole
       one p                   a tetrahedron of p, the nodes on the surface, and the crossings
       p, q, z, m              a pyramid: z over the quadrilateral p, q, c_qm, c_pm
       p, q, r, m              a prism between p, q, r and its crossings to m
       p, q, m, n              a prism between p, c_pm, c_pn and q, c_qm, c_qn

   The diagonal of a quadrilateral p, q, c_qm, c_pm, which two tetrahedra share, starts at the crossing of the long edge
   of the face p, q, m; if that is p q, at the crossing from the node with the even sum of places (of both alike, from
   the lower number). The first rule gives prisms without a cycle of diagonals, which have a decomposition. */
#include "base/assert.h"
#include "base/memory.h"
#include "base/status.h"
#include "math/functions.h"
#include "math/vec3.h"
#include "pellicle/measure.h"
#include "pellicle/mesh_check.h"
#include "pellicle/topology.h"
#include "pellicle/volume.h"
#include "tetra/lattice.h"

#include <math.h>
#include <string.h>

/* of an edge, at which the walls of a body come apart where they touched */
#define PINCHED_SHARE 0.7

/* vertices of the result are nodes, then crossings (node_count + cut) */
typedef struct stuffing {
    const pel_lattice *lattice;
    int32_t (*tetrahedra)[4];
    size_t room;
    int32_t count;
    bool is_out_of_memory;
} stuffing;

static const double *point_of(const pel_lattice *lattice, int32_t v)
{
    return v < lattice->node_count ? lattice->positions[v] : lattice->cut_positions[v - lattice->node_count];
}

double pel_tetrahedron_volume(const double x[4][3])
{
    double a[3], b[3], c[3], normal[3];
    pel_vec3_subtract(x[1], x[0], a);
    pel_vec3_subtract(x[2], x[0], b);
    pel_vec3_subtract(x[3], x[0], c);
    pel_vec3_cross(a, b, normal);
    return pel_vec3_dot(normal, c) / 6;
}

static void emit(stuffing *job, int32_t a, int32_t b, int32_t c, int32_t d)
{
    if (!pel_reserve((void **)&job->tetrahedra, &job->room, (size_t)job->count + 1, sizeof *job->tetrahedra)) {
        job->is_out_of_memory = true;
        return;
    }
    const int32_t corners[4] = {a, b, c, d};
    double x[4][3];
    for (int k = 0; k < 4; k++)
        pel_vec3_copy(point_of(job->lattice, corners[k]), x[k]);
    int32_t *made = job->tetrahedra[job->count++];
    const bool is_turned = pel_tetrahedron_volume((const double(*)[3])x) < 0;
    memcpy(made, corners, sizeof corners);
    made[2] = corners[is_turned ? 3 : 2];
    made[3] = corners[is_turned ? 2 : 3];
}

static int32_t cut(const stuffing *job, int32_t a, int32_t b)
{
    int32_t number = pel_lattice_cut(job->lattice, a, b);
    PEL_ASSERT(number >= 0);
    return job->lattice->node_count + number;
}

static int parity(const pel_lattice *lattice, int32_t node)
{
    int32_t at[3];
    pel_lattice_place(lattice, node, at);
    return (at[0] + at[1] + at[2]) & 1;
}

/* the diagonal of p, q, c_qm, c_pm ends at c_qm, so that it starts at p */
static bool starts_at(const pel_lattice *lattice, int32_t p, int32_t q, int32_t m)
{
    if (pel_lattice_is_long(lattice, q, m))
        return true;
    if (pel_lattice_is_long(lattice, p, m))
        return false;
    int first = parity(lattice, p), second = parity(lattice, q);
    return first != second ? second == 0 : q < p;
}

static void pyramid(stuffing *job, int32_t apex, const int32_t quad[4], bool first)
{
    if (first) {
        emit(job, apex, quad[0], quad[1], quad[2]);
        emit(job, apex, quad[0], quad[2], quad[3]);
    } else {
        emit(job, apex, quad[1], quad[2], quad[3]);
        emit(job, apex, quad[1], quad[3], quad[0]);
    }
}

/* A prism with triangles a and b; up[i]: the diagonal between i and its next one goes from a_i to b_next. */
static void prism(stuffing *job, const int32_t a[3], const int32_t b[3], const bool up[3])
{
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        const int32_t quad[4] = {a[j], a[k], b[k], b[j]};
        if (up[i] && !up[k]) { /* both diagonals at a_i */
            emit(job, a[i], b[i], b[j], b[k]);
            pyramid(job, a[i], quad, up[j]);
            return;
        }
        if (!up[i] && up[k]) { /* both at b_i */
            emit(job, b[i], a[i], a[j], a[k]);
            pyramid(job, b[i], quad, up[j]);
            return;
        }
    }
    PEL_ASSERT(false);
}

/* nodes inside, on the surface and outside */
typedef struct sorted {
    int32_t in[4], on[4], out[4];
    int in_count, on_count, out_count;
} sorted;

static void stuff_two(stuffing *job, const sorted *s)
{
    const int32_t p = s->in[0], q = s->in[1], m = s->out[0];
    const bool first = starts_at(job->lattice, p, q, m);
    if (s->out_count == 1) {
        const int32_t quad[4] = {p, q, cut(job, q, m), cut(job, p, m)};
        pyramid(job, s->on[0], quad, first);
        return;
    }
    const int32_t n = s->out[1];
    const int32_t a[3] = {p, cut(job, p, m), cut(job, p, n)}, b[3] = {q, cut(job, q, m), cut(job, q, n)};
    /* the quadrilateral of four crossings is on the surface: any diagonal that leaves no cycle */
    const bool second = starts_at(job->lattice, p, q, n);
    const bool up[3] = {first, !first, !second};
    prism(job, a, b, up);
}

static void stuff_three(stuffing *job, const sorted *s)
{
    const int32_t m = s->out[0], *a = s->in;
    const int32_t b[3] = {cut(job, a[0], m), cut(job, a[1], m), cut(job, a[2], m)};
    bool up[3];
    for (int i = 0; i < 3; i++)
        up[i] = starts_at(job->lattice, a[i], a[(i + 1) % 3], m);
    prism(job, a, b, up);
}

static void stuff(stuffing *job, const int32_t nodes[4])
{
    sorted s = {.in_count = 0};
    for (int k = 0; k < 4; k++) {
        const int sign = job->lattice->signs[nodes[k]];
        if (sign > 0)
            s.in[s.in_count++] = nodes[k];
        else if (sign == 0)
            s.on[s.on_count++] = nodes[k];
        else
            s.out[s.out_count++] = nodes[k];
    }
    if (s.in_count == 0)
        return;
    if (s.out_count == 0) {
        emit(job, nodes[0], nodes[1], nodes[2], nodes[3]);
    } else if (s.in_count == 1) {
        for (int k = 0; k < s.out_count; k++)
            s.on[s.on_count++] = cut(job, s.in[0], s.out[k]);
        emit(job, s.in[0], s.on[0], s.on[1], s.on[2]);
    } else if (s.in_count == 2) {
        stuff_two(job, &s);
    } else {
        stuff_three(job, &s);
    }
}

/* the four tetrahedra around the line between a centre and the next one along an axis */
static void stuff_pair(stuffing *job, const int32_t at[3], int axis)
{
    const pel_lattice *lattice = job->lattice;
    const int second = (axis + 1) % 3, third = (axis + 2) % 3;
    int32_t to[3] = {at[0], at[1], at[2]}, ring[4];
    to[axis]++;
    for (int k = 0; k < 4; k++) {
        int32_t corner[3] = {to[0], to[1], to[2]};
        corner[second] += k == 1 || k == 2;
        corner[third] += k >= 2;
        ring[k] = pel_lattice_corner(lattice, corner[0], corner[1], corner[2]);
    }
    const int32_t a = pel_lattice_centre(lattice, at[0], at[1], at[2]);
    const int32_t b = pel_lattice_centre(lattice, to[0], to[1], to[2]);
    for (int k = 0; k < 4; k++)
        stuff(job, (const int32_t[4]){a, b, ring[k], ring[(k + 1) % 4]});
}

static void stuff_all(stuffing *job)
{
    const int32_t *n = job->lattice->cells;
    for (int32_t z = 0; z < n[2]; z++)
        for (int32_t y = 0; y < n[1]; y++)
            for (int32_t x = 0; x < n[0]; x++) {
                const int32_t at[3] = {x, y, z};
                for (int axis = 0; axis < 3; axis++)
                    if (at[axis] + 1 < n[axis])
                        stuff_pair(job, at, axis);
            }
}

/* ---- checks ---- */

static double mean_edge(const pel_mesh *mesh)
{
    double sum = 0;
    for (int32_t t = 0; t < mesh->triangle_count; t++)
        for (int k = 0; k < 3; k++)
            sum += pel_vec3_distance(mesh->positions[mesh->triangles[t][k]],
                                     mesh->positions[mesh->triangles[t][(k + 1) % 3]]);
    return sum / (3.0 * mesh->triangle_count);
}

static pel_status refuse_opening(const pel_mesh *surface, pel_error *error)
{
    pel_topology *topology = NULL;
    int32_t triangle = -1;
    pel_status status = pel_topology_create(surface, &topology, error);
    if (status != PEL_OK)
        return status;
    for (int32_t h = 0; triangle < 0 && h < 3 * surface->triangle_count; h++)
        if (topology->twin[h] < 0)
            triangle = h / 3;
    pel_topology_destroy(topology);
    return pel_refuse_element(error, PEL_BAD_MESH, "triangle", triangle,
                              "close the mesh, with `pellicle check --fix` for example",
                              "an open surface cannot be filled with tetrahedra");
}

static pel_status check_surface(const pel_mesh *surface, double edge, double *used, pel_error *error)
{
    double low[3], high[3];
    int32_t cells[3];
    if (!(edge >= 0 && isfinite(edge)))
        return pel_refuse(error, PEL_BAD_ARGUMENT, "give a length in m above 0, or 0 for the mean edge of the surface",
                          "edge of tetrahedra is %g m", edge);
    *used = edge > 0 ? edge : mean_edge(surface);
    pel_mesh_box(surface, low, high);
    const double count = pel_lattice_cells(low, high, *used, cells);
    if (!(count <= PEL_LATTICE_MOST_CELLS)) {
        const double volume = (high[0] - low[0]) * (high[1] - low[1]) * (high[2] - low[2]);
        pel_fail(error, PEL_BAD_ARGUMENT,
                 "edge of tetrahedra is %g m: the lattice has %.3g cells, at most %d are possible", *used, count,
                 PEL_LATTICE_MOST_CELLS);
        pel_fail_remedy(error, "use an edge of at least %.2g m",
                        1.1 * pel_pow(volume / (0.8 * PEL_LATTICE_MOST_CELLS), 1.0 / 3));
        return PEL_BAD_ARGUMENT;
    }
    pel_mesh_query *query = NULL;
    pel_status status = pel_mesh_query_create(surface, &query, error);
    if (status == PEL_OK && !pel_mesh_query_is_closed(query))
        status = refuse_opening(surface, error);
    pel_mesh_query_destroy(query);
    return status;
}

static pel_status refuse_thin(int32_t triangle, const double at[3], double edge, pel_error *error)
{
    pel_fail(error, PEL_BAD_MESH, "the body is thinner than the tetrahedra (edge %.3g m) at (%.4g, %.4g, %.4g)", edge,
             at[0], at[1], at[2]);
    pel_fail_element(error, "triangle", triangle);
    pel_fail_remedy(error, "use an edge of at most %.2g m, or close the hole or cut off the thin part", 0.5 * edge);
    return PEL_BAD_MESH;
}

/* every part of the given surface has one of the new surface near it */
static pel_status check_parts(const pel_mesh *surface, const pel_mesh *filled, double edge, pel_error *error)
{
    pel_mesh_query *query = NULL;
    pel_status status = pel_mesh_query_create(filled, &query, error);
    for (int32_t t = 0; status == PEL_OK && t < surface->triangle_count; t++) {
        const int32_t *v = surface->triangles[t];
        double at[3];
        for (int k = 0; k < 3; k++)
            at[k] = (surface->positions[v[0]][k] + surface->positions[v[1]][k] + surface->positions[v[2]][k]) / 3;
        if (!pel_mesh_query_reaches(query, at, edge))
            status = refuse_thin(t, at, edge, error);
    }
    pel_mesh_query_destroy(query);
    return status;
}

/* where walls are about as thin as the tetrahedra, their surface may touch itself in an edge */
static pel_status refuse_pinch(double edge, pel_error *error)
{
    pel_fail(error, PEL_BAD_MESH,
             "parts of the body are about as thin as the tetrahedra (edge %.3g m), whose surface touches itself there",
             edge);
    pel_fail_remedy(error, "use an edge of at most %.2g m, or cut off the thin parts", PINCHED_SHARE * edge);
    return PEL_BAD_MESH;
}

/* ---- the whole ---- */

static pel_status collect(const pel_mesh *surface, const pel_lattice *lattice, double edge, stuffing *job,
                          pel_mesh **filled, pel_error *error)
{
    stuff_all(job);
    if (job->is_out_of_memory)
        return pel_fail_memory(error);
    if (job->count == 0)
        return refuse_thin(0, surface->positions[surface->triangles[0][0]], edge, error);
    const size_t count = (size_t)lattice->node_count + (size_t)lattice->cut_count;
    double(*points)[3] = pel_allocate(count, sizeof *points);
    if (points == NULL)
        return pel_fail_memory(error);
    memcpy(points, lattice->positions, (size_t)lattice->node_count * sizeof *points);
    if (lattice->cut_count > 0)
        memcpy(points + lattice->node_count, lattice->cut_positions, (size_t)lattice->cut_count * sizeof *points);
    pel_error found;
    pel_status status =
        pel_mesh_create_filled(points[0], (int32_t)count, job->tetrahedra[0], job->count, filled, &found);
    pel_free(points);
    if (status == PEL_BAD_MESH)
        return refuse_pinch(edge, error);
    if (status != PEL_OK && error != NULL)
        *error = found;
    return status;
}

pel_status pel_mesh_fill(const pel_mesh *surface, double edge, pel_mesh **filled, pel_error *error)
{
    PEL_REFUSE_NULL(surface, error);
    PEL_REFUSE_NULL(filled, error);
    *filled = NULL;
    double used = 0;
    pel_status status = check_surface(surface, edge, &used, error);
    if (status != PEL_OK)
        return status;
    pel_lattice lattice;
    status = pel_lattice_create(surface, used, &lattice, error);
    stuffing job = {.lattice = &lattice};
    if (status == PEL_OK)
        status = collect(surface, &lattice, used, &job, filled, error);
    if (status == PEL_OK)
        status = check_parts(surface, *filled, used, error);
    pel_lattice_destroy(&lattice);
    pel_free(job.tetrahedra);
    if (status != PEL_OK) {
        pel_mesh_destroy(*filled);
        *filled = NULL;
    }
    return status;
}
