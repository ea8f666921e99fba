/* The conclusion of paper B wishes for inflation: the same energies under a pressure from inside. */
#include "papers/b/shrink.h"

#include <math.h>
#include <stdlib.h>

enum { PRESSURES = 3 };

/* over the pressure that shrinks the body */
static const double pressures[PRESSURES] = {1, 3, 10};

typedef struct inflated {
    char names[PRESSURES][64];
    double early[PRESSURES], late[PRESSURES]; /* volume over that at rest in frames 80 and 100 */
    double intersections;
} inflated;

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
        made->intersections += (double)summary.self_intersections_final;
    }
    return status;
}

static void judge(lab_experiment *experiment, const inflated *made)
{
    static const char source[] = B_PAPER ", section 7 (future work); 1.005 and 0.03 are ours";
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
                 0.03, source);
    b_begin_contact_claim(experiment);
    for (int body = 0; body < count; body++)
        b_no_intersections(experiment, body, "intersections, all three", made[body].intersections);
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
    lab_picture picture = {.caption = "bodies under a pressure from inside, at rest and in frame 100",
                           .frames = {0, 100},
                           .frame_count = 2,
                           .columns = 2,
                           .field = "none",
                           .azimuth = 35,
                           .elevation = 20};
    for (int body = 0; body < b_shown(experiment); body++) {
        picture.labels[picture.run_count] = experiment->bodies[body].name;
        picture.runs[picture.run_count++] = made[body].names[1];
    }
    return lab_add_picture(experiment, &picture);
}

const lab_case b_inflation = {
    .name = "b-inflation",
    .doc = "the paper's wish: bodies under a pressure from inside",
    .group = "paper B",
    .place = "section 7, future work",
    .run = run_inflation,
};
