/* Figures 11 and 13 to 20 of paper B, and table 2: shells that shrink under an outside pressure. The paper gives
   neither its time step nor its pressure and masses; ours are a frame of 1/60 s and p / (rho h) = 2.4 m/s2 on bodies of
   about 2 m. */
#include "experiment.h"

#include <math.h>
#include <string.h>

static const char shrink[] = "version: 1\n"
                             "title: shell that shrinks under pressure\n"
                             "bodies:\n"
                             "  - name: shell\n"
                             "    mesh: { shape: geodesic-sphere, frequency: 8 }\n"
                             "    mass: { density: 1000, thickness: 0.01 }\n"
                             "    membrane: { young: 1.0e5 }\n"
                             "    bending: { model: isometric, weight: 0.01 }\n"
                             "    pressure: { outside: 24 }\n"
                             "solver: { method: pbd, dt: 0.0166666667, iterations: 5 }\n"
                             "stop: { frames: 100, volume_ratio_below: 0.3 }\n"
                             "output: { every_frame: 1, fields: [displacement, energy] }\n";

static const char own[] = "our own computation";

enum { MESH_COUNT = 4 };

static const struct {
    const char *name, *override;
    const char *region; /* of fibres: where the body is rounded */
} meshes[MESH_COUNT] = {
    {"sphere", "bodies.0.mesh={ shape: geodesic-sphere, frequency: 8 }", "{ center: [0, 0, 1], radius: 0.5 }"},
    {"ellipsoid", "bodies.0.mesh={ shape: geodesic-sphere, frequency: 8, scale: [1, 1.4, 0.7] }",
     "{ center: [0, 1.4, 0], radius: 0.5 }"},
    {"torus", "bodies.0.mesh={ shape: torus, major_radius: 1, minor_radius: 0.4, slices: 48, rings: 20 }",
     "{ center: [1.4, 0, 0], radius: 0.5 }"},
    {"capsule", "bodies.0.mesh={ shape: capsule, radius: 0.6, height: 1.2, slices: 32, rings: 8, segments: 10 }",
     "{ center: [0, 0, 1.2], radius: 0.5 }"},
};

/* volume over that at rest in a frame of a run, or its last one */
static pel_status volume_at(cli_experiment *experiment, const char *run, int frame, double *ratio)
{
    cli_series series;
    pel_status status = cli_series_read(experiment, run, "frame", "volume_ratio", &series);
    if (status == PEL_OK)
        *ratio = series.y[frame < series.count ? frame : series.count - 1];
    cli_series_free(&series);
    return status;
}

static pel_status plot_volumes(cli_experiment *experiment, const char *title, const char *const *runs, int count)
{
    cli_series series[CLI_CURVES] = {{0}};
    cli_plot plot = {.title = title, .x_name = "frame", .y_name = "volume / volume at rest", .curve_count = count};
    pel_status status = PEL_OK;
    for (int i = 0; status == PEL_OK && i < count; i++) {
        status = cli_series_read(experiment, runs[i], "frame", "volume_ratio", &series[i]);
        plot.curves[i] = (cli_curve){runs[i], series[i].x, series[i].y, series[i].count, false};
    }
    if (status == PEL_OK)
        status = cli_experiment_plot(experiment, &plot);
    for (int i = 0; i < count; i++)
        cli_series_free(&series[i]);
    return status;
}

/* what is shown of an experiment: the volumes of some runs, and four of them side by side in two frames */
typedef struct exhibit {
    const char *title, *curves[CLI_CURVES];
    int curve_count;
    const char *runs[4], *labels[4];
    int frames[2];
    double elevation;
} exhibit;

static pel_status show(cli_experiment *experiment, const exhibit *what)
{
    cli_picture picture = {.run_count = 4, .frame_count = 2, .azimuth = 35, .elevation = what->elevation};
    memcpy(picture.runs, what->runs, sizeof what->runs);
    memcpy(picture.labels, what->labels, sizeof what->labels);
    memcpy(picture.frames, what->frames, sizeof what->frames);
    pel_status status = plot_volumes(experiment, what->title, what->curves, what->curve_count);
    return status == PEL_OK ? cli_experiment_draw(experiment, &picture) : status;
}

