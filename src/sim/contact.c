#include "sim/contact.h"

#include "base/memory.h"
#include "base/status.h"
#include "sim/tool.h"
#include "solve/contact.h"

#include <string.h>
#include <time.h>

enum {
    SWEEP_PRESET = 10,
    ROUND_LIMIT = 10,
    HALVING_ROUNDS = 5,
    MOST_DOUBLINGS = 6,
    CONTACTS_PER_VERTEX = 64,
    SIDE_ROUNDS = 2,
    VELOCITY_SWEEPS = 4
};

/* distance that the guard keeps, of the thickness */
#define GUARDED_SHARE 0.3
/* before a solver with contacts in its loop, pairs are found this much beyond the thickness, and this share of the
   fastest way beyond that */
#define REACH_SHARE 0.5
#define MOTION_SHARE 0.5
/* pairs closer than thickness + NEAR_SHARE * shortest edge become contacts at the start, without a CCD query. Tried and
   lost: the same where the closest points lie on the border of a feature (such normals lean and block sliding), and no
   search for conflicts in the first round, which places many contacts */
#define NEAR_SHARE 0.5
/* depth at which sweeps may end, of the thickness */
#define SWEEP_TOLERANCE 1e-2
/* Depth that a pair had at the start of the step and that corrections take back, of the thickness. No more: the start
   keeps all these distances, so that there is an answer, also where layers press each other from all sides. */
#define RECOVERY_SHARE 0.2

/* ---- creation ---- */

/* sweeps over the contacts of a step beyond which it would seem to hang */
enum { MOST_SWEEPS = 1000000 };

static pel_status check_numbers(const pel_contact_def *def, pel_error *error)
{
    const double numbers[] = {def->thickness, def->relative_thickness, def->friction};
    static const char *const names[] = {"thickness", "relative thickness", "friction"};
    for (int i = 0; i < 3; i++)
        if (!(numbers[i] >= 0 && isfinite(numbers[i]))) {
            pel_fail(error, PEL_BAD_ARGUMENT, "contact %s is %g", names[i], numbers[i]);
            pel_fail_remedy(error, "give a number of at least 0");
            return PEL_BAD_ARGUMENT;
        }
    if (!(def->thickness > 0) && !(def->relative_thickness > 0)) {
        pel_fail(error, PEL_BAD_ARGUMENT, "contact has no thickness");
        pel_fail_remedy(error, "give a thickness above 0, such as 1e-4 of the size of the bodies");
        return PEL_BAD_ARGUMENT;
    }
    if (PEL_IS_NO_CHOICE(def->method, PEL_CCD_BRIDSON + 1))
        return pel_fail(error, PEL_BAD_ARGUMENT, "contact method %d is unknown", (int)def->method);
    if (PEL_IS_NO_CHOICE(def->response, PEL_CONTACT_AFTER + 1))
        return pel_fail(error, PEL_BAD_ARGUMENT, "contact response %d is unknown", (int)def->response);
    const int64_t counts[] = {def->sweeps, def->limit, def->memory_limit}, most[] = {MOST_SWEEPS, INT32_MAX, INT64_MAX};
    static const char *const count_names[] = {"sweeps", "limit", "memory_limit"};
    for (int i = 0; i < 3; i++)
        if (counts[i] < 0 || counts[i] > most[i])
            return pel_fail(error, PEL_BAD_ARGUMENT, "contact %s is %lld", count_names[i], (long long)counts[i]);
    return PEL_OK;
}

