/* Paper B gives neither its time step nor its pressure and masses. Ours: a frame of 1/60 s and p / (rho h) = 0.3 m/s2
   on bodies of 2 m with edges of 5 cm, so that bodies lose about half of their volume in 100 frames (the scale of
   figures 17, 18 and 20) and are crushed in 200; in proportion to the edges on others. */
#include "papers/b/shrink.h"

#include <pellicle/measure.h>
#include <pellicle/topology.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* k_A over the pressure [m2]: pushes that add up to about those of the pressure where it shortens fibres by 5 %. Both
   are in proportion to the edges, so that finer bodies cave in alike */
#define GRADIENT_PER_PRESSURE 0.6

/* in all frames of a run: fewer are near each other in passing */
#define FEW_CONTACTS 10

static const char scene[] = "version: 1\n"
                            "title: shell that shrinks under pressure\n"
                            "bodies:\n"
                            "  - name: shell\n"
                            "    mesh: { shape: geodesic-sphere, frequency: 8 }\n"
                            "    mass: { density: 1000, thickness: 0.01 }\n"
                            "    membrane: { material: stvk, young: 1.0e5 }\n"
                            "    bending: { model: isometric, weight: 0.01 }\n"
                            "    pressure: { outside: 0 }\n"
                            "contact: { self: true }\n"
                            "solver: { method: pbd, dt: 0.0166666667, iterations: 5 }\n"
                            "stop: { frames: 100, volume_ratio_below: 0.1 }\n"
                            "output: { every_frame: 1, fields: [displacement], compress: true }\n";

const char *b_run_name(const lab_experiment *experiment, int body, const char *what, char *name)
{
    snprintf(name, 64, "%.36s-%.26s", experiment->bodies[body].name, what);
    return name;
}

/* "BODY: TEXT"; returns name */
static const char *label(const lab_experiment *experiment, int body, const char *text, char name[96])
{
    snprintf(name, 96, "%s: %s", experiment->bodies[body].name, text);
    return name;
}

void b_expect(lab_experiment *experiment, int body, const char *text, double value, double expected, double tolerance,
              const char *source)
{
    char name[96];
    lab_expect(experiment, label(experiment, body, text, name), value, expected, tolerance, source);
}

void b_at_most(lab_experiment *experiment, int body, const char *text, double value, double limit, const char *source)
{
    char name[96];
    lab_at_most(experiment, label(experiment, body, text, name), value, limit, source);
}

void b_at_least(lab_experiment *experiment, int body, const char *text, double value, double limit, const char *source)
{
    char name[96];
    lab_at_least(experiment, label(experiment, body, text, name), value, limit, source);
}

void b_tell(lab_experiment *experiment, int body, const char *text, double value, double expected, const char *source)
{
    char name[96];
    lab_tell(experiment, label(experiment, body, text, name), value, expected, source);
}

void b_begin_contact_claim(lab_experiment *experiment, const char *reason)
{
    lab_begin_claim(experiment, LAB_PAPER, "step 4 leaves no self-intersection, and the guard need not act", reason);
}

void b_judge_contacts(lab_experiment *experiment, int body, const char *runs, const b_contacts *sum)
{
    char text[80];
    snprintf(text, sizeof text, "intersections and vertices stepped back, %s", runs);
    /* where hardly anything touches, nothing would cross without step 4 either, and nothing is shown */
    if (sum->pairs >= FEW_CONTACTS || sum->intersections + sum->guarded > 0)
        b_at_most(experiment, body, text, sum->intersections + sum->guarded, 0,
                  B_PAPER ", section 5, step 4: the paper has no guard");
    snprintf(text, sizeof text, "contacts in all frames, %s", runs);
    b_tell(experiment, body, text, sum->pairs, (double)NAN, "");
}

