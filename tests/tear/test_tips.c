/* Tips of cuts: the configurational force against the energy that longer cuts release, on several meshes and laws. */
#include "shell_fixture.h"

#include "failing_malloc.h"
#include "pellicle/sim.h"
#include "pellicle/tear.h"

enum { MOST_PATH = 64, MOST_PINS = 256 };
#define WIDTH 1.0
#define THICKNESS 0.01

typedef struct panel {
    pel_mesh *mesh;
    pel_model *model;
    pel_sim *sim;
    double energy;
    pel_tip tips[3];
    int32_t tip_count;
} panel;

typedef struct panel_def {
    int32_t cells;
    pel_grid_diagonals diagonals;
    double roughness; /* of the mesh, over the edge */
    pel_membrane_kind law;
    bool has_springs;
    double stretch;
    bool from_border;
    double shear;   /* of the ends, over the width */
    double tearing; /* m, toughness over young */
} panel_def;

static double border_of(const pel_mesh *mesh, int sign)
{
    double low[3], high[3];
    pel_mesh_box(mesh, low, high);
    return sign > 0 ? high[1] : low[1];
}

/* vertices of the grid row y = 0 from `from` to `to`, by x */
static int32_t row(const pel_mesh *mesh, double from, double to, int32_t *path)
{
    int32_t count = 0;
    for (double x = from; x < to + 1e-9; x += WIDTH / 1000) {
        int32_t v = nearest_vertex(mesh, x, 0, 0);
        if (fabs(mesh->positions[v][1]) < 1e-9 && mesh->positions[v][0] > from - 1e-9 &&
            mesh->positions[v][0] < to + 1e-9 && (count == 0 || path[count - 1] != v))
            path[count++] = v;
    }
    return count;
}

static void roughen(pel_mesh *mesh, const panel_def *def)
{
    random_state random = {3};
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        double *x = mesh->positions[v], shift[2];
        for (int c = 0; c < 2; c++)
            shift[c] = random_between(&random, -def->roughness, def->roughness) * WIDTH / def->cells;
        if (fabs(x[0]) > 0.499 * WIDTH || fabs(x[1]) > 0.499 * WIDTH || fabs(x[1]) < 1e-9)
            continue;
        x[0] += shift[0];
        x[1] += shift[1];
    }
}

/* a panel whose ends are drawn apart, with a cut from -length to length (or from the border to length) along x */
static panel make_panel(const panel_def *def, double length)
{
    panel p = {.mesh = make_grid(def->cells, def->cells, WIDTH, WIDTH, def->diagonals)};
    int32_t low[MOST_PINS], high[MOST_PINS], low_count = 0, high_count = 0, path[MOST_PATH];
    roughen(p.mesh, def);
    for (int32_t v = 0; v < p.mesh->vertex_count; v++) {
        if (fabs(p.mesh->positions[v][1] - border_of(p.mesh, -1)) < 1e-9)
            low[low_count++] = v;
        if (fabs(p.mesh->positions[v][1] - border_of(p.mesh, 1)) < 1e-9)
            high[high_count++] = v;
    }
    pel_body_def body = shell_body(p.mesh, def->law);
    body.shell.membrane.poisson = 0.3;
    body.shell.membrane.toughness.value = def->tearing * body.shell.membrane.young.value;
    body.pinned = low;
    body.pinned_count = low_count;
    if (def->has_springs) {
        body.shell.membrane.on = false;
        body.spring_stiffness.value = 1e5;
        body.spring_thickness = THICKNESS;
    }
    p.model = make_model(&body);
    pel_sim_def sim = lone_sim(p.model, PEL_METHOD_STATIC, 1);
    pel_support_def supports[2] = {pel_support_def_default(), pel_support_def_default()}, *support = supports;
    int32_t *all = calloc((size_t)p.mesh->vertex_count, sizeof *all);
    for (int32_t v = 0; v < p.mesh->vertex_count; v++)
        all[v] = v;
    support->name = "end";
    support->vertices = high;
    support->vertex_count = high_count;
    support->displacement[1] = def->stretch * WIDTH;
    support->displacement[0] = def->shear * WIDTH;
    /* the sheet stays flat */
    supports[1].name = "plane";
    supports[1].vertices = all;
    supports[1].vertex_count = p.mesh->vertex_count;
    supports[1].fix[0] = supports[1].fix[1] = false;
    sim.supports = supports;
    sim.support_count = 2;
    p.sim = make_sim(&sim);
    free(all);
    int32_t count = row(p.mesh, def->from_border ? -0.5 * WIDTH : -length, length, path);
    assert_true(count < MOST_PATH);
    assert_int_equal(pel_cut(p.sim, 0, path, count, NULL), PEL_OK);
    run_steps(p.sim, 1);
    pel_sim_measures m;
    pel_sim_measure(p.sim, &m);
    p.energy = m.elastic_energy;
    assert_int_equal(pel_sim_tips(p.sim, 0, p.tips, 3, &p.tip_count, NULL), PEL_OK);
    assert_int_equal(p.tip_count, def->from_border ? 1 : 2);
    return p;
}

static void end_panel(panel *p)
{
    pel_sim_destroy(p->sim);
    pel_model_destroy(p->model);
    pel_mesh_destroy(p->mesh);
}

