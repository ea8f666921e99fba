/* Contact that a scene with several bodies has without asking for it. */
#include "scene/scene_run.h"

#include "pellicle/sim_contact.h"

#include <stdlib.h>

#define HEAD "version: 1\nduration: 1\nbodies:\n"
#define SHEET(name, z)                                                                                                 \
    "  - name: " name "\n    mesh: { shape: grid, nx: 4, ny: 4, size_x: 0.2, size_y: 0.2, translate: [0, 0, " z        \
    "] }\n    membrane: { preset: rubber }\n"
#define BALL(name, at)                                                                                                 \
    "  - name: " name "\n    mesh: { shape: geodesic-sphere, frequency: 2, radius: 0.05, translate: [" at              \
    "] }\n    membrane: { preset: rubber }\n    mass: { density: 1000 }\n"
#define MARBLE HEAD "  - { mesh: { shape: geodesic-sphere, frequency: 2, radius: 0.05 }, rigid: { sphere: true } }\n"
#define POST "tools: [{ name: post, shape: sphere, radius: 0.1, motion: [{ position: [0, 0, -9] }] }]\n"
#define TWO HEAD SHEET("cloth", "0.0") BALL("ball", "0, 0, 0.2")

static void test_choice(void **unused)
{
    (void)unused;
    static const struct {
        const char *text;
        bool enabled, implied;
        const char *says; /* null = nothing */
    } cases[] = {
        {TWO, true, true, NULL},
        {HEAD BALL("ball", "0, 0, 0"), false, false, NULL},
        {HEAD BALL(
             "ball",
             "0, 0, 0") "tools: [{ name: post, mesh: { shape: cylinder }, motion: [{ position: [0, 0, -9] }] }]\n",
         true, true, NULL},
        {HEAD BALL(
             "ball",
             "0, 0, 0") "tools: [{ name: post, shape: sphere, radius: 0.1, motion: [{ position: [0, 0, -9] }] }]\n",
         false, false, NULL},
        /* a rigid sphere is one to tools of every shape */
        {MARBLE POST, true, true, NULL},
        {MARBLE POST "contact: none\n", false, false, NULL},
        {HEAD "  - { name: die, mesh: { shape: box }, rigid: { mass: 1 } }\n"
              "tools: [{ name: post, shape: sphere, radius: 0.1, motion: [{ position: [0, 0, -9] }] }]\n"
              "solver: { method: static }\n",
         true, true, NULL},
        {HEAD "  - { name: die, mesh: { shape: box }, rigid: { mass: 1 } }\n"
              "tools: [{ name: post, shape: sphere, radius: 0.1, motion: [{ position: [0, 0, -9] }] }]\n"
              "solver: { method: implicit }\n",
         false, false, NULL},
        {TWO "contact: {}\n", true, false, NULL},
        {TWO "contact: { self: false, between: false }\n", true, false, NULL},
        {TWO "contact: none\n", false, false, NULL},
        {TWO "solver: { analysis: modal }\n", false, false, NULL},
        /* boxes overlap, surfaces do not */
        {HEAD BALL("a", "0, 0, 0") BALL("b", "0.065, 0.065, 0.065"), true, true, NULL},
        {HEAD SHEET("cloth", "0.01") BALL("ball", "0, 0, 0"), false, false,
         "no contact: bodies 'cloth' and 'ball' intersect"},
        {HEAD SHEET("far", "9") BALL("a", "0, 0, 0") BALL("b", "0, 0, 0"), false, false, "bodies 'a' and 'b'"},
    };
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        heard told = {""};
        pel_log log = {.write = hear, .user = &told};
        pel_scene *scene = NULL;
        assert_int_equal(pel_scene_parse("a.yaml", cases[c].text, strlen(cases[c].text), NULL, 0, &log, &scene, NULL),
                         PEL_OK);
        const char *line = strstr(told.text, "no contact");
        bool says = cases[c].says == NULL ? line == NULL : line != NULL && strstr(line, cases[c].says) != NULL;
        bool prints = strstr(pel_scene_text(scene), "\ncontact:") != NULL &&
                      strstr(pel_scene_text(scene), "\ncontact: none") == NULL;
        if (scene->sim.contact.enabled != cases[c].enabled || scene->contact_is_implied != cases[c].implied || !says ||
            prints != cases[c].enabled)
            fail_msg("case %d: %d, %d: %s", (int)c, scene->sim.contact.enabled, scene->contact_is_implied, told.text);
        if (cases[c].implied)
            assert_true(!scene->sim.contact.self && scene->sim.contact.between);
        pel_scene_destroy(scene);
    }
}

/* a ball that falls on a sheet that is held stays above it */
static void test_ball_on_sheet(void **unused)
{
    (void)unused;
    run r;
    check_begin(&r, HEAD SHEET("cloth", "0.0") "    pinned: boundary\n" BALL(
                        "ball", "0, 0, 0.06") "gravity: [0, 0, -9.81]\nsolver: { dt: 0.01 }\n");
    for (int i = 0; i < 30; i++)
        assert_int_equal(pel_sim_step(r.sim, NULL), PEL_OK);
    size_t count = (size_t)pel_sim_vertex_count(r.sim, 1);
    double *at = malloc(3 * count * sizeof *at);
    pel_sim_get_positions(r.sim, 1, at);
    for (size_t v = 0; v < count; v++)
        assert_true(at[3 * v + 2] > -0.1);
    pel_contact_statistics contact;
    pel_sim_get_contact_statistics(r.sim, &contact);
    assert_true(contact.contacts > 0);
    free(at);
    end(&r);
}

/* what the resolved scene says gives the same scene */
static void test_again(void **unused)
{
    (void)unused;
    pel_scene *first = NULL, *second = NULL;
    assert_int_equal(pel_scene_parse("a.yaml", TWO, strlen(TWO), NULL, 0, NULL, &first, NULL), PEL_OK);
    const char *text = pel_scene_text(first);
    assert_int_equal(pel_scene_parse("a.yaml", text, strlen(text), NULL, 0, NULL, &second, NULL), PEL_OK);
    assert_string_equal(pel_scene_text(second), text);
    pel_scene_destroy(first);
    pel_scene_destroy(second);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_choice),
        cmocka_unit_test(test_ball_on_sheet),
        cmocka_unit_test(test_again),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
