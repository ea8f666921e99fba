/* The run driver: prepare (nothing on disk) -> open the folder -> simulate -> finish. After any failure while
   simulating, finish leaves a complete folder. */
#define _XOPEN_SOURCE 700
#include "pellicle/run.h"

#include "base/hash.h"
#include "base/memory.h"
#include "base/status.h"
#include "io/file.h"
#include "math/extremes.h"
#include "math/vec3.h"
#include "pellicle/parallel.h"
#include "pellicle/sim_adjoint.h"
#include "pellicle/sim_rigid.h"
#include "results/files.h"
#include "run/state.h"
#include "run/warnings.h"
#include "sim/sim.h"
#include "sim/snapshot.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

enum { RUN_COOKIE = 0x72756e21 };

/* softness of xpbd from which on the first step is tried before anything is written */
#define SOFTNESS_TRIED 1

/* s of wall time between states that are kept, and the share of the time that this may take */
#define KEEP_SECONDS 10
#define KEEP_SHARE 0.02

/* changes of the volume ratio below this are rounding */
#define VOLUME_NOISE 1e-12

pel_run_def pel_run_def_default(void)
{
    return (pel_run_def){.keep_seconds = KEEP_SECONDS, .cookie = RUN_COOKIE};
}

/* ---- prepare: nothing is written ---- */

static pel_status check_def(const pel_run_def *def, pel_error *error)
{
    if (def->cookie != RUN_COOKIE)
        return pel_fail(error, PEL_BAD_ARGUMENT, "run def was not made by pel_run_def_default()");
    if (def->folder != NULL && (def->folder[0] == '\0' || strlen(def->folder) >= PEL_RUN_PATH_SIZE))
        return pel_refuse(error, PEL_BAD_ARGUMENT, "name a folder for the results",
                          "the name of the output folder is empty or very long");
    if (def->max_frames < 0 || def->thread_count < 0 || !(def->keep_seconds >= 0))
        return pel_fail(error, PEL_BAD_ARGUMENT, "the number of frames, threads or seconds is below 0");
    if (def->folder == NULL && def->resume != NULL)
        return pel_fail(error, PEL_BAD_ARGUMENT, "a run without a folder cannot resume");
    if (def->beside != NULL &&
        (def->folder != NULL || def->beside->count < 0 || (def->beside->count > 0 && def->beside->scenes == NULL)))
        return pel_fail(error, PEL_BAD_ARGUMENT, "runs beside a run need their scenes, and leave no files");
    return PEL_OK;
}

/* never overwrite the run's own scene or meshes */
static pel_status check_input(const pel_run_def *def, const char *path, const char *what, pel_error *error)
{
    if (path == NULL || def->folder == NULL ||
        !pel_run_folder_takes(def->folder, path, def->resume != NULL, def->overwrite))
        return PEL_OK;
    pel_fail(error, PEL_BAD_FILE, "the run would overwrite its own %s", what);
    pel_fail_remedy(error, "choose another output folder");
    pel_fail_place(error, path, 0, 0);
    return PEL_BAD_FILE;
}

static pel_status check_inputs(const pel_scene *scene, const pel_run_def *def, pel_error *error)
{
    pel_status status = check_input(def, scene->path, "scene", error);
    for (int32_t i = 0; status == PEL_OK && i < scene->mesh_file_count; i++)
        status = check_input(def, scene->mesh_files[i], "mesh", error);
    return status;
}

static uint64_t hash_mesh(uint64_t hash, const pel_mesh *mesh)
{
    size_t vertex_count = (size_t)mesh->vertex_count;
    hash = pel_hash_bytes(hash, mesh->positions, vertex_count * sizeof *mesh->positions);
    hash = pel_hash_bytes(hash, mesh->triangles, (size_t)mesh->triangle_count * sizeof *mesh->triangles);
    for (int32_t f = 0; f < mesh->field_count; f++) {
        const pel_field *field = &mesh->fields[f];
        hash = pel_hash_bytes(hash, field->name, strlen(field->name));
        hash = pel_hash_bytes(hash, field->values, vertex_count * (size_t)field->component_count * sizeof(double));
    }
    return hash;
}

