#ifndef PAPERS_LAB_MEDIAN_H
#define PAPERS_LAB_MEDIAN_H

/* sorts the values (count from 1) */
double lab_median(double *values, int count);

#endif
