/* Figure 15 and table 1 of paper B: minimisation of the energy by gradient descent, and distance constraints, compared
   with the paper's method. */
#include "papers/b/descend.h"
#include "papers/b/shrink.h"

#include <pellicle/measure.h>
#include <pellicle/mesh_io.h>

#include <math.h>
#include <stdlib.h>

/* ---- figure 15 ---- */

enum { FRAMES = 30 };

/* "by the elastic energy": E_S alone, and no contact */
#define E_S_ALONE "bodies.0.bending=", "contact="

typedef struct shapes {
    char names[2][64]; /* of the files with the last frames: pbd, gradient descent */
    b_shrunk made[2];
    double iterations; /* of gradient descent in a frame */
    double energy;     /* of gradient descent over that of pbd in the last frame */
} shapes;

/* The body by gradient descent, from frame to frame to the energy that pbd leaves in it. */
static pel_status descend(lab_experiment *experiment, int body, const pel_mesh *rest, const double *energies,
                          shapes *made)
{
    char path[LAB_PATH_SIZE];
    pel_mesh *mesh = NULL;
    const b_descent def = {.young = 1e5,
                           .poisson = 0.3,
                           .density = 1000,
                           .thickness = 0.01,
                           .pressure = experiment->bodies[body].pressure,
                           .dt = 1.0 / 60,
                           .frames = FRAMES,
                           .energies = energies,
                           .most = 500};
    int iterations;
    double(*positions)[3] = calloc((size_t)rest->vertex_count, sizeof *positions);
    if (positions == NULL)
        return pel_fail_memory(experiment->error);
    lab_tell_run(experiment, b_run_name(experiment, body, "descent.ply", made->names[1]));
    pel_status status = b_descend(rest, &def, positions, &iterations, experiment->error);
    made->iterations = (double)iterations / FRAMES;
    if (status == PEL_OK)
        status = pel_mesh_create(positions[0], rest->vertex_count, rest->triangles[0], rest->triangle_count, &mesh,
                                 experiment->error);
    free(positions);
    if (status == PEL_OK)
        status = b_compare(&experiment->bodies[body], rest, mesh, &made->made[1], experiment->error);
    if (status == PEL_OK)
        status =
            pel_mesh_write(lab_path(experiment, made->names[1], path), PEL_FORMAT_AUTO, mesh, NULL, experiment->error);
    pel_mesh_destroy(mesh);
    return status;
}

static pel_status run_shapes(lab_experiment *experiment, int body, shapes *made)
{
    const char *settings[] = {E_S_ALONE, "stop.frames=30", NULL};
    char run[64];
    pel_mesh *rest = NULL;
    pel_run_summary summary;
    lab_series series = {0};
    pel_status status = b_shrink(experiment, body, "pbd", settings, &summary);
    b_run_name(experiment, body, "pbd", run);
    snprintf(made->names[0], sizeof made->names[0], "%.50s/final.ply", run);
    if (status == PEL_OK)
        status = b_measure(experiment, body, run, FRAMES, &made->made[0]);
    if (status == PEL_OK)
        status = b_read_frame(experiment, run, 0, &rest);
    if (status == PEL_OK)
        status = lab_read_series(experiment, run, "frame", "membrane_energy", &series);
    if (status == PEL_OK && series.count <= FRAMES)
        status = pel_fail(experiment->error, PEL_BAD_FORMAT, "the run has fewer than %d frames", (int)FRAMES);
    if (status == PEL_OK)
        status = descend(experiment, body, rest, series.y, made);
    lab_free_series(&series);
    pel_mesh_destroy(rest);
    return status;
}

static pel_status run_figure_15(lab_experiment *experiment)
{
    int count = b_shown(experiment);
    static shapes made[B_SHOWN];
    pel_status status = PEL_OK;
    for (int body = 0; status == PEL_OK && body < count; body++)
        status = run_shapes(experiment, body, &made[body]);
    if (status != PEL_OK)
        return status;
    lab_begin_claim(experiment, LAB_PAPER, "the two shapes are similar in frame 30", NULL);
    for (int body = 0; body < count; body++) {
        b_expect(experiment, body, "displacement of the body, gradient descent / pbd",
                 made[body].made[1].body_way / made[body].made[0].body_way, 1, 0.25,
                 B_PAPER ", figure 15; 0.25 is ours");
        b_tell(experiment, body, "iterations of gradient descent a frame", made[body].iterations, 5, "sweeps of pbd");
    }
    lab_begin_claim(experiment, LAB_PAPER, "that of gradient descent is rougher",
                    "on the liver both are equally rough, at half of pbd's energy too (1.03); there gradient descent "
                    "comes nearer to pbd on the others (.99 and .96)");
    for (int body = 0; body < count; body++)
        b_at_most(experiment, body, "roughness, pbd / gradient descent",
                  made[body].made[0].roughness / made[body].made[1].roughness, 1, B_PAPER ", figure 15");
    static const char *const labels[2] = {"pbd", "gradient descent"};
    lab_picture picture =
        b_begin_pairs("frame 30 by position-based dynamics and by gradient descent to the same energy", 0, count);
    for (int body = 0; body < count; body++)
        b_add_pair(&picture, labels, made[body].names);
    return lab_add_picture(experiment, &picture);
}

