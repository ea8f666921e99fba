/* Closing holes. The loop of edges around a hole is cut into triangles without new vertices, by dynamic programming
   over its sub-loops: the triangulation with the least largest angle between neighbours and, among these, the least
   area (Liepa 2003, "Filling holes in meshes", section 3). Its cost grows with the cube of the loop, so that a longer
   loop is first divided along short chords.

       loop 0 .. n - 1; best[i][k] cuts the part from i to k, closed by the edge k - i:
       the triangle (i, m, k) beside that edge, best[i][m] and best[m][k] */
#include "base/assert.h"
#include "pellicle/mesh_check.h"

#include "base/hash.h"
#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "math/extremes.h"
#include "math/functions.h"
#include "math/vec3.h"
#include "pellicle/topology.h"

#include <math.h>
#include <string.h>

/* longest loop that is triangulated directly; longer ones are divided: number of starts of chords tried, and least
   share of the loop on either side */
enum { WHOLE_LOOP = 160, CHORD_STARTS = 64, CHORD_SHARE = 4 };

typedef struct fill_weight {
    double angle; /* rad, largest between neighbours; infinite = impossible */
    double area;
} fill_weight;

typedef struct fill_work {
    const pel_mesh *mesh;
    pel_topology *topology;
    uint64_t *edges; /* (edge_room) open addressing; pairs of rim vertices with an edge, plus 1; 0 = free */
    size_t edge_room;
    uint8_t *seen;   /* (3 triangle_count) half-edges of loops that were walked */
    int32_t *loop;   /* (loop_count) vertices, in the winding of the filling */
    int32_t *beyond; /* (loop_count) corner across the edge from vertex i - 1 to i; -1 = a chord */
    size_t loop_room, beyond_room;
    int32_t loop_count;
    fill_weight *weights;    /* (WHOLE_LOOP x WHOLE_LOOP) */
    int32_t *middles;        /* the m of each (i, k) */
    int32_t (*triangles)[3]; /* (triangle_count x 3) added */
    size_t triangle_room;
    int32_t triangle_count;
    pel_fill_summary summary;
} fill_work;

/* ---- edges that are there ---- */

static uint64_t edge_key(int32_t a, int32_t b)
{
    uint32_t low = (uint32_t)(a < b ? a : b), high = (uint32_t)(a < b ? b : a);
    return ((uint64_t)low << 32 | high) + 1;
}

/* where the key is, or would be */
static size_t find_slot(const fill_work *w, uint64_t key)
{
    size_t slot = (size_t)pel_hash_word(PEL_HASH_START, key) % w->edge_room;
    while (w->edges[slot] != 0 && w->edges[slot] != key)
        slot = slot + 1 < w->edge_room ? slot + 1 : 0;
    return slot;
}

static bool has_edge(const fill_work *w, int32_t a, int32_t b)
{
    return w->edges[find_slot(w, edge_key(a, b))] != 0;
}

static void add_edge(fill_work *w, int32_t a, int32_t b)
{
    w->edges[find_slot(w, edge_key(a, b))] = edge_key(a, b);
}

static bool on_rim(const pel_topology *topology, int32_t v)
{
    PEL_ASSERT_INDEX(v, topology->vertex_count);
    int32_t h = topology->corner_of_vertex[v];
    return h >= 0 && topology->twin[h] < 0;
}

/* a loop of n edges gets n - 3 new ones: twice the rim is room for all */
static pel_status collect_edges(fill_work *w)
{
    const pel_topology *topology = w->topology;
    size_t count = 2 * (size_t)topology->boundary_edge_count;
    for (int pass = 0; pass < 2; pass++) {
        for (int32_t e = 0; e < topology->edge_count; e++) {
            int32_t h = topology->half_edge_of_edge[e];
            int32_t a = pel_half_edge_origin(topology, h), b = pel_half_edge_target(topology, h);
            if (!on_rim(topology, a) || !on_rim(topology, b))
                continue;
            if (pass == 0)
                count++;
            else
                add_edge(w, a, b);
        }
        if (pass == 0) {
            w->edge_room = 2 * count + 1;
            w->edges = pel_allocate(w->edge_room, sizeof *w->edges);
        }
        if (w->edges == NULL)
            return PEL_OUT_OF_MEMORY;
    }
    return PEL_OK;
}

/* ---- loops ---- */

static bool append(fill_work *w, int32_t vertex, int32_t beyond)
{
    size_t count = (size_t)w->loop_count + 1;
    if (!pel_reserve((void **)&w->loop, &w->loop_room, count, sizeof *w->loop) ||
        !pel_reserve((void **)&w->beyond, &w->beyond_room, count, sizeof *w->beyond))
        return false;
    w->loop[w->loop_count] = vertex;
    w->beyond[w->loop_count++] = beyond;
    return true;
}

