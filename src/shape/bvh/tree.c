#include "bvh/tree.h"

#include "base/assert.h"
#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "math/extremes.h"
#include "mesh/edge_table.h"

#include <string.h>

/* ---- order of the triangles ---- */

/* Keys use the memory of the nodes, which is free during a build. */
typedef struct build {
    pel_tree *tree;
    const double (*positions)[3];
    const double *origin;
    uint64_t *keys;        /* (triangle_count) place along an axis, triangle */
    float (*centroids)[3]; /* (triangle_count) null = they are computed again and again */
    bool is_mixed;         /* what is sorted has several groups */
} build;

static float centroid(const build *b, uint32_t t, int axis)
{
    const int32_t *v = b->tree->triangles[t];
    double origin = b->origin[axis];
    double sum = (b->positions[v[0]][axis] - origin) + (b->positions[v[1]][axis] - origin);
    sum += b->positions[v[2]][axis] - origin;
    return isfinite(sum) ? (float)sum : 0;
}

static int32_t group_of(const pel_tree *tree, uint32_t t)
{
    return tree->node_groups != NULL ? tree->groups.group_of_vertex[tree->triangles[t][0]] : 0;
}

static bool is_kept_together(const pel_tree *tree, int32_t group)
{
    return tree->node_groups != NULL && !tree->groups.may_meet[group * tree->groups.group_count + group];
}

static float get_centroid(const build *b, uint32_t t, int axis)
{
    int32_t group = group_of(b->tree, t);
    if (b->is_mixed && is_kept_together(b->tree, group))
        return b->tree->group_places[group][axis];
    return b->centroids != NULL ? b->centroids[t][axis] : centroid(b, t, axis);
}

/* keys rise with the coordinate, equal ones with the triangle: the order does not depend on the sorting algorithm */
static uint64_t make_key(float coordinate, int32_t triangle)
{
    uint32_t bits;
    memcpy(&bits, &coordinate, sizeof bits);
    bits = bits >> 31 ? ~bits : bits | 0x80000000u;
    return (uint64_t)bits << 32 | (uint32_t)triangle;
}

static int longest_axis(const build *b, int32_t begin, int32_t end)
{
    float low[3], high[3];
    for (int k = 0; k < 3; k++)
        low[k] = high[k] = get_centroid(b, (uint32_t)b->keys[begin], k);
    for (int32_t i = begin + 1; i < end; i++)
        for (int k = 0; k < 3; k++) {
            float x = get_centroid(b, (uint32_t)b->keys[i], k);
            low[k] = x < low[k] ? x : low[k];
            high[k] = x > high[k] ? x : high[k];
        }
    int axis = high[1] - low[1] > high[0] - low[0] ? 1 : 0;
    return high[2] - low[2] > high[axis] - low[axis] ? 2 : axis;
}

static void exchange(uint64_t *a, uint64_t *b)
{
    uint64_t c = *a;
    *a = *b;
    *b = c;
}

/* moves the keys smaller than the key of rank `nth` before it and the larger ones after it (Hoare) */
static void select_key(uint64_t *keys, int32_t begin, int32_t end, int32_t nth)
{
    int32_t low = begin, high = end - 1;
    while (low < high) {
        int32_t middle = low + (high - low) / 2;
        if (keys[middle] < keys[low])
            exchange(&keys[middle], &keys[low]);
        if (keys[high] < keys[low])
            exchange(&keys[high], &keys[low]);
        if (keys[high] < keys[middle])
            exchange(&keys[high], &keys[middle]);
        uint64_t pivot = keys[middle];
        int32_t i = low, j = high;
        while (i <= j) {
            while (keys[i] < pivot)
                i++;
            while (keys[j] > pivot)
                j--;
            if (i <= j)
                exchange(&keys[i++], &keys[j--]);
        }
        if (nth <= j)
            high = j;
        else if (nth >= i)
            low = i;
        else
            return;
    }
}

/* the group of all keys, -1 = there are several */
static int32_t common_group(const build *b, int32_t begin, int32_t end)
{
    int32_t group = group_of(b->tree, (uint32_t)b->keys[begin]);
    for (int32_t i = begin + 1; i < end && b->tree->node_groups != NULL; i++)
        if (group_of(b->tree, (uint32_t)b->keys[i]) != group)
            return -1;
    return group;
}

