#ifndef PAPERS_A_ORGAN_H
#define PAPERS_A_ORGAN_H

#include "papers/lab/experiment.h"

/* An organ instead of the ball of figure 8 and of the lens of figure 9: the liver of the bodies, else the first one. */
pel_status a_press_organ(lab_experiment *experiment);
pel_status a_probe_organ(lab_experiment *experiment);

#endif
