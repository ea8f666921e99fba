/* All surfaces of a simulation as one: the bodies' present triangles and those of the tools. */
#include "base/memory.h"
#include "base/status.h"
#include "geom/wide4.h"
#include "sim/contact.h"
#include "sim/tool.h"

#include <string.h>

enum { BOX_CORNERS = 8, BOX_TRIANGLES = 12 };

static const int32_t box_triangles[BOX_TRIANGLES][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6},
                                                        {0, 1, 4}, {1, 5, 4}, {2, 6, 3}, {3, 6, 7},
                                                        {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};

/* ---- tools ---- */

static bool is_surface(const pel_tool *tool)
{
    return tool->press && (tool->mesh != NULL || tool->solid.kind == PEL_SOLID_BOX);
}

static int32_t tool_triangle_count(const pel_tool *tool)
{
    if (!is_surface(tool))
        return 0;
    return tool->mesh != NULL ? tool->mesh->triangle_count : BOX_TRIANGLES;
}

static void set_tool(const pel_tool *tool, pel_contact_tool *own, int32_t point)
{
    own->point_begin = own->point_end = point;
    if (!is_surface(tool))
        return;
    own->point_end += tool->mesh != NULL ? tool->mesh->vertex_count : BOX_CORNERS;
    own->local = tool->mesh != NULL ? (const double(*)[3])tool->mesh->positions : (const double(*)[3])own->corners;
    for (int i = 0; i < BOX_CORNERS; i++)
        for (int k = 0; k < 3; k++)
            own->corners[i][k] = (i >> k & 1 ? 1 : -1) * tool->solid.half_extents[k];
}

static void add_tool_triangles(pel_sim_contacts *contacts, const pel_tool *tool, const pel_contact_tool *own)
{
    int32_t count = tool_triangle_count(tool);
    for (int32_t t = 0; t < count; t++)
        for (int c = 0; c < 3; c++)
            contacts->triangles[contacts->triangle_count + t][c] =
                own->point_begin + (tool->mesh != NULL ? tool->mesh->triangles[t][c] : box_triangles[t][c]);
    contacts->triangle_count += count;
}

int32_t pel_contact_tool_of(const pel_sim *sim, int32_t point)
{
    const pel_sim_contacts *contacts = sim->contacts;
    return point < contacts->place_count ? -1 : contacts->group_of_point[point] - sim->model->body_count;
}

void pel_contact_tool_points(const pel_contact_tool *tool, const pel_pose *pose, double (*points)[3])
{
    for (int32_t p = tool->point_begin; p < tool->point_end; p++)
        pel_pose_to_world(pose, tool->local[p - tool->point_begin], points[p]);
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
    pel_sim *sim;
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
    const pel_state *state = job->sim->state;
    pel_sim_contacts *contacts = job->sim->contacts;
    int64_t count = contacts->place_count, begin = count * part / POINT_PARTS, end = count * (part + 1) / POINT_PARTS;
    bool moved = set_range(state->position, begin, end, contacts->start);
    job->differs[part] = set_range(state->position_next, begin, end, contacts->end) || moved;
}

void pel_contact_points(pel_sim *sim)
{
    pel_sim_contacts *contacts = sim->contacts;
    point_job job = {.sim = sim};
    pel_pool_run(sim->pool, POINT_PARTS, set_part, &job);
    bool differs = false;
    double x[3];
    for (int part = 0; part < POINT_PARTS; part++)
        differs |= job.differs[part];
    for (int32_t i = 0; i < sim->tool_count; i++) {
        const pel_contact_tool *tool = &contacts->tools[i];
        for (int32_t p = tool->point_begin; p < tool->point_end; p++) {
            pel_pose_to_world(&sim->tools[i].pose_before, tool->local[p - tool->point_begin], x);
            differs |= set_point(x, contacts->start[p]);
            pel_pose_to_world(&sim->tools[i].pose, tool->local[p - tool->point_begin], x);
            differs |= set_point(x, contacts->end[p]);
        }
    }
    contacts->way_is_searched &= !differs;
}

void pel_contact_present_points(pel_sim *sim)
{
    pel_sim_contacts *contacts = sim->contacts;
    contacts->way_is_searched = false;
    for (int32_t p = 0; p < contacts->place_count; p++)
        pel_vertex_position(sim->state->position, p, contacts->start[p]);
    for (int32_t i = 0; i < sim->tool_count; i++)
        pel_contact_tool_points(&contacts->tools[i], &sim->tools[i].pose, contacts->start);
}

/* ---- triangles ---- */

