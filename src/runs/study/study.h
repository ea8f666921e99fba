/* Internals of a study, shared by its parts. */
#ifndef PEL_STUDY_STUDY_H
#define PEL_STUDY_STUDY_H

#include "io/file.h"
#include "io/json.h"
#include "keys/value.h"
#include "pellicle/scene.h"
#include "pellicle/study.h"

/* room for any path in the folder of a study */
enum { PEL_STUDY_PATH_SIZE = 3200 };

/* runs of a study at most */
enum { PEL_STUDY_MOST_RUNS = 10000000 };

/* A parameter that varies. Axes of one group go together: the run takes the same index of all of them. */
typedef struct pel_study_axis {
    const char *path;          /* as after --set */
    const char *const *values; /* (count) YAML */
    int64_t count;
    int32_t group;
    pel_scene_place place;
} pel_study_axis;

typedef enum pel_study_at {
    PEL_STUDY_START,
    PEL_STUDY_END,
    PEL_STUDY_MIN,
    PEL_STUDY_MAX,
    PEL_STUDY_MEAN,
    PEL_STUDY_AT_COUNT
} pel_study_at;

/* A number that is kept of each run: of the summary, or of a column of the series. */
typedef struct pel_study_measure {
    const char *name;
    int32_t key;        /* of the summary (measure.h); -1 = a column */
    const char *column; /* null = of the summary */
    pel_study_at at;
    pel_scene_place place;
} pel_study_measure;

struct pel_study {
    pel_arena arena;
    const char *path;
    const char *scene_name; /* as the study names it, for messages */
    const char *scene_path;
    char *scene_text;
    size_t scene_size;
    pel_study_axis *axes;
    int32_t axis_count, group_count;
    int64_t *group_sizes; /* (group_count) the last group changes fastest */
    int64_t run_count;
    pel_study_measure *measures;
    int32_t measure_count;
    bool keep;
    const char *header;
    size_t row_size;
    uint64_t fingerprint; /* of all that rows depend on */
};

/* the index that a run takes of the axes of a group */
int64_t pel_study_index(const pel_study *study, int64_t run, int32_t group);

/* The overrides (axis_count) of a run, in the arena. Null when out of memory. */
const char *const *pel_study_overrides(const pel_study *study, int64_t run, pel_arena *arena);

/* ---- design.c ---- */

/* Reads `vary` into axes and groups. */
pel_status pel_study_read_vary(pel_scene_reader *reader, const pel_scene_value *vary, pel_study *study);

/* ---- measure.c ---- */

/* Reads `measure` (null: the usual ones). */
pel_status pel_study_read_measures(pel_scene_reader *reader, const pel_scene_value *measure, pel_study *study);

/* Loads the scene of a run. */
pel_status pel_study_scene(const pel_study *study, int64_t run, pel_scene **scene, pel_error *error);

/* Whether the study asks for the measure by name and it is a quantity, not a count, after the start. */
bool pel_study_measure_expects(const pel_study_measure *measure);

/* The measure is the codes of the warnings of a run, with spaces. */
bool pel_study_measure_is_codes(const pel_study_measure *measure);

/* Starts the first run and refuses columns that its series lacks; a run that cannot start has its error in its row. */
pel_status pel_study_check_columns(pel_scene_reader *reader, const pel_study *study);

/* ---- store.c ---- */

/* Names of measures that the study asks for and that are 0 in all runs, with commas, as far as they fit; "" before
   pel_study_store_collect finds all rows. Lives as long as the store. */
const char *pel_study_store_zeros(const pel_study_store *store);
/* The same of warnings: "CODE in N runs" with commas, of the runs that are done. */
const char *pel_study_store_warnings(const pel_study_store *store);

/* whether the status of a row is "done" */
bool pel_study_row_is_done(const char *row);
/* pel_study_store_add in two steps: many rows, then one write. The errors of both are those of pel_study_store_add. */
pel_status pel_study_store_gather(pel_study_store *store, const char *row, pel_error *error);
pel_status pel_study_store_flush(pel_study_store *store, pel_error *error);

/* ---- page.c ---- */

/* The report of the table as one HTML page: open, then each row without its newline, then commit or abandon. */
typedef struct pel_study_page {
    pel_file_writer writer;
    pel_json json;
    int64_t row_count;
} pel_study_page;

/* On failure (PEL_BAD_FILE, PEL_OUT_OF_MEMORY) there is nothing to close. */
pel_status pel_study_page_open(pel_study_page *page, const pel_study *study, const char *path, pel_error *error);
void pel_study_page_put(pel_study_page *page, const char *row);
/* Writes the rest. Closes the page also on failure. */
pel_status pel_study_page_commit(pel_study_page *page, pel_error *error);
void pel_study_page_abandon(pel_study_page *page);

/* ---- keys.c ---- */

/* Refuses keys that are none of `known` (known_count), and keys that stand twice. */
pel_status pel_study_check_keys(pel_scene_reader *reader, const pel_scene_value *map, const char *what,
                                const char *const *known, size_t known_count);
/* PEL_BAD_SCENE unless the value is a map; what: "a fit", ... */
pel_status pel_study_need_map(pel_scene_reader *reader, const pel_scene_value *value, const char *what);
/* The text of a scalar that is not empty. */
pel_status pel_study_need_text(pel_scene_reader *reader, const pel_scene_value *value, const char **text);
pel_status pel_study_need_number(pel_scene_reader *reader, const pel_scene_value *value, double *number);
/* least .. most */
pel_status pel_study_need_integer(pel_scene_reader *reader, const pel_scene_value *value, double least, double most,
                                  int64_t *number);
/* the index of the text in words (count) */
pel_status pel_study_need_word(pel_scene_reader *reader, const pel_scene_value *value, const char *const *words,
                               size_t count, int32_t *word);
/* A path relative to the folder of `beside`, in the arena. Null when out of memory. */
const char *pel_study_resolve(pel_scene_reader *reader, const char *beside, const char *path);
/* Tells the error of a file that cannot be read at the place that names it. */
void pel_study_fail_file(pel_scene_reader *reader, const pel_scene_value *value);
/* A value in one line, in the brackets of JSON, with scalars as put_scalar writes them. */
void pel_study_put_value(pel_json *json, const pel_scene_value *value,
                         void (*put_scalar)(pel_json *json, const pel_scene_value *scalar));
/* The text of a cell of a CSV file, in quotes where it needs them. What begins with = + - @ or a tab and is no number
   begins with ' then, so that spreadsheets show it and compute nothing (OWASP, CSV injection). */
void pel_study_put_cell(pel_json *json, const char *text);

#endif
