#include "live/keep.h"

#include "base/memory.h"
#include "base/status.h"
#include "io/file.h"

#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

static const char head[] = "# pellicle live: %" PRId64 " steps\n";

pel_status pel_keep_write(const char *path, const pel_session *session, int64_t steps, pel_error *error)
{
    char *text = NULL;
    pel_file_writer writer;
    pel_status status = pel_session_scene(session, &text, error);
    if (status != PEL_OK)
        return status;
    if (strstr(text, "\nsession:\n") == NULL) {
        pel_session_free_text(text);
        if (unlink(path) == 0 || errno == ENOENT)
            return PEL_OK;
        pel_fail(error, PEL_BAD_FILE, "cannot remove the file: %s", strerror(errno));
        pel_fail_place(error, path, 0, 0);
        return PEL_BAD_FILE;
    }
    status = pel_file_writer_open(&writer, path, error);
    if (status == PEL_OK) {
        pel_file_writer_printf(&writer, head, steps);
        pel_file_writer_write(&writer, text, strlen(text));
        status = pel_file_writer_commit(&writer, error);
    }
    pel_session_free_text(text);
    return status;
}

static pel_status parse(const char *path, const char *scene_path, const char *text, size_t size, pel_kept *kept,
                        pel_error *error)
{
    if (sscanf(text, "# pellicle live: %" SCNd64 " steps", &kept->steps) != 1 || kept->steps < 0) {
        pel_fail(error, PEL_BAD_FORMAT, "this is no kept state of pellicle live");
        pel_fail_remedy(error, "remove the file");
        pel_fail_place(error, path, 0, 0);
        return PEL_BAD_FORMAT;
    }
    pel_status status = pel_scene_parse(scene_path, text, size, NULL, 0, NULL, &kept->scene, error);
    if (status != PEL_OK)
        return status;
    kept->commands = kept->scene->session;
    kept->command_count = kept->scene->session_count;
    kept->scene->session_count = 0;
    return PEL_OK;
}

pel_status pel_keep_read(const char *path, const char *scene_path, pel_kept *kept, pel_error *error)
{
    char *text = NULL;
    size_t size = 0;
    *kept = (pel_kept){0};
    if (access(path, F_OK) != 0 && errno == ENOENT)
        return PEL_OK;
    pel_status status = pel_file_read(path, &text, &size, error);
    if (status == PEL_OK)
        status = parse(path, scene_path, text, size, kept, error);
    pel_free(text);
    if (status != PEL_OK)
        *kept = (pel_kept){0};
    return status;
}
