/* Shells against mechanics: cases with a closed form, a one-dimensional solution, or an accepted number, over fineness,
   kinds of mesh and models of bending. */
#include "papers/own/validation.h"

#include "papers/own/cases.h"

#include <pellicle/mesh_io.h>
#include <pellicle/shape.h>
#include <pellicle/sim_ledger.h>
#include <pellicle/sim_reading.h>
#include <pellicle/sim_surface.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MESHES = 3, MODELS = 2, SIZES = OWN_SIZES, SCENE_SIZE = OWN_SCENE_SIZE };

static const char *const mesh_names[MESHES] = {"one-diagonal", "union-jack", "equilateral"};
static const char *const model_names[MODELS] = {"midedge", "hinge"};

static const double origin[3];

/* ---- one dimension ---- */

/* where the tip of a strip of length 1 ends, clamped level: along and down */
typedef struct tip {
    double along, down;
} tip;

/* turning of a level strip: theta'' = -load (1 - s if heavy, else 1) cos theta with theta'(0) = start, by Runge and
   Kutta; returns theta'(1), which is 0 at the free end */
static double shoot(double load, bool heavy, double start, tip *end)
{
    enum { STEPS = 2000 };
    static const double at[4] = {0, 0.5, 0.5, 1}, weight[4] = {1, 2, 2, 1};
    const double ds = 1.0 / STEPS;
    double y[4] = {0, start, 0, 0}; /* theta, theta', along, down */
    for (int i = 0; i < STEPS; i++) {
        double slope[4] = {0}, sum[4] = {0};
        for (int k = 0; k < 4; k++) {
            double theta = y[0] + at[k] * ds * slope[0], turning = y[1] + at[k] * ds * slope[1];
            double rest = heavy ? 1 - (i + at[k]) * ds : 1;
            slope[0] = turning;
            slope[1] = -load * rest * cos(theta);
            slope[2] = cos(theta);
            slope[3] = sin(theta);
            for (int c = 0; c < 4; c++)
                sum[c] += weight[k] * ds / 6 * slope[c];
        }
        for (int c = 0; c < 4; c++)
            y[c] += sum[c];
    }
    *end = (tip){y[2], y[3]};
    return y[1];
}

/* bisects between no rotation and the rotation of small deflections */
static tip solve_elastica(double load, bool heavy)
{
    double low = 0, high = heavy ? 0.5 * load : load;
    tip end = {1, 0};
    for (int i = 0; i < 60; i++) {
        double middle = 0.5 * (low + high);
        if (shoot(load, heavy, middle, &end) < 0)
            low = middle;
        else
            high = middle;
    }
    return end;
}

/* ---- solutions ---- */

/* quantities of a case: the displacement of the vertex nearest to a place at rest, and the ratio of volumes */
typedef struct answer {
    double displacement[3], volume_ratio;
} answer;

static pel_status read_answer(const pel_sim *sim, const double probe[3], answer *found, pel_error *error)
{
    size_t count = (size_t)pel_sim_vertex_count(sim, 0), nearest = 0;
    double *rest = calloc(6 * count, sizeof *rest), *x = rest + 3 * count, best = HUGE_VAL;
    if (rest == NULL)
        return pel_fail_memory(error);
    pel_sim_get_rest_positions(sim, 0, rest);
    pel_sim_get_positions(sim, 0, x);
    for (size_t v = 0; v < count; v++) {
        const double *r = rest + 3 * v;
        double distance = hypot(hypot(r[0] - probe[0], r[1] - probe[1]), r[2] - probe[2]);
        if (distance < best) {
            best = distance;
            nearest = v;
        }
    }
    for (size_t c = 0; c < 3; c++)
        found->displacement[c] = x[3 * nearest + c] - rest[3 * nearest + c];
    free(rest);
    return PEL_OK;
}

pel_status own_modes(const lab_experiment *experiment, const char *text, int count, double *values)
{
    lab_trial trial;
    pel_status status = lab_open_trial("validation", text, NULL, &trial, experiment->error);
    if (status == PEL_OK)
        status = pel_sim_step(trial.sim, experiment->error);
    if (status == PEL_OK && pel_sim_get_modes(trial.sim, NULL) == count)
        pel_sim_get_modes(trial.sim, values);
    lab_close_trial(&trial);
    return status;
}

