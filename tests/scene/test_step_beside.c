/* Steps of simulations beside each other: derivatives of their readings against differences of whole runs. */
#include "check.h"
#include "constraint/frame.h"
#include "math/vec3.h"
#include "minimise/step_newton.h"
#include "minimise/step_path.h"
#include "pellicle/scene.h"
#include "pellicle/sim_adjoint.h"
#include "pellicle/sim_ledger.h"
#include "pellicle/sim_surface.h"

#include <string.h>

/* differences of second order on both sides, of steps that are solved to rounding */
#define TOLERANCE 1e-5

static const char sheet[] =
    "version: 1\n"
    "bodies: [{name: body, mesh: {shape: grid, nx: 4, ny: 3, size_x: 0.4, size_y: 0.3}, mass: {per_vertex: 0.002},\n"
    "  membrane: {material: neo-hookean, young: 1.0e+4, poisson: 0.3, thickness: 0.01}, bending: {model: BENDING},\n"
    "  springs: {stiffness: 3, damping: 0.02}, volumetric: {stiffness: 0.01, damping: 0.03},\n"
    "  pinned: {box: {min: [-0.21, -1, -1], max: [-0.19, 1, 1]}},\n"
    "  supports: [{name: end, at: {box: {min: [0.19, -1, -1], max: [0.21, 1, 1]}}, fix: [z], displacement: [0, 0, "
    "0.01]}]}]\n"
    "loads: [{name: pull, force: [0.1, 0.05, 0.1], keys: [[0, 0], [0.05, 1]], at: {nearest: [0.2, 0.15, 0]}}]\n"
    "gravity: [0, 0, -2]\nsolver: {method: METHOD, dt: 0.01}\nduration: 1\n";
/* held by nothing, with a gas */
static const char ball[] =
    "version: 1\n"
    "bodies: [{name: body, mesh: {shape: geodesic-sphere, frequency: 2, radius: 0.1}, mass: {per_vertex: 0.002},\n"
    "  membrane: {material: neo-hookean, young: 1.0e+5, poisson: 0.4, thickness: 0.001},\n"
    "  bending: {model: BENDING}, pressure: {gas: {pressure: 900, outside: 700}}}]\n"
    "loads: [{name: up, force: [0, 0, 0.3], at: {nearest: [0, 0, 0.1]}},\n"
    "  {name: down, force: [0, 0, -0.3], at: {nearest: [0, 0, -0.1]}}]\n"
    "gravity: [0, 0, 0]\nsolver: {method: METHOD, dt: 0.004}\nduration: 1\n";

/* of a number, to both sides */
#define STEP 1e-4

enum { STEPS = 6, READINGS = 6 };

typedef struct stage {
    pel_scene *scene;
    pel_model *model;
    pel_sim *sim;
} stage;

/* words of a scene in capitals are filled in */
static void write_scene(const char *form, const char *bending, const char *method, char *text, size_t size)
{
    const char *const words[] = {"BENDING", "METHOD"}, *const values[] = {bending, method};
    size_t length = 0;
    while (*form != '\0' && length + 20 < size) {
        int found = -1;
        for (int w = 0; w < 2; w++)
            if (strncmp(form, words[w], strlen(words[w])) == 0)
                found = w;
        if (found < 0) {
            text[length++] = *form++;
            continue;
        }
        strcpy(text + length, values[found]);
        length += strlen(values[found]);
        form += strlen(words[found]);
    }
    text[length] = '\0';
}

static stage make(const char *text, const char *key, double value)
{
    stage s;
    pel_error error;
    char line[100], why[1000];
    const char *overrides[] = {line};
    snprintf(line, sizeof line, "%s=%.17g", key != NULL ? key : "", value);
    if (pel_scene_parse("test.yaml", text, strlen(text), overrides, key != NULL, NULL, &s.scene, &error) != PEL_OK)
        fail_msg("%s", pel_error_text(&error, why, sizeof why));
    assert_int_equal(pel_model_create(&s.scene->model, &s.model, &error), PEL_OK);
    pel_sim_def def = s.scene->sim;
    def.model = s.model;
    def.thread_count = 1;
    if (pel_sim_create(&def, &s.sim, &error) != PEL_OK)
        fail_msg("%s", pel_error_text(&error, why, sizeof why));
    return s;
}

static void end(stage *s)
{
    pel_sim_destroy(s->sim);
    pel_model_destroy(s->model);
    pel_scene_destroy(s->scene);
}

