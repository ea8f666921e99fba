#include "commands.h"
#include "diagnostics.h"
#include "stop.h"

#include <pellicle/frames.h>
#include <pellicle/run.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

typedef enum progress_form { PROGRESS_NONE, PROGRESS_BAR, PROGRESS_PLAIN } progress_form;

const char *cli_progress_names(int index)
{
    static const char *const names[] = {"none", "bar", "plain", NULL};
    return names[index];
}

/* the progress line of a terminal, or lines of a log */
typedef struct display {
    progress_form form;
    bool quiet;
    double last;               /* s, when it was written; 0 = never */
    double began;              /* s, when the step at hand began */
    pel_run_progress progress; /* before this step */
} display;

/* s between two of them */
static double progress_interval(const display *d)
{
    return d->form == PROGRESS_BAR ? 0.1 : 1;
}

/* s that a step takes before the line says so, and then between two lines of a log */
#define LONG_STEP 1.0
#define LONG_STEP_INTERVAL 5.0

/* a step that takes long goes on */
static void print_long_step(const display *d, double seconds)
{
    const pel_run_progress *p = &d->progress;
    fprintf(stderr, "%sstep %lld/%lld  %.4g s  step %lld takes %.0f s so far%s",
            d->form == PROGRESS_BAR ? "\r\033[K" : "", (long long)p->step, (long long)p->step_total, p->time,
            (long long)p->step + 1, seconds, d->form == PROGRESS_BAR ? "" : "\n");
    fflush(stderr);
}

static void print_progress(const display *d, const pel_run_progress *p)
{
    fprintf(stderr, "%sstep %lld/%lld  %.4g s  %.0f steps/s", d->form == PROGRESS_BAR ? "\r\033[K" : "",
            (long long)p->step, (long long)p->step_total, p->time, p->steps_per_second);
    if (p->remaining >= 0.0) {
        long left = (long)(p->remaining + 0.5);
        fprintf(stderr, "  ETA %ld:%02ld", left / 60, left % 60);
    }
    fprintf(stderr, "  residual %.3g N%s", p->max_force, d->form == PROGRESS_BAR ? "" : "\n");
    fflush(stderr);
}

static bool show_progress(void *user, const pel_run_progress *progress)
{
    display *d = user;
    double now = pel_seconds();
    d->began = now;
    d->progress = *progress;
    /* nothing is lost if the program ends before this point */
    cli_catch_stop(d->quiet                  ? ""
                   : d->form == PROGRESS_BAR ? "\r\033[Kstopping; the same again ends at once\n"
                                             : "stopping; the same again ends at once\n");
    bool first_or_last = progress->step == 0 || progress->step == progress->step_total;
    if (d->form != PROGRESS_NONE &&
        (now - d->last > progress_interval(d) || (d->form == PROGRESS_PLAIN && first_or_last))) {
        print_progress(d, progress);
        d->last = now;
    }
    return true;
}

/* asked often in long steps */
static bool is_wanted(void *user)
{
    display *d = user;
    const double now = d->form != PROGRESS_NONE && d->began > 0 ? pel_seconds() : 0, seconds = now - d->began;
    if (now > 0 && seconds > LONG_STEP && now - d->last > (d->form == PROGRESS_BAR ? LONG_STEP : LONG_STEP_INTERVAL)) {
        print_long_step(d, seconds);
        d->last = now;
    }
    return !cli_stop_asked();
}

/* --progress, or a default that suits standard error */
static progress_form choose_progress(const cli_call *call, bool quiet)
{
    const char *name = cli_value(call, "progress");
    for (int i = 0; name != NULL && cli_progress_names(i) != NULL; ++i)
        if (strcmp(name, cli_progress_names(i)) == 0)
            return (progress_form)i;
    return !quiet && isatty(STDERR_FILENO) != 0 ? PROGRESS_BAR : PROGRESS_NONE;
}

/* warnings come before and after the steps; they replace the progress line */
static void write_warning(void *user, const char *text)
{
    const display *d = user;
    fprintf(stderr, "%swarning: %s\n", d->form == PROGRESS_BAR && d->last > 0.0 ? "\r\033[K" : "", text);
}

