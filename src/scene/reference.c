/* The table as the reference page of scenes (Markdown) and as the list of parameter paths. */
#include "scene/documents.h"

#include <string.h>

/* group of a path in < > as a word for readers */
static void write_group(FILE *file, const char *group)
{
    fprintf(file, "[%.*s](#%.*s)", (int)strlen(group) - 2, group + 1, (int)strlen(group) - 2, group + 1);
}

/* "number or `auto`, [region](#region)" */
static void write_type(FILE *file, const pel_scene_row *row)
{
    char text[200];
    pel_scene_row named = *row;
    if (row->like != NULL)
        named.forms &= ~(unsigned)PEL_FORM_MAP;
    pel_scene_form_text(&named, text, sizeof text);
    fputs(text, file);
    if (row->like == NULL)
        return;
    fputs(text[0] != '\0' ? " or " : "", file);
    write_group(file, row->like);
}

static void write_row(FILE *file, const pel_scene_row *row, const char *prefix)
{
    char range[80];
    fprintf(file, "| `%s` | ", pel_scene_row_name(row, prefix));
    write_type(file, row);
    fprintf(file, " | %s | %s | ", row->unit != NULL ? row->unit : "",
            pel_scene_range_text(row->range, range, sizeof range));
    if (row->preset != NULL)
        fprintf(file, "`%s`", row->preset);
    else
        fputs(row->required ? "required" : row->alternative ? "one of these" : "", file);
    fprintf(file, " | %s", row->doc);
    if (row->needs != NULL && row->needs_word == NULL)
        fprintf(file, " (with `%s`)", row->needs);
    fputs(" |\n", file);
}

/* the table of the rows below a prefix that stand beside a word (null: beside any) */
static void write_rows(FILE *file, const pel_scene_table *table, const char *prefix, const char *word)
{
    bool started = false;
    for (const pel_scene_row *row = NULL; (row = pel_scene_row_next(table, prefix, row)) != NULL;) {
        bool fits =
            word == NULL ? row->needs_word == NULL : row->needs_word != NULL && strcmp(word, row->needs_word) == 0;
        if (!fits)
            continue;
        if (!started && word != NULL)
            fprintf(file, "\nWith `%s: %s`:\n", row->needs, word);
        if (!started)
            fputs("\n| key | value | unit | range | default | meaning |\n|---|---|---|---|---|---|\n", file);
        started = true;
        write_row(file, row, prefix);
    }
}

static void write_section(FILE *file, const pel_scene_table *table, const pel_scene_row *row)
{
    const char *prefix = pel_scene_row_prefix(row);
    if (row != NULL && row->path[0] == '<')
        fprintf(file, "\n## %.*s\n", (int)strlen(row->path) - 2, row->path + 1);
    else if (row != NULL)
        fprintf(file, "\n## `%s`\n", row->path);
    if (row != NULL)
        fprintf(file, "\n%s.\n", row->doc);
    write_rows(file, table, prefix, NULL);
    /* then the keys that go with one word of an alternative */
    const char *word = NULL;
    for (const pel_scene_row *child = NULL; (child = pel_scene_row_next(table, prefix, child)) != NULL;) {
        if (child->needs_word == NULL || (word != NULL && strcmp(word, child->needs_word) == 0))
            continue;
        word = child->needs_word;
        write_rows(file, table, prefix, word);
    }
}

void pel_scene_put_reference(FILE *file, const pel_scene_table *table)
{
    fputs("# Scene files\n\n"
          "A scene is a YAML 1.2 (or JSON) file. Units are SI. A key that is left out, or has no value, takes its\n"
          "default. `--set bodies.0.springs.stiffness=5` on the command line sets any of these keys; elements of\n"
          "lists go by number from 0 or by name.\n",
          file);
    write_section(file, table, NULL);
    for (size_t i = 0; i < table->row_count; i++)
        if ((table->rows[i].forms & PEL_FORM_MAP) != 0 && table->rows[i].like == NULL)
            write_section(file, table, &table->rows[i]);
}

/* path: that of the parent as --set takes it, with the number 0 for list elements */
static void write_paths(FILE *file, const pel_scene_table *table, const char *prefix, const char *path)
{
    for (const pel_scene_row *row = NULL; (row = pel_scene_row_next(table, prefix, row)) != NULL;) {
        char child_path[200];
        const char *name = pel_scene_row_name(row, prefix);
        if (pel_scene_row_find(table, prefix, name) != row)
            continue;
        snprintf(child_path, sizeof child_path, "%s%s%s", path, path[0] != '\0' ? "." : "",
                 strcmp(name, "[]") == 0 ? "0" : name);
        if ((row->forms & ~(unsigned)(PEL_FORM_MAP | PEL_FORM_LIST)) != 0)
            fprintf(file, "%s\n", child_path);
        write_paths(file, table, pel_scene_row_prefix(row), child_path);
    }
}

void pel_scene_put_parameters(FILE *file, const pel_scene_table *table)
{
    write_paths(file, table, "", "");
}
