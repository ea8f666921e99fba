#include "io/ply_header.h"

#include <stdio.h>
#include <string.h>

/* the two names of each type */
static const char *const type_names[PEL_PLY_TYPE_COUNT][3] = {
    {"char", "int8", NULL}, {"uchar", "uint8", NULL}, {"short", "int16", NULL},   {"ushort", "uint16", NULL},
    {"int", "int32", NULL}, {"uint", "uint32", NULL}, {"float", "float32", NULL}, {"double", "float64", NULL},
};

const pel_ply_element *pel_ply_find_element(const pel_ply_header *header, const char *name)
{
    for (int i = 0; i < header->element_count; i++)
        if (strcmp(header->elements[i].name, name) == 0)
            return &header->elements[i];
    return NULL;
}

const pel_ply_property *pel_ply_find_property(const pel_ply_header *header, const pel_ply_element *element,
                                              const char *name)
{
    const pel_ply_property *properties = header->properties + element->first_property;
    for (int i = 0; i < element->property_count; i++)
        if (strcmp(properties[i].name, name) == 0)
            return &properties[i];
    return NULL;
}

bool pel_ply_matches(const pel_text_cursor *scan)
{
    return scan->end - scan->at > 3 && memcmp(scan->at, "ply", 3) == 0 && pel_is_space(scan->at[3]);
}

/* a name that must fit, of printable characters */
static pel_status read_name(pel_text_cursor *scan, char name[PEL_NAME_SIZE], pel_error *error)
{
    size_t length;
    const char *word = pel_text_cursor_word(scan, &length);
    if (length == 0)
        return pel_text_cursor_fail_number(scan, error, "a name");
    if (length >= PEL_NAME_SIZE || memchr(word, '\0', length) != NULL)
        return pel_text_cursor_fail(scan, word, error, "shorten the name",
                                    "a name is longer than %d characters or holds a zero byte", PEL_NAME_SIZE - 1);
    memcpy(name, word, length);
    name[length] = '\0';
    return PEL_OK;
}

static pel_status read_type(pel_text_cursor *scan, pel_ply_type *type, pel_error *error)
{
    size_t length;
    const char *word = pel_text_cursor_word(scan, &length);
    for (int i = 0; i < PEL_PLY_TYPE_COUNT; i++) {
        if (pel_word_is_one_of(word, length, type_names[i])) {
            *type = (pel_ply_type)i;
            return PEL_OK;
        }
    }
    scan->at = word;
    return pel_text_cursor_fail_number(scan, error, "a type (char, uchar, short, ushort, int, uint, float or double)");
}

static pel_status read_format(pel_text_cursor *scan, pel_ply_header *header, pel_error *error)
{
    pel_text_cursor_skip_blanks(scan);
    const char *place = scan->at;
    if (pel_text_cursor_accept(scan, "ascii"))
        header->encoding = PEL_ENCODING_ASCII;
    else if (pel_text_cursor_accept(scan, "binary_little_endian"))
        header->encoding = PEL_ENCODING_LITTLE;
    else if (pel_text_cursor_accept(scan, "binary_big_endian"))
        header->encoding = PEL_ENCODING_BIG;
    else
        return pel_text_cursor_fail_number(scan, error, "a format (ascii, binary_little_endian or binary_big_endian)");
    pel_text_cursor_skip_blanks(scan);
    if (!pel_text_cursor_accept(scan, "1.0"))
        return pel_text_cursor_fail(scan, place, error, "export it as PLY 1.0", "the PLY version is not 1.0");
    return PEL_OK;
}

static pel_status read_element(pel_text_cursor *scan, pel_ply_header *header, pel_error *error)
{
    pel_text_cursor_skip_blanks(scan);
    pel_ply_element element = {.place = scan->at, .first_property = header->property_count};
    if (header->element_count == PEL_PLY_ELEMENT_LIMIT)
        return pel_text_cursor_fail(scan, scan->at, error, "remove elements", "more than %d elements",
                                    (int)PEL_PLY_ELEMENT_LIMIT);
    pel_status status = read_name(scan, element.name, error);
    if (status != PEL_OK)
        return status;
    if (pel_ply_find_element(header, element.name) != NULL)
        return pel_text_cursor_fail(scan, element.place, error, "rename one of them", "element '%s' stands twice",
                                    element.name);
    pel_text_cursor_skip_blanks(scan);
    const char *place = scan->at;
    if (!pel_text_cursor_integer(scan, &element.count) || !pel_text_cursor_at_break(scan) || element.count < 0) {
        scan->at = place;
        return pel_text_cursor_fail_number(scan, error, "a number of elements");
    }
    header->elements[header->element_count++] = element;
    return PEL_OK;
}

