#include "mesh/topology_check.h"

static bool check_triangles(const pel_topology *t)
{
    for (int32_t i = 0; i < t->triangle_count; i++) {
        const int32_t *v = t->triangles[i];
        for (int k = 0; k < 3; k++)
            if (v[k] < 0 || v[k] >= t->vertex_count || v[k] == v[(k + 1) % 3])
                return false;
    }
    return true;
}

static bool check_twin(const pel_topology *t, int32_t h)
{
    int32_t twin = t->twin[h];
    if (twin < 0)
        return twin == -1;
    return twin < 3 * t->triangle_count && twin != h && t->twin[twin] == h &&
           pel_half_edge_origin(t, twin) == pel_half_edge_target(t, h) &&
           pel_half_edge_target(t, twin) == pel_half_edge_origin(t, h);
}

/* edges in the order of the lower of their half-edges */
static bool check_edges(const pel_topology *t)
{
    int32_t edges = 0, boundary = 0;
    for (int32_t h = 0; h < 3 * t->triangle_count; h++) {
        if (!check_twin(t, h))
            return false;
        if (t->twin[h] >= 0 && t->twin[h] < h) {
            if (t->edge_of_half_edge[h] != t->edge_of_half_edge[t->twin[h]])
                return false;
            continue;
        }
        if (edges == t->edge_count || t->edge_of_half_edge[h] != edges || t->half_edge_of_edge[edges] != h)
            return false;
        edges++;
        boundary += t->twin[h] < 0;
    }
    return edges == t->edge_count && boundary == t->boundary_edge_count;
}

/* triangles that a turn about the vertex visits; -1 when it begins elsewhere, or comes to another place than its begin
   or the boundary */
static int32_t fan_size(const pel_topology *t, int32_t v)
{
    int32_t begin = t->corner_of_vertex[v], count = 0;
    if (begin == -1)
        return 0;
    if (begin < 0 || begin >= 3 * t->triangle_count || pel_half_edge_origin(t, begin) != v)
        return -1;
    for (int32_t h = begin; h >= 0; count++) {
        if (count > 0 && h == begin)
            return count;
        if (pel_half_edge_origin(t, h) != v || count == t->triangle_count)
            return -1;
        h = pel_half_edge_turn(t, h);
    }
    /* it ends at the boundary, so it has to begin there */
    return t->twin[begin] < 0 ? count : -1;
}

static bool check_fans(const pel_topology *t)
{
    int64_t corners = 0;
    for (int32_t v = 0; v < t->vertex_count; v++) {
        int32_t size = fan_size(t, v);
        if (size < 0)
            return false;
        corners += size;
    }
    return corners == 3 * (int64_t)t->triangle_count;
}

bool pel_topology_is_valid(const pel_topology *topology)
{
    return topology->vertex_count > 0 && topology->triangle_count > 0 && check_triangles(topology) &&
           check_edges(topology) && check_fans(topology);
}
