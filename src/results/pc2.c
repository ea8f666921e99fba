/* PC2, the point cache 2 of 3ds Max: a head of 32 bytes, then the vertices of each sample as floats, little endian:
       char signature[12] = "POINTCACHE2\0"; int32 version = 1; int32 vertices; float start; float rate; int32 samples
 */
#include "results/export.h"

#include "base/memory.h"
#include "base/status.h"
#include "io/bytes.h"
#include "io/file.h"

enum { HEAD_SIZE = 32 };

static pel_status check_size(const pel_export_source *source, pel_error *error)
{
    for (int i = 0; i < 3; i++)
        if (!pel_export_fits_float(source->outline.low[i]) || !pel_export_fits_float(source->outline.high[i]))
            return pel_export_fail_large(source->frames, 0, error);
    return PEL_OK;
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

static pel_status write_frames(pel_file_writer *writer, const pel_export_source *source, char *bytes, pel_error *error)
{
    pel_status status = PEL_OK;
    for (int32_t f = 0; status == PEL_OK && f < source->frames->frame_count; f++) {
        pel_mesh *mesh;
        status = pel_export_read(source, f, &mesh, error);
        for (int32_t v = 0; status == PEL_OK && v < source->vertex_count; v++)
            for (int i = 0; i < 3; i++)
                pel_store_float(bytes + 12 * (size_t)v + 4 * i, false, (float)mesh->positions[v][i]);
        if (status == PEL_OK)
            pel_file_writer_write(writer, bytes, 12 * (size_t)source->vertex_count);
        pel_mesh_destroy(mesh);
    }
    return status;
}

static pel_status write_file(const char *path, const pel_export_source *source, pel_error *error)
{
    pel_file_writer writer;
    char *bytes = pel_allocate((size_t)source->vertex_count, 12);
    pel_status status = bytes != NULL ? pel_file_writer_open(&writer, path, error) : pel_fail_memory(error);
    if (status == PEL_OK) {
        write_head(&writer, source->vertex_count, source->frames->frame_count);
        status = write_frames(&writer, source, bytes, error);
        if (status == PEL_OK)
            status = pel_file_writer_commit(&writer, error);
        else
            pel_file_writer_abandon(&writer);
    }
    pel_free(bytes);
    return status;
}

pel_status pel_export_pc2(const char *path, const pel_frames *frames, pel_error *error)
{
    PEL_REFUSE_NULL(path, error);
    PEL_REFUSE_NULL(frames, error);
    pel_export_source source;
    pel_status status = pel_export_open(&source, frames, error);
    if (status == PEL_OK)
        status = check_size(&source, error);
    if (status == PEL_OK)
        status = write_file(path, &source, error);
    pel_export_close(&source);
    return status;
}