/* leaves begin..end; depth is the logarithm of their number */
static void sort_triangles(build *b, int32_t begin, int32_t end)
{
    if (end - begin < 2)
        return;
    const pel_tree *tree = b->tree;
    int32_t first = PEL_LANES * begin, middle = pel_tree_middle(begin, end);
    int32_t last = end == tree->leaf_count ? tree->triangle_count : PEL_LANES * end;
    b->is_mixed = common_group(b, first, last) < 0;
    int axis = longest_axis(b, first, last);
    for (int32_t i = first; i < last; i++) {
        uint32_t t = (uint32_t)b->keys[i];
        b->keys[i] = make_key(get_centroid(b, t, axis), (int32_t)t);
    }
    select_key(b->keys, first, last, PEL_LANES * middle);
    sort_triangles(b, begin, middle);
    sort_triangles(b, middle, end);
}

static void fill_leaves(const build *b)
{
    pel_tree *tree = b->tree;
    for (int32_t leaf = 0; leaf < tree->leaf_count; leaf++)
        for (int32_t lane = 0; lane < PEL_LANES; lane++) {
            int32_t i = PEL_LANES * leaf + lane;
            tree->leaves[leaf][lane] = i < tree->triangle_count ? (int32_t)(uint32_t)b->keys[i] : -1;
        }
}

static void place_groups(build *b)
{
    pel_tree *tree = b->tree;
    int32_t count = tree->node_groups != NULL ? tree->groups.group_count : 0;
    b->is_mixed = false;
    for (int32_t g = 0; g < count; g++)
        memset(tree->group_places[g], 0, sizeof tree->group_places[g]);
    for (int32_t t = 0; t < tree->triangle_count && count > 0; t++) {
        float *place = tree->group_places[group_of(tree, (uint32_t)t)];
        place[3]++;
        for (int k = 0; k < 3; k++)
            place[k] += (get_centroid(b, (uint32_t)t, k) - place[k]) / place[3];
    }
}

/* of all corners in a leaf */
static int32_t group_of_leaf(const pel_tree *tree, int32_t leaf)
{
    const int32_t *triangles = tree->leaves[leaf], *groups = tree->groups.group_of_vertex;
    int32_t group = group_of(tree, (uint32_t)triangles[0]);
    for (int lane = 0; lane < PEL_LANES && triangles[lane] >= 0; lane++)
        for (int i = 0; i < 3; i++)
            if (groups[tree->triangles[triangles[lane]][i]] != group)
                return -1;
    return group;
}

/* of a node over leaves begin..end and all below; returns its own */
static int32_t group_nodes(pel_tree *tree, int32_t node, int32_t begin, int32_t end)
{
    int32_t middle = pel_tree_middle(begin, end);
    if (end - begin == 1)
        return tree->node_groups[node] = group_of_leaf(tree, begin);
    int32_t left = group_nodes(tree, node + 1, begin, middle);
    int32_t right = group_nodes(tree, node + 2 * (middle - begin), middle, end);
    return tree->node_groups[node] = left == right ? left : -1;
}

static void run_build(build *b)
{
    pel_tree *tree = b->tree;
    b->origin = b->positions[tree->triangles[0][0]];
    b->keys = (uint64_t *)(void *)tree->nodes;
    for (int32_t t = 0; t < tree->triangle_count; t++)
        b->keys[t] = (uint64_t)t;
    for (int32_t t = 0; b->centroids != NULL && t < tree->triangle_count; t++)
        for (int k = 0; k < 3; k++)
            b->centroids[t][k] = centroid(b, (uint32_t)t, k);
    place_groups(b);
    sort_triangles(b, 0, tree->leaf_count);
    fill_leaves(b);
    if (tree->node_groups != NULL)
        group_nodes(tree, 0, 0, tree->leaf_count);
    for (int32_t n = 0; n < tree->node_count; n++)
        tree->nodes[n] = pel_box_empty();
    tree->built_cost = 0;
    tree->is_stale = false;
}

