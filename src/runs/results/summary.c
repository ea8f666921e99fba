#include "results/summary.h"

#include "base/status.h"
#include "io/file.h"
#include "io/json.h"
#include "results/folder.h"
#include "stage/stepper.h"

#include <inttypes.h>
#include <math.h>

static void begin(pel_json *json, const char *key)
{
    pel_json_print(json, ",\n  \"%s\": ", key);
}

static void text_entry(pel_json *json, const char *key, const char *text)
{
    begin(json, key);
    if (text[0] != '\0')
        pel_json_string(json, text);
    else
        pel_json_print(json, "null");
}

static void number_entry(pel_json *json, const char *key, double value)
{
    begin(json, key);
    pel_json_number(json, value);
}

static void count_entry(pel_json *json, const char *key, int64_t value)
{
    begin(json, key);
    pel_json_print(json, "%" PRId64, value);
}

static void write_event(pel_json *json, const char *count_key, int64_t count, const char *time_key, double time)
{
    pel_json_print(json, ", \"%s\": %" PRId64 ", \"%s\": ", count_key, count, time_key);
    pel_json_number(json, count > 0 ? time : (double)NAN);
}

static void write_tool_states(pel_json *json, const pel_sim *sim, int32_t tool)
{
    pel_tool_reading reading;
    pel_sim_get_tool(sim, tool, &reading);
    pel_json_print(json, ", \"held\": %d", (int)reading.held_count);
    write_event(json, "lost", reading.lost_count, "lost_time", reading.lost_time);
    write_event(json, "held_back_steps", reading.held_back_count, "held_back_time", reading.held_back_time);
}

static void write_tools(pel_json *json, const pel_run_ending *ending)
{
    const pel_sim *sim = ending->sim;
    begin(json, "tools");
    pel_json_print(json, "[");
    for (int32_t t = 0; t < ending->tool_count; t++) {
        pel_json_print(json, "%s{\"name\": ", t > 0 ? ", " : "");
        pel_json_string(json, pel_sim_tool_name(sim, t));
        pel_json_print(json, ", \"max_force\": ");
        pel_json_number(json, ending->tool_force[t]);
        write_tool_states(json, sim, t);
        pel_json_print(json, "}");
    }
    pel_json_print(json, "]");
}

static void write_contact(pel_json *json, const pel_sim *sim)
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
    begin(json, "contact");
    pel_json_print(json, "{\"thickness\": ");
    pel_json_number(json, pel_sim_contact_thickness(sim));
    for (size_t i = 0; i < sizeof counts / sizeof counts[0]; i++)
        pel_json_print(json, ", \"%s\": %" PRId64, counts[i].name, counts[i].count);
    pel_json_print(json, ", \"cubics_saved\": ");
    pel_json_number(json, s.candidates > 0 ? 1 - (double)s.cubics / (double)s.candidates : 1);
    pel_json_print(json, ", \"find_s\": ");
    pel_json_number(json, s.find_seconds);
    pel_json_print(json, ", \"solve_s\": ");
    pel_json_number(json, s.solve_seconds);
    pel_json_print(json, ", \"guard_s\": ");
    pel_json_number(json, s.guard_seconds);
    pel_json_print(json, "}");
}

static void write_solver(pel_json *json, const pel_run_ending *ending)
{
    const pel_run_summary *s = ending->summary;
    pel_method method = ending->method;
    text_entry(json, "method", ending->method_name);
    if (s->solver.solves) {
        count_entry(json, "solver_iterations", s->solver.iterations);
        number_entry(json, "solver_residual", s->solver.residual);
        begin(json, "solver_converged");
        pel_json_print(json, s->solver.converged ? "true" : "false");
        count_entry(json, "solver_unconverged_steps", s->unconverged_steps);
    }
    if (s->solver.substeps == 0)
        return;
    count_entry(json, "substeps_min", s->solver.least_substeps);
    count_entry(json, "substeps_max", s->solver.most_substeps);
    if (!pel_stepper_of(method)->is_compliant)
        return;
    count_entry(json, "substeps_needed", s->solver.needed_substeps);
    begin(json, "second_order");
    pel_json_print(json, s->solver.second_order ? "true" : "false");
    number_entry(json, "softness_max", s->solver.most_softness);
}

