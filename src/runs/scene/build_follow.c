/* Bodies that follow a sequence: `bodies[].follow`. */
#include "keys/table.h"
#include "pellicle/import.h"
#include "scene/build.h"
#include "scene/mesh.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* makes the path absolute; a pattern stays the name in its folder */
static pel_status resolve(pel_scene_reader *reader, pel_scene_value *file, const char *folder)
{
    const char *text = file->text, *slash = strrchr(text, '/'), *name = slash != NULL ? slash + 1 : text;
    if (strchr(name, '*') == NULL)
        return pel_scene_resolve_path(reader, "sequence", file, folder);
    size_t length = slash == NULL ? 1 : slash == text ? 1 : (size_t)(slash - text);
    file->text = pel_arena_text(reader->arena, slash == NULL ? "." : text, length);
    if (file->text == NULL)
        return pel_fail_memory(reader->error);
    pel_status status = pel_scene_resolve_path(reader, "folder", file, folder);
    if (status != PEL_OK)
        return status;
    size_t size = strlen(file->text) + strlen(name) + sizeof "/";
    char *joined = pel_arena_take(reader->arena, size, 1);
    if (joined == NULL)
        return pel_fail_memory(reader->error);
    snprintf(joined, size, "%s/%s", file->text, name);
    file->text = joined;
    return PEL_OK;
}

/* the row of each vertex: its own, or of a mesh that was welded the first one of its file */
static pel_status find_rows(pel_scene_reader *reader, const pel_scene_value *file, const pel_mesh *mesh,
                            int32_t vertex_count, int32_t **rows)
{
    const pel_scene_welding *welding = reader->weldings;
    while (welding != NULL && welding->mesh != mesh)
        welding = welding->next;
    int32_t count = mesh->vertex_count, file_count = welding != NULL ? welding->file_count : count;
    if (vertex_count != count && vertex_count != file_count) {
        pel_scene_fail(reader, &file->place, "the sequence '%.120s' has %d vertices, the mesh of the body has %d",
                       file->text, (int)vertex_count, (int)file_count);
        pel_fail_remedy(reader->error, "use a sequence of the same mesh, with the same order of vertices");
        return PEL_BAD_SCENE;
    }
    *rows = pel_arena_take(reader->arena, (size_t)count, sizeof **rows);
    if (*rows == NULL)
        return pel_fail_memory(reader->error);
    for (int32_t v = 0; v < count; v++)
        (*rows)[v] = v;
    for (int32_t v = file_count - 1; vertex_count != count && v >= 0; v--)
        (*rows)[welding->index_of[v]] = v;
    return PEL_OK;
}

static pel_status read_sequence(pel_scene_reader *reader, const pel_scene_value *value, const char *folder,
                                const pel_mesh *mesh, pel_sequence **sequence)
{
    const pel_scene_value *follow = pel_scene_value_entry(value, "follow");
    const pel_scene_value *animation = pel_scene_value_entry(follow, "animation");
    pel_scene_value *file = pel_scene_value_entry(follow, "file");
    pel_sequence *read = NULL;
    pel_transform transform;
    int32_t *rows = NULL;
    pel_status status = resolve(reader, file, folder);
    if (status == PEL_OK)
        status = pel_scene_transform(reader, pel_scene_value_entry(value, "mesh"), &transform);
    if (status != PEL_OK)
        return status;
    status = pel_sequence_read(file->text, animation != NULL ? animation->text : NULL,
                               pel_scene_value_number(follow, "fps"), &read, reader->error);
    /* errors inside a file have their own place */
    if (status == PEL_BAD_FILE || status == PEL_BAD_ARGUMENT)
        return pel_scene_fail_at(reader, status == PEL_BAD_FILE ? &file->place : &animation->place);
    if (status == PEL_OK)
        status = find_rows(reader, file, mesh, pel_sequence_vertex_count(read), &rows);
    if (status == PEL_OK)
        status = pel_sequence_map(read, rows, mesh->vertex_count, &transform, pel_scene_value_number(follow, "start"),
                                  sequence, reader->error);
    pel_sequence_destroy(read);
    return status;
}

/* all vertices, from the start on */
static bool is_whole(const pel_scene_value *follow)
{
    const pel_scene_value *at = pel_scene_value_entry(follow, "at");
    return pel_scene_value_entry(follow, "stiffness") == NULL && at->form == PEL_FORM_WORD &&
           strcmp(at->text, "all") == 0 && !(pel_scene_value_number(follow, "from") > 0);
}

pel_status pel_scene_build_follow(pel_scene_reader *reader, const pel_scene_value *value, const char *folder,
                                  int32_t body, pel_mesh *mesh)
{
    const pel_scene_value *follow = pel_scene_value_entry(value, "follow");
    if (follow == NULL)
        return PEL_OK;
    pel_sequence_destroy(reader->sequences[body]);
    reader->sequences[body] = NULL;
    pel_status status = read_sequence(reader, value, folder, mesh, &reader->sequences[body]);
    if (status == PEL_OK && is_whole(follow))
        pel_sequence_at(reader->sequences[body], 0, mesh->positions[0]);
    return status;
}

pel_status pel_scene_read_follow(pel_scene_reader *reader, const pel_scene_value *value, const pel_body_def *body,
                                 int32_t number, pel_tool_def *tool)
{
    const pel_scene_value *follow = pel_scene_value_entry(value, "follow");
    const pel_scene_value *until = pel_scene_value_entry(follow, "until");
    const pel_scene_value *strength = pel_scene_value_entry(follow, "strength");
    size_t size = strlen(body->name) + sizeof "_follow";
    char *name = pel_arena_take(reader->arena, size, 1);
    pel_pose_key *key = pel_arena_take(reader->arena, 1, sizeof *key);
    if (name == NULL || key == NULL)
        return pel_fail_memory(reader->error);
    snprintf(name, size, "%s_follow", body->name);
    *key = (pel_pose_key){.rotation = {0, 0, 0, 1}};
    *tool = pel_tool_def_default();
    tool->name = name;
    tool->shape = PEL_TOOL_SUPPORT;
    tool->body = number;
    tool->press = false;
    tool->keys = key;
    tool->key_count = 1;
    tool->sequence = reader->sequences[number];
    tool->grasp_from = pel_scene_value_number(follow, "from");
    if (until->form != PEL_FORM_WORD)
        tool->grasp_until = until->number;
    tool->strength = strength != NULL ? strength->number : 0;
    const pel_scene_part source = {reader, value, body->mesh};
    pel_status status = pel_scene_check_times(reader, follow, tool->grasp_from, tool->grasp_until);
    return status == PEL_OK ? pel_scene_read_vertices(&source, pel_scene_value_entry(follow, "at"), &tool->vertices,
                                                      &tool->vertex_count)
                            : status;
}