void pel_tree_rebuild(pel_tree *tree, const double (*positions)[3])
{
    build b = {.tree = tree, .positions = positions};
    run_build(&b);
    PEL_ASSERT_WHOLE(pel_tree_is_valid(tree));
}

/* for the first time, with memory to do it faster */
static pel_status build_first(pel_tree *tree, const double (*positions)[3])
{
    build b = {.tree = tree, .positions = positions};
    b.centroids = pel_allocate((size_t)tree->triangle_count, sizeof *b.centroids);
    if (b.centroids == NULL)
        return PEL_OUT_OF_MEMORY;
    run_build(&b);
    pel_free(b.centroids);
    return PEL_OK;
}

/* whether half of the triangles do not meet their own group: a tree is built once more for them */
static bool is_worth_groups(const pel_tree *tree)
{
    const pel_collision_groups *groups = &tree->groups;
    int32_t count = 0;
    for (int32_t t = 0; groups->group_of_vertex != NULL && t < tree->triangle_count; t++) {
        int32_t group = groups->group_of_vertex[tree->triangles[t][0]];
        count += !groups->may_meet[group * groups->group_count + group];
    }
    return count > tree->triangle_count / 2;
}

pel_status pel_tree_use_groups(pel_tree *tree, const pel_collision_groups *groups)
{
    PEL_FREE_ALL(tree->node_groups, tree->group_places);
    tree->node_groups = NULL;
    tree->group_places = NULL;
    tree->groups = *groups;
    if (!is_worth_groups(tree))
        return PEL_OK;
    tree->is_stale = true;
    bool made = PEL_ALLOCATE_ALL(PEL_ROOM(tree->node_groups, tree->node_count),
                                 PEL_ROOM(tree->group_places, groups->group_count));
    for (int32_t n = 0; made && n < tree->node_count; n++)
        tree->node_groups[n] = -1;
    return made ? PEL_OK : PEL_OUT_OF_MEMORY;
}

/* ---- creation ---- */

/* closes the chain of the half-edges of each edge to a ring */
static void close_rings(const pel_edge_table *table, int32_t half_edge_count)
{
    for (int32_t h = 0; h < half_edge_count; h++)
        if (table->next_in_edge[h] < 0)
            table->next_in_edge[h] = table->half_edge_of_edge[table->edge_of_half_edge[h]];
}

/* gives each edge and each vertex to the first triangle that has it; seen: (vertex_count) zeros */
static void assign_features(pel_tree *tree, const pel_edge_table *table, uint8_t *seen)
{
    for (int32_t e = 0; e < table->edge_count; e++) {
        int32_t h = table->half_edge_of_edge[e];
        tree->features[h / 3] |= (uint8_t)(1 << h % 3);
    }
    for (int32_t h = 0; h < 3 * tree->triangle_count; h++) {
        int32_t v = pel_tree_corner(tree, h);
        if (!seen[v])
            tree->features[h / 3] |= (uint8_t)(8 << h % 3);
        seen[v] = 1;
    }
}

static pel_status find_features(pel_tree *tree)
{
    pel_edge_table table;
    if (pel_edge_table_build(tree->triangles, tree->triangle_count, tree->vertex_count, NULL, &table) != PEL_OK)
        return PEL_OUT_OF_MEMORY;
    uint8_t *seen;
    bool made = PEL_ALLOCATE_ALL(PEL_ROOM(seen, tree->vertex_count), PEL_ROOM(tree->features, tree->triangle_count));
    if (made) {
        close_rings(&table, 3 * tree->triangle_count);
        assign_features(tree, &table, seen);
        tree->next_in_edge = table.next_in_edge;
        table.next_in_edge = NULL;
    }
    pel_free(seen);
    pel_edge_table_clear(&table);
    return made ? PEL_OK : PEL_OUT_OF_MEMORY;
}

static pel_status allocate_tree(pel_tree *tree)
{
    /* one more: a build keeps its keys there */
    return PEL_ALLOCATE_ALL(PEL_ROOM_ALIGNED(tree->nodes, (size_t)tree->node_count + 1),
                            PEL_ROOM(tree->leaves, tree->leaf_count))
               ? PEL_OK
               : PEL_OUT_OF_MEMORY;
}

