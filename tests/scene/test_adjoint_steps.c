/* Derivatives of functions of steps in time against differences of whole paths. */
#include "check.h"

#include "base/wide.h"
#include "constraint/frame.h"
#include "failing_malloc.h"
#include "minimise/step_newton.h"
#include "pellicle/live.h"
#include "pellicle/scene.h"
#include "pellicle/sim_adjoint.h"
#include "pellicle/sim_surface.h"

#include <stdlib.h>

/* Differences of fourth order of paths that are solved to 1e-10 of their forces: remaining error. */
#define TOLERANCE 1e-5

static const char strip[] =
    "version: 1\n"
    "bodies: [{name: body, mesh: {shape: grid, nx: 5, ny: 2, size_x: 0.5, size_y: 0.2}, mass: {per_vertex: 0.002},\n"
    "  membrane: {material: stvk, young: 1.0e+4, poisson: 0.3, thickness: 0.01}, bending: {model: midedge},\n"
    "  velocity: [0, 0, 0.3], angular_velocity: [1, 2, 0]}]\n"
    "loads: [{name: pull, force: [0.1, 0.05, 0.1], until: 0.031, at: {nearest: [0.25, 0.1, 0]}}]\n"
    "gravity: [0, 0, 0]\nsolver: {method: implicit, dt: 0.01}\nduration: 1\n";
/* held at an edge and on springs at the other, pressed from below, in drag: BDF2 from the second step on */
static const char cloth[] =
    "version: 1\n"
    "bodies: [{name: body, mesh: {shape: grid, nx: 4, ny: 3, size_x: 0.4, size_y: 0.3}, mass: {per_vertex: 0.002},\n"
    "  membrane: {material: neo-hookean, young: 1.0e+4, poisson: 0.3, thickness: 0.01}, bending: {model: midedge},\n"
    "  pinned: {box: {min: [-0.21, -1, -1], max: [-0.19, 1, 1]}},\n"
    "  supports: [{name: end, at: {box: {min: [0.19, -1, -1], max: [0.21, 1, 1]}}, fix: [z], stiffness: 5}]}]\n"
    "loads: [{name: pull, force: [0.1, 0.05, 0.1], keys: [[0, 0], [0.05, 1]], at: {nearest: [0.2, 0.15, 0]}}]\n"
    "gravity: [0, 0, -2]\nsolver: {method: implicit, dt: 0.01, drag: 3}\nduration: 1\n";
static const char gas[] =
    "version: 1\n"
    "bodies: [{name: body, mesh: {shape: geodesic-sphere, frequency: 2, radius: 0.1}, mass: {per_vertex: 0.002},\n"
    "  membrane: {material: neo-hookean, young: 1.0e+5, poisson: 0.4, thickness: 0.001},\n"
    "  bending: {model: midedge}, pressure: {gas: {pressure: 900, outside: 500}}}]\n"
    "loads: [{name: pull, force: [0.3, 0.05, 0.1], at: {nearest: [0.1, 0, 0]}}]\n"
    "gravity: [0, 0, -2]\nsolver: {method: implicit, dt: 0.004}\nduration: 1\n";
/* hinges and springs of paper A, damped and not in potentials of shells alone */
static const char springs[] =
    "version: 1\n"
    "bodies: [{name: body, mesh: {shape: geodesic-sphere, frequency: 2, radius: 0.1}, mass: {per_vertex: 0.002},\n"
    "  membrane: {material: stvk, young: 1.0e+4, poisson: 0.3, thickness: 0.001}, bending: {model: hinge},\n"
    "  springs: {stiffness: 3, damping: 0.02}, pressure: {inside: 30}}]\n"
    "loads: [{name: pull, force: [0.02, 0.01, 0.01], at: {nearest: [0.1, 0, 0]}}]\n"
    "gravity: [0, 0, -2]\nsolver: {method: implicit, dt: 0.004}\nduration: 1\n";
