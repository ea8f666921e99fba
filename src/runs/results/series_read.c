#include "pellicle/frames.h"

#include "base/memory.h"
#include "base/number.h"
#include "base/status.h"
#include "io/csv.h"
#include "io/file.h"

#include <math.h>
#include <string.h>

/* bytes of a cell; Pellicle writes no longer name or number */
enum { CELL_SIZE = 512 };

/* which of the names stands over each column, -1 for none, is written to columns (column_count) */
static void find_columns(const char *line, const char *const *names, int32_t name_count, int32_t *columns,
                         size_t column_count)
{
    char cell[CELL_SIZE];
    for (size_t i = 0; i < column_count; ++i) {
        bool is_cell = pel_csv_next(&line, cell, sizeof cell);
        columns[i] = -1;
        for (int32_t k = 0; is_cell && k < name_count; ++k)
            if (strcmp(cell, names[k]) == 0)
                columns[i] = k;
    }
}

static void take_row(const char *line, const int32_t *columns, size_t column_count, const pel_series *series,
                     int64_t row)
{
    char cell[CELL_SIZE];
    for (size_t i = 0; i < column_count && pel_csv_next(&line, cell, sizeof cell); ++i) {
        const char *end = cell + strlen(cell);
        double value;
        if (columns[i] >= 0 && pel_number_parse(cell, end, &value) == end)
            series->values[(int64_t)columns[i] * series->row_count + row] = value;
    }
}

static int64_t count_letters(const char *text, char letter)
{
    int64_t count = 0;
    for (const char *at = strchr(text, letter); at != NULL; at = strchr(at + 1, letter))
        count++;
    return count;
}

static pel_status take_rows(char *text, const char *const *names, pel_series *series, pel_error *error)
{
    char *next = strchr(text, '\n');
    if (next == NULL)
        return PEL_OK;
    *next = '\0';
    size_t column_count = (size_t)count_letters(text, ',') + 1;
    int32_t *columns = pel_allocate(column_count, sizeof *columns);
    series->row_count = count_letters(next + 1, '\n');
    size_t value_count = (size_t)series->column_count * (size_t)series->row_count;
    series->values = pel_allocate(value_count, sizeof *series->values);
    if (columns == NULL || series->values == NULL) {
        pel_free(columns);
        return pel_fail_memory(error);
    }
    for (size_t i = 0; i < value_count; ++i)
        series->values[i] = (double)NAN;
    find_columns(text, names, series->column_count, columns, column_count);
    for (int64_t row = 0; row < series->row_count; ++row) {
        char *line = next + 1;
        next = strchr(line, '\n');
        *next = '\0';
        take_row(line, columns, column_count, series, row);
    }
    pel_free(columns);
    return PEL_OK;
}

pel_status pel_series_read(const char *path, const char *const *names, int32_t name_count, pel_series **series,
                           pel_error *error)
{
    PEL_REFUSE_NULL(path, error);
    PEL_REFUSE_NULL(names, error);
    PEL_REFUSE_NULL(series, error);
    char *text;
    size_t size;
    *series = NULL;
    if (names == NULL || name_count < 1)
        return pel_fail(error, PEL_BAD_ARGUMENT, "names: no column of the series is asked for");
    for (int32_t i = 0; i < name_count; i++)
        if (names[i] == NULL)
            return pel_fail(error, PEL_BAD_ARGUMENT, "names[%d] is null", (int)i);
    pel_status status = pel_file_read(path, &text, &size, error);
    if (status != PEL_OK)
        return status;
    pel_series *made = pel_allocate(1, sizeof *made);
    if (made != NULL)
        made->column_count = name_count;
    status = made != NULL ? take_rows(text, names, made, error) : pel_fail_memory(error);
    pel_free(text);
    if (status == PEL_OK)
        *series = made;
    else
        pel_series_destroy(made);
    return status;
}

void pel_series_destroy(pel_series *series)
{
    if (series == NULL)
        return;
    pel_free(series->values);
    pel_free(series);
}

double pel_series_value(const pel_series *series, int32_t column, int64_t row)
{
    if (series == NULL)
        return (double)NAN;
    if (column < 0 || column >= series->column_count || row < 0 || row >= series->row_count)
        return (double)NAN;
    return series->values[column * series->row_count + row];
}
