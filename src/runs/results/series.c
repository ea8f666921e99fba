#include "results/series.h"

#include "base/assert.h"
#include "base/memory.h"
#include "base/number.h"
#include "base/room.h"
#include "base/status.h"
#include "io/file.h"
#include "pellicle/sim_reading.h"
#include "pellicle/sim_rigid.h"
#include "pellicle/tear.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <math.h>
#include <string.h>
#include <unistd.h>

static const char first_columns[] =
    "frame,time,volume,volume_ratio,area_ratio,kinetic_energy,elastic_energy,max_displacement,"
    "max_force,vertices,triangles,contacts,step_ms";
enum { FIRST_COLUMN_COUNT = 13 };

static const char *const tool_columns[] = {"force",    "force_x",  "force_y",  "force_z",    "contacts",
                                           "x",        "y",        "z",        "force_max",  "held",
                                           "torque_x", "torque_y", "torque_z", "force_known"};
enum { TOOL_COLUMN_COUNT = sizeof tool_columns / sizeof tool_columns[0], LONGEST_TOOL_COLUMN = 20 };

static pel_status fail_series(const pel_run_series *series, int number, pel_error *error)
{
    pel_fail(error, PEL_BAD_FILE, "cannot write the file: %s", strerror(number));
    pel_fail_remedy(error, "%s", pel_file_write_remedy(number));
    pel_fail_place(error, series->path, 0, 0);
    return PEL_BAD_FILE;
}

/* ---- the line ---- */

static void put_text(pel_run_series *series, const char *text)
{
    size_t length = strlen(text);
    PEL_ASSERT(series->length + length < series->room);
    memcpy(series->line + series->length, text, length + 1);
    series->length += length;
}

static void put_number(pel_run_series *series, double value)
{
    char text[PEL_NUMBER_SIZE];
    pel_number_print(text, value);
    put_text(series, ",");
    /* a number that does not exist is an empty cell */
    put_text(series, isnan(value) ? "" : text);
}

static void put_count(pel_run_series *series, const char *before, int64_t value)
{
    char text[PEL_NUMBER_SIZE];
    snprintf(text, sizeof text, "%s%" PRId64, before, value);
    put_text(series, text);
}

/* a column's name, in quotes when the name of the tool or body has a character that separates columns */
static void put_named_column(pel_run_series *series, const char *tool, const char *column)
{
    bool quoted = strpbrk(tool, ",\"\r\n") != NULL;
    put_text(series, quoted ? ",\"" : ",");
    for (; *tool != '\0'; tool++) {
        char letters[3] = {*tool, *tool == '"' ? '"' : '\0', '\0'};
        put_text(series, letters);
    }
    put_text(series, "_");
    put_text(series, column);
    put_text(series, quoted ? "\"" : "");
}

static const char *const support_columns[] = {"support_force", "support_force_x", "support_force_y", "support_force_z"};
enum { SUPPORT_COLUMN_COUNT = sizeof support_columns / sizeof support_columns[0] };

/* of single supports */
static const char *const part_columns[] = {"force",    "force_x",  "force_y", "force_z",
                                           "torque_x", "torque_y", "torque_z"};
enum { PART_COLUMN_COUNT = sizeof part_columns / sizeof part_columns[0] };

/* of ties */
static const char *const tie_columns[] = {"force", "force_x", "force_y", "force_z", "largest", "held"};
static const char *const joint_columns[] = {"force",    "force_x",  "force_y",  "force_z", "torque_x",
                                            "torque_y", "torque_z", "position", "load"};
enum { JOINT_COLUMN_COUNT = sizeof joint_columns / sizeof joint_columns[0] };
enum { TIE_COLUMN_COUNT = sizeof tie_columns / sizeof tie_columns[0] };

/* a body whose pins have no tool for columns */
static bool has_pins(const pel_run_series *series, int32_t body)
{
    return series->has_pins[body] != 0;
}

static const char *const body_columns[] = {"contact_force", "contact_force_x", "contact_force_y", "contact_force_z"};
enum { BODY_COLUMN_COUNT = sizeof body_columns / sizeof body_columns[0] };

