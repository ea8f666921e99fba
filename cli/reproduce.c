#include "commands.h"
#include "diagnostics.h"

#include "papers/papers.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

const char *cli_experiment_names(int index)
{
    const lab_case *which = papers_case_at(index);
    return which != NULL ? which->name : NULL;
}

static void print_cases(FILE *file)
{
    const lab_case *which;
    for (int i = 0; (which = papers_case_at(i)) != NULL; i++)
        fprintf(file, "  %-14s %s: %s\n", which->name, which->group, which->doc);
}

void cli_reproduce_help(FILE *file)
{
    fputs("\nexperiments:\n", file);
    print_cases(file);
}

/* ---- progress: one line that is written over on a terminal, else a line for each run ---- */

typedef struct progress {
    int number, count; /* index of the experiment, and number of those that run */
    double begin;
} progress;

static void tell_progress(void *user, const char *experiment, const char *run)
{
    const progress *at = user;
    int seconds = (int)(pel_seconds() - at->begin);
    bool terminal = isatty(STDERR_FILENO) != 0;
    fprintf(stderr, "%s%2d of %d, %d:%02d  %s: %s%s", terminal ? "\r\033[K" : "  ", at->number, at->count, seconds / 60,
            seconds % 60, experiment, run, terminal ? "" : "\n");
}

static void end_progress(void)
{
    if (isatty(STDERR_FILENO) != 0)
        fputs("\r\033[K", stderr);
}

/* ---- results ---- */

static void print_findings(const lab_experiment *experiment, int claim)
{
    for (int i = 0; i < experiment->finding_count; i++) {
        const lab_finding *finding = &experiment->findings[i];
        if (finding->claim != claim)
            continue;
        printf("    %-6s %-58s %12.6g",
               finding->relation == LAB_TOLD ? ""
               : lab_finding_holds(finding)  ? "ok"
                                             : "NOT OK",
               finding->name, finding->value);
        if (!isnan(finding->expected))
            printf("  %s %.6g", lab_relation_sign(finding->relation), finding->expected);
        if (finding->relation == LAB_EQUAL && finding->tolerance > 0)
            printf(" +- %.2g", finding->tolerance);
        printf("%s%s%s\n", finding->source[0] != '\0' ? " (" : "", finding->source,
               finding->source[0] != '\0' ? ")" : "");
    }
}

static void print_experiment(const lab_experiment *experiment)
{
    char text[512];
    printf("%s: %s\n", experiment->name, experiment->doc);
    for (int i = 0; i < experiment->claim_count; i++) {
        printf("  %s: %s\n    %s\n", lab_origin_name(experiment->claims[i].origin), experiment->claims[i].says,
               lab_claim_text(experiment, i, text, sizeof text));
        print_findings(experiment, i);
    }
    printf("  %s; results in %s\n", lab_verdict_name(lab_experiment_verdict(experiment)), experiment->folder);
    fflush(stdout);
}

static void write_numbers(pel_json *json, const lab_experiment *experiment)
{
    pel_json_open(json, "numbers", '[');
    for (int i = 0; i < experiment->finding_count; i++) {
        const lab_finding *f = &experiment->findings[i];
        pel_json_open(json, NULL, '{');
        pel_json_text(json, "name", f->name);
        pel_json_number(json, "value", f->value);
        pel_json_text(json, "relation", lab_relation_sign(f->relation));
        pel_json_number(json, "expected", f->expected);
        pel_json_number(json, "tolerance", f->tolerance);
        pel_json_bool(json, "judged", f->relation != LAB_TOLD);
        pel_json_bool(json, "holds", lab_finding_holds(f));
        pel_json_text(json, "origin", lab_origin_name(experiment->claims[f->claim].origin));
        pel_json_bool(json, "by_construction", experiment->claims[f->claim].by_construction);
        pel_json_text(json, "source", f->source);
        pel_json_number(json, "claim", f->claim);
        pel_json_close(json, '}');
    }
    pel_json_close(json, ']');
}

