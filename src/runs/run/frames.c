#include "run/frames.h"

#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "math/extremes.h"
#include "math/vec3.h"
#include "observe/observe.h"
#include "pellicle/parallel.h"
#include "results/files.h"
#include "stage/stepper.h"

#include <math.h>
#include <stdatomic.h>
#include <string.h>
#include <unistd.h>

/* rewrite frames.pvd when the number of frames has grown by this share, or after this many seconds: its cost stays
   small compared to the frames */
#define LIST_GROWTH 0.125
#define LIST_SECONDS 2.0

/* ---- the files ---- */

pel_status pel_run_frames_list(pel_run_frames *frames, pel_error *error)
{
    if (frames->listed_count == frames->frame_count || frames->folder == NULL)
        return PEL_OK;
    size_t count = (size_t)frames->frame_count;
    double *times = pel_allocate(count, sizeof *times);
    if (times == NULL)
        return pel_fail_memory(error);
    for (size_t i = 0; i < count; i++) {
        /* a rule may end the run between two frames of the plan */
        bool is_last = i + 1 == count && frames->last_time > 0;
        times[i] = is_last ? frames->last_time : pel_run_plan_time(frames->plan, (int64_t)i);
    }
    pel_status status = pel_results_write_list(frames->folder, times, count, &frames->tools, error);
    pel_free(times);
    if (status == PEL_OUT_OF_MEMORY)
        return status;
    frames->listed_count = frames->frame_count;
    frames->listed_at = pel_seconds();
    return status;
}

static bool list_is_due(const pel_run_frames *frames)
{
    double unlisted = (double)(frames->frame_count - frames->listed_count);
    return unlisted > LIST_GROWTH * (double)frames->listed_count || pel_seconds() - frames->listed_at > LIST_SECONDS;
}

void pel_run_measure(pel_sim *sim, unsigned skips, pel_sim_measures *measures, pel_sim_ledger *ledger)
{
    bool has_energies = (skips & PEL_RUN_ENERGIES) == 0;
    pel_sim_measure_parts(sim, (skips & PEL_RUN_SURFACES) == 0, has_energies, measures);
    if (has_energies)
        pel_sim_get_ledger(sim, ledger);
    else
        *ledger = (pel_sim_ledger){0};
}

/* ---- a frame: taken from the simulation, then written ---- */

/* all that a frame says of the present state; nothing of the simulation is needed any more to write it */
static pel_status take_frame(pel_run_frames *frames, pel_sim *sim, const pel_run_totals *totals,
                             const double *tool_force, pel_error *error)
{
    pel_run_frame *frame = &frames->frame;
    int64_t steps = pel_sim_step_count(sim) - totals->frame_step;
    pel_run_row *row = &frame->row;
    frame->time = pel_sim_time(sim);
    frame->pressing = 0;
    for (int32_t t = 0; t < frames->tool_count; t++) {
        pel_tool_reading reading;
        pel_sim_get_tool(sim, t, &reading);
        if (pel_vec3_length(reading.force) > 0)
            frame->pressing = pel_max(frame->pressing, tool_force[frames->tool_count + t]);
    }
    *row = (pel_run_row){
        .frame = totals->frame_count,
        .step_ms = steps > 0 ? 1e3 * totals->frame_seconds / (double)steps : 0,
        .tool_force_max = tool_force,
        .contact_before = totals->contact,
    };
    pel_run_measure(sim, frames->skips, &row->measures, &row->ledger);
    pel_sim_get_contact_statistics(sim, &row->contact);
    frames->measured_step = pel_sim_step_count(sim);
    if (frames->folder != NULL || frames->row != NULL)
        pel_run_series_make(&frames->series, sim, row);
    if (frames->folder == NULL)
        return PEL_OK;
    pel_status status = pel_run_surface_read(&frames->surface, sim, error);
    return status == PEL_OK ? pel_tool_surfaces_read(&frames->tools, sim, error) : status;
}

static void give_row(const pel_run_frames *frames)
{
    if (frames->row != NULL)
        frames->row(frames->user, frames->series.line);
}

/* the files of the frame and its row */
static pel_status write_files(pel_run_frames *frames, pel_error *error)
{
    char path[PEL_RUN_FILE_SIZE];
    const pel_output_def *output = &frames->scene->output;
    int64_t frame = frames->frame.row.frame;
    pel_run_frame_path(path, frames->folder, frame);
    pel_status status = pel_tool_surfaces_write(&frames->tools, output, frames->folder, frame, error);
    if (status != PEL_OK)
        return status;
    status = pel_run_surface_write(&frames->surface, output, path, error);
    if (status == PEL_OK) {
        status = pel_run_series_add(&frames->series, error);
        if (status != PEL_OK)
            unlink(path);
    }
    if (status != PEL_OK)
        pel_tool_surfaces_remove(&frames->tools, frames->folder, frame);
    return status;
}

