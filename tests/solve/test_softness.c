/* Rates of softness: closed forms on regular nets and sheets, and what counts. */
#include "solve/softness.h"

#include "failing_malloc.h"
#include "shell_fixture.h"

/* rates are told from above in eighths of an octave */
#define BIN 1.126

#define EDGE 0.1
#define YOUNG 1e5
#define DENSITY 1000

static pel_softness look(const pel_model *model, const pel_state *state, double time, pel_pool *pool,
                         const pel_softness_scratch *scratch)
{
    pel_softness_progress progress = {0};
    pel_softness_look(model, state, time, pool, pel_softness_size(model), scratch, &progress);
    return progress.found;
}

static pel_softness find(const pel_model *model, double stretch, double time)
{
    pel_state *state = make_state(model);
    pel_softness_scratch scratch;
    assert_int_equal(pel_softness_create(model, NULL, &scratch, NULL), PEL_OK);
    for (int32_t v = 0; v < model->vertex_count; v++)
        for (int c = 0; c < 3; c++)
            state->position[v][c] *= (pel_real)stretch;
    pel_softness found = look(model, state, time, NULL, &scratch);
    pel_softness_destroy(&scratch);
    pel_state_destroy(state);
    return found;
}

static double rate_of(const pel_body_def *body, double stretch)
{
    pel_model *model = make_model(body);
    double rate = find(model, stretch, 0).rate;
    pel_model_destroy(model);
    return rate;
}

static void assert_rate(double rate, double exact)
{
    if (!(rate > 0.999 * exact && rate < BIN * exact))
        print_error("rate %g, exact %g, quotient %g\n", rate, exact, rate / exact);
    assert_true(rate > 0.999 * exact && rate < BIN * exact);
}

/* equilateral triangles; the border is pinned, as its vertices are lighter */
typedef struct sheet {
    pel_mesh *mesh;
    int32_t *border;
    pel_body_def body;
} sheet;

static sheet make_sheet(pel_membrane_kind kind, double poisson)
{
    sheet made = {.mesh = make_grid(30, 34, 30 * EDGE, 34 * sqrt(0.75) * EDGE, PEL_GRID_EQUILATERAL)};
    made.border = malloc((size_t)made.mesh->vertex_count * sizeof *made.border);
    made.body = shell_body(made.mesh, kind);
    made.body.shell.membrane.poisson = poisson;
    int32_t count = 0;
    for (int32_t v = 0; v < made.mesh->vertex_count; v++) {
        const double *x = made.mesh->positions[v];
        if (fabs(x[0]) > 14.3 * EDGE || fabs(x[1]) > 16.5 * sqrt(0.75) * EDGE)
            made.border[count++] = v;
    }
    made.body.pinned = made.border;
    made.body.pinned_count = count;
    return made;
}

static void free_sheet(sheet *made)
{
    free(made->border);
    pel_mesh_destroy(made->mesh);
}

/* equal stretch in both directions is the worst: E / ((1 - nu) rho e^2) */
static void test_membranes(void **unused)
{
    (void)unused;
    for (int kind = 0; kind < 5; kind++)
        for (int i = 0; i < 3; i++) {
            double poisson = kind == PEL_MEMBRANE_MOONEY_RIVLIN ? 0.5 : i * 0.2;
            sheet made = make_sheet((pel_membrane_kind)kind, poisson);
            assert_rate(rate_of(&made.body, 1), YOUNG / ((1 - poisson) * DENSITY * EDGE * EDGE));
            free_sheet(&made);
        }
}

/* at the present state: Green's strain grows with the square of the stretch, rubber softens */
static void test_large_strain(void **unused)
{
    (void)unused;
    double rates[5];
    for (int kind = 0; kind < 5; kind++) {
        sheet made = make_sheet((pel_membrane_kind)kind, 0.3);
        rates[kind] = rate_of(&made.body, 1.5) / rate_of(&made.body, 1);
        free_sheet(&made);
    }
    /* psi = K (s^2 - 1)^2 / 2 with the tangent K (6 s^2 - 2) against 4 K */
    assert_near(rates[PEL_MEMBRANE_STVK], (6 * 1.5 * 1.5 - 2) / 4, 0.15 * rates[PEL_MEMBRANE_STVK]);
    assert_near(rates[PEL_MEMBRANE_COROTATED], 1, 0.15);
    assert_true(rates[PEL_MEMBRANE_MOONEY_RIVLIN] < 0.8 && rates[PEL_MEMBRANE_MOONEY_RIVLIN] > 0.1);
}

