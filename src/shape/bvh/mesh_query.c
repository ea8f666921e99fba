/* The winding number is the sum of the signs with which triangles cross the ray from the point along +x. Seen along x,
   a triangle is crossed when its outline winds about the point: each edge counts +1 or -1 where it passes above the
   point in y, from one side in z to the other. A number is found for an edge with its ends in one order, so that both
   triangles at it agree to the last bit and no ray slips through between them. */
#include "bvh/mesh_query.h"

#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "bvh/search.h"
#include "math/extremes.h"
#include "math/vec3.h"
#include "mesh/edge_table.h"
#include "pellicle/geometry.h"

#include <string.h>

struct pel_mesh_query {
    bool closed;
    double (*positions)[3];  /* (tree->vertex_count) */
    int32_t (*triangles)[3]; /* (tree->triangle_count) */
    pel_box *boxes;          /* (tree->vertex_count) */
    pel_tree *tree;
    pel_element_list found; /* with room for all triangles */
};

static float below(double x)
{
    float rounded = (float)x;
    return (double)rounded > x ? nextafterf(rounded, -HUGE_VALF) : rounded;
}

static float above(double x)
{
    return -below(-x);
}

static pel_box make_box(const double low[3], const double high[3])
{
    return (pel_box){{below(low[0]), below(low[1]), below(low[2]), 0},
                     {above(high[0]), above(high[1]), above(high[2]), 0}};
}

/* ---- creation ---- */

static int32_t sense_of(int32_t from, int32_t to)
{
    return (from < to) - (from > to);
}

/* edges whose triangles do not pass it equally often in both senses make an open mesh */
static pel_status find_closed(const pel_mesh *mesh, bool *closed, pel_error *error)
{
    pel_edge_table table;
    if (pel_edge_table_build((const int32_t(*)[3])mesh->triangles, mesh->triangle_count, mesh->vertex_count, NULL,
                             &table) != PEL_OK)
        return pel_fail_memory(error);
    *closed = true;
    for (int32_t e = 0; *closed && e < table.edge_count; e++) {
        int32_t sum = 0;
        for (int32_t h = table.half_edge_of_edge[e]; h >= 0; h = table.next_in_edge[h])
            sum += sense_of(mesh->triangles[h / 3][h % 3], mesh->triangles[h / 3][(h + 1) % 3]);
        *closed = sum == 0;
    }
    pel_edge_table_clear(&table);
    return PEL_OK;
}

static pel_status fill(pel_mesh_query *query, const pel_mesh *mesh, pel_error *error)
{
    size_t count = (size_t)mesh->vertex_count, triangle_count = (size_t)mesh->triangle_count;
    query->positions = pel_allocate(count, sizeof *query->positions);
    query->triangles = pel_allocate(triangle_count, sizeof *query->triangles);
    query->boxes = pel_allocate_aligned(count, sizeof *query->boxes);
    /* lists grow by whole leaves */
    bool room = pel_reserve((void **)&query->found.elements, &query->found.capacity, triangle_count + PEL_LANES,
                            sizeof *query->found.elements);
    if (query->positions == NULL || query->triangles == NULL || query->boxes == NULL || !room)
        return pel_fail_memory(error);
    memcpy(query->positions, mesh->positions, count * sizeof *query->positions);
    memcpy(query->triangles, mesh->triangles, triangle_count * sizeof *query->triangles);
    for (size_t v = 0; v < count; v++)
        query->boxes[v] = make_box(mesh->positions[v], mesh->positions[v]);
    pel_status status = find_closed(mesh, &query->closed, error);
    if (status == PEL_OK)
        status = pel_tree_create((const double(*)[3])query->positions, mesh->vertex_count,
                                 (const int32_t(*)[3])query->triangles, mesh->triangle_count, PEL_TREE_TRIANGLES,
                                 &query->tree, error);
    if (status == PEL_OK)
        pel_tree_refit(query->tree, query->boxes, NULL);
    return status;
}

