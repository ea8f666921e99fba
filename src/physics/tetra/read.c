/* Files with tetrahedra. A reader of the format fills a soup of points and tetrahedra; then the corners are checked,
   and all tetrahedra are turned around if each of them has a negative volume, as some programs write them. */
#include "tetra/read.h"

#include "base/memory.h"
#include "base/room.h"
#include "io/file.h"
#include "io/formats.h"
#include "pellicle/volume.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* ---- the soup ---- */

pel_status pel_tetra_soup_add_point(pel_tetra_soup *soup, const double x[3], pel_error *error)
{
    void *points = soup->points;
    if (!pel_reserve(&points, &soup->point_limit, soup->point_count + 1, sizeof *soup->points))
        return pel_fail_memory(error);
    soup->points = points;
    memcpy(soup->points[soup->point_count++], x, sizeof *soup->points);
    return PEL_OK;
}

pel_status pel_tetra_soup_add(pel_tetra_soup *soup, const int64_t corners[4], const char *place, pel_error *error)
{
    void *tetrahedra = soup->tetrahedra, *places = soup->places;
    bool room =
        pel_reserve(&tetrahedra, &soup->tetrahedron_limit, soup->tetrahedron_count + 1, sizeof *soup->tetrahedra);
    soup->tetrahedra = tetrahedra;
    room = room && pel_reserve(&places, &soup->place_limit, soup->tetrahedron_count + 1, sizeof *soup->places);
    soup->places = places;
    if (!room)
        return pel_fail_memory(error);
    for (int k = 0; k < 4; k++)
        soup->tetrahedra[soup->tetrahedron_count][k] =
            corners[k] >= 0 && corners[k] < INT32_MAX ? (int32_t)corners[k] : INT32_MAX;
    soup->places[soup->tetrahedron_count++] = place;
    return PEL_OK;
}

static void free_soup(pel_tetra_soup *soup)
{
    PEL_FREE_ALL(soup->points, soup->tetrahedra, soup->places);
}

/* ---- numbers ---- */

pel_status pel_tetra_read_integer(pel_text_cursor *scan, const char *what, int64_t *value, pel_error *error)
{
    pel_text_cursor_skip_comments(scan);
    const char *place = scan->at;
    if (pel_text_cursor_integer(scan, value) && pel_text_cursor_at_break(scan))
        return PEL_OK;
    scan->at = place;
    return pel_text_cursor_fail_number(scan, error, what);
}

pel_status pel_tetra_read_count(pel_text_cursor *scan, const char *what, int64_t smallest, int64_t *count,
                                pel_error *error)
{
    pel_text_cursor_skip_comments(scan);
    const char *place = scan->at;
    pel_status status = pel_tetra_read_integer(scan, what, count, error);
    if (status == PEL_OK && (*count < 0 || *count > (scan->end - scan->at) / smallest))
        return pel_text_cursor_fail(scan, place, error, "the file seems to be cut off: copy or save it again",
                                    "%s is %lld, more than the file can hold", what + 2, (long long)*count);
    return status;
}

pel_status pel_tetra_read_point(pel_text_cursor *scan, double x[3], pel_error *error)
{
    for (int c = 0; c < 3; c++) {
        pel_text_cursor_skip_comments(scan);
        if (!pel_text_cursor_number(scan, &x[c]))
            return pel_text_cursor_fail_number(scan, error, "a finite coordinate");
    }
    return PEL_OK;
}

pel_status pel_tetra_refuse_cell(const pel_text_cursor *scan, const char *at, const char *shape, pel_error *error)
{
    return pel_text_cursor_fail(scan, at, error, "mesh the volume with tetrahedra",
                                "there is a %s, but only tetrahedra can be used", shape);
}

/* ---- VTU ---- */

static pel_status take_cell(const pel_text_cursor *scan, const pel_vtk_grid *grid, int64_t c, int64_t begin,
                            pel_tetra_soup *soup, pel_error *error)
{
    enum { LARGEST_SURFACE = 9, TETRAHEDRON = 10, TETRAHEDRON_10 = 24 };
    const double type = grid->types[c];
    const int64_t count = (int64_t)grid->ends[c] - begin;
    const bool is_quadratic = type == TETRAHEDRON_10;
    int64_t corners[4];
    if (type <= LARGEST_SURFACE || (type >= 21 && type <= 23))
        return PEL_OK;
    if (type != TETRAHEDRON && !is_quadratic)
        return pel_tetra_refuse_cell(scan, scan->begin, "cell of another shape", error);
    if (count != (is_quadratic ? 10 : 4))
        return pel_text_cursor_fail(scan, scan->begin, error, "save the file again", "tetrahedron %lld has %lld points",
                                    (long long)c, (long long)count);
    for (int k = 0; k < 4; k++) {
        const double corner = grid->corners[begin + k];
        corners[k] = corner >= 0 && corner < INT32_MAX && corner == floor(corner) ? (int64_t)corner : -1;
    }
    soup->quadratic_count += is_quadratic;
    return pel_tetra_soup_add(soup, corners, NULL, error);
}

