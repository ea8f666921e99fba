/* Reads the members of a def out of a checked tree of values, by the table of members. */
#include "base/status.h"
#include "keys/table.h"
#include "scene/build.h"
#include "scene/mesh.h"
#include "scene/region.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static pel_status read_keys(pel_scene_reader *reader, const pel_def_row *row, const pel_scene_value *list, void *def)
{
    int32_t count = pel_scene_value_count(list), k = 0;
    pel_key *keys = pel_arena_take(reader->arena, (size_t)count, sizeof *keys);
    if (keys == NULL)
        return pel_fail_memory(reader->error);
    for (const pel_scene_value *pair = list->first; pair != NULL; pair = pair->next, k++) {
        keys[k] = (pel_key){pair->first->number, pair->last->number / pel_def_row_factor(row)};
        if (k > 0 && !(keys[k].time > keys[k - 1].time)) {
            pel_scene_fail(reader, &pair->place, "the times of the keys do not increase: %g after %g", keys[k].time,
                           keys[k - 1].time);
            pel_fail_remedy(reader->error,
                            "order the keys by time; for a jump use two keys with slightly different times");
            return PEL_BAD_SCENE;
        }
    }
    pel_member_set_keys(row, def, keys, count);
    return PEL_OK;
}

/* the field's value, mapped by the line through map[0] at 0 and map[1] at 1 if there is a map */
static double mapped(const double map[2], double value)
{
    return map[0] + value * (map[1] - map[0]);
}

/* numbers on the vertices from a field and its map */
static pel_status read_field(const pel_scene_part *part, const pel_def_row *row, const pel_scene_value *value,
                             void *def)
{
    pel_scene_reader *reader = part->reader;
    const pel_scene_value *name = pel_scene_value_entry(value, "field"), *map = pel_scene_value_entry(value, "map");
    const double *values;
    pel_status status = pel_scene_field(reader, name, part->mesh, &values);
    if (status != PEL_OK)
        return status;
    double ends[2] = {0, 1};
    if (map != NULL)
        pel_scene_value_numbers(map, ends);
    double *numbers = pel_arena_take(reader->arena, (size_t)part->mesh->vertex_count, sizeof *numbers);
    if (numbers == NULL)
        return pel_fail_memory(reader->error);
    for (int32_t v = 0; v < part->mesh->vertex_count; v++) {
        double number = map != NULL ? mapped(ends, values[v]) : values[v];
        numbers[v] = number / pel_def_row_factor(row);
        if (pel_range_has(row->range, number))
            continue;
        char path[160], range[80];
        pel_scene_fail(reader, &name->place, "%s is %g at vertex %d, out of range",
                       pel_scene_value_path(value, path, sizeof path), number, (int)v);
        pel_fail_remedy(reader->error, "it must be %s %s; `map: [a, b]` maps the field values 0 and 1 to a and b",
                        pel_range_text(row->range, range, sizeof range), row->unit);
        return PEL_BAD_SCENE;
    }
    const double none = 0;
    pel_member_set(row, def, &none); /* fingerprints tell 0 from -0 */
    ((pel_quantity *)(void *)((char *)def + row->offset))->field = numbers;
    return PEL_OK;
}

/* numbers on the vertices from a base and regions */
static pel_status read_regions(const pel_scene_part *part, const pel_def_row *row, const pel_scene_value *value,
                               void *def)
{
    pel_scene_reader *reader = part->reader;
    const pel_scene_value *list = pel_scene_value_entry(value, "regions");
    const double base = pel_scene_value_number(value, "base") / pel_def_row_factor(row);
    double *numbers = pel_arena_take(reader->arena, (size_t)part->mesh->vertex_count, sizeof *numbers);
    if (numbers == NULL)
        return pel_fail_memory(reader->error);
    for (int32_t v = 0; v < part->mesh->vertex_count; v++)
        numbers[v] = base;
    for (const pel_scene_value *item = list != NULL ? list->first : NULL; item != NULL; item = item->next) {
        const double number = pel_scene_value_number(item, "value") / pel_def_row_factor(row);
        pel_scene_region region;
        pel_status status = pel_scene_region_find(reader, pel_scene_value_entry(item, "region"), part->mesh, &region);
        if (status != PEL_OK)
            return status;
        for (int32_t i = 0; i < region.count; i++) {
            double *at = &numbers[region.vertices != NULL ? region.vertices[i] : i];
            *at += (region.weights != NULL ? region.weights[i] : 1) * (number - *at);
        }
    }
    const double none = 0;
    pel_member_set(row, def, &none);
    ((pel_quantity *)(void *)((char *)def + row->offset))->field = numbers;
    return PEL_OK;
}

