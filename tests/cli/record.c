/* Preloaded into a program: notes in $RECORD/log what it does to names of files, and copies what it waits for the disk
   to have. tests/cli/power.py replays these notes. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static int copies;

static void *real(const char *name)
{
    return dlsym(RTLD_NEXT, name);
}

static void note(const char *format, ...)
{
    char line[9000], path[4200];
    va_list arguments;
    int kept = errno;
    va_start(arguments, format);
    int length = vsnprintf(line, sizeof line - 1, format, arguments);
    va_end(arguments);
    line[length++] = '\n';
    snprintf(path, sizeof path, "%s/log", getenv("RECORD"));
    int (*open_file)(const char *, int, ...) = real("open");
    int log = open_file(path, O_WRONLY | O_APPEND | O_CREAT, 0666);
    if (log < 0 || write(log, line, (size_t)length) != length)
        abort();
    close(log);
    errno = kept;
}

/* absolute, whatever the present folder */
static const char *place(int folder, const char *path, char out[4200])
{
    char link[64], base[4200] = "";
    if (path[0] == '/') {
        snprintf(out, 4200, "%s", path);
        return out;
    }
    snprintf(link, sizeof link, folder == AT_FDCWD ? "/proc/self/cwd" : "/proc/self/fd/%d", folder);
    ssize_t length = readlink(link, base, sizeof base - 1);
    base[length > 0 ? length : 0] = '\0';
    snprintf(out, 4200, "%.2000s/%.2000s", base, path);
    return out;
}

static unsigned long number(const char *path)
{
    struct stat s;
    return stat(path, &s) == 0 ? (unsigned long)s.st_ino : 0;
}

static void copy(const char *from, const char *what)
{
    char command[9000];
    snprintf(command, sizeof command, "env -u LD_PRELOAD cp -a '%s' '%s/%d'", from, getenv("RECORD"), copies);
    if (system(command) != 0)
        abort();
    note("%s %d", what, copies++);
}

static int open_and_note(const char *name, const char *path, int flags, unsigned mode)
{
    char out[4200];
    int (*call)(const char *, int, ...) = real(name);
    int is_new = (flags & O_CREAT) != 0 && access(path, F_OK) != 0;
    int made = call(path, flags, mode);
    if (made >= 0 && is_new)
        note("name %lu %s", number(path), place(AT_FDCWD, path, out));
    return made;
}

#define OPEN(name)                                                                                                     \
    int name(const char *path, int flags, ...)                                                                         \
    {                                                                                                                  \
        va_list arguments;                                                                                             \
        va_start(arguments, flags);                                                                                    \
        unsigned mode = (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(arguments, unsigned) : 0;                        \
        va_end(arguments);                                                                                             \
        return open_and_note(#name, path, flags, mode);                                                                \
    }
OPEN(open)
OPEN(open64)

int linkat(int from_folder, const char *from, int to_folder, const char *to, int flags)
{
    char out[4200];
    int (*call)(int, const char *, int, const char *, int) = real("linkat");
    int result = call(from_folder, from, to_folder, to, flags);
    if (result == 0)
        note("name %lu %s", number(to), place(to_folder, to, out));
    return result;
}

int mkdir(const char *path, mode_t mode)
{
    char out[4200];
    int (*call)(const char *, mode_t) = real("mkdir");
    int result = call(path, mode);
    if (result == 0)
        note("made 0 %s", place(AT_FDCWD, path, out));
    return result;
}

int rename(const char *from, const char *to)
{
    char a[4200], b[4200];
    int (*call)(const char *, const char *) = real("rename");
    int result = call(from, to);
    if (result == 0)
        note("move %lu %s\t%s", number(to), place(AT_FDCWD, from, a), place(AT_FDCWD, to, b));
    return result;
}

int unlink(const char *path)
{
    char out[4200];
    int (*call)(const char *) = real("unlink");
    int result = call(path);
    if (result == 0)
        note("gone 0 %s", place(AT_FDCWD, path, out));
    return result;
}

int unlinkat(int folder, const char *path, int flags)
{
    char out[4200];
    int (*call)(int, const char *, int) = real("unlinkat");
    int result = call(folder, path, flags);
    if (result == 0)
        note("gone 0 %s", place(folder, path, out));
    return result;
}

int fsync(int file)
{
    char link[64], path[4200];
    struct stat s;
    int (*call)(int) = real("fsync");
    pthread_mutex_lock(&lock);
    int result = call(file);
    snprintf(link, sizeof link, "/proc/self/fd/%d", file);
    fstat(file, &s);
    if (S_ISDIR(s.st_mode)) {
        ssize_t length = readlink(link, path, sizeof path - 1);
        path[length > 0 ? length : 0] = '\0';
        note("folder 0 %s", path);
    } else {
        /* of a file without a name too */
        snprintf(path, sizeof path, "/proc/%ld/fd/%d", (long)getpid(), file);
        char command[9000];
        snprintf(command, sizeof command, "env -u LD_PRELOAD cat '%s' >'%s/%d'", path, getenv("RECORD"), copies);
        if (system(command) != 0)
            abort();
        note("file %lu %d", (unsigned long)s.st_ino, copies++);
    }
    pthread_mutex_unlock(&lock);
    return result;
}

int syncfs(int file)
{
    char link[64], path[4200];
    int (*call)(int) = real("syncfs");
    pthread_mutex_lock(&lock);
    int result = call(file);
    snprintf(link, sizeof link, "/proc/self/fd/%d", file);
    ssize_t length = readlink(link, path, sizeof path - 1);
    path[length > 0 ? length : 0] = '\0';
    copy(path, "all");
    pthread_mutex_unlock(&lock);
    return result;
}
