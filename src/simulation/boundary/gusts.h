/* Gusts: eddies of the air that the wind carries along. */
#ifndef PEL_BOUNDARY_GUSTS_H
#define PEL_BOUNDARY_GUSTS_H

#include "pellicle/wind.h"

enum { PEL_GUST_WAVES = 24 };

typedef struct pel_gust_wave {
    double vector[3], amplitude[3]; /* 1/m, m/s */
    double rate, phase;             /* 1/s, rad */
} pel_gust_wave;

typedef struct pel_gusts {
    pel_gust_wave waves[PEL_GUST_WAVES];
    int count; /* 0 = no gusts */
} pel_gusts;

/* The waves of the def: its speed and length are checked. */
void pel_gusts_make(const pel_gust_def *def, pel_gusts *gusts);
/* m/s: adds `factor` times the velocity of the gusts at a place [m] and time [s], carried by a mean wind [m/s]. */
void pel_gusts_add(const pel_gusts *gusts, const double wind[3], const double x[3], double time, double factor,
                   double flow[3]);

#endif
