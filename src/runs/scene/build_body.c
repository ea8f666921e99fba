#include "scene/build.h"

#include "scene/mesh.h"
#include "scene/region.h"
#include "scene/table.h"

#include <string.h>

pel_status pel_scene_build_keys(pel_scene_reader *reader, const pel_scene_value *list, const pel_key **keys,
                                int32_t *key_count)
{
    if (list == NULL)
        return PEL_OK;
    int32_t count = pel_scene_value_count(list), k = 0;
    pel_key *taken = pel_arena_take(reader->arena, (size_t)count, sizeof *taken);
    if (taken == NULL)
        return pel_fail_memory(reader->error);
    for (const pel_scene_value *pair = list->first; pair != NULL; pair = pair->next, k++) {
        taken[k] = (pel_key){pair->first->number, pair->last->number};
        if (k > 0 && !(taken[k].time > taken[k - 1].time)) {
            pel_scene_fail(reader, &pair->place, "the times of the keys do not increase: %g after %g", taken[k].time,
                           taken[k - 1].time);
            pel_fail_remedy(reader->error,
                            "order the keys by time; for a jump use two keys with slightly different times");
            return PEL_BAD_SCENE;
        }
    }
    *keys = taken;
    *key_count = count;
    return PEL_OK;
}

pel_status pel_scene_check_names(pel_scene_reader *reader, const pel_scene_value *list)
{
    for (const pel_scene_value *element = list->first; element != NULL; element = element->next) {
        const pel_scene_value *name = pel_scene_value_entry(element, "name");
        for (const pel_scene_value *other = list->first; other != element; other = other->next) {
            if (strcmp(pel_scene_value_entry(other, "name")->text, name->text) != 0)
                continue;
            pel_scene_fail(reader, &name->place, "the name '%s' is in use", name->text);
            pel_fail_remedy(reader->error, "give each of the %s a name of its own", list->key);
            return PEL_BAD_SCENE;
        }
    }
    return PEL_OK;
}

/* the field's value, mapped by the line through map[0] at 0 and map[1] at 1 if there is a map */
static double mapped(const double map[2], double value)
{
    return map[0] + value * (map[1] - map[0]);
}

/* numbers on the vertices from a field and its map */
static pel_status read_field(const pel_scene_body_source *source, const pel_scene_value *value, const pel_def_row *row,
                             pel_quantity *quantity)
{
    pel_scene_reader *reader = source->reader;
    const pel_scene_value *name = pel_scene_value_entry(value, "field"), *map = pel_scene_value_entry(value, "map");
    const double *values;
    pel_status status = pel_scene_field(reader, name, source->mesh, &values);
    if (status != PEL_OK)
        return status;
    double ends[2] = {0, 1};
    if (map != NULL)
        pel_scene_value_numbers(map, ends);
    double *numbers = pel_arena_take(reader->arena, (size_t)source->mesh->vertex_count, sizeof *numbers);
    if (numbers == NULL)
        return pel_fail_memory(reader->error);
    for (int32_t v = 0; v < source->mesh->vertex_count; v++) {
        numbers[v] = map != NULL ? mapped(ends, values[v]) : values[v];
        if (pel_range_has(row->range, numbers[v]))
            continue;
        char path[160], range[80];
        pel_scene_fail(reader, &name->place, "%s is %g at vertex %d, out of range",
                       pel_scene_value_path(value, path, sizeof path), numbers[v], (int)v);
        pel_fail_remedy(reader->error, "it must be %s %s; `map: [a, b]` maps the field values 0 and 1 to a and b",
                        pel_range_text(row->range, range, sizeof range), row->unit);
        return PEL_BAD_SCENE;
    }
    quantity->field = numbers;
    return PEL_OK;
}

