#ifndef PEL_MACOS_STRINGS_H
#define PEL_MACOS_STRINGS_H
#include <stddef.h>
int strcasecmp(const char *a, const char *b);
int strncasecmp(const char *a, const char *b, size_t size);
int ffs(int number);
#endif
