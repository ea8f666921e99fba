/* Properties of a bending model for the generic code, which asks them instead of the model itself. A model is an
   enumerator (pellicle/shell.h), a row here, and the measure that the rows' code calls: of hinges, which are two
   triangles that share an edge (pellicle/bending.h), or of triangles with rotations of their edges
   (measure/midedge.h). */
#ifndef PEL_LAW_BENDING_MODEL_H
#define PEL_LAW_BENDING_MODEL_H

#include "pellicle/bending.h"
#include "pellicle/shell.h"

typedef struct pel_bending_traits {
    bool has_hinges; /* the energy is a sum over hinges */
    bool is_angle;   /* of a hinge's change of angle; otherwise of the isometric stencil, in this form: */
    pel_bending_form form;
    bool turns_edges;     /* the energy is a sum over triangles, with a rotation of each edge as an unknown */
    bool has_rest_angles; /* so that PEL_FIBRE_CURL acts on it */
} pel_bending_traits;

/* all false for PEL_BENDING_NONE */
const pel_bending_traits *pel_bending_traits_of(pel_bending_model model);

/* words of scenes, by model; null after the last */
extern const char *const pel_bending_words[];

static inline bool pel_bending_is_on(const pel_bending_traits *traits)
{
    return traits->has_hinges || traits->turns_edges;
}

#endif
