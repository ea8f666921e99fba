/* Figures 1, 2, 5, 8, 9 and 10 of paper B: the pipeline, the pressure, and the effect of each energy. */
#include "papers/b/shrink.h"

#include <pellicle/measure.h>
#include <pellicle/mesh_io.h>
#include <pellicle/topology.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char isotropic[] = "plain", fibred[] = "fibres";

/* ---- figure 1 ---- */

enum { STAGES = 5 };

static const char *const stages[STAGES] = {"pressure", "stretch", "bending", "fibres", "contact"};

static void judge_stages(lab_experiment *experiment, const b_shrunk shapes[STAGES], const b_contacts *contacts)
{
    lab_begin_claim(experiment, LAB_PAPER, "the prediction by pressure alone stretches the surface too far", NULL);
    for (int i = 0; i < STAGES; i++) {
        char text[64];
        snprintf(text, sizeof text, "%s, membrane energy per area over mu", stages[i]);
        b_tell(experiment, 0, text, shapes[i].energy, (double)NAN, "");
    }
    lab_at_most(experiment, "membrane energy, with E_S / pressure alone", shapes[1].energy / shapes[0].energy, 0.5,
                B_PAPER ", section 1; 0.5 is ours");
    lab_begin_claim(experiment, LAB_PAPER, "bending energy keeps the surface smooth", NULL);
    lab_at_most(experiment, "roughness of the mean curvature, with E_B / without",
                shapes[2].roughness / shapes[1].roughness, 0.9, B_PAPER ", section 6; 0.9 is ours");
    lab_begin_claim(experiment, LAB_PAPER, "fibres make the rounded part cave in further", NULL);
    lab_at_least(experiment, "depth of the cap, with E_A / without", shapes[3].cap_depth / shapes[2].cap_depth, 1.2,
                 B_PAPER ", section 6; 1.2 is ours");
    b_begin_contact_claim(experiment, NULL);
    b_judge_contacts(experiment, 0, "with contact", contacts);
}

static pel_status run_figure_1(lab_experiment *experiment)
{
    char fibres[B_FIBRES_SIZE], names[STAGES][64];
    const char *cap = experiment->bodies[0].cap;
    b_shrunk shapes[STAGES] = {{0}};
    b_contacts contacts = {0};
    b_fibres(experiment, 0, "arap", fibres);
    const char *settings[STAGES][5] = {
        /* nothing holds: springs that are as good as none */
        {"bodies.0.membrane=", "bodies.0.bending=", "bodies.0.springs={ stiffness: 1.0e-9, damping: 0 }",
         "contact.self=false", "solver={ method: explicit, dt: 0.0166666667 }"},
        {"bodies.0.bending.weight=0", "contact.self=false"},
        {"contact.self=false"},
        {fibres, cap, "contact.self=false"},
        {fibres, cap},
    };
    pel_status status = PEL_OK;
    for (int i = 0; status == PEL_OK && i < STAGES; i++) {
        const char *overrides[7] = {"stop.frames=60"};
        pel_run_summary summary = {0};
        memcpy(overrides + 1, settings[i], sizeof settings[i]);
        status = b_shrink(experiment, 0, stages[i], overrides, &summary);
        b_run_name(experiment, 0, stages[i], names[i]);
        if (status == PEL_OK)
            status = b_measure(experiment, 0, names[i], 60, &shapes[i]);
        if (status == PEL_OK && i == STAGES - 1)
            status = b_add_contacts(experiment, 0, stages[i], &summary, &contacts);
    }
    if (status != PEL_OK)
        return status;
    judge_stages(experiment, shapes, &contacts);
    b_begin_bound_claim(experiment);
    status = b_judge_bound(experiment, 0, stages[STAGES - 1]);
    if (status != PEL_OK)
        return status;
    lab_picture picture = {.caption = "frame 60 with pressure alone, and E_S, E_B, E_A and contact added one by one",
                           .run_count = STAGES,
                           .frames = {60},
                           .frame_count = 1,
                           .columns = 5,
                           .field = "none",
                           .azimuth = 35,
                           .elevation = 20};
    for (int i = 0; i < STAGES; i++) {
        static const char *const labels[STAGES] = {"pressure alone", "E_S", "+ E_B", "+ E_A", "+ contact"};
        picture.runs[i] = names[i];
        picture.labels[i] = labels[i];
    }
    return lab_add_picture(experiment, &picture);
}

