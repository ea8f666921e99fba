/* Validation: what a course in mechanics begins with. Cook's membrane and a pinched semi-cylinder over fineness, the
 * torsion of a tube and the pressure that crushes it, a round membrane under pressure, frequencies of a drum and of a
 * ring, and the largest pressure of a balloon.
 */
#include "papers/own/validation.h"

#include "papers/lab/plot.h"

#include <pellicle/sim_reading.h>

#include <math.h>
#include <stdio.h>

#define PI 3.14159265358979323846

/* ---- over fineness ---- */

/* 48 long, from 44 to 16 high, thickness 1 */
static void place_cook(double u, double v, double x[3])
{
    x[0] = 48 * u;
    x[1] = 44 * u + v * (44 - 28 * u);
    x[2] = 0;
}

/* E = 1, nu = 1/3, a shear of 1 along the right side: 1e-4 of it here, so that the answer is linear */
static pel_status write_cook(const lab_experiment *experiment, int n, const char *mesh, const char *model, char *text)
{
    return own_write_shell(experiment, "cook", n, n, mesh, model, place_cook,
                           "    membrane: { material: linear, young: 1, poisson: 0.333333333333, thickness: 1 }\n"
                           "    mass: { density: 1 }\n"
                           "    supports:\n"
                           "      - { at: { box: { min: [-9, -99, -9], max: [1.0e-4, 99, 9] } } }\n"
                           "      - { at: all, fix: [z] }\n"
                           "loads: [{ force: [0, 6.25e-6, 0], per: length,\n"
                           "          at: { box: { min: [47.9999, -99, -9], max: [49, 99, 9] } } }]\n",
                           text);
}

/* half of it: from the top, v = 0, to the straight side, v = 1, and from the clamped end, u = 0, to the free one */
static void place_semicylinder(double u, double v, double x[3])
{
    x[0] = 1.016 * sin(v * PI / 2);
    x[1] = 3.048 * u;
    x[2] = 1.016 * cos(v * PI / 2);
}

static pel_status write_semicylinder(const lab_experiment *experiment, int n, const char *mesh, const char *model,
                                     char *text)
{
    return own_write_shell(experiment, "semicylinder", n, n, mesh, model, place_semicylinder,
                           "    membrane: { material: stvk, young: 2.0685e7, poisson: 0.3, thickness: 0.03 }\n"
                           "    mass: { density: 1000 }\n"
                           "    supports:\n"
                           "      - { at: { box: { min: [-9, -9, -9], max: [9, 1.0e-5, 9] } }, rotation: fixed }\n"
                           "      - { at: { box: { min: [-9, -9, -9], max: [1.0e-5, 9, 9] } }, symmetry: x }\n"
                           "      - { at: { box: { min: [-9, -9, -9], max: [9, 9, 1.0e-5] } }, fix: [z], rotation: "
                           "fixed }\n"
                           "loads: [{ force: [0, 0, -1000], at: { nearest: [0, 3.048, 1.016] } }]\n",
                           text);
}

static const own_study studies[] = {
    {"cook",
     "Cook's membrane, middle of its right side",
     write_cook,
     1,
     {16, 32, 64},
     {48, 52, 0},
     {0, 1, 0},
     23.96e-4,
     0.01,
     "Cook 1974"},
    {"semicylinder",
     "pinched semi-cylinder under P = 2000",
     write_semicylinder,
     1,
     {12, 24, 40},
     {0, 3.048, 1.016},
     {0, 0, -1},
     1.71505,
     0.02,
     "Sze, Liu, Lo 2004"},
};

/* ---- tubes ---- */

enum { TUBES = 3 };
static const int tube_slices[TUBES] = {24, 48, 96};

/* errors over the number of slices */
static pel_status plot_tubes(const lab_experiment *experiment, const char *file, const char *title,
                             const double errors[TUBES])
{
    char path[LAB_PATH_SIZE];
    double slices[TUBES];
    for (int i = 0; i < TUBES; i++)
        slices[i] = tube_slices[i];
    const lab_plot plot = {.title = title,
                           .x_name = "vertices around the tube",
                           .y_name = "error / expected",
                           .log_x = true,
                           .log_y = true,
                           .curves = {{"mid-edge", slices, errors, TUBES, true}},
                           .curve_count = 1};
    return lab_write_plot(lab_path(experiment, file, path), &plot, experiment->error);
}

