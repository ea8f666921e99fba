/* Experiments of `pellicle reproduce`. Each runs scenes and gives claims: a statement of a paper, the theory or a
   reference, the measured numbers, and the verdict. */
#ifndef PELLICLE_CLI_EXPERIMENT_H
#define PELLICLE_CLI_EXPERIMENT_H

#include "diagnostics.h"
#include "plot.h"

#include <pellicle/frames.h>
#include <pellicle/run.h>
#include <pellicle/topology.h>

enum {
    CLI_EXPERIMENT_NUMBERS = 320,
    CLI_EXPERIMENT_CLAIMS = 16,
    CLI_EXPERIMENT_IMAGES = 24,
    CLI_EXPERIMENT_PATH = PEL_RUN_PATH_SIZE,
    CLI_BODIES = 8
};

/* Source of a claim. */
typedef enum cli_origin {
    CLI_PAPER,      /* paper A or B says it */
    CLI_THEORY,     /* mechanics, a closed form */
    CLI_REFERENCE,  /* a computation apart from this program, or a published number of others */
    CLI_REGRESSION, /* an earlier result of this program: not a truth, but changes must be noticed */
    CLI_ORIGINS
} cli_origin;

typedef enum cli_relation { CLI_TOLD, CLI_EQUAL, CLI_AT_MOST, CLI_AT_LEAST } cli_relation;

/* A measured number and its expected value. */
typedef struct cli_finding {
    char name[96];
    double value, expected; /* expected is NaN if there is none */
    double tolerance;       /* CLI_EQUAL: largest difference that counts as equal */
    cli_relation relation;  /* CLI_TOLD = not judged */
    const char *source;     /* of the expected number; a literal */
    int claim;              /* that it is judged for */
} cli_finding;

/* Findings that are added after a claim are judged for it. */
typedef struct cli_claim {
    cli_origin origin;
    const char *says;   /* one sentence without a full stop; a literal */
    const char *reason; /* why a paper's claim does not hold here, when that is known; nullable, a literal */
} cli_claim;

typedef enum cli_verdict {
    CLI_ONLY_TOLD, /* nothing was judged */
    CLI_HOLDS,
    CLI_DIFFERS, /* a paper's claim that does not hold for a known reason, or on a mesh of the user */
    CLI_FAILS
} cli_verdict;

/* A closed surface that experiments of paper B shrink. */
typedef struct cli_body {
    char name[40];
    char mesh[CLI_EXPERIMENT_PATH + 160]; /* the setting of bodies.0.mesh: about 2 m long, z up */
    double pressure;                      /* outside, in proportion to the length of the edges [Pa] */
    char *cap;                            /* the setting of the region of fibres: the part of the surface about its
                                             roundest vertex */
    double cap_center[3], cap_radius;     /* that vertex, and the ball that the part lies in */
} cli_body;

typedef struct cli_image {
    char file[24]; /* in the folder of the experiment */
    char caption[160];
} cli_image;

/* A running experiment and its results. */
typedef struct cli_experiment {
    const char *name, *doc;
    const char *folder; /* exists */
    pel_error *error;
    const cli_body *bodies; /* (body_count) */
    int body_count;
    bool given_mesh; /* the body is the user's: a paper's claims need not hold on it */
    cli_claim claims[CLI_EXPERIMENT_CLAIMS];
    int claim_count;
    cli_finding findings[CLI_EXPERIMENT_NUMBERS];
    int finding_count;
    cli_image images[CLI_EXPERIMENT_IMAGES];
    int image_count, plot_count, picture_count;
    double seconds; /* that it took */
    /* called before each run; null = quiet */
    void (*progress)(const struct cli_experiment *experiment, const char *run);
} cli_experiment;

typedef struct cli_experiment_case {
    const char *name;
    const char *doc;   /* one line */
    const char *group; /* "paper A", "paper B" or "own" */
    cli_origin origin; /* of findings that are added before any claim */
    pel_status (*run)(cli_experiment *experiment);
} cli_experiment_case;

/* folder/name in path (CLI_EXPERIMENT_PATH bytes); returns path */
const char *cli_experiment_path(const cli_experiment *experiment, const char *name, char *path);

/* ---- claims and numbers ---- */

/* Begins a claim. reason is nullable. */
void cli_experiment_claim(cli_experiment *experiment, cli_origin origin, const char *says, const char *reason);
/* A number that has to be `expected` up to the tolerance. */
void cli_experiment_check(cli_experiment *experiment, const char *name, double value, double expected, double tolerance,
                          const char *source);
