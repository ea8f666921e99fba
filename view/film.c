/* ffmpeg reads raw pictures from its standard input and writes to a temporary name. The pipe is a pair of sockets,
   because writing to a closed one need not raise a signal. */
#define _XOPEN_SOURCE 700 /* fseeko */
#include "view/film.h"

#include "view/support.h"

#include <errno.h>
#include <fcntl.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

extern char **environ;

enum { PATH_SIZE = 4096 };

struct view_film {
    int pipe;
    pid_t child;
    bool broken; /* ffmpeg went away */
    char path[PATH_SIZE], temporary[PATH_SIZE + 32];
};

/* null when the socket cannot be made its standard input */
static pid_t spawn(const char *program, char *const *arguments, int input, int *number)
{
    posix_spawn_file_actions_t actions;
    pid_t child = -1;
    *number = posix_spawn_file_actions_init(&actions);
    if (*number != 0)
        return -1;
    *number = posix_spawn_file_actions_adddup2(&actions, input, 0);
    if (*number == 0)
        *number = posix_spawn_file_actions_addopen(&actions, 1, "/dev/null", O_WRONLY, 0);
    if (*number == 0)
        *number = posix_spawnp(&child, program, &actions, NULL, arguments, environ);
    posix_spawn_file_actions_destroy(&actions);
    return *number == 0 ? child : -1;
}

static pel_status start(view_film *film, int32_t width, int32_t height, double frame_rate, const char *program,
                        pel_error *error)
{
    int ends[2], number;
    char size[32], rate[32], name[] = "ffmpeg";
    snprintf(size, sizeof size, "%dx%d", (int)width, (int)height);
    snprintf(rate, sizeof rate, "%.6g", frame_rate);
    /* mp4: yuv420p needs even sizes; gif: one palette for the whole film */
    bool gif = view_ends_with(film->path, ".gif");
    const char *filter =
        gif ? "split[a][b];[a]palettegen=stats_mode=diff[p];[b][p]paletteuse=dither=bayer:bayer_scale=4"
            : "pad=ceil(iw/2)*2:ceil(ih/2)*2:color=white";
    const char *head[] = {name,       "-hide_banner", "-loglevel", "error",   "-xerror",   "-y",  "-f",
                          "rawvideo", "-pix_fmt",     "rgba",      "-s",      size,        "-r",  rate,
                          "-i",       "pipe:0",       "-an",       "-fflags", "+bitexact", "-vf", filter};
    const char *mp4[] = {"-c:v",      "libx264",    "-preset", "medium", "-crf",          "18", "-pix_fmt", "yuv420p",
                         "-movflags", "+faststart", "-f",      "mp4",    film->temporary, NULL};
    const char *loop[] = {"-loop", "0", "-f", "gif", film->temporary, NULL};
    char *arguments[sizeof head / sizeof *head + sizeof mp4 / sizeof *mp4];
    memcpy(arguments, head, sizeof head);
    memcpy(arguments + sizeof head / sizeof *head, gif ? loop : mp4, gif ? sizeof loop : sizeof mp4);
    if (socketpair(AF_UNIX, SOCK_STREAM, 0, ends) != 0) {
        pel_fail(error, PEL_BAD_FILE, "cannot make a pipe: %s", strerror(errno));
        pel_fail_remedy(error, "close other programs, or end the output name in .png");
        pel_fail_place(error, film->path, 0, 0);
        return PEL_BAD_FILE;
    }
    fcntl(ends[0], F_SETFD, FD_CLOEXEC);
    fcntl(ends[1], F_SETFD, FD_CLOEXEC);
    film->child = spawn(program != NULL ? program : name, arguments, ends[1], &number);
    close(ends[1]);
    film->pipe = ends[0];
    if (film->child > 0)
        return PEL_OK;
    pel_fail(error, PEL_BAD_ARGUMENT, "cannot make a film: %s does not start: %s", program != NULL ? program : name,
             strerror(number));
    pel_fail_place(error, film->path, 0, 0);
    pel_fail_remedy(error, "install the Debian package ffmpeg, or end the output's name in .png or name a folder");
    return PEL_BAD_ARGUMENT;
}

