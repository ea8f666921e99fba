#include "results/summary.h"

#include "base/status.h"
#include "io/file.h"
#include "io/json.h"
#include "pellicle/sim_contact.h"
#include "pellicle/sim_ledger.h"
#include "pellicle/sim_reading.h"
#include "pellicle/tear.h"
#include "results/folder.h"
#include "stage/stepper.h"

#include <inttypes.h>
#include <math.h>

/* an object or array in one line, inside the lines of the summary */
static void open_inline(pel_json *json, const char *key, char bracket)
{
    pel_json_open(json, key, bracket);
    json->style = PEL_JSON_SPACED;
}

static void close_inline(pel_json *json, char bracket)
{
    pel_json_close(json, bracket);
    json->style = PEL_JSON_INDENTED;
}

static void text_entry(pel_json *json, const char *key, const char *text)
{
    pel_json_text(json, key, text[0] != '\0' ? text : NULL);
}

static void write_event(pel_json *json, const char *count_key, int64_t count, const char *time_key, double time)
{
    pel_json_integer(json, count_key, count);
    pel_json_number(json, time_key, count > 0 ? time : (double)NAN);
}

static void write_tool(pel_json *json, const pel_sim *sim, int32_t tool, double max_force)
{
    pel_tool_reading reading;
    pel_sim_get_tool(sim, tool, &reading);
    pel_json_open(json, NULL, '{');
    pel_json_text(json, "name", pel_sim_tool_name(sim, tool));
    pel_json_number(json, "max_force", max_force);
    pel_json_integer(json, "held", reading.held_count);
    write_event(json, "lost", reading.lost_count, "lost_time", reading.lost_time);
    write_event(json, "held_back_steps", reading.held_back_count, "held_back_time", reading.held_back_time);
    pel_json_close(json, '}');
}

static void write_tools(pel_json *json, const pel_run_ending *ending)
{
    open_inline(json, "tools", '[');
    for (int32_t t = 0; t < ending->tool_count; t++)
        write_tool(json, ending->sim, t, ending->tool_force[t]);
    close_inline(json, ']');
}

static void write_contact(pel_json *json, const pel_sim *sim, double worst_step_ms)
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
                  {"tools_held", s.tools_held},   {"steps_divided", s.steps_divided},
                  {"tangled", s.tangled}};
    open_inline(json, "contact", '{');
    pel_json_number(json, "thickness", pel_sim_contact_thickness(sim));
    pel_json_open(json, "thickness_of", '{');
    for (int32_t b = 0; b < pel_model_body_count(pel_sim_model(sim)); b++)
        pel_json_number(json, pel_model_body_name(pel_sim_model(sim), b), pel_sim_body_contact_thickness(sim, b));
    pel_json_close(json, '}');
    for (size_t i = 0; i < sizeof counts / sizeof counts[0]; i++)
        pel_json_integer(json, counts[i].name, counts[i].count);
    pel_json_number(json, "cubics_saved", s.candidates > 0 ? 1 - (double)s.cubics / (double)s.candidates : 1);
    int64_t steps = pel_sim_step_count(sim);
    pel_json_number(json, "sleeping_share", steps > 0 ? s.sleeping / (double)steps : 0);
    pel_json_number(json, "worst_step_ms", worst_step_ms);
    pel_json_number(json, "find_s", s.find_seconds);
    pel_json_number(json, "solve_s", s.solve_seconds);
    pel_json_number(json, "guard_s", s.guard_seconds);
    close_inline(json, '}');
}

static void write_solver(pel_json *json, const pel_run_ending *ending)
{
    const pel_run_summary *s = ending->summary;
    pel_method method = ending->method;
    text_entry(json, "method", ending->method_name);
    if (s->solver.solves) {
        pel_json_integer(json, "solver_iterations", s->solver.iterations);
        pel_json_number(json, "solver_residual", s->solver.residual);
        pel_json_bool(json, "solver_converged", s->solver.converged);
        pel_json_integer(json, "solver_unconverged_steps", s->unconverged_steps);
    }
    if (s->solver.substeps == 0)
        return;
    pel_json_integer(json, "substeps_min", s->solver.least_substeps);
    pel_json_integer(json, "substeps_max", s->solver.most_substeps);
    if (!pel_stepper_of(method)->is_compliant)
        return;
    pel_json_integer(json, "substeps_needed", s->solver.needed_substeps);
    pel_json_bool(json, "second_order", s->solver.second_order);
    pel_json_number(json, "softness_max", s->solver.most_softness);
}

