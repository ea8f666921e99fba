#include "mesh/patch.h"

#include "base/memory.h"
#include "base/room.h"

#include <string.h>

/* the other half-edge of an edge with exactly two, -1 otherwise */
static int32_t partner(const pel_edge_table *edges, int32_t h)
{
    int32_t first = edges->half_edge_of_edge[edges->edge_of_half_edge[h]];
    int32_t second = edges->next_in_edge[first];
    if (second < 0 || edges->next_in_edge[second] >= 0)
        return -1;
    return h == first ? second : first;
}

/* visits the patch of queue[0], whose patch number is set; queue (triangle_count) */
static void walk_patch(const int32_t (*triangles)[3], const pel_edge_table *edges, int32_t *queue, pel_patches *patches)
{
    int32_t patch = patches->patch_of_triangle[queue[0]];
    for (int32_t begin = 0, end = 1; begin < end; begin++) {
        int32_t t = queue[begin];
        for (int32_t h = 3 * t; h < 3 * t + 3; h++) {
            int32_t other = partner(edges, h);
            if (other < 0)
                continue;
            int32_t u = other / 3;
            bool same_direction = triangles[t][h % 3] == triangles[u][other % 3];
            uint8_t flipped = patches->flipped[t] ^ (uint8_t)same_direction;
            if (patches->patch_of_triangle[u] < 0) {
                patches->patch_of_triangle[u] = patch;
                patches->flipped[u] = flipped;
                queue[end++] = u;
            } else if (patches->flipped[u] != flipped) {
                patches->non_orientable[patch] = 1;
            }
        }
    }
}

pel_status pel_patches_build(const int32_t (*triangles)[3], int32_t triangle_count, const pel_edge_table *edges,
                             pel_patches *patches)
{
    size_t count = (size_t)triangle_count;
    memset(patches, 0, sizeof *patches);
    patches->patch_of_triangle = pel_allocate(count, sizeof(int32_t));
    patches->flipped = pel_allocate(count, 1);
    patches->non_orientable = pel_allocate(count, 1);
    int32_t *queue = pel_allocate(count, sizeof *queue);
    if (patches->patch_of_triangle == NULL || patches->flipped == NULL || patches->non_orientable == NULL ||
        queue == NULL) {
        pel_free(queue);
        pel_patches_clear(patches);
        return PEL_OUT_OF_MEMORY;
    }
    memset(patches->patch_of_triangle, -1, count * sizeof(int32_t));
    for (int32_t t = 0; t < triangle_count; t++) {
        if (edges->edge_of_half_edge[3 * t] < 0 || patches->patch_of_triangle[t] >= 0)
            continue;
        patches->patch_of_triangle[t] = patches->patch_count++;
        queue[0] = t;
        walk_patch(triangles, edges, queue, patches);
    }
    pel_free(queue);
    return PEL_OK;
}

void pel_patches_clear(pel_patches *patches)
{
    PEL_FREE_ALL(patches->patch_of_triangle, patches->flipped, patches->non_orientable);
    memset(patches, 0, sizeof *patches);
}
