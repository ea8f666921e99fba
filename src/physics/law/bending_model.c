#include "law/bending_model.h"

static const pel_bending_traits rows[PEL_BENDING_COUNT] = {
    [PEL_BENDING_ISOMETRIC] = {.has_hinges = true, .form = PEL_BENDING_LITERAL},
    [PEL_BENDING_ISOMETRIC_REST] = {.has_hinges = true, .form = PEL_BENDING_REST_SUBTRACTED},
    [PEL_BENDING_HINGE] = {.has_hinges = true, .is_angle = true, .has_rest_angles = true},
    [PEL_BENDING_MIDEDGE] = {.turns_edges = true, .has_rest_angles = true},
};

const char *const pel_bending_words[PEL_BENDING_COUNT + 1] = {
    [PEL_BENDING_NONE] = "none",
    [PEL_BENDING_ISOMETRIC] = "isometric",
    [PEL_BENDING_ISOMETRIC_REST] = "isometric-rest",
    [PEL_BENDING_HINGE] = "hinge",
    [PEL_BENDING_MIDEDGE] = "midedge",
};

const pel_bending_traits *pel_bending_traits_of(pel_bending_model model)
{
    return &rows[(unsigned)model < PEL_BENDING_COUNT ? model : PEL_BENDING_NONE];
}
