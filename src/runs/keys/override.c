#include "keys/override.h"

#include "keys/table.h"
#include "keys/validate.h"
#include "keys/yaml.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_NAMES = 64, SEGMENT_SIZE = 128 };

/* one override on its way down the tree */
typedef struct override_walk {
    pel_scene_reader *reader;
    pel_scene_place place; /* "--set a.b=c" */
    const char *rest;      /* of the path, up to `end` */
    const char *end;
    pel_scene_value *value; /* where we are */
    const pel_def_row *row; /* its row; null at the root and for parts of vectors */
} override_walk;

/* takes the next segment of the path; false when it is empty or too long */
static bool next_segment(override_walk *walk, char segment[SEGMENT_SIZE])
{
    const char *dot = memchr(walk->rest, '.', (size_t)(walk->end - walk->rest));
    const char *stop = dot != NULL ? dot : walk->end;
    size_t length = (size_t)(stop - walk->rest);
    if (length == 0 || length >= SEGMENT_SIZE)
        return false;
    memcpy(segment, walk->rest, length);
    segment[length] = '\0';
    walk->rest = dot != NULL ? dot + 1 : walk->end;
    return dot == NULL || dot + 1 < walk->end;
}

/* the number of a segment, -1 if it is no number */
static int64_t segment_index(const char *segment)
{
    size_t digits = strspn(segment, "0123456789");
    if (digits == 0 || digits > 9 || segment[digits] != '\0')
        return -1;
    return strtoll(segment, NULL, 10);
}

static pel_scene_value *element_of_name(const pel_scene_value *list, const char *name)
{
    pel_scene_value *element = list->first;
    for (; element != NULL; element = element->next) {
        const pel_scene_value *known = pel_scene_value_entry(element, "name");
        if (known != NULL && strcmp(known->text, name) == 0)
            return element;
    }
    return NULL;
}

static pel_status fail_element(override_walk *walk, const char *segment)
{
    const char *names[MOST_NAMES];
    size_t count = 0;
    for (const pel_scene_value *element = walk->value->first; element != NULL; element = element->next) {
        const pel_scene_value *name = pel_scene_value_entry(element, "name");
        if (name != NULL && count < MOST_NAMES)
            names[count++] = name->text;
    }
    char path[160];
    int32_t element_count = pel_scene_value_count(walk->value);
    if (count > 0 && segment_index(segment) < 0)
        return pel_scene_fail_name(walk->reader, &walk->place, "element", segment, names, count);
    pel_scene_fail(walk->reader, &walk->place, "%s has no element '%s'",
                   pel_scene_value_path(walk->value, path, sizeof path), segment);
    pel_fail_remedy(walk->reader->error, "it has %d, numbered from 0", (int)element_count);
    return PEL_BAD_SCENE;
}

/* moves to an element of the list, or appends one */
static pel_status enter_element(override_walk *walk, const char *segment)
{
    int64_t index = segment_index(segment);
    const pel_def_row *element_row =
        walk->row != NULL ? pel_scene_row_find(walk->reader->table, walk->row->path, "[]") : NULL;
    pel_scene_value *element =
        index >= 0 ? pel_scene_value_element(walk->value, index) : element_of_name(walk->value, segment);
    if (element == NULL && element_row != NULL && index == pel_scene_value_count(walk->value)) {
        element = pel_scene_value_create(walk->reader, PEL_SCENE_MAP, walk->place);
        if (element == NULL)
            return PEL_OUT_OF_MEMORY;
        pel_scene_value_append(walk->value, NULL, element);
    }
    if (element == NULL)
        return fail_element(walk, segment);
    walk->value = element;
    walk->row = element_row;
    return PEL_OK;
}

/* removes the other alternatives, and keys that need them, from a map */
static void remove_alternatives(pel_scene_reader *reader, const char *prefix, pel_scene_value *map, const char *kept)
{
    const pel_def_row *row = NULL;
    while ((row = pel_scene_row_next(reader->table, prefix, row)) != NULL) {
        const char *name = pel_scene_row_name(row, prefix);
        bool other = row->alternative && strcmp(name, kept) != 0;
        bool needs_other = row->needs != NULL && !pel_scene_row_needs(row, kept);
        pel_scene_value *entry = pel_scene_value_entry(map, name);
        if (entry != NULL && (other || needs_other))
            pel_scene_value_remove(entry);
    }
}

static pel_status fail_key(override_walk *walk, const char *prefix, const char *segment)
{
    const char *names[MOST_NAMES];
    size_t count = 0;
    const pel_def_row *row = NULL;
    while ((row = pel_scene_row_next(walk->reader->table, prefix, row)) != NULL)
        if (count < MOST_NAMES && pel_scene_row_applies(row, walk->value))
            names[count++] = pel_scene_row_name(row, prefix);
    return pel_scene_fail_key(walk->reader, &walk->place, prefix, segment, names, count);
}

