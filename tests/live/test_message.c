/* What the first message to a page proposes. */
#include "check.h"
#include "live/message.h"

#include "base/memory.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* the spring of the hand in a scene with one body [N/m] */
static double proposed(const char *body)
{
    char text[600];
    pel_scene *scene;
    pel_model *model;
    pel_sim *sim;
    size_t size;
    snprintf(text, sizeof text, "version: 1\nbodies:\n  - { name: a, %s }\nduration: 1\n", body);
    assert_int_equal(pel_scene_parse("a.yaml", text, strlen(text), NULL, 0, NULL, &scene, NULL), PEL_OK);
    assert_int_equal(pel_model_create(&scene->model, &model, NULL), PEL_OK);
    scene->sim.model = model;
    assert_int_equal(pel_sim_create(&scene->sim, &sim, NULL), PEL_OK);
    unsigned char *message = pel_message_hello(scene, "", sim, &size);
    assert_non_null(message);
    char *head = malloc(size + 1);
    memcpy(head, message, size);
    head[size] = 0;
    const char *found = strstr(head, "\"stiffness\":");
    assert_non_null(found);
    double stiffness = strtod(found + strlen("\"stiffness\":"), NULL);
    free(head);
    pel_free(message);
    pel_sim_destroy(sim);
    pel_model_destroy(model);
    pel_scene_destroy(scene);
    return stiffness;
}

static double of_tissue(double radius, double young)
{
    char text[300];
    snprintf(
        text, sizeof text,
        "mesh: { shape: geodesic-sphere, frequency: 4, radius: %g }, mass: { density: 1000 }, springs: { young: %g }, "
        "volumetric: { young: %g }",
        radius, 10 * young, young);
    return proposed(text);
}

/* of moduli it is proportional to them and to the size, and pulls about as hard as the tissue, E times the size */
static void test_moduli(void **unused)
{
    (void)unused;
    double one = of_tissue(0.1, 5000);
    assert_near(of_tissue(0.1, 10000), 2 * one, 1e-9 * one);
    assert_near(of_tissue(0.4, 5000), 4 * one, 1e-9 * one);
    assert_true(one > 0.02 * 5000 * 0.2 && one < 5000 * 0.2);
}

static void test_stiffnesses(void **unused)
{
    (void)unused;
    const char *springs = "mesh: { shape: geodesic-sphere, frequency: 4 }, springs: { stiffness: 3 }, "
                          "volumetric: { stiffness: 1.5 }";
    assert_near(proposed(springs), 18, 1e-9);
    const char *shell = "mesh: { shape: geodesic-sphere, frequency: 4 }, mass: { density: 1000, thickness: 0.002 }, "
                        "membrane: { young: 1e5, thickness: 0.002 }";
    assert_near(proposed(shell), 60, 1e-9);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_moduli), cmocka_unit_test(test_stiffnesses)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