const lab_case b_figure_1 = {
    .name = "b-figure1",
    .doc = "the pipeline: prediction, stretch, bending, fibres and contact one by one",
    .group = "paper B",
    .place = "section 1, figure 1",
    .run = run_figure_1,
};

/* ---- figure 2 ---- */

/* largest difference of the force from -P n times a third of the triangles' area, over the largest force, and the
   largest difference of cos alpha from -n_z */
static pel_status check_pressure(const pel_mesh *mesh, double pressure, double off[2], pel_error *error)
{
    const pel_field *field = pel_mesh_field(mesh, "pressure");
    pel_topology *topology;
    off[0] = off[1] = (double)NAN;
    if (field == NULL)
        return pel_fail(error, PEL_BAD_FORMAT, "the frame has no field 'pressure'");
    pel_status status = pel_topology_create(mesh, &topology, error);
    if (status != PEL_OK)
        return status;
    double *areas = calloc((size_t)mesh->vertex_count, 4 * sizeof *areas), *normals = areas + mesh->vertex_count;
    if (areas == NULL) {
        pel_topology_destroy(topology);
        return pel_fail_memory(error);
    }
    for (int32_t t = 0; t < mesh->triangle_count; t++) {
        double area = 0;
        const double *x[3];
        for (int k = 0; k < 3; k++)
            x[k] = mesh->positions[mesh->triangles[t][k]];
        for (int i = 0; i < 3; i++) {
            int j = (i + 1) % 3, k = (i + 2) % 3;
            area += pow((x[1][j] - x[0][j]) * (x[2][k] - x[0][k]) - (x[1][k] - x[0][k]) * (x[2][j] - x[0][j]), 2);
        }
        for (int k = 0; k < 3; k++)
            areas[mesh->triangles[t][k]] += sqrt(area) / 6;
    }
    pel_surface_normals(topology, mesh->positions[0], PEL_NORMAL_AREA, normals);
    double largest = 0, force_off = 0, angle_off = 0;
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        double square = 0, length = 0;
        for (int i = 0; i < 3; i++) {
            double force = field->values[3 * v + i];
            square += pow(force + pressure * areas[v] * normals[3 * v + i], 2);
            length += force * force;
        }
        largest = fmax(largest, sqrt(length));
        force_off = fmax(force_off, sqrt(square));
        angle_off = fmax(angle_off, fabs(field->values[3 * v + 2] / sqrt(length) + normals[3 * v + 2]));
    }
    off[0] = force_off / largest;
    off[1] = angle_off;
    free(areas);
    pel_topology_destroy(topology);
    return PEL_OK;
}

/* the surface with cos alpha as the paper draws it, that of the force and the vertical, as folder/BODY-angle.ply */
static pel_status write_angle(const lab_experiment *experiment, pel_mesh *mesh, const char *name)
{
    char path[LAB_PATH_SIZE];
    const pel_field *force = pel_mesh_field(mesh, "pressure");
    double *cosine = calloc((size_t)mesh->vertex_count, sizeof *cosine);
    if (cosine == NULL)
        return pel_fail_memory(experiment->error);
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        const double *f = force->values + 3 * (size_t)v;
        cosine[v] = f[2] / sqrt(f[0] * f[0] + f[1] * f[1] + f[2] * f[2]);
    }
    pel_status status = pel_mesh_add_field(mesh, "cos_alpha", 1, cosine, experiment->error);
    if (status == PEL_OK)
        status = pel_mesh_write(lab_path(experiment, name, path), PEL_FORMAT_AUTO, mesh, NULL, experiment->error);
    free(cosine);
    return status;
}

