/* Meshes that are inside out: the parts that are turned, and forces that do not depend on the given orientation. */
#include "check.h"

#include "math/vec3.h"
#include "pellicle/measure.h"
#include "pellicle/model.h"
#include "pellicle/shape.h"
#include "pellicle/sim_ledger.h"

#include <stdlib.h>
#include <string.h>

/* balls of these radii about points (x, x, x) as one mesh; inward ones are turned */
typedef struct ball {
    double x, radius;
    bool inward, open;
} ball;

static pel_mesh *make_balls(const ball *balls, int32_t count, int32_t frequency)
{
    pel_shape_def def = pel_shape_def_default(PEL_SHAPE_GEODESIC_SPHERE);
    def.frequency = frequency;
    pel_mesh *one, *all;
    assert_int_equal(pel_shape_create(&def, &one, NULL), PEL_OK);
    int32_t n = one->vertex_count, m = one->triangle_count, last = 0;
    double(*positions)[3] = malloc((size_t)(count * n) * sizeof *positions);
    int32_t(*triangles)[3] = malloc((size_t)(count * m) * sizeof *triangles);
    assert_true(positions != NULL && triangles != NULL);
    for (int32_t b = 0; b < count; b++) {
        for (int32_t v = 0; v < n; v++) {
            pel_vec3_scale(one->positions[v], balls[b].radius, positions[b * n + v]);
            for (int c = 0; c < 3; c++)
                positions[b * n + v][c] += balls[b].x;
        }
        for (int32_t t = 0; t < m - balls[b].open; t++, last++)
            for (int i = 0; i < 3; i++)
                triangles[last][i] = b * n + one->triangles[t][balls[b].inward ? 2 - i : i];
    }
    assert_int_equal(pel_mesh_create(positions[0], count * n, triangles[0], last, &all, NULL), PEL_OK);
    pel_mesh_destroy(one);
    free(positions);
    free(triangles);
    return all;
}

static pel_model *make_model(const pel_mesh *mesh, const pel_shell_def *shell)
{
    pel_body_def body = pel_body_def_default();
    body.name = "balls";
    body.mesh = mesh;
    if (shell != NULL) {
        body.shell = *shell;
        body.mass_kind = PEL_MASS_DENSITY;
        body.mass = 1000;
        body.thickness.value = 0.01;
        body.spring_stiffness.value = body.volumetric_stiffness.value = 0;
    }
    pel_model_def def = pel_model_def_default();
    def.bodies = &body;
    def.body_count = 1;
    pel_model *model;
    assert_int_equal(pel_model_create(&def, &model, NULL), PEL_OK);
    return model;
}

static double volume_of(const pel_mesh *mesh)
{
    return pel_surface_volume(mesh->positions[0], mesh->triangles[0], mesh->triangle_count, NULL);
}

static void test_parts(void **unused)
{
    (void)unused;
    static const struct {
        ball balls[4];
        int32_t count, turned; /* balls */
        double volume;         /* of balls of radius 1 */
    } cases[] = {
        {{{0, 1, false, false}}, 1, 0, 1},
        {{{0, 1, true, false}}, 1, 1, 1},
        /* beside each other */
        {{{0, 1, false, false}, {3, 1, true, false}}, 2, 1, 2},
        /* a cavity; all of it turned; two layers in one sense; both turned */
        {{{0, 1, false, false}, {0, 0.5, true, false}}, 2, 0, 0.875},
        {{{0, 1, true, false}, {0, 0.5, false, false}}, 2, 2, 0.875},
        {{{0, 0.5, false, false}, {0, 1, false, false}}, 2, 0, 1.125},
        {{{0, 0.5, true, false}, {0, 1, true, false}}, 2, 2, 1.125},
        /* within the box of another, not within it */
        {{{0, 1, false, false}, {0.9, 0.05, true, false}, {0, 0.1, true, false}}, 3, 1, 1 + 0.000125 - 0.001},
        /* open surfaces have no inside */
        {{{0, 1, true, true}}, 1, 0, -1},
        {{{0, 1, false, true}, {0, 0.3, true, false}}, 2, 1, 1.027},
    };
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        pel_mesh *mesh = make_balls(cases[c].balls, cases[c].count, 4);
        pel_model *model = make_model(mesh, NULL);
        const pel_mesh *own = pel_model_mesh(model, 0);
        int32_t each = 320;
        assert_int_equal(pel_model_turned_count(model, 0), cases[c].turned * each);
        double unit = 4.0 / 3 * 3.14159265358979;
        assert_near(volume_of(own) / unit, cases[c].volume, 0.06 * fabs(cases[c].volume) + 0.03);
        /* with the rounding of the state */
        for (int32_t v = 0; v < mesh->vertex_count; v++)
            for (int k = 0; k < 3; k++)
                assert_true(own->positions[v][k] == (double)(pel_real)mesh->positions[v][k]);
        pel_model_destroy(model);
        pel_mesh_destroy(mesh);
    }
}

