#include "subdivide/front.h"

#include "base/assert.h"
#include "base/memory.h"
#include "base/sort.h"
#include "base/status.h"
#include "subdivide/split.h"

#include <string.h>

enum {
    MARKED = 1,    /* by the caller */
    RED = 2,       /* refined; for nodes below red_limit */
    WAS_RED = 4,   /* as of the last commit; kept while TOUCHED */
    TOUCHED = 8,   /* in the list of touched nodes */
    PENDING = 16,  /* in the list of changed marks */
    CANDIDATE = 32 /* in the list of candidates of a level */
};

/* ---- creation ---- */

typedef struct front_size {
    int64_t node_count, red_limit, edge_count, red_edge_count, fine_vertex_count, fine_triangle_count, fine_edge_count;
} front_size;

static front_size size_of(const pel_topology *base, int32_t depth)
{
    pel_level_size level = pel_level_size_of(base);
    front_size size = {0};
    for (int32_t l = 0; l < depth; l++) {
        size.red_limit += level.triangle_count;
        size.red_edge_count += level.edge_count;
        level = pel_level_size_split(level);
    }
    size.node_count = size.red_limit + level.triangle_count;
    size.edge_count = size.red_edge_count + level.edge_count;
    size.fine_vertex_count = level.vertex_count;
    size.fine_triangle_count = level.triangle_count;
    size.fine_edge_count = level.edge_count;
    return size;
}

/* one array of the front */
typedef struct array_entry {
    void **array;
    int64_t count;
    size_t size;
} array_entry;

enum { ARRAY_COUNT = 19 };

static void list_arrays(pel_front *front, const front_size *size, array_entry entries[ARRAY_COUNT])
{
    const array_entry all[ARRAY_COUNT] = {
        {(void **)&front->flags, size->node_count, sizeof *front->flags},
        {(void **)&front->shapes, size->node_count, sizeof *front->shapes},
        {(void **)&front->old_shapes, size->node_count, sizeof *front->old_shapes},
        {(void **)&front->red_counts, size->red_edge_count, sizeof *front->red_counts},
        {(void **)&front->triangles, size->fine_triangle_count, sizeof *front->triangles},
        {(void **)&front->place_of_node, size->node_count, sizeof *front->place_of_node},
        {(void **)&front->vertices, size->fine_vertex_count, sizeof *front->vertices},
        {(void **)&front->index_in_front, size->fine_vertex_count, sizeof *front->index_in_front},
        {(void **)&front->edges, size->fine_edge_count, sizeof *front->edges},
        {(void **)&front->place_of_edge, size->edge_count + size->node_count, sizeof *front->place_of_edge},
        {(void **)&front->changes, size->node_count, sizeof *front->changes},
        {(void **)&front->added_vertices, size->fine_vertex_count, sizeof *front->added_vertices},
        {(void **)&front->removed_vertices, size->fine_vertex_count, sizeof *front->removed_vertices},
        {(void **)&front->pending, size->red_limit, sizeof *front->pending},
        {(void **)&front->touched, size->red_limit, sizeof *front->touched},
        {(void **)&front->candidates, size->red_limit, sizeof *front->candidates},
        {(void **)&front->coarser, size->red_limit, sizeof *front->coarser},
        {(void **)&front->deleted, size->red_limit, sizeof *front->deleted},
        {(void **)&front->stack, size->red_limit, sizeof *front->stack},
    };
    memcpy(entries, all, sizeof all);
}

static void set_shape(pel_front *front, int32_t node, uint8_t shape);
static void update_edge(pel_front *front, int32_t edge, bool active);
static void update_vertex(pel_front *front, int32_t v, bool active);

/* the base as the surface */
static void start_base(pel_front *front, const front_size *size)
{
    const pel_topology *base = front->forest->levels[0];
    memset(front->place_of_node, -1, (size_t)size->node_count * sizeof *front->place_of_node);
    memset(front->index_in_front, -1, (size_t)size->fine_vertex_count * sizeof *front->index_in_front);
    memset(front->place_of_edge, -1, (size_t)(size->edge_count + size->node_count) * sizeof *front->place_of_edge);
    for (int32_t v = 0; v < base->vertex_count; v++)
        update_vertex(front, v, true);
    front->added_count = 0;
    for (int32_t e = 0; e < base->edge_count; e++)
        update_edge(front, e, true);
    for (int32_t t = 0; t < base->triangle_count; t++)
        set_shape(front, t, PEL_FRONT_WHOLE);
    memcpy(front->old_shapes, front->shapes, (size_t)size->node_count);
    front->next_triangle_count = front->triangle_count;
}