/* frequencies or load factors of an analysis */
static void write_modes(pel_json *json, const pel_run_ending *ending)
{
    static const char *const keys[] = {NULL, "frequencies", "load_factors"};
    pel_analysis analysis = pel_sim_analysis(ending->sim);
    if (analysis == PEL_ANALYSIS_NONE)
        return;
    pel_json_numbers(json, keys[analysis], ending->summary->modes, ending->summary->mode_count);
}

static void write_limit_points(pel_json *json, const pel_sim *sim)
{
    static const char *const kinds[] = {
        [PEL_LIMIT_MAXIMUM] = "maximum", [PEL_LIMIT_MINIMUM] = "minimum", [PEL_LIMIT_BIFURCATION] = "bifurcation"};
    pel_limit_point points[PEL_LIMIT_POINTS];
    if (pel_sim_analysis(sim) != PEL_ANALYSIS_NONE || pel_sim_path_kind(sim) != PEL_PATH_ARC_LENGTH)
        return;
    int32_t count = pel_sim_get_limit_points(sim, points);
    pel_json_open(json, "limit_points", '[');
    for (int32_t i = 0; i < count; i++) {
        open_inline(json, NULL, '{');
        pel_json_number(json, "load_factor", points[i].load_factor);
        pel_json_integer(json, "step", points[i].step);
        pel_json_text(json, "kind", kinds[points[i].kind]);
        close_inline(json, '}');
    }
    pel_json_close(json, ']');
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
                   {"work_estimated", ledger->work_estimated},
                   {"work_loads", ledger->work_loads},
                   {"work_pressure", ledger->work_pressure},
                   {"work_gravity", ledger->work_gravity},
                   {"work_material", ledger->work_material},
                   {"dissipated_drag", ledger->dissipated_drag},
                   {"dissipated_fracture", ledger->dissipated_fracture},
                   {"dissipated_remesh", ledger->dissipated_remesh},
                   {"dissipated_plastic", ledger->dissipated_plastic},
                   {"dissipated_solver", ledger->dissipated_solver},
                   {"energy_error", ledger->energy_error},
                   {"supplied", ledger->supplied}};
    open_inline(json, "energy", '{');
    for (size_t i = 0; i < sizeof entries / sizeof entries[0]; i++)
        pel_json_number(json, entries[i].name, entries[i].value);
    close_inline(json, '}');
}

void pel_results_put_hole(pel_json *json, const pel_hole_reading *hole)
{
    pel_json_bool(json, "whole", hole->is_whole);
    pel_json_number(json, "swept", hole->swept);
    pel_json_number(json, "diameter", hole->diameter);
    pel_json_number(json, "offset", hole->offset);
    pel_json_number(json, "roundness", hole->roundness);
    pel_json_integer(json, "run_outs", hole->run_out_count);
}

void pel_results_put_forces(pel_json *json, const pel_score *score)
{
    pel_json_number(json, "force_peak", score->force_peak);
    pel_json_number(json, "force_rms", score->force_rms);
    pel_json_number(json, "time", score->time);
    pel_json_number(json, "touches", (double)score->touch_count);
}

/* of forceps that lead a tear */
static void write_score(pel_json *json, const pel_sim *sim)
{
    pel_score score;
    if (!pel_sim_get_score(sim, &score))
        return;
    pel_json_open(json, "hole", '{');
    pel_results_put_hole(json, &score.hole);
    pel_json_number(json, "largest_radius", score.hole.largest);
    pel_json_close(json, '}');
    pel_json_open(json, "score", '{');
    pel_results_put_forces(json, &score);
    pel_json_close(json, '}');
}

static void write_cuts(pel_json *json, const pel_sim *sim, const pel_sim_ledger *ledger)
{
    pel_cut_reading cuts;
    pel_sim_get_cuts(sim, -1, &cuts, NULL);
    open_inline(json, "tear", '{');
    pel_json_number(json, "length", cuts.length);
    pel_json_number(json, "fracture_energy", ledger->dissipated_fracture);
    pel_json_integer(json, "islands", cuts.island_count);
    pel_json_integer(json, "released", cuts.released_count);
    pel_json_integer(json, "cuts", pel_sim_cuts_done(sim));
    write_score(json, sim);
    close_inline(json, '}');
}

