#include "scene/build.h"

#include "base/number.h"
#include "keys/table.h"
#include "keys/validate.h"
#include "observe/field.h"
#include "scene/mesh.h"
#include "scene/place.h"
#include "scene/region.h"
#include "stage/stepper.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_NAMES = 64 };

static pel_status read_load(pel_scene_reader *reader, pel_scene_value *value, const pel_model_def *model,
                            pel_load_def *load)
{
    *load = pel_load_def_default();
    const pel_scene_part part = {reader, value, NULL};
    pel_status status = pel_scene_fill_body(reader, value, model, "load");
    if (status == PEL_OK)
        status = pel_scene_find_body(reader, pel_scene_value_entry(value, "body"), model, &load->body);
    if (status == PEL_OK)
        status = pel_scene_read_members(&part, PEL_DEF_LOAD, load);
    if (status == PEL_OK)
        status = pel_scene_check_times(reader, value, load->from, load->until);
    if (status != PEL_OK)
        return status;
    pel_scene_region region;
    status = pel_scene_region_find(reader, pel_scene_value_entry(value, "at"), model->bodies[load->body].mesh, &region);
    load->vertices = region.vertices;
    load->vertex_count = region.vertices != NULL ? region.count : 0;
    load->weights = region.weights;
    return status;
}

static pel_status read_loads(pel_scene_reader *reader, const pel_scene_value *list, pel_scene *scene)
{
    pel_load_def *loads = pel_arena_take(reader->arena, (size_t)pel_scene_value_count(list), sizeof *loads);
    if (loads == NULL)
        return pel_fail_memory(reader->error);
    pel_status status = pel_scene_check_names(reader, list);
    int32_t count = 0;
    for (pel_scene_value *value = list->first; status == PEL_OK && value != NULL; value = value->next)
        status = read_load(reader, value, &scene->model, &loads[count++]);
    scene->sim.loads = loads;
    scene->sim.load_count = count;
    return status;
}

/* Positions are about an origin. Places above bodies of the scene become positions. */
static pel_status read_motion(pel_scene_reader *reader, const pel_scene_value *list, const pel_scene *scene,
                              const double origin[3], pel_tool_def *tool)
{
    int32_t count = 0;
    pel_pose_key *keys = pel_arena_take(reader->arena, (size_t)pel_scene_value_count(list), sizeof *keys);
    if (keys == NULL)
        return pel_fail_memory(reader->error);
    for (const pel_scene_value *value = list->first; value != NULL; value = value->next) {
        pel_pose_key *key = &keys[count++];
        pel_scene_value *position = pel_scene_value_entry(value, "position");
        key->time = pel_scene_value_number(value, "time");
        key->rotation[3] = 1;
        pel_status status =
            pel_scene_rotation_vector(reader, pel_scene_value_entry(value, "rotation"), key->rotation_vector);
        if (status == PEL_OK && position->kind == PEL_SCENE_MAP)
            status = pel_scene_place_tool(reader, position, scene, tool, key->rotation_vector);
        if (status != PEL_OK)
            return status;
        pel_scene_value_numbers(position, key->position);
        for (int i = 0; i < 3; i++)
            key->position[i] += origin[i];
        if (count > 1 && !(key->time > key[-1].time)) {
            pel_scene_fail(reader, &value->place, "the times of the poses do not increase: %g after %g", key->time,
                           key[-1].time);
            pel_fail_remedy(reader->error, "give each pose a later time than the one before");
            return PEL_BAD_SCENE;
        }
    }
    tool->keys = keys;
    tool->key_count = count;
    return PEL_OK;
}

/* where meshes are made and who owns them */
typedef struct mesh_store {
    const char *folder;
    pel_mesh **meshes;
    int32_t *count;
} mesh_store;

static pel_status read_mesh(pel_scene_reader *reader, pel_scene_value *value, const mesh_store *store,
                            pel_tool_def *tool)
{
    pel_mesh *mesh;
    pel_status status = pel_scene_mesh(reader, value, store->folder, &mesh);
    if (status != PEL_OK)
        return status;
    store->meshes[(*store->count)++] = mesh;
    tool->shape = PEL_TOOL_MESH;
    tool->mesh = mesh;
    return PEL_OK;
}

/* both ends of a blade or hook */
static void read_edge(const pel_scene_value *list, pel_tool_def *tool)
{
    int end = 0;
    for (const pel_scene_value *point = list->first; point != NULL && end < 2; point = point->next)
        pel_scene_value_numbers(point, tool->edge[end++]);
    tool->press = false;
}

