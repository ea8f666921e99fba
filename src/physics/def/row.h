/* The table of members: one row for each key of a scene and the member of a def that it writes. From it come

       the checker, printer, schema and reference of scenes, and the reader of the defs   src/runs/scene
       the defaults of new defs (pel_def_reset)                                           this room
       fingerprints and copies of defs                                                    this room
       the parameters of a simulation and what they refuse                                src/simulation/sim
       the paths of `--set`, of Python and of JavaScript                                  the parameters

   A new key is a member of a public def and a row in rows.c. Keys that are no numbers or words, such as meshes and
   regions, have rows too; the reader of their part of a scene has code for them. */
#ifndef PEL_DEF_ROW_H
#define PEL_DEF_ROW_H

#include "pellicle/live.h"

/* ---- keys ---- */

/* Forms of values; a row allows one form or several. */
typedef enum pel_form {
    PEL_FORM_NUMBER = 1,
    PEL_FORM_INTEGER = 2,
    PEL_FORM_BOOLEAN = 4,
    PEL_FORM_WORD = 8,     /* one of the row's words */
    PEL_FORM_TEXT = 16,    /* any other text that is not empty */
    PEL_FORM_PAIR = 32,    /* [number, number] */
    PEL_FORM_KEY = 64,     /* [time, value]; times are not below 0, the range applies to the value */
    PEL_FORM_VECTOR = 128, /* [x, y, z] */
    PEL_FORM_LIST = 256,   /* elements by the row `path[]`; the range applies to their number */
    PEL_FORM_MAP = 512     /* entries as the rows `path.name` say */
} pel_form;

typedef struct pel_range {
    bool given;
    bool open; /* `least` itself is not allowed */
    double least, most;
} pel_range;

/* ---- members ---- */

/* Def that contains a member; parameters are listed in this order. */
typedef enum pel_def_kind {
    PEL_DEF_NONE, /* the key is no member */
    PEL_DEF_BODY,
    PEL_DEF_FIBRES, /* pel_anisotropy_def */
    PEL_DEF_SUPPORT,
    PEL_DEF_MODEL,
    PEL_DEF_LOAD,
    PEL_DEF_TOOL,
    PEL_DEF_CUT,
    PEL_DEF_TIE,
    PEL_DEF_JOINT,
    PEL_DEF_SEAM,
    PEL_DEF_CONTACT,
    PEL_DEF_SOLVER,
    PEL_DEF_SIM,
    PEL_DEF_SCENE,  /* pel_scene */
    PEL_DEF_OUTPUT, /* pel_output_def */
    PEL_DEF_COUNT
} pel_def_kind;

/* How a member is stored. */
typedef enum pel_store {
    PEL_STORE_DOUBLE, /* and arrays of them */
    PEL_STORE_INT,    /* int32_t and enums */
    PEL_STORE_INT64,
    PEL_STORE_BOOL,     /* and arrays of them */
    PEL_STORE_QUANTITY, /* pel_quantity */
    PEL_STORE_KEYS,     /* nullable const pel_key * with a count: factor over time */
    PEL_STORE_LIST,     /* nullable pointer with a count of elements of `size` bytes */
    PEL_STORE_FIELD,    /* nullable pointer to a double for each vertex of the body's mesh */
    PEL_STORE_MESH,     /* nullable const pel_mesh * */
    PEL_STORE_SEQUENCE, /* nullable const pel_sequence * */
    PEL_STORE_TEXT,     /* nullable const char * */
    PEL_STORE_DEF,      /* a def of kind `element` */
    PEL_STORE_DEFS      /* nullable pointer with a count of defs of kind `element` */
} pel_store;

/* Parts of the input that determines the result of a simulation, and their names for users (fingerprint.h). */
#define PEL_PARTS(ROW)                                                                                                 \
    ROW(MESH, "mesh")                                                                                                  \
    ROW(MASS, "mass")                                                                                                  \
    ROW(PINS, "pinned vertices")                                                                                       \
    ROW(START, "velocity at the start")                                                                                \
    ROW(GRAVITY, "gravity")                                                                                            \
    ROW(SPRINGS, "springs")                                                                                            \
    ROW(VOLUMETRIC, "volumetric springs")                                                                              \
    ROW(SURFACE, "contact of a body")                                                                                  \
    ROW(REFINEMENT, "refinement")                                                                                      \
    ROW(MEMBRANE, "membrane")                                                                                          \
    ROW(RIGID, "rigid bodies")                                                                                         \
    ROW(VOLUME, "volume")                                                                                              \
    ROW(BENDING, "bending")                                                                                            \
    ROW(ANISOTROPY, "anisotropy")                                                                                      \
    ROW(PRESSURE, "pressure")                                                                                          \
    ROW(LOADS, "loads")                                                                                                \
    ROW(SUPPORTS, "supports")                                                                                          \
    ROW(TOOLS, "tools")                                                                                                \
    ROW(TIES, "attachments, stitches and joints")                                                                      \
    ROW(CUTS, "cuts")                                                                                                  \
    ROW(CONTACT, "contact")                                                                                            \
    ROW(SOLVER, "solver")

