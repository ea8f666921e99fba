/* Smooth elements where a scene leaves the choice: what bends or locks, and is cheap. */
#include "choice/element.h"
#include "pellicle/sim_reading.h"
#include "scene/scene_run.h"

#include <math.h>

#define BEAM(cells, more)                                                                                              \
    "version: 1\nbodies:\n  - name: beam\n    mesh: { shape: box, size_x: 8, size_y: 1, size_z: 1 }\n"                 \
    "    mass: { density: 1 }\n    pinned: { box: { min: [-4.001, -1, -1], max: [-3.999, 1, 1] } }\n"                  \
    "    volume: { young: 1.0e6, edge: " #cells more " }\n"
#define STATIC                                                                                                         \
    "solver: { method: static, dt: 1 }\nduration: 1\n"                                                                 \
    "loads: [ { force: [0, 0, -10], at: { box: { min: [3.999, -1, -1], max: [4.001, 1, 1] } } } ]\n"
#define CUBE                                                                                                           \
    "version: 1\nbodies: [ { name: cube, mesh: { shape: box }, volume: { young: 1.0e6, poisson: %s, edge: %s } } ]\n"  \
    "duration: 0.01\n%s\n"

/* over Timoshenko's, with the shear factor of a rectangle (Cowper 1966) */
static double deflection_of(const char *text, double poisson)
{
    run r;
    check_begin(&r, text);
    assert_int_equal(pel_sim_step(r.sim, NULL), PEL_OK);
    int32_t count = pel_sim_vertex_count(r.sim, 0);
    double(*x)[3] = malloc((size_t)count * sizeof *x), (*rest)[3] = malloc((size_t)count * sizeof *rest), sum = 0;
    int ends = 0;
    assert_true(x != NULL && rest != NULL);
    pel_sim_get_positions(r.sim, 0, &x[0][0]);
    pel_sim_get_rest_positions(r.sim, 0, &rest[0][0]);
    for (int32_t v = 0; v < count; v++)
        if (rest[v][0] > 3.999) {
            sum += rest[v][2] - x[v][2];
            ends++;
        }
    free(x);
    free(rest);
    end(&r);
    double shear = 10 * (1 + poisson) / (12 + 11 * poisson) * 1e6 / (2 * (1 + poisson));
    return sum / ends / (10 * 512 / (3 * 1e6 / 12.0) + 10 * 8 / shear);
}

static void test_beam(void **unused)
{
    (void)unused;
    assert_true(deflection_of(BEAM(0.25, ", element: linear") STATIC, 0.3) < 0.955);
    assert_near(deflection_of(BEAM(0.25, "") STATIC, 0.3), 1, 0.02);
    assert_near(deflection_of(BEAM(0.5, "") STATIC, 0.3), 1, 0.02);
    /* the clamped end cannot contract, which the beam of theory does */
    assert_near(deflection_of(BEAM(0.25, ", poisson: 0.499") STATIC, 0.499), 1, 0.025);
}

static pel_volume_element element_of(const char *poisson, const char *edge, const char *more, const char *told)
{
    heard all = {""};
    const pel_log log = {.write = hear, .user = &all};
    char text[600];
    pel_scene *scene;
    snprintf(text, sizeof text, CUBE, poisson, edge, more);
    assert_int_equal(pel_scene_parse("a.yaml", text, strlen(text), NULL, 0, &log, &scene, NULL), PEL_OK);
    const pel_volume_element element = scene->model.bodies[0].volume.element;
    const bool is_smooth = element == PEL_VOLUME_SMOOTH;
    assert_int_equal(strstr(all.text, "has smooth elements") != NULL, told != NULL);
    assert_true(told == NULL || strstr(all.text, told) != NULL);
    /* the printed scene has the word, so that it repeats the run */
    assert_int_equal(strstr(pel_scene_text(scene), "element: smooth") != NULL, is_smooth);
    assert_true(!is_smooth || scene->sim.solver.method != PEL_METHOD_XPBD);
    pel_scene_destroy(scene);
    return element;
}

static void test_choice(void **unused)
{
    (void)unused;
    assert_int_equal(element_of("0.3", "0.3", "", NULL), PEL_VOLUME_LINEAR);
    assert_int_equal(element_of("0.45", "0.3", "", NULL), PEL_VOLUME_LINEAR);
    assert_int_equal(element_of("0.49", "0.3", "", "lock at a Poisson's ratio of 0.49"), PEL_VOLUME_SMOOTH);
    assert_int_equal(element_of("0.49, element: linear", "0.3", "", NULL), PEL_VOLUME_LINEAR);
    assert_int_equal(element_of("0.49", "0.3", "solver: { method: static }", "lock"), PEL_VOLUME_SMOOTH);
    /* a method that has linear ones only, and steps that would be dear */
    assert_int_equal(element_of("0.49", "0.3", "solver: { method: xpbd }", NULL), PEL_VOLUME_LINEAR);
    assert_int_equal(element_of("0.49", "0.07", "", NULL), PEL_VOLUME_LINEAR);
}

/* what springs carry, on both sides of the gravity under which a rod of the same modulus sags, or stretches, by a tenth
   of its length: rho g (V / V) L (L / d)^2 2 / 3 / E and rho g L / (2 E), with d = 4 V / A */
static void test_carried(void **unused)
{
    (void)unused;
    const double length = 0.2, width = 0.03, density = 1300, young = 4e4;
    const double depth = 4 * length * width * width / (4 * length * width + 2 * width * width);
    const double bent = 0.1 * 1.5 * young * depth * depth / (density * length * length * length);
    const double drawn = 0.1 * 2 * young / (density * length);
    for (int i = 0; i < 8; i++) {
        const double g = (i < 4 ? bent : drawn) * (i % 2 == 0 ? 0.98 : 1.02);
        const double offset = i % 4 < 2 ? 0 : 5;
        char text[600];
        run r;
        snprintf(
            text, sizeof text,
            "version: 1\ngravity: [%.17g, 0, %.17g]\nbodies: [{ name: beam, mesh: { shape: box, nx: 12, ny: 2, nz: 2, "
            "size_x: 0.2, size_y: 0.03, size_z: 0.03, translate: [%g, 0, 0] }, mass: { density: 1300 }, "
            "volumetric: { young: 4e4 }, pinned: { box: { min: [-1, -1, -1], max: [%g, 1, 1] } } }]\nduration: 1\n",
            i < 4 ? 0 : g, i < 4 ? -g : 0, offset, offset - 0.09);
        check_begin(&r, text);
        if (pel_scene_is_carried(r.scene, r.model, 0) != (i % 2 == 1))
            fail_msg("case %d: %g m/s^2", i, g);
        end(&r);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_beam),
        cmocka_unit_test(test_carried),
        cmocka_unit_test(test_choice),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
