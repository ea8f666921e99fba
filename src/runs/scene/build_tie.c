/* Attachments, stitches and joints of a scene, and bodies that springs draw to a sequence: ties of the simulation. */
#include "base/memory.h"
#include "keys/table.h"
#include "keys/validate.h"
#include "math/vec3.h"
#include "scene/build.h"
#include "scene/mesh.h"
#include "scene/region.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_NAMES = 64 };

static pel_status find_tool(pel_scene_reader *reader, const pel_scene_value *name, const pel_scene *scene,
                            int32_t *tool)
{
    const char *names[MOST_NAMES];
    size_t count = 0;
    for (int32_t t = 0; t < scene->sim.tool_count; t++) {
        if (strcmp(scene->sim.tools[t].name, name->text) == 0) {
            *tool = t;
            return PEL_OK;
        }
        if (count < MOST_NAMES)
            names[count++] = scene->sim.tools[t].name;
    }
    return pel_scene_fail_name(reader, &name->place, "tool", name->text, names, count);
}

static pel_status read_target(pel_scene_reader *reader, const pel_scene_value *value, const pel_scene *scene,
                              pel_tie_def *tie)
{
    const pel_scene_value *to = pel_scene_value_entry(value, "to");
    const pel_scene_value *body = to != NULL ? pel_scene_value_entry(to, "body") : NULL;
    const pel_scene_value *tool = to != NULL ? pel_scene_value_entry(to, "tool") : NULL;
    tie->target = body != NULL ? PEL_TIE_BODY : tool != NULL ? PEL_TIE_TOOL : PEL_TIE_PLACE;
    if (tool != NULL)
        return find_tool(reader, tool, scene, &tie->tool);
    if (body == NULL)
        return PEL_OK;
    pel_status status = pel_scene_find_body(reader, body, &scene->model, &tie->to_body);
    if (status != PEL_OK || tie->to_body != tie->body)
        return status;
    pel_scene_fail(reader, &body->place, "the attachment leads from '%s' to itself", body->text);
    pel_fail_remedy(reader->error, "give another body, or use `stitches`");
    return PEL_BAD_SCENE;
}

static pel_status read_attachment(pel_scene_reader *reader, pel_scene_value *value, const pel_scene *scene,
                                  pel_tie_def *tie)
{
    *tie = pel_tie_def_default();
    pel_status status = pel_scene_fill_body(reader, value, &scene->model, "attachment");
    if (status == PEL_OK)
        status = pel_scene_find_body(reader, pel_scene_value_entry(value, "body"), &scene->model, &tie->body);
    if (status != PEL_OK)
        return status;
    const pel_scene_part part = {reader, value, scene->model.bodies[tie->body].mesh};
    status = pel_scene_read_members(&part, PEL_DEF_TIE, tie);
    if (status == PEL_OK)
        status = pel_scene_read_vertices(&part, pel_scene_value_entry(value, "at"), &tie->vertices, &tie->vertex_count);
    if (status == PEL_OK)
        status = read_target(reader, value, scene, tie);
    return status == PEL_OK ? pel_scene_check_times(reader, value, tie->from, tie->until) : status;
}

/* ---- stitches ---- */

typedef struct border {
    int32_t body, count;
    const int32_t *vertices;
    const pel_mesh *mesh;
} border;

static pel_status read_border(pel_scene_reader *reader, const pel_scene_value *value, const char *side,
                              const pel_scene *scene, border *made)
{
    pel_scene_value *map = pel_scene_value_entry(value, side);
    pel_status status = pel_scene_fill_body(reader, map, &scene->model, "stitch");
    if (status == PEL_OK)
        status = pel_scene_find_body(reader, pel_scene_value_entry(map, "body"), &scene->model, &made->body);
    if (status != PEL_OK)
        return status;
    made->mesh = scene->model.bodies[made->body].mesh;
    const pel_scene_part part = {reader, map, made->mesh};
    return pel_scene_read_vertices(&part, pel_scene_value_entry(map, "at"), &made->vertices, &made->count);
}

typedef struct pair {
    double square;
    int32_t a, b;
} pair;

static int compare_pairs(const void *left, const void *right)
{
    const pair *a = left, *b = right;
    if (a->square != b->square)
        return a->square < b->square ? -1 : 1;
    return a->a != b->a ? a->a - b->a : a->b - b->b;
}

