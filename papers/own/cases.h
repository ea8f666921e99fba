/* Our own checks: refinement, shells, shells against mechanics, and tears. */
#ifndef PAPERS_OWN_CASES_H
#define PAPERS_OWN_CASES_H

#include "papers/lab/experiment.h"

extern const lab_case own_shells, own_refinement, own_validation, own_tear;

#endif
