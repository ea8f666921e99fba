/* Tears: energy release rates with closed forms and energies, directions and paths over meshes, what a cut leaves as it
   was, and the capsulorhexis in ten orientations on its mesh. */
#include "papers/own/validation.h"

#include "papers/own/cases.h"

#include <pellicle/sim_contact.h>
#include <pellicle/sim_ledger.h>
#include <pellicle/sim_reading.h>
#include <pellicle/sim_surface.h>
#include <pellicle/tear.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define PI 3.14159265358979323846

enum { TEXT = 4000 };

/* ---- flat sheets ---- */

typedef struct sheet {
    double size[2]; /* m */
    int cells[2];
    const char *diagonals;
    double from[2], to[2]; /* of the cut */
    double toughness, dt;
    double pull[3]; /* m in 1 s, of the upper side against the lower one */
    bool has_legs;  /* then both halves of the left side are drawn apart, and the right side is pinned */
} sheet;

static const sheet usual = {
    .size = {0.1, 0.1},
    .cells = {20, 20},
    .diagonals = "union-jack",
    .from = {-0.05, 0},
    .to = {-0.02, 0},
    .toughness = 300,
    .dt = 0.01,
    .pull = {0, 0.01, 0},
};

static void write_sheet(const sheet *s, char *text)
{
    double x = s->size[0] / 2, y = s->size[1] / 2, e = 1e-6;
    char ends[1200];
    if (s->has_legs)
        snprintf(ends, sizeof ends,
                 "    bending: { model: hinge }\n"
                 "    pinned: { box: { min: [%.9g, -1, -1], max: [1, 1, 1] } }\n"
                 "    supports:\n"
                 "      - { at: { box: { min: [-1, %.9g, -1], max: [%.9g, 1, 1] } }, fix: [y, z],\n"
                 "          displacement: [%.9g, %.9g, %.9g], keys: [[0, 0], [1, 1]] }\n"
                 "      - { at: { box: { min: [-1, -1, -1], max: [%.9g, %.9g, 1] } }, fix: [y, z],\n"
                 "          displacement: [%.9g, %.9g, %.9g], keys: [[0, 0], [1, 1]] }\n",
                 x - e, 0.01 * y, e - x, s->pull[0], s->pull[1], s->pull[2], e - x, -0.01 * y, -s->pull[0], -s->pull[1],
                 -s->pull[2]);
    else
        snprintf(ends, sizeof ends,
                 "    pinned: { box: { min: [-1, -1, -1], max: [1, %.9g, 1] } }\n"
                 "    supports:\n"
                 "      - { at: { box: { min: [-1, %.9g, -1], max: [1, 1, 1] } },\n"
                 "          displacement: [%.9g, %.9g, %.9g], keys: [[0, 0], [1, 1]] }\n"
                 "      - { at: all, fix: [z] }\n",
                 e - y, y - e, s->pull[0], s->pull[1], s->pull[2]);
    snprintf(text, TEXT,
             "version: 1\n"
             "bodies:\n"
             "  - mesh: { shape: grid, nx: %d, ny: %d, size_x: %.9g, size_y: %.9g, diagonals: %s }\n"
             "    membrane: { material: neo-hookean, young: 1.0e6, poisson: 0.3, thickness: 0.001, toughness: %.9g }\n"
             "%s"
             "cuts: [{ path: [[%.9g, %.9g, 0], [%.9g, %.9g, 0]] }]\n"
             "solver: { method: static, dt: %.9g }\n"
             "duration: 1\n",
             s->cells[0], s->cells[1], s->size[0], s->size[1], s->diagonals, s->toughness, ends, s->from[0], s->from[1],
             s->to[0], s->to[1], s->dt);
}

static pel_status open_sheet(const lab_experiment *experiment, const sheet *s, lab_trial *trial)
{
    char text[TEXT];
    write_sheet(s, text);
    return lab_open_trial("tear", text, NULL, trial, experiment->error);
}

