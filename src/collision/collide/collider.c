#include "collide/collider.h"

#include "base/memory.h"
#include "base/room.h"
#include "base/sort.h"
#include "base/status.h"
#include "collide/clearance.h"
#include "geom/ccd.h"
#include "math/extremes.h"
#include "math/functions.h"
#include "pellicle/parallel.h"

#include <string.h>

enum {
    DEF_COOKIE = 0x434f4c4c,
    BLOCK = PEL_COLLIDER_BLOCK, /* candidates that are solved together */
    LISTS = 2,
    PARTS = 64,     /* lists of collisions that threads fill */
    FEW_SHARE = 64, /* fewer hits than features over this are sorted by comparison */
    /* of a pair: two lists that double when they grow */
    BYTES_PER_PAIR = 4 * sizeof(pel_pair),
    UNFILTERED_SEARCHES = 7
};

/* of all: where more pairs come near, they are measured without a filter in the next searches */
#define MOST_NEAR 0.5

/* default of the memory limit: the larger of this and a size per triangle */
#define LEAST_MEMORY ((int64_t)1 << 30)
#define MEMORY_PER_TRIANGLE ((int64_t)1 << 12)

typedef struct collision_list {
    pel_collision *collisions;
    size_t count, capacity;
} collision_list;

/* result of one part of the candidates of one kind */
typedef struct part {
    collision_list list;
    pel_ccd_statistics statistics;
    int64_t left_count, near_count; /* pairs that the sieve left, and that passed the filter */
    pel_status status;
} part;

struct pel_collider {
    int32_t (*triangles)[3]; /* own */
    pel_candidates *candidates;
    pel_clearance clearances[LISTS]; /* that of many pairs, and the nearest of them */
    const uint8_t *sought;           /* not owned; null = all groups: */
    pel_pair_list found[2];          /* pairs of the last search for some of them, by kind */
    double margin;                   /* as in the def */
    int64_t memory_limit;            /* as in the def */
    pel_pool *pool, *own_pool;
    int32_t unfiltered[2]; /* by kind: searches to come without a filter; the measure would turn down the same pairs */
    part parts[PARTS];
    collision_list collisions;
    int32_t *ends; /* (features) scratch of their order */
    size_t end_capacity;
};

/* ---- creation ---- */

pel_collider_def pel_collider_def_default(void)
{
    return (pel_collider_def){.margin = -1, .thread_count = 1, .cookie = DEF_COOKIE};
}

pel_collision_query pel_collision_query_default(void)
{
    return (pel_collision_query){.method = PEL_CCD_CONSERVATIVE};
}

static pel_status check_mesh(const pel_mesh *mesh, pel_error *error)
{
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        for (int k = 0; k < 3; k++)
            if (!isfinite(mesh->positions[v][k])) {
                pel_fail(error, PEL_BAD_ARGUMENT, "the position of a vertex is not finite");
                pel_fail_element(error, "vertex", v);
                return PEL_BAD_ARGUMENT;
            }
    for (int32_t t = 0; t < mesh->triangle_count; t++) {
        const int32_t *v = mesh->triangles[t];
        bool in_range = true;
        for (int i = 0; i < 3; i++)
            in_range = in_range && v[i] >= 0 && v[i] < mesh->vertex_count && v[i] != v[(i + 1) % 3];
        if (in_range)
            continue;
        return pel_refuse_element(error, PEL_BAD_MESH, "triangle", t, "repair the mesh (pel_mesh_repair)",
                                  "a triangle needs three different vertices of the mesh, not %d, %d, %d", (int)v[0],
                                  (int)v[1], (int)v[2]);
    }
    return PEL_OK;
}

static pel_status check_def(const pel_collider_def *def, pel_error *error)
{
    if (def->cookie != DEF_COOKIE)
        return pel_fail(error, PEL_BAD_ARGUMENT, "the collider's def was not made by pel_collider_def_default");
    if (def->mesh == NULL)
        return pel_fail(error, PEL_BAD_ARGUMENT, "the collider's def has no mesh");
    if (!isfinite(def->margin))
        return pel_fail(error, PEL_BAD_ARGUMENT, "the collider's margin is not finite");
    if (def->memory_limit < 0)
        return pel_fail(error, PEL_BAD_ARGUMENT, "the collider's memory_limit is %lld", (long long)def->memory_limit);
    if (def->thread_count < 0 || def->thread_count > PEL_THREADS_MOST)
        return pel_fail(error, PEL_BAD_ARGUMENT, "the collider's thread_count is %d", def->thread_count);
    return check_mesh(def->mesh, error);
}