pel_status b_add_contacts(const lab_experiment *experiment, int body, const char *what, const pel_run_summary *summary,
                          b_contacts *sum)
{
    char run[64];
    const char *const columns[2] = {"contact_fall_backs", "contact_pairs"};
    double *const sums[2] = {&sum->guarded, &sum->pairs};
    pel_status status = PEL_OK;
    b_run_name(experiment, body, what, run);
    sum->intersections += (double)summary->self_intersections_final;
    for (int i = 0; status == PEL_OK && i < 2; i++) {
        lab_series series;
        status = lab_read_series(experiment, run, "frame", columns[i], &series);
        for (int k = 0; status == PEL_OK && k < series.count; k++)
            *sums[i] += series.y[k];
        lab_free_series(&series);
    }
    return status;
}

int b_shown(const lab_experiment *experiment)
{
    return experiment->body_count < B_SHOWN ? experiment->body_count : B_SHOWN;
}

pel_status b_shrink(lab_experiment *experiment, int body, const char *what, const char *const *settings,
                    pel_run_summary *summary)
{
    enum { SETTINGS = 12 };
    char name[64], pressure[64];
    const char *overrides[SETTINGS + 3] = {experiment->bodies[body].mesh, pressure};
    snprintf(pressure, sizeof pressure, "bodies.0.pressure.outside=%.15g", experiment->bodies[body].pressure);
    for (int i = 0; settings != NULL && settings[i] != NULL && i < SETTINGS; i++)
        overrides[i + 2] = settings[i];
    return lab_run(experiment, b_run_name(experiment, body, what, name), scene, overrides, summary);
}

pel_status b_volume(const lab_experiment *experiment, const char *run, int frame, double *ratio, int *rises)
{
    lab_series series;
    pel_status status = lab_read_series(experiment, run, "frame", "volume_ratio", &series);
    int last = frame >= 0 && frame < series.count ? frame : series.count - 1;
    if (status == PEL_OK) {
        *ratio = series.y[last];
        *rises = 0;
        for (int i = 1; i <= last; i++)
            *rises += series.y[i] > series.y[i - 1] + 1e-7;
    }
    lab_free_series(&series);
    return status;
}

pel_status b_turns(const lab_experiment *experiment, const char *run, int frame, int *turns)
{
    lab_series series;
    pel_status status = lab_read_series(experiment, run, "frame", "volume_ratio", &series);
    double before = 0;
    *turns = 0;
    for (int i = 1; status == PEL_OK && i < series.count && i <= frame; i++) {
        double way = series.y[i] - series.y[i - 1];
        if (fabs(way) <= 1e-7)
            continue;
        *turns += before * way < 0;
        before = way;
    }
    lab_free_series(&series);
    return status;
}

pel_status b_volume_ratio(const lab_experiment *experiment, const char *run, const char *other, int frame,
                          double *ratio)
{
    lab_series series[2] = {{0}};
    pel_status status = lab_read_series(experiment, run, "frame", "volume_ratio", &series[0]);
    if (status == PEL_OK)
        status = lab_read_series(experiment, other, "frame", "volume_ratio", &series[1]);
    for (int i = 0; i < 2; i++)
        frame = frame < series[i].count ? frame : series[i].count - 1;
    if (status == PEL_OK)
        *ratio = series[0].y[frame] / series[1].y[frame];
    lab_free_series(&series[0]);
    lab_free_series(&series[1]);
    return status;
}

pel_status b_last(const lab_experiment *experiment, const char *run, const char *column, double *number)
{
    lab_series series;
    pel_status status = lab_read_series(experiment, run, "frame", column, &series);
    if (status == PEL_OK)
        *number = series.y[series.count - 1];
    lab_free_series(&series);
    return status;
}

pel_status b_mean(const lab_experiment *experiment, const char *run, const char *column, double *mean)
{
    lab_series series;
    pel_status status = lab_read_series(experiment, run, "frame", column, &series);
    *mean = 0;
    for (int i = 1; status == PEL_OK && i < series.count; i++)
        *mean += series.y[i] / (series.count - 1);
    lab_free_series(&series);
    return status;
}

void b_begin_bound_claim(lab_experiment *experiment)
{
    lab_begin_claim(experiment, LAB_THEORY, "E_A decides the depth, not the bound of a correction", NULL);
}

