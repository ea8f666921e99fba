/* Live parameters against the scene: a parameter that is set before the first step gives the same bits as a scene with
   that value, for every parameter and method. */
#include "check.h"
#include "pellicle/live.h"
#include "pellicle/scene.h"
#include "stage/surface_view.h"

#include <stdlib.h>

typedef struct stage {
    pel_scene *scene;
    pel_model *model;
    pel_sim *sim;
} stage;

static const char body_text[] = "version: 1\n"
                                "duration: 1\n"
                                "gravity: [0, 0, -1]\n"
                                "bodies:\n"
                                "  - name: ball\n"
                                "    mesh: {shape: geodesic-sphere, frequency: 2, radius: 1}\n"
                                "    %s\n"
                                "    springs: {stiffness: 3, damping: 0.5}\n"
                                "    volumetric: {stiffness: 1.5, damping: 0.5}\n"
                                "    pressure: %s\n"
                                "    pinned: {nearest: [0, 0, -1]}\n";

/* membranes with different numbers of their own */
static const char *const membranes[] = {"",
                                        "    membrane: {material: stvk, young: 1000, poisson: 0.3, thickness: 0.01}\n",
                                        "    membrane: {material: mooney-rivlin, young: 1000, thickness: 0.01}\n",
                                        "    membrane: {material: gent, young: 1000, thickness: 0.01}\n",
                                        "    membrane: {material: fung, young: 1000, poisson: 0.3, thickness: 0.01}\n"};
static const char bending[] = "    bending: {model: hinge, stiffness: 1.0e-3}\n";
static const char *const fibres[] = {
    "", "    anisotropy: [{mode: active, stiffness: 5, rest_length: 0.9, direction: [1, 0, 0]}]\n",
    "    anisotropy: [{mode: curl, curvature: -0.5, stiffness: 5}]\n",
    ("    anisotropy: [{mode: normal, stiffness: 5, gradient: 2, max_step: 0.1},\n      {mode: cave, stiffness: 5, "
     "strength: 0.01, region: {sphere: {center: [0,0,1], radius: 0.5}}}]\n")};
static const char *const masses[] = {"mass: {density: 1000, thickness: 0.01}", "mass: {per_vertex: 1}",
                                     "mass: {total: 80}"};
static const char *const pressures[] = {"{outside: 2}", "{gas: {pressure: 1000}}", "{volume: {target: 1, bulk: 100}}"};
static const char refinement[] =
    "    refine: {levels: 1, above: 0.4, below: 0.2, curvature: {above: 0.3, below: 0.15}, "
    "near_tools: 0.15, rings: 1}\n";
/* what it has: a number above 0 is read, however small */
static const char *const criteria[] = {"bodies.ball.refine.above", "bodies.ball.refine.below",
                                       "bodies.ball.refine.curvature.above", "bodies.ball.refine.curvature.below",
                                       "bodies.ball.refine.near_tools"};
static const char outside[] = "loads:\n"
                              "  - {name: pull, force: [0, 0, 0.5], at: {nearest: [1, 0, 0]}}\n"
                              "tools:\n"
                              "  - {name: ball-tool, shape: sphere, radius: 0.3, motion: [{position: [0, 0, 1.302]}, "
                              "{time: 0.01, position: [0, 0, 1.28]}]}\n"
                              "  - {name: rod, shape: capsule, radius: 0.2, length: 1, motion: [{position: [1.202, 0, "
                              "0]}, {time: 0.01, position: [1.18, 0, 0]}]}\n"
                              "  - {name: box, shape: box, size: [0.4, 0.4, 0.4], motion: [{position: [-1.202, 0, 0]}, "
                              "{time: 0.01, position: [-1.18, 0, 0]}]}\n"
                              "  - {name: hand, shape: sphere, radius: 0.1, press: false, grasp: {reach: 0.3, from: "
                              "0.001}, motion: [{position: [0, 1.1, 0]}, {time: 0.01, position: [0, 1.12, 0]}]}\n";
static const char contact[] = "contact: {thickness: 1.0e-3, friction: 0.3}\n";