static uint64_t hash_scene(const pel_scene *scene)
{
    const char *text = pel_scene_text(scene);
    uint64_t hash = pel_hash_bytes(PEL_HASH_START, text, strlen(text));
    for (int32_t b = 0; b < scene->model.body_count; b++)
        hash = hash_mesh(hash, scene->model.bodies[b].mesh);
    for (int32_t t = 0; t < scene->sim.tool_count; t++)
        if (scene->sim.tools[t].mesh != NULL)
            hash = hash_mesh(hash, scene->sim.tools[t].mesh);
    return hash;
}

/* the state before the first step, with its energies: no run computes them again */
static void keep_at_start(pel_run_kept *kept)
{
    const unsigned readers = PEL_RUN_ENERGIES | PEL_RUN_WARNINGS;
    kept->sim->ledger->is_unread = (kept->skips & readers) == readers;
    pel_ledger_start(kept->sim);
    pel_snapshot_keep(kept->sim, kept->start);
    kept->is_at_start = true;
}

/* the state before the first step */
static pel_status keep_start(pel_run_kept *kept, pel_error *error)
{
    size_t size = pel_sim_save_size(kept->sim);
    pel_free(kept->start);
    kept->start = pel_allocate(size, 1);
    if (kept->start == NULL)
        return pel_fail_memory(error);
    keep_at_start(kept);
    return PEL_OK;
}

/* the simulation of a kept run is at its start again */
static pel_status take_kept(pel_run_state *run, const pel_sim_def *def, pel_error *error)
{
    pel_run_kept *kept = run->kept;
    pel_status status;
    if (kept->sim != NULL) {
        status = pel_run_kept_rewind(kept, error);
    } else {
        status = pel_sim_create(def, &kept->sim, error);
        if (status == PEL_OK)
            status = keep_start(kept, error);
    }
    run->sim = kept->sim;
    kept->is_at_start = false;
    return status;
}

/* model, simulation, and writer of its frames */
static pel_status create_sim(pel_run_state *run, pel_error *error)
{
    pel_run_kept *kept = run->kept;
    pel_model **model = kept != NULL ? &kept->model : &run->model;
    pel_status status = *model == NULL ? pel_model_create(&run->scene->model, model, error) : PEL_OK;
    if (status != PEL_OK)
        return status;
    run->model = *model;
    pel_sim_def def = run->scene->sim;
    def.model = run->model;
    def.wanted = run->def->wanted;
    def.user = run->def->user;
    if (run->def->thread_count > 0)
        def.thread_count = run->def->thread_count;
    run->thread_count = def.thread_count > 0 ? def.thread_count : (int32_t)pel_thread_limit();
    status = kept != NULL ? take_kept(run, &def, error) : pel_sim_create(&def, &run->sim, error);
    if (status == PEL_OK)
        run->tool_count = run->frames.tool_count = pel_sim_tool_count(run->sim);
    if (status == PEL_OK && run->scene->session_count > 0) {
        status = pel_session_create(run->scene, run->sim, &run->session, error);
        /* changes by a session are not in the states that failed frames return to */
        def.thread_count = 1;
    }
    return status == PEL_OK ? pel_run_frames_create(&run->frames, &def, run->sim, error) : status;
}

/* a volume to stop at needs one */
static pel_status check_stop(const pel_run_state *run, pel_error *error)
{
    bool any = !(run->scene->least_volume_ratio > 0);
    for (int32_t b = 0; b < pel_model_body_count(run->model); b++)
        any |= run->model->bodies[b].has_volume;
    if (any)
        return PEL_OK;
    return pel_refuse(
        error, PEL_BAD_SCENE,
        "close the mesh with `pellicle check FILE --fix OUT --fill-holes 1000`, or stop by frames or time",
        "stop.volume_ratio_below needs a volume, but each body is open, or flat at rest");
}

/* remedy for a run that xpbd makes too soft */
static void print_remedy(const pel_run_state *run, char *text, size_t size)
{
    const pel_solver_def *solver = &run->scene->sim.solver;
    pel_solver_reading reading;
    pel_sim_get_solver(run->sim, &reading);
    snprintf(text, size, "use %s >= %d, or method implicit (static for equilibria)",
             solver->substeps > 0 ? "substeps" : "max_substeps", (int)reading.needed_substeps);
}

