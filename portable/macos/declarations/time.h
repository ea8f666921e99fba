#ifndef PEL_MACOS_TIME_H
#define PEL_MACOS_TIME_H
#include <sys/types.h>
typedef unsigned long clock_t;
typedef enum {
    CLOCK_REALTIME = 0,
    CLOCK_MONOTONIC_RAW = 4,
    CLOCK_MONOTONIC = 6,
    CLOCK_PROCESS_CPUTIME_ID = 12,
    CLOCK_THREAD_CPUTIME_ID = 16
} clockid_t;
#define CLOCKS_PER_SEC ((clock_t)1000000)
struct tm {
    int tm_sec, tm_min, tm_hour, tm_mday, tm_mon, tm_year, tm_wday, tm_yday, tm_isdst;
    long tm_gmtoff;
    char *tm_zone;
};
clock_t clock(void);
time_t time(time_t *seconds);
time_t mktime(struct tm *date);
struct tm *gmtime_r(const time_t *seconds, struct tm *date);
struct tm *localtime_r(const time_t *seconds, struct tm *date);
struct tm *gmtime(const time_t *seconds);
struct tm *localtime(const time_t *seconds);
size_t strftime(char *text, size_t size, const char *format, const struct tm *date);
int clock_gettime(clockid_t clock, struct timespec *time);
int clock_getres(clockid_t clock, struct timespec *time);
int nanosleep(const struct timespec *time, struct timespec *rest);
#endif
