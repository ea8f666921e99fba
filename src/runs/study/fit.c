/* Fit files: their keys are checked here, where lines and columns are known; pellicle.calibrate (Python) does the fit.
 */
#include "study/study.h"

#include "base/memory.h"
#include "io/file.h"
#include "keys/validate.h"
#include "keys/yaml.h"

#include <string.h>

static const char *const fit_keys[] = {"scene", "parameters", "data", "confidence", "max_evaluations"};
static const char *const parameter_keys[] = {"start", "from", "to", "scale"};
static const char *const data_keys[] = {"file",    "x",       "y",      "column_x", "column_y",
                                        "scale_x", "scale_y", "weight", "body"};

/* ---- the value as JSON ---- */

static void put_as_json(pel_json *json, const pel_scene_value *scalar)
{
    double number;
    if (!scalar->quoted && pel_scene_parse_number(scalar->text, &number))
        pel_json_put_number(json, number);
    else
        pel_json_put_text(json, scalar->text);
}

/* ---- checks ---- */

static pel_status need_entry(pel_scene_reader *reader, const pel_scene_value *map, const char *key,
                             const pel_scene_value **value)
{
    *value = pel_scene_value_entry(map, key);
    if (*value != NULL)
        return PEL_OK;
    pel_scene_fail(reader, &map->place, "the key '%s' is missing", key);
    pel_fail_remedy(reader->error, "add it; docs/sweeps.md has a fit file");
    return PEL_BAD_SCENE;
}

static pel_status check_parameter(pel_scene_reader *reader, const pel_scene_value *parameter)
{
    static const char *const words[] = {"linear", "log"};
    const pel_scene_value *value;
    double start = 0, from = 0, to = 0;
    double *const numbers[3] = {&start, &from, &to};
    int32_t word = 0;
    pel_status status = pel_study_check_keys(reader, parameter, "a parameter", parameter_keys, 4);
    for (int i = 0; i < 3 && status == PEL_OK; i++) {
        status = need_entry(reader, parameter, parameter_keys[i], &value);
        if (status == PEL_OK)
            status = pel_study_need_number(reader, value, numbers[i]);
    }
    value = pel_scene_value_entry(parameter, "scale");
    if (status == PEL_OK && value != NULL)
        status = pel_study_need_word(reader, value, words, 2, &word);
    if (status != PEL_OK)
        return status;
    if (from < to && from <= start && start <= to && (word == 0 || from > 0))
        return PEL_OK;
    pel_scene_fail(reader, &parameter->place, "the start must lie within from .. to%s", word == 1 ? ", above 0" : "");
    pel_fail_remedy(reader->error, "write { start: 2, from: 1, to: 5 }");
    return PEL_BAD_SCENE;
}

static pel_status make_absolute(pel_scene_reader *reader, pel_scene_value *value)
{
    const char *text;
    pel_status status = pel_study_need_text(reader, value, &text);
    if (status != PEL_OK)
        return status;
    const char *path = pel_study_resolve(reader, value->place.source, text);
    status = path != NULL ? pel_file_check(path, reader->error) : PEL_OUT_OF_MEMORY;
    if (status == PEL_BAD_FILE)
        pel_study_fail_file(reader, value);
    if (status != PEL_OK)
        return status;
    value->text = path;
    value->quoted = true;
    return PEL_OK;
}

/* a curve names its columns, markers their body */
static pel_status check_columns(pel_scene_reader *reader, const pel_scene_value *data)
{
    static const char *const columns[] = {"x", "y"};
    const pel_scene_value *value = pel_scene_value_entry(data, "body");
    const char *text;
    if (value != NULL)
        return pel_study_need_text(reader, value, &text);
    pel_status status = PEL_OK;
    for (int i = 0; i < 2 && status == PEL_OK; i++) {
        status = need_entry(reader, data, columns[i], &value);
        if (status == PEL_OK)
            status = pel_study_need_text(reader, value, &text);
    }
    return status;
}

static pel_status check_data(pel_scene_reader *reader, const pel_scene_value *data)
{
    static const char *const numbers[] = {"scale_x", "scale_y", "weight"};
    const pel_scene_value *value;
    double number;
    pel_status status = pel_study_check_keys(reader, data, "data", data_keys, sizeof data_keys / sizeof *data_keys);
    if (status == PEL_OK)
        status = need_entry(reader, data, "file", &value);
    if (status == PEL_OK)
        status = make_absolute(reader, pel_scene_value_entry(data, "file"));
    if (status == PEL_OK)
        status = check_columns(reader, data);
    for (int i = 0; i < 3 && status == PEL_OK; i++)
        if ((value = pel_scene_value_entry(data, numbers[i])) != NULL)
            status = pel_study_need_number(reader, value, &number);
    return status;
}

