/* Lines of CSV files, cell by cell: cells in quotes may hold commas, and two quotes for one. */
#ifndef PEL_IO_CSV_H
#define PEL_IO_CSV_H

#include <stdbool.h>
#include <stddef.h>

/* Copies the next cell of the line at *at, which ends with a line break or zero, without its quotes; what is longer
   than size - 1 bytes is cut. *at goes to the next cell, null after the last one. False when *at is null. */
bool pel_csv_next(const char **at, char *cell, size_t size);

#endif