static pel_status run_figure_2(lab_experiment *experiment)
{
    static char angles[B_SHOWN][64];
    double off[B_SHOWN][2];
    pel_status status = PEL_OK;
    lab_picture force = {.caption = "force of the pressure on the vertices at rest",
                         .run_count = b_shown(experiment),
                         .frames = {0},
                         .frame_count = 1,
                         .columns = b_shown(experiment),
                         .field = "pressure",
                         .unit = "N",
                         .azimuth = 35,
                         .elevation = 20};
    static char names[B_SHOWN][64];
    for (int body = 0; status == PEL_OK && body < b_shown(experiment); body++) {
        const char *settings[] = {"bodies.0.pressure.form=vertex-normal", "stop.frames=1",
                                  "output.fields=[pressure, normal]", "output.precision=double", NULL};
        pel_run_summary summary;
        pel_mesh *mesh = NULL;
        status = b_shrink(experiment, body, "rest", settings, &summary);
        force.runs[body] = b_run_name(experiment, body, "rest", names[body]);
        if (status == PEL_OK)
            status = b_read_frame(experiment, names[body], 0, &mesh);
        if (status == PEL_OK)
            status = check_pressure(mesh, experiment->bodies[body].pressure, off[body], experiment->error);
        snprintf(angles[body], sizeof angles[body], "%s-angle.ply", experiment->bodies[body].name);
        if (status == PEL_OK)
            status = write_angle(experiment, mesh, angles[body]);
        pel_mesh_destroy(mesh);
        force.labels[body] = experiment->bodies[body].name;
    }
    if (status != PEL_OK)
        return status;
    lab_begin_claim(experiment, LAB_PAPER, "the force on a vertex is -P n times a third of its triangles' area", NULL);
    for (int body = 0; body < b_shown(experiment); body++)
        b_expect(experiment, body, "error of the force / largest force", off[body][0], 0, 1e-6,
                 B_PAPER ", equation of section 2");
    lab_begin_claim(experiment, LAB_PAPER, "cos alpha is that of the inward normal with the vertical", NULL);
    for (int body = 0; body < b_shown(experiment); body++)
        b_expect(experiment, body, "error of cos alpha", off[body][1], 0, 1e-6, B_PAPER ", figure 2");
    status = lab_add_picture(experiment, &force);
    lab_picture angle = force;
    angle.caption = "cos alpha: red where the pressure acts upward, blue where it acts downward";
    angle.field = "cos_alpha";
    angle.unit = "";
    angle.range[0] = -1;
    angle.range[1] = 1;
    for (int body = 0; body < b_shown(experiment); body++)
        angle.runs[body] = angles[body];
    return status == PEL_OK ? lab_add_picture(experiment, &angle) : status;
}

const lab_case b_figure_2 = {
    .name = "b-figure2",
    .doc = "pressure on the bodies at rest: its size and its direction",
    .group = "paper B",
    .place = "section 2, figure 2",
    .run = run_figure_2,
};

/* ---- figures 5 and 9 ---- */

/* bodies that shrink for 200 frames, and how they are in frame 100 */
static pel_status run_sequence(lab_experiment *experiment, const char *what, bool fibres, b_shrunk shapes[B_SHOWN],
                               pel_run_summary summaries[B_SHOWN])
{
    pel_status status = PEL_OK;
    for (int body = 0; status == PEL_OK && body < b_shown(experiment); body++) {
        char energy[B_FIBRES_SIZE], name[64];
        const char *settings[] = {"stop.frames=200", fibres ? b_fibres(experiment, body, "arap", energy) : NULL,
                                  experiment->bodies[body].cap, NULL};
        status = b_shrink(experiment, body, what, settings, &summaries[body]);
        if (status == PEL_OK)
            status = b_measure(experiment, body, b_run_name(experiment, body, what, name), 100, &shapes[body]);
    }
    return status;
}