static pel_status read_property(pel_text_cursor *scan, pel_ply_header *header, pel_error *error)
{
    pel_text_cursor_skip_blanks(scan);
    const char *place = scan->at;
    if (header->element_count == 0)
        return pel_text_cursor_fail(scan, place, error, "move it behind the line of its element",
                                    "a property stands before any element");
    if (header->property_count == PEL_PLY_PROPERTY_LIMIT)
        return pel_text_cursor_fail(scan, place, error, "remove properties", "more than %d properties",
                                    (int)PEL_PLY_PROPERTY_LIMIT);
    pel_ply_element *element = &header->elements[header->element_count - 1];
    pel_ply_property property = {.is_list = false};
    pel_status status = PEL_OK;
    if (pel_text_cursor_accept(scan, "list")) {
        property.is_list = true;
        status = read_type(scan, &property.count_type, error);
    }
    if (status == PEL_OK)
        status = read_type(scan, &property.type, error);
    if (status == PEL_OK)
        status = read_name(scan, property.name, error);
    if (status != PEL_OK)
        return status;
    if (pel_ply_find_property(header, element, property.name) != NULL)
        return pel_text_cursor_fail(scan, place, error, "rename one of them", "property '%s' stands twice",
                                    property.name);
    header->properties[header->property_count++] = property;
    element->property_count++;
    return PEL_OK;
}

/* one line between "ply" and "end_header" */
static pel_status read_line(pel_text_cursor *scan, pel_ply_header *header, bool *has_format, pel_error *error)
{
    if (pel_text_cursor_accept(scan, "comment") || pel_text_cursor_accept(scan, "obj_info")) {
        pel_text_cursor_skip_line(scan);
        return PEL_OK;
    }
    pel_status status;
    if (pel_text_cursor_accept(scan, "format")) {
        *has_format = true;
        status = read_format(scan, header, error);
    } else if (pel_text_cursor_accept(scan, "element")) {
        status = read_element(scan, header, error);
    } else if (pel_text_cursor_accept(scan, "property")) {
        status = read_property(scan, header, error);
    } else {
        return pel_text_cursor_fail_number(scan, error, "a line of a PLY header");
    }
    pel_text_cursor_skip_blanks(scan);
    if (status == PEL_OK && scan->at < scan->end && !pel_is_line_end(*scan->at))
        status = pel_text_cursor_fail_number(scan, error, "the end of the line");
    return status;
}

/* Skips the line end of "end_header". Data may begin with \n, so the first line decides whether lines end with \r
   alone. */
static pel_status skip_last_line_end(pel_text_cursor *scan, bool pairs, pel_error *error)
{
    pel_text_cursor_skip_blanks(scan);
    if (scan->at < scan->end && *scan->at == '\r') {
        scan->at++;
        if (!pairs)
            return PEL_OK;
    }
    if (scan->at == scan->end || *scan->at != '\n')
        return pel_text_cursor_fail_number(scan, error, "the end of the line");
    scan->at++;
    return PEL_OK;
}

pel_status pel_ply_read_header(pel_text_cursor *scan, pel_ply_header *header, pel_error *error)
{
    bool has_format = false;
    if (!pel_ply_matches(scan))
        return pel_text_cursor_fail(scan, scan->begin, error, "begin the file with a line 'ply'",
                                    "the file does not begin with 'ply'");
    scan->at += 3;
    const bool pairs = scan->end - scan->at >= 2 && scan->at[0] == '\r' && scan->at[1] == '\n';
    for (pel_text_cursor_skip_spaces(scan); !pel_text_cursor_accept(scan, "end_header");
         pel_text_cursor_skip_spaces(scan)) {
        if (scan->at == scan->end)
            return pel_text_cursor_fail_number(scan, error, "'end_header'");
        pel_status status = read_line(scan, header, &has_format, error);
        if (status != PEL_OK)
            return status;
    }
    if (!has_format)
        return pel_text_cursor_fail(scan, scan->begin, error, "add a line such as 'format ascii 1.0'",
                                    "the header has no format line");
    return skip_last_line_end(scan, pairs, error);
}
