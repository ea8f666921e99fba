/* Rows of runs that share a scene, a model or a simulation with the run before are those of runs that share nothing, to
   the bit: for all methods, numbers of all kinds, and runs that fail in between. */
#define _XOPEN_SOURCE 700 /* mkdtemp */
#include "check.h"

#include "failing_malloc.h"
#include "study/kept.h"

#include <stdlib.h>
#include <unistd.h>

enum { ROW = 8192 };

static char folder[64], scene_path[128], study_path[128];

static int set_up(void **unused)
{
    (void)unused;
    snprintf(folder, sizeof folder, "kept-test-XXXXXX");
    if (mkdtemp(folder) == NULL)
        return -1;
    snprintf(scene_path, sizeof scene_path, "%s/scene.yaml", folder);
    snprintf(study_path, sizeof study_path, "%s/study.yaml", folder);
    return 0;
}

static int tear_down(void **unused)
{
    (void)unused;
    unlink(scene_path);
    return rmdir(folder);
}

static const char tissue[] = "springs: {stiffness: 3, damping: 0.5}, volumetric: {stiffness: 1.5, damping: 0.5}";
static const char shell[] = "membrane: {young: 1000, thickness: 0.01}, bending: {}, pinned: {nearest: [0, 0, -1]}";
static const char pressed[] =
    "tools: [{name: probe, shape: sphere, radius: 0.3, motion: [{position: [0, 0, 1.31]}, "
    "{time: 0.02, position: [0, 0, 1.2]}]},\n"
    "  {name: hand, shape: sphere, radius: 0.2, press: false, grasp: {reach: 0.3, from: 0.001, max_force: 1},\n"
    "   motion: [{position: [1.1, 0, 0]}, {time: 0.02, position: [1.2, 0, 0]}]}]\n";

/* direct numbers, those of the simulation, those of the model; the last values are refused, or make it diverge */
static const struct study_case {
    const char *method, *body, *more, *vary;
} cases[] = {
    {"quasi-static, alpha: 20", tissue, "", "duration: [0.015], loads.pull.force: [[0, 0, 1], [0, 1, 0], [2, 0, 0]]"},
    {"quasi-static, alpha: 20", tissue, pressed,
     "{loads.pull.force: [[0, 0, 1], [1, 0, 1]], bodies.ball.springs.stiffness: [3, 2, -1], solver.alpha: [20, 1e9]}"},
    {"quasi-static", tissue, "", "bodies.ball.volumetric.stiffness: [1, 2, 3], gravity: [[0, 0, 0], [0, 0, -1]]"},
    {"explicit", tissue, pressed, "tools.hand.grasp.max_force: [0.01, 1, 5], tools.hand.grasp.reach: [0.05, 0.3]"},
    {"explicit", shell, "contact: {}\n", "loads.pull.force: [[0, 0, 1], [0, 0, 1e9]], contact.friction: [0, 0.5]"},
    {"pbd", shell, pressed, "tools.probe.friction: [0, 0.4], bodies.ball.membrane.poisson: [0.1, 0.3]"},
    {"pbd-distance", tissue, "contact: {}\n", "solver.iterations: [2, 5], loads.pull.force: [[0, 0, 1], [1, 1, 0]]"},
    {"xpbd", shell, pressed, "tools.hand.grasp.max_force: [0.1, 1], bodies.ball.membrane.poisson: [0.1, 0.3]"},
    {"xpbd, max_substeps: 50", shell, "contact: {friction: 0.2}\n", "loads.pull.force: [[0, 0, 1], [0, 5, 0]]"},
    {"descent", shell, pressed, "loads.pull.force: [[0, 0, 1], [0, 5, 0]], tools.probe.radius: [0.3, 0.25]"},
    {"static", shell, "", "loads.pull.force: [[0, 0, 1], [0, 0.5, 0], [1, 0, 0]]"},
    {"implicit", shell, "", "loads.pull.force: [[0, 0, 1], [0, 0.5, 0]], gravity: [[0, 0, 0], [0, 0, -1]]"},
    {"implicit", shell, pressed, "loads.pull.force: [[0, 0, 1], [0, 0.5, 0], [1, 0, 0]]"},
    {"implicit", tissue, "contact: {}\n", "loads.pull.force: [[0, 0, 1], [0, 0.5, 0]]"},
    /* of the material, with the method left to the program: each is read anew */
    {"", shell, "", "bodies.ball.membrane.young: [1e3, 1e6]"},
    {"", shell, pressed, "loads.pull.force: [[0, 0, 1], [0, 0.5, 0]]"},
    {"quasi-static", "springs: {stiffness: 3, damping: 0.5}, refine: {levels: 1, above: 2, interval: 1}", "",
     "loads.pull.force: [[0, 0, 1], [0, 1, 0], [3, 0, 0]]"},
};

