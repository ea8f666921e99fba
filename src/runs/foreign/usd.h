/* USD as text (openusd.org: "Usda file format", schemas UsdGeomMesh and UsdGeomXformable), as Blender, Houdini, Maya
   and `pellicle convert` write it: the meshes of the stage where their prims stand, and their samples over time.

   usd.c        the prims of the file: meshes, visibility, what is not followed
   usd_place.c  where prims stand at a time: xformOps
   usd_text.c   values: numbers, samples, and what is passed over */
#ifndef PEL_FOREIGN_USD_H
#define PEL_FOREIGN_USD_H

#include "foreign/place.h"
#include "io/text_cursor.h"
#include "pellicle/mesh.h"
#include "pellicle/sequence.h"

/* ---- values ---- */

/* The numbers of an attribute at each of its time codes, without brackets: sample i is values[ends[i - 1]] up to
   values[ends[i]]. A value without a time has one sample. */
typedef struct pel_usd_samples {
    double *codes;  /* (count) rising */
    size_t *ends;   /* (count) */
    double *values; /* (value_count) */
    size_t count, value_count, code_capacity, end_capacity, value_capacity;
    bool is_timed;
} pel_usd_samples;

void pel_usd_samples_free(pel_usd_samples *samples);
/* the numbers of sample i; count = how many */
const double *pel_usd_sample(const pel_usd_samples *samples, size_t i, size_t *count);
/* The last sample not after a code (the first one before all), and how far the code is on the way to the next: 0 to 1,
   0 where the next has another number of values. There is at least one sample. */
size_t pel_usd_sample_at(const pel_usd_samples *samples, double code, double *share);

/* Each moves after what it reads. PEL_BAD_FORMAT with the place, PEL_OUT_OF_MEMORY. */
pel_status pel_usd_read_value(pel_text_cursor *scan, pel_usd_samples *samples, pel_error *error);
/* { code: value, ... } */
pel_status pel_usd_read_samples(pel_text_cursor *scan, pel_usd_samples *samples, pel_error *error);
/* a string in quotes; text (length) without them, escapes as they are */
pel_status pel_usd_read_string(pel_text_cursor *scan, const char **text, size_t *length, pel_error *error);
/* any value */
pel_status pel_usd_pass_value(pel_text_cursor *scan, pel_error *error);
/* from an opening bracket to the closing one */
pel_status pel_usd_pass_group(pel_text_cursor *scan, pel_error *error);
/* white space, comments and semicolons */
void pel_usd_pass_space(pel_text_cursor *scan);
/* a word of letters, digits and _:.-![] (length 0: there is none) */
const char *pel_usd_word(pel_text_cursor *scan, size_t *length);
bool pel_usd_is(const char *word, size_t length, const char *other);

/* ---- places ---- */

/* an attribute xformOp:KIND[:NAME] */
typedef struct pel_usd_op {
    const char *name; /* (length) in the text */
    size_t length;
    pel_usd_samples samples;
} pel_usd_op;

enum { PEL_USD_OPS = 64 }; /* of a prim, and in its order: each looks for its name, in each frame */

typedef struct pel_usd_ops {
    pel_usd_op *ops; /* (count) */
    size_t count, capacity;
    const char *order, *order_end; /* the value of xformOpOrder in the text; null = none */
} pel_usd_ops;

void pel_usd_ops_free(pel_usd_ops *ops);
/* Where the prim stands in its parent at a time code; is_reset: in the world instead. PEL_BAD_FORMAT at the order. */
pel_status pel_usd_ops_place(const pel_usd_ops *ops, const pel_text_cursor *scan, double code, pel_place *place,
                             bool *is_reset, pel_error *error);

/* ---- files ---- */

/* All visible meshes as one, in the order of the file, at the first time code, in metres (metersPerUnit); the up axis
   stays, with a note. */
pel_status pel_usd_read(const char *path, const pel_log *log, pel_mesh **mesh, pel_error *error);
pel_status pel_usd_parse(const char *name, const void *bytes, size_t size, const pel_log *log, pel_mesh **mesh,
                         pel_error *error);
/* The vertices of that mesh at each time code of the file. PEL_BAD_FORMAT without samples, or with too many. */
pel_status pel_usd_read_sequence(const char *path, pel_sequence **sequence, pel_error *error);
pel_status pel_usd_parse_sequence(const char *name, const void *bytes, size_t size, pel_sequence **sequence,
                                  pel_error *error);
/* whether a path ends in .usda, or in .usd (text or binary; a binary file is refused with a remedy) */
bool pel_usd_is_path(const char *path);

#endif
