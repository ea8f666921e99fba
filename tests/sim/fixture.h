/* A model and a sim on a shape, with paper A's parameters unless a test changes the defs. */
#ifndef PEL_TESTS_SIM_FIXTURE_H
#define PEL_TESTS_SIM_FIXTURE_H

#include "check.h"

#include <stdlib.h>

#include "pellicle/shape.h"
#include "pellicle/sim_step.h"

/* a tolerance: in float energies and momenta themselves are sums with 1e-7 */
#define IN_FLOAT(in_double, in_float) (sizeof(pel_real) == 4 ? (in_float) : (in_double))

static inline pel_mesh *make_sphere(int32_t frequency)
{
    pel_shape_def def = pel_shape_def_default(PEL_SHAPE_GEODESIC_SPHERE);
    def.frequency = frequency;
    pel_mesh *mesh;
    assert_int_equal(pel_shape_create(&def, &mesh, NULL), PEL_OK);
    return mesh;
}

/* paper A's springs on a mesh */
static inline pel_body_def ball_body(const pel_mesh *mesh)
{
    pel_body_def body = pel_body_def_default();
    body.name = "ball";
    body.mesh = mesh;
    return body;
}

static inline pel_model *make_model(const pel_body_def *body)
{
    pel_model_def def = pel_model_def_default();
    def.bodies = body;
    def.body_count = 1;
    pel_model *model;
    pel_error error;
    char text[800];
    pel_status status = pel_model_create(&def, &model, &error);
    if (status != PEL_OK)
        print_error("%s\n", pel_error_text(&error, text, sizeof text));
    assert_int_equal(status, PEL_OK);
    return model;
}

/* a model alone, in one thread */
static inline pel_sim_def lone_sim(const pel_model *model, pel_method method, double dt)
{
    pel_sim_def def = pel_sim_def_default();
    def.model = model;
    def.solver.method = method;
    def.solver.dt = dt;
    def.thread_count = 1;
    return def;
}

/* a body with all that is made of it */
typedef struct stage {
    pel_mesh *mesh;
    pel_model *model;
    pel_sim *sim;
} stage;

static inline void end_stage(stage *s)
{
    pel_sim_destroy(s->sim);
    pel_model_destroy(s->model);
    pel_mesh_destroy(s->mesh);
}

static inline pel_sim *make_sim(const pel_sim_def *def)
{
    pel_sim *sim;
    pel_error error;
    char text[800];
    pel_status status = pel_sim_create(def, &sim, &error);
    if (status != PEL_OK)
        print_error("%s\n", pel_error_text(&error, text, sizeof text));
    assert_int_equal(status, PEL_OK);
    return sim;
}

/* A def with a fault (its number, for the report) is refused with a message that has these words; null: it has no
   fault. element_kind: what the error names as number 1, with a remedy; null for none. */
static inline void check_refusal(const pel_sim_def *def, int fault, const char *words, const char *element_kind)
{
    pel_sim *sim;
    pel_error error = {0};
    pel_status status = pel_sim_create(def, &sim, &error);
    if (words != NULL && (status != PEL_BAD_ARGUMENT || strstr(error.what, words) == NULL))
        fail_msg("fault %d: %s", fault, error.what);
    assert_int_equal(status, words == NULL ? PEL_OK : PEL_BAD_ARGUMENT);
    assert_true((sim == NULL) == (status != PEL_OK));
    if (words != NULL && element_kind != NULL) {
        assert_int_equal(error.element, 1);
        assert_string_equal(error.element_kind, element_kind);
        assert_true(error.remedy[0] != '\0');
    }
    pel_sim_destroy(sim);
}

static inline int32_t nearest_vertex(const pel_mesh *mesh, double x, double y, double z)
{
    int32_t nearest = 0;
    double least = HUGE_VAL;
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        const double *p = mesh->positions[v];
        double square = (p[0] - x) * (p[0] - x) + (p[1] - y) * (p[1] - y) + (p[2] - z) * (p[2] - z);
        if (square < least) {
            least = square;
            nearest = v;
        }
    }
    return nearest;
}

static inline void run_steps(pel_sim *sim, int count)
{
    pel_error error;
    char text[800];
    for (int n = 0; n < count; n++) {
        pel_status status = pel_sim_step(sim, &error);
        if (status != PEL_OK)
            print_error("%s\n", pel_error_text(&error, text, sizeof text));
        assert_int_equal(status, PEL_OK);
    }
}

/* saves and destroys a sim, and continues in a new one */
static inline pel_sim *resume_sim(pel_sim *sim, const pel_sim_def *def)
{
    size_t size = pel_sim_save_size(sim);
    void *bytes = malloc(size);
    pel_sim_save(sim, bytes);
    pel_sim_destroy(sim);
    sim = make_sim(def);
    assert_int_equal(pel_sim_load(sim, bytes, size, NULL), PEL_OK);
    free(bytes);
    return sim;
}

/* an allocation_case (failing_malloc.h): a sim from its pel_sim_def, which may stay as it is */
static inline pel_status create_sim(const void *def, pel_error *error)
{
    pel_sim *sim;
    pel_status status = pel_sim_create(def, &sim, error);
    assert_true((sim == NULL) == (status != PEL_OK));
    pel_sim_destroy(sim);
    return status;
}

static inline double height_of(const pel_sim *sim, int32_t vertex)
{
    const pel_mesh *mesh = pel_model_mesh(pel_sim_model(sim), 0);
    static double positions[3 * 200000];
    assert_true(mesh->vertex_count <= 200000);
    pel_sim_get_positions(sim, 0, positions);
    return positions[3 * vertex + 2];
}

#endif
