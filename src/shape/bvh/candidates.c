#include "bvh/candidates.h"

#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "pellicle/geometry.h"

#include <string.h>

/* rebuild the tree when the area of its boxes has grown by this factor */
static const double cost_growth = 1.3;
/* growth of a kept box on every side, relative to the displacement of its vertex */
static const float way_share = 1;
/* vertices that left their boxes, as a part of all: up to this it pays to search there only */
static const double few_left = 0.2;
/* limit of kept pairs, relative to the pairs of the last search of the whole tree */
static const double pair_growth = 1.5;
/* pairs are kept no longer if they are more than this times those that overlap, and LIST_ROOM of each vertex: they were
   found for a long way, and the ways of the parts of a divided step are short */
static const double waste = 16;
enum { LIST_ROOM = 4 };
/* updates that kept pairs must serve to be worth it, and the longest pause without; vertices of one chunk */
enum { WORTH_KEEPING = 2, PAUSE_LIMIT = 32, VERTICES_PER_CHUNK = 2048 };
static const unsigned both_kinds = 1u << PEL_PAIR_VERTEX_FACE | 1u << PEL_PAIR_EDGE_EDGE;

/* ---- creation ---- */

static pel_status allocate_boxes(pel_candidates *c)
{
    const pel_tree *tree = c->tree;
    size_t vertex_count = (size_t)tree->vertex_count;
    bool made =
        PEL_ALLOCATE_ALL(PEL_ROOM_ALIGNED(c->vertex_boxes, vertex_count), PEL_ROOM_ALIGNED(c->kept_boxes, vertex_count),
                         PEL_ROOM(c->left, vertex_count), PEL_ROOM(c->node_grew, tree->node_count),
                         PEL_ROOM(c->kept_places, pel_frame_sample_count(tree->vertex_count)));
    return made ? PEL_OK : PEL_OUT_OF_MEMORY;
}

pel_status pel_candidates_create(const double (*positions)[3], int32_t vertex_count, const int32_t (*triangles)[3],
                                 int32_t triangle_count, double margin, int64_t limit, pel_candidates **candidates,
                                 pel_error *error)
{
    *candidates = NULL;
    pel_candidates *c = pel_allocate(1, sizeof *c);
    if (c == NULL)
        return pel_fail_memory(error);
    c->margin = margin;
    pel_pair_search_begin(&c->search, limit);
    pel_status status =
        pel_tree_create(positions, vertex_count, triangles, triangle_count, PEL_TREE_FEATURES, &c->tree, error);
    if (status == PEL_OK && allocate_boxes(c) != PEL_OK)
        status = pel_fail_memory(error);
    if (status == PEL_OK)
        *candidates = c;
    else
        pel_candidates_destroy(c);
    return status;
}

/* ---- groups ---- */

static bool may_meet(const pel_candidates *c, pel_pair_kind kind, pel_pair pair)
{
    const pel_collision_groups *groups = &c->tree->groups;
    bool edges = kind == PEL_PAIR_EDGE_EDGE;
    int32_t first = edges ? pel_tree_corner(c->tree, pair.first) : pair.first;
    int32_t second = edges ? pel_tree_corner(c->tree, pair.second) : c->tree->triangles[pair.second][0];
    int32_t a = groups->group_of_vertex[first], b = groups->group_of_vertex[second];
    return groups->may_meet[a * groups->group_count + b] && (c->sought == NULL || c->sought[a] || c->sought[b]);
}

static bool keep_meeting(void *context, int32_t chunk, pel_pair_kind kind, pel_pair pair)
{
    (void)chunk;
    return may_meet(context, kind, pair);
}

/* the searches list only pairs that may meet: a rigid tool of fine triangles would have millions of others */
static void keep_of_groups(pel_candidates *c)
{
    c->search.keep = c->tree->groups.group_of_vertex != NULL ? keep_meeting : NULL;
    c->search.context = c;
}

pel_status pel_candidates_use_groups(pel_candidates *c, const pel_collision_groups *groups,
                                     const double (*positions)[3])
{
    pel_collision_groups others = c->groups = *groups;
    c->has_kept = false;
    pel_hulls_destroy(c->hulls);
    if (groups->shape != NULL)
        positions = groups->shape;
    pel_status status = pel_hulls_create(c->tree, positions, groups, &c->hulls);
    if (c->hulls != NULL)
        others.may_meet = c->hulls->may_meet;
    if (status == PEL_OK)
        status = pel_tree_use_groups(c->tree, &others);
    keep_of_groups(c);
    return status;
}

