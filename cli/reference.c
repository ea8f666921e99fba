/* Texts that the scene's table of parameters yields. */
#include "commands.h"
#include "diagnostics.h"

#include <pellicle/scene.h>

static int print_text(pel_status (*write)(FILE *file, pel_error *error))
{
    pel_error error;
    if (write(stdout, &error) == PEL_OK)
        return CLI_DONE;
    cli_report(&error);
    return CLI_FAILED;
}

int cli_reference(const cli_call *call)
{
    (void)call;
    return print_text(pel_scene_write_reference);
}

int cli_schema(const cli_call *call)
{
    (void)call;
    return print_text(pel_scene_write_schema);
}

void cli_print_scene_keys(FILE *file)
{
    /* completion without scene keys is better than none */
    (void)pel_scene_write_parameters(file, NULL);
}
