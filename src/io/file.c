#define _XOPEN_SOURCE 700 /* realpath */
#include "io/file.h"

#include "base/memory.h"

#include <errno.h>
#include <fcntl.h>
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

/* a descriptor of anything that can be read but a folder, or -1 with the error filled */
static int open_readable(const char *path, struct stat *information, pel_error *error)
{
    int descriptor = open(path, O_RDONLY | O_CLOEXEC);
    if (descriptor < 0) {
        fail_path(error, path, "cannot open the file", errno, "check the path and its permissions");
        return -1;
    }
    const bool known = fstat(descriptor, information) == 0;
    if (known && !S_ISDIR(information->st_mode))
        return descriptor;
    fail_path(error, path, "cannot read the file", known ? EISDIR : errno, "name a file that can be read");
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
    /* pipes and devices have no size: stop before memory is gone */
    const size_t limit_without_size = (size_t)1 << 30;
    *bytes = NULL;
    *size = 0;
    struct stat information;
    int descriptor = open_readable(path, &information, error);
    if (descriptor < 0)
        return PEL_BAD_FILE;
    const bool regular = S_ISREG(information.st_mode);
    pel_status status = read_all(descriptor, path, regular ? (size_t)information.st_size : 0,
                                 regular ? SIZE_MAX : limit_without_size, bytes, size, error);
    close(descriptor);
    return status;
}

/* a new file beside the target, or -1 with errno */
static int open_temporary(pel_file_writer *writer)
{
    const char *slash = strrchr(writer->target, '/');
    int folder_length = slash == NULL ? 0 : (int)(slash - writer->target) + 1;
    size_t size = (size_t)folder_length + 64;
    writer->temporary = pel_allocate(size, 1);
    if (writer->temporary == NULL) {
        errno = ENOMEM;
        return -1;
    }
    for (int attempt = 0; attempt < 1000; attempt++) {
        snprintf(writer->temporary, size, "%.*s.pellicle-%ld-%d.tmp", folder_length, writer->target, (long)getpid(),
                 attempt);
        int descriptor = open(writer->temporary, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (descriptor >= 0 || errno != EEXIST)
            return descriptor;
    }
    return -1;
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
        unlink(writer->temporary);
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
    pel_free(writer->path);
    pel_free(writer->target);
    pel_free(writer->temporary);
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
        if (writer->temporary != NULL)
            unlink(writer->temporary);
    }
    free_names(writer);
    if (number == ENOMEM)
        return pel_fail_memory(error);
    return fail_path(error, path, "cannot write the file", number,
                     "check that the folder exists and that you may write to it");
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

pel_status pel_file_writer_commit(pel_file_writer *writer, pel_error *error)
{
    int number = writer->failure;
    if (!close_writer(writer) && number == 0)
        number = errno;
    if (number == 0 && writer->temporary != NULL && rename(writer->temporary, writer->target) != 0)
        number = errno;
    pel_status status = PEL_OK;
    if (number != 0) {
        if (writer->temporary != NULL)
            unlink(writer->temporary);
        status = fail_path(error, writer->path, "cannot write the file", number,
                           "free some disk space or choose another folder");
    }
    free_names(writer);
    return status;
}

void pel_file_writer_abandon(pel_file_writer *writer)
{
    if (writer->stream == NULL)
        return;
    close_writer(writer);
    if (writer->temporary != NULL)
        unlink(writer->temporary);
    free_names(writer);
}
