/* Questions that all readers of parts of a scene ask: names, bodies, times and lists of vertices. */
#include "keys/validate.h"
#include "scene/build.h"
#include "scene/region.h"

#include <string.h>

enum { MOST_NAMES = 64 };

pel_status pel_scene_find_body(pel_scene_reader *reader, const pel_scene_value *name, const pel_model_def *model,
                               int32_t *body)
{
    const char *names[MOST_NAMES];
    size_t count = 0;
    for (int32_t b = 0; b < model->body_count; b++) {
        if (strcmp(model->bodies[b].name, name->text) == 0) {
            *body = b;
            return PEL_OK;
        }
        if (count < MOST_NAMES)
            names[count++] = model->bodies[b].name;
    }
    return pel_scene_fail_name(reader, &name->place, "body", name->text, names, count);
}

pel_status pel_scene_fill_body(pel_scene_reader *reader, pel_scene_value *load, const pel_model_def *model,
                               const char *what)
{
    if (pel_scene_value_entry(load, "body") != NULL)
        return PEL_OK;
    if (model->body_count > 1) {
        pel_scene_fail(reader, &load->place, "the %s does not say on which body it acts", what);
        pel_fail_remedy(reader->error, "add `body: %s` or another name", model->bodies[0].name);
        return PEL_BAD_SCENE;
    }
    pel_scene_value *body = pel_scene_value_text(reader, model->bodies[0].name, load->place);
    if (body == NULL)
        return PEL_OUT_OF_MEMORY;
    body->form = PEL_FORM_TEXT;
    pel_scene_value_append(load, "body", body);
    return PEL_OK;
}

/* of a load or a grasp */
pel_status pel_scene_check_times(pel_scene_reader *reader, const pel_scene_value *value, double from, double until)
{
    if (until > from)
        return PEL_OK;
    pel_scene_fail(reader, &pel_scene_value_entry(value, "until")->place, "`until` %g is not after `from` %g", until,
                   from);
    pel_fail_remedy(reader->error, "use a later time, or omit it (default: the end of the run)");
    return PEL_BAD_SCENE;
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

pel_status pel_scene_read_vertices(const pel_scene_part *source, const pel_scene_value *value, const int32_t **vertices,
                                   int32_t *count)
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
