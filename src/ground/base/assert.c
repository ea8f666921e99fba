#include "base/assert.h"

#include <stdio.h>
#include <stdlib.h>

static _Thread_local int depth;

_Noreturn void pel_assert_fail(const char *condition, const char *file, int line)
{
    fprintf(stderr, "%s:%d: assertion failed: %s\n", file, line, condition);
    abort();
}

void pel_check_begin(void)
{
    depth++;
}

bool pel_check_end(bool is_valid)
{
    depth--;
    return is_valid;
}

bool pel_check_is_running(void)
{
    return depth > 0;
}