void pel_candidates_destroy(pel_candidates *c)
{
    if (c == NULL)
        return;
    pel_hulls_destroy(c->hulls);
    pel_tree_destroy(c->tree);
    pel_pair_search_clear(&c->search);
    PEL_FREE_ALL(c->vertex_face, c->edge_edge, c->vertex_boxes, c->overlaps, c->kept_boxes, c->left, c->node_grew,
                 c->kept_places, c);
}

/* ---- search ---- */

/* whether this search is to be done with the margin */
static bool choose_margin(pel_candidates *c)
{
    if (c->has_kept && c->kept_uses < WORTH_KEEPING) {
        c->pause_length = c->pause_length == 0 ? 2 : 2 * c->pause_length;
        c->pause_length = c->pause_length < PAUSE_LIMIT ? c->pause_length : PAUSE_LIMIT;
        c->pause = c->pause_length;
    } else if (c->has_kept) {
        c->pause_length = 0;
    }
    if (c->pause > 0) {
        c->pause--;
        return false;
    }
    return c->margin > 0;
}

/* fits the tree, or rebuilds it when it has degraded */
static void fit_tree(pel_candidates *c, const pel_motion *motion, const pel_box *boxes, pel_pool *pool)
{
    pel_tree_refit(c->tree, boxes, pool);
    if (!c->tree->is_stale && pel_tree_cost(c->tree) <= cost_growth * c->tree->built_cost)
        return;
    pel_tree_rebuild(c->tree, motion->start);
    pel_tree_refit(c->tree, boxes, pool);
    c->counts.rebuilds++;
}

/* the box of a vertex with room for its motion in the next steps */
static pel_box roomy_box(const pel_candidates *c, int32_t v)
{
    const pel_box *box = &c->vertex_boxes[v];
    const float margin = (float)(0.5 * c->margin);
    pel_corner more = way_share * (box->high - box->low) + (pel_corner){margin, margin, margin, 0};
    return (pel_box){box->low - more, box->high + more};
}

static size_t found_count(const pel_candidates *c)
{
    return pel_pair_search_count(&c->search, PEL_PAIR_VERTEX_FACE) +
           pel_pair_search_count(&c->search, PEL_PAIR_EDGE_EDGE);
}

static pel_status search_boxes(pel_candidates *c, const pel_motion *motion, const pel_box *boxes, pel_pool *pool,
                               pel_error *error)
{
    fit_tree(c, motion, boxes, pool);
    c->counts.searches++;
    return pel_find_pairs(c->tree, c->tree, both_kinds, pool, &c->search, error);
}

/* Repeats a search with a margin that exceeds the limit without one. */
static pel_status search_tree(pel_candidates *c, const pel_frame *frame, const pel_motion *motion, pel_pool *pool,
                              pel_error *error)
{
    bool with_margin = choose_margin(c);
    c->has_kept = false;
    for (int32_t v = 0; with_margin && v < c->tree->vertex_count; v++)
        c->kept_boxes[v] = roomy_box(c, v);
    pel_status status = search_boxes(c, motion, with_margin ? c->kept_boxes : c->vertex_boxes, pool, error);
    if (status == PEL_BAD_ARGUMENT && with_margin) {
        with_margin = false;
        c->pause = c->pause_length = PAUSE_LIMIT;
        status = search_boxes(c, motion, c->vertex_boxes, pool, error);
    }
    if (status == PEL_OK && with_margin) {
        pel_frame_sample(frame, motion, c->kept_places);
        c->kept_uses = 0;
        c->kept_limit = (size_t)(pair_growth * (double)found_count(c)) + (size_t)c->tree->vertex_count;
        c->has_kept = true;
    }
    return status;
}

/* Gives room to the vertices that left their boxes and adds the pairs that this brings. Boxes only grow, so that a pair
   is on the list exactly when its boxes overlap. The boxes of the update make place for those before. */
static pel_status extend_kept(pel_candidates *c, pel_pool *pool, pel_error *error)
{
    const pel_pair_growth growth = {c->node_grew, c->vertex_boxes};
    for (int32_t v = 0; v < c->tree->vertex_count; v++) {
        pel_box before = c->kept_boxes[v];
        if (c->left[v])
            c->kept_boxes[v] = pel_box_join(before, roomy_box(c, v));
        c->vertex_boxes[v] = before;
    }
    pel_tree_refit_changed(c->tree, c->left, c->node_grew);
    c->counts.extensions++;
    return pel_find_new_pairs(c->tree, both_kinds, &growth, pool, &c->search, error);
}

