/* Columns of a series.csv. */
#ifndef PELLICLE_VIEW_SERIES_H
#define PELLICLE_VIEW_SERIES_H

#include "pellicle/base.h"

/* Reads the columns of these names (name_count) into values (row_count x name_count); cells that are missing or no
   numbers become NaN, further rows are left out. Errors: PEL_BAD_FILE, PEL_OUT_OF_MEMORY. */
pel_status view_series_read(const char *path, const char *const *names, int32_t name_count, double *values,
                            int32_t row_count, pel_error *error);

#endif
