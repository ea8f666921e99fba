/* The single table of all keys of a scene. The checker, the defaults, the JSON Schema, the reference page, the
   parameter paths and --set are derived from it. */
#ifndef PEL_SCENE_TABLE_H
#define PEL_SCENE_TABLE_H

#include "base/status.h"
#include "scene/arena.h"

/* Forms of values; a row allows one form or several. */
typedef enum pel_scene_form {
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
} pel_scene_form;

typedef struct pel_scene_range {
    bool given;
    bool open; /* `least` itself is not allowed */
    double least, most;
} pel_scene_range;

typedef struct pel_scene_row {
    const char
        *path; /* "bodies[].springs.stiffness"; [] is any element; <name> begins a group that several rows share */
    unsigned forms;
    const char *unit; /* null = none */
    pel_scene_range range;
    const char *preset;     /* default, as YAML; # is the element's number from 1; null = none */
    bool varies;            /* other keys of the scene may imply another default, see `doc` */
    bool required;          /* required */
    const char *supplied;   /* required, but for this key of the same map, which fills it in; "" = keys elsewhere do */
    bool alternative;       /* exactly one of the alternatives of a map is given */
    bool scoped;            /* unit and range come from the row that is `like` this group */
    const char *needs;      /* allowed (and required, filled in) only with this key or one of these, "a, b" ... */
    const char *needs_word; /* ... with this value; null = any */
    const char *like;       /* group of the entries, "<region>" */
    const char *const *words; /* null-terminated */
    const char *doc;          /* one sentence without full stop */
} pel_scene_row;

typedef struct pel_scene_table {
    const pel_scene_row *rows;
    size_t row_count;
    const size_t *parent_lengths; /* (row_count) of the prefix that a row stands directly below */
    const char *const *names;     /* (row_count) name of each row below that prefix; null = none */
    const size_t *siblings;       /* (row_count) the next row with a name and the same prefix; row_count = none */
} pel_scene_table;

/* the rows of the program plus the parameters of every shape of pellicle/shape.h; null when out of memory */
const pel_scene_table *pel_scene_table_create(pel_arena *arena);

/* prefix of the children's paths: the group of the row, else its path; "" for the root */
const char *pel_scene_row_prefix(const pel_scene_row *row);
/* the key of a row that stands directly below the prefix, as pel_scene_row_next gives it; "[]" for the element of a
 * list */
const char *pel_scene_row_name(const pel_scene_row *row, const char *prefix);
/* the row after `row` (null: the first) directly below a prefix, null after the last */
const pel_scene_row *pel_scene_row_next(const pel_scene_table *table, const char *prefix, const pel_scene_row *row);
/* the row of that name below a prefix, the first of several; null if there is none */
const pel_scene_row *pel_scene_row_find(const pel_scene_table *table, const char *prefix, const char *name);

/* whether a row with a condition is allowed with this key */
bool pel_scene_row_needs(const pel_scene_row *row, const char *key);

/* "number or auto" */
const char *pel_scene_form_text(const pel_scene_row *row, char *text, size_t size);
/* "> 0", "1 to 20"; empty when there is no range */
const char *pel_scene_range_text(pel_scene_range range, char *text, size_t size);
bool pel_scene_range_has(pel_scene_range range, double number);

#endif
