typedef double number;
#define LEAST_PIVOT 4e-15
#define square_root sqrt
#define PEL_FACTOR_COMPUTE pel_factor_compute_double
#define PEL_FACTOR_SOLVE pel_factor_solve_double
#define PEL_FACTOR_REDUCE pel_factor_reduce_double
#include "linear/factor_numeric.h"
