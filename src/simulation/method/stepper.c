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

const pel_stepper *pel_stepper_find(const char *word)
{
    for (int i = 0; i < PEL_METHOD_COUNT; i++)
        if (strcmp(pel_method_words[i], word) == 0)
            return kinds[i];
    return NULL;
}
