/* The conclusion of paper B wishes for exaggerated deformations, which an algorithm by energies hardly gives. Here an
   animator pulls the tip of a body by a handle, a grasp that keys move, while the foot is pinned; the energies shape
   the rest, and a target volume keeps it filled. Or the animator gives the exaggerated shape, as the shape at rest: the
   energies themselves drive the body there. */
#include "papers/b/shrink.h"

#include <pellicle/mesh_io.h>

#include <math.h>
#include <stdlib.h>

/* s when the handle arrives, turns back, is home, and lets go there, at rest: let go as it came home, at 2 m/s, the
   part went on inward by a fifth of the way; size of the bodies, and radius of the handle [m] */
#define ARRIVES 1.0
#define LEAVES 1.25
#define COMES_HOME 2.25
#define LETS_GO 2.75
#define SIZE 2.0
#define HANDLE 0.2

/* frames: the handle is held, and the last one */
enum { HELD = 70, LAST = 220 };

/* of a target shape: how far the tip is drawn out, over the size of the body, and how far from it the body follows [m]
 */
#define DRAWN_OUT 0.15
#define AROUND 0.9

/* of the handle, over the size of the body */
static const double ways[] = {0.25, 1};
enum { WAYS = sizeof ways / sizeof *ways };

/* The tip of a body: the vertex farthest from its middle above its foot. */
typedef struct tip {
    double at[3], direction[3]; /* unit vector away from the middle */
    double foot;                /* height below which the body is pinned: a tenth of its own */
} tip;

typedef struct pulled {
    char names[WAYS][64];
    double reach[WAYS];   /* way of the tip along the pull over that of the handle, while it is held */
    double stretch[WAYS]; /* longest edge over its length at rest */
    double remains[WAYS]; /* way of the tip at the end over that of the handle */
    double volumes[WAYS]; /* over that at rest, at the end */
    b_contacts contacts;
    double crossed; /* pairs of triangles that intersect when it is drawn to the target shape */
    double target;  /* root mean square of the distance from the target shape, over that between the shapes */
    double drawn;   /* longest edge of the target shape over its length in the body */
} pulled;

static void find_tip(const pel_mesh *rest, tip *found)
{
    double low[3], high[3], farthest = 0;
    int32_t chosen = 0;
    pel_mesh_box(rest, low, high);
    found->foot = low[2] + 0.1 * (high[2] - low[2]);
    for (int32_t v = 0; v < rest->vertex_count; v++) {
        double square = 0;
        for (int i = 0; i < 3; i++)
            square += pow(rest->positions[v][i] - 0.5 * (low[i] + high[i]), 2);
        if (square <= farthest || rest->positions[v][2] < found->foot + 2 * HANDLE)
            continue;
        farthest = square;
        chosen = v;
    }
    for (int i = 0; i < 3; i++) {
        found->at[i] = rest->positions[chosen][i];
        found->direction[i] = (found->at[i] - 0.5 * (low[i] + high[i])) / sqrt(farthest);
    }
}

static void write_handle(const tip *at, double way, char *text, size_t size)
{
    double to[3];
    for (int i = 0; i < 3; i++)
        to[i] = at->at[i] + way * SIZE * at->direction[i];
    const double *from = at->at;
    snprintf(text, size,
             "tools=[{ name: handle, shape: sphere, radius: %g, press: false, max_force: 1e9, grasp: { until: %g, "
             "reach: 0.01 }, motion: [{ position: [%.9g, %.9g, %.9g] }, { time: %g, position: [%.9g, %.9g, %.9g] }, "
             "{ time: %g, position: [%.9g, %.9g, %.9g] }, { time: %g, position: [%.9g, %.9g, %.9g] }] }]",
             HANDLE, LETS_GO, from[0], from[1], from[2], ARRIVES, to[0], to[1], to[2], LEAVES, to[0], to[1], to[2],
             COMES_HOME, from[0], from[1], from[2]);
}

/* the setting that pins the foot */
static void write_foot(const tip *at, char *text, size_t size)
{
    snprintf(text, size, "bodies.0.pinned={ box: { min: [-9, -9, -9], max: [9, 9, %.6g] } }", at->foot);
}