pel_status pel_tree_create(const double (*positions)[3], int32_t vertex_count, const int32_t (*triangles)[3],
                           int32_t triangle_count, pel_tree_content content, pel_tree **result, pel_error *error)
{
    *result = NULL;
    if (triangle_count < 1 || triangle_count > INT32_MAX / 3)
        return pel_fail(error, PEL_BAD_ARGUMENT, "a tree over %d triangles cannot be made", (int)triangle_count);
    pel_tree *tree = pel_allocate(1, sizeof *tree);
    if (tree == NULL)
        return pel_fail_memory(error);
    tree->vertex_count = vertex_count;
    tree->triangle_count = triangle_count;
    tree->leaf_count = (triangle_count + PEL_LANES - 1) / PEL_LANES;
    tree->node_count = 2 * tree->leaf_count - 1;
    tree->triangles = triangles;
    if ((content == PEL_TREE_FEATURES && find_features(tree) != PEL_OK) || allocate_tree(tree) != PEL_OK ||
        build_first(tree, positions) != PEL_OK) {
        pel_tree_destroy(tree);
        return pel_fail_memory(error);
    }
    PEL_ASSERT_WHOLE(pel_tree_is_valid(tree));
    *result = tree;
    return PEL_OK;
}

void pel_tree_destroy(pel_tree *tree)
{
    if (tree == NULL)
        return;
    PEL_FREE_ALL(tree->next_in_edge, tree->features, tree->nodes, tree->leaves, tree->node_groups, tree->group_places,
                 tree);
}

/* ---- boxes ---- */

static pel_box leaf_box(const pel_tree *tree, int32_t leaf, const pel_box *boxes)
{
    PEL_ASSERT_INDEX(leaf, tree->leaf_count);
    const int32_t *triangles = tree->leaves[leaf];
    pel_box whole = pel_box_empty();
    for (int lane = 0; lane < PEL_LANES && triangles[lane] >= 0; lane++)
        whole = pel_box_join(whole, pel_tree_triangle_box(tree, boxes, triangles[lane]));
    return whole;
}

/* arguments of a fit of nodes */
typedef struct fit {
    pel_tree *tree;
    const pel_box *boxes;
    const uint8_t *vertex_changed; /* null = all */
    uint8_t *node_changed;
} fit;

/* nodes of this many leaves are fitted in parallel; the few above them afterwards */
enum { LEAVES_PER_CHUNK = 64 };

static pel_box refit_below(const fit *f, int32_t node, int32_t begin, int32_t end)
{
    pel_tree *tree = f->tree;
    if (end - begin == 1)
        return tree->nodes[node] = leaf_box(tree, begin, f->boxes);
    int32_t middle = pel_tree_middle(begin, end);
    pel_box left = refit_below(f, node + 1, begin, middle);
    pel_box right = refit_below(f, node + 2 * (middle - begin), middle, end);
    return tree->nodes[node] = pel_box_join(left, right);
}

/* the nodes above those that chunks fitted */
static pel_box refit_above(const fit *f, int32_t node, int32_t begin, int32_t end)
{
    if (end - begin <= LEAVES_PER_CHUNK)
        return f->tree->nodes[node];
    int32_t middle = pel_tree_middle(begin, end);
    pel_box left = refit_above(f, node + 1, begin, middle);
    pel_box right = refit_above(f, node + 2 * (middle - begin), middle, end);
    return f->tree->nodes[node] = pel_box_join(left, right);
}

/* the node of a chunk: the one of at most LEAVES_PER_CHUNK leaves that holds the leaf where the chunk begins. A node
   that begins in an earlier chunk is fitted there */