/* stiffness times the mobility of both ends; a keyed factor acts */
static void test_springs(void **unused)
{
    (void)unused;
    sheet made = make_sheet(PEL_MEMBRANE_STVK, 0.3);
    const pel_key keys[2] = {{0, 3}, {1, 6}};
    made.body.shell.membrane.on = false;
    made.body.mass_kind = PEL_MASS_PER_VERTEX;
    made.body.mass = 0.5;
    made.body.spring_stiffness.value = 7;
    assert_rate(rate_of(&made.body, 1), 7 * 2 / 0.5);
    made.body.spring_stiffness.keys = keys;
    made.body.spring_stiffness.key_count = 2;
    pel_model *model = make_model(&made.body);
    pel_state *state = make_state(model);
    pel_softness_scratch scratch;
    assert_int_equal(pel_softness_create(model, NULL, &scratch, NULL), PEL_OK);
    for (int i = 0; i < 2; i++) {
        state->factors[0][PEL_SPRING_STIFFNESS] = keys[i].value;
        assert_rate(look(model, state, 0, NULL, &scratch).rate, 2 / 0.5 * keys[i].value);
    }
    pel_softness_destroy(&scratch);
    pel_state_destroy(state);
    pel_model_destroy(model);
    free_sheet(&made);
}

/* a hinge of equilateral triangles: D |e|^2 / area times 16 / 3 / (m e^2), m = rho h times the area of a vertex */
static void test_bending(void **unused)
{
    (void)unused;
    const double area = sqrt(0.75) * EDGE * EDGE, mass = DENSITY * 0.01 * area;
    for (int angles = 0; angles < 2; angles++) {
        sheet made = make_sheet(PEL_MEMBRANE_STVK, 0.3);
        made.body.shell.bending.model = angles ? PEL_BENDING_HINGE : PEL_BENDING_ISOMETRIC_REST;
        made.body.shell.bending.stiffness.value = 100;
        made.body.shell.membrane.young.value = 1;
        /* weights of the isometric stencil: 2 / sqrt 3 on the tips, the same with the other sign on the ends */
        double square = angles ? 16 / (3 * EDGE * EDGE) : 16.0 / 3;
        double stiffness = 100 * (angles ? EDGE * EDGE / (0.5 * area * 2) : 1 / (0.5 * area * 2));
        assert_rate(rate_of(&made.body, 1), stiffness * square / mass);
        free_sheet(&made);
    }
}

/* k sum c^2 / m along an edge, four times that for the squared energy */
static void test_fibres(void **unused)
{
    (void)unused;
    double rates[2];
    for (int squared = 0; squared < 2; squared++) {
        sheet made = make_sheet(PEL_MEMBRANE_STVK, 0.3);
        pel_anisotropy_def fibres = pel_anisotropy_def_default();
        fibres.mode = PEL_FIBRE_STRAIN;
        fibres.kind = squared ? PEL_FIBRE_STVK : PEL_FIBRE_SQRT;
        fibres.stiffness = 1e5;
        fibres.direction = PEL_FIBRE_ALONG;
        fibres.axis[0] = 1;
        fibres.axis[1] = fibres.axis[2] = 0;
        made.body.shell.anisotropies = &fibres;
        made.body.shell.anisotropy_count = 1;
        rates[squared] = rate_of(&made.body, 1);
        /* c = (1, -1, 0) / e along an edge; k area / m = k / (2 rho h) */
        assert_rate(rates[squared], (squared ? 4 : 1) * 1e5 / (2 * DENSITY * 0.01) * 2 / (EDGE * EDGE));
        free_sheet(&made);
    }
}