pel_status pel_front_create(const pel_lod_forest *forest, pel_front **front, pel_error *error)
{
    *front = NULL;
    pel_front *made = pel_allocate(1, sizeof *made);
    if (made == NULL)
        return pel_fail_memory(error);
    front_size size = size_of(forest->levels[0], forest->depth);
    array_entry entries[ARRAY_COUNT];
    list_arrays(made, &size, entries);
    for (int i = 0; i < ARRAY_COUNT; i++) {
        *entries[i].array = pel_allocate((size_t)entries[i].count, entries[i].size);
        if (*entries[i].array == NULL) {
            pel_front_destroy(made);
            return pel_fail_memory(error);
        }
    }
    made->forest = forest;
    made->red_limit = (int32_t)size.red_limit;
    made->node_count = (int32_t)size.node_count;
    made->bisector_begin = (int32_t)size.edge_count;
    for (int32_t l = 0; l <= forest->depth; l++)
        made->node_begin[l + 1] = made->node_begin[l] + forest->levels[l]->triangle_count;
    start_base(made, &size);
    PEL_ASSERT_WHOLE(pel_front_is_valid(made));
    *front = made;
    return PEL_OK;
}

void pel_front_destroy(pel_front *front)
{
    if (front == NULL)
        return;
    array_entry entries[ARRAY_COUNT];
    front_size none = {0};
    list_arrays(front, &none, entries);
    for (int i = 0; i < ARRAY_COUNT; i++)
        pel_free(*entries[i].array);
    pel_free(front);
}

/* ---- nodes ---- */

int32_t pel_front_level(const pel_front *front, int32_t node)
{
    PEL_ASSERT_INDEX(node, front->node_count);
    int32_t level = 0;
    while (node >= front->node_begin[level + 1])
        level++;
    return level;
}

bool pel_front_is_marked(const pel_front *front, int32_t node)
{
    PEL_ASSERT_INDEX(node, front->node_count);
    return front->flags[node] & MARKED;
}

/* a node with its place in the forest */
typedef struct place {
    const pel_topology *topology;
    int32_t level, begin, t;
} place;

static place place_on(const pel_front *front, int32_t level, int32_t node)
{
    PEL_ASSERT_INDEX(level, front->forest->depth + 1);
    PEL_ASSERT_INDEX(node, front->node_count);
    int32_t begin = front->node_begin[level];
    return (place){front->forest->levels[level], level, begin, node - begin};
}

/* neighbour across edge k, -1 on the boundary */
static int32_t neighbour(const place *at, int k)
{
    int32_t twin = at->topology->twin[3 * at->t + k];
    return twin < 0 ? -1 : at->begin + twin / 3;
}

/* number of edge k over all levels */
static int32_t edge_of(const pel_front *front, const place *at, int k)
{
    PEL_ASSERT_INDEX(k, 3);
    return pel_lod_midpoint(at->topology, 3 * at->t + k) - front->forest->levels[0]->vertex_count;
}

static bool is_red(const pel_front *front, int32_t node)
{
    return node >= 0 && node < front->red_limit && (front->flags[node] & RED) != 0;
}

static int split_edge_count(const pel_front *front, const place *at)
{
    int count = 0;
    for (int k = 0; k < 3; k++)
        count += front->red_counts[edge_of(front, at, k)] > 0;
    return count;
}

/* ---- closing ---- */

void pel_front_mark(pel_front *front, int32_t node, bool marked)
{
    PEL_ASSERT(node < front->node_count);
    PEL_ASSERT_INDEX(node, front->node_count);
    uint8_t *flags = &front->flags[node];
    if (node >= front->red_limit || (*flags & MARKED) == (marked ? MARKED : 0))
        return;
    *flags ^= MARKED;
    front->marked_count += marked ? 1 : -1;
    if ((*flags & PENDING) == 0) {
        *flags |= PENDING;
        front->pending[front->pending_count++] = node;
    }
}

