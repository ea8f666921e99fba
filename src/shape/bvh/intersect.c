#include "bvh/intersect.h"

#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "bvh/frame.h"
#include "bvh/search.h"
#include "pellicle/geometry.h"

#include <stdlib.h>
#include <string.h>

/* input of the search: the usable triangles */
typedef struct certificate {
    const pel_mesh *mesh;
    int32_t usable_count;
    int32_t (*triangles)[3]; /* (usable_count x 3) */
    int32_t *numbers;        /* (usable_count) in the mesh */
    double (*positions)[3];  /* (vertex_count x 3), zero where they are not finite */
    pel_box *boxes;          /* (vertex_count) */
    pel_tree *tree;
    pel_pair_search search;
    int32_t pair_limit;
    int32_t split; /* above 0: only pairs of a triangle before it and one from it on, and no more than one a chunk */
    int64_t counts[PEL_SEARCH_CHUNKS]; /* pairs that intersect, of each chunk */
    /* usable triangles that have changed, for a search of their pairs alone */
    int32_t changed_count;
    int32_t (*changed)[3];    /* (usable_count x 3) */
    int32_t *changed_numbers; /* (usable_count) among the usable ones */
} certificate;

static bool is_usable(const pel_mesh *mesh, const int32_t v[3])
{
    for (int i = 0; i < 3; i++) {
        if (v[i] < 0 || v[i] >= mesh->vertex_count || v[i] == v[(i + 1) % 3])
            return false;
        const double *x = mesh->positions[v[i]];
        if (!isfinite(fabs(x[0]) + fabs(x[1]) + fabs(x[2])))
            return false;
    }
    return true;
}

static pel_status collect_triangles(certificate *it)
{
    const pel_mesh *mesh = it->mesh;
    if (!PEL_ALLOCATE_ALL(PEL_ROOM(it->triangles, mesh->triangle_count), PEL_ROOM(it->numbers, mesh->triangle_count),
                          PEL_ROOM(it->positions, mesh->vertex_count), PEL_ROOM_ALIGNED(it->boxes, mesh->vertex_count)))
        return PEL_OUT_OF_MEMORY;
    for (int32_t t = 0; t < mesh->triangle_count; t++) {
        const int32_t *v = mesh->triangles[t];
        if (!is_usable(mesh, v))
            continue;
        for (int i = 0; i < 3; i++)
            memcpy(it->positions[v[i]], mesh->positions[v[i]], sizeof it->positions[v[i]]);
        memcpy(it->triangles[it->usable_count], v, sizeof it->triangles[0]);
        it->numbers[it->usable_count++] = t;
    }
    return PEL_OK;
}

static bool has_corner(const int32_t v[3], int32_t corner)
{
    return v[0] == corner || v[1] == corner || v[2] == corner;
}

/* the corners of both, common ones first and in the same order; returns how many are common */
static int common_first(const int32_t a[3], const int32_t b[3], int32_t a_order[3], int32_t b_order[3])
{
    int shared = 0, a_rest = 2, b_rest = 2;
    for (int i = 0; i < 3; i++) {
        if (has_corner(b, a[i])) {
            a_order[shared] = b_order[shared] = a[i];
            shared++;
        } else {
            a_order[a_rest--] = a[i];
        }
    }
    for (int i = 0; i < 3; i++)
        if (!has_corner(a, b[i]))
            b_order[b_rest--] = b[i];
    return shared;
}

static bool triangles_intersect(const certificate *it, pel_pair pair)
{
    int32_t a[3], b[3];
    double a_corners[3][3], b_corners[3][3];
    int shared = common_first(it->triangles[pair.first], it->triangles[pair.second], a, b);
    for (int i = 0; i < 3; i++) {
        memcpy(a_corners[i], it->positions[a[i]], sizeof a_corners[i]);
        memcpy(b_corners[i], it->positions[b[i]], sizeof b_corners[i]);
    }
    return pel_triangles_intersect_beyond((const double(*)[3])a_corners, (const double(*)[3])b_corners, shared);
}

