/* Figure 6 of paper B: a ball with fibres at its pole. And whether the number of sweeps changes how far they cave in
   beyond what it changes of E_S and E_B: where pushes are small, the depth that they add is the compliance of the cap,
   measured with a load, times the energy E_A that the pressure leaves in the fibres. */
#include "papers/b/shrink.h"

#include <pellicle/mesh_io.h>

#include <math.h>
#include <stdlib.h>

/* frame whose gradients are drawn, and frame after it in which the motion that the fibres added is compared with them
 */
enum { DRAWN = 4, MOVED = 6, CAVED = 40 };

/* E_A over k_A of a triangle with a fibre towards the pole, area k / 2 (|F a| - 1)^2 where it is shorter than at rest,
   and the unit normal of the triangle; 0 outside of the cap. k is 1000 N/m, as in the scene. */
static double fibre_energy(const lab_body *ball, const pel_mesh *rest, const pel_mesh *mesh, int32_t t,
                           double normal[3])
{
    double a[2][3], b[2][3], to[3], area = 0, size = 0, g[3] = {0}, f[2] = {0}, cross[3], square = 0;
    const int32_t *corners = rest->triangles[t];
    for (int i = 0; i < 3; i++) {
        a[0][i] = rest->positions[corners[1]][i] - rest->positions[corners[0]][i];
        b[0][i] = rest->positions[corners[2]][i] - rest->positions[corners[0]][i];
        a[1][i] = mesh->positions[corners[1]][i] - mesh->positions[corners[0]][i];
        b[1][i] = mesh->positions[corners[2]][i] - mesh->positions[corners[0]][i];
        to[i] = ball->cap_center[i];
        for (int k = 0; k < 3; k++)
            to[i] -= rest->positions[corners[k]][i] / 3;
        g[0] += a[0][i] * a[0][i];
        g[1] += a[0][i] * b[0][i];
        g[2] += b[0][i] * b[0][i];
        f[0] += a[0][i] * to[i];
        f[1] += b[0][i] * to[i];
        square += to[i] * to[i];
    }
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        cross[i] = a[1][j] * b[1][k] - a[1][k] * b[1][j];
        size += cross[i] * cross[i];
    }
    for (int i = 0; i < 3; i++)
        normal[i] = cross[i] / sqrt(size);
    if (square > ball->cap_radius * ball->cap_radius)
        return 0;
    /* the direction to the pole in the triangle, as u a + v b */
    double det = g[0] * g[2] - g[1] * g[1], u = (f[0] * g[2] - f[1] * g[1]) / det,
           v = (f[1] * g[0] - f[0] * g[1]) / det;
    double before = 0, now = 0;
    area = sqrt(det) / 2;
    for (int i = 0; i < 3; i++) {
        before += pow(u * a[0][i] + v * b[0][i], 2);
        now += pow(u * a[1][i] + v * b[1][i], 2);
    }
    return area * 500 * pow(fmin(sqrt(now / before) - 1, 0), 2);
}

/* The way of the vertices of a frame by one correction of E_A, E_A / (3 k_A) of each triangle along its inward normal:
   ways (vertex_count x 3) [m]. */
static void fibre_ways(const lab_body *ball, const pel_mesh *rest, const pel_mesh *mesh, double (*ways)[3])
{
    for (int32_t t = 0; t < mesh->triangle_count; t++) {
        double normal[3], way = fibre_energy(ball, rest, mesh, t, normal) / (3 * b_fibre_gradient(ball));
        for (int k = 0; k < 3; k++)
            for (int i = 0; i < 3; i++)
                ways[mesh->triangles[t][k]][i] -= way * normal[i];
    }
}

/* the cosine between these ways and the motion from one mesh to another, over all vertices */
static double alignment(const pel_mesh *from, const pel_mesh *to, double (*ways)[3])
{
    double along = 0, way = 0, motion = 0;
    for (int32_t v = 0; v < from->vertex_count; v++)
        for (int i = 0; i < 3; i++) {
            double moved = to->positions[v][i] - from->positions[v][i];
            along += ways[v][i] * moved;
            way += ways[v][i] * ways[v][i];
            motion += moved * moved;
        }
    return along / sqrt(way * motion);
}

