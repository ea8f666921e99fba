#include "commands.h"
#include "experiment.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static const cli_experiment_case *const cases[] = {
    &cli_figure_4,    &cli_figure_6_7,   &cli_figure_8,         &cli_figure_9,       &cli_table_1,
    &cli_b_figure_1,  &cli_b_figure_2,   &cli_b_figure_5,       &cli_b_figure_6,     &cli_b_figure_8,
    &cli_b_figure_9,  &cli_b_figure_10,  &cli_b_figure_11,      &cli_b_figure_12,    &cli_b_figure_13,
    &cli_b_figure_14, &cli_b_figure_15,  &cli_b_figure_16_18,   &cli_b_figure_19_20, &cli_b_table_2,
    &cli_accuracy,    &cli_shell_checks, &cli_shell_refinement, &cli_validation,
};

enum { CASE_COUNT = sizeof cases / sizeof *cases };

const char *cli_experiment_names(int index)
{
    return index < CASE_COUNT ? cases[index]->name : NULL;
}

static void print_cases(FILE *file)
{
    for (int i = 0; i < CASE_COUNT; ++i)
        fprintf(file, "  %-14s %s: %s\n", cases[i]->name, cases[i]->group, cases[i]->doc);
}

void cli_reproduce_help(FILE *file)
{
    fputs("\nexperiments:\n", file);
    print_cases(file);
}

/* makes a folder with its parents */
static pel_status make_folder(char *path, pel_error *error)
{
    for (char *slash = path + 1;; slash++) {
        if (*slash != '/' && *slash != '\0')
            continue;
        char kept = *slash;
        *slash = '\0';
        bool made = mkdir(path, 0777) == 0 || errno == EEXIST;
        *slash = kept;
        if (!made) {
            pel_fail(error, PEL_BAD_FILE, "cannot make the folder");
            cli_name_file(error, path);
            return PEL_BAD_FILE;
        }
        if (kept == '\0')
            return PEL_OK;
    }
}

/* ---- progress: one line that is written over on a terminal, else a line for each run ---- */

static struct {
    int number, count; /* index of the experiment, and number of those that run */
    double begin;
} at;

static void tell_progress(const cli_experiment *experiment, const char *run)
{
    int seconds = (int)(pel_seconds() - at.begin);
    bool terminal = isatty(STDERR_FILENO) != 0;
    fprintf(stderr, "%s%2d of %d, %d:%02d  %s: %s%s", terminal ? "\r\033[K" : "  ", at.number, at.count, seconds / 60,
            seconds % 60, experiment->name, run, terminal ? "" : "\n");
}

static void end_progress(void)
{
    if (isatty(STDERR_FILENO) != 0)
        fputs("\r\033[K", stderr);
}

/* ---- results ---- */

static const char *const relations[] = {"beside", "=", "<=", ">="};

static void print_findings(const cli_experiment *experiment, int claim)
{
    for (int i = 0; i < experiment->finding_count; i++) {
        const cli_finding *finding = &experiment->findings[i];
        if (finding->claim != claim)
            continue;
        printf("    %-6s %-58s %12.6g",
               finding->relation == CLI_TOLD ? ""
               : cli_finding_holds(finding)  ? "ok"
                                             : "NOT OK",
               finding->name, finding->value);
        if (!isnan(finding->expected))
            printf("  %s %.6g", relations[finding->relation], finding->expected);
        if (finding->relation == CLI_EQUAL && finding->tolerance > 0)
            printf(" +- %.2g", finding->tolerance);
        printf("%s%s%s\n", finding->source[0] != '\0' ? " (" : "", finding->source,
               finding->source[0] != '\0' ? ")" : "");
    }
}

static void print_claims(const cli_experiment *experiment)
{
    char text[512];
    for (int i = 0; i < experiment->claim_count; i++) {
        printf("  %s: %s\n    %s\n", cli_origin_name(experiment->claims[i].origin), experiment->claims[i].says,
               cli_claim_text(experiment, i, text, sizeof text));
        print_findings(experiment, i);
    }
}

