#ifdef PELLICLE_ASSIMP
#define _GNU_SOURCE /* dladdr, pipe2, environ */
#include "foreign/child.h"

#include "base/memory.h"
#include "base/patience.h"
#include "base/status.h"
#include "io/file.h"
#include "io/text_cursor.h"

#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

static const char *const remedy = "export the mesh again, preferably as PLY or OBJ";

/* what people have; everything else that assimp knows is refused */
static const char *const extensions[] = {"fbx", "dae", "3ds", "3mf", "amf", "dxf", "lwo", "x3d"};

static const char *extension_of(const char *path)
{
    const char *dot = strrchr(path, '.');
    for (size_t i = 0; dot != NULL && i < sizeof extensions / sizeof *extensions; i++) {
        pel_text_cursor ahead = {.at = dot + 1, .end = dot + strlen(dot)};
        if (pel_text_cursor_accept(&ahead, extensions[i]) && ahead.at == ahead.end)
            return extensions[i];
    }
    return NULL;
}

bool pel_foreign_is(const char *path)
{
    return extension_of(path) != NULL;
}

/* ---- the program ---- */

/* nobody else may have put it there */
static bool is_program(const char *path)
{
    struct stat information;
    return path[0] == '/' && stat(path, &information) == 0 && S_ISREG(information.st_mode) && access(path, X_OK) == 0 &&
           (information.st_uid == 0 || information.st_uid == geteuid());
}

/* `pellicle`, or bin/pellicle, beside a file or up to two folders above it */
static bool is_near(const char *file, char *path, size_t size)
{
    char folder[PATH_MAX];
    if (realpath(file, folder) == NULL)
        return false;
    for (int up = 0; up < 3; up++) {
        char *slash = strrchr(folder, '/');
        if (slash == NULL)
            return false;
        *slash = '\0';
        for (int inner = 0; inner < 2; inner++) {
            int length = snprintf(path, size, "%s/%spellicle", folder, inner ? "bin/" : "");
            if (length < (int)size && is_program(path))
                return true;
        }
    }
    return false;
}

static bool is_in_path(char *path, size_t size)
{
    const char *at = getenv("PATH");
    while (at != NULL && *at != '\0') {
        const size_t length = strcspn(at, ":");
        if (length < size && snprintf(path, size, "%.*s/pellicle", (int)length, at) < (int)size && is_program(path))
            return true;
        at += length + (at[length] == ':');
    }
    return false;
}

bool pel_foreign_program(char *path, size_t size)
{
    Dl_info own;
    const char *named = getenv("PELLICLE_PROGRAM");
    if (named != NULL)
        return snprintf(path, size, "%s", named) < (int)size && is_program(path);
    return (dladdr(__extension__(const void *) pel_foreign_program, &own) != 0 && own.dli_fname != NULL &&
            own.dli_fname[0] == '/' && is_near(own.dli_fname, path, size)) ||
           is_near("/proc/self/exe", path, size) || is_in_path(path, size);
}

/* ---- the child ---- */

typedef struct child {
    const char *path;
    pid_t pid;
    int from; /* its standard output */
    void *bytes;
    size_t size, capacity, limit;
    double wait_seconds;
    bool is_late, is_large;
} child;

static pel_status fail(const char *path, pel_error *error, const char *what)
{
    pel_fail(error, PEL_BAD_FORMAT, "%s", what);
    pel_fail_remedy(error, "%s", remedy);
    pel_fail_place(error, path, 0, 0);
    return PEL_BAD_FORMAT;
}

/* posix_spawn forks no threads of this process and runs nothing of it in the child */
static int spawn(const char *program, const char *path, child *made)
{
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0)
        return errno;
    posix_spawn_file_actions_t actions;
    int number = posix_spawn_file_actions_init(&actions);
    if (number == 0) {
        char command[] = PEL_CHILD_COMMAND, *file = pel_copy_string(path), *name = pel_copy_string(program);
        char *const arguments[] = {name, command, file, NULL};
        number = file == NULL || name == NULL ? ENOMEM : 0;
        if (number == 0)
            number = posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
        if (number == 0)
            number = posix_spawn_file_actions_adddup2(&actions, ends[1], 1);
        if (number == 0)
            number = posix_spawn_file_actions_addopen(&actions, 2, "/dev/null", O_WRONLY, 0);
        if (number == 0)
            number = posix_spawn(&made->pid, program, &actions, NULL, arguments, environ);
        posix_spawn_file_actions_destroy(&actions);
        pel_free(file);
        pel_free(name);
    }
    close(ends[1]);
    if (number != 0)
        close(ends[0]);
    made->from = ends[0];
    return number;
}

/* s between two questions whether the mesh is still wanted */
#define BEAT 0.1

/* all that the child says, until it ends, is late or says too much; false = out of memory, or it is not wanted */
static bool receive(child *c)
{
    const double end = pel_seconds() + c->wait_seconds;
    for (;;) {
        const double left = end - pel_seconds();
        struct pollfd ready = {.fd = c->from, .events = POLLIN};
        c->is_late = left <= 0;
        c->is_large = c->size > c->limit;
        if (c->is_late || c->is_large)
            return true;
        if (pel_patience_is_lost())
            return false;
        if (poll(&ready, 1, left < BEAT ? (int)(1000 * left) + 1 : (int)(1000 * BEAT)) <= 0)
            continue;
        if (!pel_reserve(&c->bytes, &c->capacity, c->size + (1 << 16), 1))
            return false;
        ssize_t count = read(c->from, (char *)c->bytes + c->size, c->capacity - c->size);
        if (count == 0 || (count < 0 && errno != EINTR && errno != EAGAIN))
            return true;
        c->size += count > 0 ? (size_t)count : 0;
    }
}

