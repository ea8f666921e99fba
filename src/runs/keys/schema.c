/* The table as JSON Schema (draft 7) for editors. Every map becomes one object per alternative, and per word of an
   alternative that has its own keys, so that an editor offers exactly the keys that go together. */
#include "keys/schema_api.h"

#include "keys/value.h"

#include <math.h>
#include <string.h>

typedef struct schema_writer {
    pel_json *json;
    const pel_scene_table *table;
} schema_writer;

/* one of the objects that a map can be */
typedef struct schema_variant {
    const pel_def_row *chosen; /* alternative, null if there is none */
    const char *word;          /* its value, null when any */
    bool implied;              /* optional: the default */
} schema_variant;

static void write_value(schema_writer *out, const pel_def_row *row, const pel_def_row *limits, const char *word);

static void emit(const schema_writer *out, const char *text)
{
    pel_json_print(out->json, "%s", text);
}

static void write_text(const schema_writer *out, const char *text)
{
    pel_json_put_text(out->json, text);
}

static void write_limit(schema_writer *out, const char *key, double limit)
{
    if (!isfinite(limit))
        return;
    pel_json_print(out->json, ",\"%s\":", key);
    pel_json_put_number(out->json, limit);
}

static void write_number(schema_writer *out, pel_form form, pel_range range)
{
    pel_json_print(out->json, "{\"type\":\"%s\"", form == PEL_FORM_INTEGER ? "integer" : "number");
    if (range.given) {
        write_limit(out, range.open ? "exclusiveMinimum" : "minimum", range.least);
        write_limit(out, "maximum", range.most);
    }
    emit(out, "}");
}

static void write_words(schema_writer *out, const char *const *words, const char *only)
{
    if (only != NULL) {
        emit(out, "{\"const\":");
        write_text(out, only);
        emit(out, "}");
        return;
    }
    emit(out, "{\"enum\":[");
    for (size_t i = 0; words[i] != NULL; i++) {
        emit(out, i > 0 ? "," : "");
        write_text(out, words[i]);
    }
    emit(out, "]}");
}

static void write_tuple(schema_writer *out, int count, pel_range first, pel_range others)
{
    pel_json_print(out->json, "{\"type\":\"array\",\"minItems\":%d,\"maxItems\":%d,\"items\":[", count, count);
    for (int i = 0; i < count; i++) {
        emit(out, i > 0 ? "," : "");
        write_number(out, PEL_FORM_NUMBER, i == 0 ? first : others);
    }
    emit(out, "]}");
}

static void write_list(schema_writer *out, const pel_def_row *row, const pel_def_row *limits)
{
    const pel_def_row *element = pel_scene_row_find(out->table, row->path, "[]");
    emit(out, "{\"type\":\"array\",");
    if (row->range.given)
        pel_json_print(out->json, "\"minItems\":%d,", (int)row->range.least);
    emit(out, "\"items\":");
    write_value(out, element, element->scoped ? limits : element, NULL);
    emit(out, "}");
}

/* whether one of the keys that a row needs is an alternative: then the object that has it has the row too */
static bool needs_alternative(const schema_writer *out, const char *prefix, const pel_def_row *row)
{
    const pel_def_row *other = NULL;
    while (row->needs != NULL && (other = pel_scene_row_next(out->table, prefix, other)) != NULL)
        if (other->alternative && pel_scene_row_needs(row, pel_scene_row_name(other, prefix)))
            return true;
    return false;
}

static bool belongs(const schema_writer *out, const pel_def_row *row, const char *prefix, const schema_variant *variant)
{
    if (row->alternative)
        return row == variant->chosen;
    if (!needs_alternative(out, prefix, row))
        return true;
    if (variant->chosen == NULL || !pel_scene_row_needs(row, pel_scene_row_name(variant->chosen, prefix)))
        return false;
    return row->needs_word == NULL || (variant->word != NULL && strcmp(row->needs_word, variant->word) == 0);
}

/* the next row of the object with the same key, for another word of the key that both need */
static const pel_def_row *next_of_key(const schema_writer *out, const char *prefix, const pel_def_row *row,
                                      const schema_variant *variant)
{
    const pel_def_row *other = row;
    while ((other = pel_scene_row_next(out->table, prefix, other)) != NULL)
        if (strcmp(other->path, row->path) == 0 && belongs(out, other, prefix, variant))
            return other;
    return NULL;
}

static bool is_first_of_key(const schema_writer *out, const char *prefix, const pel_def_row *row,
                            const schema_variant *variant)
{
    const pel_def_row *other = NULL;
    while ((other = pel_scene_row_next(out->table, prefix, other)) != row)
        if (strcmp(other->path, row->path) == 0 && belongs(out, other, prefix, variant))
            return false;
    return true;
}

/* whether an object has to have the key, whatever its others are */
static bool is_needed(const schema_writer *out, const char *prefix, const pel_def_row *row,
                      const schema_variant *variant)
{
    if (row->alternative)
        return !variant->implied;
    return row->required && row->supplied == NULL && (row->needs_word == NULL || needs_alternative(out, prefix, row));
}

