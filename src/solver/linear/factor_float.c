typedef float number;
#define LEAST_PIVOT 1e-7f
#define square_root sqrtf
#define PEL_FACTOR_COMPUTE pel_factor_compute_float
#define PEL_FACTOR_SOLVE pel_factor_solve_float
#define PEL_FACTOR_REDUCE pel_factor_reduce_float
#include "linear/factor_numeric.h"
