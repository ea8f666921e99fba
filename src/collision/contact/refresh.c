/* Pairs in the substeps of position-based methods: where they touch follows the present positions.

   A vertex before the inside of a triangle is kept off along the triangle's normal, one before its border along the
   direction to the closest point; two edges along their common normal. The closest point of an edge is that of the
   whole surface only if the direction from it leads away from both its triangles: n . t <= 0 for the unit vectors t
   that point from the edge into them. Other pairs are off, for there the triangle itself is closer: on flat and concave
   surfaces edges are no bumps. Edges touch where the closest points lie inside both; their ends are vertices.

   The side on which a pair touches is that of the start of the substep in which its closest points came to lie inside
   both features; from then on the normal is followed. */
#include "contact/layer.h"
#include "contact/set.h"
#include "geom/wide4.h"
#include "math/extremes.h"
#include "sweep/sweep.h"

#include <string.h>

enum { PAIRS_OF_CHUNK = 256, BYTES_OF_LINE = 64 };

/* weights of closest points inside a feature are farther from 0 than this */
#define INSIDE 1e-9
/* sine of the angle below which edges count as parallel and have no common normal */
#define PARALLEL 1e-3
/* directions that lean so little over a triangle still lead away from it */
#define LEAN 0.05
/* of the thickness: two edges that are off, since other features are closer, have this much room before they are looked
   at again */
#define OFF_SHARE 0.1
/* of its room: a pair whose places moved less against each other need not be looked at, and then has as much room left;
   the rest is for turning features and for corrections within a substep */
#define MOVED_SHARE 0.25
/* of the thickness: near pairs keep weights and normal until points may have moved so far against each other */
#define KEEP_SHARE 0.01

void pel_contact_set_place_substep(pel_contact_set *set)
{
    for (int32_t i = 0; i < set->def.obstacle_count; i++) {
        const pel_obstacle *obstacle = &set->obstacles[i];
        int32_t first = obstacle->point_begin - set->vertex_count;
        pel_obstacle_points(obstacle, &obstacle->substep, set->substep_start + first);
        pel_obstacle_points(obstacle, &obstacle->pose, set->substep_end + first);
    }
}

/* the look at a pair stands where the pair stands now */
static void move_look(pel_contact_set *set, int32_t from, int32_t to)
{
    set->calm[to] = set->calm[from];
    set->watches[to] = set->watches[from];
    set->acts[to] = set->acts[from];
}

/* Pairs keep their order, so that nothing is written over before it has moved: first what goes forward, from the front
   on, then what goes back, from the end on. */
static void move_looks(pel_contact_set *set)
{
    const int32_t *from = set->origins, count = set->list.count;
    for (int32_t c = 0; c < count; c++)
        if (from[c] > c)
            move_look(set, from[c], c);
    for (int32_t c = count - 1; c >= 0; c--)
        if (from[c] >= 0 && from[c] < c)
            move_look(set, from[c], c);
}

static void expect_look(pel_contact_set *set, int32_t c)
{
    bool sleeps = pel_contact_sleeps(set, set->keys[c].points);
    set->calm[c] = sleeps ? HUGE_VAL : 0;
    set->acts[c] = !sleeps;
}

static void recall_multipliers(pel_contact_set *set, double substep)
{
    double square = substep * substep;
    pel_contacts_begin(&set->list, substep);
    set->list.active = NULL;
    for (int32_t c = 0; c < set->list.count; c++) {
        memset(set->owed[c], 0, sizeof set->owed[c]);
        pel_contact *contact = &set->list.contacts[c];
        contact->multiplier = (pel_real)(square * set->keys[c].load);
        contact->earlier = (pel_real)(square * set->keys[c].earlier);
        for (int k = 0; k < 3; k++)
            contact->drag[k] = (pel_real)(square * set->keys[c].drag[k]);
    }
}

void pel_contact_set_recall_loads(pel_contact_set *set, double substep)
{
    recall_multipliers(set, substep);
    pel_travel_restart(&set->travel);
    set->calm_until = 0;
    set->is_moved = set->moves = false;
    for (int32_t c = 0; c < set->list.count; c++)
        expect_look(set, c);
}

