/* Derivatives by an adjoint solution against differences of whole solutions. */
#include "shell_fixture.h"
#include "sim/fixture.h"

#include "failing_malloc.h"
#include "pellicle/sim_adjoint.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* input of a case, with the numbers of the derivatives */
typedef struct trial {
    pel_method method;
    bool is_closed, has_hinges, is_woven;
    double young, poisson, thickness, pressure, load, gravity;
    double rigidity;        /* N m, flexural; 0 = that of the material */
    double (*positions)[3]; /* of the mesh */
    double force[3];        /* on vertex 7 */
} trial;

static pel_mesh *make_mesh(const trial *t)
{
    pel_mesh *mesh = t->is_closed ? make_sphere(2) : make_grid(4, 3, 1, 0.8, PEL_GRID_UNION_JACK);
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        double *x = mesh->positions[v];
        if (!t->is_closed)
            x[2] = 0.15 * x[0] * x[0] - 0.1 * x[0] * x[1];
        if (t->positions != NULL)
            memcpy(x, t->positions[v], 3 * sizeof *x);
    }
    return mesh;
}

/* a fixed function of the positions, and its derivative */
static double function_of(int32_t count, const double *x, double *derivative)
{
    double sum = 0;
    for (int32_t i = 0; i < 3 * count; i++) {
        double weight = sin(1.7 * i + 0.3);
        sum += weight * x[i] + 0.5 * x[i] * x[i];
        if (derivative != NULL)
            derivative[i] = weight + x[i];
    }
    return sum;
}

typedef struct solved {
    pel_mesh *mesh;
    pel_model *model;
    pel_sim *sim;
    double value;
    double *x;
} solved;

static solved solve(const trial *t)
{
    solved s = {.mesh = make_mesh(t)};
    pel_body_def body = pel_body_def_default();
    body.mesh = s.mesh;
    body.name = "shell";
    body.mass_kind = PEL_MASS_PER_VERTEX;
    body.mass = 0.1;
    body.spring_stiffness.value = body.volumetric_stiffness.value = 0;
    body.shell.membrane.on = true;
    body.shell.membrane.kind = PEL_MEMBRANE_NEO_HOOKEAN;
    body.shell.membrane.young.value = t->young;
    body.shell.membrane.poisson = t->poisson;
    body.shell.membrane.thickness.value = t->thickness;
    body.shell.bending.model = t->has_hinges ? PEL_BENDING_HINGE : PEL_BENDING_MIDEDGE;
    if (t->rigidity > 0)
        body.shell.bending.stiffness.value = t->rigidity;
    if (t->is_woven) {
        body.shell.membrane.kind = PEL_MEMBRANE_ORTHOTROPIC;
        body.shell.membrane.weft = 0.6 * t->young;
        body.shell.membrane.shear = 0.3 * t->young;
        body.shell.membrane.direction[1] = 0.5;
        if (t->rigidity > 0)
            body.shell.bending.weft = 0.3 * t->rigidity;
    }
    static const int32_t pins[4] = {0, 1, 5, 6};
    body.pinned = pins;
    body.pinned_count = 4;
    if (t->is_closed) {
        body.shell.pressure.kind = PEL_PRESSURE_GIVEN;
        body.shell.pressure.outside.value = -t->pressure;
    }
    pel_model_def model = pel_model_def_default();
    model.bodies = &body;
    model.body_count = 1;
    model.gravity[2] = t->gravity;
    pel_error error = {.status = PEL_OK};
    if (pel_model_create(&model, &s.model, &error) != PEL_OK)
        fail_msg("%s", error.what);
    static const int32_t seventh[1] = {7};
    pel_load_def loads[2] = {pel_load_def_default(), pel_load_def_default()};
    /* derivatives by rest positions leave the forces of the vertices as they are: parts of a total follow areas */
    loads[0].kind = PEL_LOAD_PER_VERTEX;
    loads[0].force[0] = t->load / s.mesh->vertex_count;
    loads[0].force[2] = 2 * t->load / s.mesh->vertex_count;
    loads[1].vertices = seventh;
    loads[1].vertex_count = 1;
    memcpy(loads[1].force, t->force, sizeof loads[1].force);
    pel_sim_def def = pel_sim_def_default();
    def.model = s.model;
    def.solver.method = t->method;
    def.solver.dt = 0.01;
    def.loads = loads;
    def.load_count = 2;
    if (pel_sim_create(&def, &s.sim, &error) != PEL_OK || pel_sim_step(s.sim, &error) != PEL_OK)
        fail_msg("%s", error.what);
    /* after the last step the residual is zero */
    for (int i = 0; t->method == PEL_METHOD_STATIC && i < 2; i++)
        assert_int_equal(pel_sim_step(s.sim, &error), PEL_OK);
    s.x = calloc(3 * (size_t)s.mesh->vertex_count, sizeof *s.x);
    pel_sim_get_positions(s.sim, 0, s.x);
    s.value = function_of(s.mesh->vertex_count, s.x, NULL);
    return s;
}

