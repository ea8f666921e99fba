#include "scene/build.h"

#include "base/number.h"
#include "scene/table.h"

#include <math.h>
#include <string.h>

/* "relative 1e-4" */
static pel_status read_relative(pel_scene_reader *reader, const pel_scene_value *value, double *relative)
{
    static const char word[] = "relative ";
    const char *text = value->text, *end = text + strlen(text), *number = text + strlen(word);
    bool fine = strncmp(text, word, strlen(word)) == 0;
    if (fine && pel_number_parse(number, end, relative) == end && *relative > 0 && isfinite(*relative))
        return PEL_OK;
    pel_scene_fail(reader, &value->place, "`thickness` '%.80s' is not a thickness", text);
    pel_fail_remedy(reader->error, "give a number of metres, or `relative` and a number, such as relative 1e-4");
    return PEL_BAD_SCENE;
}

pel_status pel_scene_build_contact(pel_scene_reader *reader, const pel_scene_value *value, pel_contact_def *contact)
{
    contact->enabled = value != NULL;
    if (value == NULL)
        return PEL_OK;
    /* in the order of the words in the table */
    static const pel_ccd_method methods[] = {PEL_CCD_CONSERVATIVE, PEL_CCD_BRIDSON};
    static const pel_contact_response responses[] = {PEL_CONTACT_IN_LOOP, PEL_CONTACT_AFTER};
    const pel_scene_value *thickness = pel_scene_value_entry(value, "thickness");
    contact->self = pel_scene_value_boolean(value, "self");
    contact->between = pel_scene_value_boolean(value, "between");
    contact->friction = pel_scene_value_number(value, "friction");
    pel_scene_value_read(value, "restitution", &contact->restitution);
    contact->method = methods[pel_scene_value_integer(value, "method")];
    contact->response = responses[pel_scene_value_integer(value, "response")];
    contact->allow_tangled = pel_scene_value_integer(value, "start") == 1;
    contact->sweeps = pel_scene_value_integer(value, "sweeps");
    contact->limit = pel_scene_value_integer(value, "limit");
    const pel_scene_value *memory = pel_scene_value_entry(value, "memory_limit");
    contact->memory_limit = memory->form == PEL_FORM_NUMBER ? (int64_t)fmin(fmax(1, memory->number), 0x1p62) : 0;
    if (thickness->form != PEL_FORM_NUMBER)
        return read_relative(reader, thickness, &contact->relative_thickness);
    contact->thickness = thickness->number;
    return PEL_OK;
}