/* quasi-static frames are equilibria only where the body had the time to come to rest */
static void check_rest(pel_run_frames *frames)
{
    const pel_run_row *row = &frames->frame.row;
    if (pel_stepper_of(frames->scene->sim.solver.method)->relaxes)
        pel_warnings_check_frame_rest(&frames->warnings, row->frame, &row->measures, frames->frame.pressing);
}

static pel_status write_frame(pel_run_frames *frames, pel_error *error)
{
    const pel_run_row *row = &frames->frame.row;
    give_row(frames);
    pel_status status = frames->folder != NULL ? write_files(frames, error) : PEL_OK;
    if (status != PEL_OK)
        return status;
    frames->frame_count = row->frame + 1;
    frames->last_time = frames->frame.time;
    frames->max_displacement = pel_max(frames->max_displacement, row->measures.max_displacement);
    frames->unbalanced_force = pel_max(frames->unbalanced_force, row->measures.unbalanced_force);
    if ((frames->skips & PEL_RUN_WARNINGS) == 0) {
        pel_warnings_check_frame(&frames->warnings, row->frame, &row->measures, &row->ledger);
        check_rest(frames);
    }
    atomic_store(&frames->max_force, row->measures.max_force);
    return list_is_due(frames) ? pel_run_frames_list(frames, error) : PEL_OK;
}

/* ---- the thread that writes ---- */

/* after a failure nothing more is written */
static void write_job(void *context, int32_t slot)
{
    (void)slot;
    pel_run_frames *frames = context;
    if (!atomic_load(&frames->failed) && write_frame(frames, &frames->error) != PEL_OK)
        atomic_store(&frames->failed, true);
}

/* room for the present state; false when out of memory */
static bool expect_state(pel_run_frames *frames, const pel_sim *sim)
{
    frames->snapshot_size = pel_sim_save_size(sim);
    return pel_reserve((void **)&frames->frame.snapshot, &frames->snapshot_room, frames->snapshot_size, 1);
}

static pel_status start_thread(pel_run_frames *frames, const pel_sim *sim, pel_error *error)
{
    pel_run_frame *frame = &frames->frame;
    frame->tool_force = pel_allocate(PEL_TOOL_NUMBERS * (size_t)frames->tool_count, sizeof *frame->tool_force);
    if (frame->tool_force == NULL || !expect_state(frames, sim))
        return pel_fail_memory(error);
    return pel_worker_create(1, write_job, frames, &frames->worker, error);
}

/* ---- the caller's side ---- */

/* no surface and no tool since the frame before; pins that move take no energy */
static bool touched_nothing(const pel_run_frames *frames, const double *tool_force)
{
    const pel_run_row *row = &frames->frame.row;
    bool is_free = row->contact.contacts == row->contact_before.contacts;
    for (int32_t t = 0; t < frames->tool_count; t++)
        is_free &= !(tool_force[t] > 0) || frames->scene->sim.tools[t].shape == PEL_TOOL_SUPPORT;
    return is_free;
}

/* reset the sums since the last frame */
static void begin_interval(const pel_run_frames *frames, pel_run_totals *totals, const pel_sim *sim, double *tool_force)
{
    const int32_t tool_count = frames->tool_count;
    const double loss = frames->frame.row.ledger.dissipated_solver;
    const bool is_free = touched_nothing(frames, tool_force);
    totals->free_loss += is_free ? loss - totals->loss : 0;
    totals->bounce_loss += is_free ? totals->touch_loss : 0;
    totals->touch_loss = is_free ? 0 : totals->touch_loss + loss - totals->loss;
    totals->loss = loss;
    totals->most_kinetic = pel_max(totals->most_kinetic, frames->frame.row.ledger.kinetic);
    totals->frame_count++;
    totals->frame_step = pel_sim_step_count(sim);
    totals->frame_seconds = 0;
    pel_sim_get_contact_statistics(sim, &totals->contact);
    memset(tool_force, 0, (size_t)tool_count * sizeof *tool_force);
}

pel_status pel_run_frames_create(pel_run_frames *frames, const pel_sim_def *sim_def, const pel_sim *sim,
                                 pel_error *error)
{
    frames->measured_step = -1;
    pel_status status =
        frames->has_surface ? pel_run_surface_create(sim, &frames->scene->output, &frames->surface, error) : PEL_OK;
    int32_t threads = sim_def->thread_count > 0 ? sim_def->thread_count : (int32_t)pel_thread_limit();
    return status == PEL_OK && threads > 1 ? start_thread(frames, sim, error) : status;
}

