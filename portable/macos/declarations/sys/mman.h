#ifndef PEL_MACOS_SYS_MMAN_H
#define PEL_MACOS_SYS_MMAN_H
#include <sys/types.h>
#define PROT_READ 1
#define PROT_WRITE 2
#define MAP_SHARED 1
#define MAP_PRIVATE 2
#define MAP_ANON 0x1000
#define MAP_FAILED ((void *)-1)
void *mmap(void *at, size_t size, int protection, int flags, int descriptor, off_t offset);
int munmap(void *block, size_t size);
#endif
