/* alloca is in malloc.h */
#include <malloc.h>