static void release(solved *s)
{
    free(s->x);
    pel_sim_destroy(s->sim);
    pel_model_destroy(s->model);
    pel_mesh_destroy(s->mesh);
}

/* fourth order difference of the function by one number */
static double difference(const trial *t, double *number, double h)
{
    double f[4], kept = *number;
    static const double places[4] = {-2, -1, 1, 2};
    for (int i = 0; i < 4; i++) {
        *number = kept + places[i] * h;
        solved s = solve(t);
        f[i] = s.value;
        release(&s);
    }
    *number = kept;
    return (8 * (f[2] - f[1]) - (f[3] - f[0])) / (12 * h);
}

/* states of rest balance to 1e-6 of the forces, most of them better; steps in time to 1e-3 */
static void check_near(const trial *t, const char *name, double value, double expected, double scale)
{
    double tolerance = t->method == PEL_METHOD_STATIC ? 1e-6 : 2e-2;
    if (!(fabs(value - expected) <= tolerance * fmax(fabs(expected), scale)))
        fail_msg("%s: %.12g, by differences %.12g", name, value, expected);
}

/* by each third vertex; if all move alike, the solution moves along */
static void check_rest(trial *t, double (*moved)[3], size_t count, const double *gradient, const double *rest)
{
    double largest = 0, sums[3] = {0, 0, 0};
    for (size_t i = 0; i < 3 * count; i++) {
        largest = fmax(largest, fabs(rest[i]));
        sums[i % 3] += rest[i] - gradient[i];
    }
    t->positions = moved;
    for (size_t v = 0; v < count; v += 3)
        for (int c = 0; c < 3; c++)
            check_near(t, "rest", rest[3 * v + (size_t)c], difference(t, &moved[v][c], 1e-3), largest);
    for (int c = 0; c < 3; c++)
        assert_near(sums[c], 0, 1e-6 * largest);
}

