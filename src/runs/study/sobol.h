/* Points of low discrepancy: Sobol sequences (I. M. Sobol, USSR Comp. Math. Math. Phys. 7, 1967) in the order of Gray
   codes (Antonov, Saleev, 1979), with the direction numbers of S. Joe and F. Y. Kuo (SIAM J. Sci. Comput. 30, 2008). */
#ifndef PEL_STUDY_SOBOL_H
#define PEL_STUDY_SOBOL_H

#include <stdint.h>

/* dimensions at most */
enum { PEL_SOBOL_DIMENSIONS = 21 };

/* Coordinate `dimension` (below PEL_SOBOL_DIMENSIONS) of point `index` (below 2^32), in [0, 1). */
double pel_sobol(int32_t dimension, uint32_t index);

#endif
