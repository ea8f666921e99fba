/* Which of its vibrations a body is set into by what acts on it. */
#ifndef PEL_CHOICE_EXCITED_H
#define PEL_CHOICE_EXCITED_H

#include "pellicle/scene.h"
#include "stage/stage.h"

typedef struct pel_excited {
    double frequency;            /* Hz, the highest of those that count; 0 = nothing does */
    char by[PEL_NAME_SIZE + 16]; /* what starts it */
} pel_excited;

/* The loads of a body, one after the other in time, each in a time step of its own after the first two of a modal
   analysis: loads (scene->sim.load_count) receives *count of them. */
void pel_excited_lay_out(const pel_scene *scene, int32_t body, double dt, pel_load_def *loads, int32_t *count);

/* The vibrations that loads, weight, pressure, moving pins and supports, and the velocity at the start set a body into,
   from a modal analysis of it alone with those loads. What starts slowly sets it into none, nor does a share of less
   than 1 % of the energy, or a weight that moves it by less than a thousandth of its size. PEL_OUT_OF_MEMORY. */
pel_status pel_excited_find(const pel_scene *scene, int32_t body, pel_sim *sim, pel_excited *excited);

#endif