static double mean_edge(const double (*positions)[3], const int32_t (*triangles)[3], int32_t triangle_count)
{
    double sum = 0;
    for (int32_t h = 0; h < 3 * triangle_count; h++) {
        const double *a = positions[triangles[h / 3][h % 3]], *b = positions[triangles[h / 3][(h + 1) % 3]];
        sum += pel_hypot(pel_hypot(b[0] - a[0], b[1] - a[1]), b[2] - a[2]);
    }
    return isfinite(sum) ? sum / (3.0 * triangle_count) : 0;
}

static void clear_surface(pel_candidates *candidates, pel_clearance clearances[LISTS])
{
    pel_candidates_destroy(candidates);
    for (int i = 0; i < LISTS; i++)
        pel_clearance_clear(&clearances[i]);
}

/* members that belong to one surface; all freed on failure */
static pel_status make_surface(const pel_collider *collider, const double (*positions)[3], int32_t vertex_count,
                               const int32_t (*triangles)[3], int32_t triangle_count, pel_candidates **made,
                               pel_clearance clearances[LISTS], pel_error *error)
{
    int64_t memory = collider->memory_limit;
    if (memory == 0)
        memory =
            MEMORY_PER_TRIANGLE * triangle_count > LEAST_MEMORY ? MEMORY_PER_TRIANGLE * triangle_count : LEAST_MEMORY;
    double margin = collider->margin >= 0 ? collider->margin : 0.2 * mean_edge(positions, triangles, triangle_count);
    pel_status status = pel_candidates_create(positions, vertex_count, triangles, triangle_count, margin,
                                              memory / BYTES_PER_PAIR, made, error);
    if (status != PEL_OK)
        return status;
    if (collider->candidates != NULL &&
        pel_candidates_use_groups(*made, &collider->candidates->groups, positions) != PEL_OK)
        status = pel_fail_memory(error);
    clearances[0] = clearances[1] = (pel_clearance){0};
    for (int i = 0; status == PEL_OK && i < LISTS; i++)
        status = pel_clearance_create(vertex_count, &clearances[i], error);
    if (status != PEL_OK)
        clear_surface(*made, clearances);
    return status;
}

static void replace_surface(pel_collider *collider, int32_t (*triangles)[3], pel_candidates *made,
                            const pel_clearance clearances[LISTS])
{
    clear_surface(collider->candidates, collider->clearances);
    pel_free(collider->triangles);
    memcpy(collider->clearances, clearances, sizeof collider->clearances);
    collider->candidates = made;
    collider->triangles = triangles;
}

pel_status pel_collider_set_surface(pel_collider *collider, const double (*positions)[3], int32_t vertex_count,
                                    int32_t (*triangles)[3], int32_t triangle_count, pel_error *error)
{
    pel_candidates *made;
    pel_clearance clearances[LISTS];
    pel_status status = make_surface(collider, positions, vertex_count, (const int32_t(*)[3])triangles, triangle_count,
                                     &made, clearances, error);
    if (status == PEL_OK)
        replace_surface(collider, triangles, made, clearances);
    return status;
}

void pel_collider_memory(pel_collider *collider, pel_memory_part parts[PEL_COLLIDER_PARTS])
{
    pel_candidates_memory(collider->candidates, parts);
    for (int i = 0; i < LISTS; i++)
        pel_clearance_memory(&collider->clearances[i], parts + PEL_CANDIDATES_PARTS + i * PEL_CLEARANCE_PARTS);
}

static void copy_memory(const pel_memory_part *from, const pel_memory_part *to, int count)
{
    for (int i = 0; i < count; i++)
        memcpy(to[i].data, from[i].data, to[i].size);
}

