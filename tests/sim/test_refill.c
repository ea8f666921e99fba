/* Other numbers in a simulation at its start: every parameter of bodies and the solver, by itself and one after the
   other, gives the snapshot of a simulation that was created with them, then and some steps later. What cannot be taken
   over is refused. */
#include "failing_malloc.h"
#include "model/model.h"
#include "sim/fixture.h"
#include "sim/parameter.h"
#include "sim/sim.h"
#include "sim/snapshot.h"

enum { STEPS = 5, VALUES = 5 };

typedef struct setup {
    const char *name;
    pel_mass_kind mass_kind;
    bool by_area, has_depth, has_thickness, turns, is_shell, has_tool, is_bare; /* bare: no springs in the first body */
    pel_method method;
    bool keeps_velocity;
} setup;

static const setup setups[] = {
    {.name = "quasi-static", .method = PEL_METHOD_QUASI_STATIC, .is_bare = true},
    {.name = "velocities kept", .method = PEL_METHOD_QUASI_STATIC, .keeps_velocity = true, .by_area = true},
    {.name = "filled", .method = PEL_METHOD_QUASI_STATIC, .mass_kind = PEL_MASS_TOTAL, .has_depth = true},
    {.name = "explicit", .method = PEL_METHOD_EXPLICIT, .mass_kind = PEL_MASS_DENSITY},
    {.name = "turning", .method = PEL_METHOD_EXPLICIT, .mass_kind = PEL_MASS_TOTAL, .turns = true},
    {.name = "springs by young", .method = PEL_METHOD_EXPLICIT, .has_thickness = true},
    {.name = "implicit", .method = PEL_METHOD_IMPLICIT},
    {.name = "shell", .method = PEL_METHOD_EXPLICIT, .is_shell = true},
    {.name = "tool", .method = PEL_METHOD_QUASI_STATIC, .has_tool = true},
};
enum { SETUP_COUNT = sizeof setups / sizeof *setups, REFILLABLE = 5 };

/* addresses are taken of the members, so it lies still */
typedef struct defs {
    pel_mesh *mesh;
    int32_t pinned[2];
    double field[200];
    pel_body_def bodies[2];
    pel_load_def load;
    pel_tool_def tool;
    pel_pose_key pose;
    pel_model_def model;
    pel_sim_def sim;
} defs;

static void fill_body(defs *d, const setup *s, int b)
{
    pel_body_def *body = &d->bodies[b];
    *body = ball_body(d->mesh);
    body->name = b == 0 ? "ball" : "other";
    body->mass_kind = s->mass_kind;
    body->thickness.value = 0.02;
    body->mass = s->mass_kind == PEL_MASS_DENSITY ? 1000 : 50;
    body->volumetric_by_area = s->by_area;
    body->volumetric_depth = s->has_depth ? 0.5 : 0;
    body->spring_thickness = s->has_thickness ? 0.01 : 0;
    if (s->is_bare && b == 0)
        body->spring_stiffness.value = 0;
    body->spring_damping.field = d->field;
    body->pinned = d->pinned;
    body->pinned_count = 2;
    body->angular_velocity[1] = s->turns && b == 1 ? 0.3 : 0;
    body->shell.membrane.on = s->is_shell;
    body->shell.membrane.young.value = 10;
    body->shell.membrane.thickness.value = 0.01;
}

static defs *make_defs(const setup *s)
{
    defs *d = calloc(1, sizeof *d);
    assert_non_null(d);
    d->mesh = make_sphere(2);
    assert_true(d->mesh->vertex_count <= 200);
    for (int i = 0; i < 200; i++)
        d->field[i] = 0.3 + 1e-3 * i;
    for (int b = 0; b < 2; b++) {
        d->pinned[b] = nearest_vertex(d->mesh, 0.3 * b, 0, -1);
        fill_body(d, s, b);
    }
    d->load = pel_load_def_default();
    d->load.name = "pull";
    d->load.body = 1;
    d->load.force[2] = 0.4;
    d->pose.rotation[3] = 1;
    d->pose.position[2] = 1.2;
    d->tool = pel_tool_def_default();
    d->tool.name = "probe";
    d->tool.radius = 0.1;
    d->tool.keys = &d->pose;
    d->tool.key_count = 1;
    d->model = pel_model_def_default();
    d->model.bodies = d->bodies;
    d->model.body_count = 2;
    d->sim = lone_sim(NULL, s->method, 1e-3);
    d->sim.solver.keep_velocity = s->keeps_velocity;
    d->sim.loads = &d->load;
    d->sim.load_count = 1;
    d->sim.tools = &d->tool;
    d->sim.tool_count = s->has_tool;
    return d;
}

