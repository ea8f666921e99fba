/* Rendering in two passes over the frames: the first finds the range of the colors and the camera, so that all pictures
   agree; the second draws. Only one frame is in memory at a time, and nothing is written before all frames were read
   once without an error. */
#include "pellicle/render.h"

#include "view/field.h"
#include "view/film.h"
#include "view/frame_selection.h"
#include "view/gl_target.h"
#include "view/run.h"
#include "view/sheet_layout.h"
#include "view/support.h"
#include "view/writer.h"

#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

enum { PATH_SIZE = 4096, MOST_INPUTS = 64, MOST_ARROWS = 1500 };
static const uint32_t cookie = 0x52454e44;

/* a field that colors the surface, with the scale of its color bar */
typedef struct shown_field {
    char name[PEL_NAME_SIZE]; /* "" = plain */
    int32_t component_count;
    double range[2];
    pel_color_map color_map;
    view_scale scale;
} shown_field;

typedef struct job {
    pel_render_def def;
    const pel_log *log;
    view_run *runs; /* (def.input_count) */
    view_frame_selection shots;
    view_sheet page;
    view_gl_target *canvas;
    view_camera camera;
    view_image image;
    view_triangle_list soup;
    shown_field fields[PEL_RENDER_FIELD_LIMIT]; /* (field_count) */
    int32_t field_count, colored_count;         /* all; those that color the surface */
    double bounds[2][3];                        /* of the surfaces of all frames */
    double around;  /* radius of a ball about their middle with them and small tools in it */
    double longest; /* arrow, in the unit of its field */
    int time_decimals;
    double *values; /* (value_count) numbers of one frame */
    int32_t value_count;
    pel_render_summary summary;
} job;

pel_render_def pel_render_def_default(void)
{
    pel_render_def def = {.component = -1, .color_map = PEL_COLORS_AUTO, .up = -1, .cookie = cookie};
    pel_camera_preset_find("iso", &def.angle);
    return def;
}

/* ---- the def ---- */

static pel_status check_numbers(const pel_render_def *def, pel_error *error)
{
    const pel_camera_angle *angle = &def->angle;
    if (!isfinite(angle->azimuth) || !(fabs(angle->elevation) <= 90) || !(angle->zoom >= 0.01 && angle->zoom <= 100))
        return pel_refuse(error, PEL_BAD_ARGUMENT, "give an elevation of -90 to 90 and a zoom of 0.01 to 100",
                          "the camera's angle is out of range");
    if (def->fixed_range && !(isfinite(def->range[0]) && isfinite(def->range[1]) && def->range[0] < def->range[1]))
        return pel_refuse(error, PEL_BAD_ARGUMENT, "give its lower end first", "the range of the colors is empty");
    if (def->width < 0 || def->height < 0 || (def->width == 0) != (def->height == 0))
        return pel_refuse(error, PEL_BAD_ARGUMENT, "give width and height from 1",
                          "the size of the picture is out of range");
    if (def->columns < 0 || def->rows < 0 || def->columns > 1000 || def->rows > 1000 ||
        (def->columns == 0) != (def->rows == 0))
        return pel_refuse(error, PEL_BAD_ARGUMENT, "give both from 1", "the sheet's columns and rows are out of range");
    if (!(def->frame_rate >= 0 && def->frame_rate <= 1000))
        return pel_refuse(error, PEL_BAD_ARGUMENT, "give up to 1000 pictures a second",
                          "the frame rate is out of range");
    if (!isfinite(def->turn) || (def->turn != 0 && view_output_kind(def->output) != VIEW_FILM))
        return pel_refuse(error, PEL_BAD_ARGUMENT, "write a .mp4 or a .gif, or choose a view",
                          "the camera turns in films alone");
    if (def->component < -1 || def->up < -1 || def->up > 2 || (unsigned)def->color_map > PEL_COLORS_AUTO ||
        (unsigned)def->background > PEL_BACKGROUND_TRANSPARENT)
        return pel_refuse(error, PEL_BAD_ARGUMENT, "begin with pel_render_def_default", "a choice is out of range");
    return PEL_OK;
}