/* counts the pair when its triangles intersect; no chunk keeps more than can be listed */
static bool keep_pair(void *context, int32_t chunk, pel_pair_kind kind, pel_pair pair)
{
    (void)kind;
    certificate *it = context;
    bool is_within = (it->numbers[pair.first] < it->split) == (it->numbers[pair.second] < it->split);
    if (it->split > 0 && (is_within || it->counts[chunk] > 0))
        return false;
    return triangles_intersect(it, pair) && ++it->counts[chunk] <= it->pair_limit;
}

/* limit of tested pairs of overlapping boxes: some for each triangle, and a minimum. Surfaces have 10 to 30 a triangle;
   a vertex of n triangles adds n^2 / 2 */
static int64_t test_limit(const certificate *it)
{
    const int64_t for_each = 100, at_least = 4000000;
    return for_each * it->usable_count + at_least;
}

/* names the vertex of the most triangles, the usual cause of too many pairs */
static pel_status fail_limit(const certificate *it, pel_error *error)
{
    int32_t *valence = pel_allocate((size_t)it->mesh->vertex_count, sizeof *valence), worst = 0;
    if (valence == NULL)
        return pel_fail_memory(error);
    for (int32_t t = 0; t < it->usable_count; t++)
        for (int i = 0; i < 3; i++)
            valence[it->triangles[t][i]]++;
    for (int32_t v = 1; v < it->mesh->vertex_count; v++)
        worst = valence[v] > valence[worst] ? v : worst;
    pel_fail(error, PEL_BAD_MESH,
             "the boxes of more than %lld pairs of triangles overlap: too many to test for intersections; vertex %d "
             "has %d triangles",
             (long long)test_limit(it), (int)worst, (int)valence[worst]);
    pel_fail_remedy(error,
                    "divide the triangles around that vertex, or omit the test (pellicle check --no-intersections)");
    pel_fail_element(error, "vertex", worst);
    pel_free(valence);
    return PEL_BAD_MESH;
}

/* a tree over some of the triangles, with the boxes of all vertices */
static pel_status make_tree(certificate *it, int32_t (*triangles)[3], int32_t count, pel_error *error)
{
    const double(*positions)[3] = (const double(*)[3])it->positions;
    pel_status status = pel_tree_create(positions, it->mesh->vertex_count, (const int32_t(*)[3])triangles, count,
                                        PEL_TREE_TRIANGLES, &it->tree, error);
    if (status != PEL_OK)
        return status;
    pel_motion rest = {positions, positions, it->mesh->vertex_count};
    pel_frame frame = pel_frame_centre(&rest);
    pel_boxes_of_motion(&frame, &rest, 0, NULL, it->boxes);
    pel_tree_refit(it->tree, it->boxes, NULL);
    return PEL_OK;
}

static pel_status find_pairs(certificate *it, pel_error *error)
{
    pel_status status = make_tree(it, it->triangles, it->usable_count, error);
    if (status != PEL_OK)
        return status;
    it->search.keep = keep_pair;
    it->search.context = it;
    status = pel_find_pairs(it->tree, it->tree, 1u << PEL_PAIR_FACE_FACE, NULL, &it->search, error);
    return status == PEL_BAD_ARGUMENT ? fail_limit(it, error) : status;
}

static int compare_pairs(const void *a, const void *b)
{
    const pel_pair *p = a, *q = b;
    if (p->first != q->first)
        return p->first < q->first ? -1 : 1;
    return (p->second > q->second) - (p->second < q->second);
}

/* counts and lists the pairs found, by the numbers of the mesh (in the order of the usable triangles) */
static void list_pairs(const certificate *it, pel_pair *pairs, int64_t *count)
{
    int32_t listed = 0;
    for (int chunk = 0; chunk < PEL_SEARCH_CHUNKS; chunk++) {
        const pel_pair_list *list = &it->search.chunks[chunk].lists[PEL_PAIR_FACE_FACE];
        *count += it->counts[chunk];
        for (size_t i = 0; i < list->count && listed < it->pair_limit; i++)
            pairs[listed++] = (pel_pair){it->numbers[list->pairs[i].first], it->numbers[list->pairs[i].second]};
    }
    if (listed > 1)
        qsort(pairs, (size_t)listed, sizeof *pairs, compare_pairs);
}

