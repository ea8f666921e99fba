/* Paper A, abstract: local refinement costs little and makes the computation many times more precise. Error against
   cost, refined locally and everywhere. */
#include "papers/a/cases.h"

#include "papers/lab/trial.h"

#include <pellicle/shape.h>
#include <pellicle/sim.h>
#include <pellicle/subdivide.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A smooth pull on a patch: under tension the net of springs has one solution that finer meshes come close to (pressed,
   it wrinkles as fine as the mesh allows). */
static const char patch[] = "version: 1\n"
                            "title: ball pulled at a patch\n"
                            "bodies:\n"
                            "  - name: ball\n"
                            "    mesh: { shape: geodesic-sphere, frequency: 5, radius: 1 }\n"
                            "    mass: { per_vertex: 1 }\n"
                            "    springs: { stiffness: 3, damping: 0.5 }\n"
                            "    volumetric: { stiffness: 1.5, damping: 0.5 }\n"
                            "    scale_with_area: true\n"
                            "loads:\n"
                            "  - { body: ball, force: [0, 0, 2], at: { nearest: [0, 0, 1], falloff: 0.6 } }\n"
                            "solver: { method: quasi-static, dt: 0.01 }\n"
                            "duration: 20\n"
                            "output: { every: 1000, fields: [displacement] }\n";

enum { LEVELS = 2, REFERENCE = 3, BASE_VERTICES = 252 };

/* radius of the zone, about the pole, in which errors are measured: that which level 1 refines */
#define ZONE 0.5

typedef struct solution {
    double at[BASE_VERTICES][3]; /* where the base's vertices are */
    double cost;                 /* time of a step over that on the base */
    double triangles;
} solution;

/* the patch on one thread */
static pel_status start(const char *refine, const char *method, lab_trial *trial, pel_error *error)
{
    char setting[128], solver[64];
    const char *overrides[] = {setting, solver, "solver.threads=1", NULL};
    snprintf(setting, sizeof setting, "bodies.ball.refine=%s", refine);
    snprintf(solver, sizeof solver, "solver.method=%s", method);
    return lab_open_trial("patch", patch, overrides, trial, error);
}

/* processor time of a step on the settled surface over that on the base: both take turns, the least of each counts */
static pel_status compare_steps(const char *refine, double *ratio, pel_error *error)
{
    enum { STEPS = 50, TRIES = 40, BEFORE = 1000 };
    const char *refines[2] = {"", refine};
    lab_trial trials[2] = {{0}};
    double least[2] = {(double)HUGE_VAL, (double)HUGE_VAL};
    pel_status status = PEL_OK;
    for (int i = 0; status == PEL_OK && i < 2; i++) {
        status = start(refines[i], "quasi-static", &trials[i], error);
        if (status == PEL_OK)
            status = lab_step_trial(&trials[i], BEFORE, error);
    }
    for (int n = 0; status == PEL_OK && n < 2 * TRIES; n++) {
        double begin = pel_thread_seconds();
        status = lab_step_trial(&trials[n % 2], STEPS, error);
        least[n % 2] = fmin(least[n % 2], (pel_thread_seconds() - begin) / STEPS);
    }
    *ratio = least[1] / least[0];
    for (int i = 0; i < 2; i++)
        lab_close_trial(&trials[i]);
    return status;
}

/* what work does with a simulation of the patch that is refined everywhere to a level */
static pel_status on_level(int level, const char *method, pel_status (*work)(pel_sim *, void *, pel_error *),
                           void *subject, pel_error *error)
{
    char refine[64] = "";
    lab_trial trial;
    if (level > 0)
        snprintf(refine, sizeof refine, "{ everywhere: true, levels: %d }", level);
    pel_status status = start(refine, method, &trial, error);
    if (status == PEL_OK)
        status = work(trial.sim, subject, error);
    lab_close_trial(&trial);
    return status;
}

