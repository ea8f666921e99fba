#include "papers/lab/experiment.h"

#include "papers/lab/file.h"
#include "papers/lab/stored.h"
#include "papers/lab/trial.h"

#include <pellicle/mesh_io.h>
#include <pellicle/render.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

void *lab_add_item(lab_experiment *experiment, void **items, int *count, size_t size)
{
    char *grown = realloc(*items, ((size_t)*count + 1) * size);
    if (grown == NULL) {
        experiment->is_incomplete = true;
        return NULL;
    }
    *items = grown;
    return memset(grown + (size_t)(*count)++ * size, 0, size);
}

/* ---- tables ---- */

static lab_row *add_row(lab_experiment *experiment, const char *cells)
{
    void *rows = experiment->rows;
    lab_row *row = lab_add_item(experiment, &rows, &experiment->row_count, sizeof *row);
    experiment->rows = rows;
    if (row != NULL)
        snprintf(row->cells, sizeof row->cells, "%s", cells);
    return row;
}

void lab_begin_table(lab_experiment *experiment, const char *caption, const char *columns)
{
    lab_row *row = add_row(experiment, columns);
    if (row == NULL)
        return;
    row->is_head = true;
    snprintf(row->caption, sizeof row->caption, "%s", caption);
}

void lab_add_row(lab_experiment *experiment, const char *cells)
{
    add_row(experiment, cells);
}

/* ---- numbers.csv ---- */

static void write_findings(FILE *file, const void *context)
{
    const lab_experiment *experiment = context;
    fputs("name,value,relation,expected,tolerance,judged,holds,origin,source,claim,verdict,construction\n", file);
    for (int i = 0; i < experiment->finding_count; i++) {
        const lab_finding *f = &experiment->findings[i];
        const lab_claim *claim = &experiment->claims[f->claim];
        fprintf(file, "\"%s\",%.17g,%s,", f->name, f->value, lab_relation_sign(f->relation));
        if (!isnan(f->expected))
            fprintf(file, "%.17g", f->expected);
        fprintf(file, ",%.17g,%d,%d,%s,\"%s\",\"%s\",%s,%d\n", f->tolerance, f->relation != LAB_TOLD,
                lab_finding_holds(f), lab_origin_name(claim->origin), f->source, claim->says,
                lab_verdict_name(lab_claim_verdict(experiment, f->claim)), claim->by_construction);
    }
}

pel_status lab_run_case(const lab_case *which, lab_experiment *experiment)
{
    char path[LAB_PATH_SIZE];
    double begin = pel_seconds();
    experiment->name = which->name;
    experiment->doc = which->doc;
    experiment->group = which->group;
    experiment->place = which->place;
    /* a case without its own claims is judged by its subject */
    if (strcmp(which->group, "own") == 0)
        lab_begin_claim(experiment, which->origin, which->doc, NULL);
    pel_status status = which->run(experiment);
    if (status == PEL_OK && !experiment->given_bodies) {
        const lab_stored *numbers;
        int count = lab_stored_numbers(&numbers);
        lab_judge_stored(experiment, numbers, count);
    }
    experiment->seconds = pel_seconds() - begin;
    if (status == PEL_OK && experiment->is_incomplete)
        status = pel_fail_memory(experiment->error);
    if (status == PEL_OK)
        status = lab_write_file(lab_path(experiment, "numbers.csv", path), "numbers", write_findings, experiment,
                                experiment->error);
    return status;
}

void lab_clear(lab_experiment *experiment)
{
    free(experiment->claims);
    free(experiment->findings);
    free(experiment->images);
    free(experiment->rows);
    *experiment = (lab_experiment){0};
}

const char *lab_path(const lab_experiment *experiment, const char *name, char *path)
{
    snprintf(path, LAB_PATH_SIZE, "%s/%s", experiment->folder, name);
    return path;
}

/* ---- runs ---- */

void lab_tell_run(const lab_experiment *experiment, const char *run)
{
    if (experiment->progress != NULL)
        experiment->progress(experiment->user, experiment->name, run);
}

static pel_status run_scene(lab_experiment *experiment, const char *name, const pel_scene *scene,
                            pel_run_summary *summary)
{
    char folder[LAB_PATH_SIZE];
    pel_run_def def = pel_run_def_default();
    def.folder = lab_path(experiment, name, folder);
    def.overwrite = true;
    lab_tell_run(experiment, name);
    return pel_run(scene, &def, summary, experiment->error);
}

pel_status lab_run(lab_experiment *experiment, const char *name, const char *scene, const char *const *overrides,
                   pel_run_summary *summary)
{
    pel_scene *resolved;
    pel_status status = pel_scene_parse(name, scene, strlen(scene), overrides, lab_count_overrides(overrides), NULL,
                                        &resolved, experiment->error);
    if (status == PEL_OK)
        status = run_scene(experiment, name, resolved, summary);
    pel_scene_destroy(resolved);
    return status;
}

pel_status lab_read_final(const lab_experiment *experiment, const char *run, pel_mesh **mesh)
{
    char name[128], path[LAB_PATH_SIZE];
    snprintf(name, sizeof name, "%s/%s", run, pel_run_file_name(PEL_RUN_FINAL));
    return pel_mesh_read(lab_path(experiment, name, path), PEL_FORMAT_AUTO, NULL, mesh, experiment->error);
}

/* ---- series ---- */

