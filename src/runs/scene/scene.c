/* Reading a scene: YAML -> tree -> overrides -> checked against the table -> meshes and defs. */
#include "pellicle/scene.h"

#include "base/memory.h"
#include "choice/apart.h"
#include "choice/damping.h"
#include "choice/element.h"
#include "choice/fluid.h"
#include "choice/method.h"
#include "choice/time_step.h"
#include "io/file.h"
#include "keys/override.h"
#include "keys/print.h"
#include "keys/validate.h"
#include "keys/yaml.h"
#include "scene/build.h"
#include "scene/defaults.h"
#include "scene/portable.h"
#include "stage/stepper.h"

#include <stdio.h>
#include <string.h>

/* everything that a scene owns */
typedef struct scene_storage {
    pel_arena arena;
    pel_mesh **meshes; /* (mesh_count) */
    int32_t mesh_count;
    pel_sequence **sequences; /* (sequence_count) of bodies that follow one; others are null */
    int32_t sequence_count;
    const pel_scene_value *root;
    const char *text; /* resolved */
} scene_storage;

/* source of a scene */
typedef struct scene_source {
    const char *path, *text;
    size_t size;
    const char *const *overrides;
    int32_t override_count;
} scene_source;

void pel_scene_destroy(pel_scene *scene)
{
    if (scene == NULL)
        return;
    scene_storage *storage = scene->inner;
    for (int32_t b = 0; storage != NULL && b < storage->mesh_count; b++)
        pel_mesh_destroy(storage->meshes[b]);
    for (int32_t b = 0; storage != NULL && b < storage->sequence_count; b++)
        pel_sequence_destroy(storage->sequences[b]);
    if (storage != NULL)
        pel_arena_free(&storage->arena);
    pel_free(storage);
    pel_free(scene);
}

static pel_scene *create_scene(void)
{
    pel_scene *scene = pel_allocate(1, sizeof *scene);
    if (scene == NULL)
        return NULL;
    scene->inner = pel_allocate(1, sizeof(scene_storage));
    if (scene->inner != NULL)
        return scene;
    pel_free(scene);
    return NULL;
}

/* the folder of a path, "." if it has none; null if out of memory */
static const char *folder_of(pel_arena *arena, const char *path)
{
    const char *slash = strrchr(path, '/');
    if (slash == NULL)
        return ".";
    return pel_arena_text(arena, path, slash == path ? 1 : (size_t)(slash - path));
}

/* YAML, overrides and check; null with the error filled on failure */
static pel_scene_value *read_tree(pel_scene_reader *reader, const scene_source *source, const char *path)
{
    pel_scene_value *root = pel_scene_yaml_parse(reader, path, source->text, source->size, true);
    if (root == NULL)
        return NULL;
    for (int32_t i = 0; root->kind == PEL_SCENE_MAP && i < source->override_count; i++)
        if (pel_scene_override(reader, root, source->overrides[i]) != PEL_OK)
            return NULL;
    if (pel_scene_fill_defaults(reader, root) != PEL_OK)
        return NULL;
    return pel_scene_check(reader, root) == PEL_OK ? root : NULL;
}

/* paths of the meshes of bodies and tools, absolute since the meshes were read */
static pel_status list_mesh_files(pel_scene_reader *reader, const pel_scene_value *root, int32_t most, pel_scene *scene)
{
    static const struct {
        const char *list, *file;
    } places[] = {{"bodies", "mesh.file"}, {"bodies", "rest.file"}, {"tools", "mesh.file"}};
    const char **files = pel_arena_take(reader->arena, (size_t)most, sizeof *files);
    if (files == NULL)
        return pel_fail_memory(reader->error);
    for (size_t l = 0; l < sizeof places / sizeof *places; l++) {
        const pel_scene_value *list = pel_scene_value_entry(root, places[l].list);
        for (const pel_scene_value *value = list != NULL ? list->first : NULL; value != NULL; value = value->next) {
            const pel_scene_value *file = pel_scene_value_at(value, places[l].file);
            if (file != NULL)
                files[scene->mesh_file_count++] = file->text;
        }
    }
    scene->mesh_files = files;
    return PEL_OK;
}

static pel_status choose_method(pel_scene_reader *reader, const pel_scene_value *root, pel_scene *scene)
{
    pel_status status = pel_scene_choose_method(reader, root, scene);
    if (status != PEL_OK)
        return status;
    pel_scene_choose_bending(root, scene);
    return PEL_OK;
}

/* bodies, loads, tools, cuts and seams */
static pel_status build_parts(pel_scene_reader *reader, pel_scene_value *root, const char *folder, pel_scene *scene)
{
    scene_storage *storage = scene->inner;
    pel_sim_def opened = {0};
    pel_status status = pel_scene_take_cuts(reader, root, &opened);
    if (status == PEL_OK)
        status = pel_scene_build_bodies(reader, root, folder, scene, storage->meshes, &storage->mesh_count, &opened);
    if (status == PEL_OK)
        status = pel_scene_build_sim(reader, root, folder, scene, storage->meshes, &storage->mesh_count);
    if (status == PEL_OK)
        status = pel_scene_keep_apart(reader, root, scene);
    scene->sim.cuts = opened.cuts;
    scene->sim.cut_count = opened.cut_count;
    scene->sim.seams = opened.seams;
    scene->sim.seam_count = opened.seam_count;
    return status == PEL_OK ? pel_scene_check_cuts(reader, root, scene) : status;
}

