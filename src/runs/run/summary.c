#include "results/summary.h"
#include "def/row.h"
#include "math/extremes.h"
#include "pellicle/sim_reading.h"
#include "run/state.h"
#include "run/warnings.h"
#include "scene/build.h"
#include "stage/stepper.h"

#include <math.h>
#include <string.h>

static const char *status_word(pel_status status)
{
    switch (status) {
    case PEL_OK:
        return "done";
    case PEL_STOPPED:
        return "stopped";
    case PEL_DIVERGED:
        return "diverged";
    default:
        return "failed";
    }
}

static const char *stop_reason(const pel_run_state *run, pel_status status)
{
    if (status != PEL_OK)
        return "";
    if (run->stop_reason != NULL)
        return run->stop_reason;
    return pel_sim_step_count(run->sim) >= run->plan.step_total ? "duration" : "max_frames";
}

void pel_run_summary_fill(const pel_run_state *run, pel_status status, pel_run_summary *summary)
{
    const pel_sim *sim = run->sim;
    const pel_run_totals *totals = &run->totals;
    int64_t steps = pel_sim_step_count(sim);
    *summary = (pel_run_summary){
        .status = status_word(status),
        .frames = totals->frame_count,
        .steps = steps,
        .time_simulated = pel_sim_time(sim),
        .wall_s = totals->wall_seconds + pel_seconds() - run->start,
        .steps_per_second = totals->step_seconds > 0 ? (double)steps / totals->step_seconds : 0,
        .worst_step_ms = 1e3 * totals->worst_seconds,
        .volume_final = run->measures.volume,
        .volume_ratio_final = run->measures.volume_ratio,
        .area_ratio_final = run->measures.area_ratio,
        .max_displacement = pel_run_max_displacement(run),
        .residual_displacement = run->measures.max_displacement,
        .vertices_final = run->measures.vertex_count,
        .triangles_final = run->measures.triangle_count,
        .self_intersections_final = run->intersection_count,
        .state_hash = (run->frames.skips & PEL_RUN_HASH) == 0 ? pel_sim_hash(sim) : 0,
        .alpha = pel_sim_alpha(sim),
        .alpha_limit = pel_sim_alpha_limit(sim),
        .threads = run->thread_count,
        .stop_reason = stop_reason(run, status),
        .volume_rises = totals->rise_count,
        .volume_rise_sum = totals->rise_sum,
        .volume_rise_max = totals->rise_max,
        .unconverged_steps = totals->warnings.of[PEL_WARN_UNCONVERGED].count,
        .ledger = run->ledger,
    };
    summary->warning_count = pel_warnings_list(run, summary->warnings);
    pel_sim_get_solver(sim, &summary->solver);
    summary->mode_count = pel_sim_get_modes(sim, summary->modes);
    summary->max_tool_force = pel_run_max_tool_force(run);
    memcpy(summary->checkpoint, run->checkpoint_path, sizeof summary->checkpoint);
}

pel_status pel_run_summary_write(const pel_run_state *run, const pel_run_summary *summary, const pel_error *cause,
                                 pel_error *error)
{
    const pel_method method = run->scene->sim.solver.method;
    const pel_run_ending ending = {
        .folder = run->def->folder,
        .scene_path = run->scene->path,
        .method = method,
        .method_name = pel_method_words[method],
        .summary = summary,
        .sim = run->sim,
        .tool_count = run->tool_count,
        .tool_force = run->tool_force + run->tool_count,
        .cause = cause,
    };
    return pel_results_write_summary(&ending, error);
}