/* A number that has to be at most, or at least, `limit`. */
void cli_experiment_limit(cli_experiment *experiment, const char *name, double value, double limit, const char *source);
void cli_experiment_least(cli_experiment *experiment, const char *name, double value, double limit, const char *source);
/* A number that is reported next to another one, or NaN, without a verdict: it depends on the machine, or on values
   missing in the paper. */
void cli_experiment_tell(cli_experiment *experiment, const char *name, double value, double expected,
                         const char *source);

bool cli_finding_holds(const cli_finding *finding);
cli_verdict cli_claim_verdict(const cli_experiment *experiment, int claim);
/* the worst of its claims */
cli_verdict cli_experiment_verdict(const cli_experiment *experiment);
/* "holds (3 of 3)", "differs (1 of 3): why"; returns text */
const char *cli_claim_text(const cli_experiment *experiment, int claim, char *text, size_t size);
const char *cli_verdict_name(cli_verdict verdict);
const char *cli_origin_name(cli_origin origin);

/* ---- runs ---- */

/* Runs a scene, given as text with overrides (null-terminated list), into folder/name. */
pel_status cli_experiment_run(cli_experiment *experiment, const char *name, const char *scene,
                              const char *const *overrides, pel_run_summary *summary);

/* Two columns of the series of a run. */
typedef struct cli_series {
    const double *x, *y; /* (count) */
    int count;
    pel_series *read; /* holds both */
} cli_series;

pel_status cli_series_read(const cli_experiment *experiment, const char *run, const char *x_name, const char *y_name,
                           cli_series *series);
void cli_series_free(cli_series *series);

/* ---- pictures ---- */

/* Writes the next plot: folder/plot.svg, plot-2.svg, ... */
pel_status cli_experiment_plot(cli_experiment *experiment, const cli_plot *plot);

enum { CLI_PICTURE_RUNS = 8, CLI_PICTURE_FRAMES = 6 };

/* The next picture, folder/picture.png, picture-2.png, ...: runs as rows, frames as columns. A program built without
   pictures draws none. */
typedef struct cli_picture {
    const char *caption;
    const char *runs[CLI_PICTURE_RUNS], *labels[CLI_PICTURE_RUNS];
    int run_count;
    int frames[CLI_PICTURE_FRAMES];
    int frame_count;
    int columns;        /* 0 = a row for each run */
    const char *field;  /* null = displacement */
    const char *unit;   /* of the field; null = the unit of known quantities */
    int component;      /* of a vector field, from 1; 0 = magnitude */
    double range[2];    /* range of the colours; equal ends = range of the data */
    const char *arrows; /* nullable */
    double azimuth, elevation;
    bool edges, times; /* times instead of frame numbers */
} cli_picture;

pel_status cli_experiment_draw(cli_experiment *experiment, const cli_picture *picture);

/* ---- bodies ---- */

/* The mesh file that is given, whose axis `up` ('x', 'y' or 'z') points up; the scans in the folder that is given; or
   blends: bodies (CLI_BODIES). */
pel_status cli_bodies_find(const char *mesh, char up, const char *data, cli_body *bodies, int *count, pel_error *error);
/* Frees what cli_bodies_find left in bodies (CLI_BODIES), also when it failed; zeroed ones are fine. */
void cli_bodies_free(cli_body *bodies);

/* Marks the cap of a body at rest: vertices that edges within the ball connect with the vertex nearest to its centre.
   marked: (vertex_count). */
pel_status cli_body_cap(const cli_body *body, const pel_topology *topology, const double (*rest)[3], bool *marked,
                        pel_error *error);

/* ---- the page ---- */

/* Writes folder/index.html and index.md about the experiments (count) that ran. */
pel_status cli_reproduce_page(const char *folder, const cli_experiment *const *experiments, int count,
                              pel_error *error);

/* the cases of the other files */
extern const cli_experiment_case cli_figure_4, cli_figure_6_7, cli_figure_8, cli_figure_9, cli_table_1, cli_accuracy,
    cli_b_figure_1, cli_b_figure_2, cli_b_figure_5, cli_b_figure_6, cli_b_figure_8, cli_b_figure_9, cli_b_figure_10,
    cli_b_figure_11, cli_b_figure_12, cli_b_figure_13, cli_b_figure_14, cli_b_figure_15, cli_b_figure_16_18,
    cli_b_figure_19_20, cli_b_table_2, cli_shell_checks, cli_shell_refinement, cli_validation;

#endif
