#include "contact/set.h"

#include "base/assert.h"
#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "contact/layer.h"
#include "math/extremes.h"
#include "sweep/sweep.h"

#include <string.h>

enum { VELOCITY_SWEEPS = 4 };

/* distance that the guard keeps, of the thickness */
#define GUARDED_SHARE 0.3
/* of a solver with contacts in its loop: by which ways may be wrong at least, of the thickness, and at most, of the
   shortest edge */
#define LEAST_MARGIN 0.5
#define MOST_MARGIN 0.1
/* of the margin, and of the thickness: the list of a search serves in further steps while nothing is farther from where
   its way ended. What slides farther is before other triangles than those that were chosen at a corner. */
#define HOME_SHARE 0.25
#define HOME_SLIDE 0.02
/* of the thickness: what is so near to a corner while it is near its home leans less over the triangles there than
   refresh.c permits */
#define CORNER_SHARE 0.01
/* features closer than thickness + NEAR_SHARE x shortest edge at the start of a step become contacts, without a time of
   impact; tried and lost: also where the closest points lie on the border of a feature (such normals
   lean, and what slides is held up), and no look for conflicts in the first round, where many contacts get their place
 */
#define NEAR_SHARE 0.5
/* of what a pair lacks of its thickness, how much corrections give back in a step */
#define REGAIN 0.1
/* of the pairs after a search in a step that went through all: while there are fewer, the next ones keep them */
#define MOST_KEPT 1.1
/* depth at which sweeps may end, of the thickness */
#define SWEEP_TOLERANCE 1e-2

/* ---- creation ---- */

void pel_contact_set_measure_groups(pel_contact_set *set)
{
    set->least = HUGE_VAL;
    set->largest = 0;
    for (int32_t i = 0; i < set->def.body_count + set->def.obstacle_count; i++) {
        set->least = pel_min(set->least, set->groups[i].thickness);
        set->largest = pel_max(set->largest, set->groups[i].thickness);
    }
    set->finest = set->least;
    for (int32_t b = 0; set->def.origin_of_vertex != NULL && b < set->def.body_count; b++)
        set->finest = pel_min(set->finest, pel_contact_kin_share(set, b) * set->groups[b].thickness);
    set->guarded = GUARDED_SHARE * set->least;
    set->near = set->largest + NEAR_SHARE * set->def.shortest_edge;
    set->aim = HUGE_VAL;
    set->margin = LEAST_MARGIN * set->largest;
    set->horizon = 1;
}

static pel_status copy_def(pel_contact_set *set, const pel_contact_set_def *def, pel_error *error)
{
    size_t obstacle_count = (size_t)def->obstacle_count, group_count = (size_t)def->body_count + obstacle_count;
    set->def = *def;
    set->vertex_count = def->vertex_count;
    set->obstacles = pel_allocate(obstacle_count, sizeof *set->obstacles);
    set->groups = pel_allocate(group_count, sizeof *set->groups);
    set->list.rigids = def->rigids;
    set->def.obstacles = set->obstacles;
    set->def.groups = set->groups;
    if (set->obstacles == NULL || set->groups == NULL)
        return pel_fail_memory(error);
    memcpy(set->groups, def->groups, group_count * sizeof *set->groups);
    for (size_t i = 0; i < obstacle_count; i++)
        set->obstacles[i] = def->obstacles[i];
    pel_contact_set_measure_groups(set);
    const pel_travel_def travel = {def->vertex_count, def->body_count, def->body_of_slice, def->mass};
    return pel_travel_create(&travel, &set->travel, error);
}

pel_status pel_contact_set_create(const pel_contact_set_def *def, pel_contact_set **set, pel_error *error)
{
    *set = pel_allocate(1, sizeof **set);
    if (*set == NULL)
        return pel_fail_memory(error);
    pel_status status = copy_def(*set, def, error);
    return status == PEL_OK ? pel_contact_surface_create(*set, error) : status;
}

void pel_contact_set_destroy(pel_contact_set *set)
{
    if (set == NULL)
        return;
    pel_collider_destroy(set->collider);
    PEL_FREE_ALL(set->obstacles, set->groups, set->next_triangles, set->group_of_point, set->may_meet, set->is_asleep,
                 set->start, set->end, set->shape, set->is_fan, set->known.items, set->known.begins[0],
                 set->known.begins[1], set->bend, set->is_stray, set->home, set->substep_start, set->substep_end,
                 set->list.contacts, set->keys, set->other_keys, set->calm, set->watches, set->acts, set->active,
                 set->origins, set->owed, set->other_contacts, set->heights.list.contacts, set->heights.triangles,
                 set->heights.bounds, set->heights.places, set->heights.parts, set->conflicts, set->impacts,
                 set->solved, set->zones, set->rings, set->wanted, set->rigid_wanted, set->tangles.pairs,
                 set->tangles.keys, set->body_shares, set->body_impacts, set->balls, set->ball_order, set->ball_pairs,
                 set->joined);
    pel_contact_patches_clear(&set->patches);
    pel_travel_destroy(&set->travel);
    pel_free(set);
}

/* ---- records ---- */

