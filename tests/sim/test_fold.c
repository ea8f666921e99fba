/* Plastic folds: two triangles bent past yield and released spring back by their moment over their stiffness, under
   each method; the work that they take; snapshots; what bodies that fold cannot have. */
#include "pellicle/bending.h"
#include "pellicle/sim_ledger.h"
#include "shell_fixture.h"

#define PAIR_YIELD_ANGLE 0.2
static const double rigidity = 1e-3, hardening = 0.25, force = 9.6e-4;
/* of a diagonal of the unit square: edge, height of each triangle over it, stiffness of the angle over D */
static const double edge = 1.4142135623730951, arm = 0.7071067811865476, factor = 2;

static const pel_key ramp[] = {{0, 0}, {2, 1}, {3, 1}, {5, 0}};
enum { END = 7 }; /* s */

typedef struct pair {
    pel_mesh *mesh;
    pel_model *model;
    pel_sim *sim;
    int32_t tip, held[3];
    pel_body_def body;
    pel_load_def load;
} pair;

static void make_pair(pair *p, pel_method method, double dt)
{
    int count = 0;
    p->mesh = make_grid(1, 1, 1, 1, PEL_GRID_ONE_DIAGONAL);
    p->tip = 0;
    /* the tip of one triangle is no corner of the other */
    for (int32_t v = 0; v < 4; v++) {
        bool is_other = false;
        for (int k = 0; k < 3; k++)
            is_other |= p->mesh->triangles[1][k] == v;
        if (is_other)
            p->held[count++] = v;
        else
            p->tip = v;
    }
    assert_int_equal(count, 3);
    p->body = shell_body(p->mesh, PEL_MEMBRANE_STVK);
    p->body.thickness.value = 1e-8;
    p->body.shell.membrane.young.value = 1e4;
    p->body.pinned = p->held;
    p->body.pinned_count = 3;
    p->body.shell.bending.model = PEL_BENDING_HINGE;
    p->body.shell.bending.stiffness.value = rigidity;
    p->body.shell.bending.yield = PAIR_YIELD_ANGLE / arm;
    p->body.shell.bending.hardening = hardening;
    p->model = make_model(&p->body);
    p->load = pel_load_def_default();
    p->load.kind = PEL_LOAD_PER_VERTEX;
    p->load.force[2] = force;
    p->load.vertices = &p->tip;
    p->load.vertex_count = 1;
    p->load.keys = ramp;
    p->load.key_count = sizeof ramp / sizeof *ramp;
    pel_sim_def def = lone_sim(p->model, method, dt);
    def.loads = &p->load;
    def.load_count = 1;
    if (method == PEL_METHOD_EXPLICIT || method == PEL_METHOD_IMPLICIT || method == PEL_METHOD_XPBD)
        def.solver.drag = 60;
    p->sim = make_sim(&def);
}

static void end_pair(pair *p)
{
    pel_sim_destroy(p->sim);
    pel_model_destroy(p->model);
    pel_mesh_destroy(p->mesh);
}

/* of the tip of a pair from the plane */
static double angle_of(const pair *p, int32_t body, int32_t number)
{
    const int32_t count = pel_sim_vertex_count(p->sim, body);
    double(*x)[3] = malloc((size_t)count * sizeof *x), out[3], along = 0;
    const double *at = p->mesh->positions[p->tip];
    assert_true(4 * number < count);
    pel_sim_get_positions(p->sim, body, x[0]);
    pel_vec3_copy(x[4 * number + p->tip], out);
    free(x);
    out[0] -= 3 * number;
    for (int c = 0; c < 2; c++)
        along += (at[c] > 0 ? 1 : -1) / edge * out[c];
    return atan2(out[2], along);
}

/* where a dead force and the moment of a fold balance that has slipped to `from` and yields `limit` beyond that */
static double balance(double pull, double from, double limit, double harder)
{
    double low = 0, high = 1.5;
    while (high - low > 1e-14) {
        const double angle = 0.5 * (low + high), slip = from + fmax(0, angle - from - limit) / (1 + harder);
        if (pull * arm * cos(angle) > rigidity * factor * (angle - slip))
            low = angle;
        else
            high = angle;
    }
    return low;
}

static void run_to(pair *p, double time, double dt)
{
    pel_error error;
    for (int64_t end = (int64_t)(time / dt + 0.5); pel_sim_step_count(p->sim) < end;)
        if (pel_sim_step(p->sim, &error) != PEL_OK)
            fail_msg("%s", error.what);
}

static const struct {
    pel_method method;
    double dt, tolerance;
} cases[] = {{PEL_METHOD_STATIC, 0.25, 2e-5},
             {PEL_METHOD_IMPLICIT, 0.02, 2e-3},
             {PEL_METHOD_XPBD, 0.01, 5e-3},
             {PEL_METHOD_EXPLICIT, 1e-4, 2e-3},
             {PEL_METHOD_DESCENT, 0.25, 1e-3}};