static pel_status solve(lab_experiment *experiment, const char *run, const char *refine, int duration, solution *made)
{
    char settings[2][128];
    snprintf(settings[0], sizeof settings[0], "bodies.ball.refine=%s", refine);
    snprintf(settings[1], sizeof settings[1], "duration=%d", duration);
    const char *overrides[] = {settings[0], settings[1], NULL};
    pel_run_summary summary;
    pel_status status = lab_run(experiment, run, patch, overrides, &summary);
    if (status == PEL_OK)
        status = compare_steps(refine, &made->cost, experiment->error);
    if (status != PEL_OK)
        return status;
    made->triangles = (double)summary.triangles_final;
    pel_mesh *mesh;
    status = lab_read_final(experiment, run, &mesh);
    if (status == PEL_OK)
        memcpy(made->at, mesh->positions, sizeof made->at);
    pel_mesh_destroy(mesh);
    return status;
}

/* largest distance over the base's vertices in the zone, relative to the largest displacement there */
static double error_of(const solution *base_shape, const solution *reference, const solution *made)
{
    double most = 0, largest = 0;
    for (int v = 0; v < BASE_VERTICES; v++) {
        const double *rest = base_shape->at[v];
        double error = 0, way = 0;
        if (rest[0] * rest[0] + rest[1] * rest[1] + (rest[2] - 1) * (rest[2] - 1) > ZONE * ZONE)
            continue;
        for (int i = 0; i < 3; i++) {
            error += pow(made->at[v][i] - reference->at[v][i], 2);
            way += pow(reference->at[v][i] - rest[i], 2);
        }
        most = fmax(most, sqrt(error));
        largest = fmax(largest, sqrt(way));
    }
    return most / largest;
}

/* ---- the reference ---- */

/* from the displacements that are a field of the mesh, the surface of the level at rest, to those at equilibrium */
static pel_status settle(pel_sim *sim, void *surface, pel_error *error)
{
    pel_mesh *mesh = surface;
    size_t count = 3 * (size_t)mesh->vertex_count;
    const double *rest = mesh->positions[0];
    double *shift = mesh->fields[0].values, *at = malloc(count * sizeof *at);
    if (at == NULL)
        return pel_fail_memory(error);
    memcpy(at, rest, count * sizeof *at);
    for (size_t i = 0; i < count; i++)
        at[i] += shift[i];
    pel_status status = pel_sim_set_positions(sim, 0, at, error);
    if (status == PEL_OK)
        status = pel_sim_step(sim, error);
    pel_sim_get_positions(sim, 0, at);
    for (size_t i = 0; i < count; i++)
        shift[i] = at[i] - rest[i];
    free(at);
    return status;
}

/* level by level, each started from the interpolated previous one */
static pel_status solve_reference(lab_experiment *experiment, solution *made)
{
    pel_mesh *mesh, *fine;
    pel_error *error = experiment->error;
    pel_shape_def shape = pel_shape_def_default(PEL_SHAPE_GEODESIC_SPHERE);
    pel_status status = pel_shape_create(&shape, &mesh, error);
    if (status == PEL_OK)
        status = pel_mesh_add_field(mesh, "displacement", 3, NULL, error);
    pel_subdivide_def once = pel_subdivide_def_default();
    once.clamp_fields = false;
    for (int level = 0; status == PEL_OK && level <= REFERENCE; level++) {
        char run[64];
        snprintf(run, sizeof run, "reference, level %d", level);
        lab_tell_run(experiment, run);
        status = on_level(level, "static", settle, mesh, error);
        if (status != PEL_OK || level == REFERENCE)
            break;
        status = pel_mesh_subdivide_with(mesh, &once, &fine, error);
        if (status != PEL_OK)
            break;
        pel_mesh_destroy(mesh);
        mesh = fine;
    }
    for (int v = 0; status == PEL_OK && v < BASE_VERTICES; v++)
        for (int i = 0; i < 3; i++)
            made->at[v][i] = mesh->positions[v][i] + mesh->fields[0].values[3 * v + i];
    pel_mesh_destroy(mesh);
    return status;
}

/* three ways to refine: by force per area above this, on so many rings; and everywhere */
enum { NARROW, WIDE, GLOBAL, WAYS };
static const struct {
    const char *run, *name, *refine;
} ways[WAYS] = {
    {"narrow", "refined locally, narrow", "{ levels: %d, above: 1.5, rings: 1, interval: 50 }"},
    {"wide", "refined locally, wide", "{ levels: %d, above: 0.3, rings: 2, interval: 50 }"},
    {"global", "refined everywhere", "{ levels: %d, everywhere: true }"},
};