static void free_defs(defs *d)
{
    pel_mesh_destroy(d->mesh);
    free(d);
}

/* null = refused */
static pel_sim *make(defs *d, pel_model **model)
{
    pel_sim *sim = NULL;
    if (pel_model_create(&d->model, model, NULL) != PEL_OK)
        return NULL;
    d->sim.model = *model;
    if (pel_sim_create(&d->sim, &sim, NULL) != PEL_OK) {
        pel_model_destroy(*model);
        *model = NULL;
    }
    return sim;
}

static void check_same(pel_sim *sim, pel_sim *oracle, const char *name, const char *path, const char *text)
{
    size_t size = pel_sim_save_size(sim);
    assert_int_equal(size, pel_sim_save_size(oracle));
    unsigned char *bytes = calloc(2, size);
    assert_non_null(bytes);
    for (int step = 0; step <= STEPS; step++) {
        pel_sim_ledger ledgers[2] = {0};
        pel_sim_save(sim, bytes);
        pel_sim_save(oracle, bytes + size);
        pel_sim_get_ledger(sim, &ledgers[0]);
        pel_sim_get_ledger(oracle, &ledgers[1]);
        bool is_same = memcmp(bytes, bytes + size, size) == 0 && memcmp(&ledgers[0], &ledgers[1], sizeof *ledgers) == 0;
        if (!is_same || pel_sim_alpha(sim) != pel_sim_alpha(oracle) ||
            (pel_sim_alpha_limit(sim) != pel_sim_alpha_limit(oracle) && !isnan(pel_sim_alpha_limit(oracle))))
            fail_msg("%s: %s = %s gives other bits at step %d", name, path, text, step);
        pel_status status = pel_sim_step(sim, NULL);
        assert_int_equal(status, pel_sim_step(oracle, NULL));
        if (status != PEL_OK)
            break;
    }
    free(bytes);
}

typedef struct counts {
    int tried, done, refused;
} counts;

static bool is_of_model(const pel_def_row *row)
{
    return row->def == PEL_DEF_BODY || row->def == PEL_DEF_MODEL;
}

static const char *value_text(const pel_def_row *row, int i)
{
    static const char *const numbers[] = {"0.7", "3", "0", "1e9", "0.25"}, *const vectors[] = {"[0, 0, -9.81]",
                                                                                               "[1, 0, 0]"};
    static const char *const switches[] = {"true", "false"};
    if (pel_def_row_kind(row) == PEL_PARAMETER_WORD)
        return pel_def_row_words(row)[i > 0];
    if (pel_def_row_kind(row) == PEL_PARAMETER_VECTOR)
        return vectors[i % 2];
    return pel_def_row_kind(row) == PEL_PARAMETER_SWITCH ? switches[i % 2] : numbers[i];
}

