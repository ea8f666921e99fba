#include_next <sys/resource.h>
#ifndef PEL_PORTABLE_MACOS_SYS_RESOURCE_H
#define PEL_PORTABLE_MACOS_SYS_RESOURCE_H
/* the type of the first argument of getrlimit in glibc */
#define __rlimit_resource_t int
#endif