/* Errors of the state, of the path to it, and of solvers. Distances are compared: a free body at rest may turn. */
static void read(stage *s, double readings[READINGS])
{
    pel_sim_measures measures;
    pel_sim_ledger ledger;
    pel_support_reading support = {0};
    double x[100][3], sum = 0;
    assert_true(pel_sim_vertex_count(s->sim, 0) <= 100);
    pel_sim_measure(s->sim, &measures);
    pel_sim_get_ledger(s->sim, &ledger);
    pel_sim_get_support(s->sim, 0, &support);
    pel_sim_get_positions(s->sim, 0, x[0]);
    for (int v = 0; v < pel_sim_vertex_count(s->sim, 0); v++)
        sum += sin(1.7 * v) * pel_vec3_distance(x[v], x[0]);
    const double all[READINGS] = {sum,
                                  pel_sim_has_velocity(s->sim) ? measures.kinetic_energy : 0,
                                  measures.elastic_energy,
                                  ledger.work_loads,
                                  support.force[0],
                                  measures.volume};
    memcpy(readings, all, sizeof all);
}

/* whole steps solved to rounding, which differences of runs need */
static void run_alone(stage *s, double readings[READINGS])
{
    pel_error error;
    s->sim->part.can_halve = false;
    s->sim->minimise->newton->is_exact = pel_sim_has_velocity(s->sim);
    /* with the schemes of a simulation that others go beside: none in two stages */
    s->sim->minimise->newton->leads = pel_sim_has_velocity(s->sim);
    for (int i = 0; i < STEPS; i++)
        assert_int_equal(pel_sim_step(s->sim, &error), PEL_OK);
    read(s, readings);
}

/* differences of the readings over 2e-4 of the number */
static void run_beside(const char *text, const char *key, double value, double differences[READINGS])
{
    double readings[2][READINGS];
    stage lead = make(text, NULL, 0),
          sides[2] = {make(text, key, value - STEP * value), make(text, key, value + STEP * value)};
    pel_sim *sims[2] = {sides[0].sim, sides[1].sim};
    pel_error error;
    char why[1000];
    for (int i = 0; i < STEPS; i++)
        if (pel_sim_step_beside(lead.sim, sims, 2, &error) != PEL_OK)
            fail_msg("%s: %s", key, pel_error_text(&error, why, sizeof why));
    for (int side = 0; side < 2; side++) {
        read(&sides[side], readings[side]);
        end(&sides[side]);
    }
    end(&lead);
    for (int r = 0; r < READINGS; r++)
        differences[r] = readings[1][r] - readings[0][r];
}

static void check_key(const char *text, const char *key, double value)
{
    double found[READINGS], alone[2][READINGS];
    run_beside(text, key, value, found);
    for (int side = 0; side < 2; side++) {
        stage own = make(text, key, value * (side == 0 ? 1 - STEP : 1 + STEP));
        run_alone(&own, alone[side]);
        end(&own);
    }
    for (int r = 0; r < READINGS; r++) {
        /* error of solvers of states of rest */
        double expected = alone[1][r] - alone[0][r], noise = 1e-8 * fabs(alone[0][r]);
        if (!(fabs(found[r] - expected) <= TOLERANCE * fabs(expected) + noise))
            print_error("%s, reading %d\n", key, r);
        assert_near(found[r], expected, TOLERANCE * fabs(expected) + noise);
    }
}

/* a number of the scene by its key */
typedef struct key_value {
    const char *key;
    double value;
} key_value;

/* differences in float tell three digits */
#define skip_in_float()                                                                                                \
    do {                                                                                                               \
        if (sizeof(pel_real) == sizeof(float))                                                                         \
            skip();                                                                                                    \
    } while (0)

static void test_numbers_of_a_sheet(void **unused)
{
    (void)unused;
    skip_in_float();
    static const key_value keys[] = {{"bodies.body.membrane.young", 1e4},
                                     {"bodies.body.membrane.poisson", 0.3},
                                     {"bodies.body.springs.stiffness", 3},
                                     {"bodies.body.volumetric.stiffness", 0.01},
                                     {"loads.pull.force.2", 0.1},
                                     {"gravity.2", -2},
                                     {"bodies.body.supports.end.displacement.2", 0.01}};
    static const char *const own[] = {"bodies.body.mass.per_vertex", "bodies.body.springs.damping",
                                      "bodies.body.volumetric.damping"};
    static const double values[] = {0.002, 0.02, 0.03};
    char text[2000];
    for (int bending = 0; bending < 2; bending++)
        for (int method = 0; method < 2; method++) {
            write_scene(sheet, bending == 0 ? "midedge" : "hinge", method == 0 ? "static" : "implicit", text,
                        sizeof text);
            for (size_t k = 0; k < sizeof keys / sizeof *keys; k++)
                check_key(text, keys[k].key, keys[k].value);
            for (size_t k = 0; method == 1 && k < sizeof own / sizeof *own; k++)
                check_key(text, own[k], values[k]);
        }
}

static void test_numbers_of_a_free_ball(void **unused)
{
    (void)unused;
    skip_in_float();
    char text[2000];
    write_scene(ball, "hinge", "implicit", text, sizeof text);
    check_key(text, "bodies.body.membrane.young", 1e5);
    check_key(text, "bodies.body.pressure.gas.pressure", 900);
    check_key(text, "loads.up.force.2", 0.3);
}