/* all pairs by rising distance: each vertex takes the nearest one that is left */
static void match(const border *a, const border *b, pair *pairs, int32_t *partner)
{
    size_t count = 0;
    for (int32_t i = 0; i < a->count; i++)
        for (int32_t j = 0; j < b->count; j++) {
            double way[3];
            pel_vec3_subtract(a->mesh->positions[a->vertices[i]], b->mesh->positions[b->vertices[j]], way);
            pairs[count++] = (pair){pel_vec3_squared_length(way), i, j};
        }
    qsort(pairs, count, sizeof *pairs, compare_pairs);
    int32_t *is_taken = partner + a->count;
    for (int32_t i = 0; i < a->count; i++) {
        partner[i] = -1;
        is_taken[i] = 0;
    }
    for (size_t p = 0; p < count; p++)
        if (partner[pairs[p].a] < 0 && !is_taken[pairs[p].b]) {
            partner[pairs[p].a] = b->vertices[pairs[p].b];
            is_taken[pairs[p].b] = 1;
        }
}

/* vertices of both borders */
static pel_status check_borders(pel_scene_reader *reader, const pel_scene_value *value, const border *a,
                                const border *b)
{
    const char *what = NULL;
    if (a->count != b->count) {
        pel_scene_fail(reader, &value->place, "the borders have %d and %d vertices", (int)a->count, (int)b->count);
        pel_fail_remedy(reader->error,
                        "choose regions with the same number of vertices, or meshes with the same edges");
        return PEL_BAD_SCENE;
    }
    for (int32_t i = 0; a->body == b->body && i < a->count; i++)
        for (int32_t j = 0; j < b->count; j++)
            if (a->vertices[i] == b->vertices[j])
                what = "the borders share a vertex";
    if (what == NULL)
        return PEL_OK;
    pel_scene_fail(reader, &value->place, "%s", what);
    pel_fail_remedy(reader->error, "choose two regions without a common vertex");
    return PEL_BAD_SCENE;
}

static pel_status pair_borders(pel_scene_reader *reader, const border *a, const border *b, pel_tie_def *tie)
{
    int32_t *partner = pel_arena_take(reader->arena, 2 * (size_t)a->count, sizeof *partner);
    pair *pairs = pel_allocate((size_t)a->count * (size_t)b->count, sizeof *pairs);
    if (partner != NULL && pairs != NULL)
        match(a, b, pairs, partner);
    bool has_room = partner != NULL && pairs != NULL;
    pel_free(pairs);
    tie->vertices = a->vertices;
    tie->vertex_count = a->count;
    tie->to_vertices = partner;
    return has_room ? PEL_OK : pel_fail_memory(reader->error);
}

static pel_status read_stitch(pel_scene_reader *reader, const pel_scene_value *value, const pel_scene *scene,
                              pel_tie_def *tie)
{
    border a, b;
    *tie = pel_tie_def_default();
    tie->target = PEL_TIE_VERTICES;
    const pel_scene_part part = {reader, value, NULL};
    pel_status status = pel_scene_read_members(&part, PEL_DEF_TIE, tie);
    if (status == PEL_OK)
        status = read_border(reader, value, "a", scene, &a);
    if (status == PEL_OK)
        status = read_border(reader, value, "b", scene, &b);
    if (status == PEL_OK)
        status = check_borders(reader, value, &a, &b);
    if (status != PEL_OK)
        return status;
    tie->body = a.body;
    tie->to_body = b.body;
    status = pair_borders(reader, &a, &b, tie);
    return status == PEL_OK ? pel_scene_check_times(reader, value, tie->from, tie->until) : status;
}

/* ---- springs to a sequence ---- */

/* the stiffness of each vertex of the list from a field of the mesh */
static pel_status read_stiffnesses(pel_scene_reader *reader, const pel_scene_value *value, const pel_mesh *mesh,
                                   pel_tie_def *tie)
{
    const pel_scene_value *map = pel_scene_value_entry(value, "map");
    double *made = pel_arena_take(reader->arena, (size_t)tie->vertex_count, sizeof *made), ends[2] = {0, 1};
    const double *values;
    if (made == NULL)
        return pel_fail_memory(reader->error);
    pel_status status = pel_scene_field(reader, pel_scene_value_entry(value, "field"), mesh, &values);
    if (map != NULL)
        pel_scene_value_numbers(map, ends);
    for (int32_t i = 0; status == PEL_OK && i < tie->vertex_count; i++) {
        double number = values[tie->vertices[i]];
        made[i] = map != NULL ? ends[0] + number * (ends[1] - ends[0]) : number;
    }
    tie->stiffnesses = made;
    return status;
}

