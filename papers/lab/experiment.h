/* An experiment of `pellicle reproduce`: it runs scenes into a folder of its own, draws them, and states claims
   (claim.h). */
#ifndef PAPERS_LAB_EXPERIMENT_H
#define PAPERS_LAB_EXPERIMENT_H

#include "papers/lab/claim.h"
#include "papers/lab/plot.h"

#include <pellicle/error.h>
#include <pellicle/frames.h>
#include <pellicle/run.h>

enum { LAB_PATH_SIZE = PEL_RUN_PATH_SIZE };

typedef struct lab_image {
    char file[24]; /* in the folder of the experiment */
    char caption[160];
} lab_image;

/* A table of an experiment: its cells are parted by '|'. */
typedef struct lab_row {
    char cells[240];
    bool is_head;      /* begins a table: the names of its columns */
    char caption[200]; /* of a head */
} lab_row;

/* A running experiment and its results. */
struct lab_experiment {
    const char *name, *doc, *group, *place;
    const char *folder; /* exists */
    pel_error *error;
    const struct lab_body *bodies; /* (body_count) papers/lab/body.h */
    int body_count;
    bool given_bodies; /* the experiment has bodies of the user: a paper's claims and the stored numbers (stored.h) need
                          not hold */
    bool is_incomplete; /* memory was out for a claim, a number or an image */
    lab_claim *claims;  /* (claim_count) */
    lab_finding *findings;
    lab_image *images;
    lab_row *rows; /* (row_count) of its tables */
    int claim_count, finding_count, image_count, row_count;
    int plot_count, picture_count;
    double seconds; /* that it took */
    /* called before each run; null = quiet */
    void (*progress)(void *user, const char *experiment, const char *run);
    void *user; /* of progress */
};

typedef struct lab_case {
    const char *name;
    const char *doc;   /* one line */
    const char *group; /* "paper A", "paper B" or "own" */
    const char *place; /* in the paper: section and number of the figure or table; null in own checks */
    lab_origin origin; /* of findings that are added before any claim */
    pel_status (*run)(lab_experiment *experiment);
} lab_case;

/* Runs a case in its folder, writes numbers.csv there and takes the time. The experiment has its folder, bodies and
   error; lab_clear frees the rest, also after a failure. */
pel_status lab_run_case(const lab_case *which, lab_experiment *experiment);
void lab_clear(lab_experiment *experiment);

/* Adds a zeroed item of size bytes to items, of which there are *count. Null when memory is out: the experiment is
   incomplete then. */
void *lab_add_item(lab_experiment *experiment, void **items, int *count, size_t size);

/* Begins a table with these columns, parted by '|'; adds a row to the last one. */
void lab_begin_table(lab_experiment *experiment, const char *caption, const char *columns);
void lab_add_row(lab_experiment *experiment, const char *cells);

/* folder/name in path (LAB_PATH_SIZE bytes); returns path */
const char *lab_path(const lab_experiment *experiment, const char *name, char *path);

/* ---- runs ---- */

/* tells the progress that a run begins */
void lab_tell_run(const lab_experiment *experiment, const char *run);

/* Runs a scene, given as text with overrides (null-terminated list, nullable), into folder/name. */
pel_status lab_run(lab_experiment *experiment, const char *name, const char *scene, const char *const *overrides,
                   pel_run_summary *summary);

/* the mesh at the end of a run */
pel_status lab_read_final(const lab_experiment *experiment, const char *run, pel_mesh **mesh);

/* Two columns of the series of a run. */
typedef struct lab_series {
    const double *x, *y; /* (count) */
    int count;
    pel_series *read; /* holds both */
} lab_series;

pel_status lab_read_series(const lab_experiment *experiment, const char *run, const char *x_name, const char *y_name,
                           lab_series *series);
void lab_free_series(lab_series *series);

/* ---- pictures ---- */

/* Writes the next plot: folder/plot.svg, plot-2.svg, ... */
pel_status lab_add_plot(lab_experiment *experiment, const lab_plot *plot);

/* The next plot: two columns of the series of runs (run_count, the first LAB_CURVES of them). */
typedef struct lab_run_plot {
    const char *title, *x_name, *y_name, *x_column, *y_column;
    const char *const *runs, *const *labels;
    int run_count;
} lab_run_plot;

pel_status lab_plot_runs(lab_experiment *experiment, const lab_run_plot *plot);

enum { LAB_PICTURE_RUNS = 8, LAB_PICTURE_FRAMES = 6 };

/* The next picture, folder/picture.png, picture-2.png, ...: runs as rows, frames as columns. A program built without
   pictures draws none. */
typedef struct lab_picture {
    const char *caption;
    const char *runs[LAB_PICTURE_RUNS], *labels[LAB_PICTURE_RUNS];
    int run_count;
    int frames[LAB_PICTURE_FRAMES];
    int frame_count;
    int columns;        /* 0 = a row for each run */
    const char *field;  /* null = displacement */
    const char *unit;   /* of the field; null = the unit of known quantities */
    int component;      /* of a vector field, from 1; 0 = magnitude */
    double range[2];    /* range of the colours; equal ends = range of the data */
    const char *arrows; /* nullable */
    double azimuth, elevation;
    bool edges, times; /* times instead of frame numbers */
} lab_picture;

pel_status lab_add_picture(lab_experiment *experiment, const lab_picture *picture);

#endif
