#include "papers/lab/file.h"

#include <pellicle/error.h>

pel_status lab_write_file(const char *path, const char *noun, void (*write)(FILE *file, const void *context),
                          const void *context, pel_error *error)
{
    FILE *file = fopen(path, "w");
    bool opened = file != NULL, whole = false;
    if (opened) {
        write(file, context);
        whole = ferror(file) == 0;
        whole = fclose(file) == 0 && whole;
    }
    if (whole)
        return PEL_OK;
    pel_fail(error, PEL_BAD_FILE, opened ? "the %s could not be written completely" : "cannot write the %s", noun);
    pel_fail_place(error, path, 0, 0);
    return PEL_BAD_FILE;
}

void lab_put_escaped(FILE *file, const char *text)
{
    for (; *text != '\0'; text++) {
        if (*text == '<')
            fputs("&lt;", file);
        else if (*text == '>')
            fputs("&gt;", file);
        else if (*text == '&')
            fputs("&amp;", file);
        else
            fputc(*text, file);
    }
}
