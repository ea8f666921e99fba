/* Figures 4 and 6 to 9 of paper A: levels of the lens surface; pressing and letting go, with and without volumetric
   springs; base, global and local refinement under the same force; the lens capsule under a probe. */
#include "papers/a/cases.h"
#include "papers/a/organ.h"
#include "papers/a/weights.h"
#include "papers/lab/trial.h"

#include <pellicle/mesh_io.h>
#include <pellicle/shape.h>
#include <pellicle/subdivide.h>

#include <math.h>
#include <string.h>

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

static const char reference[] = "paperA.py, an own program of the figure";

/* ---- figure 4 ---- */

/* largest move of the vertices that two levels share */
static double most_moved(const pel_mesh *coarse, const pel_mesh *fine)
{
    double most = 0;
    for (int32_t v = 0; v < coarse->vertex_count; v++)
        for (int i = 0; i < 3; i++)
            most = fmax(most, fabs(coarse->positions[v][i] - fine->positions[v][i]));
    return most;
}

/* largest distance of the vertices from the outline, relative to the lens' radius, measured from the finest lens */
static double most_off(const pel_mesh *mesh, const pel_mesh *fine)
{
    double most = 0, radius = 0;
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        const double *p = mesh->positions[v];
        double least = (double)HUGE_VAL, from_axis = sqrt(p[0] * p[0] + p[1] * p[1]);
        radius = fmax(radius, from_axis);
        for (int32_t w = 0; w < fine->vertex_count; w++) {
            const double *q = fine->positions[w];
            double r = sqrt(q[0] * q[0] + q[1] * q[1]) - from_axis, z = q[2] - p[2];
            least = fmin(least, r * r + z * z);
        }
        most = fmax(most, sqrt(least));
    }
    return most / radius;
}

static pel_status make_levels(lab_experiment *experiment, pel_mesh *levels[3], pel_mesh **fine)
{
    pel_shape_def def = pel_shape_def_default(PEL_SHAPE_LENS_CAPSULE);
    def.frequency = 5;
    pel_status status = pel_shape_create(&def, &levels[0], experiment->error);
    def.frequency = 60;
    if (status == PEL_OK)
        status = pel_shape_create(&def, fine, experiment->error);
    for (int i = 1; status == PEL_OK && i < 3; i++)
        status = pel_mesh_subdivide(levels[i - 1], 1, &levels[i], experiment->error);
    for (int i = 0; status == PEL_OK && i < 3; i++) {
        char name[32], path[LAB_PATH_SIZE];
        snprintf(name, sizeof name, "level-%d.ply", i);
        status = pel_mesh_write(lab_path(experiment, name, path), PEL_FORMAT_AUTO, levels[i], NULL, experiment->error);
    }
    return status;
}

static pel_status run_figure_4(lab_experiment *experiment)
{
    pel_mesh *levels[3] = {NULL, NULL, NULL}, *fine = NULL;
    pel_status status = make_levels(experiment, levels, &fine);
    if (status == PEL_OK) {
        lab_begin_claim(experiment, LAB_PAPER, "each level cuts a triangle into four", NULL);
        lab_by_construction(experiment, "a level is made of the four triangles of each one");
        for (int i = 1; i < 3; i++)
            lab_expect(experiment, i == 1 ? "triangles, level 1 / 0" : "triangles, level 2 / 1",
                       (double)levels[i]->triangle_count / levels[i - 1]->triangle_count, 4, 0, "paper A, section 3.1");
        lab_begin_claim(experiment, LAB_PAPER, "the scheme interpolates: vertices stay where they are", NULL);
        lab_by_construction(experiment, "a level keeps the numbers of the vertices before it");
        lab_at_most(experiment, "largest displacement of a vertex of level 0 [m]", most_moved(levels[0], levels[2]), 0,
                    "paper A, section 3.1");
        status = a_judge_weights(experiment);
        lab_begin_claim(experiment, LAB_REGRESSION, "the levels lie near the outline that the base was made from",
                        NULL);
        lab_at_most(experiment, "level 1: largest distance from the outline / radius", most_off(levels[1], fine), 0.03,
                    "our own runs");
        lab_at_most(experiment, "level 2: largest distance from the outline / radius", most_off(levels[2], fine), 0.03,
                    "our own runs");
    }
    for (int i = 0; i < 3; i++)
        pel_mesh_destroy(levels[i]);
    pel_mesh_destroy(fine);
    const lab_picture picture = {.caption = "three levels of the surface of a lens",
                                 .runs = {"level-0.ply", "level-1.ply", "level-2.ply"},
                                 .labels = {"base", "level 1", "level 2"},
                                 .run_count = 3,
                                 .frames = {0},
                                 .frame_count = 1,
                                 .columns = 3,
                                 .field = "none",
                                 .azimuth = 30,
                                 .elevation = 40,
                                 .edges = true};
    return status == PEL_OK ? lab_add_picture(experiment, &picture) : status;
}

