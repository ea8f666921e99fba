/* Pellicle: the air around all bodies. */
#ifndef PELLICLE_WIND_H
#define PELLICLE_WIND_H

#include "quantity.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Gusts: a field of eddies that the wind carries along, without sources; the same for the same seed. */
typedef struct pel_gust_def {
    double speed;  /* m/s, root mean square of each component; 0 = no gusts */
    double length; /* m, of the eddies; above 0 with gusts */
    int32_t seed;
} pel_gust_def;

/* Air acts on every triangle as on a flat plate. With the area A, the velocity w of the air relative to the triangle,
   its component c across the triangle and the unit normal n on the side where w . n > 0, the force is

       density A c / 2 (drag (c / |w|) w + lift (|w| n - (c / |w|) w)),

   drag along w and lift across it; with drag = lift it is along the normal. Open surfaces feel it on both sides, closed
   ones where they face the wind. There is no friction along the surface, and bodies shelter nothing. For methods with
   velocities (explicit, pbd, pbd-distance, xpbd, implicit); derivatives do not exist. */
typedef struct pel_wind_def {
    double velocity[3];  /* m/s; 0 = still air */
    const pel_key *keys; /* (key_count) factor on velocity and gusts over time; nullable */
    int32_t key_count;
    double density;    /* kg/m3; 0 = no air (default) */
    double drag, lift; /* coefficients of at least 0; default: 1.2, a plate across the wind */
    pel_gust_def gusts;
} pel_wind_def;

#ifdef __cplusplus
}
#endif
#endif
