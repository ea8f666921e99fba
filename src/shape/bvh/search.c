#include "bvh/search.h"

#include "base/assert.h"
#include "base/memory.h"
#include "base/status.h"

#include <stdatomic.h>
#include <string.h>

enum {
    TASK_LIMIT = 1024,        /* pairs of subtrees */
    TASK_GROWTH = 3,          /* the most that one is cut into */
    LEAF_MEMBERS = 24,        /* vertices or edges of a leaf, at most */
    LEAF_GROUPS = 4,          /* one of triangles, three of edges */
    LEAVES_AT_HAND = 16,      /* of each side of a walk, a power of two */
    LEAST_ROOM = 256,         /* pairs of a list that has any: few pairs more take no memory */
    DEPTH_LIMIT = 64,         /* of a tree: the logarithm of its leaves is below 32 */
    REPORT_INTERVAL = 1 << 14 /* pairs after which a chunk adds to the common count */
};

/* a node with the leaves below it */
typedef struct subtree {
    int32_t node, begin, end;
} subtree;

/* two subtrees whose pairs are to be found; equal ones in one tree: the pairs within */
typedef struct task {
    subtree a, b;
} task;

typedef struct search_plan {
    const pel_tree *a, *b;
    unsigned kinds;
    bool within;                   /* a and b are one surface */
    const pel_pair_growth *growth; /* null = all pairs */
    pel_pair_search *search;
    const pel_pool *pool;
    atomic_llong found; /* pairs found, for the limit */
    task tasks[TASK_LIMIT];
    int32_t task_count;
} search_plan;

/* A leaf laid out for comparisons, from the boxes of the vertices: a group of triangles, then those of its edges. */
typedef struct leaf_content {
    int32_t leaf; /* -1 = none */
    int group_count, vertex_count;
    pel_box_group groups[LEAF_GROUPS];
    /* content of the lanes: a triangle or edge, -1 = empty; and its vertices (an edge repeats the last one) */
    pel_box8_mask elements[LEAF_GROUPS], corners[LEAF_GROUPS][3];
    int32_t vertices[LEAF_MEMBERS];
} leaf_content;

/* a thread's way through its tasks */
typedef struct walk {
    search_plan *plan;
    leaf_content *at_hand[2]; /* (LEAVES_AT_HAND) of either tree: a traversal soon revisits a leaf */
    pel_pair_chunk *chunk;
    size_t dropped;  /* pairs of this chunk that search->keep turned down */
    size_t reported; /* pairs of this chunk that are in plan->found */
} walk;

/* ---- lists ---- */

void pel_pair_search_begin(pel_pair_search *search, int64_t limit)
{
    *search = (pel_pair_search){.limit = limit};
}

void pel_pair_search_clear(pel_pair_search *search)
{
    for (int chunk = 0; chunk < PEL_SEARCH_CHUNKS; chunk++)
        for (int kind = 0; kind < PEL_PAIR_KIND_COUNT; kind++)
            pel_free(search->chunks[chunk].lists[kind].pairs);
    *search = (pel_pair_search){0};
}

size_t pel_pair_search_count(const pel_pair_search *search, pel_pair_kind kind)
{
    size_t count = 0;
    for (int chunk = 0; chunk < PEL_SEARCH_CHUNKS; chunk++)
        count += search->chunks[chunk].lists[kind].count;
    return count;
}

/* Buffer for the pairs of two leaves, so that the lists grow only by pairs found. */
typedef struct leaf_pairs {
    pel_pair pairs[LEAF_MEMBERS * LEAF_MEMBERS];
    size_t count;
} leaf_pairs;

/* where the next `count` pairs can be written */
static pel_pair *make_room(pel_pair_list *list, size_t count)
{
    size_t needed = list->count + count > LEAST_ROOM ? list->count + count : LEAST_ROOM;
    if (!pel_reserve((void **)&list->pairs, &list->capacity, needed, sizeof *list->pairs))
        return NULL;
    return list->pairs + list->count;
}

/* removes pairs that the search does not keep */
static void drop_unwanted(walk *w, pel_pair_kind kind, leaf_pairs *found)
{
    const pel_pair_search *search = w->plan->search;
    size_t kept = 0;
    for (size_t i = 0; i < found->count; i++)
        if (search->keep(search->context, (int32_t)(w->chunk - search->chunks), kind, found->pairs[i]))
            found->pairs[kept++] = found->pairs[i];
    w->dropped += found->count - kept;
    found->count = kept;
}

