/* Loads that are refused, each with its number and defect. */
#include "model/model.h"
#include "pellicle/base.h"
#include "pellicle/mesh.h"
#include "pellicle/model.h"
#include "pellicle/shape.h"
#include "pellicle/sim_ledger.h"
#include "sim/fixture.h"

/* change of a good load in a case */
typedef enum fault {
    FAULT_NONE,
    BODY_BELOW,
    BODY_BEYOND,
    KIND_UNKNOWN,
    VERTICES_BELOW,
    KEYS_BELOW,
    KEYS_NULL,
    FORCE_INFINITE,
    FROM_NAN,
    UNTIL_NAN,
    NO_TIME,
    BACKWARDS,
    NO_VERTEX,
    VERTEX_BELOW,
    VERTEX_BEYOND,
    WEIGHT_NAN,
    KEY_TIME,
    KEY_VALUE,
    KEYS_AT_ONCE,
    NO_BOUNDARY,
    FAULT_COUNT
} fault;

static const char *const messages[FAULT_COUNT] = {
    [BODY_BELOW] = "names a body",      [BODY_BEYOND] = "names a body",     [KIND_UNKNOWN] = "kind of the load",
    [VERTICES_BELOW] = "below 0",       [KEYS_BELOW] = "below 0",           [KEYS_NULL] = "keys is null",
    [FORCE_INFINITE] = "force is not",  [FROM_NAN] = "before it begins",    [UNTIL_NAN] = "before it begins",
    [NO_TIME] = "before it begins",     [BACKWARDS] = "before it begins",   [NO_VERTEX] = "acts on no vertex",
    [VERTEX_BELOW] = "names a vertex",  [VERTEX_BEYOND] = "names a vertex", [WEIGHT_NAN] = "weight is not",
    [KEY_TIME] = "keys are not finite", [KEY_VALUE] = "keys are not",       [KEYS_AT_ONCE] = "not in order",
    [NO_BOUNDARY] = "no boundary edge",
};

typedef struct arrays {
    int32_t vertices[2];
    double weights[2];
    pel_key keys[2];
} arrays;

/* place: of the vertex, its weight or the key */
static void break_load(fault what, int place, pel_load_def *load, arrays *a, int32_t vertex_count)
{
    const double nothing = (double)NAN;
    switch (what) {
    case BODY_BELOW:
        load->body = -1;
        break;
    case BODY_BEYOND:
        load->body = 1;
        break;
    case KIND_UNKNOWN:
        load->kind = (pel_load_kind)99;
        break;
    case VERTICES_BELOW:
        load->vertex_count = -1;
        break;
    case KEYS_BELOW:
        load->key_count = -1;
        break;
    case KEYS_NULL:
        load->keys = NULL;
        break;
    case FORCE_INFINITE:
        load->force[2] = (double)INFINITY;
        break;
    case FROM_NAN:
        load->from = nothing;
        break;
    case UNTIL_NAN:
        load->until = nothing;
        break;
    case NO_TIME:
        load->until = load->from;
        break;
    case BACKWARDS:
        load->until = load->from - 1;
        break;
    case NO_VERTEX:
        load->vertex_count = 0;
        break;
    case VERTEX_BELOW:
        a->vertices[place] = -1;
        break;
    case VERTEX_BEYOND:
        a->vertices[place] = vertex_count;
        break;
    case WEIGHT_NAN:
        a->weights[place] = nothing;
        break;
    case KEY_TIME:
        a->keys[place].time = (double)INFINITY;
        break;
    case KEY_VALUE:
        a->keys[place].value = nothing;
        break;
    case KEYS_AT_ONCE:
        a->keys[1].time = a->keys[0].time;
        break;
    case NO_BOUNDARY:
        load->kind = PEL_LOAD_PER_LENGTH;
        break;
    default:
        break;
    }
}

