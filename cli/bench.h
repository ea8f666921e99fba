/* Benchmarks of `pellicle bench`: each is a row of the table in bench.c with three functions. */
#ifndef PELLICLE_CLI_BENCH_H
#define PELLICLE_CLI_BENCH_H

#include "diagnostics.h"

enum { CLI_BENCH_NUMBERS = 20 };

/* Measurements. A benchmark's `finish` adds further numbers (bytes moved, shares). */
typedef struct cli_bench_result {
    int repeats;
    double min_s, median_s;
    int number_count;
    struct {
        const char *name; /* JSON key, such as "triad_bytes_per_s"; a literal */
        const char *unit; /* "" for a plain ratio */
        double value;
    } numbers[CLI_BENCH_NUMBERS];
} cli_bench_result;

void cli_bench_add(cli_bench_result *result, const char *name, const char *unit, double value);

typedef struct cli_bench_case {
    const char *name;
    const char *doc;        /* one line */
    double compare_s;       /* time for comparison; 0 = none */
    const char *compare_to; /* "paper A, 2006" or "aim"; null when compare_s is 0 */
    int repeats;            /* default of --repeats */
    /* prepares the benchmark; not timed */
    pel_status (*begin)(void **inner, pel_error *error);
    /* brings inner back to where `once` starts; not timed; nullable */
    pel_status (*rewind)(void *inner, pel_error *error);
    /* the timed part */
    pel_status (*once)(void *inner, pel_error *error);
    /* adds numbers to the result; nullable */
    pel_status (*finish)(void *inner, cli_bench_result *result, pel_error *error);
    /* frees inner, also after a failed begin (inner may be null) */
    void (*end)(void *inner);
} cli_bench_case;

/* the cases of the other files */
extern const cli_bench_case cli_bench_read_obj, cli_bench_read_ply, cli_bench_sphere_500, cli_bench_springs,
    cli_bench_springs_explicit, cli_bench_million, cli_bench_million_threads, cli_bench_table1, cli_bench_frames,
    cli_bench_frames_all;

#endif
