#include "pellicle/mesh_io.h"

#include "base/memory.h"
#include "base/number.h"
#include "io/formats.h"
#include "pellicle/results.h"

#include <math.h>
#include <string.h>

static bool has_extension(const char *path, const char *extension)
{
    const char *dot = strrchr(path, '.');
    if (dot == NULL)
        return false;
    pel_text_cursor ahead = {.at = dot + 1, .end = dot + strlen(dot)};
    return pel_text_cursor_accept(&ahead, extension) && ahead.at == ahead.end;
}

pel_mesh_format pel_mesh_format_of_path(const char *path)
{
    if (path == NULL)
        return PEL_FORMAT_AUTO;
    static const struct {
        const char *extension;
        pel_mesh_format format;
    } formats[] = {{"obj", PEL_FORMAT_OBJ},
                   {"ply", PEL_FORMAT_PLY},
                   {"stl", PEL_FORMAT_STL},
                   {"off", PEL_FORMAT_OFF},
                   {"vtp", PEL_FORMAT_VTP}};
    for (size_t i = 0; i < sizeof formats / sizeof *formats; i++)
        if (has_extension(path, formats[i].extension))
            return formats[i].format;
    return PEL_FORMAT_AUTO;
}

/* headers that cannot be mistaken first, then the extension, then the look of the first words */
static pel_mesh_format detect_format(const pel_text_cursor *scan)
{
    if (pel_ply_matches(scan))
        return PEL_FORMAT_PLY;
    if (pel_stl_size_fits(scan))
        return PEL_FORMAT_STL;
    if (pel_off_matches(scan))
        return PEL_FORMAT_OFF;
    if (pel_vtp_matches(scan))
        return PEL_FORMAT_VTP;
    pel_mesh_format by_name = pel_mesh_format_of_path(scan->name);
    if (by_name != PEL_FORMAT_AUTO)
        return by_name;
    if (pel_stl_matches(scan))
        return PEL_FORMAT_STL;
    return pel_obj_matches(scan) ? PEL_FORMAT_OBJ : PEL_FORMAT_AUTO;
}

static void skip_byte_order_mark(pel_text_cursor *scan)
{
    if (scan->end - scan->at >= 3 && memcmp(scan->at, "\xef\xbb\xbf", 3) == 0)
        scan->at += 3;
}

/* text of two bytes a letter: with a byte order mark, or letters of ASCII */
static bool is_wide_text(const pel_text_cursor *scan)
{
    const unsigned char *b = (const unsigned char *)scan->begin;
    if (scan->end - scan->begin < 4 || pel_stl_size_fits(scan))
        return false;
    bool marked = (b[0] == 0xff && b[1] == 0xfe) || (b[0] == 0xfe && b[1] == 0xff);
    bool low = b[1] == 0 && b[3] == 0 && b[0] >= '\t' && b[0] < 0x7f && b[2] >= '\t' && b[2] < 0x7f;
    bool high = b[0] == 0 && b[2] == 0 && b[1] >= '\t' && b[1] < 0x7f && b[3] >= '\t' && b[3] < 0x7f;
    return marked || low || high;
}

/* files that people take for meshes, or from which a program makes one */
static const struct {
    const char *extension, *what, *remedy;
} strangers[] = {
    {"blend", "a .blend file holds a whole session of Blender", "export OBJ or PLY (File, Export) in Blender"},
    {"step", "STEP holds solids without triangles", "export STL from the CAD program"},
    {"stp", "STEP holds solids without triangles", "export STL from the CAD program"},
    {"iges", "IGES holds surfaces without triangles", "export STL from the CAD program"},
    {"igs", "IGES holds surfaces without triangles", "export STL from the CAD program"},
    {"vtk", "legacy VTK files hold no surface", "save the surface as .vtp or .ply in ParaView (Extract Surface)"},
    {"vtu", "the file holds a volume", "use it as the mesh of a body with `volume`, or save its surface as .vtp"},
    {"msh", "the file holds a volume", "use it as the mesh of a body with `volume`, or save its surface as STL"},
    {"yaml", "the file is a scene", "run it with pellicle run, and name a mesh or a folder of results here"},
    {"yml", "the file is a scene", "run it with pellicle run, and name a mesh or a folder of results here"},
};