/* A run that is far too soft is tried for one step: if it fails, the run is refused before anything is written. */
static pel_status try_step(const pel_run_state *run, pel_error *error)
{
    char remedy[200];
    if (!(pel_sim_softness(run->sim) > SOFTNESS_TRIED) || run->def->resume != NULL)
        return PEL_OK;
    size_t size = pel_sim_save_size(run->sim);
    void *bytes = pel_allocate(size, 1);
    if (bytes == NULL)
        return pel_fail_memory(error);
    pel_sim_save(run->sim, bytes);
    pel_status status = pel_sim_step(run->sim, error);
    if (status == PEL_DIVERGED) {
        print_remedy(run, remedy, sizeof remedy);
        status = PEL_BAD_SCENE;
        pel_fail(error, status, "xpbd diverges in the first step: it stretches about %.3g times as far as the material",
                 1 + pel_sim_softness(run->sim));
        pel_fail_remedy(error, "%s", remedy);
    } else {
        status = pel_sim_load(run->sim, bytes, size, error);
    }
    pel_free(bytes);
    return status;
}

/* a session changes the scene that a checkpoint is compared with */
static pel_status refuse_resume(const pel_run_state *run, pel_error *error)
{
    if (run->scene->session_count == 0 || run->def->resume == NULL)
        return PEL_OK;
    return pel_refuse(error, PEL_BAD_SCENE, "run it from its start, without --resume",
                      "a run of a scene with a session cannot be resumed");
}

static pel_status prepare(pel_run_state *run, pel_error *error)
{
    pel_status status = refuse_resume(run, error);
    if (status == PEL_OK)
        status = create_sim(run, error);
    if (status == PEL_OK)
        status = pel_run_beside_create(run, error);
    if (status == PEL_OK)
        status = check_stop(run, error);
    if (status == PEL_OK)
        status = try_step(run, error);
    if (status == PEL_OK && (run->frames.skips & PEL_RUN_WARNINGS) == 0)
        status = pel_warnings_check_scene(run, error);
    if (status != PEL_OK)
        return status;
    run->tool_force = pel_allocate(PEL_TOOL_NUMBERS * (size_t)run->tool_count, sizeof *run->tool_force);
    if (run->tool_force == NULL)
        return pel_fail_memory(error);
    if (run->def->folder != NULL) {
        run->fingerprint = hash_scene(run->scene);
        status = pel_run_checkpoint_prepare(run, error);
    }
    if (status == PEL_OK && run->def->resume != NULL)
        status = pel_run_checkpoint_read(run, run->def->resume, error);
    run->start_step = pel_sim_step_count(run->sim);
    return status;
}

static void release(pel_run_state *run)
{
    pel_run_frames_destroy(&run->frames);
    pel_run_folder_unlock(run->def->folder, run->lock);
    pel_free(run->checkpoint);
    pel_free(run->tool_force);
    pel_session_destroy(run->session);
    pel_run_beside_destroy(run);
    if (run->kept != NULL)
        return;
    pel_sim_destroy(run->sim);
    pel_model_destroy(run->model);
}

/* ---- files ---- */

pel_status pel_run_take_folder(const char *folder, bool overwrite, const pel_log *log, pel_error *error)
{
    PEL_REFUSE_NULL(folder, error);
    if (folder[0] == '\0' || strlen(folder) >= PEL_RUN_PATH_SIZE)
        return pel_fail(error, PEL_BAD_ARGUMENT, "the name of the output folder is empty or very long");
    int queue = pel_run_folder_queue(folder);
    pel_status status = pel_run_folder_claim(folder, NULL, overwrite, log, error);
    if (status == PEL_OK)
        status = pel_run_folder_open(folder, error);
    pel_run_folder_leave_queue(queue);
    return status;
}

/* for this run alone */
static pel_status lock_folder(pel_run_state *run, pel_error *error)
{
    const pel_run_def *def = run->def;
    int queue = pel_run_folder_queue(def->folder);
    pel_status status = pel_run_folder_claim(def->folder, def->resume, def->overwrite, def->log, error);
    if (status == PEL_OK)
        status = pel_run_folder_open(def->folder, error);
    if (status == PEL_OK)
        status = pel_run_folder_lock(def->folder, &run->lock, error);
    pel_run_folder_leave_queue(queue);
    return status;
}

static pel_status write_scene(const pel_run_state *run, bool finished, pel_error *error)
{
    return pel_results_write_scene(run->def->folder, pel_scene_text(run->scene), run->sim, finished, error);
}

