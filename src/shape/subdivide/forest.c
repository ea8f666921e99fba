#include "subdivide/forest.h"

#include "base/assert.h"
#include "base/memory.h"
#include "base/status.h"
#include "subdivide/clamp.h"
#include "subdivide/split.h"

#include <string.h>

size_t pel_lod_forest_bytes(const pel_topology *base, int32_t depth)
{
    pel_level_size size = pel_level_size_of(base);
    size_t bytes = sizeof(pel_lod_forest) + sizeof(pel_topology) + pel_level_size_topology_bytes(size);
    for (int32_t l = 0; l < depth; l++) {
        size = pel_level_size_split(size);
        if (!pel_level_size_fits(size))
            return SIZE_MAX;
        bytes += sizeof(pel_topology) + pel_level_size_topology_bytes(size);
    }
    return bytes + (size_t)size.vertex_count * 3 * sizeof(double);
}

static pel_status check_size(const pel_topology *base, int32_t depth, size_t memory_limit, pel_error *error)
{
    if (depth < 0 || depth > PEL_LOD_DEPTH_LIMIT) {
        pel_fail(error, PEL_BAD_ARGUMENT, "%d levels of detail are asked for", (int)depth);
        pel_fail_remedy(error, "give a number of levels from 0 to %d", PEL_LOD_DEPTH_LIMIT);
        return PEL_BAD_ARGUMENT;
    }
    size_t bytes = pel_lod_forest_bytes(base, depth);
    if (bytes != SIZE_MAX && (memory_limit == 0 || bytes <= memory_limit))
        return PEL_OK;
    int32_t possible = depth - 1;
    while (possible > 0 && (pel_lod_forest_bytes(base, possible) == SIZE_MAX ||
                            (memory_limit > 0 && pel_lod_forest_bytes(base, possible) > memory_limit)))
        possible--;
    if (bytes == SIZE_MAX)
        pel_fail(error, PEL_BAD_ARGUMENT, "%d levels of %d triangles are more than 32 bits can number", (int)depth,
                 (int)base->triangle_count);
    else
        pel_fail(error, PEL_BAD_ARGUMENT, "%d levels of %d triangles need %.1f MB, the limit is %.1f MB", (int)depth,
                 (int)base->triangle_count, (double)bytes * 1e-6, (double)memory_limit * 1e-6);
    pel_fail_remedy(error, "use %d levels or raise the memory limit", (int)possible);
    return PEL_BAD_ARGUMENT;
}

static pel_status split_levels(pel_lod_forest *forest, int32_t depth, pel_error *error)
{
    for (int32_t l = 0; l < depth; l++) {
        pel_topology *fine;
        pel_status status = pel_topology_split(forest->levels[l], &fine, error);
        if (status != PEL_OK)
            return status;
        forest->levels[l + 1] = fine;
        forest->depth = l + 1;
    }
    return PEL_OK;
}

static pel_status place_vertices(pel_lod_forest *forest, const pel_mesh *mesh, pel_error *error)
{
    size_t vertex_count = (size_t)forest->levels[forest->depth]->vertex_count;
    forest->rest_positions = pel_allocate(vertex_count, sizeof *forest->rest_positions);
    if (forest->rest_positions == NULL)
        return pel_fail_memory(error);
    memcpy(forest->rest_positions, mesh->positions, (size_t)mesh->vertex_count * sizeof *mesh->positions);
    return pel_lod_forest_interpolate(forest, 3, false, forest->rest_positions[0], error);
}

pel_status pel_lod_forest_create(const pel_mesh *mesh, int32_t depth, size_t memory_limit, pel_lod_forest **forest,
                                 pel_error *error)
{
    *forest = NULL;
    pel_topology *base;
    pel_status status = pel_topology_create(mesh, &base, error);
    if (status != PEL_OK)
        return status;
    pel_lod_forest *made = pel_allocate(1, sizeof *made);
    if (made == NULL) {
        pel_topology_destroy(base);
        return pel_fail_memory(error);
    }
    made->levels[0] = base;
    status = check_size(base, depth, memory_limit, error);
    if (status == PEL_OK)
        status = split_levels(made, depth, error);
    if (status == PEL_OK)
        status = place_vertices(made, mesh, error);
    if (status != PEL_OK) {
        pel_lod_forest_destroy(made);
        return status;
    }
    *forest = made;
    return PEL_OK;
}

void pel_lod_forest_destroy(pel_lod_forest *forest)
{
    if (forest == NULL)
        return;
    for (int32_t l = 0; l <= forest->depth; l++)
        pel_topology_destroy(forest->levels[l]);
    pel_free(forest->rest_positions);
    pel_free(forest);
}

pel_status pel_lod_forest_interpolate(const pel_lod_forest *forest, int32_t component_count, bool clamp, double *values,
                                      pel_error *error)
{
    pel_butterfly *butterfly;
    pel_status status = pel_butterfly_create(forest->levels[0], &butterfly, error);
    if (status != PEL_OK)
        return status;
    for (int32_t l = 0; l < forest->depth; l++) {
        pel_butterfly_edge_values(butterfly, forest->levels[l], component_count, values);
        if (clamp)
            pel_clamp_rows(values, component_count, forest->levels[0]->vertex_count,
                           forest->levels[l + 1]->vertex_count);
    }
    pel_butterfly_destroy(butterfly);
    return PEL_OK;
}

int32_t pel_lod_forest_vertex_level(const pel_lod_forest *forest, int32_t v)
{
    PEL_ASSERT_INDEX(v, forest->levels[forest->depth]->vertex_count);
    int32_t level = 0;
    while (v >= forest->levels[level]->vertex_count)
        level++;
    return level;
}

bool pel_lod_forest_vertex_parents(const pel_lod_forest *forest, int32_t v, int32_t parents[2])
{
    PEL_ASSERT_INDEX(v, forest->levels[forest->depth]->vertex_count);
    int32_t level = pel_lod_forest_vertex_level(forest, v);
    if (level == 0)
        return false;
    const pel_topology *coarse = forest->levels[level - 1];
    int32_t h = coarse->half_edge_of_edge[v - coarse->vertex_count];
    parents[0] = pel_half_edge_origin(coarse, h);
    parents[1] = pel_half_edge_target(coarse, h);
    return true;
}