/* the pairs of the clearances first: they are searched with the candidates */
static pel_status recall(const pel_memory_part *saved, pel_candidates *made, pel_clearance clearances[LISTS],
                         pel_pool *pool, pel_error *error)
{
    pel_memory_part parts[PEL_CANDIDATES_PARTS], clear[PEL_CLEARANCE_PARTS];
    pel_status status = PEL_OK;
    pel_candidates_memory(made, parts);
    for (int i = 0; status == PEL_OK && i < LISTS; i++) {
        pel_clearance_memory(&clearances[i], clear);
        copy_memory(saved + PEL_CANDIDATES_PARTS + i * PEL_CLEARANCE_PARTS, clear, PEL_CLEARANCE_PARTS);
        status = pel_clearance_recall(&clearances[i], made, pool, error);
    }
    copy_memory(saved, parts, PEL_CANDIDATES_PARTS);
    return status == PEL_OK ? pel_candidates_recall(made, pool, error) : status;
}

pel_status pel_collider_recall(pel_collider *collider, const double (*positions)[3], int32_t vertex_count,
                               int32_t (*triangles)[3], int32_t triangle_count, pel_error *error)
{
    pel_memory_part saved[PEL_COLLIDER_PARTS];
    pel_candidates *made;
    pel_clearance clearances[LISTS];
    pel_status status = make_surface(collider, positions, vertex_count, (const int32_t(*)[3])triangles, triangle_count,
                                     &made, clearances, error);
    if (status != PEL_OK)
        return status;
    pel_collider_memory(collider, saved);
    status = recall(saved, made, clearances, collider->pool, error);
    if (status == PEL_OK)
        replace_surface(collider, triangles, made, clearances);
    else
        clear_surface(made, clearances);
    return status;
}

static pel_status fill_collider(pel_collider *collider, const pel_collider_def *def, pel_error *error)
{
    const pel_mesh *mesh = def->mesh;
    collider->margin = def->margin;
    collider->memory_limit = def->memory_limit;
    int32_t(*triangles)[3] = pel_allocate((size_t)mesh->triangle_count, sizeof *triangles);
    if (triangles == NULL)
        return pel_fail_memory(error);
    memcpy(triangles, mesh->triangles, (size_t)mesh->triangle_count * sizeof *triangles);
    pel_status status = pel_collider_set_surface(collider, (const double(*)[3])mesh->positions, mesh->vertex_count,
                                                 triangles, mesh->triangle_count, error);
    if (status != PEL_OK)
        pel_free(triangles);
    int threads = def->thread_count > 0 ? def->thread_count : pel_thread_limit();
    if (status == PEL_OK && threads > 1)
        status = pel_pool_create(threads, &collider->own_pool, error);
    collider->pool = collider->own_pool;
    return status;
}

pel_status pel_collider_create(const pel_collider_def *def, pel_collider **collider, pel_error *error)
{
    PEL_REFUSE_NULL(def, error);
    PEL_REFUSE_NULL(collider, error);
    *collider = NULL;
    pel_status status = check_def(def, error);
    if (status != PEL_OK)
        return status;
    pel_collider *made = pel_allocate(1, sizeof *made);
    if (made == NULL)
        return pel_fail_memory(error);
    status = fill_collider(made, def, error);
    if (status == PEL_OK)
        *collider = made;
    else
        pel_collider_destroy(made);
    return status;
}

void pel_collider_destroy(pel_collider *collider)
{
    if (collider == NULL)
        return;
    clear_surface(collider->candidates, collider->clearances);
    pel_free(collider->triangles);
    pel_pool_destroy(collider->own_pool);
    for (int i = 0; i < PARTS; i++)
        pel_free(collider->parts[i].list.collisions);
    PEL_FREE_ALL(collider->found[0].pairs, collider->found[1].pairs, collider->collisions.collisions, collider->ends,
                 collider);
}

void pel_collider_use_pool(pel_collider *collider, pel_pool *pool)
{
    collider->pool = pool;
}

pel_status pel_collider_use_groups(pel_collider *collider, const pel_collision_groups *groups,
                                   const double (*positions)[3], pel_error *error)
{
    collider->clearances[0].reach = collider->clearances[1].reach = 0;
    return pel_candidates_use_groups(collider->candidates, groups, positions) == PEL_OK ? PEL_OK
                                                                                        : pel_fail_memory(error);
}