static pel_status check_def(const pel_render_def *def, pel_error *error)
{
    if (def == NULL || def->cookie != cookie)
        return pel_refuse(error, PEL_BAD_ARGUMENT, "begin with that function",
                          "the def was not made by pel_render_def_default");
    if (def->inputs == NULL || def->input_count < 1 || def->input_count > MOST_INPUTS)
        return pel_refuse(error, PEL_BAD_ARGUMENT, "draw 1 to 64 at a time",
                          "the number of runs is out of range, or inputs is null");
    for (int32_t i = 0; i < def->input_count; ++i)
        if (def->inputs[i] == NULL)
            return pel_refuse(error, PEL_BAD_ARGUMENT, "name each run", "one of the inputs is null");
    if (def->frame_range_count < 0 || (def->frame_range_count > 0 && def->frames == NULL))
        return pel_refuse(error, PEL_BAD_ARGUMENT, "give the ranges with their count",
                          "frames is null, or frame_range_count below 0");
    if (def->output == NULL || def->output[0] == '\0' || strlen(def->output) > PATH_SIZE - 64)
        return pel_refuse(error, PEL_BAD_ARGUMENT, "name a folder, a .png or an .mp4 file",
                          "the output has no name or a very long one");
    if (view_output_kind(def->output) == VIEW_FILM && def->background == PEL_BACKGROUND_TRANSPARENT)
        return pel_refuse(error, PEL_BAD_ARGUMENT, "choose a white or dark background, or write pictures",
                          "a film cannot be transparent");
    if (def->body_colors != NULL && (def->body_color_count < 1 || def->body_color_count > PEL_RENDER_COLOR_LIMIT))
        return pel_refuse(error, PEL_BAD_ARGUMENT, "give 1 to 16 colors",
                          "the number of colors of bodies is out of range");
    return check_numbers(def, error);
}

/* ---- reading ---- */

static const char *frame_path(const job *j, view_shot shot)
{
    const view_run *run = &j->runs[shot.run];
    return run->frames != NULL ? run->frames->paths[shot.frame] : run->path;
}

static pel_status read_shot(job *j, view_shot shot, pel_mesh **mesh, pel_error *error)
{
    double start = pel_seconds();
    *mesh = NULL;
    if (j->def.progress != NULL && !j->def.progress(j->def.user))
        return pel_fail(error, PEL_STOPPED, "stopped while drawing");
    pel_status status = view_run_read(&j->runs[shot.run], shot.frame, mesh, error);
    if (status == PEL_OK && (*mesh)->vertex_count > j->value_count) {
        double *grown = realloc(j->values, (size_t)(*mesh)->vertex_count * sizeof *grown);
        if (grown != NULL) {
            j->values = grown;
            j->value_count = (*mesh)->vertex_count;
        } else {
            status = pel_fail_memory(error);
        }
    }
    j->summary.read_s += pel_seconds() - start;
    if (status != PEL_OK) {
        pel_mesh_destroy(*mesh);
        *mesh = NULL;
    }
    return status;
}

static pel_status open_runs(job *j, pel_error *error)
{
    j->runs = view_allocate((size_t)j->def.input_count, sizeof *j->runs);
    pel_status status = j->runs != NULL ? PEL_OK : pel_fail_memory(error);
    for (int32_t r = 0; status == PEL_OK && r < j->def.input_count; ++r)
        status = view_run_open(&j->runs[r], j->def.inputs[r], !j->def.hide_tools, j->log, error);
    if (status == PEL_OK && j->def.up < 0)
        j->def.up = view_run_up(&j->runs[0]);
    return status;
}

/* splits the names that are asked for; displacement unless any are */
static pel_status name_fields(job *j, pel_error *error)
{
    const char *at = j->def.field != NULL ? j->def.field : "displacement";
    for (bool is_last = false; !is_last; at += strcspn(at, ",") + 1) {
        size_t length = strcspn(at, ",");
        is_last = at[length] == '\0';
        if (j->field_count == PEL_RENDER_FIELD_LIMIT)
            return pel_refuse(error, PEL_BAD_ARGUMENT, "name up to 8 with commas between them",
                              "there are more than 8 fields");
        shown_field *shown = &j->fields[j->field_count++];
        *shown = (shown_field){.range = {HUGE_VAL, -HUGE_VAL}};
        if (length == 4 && strncmp(at, "none", 4) == 0)
            continue;
        if (length == 0 || length >= sizeof shown->name)
            return pel_refuse(error, PEL_BAD_ARGUMENT, "write names such as displacement,force",
                              "the name of a field is empty or too long");
        snprintf(shown->name, sizeof shown->name, "%.*s", (int)length, at);
        ++j->colored_count;
    }
    if (j->colored_count > 1 && (j->def.fixed_range || j->def.unit != NULL))
        return pel_refuse(error, PEL_BAD_ARGUMENT, "leave them out, or name one field beside none",
                          "range and unit are those of a single field, but there are several");
    return PEL_OK;
}

/* the names of name_fields in the first mesh; only displacement that nobody asked for may be missing */
static pel_status find_fields(job *j, pel_error *error)
{
    pel_mesh *mesh;
    const pel_field *field;
    pel_status status = read_shot(j, j->shots.shots[0], &mesh, error);
    for (int32_t f = 0; status == PEL_OK && f < j->field_count; ++f) {
        shown_field *shown = &j->fields[f];
        if (shown->name[0] == '\0')
            continue;
        status = view_field_find(mesh, shown->name, frame_path(j, j->shots.shots[0]), &field, error);
        if (status == PEL_OK) {
            shown->component_count = field->component_count;
        } else if (j->def.field == NULL) {
            shown->name[0] = '\0';
            j->colored_count = 0;
            status = PEL_OK;
        }
    }
    pel_mesh_destroy(mesh);
    return status;
}

