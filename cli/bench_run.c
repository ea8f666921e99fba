/* Cost of frames: whole runs of a sphere of 20,480 triangles that write a frame every 10 steps or every step, compared
   with runs that write only the first and the last state. */
#include "bench.h"

#include <pellicle/frames.h>
#include <pellicle/run.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char scene_text[] = "version: 1\n"
                                 "bodies:\n"
                                 "  - { name: ball, mesh: { shape: geodesic-sphere, frequency: 32 },\n"
                                 "      mass: { per_vertex: 1 }, springs: { stiffness: 3, damping: 0.5 },\n"
                                 "      volumetric: { stiffness: 1.5, damping: 0.5 } }\n"
                                 "loads:\n"
                                 "  - { body: ball, force: [0, 0, -1], at: { nearest: [0, 0, 1] } }\n"
                                 "solver: { dt: 0.0016666666666666667 }\n"
                                 "duration: 1\n";

typedef struct writing {
    char folder[32];
    pel_scene *with, *without;      /* frames */
    double with_best, without_best; /* s */
    int run_count, frame_count;
} writing;

static pel_status load(const char *every, const char *duration, pel_scene **scene, pel_error *error)
{
    const char *const settings[2] = {every, duration};
    return pel_scene_parse("bench", scene_text, strlen(scene_text), settings, 2, NULL, scene, error);
}

static pel_status begin(void **inner, const char *every, const char *duration, pel_error *error)
{
    writing *w = calloc(1, sizeof *w);
    *inner = w;
    if (w == NULL)
        return pel_fail_memory(error);
    w->with_best = w->without_best = HUGE_VAL;
    snprintf(w->folder, sizeof w->folder, "/tmp/pellicle-bench-XXXXXX");
    if (mkdtemp(w->folder) == NULL) {
        w->folder[0] = '\0';
        *error = (pel_error){.status = PEL_BAD_FILE, .element = -1, .byte_offset = -1};
        snprintf(error->what, sizeof error->what, "no temporary folder can be made in /tmp");
        return PEL_BAD_FILE;
    }
    pel_status status = load(every, duration, &w->with, error);
    return status == PEL_OK ? load("output.every_frame=1000000", duration, &w->without, error) : status;
}

static pel_status begin_tenth(void **inner, pel_error *error)
{
    return begin(inner, "output.every_frame=10", "duration=1", error);
}

static pel_status begin_every(void **inner, pel_error *error)
{
    return begin(inner, "output.every_frame=1", "duration=0.3333", error);
}

static const char *run_folder(const writing *w, int number, char path[64])
{
    snprintf(path, 64, "%s/run%d", w->folder, number);
    return path;
}

/* the files of every run; at the end, because a file system may be slow where files have just been removed */
static void remove_runs(const writing *w)
{
    char run[64], path[128];
    for (int n = 0; n < w->run_count; ++n) {
        pel_frames *frames;
        run_folder(w, n, run);
        if (pel_frames_open(run, &frames, NULL) == PEL_OK)
            for (int32_t f = 0; f < frames->frame_count; ++f)
                remove(frames->paths[f]);
        pel_frames_close(frames);
        for (int file = 0; file < PEL_RUN_FILE_COUNT; ++file) {
            snprintf(path, sizeof path, "%s/%s", run, pel_run_file_name((pel_run_file)file));
            remove(path);
        }
        snprintf(path, sizeof path, "%s/frames", run);
        rmdir(path);
        rmdir(run);
    }
}

static pel_status run(writing *w, const pel_scene *scene, double *best, pel_error *error)
{
    char path[64];
    pel_run_def def = pel_run_def_default();
    pel_run_summary summary;
    def.folder = run_folder(w, w->run_count++, path);
    def.overwrite = true;
    double start = pel_seconds();
    pel_status status = pel_run(scene, &def, &summary, error);
    *best = fmin(*best, pel_seconds() - start);
    w->frame_count = summary.frames > w->frame_count ? (int)summary.frames : w->frame_count;
    return status;
}

/* one after the other, so that both meet the same machine */
static pel_status once(void *inner, pel_error *error)
{
    writing *w = inner;
    pel_status status = run(w, w->without, &w->without_best, error);
    return status == PEL_OK ? run(w, w->with, &w->with_best, error) : status;
}

static pel_status finish(void *inner, cli_bench_result *result, pel_error *error)
{
    (void)error;
    const writing *w = inner;
    cli_bench_add(result, "frames", "", w->frame_count);
    cli_bench_add(result, "with_frames_ms", "ms", 1e3 * w->with_best);
    cli_bench_add(result, "without_frames_ms", "ms", 1e3 * w->without_best);
    cli_bench_add(result, "ratio", "times", w->with_best / w->without_best);
    return PEL_OK;
}

static void end(void *inner)
{
    writing *w = inner;
    if (w == NULL)
        return;
    remove_runs(w);
    if (w->folder[0] != '\0')
        rmdir(w->folder);
    pel_scene_destroy(w->with);
    pel_scene_destroy(w->without);
    free(w);
}

const cli_bench_case cli_bench_frames = {
    .name = "frames",
    .doc = "a run of 20,480 triangles, 600 steps, with a frame every 10 steps (60 a second) and without",
    .repeats = 7,
    .begin = begin_tenth,
    .once = once,
    .finish = finish,
    .end = end,
};

const cli_bench_case cli_bench_frames_all = {
    .name = "frames-all",
    .doc = "the same, 200 steps with a frame every step",
    .repeats = 5,
    .begin = begin_every,
    .once = once,
    .finish = finish,
    .end = end,
};