/* builds all again where the meshes of bodies became finer around what acts on them */
static pel_status refine_meshes(pel_scene_reader *reader, pel_scene_value *root, const char *folder,
                                const pel_scene *blank, pel_scene *scene)
{
    scene_storage *storage = scene->inner;
    const pel_log *log = reader->log;
    const pel_sim_def before = scene->sim;
    bool any;
    pel_status status = pel_scene_refine_meshes(reader, root, scene, storage->meshes, &any);
    if (status != PEL_OK || !any)
        return status;
    /* everything was told the first time */
    reader->log = NULL;
    reader->made = storage->meshes;
    const int32_t mesh_count = storage->mesh_count;
    *scene = *blank;
    status = build_parts(reader, root, folder, scene);
    storage->mesh_count = mesh_count;
    reader->made = NULL;
    reader->log = log;
    return status == PEL_OK ? pel_scene_check_refined_loads(reader, root, &before, &scene->sim) : status;
}

static pel_status build(pel_scene_reader *reader, pel_scene_value *root, const char *folder, pel_scene *scene)
{
    scene_storage *storage = scene->inner;
    const pel_scene blank = *scene;
    bool damps = false;
    int32_t body_count = pel_scene_value_count(pel_scene_value_entry(root, "bodies"));
    int32_t tool_count = pel_scene_value_count(pel_scene_value_entry(root, "tools"));
    int32_t most = 2 * body_count + tool_count;
    storage->meshes = pel_arena_take(reader->arena, (size_t)most, sizeof(pel_mesh *));
    reader->sequences = storage->sequences =
        pel_arena_take(reader->arena, (size_t)body_count, sizeof *storage->sequences);
    if (storage->meshes == NULL || storage->sequences == NULL)
        return pel_fail_memory(reader->error);
    storage->sequence_count = body_count;
    pel_status status = build_parts(reader, root, folder, scene);
    if (status == PEL_OK)
        pel_scene_choose_elements(reader, root, scene);
    if (status == PEL_OK)
        status = refine_meshes(reader, root, folder, &blank, scene);
    if (status != PEL_OK)
        return status;
    status = list_mesh_files(reader, root, most, scene);
    if (status != PEL_OK)
        return status;
    status = pel_scene_keep_fillings(reader, root, scene);
    if (status == PEL_OK)
        status = choose_method(reader, root, scene);
    if (status == PEL_OK)
        status = pel_scene_make_imperfect(reader, root, scene, storage->meshes, storage->mesh_count);
    if (status == PEL_OK)
        status = pel_scene_take_loss_factors(reader, root, scene, &damps);
    /* damping counts as stiffness, and loss factors become damping at a frequency that a method finds */
    if (status == PEL_OK && damps)
        status = choose_method(reader, root, scene);
    if (status == PEL_OK)
        status = pel_scene_choose_dt(reader, root, scene);
    if (status == PEL_OK)
        pel_scene_tell_cost(reader, scene);
    /* default names have been added to the tree: sort it */
    if (status == PEL_OK)
        status = pel_scene_check(reader, root);
    if (status != PEL_OK)
        return status;
    pel_scene_forget_soft_keys(root);
    storage->root = root;
    storage->text = pel_scene_print(reader, root);
    return storage->text != NULL ? PEL_OK : PEL_OUT_OF_MEMORY;
}

static pel_status fill_scene(pel_scene *scene, const scene_source *source, const pel_log *log, pel_error *error)
{
    pel_arena *arena = &((scene_storage *)scene->inner)->arena;
    pel_scene_reader reader = {.arena = arena, .table = pel_scene_table_create(arena), .log = log, .error = error};
    const char *folder = folder_of(arena, source->path);
    scene->path = pel_arena_text(arena, source->path, strlen(source->path));
    if (reader.table == NULL || folder == NULL || scene->path == NULL)
        return pel_fail_memory(error);
    pel_scene_value *root = read_tree(&reader, source, scene->path);
    return root != NULL ? build(&reader, root, folder, scene) : error->status;
}

static pel_status create(const scene_source *source, const pel_log *log, pel_scene **scene, pel_error *error)
{
    *scene = create_scene();
    if (*scene == NULL)
        return pel_fail_memory(error);
    /* the parts below rely on an error being there */
    pel_error inner_error = {0};
    pel_status status = fill_scene(*scene, source, log, &inner_error);
    if (status == PEL_OK)
        return PEL_OK;
    if (error != NULL)
        *error = inner_error;
    pel_scene_destroy(*scene);
    *scene = NULL;
    return status;
}

static pel_status check_overrides(const char *const *overrides, int32_t count, pel_error *error)
{
    if (count < 0)
        return pel_fail(error, PEL_BAD_ARGUMENT, "override_count is %d", (int)count);
    if (count > 0)
        PEL_REFUSE_NULL(overrides, error);
    for (int32_t i = 0; i < count; i++)
        if (overrides[i] == NULL)
            return pel_fail(error, PEL_BAD_ARGUMENT, "overrides[%d] is null", (int)i);
    return PEL_OK;
}