const lab_case a_figure_4 = {
    .name = "figure4",
    .doc = "three levels of the surface of a lens by the modified butterfly scheme",
    .group = "paper A",
    .place = "section 3.1, figure 4",
    .run = run_figure_4,
};

/* ---- figures 6 and 7 ---- */

static pel_status plot_two(lab_experiment *experiment, const char *title, const char *const runs[2],
                           const char *const names[2])
{
    return lab_plot_runs(experiment, &(lab_run_plot){.title = title,
                                                     .x_name = "time [s]",
                                                     .y_name = "largest displacement [m]",
                                                     .x_column = "time",
                                                     .y_column = "max_displacement",
                                                     .runs = runs,
                                                     .labels = names,
                                                     .run_count = 2});
}

/* the same force outward: "pulling has the same effect" */
static pel_status check_pull(lab_experiment *experiment)
{
    static const char pull[] = "loads.0.force=[0, 0, 1]";
    const char *hollow[] = {pull, NULL}, *full[] = {pull, filled, NULL};
    pel_run_summary without = {0}, with = {0};
    pel_status status = lab_run(experiment, "pulled-hollow", sphere, hollow, &without);
    if (status == PEL_OK)
        status = lab_run(experiment, "pulled-filled", sphere, full, &with);
    if (status != PEL_OK)
        return status;
    lab_begin_claim(experiment, LAB_PAPER, "pulled, the ball recovers almost completely too", NULL);
    lab_at_most(experiment, "pulled, filled: residual / depth", with.residual_displacement / with.max_displacement,
                0.05, "paper A, section 4; 0.05 is ours");
    lab_at_least(experiment, "pulled: residual, hollow / filled",
                 without.residual_displacement / with.residual_displacement, 10, "paper A, section 4; 10 is ours");
    return PEL_OK;
}

/* times that the largest displacement of a run turns round after the force ends at 5 s */
static pel_status count_turns(lab_experiment *experiment, const char *run, double *turns)
{
    lab_series series;
    pel_status status = lab_read_series(experiment, run, "time", "max_displacement", &series);
    double last = 0;
    *turns = 0;
    for (int i = 1; status == PEL_OK && i < series.count; i++) {
        double change = series.y[i] - series.y[i - 1];
        if (series.x[i - 1] < 5 || fabs(change) < 1e-4)
            continue;
        *turns += change * last < 0;
        last = change;
    }
    lab_free_series(&series);
    return status;
}