void pel_contact_set_recall_again(pel_contact_set *set, double substep, bool keeps_looks)
{
    if (!keeps_looks) {
        pel_contact_set_recall_loads(set, substep);
        return;
    }
    recall_multipliers(set, substep);
    move_looks(set);
    for (int32_t c = 0; c < set->list.count; c++)
        if (set->origins[c] < 0)
            expect_look(set, c);
}

void pel_contact_set_begin_substep(pel_contact_set *set, double substep)
{
    double ratio = substep / set->list.substep, square = ratio * ratio;
    set->substep++;
    set->elapsed += substep;
    pel_contact_set_place_substep(set);
    set->list.substep = substep;
    for (int32_t i = 0; ratio != 1 && i < pel_contact_list_length(&set->list); i++) {
        pel_contact *contact = pel_contact_list_at(&set->list, i);
        contact->multiplier *= (pel_real)square;
        contact->earlier *= (pel_real)square;
        for (int k = 0; k < 3; k++)
            contact->drag[k] *= (pel_real)square;
    }
}

/* m, present slack of a pair: reduce it evenly over the substeps, since a jump would turn into velocity */
static double slack_of(const pel_contact_set *set, const pel_contact_key *key)
{
    double gain = set->largest * set->elapsed / PEL_CONTACT_RECOVERY_TIME;
    return key->slack > gain ? key->slack - gain : 0;
}

void pel_contact_set_keep_loads(pel_contact_set *set)
{
    double rate = 1 / (set->list.substep * set->list.substep);
    for (int32_t c = 0; c < set->list.count; c++) {
        const pel_contact *contact = &set->list.contacts[c];
        pel_contact_key *key = &set->keys[c];
        if (pel_contact_sleeps(set, key->points))
            continue;
        key->load = rate * (double)contact->multiplier;
        key->earlier = rate * (double)contact->earlier;
        for (int k = 0; k < 3; k++)
            key->drag[k] = rate * (double)contact->drag[k];
        key->slack = slack_of(set, key);
    }
    set->elapsed = 0;
    pel_contact_set_sort(set);
}

typedef struct refresh_job {
    pel_contact_set *set;
    const pel_record *positions,
        *start; /* (vertex_count) now and at the start of the substep; null = at that of the step */
    bool looks_at_all, is_first;
} refresh_job;

static void load_point(const refresh_job *job, int32_t point, double x[3])
{
    const pel_contact_set *set = job->set;
    if (job->start == NULL)
        pel_vec3_copy(set->start[point], x);
    else if (point < set->vertex_count)
        pel_vertex_position(job->positions, point, x);
    else
        pel_vec3_copy(set->substep_end[point - set->vertex_count], x);
}

static bool has_point(const pel_contact_key *key, int32_t point)
{
    return key->points[0] == point || key->points[1] == point || key->points[2] == point || key->points[3] == point;
}

/* Whether a direction from an edge a, b leads away from both its triangles. A triangle that has a vertex of the pair
   makes no pair with it: where it collapses, the edge alone stops the pair. */
static bool leads_away(const refresh_job *job, const pel_contact_key *key, int32_t edge, const double a[3],
                       const double b[3], const double direction[3])
{
    const pel_tree *tree = pel_collider_tree(job->set->collider);
    double along[3], square;
    int32_t opposites[2];
    pel_tree_edge_opposites(tree, edge, opposites);
    pel_vec3_subtract(b, a, along);
    square = pel_vec3_squared_length(along);
    for (int i = 0; i < 2; i++) {
        double inward[3];
        if (opposites[i] < 0 || !(square > 0) || has_point(key, opposites[i]))
            continue;
        load_point(job, opposites[i], inward);
        pel_vec3_subtract(inward, a, inward);
        pel_vec3_along(inward, -pel_vec3_dot(inward, along) / square, along, inward);
        if (pel_vec3_dot(inward, direction) > LEAN * pel_vec3_length(inward))
            return false;
    }
    return true;
}

/* Whether the direction to a vertex before the border of a triangle leads away from the triangles across that border.
   The corner that a pair stands for is the nearest point of its ring. */
