#include "view/frame_selection.h"

#include "view/support.h"

#include <math.h>
#include <stdlib.h>

enum { MOST_CELLS = 144, TURNTABLE_PICTURES = 72 };

view_output view_output_kind(const char *output)
{
    return view_ends_with(output, ".png")                                     ? VIEW_PICTURE
           : view_ends_with(output, ".mp4") || view_ends_with(output, ".gif") ? VIEW_FILM
                                                                              : VIEW_FOLDER;
}

void view_frame_selection_destroy(view_frame_selection *shots)
{
    free(shots->shots);
    *shots = (view_frame_selection){0};
}

/* the frames of one run */
typedef struct frame_list {
    int32_t *frames; /* (count); null = all */
    int32_t count;
} frame_list;

static bool resolve(int32_t *number, int32_t frame_count)
{
    *number += *number < 0 ? frame_count : 0;
    return *number >= 0 && *number < frame_count;
}

static pel_status fail_frame(const view_run *run, int32_t number, pel_error *error)
{
    int32_t count = view_run_frame_count(run);
    pel_fail(error, PEL_BAD_ARGUMENT, "there is no frame %d", (int)number);
    pel_fail_place(error, run->path, 0, 0);
    if (count > 1)
        pel_fail_remedy(error, "the frames are 0 to %d; -1 is the last", (int)count - 1);
    else
        pel_fail_remedy(error, "there is one frame; leave the option out");
    return PEL_BAD_ARGUMENT;
}

/* all frames of the ranges, one after the other; list null only counts them */
static pel_status walk_ranges(const view_run *run, const pel_frame_range *ranges, int32_t range_count, int32_t *list,
                              int32_t *count, pel_error *error)
{
    int32_t frame_count = view_run_frame_count(run);
    *count = 0;
    for (int32_t r = 0; r < range_count; ++r) {
        int32_t first = ranges[r].first, last = ranges[r].last, step = ranges[r].step;
        if (!resolve(&first, frame_count))
            return fail_frame(run, ranges[r].first, error);
        if (!resolve(&last, frame_count))
            return fail_frame(run, ranges[r].last, error);
        if (last < first || step < 1 || *count > INT32_MAX / 2) {
            pel_fail(error, PEL_BAD_ARGUMENT, "there is no frame from %d to %d with steps of %d", (int)first, (int)last,
                     (int)step);
            pel_fail_place(error, run->path, 0, 0);
            pel_fail_remedy(error, "write FIRST:LAST:STEP with FIRST before LAST and a step from 1");
            return PEL_BAD_ARGUMENT;
        }
        for (int64_t frame = first; frame <= last; frame += step) {
            if (list != NULL)
                list[*count] = (int32_t)frame;
            ++*count;
        }
    }
    return PEL_OK;
}

/* one frame per cell of a run and field on the sheet, evenly spaced from the first to the last */
static pel_status spread_frames(frame_list *list, const view_run *run, const pel_render_def *def, int32_t field_count,
                                pel_error *error)
{
    int32_t cells = def->columns * def->rows / (def->input_count * field_count);
    int32_t frame_count = view_run_frame_count(run);
    int32_t count = cells < frame_count ? cells : frame_count;
    list->count = count > 1 ? count : 1;
    list->frames = view_allocate((size_t)list->count, sizeof *list->frames);
    if (list->frames == NULL)
        return pel_fail_memory(error);
    list->frames[0] = list->count > 1 ? 0 : run->peak;
    for (int32_t i = 1; i < list->count; ++i)
        list->frames[i] = (int32_t)lround((double)i * (frame_count - 1) / (list->count - 1));
    return PEL_OK;
}

static pel_status list_frames(frame_list *list, const view_run *run, const pel_render_def *def, int32_t field_count,
                              pel_error *error)
{
    const pel_frame_range peak = {run->peak, run->peak, 1}, all = {0, -1, 1};
    const pel_frame_range *ranges = def->frames;
    int32_t range_count = def->frame_range_count;
    bool is_picture = view_output_kind(def->output) == VIEW_PICTURE;
    if (range_count == 0 && is_picture && def->columns > 0)
        return spread_frames(list, run, def, field_count, error);
    if (range_count == 0) {
        ranges = is_picture ? &peak : &all;
        range_count = 1;
    }
    pel_status status = walk_ranges(run, ranges, range_count, NULL, &list->count, error);
    if (status != PEL_OK)
        return status;
    list->frames = view_allocate((size_t)list->count, sizeof *list->frames);
    if (list->frames == NULL)
        return pel_fail_memory(error);
    return walk_ranges(run, ranges, range_count, list->frames, &list->count, error);
}