/* of the center of mass of rigid bodies */
static const char *const rigid_columns[] = {"x",
                                            "y",
                                            "z",
                                            "rotation_x",
                                            "rotation_y",
                                            "rotation_z",
                                            "rotation_w",
                                            "momentum_x",
                                            "momentum_y",
                                            "momentum_z",
                                            "angular_momentum_x",
                                            "angular_momentum_y",
                                            "angular_momentum_z"};
enum { RIGID_COLUMN_COUNT = sizeof rigid_columns / sizeof rigid_columns[0] };

static bool is_rigid(const pel_sim *sim, int32_t body)
{
    pel_rigid_reading reading;
    return pel_sim_get_rigid(sim, body, &reading);
}

/* bodies that may touch each other */
static bool have_contact(const pel_sim *sim)
{
    return pel_sim_contact_thickness(sim) > 0 && pel_model_body_count(pel_sim_model(sim)) > 1;
}

static const char *const shell_columns[] = {"membrane_energy", "bending_energy", "fibre_energy"};
enum { SHELL_COLUMN_COUNT = sizeof shell_columns / sizeof shell_columns[0] };

static const char *const ledger_columns[] = {"work_tools",    "work_loads",      "work_pressure",     "work_gravity",
                                             "work_material", "dissipated_drag", "dissipated_solver", "energy_error"};
enum { LEDGER_COLUMN_COUNT = sizeof ledger_columns / sizeof ledger_columns[0] };

static const char *const contact_columns[] = {
    "contact_candidates", "contact_passed_filter", "contact_passed_hull", "contact_cubics",     "contact_pairs",
    "contact_dropped",    "contact_rounds",        "contact_fall_backs",  "contact_tools_held", "contact_tangled",
    "contact_find_ms",    "contact_solve_ms",      "contact_guard_ms"};
enum { CONTACT_COLUMN_COUNT = sizeof contact_columns / sizeof contact_columns[0], CONTACT_TIMES = 3 };

static bool has_contact(const pel_sim *sim)
{
    return pel_sim_contact_thickness(sim) > 0;
}

static bool has_path(const pel_sim *sim)
{
    return pel_sim_analysis(sim) == PEL_ANALYSIS_NONE && pel_sim_path_kind(sim) == PEL_PATH_ARC_LENGTH;
}

/* 1 at a maximum of the load factor, -1 at a minimum, 2 at a bifurcation, else 0 */
static double limit_of(const pel_sim *sim)
{
    pel_limit_point points[PEL_LIMIT_POINTS];
    int32_t count = pel_sim_get_limit_points(sim, points);
    bool is_limit = count > 0 && points[count - 1].step == pel_sim_step_count(sim);
    static const double marks[] = {[PEL_LIMIT_MAXIMUM] = 1, [PEL_LIMIT_MINIMUM] = -1, [PEL_LIMIT_BIFURCATION] = 2};
    return is_limit ? marks[points[count - 1].kind] : 0;
}

/* the column of an analysis or a path; null = none */
static const char *mode_column(const pel_sim *sim)
{
    static const char *const columns[] = {NULL, "frequency", "load_factor"};
    return has_path(sim) ? "load_factor" : columns[pel_sim_analysis(sim)];
}

static bool has_residual(const pel_sim *sim)
{
    pel_solver_reading reading;
    pel_sim_get_solver(sim, &reading);
    return reading.has_budget;
}

static void put_residual(pel_run_series *series, const pel_sim *sim)
{
    pel_solver_reading reading;
    pel_sim_get_solver(sim, &reading);
    put_number(series, reading.residual);
}

static const char tear_columns[] = ",cut_length,dissipated_fracture,dissipated_remesh,tips,tip_rate,tip_x,tip_y,tip_z,"
                                   "tip_force_x,tip_force_y,tip_force_z";
enum { TEAR_COLUMN_COUNT = 11 };

/* the tip that releases most energy per area; returns the number of tips */
static int32_t find_tip(pel_sim *sim, pel_tip *most)
{
    enum { MOST_TIPS = 64 };
    pel_tip tips[MOST_TIPS];
    int32_t all = 0;
    for (int32_t b = 0; b < pel_model_body_count(pel_sim_model(sim)); b++) {
        int32_t count;
        pel_sim_tips(sim, b, tips, MOST_TIPS, &count, NULL);
        for (int32_t t = 0; t < count && t < MOST_TIPS; t++)
            if (all + t == 0 || tips[t].rate > most->rate)
                *most = tips[t];
        all += count;
    }
    return all;
}

