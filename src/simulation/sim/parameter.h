/* Parameters in defs, without a simulation: their places, and values of them. The rows of the table of members
   (def/row.h) say what a parameter is. */
#ifndef PEL_SIM_PARAMETER_H
#define PEL_SIM_PARAMETER_H

#include "def/row.h"
#include "stage/stage.h"

/* Place of a parameter in the defs of a model and a simulation. */
typedef struct pel_parameter_place {
    int32_t row, element; /* of the table; of all that its def has in these defs */
} pel_parameter_place;

/* The place of a path. PEL_BAD_ARGUMENT. */
pel_status pel_parameter_find_place(const pel_model_def *model, const pel_sim_def *sim, const char *path,
                                    pel_parameter_place *found, pel_error *error);
/* Writes a value, in the form of scenes, to writable defs. False, without a change, if it is not a value of this
   parameter, or depends on more than its text, such as auto. */
bool pel_parameter_write(const pel_model_def *model, const pel_sim_def *sim, pel_parameter_place at, const char *text);
/* Writes a value of defs to a simulation that was made from them, where its row is direct. PEL_BAD_ARGUMENT. */
pel_status pel_parameter_copy(pel_sim *sim, const pel_sim_def *def, pel_parameter_place at, pel_error *error);

#endif
