#include "study/study.h"

#include "base/hash.h"
#include "base/memory.h"
#include "io/file.h"
#include "keys/validate.h"
#include "keys/yaml.h"
#include "pellicle/scene.h"

#include <inttypes.h>
#include <string.h>

static const char *const study_keys[] = {"scene", "vary", "measure", "keep"};
static const char *const boolean_words[] = {"false", "true"};

int64_t pel_study_index(const pel_study *study, int64_t run, int32_t group)
{
    for (int32_t g = study->group_count - 1; g > group; g--)
        run /= study->group_sizes[g];
    return run % study->group_sizes[group];
}

const char *const *pel_study_overrides(const pel_study *study, int64_t run, pel_arena *arena)
{
    const char **overrides = pel_arena_take(arena, (size_t)study->axis_count, sizeof *overrides);
    for (int32_t a = 0; overrides != NULL && a < study->axis_count; a++) {
        const pel_study_axis *axis = &study->axes[a];
        const char *value = axis->values[pel_study_index(study, run, axis->group)];
        size_t size = strlen(axis->path) + strlen(value) + 2;
        char *text = pel_arena_take(arena, size, 1);
        if (text == NULL)
            return NULL;
        snprintf(text, size, "%s=%s", axis->path, value);
        overrides[a] = text;
    }
    return overrides;
}

/* ---- the scene ---- */

/* an error of the scene's file, told at its place in the study when the file cannot be read */
static pel_status read_scene_file(pel_scene_reader *reader, const pel_scene_value *scene, pel_study *study)
{
    pel_status status = pel_study_need_text(reader, scene, &study->scene_name);
    if (status != PEL_OK)
        return status;
    study->scene_path = pel_study_resolve(reader, study->path, study->scene_name);
    if (study->scene_path == NULL)
        return PEL_OUT_OF_MEMORY;
    status = pel_file_read(study->scene_path, &study->scene_text, &study->scene_size, reader->error);
    if (status == PEL_BAD_FILE)
        pel_study_fail_file(reader, scene);
    return status;
}

/* a value of the study that the scene refuses is told at its place in the study */
static pel_status place_override(pel_scene_reader *reader, const pel_study *study, pel_status status)
{
    static const char prefix[] = "--set ";
    const char *file = reader->error->file;
    for (int32_t a = 0; a < study->axis_count; a++) {
        size_t length = strlen(study->axes[a].path);
        if (strncmp(file, prefix, sizeof prefix - 1) != 0 ||
            strncmp(file + sizeof prefix - 1, study->axes[a].path, length) != 0 ||
            file[sizeof prefix - 1 + length] != '=')
            continue;
        const pel_scene_place *place = &study->axes[a].place;
        pel_fail_place(reader->error, place->source, place->line, place->column);
        return status;
    }
    return status;
}

static uint64_t hash_text(uint64_t hash, const char *text)
{
    return pel_hash_bytes(hash, text, strlen(text) + 1);
}

/* a mesh by its bytes: wherever it lies */
static pel_status hash_file(const char *path, uint64_t *hash, pel_error *error)
{
    char *bytes;
    size_t size;
    pel_status status = pel_file_read(path, &bytes, &size, error);
    if (status != PEL_OK)
        return status;
    *hash = pel_hash_block(*hash, bytes, size);
    pel_free(bytes);
    return PEL_OK;
}

static uint64_t hash_design(const pel_study *study)
{
    uint64_t hash = hash_text(PEL_HASH_START, PEL_VERSION);
    hash = pel_hash_block(hash, study->scene_text, study->scene_size);
    for (int32_t a = 0; a < study->axis_count; a++) {
        hash = hash_text(pel_hash_word(hash, (uint64_t)study->axes[a].group), study->axes[a].path);
        for (int64_t i = 0; i < study->axes[a].count; i++)
            hash = hash_text(hash, study->axes[a].values[i]);
    }
    for (int32_t m = 0; m < study->measure_count; m++) {
        const pel_study_measure *measure = &study->measures[m];
        hash = hash_text(pel_hash_word(hash, (uint64_t)measure->at), measure->name);
        hash = pel_hash_word(hash, (uint64_t)measure->key);
        hash = hash_text(hash, measure->column != NULL ? measure->column : "");
    }
    return hash;
}

/* the scene with the values of the first run: wrong keys and values are told before any run */
static pel_status check_scene(pel_scene_reader *reader, pel_study *study)
{
    pel_scene *scene;
    pel_status status = pel_study_scene(study, 0, &scene, reader->error);
    if (status != PEL_OK)
        return place_override(reader, study, status);
    study->fingerprint = hash_design(study);
    for (int32_t i = 0; i < scene->mesh_file_count && status == PEL_OK; i++)
        status = hash_file(scene->mesh_files[i], &study->fingerprint, reader->error);
    pel_scene_destroy(scene);
    return status == PEL_OK ? pel_study_check_columns(reader, study) : status;
}

/* ---- the table ---- */

