/* Figures 6 to 9 of paper A: pressing and letting go, with and without volumetric springs; base, global and local
   refinement under the same force; the lens capsule under a probe. */
#include "experiment.h"

#include <math.h>

static const char sphere[] = "version: 1\n"
                             "title: sphere pressed at the pole\n"
                             "bodies:\n"
                             "  - name: ball\n"
                             "    mesh: { shape: geodesic-sphere, frequency: 5, radius: 1 }\n"
                             "    mass: { per_vertex: 1 }\n"
                             "    springs: { stiffness: 3, damping: 0.5 }\n"
                             "loads:\n"
                             "  - { body: ball, force: [0, 0, -1], at: { nearest: [0, 0, 1] }, until: 5 }\n"
                             "solver: { method: quasi-static, alpha: 50, dt: 0.01, velocity: ignore }\n"
                             "duration: 10\n"
                             "output: { every: 0.1, fields: [displacement, force] }\n";

static const char filled[] = "bodies.ball.volumetric={ stiffness: 1.5, damping: 0.5 }";

static const char own[] = "our own computation of the figure";

/* ---- figures 6 and 7 ---- */

static pel_status plot_two(cli_experiment *experiment, const char *title, const char *const runs[2],
                           const char *const names[2])
{
    cli_series series[2] = {{0}, {0}};
    pel_status status = PEL_OK;
    for (int i = 0; status == PEL_OK && i < 2; i++)
        status = cli_series_read(experiment, runs[i], "time", "max_displacement", &series[i]);
    cli_plot plot = {.title = title, .x_name = "time [s]", .y_name = "largest displacement [m]", .curve_count = 2};
    for (int i = 0; i < 2; i++)
        plot.curves[i] = (cli_curve){names[i], series[i].x, series[i].y, series[i].count, false};
    if (status == PEL_OK)
        status = cli_experiment_plot(experiment, &plot);
    for (int i = 0; i < 2; i++)
        cli_series_free(&series[i]);
    return status;
}

static pel_status run_figure_6_7(cli_experiment *experiment)
{
    static const char *const names[2] = {"without volumetric springs", "with volumetric springs"};
    static const char *const runs[2] = {"hollow", "filled"};
    const char *overrides[] = {filled, NULL};
    pel_run_summary hollow, full;
    pel_status status = cli_experiment_run(experiment, runs[0], sphere, NULL, &hollow);
    if (status == PEL_OK)
        status = cli_experiment_run(experiment, runs[1], sphere, overrides, &full);
    if (status != PEL_OK)
        return status;
    cli_experiment_check(experiment, "hollow: depth [m]", hollow.max_displacement, 0.518, 0.001, own);
    cli_experiment_check(experiment, "hollow: left after 5 s [m]", hollow.residual_displacement, 0.336, 0.002, own);
    cli_experiment_check(experiment, "filled: depth [m]", full.max_displacement, 0.283, 0.001, own);
    cli_experiment_check(experiment, "filled: left after 5 s [m]", full.residual_displacement, 0.005, 0.001, own);
    cli_experiment_limit(experiment, "filled: left / depth", full.residual_displacement / full.max_displacement, 0.05,
                         "paper A: almost completely restored");
    status = plot_two(experiment, "a ball pressed for 5 s and let go", runs, names);
    const cli_picture picture = {.runs = {"hollow", "filled"},
                                 .labels = {names[0], names[1]},
                                 .run_count = 2,
                                 .frames = {50, 100},
                                 .frame_count = 2,
                                 .azimuth = 35,
                                 .elevation = 45,
                                 .edges = true};
    return status == PEL_OK ? cli_experiment_draw(experiment, &picture) : status;
}

const cli_experiment_case cli_figure_6_7 = {
    .name = "figure6-7",
    .doc = "a ball pressed and let go, without and with volumetric springs",
    .run = run_figure_6_7,
};

/* ---- figure 8 ---- */

/* the paper's counts on each of the three surfaces */
static void check_counts(cli_experiment *experiment, const char *const runs[3], const pel_run_summary summaries[3])
{
    static const double counts[3][2] = {{252, 500}, {1002, 2000}, {294, 584}};
    for (int i = 0; i < 3; i++) {
        char name[64];
        snprintf(name, sizeof name, "%s: vertices", runs[i]);
        cli_experiment_check(experiment, name, (double)summaries[i].vertices_final, counts[i][0], 0, "paper A");
        snprintf(name, sizeof name, "%s: triangles", runs[i]);
        cli_experiment_check(experiment, name, (double)summaries[i].triangles_final, counts[i][1], 0, "paper A");
        snprintf(name, sizeof name, "%s: depth [m]", runs[i]);
        cli_experiment_tell(experiment, name, summaries[i].residual_displacement, (double)NAN, "");
    }
}

