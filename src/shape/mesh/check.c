/* Everything that can be wrong with a mesh, found in near-linear time: edges by the edge table, fans and components by
   disjoint sets. Two corners of a vertex belong to one fan when their triangles share an edge at that vertex; a vertex
   with several fans is not manifold. Components and boundary loops are counted over fans, not vertices, so that pieces
   that merely touch stay apart. */
#include "pellicle/mesh_check.h"

#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "mesh/duplicate.h"
#include "mesh/edge_table.h"
#include "mesh/figures.h"
#include "mesh/flat_triangle.h"
#include "mesh/issue.h"
#include "mesh/patch.h"
#include "mesh/union_find.h"
#include "mesh/weld.h"

#include <math.h>
#include <string.h>

/* data shared by the passes */
typedef struct inspection {
    const pel_mesh *mesh;
    const int32_t (*triangles)[3];
    pel_mesh_report *report;
    uint8_t *not_finite; /* (vertex_count) */
    uint8_t *skip;       /* (triangle_count) bad index or repeated vertex: no part in the topology */
    pel_edge_table edges;
    pel_patches patches;
    int32_t *fan_of_corner;         /* (3 triangle_count) disjoint sets of corners */
    int32_t *component_of_triangle; /* (triangle_count) -1 = skipped */
    int32_t *scratch;               /* (max of vertex_count and triangle_count) */
} inspection;

static pel_status find_bad_vertices(inspection *it)
{
    for (int32_t v = 0; v < it->mesh->vertex_count; v++) {
        const double *p = it->mesh->positions[v];
        it->not_finite[v] = !(isfinite(p[0]) && isfinite(p[1]) && isfinite(p[2]));
        if (it->not_finite[v] && pel_issue_add(it->report, PEL_ISSUE_NOT_FINITE, v, -1, -1) != PEL_OK)
            return PEL_OUT_OF_MEMORY;
    }
    return PEL_OK;
}

/* -1 = all indices are fine */
static int bad_corner(const inspection *it, int32_t t)
{
    for (int i = 0; i < 3; i++)
        if (it->triangles[t][i] < 0 || it->triangles[t][i] >= it->mesh->vertex_count)
            return i;
    return -1;
}

static pel_status inspect_triangle(inspection *it, int32_t t)
{
    const int32_t *v = it->triangles[t];
    int bad = bad_corner(it, t);
    it->skip[t] = 1;
    if (bad >= 0)
        return pel_issue_add(it->report, PEL_ISSUE_BAD_INDEX, t, bad, v[bad]);
    if (v[0] == v[1] || v[0] == v[2])
        return pel_issue_add(it->report, PEL_ISSUE_REPEATED_VERTEX, t, v[0], -1);
    if (v[1] == v[2])
        return pel_issue_add(it->report, PEL_ISSUE_REPEATED_VERTEX, t, v[1], -1);
    it->skip[t] = 0;
    if (it->not_finite[v[0]] || it->not_finite[v[1]] || it->not_finite[v[2]])
        return PEL_OK;
    if (pel_triangle_is_flat(it->mesh->positions[v[0]], it->mesh->positions[v[1]], it->mesh->positions[v[2]]))
        return pel_issue_add(it->report, PEL_ISSUE_ZERO_AREA, t, -1, -1);
    return PEL_OK;
}

static pel_status find_bad_triangles(inspection *it)
{
    pel_status status = PEL_OK;
    for (int32_t t = 0; t < it->mesh->triangle_count && status == PEL_OK; t++)
        status = inspect_triangle(it, t);
    return status;
}

static pel_status find_duplicates(inspection *it)
{
    const pel_mesh *mesh = it->mesh;
    pel_status status = pel_find_duplicate_triangles(it->triangles, mesh->triangle_count, it->skip, it->scratch);
    for (int32_t t = 0; t < mesh->triangle_count && status == PEL_OK; t++)
        if (it->scratch[t] >= 0 && it->scratch[t] != t)
            status = pel_issue_add(it->report, PEL_ISSUE_DUPLICATE_TRIANGLE, t, it->scratch[t], -1);
    return status;
}

static pel_status find_duplicate_vertices(inspection *it)
{
    int32_t place_count, vertex_count = it->mesh->vertex_count;
    int32_t *first_of_place = pel_allocate((size_t)vertex_count, sizeof *first_of_place);
    if (first_of_place == NULL)
        return PEL_OUT_OF_MEMORY;
    pel_status status =
        pel_weld_points((const double(*)[3])it->mesh->positions, vertex_count, 0, it->scratch, &place_count);
    for (int32_t v = 0, seen = 0; v < vertex_count && status == PEL_OK; v++) {
        int32_t place = it->scratch[v];
        if (place == seen)
            first_of_place[seen++] = v;
        else
            status = pel_issue_add(it->report, PEL_ISSUE_DUPLICATE_VERTEX, v, first_of_place[place], -1);
    }
    pel_free(first_of_place);
    return status;
}