static pel_status check_lists(pel_scene_reader *reader, const pel_scene_value *root)
{
    const pel_scene_value *parameters, *data;
    pel_status status = need_entry(reader, root, "parameters", &parameters);
    if (status == PEL_OK)
        status = pel_study_check_keys(reader, parameters, "parameters", NULL, 0);
    if (status == PEL_OK)
        status = need_entry(reader, root, "data", &data);
    if (status != PEL_OK)
        return status;
    if (parameters->first == NULL || data->kind != PEL_SCENE_LIST || data->first == NULL) {
        const pel_scene_value *empty = parameters->first == NULL ? parameters : data;
        pel_scene_fail(reader, &empty->place, "a fit needs parameters, and data as a list");
        pel_fail_remedy(reader->error, "write data: [{ file: force.csv, x: probe_z, y: probe_force }]");
        return PEL_BAD_SCENE;
    }
    for (const pel_scene_value *child = parameters->first; child != NULL && status == PEL_OK; child = child->next)
        status = check_parameter(reader, child);
    for (const pel_scene_value *child = data->first; child != NULL && status == PEL_OK; child = child->next)
        status = check_data(reader, child);
    return status;
}

static pel_status check_options(pel_scene_reader *reader, const pel_scene_value *root)
{
    const pel_scene_value *confidence = pel_scene_value_entry(root, "confidence");
    const pel_scene_value *most = pel_scene_value_entry(root, "max_evaluations");
    double share = 0.95;
    int64_t count;
    pel_status status = confidence != NULL ? pel_study_need_number(reader, confidence, &share) : PEL_OK;
    if (status == PEL_OK && !(share > 0 && share < 1)) {
        pel_scene_fail(reader, &confidence->place, "the confidence must be between 0 and 1");
        pel_fail_remedy(reader->error, "write confidence: 0.95");
        return PEL_BAD_SCENE;
    }
    return status == PEL_OK && most != NULL ? pel_study_need_integer(reader, most, 1, 1e6, &count) : status;
}

static pel_status check_fit(pel_scene_reader *reader, const pel_scene_value *root)
{
    const pel_scene_value *scene;
    pel_status status = pel_scene_check_kind(reader, root, "fit");
    if (status == PEL_OK)
        status = pel_study_check_keys(reader, root, "a fit", fit_keys, sizeof fit_keys / sizeof *fit_keys);
    if (status == PEL_OK)
        status = need_entry(reader, root, "scene", &scene);
    if (status == PEL_OK)
        status = make_absolute(reader, pel_scene_value_entry(root, "scene"));
    if (status == PEL_OK)
        status = check_lists(reader, root);
    return status == PEL_OK ? check_options(reader, root) : status;
}

static pel_status parse(const char *path, const char *text, size_t size, char **json, pel_error *error)
{
    pel_arena arena = {0};
    pel_scene_reader reader = {.arena = &arena, .error = error};
    pel_scene_value *root = pel_scene_yaml_parse(&reader, path, text, size, true);
    pel_status status = root != NULL ? check_fit(&reader, root) : error->status;
    if (status == PEL_OK) {
        pel_json made = {0};
        pel_study_put_value(&made, root, put_as_json);
        *json = made.failed ? NULL : pel_copy_string(made.text);
        pel_json_free(&made);
        if (*json == NULL)
            status = pel_fail_memory(error);
    }
    pel_arena_free(&arena);
    return status;
}

pel_status pel_fit_load(const char *path, char **json, pel_error *error)
{
    char *text;
    size_t size;
    pel_error inner = {0};
    PEL_REFUSE_NULL(json, error);
    *json = NULL;
    PEL_REFUSE_NULL(path, error);
    pel_status status = pel_file_read(path, &text, &size, &inner);
    if (status == PEL_OK) {
        status = parse(path, text, size, json, &inner);
        pel_free(text);
    }
    if (status != PEL_OK && error != NULL)
        *error = inner;
    return status;
}

void pel_fit_destroy(char *json)
{
    pel_free(json);
}