void pel_collider_seek(pel_collider *collider, const uint8_t *groups)
{
    collider->sought = groups;
}

const pel_tree *pel_collider_tree(const pel_collider *collider)
{
    return collider->candidates->tree;
}

/* ---- broad phase ---- */

static pel_status check_query(const pel_collision_query *query, pel_error *error)
{
    PEL_REFUSE_NULL(query->start, error);
    PEL_REFUSE_NULL(query->end, error);
    if (PEL_IS_NO_CHOICE(query->method, PEL_CCD_BRIDSON + 1))
        return pel_fail(error, PEL_BAD_ARGUMENT, "method %d of the collision query is unknown", (int)query->method);
    if (!(query->min_separation >= 0 && isfinite(query->min_separation)))
        return pel_fail(error, PEL_BAD_ARGUMENT, "min_separation must be at least 0, not %g", query->min_separation);
    if (!(query->tolerance >= 0 && isfinite(query->tolerance)))
        return pel_fail(error, PEL_BAD_ARGUMENT, "tolerance must be at least 0, not %g", query->tolerance);
    if (!(query->near >= 0))
        return pel_fail(error, PEL_BAD_ARGUMENT, "near must be at least 0, not %g", query->near);
    return PEL_OK;
}

static pel_status update(pel_collider *collider, const pel_collision_query *query, pel_error *error)
{
    return pel_candidates_update(collider->candidates, (const double(*)[3])query->start, (const double(*)[3])query->end,
                                 query->min_separation + query->tolerance, collider->pool, error);
}

pel_status pel_collider_candidates(pel_collider *collider, const pel_collision_query *query,
                                   pel_collision_candidates *candidates, pel_error *error)
{
    PEL_REFUSE_NULL(collider, error);
    PEL_REFUSE_NULL(query, error);
    PEL_REFUSE_NULL(candidates, error);
    const pel_candidates *c = collider->candidates;
    *candidates = (pel_collision_candidates){0};
    pel_status status = check_query(query, error);
    if (status == PEL_OK)
        status = update(collider, query, error);
    if (status == PEL_OK)
        *candidates = (pel_collision_candidates){
            .vertex_face = c->vertex_face,
            .vertex_face_count = (int64_t)c->vertex_face_count,
            .edge_edge = c->edge_edge,
            .edge_edge_count = (int64_t)c->edge_edge_count,
            .searches = c->counts.searches,
            .kept = c->counts.kept,
        };
    return status;
}

/* ---- narrow phase ---- */

/* candidates of one kind on their way through the narrow phase */
typedef struct narrow {
    const pel_tree *tree;
    const pel_collision_query *query;
    bool edge_edge;
    const pel_pair_test *test; /* null = times of impact */
    bool is_filtered;          /* before they are measured */
    const pel_pair *pairs;
    size_t pair_count;
    part *parts; /* (PARTS) */
    const pel_pool *pool;
} narrow;

static void set_points(const narrow *n, pel_pair pair, int32_t points[4])
{
    if (n->edge_edge) {
        pel_tree_edge_ends(n->tree, pair.first, points);
        pel_tree_edge_ends(n->tree, pair.second, points + 2);
    } else {
        points[0] = pair.first;
        memcpy(points + 1, n->tree->triangles[pair.second], sizeof(int32_t[3]));
    }
}

/* at most BLOCK pairs, whose points are written */
static pel_ccd_batch batch_of(const narrow *n, const pel_pair *pairs, int32_t count, int32_t points[BLOCK][4])
{
    for (int32_t i = 0; i < count; i++)
        set_points(n, pairs[i], points[i]);
    return (pel_ccd_batch){.start = n->query->start,
                           .end = n->query->end,
                           .points = points[0],
                           .query_count = count,
                           .edge_edge = n->edge_edge,
                           .method = n->query->method,
                           .min_separation = n->query->min_separation,
                           .tolerance = n->query->tolerance,
                           .near = n->query->near};
}

