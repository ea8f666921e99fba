/* Windows: the functions of posix.h. */
#include "posix.h"

#include <errno.h>
#include <malloc.h>
#include <string.h>
#include <sys/statvfs.h>
#undef gethostname
#undef rename
#undef sigaction
#include <windows.h>

/* all blocks are aligned ones: one function frees them */
enum { ALIGNMENT = 16 };

void *pel_windows_aligned_alloc(size_t alignment, size_t size)
{
    return _aligned_malloc(size > 0 ? size : 1, alignment);
}

void *pel_windows_calloc(size_t count, size_t size)
{
    if (size > 0 && count > (size_t)-1 / size)
        return NULL;
    void *block = pel_windows_aligned_alloc(ALIGNMENT, count * size);
    if (block != NULL)
        memset(block, 0, count * size);
    return block;
}

void *pel_windows_realloc(void *block, size_t size)
{
    return _aligned_realloc(block, size > 0 ? size : 1, ALIGNMENT);
}

void pel_windows_free(void *block)
{
    _aligned_free(block);
}

int pel_windows_mkdir(const char *path, int mode)
{
    (void)mode;
    return _mkdir(path);
}

/* replaces a file that is there, as POSIX does */
int pel_windows_rename(const char *from, const char *to)
{
    if (MoveFileExA(from, to, MOVEFILE_REPLACE_EXISTING))
        return 0;
    errno = GetLastError() == ERROR_FILE_NOT_FOUND ? ENOENT : EACCES;
    return -1;
}

/* a file in the folder of the pattern, which ends in a star */
int pel_windows_unlink(const char *pattern, const char *name)
{
    char path[2 * PATH_MAX];
    snprintf(path, sizeof path, "%.*s%s", (int)strlen(pattern) - 1, pattern, name);
    return unlink(path);
}

static void use_slashes(char *path)
{
    for (; *path != '\0'; path++)
        if (*path == '\\')
            *path = '/';
}

/* null if there is no such file, as POSIX says; the block is one of malloc */
char *pel_windows_realpath(const char *path, char *resolved)
{
    if (_access(path, 0) != 0)
        return NULL;
    char *full = _fullpath(resolved, path, PATH_MAX);
    if (full != NULL)
        use_slashes(full);
    return full;
}

ssize_t pel_windows_readlink(const char *path, char *text, size_t size)
{
    char full[PATH_MAX];
    DWORD length = strcmp(path, "/proc/self/exe") == 0 ? GetModuleFileNameA(NULL, full, sizeof full) : 0;
    if (length == 0 || length >= sizeof full || length > size)
        return pel_windows_unsupported();
    use_slashes(full);
    memcpy(text, full, length);
    return (ssize_t)length;
}

int pel_windows_flock(int descriptor, int operation)
{
    OVERLAPPED at = {0};
    HANDLE file = (HANDLE)_get_osfhandle(descriptor);
    DWORD flags = ((operation & LOCK_EX) != 0 ? LOCKFILE_EXCLUSIVE_LOCK : 0u) |
                  ((operation & LOCK_NB) != 0 ? LOCKFILE_FAIL_IMMEDIATELY : 0u);
    /* a byte beyond the content, which stays readable */
    at.OffsetHigh = 1;
    if ((operation & LOCK_UN) != 0 ? UnlockFileEx(file, 0, 1, 0, &at) : LockFileEx(file, flags, 0, 1, 0, &at))
        return 0;
    errno = GetLastError() == ERROR_LOCK_VIOLATION || GetLastError() == ERROR_IO_PENDING ? EWOULDBLOCK : EBADF;
    return -1;
}

long pel_windows_sysconf(int name)
{
    SYSTEM_INFO system;
    MEMORYSTATUSEX memory = {.dwLength = sizeof memory};
    GetSystemInfo(&system);
    if (name == _SC_NPROCESSORS_ONLN)
        return (long)system.dwNumberOfProcessors;
    if (name == _SC_PAGESIZE)
        return (long)system.dwPageSize;
    return GlobalMemoryStatusEx(&memory) ? (long)(memory.ullTotalPhys / system.dwPageSize) : -1;
}

int pel_windows_statvfs(const char *path, struct statvfs *disk)
{
    ULARGE_INTEGER mine;
    if (!GetDiskFreeSpaceExA(path, &mine, NULL, NULL)) {
        errno = GetLastError() == ERROR_PATH_NOT_FOUND ? ENOENT : EACCES;
        return -1;
    }
    *disk = (struct statvfs){.f_frsize = 1, .f_bavail = mine.QuadPart};
    return 0;
}

/* signal() keeps a handler for one signal, as SA_RESETHAND asks */
int pel_windows_sigaction(int number, const struct sigaction *action, struct sigaction *old)
{
    void (*before)(int);
    if (number != SIGINT && number != SIGTERM)
        return pel_windows_unsupported();
    before = signal(number, action != NULL ? action->sa_handler : SIG_DFL);
    if (action == NULL)
        signal(number, before);
    if (old != NULL)
        old->sa_handler = before;
    return before == SIG_ERR ? -1 : 0;
}

int pel_windows_unsupported(void)
{
    errno = ENOSYS;
    return -1;
}

ssize_t pel_windows_getline(char **line, size_t *size, FILE *file)
{
    size_t length = 0;
    for (int c = getc(file); c != EOF; c = getc(file)) {
        if (length + 2 > *size) {
            size_t room = 2 * *size + 120;
            char *more = pel_windows_realloc(*line, room);
            if (more == NULL)
                return -1;
            *line = more;
            *size = room;
        }
        (*line)[length++] = (char)c;
        if (c == '\n')
            break;
    }
    if (length == 0)
        return -1;
    (*line)[length] = '\0';
    return (ssize_t)length;
}