static bool leads_away_from_border(const refresh_job *job, const pel_contact_key *key, double x[4][3],
                                   const double w[3], const double direction[3])
{
    const pel_tree *tree = pel_collider_tree(job->set->collider);
    if (key->ring > 0 && w[key->ring % 3] <= INSIDE && w[(key->ring + 1) % 3] <= INSIDE)
        return true;
    for (int i = 0; i < 3; i++)
        if (w[(i + 2) % 3] <= INSIDE &&
            !leads_away(job, key, pel_tree_edge(tree, 3 * key->second + i), x[1 + i], x[1 + (i + 1) % 3], direction))
            return false;
    return true;
}

/* six times the signed volume of the points at the start of the substep: which side the pair is on */
static double start_volume(const refresh_job *job, const pel_contact_key *key)
{
    const pel_contact_set *set = job->set;
    double x[4][3], a[3], b[3], c[3], normal[3];
    for (int i = 0; i < 4; i++) {
        int32_t point = key->points[i];
        if (point < set->vertex_count)
            pel_vertex_position(job->start, point, x[i]);
        else
            pel_vec3_copy(set->substep_start[point - set->vertex_count], x[i]);
    }
    pel_vec3_subtract(x[key->edge_edge ? 1 : 2], x[key->edge_edge ? 0 : 1], a);
    pel_vec3_subtract(x[3], x[key->edge_edge ? 2 : 1], b);
    pel_vec3_subtract(x[0], x[key->edge_edge ? 2 : 1], c);
    pel_vec3_cross(a, b, normal);
    return pel_vec3_dot(normal, c);
}

/* turns the unit normal of two features, as it is computed from their points, to the side that the pair is on */
static void keep_side(const refresh_job *job, const pel_contact *contact, pel_contact_key *key, double normal[3])
{
    double side = 0;
    if (!key->has_side)
        side = start_volume(job, key);
    for (int k = 0; k < 3 && key->has_side; k++)
        side += normal[k] * (double)contact->normal[k];
    if (side < 0)
        pel_vec3_scale(normal, -1, normal);
    key->has_side = true;
}

/* what of a triangle the closest point with these weights lies on */
static int32_t border_of(const refresh_job *job, const pel_contact_key *key, const double w[3])
{
    for (int i = 0; i < 3; i++)
        if (w[(i + 1) % 3] <= INSIDE && w[(i + 2) % 3] <= INSIDE)
            return key->points[1 + i];
    for (int i = 0; i < 3; i++)
        if (w[(i + 2) % 3] <= INSIDE)
            return -2 - pel_tree_edge(pel_collider_tree(job->set->collider), 3 * key->second + i);
    return PEL_NO_BORDER;
}

/* the same of two balls, by their middles */
static void look_at_balls(double x[4][3], const pel_contact *contact, pel_contact_key *key, double weights[4],
                          double normal[3])
{
    double way[3], length;
    key->border = PEL_NO_BORDER;
    key->is_off = key->has_side = false;
    for (int i = 0; i < 4; i++)
        weights[i] = i == 0 ? 1 : i == 1 ? -1 : 0;
    for (int k = 0; k < 3; k++)
        normal[k] = (double)contact->normal[k];
    pel_vec3_subtract(x[0], x[1], way);
    length = pel_vec3_length(way);
    if (pel_vec3_dot(way, normal) > 0)
        pel_vec3_scale(way, 1 / length, normal);
}

/* weights and normal of a vertex before a triangle */
static void look_at_face(const refresh_job *job, double x[4][3], const pel_contact *contact, pel_contact_key *key,
                         double weights[4], double normal[3])
{
    double w[3], u[3], v[3], way[3], square = pel_closest_point_triangle(x[0], x[1], x[2], x[3], w);
    key->border = border_of(job, key, w);
    bool is_border = key->border != PEL_NO_BORDER;
    weights[0] = 1;
    for (int i = 0; i < 3; i++)
        weights[i + 1] = -w[i];
    key->is_off = false;
    if (!is_border) {
        pel_vec3_subtract(x[2], x[1], u);
        pel_vec3_subtract(x[3], x[1], v);
        pel_vec3_cross(u, v, normal);
        if (pel_vec3_normalize(normal) > 0) {
            keep_side(job, contact, key, normal);
            return;
        }
    }
    key->has_side = false;
    for (int k = 0; k < 3; k++) {
        way[k] = x[0][k] - w[0] * x[1][k] - w[1] * x[2][k] - w[2] * x[3][k];
        normal[k] = (double)contact->normal[k];
    }
    if (square > 0 && pel_vec3_dot(way, normal) > 0)
        pel_vec3_scale(way, 1 / sqrt(square), normal);
    key->is_off = is_border && !leads_away_from_border(job, key, x, w, normal);
}