static pel_status read_vtu(pel_text_cursor *scan, pel_tetra_soup *soup, pel_error *error)
{
    pel_vtk_grid grid = {0};
    pel_status status = pel_vtu_read(scan, &grid, error);
    for (int64_t v = 0; status == PEL_OK && v < grid.point_count; v++)
        status = pel_tetra_soup_add_point(soup, grid.points + 3 * v, error);
    for (int64_t c = 0; status == PEL_OK && c < grid.cell_count; c++)
        status = take_cell(scan, &grid, c, c > 0 ? (int64_t)grid.ends[c - 1] : 0, soup, error);
    pel_vtk_grid_free(&grid);
    return status;
}

/* ---- TetGen ---- */

/* "count dimension attributes markers", then "number x y z ..."; numbers run on from 0 or 1, which *first gets */
static pel_status read_node(pel_text_cursor *scan, pel_tetra_soup *soup, int64_t *first, pel_error *error)
{
    int64_t count, dimension, number;
    pel_status status = pel_tetra_read_count(scan, "a number of nodes", 6, &count, error);
    if (status == PEL_OK)
        status = pel_tetra_read_integer(scan, "the number 3 of coordinates", &dimension, error);
    if (status == PEL_OK && dimension != 3)
        return pel_text_cursor_fail(scan, scan->at, error, "give the .node file of a mesh in space",
                                    "nodes have %lld coordinates", (long long)dimension);
    *first = 1;
    pel_text_cursor_skip_line(scan);
    for (int64_t i = 0; status == PEL_OK && i < count; i++) {
        double x[3];
        pel_text_cursor_skip_comments(scan);
        const char *place = scan->at;
        status = pel_tetra_read_integer(scan, "the number of a node", &number, error);
        if (status == PEL_OK && i == 0)
            *first = number;
        if (status == PEL_OK && (number != *first + i || *first < 0 || *first > 1))
            return pel_text_cursor_fail(scan, place, error, "number the nodes from 0 or 1 without gaps",
                                        "the node has the number %lld, not %lld", (long long)number,
                                        (long long)((*first == 0 ? 0 : 1) + i));
        if (status == PEL_OK)
            status = pel_tetra_read_point(scan, x, error);
        if (status == PEL_OK)
            status = pel_tetra_soup_add_point(soup, x, error);
        pel_text_cursor_skip_line(scan);
    }
    return status;
}

/* "count corners attributes", then "number a b c d ..." */
static pel_status read_ele(pel_text_cursor *scan, pel_tetra_soup *soup, int64_t first, pel_error *error)
{
    int64_t count, width, number;
    pel_status status = pel_tetra_read_count(scan, "a number of tetrahedra", 8, &count, error);
    if (status == PEL_OK)
        status = pel_tetra_read_integer(scan, "a number of corners", &width, error);
    if (status == PEL_OK && width != 4 && width != 10)
        return pel_text_cursor_fail(scan, scan->at, error, "give the .ele file of tetrahedra",
                                    "elements have %lld corners", (long long)width);
    pel_text_cursor_skip_line(scan);
    for (int64_t i = 0; status == PEL_OK && i < count; i++) {
        int64_t corners[4];
        pel_text_cursor_skip_comments(scan);
        const char *place = scan->at;
        status = pel_tetra_read_integer(scan, "the number of a tetrahedron", &number, error);
        for (int k = 0; status == PEL_OK && k < 4; k++) {
            status = pel_tetra_read_integer(scan, "the number of a node", &corners[k], error);
            corners[k] -= status == PEL_OK ? first : 0;
        }
        if (status == PEL_OK)
            status = pel_tetra_soup_add(soup, corners, place, error);
        soup->quadratic_count += width == 10;
        pel_text_cursor_skip_line(scan);
    }
    return status;
}

/* ---- the mesh ---- */

