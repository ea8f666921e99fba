/* The little of XML that VTK files need: tags with attributes, one after the other, and escaped text. */
#ifndef PEL_IO_XML_H
#define PEL_IO_XML_H

#include "io/file.h"

#include <stdbool.h>
#include <stddef.h>

/* writes text with the five special characters escaped and control characters as question marks */
void pel_xml_write_escaped(pel_file_writer *writer, const char *text);

/* The text between < and >, such as `Piece NumberOfPoints="3"` or `/Piece`. */
typedef struct pel_xml_tag {
    const char *start, *end;
} pel_xml_tag;

/* The first tag that begins in at..end; moves *at after it. False if no complete tag is left. */
bool pel_xml_next(const char **at, const char *end, pel_xml_tag *tag);

/* the tag's name, slash of an end tag included, is `name` */
bool pel_xml_is(const pel_xml_tag *tag, const char *name);

/* Copies the value of an attribute, unescaped, to text (size bytes, terminated). False when the tag does not have it or
   it does not fit; text is empty then. */
bool pel_xml_attribute(const pel_xml_tag *tag, const char *name, char *text, size_t size);

/* The same for a number of at most 18 decimal digits, between blanks or not. */
bool pel_xml_count(const pel_xml_tag *tag, const char *name, int64_t *count);

#endif
