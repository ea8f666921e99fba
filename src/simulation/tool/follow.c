/* A support that follows a sequence has, beside its pose, a place along it: the length [m] that its fastest vertex may
   have gone. Ways of tools and the guard treat it like the rest of a pose: contact may make the support late. */
#include "tool/follow.h"

#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "math/extremes.h"
#include "model/origin.h"

/* of the size of the body: a sequence that starts farther from the body at rest is another mesh, or in other units */
#define FAR_SHARE 0.5

/* ---- creation ---- */

static pel_status check_start(const pel_sim *sim, const pel_tool_def *def, int32_t index, pel_error *error)
{
    const pel_body *body = &sim->given->bodies[def->body];
    pel_sequence_moment start = pel_sequence_find(def->sequence, pel_max(def->grasp_from, 0));
    for (int32_t i = 0; i < def->vertex_count && !sim->goes_on && !(def->grasp_from > 0); i++) {
        double point[3], rest[3];
        pel_sequence_point(&start, pel_origin_of(&sim->given->def.bodies[def->body], def->vertices[i]), point);
        pel_vertex_position(sim->model->rest, body->model_index[def->vertices[i]], rest);
        double way = pel_vec3_distance(point, rest);
        if (way > FAR_SHARE * body->diameter)
            return pel_refuse_element(error, PEL_BAD_ARGUMENT, "tool", index,
                                      "give the sequence the units, the axes and the place of the mesh",
                                      "the sequence starts %.3g m away from vertex %d of body '%s'", way,
                                      (int)def->vertices[i], body->name);
    }
    return PEL_OK;
}

static pel_status check(const pel_sim *sim, const pel_tool_def *def, int32_t index, pel_error *error)
{
    const pel_body_def *body = &sim->given->def.bodies[def->body];
    if (sim->given->bodies[def->body].detail != NULL)
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "tool", index, "remove `refine`",
                                  "a body that refines follows a sequence");
    int32_t most = 0;
    for (int32_t v = 0; v < body->mesh->vertex_count; v++)
        most = pel_origin_of(body, v) > most ? pel_origin_of(body, v) : most;
    if (def->sequence->vertex_count != most + 1)
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "tool", index,
                                  "use a sequence of the same mesh, with the same order of vertices",
                                  "the sequence has %d vertices, the mesh of body '%s' has %d",
                                  (int)def->sequence->vertex_count, sim->given->bodies[def->body].name, (int)most + 1);
    return check_start(sim, def, index, error);
}

pel_status pel_tool_follow_create(pel_sim *sim, const pel_tool_def *def, int32_t index, pel_error *error)
{
    pel_tool *tool = &sim->tools->items[index];
    if (def->sequence == NULL)
        return PEL_OK;
    pel_status status = check(sim, def, index, error);
    if (status != PEL_OK)
        return status;
    bool books = !pel_sim_has_velocity(sim);
    if (!PEL_ALLOCATE_ALL(PEL_ROOM(tool->rows, sim->model->vertex_count),
                          PEL_ROOM_IF(books, tool->booked_forces, sim->model->vertex_count)))
        return pel_fail_memory(error);
    const int32_t *places = sim->model->bodies[def->body].model_index;
    for (int32_t i = 0; i < def->vertex_count; i++)
        tool->rows[places[def->vertices[i]]] = pel_origin_of(&sim->given->def.bodies[def->body], def->vertices[i]);
    tool->sequence = pel_sequence_share(def->sequence);
    return PEL_OK;
}

void pel_tool_follow_destroy(pel_tool *tool)
{
    pel_sequence_destroy((pel_sequence *)(uintptr_t)tool->sequence);
    PEL_FREE_ALL(tool->rows, tool->booked_forces);
}

/* ---- places ---- */

double pel_tool_along(const pel_tool *tool, double time)
{
    return tool->sequence != NULL ? pel_sequence_clamp(tool->sequence, time) * tool->sequence->speed : 0;
}

pel_tool_path pel_tool_path_at(const pel_tool *tool, const pel_pose *pose)
{
    pel_tool_path path = {.tool = tool, .pose = pose};
    if (tool->sequence != NULL)
        path.moment =
            pel_sequence_find(tool->sequence, tool->sequence->speed > 0 ? pose->along / tool->sequence->speed : 0);
    return path;
}

/* in the frame of the tool */
static void place_at(const pel_tool_path *path, int32_t v, double place[3])
{
    pel_sequence_point(&path->moment, path->tool->rows[v], place);
    pel_vec3_subtract(place, path->tool->center, place);
}

/* along its edge a blade that has pierced holds nothing */
static bool slides(const pel_tool *tool)
{
    bool is_blade = tool->blade != NULL && tool->solid.shape != PEL_TOOL_HOOK;
    for (int32_t i = 0; is_blade && i < tool->blade->tip_count; i++)
        is_blade = !tool->blade->tips[i].is_pressing;
    return is_blade;
}

void pel_tool_path_target(const pel_tool_path *path, int32_t i, double target[3])
{
    const pel_tool *tool = path->tool;
    double place[3] = {0};
    if (tool->sequence != NULL)
        place_at(path, tool->held[i], place);
    pel_vec3_add(place, tool->anchors[i], place);
    if (slides(tool))
        pel_pose_slide(&tool->blade->pose_before, path->pose, (const double(*)[3])tool->solid.edge, place, target);
    else
        pel_pose_to_world(path->pose, place, target);
}

void pel_tool_path_anchor(const pel_tool_path *path, int32_t v, const double x[3], double anchor[3])
{
    double place[3] = {0};
    pel_pose_to_local(path->pose, x, anchor);
    if (path->tool->sequence != NULL)
        place_at(path, v, place);
    pel_vec3_subtract(anchor, place, anchor);
}

/* ---- work ---- */

/* The pose has done its own work in the ledger: here each vertex moves in the frame of the tool. */
static double work_of(pel_sim *sim, pel_tool *tool)
{
    const pel_tool_path before = pel_tool_path_at(tool, &tool->pose_before),
                        after = pel_tool_path_at(tool, &tool->pose);
    double work = 0;
    for (int32_t i = 0; i < tool->held_count; i++) {
        int32_t v = tool->held[i];
        double *force = sim->tools->grip_forces[v], from[3], to[3], mean[3];
        place_at(&before, v, from);
        place_at(&after, v, to);
        pel_vec3_subtract(to, from, to);
        pel_rotate(tool->pose.rotation, to, to);
        pel_vec3_copy(force, mean);
        for (int k = 0; k < 3 && tool->booked_forces != NULL; k++) {
            mean[k] = 0.5 * (force[k] + tool->booked_forces[v][k]);
            tool->booked_forces[v][k] = force[k];
        }
        work -= pel_vec3_dot(mean, to);
    }
    return work;
}

double pel_tools_follow_work(pel_sim *sim)
{
    double work = 0;
    for (int32_t t = 0; t < sim->tools->count; t++)
        if (sim->tools->items[t].sequence != NULL)
            work += work_of(sim, &sim->tools->items[t]);
    return work;
}
