#define _XOPEN_SOURCE 700 /* realpath */
#include "scene/mesh.h"

#include "base/memory.h"
#include "keys/validate.h"
#include "math/extremes.h"
#include "math/functions.h"
#include "math/vec3.h"
#include "mesh/seam.h"
#include "pellicle/import.h"
#include "pellicle/mesh_io.h"
#include "pellicle/shape.h"

#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_NAMES = 64 };

static const double pi = 3.14159265358979323846;

static pel_status create_shape(pel_scene_reader *reader, const pel_scene_value *value, pel_mesh **mesh)
{
    const pel_scene_value *name = pel_scene_value_entry(value, "shape");
    pel_shape_def def;
    pel_status status = pel_shape_def_of_name(name->text, &def, reader->error);
    const pel_shape_info *info = pel_shape_info_of(def.kind);
    for (int32_t i = 0; status == PEL_OK && i < info->parameter_count; i++) {
        const char *key = info->parameters[i].name;
        status = pel_shape_set_number(&def, key, pel_scene_value_number(value, key), reader->error);
    }
    if (status == PEL_OK)
        status = pel_shape_create(&def, mesh, reader->error);
    return status == PEL_OK ? PEL_OK : pel_scene_fail_at(reader, &name->place);
}

/* makes the path in the tree absolute; the file must exist */
pel_status pel_scene_resolve_path(pel_scene_reader *reader, const char *what, pel_scene_value *file, const char *folder)
{
    char joined[PATH_MAX], absolute[PATH_MAX];
    int length = file->text[0] == '/' ? snprintf(joined, sizeof joined, "%s", file->text)
                                      : snprintf(joined, sizeof joined, "%s/%s", folder, file->text);
    errno = ENAMETOOLONG;
    if (length >= (int)sizeof joined || realpath(joined, absolute) == NULL) {
        const char *why = strerror(errno);
        pel_fail(reader->error, PEL_BAD_FILE, "cannot open the %s '%.150s': %s", what, file->text, why);
        pel_fail_remedy(reader->error, "check the path; relative paths start at the folder of the scene, %.150s",
                        folder);
        return pel_scene_fail_at(reader, &file->place);
    }
    file->text = pel_arena_text(reader->arena, absolute, strlen(absolute));
    return file->text != NULL ? PEL_OK : pel_fail_memory(reader->error);
}

/* Sews what the file gives twice. The scene names vertices by their numbers in the file, so that these are kept: in the
   reader, and as the field file_vertex, the first of each place. */
static pel_status weld(pel_scene_reader *reader, pel_mesh *mesh)
{
    const int32_t before = mesh->vertex_count;
    int32_t *index_of;
    pel_status status = pel_seams_weld(mesh, &index_of, reader->log, reader->error);
    if (index_of == NULL)
        return status;
    int32_t *kept = pel_arena_take(reader->arena, (size_t)before, sizeof *kept);
    pel_scene_welding *welding = pel_arena_take(reader->arena, 1, sizeof *welding);
    double *first = pel_allocate((size_t)mesh->vertex_count, sizeof *first);
    if (kept != NULL && welding != NULL && first != NULL) {
        memcpy(kept, index_of, (size_t)before * sizeof *kept);
        *welding = (pel_scene_welding){mesh, kept, before, reader->weldings};
        reader->weldings = welding;
        for (int32_t v = before - 1; v >= 0; v--)
            first[index_of[v]] = v;
        status = pel_mesh_add_field(mesh, "file_vertex", 1, first, reader->error);
    } else {
        status = pel_fail_memory(reader->error);
    }
    pel_free(index_of);
    pel_free(first);
    return status;
}

