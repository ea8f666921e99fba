/* A small run folder, opened, for tests of exports. */
#ifndef TESTS_EXPORT_FOLDER_H
#define TESTS_EXPORT_FOLDER_H

#include "pellicle/frames.h"
#include "results/run_folder.h"

static char folder[FOLDER_SIZE];
static pel_frames *frames;

static int set_up(void **unused)
{
    (void)unused;
    strcpy(folder, "export_XXXXXX");
    folder_make(folder);
    return pel_frames_open(folder, &frames, NULL) != PEL_OK;
}

static int tear_down(void **unused)
{
    (void)unused;
    pel_frames_close(frames);
    folder_remove(folder);
    return 0;
}

#endif
