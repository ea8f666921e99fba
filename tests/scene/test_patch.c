/* A scene with a number written over is the scene that is read with that number, for every parameter that may be
   written over, in scenes with as many defaults as possible. */
#include "check.h"

#include "choice/plan.h"
#include "def/fingerprint.h"
#include "scene/patch.h"

static const char ball[] = "mesh: {shape: geodesic-sphere, frequency: 2}";
static const char outside[] =
    "loads: [{name: pull, force: [0, 0, 0.5], from: 0.1, until: 0.6, at: {nearest: [1, 0, 0]}},\n"
    "        {name: push, force: [0, 0, 0.5], keys: [[0, 0], [1, 1]], at: {nearest: [1, 0, 0]}}]\n"
    "tools: [{name: rod, shape: capsule, radius: 0.2, length: 1, motion: [{position: [2, 0, 0]}]},\n"
    "        {name: block, shape: box, size: [0.4, 0.4, 0.4], motion: [{position: {above: highest, by: 1}}]},\n"
    "        {name: hand, shape: sphere, radius: 0.1, press: false, grasp: {reach: 0.3, from: 0.1, until: 0.4},\n"
    "         motion: [{position: [0, 1.1, 0]}]}]\n"
    "contact: {friction: 0.3}\n";

/* of a body, with dependent keys first omitted, then given */
static const char *const bodies[] = {
    "springs: {young: 1000}, volumetric: {}, mass: {density: 900}",
    "springs: {young: 1000, thickness: 0.1, drag: 1}, volumetric: {young: 500, depth: 0.2, drag: 2}",
    "springs: {stiffness: 3, damping: 0.5}, volumetric: {stiffness: 1, damping: 0.2}, mass: {total: 8}, "
    "scale_with_area: true",
    "preset: paper-a, volumetric: {}",
    "membrane: {material: stvk, young: 1000, poisson: 0.3, thickness: 0.01}, bending: {}",
    "membrane: {young: 1000, thickness: 0.01}, pressure: {gas: {pressure: 1000}}, "
    "anisotropy: [{mode: active, rest_length: 0.9, direction: [1, 0, 0]}]",
    "membrane: {preset: rubber}, pressure: {inside: 100}",
    "membrane: {material: mooney-rivlin, young: 1000, thickness: 0.01}, mass: {density: 900, thickness: 0.02}, "
    "pressure: {volume: {target: 1.1, bulk: 100}}, bending: {stiffness: 1.0e-3}",
    "membrane: {material: gent, young: 1000}, mass: {density: 900, thickness: 0.02}, "
    "supports: [{at: {nearest: [0, 0, -1]}, fix: [x, y, z]}]",
    "membrane: {material: fung, young: 1000, thickness: 0.01, strain_limit: 0.2}, mass: {per_vertex: 1}, "
    "refine: {levels: 1, above: 4, curvature: {above: 1}, near_tools: 0.1}",
};
static const char *const methods[] = {"", "quasi-static", "explicit", "pbd", "xpbd", "descent", "static", "implicit"};

static pel_scene *read_scene(const char *text, const char *override, pel_error *error)
{
    pel_scene *scene;
    pel_status status =
        pel_scene_parse("test.yaml", text, strlen(text), &override, override != NULL, NULL, &scene, error);
    assert_true(status == PEL_OK || scene == NULL);
    return scene;
}

static void write_scene(char text[4000], size_t body, size_t method)
{
    bool is_static = strcmp(methods[method], "static") == 0;
    snprintf(text, 4000, "version: 1\nbodies: [{name: ball, %s, %s}]\n%s%ssolver: {%s%s%s}\ngravity: [0, 0, -1]\n",
             ball, bodies[body], outside, is_static ? "" : "duration: 1\n",
             methods[method][0] != '\0' ? "method: " : "", methods[method],
             is_static || methods[method][0] == '\0' ? "" : ", dt: 0.001");
}

/* Some other values, as text: near the present one and far from it. False when there are no more. */
static bool choose(const pel_def_row *row, double now, int round, char text[100])
{
    static const double factors[] = {0.9, 1e-3, 1e3, 1.1};
    if (pel_def_row_kind(row) == PEL_PARAMETER_WORD) {
        if (pel_def_row_words(row)[round] == NULL)
            return false;
        snprintf(text, 100, "%s", pel_def_row_words(row)[round]);
        return true;
    }
    if (round >= 4)
        return false;
    double x = now != 0 && isfinite(now) ? factors[round] * now : 0.3 * factors[round];
    if (pel_def_row_kind(row) == PEL_PARAMETER_INTEGER)
        x = fmax(row->range.least, 1) + round;
    x = row->range.given ? fmin(x, row->range.most) : x;
    if (pel_def_row_kind(row) == PEL_PARAMETER_VECTOR)
        snprintf(text, 100, "[%.17g, %.17g, %.17g]", fabs(x), 0.5 * fabs(x), 0.25 * fabs(x));
    else if (pel_def_row_kind(row) == PEL_PARAMETER_SWITCH)
        snprintf(text, 100, "%s", round % 2 == 0 ? "true" : "false");
    else
        snprintf(text, 100, "%.17g", x);
    return true;
}