static pel_status find_isolated_vertices(inspection *it)
{
    int32_t *used = it->scratch;
    if (it->mesh->tetrahedron_count > 0)
        return PEL_OK; /* tetrahedra have the vertices inside */
    memset(used, 0, (size_t)it->mesh->vertex_count * sizeof *used);
    for (int32_t t = 0; t < it->mesh->triangle_count; t++)
        if (bad_corner(it, t) < 0)
            used[it->triangles[t][0]] = used[it->triangles[t][1]] = used[it->triangles[t][2]] = 1;
    pel_status status = PEL_OK;
    for (int32_t v = 0; v < it->mesh->vertex_count && status == PEL_OK; v++)
        if (!used[v])
            status = pel_issue_add(it->report, PEL_ISSUE_ISOLATED_VERTEX, v, -1, -1);
    return status;
}

static int32_t origin(const inspection *it, int32_t h)
{
    return it->triangles[h / 3][h % 3];
}

static int32_t next(int32_t h)
{
    return h % 3 == 2 ? h - 2 : h + 1;
}

/* part of a surface that no winding makes consistent: turning triangles would only move its seam */
static bool is_one_sided(const inspection *it, int32_t t)
{
    return it->patches.non_orientable[it->patches.patch_of_triangle[t]] != 0;
}

static pel_status classify_edges(inspection *it)
{
    pel_status status = PEL_OK;
    for (int32_t e = 0; e < it->edges.edge_count && status == PEL_OK; e++) {
        int32_t h = it->edges.half_edge_of_edge[e], other = it->edges.next_in_edge[h];
        int32_t a = origin(it, h), b = origin(it, next(h));
        if (other < 0)
            status = pel_issue_add(it->report, PEL_ISSUE_BOUNDARY_EDGE, e, a, b);
        else if (it->edges.next_in_edge[other] >= 0)
            status = pel_issue_add(it->report, PEL_ISSUE_NON_MANIFOLD_EDGE, e, a, b);
        else if (origin(it, other) == a && !is_one_sided(it, h / 3))
            status = pel_issue_add(it->report, PEL_ISSUE_INCONSISTENT_WINDING, e, a, b);
    }
    return status;
}

/* joins the corners at both ends of each edge */
static void join_fans(inspection *it)
{
    int32_t *fan = it->fan_of_corner;
    pel_union_find_reset(fan, 3 * it->mesh->triangle_count);
    for (int32_t e = 0; e < it->edges.edge_count; e++) {
        int32_t first = it->edges.half_edge_of_edge[e];
        for (int32_t h = it->edges.next_in_edge[first]; h >= 0; h = it->edges.next_in_edge[h]) {
            bool same_direction = origin(it, h) == origin(it, first);
            pel_union_find_join(fan, first, same_direction ? h : next(h));
            pel_union_find_join(fan, next(first), same_direction ? next(h) : h);
        }
    }
}

static pel_status find_non_manifold_vertices(inspection *it)
{
    int32_t *fan_count = it->scratch;
    memset(fan_count, 0, (size_t)it->mesh->vertex_count * sizeof *fan_count);
    for (int32_t h = 0; h < 3 * it->mesh->triangle_count; h++)
        if (!it->skip[h / 3] && it->fan_of_corner[h] == h)
            fan_count[origin(it, h)]++;
    pel_status status = PEL_OK;
    int32_t used_count = 0;
    for (int32_t v = 0; v < it->mesh->vertex_count && status == PEL_OK; v++) {
        used_count += fan_count[v] > 0;
        if (fan_count[v] > 1)
            status = pel_issue_add(it->report, PEL_ISSUE_NON_MANIFOLD_VERTEX, v, -1, -1);
    }
    it->report->euler_characteristic = used_count - it->edges.edge_count;
    return status;
}

/* numbers components by their first triangle and makes room for them */
static pel_status find_components(inspection *it)
{
    int32_t *set = it->component_of_triangle, *number = it->scratch, count = 0;
    pel_union_find_reset(set, it->mesh->triangle_count);
    for (int32_t e = 0; e < it->edges.edge_count; e++) {
        int32_t first = it->edges.half_edge_of_edge[e];
        for (int32_t h = it->edges.next_in_edge[first]; h >= 0; h = it->edges.next_in_edge[h])
            pel_union_find_join(set, first / 3, h / 3);
    }
    for (int32_t t = 0; t < it->mesh->triangle_count; t++) {
        set[t] = pel_union_find_root(set, t);
        if (set[t] == t && !it->skip[t])
            number[t] = count++;
    }
    it->report->components = pel_allocate((size_t)count, sizeof *it->report->components);
    if (it->report->components == NULL)
        return PEL_OUT_OF_MEMORY;
    it->report->component_count = count;
    for (int32_t t = 0; t < it->mesh->triangle_count; t++) {
        if (set[t] == t && !it->skip[t])
            it->report->components[number[t]].first_triangle = t;
        set[t] = it->skip[t] ? -1 : number[set[t]];
    }
    return PEL_OK;
}

