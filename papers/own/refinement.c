/* Shells that refine where they bend or are strained, compared with coarse and fine ones, as paper B proposes. Two thin
   balls. One is pressed in at a spot and minimises its energy: its reference is the finest surface; measured are the
   dent, the volume and the smoothness of the curvature. The other shrinks as in paper B, whose method has no
   mesh-independent solution: measured is how fast the volume falls. */
#include "papers/own/cases.h"

#include <pellicle/measure.h>
#include <pellicle/mesh_io.h>
#include <pellicle/topology.h>

#include <math.h>
#include <stdlib.h>

static const char pressed[] = "version: 1\n"
                              "title: thin ball that is pressed in at a spot\n"
                              "bodies:\n"
                              "  - name: ball\n"
                              "    mesh: { shape: geodesic-sphere, frequency: 8 }\n"
                              "    membrane: { material: stvk, young: 1.0e6, poisson: 0.3, thickness: 0.02 }\n"
                              "    bending: { model: hinge }\n"
                              "    pinned: { box: { min: [-2, -2, -2], max: [2, 2, 0] } }\n"
                              "loads:\n"
                              "  - { force: [0, 0, -70], at: { nearest: [0, 0, 1], falloff: 0.3 },\n"
                              "      keys: [[0, 0], [1, 1]] }\n"
                              "solver: { method: descent, dt: 0.2, iterations: 400, threads: 1 }\n"
                              "duration: 2\n"
                              "output: { every: 2, fields: [mean_curvature] }\n";

static const char shrinking[] =
    "version: 1\n"
    "title: ball that shrinks as in paper B\n"
    "bodies:\n"
    "  - name: ball\n"
    "    mesh: { shape: geodesic-sphere, frequency: 8 }\n"
    "    mass: { density: 1000, thickness: 0.01 }\n"
    "    membrane: { material: stvk, young: 1.0e5 }\n"
    "    bending: { model: isometric, weight: 0.01 }\n"
    "    anisotropy: { energy: arap, strength: 0.3, region: { sphere: { center: [0, 0, 1], radius: 0.5 } } }\n"
    "    pressure: { outside: 10 }\n"
    "solver: { method: pbd, dt: 0.0166666667, iterations: 5, threads: 1 }\n"
    "stop: { frames: 25 }\n"
    "output: { every_frame: 1, fields: [mean_curvature] }\n";

static const char own[] = "our own computation";

/* radius about the pole, at rest, in which shapes are compared */
#define ZONE 0.6
/* radius of the column about the axis in which roughness is measured */
#define COLUMN 0.5

enum { BASE_VERTICES = 642 };

/* how a run ended, and its surface */
typedef struct outcome {
    double triangles, milliseconds, frames, volume;
    double roughness;                /* of the mean curvature, see below */
    double at[BASE_VERTICES][3];     /* the vertices of the base */
    double curvature[BASE_VERTICES]; /* mean curvature there [1/m] */
} outcome;

/* ---- measures ---- */

/* How rough the mean curvature is about the pole: its difference from the mean of the neighbours over that from a ball
   of radius 1, root mean squares by area. On a smooth surface it falls as meshes become finer; noise and folds at the
   edges of the mesh keep it near 1. */
static double roughness_of(const pel_mesh *mesh, const pel_topology *topology, const double *curvature)
{
    size_t count = (size_t)mesh->vertex_count;
    double *sums = calloc(3 * count, sizeof *sums), *ends = sums + count, *areas = ends + count;
    if (sums == NULL)
        return (double)NAN;
    double noise = 0, size = 0;
    pel_surface_vertex_areas(topology, mesh->positions[0], areas);
    for (int32_t t = 0; t < mesh->triangle_count; t++)
        for (int k = 0; k < 3; k++) {
            int32_t v = mesh->triangles[t][k], next = mesh->triangles[t][(k + 1) % 3];
            sums[v] += curvature[next];
            ends[v]++;
        }
    for (size_t v = 0; v < count; v++) {
        const double *x = mesh->positions[v];
        if (x[2] < 0 || x[0] * x[0] + x[1] * x[1] > COLUMN * COLUMN)
            continue;
        noise += areas[v] * pow(curvature[v] - sums[v] / ends[v], 2);
        size += areas[v] * pow(curvature[v] - 1, 2);
    }
    free(sums);
    return sqrt(noise / size);
}

static pel_status measure_surface(const pel_mesh *mesh, outcome *made, pel_error *error)
{
    pel_topology *topology;
    pel_status status = pel_topology_create(mesh, &topology, error);
    if (status != PEL_OK)
        return status;
    double *curvature = calloc((size_t)mesh->vertex_count, sizeof *curvature);
    if (curvature == NULL) {
        pel_topology_destroy(topology);
        return pel_fail_memory(error);
    }
    pel_surface_mean_curvature(topology, mesh->positions[0], curvature, NULL);
    made->roughness = roughness_of(mesh, topology, curvature);
    for (int v = 0; v < BASE_VERTICES; v++) {
        made->curvature[v] = curvature[v];
        for (int c = 0; c < 3; c++)
            made->at[v][c] = mesh->positions[v][c];
    }
    free(curvature);
    pel_topology_destroy(topology);
    return PEL_OK;
}