/* of surfaces that open */
static void put_cuts(pel_run_series *series, pel_sim *sim, const pel_sim_ledger *ledger)
{
    pel_cut_reading cuts;
    const pel_tip none = {.rate = (double)NAN,
                          .position = {(double)NAN, (double)NAN, (double)NAN},
                          .force = {(double)NAN, (double)NAN, (double)NAN}};
    pel_tip tip = none;
    pel_sim_get_cuts(sim, -1, &cuts, NULL);
    put_number(series, cuts.length);
    put_number(series, ledger->dissipated_fracture);
    put_number(series, ledger->dissipated_remesh);
    put_count(series, ",", find_tip(sim, &tip));
    put_number(series, tip.rate);
    for (int c = 0; c < 3; c++)
        put_number(series, tip.position[c]);
    for (int c = 0; c < 3; c++)
        put_number(series, tip.force[c]);
}

static bool has_caving(const pel_sim *sim)
{
    pel_solver_reading reading;
    pel_sim_get_solver(sim, &reading);
    return reading.has_caving;
}

static void put_caving(pel_run_series *series, const pel_sim *sim)
{
    pel_solver_reading reading;
    pel_sim_get_solver(sim, &reading);
    put_number(series, reading.caving_limited);
}

static void put_header(pel_run_series *series, const pel_sim *sim)
{
    put_text(series, first_columns);
    for (int32_t t = 0; t < series->tool_count; t++)
        for (int c = 0; c < TOOL_COLUMN_COUNT; c++)
            put_named_column(series, pel_sim_tool_name(sim, t), tool_columns[c]);
    const pel_model *model = pel_sim_model(sim);
    for (int32_t b = 0; b < pel_model_body_count(model); b++)
        for (int c = 0; has_pins(series, b) && c < SUPPORT_COLUMN_COUNT; c++)
            put_named_column(series, pel_model_body_name(model, b), support_columns[c]);
    for (int32_t s = 0; s < pel_sim_support_count(sim); s++)
        for (int c = 0; c < PART_COLUMN_COUNT; c++)
            put_named_column(series, pel_sim_support_name(sim, s), part_columns[c]);
    for (int32_t t = 0; t < pel_sim_tie_count(sim); t++)
        for (int c = 0; c < TIE_COLUMN_COUNT; c++)
            put_named_column(series, pel_sim_tie_name(sim, t), tie_columns[c]);
    for (int32_t j = 0; j < pel_sim_joint_count(sim); j++)
        for (int c = 0; c < JOINT_COLUMN_COUNT; c++)
            put_named_column(series, pel_sim_joint_name(sim, j), joint_columns[c]);
    for (int32_t b = 0; b < pel_model_body_count(model); b++)
        for (int c = 0; have_contact(sim) && c < BODY_COLUMN_COUNT; c++)
            put_named_column(series, pel_model_body_name(model, b), body_columns[c]);
    for (int32_t b = 0; b < pel_model_body_count(model); b++)
        for (int c = 0; c < RIGID_COLUMN_COUNT && is_rigid(sim, b); c++)
            put_named_column(series, pel_model_body_name(model, b), rigid_columns[c]);
    for (int c = 0; pel_sim_has_shells(sim) && c < SHELL_COLUMN_COUNT; c++) {
        put_text(series, ",");
        put_text(series, shell_columns[c]);
    }
    for (int c = 0; c < LEDGER_COLUMN_COUNT; c++) {
        put_text(series, ",");
        put_text(series, ledger_columns[c]);
    }
    for (int c = 0; has_contact(sim) && c < CONTACT_COLUMN_COUNT; c++) {
        put_text(series, ",");
        put_text(series, contact_columns[c]);
    }
    if (mode_column(sim) != NULL) {
        put_text(series, ",");
        put_text(series, mode_column(sim));
    }
    if (has_path(sim))
        put_text(series, ",limit_point");
    if (has_residual(sim))
        put_text(series, ",solver_residual");
    if (pel_sim_can_tear(sim))
        put_text(series, tear_columns);
    if (has_caving(sim))
        put_text(series, ",caving_limited");
    put_text(series, "\n");
}