/* The number or numbers of a value; false for other values, which the code of their part reads. NAN is a word such as
   auto. */
static bool find_numbers(const pel_def_row *row, const pel_scene_value *value, double numbers[3])
{
    const char *const *words = pel_def_row_words(row);
    numbers[0] = value->number;
    switch (value->form) {
    case PEL_FORM_VECTOR:
        pel_scene_value_numbers(value, numbers);
        return row->store == PEL_STORE_DOUBLE;
    case PEL_FORM_MAP:
        numbers[0] = 1;
        return row->store == PEL_STORE_BOOL;
    case PEL_FORM_WORD:
        if (row->forms != PEL_FORM_WORD) {
            numbers[0] = (double)NAN;
            return row->may_be_auto;
        }
        for (numbers[0] = 0; strcmp(words[(int)numbers[0]], value->text) != 0;)
            numbers[0]++;
        return true;
    default:
        return value->form != PEL_FORM_TEXT && value->form != PEL_FORM_LIST;
    }
}

static pel_status read_member(const pel_scene_part *part, const pel_def_row *row, const pel_scene_value *value,
                              void *def)
{
    void *at = (char *)def + row->offset;
    const pel_scene_value *keys = pel_scene_value_entry(value, "keys");
    double numbers[3];
    if (row->store == PEL_STORE_QUANTITY && keys != NULL)
        return read_keys(part->reader, row, keys, def);
    if (row->store == PEL_STORE_QUANTITY && value->form == PEL_FORM_MAP)
        return pel_scene_value_entry(value, "base") != NULL ? read_regions(part, row, value, def)
                                                            : read_field(part, row, value, def);
    if (row->store == PEL_STORE_KEYS)
        return read_keys(part->reader, row, value, def);
    if (row->store == PEL_STORE_TEXT)
        memcpy(at, &value->text, sizeof value->text);
    else if (row->store <= PEL_STORE_QUANTITY && find_numbers(row, value, numbers))
        pel_member_set(row, def, numbers);
    return PEL_OK;
}

pel_status pel_scene_read_members(const pel_scene_part *part, pel_def_kind kind, void *def)
{
    static const char *const prefixes[PEL_DEF_COUNT] = {
        [PEL_DEF_BODY] = "bodies[].",
        [PEL_DEF_FIBRES] = "<anisotropy>.",
        [PEL_DEF_SUPPORT] = "bodies[].supports[].",
        [PEL_DEF_MODEL] = "",
        [PEL_DEF_LOAD] = "loads[].",
        [PEL_DEF_TOOL] = "tools[].",
        [PEL_DEF_CONTACT] = "contact.",
        [PEL_DEF_SOLVER] = "solver.",
        [PEL_DEF_SIM] = "",
        [PEL_DEF_SCENE] = "",
        [PEL_DEF_OUTPUT] = "output.",
        [PEL_DEF_CUT] = "cuts[].",
        [PEL_DEF_TIE] = "attachments[].",
        [PEL_DEF_JOINT] = "joints[].",
        [PEL_DEF_SEAM] = "seams[].",
    };
    const pel_scene_table *table = part->reader->table;
    pel_status status = PEL_OK;
    for (size_t i = 0; status == PEL_OK && i < table->row_count; i++) {
        const pel_def_row *row = &table->rows[i];
        const pel_scene_value *value =
            row->def == kind ? pel_scene_value_at(part->value, row->path + strlen(prefixes[kind])) : NULL;
        if (value != NULL)
            status = read_member(part, row, value, def);
    }
    return status;
}