/* a record from a pair and where it meets; false when none of its points can move */
static bool make_contact(const pel_contact_set *set, const pel_collision *pair, const pel_ccd_hit *hit,
                         pel_contact *contact)
{
    PEL_ASSERT_INDEX(pair->vertices[0], set->point_count);
    PEL_ASSERT_INDEX(pair->vertices[3], set->point_count);
    /* points 0 and 3 are of either side */
    const int32_t *group = set->group_of_point;
    double separation = pel_contact_pair_thickness(set, pair->vertices) + pel_contact_pair_radius(set, pair->vertices);
    double free = 0;
    double friction = pel_contact_friction(set, group[pair->vertices[0]], group[pair->vertices[3]]);
    *contact = (pel_contact){.friction = (pel_real)friction};
    double drift[3] = {0, 0, 0};
    for (int i = 0; i < 4; i++) {
        int32_t point = pair->vertices[i];
        double weight = hit->weight[i], way[3];
        if (point < set->vertex_count) {
            contact->vertices[i] = point;
            contact->weights[i] = (pel_real)weight;
            free += (double)set->def.inverse_mass[point] * weight * weight;
            continue;
        }
        separation -= weight * pel_vec3_dot(set->end[point], hit->normal);
        pel_vec3_subtract(set->end[point], set->start[point], way);
        pel_vec3_along(drift, -weight, way, drift);
    }
    contact->separation = (pel_real)separation;
    for (int k = 0; k < 3; k++) {
        contact->normal[k] = (pel_real)hit->normal[k];
        contact->drift[k] = (pel_real)drift[k];
    }
    return free > 0 && pel_vec3_squared_length(hit->normal) > 0.5;
}

static pel_contact_key make_key(const pel_contact_set *set, const pel_collision *hit)
{
    pel_contact_key key = {.edge_edge = hit->edge_edge,
                           .first = hit->first,
                           .second = hit->second,
                           .obstacle = -1,
                           .border = PEL_NO_BORDER};
    memcpy(key.points, hit->vertices, sizeof key.points);
    memcpy(key.place, hit->hit.weight, sizeof key.place);
    for (int i = 0; i < 4 && key.obstacle < 0; i++)
        key.obstacle = pel_contact_obstacle_of(set, hit->vertices[i]);
    return key;
}

/* the order of a key and of the pair of two features */
static inline int compare_pair(const pel_contact_key *a, bool edge_edge, int32_t first, int32_t second)
{
    if (a->edge_edge != edge_edge)
        return a->edge_edge ? 1 : -1;
    if (a->first != first)
        return a->first < first ? -1 : 1;
    return (a->second > second) - (a->second < second);
}

static int compare_keys(const pel_contact_key *a, const pel_contact_key *b)
{
    return compare_pair(a, b->edge_edge, b->first, b->second);
}

/* Room in an array of scratch: it does not keep what is in it, so that only what is used then takes pages. */
static bool reserve_anew(void **array, size_t *capacity, size_t needed, size_t size)
{
    if (needed <= *capacity)
        return true;
    pel_free(*array);
    *array = NULL;
    *capacity = 0;
    return pel_reserve(array, capacity, needed, size);
}

/* for so many pairs at most in the merged list */
static pel_status make_room(pel_contact_set *set, size_t count, pel_error *error)
{
    if (reserve_anew((void **)&set->other_contacts, &set->other_capacity, count, sizeof *set->other_contacts) &&
        reserve_anew((void **)&set->other_keys, &set->other_key_capacity, count, sizeof *set->other_keys) &&
        reserve_anew((void **)&set->origins, &set->origin_capacity, count, sizeof *set->origins))
        return PEL_OK;
    return pel_fail_memory(error);
}

/* what substeps note of so many pairs; looks at those before them are kept */
static pel_status make_room_for_looks(pel_contact_set *set, size_t count, pel_error *error)
{
    if (pel_reserve((void **)&set->calm, &set->calm_capacity, count, sizeof *set->calm) &&
        pel_reserve((void **)&set->watches, &set->watch_capacity, count, sizeof *set->watches) &&
        pel_reserve((void **)&set->acts, &set->act_capacity, count, sizeof *set->acts) &&
        pel_reserve((void **)&set->active, &set->active_capacity, count, sizeof *set->active) &&
        pel_reserve((void **)&set->owed, &set->owed_capacity, count, sizeof *set->owed) &&
        pel_contact_patches_expect(&set->patches, &set->list, count))
        return PEL_OK;
    return pel_fail_memory(error);
}

bool pel_contact_set_expect(pel_contact_set *set, int32_t count)
{
    size_t needed = (size_t)count;
    set->list.count = set->list.active_count = 0;
    set->list.active = NULL;
    return pel_reserve((void **)&set->list.contacts, &set->capacity, needed, sizeof *set->list.contacts) &&
           pel_reserve((void **)&set->keys, &set->key_capacity, needed, sizeof *set->keys) &&
           make_room(set, needed, NULL) == PEL_OK && make_room_for_looks(set, needed, NULL) == PEL_OK;
}

/* upper bound of the margin [m] */
static double most_margin(const pel_contact_set *set)
{
    return pel_max(MOST_MARGIN * set->def.shortest_edge, LEAST_MARGIN * set->largest);
}

