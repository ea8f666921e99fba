#include "export/parts.h"

#include "base/room.h"
#include "base/status.h"
#include "export/export.h"
#include "math/vec3.h"

#include <string.h>

static void number_vertices(const pel_mesh *mesh, pel_export_parts *by)
{
    const pel_field *body = pel_mesh_field(mesh, "body");
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        double number = body != NULL && body->component_count == 1 ? body->values[v] : 0;
        by->part_of[v] = number > 0 && number < by->count ? (int32_t)number : 0;
    }
}

static void count_parts(const pel_mesh *mesh, pel_export_parts *by)
{
    memset(by->parts, 0, (size_t)by->count * sizeof *by->parts);
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        by->parts[by->part_of[v]].vertex_count++;
    for (int32_t t = 0; t < mesh->triangle_count; t++)
        by->parts[by->part_of[mesh->triangles[t][0]]].index_count += 3;
}

static bool is_apart(const pel_mesh *mesh, const pel_export_parts *by)
{
    for (int32_t t = 0; t < mesh->triangle_count; t++) {
        const int32_t *v = mesh->triangles[t];
        if (by->part_of[v[1]] != by->part_of[v[0]] || by->part_of[v[2]] != by->part_of[v[0]])
            return false;
    }
    for (int32_t p = 0; p < by->count; p++)
        if (by->parts[p].vertex_count == 0 || by->parts[p].index_count == 0)
            return false;
    return true;
}

static void sort_parts(const pel_mesh *mesh, pel_export_parts *by)
{
    for (int32_t p = 1; p < by->count; p++) {
        by->parts[p].vertex_begin = by->parts[p - 1].vertex_begin + by->parts[p - 1].vertex_count;
        by->parts[p].index_begin = by->parts[p - 1].index_begin + by->parts[p - 1].index_count;
    }
    for (int32_t p = 0; p < by->count; p++)
        by->parts[p].vertex_count = by->parts[p].index_count = 0;
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        pel_export_part *of = &by->parts[by->part_of[v]];
        by->place[v] = (int32_t)(of->vertex_begin + of->vertex_count++);
    }
    for (int32_t t = 0; t < mesh->triangle_count; t++) {
        pel_export_part *of = &by->parts[by->part_of[mesh->triangles[t][0]]];
        for (int c = 0; c < 3; c++)
            by->indices[of->index_begin + of->index_count++] =
                (uint32_t)((size_t)by->place[mesh->triangles[t][c]] - of->vertex_begin);
    }
}

pel_status pel_export_parts_create(const pel_mesh *mesh, pel_export_parts *by, pel_error *error)
{
    *by = (pel_export_parts){.count = pel_export_part_count(mesh)};
    if (!PEL_ALLOCATE_ALL(PEL_ROOM(by->parts, by->count), PEL_ROOM(by->part_of, mesh->vertex_count),
                          PEL_ROOM(by->place, mesh->vertex_count), PEL_ROOM(by->indices, 3 * mesh->triangle_count)))
        return pel_fail_memory(error);
    number_vertices(mesh, by);
    count_parts(mesh, by);
    if (!is_apart(mesh, by)) {
        by->count = 1;
        number_vertices(mesh, by);
        count_parts(mesh, by);
    }
    sort_parts(mesh, by);
    return PEL_OK;
}

void pel_export_parts_free(pel_export_parts *by)
{
    PEL_FREE_ALL(by->indices, by->place, by->part_of, by->parts);
}

void pel_export_normals(const pel_mesh *mesh, double (*normals)[3])
{
    memset(normals, 0, (size_t)mesh->vertex_count * sizeof *normals);
    for (int32_t t = 0; t < mesh->triangle_count; t++) {
        const int32_t *v = mesh->triangles[t];
        double a[3], b[3], normal[3];
        pel_vec3_subtract(mesh->positions[v[1]], mesh->positions[v[0]], a);
        pel_vec3_subtract(mesh->positions[v[2]], mesh->positions[v[0]], b);
        pel_vec3_cross(a, b, normal);
        for (int i = 0; i < 3; i++)
            pel_vec3_add(normals[v[i]], normal, normals[v[i]]);
    }
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        double length = pel_vec3_length(normals[v]);
        if (length > 0 && isfinite(length))
            pel_vec3_scale(normals[v], 1 / length, normals[v]);
        else
            pel_vec3_set(normals[v], 0, 0, 1);
    }
}
