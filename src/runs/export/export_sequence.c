#include "export/export.h"

#include "base/status.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

const char *pel_export_numbered_path(char text[PEL_EXPORT_PATH_SIZE], const char *path, int32_t frame)
{
    const char *slash = strrchr(path, '/'), *dot = strrchr(path, '.');
    size_t stem = dot != NULL && (slash == NULL || dot > slash) ? (size_t)(dot - path) : strlen(path);
    snprintf(text, PEL_EXPORT_PATH_SIZE, "%.*s_%05d%s", (int)stem, path, (int)frame, path + stem);
    return text;
}

static pel_status write_frame(const char *path, pel_mesh_format format, const pel_export_source *source, int32_t frame,
                              const pel_log *log, pel_error *error)
{
    char numbered[PEL_EXPORT_PATH_SIZE];
    pel_mesh *mesh;
    pel_status status = pel_export_read(source, frame, &mesh, error);
    if (status == PEL_OK)
        status = pel_mesh_write(pel_export_numbered_path(numbered, path, frame), format, mesh, log, error);
    pel_mesh_destroy(mesh);
    return status;
}

pel_status pel_export_sequence(const char *path, pel_mesh_format format, const pel_frames *frames, const pel_log *log,
                               pel_error *error)
{
    PEL_REFUSE_NULL(path, error);
    PEL_REFUSE_NULL(frames, error);
    pel_export_source source;
    if (strlen(path) + 16 > PEL_EXPORT_PATH_SIZE)
        return pel_fail(error, PEL_BAD_ARGUMENT, "the path has %zu characters, too many for numbered files",
                        strlen(path));
    pel_status status = pel_export_open(&source, frames, error);
    int32_t frame = 0;
    for (; status == PEL_OK && frame < frames->frame_count; frame++)
        status = write_frame(path, format, &source, frame, frame == 0 ? log : NULL, error);
    pel_export_close(&source);
    /* the last one failed and left nothing */
    for (int32_t written = 0; status != PEL_OK && written < frame - 1; written++) {
        char numbered[PEL_EXPORT_PATH_SIZE];
        unlink(pel_export_numbered_path(numbered, path, written));
    }
    return status;
}