static void count_component_elements(inspection *it)
{
    pel_mesh_component *components = it->report->components;
    for (int32_t c = 0; c < it->report->component_count; c++)
        components[c].closed = components[c].manifold = components[c].oriented = components[c].orientable = true;
    for (int32_t h = 0; h < 3 * it->mesh->triangle_count; h++) {
        if (it->skip[h / 3])
            continue;
        pel_mesh_component *component = &components[it->component_of_triangle[h / 3]];
        component->vertex_count += it->fan_of_corner[h] == h;
        component->triangle_count += h % 3 == 0;
    }
    for (int32_t e = 0; e < it->edges.edge_count; e++) {
        int32_t h = it->edges.half_edge_of_edge[e], other = it->edges.next_in_edge[h];
        pel_mesh_component *component = &components[it->component_of_triangle[h / 3]];
        component->edge_count++;
        if (other < 0)
            component->boundary_edge_count++;
        else if (it->edges.next_in_edge[other] >= 0)
            component->manifold = false;
        else if (origin(it, other) == origin(it, h))
            component->oriented = false;
        if (other < 0 || it->edges.next_in_edge[other] >= 0)
            component->closed = false;
    }
}

/* chains boundary edges over fans; changes fan_of_corner */
static pel_status count_boundary_loops(inspection *it)
{
    int32_t *fan = it->fan_of_corner;
    uint8_t *seen = pel_allocate(3 * (size_t)it->mesh->triangle_count, 1);
    if (seen == NULL)
        return PEL_OUT_OF_MEMORY;
    for (int32_t e = 0; e < it->edges.edge_count; e++) {
        int32_t h = it->edges.half_edge_of_edge[e];
        if (it->edges.next_in_edge[h] < 0)
            pel_union_find_join(fan, h, next(h));
    }
    for (int32_t e = 0; e < it->edges.edge_count; e++) {
        int32_t h = it->edges.half_edge_of_edge[e];
        if (it->edges.next_in_edge[h] >= 0)
            continue;
        int32_t loop = pel_union_find_root(fan, h);
        it->report->boundary_loop_count += !seen[loop];
        it->report->components[it->component_of_triangle[h / 3]].boundary_loop_count += !seen[loop];
        seen[loop] = 1;
    }
    pel_free(seen);
    return PEL_OK;
}

static pel_status find_non_orientable(inspection *it)
{
    for (int32_t t = 0; t < it->mesh->triangle_count; t++)
        if (!it->skip[t] && is_one_sided(it, t))
            it->report->components[it->component_of_triangle[t]].orientable = false;
    pel_status status = PEL_OK;
    for (int32_t c = 0; c < it->report->component_count && status == PEL_OK; c++)
        if (!it->report->components[c].orientable)
            status =
                pel_issue_add(it->report, PEL_ISSUE_NON_ORIENTABLE, it->report->components[c].first_triangle, c, -1);
    return status;
}

static void fill_genus(pel_mesh_report *report)
{
    for (int32_t c = 0; c < report->component_count; c++) {
        pel_mesh_component *component = &report->components[c];
        component->euler_characteristic = component->vertex_count - component->edge_count + component->triangle_count;
        component->genus = component->manifold && component->orientable
                               ? (2 - component->euler_characteristic - component->boundary_loop_count) / 2
                               : -1;
        report->euler_characteristic += component->triangle_count;
        if (component->genus < 0 || report->genus < 0)
            report->genus = -1;
        else
            report->genus += component->genus;
    }
}

/* closed components of negative volume, rounding of flat ones aside */
static pel_status find_inside_out(inspection *it)
{
    pel_status status = PEL_OK;
    for (int32_t c = 0; c < it->report->component_count && status == PEL_OK; c++) {
        const pel_mesh_component *component = &it->report->components[c];
        if (component->volume < -1e-12 * component->area * sqrt(component->area))
            status = pel_issue_add(it->report, PEL_ISSUE_INSIDE_OUT, component->first_triangle, c, -1);
    }
    return status;
}

