/* The experiments of paper B. */
#ifndef PAPERS_B_CASES_H
#define PAPERS_B_CASES_H

#include "papers/lab/experiment.h"

extern const lab_case b_figure_1, b_figure_2, b_figure_4, b_figure_5, b_figure_6, b_algorithm, b_figure_8, b_figure_9,
    b_figure_10, b_figure_11, b_figure_12, b_figure_13, b_figure_14, b_figure_15, b_table_1, b_figure_16_18,
    b_figure_19_20, b_table_2, b_inflation, b_exaggeration;

#endif