pel_status lab_read_series(const lab_experiment *experiment, const char *run, const char *x_name, const char *y_name,
                           lab_series *series)
{
    const char *const names[2] = {x_name, y_name};
    char name[128], path[LAB_PATH_SIZE];
    *series = (lab_series){0};
    snprintf(name, sizeof name, "%s/%s", run, pel_run_file_name(PEL_RUN_SERIES));
    pel_status status = pel_series_read(lab_path(experiment, name, path), names, 2, &series->read, experiment->error);
    if (status != PEL_OK)
        return status;
    series->count = (int)series->read->row_count;
    series->x = series->read->values;
    series->y = series->x + series->count;
    if (series->count == 0 || isnan(series->x[0]) || isnan(series->y[0]))
        return pel_fail(experiment->error, PEL_BAD_FORMAT, "series.csv lacks a column");
    return PEL_OK;
}

void lab_free_series(lab_series *series)
{
    pel_series_destroy(series->read);
    *series = (lab_series){0};
}

/* ---- plots and pictures ---- */

/* the name of the next image of a kind: "plot.svg", "plot-2.svg", ...; null when memory is out */
static const char *add_image(lab_experiment *experiment, const char *kind, const char *ending, int *count,
                             const char *caption)
{
    void *images = experiment->images;
    lab_image *image = lab_add_item(experiment, &images, &experiment->image_count, sizeof *image);
    experiment->images = images;
    if (image == NULL)
        return NULL;
    ++*count;
    if (*count == 1)
        snprintf(image->file, sizeof image->file, "%s.%s", kind, ending);
    else
        snprintf(image->file, sizeof image->file, "%s-%d.%s", kind, *count, ending);
    snprintf(image->caption, sizeof image->caption, "%s", caption);
    return image->file;
}

pel_status lab_add_plot(lab_experiment *experiment, const lab_plot *plot)
{
    char path[LAB_PATH_SIZE];
    const char *file = add_image(experiment, "plot", "svg", &experiment->plot_count, plot->title);
    if (file == NULL)
        return pel_fail_memory(experiment->error);
    return lab_write_plot(lab_path(experiment, file, path), plot, experiment->error);
}

pel_status lab_plot_runs(lab_experiment *experiment, const lab_run_plot *plot)
{
    lab_series series[LAB_CURVES] = {{0}};
    int count = plot->run_count < LAB_CURVES ? plot->run_count : LAB_CURVES;
    lab_plot drawn = {.title = plot->title, .x_name = plot->x_name, .y_name = plot->y_name, .curve_count = count};
    pel_status status = PEL_OK;
    for (int i = 0; status == PEL_OK && i < count; i++) {
        status = lab_read_series(experiment, plot->runs[i], plot->x_column, plot->y_column, &series[i]);
        drawn.curves[i] = (lab_curve){plot->labels[i], series[i].x, series[i].y, series[i].count, false};
    }
    if (status == PEL_OK)
        status = lab_add_plot(experiment, &drawn);
    for (int i = 0; i < count; i++)
        lab_free_series(&series[i]);
    return status;
}

#ifdef PELLICLE_VIEW

/* the last frame that all runs have: one may end before the others */
static int last_common_frame(const char *const *runs, int count)
{
    int last = INT32_MAX;
    for (int i = 0; i < count; i++) {
        pel_frames *frames;
        pel_error error;
        if (pel_frames_open(runs[i], &frames, &error) != PEL_OK)
            continue;
        last = frames->frame_count - 1 < last ? frames->frame_count - 1 : last;
        pel_frames_close(frames);
    }
    return last;
}

pel_status lab_add_picture(lab_experiment *experiment, const lab_picture *picture)
{
    static char paths[LAB_PICTURE_RUNS][LAB_PATH_SIZE];
    char output[LAB_PATH_SIZE];
    const char *inputs[LAB_PICTURE_RUNS];
    pel_frame_range frames[LAB_PICTURE_FRAMES];
    const char *file = add_image(experiment, "picture", "png", &experiment->picture_count, picture->caption);
    if (file == NULL)
        return pel_fail_memory(experiment->error);
    for (int i = 0; i < picture->run_count; i++)
        inputs[i] = lab_path(experiment, picture->runs[i], paths[i]);
    int last = last_common_frame(inputs, picture->run_count), frame_count = 0;
    for (int i = 0; i < picture->frame_count && (i == 0 || picture->frames[i - 1] < last); i++) {
        int frame = picture->frames[i] < last ? picture->frames[i] : last;
        frames[frame_count++] = (pel_frame_range){frame, frame, 1};
    }
    pel_render_def def = pel_render_def_default();
    def.inputs = inputs;
    def.input_count = picture->run_count;
    def.labels = picture->labels;
    def.output = lab_path(experiment, file, output);
    def.frames = frames;
    def.frame_range_count = frame_count;
    def.field = picture->field;
    def.unit = picture->unit;
    def.component = picture->component - 1;
    def.fixed_range = picture->range[0] < picture->range[1];
    def.range[0] = picture->range[0];
    def.range[1] = picture->range[1];
    def.arrows = picture->arrows;
    def.angle.azimuth = picture->azimuth;
    def.angle.elevation = picture->elevation;
    def.edges = picture->edges;
    def.frame_numbers = !picture->times;
    if (picture->columns > 0) {
        def.columns = picture->columns;
        def.rows = (picture->run_count * frame_count + picture->columns - 1) / picture->columns;
    }
    return pel_render(&def, NULL, NULL, experiment->error);
}

#else

pel_status lab_add_picture(lab_experiment *experiment, const lab_picture *picture)
{
    (void)experiment;
    (void)picture;
    (void)add_image;
    return PEL_OK;
}

#endif
