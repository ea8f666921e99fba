#include "results/opened_mesh.h"

#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"

#include <string.h>

static const int32_t *corners_of(const pel_mesh *mesh)
{
    return mesh->triangles[0];
}

/* takes the triangles of a frame over */
static pel_status take(pel_opened_mesh *opened, const pel_mesh *mesh, pel_error *error)
{
    PEL_FREE_ALL(opened->triangles, opened->corners);
    opened->vertex_count = mesh->vertex_count;
    opened->triangle_count = mesh->triangle_count;
    if (!PEL_ALLOCATE_ALL(PEL_ROOM(opened->triangles, mesh->triangle_count),
                          PEL_ROOM(opened->corners, mesh->vertex_count)))
        return pel_fail_memory(error);
    memcpy(opened->triangles, mesh->triangles, (size_t)mesh->triangle_count * sizeof *mesh->triangles);
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        opened->corners[v] = -1;
    for (int32_t c = 0; c < 3 * mesh->triangle_count; c++)
        opened->corners[corners_of(mesh)[c]] = c;
    return PEL_OK;
}

/* whether all corners of each vertex are one vertex in the frame too */
static bool fits(const pel_opened_mesh *opened, const pel_mesh *mesh)
{
    const int32_t *own = opened->triangles[0], *there = corners_of(mesh);
    if (mesh->triangle_count != opened->triangle_count || mesh->vertex_count > opened->vertex_count)
        return false;
    for (int32_t c = 0; c < 3 * mesh->triangle_count; c++)
        if (there[c] != there[opened->corners[own[c]]])
            return false;
    return true;
}

/* a vertex that no triangle has has no place in another frame */
static bool is_whole(const pel_opened_mesh *opened)
{
    for (int32_t v = 0; v < opened->vertex_count; v++)
        if (opened->corners[v] < 0)
            return false;
    return true;
}

/* the frame with the most vertices, and whether all others fit */
static pel_status survey(pel_opened_mesh *opened, bool *is_opened, pel_error *error)
{
    pel_status status = PEL_OK;
    for (int32_t f = 0; status == PEL_OK && f < opened->frames->frame_count; f++) {
        pel_mesh *mesh;
        status = pel_frames_read(opened->frames, f, &mesh, error);
        if (status == PEL_OK && mesh->vertex_count > opened->vertex_count)
            status = take(opened, mesh, error);
        pel_mesh_destroy(mesh);
    }
    *is_opened = status == PEL_OK && is_whole(opened);
    for (int32_t f = 0; *is_opened && status == PEL_OK && f < opened->frames->frame_count; f++) {
        pel_mesh *mesh;
        status = pel_frames_read(opened->frames, f, &mesh, error);
        if (status == PEL_OK)
            *is_opened = fits(opened, mesh);
        pel_mesh_destroy(mesh);
    }
    return status;
}

pel_status pel_opened_mesh_create(const pel_frames *frames, pel_opened_mesh **opened, pel_error *error)
{
    bool is_opened = false;
    pel_opened_mesh *made = pel_allocate(1, sizeof *made);
    *opened = NULL;
    if (made == NULL)
        return pel_fail_memory(error);
    made->frames = frames;
    pel_status status = survey(made, &is_opened, error);
    if (status == PEL_OK && is_opened)
        *opened = made;
    else
        pel_opened_mesh_destroy(made);
    return status;
}

void pel_opened_mesh_destroy(pel_opened_mesh *opened)
{
    if (opened == NULL)
        return;
    PEL_FREE_ALL(opened->triangles, opened->corners, opened);
}

static pel_status spread(const pel_opened_mesh *opened, const pel_mesh *mesh, pel_mesh **made, pel_error *error)
{
    size_t most = 3;
    for (int32_t f = 0; f < mesh->field_count; f++)
        if ((size_t)mesh->fields[f].component_count > most)
            most = (size_t)mesh->fields[f].component_count;
    double *values = pel_allocate((size_t)opened->vertex_count * most, sizeof *values);
    if (values == NULL)
        return pel_fail_memory(error);
    for (int32_t v = 0; v < opened->vertex_count; v++)
        memcpy(values + 3 * (size_t)v, mesh->positions[corners_of(mesh)[opened->corners[v]]], sizeof *mesh->positions);
    pel_status status =
        pel_mesh_create(values, opened->vertex_count, opened->triangles[0], opened->triangle_count, made, error);
    for (int32_t f = 0; status == PEL_OK && f < mesh->field_count; f++) {
        const pel_field *field = &mesh->fields[f];
        size_t size = (size_t)field->component_count;
        for (int32_t v = 0; v < opened->vertex_count; v++)
            memcpy(values + size * (size_t)v, field->values + size * (size_t)corners_of(mesh)[opened->corners[v]],
                   size * sizeof *values);
        status = pel_mesh_add_field(*made, field->name, field->component_count, values, error);
    }
    pel_free(values);
    if (status != PEL_OK) {
        pel_mesh_destroy(*made);
        *made = NULL;
    }
    return status;
}

pel_status pel_opened_mesh_read(const pel_opened_mesh *opened, int32_t frame, pel_mesh **mesh, pel_error *error)
{
    pel_mesh *read;
    *mesh = NULL;
    pel_status status = pel_frames_read(opened->frames, frame, &read, error);
    if (status == PEL_OK && !fits(opened, read)) {
        status = pel_refuse(error, PEL_BAD_FORMAT, "make sure that no other program writes into the folder",
                            "the triangles of this frame are not those of the surface that is cut");
        pel_fail_place(error, opened->frames->paths[frame], 0, 0);
    }
    if (status == PEL_OK)
        status = spread(opened, read, mesh, error);
    pel_mesh_destroy(read);
    return status;
}