/* Goes to the triangle of the ring of a pair that is nearest to its vertex; false = it is there. Its side is not known
   then. */
static bool walk(const refresh_job *job, double x[4][3], pel_contact *contact, pel_contact_key *key)
{
    const pel_contact_set *set = job->set;
    const pel_tree *tree = pel_collider_tree(set->collider);
    int32_t ring[PEL_RING_LIMIT], corner = key->points[key->ring], nearest = key->second;
    int count = pel_contact_ring(tree, key->second, corner, ring);
    double least = HUGE_VAL, w[3];
    for (int i = 0; i < count; i++) {
        const int32_t *v = tree->triangles[ring[i]];
        double y[3][3];
        if (v[0] == key->points[0] || v[1] == key->points[0] || v[2] == key->points[0])
            continue;
        for (int k = 0; k < 3; k++)
            load_point(job, v[k], y[k]);
        double square = pel_closest_point_triangle(x[0], y[0], y[1], y[2], w);
        if (square < least) {
            least = square;
            nearest = ring[i];
        }
    }
    if (nearest == key->second)
        return false;
    key->second = nearest;
    key->has_side = false;
    for (int k = 1; k < 4; k++) {
        int32_t point = tree->triangles[nearest][k - 1];
        key->points[k] = point;
        key->ring = point == corner ? (uint8_t)k : key->ring;
        contact->vertices[k] = point < set->vertex_count ? point : 0;
        load_point(job, point, x[k]);
    }
    return true;
}

/* weights and normal of a vertex before the nearest of the triangles that a pair stands for */
static void refresh_vertex_face(const refresh_job *job, double x[4][3], pel_contact *contact, pel_contact_key *key,
                                double weights[4], double normal[3])
{
    look_at_face(job, x, contact, key, weights, normal);
    if (key->border != PEL_NO_BORDER && key->ring > 0 && walk(job, x, contact, key))
        look_at_face(job, x, contact, key, weights, normal);
}

/* the same for two edges */
static void refresh_edges(const refresh_job *job, double x[4][3], const pel_contact *contact, pel_contact_key *key,
                          double weights[4], double normal[3])
{
    double w[4], u[3], v[3], cross[3], back[3];
    pel_closest_segment_segment(x[0], x[1], x[2], x[3], w);
    double least = pel_min(pel_min(w[0], w[1]), pel_min(w[2], w[3]));
    pel_vec3_subtract(x[1], x[0], u);
    pel_vec3_subtract(x[3], x[2], v);
    pel_vec3_cross(u, v, cross);
    double size = pel_vec3_length(u) * pel_vec3_length(v), sine = pel_vec3_normalize(cross);
    bool is_inside = least > INSIDE && sine > PARALLEL * size;
    if (is_inside)
        keep_side(job, contact, key, cross);
    else
        key->has_side = false;
    pel_vec3_scale(cross, -1, back);
    key->is_off = !is_inside || !leads_away(job, key, key->first, x[0], x[1], back) ||
                  !leads_away(job, key, key->second, x[2], x[3], cross);
    for (int i = 0; i < 4; i++)
        weights[i] = i < 2 ? w[i] : -w[i];
    for (int k = 0; k < 3; k++)
        normal[k] = is_inside ? cross[k] : (double)contact->normal[k];
}