/* about the bytes of checkpoint, final.ply, frames.pvd and summary.json */
static size_t last_files_size(const pel_run_state *run)
{
    const size_t list_entry = 100, others = 1 << 16;
    size_t mesh = 48 * (size_t)run->frames.surface.vertex_count + 16 * (size_t)run->frames.surface.triangle_count;
    int64_t listed = run->plan.frame_end < 100000 ? run->plan.frame_end : 100000;
    return run->checkpoint_size + mesh + list_entry * (size_t)listed + others;
}

static pel_status check_disk(const pel_run_state *run, pel_error *error)
{
    pel_disk_need need = pel_run_plan_need(&run->plan, run->scene, run->totals.frame_count, run->start_step);
    need.frame_bytes = pel_run_frame_bytes(&run->frames.surface, &run->scene->output);
    need.checkpoint_bytes = (double)run->checkpoint_size;
    need.may_take_less |= run->def->overwrite;
    return pel_run_check_disk(run->def->folder, &need, run->def->log, error);
}

static pel_status open_folder(pel_run_state *run, pel_error *error)
{
    const char *folder = run->def->folder;
    if (folder == NULL)
        return pel_run_frames_begin(&run->frames, run->sim, 0, false, error);
    bool resume = run->def->resume != NULL, removed = false;
    pel_status status = lock_folder(run, error);
    /* it is cut back: not a file elsewhere that a link leads to */
    char series[PEL_RUN_FILE_SIZE];
    if (status == PEL_OK && resume)
        status = pel_file_check_inside(folder, pel_run_path(series, folder, PEL_RUN_SERIES), error);
    /* the list first: it must not name removed frames */
    if (status == PEL_OK && resume)
        status = pel_run_frames_begin(&run->frames, run->sim, run->totals.frame_count, true, error);
    if (status == PEL_OK)
        status = pel_run_folder_clear(folder, run->totals.frame_count, resume, &removed, error);
    if (status == PEL_OK && removed && !resume)
        pel_log_line(run->def->log, "the folder %s held an older run, which was removed", folder);
    if (status == PEL_OK)
        status = write_scene(run, false, error);
    if (status == PEL_OK && !resume)
        status = pel_run_frames_begin(&run->frames, run->sim, 0, false, error);
    if (status == PEL_OK)
        pel_run_folder_reserve(folder, last_files_size(run));
    return status;
}

/* ---- simulate ---- */

static void note_tools(pel_run_state *run)
{
    int32_t count = run->tool_count;
    for (int32_t t = 0; t < count; t++) {
        pel_tool_reading reading;
        pel_sim_get_tool(run->sim, t, &reading);
        const double *f = reading.force;
        double force = sqrt(f[0] * f[0] + f[1] * f[1] + f[2] * f[2]);
        run->tool_force[t] = pel_max(run->tool_force[t], force);
        if (force > run->tool_force[count + t]) {
            run->tool_force[count + t] = force;
            run->tool_force[2 * count + t] = reading.contact_count;
        }
    }
}

/* false when the caller wants to stop */
static bool report(const pel_run_state *run)
{
    const pel_run_def *def = run->def;
    if (def->wanted != NULL && !def->wanted(def->user))
        return false;
    if (def->progress == NULL)
        return true;
    int64_t step = pel_sim_step_count(run->sim), end = pel_run_plan_step(&run->plan, run->plan.frame_end);
    double seconds = pel_seconds() - run->start, done = (double)(step - run->start_step);
    const pel_run_progress progress = {
        .step = step,
        .step_total = end,
        .frame = run->totals.frame_count - 1,
        .frame_total = run->plan.frame_end,
        .time = pel_sim_time(run->sim),
        .steps_per_second = seconds > 0 ? done / seconds : 0,
        .remaining = done > 0 ? (double)(end - step) * seconds / done : -1,
        .max_force = run->frames.max_force,
    };
    return def->progress(def->user, &progress);
}

/* before the first step nothing moves, even under load */
static bool is_settled(const pel_run_state *run)
{
    double speed = run->scene->rest_speed;
    return speed > 0 && pel_sim_step_count(run->sim) > 0 && pel_sim_time(run->sim) >= run->plan.settled_time &&
           pel_sim_max_speed(run->sim) <= speed;
}

/* whether bodies touch: contacts of this or an earlier step; without contact, at frames, triangles that cut each other
 */