pel_status view_film_create(const char *path, int32_t width, int32_t height, double frame_rate, const char *program,
                            view_film **film, pel_error *error)
{
    *film = NULL;
    if (strlen(path) >= PATH_SIZE) {
        pel_fail(error, PEL_BAD_FILE, "the name is too long");
        pel_fail_remedy(error, "choose a shorter one");
        pel_fail_place(error, path, 0, 0);
        return PEL_BAD_FILE;
    }
    view_film *made = view_allocate(1, sizeof *made);
    if (made == NULL)
        return pel_fail_memory(error);
    made->pipe = -1;
    snprintf(made->path, sizeof made->path, "%s", path);
    snprintf(made->temporary, sizeof made->temporary, "%s.%ld.part", path, (long)getpid());
    pel_status status = start(made, width, height, frame_rate, program, error);
    if (status == PEL_OK)
        *film = made;
    else
        view_film_close(made, false, NULL);
    return status;
}

static pel_status fail_film(const view_film *film, const char *what, pel_error *error)
{
    pel_fail(error, PEL_BAD_FILE, "cannot write the film: %s", what);
    pel_fail_place(error, film->path, 0, 0);
    pel_fail_remedy(error, "see what ffmpeg says above, and check that the folder exists and that there is space");
    return PEL_BAD_FILE;
}

pel_status view_film_add(view_film *film, const view_image *image, pel_error *error)
{
    const uint8_t *at = image->pixels, *end = at + 4 * (size_t)image->width * (size_t)image->height;
    while (at < end) {
        ssize_t count = send(film->pipe, at, (size_t)(end - at), MSG_NOSIGNAL);
        if (count < 0 && errno == EINTR)
            continue;
        if (count < 0) {
            film->broken = true;
            return fail_film(film, "ffmpeg stopped", error);
        }
        at += count;
    }
    return PEL_OK;
}

/* Whether the boxes of an MP4 file fill it, one after the other, and the index is among them: ffmpeg may end well
   though the disk was full. */
static bool is_whole_mp4(const char *path)
{
    FILE *file = fopen(path, "rb");
    if (file == NULL)
        return false;
    bool index = false, media = false, whole = false;
    for (;;) {
        unsigned char head[16];
        size_t count = fread(head, 1, 8, file);
        whole = count == 0 && feof(file);
        if (count != 8)
            break;
        uint64_t size = 0, used = 8;
        for (int i = 0; i < 4; i++)
            size = size << 8 | head[i];
        if (size == 1) {
            used = 16;
            if (fread(head + 8, 1, 8, file) != 8)
                break;
            for (int i = 8; i < 16; i++)
                size = size << 8 | head[i];
        }
        index = index || memcmp(head + 4, "moov", 4) == 0;
        media = media || memcmp(head + 4, "mdat", 4) == 0;
        /* the last byte must be there, not only its place */
        if (size < used ||
            (size > used && (fseeko(file, (off_t)(size - used - 1), SEEK_CUR) != 0 || fgetc(file) == EOF)))
            break;
    }
    fclose(file);
    return whole && index && media;
}

/* whether a GIF file ends with its last mark */
static bool is_whole_gif(const char *path)
{
    FILE *file = fopen(path, "rb");
    bool whole = file != NULL && fseeko(file, -1, SEEK_END) == 0 && fgetc(file) == ';';
    if (file != NULL)
        fclose(file);
    return whole;
}

static bool is_whole(const view_film *film)
{
    return view_ends_with(film->path, ".gif") ? is_whole_gif(film->temporary) : is_whole_mp4(film->temporary);
}

pel_status view_film_close(view_film *film, bool keep, pel_error *error)
{
    if (film == NULL)
        return PEL_OK;
    int result = 0;
    pel_status status = PEL_OK;
    if (film->pipe >= 0)
        close(film->pipe);
    while (film->child > 0 && waitpid(film->child, &result, 0) < 0 && errno == EINTR)
        ;
    keep = keep && !film->broken && film->child > 0;
    if (keep && (!WIFEXITED(result) || WEXITSTATUS(result) != 0))
        status = fail_film(film, "ffmpeg failed", error);
    else if (keep && !is_whole(film))
        status = fail_film(film, "ffmpeg left it incomplete", error);
    else if (keep && rename(film->temporary, film->path) != 0)
        status = fail_film(film, strerror(errno), error);
    if (!keep || status != PEL_OK)
        unlink(film->temporary);
    free(film);
    return status;
}