/* frequencies or load factors of an analysis */
static void write_modes(pel_json *json, const pel_run_ending *ending)
{
    static const char *const keys[] = {NULL, "frequencies", "load_factors"};
    pel_analysis analysis = pel_sim_analysis(ending->sim);
    if (analysis == PEL_ANALYSIS_NONE)
        return;
    begin(json, keys[analysis]);
    pel_json_print(json, "[");
    for (int32_t m = 0; m < ending->summary->mode_count; m++) {
        pel_json_print(json, m > 0 ? ", " : "");
        pel_json_number(json, ending->summary->modes[m]);
    }
    pel_json_print(json, "]");
}

static void write_ledger(pel_json *json, const pel_sim_ledger *ledger)
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
    begin(json, "energy");
    for (size_t i = 0; i < sizeof entries / sizeof entries[0]; i++) {
        pel_json_print(json, "%s\"%s\": ", i == 0 ? "{" : ", ", entries[i].name);
        pel_json_number(json, entries[i].value);
    }
    pel_json_print(json, "}");
}

static void write_warnings(pel_json *json, const pel_run_summary *summary)
{
    begin(json, "warnings");
    pel_json_print(json, "[");
    for (int32_t i = 0; i < summary->warning_count; i++) {
        const pel_run_warning *warning = &summary->warnings[i];
        pel_json_print(json,
                       "%s\n    {\"code\": \"%s\", \"first_frame\": %" PRId64 ", \"count\": %" PRId64 ", \"text\": ",
                       i > 0 ? "," : "", warning->code, warning->first_frame, warning->count);
        pel_json_string(json, warning->text);
        pel_json_print(json, "}");
    }
    pel_json_print(json, summary->warning_count > 0 ? "\n  ]" : "]");
}

static void write_entries(pel_json *json, const pel_run_ending *ending)
{
    const pel_run_summary *s = ending->summary;
    count_entry(json, "frames", s->frames);
    count_entry(json, "steps", s->steps);
    number_entry(json, "time_simulated", s->time_simulated);
    number_entry(json, "wall_s", s->wall_s);
    number_entry(json, "steps_per_second", s->steps_per_second);
    number_entry(json, "volume_ratio_final", s->volume_ratio_final);
    number_entry(json, "area_ratio_final", s->area_ratio_final);
    number_entry(json, "max_displacement", s->max_displacement);
    number_entry(json, "residual_displacement", s->residual_displacement);
    count_entry(json, "vertices_final", s->vertices_final);
    count_entry(json, "triangles_final", s->triangles_final);
    if (s->self_intersections_final >= 0) {
        count_entry(json, "self_intersections_final", s->self_intersections_final);
    } else {
        begin(json, "self_intersections_final");
        pel_json_print(json, "null");
    }
    begin(json, "state_hash");
    pel_json_print(json, "\"%016" PRIx64 "\"", s->state_hash);
    number_entry(json, "alpha", s->alpha);
    number_entry(json, "alpha_limit", s->alpha_limit);
    count_entry(json, "threads", s->threads);
    number_entry(json, "max_tool_force", s->max_tool_force);
    write_tools(json, ending);
    write_solver(json, ending);
    write_modes(json, ending);
    if (pel_sim_contact_thickness(ending->sim) > 0)
        write_contact(json, ending->sim);
    write_ledger(json, &s->ledger);
    write_warnings(json, s);
    text_entry(json, "stop_reason", s->stop_reason);
    count_entry(json, "volume_rises", s->volume_rises);
    number_entry(json, "volume_rise_sum", s->volume_rise_sum);
    number_entry(json, "volume_rise_max", s->volume_rise_max);
    text_entry(json, "checkpoint", s->checkpoint);
    text_entry(json, "scene", ending->scene_path);
    text_entry(json, "version", PEL_VERSION);
}

pel_status pel_results_write_summary(const pel_run_ending *ending, pel_error *error)
{
    pel_json json = {0};
    pel_file_writer writer;
    char path[PEL_RUN_FILE_SIZE], text[1200];
    pel_json_print(&json, "{\n  \"status\": \"%s\"", ending->summary->status);
    write_entries(&json, ending);
    text_entry(&json, "error", ending->cause != NULL ? pel_error_text(ending->cause, text, sizeof text) : "");
    pel_json_print(&json, "\n}\n");
    pel_status status = json.failed ? pel_fail_memory(error) : PEL_OK;
    if (status == PEL_OK)
        status = pel_file_writer_open(&writer, pel_run_path(path, ending->folder, PEL_RUN_SUMMARY), error);
    if (status == PEL_OK) {
        pel_file_writer_write(&writer, json.text, json.length);
        status = pel_file_writer_commit(&writer, error);
    }
    pel_json_free(&json);
    return status;
}
