/* The header of a PLY file: which elements follow, how many, with which properties. */
#ifndef PEL_IO_PLY_HEADER_H
#define PEL_IO_PLY_HEADER_H

#include "io/formats.h"

/* more than any sensible file has; a longer header is refused */
enum { PEL_PLY_ELEMENT_LIMIT = 32, PEL_PLY_PROPERTY_LIMIT = 512 };

typedef enum pel_ply_type {
    PEL_PLY_INT8,
    PEL_PLY_UINT8,
    PEL_PLY_INT16,
    PEL_PLY_UINT16,
    PEL_PLY_INT32,
    PEL_PLY_UINT32,
    PEL_PLY_FLOAT,
    PEL_PLY_DOUBLE,
    PEL_PLY_TYPE_COUNT
} pel_ply_type;

typedef struct pel_ply_property {
    char name[PEL_NAME_SIZE];
    bool is_list;
    pel_ply_type count_type; /* of a list */
    pel_ply_type type;
} pel_ply_property;

typedef struct pel_ply_element {
    char name[PEL_NAME_SIZE];
    int64_t count;
    const char *place; /* of its line in the file */
    int first_property, property_count;
} pel_ply_element;

typedef struct pel_ply_header {
    pel_encoding encoding;
    int element_count, property_count;
    pel_ply_element elements[PEL_PLY_ELEMENT_LIMIT];
    pel_ply_property properties[PEL_PLY_PROPERTY_LIMIT]; /* of all elements, one after the other */
} pel_ply_header;

/* Reads the header and moves to the first byte after it. */
pel_status pel_ply_read_header(pel_text_cursor *scan, pel_ply_header *header, pel_error *error);
/* the element or property of that name, or null */
const pel_ply_element *pel_ply_find_element(const pel_ply_header *header, const char *name);
const pel_ply_property *pel_ply_find_property(const pel_ply_header *header, const pel_ply_element *element,
                                              const char *name);
/* bytes of a binary scalar */
static inline size_t pel_ply_type_size(pel_ply_type type)
{
    static const unsigned char sizes[PEL_PLY_TYPE_COUNT] = {1, 1, 2, 2, 4, 4, 4, 8};
    return sizes[type];
}

#endif