bool pel_contact_set_restore(pel_contact_set *set)
{
    double least = LEAST_MARGIN * set->largest;
    bool is_whole = set->margin >= least && set->margin <= most_margin(set) && set->horizon > 0 && set->horizon <= 1;
    for (int32_t c = 0; is_whole && c < set->list.count; c++) {
        const pel_contact_key *key = &set->keys[c];
        is_whole = key->load >= 0 && key->earlier >= 0 && key->slack >= 0 &&
                   isfinite(key->load + key->earlier + key->slack) &&
                   isfinite(key->drag[0] + key->drag[1] + key->drag[2]) && set->list.contacts[c].compliance >= 0 &&
                   (c == 0 || compare_keys(key - 1, key) < 0);
    }
    for (int32_t p = 0; is_whole && set->has_home && p < set->point_count; p++)
        is_whole = isfinite(set->home[p][0] + set->home[p][1] + set->home[p][2]);
    if (is_whole)
        return true;
    set->has_home = false;
    set->list.count = 0;
    set->margin = least;
    set->horizon = 1;
    return false;
}

bool pel_contact_set_take_over(pel_contact_set *set, const pel_contact_set *from)
{
    size_t count = (size_t)from->list.count;
    if (!pel_contact_set_expect(set, from->list.count))
        return false;
    set->has_home = false;
    set->list.count = from->list.count;
    if (count > 0) {
        memcpy(set->keys, from->keys, count * sizeof *set->keys);
        memcpy(set->list.contacts, from->list.contacts, count * sizeof *set->list.contacts);
    }
    set->margin = pel_min(pel_max(from->margin, LEAST_MARGIN * set->largest), most_margin(set));
    set->was_widened = from->was_widened;
    set->horizon = from->horizon;
    return true;
}

/* adds what a pair carries to another one, whose first side is this one's, 1, or the other, -1 */
static void add_load(const pel_contact_key *from, double side, pel_contact_key *to)
{
    to->load += from->load;
    to->earlier += from->earlier;
    to->mean_load += from->mean_load;
    to->has_pushed |= from->has_pushed;
    pel_vec3_along(to->drag, side, from->drag, to->drag);
    pel_vec3_along(to->mean_drag, side, from->mean_drag, to->mean_drag);
}

/* the same of a pair with the same normal, within a substep */
static void add_multiplier(const pel_contact *from, pel_contact *to)
{
    to->multiplier += from->multiplier;
    to->earlier += from->earlier;
    for (int k = 0; k < 3; k++) {
        to->drag[k] += from->drag[k];
        to->stopped[k] += from->stopped[k];
    }
}

void pel_contact_set_sort(pel_contact_set *set)
{
    int32_t count = set->list.count > 0 ? 1 : 0;
    while (count < set->list.count && compare_keys(&set->keys[count - 1], &set->keys[count]) < 0)
        count++;
    if (count == set->list.count)
        return;
    set->list.active = NULL;
    for (int32_t c = count; c < set->list.count; c++) {
        const pel_contact_key key = set->keys[c];
        const pel_contact contact = set->list.contacts[c];
        int32_t at = count;
        while (at > 0 && compare_keys(&set->keys[at - 1], &key) > 0)
            at--;
        if (at > 0 && compare_keys(&set->keys[at - 1], &key) == 0) {
            add_load(&key, 1, &set->keys[at - 1]);
            add_multiplier(&contact, &set->list.contacts[at - 1]);
            continue;
        }
        for (int32_t i = count; i > at; i--) {
            set->keys[i] = set->keys[i - 1];
            set->list.contacts[i] = set->list.contacts[i - 1];
        }
        set->keys[at] = key;
        set->list.contacts[at] = contact;
        count++;
    }
    set->list.count = count;
}

/* the merged list becomes the list */
static void exchange_lists(pel_contact_set *set, int32_t count)
{
    PEL_ASSERT(count >= 0 && (size_t)count <= set->other_capacity);
    pel_contact *list = set->list.contacts;
    pel_contact_key *keys = set->keys;
    size_t capacity = set->capacity, key_capacity = set->key_capacity;
    set->list = (pel_contact_list){
        .contacts = set->other_contacts, .count = count, .substep = set->list.substep, .rigids = set->def.rigids};
    set->keys = set->other_keys;
    set->capacity = set->other_capacity;
    set->key_capacity = set->other_key_capacity;
    set->other_contacts = list;
    set->other_keys = keys;
    set->other_capacity = capacity;
    set->other_key_capacity = key_capacity;
}

/* a pair of the merged list that stands for the triangles around a corner */
typedef struct merged_ring {
    int32_t at;
    int count;
    int32_t triangles[PEL_RING_LIMIT]; /* (count) */
    bool is_known;                     /* one of its pairs was in the list */
    int32_t corner;
} merged_ring;

/* rings of a vertex; pairs with triangles in others stand alone */
enum { MOST_RINGS = 4 };

/* what was found on its way into the list */
typedef struct merger {
    pel_contact_set *set;
    const pel_timed_hit *impacts; /* of conflicts among what was found; null = not looked for */
    double obstacle_reach;        /* m, obstacles that are farther away at the start count only by their faces */
    bool is_anew;                 /* drop contacts that are not found again */
    bool is_again;                /* in a step: what was known stays as it was */
    const uint8_t *sought;        /* groups one of which is of every pair that was looked for; null = all */
    bool is_same;                 /* the list of an earlier step: nothing moves by more than HOME_SLIDE */
    int32_t old, count;           /* contacts of the list that were taken over, contacts of the merged list */
    /* pairs of the vertex that was added last which stand for rings of triangles: */
    int32_t vertex;
    int ring_count;
    merged_ring rings[MOST_RINGS];
} merger;