pel_status pel_mesh_query_create(const pel_mesh *mesh, pel_mesh_query **query, pel_error *error)
{
    *query = pel_allocate(1, sizeof **query);
    if (*query == NULL)
        return pel_fail_memory(error);
    pel_status status = fill(*query, mesh, error);
    if (status != PEL_OK) {
        pel_mesh_query_destroy(*query);
        *query = NULL;
    }
    return status;
}

void pel_mesh_query_destroy(pel_mesh_query *query)
{
    if (query == NULL)
        return;
    pel_tree_destroy(query->tree);
    PEL_FREE_ALL(query->positions, query->triangles, query->boxes, query->found.elements, query);
}

bool pel_mesh_query_is_closed(const pel_mesh_query *query)
{
    return query->closed;
}

/* ---- queries ---- */

/* the list has room for all triangles, so the search cannot fail */
static void find(pel_mesh_query *query, const double low[3], const double high[3])
{
    const pel_box box = make_box(low, high);
    pel_find_in_box(query->tree, &box, &query->found, NULL);
}

/* an edge from a to b passes the point on the side of rising y: 1 upward in z, -1 downward, 0 not */
static int32_t passes(const double a[3], const double b[3], const double point[3])
{
    if ((a[2] <= point[2]) == (b[2] <= point[2]))
        return 0;
    bool upward = a[2] <= point[2];
    const double *low = upward ? a : b, *high = upward ? b : a;
    double side = (high[1] - low[1]) * (point[2] - low[2]) - (point[1] - low[1]) * (high[2] - low[2]);
    return side > 0 ? (upward ? 1 : -1) : 0;
}

/* 1 or -1 where the ray crosses a triangle from the inside or from the outside */
static int32_t crosses(const pel_mesh_query *query, int32_t t, const double point[3])
{
    const double *x[3];
    for (int i = 0; i < 3; i++)
        x[i] = query->positions[query->tree->triangles[t][i]];
    int32_t sum = passes(x[0], x[1], point) + passes(x[1], x[2], point) + passes(x[2], x[0], point);
    if (sum == 0)
        return 0;
    if (point[0] >= pel_max(x[0][0], pel_max(x[1][0], x[2][0])))
        return 0;
    if (point[0] < pel_min(x[0][0], pel_min(x[1][0], x[2][0])))
        return sum;
    double normal[3], arm[3];
    pel_vec3_triangle_normal(x[0], x[1], x[2], normal);
    pel_vec3_subtract(x[0], point, arm);
    return pel_vec3_dot(normal, arm) / normal[0] > 0 ? sum : 0;
}

int32_t pel_mesh_query_winding(pel_mesh_query *query, const double point[3])
{
    if (!query->closed)
        return 0;
    const pel_box *all = &query->tree->nodes[0];
    const double high[3] = {(double)all->high[0], point[1], point[2]};
    if (!(point[0] <= high[0]))
        return 0;
    find(query, point, high);
    int32_t sum = 0;
    for (size_t i = 0; i < query->found.count; i++)
        sum += crosses(query, query->found.elements[i], point);
    return sum;
}

bool pel_mesh_query_nearest(pel_mesh_query *query, const double point[3], double reach, double nearest[3])
{
    double low[3], high[3], weights[3], least = reach * reach;
    bool is_near = false;
    for (int k = 0; k < 3; k++) {
        low[k] = point[k] - reach;
        high[k] = point[k] + reach;
    }
    find(query, low, high);
    for (size_t i = 0; i < query->found.count; i++) {
        const int32_t *v = query->tree->triangles[query->found.elements[i]];
        const double *x[3] = {query->positions[v[0]], query->positions[v[1]], query->positions[v[2]]};
        const double square = pel_closest_point_triangle(point, x[0], x[1], x[2], weights);
        if (!(square <= least))
            continue;
        least = square;
        is_near = true;
        for (int k = 0; k < 3; k++)
            nearest[k] = weights[0] * x[0][k] + weights[1] * x[1][k] + weights[2] * x[2][k];
    }
    return is_near;
}

bool pel_mesh_query_reaches(pel_mesh_query *query, const double point[3], double reach)
{
    double nearest[3];
    return pel_mesh_query_winding(query, point) != 0 || pel_mesh_query_nearest(query, point, reach, nearest);
}
