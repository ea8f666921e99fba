/* Assignment of frames and runs to pages. */
#ifndef PELLICLE_VIEW_FRAME_SELECTION_H
#define PELLICLE_VIEW_FRAME_SELECTION_H

#include "view/run.h"

#include "pellicle/render.h"

typedef struct view_shot {
    int32_t run, frame, field;
} view_shot;

typedef enum view_output { VIEW_FOLDER, VIEW_PICTURE, VIEW_FILM } view_output;

typedef struct view_frame_selection {
    view_shot *shots; /* (page_count x cell_count) page by page; run -1 = the cell stays empty */
    int32_t page_count, cell_count;
    int32_t columns, rows; /* of a page */
} view_frame_selection;

view_output view_output_kind(const char *output);

/* Lays out the frames that the def asks for, each once for every one of field_count fields. Errors: PEL_BAD_ARGUMENT (a
   frame that does not exist, too many for the sheet), PEL_OUT_OF_MEMORY; shots are empty then. */
pel_status view_frame_selection_create(view_frame_selection *shots, const pel_render_def *def, int32_t field_count,
                                       const view_run *runs, pel_error *error);
void view_frame_selection_destroy(view_frame_selection *shots);

#endif
