#include "bvh/tree.h"

#include "base/memory.h"
#include "base/status.h"
#include "mesh/edge_table.h"

#include <string.h>

enum { GROUPS_PER_LEAF = 4 }; /* at most: triangles 1, edges 3 */

/* ---- creation ---- */

static pel_status find_edges(pel_tree *tree)
{
    pel_edge_table table;
    if (pel_edge_table_build((const int32_t(*)[3])tree->triangles, tree->triangle_count, tree->vertex_count, NULL,
                             &table) != PEL_OK)
        return PEL_OUT_OF_MEMORY;
    tree->edge_count = table.edge_count;
    tree->edges = pel_allocate((size_t)table.edge_count, sizeof *tree->edges);
    tree->triangle_edges = pel_allocate((size_t)tree->triangle_count, sizeof *tree->triangle_edges);
    tree->opposite = pel_allocate((size_t)table.edge_count, sizeof *tree->opposite);
    bool made = tree->edges != NULL && tree->triangle_edges != NULL && tree->opposite != NULL;
    if (made) {
        memcpy(tree->triangle_edges, table.edge_of_half_edge, (size_t)tree->triangle_count * sizeof(int32_t[3]));
        for (int32_t e = 0; e < table.edge_count; e++) {
            int32_t h = table.half_edge_of_edge[e], next = table.next_in_edge[h];
            tree->opposite[e][0] = tree->triangles[h / 3][(h + 2) % 3];
            tree->opposite[e][1] = next >= 0 ? tree->triangles[next / 3][(next + 2) % 3] : -1;
            tree->edges[e][0] = tree->triangles[h / 3][h % 3];
            tree->edges[e][1] = tree->triangles[h / 3][(h + 1) % 3];
        }
    }
    pel_edge_table_clear(&table);
    return made ? PEL_OK : PEL_OUT_OF_MEMORY;
}

/* At most: each leaf leaves a group of edges unfilled. */
static size_t group_limit(const pel_tree *tree, pel_tree_content content)
{
    size_t leaf_count = (size_t)tree->leaf_count, full;
    if (content == PEL_TREE_TRIANGLES)
        return leaf_count;
    full = ((size_t)tree->edge_count + (PEL_LANES - 1) * leaf_count) / PEL_LANES;
    return leaf_count + (full < (GROUPS_PER_LEAF - 1) * leaf_count ? full : (GROUPS_PER_LEAF - 1) * leaf_count);
}

static pel_status allocate_tree(pel_tree *tree, pel_tree_content content)
{
    size_t leaf_count = (size_t)tree->leaf_count;
    size_t group_count = group_limit(tree, content);
    tree->nodes = pel_allocate_aligned((size_t)tree->node_count, sizeof *tree->nodes);
    tree->leaves = pel_allocate(leaf_count, sizeof *tree->leaves);
    tree->groups = pel_allocate_aligned(group_count, sizeof *tree->groups);
    tree->members = pel_allocate_aligned(group_count, sizeof *tree->members);
    bool made = tree->nodes != NULL && tree->leaves != NULL && tree->groups != NULL && tree->members != NULL;
    if (made && content == PEL_TREE_FEATURES) {
        tree->leaf_vertices = pel_allocate((size_t)tree->vertex_count, sizeof *tree->leaf_vertices);
        tree->vertex_seen = pel_allocate((size_t)tree->vertex_count, 1);
        made = tree->leaf_vertices != NULL && tree->vertex_seen != NULL;
    }
    return made ? PEL_OK : PEL_OUT_OF_MEMORY;
}

static pel_status fill_tree(pel_tree *tree, const int32_t (*triangles)[3], pel_tree_content content)
{
    tree->triangles = pel_allocate((size_t)tree->triangle_count, sizeof *tree->triangles);
    if (tree->triangles == NULL)
        return PEL_OUT_OF_MEMORY;
    memcpy(tree->triangles, triangles, (size_t)tree->triangle_count * sizeof *triangles);
    if (content == PEL_TREE_FEATURES && find_edges(tree) != PEL_OK)
        return PEL_OUT_OF_MEMORY;
    return allocate_tree(tree, content);
}