/* explicit Euler swings where the quasi-static update does not; the paper's limits of stiffness and damping */
static pel_status check_euler(lab_experiment *experiment)
{
    const char *euler[] = {filled, "solver.method=explicit", NULL};
    const char *stiff[] = {"bodies.ball.volumetric={ stiffness: 20, damping: 2 }",
                           "bodies.ball.springs={ stiffness: 20, damping: 2 }", "duration=6", NULL, NULL};
    double swings = 0, still = 0;
    pel_run_summary explicit_end = {0}, limit[2] = {{0}};
    pel_status status = lab_run(experiment, "explicit", sphere, euler, &explicit_end);
    if (status == PEL_OK)
        status = count_turns(experiment, "explicit", &swings);
    if (status == PEL_OK)
        status = count_turns(experiment, "filled", &still);
    if (status == PEL_OK)
        status = lab_run(experiment, "limit", sphere, stiff, &limit[0]);
    stiff[3] = "solver.method=explicit";
    if (status == PEL_OK)
        status = lab_run(experiment, "limit-explicit", sphere, stiff, &limit[1]);
    if (status != PEL_OK)
        return status;
    lab_begin_claim(experiment, LAB_PAPER, "explicit Euler oscillates, the quasi-static update does not", NULL);
    lab_at_least(experiment, "explicit: reversals of the displacement after release", swings, 3, "paper A, section 1");
    lab_at_most(experiment, "quasi-static: reversals of the displacement after release", still, 0,
                "paper A, section 2");
    lab_begin_claim(experiment, LAB_PAPER, "stiffness 20 and damping 2 still work at dt 0.01", NULL);
    lab_at_most(experiment, "quasi-static, alpha 50: largest displacement [m]", limit[0].max_displacement, 0.1,
                "paper A, section 4; 0.1, a third of that with stiffness 3, is ours");
    lab_at_most(experiment, "explicit: largest displacement [m]", limit[1].max_displacement, 0.1,
                "paper A, section 4; 0.1 is ours");
    return PEL_OK;
}

/* The ball shifted as a whole: no structural spring changes its length, and each vertex swings on its volumetric spring
   alone, m z'' = -k' z - (d + d') z' (equations ). */
static pel_status check_swing(lab_experiment *experiment)
{
    enum { STEPS = 3000, VERTICES = 252 };
    const char *settings[] = {filled, "loads=[]", "solver={ method: explicit, dt: 0.001 }", NULL};
    const double shift = 0.1, decay = 0.5, rate = sqrt(1.5 - decay * decay), time = 1e-3 * STEPS;
    double at[VERTICES][3], mean = 0;
    lab_trial trial = {0};
    lab_tell_run(experiment, "swing");
    pel_status status = lab_open_trial("swing", sphere, settings, &trial, experiment->error);
    if (status == PEL_OK) {
        pel_sim_get_positions(trial.sim, 0, at[0]);
        for (int v = 0; v < VERTICES; v++)
            at[v][2] += shift;
        status = pel_sim_set_positions(trial.sim, 0, at[0], experiment->error);
    }
    for (int v = 0; v < VERTICES; v++)
        mean -= (at[v][2] - shift) / VERTICES;
    if (status == PEL_OK)
        status = lab_step_trial(&trial, STEPS, experiment->error);
    if (status == PEL_OK)
        pel_sim_get_positions(trial.sim, 0, at[0]);
    lab_close_trial(&trial);
    for (int v = 0; status == PEL_OK && v < VERTICES; v++)
        mean += at[v][2] / VERTICES;
    double exact = shift * exp(-decay * time) * (cos(rate * time) + decay / rate * sin(rate * time));
    lab_begin_claim(experiment, LAB_THEORY, "a volumetric spring and its damping are those of equation A-4", NULL);
    lab_expect(experiment, "shifted ball after 3 s: displacement / exact", mean / exact, 1, 0.01,
               "a damped oscillator, k' 1.5, d + d' 1, m 1");
    return status;
}