/* the rim half-edge that ends where h begins; rim vertices have one of either kind */
static int32_t previous_on_rim(const pel_topology *topology, int32_t h)
{
    PEL_ASSERT_INDEX(h, 3 * topology->triangle_count);
    int32_t at = pel_half_edge_previous(h);
    while (topology->twin[at] >= 0)
        at = pel_half_edge_previous(topology->twin[at]);
    return at;
}

/* Traverses the boundary backwards, which is the winding of the filling. */
static pel_status walk_loop(fill_work *w, int32_t first)
{
    const pel_topology *topology = w->topology;
    int32_t h = first;
    w->loop_count = 0;
    do {
        /* from the target of h to its origin */
        int32_t tip = pel_half_edge_origin(topology, pel_half_edge_previous(h));
        w->seen[h] = 1;
        if (!append(w, pel_half_edge_origin(topology, h), tip))
            return PEL_OUT_OF_MEMORY;
        h = previous_on_rim(topology, h);
    } while (h != first);
    return PEL_OK;
}

/* ---- cutting ---- */

static const double *position(const fill_work *w, int32_t vertex)
{
    return w->mesh->positions[vertex];
}

/* twice the area vector */
static void area_vector(const fill_work *w, int32_t a, int32_t b, int32_t c, double normal[3])
{
    pel_vec3_triangle_normal(position(w, a), position(w, b), position(w, c), normal);
}

/* angle between two triangles that share an edge; infinite if one has no area */
static double angle_between(const double a[3], const double b[3])
{
    double scale = pel_vec3_length(a) * pel_vec3_length(b);
    if (!(scale > 0))
        return HUGE_VAL;
    return pel_acos(pel_min(pel_max(pel_vec3_dot(a, b) / scale, -1), 1));
}

static fill_weight *weight_at(const fill_work *w, int32_t i, int32_t k)
{
    return &w->weights[i * WHOLE_LOOP + k];
}

/* angle across the edge from part i to part k (i < k) of the loop, to the triangle that closes that part */
static double angle_across(const fill_work *w, const int32_t *loop, const int32_t *beyond, int32_t i, int32_t k,
                           const double normal[3])
{
    double other[3];
    if (k == i + 1) {
        if (beyond[k] < 0)
            return 0;
        area_vector(w, loop[k], loop[i], beyond[k], other);
    } else {
        area_vector(w, loop[i], loop[w->middles[i * WHOLE_LOOP + k]], loop[k], other);
    }
    return angle_between(normal, other);
}

static fill_weight weigh(const fill_work *w, const int32_t *loop, const int32_t *beyond, int32_t count, int32_t i,
                         int32_t m, int32_t k)
{
    const fill_weight *left = weight_at(w, i, m), *right = weight_at(w, m, k);
    double normal[3], closing[3];
    area_vector(w, loop[i], loop[m], loop[k], normal);
    double angle = pel_max(left->angle, right->angle);
    angle = pel_max(angle, angle_across(w, loop, beyond, i, m, normal));
    angle = pel_max(angle, angle_across(w, loop, beyond, m, k, normal));
    if (i == 0 && k == count - 1 && beyond[0] >= 0) {
        area_vector(w, loop[0], loop[k], beyond[0], closing);
        angle = pel_max(angle, angle_between(normal, closing));
    }
    double area = pel_vec3_length(normal) / 2;
    return (fill_weight){area > 0 ? angle : HUGE_VAL, left->area + right->area + area};
}

static bool is_better(fill_weight a, fill_weight b)
{
    /* angles that differ by rounding are one */
    const double noise = 1e-9;
    if (fabs(a.angle - b.angle) > noise)
        return a.angle < b.angle;
    return a.area < b.area;
}

static void find_best(fill_work *w, const int32_t *loop, const int32_t *beyond, int32_t count, int32_t i, int32_t k)
{
    fill_weight best = {HUGE_VAL, HUGE_VAL};
    bool closes = i == 0 && k == count - 1;
    w->middles[i * WHOLE_LOOP + k] = i + 1;
    if (closes || !has_edge(w, loop[i], loop[k])) {
        for (int32_t m = i + 1; m < k; m++) {
            fill_weight weight = weigh(w, loop, beyond, count, i, m, k);
            if (weight.angle < HUGE_VAL && (best.angle == HUGE_VAL || is_better(weight, best))) {
                best = weight;
                w->middles[i * WHOLE_LOOP + k] = m;
            }
        }
    }
    *weight_at(w, i, k) = best;
}