/* ---- candidates among the pairs that were found ---- */

/* One kind of pairs. A first pass marks those whose boxes overlap by a bit, a second one copies them: most that are
   kept do not, so that a list with room for all would be much longer. */
typedef struct sieve {
    pel_candidates *c;
    pel_pair_kind kind;
    pel_pair *pairs;                                               /* the remaining pairs, chunk after chunk */
    size_t word[PEL_SEARCH_CHUNKS], offset[PEL_SEARCH_CHUNKS + 1]; /* of each chunk, in the bits and the pairs */
} sieve;

static size_t word_count(const pel_pair_list *list)
{
    return (list->count + 63) / 64;
}

static bool overlap_now(const pel_candidates *c, pel_pair_kind kind, pel_pair pair)
{
    const pel_box *boxes = c->vertex_boxes;
    bool edges = kind == PEL_PAIR_EDGE_EDGE;
    pel_box a = edges ? pel_tree_edge_box(c->tree, boxes, pair.first) : boxes[pair.first];
    pel_box b =
        edges ? pel_tree_edge_box(c->tree, boxes, pair.second) : pel_tree_triangle_box(c->tree, boxes, pair.second);
    return pel_box_overlaps(&a, &b);
}

static void mark_overlaps(void *context, int32_t chunk)
{
    sieve *s = context;
    const pel_pair_list *list = &s->c->search.chunks[chunk].lists[s->kind];
    uint64_t *words = s->c->overlaps + s->word[chunk];
    size_t count = 0;
    for (size_t begin = 0; begin < list->count; begin += 64) {
        size_t end = begin + 64 < list->count ? begin + 64 : list->count;
        uint64_t word = 0;
        for (size_t i = begin; i < end; i++)
            word |= (uint64_t)overlap_now(s->c, s->kind, list->pairs[i]) << (i - begin);
        words[begin / 64] = word;
        count += (size_t)__builtin_popcountll(word);
    }
    s->offset[chunk + 1] = count;
}

static void copy_overlaps(void *context, int32_t chunk)
{
    sieve *s = context;
    const pel_pair_list *list = &s->c->search.chunks[chunk].lists[s->kind];
    const uint64_t *words = s->c->overlaps + s->word[chunk];
    pel_pair *out = s->pairs + s->offset[chunk];
    for (size_t w = 0; w < word_count(list); w++)
        for (uint64_t word = words[w]; word != 0; word &= word - 1)
            *out++ = list->pairs[64 * w + (size_t)__builtin_ctzll(word)];
}

static pel_status sieve_pairs(pel_candidates *c, pel_pair_kind kind, pel_pool *pool, pel_pair **pairs, size_t *count,
                              size_t *capacity)
{
    sieve s = {.c = c, .kind = kind};
    size_t words = 0;
    for (int chunk = 0; chunk < PEL_SEARCH_CHUNKS; chunk++) {
        s.word[chunk] = words;
        words += word_count(&c->search.chunks[chunk].lists[kind]);
    }
    c->counts.kept += (int64_t)pel_pair_search_count(&c->search, kind);
    if (!pel_reserve((void **)&c->overlaps, &c->overlap_capacity, words, sizeof *c->overlaps))
        return PEL_OUT_OF_MEMORY;
    if (words == 0)
        return PEL_OK;
    pel_pool_run(pool, PEL_SEARCH_CHUNKS, mark_overlaps, &s);
    for (int chunk = 0; chunk < PEL_SEARCH_CHUNKS; chunk++)
        s.offset[chunk + 1] += s.offset[chunk];
    *count = s.offset[PEL_SEARCH_CHUNKS];
    if (*count == 0)
        return PEL_OK;
    if (!pel_reserve((void **)pairs, capacity, *count, sizeof **pairs))
        return PEL_OUT_OF_MEMORY;
    s.pairs = *pairs;
    pel_pool_run(pool, PEL_SEARCH_CHUNKS, copy_overlaps, &s);
    return PEL_OK;
}