static void test_springs_back_by_moment_over_stiffness(void **unused)
{
    (void)unused;
    const double bent = balance(force, 0, PAIR_YIELD_ANGLE, hardening),
                 slip = (bent - PAIR_YIELD_ANGLE) / (1 + hardening);
    const double work = rigidity * factor * slip * (PAIR_YIELD_ANGLE + 0.5 * hardening * slip);
    assert_true(bent > 0.5 && slip > 0.25);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        pair p;
        pel_sim_ledger ledger;
        const double tolerance = IN_FLOAT(cases[i].tolerance, 1e-2);
        make_pair(&p, cases[i].method, cases[i].dt);
        run_to(&p, 3, cases[i].dt);
        assert_near(angle_of(&p, 0, 0), bent, tolerance * bent);
        run_to(&p, END, cases[i].dt);
        assert_near(angle_of(&p, 0, 0), slip, tolerance * bent);
        pel_sim_get_ledger(p.sim, &ledger);
        assert_near(ledger.dissipated_plastic, work, 4 * tolerance * work);
        assert_true(ledger.elastic < 1e-2 * work);
        /* a static step takes the mean of the forces at its ends for the work of a load */
        assert_near(ledger.work_loads, work + ledger.dissipated_drag + ledger.dissipated_solver, 0.05 * work);
        end_pair(&p);
    }
}

/* ---- many hinges ---- */

enum { PAIRS = 12 }; /* of a body, more than a block has lanes */

/* the pair again and again along x, 3 m apart */
static pel_mesh *repeat(const pel_mesh *one)
{
    double positions[4 * PAIRS][3];
    int32_t triangles[2 * PAIRS][3];
    pel_mesh *mesh;
    for (int32_t i = 0; i < 4 * PAIRS; i++) {
        memcpy(positions[i], one->positions[i % 4], sizeof *positions);
        positions[i][0] += 3 * (i / 4);
    }
    for (int32_t i = 0; i < 6 * PAIRS; i++)
        triangles[i / 3][i % 3] = one->triangles[i / 3 % 2][i % 3] + i / 6 * 4;
    assert_int_equal(pel_mesh_create(positions[0], 4 * PAIRS, triangles[0], 2 * PAIRS, &mesh, NULL), PEL_OK);
    return mesh;
}

/* where a pair comes to rest after it was bent by a force, then the other way by as much, where it yields at the moment
   that the first way left it with; adds the work to `work` */
static double bend_and_back(double pull, double harder, double *work)
{
    const double first = (balance(pull, 0, PAIR_YIELD_ANGLE, harder) - PAIR_YIELD_ANGLE) / (1 + harder);
    const double limit = PAIR_YIELD_ANGLE + harder * first, back = balance(pull, -first, limit, harder);
    const double slip = (back + first - limit) / (1 + harder);
    assert_true(first > 0.1 && slip > 0.01);
    *work +=
        rigidity * factor * (first * (PAIR_YIELD_ANGLE + 0.5 * harder * first) + slip * (limit + 0.5 * harder * slip));
    return first - slip;
}

/* Two bodies of many pairs, the second one folded down, and harder; each pair by a force of its own. */
static void test_folds_down_and_back(void **unused)
{
    (void)unused;
    static const pel_key keys[] = {{0, 0}, {2, 1}, {3, 1}, {5, -1}, {6, -1}, {8, 0}};
    double rest[2 * PAIRS], work = 0;
    int32_t tips[PAIRS], held[3 * PAIRS];
    pel_body_def bodies[2];
    pel_load_def loads[2 * PAIRS];
    pel_sim_ledger ledger;
    pair p;
    make_pair(&p, PEL_METHOD_STATIC, 0.25);
    pel_sim_destroy(p.sim);
    pel_model_destroy(p.model);
    pel_mesh *mesh = repeat(p.mesh);
    for (int32_t i = 0; i < 3 * PAIRS; i++)
        held[i] = p.held[i % 3] + i / 3 * 4;
    for (int i = 0; i < 2 * PAIRS; i++) {
        const int b = i / PAIRS;
        const double pull = force * (1 + 0.03 * (i % PAIRS)), harder = (1 + b) * hardening;
        bodies[b] = p.body;
        bodies[b].name = b == 0 ? "up" : "down";
        bodies[b].mesh = mesh;
        bodies[b].pinned = held;
        bodies[b].pinned_count = 3 * PAIRS;
        bodies[b].shell.bending.hardening = harder;
        tips[i % PAIRS] = p.tip + i % PAIRS * 4;
        loads[i] = p.load;
        loads[i].body = b;
        loads[i].force[2] = b == 0 ? pull : -pull;
        loads[i].vertices = &tips[i % PAIRS];
        loads[i].keys = keys;
        loads[i].key_count = sizeof keys / sizeof *keys;
        rest[i] = (b == 0 ? 1 : -1) * bend_and_back(pull, harder, &work);
    }
    pel_model_def model = pel_model_def_default();
    model.bodies = bodies;
    model.body_count = 2;
    assert_int_equal(pel_model_create(&model, &p.model, NULL), PEL_OK);
    pel_sim_def def = lone_sim(p.model, PEL_METHOD_STATIC, 0.25);
    def.loads = loads;
    def.load_count = 2 * PAIRS;
    p.sim = make_sim(&def);
    run_to(&p, 9, 0.25);
    for (int i = 0; i < 2 * PAIRS; i++)
        assert_near(angle_of(&p, i / PAIRS, i % PAIRS), rest[i], 2e-5);
    pel_sim_get_ledger(p.sim, &ledger);
    assert_near(ledger.dissipated_plastic, work, 1e-4 * work);
    pel_mesh_destroy(mesh);
    end_pair(&p);
}

