#include "subdivide/local.h"

#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "math/extremes.h"
#include "math/vec3.h"
#include "mesh/allocate.h"
#include "subdivide/front.h"

#include <string.h>

/* longest edge of a triangle, and its centre */
static double measure(const pel_lod_forest *forest, int32_t level, int32_t t, double center[3])
{
    const int32_t *v = forest->levels[level]->triangles[t];
    double longest = 0;
    pel_vec3_set(center, 0, 0, 0);
    for (int i = 0; i < 3; i++) {
        const double *a = forest->rest_positions[v[i]];
        longest = pel_max(longest, pel_vec3_distance(a, forest->rest_positions[v[(i + 1) % 3]]));
        pel_vec3_along(center, 1.0 / 3, a, center);
    }
    return longest;
}

/* Level by level: children of those that are marked. Closing adds others, which ask again. */
static void mark(pel_front *front, const pel_local_def *def)
{
    for (int32_t l = 0; l < front->forest->depth; l++) {
        for (int32_t t = 0; t < front->forest->levels[l]->triangle_count; t++) {
            double center[3];
            if (l > 0 && front->shapes[pel_front_parent(front, l, front->node_begin[l] + t)] != PEL_FRONT_RED)
                continue;
            double edge = measure(front->forest, l, t, center);
            if (def->divides(def->user, l, t, edge, center))
                pel_front_mark(front, front->node_begin[l] + t, true);
        }
        pel_front_close(front);
        pel_front_commit(front);
    }
}

/* numbers (vertices of the finest level) of those that the surface has, in order; returns their count */
static int32_t number_vertices(const pel_front *front, int32_t vertex_count, int32_t *numbers)
{
    int32_t count = 0;
    for (int32_t v = 0; v < vertex_count; v++)
        numbers[v] = pel_front_has_vertex(front, v) ? count++ : -1;
    return count;
}

/* values of all levels from those of the base, as the means of the ends of edges */
static void fill_flat(const pel_lod_forest *forest, size_t component_count, double *values)
{
    for (int32_t l = 0; l < forest->depth; l++) {
        const pel_topology *level = forest->levels[l];
        for (int32_t e = 0; e < level->edge_count; e++) {
            const int32_t h = level->half_edge_of_edge[e];
            const double *a = values + (size_t)pel_half_edge_origin(level, h) * component_count,
                         *b = values + (size_t)pel_half_edge_target(level, h) * component_count;
            double *middle = values + (size_t)pel_lod_midpoint(level, h) * component_count;
            for (size_t c = 0; c < component_count; c++)
                middle[c] = 0.5 * (a[c] + b[c]);
        }
    }
}

static pel_status copy_field(const pel_front *front, const pel_field *field, int32_t base_count, const int32_t *numbers,
                             bool is_flat, pel_mesh *fine, pel_error *error)
{
    const size_t n = (size_t)field->component_count,
                 all = (size_t)front->forest->levels[front->forest->depth]->vertex_count;
    double *values = pel_allocate(all * n, sizeof *values);
    if (values == NULL)
        return pel_fail_memory(error);
    memcpy(values, field->values, (size_t)base_count * n * sizeof *values);
    pel_status status = PEL_OK;
    if (is_flat)
        fill_flat(front->forest, n, values);
    else
        status = pel_lod_forest_interpolate(front->forest, field->component_count, true, values, error);
    for (size_t v = 0; v < all; v++)
        if (numbers[v] >= 0)
            memmove(values + (size_t)numbers[v] * n, values + v * n, n * sizeof *values);
    if (status == PEL_OK)
        status = pel_mesh_add_field(fine, field->name, field->component_count, values, error);
    pel_free(values);
    return status;
}

static pel_status copy_surface(const pel_front *front, const pel_mesh *mesh, bool is_flat, pel_mesh **fine,
                               pel_error *error)
{
    const int32_t all = front->forest->levels[front->forest->depth]->vertex_count;
    int32_t *numbers = NULL;
    pel_front_triangle *triangles = NULL;
    pel_status status = PEL_ALLOCATE_ALL(PEL_ROOM(numbers, all), PEL_ROOM(triangles, front->triangle_count))
                            ? PEL_OK
                            : pel_fail_memory(error);
    if (status == PEL_OK) {
        *fine = pel_mesh_allocate(number_vertices(front, all, numbers), front->triangle_count);
        status = *fine != NULL ? PEL_OK : pel_fail_memory(error);
    }
    for (int32_t v = 0; status == PEL_OK && v < all; v++)
        if (numbers[v] >= 0)
            memcpy((*fine)->positions[numbers[v]], front->forest->rest_positions[v], sizeof *(*fine)->positions);
    if (status == PEL_OK)
        pel_front_surface(front, triangles);
    for (int32_t t = 0; status == PEL_OK && t < front->triangle_count; t++)
        for (int i = 0; i < 3; i++)
            (*fine)->triangles[t][i] = numbers[triangles[t].vertices[i]];
    for (int32_t f = 0; status == PEL_OK && f < mesh->field_count; f++)
        status = copy_field(front, &mesh->fields[f], mesh->vertex_count, numbers, is_flat, *fine, error);
    PEL_FREE_ALL(numbers, triangles);
    return status;
}

/* as many levels as the memory has room for */
static pel_status find_depth(const pel_mesh *mesh, const pel_local_def *def, int32_t *depth, pel_error *error)
{
    pel_topology *base;
    pel_status status = pel_topology_create(mesh, &base, error);
    *depth = def->depth;
    while (status == PEL_OK && *depth > 0 && !def->all_levels && pel_lod_forest_bytes(base, *depth) > def->memory_limit)
        --*depth;
    if (status == PEL_OK)
        pel_topology_destroy(base);
    return status;
}

pel_status pel_mesh_subdivide_locally(const pel_mesh *mesh, const pel_local_def *def, pel_mesh **fine, pel_error *error)
{
    pel_lod_forest *forest = NULL;
    pel_front *front = NULL;
    int32_t depth;
    *fine = NULL;
    pel_status status = find_depth(mesh, def, &depth, error);
    if (status == PEL_OK)
        status = pel_lod_forest_create(mesh, depth, def->all_levels ? def->memory_limit : 0, &forest, error);
    if (status == PEL_OK && def->is_flat)
        fill_flat(forest, 3, forest->rest_positions[0]);
    if (status == PEL_OK)
        status = pel_front_create(forest, &front, error);
    if (status == PEL_OK) {
        mark(front, def);
        status = copy_surface(front, mesh, def->is_flat, fine, error);
    }
    if (status != PEL_OK) {
        pel_mesh_destroy(*fine);
        *fine = NULL;
    }
    pel_front_destroy(front);
    pel_lod_forest_destroy(forest);
    return status;
}