static pel_status sieve_all(pel_candidates *c, pel_pool *pool, pel_error *error)
{
    c->counts.kept = 0;
    if (sieve_pairs(c, PEL_PAIR_VERTEX_FACE, pool, &c->vertex_face, &c->vertex_face_count, &c->vertex_face_capacity) !=
            PEL_OK ||
        sieve_pairs(c, PEL_PAIR_EDGE_EDGE, pool, &c->edge_edge, &c->edge_edge_count, &c->edge_edge_capacity) != PEL_OK)
        return pel_fail_memory(error);
    double overlaps = (double)(c->vertex_face_count + c->edge_edge_count);
    c->has_kept &= (double)c->counts.kept <= waste * (overlaps + LIST_ROOM * (double)c->tree->vertex_count);
    return PEL_OK;
}

/* ---- update ---- */

static pel_status make_boxes(pel_candidates *c, const pel_frame *frame, const pel_motion *motion, double thickness,
                             pel_pool *pool, pel_error *error)
{
    int32_t bad = pel_boxes_of_motion(frame, motion, thickness, pool, c->vertex_boxes);
    if (bad < 0)
        return PEL_OK;
    pel_fail(error, PEL_BAD_ARGUMENT, "the position of a vertex is not finite");
    pel_fail_element(error, "vertex", bad);
    return PEL_BAD_ARGUMENT;
}

static int32_t chunk_count(const pel_candidates *c)
{
    return (c->tree->vertex_count + VERTICES_PER_CHUNK - 1) / VERTICES_PER_CHUNK;
}

static void mark_chunk(void *context, int32_t chunk)
{
    pel_candidates *c = context;
    int32_t begin = chunk * VERTICES_PER_CHUNK, end = begin + VERTICES_PER_CHUNK;
    for (int32_t v = begin; v < end && v < c->tree->vertex_count; v++)
        c->left[v] = !pel_box_contains(&c->kept_boxes[v], &c->vertex_boxes[v]);
}

/* marks the vertices that are not in their boxes any more; returns how many */
static int32_t mark_left(pel_candidates *c, pel_pool *pool)
{
    int32_t count = 0;
    pel_pool_run(pool, chunk_count(c), mark_chunk, c);
    for (int32_t v = 0; v < c->tree->vertex_count; v++)
        count += c->left[v];
    return count;
}

/* whether the kept pairs, possibly extended, serve this update too; false = search the tree */
static pel_status use_kept(pel_candidates *c, const pel_frame *frame, const pel_motion *motion, double thickness,
                           pel_pool *pool, bool *serves, pel_error *error)
{
    int32_t left = mark_left(c, pool);
    pel_status status = PEL_OK;
    *serves = left == 0;
    if (left > 0 && left <= few_left * c->tree->vertex_count && found_count(c) <= c->kept_limit) {
        status = extend_kept(c, pool, error);
        *serves = status == PEL_OK;
        if (status == PEL_OK)
            status = make_boxes(c, frame, motion, thickness, pool, error);
    }
    c->kept_uses += *serves;
    return status == PEL_BAD_ARGUMENT ? PEL_OK : status;
}

/* Adds the pairs of hulls to the lists: those of which one is of groups, null = all. */
static pel_status add_hulls(pel_candidates *c, const pel_motion *motion, double reach, const uint8_t *groups,
                            pel_pool *pool, pel_pair_list *const lists[2], pel_error *error)
{
    if (c->hulls == NULL)
        return PEL_OK;
    return pel_hulls_find(c->hulls, motion, reach, groups, c->search.limit, pool, lists, error);
}

/* whether pairs may be elsewhere than between hulls */
static bool needs_tree(const pel_candidates *c)
{
    return c->hulls == NULL || !c->hulls->are_all;
}

static pel_status update(pel_candidates *c, const pel_motion *motion, double thickness, pel_pool *pool,
                         pel_error *error)
{
    pel_frame frame;
    pel_status status;
    if (!needs_tree(c))
        return PEL_OK;
    if (c->has_kept) {
        bool serves = false;
        frame = pel_frame_follow(motion, (const double(*)[3])c->kept_places);
        status = make_boxes(c, &frame, motion, thickness, pool, error);
        if (status == PEL_OK)
            status = use_kept(c, &frame, motion, thickness, pool, &serves, error);
        if (status != PEL_OK || serves)
            return status == PEL_OK ? sieve_all(c, pool, error) : status;
    }
    frame = pel_frame_centre(motion);
    status = make_boxes(c, &frame, motion, thickness, pool, error);
    if (status == PEL_OK)
        status = search_tree(c, &frame, motion, pool, error);
    return status == PEL_OK ? sieve_all(c, pool, error) : status;
}

