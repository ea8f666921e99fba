#include "misuse.h"

#include <pellicle/study.h>

static const char study_text[] = "scene: study-misuse-scene.yaml\nvary: { solver.dt: [0.01, 0.02] }\n";
static const char scene_text[] = "version: 1\n"
                                 "bodies: [{ name: ball, mesh: { shape: geodesic-sphere, frequency: 1 } }]\n"
                                 "duration: 0.02\n";

static void test_study(void **unused)
{
    (void)unused;
    pel_study *study = NULL, *made;
    pel_study_store *store;
    pel_study_def def = pel_study_def_default(), wrong;
    char *json, row[4096];
    FILE *file = fopen("study-misuse-scene.yaml", "w");
    assert_non_null(file);
    fputs(scene_text, file);
    assert_int_equal(fclose(file), 0);
    assert_int_equal(pel_study_parse("study.yaml", study_text, strlen(study_text), &study, NULL), PEL_OK);
    assert_true(pel_study_row_size(study) <= sizeof row);

    REFUSED("path", pel_study_load(NULL, &made, &error));
    REFUSED("study", pel_study_load("a.yaml", NULL, &error));
    REFUSED("path", pel_study_parse(NULL, study_text, 3, &made, &error));
    REFUSED("text", pel_study_parse("a.yaml", NULL, 3, &made, &error));
    REFUSED("study", pel_study_parse("a.yaml", study_text, 3, NULL, &error));
    SURVIVES(pel_study_destroy(NULL));
    GIVES(pel_study_run_count(NULL) == 0 && pel_study_row_size(NULL) == 0 && pel_study_header(NULL)[0] == '\0');
    REFUSED("study", pel_study_run(NULL, 0, NULL, NULL, NULL, row, &error));
    REFUSED("row", pel_study_run(study, 0, NULL, NULL, NULL, NULL, &error));
    REFUSED("no run", pel_study_run(study, 2, NULL, NULL, NULL, row, &error));
    REFUSED("no run", pel_study_run(study, -1, NULL, NULL, NULL, row, &error));
    REFUSED("study", pel_study_store_open(NULL, "misuse", 1, 1, &store, &error));
    REFUSED("folder", pel_study_store_open(study, NULL, 1, 1, &store, &error));
    REFUSED("folder", pel_study_store_open(study, "", 1, 1, &store, &error));
    REFUSED("store", pel_study_store_open(study, "misuse", 1, 1, NULL, &error));
    REFUSED("chunk", pel_study_store_open(study, "misuse", 0, 1, &store, &error));
    REFUSED("chunk", pel_study_store_open(study, "misuse", 3, 2, &store, &error));
    SURVIVES(pel_study_store_close(NULL));
    GIVES(!pel_study_store_needs(NULL, 0) && !pel_study_store_failed(NULL, 0));
    REFUSED("study", pel_study_lost_run(NULL, 0, "crashed", "why", NULL, row, &error));
    REFUSED("status", pel_study_lost_run(study, 0, NULL, "why", NULL, row, &error));
    REFUSED("what", pel_study_lost_run(study, 0, "crashed", NULL, NULL, row, &error));
    REFUSED("row", pel_study_lost_run(study, 0, "crashed", "why", NULL, NULL, &error));
    REFUSED("store", pel_study_store_add(NULL, "0,1,done,", &error));
    REFUSED("store", pel_study_store_collect(NULL, NULL, NULL, &error));
    REFUSED("study", pel_study_execute(NULL, &def, NULL, &error));
    REFUSED("def", pel_study_execute(study, NULL, NULL, &error));
    REFUSED("folder", pel_study_execute(study, &def, NULL, &error));
    wrong = def, wrong.cookie = 0;
    REFUSED("default", pel_study_execute(study, &wrong, NULL, &error));
    wrong = def, wrong.thread_count = -1;
    REFUSED("thread_count", pel_study_execute(study, &wrong, NULL, &error));
    wrong = def, wrong.folder = "misuse", wrong.thread_count = 1025;
    REFUSED("thread_count", pel_study_execute(study, &wrong, NULL, &error));
    wrong = def, wrong.folder = "misuse", wrong.run_seconds = -1;
    REFUSED("run_seconds", pel_study_execute(study, &wrong, NULL, &error));
    REFUSED("path", pel_fit_load(NULL, &json, &error));
    REFUSED("json", pel_fit_load("a.yaml", NULL, &error));
    SURVIVES(pel_fit_destroy(NULL));
    pel_study_destroy(study);
    assert_int_equal(misuse_failures, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_study)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
