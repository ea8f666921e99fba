#include "random.h"
#include "sim/refine_fixture.h"

/* P_s(x) by Bonnet's recursion */
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
    pel_active active = {.relaxation = {.factor = 1}};
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
        pel_sim_measures before, after;
        pel_sim_measure(made.sim, &before);
        run_steps(made.sim, 1);
        pel_sim_measure(made.sim, &after);
        assert_true(after.spring_energy + after.volumetric_energy < before.spring_energy + before.volumetric_energy);
    }
    end(&made);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_polynomial),
        cmocka_unit_test(test_stage_count),
        cmocka_unit_test(test_energy_falls),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
