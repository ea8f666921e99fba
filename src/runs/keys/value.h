/* A scene as a tree of values, each with its place. YAML and overrides become such a tree (yaml.c, override.c);
   validate.c compares it with the table and fills in the defaults; print.c writes it; the room `scene` reads the defs
   out of it. */
#ifndef PEL_KEYS_VALUE_H
#define PEL_KEYS_VALUE_H

#include "base/status.h"
#include "keys/arena.h"

/* where a value stands: a file, or "--set a.b=c" with line 0 */
typedef struct pel_scene_place {
    const char *source;
    int32_t line, column; /* from 1 */
} pel_scene_place;

typedef enum pel_scene_value_kind { PEL_SCENE_SCALAR, PEL_SCENE_LIST, PEL_SCENE_MAP } pel_scene_value_kind;

typedef struct pel_scene_value {
    pel_scene_value_kind kind;
    bool quoted;      /* a scalar in quotes is text, never a number */
    bool is_implied;  /* left out, filled in by its preset or by another key (defaults.c) */
    unsigned form;    /* the pel_form that the checker found it to have */
    double number;    /* of numbers; the index of a word; 0 or 1 of a boolean */
    const char *text; /* of scalars */
    const char *key;  /* of the entries of a map */
    pel_scene_place key_place, place;
    struct pel_scene_value *parent, *first, *last, *next; /* elements or entries in order */
} pel_scene_value;

/* what all parts of reading one scene share */
/* the vertices of a mesh whose seams were welded */
struct pel_sequence;

typedef struct pel_scene_welding {
    const struct pel_mesh *mesh;
    const int32_t *index_of; /* (file_count) the vertex of each vertex of the file */
    int32_t file_count;
    struct pel_scene_welding *next;
} pel_scene_welding;

typedef struct pel_scene_reader {
    pel_arena *arena;
    const struct pel_scene_table *table;
    const pel_log *log;
    pel_error *error;
    pel_scene_welding *weldings; /* of the meshes that have some */
    /* meshes of the bodies and tools in the order of the scene, which were made before; null = none */
    struct pel_mesh *const *made;
    struct pel_sequence **sequences; /* (bodies) that they follow; null = none */
} pel_scene_reader;

/* a new value at a place, null when out of memory (the error is filled) */
pel_scene_value *pel_scene_value_create(pel_scene_reader *reader, pel_scene_value_kind kind, pel_scene_place place);
/* a new scalar with that text */
pel_scene_value *pel_scene_value_text(pel_scene_reader *reader, const char *text, pel_scene_place place);
/* appends a list element (key null) or a map entry */
void pel_scene_value_append(pel_scene_value *parent, const char *key, pel_scene_value *child);
/* takes a child out of its parent */
void pel_scene_value_remove(pel_scene_value *child);

/* the entry of a map, null if there is none or value is no map */
pel_scene_value *pel_scene_value_entry(const pel_scene_value *value, const char *key);
/* the value below a dotted path of keys, "springs.stiffness"; null if there is none */
pel_scene_value *pel_scene_value_at(const pel_scene_value *value, const char *path);
/* content of a checked value below a path; it must exist: see the table for defaults and required keys */
double pel_scene_value_number(const pel_scene_value *value, const char *path);
int32_t pel_scene_value_integer(const pel_scene_value *value, const char *path);
/* the numbers of a list of them */
void pel_scene_value_numbers(const pel_scene_value *list, double *numbers);
/* the element of a list, null if there is none */
pel_scene_value *pel_scene_value_element(const pel_scene_value *value, int64_t index);
/* number of elements or entries */
int32_t pel_scene_value_count(const pel_scene_value *value);
/* "bodies.0.springs.stiffness"; at most size bytes; returns text */
const char *pel_scene_value_path(const pel_scene_value *value, char *text, size_t size);

/* PEL_BAD_SCENE at a place; the remedy follows by pel_fail_remedy */
pel_status pel_scene_fail(pel_scene_reader *reader, const pel_scene_place *place, const char *format, ...)
    PEL_PRINTF(3, 4);

/* Puts a failure that the library has just told at a place in the scene; bad arguments become PEL_BAD_SCENE. Returns
   the status. */
pel_status pel_scene_fail_at(pel_scene_reader *reader, const pel_scene_place *place);

/* Numbers of the YAML 1.2 core schema (10, -1.5, .5, 1.0e5, 0x1F, 0o17). False for all other text; a number too large
   for a double gives infinity. */
bool pel_scene_parse_number(const char *text, double *number);
bool pel_scene_parse_integer(const char *text, double *number);

#endif