/* of the runs "BODY-WHAT" */
static pel_status claim_contact(lab_experiment *experiment, const char *what, const pel_run_summary *summaries,
                                int count)
{
    pel_status status = PEL_OK;
    b_begin_contact_claim(experiment, NULL);
    for (int body = 0; status == PEL_OK && body < count; body++) {
        b_contacts contacts = {0};
        status = b_add_contacts(experiment, body, what, &summaries[body], &contacts);
        b_judge_contacts(experiment, body, "to the end", &contacts);
    }
    return status;
}

static pel_status claim_bound(lab_experiment *experiment, int count)
{
    pel_status status = PEL_OK;
    b_begin_bound_claim(experiment);
    for (int body = 0; status == PEL_OK && body < count; body++)
        status = b_judge_bound(experiment, body, fibred);
    return status;
}

static pel_status draw_sequence(lab_experiment *experiment, const char *caption, const char *what)
{
    static const int frames[] = {0, 50, 100, 150, -1};
    return b_draw_bodies(experiment, caption, what, frames, 5);
}

static pel_status run_figure_5(lab_experiment *experiment)
{
    b_shrunk shapes[B_SHOWN];
    pel_run_summary summaries[B_SHOWN];
    double changes[B_SHOWN] = {0};
    pel_status status = run_sequence(experiment, isotropic, false, shapes, summaries);
    for (int body = 0; status == PEL_OK && body < b_shown(experiment); body++) {
        char name[64];
        status = b_cap_change(experiment, body, b_run_name(experiment, body, isotropic, name), 100, &changes[body]);
    }
    if (status != PEL_OK)
        return status;
    lab_begin_claim(experiment, LAB_PAPER,
                    "sphere-like parts stay stable under isotropic energies: they change less than other parts",
                    "six of ten parts of this size on the animal are narrow (legs, ears, neck) and hardly change; "
                    "among the others its roundest one, the rump, changes as they do (1.02)");
    for (int body = 0; body < b_shown(experiment); body++) {
        b_at_most(experiment, body, "change of the cap / of parts of its size, frame 100", changes[body], 0.8,
                  B_PAPER ", figure 5; 0.8 is ours");
        b_tell(experiment, body, "displacement of the cap / of the body", shapes[body].cap_way / shapes[body].body_way,
               (double)NAN, "");
        b_tell(experiment, body, "depth of the cap [m]", shapes[body].cap_depth, (double)NAN, "");
    }
    status = claim_contact(experiment, isotropic, summaries, b_shown(experiment));
    return status != PEL_OK
               ? status
               : draw_sequence(experiment, "E_S and E_B alone: frames 0, 50, 100, 150 and 200, or the last", isotropic);
}

const lab_case b_figure_5 = {
    .name = "b-figure5",
    .doc = "bodies that shrink under stretch and bending energy, 200 frames",
    .group = "paper B",
    .place = "section 3, figure 5",
    .run = run_figure_5,
};

static pel_status run_figure_9(lab_experiment *experiment)
{
    b_shrunk plain[B_SHOWN], shapes[B_SHOWN];
    pel_run_summary summaries[B_SHOWN];
    pel_status status = run_sequence(experiment, isotropic, false, plain, summaries);
    if (status == PEL_OK)
        status = run_sequence(experiment, fibred, true, shapes, summaries);
    if (status != PEL_OK)
        return status;
    lab_begin_claim(experiment, LAB_PAPER, "with fibres the sphere-like parts cave in quickly and clearly", NULL);
    for (int body = 0; body < b_shown(experiment); body++) {
        b_at_least(experiment, body, "depth of the cap, frame 100, minus that without fibres [m]",
                   shapes[body].cap_depth - plain[body].cap_depth, 0.02, B_PAPER ", figure 9");
        b_tell(experiment, body, "depth of the cap [m]", shapes[body].cap_depth, plain[body].cap_depth,
               "without fibres");
    }
    status = claim_contact(experiment, fibred, summaries, b_shown(experiment));
    if (status == PEL_OK)
        status = claim_bound(experiment, b_shown(experiment));
    return status != PEL_OK ? status
                            : draw_sequence(experiment,
                                            "with fibres at the roundest part: frames 0, 50, 100, 150 and 200, or the "
                                            "last",
                                            fibred);
}

