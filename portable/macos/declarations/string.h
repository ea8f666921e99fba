#ifndef PEL_MACOS_STRING_H
#define PEL_MACOS_STRING_H
#include <stddef.h>
#include <strings.h>
void *memcpy(void *to, const void *from, size_t size);
void *memmove(void *to, const void *from, size_t size);
void *memset(void *block, int byte, size_t size);
void *memchr(const void *block, int byte, size_t size);
void *memmem(const void *block, size_t size, const void *part, size_t part_size);
int memcmp(const void *a, const void *b, size_t size);
size_t strlen(const char *text);
size_t strnlen(const char *text, size_t size);
size_t strspn(const char *text, const char *letters);
size_t strcspn(const char *text, const char *letters);
size_t strlcpy(char *to, const char *from, size_t size);
size_t strlcat(char *to, const char *from, size_t size);
char *strcpy(char *to, const char *from);
char *strncpy(char *to, const char *from, size_t size);
char *stpcpy(char *to, const char *from);
char *strcat(char *to, const char *from);
char *strncat(char *to, const char *from, size_t size);
int strcmp(const char *a, const char *b);
int strncmp(const char *a, const char *b, size_t size);
int strcoll(const char *a, const char *b);
char *strchr(const char *text, int letter);
char *strrchr(const char *text, int letter);
char *strstr(const char *text, const char *part);
char *strpbrk(const char *text, const char *letters);
char *strdup(const char *text);
char *strndup(const char *text, size_t size);
char *strtok_r(char *text, const char *letters, char **rest);
char *strsep(char **text, const char *letters);
char *strerror(int number);
int strerror_r(int number, char *text, size_t size);
char *strsignal(int number);
#endif