/* turns too fast for its steps, with a pinned corner: two stages */
static const char flap[] =
    "version: 1\n"
    "bodies: [{name: body, mesh: {shape: grid, nx: 5, ny: 2, size_x: 0.5, size_y: 0.2}, mass: {per_vertex: 0.002},\n"
    "  membrane: {material: stvk, young: 1.0e+5, poisson: 0.3, thickness: 0.01}, bending: {model: midedge},\n"
    "  pinned: {vertices: [0]}, velocity: [0, 0, 1], angular_velocity: [5, 10, 0]}]\n"
    "loads: [{name: pull, force: [0.1, 0.05, 0.1], until: 0.031, at: {nearest: [0.25, 0.1, 0]}}]\n"
    "gravity: [0, 0, -2]\nsolver: {method: implicit, dt: 0.01}\nduration: 1\n";

enum { STEPS = 11 };

/* a function of positions and velocities, that of the last step or the sum over all steps */
typedef struct trial {
    const char *scene;
    bool is_running;
    int64_t steps;
    double value;
    bool is_still;      /* without the velocities */
    double moved[2][3]; /* added to position and velocity of vertex 4 where the steps begin */
} trial;

static bool gradient(void *user, const pel_adjoint_point *point)
{
    trial *t = user;
    (void)point->step;
    for (size_t i = 0; i < 15; i++) {
        double w = sin(1.7 * (double)i + 0.3), x = point->positions[i];
        double v = t->is_still ? 0 : point->velocities[i];
        t->value += w * x + 3 * x * x + 0.01 * w * v * v;
        point->by_positions[i] = w + 6 * x;
        point->by_velocities[i] = 0.02 * w * v;
    }
    return true;
}

typedef struct stage {
    pel_scene *scene;
    pel_model *model;
    pel_sim *sim;
    int32_t count; /* vertices */
} stage;

static stage make(const trial *t, const char *override)
{
    stage s;
    pel_error error;
    char text[1000];
    pel_status status =
        pel_scene_parse("test.yaml", t->scene, strlen(t->scene), &override, override != NULL, NULL, &s.scene, &error);
    if (status != PEL_OK)
        fail_msg("%s", pel_error_text(&error, text, sizeof text));
    assert_int_equal(pel_model_create(&s.scene->model, &s.model, &error), PEL_OK);
    pel_sim_def def = s.scene->sim;
    def.model = s.model;
    def.thread_count = 1;
    if (pel_sim_create(&def, &s.sim, &error) != PEL_OK)
        fail_msg("%s", pel_error_text(&error, text, sizeof text));
    s.count = pel_sim_vertex_count(s.sim, 0);
    double *x = calloc(6 * (size_t)s.count, sizeof *x), *v = x + 3 * (size_t)s.count;
    pel_sim_get_positions(s.sim, 0, x);
    pel_sim_get_velocities(s.sim, 0, v);
    for (int k = 0; k < 3; k++) {
        x[12 + k] += t->moved[0][k];
        v[12 + k] += t->moved[1][k];
    }
    assert_int_equal(pel_sim_set_positions(s.sim, 0, x, &error), PEL_OK);
    assert_int_equal(pel_sim_set_velocities(s.sim, 0, v, &error), PEL_OK);
    free(x);
    return s;
}

static void end(stage *s)
{
    pel_sim_destroy(s->sim);
    pel_model_destroy(s->model);
    pel_scene_destroy(s->scene);
}

static pel_status solve(trial *t, stage *s, pel_adjoint_steps def, pel_error *error)
{
    t->value = 0;
    def.step_count = t->steps;
    def.gradient = gradient;
    def.user = t;
    def.is_running = t->is_running;
    return pel_sim_adjoint_steps(s->sim, &def, error);
}

static double value_of(trial *t, const char *override)
{
    pel_error error;
    char text[1000];
    stage s = make(t, override);
    if (solve(t, &s, (pel_adjoint_steps){.step_count = 0}, &error) != PEL_OK)
        fail_msg("%s: %s", override, pel_error_text(&error, text, sizeof text));
    end(&s);
    return t->value;
}

static double fourth_order(const double f[4], double h)
{
    return (8 * (f[2] - f[1]) - (f[3] - f[0])) / (12 * h);
}

static const double places[4] = {-2, -1, 1, 2};

/* by a factor on a number of the scene, whose value stands between the two parts of an override */
static double by_factor(trial *t, const char *path, double number, const char *rest, double h)
{
    double f[4];
    char override[300];
    for (int i = 0; i < 4; i++) {
        snprintf(override, sizeof override, "%s%.17g%s", path, number * (1 + places[i] * h), rest);
        f[i] = value_of(t, override);
    }
    return fourth_order(f, h);
}

