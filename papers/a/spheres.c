#include "papers/a/spheres.h"

#include "papers/lab/median.h"

#include <pellicle/error.h>
#include <pellicle/shape.h>
#include <pellicle/sim_surface.h>

#include <stdlib.h>

enum { TURNS = 20, TURN = 25, EVENTS = 200 };

const double a_paper_seconds[A_SPHERES] = {0.060, 0.066, 0.066, 0.194};

typedef struct sphere {
    pel_model *model;
    pel_sim *sim;
    void *start; /* snapshot to restore */
    size_t start_size;
} sphere;

struct a_spheres {
    pel_mesh *mesh;
    sphere spheres[A_SPHERES];
    double times[A_SPHERES][A_REPEATS];
    double ratios[A_SPHERES][TURNS][A_REPEATS]; /* of times to those of the base in the same turn */
    int repeat;
    int32_t center; /* vertex whose two rings give the paper's 294 vertices and 584 triangles */
};

static pel_status make_model(const a_spheres *table, int which, pel_model **made, pel_error *error)
{
    pel_body_def body = pel_body_def_default();
    body.name = "ball";
    body.mesh = table->mesh;
    body.volumetric_by_area = true;
    body.refine.levels = which == A_BASE ? 0 : 1;
    body.refine.everywhere = which == A_EVERYWHERE;
    if (which == A_DYNAMIC) {
        body.refine.above = 10;
        body.refine.below = 5;
        body.refine.interval = 50;
    }
    pel_model_def model = pel_model_def_default();
    model.bodies = &body;
    model.body_count = 1;
    return pel_model_create(&model, made, error);
}

static pel_status make_sim(const a_spheres *table, sphere *made, pel_error *error)
{
    pel_load_def load = pel_load_def_default();
    for (int i = 0; i < 3; i++)
        load.force[i] = -table->mesh->positions[table->center][i];
    load.vertices = &table->center;
    load.vertex_count = 1;
    pel_sim_def def = pel_sim_def_default();
    def.model = made->model;
    def.solver.alpha = 50;
    def.loads = &load;
    def.load_count = 1;
    def.thread_count = 1;
    return pel_sim_create(&def, &made->sim, error);
}

static pel_status keep_start(sphere *made, pel_error *error)
{
    made->start_size = pel_sim_save_size(made->sim);
    made->start = malloc(made->start_size);
    if (made->start == NULL)
        return pel_fail_memory(error);
    pel_sim_save(made->sim, made->start);
    return PEL_OK;
}

static pel_status make_sphere(a_spheres *table, int which, pel_error *error)
{
    sphere *made = &table->spheres[which];
    pel_status status = make_model(table, which, &made->model, error);
    if (status == PEL_OK)
        status = make_sim(table, made, error);
    if (status == PEL_OK && which == A_LOCAL)
        status = pel_sim_refine(made->sim, 0, table->center, 1, error);
    return status == PEL_OK ? keep_start(made, error) : status;
}

pel_status a_spheres_create(a_spheres **spheres, pel_error *error)
{
    a_spheres *table = calloc(1, sizeof *table);
    *spheres = table;
    if (table == NULL)
        return pel_fail_memory(error);
    /* of the default mesh: it and its six neighbours have six triangles each */
    table->center = 13;
    pel_shape_def shape = pel_shape_def_default(PEL_SHAPE_GEODESIC_SPHERE);
    pel_status status = pel_shape_create(&shape, &table->mesh, error);
    for (int i = 0; status == PEL_OK && i < A_SPHERES; i++)
        status = make_sphere(table, i, error);
    return status;
}

pel_status a_spheres_rewind(a_spheres *table, pel_error *error)
{
    pel_status status = PEL_OK;
    for (int i = 0; status == PEL_OK && i < A_SPHERES; i++)
        status = pel_sim_load(table->spheres[i].sim, table->spheres[i].start, table->spheres[i].start_size, error);
    return status;
}

pel_status a_spheres_run(a_spheres *table, pel_error *error)
{
    pel_status status = PEL_OK;
    double times[A_SPHERES] = {0};
    for (int turn = 0; turn < TURNS; turn++) {
        double base = 0;
        for (int i = 0; i < A_SPHERES; i++) {
            double start = pel_thread_seconds();
            for (int n = 0; status == PEL_OK && n < TURN; n++)
                status = pel_sim_step(table->spheres[i].sim, error);
            double seconds = pel_thread_seconds() - start;
            times[i] += seconds;
            if (i == A_BASE)
                base = seconds;
            table->ratios[i][turn][table->repeat] = seconds / base;
        }
    }
    for (int i = 0; i < A_SPHERES; i++)
        table->times[i][table->repeat] = times[i];
    table->repeat++;
    return status;
}

/* time of the 500 steps over that on the base, whose turns all take as long */
static double ratio_of(a_spheres *table, int which)
{
    double sum = 0;
    for (int turn = 0; turn < TURNS; turn++)
        sum += lab_median(table->ratios[which][turn], table->repeat);
    return sum / TURNS;
}

/* the event of the local sphere, and back */
static pel_status time_events(a_spheres *table, double *refine, double *coarsen, pel_error *error)
{
    static const int levels[2] = {0, 1};
    double times[2][EVENTS];
    pel_status status = PEL_OK;
    for (int n = 0; n < EVENTS; n++)
        for (int i = 0; status == PEL_OK && i < 2; i++) {
            double start = pel_thread_seconds();
            status = pel_sim_refine(table->spheres[A_LOCAL].sim, 0, table->center, levels[i], error);
            times[i][n] = pel_thread_seconds() - start;
        }
    *coarsen = lab_median(times[0], EVENTS);
    *refine = lab_median(times[1], EVENTS);
    return status;
}

pel_status a_spheres_measure(a_spheres *table, a_times *times, pel_error *error)
{
    for (int i = 0; i < A_SPHERES; i++) {
        times->triangles[i] = pel_sim_triangle_count(table->spheres[i].sim, 0);
        times->seconds[i] = lab_median(table->times[i], table->repeat);
        times->over_base[i] = ratio_of(table, i);
    }
    return time_events(table, &times->refine, &times->coarsen, error);
}

void a_spheres_destroy(a_spheres *table)
{
    for (int i = 0; table != NULL && i < A_SPHERES; i++) {
        pel_sim_destroy(table->spheres[i].sim);
        pel_model_destroy(table->spheres[i].model);
        free(table->spheres[i].start);
    }
    if (table != NULL)
        pel_mesh_destroy(table->mesh);
    free(table);
}
