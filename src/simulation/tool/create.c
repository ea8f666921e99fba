/* Tools from their defs: checks, copies and room. */
#include "tool/create.h"

#include "base/assert.h"
#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "bvh/mesh_query.h"
#include "math/extremes.h"
#include "stage/layer.h"
#include "tool/follow.h"
#include "tool/pose.h"
#include "tool/start.h"

#include <stdio.h>
#include <string.h>

pel_tool_def pel_tool_def_default(void)
{
    pel_tool_def def = {0};
    pel_def_reset(PEL_DEF_TOOL, &def);
    return def;
}

/* ---- checks ---- */

static bool is_positive(double value)
{
    return value > 0 && isfinite(value);
}

static pel_status check_closing(const pel_tool_def *def, int32_t tool, pel_error *error)
{
    bool is_whole = def->closing != NULL && def->closing_count > 0;
    for (int32_t k = 0; is_whole && k < def->closing_count; k++) {
        const pel_key *key = &def->closing[k];
        is_whole = isfinite(key->time) && key->value >= 0 && key->value <= 1 && (k == 0 || key->time > key[-1].time);
    }
    if (!is_whole)
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "tool", tool,
                                  "give times that increase and shares from 0 (open) to 1 (closed), such as closing: "
                                  "[[0, 0], [0.3, 1]]",
                                  "'%s' closes by no keys, or by keys out of range or order", def->name);
    double across[3];
    pel_vec3_cross(def->edge[0], def->edge[1], across);
    double least = 1e-3 * pel_vec3_length(def->edge[0]) * pel_vec3_length(def->edge[1]);
    if (!(pel_vec3_length(across) > least) || !isfinite(least))
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "tool", tool,
                                  "give the tips of both blades in the tool's frame, apart as seen from its origin, "
                                  "such as edge: [[0.05, 0, 0.01], [0.05, 0, -0.01]]",
                                  "the blades of '%s' do not open", def->name);
    return PEL_OK;
}

static pel_status check_shape(const pel_tool_def *def, int32_t tool, pel_error *error)
{
    const pel_solid_row *row = &pel_solid_rows[def->shape];
    const double *half = def->half_extents;
    if (def->shape == PEL_TOOL_MESH && def->mesh == NULL)
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "tool", tool, "give a mesh",
                                  "tool of shape mesh has no mesh");
    if (row->has_size && (!is_positive(half[0]) || !is_positive(half[1]) || !is_positive(half[2])))
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "tool", tool, "give three half extents above 0",
                                  "%s has no size", row->word);
    if (row->has_radius && !is_positive(def->radius))
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "tool", tool, "give a radius above 0",
                                  "radius is not above 0");
    if (row->has_length && !(def->half_length >= 0 && isfinite(def->half_length)))
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "tool", tool, "give a half length of at least 0",
                                  "%s length is below 0", row->word);
    return def->shape == PEL_TOOL_SCISSORS ? check_closing(def, tool, error) : PEL_OK;
}

static pel_status check_support(const pel_sim *sim, const pel_tool_def *def, int32_t tool, pel_error *error)
{
    PEL_ASSERT_INDEX(tool, sim->tools->count);
    if (def->body < 0 || def->vertices == NULL || def->vertex_count < 1)
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "tool", tool, "give a body and vertices of its mesh",
                                  "support has no body or no vertices");
    if (!isfinite(def->center[0]) || !isfinite(def->center[1]) || !isfinite(def->center[2]))
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "tool", tool, "give a point in metres",
                                  "center of the support is not finite");
    if (!(def->strength >= 0) || !(def->grasp_until > def->grasp_from))
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "tool", tool,
                                  "give grasp_from < grasp_until, and a strength above 0 in newtons or 0 for none",
                                  "the support ends before it begins, or its strength is %g N", def->strength);
    for (int32_t i = 0; i < def->vertex_count; i++) {
        int32_t v = def->vertices[i];
        if (v < 0 || v >= sim->given->bodies[def->body].mesh->vertex_count)
            return pel_refuse_element(error, PEL_BAD_ARGUMENT, "tool", tool, "give vertices of the mesh",
                                      "support names a vertex that does not exist");
        if (!(sim->model->inverse_mass[sim->model->bodies[def->body].model_index[v]] > 0))
            return pel_refuse_element(error, PEL_BAD_ARGUMENT, "tool", tool,
                                      "remove it from the pins or from the support",
                                      "support holds a vertex that is pinned");
    }
    return PEL_OK;
}

