/* Windows: no terminals to wait for; libfyaml names this. */
#ifndef PEL_PORTABLE_WINDOWS_SELECT_H
#define PEL_PORTABLE_WINDOWS_SELECT_H
typedef struct fd_set {
    int count;
} fd_set;
#define FD_ZERO(set) ((set)->count = 0)
#define FD_SET(descriptor, set) ((set)->count = (descriptor))
#define select(count, read, write, except, time) ((void)(read), (void)(time), -1)
#endif
