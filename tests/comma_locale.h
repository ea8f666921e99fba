/* A locale in which numbers have a decimal comma: input and output must not change. */
#ifndef PEL_TESTS_COMMA_LOCALE_H
#define PEL_TESTS_COMMA_LOCALE_H

#include "check.h"
#include "source_dir.h"

#include <locale.h>
#include <stdbool.h>
#include <stdlib.h>

/* sets such a locale, built here when none is installed; false when that is impossible. End with setlocale(..., "C").
 */
static inline bool set_comma_locale(void)
{
    static const char *const names[] = {"de_DE.UTF-8", "fr_FR.UTF-8", "de_DE", "fr_FR"};
    /* not in the folder from which the test is started; UTF-8 takes 1 s */
    const char *build =
        "cd " PEL_TESTS_DIR " && localedef -i de_DE -f ISO-8859-1 ./de_DE.ISO-8859-1 >localedef.log 2>&1";
    char comma[8];
    bool set = false;
    for (size_t i = 0; !set && i < sizeof names / sizeof *names; i++)
        set = setlocale(LC_NUMERIC, names[i]) != NULL;
    set = set || (system(build) == 0 && setenv("LOCPATH", PEL_TESTS_DIR, 1) == 0 &&
                  setlocale(LC_NUMERIC, "de_DE.ISO-8859-1") != NULL);
    snprintf(comma, sizeof comma, "%.1f", 0.5);
    assert_true(!set || strcmp(comma, "0,5") == 0);
    return set;
}

#endif