/* the times, the strength and the vertices are those of the support that would hold it */
static pel_status read_spring(pel_scene_reader *reader, const pel_scene_value *value, const pel_scene *scene,
                              int32_t body, pel_tie_def *tie)
{
    const pel_scene_value *stiffness = pel_scene_value_at(value, "follow.stiffness");
    const pel_mesh *mesh = scene->model.bodies[body].mesh;
    pel_tool_def support;
    pel_status status = pel_scene_read_follow(reader, value, &scene->model.bodies[body], body, &support);
    if (status != PEL_OK)
        return status;
    *tie = pel_tie_def_default();
    tie->name = support.name;
    tie->body = body;
    tie->vertices = support.vertices;
    tie->vertex_count = support.vertex_count;
    tie->target = PEL_TIE_SEQUENCE;
    tie->sequence = support.sequence;
    tie->from = support.grasp_from;
    tie->until = support.grasp_until;
    tie->strength = support.strength;
    if (stiffness->form == PEL_FORM_MAP)
        return read_stiffnesses(reader, stiffness, mesh, tie);
    tie->stiffness = stiffness->number;
    if (tie->stiffness > 0)
        return PEL_OK;
    pel_scene_fail(reader, &stiffness->place, "the springs of `follow` have no stiffness");
    pel_fail_remedy(reader->error, "give a number above 0, or omit it to hold the vertices");
    return PEL_BAD_SCENE;
}

pel_status pel_scene_build_ties(pel_scene_reader *reader, const pel_scene_value *root, pel_scene *scene)
{
    const pel_scene_value *attachments = pel_scene_value_entry(root, "attachments");
    const pel_scene_value *stitches = pel_scene_value_entry(root, "stitches");
    size_t most = (size_t)pel_scene_value_count(attachments) + (size_t)pel_scene_value_count(stitches) +
                  (size_t)scene->model.body_count;
    pel_tie_def *ties = pel_arena_take(reader->arena, most, sizeof *ties);
    if (ties == NULL)
        return pel_fail_memory(reader->error);
    int32_t count = 0, b = 0;
    pel_status status = pel_scene_check_names(reader, attachments);
    if (status == PEL_OK)
        status = pel_scene_check_names(reader, stitches);
    for (pel_scene_value *value = attachments->first; status == PEL_OK && value != NULL; value = value->next)
        status = read_attachment(reader, value, scene, &ties[count++]);
    for (pel_scene_value *value = stitches->first; status == PEL_OK && value != NULL; value = value->next)
        status = read_stitch(reader, value, scene, &ties[count++]);
    const pel_scene_value *bodies = pel_scene_value_entry(root, "bodies");
    for (const pel_scene_value *value = bodies->first; status == PEL_OK && value != NULL; value = value->next, b++)
        if (pel_scene_value_at(value, "follow.stiffness") != NULL)
            status = read_spring(reader, value, scene, b, &ties[count++]);
    scene->sim.ties = ties;
    scene->sim.tie_count = count;
    return status;
}

/* ---- joints ---- */

/* rad */
#define DEGREE 0.017453292519943295

static pel_status read_joint(pel_scene_reader *reader, pel_scene_value *value, const pel_scene *scene,
                             pel_joint_def *joint)
{
    *joint = pel_joint_def_default();
    const pel_scene_value *to = pel_scene_value_entry(value, "to");
    pel_status status = pel_scene_fill_body(reader, value, &scene->model, "joint");
    const pel_scene_part part = {reader, value, NULL};
    if (status == PEL_OK)
        status = pel_scene_read_members(&part, PEL_DEF_JOINT, joint);
    if (status == PEL_OK)
        status = pel_scene_find_body(reader, pel_scene_value_entry(value, "body"), &scene->model, &joint->body);
    joint->to_body = -1;
    if (status == PEL_OK && to != NULL)
        status = pel_scene_find_body(reader, to, &scene->model, &joint->to_body);
    double unit = joint->kind == PEL_JOINT_HINGE ? DEGREE : 1;
    joint->least *= unit;
    joint->most *= unit;
    joint->speed *= unit;
    return status;
}

pel_status pel_scene_build_joints(pel_scene_reader *reader, const pel_scene_value *root, pel_scene *scene)
{
    const pel_scene_value *list = pel_scene_value_entry(root, "joints");
    pel_joint_def *joints = pel_arena_take(reader->arena, (size_t)pel_scene_value_count(list), sizeof *joints);
    if (joints == NULL && pel_scene_value_count(list) > 0)
        return pel_fail_memory(reader->error);
    int32_t count = 0;
    pel_status status = pel_scene_check_names(reader, list);
    for (pel_scene_value *value = list->first; status == PEL_OK && value != NULL; value = value->next)
        status = read_joint(reader, value, scene, &joints[count++]);
    scene->sim.joints = joints;
    scene->sim.joint_count = count;
    return status;
}
