/* The small files of a run's folder, each written as a whole. */
#ifndef PEL_RESULTS_FILES_H
#define PEL_RESULTS_FILES_H

#include "pellicle/frames.h"
#include "results/tool_surface.h"

#include <stddef.h>

/* scene.yaml: the resolved scene, the program's version, the contact thickness of each body and, when the run is
   finished, the hash of the state. PEL_BAD_FILE, PEL_OUT_OF_MEMORY. */
pel_status pel_results_write_scene(const char *folder, const char *text, const pel_sim *sim, bool finished,
                                   pel_error *error);

/* frames.pvd: frames 0 .. count - 1 with their times (count) [s], and the files of tools that are there. The same
   errors. */
pel_status pel_results_write_list(const char *folder, const double *times, size_t count, const pel_tool_surfaces *tools,
                                  pel_error *error);

#endif
