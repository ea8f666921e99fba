/* P_s(x) by Bonnet's recursion */
#include "random.h"
#include "sim/refine_fixture.h"
#include "solve/relax.h"
#include "stage/stage.h"

static double legendre(int32_t s, double x)
{
    double before = 1, now = x;
    for (int32_t j = 2; j <= s; j++) {
        double next = ((2 * j - 1) * x * now - (j - 1) * before) / j;
        before = now;
        now = next;
    }
    return s == 0 ? 1 : now;
}

/* a ball under a uniform force moves as a whole: its springs stay at rest and each step takes away the same share of
   the way that is left, which is the polynomial of the stages */
static void test_polynomial(void **unused)
{
    (void)unused;
    for (int32_t level = 1; level <= 3; level++) {
        pel_mesh *mesh = make_sphere(5);
        pel_body_def body = ball(mesh, level);
        body.refine.everywhere = true;
        body.volumetric_stiffness.value = 6;
        pel_load_def load = pel_load_def_default();
        load.force[2] = 0.01 * 252;
        pel_sim_def def = pel_sim_def_default();
        def.loads = &load;
        def.load_count = 1;
        bench made = begin(mesh, &body, &def);
        run_steps(made.sim, 1);
        const pel_relax *relax = made.sim->relax;
        const pel_model *model = made.sim->model;
        int32_t s = pel_relax_stage_count(relax, 0), pole = nearest_vertex(mesh, 0, 0, 1);
        assert_true(s >= 2 && relax->border_count == 0);
        /* f / m and k' / m are the same for all vertices up to the shares of area: take those of the whole */
        double mass = 0, stiffness = 0;
        for (int32_t v = 0; v < model->vertex_count; v++) {
            mass += (double)model->mass[v];
            stiffness += (double)model->rest[v][3];
        }
        double z = made.sim->active->relaxation.factor * stiffness / mass,
               left = legendre(s, 1 - 2 * z / (s * (s + 1)));
        double start = mesh->positions[pole][2], end_height = start + 0.01 * 252 / stiffness;
        assert_true(z > 0.1);
        for (int n = 1; n <= 5; n++) {
            double expected = end_height - pow(left, n) * (end_height - start);
            assert_near(height_of(made.sim, pole), expected, 0.02 * (end_height - start));
            run_steps(made.sim, 1);
        }
        end(&made);
    }
}

/* s (s + 1) is the range of stability, of which nine tenths are used; one stage has that of one plain step */
static void test_stage_count(void **unused)
{
    (void)unused;
    pel_refined_model active = {.relaxation = {.factor = 1}};
    for (int32_t s = 1; s < 40; s++) {
        pel_relax relax = {.active = &active, .rate = 0.8999 * s * (s + 1)};
        assert_int_equal(pel_relax_stage_count(&relax, 0), s);
        relax.rate = 0.9001 * s * (s + 1);
        assert_int_equal(pel_relax_stage_count(&relax, 0), s + 1);
        assert_int_equal(pel_relax_stage_count(&relax, 0.9 * ((s + 1.5) * (s + 2.5) - s * (s + 1))), s + 2);
    }
}

static double noise(random_state *random)
{
    return random_between(random, -0.05, 0.05);
}

/* stages of random positions of a locally refined ball never raise its energy, whatever vertices are fine, and those
   that are not keep the bits of the plain step */
static void test_energy_falls(void **unused)
{
    (void)unused;
    random_state random = {5};
    pel_mesh *mesh = make_sphere(6);
    pel_body_def body = ball(mesh, 3);
    pel_sim_def def = pel_sim_def_default();
    bench made = begin(mesh, &body, &def);
    refine(&made, 10, 3);
    refine(&made, 200, 2);
    refine(&made, 300, 1);
    pel_state *state = made.sim->state;
    const pel_model *model = made.sim->model;
    int32_t fine = 0, plain = 0;
    for (int32_t v = 0; v < model->vertex_count; v++) {
        fine += made.sim->active->is_fine[v];
        plain += model->mesh_vertex[v] >= 0 && !made.sim->active->is_fine[v];
    }
    assert_true(fine > 200 && plain > 100);
    for (int round = 0; round < 20; round++) {
        for (int32_t v = 0; v < model->vertex_count; v++)
            for (int c = 0; c < 3; c++)
                state->position[v][c] = model->rest[v][c] + (pel_real)noise(&random);
        made.sim->present.has_force = false;
        pel_sim_measures before, after;
        pel_sim_measure(made.sim, &before);
        run_steps(made.sim, 1);
        pel_sim_measure(made.sim, &after);
        assert_true(after.spring_energy + after.volumetric_energy < before.spring_energy + before.volumetric_energy);
    }
    end(&made);
}

