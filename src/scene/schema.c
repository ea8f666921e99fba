/* The table as JSON Schema (draft 7) for editors. Every map becomes one object per alternative, and per word of an
   alternative that brings keys of its own, so that an editor offers exactly the keys that go together. */
#include "scene/schema_api.h"

#include "base/number.h"
#include "scene/value.h"

#include <math.h>
#include <stdarg.h>
#include <string.h>

typedef struct schema_writer {
    FILE *file;
    const pel_scene_table *table;
} schema_writer;

/* one of the objects that a map can be */
typedef struct schema_variant {
    const pel_scene_row *chosen; /* alternative, null when there is none */
    const char *word;            /* its value, null when any */
    bool implied;                /* it may be left out: the default */
} schema_variant;

static void write_value(schema_writer *out, const pel_scene_row *row, const pel_scene_row *limits, const char *word);

static void write_escaped(schema_writer *out, const char *text)
{
    for (; *text != '\0'; text++) {
        if (*text == '"' || *text == '\\')
            fputc('\\', out->file);
        fputc(*text, out->file);
    }
}

static void write_text(schema_writer *out, const char *text)
{
    fputc('"', out->file);
    write_escaped(out, text);
    fputc('"', out->file);
}

static void write_limit(schema_writer *out, const char *key, double limit)
{
    char text[PEL_NUMBER_SIZE];
    if (!isfinite(limit))
        return;
    pel_number_print(text, limit);
    fprintf(out->file, ",\"%s\":%s", key, text);
}

static void write_number(schema_writer *out, pel_scene_form form, pel_scene_range range)
{
    fprintf(out->file, "{\"type\":\"%s\"", form == PEL_FORM_INTEGER ? "integer" : "number");
    if (range.given) {
        write_limit(out, range.open ? "exclusiveMinimum" : "minimum", range.least);
        write_limit(out, "maximum", range.most);
    }
    fputc('}', out->file);
}

static void write_words(schema_writer *out, const char *const *words, const char *only)
{
    if (only != NULL) {
        fputs("{\"const\":", out->file);
        write_text(out, only);
        fputc('}', out->file);
        return;
    }
    fputs("{\"enum\":[", out->file);
    for (size_t i = 0; words[i] != NULL; i++) {
        fputs(i > 0 ? "," : "", out->file);
        write_text(out, words[i]);
    }
    fputs("]}", out->file);
}

static void write_tuple(schema_writer *out, int count, pel_scene_range first, pel_scene_range others)
{
    fprintf(out->file, "{\"type\":\"array\",\"minItems\":%d,\"maxItems\":%d,\"items\":[", count, count);
    for (int i = 0; i < count; i++) {
        fputs(i > 0 ? "," : "", out->file);
        write_number(out, PEL_FORM_NUMBER, i == 0 ? first : others);
    }
    fputs("]}", out->file);
}

static void write_list(schema_writer *out, const pel_scene_row *row, const pel_scene_row *limits)
{
    const pel_scene_row *element = pel_scene_row_find(out->table, row->path, "[]");
    fputs("{\"type\":\"array\",", out->file);
    if (row->range.given)
        fprintf(out->file, "\"minItems\":%d,", (int)row->range.least);
    fputs("\"items\":", out->file);
    write_value(out, element, element->scoped ? limits : element, NULL);
    fputc('}', out->file);
}

/* whether one of the keys that a row needs is an alternative: then the object that has it has the row too */
static bool needs_alternative(const schema_writer *out, const char *prefix, const pel_scene_row *row)
{
    const pel_scene_row *other = NULL;
    while (row->needs != NULL && (other = pel_scene_row_next(out->table, prefix, other)) != NULL)
        if (other->alternative && pel_scene_row_needs(row, pel_scene_row_name(other, prefix)))
            return true;
    return false;
}

static bool belongs(const schema_writer *out, const pel_scene_row *row, const char *prefix,
                    const schema_variant *variant)
{
    if (row->alternative)
        return row == variant->chosen;
    if (!needs_alternative(out, prefix, row))
        return true;
    if (variant->chosen == NULL || !pel_scene_row_needs(row, pel_scene_row_name(variant->chosen, prefix)))
        return false;
    return row->needs_word == NULL || (variant->word != NULL && strcmp(row->needs_word, variant->word) == 0);
}

