/* The thread of the haptic loop: wakes at the rate, calls a function each time, and books how late it was. */
#ifndef PEL_HAPTIC_LOOP_H
#define PEL_HAPTIC_LOOP_H

#include "pellicle/haptic.h"

typedef struct pel_loop pel_loop;

/* One update; latency describes all earlier updates. Called in the loop's thread. */
typedef void pel_loop_function(void *context, const pel_haptic_latency *latency);

/* rate: Hz. PEL_OUT_OF_MEMORY when the thread cannot be had. */
pel_status pel_loop_create(double rate, pel_loop_function *function, void *context, pel_loop **loop, pel_error *error);
/* Books an update that started so many ns late. */
void pel_loop_book(pel_haptic_latency *latency, int64_t late);
/* after the present update; null is fine */
void pel_loop_destroy(pel_loop *loop);

#endif