pel_status b_judge_bound(lab_experiment *experiment, int body, const char *what)
{
    char run[64], text[80];
    double cut = (double)NAN;
    pel_status status = b_mean(experiment, b_run_name(experiment, body, what, run), "caving_limited", &cut);
    snprintf(text, sizeof text, "%s, share of corrections that are cut", what);
    b_at_most(experiment, body, text, cut, 0.05, "docs/shells.md");
    return status;
}

pel_status b_plot_volumes(lab_experiment *experiment, const char *title, const char *const *runs,
                          const char *const *labels, int count)
{
    return lab_plot_runs(experiment, &(lab_run_plot){.title = title,
                                                     .x_name = "frame",
                                                     .y_name = "volume / volume at rest",
                                                     .x_column = "frame",
                                                     .y_column = "volume_ratio",
                                                     .runs = runs,
                                                     .labels = labels,
                                                     .run_count = count});
}

pel_status b_draw_bodies(lab_experiment *experiment, const char *caption, const char *what, const int *frames,
                         int frame_count)
{
    char names[B_SHOWN][64];
    lab_picture picture = {.caption = caption,
                           .run_count = b_shown(experiment),
                           .frame_count = frame_count,
                           .columns = frame_count,
                           .field = "none",
                           .azimuth = 35,
                           .elevation = 20};
    memcpy(picture.frames, frames, (size_t)frame_count * sizeof *frames);
    for (int body = 0; body < picture.run_count; body++) {
        picture.runs[body] = b_run_name(experiment, body, what, names[body]);
        picture.labels[body] = experiment->bodies[body].name;
    }
    return lab_add_picture(experiment, &picture);
}

lab_picture b_begin_pairs(const char *caption, int frame, int bodies)
{
    return (lab_picture){.caption = caption,
                         .frames = {frame},
                         .frame_count = 1,
                         .columns = 2 * bodies,
                         .field = "none",
                         .azimuth = 35,
                         .elevation = 20};
}

void b_add_pair(lab_picture *picture, const char *const labels[2], char names[2][64])
{
    for (int i = 0; i < 2; i++) {
        picture->labels[picture->run_count] = labels[i];
        picture->runs[picture->run_count++] = names[i];
    }
}

double b_fibre_gradient(const lab_body *body)
{
    return GRADIENT_PER_PRESSURE * body->pressure;
}

const char *b_fibres(const lab_experiment *experiment, int body, const char *energy, char *text)
{
    double gradient = b_fibre_gradient(&experiment->bodies[body]);
    snprintf(text, B_FIBRES_SIZE, "bodies.0.anisotropy={ mode: normal, energy: %s, gradient: %.6g }", energy,
             strcmp(energy, "stvk") == 0 ? 4 * gradient : gradient);
    return text;
}

pel_status b_read_frame(const lab_experiment *experiment, const char *run, int frame, pel_mesh **mesh)
{
    char path[LAB_PATH_SIZE];
    pel_frames *frames;
    *mesh = NULL;
    pel_status status = pel_frames_open(lab_path(experiment, run, path), &frames, experiment->error);
    if (status != PEL_OK)
        return status;
    int last = frames->frame_count - 1;
    status = pel_frames_read(frames, frame >= 0 && frame < last ? frame : last, mesh, experiment->error);
    pel_frames_close(frames);
    return status;
}

/* ---- measures ---- */

/* the mean curvature at a vertex minus the mean over its neighbours */
static double unevenness(const pel_topology *topology, const double *curvature, int32_t v)
{
    double sum = 0;
    int count = 0;
    int32_t first = topology->corner_of_vertex[v], h = first;
    do {
        sum += curvature[pel_half_edge_target(topology, h)];
        count++;
        h = pel_half_edge_turn(topology, h);
    } while (h >= 0 && h != first);
    return curvature[v] - sum / count;
}