static pel_status write_findings(const cli_experiment *experiment)
{
    char path[CLI_EXPERIMENT_PATH];
    FILE *file = fopen(cli_experiment_path(experiment, "numbers.csv", path), "w");
    if (file == NULL) {
        pel_fail(experiment->error, PEL_BAD_FILE, "cannot write the numbers");
        cli_name_file(experiment->error, path);
        return PEL_BAD_FILE;
    }
    fputs("name,value,relation,expected,tolerance,judged,holds,origin,source,claim,verdict\n", file);
    for (int i = 0; i < experiment->finding_count; i++) {
        const cli_finding *f = &experiment->findings[i];
        const cli_claim *claim = &experiment->claims[f->claim];
        fprintf(file, "\"%s\",%.17g,%s,", f->name, f->value, relations[f->relation]);
        if (!isnan(f->expected))
            fprintf(file, "%.17g", f->expected);
        fprintf(file, ",%.17g,%d,%d,%s,\"%s\",\"%s\",%s\n", f->tolerance, f->relation != CLI_TOLD, cli_finding_holds(f),
                cli_origin_name(claim->origin), f->source, claim->says,
                cli_verdict_name(cli_claim_verdict(experiment, f->claim)));
    }
    bool whole = ferror(file) == 0;
    return fclose(file) == 0 && whole
               ? PEL_OK
               : pel_fail(experiment->error, PEL_BAD_FILE, "the numbers could not be written completely");
}

static void write_numbers(cli_json *json, const cli_experiment *experiment)
{
    cli_json_open(json, "numbers", '[');
    for (int i = 0; i < experiment->finding_count; i++) {
        const cli_finding *f = &experiment->findings[i];
        cli_json_open(json, NULL, '{');
        cli_json_text(json, "name", f->name);
        cli_json_number(json, "value", f->value);
        cli_json_text(json, "relation", relations[f->relation]);
        cli_json_number(json, "expected", f->expected);
        cli_json_number(json, "tolerance", f->tolerance);
        cli_json_bool(json, "judged", f->relation != CLI_TOLD);
        cli_json_bool(json, "holds", cli_finding_holds(f));
        cli_json_text(json, "origin", cli_origin_name(experiment->claims[f->claim].origin));
        cli_json_text(json, "source", f->source);
        cli_json_number(json, "claim", f->claim);
        cli_json_close(json, '}');
    }
    cli_json_close(json, ']');
}

static void write_json(cli_json *json, const cli_experiment *experiment)
{
    char text[512];
    cli_json_open(json, experiment->name, '{');
    cli_json_text(json, "folder", experiment->folder);
    cli_json_text(json, "verdict", cli_verdict_name(cli_experiment_verdict(experiment)));
    cli_json_number(json, "seconds", experiment->seconds);
    cli_json_open(json, "claims", '[');
    for (int i = 0; i < experiment->claim_count; i++) {
        cli_json_open(json, NULL, '{');
        cli_json_text(json, "origin", cli_origin_name(experiment->claims[i].origin));
        cli_json_text(json, "says", experiment->claims[i].says);
        cli_json_text(json, "verdict", cli_claim_text(experiment, i, text, sizeof text));
        cli_json_close(json, '}');
    }
    cli_json_close(json, ']');
    write_numbers(json, experiment);
    cli_json_close(json, '}');
}

/* ---- all of them ---- */

typedef struct job {
    const char *parent; /* folder of the results */
    bool quiet;
    cli_json *json; /* nullable */
    cli_body bodies[CLI_BODIES];
    int body_count;
    bool given_mesh;
    cli_experiment *done[CASE_COUNT];
    char folders[CASE_COUNT][CLI_EXPERIMENT_PATH];
    int done_count;
} job;