/* ---- first pass ---- */

static pel_status survey_arrows(job *j, const pel_mesh *mesh, const char *place, pel_error *error)
{
    double range[2] = {0, 0};
    const pel_field *field;
    pel_status status = view_field_find(mesh, j->def.arrows, place, &field, error);
    if (status == PEL_OK && field->component_count != 3) {
        pel_fail(error, PEL_BAD_ARGUMENT, "field '%s' is not a vector, so it has no arrows", j->def.arrows);
        pel_fail_place(error, place, 0, 0);
        pel_fail_remedy(error, "choose a field of 3 numbers, such as force or displacement");
        return PEL_BAD_ARGUMENT;
    }
    if (status == PEL_OK)
        status = view_field_take(mesh, j->def.arrows, -1, place, j->values, range, error);
    j->longest = fmax(j->longest, range[1]);
    return status;
}

static void survey_points(job *j, const pel_mesh *mesh)
{
    for (int32_t v = 0; v < mesh->vertex_count; ++v) {
        view_camera_see(&j->camera, mesh->positions[v], 0);
        for (int i = 0; i < 3; ++i) {
            j->bounds[0][i] = fmin(j->bounds[0][i], mesh->positions[v][i]);
            j->bounds[1][i] = fmax(j->bounds[1][i], mesh->positions[v][i]);
        }
    }
}

static double body_size(const job *j)
{
    double size = 0;
    for (int i = 0; i < 3; ++i)
        size = hypot(size, j->bounds[1][i] - j->bounds[0][i]);
    return size;
}

static double tool_radius(const pel_tool_def *tool)
{
    const double *half = tool->half_extents;
    return tool->radius + tool->half_length + sqrt(half[0] * half[0] + half[1] * half[1] + half[2] * half[2]);
}

static void find_middle(const job *j, double middle[3])
{
    for (int i = 0; i < 3; ++i)
        middle[i] = 0.5 * (j->bounds[0][i] + j->bounds[1][i]);
}

/* Of the body's size: tools up to this are shown whole, larger ones may reach out of the picture. Beyond half of it
   they may hide the body: they are drawn more transparent and cast no shadow. */
#define WHOLE_TOOL 0.7

static bool may_hide(const job *j, const pel_tool_def *tool)
{
    return tool_radius(tool) > 0.5 * WHOLE_TOOL * body_size(j);
}

static void survey_tools(job *j, view_shot shot)
{
    const view_run *run = &j->runs[shot.run];
    for (int32_t t = 0; t < view_run_tool_count(run); ++t) {
        double position[3], rotation[4];
        const pel_tool_def *tool = view_run_tool(run, t, shot.frame, position, rotation);
        if (tool->shape == PEL_TOOL_SUPPORT)
            continue;
        double radius = tool_radius(tool), middle[3];
        find_middle(j, middle);
        if (radius < WHOLE_TOOL * body_size(j)) {
            view_camera_see(&j->camera, position, radius);
            j->around =
                fmax(j->around,
                     hypot(hypot(position[0] - middle[0], position[1] - middle[1]), position[2] - middle[2]) + radius);
        } else {
            view_camera_reach(&j->camera, position, radius);
        }
    }
}

static pel_status survey_shot(job *j, view_shot shot, pel_error *error)
{
    pel_mesh *mesh;
    const char *place = frame_path(j, shot);
    pel_status status = read_shot(j, shot, &mesh, error);
    if (status != PEL_OK)
        return status;
    shown_field *shown = &j->fields[shot.field];
    if (shown->name[0] != '\0')
        status = view_field_take(mesh, shown->name, j->def.component, place, j->values, shown->range, error);
    if (status == PEL_OK && j->def.arrows != NULL)
        status = survey_arrows(j, mesh, place, error);
    if (status == PEL_OK)
        survey_points(j, mesh);
    pel_mesh_destroy(mesh);
    return status;
}

/* ---- arrows ---- */

/* the vectors worth drawing, every stride-th of them when they are many */
static bool is_drawn(const double vector[3], double least)
{
    return vector[0] * vector[0] + vector[1] * vector[1] + vector[2] * vector[2] > least * least;
}

/* callback for an arrow from ends[0] to ends[1] */
typedef pel_status arrow_visit(job *j, const double ends[2][3], pel_error *error);

static pel_status see_arrow(job *j, const double ends[2][3], pel_error *error)
{
    (void)error;
    view_camera_see(&j->camera, ends[0], 0);
    view_camera_see(&j->camera, ends[1], 0);
    return PEL_OK;
}

static pel_status add_arrow(job *j, const double ends[2][3], pel_error *error)
{
    return view_triangle_list_add_arrow(&j->soup, &j->camera, ends[0], ends[1], 0.006 * body_size(j), error);
}

