#include "results/export.h"

#include "base/status.h"

pel_status pel_export_open(pel_export_source *source, const pel_frames *frames, pel_error *error)
{
    *source = (pel_export_source){.frames = frames};
    pel_status status = pel_frames_check(frames, &source->outline, error);
    source->vertex_count = source->outline.vertex_count;
    if (status != PEL_OK || source->outline.changed_frame < 0)
        return status;
    status = pel_common_mesh_check(frames, source->outline.changed_frame, error);
    if (status == PEL_OK)
        status = pel_common_mesh_create(frames, &source->common, error);
    if (status == PEL_OK)
        source->vertex_count = pel_common_mesh_vertex_count(source->common);
    return status;
}

void pel_export_close(pel_export_source *source)
{
    pel_common_mesh_destroy(source->common);
    source->common = NULL;
}

pel_status pel_export_read(const pel_export_source *source, int32_t frame, pel_mesh **mesh, pel_error *error)
{
    if (source->common != NULL)
        return pel_common_mesh_read(source->common, frame, mesh, error);
    pel_status status = pel_frames_read(source->frames, frame, mesh, error);
    /* files may change between one reading and the next */
    if (status == PEL_OK && (*mesh)->vertex_count != source->vertex_count) {
        status = pel_export_fail_changed(source->frames, frame, error);
        pel_mesh_destroy(*mesh);
        *mesh = NULL;
    }
    return status;
}

pel_status pel_export_fail_changed(const pel_frames *frames, int32_t frame, pel_error *error)
{
    pel_fail(error, PEL_BAD_FORMAT, "the triangles of this frame are not those of the first");
    pel_fail_remedy(error, "let no other program write into the folder meanwhile");
    pel_fail_place(error, frames->paths[frame], 0, 0);
    return PEL_BAD_FORMAT;
}

pel_status pel_export_fail_large(const pel_frames *frames, int32_t frame, pel_error *error)
{
    pel_fail(error, PEL_BAD_FORMAT, "a coordinate is too large for a 32-bit number");
    pel_fail_remedy(error, "export numbered OBJ or PLY files instead");
    pel_fail_place(error, frames->paths[frame], 0, 0);
    return PEL_BAD_FORMAT;
}
