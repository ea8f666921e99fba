/* Filling a report: one finding at a time. */
#ifndef PEL_MESH_ISSUE_H
#define PEL_MESH_ISSUE_H

#include "pellicle/mesh_check.h"

/* Counts a finding and lists it while there is room; related: a and b, -1 = nothing. PEL_OK or PEL_OUT_OF_MEMORY. */
pel_status pel_issue_add(pel_mesh_report *report, pel_issue_kind kind, int32_t element, int32_t a, int32_t b);

/* error_count and warning_count from the counts of the kinds */
void pel_issue_sum(pel_mesh_report *report);

#endif