static pel_status run_case(job *work, const cli_experiment_case *which, pel_error *error)
{
    cli_experiment *experiment = calloc(1, sizeof *experiment);
    if (experiment == NULL)
        return pel_fail_memory(error);
    work->done[work->done_count++] = experiment;
    at.number = work->done_count;
    experiment->name = which->name;
    experiment->doc = which->doc;
    experiment->error = error;
    experiment->bodies = work->bodies;
    experiment->body_count = work->body_count;
    experiment->given_mesh = work->given_mesh;
    experiment->progress = work->quiet ? NULL : tell_progress;
    char *folder = work->folders[at.number - 1];
    snprintf(folder, CLI_EXPERIMENT_PATH, "%s/%s", work->parent, which->name);
    experiment->folder = folder;
    pel_status status = make_folder(folder, error);
    double begin = pel_seconds();
    /* a case without its own claims is judged by its subject */
    if (strcmp(which->group, "own") == 0)
        cli_experiment_claim(experiment, which->origin, which->doc, NULL);
    if (status == PEL_OK)
        status = which->run(experiment);
    experiment->seconds = pel_seconds() - begin;
    if (status == PEL_OK)
        status = write_findings(experiment);
    if (!work->quiet)
        end_progress();
    if (status != PEL_OK)
        return status;
    if (work->json != NULL)
        write_json(work->json, experiment);
    else if (!work->quiet) {
        printf("%s: %s\n", which->name, which->doc);
        print_claims(experiment);
        printf("  %s; results in %s\n", cli_verdict_name(cli_experiment_verdict(experiment)), experiment->folder);
        fflush(stdout);
    }
    return PEL_OK;
}

static bool is_wanted(const cli_call *call, const char *name)
{
    if (cli_has(call, "all") || call->argument_count == 0)
        return true;
    for (int i = 0; i < call->argument_count; i++)
        if (strcmp(call->arguments[i], name) == 0)
            return true;
    return false;
}

static int run_cases(const cli_call *call, job *work)
{
    pel_error error;
    at.begin = pel_seconds();
    at.count = 0;
    for (int i = 0; i < CASE_COUNT; i++)
        at.count += is_wanted(call, cases[i]->name);
    const char *data = cli_value(call, "data"), *up = cli_value(call, "up");
    pel_status status =
        cli_bodies_find(cli_value(call, "mesh"), up != NULL ? up[0] : 'z',
                        data != NULL ? data : getenv("PELLICLE_DATA"), work->bodies, &work->body_count, &error);
    if (status != PEL_OK) {
        cli_report(&error);
        return CLI_BAD_INPUT;
    }
    for (int i = 0; status == PEL_OK && i < CASE_COUNT; i++)
        if (is_wanted(call, cases[i]->name))
            status = run_case(work, cases[i], &error);
    if (status == PEL_OK && at.count > 1)
        status = cli_reproduce_page(work->parent, (const cli_experiment *const *)work->done, work->done_count, &error);
    if (status != PEL_OK) {
        cli_report(&error);
        return CLI_FAILED;
    }
    bool right = true;
    for (int i = 0; i < work->done_count; i++)
        right = right && cli_experiment_verdict(work->done[i]) != CLI_FAILS;
    if (at.count > 1 && !work->quiet && work->json == NULL)
        printf("all of it: %s/index.html and index.md\n", work->parent);
    return right ? CLI_DONE : CLI_FAILED;
}

int cli_reproduce(const cli_call *call)
{
    if (cli_has(call, "list")) {
        print_cases(stdout);
        return CLI_DONE;
    }
    const char *output = cli_value(call, "output"), *parent = output != NULL ? output : "results/reproduce";
    if (strlen(parent) > CLI_EXPERIMENT_PATH - 256)
        return cli_complain("the path of the output folder is too long. choose a shorter one with -o");
    static job work;
    cli_json json = {.file = stdout};
    work.parent = parent;
    work.given_mesh = cli_value(call, "mesh") != NULL;
    work.quiet = cli_has(call, "quiet") || cli_has(call, "json");
    if (cli_has(call, "json")) {
        work.json = &json;
        cli_json_open(&json, NULL, '{');
    }
    int status = run_cases(call, &work);
    if (cli_has(call, "json"))
        cli_json_close(&json, '}');
    for (int i = 0; i < work.done_count; i++)
        free(work.done[i]);
    cli_bodies_free(work.bodies);
    return status;
}