static pel_status read_tool(pel_scene_reader *reader, pel_scene_value *value, const pel_scene *scene,
                            const mesh_store *store, pel_tool_def *tool)
{
    const pel_scene_value *body = pel_scene_value_entry(value, "body"), *grasp = pel_scene_value_entry(value, "grasp");
    const pel_scene_part part = {reader, value, NULL};
    *tool = pel_tool_def_default();
    pel_status status = pel_scene_size_tool(reader, value, &scene->model);
    if (status == PEL_OK)
        status = pel_scene_read_members(&part, PEL_DEF_TOOL, tool);
    pel_scene_value *mesh = pel_scene_value_entry(value, "mesh");
    if (status == PEL_OK && mesh != NULL)
        status = read_mesh(reader, mesh, store, tool);
    if (status == PEL_OK && pel_scene_value_entry(value, "edge") != NULL)
        read_edge(pel_scene_value_entry(value, "edge"), tool);
    if (status == PEL_OK && body != NULL)
        status = pel_scene_find_body(reader, body, &scene->model, &tool->body);
    if (status == PEL_OK && grasp != NULL)
        status = pel_scene_check_times(reader, grasp, tool->grasp_from, tool->grasp_until);
    static const double origin[3] = {0};
    return status == PEL_OK ? read_motion(reader, pel_scene_value_entry(value, "motion"), scene, origin, tool) : status;
}

/* pinned vertices that move; the motion is that of the center, from its rest position */
static pel_status read_support(pel_scene_reader *reader, const pel_scene_value *value, const pel_scene *scene,
                               int32_t number, pel_tool_def *tool)
{
    const pel_body_def *body = &scene->model.bodies[number];
    const pel_scene_value *support = pel_scene_value_entry(value, "support");
    size_t size = strlen(body->name) + sizeof "_support";
    char *name = pel_arena_take(reader->arena, size, 1);
    if (name == NULL)
        return pel_fail_memory(reader->error);
    snprintf(name, size, "%s_support", body->name);
    *tool = pel_tool_def_default();
    tool->name = name;
    tool->shape = PEL_TOOL_SUPPORT;
    tool->body = number;
    tool->press = false;
    pel_scene_value_numbers(pel_scene_value_entry(support, "center"), tool->center);
    const pel_scene_part source = {reader, value, body->mesh};
    pel_status status =
        pel_scene_read_vertices(&source, pel_scene_value_entry(value, "pinned"), &tool->vertices, &tool->vertex_count);
    if (status != PEL_OK)
        return status;
    return read_motion(reader, pel_scene_value_entry(support, "motion"), scene, tool->center, tool);
}

/* after the tools of the scene */
static pel_status read_supports(pel_scene_reader *reader, const pel_scene_value *bodies, const pel_scene *scene,
                                pel_tool_def *tools, int32_t *count)
{
    pel_status status = PEL_OK;
    int32_t b = 0;
    for (const pel_scene_value *value = bodies->first; status == PEL_OK && value != NULL; value = value->next, b++) {
        if (pel_scene_value_entry(value, "support") != NULL)
            status = read_support(reader, value, scene, b, &tools[(*count)++]);
        const pel_scene_value *follow = pel_scene_value_entry(value, "follow");
        if (status == PEL_OK && follow != NULL && pel_scene_value_entry(follow, "stiffness") == NULL)
            status = pel_scene_read_follow(reader, value, &scene->model.bodies[b], b, &tools[(*count)++]);
    }
    return status;
}

static pel_status read_tools(pel_scene_reader *reader, const pel_scene_value *root, const mesh_store *store,
                             pel_scene *scene)
{
    const pel_scene_value *list = pel_scene_value_entry(root, "tools"), *bodies = pel_scene_value_entry(root, "bodies");
    size_t most = (size_t)pel_scene_value_count(list) + 2 * (size_t)pel_scene_value_count(bodies);
    pel_tool_def *tools = pel_arena_take(reader->arena, most, sizeof *tools);
    if (tools == NULL)
        return pel_fail_memory(reader->error);
    pel_status status = pel_scene_check_names(reader, list);
    int32_t count = 0;
    for (pel_scene_value *value = list->first; status == PEL_OK && value != NULL; value = value->next)
        status = read_tool(reader, value, scene, store, &tools[count++]);
    if (status == PEL_OK)
        status = read_supports(reader, bodies, scene, tools, &count);
    scene->sim.tools = tools;
    scene->sim.tool_count = count;
    return status;
}

