/* Figure 4 of paper B: one stencil of bending, two triangles with a common edge, one of them held. The other one is
   folded by a force and let go. */
#include "papers/b/shrink.h"
#include "papers/lab/trial.h"

#include <pellicle/sim.h>

#include <math.h>

enum { CHOICES = 4, NONE = 0, WEAK = 1, PAPER = 2, STRONG = 3, LET_GO = 15, LAST = 120 };

static const char *const choices[CHOICES] = {"0", "0.001", "0.01", "1"};

/* the corner at -x +y is free; a force folds the stencil for a quarter of a second */
static const char scene[] = "version: 1\n"
                            "bodies:\n"
                            "  - name: stencil\n"
                            "    mesh: { shape: grid, nx: 1, ny: 1, size_x: 1, size_y: 1 }\n"
                            "    mass: { density: 1000, thickness: 0.01 }\n"
                            "    membrane: { material: stvk, young: 1.0e5 }\n"
                            "    bending: { model: isometric, weight: 0.01 }\n"
                            "    pinned: { vertices: [0, 1, 3] }\n"
                            "loads:\n"
                            "  - { name: push, body: stencil, at: { vertices: [2] }, force: [0, 0, 2], until: 0.25 }\n"
                            "solver: { method: pbd, dt: 0.0166666667, iterations: 5 }\n"
                            "stop: { frames: 120 }\n";

/* radians between the two triangles in frames 0 to LAST */
static pel_status fold(lab_experiment *experiment, const char *weight, double angles[LAST + 1])
{
    char setting[64];
    lab_trial trial = {0};
    snprintf(setting, sizeof setting, "bodies.0.bending.weight=%s", weight);
    const char *settings[] = {setting, NULL};
    lab_tell_run(experiment, weight);
    pel_status status = lab_open_trial("stencil", scene, settings, &trial, experiment->error);
    for (int frame = 0; status == PEL_OK && frame <= LAST; frame++) {
        double x[4][3];
        if (frame > 0)
            status = lab_step_trial(&trial, 1, experiment->error);
        if (status != PEL_OK)
            break;
        pel_sim_get_positions(trial.sim, 0, x[0]);
        /* of the height over the held triangle and the distance from the common edge */
        double across = (x[2][1] - x[2][0]) / sqrt(2.0);
        angles[frame] = atan2(x[2][2], across);
    }
    lab_close_trial(&trial);
    return status;
}

static int count_passes(const double angles[LAST + 1])
{
    int passes = 0;
    for (int frame = LET_GO + 1; frame <= LAST; frame++)
        passes += angles[frame] * angles[frame - 1] < 0;
    return passes;
}

static pel_status plot(lab_experiment *experiment, double angles[CHOICES][LAST + 1])
{
    double frames[LAST + 1];
    lab_plot curves = {.title = "one stencil, folded until frame 15 and let go",
                       .x_name = "frame",
                       .y_name = "angle [rad]",
                       .curve_count = CHOICES};
    static const char *const names[CHOICES] = {"without E_B", "k_B 0.001", "k_B 0.01", "k_B 1"};
    for (int frame = 0; frame <= LAST; frame++)
        frames[frame] = frame;
    for (int i = 0; i < CHOICES; i++)
        curves.curves[i] = (lab_curve){names[i], frames, angles[i], LAST + 1, false};
    return lab_add_plot(experiment, &curves);
}

static pel_status run_figure_4(lab_experiment *experiment)
{
    static double angles[CHOICES][LAST + 1];
    pel_status status = PEL_OK;
    for (int i = 0; status == PEL_OK && i < CHOICES; i++)
        status = fold(experiment, choices[i], angles[i]);
    if (status != PEL_OK)
        return status;
    lab_begin_claim(experiment, LAB_PAPER, "without E_B a folded stencil does not return", NULL);
    lab_at_least(experiment, "angle in frame 60 / in frame 15, without E_B", angles[NONE][60] / angles[NONE][LET_GO], 1,
                 B_PAPER ", figure 4");
    lab_begin_claim(experiment, LAB_PAPER, "E_B drives it back to its first shape", NULL);
    lab_at_least(experiment, "passes through the shape at rest after it is let go, k_B 0.001",
                 count_passes(angles[WEAK]), 1, B_PAPER ", figure 4");
    lab_begin_claim(experiment, LAB_PAPER, "a good k_B keeps it between its first shape and that without E_B", NULL);
    for (int i = WEAK; i < STRONG; i++) {
        char name[64];
        snprintf(name, sizeof name, "angle in frame 15, k_B %s / without E_B", choices[i]);
        lab_expect(experiment, name, angles[i][LET_GO] / angles[NONE][LET_GO], 0.5, 0.499, B_PAPER ", figure 4");
    }
    lab_begin_claim(experiment, LAB_PAPER, "a large k_B resists all folding", NULL);
    lab_at_most(experiment, "angle in frame 15, k_B 1 / without E_B", angles[STRONG][LET_GO] / angles[NONE][LET_GO],
                0.01, B_PAPER ", figure 4; 0.01 is ours");
    lab_begin_claim(experiment, LAB_PAPER, "the larger k_B, the more it jitters", NULL);
    for (int i = PAPER; i <= STRONG; i++) {
        char name[96];
        snprintf(name, sizeof name, "passes through the shape at rest, k_B %s / k_B %s", choices[i], choices[i - 1]);
        lab_at_least(experiment, name, count_passes(angles[i]) / (double)count_passes(angles[i - 1]), 1,
                     B_PAPER ", figure 4");
    }
    for (int i = 0; i < CHOICES; i++) {
        char name[64];
        snprintf(name, sizeof name, "angle in frame 15 [rad], k_B %s", choices[i]);
        lab_tell(experiment, name, angles[i][LET_GO], (double)NAN, "");
    }
    return plot(experiment, angles);
}

const lab_case b_figure_4 = {
    .name = "b-figure4",
    .doc = "one stencil, folded and let go: the states between no and too much bending energy",
    .group = "paper B",
    .place = "section 3, figure 4",
    .run = run_figure_4,
};