/* moves to an entry of the map, which is added if missing */
static pel_status enter_entry(override_walk *walk, const char *segment)
{
    pel_scene_reader *reader = walk->reader;
    const char *prefix = pel_scene_row_prefix(walk->row);
    const pel_def_row *row = pel_scene_row_find(reader->table, prefix, segment);
    if (row == NULL || strcmp(segment, "[]") == 0)
        return fail_key(walk, prefix, segment);
    if (row->alternative)
        remove_alternatives(reader, prefix, walk->value, segment);
    pel_scene_value *entry = pel_scene_value_entry(walk->value, segment);
    if (entry == NULL) {
        bool is_list = (row->forms & (PEL_FORM_MAP | PEL_FORM_LIST)) == PEL_FORM_LIST;
        entry = pel_scene_value_create(reader, is_list ? PEL_SCENE_LIST : PEL_SCENE_MAP, walk->place);
        if (entry == NULL)
            return PEL_OUT_OF_MEMORY;
        pel_scene_value_append(walk->value, pel_scene_row_name(row, prefix), entry);
    }
    walk->value = entry;
    walk->row = row;
    return PEL_OK;
}

static pel_status enter(override_walk *walk, const char *segment)
{
    pel_scene_value *value = walk->value;
    if (value->kind == PEL_SCENE_LIST)
        return enter_element(walk, segment);
    bool may_be_map = value->parent == NULL || (walk->row != NULL && (walk->row->forms & PEL_FORM_MAP) != 0);
    if (!may_be_map) {
        char path[160];
        pel_scene_fail(walk->reader, &walk->place, "%s has no keys below it",
                       pel_scene_value_path(value, path, sizeof path));
        pel_fail_remedy(walk->reader->error, "give the whole value, such as [0, 0, 1] for a vector");
        return PEL_BAD_SCENE;
    }
    /* replace a number by a map */
    value->kind = PEL_SCENE_MAP;
    return enter_entry(walk, segment);
}

/* the value after the =; plain text needs no care about YAML's special characters */
static pel_scene_value *read_value(const override_walk *walk, const char *text)
{
    if (walk->row != NULL && walk->row->forms == PEL_FORM_TEXT && text[0] != '\0' && strcmp(text, "null") != 0)
        return pel_scene_value_text(walk->reader, text, walk->place);
    if (strspn(text, " ") == strlen(text))
        return pel_scene_value_create(walk->reader, PEL_SCENE_SCALAR, walk->place);
    return pel_scene_yaml_parse(walk->reader, walk->place.source, text, strlen(text), false);
}

/* puts a new value in the place of the present one */
static pel_status replace_value(override_walk *walk, const char *text)
{
    pel_scene_value *value = read_value(walk, text);
    if (value == NULL)
        return walk->reader->error->status;
    pel_scene_value *old = walk->value;
    old->kind = value->kind;
    old->quoted = value->quoted;
    old->text = value->text;
    old->place = old->key_place = walk->place;
    old->first = value->first;
    old->last = value->last;
    for (pel_scene_value *child = old->first; child != NULL; child = child->next)
        child->parent = old;
    return PEL_OK;
}

/* the place of an override in messages */
static const char *source_text(pel_scene_reader *reader, const char *text)
{
    char source[200];
    int length = snprintf(source, sizeof source, "--set %.180s", text);
    const char *copy = pel_arena_text(reader->arena, source, (size_t)length);
    if (copy == NULL)
        pel_fail_memory(reader->error);
    return copy;
}

pel_status pel_scene_override(pel_scene_reader *reader, pel_scene_value *root, const char *text)
{
    const char *source = source_text(reader, text);
    if (source == NULL)
        return PEL_OUT_OF_MEMORY;
    const char *equals = strchr(text, '=');
    override_walk walk = {reader, {source, 0, 0}, text, equals, root, NULL};
    if (equals == NULL || equals == text) {
        pel_scene_fail(reader, &walk.place, "this is not of the form KEY=VALUE");
        pel_fail_remedy(reader->error, "write it as solver.dt=0.005");
        return PEL_BAD_SCENE;
    }
    while (walk.rest < walk.end) {
        char segment[SEGMENT_SIZE];
        if (!next_segment(&walk, segment)) {
            pel_scene_fail(reader, &walk.place, "the path has an empty or very long part");
            pel_fail_remedy(reader->error, "write it as solver.dt=0.005");
            return PEL_BAD_SCENE;
        }
        pel_status status = enter(&walk, segment);
        if (status != PEL_OK)
            return status;
    }
    return replace_value(&walk, equals + 1);
}
