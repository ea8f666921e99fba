/* A body that refines, with its model and sim. */
#ifndef PEL_TESTS_SIM_REFINE_FIXTURE_H
#define PEL_TESTS_SIM_REFINE_FIXTURE_H

#include "pellicle/sim_ledger.h"
#include "pellicle/sim_surface.h"
#include "sim/fixture.h"
#include "stage/stage.h"

/* a tolerance, by the precision of the state: some roundings of it */
static inline double rounding(double in_double, double in_single)
{
    return sizeof(pel_real) == 8 ? in_double : in_single;
}

typedef struct bench {
    pel_mesh *mesh;
    pel_model *model;
    pel_sim *sim;
} bench;

static inline pel_body_def ball(const pel_mesh *mesh, int32_t levels)
{
    pel_body_def body = ball_body(mesh);
    body.volumetric_by_area = true;
    body.refine.levels = levels;
    return body;
}

static inline bench begin(pel_mesh *mesh, const pel_body_def *body, const pel_sim_def *with)
{
    bench made = {.mesh = mesh, .model = make_model(body)};
    pel_sim_def def = *with;
    def.model = made.model;
    made.sim = make_sim(&def);
    return made;
}

static inline void end(bench *made)
{
    pel_sim_destroy(made->sim);
    pel_model_destroy(made->model);
    pel_mesh_destroy(made->mesh);
}

static inline pel_sim_def explicit_def(double dt)
{
    pel_sim_def def = pel_sim_def_default();
    def.solver.method = PEL_METHOD_EXPLICIT;
    def.solver.dt = dt;
    return def;
}

static inline void refine(bench *made, int32_t vertex, int32_t level)
{
    pel_error error;
    char text[800];
    pel_status status = pel_sim_refine(made->sim, 0, vertex, level, &error);
    if (status != PEL_OK)
        print_error("%s\n", pel_error_text(&error, text, sizeof text));
    assert_int_equal(status, PEL_OK);
    assert_true(pel_front_is_valid(made->sim->model->bodies[0].front));
}

static inline pel_load_def pole_load(const pel_mesh *mesh, int32_t *pole, double force)
{
    *pole = nearest_vertex(mesh, 0, 0, 1);
    pel_load_def load = pel_load_def_default();
    load.force[2] = -force;
    load.vertices = pole;
    load.vertex_count = 1;
    return load;
}

static inline double spring_energy(const bench *made)
{
    pel_sim_measures measures;
    pel_sim_measure(made->sim, &measures);
    return measures.spring_energy;
}

#endif
