#include "base/number.h"
#include "base/status.h"
#include "io/file.h"
#include "scene/build.h"
#include "scene/run_state.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
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
        .wall_s = totals->wall_seconds + pel_run_clock() - run->start,
        .steps_per_second = totals->step_seconds > 0 ? (double)steps / totals->step_seconds : 0,
        .volume_ratio_final = run->measures.volume_ratio,
        .area_ratio_final = run->measures.area_ratio,
        .max_displacement = fmax(totals->max_displacement, run->measures.max_displacement),
        .residual_displacement = run->measures.max_displacement,
        .vertices_final = run->measures.vertex_count,
        .triangles_final = run->measures.triangle_count,
        .self_intersections_final = run->intersection_count,
        .state_hash = pel_sim_hash(sim),
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
    for (int32_t t = 0; t < pel_sim_tool_count(sim); t++)
        summary->max_tool_force = fmax(summary->max_tool_force, run->tool_force[pel_sim_tool_count(sim) + t]);
    memcpy(summary->checkpoint, run->checkpoint_path, sizeof summary->checkpoint);
}

/* ---- JSON ---- */

static void write_text(pel_file_writer *writer, const char *text)
{
    char letter[7];
    pel_file_writer_write(writer, "\"", 1);
    while (*text != '\0') {
        text = pel_json_letter(text, letter);
        pel_file_writer_write(writer, letter, strlen(letter));
    }
    pel_file_writer_write(writer, "\"", 1);
}

static void begin(pel_file_writer *writer, const char *key)
{
    pel_file_writer_printf(writer, ",\n  \"%s\": ", key);
}

static void text_entry(pel_file_writer *writer, const char *key, const char *text)
{
    begin(writer, key);
    if (text[0] != '\0')
        write_text(writer, text);
    else
        pel_file_writer_printf(writer, "null");
}

static void write_number(pel_file_writer *writer, double value)
{
    char text[PEL_NUMBER_SIZE];
    pel_number_print(text, value);
    pel_file_writer_printf(writer, "%s", isfinite(value) ? text : "null");
}

static void number_entry(pel_file_writer *writer, const char *key, double value)
{
    begin(writer, key);
    write_number(writer, value);
}

static void count_entry(pel_file_writer *writer, const char *key, int64_t value)
{
    begin(writer, key);
    pel_file_writer_printf(writer, "%" PRId64, value);
}

static void write_event(pel_file_writer *writer, const char *count_key, int64_t count, const char *time_key,
                        double time)
{
    pel_file_writer_printf(writer, ", \"%s\": %" PRId64 ", \"%s\": ", count_key, count, time_key);
    write_number(writer, count > 0 ? time : (double)NAN);
}

static void write_tool_states(pel_file_writer *writer, const pel_sim *sim, int32_t tool)
{
    pel_tool_reading reading;
    pel_sim_get_tool(sim, tool, &reading);
    pel_file_writer_printf(writer, ", \"held\": %d", (int)reading.held_count);
    write_event(writer, "lost", reading.lost_count, "lost_time", reading.lost_time);
    write_event(writer, "held_back_steps", reading.held_back_count, "held_back_time", reading.held_back_time);
}

static void write_tools(pel_file_writer *writer, const pel_run_state *run)
{
    int32_t count = pel_sim_tool_count(run->sim);
    begin(writer, "tools");
    pel_file_writer_printf(writer, "[");
    for (int32_t t = 0; t < count; t++) {
        pel_file_writer_printf(writer, "%s{\"name\": ", t > 0 ? ", " : "");
        write_text(writer, pel_sim_tool_name(run->sim, t));
        pel_file_writer_printf(writer, ", \"max_force\": ");
        write_number(writer, run->tool_force[count + t]);
        write_tool_states(writer, run->sim, t);
        pel_file_writer_printf(writer, "}");
    }
    pel_file_writer_printf(writer, "]");
}

static void write_contact(pel_file_writer *writer, const pel_sim *sim)
{
    pel_contact_statistics s;
    pel_sim_get_contact_statistics(sim, &s);
    const struct {
        const char *name;
        int64_t count;
    } counts[] = {{"candidates", s.candidates},   {"passed_filter", s.passed_filter},
                  {"passed_hull", s.passed_hull}, {"cubics", s.cubics},
                  {"pairs", s.contacts},          {"dropped", s.dropped},
                  {"rounds", s.rounds},           {"fall_backs", s.fall_backs},
                  {"tools_held", s.tools_held},   {"tangled", s.tangled}};
    begin(writer, "contact");
    pel_file_writer_printf(writer, "{\"thickness\": ");
    write_number(writer, pel_sim_contact_thickness(sim));
    for (size_t i = 0; i < sizeof counts / sizeof counts[0]; i++)
        pel_file_writer_printf(writer, ", \"%s\": %" PRId64, counts[i].name, counts[i].count);
    pel_file_writer_printf(writer, ", \"cubics_saved\": ");
    write_number(writer, s.candidates > 0 ? 1 - (double)s.cubics / (double)s.candidates : 1);
    pel_file_writer_printf(writer, ", \"find_s\": ");
    write_number(writer, s.find_seconds);
    pel_file_writer_printf(writer, ", \"solve_s\": ");
    write_number(writer, s.solve_seconds);
    pel_file_writer_printf(writer, ", \"guard_s\": ");
    write_number(writer, s.guard_seconds);
    pel_file_writer_printf(writer, "}");
}

