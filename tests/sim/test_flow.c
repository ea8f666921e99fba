/* Sheets that stretch for good: a square pulled past yield and released keeps its plastic strain, under each method;
   the work that it takes; snapshots; what bodies that yield cannot have. */
#include "pellicle/sim_ledger.h"
#include "shell_fixture.h"

enum { CELLS = 2, SIDE = CELLS + 1, SHEET = SIDE * SIDE, END = 7 };

static const double young = 1e5, poisson = 0.3, thickness = 0.01, yield = 1e4, hardening = 4e4, pull = 1.05e4;
static const pel_key ramp[] = {{0, 0}, {2, 1}, {3, 1}, {5, 0}};

typedef struct sheet {
    pel_mesh *mesh;
    pel_model *model;
    pel_sim *sim;
    pel_body_def body;
    pel_load_def load;
    double weights[SHEET];
    int32_t held[1];
} sheet;

/* pulled along x by forces on two sides; one vertex is held */
static void make_sheet(sheet *s, pel_method method, double dt)
{
    s->mesh = make_grid(CELLS, CELLS, 1, 1, PEL_GRID_ONE_DIAGONAL);
    assert_int_equal(s->mesh->vertex_count, SHEET);
    s->body = shell_body(s->mesh, PEL_MEMBRANE_ELASTOPLASTIC);
    s->body.shell.membrane.young.value = young;
    s->body.shell.membrane.poisson = poisson;
    s->body.shell.membrane.thickness.value = thickness;
    s->body.shell.membrane.yield = yield;
    s->body.shell.membrane.hardening = hardening;
    s->body.mass = 50;
    /* holds it flat */
    s->body.shell.bending.model = PEL_BENDING_HINGE;
    s->body.shell.bending.stiffness.value = 1e-2;
    s->held[0] = SIDE * CELLS / 2;
    s->body.pinned = s->held;
    s->body.pinned_count = 1;
    s->model = make_model(&s->body);
    for (int v = 0; v < SHEET; v++) {
        const double *at = s->mesh->positions[v];
        s->weights[v] = fabs(at[0]) < 0.49 ? 0 : (at[0] > 0 ? 1 : -1) * (fabs(at[1]) > 0.49 ? 0.5 : 1) / CELLS;
    }
    s->load = pel_load_def_default();
    s->load.kind = PEL_LOAD_PER_VERTEX;
    s->load.force[0] = pull * thickness;
    s->load.weights = s->weights;
    s->load.keys = ramp;
    s->load.key_count = sizeof ramp / sizeof *ramp;
    pel_sim_def def = lone_sim(s->model, method, dt);
    def.loads = &s->load;
    def.load_count = 1;
    if (method == PEL_METHOD_EXPLICIT || method == PEL_METHOD_IMPLICIT || method == PEL_METHOD_XPBD)
        def.solver.drag = 60;
    s->sim = make_sim(&def);
}

static void end_sheet(sheet *s)
{
    pel_sim_destroy(s->sim);
    pel_model_destroy(s->model);
    pel_mesh_destroy(s->mesh);
}

/* lengths of two sides: the sheet may have tilted */
static void read_size(const sheet *s, double size[2])
{
    double x[SHEET][3];
    const int ends[2] = {SIDE - 1, SHEET - SIDE};
    pel_sim_get_positions(s->sim, 0, x[0]);
    for (int i = 0; i < 2; i++) {
        const bool is_across = fabs(s->mesh->positions[ends[i]][0] - s->mesh->positions[0][0]) < 0.5;
        size[is_across] = pel_vec3_distance(x[0], x[ends[i]]);
    }
}

/* the stretch at which force over area at rest is `pull`, and its plastic strain */
static double balance(double *slip)
{
    double low = 0, high = 0.5;
    while (high - low > 1e-15) {
        const double h = 0.5 * (low + high);
        *slip = fmax(0, (young * h - yield) / (young + hardening));
        *(young * (h - *slip) * exp(-h) > pull ? &high : &low) = h;
    }
    return exp(low);
}

