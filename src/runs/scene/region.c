#include "scene/region.h"

#include "base/memory.h"
#include "keys/validate.h"
#include "math/extremes.h"
#include "pellicle/region.h"
#include "scene/mesh.h"
#include "scene/place.h"

#include <stdio.h>
#include <string.h>

enum { MOST_NAMES = 64 };

/* the listed vertices, by their numbers in the file; each must exist, so that the message can name its place */
static pel_status read_vertices(pel_scene_reader *reader, const pel_scene_value *list, const pel_mesh *mesh,
                                pel_region *region)
{
    int32_t *vertices = pel_arena_take(reader->arena, (size_t)pel_scene_value_count(list), sizeof *vertices);
    if (vertices == NULL)
        return pel_fail_memory(reader->error);
    for (const pel_scene_value *child = list->first; child != NULL; child = child->next) {
        const pel_status status = pel_scene_vertex(reader, child, mesh, &vertices[region->vertex_count++]);
        if (status != PEL_OK)
            return status;
    }
    region->kind = PEL_REGION_VERTICES;
    region->vertices = vertices;
    return PEL_OK;
}

/* the field of a group of an OBJ file */
static pel_status read_group(pel_scene_reader *reader, const pel_scene_value *group, const pel_mesh *mesh,
                             pel_region *region)
{
    static const char word[] = "group:";
    const size_t prefix = strlen(word), size = prefix + strlen(group->text) + 1;
    const char *names[MOST_NAMES];
    size_t count = 0;
    char *field = pel_arena_take(reader->arena, size, 1);
    if (field == NULL)
        return pel_fail_memory(reader->error);
    snprintf(field, size, "%s%s", word, group->text);
    region->kind = PEL_REGION_FIELD;
    region->field = field;
    region->above = 0.5;
    if (pel_mesh_field(mesh, field) != NULL)
        return PEL_OK;
    if (mesh->tetrahedron_count > 0)
        return pel_scene_fail_filled(reader, group, "group");
    for (int32_t f = 0; f < mesh->field_count && count < MOST_NAMES; f++)
        if (strncmp(mesh->fields[f].name, word, prefix) == 0)
            names[count++] = mesh->fields[f].name + prefix;
    return pel_scene_fail_name(reader, &group->place, "group of the mesh", group->text, names, count);
}

/* regions that are given by numbers alone; false for others */
static bool read_shape(const pel_scene_value *value, pel_region *region)
{
    const pel_scene_value *sphere = pel_scene_value_entry(value, "sphere"), *box = pel_scene_value_entry(value, "box"),
                          *plane = pel_scene_value_entry(value, "plane"),
                          *point = pel_scene_value_entry(value, "nearest"),
                          *loop = pel_scene_value_entry(value, "boundary");
    if (sphere != NULL) {
        region->kind = PEL_REGION_SPHERE;
        pel_scene_value_numbers(pel_scene_value_entry(sphere, "center"), region->center);
        region->radius = pel_scene_value_number(sphere, "radius");
    } else if (box != NULL) {
        region->kind = PEL_REGION_BOX;
        pel_scene_value_numbers(pel_scene_value_entry(box, "min"), region->low);
        pel_scene_value_numbers(pel_scene_value_entry(box, "max"), region->high);
    } else if (plane != NULL) {
        region->kind = PEL_REGION_PLANE;
        pel_scene_value_numbers(pel_scene_value_entry(plane, "point"), region->point);
        pel_scene_value_numbers(pel_scene_value_entry(plane, "normal"), region->normal);
    } else if (point != NULL) {
        region->kind = PEL_REGION_NEAREST;
        pel_scene_value_numbers(point, region->point);
    } else if (loop != NULL) {
        region->kind = PEL_REGION_BOUNDARY;
        region->loop = (int32_t)loop->number;
    } else {
        return false;
    }
    return true;
}

static pel_status read_region(pel_scene_reader *reader, const pel_scene_value *value, const pel_mesh *mesh,
                              pel_region *region)
{
    const pel_scene_value *field = pel_scene_value_entry(value, "field"), *ray = pel_scene_value_entry(value, "ray"),
                          *group = pel_scene_value_entry(value, "group"),
                          *vertices = pel_scene_value_entry(value, "vertices"),
                          *falloff = pel_scene_value_entry(value, "falloff");
    const double *unused;
    region->falloff = falloff != NULL ? falloff->number : 0;
    if (value->kind != PEL_SCENE_MAP || read_shape(value, region))
        return PEL_OK;
    if (ray != NULL) {
        region->kind = PEL_REGION_NEAREST;
        return pel_scene_cast(reader, ray, &mesh, 1, region->point, NULL);
    }
    if (field != NULL) {
        region->kind = PEL_REGION_FIELD;
        region->field = field->text;
        region->above = pel_scene_value_number(value, "above");
        return pel_scene_field(reader, field, mesh, &unused);
    }
    if (group != NULL)
        return read_group(reader, group, mesh, region);
    return vertices != NULL ? read_vertices(reader, vertices, mesh, region) : PEL_OK;
}

