/* One sheet for all laws under the methods that use a material: explicit, xpbd and descent stretch it by the pull of
   the law's closed form, pbd, which knows no stiffness, brings it back to its rest shape. Each law reads the numbers
   that it declares, and no other; they are its live parameters. */
#include "law_forms.h"
#include "pellicle/live.h"
#include "shell_fixture.h"

#include <stdlib.h>

enum { CELLS = 3, SIDE = CELLS + 1, SHEET = SIDE * SIDE };

static const double stretch = 1.25;

static pel_membrane_material material_of(int kind)
{
    pel_membrane_material material = law_material(kind, 100, 0.3, 0.01);
    material.yield = 200; /* methods swing past the end */
    return material;
}

static pel_model *make_sheet_model(const pel_mesh *mesh, int kind)
{
    const pel_membrane_material material = material_of(kind);
    pel_body_def body = shell_body(mesh, material.kind);
    body.mass_kind = PEL_MASS_PER_VERTEX;
    body.mass = 1.0 / SHEET;
    body.shell.membrane.young.value = material.young;
    body.shell.membrane.poisson = material.poisson;
    body.shell.membrane.thickness.value = material.thickness;
    body.shell.membrane.mooney_ratio = material.mooney_ratio;
    body.shell.membrane.extension_limit = material.extension_limit;
    body.shell.membrane.stiffening = material.stiffening;
    body.shell.membrane.weft = material.weft;
    body.shell.membrane.shear = material.shear;
    memcpy(body.shell.membrane.warp_curve, material.warp_curve, sizeof material.warp_curve);
    memcpy(body.shell.membrane.weft_curve, material.weft_curve, sizeof material.weft_curve);
    body.shell.membrane.yield = material.yield;
    body.shell.membrane.hardening = material.hardening;
    static const int32_t held[1] = {0};
    body.pinned = held;
    body.pinned_count = 1;
    return make_model(&body);
}

static pel_sim_def sim_of(const pel_model *model, pel_method method)
{
    pel_sim_def def = pel_sim_def_default();
    def.model = model;
    def.solver = (pel_solver_def){.method = method, .dt = 0.01, .drag = 3};
    def.thread_count = 1;
    if (method == PEL_METHOD_EXPLICIT) {
        def.solver.symplectic = true;
        def.solver.dt = 0.02;
    } else if (method == PEL_METHOD_XPBD) {
        def.solver.dt = 0.005;
        def.solver.substeps = 1;
        def.solver.iterations = 4;
    } else if (method == PEL_METHOD_DESCENT) {
        def.solver.dt = 1;
        def.solver.iterations = 500;
    }
    return def;
}

/* the pull of equal tension on all sides as forces of the vertices of a square sheet of size 1 */
static void side_forces(double tension, double weights[2][SHEET], pel_load_def loads[2])
{
    for (int d = 0; d < 2; d++) {
        for (int i = 0; i < SHEET; i++) {
            int across = d == 0 ? i % SIDE : i / SIDE, along = d == 0 ? i / SIDE : i % SIDE;
            double share = (along == 0 || along == CELLS ? 0.5 : 1.0) / CELLS;
            weights[d][i] = across == 0 ? -share : across == CELLS ? share : 0;
        }
        loads[d] = pel_load_def_default();
        loads[d].kind = PEL_LOAD_PER_VERTEX;
        loads[d].force[d] = tension;
        loads[d].weights = weights[d];
    }
}

/* lengths of two sides: the sheet may turn about its held corner */
static void side_lengths(pel_sim *sim, double lengths[2])
{
    double x[SHEET][3];
    pel_sim_get_positions(sim, 0, x[0]);
    lengths[0] = pel_vec3_distance(x[0], x[SIDE - 1]);
    lengths[1] = pel_vec3_distance(x[0], x[SHEET - SIDE]);
}

static void test_methods_agree(void **unused)
{
    (void)unused;
    /* float: a substep moves vertices by little more than their rounding */
    static const struct {
        pel_method method;
        int steps;
        double tolerance, single;
    } runs[] = {{PEL_METHOD_EXPLICIT, 8000, 1e-6, 1e-4},
                {PEL_METHOD_XPBD, 20000, 5e-5, 3e-3},
                {PEL_METHOD_DESCENT, 6, 1e-5, 5e-3}};
    pel_mesh *mesh = make_grid(CELLS, CELLS, 1, 1, PEL_GRID_ONE_DIAGONAL);
    assert_int_equal(mesh->vertex_count, SHEET);
    for (int kind = 0; kind < PEL_MEMBRANE_COUNT; kind++) {
        const pel_membrane_material material = material_of(kind);
        pel_model *model = make_sheet_model(mesh, kind);
        static double weights[2][SHEET];
        pel_load_def loads[2];
        side_forces(law_tension(&material, stretch, stretch), weights, loads);
        print_message("%-14s", pel_membrane_kind_name(material.kind));
        for (size_t r = 0; r < sizeof runs / sizeof *runs; r++) {
            pel_sim_def def = sim_of(model, runs[r].method);
            def.loads = loads;
            def.load_count = 2;
            pel_sim *sim = make_sim(&def);
            run_steps(sim, runs[r].steps);
            double lengths[2], tolerance = sizeof(pel_real) == 8 ? runs[r].tolerance : runs[r].single;
            side_lengths(sim, lengths);
            print_message("  %9.2e %9.2e", lengths[0] - stretch, lengths[1] - stretch);
            for (int d = 0; d < 2; d++)
                assert_near(lengths[d], stretch, tolerance);
            pel_sim_destroy(sim);
        }
        print_message("\n");
        pel_model_destroy(model);
    }
    pel_mesh_destroy(mesh);
}