/* separation and drift of the obstacle's share of the sum; returns the thickness that the pair keeps at present [m] */
static double set_obstacle_share(const pel_contact_set *set, const pel_contact_key *key, const double weights[4],
                                 const double normal[3], pel_contact *contact)
{
    double thickness = pel_contact_pair_thickness(set, key->points) - slack_of(set, key);
    double separation = thickness + pel_contact_pair_radius(set, key->points), drift[3] = {0, 0, 0};
    for (int i = 0; i < 4; i++) {
        int32_t point = key->points[i] - set->vertex_count;
        contact->weights[i] = point < 0 ? (pel_real)weights[i] : 0;
        if (point < 0)
            continue;
        separation -= weights[i] * pel_vec3_dot(set->substep_end[point], normal);
        for (int k = 0; k < 3; k++)
            drift[k] -= weights[i] * (set->substep_end[point][k] - set->substep_start[point][k]);
    }
    contact->separation = (pel_real)separation;
    for (int k = 0; k < 3; k++)
        contact->drift[k] = (pel_real)drift[k];
    return thickness;
}

static double gap_of(double x[4][3], const double weights[4], const double normal[3])
{
    double gap = 0;
    for (int i = 0; i < 4; i++)
        gap += weights[i] * pel_vec3_dot(x[i], normal);
    return gap;
}

/* The place of an impact in this step stays; where its normal leans over a triangle that one is closer. */
static void check_impact(const refresh_job *job, double x[4][3], pel_contact_key *key, pel_contact *contact)
{
    double normal[3], back[3], w[3];
    for (int k = 0; k < 3; k++) {
        normal[k] = (double)contact->normal[k];
        back[k] = -normal[k];
        w[k] = key->edge_edge ? 0 : fabs(key->place[k + 1]);
    }
    if (!key->edge_edge && pel_contact_are_balls(key->points))
        key->is_off = false;
    else if (key->edge_edge)
        key->is_off = !leads_away(job, key, key->first, x[0], x[1], back) ||
                      !leads_away(job, key, key->second, x[2], x[3], normal);
    else
        key->is_off = !leads_away_from_border(job, key, x, w, normal);
    if (key->is_off)
        pel_contact_switch_off(contact);
}

/* what went so far beyond an impact is left to the guard */
static bool is_far_through(const pel_contact_set *set, double x[4][3], const pel_contact_key *key,
                           const pel_contact *contact)
{
    double normal[3];
    for (int k = 0; k < 3; k++)
        normal[k] = (double)contact->normal[k];
    double radius = pel_contact_pair_radius(set, key->points);
    return gap_of(x, key->place, normal) - radius < -PEL_CONTACT_FAR * set->mean_edge;
}

static void way_between(double x[4][3], const double weights[4], double way[3])
{
    for (int k = 0; k < 3; k++)
        way[k] = weights[0] * x[0][k] + weights[1] * x[1][k] + weights[2] * x[2][k] + weights[3] * x[3][k];
}

/* After a look: both sides together have to travel half of the room before the next one is needed. Where all are looked
   at the sweeps to come may go any way: all that are not off act. */
static void keep_calm(const refresh_job *job, int32_t c, double thickness, double x[4][3], const double weights[4])
{
    pel_contact_set *set = job->set;
    pel_contact_key *key = &set->keys[c];
    double room = key->gap - thickness;
    bool is_off = key->is_off && key->edge_edge;
    if (is_off)
        room = pel_max(room, OFF_SHARE * thickness);
    bool is_far = is_off || (room > PEL_CONTACT_NEAR_SHARE * thickness && !job->looks_at_all);
    key->room = is_far && !(set->list.contacts[c].multiplier > 0) ? room : 0;
    double left = key->room > 0 ? 0.5 * key->room : key->slack > 0 ? 0 : KEEP_SHARE * thickness;
    set->calm[c] = set->travel.approach + left;
    double apart[3];
    way_between(x, weights, apart);
    pel_contact_watch *watch = &set->watches[c];
    *watch = (pel_contact_watch){.limit = (float)(MOVED_SHARE * key->room)};
    memcpy(watch->place, weights, sizeof watch->place);
    memcpy(watch->points, key->points, sizeof watch->points);
    for (int k = 0; k < 3; k++)
        watch->apart[k] = (float)apart[k];
}

/* Whether the places of a pair that need not be looked at yet have moved so little against each other that it has room
   for more. */