/* runs a scene to its end, without a folder */
static pel_status solve(const lab_experiment *experiment, const char *text, const double probe[3], answer *found)
{
    lab_trial trial;
    *found = (answer){0};
    pel_status status = lab_open_trial("validation", text, NULL, &trial, experiment->error);
    if (status == PEL_OK)
        status = lab_step_trial(&trial, 3, experiment->error);
    if (status == PEL_OK) {
        pel_sim_measures measures;
        pel_sim_measure(trial.sim, &measures);
        status = read_answer(trial.sim, probe, found, experiment->error);
        found->volume_ratio = measures.volume_ratio;
    }
    lab_close_trial(&trial);
    return status;
}

/* ---- studies over fineness ---- */

static pel_status plot_study(const lab_experiment *experiment, const own_study *which,
                             double errors[MESHES * MODELS][SIZES])
{
    double sizes[SIZES];
    char names[MESHES * MODELS][64], file[64], path[LAB_PATH_SIZE];
    lab_plot plot = {.title = which->title,
                     .x_name = "cells along the side",
                     .y_name = "error / expected",
                     .log_x = true,
                     .log_y = true,
                     .curve_count = MESHES * which->models};
    for (int i = 0; i < SIZES; i++)
        sizes[i] = which->sizes[i];
    for (int c = 0; c < plot.curve_count; c++) {
        snprintf(names[c], sizeof names[c], "%s, %s", model_names[c / MESHES], mesh_names[c % MESHES]);
        plot.curves[c] = (lab_curve){names[c], sizes, errors[c], SIZES, true};
    }
    snprintf(file, sizeof file, "%s.svg", which->name);
    return lab_write_plot(lab_path(experiment, file, path), &plot, experiment->error);
}

pel_status own_run_study(lab_experiment *experiment, const own_study *which)
{
    double errors[MESHES * MODELS][SIZES];
    char text[SCENE_SIZE], name[64];
    lab_tell_run(experiment, which->name);
    for (int c = 0; c < MESHES * which->models; c++)
        for (int i = 0; i < SIZES; i++) {
            answer found;
            const char *model = model_names[c / MESHES], *mesh = mesh_names[c % MESHES];
            pel_status status = which->write(experiment, which->sizes[i], mesh, model, text);
            if (status == PEL_OK)
                status = solve(experiment, text, which->probe, &found);
            if (status != PEL_OK)
                return status;
            double value = 0;
            for (int k = 0; k < 3; k++)
                value += which->direction[k] * found.displacement[k];
            errors[c][i] = fmax(fabs(value / which->expected - 1), 1e-6);
            snprintf(name, sizeof name, "%s, %s, %s, %d", which->name, model, mesh, which->sizes[i]);
            if (c < MESHES && i == SIZES - 1)
                lab_expect(experiment, name, value, which->expected, which->tolerance * which->expected, which->source);
            else
                lab_tell(experiment, name, value, which->expected, which->source);
        }
    return plot_study(experiment, which, errors);
}

/* A strip of length 10, width 1 and thickness 0.1 (Sze, Liu, Lo 2004), E 1.2e6 and poisson 0, so that E I = 100, from
   x = 0 on. Hinges have no rotation that a support could hold: their first cells, before x = 0, are pinned, on
   equilateral meshes every other row by half a cell. */