void pel_front_mark_vertex(pel_front *front, int32_t v, int32_t level, bool marked)
{
    PEL_ASSERT_INDEX(v, front->forest->levels[front->forest->depth]->vertex_count);
    PEL_ASSERT_INDEX(level, front->forest->depth + 1);
    int32_t own = pel_lod_forest_vertex_level(front->forest, v);
    if (level <= own || level > front->forest->depth)
        return;
    const pel_topology *topology = front->forest->levels[level - 1];
    int32_t first = topology->corner_of_vertex[v], h = first;
    while (h >= 0) {
        pel_front_mark(front, front->node_begin[level - 1] + h / 3, marked);
        h = pel_half_edge_turn(topology, h);
        if (h == first)
            break;
    }
}

static void add_candidate(pel_front *front, int32_t *list, int32_t *count, int32_t node)
{
    PEL_ASSERT_INDEX(node, front->node_count);
    if (front->flags[node] & CANDIDATE)
        return;
    front->flags[node] |= CANDIDATE;
    list[(*count)++] = node;
}

/* nodes of the coarser level whose rules look at this node */
static void raise_parents(pel_front *front, const place *at)
{
    if (at->level == 0)
        return;
    int32_t begin = front->node_begin[at->level - 1];
    add_candidate(front, front->coarser, &front->coarser_count, begin + pel_lod_parent(at->t));
    for (int k = 0; k < 3; k++) {
        int32_t twin = at->topology->twin[3 * at->t + k];
        if (twin >= 0)
            add_candidate(front, front->coarser, &front->coarser_count, begin + pel_lod_parent(twin / 3));
    }
}

static void set_red(pel_front *front, const place *at, bool red)
{
    int32_t node = at->begin + at->t;
    uint8_t *flags = &front->flags[node];
    if ((*flags & TOUCHED) == 0) {
        *flags |= TOUCHED | (*flags & RED ? WAS_RED : 0);
        front->touched[front->touched_count++] = node;
    }
    *flags ^= RED;
    front->red_count += red ? 1 : -1;
    for (int k = 0; k < 3; k++) {
        uint8_t *count = &front->red_counts[edge_of(front, at, k)];
        int32_t gain = neighbour(at, k) < 0 ? 1 : 2;
        /* each split edge makes one more triangle on each of its sides */
        if (red && (*count)++ == 0)
            front->next_triangle_count += gain;
        if (!red && --(*count) == 0)
            front->next_triangle_count -= gain;
    }
    raise_parents(front, at);
}

/* a node that is red for other reasons than rule 3: marked, or by a red node of the finer level (rules 1 and 2) */
static bool is_seed(const pel_front *front, const place *at)
{
    if (front->flags[at->begin + at->t] & MARKED)
        return true;
    if (at->level + 1 >= front->forest->depth)
        return false;
    int32_t begin = front->node_begin[at->level + 1];
    const int32_t *twin = front->forest->levels[at->level + 1]->twin;
    for (int32_t i = 0; i < 4; i++) {
        int32_t child = pel_lod_child(at->t, i);
        if (is_red(front, begin + child))
            return true;
        for (int k = 0; k < 3; k++) {
            int32_t other = twin[3 * child + k];
            if (other >= 0 && is_red(front, begin + other / 3))
                return true;
        }
    }
    return false;
}

/* removes candidates that are no longer requested, with all nodes that might depend on them */
static int32_t delete_unsupported(pel_front *front, int32_t level)
{
    PEL_ASSERT_INDEX(level, front->forest->depth + 1);
    int32_t count = 0;
    for (int32_t c = 0; c < front->candidate_count; c++) {
        place at = place_on(front, level, front->candidates[c]);
        if (!is_red(front, front->candidates[c]) || is_seed(front, &at))
            continue;
        set_red(front, &at, false);
        front->deleted[count++] = front->candidates[c];
    }
    for (int32_t head = 0; head < count; head++) {
        place at = place_on(front, level, front->deleted[head]);
        for (int k = 0; k < 3; k++) {
            int32_t other = neighbour(&at, k);
            if (!is_red(front, other))
                continue;
            place there = place_on(front, level, other);
            if (is_seed(front, &there))
                continue;
            set_red(front, &there, false);
            front->deleted[count++] = other;
        }
    }
    return count;
}

