#include "scene/region.h"

#include "pellicle/region.h"
#include "scene/mesh.h"

#include <string.h>

/* the listed vertices, by their numbers in the file; each must exist, so that the message can name its place */
static pel_status read_vertices(pel_scene_reader *reader, const pel_scene_value *list, const pel_mesh *mesh,
                                pel_region *region)
{
    int32_t *vertices = pel_arena_take(reader->arena, (size_t)pel_scene_value_count(list), sizeof *vertices);
    if (vertices == NULL)
        return pel_fail_memory(reader->error);
    const pel_scene_welding *welding = reader->weldings;
    while (welding != NULL && welding->mesh != mesh)
        welding = welding->next;
    const int32_t count = welding != NULL ? welding->file_count : mesh->vertex_count;
    for (const pel_scene_value *child = list->first; child != NULL; child = child->next) {
        if (child->number >= count) {
            pel_scene_fail(reader, &child->place, "the mesh has no vertex %.0f", child->number);
            pel_fail_remedy(reader->error, "give numbers from 0 to %d", (int)count - 1);
            return PEL_BAD_SCENE;
        }
        const int32_t vertex = (int32_t)child->number;
        vertices[region->vertex_count++] = welding != NULL ? welding->index_of[vertex] : vertex;
    }
    region->kind = PEL_REGION_VERTICES;
    region->vertices = vertices;
    return PEL_OK;
}

static pel_status read_region(pel_scene_reader *reader, const pel_scene_value *value, const pel_mesh *mesh,
                              pel_region *region)
{
    const pel_scene_value *sphere = pel_scene_value_entry(value, "sphere"), *box = pel_scene_value_entry(value, "box"),
                          *field = pel_scene_value_entry(value, "field"),
                          *vertices = pel_scene_value_entry(value, "vertices"),
                          *point = pel_scene_value_entry(value, "nearest"),
                          *falloff = pel_scene_value_entry(value, "falloff");
    const double *unused;
    region->falloff = falloff != NULL ? falloff->number : 0;
    if (sphere != NULL) {
        region->kind = PEL_REGION_SPHERE;
        pel_scene_value_numbers(pel_scene_value_entry(sphere, "center"), region->center);
        region->radius = pel_scene_value_number(sphere, "radius");
    } else if (box != NULL) {
        region->kind = PEL_REGION_BOX;
        pel_scene_value_numbers(pel_scene_value_entry(box, "min"), region->low);
        pel_scene_value_numbers(pel_scene_value_entry(box, "max"), region->high);
    } else if (point != NULL) {
        region->kind = PEL_REGION_NEAREST;
        pel_scene_value_numbers(point, region->point);
    } else if (field != NULL) {
        region->kind = PEL_REGION_FIELD;
        region->field = field->text;
        region->above = pel_scene_value_number(value, "above");
        return pel_scene_field(reader, field, mesh, &unused);
    }
    return vertices != NULL ? read_vertices(reader, vertices, mesh, region) : PEL_OK;
}

/* copies a selection into the arena, without weights if all are 1 */
static pel_status keep(pel_scene_reader *reader, const pel_selection *selection, bool weighted,
                       pel_scene_region *region)
{
    size_t count = (size_t)selection->count;
    region->count = selection->count;
    region->vertices = pel_arena_take(reader->arena, count, sizeof *region->vertices);
    if (region->vertices == NULL)
        return pel_fail_memory(reader->error);
    memcpy(region->vertices, selection->vertices, count * sizeof *region->vertices);
    if (!weighted)
        return PEL_OK;
    region->weights = pel_arena_take(reader->arena, count, sizeof *region->weights);
    if (region->weights == NULL)
        return pel_fail_memory(reader->error);
    memcpy(region->weights, selection->weights, count * sizeof *region->weights);
    return PEL_OK;
}

pel_status pel_scene_region_find(pel_scene_reader *reader, const pel_scene_value *value, const pel_mesh *mesh,
                                 pel_scene_region *region)
{
    *region = (pel_scene_region){.count = mesh->vertex_count};
    pel_region def = pel_region_default();
    bool is_word = value->kind != PEL_SCENE_MAP;
    if (is_word && strcmp(value->text, "boundary") != 0)
        return PEL_OK;
    def.kind = PEL_REGION_BOUNDARY;
    pel_status status = is_word ? PEL_OK : read_region(reader, value, mesh, &def);
    if (status != PEL_OK)
        return status;
    pel_selection *selection;
    status = pel_mesh_select(mesh, &def, &selection, reader->error);
    if (status != PEL_OK)
        return pel_scene_fail_at(reader, &value->place);
    status = keep(reader, selection, def.falloff > 0, region);
    pel_selection_destroy(selection);
    return status;
}
