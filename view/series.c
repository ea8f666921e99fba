#include "view/series.h"

#include "view/support.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The next cell of a line, without its quotes, written over the line itself; null past the last. */
static char *next_cell(char **at)
{
    if (*at == NULL)
        return NULL;
    char *cell = *at, *to = cell, *from = cell;
    bool quoted = false;
    for (; *from != '\0' && *from != '\r' && *from != '\n' && (quoted || *from != ','); ++from) {
        if (*from == '"' && (!quoted || from[1] != '"'))
            quoted = !quoted;
        else
            *to++ = *from == '"' ? *from++ : *from;
    }
    *at = *from == ',' ? from + 1 : NULL;
    *to = '\0';
    return cell;
}

/* which of the names stands over each column, -1 for none, is written to columns (column_count) */
static void find_columns(char *line, const char *const *names, int32_t name_count, int32_t *columns,
                         size_t column_count)
{
    char *cell;
    for (size_t i = 0; i < column_count; ++i) {
        columns[i] = -1;
        cell = next_cell(&line);
        for (int32_t k = 0; cell != NULL && k < name_count; ++k) {
            if (strcmp(cell, names[k]) == 0)
                columns[i] = k;
        }
    }
}

static void take_row(char *line, const int32_t *columns, size_t column_count, double *row)
{
    for (size_t i = 0; i < column_count; ++i) {
        char *cell = next_cell(&line), *end = cell;
        if (cell == NULL)
            return;
        double value = columns[i] >= 0 ? strtod(cell, &end) : 0;
        if (end != cell && *end == '\0')
            row[columns[i]] = value;
    }
}

/* a whole file with a zero behind it, to be freed */
static pel_status read_text(const char *path, char **text, pel_error *error)
{
    FILE *file = fopen(path, "rb");
    long size = file != NULL && fseek(file, 0, SEEK_END) == 0 ? ftell(file) : -1;
    pel_status status = PEL_OK;
    *text = NULL;
    if (size >= 0 && fseek(file, 0, SEEK_SET) == 0) {
        *text = view_allocate((size_t)size + 1, 1);
        status = *text != NULL ? PEL_OK : pel_fail_memory(error);
    }
    if (status == PEL_OK && (*text == NULL || fread(*text, 1, (size_t)size, file) != (size_t)size)) {
        status = pel_fail(error, PEL_BAD_FILE, "cannot read the file: %s", strerror(errno));
        pel_fail_place(error, path, 0, 0);
        pel_fail_remedy(error, "leave the tools out, or run the scene again");
        free(*text);
        *text = NULL;
    }
    if (file != NULL)
        fclose(file);
    return status;
}

pel_status view_series_read(const char *path, const char *const *names, int32_t name_count, double *values,
                            int32_t row_count, pel_error *error)
{
    for (size_t i = 0; i < (size_t)row_count * (size_t)name_count; ++i)
        values[i] = (double)NAN;
    char *text;
    pel_status status = read_text(path, &text, error);
    if (status != PEL_OK)
        return status;
    char *line = text;
    size_t column_count = 1;
    for (const char *c = text; *c != '\0' && *c != '\n'; ++c)
        column_count += *c == ',';
    int32_t *columns = view_allocate(column_count, sizeof *columns);
    for (int32_t row = -1; columns != NULL && line != NULL && row < row_count; ++row) {
        char *next = strchr(line, '\n');
        if (row < 0)
            find_columns(line, names, name_count, columns, column_count);
        else if (next != NULL)
            take_row(line, columns, column_count, values + (size_t)row * (size_t)name_count);
        line = next != NULL ? next + 1 : NULL;
    }
    bool good = columns != NULL;
    free(columns);
    free(text);
    return good ? PEL_OK : pel_fail_memory(error);
}