static pel_status write_strip(int n, const char *mesh, const char *model, const char *load, char *text)
{
    bool clamped = strcmp(model, "midedge") == 0;
    double extra = clamped ? 0 : strcmp(mesh, "equilateral") == 0 ? 0.75 : 1, cell = 10 / (n + !clamped - extra);
    char held[128];
    snprintf(held, sizeof held,
             clamped ? "supports: [{ at: { box: { min: [-9, -9, -9], max: [%.17g, 9, 9] } }, rotation: fixed }]"
                     : "pinned: { box: { min: [-9, -9, -9], max: [%.17g, 9, 9] } }",
             clamped ? 1e-6 : 0.4 * cell);
    snprintf(
        text, SCENE_SIZE,
        "version: 1\n"
        "bodies:\n"
        "  - name: strip\n"
        "    mesh: { shape: grid, nx: %d, ny: %d, size_x: %.17g, size_y: 1, diagonals: %s, translate: [%.17g, 0, 0] }\n"
        "    membrane: { material: stvk, young: 1.2e6, poisson: 0, thickness: 0.1 }\n"
        "    mass: { density: 1000 }\n"
        "    bending: { model: %s }\n"
        "    %s\n"
        "%s"
        "solver: { method: static }\n"
        "stop: { frames: 3 }\n",
        n + !clamped, n / 8 < 2 ? 2 : n / 8, 10 + extra * cell, mesh, 5 - extra * cell / 2, model, held, load);
    return PEL_OK;
}

static pel_status write_cantilever(const lab_experiment *experiment, int n, const char *mesh, const char *model,
                                   char *text)
{
    (void)experiment;
    return write_strip(n, mesh, model,
                       "loads: [{ force: [0, 0, -4], at: { box: { min: [9.999, -9, -9], max: [11, 9, 9] } } }]\n",
                       text);
}

/* rolled up to a full circle by a moment 2 pi E I / L at its end */
static pel_status write_roll(const lab_experiment *experiment, int n, const char *mesh, const char *model, char *text)
{
    (void)experiment;
    char load[200];
    snprintf(load, sizeof load,
             "loads: [{ force: [0, %.17g, 0], per: moment, at: { box: { min: [9.999, -9, -9], max: [11, 9, 9] } } }]\n",
             -20 * 3.14159265358979323846);
    return write_strip(n, mesh, model, load, text);
}

/* a grid of nx x ny cells about the origin, of side 1 */
static pel_status make_grid(int nx, int ny, const char *mesh, pel_mesh **grid, pel_error *error)
{
    pel_shape_def def = pel_shape_def_default(PEL_SHAPE_GRID);
    def.nx = nx;
    def.ny = ny;
    def.diagonals = strcmp(mesh, mesh_names[0]) == 0   ? PEL_GRID_ONE_DIAGONAL
                    : strcmp(mesh, mesh_names[1]) == 0 ? PEL_GRID_UNION_JACK
                                                       : PEL_GRID_EQUILATERAL;
    return pel_shape_create(&def, grid, error);
}

/* numbers of the vertices on the border of a square grid of side 1 */
static pel_status write_border(int n, const char *mesh, char *text, size_t size, pel_error *error)
{
    pel_mesh *grid;
    pel_status status = make_grid(n, n, mesh, &grid, error);
    text[0] = '\0';
    for (int32_t v = 0; status == PEL_OK && v < grid->vertex_count; v++) {
        const double *x = grid->positions[v];
        size_t length = strlen(text);
        if (fmax(fabs(x[0]), fabs(x[1])) > 0.5 - 1e-6)
            snprintf(text + length, size - length, "%s%d", length > 0 ? ", " : "", (int)v);
    }
    pel_mesh_destroy(grid);
    return status;
}

static pel_status write_plate(const lab_experiment *experiment, int n, const char *mesh, const char *model, char *text)
{
    char border[1500];
    pel_status status = write_border(n, mesh, border, sizeof border, experiment->error);
    snprintf(text, SCENE_SIZE,
             "version: 1\n"
             "bodies:\n"
             "  - name: plate\n"
             "    mesh: { shape: grid, nx: %d, ny: %d, diagonals: %s }\n"
             "    membrane: { material: stvk, young: 1.0e9, poisson: 0.3, thickness: 0.01 }\n"
             "    mass: { density: 1000 }\n"
             "    bending: { model: %s }\n"
             "    pinned: { vertices: [%s] }\n"
             "gravity: [0, 0, -0.01]\n"
             "solver: { method: static }\n"
             "stop: { frames: 3 }\n",
             n, n, mesh, model, border);
    return status;
}

/* ---- curved shells: a quarter or an eighth, on symmetry planes ---- */