/* -o, else the folder of the checkpoint to go on from, else results/ and the scene's name */
static bool choose_folder(const cli_call *call, char folder[PEL_RUN_PATH_SIZE])
{
    const char *given = cli_value(call, "output"), *resume = cli_value(call, "resume");
    const char *path = given != NULL ? given : resume != NULL ? resume : call->arguments[0];
    const char *slash = strrchr(path, '/');
    int length;
    if (given != NULL) {
        length = snprintf(folder, PEL_RUN_PATH_SIZE, "%s", given);
    } else if (resume != NULL) {
        length = snprintf(folder, PEL_RUN_PATH_SIZE, "%.*s", slash > path ? (int)(slash - path) : 1,
                          slash != NULL ? path : ".");
    } else {
        const char *name = slash != NULL ? slash + 1 : path, *dot = strrchr(name, '.');
        /* "." and ".." are no names */
        if (dot != NULL && strspn(name, ".") >= (size_t)(dot - name))
            dot = NULL;
        length = snprintf(folder, PEL_RUN_PATH_SIZE, "results/%.*s",
                          dot != NULL ? (int)(dot - name) : (int)strlen(name), name);
    }
    if (length < 0 || length >= PEL_RUN_PATH_SIZE)
        return cli_complain("the path of the output folder is too long. choose a shorter one with -o"), false;
    while (length > 1 && folder[length - 1] == '/')
        folder[--length] = '\0';
    return true;
}

/* existing files of the results, and their use */
static void print_files(const char *folder)
{
    static const struct {
        pel_run_file file;
        const char *use;
    } files[] = {
        {PEL_RUN_SERIES, "the measures over time, one row a frame"},
        {PEL_RUN_FINAL, "the surface at the end: meshlab, blender or paraview"},
        {PEL_RUN_SUMMARY, "the run in a few numbers"},
        {PEL_RUN_SCENE, "the scene with every default written out"},
    };
    printf("results in %s:\n", folder);
    const char *frames = pel_run_file_name(PEL_RUN_FRAMES);
    printf("  %-13s the moving surface: paraview %s/%s\n", frames, folder, frames);
    for (size_t i = 0; i < sizeof files / sizeof *files; ++i) {
        const char *name = pel_run_file_name(files[i].file);
        char path[PEL_RUN_PATH_SIZE + 16];
        snprintf(path, sizeof path, "%s/%s", folder, name);
        if (access(path, F_OK) == 0)
            printf("  %-13s %s\n", name, files[i].use);
    }
}

/* the first line: an analysis has modes, not a time */
static void print_progress_made(const pel_scene *scene, const pel_run_summary *s)
{
    pel_analysis analysis = scene->sim.solver.analysis;
    if (analysis == PEL_ANALYSIS_NONE)
        printf("%s: %lld steps, %lld frames, %.6g s simulated in %.3g s (stepping alone: %.0f steps/s)\n", s->status,
               (long long)s->steps, (long long)s->frames, s->time_simulated, s->wall_s, s->steps_per_second);
    else
        printf("%s: %d %s in %.3g s, a frame each\n", s->status, (int)s->mode_count,
               analysis == PEL_ANALYSIS_MODAL ? "frequencies" : "load factors", s->wall_s);
}

static void print_summary(const cli_call *call, const pel_scene *scene, const char *folder, const pel_run_summary *s)
{
    print_progress_made(scene, s);
    printf("  largest displacement   %.6g m\n", s->max_displacement);
    printf("  displacement at end    %.6g m\n", s->residual_displacement);
    if (scene->sim.tool_count > 0)
        printf("  largest tool force     %.6g N\n", s->max_tool_force);
    if (isfinite(s->volume_ratio_final))
        printf("  volume at end          %.6g m3, %.6g of that at rest\n", s->volume_final, s->volume_ratio_final);
    else if (s->volume_final != 0)
        printf("  volume at end          %.6g m3\n", s->volume_final);
    if (s->self_intersections_final >= 0)
        printf("  self-intersections     %lld pairs of triangles at end\n", (long long)s->self_intersections_final);
    for (int m = 0; m < s->mode_count; ++m)
        if (scene->sim.solver.analysis == PEL_ANALYSIS_MODAL)
            printf("  mode %-3d               %.6g Hz\n", m + 1, s->modes[m]);
        else
            printf("  mode %-3d               load factor %.6g\n", m + 1, s->modes[m]);
    if (s->alpha > 0.0)
        printf("  alpha                  %.6g (stable below %.6g)\n", s->alpha, s->alpha_limit);
    print_files(folder);
    bool can_go_on = strcmp(s->status, "done") == 0 || strcmp(s->status, "stopped") == 0;
    if (can_go_on && s->checkpoint[0] != '\0') {
        /* the scene as it was with --set */
        char resolved[PEL_RUN_PATH_SIZE + 16];
        snprintf(resolved, sizeof resolved, "%s/%s", folder, pel_run_file_name(PEL_RUN_SCENE));
        printf("continue with: pellicle run %s --resume %s\n", cli_has(call, "set") ? resolved : call->arguments[0],
               s->checkpoint);
    }
}