static void tell(cli_experiment *experiment, const char *subject, const char *what, double value)
{
    char name[64];
    snprintf(name, sizeof name, "%.31s: %.30s", subject, what);
    cli_experiment_tell(experiment, name, value, (double)NAN, "");
}

/* ---- figures 11 and 13: materials and sizes ---- */

static const char *const materials[] = {"corotated", "linear", "stvk", "mooney-rivlin"};
enum { MATERIAL_COUNT = 4 };

static pel_status run_materials(cli_experiment *experiment, int mesh, double volumes[MATERIAL_COUNT])
{
    pel_status status = PEL_OK;
    for (int i = 0; status == PEL_OK && i < MATERIAL_COUNT; i++) {
        char run[64], material[64];
        pel_run_summary summary = {0};
        snprintf(run, sizeof run, "%s-%s", meshes[mesh].name, materials[i]);
        snprintf(material, sizeof material, "bodies.0.membrane.material=%s", materials[i]);
        const char *overrides[] = {meshes[mesh].override, material, NULL};
        status = cli_experiment_run(experiment, run, shrink, overrides, &summary);
        if (status == PEL_OK)
            status = volume_at(experiment, run, 50, &volumes[i]);
        if (status == PEL_OK)
            tell(experiment, run, "volume in frame 50", volumes[i]);
    }
    return status;
}

/* a body of a smaller volume under the same pressure, and under one that goes with its size */
static pel_status run_sizes(cli_experiment *experiment)
{
    static const double parts[3] = {1, 0.25, 0.0625};
    double volumes[2][3] = {{0}};
    pel_status status = PEL_OK;
    for (int scaled = 0; scaled < 2; scaled++)
        for (int i = 0; status == PEL_OK && i < 3; i++) {
            char run[64], mesh[128], pressure[64];
            double size = cbrt(parts[i]);
            pel_run_summary summary = {0};
            snprintf(run, sizeof run, "volume-1-%d%s", (int)(1 / parts[i]), scaled ? "-scaled" : "");
            snprintf(mesh, sizeof mesh, "bodies.0.mesh.scale=%.15g", size);
            snprintf(pressure, sizeof pressure, "bodies.0.pressure.outside=%.15g", scaled ? 24 * size : 24);
            const char *overrides[] = {mesh, pressure, "stop.frames=50", NULL};
            status = cli_experiment_run(experiment, run, shrink, overrides, &summary);
            volumes[scaled][i] = summary.volume_ratio_final;
            tell(experiment, run, "volume in frame 50", summary.volume_ratio_final);
        }
    if (status == PEL_OK)
        cli_experiment_limit(experiment, "pressure with size: largest difference of volume",
                             fmax(fabs(volumes[1][1] - volumes[1][0]), fabs(volumes[1][2] - volumes[1][0])), 1e-3,
                             "paper B: the volume has little influence");
    return status;
}

static pel_status run_figure_11_13(cli_experiment *experiment)
{
    pel_status status = PEL_OK;
    for (int mesh = 0; status == PEL_OK && mesh < 3; mesh++) {
        double volumes[MATERIAL_COUNT] = {0}, spread = 0;
        status = run_materials(experiment, mesh, volumes);
        for (int i = 0; i < MATERIAL_COUNT; i++)
            spread = fmax(spread, fabs(volumes[i] - volumes[2]));
        char name[64];
        snprintf(name, sizeof name, "%s: largest difference from stvk", meshes[mesh].name);
        cli_experiment_limit(experiment, name, spread, 0.05, "paper B: the materials differ very little");
    }
    if (status == PEL_OK)
        status = run_sizes(experiment);
    static const exhibit what = {
        .title = "volume of shells of four materials",
        .curves = {"sphere-corotated", "sphere-linear", "sphere-stvk", "sphere-mooney-rivlin", "torus-corotated",
                   "torus-linear", "torus-stvk", "torus-mooney-rivlin"},
        .curve_count = 8,
        .runs = {"torus-corotated", "torus-linear", "torus-stvk", "torus-mooney-rivlin"},
        .labels = {"corotated", "linear", "stvk", "mooney-rivlin"},
        .frames = {50, 80},
        .elevation = 45,
    };
    return status == PEL_OK ? show(experiment, &what) : status;
}