static pel_status check_lead(const pel_tool_def *def, int32_t tool, pel_error *error)
{
    const pel_solid solid = pel_solid_of(def);
    double least = 4 * pel_grasp_extent(&solid, def->reach), axis = pel_vec3_length(def->lead_axis);
    if (!def->grasp || def->shape == PEL_TOOL_MESH || def->shape == PEL_TOOL_SUPPORT)
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "tool", tool, "use a sphere, capsule or box that grasps",
                                  "a tool that leads a tear does not grasp, or is a mesh");
    if (!isfinite(pel_vec3_length(def->lead_center)) || !(axis > 0 && isfinite(axis)) ||
        !(def->lead_speed >= 0 && isfinite(def->lead_speed)) || !is_positive(def->lead_radius) ||
        !(fabs(def->lead_outward) <= 1.5707963267948968))
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "tool", tool,
                                  "give a center, an axis, a radius and a speed above 0, and -90 to 90 degrees outward",
                                  "a tool that leads a tear has a number out of range");
    if (!(def->lead_regrasp >= least && isfinite(def->lead_regrasp)))
        return pel_refuse_element(
            error, PEL_BAD_ARGUMENT, "tool", tool, "raise grasp.lead.regrasp, or use a smaller tool",
            "a tool that leads a tear grasps the flap anew %.3g m from the tip; its size and reach "
            "ask for %.3g m",
            def->lead_regrasp, least);
    return PEL_OK;
}

static pel_status check_tool(const pel_sim *sim, const pel_tool_def *defs, int32_t tool, pel_error *error)
{
    PEL_ASSERT_INDEX(tool, sim->tools->count);
    const pel_tool_def *def = &defs[tool];
    if (def->name == NULL || def->name[0] == '\0' || strlen(def->name) >= PEL_NAME_SIZE)
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "tool", tool, "give a short name",
                                  "tool has no name or a very long one");
    for (int32_t other = 0; other < tool; other++)
        if (strcmp(defs[other].name, def->name) == 0)
            return pel_refuse_element(error, PEL_BAD_ARGUMENT, "tool", tool, "give each tool a name of its own",
                                      "two tools have the same name");
    if (def->body < -1 || def->body >= sim->model->body_count)
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "tool", tool, "give a body of the model, or -1 for all",
                                  "tool names a body that does not exist");
    if (PEL_IS_NO_CHOICE(def->shape, PEL_TOOL_SHAPE_COUNT))
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "tool", tool, "give one of pel_tool_shape",
                                  "shape of the tool is unknown");
    if (def->key_count < 1 || def->keys == NULL)
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "tool", tool, "give at least one key",
                                  "tool has no pose: no keys");
    for (int32_t k = 0; k < def->key_count; k++) {
        const pel_pose_key *key = &def->keys[k];
        if (!pel_tool_is_key(key))
            return pel_refuse_element(
                error, PEL_BAD_ARGUMENT, "tool", tool,
                "give finite positions, unit quaternions x, y, z, w and at most 1e6 turns",
                "a key has a position that is not finite, turns too often, or its rotation is not a unit quaternion");
        if (k > 0 && !(key->time > key[-1].time))
            return pel_refuse_element(error, PEL_BAD_ARGUMENT, "tool", tool, "give keys with increasing times",
                                      "keys are not in order");
    }
    if (!isfinite(def->friction))
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "tool", tool, "give a coefficient of at least 0",
                                  "the friction of a tool is not finite");
    if (!isfinite(def->restitution))
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "tool", tool, "give a number from 0 to 1",
                                  "the restitution of a tool is not finite");
    if (!isfinite(def->thickness))
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "tool", tool, "give a number of metres above 0",
                                  "the thickness of a tool is not finite");
    if (def->grasp && (!(def->grasp_until > def->grasp_from) || !(def->reach >= 0 && isfinite(def->reach))))
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "tool", tool,
                                  "give grasp_from < grasp_until and a reach of at least 0",
                                  "grasp ends before it begins, or its reach is below 0");
    if (def->grasp && !(def->grasp_max_force >= 0))
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "tool", tool,
                                  "give grasp_max_force > 0 in newtons, infinity for no limit, or 0 for the material's",
                                  "the largest force of a grasp is below 0 or not a number");
    pel_status status = def->leads ? check_lead(def, tool, error) : PEL_OK;
    if (status != PEL_OK)
        return status;
    return def->shape == PEL_TOOL_SUPPORT ? check_support(sim, def, tool, error) : check_shape(def, tool, error);
}