/* the last of its tips */
static pel_status read_tip(const lab_experiment *experiment, pel_sim *sim, pel_tip *tip)
{
    enum { MOST = 8 };
    pel_tip tips[MOST];
    int32_t count = 0;
    *tip = (pel_tip){.rate = (double)NAN};
    pel_status status = pel_sim_tips(sim, 0, tips, MOST, &count, experiment->error);
    if (status == PEL_OK && count > 0)
        *tip = tips[count < MOST ? count - 1 : MOST - 1];
    return status;
}

static double length_of(pel_sim *sim)
{
    pel_cut_reading cuts = {0};
    pel_sim_get_cuts(sim, 0, &cuts, NULL);
    return cuts.length;
}

/* ---- energy release rates ---- */

/* Two legs drawn apart: a tear of length a takes F (l + 1) a from supports and stretched legs, with their stretch l =
   1 + F / (E h w) of width w, to first order of the strain. */
static pel_status check_trousers(lab_experiment *experiment)
{
    sheet s = usual;
    lab_trial trial;
    double sum = 0, forces = 0;
    int count = 0;
    s.size[1] = 0.04;
    s.cells[0] = 40;
    s.cells[1] = 16;
    s.toughness = 4000;
    s.has_legs = true;
    s.dt = 0.0025;
    s.pull[1] = 0;
    s.pull[2] = 0.1;
    pel_status status = open_sheet(experiment, &s, &trial);
    for (int i = 0; status == PEL_OK && i < 280; i++) {
        pel_support_reading reading;
        pel_tip tip;
        status = lab_step_trial(&trial, 1, experiment->error);
        if (status != PEL_OK || i <= 160)
            continue;
        pel_sim_get_support_part(trial.sim, 0, &reading);
        status = read_tip(experiment, trial.sim, &tip);
        double force = fabs(reading.force[2]), work = force * (2 + force / (1e6 * 0.001 * 0.02));
        sum += tip.rate * 0.001 / work;
        forces += work / (s.toughness * 0.001);
        count++;
    }
    if (status == PEL_OK) {
        pel_sim_ledger ledger;
        pel_sim_get_ledger(trial.sim, &ledger);
        lab_begin_claim(experiment, LAB_THEORY, "trousers tear at the force that their toughness asks for", NULL);
        lab_expect(experiment, "trousers: energy release rate / that of the force", sum / count, 1, 0.02,
                   "F (l + 1) / h");
        lab_expect(experiment, "trousers: force / that of the toughness", forces / count, 1, 0.03, "F (l + 1) / h");
        lab_expect(experiment, "trousers: energy that is missing / that of the tear",
                   (ledger.work_tools - ledger.elastic) / ledger.dissipated_fracture, 1, 0.02, "conservation");
    }
    lab_close_trial(&trial);
    return status;
}

static pel_status check_strip(lab_experiment *experiment)
{
    pel_status status = PEL_OK;
    lab_begin_claim(experiment, LAB_THEORY, "a clamped strip releases the energy of the strip ahead, at any length",
                    NULL);
    for (int i = 0; status == PEL_OK && i < 4; i++) {
        sheet s = usual;
        lab_trial trial;
        pel_tip tip;
        char name[96];
        s.size[0] = 0.4;
        s.cells[0] = 80;
        s.from[0] = -0.2;
        s.to[0] = -0.1 + 0.05 * i;
        s.pull[1] = 1e-3;
        s.toughness = 1e9;
        s.dt = 1;
        status = open_sheet(experiment, &s, &trial);
        if (status == PEL_OK)
            status = lab_step_trial(&trial, 1, experiment->error);
        if (status == PEL_OK)
            status = read_tip(experiment, trial.sim, &tip);
        double energy = 0.5e6 / 0.91 * 1e-4 * 0.1;
        snprintf(name, sizeof name, "strip, cut of %.2f m: energy release rate / exact", 0.1 + 0.05 * i);
        if (status == PEL_OK)
            lab_expect(experiment, name, tip.rate / energy, 1, 0.05, "E e^2 H / (2 (1 - nu^2))");
        lab_close_trial(&trial);
    }
    return status;
}

