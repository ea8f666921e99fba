/* All surfaces as one: the present triangles of the bodies and those of obstacles. */
#include "contact/set.h"

#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "geom/wide4.h"

#include <string.h>

/* of the mean edge: motion for which the collider keeps pairs */
#define MARGIN_SHARE 0.2

/* ---- obstacles ---- */

static bool is_surface(const pel_obstacle *obstacle)
{
    return obstacle->presses && (obstacle->mesh != NULL || !pel_solid_is_round(&obstacle->solid));
}

static const pel_solid_row *row_of(const pel_obstacle *obstacle)
{
    return &pel_solid_rows[obstacle->solid.shape];
}

static int32_t triangle_count_of(const pel_obstacle *obstacle)
{
    if (!is_surface(obstacle))
        return 0;
    return obstacle->mesh != NULL ? obstacle->mesh->triangle_count : row_of(obstacle)->triangle_count;
}

/* its points, from `point` on */
static void set_points(pel_obstacle *obstacle, int32_t point)
{
    const pel_mesh *mesh = obstacle->mesh;
    obstacle->point_begin = obstacle->point_end = point;
    if (!is_surface(obstacle))
        return;
    obstacle->point_end += mesh != NULL ? mesh->vertex_count : row_of(obstacle)->corner_count;
    obstacle->local = mesh != NULL ? (const double(*)[3])mesh->positions : (const double(*)[3])obstacle->corners;
    for (int32_t i = 0; mesh == NULL && i < row_of(obstacle)->corner_count; i++)
        pel_solid_corner(&obstacle->solid, i, obstacle->corners[i]);
}

int32_t pel_contact_obstacle_of(const pel_contact_set *set, int32_t point)
{
    return point < set->vertex_count ? -1 : set->group_of_point[point] - set->def.body_count;
}

void pel_obstacle_points(const pel_obstacle *obstacle, const pel_pose *pose, double (*points)[3])
{
    for (int32_t p = 0; p < obstacle->point_end - obstacle->point_begin; p++)
        pel_pose_to_world(pose, obstacle->local[p], points[p]);
}

/* ---- points ---- */

enum { POINT_PARTS = 64 };

/* false if the point was there already */
static bool set_point(const double x[3], double point[3])
{
    bool differs = x[0] != point[0] || x[1] != point[1] || x[2] != point[2];
    pel_vec3_copy(x, point);
    return differs;
}

typedef struct point_job {
    pel_contact_set *set;
    const pel_record *position, *next;
    bool differs[POINT_PARTS];
} point_job;

/* whether a vertex is where the point is; reads the number behind the point as well */
static bool is_at(pel_record record, const double point[3])
{
    wide4 x = __builtin_convertvector(record, wide4), y;
    memcpy(&y, point, sizeof y);
    wide4_mask same = x == y;
    same[3] = -1;
    return wide4_all(same);
}

/* returns whether a point differs; looks at no more of them than that takes */
static bool set_range(const pel_record *records, int64_t begin, int64_t end, double (*points)[3])
{
    while (begin < end && is_at(records[begin], points[begin]))
        begin++;
    for (int64_t p = begin; p < end; p++)
        pel_vertex_position(records, (int32_t)p, points[p]);
    return begin < end;
}

static void set_part(void *context, int32_t part)
{
    point_job *job = context;
    pel_contact_set *set = job->set;
    int64_t count = set->vertex_count, begin = count * part / POINT_PARTS, end = count * (part + 1) / POINT_PARTS;
    bool moved = set_range(job->position, begin, end, set->start);
    job->differs[part] = set_range(job->next, begin, end, set->end) || moved;
}

void pel_contact_set_place(pel_contact_set *set, const pel_record *position, const pel_record *next)
{
    point_job job = {.set = set, .position = position, .next = next};
    pel_pool_run(set->def.pool, POINT_PARTS, set_part, &job);
    bool differs = false;
    for (int part = 0; part < POINT_PARTS; part++)
        differs |= job.differs[part];
    set->way_is_searched &= !differs;
    pel_contact_set_place_obstacles(set);
}

void pel_contact_set_place_obstacles(pel_contact_set *set)
{
    bool differs = false;
    double x[3];
    for (int32_t i = 0; i < set->def.obstacle_count; i++) {
        const pel_obstacle *obstacle = &set->obstacles[i];
        for (int32_t p = obstacle->point_begin; p < obstacle->point_end; p++) {
            pel_pose_to_world(&obstacle->before, obstacle->local[p - obstacle->point_begin], x);
            differs |= set_point(x, set->start[p]);
            pel_pose_to_world(&obstacle->pose, obstacle->local[p - obstacle->point_begin], x);
            differs |= set_point(x, set->end[p]);
        }
    }
    set->way_is_searched &= !differs;
}

