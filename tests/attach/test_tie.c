/* Ties: period of a spring, balance across a seam, momentum, derivatives, strength, times, tools, snapshots. */
#include "attach/tie.h"
#include "failing_malloc.h"
#include "newton/newton.h"
#include "pellicle/sim_ledger.h"
#include "pellicle/tear.h"
#include "shell_fixture.h"

enum { MOST = 64 };

typedef struct pair {
    pel_mesh *mesh[2];
    pel_body_def bodies[2];
    pel_model *model;
    int32_t left[2][MOST], right[2][MOST], all[MOST], left_count, right_count;
    pel_pose_key keys[2];
    pel_tool_def tool;
    pel_tie_def tie;
    pel_sim_def def;
} pair;

/* two strips of 0.2 m along x, a gap of 0.01 m between them; all vertices have 1 g */
static void begin(pair *p, pel_method method, double dt)
{
    memset(p, 0, sizeof *p);
    for (int b = 0; b < 2; b++) {
        p->left_count = p->right_count = 0;
        p->mesh[b] = make_grid(4, 2, 0.2, 0.1, PEL_GRID_UNION_JACK);
        for (int32_t v = 0; v < p->mesh[b]->vertex_count; v++) {
            double x = p->mesh[b]->positions[v][0];
            if (x < -0.0999)
                p->left[b][p->left_count++] = v;
            else if (x > 0.0999)
                p->right[b][p->right_count++] = v;
            p->mesh[b]->positions[v][0] += 0.21 * b;
            p->all[v] = v;
        }
        p->bodies[b] = shell_body(p->mesh[b], PEL_MEMBRANE_STVK);
        p->bodies[b].name = b == 0 ? "a" : "b";
        p->bodies[b].mass_kind = PEL_MASS_PER_VERTEX;
        p->bodies[b].mass = 1e-3;
    }
    p->def = lone_sim(NULL, method, dt);
    p->tie = pel_tie_def_default();
    p->tie.name = "tie";
    p->tie.body = 0;
    p->tie.vertices = p->right[0];
    p->tie.vertex_count = p->right_count;
    p->def.ties = &p->tie;
    p->def.tie_count = 1;
}

static pel_sim *create(pair *p, int32_t body_count, double gravity)
{
    pel_model_def def = pel_model_def_default();
    def.bodies = p->bodies;
    def.body_count = body_count;
    def.gravity[0] = gravity;
    assert_int_equal(pel_model_create(&def, &p->model, NULL), PEL_OK);
    p->def.model = p->model;
    return make_sim(&p->def);
}

static void end(pair *p, pel_sim *sim)
{
    pel_sim_destroy(sim);
    pel_model_destroy(p->model);
    pel_mesh_destroy(p->mesh[0]);
    pel_mesh_destroy(p->mesh[1]);
}

static void stitch(pair *p, double close)
{
    p->tie.target = PEL_TIE_VERTICES;
    p->tie.to_body = 1;
    p->tie.to_vertices = p->left[1];
    p->tie.close = close;
}

static const struct {
    pel_method method;
    double dt;
} dynamics[] = {{PEL_METHOD_IMPLICIT, 1e-3}, {PEL_METHOD_XPBD, 1e-3}, {PEL_METHOD_EXPLICIT, 1e-4}};

/* each vertex of mass m on a spring k: x = v / w sin(w t), w = sqrt(k / m), and the force k x */
static void test_period(void **unused)
{
    (void)unused;
    const double k = 4, m = 1e-3, speed = 0.1, w = sqrt(k / m);
    for (int d = 0; d < 3; d++) {
        pair p;
        begin(&p, dynamics[d].method, dynamics[d].dt);
        p.tie.vertices = p.all;
        p.tie.vertex_count = p.mesh[0]->vertex_count;
        p.tie.stiffness = k;
        p.bodies[0].velocity[2] = speed;
        p.def.solver.substeps = dynamics[d].method == PEL_METHOD_XPBD ? 40 : 0;
        pel_sim *sim = create(&p, 1, 0);
        double x[MOST][3], worst = 0;
        int steps = (int)(2 * 6.283185307179586 / w / dynamics[d].dt);
        for (int s = 1; s <= steps; s++) {
            run_steps(sim, 1);
            pel_sim_get_positions(sim, 0, x[0]);
            worst = fmax(worst, fabs(x[3][2] - speed / w * sin(w * s * dynamics[d].dt)));
        }
        assert_near(worst * w / speed, 0, 0.03);
        pel_tie_reading reading;
        pel_sim_get_tie(sim, 0, &reading);
        assert_near(reading.force[2], -k * x[3][2] * p.tie.vertex_count, 0.1 * k * speed / w * p.tie.vertex_count);
        assert_int_equal(reading.held_count, p.tie.vertex_count);
        end(&p, sim);
    }
}

