/* Table 1 of paper A: 500 steps of the sphere on its base mesh, refined everywhere and refined locally. The four
   alternate every few steps, processor time is counted, and each turn is compared with that of the base just before,
   so that other load on the machine affects both equally. All repeats compute the same: their median counts. */
#include "bench.h"

#include <pellicle/shape.h>
#include <pellicle/sim.h>

#include <stdlib.h>

enum { BASE, LOCAL, DYNAMIC, EVERYWHERE, SPHERES };
enum { TURNS = 20, TURN = 25, REPEATS_MAX = 1000, EVENTS = 200 };

/* seconds of 500 steps in the paper (Pentium 4, 2006) */
static const double paper_base = 0.060, paper_everywhere = 0.194, paper_local = 0.066;

typedef struct sphere {
    pel_model *model;
    pel_sim *sim;
    void *start; /* snapshot to restore */
    size_t start_size;
} sphere;

typedef struct table1 {
    pel_mesh *mesh;
    sphere spheres[SPHERES];
    double times[SPHERES][REPEATS_MAX];
    double ratios[SPHERES][TURNS][REPEATS_MAX]; /* of times to those of the base in the same turn */
    int repeat;
    int32_t center; /* vertex whose two rings give the paper's 294 vertices and 584 triangles */
} table1;

static pel_status make_model(const table1 *table, int which, pel_model **made, pel_error *error)
{
    pel_body_def body = pel_body_def_default();
    body.name = "ball";
    body.mesh = table->mesh;
    body.volumetric_by_area = true;
    body.refine.levels = which == BASE ? 0 : 1;
    body.refine.everywhere = which == EVERYWHERE;
    if (which == DYNAMIC) {
        body.refine.above = 10;
        body.refine.below = 5;
        body.refine.interval = 50;
    }
    pel_model_def model = pel_model_def_default();
    model.bodies = &body;
    model.body_count = 1;
    return pel_model_create(&model, made, error);
}

static pel_status make_sim(const table1 *table, sphere *made, pel_error *error)
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

static pel_status make_sphere(table1 *table, int which, pel_error *error)
{
    sphere *made = &table->spheres[which];
    pel_status status = make_model(table, which, &made->model, error);
    if (status == PEL_OK)
        status = make_sim(table, made, error);
    if (status == PEL_OK && which == LOCAL)
        status = pel_sim_refine(made->sim, 0, table->center, 1, error);
    return status == PEL_OK ? keep_start(made, error) : status;
}

static pel_status begin(void **inner, pel_error *error)
{
    table1 *table = calloc(1, sizeof *table);
    *inner = table;
    if (table == NULL)
        return pel_fail_memory(error);
    /* of the default mesh: it and its six neighbours have six triangles each */
    table->center = 13;
    pel_shape_def shape = pel_shape_def_default(PEL_SHAPE_GEODESIC_SPHERE);
    pel_status status = pel_shape_create(&shape, &table->mesh, error);
    for (int i = 0; status == PEL_OK && i < SPHERES; i++)
        status = make_sphere(table, i, error);
    return status;
}

static pel_status rewind_all(void *inner, pel_error *error)
{
    const table1 *table = inner;
    pel_status status = PEL_OK;
    for (int i = 0; status == PEL_OK && i < SPHERES; i++)
        status = pel_sim_load(table->spheres[i].sim, table->spheres[i].start, table->spheres[i].start_size, error);
    return status;
}

static pel_status once(void *inner, pel_error *error)
{
    table1 *table = inner;
    pel_status status = PEL_OK;
    double times[SPHERES] = {0};
    for (int turn = 0; turn < TURNS; turn++) {
        double base = 0;
        for (int i = 0; i < SPHERES; i++) {
            double start = pel_thread_seconds();
            for (int n = 0; status == PEL_OK && n < TURN; n++)
                status = pel_sim_step(table->spheres[i].sim, error);
            double seconds = pel_thread_seconds() - start;
            times[i] += seconds;
            if (i == BASE)
                base = seconds;
            table->ratios[i][turn][table->repeat] = seconds / base;
        }
    }
    for (int i = 0; i < SPHERES; i++)
        table->times[i][table->repeat] = times[i];
    table->repeat++;
    return status;
}

/* time of the 500 steps over that on the base, whose turns all take as long */
static double ratio_of(table1 *table, int which)
{
    double sum = 0;
    for (int turn = 0; turn < TURNS; turn++)
        sum += cli_bench_median(table->ratios[which][turn], table->repeat);
    return sum / TURNS;
}

/* the event of the local sphere, and back */
static pel_status time_events(table1 *table, double *refine, double *coarsen, pel_error *error)
{
    static const int levels[2] = {0, 1};
    double times[2][EVENTS];
    pel_status status = PEL_OK;
    for (int n = 0; n < EVENTS; n++)
        for (int i = 0; status == PEL_OK && i < 2; i++) {
            double start = pel_thread_seconds();
            status = pel_sim_refine(table->spheres[LOCAL].sim, 0, table->center, levels[i], error);
            times[i][n] = pel_thread_seconds() - start;
        }
    *coarsen = cli_bench_median(times[0], EVENTS);
    *refine = cli_bench_median(times[1], EVENTS);
    return status;
}

static pel_status finish(void *inner, cli_bench_result *result, pel_error *error)
{
    table1 *table = inner;
    static const char *const names[SPHERES] = {"base_ms", "local_ms", "dynamic_ms", "everywhere_ms"};
    static const char *const faster[SPHERES] = {"base_faster_than_paper", "local_faster_than_paper",
                                                "dynamic_faster_than_paper", "everywhere_faster_than_paper"};
    const double paper[SPHERES] = {paper_base, paper_local, paper_local, paper_everywhere};
    double local = ratio_of(table, LOCAL), dynamic = ratio_of(table, DYNAMIC);
    double everywhere = ratio_of(table, EVERYWHERE), refine, coarsen;
    cli_bench_add(result, "local_triangles", "", pel_sim_triangle_count(table->spheres[LOCAL].sim, 0));
    cli_bench_add(result, "dynamic_triangles", "", pel_sim_triangle_count(table->spheres[DYNAMIC].sim, 0));
    for (int i = 0; i < SPHERES; i++) {
        double typical = cli_bench_median(table->times[i], table->repeat);
        cli_bench_add(result, names[i], "ms", 1e3 * typical);
        cli_bench_add(result, faster[i], "times", paper[i] / typical);
    }
    cli_bench_add(result, "local_over_base", "(paper: 1.10)", local);
    cli_bench_add(result, "dynamic_over_base", "(paper: 1.10)", dynamic);
    cli_bench_add(result, "everywhere_over_base", "(paper: 3.23)", everywhere);
    pel_status status = time_events(table, &refine, &coarsen, error);
    cli_bench_add(result, "refine_event_us", "us", 1e6 * refine);
    cli_bench_add(result, "coarsen_event_us", "us", 1e6 * coarsen);
    return status;
}

static void end(void *inner)
{
    table1 *table = inner;
    for (int i = 0; table != NULL && i < SPHERES; i++) {
        pel_sim_destroy(table->spheres[i].sim);
        pel_model_destroy(table->spheres[i].model);
        free(table->spheres[i].start);
    }
    if (table != NULL)
        pel_mesh_destroy(table->mesh);
    free(table);
}

const cli_bench_case cli_bench_table1 = {
    .name = "table1",
    .doc =
        "table 1 of paper A: 500 steps on the base, refined locally (asked for, and by the criterion) and everywhere",
    .repeats = 31,
    .begin = begin,
    .rewind = rewind_all,
    .once = once,
    .finish = finish,
    .end = end,
};