static pel_status solve(lab_experiment *experiment, const char *run, const char *scene, const char *setting,
                        outcome *made)
{
    pel_run_summary summary;
    pel_mesh *mesh;
    const char *overrides[] = {setting, NULL};
    pel_status status = lab_run(experiment, run, scene, overrides, &summary);
    if (status != PEL_OK)
        return status;
    made->triangles = (double)summary.triangles_final;
    made->frames = (double)summary.steps;
    made->milliseconds = 1e3 * (double)summary.steps / summary.steps_per_second;
    made->volume = summary.volume_ratio_final;
    status = lab_read_final(experiment, run, &mesh);
    if (status == PEL_OK)
        status = measure_surface(mesh, made, experiment->error);
    pel_mesh_destroy(mesh);
    return status;
}

/* the vertices of the base lie on the unit sphere at rest; where one lies is told by the unmoved surface */
static bool is_in_zone(const double rest[3])
{
    return rest[0] * rest[0] + rest[1] * rest[1] + (rest[2] - 1) * (rest[2] - 1) < ZONE * ZONE;
}

/* root mean square of the difference of shapes over that of the change, and the same of mean curvatures */
static void compare(const outcome *rest, const outcome *reference, const outcome *made, double *shape,
                    double *curvature)
{
    double way = 0, apart = 0, change = 0, difference = 0;
    for (int v = 0; v < BASE_VERTICES; v++) {
        if (!is_in_zone(rest->at[v]))
            continue;
        for (int c = 0; c < 3; c++) {
            way += pow(reference->at[v][c] - rest->at[v][c], 2);
            apart += pow(made->at[v][c] - reference->at[v][c], 2);
        }
        change += pow(reference->curvature[v] - 1, 2);
        difference += pow(made->curvature[v] - reference->curvature[v], 2);
    }
    *shape = sqrt(apart / way);
    *curvature = sqrt(difference / change);
}

static void tell(lab_experiment *experiment, const char *run, const char *what, double value, double expected,
                 const char *source)
{
    char name[64];
    snprintf(name, sizeof name, "%.31s: %.30s", run, what);
    lab_tell(experiment, name, value, expected, source);
}

/* ---- the ball that is pressed ---- */

enum { WAYS = 7, REFERENCE = WAYS - 1, GLOBAL = WAYS - 2, LOCAL = 4 };

typedef struct way {
    const char *run, *setting;
} way;

static const way pressed_ways[WAYS] = {
    {"pressed-base", "bodies.ball.refine="},
    {"pressed-curvature-1", "bodies.ball.refine={ levels: 1, curvature: { above: 0.15 }, interval: 1 }"},
    {"pressed-curvature-2", "bodies.ball.refine={ levels: 2, curvature: { above: 0.15 }, interval: 1 }"},
    {"pressed-force-1", "bodies.ball.refine={ levels: 1, above: 40, interval: 1 }"},
    {"pressed-force-2", "bodies.ball.refine={ levels: 2, above: 40, interval: 1 }"},
    {"pressed-global-1", "bodies.ball.refine={ levels: 1, everywhere: true }"},
    {"pressed-global-2", "bodies.ball.refine={ levels: 2, everywhere: true }"},
};

static pel_status plot_errors(lab_experiment *experiment, const outcome made[WAYS], const double errors[WAYS])
{
    double cost[3][3], error[3][3];
    static const int members[3][3] = {{0, 1, 2}, {0, 3, 4}, {0, 5, 5}};
    static const char *const names[3] = {"refined by curvature", "refined by force", "refined everywhere"};
    lab_plot plot = {.title = "ball pressed in at a spot: error of the dent against cost",
                     .x_name = "ms of ten minimisations",
                     .y_name = "error of the dent",
                     .log_x = true,
                     .log_y = true,
                     .curve_count = 3};
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++) {
            cost[i][k] = made[members[i][k]].milliseconds;
            error[i][k] = errors[members[i][k]];
        }
        plot.curves[i] = (lab_curve){names[i], cost[i], error[i], i < 2 ? 3 : 2, true};
    }
    return lab_add_plot(experiment, &plot);
}