const cli_experiment_case cli_figure_11_13 = {
    .name = "b-figure11-13",
    .doc = "paper B: shells of four materials and three sizes that shrink",
    .run = run_figure_11_13,
};

/* ---- figures 14 and 15, table 1: energies against distances and minimisation ---- */

/* a method on a mesh; its energy in the last frame and the time of a step */
static pel_status run_method(cli_experiment *experiment, int mesh, const char *method, const char *frames,
                             pel_run_summary *summary)
{
    char run[64], override[64], name[96];
    bool gradient = strcmp(method, "gradient") == 0, lbfgs = strcmp(method, "lbfgs") == 0;
    snprintf(run, sizeof run, "%s-%s", meshes[mesh].name, method);
    snprintf(override, sizeof override, "solver.method=%s", gradient || lbfgs ? "descent" : method);
    const char *overrides[] = {
        meshes[mesh].override, override, frames,
        /* where energies are minimised a pressure beyond that of buckling has no balance */
        strcmp(frames, "stop.frames=30") == 0
            ? "bodies.0.pressure={ volume: { target: { keys: [[0, 1], [0.5, 0.6]] }, bulk: 500 } }"
            : "bodies.0.pressure.outside=24",
        gradient ? "solver.descent=gradient" : "solver.descent=lbfgs", "solver.threads=1",
        strcmp(method, "pbd") == 0 ? "solver.iterations=5" : "solver.iterations=auto", NULL};
    pel_status status = cli_experiment_run(experiment, run, shrink, overrides, summary);
    if (status != PEL_OK)
        return status;
    snprintf(name, sizeof name, "volume in frame %d", (int)summary->steps);
    tell(experiment, run, name, summary->volume_ratio_final);
    tell(experiment, run, "ms a frame", 1e3 / summary->steps_per_second);
    return PEL_OK;
}

static pel_status last_number(cli_experiment *experiment, const char *run, const char *column, double *number)
{
    cli_series series;
    pel_status status = cli_series_read(experiment, run, "frame", column, &series);
    if (status == PEL_OK)
        *number = series.y[series.count - 1];
    cli_series_free(&series);
    return status;
}

static pel_status run_figure_14(cli_experiment *experiment)
{
    pel_status status = PEL_OK;
    for (int mesh = 0; status == PEL_OK && mesh < 3; mesh++) {
        static const char *const methods[2] = {"pbd", "pbd-distance"};
        double membrane[2] = {0};
        pel_run_summary summary = {0};
        for (int i = 0; status == PEL_OK && i < 2; i++) {
            char run[64];
            snprintf(run, sizeof run, "%s-%s", meshes[mesh].name, methods[i]);
            status = run_method(experiment, mesh, methods[i], "stop.frames=100", &summary);
            if (status == PEL_OK)
                status = last_number(experiment, run, "membrane_energy", &membrane[i]);
        }
        char name[64];
        snprintf(name, sizeof name, "%s: energy / distance: stretch energy", meshes[mesh].name);
        cli_experiment_limit(experiment, name, membrane[0] / membrane[1], 1, "paper B: distances stretch more");
    }
    static const exhibit what = {
        .title = "energies and distances as constraints",
        .curves = {"sphere-pbd", "sphere-pbd-distance", "ellipsoid-pbd", "ellipsoid-pbd-distance", "torus-pbd",
                   "torus-pbd-distance"},
        .curve_count = 6,
        .runs = {"sphere-pbd", "sphere-pbd-distance", "ellipsoid-pbd", "ellipsoid-pbd-distance"},
        .labels = {"energy", "distance", "energy", "distance"},
        .frames = {50, -1},
        .elevation = 30,
    };
    return status == PEL_OK ? show(experiment, &what) : status;
}