static bool has_hardly_moved(const refresh_job *job, int32_t c)
{
    pel_contact_set *set = job->set;
    const pel_contact_watch *watch = &set->watches[c];
    const float *apart = watch->apart;
    wide4 way = {0, 0, 0, 0};
    for (int i = 0; i < 4; i++) {
        int32_t point = watch->points[i];
        if (point < set->vertex_count) {
            way += watch->place[i] * __builtin_convertvector(job->positions[point], wide4);
            continue;
        }
        const double *x = set->substep_end[point - set->vertex_count];
        way += watch->place[i] * (wide4){x[0], x[1], x[2], 0};
    }
    way -= (wide4){(double)apart[0], (double)apart[1], (double)apart[2], 0};
    way *= way;
    double limit = (double)watch->limit;
    if (!(way[0] + way[1] + way[2] < limit * limit))
        return false;
    set->calm[c] = set->travel.approach + limit;
    return true;
}

static void refresh_pair(const refresh_job *job, int32_t c)
{
    pel_contact_set *set = job->set;
    pel_contact_key *key = &set->keys[c];
    pel_contact *contact = &set->list.contacts[c];
    double x[4][3], weights[4], normal[3];
    for (int i = 0; i < 4; i++)
        load_point(job, key->points[i], x[i]);
    if (key->is_impact) {
        set->calm[c] = key->room = 0;
        if (set->minds_sides)
            check_impact(job, x, key, contact);
        set->acts[c] = !key->is_off;
        if (is_far_through(set, x, key, contact))
            pel_contact_switch_off(contact);
        return;
    }
    if (key->edge_edge)
        refresh_edges(job, x, contact, key, weights, normal);
    else if (pel_contact_are_balls(key->points))
        look_at_balls(x, contact, key, weights, normal);
    else
        refresh_vertex_face(job, x, contact, key, weights, normal);
    const pel_real before[3] = {contact->normal[0], contact->normal[1], contact->normal[2]};
    for (int k = 0; k < 3; k++)
        contact->normal[k] = (pel_real)normal[k];
    if (!set->def.has_layers)
        pel_contact_keep_push(contact, before);
    key->gap = gap_of(x, weights, normal) - pel_contact_pair_radius(set, key->points);
    memcpy(key->place, weights, sizeof weights);
    keep_calm(job, c, set_obstacle_share(set, key, weights, normal, contact), x, weights);
    set->acts[c] = !(key->room > 0 || key->is_off);
    if (!set->acts[c])
        pel_contact_switch_off(contact);
}

static void refresh_chunk(void *context, int32_t chunk)
{
    const refresh_job *job = context;
    const pel_contact_set *set = job->set;
    int32_t begin = chunk * PAIRS_OF_CHUNK, end = begin + PAIRS_OF_CHUNK, chosen[PAIRS_OF_CHUNK], count = 0;
    bool any_sleeps = set->asleep_count > 0;
    for (int32_t c = begin; c < end && c < set->list.count; c++) {
        bool follows = set->is_moved && set->keys[c].obstacle >= 0 && !(set->keys[c].room > 0);
        if (!job->looks_at_all && !follows && set->calm[c] > set->travel.approach)
            continue;
        /* freeze the plane of a loaded contact within the substep: a load removed along a turned normal adds energy */
        if (!job->is_first && set->list.contacts[c].multiplier > 0)
            continue;
        if (any_sleeps && pel_contact_sleeps(set, set->keys[c].points))
            continue;
        if (!job->looks_at_all && set->calm[c] > 0 && set->watches[c].limit > 0 && has_hardly_moved(job, c))
            continue;
        /* long lists are in no cache nearby: a pair comes while others are chosen */
        for (size_t i = 0; i < sizeof *set->keys; i += BYTES_OF_LINE)
            __builtin_prefetch((const char *)&set->keys[c] + i, 1);
        chosen[count++] = c;
    }
    for (int32_t i = 0; i < count; i++)
        refresh_pair(job, chosen[i]);
}

/* Whether another pair before it in the list has the same point, edge or triangle that this vertex is before: one is
   enough. Pairs of a vertex stand together. */