/* a grid laid over the surface: u and v from 0 to 1, cells_u of them along u */
static pel_status write_surface(const lab_experiment *experiment, const char *name, int cells_u, int n,
                                const char *mesh, void (*place)(double u, double v, double x[3]), char *path)
{
    pel_mesh *grid;
    char file[64];
    pel_status status = make_grid(cells_u, n, mesh, &grid, experiment->error);
    if (status != PEL_OK)
        return status;
    for (int32_t v = 0; v < grid->vertex_count; v++)
        place(grid->positions[v][0] + 0.5, grid->positions[v][1] + 0.5, grid->positions[v]);
    snprintf(file, sizeof file, "%s-%s-%d.ply", name, mesh, n);
    status = pel_mesh_write(lab_path(experiment, file, path), PEL_FORMAT_PLY, grid, NULL, experiment->error);
    pel_mesh_destroy(grid);
    return status;
}

pel_status own_write_shell(const lab_experiment *experiment, const char *name, int cells_u, int n, const char *mesh,
                           const char *model, void (*place)(double u, double v, double x[3]), const char *rest,
                           char *text)
{
    char path[LAB_PATH_SIZE];
    pel_status status = write_surface(experiment, name, cells_u, n, mesh, place, path);
    snprintf(text, SCENE_SIZE,
             "version: 1\n"
             "bodies:\n"
             "  - name: shell\n"
             "    mesh: { file: \"%s\" }\n"
             "    bending: { model: %s }\n"
             "%s"
             "solver: { method: static }\n"
             "stop: { frames: 3 }\n",
             path, model, rest);
    return status;
}

static void place_roof(double u, double v, double x[3])
{
    double angle = v * 40 * 3.14159265358979323846 / 180;
    x[0] = 25 * u;
    x[1] = 25 * sin(angle);
    x[2] = 25 * cos(angle);
}

/* a thousandth of the load, so that the answer is linear */
static pel_status write_roof(const lab_experiment *experiment, int n, const char *mesh, const char *model, char *text)
{
    return own_write_shell(experiment, "roof", n, n, mesh, model, place_roof,
                           "    membrane: { material: stvk, young: 4.32e8, poisson: 0, thickness: 0.25 }\n"
                           "    mass: { density: 360 }\n"
                           "    supports:\n"
                           "      - { at: { box: { min: [-1, -99, -99], max: [1.0e-5, 99, 99] } }, fix: [y, z] }\n"
                           "      - { at: { box: { min: [24.99999, -99, -99], max: [99, 99, 99] } }, symmetry: x }\n"
                           "      - { at: { box: { min: [-99, -1, -99], max: [99, 1.0e-5, 99] } }, symmetry: y }\n"
                           "gravity: [0, 0, -0.001]\n",
                           text);
}

static void place_cylinder(double u, double v, double x[3])
{
    double angle = v * 3.14159265358979323846 / 2;
    x[0] = 300 * u;
    x[1] = 300 * sin(angle);
    x[2] = 300 * cos(angle);
}

static pel_status write_cylinder(const lab_experiment *experiment, int n, const char *mesh, const char *model,
                                 char *text)
{
    return own_write_shell(
        experiment, "cylinder", n, n, mesh, model, place_cylinder,
        "    membrane: { material: stvk, young: 3.0e6, poisson: 0.3, thickness: 3 }\n"
        "    mass: { density: 1000 }\n"
        "    supports:\n"
        "      - { at: { box: { min: [-1, -999, -999], max: [1.0e-4, 999, 999] } }, fix: [y, z] }\n"
        "      - { at: { box: { min: [299.9999, -999, -999], max: [999, 999, 999] } }, symmetry: x }\n"
        "      - { at: { box: { min: [-999, -1, -999], max: [999, 1.0e-4, 999] } }, symmetry: y }\n"
        "      - { at: { box: { min: [-999, -999, -1], max: [999, 999, 1.0e-4] } }, symmetry: z }\n"
        "loads: [{ force: [0, 0, -0.25], at: { nearest: [300, 0, 300] } }]\n",
        text);
}