static void judge_tube(lab_experiment *experiment, const char *what, int i, double ratio, double tolerance,
                       const char *source, double errors[TUBES])
{
    char name[64];
    snprintf(name, sizeof name, "%s, %d around: over exact", what, tube_slices[i]);
    errors[i] = fmax(fabs(ratio - 1), 1e-6);
    if (i == TUBES - 1)
        lab_expect(experiment, name, ratio, 1, tolerance, source);
    else
        lab_tell(experiment, name, ratio, 1, source);
}

/* a tube of radius 30 and length 300, held at one end and turned by a degree at the other: the energy is
   G 2 pi R^3 h angle^2 / (2 L) */
static pel_status check_torsion(lab_experiment *experiment)
{
    const double exact = 1e9 / 1.3 * PI * 2.7e-5 * 0.001 / 0.3 * PI * PI / (180 * 180);
    double errors[TUBES];
    pel_status status = PEL_OK;
    for (int i = 0; status == PEL_OK && i < TUBES; i++) {
        char text[OWN_SCENE_SIZE];
        lab_trial trial;
        pel_sim_measures now = {0};
        snprintf(text, sizeof text,
                 "version: 1\n"
                 "bodies:\n"
                 "  - mesh: { shape: cylinder, radius: 0.03, height: 0.3, slices: %d, segments: %d, capped: false }\n"
                 "    membrane: { material: stvk, young: 2.0e9, poisson: 0.3, thickness: 0.001 }\n"
                 "    bending: { model: midedge }\n"
                 "    pinned: { box: { min: [-1, -1, -1], max: [1, 1, -0.1499] } }\n"
                 "tools:\n"
                 "  - { name: chuck, shape: box, size: [0.1, 0.1, 0.01], press: false, grasp: { reach: 1.0e-6 },\n"
                 "      motion: [ { position: [0, 0, 0.155] }, { time: 1, position: [0, 0, 0.155],\n"
                 "                rotation: { axis: [0, 0, 1], angle: 1 } } ] }\n"
                 "solver: { method: static }\n",
                 tube_slices[i], 3 * tube_slices[i] / 2);
        status = lab_open_trial("validation", text, NULL, &trial, experiment->error);
        if (status == PEL_OK)
            status = lab_step_trial(&trial, 1, experiment->error);
        if (status == PEL_OK)
            pel_sim_measure(trial.sim, &now);
        lab_close_trial(&trial);
        if (status == PEL_OK)
            judge_tube(experiment, "twisted tube: energy", i, now.elastic_energy / exact, 0.01, "Bredt", errors);
    }
    return status == PEL_OK ? plot_tubes(experiment, "tube-torsion.svg", "tube under torsion", errors) : status;
}

/* an open tube under outside pressure, nu = 0: a ring, which E h^3 / 4 R^3 flattens */
static pel_status check_crushed_tube(lab_experiment *experiment)
{
    const double exact = 1e9 * 1e-9 / 4e-3;
    double errors[TUBES], factor = 0;
    pel_status status = PEL_OK;
    for (int i = 0; status == PEL_OK && i < TUBES; i++) {
        char text[OWN_SCENE_SIZE];
        snprintf(text, sizeof text,
                 "version: 1\n"
                 "bodies:\n"
                 "  - mesh: { shape: cylinder, radius: 0.1, height: 0.05, slices: %d, segments: %d, capped: false }\n"
                 "    membrane: { material: stvk, young: 1.0e9, poisson: 0, thickness: 0.001 }\n"
                 "    bending: { model: midedge }\n"
                 "    pressure: { outside: 1 }\n"
                 "solver: { analysis: buckling, modes: 1 }\n",
                 tube_slices[i], tube_slices[i] / 12);
        status = own_modes(experiment, text, 1, &factor);
        if (status == PEL_OK)
            judge_tube(experiment, "crushed tube: pressure", i, factor / exact, 0.01, "Levy 1884", errors);
    }
    return status == PEL_OK ? plot_tubes(experiment, "tube-pressure.svg", "tube under outside pressure", errors)
                            : status;
}

