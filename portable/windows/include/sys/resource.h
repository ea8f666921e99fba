/* Windows: no limits of resources. */
#ifndef PEL_PORTABLE_WINDOWS_RESOURCE_H
#define PEL_PORTABLE_WINDOWS_RESOURCE_H
typedef unsigned long long rlim_t;
struct rlimit {
    rlim_t rlim_cur, rlim_max;
};
#define RLIM_INFINITY (~(rlim_t)0)
#define RLIMIT_AS 9
#define getrlimit(what, limit) ((void)(limit), -1)
#endif