/* a seam carries the weight of what hangs on it */
static void test_balance(void **unused)
{
    (void)unused;
    const struct {
        pel_method method;
        double dt, drag, tolerance;
        int steps;
    } cases[] = {{PEL_METHOD_STATIC, 0.1, 0, 1e-6, 12},
                 {PEL_METHOD_IMPLICIT, 0.02, 20, 1e-3, 200},
                 {PEL_METHOD_XPBD, 0.01, 20, 1e-2, 300}};
    for (int c = 0; c < 3; c++)
        for (int to_surface = 0; to_surface < 2; to_surface++) {
            pair p;
            begin(&p, cases[c].method, cases[c].dt);
            stitch(&p, 0.2);
            p.tie.target = to_surface ? PEL_TIE_BODY : PEL_TIE_VERTICES;
            p.bodies[0].pinned = p.left[0];
            p.bodies[0].pinned_count = p.left_count;
            p.def.solver.drag = cases[c].drag;
            pel_sim *sim = create(&p, 2, 9.81);
            run_steps(sim, cases[c].steps);
            double weight = 1e-3 * p.mesh[1]->vertex_count * 9.81;
            pel_tie_reading reading;
            pel_support_reading support;
            pel_sim_get_tie(sim, 0, &reading);
            pel_sim_get_support(sim, 0, &support);
            assert_near(reading.force[0], weight, cases[c].tolerance * weight);
            assert_near(support.force[0], 2 * weight, cases[c].tolerance * weight);
            assert_true(reading.longest < 1e-3);
            assert_true(reading.largest < weight);
            end(&p, sim);
        }
}

/* two free strips that swing about each other keep their momentum, and the angular momentum as the method does */
static void test_momentum(void **unused)
{
    (void)unused;
    for (int d = 0; d < 3; d++) {
        pair p;
        begin(&p, dynamics[d].method, dynamics[d].dt);
        stitch(&p, 0.05);
        p.tie.target = PEL_TIE_BODY;
        p.bodies[0].velocity[2] = 0.3;
        p.bodies[1].velocity[1] = -0.2;
        pel_sim *sim = create(&p, 2, 0);
        double x[MOST][3], v[MOST][3], momentum[2][3] = {{0}}, turning[2][3] = {{0}}, moment[3];
        for (int after = 0; after < 2; after++) {
            for (int b = 0; b < 2; b++) {
                pel_sim_get_positions(sim, b, x[0]);
                pel_sim_get_velocities(sim, b, v[0]);
                for (int32_t i = 0; i < p.mesh[b]->vertex_count; i++) {
                    pel_vec3_along(momentum[after], 1e-3, v[i], momentum[after]);
                    pel_vec3_cross(x[i], v[i], moment);
                    pel_vec3_along(turning[after], 1e-3, moment, turning[after]);
                }
            }
            if (after == 0)
                run_steps(sim, 100);
        }
        pel_tie_reading reading;
        pel_sim_get_tie(sim, 0, &reading);
        assert_true(dynamics[d].method == PEL_METHOD_EXPLICIT || reading.largest > 0);
        double size = pel_vec3_length(momentum[0]);
        assert_near(pel_vec3_distance(momentum[0], momentum[1]), 0, (sizeof(pel_real) == 4 ? 1e-4 : 1e-9) * size);
        size = pel_vec3_length(turning[0]);
        /* implicit and xpbd damp what they do not resolve */
        double most = dynamics[d].method == PEL_METHOD_EXPLICIT && sizeof(pel_real) == 8 ? 1e-9 : 2e-3;
        assert_near(pel_vec3_distance(turning[0], turning[1]), 0, most * size);
        end(&p, sim);
    }
}