/* the energy and the force of a sheet with a cut of this length from its left side */
static pel_status release_at(const lab_experiment *experiment, const char *diagonals, int cells, double length,
                             double *energy, double *force)
{
    sheet s = usual;
    lab_trial trial;
    pel_tip tip = {0};
    s.diagonals = diagonals;
    s.cells[0] = s.cells[1] = cells;
    s.to[0] = s.from[0] + length;
    s.pull[1] = 0.005;
    s.toughness = 1e9;
    s.dt = 1;
    pel_status status = open_sheet(experiment, &s, &trial);
    if (status == PEL_OK)
        status = lab_step_trial(&trial, 1, experiment->error);
    if (status == PEL_OK)
        status = read_tip(experiment, trial.sim, &tip);
    if (status == PEL_OK) {
        pel_sim_measures now;
        pel_sim_measure(trial.sim, &now);
        *energy = now.elastic_energy;
        *force = tip.release;
    }
    lab_close_trial(&trial);
    return status;
}

static pel_status check_energy(lab_experiment *experiment)
{
    static const struct {
        const char *diagonals;
        int cells;
    } meshes[] = {{"union-jack", 40}, {"one-diagonal", 40}, {"union-jack", 50}, {"one-diagonal", 50}};
    double low = HUGE_VAL, high = 0;
    lab_begin_claim(experiment, LAB_THEORY, "the force on a tip is the energy that a longer cut releases", NULL);
    for (size_t i = 0; i < sizeof meshes / sizeof *meshes; i++) {
        /* by two edges: vertices of the union jack take turns in the number of their triangles */
        double energies[2] = {0}, forces[2] = {0}, way = 0.1 / meshes[i].cells;
        char name[96];
        for (int k = 0; k < 2; k++) {
            pel_status status = release_at(experiment, meshes[i].diagonals, meshes[i].cells, 0.04 + (2 * k - 1) * way,
                                           &energies[k], &forces[k]);
            if (status != PEL_OK)
                return status;
        }
        double mean = 0.5 * (forces[0] + forces[1]);
        low = fmin(low, mean);
        high = fmax(high, mean);
        snprintf(name, sizeof name, "sheet, %s, %d cells: force / energy released", meshes[i].diagonals,
                 meshes[i].cells);
        lab_expect(experiment, name, mean / ((energies[0] - energies[1]) / (2 * way)), 1, 0.03,
                   "energies of both cuts");
    }
    lab_at_most(experiment, "sheet: largest force / smallest one, over the meshes", high / low, 1.02, "the same sheet");
    return PEL_OK;
}

/* ---- directions and paths ---- */

/* at the end of a cut at 45 degrees from the border of a half plane K1 = 0.705 and K2 = 0.364 */
static pel_status check_kink(lab_experiment *experiment)
{
    static const struct {
        const char *diagonals;
        int cells;
    } meshes[] = {{"union-jack", 64}, {"equilateral", 64}, {"one-diagonal", 48}, {"union-jack", 90}};
    enum { MESHES = sizeof meshes / sizeof *meshes };
    lab_begin_claim(experiment, LAB_THEORY, "the force on the end of a slanting cut has the direction of theory", NULL);
    for (int i = 0; i < MESHES; i++) {
        sheet s = usual;
        lab_trial trial;
        pel_tip tip;
        char name[96];
        s.size[0] = s.size[1] = 0.16;
        s.cells[0] = s.cells[1] = meshes[i].cells;
        s.diagonals = meshes[i].diagonals;
        s.from[0] = -0.08;
        s.to[0] = -0.08 + 0.02 * sqrt(0.5);
        s.to[1] = 0.02 * sqrt(0.5);
        s.pull[1] = 1e-3;
        s.toughness = 1e9;
        s.dt = 1;
        pel_status status = open_sheet(experiment, &s, &trial);
        if (status == PEL_OK)
            status = lab_step_trial(&trial, 1, experiment->error);
        if (status == PEL_OK)
            status = read_tip(experiment, trial.sim, &tip);
        lab_close_trial(&trial);
        if (status != PEL_OK)
            return status;
        snprintf(name, sizeof name, "notch at 45 degrees, %s, %d cells: turn [degrees]", meshes[i].diagonals,
                 meshes[i].cells);
        lab_expect(experiment, name, atan2(tip.force[1], tip.force[0]) * 180 / PI - 45, -39.2, 2,
                   "2 K1 K2 / (K1^2 + K2^2), Murakami 1987");
    }
    return PEL_OK;
}