static const char measures[] =
    "measure: {hash: state_hash, most: max_displacement, left: residual_displacement, volume: volume_ratio_final, "
    "tool: max_tool_force, steps: steps, vertices: vertices_final, cuts: self_intersections_final, alpha: alpha, "
    "rises: volume_rises, warnings: warnings, iterations: solver_iterations, residual: solver_residual, "
    "late: solver_unconverged_steps, elastic: energy.elastic, start: energy.elastic_start, tools: energy.work_tools, "
    "loads: energy.work_loads, material: energy.work_material, gap: energy.energy_error, "
    "force: {column: max_force, at: mean}, contacts: {column: contacts, at: max}, first: {column: max_force, at: "
    "start}}\n";

static const char few_measures[] = "measure: [state_hash, max_displacement, volume_rise_sum, energy.work_loads]\n";

static pel_study *make_study(const struct study_case *c, const char *measured)
{
    char text[4000];
    bool is_static = strncmp(c->method, "static", 6) == 0;
    snprintf(text, sizeof text,
             "version: 1\nbodies: [{name: ball, mesh: {shape: geodesic-sphere, frequency: 2}, mass: {per_vertex: 0.1}, "
             "%s}]\nloads: [{name: pull, force: [0, 0, 0.5], until: 0.01, at: {nearest: [0, 1, 0]}}]\n%s%s"
             "solver: {%s%s%s}\noutput: {every_frame: 4}\n",
             c->body, c->more, is_static ? "" : "duration: 0.02\n", c->method[0] != '\0' ? "method: " : "", c->method,
             is_static              ? ""
             : c->method[0] != '\0' ? ", dt: 0.001"
                                    : "dt: 0.001");
    FILE *file = fopen(scene_path, "w");
    assert_non_null(file);
    fputs(text, file);
    assert_int_equal(fclose(file), 0);
    bool is_map = c->vary[0] == '{';
    snprintf(text, sizeof text, "scene: scene.yaml\nvary: %s%s%s\n%s", is_map ? "" : "{", c->vary, is_map ? "" : "}",
             measured);
    pel_study *study;
    pel_error error;
    char message[1200];
    if (pel_study_parse(study_path, text, strlen(text), &study, &error) != PEL_OK)
        fail_msg("%s\n%s", pel_error_text(&error, message, sizeof message), text);
    return study;
}

typedef struct tally {
    int rows, done, kept_simulations, kept_models, kept_scenes;
} tally;