/* gamma p A^2 / (V m), A^2 / m summed over the vertices: 3 gamma p / (R rho h) for a sphere */
static void test_pressure(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_sphere(12);
    pel_body_def body = shell_body(mesh, PEL_MEMBRANE_STVK);
    body.shell.pressure.kind = PEL_PRESSURE_GAS;
    body.shell.pressure.value = 1e5;
    body.shell.pressure.gamma = 1.4;
    pel_model *model = make_model(&body);
    double exact = 3 * 1.4 * 1e5 / (DENSITY * 0.01), at_rest = find(model, 1, 0).pressure;
    assert_near(at_rest / exact, 1, 0.02);
    /* p V^gamma stays: the slope falls with the power gamma + 1 of the volume, the areas rise */
    assert_near(find(model, 1.2, 0).pressure / at_rest, pow(1.2, 4 - 3 * 2.4), 0.01);
    pel_model_destroy(model);
    body.shell.pressure.kind = PEL_PRESSURE_GIVEN;
    model = make_model(&body);
    assert_true(find(model, 1, 0).pressure == 0);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

/* a stiff tenth of a sheet decides; one small triangle does not */
static void test_regions(void **unused)
{
    (void)unused;
    sheet made = make_sheet(PEL_MEMBRANE_STVK, 0.3);
    double plain = rate_of(&made.body, 1), *young = malloc((size_t)made.mesh->vertex_count * sizeof *young);
    for (int32_t v = 0; v < made.mesh->vertex_count; v++)
        young[v] = fabs(made.mesh->positions[v][0]) < 1.5 * EDGE ? 100 * YOUNG : YOUNG;
    made.body.shell.membrane.young.field = young;
    assert_rate(rate_of(&made.body, 1) / plain, 100 / BIN);
    made.body.shell.membrane.young.field = NULL;
    free(young);
    /* draw one vertex almost onto its neighbour */
    int32_t middle = made.mesh->vertex_count / 2;
    made.mesh->positions[middle][0] += 0.9 * EDGE;
    assert_true(rate_of(&made.body, 1) < 1.3 * plain);
    free_sheet(&made);
}

/* a small part that is refined decides */
static void test_refined_part(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_sphere(8);
    pel_body_def body = shell_body(mesh, PEL_MEMBRANE_STVK);
    body.refine.levels = 2;
    pel_model *model = make_model(&body);
    pel_sim_def def = pel_sim_def_default();
    def.model = model;
    def.solver.method = PEL_METHOD_XPBD;
    def.solver.dt = 0.05;
    def.thread_count = 1;
    pel_sim *sim = make_sim(&def);
    run_steps(sim, 1);
    pel_solver_reading before, after;
    pel_sim_get_solver(sim, &before);
    assert_int_equal(pel_sim_refine(sim, 0, 5, 2, NULL), PEL_OK);
    run_steps(sim, 1);
    assert_true(pel_sim_triangle_count(sim, 0) < mesh->triangle_count + 600);
    pel_sim_get_solver(sim, &after);
    assert_near((double)after.needed_substeps / before.needed_substeps, 4, 0.8);
    pel_sim_destroy(sim);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

static void test_iterations(void **unused)
{
    (void)unused;
    assert_near(pel_softness_after(0.05, 1), 0.0025 / 0.55,
                1e-15);                               /* a single sweep takes back what is of first order */
    assert_near(pel_softness_after(100, 4), 25, 0.5); /* shared by the sweeps where it is large */
    assert_true(pel_softness_after(0.2, 2) < 0.03);
    for (int n = 1; n < 9; n++)
        assert_near(pel_softness_after(pel_softness_share(0.3, n), n), 0.3, 1e-12);
}

/* springs, membrane, bending and fibres of a bent ball, at once and in parts, with one thread and two: the same bits */
static void test_parts(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_sphere(9);
    pel_body_def body = shell_body(mesh, PEL_MEMBRANE_STVK);
    pel_anisotropy_def fibres = pel_anisotropy_def_default();
    fibres.mode = PEL_FIBRE_STRAIN;
    fibres.kind = PEL_FIBRE_SQRT;
    fibres.stiffness = 1e5;
    fibres.direction = PEL_FIBRE_ALONG;
    fibres.axis[0] = 1;
    fibres.axis[1] = fibres.axis[2] = 0;
    body.spring_stiffness.value = 7;
    body.shell.bending.model = PEL_BENDING_HINGE;
    body.shell.anisotropies = &fibres;
    body.shell.anisotropy_count = 1;
    pel_model *model = make_model(&body);
    pel_state *state = make_state(model);
    pel_softness_scratch scratch;
    pel_pool *pool;
    assert_int_equal(pel_softness_create(model, NULL, &scratch, NULL), PEL_OK);
    assert_int_equal(pel_pool_create(2, &pool, NULL), PEL_OK);
    for (int32_t v = 0; v < model->vertex_count; v++)
        state->position[v][0] *= (pel_real)(1 + 0.3 * (double)state->position[v][1]);
    const pel_softness whole = look(model, state, 0, NULL, &scratch);
    const int64_t size = pel_softness_size(model);
    assert_true(whole.rate > 0 && size > mesh->vertex_count + 2 * mesh->triangle_count);
    for (int parts = 1; parts <= 20; parts++) {
        pel_softness_progress progress = {0};
        for (int part = 1; part <= parts; part++)
            pel_softness_look(model, state, 0, parts % 2 ? pool : NULL, size * part / parts, &scratch, &progress);
        assert_true(progress.done == size && progress.found.rate == whole.rate);
    }
    pel_pool_destroy(pool);
    pel_softness_destroy(&scratch);
    pel_state_destroy(state);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

static pel_status create(const void *model, pel_error *error)
{
    pel_softness_scratch scratch = {0};
    pel_status status = pel_softness_create(model, NULL, &scratch, error);
    pel_softness_destroy(&scratch);
    return status;
}

static void test_allocation(void **unused)
{
    (void)unused;
    sheet made = make_sheet(PEL_MEMBRANE_STVK, 0.3);
    pel_model *model = make_model(&made.body);
    for_every_allocation_failure(create, model);
    pel_model_destroy(model);
    free_sheet(&made);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_membranes), cmocka_unit_test(test_large_strain), cmocka_unit_test(test_springs),
        cmocka_unit_test(test_bending),   cmocka_unit_test(test_fibres),       cmocka_unit_test(test_pressure),
        cmocka_unit_test(test_regions),   cmocka_unit_test(test_refined_part), cmocka_unit_test(test_iterations),
        cmocka_unit_test(test_parts),     cmocka_unit_test(test_allocation),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
