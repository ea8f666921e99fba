#include "pellicle/mesh.h"

#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "math/vec3.h"
#include "mesh/allocate.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static pel_status check_arrays(const double *positions, int32_t vertex_count, const int32_t *triangles,
                               int32_t triangle_count, pel_error *error)
{
    if (vertex_count < 1 || triangle_count < 1)
        return pel_fail(error, PEL_BAD_ARGUMENT,
                        "mesh has %d vertices and %d triangles; at least one of each is needed", (int)vertex_count,
                        (int)triangle_count);
    for (int32_t v = 0; v < vertex_count; v++) {
        const double *p = positions + 3 * (size_t)v;
        if (!isfinite(p[0]) || !isfinite(p[1]) || !isfinite(p[2])) {
            pel_fail(error, PEL_BAD_ARGUMENT, "position (%g, %g, %g) is not finite", p[0], p[1], p[2]);
            pel_fail_element(error, "vertex", v);
            return PEL_BAD_ARGUMENT;
        }
    }
    for (int32_t t = 0; t < triangle_count; t++) {
        for (int i = 0; i < 3; i++) {
            int32_t v = triangles[3 * (size_t)t + (size_t)i];
            if (v < 0 || v >= vertex_count) {
                pel_fail(error, PEL_BAD_ARGUMENT, "vertex index %d is outside 0..%d", (int)v, (int)vertex_count - 1);
                pel_fail_element(error, "triangle", t);
                return PEL_BAD_ARGUMENT;
            }
        }
    }
    return PEL_OK;
}

pel_mesh *pel_mesh_allocate(int32_t vertex_count, int32_t triangle_count)
{
    pel_mesh *mesh = pel_allocate(1, sizeof *mesh);
    if (mesh == NULL)
        return NULL;
    mesh->vertex_count = vertex_count;
    mesh->triangle_count = triangle_count;
    if (!PEL_ALLOCATE_ALL(PEL_ROOM(mesh->positions, vertex_count), PEL_ROOM(mesh->triangles, triangle_count))) {
        pel_mesh_destroy(mesh);
        return NULL;
    }
    return mesh;
}

pel_status pel_mesh_create(const double *positions, int32_t vertex_count, const int32_t *triangles,
                           int32_t triangle_count, pel_mesh **mesh, pel_error *error)
{
    PEL_REFUSE_NULL(positions, error);
    PEL_REFUSE_NULL(triangles, error);
    PEL_REFUSE_NULL(mesh, error);
    *mesh = NULL;
    pel_status status = check_arrays(positions, vertex_count, triangles, triangle_count, error);
    if (status != PEL_OK)
        return status;
    pel_mesh *made = pel_mesh_allocate(vertex_count, triangle_count);
    if (made == NULL)
        return pel_fail_memory(error);
    memcpy(made->positions, positions, (size_t)vertex_count * sizeof *made->positions);
    memcpy(made->triangles, triangles, (size_t)triangle_count * sizeof *made->triangles);
    *mesh = made;
    return PEL_OK;
}

void pel_mesh_destroy(pel_mesh *mesh)
{
    if (mesh == NULL)
        return;
    for (int32_t f = 0; f < mesh->field_count; f++)
        pel_free(mesh->fields[f].values);
    PEL_FREE_ALL(mesh->fields, mesh->triangles, mesh->tetrahedra, mesh->positions, mesh);
}

pel_status pel_mesh_copy_tetrahedra(const pel_mesh *mesh, pel_mesh *copy, pel_error *error)
{
    if (mesh->tetrahedron_count == 0)
        return PEL_OK;
    copy->tetrahedra = pel_allocate((size_t)mesh->tetrahedron_count, sizeof *copy->tetrahedra);
    if (copy->tetrahedra == NULL)
        return pel_fail_memory(error);
    memcpy(copy->tetrahedra, mesh->tetrahedra, (size_t)mesh->tetrahedron_count * sizeof *copy->tetrahedra);
    copy->tetrahedron_count = mesh->tetrahedron_count;
    return PEL_OK;
}