/* pbd-distance uses only the edges and masses of a body; other properties affect only reported energies */
static void note_ignored(pel_scene_reader *reader, const pel_scene_value *body)
{
    static const char *const keys[] = {"membrane", "bending", "anisotropy"};
    const pel_scene_place *place = NULL;
    char names[64] = "";
    for (size_t i = 0; i < sizeof keys / sizeof keys[0]; i++) {
        const pel_scene_value *value = pel_scene_value_entry(body, keys[i]);
        if (value == NULL)
            continue;
        place = place == NULL ? &value->key_place : place;
        size_t length = strlen(names);
        snprintf(names + length, sizeof names - length, "%s%s", length > 0 ? ", " : "", keys[i]);
    }
    if (place != NULL)
        pel_log_line(reader->log,
                     "%s:%d:%d: pbd-distance constrains edge lengths only and ignores %s. use pbd, or xpbd for the "
                     "response of the material",
                     place->source, (int)place->line, (int)place->column, names);
}

/* a field that every run has, or one of a mesh */
static pel_status check_field(pel_scene_reader *reader, const pel_scene_value *field, const pel_model_def *model)
{
    const char *names[MOST_NAMES];
    size_t count = 0;
    for (; count < PEL_FIELD_COUNT; count++)
        names[count] = pel_field_at((int32_t)count)->name;
    for (int32_t b = 0; b < model->body_count; b++)
        for (int32_t f = 0; f < model->bodies[b].mesh->field_count; f++)
            if (count < MOST_NAMES)
                names[count++] = model->bodies[b].mesh->fields[f].name;
    for (size_t i = 0; i < count; i++)
        if (strcmp(names[i], field->text) == 0)
            return PEL_OK;
    return pel_scene_fail_name(reader, &field->place, "field", field->text, names, count);
}

static pel_status read_output(pel_scene_reader *reader, const pel_scene_value *value, pel_scene *scene)
{
    pel_output_def *output = &scene->output;
    const pel_scene_value *list = pel_scene_value_entry(value, "fields");
    const pel_scene_part part = {reader, value, NULL};
    output->every_frame = 1;
    pel_scene_read_members(&part, PEL_DEF_OUTPUT, output);
    const char **fields = pel_arena_take(reader->arena, (size_t)pel_scene_value_count(list), sizeof *fields);
    if (fields == NULL)
        return pel_fail_memory(reader->error);
    output->fields = fields;
    for (const pel_scene_value *field = list->first; field != NULL; field = field->next) {
        pel_status status = check_field(reader, field, &scene->model);
        if (status != PEL_OK)
            return status;
        fields[output->field_count++] = field->text;
    }
    return PEL_OK;
}

/* "auto", "shell", or "relative 1e-4" */
static pel_status read_thickness(pel_scene_reader *reader, const pel_scene_value *value, pel_contact_def *contact)
{
    static const char word[] = "relative ";
    const char *text = value->text, *end = text + strlen(text), *number = text + strlen(word);
    double *relative = &contact->relative_thickness;
    contact->shell_thickness = strcmp(text, "shell") == 0;
    bool fine = contact->shell_thickness || strcmp(text, "auto") == 0 ||
                (strncmp(text, word, strlen(word)) == 0 && pel_number_parse(number, end, relative) == end &&
                 *relative > 0 && isfinite(*relative));
    if (fine)
        return PEL_OK;
    pel_scene_fail(reader, &value->place, "`thickness` '%.80s' is not a thickness", text);
    pel_fail_remedy(reader->error,
                    "give a number of metres, `auto`, `shell`, or `relative` and a number, such as relative 1e-4");
    return PEL_BAD_SCENE;
}

/* a null value is no contact, and so is the word */
static pel_status read_contact(pel_scene_reader *reader, const pel_scene_value *value, pel_contact_def *contact)
{
    contact->enabled = value != NULL && value->form == PEL_FORM_MAP;
    if (!contact->enabled)
        return PEL_OK;
    const pel_scene_part part = {reader, value, NULL};
    const pel_scene_value *thickness = pel_scene_value_entry(value, "thickness");
    pel_status status = pel_scene_read_members(&part, PEL_DEF_CONTACT, contact);
    if (status == PEL_OK && thickness->form == PEL_FORM_TEXT)
        status = read_thickness(reader, thickness, contact);
    return status;
}

