#include "commands.h"
#include "diagnostics.h"

#include <pellicle/export.h>

#include <string.h>

enum { FORMAT_GLB = PEL_FORMAT_COUNT, FORMAT_PC2, FORMAT_USD };

/* the formats of meshes, then these three */
const char *cli_export_names(int index)
{
    int mesh_format_count = 0;
    while (cli_format_names(mesh_format_count) != NULL)
        ++mesh_format_count;
    if (index < mesh_format_count)
        return cli_format_names(index);
    static const char *const more[] = {"glb", "pc2", "usda", NULL};
    return more[index - mesh_format_count];
}

static bool ends_with(const char *text, const char *ending)
{
    size_t length = strlen(text), size = strlen(ending);
    return length > size && strcmp(text + length - size, ending) == 0;
}

/* format by --format or the file's extension: FORMAT_GLB, FORMAT_PC2, FORMAT_USD, a pel_mesh_format, or -1 after an
   error message */
static int output_format(const cli_call *call, const char *out)
{
    const char *name = cli_value(call, "format");
    if (name != NULL ? strcmp(name, "glb") == 0 : ends_with(out, ".glb"))
        return FORMAT_GLB;
    if (name != NULL ? strcmp(name, "pc2") == 0 : ends_with(out, ".pc2"))
        return FORMAT_PC2;
    if (name != NULL ? strcmp(name, "usda") == 0 : ends_with(out, ".usda"))
        return FORMAT_USD;
    pel_mesh_format format = pel_mesh_format_of_path(out);
    if (name == NULL && format == PEL_FORMAT_AUTO) {
        cli_complain(
            "'%s' is not a format that can be written. end the name in .obj, .ply, .stl, .off, .vtp, .glb, .usda or, "
            "for a run, .pc2",
            out);
        return -1;
    }
    return cli_output_format(call, out, &format) ? (int)format : -1;
}

static pel_status export_frames(const pel_frames *frames, const char *out, int format, const pel_log *log,
                                pel_error *error)
{
    if (format == FORMAT_GLB)
        return pel_export_glb(out, frames, error);
    if (format == FORMAT_PC2)
        return pel_export_pc2(out, frames, error);
    if (format == FORMAT_USD)
        return pel_export_usd(out, frames, error);
    return pel_export_sequence(out, (pel_mesh_format)format, frames, log, error);
}

static int export_run(const char *folder, const char *out, int format, bool quiet)
{
    pel_frames *frames;
    pel_error error;
    char first[PEL_EXPORT_PATH_SIZE], last[PEL_EXPORT_PATH_SIZE];
    pel_status status = pel_frames_open(folder, &frames, &error);
    if (status == PEL_OK)
        status = export_frames(frames, out, format, quiet ? NULL : &cli_notes, &error);
    if (status == PEL_OK && !quiet && format < FORMAT_GLB)
        printf("%s to %s\n", pel_export_numbered_path(first, out, 0),
               pel_export_numbered_path(last, out, frames->frame_count - 1));
    else if (status == PEL_OK && !quiet)
        printf("%s: %d frames\n", out, (int)frames->frame_count);
    pel_frames_close(frames);
    return status == PEL_OK ? CLI_DONE : cli_report(&error);
}

/* as .glb or .usda */
static int write_scene(const char *path, int format, const pel_mesh *mesh, bool quiet)
{
    pel_error error;
    if ((format == FORMAT_GLB ? pel_export_glb_mesh : pel_export_usd_mesh)(path, mesh, &error) != PEL_OK)
        return cli_report(&error);
    if (!quiet)
        printf("%s: %d vertices, %d triangles\n", path, (int)mesh->vertex_count, (int)mesh->triangle_count);
    return CLI_DONE;
}

int cli_convert(const cli_call *call)
{
    const char *in = call->arguments[0], *out = call->arguments[1];
    int format = output_format(call, out);
    if (format < 0)
        return CLI_BAD_INPUT;
    bool quiet = cli_has(call, "quiet");
    if (cli_is_folder(in))
        return export_run(in, out, format, quiet);
    if (format == FORMAT_PC2)
        return cli_complain("a point cache holds the frames of a run and '%s' is not a folder. name a run's folder",
                            in);
    const pel_log *log = quiet ? NULL : &cli_notes;
    int status;
    pel_mesh *mesh = cli_read_mesh(in, log, NULL, &status);
    if (mesh != NULL)
        status = format >= FORMAT_GLB ? write_scene(out, format, mesh, quiet)
                                      : cli_write_mesh(out, (pel_mesh_format)format, mesh, log, quiet);
    pel_mesh_destroy(mesh);
    return status;
}