/* mean way of the vertices in the handle along the pull, in a frame, over the way of the handle */
static pel_status way_of_tip(const lab_experiment *experiment, const tip *at, const char *run, int frame, double way,
                             double *share)
{
    pel_mesh *rest = NULL, *mesh = NULL;
    double sum = 0;
    int count = 0;
    pel_status status = b_read_frame(experiment, run, 0, &rest);
    if (status == PEL_OK)
        status = b_read_frame(experiment, run, frame, &mesh);
    for (int32_t v = 0; status == PEL_OK && v < rest->vertex_count; v++) {
        double square = 0, along = 0;
        for (int i = 0; i < 3; i++) {
            square += pow(rest->positions[v][i] - at->at[i], 2);
            along += at->direction[i] * (mesh->positions[v][i] - rest->positions[v][i]);
        }
        if (square < HANDLE * HANDLE) {
            sum += along;
            count++;
        }
    }
    *share = sum / count / (way * SIZE);
    pel_mesh_destroy(rest);
    pel_mesh_destroy(mesh);
    return status;
}

static pel_status find_rest(lab_experiment *experiment, int body, tip *at)
{
    const char *settings[] = {"stop.frames=1", NULL};
    char run[64];
    pel_run_summary summary;
    pel_mesh *rest = NULL;
    pel_status status = b_shrink(experiment, body, "rest", settings, &summary);
    if (status == PEL_OK)
        status = b_read_frame(experiment, b_run_name(experiment, body, "rest", run), 0, &rest);
    if (status == PEL_OK)
        find_tip(rest, at);
    pel_mesh_destroy(rest);
    return status;
}

static pel_status pull(lab_experiment *experiment, int body, pulled *made)
{
    tip at = {.foot = 0};
    pel_status status = find_rest(experiment, body, &at);
    for (int i = 0; status == PEL_OK && i < WAYS; i++) {
        char handle[500], foot[120], what[32];
        pel_run_summary summary = {0};
        b_shrunk shape = {0};
        write_handle(&at, ways[i], handle, sizeof handle);
        write_foot(&at, foot, sizeof foot);
        snprintf(what, sizeof what, "pulled-%g", ways[i]);
        const char *settings[] = {handle,
                                  foot,
                                  "bodies.0.bending.model=isometric-rest",
                                  "bodies.0.pressure={ volume: { target: 1, bulk: 500 } }",
                                  "solver.drag=2",
                                  "stop.frames=220",
                                  NULL};
        status = b_shrink(experiment, body, what, settings, &summary);
        b_run_name(experiment, body, what, made->names[i]);
        if (status == PEL_OK)
            status = way_of_tip(experiment, &at, made->names[i], HELD, ways[i], &made->reach[i]);
        if (status == PEL_OK)
            status = way_of_tip(experiment, &at, made->names[i], LAST, ways[i], &made->remains[i]);
        if (status == PEL_OK)
            status = b_measure(experiment, body, made->names[i], HELD, &shape);
        made->stretch[i] = shape.most_stretch;
        made->volumes[i] = summary.volume_ratio_final;
        if (status == PEL_OK)
            status = b_add_contacts(experiment, body, what, &summary, &made->contacts);
    }
    return status;
}

/* the body with its tip drawn out, as folder/NAME */
static pel_status write_target(const lab_experiment *experiment, const tip *at, const char *name, pel_mesh *mesh)
{
    char path[LAB_PATH_SIZE];
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        double square = 0;
        for (int i = 0; i < 3; i++)
            square += pow(mesh->positions[v][i] - at->at[i], 2);
        double part = fmax(1 - square / (AROUND * AROUND), 0);
        for (int i = 0; i < 3; i++)
            mesh->positions[v][i] += DRAWN_OUT * SIZE * part * part * at->direction[i];
    }
    return pel_mesh_write(lab_path(experiment, name, path), PEL_FORMAT_PLY, mesh, NULL, experiment->error);
}

static double distance_between(const pel_mesh *a, const pel_mesh *b)
{
    double square = 0;
    for (int32_t v = 0; v < a->vertex_count; v++)
        for (int i = 0; i < 3; i++)
            square += pow(a->positions[v][i] - b->positions[v][i], 2);
    return sqrt(square / a->vertex_count);
}

