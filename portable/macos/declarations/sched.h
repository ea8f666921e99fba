#ifndef PEL_MACOS_SCHED_H
#define PEL_MACOS_SCHED_H
#define SCHED_OTHER 1
#define SCHED_RR 2
#define SCHED_FIFO 4
struct sched_param {
    int sched_priority;
    char __opaque[4];
};
int sched_yield(void);
int sched_get_priority_min(int policy);
int sched_get_priority_max(int policy);
#endif
