/* Figures 8 and 9 of paper A on an organ: filled by volumetric springs, of a material instead of the paper's numbers
   for a ball of 252 vertices. */
#include "papers/a/organ.h"

#include "papers/lab/body.h"

#include <math.h>
#include <string.h>

static const char scene[] = "version: 1\n"
                            "title: organ filled by volumetric springs\n"
                            "bodies:\n"
                            "  - name: organ\n"
                            "    mesh: { shape: geodesic-sphere }\n"
                            "    springs: { young: 5000 }\n"
                            "    volumetric: { young: 5000 }\n"
                            "solver: { method: quasi-static, dt: 0.01 }\n"
                            "duration: 10\n"
                            "output: { every: 2.5, fields: [displacement, force] }\n";

enum { KINDS = 3, BASE = 0, GLOBAL = 1, LOCAL = 2, PRESSED = 2 };

static const char *const runs[KINDS] = {"organ-base", "organ-global", "organ-local"};

static const lab_body *find_organ(const lab_experiment *experiment)
{
    for (int i = 0; i < experiment->body_count; i++)
        if (strncmp(experiment->bodies[i].name, "liver", 5) == 0)
            return &experiment->bodies[i];
    return &experiment->bodies[0];
}

/* a point at a height over the roundest part of the organ */
static void point_over(const lab_body *organ, double height, double point[3])
{
    for (int i = 0; i < 3; i++)
        point[i] = organ->cap_center[i] + height * organ->cap_normal[i];
}

static pel_status run_organ(lab_experiment *experiment, const lab_body *organ, const char *cause,
                            const char *const refine[KINDS], pel_run_summary summaries[KINDS])
{
    pel_status status = PEL_OK;
    for (int i = 0; status == PEL_OK && i < KINDS; i++) {
        const char *overrides[] = {organ->mesh, cause, refine[i], NULL};
        status = lab_run(experiment, runs[i], scene, overrides, &summaries[i]);
    }
    return status;
}

/* largest displacement in a frame */
static pel_status depth_of(const lab_experiment *experiment, const char *run, int frame, double *depth)
{
    lab_series series;
    pel_status status = lab_read_series(experiment, run, "time", "max_displacement", &series);
    if (status == PEL_OK)
        *depth = series.y[frame < series.count ? frame : series.count - 1];
    lab_free_series(&series);
    return status;
}

static pel_status draw_organ(lab_experiment *experiment, const char *caption)
{
    const lab_picture picture = {.caption = caption,
                                 .times = true,
                                 .runs = {runs[BASE], runs[GLOBAL], runs[LOCAL]},
                                 .labels = {"base", "refined everywhere", "refined locally"},
                                 .run_count = KINDS,
                                 .frames = {PRESSED},
                                 .frame_count = 1,
                                 .columns = KINDS,
                                 .azimuth = 35,
                                 .elevation = 35,
                                 .edges = true};
    return lab_add_picture(experiment, &picture);
}

/* ---- figure 8 ---- */

pel_status a_press_organ(lab_experiment *experiment)
{
    static const char *const refine[KINDS] = {NULL, "bodies.organ.refine={ levels: 1, everywhere: true }",
                                              "bodies.organ.refine={ levels: 1, above: 500 }"};
    const lab_body *organ = find_organ(experiment);
    double over[3], depths[KINDS] = {0};
    char load[200];
    pel_run_summary summaries[KINDS];
    point_over(organ, 300, over);
    const double *at = organ->cap_center;
    snprintf(load, sizeof load, "loads=[{ force: [%.9g, %.9g, %.9g], at: { nearest: [%.9g, %.9g, %.9g] }, until: 5 }]",
             at[0] - over[0], at[1] - over[1], at[2] - over[2], at[0], at[1], at[2]);
    pel_status status = run_organ(experiment, organ, load, refine, summaries);
    for (int i = 0; status == PEL_OK && i < KINDS; i++)
        status = depth_of(experiment, runs[i], PRESSED, &depths[i]);
    if (status != PEL_OK)
        return status;
    lab_begin_claim(experiment, LAB_PAPER, "an organ: refined locally the shape is nearly that of refining everywhere",
                    NULL);
    lab_expect(experiment, "organ, local / global: depth", depths[LOCAL] / depths[GLOBAL], 1, 0.05,
               "paper A, section 4; 5 % is ours");
    lab_at_least(experiment, "organ: error of the depth, base / local",
                 fabs(depths[BASE] - depths[GLOBAL]) / fabs(depths[LOCAL] - depths[GLOBAL]), 3,
                 "paper A, section 5: many times more precise; 3 is ours");
    lab_tell(experiment, "organ: depth [m], base", depths[BASE], depths[GLOBAL], "refined everywhere");
    lab_tell(experiment, "organ: triangles, base", (double)summaries[BASE].triangles_final,
             (double)summaries[GLOBAL].triangles_final, "refined everywhere");
    return draw_organ(experiment, "the same force on an organ after 5 s");
}

/* ---- figure 9 ---- */

pel_status a_probe_organ(lab_experiment *experiment)
{
    static const char *const refine[KINDS] = {NULL, "bodies.organ.refine={ levels: 1, everywhere: true }",
                                              "bodies.organ.refine={ levels: 1, near_tools: 0.1 }"};
    const lab_body *organ = find_organ(experiment);
    const double radius = 0.2, way = 0.15;
    double high[3], low[3];
    char probe[400];
    pel_run_summary summaries[KINDS];
    point_over(organ, radius + 0.1, high);
    point_over(organ, radius - way, low);
    snprintf(probe, sizeof probe,
             "tools=[{ name: probe, shape: sphere, radius: %g, motion: [{ position: [%.9g, %.9g, %.9g] }, { time: 3, "
             "position: [%.9g, %.9g, %.9g] }, { time: 5, position: [%.9g, %.9g, %.9g] }, { time: 6, position: [%.9g, "
             "%.9g, %.9g] }] }]",
             radius, high[0], high[1], high[2], low[0], low[1], low[2], low[0], low[1], low[2], high[0], high[1],
             high[2]);
    pel_status status = run_organ(experiment, organ, probe, refine, summaries);
    if (status != PEL_OK)
        return status;
    lab_begin_claim(experiment, LAB_THEORY, "an organ follows the probe as far as it moves", NULL);
    for (int i = 0; i < KINDS; i++) {
        char name[64];
        snprintf(name, sizeof name, "%s: depth / way of the probe", runs[i]);
        lab_expect(experiment, name, summaries[i].max_displacement / way, 1, 0.1, "the displacement of the probe");
    }
    lab_begin_claim(experiment, LAB_PAPER, "an organ is almost completely restored", NULL);
    for (int i = 0; i < KINDS; i++) {
        char name[64];
        snprintf(name, sizeof name, "%s: residual / depth", runs[i]);
        lab_at_most(experiment, name, summaries[i].residual_displacement / summaries[i].max_displacement, 0.05,
                    "paper A, section 4; 0.05 is ours, as for the ball");
    }
    lab_begin_claim(experiment, LAB_PAPER, "refined near the probe, the force is nearly that of refining everywhere",
                    NULL);
    lab_expect(experiment, "organ, local / global: largest force on the probe",
               summaries[LOCAL].max_tool_force / summaries[GLOBAL].max_tool_force, 1, 0.1,
               "paper A, section 4; 0.1 is ours");
    lab_tell(experiment, "organ: largest force on the probe [N], base", summaries[BASE].max_tool_force,
             summaries[GLOBAL].max_tool_force, "refined everywhere");
    return draw_organ(experiment, "an organ under a probe");
}