static void check_trial(trial t)
{
    solved s = solve(&t);
    size_t count = (size_t)s.mesh->vertex_count;
    double *gradient = calloc(9 * count, sizeof *gradient), *forces = gradient + 3 * count, *rest = forces + 3 * count;
    double(*moved)[3] = calloc(count, sizeof *moved), loads[2], gravity[3];
    pel_adjoint_material material;
    function_of((int32_t)count, s.x, gradient);
    pel_adjoint def = {.positions = NULL};
    def.positions = gradient;
    def.forces = forces;
    def.rest_positions = t.has_hinges ? NULL : rest;
    def.loads = loads;
    def.gravity = gravity;
    def.materials = &material;
    pel_error error = {.status = PEL_OK};
    uint64_t before = pel_sim_hash(s.sim);
    if (pel_sim_adjoint(s.sim, &def, &error) != PEL_OK)
        fail_msg("%s", error.what);
    assert_true(before == pel_sim_hash(s.sim));
    memcpy(moved, s.mesh->positions, count * sizeof *moved);
    release(&s);

    check_near(&t, "young", material.young, t.young * difference(&t, &t.young, 4e-3 * t.young), 0);
    check_near(&t, "thickness", material.thickness, t.thickness * difference(&t, &t.thickness, 2e-3 * t.thickness), 0);
    /* of a plate if it is not given; given, it changes alone. In one step bending moves almost nothing */
    const double given = t.rigidity, plate = t.young * pow(t.thickness, 3) / (12 * (1 - t.poisson * t.poisson));
    const double rigidity = t.rigidity = given > 0 ? given : plate;
    if (t.method == PEL_METHOD_STATIC && (!t.is_woven || given > 0))
        check_near(&t, "bending", material.bending, rigidity * difference(&t, &t.rigidity, 1e-3 * rigidity), 0);
    t.rigidity = given;
    check_near(&t, "poisson", material.poisson, difference(&t, &t.poisson, 1e-3), 0);
    check_near(&t, "load", loads[0], t.load * difference(&t, &t.load, 2e-3 * t.load), 0);
    check_near(&t, "gravity", gravity[2], difference(&t, &t.gravity, 1e-2), 0);
    if (t.is_closed)
        check_near(&t, "pressure", material.pressure, t.pressure * difference(&t, &t.pressure, 2e-2 * t.pressure), 0);
    for (int c = 0; c < 3; c++)
        check_near(&t, "force", forces[21 + c], difference(&t, &t.force[c], 1e-2), fabs(forces[21]));
    if (t.method == PEL_METHOD_STATIC && !t.has_hinges)
        check_rest(&t, moved, count, gradient, rest);
    free(moved);
    free(gradient);
}

static const trial sheet = {.method = PEL_METHOD_STATIC,
                            .young = 1e4,
                            .poisson = 0.3,
                            .thickness = 0.05,
                            .load = 1.5,
                            .gravity = -2,
                            .force = {0.2, -0.1, 0.3}};

static void test_sheet(void **unused)
{
    (void)unused;
    if (sizeof(pel_real) == sizeof(float))
        skip(); /* differences of solutions in float tell three digits */
    check_trial(sheet);
}

/* a rigidity that is given does not follow Young's modulus, Poisson's ratio and thickness */
static void test_given_rigidity(void **unused)
{
    (void)unused;
    if (sizeof(pel_real) == sizeof(float))
        skip(); /* differences of solutions in float tell three digits */
    trial stiff = sheet;
    stiff.rigidity = 0.4;
    check_trial(stiff);
}

/* warp and weft, whose bending follows the moduli or is given */
static void test_woven_sheet(void **unused)
{
    (void)unused;
    if (sizeof(pel_real) == sizeof(float))
        skip(); /* differences of solutions in float tell three digits */
    trial woven = sheet;
    woven.is_woven = true;
    check_trial(woven);
    woven.rigidity = 0.4;
    check_trial(woven);
    woven.rigidity = 0;
    woven.has_hinges = true;
    solved s = solve(&woven);
    pel_adjoint_material material;
    double *gradient = calloc(3 * (size_t)s.mesh->vertex_count, sizeof *gradient);
    const pel_adjoint def = {.positions = gradient, .materials = &material};
    pel_error error;
    assert_int_equal(pel_sim_adjoint(s.sim, &def, &error), PEL_BAD_ARGUMENT);
    assert_non_null(strstr(error.what, "orthotropic"));
    free(gradient);
    release(&s);
}

/* hinges have no derivative by rest positions */
static void test_hinges(void **unused)
{
    (void)unused;
    if (sizeof(pel_real) == sizeof(float))
        skip(); /* differences of solutions in float tell three digits */
    trial hinges = sheet;
    hinges.has_hinges = true;
    check_trial(hinges);
}

static void test_ball(void **unused)
{
    (void)unused;
    if (sizeof(pel_real) == sizeof(float))
        skip(); /* differences of solutions in float tell three digits */
    trial ball = sheet;
    ball.is_closed = true;
    ball.pressure = 20;
    check_trial(ball);
}