static double by_start(trial *t, int which, int k, double h)
{
    double f[4];
    for (int i = 0; i < 4; i++) {
        t->moved[which][k] = places[i] * h;
        f[i] = value_of(t, NULL);
    }
    t->moved[which][k] = 0;
    return fourth_order(f, h);
}

static void check_near(const char *name, double value, double expected, double scale)
{
    if (!(fabs(value - expected) <= TOLERANCE * fmax(fabs(expected), scale)))
        fail_msg("%s: %.12g, by differences %.12g", name, value, expected);
}

/* requested derivatives, of one body with fewer than 64 vertices and one load */
typedef struct answer {
    double forces[192], rest[192], start[192], velocities[192], load, gravity[3];
    pel_adjoint_material material;
} answer;

static void find(trial *t, bool with_rest, answer *found)
{
    pel_error error;
    char text[1000];
    stage s = make(t, NULL);
    pel_adjoint_steps def = {.step_count = 0};
    assert_true(s.count <= 64);
    def.results.forces = found->forces;
    def.results.rest_positions = with_rest ? found->rest : NULL;
    def.results.loads = &found->load;
    def.results.gravity = found->gravity;
    def.results.materials = &found->material;
    def.start_positions = found->start;
    def.start_velocities = found->velocities;
    if (solve(t, &s, def, &error) != PEL_OK)
        fail_msg("%s", pel_error_text(&error, text, sizeof text));
    assert_int_equal(pel_sim_step_count(s.sim), t->steps);
    end(&s);
}

/* differences of paths in float tell three digits */
static void skip_in_float(void)
{
    if (sizeof(pel_real) == sizeof(float))
        skip();
}

static double largest(const double *values)
{
    double most = 0;
    for (int i = 0; i < 192; i++)
        most = fmax(most, fabs(values[i]));
    return most;
}

/* the numbers of a scene that its derivatives are checked for; 0 = not */
typedef struct numbers {
    double young, poisson, thickness, gravity, pressure, load[3];
} numbers;

static void check_common(trial *t, const numbers *n, const answer *found)
{
    static const char membrane[] = "bodies.body.membrane.";
    char path[100];
    double sum = 0;
    snprintf(path, sizeof path, "%syoung=", membrane);
    check_near("young", found->material.young, by_factor(t, path, n->young, "", 1e-3), 0);
    snprintf(path, sizeof path, "%sthickness=", membrane);
    check_near("thickness", found->material.thickness, by_factor(t, path, n->thickness, "", 1e-3), 0);
    snprintf(path, sizeof path, "%spoisson=", membrane);
    check_near("poisson", found->material.poisson * n->poisson, by_factor(t, path, n->poisson, "", 1e-3), 0);
    if (n->gravity != 0)
        check_near("gravity", found->gravity[2] * n->gravity, by_factor(t, "gravity=[0, 0, ", n->gravity, "]", 1e-3),
                   0);
    if (n->pressure != 0)
        check_near("pressure", found->material.pressure,
                   by_factor(t, "bodies.body.pressure.inside=", n->pressure, "", 1e-3), 0);
    for (int k = 0; k < 3; k++) {
        snprintf(path, sizeof path, "loads.pull.force.%d=", k);
        sum += by_factor(t, path, n->load[k], "", 1e-3);
    }
    check_near("load", found->load, sum, 0);
    for (int k = 0; k < 3; k++) {
        check_near("start", found->start[12 + k], by_start(t, 0, k, 1e-5), largest(found->start));
        check_near("start velocity", found->velocities[12 + k], by_start(t, 1, k, 1e-3), largest(found->velocities));
    }
}

/* of the last state, or of the sum over all steps (is_running); make nightly: of both */
static void check_paths(const char *scene, const numbers *n, bool with_rest, bool is_running)
{
    static answer found;
    skip_in_float();
    for (int running = LONG(0, is_running); running <= LONG(1, is_running); running++) {
        trial t = {.scene = scene, .steps = STEPS, .is_running = running > 0};
        find(&t, with_rest, &found);
        /* differences take some 30 paths */
        if (!is_slow())
            check_common(&t, n, &found);
    }
}

static void test_strip(void **unused)
{
    (void)unused;
    check_paths(strip, &(numbers){.young = 1e4, .poisson = 0.3, .thickness = 0.01, .load = {0.1, 0.05, 0.1}}, true,
                false);
}