const cli_experiment_case cli_figure_14 = {
    .name = "b-figure14",
    .doc = "paper B: energies as constraints beside distances of edges",
    .run = run_figure_14,
};

static pel_status run_figure_15(cli_experiment *experiment)
{
    static const char *const methods[4] = {"pbd", "pbd-distance", "gradient", "lbfgs"};
    pel_status status = PEL_OK;
    for (int mesh = 0; status == PEL_OK && mesh < 3; mesh++) {
        double milliseconds[4] = {0}, bending[4] = {0};
        char name[64], run[64];
        for (int i = 0; status == PEL_OK && i < 4; i++) {
            pel_run_summary summary = {0};
            status = run_method(experiment, mesh, methods[i], "stop.frames=30", &summary);
            milliseconds[i] = 1e3 / summary.steps_per_second;
            snprintf(run, sizeof run, "%s-%s", meshes[mesh].name, methods[i]);
            if (status == PEL_OK)
                status = last_number(experiment, run, "bending_energy", &bending[i]);
            tell(experiment, run, "bending energy", bending[i]);
        }
        snprintf(name, sizeof name, "%s: pbd / gradient descent: time", meshes[mesh].name);
        cli_experiment_limit(experiment, name, milliseconds[0] / milliseconds[2], 1, "paper B, table 1: less time");
        snprintf(name, sizeof name, "%s: distances / pbd: time", meshes[mesh].name);
        cli_experiment_limit(experiment, name, milliseconds[1] / milliseconds[0], 1, "paper B, table 1: less time");
    }
    static const exhibit what = {
        .title = "position-based dynamics and minimisation of the energy",
        .curves = {"sphere-pbd", "sphere-gradient", "sphere-lbfgs", "torus-pbd", "torus-gradient", "torus-lbfgs"},
        .curve_count = 6,
        .runs = {"sphere-pbd", "sphere-gradient", "torus-pbd", "torus-gradient"},
        .labels = {"pbd", "gradient descent", "pbd", "gradient descent"},
        .frames = {10, -1},
        .elevation = 30,
    };
    return status == PEL_OK ? show(experiment, &what) : status;
}

const cli_experiment_case cli_figure_15 = {
    .name = "b-figure15",
    .doc = "paper B, with table 1: position-based dynamics beside minimisation of the energy",
    .run = run_figure_15,
};

/* ---- figures 16 to 18: the weight of bending ---- */

static const char *const weights[] = {"1", "0.1", "0.01", "0.001", "0", "auto"};
enum { WEIGHT_COUNT = 6 };

static void judge_weights(cli_experiment *experiment, const char *mesh, const pel_run_summary runs[WEIGHT_COUNT])
{
    char name[64];
    for (int i = 0; i < 2; i++) {
        snprintf(name, sizeof name, "%s: volume lost with k_B %s", mesh, weights[i]);
        cli_experiment_limit(experiment, name, 1 - runs[i].volume_ratio_final, 0.07, "paper B: small change");
    }
    snprintf(name, sizeof name, "%s: volume with k_B 0.01 / with 0.1", mesh);
    cli_experiment_limit(experiment, name, runs[2].volume_ratio_final / runs[1].volume_ratio_final, 0.75,
                         "paper B: it shrinks");
    snprintf(name, sizeof name, "%s: rises, auto less than k_B 0.01", mesh);
    cli_experiment_limit(experiment, name, (double)(runs[5].volume_rises - runs[2].volume_rises), 0, own);
}