pel_status pel_scene_keep_welding(pel_scene_reader *reader, const pel_mesh *mesh, pel_mesh *fine)
{
    const pel_scene_welding *old = reader->weldings;
    while (old != NULL && old->mesh != mesh)
        old = old->next;
    if (old == NULL)
        return PEL_OK;
    pel_scene_welding *welding = pel_arena_take(reader->arena, 1, sizeof *welding);
    if (welding == NULL)
        return pel_fail_memory(reader->error);
    *welding = (pel_scene_welding){fine, old->index_of, old->file_count, reader->weldings};
    reader->weldings = welding;
    /* new vertices are none of the file */
    const pel_field *field = pel_mesh_field(fine, "file_vertex");
    for (int32_t v = mesh->vertex_count; field != NULL && v < fine->vertex_count; v++)
        field->values[v] = -1;
    return PEL_OK;
}

static pel_status read_file(pel_scene_reader *reader, pel_scene_value *value, const char *folder, pel_mesh **mesh)
{
    /* in the order of the words in the table */
    static const pel_mesh_format formats[] = {PEL_FORMAT_AUTO, PEL_FORMAT_OBJ, PEL_FORMAT_PLY,
                                              PEL_FORMAT_STL,  PEL_FORMAT_OFF, PEL_FORMAT_VTP};
    pel_scene_value *file = pel_scene_value_entry(value, "file");
    pel_status status = pel_scene_resolve_path(reader, "mesh", file, folder);
    if (status != PEL_OK)
        return status;
    pel_mesh_format format = formats[pel_scene_value_integer(value, "format")];
    status = format == PEL_FORMAT_AUTO ? pel_mesh_import(file->text, reader->log, mesh, reader->error)
                                       : pel_mesh_read(file->text, format, reader->log, mesh, reader->error);
    if (status == PEL_OK && pel_scene_value_number(value, "weld") > 0)
        status = weld(reader, *mesh);
    /* errors inside the file have their own place */
    return status == PEL_BAD_FILE ? pel_scene_fail_at(reader, &file->place) : status;
}

/* the unit axis of a rotation { axis, angle } */
static pel_status read_axis(pel_scene_reader *reader, const pel_scene_value *value, double axis[3])
{
    const pel_scene_value *axis_value = pel_scene_value_entry(value, "axis");
    double largest = 0;
    pel_scene_value_numbers(axis_value, axis);
    for (int i = 0; i < 3; i++)
        largest = pel_max(largest, fabs(axis[i]));
    if (!(largest > 0)) {
        pel_scene_fail(reader, &axis_value->place, "the axis of rotation has no length");
        pel_fail_remedy(reader->error, "give a direction such as [0, 0, 1]");
        return PEL_BAD_SCENE;
    }
    for (int i = 0; i < 3; i++)
        axis[i] /= largest;
    pel_vec3_normalize(axis);
    return PEL_OK;
}

pel_status pel_scene_rotation(pel_scene_reader *reader, const pel_scene_value *value, double rotation[4])
{
    double axis[3] = {0}, half_angle = 0;
    if (value != NULL) {
        pel_status status = read_axis(reader, value, axis);
        if (status != PEL_OK)
            return status;
        half_angle = fmod(pel_scene_value_number(value, "angle"), 720) * pi / 360;
    }
    pel_vec3_scale(axis, pel_sin(half_angle), rotation);
    rotation[3] = pel_cos(half_angle);
    return PEL_OK;
}

pel_status pel_scene_rotation_vector(pel_scene_reader *reader, const pel_scene_value *value, double vector[3])
{
    double axis[3] = {0};
    pel_status status = value != NULL ? read_axis(reader, value, axis) : PEL_OK;
    pel_vec3_scale(axis, value != NULL ? pel_scene_value_number(value, "angle") * pi / 180 : 0, vector);
    return status;
}

pel_status pel_scene_transform(pel_scene_reader *reader, const pel_scene_value *value, pel_transform *transform)
{
    const pel_scene_value *scale = pel_scene_value_entry(value, "scale");
    *transform = pel_transform_default();
    pel_status status = pel_scene_rotation(reader, pel_scene_value_entry(value, "rotate"), transform->rotation);
    if (status != PEL_OK)
        return status;
    pel_scene_value_numbers(pel_scene_value_entry(value, "translate"), transform->translation);
    if (scale->form == PEL_FORM_VECTOR)
        pel_scene_value_numbers(scale, transform->scale);
    else
        pel_vec3_set(transform->scale, scale->number, scale->number, scale->number);
    return PEL_OK;
}

