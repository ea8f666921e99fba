#include "pellicle/shape.h"

#include "base/number.h"
#include "base/status.h"
#include "base/text.h"
#include "primitive/shape_build.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { COOKIE = 0x53484150, MOST_PARAMETERS = 8 };

static const char *const diagonal_names[] = {"one-diagonal", "union-jack", "equilateral", NULL};
static const char *const body_names[] = {"head", "animal", "liver", NULL};

#define LARGEST_LENGTH 1e9
#define MEMBER(member) offsetof(pel_shape_def, member)
/* a parameter of a length > 0 [m]; of a length >= 0; of a count */
#define LENGTH(member, value, doc)                                                                                     \
    {                                                                                                                  \
#member, doc, "m", PEL_SHAPE_NUMBER, MEMBER(member), 0, LARGEST_LENGTH, true, value, NULL                      \
    }
#define COUNT(member, least, most, value, doc)                                                                         \
    {                                                                                                                  \
#member, doc, "", PEL_SHAPE_INTEGER, MEMBER(member), least, most, false, value, NULL                           \
    }

static const pel_shape_parameter geodesic_sphere_parameters[] = {
    COUNT(frequency, 1, 5000, 5, "divisions of each edge of the icosahedron: 10 f^2 + 2 vertices"),
    LENGTH(radius, 1, "radius of the sphere"),
};

static const pel_shape_parameter uv_sphere_parameters[] = {
    LENGTH(radius, 1, "radius of the sphere"),
    COUNT(slices, 3, 1000000, 32, "divisions around the z axis"),
    COUNT(rings, 2, 1000000, 16, "divisions from pole to pole"),
};

static const pel_shape_parameter grid_parameters[] = {
    COUNT(nx, 1, 1000000, 10, "cells along x"),
    COUNT(ny, 1, 1000000, 10, "cells along y"),
    LENGTH(size_x, 1, "width along x"),
    LENGTH(size_y, 1, "width along y"),
    {"diagonals", "how the cells are divided into triangles", "", PEL_SHAPE_CHOICE, MEMBER(diagonals), 0, 2, false, 0,
     diagonal_names},
};

static const pel_shape_parameter cylinder_parameters[] = {
    LENGTH(radius, 1, "radius of the cylinder"),
    LENGTH(height, 2, "length along the z axis"),
    COUNT(slices, 3, 1000000, 32, "divisions around the z axis"),
    COUNT(segments, 1, 1000000, 10, "divisions along the z axis"),
    {"capped", "true: flat disks close both ends", "", PEL_SHAPE_BOOLEAN, MEMBER(capped), 0, 1, false, 1, NULL},
};

static const pel_shape_parameter torus_parameters[] = {
    LENGTH(major_radius, 1, "distance from the z axis to the center line of the tube"),
    LENGTH(minor_radius, 0.25, "radius of the tube, less than major_radius"),
    COUNT(slices, 3, 1000000, 48, "divisions around the z axis"),
    COUNT(rings, 3, 1000000, 12, "divisions around the tube"),
};

static const pel_shape_parameter capsule_parameters[] = {
    LENGTH(radius, 0.5, "radius of the cylinder and of its hemispheres"),
    {"height", "length of the cylinder", "m", PEL_SHAPE_NUMBER, MEMBER(height), 0, LARGEST_LENGTH, false, 1, NULL},
    COUNT(slices, 3, 1000000, 32, "divisions around the z axis"),
    COUNT(rings, 1, 1000000, 8, "divisions of each hemisphere from its pole to its rim"),
    COUNT(segments, 1, 1000000, 10, "divisions of the cylinder along its axis"),
};

static const pel_shape_parameter lens_capsule_parameters[] = {
    {"age", "11, 29 or 45: the ages for which an outline is published", "years", PEL_SHAPE_INTEGER, MEMBER(age), 11, 45,
     false, 29, NULL},
    COUNT(frequency, 1, 5000, 16, "fineness, as for a geodesic sphere: 10 f^2 + 2 vertices"),
};

static const pel_shape_parameter disk_parameters[] = {
    LENGTH(radius, 1, "radius of the disk"),
    COUNT(rings, 1, 10000, 10, "rings of triangles around the center: 6 rings^2 triangles"),
};

