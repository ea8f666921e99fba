/* One run of a study: the scene with its values, stepped to its end without a folder, and the row of its measures. */
#include "study/kept.h"

#include "base/memory.h"
#include "base/number.h"
#include "io/csv.h"
#include "math/extremes.h"
#include "pellicle/run.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

/* room for the text of an error; digits of the folder of a run */
enum { ERROR_SIZE = 1200, FOLDER_DIGITS = 5 };

/* ---- numbers of the summary ---- */

enum { EVERYTHING = PEL_RUN_SURFACES | PEL_RUN_ENERGIES | PEL_RUN_HASH | PEL_RUN_WARNINGS };

typedef enum key_kind { KEY_DOUBLE, KEY_INT32, KEY_INT64, KEY_HASH, KEY_CODES } key_kind;

/* names are those of summary.json; what depends on the machine is not there */
static const struct summary_key {
    const char *name;
    key_kind kind;
    size_t offset;
    unsigned needs; /* of run/kept.h */
} summary_keys[] = {
#define KEY_OF(name, kind, needs)                                                                                      \
    {                                                                                                                  \
#name, kind, offsetof(pel_run_summary, name), needs                                                            \
    }
#define KEY(name, kind) KEY_OF(name, kind, 0)
#define ENERGY(name)                                                                                                   \
    {                                                                                                                  \
        "energy." #name, KEY_DOUBLE, offsetof(pel_run_summary, ledger.name), PEL_RUN_ENERGIES                          \
    }
    KEY(max_displacement, KEY_DOUBLE),
    KEY(residual_displacement, KEY_DOUBLE),
    KEY_OF(volume_final, KEY_DOUBLE, PEL_RUN_SURFACES),
    KEY_OF(volume_ratio_final, KEY_DOUBLE, PEL_RUN_SURFACES),
    KEY_OF(area_ratio_final, KEY_DOUBLE, PEL_RUN_SURFACES),
    KEY(max_tool_force, KEY_DOUBLE),
    KEY(time_simulated, KEY_DOUBLE),
    KEY(frames, KEY_INT64),
    KEY(steps, KEY_INT64),
    KEY_OF(vertices_final, KEY_INT64, PEL_RUN_SURFACES),
    KEY_OF(triangles_final, KEY_INT64, PEL_RUN_SURFACES),
    KEY(self_intersections_final, KEY_INT64),
    KEY_OF(state_hash, KEY_HASH, PEL_RUN_HASH),
    KEY(alpha, KEY_DOUBLE),
    KEY(alpha_limit, KEY_DOUBLE),
    KEY_OF(volume_rises, KEY_INT64, PEL_RUN_SURFACES),
    KEY_OF(volume_rise_sum, KEY_DOUBLE, PEL_RUN_SURFACES),
    KEY_OF(volume_rise_max, KEY_DOUBLE, PEL_RUN_SURFACES),
    {"warnings", KEY_INT32, offsetof(pel_run_summary, warning_count), EVERYTHING},
    {"warning_codes", KEY_CODES, 0, EVERYTHING},
    {"solver_iterations", KEY_INT32, offsetof(pel_run_summary, solver.iterations), 0},
    {"solver_residual", KEY_DOUBLE, offsetof(pel_run_summary, solver.residual), 0},
    /* they are counted as warnings */
    {"solver_unconverged_steps", KEY_INT64, offsetof(pel_run_summary, unconverged_steps), EVERYTHING},
    {"frequency", KEY_DOUBLE, offsetof(pel_run_summary, modes), 0},
    {"load_factor", KEY_DOUBLE, offsetof(pel_run_summary, modes), 0},
    ENERGY(elastic),
    ENERGY(kinetic),
    ENERGY(elastic_start),
    ENERGY(kinetic_start),
    ENERGY(work_tools),
    ENERGY(work_estimated),
    ENERGY(work_loads),
    ENERGY(work_pressure),
    ENERGY(work_gravity),
    ENERGY(work_material),
    ENERGY(dissipated_drag),
    ENERGY(dissipated_plastic),
    ENERGY(dissipated_solver),
    ENERGY(energy_error),
    ENERGY(supplied),
};
enum { SUMMARY_KEY_COUNT = sizeof summary_keys / sizeof summary_keys[0] };