/* at most BLOCK pairs */
static pel_status solve_block(const narrow *n, const pel_pair *pairs, int32_t count, part *p)
{
    int32_t points[BLOCK][4], queries[BLOCK];
    pel_ccd_hit hits[BLOCK];
    const pel_ccd_batch batch = batch_of(n, pairs, count, points);
    int32_t hit_count = pel_ccd_solve_batch(&batch, queries, hits, &p->statistics);
    collision_list *list = &p->list;
    if (!pel_reserve((void **)&list->collisions, &list->capacity, list->count + (size_t)hit_count,
                     sizeof *list->collisions))
        return PEL_OUT_OF_MEMORY;
    for (int32_t i = 0; i < hit_count; i++) {
        pel_collision *c = &list->collisions[list->count++];
        const pel_pair *pair = &pairs[queries[i]];
        *c = (pel_collision){.edge_edge = n->edge_edge, .first = pair->first, .second = pair->second, .hit = hits[i]};
        memcpy(c->vertices, points[queries[i]], sizeof c->vertices);
    }
    return PEL_OK;
}

/* the numbers of those that are to be measured, at most BLOCK */
static int32_t choose_pairs(const narrow *n, const pel_ccd_batch *batch, const pel_pair *pairs,
                            const int32_t (*points)[4], int32_t chosen[BLOCK], part *p)
{
    int32_t count = batch->query_count, near[BLOCK], few[BLOCK][4];
    for (int32_t i = 0; i < count; i++)
        chosen[i] = i;
    if (n->test->sieve != NULL)
        count = n->test->sieve(n->test->context, n->edge_edge, pairs, points, count, chosen);
    p->left_count += count;
    if (!n->is_filtered)
        return count;
    for (int32_t i = 0; i < count; i++)
        memcpy(few[i], points[chosen[i]], sizeof few[i]);
    pel_ccd_batch left = *batch;
    left.points = few[0];
    left.query_count = count;
    count = pel_ccd_near_batch(&left, near);
    for (int32_t i = 0; i < count; i++)
        chosen[i] = chosen[near[i]];
    p->near_count += count;
    return count;
}

static pel_status measure_block(const narrow *n, const pel_pair *pairs, int32_t count, part *p)
{
    int32_t points[BLOCK][4], near[BLOCK];
    collision_list *list = &p->list;
    const pel_ccd_batch batch = batch_of(n, pairs, count, points);
    int32_t near_count = choose_pairs(n, &batch, pairs, (const int32_t(*)[4])points, near, p);
    if (!pel_reserve((void **)&list->collisions, &list->capacity, list->count + (size_t)near_count,
                     sizeof *list->collisions))
        return PEL_OUT_OF_MEMORY;
    for (int32_t i = 0; i < near_count; i++) {
        const pel_pair *pair = &pairs[near[i]];
        pel_collision *c = &list->collisions[list->count];
        *c = (pel_collision){.edge_edge = n->edge_edge, .first = pair->first, .second = pair->second};
        memcpy(c->vertices, points[near[i]], sizeof c->vertices);
        list->count += n->test->measure(n->test->context, c);
    }
    p->statistics.queries += count;
    return PEL_OK;
}

static void solve_part(void *context, int32_t number)
{
    narrow *n = context;
    part *p = &n->parts[number];
    size_t begin = n->pair_count * (size_t)number / PARTS, end = n->pair_count * ((size_t)number + 1) / PARTS;
    p->list.count = 0;
    p->left_count = p->near_count = 0;
    p->status = pel_pool_is_stopped(n->pool) ? PEL_STOPPED : PEL_OK;
    p->statistics = (pel_ccd_statistics){0};
    for (size_t i = begin; i < end && p->status == PEL_OK; i += BLOCK) {
        int32_t count = (int32_t)(end - i < BLOCK ? end - i : BLOCK);
        p->status = n->test != NULL ? measure_block(n, n->pairs + i, count, p) : solve_block(n, n->pairs + i, count, p);
    }
}

/* by `second`; few */
static void sort_few(pel_collision *collisions, int32_t count)
{
    for (int32_t i = 1; i < count; i++) {
        const pel_collision moving = collisions[i];
        int32_t at = i;
        for (; at > 0 && collisions[at - 1].second > moving.second; at--)
            collisions[at] = collisions[at - 1];
        collisions[at] = moving;
    }
}

static bool is_before(const pel_collision *a, const pel_collision *b)
{
    return a->first != b->first ? a->first < b->first : a->second < b->second;
}

