#define _GNU_SOURCE /* O_TMPFILE */
#include "io/file.h"

#include "base/memory.h"
#include "base/room.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static pel_status fail_path(pel_error *error, const char *path, const char *what, int number, const char *remedy)
{
    pel_fail(error, PEL_BAD_FILE, "%s: %s", what, strerror(number));
    pel_fail_remedy(error, "%s", remedy);
    pel_fail_place(error, path, 0, 0);
    return PEL_BAD_FILE;
}

const char *pel_file_write_remedy(int number)
{
    return number == EFBIG ? "raise the limit on the size of files: ulimit -f unlimited"
                           : "free some disk space or choose another folder";
}

/* reads until the end, growing the block; the first guess of the size is usually right */
static pel_status read_all(int descriptor, const char *path, size_t guess, size_t limit, char **bytes, size_t *size,
                           pel_error *error)
{
    size_t capacity = 0, used = 0;
    void *block = NULL;
    for (;;) {
        if (!pel_reserve(&block, &capacity, (used > guess ? used : guess) + 2, 1)) {
            pel_free(block);
            return pel_fail_memory(error);
        }
        ssize_t count = read(descriptor, (char *)block + used, capacity - used - 1);
        if (count < 0 && errno == EINTR)
            continue;
        if (count < 0 || used > limit) {
            int number = count < 0 ? errno : EFBIG;
            pel_free(block);
            return fail_path(error, path, "cannot read the file", number, "check the path and the disk");
        }
        if (count == 0)
            break;
        used += (size_t)count;
    }
    ((char *)block)[used] = '\0';
    *bytes = block;
    *size = used;
    return PEL_OK;
}

/* refuses other files than regular ones: a pipe may never end and a device may block forever */
static int fail_kind(const char *path, mode_t mode, pel_error *error)
{
    const char *kind = S_ISFIFO(mode) || S_ISSOCK(mode) ? "a pipe" : "a device";
    if (S_ISDIR(mode)) {
        fail_path(error, path, "cannot read the file", EISDIR, "name a file that can be read");
        return -1;
    }
    pel_fail(error, PEL_BAD_FILE, "cannot read the file: it is %s", kind);
    pel_fail_remedy(error, "save its content to a file and name that");
    pel_fail_place(error, path, 0, 0);
    return -1;
}

/* A descriptor of a regular file, or -1 with the error filled. Opening a pipe must not wait for its writer. */
static int open_readable(const char *path, struct stat *information, pel_error *error)
{
    int descriptor = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
    if (descriptor < 0) {
        fail_path(error, path, "cannot open the file", errno, "check the path and its permissions");
        return -1;
    }
    if (fstat(descriptor, information) != 0)
        fail_path(error, path, "cannot read the file", errno, "check the path and its permissions");
    else if (S_ISREG(information->st_mode))
        return descriptor;
    else
        fail_kind(path, information->st_mode, error);
    close(descriptor);
    return -1;
}

pel_status pel_file_check(const char *path, pel_error *error)
{
    struct stat information;
    int descriptor = open_readable(path, &information, error);
    if (descriptor < 0)
        return PEL_BAD_FILE;
    close(descriptor);
    return PEL_OK;
}

pel_status pel_file_read(const char *path, char **bytes, size_t *size, pel_error *error)
{
    /* files of /proc have no size: stop before memory runs out */
    const size_t limit_without_size = (size_t)1 << 30;
    *bytes = NULL;
    *size = 0;
    struct stat information;
    int descriptor = open_readable(path, &information, error);
    if (descriptor < 0)
        return PEL_BAD_FILE;
    const size_t known = (size_t)information.st_size;
    pel_status status =
        read_all(descriptor, path, known, known > 0 ? SIZE_MAX : limit_without_size, bytes, size, error);
    close(descriptor);
    return status;
}

