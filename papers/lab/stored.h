/* Numbers of the experiments of both papers as the last version of this program measured them: a claim of the paper can
   hold although a formula is broken, a number to 1 % seldom stays. */
#ifndef PAPERS_LAB_STORED_H
#define PAPERS_LAB_STORED_H

#include "papers/lab/experiment.h"

typedef struct lab_stored {
    const char *experiment, *finding;
    double value;
} lab_stored;

/* Adds the claim that the findings of the experiment are those of numbers (count), and those that are not. Without a
   number for the experiment it adds none. */
void lab_judge_stored(lab_experiment *experiment, const lab_stored *numbers, int count);

/* numbers.inc, written by `make reproduction`; returns how many there are */
int lab_stored_numbers(const lab_stored **numbers);

#endif
