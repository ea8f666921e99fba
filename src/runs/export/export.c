#include "export/export.h"

#include "base/assert.h"
#include "base/memory.h"
#include "base/status.h"
#include "math/extremes.h"

#include <string.h>

/* larger values are not numbers of bodies */
#define MOST_PARTS 65536.0

/* ---- parts ---- */

int32_t pel_export_part_count(const pel_mesh *mesh)
{
    const pel_field *body = pel_mesh_field(mesh, "body");
    double most = 0;
    for (int32_t v = 0; body != NULL && body->component_count == 1 && v < mesh->vertex_count; v++)
        most = pel_max(most, body->values[v]);
    return most < MOST_PARTS ? (int32_t)most + 1 : 1;
}

const char *pel_export_tool_name(const pel_export_source *source, int32_t part)
{
    return source != NULL && part >= source->body_count ? source->frames->tool_names[part - source->body_count] : NULL;
}

/* the first surface of each tool */
static pel_status read_tools(pel_export_source *source, pel_error *error)
{
    const pel_frames *frames = source->frames;
    pel_status status = PEL_OK;
    source->tools = pel_allocate((size_t)frames->tool_count, sizeof *source->tools);
    if (source->tools == NULL)
        return pel_fail_memory(error);
    for (int32_t i = 0; status == PEL_OK && i < frames->tool_count; i++) {
        for (int32_t f = 0; status == PEL_OK && source->tools[i] == NULL && f < frames->frame_count; f++)
            status = pel_frames_read_tool(frames, f, i, &source->tools[i], error);
        if (source->tools[i] != NULL)
            source->vertex_count += source->tools[i]->vertex_count;
    }
    return status;
}

/* ---- the bodies ---- */

static pel_status open_bodies(pel_export_source *source, pel_error *error)
{
    const pel_frames *frames = source->frames;
    pel_status status = pel_frames_check(frames, &source->outline, error);
    source->body_vertex_count = source->outline.vertex_count;
    if (status != PEL_OK || source->outline.changed_frame < 0)
        return status;
    status = pel_opened_mesh_create(frames, &source->opened, error);
    if (status != PEL_OK || source->opened != NULL) {
        source->body_vertex_count = source->opened != NULL ? source->opened->vertex_count : 0;
        return status;
    }
    status = pel_common_mesh_check(frames, source->outline.changed_frame, error);
    if (status == PEL_OK)
        status = pel_common_mesh_create(frames, &source->common, error);
    if (status == PEL_OK)
        source->body_vertex_count = pel_common_mesh_vertex_count(source->common);
    return status;
}

pel_status pel_export_read_bodies(const pel_export_source *source, int32_t frame, pel_mesh **mesh, pel_error *error)
{
    if (source->common != NULL)
        return pel_common_mesh_read(source->common, frame, mesh, error);
    if (source->opened != NULL)
        return pel_opened_mesh_read(source->opened, frame, mesh, error);
    pel_status status = pel_frames_read(source->frames, frame, mesh, error);
    /* files may change between one reading and the next */
    if (status == PEL_OK && (*mesh)->vertex_count != source->body_vertex_count) {
        status = pel_export_fail_changed(source->frames, frame, error);
        pel_mesh_destroy(*mesh);
        *mesh = NULL;
    }
    return status;
}

pel_status pel_export_open(pel_export_source *source, const pel_frames *frames, pel_error *error)
{
    pel_mesh *first = NULL;
    *source = (pel_export_source){.frames = frames};
    pel_status status = open_bodies(source, error);
    if (status == PEL_OK)
        status = pel_export_read_bodies(source, 0, &first, error);
    if (status != PEL_OK)
        return status;
    source->body_count = pel_export_part_count(first);
    source->vertex_count = source->body_vertex_count;
    pel_mesh_destroy(first);
    return read_tools(source, error);
}

void pel_export_close(pel_export_source *source)
{
    pel_common_mesh_destroy(source->common);
    for (int32_t i = 0; source->tools != NULL && i < source->frames->tool_count; i++)
        pel_mesh_destroy(source->tools[i]);
    pel_free(source->tools);
    pel_opened_mesh_destroy(source->opened);
    source->common = NULL;
    source->opened = NULL;
    source->tools = NULL;
}

/* ---- bodies and tools ---- */

/* room for the bodies and all tools; positions, triangles and fields are those of the bodies */
static pel_status grow(const pel_export_source *source, const pel_mesh *bodies, pel_mesh **mesh, pel_error *error)
{
    int32_t vertex_count = source->vertex_count, triangle_count = bodies->triangle_count;
    for (int32_t i = 0; i < source->frames->tool_count; i++)
        triangle_count += source->tools[i] != NULL ? source->tools[i]->triangle_count : 0;
    double(*positions)[3] = pel_allocate((size_t)vertex_count, sizeof *positions);
    int32_t(*triangles)[3] = pel_allocate((size_t)triangle_count, sizeof *triangles);
    pel_status status = positions != NULL && triangles != NULL ? PEL_OK : pel_fail_memory(error);
    if (status == PEL_OK) {
        memcpy(positions, bodies->positions, (size_t)bodies->vertex_count * sizeof *positions);
        memcpy(triangles, bodies->triangles, (size_t)bodies->triangle_count * sizeof *triangles);
        status = pel_mesh_create(positions[0], vertex_count, triangles[0], triangle_count, mesh, error);
    }
    pel_free(triangles);
    pel_free(positions);
    for (int32_t f = 0; status == PEL_OK && f < bodies->field_count; f++) {
        const pel_field *field = &bodies->fields[f];
        status = pel_mesh_add_field(*mesh, field->name, field->component_count, NULL, error);
        if (status == PEL_OK)
            memcpy(pel_mesh_field(*mesh, field->name)->values, field->values,
                   (size_t)bodies->vertex_count * (size_t)field->component_count * sizeof *field->values);
    }
    if (status == PEL_OK && pel_mesh_field(*mesh, "body") == NULL)
        status = pel_mesh_add_field(*mesh, "body", 1, NULL, error);
    return status;
}