/* ---- weights ---- */

static pel_status weigh(pel_scene_reader *reader, const pel_scene_value *value, const pel_mesh *mesh, double *weights);

/* one region: the words `all` and `boundary`, or a map */
static pel_status weigh_one(pel_scene_reader *reader, const pel_scene_value *value, const pel_mesh *mesh,
                            double *weights)
{
    pel_region def = pel_region_default();
    pel_selection *selection;
    const bool is_boundary = value->kind != PEL_SCENE_MAP && strcmp(value->text, "boundary") == 0;
    def.kind = is_boundary ? PEL_REGION_BOUNDARY : PEL_REGION_ALL;
    pel_status status = read_region(reader, value, mesh, &def);
    if (status != PEL_OK)
        return status;
    status = pel_mesh_select(mesh, &def, &selection, reader->error);
    if (status != PEL_OK)
        return pel_scene_fail_at(reader, &value->place);
    for (int32_t i = 0; i < selection->count; i++)
        weights[selection->vertices[i]] = pel_max(weights[selection->vertices[i]], selection->weights[i]);
    pel_selection_destroy(selection);
    return PEL_OK;
}

/* Raises the weights of vertices (mesh->vertex_count) to those of a region. */
static pel_status weigh(pel_scene_reader *reader, const pel_scene_value *value, const pel_mesh *mesh, double *weights)
{
    const pel_scene_value *parts = pel_scene_value_entry(value, "union"),
                          *outside = pel_scene_value_entry(value, "not");
    pel_status status = PEL_OK;
    if (parts != NULL) {
        for (const pel_scene_value *part = parts->first; status == PEL_OK && part != NULL; part = part->next)
            status = weigh(reader, part, mesh, weights);
        return status;
    }
    if (outside == NULL)
        return weigh_one(reader, value, mesh, weights);
    double *inside = pel_allocate((size_t)mesh->vertex_count, sizeof *inside);
    if (inside == NULL)
        return pel_fail_memory(reader->error);
    status = weigh(reader, outside, mesh, inside);
    for (int32_t v = 0; status == PEL_OK && v < mesh->vertex_count; v++)
        weights[v] = pel_max(weights[v], 1 - inside[v]);
    pel_free(inside);
    return status;
}

/* copies the vertices with a weight into the arena, without weights if all are 1 */
static pel_status keep(pel_scene_reader *reader, const pel_scene_value *value, const pel_mesh *mesh,
                       const double *weights, pel_scene_region *region)
{
    int32_t count = 0, whole = 0;
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        count += weights[v] > 0;
        whole += weights[v] >= 1;
    }
    if (count == 0) {
        pel_scene_fail(reader, &value->place, "the region is empty: `not` leaves no vertex");
        pel_fail_remedy(reader->error, "make the region that is left out smaller");
        return PEL_BAD_SCENE;
    }
    region->count = 0;
    region->vertices = pel_arena_take(reader->arena, (size_t)count, sizeof *region->vertices);
    region->weights = whole < count ? pel_arena_take(reader->arena, (size_t)count, sizeof *region->weights) : NULL;
    if (region->vertices == NULL || (whole < count && region->weights == NULL))
        return pel_fail_memory(reader->error);
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        if (!(weights[v] > 0))
            continue;
        if (region->weights != NULL)
            region->weights[region->count] = weights[v];
        region->vertices[region->count++] = v;
    }
    return PEL_OK;
}

pel_status pel_scene_region_find(pel_scene_reader *reader, const pel_scene_value *value, const pel_mesh *mesh,
                                 pel_scene_region *region)
{
    *region = (pel_scene_region){.count = mesh->vertex_count};
    if (value->kind != PEL_SCENE_MAP && strcmp(value->text, "all") == 0)
        return PEL_OK;
    double *weights = pel_allocate((size_t)mesh->vertex_count, sizeof *weights);
    if (weights == NULL)
        return pel_fail_memory(reader->error);
    pel_status status = weigh(reader, value, mesh, weights);
    if (status == PEL_OK)
        status = keep(reader, value, mesh, weights, region);
    pel_free(weights);
    return status;
}