/* gradient and Hessian at stretched threads against central differences of the energy */
static void test_derivatives(void **unused)
{
    (void)unused;
    random_state random = {11};
    for (int target = 0; target < 3; target++) {
        pair p;
        begin(&p, PEL_METHOD_IMPLICIT, 1e-3);
        stitch(&p, target == 2 ? 1 : 0);
        p.tie.target = target == 0 ? PEL_TIE_PLACE : target == 1 ? PEL_TIE_BODY : PEL_TIE_VERTICES;
        p.tie.stiffness = 3;
        pel_sim *sim = create(&p, 2, 0);
        run_steps(sim, 1);
        size_t count = 3 * (size_t)sim->model->vertex_count;
        double *x = malloc(count * sizeof *x), *g = calloc(3 * count, sizeof *g), *h = g + count, *l = h + count;
        for (size_t u = 0; u < count; u++)
            x[u] = (double)sim->state->position[u / 3][u % 3] + random_between(&random, -0.05, 0.05);
        pel_ties_evaluate(sim, 2e-3, x, g);
        double square = 0;
        for (size_t u = 0; u < count; u++) {
            double at = x[u], step = 1e-6, energy[2];
            memset(h, 0, 2 * count * sizeof *h);
            x[u] = at + step;
            energy[0] = pel_ties_evaluate(sim, 2e-3, x, h);
            x[u] = at - step;
            energy[1] = pel_ties_evaluate(sim, 2e-3, x, l);
            x[u] = at;
            assert_near(g[u], (energy[0] - energy[1]) / (2 * step), 1e-8);
            square += g[u] * g[u];
            const pel_newton_system system = pel_newton_system_of(sim->newton);
            if (target != 0 || system.matrix == NULL || square == 0)
                continue;
            memset(system.matrix->values, 0, (size_t)system.matrix->block_start[system.matrix->block_count] * 8);
            pel_ties_add_matrix(sim, 2e-3, x, system.matrix);
            int32_t v = (int32_t)(u / 3), block = pel_matrix_block(system.matrix, v, v);
            for (int a = 0; a < 3; a++)
                assert_near(system.matrix->values[system.matrix->block_start[block] + a + 3 * (int32_t)(u % 3)],
                            (h[3 * v + a] - l[3 * v + a]) / (2 * step), 1e-6);
        }
        assert_true(square > 1e-6);
        free(x);
        free(g);
        end(&p, sim);
    }
}

/* what is more than the strength opens for good, and is counted; until opens too */
static void test_opens(void **unused)
{
    (void)unused;
    for (int d = 0; d < 2; d++)
        for (int by_force = 0; by_force < 2; by_force++) {
            pair p;
            begin(&p, dynamics[d].method, 0.01);
            p.tie.strength = by_force ? 0.02 : 1;
            p.tie.until = by_force ? (double)HUGE_VAL : 0.1;
            p.def.solver.drag = 5;
            pel_sim *sim = create(&p, 1, 9.81);
            run_steps(sim, 8);
            pel_tie_reading reading;
            pel_sim_get_tie(sim, 0, &reading);
            assert_int_equal(reading.held_count, by_force ? 0 : p.right_count);
            run_steps(sim, 8);
            pel_sim_get_tie(sim, 0, &reading);
            assert_int_equal(reading.held_count, 0);
            assert_int_equal(reading.lost_count, by_force ? p.right_count : 0);
            assert_true((reading.lost_time > 0) == (by_force == 1));
            double v[MOST][3];
            pel_sim_get_velocities(sim, 0, v[0]);
            assert_true(v[0][0] > 0.1);
            end(&p, sim);
        }
}

/* a tool carries them from where they are; it has the opposite force, and its work goes into the strip */
static void test_tool(void **unused)
{
    (void)unused;
    for (int d = 0; d < 2; d++) {
        pair p;
        begin(&p, dynamics[d].method, 0.01);
        p.bodies[0].pinned = p.left[0];
        p.bodies[0].pinned_count = p.left_count;
        for (int k = 0; k < 2; k++)
            p.keys[k] = (pel_pose_key){0.5 * k, {0.3 + 0.01 * k, 0, 0}, {0, 0, 0, 1}, {0}};
        p.tool = pel_tool_def_default();
        p.tool.name = "hook";
        p.tool.radius = 0.01;
        p.tool.press = false;
        p.tool.keys = p.keys;
        p.tool.key_count = 2;
        p.def.tools = &p.tool;
        p.def.tool_count = 1;
        p.tie.target = PEL_TIE_TOOL;
        p.tie.tool = 0;
        p.def.solver.drag = 10;
        pel_sim *sim = create(&p, 1, 0);
        run_steps(sim, 200);
        pel_tie_reading reading;
        pel_tool_reading tool;
        pel_sim_ledger ledger;
        pel_sim_get_tie(sim, 0, &reading);
        pel_sim_get_tool(sim, 0, &tool);
        pel_sim_get_ledger(sim, &ledger);
        double x[MOST][3];
        pel_sim_get_positions(sim, 0, x[0]);
        assert_near(x[p.right[0][0]][0], 0.11, 2e-4);
        assert_true(reading.force[0] > 1);
        assert_near(tool.force[0], -reading.force[0], 1e-9 * reading.force[0]);
        assert_near(ledger.work_tools, ledger.elastic, (d == 0 ? 1e-3 : 0.05) * ledger.elastic);
        /* sweeps of xpbd leave the elements of a step behind the tool */
        assert_near(ledger.energy_error, 0, (d == 0 ? 1e-3 : 0.05) * ledger.elastic);
        end(&p, sim);
    }
}

