/* pellicle render: the options become a pel_render_def. */
#include "commands.h"
#include "diagnostics.h"
#include "stop.h"

#include <pellicle/render.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

static const char *const backgrounds[] = {"white", "dark", "transparent"};
enum { BACKGROUND_COUNT = sizeof backgrounds / sizeof backgrounds[0], RANGES = 64 };

const char *cli_background_names(int index)
{
    return index < BACKGROUND_COUNT ? backgrounds[index] : NULL;
}

const char *cli_axis_names(int index)
{
    static const char *const names[] = {"x", "y", "z", NULL};
    return names[index];
}

#ifndef PELLICLE_VIEW

const char *cli_color_map_names(int index)
{
    (void)index;
    return NULL;
}

int cli_render(const cli_call *call)
{
    (void)call;
    return cli_complain("this program was built without pictures. build it with -DPELLICLE_VIEW=ON");
}

#else

const char *cli_color_map_names(int index)
{
    return pel_color_map_name(index);
}

/* ---- values of options ---- */

/* up to `most` numbers with a letter between them, at least `least`; returns how many, 0 when the text is anything else
 */
static int read_numbers(const char *text, char between, int least, int most, double *numbers)
{
    for (int count = 0; count < most;) {
        char *end;
        numbers[count] = strtod(text, &end);
        if (end == text || !isfinite(numbers[count]))
            return 0;
        ++count;
        if (*end == '\0')
            return count >= least ? count : 0;
        if (*end != between)
            return 0;
        text = end + 1;
    }
    return 0;
}

/* "1280x720" */
static bool read_pair(const cli_call *call, const char *option, int32_t *first, int32_t *second)
{
    const char *text = cli_value(call, option);
    double numbers[2];
    if (text == NULL)
        return true;
    if (read_numbers(text, 'x', 2, 2, numbers) == 2 && numbers[0] >= 1 && numbers[1] >= 1 && numbers[0] <= 100000 &&
        numbers[1] <= 100000 && numbers[0] == floor(numbers[0]) && numbers[1] == floor(numbers[1])) {
        *first = (int32_t)numbers[0];
        *second = (int32_t)numbers[1];
        return true;
    }
    cli_complain("option '--%s' is '%s'. write two whole numbers from 1, such as %s", option, text,
                 strcmp(option, "size") == 0 ? "1280x720" : "3x2");
    return false;
}

static bool read_range(const cli_call *call, pel_render_def *def)
{
    const char *text = cli_value(call, "range");
    if (text == NULL)
        return true;
    def->fixed_range = true;
    if (read_numbers(text, ':', 2, 2, def->range) == 2 && def->range[0] < def->range[1])
        return true;
    cli_complain("option '--range' is '%s'. write LOW:HIGH with the lower number first, such as 0:0.3", text);
    return false;
}

static bool read_view(const cli_call *call, pel_camera_angle *angle)
{
    const char *text = cli_value(call, "view");
    double numbers[3] = {0, 0, 1};
    if (text == NULL || pel_camera_preset_find(text, angle))
        return true;
    if (read_numbers(text, ',', 2, 3, numbers) > 0 && fabs(numbers[1]) <= 90 && numbers[2] >= 0.01 &&
        numbers[2] <= 100) {
        *angle = (pel_camera_angle){numbers[0], numbers[1], numbers[2]};
        return true;
    }
    const char *nearest = cli_nearest(text, pel_camera_preset_name);
    if (nearest != NULL)
        cli_complain("unknown view '%s'. did you mean '%s'?", text, nearest);
    else
        cli_complain("unknown view '%s'. choose iso, front, back, left, right, top or bottom, or write "
                     "AZIMUTH,ELEVATION[,ZOOM] with an elevation of -90 to 90 and a zoom of 0.01 to 100",
                     text);
    return false;
}

/* "x", "y", "z" or a number from 0 */
static bool read_component(const cli_call *call, int32_t *component)
{
    const char *text = cli_value(call, "component");
    char *end;
    if (text == NULL)
        return true;
    long number = strtol(text, &end, 10);
    if (text[0] >= 'x' && text[0] <= 'z' && text[1] == '\0')
        *component = text[0] - 'x';
    else if (*end == '\0' && number >= 0 && number < 1000)
        *component = (int32_t)number;
    else
        return cli_complain("option '--component' is '%s'. write x, y, z or a number from 0", text), false;
    return true;
}