static double diagonal(const pel_model *model)
{
    double low[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, high[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
    for (int32_t v = 0; v < model->vertex_count; v++)
        for (int k = 0; k < 3 && model->mesh_vertex[v] >= 0; k++) {
            low[k] = fmin(low[k], (double)model->rest[v][k]);
            high[k] = fmax(high[k], (double)model->rest[v][k]);
        }
    return pel_vec3_distance(low, high);
}

typedef struct edge_place {
    double length; /* m */
    int32_t body, vertex;
} edge_place;

/* shortest edge of a body at rest, on the finest level where it refines, and where it begins */
static edge_place shortest_edge(const pel_model *model, int32_t body)
{
    const pel_mesh *mesh = model->bodies[body].mesh;
    double levels = model->bodies[body].detail != NULL ? ldexp(1, model->bodies[body].detail->def.levels) : 1;
    edge_place shortest = {HUGE_VAL, body, 0};
    for (int32_t h = 0; h < 3 * mesh->triangle_count; h++) {
        int32_t v = mesh->triangles[h / 3][h % 3];
        double length =
            pel_vec3_distance(mesh->positions[v], mesh->positions[mesh->triangles[h / 3][(h + 1) % 3]]) / levels;
        if (length < shortest.length)
            shortest = (edge_place){length, body, v};
    }
    return shortest;
}

static pel_status refuse_thickness(const pel_sim *sim, double thickness, const edge_place *edge, pel_error *error)
{
    pel_fail(error, PEL_BAD_ARGUMENT, "contact thickness %g is more than the shortest edge, %g, of body '%s'",
             thickness, edge->length, sim->given->bodies[edge->body].name);
    pel_fail_element(error, "vertex", edge->vertex);
    pel_fail_remedy(error, "use at most %.3g, or a mesh without such short edges", 0.5 * edge->length);
    return PEL_BAD_ARGUMENT;
}

/* the thickness of all groups that have none of their own: what was given is taken or refused, the relative one gives
   way to short edges */
static pel_status choose_thickness(pel_sim *sim, const edge_place *shortest, pel_error *error)
{
    pel_sim_contacts *contacts = sim->contacts;
    double thickness = contacts->def.thickness;
    if (!(thickness > 0))
        thickness = fmin(contacts->def.relative_thickness * diagonal(sim->given), 0.5 * shortest->length);
    if (!(thickness > 0)) {
        pel_fail(error, PEL_BAD_ARGUMENT, "body '%s' has an edge without length",
                 sim->given->bodies[shortest->body].name);
        pel_fail_element(error, "vertex", shortest->vertex);
        pel_fail_remedy(error, "repair the mesh, or give contact a thickness in metres");
        return PEL_BAD_ARGUMENT;
    }
    contacts->thickness = thickness;
    return PEL_OK;
}

/* of bodies, none of which may be thicker than its edges are long, and tools */
static pel_status set_thicknesses(pel_sim *sim, pel_error *error)
{
    pel_sim_contacts *contacts = sim->contacts;
    int32_t body_count = sim->model->body_count, count = body_count + sim->tool_count;
    edge_place shortest = {.length = HUGE_VAL}, edges;
    for (int32_t b = 0; b < body_count; b++) {
        edges = shortest_edge(sim->given, b);
        shortest = edges.length < shortest.length ? edges : shortest;
    }
    contacts->thickness_of_group = pel_allocate((size_t)count, sizeof *contacts->thickness_of_group);
    if (contacts->thickness_of_group == NULL)
        return pel_fail_memory(error);
    pel_status status = choose_thickness(sim, &shortest, error);
    contacts->least = HUGE_VAL;
    for (int32_t i = 0; status == PEL_OK && i < count; i++) {
        double own = i < body_count ? sim->given->bodies[i].contact_thickness : sim->tools[i - body_count].thickness;
        double thickness = contacts->thickness_of_group[i] = own > 0 ? own : contacts->thickness;
        edges = i < body_count ? shortest_edge(sim->given, i) : shortest;
        if (i < body_count && thickness > edges.length)
            return refuse_thickness(sim, thickness, &edges, error);
        contacts->least = fmin(contacts->least, thickness);
        contacts->largest = fmax(contacts->largest, thickness);
    }
    contacts->guarded = GUARDED_SHARE * contacts->least;
    contacts->near = contacts->largest + NEAR_SHARE * shortest.length;
    return status;
}

static pel_status allocate_guard(pel_sim *sim, pel_error *error)
{
    pel_sim_contacts *contacts = sim->contacts;
    size_t places = (size_t)contacts->place_count, nodes = places + (size_t)sim->tool_count;
    contacts->solved = pel_allocate(places, sizeof *contacts->solved);
    contacts->zones = pel_allocate(nodes, sizeof *contacts->zones);
    contacts->rings = pel_allocate(nodes, sizeof *contacts->rings);
    contacts->wanted = pel_allocate((size_t)sim->tool_count, sizeof *contacts->wanted);
    contacts->body_shares = pel_allocate((size_t)sim->model->body_count, sizeof *contacts->body_shares);
    contacts->body_impacts = pel_allocate((size_t)sim->model->body_count, sizeof *contacts->body_impacts);
    bool made = contacts->solved != NULL && contacts->zones != NULL && contacts->rings != NULL &&
                contacts->wanted != NULL && contacts->body_shares != NULL && contacts->body_impacts != NULL;
    return made ? PEL_OK : pel_fail_memory(error);
}

/* what tools press with reaches as far as their largest distance from a body */
static void grow_tools(pel_sim *sim)
{
    for (int32_t i = 0; i < sim->tool_count; i++)
        for (int32_t b = 0; b < sim->model->body_count; b++) {
            double thickness = pel_contact_thickness(sim->contacts, b, sim->model->body_count + i);
            sim->tools[i].press_margin = fmax(sim->tools[i].press_margin, thickness);
        }
}

static pel_status refuse_mesh_tools(const pel_sim *sim, pel_error *error)
{
    for (int32_t i = 0; i < sim->tool_count; i++) {
        if (sim->tools[i].mesh == NULL)
            continue;
        pel_fail(error, PEL_BAD_ARGUMENT, "tool '%s' is a mesh, which needs contact", sim->tools[i].name);
        pel_fail_element(error, "tool", i);
        pel_fail_remedy(error, "switch contact on, or use a sphere, capsule or box");
        return PEL_BAD_ARGUMENT;
    }
    return PEL_OK;
}

pel_status pel_contacts_create(pel_sim *sim, const pel_contact_def *def, pel_error *error)
{
    if (!def->enabled)
        return refuse_mesh_tools(sim, error);
    pel_status status = check_numbers(def, error);
    if (status != PEL_OK)
        return status;
    sim->contacts = pel_allocate(1, sizeof *sim->contacts);
    if (sim->contacts == NULL)
        return pel_fail_memory(error);
    sim->contacts->def = *def;
    sim->self_contact = def->self && !def->allow_tangled;
    sim->contact_in_loop &= def->response == PEL_CONTACT_IN_LOOP;
    if (def->sweeps == 0)
        sim->contacts->def.sweeps = SWEEP_PRESET;
    int64_t limit = (int64_t)CONTACTS_PER_VERTEX * sim->model->vertex_count;
    sim->contacts->limit = def->limit > 0 ? def->limit : (int32_t)(limit < INT32_MAX / 2 ? limit : INT32_MAX / 2);
    status = set_thicknesses(sim, error);
    if (status == PEL_OK)
        status = pel_contact_surface_create(sim, error);
    if (status == PEL_OK)
        status = allocate_guard(sim, error);
    if (status == PEL_OK && !sim->goes_on)
        status = pel_tangles_find(sim, error);
    if (status == PEL_OK && !sim->goes_on)
        status = pel_tangles_refuse(sim, error);
    if (status == PEL_OK)
        grow_tools(sim);
    return status;
}

void pel_contacts_destroy(pel_sim *sim)
{
    pel_sim_contacts *contacts = sim->contacts;
    if (contacts == NULL)
        return;
    pel_collider_destroy(contacts->collider);
    void *arrays[] = {contacts->triangles,
                      contacts->group_of_point,
                      contacts->friction_of_group,
                      contacts->thickness_of_group,
                      contacts->may_meet,
                      contacts->revisions,
                      contacts->tools,
                      contacts->start,
                      contacts->end,
                      contacts->substep_start,
                      contacts->substep_end,
                      contacts->list.contacts,
                      contacts->keys,
                      contacts->other_keys,
                      contacts->other_contacts,
                      contacts->heights.list.contacts,
                      contacts->heights.triangles,
                      contacts->conflicts,
                      contacts->impacts,
                      contacts->solved,
                      contacts->zones,
                      contacts->rings,
                      contacts->wanted,
                      contacts->tangles.pairs,
                      contacts->tangles.keys,
                      contacts->before_event,
                      contacts->body_shares,
                      contacts->body_impacts};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++)
        pel_free(arrays[i]);
    pel_free(contacts);
    sim->contacts = NULL;
}

/* ---- records ---- */

/* a record from a pair and where it meets; false when none of its points can move */
static bool make_contact(const pel_sim *sim, const pel_collision *pair, const pel_ccd_hit *hit, pel_contact *contact)
{
    const pel_sim_contacts *contacts = sim->contacts;
    /* points 0 and 3 are of either side */
    const int32_t *group = contacts->group_of_point;
    double separation = pel_contact_thickness(contacts, group[pair->vertices[0]], group[pair->vertices[3]]), free = 0;
    double friction = pel_contact_friction(contacts, group[pair->vertices[0]], group[pair->vertices[3]]);
    *contact = (pel_contact){.friction = (pel_real)friction};
    double drift[3] = {0, 0, 0};
    for (int i = 0; i < 4; i++) {
        int32_t point = pair->vertices[i];
        double weight = hit->weight[i], way[3];
        if (point < contacts->place_count) {
            contact->vertices[i] = point;
            contact->weights[i] = (pel_real)weight;
            free += (double)sim->model->inverse_mass[point] * weight * weight;
            continue;
        }
        separation -= weight * pel_vec3_dot(contacts->end[point], hit->normal);
        pel_vec3_subtract(contacts->end[point], contacts->start[point], way);
        pel_vec3_along(drift, -weight, way, drift);
    }
    contact->separation = (pel_real)separation;
    for (int k = 0; k < 3; k++) {
        contact->normal[k] = (pel_real)hit->normal[k];
        contact->drift[k] = (pel_real)drift[k];
    }
    return free > 0 && pel_vec3_squared_length(hit->normal) > 0.5;
}

static pel_contact_key make_key(const pel_sim *sim, const pel_collision *hit)
{
    pel_contact_key key = {.edge_edge = hit->edge_edge, .first = hit->first, .second = hit->second, .tool = -1};
    memcpy(key.points, hit->vertices, sizeof key.points);
    memcpy(key.place, hit->hit.weight, sizeof key.place);
    for (int i = 0; i < 4 && key.tool < 0; i++)
        key.tool = pel_contact_tool_of(sim, hit->vertices[i]);
    return key;
}

static int compare_keys(const pel_contact_key *a, const pel_contact_key *b)
{
    if (a->edge_edge != b->edge_edge)
        return a->edge_edge ? 1 : -1;
    if (a->first != b->first)
        return a->first < b->first ? -1 : 1;
    return (a->second > b->second) - (a->second < b->second);
}

static pel_status make_room(pel_sim_contacts *contacts, size_t count, pel_error *error)
{
    if (pel_reserve((void **)&contacts->other_contacts, &contacts->other_capacity, count,
                    sizeof *contacts->other_contacts) &&
        pel_reserve((void **)&contacts->other_keys, &contacts->other_key_capacity, count, sizeof *contacts->other_keys))
        return PEL_OK;
    return pel_fail_memory(error);
}

/* the merged list becomes the list */
static void exchange_lists(pel_sim_contacts *contacts, int32_t count)
{
    pel_contact *list = contacts->list.contacts;
    pel_contact_key *keys = contacts->keys;
    size_t capacity = contacts->capacity, key_capacity = contacts->key_capacity;
    contacts->list = (pel_contact_list){contacts->other_contacts, count, contacts->list.recovery};
    contacts->keys = contacts->other_keys;
    contacts->capacity = contacts->other_capacity;
    contacts->key_capacity = contacts->other_key_capacity;
    contacts->other_contacts = list;
    contacts->other_keys = keys;
    contacts->other_capacity = capacity;
    contacts->other_key_capacity = key_capacity;
}

/* what was found on its way into the list */
typedef struct merger {
    pel_sim *sim;
    const pel_timed_hit *impacts; /* of conflicts among what was found; null = not looked for */
    double tool_reach;            /* m, tools that are farther away at the start count only by their faces */
    bool is_for_substeps;         /* found at the start of a step with substeps */
    int32_t old, count;           /* contacts of the list that were taken over, contacts of the merged list */
} merger;

/* takes over what comes before a key, all when it is null; true when the next one has this key */
static bool take_over(merger *m, const pel_contact_key *key)
{
    pel_sim_contacts *contacts = m->sim->contacts;
    for (; m->old < contacts->list.count; m->old++) {
        int order = key != NULL ? compare_keys(&contacts->keys[m->old], key) : -1;
        if (order >= 0)
            return order == 0;
        contacts->other_keys[m->count] = contacts->keys[m->old];
        contacts->other_contacts[m->count++] = contacts->list.contacts[m->old];
    }
    return false;
}

/* a vertex right before the inner part of a triangle */
static bool is_before_face(const pel_collision *pair)
{
    const double *w = pair->hit.weight;
    return !pair->edge_edge && fmax(w[1], fmax(w[2], w[3])) < -1e-6;
}

/* a pair that is in the list takes the new place and keeps its sums, unless its place says more */
static void add_found(merger *m, const pel_collision *pair, int64_t number)
{
    pel_sim_contacts *contacts = m->sim->contacts;
    pel_contact_key key = make_key(m->sim, pair);
    key.is_impact = m->impacts != NULL && m->impacts[number].hit.time_of_impact <= 1;
    double start = pel_contact_start_distance(contacts, pair);
    key.depth = fmax(0, (1 - RECOVERY_SHARE) * contacts->thickness - start);
    if (key.is_impact)
        memcpy(key.place, m->impacts[number].hit.weight, sizeof key.place);
    if (key.tool >= 0 && !is_before_face(pair) && start > m->tool_reach)
        return;
    /* the substeps see boxes as solids (tool_solid.h) */
    if (key.tool >= 0 && m->is_for_substeps && m->sim->tools[key.tool].mesh == NULL)
        return;
    bool known = take_over(m, &key);
    pel_contact contact, *old = known ? &contacts->list.contacts[m->old] : NULL;
    if (known && contacts->keys[m->old].is_impact && !key.is_impact)
        return;
    if (!make_contact(m->sim, pair, key.is_impact ? &m->impacts[number].hit : &pair->hit, &contact))
        return;
    if (key.is_impact)
        contact.separation -= (pel_real)key.depth;
    if (known) {
        const pel_contact_key *own = &contacts->keys[m->old];
        contact.push = old->push;
        memcpy(contact.tangential, old->tangential, sizeof contact.tangential);
        memcpy(contact.stopped, old->stopped, sizeof contact.stopped);
        key.has_pushed = own->has_pushed;
        key.load = own->load;
        pel_vec3_copy(own->drag, key.drag);
        m->old++;
    } else if (contacts->list.count - m->old + m->count >= contacts->limit) {
        contacts->statistics.dropped++;
        return;
    }
    contacts->other_keys[m->count] = key;
    contacts->other_contacts[m->count++] = contact;
}

/* puts what was found into the list */
static pel_status merge(pel_sim *sim, const pel_collision_result *found, const pel_timed_hit *impacts,
                        double tool_reach, pel_error *error)
{
    pel_sim_contacts *contacts = sim->contacts;
    merger m = {.sim = sim, .impacts = impacts, .tool_reach = tool_reach};
    m.is_for_substeps = impacts == NULL && pel_sim_is_projected(sim);
    pel_status status = make_room(contacts, (size_t)contacts->list.count + (size_t)found->collision_count, error);
    if (status != PEL_OK)
        return status;
    for (int64_t i = 0; i < found->collision_count; i++)
        if (contacts->tangles.count == 0 || !pel_tangles_have(contacts, &found->collisions[i]))
            add_found(&m, &found->collisions[i], i);
    take_over(&m, NULL);
    exchange_lists(contacts, m.count);
    return PEL_OK;
}

/* ---- search ---- */

static double seconds_now(void)
{
    struct timespec now;
    timespec_get(&now, TIME_UTC);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* what comes within the distance between start and end */
static pel_status search(pel_sim *sim, double distance, pel_collision_result *found, pel_error *error)
{
    pel_sim_contacts *contacts = sim->contacts;
    double began = seconds_now();
    contacts->way_is_searched = false;
    pel_collision_query query = pel_collision_query_default();
    query.start = (const double *)contacts->start;
    query.end = (const double *)contacts->end;
    query.min_separation = distance;
    query.tolerance = 1e-2 * contacts->least;
    query.near = contacts->near;
    query.method = contacts->def.method;
    pel_status status = pel_collider_detect(contacts->collider, &query, found, error);
    pel_contact_count_search(contacts, found);
    contacts->statistics.find_seconds += seconds_now() - began;
    return status;
}

/* the longest way of a step of velocities */
static double longest_way(const pel_sim_contacts *contacts)
{
    double square = 0;
    for (int32_t p = 0; p < contacts->point_count; p++) {
        double way[3];
        pel_vec3_subtract(contacts->end[p], contacts->start[p], way);
        double own = pel_vec3_squared_length(way);
        square = own > square ? own : square;
    }
    return sqrt(square);
}

/* tools where they are and where they will want to be; the substeps have moved them already */
static void expect_tools(pel_sim *sim)
{
    double next = pel_sim_next_time(sim);
    bool began = pel_sim_is_projected(sim);
    for (int32_t i = 0; i < sim->tool_count; i++) {
        pel_contact_tool *own = &sim->contacts->tools[i];
        pel_tool *tool = &sim->tools[i];
        pel_pose wanted = began ? tool->pose_wanted : pel_tool_next_pose(sim, tool, next);
        pel_contact_tool_points(own, began ? &tool->pose_before : &tool->pose, sim->contacts->start);
        pel_contact_tool_points(own, &wanted, sim->contacts->end);
    }
}

/* where vertices go by their velocity and the loads; held ones on their path */
static void expect_vertices(pel_sim *sim)
{
    pel_sim_contacts *contacts = sim->contacts;
    const pel_state *state = sim->state;
    const pel_boundary *boundary = &sim->boundary;
    double dt = sim->step.dt;
    memset(sim->force, 0, (size_t)sim->model->vertex_count * sizeof *sim->force);
    if (state->velocity != NULL)
        pel_loads_add(sim, pel_sim_time(sim), sim->state->position, sim->force);
    for (int32_t p = 0; p < contacts->place_count; p++)
        for (int k = 0; k < 3; k++) {
            double velocity = state->velocity != NULL ? (double)state->velocity[p][k] : 0;
            velocity += dt * (double)(sim->model->inverse_mass[p] * sim->force[p][k]);
            contacts->end[p][k] = contacts->start[p][k] + dt * velocity;
        }
    if (!pel_sim_is_projected(sim) || boundary->held_count == 0)
        return;
    pel_tools_place(sim, 1);
    for (int32_t i = 0; i < boundary->held_count; i++)
        pel_vec3_copy(boundary->target[i], contacts->end[boundary->held[i]]);
}

pel_status pel_contacts_find(pel_sim *sim, double least, pel_error *error)
{
    pel_sim_contacts *contacts = sim->contacts;
    contacts->list.count = 0;
    contacts->substep = 0;
    pel_contact_points(sim);
    contacts->way_is_searched = false;
    expect_tools(sim);
    expect_vertices(sim);
    double reach = contacts->largest * (1 + REACH_SHARE) + MOTION_SHARE * longest_way(contacts);
    reach = fmin(reach, 4 * contacts->largest);
    pel_collision_result found;
    pel_status status = search(sim, fmax(least, reach), &found, error);
    /* what slides along the edges between the flat triangles of a tool must not run into them */
    double tool_reach = least > reach ? reach : HUGE_VAL;
    return status == PEL_OK ? merge(sim, &found, NULL, tool_reach, error) : status;
}

/* what comes too near between start and end, and the conflicts among it; nothing is searched twice */
static pel_status search_way(pel_sim *sim, pel_collision_result *found, pel_error *error)
{
    pel_sim_contacts *contacts = sim->contacts;
    if (contacts->way_is_searched) {
        *found = contacts->on_way;
        return PEL_OK;
    }
    pel_status status = search(sim, contacts->largest, found, error);
    double began = seconds_now();
    if (status == PEL_OK)
        status = pel_contact_find_conflicts(sim, found, error);
    contacts->statistics.guard_seconds += seconds_now() - began;
    contacts->on_way = *found;
    contacts->way_is_searched = status == PEL_OK;
    return status;
}

pel_status pel_contacts_find_on_way(pel_sim *sim, pel_error *error)
{
    pel_sim_contacts *contacts = sim->contacts;
    pel_collision_result found;
    pel_contact_points(sim);
    pel_status status = search_way(sim, &found, error);
    contacts->statistics.rounds++;
    return status == PEL_OK ? merge(sim, &found, contacts->impacts, HUGE_VAL, error) : status;
}

void pel_contacts_forget_step(pel_sim *sim)
{
    pel_sim_contacts *contacts = sim->contacts;
    for (int32_t c = 0; c < contacts->list.count; c++) {
        pel_contact_key *key = &contacts->keys[c];
        key->is_impact = key->is_off = key->has_side = key->has_pushed = false;
        key->gap = 0;
    }
}

/* ---- correction ---- */

/* Moves the new positions by sweeps over the contacts. Velocities lose what runs into a contact, by impulses: momentum
   stays and energy cannot grow. */
static void correct(pel_sim *sim, int32_t sweeps)
{
    pel_sim_contacts *contacts = sim->contacts;
    pel_state *state = sim->state;
    double tolerance = SWEEP_TOLERANCE * contacts->least;
    for (int32_t i = 0; i < sim->tool_count; i++)
        sim->tools[i].pose_substep = sim->tools[i].pose_before;
    pel_contacts_place_tools(sim);
    pel_contacts_refresh(sim, state->position, HUGE_VAL);
    for (int32_t c = 0; c < contacts->list.count; c++)
        if (!contacts->keys[c].is_impact)
            contacts->list.contacts[c].separation -= (pel_real)contacts->keys[c].depth;
    contacts->list.recovery = HUGE_VAL;
    for (int32_t i = 0; i < sweeps; i++)
        if (pel_contacts_project(&contacts->list, state->position_next, state->position) < tolerance)
            break;
    contacts->way_is_searched = false;
    for (int32_t p = 0; p < contacts->place_count; p++)
        pel_vertex_position(state->position_next, p, contacts->end[p]);
    if (state->velocity_next != NULL)
        pel_contacts_stop(&contacts->list, state->position_next, state->velocity_next, sim->step.dt, VELOCITY_SWEEPS);
}

/* Forces of what was corrected after the solver, by the change of velocities. Without velocities a correction undoes
   the step of the forces that press, alpha F dt^2 / m (paper A, eq. A-5), and tools are read from these forces. */
static void take_corrections(pel_sim *sim)
{
    const pel_sim_contacts *contacts = sim->contacts;
    double dt = sim->step.dt, alpha = pel_sim_alpha(sim);
    for (int32_t c = 0; c < contacts->list.count; c++) {
        const pel_contact *contact = &contacts->list.contacts[c];
        int32_t tool = contacts->keys[c].tool;
        double stopped[3];
        if (!(contact->push > 0))
            continue;
        for (int k = 0; k < 3; k++)
            stopped[k] = (double)contact->stopped[k];
        if (alpha > 0 && tool < 0)
            pel_contact_take_push(sim, tool, contact, 1 / (alpha * dt * dt));
        else
            pel_contact_take(sim, tool, contact, stopped, 1 / dt);
    }
}

/* search and correction until nothing is too near; what is left are the conflicts */
static pel_status respond(pel_sim *sim, double longest, pel_error *error)
{
    pel_sim_contacts *contacts = sim->contacts;
    bool once = contacts->def.response == PEL_CONTACT_AFTER;
    /* layers that press each other, which converge slowly; other methods have solved nothing of them yet */
    int doublings = pel_sim_has_loop_contacts(sim) ? MOST_DOUBLINGS : 0;
    /* shorter parts have fewer conflicts, and cost less than many rounds */
    int limit = once ? 1 : pel_parts_can_halve(sim) ? HALVING_ROUNDS : ROUND_LIMIT;
    for (int round = 0;; round++) {
        pel_collision_result found;
        pel_status status = search_way(sim, &found, error);
        if (status != PEL_OK || round == limit || (round > 0 && contacts->conflict_count == 0))
            return status;
        /* without conflicts, what the solver swept over needs no more */
        if (contacts->conflict_count == 0 &&
            (pel_sim_has_loop_contacts(sim) || found.collision_count + contacts->list.count == 0))
            return PEL_OK;
        if (round == 0 && pel_parts_can_halve(sim))
            contacts->solved_energy = pel_sim_next_energy(sim);
        double began = seconds_now();
        status = merge(sim, &found, contacts->impacts, HUGE_VAL, error);
        if (status != PEL_OK)
            return status;
        contacts->minds_sides = round < SIDE_ROUNDS;
        correct(sim, once ? 1 : contacts->def.sweeps << (round < doublings ? round : doublings));
        /* boxes are in the list */
        pel_tools_press(sim, longest, true);
        pel_contact_points(sim);
        contacts->statistics.rounds++;
        contacts->statistics.solve_seconds += seconds_now() - began;
    }
}

/* Corrections may add this share of the energy that was supplied, over a whole step. */
#define APPEARS_SHARE 0.02

/* Whether the part is to be done anew in two: the guard would have to step bodies back, or corrections have put in more
   energy than they may. */
static bool is_refused(pel_sim *sim)
{
    if (!pel_parts_can_halve(sim))
        return false;
    if (sim->contacts->conflict_count > 0)
        return true;
    double most = APPEARS_SHARE * sim->ledger.sums.supplied * sim->step.dt / sim->solver.dt + sim->ledger.rounding;
    return !(pel_sim_next_energy(sim) - sim->contacts->solved_energy <= most);
}

static pel_status step(pel_sim *sim, double longest, pel_error *error)
{
    pel_sim_contacts *contacts = sim->contacts;
    pel_tools_press(sim, longest, false);
    pel_contact_points(sim);
    int64_t rounds = contacts->statistics.rounds;
    pel_status status = respond(sim, longest, error);
    if (status != PEL_OK)
        return status;
    sim->parts.is_refused = contacts->statistics.rounds > rounds && is_refused(sim);
    if (sim->parts.is_refused)
        return PEL_OK;
    double began = seconds_now();
    for (int32_t i = 0; i < sim->tool_count; i++)
        sim->tools[i].is_held_back = false;
    /* the cubic may have missed some */
    if (contacts->conflict_count == 0 && contacts->def.method != PEL_CCD_CONSERVATIVE)
        status = pel_contact_look(sim, error);
    if (status == PEL_OK && contacts->conflict_count > 0)
        status = pel_contact_guard(sim, error);
    contacts->statistics.guard_seconds += seconds_now() - began;
    contacts->statistics.contacts += contacts->list.count;
    if (status == PEL_OK && contacts->tangles.count > 0) {
        contacts->way_is_searched = false;
        memcpy(contacts->start, contacts->end, (size_t)contacts->point_count * sizeof *contacts->start);
        status = pel_tangles_find(sim, error);
    }
    return status;
}

pel_status pel_contacts_apply(pel_sim *sim, double time, double longest, pel_error *error)
{
    if (!pel_sim_has_loop_contacts(sim))
        sim->contacts->list.count = 0;
    pel_contacts_begin(&sim->contacts->list);
    if (!sim->stepper->moves_tools)
        pel_tools_move(sim, time);
    pel_status status = step(sim, longest, error);
    if (status != PEL_OK || sim->parts.is_refused) {
        pel_tools_return(sim);
        return status;
    }
    take_corrections(sim);
    pel_tools_read(sim, time);
    return PEL_OK;
}

void pel_contacts_mark(const pel_sim *sim)
{
    const pel_contact_list *list = &sim->contacts->list;
    for (int32_t c = 0; c < list->count; c++)
        for (int i = 0; i < 4 && (list->contacts[c].push > 0 || sim->contacts->keys[c].has_pushed); i++)
            if (list->contacts[c].weights[i] != 0)
                sim->state->contact[list->contacts[c].vertices[i]] = 1;
}

pel_status pel_contacts_begin_step(pel_sim *sim, pel_error *error)
{
    pel_sim_contacts *contacts = sim->contacts;
    bool is_new = !pel_contact_surface_is_present(sim);
    /* statistics of a body that does not move are those of one that was loaded from a snapshot */
    contacts->way_is_searched = false;
    if (!is_new && contacts->tangles.is_known)
        return PEL_OK;
    pel_contact_present_points(sim);
    pel_status status = pel_contact_surface_update(sim, error);
    if (status == PEL_OK && (!contacts->tangles.is_known || contacts->tangles.count > 0))
        status = pel_tangles_find(sim, error);
    return status;
}

/* ---- questions ---- */

void pel_sim_get_contact_statistics(const pel_sim *sim, pel_contact_statistics *statistics)
{
    if (sim == NULL || statistics == NULL)
        return;
    *statistics = sim->contacts != NULL ? sim->contacts->statistics : (pel_contact_statistics){0};
}