static const pel_shape_parameter blend_parameters[] = {
    {"body", "the body", "", PEL_SHAPE_CHOICE, MEMBER(body), 0, 2, false, PEL_BLEND_LIVER, body_names},
    LENGTH(size, 0.25, "longest side of the bounding box"),
    LENGTH(edge, 0.006, "approximate length of the edges: 0.0005 to 0.03 times size (liver: 0.06)"),
};

static const pel_shape_parameter box_parameters[] = {
    LENGTH(size_x, 1, "width along x"),        LENGTH(size_y, 1, "width along y"),
    LENGTH(size_z, 1, "height along z"),       COUNT(nx, 1, 1000000, 6, "cells along x"),
    COUNT(ny, 1, 1000000, 6, "cells along y"), COUNT(nz, 1, 1000000, 6, "cells along z"),
};

#define INFO(kind, name, doc, parameters)                                                                              \
    {                                                                                                                  \
        kind, name, doc, parameters, sizeof(parameters) / sizeof *(parameters)                                         \
    }

static const pel_shape_info infos[PEL_SHAPE_COUNT] = {
    INFO(PEL_SHAPE_GEODESIC_SPHERE, "geodesic-sphere", "icosahedron with subdivided faces, projected to a sphere",
         geodesic_sphere_parameters),
    INFO(PEL_SHAPE_UV_SPHERE, "uv-sphere", "sphere with meridians and parallels about the z axis",
         uv_sphere_parameters),
    INFO(PEL_SHAPE_GRID, "grid", "rectangle in the plane z = 0 with normal +z", grid_parameters),
    INFO(PEL_SHAPE_CYLINDER, "cylinder", "cylinder about the z axis, open or closed by disks", cylinder_parameters),
    INFO(PEL_SHAPE_TORUS, "torus", "ring about the z axis", torus_parameters),
    INFO(PEL_SHAPE_CAPSULE, "capsule", "cylinder about the z axis with hemispheres at its ends", capsule_parameters),
    INFO(PEL_SHAPE_LENS_CAPSULE, "lens-capsule",
         "capsule of the human eye lens with its thickness as a field (Burd et al. 2002)", lens_capsule_parameters),
    INFO(PEL_SHAPE_DISK, "disk", "disk in the plane z = 0 with normal +z", disk_parameters),
    INFO(PEL_SHAPE_BLEND, "blend", "head, animal or liver: a smooth blend of rounded parts", blend_parameters),
    INFO(PEL_SHAPE_BOX, "box", "closed box about the origin", box_parameters),
};

const pel_shape_info *pel_shape_info_of(pel_shape_kind kind)
{
    return (unsigned)kind < PEL_SHAPE_COUNT ? &infos[kind] : NULL;
}

static void store(pel_shape_def *def, const pel_shape_parameter *parameter, double value)
{
    void *member = (char *)def + parameter->offset;
    switch (parameter->type) {
    case PEL_SHAPE_NUMBER:
        *(double *)member = value;
        break;
    case PEL_SHAPE_INTEGER:
        *(int32_t *)member = (int32_t)value;
        break;
    case PEL_SHAPE_BOOLEAN:
        *(bool *)member = value != 0;
        break;
    case PEL_SHAPE_CHOICE: {
        /* of whichever enum: all are as wide */
        unsigned index = (unsigned)value;
        memcpy(member, &index, sizeof index);
        break;
    }
    }
}

static double value_of(const pel_shape_def *def, const pel_shape_parameter *parameter)
{
    const void *member = (const char *)def + parameter->offset;
    switch (parameter->type) {
    case PEL_SHAPE_NUMBER:
        return *(const double *)member;
    case PEL_SHAPE_INTEGER:
        return *(const int32_t *)member;
    case PEL_SHAPE_BOOLEAN:
        return *(const bool *)member ? 1 : 0;
    default: {
        unsigned index;
        memcpy(&index, member, sizeof index);
        return index;
    }
    }
}

pel_shape_def pel_shape_def_default(pel_shape_kind kind)
{
    pel_shape_def def;
    memset(&def, 0, sizeof def);
    def.kind = kind;
    def.cookie = COOKIE;
    const pel_shape_info *info = pel_shape_info_of(kind);
    for (int32_t i = 0; info != NULL && i < info->parameter_count; i++)
        store(&def, &info->parameters[i], info->parameters[i].default_value);
    return def;
}

