#include "experiment.h"

#include <pellicle/render.h>

#include <math.h>
#include <string.h>

const char *cli_experiment_path(const cli_experiment *experiment, const char *name, char *path)
{
    snprintf(path, CLI_EXPERIMENT_PATH, "%s/%s", experiment->folder, name);
    return path;
}

/* ---- runs ---- */

static pel_status run_scene(cli_experiment *experiment, const char *name, const pel_scene *scene,
                            pel_run_summary *summary)
{
    char folder[CLI_EXPERIMENT_PATH];
    pel_run_def def = pel_run_def_default();
    def.folder = cli_experiment_path(experiment, name, folder);
    if (experiment->progress != NULL)
        experiment->progress(experiment, name);
    return pel_run(scene, &def, summary, experiment->error);
}

pel_status cli_experiment_run(cli_experiment *experiment, const char *name, const char *scene,
                              const char *const *overrides, pel_run_summary *summary)
{
    int32_t count = 0;
    while (overrides != NULL && overrides[count] != NULL)
        count++;
    pel_scene *resolved;
    pel_status status =
        pel_scene_parse(name, scene, strlen(scene), overrides, count, NULL, &resolved, experiment->error);
    if (status == PEL_OK)
        status = run_scene(experiment, name, resolved, summary);
    pel_scene_destroy(resolved);
    return status;
}

/* ---- series ---- */

pel_status cli_series_read(const cli_experiment *experiment, const char *run, const char *x_name, const char *y_name,
                           cli_series *series)
{
    const char *const names[2] = {x_name, y_name};
    char name[128], path[CLI_EXPERIMENT_PATH];
    *series = (cli_series){0};
    snprintf(name, sizeof name, "%s/%s", run, pel_run_file_name(PEL_RUN_SERIES));
    pel_status status =
        pel_series_read(cli_experiment_path(experiment, name, path), names, 2, &series->read, experiment->error);
    if (status != PEL_OK)
        return status;
    series->count = (int)series->read->row_count;
    series->x = series->read->values;
    series->y = series->x + series->count;
    if (series->count == 0 || isnan(series->x[0]) || isnan(series->y[0]))
        return pel_fail(experiment->error, PEL_BAD_FORMAT, "series.csv lacks a column");
    return PEL_OK;
}

void cli_series_free(cli_series *series)
{
    pel_series_destroy(series->read);
    *series = (cli_series){0};
}

/* ---- plots and pictures ---- */

/* the name of the next image of a kind: "plot.svg", "plot-2.svg", ... */
static const char *add_image(cli_experiment *experiment, const char *kind, const char *ending, int *count,
                             const char *caption)
{
    if (experiment->image_count == CLI_EXPERIMENT_IMAGES)
        return NULL;
    cli_image *image = &experiment->images[experiment->image_count++];
    ++*count;
    if (*count == 1)
        snprintf(image->file, sizeof image->file, "%s.%s", kind, ending);
    else
        snprintf(image->file, sizeof image->file, "%s-%d.%s", kind, *count, ending);
    snprintf(image->caption, sizeof image->caption, "%s", caption);
    return image->file;
}

pel_status cli_experiment_plot(cli_experiment *experiment, const cli_plot *plot)
{
    char path[CLI_EXPERIMENT_PATH];
    const char *file = add_image(experiment, "plot", "svg", &experiment->plot_count, plot->title);
    if (file == NULL)
        return PEL_OK;
    return cli_plot_write(cli_experiment_path(experiment, file, path), plot, experiment->error);
}

#ifdef PELLICLE_VIEW

/* the last frame that all runs have: one may end before the others */
static int last_common_frame(const char *const *runs, int count)
{
    int last = INT32_MAX;
    for (int i = 0; i < count; i++) {
        pel_frames *frames;
        pel_error error;
        if (!cli_is_folder(runs[i]) || pel_frames_open(runs[i], &frames, &error) != PEL_OK)
            continue;
        last = frames->frame_count - 1 < last ? frames->frame_count - 1 : last;
        pel_frames_close(frames);
    }
    return last;
}

pel_status cli_experiment_draw(cli_experiment *experiment, const cli_picture *picture)
{
    static char paths[CLI_PICTURE_RUNS][CLI_EXPERIMENT_PATH];
    char output[CLI_EXPERIMENT_PATH];
    const char *inputs[CLI_PICTURE_RUNS];
    pel_frame_range frames[CLI_PICTURE_FRAMES];
    const char *file = add_image(experiment, "picture", "png", &experiment->picture_count, picture->caption);
    if (file == NULL)
        return PEL_OK;
    for (int i = 0; i < picture->run_count; i++)
        inputs[i] = cli_experiment_path(experiment, picture->runs[i], paths[i]);
    int last = last_common_frame(inputs, picture->run_count), frame_count = 0;
    for (int i = 0; i < picture->frame_count && (i == 0 || picture->frames[i - 1] < last); i++) {
        int frame = picture->frames[i] < last ? picture->frames[i] : last;
        frames[frame_count++] = (pel_frame_range){frame, frame, 1};
    }
    pel_render_def def = pel_render_def_default();
    def.inputs = inputs;
    def.input_count = picture->run_count;
    def.labels = picture->labels;
    def.output = cli_experiment_path(experiment, file, output);
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

pel_status cli_experiment_draw(cli_experiment *experiment, const cli_picture *picture)
{
    (void)experiment;
    (void)picture;
    (void)add_image;
    return PEL_OK;
}

#endif