static bool add_triangle(fill_work *w, int32_t a, int32_t b, int32_t c)
{
    if (!pel_reserve((void **)&w->triangles, &w->triangle_room, (size_t)w->triangle_count + 1, sizeof *w->triangles))
        return false;
    int32_t *triangle = w->triangles[w->triangle_count++];
    triangle[0] = a;
    triangle[1] = b;
    triangle[2] = c;
    return true;
}

/* the triangles of the part from i to k */
static bool add_part(fill_work *w, const int32_t *loop, int32_t i, int32_t k)
{
    if (k - i < 2)
        return true;
    int32_t m = w->middles[i * WHOLE_LOOP + k];
    if (m - i > 1)
        add_edge(w, loop[i], loop[m]);
    if (k - m > 1)
        add_edge(w, loop[m], loop[k]);
    return add_triangle(w, loop[i], loop[m], loop[k]) && add_part(w, loop, i, m) && add_part(w, loop, m, k);
}

/* a loop of at most WHOLE_LOOP edges; *filled tells whether it can be done */
static pel_status cut_loop(fill_work *w, const int32_t *loop, const int32_t *beyond, int32_t count, bool *filled)
{
    for (int32_t i = 0; i + 1 < count; i++)
        *weight_at(w, i, i + 1) = (fill_weight){0, 0};
    for (int32_t length = 2; length < count; length++)
        for (int32_t i = 0; i + length < count; i++)
            find_best(w, loop, beyond, count, i, i + length);
    *filled = weight_at(w, 0, count - 1)->angle < HUGE_VAL;
    return !*filled || add_part(w, loop, 0, count - 1) ? PEL_OK : PEL_OUT_OF_MEMORY;
}

/* the shortest chord relative to the parts it divides; false if all candidates are edges already */
static bool find_chord(const fill_work *w, const int32_t *loop, int32_t count, int32_t *from, int32_t *to)
{
    double least = HUGE_VAL;
    int32_t stride = count / CHORD_STARTS > 0 ? count / CHORD_STARTS : 1;
    for (int32_t i = 0; i < count; i += stride)
        for (int32_t j = i + count / CHORD_SHARE; j < count && j - i <= count - count / CHORD_SHARE; j++) {
            double length = pel_vec3_distance(position(w, loop[i]), position(w, loop[j]));
            if (length < least && length > 0 && !has_edge(w, loop[i], loop[j])) {
                least = length;
                *from = i;
                *to = j;
            }
        }
    return least < HUGE_VAL;
}

static pel_status fill_loop(fill_work *w, const int32_t *loop, const int32_t *beyond, int32_t count, bool *filled);

/* the parts of a loop on both sides of a chord, in a separate block */
static pel_status fill_parts(fill_work *w, const int32_t *loop, const int32_t *beyond, int32_t count, int32_t from,
                             int32_t to, bool *filled)
{
    int32_t inner = to - from + 1, outer = count - inner + 2;
    int32_t *block = pel_allocate(2 * (size_t)(inner + outer), sizeof *block);
    if (block == NULL)
        return PEL_OUT_OF_MEMORY;
    int32_t *parts[2] = {block, block + inner}, *edges[2] = {block + inner + outer, block + 2 * inner + outer};
    memcpy(parts[0], loop + from, (size_t)inner * sizeof *block);
    memcpy(edges[0], beyond + from, (size_t)inner * sizeof *block);
    edges[0][0] = -1;
    for (int32_t i = 0; i < outer; i++) {
        parts[1][i] = loop[(to + i) % count];
        edges[1][i] = beyond[(to + i) % count];
    }
    edges[1][0] = -1;
    add_edge(w, loop[from], loop[to]);
    pel_status status = fill_loop(w, parts[0], edges[0], inner, filled);
    if (status == PEL_OK && *filled)
        status = fill_loop(w, parts[1], edges[1], outer, filled);
    pel_free(block);
    return status;
}

static pel_status fill_loop(fill_work *w, const int32_t *loop, const int32_t *beyond, int32_t count, bool *filled)
{
    int32_t from = 0, to = 0;
    if (count <= WHOLE_LOOP)
        return cut_loop(w, loop, beyond, count, filled);
    *filled = find_chord(w, loop, count, &from, &to);
    return *filled ? fill_parts(w, loop, beyond, count, from, to, filled) : PEL_OK;
}

/* ---- all of it ---- */