/* its size, then x, y, z */
static void put_force(pel_run_series *series, const double f[3])
{
    put_number(series, sqrt(f[0] * f[0] + f[1] * f[1] + f[2] * f[2]));
    for (int i = 0; i < 3; i++)
        put_number(series, f[i]);
}

static void put_tool(pel_run_series *series, const pel_sim *sim, int32_t tool, double force_max)
{
    pel_tool_reading reading;
    pel_sim_get_tool(sim, tool, &reading);
    put_force(series, reading.force);
    put_count(series, ",", reading.contact_count);
    for (int i = 0; i < 3; i++)
        put_number(series, reading.position[i]);
    put_number(series, force_max);
    put_count(series, ",", reading.held_count);
    for (int i = 0; i < 3; i++)
        put_number(series, reading.torque[i]);
    put_count(series, ",", reading.force_known);
}

static void put_support(pel_run_series *series, pel_sim *sim, int32_t body)
{
    pel_support_reading reading;
    pel_sim_get_support(sim, body, &reading);
    put_force(series, reading.force);
}

static void put_part(pel_run_series *series, const pel_sim *sim, int32_t support)
{
    pel_support_reading reading;
    pel_sim_get_support_part(sim, support, &reading);
    put_force(series, reading.force);
    for (int i = 0; i < 3; i++)
        put_number(series, reading.torque[i]);
}

static void put_tie(pel_run_series *series, const pel_sim *sim, int32_t tie)
{
    pel_tie_reading reading;
    pel_sim_get_tie(sim, tie, &reading);
    put_force(series, reading.force);
    put_number(series, reading.largest);
    put_count(series, ",", reading.held_count);
}

static void put_joint(pel_run_series *series, const pel_sim *sim, int32_t joint)
{
    pel_joint_reading reading = {0};
    pel_sim_get_joint(sim, joint, &reading);
    put_force(series, reading.force);
    for (int i = 0; i < 3; i++)
        put_number(series, reading.torque[i]);
    put_number(series, reading.position);
    put_number(series, reading.load);
}

static void put_body(pel_run_series *series, const pel_sim *sim, int32_t body)
{
    double force[3];
    pel_sim_get_body_contact(sim, body, force);
    put_force(series, force);
}

static void put_rigid(pel_run_series *series, const pel_sim *sim, int32_t body)
{
    pel_rigid_reading reading;
    if (!pel_sim_get_rigid(sim, body, &reading))
        return;
    for (int i = 0; i < 3; i++)
        put_number(series, reading.center[i]);
    for (int i = 0; i < 4; i++)
        put_number(series, reading.rotation[i]);
    for (int i = 0; i < 3; i++)
        put_number(series, reading.momentum[i]);
    for (int i = 0; i < 3; i++)
        put_number(series, reading.angular_momentum[i]);
}

static void put_ledger(pel_run_series *series, const pel_sim_ledger *ledger)
{
    const double energies[LEDGER_COLUMN_COUNT] = {
        ledger->work_tools,    ledger->work_loads,      ledger->work_pressure,     ledger->work_gravity,
        ledger->work_material, ledger->dissipated_drag, ledger->dissipated_solver, ledger->energy_error};
    for (int c = 0; c < LEDGER_COLUMN_COUNT; c++)
        put_number(series, energies[c]);
}

/* sums over the steps since the last frame */
static void put_contact(pel_run_series *series, const pel_run_row *row)
{
    const pel_contact_statistics *now = &row->contact, *before = &row->contact_before;
    const int64_t counts[CONTACT_COLUMN_COUNT - CONTACT_TIMES] = {
        now->candidates - before->candidates,   now->passed_filter - before->passed_filter,
        now->passed_hull - before->passed_hull, now->cubics - before->cubics,
        now->contacts - before->contacts,       now->dropped - before->dropped,
        now->rounds - before->rounds,           now->fall_backs - before->fall_backs,
        now->tools_held - before->tools_held,   now->tangled,
    };
    const double seconds[CONTACT_TIMES] = {
        now->find_seconds - before->find_seconds,
        now->solve_seconds - before->solve_seconds,
        now->guard_seconds - before->guard_seconds,
    };
    for (int c = 0; c < CONTACT_COLUMN_COUNT - CONTACT_TIMES; c++)
        put_count(series, ",", counts[c]);
    for (int c = 0; c < CONTACT_TIMES; c++)
        put_number(series, round(seconds[c] * 1e8) / 1e5);
}