/* one more value in the simulation, which is made anew where it cannot be taken over, and the same in the oracle */
static void try_value(defs *d, const setup *s, pel_sim **sim, pel_model **model, pel_parameter_place at, int i,
                      counts *count)
{
    const pel_def_row *row = pel_def_row_at(at.row);
    const char *text = value_text(row, i);
    defs before = *d;
    if (!pel_parameter_write(&d->model, &d->sim, at, text))
        return;
    pel_model *oracle_model = NULL;
    pel_sim *oracle = make(d, &oracle_model);
    count->tried++;
    count->refused += oracle == NULL;
    assert_true(pel_parameter_write(&(*model)->def, &(*sim)->def, at, text));
    bool with_model = is_of_model(row), is_done = !with_model || pel_model_refill(*model);
    is_done = is_done && pel_sim_refill(*sim, with_model);
    if (oracle == NULL && is_done)
        fail_msg("%s: %s = %s is refused at creation only", s->name, row->path, text);
    count->done += is_done;
    if (is_done) {
        size_t size = pel_sim_save_size(*sim);
        unsigned char *start = calloc(1, size);
        assert_non_null(start);
        pel_snapshot_keep(*sim, start);
        check_same(*sim, oracle, s->name, row->path, text);
        assert_int_equal(pel_snapshot_rewind(*sim, start, NULL), PEL_OK);
        free(start);
    } else {
        if (oracle == NULL)
            *d = before;
        pel_sim_destroy(*sim);
        pel_model_destroy(*model);
        *sim = make(d, model);
        assert_non_null(*sim);
    }
    pel_sim_destroy(oracle);
    pel_model_destroy(oracle_model);
}

static void try_parameters(const setup *s, counts *count)
{
    defs *d = make_defs(s);
    pel_model *model = NULL;
    pel_sim *sim = make(d, &model);
    assert_non_null(sim);
    for (int32_t r = -1; (r = pel_def_parameter_after(r)) >= 0;) {
        const pel_def_row *row = pel_def_row_at(r);
        bool is_body = row->def == PEL_DEF_BODY, is_solver = row->def == PEL_DEF_SOLVER;
        const void *def = is_body ? (const void *)&d->bodies[1] : (const void *)&d->sim.solver;
        if ((!is_body && !is_solver && row->def != PEL_DEF_MODEL) || row->refusal != NULL ||
            (row->applies != NULL && !row->applies(def)))
            continue;
        for (int i = 0; i < VALUES; i++)
            try_value(d, s, &sim, &model, (pel_parameter_place){r, is_body ? 1 : 0}, i, count);
    }
    pel_sim_destroy(sim);
    pel_model_destroy(model);
    free_defs(d);
}

static void test_all_parameters(void **unused)
{
    (void)unused;
    for (int i = 0; i < SETUP_COUNT; i++) {
        counts count = {0, 0, 0};
        try_parameters(&setups[i], &count);
        print_message("%s: %d values, %d taken over, %d refused\n", setups[i].name, count.tried, count.done,
                      count.refused);
        assert_true(count.tried > 20);
        /* two values of stiffness make or remove the lengths of springs */
        int other = setups[i].is_bare ? 2 : 0;
        if (i < REFILLABLE)
            assert_true(count.done > 20 && count.done + count.refused + other == count.tried && count.refused > 0);
        else /* springs of no stiffness are uniform */
            assert_true(setups[i].has_thickness ? count.done < count.tried / 4 : count.done == 0);
    }
}

/* fields of stiffness have an array of their own */
static void test_fields(void **unused)
{
    (void)unused;
    defs *d = make_defs(&setups[0]);
    pel_model *model = NULL;
    d->bodies[0].spring_stiffness.field = d->field;
    pel_sim *sim = make(d, &model);
    assert_non_null(sim);
    assert_false(pel_model_refill(model));
    pel_sim_destroy(sim);
    pel_model_destroy(model);
    free_defs(d);
}

/* where memory runs out the model is made anew, which tells of it */
static void test_memory(void **unused)
{
    (void)unused;
    defs *d = make_defs(&setups[1]);
    pel_model *model = NULL;
    pel_sim *sim = make(d, &model);
    assert_non_null(sim);
    failing_malloc_begin(1);
    assert_false(pel_model_refill(model));
    assert_int_equal(failing_malloc_end().live, 0);
    assert_true(pel_model_refill(model));
    pel_sim_destroy(sim);
    pel_model_destroy(model);
    free_defs(d);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_all_parameters),
        cmocka_unit_test(test_fields),
        cmocka_unit_test(test_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
