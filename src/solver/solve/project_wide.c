#include "solve/project_kernel.h"

pel_batch_sweep *const pel_project_wide[PEL_CONSTRAINT_COUNT] = PEL_PROJECT_TABLE;