static pel_status visit_arrows(job *j, const pel_mesh *mesh, const double (*vectors)[3], const double (*normals)[3],
                               arrow_visit *visit, pel_error *error)
{
    double least = 0.02 * j->longest, scale = 0.2 * body_size(j) / j->longest;
    int32_t count = 0, next = 0;
    for (int32_t v = 0; v < mesh->vertex_count; ++v)
        count += is_drawn(vectors[v], least);
    int32_t stride = (count + MOST_ARROWS - 1) / MOST_ARROWS;
    for (int32_t v = 0; v < mesh->vertex_count; ++v) {
        if (!is_drawn(vectors[v], least) || next++ % stride != 0)
            continue;
        const double *at = mesh->positions[v];
        double along = 0, ends[2][3];
        for (int i = 0; i < 3; ++i)
            along += vectors[v][i] * normals[v][i];
        for (int i = 0; i < 3; ++i) {
            ends[0][i] = at[i] - (along < 0 ? scale * vectors[v][i] : 0);
            ends[1][i] = at[i] + (along < 0 ? 0 : scale * vectors[v][i]);
        }
        pel_status status = visit(j, (const double(*)[3])ends, error);
        if (status != PEL_OK)
            return status;
    }
    return PEL_OK;
}

static pel_status walk_arrows(job *j, const pel_mesh *mesh, arrow_visit *visit, pel_error *error)
{
    if (!(j->longest > 0))
        return PEL_OK;
    double(*normals)[3] = view_mesh_normals(mesh);
    if (normals == NULL)
        return pel_fail_memory(error);
    const double(*vectors)[3] = (const double(*)[3])pel_mesh_field(mesh, j->def.arrows)->values;
    pel_status status = visit_arrows(j, mesh, vectors, (const double(*)[3])normals, visit, error);
    free(normals);
    return status;
}

/* arrows belong into the picture; how long they are is known once all frames were read */
static pel_status survey_arrow_ends(job *j, view_shot shot, pel_error *error)
{
    pel_mesh *mesh;
    pel_status status = read_shot(j, shot, &mesh, error);
    if (status == PEL_OK)
        status = walk_arrows(j, mesh, see_arrow, error);
    pel_mesh_destroy(mesh);
    return status;
}

/* a range whose low end is 0 or, compared with its high end, near it */
static bool is_from_zero(const double range[2])
{
    return range[0] == 0 || (range[0] > 0 && range[0] < 0.1 * range[1]);
}

/* grey is zero if zero is in the middle or at the low end of the range */
static pel_color_map choose_color_map(const pel_render_def *def, const double range[2])
{
    bool both = range[0] < 0 && range[1] > 0;
    if (def->color_map != PEL_COLORS_AUTO)
        return def->color_map;
    if (both && -range[0] > 0.05 * range[1] && range[1] > -0.05 * range[0])
        return PEL_COLORS_COOL_WARM;
    return is_from_zero(def->fixed_range ? def->range : range) ? PEL_COLORS_WARM : PEL_COLORS_VIRIDIS;
}

/* makes the range fit for a color bar: not empty, from 0 where that is near, symmetric for two colors */
static void settle_range(const pel_render_def *def, shown_field *shown)
{
    double *range = shown->range;
    bool both = range[0] < 0 && range[1] > 0;
    shown->color_map = choose_color_map(def, range);
    if (def->fixed_range) {
        memcpy(range, def->range, sizeof shown->range);
        return;
    }
    if (both && shown->color_map == PEL_COLORS_COOL_WARM) {
        range[1] = fmax(range[1], -range[0]);
        range[0] = -range[1];
    } else if (is_from_zero(range)) {
        range[0] = 0;
    }
    double size = fmax(fabs(range[0]), fabs(range[1]));
    if (size == 0) {
        range[1] = 1;
    } else if (range[1] - range[0] < 1e-9 * size) {
        range[0] -= 0.05 * size;
        range[1] += 0.05 * size;
    }
}

/* how many decimals tell the times apart, at most 4 */
static int count_decimals(const job *j)
{
    int decimals = 0;
    for (int32_t i = 0; i < j->shots.page_count * j->shots.cell_count; ++i) {
        view_shot shot = j->shots.shots[i];
        double time = shot.run >= 0 ? view_run_time(&j->runs[shot.run], shot.frame) : 0;
        for (double scale = pow(10, decimals); decimals < 4; scale *= 10, ++decimals) {
            if (fabs(time * scale - round(time * scale)) < 1e-3)
                break;
        }
    }
    return decimals;
}