static void measure_ways(const bool *in_cap, const pel_mesh *rest, const pel_mesh *mesh, const double *normals,
                         const double *curvature, b_shrunk *shape)
{
    double cap = 0, all = 0, depth = 0, bend = 0;
    int count = 0;
    for (int32_t v = 0; v < rest->vertex_count; v++) {
        double square = 0, inward = 0;
        for (int i = 0; i < 3; i++) {
            double way = mesh->positions[v][i] - rest->positions[v][i];
            square += way * way;
            inward -= way * normals[3 * v + i];
        }
        all += square;
        if (!in_cap[v])
            continue;
        count++;
        cap += square;
        depth += inward;
        bend += curvature[v];
    }
    shape->body_way = sqrt(all / rest->vertex_count);
    shape->cap_way = sqrt(cap / count);
    shape->cap_depth = depth / count;
    shape->cap_curvature = bend / count;
}

static double edge_length(const pel_mesh *mesh, int32_t t, int corner)
{
    const double *a = mesh->positions[mesh->triangles[t][corner]],
                 *b = mesh->positions[mesh->triangles[t][(corner + 1) % 3]];
    return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]));
}

/* energy of St. Venant and Kirchhoff per area at rest, over mu, from the lengths of the edges (nu = 0.3) */
static double energy_density(const double rest[3], const double now[3], double *area)
{
    /* C - I of the squared lengths: x axis along edge 0 */
    double x = (rest[0] * rest[0] + rest[2] * rest[2] - rest[1] * rest[1]) / (2 * rest[0]);
    double y = sqrt(fmax(rest[2] * rest[2] - x * x, 1e-30));
    double c11 = now[0] * now[0] / (rest[0] * rest[0]);
    double dot = (now[0] * now[0] + now[2] * now[2] - now[1] * now[1]) / 2;
    double c12 = (dot / rest[0] - x * c11) / y;
    double c22 = (now[2] * now[2] - x * x * c11 - 2 * x * y * c12) / (y * y);
    double e11 = (c11 - 1) / 2, e22 = (c22 - 1) / 2, e12 = c12 / 2;
    *area = rest[0] * y / 2;
    const double lambda = 2 * 0.3 / (1 - 0.3);
    return e11 * e11 + e22 * e22 + 2 * e12 * e12 + lambda / 2 * (e11 + e22) * (e11 + e22);
}

/* energy per area at rest of a triangle, and its area */
static double triangle_energy(const pel_mesh *rest, const pel_mesh *mesh, int32_t t, double *area)
{
    double before[3], now[3];
    for (int k = 0; k < 3; k++) {
        before[k] = edge_length(rest, t, k);
        now[k] = edge_length(mesh, t, k);
    }
    return energy_density(before, now, area);
}

void b_energy_density(const pel_mesh *rest, const pel_mesh *mesh, double *density)
{
    memset(density, 0, (size_t)rest->vertex_count * sizeof *density);
    double *areas = calloc((size_t)rest->vertex_count, sizeof *areas);
    for (int32_t t = 0; areas != NULL && t < rest->triangle_count; t++) {
        double area, energy = triangle_energy(rest, mesh, t, &area);
        for (int k = 0; k < 3; k++) {
            density[rest->triangles[t][k]] += area * energy;
            areas[rest->triangles[t][k]] += area;
        }
    }
    for (int32_t v = 0; areas != NULL && v < rest->vertex_count; v++)
        density[v] /= areas[v];
    free(areas);
}

static void measure_stretch(const pel_mesh *rest, const pel_mesh *mesh, b_shrunk *shape)
{
    double areas = 0, sum = 0, squares = 0;
    for (int32_t t = 0; t < rest->triangle_count; t++) {
        double area, density = triangle_energy(rest, mesh, t, &area);
        for (int k = 0; k < 3; k++)
            shape->most_stretch = fmax(shape->most_stretch, edge_length(mesh, t, k) / edge_length(rest, t, k));
        areas += area;
        sum += area * density;
        squares += area * density * density;
    }
    double mean = sum / areas;
    shape->energy = mean;
    shape->energy_spread = sqrt(fmax(squares / areas - mean * mean, 0)) / mean;
}