/* "; did you mean 'x'?" or the whole list of names */
static void suggest(const char *name, const char *const *names, size_t count, pel_error *error)
{
    const char *nearest = pel_nearest_name(name, names, count);
    char list[256] = "";
    if (nearest != NULL) {
        pel_fail_remedy(error, "did you mean '%s'?", nearest);
        return;
    }
    for (size_t i = 0, length = 0; i < count && length < sizeof list; i++)
        length += (size_t)snprintf(list + length, sizeof list - length, "%s%s", i > 0 ? ", " : "", names[i]);
    pel_fail_remedy(error, "use one of: %s", list);
}

pel_status pel_shape_def_of_name(const char *name, pel_shape_def *def, pel_error *error)
{
    PEL_REFUSE_NULL(name, error);
    PEL_REFUSE_NULL(def, error);
    const char *names[PEL_SHAPE_COUNT];
    for (int32_t i = 0; i < PEL_SHAPE_COUNT; i++) {
        names[i] = infos[i].name;
        if (strcmp(name, infos[i].name) == 0) {
            *def = pel_shape_def_default(infos[i].kind);
            return PEL_OK;
        }
    }
    *def = pel_shape_def_default(PEL_SHAPE_GEODESIC_SPHERE);
    pel_fail(error, PEL_BAD_ARGUMENT, "there is no shape '%s'", name);
    suggest(name, names, PEL_SHAPE_COUNT, error);
    return PEL_BAD_ARGUMENT;
}

static pel_status find_parameter(const pel_shape_def *def, const char *key, const pel_shape_parameter **found,
                                 pel_error *error)
{
    const pel_shape_info *info = pel_shape_info_of(def->kind);
    const char *names[MOST_PARAMETERS];
    if (info == NULL)
        return pel_fail(error, PEL_BAD_ARGUMENT, "there is no shape of kind %d", (int)def->kind);
    for (int32_t i = 0; i < info->parameter_count; i++) {
        names[i] = info->parameters[i].name;
        if (strcmp(key, names[i]) == 0) {
            *found = &info->parameters[i];
            return PEL_OK;
        }
    }
    pel_fail(error, PEL_BAD_ARGUMENT, "%s has no parameter '%s'", info->name, key);
    suggest(key, names, (size_t)info->parameter_count, error);
    return PEL_BAD_ARGUMENT;
}

static pel_status check_value(const pel_shape_info *info, const pel_shape_parameter *parameter, double value,
                              pel_error *error)
{
    bool above = parameter->exclusive_minimum ? value > parameter->minimum : value >= parameter->minimum;
    bool whole = parameter->type == PEL_SHAPE_NUMBER || value == floor(value);
    if (above && value <= parameter->maximum && whole)
        return PEL_OK;
    pel_fail(error, PEL_BAD_ARGUMENT, "%s: %s is %g", info->name, parameter->name, value);
    const char *kind = parameter->type == PEL_SHAPE_NUMBER ? "number" : "whole number";
    if (parameter->exclusive_minimum)
        pel_fail_remedy(error, "give a %s greater than %g, at most %g", kind, parameter->minimum, parameter->maximum);
    else
        pel_fail_remedy(error, "give a %s from %g to %g", kind, parameter->minimum, parameter->maximum);
    return PEL_BAD_ARGUMENT;
}

pel_status pel_shape_set_number(pel_shape_def *def, const char *key, double value, pel_error *error)
{
    PEL_REFUSE_NULL(def, error);
    PEL_REFUSE_NULL(key, error);
    const pel_shape_parameter *parameter;
    pel_status status = find_parameter(def, key, &parameter, error);
    if (status == PEL_OK)
        status = check_value(pel_shape_info_of(def->kind), parameter, value, error);
    if (status == PEL_OK)
        store(def, parameter, value);
    return status;
}

/* the value that a text means for a parameter; NaN = not understood */
static double parse_value(const pel_shape_parameter *parameter, const char *text)
{
    if (parameter->type == PEL_SHAPE_BOOLEAN && strcmp(text, "true") == 0)
        return 1;
    if (parameter->type == PEL_SHAPE_BOOLEAN && strcmp(text, "false") == 0)
        return 0;
    if (parameter->type == PEL_SHAPE_BOOLEAN)
        return (double)NAN;
    if (parameter->type == PEL_SHAPE_CHOICE) {
        for (int32_t i = 0; parameter->choices[i] != NULL; i++)
            if (strcmp(text, parameter->choices[i]) == 0)
                return i;
        return (double)NAN;
    }
    double value;
    const char *end = pel_number_parse(text, text + strlen(text), &value);
    return end == NULL || *end != '\0' ? (double)NAN : value;
}