static pel_status survey(job *j, pel_error *error)
{
    for (int i = 0; i < 2; ++i) {
        for (int k = 0; k < 3; ++k)
            j->bounds[i][k] = i == 0 ? HUGE_VAL : -HUGE_VAL;
    }
    int32_t count = j->shots.page_count * j->shots.cell_count;
    view_camera_begin(&j->camera, &j->def.angle, j->def.up, j->page.cell_width, j->page.cell_height);
    pel_status status = PEL_OK;
    for (int32_t i = 0; status == PEL_OK && i < count; ++i) {
        if (j->shots.shots[i].run >= 0)
            status = survey_shot(j, j->shots.shots[i], error);
    }
    for (int32_t i = 0; status == PEL_OK && j->longest > 0 && i < count; ++i) {
        if (j->shots.shots[i].run >= 0)
            status = survey_arrow_ends(j, j->shots.shots[i], error);
    }
    if (status != PEL_OK)
        return status;
    j->around = 0.5 * body_size(j);
    for (int32_t i = 0; i < count; ++i) {
        if (j->shots.shots[i].run >= 0)
            survey_tools(j, j->shots.shots[i]);
    }
    view_camera_fit(&j->camera, j->def.angle.zoom);
    j->time_decimals = count_decimals(j);
    for (int32_t f = 0; f < j->field_count; ++f) {
        shown_field *shown = &j->fields[f];
        if (shown->name[0] == '\0')
            continue;
        settle_range(&j->def, shown);
        view_scale_make(&shown->scale, shown->name, j->def.component, shown->component_count, j->def.unit,
                        shown->range);
    }
    return PEL_OK;
}

/* ---- second pass ---- */

/* The corners of a picture, in the order in which they are drawn. */
typedef struct parts {
    size_t surface, arrows, tools, large_tools, ground; /* where each ends */
} parts;

/* tissue first: a single body has it */
static const uint8_t body_colors[][3] = {{217, 180, 160}, {74, 124, 178},  {196, 92, 78},  {118, 158, 104},
                                         {222, 176, 84},  {138, 112, 170}, {96, 164, 168}, {150, 150, 150}};

/* the colors of bodies that no field colors */
static int32_t palette(const job *j, const uint8_t (**colors)[3])
{
    const bool is_given = j->def.body_colors != NULL;
    *colors = is_given ? j->def.body_colors : body_colors;
    return is_given ? j->def.body_color_count : (int32_t)(sizeof body_colors / sizeof *body_colors);
}

/* whether bodies have several colors or one that is given; false = plain */
static bool has_palette(const job *j, const pel_mesh *mesh)
{
    return j->def.body_colors != NULL || pel_mesh_field(mesh, "body") != NULL;
}

/* the place of each vertex's body in the palette */
static void take_bodies(job *j, const pel_mesh *mesh)
{
    const uint8_t(*colors)[3];
    const int32_t count = palette(j, &colors);
    const pel_field *body = pel_mesh_field(mesh, "body");
    for (int32_t v = 0; v < mesh->vertex_count; ++v) {
        const double number = body != NULL ? body->values[(size_t)v * (size_t)body->component_count] : 0;
        j->values[v] = (fmod(number >= 0 ? number : 0, count) + 0.5) / count;
    }
}

static pel_status add_surface(job *j, const pel_mesh *mesh, view_shot shot, pel_error *error)
{
    const shown_field *shown = &j->fields[shot.field];
    double unused[2] = {0, 0}, low = shown->range[0], high = shown->range[1];
    bool colored = shown->name[0] != '\0';
    if (!colored && has_palette(j, mesh)) {
        take_bodies(j, mesh);
        return view_triangle_list_add_mesh(&j->soup, &j->camera, mesh, j->values, j->def.flat, error);
    }
    if (colored) {
        pel_status status =
            view_field_take(mesh, shown->name, j->def.component, frame_path(j, shot), j->values, unused, error);
        if (status != PEL_OK)
            return status;
        for (int32_t v = 0; v < mesh->vertex_count; ++v)
            j->values[v] = fmin(fmax((j->values[v] - low) / (high - low), 0), 1);
    }
    return view_triangle_list_add_mesh(&j->soup, &j->camera, mesh, colored ? j->values : NULL, j->def.flat, error);
}

static pel_status add_tools(job *j, view_shot shot, bool large, pel_error *error)
{
    const view_run *run = &j->runs[shot.run];
    pel_status status = PEL_OK;
    for (int32_t t = 0; status == PEL_OK && t < view_run_tool_count(run); ++t) {
        double position[3], rotation[4];
        const pel_tool_def *tool = view_run_tool(run, t, shot.frame, position, rotation);
        if (may_hide(j, tool) == large)
            status = view_triangle_list_add_tool(&j->soup, &j->camera, tool, position, rotation, error);
    }
    return status;
}

/* under the lowest point of all frames; its shadows are seen from above only */
static pel_status add_ground(job *j, pel_error *error)
{
    double center[3];
    if (j->def.hide_ground || j->camera.axes[2][j->camera.up] < 0.05)
        return PEL_OK;
    for (int i = 0; i < 3; ++i)
        center[i] = 0.5 * (j->bounds[0][i] + j->bounds[1][i]);
    center[j->def.up] = j->bounds[0][j->def.up] - 0.002 * body_size(j);
    return view_triangle_list_add_ground(&j->soup, &j->camera, center, 0.9 * body_size(j), error);
}