static bool is_touching(const pel_run_state *run, bool at_frame)
{
    pel_contact_statistics statistics;
    int64_t count = 0;
    if (pel_sim_contact_thickness(run->sim) > 0) {
        pel_sim_get_contact_statistics(run->sim, &statistics);
        if (statistics.contacts > 0 || run->scene->sim.contact.self)
            return statistics.contacts > 0;
    }
    return at_frame && pel_sim_intersections(run->sim, &count, NULL) == PEL_OK && count > 0;
}

/* the rule that ends the run at the present step, null when none does; rest is looked for at frames only */
static const char *find_stop(const pel_run_state *run, bool at_frame)
{
    const pel_scene *scene = run->scene;
    if (scene->least_volume_ratio > 0 && pel_sim_volume_ratio(run->sim) < scene->least_volume_ratio)
        return "volume_ratio_below";
    if (scene->stop_at_contact && is_touching(run, at_frame))
        return "self_contact";
    if (at_frame && is_settled(run))
        return "at_rest";
    if (pel_sim_get_path_end(run->sim) == PEL_PATH_END_FULL_LOAD)
        return "full_load";
    if (pel_sim_get_path_end(run->sim) == PEL_PATH_END_LOST)
        return "path_lost";
    if (scene->frame_limit > 0 && pel_sim_step_count(run->sim) >= scene->frame_limit)
        return "frames";
    if (scene->time_limit > 0 && pel_sim_time(run->sim) >= scene->time_limit * (1 - 1e-12))
        return "time";
    return NULL;
}

/* jitter: the volume of a shell that is pressed together should fall from frame to frame */
static void note_volume(pel_run_totals *totals, double ratio)
{
    double rise = totals->frame_count > 0 ? ratio - totals->volume_ratio : 0;
    totals->volume_ratio = ratio;
    if (!(rise > VOLUME_NOISE))
        return;
    totals->rise_count++;
    totals->rise_sum += rise;
    totals->rise_max = pel_max(totals->rise_max, rise);
}

static pel_status add_frame(pel_run_state *run, pel_error *error)
{
    if ((run->frames.skips & PEL_RUN_SURFACES) == 0)
        note_volume(&run->totals, pel_sim_volume_ratio(run->sim));
    pel_run_beside_add_frame(run);
    return pel_run_frames_add(&run->frames, run->sim, &run->totals, run->tool_force, error);
}

/* until all frames are written; a failure brings the run back to the frame that could not be */
static pel_status settle_frames(pel_run_state *run, pel_error *error)
{
    return pel_run_frames_settle(&run->frames, run->sim, &run->totals, run->tool_force, error);
}

/* the frame and the checkpoint that the present step has to give; a frame may be due still when a run is resumed */
static pel_status write_due(pel_run_state *run, pel_error *error)
{
    const pel_run_plan *plan = &run->plan;
    int64_t step = pel_sim_step_count(run->sim), frame = run->totals.frame_count;
    pel_status status = pel_run_frames_failed(&run->frames) ? settle_frames(run, error) : PEL_OK;
    bool is_due = frame <= plan->frame_total && step == pel_run_plan_step(plan, frame);
    if (status == PEL_OK && is_due)
        status = add_frame(run, error);
    if (status == PEL_OK)
        run->stop_reason = find_stop(run, is_due);
    run->settled = status == PEL_OK && run->stop_reason != NULL;
    if (run->settled && !is_due)
        status = add_frame(run, error);
    if (status != PEL_OK || run->settled || run->session != NULL || plan->checkpoint_steps == 0 || step == 0 ||
        step % plan->checkpoint_steps != 0)
        return status;
    status = settle_frames(run, error);
    return status == PEL_OK ? pel_run_checkpoint_write(run, true, error) : status;
}

/* periodically: the state from which a killed run resumes */
static pel_status keep_state(pel_run_state *run, pel_error *error)
{
    if (!(run->def->keep_seconds > 0) || run->def->folder == NULL || run->session != NULL)
        return PEL_OK;
    double now = pel_seconds();
    if (now < run->keep_at)
        return PEL_OK;
    pel_status status = settle_frames(run, error);
    if (status != PEL_OK)
        return status;
    pel_error failure;
    char text[1200];
    if (pel_run_checkpoint_write(run, false, &failure) != PEL_OK)
        pel_log_line(run->def->log, "the state of step %" PRId64 " is not kept: %s", pel_sim_step_count(run->sim),
                     pel_error_text(&failure, text, sizeof text));
    double end = pel_seconds();
    run->keep_at = end + pel_max(run->def->keep_seconds, (end - now) / KEEP_SHARE);
    return PEL_OK;
}