/* "50", "50:", "0:100:10", ":-1" */
static bool read_frame_range(const char *text, size_t length, pel_frame_range *range)
{
    char copy[64], *end;
    long numbers[3] = {0, -1, 1};
    if (length == 0 || length >= sizeof copy)
        return false;
    memcpy(copy, text, length);
    copy[length] = '\0';
    const char *at = copy;
    for (int i = 0; i < 3; ++i) {
        long number = strtol(at, &end, 10);
        if (end != at)
            numbers[i] = number;
        if (*end == '\0') {
            if (i == 0)
                numbers[1] = numbers[0];
            break;
        }
        if (*end != ':' || i == 2)
            return false;
        at = end + 1;
    }
    for (int i = 0; i < 3; ++i) {
        if (numbers[i] < -1000000000 || numbers[i] > 1000000000)
            return false;
    }
    *range = (pel_frame_range){(int32_t)numbers[0], (int32_t)numbers[1], (int32_t)numbers[2]};
    return range->step >= 1;
}

static bool read_frames(const cli_call *call, pel_frame_range ranges[RANGES], int32_t *count)
{
    const char *text = cli_value(call, "frames");
    for (const char *at = text; at != NULL; ++*count) {
        const char *comma = strchr(at, ',');
        size_t length = comma != NULL ? (size_t)(comma - at) : strlen(at);
        if (*count >= RANGES || !read_frame_range(at, length, &ranges[*count])) {
            cli_complain("option '--frames' is '%s'. write frames as 50, 0:100, 0:100:10 or 0,50,-1; -1 is the last",
                         text);
            return false;
        }
        at = comma != NULL ? comma + 1 : NULL;
    }
    return true;
}

static bool read_choices(const cli_call *call, pel_render_def *def)
{
    const char *colors = cli_value(call, "colors"), *background = cli_value(call, "background");
    const char *up = cli_value(call, "up");
    if (colors != NULL)
        pel_color_map_find(colors, &def->color_map);
    for (int i = 0; background != NULL && i < BACKGROUND_COUNT; ++i) {
        if (strcmp(background, backgrounds[i]) == 0)
            def->background = (pel_background)i;
    }
    if (up != NULL)
        def->up = up[0] - 'x';
    def->field = cli_value(call, "field");
    def->arrows = cli_value(call, "arrows");
    def->title = cli_value(call, "title");
    def->unit = cli_value(call, "unit");
    def->flat = cli_has(call, "flat");
    def->edges = cli_has(call, "edges");
    def->outline = cli_has(call, "outline");
    def->hide_bar = cli_has(call, "no-bar");
    def->hide_labels = cli_has(call, "no-labels");
    def->hide_tools = cli_has(call, "no-tools");
    def->hide_ground = cli_has(call, "no-ground");
    def->frame_numbers = cli_has(call, "frame-numbers");
    def->frame_rate = cli_number(call, "fps");
    def->turn = cli_number(call, "turn");
    return read_component(call, &def->component) && read_range(call, def) && read_view(call, &def->angle) &&
           read_pair(call, "size", &def->width, &def->height) && read_pair(call, "sheet", &def->columns, &def->rows);
}

/* "d9b4a0,4a7cb2", also with # before each */
static bool read_body_colors(const cli_call *call, uint8_t (*colors)[3], pel_render_def *def)
{
    const char *text = cli_value(call, "body-colors");
    for (const char *at = text; at != NULL; at = *at == ',' ? at + 1 : NULL) {
        at += *at == '#';
        if (strspn(at, "0123456789abcdefABCDEF") != 6 || (at[6] != ',' && at[6] != '\0') ||
            def->body_color_count == PEL_RENDER_COLOR_LIMIT)
            return cli_complain("option '--body-colors' is '%s'. write up to %d colors as RRGGBB with commas between, "
                                "such as d9b4a0,4a7cb2",
                                text, (int)PEL_RENDER_COLOR_LIMIT),
                   false;
        for (int i = 0; i < 3; ++i, at += 2)
            colors[def->body_color_count][i] = (uint8_t)strtoul((char[]){at[0], at[1], '\0'}, NULL, 16);
        def->body_color_count++;
    }
    if (text != NULL)
        def->body_colors = (const uint8_t(*)[3])colors;
    return true;
}

/* labels for all inputs or none */
static bool read_labels(const cli_call *call, const char **labels, pel_render_def *def)
{
    int count = cli_values(call, "label", labels);
    if (count > 0 && count != def->input_count)
        return cli_complain("there are %d labels for %d runs. give one to each", count, (int)def->input_count), false;
    def->labels = count > 0 ? labels : NULL;
    return true;
}

/* ---- the command ---- */

