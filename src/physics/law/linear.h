/* Linear elasticity in a frame that turns with the first rest axis (paper B's LE, theory page section 3): the quadratic
   law of stvk.h on the strain of the triangle factor. The one law that is no function of C. */
#ifndef PEL_LAW_LINEAR_H
#define PEL_LAW_LINEAR_H

#include "law/stvk.h"

enum { pel_law_linear_traits = PEL_LAW_ALIGNED | pel_law_stvk_traits };

#define pel_law_linear pel_law_stvk
#define pel_law_linear_of pel_law_stvk_of
#define pel_law_linear_refuse pel_law_stvk_refuse

#endif