static pel_status step(pel_run_state *run, pel_error *error)
{
    if (run->sims_beside != NULL)
        return pel_sim_step_beside(run->sim, run->sims_beside, run->def->beside->count, error);
    if (run->session == NULL)
        return pel_sim_step(run->sim, error);
    pel_status status = pel_session_repeat(run->session, error);
    return status == PEL_OK ? pel_session_step(run->session, error) : status;
}

/* one step with its output */
static pel_status advance(pel_run_state *run, pel_error *error)
{
    /* the clock takes a thirtieth of the steps of a small body, and no row of a study has times */
    bool is_timed = run->kept == NULL;
    double before = is_timed ? pel_seconds() : 0;
    pel_status status = step(run, error);
    if (status != PEL_OK)
        return status;
    double seconds = is_timed ? pel_seconds() - before : 0;
    run->totals.frame_seconds += seconds;
    run->totals.step_seconds += seconds;
    run->totals.worst_seconds = pel_max(run->totals.worst_seconds, seconds);
    note_tools(run);
    if ((run->frames.skips & PEL_RUN_WARNINGS) == 0)
        pel_warnings_check_step(run);
    status = write_due(run, error);
    return status == PEL_OK && !run->settled ? keep_state(run, error) : status;
}

static pel_status simulate(pel_run_state *run, pel_error *error)
{
    int64_t end = pel_run_plan_step(&run->plan, run->plan.frame_end);
    pel_status status = write_due(run, error);
    bool wanted = report(run);
    while (status == PEL_OK && wanted && !run->settled && pel_sim_step_count(run->sim) < end) {
        status = advance(run, error);
        wanted = status != PEL_STOPPED && (status != PEL_OK || report(run));
    }
    if (status == PEL_STOPPED)
        status = PEL_OK;
    int64_t step = pel_sim_step_count(run->sim);
    if (status == PEL_DIVERGED && strcmp(error->element_kind, "body") == 0)
        pel_scene_locate(run->scene, error);
    if (status != PEL_OK || wanted || run->settled || step >= end)
        return status;
    return pel_fail(error, PEL_STOPPED, "stopped at step %" PRId64 " of %" PRId64, step, end);
}

/* ---- finish ---- */

/* add the checkpoint to resume to the remedy of the error that ended the run */
static void name_checkpoint(const pel_run_state *run, pel_error *error)
{
    char remedy[sizeof error->remedy];
    if (run->checkpoint_path[0] == '\0')
        return;
    memcpy(remedy, error->remedy, sizeof remedy);
    pel_fail_remedy(error, "%.150s%sthe last good state, of step %" PRId64 ", is in %.120s", remedy,
                    remedy[0] != '\0' ? "; " : "", run->checkpoint_step, run->checkpoint_path);
}

static pel_status write_results(pel_run_state *run, pel_error *error)
{
    char path[PEL_RUN_FILE_SIZE];
    pel_status status = pel_run_frames_list(&run->frames, error);
    pel_run_path(path, run->def->folder, PEL_RUN_FINAL);
    if (status == PEL_OK)
        status = pel_run_surface_write_final(&run->frames.surface, run->sim, path, error);
    if (status == PEL_OK)
        status = write_scene(run, true, error);
    return status;
}

/* save the last state of a run that can resume; a completed run names requested checkpoints only */
static pel_status settle_checkpoint(pel_run_state *run, bool over, pel_error *error)
{
    if (run->session != NULL)
        return PEL_OK;
    if (!over && (run->checkpoint_path[0] == '\0' || run->checkpoint_step != pel_sim_step_count(run->sim)))
        return pel_run_checkpoint_write(run, false, error);
    if (over && run->plan.checkpoint_steps == 0)
        run->checkpoint_path[0] = '\0';
    return PEL_OK;
}

/* the state of a completed run goes once its summary is on the disk: a power failure leaves one of them */
static void drop_checkpoint(const pel_run_state *run)
{
    char path[PEL_RUN_FILE_SIZE];
    if (run->session == NULL && run->plan.checkpoint_steps == 0)
        unlink(pel_run_path(path, run->def->folder, PEL_RUN_CHECKPOINT));
}

/* Counts the triangles that intersect at the end: -1 where that is too much work, which is a warning, or would keep a
   run waiting that was asked to stop. */