static bool add_pairs(walk *w, pel_pair_kind kind, leaf_pairs *found)
{
    pel_pair_list *list = &w->chunk->lists[kind];
    if (w->plan->search->keep != NULL)
        drop_unwanted(w, kind, found);
    if (found->count == 0)
        return true;
    pel_pair *pairs = make_room(list, found->count);
    if (pairs == NULL)
        return false;
    memcpy(pairs, found->pairs, found->count * sizeof *pairs);
    list->count += found->count;
    return true;
}

/* adds the chunk's new pairs to the common count; false beyond the limit */
static bool report(walk *w, size_t interval)
{
    size_t count = w->dropped;
    for (int kind = 0; kind < PEL_PAIR_KIND_COUNT; kind++)
        count += w->chunk->lists[kind].count;
    if (count - w->reported < interval)
        return true;
    long long more = (long long)(count - w->reported);
    w->reported = count;
    return atomic_fetch_add(&w->plan->found, more) + more <= w->plan->search->limit;
}

/* ---- content of leaves ---- */

static void empty_group(leaf_content *content, int group)
{
    const pel_box8_mask none = {-1, -1, -1, -1, -1, -1, -1, -1};
    const pel_box empty = pel_box_empty();
    content->elements[group] = none;
    for (int k = 0; k < 3; k++) {
        content->corners[group][k] = none;
        content->groups[group].low[k] = pel_box8_splat(empty.low[0]);
        content->groups[group].high[k] = pel_box8_splat(empty.high[0]);
    }
}

static void set_lane(leaf_content *content, int place, int32_t element, const int32_t corners[3], pel_box box)
{
    int group = place / PEL_LANES, lane = place % PEL_LANES;
    content->elements[group][lane] = element;
    for (int k = 0; k < 3; k++)
        content->corners[group][k][lane] = corners[k];
    pel_box_group_set(&content->groups[group], lane, box);
}

/* the vertices and edges that belong to a triangle */
static void add_features(const pel_tree *tree, leaf_content *content, int32_t t, const pel_box boxes[3],
                         int *edge_count)
{
    PEL_ASSERT_INDEX(t, tree->triangle_count);
    const int32_t *v = tree->triangles[t];
    unsigned features = tree->features[t];
    for (int i = 0; i < 3; i++) {
        int next = i < 2 ? i + 1 : 0;
        if (features & 8u << i)
            content->vertices[content->vertex_count++] = v[i];
        if (!(features & 1u << i))
            continue;
        int place = PEL_LANES + (*edge_count)++;
        if (place % PEL_LANES == 0)
            empty_group(content, content->group_count++);
        set_lane(content, place, 3 * t + i, (const int32_t[3]){v[i], v[next], v[next]},
                 pel_box_join(boxes[i], boxes[next]));
    }
}

static void lay_out(const pel_tree *tree, int32_t leaf, leaf_content *content)
{
    PEL_ASSERT_INDEX(leaf, tree->leaf_count);
    const int32_t *triangles = tree->leaves[leaf];
    int edge_count = 0;
    content->leaf = leaf;
    content->group_count = 1;
    content->vertex_count = 0;
    empty_group(content, 0);
    for (int lane = 0; lane < PEL_LANES && triangles[lane] >= 0; lane++) {
        int32_t t = triangles[lane];
        const int32_t *v = tree->triangles[t];
        pel_box boxes[3];
        for (int i = 0; i < 3; i++)
            boxes[i] = tree->vertex_boxes[v[i]];
        set_lane(content, lane, t, v, pel_box_join(pel_box_join(boxes[0], boxes[1]), boxes[2]));
        if (tree->features != NULL)
            add_features(tree, content, t, boxes, &edge_count);
    }
}

static const leaf_content *content_of(walk *w, int side, int32_t leaf)
{
    leaf_content *content = &w->at_hand[side][leaf & (LEAVES_AT_HAND - 1)];
    if (content->leaf != leaf)
        lay_out(side == 0 ? w->plan->a : w->plan->b, leaf, content);
    return content;
}

/* ---- pairs of leaves ---- */