typedef struct variant {
    const char *method;
    int mass, membrane, fibre, pressure;
    bool refines, touches;
} variant;

static pel_status parse(const char *text, const char *override, pel_scene **scene, pel_error *error)
{
    return pel_scene_parse("test.yaml", text, strlen(text), &override, override != NULL, NULL, scene, error);
}

static void end(stage *s)
{
    pel_sim_destroy(s->sim);
    pel_model_destroy(s->model);
    pel_scene_destroy(s->scene);
}

static pel_status make(const char *text, const char *override, stage *s, pel_error *error)
{
    *s = (stage){NULL, NULL, NULL};
    pel_status status = parse(text, override, &s->scene, error);
    if (status == PEL_OK)
        status = pel_model_create(&s->scene->model, &s->model, error);
    if (status != PEL_OK)
        return status;
    pel_sim_def def = s->scene->sim;
    def.model = s->model;
    def.thread_count = 1;
    return pel_sim_create(&def, &s->sim, error);
}

static void write_scene(const variant *v, char *text, size_t size)
{
    size_t length = (size_t)snprintf(text, size, body_text, masses[v->mass], pressures[v->pressure]);
    length += (size_t)snprintf(text + length, size - length, "%s%s%s%s%s%s", membranes[v->membrane],
                               v->membrane > 0 ? bending : "", fibres[v->fibre], v->refines ? refinement : "", outside,
                               v->touches ? contact : "");
    snprintf(text + length, size - length, "solver: {method: %s, dt: %s}\n", v->method,
             strcmp(v->method, "quasi-static") == 0 ? "0.01" : "0.002");
}

/* some other value that is in range; false when there is none */
static bool choose(const pel_parameter_info *info, double values[3], char *text, size_t size)
{
    int count = info->kind == PEL_PARAMETER_VECTOR ? 3 : 1;
    if (!info->is_live)
        return false;
    for (int i = 0; i < count; i++) {
        double x = info->value[i];
        if (info->kind == PEL_PARAMETER_WORD) {
            values[i] = x > 0 ? x - 1 : x + 1;
        } else if (info->kind == PEL_PARAMETER_SWITCH) {
            values[i] = x == 0;
        } else if (info->kind == PEL_PARAMETER_INTEGER) {
            values[i] = isnan(x) || x == 0 ? fmax(info->least, 2) : x + 1;
        } else {
            values[i] = isnan(x) || x == 0 ? fmin(0.3, info->most) : 0.9 * x;
        }
        if (values[i] > info->most)
            values[i] = info->least;
    }
    if (info->kind == PEL_PARAMETER_WORD)
        snprintf(text, size, "%s", info->words[(int)values[0]]);
    else if (info->kind == PEL_PARAMETER_SWITCH)
        snprintf(text, size, "%s", values[0] != 0 ? "true" : "false");
    else if (count == 3)
        snprintf(text, size, "[%.17g, %.17g, %.17g]", values[0], values[1], values[2]);
    else
        snprintf(text, size, "%.17g", values[0]);
    return true;
}

static uint64_t run(pel_sim *sim, int32_t steps)
{
    pel_error error;
    for (int32_t i = 0; i < steps; i++)
        if (pel_sim_step(sim, &error) != PEL_OK)
            return (uint64_t)i;
    return pel_sim_hash(sim);
}

typedef struct tally {
    long set, refused, keyed;
} tally;

/* live and written: the same status and the same bits */
static void compare(const char *scene, const char *override, pel_status status, stage *live, const pel_error *refusal,
                    tally *count)
{
    stage written;
    pel_error error;
    char text[1000], other[1000];
    pel_status made = make(scene, override, &written, &error);
    if (made != status)
        fail_msg("%s: %s, but written: %s", override, status ? pel_error_text(refusal, text, sizeof text) : "taken",
                 made ? pel_error_text(&error, other, sizeof other) : "taken");
    if (made == PEL_OK) {
        uint64_t expected = run(written.sim, 6), hash = run(live->sim, 6);
        if (hash != expected)
            fail_msg("%s: live it has other bits\n%s", override, scene);
        count->set++;
    } else {
        count->refused++;
    }
    end(&written);
}