/* kept when a study does not say */
static const char *const usual_keys[] = {"max_displacement", "residual_displacement", "volume_ratio_final",
                                         "max_tool_force", "warning_codes"};
enum { USUAL_COUNT = sizeof usual_keys / sizeof usual_keys[0] };

static void put_key(pel_json *row, const struct summary_key *key, const pel_run_summary *summary)
{
    const char *at = (const char *)summary + key->offset;
    char text[PEL_NUMBER_SIZE] = "";
    switch (key->kind) {
    case KEY_DOUBLE:
        pel_number_print(text, *(const double *)(const void *)at);
        break;
    case KEY_INT32:
        snprintf(text, sizeof text, "%" PRId32, *(const int32_t *)(const void *)at);
        break;
    case KEY_INT64:
        snprintf(text, sizeof text, "%" PRId64, *(const int64_t *)(const void *)at);
        break;
    case KEY_CODES:
        for (int32_t i = 0; i < summary->warning_count; i++)
            pel_json_print(row, "%s%s", i > 0 ? " " : "", summary->warnings[i].code);
        break;
    case KEY_HASH:
        snprintf(text, sizeof text, "%016" PRIx64, *(const uint64_t *)(const void *)at);
        break;
    }
    pel_json_print(row, "%s", text);
}

/* ---- `measure` ---- */

static const char *const at_words[PEL_STUDY_AT_COUNT] = {"start", "end", "min", "max", "mean"};
static const char *const column_keys[] = {"column", "at"};

static pel_status find_key(pel_scene_reader *reader, const pel_scene_value *value, pel_study_measure *measure)
{
    const char *names[SUMMARY_KEY_COUNT], *text;
    pel_status status = pel_study_need_text(reader, value, &text);
    if (status != PEL_OK)
        return status;
    for (int32_t k = 0; k < SUMMARY_KEY_COUNT; k++) {
        names[k] = summary_keys[k].name;
        if (strcmp(text, names[k]) == 0) {
            measure->key = k;
            return PEL_OK;
        }
    }
    const char *nearest = pel_nearest_name(text, names, SUMMARY_KEY_COUNT);
    pel_scene_fail(reader, &value->place, "'%.100s' is not a number of the summary that a study can keep", text);
    if (nearest != NULL)
        pel_fail_remedy(reader->error, "did you mean '%s'?", nearest);
    else
        pel_fail_remedy(reader->error, "write { column: %.60s, at: end } for a column of series.csv", text);
    return PEL_BAD_SCENE;
}

static pel_status read_column(pel_scene_reader *reader, const pel_scene_value *map, pel_study_measure *measure)
{
    pel_status status = pel_study_check_keys(reader, map, "a measure", column_keys, 2);
    const pel_scene_value *column = pel_scene_value_entry(map, "column"), *at = pel_scene_value_entry(map, "at");
    int32_t word = PEL_STUDY_END;
    if (status == PEL_OK && column == NULL) {
        pel_scene_fail(reader, &map->place, "the measure names no column");
        pel_fail_remedy(reader->error, "write { column: max_force, at: max }");
        return PEL_BAD_SCENE;
    }
    if (status == PEL_OK)
        status = pel_study_need_text(reader, column, &measure->column);
    if (status == PEL_OK && at != NULL)
        status = pel_study_need_word(reader, at, at_words, PEL_STUDY_AT_COUNT, &word);
    measure->at = (pel_study_at)word;
    measure->key = -1;
    if (status == PEL_OK)
        measure->place = column->place;
    return status;
}

static pel_status read_measure(pel_scene_reader *reader, const pel_scene_value *value, pel_study_measure *measure)
{
    measure->name = value->key != NULL ? value->key : value->text;
    measure->place = value->place;
    if (value->kind == PEL_SCENE_MAP && value->key != NULL)
        return read_column(reader, value, measure);
    if (value->kind == PEL_SCENE_SCALAR)
        return find_key(reader, value, measure);
    pel_scene_fail(reader, &value->place, "this is not a measure");
    pel_fail_remedy(reader->error, "write NAME: max_displacement or NAME: { column: max_force, at: max }");
    return PEL_BAD_SCENE;
}