static void fill_flags(pel_mesh_report *report)
{
    const pel_issue *issues = report->issues;
    report->closed = report->component_count > 0 && issues[PEL_ISSUE_BOUNDARY_EDGE].count == 0;
    report->manifold = issues[PEL_ISSUE_BAD_INDEX].count == 0 && issues[PEL_ISSUE_REPEATED_VERTEX].count == 0 &&
                       issues[PEL_ISSUE_NON_MANIFOLD_EDGE].count == 0 &&
                       issues[PEL_ISSUE_NON_MANIFOLD_VERTEX].count == 0;
    report->oriented = issues[PEL_ISSUE_INCONSISTENT_WINDING].count == 0 && issues[PEL_ISSUE_NON_ORIENTABLE].count == 0;
    pel_issue_sum(report);
}

static pel_status allocate_scratch(inspection *it)
{
    size_t vertex_count = (size_t)it->mesh->vertex_count, triangle_count = (size_t)it->mesh->triangle_count;
    return PEL_ALLOCATE_ALL(PEL_ROOM(it->not_finite, vertex_count), PEL_ROOM(it->skip, triangle_count),
                            PEL_ROOM(it->fan_of_corner, 3 * triangle_count),
                            PEL_ROOM(it->component_of_triangle, triangle_count),
                            PEL_ROOM(it->scratch, vertex_count > triangle_count ? vertex_count : triangle_count))
               ? PEL_OK
               : PEL_OUT_OF_MEMORY;
}

static void free_scratch(inspection *it)
{
    pel_edge_table_clear(&it->edges);
    pel_patches_clear(&it->patches);
    PEL_FREE_ALL(it->not_finite, it->skip, it->fan_of_corner, it->component_of_triangle, it->scratch);
}

static pel_status inspect_elements(inspection *it)
{
    pel_status status = allocate_scratch(it);
    if (status == PEL_OK)
        status = find_bad_vertices(it);
    if (status == PEL_OK)
        status = find_bad_triangles(it);
    if (status == PEL_OK)
        status = find_duplicates(it);
    if (status == PEL_OK)
        status = find_duplicate_vertices(it);
    if (status == PEL_OK)
        status = find_isolated_vertices(it);
    return status;
}

static pel_status inspect_topology(inspection *it)
{
    const pel_mesh *mesh = it->mesh;
    pel_status status =
        pel_edge_table_build(it->triangles, mesh->triangle_count, mesh->vertex_count, it->skip, &it->edges);
    if (status != PEL_OK)
        return status;
    it->report->edge_count = it->edges.edge_count;
    join_fans(it);
    status = pel_patches_build(it->triangles, mesh->triangle_count, &it->edges, &it->patches);
    if (status == PEL_OK)
        status = classify_edges(it);
    if (status == PEL_OK)
        status = find_non_manifold_vertices(it);
    if (status == PEL_OK)
        status = find_components(it);
    if (status != PEL_OK)
        return status;
    count_component_elements(it);
    status = count_boundary_loops(it);
    if (status == PEL_OK)
        status = find_non_orientable(it);
    fill_genus(it->report);
    return status;
}

static pel_status inspect(inspection *it)
{
    pel_status status = inspect_elements(it);
    if (status == PEL_OK)
        status = inspect_topology(it);
    if (status == PEL_OK)
        status = pel_figures_fill(it->mesh, it->not_finite, it->component_of_triangle, &it->edges, it->report);
    if (status == PEL_OK)
        status = find_inside_out(it);
    if (status == PEL_OK)
        fill_flags(it->report);
    return status;
}

pel_status pel_mesh_check(const pel_mesh *mesh, pel_mesh_report **report, pel_error *error)
{
    PEL_REFUSE_NULL(mesh, error);
    PEL_REFUSE_NULL(report, error);
    *report = NULL;
    if (mesh->vertex_count < 0 || mesh->triangle_count < 0 || mesh->triangle_count > INT32_MAX / 3)
        return pel_fail(error, PEL_BAD_ARGUMENT,
                        "mesh has %d vertices and %d triangles; at most %d triangles can be checked",
                        (int)mesh->vertex_count, (int)mesh->triangle_count, (int)(INT32_MAX / 3));
    pel_mesh_report *made = pel_allocate(1, sizeof *made);
    if (made == NULL)
        return pel_fail_memory(error);
    made->vertex_count = mesh->vertex_count;
    made->triangle_count = mesh->triangle_count;
    inspection it = {.mesh = mesh, .triangles = (const int32_t(*)[3])mesh->triangles, .report = made};
    pel_status status = inspect(&it);
    free_scratch(&it);
    if (status != PEL_OK) {
        pel_mesh_report_destroy(made);
        return pel_fail_memory(error);
    }
    *report = made;
    return PEL_OK;
}

void pel_mesh_report_destroy(pel_mesh_report *report)
{
    if (report == NULL)
        return;
    for (int32_t i = 0; i < PEL_ISSUE_COUNT; i++) {
        pel_free(report->issues[i].elements);
        pel_free(report->issues[i].related);
    }
    pel_free(report->components);
    pel_free(report);
}