/* makes a node red if the rules say so, with all that follows on its level */
static void insert_supported(pel_front *front, int32_t level, int32_t node)
{
    PEL_ASSERT_INDEX(level, front->forest->depth + 1);
    PEL_ASSERT_INDEX(node, front->node_count);
    place at = place_on(front, level, node);
    if (is_red(front, node) || (split_edge_count(front, &at) < 2 && !is_seed(front, &at)))
        return;
    set_red(front, &at, true);
    front->stack[0] = node;
    for (int32_t count = 1; count > 0;) {
        at = place_on(front, level, front->stack[--count]);
        for (int k = 0; k < 3; k++) {
            int32_t other = neighbour(&at, k);
            if (other < 0 || is_red(front, other))
                continue;
            place there = place_on(front, level, other);
            if (split_edge_count(front, &there) < 2)
                continue;
            set_red(front, &there, true);
            front->stack[count++] = other;
        }
    }
}

static void close_level(pel_front *front, int32_t level)
{
    PEL_ASSERT_INDEX(level, front->forest->depth + 1);
    int32_t deleted_count = delete_unsupported(front, level);
    for (int32_t c = 0; c < front->candidate_count; c++) {
        insert_supported(front, level, front->candidates[c]);
        front->flags[front->candidates[c]] &= (uint8_t)~CANDIDATE;
    }
    for (int32_t d = 0; d < deleted_count; d++)
        insert_supported(front, level, front->deleted[d]);
}

int32_t pel_front_close(pel_front *front)
{
    pel_sort_int32(front->pending, front->pending_count);
    for (int32_t level = front->forest->depth - 1; level >= 0 && front->pending_count + front->coarser_count > 0;
         level--) {
        int32_t *raised = front->coarser;
        front->coarser = front->candidates;
        front->candidates = raised;
        front->candidate_count = front->coarser_count;
        front->coarser_count = 0;
        while (front->pending_count > 0 && front->pending[front->pending_count - 1] >= front->node_begin[level]) {
            int32_t node = front->pending[--front->pending_count];
            front->flags[node] &= (uint8_t)~PENDING;
            add_candidate(front, front->candidates, &front->candidate_count, node);
        }
        close_level(front, level);
    }
    return front->next_triangle_count;
}

/* ---- lists ---- */

static void remove_triangle(pel_front *front, int32_t node, int half)
{
    PEL_ASSERT_INDEX(node, front->node_count);
    int32_t at = front->place_of_node[node][half], last = --front->triangle_count;
    front->place_of_node[node][half] = -1;
    if (at == last)
        return;
    front->triangles[at] = front->triangles[last];
    front->place_of_node[front->triangles[at].node][front->triangles[at].half] = at;
}

static void add_triangle(pel_front *front, const pel_front_triangle *triangle)
{
    front->place_of_node[triangle->node][triangle->half] = front->triangle_count;
    front->triangles[front->triangle_count++] = *triangle;
}

/* the triangles of a leaf; returns their number: 0, 1 or 2 */
static int leaf_triangles(const pel_front *front, int32_t level, int32_t node, uint8_t shape,
                          pel_front_triangle triangles[2])
{
    PEL_ASSERT_INDEX(level, front->forest->depth + 1);
    PEL_ASSERT_INDEX(node, front->node_count);
    if (shape == PEL_FRONT_ABSENT || shape == PEL_FRONT_RED)
        return 0;
    place at = place_on(front, level, node);
    const int32_t *v = at.topology->triangles[at.t];
    if (shape == PEL_FRONT_WHOLE) {
        triangles[0] = (pel_front_triangle){node, 0, {v[0], v[1], v[2]}};
        return 1;
    }
    int k = shape - PEL_FRONT_BISECTED, after = (k + 1) % 3, opposite = (k + 2) % 3;
    int32_t middle = pel_lod_midpoint(at.topology, 3 * at.t + k);
    triangles[0] = (pel_front_triangle){node, 0, {v[k], middle, v[opposite]}};
    triangles[1] = (pel_front_triangle){node, 1, {middle, v[after], v[opposite]}};
    return 2;
}

