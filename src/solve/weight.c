/* The weight k_B of bending under pbd, chosen step by step: paper B leaves open how to find it. Too large a weight
   holds the volume and makes it jitter, as a projection of bending then overshoots and feeds the velocities; too small
   a one lets the surface crumple (theory page, section 0, finding 2). So the weight rises slowly while the volume
   falls, and is cut down when the volume has risen: it stays as large as the motion bears. */
#include "solve/project.h"

#include <math.h>

/* where it starts, and the range that it keeps to */
static const double first_weight = 0.03, least_weight = 1e-4, most_weight = 0.5;
/* factors after a step with a smaller and with a larger volume */
static const double rise = 1.03, cut = 0.6;
/* a larger volume counts when it is so much larger */
static const double noise = 1e-9;

void pel_auto_weight_begin(pel_auto_weight *weight, double volume)
{
    *weight = (pel_auto_weight){first_weight, volume};
}

void pel_auto_weight_follow(pel_auto_weight *weight, double volume)
{
    bool rose = volume > weight->volume + noise * fabs(weight->volume);
    weight->weight = fmin(fmax(weight->weight * (rose ? cut : rise), least_weight), most_weight);
    weight->volume = volume;
}