/* below yield nothing stays, and the bits are those of a body that never yields */
static void test_below_yield_is_elastic(void **unused)
{
    (void)unused;
    pair p;
    make_pair(&p, PEL_METHOD_STATIC, 0.25);
    p.body.shell.bending.yield = 10;
    pel_model *stiff = make_model(&p.body);
    p.body.shell.bending.yield = 0;
    pel_model *elastic = make_model(&p.body);
    pel_sim_def def = lone_sim(stiff, PEL_METHOD_STATIC, 0.25);
    def.loads = &p.load;
    def.load_count = 1;
    pel_sim *a = make_sim(&def);
    def.model = elastic;
    pel_sim *b = make_sim(&def);
    pel_sim_ledger ledger;
    run_steps(a, 20);
    run_steps(b, 20);
    assert_true(pel_sim_hash(a) == pel_sim_hash(b));
    pel_sim_get_ledger(a, &ledger);
    assert_true(ledger.dissipated_plastic == 0 && ledger.elastic > 0);
    pel_sim_destroy(a);
    pel_sim_destroy(b);
    pel_model_destroy(stiff);
    pel_model_destroy(elastic);
    end_pair(&p);
}

static void test_snapshots_hold_folds(void **unused)
{
    (void)unused;
    for (size_t i = 0; i < 3; i++) {
        pair p, other;
        const double dt = cases[i].dt;
        make_pair(&p, cases[i].method, dt);
        make_pair(&other, cases[i].method, dt);
        run_to(&p, 1.75, dt);
        void *bytes = malloc(pel_sim_save_size(p.sim));
        const size_t size = pel_sim_save_size(p.sim);
        pel_sim_save(p.sim, bytes);
        run_to(&p, 4, dt);
        const uint64_t hash = pel_sim_hash(p.sim);
        /* folded further, and not at all */
        assert_int_equal(pel_sim_load(p.sim, bytes, size, NULL), PEL_OK);
        assert_int_equal(pel_sim_load(other.sim, bytes, size, NULL), PEL_OK);
        run_to(&p, 4, dt);
        run_to(&other, 4, dt);
        assert_true(pel_sim_hash(p.sim) == hash);
        assert_true(pel_sim_hash(other.sim) == hash);
        free(bytes);
        end_pair(&p);
        end_pair(&other);
    }
}

static void test_refusals(void **unused)
{
    (void)unused;
    pair p;
    make_pair(&p, PEL_METHOD_STATIC, 0.25);
    pel_sim_def def = lone_sim(p.model, PEL_METHOD_PBD, 0.01);
    check_refusal(&def, 0, "what yields follows stresses", NULL);
    pel_body_def body = p.body;
    body.shell.bending.model = PEL_BENDING_MIDEDGE;
    assert_refused(&body, PEL_BAD_ARGUMENT, "hinges");
    body = p.body;
    body.shell.membrane.toughness.value = 100;
    assert_refused(&body, PEL_BAD_ARGUMENT, "plastic folds");
    body = p.body;
    body.shell.bending.yield = -1;
    assert_refused(&body, PEL_BAD_ARGUMENT, "yield");
    body = p.body;
    body.shell.bending.hardening = (double)NAN;
    assert_refused(&body, PEL_BAD_ARGUMENT, "hardening");
    end_pair(&p);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_springs_back_by_moment_over_stiffness),
        cmocka_unit_test(test_folds_down_and_back),
        cmocka_unit_test(test_below_yield_is_elastic),
        cmocka_unit_test(test_snapshots_hold_folds),
        cmocka_unit_test(test_refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