/* the same bits after a snapshot while a seam closes */
static void test_resumes(void **unused)
{
    (void)unused;
    for (int d = 0; d < 3; d++) {
        double x[2][MOST][3], work[2];
        for (int resumes = 0; resumes < 2; resumes++) {
            pair p;
            begin(&p, dynamics[d].method, dynamics[d].dt);
            stitch(&p, 0.02);
            pel_sim *sim = create(&p, 2, 1);
            run_steps(sim, 11);
            if (resumes)
                sim = resume_sim(sim, &p.def);
            run_steps(sim, 15);
            pel_sim_ledger ledger;
            pel_sim_get_ledger(sim, &ledger);
            pel_sim_get_positions(sim, 1, x[resumes][0]);
            work[resumes] = ledger.work_tools;
            end(&p, sim);
        }
        assert_memory_equal(x[0], x[1], 15 * sizeof x[0][0]);
        assert_true(work[0] == work[1]);
    }
}

static void expect_refused(pair *p, const char *words)
{
    pel_sim *sim;
    pel_error error;
    pel_status status = pel_sim_create(&p->def, &sim, &error);
    if (status == PEL_OK || strstr(error.what, words) == NULL || error.remedy[0] == '\0')
        fail_msg("expected '%s', got '%s'", words, error.what);
}

static void test_refusals(void **unused)
{
    (void)unused;
    pair p;
    begin(&p, PEL_METHOD_XPBD, 0.01);
    stitch(&p, 0);
    pel_sim *sim = create(&p, 2, 0);
    const pel_tie_def good = p.tie;
    p.tie.name = "";
    expect_refused(&p, "no name");
    p.tie = good;
    p.tie.body = 2;
    expect_refused(&p, "body that does not exist");
    p.tie = good;
    p.tie.vertex_count = 0;
    expect_refused(&p, "no vertex");
    p.tie = good;
    p.tie.to_body = 3;
    expect_refused(&p, "leads to a body that does not exist");
    p.tie = good;
    p.tie.to_vertices = NULL;
    expect_refused(&p, "leads to a vertex");
    p.tie = good;
    p.tie.target = PEL_TIE_BODY;
    p.tie.to_body = 0;
    expect_refused(&p, "own surface");
    p.tie.target = PEL_TIE_TOOL;
    expect_refused(&p, "tool that does not exist");
    p.tie.target = PEL_TIE_SEQUENCE;
    expect_refused(&p, "no sequence");
    p.tie = good;
    p.tie.to_body = 0;
    p.tie.to_vertices = p.tie.vertices;
    expect_refused(&p, "tied to itself");
    p.tie = good;
    p.tie.stiffness = -1;
    expect_refused(&p, "out of range");
    p.tie = good;
    p.tie.until = p.tie.from;
    expect_refused(&p, "ends before it begins");
    p.tie = good;
    p.def.solver.method = PEL_METHOD_QUASI_STATIC;
    expect_refused(&p, "no attachments");
    p.def.solver.method = PEL_METHOD_PBD;
    expect_refused(&p, "no attachments");
    p.def.solver.method = PEL_METHOD_XPBD;
    const int32_t path[2] = {0, 1};
    assert_int_equal(pel_cut(sim, 0, path, 2, NULL), PEL_BAD_ARGUMENT);
    p.def.solver.method = PEL_METHOD_EXPLICIT;
    p.def.solver.dt = 1e-4;
    p.tie.stiffness = 1e6;
    expect_refused(&p, "unstable at dt");
    end(&p, sim);
}

static void test_memory(void **unused)
{
    (void)unused;
    pair p;
    begin(&p, PEL_METHOD_STATIC, 0.1);
    stitch(&p, 0);
    p.tie.target = PEL_TIE_BODY;
    pel_sim *sim = create(&p, 2, 0);
    for_every_allocation_failure(create_sim, &p.def);
    end(&p, sim);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_period),      cmocka_unit_test(test_balance),  cmocka_unit_test(test_momentum),
        cmocka_unit_test(test_derivatives), cmocka_unit_test(test_opens),    cmocka_unit_test(test_tool),
        cmocka_unit_test(test_resumes),     cmocka_unit_test(test_refusals), cmocka_unit_test(test_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