/* RUN/pictures for a folder, NAME.png for a file */
static const char *choose_output(const cli_call *call, char *text, size_t size)
{
    const char *output = cli_value(call, "output"), *input = call->arguments[0];
    if (output != NULL)
        return output;
    const char *slash = strrchr(input, '/'), *name = slash != NULL ? slash + 1 : input, *dot = strrchr(name, '.');
    size_t length = strlen(input);
    while (length > 1 && input[length - 1] == '/')
        --length;
    if (call->argument_count > 1)
        snprintf(text, size, "pictures");
    else if (cli_is_folder(input) || dot == NULL)
        snprintf(text, size, "%.*s/pictures", (int)length, input);
    else if (strcmp(dot, ".pvd") == 0)
        snprintf(text, size, "%.*spictures", (int)(name - input), input);
    else
        snprintf(text, size, "%.*s.png", (int)(dot - name), name);
    return text;
}

/* whether the name, taken as a folder of pictures, has the extension of a file format that cannot be written */
static bool is_other_file(const char *output)
{
    static const char *const endings[] = {".jpg", ".jpeg", ".bmp",  ".tif", ".tiff", ".webp", ".svg", ".pdf",
                                          ".avi", ".mov",  ".webm", ".mkv", ".html", ".exr",  ".ppm"};
    const char *slash = strrchr(output, '/'), *dot = strrchr(slash != NULL ? slash : output, '.');
    for (size_t i = 0; dot != NULL && i < sizeof endings / sizeof *endings; i++)
        if (strcasecmp(dot, endings[i]) == 0)
            return !cli_is_folder(output);
    return false;
}

static void write_summary(const char *output, const pel_render_summary *summary)
{
    pel_json json = {.file = stdout, .style = PEL_JSON_INDENTED};
    pel_json_open(&json, NULL, '{');
    pel_json_text(&json, "output", output);
    pel_json_integer(&json, "pictures", summary->picture_count);
    pel_json_integer(&json, "width", summary->width);
    pel_json_integer(&json, "height", summary->height);
    pel_json_text(&json, "field", summary->field[0] != '\0' ? summary->field : NULL);
    if (summary->field[0] != '\0')
        pel_json_numbers(&json, "range", summary->range, 2);
    pel_json_number(&json, "read_s", summary->read_s);
    pel_json_number(&json, "draw_s", summary->draw_s);
    pel_json_number(&json, "least_s", summary->least_s);
    pel_json_number(&json, "write_s", summary->write_s);
    pel_json_text(&json, "renderer", summary->renderer);
    pel_json_close(&json, '}');
}

static void print_summary(const char *output, const pel_render_summary *summary)
{
    printf("%s: ", output);
    if (summary->picture_count > 1)
        printf("%d pictures of ", (int)summary->picture_count);
    printf("%d x %d pixels", (int)summary->width, (int)summary->height);
    if (summary->field[0] != '\0')
        printf(", %s from %.4g to %.4g", summary->field, summary->range[0], summary->range[1]);
    putchar('\n');
}

static bool go_on(void *unused)
{
    (void)unused;
    cli_catch_stop("stopping; the same again ends at once\n");
    return !cli_stop_asked();
}

int cli_render(const cli_call *call)
{
    pel_render_def def = pel_render_def_default();
    pel_frame_range ranges[RANGES];
    char output[4096];
    const char *labels[CLI_ARGUMENTS + 1];
    uint8_t colors[PEL_RENDER_COLOR_LIMIT][3];
    def.inputs = call->arguments;
    def.input_count = call->argument_count;
    def.output = choose_output(call, output, sizeof output);
    def.frames = ranges;
    def.progress = go_on;
    if (call->given_count > CLI_ARGUMENTS)
        return cli_complain("there are too many options");
    if (is_other_file(def.output))
        return cli_complain(
            "'%s' is not a picture format that can be written. end the name in .png, .mp4 or .gif, or name a folder",
            def.output);
    if (!read_choices(call, &def) || !read_frames(call, ranges, &def.frame_range_count) ||
        !read_labels(call, labels, &def) || !read_body_colors(call, colors, &def))
        return CLI_BAD_INPUT;
    pel_render_summary summary;
    pel_error error;
    if (pel_render(&def, &cli_notes, &summary, &error) != PEL_OK)
        return cli_report(&error);
    if (cli_has(call, "json"))
        write_summary(def.output, &summary);
    else if (!cli_has(call, "quiet"))
        print_summary(def.output, &summary);
    return CLI_DONE;
}

#endif