pel_status pel_scene_build_quantity(const pel_scene_body_source *source, const pel_scene_value *map, const char *key,
                                    const char *row_path, pel_quantity *quantity)
{
    const pel_scene_value *value = map != NULL ? pel_scene_value_entry(map, key) : NULL;
    *quantity = (pel_quantity){0};
    if (value == NULL)
        return PEL_OK;
    if (value->kind != PEL_SCENE_MAP) {
        quantity->value = value->number;
        return PEL_OK;
    }
    if (pel_scene_value_entry(value, "field") != NULL)
        return read_field(source, value, pel_scene_row_find(source->reader->table, row_path, key), quantity);
    return pel_scene_build_keys(source->reader, pel_scene_value_entry(value, "keys"), &quantity->keys,
                                &quantity->key_count);
}

static void read_surface(const pel_scene_body_source *source, pel_body_def *body)
{
    const pel_scene_value *contact = pel_scene_value_entry(source->value, "contact");
    pel_scene_value_read(contact, "friction", &body->friction);
    pel_scene_value_read(contact, "restitution", &body->restitution);
    pel_scene_value_read(contact, "thickness", &body->contact_thickness);
}

pel_status pel_scene_read_vertices(const pel_scene_body_source *source, const pel_scene_value *value,
                                   const int32_t **vertices, int32_t *count)
{
    if (value == NULL)
        return PEL_OK;
    pel_scene_region region;
    pel_status status = pel_scene_region_find(source->reader, value, source->mesh, &region);
    if (status != PEL_OK)
        return status;
    if (region.vertices == NULL) {
        region.vertices = pel_arena_take(source->reader->arena, (size_t)region.count, sizeof *region.vertices);
        if (region.vertices == NULL)
            return pel_fail_memory(source->reader->error);
        for (int32_t v = 0; v < region.count; v++)
            region.vertices[v] = v;
    }
    *vertices = region.vertices;
    *count = region.count;
    return PEL_OK;
}

/* `above` and `below` of a map; below may be left to half of above, and has to be less */
static pel_status read_thresholds(const pel_scene_body_source *source, const pel_scene_value *map, double *above,
                                  double *below)
{
    const pel_scene_value *high = pel_scene_value_entry(map, "above"), *low = pel_scene_value_entry(map, "below");
    if (high == NULL)
        return PEL_OK;
    *above = high->number;
    *below = low->form == PEL_FORM_WORD ? *above / 2 : low->number;
    if (*below < *above)
        return PEL_OK;
    pel_scene_fail(source->reader, &low->place, "below (%g) is not less than above (%g)", *below, *above);
    pel_fail_remedy(source->reader->error, "use a smaller value, or omit it (default: half of above)");
    return PEL_BAD_SCENE;
}

/* something says where, and not twice */
static pel_status check_refine(const pel_scene_body_source *source, const pel_scene_value *value, bool everywhere)
{
    static const char *const keys[] = {"above", "curvature", "near_tools", "region"};
    const pel_scene_value *found = NULL;
    for (size_t i = 0; found == NULL && i < sizeof keys / sizeof keys[0]; i++)
        found = pel_scene_value_entry(value, keys[i]);
    if ((found != NULL) != everywhere)
        return PEL_OK;
    if (everywhere) {
        pel_scene_fail(source->reader, &found->key_place, "'everywhere' and '%s' exclude each other", found->key);
        pel_fail_remedy(source->reader->error, "remove one of them");
    } else {
        pel_scene_fail(source->reader, &value->place, "refine has no criterion");
        pel_fail_remedy(source->reader->error,
                        "add 'above', 'curvature', 'near_tools' or 'region', or 'everywhere: true'");
    }
    return PEL_BAD_SCENE;
}