static pel_fingerprint fingerprint_of(const pel_scene *scene)
{
    pel_fingerprint made = {0};
    pel_fingerprint_add(&made, PEL_DEF_MODEL, &scene->model);
    pel_fingerprint_add(&made, PEL_DEF_SIM, &scene->sim);
    return made;
}

static void check_same(const pel_scene *patched, const pel_scene *written, const char *override, const char *text)
{
    char names[400];
    const pel_fingerprint a = fingerprint_of(patched), b = fingerprint_of(written);
    if (pel_fingerprint_compare(&a, &b, names, sizeof names)[0] != '\0')
        fail_msg("%s: %s differ from a scene that is read with it\n%s", override, names, text);
    const pel_run_plan p = pel_run_plan_make(patched, 0), w = pel_run_plan_make(written, 0);
    assert_true(p.dt == w.dt && p.step_total == w.step_total && p.settled_time == w.settled_time);
    assert_true(p.steps_per_frame == w.steps_per_frame && patched->rest_speed == written->rest_speed);
}

/* A scene that refuses the value has to be refused by the model or the simulation too. */
static void check_refused(const pel_scene *patched, const char *override, const char *text)
{
    pel_model *model = NULL;
    pel_sim *sim = NULL;
    pel_status status = pel_model_create(&patched->model, &model, NULL);
    pel_sim_def def = patched->sim;
    def.model = model;
    if (status == PEL_OK)
        status = pel_sim_create(&def, &sim, NULL);
    if (status == PEL_OK)
        fail_msg("%s: the scene refuses what is written over\n%s", override, text);
    pel_sim_destroy(sim);
    pel_model_destroy(model);
}

typedef struct tally {
    long written, refused, apart;
} tally;

/* first: with its present value, from which it goes to the other one */
static void check_value(const char *text, const char *first, const char *path, const char *value, tally *count)
{
    char override[300];
    pel_parameter_place place;
    pel_scene *patched = read_scene(text, first, NULL);
    assert_non_null(patched);
    assert_true(pel_scene_patch_find(patched, path, &place));
    snprintf(override, sizeof override, "%s=%s", path, value);
    pel_scene *written = read_scene(text, override, NULL);
    if (!pel_scene_patch(patched, place, value)) {
        count->apart++;
    } else if (written == NULL) {
        check_refused(patched, override, text);
        count->refused++;
    } else {
        check_same(patched, written, override, text);
        count->written++;
    }
    pel_scene_destroy(patched);
    pel_scene_destroy(written);
}

static void check_scene(const char *text, tally *count)
{
    pel_error error;
    char message[1200];
    pel_scene *scene = read_scene(text, NULL, &error);
    if (scene == NULL)
        fail_msg("%s\n%s", pel_error_text(&error, message, sizeof message), text);
    pel_model *model;
    pel_sim *sim;
    assert_int_equal(pel_model_create(&scene->model, &model, NULL), PEL_OK);
    pel_sim_def def = scene->sim;
    def.model = model;
    def.thread_count = 1;
    if (pel_sim_create(&def, &sim, &error) != PEL_OK)
        fail_msg("%s\n%s", pel_error_text(&error, message, sizeof message), text);
    for (int32_t p = 0; p < pel_parameter_count(sim); p += LONG(1, 3)) {
        pel_parameter_info info;
        pel_parameter_place place;
        char value[100], first[300];
        pel_parameter_at(sim, p, &info);
        if (!pel_scene_patch_find(scene, info.path, &place))
            continue;
        const pel_def_row *row = pel_def_row_at(place.row);
        assert_true(choose(row, info.value[0], 0, value));
        snprintf(first, sizeof first, "%s=%s", info.path, value);
        pel_scene *other = read_scene(text, first, NULL);
        for (int round = 1; other != NULL && choose(row, info.value[0], round, value); round++)
            check_value(text, first, info.path, value, count);
        pel_scene_destroy(other);
    }
    pel_sim_destroy(sim);
    pel_model_destroy(model);
    pel_scene_destroy(scene);
}

