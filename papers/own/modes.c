/* Validation: frequencies of plates and strips, buckling of strips and spheres, and the energy of a shell that
 * vibrates.
 */
#include "papers/own/ritz.h"
#include "papers/own/validation.h"

#include <pellicle/bending.h>
#include <pellicle/mesh_io.h>
#include <pellicle/sim_ledger.h>
#include <pellicle/sim_surface.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MODES = 6 };

/* ---- plates and strips ---- */

/* free, of length 1; six rigid motions come first. In-plane modes of such thin strips have higher frequencies. */
static pel_status check_free(lab_experiment *experiment, const char *name, double width, int along, int across)
{
    const double poisson = 0.3, stiffness = pel_bending_stiffness(1e9, poisson, 0.001);
    const ritz_plate plate = {.width = width, .poisson = poisson};
    double expected[MODES], found[6 + MODES];
    char text[OWN_SCENE_SIZE], line[64];
    if (!ritz_solve(&plate, MODES, expected))
        return pel_fail_memory(experiment->error);
    snprintf(text, sizeof text,
             "version: 1\n"
             "bodies:\n"
             "  - mesh: { shape: grid, nx: %d, ny: %d, size_x: 1, size_y: %g, diagonals: union-jack }\n"
             "    membrane: { material: stvk, young: 1.0e9, poisson: %g, thickness: 0.001 }\n"
             "    mass: { density: 1000 }\n"
             "    bending: { model: midedge }\n"
             "solver: { analysis: modal, modes: %d }\n",
             along, across, width, poisson, 6 + MODES);
    pel_status status = own_modes(experiment, text, 6 + MODES, found);
    for (int m = 0; status == PEL_OK && m < MODES; m++) {
        double hertz = sqrt(expected[m] * stiffness) / (2 * 3.14159265358979323846);
        snprintf(line, sizeof line, "%s, frequency %d", name, m + 1);
        lab_expect(experiment, line, found[6 + m], hertz, 0.01 * hertz, "own Ritz, thin plates");
    }
    return status;
}

/* a strip that is bent in its plane by a force at its end turns over */
static pel_status check_lateral(lab_experiment *experiment, double width)
{
    const ritz_plate plate = {.width = width, .poisson = 0.3, .is_clamped = true, .buckles = true};
    double factor, found;
    char text[OWN_SCENE_SIZE], line[64];
    if (!ritz_solve(&plate, 1, &factor))
        return pel_fail_memory(experiment->error);
    snprintf(text, sizeof text,
             "version: 1\n"
             "bodies:\n"
             "  - mesh: { shape: grid, nx: 60, ny: %g, size_y: %g, diagonals: union-jack, translate: [0.5, 0, 0] }\n"
             "    membrane: { material: stvk, young: 1.0e9, poisson: 0.3, thickness: 0.001 }\n"
             "    bending: { model: midedge }\n"
             "    supports: [{ at: { box: { min: [-1, -1, -1], max: [1.0e-6, 1, 1] } }, rotation: fixed }]\n"
             "loads: [{ force: [0, -1, 0], at: { box: { min: [0.99999, -1, -1], max: [2, 1, 1] } } }]\n"
             "solver: { analysis: buckling, modes: 1 }\n",
             60 * width, width);
    pel_status status = own_modes(experiment, text, 1, &found);
    factor *= pel_bending_stiffness(1e9, 0.3, 0.001);
    snprintf(line, sizeof line, "lateral buckling, width / length %g: force", width);
    if (status == PEL_OK)
        lab_expect(experiment, line, found, factor, 0.02 * factor, "own Ritz, thin plates");
    return status;
}

/* ---- spheres ---- */

/* Linear buckling of a sphere of radius 1 under outside pressure with displacements w Y and v grad Y, Y a spherical
   harmonic of degree n and L = n (n + 1): membrane strain v grad grad Y + w Y, bending (v - w) grad grad Y (Koiter and
   Sanders), second Piola stress -p / 2. With C = E h / (1 - nu^2) and D the energy is

       C [(L^2 - (1 - nu) L) v^2 - 2 (1 + nu) L v w + 2 (1 + nu) w^2] + D (L^2 - (1 - nu) L) (v - w)^2
         - p (L / 2 - 1) (w^2 + L v^2)

   Zoelly's pressure is the limit of small h. Modes are even in x, y and z: the modes of an eighth with planes of
   symmetry. */
static double sphere_pressure(double young, double poisson, double thickness)
{
    double least = HUGE_VAL;
    for (int n = 2; n < 80; n += 2) {
        double l = n * (n + 1.0), c = young * thickness / (1 - poisson * poisson);
        double inner = l * l - (1 - poisson) * l, bending = pel_bending_stiffness(young, poisson, thickness) * inner;
        double ww = 2 * (1 + poisson) * c + bending, vw = -(1 + poisson) * l * c - bending, vv = inner * c + bending;
        double g = l / 2 - 1, a = g * g * l, b = g * (ww * l + vv), d = ww * vv - vw * vw;
        least = fmin(least, (b - sqrt(b * b - 4 * a * d)) / (2 * a));
    }
    return least;
}