static void run_to(sheet *s, double time, double dt)
{
    pel_error error;
    for (int64_t end = (int64_t)(time / dt + 0.5); pel_sim_step_count(s->sim) < end;)
        if (pel_sim_step(s->sim, &error) != PEL_OK)
            fail_msg("%s", error.what);
}

static const struct {
    pel_method method;
    double dt, tolerance;
} cases[] = {{PEL_METHOD_STATIC, 0.5, 1e-5},
             {PEL_METHOD_IMPLICIT, 0.02, 2e-3},
             {PEL_METHOD_XPBD, 0.01, 5e-3},
             {PEL_METHOD_EXPLICIT, 4e-4, 2e-3},
             {PEL_METHOD_DESCENT, 0.5, 1e-3}};

static void test_keeps_its_plastic_strain(void **unused)
{
    (void)unused;
    double slip;
    const double stretched = balance(&slip), work = thickness * slip * (yield + 0.5 * hardening * slip);
    assert_true(slip > 0.05);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        sheet s;
        double size[2];
        pel_sim_ledger ledger;
        const double tolerance = IN_FLOAT(cases[i].tolerance, 1e-2);
        make_sheet(&s, cases[i].method, cases[i].dt);
        run_to(&s, 3, cases[i].dt);
        read_size(&s, size);
        print_message("%zu: %.2e", i, size[0] - stretched);
        assert_near(size[0], stretched, tolerance);
        run_to(&s, END, cases[i].dt);
        read_size(&s, size);
        print_message(" %.2e %.2e\n", size[0] - exp(slip), size[1] - exp(-0.5 * slip));
        assert_near(size[0], exp(slip), tolerance);
        assert_near(size[1], exp(-0.5 * slip), tolerance);
        pel_sim_get_ledger(s.sim, &ledger);
        assert_near(ledger.dissipated_plastic, work, 20 * tolerance * work);
        assert_true(ledger.elastic < 1e-2 * work);
        end_sheet(&s);
    }
}

static void test_snapshots_hold_flows(void **unused)
{
    (void)unused;
    for (size_t i = 0; i < 3; i++) {
        sheet s, other;
        const double dt = cases[i].dt;
        make_sheet(&s, cases[i].method, dt);
        make_sheet(&other, cases[i].method, dt);
        run_to(&s, 2.5, dt);
        const size_t size = pel_sim_save_size(s.sim);
        void *bytes = malloc(size);
        pel_sim_save(s.sim, bytes);
        run_to(&s, 4, dt);
        const uint64_t hash = pel_sim_hash(s.sim);
        assert_int_equal(pel_sim_load(s.sim, bytes, size, NULL), PEL_OK);
        assert_int_equal(pel_sim_load(other.sim, bytes, size, NULL), PEL_OK);
        run_to(&s, 4, dt);
        run_to(&other, 4, dt);
        assert_true(pel_sim_hash(s.sim) == hash);
        assert_true(pel_sim_hash(other.sim) == hash);
        free(bytes);
        end_sheet(&s);
        end_sheet(&other);
    }
}

static void test_refusals(void **unused)
{
    (void)unused;
    sheet s;
    make_sheet(&s, PEL_METHOD_STATIC, 0.5);
    pel_sim_def def = lone_sim(s.model, PEL_METHOD_PBD, 0.01);
    check_refusal(&def, 0, "what yields follows stresses", NULL);
    pel_body_def body = s.body;
    body.shell.membrane.toughness.value = 100;
    assert_refused(&body, PEL_BAD_ARGUMENT, "stretches for good");
    body = s.body;
    body.shell.membrane.yield = 0;
    assert_refused(&body, PEL_BAD_ARGUMENT, "yield");
    double field[SHEET];
    for (int v = 0; v < SHEET; v++)
        field[v] = young;
    body = s.body;
    body.shell.membrane.young.field = field;
    assert_refused(&body, PEL_BAD_ARGUMENT, "varies over the body");
    end_sheet(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_keeps_its_plastic_strain),
        cmocka_unit_test(test_snapshots_hold_flows),
        cmocka_unit_test(test_refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
