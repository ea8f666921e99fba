#include "view/support.h"

#include <stdlib.h>
#include <string.h>

void *view_allocate(size_t count, size_t size)
{
    return calloc(count > 0 ? count : 1, size);
}

bool view_ends_with(const char *text, const char *ending)
{
    size_t length = strlen(text), size = strlen(ending);
    return length > size && strcmp(text + length - size, ending) == 0;
}
