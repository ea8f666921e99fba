/* Contact in a step: inputs of the set (contact/set.h), and the loop over search, correction and guard. */
#include "touch/contact.h"

#include "base/assert.h"
#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "boundary/loads.h"
#include "geom/wide4.h"
#include "math/bounds.h"
#include "math/extremes.h"
#include "observe/ledger.h"
#include "observe/observe.h"
#include "pellicle/sim_surface.h"
#include "stage/accessors.h"
#include "stage/layer.h"
#include "stage/surface_view.h"
#include "sweep/sweep.h"
#include "tool/contact_force.h"
#include "tool/pose.h"
#include "tool/reading.h"
#include "tool/solid.h"
#include "tool/tools.h"
#include "touch/doubt.h"
#include "touch/sleep.h"
#include "touch/tangle.h"
#include "touch/thickness.h"

#include <string.h>

/* RIGID_SWEEPS: so many times the sweeps of corrections where there are rigid bodies: those that squeeze others between
   them need many, and after ten the guard stopped some of 30 falling boxes */
enum { SWEEP_PRESET = 10, RIGID_SWEEPS = 6 };
enum { ROUND_LIMIT = 10, LAYER_ROUNDS = 2, CONTACTS_PER_VERTEX = 64, SIDE_ROUNDS = 2 };

/* pairs are searched for this many substeps at least, and for the rest of the step if it is shorter than this share */
#define LEAST_HORIZON 4
#define LEAST_REST 0.5

/* corrected pairs keep this share of the guarded distance */
#define CLEAR_SHARE 1.5

/* ---- creation ---- */

/* sweeps over the contacts of a step beyond which it would seem to hang */
enum { MOST_SWEEPS = 1000000 };