static pel_status make_header(pel_scene_reader *reader, pel_study *study)
{
    enum { NUMBER_ROOM = 32, ERROR_ROOM = 3000 };
    pel_json json = {0};
    study->row_size = ERROR_ROOM + (size_t)study->measure_count * NUMBER_ROOM;
    pel_json_print(&json, "run");
    for (int32_t a = 0; a < study->axis_count; a++) {
        pel_json_print(&json, ",");
        pel_study_put_cell(&json, study->axes[a].path);
        size_t longest = 0;
        for (int64_t i = 0; i < study->axes[a].count; i++) {
            size_t length = strlen(study->axes[a].values[i]);
            longest = length > longest ? length : longest;
        }
        /* each letter may be a quote that is doubled */
        study->row_size += 2 * longest + 3;
    }
    for (int32_t m = 0; m < study->measure_count; m++) {
        pel_json_print(&json, ",");
        pel_study_put_cell(&json, study->measures[m].name);
    }
    pel_json_print(&json, ",status,error");
    study->header = json.failed ? NULL : pel_arena_text(reader->arena, json.text, json.length);
    pel_json_free(&json);
    return study->header != NULL ? PEL_OK : pel_fail_memory(reader->error);
}

/* ---- reading ---- */

static pel_status need_key(pel_scene_reader *reader, const pel_scene_value *root, const char *key, const char *remedy,
                           const pel_scene_value **value)
{
    *value = pel_scene_value_entry(root, key);
    if (*value != NULL)
        return PEL_OK;
    pel_scene_fail(reader, &root->place, "the study has no %s", key);
    pel_fail_remedy(reader->error, "%s", remedy);
    return PEL_BAD_SCENE;
}

static pel_status read_study(pel_scene_reader *reader, const pel_scene_value *root, pel_study *study)
{
    const pel_scene_value *scene, *vary, *keep = NULL;
    int32_t word = 0;
    pel_status status = pel_scene_check_kind(reader, root, "study");
    if (status == PEL_OK)
        status = pel_study_check_keys(reader, root, "a study", study_keys, sizeof study_keys / sizeof *study_keys);
    if (status == PEL_OK)
        status = need_key(reader, root, "scene", "write scene: FILE.yaml", &scene);
    if (status == PEL_OK)
        status = need_key(reader, root, "vary", "write vary: { solver.dt: [0.01, 0.02] }", &vary);
    if (status == PEL_OK)
        keep = pel_scene_value_entry(root, "keep");
    if (keep != NULL)
        status = pel_study_need_word(reader, keep, boolean_words, 2, &word);
    study->keep = word == 1;
    if (status == PEL_OK)
        status = pel_study_read_vary(reader, vary, study);
    if (status == PEL_OK)
        status = pel_study_read_measures(reader, pel_scene_value_entry(root, "measure"), study);
    if (status == PEL_OK)
        status = read_scene_file(reader, scene, study);
    if (status == PEL_OK)
        status = make_header(reader, study);
    return status == PEL_OK ? check_scene(reader, study) : status;
}

static pel_status parse(const char *path, const char *text, size_t size, pel_study *study, pel_error *error)
{
    study->path = pel_arena_text(&study->arena, path, strlen(path));
    if (study->path == NULL)
        return pel_fail_memory(error);
    pel_scene_reader reader = {.arena = &study->arena, .error = error};
    const pel_scene_value *root = pel_scene_yaml_parse(&reader, study->path, text, size, true);
    return root != NULL ? read_study(&reader, root, study) : error->status;
}

pel_status pel_study_parse(const char *path, const char *text, size_t size, pel_study **study, pel_error *error)
{
    PEL_REFUSE_NULL(study, error);
    *study = NULL;
    PEL_REFUSE_NULL(path, error);
    PEL_REFUSE_NULL(text, error);
    pel_study *made = pel_allocate(1, sizeof *made);
    if (made == NULL)
        return pel_fail_memory(error);
    /* the parts rely on an error being there */
    pel_error inner = {0};
    pel_status status = parse(path, text, size, made, &inner);
    if (status == PEL_OK) {
        *study = made;
        return PEL_OK;
    }
    if (error != NULL)
        *error = inner;
    pel_study_destroy(made);
    return status;
}

pel_status pel_study_load(const char *path, pel_study **study, pel_error *error)
{
    char *text;
    size_t size;
    PEL_REFUSE_NULL(study, error);
    *study = NULL;
    PEL_REFUSE_NULL(path, error);
    pel_status status = pel_file_read(path, &text, &size, error);
    if (status != PEL_OK)
        return status;
    status = pel_study_parse(path, text, size, study, error);
    pel_free(text);
    return status;
}

void pel_study_destroy(pel_study *study)
{
    if (study == NULL)
        return;
    pel_free(study->scene_text);
    pel_arena_free(&study->arena);
    pel_free(study);
}

int64_t pel_study_run_count(const pel_study *study)
{
    return study != NULL ? study->run_count : 0;
}

const char *pel_study_header(const pel_study *study)
{
    return study != NULL ? study->header : "";
}
