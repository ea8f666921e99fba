/* Follower loads: slopes against differences, turns with the surface, and a cantilever under one. */
#include "boundary/follower.h"
#include "boundary/loads.h"
#include "failing_malloc.h"
#include "pellicle/shape.h"
#include "pellicle/sim_forces.h"
#include "pellicle/sim_ledger.h"
#include "shell_fixture.h"

#include <string.h>

static const double strip_length = 10, stiffness = 100; /* m; N m, E h^3 / 12 of a width of 1 m */

typedef struct cantilever {
    pel_mesh *mesh;
    pel_model *model;
    int32_t ends[2][10];
    pel_support_def support;
    pel_load_def load;
    pel_sim_def def;
} cantilever;

/* a strip along x, clamped at its left end, with a force per length on its right one */
static void begin(cantilever *c, int32_t cells, pel_method method, const double force[3])
{
    memset(c, 0, sizeof *c);
    c->mesh = make_grid(cells, 2, strip_length, 1, PEL_GRID_UNION_JACK);
    int32_t counts[2] = {0, 0};
    for (int32_t v = 0; v < c->mesh->vertex_count; v++)
        if (fabs(c->mesh->positions[v][0]) > 0.4999 * strip_length) {
            int side = c->mesh->positions[v][0] > 0;
            c->ends[side][counts[side]++] = v;
        }
    pel_body_def body = shell_body(c->mesh, PEL_MEMBRANE_STVK);
    body.name = "strip";
    body.shell.membrane.young.value = 1.2e6;
    body.shell.membrane.poisson = 0;
    body.thickness.value = body.shell.membrane.thickness.value = 0.1;
    body.shell.bending.model = method == PEL_METHOD_EXPLICIT ? PEL_BENDING_HINGE : PEL_BENDING_MIDEDGE;
    if (method == PEL_METHOD_EXPLICIT) {
        body.pinned = c->ends[0];
        body.pinned_count = counts[0];
    }
    c->model = make_model(&body);
    c->support = pel_support_def_default();
    c->support.vertices = c->ends[0];
    c->support.vertex_count = counts[0];
    c->support.fix_rotation = true;
    c->load = pel_load_def_default();
    c->load.kind = PEL_LOAD_PER_LENGTH;
    c->load.follower = true;
    c->load.vertices = c->ends[1];
    c->load.vertex_count = counts[1];
    pel_vec3_copy(force, c->load.force);
    c->def = lone_sim(c->model, method, 1);
    c->def.supports = &c->support;
    c->def.support_count = method == PEL_METHOD_EXPLICIT ? 0 : 1;
    c->def.loads = &c->load;
    c->def.load_count = 1;
}

static void end(cantilever *c, pel_sim *sim)
{
    pel_sim_destroy(sim);
    pel_model_destroy(c->model);
    pel_mesh_destroy(c->mesh);
}

static void gradient_at(const pel_sim *sim, const double *unknowns, int32_t count, double *gradient)
{
    memset(gradient, 0, (size_t)count * sizeof *gradient);
    pel_followers_evaluate(sim, pel_instant(0.5), unknowns, gradient);
}

static void test_slopes(void **unused)
{
    (void)unused;
    const double force[3] = {1, -2, 3};
    cantilever c;
    random_state random = {7};
    begin(&c, 2, PEL_METHOD_STATIC, force);
    pel_sim *sim = make_sim(&c.def);
    int32_t count = 3 * c.model->vertex_count;
    double *x = calloc((size_t)count, sizeof *x), *gradient = malloc((size_t)count * sizeof *gradient);
    double *sides[2] = {malloc((size_t)count * sizeof *x), malloc((size_t)count * sizeof *x)};
    for (int32_t u = 0; u < count; u++)
        x[u] = (double)c.model->rest[u / 3][u % 3] + random_between(&random, -0.1, 0.1);
    assert_int_equal(sim->loads->follower_count, 2);
    for (int32_t i = 0; i < sim->loads->follower_count; i++) {
        const int32_t *v = sim->loads->followers[i].vertices;
        double slopes[3][3][3];
        gradient_at(sim, x, count, gradient);
        pel_follower_slopes(sim, i, slopes);
        double kept = sim->loads->followers[1 - i].length;
        sim->loads->followers[1 - i].length = 0; /* alone */
        for (int by = 0; by < 3; by++)
            for (int k = 0; k < 3; k++) {
                const double h = 1e-6, at = x[3 * v[by] + k];
                for (int side = 0; side < 2; side++) {
                    x[3 * v[by] + k] = at + (side ? h : -h);
                    gradient_at(sim, x, count, sides[side]);
                }
                x[3 * v[by] + k] = at;
                for (int end = 0; end < 2; end++)
                    for (int row = 0; row < 3; row++) {
                        int32_t u = 3 * v[end] + row;
                        assert_near(slopes[by][row][k], (sides[1][u] - sides[0][u]) / (2 * h), 1e-7);
                    }
            }
        sim->loads->followers[1 - i].length = kept;
    }
    free(x);
    free(gradient);
    free(sides[0]);
    free(sides[1]);
    end(&c, sim);
}

