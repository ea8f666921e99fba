/* Sheets that grow and shrink: free ones take their new size without stress, held ones the stress of the closed form,
   under each method; a field that ripples; the work of growth; snapshots; what bodies that grow cannot have. */
#include "pellicle/sim_ledger.h"
#include "shell_fixture.h"

enum { CELLS = 4, SIDE = CELLS + 1, SHEET = SIDE * SIDE };

static const double young = 1e5, thickness = 0.01;
static const pel_key ramp[] = {{0, 0}, {1, 1}};

typedef struct sheet {
    pel_mesh *mesh;
    pel_model *model;
    pel_sim *sim;
    int32_t pinned[SHEET];
} sheet;

/* A square of side 1, pinned at one vertex or along its border. */
static pel_body_def make_body(sheet *s, bool is_held, double scale)
{
    *s = (sheet){.mesh = make_grid(CELLS, CELLS, 1, 1, PEL_GRID_UNION_JACK)};
    assert_int_equal(s->mesh->vertex_count, SHEET);
    pel_body_def body = shell_body(s->mesh, PEL_MEMBRANE_STVK);
    body.shell.membrane.young.value = young;
    body.shell.membrane.poisson = 0;
    body.shell.membrane.thickness.value = thickness;
    body.shell.membrane.rest_scale.value = scale;
    body.shell.membrane.rest_keys = ramp;
    body.shell.membrane.rest_key_count = 2;
    body.shell.bending.model = PEL_BENDING_HINGE;
    body.shell.bending.stiffness.value = 1;
    body.mass = 1;
    body.pinned = s->pinned;
    for (int32_t v = 0; v < SHEET; v++)
        if (is_held ? fmax(fabs(s->mesh->positions[v][0]), fabs(s->mesh->positions[v][1])) > 0.49 : v == SHEET / 2)
            s->pinned[body.pinned_count++] = v;
    return body;
}

static void make_sheet(sheet *s, const pel_body_def *body, pel_method method, double dt)
{
    s->model = make_model(body);
    pel_sim_def def = lone_sim(s->model, method, dt);
    if (method == PEL_METHOD_EXPLICIT || method == PEL_METHOD_IMPLICIT || method == PEL_METHOD_XPBD)
        def.solver.drag = 20;
    s->sim = make_sim(&def);
}

static void end_sheet(sheet *s)
{
    pel_sim_destroy(s->sim);
    pel_model_destroy(s->model);
    pel_mesh_destroy(s->mesh);
}

static void run_to(pel_sim *sim, double time)
{
    pel_error error;
    while (pel_sim_time(sim) < time - 1e-9)
        if (pel_sim_step(sim, &error) != PEL_OK)
            fail_msg("%s", error.what);
}

static double distance(const sheet *s, int a, int b)
{
    double x[SHEET][3];
    pel_sim_get_positions(s->sim, 0, x[0]);
    return pel_vec3_distance(x[a], x[b]);
}

static const struct {
    pel_method method;
    double dt, tolerance;
} cases[] = {{PEL_METHOD_STATIC, 0.1, 1e-6},       {PEL_METHOD_IMPLICIT, 0.01, 1e-3}, {PEL_METHOD_XPBD, 0.01, 5e-3},
             {PEL_METHOD_EXPLICIT, 2e-4, 1e-3},    {PEL_METHOD_DESCENT, 0.1, 1e-3},   {PEL_METHOD_PBD, 0.01, 1e-3},
             {PEL_METHOD_QUASI_STATIC, 2e-4, 1e-3}};

static void test_takes_its_size(void **unused)
{
    (void)unused;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        for (int k = 0; k < 2; k++) {
            const double scale = k == 0 ? 1.2 : 0.8;
            sheet s;
            const pel_body_def body = make_body(&s, false, scale);
            pel_sim_ledger ledger;
            make_sheet(&s, &body, cases[i].method, cases[i].dt);
            run_to(s.sim, 2);
            assert_near(distance(&s, 0, CELLS), scale, IN_FLOAT(cases[i].tolerance, 1e-2));
            assert_near(distance(&s, 0, CELLS * SIDE), scale, IN_FLOAT(cases[i].tolerance, 1e-2));
            pel_sim_get_ledger(s.sim, &ledger);
            /* of the energy that its growth at once would bring */
            const double sudden = 0.5 * young * thickness * 2 * 0.04;
            assert_true(ledger.elastic < 1e-4 * sudden);
            assert_true(ledger.energy_error < IN_FLOAT(3e-6, 1e-3) * sudden);
            end_sheet(&s);
        }
}

static double largest_of(pel_sim *sim, const char *field)
{
    double values[SHEET][2], largest = -HUGE_VAL;
    assert_int_equal(pel_observe(sim, pel_field_find(field), 0, values[0], NULL), PEL_OK);
    for (int v = 0; v < SHEET; v++)
        largest = fmax(largest, values[v][0]);
    return largest;
}

/* Shrunk by s within its border, the sheet has the Green strain e = (1 / s^2 - 1) / 2, the stress E e, and the energy
   E h e^2 over the area s^2 that it would have without stress. */
