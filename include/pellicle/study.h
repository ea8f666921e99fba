/* Pellicle: studies: many runs of one scene with different parameters, and one table with a row for each run.

   A study file (YAML 1.2 or JSON):

       scene: press.yaml                                   # relative to the folder of the study
       vary:                                               # keys as for --set of `pellicle run`
         bodies.ball.springs.stiffness: [1, 2, 5]          # a list of values, or
         solver.dt: { from: 0.001, to: 0.01, count: 4, scale: log }
       measure:
         depth: max_displacement                           # a key of summary.json, or
         peak: { column: probe_force, at: max }            # a column of series.csv: start, end, min, max or mean
       keep: false                                         # true keeps the folder of each run in runs/

   All values of an entry of `vary` are combined with all values of the others. `{ sobol: n, from: a, to: b }` and
   `{ latin: n, from: a, to: b }` sample the interval from a to b: all entries of the same kind are the dimensions of n
   common points. If `vary` is a list of maps, the entries of one map vary together (the first values of all, then the
   second ones, ...), and the maps are combined.

   The table does not depend on threads, chunks or machines. In the library pellicle_scene. */
#ifndef PELLICLE_STUDY_H
#define PELLICLE_STUDY_H

#include "base.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A validated study; immutable, threads may share it. */
typedef struct pel_study pel_study;

/* Reads a study file and its scene. The scene is validated with the values of the first run, so a wrong key fails
   here. On failure *study is null. Free with pel_study_destroy, which permits null.
   Errors: PEL_BAD_SCENE with file:line:column and remedy; PEL_BAD_FILE for the study, and at its place in the study for
   the scene; PEL_OUT_OF_MEMORY. */
PEL_API pel_status pel_study_load(const char *path, pel_study **study, pel_error *error);
PEL_API void pel_study_destroy(pel_study *study);

/* The same from text (size bytes). path is its name in messages; the scene is relative to the folder of path. */
PEL_API pel_status pel_study_parse(const char *path, const char *text, size_t size, pel_study **study,
                                   pel_error *error);

PEL_API int64_t pel_study_run_count(const pel_study *study);

/* The first line of the table, without a newline: run, the keys that vary, the names of the measures, status, error.
   Lives as long as the study. */
PEL_API const char *pel_study_header(const pel_study *study);

/* Maximum size of a row in bytes, including the terminating zero. */
PEL_API size_t pel_study_row_size(const pel_study *study);

/* Executes run 0 .. run_count - 1 with one thread and writes its row (pel_study_row_size bytes), without a newline. A
   run that fails also gives a row: its status is "diverged", "failed" or "refused" and its measures are empty. folder
   (nullable) is the folder of the study; it is needed if the study keeps the folders of its runs. wanted (nullable) is
   called after each step; returning false stops the run. Any thread may call it. Errors: PEL_STOPPED, PEL_BAD_ARGUMENT
   (no such run), PEL_OUT_OF_MEMORY. */
PEL_API pel_status pel_study_run(const pel_study *study, int64_t run, const char *folder, bool (*wanted)(void *user),
                                 void *user, char *row, pel_error *error);

/* Writes the row (pel_study_row_size bytes) of a run whose process crashed or was stopped: status is a word, such as
   "crashed" or "timeout"; the error is `what` and, if not null, `remedy`; the measures are empty. Errors:
   PEL_BAD_ARGUMENT (no such run, "done" or no word), PEL_OUT_OF_MEMORY. */
PEL_API pel_status pel_study_lost_run(const pel_study *study, int64_t run, const char *status, const char *what,
                                      const char *remedy, char *row, pel_error *error);

/* The folder of a study: rows/ with the rows by chunk, each added when its run ends; at the end runs.csv with all
   rows in the order of the runs, and report.html. */
typedef struct pel_study_store pel_study_store;

/* Opens the folder, created with its parents if missing, for the runs of chunk 1 .. chunk_count: every chunk_count-th
   run from run chunk - 1 on. An incomplete row of a killed program is removed. On failure *store is null. The study
   must outlive the store. Free with pel_study_store_close, which permits null. Errors: PEL_BAD_ARGUMENT (chunk);
   PEL_BAD_FILE (not writable; another program runs this chunk; the folder holds rows of another study, scene or
   version); PEL_OUT_OF_MEMORY. */
