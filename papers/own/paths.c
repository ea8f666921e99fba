/* Validation: paths by arc length compared with prescribed volumes or displacements. */
#include "papers/own/validation.h"

#include <pellicle/mesh_io.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { POINTS = 40 };

/* where a path went: a displacement or a volume, and the load factor there */
typedef struct branch {
    double way[POINTS], factor[POINTS];
    int count, limit; /* points; the one with the largest factor before it falls */
} branch;

static double way_of(pel_sim *sim, bool by_volume)
{
    pel_sim_measures now;
    pel_sim_measure(sim, &now);
    return by_volume ? now.volume_ratio : now.max_displacement;
}

static pel_status follow(const lab_experiment *experiment, const char *text, bool by_volume, branch *found)
{
    lab_trial trial;
    pel_status status = lab_open_trial("validation", text, NULL, &trial, experiment->error);
    *found = (branch){.count = 0};
    for (int i = 0; status == PEL_OK && i < POINTS; i++) {
        status = pel_sim_step(trial.sim, experiment->error);
        if (status != PEL_OK || pel_sim_get_path_end(trial.sim) != PEL_PATH_GOES_ON)
            break;
        found->way[i] = way_of(trial.sim, by_volume);
        found->factor[i] = pel_sim_load_factor(trial.sim);
        found->count = i + 1;
        if (found->limit == i - 1 && found->factor[i] > found->factor[found->limit])
            found->limit = i;
    }
    lab_close_trial(&trial);
    return status;
}

/* ---- a balloon beyond its largest pressure ---- */

#define BALLOON                                                                                                        \
    "version: 1\n"                                                                                                     \
    "bodies:\n"                                                                                                        \
    "  - mesh: { shape: geodesic-sphere, frequency: 8, radius: 0.1 }\n"                                                \
    "    membrane: { material: neo-hookean, young: 1.0e6, poisson: 0.5, thickness: 0.001 }\n"                          \
    "    bending: { model: midedge }\n"

/* the pressure that keeps a volume: bulk times the missing volume */
static pel_status press_to(const lab_experiment *experiment, double volume, double pressure, double *found)
{
    const double bulk = 20000;
    char text[OWN_SCENE_SIZE];
    lab_trial trial;
    double target = volume + pressure / bulk;
    snprintf(text, sizeof text,
             BALLOON "    pressure: { volume: { target: { keys: [[0, 1], [10, %.17g]] }, bulk: %.17g } }\n"
                     "solver: { method: static, steps: 10 }\n",
             target, bulk);
    pel_status status = lab_open_trial("validation", text, NULL, &trial, experiment->error);
    if (status == PEL_OK)
        status = lab_step_trial(&trial, 10, experiment->error);
    if (status == PEL_OK)
        *found = bulk * (target - way_of(trial.sim, true));
    lab_close_trial(&trial);
    return status;
}

static pel_status check_balloon(lab_experiment *experiment)
{
    branch along;
    char line[64];
    pel_status status = follow(experiment,
                               BALLOON "    pressure: { inside: 6000 }\n"
                                       "solver: { path: arc-length, steps: 40 }\n",
                               true, &along);
    for (int k = -1; status == PEL_OK && k < 3; k++) {
        int at = along.limit + 2 * k + (k == 2);
        double pressure = 6000 * along.factor[at], kept = 0, stretch = cbrt(along.way[at]);
        status = press_to(experiment, along.way[at], pressure, &kept);
        if (status != PEL_OK)
            return status;
        snprintf(line, sizeof line, "balloon at %.2f times its volume: pressure", along.way[at]);
        lab_expect(experiment, line, pressure, kept, 0.005 * kept, "the volume prescribed");
        /* 2 mu h / R (1 / l - 1 / l^7), mu = E / 3 */
        double exact = 2e6 / 3 * 0.01 * (1 / stretch - pow(stretch, -7));
        lab_expect(experiment, line, pressure, exact, 0.005 * exact, "neo-Hookean membrane");
    }
    return status;
}

/* ---- a cap that snaps ---- */

