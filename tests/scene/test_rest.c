/* `bodies[].rest`: a body that starts as one mesh and has its shape at rest from another one. A spherical shell of
   radius 1 whose rest shape is an ellipsoid: it ends with the lengths of the edges of that. */
#include "scene_run.h"

#include "failing_malloc.h"
#include "pellicle/live.h"

#include <math.h>
#include <stdlib.h>

#define BALL "mesh: { shape: geodesic-sphere, frequency: 4 }\n"
#define SHAPE "    rest: { shape: geodesic-sphere, frequency: 4, scale: [0.8, 0.9, 1] }\n"
#define HEAD "version: 1\nduration: 3\nbodies:\n  - name: ball\n    " BALL

enum { VERTICES = 162 };

/* elastic energy at the end over that at the start: static solves to 1e-6 of the forces, the others swing out */
#define STATIC_ENERGY 1e-9
#define SWUNG_ENERGY 0.02

static char text[2000];

static const char *scene(const char *method, const char *bending)
{
    snprintf(text, sizeof text,
             HEAD SHAPE "    mass: { density: 1000, thickness: 0.05 }\n"
                        "    membrane: { material: stvk, young: 1.0e5 }\n"
                        "    bending: { model: %s }\n"
                        "solver: { method: %s, drag: 4, dt: 0.01 }\n",
             bending, method);
    return text;
}

static void test_starts_as_mesh(void **unused)
{
    (void)unused;
    run r;
    double at[VERTICES][3], rest[VERTICES][3];
    check_begin(&r, scene("implicit", "hinge"));
    pel_sim_get_positions(r.sim, 0, at[0]);
    pel_sim_get_rest_positions(r.sim, 0, rest[0]);
    for (int v = 0; v < VERTICES; v++) {
        assert_true(fabs(sqrt(at[v][0] * at[v][0] + at[v][1] * at[v][1] + at[v][2] * at[v][2]) - 1) < 1e-6);
        for (int k = 0; k < 3; k++)
            assert_true(fabs(rest[v][k] - (0.8 + 0.1 * k) * at[v][k]) < 1e-6);
    }
    end(&r);
}

static void test_goes_to_rest(void **unused)
{
    (void)unused;
    static const char *const methods[][2] = {
        {"static", "hinge"}, {"implicit", "hinge"}, {"xpbd", "hinge"}, {"explicit", "none"}, {"pbd", "isometric-rest"}};
    for (size_t m = 0; m < sizeof methods / sizeof *methods; m++) {
        run r;
        const bool is_static = strcmp(methods[m][0], "static") == 0,
                   is_explicit = strcmp(methods[m][0], "explicit") == 0;
        check_begin(&r, scene(methods[m][0], methods[m][1]));
        pel_sim_ledger before, after;
        pel_sim_get_ledger(r.sim, &before);
        assert_true(before.elastic_start > 1);
        /* explicit: the first steps alone, which fall towards it */
        for (int s = 0; s < (is_static ? 1 : is_explicit ? 3 : 300); s++)
            assert_int_equal(pel_sim_step(r.sim, NULL), PEL_OK);
        pel_sim_get_ledger(r.sim, &after);
        double share = after.elastic / before.elastic_start;
        if (share > (is_static ? STATIC_ENERGY : is_explicit ? 1 : SWUNG_ENERGY))
            fail_msg("%s: %g of the energy is left", methods[m][0], share);
        end(&r);
    }
}

