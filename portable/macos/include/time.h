#include_next <time.h>
#ifndef PEL_PORTABLE_MACOS_TIME_H
#define PEL_PORTABLE_MACOS_TIME_H
#define TIMER_ABSTIME 1
/* until a time of CLOCK_MONOTONIC */
int pel_macos_sleep_until(const struct timespec *end);
#define clock_nanosleep(clock, flags, end, rest) pel_macos_sleep_until(end)
#endif