/* ---- copies ---- */

/* copies the mesh; the solid becomes the sphere about it */
static pel_status create_mesh(pel_tool *tool, const pel_mesh *mesh, pel_error *error)
{
    double radius = 0;
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        radius = pel_max(radius, pel_vec3_length(mesh->positions[v]));
    tool->solid = (pel_solid){.shape = PEL_TOOL_SPHERE, .radius = radius};
    return pel_mesh_create((const double *)mesh->positions, mesh->vertex_count, (const int32_t *)mesh->triangles,
                           mesh->triangle_count, &tool->mesh, error);
}

/* A keyed support grasps its vertices permanently. It starts at rest; if its first key is elsewhere it moves there in
   the first step. Its size, for rotations, is that of the body. */
static pel_status create_support(const pel_sim *sim, const pel_tool_def *def, pel_tool *tool, pel_error *error)
{
    const pel_body *body = &sim->model->bodies[def->body];
    tool->support = pel_allocate((size_t)def->vertex_count, sizeof *tool->support);
    if (tool->support == NULL)
        return pel_fail_memory(error);
    for (int32_t i = 0; i < def->vertex_count; i++)
        tool->support[i] = body->model_index[def->vertices[i]];
    tool->support_count = def->vertex_count;
    if (sim->given->bodies[def->body].detail != NULL) {
        const pel_lod_forest *forest = sim->given->bodies[def->body].detail->forest;
        tool->support_marks = pel_allocate((size_t)forest->levels[forest->depth]->vertex_count, 1);
        if (tool->support_marks == NULL)
            return pel_fail_memory(error);
        for (int32_t i = 0; i < def->vertex_count; i++)
            tool->support_marks[def->vertices[i]] = 1;
        pel_levels_spread_marks(forest, tool->support_marks);
    }
    tool->grasp = true;
    tool->press = false;
    tool->strength = def->strength > 0 ? def->strength : (double)HUGE_VAL;
    tool->solid.radius = body->diameter;
    pel_vec3_copy(def->center, tool->center);
    return PEL_OK;
}

static void set_numbers(const pel_tool_def *def, pel_tool *tool)
{
    tool->body = def->body;
    tool->press = def->press;
    tool->grasp = def->grasp;
    tool->grasp_from = def->grasp_from;
    tool->grasp_until = def->grasp_until;
    tool->reach = def->reach;
    tool->friction = def->friction;
    tool->restitution = def->restitution;
    tool->thickness = def->thickness;
    tool->stride = 1;
    tool->grasp_max_force = def->grasp_max_force;
    tool->one_patch = def->grasp_one_patch || def->leads;
}

/* it holds vertices as a grasp does, which never closes by itself */
static bool create_blade(pel_sim *sim, const pel_tool_def *def, pel_tool *tool)
{
    size_t vertex_count = (size_t)sim->model->vertex_count;
    tool->blade = pel_allocate(1, sizeof *tool->blade);
    if (sim->tools->blade_before == NULL)
        sim->tools->blade_before = pel_allocate(vertex_count, sizeof *sim->tools->blade_before);
    tool->press = false;
    tool->grasp = true;
    tool->grasp_from = tool->grasp_until = tool->grasp_max_force = (double)HUGE_VAL;
    if (tool->blade == NULL || sim->tools->blade_before == NULL)
        return false;
    tool->blade->closed = tool->blade->closed_before = 1;
    if (def->shape != PEL_TOOL_SCISSORS)
        return true;
    tool->blade->closing = pel_allocate((size_t)def->closing_count, sizeof *def->closing);
    if (tool->blade->closing == NULL)
        return false;
    tool->blade->closing_count = def->closing_count;
    memcpy(tool->blade->closing, def->closing, (size_t)def->closing_count * sizeof *def->closing);
    return true;
}