/* one step of the formulas of solve/relax.h over whole arrays: the plain vertices first, then the others by stages */
static void step_slowly(const bench *made, pel_record *next)
{
    const pel_sim *sim = made->sim;
    const pel_model *model = sim->model;
    const pel_refined_model *active = sim->active;
    size_t size = (size_t)model->vertex_count * sizeof(pel_record);
    pel_state state = *sim->state;
    pel_record *force = aligned_alloc(64, size), *before = aligned_alloc(64, size), *velocity = aligned_alloc(64, size);
    bool keep = sim->step.keep_velocity;
    double factor = sim->step.alpha * sim->step.dt * sim->step.dt;
    for (int32_t v = 0; v < model->vertex_count; v++)
        velocity[v] = (state.position[v] - state.position_before[v]) / (pel_real)sim->step.dt;
    pel_body_forces(model, &state, keep ? velocity : NULL, NULL, force);
    for (int32_t v = 0; v < model->vertex_count; v++)
        next[v] = state.position[v] + (active->is_fine[v] ? 0 : (pel_real)factor * model->inverse_mass[v]) * force[v];
    memcpy(before, next, size);
    int32_t s = pel_relax_stage_count(sim->relax, 0);
    for (int32_t j = 1; j <= s; j++) {
        state.position = next;
        pel_body_forces(model, &state, NULL, NULL, force);
        for (int32_t v = 0; v < model->vertex_count; v++) {
            if (!active->is_fine[v])
                continue;
            double rate = factor * (double)model->inverse_mass[v], way[3], e[3], along = 0, square = 0;
            double b = keep ? rate * (double)model->damping[v] / sim->step.dt : 0;
            double c = keep ? rate * (double)model->volumetric_damping[v] / sim->step.dt : 0;
            for (int i = 0; i < 3; i++) {
                way[i] = rate * (double)force[v][i] / (1 + b);
                e[i] = (double)sim->state->position[v][i] - (double)model->rest[v][i];
                along += way[i] * e[i];
                square += e[i] * e[i];
            }
            for (int i = 0; i < 3; i++) {
                double now = (double)next[v][i], old = (double)before[v][i];
                way[i] -= square > 0 ? c / (1 + b + c) * along / square * e[i] : 0;
                before[v][i] = next[v][i];
                next[v][i] =
                    (pel_real)(now + (j - 1.0) / j * (now - old) + (2.0 * j - 1) / j * 2 / (s * (s + 1.0)) * way[i]);
            }
        }
    }
    free(force);
    free(before);
    free(velocity);
}

static void test_slow_steps(void **unused)
{
    (void)unused;
    for (int keep = 0; keep < 2; keep++) {
        random_state random = {7};
        pel_mesh *mesh = make_sphere(6);
        pel_body_def body = ball(mesh, 3);
        pel_sim_def def = pel_sim_def_default();
        def.solver.keep_velocity = keep;
        def.solver.alpha = 40;
        bench made = begin(mesh, &body, &def);
        refine(&made, 10, 3);
        refine(&made, 200, 2);
        refine(&made, 300, 1);
        const pel_model *model = made.sim->model;
        pel_record *expected = aligned_alloc(64, (size_t)model->vertex_count * sizeof *expected);
        for (int32_t v = 0; v < model->vertex_count; v++)
            for (int c = 0; c < 3; c++)
                made.sim->state->position[v][c] = model->rest[v][c] + (pel_real)noise(&random);
        for (int n = 0; n < 5; n++) {
            /* another surface with much of the same border */
            if (n == 2)
                refine(&made, 100, 1);
            assert_true(made.sim->model == model);
            /* the lists are made in the step */
            pel_relax_follow(made.sim->relax);
            step_slowly(&made, expected);
            run_steps(made.sim, 1);
            for (int32_t v = 0; v < model->vertex_count; v++)
                for (int c = 0; c < 3 && model->mesh_vertex[v] >= 0; c++)
                    assert_near((double)made.sim->state->position[v][c], (double)expected[v][c], rounding(1e-13, 2e-6));
        }
        free(expected);
        end(&made);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_polynomial),
        cmocka_unit_test(test_stage_count),
        cmocka_unit_test(test_energy_falls),
        cmocka_unit_test(test_slow_steps),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