static pel_status fail_tetrahedron(const pel_text_cursor *scan, const pel_tetra_soup *soup, size_t t,
                                   const char *remedy, const char *what, pel_error *error)
{
    const char *place = soup->places[t] != NULL ? soup->places[t] : scan->begin;
    pel_text_cursor_fail(scan, place, error, remedy, "tetrahedron %zu of the file %s", t + 1, what);
    return PEL_BAD_FORMAT;
}

static pel_status check_corners(const pel_text_cursor *scan, const pel_tetra_soup *soup, pel_error *error)
{
    if (soup->tetrahedron_count == 0)
        return pel_text_cursor_fail(scan, scan->begin, error,
                                    "mesh the volume as well: in Gmsh a 3D mesh of a physical volume",
                                    "the file has no tetrahedra");
    if (soup->tetrahedron_count > INT32_MAX / 4 || soup->point_count >= INT32_MAX / 4)
        return pel_text_cursor_fail(scan, scan->begin, error, "use a coarser mesh", "the mesh is too large");
    for (size_t t = 0; t < soup->tetrahedron_count; t++)
        for (int k = 0; k < 4; k++)
            if ((size_t)soup->tetrahedra[t][k] >= soup->point_count)
                return fail_tetrahedron(scan, soup, t, "save the mesh again with all its nodes",
                                        "has a node that does not exist", error);
    return PEL_OK;
}

static double volume_of(const pel_tetra_soup *soup, size_t t)
{
    double x[4][3];
    for (int k = 0; k < 4; k++)
        memcpy(x[k], soup->points[soup->tetrahedra[t][k]], sizeof x[k]);
    return pel_tetrahedron_volume((const double(*)[3])x);
}

/* turns all tetrahedra around where each of them is inside out; refuses a file with both */
static pel_status orient(const pel_text_cursor *scan, pel_tetra_soup *soup, const pel_log *log, pel_error *error)
{
    size_t inverted = 0, last = 0, upright = 0;
    for (size_t t = 0; t < soup->tetrahedron_count; t++) {
        const double volume = volume_of(soup, t);
        if (volume == 0)
            return fail_tetrahedron(scan, soup, t, "remove it, or improve the mesh", "has no volume", error);
        inverted += volume < 0;
        if (volume < 0)
            last = t;
        else
            upright = t;
    }
    if (inverted == 0)
        return PEL_OK;
    if (inverted < soup->tetrahedron_count)
        return fail_tetrahedron(scan, soup, 2 * inverted <= soup->tetrahedron_count ? last : upright,
                                "swap two of its nodes, or repair the mesh where it folds over",
                                "is turned inside out, unlike most others", error);
    for (size_t t = 0; t < soup->tetrahedron_count; t++) {
        const int32_t first = soup->tetrahedra[t][0];
        soup->tetrahedra[t][0] = soup->tetrahedra[t][1];
        soup->tetrahedra[t][1] = first;
    }
    pel_log_line(log, "tetrahedra turned around: the file lists their corners in the other order");
    return PEL_OK;
}

static pel_status make_mesh(const pel_text_cursor *scan, pel_tetra_soup *soup, const pel_log *log, pel_mesh **mesh,
                            pel_error *error)
{
    char what[sizeof error->what], remedy[sizeof error->remedy];
    pel_error own = {0};
    pel_status status = check_corners(scan, soup, error);
    if (status == PEL_OK)
        status = orient(scan, soup, log, error);
    if (status != PEL_OK)
        return status;
    status = pel_mesh_create_filled(soup->points[0], (int32_t)soup->point_count, soup->tetrahedra[0],
                                    (int32_t)soup->tetrahedron_count, mesh, &own);
    if (status == PEL_OUT_OF_MEMORY)
        return pel_fail_memory(error);
    if (status != PEL_OK) {
        const bool is_tetrahedron = strcmp(own.element_kind, "tetrahedron") == 0 && own.element >= 0;
        snprintf(what, sizeof what, "%s", own.what);
        snprintf(remedy, sizeof remedy, "%s", own.remedy);
        return is_tetrahedron ? fail_tetrahedron(scan, soup, (size_t)own.element, remedy, what, error)
                              : pel_text_cursor_fail(scan, scan->begin, error, remedy, "%s", what);
    }
    if (soup->quadratic_count > 0)
        pel_log_line(log, "%zu tetrahedra have nodes on their edges, which are ignored", soup->quadratic_count);
    if ((size_t)(*mesh)->vertex_count < soup->point_count)
        pel_log_line(log, "%zu nodes that belong to no tetrahedron ignored",
                     soup->point_count - (size_t)(*mesh)->vertex_count);
    return PEL_OK;
}

/* ---- files ---- */