pel_status pel_mesh_add_field(pel_mesh *mesh, const char *name, int32_t component_count, const double *values,
                              pel_error *error)
{
    PEL_REFUSE_NULL(mesh, error);
    PEL_REFUSE_NULL(name, error);
    if (component_count < 1 || name[0] == '\0' || strlen(name) >= PEL_NAME_SIZE)
        return pel_fail(error, PEL_BAD_ARGUMENT,
                        "field name '%s' is empty or longer than %d characters, or it has no components", name,
                        PEL_NAME_SIZE - 1);
    size_t count = (size_t)mesh->vertex_count * (size_t)component_count;
    double *copy = pel_allocate(count, sizeof *copy);
    if (copy == NULL)
        return pel_fail_memory(error);
    if (values != NULL)
        memcpy(copy, values, count * sizeof *copy);
    for (int32_t f = 0; f < mesh->field_count; f++) {
        if (strcmp(mesh->fields[f].name, name) == 0) {
            pel_free(mesh->fields[f].values);
            mesh->fields[f].values = copy;
            mesh->fields[f].component_count = component_count;
            return PEL_OK;
        }
    }
    pel_field *fields = pel_reallocate(mesh->fields, (size_t)mesh->field_count + 1, sizeof *fields);
    if (fields == NULL) {
        pel_free(copy);
        return pel_fail_memory(error);
    }
    mesh->fields = fields;
    pel_field *field = &fields[mesh->field_count++];
    snprintf(field->name, sizeof field->name, "%s", name);
    field->component_count = component_count;
    field->values = copy;
    return PEL_OK;
}

const pel_field *pel_mesh_field(const pel_mesh *mesh, const char *name)
{
    if (mesh == NULL || name == NULL)
        return NULL;
    for (int32_t f = 0; f < mesh->field_count; f++)
        if (strcmp(mesh->fields[f].name, name) == 0)
            return &mesh->fields[f];
    return NULL;
}

pel_transform pel_transform_default(void)
{
    const pel_transform transform = {{1, 1, 1}, {0, 0, 0, 1}, {0, 0, 0}};
    return transform;
}

/* rotation times scale; false when a number is not finite or the scale or rotation is null */
static bool linear_part(const pel_transform *transform, double matrix[3][3])
{
    const double *q = transform->rotation, *scale = transform->scale;
    double squared = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
    if (!(isfinite(squared) && squared > 1e-200))
        return false;
    double s = 2 / squared;
    double x = q[0], y = q[1], z = q[2], w = q[3];
    pel_vec3_set(matrix[0], 1 - s * (y * y + z * z), s * (x * y - w * z), s * (x * z + w * y));
    pel_vec3_set(matrix[1], s * (x * y + w * z), 1 - s * (x * x + z * z), s * (y * z - w * x));
    pel_vec3_set(matrix[2], s * (x * z - w * y), s * (y * z + w * x), 1 - s * (x * x + y * y));
    bool usable = true;
    for (int i = 0; i < 3; i++) {
        usable = usable && isfinite(scale[i]) && scale[i] != 0 && isfinite(transform->translation[i]);
        for (int k = 0; k < 3; k++)
            matrix[i][k] *= scale[k];
    }
    return usable;
}

static void transform_point(double matrix[3][3], const double translation[3], const double point[3], double moved[3])
{
    for (int i = 0; i < 3; i++)
        moved[i] = pel_vec3_dot(matrix[i], point) + translation[i];
}

static void turn_around(pel_mesh *mesh)
{
    for (int32_t t = 0; t < mesh->triangle_count; t++) {
        int32_t second = mesh->triangles[t][1];
        mesh->triangles[t][1] = mesh->triangles[t][2];
        mesh->triangles[t][2] = second;
    }
    for (int32_t t = 0; t < mesh->tetrahedron_count; t++) {
        int32_t second = mesh->tetrahedra[t][1];
        mesh->tetrahedra[t][1] = mesh->tetrahedra[t][2];
        mesh->tetrahedra[t][2] = second;
    }
}

pel_status pel_mesh_transform(pel_mesh *mesh, const pel_transform *transform, pel_error *error)
{
    PEL_REFUSE_NULL(mesh, error);
    PEL_REFUSE_NULL(transform, error);
    double matrix[3][3], moved[3];
    if (!linear_part(transform, matrix))
        return pel_refuse(error, PEL_BAD_ARGUMENT, "give finite numbers, scales other than 0 and a unit quaternion",
                          "transform has a number that is not finite, or a zero scale or rotation");
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        transform_point(matrix, transform->translation, mesh->positions[v], moved);
        if (!isfinite(moved[0]) || !isfinite(moved[1]) || !isfinite(moved[2])) {
            pel_fail(error, PEL_BAD_ARGUMENT, "the transform moves this vertex to infinity");
            pel_fail_element(error, "vertex", v);
            return PEL_BAD_ARGUMENT;
        }
    }
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        transform_point(matrix, transform->translation, mesh->positions[v], moved);
        pel_vec3_copy(moved, mesh->positions[v]);
    }
    const double *scale = transform->scale;
    if (((scale[0] < 0) + (scale[1] < 0) + (scale[2] < 0)) % 2 == 1)
        turn_around(mesh);
    return PEL_OK;
}