static void write_solver(pel_file_writer *writer, const pel_run_state *run, const pel_run_summary *s)
{
    pel_method method = run->scene->sim.solver.method;
    text_entry(writer, "method", pel_scene_method_name(method));
    if (method == PEL_METHOD_DESCENT) {
        count_entry(writer, "solver_iterations", s->solver.iterations);
        number_entry(writer, "solver_residual", s->solver.residual);
        begin(writer, "solver_converged");
        pel_file_writer_printf(writer, s->solver.converged ? "true" : "false");
        count_entry(writer, "solver_unconverged_steps", s->unconverged_steps);
    }
    if (s->solver.substeps == 0)
        return;
    count_entry(writer, "substeps_min", s->solver.least_substeps);
    count_entry(writer, "substeps_max", s->solver.most_substeps);
    if (method != PEL_METHOD_XPBD)
        return;
    count_entry(writer, "substeps_needed", s->solver.needed_substeps);
    begin(writer, "second_order");
    pel_file_writer_printf(writer, s->solver.second_order ? "true" : "false");
    number_entry(writer, "softness_max", s->solver.most_softness);
}

static void write_ledger(pel_file_writer *writer, const pel_sim_ledger *ledger)
{
    const struct {
        const char *name;
        double value;
    } entries[] = {{"elastic_start", ledger->elastic_start},
                   {"kinetic_start", ledger->kinetic_start},
                   {"elastic", ledger->elastic},
                   {"kinetic", ledger->kinetic},
                   {"work_tools", ledger->work_tools},
                   {"work_loads", ledger->work_loads},
                   {"work_pressure", ledger->work_pressure},
                   {"work_gravity", ledger->work_gravity},
                   {"work_material", ledger->work_material},
                   {"dissipated_drag", ledger->dissipated_drag},
                   {"dissipated_solver", ledger->dissipated_solver},
                   {"energy_error", ledger->energy_error},
                   {"supplied", ledger->supplied}};
    begin(writer, "energy");
    for (size_t i = 0; i < sizeof entries / sizeof entries[0]; i++) {
        pel_file_writer_printf(writer, "%s\"%s\": ", i == 0 ? "{" : ", ", entries[i].name);
        write_number(writer, entries[i].value);
    }
    pel_file_writer_printf(writer, "}");
}

static void write_warnings(pel_file_writer *writer, const pel_run_summary *summary)
{
    begin(writer, "warnings");
    pel_file_writer_printf(writer, "[");
    for (int32_t i = 0; i < summary->warning_count; i++) {
        const pel_run_warning *warning = &summary->warnings[i];
        pel_file_writer_printf(
            writer, "%s\n    {\"code\": \"%s\", \"first_frame\": %" PRId64 ", \"count\": %" PRId64 ", \"text\": ",
            i > 0 ? "," : "", warning->code, warning->first_frame, warning->count);
        write_text(writer, warning->text);
        pel_file_writer_printf(writer, "}");
    }
    pel_file_writer_printf(writer, summary->warning_count > 0 ? "\n  ]" : "]");
}

static void write_entries(pel_file_writer *writer, const pel_run_state *run, const pel_run_summary *s)
{
    count_entry(writer, "frames", s->frames);
    count_entry(writer, "steps", s->steps);
    number_entry(writer, "time_simulated", s->time_simulated);
    number_entry(writer, "wall_s", s->wall_s);
    number_entry(writer, "steps_per_second", s->steps_per_second);
    number_entry(writer, "volume_ratio_final", s->volume_ratio_final);
    number_entry(writer, "area_ratio_final", s->area_ratio_final);
    number_entry(writer, "max_displacement", s->max_displacement);
    number_entry(writer, "residual_displacement", s->residual_displacement);
    count_entry(writer, "vertices_final", s->vertices_final);
    count_entry(writer, "triangles_final", s->triangles_final);
    if (s->self_intersections_final >= 0) {
        count_entry(writer, "self_intersections_final", s->self_intersections_final);
    } else {
        begin(writer, "self_intersections_final");
        pel_file_writer_printf(writer, "null");
    }
    begin(writer, "state_hash");
    pel_file_writer_printf(writer, "\"%016" PRIx64 "\"", s->state_hash);
    number_entry(writer, "alpha", s->alpha);
    number_entry(writer, "alpha_limit", s->alpha_limit);
    count_entry(writer, "threads", s->threads);
    number_entry(writer, "max_tool_force", s->max_tool_force);
    write_tools(writer, run);
    write_solver(writer, run, s);
    if (pel_sim_contact_thickness(run->sim) > 0)
        write_contact(writer, run->sim);
    write_ledger(writer, &s->ledger);
    write_warnings(writer, s);
    text_entry(writer, "stop_reason", s->stop_reason);
    count_entry(writer, "volume_rises", s->volume_rises);
    number_entry(writer, "volume_rise_sum", s->volume_rise_sum);
    number_entry(writer, "volume_rise_max", s->volume_rise_max);
    text_entry(writer, "checkpoint", s->checkpoint);
    text_entry(writer, "scene", run->scene->path);
    text_entry(writer, "version", PEL_VERSION);
}

pel_status pel_run_summary_write(const pel_run_state *run, const pel_run_summary *summary, const pel_error *cause,
                                 pel_error *error)
{
    pel_file_writer writer;
    char path[PEL_RUN_FILE_SIZE], text[1200];
    pel_status status = pel_file_writer_open(&writer, pel_run_path(path, run->def->folder, PEL_RUN_SUMMARY), error);
    if (status != PEL_OK)
        return status;
    pel_file_writer_printf(&writer, "{\n  \"status\": \"%s\"", summary->status);
    write_entries(&writer, run, summary);
    text_entry(&writer, "error", cause != NULL ? pel_error_text(cause, text, sizeof text) : "");
    pel_file_writer_printf(&writer, "\n}\n");
    return pel_file_writer_commit(&writer, error);
}