/* a dented part does not enclose itself: more than half of the space about its first vertex is within it */
static void test_dented(void **unused)
{
    (void)unused;
    const ball inward = {0, 1, true, false};
    pel_mesh *mesh = make_balls(&inward, 1, 4);
    pel_vec3_scale(mesh->positions[mesh->triangles[0][0]], 0.3, mesh->positions[mesh->triangles[0][0]]);
    pel_model *model = make_model(mesh, NULL);
    assert_int_equal(pel_model_turned_count(model, 0), mesh->triangle_count);
    assert_near(volume_of(pel_model_mesh(model, 0)), -volume_of(mesh), 1e-6);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

/* small balls inside an icosahedron and beside it, close to its large triangles: one inside is a cavity, one outside is
   inside out */
static void test_near_triangles(void **unused)
{
    (void)unused;
    for (int i = -60; i <= 60; i++) {
        const ball balls[2] = {{0, 1, false, false}, {0.01 * i, 0.004, true, false}};
        double distance = fabs(0.01 * i) * sqrt(3);
        if (distance > 0.78 && distance < 0.96)
            continue; /* between the spheres in the icosahedron and about it */
        pel_mesh *mesh = make_balls(balls, 2, 1);
        pel_model *model = make_model(mesh, NULL);
        assert_int_equal(pel_model_turned_count(model, 0), distance > 0.9 ? 20 : 0);
        pel_model_destroy(model);
        pel_mesh_destroy(mesh);
    }
}

typedef struct outcome {
    double volume; /* ratio */
    double depth;  /* of the vertex at +x, outward */
} outcome;

static outcome press(const pel_shell_def *shell, pel_method method, bool inward)
{
    const ball one = {0, 1, inward, false};
    pel_mesh *mesh = make_balls(&one, 1, 6);
    pel_model *model = make_model(mesh, shell);
    pel_sim_def def = pel_sim_def_default();
    def.model = model;
    def.solver.method = method;
    def.solver.dt = method == PEL_METHOD_EXPLICIT ? 0.002 : 0.01;
    pel_sim *sim;
    pel_error error;
    pel_status status = pel_sim_create(&def, &sim, &error);
    if (status != PEL_OK)
        print_error("%s\n", error.what);
    assert_int_equal(status, PEL_OK);
    for (int n = 0; n * def.solver.dt < 0.08; n++)
        assert_int_equal(pel_sim_step(sim, NULL), PEL_OK);
    pel_sim_measures measures;
    pel_sim_measure(sim, &measures);
    double *positions = malloc(3 * sizeof *positions * (size_t)mesh->vertex_count);
    assert_non_null(positions);
    pel_sim_get_positions(sim, 0, positions);
    outcome out = {.volume = measures.volume_ratio};
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        if (mesh->positions[v][0] > 0.9)
            out.depth += pel_vec3_length(positions + 3 * v) - 1;
    free(positions);
    pel_sim_destroy(sim);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
    return out;
}

/* a pressure, a gas, a volume to keep and a cap that caves in do to a turned mesh what they do to the mesh */
static void test_pressures(void **unused)
{
    (void)unused;
    static const pel_method methods[] = {PEL_METHOD_XPBD, PEL_METHOD_PBD, PEL_METHOD_EXPLICIT};
    for (int kind = 0; kind < 6; kind++)
        for (int m = 0; m < 3; m++) {
            pel_shell_def shell = pel_shell_def_default();
            shell.membrane.on = true;
            shell.membrane.young.value = 1e4;
            shell.membrane.thickness.value = 0.01;
            shell.bending.model = PEL_BENDING_HINGE;
            shell.pressure.kind = kind < 3 || kind == 5 ? PEL_PRESSURE_GIVEN
                                  : kind == 3           ? PEL_PRESSURE_GAS
                                                        : PEL_PRESSURE_VOLUME;
            shell.pressure.form = kind == 2 ? PEL_PRESSURE_VERTEX_NORMAL : PEL_PRESSURE_CONSISTENT;
            shell.pressure.outside.value = kind == 1 ? -20 : 20;
            shell.pressure.value = kind == 3 ? 1e4 : 0;
            shell.pressure.bulk = 100;
            shell.pressure.target.value = 0.8;
            pel_anisotropy_def cap = pel_anisotropy_def_default();
            cap.strength = 0.3;
            cap.center[2] = 1;
            shell.anisotropies = &cap;
            shell.anisotropy_count = kind == 5 && methods[m] != PEL_METHOD_EXPLICIT;
            outcome outward = press(&shell, methods[m], false), inward = press(&shell, methods[m], true);
            /* the corners of a turned triangle stand in another order, and so do constraints in a sweep */
            double tolerance = sizeof(pel_real) == 4 ? 1e-3 : 1e-6;
            assert_near(inward.volume, outward.volume, tolerance + 0.05 * fabs(outward.volume - 1));
            assert_near(inward.depth, outward.depth, tolerance + 0.05 * fabs(outward.depth));
            if (kind != 3)
                assert_true(kind == 1 ? outward.volume > 1 + 1e-5 : outward.volume < 1 - 1e-5);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_parts),
        cmocka_unit_test(test_near_triangles),
        cmocka_unit_test(test_dented),
        cmocka_unit_test(test_pressures),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