pel_status pel_shape_set(pel_shape_def *def, const char *key, const char *text, pel_error *error)
{
    PEL_REFUSE_NULL(def, error);
    PEL_REFUSE_NULL(key, error);
    PEL_REFUSE_NULL(text, error);
    const pel_shape_parameter *parameter;
    pel_status status = find_parameter(def, key, &parameter, error);
    if (status != PEL_OK)
        return status;
    double value = parse_value(parameter, text);
    if (!isnan(value))
        return pel_shape_set_number(def, key, value, error);
    pel_fail(error, PEL_BAD_ARGUMENT, "%s: %s cannot be '%s'", pel_shape_info_of(def->kind)->name, key, text);
    if (parameter->type == PEL_SHAPE_BOOLEAN)
        pel_fail_remedy(error, "give true or false");
    else if (parameter->type == PEL_SHAPE_CHOICE)
        suggest(text, parameter->choices, (size_t)parameter->maximum + 1, error);
    else
        pel_fail_remedy(error, "give a number%s%s", parameter->unit[0] != '\0' ? " in " : "", parameter->unit);
    return PEL_BAD_ARGUMENT;
}

const char *pel_shape_get(const pel_shape_def *def, const pel_shape_parameter *parameter, char *text, size_t size)
{
    if (def == NULL || parameter == NULL || text == NULL || size == 0)
        return "";
    double value = value_of(def, parameter);
    char number[PEL_NUMBER_SIZE];
    pel_number_print(number, value);
    if (parameter->type == PEL_SHAPE_BOOLEAN)
        snprintf(text, size, "%s", value != 0 ? "true" : "false");
    else if (parameter->type == PEL_SHAPE_CHOICE)
        snprintf(text, size, "%s", parameter->choices[(int32_t)value]);
    else
        snprintf(text, size, "%s", number);
    return text;
}

pel_status pel_shape_check_size(int64_t vertex_count, int64_t triangle_count, pel_error *error)
{
    if (vertex_count <= INT32_MAX && triangle_count <= INT32_MAX / 3)
        return PEL_OK;
    pel_fail(error, PEL_BAD_ARGUMENT, "the shape would have %lld triangles", (long long)triangle_count);
    pel_fail_remedy(error, "ask for at most %d triangles", (int)(INT32_MAX / 3));
    return PEL_BAD_ARGUMENT;
}

pel_status pel_shape_create(const pel_shape_def *def, pel_mesh **mesh, pel_error *error)
{
    PEL_REFUSE_NULL(def, error);
    PEL_REFUSE_NULL(mesh, error);
    *mesh = NULL;
    const pel_shape_info *info = pel_shape_info_of(def->kind);
    if (def->cookie != COOKIE || info == NULL)
        return pel_refuse(error, PEL_BAD_ARGUMENT, "begin with pel_shape_def_default(kind) and change its members",
                          "the shape's def was not filled by pel_shape_def_default");
    for (int32_t i = 0; i < info->parameter_count; i++) {
        pel_status status = check_value(info, &info->parameters[i], value_of(def, &info->parameters[i]), error);
        if (status != PEL_OK)
            return status;
    }
    switch (def->kind) {
    case PEL_SHAPE_GEODESIC_SPHERE:
        return pel_shape_geodesic_sphere(def->frequency, def->radius, false, mesh, error);
    case PEL_SHAPE_UV_SPHERE:
        return pel_shape_uv_sphere(def, mesh, error);
    case PEL_SHAPE_GRID:
        return pel_shape_grid(def, mesh, error);
    case PEL_SHAPE_DISK:
        return pel_shape_disk(def, mesh, error);
    case PEL_SHAPE_BOX:
        return pel_shape_box(def, mesh, error);
    case PEL_SHAPE_CYLINDER:
        return pel_shape_cylinder(def, mesh, error);
    case PEL_SHAPE_TORUS:
        return pel_shape_torus(def, mesh, error);
    case PEL_SHAPE_CAPSULE:
        return pel_shape_capsule(def, mesh, error);
    case PEL_SHAPE_LENS_CAPSULE:
        return pel_shape_lens_capsule(def, mesh, error);
    default:
        return pel_shape_blend(def, mesh, error);
    }
}