/* ---- the file ---- */

static pel_status prepare(pel_run_series *series, const char *path, const pel_sim *sim, pel_error *error)
{
    size_t name_room = 2 * PEL_NAME_SIZE + LONGEST_TOOL_COLUMN + PEL_NUMBER_SIZE;
    size_t tool_room = TOOL_COLUMN_COUNT * name_room;
    *series = (pel_run_series){.descriptor = -1, .path = path, .tool_count = pel_sim_tool_count(sim)};
    int32_t body_count = pel_model_body_count(pel_sim_model(sim));
    series->room =
        sizeof first_columns + sizeof tear_columns + TEAR_COLUMN_COUNT * PEL_NUMBER_SIZE +
        (FIRST_COLUMN_COUNT + SHELL_COLUMN_COUNT + LEDGER_COLUMN_COUNT + CONTACT_COLUMN_COUNT + 2) * PEL_NUMBER_SIZE +
        (size_t)series->tool_count * tool_room + (size_t)pel_sim_support_count(sim) * PART_COLUMN_COUNT * name_room +
        (size_t)pel_sim_tie_count(sim) * TIE_COLUMN_COUNT * name_room +
        (size_t)pel_sim_joint_count(sim) * JOINT_COLUMN_COUNT * name_room +
        (size_t)pel_model_body_count(pel_sim_model(sim)) *
            (SUPPORT_COLUMN_COUNT + BODY_COLUMN_COUNT + RIGID_COLUMN_COUNT) * name_room;
    if (!PEL_ALLOCATE_ALL(PEL_ROOM(series->line, series->room), PEL_ROOM(series->has_pins, body_count)))
        return pel_fail_memory(error);
    for (int32_t b = 0; b < body_count; b++)
        series->has_pins[b] = pel_model_pinned_count(pel_sim_model(sim), b) > 0;
    return PEL_OK;
}

static pel_status write_line(pel_run_series *series, pel_error *error)
{
    size_t written = 0;
    while (written < series->length) {
        ssize_t count = write(series->descriptor, series->line + written, series->length - written);
        if (count < 0 && errno == EINTR)
            continue;
        if (count < 0) {
            int number = errno;
            /* shortening needs no space */
            if (ftruncate(series->descriptor, series->size) != 0)
                number = errno;
            lseek(series->descriptor, series->size, SEEK_SET);
            return fail_series(series, number, error);
        }
        written += (size_t)count;
    }
    series->size += (int64_t)series->length;
    return PEL_OK;
}