/* 1 = equilateral, 0 = flat, as in a report */
static double quality(const fill_work *w, const int32_t triangle[3])
{
    double normal[3], squares = 0;
    area_vector(w, triangle[0], triangle[1], triangle[2], normal);
    for (int i = 0; i < 3; i++) {
        double length = pel_vec3_distance(position(w, triangle[i]), position(w, triangle[(i + 1) % 3]));
        squares += length * length;
    }
    return squares > 0 ? 2 * sqrt(3.0) * pel_vec3_length(normal) / squares : 0;
}

static pel_status fill_hole(fill_work *w, int32_t first, int32_t edge_limit)
{
    int32_t before = w->triangle_count;
    bool filled = false;
    pel_status status = walk_loop(w, first);
    /* the rim of a single triangle encloses no hole */
    bool lone = w->loop_count == 3 && w->beyond[0] == w->loop[1];
    if (status == PEL_OK && w->loop_count >= 3 && w->loop_count <= edge_limit && !lone)
        status = fill_loop(w, w->loop, w->beyond, w->loop_count, &filled);
    if (status != PEL_OK)
        return status;
    if (!filled)
        w->triangle_count = before;
    w->summary.filled_holes += filled;
    w->summary.left_holes += !filled;
    for (int32_t t = before; t < w->triangle_count; t++)
        w->summary.quality_min = pel_min(w->summary.quality_min, quality(w, w->triangles[t]));
    return PEL_OK;
}

static pel_status fill_holes(fill_work *w, int32_t edge_limit)
{
    if (!PEL_ALLOCATE_ALL(PEL_ROOM(w->seen, 3 * (size_t)w->mesh->triangle_count),
                          PEL_ROOM(w->weights, (size_t)WHOLE_LOOP * WHOLE_LOOP),
                          PEL_ROOM(w->middles, (size_t)WHOLE_LOOP * WHOLE_LOOP)))
        return PEL_OUT_OF_MEMORY;
    pel_status status = collect_edges(w);
    for (int32_t h = 0; status == PEL_OK && h < 3 * w->mesh->triangle_count; h++)
        if (w->topology->twin[h] < 0 && w->seen[h] == 0)
            status = fill_hole(w, h, edge_limit);
    return status;
}

static pel_status write_mesh(const fill_work *w, pel_mesh **filled, pel_error *error)
{
    const pel_mesh *mesh = w->mesh;
    size_t old_count = (size_t)mesh->triangle_count, count = old_count + (size_t)w->triangle_count;
    int32_t(*triangles)[3] = pel_allocate(count, sizeof *triangles);
    if (triangles == NULL)
        return pel_fail_memory(error);
    memcpy(triangles, mesh->triangles, old_count * sizeof *triangles);
    if (w->triangle_count > 0)
        memcpy(triangles + old_count, w->triangles, (size_t)w->triangle_count * sizeof *triangles);
    pel_status status =
        pel_mesh_create(mesh->positions[0], mesh->vertex_count, triangles[0], (int32_t)count, filled, error);
    for (int32_t f = 0; status == PEL_OK && f < mesh->field_count; f++) {
        const pel_field *field = &mesh->fields[f];
        status = pel_mesh_add_field(*filled, field->name, field->component_count, field->values, error);
    }
    pel_free(triangles);
    if (status != PEL_OK) {
        pel_mesh_destroy(*filled);
        *filled = NULL;
    }
    return status;
}

pel_status pel_mesh_fill_holes(const pel_mesh *mesh, int32_t edge_limit, pel_mesh **filled, pel_fill_summary *summary,
                               pel_error *error)
{
    if (mesh == NULL || filled == NULL || edge_limit < 3)
        return pel_fail(error, PEL_BAD_ARGUMENT, "%s",
                        mesh == NULL     ? "mesh is null"
                        : filled == NULL ? "filled is null"
                                         : "edge_limit is below 3");
    *filled = NULL;
    fill_work w = {.mesh = mesh, .summary = {.quality_min = 1}};
    pel_status status = pel_topology_create(mesh, &w.topology, error);
    if (status == PEL_OK) {
        status = fill_holes(&w, edge_limit);
        if (status != PEL_OK)
            pel_fail_memory(error);
    }
    w.summary.triangles = w.triangle_count;
    if (status == PEL_OK)
        status = write_mesh(&w, filled, error);
    if (status == PEL_OK && summary != NULL)
        *summary = w.summary;
    pel_topology_destroy(w.topology);
    PEL_FREE_ALL(w.edges, w.seen, w.loop, w.beyond, w.weights, w.middles, w.triangles);
    return status;
}
