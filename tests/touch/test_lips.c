/* Lips of cuts under contact: they never intersect, from the moment of the cut on, and parting them gives no momentum.
 */
#include "sim/cut_fixture.h"

#include "pellicle/sim_contact.h"
#include "pellicle/sim_ledger.h"
#include "stage/stage.h"
#include "touch/contact.h"

static const pel_method methods[] = {PEL_METHOD_XPBD,     PEL_METHOD_PBD,          PEL_METHOD_IMPLICIT,
                                     PEL_METHOD_EXPLICIT, PEL_METHOD_QUASI_STATIC, PEL_METHOD_PBD_DISTANCE,
                                     PEL_METHOD_DESCENT,  PEL_METHOD_STATIC};
enum { METHOD_COUNT = sizeof methods / sizeof methods[0], MOVING_COUNT = 6 };

static int64_t intersections_of(pel_sim *sim)
{
    int64_t count;
    assert_int_equal(pel_sim_intersections(sim, &count, NULL), PEL_OK);
    return count;
}

/* steps without an intersection after any of them */
static void run_apart(pel_sim *sim, int count)
{
    for (int i = 0; i < count; i++) {
        run_steps(sim, 1);
        assert_int_equal(intersections_of(sim), 0);
    }
}

static pel_body_def sheet_of(const pel_mesh *mesh, pel_method method)
{
    pel_body_def body = pel_body_def_default();
    body.name = "sheet";
    body.mesh = mesh;
    body.mass_kind = PEL_MASS_DENSITY;
    body.mass = 1000;
    body.thickness.value = 0.01;
    body.spring_stiffness.value = 20;
    body.spring_damping.value = body.volumetric_damping.value = body.volumetric_stiffness.value = 0;
    body.shell.membrane.on = method != PEL_METHOD_QUASI_STATIC && method != PEL_METHOD_PBD_DISTANCE;
    body.shell.membrane.young.value = 1e4;
    body.shell.membrane.thickness.value = 0.01;
    body.shell.membrane.poisson = 0.3;
    return body;
}

static void set_random_velocities(pel_sim *sim, random_state *random, double size)
{
    int32_t count = pel_sim_vertex_count(sim, 0);
    double *v = calloc((size_t)count, 24);
    for (int32_t i = 0; i < 3 * count; i++)
        v[i] = random_between(random, -size, size);
    if (sim->stepper->has_velocity)
        assert_int_equal(pel_sim_set_velocities(sim, 0, v, NULL), PEL_OK);
    free(v);
}

/* ---- any cut ---- */

static pel_mesh *make_any(int kind, random_state *random)
{
    static const pel_shape_kind shapes[] = {PEL_SHAPE_CYLINDER, PEL_SHAPE_TORUS, PEL_SHAPE_DISK, PEL_SHAPE_GRID};
    pel_mesh *mesh;
    if (kind % 6 < 2)
        return kind % 6 == 0 ? make_irregular_patch(6, random) : make_irregular_ball(3, random);
    pel_shape_def def = pel_shape_def_default(shapes[kind % 6 - 2]);
    def.nx = def.ny = 5;
    def.slices = 8;
    def.rings = def.segments = 4;
    def.capped = kind % 4 == 0;
    assert_int_equal(pel_shape_create(&def, &mesh, NULL), PEL_OK);
    return mesh;
}

typedef struct outcomes {
    int made, held, refused;
} outcomes;