static pel_status count_intersections(pel_run_state *run, bool stopped, pel_error *error)
{
    /* flat sheets take up to 5 us a triangle */
    enum { QUICK_TRIANGLES = 20000 };
    run->intersection_count = -1;
    if (run->def->skip_intersections || (stopped && run->frames.surface.triangle_count > QUICK_TRIANGLES))
        return PEL_OK;
    int64_t count;
    pel_status status = pel_run_surface_intersections(&run->frames.surface, run->sim, &count, error);
    if (status == PEL_OK)
        run->intersection_count = count;
    return status;
}

/* the final numbers are those of the last frame if it shows the end */
static void measure_end(pel_run_state *run)
{
    if (run->frames.measured_step == pel_sim_step_count(run->sim)) {
        run->measures = run->frames.frame.row.measures;
        run->ledger = run->frames.frame.row.ledger;
        return;
    }
    pel_run_measure(run->sim, run->frames.skips, &run->measures, &run->ledger);
}

/* if status is a failure, error holds its cause; a later failure does not replace an earlier one, and a failed frame
   counts as the earliest */
static pel_status finish(pel_run_state *run, pel_status status, pel_run_summary *summary, pel_error *error)
{
    pel_status later = settle_frames(run, error);
    status = later != PEL_OK ? later : status;
    bool has_folder = run->def->folder != NULL;
    if (has_folder)
        pel_run_folder_release(run->def->folder);
    measure_end(run);
    later = has_folder ? write_results(run, status == PEL_OK ? error : NULL) : PEL_OK;
    status = status == PEL_OK ? later : status;
    later = count_intersections(run, status == PEL_STOPPED, status == PEL_OK ? error : NULL);
    bool uncounted = later == PEL_BAD_MESH;
    status = status == PEL_OK && !uncounted ? later : status;
    bool over = run->settled || pel_sim_step_count(run->sim) >= run->plan.step_total;
    bool is_done = status == PEL_OK && over;
    later = has_folder ? settle_checkpoint(run, is_done, status == PEL_OK ? error : NULL) : PEL_OK;
    status = status == PEL_OK ? later : status;
    if (status != PEL_OK)
        name_checkpoint(run, error);
    if (uncounted)
        pel_warn(&run->totals.warnings, PEL_WARN_UNCOUNTED, run->totals.frame_count - 1, 0);
    if (over && status == PEL_OK && (run->frames.skips & PEL_RUN_WARNINGS) == 0)
        pel_warnings_check_end(run);
    pel_run_summary_fill(run, status, summary);
    pel_warnings_tell(run, true);
    later = has_folder
                ? pel_run_summary_write(run, summary, status != PEL_OK ? error : NULL, status == PEL_OK ? error : NULL)
                : PEL_OK;
    if (status == PEL_OK && later == PEL_OK && has_folder && is_done)
        drop_checkpoint(run);
    if (status == PEL_OK && later != PEL_OK)
        summary->status = "failed";
    return status == PEL_OK ? later : status;
}

/* bodies that the first lines of a run name */
enum { MOST_NAMED = 8 };

/* of what a scene asks for */
#define SAME_SPEED 1e-3

/* A rigid body starts as its pins and joints let it. */
static void tell_start_speed(const pel_run_state *run, int32_t b)
{
    const pel_body_def *body = &run->scene->model.bodies[b];
    const double *asked = body->velocity, *turn = body->angular_velocity;
    pel_rigid_reading now;
    double apart[3], turned[3];
    if (pel_sim_step_count(run->sim) > 0 || !pel_sim_get_rigid(run->sim, b, &now))
        return;
    pel_vec3_subtract(now.velocity, asked, apart);
    pel_vec3_subtract(now.spin, turn, turned);
    if (pel_vec3_squared_length(apart) > SAME_SPEED * SAME_SPEED * pel_vec3_squared_length(asked) ||
        pel_vec3_squared_length(turned) > SAME_SPEED * SAME_SPEED * pel_vec3_squared_length(turn))
        pel_log_line(run->def->log,
                     "body '%s' starts as its pins and joints let it: its center of mass at %.3g m/s and turning at "
                     "%.3g rad/s, in place of %.3g and %.3g. give the velocity of the center too to turn about a joint",
                     body->name, pel_vec3_length(now.velocity), pel_vec3_length(now.spin), pel_vec3_length(asked),
                     pel_vec3_length(turn));
}