typedef struct study {
    solution rest, base, reference, ways[WAYS][LEVELS];
} study;

static pel_status solve_all(lab_experiment *experiment, study *all)
{
    /* nothing pulls: where the base's vertices are at rest; in the file's precision, like all others */
    const char *rest[] = {"loads=[]", "duration=0.01", NULL};
    pel_run_summary summary;
    pel_mesh *mesh;
    pel_status status = lab_run(experiment, "rest", patch, rest, &summary);
    if (status == PEL_OK)
        status = lab_read_final(experiment, "rest", &mesh);
    if (status != PEL_OK)
        return status;
    memcpy(all->rest.at, mesh->positions, sizeof all->rest.at);
    pel_mesh_destroy(mesh);
    status = solve(experiment, "base", "", 20, &all->base);
    for (int way = 0; way < WAYS; way++)
        for (int level = 1; status == PEL_OK && level <= LEVELS; level++) {
            char run[32], refine[96];
            snprintf(run, sizeof run, "%s-%d", ways[way].run, level);
            snprintf(refine, sizeof refine, ways[way].refine, level);
            /* finer meshes settle later */
            status = solve(experiment, run, refine, 10 << level, &all->ways[way][level - 1]);
        }
    return status == PEL_OK ? solve_reference(experiment, &all->reference) : status;
}

/* ---- physics of a level ---- */

/* of the surface refined everywhere: mass, energy of the structural springs of the ball that is 1 % larger, and energy
   of the volumetric springs of the ball that is shifted by .01 m */
typedef struct physics {
    double mass, stretched, shifted;
} physics;

static double sum_of(const double *values, int32_t count)
{
    double sum = 0;
    for (int32_t i = 0; i < count; i++)
        sum += values[i];
    return sum;
}

static pel_status weigh(pel_sim *sim, void *measured, pel_error *error)
{
    physics *made = measured;
    int32_t count = pel_sim_vertex_count(sim, 0);
    double *rest = malloc(8 * (size_t)count * sizeof *rest);
    if (rest == NULL)
        return pel_fail_memory(error);
    double *at = rest + 3 * (size_t)count, *spring = at + 3 * (size_t)count, *volumetric = spring + count;
    pel_sim_get_masses(sim, 0, spring);
    made->mass = sum_of(spring, count);
    pel_sim_get_rest_positions(sim, 0, rest);
    for (int32_t i = 0; i < 3 * count; i++)
        at[i] = 1.01 * rest[i];
    pel_status status = pel_sim_set_positions(sim, 0, at, error);
    pel_sim_get_energies(sim, 0, spring, volumetric);
    made->stretched = sum_of(spring, count);
    for (int32_t i = 0; i < 3 * count; i++)
        at[i] = rest[i] + (i % 3 == 2 ? 0.01 : 0);
    if (status == PEL_OK)
        status = pel_sim_set_positions(sim, 0, at, error);
    pel_sim_get_energies(sim, 0, spring, volumetric);
    made->shifted = sum_of(volumetric, count);
    free(rest);
    return status;
}

static pel_status judge_physics(lab_experiment *experiment)
{
    static const char source[] = "paper A, section 3.3; 0.02 is ours";
    physics levels[LEVELS + 1] = {{0}};
    pel_status status = PEL_OK;
    for (int i = 0; status == PEL_OK && i <= LEVELS; i++)
        status = on_level(i, "quasi-static", weigh, &levels[i], experiment->error);
    lab_begin_claim(experiment, LAB_PAPER, "a level changes neither the mass nor the stiffness of the springs", NULL);
    for (int i = 1; status == PEL_OK && i <= LEVELS; i++) {
        char name[64];
        snprintf(name, sizeof name, "level %d / base: mass", i);
        lab_expect(experiment, name, levels[i].mass / levels[0].mass, 1, 0.02, source);
        snprintf(name, sizeof name, "level %d / base: energy of the springs, 1 %% larger", i);
        lab_expect(experiment, name, levels[i].stretched / levels[0].stretched, 1, 0.02, source);
        snprintf(name, sizeof name, "level %d / base: energy of the volumetric springs, shifted", i);
        lab_expect(experiment, name, levels[i].shifted / levels[0].shifted, 1, 0.02, source);
    }
    return status;
}