/* cuts through a surface that crumples, one after the other */
static void cut_at_random(int round, random_state *random, outcomes *sum)
{
    pel_method method = methods[round % MOVING_COUNT];
    pel_mesh *mesh = make_any(round, random);
    pel_body_def body = sheet_of(mesh, method);
    pel_model *model = make_model(&body);
    pel_sim_def def = lone_sim(model, method, method == PEL_METHOD_QUASI_STATIC ? 1e-2 : 1e-3);
    def.contact.enabled = true;
    pel_sim *sim = make_sim(&def);
    for (int cuts = 0; cuts < 4; cuts++) {
        int32_t path[16], count = random_path(mesh, random, 4 + (int32_t)random_below(random, 9), path);
        set_random_velocities(sim, random, round % 3);
        run_apart(sim, 3);
        sums before = sums_of(sim);
        uint64_t hash = pel_sim_hash(sim);
        pel_status status = count < 3 ? PEL_BAD_ARGUMENT : pel_cut(sim, 0, path, count, NULL);
        sums after = sums_of(sim);
        if (status == PEL_OK && sim->stepper->has_velocity)
            compare_motion(&before, &after);
        if (status != PEL_OK)
            assert_true(pel_sim_hash(sim) == hash);
        assert_int_equal(intersections_of(sim), 0);
        sum->made += status == PEL_OK;
        sum->held += status != PEL_OK && pel_sim_cut_is_held(sim);
        sum->refused += status != PEL_OK && !pel_sim_cut_is_held(sim);
    }
    run_apart(sim, 3);
    pel_sim_destroy(sim);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

static void test_random_cuts(void **unused)
{
    (void)unused;
    random_state random = {7};
    outcomes sum = {0};
    for (int round = 0; round < LONG(6000, ROUNDS(48, 6)); round++)
        cut_at_random(round, &random, &sum);
    print_message("%d cuts made, %d held back, %d refused\n", sum.made, sum.held, sum.refused);
    /* refused are those whose path is open already, along older cuts */
    assert_true(100 * sum.held <= sum.made + 100 && 20 * sum.refused <= sum.made + 20);
}

/* ---- lips that are pressed together ---- */

typedef struct pressed {
    pel_mesh *mesh;
    pel_model *model;
    pel_sim *sim;
    int32_t pins[32], path[32];
} pressed;

/* a sheet that stands on its lower edge, with a cut across; push: gravity out of its plane [m/s2] */
static void make_pressed(pressed *s, pel_method method, double push, int threads)
{
    *s = (pressed){.mesh = make_grid(8, 8, 1, 1, PEL_GRID_UNION_JACK)};
    pel_body_def body = sheet_of(s->mesh, method);
    pel_model_def model_def = pel_model_def_default();
    pel_cut_def cut = {.at = 5e-3, .vertices = s->path};
    for (int32_t v = 0; v < s->mesh->vertex_count; v++) {
        const double *x = s->mesh->positions[v];
        if (x[1] < -0.5 + 1e-9)
            s->pins[body.pinned_count++] = v;
        if (fabs(x[1]) < 1e-9 && fabs(x[0]) < 0.4)
            s->path[cut.vertex_count++] = v;
    }
    body.pinned = s->pins;
    model_def.bodies = &body;
    model_def.body_count = 1;
    model_def.gravity[1] = -1;
    model_def.gravity[2] = push;
    assert_int_equal(pel_model_create(&model_def, &s->model, NULL), PEL_OK);
    pel_sim_def def = lone_sim(s->model, method, 5e-3);
    if (method == PEL_METHOD_EXPLICIT)
        def.solver.dt = 1e-3;
    def.thread_count = threads;
    def.contact.enabled = true;
    def.cuts = &cut;
    def.cut_count = 1;
    s->sim = make_sim(&def);
}

static void end_pressed(pressed *s)
{
    pel_sim_destroy(s->sim);
    pel_model_destroy(s->model);
    pel_mesh_destroy(s->mesh);
}

/* m, least distance of a vertex above the cut from its copy, along y */
static double gap_of(const pressed *s)
{
    int32_t count = pel_sim_vertex_count(s->sim, 0), *origins = calloc((size_t)count, 4);
    double *x = calloc((size_t)count, 24), gap = HUGE_VAL;
    pel_sim_get_positions(s->sim, 0, x);
    pel_sim_get_origins(s->sim, 0, origins);
    for (int32_t v = 0; v < count; v++)
        if (origins[v] != v)
            gap = fmin(gap, fabs(x[3 * v + 1] - x[3 * origins[v] + 1]));
    free(origins);
    free(x);
    return gap;
}

static void test_pressed_lips(void **unused)
{
    (void)unused;
    for (int m = 0; m < METHOD_COUNT; m++)
        for (int buckles = 0; buckles < 2; buckles++) {
            pressed s;
            pel_sim_ledger ledger;
            make_pressed(&s, methods[m], 0.3 * buckles, 1);
            run_apart(s.sim, methods[m] == PEL_METHOD_STATIC ? 3 : 30);
            assert_int_equal(pel_sim_cuts_done(s.sim), 1);
            pel_sim_get_ledger(s.sim, &ledger);
            if (methods[m] == PEL_METHOD_XPBD || methods[m] == PEL_METHOD_IMPLICIT)
                assert_true(ledger.energy_error < 0.02 * ledger.supplied);
            end_pressed(&s);
        }
}

/* however thick the surfaces are that contact keeps apart: an incision is no wider than a hundredth of an edge */
static void test_closed_lips(void **unused)
{
    (void)unused;
    for (int m = 0; m < 3; m += 2) {
        pressed s;
        make_pressed(&s, methods[m], 0, 1);
        pel_sim_def def = s.sim->def;
        pel_contact_statistics statistics;
        pel_sim *sim;
        def.model = s.model;
        def.contact.thickness = 0.05;
        assert_int_equal(pel_sim_create(&def, &sim, NULL), PEL_OK);
        pel_sim_destroy(s.sim);
        s.sim = sim;
        run_apart(sim, 40);
        assert_true(gap_of(&s) < 1e-3);
        pel_sim_get_contact_statistics(sim, &statistics);
        assert_int_equal(statistics.fall_backs, 0);
        end_pressed(&s);
    }
}

/* the same bits for any number of threads, and after a snapshot with pressed lips */
static void test_same_bits(void **unused)
{
    (void)unused;
    for (int m = 0; m < 4; m++) {
        pressed s, threaded, resumed;
        make_pressed(&s, methods[m], 0.3, 1);
        make_pressed(&threaded, methods[m], 0.3, 3);
        make_pressed(&resumed, methods[m], 0.3, 1);
        run_steps(s.sim, 12);
        size_t size = pel_sim_save_size(s.sim);
        void *bytes = malloc(size);
        pel_sim_save(s.sim, bytes);
        run_steps(s.sim, 6);
        run_steps(threaded.sim, 18);
        assert_int_equal(pel_sim_load(resumed.sim, bytes, size, NULL), PEL_OK);
        run_steps(resumed.sim, 6);
        assert_true(pel_sim_hash(threaded.sim) == pel_sim_hash(s.sim));
        assert_true(pel_sim_hash(resumed.sim) == pel_sim_hash(s.sim));
        free(bytes);
        end_pressed(&s);
        end_pressed(&threaded);
        end_pressed(&resumed);
    }
}

/* ---- what a cut changes, and the whole surface ---- */

/* a sheet in folds that lie on each other: a height over a plane intersects nowhere, but lips that part may */
static void fold(pel_sim *sim, const double *x)
{
    assert_int_equal(pel_sim_set_positions(sim, 0, x, NULL), PEL_OK);
    pel_contacts_place_start(sim);
    assert_int_equal(pel_contacts_update_surface(sim, NULL), PEL_OK);
    assert_int_equal(pel_tangles_find(sim->contacts, NULL), PEL_OK);
    assert_int_equal(sim->contacts->tangles.count, 0);
}

/* With the surface before known to be clear only what changed is looked at, else all of it: the same cuts are made and
   held back, with the same bits. */
static void test_look_at_changes(void **unused)
{
    (void)unused;
    random_state random = {3401};
    int made = 0, held = 0;
    for (int round = 0; round < LONG(2000, 200); round++) {
        pel_mesh *mesh = make_grid(8, 8, 1, 1, (pel_grid_diagonals)random_below(&random, 3));
        pel_body_def body = sheet_of(mesh, PEL_METHOD_XPBD);
        pel_model *model = make_model(&body);
        pel_sim_def def = lone_sim(model, PEL_METHOD_XPBD, 1e-3);
        def.contact.enabled = def.contact.self = true;
        def.contact.thickness = 1e-3;
        pel_sim *sims[2] = {make_sim(&def), make_sim(&def)};
        double *x = malloc((size_t)mesh->vertex_count * 24), squeeze = exp(random_between(&random, -9, -3));
        for (int32_t v = 0; v < mesh->vertex_count; v++)
            pel_vec3_set(x + 3 * v, squeeze * mesh->positions[v][0], squeeze * mesh->positions[v][1],
                         random_between(&random, -0.5, 0.5));
        int32_t path[10], count = random_path(mesh, &random, (int32_t)random_integer(&random, 2, 10), path);
        pel_status status[2];
        for (int i = 0; i < 2; i++) {
            fold(sims[i], x);
            sims[i]->contacts->tangles.is_known = i == 0;
            status[i] = pel_cut(sims[i], 0, path, count, NULL);
        }
        assert_int_equal(status[0], status[1]);
        assert_true(pel_sim_cut_is_held(sims[0]) == pel_sim_cut_is_held(sims[1]));
        assert_true(pel_sim_hash(sims[0]) == pel_sim_hash(sims[1]));
        assert_true(status[0] != PEL_OK || intersections_of(sims[0]) == 0);
        made += status[0] == PEL_OK;
        held += pel_sim_cut_is_held(sims[0]);
        free(x);
        pel_sim_destroy(sims[0]);
        pel_sim_destroy(sims[1]);
        pel_model_destroy(model);
        pel_mesh_destroy(mesh);
    }
    print_message("%d cuts made, %d held back\n", made, held);
    assert_true(made > 10 && held > 10);
}

/* ---- held back ---- */

/* so far away that the gap of lips is less than the rounding of positions: there the cut waits */
static void test_held_back(void **unused)
{
    (void)unused;
    pressed s;
    pel_error error;
    make_pressed(&s, PEL_METHOD_IMPLICIT, 0, 1);
    size_t size = 3 * (size_t)s.mesh->vertex_count * sizeof(double);
    double *x = malloc(size);
    memcpy(x, s.mesh->positions, size);
    for (int32_t v = 0; v < s.mesh->vertex_count; v++)
        x[3 * v + 1] += IN_FLOAT(1e13, 1e4);
    assert_int_equal(pel_sim_set_positions(s.sim, 0, x, NULL), PEL_OK);
    uint64_t hash = pel_sim_hash(s.sim);
    assert_int_equal(pel_cut(s.sim, 0, s.path, 6, &error), PEL_BAD_ARGUMENT);
    assert_non_null(strstr(error.what, "held back"));
    assert_true(error.remedy[0] != '\0');
    assert_true(pel_sim_cut_is_held(s.sim) && pel_sim_hash(s.sim) == hash);
    free(x);
    end_pressed(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_random_cuts), cmocka_unit_test(test_pressed_lips), cmocka_unit_test(test_closed_lips),
        cmocka_unit_test(test_same_bits),   cmocka_unit_test(test_held_back),    cmocka_unit_test(test_look_at_changes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
