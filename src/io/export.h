/* What the exports share. */
#ifndef PEL_IO_EXPORT_H
#define PEL_IO_EXPORT_H

#include "pellicle/export.h"

#include <float.h>
#include <math.h>

/* refuses frame `frame`, whose triangles are not those of frame 0 */
pel_status pel_export_fail_changed(const pel_frames *frames, int32_t frame, pel_error *error);

/* refuses a frame with coordinates that no float holds */
pel_status pel_export_fail_large(const pel_frames *frames, int32_t frame, pel_error *error);

static inline bool pel_export_fits_float(double value)
{
    return fabs(value) <= (double)FLT_MAX;
}

#endif
