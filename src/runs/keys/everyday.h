/* What people write who know other programs, and what it is called here. */
#ifndef PEL_SCENE_EVERYDAY_H
#define PEL_SCENE_EVERYDAY_H

#include <stddef.h>

/* The remedy for a word, by the words (count) that are known in its place; null if there is none. */
const char *pel_everyday_word(const char *text, const char *const *known, size_t count);

/* The key that another name stands for, if possible one of those (count) that are known in its place; null if there is
   none. */
const char *pel_everyday_key(const char *name, const char *const *known, size_t count);

/* How to get what a name that is no key asks for, such as a floor; null if there is none. */
const char *pel_everyday_thing(const char *name);

#endif