static pel_status read_refine(const pel_scene_body_source *source, pel_refine_def *refine)
{
    const pel_scene_value *value = pel_scene_value_entry(source->value, "refine");
    if (value == NULL)
        return PEL_OK;
    const pel_scene_value *curvature = pel_scene_value_entry(value, "curvature"),
                          *near = pel_scene_value_entry(value, "near_tools"),
                          *region = pel_scene_value_entry(value, "region");
    refine->levels = pel_scene_value_integer(value, "levels");
    refine->rings = pel_scene_value_integer(value, "rings");
    refine->budget = pel_scene_value_integer(value, "budget");
    refine->springs = (pel_refine_springs)pel_scene_value_number(value, "springs");
    refine->everywhere = pel_scene_value_boolean(value, "everywhere");
    refine->near_tools = near != NULL ? near->number : 0;
    if (pel_scene_value_entry(value, "dwell") != NULL) {
        refine->dwell = pel_scene_value_integer(value, "dwell");
        refine->interval = pel_scene_value_integer(value, "interval");
    }
    pel_status status = check_refine(source, value, refine->everywhere);
    if (status == PEL_OK)
        status = read_thresholds(source, value, &refine->above, &refine->below);
    if (status == PEL_OK && curvature != NULL)
        status = read_thresholds(source, curvature, &refine->curvature_above, &refine->curvature_below);
    if (status != PEL_OK || region == NULL)
        return status;
    const pel_scene_value *levels = pel_scene_value_entry(value, "region_levels");
    refine->region_levels = (int32_t)levels->number;
    if (refine->region_levels <= refine->levels)
        return pel_scene_read_vertices(source, region, &refine->region, &refine->region_count);
    pel_scene_fail(source->reader, &levels->place, "region_levels is %d, the body has %d levels",
                   (int)refine->region_levels, (int)refine->levels);
    pel_fail_remedy(source->reader->error, "raise levels, or give at most %d", (int)refine->levels);
    return PEL_BAD_SCENE;
}

static pel_status read_body(const pel_scene_body_source *source, pel_body_def *body)
{
    *body = pel_body_def_default();
    body->name = pel_scene_value_entry(source->value, "name")->text;
    body->mesh = source->mesh;
    pel_scene_value_numbers(pel_scene_value_entry(source->value, "velocity"), body->velocity);
    pel_scene_value_numbers(pel_scene_value_entry(source->value, "angular_velocity"), body->angular_velocity);
    body->volumetric_by_area = pel_scene_value_boolean(source->value, "scale_with_area");
    body->reference_count = pel_scene_value_integer(source->value, "reference_count");
    read_surface(source, body);
    pel_status status = read_refine(source, &body->refine);
    if (status == PEL_OK)
        status = pel_scene_build_tissue(source, body);
    if (status == PEL_OK)
        status = pel_scene_build_shell(source, &body->shell);
    if (status != PEL_OK)
        return status;
    /* a support that moves is a tool (build_sim.c) */
    if (pel_scene_value_entry(source->value, "support") != NULL)
        return PEL_OK;
    return pel_scene_read_vertices(source, pel_scene_value_entry(source->value, "pinned"), &body->pinned,
                                   &body->pinned_count);
}

pel_status pel_scene_build_bodies(pel_scene_reader *reader, const pel_scene_value *root, const char *folder,
                                  pel_scene *scene, pel_mesh **meshes, int32_t *mesh_count)
{
    const pel_scene_value *list = pel_scene_value_entry(root, "bodies");
    pel_body_def *bodies = pel_arena_take(reader->arena, (size_t)pel_scene_value_count(list), sizeof *bodies);
    if (bodies == NULL)
        return pel_fail_memory(reader->error);
    pel_status status = pel_scene_check_names(reader, list);
    int32_t count = 0;
    for (const pel_scene_value *value = list->first; status == PEL_OK && value != NULL; value = value->next) {
        status = pel_scene_mesh(reader, pel_scene_value_entry(value, "mesh"), folder, &meshes[count]);
        if (status != PEL_OK)
            break;
        pel_scene_body_source source = {reader, value, meshes[count]};
        *mesh_count = count + 1;
        status = read_body(&source, &bodies[count++]);
    }
    scene->model = pel_model_def_default();
    scene->model.bodies = bodies;
    scene->model.body_count = count;
    pel_scene_value_numbers(pel_scene_value_entry(root, "gravity"), scene->model.gravity);
    return status;
}
