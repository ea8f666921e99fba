#include "study/study.h"

#include "base/number.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static pel_status fail_unknown(pel_scene_reader *reader, const pel_scene_value *entry, const char *what,
                               const char *const *known, size_t known_count)
{
    const char *nearest = pel_nearest_name(entry->key, known, known_count);
    pel_scene_fail(reader, &entry->key_place, "unknown key '%.100s' of %s", entry->key, what);
    if (nearest != NULL) {
        pel_fail_remedy(reader->error, "did you mean '%s'?", nearest);
        return PEL_BAD_SCENE;
    }
    char list[250] = "";
    for (size_t i = 0; i < known_count; i++) {
        size_t length = strlen(list);
        snprintf(list + length, sizeof list - length, "%s%s", i > 0 ? ", " : "", known[i]);
    }
    pel_fail_remedy(reader->error, "known are: %s", list);
    return PEL_BAD_SCENE;
}

static pel_status check_once(pel_scene_reader *reader, const pel_scene_value *entry)
{
    for (const pel_scene_value *other = entry->parent->first; other != entry; other = other->next)
        if (strcmp(other->key, entry->key) == 0) {
            pel_scene_fail(reader, &entry->key_place, "the key '%.100s' is given twice", entry->key);
            pel_fail_remedy(reader->error, "keep one of them");
            return PEL_BAD_SCENE;
        }
    return PEL_OK;
}

pel_status pel_study_need_map(pel_scene_reader *reader, const pel_scene_value *value, const char *what)
{
    if (value->kind == PEL_SCENE_MAP)
        return PEL_OK;
    pel_scene_fail(reader, &value->place, "%s must be a map of keys and values", what);
    pel_fail_remedy(reader->error, "write key: value");
    return PEL_BAD_SCENE;
}

pel_status pel_study_check_keys(pel_scene_reader *reader, const pel_scene_value *map, const char *what,
                                const char *const *known, size_t known_count)
{
    pel_status status = pel_study_need_map(reader, map, what);
    for (const pel_scene_value *entry = status == PEL_OK ? map->first : NULL; entry != NULL && status == PEL_OK;
         entry = entry->next) {
        bool found = known_count == 0;
        for (size_t i = 0; i < known_count && !found; i++)
            found = strcmp(entry->key, known[i]) == 0;
        status = found ? check_once(reader, entry) : fail_unknown(reader, entry, what, known, known_count);
    }
    return status;
}

pel_status pel_study_need_text(pel_scene_reader *reader, const pel_scene_value *value, const char **text)
{
    *text = value->text;
    if (value->kind == PEL_SCENE_SCALAR && value->text[0] != '\0')
        return PEL_OK;
    pel_scene_fail(reader, &value->place, "a text is needed here");
    pel_fail_remedy(reader->error, "write a name");
    return PEL_BAD_SCENE;
}

pel_status pel_study_need_number(pel_scene_reader *reader, const pel_scene_value *value, double *number)
{
    if (value->kind == PEL_SCENE_SCALAR && !value->quoted && pel_scene_parse_number(value->text, number) &&
        isfinite(*number))
        return PEL_OK;
    pel_scene_fail(reader, &value->place, "'%.60s' is not a finite number", value->text);
    pel_fail_remedy(reader->error, "write a number such as 0.5 or 1.5e3");
    return PEL_BAD_SCENE;
}

pel_status pel_study_need_integer(pel_scene_reader *reader, const pel_scene_value *value, double least, double most,
                                  int64_t *number)
{
    double wide;
    if (value->kind == PEL_SCENE_SCALAR && !value->quoted && pel_scene_parse_integer(value->text, &wide) &&
        wide >= least && wide <= most) {
        *number = (int64_t)wide;
        return PEL_OK;
    }
    pel_scene_fail(reader, &value->place, "'%.60s' is not a whole number within %.0f .. %.0f", value->text, least,
                   most);
    pel_fail_remedy(reader->error, "write a whole number in this range");
    return PEL_BAD_SCENE;
}

pel_status pel_study_need_word(pel_scene_reader *reader, const pel_scene_value *value, const char *const *words,
                               size_t count, int32_t *word)
{
    for (size_t i = 0; i < count && value->kind == PEL_SCENE_SCALAR; i++)
        if (strcmp(value->text, words[i]) == 0) {
            *word = (int32_t)i;
            return PEL_OK;
        }
    char list[250] = "";
    for (size_t i = 0; i < count; i++) {
        size_t length = strlen(list);
        snprintf(list + length, sizeof list - length, "%s%s", i > 0 ? ", " : "", words[i]);
    }
    pel_scene_fail(reader, &value->place, "'%.60s' is not one of the choices", value->text);
    pel_fail_remedy(reader->error, "write one of %s", list);
    return PEL_BAD_SCENE;
}

const char *pel_study_resolve(pel_scene_reader *reader, const char *beside, const char *path)
{
    const char *slash = strrchr(beside, '/');
    size_t folder = path[0] == '/' || slash == NULL ? 0 : (size_t)(slash - beside) + 1, length = strlen(path);
    char *joined = pel_arena_take(reader->arena, folder + length + 1, 1);
    if (joined == NULL) {
        pel_fail_memory(reader->error);
        return NULL;
    }
    memcpy(joined, beside, folder);
    memcpy(joined + folder, path, length);
    return joined;
}

void pel_study_fail_file(pel_scene_reader *reader, const pel_scene_value *value)
{
    char why[sizeof reader->error->what];
    memcpy(why, reader->error->what, sizeof why);
    pel_scene_fail(reader, &value->place, "'%.120s': %.150s", value->text, why);
    pel_fail_remedy(reader->error, "write the path of a file, relative to this one");
    reader->error->status = PEL_BAD_FILE;
}

void pel_study_put_value(pel_json *json, const pel_scene_value *value,
                         void (*put_scalar)(pel_json *json, const pel_scene_value *scalar))
{
    if (value->kind == PEL_SCENE_SCALAR) {
        put_scalar(json, value);
        return;
    }
    bool is_list = value->kind == PEL_SCENE_LIST;
    pel_json_print(json, is_list ? "[" : "{");
    for (const pel_scene_value *child = value->first; child != NULL; child = child->next) {
        pel_json_print(json, "%s", child != value->first ? ", " : "");
        if (!is_list) {
            pel_json_put_text(json, child->key);
            pel_json_print(json, ": ");
        }
        pel_study_put_value(json, child, put_scalar);
    }
    pel_json_print(json, is_list ? "]" : "}");
}

/* a text that spreadsheets would compute: it begins like a formula and is no number */
static bool is_formula(const char *text)
{
    double value;
    if (text[0] == '\0' || strchr("=+-@\t\r", text[0]) == NULL)
        return false;
    const char *end = text + strlen(text);
    return pel_number_parse(text, end, &value) != end;
}

void pel_study_put_cell(pel_json *json, const char *text)
{
    const char *mark = is_formula(text) ? "'" : "";
    if (strpbrk(text, ",\"\r\n") == NULL) {
        pel_json_print(json, "%s%s", mark, text);
        return;
    }
    pel_json_print(json, "\"%s", mark);
    while (*text != '\0') {
        int plain = (int)strcspn(text, "\"\r\n");
        pel_json_print(json, "%.*s%s", plain, text, text[plain] == '"' ? "\"\"" : text[plain] != '\0' ? " " : "");
        text += plain + (text[plain] != '\0');
    }
    pel_json_print(json, "\"");
}