/* whether a pair would have been found again, if it were still there */
static bool is_sought(const merger *m, const pel_contact_key *key)
{
    const int32_t *group = m->set->group_of_point;
    return m->sought == NULL || m->sought[group[key->points[0]]] || m->sought[group[key->points[3]]];
}

/* takes over what comes before a pair, all when it is null; true when the next one is of this pair */
static bool take_over(merger *m, const pel_collision *pair)
{
    pel_contact_set *set = m->set;
    PEL_ASSERT(m->old >= 0 && m->old <= set->list.count);
    for (; m->old < set->list.count; m->old++) {
        int order = pair != NULL ? compare_pair(&set->keys[m->old], pair->edge_edge, pair->first, pair->second) : -1;
        if (order >= 0)
            return order == 0;
        if (m->is_anew && !pel_contact_sleeps(set, set->keys[m->old].points) && is_sought(m, &set->keys[m->old]))
            continue;
        set->origins[m->count] = m->old;
        set->other_keys[m->count] = set->keys[m->old];
        set->other_contacts[m->count++] = set->list.contacts[m->old];
    }
    return false;
}

/* a vertex right before the inner part of a triangle */
static bool is_before_face(const pel_collision *pair)
{
    const double *w = pair->hit.weight;
    return !pair->edge_edge && pel_max(w[1], pel_max(w[2], w[3])) < -1e-6;
}

/* mean mass of the points of one side that can move [kg]; 0 = none can */
static double side_mass(const pel_contact_set *set, const pel_collision *pair, int begin, int end)
{
    double mass = 0;
    int count = 0;
    for (int i = begin; i < end; i++) {
        int32_t point = pair->vertices[i];
        if (point >= set->vertex_count || !(set->def.inverse_mass[point] > 0))
            continue;
        const pel_rigid *rigid = pel_rigid_of(set->def.rigids, point);
        mass += rigid != NULL ? rigid->shape->mass : (double)set->def.mass[point];
        count++;
    }
    return count > 0 ? mass / count : 0;
}

/* of the weaker side, and low enough to stop the approach in this step */
static double compliance_of(const pel_contact_set *set, const pel_collision *pair, double thickness)
{
    int middle = pair->edge_edge ? 2 : 1;
    double compliance = 0, approach = 0, share = pel_contact_pair_share(set, pair->vertices);
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 3; k++)
            approach -= pair->hit.weight[i] * pair->hit.normal[k] *
                        (set->end[pair->vertices[i]][k] - set->start[pair->vertices[i]][k]);
    double speed = approach > 0 ? approach / set->time : 0;
    for (int side = 0; side < 2; side++) {
        double mass = side_mass(set, pair, side == 0 ? 0 : middle, side == 0 ? middle : 4);
        const pel_contact_group *group = &set->groups[set->group_of_point[pair->vertices[3 * side]]];
        /* a thinner layer is stiffer */
        const pel_contact_layer layer = {thickness, group->hardness / share};
        double own = mass > 0 ? pel_contact_layer_compliance(&layer, mass, speed, set->dt) : 0;
        compliance = own > compliance ? own : compliance;
    }
    return compliance;
}

/* what a pair that was known keeps */
static void keep_old(const pel_contact *old, const pel_contact_key *own, pel_contact *contact, pel_contact_key *key)
{
    contact->multiplier = old->multiplier;
    memcpy(contact->drag, old->drag, sizeof contact->drag);
    memcpy(contact->stopped, old->stopped, sizeof contact->stopped);
    key->has_pushed = own->has_pushed;
    key->mean_load = own->mean_load;
    pel_vec3_copy(own->mean_drag, key->mean_drag);
    key->slack = own->slack;
    key->load = own->load;
    key->earlier = own->earlier;
    pel_vec3_copy(own->drag, key->drag);
}

/* m, by how much a pair may be farther apart than corrections bring it */
static double beyond_aim(const pel_contact_set *set, const pel_contact_key *key)
{
    double allowed = pel_contact_pair_thickness(set, key->points) - key->slack;
    double aim = pel_contact_pair_share(set, key->points) * set->aim;
    return allowed > aim ? allowed - aim : 0;
}

/* m, at `start`, of a pair that was found */
static double start_distance(const merger *m, const pel_collision *pair)
{
    double way[3] = {0, 0, 0};
    if (m->impacts != NULL || !m->set->def.has_layers)
        return pel_contact_start_distance(m->set, pair);
    /* the search has measured it */
    for (int i = 0; i < 4; i++)
        pel_vec3_along(way, pair->hit.weight[i], m->set->start[pair->vertices[i]], way);
    return pel_vec3_length(way) - pel_contact_pair_radius(m->set, pair->vertices);
}

/* the corner of a triangle that its vertex is before at `start`, so nearly that it stays before it while all is near
   its home, PEL_NO_BORDER = none */