static pel_status add_parts(job *j, const pel_mesh *mesh, view_shot shot, parts *ends, pel_error *error)
{
    j->soup.count = 0;
    pel_status status = add_surface(j, mesh, shot, error);
    ends->surface = j->soup.count;
    if (status == PEL_OK && j->def.arrows != NULL)
        status = walk_arrows(j, mesh, add_arrow, error);
    ends->arrows = j->soup.count;
    if (status == PEL_OK)
        status = add_tools(j, shot, false, error);
    ends->tools = j->soup.count;
    if (status == PEL_OK)
        status = add_tools(j, shot, true, error);
    ends->large_tools = j->soup.count;
    if (status == PEL_OK)
        status = add_ground(j, error);
    ends->ground = j->soup.count;
    return status;
}

/* fields keep their colors: shadows on them are weaker */
static void draw_parts(job *j, const pel_mesh *mesh, const shown_field *shown, const parts *ends)
{
    bool colored = shown->name[0] != '\0';
    const uint8_t(*colors)[3];
    const int32_t color_count = palette(j, &colors);
    const view_look surface = {.colored = colored || has_palette(j, mesh),
                               .plain = {{colors[0][0], colors[0][1], colors[0][2], 255}},
                               .edge_width = j->def.edges ? fmax(0.9, j->page.text_size / 18.0) : 0,
                               .edge_strength = 0.4,
                               .highlight = colored ? 0.015 : 0.05,
                               .occlusion = colored ? 0.6 : 1};
    const view_look outline = {.plain = {{40, 34, 34, 255}}, .outline_width = fmax(1.2, j->page.text_size / 14.0)};
    const view_look arrows = {.plain = {{196, 44, 56, 255}}, .highlight = 0.1, .occlusion = 0.4};
    const view_look tools = {.plain = {{120, 132, 148, 110}}, .highlight = 0.25},
                    large_tools = {.plain = {{120, 132, 148, 44}}, .highlight = 0.1};
    const view_look ground = {.ground = true, .occlusion = j->def.background == PEL_BACKGROUND_DARK ? 1 : 0.8};
    double middle[3], center[3];
    find_middle(j, middle);
    view_camera_turn(&j->camera, middle, center);
    if (colored)
        view_gl_target_set_color_map(j->canvas, shown->color_map);
    else
        view_gl_target_set_palette(j->canvas, colors, color_count);
    /* colors stay readable under tools, which are transparent: only on a plain surface they cast shadows */
    view_gl_target_load(j->canvas, &j->soup, colored ? ends->arrows : ends->tools, center,
                        fmax(0.6 * body_size(j), 1e-30));
    view_gl_target_draw(j->canvas, &j->soup, 0, ends->surface, &surface);
    if (j->def.outline)
        view_gl_target_draw(j->canvas, &j->soup, 0, ends->surface, &outline);
    view_gl_target_draw(j->canvas, &j->soup, ends->surface, ends->arrows - ends->surface, &arrows);
    view_gl_target_draw(j->canvas, &j->soup, ends->large_tools, ends->ground - ends->large_tools, &ground);
    view_gl_target_draw(j->canvas, &j->soup, ends->tools, ends->large_tools - ends->tools, &large_tools);
    view_gl_target_draw(j->canvas, &j->soup, ends->arrows, ends->tools - ends->arrows, &tools);
}

/* adds to a text of `size` bytes, after a comma unless it is the first part */
__attribute__((format(printf, 3, 4))) static void add_part(char *text, size_t size, const char *format, ...)
{
    size_t length = strlen(text);
    if (length > 0 && length + 2 < size)
        length += (size_t)snprintf(text + length, size - length, ", ");
    va_list values;
    va_start(values, format);
    vsnprintf(text + length, size - length, format, values);
    va_end(values);
}

/* "soft, force, t = 0.50 s", "soft, frame 50", or "soft, mode 1" */
static void draw_label(job *j, view_shot shot, int32_t cell)
{
    const view_run *run = &j->runs[shot.run];
    char text[512] = "";
    if (j->def.labels != NULL && j->def.labels[shot.run] != NULL) {
        add_part(text, sizeof text, "%s", j->def.labels[shot.run]);
    } else if (j->def.input_count > 1) {
        /* the last part of the path, without trailing slashes */
        const char *end = run->path + strlen(run->path);
        while (end > run->path + 1 && end[-1] == '/')
            --end;
        const char *begin = end;
        while (begin > run->path && begin[-1] != '/')
            --begin;
        add_part(text, sizeof text, "%.*s", (int)(end - begin), begin);
    }
    if (j->colored_count > 1 && j->fields[shot.field].name[0] != '\0')
        add_part(text, sizeof text, "%s", j->fields[shot.field].scale.title);
    if (run->has_times && j->def.frame_numbers)
        add_part(text, sizeof text, "frame %d", (int)shot.frame);
    else if (run->has_times && view_run_has_modes(run))
        add_part(text, sizeof text, shot.frame > 0 ? "mode %d" : "at rest", (int)shot.frame);
    else if (run->has_times)
        add_part(text, sizeof text, "t = %.*f s", j->time_decimals, view_run_time(run, shot.frame));
    view_sheet_label(&j->page, &j->image, cell, text);
}