static bool is_again(const pel_contact_set *set, int32_t c)
{
    const pel_contact_key *key = &set->keys[c];
    if (key->edge_edge || key->is_impact)
        return false;
    for (int32_t i = c - 1; i >= 0 && set->keys[i].first == key->first; i--) {
        const pel_contact_key *other = &set->keys[i];
        bool is_same = key->border == PEL_NO_BORDER ? other->second == key->second : other->border == key->border;
        if (is_same && !(other->room > 0) && !other->is_off && !other->is_impact)
            return true;
    }
    return false;
}

/* m, the least of `calm` */
static double least_calm(const pel_contact_set *set)
{
    int32_t count = set->list.count, c = 0;
    wide4 least = wide4_set(HUGE_VAL);
    for (; c + 4 <= count; c += 4) {
        wide4 calm;
        memcpy(&calm, set->calm + c, sizeof calm);
        least = wide4_min(calm, least);
    }
    double all = pel_min(pel_min(least[0], least[1]), pel_min(least[2], least[3]));
    for (; c < count; c++)
        all = pel_min(all, set->calm[c]);
    return all;
}

static void list_active(pel_contact_set *set)
{
    pel_contact_list *list = &set->list;
    list->active = set->active;
    list->active_count = 0;
    set->calm_until = least_calm(set);
    for (int32_t c = 0; c < list->count; c++) {
        if (!set->acts[c] || pel_contact_sleeps(set, set->keys[c].points))
            continue;
        if (is_again(set, c) && !(list->contacts[c].multiplier > 0))
            pel_contact_switch_off(&list->contacts[c]);
        else
            set->active[list->active_count++] = c;
    }
}

/* m, of the points of obstacles in this substep; negative = there are none */
static double obstacle_travel(const pel_contact_set *set)
{
    double longest = set->point_count > set->vertex_count ? 0 : -1;
    for (int32_t p = 0; p < set->point_count - set->vertex_count; p++)
        longest = pel_max(longest, pel_vec3_distance(set->substep_start[p], set->substep_end[p]));
    return longest;
}

bool pel_contact_set_needs_look(pel_contact_set *set, const pel_record *positions, bool is_first)
{
    if (set->list.count == 0 && set->list.active != NULL)
        return false;
    double way = is_first ? obstacle_travel(set) : set->point_count > set->vertex_count ? 0 : -1;
    if (is_first) {
        set->is_moved = way > 0 || set->moves;
        set->moves = way > 0;
    }
    pel_travel_follow(&set->travel, positions, way, set->def.pool);
    return set->is_moved || set->list.active == NULL || !(set->travel.approach < set->calm_until);
}

void pel_contact_set_refresh(pel_contact_set *set, const pel_record *positions, const pel_record *start,
                             bool looks_at_all, bool is_first)
{
    refresh_job job = {set, positions, start, looks_at_all, is_first};
    int32_t count = set->list.count;
    pel_pool_run(set->def.pool, (count + PAIRS_OF_CHUNK - 1) / PAIRS_OF_CHUNK, refresh_chunk, &job);
    list_active(set);
    /* impacts of corrections after the solver say more than their patches */
    if (!looks_at_all)
        pel_contact_patches_thin(&set->patches, &set->list, set->active, positions);
}

/* whether a pair leans over no triangle at the start of the step; impacts act wherever they are */
static bool acts_at_start(const refresh_job *job, int32_t c)
{
    pel_contact_key key = job->set->keys[c];
    pel_contact contact = job->set->list.contacts[c];
    double x[4][3];
    if (key.is_impact)
        return true;
    for (int i = 0; i < 4; i++)
        load_point(job, key.points[i], x[i]);
    check_impact(job, x, &key, &contact);
    return !key.is_off;
}

static void look_chunk(void *context, int32_t chunk)
{
    const refresh_job *job = context;
    int32_t begin = chunk * PAIRS_OF_CHUNK, end = begin + PAIRS_OF_CHUNK;
    for (int32_t c = begin; c < end && c < job->set->list.count; c++)
        job->set->keys[c].is_off = !acts_at_start(job, c);
}

void pel_contact_set_look_at_start(pel_contact_set *set)
{
    refresh_job job = {set, NULL, NULL, true, true};
    int32_t count = set->list.count;
    pel_pool_run(set->def.pool, (count + PAIRS_OF_CHUNK - 1) / PAIRS_OF_CHUNK, look_chunk, &job);
}
