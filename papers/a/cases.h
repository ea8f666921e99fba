/* The experiments of paper A. */
#ifndef PAPERS_A_CASES_H
#define PAPERS_A_CASES_H

#include "papers/lab/experiment.h"

extern const lab_case a_figure_4, a_figure_6_7, a_figure_8, a_figure_9, a_table_1, a_precision, a_rates;

#endif