pel_status pel_scene_parse(const char *path, const char *text, size_t size, const char *const *overrides,
                           int32_t override_count, const pel_log *log, pel_scene **scene, pel_error *error)
{
    PEL_REFUSE_NULL(path, error);
    PEL_REFUSE_NULL(text, error);
    PEL_REFUSE_NULL(scene, error);
    pel_status checked = check_overrides(overrides, override_count, error);
    if (checked != PEL_OK)
        return checked;
    scene_source source = {path, text, size, overrides, override_count};
    return create(&source, log, scene, error);
}

pel_status pel_scene_load(const char *path, const char *const *overrides, int32_t override_count, const pel_log *log,
                          pel_scene **scene, pel_error *error)
{
    PEL_REFUSE_NULL(path, error);
    PEL_REFUSE_NULL(scene, error);
    pel_status checked = check_overrides(overrides, override_count, error);
    if (checked != PEL_OK)
        return checked;
    char *text;
    size_t size;
    *scene = NULL;
    pel_status status = pel_file_read(path, &text, &size, error);
    if (status != PEL_OK)
        return status;
    scene_source source = {path, text, size, overrides, override_count};
    status = create(&source, log, scene, error);
    pel_free(text);
    return status;
}

const pel_scene_value *pel_scene_root(const pel_scene *scene)
{
    return ((const scene_storage *)scene->inner)->root;
}

const char *pel_scene_text(const pel_scene *scene)
{
    if (scene == NULL)
        return "";
    return ((const scene_storage *)scene->inner)->text;
}

char *pel_scene_portable_text(const pel_scene *scene, const char *const *names)
{
    const pel_scene_names renamed = {scene->mesh_files, names, scene->mesh_file_count};
    return pel_scene_print_renamed(((const scene_storage *)scene->inner)->root, &renamed);
}

/* supports are counted through all bodies */
static const pel_scene_value *find_support(const pel_scene_value *root, int64_t number)
{
    for (const pel_scene_value *body = pel_scene_value_entry(root, "bodies")->first; body != NULL; body = body->next) {
        const pel_scene_value *list = pel_scene_value_entry(body, "supports");
        int64_t count = (int64_t)pel_scene_value_count(list);
        if (number < count)
            return pel_scene_value_element(list, number);
        number -= count;
    }
    return NULL;
}

/* the value that an error of the model or the simulation refers to; otherwise the whole scene */
static const pel_scene_value *find_cause(const pel_scene *scene, const pel_error *error)
{
    static const char *const kinds[][2] = {
        {"body", "bodies"}, {"load", "loads"}, {"tool", "tools"}, {"joint", "joints"}};
    const pel_scene_value *root = ((const scene_storage *)scene->inner)->root;
    if (error->element >= 0 && strcmp(error->element_kind, "support") == 0)
        return find_support(root, error->element);
    if (error->status == PEL_UNSTABLE)
        return pel_scene_value_at(root,
                                  pel_stepper_of(scene->sim.solver.method)->is_explicit ? "solver.dt" : "solver.alpha");
    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++) {
        const pel_scene_value *list = pel_scene_value_entry(root, kinds[i][1]);
        const pel_scene_value *element = error->element >= 0 && strcmp(error->element_kind, kinds[i][0]) == 0
                                             ? pel_scene_value_element(list, error->element)
                                             : NULL;
        if (element != NULL)
            return element;
    }
    return NULL;
}

/* people know bodies, loads, tools, joints and supports by their names */
static void name_element(const pel_scene *scene, pel_error *error)
{
    const char *name = NULL, *kind = error->element_kind;
    const int64_t i = error->element;
    if (strcmp(kind, "body") == 0 && i >= 0 && i < scene->model.body_count)
        name = scene->model.bodies[i].name;
    else if (strcmp(kind, "load") == 0 && i >= 0 && i < scene->sim.load_count)
        name = scene->sim.loads[i].name;
    else if (strcmp(kind, "tool") == 0 && i >= 0 && i < scene->sim.tool_count)
        name = scene->sim.tools[i].name;
    else if (strcmp(kind, "joint") == 0 && i >= 0 && i < scene->sim.joint_count)
        name = scene->sim.joints[i].name;
    else if (strcmp(kind, "support") == 0 && i >= 0 && i < scene->sim.support_count)
        name = scene->sim.supports[i].name;
    if (name != NULL)
        snprintf(error->element_name, sizeof error->element_name, "%s", name);
}

void pel_scene_locate(const pel_scene *scene, pel_error *error)
{
    if (scene == NULL || error == NULL)
        return;
    name_element(scene, error);
    if (error->file[0] != '\0')
        return;
    const pel_scene_value *cause = find_cause(scene, error);
    if (cause != NULL)
        pel_fail_place(error, cause->place.source, cause->place.line, cause->place.column);
    else
        pel_fail_place(error, scene->path, 0, 0);
}