PEL_DEFINE_SORT(sort_all, pel_collision, is_before)

/* puts the hits of all parts behind each other: to their places by their first feature, where `ends` are the places
   behind those of each feature, or as they come */
static void put_hits(const pel_collider *collider, int32_t *ends, pel_collision *to)
{
    int32_t at = 0;
    for (int i = 0; i < PARTS; i++)
        for (size_t k = 0; k < collider->parts[i].list.count; k++) {
            const pel_collision *collision = &collider->parts[i].list.collisions[k];
            to[ends != NULL ? ends[collision->first]++ : at++] = *collision;
        }
}

/* many hits: each goes to its place by its first feature */
static void put_by_feature(pel_collider *collider, size_t feature_count, pel_collision *to)
{
    int32_t *ends = collider->ends, end = 0;
    memset(ends, 0, feature_count * sizeof *ends);
    for (int i = 0; i < PARTS; i++)
        for (size_t k = 0; k < collider->parts[i].list.count; k++)
            ends[collider->parts[i].list.collisions[k].first]++;
    for (size_t f = 0; f < feature_count; f++) {
        int32_t own = ends[f];
        ends[f] = end;
        end += own;
    }
    put_hits(collider, ends, to);
    for (size_t f = 0; f < feature_count; f++) {
        int32_t begin = f > 0 ? ends[f - 1] : 0;
        sort_few(to + begin, ends[f] - begin);
    }
}

/* Adds the hits of all parts in the order of their features, so that the order of candidates does not show. */
static pel_status gather(pel_collider *collider, bool edge_edge, pel_error *error)
{
    collision_list *all = &collider->collisions;
    const pel_tree *tree = collider->candidates->tree;
    size_t feature_count = (size_t)(edge_edge ? 3 * tree->triangle_count : tree->vertex_count), count = 0;
    for (int i = 0; i < PARTS; i++)
        count += collider->parts[i].list.count;
    if (count == 0)
        return PEL_OK;
    if (!pel_reserve((void **)&all->collisions, &all->capacity, all->count + count, sizeof *all->collisions) ||
        !pel_reserve((void **)&collider->ends, &collider->end_capacity, feature_count, sizeof *collider->ends))
        return pel_fail_memory(error);
    pel_collision *to = all->collisions + all->count;
    if (FEW_SHARE * count < feature_count) {
        put_hits(collider, NULL, to);
        sort_all(to, count);
    } else
        put_by_feature(collider, feature_count, to);
    all->count += count;
    return PEL_OK;
}

/* how many further searches go without a filter */
static int32_t choose_unfiltered(const pel_collider *collider)
{
    int64_t left_count = 0, near_count = 0;
    for (int i = 0; i < PARTS; i++) {
        left_count += collider->parts[i].left_count;
        near_count += collider->parts[i].near_count;
    }
    return (double)near_count > MOST_NEAR * (double)left_count ? UNFILTERED_SEARCHES : 0;
}

/* solves the pairs of one kind and adds the hits */
static pel_status solve_kind(pel_collider *collider, narrow n, const pel_pair_list *pairs,
                             pel_ccd_statistics *statistics, pel_error *error)
{
    if (pairs->count == 0)
        return PEL_OK;
    n.tree = collider->candidates->tree;
    n.pairs = pairs->pairs;
    n.pair_count = pairs->count;
    n.parts = collider->parts;
    n.pool = collider->pool;
    int32_t *unfiltered = &collider->unfiltered[n.edge_edge];
    n.is_filtered = *unfiltered == 0;
    pel_pool_run(collider->pool, PARTS, solve_part, &n);
    if (n.test != NULL)
        *unfiltered = n.is_filtered ? choose_unfiltered(collider) : *unfiltered - 1;
    for (int i = 0; i < PARTS; i++) {
        const part *p = &collider->parts[i];
        if (p->status == PEL_STOPPED)
            return pel_pool_check(collider->pool, error);
        if (p->status != PEL_OK)
            return pel_fail_memory(error);
        pel_ccd_statistics_add(statistics, &p->statistics);
    }
    return gather(collider, n.edge_edge, error);
}

/* m, pairs that stay farther apart are no hits */
static double needed_distance(const pel_collision_query *query)
{
    return pel_max(query->min_separation + query->tolerance, query->near);
}