void pel_contact_set_place_start(pel_contact_set *set, const pel_record *position)
{
    set->way_is_searched = set->was_clear = false;
    for (int32_t p = 0; p < set->vertex_count; p++)
        pel_vertex_position(position, p, set->start[p]);
    for (int32_t i = 0; i < set->def.obstacle_count; i++)
        pel_obstacle_points(&set->obstacles[i], &set->obstacles[i].pose, set->start + set->obstacles[i].point_begin);
}

/* ---- triangles ---- */

static void add_obstacles(pel_contact_set *set)
{
    for (int32_t i = 0; i < set->def.obstacle_count; i++) {
        const pel_obstacle *obstacle = &set->obstacles[i];
        int32_t count = triangle_count_of(obstacle), first = obstacle->point_begin;
        const int32_t(*triangles)[3] =
            obstacle->mesh != NULL ? (const int32_t(*)[3])obstacle->mesh->triangles : row_of(obstacle)->triangles;
        for (int32_t t = 0; t < count; t++)
            pel_contact_surface_add(
                set, (const int32_t[3]){first + triangles[t][0], first + triangles[t][1], first + triangles[t][2]});
    }
}

pel_status pel_contact_surface_begin(pel_contact_set *set, pel_error *error)
{
    size_t limit = (size_t)(set->obstacle_triangle_count + set->def.triangle_limit);
    set->way_is_searched = false;
    set->next_count = 0;
    if (set->next_triangles == NULL)
        set->next_triangles = pel_allocate(limit, sizeof *set->next_triangles);
    if (set->next_triangles == NULL)
        return pel_fail_memory(error);
    add_obstacles(set);
    return PEL_OK;
}

void pel_contact_surface_add(pel_contact_set *set, const int32_t corners[3])
{
    memcpy(set->next_triangles[set->next_count++], corners, sizeof set->next_triangles[0]);
}

/* of the bodies at rest: obstacles may have far larger triangles */
static double mean_edge(const pel_contact_set *set)
{
    double sum = 0;
    int64_t count = 0;
    for (int32_t t = set->obstacle_triangle_count; t < set->next_count; t++) {
        const int32_t *v = set->next_triangles[t];
        for (int c = 0; c < 3; c++, count++)
            sum += pel_vec3_distance(set->shape[v[c]], set->shape[v[(c + 1) % 3]]);
    }
    if (count == 0)
        return set->def.shortest_edge;
    return isfinite(sum) ? sum / (double)count : 0;
}

static pel_status create_collider(pel_contact_set *set, pel_error *error)
{
    const pel_mesh mesh = {.vertex_count = set->point_count,
                           .triangle_count = set->next_count,
                           .positions = set->start,
                           .triangles = set->next_triangles};
    pel_collider_def def = pel_collider_def_default();
    def.mesh = &mesh;
    set->mean_edge = mean_edge(set);
    def.margin = MARGIN_SHARE * set->mean_edge;
    def.memory_limit = set->def.memory_limit;
    pel_status status = pel_collider_create(&def, &set->collider, error);
    if (status != PEL_OK)
        return status;
    pel_collider_use_pool(set->collider, set->def.pool);
    const pel_collision_groups groups = {set->group_of_point, set->may_meet,
                                         set->def.body_count + set->def.obstacle_count, (const double(*)[3])set->shape};
    pel_free(set->next_triangles); /* it has a copy */
    set->next_triangles = NULL;
    return pel_collider_use_groups(set->collider, &groups, (const double(*)[3])set->start, error);
}

/* Which bodies are convex, and how their pairs are found, must not depend on when the surface was made. */
static void find_shape(pel_contact_set *set)
{
    static const pel_pose none = {.rotation = {0, 0, 0, 1}};
    for (int32_t p = 0; p < set->vertex_count; p++)
        pel_vertex_position(set->def.rest, p, set->shape[p]);
    for (int32_t i = 0; i < set->def.obstacle_count; i++)
        pel_obstacle_points(&set->obstacles[i], &none, set->shape + set->obstacles[i].point_begin);
}

pel_status pel_contact_surface_finish(pel_contact_set *set, bool is_known, pel_error *error)
{
    pel_status status;
    find_shape(set);
    if (set->collider == NULL)
        status = create_collider(set, error);
    else
        status = (is_known ? pel_collider_recall
                           : pel_collider_set_surface)(set->collider, (const double(*)[3])set->start, set->point_count,
                                                       set->next_triangles, set->next_count, error);
    if (status != PEL_OK)
        return status;
    set->next_triangles = NULL;
    set->triangles = pel_collider_tree(set->collider)->triangles;
    set->triangle_count = set->next_count;
    pel_contact_heights_set_surface(set);
    pel_contact_find_fans(set);
    return PEL_OK;
}