/* how far copies beyond the first cut lie from y = 0 */
static double find_offset(pel_sim *sim, double from)
{
    const pel_mesh *mesh = pel_model_mesh(pel_sim_model(sim), 0);
    int32_t *origins = calloc((size_t)mesh->vertex_count, sizeof *origins);
    double most = origins != NULL ? 0 : (double)NAN;
    if (origins != NULL)
        pel_sim_get_origins(sim, 0, origins);
    for (int32_t v = 0; origins != NULL && v < mesh->vertex_count; v++)
        if (origins[v] != v && mesh->positions[v][0] > from)
            most = fmax(most, fabs(mesh->positions[v][1]));
    free(origins);
    return most;
}

/* a cut in the middle of a strip tears straight to the other end of it */
static pel_status follow_path(lab_experiment *experiment, const char *diagonals, int cells, double *off, double *length)
{
    sheet s = usual;
    lab_trial trial;
    char row[120];
    s.size[0] = 0.2;
    s.cells[1] = cells;
    s.cells[0] = 2 * cells;
    s.diagonals = diagonals;
    s.from[0] = -0.1;
    s.to[0] = -0.05;
    s.toughness = 200;
    s.dt = 0.05;
    pel_status status = open_sheet(experiment, &s, &trial);
    for (int n = 0; status == PEL_OK && n < 18 && length_of(trial.sim) < 0.1999; n++)
        status = lab_step_trial(&trial, 1, experiment->error);
    if (status == PEL_OK) {
        *length = length_of(trial.sim);
        *off = find_offset(trial.sim, -0.045) * cells / s.size[1];
        snprintf(row, sizeof row, "%s | %d | %.3f | %.5f", diagonals, cells, *off, *length);
        lab_add_row(experiment, row);
    }
    lab_close_trial(&trial);
    return status;
}

static pel_status check_paths(lab_experiment *experiment)
{
    static const char *const diagonals[2] = {"union-jack", "equilateral"};
    static const int cells[5] = {14, 16, 18, 20, 24};
    double most_off = 0, most_long = 0, off = 0, length = 0;
    lab_begin_table(experiment, "paths over meshes", "mesh | cells | distance from the middle / edge | length [m]");
    for (int i = 0; i < 10; i++) {
        pel_status status = follow_path(experiment, diagonals[i % 2], cells[i / 2], &off, &length);
        if (status != PEL_OK)
            return status;
        most_off = fmax(most_off, off);
        most_long = fmax(most_long, fabs(length / 0.2 - 1));
    }
    lab_begin_claim(experiment, LAB_THEORY, "a path does not depend on the mesh", NULL);
    lab_at_most(experiment, "ten meshes: largest distance of a path from the middle / edge", most_off, 0.1, "symmetry");
    lab_at_most(experiment, "ten meshes: largest error of a length", most_long, 0.005, "symmetry");
    pel_status status = follow_path(experiment, "one-diagonal", 20, &off, &length);
    lab_tell(experiment, "one-diagonal: distance of the path from the middle / edge", off, 0.1, "a mesh that leans");
    return status;
}

/* ---- what a cut leaves ---- */

typedef struct sums {
    double mass, momentum[3], angular[3], kinetic;
} sums;

static bool sum_up(pel_sim *sim, sums *all)
{
    size_t count = (size_t)pel_sim_vertex_count(sim, 0);
    double *m = calloc(7 * count, sizeof *m), *x = m + count, *v = m + 4 * count;
    *all = (sums){0};
    if (m == NULL)
        return false;
    pel_sim_get_masses(sim, 0, m);
    pel_sim_get_positions(sim, 0, x);
    pel_sim_get_velocities(sim, 0, v);
    for (size_t i = 0; i < count; i++) {
        const double *a = x + 3 * i, *b = v + 3 * i;
        all->mass += m[i];
        for (int c = 0; c < 3; c++) {
            int d = (c + 1) % 3, e = (c + 2) % 3;
            all->momentum[c] += m[i] * b[c];
            all->angular[c] += m[i] * (a[d] * b[e] - a[e] * b[d]);
            all->kinetic += 0.5 * m[i] * b[c] * b[c];
        }
    }
    free(m);
    return true;
}

