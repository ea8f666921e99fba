/* The whole of a tree, checked. */
#include "base/memory.h"
#include "base/room.h"
#include "bvh/tree.h"

typedef struct check {
    const pel_tree *tree;
    uint8_t *is_in_leaf; /* (triangle_count) */
    uint8_t *has_owner;  /* (vertex_count) */
} check;

/* the leaves are full, but for the end of the last one */
static bool check_leaves(const check *c)
{
    const pel_tree *tree = c->tree;
    for (int32_t i = 0; i < PEL_LANES * tree->leaf_count; i++) {
        int32_t t = tree->leaves[i / PEL_LANES][i % PEL_LANES];
        if (i >= tree->triangle_count && t == -1)
            continue;
        if (i >= tree->triangle_count || t < 0 || t >= tree->triangle_count || c->is_in_leaf[t] != 0)
            return false;
        c->is_in_leaf[t] = 1;
    }
    return true;
}

/* the half-edges of an edge form a ring: it rises but for one step down to the first */
static bool check_ring(const pel_tree *tree, int32_t h)
{
    int32_t next = tree->next_in_edge[h], count = 3 * tree->triangle_count;
    if (next < 0 || next >= count)
        return false;
    int32_t a = pel_tree_corner(tree, h), b = pel_tree_corner(tree, pel_half_edge_next(h));
    int32_t c = pel_tree_corner(tree, next), d = pel_tree_corner(tree, pel_half_edge_next(next));
    if (!((a == c && b == d) || (a == d && b == c)))
        return false;
    /* what steps down does so to the first, which nothing else is before */
    for (int32_t g = next, steps = 0; next <= h && g != h; g = tree->next_in_edge[g], steps++)
        if (g < next || g > h || steps == count || tree->next_in_edge[g] <= g)
            return false;
    return true;
}

static bool check_features(const check *c)
{
    const pel_tree *tree = c->tree;
    for (int32_t h = 0; h < 3 * tree->triangle_count; h++)
        if (!check_ring(tree, h))
            return false;
    for (int32_t h = 0; h < 3 * tree->triangle_count; h++) {
        bool owns_edge = (tree->features[h / 3] >> h % 3 & 1) != 0;
        bool owns_corner = (tree->features[h / 3] >> (3 + h % 3) & 1) != 0;
        uint8_t *has_owner = &c->has_owner[pel_tree_corner(tree, h)];
        if (owns_edge != (pel_tree_edge(tree, h) == h) || owns_corner != (*has_owner == 0))
            return false;
        *has_owner = 1;
    }
    return true;
}

/* not outside; false for what is not a number, as after a step that diverged */
static bool sticks_out(const pel_box *inner, const pel_box *outer)
{
    for (int k = 0; k < 3; k++)
        if (inner->low[k] < outer->low[k] || inner->high[k] > outer->high[k])
            return true;
    return false;
}

static bool check_boxes(const pel_tree *tree, int32_t node, int32_t begin, int32_t end)
{
    const pel_box *own = &tree->nodes[node];
    if (end - begin == 1) {
        for (int lane = 0; lane < PEL_LANES && tree->leaves[begin][lane] >= 0; lane++) {
            const pel_box box = pel_tree_triangle_box(tree, tree->vertex_boxes, tree->leaves[begin][lane]);
            if (sticks_out(&box, own))
                return false;
        }
        return true;
    }
    int32_t middle = pel_tree_middle(begin, end), left = node + 1, right = node + 2 * (middle - begin);
    return !sticks_out(&tree->nodes[left], own) && !sticks_out(&tree->nodes[right], own) &&
           check_boxes(tree, left, begin, middle) && check_boxes(tree, right, middle, end);
}

static bool is_fitted(const pel_tree *tree)
{
    return tree->vertex_boxes != NULL && tree->nodes[0].low[0] <= tree->nodes[0].high[0];
}

bool pel_tree_is_valid(const pel_tree *tree)
{
    check c = {.tree = tree};
    if (tree->leaf_count != (tree->triangle_count + PEL_LANES - 1) / PEL_LANES ||
        tree->node_count != 2 * tree->leaf_count - 1)
        return false;
    bool has_room =
        PEL_ALLOCATE_ALL(PEL_ROOM(c.is_in_leaf, tree->triangle_count), PEL_ROOM(c.has_owner, tree->vertex_count));
    bool good = !has_room || (check_leaves(&c) && (tree->features == NULL || check_features(&c)) &&
                              (!is_fitted(tree) || check_boxes(tree, 0, 0, tree->leaf_count)));
    PEL_FREE_ALL(c.is_in_leaf, c.has_owner);
    return good;
}