static pel_status check_numbers(const pel_contact_def *def, pel_error *error)
{
    const double numbers[] = {def->thickness, def->relative_thickness, def->friction};
    static const char *const names[] = {"thickness", "relative thickness", "friction"};
    for (int i = 0; i < 3; i++)
        if (!(numbers[i] >= 0 && isfinite(numbers[i])))
            return pel_refuse(error, PEL_BAD_ARGUMENT, "give a number of at least 0", "contact %s is %g", names[i],
                              numbers[i]);
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

static void set_obstacles(const pel_sim *sim, pel_obstacle *obstacles)
{
    for (int32_t i = 0; i < sim->tools->count; i++) {
        const pel_tool *tool = &sim->tools->items[i];
        obstacles[i] = (pel_obstacle){
            .solid = tool->solid, .mesh = tool->mesh, .presses = tool->press, .body = tool->body, .held = tool->held};
    }
}

static pel_status create_set(pel_sim *sim, pel_obstacle *obstacles, pel_contact_group *groups, pel_error *error)
{
    const pel_model *model = sim->model;
    const pel_contact_def *def = &sim->touch->def;
    int64_t limit = (int64_t)CONTACTS_PER_VERTEX * model->vertex_count;
    pel_contact_set_def given = {
        .vertex_count = model->vertex_count,
        .body_count = model->body_count,
        .body_of_slice = model->body_of_slice,
        .mass = model->mass,
        .inverse_mass = model->inverse_mass,
        .rest = model->rest,
        .origin_of_vertex = sim->touch->origins,
        .triangle_limit = model->triangle_begin[model->body_count],
        .obstacles = obstacles,
        .obstacle_count = sim->tools->count,
        .groups = groups,
        .self = def->self,
        .between = def->between,
        .has_layers = sim->contact_in_loop && pel_sim_is_projected(sim),
        .method = def->method,
        .limit = def->limit > 0 ? def->limit : (int32_t)(limit < INT32_MAX / 2 ? limit : INT32_MAX / 2),
        .memory_limit = def->memory_limit,
        .pool = sim->pool,
        .rigids = sim->rigids,
    };
    pel_contacts_limit_by_mesh(sim);
    pel_status status = pel_contacts_set_groups(sim, &given, groups, error);
    set_obstacles(sim, obstacles);
    return status == PEL_OK ? pel_contact_set_create(&given, &sim->contacts, error) : status;
}

static pel_status create_from_tools(pel_sim *sim, pel_error *error)
{
    size_t tool_count = (size_t)sim->tools->count, body_count = (size_t)sim->model->body_count;
    pel_obstacle *obstacles = pel_allocate(tool_count, sizeof *obstacles);
    pel_contact_group *groups = pel_allocate(body_count + tool_count, sizeof *groups);
    pel_status status =
        PEL_ALLOCATE_ALL(PEL_ROOM(sim->touch->revisions, body_count), PEL_ROOM(sim->touch->limits, body_count),
                         PEL_ROOM(sim->touch->supports, 2 * (size_t)sim->model->vertex_count)) &&
                obstacles != NULL && groups != NULL
            ? create_set(sim, obstacles, groups, error)
            : pel_fail_memory(error);
    pel_free(obstacles);
    pel_free(groups);
    return status;
}

static pel_status refuse_mesh_tools(const pel_sim *sim, pel_error *error)
{
    for (int32_t i = 0; i < sim->tools->count; i++) {
        if (sim->tools->items[i].mesh == NULL)
            continue;
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "tool", i,
                                  "switch contact on, or use a sphere, capsule or box",
                                  "tool '%s' is a mesh, which needs contact", sim->tools->items[i].name);
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
    sim->touch->def = *def;
    if (def->sweeps == 0)
        sim->touch->def.sweeps = SWEEP_PRESET;
    sim->self_contact = def->self && !def->allow_tangled;
    sim->contact_in_loop &= def->response == PEL_CONTACT_IN_LOOP;
    status = create_from_tools(sim, error);
    if (status != PEL_OK)
        return status;
    pel_contacts_place(sim);
    if (!sim->is_opened)
        status = pel_contacts_update_surface(sim, error);
    if (status == PEL_OK && !sim->goes_on)
        status = pel_contacts_limit_by_start(sim, error);
    if (status == PEL_OK && !sim->goes_on)
        status = pel_tangles_find(sim->contacts, error);
    if (status == PEL_OK && !sim->goes_on)
        status = pel_contacts_refuse_tangles(sim, error);
    return status;
}

void pel_contacts_destroy(pel_sim *sim)
{
    pel_contact_set_destroy(sim->contacts);
    sim->contacts = NULL;
    pel_sleep_destroy(sim);
    PEL_FREE_ALL(sim->touch->revisions, sim->touch->limits, sim->touch->supports, sim->touch->origins,
                 sim->touch->before_event);
}

/* ---- inputs of the set ---- */

static void bring_poses(const pel_sim *sim)
{
    for (int32_t i = 0; i < sim->tools->count; i++) {
        const pel_tool *tool = &sim->tools->items[i];
        pel_obstacle *obstacle = &sim->contacts->obstacles[i];
        obstacle->before = tool->pose_before;
        obstacle->substep = tool->pose_substep;
        obstacle->pose = tool->pose;
        obstacle->held_count = tool->held_count;
    }
}

void pel_contacts_place(pel_sim *sim)
{
    bring_poses(sim);
    pel_contact_set_place(sim->contacts, sim->state->position, sim->state->position_next);
}

void pel_contacts_place_start(pel_sim *sim)
{
    bring_poses(sim);
    pel_contact_set_place_start(sim->contacts, sim->state->position);
}

void pel_contacts_begin_substep(pel_sim *sim, double substep)
{
    bring_poses(sim);
    pel_contact_set_begin_substep(sim->contacts, substep);
}

static pel_contact_motion motion_of(const pel_sim *sim)
{
    const pel_state *state = sim->state;
    return (pel_contact_motion){state->position, state->position_next, state->velocity_next, sim->step.dt};
}

/* ---- the surface ---- */

static void add_surface(pel_sim *sim, int32_t b)
{
    int32_t count = pel_surface_count(sim->model, b), begin = sim->model->triangle_begin[b];
    const pel_front_triangle *surface = pel_surface_in_order(sim, b);
    for (int32_t i = 0; i < count; i++)
        pel_contact_surface_add(sim->contacts,
                                sim->model->triangles[begin + (surface != NULL ? pel_surface_number(&surface[i]) : i)]);
}

static pel_status set_triangles(pel_sim *sim, pel_error *error)
{
    pel_status status = pel_contact_surface_begin(sim->contacts, error);
    if (status != PEL_OK)
        return status;
    for (int32_t b = 0; b < sim->model->body_count; b++) {
        const pel_rigid *rigid = pel_rigid_of(sim->rigids, sim->model->bodies[b].slice_begin * PEL_WIDTH);
        if (rigid == NULL || !(rigid->radius > 0))
            add_surface(sim, b);
        sim->touch->revisions[b] = pel_surface_event_count(sim, b);
    }
    /* where balls alone are, one has triangles, which nothing meets: a collider is of some */
    if (sim->contacts->next_count == 0)
        add_surface(sim, 0);
    return PEL_OK;
}

bool pel_contacts_are_of_present(const pel_sim *sim)
{
    for (int32_t b = 0; b < sim->model->body_count; b++)
        if (sim->touch->revisions[b] != pel_surface_event_count(sim, b))
            return false;
    return true;
}

static bool is_present(const pel_sim *sim)
{
    bool is_set = !sim->touch->is_loaded && !sim->touch->is_carried;
    return sim->contacts->collider != NULL && is_set && pel_contacts_are_of_present(sim);
}

pel_status pel_contacts_update_surface(pel_sim *sim, pel_error *error)
{
    if (is_present(sim))
        return PEL_OK;
    bool is_same = pel_contacts_are_of_present(sim), is_known = sim->touch->is_loaded && is_same;
    pel_status status = set_triangles(sim, error);
    if (status == PEL_OK)
        status = pel_contact_surface_finish(sim->contacts, is_known, error);
    if (status != PEL_OK) {
        if (!is_known)
            sim->touch->revisions[0] = -1;
        return status;
    }
    /* numbers of features are of their surface */
    if (!is_same) {
        sim->contacts->list.count = 0;
        sim->contacts->has_home = false;
        pel_sleep_follow_surface(sim);
    }
    sim->touch->is_loaded = sim->touch->is_carried = false;
    if (is_known)
        return pel_tangles_recall(sim->contacts, error);
    sim->contacts->tangles.is_known &= sim->contacts->tangles.count == 0;
    return PEL_OK;
}

/* ---- search ---- */

/* Tools where they are at a share of the step, and where they will want to be at a later one. The substeps place them.
 */
static void expect_tools(pel_sim *sim, double share, double until)
{
    pel_contact_set *contacts = sim->contacts;
    double next = pel_sim_next_time(sim);
    bool began = pel_sim_is_projected(sim);
    for (int32_t i = 0; i < sim->tools->count; i++) {
        const pel_obstacle *own = &contacts->obstacles[i];
        pel_tool *tool = &sim->tools->items[i];
        pel_pose wanted = began ? tool->pose_wanted : pel_tool_next_pose(sim, tool, next), at = wanted;
        if (until < 1)
            pel_pose_between(&tool->pose_before, &wanted, until, &at);
        pel_obstacle_points(own, began && share <= 0 ? &tool->pose_before : &tool->pose,
                            contacts->start + own->point_begin);
        pel_obstacle_points(own, &at, contacts->end + own->point_begin);
    }
}

/* held vertices follow their path */
static void expect_held(pel_sim *sim, double share, double until)
{
    const pel_boundary *boundary = &sim->tools->boundary;
    if (!pel_sim_is_projected(sim) || boundary->held_count == 0)
        return;
    pel_tools_place(sim, until);
    for (int32_t i = 0; i < boundary->held_count; i++)
        pel_vec3_copy(boundary->target[i], sim->contacts->end[boundary->held[i]]);
    pel_tools_place(sim, share);
}

/* Positions after a share of the step, from the velocity and its mean change in the last one, so that resting and
   falling bodies are predicted well: along the parabola of a steady acceleration. */
static void expect_vertices(pel_sim *sim, double until)
{
    pel_contact_set *contacts = sim->contacts;
    const pel_state *state = sim->state;
    double dt = sim->step.dt;
    for (int32_t p = 0; p < contacts->vertex_count; p++)
        for (int k = 0; k < 3; k++) {
            double way = state->velocity != NULL ? dt * (double)state->velocity[p][k] : 0;
            double last = state->velocity != NULL ? contacts->start[p][k] - (double)state->position_before[p][k] : 0;
            contacts->end[p][k] = contacts->start[p][k] + until * (way + until * (way - last));
        }
    expect_held(sim, 0, until);
}

/* the second order of the ways of vertices, which begin with their velocities */
static void find_bends(pel_sim *sim, double until)
{
    pel_contact_set *contacts = sim->contacts;
    double time = until * sim->step.dt;
    for (int32_t p = 0; sim->state->velocity != NULL && p < contacts->vertex_count; p++)
        for (int k = 0; k < 3; k++)
            contacts->bend[p][k] =
                contacts->end[p][k] - contacts->start[p][k] - time * (double)sim->state->velocity[p][k];
}

/* m, how far a vertex goes in the step at most by its velocity */
static double longest_way(const pel_sim *sim)
{
    const pel_record *velocity = sim->state->velocity;
    wide4 most = wide4_set(0);
    for (int32_t v = 0; v < sim->model->vertex_count; v++)
        most = wide4_max(wide4_abs(__builtin_convertvector(velocity[v], wide4)), most);
    return sim->step.dt * sqrt(most[0] * most[0] + most[1] * most[1] + most[2] * most[2]);
}

/* Share of the step up to which pairs that are searched at another share are to serve. Methods without substeps search
   once. */
static double search_end(const pel_sim *sim, double share)
{
    double end = share + sim->contacts->horizon;
    return !pel_sim_is_projected(sim) || end + LEAST_REST * sim->contacts->horizon > 1 ? 1 : end;
}

/* searches what may touch up to a share of the step, unless the pairs of the last search serve for all of it */
static pel_status find_or_keep(pel_sim *sim, double least, double until, pel_error *error)
{
    pel_contact_set *contacts = sim->contacts;
    sim->touch->is_same = pel_contact_set_serves(contacts);
    sim->touch->found_until = sim->touch->is_same ? 1 : until;
    if (sim->touch->is_same)
        return pel_contact_set_find_same(contacts, sim->step.dt, error);
    pel_contact_set_narrow(contacts);
    return pel_contact_set_find(contacts, least, until * sim->step.dt, error);
}

pel_status pel_contacts_find(pel_sim *sim, double least, pel_error *error)
{
    const pel_record *position = sim->state->position;
    bool is_free = sim->state->velocity != NULL && sim->tools->count == 0 && !pel_loads_exist(sim);
    sim->touch->found_at = 1;
    sim->contacts->dt = sim->step.dt;
    if (is_free && pel_contact_set_stays_clear(sim->contacts, position, least, longest_way(sim)))
        return PEL_OK;
    double until = search_end(sim, 0);
    pel_contacts_place(sim);
    expect_tools(sim, 0, until);
    expect_vertices(sim, until);
    find_bends(sim, until);
    sim->touch->found_at = 0;
    pel_contact_set_calm(sim->contacts);
    pel_status status;
    do
        status = find_or_keep(sim, least, until, error);
    while (status == PEL_OK && pel_sleep_meet(sim));
    return status;
}

/* whether a vertex is farther than a limit [m] from where the way of the last search ended */
static bool is_away(const pel_contact_set *contacts, const pel_record *now, double limit)
{
    double most = 0;
    for (int32_t p = 0; p < contacts->vertex_count; p++) {
        double square = 0;
        for (int k = 0; k < 3; k++) {
            double way = (double)now[p][k] - contacts->home[p][k];
            square += way * way;
        }
        most = square > most ? square : most;
    }
    return most > limit * limit;
}

/* how much of the way of the last search has passed after a share of the step */
static double passed(const pel_sim *sim, double share)
{
    return (share - sim->touch->found_at) / (sim->touch->found_until - sim->touch->found_at);
}

/* m, where a vertex is expected after a part of that way */
static void expect_at(const pel_contact_set *contacts, int32_t p, double part, double place[3])
{
    for (int k = 0; k < 3; k++)
        place[k] = contacts->start[p][k] +
                   part * (contacts->end[p][k] - contacts->start[p][k] - (1 - part) * contacts->bend[p][k]);
}

/* Whether a vertex is where it was not expected after a share of the step: pairs may be missing. Marks the bodies of
   such vertices. */
static bool strays(const pel_sim *sim, const pel_record *now, double share)
{
    const pel_contact_set *contacts = sim->contacts;
    double limit = 0.5 * contacts->margin, part = passed(sim, share);
    bool any = false;
    if (sim->touch->is_same)
        return is_away(contacts, now, pel_contact_set_home_reach(contacts));
    memset(contacts->is_stray, 0, (size_t)(contacts->def.body_count + contacts->def.obstacle_count));
    for (int32_t p = 0; p < contacts->vertex_count && sim->touch->found_at < 1; p++) {
        double place[3], square = 0;
        expect_at(contacts, p, part, place);
        for (int k = 0; k < 3; k++) {
            double stray = (double)now[p][k] - place[k];
            square += stray * stray;
        }
        if (!(square > limit * limit))
            continue;
        contacts->is_stray[contacts->group_of_point[p]] = 1;
        any = true;
    }
    return any;
}

/* m, how far loads that nothing holds pull a body beyond its velocity in a time: a rigid one that falls */
static void find_fall(const pel_sim *sim, int32_t p, double time, double fall[3])
{
    const pel_rigid *rigid = pel_rigid_of(sim->rigids, p);
    bool falls = rigid != NULL && rigid->shape->is_free && !rigid->is_fixed && !rigid->state.is_touched;
    pel_vec3_scale(sim->model->gravity, falls ? 0.5 * time * time * sim->state->load_factor : 0, fall);
}

/* the ways of vertices from now on, from where they were one substep before */
static void expect_on(pel_sim *sim, const pel_record *now, const pel_record *base, double substeps, int32_t p)
{
    pel_contact_set *contacts = sim->contacts;
    double length = sim->step.dt / sim->solver.substeps, fall[3], first[3];
    find_fall(sim, p, substeps * length, contacts->bend[p]);
    find_fall(sim, p, length, fall);
    for (int k = 0; k < 3; k++) {
        first[k] = substeps * ((double)(now[p][k] - base[p][k]) + fall[k]);
        contacts->start[p][k] = (double)now[p][k];
        contacts->end[p][k] = (double)now[p][k] + first[k] + contacts->bend[p][k];
    }
}

/* the rest of its way */
static void expect_rest(pel_contact_set *contacts, double part, int32_t p)
{
    expect_at(contacts, p, part, contacts->start[p]);
    pel_vec3_scale(contacts->bend[p], (1 - part) * (1 - part), contacts->bend[p]);
}

/* Searches for the next part of the step; positions now and one substep before. is_part: only for pairs of bodies that
   stray, as far as the last search went. */
static pel_status find_again(pel_sim *sim, const pel_record *now, const pel_record *base, double share, bool is_part,
                             pel_error *error)
{
    pel_contact_set *contacts = sim->contacts;
    double until = is_part ? sim->touch->found_until : search_end(sim, share), part = passed(sim, share);
    double substeps = sim->solver.substeps * (until - share);
    pel_contacts_tell(sim);
    pel_contact_set_keep_loads(contacts);
    for (int32_t p = 0; p < contacts->vertex_count; p++) {
        if (is_part && !contacts->is_stray[contacts->group_of_point[p]])
            expect_rest(contacts, part, p);
        else
            expect_on(sim, now, base, substeps, p);
    }
    expect_tools(sim, share, until);
    expect_held(sim, share, until);
    sim->touch->found_at = share;
    sim->touch->found_until = until;
    sim->touch->is_same = false;
    double substep = contacts->list.substep;
    /* pairs that went to other triangles have changed the order of the list */
    bool keeps_looks = contacts->list.active != NULL;
    pel_status status = pel_contact_set_find_again(contacts, is_part ? contacts->is_stray : NULL,
                                                   sim->step.dt * (until - share), error);
    while (status == PEL_OK && pel_sleep_meet(sim)) {
        keeps_looks = false;
        /* pairs of what woke are found anew */
        contacts->full_count = 0;
        status = pel_contact_set_find_again(contacts, NULL, sim->step.dt * (until - share), error);
    }
    if (status == PEL_OK)
        pel_contact_set_recall_again(contacts, substep, keeps_looks);
    return status;
}

/* Whether only rigid bodies stray, at most half of the vertices: in a heap some collide in each substep. */
static bool is_few(const pel_sim *sim)
{
    const pel_contact_set *contacts = sim->contacts;
    int32_t count = 0;
    for (int32_t b = 0; b < sim->model->body_count; b++) {
        const pel_body *body = &sim->model->bodies[b];
        if (!contacts->is_stray[b])
            continue;
        count += (body->slice_end - body->slice_begin) * PEL_WIDTH;
        if (body->rigid == NULL)
            return false;
    }
    return 2 * count <= contacts->vertex_count;
}

pel_status pel_contacts_follow(pel_sim *sim, const pel_record *now, const pel_record *base, double share,
                               pel_error *error)
{
    pel_contact_set *contacts = sim->contacts;
    double found = sim->touch->found_at, substep = 1.0 / sim->solver.substeps;
    bool is_over = found < 1 && share + 0.5 * substep > sim->touch->found_until, any = strays(sim, now, share);
    bool is_part = any && !pel_contact_set_widen(contacts) && !sim->touch->is_same && is_few(sim);
    if (any && !is_part)
        contacts->horizon = pel_min(pel_max(share - found, LEAST_HORIZON * substep), 1);
    else if (is_over)
        contacts->horizon = pel_min(2 * contacts->horizon, 1);
    else if (!any)
        return PEL_OK;
    is_part = is_part && !is_over;
    return find_again(sim, now, base, share, is_part, error);
}

void pel_contacts_end_search(const pel_sim *sim, const pel_record *now)
{
    pel_contact_set *contacts = sim->contacts;
    if (strays(sim, now, 1))
        pel_contact_set_widen(contacts);
    else
        contacts->horizon = pel_min(2 * contacts->horizon, 1);
}

void pel_contacts_forget_loads(pel_sim *sim, int32_t a, int32_t b)
{
    const pel_contact_set *contacts = sim->contacts;
    for (int32_t c = 0; c < contacts->list.count; c++) {
        pel_contact_key *key = &contacts->keys[c];
        int32_t first = contacts->group_of_point[key->points[0]], second = contacts->group_of_point[key->points[3]];
        if (pel_min(first, second) != a || pel_max(first, second) != b)
            continue;
        key->load = key->earlier = 0;
        memset(key->drag, 0, sizeof key->drag);
    }
    if (sim->tools->solids != NULL && b >= sim->model->body_count)
        pel_solids_forget_loads(sim, a, b - sim->model->body_count);
}

pel_status pel_contacts_find_on_way(pel_sim *sim, pel_error *error)
{
    pel_collision_result found;
    pel_contacts_place(sim);
    sim->contacts->aim = HUGE_VAL;
    pel_status status = pel_contact_set_search_way(sim->contacts, &found, error);
    return status == PEL_OK ? pel_contact_set_add_way(sim->contacts, &found, error) : status;
}

/* ---- correction ---- */

/* Forces of corrections after the solver, from the change of velocities. Without velocities a correction reverts the
   step of the pressing forces, alpha F dt^2 / m (paper A, eq. A-5), and forces on tools are computed from these. */
static void take_corrections(pel_sim *sim)
{
    const pel_contact_set *contacts = sim->contacts;
    double dt = sim->step.dt, alpha = pel_sim_alpha(sim);
    for (int32_t c = 0; c < contacts->list.count; c++) {
        const pel_contact *contact = &contacts->list.contacts[c];
        int32_t tool = contacts->keys[c].obstacle;
        if (!(contact->multiplier > 0))
            continue;
        if (alpha > 0 && tool < 0)
            pel_contact_take(sim, tool, contact, 1 / (alpha * dt * dt));
        else
            pel_contact_take_stop(sim, tool, contact, dt);
    }
}

/* whether the solver decides by layers how near pairs come */
static bool solves_layers(const pel_sim *sim)
{
    return sim->contacts->def.has_layers || (sim->contact_in_loop && sim->stepper->minimises);
}

/* relative to the mean edge: longer motions in a part do not locate an impact; shorter ones around a corner are of what
   is pressed against it, which parts do not help, and so are those shorter than both layers are thick */
#define FAR_SHARE 0.25
#define AROUND_SHARE 0.02

/* m, motion from which a conflict counts */
static double least_way(const pel_contact_set *contacts, const pel_conflict *conflict)
{
    double far = FAR_SHARE * contacts->mean_edge, around = AROUND_SHARE * contacts->mean_edge;
    double layers = 2 * contacts->largest;
    return conflict->ends_free ? pel_min(far, pel_max(around, layers)) : far;
}

/* conflicts of fast motion, and of straight paths that cut a corner although their ends are free */
static int32_t count_far_conflicts(const pel_contact_set *contacts)
{
    int32_t count = 0;
    for (size_t c = 0; c < contacts->conflict_count; c++) {
        const pel_conflict *conflict = &contacts->conflicts[c];
        count += pel_contact_conflict_way(contacts, conflict) > least_way(contacts, conflict);
    }
    return count;
}

/* whether there are conflicts of fast motion, and halving has lowered their number until now */
static bool helps_to_halve(const pel_sim *sim, int32_t far_count)
{
    return far_count > 0 && (sim->part.conflict_count == 0 || far_count < sim->part.conflict_count);
}

/* Whether to repeat the part in two halves: surfaces move too far in it. */
static bool is_refused(pel_sim *sim)
{
    if (!pel_parts_can_halve(sim))
        return false;
    if (!solves_layers(sim))
        return sim->contacts->conflict_count > 0;
    int32_t count = count_far_conflicts(sim->contacts);
    bool helps = helps_to_halve(sim, count);
    sim->part.conflict_count = count;
    return helps;
}

/* Whether to do so at once: most conflicts are of straight ways alone. What went around an edge in the substeps is
   where it should be, and a correction would pull it off its way: stiff sheets gained energy by it. */
static bool is_refused_at_once(pel_sim *sim)
{
    const pel_contact_set *contacts = sim->contacts;
    size_t around = 0;
    for (size_t c = 0; c < contacts->conflict_count; c++)
        around += contacts->conflicts[c].ends_free;
    if (!contacts->def.has_layers || around == 0 || 2 * around < contacts->conflict_count)
        return false;
    return helps_to_halve(sim, count_far_conflicts(contacts)) && is_refused(sim);
}

/* of a correction after the solver */
static int32_t most_sweeps(const pel_sim *sim)
{
    int32_t sweeps = sim->touch->def.sweeps;
    return sim->rigids != NULL && sweeps < INT32_MAX / RIGID_SWEEPS ? RIGID_SWEEPS * sweeps : sweeps;
}

/* Search and correct until all distances hold, or find that the part is to be repeated in halves; return the remaining
   conflicts. What a solver with contacts in its loop has left is corrected only so far that the guard lets it be: its
   layers decide all else. */
static pel_status respond(pel_sim *sim, double longest, pel_error *error)
{
    pel_contact_set *contacts = sim->contacts;
    bool once = sim->touch->def.response == PEL_CONTACT_AFTER, has_layers = solves_layers(sim);
    int limit = once ? 1 : has_layers ? LAYER_ROUNDS : ROUND_LIMIT;
    contacts->aim = has_layers ? CLEAR_SHARE * contacts->guarded : HUGE_VAL;
    for (int round = 0;; round++) {
        pel_collision_result found;
        pel_status status = pel_contact_set_search_way(contacts, &found, error);
        if (status == PEL_OK)
            status = pel_pool_check(sim->pool, error);
        if (status != PEL_OK || round == limit || (round > 0 && contacts->conflict_count == 0))
            return status;
        /* without conflicts, the contacts of the solver need no correction */
        if (contacts->conflict_count == 0 && (has_layers || found.collision_count + contacts->list.count == 0))
            return PEL_OK;
        sim->part.is_refused = round == 0 && is_refused_at_once(sim);
        if (sim->part.is_refused)
            return PEL_OK;
        double began = pel_seconds();
        status = pel_contact_set_add_way(contacts, &found, error);
        if (status != PEL_OK)
            return status;
        contacts->minds_sides = round < SIDE_ROUNDS;
        const pel_contact_motion motion = motion_of(sim);
        pel_contact_set_correct(contacts, &motion, once ? 1 : most_sweeps(sim));
        /* boxes are in the list */
        pel_tools_press(sim, longest, true);
        pel_contacts_place(sim);
        contacts->statistics.solve_seconds += pel_seconds() - began;
    }
}

/* of a tool: try 0.9 of the way that the guard allowed, at least STRIDE_SHARE; at PEL_LEAST_STRIDE accept the guard */
#define SAFE_SHARE 0.9
#define STRIDE_SHARE 0.05
enum { MOST_REPEATS = 3 };

static void release_tools(pel_sim *sim)
{
    for (int32_t i = 0; i < sim->tools->count; i++)
        sim->tools->items[i].is_held_back = false;
}

/* tools take the poses of the guard */
static pel_status guard(pel_sim *sim, pel_error *error)
{
    const pel_contact_motion motion = motion_of(sim);
    pel_status status = pel_contact_guard(sim->contacts, &motion, error);
    for (int32_t i = 0; i < sim->tools->count; i++) {
        const pel_obstacle *obstacle = &sim->contacts->obstacles[i];
        sim->tools->items[i].pose = obstacle->pose;
        sim->tools->items[i].is_held_back = obstacle->is_held_back;
        sim->tools->items[i].blocked |= obstacle->is_held_back;
    }
    return status;
}

/* Shortens the stride of tools that cannot reach their pose; true = repeat the part of the step, so that forces and
   work of a tool belong to its actual motion. */
static bool shorten_strides(pel_sim *sim)
{
    bool shortened = false;
    bool may_repeat = solves_layers(sim) && sim->part.repeat_count < MOST_REPEATS;
    for (int32_t i = 0; i < sim->tools->count && may_repeat; i++) {
        pel_tool *tool = &sim->tools->items[i];
        if (!tool->is_held_back || tool->stride <= PEL_LEAST_STRIDE)
            continue;
        double whole = pel_tool_way(tool, &tool->pose_before, &tool->pose_wanted);
        double share = whole > 0 ? SAFE_SHARE * pel_tool_way(tool, &tool->pose_before, &tool->pose) / whole : 0;
        tool->stride *= share > STRIDE_SHARE ? share : STRIDE_SHARE;
        shortened = true;
    }
    sim->part.repeat_count += shortened;
    return shortened;
}

static pel_status step(pel_sim *sim, const pel_step_result *result, pel_error *error)
{
    pel_contact_set *contacts = sim->contacts;
    double way = result->way_is_known && sim->tools->count == 0 ? result->way : HUGE_VAL;
    pel_tools_press(sim, result->longest, false);
    bring_poses(sim);
    if (pel_contact_set_is_clear(contacts, sim->state->position, sim->state->position_next, way)) {
        release_tools(sim);
        sim->part.is_refused = false;
        contacts->statistics.contacts += contacts->list.count;
        return PEL_OK;
    }
    pel_contacts_place(sim);
    sim->part.is_refused = false;
    pel_status status = respond(sim, result->longest, error);
    if (status != PEL_OK || sim->part.is_refused)
        return status;
    sim->part.is_refused = contacts->conflict_count > 0 && is_refused(sim);
    if (sim->part.is_refused)
        return PEL_OK;
    double began = pel_seconds();
    int64_t fall_backs = contacts->statistics.fall_backs, tools_held = contacts->statistics.tools_held;
    release_tools(sim);
    /* the cubic may have missed some */
    if (contacts->conflict_count == 0 && contacts->def.method != PEL_CCD_CONSERVATIVE)
        status = pel_contact_look(contacts, error);
    if (status == PEL_OK && contacts->conflict_count > 0)
        status = guard(sim, error);
    if (status == PEL_OK && shorten_strides(sim)) {
        contacts->statistics.fall_backs = fall_backs;
        contacts->statistics.tools_held = tools_held;
        sim->part.is_repeated = true;
        return PEL_OK;
    }
    sim->touch->has_stepped_back = contacts->statistics.fall_backs > fall_backs;
    contacts->statistics.stepped_back += pel_part_share(sim) * (double)(contacts->statistics.fall_backs - fall_backs);
    contacts->statistics.guard_seconds += pel_seconds() - began;
    contacts->statistics.contacts += contacts->list.count;
    if (status == PEL_OK && contacts->tangles.count > 0) {
        contacts->way_is_searched = false;
        memcpy(contacts->start, contacts->end, (size_t)contacts->point_count * sizeof *contacts->start);
        status = pel_tangles_find(contacts, error);
    }
    return status;
}

pel_status pel_contacts_apply(pel_sim *sim, double time, const pel_step_result *result, pel_error *error)
{
    if (!pel_sim_has_loop_contacts(sim))
        sim->contacts->list.count = 0;
    pel_contacts_begin(&sim->contacts->list, sim->step.dt);
    if (!sim->stepper->moves_tools)
        pel_tools_move(sim, time);
    pel_status status = PEL_OK;
    sim->touch->has_stepped_back = false;
    if (pel_sleep_is_everywhere(sim)) {
        release_tools(sim);
        sim->part.is_refused = false;
    } else
        status = step(sim, result, error);
    if (status != PEL_OK || sim->part.is_refused || sim->part.is_repeated) {
        pel_tools_return(sim);
        return status;
    }
    take_corrections(sim);
    pel_tools_read(sim, time);
    pel_contacts_doubt_forces(sim, sim->touch->has_stepped_back);
    return PEL_OK;
}

void pel_contacts_tally(pel_sim *sim, double rate)
{
    pel_contact_set *contacts = sim->contacts;
    for (int32_t i = 0; i < pel_contact_list_length(&contacts->list); i++) {
        int32_t c = pel_contact_list_number(&contacts->list, i);
        const pel_contact *contact = &contacts->list.contacts[c];
        if (!(contact->multiplier > 0))
            continue;
        contacts->owed[c][0] += rate * (double)contact->multiplier;
        for (int k = 0; k < 3; k++)
            contacts->owed[c][1 + k] += rate * (double)contact->drag[k];
    }
}

void pel_contacts_tell(pel_sim *sim)
{
    pel_contact_set *contacts = sim->contacts;
    double square = contacts->list.substep * contacts->list.substep * sim->solver.substeps;
    for (int32_t i = 0; i < pel_contact_list_length(&contacts->list); i++) {
        int32_t c = pel_contact_list_number(&contacts->list, i);
        double *owed = contacts->owed[c];
        pel_contact_key *key = &contacts->keys[c];
        if (!(owed[0] > 0))
            continue;
        pel_contact contact = contacts->list.contacts[c];
        key->has_pushed = true;
        key->mean_load += owed[0];
        contact.multiplier = (pel_real)(square * owed[0]);
        for (int k = 0; k < 3; k++) {
            key->mean_drag[k] += owed[1 + k];
            contact.drag[k] = (pel_real)(square * owed[1 + k]);
        }
        pel_contact_take(sim, key->obstacle, &contact, 1 / square);
        memset(owed, 0, sizeof contacts->owed[c]);
    }
}

void pel_contacts_refresh(pel_sim *sim, const pel_record *start, bool is_first)
{
    const pel_record *positions = sim->state->position_next;
    if (!pel_contact_set_needs_look(sim->contacts, positions, is_first))
        return;
    pel_contacts_tell(sim);
    pel_contact_set_refresh(sim->contacts, positions, start, false, is_first);
}

void pel_contacts_tally_asleep(pel_sim *sim)
{
    const pel_contact_set *contacts = sim->contacts;
    for (int32_t c = 0; contacts != NULL && contacts->asleep_count > 0 && c < contacts->list.count; c++) {
        pel_contact_key *key = &contacts->keys[c];
        if (!(key->load > 0) || !pel_contact_sleeps(contacts, key->points))
            continue;
        pel_contact contact = contacts->list.contacts[c];
        contact.multiplier = (pel_real)key->load;
        for (int k = 0; k < 3; k++)
            contact.drag[k] = (pel_real)key->drag[k];
        key->has_pushed = true;
        pel_contact_take(sim, key->obstacle, &contact, 1);
    }
    if (contacts != NULL && contacts->asleep_count > 0 && sim->tools->solids != NULL)
        pel_solids_tally_asleep(sim);
}

pel_status pel_contacts_begin_step(pel_sim *sim, pel_error *error)
{
    pel_contact_set *contacts = sim->contacts;
    /* statistics of a body that does not move equal those of one loaded from a snapshot */
    contacts->way_is_searched = false;
    if (is_present(sim) && contacts->tangles.is_known)
        return PEL_OK;
    pel_contacts_place_start(sim);
    pel_status status = pel_contacts_update_surface(sim, error);
    return status == PEL_OK && !contacts->tangles.is_known ? pel_tangles_find(contacts, error) : status;
}

/* ---- questions ---- */

void pel_sim_get_contact_statistics(const pel_sim *sim, pel_contact_statistics *statistics)
{
    if (sim == NULL || statistics == NULL)
        return;
    *statistics = sim->contacts != NULL ? sim->contacts->statistics : (pel_contact_statistics){0};
}

double pel_sim_contact_thickness(const pel_sim *sim)
{
    return sim != NULL && sim->contacts != NULL ? sim->contacts->def.thickness : 0;
}

double pel_sim_body_contact_thickness(const pel_sim *sim, int32_t body)
{
    if (sim == NULL || sim->contacts == NULL || body < 0 || body >= sim->model->body_count)
        return 0;
    return sim->contacts->groups[body].thickness;
}