/* "key": requires one of the keys that it depends on */
static void write_dependency(schema_writer *out, const char *prefix, const pel_def_row *row)
{
    const char *comma = "";
    write_text(out, pel_scene_row_name(row, prefix));
    emit(out, ":{\"anyOf\":[");
    for (const pel_def_row *other = NULL; (other = pel_scene_row_next(out->table, prefix, other)) != NULL;) {
        if (!pel_scene_row_needs(row, pel_scene_row_name(other, prefix)))
            continue;
        pel_json_print(out->json, "%s{\"required\":[", comma);
        write_text(out, pel_scene_row_name(other, prefix));
        emit(out, "]}");
        comma = ",";
    }
    emit(out, "]}");
}

static void write_dependencies(schema_writer *out, const char *prefix)
{
    const char *before = ",\"dependencies\":{", *after = "";
    for (const pel_def_row *row = NULL; (row = pel_scene_row_next(out->table, prefix, row)) != NULL;) {
        if (row->needs == NULL || needs_alternative(out, prefix, row))
            continue;
        emit(out, before);
        write_dependency(out, prefix, row);
        before = ",\n";
        after = "}";
    }
    emit(out, after);
}

/* keys that are required, or another one that fills them in */
static void write_supplied(schema_writer *out, const char *prefix, const schema_variant *variant)
{
    const char *before = ",\"allOf\":[", *after = "";
    for (const pel_def_row *row = NULL; (row = pel_scene_row_next(out->table, prefix, row)) != NULL;) {
        if (row->supplied == NULL || row->supplied[0] == '\0' || !belongs(out, row, prefix, variant))
            continue;
        pel_json_print(out->json, "%s{\"anyOf\":[{\"required\":[", before);
        write_text(out, pel_scene_row_name(row, prefix));
        emit(out, "]},{\"required\":[");
        write_text(out, row->supplied);
        emit(out, "]}]}");
        before = ",";
        after = "]";
    }
    emit(out, after);
}

/* the value of a key, by each of its rows */
static void write_key(schema_writer *out, const char *prefix, const pel_def_row *row, const pel_def_row *limits,
                      const schema_variant *variant)
{
    const bool is_many = next_of_key(out, prefix, row, variant) != NULL;
    const char *before = is_many ? "{\"anyOf\":[" : "";
    for (; row != NULL; row = next_of_key(out, prefix, row, variant)) {
        emit(out, before);
        write_value(out, row, row->scoped ? limits : row, row->alternative ? variant->word : NULL);
        before = ",";
    }
    emit(out, is_many ? "]}" : "");
}

static void write_object(schema_writer *out, const char *prefix, const pel_def_row *limits,
                         const schema_variant *variant)
{
    const char *comma = "";
    emit(out, "{\"type\":\"object\",\"additionalProperties\":false,\"properties\":{");
    for (const pel_def_row *row = NULL; (row = pel_scene_row_next(out->table, prefix, row)) != NULL;) {
        if (!belongs(out, row, prefix, variant) || !is_first_of_key(out, prefix, row, variant))
            continue;
        emit(out, comma);
        write_text(out, pel_scene_row_name(row, prefix));
        emit(out, ":");
        write_key(out, prefix, row, limits, variant);
        comma = ",\n";
    }
    comma = "";
    emit(out, "},\"required\":[");
    for (const pel_def_row *row = NULL; (row = pel_scene_row_next(out->table, prefix, row)) != NULL;) {
        if (!belongs(out, row, prefix, variant) || !is_needed(out, prefix, row, variant))
            continue;
        emit(out, comma);
        write_text(out, pel_scene_row_name(row, prefix));
        comma = ",";
    }
    emit(out, "]");
    write_supplied(out, prefix, variant);
    write_dependencies(out, prefix);
    emit(out, "}");
}

/* whether some key is allowed only with this word */
static bool brings_keys(schema_writer *out, const char *prefix, const char *word)
{
    const pel_def_row *row = NULL;
    while ((row = pel_scene_row_next(out->table, prefix, row)) != NULL)
        if (row->needs_word != NULL && strcmp(row->needs_word, word) == 0)
            return true;
    return false;
}

/* the objects of one alternative */
static void write_alternative(schema_writer *out, const char *prefix, const pel_def_row *limits, const pel_def_row *row)
{
    if ((row->forms & PEL_FORM_WORD) == 0 || !brings_keys(out, prefix, row->words[0])) {
        write_object(out, prefix, limits, &(schema_variant){row, NULL, false});
        return;
    }
    for (size_t i = 0; row->words[i] != NULL; i++) {
        emit(out, i > 0 ? ",\n" : "");
        write_object(out, prefix, limits, &(schema_variant){row, row->words[i], false});
    }
}