/* skip bodies that a method does not support */
static bool is_possible(const char *text)
{
    pel_scene *scene = read_scene(text, NULL, NULL);
    pel_model *model = NULL;
    pel_sim *sim = NULL;
    if (scene == NULL || pel_model_create(&scene->model, &model, NULL) != PEL_OK) {
        pel_scene_destroy(scene);
        return false;
    }
    pel_sim_def def = scene->sim;
    def.model = model;
    bool is_made = pel_sim_create(&def, &sim, NULL) == PEL_OK;
    pel_sim_destroy(sim);
    pel_model_destroy(model);
    pel_scene_destroy(scene);
    return is_made;
}

static void test_written_over(void **unused)
{
    (void)unused;
    enum { BODY_COUNT = sizeof bodies / sizeof *bodies, METHOD_COUNT = sizeof methods / sizeof *methods };
    tally count = {0, 0, 0};
    int scenes = 0;
    for (size_t b = 0; b < BODY_COUNT; b++) {
        bool any = false;
        for (size_t m = is_slow() ? b % METHOD_COUNT : 0; m < METHOD_COUNT; m += ROUNDS(1, METHOD_COUNT)) {
            char text[4000];
            write_scene(text, b, m);
            if (!is_possible(text))
                continue;
            any = true;
            scenes++;
            check_scene(text, &count);
        }
        if (!any && !is_slow())
            fail_msg("no method knows the body %s", bodies[b]);
    }
    print_message("%d scenes, %ld values written over, %ld refused, %ld to be read\n", scenes, count.written,
                  count.refused, count.apart);
    assert_true(scenes >= ROUNDS(30, 3) && count.written > LONG(2000, ROUNDS(500, 100)));
}

static bool may_patch(const char *text, const char *path)
{
    pel_parameter_place place;
    pel_scene *scene = read_scene(text, NULL, NULL);
    assert_non_null(scene);
    bool may = pel_scene_patch_find(scene, path, &place);
    pel_scene_destroy(scene);
    return may;
}

static void test_what_is_read_anew(void **unused)
{
    (void)unused;
    char text[4000];
    write_scene(text, 4, 4);
    assert_true(may_patch(text, "loads.pull.force") && may_patch(text, "loads.0.force"));
    assert_true(may_patch(text, "gravity") && may_patch(text, "bodies.ball.membrane.poisson"));
    assert_false(may_patch(text, "loads.pull.force.2"));
    assert_false(may_patch(text, "bodies.ball.membrane.thickness"));
    assert_false(may_patch(text, "solver.dt") || may_patch(text, "solver.method") || may_patch(text, "duration"));
    /* the method that the program takes depends on the material */
    write_scene(text, 4, 0);
    assert_false(may_patch(text, "bodies.ball.membrane.poisson"));
    assert_true(may_patch(text, "loads.pull.force"));
    /* and so may its step */
    static const char *const steps = "version: 1\nbodies: [{name: a, mesh: {shape: grid}, membrane: {young: 1000, "
                                     "thickness: 0.01}}]\nduration: 0.01\nsolver: {method: %s%s}\n";
    static const char *const kinds[] = {"explicit", "implicit", "xpbd"};
    for (int i = 0; i < 6; i++) {
        snprintf(text, sizeof text, steps, kinds[i / 2], i % 2 == 0 ? "" : ", dt: 0.0001");
        assert_int_equal(may_patch(text, "bodies.a.membrane.poisson"), i % 2 != 0 || i == 4);
    }
}

/* other texts than a plain number leave the scene unchanged */
static void test_other_values(void **unused)
{
    (void)unused;
    char text[4000];
    write_scene(text, 2, 1);
    pel_scene *scene = read_scene(text, NULL, NULL);
    pel_parameter_place place;
    assert_true(pel_scene_patch_find(scene, "bodies.ball.springs.stiffness", &place));
    const char *const others[] = {"-1", "x", "", "[1, 2, 3]", "nan", "inf", "{ keys: [[0, 1]] }", "auto", "3 "};
    for (size_t i = 0; i + 1 < sizeof others / sizeof *others; i++)
        assert_false(pel_scene_patch(scene, place, others[i]));
    assert_true(scene->model.bodies[0].spring_stiffness.value == 3);
    assert_true(pel_scene_patch(scene, place, "4"));
    assert_true(scene->model.bodies[0].spring_stiffness.value == 4);
    assert_true(pel_scene_patch_find(scene, "tools.rod.friction", &place));
    assert_false(pel_scene_patch(scene, place, "auto"));
    pel_scene_destroy(scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_written_over),
        cmocka_unit_test(test_what_is_read_anew),
        cmocka_unit_test(test_other_values),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