static pel_status draw_cell(job *j, view_shot shot, int32_t cell, pel_error *error)
{
    pel_mesh *mesh;
    pel_status status = read_shot(j, shot, &mesh, error);
    if (status != PEL_OK)
        return status;
    double start = pel_seconds();
    parts ends;
    int32_t x, y;
    view_sheet_cell(&j->page, cell, &x, &y);
    view_gl_target_begin(j->canvas, &j->camera, j->page.background);
    status = add_parts(j, mesh, shot, &ends, error);
    if (status == PEL_OK) {
        draw_parts(j, mesh, &j->fields[shot.field], &ends);
        status = view_gl_target_read(j->canvas, &j->image, x, y, error);
    }
    if (status == PEL_OK && !j->def.hide_labels)
        draw_label(j, shot, cell);
    j->summary.draw_s += pel_seconds() - start;
    pel_mesh_destroy(mesh);
    return status;
}

/* The camera of a picture of a film that goes around the body, always from the same distance. */
static void turn_camera(job *j, int32_t page)
{
    pel_camera_angle angle = j->def.angle;
    double middle[3];
    find_middle(j, middle);
    angle.azimuth += j->def.turn * page / j->shots.page_count;
    view_camera_begin(&j->camera, &angle, j->def.up, j->page.cell_width, j->page.cell_height);
    view_camera_see(&j->camera, middle, j->around);
    view_camera_reach(&j->camera, middle, 2 * j->around);
    view_camera_fit(&j->camera, angle.zoom);
}

static pel_status draw_page(job *j, int32_t page, pel_error *error)
{
    const view_shot *shots = j->shots.shots + (size_t)page * (size_t)j->shots.cell_count;
    double start = pel_seconds();
    double before = j->summary.draw_s;
    if (j->def.turn != 0)
        turn_camera(j, page);
    view_sheet_begin(&j->page, &j->image);
    for (int32_t f = 0, bar = 0; !j->def.hide_bar && f < j->field_count; ++f) {
        if (j->fields[f].name[0] != '\0')
            view_sheet_bar(&j->page, &j->image, bar++, j->fields[f].color_map, &j->fields[f].scale);
    }
    j->summary.draw_s += pel_seconds() - start;
    pel_status status = PEL_OK;
    for (int32_t cell = 0; status == PEL_OK && cell < j->shots.cell_count; ++cell) {
        if (shots[cell].run >= 0)
            status = draw_cell(j, shots[cell], cell, error);
    }
    double taken = j->summary.draw_s - before, *least = &j->summary.least_s;
    *least = *least == 0 || taken < *least ? taken : *least;
    return status;
}

/* ---- output ---- */

static pel_status make_folder(const char *path, pel_error *error)
{
    char part[PATH_SIZE];
    for (const char *slash = path; slash != NULL && *slash != '\0';) {
        slash = strchr(slash + 1, '/');
        snprintf(part, sizeof part, "%.*s", slash != NULL ? (int)(slash - path) : (int)strlen(path), path);
        if (mkdir(part, 0777) != 0 && errno != EEXIST && errno != EISDIR) {
            pel_fail(error, PEL_BAD_FILE, "cannot make the folder: %s", strerror(errno));
            pel_fail_place(error, part, 0, 0);
            pel_fail_remedy(error, "choose another folder for the pictures");
            return PEL_BAD_FILE;
        }
    }
    return PEL_OK;
}

static pel_status write_pictures(job *j, bool folder, pel_error *error)
{
    view_writer writer;
    pel_status status = view_writer_open(&writer, j->image.width, j->image.height, error);
    if (status == PEL_OK && folder)
        status = make_folder(j->def.output, error);
    for (int32_t p = 0; status == PEL_OK && p < j->shots.page_count; ++p) {
        char path[PATH_SIZE];
        int frame = (int)j->shots.shots[(size_t)p * (size_t)j->shots.cell_count].frame;
        if (folder)
            snprintf(path, sizeof path, "%s/f%05d.png", j->def.output, frame);
        else
            snprintf(path, sizeof path, "%s", j->def.output);
        status = draw_page(j, p, error);
        if (status == PEL_OK)
            status = view_writer_add(&writer, &j->image, path, folder, error);
        j->summary.picture_count += status == PEL_OK;
    }
    pel_status ended = view_writer_close(&writer, status == PEL_OK ? error : NULL);
    j->summary.write_s = writer.seconds;
    return status == PEL_OK ? ended : status;
}