static void check_number(const char *scene, const pel_parameter_info *info, tally *count)
{
    stage live;
    pel_error error;
    double values[3];
    char text[100], override[400];
    if (strcmp(info->row, "loads[].keys") == 0 || !choose(info, values, text, sizeof text))
        return;
    assert_int_equal(make(scene, NULL, &live, &error), PEL_OK);
    pel_status status = info->kind == PEL_PARAMETER_VECTOR
                            ? pel_set_parameter_vector(live.sim, info->path, values, &error)
                            : pel_set_parameter(live.sim, info->path, values[0], &error);
    if (status == PEL_OK) {
        pel_parameter_info now;
        assert_int_equal(pel_parameter_find(live.sim, info->path, &now, NULL), PEL_OK);
        assert_true(now.value[0] == values[0]);
    }
    snprintf(override, sizeof override, "%s=%s", info->path, text);
    compare(scene, override, status, &live, &error, count);
    end(&live);
}

static void check_keys(const char *scene, const pel_parameter_info *info, tally *count)
{
    stage live;
    pel_error error;
    char override[400];
    if (!info->may_be_keyed)
        return;
    assert_int_equal(make(scene, NULL, &live, &error), PEL_OK);
    bool is_factor = strcmp(info->row, "loads[].keys") == 0;
    const pel_key keys[2] = {{0, info->value[0]}, {0.01, 1.5 * info->value[0]}};
    pel_status status = pel_set_parameter_keys(live.sim, info->path, keys, 2, &error);
    snprintf(override, sizeof override, "%s%s=[[0, %.17g], [0.01, %.17g]]", info->path, is_factor ? "" : ".keys",
             keys[0].value, keys[1].value);
    compare(scene, override, status, &live, &error, count);
    count->keyed++;
    end(&live);
}

static void check_variant(const variant *v, int32_t first_parameter, tally *count)
{
    char scene[4000], text[1000];
    pel_error error;
    stage first;
    write_scene(v, scene, sizeof scene);
    if (make(scene, NULL, &first, &error) != PEL_OK)
        fail_msg("%s\n%s", pel_error_text(&error, text, sizeof text), scene);
    int32_t parameter_count = pel_parameter_count(first.sim);
    assert_true(parameter_count > 25);
    for (size_t i = 0; v->refines && i < sizeof criteria / sizeof *criteria; i++)
        assert_int_equal(pel_parameter_find(first.sim, criteria[i], &(pel_parameter_info){0}, NULL), PEL_OK);
    for (int32_t p = first_parameter; p < parameter_count; p += LONG(1, ROUNDS(3, 9))) {
        pel_parameter_info info;
        pel_parameter_at(first.sim, p, &info);
        check_number(scene, &info, count);
        check_keys(scene, &info, count);
    }
    end(&first);
}

static void test_same_bits(void **unused)
{
    (void)unused;
    static const variant variants[] = {
        {"quasi-static", 1, 0, 0, 0, false, false}, {"quasi-static", 2, 0, 0, 0, true, false},
        {"explicit", 0, 1, 1, 0, false, true},      {"explicit", 1, 4, 2, 1, true, false},
        {"pbd", 0, 1, 3, 0, false, true},           {"pbd-distance", 1, 0, 0, 0, false, false},
        {"xpbd", 0, 1, 1, 0, false, false},         {"xpbd", 0, 2, 2, 2, true, true},
        {"descent", 0, 3, 0, 0, false, true},       {"static", 0, 1, 0, 0, false, false},
        {"implicit", 0, 4, 1, 1, false, false},
    };
    tally count = {0, 0, 0};
    for (size_t i = 0; i < sizeof variants / sizeof *variants; i++)
        check_variant(&variants[i], LONG(0, (int32_t)i % ROUNDS(3, 9)), &count);
    print_message("%ld values set, %ld refused by both, %ld with keys\n", count.set, count.refused, count.keyed);
    assert_true(count.set > LONG(300, ROUNDS(100, 20)) && count.keyed > LONG(40, ROUNDS(13, 2)));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_same_bits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
