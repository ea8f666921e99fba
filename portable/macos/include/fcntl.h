#include_next <fcntl.h>
#ifndef PEL_PORTABLE_MACOS_FCNTL_H
#define PEL_PORTABLE_MACOS_FCNTL_H
#ifndef O_TMPFILE
#define O_TMPFILE 0
#endif
int pel_macos_fallocate(int descriptor, off_t size);
#define posix_fallocate(descriptor, offset, size) pel_macos_fallocate(descriptor, (offset) + (size))
#endif