static void test_pbd_comes_to_rest(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_grid(CELLS, CELLS, 1, 1, PEL_GRID_ONE_DIAGONAL);
    for (int kind = 0; kind < PEL_MEMBRANE_COUNT; kind++) {
        if (pel_law_yields(pel_membrane_law_traits((pel_membrane_kind)kind)))
            continue; /* refused */
        pel_model *model = make_sheet_model(mesh, kind);
        pel_sim_def def = sim_of(model, PEL_METHOD_PBD);
        pel_sim *sim = make_sim(&def);
        double x[SHEET][3], lengths[2];
        for (int v = 0; v < SHEET; v++)
            for (int c = 0; c < 3; c++)
                x[v][c] = mesh->positions[0][c] + stretch * (mesh->positions[v][c] - mesh->positions[0][c]);
        assert_int_equal(pel_sim_set_positions(sim, 0, x[0], NULL), PEL_OK);
        run_steps(sim, 600);
        side_lengths(sim, lengths);
        for (int d = 0; d < 2; d++)
            /* a tension field is at rest when it is slack, whatever its size */
            if (kind == PEL_MEMBRANE_TENSION_FIELD)
                assert_true(lengths[d] < 1.001);
            else
                assert_near(lengths[d], 1, 1e-3);
        pel_sim_destroy(sim);
        pel_model_destroy(model);
    }
    pel_mesh_destroy(mesh);
}

/* energy at a strain that all numbers change */
static double energy_of(const pel_membrane_material *given)
{
    static const double gradient[6] = {1.2, 0.1, -0.05, 1.1, 0.2, 0.15};
    pel_membrane_material wanted = *given, *material = &wanted;
    material->yield /= 20;
    return pel_membrane_density(material, gradient, NULL);
}

static bool is_same_law(const pel_membrane_law *a, const pel_membrane_law *b)
{
    bool is_same = a->modulus == b->modulus && a->poisson == b->poisson;
    for (int i = 0; i < PEL_LAW_NUMBERS; i++)
        is_same &= a->numbers[i] == b->numbers[i];
    return is_same;
}

static bool is_live(pel_sim *sim, const char *member)
{
    char path[80];
    pel_parameter_info info;
    snprintf(path, sizeof path, "bodies.shell.membrane.%s", member);
    return pel_parameter_find(sim, path, &info, NULL) == PEL_OK;
}

static void test_numbers_are_declared(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_grid(CELLS, CELLS, 1, 1, PEL_GRID_ONE_DIAGONAL);
    int readers[10] = {0};
    for (int kind = 0; kind < PEL_MEMBRANE_COUNT; kind++) {
        pel_model *model = make_sheet_model(mesh, kind);
        pel_sim_def def = sim_of(model, PEL_METHOD_XPBD);
        pel_sim *sim = make_sim(&def);
        const pel_membrane_material material = material_of(kind);
        const pel_membrane_law law = pel_membrane_law_of(&material);
        const int traits = pel_membrane_law_traits(material.kind);
        const pel_material_number *number;
        for (int32_t i = 0; (number = pel_material_number_at(i)) != NULL; i++) {
            pel_membrane_material changed = material;
            *(double *)((char *)&changed + number->offset) *= 1.25;
            const pel_membrane_law other = pel_membrane_law_of(&changed);
            bool reads = (traits & number->trait) != 0;
            if (reads != (energy_of(&changed) != energy_of(&material)) || reads == is_same_law(&law, &other) ||
                reads != is_live(sim, number->name))
                fail_msg("%s %s %s", pel_membrane_kind_name(material.kind), reads ? "declares" : "does not declare",
                         number->name);
            readers[i] += reads;
        }
        assert_true(is_live(sim, "young") && is_live(sim, "thickness"));
        pel_sim_destroy(sim);
        pel_model_destroy(model);
    }
    for (int32_t i = 0; pel_material_number_at(i) != NULL; i++)
        assert_true(readers[i] > 0);
    pel_mesh_destroy(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_methods_agree),
        cmocka_unit_test(test_pbd_comes_to_rest),
        cmocka_unit_test(test_numbers_are_declared),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