static pel_status press(lab_experiment *experiment, outcome *rest, outcome made[WAYS])
{
    double shape[WAYS] = {0}, curvature[WAYS] = {0};
    pel_status status = PEL_OK;
    for (int i = 0; status == PEL_OK && i < WAYS; i++)
        status = solve(experiment, pressed_ways[i].run, pressed, pressed_ways[i].setting, &made[i]);
    for (int i = 0; status == PEL_OK && i < WAYS; i++) {
        const char *run = pressed_ways[i].run;
        compare(rest, &made[REFERENCE], &made[i], &shape[i], &curvature[i]);
        tell(experiment, run, "triangles", made[i].triangles, (double)NAN, "");
        tell(experiment, run, "ms", made[i].milliseconds, (double)NAN, "");
        tell(experiment, run, "volume lost, of the finest", (1 - made[i].volume) / (1 - made[REFERENCE].volume), 1, "");
        tell(experiment, run, "error of the dent", shape[i], 0, "two levels everywhere");
        tell(experiment, run, "error of the curvature", curvature[i], 0, "two levels everywhere");
        tell(experiment, run, "roughness of the curvature", made[i].roughness, (double)NAN, "");
    }
    if (status != PEL_OK)
        return status;
    const outcome *local = &made[LOCAL], *global = &made[GLOBAL];
    lab_at_most(experiment, "local / base: error of the dent", shape[LOCAL] / shape[0], 0.1, own);
    lab_at_most(experiment, "local / one level everywhere: triangles", local->triangles / global->triangles, 0.5, own);
    lab_at_most(experiment, "local / one level everywhere: error of the dent", shape[LOCAL] / shape[GLOBAL], 0.5, own);
    lab_at_most(experiment, "local / one level everywhere: roughness", local->roughness / global->roughness, 0.7, own);
    return plot_errors(experiment, made, shape);
}

/* ---- the ball that shrinks ---- */

enum { SHRINK_WAYS = 5, CAP_REFINED = 3 };

#define CAP "region: { sphere: { center: [0, 0, 1], radius: 0.6 } }"

/* the base, with the same cost as the cap refined: more sweeps, more frames */
static const way shrink_ways[SHRINK_WAYS] = {
    {"shrinking-base", "bodies.ball.refine="},
    {"shrinking-sweeps", "solver.iterations=8"},
    {"shrinking-frames", "stop.frames=38"},
    {"shrinking-cap", "bodies.ball.refine={ levels: 1, " CAP " }"},
    {"shrinking-global", "bodies.ball.refine={ levels: 1, everywhere: true }"},
};

static pel_status shrink(lab_experiment *experiment, outcome made[SHRINK_WAYS])
{
    pel_status status = PEL_OK;
    for (int i = 0; status == PEL_OK && i < SHRINK_WAYS; i++) {
        const char *run = shrink_ways[i].run;
        status = solve(experiment, run, shrinking, shrink_ways[i].setting, &made[i]);
        tell(experiment, run, "triangles", made[i].triangles, (double)NAN, "");
        tell(experiment, run, "volume at the end", made[i].volume, (double)NAN, "");
        tell(experiment, run, "frames", made[i].frames, (double)NAN, "");
        tell(experiment, run, "ms", made[i].milliseconds, (double)NAN, "");
        tell(experiment, run, "roughness of the curvature", made[i].roughness, (double)NAN, "");
    }
    if (status != PEL_OK)
        return status;
    const outcome *cap = &made[CAP_REFINED], *all = &made[CAP_REFINED + 1];
    for (int i = 0; i < CAP_REFINED; i++) {
        char name[64];
        snprintf(name, sizeof name, "cap / %s: roughness", shrink_ways[i].run);
        lab_at_most(experiment, name, cap->roughness / made[i].roughness, 1, own);
    }
    lab_begin_claim(experiment, LAB_PAPER, "future work of section 7: a refined mesh shrinks further, and is smoother",
                    NULL);
    lab_at_most(experiment, "refined everywhere / base: volume in frame 25", all->volume / made[0].volume, 0.99,
                "paper B, section 7; 0.99 is ours");
    lab_at_most(experiment, "refined everywhere / base: roughness", all->roughness / made[0].roughness, 1,
                "paper B, section 7");
    return PEL_OK;
}

static pel_status run_shell_refinement(lab_experiment *experiment)
{
    static outcome rest, pressed_made[WAYS], shrink_made[SHRINK_WAYS];
    pel_status status = solve(experiment, "rest", pressed, "loads=[]", &rest);
    if (status == PEL_OK)
        status = press(experiment, &rest, pressed_made);
    if (status == PEL_OK)
        status = shrink(experiment, shrink_made);
    const lab_picture picture = {
        .caption = "the balls in the end",
        .columns = 4,
        .runs = {"pressed-force-2", "shrinking-sweeps", "shrinking-cap", "shrinking-global"},
        .labels = {"pressed, refined by force", "shrinking, more sweeps", "cap refined", "refined everywhere"},
        .run_count = 4,
        .frames = {-1},
        .frame_count = 1,
        .azimuth = 35,
        .elevation = 40,
        .edges = true,
    };
    return status == PEL_OK ? lab_add_picture(experiment, &picture) : status;
}

const lab_case own_refinement = {
    .name = "b-refinement",
    .doc = "shells refined by curvature or strain, compared with coarse and fine ones",
    .group = "own",
    .origin = LAB_REGRESSION,
    .run = run_shell_refinement,
};