/* the size that is asked for becomes a factor of the scale */
static pel_status resolve_size(pel_scene_reader *reader, pel_scene_value *value, const pel_mesh *mesh)
{
    pel_scene_value *size = pel_scene_value_entry(value, "size"), *scale = pel_scene_value_entry(value, "scale");
    double low[3], high[3], factor[3] = {scale->number, scale->number, scale->number}, longest = 0;
    if (size == NULL)
        return PEL_OK;
    if (scale->form == PEL_FORM_VECTOR)
        pel_scene_value_numbers(scale, factor);
    pel_mesh_box(mesh, low, high);
    for (int i = 0; i < 3; i++)
        longest = pel_max(longest, (high[i] - low[i]) * factor[i]);
    if (!(longest > 0) || !isfinite(size->number / longest)) {
        pel_scene_fail(reader, &size->place, "the mesh has no extent that could be scaled to %g m", size->number);
        pel_fail_remedy(reader->error, "check the file with `pellicle info`");
        return PEL_BAD_SCENE;
    }
    pel_vec3_scale(factor, size->number / longest, factor);
    pel_scene_value_remove(size);
    return scale->form == PEL_FORM_VECTOR ? pel_scene_value_set_vector(reader, scale, factor)
                                          : pel_scene_value_set_number(reader, scale, factor[0]);
}

static pel_status move_mesh(pel_scene_reader *reader, const pel_scene_value *value, pel_mesh *mesh)
{
    pel_transform transform;
    pel_status status = pel_scene_transform(reader, value, &transform);
    if (status != PEL_OK)
        return status;
    status = pel_mesh_transform(mesh, &transform, reader->error);
    return status != PEL_OK ? pel_scene_fail_at(reader, &value->place) : PEL_OK;
}

pel_status pel_scene_mesh(pel_scene_reader *reader, pel_scene_value *value, const char *folder, pel_mesh **mesh)
{
    if (reader->made != NULL) {
        *mesh = *reader->made++;
        return PEL_OK;
    }
    *mesh = NULL;
    const bool is_shape = pel_scene_value_entry(value, "shape") != NULL;
    pel_status status = is_shape ? create_shape(reader, value, mesh) : read_file(reader, value, folder, mesh);
    if (status == PEL_OK && !is_shape)
        status = resolve_size(reader, value, *mesh);
    if (status == PEL_OK)
        status = move_mesh(reader, value, *mesh);
    if (status == PEL_OK)
        return PEL_OK;
    pel_mesh_destroy(*mesh);
    *mesh = NULL;
    return status;
}

static pel_status fail_field(pel_scene_reader *reader, const pel_scene_value *name, const pel_mesh *mesh)
{
    const char *names[MOST_NAMES];
    size_t count = 0;
    for (int32_t f = 0; f < mesh->field_count && count < MOST_NAMES; f++)
        if (mesh->fields[f].component_count == 1)
            names[count++] = mesh->fields[f].name;
    return pel_scene_fail_name(reader, &name->place, "scalar field of the mesh", name->text, names, count);
}

pel_status pel_scene_fail_filled(pel_scene_reader *reader, const pel_scene_value *name, const char *what)
{
    pel_scene_fail(reader, &name->place, "%s '%s' of a body with `volume`: filling does not carry fields over", what,
                   name->text);
    pel_fail_remedy(reader->error, "select by place: nearest, a sphere, a box or a ray; or give a number");
    return PEL_BAD_SCENE;
}

pel_status pel_scene_field(pel_scene_reader *reader, const pel_scene_value *name, const pel_mesh *mesh,
                           const double **values)
{
    const pel_field *field = pel_mesh_field(mesh, name->text);
    if (field == NULL && mesh->tetrahedron_count > 0)
        return pel_scene_fail_filled(reader, name, "field");
    if (field == NULL || field->component_count != 1)
        return fail_field(reader, name, mesh);
    *values = field->values;
    return PEL_OK;
}