/* the body goes to its target shape, by E_S, E_B and the volume of the target */
static pel_status draw_out(lab_experiment *experiment, int body, pulled *made)
{
    char name[64], run[64], foot[120], rest[LAB_PATH_SIZE + 64], path[LAB_PATH_SIZE];
    tip at = {.foot = 0};
    pel_mesh *plain = NULL, *target = NULL, *end = NULL;
    b_shrunk shape = {0};
    pel_run_summary summary = {0};
    pel_status status = find_rest(experiment, body, &at);
    b_run_name(experiment, body, "rest", run);
    snprintf(name, sizeof name, "%.40s-target.ply", experiment->bodies[body].name);
    if (status == PEL_OK)
        status = b_read_frame(experiment, run, 0, &plain);
    if (status == PEL_OK)
        status = b_read_frame(experiment, run, 0, &target);
    if (status == PEL_OK)
        status = write_target(experiment, &at, name, target);
    snprintf(rest, sizeof rest, "bodies.0.rest={ file: \"%s\", weld: false }", lab_path(experiment, name, path));
    write_foot(&at, foot, sizeof foot);
    const char *settings[] = {rest, foot,
                              /* folds that the growing part begins with stay where E_B is weak */
                              "bodies.0.bending={ model: isometric-rest, weight: 1 }",
                              "bodies.0.pressure={ volume: { target: 1, bulk: 500 } }", "solver.drag=1",
                              "stop.frames=200", NULL};
    if (status == PEL_OK)
        status = b_shrink(experiment, body, "drawn", settings, &summary);
    if (status == PEL_OK)
        status = b_read_frame(experiment, b_run_name(experiment, body, "drawn", run), -1, &end);
    if (status == PEL_OK) {
        made->target = distance_between(end, target) / distance_between(plain, target);
        status = b_compare(&experiment->bodies[body], plain, target, &shape, experiment->error);
        made->drawn = shape.most_stretch;
    }
    pel_mesh_destroy(plain);
    pel_mesh_destroy(target);
    pel_mesh_destroy(end);
    made->crossed = (double)summary.self_intersections_final;
    return status;
}

static void judge(lab_experiment *experiment, const pulled *made)
{
    static const char source[] = B_PAPER ", section 7 (future work); the limit is ours";
    int count = b_shown(experiment);
    lab_begin_claim(experiment, LAB_PAPER, "an animator pulls a part as far as wanted, up to the size of the body",
                    NULL);
    for (int body = 0; body < count; body++)
        for (int i = 0; i < WAYS; i++) {
            char text[64];
            snprintf(text, sizeof text, "way of the part / of the handle, %g sizes", ways[i]);
            b_expect(experiment, body, text, made[body].reach[i], 1, 0.05, source);
        }
    lab_begin_claim(experiment, LAB_PAPER, "the deformation is exaggerated: far beyond a plausible stretch", NULL);
    for (int body = 0; body < count; body++)
        b_at_least(experiment, body, "longest edge / at rest, pulled by 1 size", made[body].stretch[WAYS - 1], 3,
                   source);
    lab_begin_claim(experiment, LAB_PAPER, "brought back and let go, it takes its shape again", NULL);
    for (int body = 0; body < count; body++)
        for (int i = 0; i < WAYS; i++) {
            char text[64];
            snprintf(text, sizeof text, "way that remains / of the handle, %g sizes", ways[i]);
            b_expect(experiment, body, text, made[body].remains[i], 0, 0.1, source);
            snprintf(text, sizeof text, "volume at the end, %g sizes", ways[i]);
            b_expect(experiment, body, text, made[body].volumes[i], 1, 0.05, source);
        }
    lab_begin_claim(experiment, LAB_PAPER, "given the exaggerated shape as its shape at rest, the body goes there",
                    NULL);
    for (int body = 0; body < count; body++) {
        b_at_most(experiment, body, "distance from the target shape / way there, frame 200", made[body].target, 0.2,
                  source);
        b_tell(experiment, body, "intersections, drawn to the target shape", made[body].crossed, (double)NAN, "");
        b_tell(experiment, body, "longest edge of the target shape / of the body", made[body].drawn, (double)NAN, "");
    }
    b_begin_contact_claim(experiment, NULL);
    for (int body = 0; body < count; body++)
        b_judge_contacts(experiment, body, "both", &made[body].contacts);
}

static pel_status run_exaggeration(lab_experiment *experiment)
{
    static pulled made[B_SHOWN];
    pel_status status = PEL_OK;
    for (int body = 0; status == PEL_OK && body < b_shown(experiment); body++) {
        made[body] = (pulled){0};
        status = pull(experiment, body, &made[body]);
        if (status == PEL_OK)
            status = draw_out(experiment, body, &made[body]);
    }
    if (status != PEL_OK)
        return status;
    judge(experiment, made);
    static const int frames[] = {0, 30, HELD, LAST}, drawn[] = {0, 10, 30, 200};
    status = b_draw_bodies(
        experiment, "pulled by the size of the body: at rest, half way, held, and after it is brought back and let go",
        "pulled-1", frames, 4);
    return status == PEL_OK
               ? b_draw_bodies(experiment, "drawn to the target shape: frames 0, 10, 30 and 200", "drawn", drawn, 4)
               : status;
}

const lab_case b_exaggeration = {
    .name = "b-exaggeration",
    .doc = "the paper's wish: a part that an animator pulls out by a handle, or by a target shape",
    .group = "paper B",
    .place = "section 7, future work",
    .run = run_exaggeration,
};
