/* one lane after another: the yardstick of the wide kernels and their oracle */
#define PEL_LANE_SCALAR
#include "solve/project_kernel.h"

pel_batch_sweep *const pel_project_plain[PEL_CONSTRAINT_COUNT] = PEL_PROJECT_TABLE;