/* how it ended; -1 if another part of this process waited for it */
static int finish(const child *c, bool is_whole)
{
    int status = -1;
    if (!is_whole || c->is_late || c->is_large)
        kill(c->pid, SIGKILL);
    close(c->from);
    while (waitpid(c->pid, &status, 0) < 0)
        if (errno != EINTR)
            return -1;
    return status;
}

static pel_status fail_end(const child *c, int status, pel_error *error)
{
    char what[200];
    const char *format = extension_of(c->path);
    if (c->is_late || (status >= 0 && WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU))
        snprintf(what, sizeof what, "the reader of %s took more than %g s", format,
                 c->is_late ? c->wait_seconds : PEL_CHILD_CPU_SECONDS);
    else if (c->is_large)
        snprintf(what, sizeof what, "the reader of %s made more than %zu bytes", format, c->limit);
    else if (status >= 0 && WIFSIGNALED(status))
        snprintf(what, sizeof what, "the reader of %s died of the file: signal %d (%s)", format, WTERMSIG(status),
                 strsignal(WTERMSIG(status)));
    else
        snprintf(what, sizeof what, "the reader of %s gave no mesh (is it of another version of pellicle?)", format);
    return fail(c->path, error, what);
}

/* ---- what it says ---- */

static void tell_notes(const char *text, size_t length, const pel_log *log)
{
    for (const char *end = text + length; text < end; text += strlen(text) + 1)
        pel_log_line(log, "%s", text);
}

static pel_status take_failure(const child *c, const pel_child_head *head, const char *text, pel_error *error)
{
    const size_t what_length = strlen(text);
    if (head->status == PEL_OUT_OF_MEMORY)
        return pel_fail_memory(error);
    pel_fail(error, PEL_BAD_FORMAT, "%s", text);
    pel_fail_remedy(error, "%s", what_length + 1 < (size_t)head->text_length ? text + what_length + 1 : remedy);
    pel_fail_place(error, c->path, 0, 0);
    return PEL_BAD_FORMAT;
}

/* nothing of it is trusted: sizes, indices and numbers are checked */
static pel_status take_mesh(const child *c, int status, const pel_log *log, pel_mesh **mesh, pel_error *error)
{
    pel_child_head head;
    if (c->size < sizeof head)
        return fail_end(c, status, error);
    memcpy(&head, c->bytes, sizeof head);
    const size_t rest = c->size - sizeof head;
    if (memcmp(head.magic, PEL_CHILD_MAGIC, sizeof head.magic) != 0 || head.text_length < 1 || head.vertex_count < 0 ||
        head.triangle_count < 0 || (size_t)head.text_length > rest)
        return fail_end(c, status, error);
    const char *text = (const char *)c->bytes + sizeof head;
    const size_t positions_size = 24 * (size_t)head.vertex_count, triangles_size = 12 * (size_t)head.triangle_count;
    if (rest - (size_t)head.text_length != positions_size + triangles_size || text[head.text_length - 1] != '\0')
        return fail_end(c, status, error);
    if (head.status != PEL_OK)
        return take_failure(c, &head, text, error);
    double *positions = pel_allocate(3 * (size_t)head.vertex_count, sizeof *positions);
    int32_t *triangles = pel_allocate(3 * (size_t)head.triangle_count, sizeof *triangles);
    pel_status made = positions != NULL && triangles != NULL ? PEL_OK : pel_fail_memory(error);
    if (made == PEL_OK) {
        memcpy(positions, text + head.text_length, positions_size);
        memcpy(triangles, text + head.text_length + positions_size, triangles_size);
        tell_notes(text, (size_t)head.text_length - 1, log);
        made = pel_mesh_create(positions, head.vertex_count, triangles, head.triangle_count, mesh, error);
        if (made == PEL_BAD_ARGUMENT)
            made = fail_end(c, status, error);
    }
    pel_free(positions);
    pel_free(triangles);
    return made;
}

pel_status pel_foreign_read(const char *path, double wait_seconds, const pel_log *log, pel_mesh **mesh,
                            pel_error *error)
{
    char program[PATH_MAX];
    struct stat information;
    child c = {.path = path, .wait_seconds = wait_seconds};
    *mesh = NULL;
    pel_status status = pel_file_check(path, error);
    if (status != PEL_OK)
        return status;
    if (!pel_foreign_program(program, sizeof program)) {
        fail(path, error, "the program pellicle, which reads this format in a process of its own, is not found");
        pel_fail_remedy(error, "set PELLICLE_PROGRAM to its absolute path, or export the mesh as glTF, PLY or OBJ");
        return PEL_BAD_FORMAT;
    }
    c.limit = stat(path, &information) == 0 ? PEL_CHILD_MEMORY(information.st_size) : 0;
    const int number = spawn(program, path, &c);
    if (number == ENOMEM)
        return pel_fail_memory(error);
    if (number != 0) {
        char what[PATH_MAX + 100];
        snprintf(what, sizeof what, "cannot start %.200s: %s", program, strerror(number));
        return fail(path, error, what);
    }
    const bool is_whole = receive(&c);
    const int end = finish(&c, is_whole);
    const bool is_read = is_whole && !c.is_late && !c.is_large;
    if (!is_whole)
        status = pel_fail_memory(error);
    else
        status = is_read ? take_mesh(&c, end, log, mesh, error) : fail_end(&c, end, error);
    pel_free(c.bytes);
    return status;
}

#else
typedef int pel_nothing_foreign;
#endif