typedef enum volume_format { FORMAT_NONE, FORMAT_MSH, FORMAT_VTK, FORMAT_VTU, FORMAT_TETGEN } volume_format;

static volume_format format_of(const char *path)
{
    static const struct {
        const char *extension;
        volume_format format;
    } formats[] = {{".msh", FORMAT_MSH},
                   {".vtk", FORMAT_VTK},
                   {".vtu", FORMAT_VTU},
                   {".ele", FORMAT_TETGEN},
                   {".node", FORMAT_TETGEN}};
    const char *dot = strrchr(path, '.');
    for (size_t i = 0; dot != NULL && i < sizeof formats / sizeof *formats; i++)
        if (strcmp(dot, formats[i].extension) == 0)
            return formats[i].format;
    return FORMAT_NONE;
}

bool pel_mesh_is_filled_file(const char *path)
{
    return path != NULL && format_of(path) != FORMAT_NONE;
}

static pel_status read_soup(pel_text_cursor *scan, volume_format format, pel_tetra_soup *soup, pel_error *error)
{
    if (format == FORMAT_MSH)
        return pel_msh_read(scan, soup, error);
    return format == FORMAT_VTK ? pel_vtk_read(scan, soup, error) : read_vtu(scan, soup, error);
}

pel_status pel_mesh_parse_filled(const char *name, const void *bytes, size_t size, const pel_log *log, pel_mesh **mesh,
                                 pel_error *error)
{
    PEL_REFUSE_NULL(name, error);
    PEL_REFUSE_NULL(bytes, error);
    PEL_REFUSE_NULL(mesh, error);
    *mesh = NULL;
    const volume_format format = format_of(name);
    pel_tetra_soup soup = {0};
    pel_text_cursor scan = {.name = name, .begin = bytes, .at = bytes, .end = (const char *)bytes + size};
    if (format == FORMAT_NONE || format == FORMAT_TETGEN)
        return pel_text_cursor_fail(&scan, scan.begin, error, "use .msh, .vtk or .vtu; .node and .ele as two files",
                                    "the extension is not that of a file with tetrahedra");
    pel_status status = read_soup(&scan, format, &soup, error);
    if (status == PEL_OK)
        status = make_mesh(&scan, &soup, log, mesh, error);
    free_soup(&soup);
    return status;
}

/* the name of the other one of two files */
static bool find_partner(const char *path, const char *extension, char *partner, size_t size)
{
    const size_t stem = (size_t)(strrchr(path, '.') - path);
    return snprintf(partner, size, "%.*s%s", (int)stem, path, extension) < (int)size && stem < size;
}

static pel_status read_tetgen(const char *path, const pel_log *log, pel_mesh **mesh, pel_error *error)
{
    char names[2][1024], *bytes[2] = {NULL, NULL};
    size_t sizes[2];
    int64_t first = 1;
    pel_tetra_soup soup = {0};
    if (!find_partner(path, ".node", names[0], sizeof names[0]) ||
        !find_partner(path, ".ele", names[1], sizeof names[1]))
        return pel_refuse(error, PEL_BAD_FILE, "move the files to a shorter path", "path is too long");
    pel_status status = pel_file_read(names[0], &bytes[0], &sizes[0], error);
    if (status == PEL_OK)
        status = pel_file_read(names[1], &bytes[1], &sizes[1], error);
    for (int i = 0; status == PEL_OK && i < 2; i++) {
        pel_text_cursor scan = {.name = names[i], .begin = bytes[i], .at = bytes[i], .end = bytes[i] + sizes[i]};
        status = i == 0 ? read_node(&scan, &soup, &first, error) : read_ele(&scan, &soup, first, error);
        if (status == PEL_OK && i == 1)
            status = make_mesh(&scan, &soup, log, mesh, error);
    }
    free_soup(&soup);
    PEL_FREE_ALL(bytes[0], bytes[1]);
    return status;
}

pel_status pel_mesh_read_filled(const char *path, const pel_log *log, pel_mesh **mesh, pel_error *error)
{
    PEL_REFUSE_NULL(path, error);
    PEL_REFUSE_NULL(mesh, error);
    char *bytes;
    size_t size;
    *mesh = NULL;
    if (format_of(path) == FORMAT_TETGEN)
        return read_tetgen(path, log, mesh, error);
    pel_status status = pel_file_read(path, &bytes, &size, error);
    if (status != PEL_OK)
        return status;
    status = pel_mesh_parse_filled(path, bytes, size, log, mesh, error);
    pel_free(bytes);
    return status;
}