PEL_API pel_status pel_study_store_open(const pel_study *study, const char *folder, int32_t chunk, int32_t chunk_count,
                                        pel_study_store **store, pel_error *error);
PEL_API void pel_study_store_close(pel_study_store *store);

/* Whether the run belongs to this chunk and had no row when the folder was opened, or its rows were collected, last. */
PEL_API bool pel_study_store_needs(const pel_study_store *store, int64_t run);

/* Whether the run belongs to this chunk and had only rows of failed runs then. */
PEL_API bool pel_study_store_failed(const pel_study_store *store, int64_t run);

/* Adds a row of pel_study_run. Of several rows of one run the one with status "done" counts, else the last. One thread
 * at a time. PEL_BAD_FILE; PEL_BAD_ARGUMENT if the text is not a row. */
PEL_API pel_status pel_study_store_add(pel_study_store *store, const char *row, pel_error *error);

/* Reads the rows of all chunks; writes runs.csv and report.html if none is missing. *missing and *failed (nullable)
   receive the numbers of runs without a row and of failed runs. PEL_BAD_FILE, PEL_OUT_OF_MEMORY. */
PEL_API pel_status pel_study_store_collect(pel_study_store *store, int64_t *missing, int64_t *failed, pel_error *error);

typedef struct pel_study_progress {
    int64_t done, total; /* runs of this call */
    int64_t failed;      /* of those done */
    double remaining;    /* s of wall time; -1 = unknown */
} pel_study_progress;

typedef struct pel_study_def {
    const char *folder;
    int32_t thread_count;       /* simultaneous runs; 0 = the processors of this machine */
    int32_t chunk, chunk_count; /* as in pel_study_store_open */
    double run_seconds;         /* s of wall time, limit of a run; 0 = none */
    bool retry;                 /* repeats runs that had failed when the folder was opened */
    /* Called after each run. Nullable. */
    void (*progress)(void *user, const pel_study_progress *progress);
    bool (*wanted)(void *user); /* called 20 times a second and after each run; false stops. Nullable */
    void *user;
    uint32_t cookie; /* set by pel_study_def_default */
} pel_study_def;

/* No folder, all processors, one chunk, no limits, no callbacks. */
PEL_API pel_study_def pel_study_def_default(void);

enum { PEL_STUDY_ZEROS_SIZE = 200, PEL_STUDY_WARNINGS_SIZE = 600 };

typedef struct pel_study_summary {
    int64_t runs;    /* of the study */
    int64_t present; /* rows present before */
    int64_t done;    /* by this call */
    int64_t missing; /* missing rows of all chunks; 0: the table is written */
    int64_t failed;  /* rows of runs that failed */
    /* names, separated by commas as far as they fit, of the study's measures that are 0 in every run, such as the force
       on a tool that never touches a body; "" while runs are missing */
    char zeros[PEL_STUDY_ZEROS_SIZE];
    /* "CODE in N runs", separated by commas as far as they fit, of the warnings of runs that are done, where the
       measure warning_codes (one of the default) has them; "" while runs are missing */
    char warnings[PEL_STUDY_WARNINGS_SIZE];
} pel_study_summary;

/* Executes all missing runs of the chunk, each in a process forked from this one. A run that crashes or is killed is
   repeated once, then gets a row with the status "crashed"; a run longer than run_seconds gets "timeout", one without
   memory "failed". This thread calls the callbacks. summary is nullable. Errors: those of the functions above,
   PEL_OUT_OF_MEMORY if no process can be started; after an error or PEL_STOPPED the same call continues. */
PEL_API pel_status pel_study_execute(const pel_study *study, const pel_study_def *def, pel_study_summary *summary,
                                     pel_error *error);

/* Reads a fit file (docs/sweeps.md), validates its keys, and returns it as JSON for `pellicle.calibrate`, with absolute
   paths. On failure *json is null. Free with pel_fit_destroy, which permits null.
   Errors: PEL_BAD_SCENE with file:line:column, PEL_BAD_FILE, PEL_OUT_OF_MEMORY. */
PEL_API pel_status pel_fit_load(const char *path, char **json, pel_error *error);
PEL_API void pel_fit_destroy(char *json);

#ifdef __cplusplus
}
#endif
#endif
