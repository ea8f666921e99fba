/* Attachments and stitches of scenes: what is paired, and bad input with its place. */
#include "scene_run.h"

#include <math.h>

#include <stdlib.h>

#define HEAD "version: 1\nbodies:\n"
#define SHEET(name, z, more)                                                                                           \
    "  - name: " name "\n    mesh: { shape: grid, nx: 4, ny: 4, size_x: 1, size_y: 1, translate: [0, 0, " z "] }\n"    \
    "    membrane: { young: 1e5, thickness: 1e-3 }\n" more
#define TOUGH                                                                                                          \
    "  - name: a\n    mesh: { shape: grid, nx: 4, ny: 4, size_x: 1, size_y: 1 }\n"                                     \
    "    membrane: { young: 1e5, thickness: 1e-3, toughness: 10 }\n"
#define END "duration: 1\nsolver: { method: implicit, dt: 0.02 }\n"
#define TOP "{ box: { min: [-1, 0.49, -1], max: [1, 1, 1] } }"
#define LEFT "{ box: { min: [-1, -1, -1], max: [-0.49, 1, 1] } }"
#define CORNER "{ box: { min: [0.49, 0.49, -1], max: [1, 1, 1] } }"
#define TWO HEAD SHEET("a", "0", "") SHEET("b", "0.02", "")

/* each vertex of a border is paired with the nearest one, and they meet */
static void test_stitch(void **unused)
{
    (void)unused;
    run r;
    check_begin(&r,
                TWO "stitches:\n  - { a: { body: a, at: " TOP " }, b: { body: b, at: " TOP " }, close: 0.2 }\n" END);
    assert_int_equal(r.scene->sim.tie_count, 1);
    const pel_tie_def *tie = &r.scene->sim.ties[0];
    assert_string_equal(pel_sim_tie_name(r.sim, 0), "stitch1");
    assert_int_equal(tie->vertex_count, 5);
    for (int32_t i = 0; i < 5; i++)
        assert_int_equal(tie->vertices[i], tie->to_vertices[i]);
    double x[2][25][3];
    for (int s = 0; s < 30; s++)
        assert_int_equal(pel_sim_step(r.sim, NULL), PEL_OK);
    for (int b = 0; b < 2; b++)
        pel_sim_get_positions(r.sim, b, x[b][0]);
    pel_tie_reading reading;
    pel_sim_get_tie(r.sim, 0, &reading);
    assert_int_equal(reading.held_count, 5);
    assert_true(reading.longest < 2e-3);
    int32_t v = tie->vertices[2];
    assert_true(fabs(x[0][v][2] - x[1][v][2]) < 2e-3);
    end(&r);
}

/* a name in each list, targets by name, numbers and defaults */
static void test_attachment(void **unused)
{
    (void)unused;
    run r;
    check_begin(&r,
                TWO "tools:\n  - { name: hook, shape: sphere, radius: 0.05, press: false, motion: [{ position: [0, 0, "
                    "1] }] }\nattachments:\n  - { body: a, at: " CORNER ", to: { tool: hook }, stiffness: 5, until: "
                    "0.5 }\n  - { name: glue, body: a, at: " LEFT ", to: { body: b }, from: 0.1, strength: 3, close: "
                    "0.3 }\n  - { name: nail, body: b, at: " TOP " }\n" END);
    const pel_tie_def *ties = r.scene->sim.ties;
    assert_int_equal(r.scene->sim.tie_count, 3);
    assert_string_equal(ties[0].name, "attachment1");
    assert_true(ties[0].target == PEL_TIE_TOOL && ties[0].tool == 0 && ties[0].stiffness == 5 && ties[0].until == 0.5);
    assert_true(ties[1].target == PEL_TIE_BODY && ties[1].to_body == 1 && ties[1].from == 0.1 && ties[1].strength == 3);
    assert_true(ties[1].close == 0.3 && ties[0].close < 0);
    assert_true(ties[2].target == PEL_TIE_PLACE && ties[2].body == 1 && isinf(ties[2].until));
    end(&r);
}

static void test_refusals(void **unused)
{
    (void)unused;
    static const refusal cases[] = {
        {TWO "attachments:\n  - { body: c, at: all }\n" END, "unknown body 'c'"},
        {TWO "attachments:\n  - { at: all }\n" END, "the attachment does not say on which body"},
        {TWO "attachments:\n  - { body: a, at: all, to: { body: a } }\n" END, "leads from 'a' to itself"},
        {HEAD TOUGH SHEET("b", "0.02", "") "attachments:\n  - { body: a, at: " TOP ", to: { body: b } }\n" END,
         "beside tears"},
        {TWO "attachments:\n  - { body: a, at: " TOP
             ", to: { body: b } }\nduration: 1\nsolver: { method: pbd, dt: 0.02 "
             "}\n",
         "no attachments"},
        {TWO "attachments:\n  - { body: a, at: all, to: { tool: hook } }\n" END, "unknown tool 'hook'"},
        {TWO "attachments:\n  - { body: a, at: all, from: 1, until: 0.5 }\n" END, "`until` 0.5 is not after `from` 1"},
        {TWO "stitches:\n  - { a: { body: a, at: " TOP " }, b: { body: b, at: all } }\n" END,
         "a.yaml:10:5: error: the borders have 5 and 25 vertices"},
        {TWO "stitches:\n  - { a: { body: a, at: " TOP " }, b: { body: a, at: " LEFT " } }\n" END, "share a vertex"},
        {TWO "stitches:\n  - { a: { body: a, at: " TOP " } }\n" END, "b"},
        {TWO "attachments:\n  - { body: a, at: all }\n"
             "duration: 1\nsolver: { method: quasi-static }\n",
         "this method has no attachments"},
    };
    check_refusals(cases, sizeof cases / sizeof *cases);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_stitch),
        cmocka_unit_test(test_attachment),
        cmocka_unit_test(test_refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
