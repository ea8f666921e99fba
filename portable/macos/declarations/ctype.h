#ifndef PEL_MACOS_CTYPE_H
#define PEL_MACOS_CTYPE_H
int isalnum(int letter);
int isalpha(int letter);
int isdigit(int letter);
int islower(int letter);
int isprint(int letter);
int ispunct(int letter);
int isspace(int letter);
int isupper(int letter);
int isxdigit(int letter);
int tolower(int letter);
int toupper(int letter);
#endif