static int32_t corner_of(const pel_contact_set *set, const pel_collision *pair)
{
    const double(*x)[3] = (const double(*)[3])set->start;
    const int32_t *v = pair->vertices;
    double most = CORNER_SHARE * set->finest, place[3] = {0, 0, 0};
    for (int i = 1; i < 4; i++)
        pel_vec3_along(place, -pair->hit.weight[i], x[v[i]], place);
    for (int i = 1; i < 4; i++)
        if (pel_vec3_distance(place, x[v[i]]) <= most)
            return v[i];
    return PEL_NO_BORDER;
}

/* the end of the merged pairs of a vertex: all before it are of vertices up to this one */
static int32_t end_of_vertex(const merger *m, int32_t vertex)
{
    int32_t begin = 0, end = m->count;
    while (begin < end) {
        int32_t middle = begin + (end - begin) / 2;
        if (m->set->other_keys[middle].first <= vertex)
            begin = middle + 1;
        else
            end = middle;
    }
    return begin;
}

/* the merged pair of a vertex before a triangle, at the corner `corner`; null = there is none */
static pel_contact_key *pair_at_corner(const merger *m, int32_t vertex, int32_t corner)
{
    for (int32_t i = end_of_vertex(m, vertex) - 1; i >= 0 && m->set->other_keys[i].first == vertex; i--)
        if (m->set->other_keys[i].border == corner)
            return &m->set->other_keys[i];
    return NULL;
}

/* A vertex at rest before a corner that it is before in another triangle too, or that has a pair with it from the other
   side: one of them is enough, and takes the load. What slides needs all of them. */
static bool is_again(merger *m, const pel_collision *pair, pel_contact_key *key)
{
    const pel_contact_set *set = m->set;
    if (!m->is_same || pair->edge_edge || pel_contact_pair_radius(set, pair->vertices) > 0)
        return false;
    key->border = corner_of(set, pair);
    if (key->border < 0)
        return false;
    pel_contact_key *twin = pair_at_corner(m, key->first, key->border);
    double side = 1;
    if (twin == NULL && key->border < key->first) {
        twin = pair_at_corner(m, key->border, key->first);
        side = -1;
    }
    if (twin != NULL && take_over(m, pair))
        add_load(&set->keys[m->old++], side, twin);
    return twin != NULL;
}

/* pairs of a vertex stand for the triangles around the corners that it is nearest to; a ball may touch several */
static bool makes_rings(const merger *m, const pel_collision *pair)
{
    const pel_contact_set *set = m->set;
    return set->def.has_layers && (m->is_anew || m->is_again) && !m->is_same && !pair->edge_edge &&
           set->tangles.count == 0 && set->def.origin_of_vertex == NULL &&
           !(pel_contact_pair_radius(set, pair->vertices) > 0);
}

/* the ring of a pair that stands for this one; null = there is none */
static merged_ring *ring_with(merger *m, const pel_collision *pair)
{
    if (!makes_rings(m, pair))
        return NULL;
    if (m->vertex != pair->first)
        m->ring_count = 0;
    m->vertex = pair->first;
    for (int r = 0; r < m->ring_count; r++)
        for (int i = 0; i < m->rings[r].count; i++)
            if (m->rings[r].triangles[i] == pair->second)
                return &m->rings[r];
    return NULL;
}

/* A pair that the one of a ring stands for, which takes its load; false = it is the first of them that was known, and
   is to stand for the ring. Slack is that of known pairs, if there are any: others are new because they slid there. */
static bool is_in_ring(merger *m, const pel_collision *pair, merged_ring *ring, double slack)
{
    pel_contact_set *set = m->set;
    pel_contact_key *twin = &set->other_keys[ring->at];
    bool is_known = take_over(m, pair);
    if (!is_known && !ring->is_known)
        twin->slack = pel_max(twin->slack, slack);
    if (!is_known || !ring->is_known)
        return !is_known;
    twin->slack = pel_max(twin->slack, set->keys[m->old].slack);
    const pel_contact *old = &set->list.contacts[m->old];
    pel_contact *contact = &set->other_contacts[ring->at];
    if (set->keys[m->old].load > 0 && old->compliance < contact->compliance)
        contact->compliance = old->compliance;
    add_load(&set->keys[m->old++], 1, twin);
    return true;
}

/* the pair that was merged last stands for the triangles around the corner that its vertex is nearest to */
static void add_ring(merger *m, const pel_collision *pair, bool is_known)
{
    pel_contact_key *key = &m->set->other_keys[m->count - 1];
    merged_ring *ring = &m->rings[m->ring_count];
    uint8_t nearest = 1;
    for (uint8_t i = 2; i < 4; i++)
        nearest = pair->hit.weight[i] < pair->hit.weight[nearest] ? i : nearest;
    ring->at = m->count - 1;
    ring->is_known = is_known;
    ring->corner = key->points[nearest];
    ring->count = pel_contact_smooth_ring(m->set, key->second, ring->corner, key->first, ring->triangles);
    if (ring->count == 0)
        return;
    m->ring_count++;
    key->ring = nearest;
}

