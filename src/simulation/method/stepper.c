#include "stage/stepper.h"

#include "def/row.h"

#include <string.h>

static const pel_stepper *const kinds[] = {
#define KIND(METHOD, name, word) [PEL_METHOD_##METHOD] = &pel_step_##name##_kind,
    PEL_METHODS(KIND)
#undef KIND
};

const pel_stepper *pel_stepper_of(pel_method method)
{
    return kinds[method];
}

const pel_stepper *pel_stepper_for(pel_method method, const pel_model *model)
{
    bool has_rigid = false;
    for (int32_t b = 0; b < model->body_count; b++)
        has_rigid |= model->bodies[b].rigid != NULL;
    return has_rigid && method == PEL_METHOD_EXPLICIT ? &pel_step_explicit_rigid_kind : kinds[method];
}

const pel_stepper *pel_stepper_find(const char *word)
{
    for (int i = 0; i < PEL_METHOD_COUNT; i++)
        if (strcmp(pel_method_words[i], word) == 0)
            return kinds[i];
    return NULL;
}