pel_mesh pel_contact_mesh(const pel_contact_set *set)
{
    return (pel_mesh){.vertex_count = set->point_count,
                      .triangle_count = set->triangle_count,
                      .positions = set->start,
                      .triangles = (int32_t(*)[3])set->triangles};
}

/* ---- creation ---- */

static bool is_rigid(const pel_contact_set *set, int32_t body)
{
    for (int32_t i = 0; set->def.rigids != NULL && i < set->def.rigids->count; i++)
        if (set->def.body_of_slice[set->def.rigids->items[i].begin / PEL_WIDTH] == body)
            return true;
    return false;
}

static void set_groups(pel_contact_set *set)
{
    int32_t body_count = set->def.body_count, count = body_count + set->def.obstacle_count;
    for (int32_t p = 0; p < set->vertex_count; p++)
        set->group_of_point[p] = set->def.body_of_slice[p / PEL_WIDTH];
    for (int32_t i = 0; i < set->def.obstacle_count; i++)
        for (int32_t p = set->obstacles[i].point_begin; p < set->obstacles[i].point_end; p++)
            set->group_of_point[p] = body_count + i;
    for (int32_t a = 0; a < body_count; a++) {
        for (int32_t b = 0; b < body_count; b++)
            set->may_meet[a * count + b] = a == b ? set->def.self && !is_rigid(set, a) : set->def.between;
        for (int32_t i = 0; i < set->def.obstacle_count; i++) {
            bool meets = set->obstacles[i].body < 0 || set->obstacles[i].body == a;
            set->may_meet[a * count + body_count + i] = set->may_meet[(body_count + i) * count + a] = meets;
        }
    }
}

static pel_status allocate_surface(pel_contact_set *set, pel_error *error)
{
    size_t group_count = (size_t)(set->def.body_count + set->def.obstacle_count);
    size_t point_count = (size_t)set->point_count, obstacle_points = point_count - (size_t)set->vertex_count;
    size_t triangles = (size_t)(set->obstacle_triangle_count + set->def.triangle_limit);
    size_t most = triangles > point_count ? triangles : point_count;
    /* start and end have one more: points are read four numbers at once */
    bool made = PEL_ALLOCATE_ALL(
        PEL_ROOM(set->group_of_point, point_count), PEL_ROOM(set->may_meet, group_count * group_count),
        PEL_ROOM(set->is_asleep, group_count), PEL_ROOM(set->start, point_count + 1),
        PEL_ROOM(set->end, point_count + 1), PEL_ROOM(set->home, set->def.has_layers ? point_count : 0),
        PEL_ROOM(set->shape, point_count), PEL_ROOM(set->is_fan, point_count), PEL_ROOM(set->bend, set->vertex_count),
        PEL_ROOM(set->is_stray, group_count), PEL_ROOM(set->substep_start, obstacle_points),
        PEL_ROOM(set->substep_end, obstacle_points), PEL_ROOM(set->heights.bounds, triangles),
        PEL_ROOM(set->heights.places, set->vertex_count), PEL_ROOM(set->heights.parts, most / PEL_HEIGHT_CHUNK + 1));
    return made ? PEL_OK : pel_fail_memory(error);
}

pel_status pel_contact_surface_create(pel_contact_set *set, pel_error *error)
{
    set->point_count = set->vertex_count;
    for (int32_t i = 0; i < set->def.obstacle_count; i++) {
        set_points(&set->obstacles[i], set->point_count);
        set->point_count = set->obstacles[i].point_end;
        set->obstacle_triangle_count += triangle_count_of(&set->obstacles[i]);
    }
    pel_status status = allocate_surface(set, error);
    if (status != PEL_OK)
        return status;
    set_groups(set);
    return pel_contact_balls_create(set, error);
}

void pel_contact_count_search(pel_contact_set *set, const pel_collision_result *found)
{
    pel_contact_statistics *sum = &set->statistics;
    const pel_ccd_statistics *kinds[] = {&found->vertex_face, &found->edge_edge};
    for (int i = 0; i < 2; i++) {
        sum->candidates += kinds[i]->queries;
        sum->passed_filter += kinds[i]->passed_filter;
        sum->passed_hull += kinds[i]->passed_hull;
        sum->cubics += kinds[i]->cubics;
    }
}
