/* Binary glTF 2.0 (Khronos): a head, a chunk of JSON and a chunk of numbers, all little endian:

       "glTF" 2 length | length "JSON" text | length "BIN" indices, frame 0, frame 1, ..., times, weights

   Each body and each tool is a node with its own mesh: a part. Indices are those of part 0, then of part 1, ...; a
   frame is the positions and then the normals (vertices x 3 floats each) of part 0, then of part 1, ..., frame 0 as
   positions, the others as differences from frame 0: morph targets. Weight t of the animation's key k is 1 for t = k -
   1 and else 0, so that linear interpolation goes from frame to frame. */
#include "export/export.h"
#include "export/parts.h"

#include "base/room.h"
#include "base/status.h"
#include "io/bytes.h"
#include "io/file.h"
#include "io/json.h"

#include <stdio.h>
#include <string.h>

enum { HEAD_SIZE = 12, CHUNK_HEAD_SIZE = 8, UNSIGNED_INT = 5125, FLOAT = 5126, ARRAY = 34962, INDICES = 34963 };

typedef struct glb {
    const pel_export_source *source; /* null: a single mesh */
    const pel_frames *frames;        /* null as well */
    const pel_mesh *first;
    int32_t frame_count;
    size_t vertex_count, index_count;
    pel_export_parts by;
    double (*normals)[3]; /* (vertex_count x 3) */
    float *base;          /* (vertex_count x 6) frame 0: positions, normals of each part */
    float *current;       /* the same of the frame at hand, as the file holds it */
    char *bytes;          /* (vertex_count x 24) or the indices */
    double (*bounds)[6];  /* (frame_count x part_count) least and largest of the positions that the file holds */
} glb;

static void free_buffers(glb *g)
{
    PEL_FREE_ALL(g->bounds, g->bytes, g->current, g->base, g->normals);
    pel_export_parts_free(&g->by);
}

static pel_status make_buffers(glb *g, pel_error *error)
{
    size_t largest = 24 * g->vertex_count > 4 * g->index_count ? 24 * g->vertex_count : 4 * g->index_count;
    bool made = PEL_ALLOCATE_ALL(PEL_ROOM(g->normals, g->vertex_count), PEL_ROOM(g->base, 6 * g->vertex_count),
                                 PEL_ROOM(g->current, 6 * g->vertex_count), PEL_ROOM(g->bytes, largest),
                                 PEL_ROOM(g->bounds, (size_t)g->frame_count * (size_t)g->by.count));
    return made ? PEL_OK : pel_fail_memory(error);
}

/* ---- frames ---- */

/* fill current with the stored values of the frame and its bounds; false if a coordinate does not fit into a float */
static bool encode_frame(glb *g, const pel_mesh *mesh, int32_t frame)
{
    double(*bounds)[6] = g->bounds + (size_t)frame * (size_t)g->by.count;
    pel_export_normals(mesh, g->normals);
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        int32_t p = g->by.part_of[v];
        const pel_export_part *of = &g->by.parts[p];
        size_t row = (size_t)g->by.place[v] - of->vertex_begin;
        for (size_t i = 0; i < 3; i++) {
            size_t at = 6 * of->vertex_begin + 3 * row + i, normal_at = 3 * of->vertex_count + at;
            if (!pel_export_fits_float(2 * mesh->positions[v][i]))
                return false;
            g->current[at] = (float)mesh->positions[v][i] - g->base[at];
            g->current[normal_at] = (float)g->normals[v][i] - g->base[normal_at];
            double x = (double)g->current[at];
            bounds[p][i] = row == 0 || x < bounds[p][i] ? x : bounds[p][i];
            bounds[p][3 + i] = row == 0 || x > bounds[p][3 + i] ? x : bounds[p][3 + i];
        }
    }
    return true;
}

static bool has_first_triangles(const glb *g, const pel_mesh *mesh)
{
    return (size_t)mesh->vertex_count == g->vertex_count && 3 * (size_t)mesh->triangle_count == g->index_count &&
           memcmp(mesh->triangles, g->first->triangles, g->index_count * sizeof(int32_t)) == 0;
}

/* reads a frame but the first and encodes it */
static pel_status load_frame(glb *g, int32_t frame, pel_error *error)
{
    pel_mesh *mesh;
    pel_status status = pel_export_read(g->source, frame, &mesh, error);
    if (status != PEL_OK)
        return status;
    if (!has_first_triangles(g, mesh))
        status = pel_export_fail_changed(g->frames, frame, error);
    else if (!encode_frame(g, mesh, frame))
        status = pel_export_fail_large(g->frames, frame, error);
    pel_mesh_destroy(mesh);
    return status;
}

