#include "bench.h"
#include "commands.h"
#include "diagnostics.h"

#include "papers/lab/median.h"

#include <string.h>

static const cli_bench_case *const cases[] = {
    &cli_bench_sphere_500, &cli_bench_springs,         &cli_bench_springs_explicit, &cli_bench_table1,
    &cli_bench_million,    &cli_bench_million_threads, &cli_bench_read_obj,         &cli_bench_read_ply,
    &cli_bench_frames,     &cli_bench_frames_all,
};

enum { CASE_COUNT = sizeof cases / sizeof *cases, REPEATS_MAX = 1000 };

const char *cli_bench_names(int index)
{
    return index < CASE_COUNT ? cases[index]->name : NULL;
}

void cli_bench_add(cli_bench_result *result, const char *name, const char *unit, double value)
{
    if (result->number_count == CLI_BENCH_NUMBERS)
        return;
    int i = result->number_count++;
    result->numbers[i].name = name;
    result->numbers[i].unit = unit;
    result->numbers[i].value = value;
}

static pel_status repeat(const cli_bench_case *bench, void *inner, double *times, int count, pel_error *error)
{
    pel_status status = PEL_OK;
    for (int i = 0; status == PEL_OK && i < count; ++i) {
        if (bench->rewind != NULL)
            status = bench->rewind(inner, error);
        if (status != PEL_OK)
            break;
        double start = pel_seconds();
        status = bench->once(inner, error);
        times[i] = pel_seconds() - start;
    }
    return status;
}

static pel_status measure(const cli_bench_case *bench, int repeats, cli_bench_result *result, pel_error *error)
{
    double times[REPEATS_MAX];
    void *inner = NULL;
    *result = (cli_bench_result){.repeats = repeats};
    pel_status status = bench->begin(&inner, error);
    if (status == PEL_OK)
        status = repeat(bench, inner, times, repeats, error);
    if (status == PEL_OK) {
        result->median_s = lab_median(times, repeats);
        result->min_s = times[0];
        if (bench->finish != NULL)
            status = bench->finish(inner, result, error);
    }
    bench->end(inner);
    return status;
}

static void print_result(const cli_bench_case *bench, const cli_bench_result *result)
{
    printf("%-16s min %10.3f ms   median %10.3f ms   of %d", bench->name, 1e3 * result->min_s, 1e3 * result->median_s,
           result->repeats);
    if (bench->compare_s > 0.0)
        printf("   %s %g ms", bench->compare_to, 1e3 * bench->compare_s);
    fputc('\n', stdout);
    for (int i = 0; i < result->number_count; ++i)
        printf("%-16s %s %.4g %s\n", "", result->numbers[i].name, result->numbers[i].value, result->numbers[i].unit);
    fflush(stdout);
}

static void write_result(pel_json *json, const cli_bench_case *bench, const cli_bench_result *result)
{
    pel_json_open(json, bench->name, '{');
    pel_json_text(json, "doc", bench->doc);
    pel_json_integer(json, "repeats", result->repeats);
    pel_json_number(json, "min_s", result->min_s);
    pel_json_number(json, "median_s", result->median_s);
    if (bench->compare_s > 0.0) {
        pel_json_text(json, "compare_to", bench->compare_to);
        pel_json_number(json, "compare_s", bench->compare_s);
    }
    for (int i = 0; i < result->number_count; ++i)
        pel_json_number(json, result->numbers[i].name, result->numbers[i].value);
    pel_json_close(json, '}');
}

static void print_cases(FILE *file)
{
    for (int i = 0; i < CASE_COUNT; ++i)
        fprintf(file, "  %-16s %s\n", cases[i]->name, cases[i]->doc);
}

void cli_bench_help(FILE *file)
{
    fputs("\nbenchmarks:\n", file);
    print_cases(file);
}

static int run_cases(const cli_call *call, pel_json *json)
{
    const char *name = call->arguments[0];
    int asked = cli_count(call, "repeats");
    for (int i = 0; i < CASE_COUNT; ++i) {
        if (name != NULL && strcmp(name, cases[i]->name) != 0)
            continue;
        cli_bench_result result;
        pel_error error;
        if (measure(cases[i], asked > 0 ? asked : cases[i]->repeats, &result, &error) != PEL_OK) {
            cli_report(&error);
            return CLI_FAILED;
        }
        if (json != NULL)
            write_result(json, cases[i], &result);
        else
            print_result(cases[i], &result);
    }
    return CLI_DONE;
}

int cli_bench(const cli_call *call)
{
    if (cli_has(call, "list")) {
        print_cases(stdout);
        return CLI_DONE;
    }
    if (cli_count(call, "repeats") > REPEATS_MAX)
        return cli_complain("option '--repeats' is more than %d. give less", REPEATS_MAX);
    if (!cli_has(call, "json"))
        return run_cases(call, NULL);
    pel_json json = {.file = stdout, .style = PEL_JSON_INDENTED};
    pel_json_open(&json, NULL, '{');
    int status = run_cases(call, &json);
    pel_json_close(&json, '}');
    return status;
}
