/* series.csv: one row per frame, added as the run goes. The file always ends with a whole row. */
#ifndef PEL_RESULTS_SERIES_H
#define PEL_RESULTS_SERIES_H

#include "pellicle/run.h"
#include "pellicle/sim_contact.h"
#include "pellicle/sim_ledger.h"

typedef struct pel_run_series {
    int descriptor;      /* -1 = closed */
    int64_t size;        /* bytes of whole rows in the file */
    char *line;          /* the row being made */
    size_t length, room; /* of the line */
    const char *path;    /* the caller's */
    /* at the start, which the columns are of: a session adds tools and pins */
    int32_t tool_count;
    uint8_t *has_pins; /* (bodies): a cut makes another model */
} pel_run_series;

/* One row; the tools' present readings come from the sim. */
typedef struct pel_run_row {
    int64_t frame;
    double step_ms; /* mean wall time of a step since the last frame */
    pel_sim_measures measures;
    pel_sim_ledger ledger;
    pel_contact_statistics contact, contact_before; /* sums now and at the last frame; the row has the difference */
    const double *tool_force_max;                   /* (tool count) N, largest since the last frame */
} pel_run_row;

/* Begins a new file with the header row; path null: makes the rows only, for `line`. Close also on failure. */
pel_status pel_run_series_create(pel_run_series *series, const char *path, const pel_sim *sim, pel_error *error);

/* Continues the file after its first row_count rows and removes the others. PEL_BAD_FORMAT if it has fewer rows or
   other columns; the file is not changed then. */
pel_status pel_run_series_resume(pel_run_series *series, const char *path, const pel_sim *sim, int64_t row_count,
                                 pel_error *error);

/* Makes the text of a row of the present state, and adds it to the file; on failure the file is as it was. */
void pel_run_series_make(pel_run_series *series, pel_sim *sim, const pel_run_row *row);
pel_status pel_run_series_add(pel_run_series *series, pel_error *error);

void pel_run_series_close(pel_run_series *series);

#endif