/* one element with its box, to be held against the lanes of the other leaf */
typedef struct probe {
    int32_t element, vertices[2];
    float low[3], high[3];
} probe;

static probe get_probe(const leaf_content *leaf, int group, int lane)
{
    const pel_box_group *boxes = &leaf->groups[group];
    return (probe){leaf->elements[group][lane],
                   {leaf->corners[group][0][lane], leaf->corners[group][1][lane]},
                   {boxes->low[0][lane], boxes->low[1][lane], boxes->low[2][lane]},
                   {boxes->high[0][lane], boxes->high[1][lane], boxes->high[2][lane]}};
}

static probe vertex_probe(int32_t v, const pel_box *box)
{
    return (probe){v, {v, v}, {box->low[0], box->low[1], box->low[2]}, {box->high[0], box->high[1], box->high[2]}};
}

/* bit i: lane i of the group overlaps */
static unsigned touching(const pel_box_group *group, const pel_box *box)
{
    return pel_box8_bits(pel_box_group_overlaps(group, (const float *)&box->low, (const float *)&box->high));
}

static unsigned touched(const pel_box_group *group, const probe *p)
{
    return pel_box8_bits(pel_box_group_overlaps(group, p->low, p->high));
}

/* bit i: lane i of the group, of edges or triangles, has one of the vertex_count vertices of the probe; most overlaps
   within a surface are such neighbours */
static unsigned neighbours(const leaf_content *leaf, int group, const probe *p, int vertex_count)
{
    pel_box8_mask shared = {0};
    for (int i = 0; i < vertex_count; i++)
        for (int corner = 0; corner < 3; corner++)
            shared |= pel_box8_equal(leaf->corners[group][corner], p->vertices[i]);
    return pel_box8_bits(shared);
}

/* takes the lowest set bit away and returns its number */
static int next_lane(unsigned *lanes)
{
    int lane = __builtin_ctz(*lanes);
    *lanes &= *lanes - 1;
    return lane;
}

/* vertices of leaf p (of tree a) against the triangles of leaf q (with this box) */
static bool vertices_with_faces(walk *w, const pel_tree *a, const leaf_content *p, const leaf_content *q,
                                const pel_box *q_box, bool swapped)
{
    leaf_pairs found;
    pel_pair *pairs = found.pairs;
    bool within = w->plan->within, face_first = swapped && !within;
    for (int i = 0; i < p->vertex_count; i++) {
        const pel_box *box = &a->vertex_boxes[p->vertices[i]];
        if (!pel_box_overlaps(box, q_box))
            continue;
        probe vertex = vertex_probe(p->vertices[i], box);
        unsigned faces = touched(&q->groups[0], &vertex);
        if (within && faces != 0)
            faces &= ~neighbours(q, 0, &vertex, 1);
        while (faces != 0) {
            int32_t t = q->elements[0][next_lane(&faces)];
            *pairs++ = face_first ? (pel_pair){t, vertex.element} : (pel_pair){vertex.element, t};
        }
    }
    found.count = (size_t)(pairs - found.pairs);
    return add_pairs(w, face_first ? PEL_PAIR_FACE_VERTEX : PEL_PAIR_VERTEX_FACE, &found);
}

static pel_pair ordered(int32_t first, int32_t second)
{
    return first < second ? (pel_pair){first, second} : (pel_pair){second, first};
}

/* lanes of group g that come after lane `lane` of group `of` */
static unsigned later_lanes(int g, int of, int lane)
{
    return g > of ? ~0u : ~0u << (lane + 1);
}

static bool edges_with_edges(walk *w, const leaf_content *p, const leaf_content *q, const pel_box *q_box)
{
    bool within = w->plan->within, same = p == q;
    leaf_pairs found;
    pel_pair *pairs = found.pairs;
    for (int g = 1; g < p->group_count; g++)
        for (unsigned lanes = touching(&p->groups[g], q_box); lanes != 0;) {
            int lane = next_lane(&lanes);
            probe edge = get_probe(p, g, lane);
            for (int h = same ? g : 1; h < q->group_count; h++) {
                unsigned others = touched(&q->groups[h], &edge) & (same ? later_lanes(h, g, lane) : ~0u);
                if (within && others != 0)
                    others &= ~neighbours(q, h, &edge, 2);
                while (others != 0) {
                    int32_t e = q->elements[h][next_lane(&others)];
                    *pairs++ = within ? ordered(edge.element, e) : (pel_pair){edge.element, e};
                }
            }
        }
    found.count = (size_t)(pairs - found.pairs);
    return add_pairs(w, PEL_PAIR_EDGE_EDGE, &found);
}