static double difference(const double a[3], const double b[3])
{
    return hypot(hypot(a[0] - b[0], a[1] - b[1]), a[2] - b[2]) / hypot(hypot(a[0], a[1]), a[2]);
}

/* a sheet that flies and turns, cut in flight */
static pel_status check_cut(lab_experiment *experiment)
{
    static const char scene[] = "version: 1\n"
                                "bodies:\n"
                                "  - mesh: { shape: grid, nx: 20, ny: 20, size_x: 0.2, size_y: 0.2 }\n"
                                "    membrane: { young: 1.0e6, poisson: 0.4, thickness: 0.001 }\n"
                                "    bending: {}\n"
                                "    velocity: [1, 2, 3]\n"
                                "    angular_velocity: [4, -2, 7]\n"
                                "cuts: [{ at: 0.02, path: [[-0.1, 0.01, 0], [0.03, 0.05, 0], [0.06, -0.03, 0]] }]\n"
                                "solver: { method: implicit, dt: 0.01 }\n"
                                "duration: 1\n";
    lab_trial trial;
    sums before, after;
    bool known = false;
    pel_status status = lab_open_trial("tear", scene, NULL, &trial, experiment->error);
    if (status == PEL_OK)
        status = lab_step_trial(&trial, 1, experiment->error);
    if (status == PEL_OK) {
        const pel_cut_def *cut = &trial.scene->sim.cuts[0];
        known = sum_up(trial.sim, &before);
        status = pel_cut(trial.sim, 0, cut->vertices, cut->vertex_count, experiment->error);
    }
    if (status == PEL_OK && known && sum_up(trial.sim, &after)) {
        lab_begin_claim(experiment, LAB_THEORY, "a cut changes neither mass nor momenta nor kinetic energy", NULL);
        lab_at_most(experiment, "cut: mass, change", fabs(after.mass / before.mass - 1), 1e-14, "conservation");
        lab_at_most(experiment, "cut: momentum, change", difference(before.momentum, after.momentum), 1e-12,
                    "conservation");
        lab_at_most(experiment, "cut: angular momentum, change", difference(before.angular, after.angular), 1e-12,
                    "conservation");
        lab_at_most(experiment, "cut: kinetic energy, change", fabs(after.kinetic / before.kinetic - 1), 1e-12,
                    "conservation");
    }
    lab_close_trial(&trial);
    return status;
}

/* ---- capsulorhexis ---- */

#define RADIUS 2.75e-3 /* m, that forceps lead it on */
/* degrees between orientations: the corners of the mesh repeat every 72 */
#define TURN 7.2

enum { ORIENTATIONS = 10, STEPS = 30, MOST_PARTS = 600 };

typedef struct rhexis {
    double low, high, force, peak, angle,
        time;          /* radii at rest; N, mean and largest; rad, smallest; s, until it joined */
    int64_t crossings; /* of all measured states */
    bool joined;
} rhexis;

