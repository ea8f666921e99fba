/* PC2, the point cache 2 of 3ds Max: a head of 32 bytes, then the vertices of each sample as floats, little endian:
       char signature[12] = "POINTCACHE2\0"; int32 version = 1; int32 vertices; float start; float rate; int32 samples
 */
#include "io/export.h"

#include "base/memory.h"
#include "base/status.h"
#include "io/bytes.h"
#include "io/file.h"

enum { HEAD_SIZE = 32 };

pel_status pel_export_fail_changed(const pel_frames *frames, int32_t frame, pel_error *error)
{
    pel_fail(error, PEL_BAD_FORMAT, "the triangles of this frame are not those of the first");
    pel_fail_remedy(error, "this format holds one set of triangles: export numbered OBJ or PLY files instead");
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

static pel_status check(const pel_frames *frames, pel_frames_outline *outline, pel_error *error)
{
    pel_status status = pel_frames_check(frames, outline, error);
    if (status == PEL_OK && outline->changed_frame >= 0)
        return pel_export_fail_changed(frames, outline->changed_frame, error);
    for (int i = 0; status == PEL_OK && i < 3; i++)
        if (!pel_export_fits_float(outline->low[i]) || !pel_export_fits_float(outline->high[i]))
            return pel_export_fail_large(frames, 0, error);
    return status;
}

static void write_head(pel_file_writer *writer, int32_t vertex_count, int32_t frame_count)
{
    char head[HEAD_SIZE] = "POINTCACHE2";
    pel_store_bytes(head + 12, 4, false, 1);
    pel_store_bytes(head + 16, 4, false, (uint64_t)vertex_count);
    pel_store_float(head + 20, false, 0);
    pel_store_float(head + 24, false, 1);
    pel_store_bytes(head + 28, 4, false, (uint64_t)frame_count);
    pel_file_writer_write(writer, head, sizeof head);
}

static pel_status write_frames(pel_file_writer *writer, const pel_frames *frames, int32_t vertex_count, char *bytes,
                               pel_error *error)
{
    pel_status status = PEL_OK;
    for (int32_t f = 0; status == PEL_OK && f < frames->frame_count; f++) {
        pel_mesh *mesh;
        status = pel_frames_read(frames, f, &mesh, error);
        if (status == PEL_OK && mesh->vertex_count != vertex_count)
            status = pel_export_fail_changed(frames, f, error);
        for (int32_t v = 0; status == PEL_OK && v < vertex_count; v++)
            for (int i = 0; i < 3; i++)
                pel_store_float(bytes + 12 * (size_t)v + 4 * i, false, (float)mesh->positions[v][i]);
        if (status == PEL_OK)
            pel_file_writer_write(writer, bytes, 12 * (size_t)vertex_count);
        pel_mesh_destroy(mesh);
    }
    return status;
}

pel_status pel_export_pc2(const char *path, const pel_frames *frames, pel_error *error)
{
    pel_frames_outline outline;
    pel_file_writer writer;
    pel_status status = check(frames, &outline, error);
    if (status != PEL_OK)
        return status;
    char *bytes = pel_allocate((size_t)outline.vertex_count, 12);
    status = bytes != NULL ? pel_file_writer_open(&writer, path, error) : pel_fail_memory(error);
    if (status == PEL_OK) {
        write_head(&writer, outline.vertex_count, frames->frame_count);
        status = write_frames(&writer, frames, outline.vertex_count, bytes, error);
        if (status == PEL_OK)
            status = pel_file_writer_commit(&writer, error);
        else
            pel_file_writer_abandon(&writer);
    }
    pel_free(bytes);
    return status;
}