/* the equator lies at v = 0, the hole of 18 degrees at v = 1 */
static void place_hemisphere(double u, double v, double x[3])
{
    const double pi = 3.14159265358979323846;
    double turn = u * pi / 2, height = v * 72 * pi / 180;
    x[0] = 10 * cos(height) * cos(turn);
    x[1] = 10 * cos(height) * sin(turn);
    x[2] = 10 * sin(height);
}

/* pulled by a load [N] along x, and pressed by it along y */
static pel_status write_loaded_hemisphere(const lab_experiment *experiment, int n, const char *mesh, const char *model,
                                          double load, char *text)
{
    char keys[900];
    snprintf(keys, sizeof keys,
             "    membrane: { material: stvk, young: 6.825e7, poisson: 0.3, thickness: 0.04 }\n"
             "    mass: { density: 1000 }\n"
             "    supports:\n"
             "      - { at: { box: { min: [-1, -99, -99], max: [1.0e-5, 99, 99] } }, symmetry: x }\n"
             "      - { at: { box: { min: [-99, -1, -99], max: [99, 1.0e-5, 99] } }, symmetry: y }\n"
             "      - { at: { nearest: [10, 0, 0] }, fix: [z] }\n"
             "loads:\n"
             "  - { force: [%g, 0, 0], at: { nearest: [10, 0, 0] } }\n"
             "  - { force: [0, %g, 0], at: { nearest: [0, 10, 0] } }\n",
             load, -load);
    return own_write_shell(experiment, "hemisphere", n, n, mesh, model, place_hemisphere, keys, text);
}

/* a hundredth of the load, so that the answer is linear */
static pel_status write_hemisphere(const lab_experiment *experiment, int n, const char *mesh, const char *model,
                                   char *text)
{
    return write_loaded_hemisphere(experiment, n, mesh, model, 0.01, text);
}

static pel_status write_deep_hemisphere(const lab_experiment *experiment, int n, const char *mesh, const char *model,
                                        char *text)
{
    return write_loaded_hemisphere(experiment, n, mesh, model, 200, text);
}

/* once around, but for a slit of a thousandth of the width */
static void place_annulus(double u, double v, double x[3])
{
    double radius = 6 + 4 * u, angle = v * (2 * 3.14159265358979323846 - 4e-4);
    x[0] = radius * cos(angle);
    x[1] = radius * sin(angle);
    x[2] = 0;
}

static pel_status write_annulus(const lab_experiment *experiment, int n, const char *mesh, const char *model,
                                char *text)
{
    return own_write_shell(experiment, "annulus", n / 8, n, mesh, model, place_annulus,
                           "    membrane: { material: stvk, young: 2.1e7, poisson: 0, thickness: 0.03 }\n"
                           "    mass: { density: 1000 }\n"
                           "    supports:\n"
                           "      - { at: { box: { min: [5, -0.01, -1], max: [11, -1.0e-3, 1] } }, rotation: fixed }\n"
                           "loads: [{ force: [0, 0, 0.8], per: length,\n"
                           "          at: { box: { min: [5, -1.0e-6, -1], max: [11, 1.0e-6, 1] } } }]\n",
                           text);
}

/* 1 / D of the plate, and in its row the load q L^4 of a weight q = 1000 x 0.01 x 0.01; the point of the roof is at 40
   degrees on a radius of 25 */
#define PLATE_COMPLIANCE (12 * (1 - 0.3 * 0.3) / (1e9 * 0.01 * 0.01 * 0.01))

