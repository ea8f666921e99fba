#ifndef PEL_MACOS_STDIO_H
#define PEL_MACOS_STDIO_H
#include <stdarg.h>
#include <sys/types.h>
typedef struct __sFILE FILE;
typedef off_t fpos_t;
extern FILE *__stdinp, *__stdoutp, *__stderrp;
#define stdin __stdinp
#define stdout __stdoutp
#define stderr __stderrp
#define EOF (-1)
#define BUFSIZ 1024
#define SEEK_SET 0
#define SEEK_CUR 1
#define SEEK_END 2
#define _IOFBF 0
#define _IOLBF 1
#define _IONBF 2
#define PRINTS(at, first) __attribute__((format(printf, at, first)))
#define SCANS(at, first) __attribute__((format(scanf, at, first)))
int printf(const char *format, ...) PRINTS(1, 2);
int fprintf(FILE *file, const char *format, ...) PRINTS(2, 3);
int dprintf(int descriptor, const char *format, ...) PRINTS(2, 3);
int sprintf(char *text, const char *format, ...) PRINTS(2, 3);
int snprintf(char *text, size_t size, const char *format, ...) PRINTS(3, 4);
int asprintf(char **text, const char *format, ...) PRINTS(2, 3);
int vprintf(const char *format, va_list list) PRINTS(1, 0);
int vfprintf(FILE *file, const char *format, va_list list) PRINTS(2, 0);
int vsnprintf(char *text, size_t size, const char *format, va_list list) PRINTS(3, 0);
int scanf(const char *format, ...) SCANS(1, 2);
int fscanf(FILE *file, const char *format, ...) SCANS(2, 3);
int sscanf(const char *text, const char *format, ...) SCANS(2, 3);
#undef PRINTS
#undef SCANS
FILE *fopen(const char *path, const char *mode);
FILE *freopen(const char *path, const char *mode, FILE *file);
FILE *fdopen(int descriptor, const char *mode);
FILE *fmemopen(void *block, size_t size, const char *mode);
FILE *open_memstream(char **text, size_t *size);
FILE *popen(const char *command, const char *mode);
FILE *tmpfile(void);
int pclose(FILE *file);
int fclose(FILE *file);
int fflush(FILE *file);
int fileno(FILE *file);
int feof(FILE *file);
int ferror(FILE *file);
void clearerr(FILE *file);
void rewind(FILE *file);
int fseek(FILE *file, long offset, int from);
long ftell(FILE *file);
int fseeko(FILE *file, off_t offset, int from);
off_t ftello(FILE *file);
int setvbuf(FILE *file, char *block, int mode, size_t size);
size_t fread(void *block, size_t size, size_t count, FILE *file);
size_t fwrite(const void *block, size_t size, size_t count, FILE *file);
int fgetc(FILE *file);
int getc(FILE *file);
int getchar(void);
int ungetc(int letter, FILE *file);
char *fgets(char *text, int size, FILE *file);
ssize_t getline(char **line, size_t *size, FILE *file);
int fputc(int letter, FILE *file);
int putc(int letter, FILE *file);
int putchar(int letter);
int fputs(const char *text, FILE *file);
int puts(const char *text);
void perror(const char *text);
int remove(const char *path);
int rename(const char *from, const char *to);
#endif