/* a column of the table has one name */
static pel_status check_names(pel_scene_reader *reader, const pel_study *study)
{
    static const char *const own[] = {"run", "status", "error"};
    for (int32_t m = 0; m < study->measure_count; m++) {
        const pel_study_measure *measure = &study->measures[m];
        bool taken = false;
        for (size_t i = 0; i < sizeof own / sizeof *own; i++)
            taken |= strcmp(measure->name, own[i]) == 0;
        for (int32_t a = 0; a < study->axis_count; a++)
            taken |= strcmp(measure->name, study->axes[a].path) == 0;
        for (int32_t other = 0; other < m; other++)
            taken |= strcmp(measure->name, study->measures[other].name) == 0;
        if (taken) {
            pel_scene_fail(reader, &measure->place, "the table has a column '%.100s' already", measure->name);
            pel_fail_remedy(reader->error, "give the measure another name");
            return PEL_BAD_SCENE;
        }
    }
    return PEL_OK;
}

pel_status pel_study_read_measures(pel_scene_reader *reader, const pel_scene_value *measure, pel_study *study)
{
    int32_t count = measure != NULL ? pel_scene_value_count(measure) : USUAL_COUNT;
    study->measures = pel_arena_take(reader->arena, (size_t)count + 1, sizeof *study->measures);
    if (study->measures == NULL)
        return pel_fail_memory(reader->error);
    study->measure_count = count;
    if (measure == NULL) {
        for (int32_t m = 0; m < count; m++)
            for (int32_t k = 0; k < SUMMARY_KEY_COUNT; k++)
                if (strcmp(summary_keys[k].name, usual_keys[m]) == 0)
                    study->measures[m] = (pel_study_measure){.name = usual_keys[m], .key = k};
        return PEL_OK;
    }
    if (count == 0) {
        pel_scene_fail(reader, &measure->place, "nothing is measured");
        pel_fail_remedy(reader->error, "write measure: [max_displacement], or leave it out");
        return PEL_BAD_SCENE;
    }
    pel_status status =
        measure->kind == PEL_SCENE_MAP ? pel_study_check_keys(reader, measure, "measure", NULL, 0) : PEL_OK;
    int32_t m = 0;
    for (const pel_scene_value *child = measure->first; child != NULL && status == PEL_OK; child = child->next, m++)
        status = read_measure(reader, child, &study->measures[m]);
    return status == PEL_OK ? check_names(reader, study) : status;
}

/* ---- the series as it is made ---- */

/* what is summed up of one measure's column */
typedef struct column_sum {
    int32_t place; /* of the column; -1 = none */
    double start, end, least, most, sum;
    int64_t count;
} column_sum;

typedef struct run_watch {
    const pel_study *study;
    column_sum *sums; /* (measure_count) */
    bool has_header;
    bool (*wanted)(void *user);
    void *user;
} run_watch;

/* names that the program chooses and that depend on the machine's speed */
static bool is_wall_time(const char *column)
{
    size_t length = strlen(column);
    return length >= 3 && strcmp(column + length - 3, "_ms") == 0;
}

static void read_header(run_watch *watch, const char *line)
{
    char cell[3 * PEL_NAME_SIZE];
    int32_t place = 0;
    for (const char *at = line; pel_csv_next(&at, cell, sizeof cell); place++)
        for (int32_t m = 0; m < watch->study->measure_count; m++) {
            const pel_study_measure *measure = &watch->study->measures[m];
            if (measure->column != NULL && strcmp(measure->column, cell) == 0 && !is_wall_time(cell))
                watch->sums[m].place = place;
        }
    watch->has_header = true;
}

static void add_number(column_sum *sum, double value)
{
    if (sum->count == 0)
        *sum = (column_sum){.place = sum->place, .start = value, .least = value, .most = value};
    sum->end = value;
    sum->least = pel_min(sum->least, value);
    sum->most = pel_max(sum->most, value);
    sum->sum += value;
    sum->count++;
}

static void watch_row(void *user, const char *line)
{
    run_watch *watch = user;
    char cell[3 * PEL_NAME_SIZE];
    double value;
    if (!watch->has_header) {
        read_header(watch, line);
        return;
    }
    int32_t place = 0;
    for (const char *at = line; pel_csv_next(&at, cell, sizeof cell); place++)
        for (int32_t m = 0; m < watch->study->measure_count; m++)
            if (watch->sums[m].place == place && pel_number_parse(cell, cell + strlen(cell), &value) != NULL)
                add_number(&watch->sums[m], value);
}