/* real time, within the limits of a smooth film */
static double film_rate(const job *j)
{
    const view_frame_selection *shots = &j->shots;
    if (j->def.frame_rate > 0 || shots->page_count < 2)
        return j->def.frame_rate > 0 ? j->def.frame_rate : 10;
    view_shot first = shots->shots[0], last = shots->shots[(size_t)(shots->page_count - 1) * (size_t)shots->cell_count];
    const view_run *run = &j->runs[first.run];
    double time = view_run_time(run, last.frame) - view_run_time(run, first.frame);
    return time > 0 ? fmin(fmax((shots->page_count - 1) / time, 10), 60) : 25;
}

static pel_status write_film(job *j, pel_error *error)
{
    view_film *film;
    pel_status status =
        view_film_create(j->def.output, j->page.width, j->page.height, film_rate(j), j->def.program, &film, error);
    if (status != PEL_OK)
        return status;
    for (int32_t p = 0; status == PEL_OK && p < j->shots.page_count; ++p) {
        status = draw_page(j, p, error);
        double start = pel_seconds();
        if (status == PEL_OK)
            status = view_film_add(film, &j->image, error);
        j->summary.write_s += pel_seconds() - start;
        j->summary.picture_count += status == PEL_OK;
    }
    pel_status ended = view_film_close(film, status == PEL_OK, status == PEL_OK ? error : NULL);
    return status == PEL_OK ? ended : status;
}

/* ---- all of it ---- */

static pel_status make_page(job *j, pel_error *error)
{
    const char *bar_titles[PEL_RENDER_FIELD_LIMIT];
    const double some[2] = {0, 1};
    int32_t bar_count = 0;
    for (int32_t f = 0; f < j->field_count; ++f) {
        shown_field *shown = &j->fields[f];
        if (shown->name[0] == '\0')
            continue;
        view_scale_make(&shown->scale, shown->name, j->def.component, shown->component_count, j->def.unit, some);
        bar_titles[bar_count++] = shown->scale.title;
    }
    bool labels = j->def.labels != NULL || j->def.input_count > 1 || j->runs[0].has_times || j->colored_count > 1;
    view_sheet_def def = {.columns = j->shots.columns,
                          .rows = j->shots.rows,
                          .width = j->def.width,
                          .height = j->def.height,
                          .background = j->def.background,
                          .title = j->def.title,
                          .bar_titles = bar_titles,
                          .bar_count = j->def.hide_bar ? 0 : bar_count,
                          .labels = labels && !j->def.hide_labels};
    return view_sheet_create(&j->page, &def, error);
}

static pel_status prepare(job *j, pel_error *error)
{
    pel_status status = name_fields(j, error);
    if (status == PEL_OK)
        status = open_runs(j, error);
    if (status == PEL_OK)
        status = view_frame_selection_create(&j->shots, &j->def, j->field_count, j->runs, error);
    if (status == PEL_OK)
        status = find_fields(j, error);
    if (status == PEL_OK)
        status = make_page(j, error);
    if (status == PEL_OK)
        status = survey(j, error);
    if (status == PEL_OK)
        status = view_image_create(&j->image, j->page.width, j->page.height, error);
    if (status == PEL_OK)
        status = view_gl_target_create(j->page.cell_width, j->page.cell_height, &j->canvas, error);
    if (status == PEL_OK)
        view_gl_target_watch(j->canvas, j->def.progress, j->def.user);
    return status;
}

static void summarize(job *j)
{
    pel_render_summary *summary = &j->summary;
    summary->width = j->page.width;
    summary->height = j->page.height;
    for (int32_t f = 0; summary->field[0] == '\0' && f < j->field_count; ++f) {
        memcpy(summary->field, j->fields[f].name, sizeof summary->field);
        memcpy(summary->range, j->fields[f].range, sizeof summary->range);
    }
    snprintf(summary->renderer, sizeof summary->renderer, "%s", view_gl_target_renderer(j->canvas));
}

static void clean(job *j)
{
    for (int32_t r = 0; j->runs != NULL && r < j->def.input_count; ++r)
        view_run_close(&j->runs[r]);
    free(j->runs);
    free(j->values);
    view_triangle_list_destroy(&j->soup);
    view_frame_selection_destroy(&j->shots);
    view_gl_target_destroy(j->canvas);
    view_image_destroy(&j->image);
    view_sheet_destroy(&j->page);
}

pel_status pel_render(const pel_render_def *def, const pel_log *log, pel_render_summary *summary, pel_error *error)
{
    if (summary != NULL)
        *summary = (pel_render_summary){0};
    pel_status status = check_def(def, error);
    if (status != PEL_OK)
        return status;
    job j = {.def = *def, .log = log};
    status = prepare(&j, error);
    view_output kind = view_output_kind(def->output);
    if (status == PEL_OK && kind == VIEW_FILM)
        status = write_film(&j, error);
    else if (status == PEL_OK)
        status = write_pictures(&j, kind == VIEW_FOLDER, error);
    if (status == PEL_OK) {
        summarize(&j);
        if (summary != NULL)
            *summary = j.summary;
    }
    clean(&j);
    return status;
}