static void test_flap(void **unused)
{
    (void)unused;
    numbers n = {.young = 1e5, .poisson = 0.3, .thickness = 0.01, .gravity = -2, .load = {0.1, 0.05, 0.1}};
    check_paths(flap, &n, true, true);
}

/* steps of the sequence are those of pel_sim_step, but for the tolerance of these: in two stages too */
static void test_stages(void **unused)
{
    (void)unused;
    pel_error error;
    trial t = {.scene = flap, .steps = STEPS};
    stage sequence = make(&t, NULL), usual = make(&t, NULL);
    double x[192], y[192], most = 0;
    int in_stages = 0;
    assert_int_equal(solve(&t, &sequence, (pel_adjoint_steps){.step_count = 0}, &error), PEL_OK);
    for (int i = 0; i < STEPS; i++) {
        assert_int_equal(pel_sim_step(usual.sim, &error), PEL_OK);
        in_stages += usual.sim->minimise->newton->scheme->first != NULL;
    }
    pel_sim_get_positions(sequence.sim, 0, x);
    pel_sim_get_positions(usual.sim, 0, y);
    for (int32_t i = 0; i < 3 * usual.count; i++)
        most = fmax(most, fabs(x[i] - y[i]));
    assert_true(in_stages > STEPS / 2 && most < 1e-5);
    end(&sequence);
    end(&usual);
}

/* pel_sim_adjoint after a step in two stages, and the sequence of that step alone */
static void test_last_step(void **unused)
{
    (void)unused;
    pel_error error;
    static answer found;
    trial t = {.scene = flap, .steps = 1, .is_still = true};
    skip_in_float();
    find(&t, false, &found);
    stage s = make(&t, NULL);
    double x[192], by[192] = {0}, load, gravity[3];
    pel_adjoint_material material;
    assert_int_equal(pel_sim_step(s.sim, &error), PEL_OK);
    assert_non_null(s.sim->minimise->newton->scheme->first);
    pel_sim_get_positions(s.sim, 0, x);
    for (int i = 0; i < 15; i++)
        by[i] = sin(1.7 * (double)i + 0.3) + 6 * x[i];
    pel_adjoint def = {.positions = by, .loads = &load, .gravity = gravity, .materials = &material};
    assert_int_equal(pel_sim_adjoint(s.sim, &def, &error), PEL_OK);
    end(&s);
    check_near("young", material.young, found.material.young, 0);
    check_near("load", load, found.load, 0);
    check_near("gravity", gravity[2], found.gravity[2], 0);
}

static void test_cloth(void **unused)
{
    (void)unused;
    numbers n = {.young = 1e4, .poisson = 0.3, .thickness = 0.01, .gravity = -2, .load = {0.1, 0.05, 0.1}};
    check_paths(cloth, &n, true, true);
}

static void test_gas(void **unused)
{
    (void)unused;
    numbers n = {.young = 1e5, .poisson = 0.4, .thickness = 0.001, .gravity = -2, .load = {0.3, 0.05, 0.1}};
    check_paths(gas, &n, false, false);
}

static void test_springs(void **unused)
{
    (void)unused;
    numbers n = {.young = 1e4, .poisson = 0.3, .thickness = 0.001, .gravity = -2, .load = {0.02, 0.01, 0.01}};
    n.pressure = 30;
    check_paths(springs, &n, false, true);
}

/* A factor on all positions at rest, from which the steps begin: held vertices move with them. */
static void test_rest_positions(void **unused)
{
    (void)unused;
    static answer found;
    skip_in_float();
    double sum = 0, x[192];
    trial t = {.scene = cloth, .steps = STEPS, .is_running = true};
    find(&t, true, &found);
    stage s = make(&t, NULL);
    pel_sim_get_positions(s.sim, 0, x);
    for (int32_t i = 0; i < 3 * s.count; i++)
        sum += x[i] * (found.rest[i] + found.start[i]);
    end(&s);
    check_near("rest", sum, by_factor(&t, "bodies.body.mesh.scale=", 1, "", 1e-4), 0);
}

/* ---- any number of steps; state afterwards ---- */

