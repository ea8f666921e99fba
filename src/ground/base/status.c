#include "base/status.h"

#include "base/memory.h"
#include "base/patience.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* bytes that a message names */
#define LEAST_BLOCK 1e6
#define LARGEST_BLOCK 1e15

static const char *const status_texts[PEL_STATUS_COUNT] = {
    "ok",       "out of memory", "bad argument", "bad file", "bad format",
    "bad mesh", "bad scene",     "unstable",     "diverged", "stopped",
};

const char *pel_status_text(pel_status status)
{
    return (unsigned)status < PEL_STATUS_COUNT ? status_texts[status] : "unknown status";
}

/* clears the error, which may be null */
static void fill(pel_error *error, pel_status status, const char *what_format, va_list arguments)
{
    if (error == NULL)
        return;
    memset(error, 0, sizeof *error);
    error->status = status;
    error->element = -1;
    error->byte_offset = -1;
    vsnprintf(error->what, sizeof error->what, what_format, arguments);
}

pel_status pel_fail(pel_error *error, pel_status status, const char *what_format, ...)
{
    va_list arguments;
    va_start(arguments, what_format);
    fill(error, status, what_format, arguments);
    va_end(arguments);
    return status;
}

pel_status pel_refuse(pel_error *error, pel_status status, const char *remedy, const char *what_format, ...)
{
    va_list arguments;
    va_start(arguments, what_format);
    fill(error, status, what_format, arguments);
    va_end(arguments);
    pel_fail_remedy(error, "%s", remedy);
    return status;
}

pel_status pel_refuse_element(pel_error *error, pel_status status, const char *kind, int64_t element,
                              const char *remedy, const char *what_format, ...)
{
    va_list arguments;
    va_start(arguments, what_format);
    fill(error, status, what_format, arguments);
    va_end(arguments);
    pel_fail_element(error, kind, element);
    pel_fail_remedy(error, "%s", remedy);
    return status;
}

pel_status pel_fail_memory(pel_error *error)
{
    if (pel_patience_is_lost())
        return pel_fail(error, PEL_STOPPED, "stopped on request");
    const char *remedy = "use a smaller mesh or free some memory";
    const double needed = (double)pel_memory_refused(), most = pel_memory_limit();
    /* sizes that overflow say nothing, and small ones that all is taken */
    if (!(most < (double)HUGE_VAL) || !(needed < LARGEST_BLOCK))
        return pel_refuse(error, PEL_OUT_OF_MEMORY, remedy, "out of memory");
    if (needed < LEAST_BLOCK)
        return pel_refuse(error, PEL_OUT_OF_MEMORY, remedy, "out of memory: %.3g GB are not enough", 1e-9 * most);
    return pel_refuse(error, PEL_OUT_OF_MEMORY, remedy,
                      "out of memory: %.3g GB more were needed at once, of %.3g GB in all", 1e-9 * needed, 1e-9 * most);
}

void pel_fail_remedy(pel_error *error, const char *format, ...)
{
    if (error == NULL)
        return;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(error->remedy, sizeof error->remedy, format, arguments);
    va_end(arguments);
}

void pel_fail_element(pel_error *error, const char *kind, int64_t element)
{
    if (error == NULL)
        return;
    snprintf(error->element_kind, sizeof error->element_kind, "%s", kind);
    error->element = element;
}

void pel_fail_place(pel_error *error, const char *file, int32_t line, int32_t column)
{
    if (error == NULL || file == NULL)
        return;
    snprintf(error->file, sizeof error->file, "%s", file);
    error->line = line;
    error->column = column;
}

void pel_fail_offset(pel_error *error, const char *file, int64_t byte_offset)
{
    pel_fail_place(error, file, 0, 0);
    if (error != NULL)
        error->byte_offset = byte_offset;
}

/* appends to text at *length, never past size */
PEL_PRINTF(4, 5)
static void append(char *text, size_t size, size_t *length, const char *format, ...)
{
    if (*length >= size)
        return;
    va_list arguments;
    va_start(arguments, format);
    int written = vsnprintf(text + *length, size - *length, format, arguments);
    va_end(arguments);
    if (written > 0)
        *length += (size_t)written;
}

const char *pel_error_text(const pel_error *error, char *text, size_t size)
{
    if (text == NULL || size == 0)
        return "";
    size_t length = 0;
    text[0] = '\0';
    if (error == NULL)
        return text;
    if (error->file[0] != '\0')
        append(text, size, &length, "%s:", error->file);
    if (error->line > 0)
        append(text, size, &length, "%d:", (int)error->line);
    if (error->column > 0)
        append(text, size, &length, "%d:", (int)error->column);
    if (error->byte_offset >= 0)
        append(text, size, &length, "byte %lld:", (long long)error->byte_offset);
    append(text, size, &length, "%serror: ", length > 0 ? " " : "");
    if (error->element_name[0] != '\0') {
        char element[sizeof error->element_kind + sizeof error->element_name + 4];
        int named = snprintf(element, sizeof element, "%s '%s'", error->element_kind, error->element_name);
        if (strncmp(error->what, element, (size_t)named) != 0)
            append(text, size, &length, "%s: ", element);
    } else if (error->element >= 0)
        append(text, size, &length, "%s %lld: ", error->element_kind, (long long)error->element);
    append(text, size, &length, "%s", error->what);
    if (error->remedy[0] != '\0')
        append(text, size, &length, ". %s", error->remedy);
    return text;
}

void pel_log_line(const pel_log *log, const char *format, ...)
{
    if (log == NULL || log->write == NULL)
        return;
    char text[512];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    log->write(log->user, text);
}