bool pel_collider_is_clear(pel_collider *collider, const pel_collision_query *query, const pel_clearance_way *way)
{
    return pel_clearance_is_clear(&collider->clearances[0], way, needed_distance(query), collider->pool);
}

bool pel_collider_stays_clear(pel_collider *collider, const pel_collision_query *query, double longest, bool ends)
{
    return pel_clearance_stays_clear(&collider->clearances[0], longest, ends, needed_distance(query));
}

void pel_collider_go(pel_collider *collider, const pel_collision_query *query, const pel_record *positions)
{
    pel_clearance_go(&collider->clearances[0], positions, needed_distance(query), collider->pool);
}

static void list_known(const pel_clearance *clearance, pel_pair_list *vertex_face, pel_pair_list *edge_edge)
{
    *vertex_face = clearance->vertex_face;
    *edge_edge = clearance->edge_edge;
}

/* input of the narrow phase: the known pairs while no others can come near, else the candidates. A hit is within
   min_separation and tolerance, or starts within `near`, so that all give the same. */
static pel_status find_pairs(pel_collider *collider, const pel_collision_query *query, pel_pair_list *vertex_face,
                             pel_pair_list *edge_edge, pel_error *error)
{
    pel_clearance *outer = &collider->clearances[0], *inner = &collider->clearances[1];
    pel_candidates *c = collider->candidates;
    const double(*start)[3] = (const double(*)[3])query->start, (*end)[3] = (const double(*)[3])query->end;
    pel_status status = check_query(query, error);
    if (status != PEL_OK)
        return status;
    double needed = needed_distance(query);
    if (collider->sought != NULL) {
        status = pel_candidates_seek(c, start, end, query->min_separation + query->tolerance, collider->sought,
                                     collider->pool, &collider->found[0], &collider->found[1], error);
        *vertex_face = collider->found[0];
        *edge_edge = collider->found[1];
        return status;
    }
    bool serves = pel_clearance_serves(inner, start, end, needed, collider->pool), is_known = serves;
    if (!serves && pel_clearance_serves(outer, start, end, needed, collider->pool)) {
        pel_clearance_settle(outer, c->tree, start, end, needed, collider->pool);
        is_known = true;
    } else if (!serves)
        is_known = pel_clearance_renew(outer, c, start, end, needed, c->margin, collider->pool) &&
                   pel_clearance_reserve(inner, outer);
    if (is_known) {
        serves = serves || pel_clearance_narrow(inner, outer, c->tree, start, end, needed, collider->pool);
        list_known(serves ? inner : outer, vertex_face, edge_edge);
        return PEL_OK;
    }
    status = update(collider, query, error);
    *vertex_face = (pel_pair_list){.pairs = c->vertex_face, .count = c->vertex_face_count};
    *edge_edge = (pel_pair_list){.pairs = c->edge_edge, .count = c->edge_edge_count};
    return status;
}

pel_status pel_collider_list(pel_collider *collider, const pel_collision_query *query, const pel_pair_test *test,
                             pel_collision_result *result, pel_error *error)
{
    *result = (pel_collision_result){0};
    collider->collisions.count = 0;
    pel_pair_list vertex_face, edge_edge;
    pel_status status = find_pairs(collider, query, &vertex_face, &edge_edge, error);
    narrow n = {.query = query, .test = test};
    if (status == PEL_OK)
        status = solve_kind(collider, n, &vertex_face, &result->vertex_face, error);
    n.edge_edge = true;
    if (status == PEL_OK)
        status = solve_kind(collider, n, &edge_edge, &result->edge_edge, error);
    if (status != PEL_OK) {
        *result = (pel_collision_result){0};
        return status;
    }
    result->collisions = collider->collisions.collisions;
    result->collision_count = (int64_t)collider->collisions.count;
    return PEL_OK;
}

pel_status pel_collider_detect(pel_collider *collider, const pel_collision_query *query, pel_collision_result *result,
                               pel_error *error)
{
    PEL_REFUSE_NULL(collider, error);
    PEL_REFUSE_NULL(query, error);
    PEL_REFUSE_NULL(result, error);
    return pel_collider_list(collider, query, NULL, result, error);
}
