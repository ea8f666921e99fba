#include "experiment.h"

#include <pellicle/render.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

const char *cli_experiment_path(const cli_experiment *experiment, const char *name, char *path)
{
    snprintf(path, CLI_EXPERIMENT_PATH, "%s/%s", experiment->folder, name);
    return path;
}

/* ---- numbers ---- */

static void add(cli_experiment *experiment, const char *name, double value, double expected, double tolerance,
                const char *source)
{
    if (experiment->finding_count == CLI_EXPERIMENT_NUMBERS)
        return;
    cli_finding *finding = &experiment->findings[experiment->finding_count++];
    *finding = (cli_finding){.value = value, .expected = expected, .tolerance = tolerance, .source = source};
    snprintf(finding->name, sizeof finding->name, "%s", name);
}

void cli_experiment_check(cli_experiment *experiment, const char *name, double value, double expected, double tolerance,
                          const char *source)
{
    add(experiment, name, value, expected, tolerance, source);
}

void cli_experiment_limit(cli_experiment *experiment, const char *name, double value, double limit, const char *source)
{
    /* half way between 0 and the limit, and as far as that from it */
    add(experiment, name, value, limit, -1, source);
}

void cli_experiment_tell(cli_experiment *experiment, const char *name, double value, double expected,
                         const char *source)
{
    add(experiment, name, value, expected, (double)INFINITY, source);
}

bool cli_finding_holds(const cli_finding *finding)
{
    if (finding->tolerance < 0)
        return finding->value <= finding->expected;
    return isinf(finding->tolerance) || fabs(finding->value - finding->expected) <= finding->tolerance;
}

/* ---- runs ---- */

static pel_status run_scene(cli_experiment *experiment, const char *name, const pel_scene *scene,
                            pel_run_summary *summary)
{
    char folder[CLI_EXPERIMENT_PATH];
    pel_run_def def = pel_run_def_default();
    def.folder = cli_experiment_path(experiment, name, folder);
    if (!experiment->quiet)
        fprintf(stderr, "  run %s\n", name);
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

pel_status cli_experiment_plot(const cli_experiment *experiment, const cli_plot *plot)
{
    char path[CLI_EXPERIMENT_PATH];
    return cli_plot_write(cli_experiment_path(experiment, "plot.svg", path), plot, experiment->error);
}

#ifdef PELLICLE_VIEW

pel_status cli_experiment_draw(const cli_experiment *experiment, const cli_picture *picture)
{
    char paths[4][CLI_EXPERIMENT_PATH], output[CLI_EXPERIMENT_PATH];
    const char *inputs[4];
    pel_frame_range frames[4];
    for (int i = 0; i < picture->run_count; i++)
        inputs[i] = cli_experiment_path(experiment, picture->runs[i], paths[i]);
    for (int i = 0; i < picture->frame_count; i++)
        frames[i] = (pel_frame_range){picture->frames[i], picture->frames[i], 1};
    pel_render_def def = pel_render_def_default();
    def.inputs = inputs;
    def.input_count = picture->run_count;
    def.labels = picture->labels;
    def.output = cli_experiment_path(experiment, "picture.png", output);
    def.frames = frames;
    def.frame_range_count = picture->frame_count;
    def.angle.azimuth = picture->azimuth;
    def.angle.elevation = picture->elevation;
    def.edges = picture->edges;
    return pel_render(&def, NULL, NULL, experiment->error);
}

#else

pel_status cli_experiment_draw(const cli_experiment *experiment, const cli_picture *picture)
{
    (void)experiment;
    (void)picture;
    return PEL_OK;
}

#endif