pel_status b_compare(const lab_body *body, const pel_mesh *rest, const pel_mesh *mesh, b_shrunk *shape,
                     pel_error *error)
{
    pel_topology *topology;
    *shape = (b_shrunk){0};
    pel_status status = pel_topology_create(mesh, &topology, error);
    if (status != PEL_OK)
        return status;
    size_t count = (size_t)mesh->vertex_count;
    double *normals = calloc(5 * count, sizeof *normals);
    bool *in_cap = calloc(count, sizeof *in_cap);
    status = normals == NULL || in_cap == NULL
                 ? pel_fail_memory(error)
                 : lab_mark_cap(body, topology, (const double(*)[3])rest->positions, in_cap, error);
    if (status != PEL_OK) {
        free(normals);
        free(in_cap);
        pel_topology_destroy(topology);
        return status;
    }
    double *curvature = normals + 3 * count, *areas = curvature + count, noise = 0, size = 0;
    pel_surface_normals(topology, rest->positions[0], PEL_NORMAL_ANGLE, normals);
    pel_surface_mean_curvature(topology, mesh->positions[0], curvature, NULL);
    pel_surface_vertex_areas(topology, mesh->positions[0], areas);
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        noise += areas[v] * pow(unevenness(topology, curvature, v), 2);
        size += areas[v] * curvature[v] * curvature[v];
    }
    shape->roughness = sqrt(noise / size);
    measure_ways(in_cap, rest, mesh, normals, curvature, shape);
    measure_stretch(rest, mesh, shape);
    free(normals);
    free(in_cap);
    pel_topology_destroy(topology);
    return PEL_OK;
}

pel_status b_measure(const lab_experiment *experiment, int body, const char *run, int frame, b_shrunk *shape)
{
    pel_mesh *rest = NULL, *mesh = NULL;
    pel_status status = b_read_frame(experiment, run, 0, &rest);
    if (status == PEL_OK)
        status = b_read_frame(experiment, run, frame, &mesh);
    if (status == PEL_OK)
        status = b_compare(&experiment->bodies[body], rest, mesh, shape, experiment->error);
    pel_mesh_destroy(rest);
    pel_mesh_destroy(mesh);
    return status;
}

/* root mean square of the displacements of the marked vertices, less their mean */
static double change_of(const pel_mesh *rest, const pel_mesh *mesh, const bool *marked)
{
    double mean[3] = {0}, square = 0;
    int count = 0;
    for (int32_t v = 0; v < rest->vertex_count; v++) {
        count += marked[v];
        for (int i = 0; marked[v] && i < 3; i++) {
            double way = mesh->positions[v][i] - rest->positions[v][i];
            mean[i] += way;
            square += way * way;
        }
    }
    for (int i = 0; i < 3; i++)
        square -= mean[i] * mean[i] / count;
    return sqrt(fmax(square, 0) / count);
}

pel_status b_cap_change(const lab_experiment *experiment, int body, const char *run, int frame, double *over_others)
{
    enum { OTHERS = 60 };
    pel_mesh *rest = NULL, *mesh = NULL;
    pel_topology *topology = NULL;
    bool *marked = NULL;
    lab_body other = experiment->bodies[body];
    double cap = 0, sum = 0;
    pel_status status = b_read_frame(experiment, run, 0, &rest);
    if (status == PEL_OK)
        status = b_read_frame(experiment, run, frame, &mesh);
    if (status == PEL_OK)
        status = pel_topology_create(rest, &topology, experiment->error);
    if (status == PEL_OK && (marked = calloc((size_t)rest->vertex_count, sizeof *marked)) == NULL)
        status = pel_fail_memory(experiment->error);
    for (int i = -1; status == PEL_OK && i < OTHERS; i++) {
        if (i >= 0)
            memcpy(other.cap_center, rest->positions[(int64_t)i * rest->vertex_count / OTHERS],
                   sizeof other.cap_center);
        status = lab_mark_cap(&other, topology, (const double(*)[3])rest->positions, marked, experiment->error);
        if (status == PEL_OK)
            *(i < 0 ? &cap : &sum) += change_of(rest, mesh, marked);
    }
    *over_others = cap / (sum / OTHERS);
    free(marked);
    pel_topology_destroy(topology);
    pel_mesh_destroy(rest);
    pel_mesh_destroy(mesh);
    return status;
}
