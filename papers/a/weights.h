#ifndef PAPERS_A_WEIGHTS_H
#define PAPERS_A_WEIGHTS_H

#include "papers/lab/experiment.h"

/* Compares the weights of subdivision with the published ones, for vertices of 3 to 9 neighbours. */
pel_status a_judge_weights(lab_experiment *experiment);

#endif