static pel_status run_figure_6_7(lab_experiment *experiment)
{
    static const char *const names[2] = {"without volumetric springs", "with volumetric springs"};
    static const char *const runs[2] = {"hollow", "filled"};
    const char *overrides[] = {filled, NULL};
    pel_run_summary hollow, full;
    pel_status status = lab_run(experiment, runs[0], sphere, NULL, &hollow);
    if (status == PEL_OK)
        status = lab_run(experiment, runs[1], sphere, overrides, &full);
    if (status != PEL_OK)
        return status;
    lab_begin_claim(experiment, LAB_PAPER, "without volumetric springs the ball does not recover", NULL);
    lab_at_least(experiment, "hollow: residual / depth", hollow.residual_displacement / hollow.max_displacement, 0.3,
                 "paper A, figure 6; 0.3 is ours");
    lab_begin_claim(experiment, LAB_PAPER, "with them it recovers almost completely", NULL);
    lab_at_most(experiment, "filled: residual / depth", full.residual_displacement / full.max_displacement, 0.05,
                "paper A, section 4; 0.05 is ours");
    lab_begin_claim(experiment, LAB_REFERENCE, "depths and residual displacements after 5 s", NULL);
    lab_expect(experiment, "hollow: depth [m]", hollow.max_displacement, 0.518, 0.001, reference);
    lab_expect(experiment, "hollow: residual after 5 s [m]", hollow.residual_displacement, 0.336, 0.002, reference);
    lab_expect(experiment, "filled: depth [m]", full.max_displacement, 0.283, 0.001, reference);
    lab_expect(experiment, "filled: residual after 5 s [m]", full.residual_displacement, 0.005, 0.001, reference);
    status = check_pull(experiment);
    if (status == PEL_OK)
        status = check_euler(experiment);
    if (status == PEL_OK)
        status = check_swing(experiment);
    if (status != PEL_OK)
        return status;
    status = plot_two(experiment, "a ball pressed for 5 s and released", runs, names);
    const lab_picture picture = {.caption = "pressed for 5 s, and 5 s after",
                                 .times = true,
                                 .runs = {"hollow", "filled"},
                                 .labels = {names[0], names[1]},
                                 .run_count = 2,
                                 .frames = {50, 100},
                                 .frame_count = 2,
                                 .azimuth = 35,
                                 .elevation = 45,
                                 .edges = true};
    return status == PEL_OK ? lab_add_picture(experiment, &picture) : status;
}

const lab_case a_figure_6_7 = {
    .name = "figure6-7",
    .doc = "a ball pressed and released, without and with volumetric springs",
    .group = "paper A",
    .place = "section 4, figures 6 and 7",
    .run = run_figure_6_7,
};

/* ---- figure 8 ---- */

/* the paper's counts on each of the three surfaces */
static void check_counts(lab_experiment *experiment, const char *const runs[3], const pel_run_summary summaries[3])
{
    static const double counts[3][2] = {{252, 500}, {1002, 2000}, {294, 584}};
    static const char *const says[3] = {
        "the base has 252 vertices and 500 triangles", "refined everywhere it has 1002 and 2000",
        "the force criterion refines the triangles around a vertex and its neighbours: 294 and 584"};
    for (int i = 0; i < 3; i++) {
        char name[64];
        lab_begin_claim(experiment, LAB_PAPER, says[i], NULL);
        if (i < 2)
            lab_by_construction(experiment, "the mesh, and each of its triangles cut into four");
        snprintf(name, sizeof name, "%s: vertices", runs[i]);
        lab_expect(experiment, name, (double)summaries[i].vertices_final, counts[i][0], 0, "paper A, table 1");
        snprintf(name, sizeof name, "%s: triangles", runs[i]);
        lab_expect(experiment, name, (double)summaries[i].triangles_final, counts[i][1], 0, "paper A, table 1");
        snprintf(name, sizeof name, "%s: depth [m]", runs[i]);
        lab_tell(experiment, name, summaries[i].residual_displacement, (double)NAN, "");
    }
}

