#include "keys/shape_rows.h"

#include "pellicle/shape.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const pel_shape_info *shape_info(int kind)
{
    return pel_shape_info_of((pel_shape_kind)kind);
}

const char *const *pel_scene_shape_words(pel_arena *arena)
{
    const char **words = pel_arena_take(arena, PEL_SHAPE_COUNT + 1, sizeof *words);
    for (int kind = 0; words != NULL && kind < PEL_SHAPE_COUNT; kind++)
        words[kind] = shape_info(kind)->name;
    return words;
}

size_t pel_scene_shape_row_count(void)
{
    size_t count = 0;
    for (int kind = 0; kind < PEL_SHAPE_COUNT; kind++)
        count += (size_t)shape_info(kind)->parameter_count;
    return count;
}

/* the null-terminated copy of a choice's names */
static const char *const *copy_choices(pel_arena *arena, const pel_shape_parameter *parameter)
{
    size_t count = (size_t)parameter->maximum + 1;
    const char **words = pel_arena_take(arena, count + 1, sizeof *words);
    if (words != NULL)
        memcpy(words, parameter->choices, count * sizeof *words);
    return words;
}

static const char *preset_text(pel_arena *arena, const pel_shape_info *info, const pel_shape_parameter *parameter)
{
    char text[64];
    pel_shape_def def = pel_shape_def_default(info->kind);
    pel_shape_get(&def, parameter, text, sizeof text);
    return pel_arena_text(arena, text, strlen(text));
}

static const char *row_path(pel_arena *arena, const char *prefix, const char *name)
{
    char text[128];
    int length = snprintf(text, sizeof text, "%s.%s", prefix, name);
    return pel_arena_text(arena, text, (size_t)length);
}

static bool make_row(pel_arena *arena, const char *prefix, const pel_shape_info *info,
                     const pel_shape_parameter *parameter, pel_def_row *row)
{
    static const unsigned forms[] = {
        [PEL_SHAPE_NUMBER] = PEL_FORM_NUMBER,
        [PEL_SHAPE_INTEGER] = PEL_FORM_INTEGER,
        [PEL_SHAPE_BOOLEAN] = PEL_FORM_BOOLEAN,
        [PEL_SHAPE_CHOICE] = PEL_FORM_WORD,
    };
    *row = (pel_def_row){
        .path = row_path(arena, prefix, parameter->name),
        .forms = forms[parameter->type],
        .unit = parameter->unit[0] != '\0' ? parameter->unit : NULL,
        .preset = preset_text(arena, info, parameter),
        .needs = "shape",
        .needs_word = info->name,
        .doc = parameter->doc,
    };
    if (parameter->type == PEL_SHAPE_CHOICE)
        row->words = copy_choices(arena, parameter);
    if (parameter->type == PEL_SHAPE_NUMBER || parameter->type == PEL_SHAPE_INTEGER)
        row->range = (pel_range){true, parameter->exclusive_minimum, parameter->minimum, parameter->maximum};
    return row->path != NULL && row->preset != NULL && (parameter->type != PEL_SHAPE_CHOICE || row->words != NULL);
}

bool pel_scene_shape_rows(pel_arena *arena, const char *prefix, pel_def_row *rows)
{
    for (int kind = 0; kind < PEL_SHAPE_COUNT; kind++) {
        const pel_shape_info *info = shape_info(kind);
        for (int32_t i = 0; i < info->parameter_count; i++)
            if (!make_row(arena, prefix, info, &info->parameters[i], rows++))
                return false;
    }
    return true;
}