/* A state of rest that nothing holds: with stiffness, pressures and loads all larger by one factor it is the same. */
static void test_factor_on_all_forces(void **unused)
{
    (void)unused;
    skip_in_float();
    static const key_value keys[] = {{"bodies.body.membrane.young", 1e5},
                                     {"bodies.body.pressure.gas.pressure", 900},
                                     {"bodies.body.pressure.gas.outside", 700}};
    char text[2000];
    double sum = 0, most = 0;
    write_scene(ball, "hinge", "static", text, sizeof text);
    /* without the loads */
    memcpy(strstr(text, "0.3]"), "0.0]", 4);
    memcpy(strstr(text, "-0.3]"), "-0.0]", 5);
    for (size_t k = 0; k < sizeof keys / sizeof *keys; k++) {
        double differences[READINGS];
        run_beside(text, keys[k].key, keys[k].value, differences);
        sum += differences[0];
        most = fmax(most, fabs(differences[0]));
    }
    assert_true(most > 1e-7);
    assert_near(sum, 0, TOLERANCE * most);
}

/* unsupported features are refused by name, before a step is taken */
static void test_refused(void **unused)
{
    (void)unused;
    static const struct {
        const char *method, *more, *words;
    } cases[] = {
        {"xpbd", "", "static and implicit"},
        {"implicit", "contact: {self: true, thickness: 0.001}\n", "contact"},
        {"static", "tools: [{name: probe, shape: sphere, radius: 0.01, motion: [{time: 0, position: [0, 0, 1]}]}]\n",
         "tools"},
    };
    char text[2000];
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        write_scene(ball, "hinge", cases[i].method, text, sizeof text);
        strcat(text, cases[i].more);
        stage lead = make(text, NULL, 0), side = make(text, NULL, 0);
        pel_error error = {0};
        assert_int_equal(pel_sim_step_beside(lead.sim, &side.sim, 1, &error), PEL_BAD_ARGUMENT);
        assert_non_null(strstr(error.what, cases[i].words));
        assert_int_equal(pel_sim_step_count(lead.sim), 0);
        end(&lead);
        end(&side);
    }
}

static void test_simulations_that_do_not_match(void **unused)
{
    (void)unused;
    char text[2000];
    pel_error error = {0};
    write_scene(ball, "hinge", "implicit", text, sizeof text);
    stage lead = make(text, NULL, 0), coarse = make(text, "bodies.body.mesh.frequency", 1),
          other = make(text, "solver.dt", 0.003), side = make(text, NULL, 0);
    assert_int_equal(pel_sim_step_beside(lead.sim, &coarse.sim, 1, &error), PEL_BAD_ARGUMENT);
    assert_int_equal(pel_sim_step_beside(lead.sim, &other.sim, 1, &error), PEL_BAD_ARGUMENT);
    assert_int_equal(pel_sim_step_beside(lead.sim, &lead.sim, 1, &error), PEL_BAD_ARGUMENT);
    assert_int_equal(pel_sim_step_beside(lead.sim, NULL, 0, &error), PEL_OK);
    /* it has taken a step less */
    assert_int_equal(pel_sim_step_beside(lead.sim, &side.sim, 1, &error), PEL_BAD_ARGUMENT);
    assert_int_equal(pel_sim_step_count(lead.sim), 1);
    stage *all[] = {&lead, &coarse, &other, &side};
    for (int i = 0; i < 4; i++)
        end(all[i]);
}

/* where a path has ended there is no step whose matrix another could take */
static void test_ended_path(void **unused)
{
    (void)unused;
    const char *text =
        "version: 1\n"
        "bodies: [{name: body, mesh: {shape: grid, nx: 4, ny: 3, size_x: 0.4, size_y: 0.3},\n"
        "  membrane: {material: neo-hookean, young: 1.0e+4, poisson: 0.3, thickness: 0.01}, bending: {model: hinge},\n"
        "  pinned: {box: {min: [-0.21, -1, -1], max: [-0.19, 1, 1]}}}]\n"
        "loads: [{force: [1, 0, 0], at: {nearest: [0.2, 0.15, 0]}}]\n"
        "solver: {method: static, path: arc-length}\n";
    pel_error error = {0};
    stage lead = make(text, NULL, 0), side = make(text, NULL, 0);
    lead.sim->path->ended = PEL_PATH_END_FULL_LOAD;
    assert_int_equal(pel_sim_step_beside(lead.sim, &side.sim, 1, &error), PEL_BAD_ARGUMENT);
    side.sim->path->ended = PEL_PATH_END_FULL_LOAD;
    assert_int_equal(pel_sim_step_beside(lead.sim, &side.sim, 1, &error), PEL_OK);
    end(&lead);
    end(&side);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_numbers_of_a_sheet),
        cmocka_unit_test(test_numbers_of_a_free_ball),
        cmocka_unit_test(test_factor_on_all_forces),
        cmocka_unit_test(test_refused),
        cmocka_unit_test(test_simulations_that_do_not_match),
        cmocka_unit_test(test_ended_path),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