static pel_status create_tool(pel_sim *sim, const pel_tool_def *def, pel_tool *tool, pel_error *error)
{
    tool->strength = (double)HUGE_VAL;
    size_t vertex_count = (size_t)sim->model->vertex_count;
    size_t triangle_count = (size_t)sim->model->triangle_count;
    snprintf(tool->name, sizeof tool->name, "%s", def->name);
    tool->solid = pel_solid_of(def);
    if (def->shape == PEL_TOOL_MESH) {
        pel_status status = create_mesh(tool, def->mesh, error);
        if (status == PEL_OK && def->grasp)
            status = pel_mesh_query_create(def->mesh, &tool->query, error);
        if (status != PEL_OK)
            return status;
    }
    set_numbers(def, tool);
    if (pel_solid_has_edge(&tool->solid) && !create_blade(sim, def, tool))
        return pel_fail_memory(error);
    tool->keys = pel_allocate((size_t)def->key_count, sizeof *tool->keys);
    tool->key_spins = pel_allocate((size_t)def->key_count, sizeof *tool->key_spins);
    tool->planes = pel_allocate(PEL_PLANE_LIMIT, sizeof *tool->planes);
    tool->planes_before = pel_allocate(PEL_PLANE_LIMIT, sizeof *tool->planes_before);
    tool->touches = pel_allocate(vertex_count, sizeof *tool->touches);
    tool->touch_of_vertex = pel_allocate(vertex_count, sizeof *tool->touch_of_vertex);
    tool->near.triangles = pel_allocate(triangle_count, sizeof *tool->near.triangles);
    tool->in_reach.triangles = pel_allocate(triangle_count, sizeof *tool->in_reach.triangles);
    if (def->shape == PEL_TOOL_SUPPORT) {
        pel_status status = create_support(sim, def, tool, error);
        if (status != PEL_OK)
            return status;
    }
    if (tool->grasp) {
        tool->held = pel_allocate(vertex_count, sizeof *tool->held);
        tool->anchors = pel_allocate(vertex_count, sizeof *tool->anchors);
    }
    if (tool->keys == NULL || tool->key_spins == NULL || tool->planes == NULL || tool->planes_before == NULL ||
        tool->touches == NULL || tool->touch_of_vertex == NULL || tool->near.triangles == NULL ||
        tool->in_reach.triangles == NULL || (tool->grasp && (tool->held == NULL || tool->anchors == NULL)))
        return pel_fail_memory(error);
    memcpy(tool->keys, def->keys, (size_t)def->key_count * sizeof *tool->keys);
    tool->key_count = def->key_count;
    pel_tool_sum_spins(tool);
    tool->pose = pel_tool_pose_at(tool, 0);
    if (tool->support != NULL) {
        tool->pose = (pel_pose){.rotation = {0, 0, 0, 1}};
        pel_vec3_copy(tool->center, tool->pose.position);
        pel_status status = pel_tool_follow_create(sim, def, (int32_t)(tool - sim->tools->items), error);
        if (status != PEL_OK)
            return status;
        tool->pose.along = pel_tool_along(tool, 0);
    }
    tool->pose_before = tool->pose;
    return PEL_OK;
}

/* allocates the lists of held vertices */
static pel_status create_grips(pel_sim *sim, pel_error *error)
{
    size_t count = (size_t)sim->model->vertex_count;
    if (!PEL_ALLOCATE_ALL(PEL_ROOM(sim->tools->held_vertices, count), PEL_ROOM(sim->tools->held_targets, count),
                          PEL_ROOM(sim->tools->grip_forces, count),
                          PEL_ROOM(sim->tools->strengths, sim->model->body_count)))
        return pel_fail_memory(error);
    for (int32_t b = 0; b < sim->model->body_count; b++)
        sim->tools->strengths[b] = pel_body_strength(sim, b);
    return sim->stepper->record_held != NULL ? sim->stepper->record_held(sim, error) : PEL_OK;
}

