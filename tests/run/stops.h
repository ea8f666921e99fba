/* Runs that are stopped in the middle and continued: every column of the series, the summary with its warnings, all
   frames and the state hash are those of a run that was not stopped. */
#ifndef PEL_TESTS_RUN_STOPS_H
#define PEL_TESTS_RUN_STOPS_H

#define _XOPEN_SOURCE 700 /* nftw */
#include "run/run_fixture.h"

enum { LONG_STOPS = 4 };

/* steps at which a run of so many is stopped, one or LONG_STOPS */
static inline int64_t stop_of(int64_t step_count, int number)
{
    return 1 + step_count * (number + 1) / (LONG(LONG_STOPS, 1) + 1);
}

static inline void check_stops(const pel_scene *scene, const char *name, int64_t max_frames)
{
    char whole_folder[64], part_folder[64];
    snprintf(whole_folder, sizeof whole_folder, "%s", name);
    snprintf(part_folder, sizeof part_folder, "%s-part", name);
    run_case whole = {.run = whole_folder, .max_frames = max_frames, .threads = 1};
    check_run(scene, &whole, PEL_OK);
    for (int i = 0; i < LONG(LONG_STOPS, 1); i++) {
        int64_t stop = stop_of(whole.summary.steps, i);
        if (stop >= whole.summary.steps)
            continue;
        run_case part = {.run = part_folder, .max_frames = max_frames, .threads = 2, .stop_at = stop};
        check_run(scene, &part, PEL_STOPPED);
        part.stop_at = 0;
        part.resume = "checkpoint";
        check_run(scene, &part, PEL_OK);
        if (part.summary.state_hash != whole.summary.state_hash)
            print_error("%s stopped at step %d ends in another state\n", name, (int)stop);
        assert_true(part.summary.state_hash == whole.summary.state_hash);
        check_same_results(whole_folder, part_folder, whole.summary.frames);
        char path[256];
        remove_folder(in_folder(path, part_folder, ""));
    }
}

#endif
