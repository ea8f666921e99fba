/* Windows: random numbers of the system. */
#ifndef PEL_PORTABLE_WINDOWS_RANDOM_H
#define PEL_PORTABLE_WINDOWS_RANDOM_H
int pel_windows_getentropy(void *bytes, size_t size);
#define getentropy pel_windows_getentropy
#endif