static void refit_chunk(void *context, int32_t chunk)
{
    const fit *f = context;
    int32_t last = f->tree->leaf_count - 1, leaf = chunk * (LEAVES_PER_CHUNK / 2);
    int32_t until = leaf + LEAVES_PER_CHUNK / 2;
    for (leaf = leaf < last ? leaf : last; leaf < until && leaf <= last;) {
        int32_t node = 0, begin = 0, end = f->tree->leaf_count;
        while (end - begin > LEAVES_PER_CHUNK) {
            int32_t middle = pel_tree_middle(begin, end);
            node = leaf < middle ? node + 1 : node + 2 * (middle - begin);
            begin = leaf < middle ? begin : middle;
            end = leaf < middle ? middle : end;
        }
        if (begin >= chunk * (LEAVES_PER_CHUNK / 2))
            refit_below(f, node, begin, end);
        leaf = end;
    }
}

void pel_tree_refit(pel_tree *tree, const pel_box *vertex_boxes, pel_pool *pool)
{
    fit f = {.tree = tree, .boxes = vertex_boxes};
    tree->vertex_boxes = vertex_boxes;
    pel_pool_run(pool, 1 + (tree->leaf_count - 1) / (LEAVES_PER_CHUNK / 2), refit_chunk, &f);
    refit_above(&f, 0, 0, tree->leaf_count);
    if (!(tree->built_cost > 0))
        tree->built_cost = pel_tree_cost(tree);
    PEL_ASSERT_WHOLE(pel_tree_is_valid(tree));
}

static bool leaf_changed(const fit *f, int32_t leaf)
{
    const int32_t *triangles = f->tree->leaves[leaf];
    bool changed = false;
    for (int lane = 0; lane < PEL_LANES && triangles[lane] >= 0; lane++)
        for (int corner = 0; corner < 3; corner++)
            changed |= f->vertex_changed[f->tree->triangles[triangles[lane]][corner]];
    return changed;
}

static void refit_changed(const fit *f, int32_t node, int32_t begin, int32_t end)
{
    pel_tree *tree = f->tree;
    if (end - begin == 1) {
        f->node_changed[node] = leaf_changed(f, begin);
        if (f->node_changed[node])
            tree->nodes[node] = leaf_box(tree, begin, f->boxes);
        return;
    }
    int32_t middle = pel_tree_middle(begin, end), left = node + 1, right = node + 2 * (middle - begin);
    refit_changed(f, left, begin, middle);
    refit_changed(f, right, middle, end);
    f->node_changed[node] = f->node_changed[left] | f->node_changed[right];
    tree->nodes[node] = pel_box_join(tree->nodes[left], tree->nodes[right]);
}

void pel_tree_refit_changed(pel_tree *tree, const uint8_t *vertex_changed, uint8_t *node_changed)
{
    const fit f = {tree, tree->vertex_boxes, vertex_changed, node_changed};
    refit_changed(&f, 0, 0, tree->leaf_count);
}

/* all of the nodes below one stand behind it */
static void mark(const pel_tree *tree, const uint8_t *groups, int32_t node, int32_t begin, int32_t end, uint8_t *marks)
{
    int32_t own = tree->node_groups != NULL ? tree->node_groups[node] : -1;
    if (own >= 0) {
        memset(marks + node, groups[own], 2 * (size_t)(end - begin) - 1);
        return;
    }
    if (end - begin > 1) {
        int32_t middle = pel_tree_middle(begin, end), left = node + 1, right = node + 2 * (middle - begin);
        mark(tree, groups, left, begin, middle, marks);
        mark(tree, groups, right, middle, end, marks);
        marks[node] = marks[left] | marks[right];
        return;
    }
    const int32_t *triangles = tree->leaves[begin];
    marks[node] = 0;
    for (int lane = 0; lane < PEL_LANES && triangles[lane] >= 0; lane++)
        marks[node] |= groups[tree->groups.group_of_vertex[tree->triangles[triangles[lane]][0]]];
}

void pel_tree_mark_groups(const pel_tree *tree, const uint8_t *groups, uint8_t *marks)
{
    mark(tree, groups, 0, 0, tree->leaf_count, marks);
}

double pel_tree_cost(const pel_tree *tree)
{
    double sum = 0;
    for (int32_t n = 0; n < tree->node_count; n++)
        sum += pel_box_area(&tree->nodes[n]);
    return sum / pel_max(pel_box_area(&tree->nodes[0]), 1e-300);
}
