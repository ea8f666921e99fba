/* Filling a pel_error: see pellicle/error.h. */
#ifndef PEL_BASE_STATUS_H
#define PEL_BASE_STATUS_H

#include "pellicle/error.h"

#endif