static void clear_leaf(pel_front *front, int32_t node)
{
    PEL_ASSERT_INDEX(node, front->node_count);
    for (int half = 1; half >= 0; half--)
        if (front->place_of_node[node][half] >= 0)
            remove_triangle(front, node, half);
}

static void set_shape(pel_front *front, int32_t node, uint8_t shape)
{
    PEL_ASSERT_INDEX(node, front->node_count);
    pel_front_triangle triangles[2];
    int count = leaf_triangles(front, pel_front_level(front, node), node, shape, triangles);
    for (int i = 0; i < count; i++)
        add_triangle(front, &triangles[i]);
    front->shapes[node] = shape;
}

static void update_place(int32_t *list, int32_t *count, int32_t *places, int32_t item, bool active)
{
    int32_t at = places[item];
    PEL_ASSERT(at < *count && (at < 0 || list[at] == item));
    if ((at >= 0) == active)
        return;
    if (active) {
        places[item] = *count;
        list[(*count)++] = item;
        return;
    }
    int32_t last = list[--(*count)];
    list[at] = last;
    places[last] = at;
    places[item] = -1;
}

static void update_edge(pel_front *front, int32_t edge, bool active)
{
    PEL_ASSERT_INDEX(edge, front->bisector_begin + front->node_count);
    update_place(front->edges, &front->edge_count, front->place_of_edge, edge, active);
}

static void update_vertex(pel_front *front, int32_t v, bool active)
{
    PEL_ASSERT_INDEX(v, front->forest->levels[front->forest->depth]->vertex_count);
    if ((front->index_in_front[v] >= 0) == active)
        return;
    if (active)
        front->added_vertices[front->added_count++] = v;
    else
        front->removed_vertices[front->removed_count++] = v;
    update_place(front->vertices, &front->vertex_count, front->index_in_front, v, active);
}

/* ---- committing ---- */

static uint8_t shape_of(const pel_front *front, const place *at)
{
    if (is_red(front, at->begin + at->t))
        return PEL_FRONT_RED;
    if (at->level > 0 && !is_red(front, front->node_begin[at->level - 1] + pel_lod_parent(at->t)))
        return PEL_FRONT_ABSENT;
    if (at->level < front->forest->depth)
        for (int k = 0; k < 3; k++)
            if (front->red_counts[edge_of(front, at, k)] > 0)
                return (uint8_t)(PEL_FRONT_BISECTED + k);
    return PEL_FRONT_WHOLE;
}

/* records a node whose shape has changed; its triangles leave the list immediately */
static void note_change(pel_front *front, int32_t level, int32_t node)
{
    PEL_ASSERT_INDEX(level, front->forest->depth + 1);
    if (node < 0)
        return;
    place at = place_on(front, level, node);
    uint8_t shape = shape_of(front, &at);
    if (shape == front->shapes[node])
        return;
    front->changes[front->change_count++] = (pel_front_change){node, front->shapes[node], shape};
    clear_leaf(front, node);
    front->shapes[node] = shape;
}

static void note_changes_about(pel_front *front, int32_t node)
{
    PEL_ASSERT_INDEX(node, front->node_count);
    int32_t level = pel_front_level(front, node);
    place at = place_on(front, level, node);
    note_change(front, level, node);
    for (int k = 0; k < 3; k++)
        note_change(front, level, neighbour(&at, k));
    for (int32_t i = 0; i < 4; i++)
        note_change(front, level + 1, front->node_begin[level + 1] + pel_lod_child(at.t, i));
}