static void judge(lab_experiment *experiment, const study *all)
{
    double base = error_of(&all->rest, &all->reference, &all->base);
    lab_begin_claim(experiment, LAB_PAPER, "refined locally the computation is many times more precise", NULL);
    for (int i = 0; i < LEVELS; i++) {
        char name[64];
        snprintf(name, sizeof name, "error, base / wide %d", i + 1);
        lab_at_least(experiment, name, base / error_of(&all->rest, &all->reference, &all->ways[WIDE][i]),
                     i == 0 ? 1.5 : 5, "paper A, abstract; 1.5 and 5 are ours");
    }
    lab_tell(experiment, "base: error", base, 0, "level 3 everywhere");
    lab_begin_claim(experiment, LAB_REGRESSION, "refined locally the displacement is that of refining everywhere",
                    NULL);
    for (int way = 0; way < WAYS; way++)
        for (int i = 0; i < LEVELS; i++) {
            const solution *one = &all->ways[way][i];
            char name[64];
            double apart = error_of(&all->rest, &all->ways[GLOBAL][i], one);
            snprintf(name, sizeof name, "%s %d: from global", ways[way].run, i + 1);
            if (way != GLOBAL)
                lab_at_most(experiment, name, apart, 0.05, "5 % at most");
            snprintf(name, sizeof name, "%s %d: error", ways[way].run, i + 1);
            lab_tell(experiment, name, error_of(&all->rest, &all->reference, one), 0, "level 3 everywhere");
            snprintf(name, sizeof name, "%s %d: triangles / base", ways[way].run, i + 1);
            lab_tell(experiment, name, one->triangles / all->base.triangles, (double)NAN, "");
            snprintf(name, sizeof name, "%s %d: time / base", ways[way].run, i + 1);
            lab_tell(experiment, name, one->cost, (double)NAN, "");
        }
}

static pel_status plot_errors(lab_experiment *experiment, const study *all)
{
    double cost[WAYS][LEVELS + 1], error[WAYS][LEVELS + 1];
    lab_plot plot = {.title = "ball pulled at a patch: error against cost",
                     .x_name = "processor time of a step over that on the base",
                     .y_name = "largest error in the refined zone",
                     .log_x = true,
                     .log_y = true,
                     .curve_count = WAYS};
    for (int way = 0; way < WAYS; way++) {
        for (int i = 0; i <= LEVELS; i++) {
            const solution *one = i == 0 ? &all->base : &all->ways[way][i - 1];
            cost[way][i] = one->cost;
            error[way][i] = error_of(&all->rest, &all->reference, one);
        }
        plot.curves[way] = (lab_curve){ways[way].name, cost[way], error[way], LEVELS + 1, true};
    }
    return lab_add_plot(experiment, &plot);
}

static pel_status run_precision(lab_experiment *experiment)
{
    static study all;
    pel_status status = solve_all(experiment, &all);
    if (status != PEL_OK)
        return status;
    judge(experiment, &all);
    status = judge_physics(experiment);
    if (status == PEL_OK)
        status = plot_errors(experiment, &all);
    const lab_picture picture = {.caption = "the pulled ball in the end",
                                 .columns = 3,
                                 .runs = {"base", "narrow-2", "global-2"},
                                 .labels = {"base", "two levels, locally", "two levels, everywhere"},
                                 .run_count = 3,
                                 .frames = {-1},
                                 .frame_count = 1,
                                 .azimuth = 35,
                                 .elevation = 45,
                                 .edges = true};
    return status == PEL_OK ? lab_add_picture(experiment, &picture) : status;
}

const lab_case a_precision = {
    .name = "precision",
    .doc = "displacement under a load, refined locally, everywhere, and a reference",
    .group = "paper A",
    .place = "section 5",
    .run = run_precision,
};