static bool is_wanted(void *user)
{
    const run_watch *watch = user;
    return watch->wanted == NULL || watch->wanted(watch->user);
}

static double column_value(const column_sum *sum, pel_study_at at)
{
    const double values[PEL_STUDY_AT_COUNT] = {sum->start, sum->end, sum->least, sum->most,
                                               sum->sum / (double)sum->count};
    return values[at];
}

/* ---- a run ---- */

pel_status pel_study_scene(const pel_study *study, int64_t run, pel_scene **scene, pel_error *error)
{
    pel_arena arena = {0};
    *scene = NULL;
    const char *const *overrides = pel_study_overrides(study, run, &arena);
    pel_status status = overrides != NULL ? pel_scene_parse(study->scene_path, study->scene_text, study->scene_size,
                                                            overrides, study->axis_count, NULL, scene, error)
                                          : pel_fail_memory(error);
    pel_arena_free(&arena);
    return status;
}

static bool no_step(void *user, const pel_run_progress *progress)
{
    (void)user;
    (void)progress;
    return false;
}

static pel_status fail_column(pel_scene_reader *reader, const pel_study_measure *measure)
{
    if (is_wall_time(measure->column)) {
        pel_scene_fail(reader, &measure->place, "the column '%.80s' is a time of this machine, not a result",
                       measure->column);
        pel_fail_remedy(reader->error, "measure something else; `pellicle bench` measures speed");
        return PEL_BAD_SCENE;
    }
    pel_scene_fail(reader, &measure->place, "the series has no column '%.80s'", measure->column);
    pel_fail_remedy(reader->error, "the first line of series.csv of `pellicle run` names the columns, such as time, "
                                   "max_force, and TOOL_force of a tool");
    return PEL_BAD_SCENE;
}

static bool has_columns(const pel_study *study)
{
    bool any = false;
    for (int32_t m = 0; m < study->measure_count; m++)
        any |= study->measures[m].column != NULL;
    return any;
}

static bool has_key(const pel_study *study, const char *name)
{
    bool any = false;
    for (int32_t m = 0; m < study->measure_count; m++)
        any |= study->measures[m].column == NULL && strcmp(summary_keys[study->measures[m].key].name, name) == 0;
    return any;
}

/* what no row of the study says */
static unsigned find_skips(const pel_study *study)
{
    unsigned needs = has_columns(study) ? EVERYTHING : 0;
    for (int32_t m = 0; m < study->measure_count; m++)
        needs |= study->measures[m].column == NULL ? summary_keys[study->measures[m].key].needs : 0;
    return EVERYTHING & ~needs;
}

bool pel_study_measure_is_codes(const pel_study_measure *measure)
{
    return measure->column == NULL && summary_keys[measure->key].kind == KEY_CODES;
}

bool pel_study_measure_expects(const pel_study_measure *measure)
{
    if (measure->column != NULL)
        return measure->at != PEL_STUDY_START;
    return measure->place.line > 0 && summary_keys[measure->key].kind == KEY_DOUBLE;
}

pel_status pel_study_check_columns(pel_scene_reader *reader, const pel_study *study)
{
    if (!has_columns(study))
        return PEL_OK;
    run_watch watch = {.study = study};
    pel_scene *scene = NULL;
    watch.sums = pel_arena_take(reader->arena, (size_t)study->measure_count, sizeof *watch.sums);
    pel_run_summary *summary = pel_arena_take(reader->arena, 1, sizeof *summary);
    if (watch.sums == NULL || summary == NULL)
        return pel_fail_memory(reader->error);
    for (int32_t m = 0; m < study->measure_count; m++)
        watch.sums[m].place = -1;
    pel_status status = pel_study_scene(study, 0, &scene, reader->error);
    if (status != PEL_OK)
        return status;
    pel_run_def def = pel_run_def_default();
    pel_error error;
    def.thread_count = 1;
    def.row = watch_row;
    def.user = &watch;
    def.progress = no_step;
    status = pel_run(scene, &def, summary, &error);
    pel_scene_destroy(scene);
    if (status == PEL_OUT_OF_MEMORY)
        return pel_fail_memory(reader->error);
    for (int32_t m = 0; m < study->measure_count && watch.has_header; m++)
        if (study->measures[m].column != NULL && watch.sums[m].place < 0)
            return fail_column(reader, &study->measures[m]);
    return PEL_OK;
}