static pel_status run_figure_16_18(cli_experiment *experiment)
{
    pel_status status = PEL_OK;
    for (int mesh = 0; status == PEL_OK && mesh < MESH_COUNT; mesh++) {
        pel_run_summary summaries[WEIGHT_COUNT] = {{0}};
        for (int i = 0; status == PEL_OK && i < WEIGHT_COUNT; i++) {
            char run[64], weight[64];
            snprintf(run, sizeof run, "%s-%s", meshes[mesh].name, weights[i]);
            snprintf(weight, sizeof weight, "bodies.0.bending.weight=%s", weights[i]);
            const char *overrides[] = {meshes[mesh].override, weight, NULL};
            status = cli_experiment_run(experiment, run, shrink, overrides, &summaries[i]);
            tell(experiment, run, "volume at the end", summaries[i].volume_ratio_final);
            tell(experiment, run, "rises of the volume", (double)summaries[i].volume_rises);
        }
        if (status == PEL_OK)
            judge_weights(experiment, meshes[mesh].name, summaries);
    }
    static const exhibit what = {
        .title = "volume of shells with different weights of bending",
        .curves = {"sphere-1", "sphere-0.1", "sphere-0.01", "sphere-0.001", "sphere-0", "sphere-auto", "torus-0.01",
                   "torus-auto"},
        .curve_count = 8,
        .runs = {"sphere-1", "sphere-0.01", "sphere-0", "sphere-auto"},
        .labels = {"k_B 1", "k_B 0.01", "k_B 0", "k_B auto"},
        .frames = {50, -1},
        .elevation = 30,
    };
    return status == PEL_OK ? show(experiment, &what) : status;
}

const cli_experiment_case cli_figure_16_18 = {
    .name = "b-figure16-18",
    .doc = "paper B: the weight k_B of bending, and the one that is chosen by itself",
    .run = run_figure_16_18,
};

/* ---- figures 19 and 20: regions of fibres ---- */

/* none, and the three energies */
static const char *const fibres[] = {NULL, "arap", "sqrt", "stvk"};
enum { FIBRE_COUNT = 4 };

static pel_status run_fibres(cli_experiment *experiment, int mesh, double volumes[FIBRE_COUNT])
{
    pel_status status = PEL_OK;
    for (int i = 0; status == PEL_OK && i < FIBRE_COUNT; i++) {
        char run[64], region[160] = "bodies.0.anisotropy=";
        pel_run_summary summary = {0};
        snprintf(run, sizeof run, "%s-%s", meshes[mesh].name, i > 0 ? fibres[i] : "none");
        if (i > 0)
            snprintf(region, sizeof region, "bodies.0.anisotropy={ energy: %s, strength: 0.3, region: { sphere: %s } }",
                     fibres[i], meshes[mesh].region);
        const char *overrides[] = {meshes[mesh].override, region, NULL};
        status = cli_experiment_run(experiment, run, shrink, overrides, &summary);
        if (status == PEL_OK)
            status = volume_at(experiment, run, 65, &volumes[i]);
        if (status == PEL_OK)
            tell(experiment, run, "volume in frame 65", volumes[i]);
        tell(experiment, run, "frames", (double)summary.steps);
    }
    return status;
}

static pel_status run_figure_19_20(cli_experiment *experiment)
{
    pel_status status = PEL_OK;
    for (int mesh = 0; status == PEL_OK && mesh < 3; mesh++) {
        double volumes[FIBRE_COUNT] = {0};
        char name[64];
        status = run_fibres(experiment, mesh, volumes);
        for (int i = 1; i < FIBRE_COUNT; i++) {
            snprintf(name, sizeof name, "%s: volume with %s / without", meshes[mesh].name, fibres[i]);
            cli_experiment_limit(experiment, name, volumes[i] / volumes[0], 0.95, "paper B: smaller with fibres");
        }
        snprintf(name, sizeof name, "%s: arap - sqrt", meshes[mesh].name);
        cli_experiment_check(experiment, name, volumes[1] - volumes[2], 0, 1e-9, "theory: one and the same energy");
    }
    static const exhibit what = {
        .title = "volume without and with fibres",
        .curves = {"sphere-none", "sphere-arap", "sphere-stvk", "ellipsoid-none", "ellipsoid-arap", "torus-none",
                   "torus-arap"},
        .curve_count = 7,
        .runs = {"sphere-none", "sphere-arap", "sphere-sqrt", "sphere-stvk"},
        .labels = {"none", "arap", "sqrt", "stvk"},
        .frames = {50, 70},
        .elevation = 30,
    };
    return status == PEL_OK ? show(experiment, &what) : status;
}

