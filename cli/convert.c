#include "commands.h"
#include "common.h"

int cli_convert(const cli_call *call)
{
    const char *out = call->arguments[1];
    pel_mesh_format format;
    if (!cli_output_format(call, out, &format))
        return CLI_BAD_INPUT;
    bool quiet = cli_has(call, "quiet");
    const pel_log *log = quiet ? NULL : &cli_notes;
    int status;
    pel_mesh *mesh = cli_read_mesh(call->arguments[0], log, NULL, &status);
    if (mesh != NULL)
        status = cli_write_mesh(out, format, mesh, log, quiet);
    pel_mesh_destroy(mesh);
    return status;
}
