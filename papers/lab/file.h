#ifndef PAPERS_LAB_FILE_H
#define PAPERS_LAB_FILE_H

#include <pellicle/base.h>

#include <stdio.h>

/* Writes the file at path by write(file, context). PEL_BAD_FILE, with the path, when not all of it could be written;
   noun names its content. */
pel_status lab_write_file(const char *path, const char *noun, void (*write)(FILE *file, const void *context),
                          const void *context, pel_error *error);

/* text escaped for HTML and SVG */
void lab_put_escaped(FILE *file, const char *text);

#endif
