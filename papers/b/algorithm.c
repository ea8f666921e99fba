/* Section 5 of paper B as it is written, beside the form of it that the other experiments run: the pressure along the
   normals of vertices (section 2), and collisions found by the cubic of Bridson and others and corrected once after the
   sweeps (step 4). */
#include "papers/b/shrink.h"

#include <math.h>

/* frames: before anything touches, and after much has */
enum { FORMS = 2, OURS = 0, WRITTEN = 1, MEASURED = 70, TOUCHED = 110 };

static const char *const forms[FORMS] = {"ours", "written"};

typedef struct outcome {
    char names[FORMS][64];
    double volumes[FORMS]; /* in frame MEASURED */
    b_contacts contacts[FORMS];
    b_shrunk shapes[FORMS]; /* in that frame */
    double apart;           /* root mean square of the distance between the shapes, over that from rest */
} outcome;

static pel_status measure_apart(const lab_experiment *experiment, outcome *made)
{
    pel_mesh *meshes[FORMS] = {NULL, NULL};
    pel_status status = PEL_OK;
    for (int i = 0; status == PEL_OK && i < FORMS; i++)
        status = b_read_frame(experiment, made->names[i], MEASURED, &meshes[i]);
    double apart = 0;
    for (int32_t v = 0; status == PEL_OK && v < meshes[0]->vertex_count; v++)
        for (int i = 0; i < 3; i++)
            apart += pow(meshes[1]->positions[v][i] - meshes[0]->positions[v][i], 2) / meshes[0]->vertex_count;
    made->apart = sqrt(apart) / made->shapes[OURS].body_way;
    for (int i = 0; i < FORMS; i++)
        pel_mesh_destroy(meshes[i]);
    return status;
}

static pel_status run_forms(lab_experiment *experiment, int body, outcome *made)
{
    char energy[B_FIBRES_SIZE];
    const char *settings[] = {b_fibres(experiment, body, "arap", energy),
                              experiment->bodies[body].cap,
                              "stop.frames=110",
                              "contact={ self: true }",
                              NULL,
                              NULL};
    pel_status status = PEL_OK;
    for (int i = 0; status == PEL_OK && i < FORMS; i++) {
        pel_run_summary summary = {0};
        int rises;
        if (i == WRITTEN) {
            settings[3] = "contact={ self: true, method: bridson, response: after }";
            settings[4] = "bodies.0.pressure.form=vertex-normal";
        }
        status = b_shrink(experiment, body, forms[i], settings, &summary);
        b_run_name(experiment, body, forms[i], made->names[i]);
        if (status == PEL_OK)
            status = b_volume(experiment, made->names[i], MEASURED, &made->volumes[i], &rises);
        if (status == PEL_OK)
            status = b_measure(experiment, body, made->names[i], MEASURED, &made->shapes[i]);
        if (status == PEL_OK)
            status = b_add_contacts(experiment, body, forms[i], &summary, &made->contacts[i]);
    }
    return status == PEL_OK ? measure_apart(experiment, made) : status;
}

static pel_status run_algorithm(lab_experiment *experiment)
{
    static const char source[] = B_PAPER ", sections 2 and 5; the limit is ours";
    static outcome made[B_SHOWN];
    int count = b_shown(experiment);
    pel_status status = PEL_OK;
    for (int body = 0; status == PEL_OK && body < count; body++)
        status = run_forms(experiment, body, &made[body]);
    if (status != PEL_OK)
        return status;
    lab_begin_claim(experiment, LAB_PAPER, "as written, the algorithm shrinks bodies", NULL);
    for (int body = 0; body < count; body++) {
        b_at_most(experiment, body, "volume in frame 70, as written", made[body].volumes[WRITTEN], 0.95, source);
        b_tell(experiment, body, "depth of the cap [m], as written", made[body].shapes[WRITTEN].cap_depth,
               made[body].shapes[OURS].cap_depth, "the form of the other experiments");
    }
    lab_begin_claim(experiment, LAB_THEORY, "the other experiments show what the algorithm as written shows", NULL);
    for (int body = 0; body < count; body++) {
        b_expect(experiment, body, "volume in frame 70, as written / other form",
                 made[body].volumes[WRITTEN] / made[body].volumes[OURS], 1, 0.05, "one force, one set of energies");
        b_at_most(experiment, body, "distance between the shapes / from rest", made[body].apart, 0.25,
                  "one force, one set of energies");
    }
    b_begin_bound_claim(experiment);
    for (int body = 0; body < count; body++)
        for (int i = 0; status == PEL_OK && i < FORMS; i++)
            status = b_judge_bound(experiment, body, forms[i]);
    if (status != PEL_OK)
        return status;
    b_begin_contact_claim(experiment, NULL);
    for (int body = 0; body < count; body++) {
        b_judge_contacts(experiment, body, "as written, 110 frames", &made[body].contacts[WRITTEN]);
        b_judge_contacts(experiment, body, "other form, 110 frames", &made[body].contacts[OURS]);
    }
    static const char *const labels[2] = {"other experiments", "as written"};
    lab_picture picture =
        b_begin_pairs("the form of the other experiments, and the algorithm as written, frame 110", TOUCHED, count);
    for (int body = 0; body < count; body++)
        b_add_pair(&picture, labels, made[body].names);
    return lab_add_picture(experiment, &picture);
}

const lab_case b_algorithm = {
    .name = "b-algorithm",
    .doc = "the pressure and the collisions as the paper writes them, beside the form of the other experiments",
    .group = "paper B",
    .place = "section 5",
    .run = run_algorithm,
};