static pel_status run_figure_8(lab_experiment *experiment)
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
        status = lab_run(experiment, runs[i], sphere, overrides, &summaries[i]);
    }
    if (status != PEL_OK)
        return status;
    check_counts(experiment, runs, summaries);
    double global = summaries[1].residual_displacement;
    lab_begin_claim(experiment, LAB_PAPER, "refined locally the shape is nearly that of refining everywhere", NULL);
    lab_expect(experiment, "local / global: depth", summaries[2].residual_displacement / global, 1, 0.05,
               "paper A, section 4; 5 % is ours");
    lab_tell(experiment, "base / global: depth", summaries[0].residual_displacement / global, 1, "");
    status = plot_two(experiment, "the same force on the surface refined everywhere and locally", &runs[1], &runs[1]);
    const lab_picture picture = {.caption = "the same force after 5 s",
                                 .times = true,
                                 .columns = 3,
                                 .runs = {"base", "global", "local"},
                                 .labels = {"base", "refined everywhere", "refined locally"},
                                 .run_count = 3,
                                 .frames = {50},
                                 .frame_count = 1,
                                 .azimuth = 35,
                                 .elevation = 45,
                                 .edges = true};
    if (status == PEL_OK)
        status = lab_add_picture(experiment, &picture);
    return status == PEL_OK ? a_press_organ(experiment) : status;
}

const lab_case a_figure_8 = {
    .name = "figure8",
    .doc = "the same force on the base, the globally and the locally refined ball",
    .group = "paper A",
    .place = "section 4, figure 8",
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

static pel_status run_figure_9(lab_experiment *experiment)
{
    static const char *const runs[2] = {"base", "local"}, *const names[2] = {"base", "refined near the probe"};
    const char *overrides[] = {"bodies.capsule.refine={ levels: 1, near_tools: 0.0002 }", NULL};
    pel_run_summary base, local;
    pel_status status = lab_run(experiment, runs[0], lens, NULL, &base);
    if (status == PEL_OK)
        status = lab_run(experiment, runs[1], lens, overrides, &local);
    if (status != PEL_OK)
        return status;
    /* the probe's lowest point goes from 2.18 mm, the front pole, to 1.18 mm */
    lab_begin_claim(experiment, LAB_THEORY, "the capsule follows the probe: it is pressed in as far as the probe moves",
                    NULL);
    lab_expect(experiment, "base: depth [m]", base.max_displacement, 0.001, 3e-5, "the displacement of the probe");
    lab_expect(experiment, "local: depth [m]", local.max_displacement, 0.001, 3e-5, "the displacement of the probe");
    lab_begin_claim(experiment, LAB_PAPER, "it is almost completely restored", NULL);
    lab_at_most(experiment, "base: residual / depth", base.residual_displacement / base.max_displacement, 0.01,
                "paper A, section 4; 0.01 is ours");
    lab_at_most(experiment, "local: residual / depth", local.residual_displacement / local.max_displacement, 0.01,
                "paper A, section 4; 0.01 is ours");
    lab_begin_claim(experiment, LAB_THEORY, "triangles refined near the probe are coarsened again at the end", NULL);
    lab_expect(experiment, "local: triangles at the end", (double)local.triangles_final, 5120, 0,
               "the mesh: all refinement given back");
    lab_tell(experiment, "base: largest force on the probe [N]", base.max_tool_force, (double)NAN, "");
    lab_tell(experiment, "local: largest force on the probe [N]", local.max_tool_force, (double)NAN, "");
    status = plot_two(experiment, "the capsule of an eye lens under a probe", runs, names);
    const lab_picture picture = {.caption = "pressed, and after",
                                 .times = true,
                                 .runs = {"base", "local"},
                                 .labels = {names[0], names[1]},
                                 .run_count = 2,
                                 .frames = {30, 100},
                                 .frame_count = 2,
                                 .azimuth = 30,
                                 .elevation = 30,
                                 .edges = true};
    if (status == PEL_OK)
        status = lab_add_picture(experiment, &picture);
    return status == PEL_OK ? a_probe_organ(experiment) : status;
}

const lab_case a_figure_9 = {
    .name = "figure9",
    .doc = "the capsule of an eye lens under a probe, on its mesh and refined near the probe",
    .group = "paper A",
    .place = "section 4, figure 9",
    .run = run_figure_9,
};