typedef enum pel_part {
#define PEL_PART_ENUMERATOR(PART, name) PEL_PART_##PART,
    PEL_PARTS(PEL_PART_ENUMERATOR)
#undef PEL_PART_ENUMERATOR
        PEL_PART_COUNT,
    PEL_PART_NONE = PEL_PART_COUNT /* decides nothing: names, numbers of threads, limits of memory and time */
} pel_part;

/* ---- rows ---- */

typedef struct pel_def_row {
    /* ---- the key ----
       "bodies[].springs.stiffness"; [] is any element; <name> begins a group that several rows share; null = a member
       without a key of its own */
    const char *path;
    unsigned forms;
    const char *unit; /* null = none */
    pel_range range;
    const char *preset;     /* default of scenes, as YAML; # is the element's number from 1; null = none */
    bool varies;            /* other keys of the scene may imply another default, see `doc` */
    bool required;          /* must be given */
    const char *supplied;   /* required, but for this key of the same map, which fills it in; "" = keys elsewhere do */
    bool alternative;       /* exactly one of the alternatives of a map is given */
    bool scoped;            /* unit and range come from the row that is `like` this group */
    const char *needs;      /* allowed (and required, filled in) only with this key or one of these, "a, b" ... */
    const char *needs_word; /* ... with this value; null = any */
    const char *like;       /* group of the entries, "<region>" */
    const char *const *words; /* null-terminated */
    const char *doc;          /* one sentence without full stop */

    /* ---- the member ---- */
    pel_def_kind def;
    pel_store store;
    pel_part part;
    size_t offset, size;       /* in the def; of the member, or of an element of a list */
    size_t count_offset;       /* of lists: int32_t */
    pel_def_kind element;      /* of nested defs */
    double initial;            /* value of a member in a new def, in its unit; 0 = `automatic` */
    bool may_be_auto;          /* `auto`, `end` or a missing key are ... */
    double automatic;          /* ... this value of the member */
    double factor;             /* value of the key over that of the member; 0 = 1 */
    const char *const *values; /* the words in the order of the member's values; null = `words` */

    /* ---- the parameter ---- */
    const char *parameter_path;       /* null = `path` */
    bool is_fixed;                    /* decided when a simulation is made: no parameter */
    bool (*applies)(const void *def); /* the def reads this member; null = always */
    bool is_direct;               /* is read from the def's copy in the sim at each step: nothing has to be rebuilt */
    bool is_implying;             /* a scene that leaves others out takes them from it */
    const char *refusal, *remedy; /* null = it can change while running */
} pel_def_row;

/* of one def */
enum { PEL_MOST_MEMBERS = 128 };

int32_t pel_def_row_count(void);
/* All rows but those of meshes, runs and outputs, in the order of the reference page; null before the first and after
   the last. */
const pel_def_row *pel_def_row_at(int32_t index);
/* The row of a member, the first of several; null if there is none. */
const pel_def_row *pel_def_row_of(pel_def_kind kind, size_t offset);
/* One row for each member of a def, in the order of memory. Returns their number. */
int32_t pel_def_members(pel_def_kind kind, const pel_def_row *members[PEL_MOST_MEMBERS]);
/* The index of the next parameter, def by def in the order of pel_def_kind; -1 before the first and after the last. */
int32_t pel_def_parameter_after(int32_t index);
pel_parameter_kind pel_def_row_kind(const pel_def_row *row);
/* words of the methods in scenes; null after the last */
extern const char *const pel_method_words[];
/* the words of a parameter in the order of its values; null = it is no word */
const char *const *pel_def_row_words(const pel_def_row *row);
/* its values may vary over time */
bool pel_def_row_may_be_keyed(const pel_def_row *row);

/* ---- values ---- */

/* Fills a def of zeros with the values of a new one. */
void pel_def_reset(pel_def_kind kind, void *def);
/* Writes numbers to a member of a def, three of a vector, else one; NAN is `auto`. */
void pel_member_set(const pel_def_row *row, void *def, const double *values);
/* Writes keys to a member; they stay the caller's. */
void pel_member_set_keys(const pel_def_row *row, void *def, const pel_key *keys, int32_t count);
/* The keys of a member, null for none. */
const pel_key *pel_member_keys(const pel_def_row *row, const void *def, int32_t *count);
/* value of the key over that of the member */
double pel_def_row_factor(const pel_def_row *row);

/* ---- ranges ---- */

/* "> 0", "1 to 20"; empty when there is no range */
const char *pel_range_text(pel_range range, char *text, size_t size);
bool pel_range_has(pel_range range, double number);

#endif
