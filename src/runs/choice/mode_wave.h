/* Whether a mesh is fine enough for a mode. */
#ifndef PEL_CHOICE_MODE_WAVE_H
#define PEL_CHOICE_MODE_WAVE_H

#include "stage/stage.h"

typedef struct pel_mode_wave {
    double edges; /* in a wave of the mode */
    double least; /* that it needs, for a frequency or load factor within 5 % */
} pel_mode_wave;

/* Of a mode (3 x vertex_count) of an analysis, with its frequency [Hz], or load factor where it buckles. */
pel_mode_wave pel_mode_wave_of(const pel_sim *sim, const double *mode, double value, bool buckles);

#endif