/* a cap of radius 1 over a circle of radius 0.2, in rings */
static pel_status write_cap(const lab_experiment *experiment, char *file, char *rim, size_t size)
{
    enum { RINGS = 12, VERTICES = 1 + 3 * RINGS * (RINGS + 1), TRIANGLES = 6 * RINGS * RINGS };
    static double x[VERTICES][3];
    static int32_t corners[TRIANGLES][3];
    int32_t t = 0, first = 1, before = 0;
    x[0][2] = 1;
    for (int i = 1; i <= RINGS; i++) {
        int count = 6 * i, inner = i > 1 ? 6 * (i - 1) : 1;
        for (int j = 0; j < count; j++) {
            double r = 0.2 * i / RINGS, angle = 2 * 3.14159265358979323846 * j / count;
            x[first + j][0] = r * cos(angle);
            x[first + j][1] = r * sin(angle);
            x[first + j][2] = sqrt(1 - r * r);
            int side = j / i, k = j % i, a = before + (side * (i - 1) + k) % inner;
            const int32_t outer[3] = {first + j, first + (j + 1) % count, a};
            memcpy(corners[t++], outer, sizeof outer);
            if (k < i - 1) {
                const int32_t between[3] = {first + (j + 1) % count, before + (side * (i - 1) + k + 1) % inner, a};
                memcpy(corners[t++], between, sizeof between);
            }
        }
        before = first;
        first += count;
    }
    rim[0] = '\0';
    for (int v = before; v < first; v++)
        snprintf(rim + strlen(rim), size - strlen(rim), "%s%d", v > before ? ", " : "", v);
    pel_mesh *mesh;
    pel_status status = pel_mesh_create(x[0], VERTICES, corners[0], TRIANGLES, &mesh, experiment->error);
    if (status != PEL_OK)
        return status;
    status = pel_mesh_write(lab_path(experiment, "cap.ply", file), PEL_FORMAT_PLY, mesh, NULL, experiment->error);
    pel_mesh_destroy(mesh);
    return status;
}

static void write_scene(const char *file, const char *rim, const char *rest, char *text)
{
    snprintf(text, OWN_SCENE_SIZE,
             "version: 1\n"
             "bodies:\n"
             "  - mesh: { file: \"%s\" }\n"
             "    membrane: { material: stvk, young: 1.0e9, poisson: 0.3, thickness: 0.008 }\n"
             "    bending: { model: midedge }\n"
             "    supports:\n"
             "      - { at: { vertices: [%s] } }\n"
             "%s",
             file, rim, rest);
}

/* the force on the top at this displacement */
static pel_status push_to(const lab_experiment *experiment, const char *file, const char *rim, double way,
                          double *force)
{
    char text[OWN_SCENE_SIZE], rest[300];
    lab_trial trial;
    pel_support_reading reading;
    snprintf(rest, sizeof rest,
             "      - { at: { vertices: [0] }, fix: [z], displacement: [0, 0, %.17g], keys: [[0, 0], [20, 1]] }\n"
             "solver: { method: static, steps: 20 }\n",
             -way);
    write_scene(file, rim, rest, text);
    pel_status status = lab_open_trial("validation", text, NULL, &trial, experiment->error);
    if (status == PEL_OK)
        status = lab_step_trial(&trial, 20, experiment->error);
    if (status == PEL_OK) {
        pel_sim_get_support_part(trial.sim, 1, &reading);
        *force = reading.force[2];
    }
    lab_close_trial(&trial);
    return status;
}

static pel_status check_cap(lab_experiment *experiment)
{
    char file[LAB_PATH_SIZE], rim[600], text[OWN_SCENE_SIZE], line[64];
    branch along;
    pel_status status = write_cap(experiment, file, rim, sizeof rim);
    if (status != PEL_OK)
        return status;
    write_scene(file, rim,
                "loads: [{ force: [0, 0, -4000], at: { vertices: [0] } }]\n"
                "solver: { path: arc-length, steps: 40 }\n",
                text);
    status = follow(experiment, text, false, &along);
    /* the point of the largest force lies beyond the limit already; after it the balances of the path are unstable, and
       the body whose top is prescribed leaves them */
    for (int k = -2; status == PEL_OK && k < 1; k++) {
        int at = along.limit + k;
        double force = 4000 * along.factor[at], pushed = 0;
        status = push_to(experiment, file, rim, along.way[at], &pushed);
        snprintf(line, sizeof line, "cap, top %.2f mm down: force", 1000 * along.way[at]);
        if (status == PEL_OK)
            lab_expect(experiment, line, force, pushed, 0.005 * fabs(pushed), "the displacement prescribed");
    }
    return status;
}

pel_status own_validate_paths(lab_experiment *experiment)
{
    pel_status status = check_balloon(experiment);
    return status == PEL_OK ? check_cap(experiment) : status;
}