pel_status pel_file_check_inside(const char *folder, const char *path, pel_error *error)
{
    char *outer = realpath(folder, NULL), *inner = realpath(path, NULL);
    /* the reader reports a missing file */
    bool inside = outer == NULL || inner == NULL;
    size_t length = outer != NULL ? strlen(outer) : 0;
    if (!inside && strcmp(outer, "/") != 0)
        inside = strncmp(inner, outer, length) == 0 && inner[length] == '/';
    free(outer);
    free(inner);
    if (inside)
        return PEL_OK;
    pel_fail(error, PEL_BAD_FORMAT,
             "the file is outside the folder of the run: a link or a name in the folder leads to it");
    pel_fail_remedy(error, "copy the file into the folder in place of the link");
    pel_fail_place(error, path, 0, 0);
    return PEL_BAD_FORMAT;
}

enum { TEMPORARY_ROOM = 64, ATTEMPTS = 1000 };

/* bytes of the target's path up to its last slash, which is one of them */
static int folder_length(const pel_file_writer *writer)
{
    const char *slash = strrchr(writer->target, '/');
    return slash == NULL ? 0 : (int)(slash - writer->target) + 1;
}

static void name_temporary(pel_file_writer *writer, int attempt)
{
    int length = folder_length(writer);
    snprintf(writer->temporary, (size_t)length + TEMPORARY_ROOM, "%.*s.pellicle-%ld-%d.tmp", length, writer->target,
             (long)getpid(), attempt);
}

/* A new file in the folder of the target, or -1 with errno. It has no name until it is complete, if the file system
   supports that: a program that is killed leaves nothing. */