static bool faces_with_faces(walk *w, const leaf_content *p, const leaf_content *q, const pel_box *q_box)
{
    bool within = w->plan->within, same = p == q;
    leaf_pairs found;
    pel_pair *pairs = found.pairs;
    for (unsigned lanes = touching(&p->groups[0], q_box); lanes != 0;) {
        int lane = next_lane(&lanes);
        probe face = get_probe(p, 0, lane);
        unsigned others = touched(&q->groups[0], &face) & (same ? later_lanes(0, 0, lane) : ~0u);
        while (others != 0) {
            int32_t t = q->elements[0][next_lane(&others)];
            *pairs++ = within ? ordered(face.element, t) : (pel_pair){face.element, t};
        }
    }
    found.count = (size_t)(pairs - found.pairs);
    return add_pairs(w, PEL_PAIR_FACE_FACE, &found);
}

static bool overlapped_before(const search_plan *plan, pel_pair_kind kind, pel_pair pair)
{
    const pel_tree *tree = plan->a;
    const pel_box *before = plan->growth->before;
    bool edges = kind == PEL_PAIR_EDGE_EDGE;
    pel_box a = edges ? pel_tree_edge_box(tree, before, pair.first) : before[pair.first];
    pel_box b = edges ? pel_tree_edge_box(tree, before, pair.second) : pel_tree_triangle_box(tree, before, pair.second);
    return pel_box_overlaps(&a, &b);
}

/* removes from the pairs from `begin` on those that are already listed */
static void drop_known(const search_plan *plan, pel_pair_kind kind, pel_pair_list *list, size_t begin)
{
    size_t kept = begin;
    for (size_t i = begin; i < list->count; i++) {
        list->pairs[kept] = list->pairs[i];
        kept += !overlapped_before(plan, kind, list->pairs[i]);
    }
    list->count = kept;
}

/* all pairs of two leaves */
static bool find_pairs(walk *w, const task *t)
{
    const search_plan *plan = w->plan;
    const pel_tree *a = plan->a, *b = plan->b;
    bool same = plan->within && t->a.begin == t->b.begin, fine = true;
    const leaf_content *p = content_of(w, 0, t->a.begin), *q = same ? p : content_of(w, 1, t->b.begin);
    const pel_box *p_box = &a->nodes[t->a.node], *q_box = &b->nodes[t->b.node];
    if (plan->kinds & 1u << PEL_PAIR_VERTEX_FACE)
        fine = vertices_with_faces(w, a, p, q, q_box, false);
    if (fine && plan->kinds & 1u << PEL_PAIR_FACE_VERTEX && !same)
        fine = vertices_with_faces(w, b, q, p, p_box, true);
    if (fine && plan->kinds & 1u << PEL_PAIR_EDGE_EDGE)
        fine = edges_with_edges(w, p, q, q_box);
    if (fine && plan->kinds & 1u << PEL_PAIR_FACE_FACE)
        fine = faces_with_faces(w, p, q, q_box);
    return fine;
}

static bool search_leaves(walk *w, const task *t)
{
    static const pel_pair_kind kinds[] = {PEL_PAIR_VERTEX_FACE, PEL_PAIR_EDGE_EDGE};
    size_t before[2];
    for (int i = 0; i < 2; i++)
        before[i] = w->chunk->lists[kinds[i]].count;
    bool fine = find_pairs(w, t);
    for (int i = 0; i < 2 && fine && w->plan->growth != NULL; i++)
        drop_known(w->plan, kinds[i], &w->chunk->lists[kinds[i]], before[i]);
    if (!fine)
        w->chunk->status = PEL_OUT_OF_MEMORY;
    else if (!report(w, REPORT_INTERVAL))
        w->chunk->status = PEL_BAD_ARGUMENT;
    return w->chunk->status == PEL_OK;
}

/* ---- pairs of subtrees ---- */