/* a load all around acts on each edge of the boundary once: in total on its length, weighted along it */
static void test_perimeter(void **unused)
{
    (void)unused;
    const double force[3] = {0, 0, 1};
    enum { CELLS = 3 };
    cantilever c;
    begin(&c, CELLS, PEL_METHOD_STATIC, force);
    double weights[3 * (CELLS + 1)];
    assert_int_equal(c.mesh->vertex_count, 3 * (CELLS + 1));
    for (int32_t v = 0; v < c.mesh->vertex_count; v++)
        weights[v] = 6 + c.mesh->positions[v][0];
    c.load.vertices = NULL;
    c.load.vertex_count = 0;
    for (int weighted = 0; weighted < 2; weighted++) {
        c.load.weights = weighted ? weights : NULL;
        pel_sim *sim = make_sim(&c.def);
        double sum = 0;
        for (int32_t i = 0; i < sim->loads->follower_count; i++)
            sum += sim->loads->followers[i].length;
        assert_int_equal(sim->loads->follower_count, 2 * CELLS + 4);
        assert_near(sum, (weighted ? 6 : 1) * 2 * (strip_length + 1), 1e-12);
        pel_sim_destroy(sim);
    }
    end(&c, NULL);
}

/* turned as a whole, a strip feels the turned force; at rest the given one */
static void test_turns(void **unused)
{
    (void)unused;
    const double force[3] = {1, -2, 3}, angle = 0.7;
    cantilever c;
    begin(&c, 4, PEL_METHOD_EXPLICIT, force);
    c.def.solver.dt = 1e-4;
    pel_sim *sim = make_sim(&c.def);
    int32_t count = c.mesh->vertex_count;
    double *x = malloc(3 * (size_t)count * sizeof *x), *f = malloc(3 * (size_t)count * sizeof *f);
    for (int turned = 0; turned < 2; turned++) {
        double co = turned ? cos(angle) : 1, si = turned ? sin(angle) : 0, sum[3] = {0};
        for (int32_t v = 0; v < count; v++) {
            const double *rest = c.mesh->positions[v];
            pel_vec3_set(x + 3 * v, co * rest[0] - si * rest[2], rest[1], si * rest[0] + co * rest[2]);
        }
        assert_int_equal(pel_sim_set_positions(sim, 0, x, NULL), PEL_OK);
        pel_sim_get_forces(sim, 0, f);
        for (int32_t v = 0; v < count; v++)
            pel_vec3_add(sum, f + 3 * v, sum);
        const double expected[3] = {co * force[0] - si * force[2], force[1], si * force[0] + co * force[2]};
        assert_near(pel_vec3_distance(sum, expected), 0, IN_FLOAT(1e-9, 1e-2));
    }
    free(x);
    free(f);
    end(&c, sim);
}

/* The elastica from its free end, in the frame of that end, where the load stands across it: B theta'' = -P cos theta
   from theta = theta' = 0. Deflection and shortening of the end seen from the clamp, by Runge and Kutta. */
static void follow_elastica(double load, double way[2])
{
    enum { STEPS = 2000 };
    double y[4] = {0, 0, 0, 0}, h = strip_length / STEPS; /* place, angle, curvature */
    for (int n = 0; n < STEPS; n++) {
        double k[4][4], at[4];
        for (int part = 0; part < 4; part++) {
            double share = part == 0 ? 0 : part == 3 ? 1 : 0.5;
            for (int i = 0; i < 4; i++)
                at[i] = y[i] + (part > 0 ? share * h * k[part - 1][i] : 0);
            k[part][0] = -cos(at[2]);
            k[part][1] = -sin(at[2]);
            k[part][2] = at[3];
            k[part][3] = -load / stiffness * cos(at[2]);
        }
        for (int i = 0; i < 4; i++)
            y[i] += h / 6 * (k[0][i] + 2 * k[1][i] + 2 * k[2][i] + k[3][i]);
    }
    /* from the clamp to the end, turned so that the strip leaves along x */
    double x = -(cos(y[2]) * y[0] + sin(y[2]) * y[1]), z = sin(y[2]) * y[0] - cos(y[2]) * y[1];
    way[0] = x - strip_length;
    way[1] = z;
}