/* the summary.json that the run wrote, on stdout */
static bool copy_summary(const char *folder)
{
    char path[PEL_RUN_PATH_SIZE + 16];
    snprintf(path, sizeof path, "%s/%s", folder, pel_run_file_name(PEL_RUN_SUMMARY));
    FILE *file = fopen(path, "rb");
    if (file == NULL)
        return false;
    char bytes[4096];
    size_t count;
    while ((count = fread(bytes, 1, sizeof bytes, file)) > 0)
        fwrite(bytes, 1, count, stdout);
    fclose(file);
    return true;
}

/* a run that was refused, or that could not even write its summary */
static void write_refusal(const pel_error *error)
{
    pel_json json = {.file = stdout, .style = PEL_JSON_INDENTED};
    pel_json_open(&json, NULL, '{');
    pel_json_text(&json, "status", "refused");
    cli_write_error(&json, error);
    pel_json_close(&json, '}');
}

static int run_scene(const cli_call *call, const pel_scene *scene, const char *folder)
{
    bool as_json = cli_has(call, "json"), quiet = as_json || cli_has(call, "quiet");
    display d = {.form = choose_progress(call, quiet), .quiet = quiet};
    const pel_log warnings = {.write = write_warning, .user = &d};
    pel_run_def def = pel_run_def_default();
    def.folder = folder;
    def.max_frames = cli_count(call, "frames");
    def.thread_count = cli_count(call, "threads");
    def.resume = cli_value(call, "resume");
    def.overwrite = cli_has(call, "overwrite");
    def.progress = show_progress;
    def.wanted = is_wanted;
    def.user = &d;
    def.log = quiet ? NULL : &cli_notes;
    def.warnings = &warnings;
    pel_run_summary summary;
    pel_error error;
    pel_status status = pel_run(scene, &def, &summary, &error);
    if (d.form == PROGRESS_BAR && d.last > 0.0)
        fputs("\r\033[K", stderr);
    bool started = summary.status[0] != '\0';
    if (status != PEL_OK) {
        cli_name_file(&error, call->arguments[0]);
        cli_report(&error);
    }
    if (as_json && !(started && copy_summary(folder)))
        write_refusal(&error);
    else if (started && !quiet)
        print_summary(call, scene, folder, &summary);
    if (status == PEL_OK)
        return cli_has(call, "strict") && summary.warning_count > 0 ? CLI_FAILED : CLI_DONE;
    return started ? CLI_FAILED : CLI_BAD_INPUT;
}

static int load_and_run(const cli_call *call, const char *const *settings, int setting_count, const char *folder)
{
    bool as_json = cli_has(call, "json"), quiet = as_json || cli_has(call, "quiet");
    pel_scene *scene = NULL;
    pel_error error;
    int status;
    if (pel_scene_load(call->arguments[0], settings, setting_count, quiet ? NULL : &cli_notes, &scene, &error) ==
        PEL_OK) {
        status = run_scene(call, scene, folder);
    } else {
        cli_suggest_scene(&error, call->arguments[0]);
        cli_name_file(&error, call->arguments[0]);
        status = cli_report(&error);
        if (as_json)
            write_refusal(&error);
    }
    pel_scene_destroy(scene);
    return status;
}

int cli_run(const cli_call *given)
{
    char folder[PEL_RUN_PATH_SIZE], scene[PEL_RUN_PATH_SIZE];
    cli_call named = *given;
    const cli_call *call = &named;
    const char *path = named.arguments[0] = cli_scene_path(scene, sizeof scene, given->arguments[0]);
    if (pel_mesh_format_of_path(path) != PEL_FORMAT_AUTO)
        return cli_complain("'%s' is a mesh, a run needs a scene. write one that names it: mesh: { file: %s }", path,
                            path);
    if (!choose_folder(call, folder))
        return CLI_BAD_INPUT;
    const char **settings = calloc((size_t)call->given_count + 1, sizeof *settings);
    if (settings == NULL) {
        cli_complain("out of memory");
        return CLI_FAILED;
    }
    int status = load_and_run(call, settings, cli_values(call, "set", settings), folder);
    free(settings);
    return status;
}