const lab_case b_figure_9 = {
    .name = "b-figure9",
    .doc = "bodies that shrink with fibres at their roundest part, 200 frames",
    .group = "paper B",
    .place = "section 6, figure 9",
    .run = run_figure_9,
};

/* ---- figure 8 ---- */

enum { WAYS = 4, STRETCH = 0, STIFF = 1, SOFT = 2, FIBRES = 3 };

static const char *const way_names[WAYS] = {"stretch", "bending-1", "bending-0.01", "fibres"};

static pel_status draw_figure_8(lab_experiment *experiment, char names[WAYS][64])
{
    static const char *const captions[3] = {"frame 100: E_S, E_S + E_B (k_B 1), E_S + E_B (k_B 0.01), all with E_A",
                                            "the same, mean curvature", "the same, membrane energy per area"};
    static const char *const fields[3] = {"none", "mean_curvature", "membrane_energy_density"};
    pel_status status = PEL_OK;
    for (int i = 0; status == PEL_OK && i < 3; i++) {
        lab_picture picture = {.caption = captions[i],
                               .labels = {"E_S", "k_B 1", "k_B 0.01", "with E_A"},
                               .run_count = WAYS,
                               .frames = {100},
                               .frame_count = 1,
                               .columns = WAYS,
                               .field = fields[i],
                               .azimuth = 35,
                               .elevation = 20};
        if (i == 1) {
            picture.range[0] = -15;
            picture.range[1] = 15;
        }
        if (i == 2)
            picture.range[1] = 0.3;
        for (int k = 0; k < WAYS; k++)
            picture.runs[k] = names[k];
        status = lab_add_picture(experiment, &picture);
    }
    return status;
}

/* E_B with the curvature at rest taken away: the energy of the initial state is 0 */
static pel_status judge_return(lab_experiment *experiment)
{
    double volumes[B_SHOWN] = {0};
    pel_status status = PEL_OK;
    for (int body = 0; status == PEL_OK && body < b_shown(experiment); body++) {
        char name[64];
        int rises;
        pel_run_summary summary;
        const char *settings[] = {"bodies.0.bending.weight=1", "bodies.0.bending.model=isometric-rest", NULL};
        status = b_shrink(experiment, body, "rest-1", settings, &summary);
        if (status == PEL_OK)
            status = b_volume(experiment, b_run_name(experiment, body, "rest-1", name), 100, &volumes[body], &rises);
    }
    lab_begin_claim(experiment, LAB_PAPER, "E_B drives the body to its initial state", NULL);
    for (int body = 0; status == PEL_OK && body < b_shown(experiment); body++)
        b_expect(experiment, body, "volume in frame 100, isometric-rest, k_B 1", volumes[body], 1, 0.04,
                 B_PAPER ", section 2; 0.04 is ours");
    return status;
}

