#ifndef PAPERS_LAB_PAGE_H
#define PAPERS_LAB_PAGE_H

#include "papers/lab/experiment.h"

/* Writes folder/index.html and index.md about the experiments (count) that ran. */
pel_status lab_write_page(const char *folder, const lab_experiment *const *experiments, int count, pel_error *error);

#endif
