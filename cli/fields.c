#include "commands.h"
#include "diagnostics.h"

#include <pellicle/run.h>

#include <stdlib.h>
#include <string.h>

enum { MOST_FIELDS = 64 };

int cli_fields(const cli_call *call)
{
    const char *names[MOST_FIELDS], *list = cli_value(call, "add");
    char *text = list != NULL ? strdup(list) : NULL;
    int32_t count = 0;
    pel_error error;
    for (char *rest = text, *name; rest != NULL && (name = strtok_r(rest, ",", &rest)) != NULL && count < MOST_FIELDS;)
        names[count++] = name;
    int status = CLI_DONE;
    if (count == 0)
        status = cli_complain("no field is named. add --add von_mises_top, for example");
    else if (pel_run_add_fields(call->arguments[0], names, count, &error) != PEL_OK)
        status = cli_report(&error);
    else if (!cli_has(call, "quiet"))
        printf("%s: %d field%s added to all frames\n", call->arguments[0], (int)count, count == 1 ? "" : "s");
    free(text);
    return status;
}
