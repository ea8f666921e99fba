/* Checks of shells: a sphere under pressure, and xpbd compared with the leapfrog up to half the buckling pressure of a
   sphere (theory: sections 11 and 12). */
#include "papers/own/cases.h"

#include <pellicle/shape.h>

#include <math.h>
#include <stdlib.h>

static const char balloon[] = "version: 1\n"
                              "title: sphere under a small pressure\n"
                              "bodies:\n"
                              "  - name: ball\n"
                              "    mesh: { shape: geodesic-sphere, frequency: 16 }\n"
                              "    membrane: { material: stvk, young: 1, poisson: 0.3, thickness: 0.01 }\n"
                              "    bending: {}\n"
                              "    pressure: { inside: 1.0e-6 }\n"
                              "solver: { method: descent }\n"
                              "stop: { frames: 60, at_rest: 1.0e-12 }\n"
                              "output: { every_frame: 1 }\n";

/* mean displacement over the exact one, from the volume */
static pel_status check_sphere(lab_experiment *experiment)
{
    static const struct {
        const char *run, *frequency;
        double tolerance;
    } levels[] = {{"sphere-1280", "bodies.0.mesh.frequency=8", 0.01},
                  {"sphere-5120", "bodies.0.mesh.frequency=16", 0.002},
                  {"sphere-20480", "bodies.0.mesh.frequency=32", 0.0005}};
    for (int i = 0; i < 3; i++) {
        const char *overrides[] = {levels[i].frequency, NULL};
        pel_run_summary summary;
        char name[64];
        pel_status status = lab_run(experiment, levels[i].run, balloon, overrides, &summary);
        if (status != PEL_OK)
            return status;
        double exact = 1e-6 * 0.7 / (2 * 0.01), mean = (cbrt(summary.volume_ratio_final) - 1) / exact;
        snprintf(name, sizeof name, "%s: mean displacement / exact", levels[i].run);
        lab_expect(experiment, name, mean, 1, levels[i].tolerance, "p R^2 (1 - nu) / (2 E h)");
    }
    return PEL_OK;
}

/* ---- xpbd and the leapfrog ---- */

typedef struct pressed_ball {
    const pel_mesh *mesh;
    pel_error *error;
} pressed_ball;

static pel_status create_model(const pressed_ball *ball, pel_model **model)
{
    const double frame = 1.0 / 60, critical = 2e6 / sqrt(3 * 0.91) * 1e-4;
    const pel_key keys[2] = {{0, 0}, {5 * frame, 0.5 * critical}};
    pel_body_def body = pel_body_def_sheet("ball", ball->mesh, 1e6, 0.01, 1000);
    body.shell.membrane.kind = PEL_MEMBRANE_STVK;
    body.shell.bending.model = PEL_BENDING_HINGE;
    body.shell.pressure.kind = PEL_PRESSURE_GIVEN;
    body.shell.pressure.outside = (pel_quantity){.keys = keys, .key_count = 2};
    pel_model_def def = pel_model_def_default();
    def.bodies = &body;
    def.body_count = 1;
    return pel_model_create(&def, model, ball->error);
}

/* ten frames of 1/60 s; the pressure rises in five of them */
static pel_status press(const pressed_ball *ball, pel_method method, int32_t substeps, double *positions)
{
    pel_model *model;
    pel_sim *sim = NULL;
    pel_status status = create_model(ball, &model);
    if (status != PEL_OK)
        return status;
    bool projects = method == PEL_METHOD_XPBD;
    pel_sim_def def = pel_sim_def_default();
    def.model = model;
    def.solver.method = method;
    def.solver.dt = projects ? 1.0 / 60 : 1.0 / (60 * substeps);
    def.solver.substeps = projects ? substeps : 0;
    def.solver.second_order = PEL_NO;
    status = pel_sim_create(&def, &sim, ball->error);
    for (int32_t i = 0; status == PEL_OK && i < (projects ? 10 : 10 * substeps); i++)
        status = pel_sim_step(sim, ball->error);
    if (status == PEL_OK)
        pel_sim_get_positions(sim, 0, positions);
    pel_sim_destroy(sim);
    pel_model_destroy(model);
    return status;
}

static double distance(const double *a, const double *b, size_t count)
{
    double square = 0;
    for (size_t i = 0; i < count; i++)
        square += (a[i] - b[i]) * (a[i] - b[i]);
    return sqrt(square);
}

static pel_status compare(lab_experiment *experiment, const pressed_ball *ball, double *reference, double *other)
{
    enum { COUNT = 5 };
    size_t count = 3 * (size_t)ball->mesh->vertex_count;
    double errors[COUNT] = {0}, substeps[COUNT] = {8, 16, 32, 64, 128};
    lab_tell_run(experiment, "leapfrog and xpbd");
    pel_status status = press(ball, PEL_METHOD_EXPLICIT, 512, reference);
    for (int i = 0; status == PEL_OK && i < COUNT; i++) {
        char name[64];
        status = press(ball, PEL_METHOD_XPBD, (int32_t)substeps[i], other);
        errors[i] = distance(reference, other, count) / distance(reference, ball->mesh->positions[0], count);
        snprintf(name, sizeof name, "xpbd: error with %.0f substeps", substeps[i]);
        if (i == 3)
            lab_at_most(experiment, name, errors[i], 0.05, "theory, section 12");
        else
            lab_tell(experiment, name, errors[i], (double)NAN, "");
    }
    if (status != PEL_OK)
        return status;
    lab_at_most(experiment, "xpbd: error with 128 / with 64 substeps", errors[4] / errors[3], 0.55,
                "first order or better");
    const lab_plot plot = {.title =
                               "xpbd compared with the leapfrog: a sphere on the way to half its buckling pressure",
                           .x_name = "substeps in a frame of 1/60 s",
                           .y_name = "distance from the leapfrog / displacement",
                           .log_x = true,
                           .log_y = true,
                           .curves = {{"xpbd", substeps, errors, COUNT, true}},
                           .curve_count = 1};
    return lab_add_plot(experiment, &plot);
}

static pel_status check_xpbd(lab_experiment *experiment)
{
    pel_shape_def shape = pel_shape_def_default(PEL_SHAPE_GEODESIC_SPHERE);
    shape.frequency = 32;
    pel_mesh *mesh;
    pel_status status = pel_shape_create(&shape, &mesh, experiment->error);
    if (status != PEL_OK)
        return status;
    const pressed_ball ball = {mesh, experiment->error};
    double *reference = calloc((size_t)mesh->vertex_count, 3 * sizeof *reference);
    double *other = calloc((size_t)mesh->vertex_count, 3 * sizeof *other);
    if (reference != NULL && other != NULL)
        status = compare(experiment, &ball, reference, other);
    else
        status = pel_fail_memory(experiment->error);
    free(reference);
    free(other);
    pel_mesh_destroy(mesh);
    return status;
}

static pel_status run_shell_checks(lab_experiment *experiment)
{
    pel_status status = check_sphere(experiment);
    return status == PEL_OK ? check_xpbd(experiment) : status;
}

const lab_case own_shells = {
    .name = "shells",
    .doc = "a sphere under pressure, and xpbd compared with the leapfrog (some minutes)",
    .group = "own",
    .origin = LAB_THEORY,
    .run = run_shell_checks,
};