static pel_status survey(glb *g, pel_error *error)
{
    if (!encode_frame(g, g->first, 0))
        return g->frames != NULL ? pel_export_fail_large(g->frames, 0, error)
                                 : pel_fail(error, PEL_BAD_ARGUMENT, "a coordinate is too large for a 32-bit number");
    memcpy(g->base, g->current, 6 * g->vertex_count * sizeof *g->base);
    pel_status status = g->frames != NULL ? pel_export_check_times(g->frames, error) : PEL_OK;
    for (int32_t f = 1; status == PEL_OK && f < g->frame_count; f++)
        status = load_frame(g, f, error);
    return status;
}

/* ---- JSON ---- */

static size_t frames_size(const glb *g)
{
    return 24 * g->vertex_count * (size_t)g->frame_count;
}

static size_t animation_size(const glb *g)
{
    size_t count = (size_t)g->frame_count;
    return count > 1 ? 4 * count + 4 * count * (count - 1) : 0;
}

/* numbers of accessors: indices of all parts, then positions and normals of all parts of frame 0, of frame 1, ... */
static int32_t accessor_of(const glb *g, int32_t frame, int32_t p)
{
    return g->by.count + 2 * (frame * g->by.count + p);
}

static void put_mesh(pel_json *json, const glb *g, int32_t p)
{
    int32_t first = accessor_of(g, 0, p);
    bool is_tool = pel_export_tool_name(g->source, p) != NULL;
    pel_json_print(json,
                   "%s{\"primitives\":[{\"attributes\":{\"POSITION\":%d,\"NORMAL\":%d},\"indices\":%d,\"material\":%d",
                   p > 0 ? "," : "", (int)first, (int)first + 1, (int)p, is_tool ? 1 : 0);
    for (int32_t f = 1; f < g->frame_count; f++) {
        int32_t target = accessor_of(g, f, p);
        pel_json_print(json, "%s{\"POSITION\":%d,\"NORMAL\":%d}", f > 1 ? "," : ",\"targets\":[", (int)target,
                       (int)target + 1);
    }
    pel_json_print(json, g->frame_count > 1 ? "]}],\"weights\":[" : "}]");
    for (int32_t f = 1; f < g->frame_count; f++)
        pel_json_print(json, f > 1 ? ",0" : "0");
    pel_json_print(json, g->frame_count > 1 ? "]}" : "}");
}

static void put_vertex_accessor(pel_json *json, const pel_export_part *of, size_t offset, const double *bounds)
{
    pel_json_print(json, ",{\"bufferView\":1,\"byteOffset\":%zu,\"componentType\":%d,\"count\":%zu,\"type\":\"VEC3\"",
                   offset, FLOAT, of->vertex_count);
    if (bounds != NULL) {
        pel_json_print(json, ",\"min\":");
        pel_json_put_numbers(json, bounds, 3);
        pel_json_print(json, ",\"max\":");
        pel_json_put_numbers(json, bounds + 3, 3);
    }
    pel_json_print(json, "}");
}

static void put_accessors(pel_json *json, const glb *g)
{
    pel_json_print(json, "\"accessors\":[");
    for (int32_t p = 0; p < g->by.count; p++)
        pel_json_print(json,
                       "%s{\"bufferView\":0,\"byteOffset\":%zu,\"componentType\":%d,\"count\":%zu,\"type\":\"SCALAR\"}",
                       p > 0 ? "," : "", 4 * g->by.parts[p].index_begin, UNSIGNED_INT, g->by.parts[p].index_count);
    for (int32_t f = 0; f < g->frame_count; f++)
        for (int32_t p = 0; p < g->by.count; p++) {
            const pel_export_part *of = &g->by.parts[p];
            size_t offset = 24 * (g->vertex_count * (size_t)f + of->vertex_begin);
            put_vertex_accessor(json, of, offset, g->bounds[f * g->by.count + p]);
            put_vertex_accessor(json, of, offset + 12 * of->vertex_count, NULL);
        }
    if (g->frame_count < 2) {
        pel_json_print(json, "]");
        return;
    }
    size_t count = (size_t)g->frame_count;
    pel_json_print(json, ",{\"bufferView\":2,\"componentType\":%d,\"count\":%zu,\"type\":\"SCALAR\",\"min\":[", FLOAT,
                   count);
    pel_json_put_number(json, (double)(float)g->frames->times[0]);
    pel_json_print(json, "],\"max\":[");
    pel_json_put_number(json, (double)(float)g->frames->times[count - 1]);
    pel_json_print(json,
                   "]},{\"bufferView\":2,\"byteOffset\":%zu,\"componentType\":%d,\"count\":%zu,\"type\":\"SCALAR\"}]",
                   4 * count, FLOAT, count * (count - 1));
}