static void set_triangles(pel_sim *sim)
{
    pel_sim_contacts *contacts = sim->contacts;
    contacts->triangle_count = 0;
    for (int32_t i = 0; i < sim->tool_count; i++)
        add_tool_triangles(contacts, &sim->tools[i], &contacts->tools[i]);
    for (int32_t b = 0; b < sim->model->body_count; b++) {
        int32_t count = pel_surface_count(sim->model, b), begin = sim->model->triangle_begin[b];
        const pel_front_triangle *surface = pel_surface_in_order(sim, b);
        for (int32_t i = 0; i < count; i++)
            memcpy(contacts->triangles[contacts->triangle_count++],
                   sim->model->triangles[begin + (surface != NULL ? pel_surface_number(&surface[i]) : i)],
                   sizeof contacts->triangles[0]);
        contacts->revisions[b] = pel_sim_surface_revision(sim, b);
    }
}

/* what the collider knows is of the present surface */
static bool is_of_present(const pel_sim *sim)
{
    for (int32_t b = 0; b < sim->model->body_count; b++)
        if (sim->contacts->revisions[b] != pel_sim_surface_revision(sim, b))
            return false;
    return true;
}

bool pel_contact_surface_is_present(const pel_sim *sim)
{
    return !sim->contacts->is_loaded && is_of_present(sim);
}

pel_status pel_contact_surface_update(pel_sim *sim, pel_error *error)
{
    pel_sim_contacts *contacts = sim->contacts;
    if (pel_contact_surface_is_present(sim))
        return PEL_OK;
    bool recalls = contacts->is_loaded && is_of_present(sim);
    set_triangles(sim);
    contacts->way_is_searched = false;
    pel_status status = (recalls ? pel_collider_recall : pel_collider_set_surface)(
        contacts->collider, (const double(*)[3])contacts->start, contacts->point_count,
        (const int32_t(*)[3])contacts->triangles, contacts->triangle_count, error);
    if (status == PEL_OK)
        contacts->is_loaded = false;
    else if (!recalls)
        contacts->revisions[0] = -1;
    return status;
}

/* ---- creation ---- */

/* bodies and tools as groups */
static void set_groups(pel_sim *sim)
{
    pel_sim_contacts *contacts = sim->contacts;
    int32_t body_count = sim->model->body_count, count = body_count + sim->tool_count;
    for (int32_t p = 0; p < contacts->place_count; p++)
        contacts->group_of_point[p] = sim->model->body_of_slice[p / PEL_WIDTH];
    for (int32_t i = 0; i < sim->tool_count; i++)
        for (int32_t p = contacts->tools[i].point_begin; p < contacts->tools[i].point_end; p++)
            contacts->group_of_point[p] = body_count + i;
    for (int32_t a = 0; a < body_count; a++) {
        for (int32_t b = 0; b < body_count; b++)
            contacts->may_meet[a * count + b] = a == b ? contacts->def.self : contacts->def.between;
        for (int32_t i = 0; i < sim->tool_count; i++) {
            bool meets = sim->tools[i].body < 0 || sim->tools[i].body == a;
            contacts->may_meet[a * count + body_count + i] = contacts->may_meet[(body_count + i) * count + a] = meets;
        }
    }
}

static void set_friction(pel_sim *sim)
{
    pel_sim_contacts *contacts = sim->contacts;
    for (int32_t i = 0; i < sim->model->body_count + sim->tool_count; i++) {
        int32_t tool = i - sim->model->body_count;
        double own = tool < 0 ? sim->model->bodies[i].friction : sim->tools[tool].friction;
        contacts->friction_of_group[i] = own >= 0 ? own : contacts->def.friction;
    }
}

double pel_contact_friction(const pel_sim_contacts *contacts, int32_t a, int32_t b)
{
    double first = contacts->friction_of_group[a], second = contacts->friction_of_group[b];
    return first == second ? first : sqrt(first * second);
}

double pel_contact_thickness(const pel_sim_contacts *contacts, int32_t a, int32_t b)
{
    return 0.5 * (contacts->thickness_of_group[a] + contacts->thickness_of_group[b]);
}

