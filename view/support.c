#include "view/support.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

pel_status view_fail(pel_error *error, pel_status status, const char *file, const char *format, ...)
{
    if (error == NULL)
        return status;
    *error = (pel_error){.status = status, .byte_offset = -1, .element = -1};
    if (file != NULL)
        snprintf(error->file, sizeof error->file, "%s", file);
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(error->what, sizeof error->what, format, arguments);
    va_end(arguments);
    return status;
}

pel_status view_fail_memory(pel_error *error)
{
    view_fail(error, PEL_OUT_OF_MEMORY, NULL, "out of memory");
    view_remedy(error, "draw a smaller picture or close other programs");
    return PEL_OUT_OF_MEMORY;
}

void view_remedy(pel_error *error, const char *format, ...)
{
    if (error == NULL)
        return;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(error->remedy, sizeof error->remedy, format, arguments);
    va_end(arguments);
}

void view_note(const pel_log *log, const char *format, ...)
{
    if (log == NULL || log->write == NULL)
        return;
    char line[1024];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(line, sizeof line, format, arguments);
    va_end(arguments);
    log->write(log->user, line);
}

void *view_allocate(size_t count, size_t size)
{
    return calloc(count > 0 ? count : 1, size);
}

bool view_ends_with(const char *text, const char *ending)
{
    size_t length = strlen(text), size = strlen(ending);
    return length > size && strcmp(text + length - size, ending) == 0;
}

double view_clock(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}
