/* Forces of contacts. Every push of a contact passes here, whatever the method, so that each vertex, body, obstacle and
   pin knows what acted on it: a contact with the force f on the weighted sum of its points acts on each point by its
   weight times f (the transpose of the sum), so that forces inside a body and between two of them add up to zero, and
   against an obstacle to what that feels. */
#include "action/force.h"

#include "base/assert.h"
#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"

#include <string.h>

static size_t pair_count(const pel_contact_forces *forces)
{
    return (size_t)forces->body_count * (size_t)forces->group_count;
}

/* ---- pages ---- */

static int32_t page_count(const pel_contact_forces *forces)
{
    return (forces->vertex_count + PEL_FORCE_PAGE - 1) / PEL_FORCE_PAGE;
}

static pel_record *make_page(void)
{
    return pel_allocate_aligned(PEL_FORCE_PAGE, sizeof(pel_record));
}

/* with_all: none is made later */
static bool allocate_pages(const pel_contact_forces *forces, bool with_all, pel_force_pages *made)
{
    bool room =
        PEL_ALLOCATE_ALL(PEL_ROOM(made->pages, page_count(forces)), PEL_ROOM(made->is_touched, page_count(forces)));
    for (int32_t p = 0; room && with_all && p < page_count(forces); p++) {
        made->pages[p] = make_page();
        room = made->pages[p] != NULL;
    }
    return room;
}

static void destroy_pages(const pel_contact_forces *forces, pel_force_pages *pages)
{
    for (int32_t p = 0; pages->pages != NULL && p < page_count(forces); p++)
        pel_free(pages->pages[p]);
    pel_free(pages->pages);
    pel_free(pages->is_touched);
}

/* a page to write to; null when there is no memory for it */
static pel_record *touch_page(pel_contact_forces *forces, pel_force_pages *pages, int32_t p)
{
    PEL_ASSERT_INDEX(p, page_count(forces));
    if (pages->pages[p] == NULL)
        pages->pages[p] = make_page();
    if (pages->pages[p] == NULL)
        forces->is_short = true;
    else
        pages->is_touched[p] = 1;
    return pages->pages[p];
}

static void clear_page(pel_force_pages *pages, int32_t p)
{
    if (pages->is_touched[p])
        memset(pages->pages[p], 0, PEL_FORCE_PAGE * sizeof **pages->pages);
    pages->is_touched[p] = 0;
}

void pel_contact_force_add(pel_contact_forces *forces, pel_force_pages *to, int32_t v, const double force[3])
{
    PEL_ASSERT_INDEX(v, forces->vertex_count);
    pel_record *page = touch_page(forces, to, v / PEL_FORCE_PAGE);
    for (int k = 0; page != NULL && k < 3; k++)
        page[v % PEL_FORCE_PAGE][k] += (pel_real)force[k];
}

void pel_contact_forces_read(const pel_contact_forces *forces, int32_t begin, int32_t count, pel_record *page)
{
    PEL_ASSERT(begin % PEL_FORCE_PAGE == 0 && begin >= 0 && begin + count <= forces->vertex_count);
    const pel_record *own = forces->vertex.pages[begin / PEL_FORCE_PAGE];
    if (own != NULL)
        memcpy(page, own, (size_t)count * sizeof *page);
    else
        memset(page, 0, (size_t)count * sizeof *page);
}

static bool is_zero(const pel_record *page, int32_t count)
{
    bool zero = true;
    for (int32_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++)
            zero &= page[i][k] == 0;
    return zero;
}

void pel_contact_forces_write(pel_contact_forces *forces, int32_t begin, int32_t count, const pel_record *page)
{
    int32_t p = begin / PEL_FORCE_PAGE;
    clear_page(&forces->vertex, p);
    pel_record *own = is_zero(page, count) ? NULL : touch_page(forces, &forces->vertex, p);
    if (own != NULL)
        memcpy(own, page, (size_t)count * sizeof *own);
}

/* ---- of a step ---- */

pel_status pel_contact_forces_create(int32_t vertex_count, int32_t body_count, int32_t obstacle_count,
                                     const int32_t *body_of_slice, pel_contact_forces *forces, pel_error *error)
{
    *forces = (pel_contact_forces){.vertex_count = vertex_count,
                                   .body_count = body_count,
                                   .group_count = body_count + obstacle_count,
                                   .body_of_slice = body_of_slice};
    bool with_all = obstacle_count > 0;
    bool made =
        allocate_pages(forces, with_all, &forces->vertex) && allocate_pages(forces, with_all, &forces->vertex_next);
    forces->pair = pel_allocate(pair_count(forces), sizeof *forces->pair);
    forces->pair_next = pel_allocate(pair_count(forces), sizeof *forces->pair_next);
    forces->is_kept = made && forces->pair != NULL && forces->pair_next != NULL;
    return forces->is_kept ? PEL_OK : pel_fail_memory(error);
}

void pel_contact_forces_destroy(pel_contact_forces *forces)
{
    destroy_pages(forces, &forces->vertex);
    destroy_pages(forces, &forces->vertex_next);
    pel_free(forces->pair);
    pel_free(forces->pair_next);
    pel_contact_records_destroy(forces);
}

void pel_contact_forces_begin(pel_contact_forces *forces)
{
    if (!forces->is_kept)
        return;
    for (int32_t p = 0; p < page_count(forces); p++)
        clear_page(&forces->vertex_next, p);
    memset(forces->pair_next, 0, pair_count(forces) * sizeof *forces->pair_next);
    pel_contact_records_begin(forces);
}

