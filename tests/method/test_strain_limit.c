/* Strain limit of cloth: principal stretches of triangles stay within it. */
#include "pellicle/sim_ledger.h"
#include "shell_fixture.h"

typedef struct cloth {
    pel_mesh *mesh;
    pel_body_def body;
    pel_model *model;
    int32_t pinned[50];
    pel_sim_def def;
} cloth;

static const double young = 1e5, thickness = 1e-3;

/* a strip along x that is pinned at its left end */
static void begin(cloth *c, pel_method method, double limit)
{
    memset(c, 0, sizeof *c);
    c->mesh = make_grid(16, 4, 0.4, 0.1, PEL_GRID_UNION_JACK);
    pel_body_def *body = &c->body;
    *body = shell_body(c->mesh, PEL_MEMBRANE_STVK);
    body->name = "cloth";
    body->thickness.value = body->shell.membrane.thickness.value = thickness;
    body->shell.membrane.young.value = young;
    body->shell.membrane.poisson = 0.3;
    body->shell.membrane.strain_limit = limit;
    for (int32_t v = 0; v < c->mesh->vertex_count; v++)
        if (c->mesh->positions[v][0] < -0.199)
            c->pinned[body->pinned_count++] = v;
    body->pinned = c->pinned;
    c->def = lone_sim(NULL, method, 0.01);
    c->def.solver.drag = 5;
}

static pel_status create(cloth *c, double gravity, pel_sim **sim, pel_error *error)
{
    pel_model_def def = pel_model_def_default();
    def.bodies = &c->body;
    def.body_count = 1;
    def.gravity[0] = gravity;
    pel_status status = pel_model_create(&def, &c->model, error);
    c->def.model = c->model;
    return status == PEL_OK ? pel_sim_create(&c->def, sim, error) : status;
}

static void end(cloth *c, pel_sim *sim)
{
    pel_sim_destroy(sim);
    pel_model_destroy(c->model);
    pel_mesh_destroy(c->mesh);
}

/* largest principal stretch of all triangles, from the public positions; the shape at rest lies in the plane z = 0 */
static double largest_stretch(const pel_sim *sim, const pel_mesh *mesh)
{
    static double x[3 * 1000];
    double largest = 0;
    pel_sim_get_positions(sim, 0, x);
    for (int32_t t = 0; t < mesh->triangle_count; t++) {
        const int32_t *v = mesh->triangles[t];
        double d[2][2], e[2][3], f[2][3];
        for (int i = 0; i < 2; i++) {
            for (int k = 0; k < 2; k++)
                d[i][k] = mesh->positions[v[i]][k] - mesh->positions[v[2]][k];
            pel_vec3_subtract(x + 3 * v[i], x + 3 * v[2], e[i]);
        }
        double det = d[0][0] * d[1][1] - d[0][1] * d[1][0];
        for (int k = 0; k < 3; k++) {
            f[0][k] = (d[1][1] * e[0][k] - d[0][1] * e[1][k]) / det;
            f[1][k] = (d[0][0] * e[1][k] - d[1][0] * e[0][k]) / det;
        }
        double a = pel_vec3_dot(f[0], f[0]), b = pel_vec3_dot(f[1], f[1]), c = pel_vec3_dot(f[0], f[1]);
        largest = fmax(largest, sqrt((a + b) / 2 + hypot((a - b) / 2, c)));
    }
    return largest;
}

/* under ten times its weight the cloth would stretch by a third; it stretches at most by the limit, its pins carry the
   weight still, and no energy appears */
static void test_hangs(void **unused)
{
    (void)unused;
    const pel_method methods[] = {PEL_METHOD_XPBD, PEL_METHOD_PBD};
    for (int m = 0; m < 2; m++)
        for (int limited = 0; limited < 2; limited++) {
            cloth c;
            pel_sim *sim;
            pel_support_reading support;
            pel_sim_ledger ledger;
            begin(&c, methods[m], limited * 0.1);
            if (methods[m] == PEL_METHOD_PBD)
                c.def.solver.iterations = 200;
            assert_int_equal(create(&c, 98.1, &sim, NULL), PEL_OK);
            for (int n = 0; n < 30; n++) {
                run_steps(sim, 10);
                pel_sim_get_ledger(sim, &ledger);
                assert_true(limited == 0 || ledger.energy_error <= ledger.tolerance || methods[m] == PEL_METHOD_PBD);
            }
            double stretch = largest_stretch(sim, c.mesh), weight = 1000 * thickness * 0.04 * 98.1;
            if (limited == 1)
                assert_true(stretch <= 1.1 + 5e-3);
            else if (methods[m] == PEL_METHOD_XPBD)
                assert_true(stretch > 1.25);
            pel_sim_get_support(sim, 0, &support);
            assert_near(support.force[0], weight, 5e-3 * weight);
            end(&c, sim);
        }
}

static void test_refusals(void **unused)
{
    (void)unused;
    const pel_method methods[] = {PEL_METHOD_EXPLICIT, PEL_METHOD_QUASI_STATIC, PEL_METHOD_DESCENT,
                                  PEL_METHOD_PBD_DISTANCE};
    pel_error error;
    cloth c;
    pel_sim *sim = NULL;
    for (int m = 0; m < 4; m++) {
        begin(&c, methods[m], 0.1);
        c.def.solver.dt = 1e-5;
        assert_int_equal(create(&c, 0, &sim, &error), PEL_BAD_ARGUMENT);
        assert_non_null(strstr(error.what, "strain_limit"));
        end(&c, NULL);
    }
    const double bad[] = {-0.1, 1, (double)NAN};
    for (int i = 0; i < 3; i++) {
        begin(&c, PEL_METHOD_XPBD, bad[i]);
        assert_int_equal(create(&c, 0, &sim, &error), PEL_BAD_ARGUMENT);
        assert_non_null(strstr(error.what, "strain limit"));
        end(&c, NULL);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_hangs),
        cmocka_unit_test(test_refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
