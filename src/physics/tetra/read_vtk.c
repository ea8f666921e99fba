/* Legacy VTK files of unstructured grids as text, up to version 5 (Kitware, "VTK file formats"): cells as lists with
   their lengths, or since version 5 as offsets and connectivity. Data of points and cells is skipped. */
#include "tetra/read.h"

#include "base/memory.h"
#include "base/status.h"

#include <string.h>

/* types of cells */
enum { LARGEST_SURFACE = 9, TETRAHEDRON = 10, TETRAHEDRON_10 = 24 };

typedef struct vtk_reader {
    pel_text_cursor *scan;
    pel_tetra_soup *soup;
    pel_error *error;
    int64_t *connectivity, *offsets; /* (connectivity_count), (cell_count + 1) */
    const char **places;             /* (cell_count) */
    int64_t cell_count, connectivity_count;
    bool has_points, has_types, is_new;
} vtk_reader;

static pel_status fail_here(const vtk_reader *reader, const char *remedy, const char *what)
{
    return pel_text_cursor_fail(reader->scan, reader->scan->at, reader->error, remedy, "%s", what);
}

/* the lines before the data: version, title, ASCII, DATASET */
static pel_status read_head(vtk_reader *reader)
{
    static const char first[] = "# vtk DataFile Version";
    pel_text_cursor *scan = reader->scan;
    double version = 0;
    if (scan->end - scan->at < (ptrdiff_t)strlen(first) || memcmp(scan->at, first, strlen(first)) != 0)
        return fail_here(reader, "save it again as legacy VTK, or as .vtu", "the file does not begin as VTK files do");
    scan->at += strlen(first);
    pel_text_cursor_skip_blanks(scan);
    pel_text_cursor_number(scan, &version);
    reader->is_new = version >= 5;
    for (int i = 0; i < 2; i++) {
        pel_text_cursor_skip_line(scan);
        if (scan->at < scan->end)
            scan->at += scan->at + 1 < scan->end && scan->at[0] == '\r' && scan->at[1] == '\n' ? 2 : 1;
    }
    pel_text_cursor_skip_spaces(scan);
    if (pel_text_cursor_accept(scan, "BINARY"))
        return fail_here(reader, "save it as text (in ParaView: File Type Ascii), or as .vtu",
                         "binary legacy VTK files are not read");
    if (!pel_text_cursor_accept(scan, "ASCII"))
        return fail_here(reader, "save it again as legacy VTK, or as .vtu", "the third line is not ASCII");
    pel_text_cursor_skip_spaces(scan);
    if (!pel_text_cursor_accept(scan, "DATASET"))
        return fail_here(reader, "save it again as legacy VTK, or as .vtu", "there is no DATASET");
    pel_text_cursor_skip_blanks(scan);
    if (!pel_text_cursor_accept(scan, "UNSTRUCTURED_GRID"))
        return fail_here(reader, "save a surface as .vtp or .ply, a volume as an unstructured grid",
                         "the data set is no unstructured grid");
    return PEL_OK;
}

static pel_status read_points(vtk_reader *reader)
{
    int64_t count;
    size_t length;
    pel_status status = pel_tetra_read_count(reader->scan, "a number of points", 6, &count, reader->error);
    if (status == PEL_OK) {
        pel_text_cursor_skip_blanks(reader->scan);
        pel_text_cursor_word(reader->scan, &length); /* the type */
    }
    for (int64_t i = 0; status == PEL_OK && i < count; i++) {
        double x[3];
        status = pel_tetra_read_point(reader->scan, x, reader->error);
        if (status == PEL_OK)
            status = pel_tetra_soup_add_point(reader->soup, x, reader->error);
    }
    reader->has_points = true;
    return status;
}

static pel_status allocate_cells(vtk_reader *reader)
{
    pel_free(reader->connectivity);
    pel_free(reader->offsets);
    pel_free(reader->places);
    reader->connectivity = pel_allocate((size_t)reader->connectivity_count + 1, sizeof *reader->connectivity);
    reader->offsets = pel_allocate((size_t)reader->cell_count + 1, sizeof *reader->offsets);
    reader->places = pel_allocate((size_t)reader->cell_count + 1, sizeof *reader->places);
    return reader->connectivity != NULL && reader->offsets != NULL && reader->places != NULL
               ? PEL_OK
               : pel_fail_memory(reader->error);
}

/* cells as lists of their points, each after its length */
static pel_status read_lists(vtk_reader *reader)
{
    int64_t size, used = 0;
    pel_status status = pel_tetra_read_count(reader->scan, "a number of cells", 4, &reader->cell_count, reader->error);
    if (status == PEL_OK)
        status = pel_tetra_read_count(reader->scan, "a size of cells", 2, &size, reader->error);
    if (status != PEL_OK)
        return status;
    reader->connectivity_count = size;
    status = allocate_cells(reader);
    for (int64_t c = 0; status == PEL_OK && c < reader->cell_count; c++) {
        int64_t count;
        pel_text_cursor_skip_spaces(reader->scan);
        reader->places[c] = reader->scan->at;
        reader->offsets[c] = used;
        status = pel_tetra_read_count(reader->scan, "a number of points of a cell", 2, &count, reader->error);
        if (status == PEL_OK && count > size - used)
            return pel_text_cursor_fail(reader->scan, reader->places[c], reader->error, "save the file again",
                                        "the cells are longer than CELLS says");
        for (int64_t i = 0; status == PEL_OK && i < count; i++)
            status = pel_tetra_read_integer(reader->scan, "the number of a point", &reader->connectivity[used++],
                                            reader->error);
    }
    if (status == PEL_OK)
        reader->offsets[reader->cell_count] = used;
    return status;
}