/* the second of two loads is at fault: it is named */
static void test_refusals(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_sphere(3);
    pel_body_def body = ball_body(mesh);
    pel_model *model = make_model(&body);
    for (int i = 2 * FAULT_NONE; i < 2 * FAULT_COUNT; i++) {
        const int f = i / 2;
        arrays a = {{3, 4}, {1, 2}, {{0, 1}, {1, 2}}};
        pel_load_def loads[2] = {pel_load_def_default(), pel_load_def_default()};
        loads[1].vertices = a.vertices;
        loads[1].weights = a.weights;
        loads[1].vertex_count = 2;
        loads[1].keys = a.keys;
        loads[1].key_count = 2;
        loads[1].force[0] = loads[0].force[0] = 1;
        break_load((fault)f, i % 2, &loads[1], &a, mesh->vertex_count);
        pel_sim_def def = pel_sim_def_default();
        def.model = model;
        def.loads = loads;
        def.load_count = 2;
        check_refusal(&def, f, messages[f], "load");
    }
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

/* edges of a body that refines come and go */
static void test_edges_of_what_refines(void **unused)
{
    (void)unused;
    pel_shape_def shape = pel_shape_def_default(PEL_SHAPE_GRID);
    pel_mesh *mesh;
    shape.nx = shape.ny = 3;
    assert_int_equal(pel_shape_create(&shape, &mesh, NULL), PEL_OK);
    for (int levels = 0; levels < 2; levels++) {
        pel_body_def body = ball_body(mesh);
        body.refine.levels = levels;
        pel_model *model = make_model(&body);
        pel_load_def load = pel_load_def_default();
        load.kind = PEL_LOAD_PER_LENGTH;
        load.force[2] = 1;
        pel_sim_def def = pel_sim_def_default();
        def.model = model;
        def.loads = &load;
        def.load_count = 1;
        check_refusal(&def, levels, levels == 0 ? NULL : "load on edges of a body that refines", NULL);
        pel_model_destroy(model);
    }
    pel_mesh_destroy(mesh);
}

/* ---- impulses ---- */

typedef struct pulse {
    double until;
    pel_key keys[3];
    int32_t key_count;
    double impulse; /* s */
} pulse;

static const pulse pulses[] = {
    {.until = 0.02, .impulse = 0.02},
    {.until = 0.004, .impulse = 0.004},
    {.until = HUGE_VAL, .keys = {{0, 0}, {0.004, 1}, {0.008, 0}}, .key_count = 3, .impulse = 0.004},
    {.until = HUGE_VAL, .keys = {{0.012, 0}, {0.015, 1}, {0.018, 0}}, .key_count = 3, .impulse = 0.003},
    {.until = 0.055, .impulse = 0.055},
};

static stage make_card(pel_method method, double dt, bool has_shell, bool has_tool, const pulse *at)
{
    stage s = {0};
    pel_shape_def shape = pel_shape_def_default(PEL_SHAPE_GRID);
    shape.nx = shape.ny = 4;
    assert_int_equal(pel_shape_create(&shape, &s.mesh, NULL), PEL_OK);
    pel_body_def body = ball_body(s.mesh);
    body.mass_kind = PEL_MASS_TOTAL;
    body.mass = 0.5;
    body.spring_damping.value = body.volumetric_stiffness.value = body.volumetric_damping.value = 0;
    if (has_shell) {
        body.spring_stiffness.value = 0;
        body.shell.membrane.on = true;
        body.shell.membrane.young.value = 100;
        body.shell.membrane.thickness.value = 0.01;
    }
    s.model = make_model(&body);
    pel_load_def load = pel_load_def_default();
    load.kind = PEL_LOAD_TOTAL;
    load.force[1] = 10;
    load.until = at->until;
    load.keys = at->keys;
    load.key_count = at->key_count;
    pel_sim_def def = lone_sim(s.model, method, dt);
    def.loads = &load;
    def.load_count = 1;
    /* implicit: takes the scheme that there is beside tools */
    const pel_pose_key key = {0, {0, 0, 50}, {0, 0, 0, 1}, {0}};
    pel_tool_def tool = pel_tool_def_default();
    tool.name = "far";
    tool.radius = 1;
    tool.keys = &key;
    tool.key_count = 1;
    def.tools = &tool;
    def.tool_count = has_tool;
    s.sim = make_sim(&def);
    return s;
}

/* A free body has the impulse of a load, and its energy, whatever the step: the work of a constant force to the last
   digit, that of another one up to the step in which it changes. */
static void check_impulse(pel_method method, double dt, bool has_shell, bool has_tool, const pulse *at)
{
    stage s = make_card(method, dt, has_shell, has_tool, at);
    double before[3 * 25], after[3 * 25], speed = 20 * at->impulse, way = 0;
    int count = (int)(0.06 / dt) + 20;
    run_steps(s.sim, count);
    pel_sim_get_positions(s.sim, 0, before);
    run_steps(s.sim, 10);
    pel_sim_get_positions(s.sim, 0, after);
    for (int v = 0; v < 25; v++)
        way += (after[3 * v + 1] - before[3 * v + 1]) / 25;
    assert_near(way / (10 * dt), speed, 1e-3 * speed);
    pel_sim_ledger ledger;
    pel_sim_get_ledger(s.sim, &ledger);
    assert_near(ledger.kinetic, 0.25 * speed * speed, 2e-3 * 0.25 * speed * speed);
    if (!has_tool && at->key_count == 0 && at->until > 0.01)
        assert_near(ledger.work_loads, ledger.kinetic, 0.02 * ledger.kinetic);
    assert_true(ledger.energy_error <= ledger.tolerance);
    end_stage(&s);
}

static void test_impulses(void **unused)
{
    (void)unused;
    static const double steps[] = {0.002, 0.01, 0.015, 0.03};
    static const pel_method methods[] = {PEL_METHOD_PBD, PEL_METHOD_XPBD, PEL_METHOD_IMPLICIT};
    for (size_t p = 0; p < sizeof pulses / sizeof *pulses; p++) {
        for (size_t i = 0; i < sizeof steps / sizeof *steps; i++)
            for (size_t m = 0; m < sizeof methods / sizeof *methods; m++)
                for (int has_tool = 0; has_tool < 2; has_tool++)
                    check_impulse(methods[m], steps[i], true, has_tool, &pulses[p]);
        for (int has_shell = 0; has_shell < 2; has_shell++) {
            check_impulse(PEL_METHOD_EXPLICIT, 0.0003, has_shell, false, &pulses[p]);
            check_impulse(PEL_METHOD_EXPLICIT, 0.0007, has_shell, false, &pulses[p]);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_refusals), cmocka_unit_test(test_edges_of_what_refines),
                                       cmocka_unit_test(test_impulses)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