/* "key": one of those that it needs has to stand beside it */
static void write_dependency(schema_writer *out, const char *prefix, const pel_scene_row *row)
{
    const char *comma = "";
    write_text(out, pel_scene_row_name(row, prefix));
    fputs(":{\"anyOf\":[", out->file);
    for (const pel_scene_row *other = NULL; (other = pel_scene_row_next(out->table, prefix, other)) != NULL;) {
        if (!pel_scene_row_needs(row, pel_scene_row_name(other, prefix)))
            continue;
        fprintf(out->file, "%s{\"required\":[", comma);
        write_text(out, pel_scene_row_name(other, prefix));
        fputs("]}", out->file);
        comma = ",";
    }
    fputs("]}", out->file);
}

static void write_dependencies(schema_writer *out, const char *prefix)
{
    const char *before = ",\"dependencies\":{", *after = "";
    for (const pel_scene_row *row = NULL; (row = pel_scene_row_next(out->table, prefix, row)) != NULL;) {
        if (row->needs == NULL || needs_alternative(out, prefix, row))
            continue;
        fputs(before, out->file);
        write_dependency(out, prefix, row);
        before = ",\n";
        after = "}";
    }
    fputs(after, out->file);
}

/* keys that are required, or another one that fills them in */
static void write_supplied(schema_writer *out, const char *prefix, const schema_variant *variant)
{
    const char *before = ",\"allOf\":[", *after = "";
    for (const pel_scene_row *row = NULL; (row = pel_scene_row_next(out->table, prefix, row)) != NULL;) {
        if (row->supplied == NULL || row->supplied[0] == '\0' || !belongs(out, row, prefix, variant))
            continue;
        fprintf(out->file, "%s{\"anyOf\":[{\"required\":[", before);
        write_text(out, pel_scene_row_name(row, prefix));
        fputs("]},{\"required\":[", out->file);
        write_text(out, row->supplied);
        fputs("]}]}", out->file);
        before = ",";
        after = "]";
    }
    fputs(after, out->file);
}

static void write_object(schema_writer *out, const char *prefix, const pel_scene_row *limits,
                         const schema_variant *variant)
{
    const char *comma = "";
    fputs("{\"type\":\"object\",\"additionalProperties\":false,\"properties\":{", out->file);
    for (const pel_scene_row *row = NULL; (row = pel_scene_row_next(out->table, prefix, row)) != NULL;) {
        if (!belongs(out, row, prefix, variant))
            continue;
        fputs(comma, out->file);
        write_text(out, pel_scene_row_name(row, prefix));
        fputc(':', out->file);
        write_value(out, row, row->scoped ? limits : row, row->alternative ? variant->word : NULL);
        comma = ",\n";
    }
    comma = "";
    fputs("},\"required\":[", out->file);
    for (const pel_scene_row *row = NULL; (row = pel_scene_row_next(out->table, prefix, row)) != NULL;) {
        bool is_needed = (row->required && row->supplied == NULL) || (row->alternative && !variant->implied);
        if (!belongs(out, row, prefix, variant) || !is_needed)
            continue;
        fputs(comma, out->file);
        write_text(out, pel_scene_row_name(row, prefix));
        comma = ",";
    }
    fputs("]", out->file);
    write_supplied(out, prefix, variant);
    write_dependencies(out, prefix);
    fputs("}", out->file);
}

/* whether some key stands only beside this word */
static bool brings_keys(schema_writer *out, const char *prefix, const char *word)
{
    const pel_scene_row *row = NULL;
    while ((row = pel_scene_row_next(out->table, prefix, row)) != NULL)
        if (row->needs_word != NULL && strcmp(row->needs_word, word) == 0)
            return true;
    return false;
}

