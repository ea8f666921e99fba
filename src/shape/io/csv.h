/* Lines of CSV files, cell by cell: cells in quotes may hold commas, and two quotes for one. */
#ifndef PEL_IO_CSV_H
#define PEL_IO_CSV_H

#include <stdbool.h>
#include <stddef.h>

/* Copies the next cell of the line at *at, which ends with a line break or zero, without its quotes, cut to size - 1
   bytes. *at moves to the next cell, null after the last one. False if *at is null. */
bool pel_csv_next(const char **at, char *cell, size_t size);

#endif