/* forth and back, so that every run follows others */
static void check_case(const struct study_case *c, const char *measured, tally *count)
{
    static char alone[ROW], shared[ROW];
    pel_study *study = make_study(c, measured);
    assert_true(pel_study_row_size(study) <= ROW);
    pel_study_kept kept = {0};
    int64_t runs = pel_study_run_count(study);
    for (int64_t i = 0; i < 2 * runs; i++) {
        int64_t run = i < runs ? i : 2 * runs - 1 - i;
        const pel_study_kept before = kept;
        assert_int_equal(pel_study_run(study, run, NULL, NULL, NULL, alone, NULL), PEL_OK);
        assert_int_equal(pel_study_run_kept(study, &kept, run, shared, NULL), PEL_OK);
        if (strcmp(alone, shared) != 0)
            fail_msg("method '%s', vary %s:\n%s\nbut in a row of runs\n%s", c->method, c->vary, alone, shared);
        count->rows++;
        count->done += pel_study_row_is_done(alone);
        count->kept_scenes += before.scene != NULL && kept.scene == before.scene;
        count->kept_models += before.parts.model != NULL && kept.parts.model == before.parts.model;
        count->kept_simulations += before.parts.sim != NULL && kept.parts.sim == before.parts.sim;
    }
    pel_study_kept_drop(&kept);
    assert_null(kept.scene);
    pel_study_destroy(study);
}

static void test_same_rows(void **unused)
{
    (void)unused;
    tally count = {0, 0, 0, 0, 0};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        check_case(&cases[i], measures, &count);
        check_case(&cases[i], few_measures, &count);
    }
    print_message("%d rows, %d of runs that are done; kept %d scenes, %d models, %d simulations\n", count.rows,
                  count.done, count.kept_scenes, count.kept_models, count.kept_simulations);
    assert_true(count.done > 100 && count.done < count.rows);
    assert_true(count.kept_scenes > 80 && count.kept_models > 60 && count.kept_simulations > 50);
}

/* runs that share a simulation find what their rows say, and nothing else: each number by itself */
static void test_single_numbers(void **unused)
{
    (void)unused;
    static const char *const keys[] = {"max_displacement",
                                       "residual_displacement",
                                       "volume_ratio_final",
                                       "area_ratio_final",
                                       "vertices_final",
                                       "triangles_final",
                                       "state_hash",
                                       "volume_rises",
                                       "volume_rise_sum",
                                       "volume_rise_max",
                                       "warnings",
                                       "energy.elastic",
                                       "energy.energy_error",
                                       "energy.supplied",
                                       "self_intersections_final"};
    tally count = {0, 0, 0, 0, 0};
    for (size_t k = 0; k < sizeof keys / sizeof *keys; k++) {
        char measured[100];
        snprintf(measured, sizeof measured, "measure: [%s]\n", keys[k]);
        for (size_t i = 0; i < sizeof cases / sizeof *cases; i += 5)
            check_case(&cases[i], measured, &count);
    }
    assert_true(count.done > 100);
}

/* steps without convergence are counted also where nothing else is asked for */
static void test_unconverged(void **unused)
{
    (void)unused;
    static const struct study_case descent = {"descent, iterations: 1", shell, "",
                                              "loads.pull.force: [[0, 0, 5], [0, 5, 0]]"};
    tally count = {0, 0, 0, 0, 0};
    check_case(&descent, "measure: [solver_unconverged_steps]\n", &count);
    pel_study *study = make_study(&descent, "measure: [solver_unconverged_steps]\n");
    static char row[ROW];
    assert_int_equal(pel_study_run(study, 0, NULL, NULL, NULL, row, NULL), PEL_OK);
    assert_non_null(strstr(row, ",16,done,"));
    pel_study_destroy(study);
}

/* two runs of one simulation; the study is the data */
static pel_status run_case(const void *data, pel_error *error)
{
    static char row[ROW];
    pel_study_kept kept = {0};
    pel_status status = pel_study_run_kept(data, &kept, 0, row, error);
    if (status == PEL_OK)
        status = pel_study_run_kept(data, &kept, 1, row, error);
    pel_study_kept_drop(&kept);
    return status;
}

static void test_memory(void **unused)
{
    (void)unused;
    pel_study *study = make_study(&cases[0], few_measures);
    assert_true(for_every_allocation_failure(run_case, study) > 100);
    pel_study_destroy(study);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_same_rows),
        cmocka_unit_test(test_single_numbers),
        cmocka_unit_test(test_unconverged),
        cmocka_unit_test(test_memory),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