pel_status pel_tree_create(const double (*positions)[3], int32_t vertex_count, const int32_t (*triangles)[3],
                           int32_t triangle_count, pel_tree_content content, pel_tree **result, pel_error *error)
{
    *result = NULL;
    if (triangle_count < 1 || triangle_count > INT32_MAX / GROUPS_PER_LEAF)
        return pel_fail(error, PEL_BAD_ARGUMENT, "a tree over %d triangles cannot be made", (int)triangle_count);
    pel_tree *tree = pel_allocate(1, sizeof *tree);
    if (tree == NULL)
        return pel_fail_memory(error);
    tree->vertex_count = vertex_count;
    tree->triangle_count = triangle_count;
    tree->leaf_count = (triangle_count + PEL_LANES - 1) / PEL_LANES;
    tree->node_count = 2 * tree->leaf_count - 1;
    if (fill_tree(tree, triangles, content) != PEL_OK) {
        pel_tree_destroy(tree);
        return pel_fail_memory(error);
    }
    pel_tree_rebuild(tree, positions);
    *result = tree;
    return PEL_OK;
}

void pel_tree_destroy(pel_tree *tree)
{
    if (tree == NULL)
        return;
    pel_free(tree->triangles);
    pel_free(tree->edges);
    pel_free(tree->triangle_edges);
    pel_free(tree->opposite);
    pel_free(tree->nodes);
    pel_free(tree->leaves);
    pel_free(tree->groups);
    pel_free(tree->members);
    pel_free(tree->leaf_vertices);
    pel_free(tree->vertex_seen);
    pel_free(tree);
}

/* ---- order of the triangles ---- */

/* Scratch of a build, in the memory of the boxes, which a build leaves empty: a group has 24 bytes a triangle or edge,
   keys and centroids take 20, and all edges come after the triangles. */
typedef struct build {
    pel_tree *tree;
    uint64_t *keys;        /* (triangle_count) place along an axis, triangle */
    float (*centroids)[3]; /* (triangle_count) */
    uint8_t *seen_edges;   /* (edge_count) */
} build;

static build begin_build(pel_tree *tree)
{
    char *memory = (char *)tree->groups;
    size_t count = (size_t)tree->triangle_count;
    build b = {.tree = tree, .keys = (uint64_t *)(void *)memory};
    memory += count * sizeof *b.keys;
    b.centroids = (float(*)[3])(void *)memory;
    memory += count * sizeof *b.centroids;
    b.seen_edges = (uint8_t *)memory;
    return b;
}

static void find_centroids(build *b, const double (*positions)[3])
{
    const pel_tree *tree = b->tree;
    const double *origin = positions[tree->triangles[0][0]];
    for (int32_t t = 0; t < tree->triangle_count; t++) {
        const int32_t *v = tree->triangles[t];
        for (int k = 0; k < 3; k++) {
            double sum = (positions[v[0]][k] - origin[k]) + (positions[v[1]][k] - origin[k]);
            sum += positions[v[2]][k] - origin[k];
            b->centroids[t][k] = isfinite(sum) ? (float)sum : 0;
        }
    }
}