const lab_case b_figure_15 = {
    .name = "b-figure15",
    .doc = "position-based dynamics and minimisation of the energy",
    .group = "paper B",
    .place = "section 6, figure 15",
    .run = run_figure_15,
};

/* ---- table 1 ---- */

enum { METHODS = 3, ENERGIES = 0, MINIMISED = 1, DISTANCES = 2 };

/* the quickest step of a run: least affected by other load on the machine [ms] */
static pel_status least_step(const lab_experiment *experiment, const char *run, double *milliseconds)
{
    lab_series series;
    pel_status status = lab_read_series(experiment, run, "frame", "step_ms", &series);
    *milliseconds = (double)HUGE_VAL;
    for (int i = 1; status == PEL_OK && i < series.count; i++)
        *milliseconds = fmin(*milliseconds, series.y[i]);
    lab_free_series(&series);
    return status;
}

static pel_status time_method(lab_experiment *experiment, int body, int method, double *milliseconds, double *triangles)
{
    static const char *const methods[METHODS] = {"pbd", "gradient", "pbd-distance"};
    static const char *const solvers[METHODS] = {"solver.method=pbd", "solver.method=descent",
                                                 "solver.method=pbd-distance"};
    char name[64];
    pel_run_summary summary = {0};
    const char *settings[] = {
        solvers[method],
        "solver.descent=gradient",
        method == MINIMISED ? "solver.iterations=50" : "solver.iterations=5",
        /* one shape for all: beyond the buckling pressure there is no equilibrium to minimise to */
        "bodies.0.pressure={ volume: { target: { keys: [[0, 1], [0.5, 0.8]] }, bulk: 500 } }",
        E_S_ALONE,
        "stop.frames=15",
        "solver.threads=1",
        NULL,
    };
    pel_status status = b_shrink(experiment, body, methods[method], settings, &summary);
    *triangles = (double)summary.triangles_final;
    b_run_name(experiment, body, methods[method], name);
    return status == PEL_OK ? least_step(experiment, name, milliseconds) : status;
}

static void tabulate(lab_experiment *experiment, double times[B_SHOWN][METHODS], const double triangles[B_SHOWN])
{
    char cells[240];
    lab_begin_table(
        experiment,
        "Table 1: the least ms a frame on one thread, five sweeps or 50 iterations of gradient descent (the text of "
        "the paper says much and little time of its own numbers)",
        "body|triangles|the paper's method|minimisation|distances|minimisation / method|distances / method");
    for (int body = 0; body < b_shown(experiment); body++) {
        const double *time = times[body];
        snprintf(cells, sizeof cells, "%.40s|%.0f|%.3g ms|%.3g ms|%.3g ms|%.3g|%.3g", experiment->bodies[body].name,
                 triangles[body], time[ENERGIES], time[MINIMISED], time[DISTANCES], time[MINIMISED] / time[ENERGIES],
                 time[DISTANCES] / time[ENERGIES]);
        lab_add_row(experiment, cells);
    }
}

static pel_status run_table_1(lab_experiment *experiment)
{
    double times[B_SHOWN][METHODS] = {{0}}, triangles[B_SHOWN] = {0};
    pel_status status = PEL_OK;
    for (int body = 0; body < b_shown(experiment); body++)
        for (int i = 0; status == PEL_OK && i < METHODS; i++)
            status = time_method(experiment, body, i, &times[body][i], &triangles[body]);
    if (status != PEL_OK)
        return status;
    lab_begin_claim(experiment, LAB_PAPER, "minimisation by gradient descent takes far longer", NULL);
    for (int body = 0; body < b_shown(experiment); body++)
        b_at_least(experiment, body, "time, gradient descent / pbd", times[body][MINIMISED] / times[body][ENERGIES], 5,
                   B_PAPER ", section 6, table 1; 5 is ours");
    lab_begin_claim(experiment, LAB_PAPER, "distances take less time than energies",
                    "steps of about a millisecond on a machine that does other work");
    lab_by_construction(experiment, "a distance moves two vertices and needs no strain");
    for (int body = 0; body < b_shown(experiment); body++)
        b_at_most(experiment, body, "time, distances / pbd", times[body][DISTANCES] / times[body][ENERGIES], 1,
                  B_PAPER ", section 6, table 1");
    tabulate(experiment, times, triangles);
    return PEL_OK;
}

const lab_case b_table_1 = {
    .name = "b-table1",
    .doc = "times of the paper's method, of minimisation and of distance constraints",
    .group = "paper B",
    .place = "section 6, table 1",
    .run = run_table_1,
};