static pel_status allocate_surface(pel_sim *sim, pel_error *error)
{
    pel_sim_contacts *contacts = sim->contacts;
    const pel_model *model = sim->model;
    int32_t point_count = contacts->place_count, group_count = model->body_count + sim->tool_count;
    contacts->tools = pel_allocate((size_t)sim->tool_count, sizeof *contacts->tools);
    if (contacts->tools == NULL)
        return pel_fail_memory(error);
    contacts->triangle_limit = model->triangle_begin[model->body_count];
    for (int32_t i = 0; i < sim->tool_count; i++) {
        set_tool(&sim->tools[i], &contacts->tools[i], point_count);
        point_count = contacts->tools[i].point_end;
        contacts->triangle_limit += tool_triangle_count(&sim->tools[i]);
    }
    contacts->point_count = point_count;
    contacts->triangles = pel_allocate((size_t)contacts->triangle_limit, sizeof *contacts->triangles);
    contacts->group_of_point = pel_allocate((size_t)point_count, sizeof *contacts->group_of_point);
    contacts->may_meet = pel_allocate((size_t)group_count * (size_t)group_count, sizeof *contacts->may_meet);
    contacts->friction_of_group = pel_allocate((size_t)group_count, sizeof *contacts->friction_of_group);
    contacts->revisions = pel_allocate((size_t)model->body_count, sizeof *contacts->revisions);
    /* one more: points are read four numbers at once */
    contacts->start = pel_allocate((size_t)point_count + 1, sizeof *contacts->start);
    contacts->end = pel_allocate((size_t)point_count + 1, sizeof *contacts->end);
    size_t tool_points = (size_t)(point_count - contacts->place_count);
    contacts->substep_start = pel_allocate(tool_points, sizeof *contacts->substep_start);
    contacts->substep_end = pel_allocate(tool_points, sizeof *contacts->substep_end);
    bool made = contacts->triangles != NULL && contacts->group_of_point != NULL && contacts->may_meet != NULL &&
                contacts->friction_of_group != NULL && contacts->revisions != NULL && contacts->start != NULL &&
                contacts->end != NULL && contacts->substep_start != NULL && contacts->substep_end != NULL;
    return made ? PEL_OK : pel_fail_memory(error);
}

/* of the bodies: tools may have far larger triangles */
static double mean_edge(const pel_sim_contacts *contacts)
{
    double sum = 0;
    int64_t count = 0;
    for (int32_t t = 0; t < contacts->triangle_count; t++)
        for (int c = 0; c < 3 && contacts->triangles[t][0] < contacts->place_count; c++, count++)
            sum += pel_vec3_distance(contacts->start[contacts->triangles[t][c]],
                                     contacts->start[contacts->triangles[t][(c + 1) % 3]]);
    return isfinite(sum) ? sum / (double)count : 0;
}

pel_mesh pel_contact_mesh(const pel_sim *sim)
{
    const pel_sim_contacts *contacts = sim->contacts;
    return (pel_mesh){.vertex_count = contacts->point_count,
                      .triangle_count = contacts->triangle_count,
                      .positions = contacts->start,
                      .triangles = contacts->triangles};
}

pel_status pel_contact_surface_create(pel_sim *sim, pel_error *error)
{
    pel_sim_contacts *contacts = sim->contacts;
    contacts->place_count = sim->model->vertex_count;
    pel_status status = allocate_surface(sim, error);
    if (status != PEL_OK)
        return status;
    set_groups(sim);
    set_friction(sim);
    set_triangles(sim);
    pel_contact_points(sim);
    pel_mesh mesh = pel_contact_mesh(sim);
    pel_collider_def def = pel_collider_def_default();
    def.mesh = &mesh;
    contacts->mean_edge = mean_edge(contacts);
    def.margin = 0.2 * contacts->mean_edge;
    def.memory_limit = contacts->def.memory_limit;
    status = pel_collider_create(&def, &contacts->collider, error);
    if (status != PEL_OK)
        return status;
    pel_collider_use_pool(contacts->collider, sim->pool);
    const pel_collision_groups groups = {contacts->group_of_point, contacts->may_meet,
                                         sim->model->body_count + sim->tool_count};
    pel_collider_use_groups(contacts->collider, &groups);
    return PEL_OK;
}

void pel_contact_count_search(pel_sim_contacts *contacts, const pel_collision_result *found)
{
    pel_contact_statistics *sum = &contacts->statistics;
    const pel_ccd_statistics *kinds[] = {&found->vertex_face, &found->edge_edge};
    for (int i = 0; i < 2; i++) {
        sum->candidates += kinds[i]->queries;
        sum->passed_filter += kinds[i]->passed_filter;
        sum->passed_hull += kinds[i]->passed_hull;
        sum->cubics += kinds[i]->cubics;
    }
}

double pel_sim_contact_thickness(const pel_sim *sim)
{
    if (sim == NULL)
        return 0;
    return sim->contacts != NULL ? sim->contacts->thickness : 0;
}