static pel_status run_figure_8(lab_experiment *experiment)
{
    char names[WAYS][64], energy[B_FIBRES_SIZE];
    b_shrunk shapes[WAYS] = {{0}};
    double volumes[WAYS] = {0};
    static const char fields[] = "output.fields=[displacement, mean_curvature, membrane_energy_density]";
    b_fibres(experiment, 0, "arap", energy);
    const char *settings[WAYS][4] = {{"bodies.0.bending.weight=0", fields},
                                     {"bodies.0.bending.weight=1", fields},
                                     {fields},
                                     {energy, experiment->bodies[0].cap, fields}};
    pel_status status = PEL_OK;
    for (int i = 0; status == PEL_OK && i < WAYS; i++) {
        pel_run_summary summary;
        int rises;
        status = b_shrink(experiment, 0, way_names[i], settings[i], &summary);
        b_run_name(experiment, 0, way_names[i], names[i]);
        if (status == PEL_OK)
            status = b_volume(experiment, names[i], 100, &volumes[i], &rises);
        if (status == PEL_OK)
            status = b_measure(experiment, 0, names[i], 100, &shapes[i]);
    }
    if (status != PEL_OK)
        return status;
    lab_begin_claim(experiment, LAB_PAPER, "with k_B 1 the body does not visibly shrink", NULL);
    lab_expect(experiment, "volume in frame 100, k_B 1", volumes[STIFF], 1, 0.1, B_PAPER ", figure 8");
    lab_begin_claim(experiment, LAB_PAPER, "with k_B 0.01 it shrinks", NULL);
    lab_at_most(experiment, "volume in frame 100, k_B 0.01", volumes[SOFT], 0.85, B_PAPER ", figure 8");
    lab_begin_claim(experiment, LAB_PAPER, "without E_B the surface is rougher and partly overstretched", NULL);
    lab_at_most(experiment, "roughness of the mean curvature, k_B 0.01 / without E_B",
                shapes[SOFT].roughness / shapes[STRETCH].roughness, 0.9, B_PAPER ", figure 8; 0.9 is ours");
    lab_at_most(experiment, "membrane energy, k_B 0.01 / without E_B", shapes[SOFT].energy / shapes[STRETCH].energy,
                0.9, B_PAPER ", figure 8; 0.9 is ours");
    lab_begin_claim(experiment, LAB_PAPER, "with E_A the roundest part caves in and its curvature vanishes", NULL);
    lab_at_least(experiment, "depth of the cap minus that without E_A [m]",
                 shapes[FIBRES].cap_depth - shapes[SOFT].cap_depth, 0.02, B_PAPER ", figure 8");
    lab_at_most(experiment, "mean curvature of the cap minus that without E_A [1/m]",
                shapes[FIBRES].cap_curvature - shapes[SOFT].cap_curvature, -0.2, B_PAPER ", figure 8; 0.2 is ours");
    b_begin_bound_claim(experiment);
    status = b_judge_bound(experiment, 0, way_names[FIBRES]);
    if (status == PEL_OK)
        status = judge_return(experiment);
    return status == PEL_OK ? draw_figure_8(experiment, names) : status;
}

const lab_case b_figure_8 = {
    .name = "b-figure8",
    .doc = "energies one by one: shape, mean curvature and energy in frame 100",
    .group = "paper B",
    .place = "section 6, figure 8",
    .run = run_figure_8,
};

/* ---- figure 10 ---- */

static pel_status draw_figure_10(lab_experiment *experiment, char names[LAB_BODIES][64])
{
    static const struct {
        const char *field, *caption;
        double range;
    } maps[4] = {{"pressure", "pressure on the vertices, at rest and at the end", 0},
                 {"none", "shape, at rest and at the end", 0},
                 {"mean_curvature", "mean curvature, at rest and at the end", 15},
                 {"gaussian_curvature", "Gaussian curvature, at rest and at the end", 60}};
    pel_status status = PEL_OK;
    for (int i = 0; status == PEL_OK && i < 4; i++) {
        lab_picture picture = {.caption = maps[i].caption,
                               .run_count = experiment->body_count,
                               .frames = {0, -1},
                               .frame_count = 2,
                               .field = maps[i].field,
                               .unit = i == 0 ? "N" : NULL,
                               .range = {-maps[i].range, maps[i].range},
                               .azimuth = 35,
                               .elevation = 20};
        for (int body = 0; body < experiment->body_count; body++) {
            picture.runs[body] = names[body];
            picture.labels[body] = experiment->bodies[body].name;
        }
        status = lab_add_picture(experiment, &picture);
    }
    return status;
}

