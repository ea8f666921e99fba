/* A locale in which numbers have a decimal comma: input and output must not change. */
#ifndef PEL_TESTS_COMMA_LOCALE_H
#define PEL_TESTS_COMMA_LOCALE_H

#include "check.h"

#include <locale.h>
#include <stdbool.h>
#include <stdlib.h>

/* sets such a locale, built here when none is installed; false when that is impossible. End with setlocale(..., "C").
 */
static inline bool set_comma_locale(void)
{
    static const char *const names[] = {"de_DE.UTF-8", "fr_FR.UTF-8", "de_DE", "fr_FR"};
    char comma[8];
    bool set = false;
    for (size_t i = 0; !set && i < sizeof names / sizeof *names; i++)
        set = setlocale(LC_NUMERIC, names[i]) != NULL;
    set = set || (system("localedef -i de_DE -f UTF-8 ./de_DE.UTF-8 >localedef.log 2>&1") == 0 &&
                  setenv("LOCPATH", ".", 1) == 0 && setlocale(LC_NUMERIC, "de_DE.UTF-8") != NULL);
    snprintf(comma, sizeof comma, "%.1f", 0.5);
    assert_true(!set || strcmp(comma, "0,5") == 0);
    return set;
}

#endif