/* the objects of one alternative */
static void write_alternative(schema_writer *out, const char *prefix, const pel_scene_row *limits,
                              const pel_scene_row *row)
{
    if ((row->forms & PEL_FORM_WORD) == 0 || !brings_keys(out, prefix, row->words[0])) {
        write_object(out, prefix, limits, &(schema_variant){row, NULL, false});
        return;
    }
    for (size_t i = 0; row->words[i] != NULL; i++) {
        fputs(i > 0 ? ",\n" : "", out->file);
        write_object(out, prefix, limits, &(schema_variant){row, row->words[i], false});
    }
}

static void write_map(schema_writer *out, const char *prefix, const pel_scene_row *limits)
{
    bool may_lack = true;
    const char *comma = "";
    schema_variant implied = {NULL, NULL, true};
    fputs("{\"anyOf\":[", out->file);
    for (const pel_scene_row *row = NULL; (row = pel_scene_row_next(out->table, prefix, row)) != NULL;) {
        if (!row->alternative)
            continue;
        /* without any alternative given, the one with a default is taken */
        may_lack = (may_lack && comma[0] != '\0') || row->preset != NULL;
        if (row->preset != NULL)
            implied = (schema_variant){row, (row->forms & PEL_FORM_WORD) != 0 ? row->preset : NULL, true};
        fputs(comma, out->file);
        write_alternative(out, prefix, limits, row);
        comma = ",\n";
    }
    if (may_lack) {
        fputs(comma, out->file);
        write_object(out, prefix, limits, &implied);
    }
    fputs("]}", out->file);
}

/* a default as JSON: numbers, booleans and lists as they are, words in quotes */
static void write_preset(schema_writer *out, const pel_scene_row *row)
{
    double number;
    if (row->preset == NULL || strchr(row->preset, '#') != NULL || row->preset[0] == '{')
        return;
    fputs("\"default\":", out->file);
    if (row->preset[0] == '[' || row->forms == PEL_FORM_BOOLEAN || pel_scene_parse_number(row->preset, &number))
        fputs(row->preset, out->file);
    else
        write_text(out, row->preset);
    fputc(',', out->file);
}

static void write_form(schema_writer *out, pel_scene_form form, const pel_scene_row *row, const pel_scene_row *limits,
                       const char *word)
{
    static const pel_scene_range time = {true, false, 0, (double)HUGE_VAL};
    if (form == PEL_FORM_NUMBER || form == PEL_FORM_INTEGER)
        write_number(out, form, limits->range);
    else if (form == PEL_FORM_BOOLEAN)
        fputs("{\"type\":\"boolean\"}", out->file);
    else if (form == PEL_FORM_WORD)
        write_words(out, row->words, word);
    else if (form == PEL_FORM_TEXT)
        fputs("{\"type\":\"string\",\"minLength\":1}", out->file);
    else if (form == PEL_FORM_PAIR)
        write_tuple(out, 2, limits->range, limits->range);
    else if (form == PEL_FORM_KEY)
        write_tuple(out, 2, time, limits->range);
    else if (form == PEL_FORM_VECTOR)
        write_tuple(out, 3, limits->range, limits->range);
    else if (form == PEL_FORM_LIST)
        write_list(out, row, limits);
    else
        write_map(out, pel_scene_row_prefix(row), limits);
}

static void write_value(schema_writer *out, const pel_scene_row *row, const pel_scene_row *limits, const char *word)
{
    const char *comma = "";
    fputs("{\"description\":\"", out->file);
    write_escaped(out, row->doc);
    if (limits->unit != NULL)
        fprintf(out->file, " [%s]", limits->unit);
    fputs("\",", out->file);
    write_preset(out, row);
    fputs("\"anyOf\":[", out->file);
    for (unsigned form = 1; form <= PEL_FORM_MAP; form *= 2) {
        if ((row->forms & form) == 0)
            continue;
        fputs(comma, out->file);
        write_form(out, (pel_scene_form)form, row, limits, word);
        comma = ",";
    }
    fputs("]}", out->file);
}

void pel_scene_put_schema(FILE *file, const pel_scene_table *table)
{
    schema_writer out = {file, table};
    fputs("{\"$schema\":\"http://json-schema.org/draft-07/schema#\",\"title\":\"scene of pellicle\",\"allOf\":[\n",
          file);
    write_object(&out, "", NULL, &(schema_variant){NULL, NULL, false});
    fputs("\n]}\n", file);
}