static int open_temporary(pel_file_writer *writer)
{
    writer->temporary = pel_allocate((size_t)folder_length(writer) + TEMPORARY_ROOM, 1);
    if (writer->temporary == NULL) {
        errno = ENOMEM;
        return -1;
    }
    snprintf(writer->temporary, (size_t)folder_length(writer) + TEMPORARY_ROOM, "%.*s.", folder_length(writer),
             writer->target);
    /* a path to name it later */
    int descriptor = -1;
    if (access("/proc/self/fd", X_OK) == 0)
        descriptor = open(writer->temporary, O_WRONLY | O_TMPFILE | O_CLOEXEC, 0666);
    writer->nameless = descriptor >= 0;
    for (int attempt = 0; descriptor < 0 && attempt < ATTEMPTS; attempt++) {
        name_temporary(writer, attempt);
        descriptor = open(writer->temporary, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (descriptor < 0 && errno != EEXIST)
            return -1;
    }
    return descriptor;
}

/* gives a nameless file its temporary name; false with errno */
static bool link_temporary(pel_file_writer *writer)
{
    char source[TEMPORARY_ROOM];
    snprintf(source, sizeof source, "/proc/self/fd/%d", fileno(writer->stream));
    for (int attempt = 0; attempt < ATTEMPTS; attempt++) {
        name_temporary(writer, attempt);
        if (linkat(AT_FDCWD, source, AT_FDCWD, writer->temporary, AT_SYMLINK_FOLLOW) == 0) {
            writer->nameless = false;
            return true;
        }
        if (errno != EEXIST)
            return false;
    }
    return false;
}

static void remove_temporary(const pel_file_writer *writer)
{
    if (writer->temporary != NULL && !writer->nameless)
        unlink(writer->temporary);
}

/* opens the temporary file, or the target itself when it is a device or a pipe */
static int open_target(pel_file_writer *writer)
{
    struct stat information;
    bool exists = stat(writer->target, &information) == 0;
    if (exists && S_ISDIR(information.st_mode)) {
        errno = EISDIR;
        return -1;
    }
    if (exists && !S_ISREG(information.st_mode))
        return open(writer->target, O_WRONLY | O_CLOEXEC);
    if (exists && access(writer->target, W_OK) != 0)
        return -1;
    int descriptor = open_temporary(writer);
    if (descriptor >= 0 && exists && fchmod(descriptor, information.st_mode & 0777) != 0) {
        int number = errno;
        close(descriptor);
        remove_temporary(writer);
        errno = number;
        return -1;
    }
    return descriptor;
}

/* false with errno when the last bytes could not be written */
static bool close_writer(pel_file_writer *writer)
{
    return writer->stream == NULL || fclose(writer->stream) == 0;
}

static void free_names(pel_file_writer *writer)
{
    PEL_FREE_ALL(writer->path, writer->target, writer->temporary);
    memset(writer, 0, sizeof *writer);
}

pel_status pel_file_writer_open(pel_file_writer *writer, const char *path, pel_error *error)
{
    memset(writer, 0, sizeof *writer);
    char *resolved = realpath(path, NULL);
    writer->path = pel_copy_string(path);
    writer->target = pel_copy_string(resolved != NULL ? resolved : path);
    free(resolved);
    if (writer->path == NULL || writer->target == NULL) {
        free_names(writer);
        return pel_fail_memory(error);
    }
    int descriptor = open_target(writer);
    if (descriptor >= 0)
        writer->stream = fdopen(descriptor, "wb");
    if (writer->stream != NULL)
        return PEL_OK;
    int number = errno;
    if (descriptor >= 0) {
        close(descriptor);
        remove_temporary(writer);
    }
    free_names(writer);
    if (number == ENOMEM)
        return pel_fail_memory(error);
    return fail_path(error, path, "cannot write the file", number,
                     number == EMFILE ? "raise the limit on open files: ulimit -n 1024"
                                      : "check that the folder exists and that you may write to it");
}

void pel_file_writer_write(pel_file_writer *writer, const void *bytes, size_t size)
{
    if (writer->failure == 0 && size > 0 && fwrite(bytes, 1, size, writer->stream) != size)
        writer->failure = errno != 0 ? errno : EIO;
}

void pel_file_writer_printf(pel_file_writer *writer, const char *format, ...)
{
    if (writer->failure != 0)
        return;
    va_list arguments;
    va_start(arguments, format);
    if (vfprintf(writer->stream, format, arguments) < 0)
        writer->failure = errno != 0 ? errno : EIO;
    va_end(arguments);
}

bool pel_file_sync(int descriptor)
{
    return fsync(descriptor) == 0 || errno == EINVAL || errno == ENOTSUP || errno == EROFS;
}

bool pel_file_sync_folder(const char *path)
{
    char folder[PATH_MAX];
    snprintf(folder, sizeof folder, "%s", path);
    char *slash = strrchr(folder, '/');
    if (slash != NULL)
        slash[slash == folder] = '\0';
    int descriptor = open(slash != NULL ? folder : ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    /* a folder that may not be read cannot be waited for */
    bool done = descriptor >= 0 ? pel_file_sync(descriptor) : errno == EACCES;
    int number = errno;
    if (descriptor >= 0)
        close(descriptor);
    errno = number;
    return done;
}

bool pel_file_sync_system(const char *folder)
{
#if defined(__linux__)
    int descriptor = open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    bool done = descriptor >= 0 && syncfs(descriptor) == 0;
    int number = errno;
    if (descriptor >= 0)
        close(descriptor);
    errno = number;
    return done;
#else
    (void)folder;
    sync();
    return true;
#endif
}

void pel_file_writer_keep(pel_file_writer *writer)
{
    writer->is_kept = writer->temporary != NULL;
}

pel_status pel_file_writer_commit(pel_file_writer *writer, pel_error *error)
{
    int number = writer->failure;
    if (number == 0 && writer->stream != NULL && fflush(writer->stream) != 0)
        number = errno;
    if (number == 0 && writer->is_kept && !pel_file_sync(fileno(writer->stream)))
        number = errno;
    if (number == 0 && writer->nameless && !link_temporary(writer))
        number = errno;
    if (!close_writer(writer) && number == 0)
        number = errno;
    if (number == 0 && writer->temporary != NULL && rename(writer->temporary, writer->target) != 0)
        number = errno;
    bool is_named = number == 0 && writer->is_kept;
    if (is_named && !pel_file_sync_folder(writer->target))
        number = errno;
    pel_status status = PEL_OK;
    if (number != 0 && is_named) {
        status = fail_path(error, writer->path, "the file is there, but may not survive a power failure", number,
                           pel_file_write_remedy(number));
    } else if (number != 0) {
        remove_temporary(writer);
        status = fail_path(error, writer->path, "cannot write the file", number, pel_file_write_remedy(number));
    }
    free_names(writer);
    return status;
}

void pel_file_writer_abandon(pel_file_writer *writer)
{
    if (writer->stream == NULL)
        return;
    close_writer(writer);
    remove_temporary(writer);
    free_names(writer);
}
