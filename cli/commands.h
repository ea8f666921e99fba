/* The commands; each returns the exit status. table.c lists them. */
#ifndef PELLICLE_CLI_COMMANDS_H
#define PELLICLE_CLI_COMMANDS_H

#include "options.h"

int cli_run(const cli_call *call);
int cli_live(const cli_call *call);
int cli_check(const cli_call *call);
int cli_info(const cli_call *call);
int cli_measure(const cli_call *call);
int cli_shape(const cli_call *call);
int cli_subdivide(const cli_call *call);
int cli_convert(const cli_call *call);
int cli_render(const cli_call *call);
int cli_plot(const cli_call *call);
int cli_fields(const cli_call *call);
int cli_report_page(const cli_call *call);
int cli_reproduce(const cli_call *call);
int cli_sweep(const cli_call *call);
int cli_calibrate(const cli_call *call);
int cli_bench(const cli_call *call);
int cli_presets(const cli_call *call);
int cli_reference(const cli_call *call);
int cli_schema(const cli_call *call);
int cli_completion(const cli_call *call);
int cli_help(const cli_call *call);

/* additions to help pages */
void cli_shape_help(FILE *file);
void cli_reproduce_help(FILE *file);
void cli_bench_help(FILE *file);

/* names for CLI_WORD values */
cli_words cli_shape_names;
cli_words cli_format_names;
cli_words cli_export_names;
cli_words cli_experiment_names;
cli_words cli_bench_names;
cli_words cli_color_map_names;
cli_words cli_component_names;
cli_words cli_background_names;
cli_words cli_axis_names;
cli_words cli_shell_names;
cli_words cli_progress_names;

/* keys for CLI_SETTING values, one a line */
void cli_print_shape_keys(FILE *file);
void cli_print_scene_keys(FILE *file);

#endif
