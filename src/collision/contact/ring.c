/* The triangles around a corner, for which one pair of a vertex may stand: where the surface is flat or convex as seen
   from the vertex, only the nearest of them can touch it. In a valley two walls do, and each needs a pair. */
#include "contact/set.h"

/* sine by which an edge at the corner may rise over the plane of a triangle that counts as flat: there the distances of
   a vertex from two triangles differ by 2 %, where it is before both */
#define FLAT 0.2
/* sine of the direction from the corner to the vertex against a triangle from which on it is clear on which side the
   vertex is */
#define CLEAR 0.3

int pel_contact_ring(const pel_tree *tree, int32_t triangle, int32_t corner, int32_t ring[PEL_RING_LIMIT])
{
    int count = 1;
    ring[0] = triangle;
    for (int i = 0; i < count; i++)
        for (int32_t h = 3 * ring[i]; h < 3 * ring[i] + 3; h++) {
            if (pel_tree_corner(tree, h) != corner && pel_tree_corner(tree, pel_half_edge_next(h)) != corner)
                continue;
            for (int32_t g = tree->next_in_edge[h]; g != h; g = tree->next_in_edge[g]) {
                int known = 0;
                while (known < count && ring[known] != g / 3)
                    known++;
                if (known == PEL_RING_LIMIT)
                    return 0;
                ring[known] = g / 3;
                count = known == count ? count + 1 : count;
            }
        }
    return count;
}

/* whether the triangles on both sides of the edges at a corner are two at most, and wound alike */
static bool is_wound_alike(const pel_tree *tree, const int32_t *ring, int count, int32_t corner)
{
    for (int i = 0; i < 3 * count; i++) {
        int32_t h = 3 * ring[i / 3] + i % 3, g = tree->next_in_edge[h];
        int32_t from = pel_tree_corner(tree, h), to = pel_tree_corner(tree, pel_half_edge_next(h));
        if (g == h || (from != corner && to != corner))
            continue;
        if (tree->next_in_edge[g] != h || pel_tree_corner(tree, g) != to)
            return false;
    }
    return true;
}

static void find_normal(const double (*x)[3], const int32_t corners[3], double normal[3])
{
    double u[3], v[3];
    pel_vec3_subtract(x[corners[1]], x[corners[0]], u);
    pel_vec3_subtract(x[corners[2]], x[corners[0]], v);
    pel_vec3_cross(u, v, normal);
    pel_vec3_normalize(normal);
}

/* the edges at a corner of triangles that are wound alike, each once, with their lengths [m]; returns how many */
static int find_spokes(const pel_contact_set *set, const int32_t *ring, int count, int32_t corner,
                       double edges[2 * PEL_RING_LIMIT][3], double lengths[2 * PEL_RING_LIMIT])
{
    const pel_tree *tree = pel_collider_tree(set->collider);
    const double(*x)[3] = (const double(*)[3])set->start;
    int spokes = 0;
    for (int32_t i = 0; i < 3 * count; i++) {
        int32_t h = 3 * ring[i / 3] + i % 3, from = pel_tree_corner(tree, h);
        int32_t to = pel_tree_corner(tree, pel_half_edge_next(h));
        /* the last edge of a ring that is open comes in only */
        if (from != corner && (to != corner || tree->next_in_edge[h] != h))
            continue;
        pel_vec3_subtract(x[from != corner ? from : to], x[corner], edges[spokes]);
        lengths[spokes] = pel_vec3_length(edges[spokes]);
        spokes++;
    }
    return spokes;
}

/* whether no edge at a corner rises much over the plane of a triangle there; side: 1 = that of normals, -1 = the other
 */
static bool is_smooth(const pel_contact_set *set, const int32_t *ring, int count, int32_t corner, double side)
{
    const pel_tree *tree = pel_collider_tree(set->collider);
    double edges[2 * PEL_RING_LIMIT][3], lengths[2 * PEL_RING_LIMIT], normal[3];
    int spokes = find_spokes(set, ring, count, corner, edges, lengths);
    for (int i = 0; i < count; i++) {
        find_normal((const double(*)[3])set->start, tree->triangles[ring[i]], normal);
        for (int k = 0; k < spokes; k++)
            if (side * pel_vec3_dot(edges[k], normal) > FLAT * lengths[k])
                return false;
    }
    return true;
}

int pel_contact_smooth_ring(const pel_contact_set *set, int32_t triangle, int32_t corner, int32_t vertex,
                            int32_t ring[PEL_RING_LIMIT])
{
    const pel_tree *tree = pel_collider_tree(set->collider);
    const double(*x)[3] = (const double(*)[3])set->start;
    int count = pel_contact_ring(tree, triangle, corner, ring);
    double normal[3], way[3];
    find_normal(x, tree->triangles[triangle], normal);
    pel_vec3_subtract(x[vertex], x[corner], way);
    double height = pel_vec3_dot(way, normal);
    bool is_clear = fabs(height) > CLEAR * pel_vec3_length(way);
    if (!is_clear || !is_wound_alike(tree, ring, count, corner) ||
        !is_smooth(set, ring, count, corner, height > 0 ? 1 : -1))
        return 0;
    return count;
}