static void clear(certificate *it)
{
    PEL_FREE_ALL(it->triangles, it->numbers, it->positions, it->boxes, it->changed, it->changed_numbers);
    pel_tree_destroy(it->tree);
    pel_pair_search_clear(&it->search);
}

static pel_status search(certificate *it, pel_pair *pairs, int64_t *count, pel_error *error)
{
    pel_status status = collect_triangles(it);
    if (status != PEL_OK)
        pel_fail_memory(error);
    pel_pair_search_begin(&it->search, test_limit(it));
    if (status == PEL_OK && it->usable_count > 1)
        status = find_pairs(it, error);
    if (status == PEL_OK)
        list_pairs(it, pairs, count);
    clear(it);
    return status;
}

pel_status pel_mesh_self_intersections(const pel_mesh *mesh, pel_pair *pairs, int32_t pair_limit, int64_t *count,
                                       pel_error *error)
{
    PEL_REFUSE_NULL(mesh, error);
    PEL_REFUSE_NULL(count, error);
    *count = 0;
    if (pair_limit > 0)
        PEL_REFUSE_NULL(pairs, error);
    if (mesh->vertex_count < 0 || mesh->triangle_count < 0 || pair_limit < 0)
        return pel_fail(error, PEL_BAD_ARGUMENT, "a count is below 0");
    certificate it = {.mesh = mesh, .pair_limit = pair_limit};
    return search(&it, pairs, count, error);
}

pel_status pel_mesh_parts_intersect(const pel_mesh *mesh, int32_t split, bool *found)
{
    certificate it = {.mesh = mesh, .split = split};
    int64_t count = 0;
    pel_status status = search(&it, NULL, &count, NULL);
    *found = count > 0;
    return status;
}

/* ---- pairs of changed triangles ---- */

static pel_status collect_changed(certificate *it, const uint8_t *changed)
{
    pel_status status = collect_triangles(it);
    if (status == PEL_OK &&
        !PEL_ALLOCATE_ALL(PEL_ROOM(it->changed, it->usable_count), PEL_ROOM(it->changed_numbers, it->usable_count)))
        status = PEL_OUT_OF_MEMORY;
    for (int32_t t = 0; status == PEL_OK && t < it->usable_count; t++) {
        if (!changed[it->numbers[t]])
            continue;
        memcpy(it->changed[it->changed_count], it->triangles[t], sizeof it->changed[0]);
        it->changed_numbers[it->changed_count++] = t;
    }
    return status;
}

/* one after the other against the tree of those that have changed; these have a turn of their own later */
static pel_status find_changed(certificate *it, const uint8_t *changed, bool *found)
{
    pel_element_list near = {0};
    pel_status status = make_tree(it, it->changed, it->changed_count, NULL);
    for (int32_t t = 0; status == PEL_OK && !*found && t < it->usable_count; t++) {
        const int32_t *v = it->triangles[t];
        pel_box box = pel_box_join(pel_box_join(it->boxes[v[0]], it->boxes[v[1]]), it->boxes[v[2]]);
        bool is_changed = changed[it->numbers[t]];
        status = pel_find_in_box(it->tree, &box, &near, NULL);
        for (size_t i = 0; status == PEL_OK && !*found && i < near.count; i++) {
            int32_t other = it->changed_numbers[near.elements[i]];
            *found = (is_changed ? other > t : other != t) && triangles_intersect(it, (pel_pair){t, other});
        }
    }
    pel_free(near.elements);
    return status;
}

pel_status pel_mesh_changed_intersect(const pel_mesh *mesh, const uint8_t *changed, bool *found)
{
    certificate it = {.mesh = mesh};
    *found = false;
    pel_status status = collect_changed(&it, changed);
    if (status == PEL_OK && it.changed_count > 0)
        status = find_changed(&it, changed, found);
    clear(&it);
    return status;
}