/* writes the ball with its gradients, gradients.ply, and compares them with the motion that the fibres add */
static pel_status draw_gradients(lab_experiment *experiment, const lab_body *ball, double *cosine)
{
    enum { REST, AT, PLAIN, WITH, MESHES };
    static const char *const runs[MESHES] = {"ball-plain", "ball-fibres", "ball-plain", "ball-fibres"};
    static const int frames[MESHES] = {0, DRAWN, MOVED, MOVED};
    pel_mesh *meshes[MESHES] = {NULL};
    char path[LAB_PATH_SIZE];
    double(*ways)[3] = NULL;
    pel_status status = PEL_OK;
    for (int i = 0; status == PEL_OK && i < MESHES; i++)
        status = b_read_frame(experiment, runs[i], frames[i], &meshes[i]);
    if (status == PEL_OK && (ways = calloc((size_t)meshes[REST]->vertex_count, sizeof *ways)) == NULL)
        status = pel_fail_memory(experiment->error);
    if (status == PEL_OK) {
        fibre_ways(ball, meshes[REST], meshes[AT], ways);
        *cosine = alignment(meshes[PLAIN], meshes[WITH], ways);
        status = pel_mesh_add_field(meshes[AT], "way", 3, ways[0], experiment->error);
    }
    if (status == PEL_OK)
        status = pel_mesh_write(lab_path(experiment, "gradients.ply", path), PEL_FORMAT_AUTO, meshes[AT], NULL,
                                experiment->error);
    free(ways);
    for (int i = 0; i < MESHES; i++)
        pel_mesh_destroy(meshes[i]);
    return status;
}

static pel_status draw_figure_6(lab_experiment *experiment)
{
    const lab_picture arrows = {.caption = "the ways of the vertices along the gradient k_A n of E_A, frame 4",
                                .runs = {"gradients.ply"},
                                .labels = {"gradient of E_A"},
                                .run_count = 1,
                                .frames = {0},
                                .frame_count = 1,
                                .field = "way",
                                .unit = "m",
                                .arrows = "way",
                                .azimuth = 35,
                                .elevation = 45};
    const lab_picture picture = {.caption = "a ball without and with fibres at its pole: frames 0 and 40",
                                 .runs = {"ball-plain", "ball-fibres"},
                                 .labels = {"without", "with fibres"},
                                 .run_count = 2,
                                 .frames = {0, CAVED},
                                 .frame_count = 2,
                                 .azimuth = 35,
                                 .elevation = 45};
    pel_status status = lab_add_picture(experiment, &arrows);
    return status == PEL_OK ? lab_add_picture(experiment, &picture) : status;
}

/* ---- sweeps ---- */

/* of pbd, in a step; [PAPER] is the paper's number */
enum { COUNTS = 4, PAPER = 1, SAMPLES = 10 };
static const int counts[COUNTS] = {3, 5, 8, 12};

/* a load at the pole [N], and k_A over that of the figure: pushes so small that they change the strain little */
#define TEST_LOAD 0.5
#define WEAKER 50

typedef struct swept {
    double added;    /* depth of the cap that fibres add [m] */
    double expected; /* its compliance to the load times the mean over frames of the energy in its fibres [m J/N] */
} swept;

/* mean over frames of the energy in the fibres of a run */
static pel_status mean_energy(const lab_experiment *experiment, const char *run, double *mean)
{
    pel_mesh *rest = NULL;
    pel_status status = b_read_frame(experiment, run, 0, &rest);
    *mean = 0;
    for (int i = 1; status == PEL_OK && i <= SAMPLES; i++) {
        pel_mesh *mesh = NULL;
        double normal[3];
        status = b_read_frame(experiment, run, i * CAVED / SAMPLES, &mesh);
        for (int32_t t = 0; status == PEL_OK && t < mesh->triangle_count; t++)
            *mean += fibre_energy(experiment->bodies, rest, mesh, t, normal) / SAMPLES;
        pel_mesh_destroy(mesh);
    }
    pel_mesh_destroy(rest);
    return status;
}

static pel_status sweep(lab_experiment *experiment, int count, swept *made)
{
    enum { BARE, LOADED, PUSHED, RUNS };
    static const char *const names[RUNS] = {"bare", "loaded", "pushed"};
    char solver[40], extra[RUNS][B_FIBRES_SIZE] = {""}, run[64];
    double depths[RUNS] = {0}, energy = 0;
    pel_status status = PEL_OK;
    snprintf(solver, sizeof solver, "solver.iterations=%d", count);
    snprintf(extra[LOADED], sizeof extra[LOADED],
             "loads=[{ body: shell, force: [0, 0, %g], at: { nearest: [0, 0, 1], falloff: 0.5 } }]", -TEST_LOAD);
    snprintf(extra[PUSHED], sizeof extra[PUSHED], "bodies.0.anisotropy={ mode: normal, gradient: %g }",
             WEAKER * b_fibre_gradient(experiment->bodies));
    for (int i = 0; status == PEL_OK && i < RUNS; i++) {
        char what[32];
        const char *settings[7] = {solver,
                                   "stop.frames=40",
                                   "contact.self=false",
                                   "output.precision=double",
                                   i > BARE ? extra[i] : NULL,
                                   i == PUSHED ? experiment->bodies->cap : NULL,
                                   NULL};
        pel_run_summary summary;
        b_shrunk shape = {0};
        snprintf(what, sizeof what, "%s-%d", names[i], count);
        status = b_shrink(experiment, 0, what, settings, &summary);
        if (status == PEL_OK)
            status = b_measure(experiment, 0, b_run_name(experiment, 0, what, run), CAVED, &shape);
        depths[i] = shape.cap_depth;
        if (status == PEL_OK && i == BARE)
            status = mean_energy(experiment, run, &energy);
    }
    *made = (swept){depths[PUSHED] - depths[BARE], (depths[LOADED] - depths[BARE]) / TEST_LOAD * energy};
    return status;
}