/* what a scene leaves to defaults and the numbers of a run depend on: laws and contact thickness */
static void tell_start(const pel_run_state *run)
{
    const pel_model_def *model = &run->scene->model;
    double common = pel_sim_contact_thickness(run->sim);
    for (int32_t b = 0; b < model->body_count && b < MOST_NAMED; b++) {
        const pel_membrane_def *membrane = &model->bodies[b].shell.membrane;
        char contact[PEL_NAME_SIZE + 128] = "";
        if (common > 0)
            pel_contacts_describe_thickness(run->sim, b, contact, sizeof contact);
        if (membrane->on || common > 0)
            pel_log_line(run->def->log, "body '%s': %s%s%s", model->bodies[b].name,
                         membrane->on ? pel_membrane_kind_name(membrane->kind) : "",
                         membrane->on && common > 0 ? ", " : "", contact);
        tell_start_speed(run, b);
    }
    if (model->body_count > MOST_NAMED)
        pel_log_line(run->def->log, "%d further bodies: see scene.yaml and summary.json",
                     (int)(model->body_count - MOST_NAMED));
}

pel_status pel_run_with(const pel_scene *scene, const pel_run_def *def, pel_run_kept *kept, pel_run_summary *summary,
                        pel_error *error)
{
    pel_error own;
    pel_error *cause = error != NULL ? error : &own;
    *summary = (pel_run_summary){.status = ""};
    pel_status status = check_def(def, cause);
    if (status == PEL_OK)
        status = check_inputs(scene, def, cause);
    if (status != PEL_OK)
        return status;
    pel_run_state run = {.scene = scene, .def = def, .kept = kept, .start = pel_seconds(), .lock = -1};
    run.keep_at = run.start + def->keep_seconds;
    run.plan = pel_run_plan_make(scene, def->max_frames);
    if (def->folder == NULL)
        run.plan.checkpoint_steps = 0;
    run.frames =
        (pel_run_frames){.scene = scene, .folder = def->folder, .plan = &run.plan, .row = def->row, .user = def->user};
    run.frames.has_surface = def->folder != NULL || !def->skip_intersections;
    run.frames.skips = kept != NULL ? kept->skips : 0;
    status = prepare(&run, cause);
    if (status != PEL_OK && status != PEL_OUT_OF_MEMORY)
        pel_scene_locate(scene, cause);
    if (status == PEL_OK && def->folder != NULL)
        status = check_disk(&run, cause);
    if (status == PEL_OK)
        status = open_folder(&run, cause);
    if (status == PEL_OK)
        pel_warnings_tell(&run, false);
    if (status == PEL_OK)
        tell_start(&run);
    if (status == PEL_OK)
        status = finish(&run, simulate(&run, cause), summary, cause);
    if (status == PEL_OK)
        pel_run_beside_end(&run);
    release(&run);
    return status;
}

pel_status pel_run(const pel_scene *scene, const pel_run_def *def, pel_run_summary *summary, pel_error *error)
{
    PEL_REFUSE_NULL(scene, error);
    PEL_REFUSE_NULL(def, error);
    PEL_REFUSE_NULL(summary, error);
    return pel_run_with(scene, def, NULL, summary, error);
}

/* ---- runs that share a simulation ---- */

pel_status pel_run_kept_rewind(pel_run_kept *kept, pel_error *error)
{
    if (kept->is_at_start)
        return PEL_OK;
    pel_status status = pel_snapshot_rewind(kept->sim, kept->start, error);
    kept->is_at_start = status == PEL_OK;
    return status;
}

bool pel_run_kept_refill(pel_run_kept *kept, const pel_run_number *numbers, int32_t count, bool with_model)
{
    if (kept->sim == NULL || pel_run_kept_rewind(kept, NULL) != PEL_OK)
        return false;
    for (int32_t i = 0; i < count; i++)
        if (!pel_parameter_write(&kept->model->def, &kept->sim->def, numbers[i].place, numbers[i].text))
            return false;
    if ((with_model && !pel_model_refill(kept->model)) || !pel_sim_refill(kept->sim, with_model))
        return false;
    if (with_model)
        keep_at_start(kept);
    return true;
}

void pel_run_kept_drop(pel_run_kept *kept, bool with_model)
{
    pel_sim_destroy(kept->sim);
    kept->sim = NULL;
    if (!with_model)
        return;
    pel_model_destroy(kept->model);
    pel_free(kept->start);
    *kept = (pel_run_kept){0};
}