static void put_views(pel_json *json, const glb *g)
{
    size_t indices = 4 * g->index_count, vertices = frames_size(g), animation = animation_size(g);
    pel_json_print(json, "\"bufferViews\":[{\"buffer\":0,\"byteLength\":%zu,\"target\":%d},", indices, INDICES);
    pel_json_print(json, "{\"buffer\":0,\"byteOffset\":%zu,\"byteLength\":%zu,\"byteStride\":12,\"target\":%d}",
                   indices, vertices, ARRAY);
    if (animation > 0)
        pel_json_print(json, ",{\"buffer\":0,\"byteOffset\":%zu,\"byteLength\":%zu}", indices + vertices, animation);
    pel_json_print(json, "],\"buffers\":[{\"byteLength\":%zu}]", indices + vertices + animation);
}

/* the z axis turned up */
static void put_node(pel_json *json, const glb *g, int32_t p)
{
    const char *tool = pel_export_tool_name(g->source, p);
    char body[32];
    snprintf(body, sizeof body, "body %d", (int)p);
    pel_json_print(json, "%s{\"mesh\":%d", p > 0 ? "," : "", (int)p);
    if (g->by.count > 1) {
        pel_json_print(json, ",\"name\":");
        pel_json_put_text(json, tool != NULL ? tool : body);
    }
    pel_json_print(json, ",\"rotation\":[-0.70710678,0,0,0.70710678]}");
}

/* one sampler moves the weights of all meshes */
static void put_animation(pel_json *json, const glb *g)
{
    int32_t times = accessor_of(g, g->frame_count, 0);
    pel_json_print(json, "\"animations\":[{\"channels\":[");
    for (int32_t p = 0; p < g->by.count; p++)
        pel_json_print(json, "%s{\"sampler\":0,\"target\":{\"node\":%d,\"path\":\"weights\"}}", p > 0 ? "," : "",
                       (int)p);
    pel_json_print(json, "],\"samplers\":[{\"input\":%d,\"output\":%d}]}],", (int)times, (int)times + 1);
}

static void put_material(pel_json *json, const char *colour)
{
    pel_json_print(json,
                   "{\"pbrMetallicRoughness\":{\"baseColorFactor\":[%s,1],\"metallicFactor\":0,"
                   "\"roughnessFactor\":0.6},\"doubleSided\":true}",
                   colour);
}

static void put_json(pel_json *json, const glb *g)
{
    pel_json_print(json, "{\"asset\":{\"version\":\"2.0\",\"generator\":\"pellicle " PEL_VERSION "\"},\"scene\":0,"
                         "\"scenes\":[{\"nodes\":[");
    for (int32_t p = 0; p < g->by.count; p++)
        pel_json_print(json, "%s%d", p > 0 ? "," : "", (int)p);
    pel_json_print(json, "]}],\"nodes\":[");
    for (int32_t p = 0; p < g->by.count; p++)
        put_node(json, g, p);
    pel_json_print(json, "],\"materials\":[");
    put_material(json, "0.8,0.55,0.45");
    if (pel_export_tool_name(g->source, g->by.count - 1) != NULL) {
        pel_json_print(json, ",");
        put_material(json, "0.45,0.5,0.56");
    }
    pel_json_print(json, "],\"meshes\":[");
    for (int32_t p = 0; p < g->by.count; p++)
        put_mesh(json, g, p);
    pel_json_print(json, "],");
    if (g->frame_count > 1)
        put_animation(json, g);
    put_accessors(json, g);
    pel_json_print(json, ",");
    put_views(json, g);
    pel_json_print(json, "}");
    /* chunks are padded to whole words */
    while (!json->failed && json->length % 4 != 0)
        pel_json_print(json, " ");
}

/* ---- writing ---- */

static void write_word(pel_file_writer *writer, uint64_t value)
{
    char bytes[4];
    pel_store_bytes(bytes, 4, false, value);
    pel_file_writer_write(writer, bytes, 4);
}

