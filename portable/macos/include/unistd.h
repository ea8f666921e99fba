#include_next <unistd.h>
#ifndef PEL_PORTABLE_MACOS_UNISTD_H
#define PEL_PORTABLE_MACOS_UNISTD_H
#include <crt_externs.h>
#define environ (*_NSGetEnviron())

/* of "/proc/self/exe" too, the file of the program */
ssize_t pel_macos_readlink(const char *path, char *text, size_t size);
#define readlink pel_macos_readlink

int pel_macos_pipe(int ends[2]);
#define pipe2(ends, flags) pel_macos_pipe(ends)

void pel_macos_closefrom(int first);
#define closefrom pel_macos_closefrom
#endif