static void test_held(void **unused)
{
    (void)unused;
    const double scale = 0.9, strain = 0.5 * (1 / (scale * scale) - 1),
                 energy = young * thickness * strain * strain * scale * scale;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        /* does not follow the material */
        if (cases[i].method == PEL_METHOD_PBD)
            continue;
        sheet s;
        const pel_body_def body = make_body(&s, true, scale);
        pel_sim_ledger ledger;
        const double tolerance = cases[i].method == PEL_METHOD_XPBD ? 0.01 : IN_FLOAT(1e-9, 1e-4);
        make_sheet(&s, &body, cases[i].method, cases[i].dt);
        run_to(s.sim, 2);
        pel_sim_get_ledger(s.sim, &ledger);
        assert_near(ledger.elastic, energy, tolerance * energy);
        assert_near(ledger.work_material, energy, 0.01 * energy);
        assert_near(largest_of(s.sim, "principal_strain"), strain, 5 * tolerance * strain);
        assert_near(largest_of(s.sim, "principal_stress"), young * strain, 5 * tolerance * young * strain);
        end_sheet(&s);
    }
}

/* A heavy sheet lags behind its growth and swings, without energy of its own. */
static void test_swings(void **unused)
{
    (void)unused;
    static const double steps[] = {0.01, 0.002};
    for (int i = 0; i < 2; i++) {
        sheet s;
        pel_body_def body = make_body(&s, false, 1.2);
        pel_sim_ledger ledger;
        body.mass = 200;
        s.model = make_model(&body);
        const pel_sim_def def = lone_sim(s.model, PEL_METHOD_IMPLICIT, steps[i]);
        s.sim = make_sim(&def);
        run_to(s.sim, 1.5);
        pel_sim_get_ledger(s.sim, &ledger);
        assert_true(ledger.kinetic + ledger.elastic > 0.1 * ledger.work_material);
        assert_true(ledger.energy_error < 0.03 * ledger.work_material);
        end_sheet(&s);
    }
}

/* A strain limit follows the shape without stress. */
static void test_strain_limit(void **unused)
{
    (void)unused;
    sheet s;
    pel_body_def body = make_body(&s, false, 1.3);
    body.shell.membrane.strain_limit = 0.02;
    make_sheet(&s, &body, PEL_METHOD_XPBD, 0.01);
    run_to(s.sim, 2);
    assert_near(distance(&s, 0, CELLS), 1.3, IN_FLOAT(5e-3, 1e-2));
    end_sheet(&s);
}

/* twice as long along its border as inside, a sheet ripples out of its plane */
static void test_field(void **unused)
{
    (void)unused;
    sheet s;
    double scales[SHEET], x[SHEET][3], height = 0;
    pel_body_def body = make_body(&s, false, 1);
    for (int v = 0; v < SHEET; v++)
        scales[v] = fmax(fabs(s.mesh->positions[v][0]), fabs(s.mesh->positions[v][1])) > 0.49 ? 1.6 : 1;
    s.mesh->positions[0][2] += 0.01;
    body.shell.membrane.rest_scale.field = scales;
    body.shell.bending.stiffness.value = 1e-3;
    make_sheet(&s, &body, PEL_METHOD_STATIC, 0.05);
    run_to(s.sim, 1);
    pel_sim_get_positions(s.sim, 0, x[0]);
    for (int v = 0; v < SHEET; v++)
        height = fmax(height, fabs(x[v][2]));
    assert_true(height > 0.1);
    end_sheet(&s);
}

static void test_snapshots(void **unused)
{
    (void)unused;
    for (size_t i = 0; i < 4; i++) {
        sheet s, other;
        const pel_body_def body = make_body(&s, false, 1.3), same = make_body(&other, false, 1.3);
        make_sheet(&s, &body, cases[i].method, cases[i].dt);
        make_sheet(&other, &same, cases[i].method, cases[i].dt);
        run_to(s.sim, 0.5);
        const size_t size = pel_sim_save_size(s.sim);
        void *bytes = malloc(size);
        pel_sim_save(s.sim, bytes);
        run_to(s.sim, 0.8);
        const uint64_t hash = pel_sim_hash(s.sim);
        assert_int_equal(pel_sim_load(other.sim, bytes, size, NULL), PEL_OK);
        run_to(other.sim, 0.8);
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
    static const pel_key wrong[] = {{0, 0}, {1, 1.5}};
    const pel_body_def body = make_body(&s, false, 1.2);
    const pel_anisotropy_def fibres = pel_anisotropy_def_default();
    double field[SHEET] = {0};
    pel_body_def bad = body;
    bad.shell.membrane.toughness.value = 100;
    assert_refused(&bad, PEL_BAD_ARGUMENT, "keeps its triangles");
    bad = body;
    shell_set_kind(&bad, PEL_MEMBRANE_ELASTOPLASTIC);
    assert_refused(&bad, PEL_BAD_ARGUMENT, "of their own");
    bad = body;
    bad.shell.anisotropies = &fibres;
    bad.shell.anisotropy_count = 1;
    assert_refused(&bad, PEL_BAD_ARGUMENT, "of their own");
    bad = body;
    bad.shell.membrane.rest_keys = wrong;
    assert_refused(&bad, PEL_BAD_ARGUMENT, "rest_keys is 1.5");
    bad = body;
    bad.shell.membrane.rest_scale.value = -1;
    assert_refused(&bad, PEL_BAD_ARGUMENT, "rest_scale is -1");
    bad.shell.membrane.rest_scale.field = field;
    assert_refused(&bad, PEL_BAD_ARGUMENT, "rest_scale is 0");
    pel_mesh_destroy(s.mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_takes_its_size), cmocka_unit_test(test_held),     cmocka_unit_test(test_field),
        cmocka_unit_test(test_snapshots),      cmocka_unit_test(test_refusals), cmocka_unit_test(test_swings),
        cmocka_unit_test(test_strain_limit),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
