/* Pellicle: studies: many runs of one scene with different parameters, and one table with a row for each run.

   A study file (YAML 1.2 or JSON):

       scene: press.yaml                                   # beside the study
       vary:                                               # keys as after --set of `pellicle run`
         bodies.ball.springs.stiffness: [1, 2, 5]          # a list of values, or
         solver.dt: { from: 0.001, to: 0.01, count: 4, scale: log }
       measure:
         depth: max_displacement                           # a key of summary.json, or
         peak: { column: probe_force, at: max }            # a column of series.csv: start, end, min, max or mean
       keep: false                                         # true keeps the folder of each run in runs/

   Each entry of `vary` is combined with all others. `{ sobol: n, from: a, to: b }` and `{ latin: n, from: a, to: b }`
   sample: all entries of one kind are the dimensions of the same n points. Where `vary` is a list of maps, the entries
   of one map go together (the first values of all, then the second ones, ...), and the maps are combined.

   The table does not depend on threads, chunks or machines. In the library pellicle_scene. */
#ifndef PELLICLE_STUDY_H
#define PELLICLE_STUDY_H

#include "base.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A study that was read and checked; it never changes, and threads may share it. */
typedef struct pel_study pel_study;

/* Reads a study file and its scene. The scene is checked with the values of the first run, so that a wrong key fails
   here. On failure *study is null. Free with pel_study_destroy; null is fine there.
   Errors: PEL_BAD_SCENE with file:line:column and remedy; PEL_BAD_FILE for the study, and at its place in the study for
   the scene; PEL_OUT_OF_MEMORY. */
PEL_API pel_status pel_study_load(const char *path, pel_study **study, pel_error *error);
PEL_API void pel_study_destroy(pel_study *study);

/* The same from text (size bytes); path stands for it in messages and gives the folder of the scene. */
PEL_API pel_status pel_study_parse(const char *path, const char *text, size_t size, pel_study **study,
                                   pel_error *error);

PEL_API int64_t pel_study_run_count(const pel_study *study);

/* The first line of the table, without a newline: run, the keys that vary, the names of the measures, status, error.
   Lives as long as the study. */
PEL_API const char *pel_study_header(const pel_study *study);

/* bytes that a row takes at most, terminating zero included */
PEL_API size_t pel_study_row_size(const pel_study *study);

/* Does run 0 .. run_count - 1 with one thread and writes its row (pel_study_row_size bytes), without a newline. A run
   that fails is a row too: its status is "diverged", "failed" or "refused" and its measures are empty.
   folder (nullable) is that of the study, for a study that keeps the folders of its runs. wanted (nullable) is asked
   after each step; false stops the run. Any thread may call it.
   Errors: PEL_STOPPED, PEL_BAD_ARGUMENT (no such run), PEL_OUT_OF_MEMORY. */
PEL_API pel_status pel_study_run(const pel_study *study, int64_t run, const char *folder, bool (*wanted)(void *user),
                                 void *user, char *row, pel_error *error);

/* Writes the row (pel_study_row_size bytes) of a run that left none itself, because its process crashed or was stopped:
   status is a word, such as "crashed" or "timeout"; the error is what and, where it is not null, remedy; the measures
   are empty. Errors: PEL_BAD_ARGUMENT (no such run, "done" or no word), PEL_OUT_OF_MEMORY. */
PEL_API pel_status pel_study_lost_run(const pel_study *study, int64_t run, const char *status, const char *what,
                                      const char *remedy, char *row, pel_error *error);

/* The folder of a study: rows/ with the rows by chunk, each added as soon as its run ends; at the end runs.csv with all
   of them in the order of the runs, and report.html. */
typedef struct pel_study_store pel_study_store;

