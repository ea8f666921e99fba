/* The experiments of both papers, and our own checks, for the command `pellicle reproduce`:

       papers *all;
       if (papers_create(&def, &all, &error) == PEL_OK)
           status = papers_run(all, papers_case_at(0), &experiment, &error);
       papers_destroy(all); */
#ifndef PAPERS_PAPERS_H
#define PAPERS_PAPERS_H

#include "papers/lab/experiment.h"

/* the index-th case, in the order of the papers; null past the last */
const lab_case *papers_case_at(int index);

typedef struct papers papers;

/* Strings must outlive the papers. */
typedef struct papers_def {
    const char *folder; /* of the results, made with its parents: at most LAB_PATH_SIZE - 256 letters */
    const char *mesh;   /* nullable: the user's body in the experiments of paper B */
    char up;            /* 'x', 'y' or 'z': its axis that points up */
    const char *data;   /* nullable: folder with scans */
    /* called before each run of a scene; nullable */
    void (*progress)(void *user, const char *experiment, const char *run);
    void *user;
} papers_def;

/* Finds the bodies of paper B. Destroying papers that failed is fine. */
pel_status papers_create(const papers_def *def, papers **made, pel_error *error);
void papers_destroy(papers *all);

/* Runs a case in folder/NAME and leaves numbers.csv there. The experiment lives as long as the papers. */
pel_status papers_run(papers *all, const lab_case *which, const lab_experiment **experiment, pel_error *error);

/* writes index.html and index.md in the folder, about all that ran */
pel_status papers_write_page(const papers *all, pel_error *error);

#endif