/* the words OFFSETS or CONNECTIVITY with a type, and numbers */
static pel_status read_numbers(vtk_reader *reader, const char *word, int64_t *values, int64_t count)
{
    size_t length;
    pel_text_cursor_skip_spaces(reader->scan);
    if (!pel_text_cursor_accept(reader->scan, word))
        return pel_text_cursor_fail(reader->scan, reader->scan->at, reader->error, "save the file again",
                                    "there is no %s", word);
    pel_text_cursor_skip_blanks(reader->scan);
    pel_text_cursor_word(reader->scan, &length);
    pel_status status = PEL_OK;
    for (int64_t i = 0; status == PEL_OK && i < count; i++)
        status = pel_tetra_read_integer(reader->scan, "the number of a point", &values[i], reader->error);
    return status;
}

static pel_status read_offsets(vtk_reader *reader)
{
    int64_t count;
    pel_status status = pel_tetra_read_count(reader->scan, "a number of offsets", 2, &count, reader->error);
    if (status == PEL_OK)
        status = pel_tetra_read_count(reader->scan, "a number of points of cells", 2, &reader->connectivity_count,
                                      reader->error);
    if (status != PEL_OK)
        return status;
    const char *place = reader->scan->at;
    reader->cell_count = count > 0 ? count - 1 : 0;
    status = allocate_cells(reader);
    for (int64_t c = 0; status == PEL_OK && c < reader->cell_count; c++)
        reader->places[c] = place;
    if (status == PEL_OK)
        status = read_numbers(reader, "OFFSETS", reader->offsets, count);
    for (int64_t c = 0; status == PEL_OK && c < count; c++)
        if (reader->offsets[c] < (c > 0 ? reader->offsets[c - 1] : 0) ||
            reader->offsets[c] > reader->connectivity_count)
            return pel_text_cursor_fail(reader->scan, place, reader->error, "save the file again",
                                        "offset %lld of the cells is out of order or of range", (long long)c);
    return status == PEL_OK ? read_numbers(reader, "CONNECTIVITY", reader->connectivity, reader->connectivity_count)
                            : status;
}

static pel_status take_cell(vtk_reader *reader, int64_t c, int64_t type)
{
    const int64_t count = reader->offsets[c + 1] - reader->offsets[c];
    const bool is_quadratic = type == TETRAHEDRON_10;
    if (type != TETRAHEDRON && !is_quadratic) {
        const bool is_surface = type <= LARGEST_SURFACE || (type >= 21 && type <= 23);
        return is_surface
                   ? PEL_OK
                   : pel_tetra_refuse_cell(reader->scan, reader->places[c], "cell of another shape", reader->error);
    }
    if (count != (is_quadratic ? 10 : 4))
        return pel_text_cursor_fail(reader->scan, reader->places[c], reader->error, "save the file again",
                                    "a tetrahedron has %lld points", (long long)count);
    reader->soup->quadratic_count += is_quadratic;
    return pel_tetra_soup_add(reader->soup, &reader->connectivity[reader->offsets[c]], reader->places[c],
                              reader->error);
}

static pel_status read_types(vtk_reader *reader)
{
    int64_t count;
    pel_status status = pel_tetra_read_count(reader->scan, "a number of types", 2, &count, reader->error);
    if (status == PEL_OK && (count != reader->cell_count || reader->offsets == NULL))
        return fail_here(reader, "save the file again", "the types of cells are not as many as the cells");
    for (int64_t c = 0; status == PEL_OK && c < count; c++) {
        int64_t type;
        status = pel_tetra_read_integer(reader->scan, "the type of a cell", &type, reader->error);
        if (status == PEL_OK)
            status = take_cell(reader, c, type);
    }
    reader->has_types = true;
    return status;
}

static pel_status read_sections(vtk_reader *reader)
{
    pel_status status = read_head(reader);
    while (status == PEL_OK && !reader->has_types) {
        pel_text_cursor_skip_spaces(reader->scan);
        if (reader->scan->at == reader->scan->end)
            return fail_here(reader, "copy or save the file again", "the file ends before the types of its cells");
        if (pel_text_cursor_accept(reader->scan, "POINTS") && !reader->has_points)
            status = read_points(reader);
        else if (pel_text_cursor_accept(reader->scan, "CELLS"))
            status = reader->is_new ? read_offsets(reader) : read_lists(reader);
        else if (pel_text_cursor_accept(reader->scan, "CELL_TYPES"))
            status = read_types(reader);
        else
            pel_text_cursor_skip_line(reader->scan); /* metadata and fields */
    }
    return status;
}

pel_status pel_vtk_read(pel_text_cursor *scan, pel_tetra_soup *soup, pel_error *error)
{
    vtk_reader reader = {.scan = scan, .soup = soup, .error = error};
    pel_status status = read_sections(&reader);
    pel_free(reader.connectivity);
    pel_free(reader.offsets);
    pel_free(reader.places);
    return status;
}