static const own_study studies[] = {
    {"cantilever",
     "cantilever under an end shear, P L^2 / E I = 4",
     write_cantilever,
     2,
     {16, 32, 64},
     {10, 0, 0},
     {0, 0, -1},
     6.698,
     0.01,
     "Sze, Liu, Lo 2004"},
    {"plate",
     "square plate on simple supports under its weight",
     write_plate,
     2,
     {8, 16, 32},
     {0, 0, 0},
     {0, 0, -1},
     0.00406235 * 0.1 * PLATE_COMPLIANCE,
     0.01,
     "Timoshenko 1959, 0.00406 q L^4 / D"},
    {"roof",
     "Scordelis-Lo roof",
     write_roof,
     1,
     {10, 20, 40},
     {25, 16.069690242163482, 19.151111077974451},
     {0, 0, -1},
     0.3024e-3,
     0.02,
     "Belytschko et al. 1985"},
    {"cylinder",
     "pinched cylinder with diaphragms",
     write_cylinder,
     1,
     {25, 50, 100},
     {300, 0, 300},
     {0, 0, -1},
     1.8248e-5,
     0.03,
     "Belytschko et al. 1985"},
    {"hemisphere",
     "pinched hemisphere with a hole of 18 degrees",
     write_hemisphere,
     1,
     {16, 32, 64},
     {10, 0, 0},
     {1, 0, 0},
     0.094e-2,
     0.015,
     "Simo, Fox, Rifai 1989"},
    {"roll",
     "strip rolled up to a full circle by a moment at its end",
     write_roll,
     1,
     {16, 32, 64},
     {10, 0, 0},
     {-1, 0, 0},
     10,
     0.01,
     "a full circle"},
    {"deep-hemisphere-out",
     "pinched hemisphere under F = 400, way out",
     write_deep_hemisphere,
     1,
     {8, 16, 32},
     {10, 0, 0},
     {1, 0, 0},
     4.067,
     0.015,
     "Sze, Liu, Lo 2004"},
    {"deep-hemisphere-in",
     "pinched hemisphere under F = 400, way in",
     write_deep_hemisphere,
     1,
     {8, 16, 32},
     {0, 10, 0},
     {0, -1, 0},
     8.178,
     0.015,
     "Sze, Liu, Lo 2004"},
    {"annulus",
     "slit annular plate under a line force of 0.8, outer corner",
     write_annulus,
     1,
     {32, 64, 96},
     {10, 0, 0},
     {0, 0, 1},
     17.528,
     0.015,
     "Sze, Liu, Lo 2004"},
};

static pel_status check_studies(lab_experiment *experiment)
{
    pel_status status = PEL_OK;
    for (size_t i = 0; status == PEL_OK && i < sizeof studies / sizeof *studies; i++)
        status = own_run_study(experiment, &studies[i]);
    return status;
}

/* ---- single cases ---- */

/* strips under their weight, compared with the one-dimensional solution */
static pel_status check_elastica(lab_experiment *experiment)
{
    static const double loads[4] = {1, 5, 10, 20}, end[3] = {10, 0, 0};
    for (int i = 0; i < 4; i++)
        for (int m = 0; m < MODELS; m++) {
            /* weight per length w = 100, E I = 100: load = w g L^3 / E I */
            char text[SCENE_SIZE], load[128], name[64];
            answer found;
            tip expected = solve_elastica(loads[i], true);
            snprintf(load, sizeof load, "gravity: [0, 0, %.17g]\n", -loads[i] / 1000);
            pel_status status = write_strip(64, mesh_names[1], model_names[m], load, text);
            if (status == PEL_OK)
                status = solve(experiment, text, end, &found);
            if (status != PEL_OK)
                return status;
            snprintf(name, sizeof name, "heavy strip, load %g, %s: tip down", loads[i], model_names[m]);
            if (m == 0)
                lab_expect(experiment, name, -found.displacement[2] / 10, expected.down, 0.005 * expected.down,
                           "solution in one dimension");
            else
                lab_tell(experiment, name, -found.displacement[2] / 10, expected.down, "solution in one dimension");
            snprintf(name, sizeof name, "heavy strip, load %g, %s: tip along", loads[i], model_names[m]);
            if (m == 0)
                lab_expect(experiment, name, 1 + found.displacement[0] / 10, expected.along, 0.005,
                           "solution in one dimension");
        }
    return PEL_OK;
}

/* the number that Sze and others give for the strip with an end shear, by the solver of this file */
static void check_one_dimension(lab_experiment *experiment)
{
    tip end = solve_elastica(4, false);
    lab_expect(experiment, "one dimension: tip down, end shear 4", 10 * end.down, 6.698, 0.005, "Sze, Liu, Lo 2004");
    lab_expect(experiment, "one dimension: tip back, end shear 4", 10 * (1 - end.along), 3.286, 0.005,
               "Sze, Liu, Lo 2004");
}