/* the pair that was merged last, which was known, stands for a ring in place of the one that did */
static void take_ring(merger *m, merged_ring *ring)
{
    pel_contact_set *set = m->set;
    int32_t at = ring->at, last = m->count - 1;
    size_t after = (size_t)(last - at);
    pel_contact_key *keys = set->other_keys + at;
    memmove(keys, keys + 1, after * sizeof *keys);
    memmove(set->other_contacts + at, set->other_contacts + at + 1, after * sizeof *set->other_contacts);
    memmove(set->origins + at, set->origins + at + 1, after * sizeof *set->origins);
    for (int r = 0; r < m->ring_count; r++)
        m->rings[r].at -= m->rings[r].at > at;
    m->count = last;
    ring->at = last - 1;
    ring->is_known = true;
    for (uint8_t i = 1; i < 4; i++)
        if (set->other_keys[ring->at].points[i] == ring->corner)
            set->other_keys[ring->at].ring = i;
}

/* of the pair that was merged last: of a ring that it takes, or of one of its own */
static void find_ring(merger *m, const pel_collision *pair, bool is_known, merged_ring *ring)
{
    if (ring != NULL)
        take_ring(m, ring);
    else if (makes_rings(m, pair) && m->ring_count < MOST_RINGS)
        add_ring(m, pair, is_known);
}

/* m, slack of a conflict that was known: a pair that was found within the step, nearer than the guard permits, has more
   than brings it back to where corrections end. fresh [m]: by the start of the step. */
static double slack_of_conflict(const pel_contact_set *set, const pel_contact_key *key, double fresh)
{
    double thickness = pel_contact_pair_thickness(set, key->points);
    double aim = pel_contact_pair_share(set, key->points) * set->aim;
    return pel_min(key->slack, pel_max(fresh, thickness - aim));
}

/* Whether nothing but corrections after the solver parts what is nearer than its thickness. The guard lets a pair come
   nearer by 1 % in each step: a fold that stayed as near as it began would shut, and jam. */
static bool comes_apart(const merger *m)
{
    return m->impacts != NULL && !m->set->def.has_layers && !(m->set->aim < HUGE_VAL);
}

/* A pair that was known stays as it was, but for what follows from its approach, and for its ring. */
static void add_known(merger *m, const pel_collision *pair, double thickness, merged_ring *ring)
{
    pel_contact_set *set = m->set;
    pel_contact_key *key = &set->other_keys[m->count];
    pel_contact *contact = &set->other_contacts[m->count];
    set->origins[m->count++] = m->old;
    *key = set->keys[m->old];
    *contact = set->list.contacts[m->old++];
    key->ring = 0;
    double compliance = compliance_of(set, pair, thickness);
    if (!(key->load > 0) || compliance < (double)contact->compliance)
        contact->compliance = (pel_real)compliance;
    find_ring(m, pair, true, ring);
}

/* update the contact's location and keep its loads; a time-of-impact location is kept */
static void add_found(merger *m, const pel_collision *pair, int64_t number)
{
    pel_contact_set *set = m->set;
    if (pel_contact_sleeps(set, pair->vertices))
        return;
    double start = start_distance(m, pair);
    double thickness = pel_contact_pair_thickness(set, pair->vertices);
    double fresh = thickness > start ? thickness - start : 0;
    merged_ring *ring = ring_with(m, pair);
    if (ring != NULL && is_in_ring(m, pair, ring, fresh))
        return;
    pel_contact_key key = make_key(set, pair);
    key.is_impact = m->impacts != NULL && m->impacts[number].hit.time_of_impact <= 1;
    key.slack = comes_apart(m) ? (1 - REGAIN) * fresh : fresh;
    if (m->is_same)
        key.ring = set->keys[number].ring;
    if (is_again(m, pair, &key))
        return;
    if (key.is_impact)
        memcpy(key.place, m->impacts[number].hit.weight, sizeof key.place);
    if (key.obstacle >= 0 && !is_before_face(pair) && start > m->obstacle_reach)
        return;
    bool known = take_over(m, pair);
    if (known && m->is_again) {
        add_known(m, pair, thickness, ring);
        return;
    }
    pel_contact contact;
    if (known && set->keys[m->old].is_impact && !key.is_impact && !m->is_anew)
        return;
    if (!make_contact(set, pair, key.is_impact ? &m->impacts[number].hit : &pair->hit, &contact))
        return;
    contact.compliance = (pel_real)compliance_of(set, pair, thickness);
    if (known) {
        const pel_contact *old = &set->list.contacts[m->old];
        keep_old(old, &set->keys[m->old], &contact, &key);
        if (!set->def.has_layers)
            pel_contact_keep_push(&contact, old->normal);
        if (key.is_impact && set->def.has_layers)
            key.slack = slack_of_conflict(set, &key, fresh);
        /* a layer that carries a load is as hard as it was */
        if (key.load > 0 && old->compliance < contact.compliance)
            contact.compliance = old->compliance;
        m->old++;
    } else if (set->list.count - m->old + m->count >= set->def.limit) {
        /* those that are known have room */
        set->statistics.dropped++;
        return;
    }
    if (key.is_impact)
        contact.separation -= (pel_real)(key.slack + beyond_aim(set, &key));
    set->origins[m->count] = -1;
    set->other_keys[m->count] = key;
    set->other_contacts[m->count++] = contact;
    find_ring(m, pair, known, ring);
}

