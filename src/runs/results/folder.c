#define _DEFAULT_SOURCE /* realpath, flock */
#include "results/folder.h"

#include "base/status.h"
#include "io/file.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

static const char *join(char path[PEL_RUN_FILE_SIZE], const char *folder, const char *name)
{
    snprintf(path, PEL_RUN_FILE_SIZE, "%s/%s", folder, name);
    return path;
}

const char *pel_run_path(char path[PEL_RUN_FILE_SIZE], const char *folder, pel_run_file file)
{
    return join(path, folder, pel_run_file_name(file));
}

const char *pel_run_frame_path(char path[PEL_RUN_FILE_SIZE], const char *folder, int64_t frame)
{
    snprintf(path, PEL_RUN_FILE_SIZE, "%s%sframes/f%05" PRId64 ".vtp", folder != NULL ? folder : "",
             folder != NULL ? "/" : "", frame);
    return path;
}

const char *pel_run_tool_path(char path[PEL_RUN_FILE_SIZE], const char *folder, int64_t frame, int32_t tool)
{
    snprintf(path, PEL_RUN_FILE_SIZE, "%s%sframes/t%05" PRId64 "-%d.vtp", folder != NULL ? folder : "",
             folder != NULL ? "/" : "", frame, (int)tool);
    return path;
}

const char *pel_run_checkpoint_path(char path[PEL_RUN_FILE_SIZE], const char *folder, int64_t step)
{
    snprintf(path, PEL_RUN_FILE_SIZE, "%s/checkpoint-%" PRId64 ".pel", folder, step);
    return path;
}

static pel_status fail_folder(const char *path, const char *what, int number, pel_error *error)
{
    pel_fail(error, PEL_BAD_FILE, "%s: %s", what, strerror(number));
    pel_fail_remedy(error, "choose another output folder, or make this one writable");
    pel_fail_place(error, path, 0, 0);
    return PEL_BAD_FILE;
}

static bool make_folder(const char *path)
{
    struct stat information;
    if (mkdir(path, 0777) == 0)
        return true;
    if (errno != EEXIST || stat(path, &information) != 0)
        return false;
    errno = ENOTDIR;
    return S_ISDIR(information.st_mode);
}

/* a folder with this file is one of a run, whatever its name and those of its other files */
static const char mark_name[] = ".pellicle-run";

static bool has_mark(const char *folder)
{
    char path[PEL_RUN_FILE_SIZE];
    struct stat information;
    return lstat(join(path, folder, mark_name), &information) == 0 && S_ISREG(information.st_mode);
}

static bool write_mark(const char *folder)
{
    static const char text[] = "the folder of a run of pellicle: the next one moves it aside\n";
    char path[PEL_RUN_FILE_SIZE];
    if (has_mark(folder))
        return true;
    int descriptor = open(join(path, folder, mark_name), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0666);
    const bool written = descriptor >= 0 && write(descriptor, text, sizeof text - 1) == (ssize_t)sizeof text - 1;
    if (descriptor >= 0)
        close(descriptor);
    return written;
}

pel_status pel_run_folder_open(const char *folder, pel_error *error)
{
    char path[PEL_RUN_FILE_SIZE];
    join(path, folder, "frames");
    for (char *slash = path + 1; *slash != '\0'; slash++) {
        if (*slash != '/' || slash[-1] == '/')
            continue;
        *slash = '\0';
        bool made = make_folder(path);
        *slash = '/';
        if (!made)
            return fail_folder(folder, "cannot make the output folder", errno, error);
    }
    if (access(folder, W_OK | X_OK) != 0)
        return fail_folder(folder, "cannot write into the output folder", errno, error);
    if (!make_folder(path) || access(path, W_OK | X_OK) != 0)
        return fail_folder(path, "cannot write into the folder", errno, error);
    return write_mark(folder) ? PEL_OK : fail_folder(folder, "cannot write into the folder", errno, error);
}

pel_status pel_run_folder_sync(const char *folder, pel_error *error)
{
    return pel_file_sync_system(folder) ? PEL_OK
                                        : fail_folder(folder, "cannot write into the output folder", errno, error);
}