/* an edge is active when it is not split and a triangle of its level lies next to it */
static void update_edges(pel_front *front, int32_t node, bool adding)
{
    PEL_ASSERT_INDEX(node, front->node_count);
    int32_t level = pel_front_level(front, node);
    place at = place_on(front, level, node);
    for (int k = 0; k < 3; k++) {
        int32_t edge = edge_of(front, &at, k), other = neighbour(&at, k);
        bool present =
            front->shapes[node] != PEL_FRONT_ABSENT || (other >= 0 && front->shapes[other] != PEL_FRONT_ABSENT);
        bool active = present && (level == front->forest->depth || front->red_counts[edge] == 0);
        if (active == adding)
            update_edge(front, edge, active);
    }
    bool green = pel_front_is_green(front->shapes[node]);
    if (green == adding)
        update_edge(front, front->bisector_begin + node, green);
}

static void update_vertices(pel_front *front, int32_t node)
{
    PEL_ASSERT_INDEX(node, front->node_count);
    place at = place_on(front, pel_front_level(front, node), node);
    for (int k = 0; k < 3; k++) {
        int32_t edge = edge_of(front, &at, k);
        update_vertex(front, front->forest->levels[0]->vertex_count + edge, front->red_counts[edge] > 0);
    }
}

void pel_front_commit(pel_front *front)
{
    for (int32_t c = 0; c < front->change_count; c++)
        front->old_shapes[front->changes[c].node] = front->changes[c].after;
    front->change_count = front->added_count = front->removed_count = 0;
    for (int32_t i = 0; i < front->touched_count; i++) {
        uint8_t *flags = &front->flags[front->touched[i]];
        if (((*flags & RED) != 0) != ((*flags & WAS_RED) != 0)) {
            note_changes_about(front, front->touched[i]);
            update_vertices(front, front->touched[i]);
        }
        *flags &= (uint8_t) ~(TOUCHED | WAS_RED);
    }
    front->touched_count = 0;
    /* first all that goes, then all that comes: no list grows beyond the finest level */
    for (int32_t c = 0; c < front->change_count; c++)
        update_edges(front, front->changes[c].node, false);
    for (int32_t c = 0; c < front->change_count; c++) {
        update_edges(front, front->changes[c].node, true);
        set_shape(front, front->changes[c].node, front->changes[c].after);
    }
    pel_sort_int32(front->added_vertices, front->added_count);
    pel_sort_int32(front->removed_vertices, front->removed_count);
    PEL_ASSERT(front->triangle_count == front->next_triangle_count);
}

/* ---- walking ---- */

/* the edge from the corner k of a split triangle to the middle of its edge k, and on to the next corner */
static int32_t first_half(const pel_front *front, const place *at, int k)
{
    place child = place_on(front, at->level + 1, front->node_begin[at->level + 1] + pel_lod_child(at->t, k));
    return edge_of(front, &child, 0);
}

static int32_t second_half(const pel_front *front, const place *at, int k)
{
    place child = place_on(front, at->level + 1, front->node_begin[at->level + 1] + pel_lod_child(at->t, (k + 1) % 3));
    return edge_of(front, &child, 2);
}

/* the one or two triangles of a leaf at its corner i */
static int32_t leaf_corners(const pel_front *front, const place *at, int i, pel_front_corner fan[2])
{
    int32_t node = at->begin + at->t, bisector = front->bisector_begin + node;
    int next = (i + 1) % 3, previous = (i + 2) % 3;
    const int32_t *v = at->topology->triangles[at->t];
    int k = front->shapes[node] - PEL_FRONT_BISECTED;
    fan[0] = (pel_front_corner){
        node, 0, v[next], v[previous], edge_of(front, at, i), edge_of(front, at, previous),
    };
    if (k < 0)
        return 1;
    int32_t middle = pel_lod_midpoint(at->topology, 3 * at->t + k);
    if (k == i) {
        fan[0].next = middle;
        fan[0].next_edge = first_half(front, at, k);
        return 1;
    }
    if (k == previous) {
        fan[0].half = 1;
        fan[0].previous = middle;
        fan[0].previous_edge = second_half(front, at, k);
        return 1;
    }
    fan[1] = fan[0];
    fan[0].previous = fan[1].next = middle;
    fan[0].previous_edge = fan[1].next_edge = bisector;
    fan[1].half = 1;
    return 2;
}

