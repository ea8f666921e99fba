#ifndef PEL_MACOS_LIMITS_H
#define PEL_MACOS_LIMITS_H
#define PATH_MAX 1024
#define NAME_MAX 255
#define PIPE_BUF 512
#define IOV_MAX 1024
#define SSIZE_MAX __LONG_MAX__
#endif