/* the file that is locked; it holds who does */
static const char lock_name[] = ".pellicle-lock";

static pel_status fail_locked(const char *folder, int descriptor, pel_error *error)
{
    char holder[160];
    ssize_t length = read(descriptor, holder, sizeof holder - 1);
    holder[length > 0 ? length : 0] = '\0';
    pel_fail(error, PEL_BAD_FILE, "another run is writing into this folder: %s",
             length > 0 ? holder : "it does not say which");
    pel_fail_remedy(error, "wait until it has ended, or choose another output folder");
    pel_fail_place(error, folder, 0, 0);
    return PEL_BAD_FILE;
}

/* the file may have been removed, and made again, between opening and locking it */
static bool is_there(int descriptor, const char *path)
{
    struct stat opened, named;
#if defined(_WIN32)
    return fstat(descriptor, &opened) == 0 && stat(path, &named) == 0; /* an open file is not removed there */
#else
    return fstat(descriptor, &opened) == 0 && stat(path, &named) == 0 && opened.st_dev == named.st_dev &&
           opened.st_ino == named.st_ino;
#endif
}

static void write_holder(int descriptor)
{
    char host[80] = "", text[160];
    gethostname(host, sizeof host - 1);
    int length = snprintf(text, sizeof text, "process %ld on %s", (long)getpid(), host);
    /* who it is serves the message alone */
    if (ftruncate(descriptor, 0) != 0 || write(descriptor, text, (size_t)length) != length)
        errno = 0;
}

pel_status pel_run_folder_lock(const char *folder, int *lock, pel_error *error)
{
    char path[PEL_RUN_FILE_SIZE];
    join(path, folder, lock_name);
    for (;;) {
        *lock = open(path, O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0666);
        if (*lock < 0)
            return fail_folder(path, "cannot lock the output folder", errno, error);
        bool locked = flock(*lock, LOCK_EX | LOCK_NB) == 0;
        if (locked && is_there(*lock, path)) {
            write_holder(*lock);
            return PEL_OK;
        }
        int number = errno;
        pel_status status = !locked && number == EWOULDBLOCK ? fail_locked(folder, *lock, error) : PEL_OK;
        close(*lock);
        *lock = -1;
        if (!locked)
            return status;
    }
}

void pel_run_folder_unlock(const char *folder, int lock)
{
    char path[PEL_RUN_FILE_SIZE];
    if (lock < 0)
        return;
    unlink(join(path, folder, lock_name));
    close(lock);
}

/* ms between tries, and the most of them */
enum { QUEUE_PAUSE = 10, QUEUE_TRIES = 500 };