/* columns and rows of a page with that many cells in rows of `wide` */
static pel_status choose_layout(view_frame_selection *shots, const pel_render_def *def, int32_t used, int32_t wide,
                                pel_error *error)
{
    if (used > MOST_CELLS || (def->columns > 0 && (int64_t)used > (int64_t)def->columns * def->rows)) {
        pel_fail(error, PEL_BAD_ARGUMENT, "%d pictures do not fit on the sheet", (int)used);
        pel_fail_remedy(error, "choose fewer frames, or a sheet of more columns and rows (at most %d in all)",
                        MOST_CELLS);
        return PEL_BAD_ARGUMENT;
    }
    shots->columns = def->columns > 0 ? def->columns : wide;
    shots->rows = def->columns > 0 ? def->rows : (used + wide - 1) / wide;
    shots->cell_count = shots->columns * shots->rows;
    shots->shots = view_allocate((size_t)shots->page_count * (size_t)shots->cell_count, sizeof *shots->shots);
    if (shots->shots == NULL)
        return pel_fail_memory(error);
    for (size_t i = 0; i < (size_t)shots->page_count * (size_t)shots->cell_count; ++i)
        shots->shots[i].run = -1;
    return PEL_OK;
}

/* one page with all frames: a row for each run and field by default */
static pel_status fill_sheet(view_frame_selection *shots, const pel_render_def *def, int32_t field_count,
                             const frame_list *lists, pel_error *error)
{
    int64_t used = 0;
    int32_t longest = 0, sequence_count = def->input_count * field_count;
    for (int32_t r = 0; r < def->input_count; ++r) {
        used += (int64_t)lists[r].count * field_count;
        longest = lists[r].count > longest ? lists[r].count : longest;
    }
    bool in_rows = sequence_count > 1 && longest > 1 && def->columns == 0;
    int64_t cells = in_rows ? (int64_t)longest * sequence_count : used;
    int32_t wide = in_rows ? longest : used <= 4 ? (int32_t)used : (int32_t)ceil(sqrt(1.4 * (double)used));
    shots->page_count = 1;
    pel_status status = choose_layout(shots, def, cells > INT32_MAX ? INT32_MAX : (int32_t)cells, wide, error);
    int32_t cell = 0;
    for (int32_t s = 0; status == PEL_OK && s < sequence_count; ++s) {
        const frame_list *list = &lists[s / field_count];
        for (int32_t i = 0; i < list->count; ++i)
            shots->shots[cell++] = (view_shot){s / field_count, list->frames[i], s % field_count};
        cell += in_rows ? longest - list->count : 0;
    }
    return status;
}

/* one page per frame with all runs and fields side by side; a shorter run stays at its last frame */
static pel_status fill_pages(view_frame_selection *shots, const pel_render_def *def, int32_t field_count,
                             const frame_list *lists, pel_error *error)
{
    for (int32_t r = 0; r < def->input_count; ++r)
        shots->page_count = lists[r].count > shots->page_count ? lists[r].count : shots->page_count;
    /* turntables show a still body from all sides */
    if (def->turn != 0 && shots->page_count == 1)
        shots->page_count = TURNTABLE_PICTURES;
    int32_t used = def->input_count * field_count;
    pel_status status = choose_layout(shots, def, used, used <= 3 ? used : (int32_t)ceil(sqrt(used)), error);
    for (int32_t p = 0; status == PEL_OK && p < shots->page_count; ++p) {
        for (int32_t s = 0; s < used; ++s) {
            const frame_list *list = &lists[s / field_count];
            shots->shots[(size_t)p * (size_t)shots->cell_count + (size_t)s] =
                (view_shot){s / field_count, list->frames[p < list->count ? p : list->count - 1], s % field_count};
        }
    }
    return status;
}

pel_status view_frame_selection_create(view_frame_selection *shots, const pel_render_def *def, int32_t field_count,
                                       const view_run *runs, pel_error *error)
{
    *shots = (view_frame_selection){0};
    frame_list *lists = view_allocate((size_t)def->input_count, sizeof *lists);
    pel_status status = lists != NULL ? PEL_OK : pel_fail_memory(error);
    for (int32_t r = 0; status == PEL_OK && r < def->input_count; ++r)
        status = list_frames(&lists[r], &runs[r], def, field_count, error);
    if (status == PEL_OK && view_output_kind(def->output) == VIEW_PICTURE)
        status = fill_sheet(shots, def, field_count, lists, error);
    else if (status == PEL_OK)
        status = fill_pages(shots, def, field_count, lists, error);
    for (int32_t r = 0; lists != NULL && r < def->input_count; ++r)
        free(lists[r].frames);
    free(lists);
    if (status != PEL_OK)
        view_frame_selection_destroy(shots);
    return status;
}