/* forces of a step in parts are means over its parts */
static void add_part(pel_contact_forces *forces, double share, bool is_first)
{
    double *sum = (double *)forces->pair;
    const double *own = (const double *)forces->pair_next;
    for (int32_t p = 0; p < page_count(forces); p++) {
        if (is_first)
            clear_page(&forces->vertex, p);
        const pel_record *next = forces->vertex_next.pages[p];
        pel_record *page = forces->vertex_next.is_touched[p] ? touch_page(forces, &forces->vertex, p) : NULL;
        for (int32_t i = 0; page != NULL && i < PEL_FORCE_PAGE; i++)
            page[i] += (pel_real)share * next[i];
    }
    for (size_t i = 0; i < pair_count(forces) * sizeof *forces->pair / sizeof *sum; i++)
        sum[i] = (is_first ? 0 : sum[i]) + share * own[i];
}

void pel_contact_forces_accept(pel_contact_forces *forces, double share, bool is_first)
{
    pel_contact_records_accept(forces, share, is_first);
    if (forces->is_kept && share < 1) {
        add_part(forces, share, is_first);
        return;
    }
    pel_force_pages vertex = forces->vertex;
    pel_pair_force *pair = forces->pair;
    forces->vertex = forces->vertex_next;
    forces->vertex_next = vertex;
    forces->pair = forces->pair_next;
    forces->pair_next = pair;
}

/* ---- actions ---- */

static int32_t body_of(const pel_contact_forces *forces, int32_t v)
{
    return forces->body_of_slice[v / PEL_WIDTH];
}

static void add_to_vertex(pel_contact_forces *forces, int32_t v, double share, const double force[3])
{
    double part[3];
    pel_vec3_scale(force, share, part);
    pel_contact_force_add(forces, &forces->vertex_next, v, part);
}

/* the two groups of an action, the lower one first, and the sum of weights of that one; false inside a body */
static bool find_groups(const pel_contact_forces *forces, const pel_contact_action *action, int32_t groups[2],
                        double *side)
{
    groups[0] = groups[1] = -1;
    if (action->obstacle >= 0)
        groups[1] = forces->body_count + action->obstacle;
    for (int i = 0; i < 4; i++) {
        int32_t body = body_of(forces, action->vertices[i]);
        if (action->weights[i] == 0 || body == groups[0])
            continue;
        groups[1] = groups[0] > body ? groups[0] : groups[0] < 0 ? groups[1] : body;
        groups[0] = groups[0] < 0 || body < groups[0] ? body : groups[0];
    }
    *side = 0;
    for (int i = 0; i < 4; i++)
        *side += body_of(forces, action->vertices[i]) == groups[0] ? action->weights[i] : 0;
    return groups[0] >= 0 && groups[1] >= 0;
}

/* way of the weighted sum since the start of the step, less that of the obstacle on its other side */
static void find_way(const pel_contact_way *given, const pel_contact_action *action, const double point[3], double side,
                     double way[3])
{
    pel_vec3_set(way, 0, 0, 0);
    for (int i = 0; i < 4; i++) {
        double x[3], start[3];
        pel_vertex_position(given->next, action->vertices[i], x);
        pel_vertex_position(given->position, action->vertices[i], start);
        pel_vec3_subtract(x, start, x);
        pel_vec3_along(way, action->weights[i], x, way);
    }
    if (action->obstacle < 0)
        return;
    double local[3], before[3];
    pel_pose_to_local(given->pose, point, local);
    pel_pose_to_world(given->before, local, before);
    pel_vec3_subtract(point, before, before);
    pel_vec3_along(way, -side, before, way);
}

void pel_contact_forces_add(pel_contact_forces *forces, const pel_contact_way *given, const pel_contact_action *action)
{
    int32_t groups[2];
    double side, point[3] = {0, 0, 0}, sum = 0, way[3], x[3], load = pel_vec3_length(action->load);
    pel_contact_records_add(forces, action);
    for (int i = 0; i < 4; i++)
        if (action->weights[i] != 0)
            add_to_vertex(forces, action->vertices[i], action->weights[i], action->force);
    if (!find_groups(forces, action, groups, &side))
        return;
    for (int i = 0; i < 4; i++) {
        pel_vertex_position(given->next, action->vertices[i], x);
        pel_vec3_along(point, fabs(action->weights[i]), x, point);
        sum += fabs(action->weights[i]);
    }
    pel_vec3_scale(point, 1 / sum, point);
    find_way(given, action, point, side, way);
    pel_pair_force *pair = &forces->pair_next[groups[0] * forces->group_count + groups[1]];
    pel_vec3_along(pair->force, side, action->force, pair->force);
    pel_vec3_along(pair->load, side, action->load, pair->load);
    pel_vec3_along(pair->point, load, point, pair->point);
    /* the load points away from the other side */
    pair->approach -= pel_vec3_dot(way, action->load);
    pair->load_size += load;
}

void pel_contact_forces_add_at(pel_contact_forces *forces, int32_t v, int32_t obstacle, const double force[3])
{
    int32_t group = forces->body_count + obstacle;
    const int32_t vertices[4] = {v, v, v, v};
    pel_contact_action action = {.vertices = vertices, .weights = {1, 0, 0, 0}, .obstacle = obstacle};
    pel_vec3_copy(force, action.force);
    pel_contact_records_add(forces, &action);
    pel_pair_force *pair = &forces->pair_next[body_of(forces, v) * forces->group_count + group];
    add_to_vertex(forces, v, 1, force);
    pel_vec3_add(pair->force, force, pair->force);
}