pel_status pel_export_read_tool(const pel_export_source *source, int32_t frame, int32_t tool, pel_mesh **mesh,
                                pel_error *error)
{
    const pel_mesh *base = source->tools[tool];
    pel_mesh *now = NULL;
    *mesh = NULL;
    pel_status status = pel_frames_read_tool(source->frames, frame, tool, &now, error);
    if (status != PEL_OK)
        return status;
    bool is_there = now != NULL && now->vertex_count == base->vertex_count;
    const double *positions = (is_there ? now : base)->positions[0];
    status = pel_mesh_create(positions, base->vertex_count, base->triangles[0], base->triangle_count, mesh, error);
    pel_mesh_destroy(now);
    return status;
}

/* the surfaces of all tools after the bodies, each at its pose in the frame */
static pel_status add_tools(const pel_export_source *source, int32_t frame, const pel_mesh *bodies, pel_mesh *mesh,
                            pel_error *error)
{
    int32_t v = bodies->vertex_count, t = bodies->triangle_count;
    double *part = pel_mesh_field(mesh, "body")->values;
    for (int32_t i = 0; i < source->frames->tool_count; i++) {
        pel_mesh *now = NULL;
        if (source->tools[i] == NULL)
            continue;
        pel_status status = pel_export_read_tool(source, frame, i, &now, error);
        if (status != PEL_OK)
            return status;
        memcpy(mesh->positions[v], now->positions[0], (size_t)now->vertex_count * sizeof *mesh->positions);
        for (int32_t k = 0; k < now->triangle_count; k++, t++)
            for (int c = 0; c < 3; c++)
                mesh->triangles[t][c] = now->triangles[k][c] + v;
        for (int32_t k = 0; k < now->vertex_count; k++)
            part[v + k] = source->body_count + i;
        v += now->vertex_count;
        pel_mesh_destroy(now);
    }
    return PEL_OK;
}

pel_status pel_export_read(const pel_export_source *source, int32_t frame, pel_mesh **mesh, pel_error *error)
{
    pel_status status = pel_export_read_bodies(source, frame, mesh, error);
    if (status != PEL_OK || source->vertex_count == source->body_vertex_count)
        return status;
    pel_mesh *bodies = *mesh;
    *mesh = NULL;
    status = grow(source, bodies, mesh, error);
    if (status == PEL_OK)
        status = add_tools(source, frame, bodies, *mesh, error);
    pel_mesh_destroy(bodies);
    if (status != PEL_OK) {
        pel_mesh_destroy(*mesh);
        *mesh = NULL;
    }
    return status;
}

/* ---- complaints ---- */

pel_status pel_export_fail_changed(const pel_frames *frames, int32_t frame, pel_error *error)
{
    PEL_ASSERT_INDEX(frame, frames->frame_count);
    pel_fail(error, PEL_BAD_FORMAT, "the triangles of this frame are not those of the first");
    pel_fail_remedy(error, "make sure that no other program writes into the folder");
    pel_fail_place(error, frames->paths[frame], 0, 0);
    return PEL_BAD_FORMAT;
}

pel_status pel_export_fail_large(const pel_frames *frames, int32_t frame, pel_error *error)
{
    PEL_ASSERT_INDEX(frame, frames->frame_count);
    pel_fail(error, PEL_BAD_FORMAT, "a coordinate is too large for a 32-bit number");
    pel_fail_remedy(error, "export numbered OBJ or PLY files instead");
    pel_fail_place(error, frames->paths[frame], 0, 0);
    return PEL_BAD_FORMAT;
}

/* ---- checks ---- */

pel_status pel_export_check_times(const pel_frames *frames, pel_error *error)
{
    for (int32_t f = 1; f < frames->frame_count; f++) {
        const double *times = frames->times;
        if ((float)times[f] > (float)times[f - 1] && times[f - 1] >= 0)
            continue;
        pel_fail(error, PEL_BAD_FORMAT, "the frame's time %g s is not later than %g s, that of the frame before",
                 times[f], times[f - 1]);
        pel_fail_remedy(error, "export a point cache (.pc2), which holds no times");
        pel_fail_place(error, frames->paths[f], 0, 0);
        return PEL_BAD_FORMAT;
    }
    return PEL_OK;
}

pel_status pel_export_check_size(const pel_export_source *source, pel_error *error)
{
    for (int i = 0; i < 3; i++)
        if (!pel_export_fits_float(source->outline.low[i]) || !pel_export_fits_float(source->outline.high[i]))
            return pel_export_fail_large(source->frames, 0, error);
    return PEL_OK;
}