static void write_rhexis(double turn, char *text)
{
    char path[600] = "";
    int used = snprintf(path, sizeof path, "[0, 0, 0.00218]");
    for (int i = 0; i <= 6; i++)
        used += snprintf(path + used, sizeof path - (size_t)used, ", [%.9g, %.9g, 0.001562]",
                         RADIUS * cos(turn + i * PI / 18), RADIUS * sin(turn + i * PI / 18));
    snprintf(text, TEXT,
             "version: 1\n"
             "bodies:\n"
             "  - mesh: { shape: lens-capsule }\n"
             "    mass: { per_vertex: 1.0e-6 }\n"
             "    springs: { young: 1.5e6, thickness: 13e-6, toughness: 1300 }\n"
             "    volumetric: { young: 1e4, depth: 0.001, adhesion: 1000 }\n"
             "    pinned: { box: { min: [-1, -1, -1], max: [1, 1, 0.001] } }\n"
             "cuts: [{ path: [%s] }]\n"
             "tools:\n"
             "  - { name: forceps, shape: sphere, radius: 0.0003, press: false,\n"
             "      grasp: { reach: 1e-5, lead: { radius: %.9g, speed: 0.005, regrasp: 0.0022 } },\n"
             "      motion: [{ position: [%.9g, %.9g, 0.002] }] }\n"
             "contact: { self: true, thickness: 13e-6 }\n"
             "solver: { method: quasi-static, momentum: 0.95, dt: 0.001 }\n"
             "duration: 20\n",
             path, RADIUS, 0.0026 * cos(turn + 0.63), 0.0026 * sin(turn + 0.63));
}

/* radii of the tear, and the smallest angle of all triangles, at rest; a first cut may end within the flap, and comes
   from the middle at `turn` */
static bool measure_rhexis(pel_sim *sim, double turn, rhexis *r)
{
    const pel_mesh *mesh = pel_model_mesh(pel_sim_model(sim), 0);
    int32_t *origins = calloc((size_t)mesh->vertex_count, sizeof *origins);
    if (origins == NULL)
        return false;
    pel_sim_get_origins(sim, 0, origins);
    r->low = HUGE_VAL;
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        const double *x = mesh->positions[v];
        double radius = hypot(x[0], x[1]), aside = x[1] * cos(turn) - x[0] * sin(turn);
        bool on_first = fabs(aside) < 2e-4 && x[0] * cos(turn) + x[1] * sin(turn) > 0;
        if (origins[v] == v || radius < 0.7 * RADIUS || on_first)
            continue;
        r->low = fmin(r->low, radius);
        r->high = fmax(r->high, radius);
    }
    r->angle = PI;
    for (int32_t h = 0; h < 3 * mesh->triangle_count; h++) {
        const int32_t *v = mesh->triangles[h / 3];
        const double *x = mesh->positions[v[h % 3]], *y = mesh->positions[v[(h + 1) % 3]],
                     *z = mesh->positions[v[(h + 2) % 3]];
        double a = 0, b = 0, ab = 0;
        for (int c = 0; c < 3; c++) {
            a += (y[c] - x[c]) * (y[c] - x[c]);
            b += (z[c] - x[c]) * (z[c] - x[c]);
            ab += (y[c] - x[c]) * (z[c] - x[c]);
        }
        r->angle = fmin(r->angle, acos(ab / sqrt(a * b)));
    }
    free(origins);
    return true;
}

static pel_status tear_rhexis(const lab_experiment *experiment, double turn, rhexis *r)
{
    char text[TEXT];
    lab_trial trial;
    double sum = 0;
    int count = 0;
    *r = (rhexis){0};
    write_rhexis(turn, text);
    pel_status status = lab_open_trial("capsulorhexis", text, NULL, &trial, experiment->error);
    double first = 0;
    for (int i = 0; status == PEL_OK && i < MOST_PARTS && !r->joined; i++) {
        pel_cut_reading cuts;
        pel_tool_reading tool;
        status = lab_step_trial(&trial, STEPS, experiment->error);
        int64_t crossings = 1;
        if (status == PEL_OK)
            status = pel_sim_intersections(trial.sim, &crossings, experiment->error);
        r->crossings += crossings;
        pel_sim_get_cuts(trial.sim, 0, &cuts, NULL);
        pel_sim_get_tool(trial.sim, 0, &tool);
        double force = hypot(hypot(tool.force[0], tool.force[1]), tool.force[2]);
        first = i == 0 ? cuts.length : first;
        if (cuts.length > first) {
            sum += force;
            count++;
            r->peak = fmax(r->peak, force);
        }
        r->joined = cuts.island_count > 0;
        r->time = pel_sim_time(trial.sim);
    }
    r->force = sum / count;
    if (status == PEL_OK && !measure_rhexis(trial.sim, turn, r))
        status = pel_fail_memory(experiment->error);
    lab_close_trial(&trial);
    return status;
}