/* the error with the scene's name as the study has it: the same text on every machine */
static void put_error(pel_json *row, const pel_study *study, pel_error *error)
{
    char text[ERROR_SIZE];
    /* that of a run with a folder names a checkpoint in it */
    if (study->keep)
        error->remedy[0] = '\0';
    if (strcmp(error->file, study->scene_path) == 0)
        pel_fail_place(error, study->scene_name, error->line, error->column);
    pel_study_put_cell(row, pel_error_text(error, text, sizeof text));
}

static void put_measures(pel_json *row, const pel_study *study, const pel_run_summary *summary, const column_sum *sums)
{
    for (int32_t m = 0; m < study->measure_count; m++) {
        const pel_study_measure *measure = &study->measures[m];
        char text[PEL_NUMBER_SIZE] = "";
        pel_json_print(row, ",");
        if (summary == NULL)
            continue;
        if (measure->column == NULL)
            put_key(row, &summary_keys[measure->key], summary);
        else if (sums[m].count > 0)
            pel_number_print(text, column_value(&sums[m], measure->at));
        pel_json_print(row, "%s", text);
    }
}

static void put_row(pel_json *row, const pel_study *study, int64_t run, const pel_run_summary *summary,
                    const column_sum *sums, const char *status, pel_error *error)
{
    pel_json_print(row, "%" PRId64, run);
    for (int32_t a = 0; a < study->axis_count; a++) {
        const pel_study_axis *axis = &study->axes[a];
        pel_json_print(row, ",");
        pel_study_put_cell(row, axis->values[pel_study_index(study, run, axis->group)]);
    }
    put_measures(row, study, summary, sums);
    pel_json_print(row, ",%s,", status);
    if (error != NULL)
        put_error(row, study, error);
}

/* numbers that the series sums up begin anew */
static void begin_watch(run_watch *watch)
{
    for (int32_t m = 0; m < watch->study->measure_count; m++)
        watch->sums[m] = (column_sum){.place = -1};
    watch->has_header = false;
}

static pel_status run_scene(const pel_study *study, const pel_scene *scene, const char *folder, pel_run_kept *parts,
                            run_watch *watch, pel_run_summary *summary, pel_error *error)
{
    pel_run_def def = pel_run_def_default();
    def.folder = folder;
    def.overwrite = true;
    def.thread_count = 1;
    def.keep_seconds = 0;
    /* a third of a small run; warnings count one that it gives */
    def.skip_intersections = !study->keep && !has_key(study, "self_intersections_final") &&
                             !has_key(study, "warnings") && !has_key(study, "warning_codes");
    def.wanted = watch->wanted != NULL ? is_wanted : NULL;
    def.row = has_columns(study) ? watch_row : NULL;
    def.user = watch;
    begin_watch(watch);
    summary->status = "";
    return pel_run_with(scene, &def, parts, summary, error);
}

static pel_status run_alone(const pel_study *study, int64_t run, const char *folder, run_watch *watch,
                            pel_run_summary *summary, pel_error *error)
{
    pel_scene *scene;
    char path[PEL_STUDY_PATH_SIZE];
    pel_status status = pel_study_scene(study, run, &scene, error);
    if (status != PEL_OK)
        return status;
    bool keeps = folder != NULL && study->keep;
    if (keeps)
        snprintf(path, sizeof path, "%s/runs/%0*" PRId64, folder, (int)FOLDER_DIGITS, run);
    status = run_scene(study, scene, keeps ? path : NULL, NULL, watch, summary, error);
    pel_scene_destroy(scene);
    return status;
}

/* A run that fails is done once more from a scene that was read for it: its error has a place then. */
static pel_status run_kept(const pel_study *study, pel_study_kept *kept, int64_t run, run_watch *watch,
                           pel_run_summary *summary, pel_error *error)
{
    bool patched;
    pel_status status = pel_study_kept_take(study, kept, run, &patched, error);
    kept->parts.skips = find_skips(study);
    if (status == PEL_OK)
        status = run_scene(study, kept->scene, NULL, &kept->parts, watch, summary, error);
    if (status == PEL_OK)
        return status;
    pel_study_kept_drop(kept);
    bool is_told = !patched || status == PEL_OUT_OF_MEMORY;
    return is_told ? status : run_alone(study, run, NULL, watch, summary, error);
}