void pel_run_frames_destroy(pel_run_frames *frames)
{
    pel_worker_destroy(frames->worker);
    pel_free(frames->frame.snapshot);
    pel_free(frames->frame.tool_force);
    pel_run_series_close(&frames->series);
    pel_tool_surfaces_destroy(&frames->tools);
    pel_run_surface_destroy(&frames->surface);
}

/* tools keep their numbers of the existing frames */
static pel_status know_tools(pel_run_frames *frames, pel_error *error)
{
    pel_frames *there = NULL;
    pel_status status = pel_frames_open(frames->folder, &there, NULL);
    /* rebuild a missing or damaged list */
    if (status != PEL_OK)
        return status == PEL_OUT_OF_MEMORY ? pel_fail_memory(error) : PEL_OK;
    for (int32_t i = 0; status == PEL_OK && i < there->tool_count; i++)
        status = pel_tool_surfaces_know(&frames->tools, there->tool_names[i], error);
    pel_frames_close(there);
    return status;
}

pel_status pel_run_frames_begin(pel_run_frames *frames, const pel_sim *sim, int64_t frame_count, bool resume,
                                pel_error *error)
{
    frames->frame_count = frame_count;
    if (frames->folder != NULL)
        pel_run_path(frames->series_path, frames->folder, PEL_RUN_SERIES);
    if (!resume) {
        const char *path = frames->folder != NULL ? frames->series_path : NULL;
        pel_status status = pel_run_series_create(&frames->series, path, sim, error);
        if (status == PEL_OK)
            give_row(frames);
        return status;
    }
    pel_status status = pel_run_series_resume(&frames->series, frames->series_path, sim, frame_count, error);
    frames->listed_count = -1;
    if (status == PEL_OK)
        status = know_tools(frames, error);
    return status == PEL_OK ? pel_run_frames_list(frames, error) : status;
}

/* state that the run returns to if it cannot be written */
static void keep_state(pel_run_frames *frames, const pel_sim *sim, const pel_run_totals *totals,
                       const double *tool_force)
{
    frames->frame.totals = *totals;
    memcpy(frames->frame.tool_force, tool_force, PEL_TOOL_NUMBERS * (size_t)frames->tool_count * sizeof *tool_force);
    pel_sim_save(sim, frames->frame.snapshot);
}

pel_status pel_run_frames_add(pel_run_frames *frames, pel_sim *sim, pel_run_totals *totals, double *tool_force,
                              pel_error *error)
{
    /* until the frame before is written */
    if (frames->worker != NULL)
        (void)pel_worker_claim(frames->worker);
    if (pel_run_frames_failed(frames))
        return pel_run_frames_settle(frames, sim, totals, tool_force, error);
    pel_status status = take_frame(frames, sim, totals, tool_force, error);
    if (status != PEL_OK)
        return status;
    if (frames->worker != NULL) {
        if (!expect_state(frames, sim))
            return pel_fail_memory(error);
        keep_state(frames, sim, totals, tool_force);
        pel_worker_give(frames->worker);
        begin_interval(frames, totals, sim, tool_force);
        return PEL_OK;
    }
    status = write_frame(frames, error);
    if (frames->frame_count > totals->frame_count)
        begin_interval(frames, totals, sim, tool_force);
    return status;
}

bool pel_run_frames_failed(const pel_run_frames *frames)
{
    return atomic_load(&frames->failed);
}

pel_status pel_run_frames_settle(pel_run_frames *frames, pel_sim *sim, pel_run_totals *totals, double *tool_force,
                                 pel_error *error)
{
    if (frames->worker != NULL)
        pel_worker_wait(frames->worker);
    pel_status status = PEL_OK;
    if (pel_run_frames_failed(frames)) {
        const pel_run_frame *frame = &frames->frame;
        *error = frames->error;
        status = error->status;
        pel_sim_load(sim, frame->snapshot, frames->snapshot_size, NULL);
        *totals = frame->totals;
        memcpy(tool_force, frame->tool_force, PEL_TOOL_NUMBERS * (size_t)frames->tool_count * sizeof *tool_force);
        /* the frame may be there and only the list not */
        if (frames->frame_count > totals->frame_count)
            begin_interval(frames, totals, sim, tool_force);
    }
    totals->max_displacement = pel_max(totals->max_displacement, frames->max_displacement);
    totals->unbalanced_force = pel_max(totals->unbalanced_force, frames->unbalanced_force);
    /* after a failure reset the totals and add the counts before the failure again */
    pel_warning_tallies counted = frames->warnings;
    pel_warnings_merge(&totals->warnings, &counted);
    if (status == PEL_OK)
        frames->warnings = counted;
    return status;
}