/* a number that changes keeps the state, and a snapshot of it goes into a simulation of the scene */
static void test_goes_on(void **unused)
{
    (void)unused;
    run r, other;
    double at[2][VERTICES][3];
    check_begin(&r, scene("xpbd", "hinge"));
    check_begin(&other, scene("xpbd", "hinge"));
    for (int s = 0; s < 20; s++)
        assert_int_equal(pel_sim_step(r.sim, NULL), PEL_OK);
    void *bytes = malloc(pel_sim_save_size(r.sim));
    pel_sim_save(r.sim, bytes);
    assert_int_equal(pel_sim_load(other.sim, bytes, pel_sim_save_size(r.sim), NULL), PEL_OK);
    free(bytes);
    pel_sim_get_positions(r.sim, 0, at[0][0]);
    pel_sim_get_positions(other.sim, 0, at[1][0]);
    assert_memory_equal(at[0], at[1], sizeof at[0]);
    assert_int_equal(pel_set_parameter(r.sim, "bodies.ball.membrane.young", 2e5, NULL), PEL_OK);
    pel_sim_get_positions(r.sim, 0, at[1][0]);
    assert_memory_equal(at[0], at[1], sizeof at[0]);
    end(&r);
    end(&other);
}

static void test_refusals(void **unused)
{
    (void)unused;
    static const refusal cases[] = {
        {HEAD "    rest: { shape: geodesic-sphere, frequency: 5 }\n", "a.yaml:6:11: error: the shape at rest has 252"},
        {HEAD "    rest: { shape: uv-sphere }\n", "the shape at rest has "},
        {HEAD SHAPE "    refine: { levels: 1, everywhere: true }\n",
         "a.yaml:6:5: error: 'rest' and 'refine' exclude each other"},
        {HEAD SHAPE "    volume: { young: 1.0e4 }\n", "'rest' and 'volume' exclude each other"},
        {HEAD SHAPE "cuts: [{ path: [[1, 0, 0.1], [0.9, 0.3, 0.1]] }]\n", "'rest' and 'cuts' exclude each other"},
        {HEAD SHAPE "imperfection: { amplitude: 1.0e-3 }\nsolver: { method: static }\n",
         "'rest' and 'imperfection' exclude each other"},
        {HEAD "    rest: { file: nowhere.obj }\n", "cannot open the mesh 'nowhere.obj'"},
    };
    check_refusals(cases, sizeof cases / sizeof *cases);
}

/* what the scene refuses, the def refuses too */
static void test_refuses_defs(void **unused)
{
    (void)unused;
    run r;
    pel_error error = {0};
    pel_model *model;
    pel_mesh *turned;
    check_begin(&r, scene("xpbd", "hinge"));
    pel_body_def body = r.scene->model.bodies[0];
    pel_model_def def = r.scene->model;
    def.bodies = &body;
    body.refine.levels = 1;
    body.refine.everywhere = true;
    assert_int_equal(pel_model_create(&def, &model, &error), PEL_BAD_ARGUMENT);
    assert_non_null(strstr(error.remedy, "the body refines"));
    body.refine.levels = 0;
    body.refine.everywhere = false;
    const pel_mesh *mesh = body.mesh;
    assert_int_equal(pel_mesh_create(mesh->positions[0], mesh->vertex_count, mesh->triangles[0], mesh->triangle_count,
                                     &turned, NULL),
                     PEL_OK);
    int32_t first = turned->triangles[7][0];
    turned->triangles[7][0] = turned->triangles[7][1];
    turned->triangles[7][1] = first;
    body.rest = turned;
    assert_int_equal(pel_model_create(&def, &model, &error), PEL_BAD_ARGUMENT);
    assert_non_null(strstr(error.what, "triangles of the rest shape"));
    pel_mesh_destroy(turned);
    end(&r);
}

static pel_status make(const void *data, pel_error *error)
{
    run r;
    pel_status status = begin(&r, data, error);
    end(&r);
    return status;
}

static void test_allocation_failures(void **unused)
{
    (void)unused;
    skip_if_slow();
    assert_true(for_allocation_failures(make, scene("xpbd", "hinge"), 7) > 20);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_starts_as_mesh), cmocka_unit_test(test_goes_to_rest),
        cmocka_unit_test(test_goes_on),        cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_refuses_defs),   cmocka_unit_test(test_allocation_failures),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
