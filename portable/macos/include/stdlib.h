#include_next <stdlib.h>
#ifndef PEL_PORTABLE_MACOS_STDLIB_H
#define PEL_PORTABLE_MACOS_STDLIB_H
/* of "/proc/self/exe" too, the file of the program */
char *pel_macos_realpath(const char *path, char *resolved);
#define realpath pel_macos_realpath
#endif