static subtree whole_tree(const pel_tree *tree)
{
    return (subtree){0, 0, tree->leaf_count};
}

static bool is_leaf(subtree s)
{
    return s.end - s.begin == 1;
}

static subtree left_of(subtree s)
{
    return (subtree){s.node + 1, s.begin, pel_tree_middle(s.begin, s.end)};
}

static subtree right_of(subtree s)
{
    int32_t middle = pel_tree_middle(s.begin, s.end);
    return (subtree){s.node + 2 * (middle - s.begin), middle, s.end};
}

static bool is_single(const search_plan *plan, const task *t)
{
    return plan->within && t->a.node == t->b.node;
}

static bool is_cut_up(const task *t)
{
    return is_leaf(t->a) && is_leaf(t->b);
}

static bool may_touch(const search_plan *plan, const task *t)
{
    const uint8_t *marks = plan->growth != NULL ? plan->growth->node_grew : plan->search->marks;
    if (marks != NULL && !marks[t->a.node] && !marks[t->b.node])
        return false;
    if (!pel_tree_nodes_may_meet(plan->a, t->a.node, plan->b, t->b.node))
        return false;
    return is_single(plan, t) || pel_box_overlaps(&plan->a->nodes[t->a.node], &plan->b->nodes[t->b.node]);
}

/* the parts of a task (at least one side is no leaf) that may hold pairs, in order; returns how many */
static int cut(const search_plan *plan, const task *t, task parts[TASK_GROWTH])
{
    int count = 0;
    if (is_single(plan, t)) {
        subtree left = left_of(t->a), right = right_of(t->a);
        const task inner[TASK_GROWTH] = {{left, left}, {left, right}, {right, right}};
        for (int i = 0; i < TASK_GROWTH; i++) {
            parts[count] = inner[i];
            count += may_touch(plan, &inner[i]);
        }
        return count;
    }
    bool cut_a = t->a.end - t->a.begin >= t->b.end - t->b.begin;
    parts[count] = cut_a ? (task){left_of(t->a), t->b} : (task){t->a, left_of(t->b)};
    count += may_touch(plan, &parts[count]);
    parts[count] = cut_a ? (task){right_of(t->a), t->b} : (task){t->a, right_of(t->b)};
    count += may_touch(plan, &parts[count]);
    return count;
}

static bool search_task(walk *w, const task *whole)
{
    task stack[2 * DEPTH_LIMIT * TASK_GROWTH];
    int depth = 0;
    stack[depth++] = *whole;
    while (depth > 0) {
        task t = stack[--depth], parts[TASK_GROWTH];
        if (is_cut_up(&t)) {
            if (!search_leaves(w, &t))
                return false;
            continue;
        }
        for (int i = cut(w->plan, &t, parts); i > 0; i--)
            stack[depth++] = parts[i - 1];
    }
    return true;
}

/* cuts all tasks once, keeping their order; false when there is nothing left to cut, or no room */
static bool cut_tasks(search_plan *plan)
{
    if (plan->task_count * TASK_GROWTH > TASK_LIMIT)
        return false;
    task old[TASK_LIMIT / TASK_GROWTH + 1];
    int32_t old_count = plan->task_count, cut_count = 0;
    for (int32_t i = 0; i < old_count; i++)
        old[i] = plan->tasks[i];
    plan->task_count = 0;
    for (int32_t i = 0; i < old_count; i++) {
        if (is_cut_up(&old[i])) {
            plan->tasks[plan->task_count++] = old[i];
            continue;
        }
        plan->task_count += cut(plan, &old[i], &plan->tasks[plan->task_count]);
        cut_count++;
    }
    return cut_count > 0;
}