/* puts what was found into the list */
static pel_status merge(merger *m, const pel_collision_result *found, pel_error *error)
{
    pel_contact_set *set = m->set;
    pel_status status = make_room(set, (size_t)set->list.count + (size_t)found->collision_count, error);
    if (status != PEL_OK)
        return status;
    for (int64_t i = 0; i < found->collision_count; i++)
        if (set->tangles.count == 0 || !pel_tangles_have(set, &found->collisions[i]))
            add_found(m, &found->collisions[i], i);
    take_over(m, NULL);
    status = make_room_for_looks(set, (size_t)m->count, error);
    if (status != PEL_OK)
        return status;
    exchange_lists(set, m->count);
    PEL_ASSERT_WHOLE(pel_contact_set_is_valid(set));
    return PEL_OK;
}

/* ---- search ---- */

void pel_contact_set_calm(pel_contact_set *set)
{
    for (int32_t c = 0; c < set->list.count; c++) {
        set->keys[c].has_pushed = false;
        set->keys[c].mean_load = 0;
        memset(set->keys[c].mean_drag, 0, sizeof set->keys[c].mean_drag);
    }
}

bool pel_contact_set_widen(pel_contact_set *set)
{
    double most = MOST_MARGIN * set->def.shortest_edge, twice = 2 * set->margin;
    bool grows = set->margin < most;
    if (grows)
        set->margin = twice < most ? twice : most;
    set->was_widened = true;
    set->has_home = false;
    return grows;
}

void pel_contact_set_narrow(pel_contact_set *set)
{
    double least = LEAST_MARGIN * set->largest, half = 0.5 * set->margin;
    if (!set->was_widened)
        set->margin = half > least ? half : least;
    set->was_widened = false;
}

/* whether features have these numbers: those of a snapshot may not */
static bool is_of_surface(const pel_contact_set *set, const pel_contact_key *key)
{
    int32_t edges = 3 * set->triangle_count;
    return key->first >= 0 && key->first < (key->edge_edge ? edges : set->point_count) && key->second >= 0 &&
           key->second < (key->edge_edge ? edges : set->triangle_count + set->ball_count);
}

double pel_contact_set_home_reach(const pel_contact_set *set)
{
    return pel_min(HOME_SHARE * set->margin, HOME_SLIDE * set->finest);
}

bool pel_contact_set_serves(const pel_contact_set *set)
{
    double limit = pel_contact_set_home_reach(set), most = 0;
    for (int32_t c = 0; set->has_home && c < set->list.count; c++)
        if (!is_of_surface(set, &set->keys[c]))
            return false;
    for (int32_t p = 0; set->has_home && p < set->point_count && most <= limit; p++) {
        double from_start = pel_vec3_distance(set->start[p], set->home[p]);
        double from_end = pel_vec3_distance(set->end[p], set->home[p]);
        most = pel_max(most, pel_max(from_start, from_end));
    }
    bool is_wide = set->margin > LEAST_MARGIN * set->largest && most <= 0.5 * limit;
    return set->has_home && most <= limit && !is_wide;
}

/* a pair of the list as a search would give it */
static pel_collision pair_of(const pel_contact_set *set, const pel_contact_key *key)
{
    const pel_tree *tree = pel_collider_tree(set->collider);
    pel_collision pair = {.edge_edge = key->edge_edge, .first = key->first, .second = key->second};
    if (key->edge_edge) {
        pel_tree_edge_ends(tree, key->first, pair.vertices);
        pel_tree_edge_ends(tree, key->second, pair.vertices + 2);
    } else {
        pair.vertices[0] = key->first;
        for (int i = 0; i < 3; i++)
            pair.vertices[1 + i] = key->second < set->triangle_count ? tree->triangles[key->second][i]
                                                                     : pel_contact_ball_point(set, key->second);
    }
    pel_contact_measure_start(set, &pair);
    return pair;
}

pel_status pel_contact_set_find_same(pel_contact_set *set, double time, pel_error *error)
{
    double began = pel_seconds();
    set->time = time;
    set->substep = 0;
    set->was_clear = false;
    pel_status status = make_room(set, 2 * (size_t)set->list.count, error);
    if (status != PEL_OK)
        return status;
    set->full_count = 0;
    merger m = {.set = set, .obstacle_reach = HUGE_VAL, .is_anew = true, .is_same = true, .vertex = -1};
    for (int32_t c = 0; c < set->list.count; c++) {
        if (pel_contact_sleeps(set, set->keys[c].points))
            continue;
        pel_collision pair = pair_of(set, &set->keys[c]);
        add_found(&m, &pair, c);
    }
    take_over(&m, NULL);
    exchange_lists(set, m.count);
    PEL_ASSERT_WHOLE(pel_contact_set_is_valid(set));
    set->statistics.find_seconds += pel_seconds() - began;
    return PEL_OK;
}