pel_status pel_candidates_update(pel_candidates *c, const double (*start)[3], const double (*end)[3], double thickness,
                                 pel_pool *pool, pel_error *error)
{
    pel_motion motion = {start, end, c->tree->vertex_count};
    c->vertex_face_count = c->edge_edge_count = 0;
    c->counts.updates++;
    pel_status status = update(c, &motion, thickness, pool, error);
    pel_pair_list vertex_face = {c->vertex_face, c->vertex_face_count, c->vertex_face_capacity};
    pel_pair_list edge_edge = {c->edge_edge, c->edge_edge_count, c->edge_edge_capacity};
    if (status == PEL_OK)
        status = add_hulls(c, &motion, thickness, NULL, pool, (pel_pair_list *[2]){&vertex_face, &edge_edge}, error);
    c->vertex_face = vertex_face.pairs;
    c->vertex_face_count = vertex_face.count;
    c->vertex_face_capacity = vertex_face.capacity;
    c->edge_edge = edge_edge.pairs;
    c->edge_edge_count = edge_edge.count;
    c->edge_edge_capacity = edge_edge.capacity;
    if (status != PEL_OK) {
        c->has_kept = false;
        c->vertex_face_count = c->edge_edge_count = 0;
    }
    return status;
}

/* ---- pairs by their distance ---- */

typedef struct near_pairs {
    const pel_candidates *c;
    const double (*positions)[3];
    double square; /* of the reach */
} near_pairs;

static bool is_near(const near_pairs *near, pel_pair_kind kind, pel_pair pair)
{
    const pel_tree *tree = near->c->tree;
    const double(*x)[3] = near->positions;
    double weights[4], square;
    if (kind == PEL_PAIR_EDGE_EDGE) {
        int32_t a[2], b[2];
        pel_tree_edge_ends(tree, pair.first, a);
        pel_tree_edge_ends(tree, pair.second, b);
        square = pel_closest_segment_segment(x[a[0]], x[a[1]], x[b[0]], x[b[1]], weights);
    } else {
        const int32_t *t = tree->triangles[pair.second];
        square = pel_closest_point_triangle(x[pair.first], x[t[0]], x[t[1]], x[t[2]], weights);
    }
    return !(square > near->square);
}

static bool keep_near(void *context, int32_t chunk, pel_pair_kind kind, pel_pair pair)
{
    const near_pairs *near = context;
    (void)chunk;
    bool meet = near->c->tree->groups.group_of_vertex == NULL || may_meet(near->c, kind, pair);
    return meet && is_near(near, kind, pair);
}

/* drops pairs of a list from `begin` on that are not near */
static void drop_others(const near_pairs *near, pel_pair_kind kind, size_t begin, pel_pair_list *list)
{
    size_t kept = begin;
    for (size_t i = begin; i < list->count; i++)
        if (is_near(near, kind, list->pairs[i]))
            list->pairs[kept++] = list->pairs[i];
    list->count = kept;
}

/* all pairs of one kind that the search has found */
static pel_status list_found(const pel_candidates *c, pel_pair_kind kind, pel_pair_list *list, pel_error *error)
{
    list->count = 0;
    if (!pel_reserve((void **)&list->pairs, &list->capacity, pel_pair_search_count(&c->search, kind),
                     sizeof *list->pairs))
        return pel_fail_memory(error);
    for (int chunk = 0; chunk < PEL_SEARCH_CHUNKS; chunk++) {
        const pel_pair_list *found = &c->search.chunks[chunk].lists[kind];
        if (found->count > 0)
            memcpy(list->pairs + list->count, found->pairs, found->count * sizeof *found->pairs);
        list->count += found->count;
    }
    return PEL_OK;
}