static pel_status run_figure_8(cli_experiment *experiment)
{
    static const char *const runs[3] = {"base", "global", "local"};
    const char *refine[3] = {NULL, "bodies.ball.refine={ levels: 1, everywhere: true }",
                             "bodies.ball.refine={ levels: 1, above: 5 }"};
    pel_run_summary summaries[3];
    pel_status status = PEL_OK;
    for (int i = 0; status == PEL_OK && i < 3; i++) {
        /* vertex 13 is next to the pole; it and its neighbours have six triangles each */
        const char *overrides[] = {
            filled, "bodies.ball.scale_with_area=true", "loads.0.at={ vertices: [13] }", "duration=5", refine[i], NULL};
        status = cli_experiment_run(experiment, runs[i], sphere, overrides, &summaries[i]);
    }
    if (status != PEL_OK)
        return status;
    check_counts(experiment, runs, summaries);
    double global = summaries[1].residual_displacement;
    cli_experiment_check(experiment, "local / global: depth", summaries[2].residual_displacement / global, 1, 0.05,
                         "paper A: nearly the same; 5 % at most");
    cli_experiment_tell(experiment, "base / global: depth", summaries[0].residual_displacement / global, 1, "");
    status = plot_two(experiment, "the same force on the surface refined everywhere and locally", &runs[1], &runs[1]);
    const cli_picture picture = {.runs = {"base", "global", "local"},
                                 .labels = {"base", "refined everywhere", "refined locally"},
                                 .run_count = 3,
                                 .frames = {50},
                                 .frame_count = 1,
                                 .azimuth = 35,
                                 .elevation = 45,
                                 .edges = true};
    return status == PEL_OK ? cli_experiment_draw(experiment, &picture) : status;
}

const cli_experiment_case cli_figure_8 = {
    .name = "figure8",
    .doc = "the same force on the base, the globally and the locally refined ball",
    .run = run_figure_8,
};

/* ---- figure 9 ---- */

static const char lens[] = "version: 1\n"
                           "title: lens capsule under a probe\n"
                           "bodies:\n"
                           "  - name: capsule\n"
                           "    mesh: { shape: lens-capsule, age: 29 }\n"
                           "    mass: { per_vertex: 1.0e-6 }\n"
                           "    springs: { stiffness: 20, damping: 0.01 }\n"
                           "    volumetric: { stiffness: 10, damping: 0.01 }\n"
                           "    scale_with_area: true\n"
                           "tools:\n"
                           "  - name: probe\n"
                           "    shape: sphere\n"
                           "    radius: 0.001\n"
                           "    motion:\n"
                           "      - { time: 0.0, position: [0, 0, 0.0033] }\n"
                           "      - { time: 1.0, position: [0, 0, 0.00218] }\n"
                           "      - { time: 1.5, position: [0, 0, 0.00218] }\n"
                           "      - { time: 2.5, position: [0, 0, 0.0045] }\n"
                           "solver: { method: quasi-static, dt: 0.001 }\n"
                           "duration: 5\n"
                           "output: { every: 0.05, fields: [displacement, force] }\n";

static pel_status run_figure_9(cli_experiment *experiment)
{
    static const char *const runs[2] = {"base", "local"}, *const names[2] = {"base", "refined near the probe"};
    const char *overrides[] = {"bodies.capsule.refine={ levels: 1, near_tools: 0.0002 }", NULL};
    pel_run_summary base, local;
    pel_status status = cli_experiment_run(experiment, runs[0], lens, NULL, &base);
    if (status == PEL_OK)
        status = cli_experiment_run(experiment, runs[1], lens, overrides, &local);
    if (status != PEL_OK)
        return status;
    /* the probe's lowest point goes from 2.18 mm, the front pole, to 1.18 mm */
    cli_experiment_check(experiment, "base: depth [m]", base.max_displacement, 0.001, 3e-5, "the way of the probe");
    cli_experiment_check(experiment, "local: depth [m]", local.max_displacement, 0.001, 3e-5, "the way of the probe");
    cli_experiment_limit(experiment, "base: left / depth", base.residual_displacement / base.max_displacement, 0.01,
                         "paper A: almost completely restored");
    cli_experiment_limit(experiment, "local: left / depth", local.residual_displacement / local.max_displacement, 0.01,
                         "paper A: almost completely restored");
    cli_experiment_check(experiment, "base: triangles at the end", (double)base.triangles_final, 5120, 0, "the mesh");
    cli_experiment_check(experiment, "local: triangles at the end", (double)local.triangles_final, 5120, 0,
                         "the mesh: all refinement given back");
    cli_experiment_tell(experiment, "base: largest force on the probe [N]", base.max_tool_force, (double)NAN, "");
    cli_experiment_tell(experiment, "local: largest force on the probe [N]", local.max_tool_force, (double)NAN, "");
    status = plot_two(experiment, "the capsule of an eye lens under a probe", runs, names);
    const cli_picture picture = {.runs = {"base", "local"},
                                 .labels = {names[0], names[1]},
                                 .run_count = 2,
                                 .frames = {30, 100},
                                 .frame_count = 2,
                                 .azimuth = 30,
                                 .elevation = 30,
                                 .edges = true};
    return status == PEL_OK ? cli_experiment_draw(experiment, &picture) : status;
}

const cli_experiment_case cli_figure_9 = {
    .name = "figure9",
    .doc = "the capsule of an eye lens under a probe, on its mesh and refined near the probe",
    .run = run_figure_9,
};