static void write_ball(int frequency, double radius, const char *membrane, const char *model, double pressure,
                       char *text)
{
    snprintf(text, SCENE_SIZE,
             "version: 1\n"
             "bodies:\n"
             "  - name: ball\n"
             "    mesh: { shape: geodesic-sphere, frequency: %d, radius: %g }\n"
             "    membrane: %s\n"
             "    bending: { model: %s }\n"
             "    pressure: { inside: %.17g }\n"
             "solver: { method: static }\n"
             "stop: { frames: 3 }\n",
             frequency, radius, membrane, model, pressure);
}

static pel_status check_spheres(lab_experiment *experiment)
{
    static const struct {
        int frequency;
        double tolerance;
    } levels[] = {{8, 0.01}, {16, 0.002}, {32, 0.0005}};
    for (int i = 0; i < 3; i++)
        for (int m = 0; m < MODELS; m++) {
            char text[SCENE_SIZE], name[64];
            answer found;
            write_ball(levels[i].frequency, 1, "{ young: 1, poisson: 0.3, thickness: 0.01 }", model_names[m], 1e-6,
                       text);
            pel_status status = solve(experiment, text, origin, &found);
            if (status != PEL_OK)
                return status;
            snprintf(name, sizeof name, "sphere, %s, %d triangles: displacement / exact", model_names[m],
                     20 * levels[i].frequency * levels[i].frequency);
            lab_expect(experiment, name, (cbrt(found.volume_ratio) - 1) / (1e-6 * 0.7 / 0.02), 1, levels[i].tolerance,
                       "p R^2 (1 - nu) / (2 E h)");
        }
    return PEL_OK;
}

/* balls of all presets under the pressure of 1 % strain in linear theory */
static pel_status check_presets(lab_experiment *experiment)
{
    static const struct {
        const char *name;
        double young, poisson, thickness;
    } presets[] = {
        {"lens-capsule", 1.5e6, 0.47, 1.5e-5},   {"skin", 1.29e5, 0.48, 1.5e-3},
        {"rubber", 1.17e6, 0.5, 1e-3},           {"latex-balloon", 9.9e5, 0.5, 2.5e-4},
        {"silicone", 1.18e5, 0.49, 2e-3},        {"paper", 3e9, 0.3, 1e-4},
        {"polyester-film", 4.9e9, 0.38, 2.3e-5}, {"aluminium-foil", 7e10, 0.33, 1.6e-5},
        {"steel-sheet", 2.1e11, 0.3, 5e-4},
    };
    for (size_t i = 0; i < sizeof presets / sizeof *presets; i++) {
        char text[SCENE_SIZE], membrane[64], name[64];
        answer found;
        double stiffness = 2 * presets[i].young * presets[i].thickness / (1 - presets[i].poisson);
        snprintf(membrane, sizeof membrane, "{ preset: %s }", presets[i].name);
        write_ball(8, 0.05, membrane, "midedge", 0.01 * stiffness / 0.05, text);
        pel_status status = solve(experiment, text, origin, &found);
        if (status != PEL_OK)
            return status;
        snprintf(name, sizeof name, "%s: strain of a ball / linear", presets[i].name);
        lab_expect(experiment, name, (cbrt(found.volume_ratio) - 1) / 0.01, 1, 0.05, "1 % in linear theory");
    }
    return PEL_OK;
}

static pel_status run_validation(lab_experiment *experiment)
{
    check_one_dimension(experiment);
    pel_status status = check_studies(experiment);
    if (status == PEL_OK)
        status = check_elastica(experiment);
    if (status == PEL_OK)
        status = check_spheres(experiment);
    if (status == PEL_OK)
        status = check_presets(experiment);
    if (status == PEL_OK)
        status = own_validate_modes(experiment);
    if (status == PEL_OK)
        status = own_validate_paths(experiment);
    return status == PEL_OK ? own_validate_classics(experiment) : status;
}

const lab_case own_validation = {
    .name = "validation",
    .doc = "shells against mechanics, over fineness, meshes and models of bending",
    .group = "own",
    .origin = LAB_THEORY,
    .run = run_validation,
};
