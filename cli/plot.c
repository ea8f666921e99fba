/* Columns of a run's series.csv as a plot or a table. */
#include "commands.h"
#include "diagnostics.h"

#include "papers/lab/file.h"
#include "papers/lab/plot.h"

#include <pellicle/error.h>
#include <pellicle/frames.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_COLUMNS = 1024, PATH_SIZE = 4352, NAME_SIZE = 224 };

/* the header of a series: its names point into the line */
typedef struct header {
    char *line;
    const char *names[MOST_COLUMNS];
    int count;
} header;

/* what is plotted: the first column against the others */
typedef struct chosen {
    const char *names[LAB_CURVES + 1];
    int count;
    const pel_series *series;
    bool log_x, log_y;
} chosen;

/* The next cell of a line, without the quotes about it and with one for two within, in its place; *rest is null behind
   the last one. */
static char *take_cell(char **rest)
{
    char *from = *rest, *to = from, *cell = from;
    bool is_quoted = *from == '"';
    for (from += is_quoted; *from != '\0' && *from != '\r' && *from != '\n' && (is_quoted || *from != ','); from++) {
        if (is_quoted && *from == '"' && *++from != '"') {
            is_quoted = false;
            from--;
            continue;
        }
        *to++ = *from;
    }
    *rest = *from == ',' ? from + 1 : NULL;
    *to = '\0';
    return cell;
}

static bool read_header(const char *path, header *head)
{
    FILE *file = fopen(path, "r");
    size_t size = 0;
    ssize_t length = file != NULL ? getline(&head->line, &size, file) : -1;
    if (file != NULL)
        fclose(file);
    if (length <= 0)
        return false;
    for (char *rest = head->line; rest != NULL && head->count < MOST_COLUMNS;)
        head->names[head->count++] = take_cell(&rest);
    return head->count > 0;
}

/* the columns of the command line: one alone is plotted over time */
static bool choose(const cli_call *call, const header *head, chosen *plot)
{
    if (call->argument_count == 2)
        plot->names[plot->count++] = "time";
    if (plot->count + call->argument_count - 1 > LAB_CURVES + 1) {
        cli_complain("a plot has at most %d curves. leave columns out", LAB_CURVES);
        return false;
    }
    for (int i = 1; i < call->argument_count; i++)
        plot->names[plot->count++] = call->arguments[i];
    for (int i = 0; i < plot->count; i++) {
        int found = 0;
        while (found < head->count && strcmp(head->names[found], plot->names[i]) != 0)
            found++;
        if (found < head->count)
            continue;
        const char *nearest = pel_nearest_name(plot->names[i], head->names, (size_t)head->count);
        if (nearest != NULL)
            cli_complain("series.csv has no column '%s'. did you mean '%s'?", plot->names[i], nearest);
        else
            cli_complain("series.csv has no column '%s'. its columns are listed by pellicle plot %s", plot->names[i],
                         call->arguments[0]);
        return false;
    }
    return true;
}

static int list_columns(const header *head)
{
    for (int i = 0; i < head->count; i++)
        printf("%s\n", head->names[i]);
    return CLI_DONE;
}

static bool ends_in(const char *text, const char *end)
{
    const size_t length = strlen(text), size = strlen(end);
    return length > size && strcmp(text + length - size, end) == 0;
}

/* the unit of a column by its name, empty if it has none */
static const char *unit_of(const char *name)
{
    static const struct {
        const char *ending, *unit;
    } units[] = {
        {"angular_momentum_x", "N m s"},
        {"angular_momentum_y", "N m s"},
        {"angular_momentum_z", "N m s"},
        {"momentum_x", "N s"},
        {"momentum_y", "N s"},
        {"momentum_z", "N s"},
        {"torque_x", "N m"},
        {"torque_y", "N m"},
        {"torque_z", "N m"},
        {"rotation_x", ""},
        {"rotation_y", ""},
        {"rotation_z", ""},
        {"force", "N"},
        {"force_max", "N"},
        {"force_x", "N"},
        {"force_y", "N"},
        {"force_z", "N"},
        {"_x", "m"},
        {"_y", "m"},
        {"_z", "m"},
        {"displacement", "m"},
        {"volume", "m³"},
        {"energy", "J"},
        {"energy_error", "J"},
        {"time", "s"},
        {"_ms", "ms"},
        {"frequency", "Hz"},
        {"pressure", "Pa"},
    };
    for (size_t i = 0; i < sizeof units / sizeof units[0]; i++)
        if (strcmp(name, units[i].ending) == 0 || ends_in(name, units[i].ending))
            return units[i].unit;
    return strncmp(name, "work_", 5) == 0 || strncmp(name, "dissipated_", 11) == 0 ? "J" : "";
}

/* "ball_force_z [N]" */
static const char *write_name(const char *column, char text[NAME_SIZE])
{
    const char *unit = unit_of(column);
    snprintf(text, NAME_SIZE, unit[0] != '\0' ? "%.200s [%s]" : "%.200s", column, unit);
    return text;
}