/* ---- a round membrane ---- */

/* A disk that its rim holds, under a pressure q: the middle rises by 0.6534 a (q a / E h)^(1/3), integrated outward
   for nu = 0.3. The theory is that of small slopes: here they are 0.06; at 100 times the pressure, a slope of 0.28, a
   neo-Hookean disk rises 1.6 % farther. */
static pel_status check_disk(lab_experiment *experiment)
{
    const double exact = 0.653444 * 0.1 * cbrt(1 * 0.1 / (1e6 * 0.001));
    pel_status status = PEL_OK;
    for (int rings = 8; status == PEL_OK && rings <= 32; rings *= 2) {
        char text[OWN_SCENE_SIZE], name[64];
        lab_trial trial;
        pel_sim_measures now = {0};
        snprintf(text, sizeof text,
                 "version: 1\n"
                 "bodies:\n"
                 "  - mesh: { shape: disk, radius: 0.1, rings: %d }\n"
                 "    membrane: { material: stvk, young: 1.0e6, poisson: 0.3, thickness: 0.001 }\n"
                 "    bending: { model: none }\n"
                 "    pinned: boundary\n"
                 "    pressure: { outside: -1 }\n"
                 "solver: { method: static }\n",
                 rings);
        status = lab_open_trial("validation", text, NULL, &trial, experiment->error);
        if (status == PEL_OK)
            status = lab_step_trial(&trial, 1, experiment->error);
        if (status == PEL_OK)
            pel_sim_measure(trial.sim, &now);
        lab_close_trial(&trial);
        snprintf(name, sizeof name, "round membrane, %d rings: height / exact", rings);
        if (status == PEL_OK)
            lab_expect(experiment, name, now.max_displacement / exact, 1, 0.005, "Hencky 1915");
    }
    return status;
}

/* ---- frequencies ---- */

enum { TONES = 4 };

static pel_status judge_tones(lab_experiment *experiment, const char *name, const char *file, const double found[TONES],
                              const double expected[TONES], const char *source)
{
    char path[LAB_PATH_SIZE], line[64];
    double numbers[TONES];
    for (int m = 0; m < TONES; m++) {
        numbers[m] = m + 1;
        snprintf(line, sizeof line, "%s, frequency %d", name, m + 1);
        lab_expect(experiment, line, found[m], expected[m], 0.01 * expected[m], source);
    }
    const lab_plot plot = {
        .title = name,
        .x_name = "mode",
        .y_name = "frequency [Hz]",
        .bars = true,
        .curves = {{"simulated", numbers, found, TONES, false}, {"theory", numbers, expected, TONES, false}},
        .curve_count = 2};
    return lab_write_plot(lab_path(experiment, file, path), &plot, experiment->error);
}

/* A square of side 0.3 stretched by 1.05 both ways: an incompressible neo-Hookean sheet has the tension
   mu (s^2 - s^-4) over its density, and m by n half waves of length s L / m. Modes in its plane begin just above the
   fourth. */
static pel_status check_drum(lab_experiment *experiment)
{
    static const double waves[TONES] = {2, 5, 5, 8};
    const double stretch = 1.05, mu = 1e6 / 3, speed2 = mu * (pow(stretch, 2) - pow(stretch, -4)) / 1100;
    double found[TONES], expected[TONES];
    pel_status status = own_modes(
        experiment,
        "version: 1\n"
        "bodies:\n"
        "  - mesh: { shape: grid, nx: 40, ny: 40, size_x: 0.3, size_y: 0.3, diagonals: union-jack }\n"
        "    membrane: { material: neo-hookean, young: 1.0e6, poisson: 0.5, thickness: 0.0001 }\n"
        "    mass: { density: 1100 }\n"
        "    bending: { model: midedge }\n"
        "    supports:\n"
        "      - { at: { box: { min: [-1, -1, -1], max: [-0.1499, 1, 1] } }, fix: [x, z], displacement: [-0.0075, 0, "
        "0] }\n"
        "      - { at: { box: { min: [0.1499, -1, -1], max: [1, 1, 1] } }, fix: [x, z], displacement: [0.0075, 0, 0] "
        "}\n"
        "      - { at: { box: { min: [-1, -1, -1], max: [1, -0.1499, 1] } }, fix: [y, z], displacement: [0, -0.0075, "
        "0] }\n"
        "      - { at: { box: { min: [-1, 0.1499, -1], max: [1, 1, 1] } }, fix: [y, z], displacement: [0, 0.0075, 0] "
        "}\n"
        "solver: { analysis: modal, modes: 4 }\n",
        TONES, found);
    for (int m = 0; m < TONES; m++)
        expected[m] = sqrt(waves[m] * speed2) / (2 * stretch * 0.3);
    return status == PEL_OK ? judge_tones(experiment, "square drum", "drum.svg", found, expected, "Rayleigh 1877")
                            : status;
}

