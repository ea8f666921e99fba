#include "commands.h"
#include "common.h"

int cli_convert(const cli_call *call)
{
    bool quiet = cli_has(call, "quiet");
    const pel_log *log = quiet ? NULL : &cli_notes;
    int status;
    pel_mesh *mesh = cli_read_mesh(call->arguments[0], log, NULL, &status);
    if (mesh != NULL)
        status = cli_write_mesh(call, call->arguments[1], mesh, log, quiet);
    pel_mesh_destroy(mesh);
    return status;
}
