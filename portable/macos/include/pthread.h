#include_next <pthread.h>
#ifndef PEL_PORTABLE_MACOS_PTHREAD_H
#define PEL_PORTABLE_MACOS_PTHREAD_H
#define pthread_condattr_setclock(attributes, clock) ((void)(attributes), 0)
/* until a time of CLOCK_MONOTONIC */
int pel_macos_timedwait(pthread_cond_t *condition, pthread_mutex_t *mutex, const struct timespec *end);
#define pthread_cond_timedwait pel_macos_timedwait
#endif