static void write_warnings(pel_json *json, const pel_run_summary *summary)
{
    pel_json_open(json, "warnings", '[');
    for (int32_t i = 0; i < summary->warning_count; i++) {
        const pel_run_warning *warning = &summary->warnings[i];
        open_inline(json, NULL, '{');
        pel_json_text(json, "code", warning->code);
        pel_json_integer(json, "first_frame", warning->first_frame);
        pel_json_integer(json, "count", warning->count);
        pel_json_text(json, "text", warning->text);
        close_inline(json, '}');
    }
    pel_json_close(json, ']');
}

static void write_entries(pel_json *json, const pel_run_ending *ending)
{
    const pel_run_summary *s = ending->summary;
    pel_json_integer(json, "frames", s->frames);
    pel_json_integer(json, "steps", s->steps);
    pel_json_number(json, "time_simulated", s->time_simulated);
    pel_json_number(json, "wall_s", s->wall_s);
    pel_json_number(json, "steps_per_second", s->steps_per_second);
    pel_json_number(json, "volume_final", s->volume_final);
    pel_json_number(json, "volume_ratio_final", s->volume_ratio_final);
    pel_json_number(json, "area_ratio_final", s->area_ratio_final);
    pel_json_number(json, "max_displacement", s->max_displacement);
    pel_json_number(json, "residual_displacement", s->residual_displacement);
    pel_json_integer(json, "vertices_final", s->vertices_final);
    pel_json_integer(json, "triangles_final", s->triangles_final);
    if (s->self_intersections_final >= 0)
        pel_json_integer(json, "self_intersections_final", s->self_intersections_final);
    else
        pel_json_null(json, "self_intersections_final");
    pel_json_key(json, "state_hash");
    pel_json_print(json, "\"%016" PRIx64 "\"", s->state_hash);
    pel_json_number(json, "alpha", s->alpha);
    pel_json_number(json, "alpha_limit", s->alpha_limit);
    pel_json_integer(json, "threads", s->threads);
    pel_json_number(json, "max_tool_force", s->max_tool_force);
    write_tools(json, ending);
    write_solver(json, ending);
    write_modes(json, ending);
    write_limit_points(json, ending->sim);
    if (pel_sim_contact_thickness(ending->sim) > 0)
        write_contact(json, ending->sim, ending->summary->worst_step_ms);
    write_ledger(json, &s->ledger);
    if (pel_sim_can_tear(ending->sim))
        write_cuts(json, ending->sim, &s->ledger);
    write_warnings(json, s);
    text_entry(json, "stop_reason", s->stop_reason);
    pel_json_integer(json, "volume_rises", s->volume_rises);
    pel_json_number(json, "volume_rise_sum", s->volume_rise_sum);
    pel_json_number(json, "volume_rise_max", s->volume_rise_max);
    text_entry(json, "checkpoint", s->checkpoint);
    text_entry(json, "scene", ending->scene_path);
    text_entry(json, "version", PEL_VERSION);
}

pel_status pel_results_write_summary(const pel_run_ending *ending, pel_error *error)
{
    pel_json json = {.style = PEL_JSON_INDENTED};
    pel_file_writer writer;
    char path[PEL_RUN_FILE_SIZE], text[1200];
    pel_json_open(&json, NULL, '{');
    pel_json_text(&json, "status", ending->summary->status);
    write_entries(&json, ending);
    text_entry(&json, "error", ending->cause != NULL ? pel_error_text(ending->cause, text, sizeof text) : "");
    pel_json_close(&json, '}');
    pel_status status = json.failed ? pel_fail_memory(error) : PEL_OK;
    if (status == PEL_OK)
        status = pel_run_folder_sync(ending->folder, error);
    if (status == PEL_OK)
        status = pel_file_writer_open(&writer, pel_run_path(path, ending->folder, PEL_RUN_SUMMARY), error);
    if (status == PEL_OK) {
        pel_file_writer_keep(&writer);
        pel_file_writer_write(&writer, json.text, json.length);
        status = pel_file_writer_commit(&writer, error);
    }
    pel_json_free(&json);
    return status;
}
