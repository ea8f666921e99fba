/* The table of the parameters of a simulation: the place of each in the defs, its range, and whether it can change
   while the simulation runs. Paths, units and ranges agree with the scene table (tests/scene/test_parameters.c). */
#ifndef PEL_SIM_PARAMETER_TABLE_H
#define PEL_SIM_PARAMETER_TABLE_H

#include "pellicle/live.h"
#include "stage/stage.h"

/* def that contains a parameter; the order of lists of parameters */
typedef enum pel_parameter_owner {
    PEL_OWNER_BODY,
    PEL_OWNER_REGION, /* pel_anisotropy_def */
    PEL_OWNER_SUPPORT,
    PEL_OWNER_MODEL,
    PEL_OWNER_LOAD,
    PEL_OWNER_TOOL,
    PEL_OWNER_CONTACT,
    PEL_OWNER_SOLVER,
    PEL_OWNER_COUNT
} pel_parameter_owner;

/* how a value is stored */
typedef enum pel_parameter_store {
    PEL_STORE_DOUBLE,   /* and vectors of three */
    PEL_STORE_QUANTITY, /* pel_quantity */
    PEL_STORE_KEYS,     /* const pel_key * followed by an int32_t count: factor over time; not a number itself */
    PEL_STORE_INT,      /* int32_t and enums */
    PEL_STORE_BOOL
} pel_parameter_store;

typedef struct pel_parameter_row {
    const char *path; /* of the scene table, but for regions of fibres: "bodies[].anisotropy[].stiffness" */
    pel_parameter_owner owner;
    pel_parameter_kind kind;
    pel_parameter_store store;
    size_t offset;       /* in the def of the owner */
    size_t count_offset; /* of PEL_STORE_KEYS */
    const char *unit;    /* null = none */
    double least, most;
    bool is_open;
    bool may_be_auto;
    double automatic; /* in the def */
    bool may_be_keyed;
    double factor; /* value of the parameter over that in the def; 0 = 1 */
    const char *const *words;
    bool (*applies)(const void *def); /* null = always */
    bool is_direct;               /* is read from the def's copy in the sim at each step: nothing has to be rebuilt */
    bool is_implying;             /* a scene that leaves others out takes them from it */
    const char *refusal, *remedy; /* null = it can change while running */
} pel_parameter_row;

/* null after the last */
const pel_parameter_row *pel_parameter_row_at(int32_t index);

/* Place of a parameter in the defs of a model and a simulation. */
typedef struct pel_parameter_place {
    int32_t row, element; /* of the table; of all that its owner has in these defs */
} pel_parameter_place;

/* ---- parameter.c: in defs, without a simulation ---- */
/* The place of a path. PEL_BAD_ARGUMENT. */
pel_status pel_parameter_find_place(const pel_model_def *model, const pel_sim_def *sim, const char *path,
                                    pel_parameter_place *found, pel_error *error);
/* Writes a value, in the form of scenes, to writable defs. False, without a change, if it is not a value of this
   parameter, or depends on more than its text, such as auto. */
bool pel_parameter_write(const pel_model_def *model, const pel_sim_def *sim, pel_parameter_place at, const char *text);
/* Writes a value of defs to a simulation that was made from them, where its row is direct. PEL_BAD_ARGUMENT. */
pel_status pel_parameter_copy(pel_sim *sim, const pel_sim_def *def, pel_parameter_place at, pel_error *error);

#endif
