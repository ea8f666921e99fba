/* Numbers of the experiments of both papers as the last version of this program measured them. A broken formula can
   leave a claim of the paper true; it seldom leaves a number within 1 %. */
#ifndef PAPERS_LAB_STORED_H
#define PAPERS_LAB_STORED_H

#include "papers/lab/experiment.h"

typedef struct lab_stored {
    const char *experiment, *finding;
    double value;
} lab_stored;

/* Adds a claim that the findings of the experiment equal its numbers (count) within 1 %, with a finding for each that
   does not. Adds no claim if there are no numbers of the experiment. */
void lab_judge_stored(lab_experiment *experiment, const lab_stored *numbers, int count);

/* numbers.inc, written by `make reproduction`; returns how many there are */
int lab_stored_numbers(const lab_stored **numbers);

#endif