/* the integral of the Gaussian curvature over the surface at the end of a run, by the fields of its last frame, less
   that of Gauss and Bonnet, over 4 pi; a closed surface has 3/2 edges a triangle */
static pel_status curvature_error(const lab_experiment *experiment, const char *run, double *error)
{
    pel_mesh *mesh;
    pel_status status = b_read_frame(experiment, run, -1, &mesh);
    if (status != PEL_OK)
        return status;
    const double pi = acos(-1.0);
    *error = (0.5 * mesh->triangle_count - mesh->vertex_count) / 2;
    const pel_field *curvature = pel_mesh_field(mesh, "gaussian_curvature"), *area = pel_mesh_field(mesh, "area");
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        *error += curvature->values[v] * area->values[v] / (4 * pi);
    pel_mesh_destroy(mesh);
    return PEL_OK;
}

static pel_status judge_curvature(lab_experiment *experiment, char names[LAB_BODIES][64])
{
    pel_status status = PEL_OK;
    lab_begin_claim(experiment, LAB_THEORY, "the Gaussian curvature of a closed body adds up to 4 pi, less for handles",
                    NULL);
    for (int body = 0; status == PEL_OK && body < experiment->body_count; body++) {
        double error = (double)NAN;
        status = curvature_error(experiment, names[body], &error);
        b_expect(experiment, body, "error of the integral of the Gaussian curvature / 4 pi", error, 0, 1e-3,
                 "Gauss and Bonnet");
    }
    return status;
}

static pel_status run_figure_10(lab_experiment *experiment)
{
    static char names[LAB_BODIES][64];
    b_shrunk rest[LAB_BODIES], shapes[LAB_BODIES];
    pel_run_summary summaries[LAB_BODIES];
    pel_status status = PEL_OK;
    for (int body = 0; status == PEL_OK && body < experiment->body_count; body++) {
        char energy[B_FIBRES_SIZE];
        const char *settings[] = {b_fibres(experiment, body, "arap", energy), experiment->bodies[body].cap,
                                  "output.fields=[displacement, pressure, area, mean_curvature, gaussian_curvature]",
                                  NULL};
        status = b_shrink(experiment, body, fibred, settings, &summaries[body]);
        b_run_name(experiment, body, fibred, names[body]);
        if (status == PEL_OK)
            status = b_measure(experiment, body, names[body], 0, &rest[body]);
        if (status == PEL_OK)
            status = b_measure(experiment, body, names[body], -1, &shapes[body]);
    }
    if (status != PEL_OK)
        return status;
    lab_begin_claim(experiment, LAB_PAPER, "the curvature of sphere-like parts decreases: they cave in", NULL);
    for (int body = 0; body < experiment->body_count; body++) {
        b_at_most(experiment, body, "mean curvature of the cap / at rest",
                  shapes[body].cap_curvature / rest[body].cap_curvature, 0.9, B_PAPER ", figure 10; 0.9 is ours");
        b_tell(experiment, body, "volume in frame 100", summaries[body].volume_ratio_final, (double)NAN, "");
    }
    status = claim_contact(experiment, fibred, summaries, experiment->body_count);
    if (status == PEL_OK)
        status = claim_bound(experiment, experiment->body_count);
    if (status == PEL_OK)
        status = judge_curvature(experiment, names);
    return status == PEL_OK ? draw_figure_10(experiment, names) : status;
}

const lab_case b_figure_10 = {
    .name = "b-figure10",
    .doc = "several bodies with their pressure and curvatures, before and after",
    .group = "paper B",
    .place = "section 6, figure 10",
    .run = run_figure_10,
};
