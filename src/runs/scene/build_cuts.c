/* Cuts of a scene: before anything reads the meshes of bodies, vertices move onto the paths. */
#include "scene/build.h"

#include "base/memory.h"
#include "keys/validate.h"
#include "mesh/path.h"

#include <math.h>
#include <string.h>

static pel_status fail_value(pel_scene_reader *reader, const pel_scene_value *value, const char *what,
                             const char *remedy)
{
    pel_scene_fail(reader, &value->place, "%s", what);
    pel_fail_remedy(reader->error, "%s", remedy);
    return PEL_BAD_SCENE;
}

/* numbers of vertices; the simulation checks that edges join them */
static pel_status read_numbers(pel_scene_reader *reader, const pel_scene_value *path, const pel_mesh *mesh,
                               pel_cut_def *cut)
{
    int32_t *vertices = pel_arena_take(reader->arena, (size_t)pel_scene_value_count(path), sizeof *vertices);
    if (vertices == NULL)
        return pel_fail_memory(reader->error);
    for (const pel_scene_value *child = path->first; child != NULL; child = child->next) {
        if (child->kind == PEL_SCENE_LIST)
            return fail_value(reader, child, "a path has points and vertices", "give points only, or vertices only");
        if (child->number < 0 || child->number >= mesh->vertex_count) {
            pel_scene_fail(reader, &child->place, "the mesh has no vertex %.0f", child->number);
            pel_fail_remedy(reader->error, "give numbers from 0 to %d", (int)mesh->vertex_count - 1);
            return PEL_BAD_SCENE;
        }
        vertices[cut->vertex_count++] = (int32_t)child->number;
    }
    cut->vertices = vertices;
    return PEL_OK;
}

static pel_status keep_vertices(pel_scene_reader *reader, const pel_path_trace *trace, pel_cut_def *cut)
{
    size_t size = (size_t)trace->count * sizeof *trace->vertices;
    int32_t *vertices = pel_arena_take(reader->arena, size, 1);
    if (vertices == NULL)
        return pel_fail_memory(reader->error);
    memcpy(vertices, trace->vertices, size);
    cut->vertices = vertices;
    cut->vertex_count = trace->count;
    return PEL_OK;
}

static pel_status read_points(pel_scene_reader *reader, const pel_scene_value *path, pel_mesh *mesh, uint8_t *marks,
                              pel_cut_def *cut)
{
    int32_t count = 0;
    double(*points)[3] = pel_arena_take(reader->arena, (size_t)pel_scene_value_count(path), sizeof *points);
    pel_path_trace trace = {0};
    pel_topology *topology = NULL;
    if (points == NULL)
        return pel_fail_memory(reader->error);
    for (const pel_scene_value *child = path->first; child != NULL; child = child->next) {
        if (child->kind != PEL_SCENE_LIST)
            return fail_value(reader, child, "a path has points and vertices", "give points only, or vertices only");
        pel_scene_value_numbers(child, points[count++]);
        if (count > 1 && memcmp(points[count - 1], points[count - 2], sizeof *points) == 0)
            return fail_value(reader, child, "two points of the path are the same", "leave one of them out");
    }
    pel_status status = pel_topology_create(mesh, &topology, reader->error);
    if (status == PEL_OK)
        status = pel_path_trace_points(mesh, topology, (const double(*)[3])(void *)points, count, marks, &trace,
                                       reader->error);
    if (status == PEL_OK)
        status = keep_vertices(reader, &trace, cut);
    else if (status == PEL_BAD_ARGUMENT)
        status = pel_scene_fail_at(reader, &pel_scene_value_element(path, trace.failed_point)->place);
    pel_free(trace.vertices);
    pel_topology_destroy(topology);
    return status;
}

static pel_status read_cut(pel_scene_reader *reader, const pel_scene_value *value, int32_t body, pel_mesh *mesh,
                           uint8_t *marks, pel_cut_def *cut)
{
    const pel_scene_part part = {reader, value, NULL};
    const pel_scene_value *path = pel_scene_value_entry(value, "path");
    *cut = (pel_cut_def){.body = body};
    pel_scene_read_members(&part, PEL_DEF_CUT, cut);
    cut->body = body;
    cut->vertex_count = 0;
    return path->first->kind == PEL_SCENE_LIST ? read_points(reader, path, mesh, marks, cut)
                                               : read_numbers(reader, path, mesh, cut);
}

pel_status pel_scene_build_cuts(pel_scene_reader *reader, const pel_scene_value *root, const char *name, int32_t body,
                                int32_t body_count, pel_mesh *mesh, pel_cut_def *cuts)
{
    const pel_scene_value *list = pel_scene_value_entry(root, "cuts");
    uint8_t *marks = pel_allocate((size_t)mesh->vertex_count, 1);
    pel_status status = marks != NULL ? PEL_OK : pel_fail_memory(reader->error);
    double before = 0;
    for (const pel_scene_value *value = list->first; status == PEL_OK && value != NULL; value = value->next, cuts++) {
        const pel_scene_value *owner = pel_scene_value_entry(value, "body");
        double at = pel_scene_value_number(value, "at");
        if (at < before)
            status = fail_value(reader, pel_scene_value_entry(value, "at"), "a cut is earlier than the one before",
                                "give the cuts in the order of their times");
        else if (owner == NULL && body_count > 1)
            status = fail_value(reader, value, "the cut does not say which body it cuts", "add `body` with its name");
        else if (owner == NULL || strcmp(owner->text, name) == 0)
            status = read_cut(reader, value, body, mesh, marks, cuts);
        before = at;
    }
    pel_free(marks);
    return status;
}

pel_status pel_scene_check_cuts(pel_scene_reader *reader, const pel_scene_value *root, const pel_scene *scene)
{
    const pel_cut_def *cut = scene->sim.cuts;
    enum { MOST_NAMES = 64 };
    const char *names[MOST_NAMES];
    size_t count = 0;
    for (int32_t b = 0; b < scene->model.body_count && count < MOST_NAMES; b++)
        names[count++] = scene->model.bodies[b].name;
    for (const pel_scene_value *value = pel_scene_value_entry(root, "cuts")->first; value != NULL;
         value = value->next, cut++) {
        const pel_scene_value *owner = pel_scene_value_entry(value, "body");
        if (cut->vertices == NULL)
            return pel_scene_fail_name(reader, &owner->place, "body", owner->text, names, count);
        const pel_body_def *body = &scene->model.bodies[cut->body];
        if (body->fluid_density > 0 && !isfinite(body->fluid_level))
            return fail_value(reader, value, "the cut opens a body that a liquid fills",
                              "give fluid.level, the height of the liquid's surface, or leave `fluid` out");
    }
    return PEL_OK;
}