static void write_json(pel_json *json, const lab_experiment *experiment)
{
    char text[512];
    pel_json_open(json, experiment->name, '{');
    pel_json_text(json, "folder", experiment->folder);
    pel_json_text(json, "verdict", lab_verdict_name(lab_experiment_verdict(experiment)));
    pel_json_number(json, "seconds", experiment->seconds);
    pel_json_open(json, "claims", '[');
    for (int i = 0; i < experiment->claim_count; i++) {
        pel_json_open(json, NULL, '{');
        pel_json_text(json, "origin", lab_origin_name(experiment->claims[i].origin));
        pel_json_text(json, "says", experiment->claims[i].says);
        pel_json_text(json, "verdict", lab_claim_text(experiment, i, text, sizeof text));
        pel_json_close(json, '}');
    }
    pel_json_close(json, ']');
    write_numbers(json, experiment);
    pel_json_close(json, '}');
}

/* ---- all of them ---- */

static bool is_wanted(const cli_call *call, const char *name)
{
    if (cli_has(call, "all") || call->argument_count == 0)
        return true;
    for (int i = 0; i < call->argument_count; i++)
        if (strcmp(call->arguments[i], name) == 0)
            return true;
    return false;
}

typedef struct job {
    const cli_call *call;
    pel_json *json; /* nullable */
    bool quiet, fails;
    progress at;
} job;

static pel_status run_cases(job *work, papers *all, pel_error *error)
{
    pel_status status = PEL_OK;
    const lab_case *which;
    for (int i = 0; status == PEL_OK && (which = papers_case_at(i)) != NULL; i++) {
        const lab_experiment *experiment;
        if (!is_wanted(work->call, which->name))
            continue;
        work->at.number++;
        status = papers_run(all, which, &experiment, error);
        if (!work->quiet)
            end_progress();
        if (status != PEL_OK)
            return status;
        if (work->json != NULL)
            write_json(work->json, experiment);
        else if (!work->quiet)
            print_experiment(experiment);
        work->fails = work->fails || lab_experiment_verdict(experiment) == LAB_FAILS;
    }
    return status == PEL_OK && work->at.count > 1 ? papers_write_page(all, error) : status;
}

static int run_all(job *work, const papers_def *def)
{
    pel_error error;
    papers *all;
    int result = CLI_FAILED;
    if (papers_create(def, &all, &error) != PEL_OK) {
        cli_report(&error);
        result = CLI_BAD_INPUT;
    } else if (run_cases(work, all, &error) != PEL_OK)
        cli_report(&error);
    else {
        result = work->fails ? CLI_FAILED : CLI_DONE;
        if (work->at.count > 1 && !work->quiet)
            printf("all of it: %s/index.html and index.md\n", def->folder);
    }
    papers_destroy(all);
    return result;
}

int cli_reproduce(const cli_call *call)
{
    if (cli_has(call, "list")) {
        print_cases(stdout);
        return CLI_DONE;
    }
    const char *output = cli_value(call, "output"), *up = cli_value(call, "up"), *data = cli_value(call, "data");
    pel_json json = {.file = stdout, .style = PEL_JSON_INDENTED};
    job work = {.call = call, .at.begin = pel_seconds()};
    papers_def def = {
        .folder = output != NULL ? output : "results/reproduce",
        .mesh = cli_value(call, "mesh"),
        .up = up != NULL ? up[0] : 'z',
        .data = data != NULL ? data : getenv("PELLICLE_DATA"),
        .user = &work.at,
    };
    if (strlen(def.folder) > LAB_PATH_SIZE - 256)
        return cli_complain("the path of the output folder is too long. choose a shorter one with -o");
    work.quiet = cli_has(call, "quiet") || cli_has(call, "json");
    def.progress = work.quiet ? NULL : tell_progress;
    for (int i = 0; papers_case_at(i) != NULL; i++)
        work.at.count += is_wanted(call, papers_case_at(i)->name);
    if (cli_has(call, "json")) {
        work.json = &json;
        pel_json_open(&json, NULL, '{');
    }
    int result = run_all(&work, &def);
    if (work.json != NULL)
        pel_json_close(&json, '}');
    return result;
}