static pel_status check_rhexis(lab_experiment *experiment)
{
    double turns[ORIENTATIONS], low[ORIENTATIONS], high[ORIENTATIONS], force[ORIENTATIONS], off = 0, angle = PI;
    double least = HUGE_VAL, most = 0;
    int joined = 0;
    int64_t crossings = 0;
    lab_begin_table(
        experiment, "capsulorhexis, turned on the mesh, whose corners repeat every 72 degrees",
        "turn [degrees] | radii [mm] | force, mean and largest [mN] | smallest angle [degrees] | joined after");
    for (int i = 0; i < ORIENTATIONS; i++) {
        rhexis r;
        char row[200];
        double turn = i * TURN * PI / 180;
        snprintf(row, sizeof row, "capsulorhexis %d of %d", i + 1, (int)ORIENTATIONS);
        lab_tell_run(experiment, row);
        pel_status status = tear_rhexis(experiment, turn, &r);
        if (status != PEL_OK)
            return status;
        turns[i] = i * TURN;
        low[i] = 1e3 * r.low;
        high[i] = 1e3 * r.high;
        force[i] = 1e3 * r.force;
        joined += r.joined;
        crossings += r.crossings;
        off = fmax(off, fmax(RADIUS - r.low, r.high - RADIUS));
        angle = fmin(angle, r.angle);
        least = fmin(least, force[i]);
        most = fmax(most, force[i]);
        snprintf(row, sizeof row, "%.1f | %.2f to %.2f | %.1f, %.1f | %.0f | %.0f s", turns[i], low[i], high[i],
                 force[i], 1e3 * r.peak, r.angle * 180 / PI, r.joined ? r.time : (double)NAN);
        lab_add_row(experiment, row);
    }
    lab_begin_claim(experiment, LAB_REFERENCE, "forceps tear a round hole into a lens, in ten orientations on its mesh",
                    NULL);
    lab_expect(experiment, "capsulorhexis: orientations in which it joins itself", joined, ORIENTATIONS, 0,
               "asked for");
    lab_at_most(experiment, "capsulorhexis: largest distance from the circle [mm]", 1e3 * off, 0.1, "asked for");
    lab_at_least(experiment, "capsulorhexis: smallest mean force [mN]", least, 8.5, "experts: 9 mN");
    lab_at_most(experiment, "capsulorhexis: largest mean force [mN]", most, 12, "experts: 9 mN");
    lab_expect(experiment, "capsulorhexis: pairs of triangles that intersect", (double)crossings, 0, 0, "asked for");
    lab_at_least(experiment, "capsulorhexis: smallest angle of a triangle [degrees]", angle * 180 / PI, 12,
                 "asked for");
    const lab_plot radii = {
        .title = "radii of the hole, led on 2.75 mm",
        .x_name = "turn on the mesh [degrees]",
        .y_name = "radius [mm]",
        .curves = {{"smallest", turns, low, ORIENTATIONS, true}, {"largest", turns, high, ORIENTATIONS, true}},
        .curve_count = 2};
    const lab_plot forces = {.title = "mean force of the forceps",
                             .x_name = "turn on the mesh [degrees]",
                             .y_name = "force [mN]",
                             .curves = {{"force", turns, force, ORIENTATIONS, true}},
                             .curve_count = 1};
    pel_status status = lab_add_plot(experiment, &radii);
    return status == PEL_OK ? lab_add_plot(experiment, &forces) : status;
}

static pel_status run_tear(lab_experiment *experiment)
{
    static pel_status (*const checks[])(lab_experiment *) = {check_cut,  check_trousers, check_strip, check_energy,
                                                             check_kink, check_paths,    check_rhexis};
    pel_status status = PEL_OK;
    for (size_t i = 0; status == PEL_OK && i < sizeof checks / sizeof *checks; i++)
        status = checks[i](experiment);
    return status;
}

const lab_case own_tear = {
    .name = "tear",
    .doc = "tears against closed forms and energies, and capsulorhexes (some minutes)",
    .group = "own",
    .origin = LAB_THEORY,
    .run = run_tear,
};