static void write_map(schema_writer *out, const char *prefix, const pel_def_row *limits)
{
    bool may_lack = true;
    const char *comma = "";
    schema_variant implied = {NULL, NULL, true};
    emit(out, "{\"anyOf\":[");
    for (const pel_def_row *row = NULL; (row = pel_scene_row_next(out->table, prefix, row)) != NULL;) {
        if (!row->alternative)
            continue;
        /* without any alternative given, the one with a default is taken */
        may_lack = (may_lack && comma[0] != '\0') || row->preset != NULL;
        if (row->preset != NULL)
            implied = (schema_variant){row, (row->forms & PEL_FORM_WORD) != 0 ? row->preset : NULL, true};
        emit(out, comma);
        write_alternative(out, prefix, limits, row);
        comma = ",\n";
    }
    if (may_lack) {
        emit(out, comma);
        write_object(out, prefix, limits, &implied);
    }
    emit(out, "]}");
}

/* Whether the entries of a map are a group that stands once, under `definitions`: one whose units and ranges are its
 * own. */
static bool is_defined(const pel_scene_table *table, const pel_def_row *row)
{
    const pel_def_row *child = NULL;
    while (row->like != NULL && (child = pel_scene_row_next(table, row->like, child)) != NULL)
        if (child->scoped)
            return false;
    return row->like != NULL;
}

/* a default as JSON: numbers, booleans and lists as they are, words in quotes */
static void write_preset(schema_writer *out, const pel_def_row *row)
{
    double number;
    if (row->preset == NULL || row->varies || strchr(row->preset, '#') != NULL || row->preset[0] == '{')
        return;
    emit(out, "\"default\":");
    if (row->preset[0] == '[' || row->forms == PEL_FORM_BOOLEAN || pel_scene_parse_number(row->preset, &number))
        emit(out, row->preset);
    else
        write_text(out, row->preset);
    emit(out, ",");
}

static void write_form(schema_writer *out, pel_form form, const pel_def_row *row, const pel_def_row *limits,
                       const char *word)
{
    static const pel_range time = {true, false, 0, (double)HUGE_VAL};
    if (form == PEL_FORM_NUMBER || form == PEL_FORM_INTEGER)
        write_number(out, form, limits->range);
    else if (form == PEL_FORM_BOOLEAN)
        emit(out, "{\"type\":\"boolean\"}");
    else if (form == PEL_FORM_WORD)
        write_words(out, row->words, word);
    else if (form == PEL_FORM_TEXT)
        emit(out, "{\"type\":\"string\",\"minLength\":1}");
    else if (form == PEL_FORM_PAIR)
        write_tuple(out, 2, limits->range, limits->range);
    else if (form == PEL_FORM_KEY)
        write_tuple(out, 2, time, limits->range);
    else if (form == PEL_FORM_VECTOR)
        write_tuple(out, 3, limits->range, limits->range);
    else if (form == PEL_FORM_LIST)
        write_list(out, row, limits);
    else if (is_defined(out->table, row))
        pel_json_print(out->json, "{\"$ref\":\"#/definitions/%.*s\"}", (int)strlen(row->like) - 2, row->like + 1);
    else
        write_map(out, pel_scene_row_prefix(row), limits);
}

static void write_description(const schema_writer *out, const char *doc, const char *unit)
{
    pel_json text = {0};
    pel_json_print(&text, "%s", doc);
    if (unit != NULL)
        pel_json_print(&text, " [%s]", unit);
    if (!text.failed)
        write_text(out, text.text);
    out->json->failed |= text.failed;
    pel_json_free(&text);
}

static void write_value(schema_writer *out, const pel_def_row *row, const pel_def_row *limits, const char *word)
{
    const char *comma = "";
    emit(out, "{\"description\":");
    write_description(out, row->doc, limits->unit);
    emit(out, ",");
    write_preset(out, row);
    emit(out, "\"anyOf\":[");
    for (unsigned form = 1; form <= PEL_FORM_MAP; form *= 2) {
        if ((row->forms & form) == 0)
            continue;
        emit(out, comma);
        write_form(out, (pel_form)form, row, limits, word);
        comma = ",";
    }
    emit(out, "]}");
}

static void write_definitions(schema_writer *out)
{
    const char *comma = "\n";
    for (size_t i = 0; i < out->table->row_count; i++) {
        const pel_def_row *row = &out->table->rows[i];
        const pel_def_row group = {.like = row->path};
        if (row->path[0] != '<' || strchr(row->path, '.') != NULL || !is_defined(out->table, &group))
            continue;
        pel_json_print(out->json, "%s\"%.*s\":", comma, (int)strlen(row->path) - 2, row->path + 1);
        write_map(out, row->path, row);
        comma = ",\n";
    }
}

void pel_scene_put_schema(pel_json *json, const pel_scene_table *table)
{
    schema_writer out = {json, table};
    emit(&out,
         "{\"$schema\":\"http://json-schema.org/draft-07/schema#\",\"title\":\"scene of pellicle\",\"allOf\":[\n");
    write_object(&out, "", NULL, &(schema_variant){NULL, NULL, false});
    emit(&out, "\n],\"definitions\":{");
    write_definitions(&out);
    emit(&out, "\n}}\n");
}
