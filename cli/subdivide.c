#include "commands.h"
#include "diagnostics.h"

#include <pellicle/subdivide.h>

int cli_subdivide(const cli_call *call)
{
    const char *path = call->arguments[0], *out = cli_value(call, "output");
    pel_mesh_format format;
    if (!cli_has(call, "levels"))
        return cli_complain("'pellicle subdivide' needs the number of levels. add '-n 1'");
    if (out == NULL)
        return cli_complain("'pellicle subdivide' needs a file to write. add '-o fine.ply'");
    if (!cli_output_format(call, out, &format))
        return CLI_BAD_INPUT;
    bool quiet = cli_has(call, "quiet");
    const pel_log *log = quiet ? NULL : &cli_notes;
    int status;
    pel_mesh *mesh = cli_read_mesh(path, log, NULL, &status), *fine = NULL;
    if (mesh == NULL)
        return status;
    pel_subdivide_def def = pel_subdivide_def_default();
    def.levels = cli_count(call, "levels");
    def.clamp_fields = !cli_has(call, "no-clamp");
    pel_error error;
    if (pel_mesh_subdivide_with(mesh, &def, &fine, &error) == PEL_OK) {
        status = cli_write_mesh(out, format, fine, log, quiet);
    } else {
        cli_name_file(&error, path);
        status = cli_report(&error);
    }
    pel_mesh_destroy(fine);
    pel_mesh_destroy(mesh);
    return status;
}
