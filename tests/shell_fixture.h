/* Bodies that are shells, for tests: shapes, deformed positions, sums of forces. */
#ifndef PEL_TESTS_SHELL_FIXTURE_H
#define PEL_TESTS_SHELL_FIXTURE_H

#include "math/vec3.h"
#include "model/shell.h"
#include "model/state.h"
#include "pellicle/observe.h"
#include "pellicle/shape.h"
#include "pellicle/sim_surface.h"
#include "random.h"
#include "sim/fixture.h"
#include "stage/stage.h"

static inline pel_mesh *make_shape(const pel_shape_def *def)
{
    pel_mesh *mesh;
    assert_int_equal(pel_shape_create(def, &mesh, NULL), PEL_OK);
    return mesh;
}

static inline pel_mesh *make_grid(int32_t nx, int32_t ny, double size_x, double size_y, pel_grid_diagonals diagonals)
{
    pel_shape_def def = pel_shape_def_default(PEL_SHAPE_GRID);
    def.nx = nx;
    def.ny = ny;
    def.size_x = size_x;
    def.size_y = size_y;
    def.diagonals = diagonals;
    return make_shape(&def);
}

/* a flat sheet with inner vertices moved about in its plane */
static inline pel_mesh *make_irregular_patch(int32_t n, random_state *random)
{
    pel_mesh *mesh = make_grid(n, n, 1, 1, PEL_GRID_UNION_JACK);
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        for (int c = 0; c < 2; c++)
            if (fabs(mesh->positions[v][0]) < 0.49 && fabs(mesh->positions[v][1]) < 0.49)
                mesh->positions[v][c] += random_between(random, -0.3, 0.3) / n;
    return mesh;
}

/* an ellipsoid with vertices moved about */
static inline pel_mesh *make_irregular_ball(int32_t frequency, random_state *random)
{
    static const double axes[3] = {1, 1.3, 0.8};
    pel_mesh *mesh = make_sphere(frequency);
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        for (int c = 0; c < 3; c++)
            mesh->positions[v][c] = axes[c] * mesh->positions[v][c] + random_between(random, -0.1, 0.1) / frequency;
    return mesh;
}

/* with the numbers that laws have no default for: the curve of tests/law_forms.h for 1e5 Pa, and a yield stress that
   nothing reaches */
static inline void shell_set_kind(pel_body_def *body, pel_membrane_kind kind)
{
    static const double curve[PEL_WEAVE_POINTS][2] = {{0.15, 1.5e4}, {0.3, 4.5e4}, {0.5, 1.25e5}};
    pel_membrane_def *membrane = &body->shell.membrane;
    membrane->kind = kind;
    membrane->shear = kind == PEL_MEMBRANE_WEAVE ? 1e5 / 2.6 : membrane->shear;
    membrane->yield = 1e7;
    memcpy(membrane->warp_curve, curve, sizeof curve);
    memcpy(membrane->weft_curve, curve, sizeof curve);
}

/* a sheet of that law */
static inline pel_body_def shell_body(const pel_mesh *mesh, pel_membrane_kind kind)
{
    pel_body_def body = pel_body_def_sheet("shell", mesh, 1e5, 0.01, 1000);
    shell_set_kind(&body, kind);
    return body;
}

static inline pel_state *make_state(const pel_model *model)
{
    pel_state *state;
    assert_int_equal(pel_state_create(model, false, &state, NULL), PEL_OK);
    return state;
}

/* moves every vertex that is no padding by up to `size` in each direction */
static inline void shake(const pel_model *model, pel_record *position, double size, random_state *random)
{
    for (int32_t v = 0; v < model->vertex_count; v++)
        for (int c = 0; c < 3; c++)
            if (model->mesh_vertex[v] >= 0)
                position[v][c] += (pel_real)random_between(random, -size, size);
}

static inline pel_record *make_records(const pel_model *model)
{
    return aligned_alloc(64, ((size_t)model->vertex_count * sizeof(pel_record) + 63) / 64 * 64);
}

/* calls pel_model_create on a def that has to be refused */
static inline void assert_refused(const pel_body_def *body, pel_status expected, const char *what)
{
    pel_model_def def = pel_model_def_default();
    def.bodies = body;
    def.body_count = 1;
    pel_model *model;
    pel_error error = {0};
    pel_status status = pel_model_create(&def, &model, &error);
    if (status != expected || strstr(error.what, what) == NULL)
        print_error("expected %d '%s', got %d '%s'\n", (int)expected, what, (int)status, error.what);
    assert_int_equal(status, expected);
    assert_null(model);
    assert_non_null(strstr(error.what, what));
    assert_true(error.remedy[0] != '\0');
    assert_int_equal(pel_model_create(&def, &model, NULL), expected);
}

/* the field "reaction" adds up to the force on the supports, and has a value on the vertices that they hold alone */
static inline void check_reactions(pel_sim *sim)
{
    int32_t count = pel_sim_vertex_count(sim, 0), held = 0;
    double *values = malloc(3 * (size_t)count * sizeof *values), sum[3] = {0}, size = 0;
    pel_support_reading reading;
    pel_error error;
    pel_sim_get_support(sim, 0, &reading);
    assert_int_equal(pel_observe(sim, pel_field_find("reaction"), 0, values, &error), PEL_OK);
    for (int32_t v = 0; v < count; v++) {
        pel_vec3_add(sum, values + 3 * (size_t)v, sum);
        size += pel_vec3_length(values + 3 * (size_t)v);
        held += pel_vec3_length(values + 3 * (size_t)v) > 0;
    }
    pel_vec3_add(sum, reading.force, sum);
    assert_true(size > 0 && held <= reading.vertex_count);
    assert_near(pel_vec3_length(sum), 0, 1e-14 * reading.vertex_count * size);
    free(values);
}

#endif