/* of the end, along x and z */
static void find_way(const cantilever *c, const pel_sim *sim, double way[2])
{
    double *x = malloc(3 * (size_t)c->mesh->vertex_count * sizeof *x);
    pel_sim_get_positions(sim, 0, x);
    way[0] = way[1] = 0;
    for (int k = 0; k < c->load.vertex_count; k++) {
        int32_t v = c->ends[1][k];
        way[0] += (x[3 * v] - c->mesh->positions[v][0]) / c->load.vertex_count;
        way[1] += x[3 * v + 2] / c->load.vertex_count;
    }
    free(x);
}

/* at once, or in parts of equal size */
static void test_cantilever(void **unused)
{
    (void)unused;
    if (sizeof(pel_real) == sizeof(float))
        skip(); /* positions in float strain a stiff sheet by 1e-7 */
    const struct {
        double load; /* P L^2 / B */
        int steps;
    } cases[] = {{1, 1}, {4, 1}, {8, 1}, {16, 4}};
    for (int i = 0; i < 4; i++) {
        double load = cases[i].load * stiffness / (strip_length * strip_length), way[2], expected[2];
        const double force[3] = {0, 0, load};
        const pel_key keys[2] = {{0, 0}, {1, 1}};
        cantilever c;
        pel_solver_reading reading;
        begin(&c, 32, PEL_METHOD_STATIC, force);
        c.load.keys = keys;
        c.load.key_count = 2;
        c.def.solver.dt = 1.0 / cases[i].steps;
        pel_sim *sim = make_sim(&c.def);
        run_steps(sim, cases[i].steps);
        pel_sim_get_solver(sim, &reading);
        assert_true(reading.converged);
        assert_true(reading.iterations <= 25);
        find_way(&c, sim, way);
        follow_elastica(load, expected);
        for (int k = 0; k < 2; k++)
            assert_near(way[k], expected[k], 5e-3 * strip_length); /* of 32 cells */
        end(&c, sim);
    }
}

/* small steps in time: work in is energy, drag aside */
static void test_ledger(void **unused)
{
    (void)unused;
    const double force[3] = {0, 0, 4};
    cantilever c;
    pel_sim_ledger ledger;
    begin(&c, 16, PEL_METHOD_EXPLICIT, force);
    c.def.solver.dt = 2e-4;
    pel_sim *sim = make_sim(&c.def);
    run_steps(sim, 5000);
    pel_sim_get_ledger(sim, &ledger);
    assert_true(ledger.work_loads > 0.05);
    assert_near(ledger.elastic + ledger.kinetic, ledger.work_loads, 5e-3 * ledger.work_loads);
    end(&c, sim);
}

static void expect_refused(cantilever *c, const char *words)
{
    pel_sim *sim;
    pel_error error;
    assert_int_equal(pel_sim_create(&c->def, &sim, &error), PEL_BAD_ARGUMENT);
    assert_non_null(strstr(error.what, words));
}

static void test_refusals(void **unused)
{
    (void)unused;
    const double force[3] = {0, 0, 1};
    cantilever c;
    begin(&c, 4, PEL_METHOD_STATIC, force);
    c.load.kind = PEL_LOAD_TOTAL;
    expect_refused(&c, "a follower load must be a force per length");
    c.load.kind = PEL_LOAD_PER_LENGTH;
    c.def.solver.path = PEL_PATH_ARC_LENGTH;
    expect_refused(&c, "no potential");
    c.def.solver.path = PEL_PATH_TIME;
    c.def.solver.analysis = PEL_ANALYSIS_BUCKLING;
    c.def.solver.mode_count = 1;
    expect_refused(&c, "no potential");
    end(&c, NULL);
}

static pel_status step_once(const void *data, pel_error *error)
{
    pel_sim *sim;
    pel_status status = pel_sim_create(data, &sim, error);
    if (status != PEL_OK) {
        assert_null(sim);
        return status;
    }
    status = pel_sim_step(sim, error);
    pel_sim_destroy(sim);
    return status;
}

static void test_allocations(void **unused)
{
    (void)unused;
    const double force[3] = {0, 0, 1};
    cantilever c;
    begin(&c, 4, PEL_METHOD_STATIC, force);
    assert_true(for_every_allocation_failure(step_once, &c.def) > 60);
    end(&c, NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_slopes),      cmocka_unit_test(test_perimeter), cmocka_unit_test(test_turns),
        cmocka_unit_test(test_cantilever),  cmocka_unit_test(test_ledger),    cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_allocations),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