static pel_status fail_file(const char *name, const char *what, const char *remedy, pel_error *error)
{
    pel_fail(error, PEL_BAD_FORMAT, "%s", what);
    pel_fail_remedy(error, "%s", remedy);
    pel_fail_place(error, name, 0, 0);
    return PEL_BAD_FORMAT;
}

static pel_status fail_unknown(const char *name, pel_error *error)
{
    for (size_t i = 0; i < sizeof strangers / sizeof *strangers; i++)
        if (has_extension(name, strangers[i].extension))
            return fail_file(name, strangers[i].what, strangers[i].remedy, error);
    return fail_file(name, "neither the extension nor the content tells the format of this file",
                     "give it the extension .obj, .ply, .stl, .off or .vtp, or convert it to one of these", error);
}

pel_status pel_mesh_parse(const char *name, const void *bytes, size_t size, pel_mesh_format format, const pel_log *log,
                          pel_mesh **mesh, pel_error *error)
{
    PEL_REFUSE_NULL(name, error);
    PEL_REFUSE_NULL(bytes, error);
    PEL_REFUSE_NULL(mesh, error);
    *mesh = NULL;
    if (size == 0)
        return fail_file(name, "the file is empty", "copy or export it again", error);
    pel_text_cursor scan = {.name = name, .begin = bytes, .at = bytes, .end = (const char *)bytes + size};
    if (is_wide_text(&scan))
        return fail_file(name, "the file is UTF-16 text, which mesh files are not",
                         "save it as UTF-8 or ASCII, for example: iconv -f UTF-16 -t UTF-8 FILE > NEW", error);
    skip_byte_order_mark(&scan);
    switch (format == PEL_FORMAT_AUTO ? detect_format(&scan) : format) {
    case PEL_FORMAT_OBJ:
        return pel_obj_read(&scan, log, mesh, error);
    case PEL_FORMAT_PLY:
    case PEL_FORMAT_PLY_ASCII:
    case PEL_FORMAT_PLY_BIG:
        return pel_ply_read(&scan, log, mesh, error);
    case PEL_FORMAT_STL:
    case PEL_FORMAT_STL_ASCII:
        return pel_stl_read(&scan, log, mesh, error);
    case PEL_FORMAT_OFF:
        return pel_off_read(&scan, log, mesh, error);
    case PEL_FORMAT_VTP:
        return pel_vtp_read_mesh(&scan, log, mesh, error);
    default:
        return fail_unknown(name, error);
    }
}

pel_status pel_mesh_read(const char *path, pel_mesh_format format, const pel_log *log, pel_mesh **mesh,
                         pel_error *error)
{
    PEL_REFUSE_NULL(path, error);
    PEL_REFUSE_NULL(mesh, error);
    char *bytes;
    size_t size;
    *mesh = NULL;
    pel_status status = pel_file_read(path, &bytes, &size, error);
    if (status != PEL_OK)
        return status;
    status = pel_mesh_parse(path, bytes, size, format, log, mesh, error);
    pel_free(bytes);
    return status;
}

void pel_write_numbers(pel_file_writer *writer, const char *before, const double values[3])
{
    char text[3 * (PEL_NUMBER_SIZE + 1)];
    size_t length = 0;
    for (int i = 0; i < 3; i++) {
        length += pel_number_print(text + length, values[i]);
        text[length++] = i < 2 ? ' ' : '\n';
    }
    pel_file_writer_write(writer, before, strlen(before));
    pel_file_writer_write(writer, text, length);
}

static bool holds_fields(pel_mesh_format format)
{
    return format == PEL_FORMAT_VTP || format == PEL_FORMAT_PLY || format == PEL_FORMAT_PLY_ASCII ||
           format == PEL_FORMAT_PLY_BIG;
}

static pel_status check_values(const double *values, int32_t vertex_count, int32_t component_count, const char *name,
                               pel_error *error)
{
    const size_t width = (size_t)component_count;
    for (size_t i = 0; i < (size_t)vertex_count * width; i++) {
        if (isfinite(values[i]))
            continue;
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "vertex", (int64_t)(i / width), "write finite values only",
                                  "a value of '%s' is %g, which no mesh file can hold", name, values[i]);
    }
    return PEL_OK;
}

