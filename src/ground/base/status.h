/* Filling a pel_error: see pellicle/error.h. */
#ifndef PEL_BASE_STATUS_H
#define PEL_BASE_STATUS_H

#include "pellicle/error.h"

/* refuses an argument of the calling function that is null */
#define PEL_REFUSE_NULL(pointer, error)                                                                                \
    do {                                                                                                               \
        if ((pointer) == NULL)                                                                                         \
            return pel_fail((error), PEL_BAD_ARGUMENT, "%s is null", #pointer);                                        \
    } while (0)

/* whether the value of an enum is outside the first `count` */
#define PEL_IS_NO_CHOICE(value, count) ((int64_t)(value) < 0 || (int64_t)(value) >= (int64_t)(count))

#endif