/* the two halves of a bisected leaf at the middle of its split edge */
static int32_t middle_corners(const pel_front *front, const place *at, pel_front_corner fan[2])
{
    int32_t node = at->begin + at->t, bisector = front->bisector_begin + node;
    int k = front->shapes[node] - PEL_FRONT_BISECTED;
    const int32_t *v = at->topology->triangles[at->t];
    int32_t begin = v[k], end = v[(k + 1) % 3], opposite = v[(k + 2) % 3];
    fan[0] = (pel_front_corner){node, 1, end, opposite, second_half(front, at, k), bisector};
    fan[1] = (pel_front_corner){node, 0, opposite, begin, bisector, first_half(front, at, k)};
    return 2;
}

/* the triangles of the surface within one triangle of the vertex's own level */
static int32_t sector_corners(const pel_front *front, int32_t level, int32_t h, pel_front_corner *fan)
{
    int32_t t = h / 3, i = h % 3;
    if (level > 0 && front->shapes[front->node_begin[level - 1] + pel_lod_parent(t)] != PEL_FRONT_RED) {
        /* three sectors lie in a bisected parent: its halves represent the first of them, whose half-edge 2 it is */
        place parent = place_on(front, level - 1, front->node_begin[level - 1] + pel_lod_parent(t));
        return t % 4 != 3 && i == 2 ? middle_corners(front, &parent, fan) : 0;
    }
    while (front->shapes[front->node_begin[level] + t] == PEL_FRONT_RED) {
        t = pel_lod_child(t, i);
        i = 0;
        level++;
    }
    place leaf = place_on(front, level, front->node_begin[level] + t);
    return leaf_corners(front, &leaf, i, fan);
}

int32_t pel_front_fan(const pel_front *front, int32_t v, pel_front_corner *fan)
{
    PEL_ASSERT_INDEX(v, front->forest->levels[front->forest->depth]->vertex_count);
    int32_t level = pel_lod_forest_vertex_level(front->forest, v), count = 0;
    const pel_topology *topology = front->forest->levels[level];
    int32_t first = topology->corner_of_vertex[v], h = first;
    while (h >= 0) {
        count += sector_corners(front, level, h, fan + count);
        h = pel_half_edge_turn(topology, h);
        if (h == first)
            break;
    }
    return count;
}

void pel_front_edge_ends(const pel_front *front, int32_t edge, int32_t ends[2])
{
    PEL_ASSERT_INDEX(edge, front->bisector_begin + front->node_count);
    const pel_lod_forest *forest = front->forest;
    int32_t level = 0;
    if (edge >= front->bisector_begin) {
        int32_t node = edge - front->bisector_begin;
        place at = place_on(front, pel_front_level(front, node), node);
        int k = front->shapes[node] - PEL_FRONT_BISECTED;
        ends[0] = pel_lod_midpoint(at.topology, 3 * at.t + k);
        ends[1] = at.topology->triangles[at.t][(k + 2) % 3];
        return;
    }
    int32_t middle = edge + forest->levels[0]->vertex_count;
    while (middle >= forest->levels[level]->vertex_count + forest->levels[level]->edge_count)
        level++;
    const pel_topology *topology = forest->levels[level];
    int32_t h = topology->half_edge_of_edge[middle - topology->vertex_count];
    ends[0] = pel_half_edge_origin(topology, h);
    ends[1] = pel_half_edge_target(topology, h);
}

static int32_t write_surface(const pel_front *front, int32_t level, int32_t t, pel_front_triangle *triangles)
{
    PEL_ASSERT_INDEX(level, front->forest->depth + 1);
    int32_t node = front->node_begin[level] + t;
    if (front->shapes[node] != PEL_FRONT_RED)
        return leaf_triangles(front, level, node, front->shapes[node], triangles);
    int32_t count = 0;
    for (int32_t i = 0; i < 4; i++)
        count += write_surface(front, level + 1, pel_lod_child(t, i), triangles + count);
    return count;
}

void pel_front_surface(const pel_front *front, pel_front_triangle *triangles)
{
    for (int32_t t = 0; t < front->forest->levels[0]->triangle_count; t++)
        triangles += write_surface(front, 0, t, triangles);
}
