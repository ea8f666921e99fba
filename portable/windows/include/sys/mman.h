/* Windows: files are read, not mapped. */
#ifndef PEL_PORTABLE_WINDOWS_MMAN_H
#define PEL_PORTABLE_WINDOWS_MMAN_H
#define PROT_READ 1
#define MAP_PRIVATE 2
#define MAP_FAILED ((void *)-1)
#define mmap(address, length, protection, flags, descriptor, offset) MAP_FAILED
#define munmap(address, length) 0
#endif