pel_status pel_tools_create(pel_sim *sim, const pel_tool_def *defs, int32_t count, pel_error *error)
{
    sim->tools->items = pel_allocate((size_t)count, sizeof *sim->tools->items);
    if (sim->tools->items == NULL)
        return pel_fail_memory(error);
    sim->tools->count = count;
    if (count == 0)
        return PEL_OK;
    if (!PEL_ALLOCATE_ALL(PEL_ROOM(sim->tools->near_triangles, sim->model->triangle_count),
                          PEL_ROOM(sim->tools->plane_of_triangle, sim->model->triangle_count),
                          PEL_ROOM(sim->held, sim->model->vertex_count),
                          PEL_ROOM(sim->tools->looked_at, sim->model->triangle_count),
                          PEL_ROOM(sim->tools->moved_at, sim->model->vertex_count),
                          PEL_ROOM(sim->tools->cornered_at, sim->model->vertex_count)))
        return pel_fail_memory(error);
    /* corners and triangles that touch a tool: most of a small body, a part of a large one */
    int32_t points = sim->model->vertex_count + sim->model->triangle_count;
    size_t room = (size_t)(points < PEL_STOP_ROOM ? points : PEL_STOP_ROOM);
    pel_stops *stops = &sim->tools->stops;
    if (sim->stepper->is_explicit && !pel_reserve((void **)&stops->items, &stops->capacity, room, sizeof *stops->items))
        return pel_fail_memory(error);
    pel_status status = pel_tool_search_create(sim->model, &sim->tools->search, error);
    bool grasps = false;
    for (int32_t i = 0; i < count; i++)
        grasps |= defs[i].grasp || defs[i].shape >= PEL_TOOL_SUPPORT;
    if (status == PEL_OK && grasps)
        status = create_grips(sim, error);
    for (int32_t i = 0; status == PEL_OK && i < count; i++) {
        status = check_tool(sim, defs, i, error);
        if (status == PEL_OK)
            status = create_tool(sim, &defs[i], &sim->tools->items[i], error);
        if (status == PEL_OK && !sim->goes_on)
            status = pel_tool_check_start(sim, i, error);
    }
    return status;
}

pel_status pel_tool_regrasp(pel_sim *sim, int32_t index, const pel_tool_def *def, pel_error *error)
{
    pel_tool_def *own = (pel_tool_def *)(uintptr_t)sim->def.tools + index, before = *own;
    pel_tool *tool = &sim->tools->items[index];
    *own = *def;
    pel_status status = check_tool(sim, sim->def.tools, index, error);
    if (status != PEL_OK) {
        *own = before;
        return status;
    }
    /* an opened grasp closes again if its interval starts again */
    if (tool->phase == PEL_GRASP_DONE && def->grasp_until > pel_sim_time(sim))
        tool->phase = PEL_GRASP_WAITING;
    if (tool->blade != NULL)
        return PEL_OK;
    tool->grasp_from = def->grasp_from;
    tool->grasp_until = def->grasp_until;
    tool->reach = def->reach;
    tool->stride = 1;
    tool->grasp_max_force = def->grasp_max_force;
    tool->one_patch = def->grasp_one_patch || def->leads;
    return PEL_OK;
}

void pel_tools_destroy(pel_sim *sim)
{
    for (int32_t i = 0; i < sim->tools->count; i++) {
        pel_tool *tool = &sim->tools->items[i];
        if (tool->blade != NULL)
            pel_free(tool->blade->closing);
        PEL_FREE_ALL(tool->keys, tool->key_spins, tool->planes, tool->planes_before, tool->touches,
                     tool->touch_of_vertex, tool->held, tool->anchors, tool->support, tool->support_marks,
                     tool->near.triangles, tool->in_reach.triangles, tool->blade);
        pel_mesh_destroy(tool->mesh);
        pel_mesh_query_destroy(tool->query);
        pel_tool_follow_destroy(tool);
    }
    pel_free(sim->tools->items);
    pel_tool_search_destroy(sim->tools->search);
    PEL_FREE_ALL(sim->tools->near_triangles, sim->tools->plane_of_triangle, sim->held, sim->tools->looked_at,
                 sim->tools->moved_at, sim->tools->cornered_at, sim->tools->held_vertices, sim->tools->held_targets,
                 sim->tools->grip_forces, sim->tools->strengths, sim->tools->stops.items, sim->tools->blade_before);
}
