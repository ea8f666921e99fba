/* The table as the reference page of scenes (Markdown) and as the list of parameter paths. */
#include "keys/schema_api.h"
#include "observe/field.h"

#include <string.h>

/* a path without the < > of groups */
static void write_path(FILE *file, const char *path)
{
    for (; *path != '\0'; path++)
        if (*path != '<' && *path != '>')
            fputc(*path, file);
}

/* "`a`, `b`" */
static void write_words(FILE *file, const char *const *words)
{
    for (size_t i = 0; words[i] != NULL; i++)
        fprintf(file, "%s`%s`", i > 0 ? ", " : "", words[i]);
}

/* "number or `auto`", "list of text", "number or [quantity](#quantity)" */
static void write_type(FILE *file, const pel_scene_table *table, const pel_def_row *row)
{
    char text[200];
    pel_def_row plain = *row;
    bool one_or_more = row->like != NULL && (row->forms & PEL_FORM_LIST) != 0;
    plain.forms &= ~(unsigned)PEL_FORM_WORD;
    if (row->like != NULL)
        plain.forms &= ~(unsigned)(PEL_FORM_MAP | (one_or_more ? PEL_FORM_LIST : 0));
    fputs(pel_scene_form_text(&plain, text, sizeof text), file);
    if (plain.forms != row->forms && text[0] != '\0')
        fputs(" or ", file);
    if ((row->forms & PEL_FORM_WORD) != 0)
        write_words(file, row->words);
    if (row->like != NULL) {
        int length = (int)strlen(row->like) - 2;
        fprintf(file, "%s[%.*s](#%.*s)", (row->forms & PEL_FORM_WORD) != 0 ? " or " : "", length, row->like + 1, length,
                row->like + 1);
    }
    if (one_or_more)
        fputs(" or list of them", file);
    else if ((row->forms & PEL_FORM_LIST) != 0)
        fprintf(file, " of %s", pel_scene_form_text(pel_scene_row_find(table, row->path, "[]"), text, sizeof text));
}

/* whether a map has another alternative than this one */
static bool has_other_alternative(const pel_scene_table *table, const char *prefix, const pel_def_row *row)
{
    const pel_def_row *other = NULL;
    while ((other = pel_scene_row_next(table, prefix, other)) != NULL)
        if (other->alternative && other != row)
            return true;
    return false;
}

static void write_default(FILE *file, const pel_scene_table *table, const pel_def_row *row, const char *prefix)
{
    if (row->varies)
        fputs("by the scene", file);
    else if (row->preset != NULL)
        fprintf(file, "`%s`", row->preset);
    else if (row->alternative && has_other_alternative(table, prefix, row))
        fputs("one of these", file);
    else if (row->alternative || row->required)
        fputs("required", file);
    if (row->needs != NULL && row->needs_word == NULL)
        fprintf(file, "%swith %s", row->preset != NULL || row->required ? ", " : "", row->needs);
}

static void write_row(FILE *file, const pel_scene_table *table, const pel_def_row *row, const char *prefix)
{
    char range[80];
    fprintf(file, "| `%s` | ", pel_scene_row_name(row, prefix));
    write_type(file, table, row);
    fprintf(file, " | %s | %s | ", row->unit != NULL ? row->unit : "", pel_range_text(row->range, range, sizeof range));
    write_default(file, table, row, prefix);
    fprintf(file, " | %s |\n", row->doc);
}

/* the table of the rows below a prefix that go with a word (null: with any) */
static void write_rows(FILE *file, const pel_scene_table *table, const char *prefix, const char *word)
{
    bool started = false;
    for (const pel_def_row *row = NULL; (row = pel_scene_row_next(table, prefix, row)) != NULL;) {
        bool fits =
            word == NULL ? row->needs_word == NULL : row->needs_word != NULL && strcmp(word, row->needs_word) == 0;
        if (!fits)
            continue;
        if (!started && word != NULL)
            fprintf(file, "\nWith `%s: %s`:\n", row->needs, word);
        if (!started)
            fputs("\n| key | value | unit | range | default | meaning |\n|---|---|---|---|---|---|\n", file);
        started = true;
        write_row(file, table, row, prefix);
    }
}

static void write_section(FILE *file, const pel_scene_table *table, const pel_def_row *row)
{
    const char *prefix = pel_scene_row_prefix(row);
    if (row != NULL) {
        fputs(row->path[0] == '<' ? "\n## " : "\n## `", file);
        write_path(file, row->path);
        fprintf(file, "%s\n\n%s.\n", row->path[0] == '<' ? "" : "`", row->doc);
    }
    write_rows(file, table, prefix, NULL);
    /* then the keys that go with one word of an alternative */
    const char *word = NULL;
    for (const pel_def_row *child = NULL; (child = pel_scene_row_next(table, prefix, child)) != NULL;) {
        if (child->needs_word == NULL || (word != NULL && strcmp(word, child->needs_word) == 0))
            continue;
        word = child->needs_word;
        write_rows(file, table, prefix, word);
    }
}

static void write_fields(FILE *file)
{
    fputs("\n## fields\n\n`output.fields` may name these fields and the fields of the meshes. If a field of a mesh has "
          "the same name, the field of this list is used.\n[Measures](../measures.md) defines the fields from `area` "
          "on.\n\n| field | numbers | unit | meaning |\n|---|---|---|---|\n",
          file);
    for (int32_t f = 0; f < PEL_FIELD_COUNT; f++) {
        const pel_field_info *field = pel_field_at(f);
        fprintf(file, "| `%s` | %d | %s | %s |\n", field->name, (int)field->component_count, field->unit, field->doc);
    }
}

void pel_scene_put_reference(FILE *file, const pel_scene_table *table)
{
    fputs("# Scene files\n\nA scene is a YAML 1.2 (or JSON) file. Units are SI. A key that is omitted, or has no "
          "value, has its\ndefault; `by the scene` means that the default depends on other keys. `--set "
          "bodies.0.springs.stiffness=5` on the command line sets any\nof these keys; elements of lists are addressed "
          "by number from 0 or by name.\n",
          file);
    write_section(file, table, NULL);
    for (size_t i = 0; i < table->row_count; i++)
        if ((table->rows[i].forms & PEL_FORM_MAP) != 0 && table->rows[i].like == NULL)
            write_section(file, table, &table->rows[i]);
    write_fields(file);
}

/* path: of the parent as in --set, with the number 0 for list elements */
static void write_paths(FILE *file, const pel_scene_table *table, const char *prefix, const char *path)
{
    for (const pel_def_row *row = NULL; (row = pel_scene_row_next(table, prefix, row)) != NULL;) {
        char child_path[200];
        const char *name = pel_scene_row_name(row, prefix);
        if (pel_scene_row_find(table, prefix, name) != row)
            continue;
        snprintf(child_path, sizeof child_path, "%s%s%s", path, path[0] != '\0' ? "." : "",
                 strcmp(name, "[]") == 0 ? "0" : name);
        if ((row->forms & ~(unsigned)(PEL_FORM_MAP | PEL_FORM_LIST)) != 0)
            fprintf(file, "%s\n", child_path);
        /* a group that contains itself, as regions do, is listed once */
        if (row->like != NULL && strncmp(row->path, row->like, strlen(row->like)) == 0)
            continue;
        write_paths(file, table, pel_scene_row_prefix(row), child_path);
    }
}

void pel_scene_put_parameters(FILE *file, const pel_scene_table *table)
{
    write_paths(file, table, "", "");
}