/* pairs by the tree alone, without kept ones: those that the search keeps, of which one is of groups */
static pel_status seek(pel_candidates *c, const pel_motion *motion, double reach, const uint8_t *groups, pel_pool *pool,
                       pel_pair_list *const lists[2], pel_error *error)
{
    pel_frame frame = pel_frame_centre(motion);
    c->has_kept = false;
    c->vertex_face_count = c->edge_edge_count = lists[0]->count = lists[1]->count = 0;
    c->counts.updates++;
    if (!needs_tree(c))
        return PEL_OK;
    pel_status status = make_boxes(c, &frame, motion, reach, pool, error);
    if (status != PEL_OK)
        return status;
    if (groups != NULL)
        pel_tree_mark_groups(c->tree, groups, c->node_grew);
    c->sought = groups;
    c->search.marks = groups != NULL ? c->node_grew : NULL;
    status = search_boxes(c, motion, c->vertex_boxes, pool, error);
    c->sought = c->search.marks = NULL;
    if (status == PEL_OK)
        status = list_found(c, PEL_PAIR_VERTEX_FACE, lists[0], error);
    return status == PEL_OK ? list_found(c, PEL_PAIR_EDGE_EDGE, lists[1], error) : status;
}

pel_status pel_candidates_near(pel_candidates *c, const double (*positions)[3], double reach, pel_pool *pool,
                               pel_pair_list *vertex_face, pel_pair_list *edge_edge, pel_error *error)
{
    pel_pair_list *const lists[2] = {vertex_face, edge_edge};
    pel_motion motion = {positions, positions, c->tree->vertex_count};
    near_pairs near = {c, positions, reach * reach};
    c->search.keep = keep_near;
    c->search.context = &near;
    pel_status status = seek(c, &motion, reach, NULL, pool, lists, error);
    keep_of_groups(c);
    size_t counts[2] = {vertex_face->count, edge_edge->count};
    if (status == PEL_OK)
        status = add_hulls(c, &motion, reach, NULL, pool, lists, error);
    drop_others(&near, PEL_PAIR_VERTEX_FACE, counts[0], vertex_face);
    drop_others(&near, PEL_PAIR_EDGE_EDGE, counts[1], edge_edge);
    c->counts.kept = (int64_t)(vertex_face->count + edge_edge->count);
    return status;
}

pel_status pel_candidates_seek(pel_candidates *c, const double (*start)[3], const double (*end)[3], double thickness,
                               const uint8_t *groups, pel_pool *pool, pel_pair_list *vertex_face,
                               pel_pair_list *edge_edge, pel_error *error)
{
    pel_pair_list *const lists[2] = {vertex_face, edge_edge};
    pel_motion motion = {start, end, c->tree->vertex_count};
    pel_status status = seek(c, &motion, thickness, groups, pool, lists, error);
    return status == PEL_OK ? add_hulls(c, &motion, thickness, groups, pool, lists, error) : status;
}

/* ---- memory ---- */

void pel_candidates_memory(pel_candidates *c, pel_memory_part parts[PEL_CANDIDATES_PARTS])
{
    size_t vertex_count = (size_t)c->tree->vertex_count;
    const pel_memory_part all[PEL_CANDIDATES_PARTS] = {
        {&c->margin, sizeof c->margin},
        {&c->kept_limit, sizeof c->kept_limit},
        {&c->has_kept, sizeof c->has_kept},
        {&c->kept_uses, sizeof c->kept_uses},
        {&c->pause, sizeof c->pause},
        {&c->pause_length, sizeof c->pause_length},
        {c->kept_boxes, vertex_count * sizeof *c->kept_boxes},
        {c->kept_places, (size_t)pel_frame_sample_count(c->tree->vertex_count) * sizeof *c->kept_places},
    };
    memcpy(parts, all, sizeof all);
}

pel_status pel_candidates_recall(pel_candidates *c, pel_pool *pool, pel_error *error)
{
    unsigned char kept;
    memcpy(&kept, &c->has_kept, 1);
    bool is_whole = kept <= 1 && c->margin >= 0 && c->kept_uses >= 0 && c->kept_uses <= INT32_MAX / 2 &&
                    c->pause >= 0 && c->pause <= PAUSE_LIMIT && c->pause_length >= 0 && c->pause_length <= PAUSE_LIMIT;
    for (int32_t v = 0; is_whole && kept == 1 && v < c->tree->vertex_count; v++)
        is_whole = pel_corner_below(c->kept_boxes[v].low, c->kept_boxes[v].high);
    c->has_kept = is_whole && kept == 1;
    if (!is_whole)
        return pel_fail(error, PEL_BAD_FORMAT, "the memory of the search for pairs is damaged");
    if (!c->has_kept)
        return PEL_OK;
    pel_tree_refit(c->tree, c->kept_boxes, pool);
    pel_status status = pel_find_pairs(c->tree, c->tree, both_kinds, pool, &c->search, error);
    c->has_kept = status == PEL_OK;
    return status;
}