/* one step in time; its start moves with the rest positions, which are not asked for */
static void test_step(void **unused)
{
    (void)unused;
    if (sizeof(pel_real) == sizeof(float))
        skip(); /* differences of solutions in float tell three digits */
    trial step = sheet;
    step.method = PEL_METHOD_IMPLICIT;
    check_trial(step);
}

/* each result alone is the one beside all others, to the bit */
static void test_each_alone(void **unused)
{
    (void)unused;
    trial ball = sheet;
    ball.is_closed = true;
    ball.pressure = 20;
    solved s = solve(&ball);
    size_t count = (size_t)s.mesh->vertex_count;
    double *results[2], *gradient = calloc(3 * count, sizeof *gradient);
    const size_t sizes[5] = {3 * count, 3 * count, 2, 3, sizeof(pel_adjoint_material) / sizeof(double)};
    size_t total = 0;
    for (int i = 0; i < 5; i++)
        total += sizes[i];
    for (int i = 0; i < 2; i++) {
        results[i] = malloc(total * sizeof *results[i]);
        for (size_t k = 0; k < total; k++)
            results[i][k] = i + 1; /* of no account */
    }
    function_of((int32_t)count, s.x, gradient);
    for (int only = -1; only < 5; only++) {
        double *places[5] = {NULL}, *place = results[only >= 0];
        for (int i = 0; i < 5; place += sizes[i++])
            places[i] = only < 0 || only == i ? place : NULL;
        pel_adjoint def = {.positions = NULL};
        def.positions = gradient;
        def.forces = places[0];
        def.rest_positions = places[1];
        def.loads = places[2];
        def.gravity = places[3];
        def.materials = (pel_adjoint_material *)places[4];
        assert_int_equal(pel_sim_adjoint(s.sim, &def, NULL), PEL_OK);
    }
    assert_memory_equal(results[0], results[1], total * sizeof *results[0]);
    double *at = results[0];
    for (int i = 0; i < 5; at += sizes[i++]) {
        double largest = 0;
        for (size_t k = 0; k < sizes[i]; k++)
            largest = fmax(largest, fabs(at[k]));
        assert_true(largest > 0);
    }
    free(results[0]);
    free(results[1]);
    free(gradient);
    release(&s);
}

static pel_status ask(const void *data, pel_error *error)
{
    const solved *s = data;
    double rest[3 * 64];
    pel_adjoint def = {.positions = NULL};
    def.positions = s->x;
    def.rest_positions = rest;
    return pel_sim_adjoint(s->sim, &def, error);
}

static void test_refusals(void **unused)
{
    (void)unused;
    solved s = solve(&sheet);
    pel_error error;
    pel_adjoint def = {.positions = NULL};
    assert_int_equal(pel_sim_adjoint(s.sim, &def, &error), PEL_BAD_ARGUMENT);
    assert_non_null(strstr(error.what, "positions is missing"));
    /* the first one makes a factor in double, which stays */
    assert_int_equal(ask(&s, &error), PEL_OK);
    assert_true(for_every_allocation_failure(ask, &s) >= 6);
    release(&s);
    /* a state that was loaded does not know the step that led to it */
    trial step = sheet;
    step.method = PEL_METHOD_IMPLICIT;
    s = solve(&step);
    size_t size = pel_sim_save_size(s.sim);
    void *bytes = malloc(size);
    pel_sim_save(s.sim, bytes);
    assert_int_equal(pel_sim_load(s.sim, bytes, size, NULL), PEL_OK);
    assert_int_equal(ask(&s, &error), PEL_BAD_ARGUMENT);
    assert_int_equal(pel_sim_step(s.sim, NULL), PEL_OK);
    assert_int_equal(ask(&s, &error), PEL_OK);
    free(bytes);
    release(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_sheet),      cmocka_unit_test(test_given_rigidity), cmocka_unit_test(test_woven_sheet),
        cmocka_unit_test(test_hinges),     cmocka_unit_test(test_ball),           cmocka_unit_test(test_step),
        cmocka_unit_test(test_each_alone), cmocka_unit_test(test_refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