/* A free ring bends in its plane with n waves at n (n^2 - 1) / sqrt(n^2 + 1) sqrt(E h^2 / 12 rho) / R^2. It is so
   narrow that these come before the modes across its plane; each has two directions, and six motions are rigid. */
static pel_status check_ring(lab_experiment *experiment)
{
    double found[6 + TONES], expected[TONES], tones[TONES];
    const double bending = sqrt(2.1e11 * 4e-6 / 12 / 7850) / 0.01 / (2 * PI);
    pel_status status =
        own_modes(experiment,
                  "version: 1\n"
                  "bodies:\n"
                  "  - mesh: { shape: cylinder, radius: 0.1, height: 0.01, slices: 96, segments: 2, capped: false }\n"
                  "    membrane: { material: stvk, young: 2.1e11, poisson: 0, thickness: 0.002 }\n"
                  "    mass: { density: 7850 }\n"
                  "    bending: { model: midedge }\n"
                  "solver: { analysis: modal, modes: 10 }\n",
                  6 + TONES, found);
    for (int m = 0; m < TONES; m++) {
        double n = 2 + m / 2;
        expected[m] = n * (n * n - 1) / sqrt(n * n + 1) * bending;
        tones[m] = found[6 + m];
    }
    return status == PEL_OK ? judge_tones(experiment, "free ring", "ring.svg", tones, expected, "Hoppe 1871") : status;
}

/* ---- a balloon ---- */

/* p = 2 mu h / R (1 / s - 1 / s^7) is largest at s = 7^(1/6) */
static pel_status check_balloon(lab_experiment *experiment)
{
    const double stretch = pow(7, 1.0 / 6), exact = 2e6 / 3 * 0.01 * (1 / stretch - pow(stretch, -7));
    pel_limit_point points[PEL_LIMIT_POINTS];
    lab_trial trial;
    int32_t count = 0;
    pel_status status =
        lab_open_trial("validation",
                       "version: 1\n"
                       "bodies:\n"
                       "  - mesh: { shape: geodesic-sphere, frequency: 8, radius: 0.1 }\n"
                       "    membrane: { material: neo-hookean, young: 1.0e6, poisson: 0.5, thickness: 0.001 }\n"
                       "    bending: { model: midedge }\n"
                       "    pressure: { inside: 6000 }\n"
                       "solver: { path: arc-length, steps: 40 }\n",
                       NULL, &trial, experiment->error);
    for (int i = 0; status == PEL_OK && count == 0 && i < 40; i++) {
        status = pel_sim_step(trial.sim, experiment->error);
        count = pel_sim_get_limit_points(trial.sim, points);
    }
    lab_close_trial(&trial);
    if (status == PEL_OK)
        lab_expect(experiment, "balloon: largest pressure / exact",
                   count > 0 ? 6000 * points[0].load_factor / exact : 0, 1, 0.01, "neo-Hookean sphere, Treloar 1975");
    return status;
}

pel_status own_validate_classics(lab_experiment *experiment)
{
    pel_status status = PEL_OK;
    for (size_t i = 0; status == PEL_OK && i < sizeof studies / sizeof *studies; i++)
        status = own_run_study(experiment, &studies[i]);
    if (status == PEL_OK)
        status = check_torsion(experiment);
    if (status == PEL_OK)
        status = check_crushed_tube(experiment);
    if (status == PEL_OK)
        status = check_disk(experiment);
    if (status == PEL_OK)
        status = check_drum(experiment);
    if (status == PEL_OK)
        status = check_ring(experiment);
    return status == PEL_OK ? check_balloon(experiment) : status;
}
