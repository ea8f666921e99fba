#ifndef PEL_MACOS_CRT_EXTERNS_H
#define PEL_MACOS_CRT_EXTERNS_H
char ***_NSGetEnviron(void);
#endif
