/* Decimal text to double and back: exact, fast, and the same in every locale. */
#ifndef PEL_BASE_NUMBER_H
#define PEL_BASE_NUMBER_H

#include <stddef.h>

/* Reads the number at `at` (sign, digits, point, exponent; or nan, inf, infinity in any case) and never looks at or
   past `end`. Returns the first character after it, null if there is no number. The value has the bits of strtod in the
   C locale; numbers too large give infinity. */
const char *pel_number_parse(const char *at, const char *end, double *value);

/* room for any number that pel_number_print writes, terminating zero included */
#define PEL_NUMBER_SIZE 32

/* Writes the shortest of 15, 16 or 17 significant digits that reads back to the same bits. Returns the length. */
size_t pel_number_print(char text[PEL_NUMBER_SIZE], double value);

#endif
