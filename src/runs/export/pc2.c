/* PC2, the point cache 2 of 3ds Max: a head of 32 bytes, then the vertices of each sample as floats, little endian:
       char signature[12] = "POINTCACHE2\0"; int32 version = 1; int32 vertices; float start; float rate; int32 samples
 */
#include "export/export.h"

#include "base/memory.h"
#include "base/status.h"
#include "io/bytes.h"
#include "io/file.h"

#include <stdio.h>
#include <string.h>

enum { HEAD_SIZE = 32 };

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

/* the bodies, or a tool */
enum { BODIES = -1 };
static const char bodies_name[] = "bodies";

static pel_status read_part(const pel_export_source *source, int32_t frame, int32_t part, pel_mesh **mesh,
                            pel_error *error)
{
    return part == BODIES ? pel_export_read_bodies(source, frame, mesh, error)
                          : pel_export_read_tool(source, frame, part, mesh, error);
}

static pel_status write_frames(pel_file_writer *writer, const pel_export_source *source, int32_t part, char *bytes,
                               pel_error *error)
{
    pel_status status = PEL_OK;
    for (int32_t f = 0; status == PEL_OK && f < source->frames->frame_count; f++) {
        pel_mesh *mesh;
        status = read_part(source, f, part, &mesh, error);
        for (int32_t v = 0; status == PEL_OK && v < mesh->vertex_count; v++)
            for (int i = 0; i < 3; i++)
                pel_store_float(bytes + 12 * (size_t)v + 4 * i, false, (float)mesh->positions[v][i]);
        if (status == PEL_OK)
            pel_file_writer_write(writer, bytes, 12 * (size_t)mesh->vertex_count);
        pel_mesh_destroy(mesh);
    }
    return status;
}

static pel_status write_file(const char *path, const pel_export_source *source, int32_t part, pel_error *error)
{
    pel_file_writer writer;
    int32_t vertex_count = part == BODIES ? source->body_vertex_count : source->tools[part]->vertex_count;
    char *bytes = pel_allocate((size_t)vertex_count, 12);
    pel_status status = bytes != NULL ? pel_file_writer_open(&writer, path, error) : pel_fail_memory(error);
    if (status == PEL_OK) {
        write_head(&writer, vertex_count, source->frames->frame_count);
        status = write_frames(&writer, source, part, bytes, error);
        if (status == PEL_OK)
            status = pel_file_writer_commit(&writer, error);
        else
            pel_file_writer_abandon(&writer);
    }
    pel_free(bytes);
    return status;
}

/* out/ball.pc2 and tool 0, 'tip of forceps': out/ball-tip_of_forceps_0 and the ending; the bodies: out/ball-bodies */
static void part_path(char text[PEL_EXPORT_PATH_SIZE], const char *path, const char *name, int32_t part,
                      const char *ending)
{
    const char *slash = strrchr(path, '/'), *dot = strrchr(path, '.');
    size_t stem = dot != NULL && (slash == NULL || dot > slash) ? (size_t)(dot - path) : strlen(path);
    char safe[PEL_NAME_SIZE + 16];
    bool changed = part != BODIES && (name[0] == '\0' || strcmp(name, bodies_name) == 0);
    size_t length = 0;
    for (; name[length] != '\0' && length + 1 < PEL_NAME_SIZE; length++) {
        char c = name[length];
        bool is_safe =
            (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '_';
        safe[length] = is_safe ? c : '_';
        changed |= !is_safe;
    }
    safe[length] = '\0';
    if (changed)
        snprintf(safe + length, 16, "_%d", (int)part);
    snprintf(text, PEL_EXPORT_PATH_SIZE, "%.*s-%s%s", (int)stem, path, safe, ending);
}

/* the mesh of the cache of a part: one object */
static pel_status write_mesh(const char *path, const pel_export_source *source, int32_t part, pel_error *error)
{
    pel_mesh *mesh, *bare = NULL;
    pel_status status = read_part(source, 0, part, &mesh, error);
    if (status == PEL_OK)
        status = pel_mesh_create(mesh->positions[0], mesh->vertex_count, mesh->triangles[0], mesh->triangle_count,
                                 &bare, error);
    if (status == PEL_OK)
        status = pel_mesh_write(path, PEL_FORMAT_OBJ, bare, NULL, error);
    pel_mesh_destroy(bare);
    pel_mesh_destroy(mesh);
    return status;
}

/* a mesh for the bodies, and a mesh and a cache for each tool */
static pel_status write_parts(const char *path, const pel_export_source *source, pel_error *error)
{
    char file[PEL_EXPORT_PATH_SIZE];
    part_path(file, path, bodies_name, BODIES, ".obj");
    pel_status status = write_mesh(file, source, BODIES, error);
    for (int32_t i = 0; status == PEL_OK && i < source->frames->tool_count; i++) {
        const char *name = source->frames->tool_names[i];
        if (source->tools[i] == NULL)
            continue;
        part_path(file, path, name, i, ".obj");
        status = write_mesh(file, source, i, error);
        part_path(file, path, name, i, ".pc2");
        if (status == PEL_OK)
            status = write_file(file, source, i, error);
    }
    return status;
}

pel_status pel_export_pc2(const char *path, const pel_frames *frames, pel_error *error)
{
    PEL_REFUSE_NULL(path, error);
    PEL_REFUSE_NULL(frames, error);
    if (strlen(path) + PEL_NAME_SIZE + 32 > PEL_EXPORT_PATH_SIZE)
        return pel_fail(error, PEL_BAD_ARGUMENT, "the path has %zu characters, more than can be given to tools",
                        strlen(path));
    pel_export_source source;
    pel_status status = pel_export_open(&source, frames, error);
    if (status == PEL_OK)
        status = pel_export_check_size(&source, error);
    if (status == PEL_OK)
        status = write_file(path, &source, BODIES, error);
    if (status == PEL_OK)
        status = write_parts(path, &source, error);
    pel_export_close(&source);
    return status;
}