pel_status pel_run_series_create(pel_run_series *series, const char *path, const pel_sim *sim, pel_error *error)
{
    pel_status status = prepare(series, path, sim, error);
    if (status != PEL_OK)
        return status;
    put_header(series, sim);
    if (path == NULL)
        return PEL_OK;
    series->descriptor = open(path, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    return series->descriptor >= 0 ? write_line(series, error) : fail_series(series, errno, error);
}

/* bytes of the header and the first row_count rows; 0 when they are not all there */
static size_t find_rows(const pel_run_series *series, const char *bytes, size_t size, int64_t row_count)
{
    if (size < series->length || memcmp(bytes, series->line, series->length) != 0)
        return 0;
    const char *at = bytes + series->length, *end = bytes + size;
    for (int64_t row = 0; row < row_count; row++) {
        char number[PEL_NUMBER_SIZE];
        size_t digits = (size_t)snprintf(number, sizeof number, "%" PRId64 ",", row);
        const char *line_end = memchr(at, '\n', (size_t)(end - at));
        if (line_end == NULL || (size_t)(line_end - at) < digits || memcmp(at, number, digits) != 0)
            return 0;
        at = line_end + 1;
    }
    return (size_t)(at - bytes);
}

pel_status pel_run_series_resume(pel_run_series *series, const char *path, const pel_sim *sim, int64_t row_count,
                                 pel_error *error)
{
    char *bytes;
    size_t size;
    pel_status status = prepare(series, path, sim, error);
    if (status == PEL_OK)
        status = pel_file_read(path, &bytes, &size, error);
    if (status == PEL_BAD_FILE)
        pel_fail_remedy(error, "resume in the folder of the run that wrote the checkpoint");
    if (status != PEL_OK)
        return status;
    put_header(series, sim);
    size_t kept = find_rows(series, bytes, size, row_count);
    pel_free(bytes);
    if (kept == 0) {
        pel_fail(error, PEL_BAD_FORMAT, "the series does not have the %" PRId64 " rows before the checkpoint",
                 row_count);
        pel_fail_remedy(error, "resume in the folder of the run that wrote the checkpoint, or run from the beginning");
        pel_fail_place(error, path, 0, 0);
        return PEL_BAD_FORMAT;
    }
    series->descriptor = open(path, O_WRONLY | O_CLOEXEC);
    series->size = (int64_t)kept;
    if (series->descriptor < 0 || ftruncate(series->descriptor, series->size) != 0 ||
        lseek(series->descriptor, series->size, SEEK_SET) < 0)
        return fail_series(series, errno, error);
    return PEL_OK;
}

void pel_run_series_make(pel_run_series *series, pel_sim *sim, const pel_run_row *row)
{
    const pel_sim_measures *m = &row->measures;
    series->length = 0;
    put_count(series, "", row->frame);
    const double numbers[] = {pel_sim_time(sim), m->volume,         m->volume_ratio,     m->area_ratio,
                              m->kinetic_energy, m->elastic_energy, m->max_displacement, m->max_force};
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
        put_number(series, numbers[i]);
    put_count(series, ",", m->vertex_count);
    put_count(series, ",", m->triangle_count);
    put_count(series, ",", m->contact_count);
    put_number(series, round(row->step_ms * 1e5) / 1e5);
    for (int32_t t = 0; t < series->tool_count; t++)
        put_tool(series, sim, t, row->tool_force_max[t]);
    for (int32_t b = 0; b < pel_model_body_count(pel_sim_model(sim)); b++)
        if (has_pins(series, b))
            put_support(series, sim, b);
    for (int32_t s = 0; s < pel_sim_support_count(sim); s++)
        put_part(series, sim, s);
    for (int32_t t = 0; t < pel_sim_tie_count(sim); t++)
        put_tie(series, sim, t);
    for (int32_t j = 0; j < pel_sim_joint_count(sim); j++)
        put_joint(series, sim, j);
    for (int32_t b = 0; have_contact(sim) && b < pel_model_body_count(pel_sim_model(sim)); b++)
        put_body(series, sim, b);
    for (int32_t b = 0; b < pel_model_body_count(pel_sim_model(sim)); b++)
        put_rigid(series, sim, b);
    const double energies[SHELL_COLUMN_COUNT] = {m->membrane_energy, m->bending_energy, m->fibre_energy};
    for (int c = 0; pel_sim_has_shells(sim) && c < SHELL_COLUMN_COUNT; c++)
        put_number(series, energies[c]);
    put_ledger(series, &row->ledger);
    if (has_contact(sim))
        put_contact(series, row);
    if (mode_column(sim) != NULL)
        put_number(series, has_path(sim) ? pel_sim_load_factor(sim) : pel_sim_mode_value(sim));
    if (has_path(sim))
        put_number(series, limit_of(sim));
    if (has_residual(sim))
        put_residual(series, sim);
    if (pel_sim_can_tear(sim))
        put_cuts(series, sim, &row->ledger);
    if (has_caving(sim))
        put_caving(series, sim);
    put_text(series, "\n");
}

pel_status pel_run_series_add(pel_run_series *series, pel_error *error)
{
    return write_line(series, error);
}

void pel_run_series_close(pel_run_series *series)
{
    if (series->line != NULL && series->descriptor >= 0)
        close(series->descriptor);
    PEL_FREE_ALL(series->line, series->has_pins);
    *series = (pel_run_series){.descriptor = -1};
}