static pel_status judge_sweeps(lab_experiment *experiment)
{
    swept made[COUNTS] = {{0}};
    pel_status status = PEL_OK;
    for (int i = 0; status == PEL_OK && i < COUNTS; i++)
        status = sweep(experiment, counts[i], &made[i]);
    lab_begin_claim(experiment, LAB_THEORY,
                    "sweeps change the depth that weak fibres add as they change what E_S and E_B resist: it is the "
                    "compliance of the cap times the energy left in the fibres",
                    NULL);
    for (int i = 0; status == PEL_OK && i < COUNTS; i++) {
        char name[96];
        if (i == PAPER)
            continue;
        snprintf(name, sizeof name, "depth added / compliance times energy, %d sweeps / 5 sweeps", counts[i]);
        lab_expect(experiment, name, made[i].added / made[i].expected / (made[PAPER].added / made[PAPER].expected), 1,
                   counts[i] < 10 ? 0.2 : 0.4, "one acceleration for any sweeps; the rest is motion");
        snprintf(name, sizeof name, "depth added, %d sweeps / 5 sweeps", counts[i]);
        lab_tell(experiment, name, made[i].added / made[PAPER].added, (double)NAN, "");
    }
    return status;
}

/* ---- figure 6 ---- */

/* a ball, for any choice of bodies */
static pel_status run_figure_6(lab_experiment *experiment)
{
    static char cap[] = "bodies.0.anisotropy.region={ sphere: { center: [0, 0, 1], radius: 0.5 } }";
    static const lab_body ball = {.name = "ball",
                                  .mesh = "bodies.0.mesh={ shape: geodesic-sphere, frequency: 12 }",
                                  .pressure = 10,
                                  .cap = cap,
                                  .cap_center = {0, 0, 1},
                                  .cap_radius = 0.5};
    const lab_body *bodies = experiment->bodies;
    experiment->bodies = &ball;
    char energy[B_FIBRES_SIZE];
    b_shrunk plain, caved;
    double cosine = (double)NAN;
    pel_run_summary summary;
    const char *without[] = {"stop.frames=40", NULL};
    const char *with[] = {b_fibres(experiment, 0, "arap", energy), cap, without[0], NULL};
    pel_status status = b_shrink(experiment, 0, "plain", without, &summary);
    if (status == PEL_OK)
        status = b_shrink(experiment, 0, "fibres", with, &summary);
    if (status == PEL_OK)
        status = b_measure(experiment, 0, "ball-plain", CAVED, &plain);
    if (status == PEL_OK)
        status = b_measure(experiment, 0, "ball-fibres", CAVED, &caved);
    experiment->bodies = bodies;
    if (status == PEL_OK)
        status = draw_gradients(experiment, &ball, &cosine);
    if (status != PEL_OK)
        return status;
    lab_begin_claim(experiment, LAB_PAPER, "the region with fibres and its surroundings cave in", NULL);
    lab_at_least(experiment, "depth of the cap, with fibres / without", caved.cap_depth / plain.cap_depth, 1.5,
                 B_PAPER ", figure 6");
    lab_at_most(experiment, "mean curvature of the cap, with fibres / without",
                caved.cap_curvature / plain.cap_curvature, 0.5, B_PAPER ", figure 6");
    lab_begin_claim(experiment, LAB_PAPER, "the gradients at the vertices point inward there, and the vertices follow",
                    NULL);
    lab_at_least(experiment, "cosine between the gradients and the motion that fibres add in two frames", cosine, 0.8,
                 B_PAPER ", section 3, figure 6; 0.8 is ours");
    experiment->bodies = &ball;
    b_begin_bound_claim(experiment);
    status = b_judge_bound(experiment, 0, "fibres");
    if (status == PEL_OK)
        status = judge_sweeps(experiment);
    experiment->bodies = bodies;
    return status == PEL_OK ? draw_figure_6(experiment) : status;
}

const lab_case b_figure_6 = {
    .name = "b-figure6",
    .doc = "a ball before and after fibres are added to a region",
    .group = "paper B",
    .place = "section 3, figure 6",
    .run = run_figure_6,
};