const cli_experiment_case cli_figure_19_20 = {
    .name = "b-figure19-20",
    .doc = "paper B: regions of fibres that cave in, three energies",
    .run = run_figure_19_20,
};

/* ---- table 2: collision detection ---- */

static const char *const searches[2] = {"conservative", "bridson"};

static pel_status sum_column(cli_experiment *experiment, const char *run, const char *column, double *sum)
{
    cli_series series;
    pel_status status = cli_series_read(experiment, run, "frame", column, &series);
    *sum = 0;
    for (int i = 0; status == PEL_OK && i < series.count; i++)
        *sum += series.y[i];
    cli_series_free(&series);
    return status;
}

/* a mesh that shrinks and touches itself, with the numbers of its search, per frame */
static pel_status run_search(cli_experiment *experiment, int mesh, const char *method)
{
    char run[64], override[64], name[64];
    double pairs = 0, cubics = 0, milliseconds = 0;
    pel_run_summary summary;
    snprintf(run, sizeof run, "%s-%s", meshes[mesh].name, method);
    snprintf(override, sizeof override, "contact={ self: true, method: %s }", method);
    const char *overrides[] = {meshes[mesh].override, override, "bodies.0.bending.weight=auto",
                               "stop={ volume_ratio_below: 0.2, frames: 200 }", NULL};
    pel_status status = cli_experiment_run(experiment, run, shrink, overrides, &summary);
    if (status == PEL_OK)
        status = sum_column(experiment, run, "contact_candidates", &pairs);
    if (status == PEL_OK)
        status = sum_column(experiment, run, "contact_cubics", &cubics);
    if (status == PEL_OK)
        status = sum_column(experiment, run, "contact_find_ms", &milliseconds);
    if (status != PEL_OK)
        return status;
    tell(experiment, run, "volume at the end", summary.volume_ratio_final);
    tell(experiment, run, "pairs of boxes a frame", pairs / (double)summary.steps);
    tell(experiment, run, "cubics a frame", cubics / (double)summary.steps);
    tell(experiment, run, "search, ms a frame", milliseconds / (double)summary.steps);
    snprintf(name, sizeof name, "%.31s: intersections at the end", run);
    cli_experiment_limit(experiment, name, (double)summary.self_intersections_final, 0, "the guard");
    snprintf(name, sizeof name, "%.31s: cubics / pairs of boxes", run);
    /* of the pairs that have to be looked at: way that was searched before is not counted again */
    cli_experiment_limit(experiment, name, pairs > 0 ? cubics / pairs : 0, strcmp(method, "bridson") == 0 ? 0.25 : 0.02,
                         own);
    return PEL_OK;
}

static pel_status run_table_2(cli_experiment *experiment)
{
    pel_status status = PEL_OK;
    for (int mesh = 0; status == PEL_OK && mesh < MESH_COUNT; mesh++)
        for (int i = 0; status == PEL_OK && i < 2; i++)
            status = run_search(experiment, mesh, searches[i]);
    static const char *const runs[] = {"sphere-conservative", "ellipsoid-conservative", "torus-conservative",
                                       "capsule-conservative"};
    if (status == PEL_OK)
        status = plot_volumes(experiment, "volume of shells that touch themselves", runs, 4);
    const cli_picture picture = {.runs = {runs[0], runs[1], runs[2], runs[3]},
                                 .labels = {"sphere", "ellipsoid", "torus", "capsule"},
                                 .run_count = 4,
                                 .frames = {40, -1},
                                 .frame_count = 2,
                                 .azimuth = 35,
                                 .elevation = 30};
    return status == PEL_OK ? cli_experiment_draw(experiment, &picture) : status;
}

const cli_experiment_case cli_table_2 = {
    .name = "b-table2",
    .doc = "paper B: pairs and cubics of the collision detection, by the filters and axes and by the plain cubic",
    .run = run_table_2,
};