static void write_floats(pel_file_writer *writer, const float *values, size_t count, char *bytes)
{
    for (size_t i = 0; i < count; i++)
        pel_store_float(bytes + 4 * i, false, values[i]);
    pel_file_writer_write(writer, bytes, 4 * count);
}

static void write_animation(pel_file_writer *writer, const glb *g)
{
    char bytes[4];
    for (int32_t f = 0; f < g->frame_count; f++)
        write_floats(writer, &(float){(float)g->frames->times[f]}, 1, bytes);
    for (int32_t f = 0; f < g->frame_count; f++)
        for (int32_t target = 1; target < g->frame_count; target++)
            write_floats(writer, &(float){target == f ? 1 : 0}, 1, bytes);
}

static pel_status write_numbers(pel_file_writer *writer, glb *g, pel_error *error)
{
    for (size_t i = 0; i < g->index_count; i++)
        pel_store_bytes(g->bytes + 4 * i, 4, false, (uint64_t)g->by.indices[i]);
    pel_file_writer_write(writer, g->bytes, 4 * g->index_count);
    write_floats(writer, g->base, 6 * g->vertex_count, g->bytes);
    for (int32_t f = 1; f < g->frame_count; f++) {
        pel_status status = load_frame(g, f, error);
        if (status != PEL_OK)
            return status;
        write_floats(writer, g->current, 6 * g->vertex_count, g->bytes);
    }
    if (g->frame_count > 1)
        write_animation(writer, g);
    return PEL_OK;
}

static pel_status write_file(const char *path, glb *g, const pel_json *json, pel_error *error)
{
    size_t numbers = 4 * g->index_count + frames_size(g) + animation_size(g);
    size_t total = HEAD_SIZE + CHUNK_HEAD_SIZE + json->length + CHUNK_HEAD_SIZE + numbers;
    if (total > UINT32_MAX)
        return pel_refuse(error, PEL_BAD_ARGUMENT, "export a point cache (.pc2), or run the scene with fewer frames",
                          "the file would have %zu bytes; the format allows at most 4 GiB", total);
    pel_file_writer writer;
    pel_status status = pel_file_writer_open(&writer, path, error);
    if (status != PEL_OK)
        return status;
    pel_file_writer_write(&writer, "glTF", 4);
    write_word(&writer, 2);
    write_word(&writer, total);
    write_word(&writer, json->length);
    pel_file_writer_write(&writer, "JSON", 4);
    pel_file_writer_write(&writer, json->text, json->length);
    write_word(&writer, numbers);
    pel_file_writer_write(&writer, "BIN\0", 4);
    status = write_numbers(&writer, g, error);
    if (status == PEL_OK)
        return pel_file_writer_commit(&writer, error);
    pel_file_writer_abandon(&writer);
    return status;
}

static pel_status export_all(const char *path, const pel_export_source *source, const pel_mesh *first, pel_error *error)
{
    const pel_frames *frames = source != NULL ? source->frames : NULL;
    glb g = {
        .source = source,
        .frames = frames,
        .first = first,
        .frame_count = frames != NULL ? frames->frame_count : 1,
        .vertex_count = (size_t)first->vertex_count,
        .index_count = 3 * (size_t)first->triangle_count,
    };
    pel_json json = {0};
    pel_status status = pel_export_parts_create(first, &g.by, error);
    if (status == PEL_OK)
        status = make_buffers(&g, error);
    if (status == PEL_OK)
        status = survey(&g, error);
    if (status == PEL_OK) {
        put_json(&json, &g);
        status = json.failed ? pel_fail_memory(error) : write_file(path, &g, &json, error);
    }
    pel_json_free(&json);
    free_buffers(&g);
    return status;
}

pel_status pel_export_glb_mesh(const char *path, const pel_mesh *mesh, pel_error *error)
{
    PEL_REFUSE_NULL(path, error);
    PEL_REFUSE_NULL(mesh, error);
    return export_all(path, NULL, mesh, error);
}

pel_status pel_export_glb(const char *path, const pel_frames *frames, pel_error *error)
{
    PEL_REFUSE_NULL(path, error);
    PEL_REFUSE_NULL(frames, error);
    pel_export_source source;
    pel_mesh *first = NULL;
    pel_status status = pel_export_open(&source, frames, error);
    if (status == PEL_OK)
        status = pel_export_read(&source, 0, &first, error);
    if (status == PEL_OK)
        status = export_all(path, &source, first, error);
    pel_mesh_destroy(first);
    pel_export_close(&source);
    return status;
}
