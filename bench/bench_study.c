/* What a run of a study costs beside its steps: runs that share with the one before what their numbers allow, runs that
   share nothing, and the steps alone, in turns.
   usage: bench_study [scene, scenes/sphere-press.yaml by default [steps, 100 by default [rounds, 500 by default]]] */
#include "bench.h"
#include "study/kept.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { KINDS = 3, TEXT = 100000 };

/* `rounds` values of a key, in lines of a study */
static pel_study *make_study(const char *scene, int steps, const char *key, const char *form, int rounds)
{
    static char text[TEXT];
    pel_error error;
    pel_study *study;
    int length = snprintf(text, sizeof text, "scene: %s\nvary:\n  duration: [%g]\n  output.every_frame: [%d]\n  %s: [",
                          scene, 0.01 * steps, steps, key);
    for (int i = 0; i < rounds && length < TEXT - 100; i++) {
        length += snprintf(text + length, TEXT - (size_t)length, "%s", i > 0 ? ", " : "");
        length += snprintf(text + length, TEXT - (size_t)length, form, 1 + i / (double)rounds);
    }
    snprintf(text + length, TEXT - (size_t)length, "]\nmeasure: [max_displacement]\n");
    bench_check(pel_study_parse("study.yaml", text, strlen(text), &study, &error), &error);
    return study;
}

static pel_sim *make_sim(const pel_study *study, pel_scene **scene, pel_model **model)
{
    pel_error error;
    pel_sim *sim;
    bench_check(pel_study_scene(study, 0, scene, &error), &error);
    bench_check(pel_model_create(&(*scene)->model, model, &error), &error);
    pel_sim_def def = (*scene)->sim;
    def.model = *model;
    def.thread_count = 1;
    bench_check(pel_sim_create(&def, &sim, &error), &error);
    return sim;
}

static double time_steps(pel_sim *sim, const void *start, size_t size, int steps)
{
    pel_error error;
    bench_check(pel_sim_load(sim, start, size, &error), &error);
    double begin = pel_thread_seconds();
    for (int i = 0; i < steps; i++)
        bench_check(pel_sim_step(sim, &error), &error);
    return pel_thread_seconds() - begin;
}

static void measure(const char *scene_path, int steps, const char *key, const char *form, int rounds)
{
    pel_error error;
    pel_scene *scene;
    pel_model *model;
    pel_study *study = make_study(scene_path, steps, key, form, rounds);
    int64_t count = pel_study_run_count(study);
    pel_sim *sim = make_sim(study, &scene, &model);
    size_t size = pel_sim_save_size(sim);
    void *start = bench_allocate(1, size);
    pel_sim_save(sim, start);
    char *row = bench_allocate(1, pel_study_row_size(study));
    double *times[KINDS];
    for (int k = 0; k < KINDS; k++)
        times[k] = bench_allocate((size_t)count, sizeof *times[k]);
    pel_study_kept kept = {0};
    for (int64_t run = 0; run < count; run++) {
        times[0][run] = time_steps(sim, start, size, steps);
        double begin = pel_thread_seconds();
        bench_check(pel_study_run_kept(study, &kept, run, row, &error), &error);
        double between = pel_thread_seconds();
        bench_check(pel_study_run(study, run, NULL, NULL, NULL, row, &error), &error);
        times[1][run] = between - begin;
        times[2][run] = pel_thread_seconds() - between;
    }
    bench_spread s[KINDS];
    for (int k = 0; k < KINDS; k++)
        s[k] = bench_spread_of(times[k], (int)count);
    printf("%-30s least: steps %.4f ms  run %.4f ms (%.3f)  alone %.4f ms;  median: %.4f %.4f (%.3f) %.4f\n", key,
           1e3 * s[0].least, 1e3 * s[1].least, s[1].least / s[0].least, 1e3 * s[2].least, 1e3 * s[0].median,
           1e3 * s[1].median, s[1].median / s[0].median, 1e3 * s[2].median);
    for (int k = 0; k < KINDS; k++)
        free(times[k]);
    free(start);
    free(row);
    pel_study_kept_drop(&kept);
    pel_sim_destroy(sim);
    pel_model_destroy(model);
    pel_scene_destroy(scene);
    pel_study_destroy(study);
}

int main(int argc, char **argv)
{
    const char *scene = argc > 1 ? argv[1] : "scenes/sphere-press.yaml";
    int steps = argc > 2 ? atoi(argv[2]) : 100, rounds = argc > 3 ? atoi(argv[3]) : 500;
    printf("processor time of %d steps, of a run after others and of a run alone, least and median of %d\n", steps,
           rounds);
    measure(scene, steps, "loads.finger.force", "[0, 0, -%g]", rounds);
    measure(scene, steps, "solver.alpha", "%g", rounds);
    measure(scene, steps, "bodies.ball.springs.stiffness", "%g", rounds);
    return 0;
}