int pel_run_folder_queue(const char *folder)
{
    char parent[PEL_RUN_FILE_SIZE];
    snprintf(parent, sizeof parent, "%s", folder);
    size_t length = strlen(parent);
    while (length > 1 && parent[length - 1] == '/')
        parent[--length] = '\0';
    char *slash = strrchr(parent, '/');
    if (slash == NULL)
        memcpy(parent, ".", 2);
    else
        slash[slash == parent] = '\0';
    int queue = open(parent, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    for (int i = 0; queue >= 0 && i < QUEUE_TRIES && flock(queue, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK; i++)
        nanosleep(&(struct timespec){.tv_nsec = QUEUE_PAUSE * 1000000}, NULL);
    return queue;
}

void pel_run_folder_leave_queue(int queue)
{
    if (queue >= 0)
        close(queue);
}

/* temporary files of pel_file_writer, left by a killed program */
static bool is_temporary(const char *name)
{
    size_t length = strlen(name);
    return strncmp(name, ".pellicle-", 10) == 0 && length > 4 && strcmp(name + length - 4, ".tmp") == 0;
}

/* ---- what is there before a run ---- */

/* nothing but what a killed program left */
static bool is_empty(const char *folder)
{
    DIR *stream = opendir(folder);
    bool empty = stream != NULL;
    for (struct dirent *entry = empty ? readdir(stream) : NULL; empty && entry != NULL; entry = readdir(stream))
        empty = strcmp(entry->d_name, ".") == 0 || strcmp(entry->d_name, "..") == 0 || is_temporary(entry->d_name) ||
                strcmp(entry->d_name, lock_name) == 0;
    if (stream != NULL)
        closedir(stream);
    return empty;
}

static pel_status fail_claim(const char *folder, const char *what, const char *remedy, pel_error *error)
{
    pel_fail(error, PEL_BAD_FILE, "%s", what);
    pel_fail_remedy(error, "%s", remedy);
    pel_fail_place(error, folder, 0, 0);
    return PEL_BAD_FILE;
}

/* whether the checkpoint is in the folder */
static bool is_home_of(const char *folder, const char *checkpoint)
{
    char file[PATH_MAX];
    struct stat there, here;
    if (realpath(checkpoint, file) == NULL)
        return false;
    *strrchr(file, '/') = '\0';
    return stat(file[0] != '\0' ? file : "/", &there) == 0 && stat(folder, &here) == 0 && there.st_dev == here.st_dev &&
           there.st_ino == here.st_ino;
}

/* the folder is the current one or above it: what follows would still be in the old one */
static bool is_around_us(const char *absolute)
{
    char here[PATH_MAX];
    const size_t length = strlen(absolute);
    return getcwd(here, sizeof here) == NULL ||
           (strncmp(here, absolute, length) == 0 && (here[length] == '/' || here[length] == '\0'));
}

static pel_status rename_aside(const char *folder, const char *absolute, const pel_log *log, pel_error *error)
{
    char aside[PATH_MAX + 24];
    struct stat information;
    int number = 1;
    do
        snprintf(aside, sizeof aside, "%s.%d", absolute, number++);
    while (lstat(aside, &information) == 0 && number < INT_MAX);
    if (rename(absolute, aside) != 0) {
        number = errno;
        fail_folder(folder, "cannot move the older run in the folder aside", number, error);
        pel_fail_remedy(error, "choose another output folder, or write over the older run with --overwrite");
        return PEL_BAD_FILE;
    }
    pel_log_line(log, "the older run in %s is %s now", folder, aside);
    return PEL_OK;
}

/* no other run may be in it meanwhile */
static pel_status move_aside(const char *folder, const pel_log *log, pel_error *error)
{
    char absolute[PATH_MAX];
    int lock;
    if (realpath(folder, absolute) == NULL)
        return fail_folder(folder, "cannot find the output folder", errno, error);
    if (is_around_us(absolute))
        return fail_claim(folder,
                          "the folder has an older run, and cannot move aside because the command runs inside it",
                          "choose another output folder, or write over the older run with --overwrite", error);
    pel_status status = pel_run_folder_lock(folder, &lock, error);
    if (status != PEL_OK)
        return status;
    /* the lock's file has no place in it */
    pel_run_folder_unlock(folder, lock);
    return rename_aside(folder, absolute, log, error);
}

pel_status pel_run_folder_claim(const char *folder, const char *resume, bool overwrite, const pel_log *log,
                                pel_error *error)
{
    struct stat information;
    if (stat(folder, &information) != 0 || !S_ISDIR(information.st_mode))
        return PEL_OK; /* making it tells */
    const bool marked = has_mark(folder);
    if (marked && !overwrite && resume == NULL)
        return move_aside(folder, log, error);
    if (marked || is_empty(folder) || (resume != NULL && is_home_of(folder, resume)))
        return PEL_OK;
    return fail_claim(
        folder, "the folder has files, and none that says that they are of a run",
        "choose a new or empty folder with -o; nothing was changed. a run of version 0.2.0 or before has no "
        "mark either: move or remove its folder yourself",
        error);
}

/* the number between two texts, such as f00012.vtp; -1 if the name does not match */
static int64_t number_in_name(const char *name, const char *before, const char *after)
{
    int64_t number = 0;
    size_t length = strlen(before);
    if (strncmp(name, before, length) != 0)
        return -1;
    const char *digits = name + length, *at = digits;
    for (; *at >= '0' && *at <= '9' && at - digits < 18; at++)
        number = 10 * number + (*at - '0');
    return at > digits && strcmp(at, after) == 0 ? number : -1;
}

/* the frame in the name of the file of a tool, such as t00012-0.vtp; -1 if the name does not match */
static int64_t tool_frame_in_name(const char *name)
{
    char before[32];
    const char *dash = strchr(name, '-');
    if (dash == NULL || (size_t)(dash - name) >= sizeof before || number_in_name(dash, "-", ".vtp") < 0)
        return -1;
    snprintf(before, sizeof before, "%.*s", (int)(dash - name), name);
    return number_in_name(before, "t", "");
}

static bool is_file(const char *name, pel_run_file file)
{
    return strcmp(name, pel_run_file_name(file)) == 0;
}

static bool is_run_file(const char *name)
{
    for (int file = 0; file < PEL_RUN_FILE_COUNT; file++)
        if (is_file(name, (pel_run_file)file))
            return true;
    return number_in_name(name, "checkpoint-", ".pel") >= 0;
}

static bool is_stale(const char *name, bool frames, int64_t first_frame, bool resume)
{
    if (is_temporary(name))
        return true;
    if (frames)
        return number_in_name(name, "f", ".vtp") >= first_frame || tool_frame_in_name(name) >= first_frame;
    return resume ? is_file(name, PEL_RUN_SUMMARY) || is_file(name, PEL_RUN_FINAL) : is_run_file(name);
}

static pel_status clear_folder(const char *folder, bool frames, int64_t first_frame, bool resume, bool *removed,
                               pel_error *error)
{
    DIR *stream = opendir(folder);
    if (stream == NULL)
        return fail_folder(folder, "cannot read the folder", errno, error);
    pel_status status = PEL_OK;
    for (struct dirent *entry = readdir(stream); status == PEL_OK && entry != NULL; entry = readdir(stream)) {
        if (!is_stale(entry->d_name, frames, first_frame, resume))
            continue;
        if (unlinkat(dirfd(stream), entry->d_name, 0) == 0) {
            *removed = true;
        } else {
            int number = errno;
            char path[PEL_RUN_FILE_SIZE + sizeof entry->d_name];
            snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
            status = fail_folder(path, "cannot remove the file of an older run", number, error);
        }
    }
    closedir(stream);
    return status;
}

pel_status pel_run_folder_clear(const char *folder, int64_t first_frame, bool resume, bool *removed, pel_error *error)
{
    char path[PEL_RUN_FILE_SIZE];
    *removed = false;
    pel_status status = clear_folder(folder, false, first_frame, resume, removed, error);
    if (status == PEL_OK)
        status = clear_folder(join(path, folder, "frames"), true, first_frame, resume, removed, error);
    return status;
}

bool pel_run_folder_takes(const char *folder, const char *path, bool resume, bool overwrite)
{
    char file[PATH_MAX];
    struct stat there, here;
    if (realpath(path, file) == NULL)
        return false;
    if (!resume && !overwrite && has_mark(folder))
        return pel_file_check_inside(folder, path, NULL) == PEL_OK;
    char *slash = strrchr(file, '/');
    *slash = '\0';
    return is_stale(slash + 1, false, 0, resume) && stat(slash > file ? file : "/", &there) == 0 &&
           stat(folder, &here) == 0 && there.st_dev == here.st_dev && there.st_ino == here.st_ino;
}

/* a name that pel_run_folder_clear takes for a left-over */
static const char reserve_name[] = ".pellicle-reserve.tmp";

bool pel_run_folder_reserve(const char *folder, size_t size)
{
    char path[PEL_RUN_FILE_SIZE];
    int descriptor = open(join(path, folder, reserve_name), O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
    if (descriptor < 0)
        return false;
    bool reserved = posix_fallocate(descriptor, 0, (off_t)size) == 0;
    close(descriptor);
    if (!reserved)
        unlink(path);
    return reserved;
}

void pel_run_folder_release(const char *folder)
{
    char path[PEL_RUN_FILE_SIZE];
    unlink(join(path, folder, reserve_name));
}