/* "STEP COMMAND"; the command itself is read by who repeats it */
static pel_status read_command(pel_scene_reader *reader, const pel_scene_value *value, int64_t least,
                               pel_scene_command *command)
{
    char *end;
    long long step = strtoll(value->text, &end, 10);
    if (value->text[0] < '0' || value->text[0] > '9' || *end != ' ' || step < least || step > INT32_MAX) {
        pel_scene_fail(reader, &value->place, "a command of the session has no step from %lld on: \"%.60s\"",
                       (long long)least, value->text);
        pel_fail_remedy(reader->error, "write the step, a space and the command: \"120 release\"");
        return PEL_BAD_SCENE;
    }
    *command = (pel_scene_command){step, end + 1, value->place.line, value->place.column};
    return PEL_OK;
}

static pel_status read_session(pel_scene_reader *reader, const pel_scene_value *list, pel_scene *scene)
{
    if (list == NULL)
        return PEL_OK;
    pel_scene_command *commands = pel_arena_take(reader->arena, (size_t)pel_scene_value_count(list), sizeof *commands);
    if (commands == NULL)
        return pel_fail_memory(reader->error);
    scene->session = commands;
    int64_t least = 0;
    for (const pel_scene_value *value = list->first; value != NULL; value = value->next) {
        pel_scene_command *command = &commands[scene->session_count];
        pel_status status = read_command(reader, value, least, command);
        if (status != PEL_OK)
            return status;
        least = command->step;
        scene->session_count++;
    }
    return PEL_OK;
}

/* a branch is one of a path */
static pel_status check_branch(pel_scene_reader *reader, const pel_scene_value *solver, const pel_solver_def *numbers)
{
    const pel_scene_value *branch = pel_scene_value_entry(solver, "branch");
    if (branch == NULL || numbers->branch == PEL_BRANCH_SAME || numbers->path == PEL_PATH_ARC_LENGTH)
        return PEL_OK;
    pel_scene_fail(reader, &branch->place, "`branch: lowest` needs a path by arc length that it could leave");
    pel_fail_remedy(reader->error, "add path: arc-length, or remove it: static leaves equilibria that are no minimum "
                                   "along their lowest mode by itself");
    return PEL_BAD_SCENE;
}

pel_status pel_scene_build_sim(pel_scene_reader *reader, const pel_scene_value *root, const char *folder,
                               pel_scene *scene, pel_mesh **meshes, int32_t *mesh_count)
{
    const mesh_store store = {folder, meshes, mesh_count};
    const pel_scene_part whole = {reader, root, NULL}, solver = {reader, pel_scene_value_entry(root, "solver"), NULL};
    pel_solver_def *numbers = &scene->sim.solver;
    scene->title = "";
    scene->sim = pel_sim_def_default();
    pel_scene_read_members(&whole, PEL_DEF_SCENE, scene);
    if (pel_scene_read_members(&whole, PEL_DEF_SIM, &scene->sim) != PEL_OK)
        return PEL_BAD_ARGUMENT;
    pel_scene_read_members(&solver, PEL_DEF_SOLVER, numbers);
    if (numbers->analysis == PEL_ANALYSIS_NONE)
        numbers->mode_count = 0;
    const pel_scene_value *bodies = pel_scene_value_entry(root, "bodies");
    for (const pel_scene_value *body = bodies->first; body != NULL; body = body->next)
        if (pel_stepper_of(numbers->method)->has_lengths)
            note_ignored(reader, body);
    pel_status status = check_branch(reader, solver.value, numbers);
    if (status == PEL_OK)
        status = read_loads(reader, pel_scene_value_entry(root, "loads"), scene);
    if (status == PEL_OK)
        status = read_contact(reader, pel_scene_value_entry(root, "contact"), &scene->sim.contact);
    if (status == PEL_OK)
        status = read_tools(reader, root, &store, scene);
    if (status == PEL_OK)
        status = pel_scene_build_supports(reader, bodies, scene);
    if (status == PEL_OK)
        status = pel_scene_build_ties(reader, root, scene);
    if (status == PEL_OK)
        status = pel_scene_build_joints(reader, root, scene);
    if (status == PEL_OK)
        status = read_session(reader, pel_scene_value_entry(root, "session"), scene);
    return status == PEL_OK ? read_output(reader, pel_scene_value_entry(root, "output"), scene) : status;
}
