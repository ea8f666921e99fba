/* The tools of a run as separate surfaces: a file for each tool and frame, which frames.pvd lists as a further part of
   the frame. */
#ifndef PEL_RESULTS_TOOL_SURFACE_H
#define PEL_RESULTS_TOOL_SURFACE_H

#include "pellicle/results.h"
#include "pellicle/scene.h"

typedef struct pel_tool_surface pel_tool_surface;

/* Numbers of tools are their places in the list: tools stay in it once they were there, under their names. */
typedef struct pel_tool_surfaces {
    pel_tool_surface *list; /* (count) */
    size_t capacity;
    int32_t count;
    double time; /* s, of the last reading */
} pel_tool_surfaces;

/* Destroys a zero or filled surface. */
void pel_tool_surfaces_destroy(pel_tool_surfaces *surfaces);

/* Puts a tool of an earlier part of the run into the list. PEL_OUT_OF_MEMORY. */
pel_status pel_tool_surfaces_know(pel_tool_surfaces *surfaces, const char *name, pel_error *error);

/* Takes shapes and poses out of the simulation; it may go on before they are written. Supports have no surface.
   PEL_OUT_OF_MEMORY. */
pel_status pel_tool_surfaces_read(pel_tool_surfaces *surfaces, const pel_sim *sim, pel_error *error);
/* Writes the last reading as the files of a frame; removes them after a failure. */
pel_status pel_tool_surfaces_write(const pel_tool_surfaces *surfaces, const pel_output_def *output, const char *folder,
                                   int64_t frame, pel_error *error);
/* Removes the files of a frame. */
void pel_tool_surfaces_remove(const pel_tool_surfaces *surfaces, const char *folder, int64_t frame);

const char *pel_tool_surface_name(const pel_tool_surfaces *surfaces, int32_t tool);

#endif