/* an eighth of a sphere: a face of an octahedron of n edges a side, its vertices moved out */
static pel_status write_eighth(const lab_experiment *experiment, int n, char *path)
{
    pel_mesh *mesh;
    int32_t vertices = (n + 1) * (n + 2) / 2, triangles = n * n, at = 0;
    double(*positions)[3] = calloc((size_t)vertices, sizeof *positions);
    int32_t(*corners)[3] = calloc((size_t)triangles, sizeof *corners);
    for (int i = 0, v = 0; positions != NULL && corners != NULL && i <= n; i++)
        for (int j = 0; j <= n - i; j++, v++) {
            double x = i, y = j, z = n - i - j, length = sqrt(x * x + y * y + z * z);
            int32_t above = v + n - i + 1;
            positions[v][0] = x / length;
            positions[v][1] = y / length;
            positions[v][2] = z / length;
            if (j < n - i) {
                corners[at][0] = v;
                corners[at][1] = above;
                corners[at++][2] = v + 1;
            }
            if (j < n - i - 1) {
                corners[at][0] = v + 1;
                corners[at][1] = above;
                corners[at++][2] = above + 1;
            }
        }
    pel_status status = positions != NULL && corners != NULL
                            ? pel_mesh_create(positions[0], vertices, corners[0], triangles, &mesh, experiment->error)
                            : pel_fail_memory(experiment->error);
    free(positions);
    free(corners);
    if (status != PEL_OK)
        return status;
    status = pel_mesh_write(lab_path(experiment, "eighth.ply", path), PEL_FORMAT_PLY, mesh, NULL, experiment->error);
    pel_mesh_destroy(mesh);
    return status;
}

static pel_status check_sphere(lab_experiment *experiment, const char *path, double thickness)
{
    double found, expected = sphere_pressure(1e9, 0.3, thickness);
    double zoelly = 2e9 * thickness * thickness / sqrt(3 * (1 - 0.09));
    char text[OWN_SCENE_SIZE], line[64];
    snprintf(text, sizeof text,
             "version: 1\n"
             "bodies:\n"
             "  - mesh: { file: \"%s\" }\n"
             "    membrane: { material: stvk, young: 1.0e9, poisson: 0.3, thickness: %g }\n"
             "    bending: { model: midedge }\n"
             "    pressure: { outside: 1000 }\n"
             "    supports:\n"
             "      - { at: { box: { min: [-1, -1, -1], max: [1.0e-9, 2, 2] } }, symmetry: x }\n"
             "      - { at: { box: { min: [-1, -1, -1], max: [2, 1.0e-9, 2] } }, symmetry: y }\n"
             "      - { at: { box: { min: [-1, -1, -1], max: [2, 2, 1.0e-9] } }, symmetry: z }\n"
             "solver: { analysis: buckling, modes: 1 }\n",
             path, thickness);
    pel_status status = own_modes(experiment, text, 1, &found);
    if (status != PEL_OK)
        return status;
    snprintf(line, sizeof line, "buckling sphere, R/h %g: over exact", 1 / thickness);
    lab_expect(experiment, line, 1000 * found / expected, 1, 0.02, "spherical harmonics, Koiter and Sanders");
    snprintf(line, sizeof line, "buckling sphere, R/h %g: over Zoelly", 1 / thickness);
    lab_tell(experiment, line, 1000 * found / zoelly, 1, "Zoelly 1915, limit of small h/R");
    return PEL_OK;
}

/* ---- energy of a vibration ---- */

/* a ball that was drawn out and let go, by the midpoint rule */
static pel_status check_vibration(lab_experiment *experiment)
{
    enum { STEPS = 10000 };
    lab_trial trial;
    double start = 0, worst = 0, *x = NULL;
    pel_status status =
        lab_open_trial("validation",
                       "version: 1\n"
                       "bodies:\n"
                       "  - mesh: { shape: geodesic-sphere, frequency: 3, radius: 0.1 }\n"
                       "    membrane: { material: stvk, young: 1.0e6, poisson: 0.3, thickness: 0.002 }\n"
                       "    mass: { density: 1000 }\n"
                       "    bending: { model: midedge }\n"
                       "solver: { method: implicit, dt: 0.0005 }\n"
                       "stop: { frames: 10000 }\n",
                       NULL, &trial, experiment->error);
    if (status == PEL_OK) {
        size_t count = (size_t)pel_sim_vertex_count(trial.sim, 0);
        x = calloc(3 * count, sizeof *x);
        status = x != NULL ? PEL_OK : pel_fail_memory(experiment->error);
        for (size_t v = 0; status == PEL_OK && v < count; v++) {
            if (v == 0)
                pel_sim_get_positions(trial.sim, 0, x);
            x[3 * v] *= 1.02;
            x[3 * v + 1] *= 0.99;
        }
        if (status == PEL_OK)
            status = pel_sim_set_positions(trial.sim, 0, x, experiment->error);
    }
    for (int i = 0; status == PEL_OK && i <= STEPS; i++) {
        pel_sim_measures now;
        if (i % 10 == 0) {
            pel_sim_measure(trial.sim, &now);
            start = i == 0 ? now.elastic_energy : start;
            worst = fmax(worst, fabs((now.elastic_energy + now.kinetic_energy) / start - 1));
        }
        status = pel_sim_step(trial.sim, experiment->error);
    }
    if (status == PEL_OK)
        lab_at_most(experiment, "vibrating ball, 10,000 steps: energy, change", worst, 0.01, "midpoint rule, constant");
    free(x);
    lab_close_trial(&trial);
    return status;
}

pel_status own_validate_modes(lab_experiment *experiment)
{
    static const double widths[] = {0.1, 0.2, 0.3}, thicknesses[] = {0.05, 0.02, 0.01, 0.005};
    char path[LAB_PATH_SIZE];
    pel_status status = check_free(experiment, "free plate", 1, 48, 48);
    if (status == PEL_OK)
        status = check_free(experiment, "free strip", 0.1, 120, 12);
    for (int i = 0; status == PEL_OK && i < 3; i++)
        status = check_lateral(experiment, widths[i]);
    if (status == PEL_OK)
        status = write_eighth(experiment, 96, path);
    for (int i = 0; status == PEL_OK && i < 4; i++)
        status = check_sphere(experiment, path, thicknesses[i]);
    return status == PEL_OK ? check_vibration(experiment) : status;
}