static pel_status write_row(const pel_study *study, int64_t run, pel_status status, const pel_run_summary *summary,
                            const column_sum *sums, pel_error *cause, char *row)
{
    pel_json text = {0};
    const char *word = summary->status[0] != '\0' ? summary->status : "refused";
    put_row(&text, study, run, status == PEL_OK ? summary : NULL, sums, word, status == PEL_OK ? NULL : cause);
    status = text.failed ? PEL_OUT_OF_MEMORY : PEL_OK;
    if (status == PEL_OK)
        snprintf(row, study->row_size, "%s", text.text);
    pel_json_free(&text);
    return status;
}

/* kept nullable */
static pel_status do_run(const pel_study *study, pel_study_kept *kept, int64_t run, const char *folder,
                         run_watch *watch, char *row, pel_error *error)
{
    pel_error own;
    pel_run_summary *summary = pel_allocate(1, sizeof *summary);
    watch->sums = pel_allocate((size_t)study->measure_count, sizeof *watch->sums);
    pel_status status = PEL_OUT_OF_MEMORY;
    if (summary != NULL && watch->sums != NULL) {
        summary->status = "";
        status = kept != NULL ? run_kept(study, kept, run, watch, summary, &own)
                              : run_alone(study, run, folder, watch, summary, &own);
    }
    if (status == PEL_STOPPED && error != NULL)
        *error = own;
    else if (status != PEL_OUT_OF_MEMORY && status != PEL_STOPPED)
        status = write_row(study, run, status, summary, watch->sums, &own, row);
    pel_free(watch->sums);
    pel_free(summary);
    return status == PEL_OUT_OF_MEMORY ? pel_fail_memory(error) : status;
}

pel_status pel_study_run(const pel_study *study, int64_t run, const char *folder, bool (*wanted)(void *user),
                         void *user, char *row, pel_error *error)
{
    PEL_REFUSE_NULL(study, error);
    PEL_REFUSE_NULL(row, error);
    row[0] = '\0';
    if (run < 0 || run >= study->run_count)
        return pel_fail(error, PEL_BAD_ARGUMENT, "the study has no run %" PRId64, run);
    run_watch watch = {.study = study, .wanted = wanted, .user = user};
    return do_run(study, NULL, run, folder, &watch, row, error);
}

pel_status pel_study_run_kept(const pel_study *study, pel_study_kept *kept, int64_t run, char *row, pel_error *error)
{
    row[0] = '\0';
    run_watch watch = {.study = study};
    return do_run(study, kept, run, NULL, &watch, row, error);
}

pel_status pel_study_lost_run(const pel_study *study, int64_t run, const char *status, const char *what,
                              const char *remedy, char *row, pel_error *error)
{
    PEL_REFUSE_NULL(study, error);
    PEL_REFUSE_NULL(status, error);
    PEL_REFUSE_NULL(what, error);
    PEL_REFUSE_NULL(row, error);
    row[0] = '\0';
    if (run < 0 || run >= study->run_count)
        return pel_fail(error, PEL_BAD_ARGUMENT, "the study has no run %" PRId64, run);
    if (status[0] == '\0' || status[strspn(status, "abcdefghijklmnopqrstuvwxyz")] != '\0' ||
        strlen(status) >= PEL_NAME_SIZE || strcmp(status, "done") == 0)
        return pel_fail(error, PEL_BAD_ARGUMENT, "'%.60s' is not a status of a lost run", status);
    pel_error own = {0};
    pel_json text = {0};
    pel_fail(&own, PEL_STOPPED, "%s", what);
    if (remedy != NULL)
        pel_fail_remedy(&own, "%s", remedy);
    put_row(&text, study, run, NULL, NULL, status, &own);
    bool is_whole = !text.failed;
    if (is_whole)
        snprintf(row, study->row_size, "%s", text.text);
    pel_json_free(&text);
    return is_whole ? PEL_OK : pel_fail_memory(error);
}

size_t pel_study_row_size(const pel_study *study)
{
    return study != NULL ? study->row_size : 0;
}