/* Opens the folder, made with its parents when missing, to do the runs of chunk 1 .. chunk_count: every chunk_count-th
   run from run chunk - 1 on. A row that was being written when the program was killed is cut off. On failure *store is
   null. The study has to live as long. Free with pel_study_store_close; null is fine there.
   Errors: PEL_BAD_ARGUMENT (chunk); PEL_BAD_FILE (not writable; another program does this chunk; the folder holds rows
   of another study, scene or version); PEL_OUT_OF_MEMORY. */
PEL_API pel_status pel_study_store_open(const pel_study *study, const char *folder, int32_t chunk, int32_t chunk_count,
                                        pel_study_store **store, pel_error *error);
PEL_API void pel_study_store_close(pel_study_store *store);

/* Whether the run is of this chunk and no chunk had its row when the folder was opened. */
PEL_API bool pel_study_store_needs(const pel_study_store *store, int64_t run);

/* Whether the run is of this chunk and the row that it had when the folder was opened is that of a run that failed. */
PEL_API bool pel_study_store_failed(const pel_study_store *store, int64_t run);

/* Adds a row of pel_study_run. Of several rows of one run the one that is done counts, else the last. One thread at a
 * time. PEL_BAD_FILE; PEL_BAD_ARGUMENT when the text is not a row. */
PEL_API pel_status pel_study_store_add(pel_study_store *store, const char *row, pel_error *error);

/* Reads the rows of all chunks; writes runs.csv and report.html when none is missing. *missing and *failed (nullable)
   receive the runs without a row and those that failed. PEL_BAD_FILE, PEL_OUT_OF_MEMORY. */
PEL_API pel_status pel_study_store_collect(pel_study_store *store, int64_t *missing, int64_t *failed, pel_error *error);

typedef struct pel_study_progress {
    int64_t done, total; /* runs of this call */
    int64_t failed;      /* of those done */
    double remaining;    /* s of wall time; -1 = not known yet */
} pel_study_progress;

typedef struct pel_study_def {
    const char *folder;
    int32_t thread_count;       /* runs at a time; 0 = the processors of this machine */
    int32_t chunk, chunk_count; /* as in pel_study_store_open */
    double run_seconds;         /* s of wall time that a run may take; 0 = any */
    bool retry;                 /* does runs again that failed when the folder was opened */
    /* Called after each run. Nullable. */
    void (*progress)(void *user, const pel_study_progress *progress);
    bool (*wanted)(void *user); /* asked 20 times a second and after each run; false stops. Nullable */
    void *user;
    uint32_t cookie; /* set by pel_study_def_default */
} pel_study_def;

/* No folder yet, all processors, one chunk, no limits, no hooks. */
PEL_API pel_study_def pel_study_def_default(void);

typedef struct pel_study_summary {
    int64_t runs;    /* of the study */
    int64_t present; /* rows that were there before */
    int64_t done;    /* by this call */
    int64_t missing; /* still, of all chunks; 0: the table is written */
    int64_t failed;  /* rows of runs that failed */
} pel_study_summary;

/* Does all runs of the chunk that are needed, each in a process that is forked from this one. A run that crashes or is
   killed is done once more, then it is a row with the status "crashed"; one that takes more than run_seconds is a row
   with the status "timeout", one that is out of memory with the status "failed". The hooks are called by this thread.
   summary is nullable. Errors: those of the functions above, PEL_OUT_OF_MEMORY where no process can be started; after
   these and after PEL_STOPPED the same call continues. */
PEL_API pel_status pel_study_execute(const pel_study *study, const pel_study_def *def, pel_study_summary *summary,
                                     pel_error *error);

/* Reads a fit file (docs/sweeps.md), checks its keys, and gives it as JSON for `pellicle.calibrate`, with the paths of
   files made absolute. On failure *json is null. Free with pel_fit_destroy; null is fine there.
   Errors: PEL_BAD_SCENE with file:line:column, PEL_BAD_FILE, PEL_OUT_OF_MEMORY. */
PEL_API pel_status pel_fit_load(const char *path, char **json, pel_error *error);
PEL_API void pel_fit_destroy(char *json);

#ifdef __cplusplus
}
#endif
#endif
