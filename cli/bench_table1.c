#include "bench.h"

#include "papers/a/spheres.h"

static pel_status begin(void **inner, pel_error *error)
{
    a_spheres *spheres;
    pel_status status = a_spheres_create(&spheres, error);
    *inner = spheres;
    return status;
}

static pel_status rewind_all(void *inner, pel_error *error)
{
    return a_spheres_rewind(inner, error);
}

static pel_status once(void *inner, pel_error *error)
{
    return a_spheres_run(inner, error);
}

static pel_status finish(void *inner, cli_bench_result *result, pel_error *error)
{
    static const char *const names[A_SPHERES] = {"base_ms", "local_ms", "dynamic_ms", "everywhere_ms"};
    static const char *const faster[A_SPHERES] = {"base_faster_than_paper", "local_faster_than_paper",
                                                  "dynamic_faster_than_paper", "everywhere_faster_than_paper"};
    a_times times;
    pel_status status = a_spheres_measure(inner, &times, error);
    cli_bench_add(result, "local_triangles", "", times.triangles[A_LOCAL]);
    cli_bench_add(result, "dynamic_triangles", "", times.triangles[A_DYNAMIC]);
    for (int i = 0; i < A_SPHERES; i++) {
        cli_bench_add(result, names[i], "ms", 1e3 * times.seconds[i]);
        cli_bench_add(result, faster[i], "times", a_paper_seconds[i] / times.seconds[i]);
    }
    cli_bench_add(result, "local_over_base", "(paper: 1.10)", times.over_base[A_LOCAL]);
    cli_bench_add(result, "dynamic_over_base", "(paper: 1.10)", times.over_base[A_DYNAMIC]);
    cli_bench_add(result, "everywhere_over_base", "(paper: 3.23)", times.over_base[A_EVERYWHERE]);
    cli_bench_add(result, "refine_event_us", "us", 1e6 * times.refine);
    cli_bench_add(result, "coarsen_event_us", "us", 1e6 * times.coarsen);
    return status;
}

static void end(void *inner)
{
    a_spheres_destroy(inner);
}

const cli_bench_case cli_bench_table1 = {
    .name = "table1",
    .doc =
        "table 1 of paper A: 500 steps on the base, refined locally (asked for, and by the criterion) and everywhere",
    .repeats = 31,
    .begin = begin,
    .rewind = rewind_all,
    .once = once,
    .finish = finish,
    .end = end,
};
