#include "commands.h"
#include "experiment.h"

#include <errno.h>
#include <math.h>
#include <string.h>
#include <sys/stat.h>

static const cli_experiment_case *const cases[] = {
    &cli_figure_6_7,   &cli_figure_8,     &cli_figure_9,         &cli_table_1,    &cli_accuracy,
    &cli_shell_checks, &cli_figure_11_13, &cli_figure_14,        &cli_figure_15,  &cli_figure_16_18,
    &cli_figure_19_20, &cli_table_2,      &cli_shell_refinement, &cli_validation,
};

enum { CASE_COUNT = sizeof cases / sizeof *cases };

const char *cli_experiment_names(int index)
{
    return index < CASE_COUNT ? cases[index]->name : NULL;
}

static void print_cases(FILE *file)
{
    for (int i = 0; i < CASE_COUNT; ++i)
        fprintf(file, "  %-14s %s\n", cases[i]->name, cases[i]->doc);
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

static void print_findings(const cli_experiment *experiment)
{
    for (int i = 0; i < experiment->finding_count; i++) {
        const cli_finding *finding = &experiment->findings[i];
        printf("  %-6s %-40s %12.6g",
               isinf(finding->tolerance)    ? ""
               : cli_finding_holds(finding) ? "ok"
                                            : "NOT OK",
               finding->name, finding->value);
        if (!isnan(finding->expected))
            printf("  %s %.6g", finding->tolerance < 0 ? "at most" : "beside", finding->expected);
        if (finding->tolerance > 0 && !isinf(finding->tolerance))
            printf(" +- %.2g", finding->tolerance);
        printf("%s%s%s\n", finding->source[0] != '\0' ? " (" : "", finding->source,
               finding->source[0] != '\0' ? ")" : "");
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
    fputs("name,value,expected,judged,holds,source\n", file);
    for (int i = 0; i < experiment->finding_count; i++) {
        const cli_finding *f = &experiment->findings[i];
        fprintf(file, "\"%s\",%.17g,", f->name, f->value);
        if (!isnan(f->expected))
            fprintf(file, "%.17g", f->expected);
        fprintf(file, ",%d,%d,\"%s\"\n", !isinf(f->tolerance), cli_finding_holds(f), f->source);
    }
    bool whole = ferror(file) == 0;
    return fclose(file) == 0 && whole ? PEL_OK
                                      : pel_fail(experiment->error, PEL_BAD_FILE, "the numbers were not written whole");
}

static void write_json(cli_json *json, const cli_experiment_case *which, const cli_experiment *experiment)
{
    cli_json_open(json, which->name, '{');
    cli_json_text(json, "folder", experiment->folder);
    cli_json_open(json, "numbers", '[');
    for (int i = 0; i < experiment->finding_count; i++) {
        const cli_finding *f = &experiment->findings[i];
        cli_json_open(json, NULL, '{');
        cli_json_text(json, "name", f->name);
        cli_json_number(json, "value", f->value);
        cli_json_number(json, "expected", f->expected);
        cli_json_bool(json, "judged", !isinf(f->tolerance));
        cli_json_bool(json, "holds", cli_finding_holds(f));
        cli_json_text(json, "source", f->source);
        cli_json_close(json, '}');
    }
    cli_json_close(json, ']');
    cli_json_close(json, '}');
}

/* runs one; *right tells whether all its numbers hold */
static pel_status run_case(const cli_experiment_case *which, const char *parent, bool quiet, cli_json *json,
                           bool *right, pel_error *error)
{
    char folder[CLI_EXPERIMENT_PATH];
    snprintf(folder, sizeof folder, "%s/%s", parent, which->name);
    cli_experiment experiment = {.folder = folder, .error = error, .quiet = quiet};
    pel_status status = make_folder(folder, error);
    if (!quiet)
        printf("%s: %s\n", which->name, which->doc);
    if (status == PEL_OK)
        status = which->run(&experiment);
    if (status == PEL_OK)
        status = write_findings(&experiment);
    if (status != PEL_OK)
        return status;
    for (int i = 0; i < experiment.finding_count; i++)
        *right = *right && cli_finding_holds(&experiment.findings[i]);
    if (json != NULL)
        write_json(json, which, &experiment);
    else if (!quiet)
        print_findings(&experiment);
    if (!quiet)
        printf("  results in %s\n", folder);
    return PEL_OK;
}

static int run_cases(const cli_call *call, const char *parent, bool quiet, cli_json *json)
{
    const char *name = call->arguments[0];
    bool right = true;
    for (int i = 0; i < CASE_COUNT; ++i) {
        pel_error error;
        if (name != NULL && strcmp(name, cases[i]->name) != 0)
            continue;
        if (run_case(cases[i], parent, quiet, json, &right, &error) != PEL_OK) {
            cli_report(&error);
            return CLI_FAILED;
        }
    }
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
    if (!cli_has(call, "json"))
        return run_cases(call, parent, cli_has(call, "quiet"), NULL);
    cli_json json = {.file = stdout};
    cli_json_open(&json, NULL, '{');
    int status = run_cases(call, parent, true, &json);
    cli_json_close(&json, '}');
    return status;
}