/* a mesh that was changed after its creation may hold anything */
static pel_status check_mesh(const pel_mesh *mesh, pel_mesh_format format, pel_error *error)
{
    pel_status status = check_values(mesh->positions[0], mesh->vertex_count, 3, "positions", error);
    for (int32_t f = 0; f < mesh->field_count && holds_fields(format) && status == PEL_OK; f++)
        status = check_values(mesh->fields[f].values, mesh->vertex_count, mesh->fields[f].component_count,
                              mesh->fields[f].name, error);
    return status;
}

static pel_status write_format(pel_file_writer *writer, pel_mesh_format format, const pel_mesh *mesh,
                               const pel_log *log, pel_error *error)
{
    switch (format) {
    case PEL_FORMAT_OBJ:
        pel_obj_write(writer, mesh);
        return PEL_OK;
    case PEL_FORMAT_PLY:
        return pel_ply_write(writer, PEL_ENCODING_LITTLE, mesh, log, error);
    case PEL_FORMAT_PLY_ASCII:
        return pel_ply_write(writer, PEL_ENCODING_ASCII, mesh, log, error);
    case PEL_FORMAT_PLY_BIG:
        return pel_ply_write(writer, PEL_ENCODING_BIG, mesh, log, error);
    case PEL_FORMAT_STL:
        return pel_stl_write(writer, PEL_ENCODING_LITTLE, mesh, error);
    case PEL_FORMAT_STL_ASCII:
        return pel_stl_write(writer, PEL_ENCODING_ASCII, mesh, error);
    default:
        pel_off_write(writer, mesh);
        return PEL_OK;
    }
}

static pel_status write_vtp(const char *path, const pel_mesh *mesh, pel_error *error)
{
    pel_vtp_field *fields = pel_allocate((size_t)mesh->field_count, sizeof *fields);
    if (fields == NULL)
        return pel_fail_memory(error);
    for (int32_t f = 0; f < mesh->field_count; f++)
        fields[f] = (pel_vtp_field){mesh->fields[f].name, mesh->fields[f].component_count, mesh->fields[f].values};
    const pel_vtp vtp = {.vertex_count = mesh->vertex_count,
                         .triangle_count = mesh->triangle_count,
                         .positions = mesh->positions[0],
                         .triangles = mesh->triangles[0],
                         .fields = fields,
                         .field_count = mesh->field_count,
                         .compress = true,
                         .float64 = true};
    pel_status status = pel_vtp_write(path, &vtp, error);
    pel_free(fields);
    return status;
}

pel_status pel_mesh_write(const char *path, pel_mesh_format format, const pel_mesh *mesh, const pel_log *log,
                          pel_error *error)
{
    PEL_REFUSE_NULL(path, error);
    PEL_REFUSE_NULL(mesh, error);
    if (format == PEL_FORMAT_AUTO)
        format = pel_mesh_format_of_path(path);
    if (format <= PEL_FORMAT_AUTO || format >= PEL_FORMAT_COUNT) {
        pel_fail(error, PEL_BAD_ARGUMENT, "the extension does not tell the format to write");
        pel_fail_remedy(error, "use the extension .obj, .ply, .stl, .off or .vtp");
        pel_fail_place(error, path, 0, 0);
        return PEL_BAD_ARGUMENT;
    }
    pel_status status = check_mesh(mesh, format, error);
    if (format == PEL_FORMAT_VTP)
        return status == PEL_OK ? write_vtp(path, mesh, error) : status;
    pel_file_writer writer;
    if (status == PEL_OK)
        status = pel_file_writer_open(&writer, path, error);
    if (status != PEL_OK)
        return status;
    status = write_format(&writer, format, mesh, log, error);
    if (status != PEL_OK) {
        pel_file_writer_abandon(&writer);
        return status;
    }
    if (mesh->field_count > 0 && !holds_fields(format))
        pel_log_line(log, "%d vertex %s dropped: only PLY and VTP hold them", (int)mesh->field_count,
                     mesh->field_count == 1 ? "field" : "fields");
    return pel_file_writer_commit(&writer, error);
}
