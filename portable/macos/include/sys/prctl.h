#ifndef PEL_PORTABLE_MACOS_SYS_PRCTL_H
#define PEL_PORTABLE_MACOS_SYS_PRCTL_H
#define PR_SET_PDEATHSIG 1
/* a process whose parent has died ends after its run: the channel between them is closed then */
#define prctl(option, value) ((void)0)
#endif