static void test_intervals(void **unused)
{
    (void)unused;
    pel_error error;
    answer all, parts;
    trial t = {.scene = cloth, .steps = 7, .is_running = false};
    find(&t, false, &all);
    /* two steps after five are the last two of seven: the state where they begin is the same */
    stage s = make(&t, NULL);
    t.steps = 5;
    assert_int_equal(solve(&t, &s, (pel_adjoint_steps){.step_count = 0}, &error), PEL_OK);
    t.steps = 2;
    double value = t.value;
    pel_adjoint_steps def = {.step_count = 0};
    def.results.gravity = parts.gravity;
    assert_int_equal(solve(&t, &s, def, &error), PEL_OK);
    assert_true(t.value != value && pel_sim_step_count(s.sim) == 7);
    uint64_t hash = pel_sim_hash(s.sim);
    end(&s);
    t.steps = 7;
    s = make(&t, NULL);
    assert_int_equal(solve(&t, &s, (pel_adjoint_steps){.step_count = 0}, &error), PEL_OK);
    assert_true(pel_sim_hash(s.sim) == hash);
    assert_true(fabs(parts.gravity[2]) < fabs(all.gravity[2]) && parts.gravity[2] != 0);
    end(&s);
}

static bool stop_at_three(void *user, const pel_adjoint_point *point)
{
    (void)user;
    return point->step != 3;
}

static void check_refusal(const char *scene, const char *override, const char *what)
{
    pel_error error;
    trial t = {.scene = scene, .steps = 3};
    stage s = make(&t, override);
    uint64_t before = pel_sim_hash(s.sim);
    assert_int_equal(solve(&t, &s, (pel_adjoint_steps){.step_count = 0}, &error), PEL_BAD_ARGUMENT);
    if (strstr(error.what, what) == NULL)
        fail_msg("'%s' does not say '%s'", error.what, what);
    assert_true(error.remedy[0] != '\0' && pel_sim_hash(s.sim) == before);
    end(&s);
}

static void test_refusals(void **unused)
{
    (void)unused;
    pel_error error;
    check_refusal(springs, "solver.method=xpbd", "method implicit");
    check_refusal(cloth, "contact={}", "without tools and contact");
    check_refusal(cloth, "solver.budget=5", "budget");
    check_refusal(springs, "bodies.body.volumetric={stiffness: 1, damping: 1}", "damping of volumetric springs");
    check_refusal(strip, "bodies.body.anisotropy=[{mode: active, rest_length: 0.9, direction: principal}]",
                  "principal");
    check_refusal(gas, "bodies.body.pressure={inside: 1, form: vertex-normal}", "potential");
    /* one that goes too far in a step, done to rounding in few iterations */
    check_refusal(cloth, "solver.iterations=1", "does not converge");
    trial t = {.scene = cloth, .steps = 4};
    stage s = make(&t, NULL);
    uint64_t before = pel_sim_hash(s.sim);
    pel_adjoint_steps def = {.step_count = 5, .gradient = stop_at_three, .is_running = true};
    assert_int_equal(pel_sim_adjoint_steps(s.sim, &def, &error), PEL_STOPPED);
    assert_true(pel_sim_hash(s.sim) == before);
    def.step_count = 0;
    assert_int_equal(pel_sim_adjoint_steps(s.sim, &def, &error), PEL_BAD_ARGUMENT);
    end(&s);
}

typedef struct question {
    trial t;
    stage s;
} question;

static pel_status ask_case(const void *data, pel_error *error)
{
    question q = *(const question *)data;
    double rest[192];
    pel_adjoint_steps def = {.step_count = 0};
    def.results.rest_positions = rest;
    return solve(&q.t, &q.s, def, error);
}

static void test_memory(void **unused)
{
    (void)unused;
    question q = {.t = {.scene = cloth, .steps = 3}};
    q.s = make(&q.t, NULL);
    /* the first one makes a factor in double, which stays */
    assert_int_equal(ask_case(&q, NULL), PEL_OK);
    assert_true(for_every_allocation_failure(ask_case, &q) >= 15);
    end(&q.s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_strip),          cmocka_unit_test(test_flap),      cmocka_unit_test(test_stages),
        cmocka_unit_test(test_last_step),      cmocka_unit_test(test_cloth),     cmocka_unit_test(test_gas),
        cmocka_unit_test(test_springs),        cmocka_unit_test(test_intervals), cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_rest_positions), cmocka_unit_test(test_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
