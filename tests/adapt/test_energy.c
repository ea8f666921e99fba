/* An event of refinement neither gives nor takes elastic energy, beyond 1 % of the body's. */
#include "sim/refine_fixture.h"

#include "shell_fixture.h"

typedef enum deformation { POKE, DEEP_POKE, STRETCH, THREE_AXES, TWIST, DEFORMATIONS } deformation;

typedef enum tissue { SPRINGS, THIN_SHELL, ISOMETRIC_SHELL, THICK_SHELL, TISSUES } tissue;

static void deform_point(deformation how, double p[3])
{
    double x = p[0], y = p[1], angle = 0.5 * p[2];
    switch (how) {
    case POKE:
    case DEEP_POKE:
        p[2] -= (how == POKE ? 0.05 : 0.3) * exp(-4 * (x * x + y * y)) * (p[2] > -1e-9);
        break;
    case STRETCH:
        p[0] *= 1.3;
        break;
    case THREE_AXES:
        p[0] *= 1.2;
        p[1] *= 0.9;
        p[2] *= 1.1;
        break;
    default:
        p[0] = cos(angle) * x - sin(angle) * y;
        p[1] = sin(angle) * x + cos(angle) * y;
    }
}

/* deforms the rest shape, turns it by 0.7 and moves it */
static void deform(const bench *made, deformation how)
{
    int32_t count = pel_sim_vertex_count(made->sim, 0);
    double *x = malloc(3 * (size_t)count * sizeof *x);
    pel_sim_get_rest_positions(made->sim, 0, x);
    for (int32_t v = 0; v < count; v++) {
        double *p = &x[3 * v];
        deform_point(how, p);
        double turned[3] = {cos(0.7) * p[0] - sin(0.7) * p[2] + 0.3, p[1] - 0.2, sin(0.7) * p[0] + cos(0.7) * p[2]};
        memcpy(p, turned, sizeof turned);
    }
    assert_int_equal(pel_sim_set_positions(made->sim, 0, x, NULL), PEL_OK);
    free(x);
}

/* without volumetric springs */
static double energy_of(const bench *made)
{
    pel_sim_measures measures;
    pel_sim_measure(made->sim, &measures);
    return measures.elastic_energy - measures.volumetric_energy;
}

static bench make_tissue(pel_mesh *mesh, tissue what)
{
    bool isometric = what == ISOMETRIC_SHELL, thick = what == THICK_SHELL;
    pel_body_def body = what == SPRINGS ? ball(mesh, 2) : shell_body(mesh, PEL_MEMBRANE_STVK);
    body.refine.levels = 2;
    body.shell.bending.model = isometric ? PEL_BENDING_ISOMETRIC : PEL_BENDING_HINGE;
    if (what == SPRINGS)
        body.shell.bending.model = pel_body_def_default().shell.bending.model;
    if (thick)
        body.shell.membrane.thickness.value = 0.1;
    pel_sim_def def = pel_sim_def_default();
    def.solver.method = what == SPRINGS ? PEL_METHOD_QUASI_STATIC : PEL_METHOD_XPBD;
    return begin(mesh, &body, &def);
}

/* the largest change by an event, refined and coarsened at every 7th vertex; share of the energy before it */
static double largest_change(pel_mesh *mesh, tissue what, deformation how)
{
    bench made = make_tissue(mesh, what);
    double largest = 0;
    for (int32_t v = 0; v < mesh->vertex_count; v += LONG(7, 40))
        for (int32_t level = 2; level >= 0; level -= 1) {
            deform(&made, how);
            double before = energy_of(&made);
            refine(&made, v, level);
            largest = fmax(largest, fabs(energy_of(&made) / before - 1));
        }
    end(&made);
    return largest;
}

static void test_closed(void **unused)
{
    (void)unused;
    skip_if_slow();
    for (int what = 0; what < TISSUES; what++)
        for (int how = 0; how < DEFORMATIONS; how++) {
            double change = largest_change(make_sphere(8), (tissue)what, (deformation)how);
            print_message("ball %d, deformation %d: %.2f %%\n", what, how, 100 * change);
            assert_true(change < 0.01);
        }
}

static void test_sheet(void **unused)
{
    (void)unused;
    for (int what = 0; what < TISSUES; what++)
        for (int how = 0; how < DEFORMATIONS - 1; how++) {
            double change =
                largest_change(make_grid(12, 12, 2, 2, PEL_GRID_UNION_JACK), (tissue)what, (deformation)how);
            print_message("sheet %d, deformation %d: %.2f %%\n", what, how, 100 * change);
            assert_true(change < 0.01);
        }
}

/* a rigid motion keeps zero energy, and rounding moves nothing */
static void test_rigid(void **unused)
{
    (void)unused;
    for (int what = 0; what < TISSUES; what++) {
        pel_mesh *mesh = make_sphere(8);
        bench made = make_tissue(mesh, (tissue)what);
        refine(&made, 10, 2);
        int32_t count = pel_sim_vertex_count(made.sim, 0);
        double *x = malloc(3 * (size_t)count * sizeof *x), *rest = malloc(3 * (size_t)count * sizeof *x);
        pel_sim_get_positions(made.sim, 0, x);
        pel_sim_get_rest_positions(made.sim, 0, rest);
        for (int32_t i = 0; i < 3 * count; i++)
            assert_near(x[i], rest[i], rounding(1e-14, 1e-6));
        free(x);
        free(rest);
        end(&made);
    }
}

/* the positions that come in exchange for energy take no momentum with them, and pinned vertices stay */
static void test_momentum(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_grid(12, 12, 2, 2, PEL_GRID_UNION_JACK);
    const int32_t pinned[3] = {0, 1, 2};
    pel_body_def body = shell_body(mesh, PEL_MEMBRANE_STVK);
    body.shell.bending.model = PEL_BENDING_HINGE;
    body.shell.membrane.thickness.value = 0.1;
    body.refine.levels = 2;
    body.pinned = pinned;
    body.pinned_count = 3;
    pel_sim_def def = pel_sim_def_default();
    def.solver.method = PEL_METHOD_XPBD;
    bench made = begin(mesh, &body, &def);
    deform(&made, POKE);
    const pel_model *model = made.sim->model;
    pel_state *state = made.sim->state;
    random_state random = {3};
    for (int32_t v = 0; v < model->vertex_count; v++)
        for (int c = 0; c < 3 && model->inverse_mass[v] > 0; c++)
            state->velocity[v][c] = (pel_real)random_between(&random, -1, 1);
    pel_record held = state->position[model->bodies[0].model_index[1]];
    for (int event = 0; event < 20; event++) {
        double momentum[2][3] = {{0}};
        for (int after = 0; after < 2; after++) {
            if (after == 1)
                refine(&made, 60 + event, event % 3);
            for (int32_t v = 0; v < model->vertex_count; v++)
                for (int c = 0; c < 3; c++)
                    momentum[after][c] += (double)model->mass[v] * (double)state->velocity[v][c];
        }
        for (int c = 0; c < 3; c++)
            assert_near(momentum[1][c], momentum[0][c], rounding(1e-12, 1e-3));
    }
    for (int c = 0; c < 3; c++)
        assert_true(state->position[model->bodies[0].model_index[1]][c] == held[c]);
    end(&made);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_closed),
        cmocka_unit_test(test_sheet),
        cmocka_unit_test(test_rigid),
        cmocka_unit_test(test_momentum),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