/* the points of a curve that can be drawn; returns their number */
static int take_points(const chosen *plot, int column, double *x, double *y)
{
    int count = 0;
    for (int64_t row = 0; row < plot->series->row_count; row++) {
        x[count] = pel_series_value(plot->series, 0, row);
        y[count] = pel_series_value(plot->series, column, row);
        count += isfinite(x[count]) && isfinite(y[count]) && (!plot->log_x || x[count] > 0) &&
                 (!plot->log_y || y[count] > 0);
    }
    return count;
}

static pel_status write_picture(const chosen *plot, const char *title, const char *path, pel_error *error)
{
    const size_t rows = (size_t)plot->series->row_count + 1;
    double *numbers = calloc(2 * rows * (size_t)plot->count, sizeof *numbers);
    if (numbers == NULL)
        return pel_fail_memory(error);
    /* one curve is named beside its axis, several in the legend */
    const bool single = plot->count == 2;
    char names[LAB_CURVES + 1][NAME_SIZE];
    lab_plot picture = {.title = title,
                        .x_name = write_name(plot->names[0], names[0]),
                        .y_name = single ? write_name(plot->names[1], names[1]) : "",
                        .log_x = plot->log_x,
                        .log_y = plot->log_y};
    for (int c = 1; c < plot->count; c++) {
        double *x = numbers + 2 * (size_t)c * rows, *y = x + rows;
        int count = take_points(plot, c, x, y);
        if (count > 0)
            picture.curves[picture.curve_count++] =
                (lab_curve){.name = single ? "" : write_name(plot->names[c], names[c]), .x = x, .y = y, .count = count};
    }
    pel_status status = PEL_BAD_ARGUMENT;
    if (picture.curve_count > 0) {
        status = (ends_in(path, ".png") ? lab_draw_plot : lab_write_plot)(path, &picture, error);
    } else {
        pel_fail(error, status, "the columns have no number to draw");
        pel_fail_remedy(error, "%s",
                        plot->log_x || plot->log_y ? "leave out --log-x and --log-y, which need values above 0"
                                                   : "choose other columns");
    }
    free(numbers);
    return status;
}

/* a cell, in quotes where it has a character that separates cells */
static void put_cell(FILE *file, const char *text)
{
    bool is_quoted = strpbrk(text, ",\"") != NULL;
    fputs(is_quoted ? "\"" : "", file);
    for (; *text != '\0'; text++)
        fprintf(file, "%s%c", *text == '"' ? "\"" : "", *text);
    fputs(is_quoted ? "\"" : "", file);
}

static void write_table(FILE *file, const void *context)
{
    const chosen *plot = context;
    for (int c = 0; c < plot->count; c++) {
        fputs(c > 0 ? "," : "", file);
        put_cell(file, plot->names[c]);
    }
    fputc('\n', file);
    for (int64_t row = 0; row < plot->series->row_count; row++)
        for (int c = 0; c < plot->count; c++) {
            const double value = pel_series_value(plot->series, c, row);
            if (isfinite(value))
                fprintf(file, "%s%.17g", c > 0 ? "," : "", value);
            else
                fputs(c > 0 ? "," : "", file);
            if (c + 1 == plot->count)
                fputc('\n', file);
        }
}

static int draw(const cli_call *call, const char *source, chosen *plot, const char *path)
{
    pel_error error;
    pel_series *series;
    if (pel_series_read(source, plot->names, plot->count, &series, &error) != PEL_OK)
        return cli_report(&error);
    plot->series = series;
    pel_status status = ends_in(path, ".csv") ? lab_write_file(path, "table", write_table, plot, &error)
                                              : write_picture(plot, call->arguments[0], path, &error);
    if (status == PEL_OK && !cli_has(call, "quiet"))
        printf("%s: %d columns, %lld rows\n", path, plot->count, (long long)series->row_count);
    pel_series_destroy(series);
    return status == PEL_OK ? CLI_DONE : cli_report(&error);
}

int cli_plot(const cli_call *call)
{
    char source[PATH_SIZE], own[PATH_SIZE];
    const char *path = cli_value(call, "output");
    header head = {0};
    chosen plot = {.log_x = cli_has(call, "log-x"), .log_y = cli_has(call, "log-y")};
    snprintf(source, sizeof source, "%.4200s/%s", call->arguments[0], pel_run_file_name(PEL_RUN_SERIES));
    snprintf(own, sizeof own, "%.4200s/plot.svg", call->arguments[0]);
    path = path != NULL ? path : own;
    if (!ends_in(path, ".svg") && !ends_in(path, ".png") && !ends_in(path, ".csv"))
        return cli_complain("'%s' is no plot. end the name in .svg or .png (a picture) or .csv (a table)", path);
    const char *name = strrchr(path, '/') != NULL ? strrchr(path, '/') + 1 : path;
    if (strcmp(name, pel_run_file_name(PEL_RUN_SERIES)) == 0)
        return cli_complain("'%s' is the name of a run's own table. choose another name", path);
    int status = CLI_BAD_INPUT;
    if (!read_header(source, &head))
        cli_complain("%s cannot be read. name the folder of a run, such as results/balloon", source);
    else if (call->argument_count == 1)
        status = list_columns(&head);
    else if (choose(call, &head, &plot))
        status = draw(call, source, &plot, path);
    free(head.line);
    return status;
}
