/* The conclusion of paper B wishes for inflation: the same energies under a pressure from inside. pbd shows how it
   looks. How far a pressure inflates a body depends on its stiffness, which xpbd adds to pbd: it is compared with the
   equilibrium. */
#include "papers/b/shrink.h"

#include <math.h>
#include <stdlib.h>

enum { PRESSURES = 3 };

/* over the pressure that shrinks the body */
static const double pressures[PRESSURES] = {1, 3, 10};

/* at equilibrium, over the same: response is linear, so that the work is twice the energy */
#define SMALL 0.03

typedef struct inflated {
    char names[PRESSURES][64];
    double early[PRESSURES], late[PRESSURES]; /* volume over that at rest in frames 80 and 100 */
    double weighed; /* work of the small pressure over twice the energy of the body at equilibrium */
    double linear;  /* growth of the volume there, over the part of the pressure */
    double moved;   /* under pressure 1: growth of the volume by xpbd over that at equilibrium */
} inflated;

/* a run under a part of the pressure, with the bending of hinges, which keeps the shape at rest; name: of the run */
static pel_status press_by(lab_experiment *experiment, int body, double part, const char *what, const char *solver,
                           const char *stop, char name[64])
{
    char pressure[64];
    pel_run_summary summary;
    snprintf(pressure, sizeof pressure, "bodies.0.pressure.outside=%.15g", -part * experiment->bodies[body].pressure);
    const char *settings[] = {pressure, "bodies.0.bending={ model: hinge }", solver, stop, NULL};
    b_run_name(experiment, body, what, name);
    return b_shrink(experiment, body, what, settings, &summary);
}

/* a column in the first and in the last row of a run */
static pel_status read_ends(lab_experiment *experiment, const char *name, const char *column, double ends[2])
{
    lab_series series;
    pel_status status = lab_read_series(experiment, name, "frame", column, &series);
    if (status == PEL_OK) {
        ends[0] = series.y[0];
        ends[1] = series.y[series.count - 1];
    }
    lab_free_series(&series);
    return status;
}

static pel_status weigh(lab_experiment *experiment, int body, inflated *made)
{
    char name[64];
    static const char by_newton[] = "solver={ method: static }", one[] = "stop.frames=1";
    double volume[2], energy[2], ratio[2], still[2], moved[2];
    pel_status status = press_by(experiment, body, SMALL, "static", by_newton, one, name);
    if (status == PEL_OK)
        status = read_ends(experiment, name, "volume", volume);
    if (status == PEL_OK)
        status = read_ends(experiment, name, "elastic_energy", energy);
    if (status == PEL_OK)
        status = read_ends(experiment, name, "volume_ratio", ratio);
    if (status == PEL_OK)
        status = press_by(experiment, body, 1, "static-1", by_newton, one, name);
    if (status == PEL_OK)
        status = read_ends(experiment, name, "volume_ratio", still);
    /* the drag lets it settle in these frames */
    if (status == PEL_OK)
        status = press_by(experiment, body, 1, "xpbd-1", "solver={ method: xpbd, dt: 0.0166666667, drag: 2 }",
                          "stop.frames=150", name);
    if (status == PEL_OK)
        status = read_ends(experiment, name, "volume_ratio", moved);
    if (status != PEL_OK)
        return status;
    made->weighed = SMALL * experiment->bodies[body].pressure * (volume[1] - volume[0]) / (2 * energy[1]);
    made->linear = (ratio[1] - 1) / SMALL;
    made->moved = (moved[1] - 1) / (still[1] - 1);
    return PEL_OK;
}

static pel_status inflate(lab_experiment *experiment, int body, inflated *made)
{
    pel_status status = PEL_OK;
    for (int i = 0; status == PEL_OK && i < PRESSURES; i++) {
        char pressure[64], what[32];
        int rises;
        pel_run_summary summary = {0};
        snprintf(pressure, sizeof pressure, "bodies.0.pressure.outside=%.15g",
                 -pressures[i] * experiment->bodies[body].pressure);
        snprintf(what, sizeof what, "inside-%g", pressures[i]);
        const char *settings[] = {pressure, NULL};
        status = b_shrink(experiment, body, what, settings, &summary);
        b_run_name(experiment, body, what, made->names[i]);
        if (status == PEL_OK)
            status = b_volume(experiment, made->names[i], 80, &made->early[i], &rises);
        if (status == PEL_OK)
            status = b_volume(experiment, made->names[i], 100, &made->late[i], &rises);
    }
    return status == PEL_OK ? weigh(experiment, body, made) : status;
}

static void judge(lab_experiment *experiment, const inflated *made)
{
    static const char source[] = B_PAPER ", section 7 (future work); 1.005 and 0.01 are ours";
    int count = b_shown(experiment);
    lab_begin_claim(experiment, LAB_PAPER, "bodies are inflated, the more the higher the pressure", NULL);
    for (int body = 0; body < count; body++) {
        b_at_least(experiment, body, "volume in frame 100, pressure 1", made[body].late[0], 1.005, source);
        b_at_least(experiment, body, "volume in frame 100, pressure 3 / 1", made[body].late[1] / made[body].late[0],
                   1.005, source);
        b_at_least(experiment, body, "volume in frame 100, pressure 10 / 3", made[body].late[2] / made[body].late[1],
                   1.005, source);
    }
    lab_begin_claim(experiment, LAB_PAPER, "and come to rest there", NULL);
    for (int body = 0; body < count; body++)
        b_expect(experiment, body, "volume, frame 100 / 80, pressure 3", made[body].late[1] / made[body].early[1], 1,
                 0.01, source);
    lab_begin_claim(experiment, LAB_THEORY, "inflation weighs what the pressure does: its work is twice the energy",
                    NULL);
    for (int body = 0; body < count; body++) {
        b_expect(experiment, body, "work of a small pressure / twice the energy, static", made[body].weighed, 1, 0.03,
                 "Clapeyron");
        b_expect(experiment, body, "growth of the volume under pressure 1, xpbd / static", made[body].moved, 1, 0.1,
                 "the equilibrium; the softness of xpbd's substeps is 5 %, the rest is motion");
        b_tell(experiment, body, "growth of the volume under pressure 1, pbd", made[body].late[0] - 1,
               made[body].linear, "static, linear: pbd ignores the stiffness, and k_B rounds bodies");
    }
}

static pel_status run_inflation(lab_experiment *experiment)
{
    static inflated made[B_SHOWN];
    pel_status status = PEL_OK;
    for (int body = 0; status == PEL_OK && body < b_shown(experiment); body++) {
        made[body] = (inflated){0};
        status = inflate(experiment, body, &made[body]);
    }
    if (status != PEL_OK)
        return status;
    judge(experiment, made);
    static const int frames[] = {0, 100};
    return b_draw_bodies(experiment, "bodies under a pressure from inside, at rest and in frame 100", "inside-3",
                         frames, 2);
}

const lab_case b_inflation = {
    .name = "b-inflation",
    .doc = "the paper's wish: bodies under a pressure from inside",
    .group = "paper B",
    .place = "section 7, future work",
    .run = run_inflation,
};