static void search_chunk(void *context, int32_t chunk)
{
    search_plan *plan = context;
    leaf_content at_hand[2][LEAVES_AT_HAND];
    walk w = {plan, {at_hand[0], at_hand[1]}, &plan->search->chunks[chunk], 0, 0};
    for (int i = 0; i < 2 * LEAVES_AT_HAND; i++)
        at_hand[i / LEAVES_AT_HAND][i % LEAVES_AT_HAND].leaf = -1;
    for (int kind = 0; kind < PEL_PAIR_KIND_COUNT; kind++)
        w.chunk->lists[kind].count = plan->growth != NULL ? w.chunk->lists[kind].count : 0;
    w.chunk->status = pel_pool_is_stopped(plan->pool) ? PEL_STOPPED : PEL_OK;
    if (w.chunk->status != PEL_OK)
        return;
    int64_t count = plan->task_count;
    int32_t begin = (int32_t)(count * chunk / PEL_SEARCH_CHUNKS);
    int32_t end = (int32_t)(count * (chunk + 1) / PEL_SEARCH_CHUNKS);
    for (int32_t i = begin; i < end; i++)
        if (!search_task(&w, &plan->tasks[i]))
            return;
    if (!report(&w, 1))
        w.chunk->status = PEL_BAD_ARGUMENT;
}

pel_status pel_pairs_refuse(int64_t limit, pel_error *error)
{
    return pel_refuse(error, PEL_BAD_ARGUMENT, "use a smaller dt, or a larger memory_limit",
                      "more than %lld pairs come near each other in a step: the memory limit is reached",
                      (long long)limit);
}

static pel_status run_search(search_plan *plan, pel_pool *pool, pel_error *error)
{
    pel_pair_search *search = plan->search;
    plan->pool = pool;
    if (plan->within && plan->kinds & 1u << PEL_PAIR_VERTEX_FACE)
        plan->kinds |= 1u << PEL_PAIR_FACE_VERTEX; /* both go into one list */
    plan->tasks[0] = (task){whole_tree(plan->a), whole_tree(plan->b)};
    plan->task_count = 1;
    while (cut_tasks(plan))
        ;
    pel_pool_run(pool, PEL_SEARCH_CHUNKS, search_chunk, plan);
    pel_status status = PEL_OK;
    for (int chunk = 0; chunk < PEL_SEARCH_CHUNKS && status != PEL_OUT_OF_MEMORY; chunk++)
        status = search->chunks[chunk].status != PEL_OK ? search->chunks[chunk].status : status;
    if (status == PEL_OUT_OF_MEMORY)
        return pel_fail_memory(error);
    if (status == PEL_STOPPED)
        return pel_pool_check(pool, error);
    return status == PEL_OK ? PEL_OK : pel_pairs_refuse(search->limit, error);
}

pel_status pel_find_pairs(const pel_tree *first, const pel_tree *second, unsigned kinds, pel_pool *pool,
                          pel_pair_search *search, pel_error *error)
{
    search_plan plan = {.a = first, .b = second, .kinds = kinds, .within = first == second, .search = search};
    return run_search(&plan, pool, error);
}

pel_status pel_find_new_pairs(const pel_tree *tree, unsigned kinds, const pel_pair_growth *growth, pel_pool *pool,
                              pel_pair_search *search, pel_error *error)
{
    search_plan plan = {.a = tree, .b = tree, .kinds = kinds, .within = true, .growth = growth, .search = search};
    return run_search(&plan, pool, error);
}

/* ---- box ---- */

static bool add_leaf(const pel_tree *tree, int32_t leaf, const pel_box *box, pel_element_list *list)
{
    PEL_ASSERT_INDEX(leaf, tree->leaf_count);
    const int32_t *triangles = tree->leaves[leaf];
    if (!pel_reserve((void **)&list->elements, &list->capacity, list->count + PEL_LANES, sizeof *list->elements))
        return false;
    for (int lane = 0; lane < PEL_LANES && triangles[lane] >= 0; lane++) {
        pel_box own = pel_tree_triangle_box(tree, tree->vertex_boxes, triangles[lane]);
        if (pel_box_overlaps(&own, box))
            list->elements[list->count++] = triangles[lane];
    }
    return true;
}

pel_status pel_find_in_box(const pel_tree *tree, const pel_box *box, pel_element_list *list, pel_error *error)
{
    subtree stack[DEPTH_LIMIT];
    int depth = 0;
    list->count = 0;
    stack[depth++] = whole_tree(tree);
    while (depth > 0) {
        subtree s = stack[--depth];
        if (!pel_box_overlaps(&tree->nodes[s.node], box))
            continue;
        if (is_leaf(s)) {
            if (!add_leaf(tree, s.begin, box, list))
                return pel_fail_memory(error);
            continue;
        }
        stack[depth++] = right_of(s);
        stack[depth++] = left_of(s);
    }
    return PEL_OK;
}
