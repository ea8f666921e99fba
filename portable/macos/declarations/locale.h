#ifndef PEL_MACOS_LOCALE_H
#define PEL_MACOS_LOCALE_H
#define LC_ALL 0
#define LC_NUMERIC 4
struct lconv {
    char *decimal_point, *thousands_sep, *grouping;
};
struct lconv *localeconv(void);
char *setlocale(int category, const char *name);
#endif