/* the mean of the forces over the energy released between two lengths of a cut */
static double ratio_of(const panel_def *def, double *release)
{
    /* by two edges: vertices of the union jack take turns in the number of their triangles */
    double way = 2 * WIDTH / def->cells, mean = 0;
    panel shorter = make_panel(def, 0.2 * WIDTH - way / 2), longer = make_panel(def, 0.2 * WIDTH + way / 2);
    double drop = (shorter.energy - longer.energy) / (way * shorter.tip_count);
    for (int32_t t = 0; t < shorter.tip_count; t++) {
        const pel_tip *tips[2] = {&shorter.tips[t], &longer.tips[t]};
        for (int i = 0; i < 2; i++) {
            mean += pel_vec3_dot(tips[i]->force, tips[i]->ahead) / (2 * shorter.tip_count);
            /* straight ahead, by symmetry */
            assert_near(fabs(tips[i]->ahead[0]), 1, 1e-9);
            assert_near(pel_vec3_dot(tips[i]->force, tips[i]->ahead) / tips[i]->release, 1, 0.03);
        }
    }
    *release = mean;
    end_panel(&shorter);
    end_panel(&longer);
    return mean / drop;
}

/* within 3 % of the energy that is released, on regular and irregular meshes, at small and large stretch; cuts inside
   and from a border */
static void test_energy_released(void **unused)
{
    (void)unused;
    const panel_def cases[] = {
        {40, PEL_GRID_UNION_JACK, 0, PEL_MEMBRANE_NEO_HOOKEAN, false, 0.01, false, 0, 0},
        {40, PEL_GRID_UNION_JACK, 0, PEL_MEMBRANE_NEO_HOOKEAN, false, 0.3, false, 0, 0},
        {40, PEL_GRID_UNION_JACK, 0.2, PEL_MEMBRANE_STVK, false, 0.01, true, 0, 0},
        {40, PEL_GRID_UNION_JACK, 0.2, PEL_MEMBRANE_GENT, false, 0.2, false, 0, 0},
        {40, PEL_GRID_ONE_DIAGONAL, 0, PEL_MEMBRANE_NEO_HOOKEAN, false, 0.01, false, 0, 0},
        {40, PEL_GRID_ONE_DIAGONAL, 0, PEL_MEMBRANE_NEO_HOOKEAN, true, 0.01, false, 0, 0},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        double release, ratio = ratio_of(&cases[i], &release);
        assert_near(ratio, 1, 0.03);
    }
}

/* the same force on meshes of several kinds and sizes */
static void test_scatter(void **unused)
{
    (void)unused;
    const panel_def cases[] = {
        {40, PEL_GRID_UNION_JACK, 0, PEL_MEMBRANE_NEO_HOOKEAN, false, 0.05, false, 0, 0},
        {30, PEL_GRID_UNION_JACK, 0.2, PEL_MEMBRANE_NEO_HOOKEAN, false, 0.05, false, 0, 0},
        {40, PEL_GRID_UNION_JACK, 0.2, PEL_MEMBRANE_NEO_HOOKEAN, false, 0.05, false, 0, 0},
        {40, PEL_GRID_ONE_DIAGONAL, 0, PEL_MEMBRANE_NEO_HOOKEAN, false, 0.05, false, 0, 0},
        {50, PEL_GRID_UNION_JACK, 0.1, PEL_MEMBRANE_NEO_HOOKEAN, false, 0.05, false, 0, 0},
    };
    double first = 0;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        panel p = make_panel(&cases[i], 0.2 * WIDTH);
        first = i == 0 ? p.tips[0].release : first;
        assert_near(p.tips[0].release / first, 1, 0.02);
        end_panel(&p);
    }
}

/* rad, of the force on the tip of a cut from the border, towards its side y > 0 */
static double angle_of(const panel_def *def)
{
    panel p = make_panel(def, 0);
    double angle = atan2(p.tips[0].force[1], p.tips[0].force[0]);
    end_panel(&p);
    return angle;
}

/* Where the strains of the tip reach far, so does the domain of the force on it: its direction on meshes of both sizes
   is the same within 1.1 degrees (2.7 with four rings on each). */
static void test_direction_of_tough_sheets(void **unused)
{
    (void)unused;
    const double most = 0.03;
    panel_def def = {20, PEL_GRID_UNION_JACK, 0, PEL_MEMBRANE_NEO_HOOKEAN, false, 0.5, true, 0.4, 0.2};
    double coarse = angle_of(&def);
    def.cells = 40;
    double fine = angle_of(&def);
    assert_near(fine, coarse, most);
}

static void test_no_tips(void **unused)
{
    (void)unused;
    const panel_def def = {10, PEL_GRID_UNION_JACK, 0, PEL_MEMBRANE_STVK, false, 0.01, true, 0, 0};
    panel p = make_panel(&def, 0.2);
    int32_t path[MOST_PATH], count = row(p.mesh, 0.2, 0.5, path), tips;
    assert_int_equal(pel_cut(p.sim, 0, path, count, NULL), PEL_OK);
    assert_int_equal(pel_sim_tips(p.sim, 0, NULL, 0, &tips, NULL), PEL_OK);
    assert_int_equal(tips, 0);
    end_panel(&p);
}

static pel_status find_tips(const void *context, pel_error *error)
{
    pel_tip tip;
    int32_t count;
    return pel_sim_tips((pel_sim *)(uintptr_t)context, 0, &tip, 1, &count, error);
}

static void test_allocation_failures(void **unused)
{
    (void)unused;
    const panel_def def = {10, PEL_GRID_UNION_JACK, 0, PEL_MEMBRANE_STVK, false, 0.01, false, 0, 0};
    panel p = make_panel(&def, 0.2);
    assert_true(for_every_allocation_failure(find_tips, p.sim) > 3);
    end_panel(&p);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_energy_released),           cmocka_unit_test(test_scatter),
        cmocka_unit_test(test_direction_of_tough_sheets), cmocka_unit_test(test_no_tips),
        cmocka_unit_test(test_allocation_failures),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