pel_status pel_contact_set_find(pel_contact_set *set, double least, double time, pel_error *error)
{
    set->time = time;
    set->substep = 0;
    if (!set->def.has_layers)
        set->list.count = 0;
    set->was_clear = false;
    double reach =
        set->def.has_layers ? set->largest + set->margin : pel_contact_search_reach(set, pel_contact_longest_way(set));
    pel_collision_result found;
    pel_status status = pel_contact_search(set, pel_max(least, reach), set->def.has_layers, &found, error);
    /* what slides along the edges between the flat triangles of an obstacle must not run into them */
    merger m = {.set = set, .obstacle_reach = least > reach ? reach : HUGE_VAL, .is_anew = true, .vertex = -1};
    if (status == PEL_OK)
        status = merge(&m, &found, error);
    set->has_home = status == PEL_OK && set->def.has_layers;
    set->full_count = set->has_home ? set->list.count : 0;
    if (set->has_home)
        memcpy(set->home, set->end, (size_t)set->point_count * sizeof *set->home);
    return status;
}

/* layers of pairs that were known and approach faster now */
static void harden(pel_contact_set *set)
{
    for (int32_t c = 0; c < set->list.count; c++) {
        const pel_contact_key *key = &set->keys[c];
        pel_contact *contact = &set->list.contacts[c];
        if (pel_contact_sleeps(set, key->points))
            continue;
        pel_collision pair = {.edge_edge = key->edge_edge};
        memcpy(pair.vertices, key->points, sizeof pair.vertices);
        memcpy(pair.hit.weight, key->place, sizeof pair.hit.weight);
        for (int k = 0; k < 3; k++)
            pair.hit.normal[k] = (double)contact->normal[k];
        double compliance = compliance_of(set, &pair, pel_contact_pair_thickness(set, key->points));
        if (!(key->load > 0) || compliance < (double)contact->compliance)
            contact->compliance = (pel_real)compliance;
    }
}

pel_status pel_contact_set_find_again(pel_contact_set *set, const uint8_t *sought, double time, pel_error *error)
{
    set->time = time;
    set->substep = 0;
    set->was_clear = false;
    pel_collision_result found;
    bool keeps = sought == NULL && set->list.count < MOST_KEPT * set->full_count;
    pel_status status = keeps ? pel_contact_list_known(set, error) : PEL_OK;
    set->known.is_used = keeps;
    pel_collider_seek(set->collider, sought);
    if (status == PEL_OK)
        status = pel_contact_search(set, set->largest + set->margin, true, &found, error);
    pel_collider_seek(set->collider, NULL);
    set->known.is_used = false;
    merger m = {
        .set = set, .sought = sought, .obstacle_reach = HUGE_VAL, .is_anew = !keeps, .is_again = true, .vertex = -1};
    if (keeps)
        harden(set);
    if (status == PEL_OK)
        status = merge(&m, &found, error);
    if (!keeps && sought == NULL)
        set->full_count = status == PEL_OK ? set->list.count : 0;
    set->has_home = status == PEL_OK;
    if (set->has_home)
        memcpy(set->home, set->end, (size_t)set->point_count * sizeof *set->home);
    return status;
}

pel_status pel_contact_set_add_way(pel_contact_set *set, const pel_collision_result *found, pel_error *error)
{
    merger m = {.set = set, .impacts = set->impacts, .obstacle_reach = HUGE_VAL, .vertex = -1};
    set->has_home = false;
    set->statistics.rounds++;
    /* pairs have gone to other triangles since their loads were kept */
    pel_contact_set_sort(set);
    return merge(&m, found, error);
}

void pel_contact_set_mark(const pel_contact_set *set, uint8_t *flags)
{
    const pel_contact_list *list = &set->list;
    for (int32_t c = 0; c < list->count; c++)
        for (int i = 0; i < 4 && (list->contacts[c].multiplier > 0 || set->keys[c].has_pushed); i++)
            if (list->contacts[c].weights[i] != 0)
                flags[list->contacts[c].vertices[i]] = 1;
}

/* ---- correction ---- */

void pel_contact_set_correct(pel_contact_set *set, const pel_contact_motion *motion, int32_t sweeps)
{
    double tolerance = SWEEP_TOLERANCE * set->finest;
    for (int32_t i = 0; i < set->def.obstacle_count; i++)
        set->obstacles[i].substep = set->obstacles[i].before;
    pel_contact_set_place_substep(set);
    set->substep++;
    pel_contact_set_refresh(set, motion->next, motion->position, true, true);
    for (int32_t c = 0; c < set->list.count; c++)
        if (!set->keys[c].is_impact)
            set->list.contacts[c].separation -= (pel_real)beyond_aim(set, &set->keys[c]);
    /* rigid: a compliance over an infinite substep vanishes */
    double substep = set->list.substep;
    set->list.substep = HUGE_VAL;
    pel_contacts_rouse(&set->list, -1);
    /* velocities are corrected by themselves, below */
    if (set->def.rigids != NULL)
        set->def.rigids->rate = 0;
    for (int32_t i = 0; i < sweeps; i++)
        if (pel_contacts_project(&set->list, motion->next, motion->position) < tolerance)
            break;
    pel_rigids_place(set->def.rigids, motion->next);
    set->list.substep = substep;
    set->way_is_searched = false;
    for (int32_t p = 0; p < set->vertex_count; p++)
        pel_vertex_position(motion->next, p, set->end[p]);
    if (motion->velocity != NULL)
        pel_contacts_stop(&set->list, motion->next, motion->velocity, motion->dt, VELOCITY_SWEEPS);
}