/* keys rise as the coordinate does, equal ones by triangle: the order is the same whatever sorted them */
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
        low[k] = high[k] = b->centroids[(uint32_t)b->keys[begin]][k];
    for (int32_t i = begin + 1; i < end; i++)
        for (int k = 0; k < 3; k++) {
            float x = b->centroids[(uint32_t)b->keys[i]][k];
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

/* moves the keys smaller than that of rank `nth` before it and the larger ones behind it (Hoare) */
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

/* leaves begin..end; depth is the logarithm of their number */
static void sort_triangles(build *b, int32_t begin, int32_t end)
{
    if (end - begin < 2)
        return;
    const pel_tree *tree = b->tree;
    int32_t first = PEL_LANES * begin, middle = pel_tree_middle(begin, end);
    int32_t last = end == tree->leaf_count ? tree->triangle_count : PEL_LANES * end;
    int axis = longest_axis(b, first, last);
    for (int32_t i = first; i < last; i++) {
        uint32_t t = (uint32_t)b->keys[i];
        b->keys[i] = make_key(b->centroids[t][axis], (int32_t)t);
    }
    select_key(b->keys, first, last, PEL_LANES * middle);
    sort_triangles(b, begin, middle);
    sort_triangles(b, middle, end);
}

/* ---- content of the leaves ---- */

/* puts an element into the next lane of the groups from `first` on; returns the new number of elements */
static int32_t add_member(pel_tree *tree, int32_t first, int32_t count, int32_t element)
{
    pel_box8_mask *lanes = &tree->members[first + count / PEL_LANES].element;
    if (count % PEL_LANES == 0)
        *lanes = (pel_box8_mask){-1, -1, -1, -1, -1, -1, -1, -1};
    (*lanes)[count % PEL_LANES] = element;
    return count + 1;
}

/* edges of a leaf's triangles that no earlier triangle has; returns the group after the last */
static int32_t add_edges(build *b, int32_t triangle_group)
{
    pel_tree *tree = b->tree;
    int32_t count = 0, group = triangle_group + 1;
    for (int lane = 0; lane < PEL_LANES; lane++) {
        int32_t t = tree->members[triangle_group].element[lane];
        for (int i = 0; i < 3 && t >= 0; i++) {
            int32_t e = tree->triangle_edges[t][i];
            if (!b->seen_edges[e])
                count = add_member(tree, group, count, e);
            b->seen_edges[e] = 1;
        }
    }
    return group + (count + PEL_LANES - 1) / PEL_LANES;
}

static void add_triangles(const build *b, int32_t leaf, int32_t group)
{
    pel_tree *tree = b->tree;
    int32_t end = PEL_LANES * (leaf + 1) < tree->triangle_count ? PEL_LANES * (leaf + 1) : tree->triangle_count;
    for (int32_t i = PEL_LANES * leaf, count = 0; i < end; i++)
        count = add_member(tree, group, count, (int32_t)(uint32_t)b->keys[i]);
}

static void fill_groups(build *b)
{
    pel_tree *tree = b->tree;
    int32_t group = 0;
    memset(b->seen_edges, 0, (size_t)tree->edge_count);
    for (int32_t leaf = 0; leaf < tree->leaf_count; leaf++) {
        pel_leaf *at = &tree->leaves[leaf];
        *at = (pel_leaf){.group = group, .group_end = group + 1};
        add_triangles(b, leaf, group);
        if (tree->edges != NULL)
            at->group_end = add_edges(b, group);
        group = at->group_end;
    }
}

/* vertices of a leaf's triangles that no earlier triangle has */
static void fill_vertices(pel_tree *tree)
{
    int32_t count = 0;
    memset(tree->vertex_seen, 0, (size_t)tree->vertex_count);
    for (int32_t leaf = 0; leaf < tree->leaf_count; leaf++) {
        pel_leaf *at = &tree->leaves[leaf];
        at->vertex_begin = count;
        for (int lane = 0; lane < PEL_LANES; lane++) {
            int32_t t = tree->members[at->group].element[lane];
            for (int i = 0; i < 3 && t >= 0; i++) {
                int32_t v = tree->triangles[t][i];
                if (!tree->vertex_seen[v])
                    tree->leaf_vertices[count++] = v;
                tree->vertex_seen[v] = 1;
            }
        }
        at->vertex_end = count;
    }
}

static void set_vertices(pel_tree *tree, int32_t leaf)
{
    const pel_leaf *at = &tree->leaves[leaf];
    for (int32_t g = at->group; g < at->group_end; g++)
        for (int lane = 0; lane < PEL_LANES; lane++) {
            pel_member_group *members = &tree->members[g];
            int32_t i = members->element[lane];
            for (int corner = 0; corner < 3; corner++) {
                int32_t v = i;
                if (i >= 0 && g == at->group)
                    v = tree->triangles[i][corner];
                else if (i >= 0)
                    v = tree->edges[i][corner < 2 ? corner : 1];
                members->vertices[corner][lane] = v;
            }
        }
}

void pel_tree_rebuild(pel_tree *tree, const double (*positions)[3])
{
    build b = begin_build(tree);
    find_centroids(&b, positions);
    for (int32_t t = 0; t < tree->triangle_count; t++)
        b.keys[t] = (uint64_t)t;
    sort_triangles(&b, 0, tree->leaf_count);
    fill_groups(&b);
    if (tree->leaf_vertices != NULL)
        fill_vertices(tree);
    for (int32_t leaf = 0; leaf < tree->leaf_count; leaf++)
        set_vertices(tree, leaf);
    for (int32_t n = 0; n < tree->node_count; n++)
        tree->nodes[n] = pel_box_empty();
    for (int32_t g = 0; g < tree->leaves[tree->leaf_count - 1].group_end; g++)
        for (int lane = 0; lane < PEL_LANES; lane++)
            pel_box_group_set(&tree->groups[g], lane, pel_box_empty());
    tree->built_cost = 0;
}

/* ---- boxes ---- */

static pel_box refit_leaf(pel_tree *tree, const pel_leaf *leaf, const pel_box *boxes)
{
    pel_box whole = pel_box_empty();
    for (int lane = 0; lane < PEL_LANES && tree->members[leaf->group].element[lane] >= 0; lane++) {
        pel_box box = pel_tree_triangle_box(tree, boxes, tree->members[leaf->group].element[lane]);
        pel_box_group_set(&tree->groups[leaf->group], lane, box);
        whole = pel_box_join(whole, box);
    }
    for (int32_t g = leaf->group + 1; g < leaf->group_end; g++)
        for (int lane = 0; lane < PEL_LANES && tree->members[g].element[lane] >= 0; lane++)
            pel_box_group_set(&tree->groups[g], lane, pel_tree_edge_box(tree, boxes, tree->members[g].element[lane]));
    return whole;
}

/* what a fit of nodes needs */
typedef struct fit {
    pel_tree *tree;
    const pel_box *boxes;
    const uint8_t *vertex_changed; /* null = all */
    uint8_t *node_changed;
} fit;

/* nodes of this many leaves are fitted at once; the few above them afterwards */
enum { LEAVES_PER_CHUNK = 64 };

static pel_box refit_below(const fit *f, int32_t node, int32_t begin, int32_t end)
{
    pel_tree *tree = f->tree;
    if (end - begin == 1)
        return tree->nodes[node] = refit_leaf(tree, &tree->leaves[begin], f->boxes);
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
}

static bool leaf_changed(const fit *f, const pel_leaf *leaf)
{
    const pel_member_group *members = &f->tree->members[leaf->group];
    bool changed = false;
    for (int lane = 0; lane < PEL_LANES && members->element[lane] >= 0; lane++)
        for (int corner = 0; corner < 3; corner++)
            changed |= f->vertex_changed[members->vertices[corner][lane]];
    return changed;
}

static void refit_changed(const fit *f, int32_t node, int32_t begin, int32_t end)
{
    pel_tree *tree = f->tree;
    if (end - begin == 1) {
        f->node_changed[node] = leaf_changed(f, &tree->leaves[begin]);
        if (f->node_changed[node])
            tree->nodes[node] = refit_leaf(tree, &tree->leaves[begin], f->boxes);
        return;
    }
    int32_t middle = pel_tree_middle(begin, end), left = node + 1, right = node + 2 * (middle - begin);
    refit_changed(f, left, begin, middle);
    refit_changed(f, right, middle, end);
    f->node_changed[node] = f->node_changed[left] | f->node_changed[right];
    tree->nodes[node] = pel_box_join(tree->nodes[left], tree->nodes[right]);
}

void pel_tree_refit_changed(pel_tree *tree, const pel_box *vertex_boxes, const uint8_t *vertex_changed,
                            uint8_t *node_changed)
{
    fit f = {tree, vertex_boxes, vertex_changed, node_changed};
    tree->vertex_boxes = vertex_boxes;
    refit_changed(&f, 0, 0, tree->leaf_count);
}

double pel_tree_cost(const pel_tree *tree)
{
    double sum = 0;
    for (int32_t n = 0; n < tree->node_count; n++)
        sum += pel_box_area(&tree->nodes[n]);
    return sum / fmax(pel_box_area(&tree->nodes[0]), 1e-300);
}
