#include "results/summary.h"

#include "base/number.h"
#include "base/status.h"
#include "io/file.h"
#include "results/folder.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

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

static void write_tools(pel_file_writer *writer, const pel_run_ending *ending)
{
    const pel_sim *sim = ending->sim;
    begin(writer, "tools");
    pel_file_writer_printf(writer, "[");
    for (int32_t t = 0; t < ending->tool_count; t++) {
        pel_file_writer_printf(writer, "%s{\"name\": ", t > 0 ? ", " : "");
        write_text(writer, pel_sim_tool_name(sim, t));
        pel_file_writer_printf(writer, ", \"max_force\": ");
        write_number(writer, ending->tool_force[t]);
        write_tool_states(writer, sim, t);
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

static void write_solver(pel_file_writer *writer, const pel_run_ending *ending)
{
    const pel_run_summary *s = ending->summary;
    pel_method method = ending->method;
    text_entry(writer, "method", ending->method_name);
    if (s->solver.solves) {
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

/* frequencies or load factors of an analysis */
static void write_modes(pel_file_writer *writer, const pel_run_ending *ending)
{
    static const char *const keys[] = {NULL, "frequencies", "load_factors"};
    pel_analysis analysis = pel_sim_analysis(ending->sim);
    if (analysis == PEL_ANALYSIS_NONE)
        return;
    begin(writer, keys[analysis]);
    pel_file_writer_printf(writer, "[");
    for (int32_t m = 0; m < ending->summary->mode_count; m++) {
        pel_file_writer_printf(writer, m > 0 ? ", " : "");
        write_number(writer, ending->summary->modes[m]);
    }
    pel_file_writer_printf(writer, "]");
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

static void write_entries(pel_file_writer *writer, const pel_run_ending *ending)
{
    const pel_run_summary *s = ending->summary;
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
    write_tools(writer, ending);
    write_solver(writer, ending);
    write_modes(writer, ending);
    if (pel_sim_contact_thickness(ending->sim) > 0)
        write_contact(writer, ending->sim);
    write_ledger(writer, &s->ledger);
    write_warnings(writer, s);
    text_entry(writer, "stop_reason", s->stop_reason);
    count_entry(writer, "volume_rises", s->volume_rises);
    number_entry(writer, "volume_rise_sum", s->volume_rise_sum);
    number_entry(writer, "volume_rise_max", s->volume_rise_max);
    text_entry(writer, "checkpoint", s->checkpoint);
    text_entry(writer, "scene", ending->scene_path);
    text_entry(writer, "version", PEL_VERSION);
}

pel_status pel_results_write_summary(const pel_run_ending *ending, pel_error *error)
{
    pel_file_writer writer;
    char path[PEL_RUN_FILE_SIZE], text[1200];
    pel_status status = pel_file_writer_open(&writer, pel_run_path(path, ending->folder, PEL_RUN_SUMMARY), error);
    if (status != PEL_OK)
        return status;
    pel_file_writer_printf(&writer, "{\n  \"status\": \"%s\"", ending->summary->status);
    write_entries(&writer, ending);
    text_entry(&writer, "error", ending->cause != NULL ? pel_error_text(ending->cause, text, sizeof text) : "");
    pel_file_writer_printf(&writer, "\n}\n");
    return pel_file_writer_commit(&writer, error);
}
