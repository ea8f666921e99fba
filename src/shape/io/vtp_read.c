/* Reads VTK XML PolyData, or an unstructured grid, of one piece as VTK and ParaView write it: arrays as text, in base64
   within their tags, or in the appended section, raw or in base64; packed by zlib or not; words of 32 or 64 bits in
   either byte order. The file is read tag by tag into a list of arrays, then each that is wanted is decoded. All sizes
   are checked against the bytes that are there before memory is asked for, no byte of the file may be used by two
   arrays, and all numbers together are bounded by a multiple of the file's size. Format: Kitware, "VTK XML file
   formats". */
#include "pellicle/results.h"

#include "base/memory.h"
#include "base/number.h"
#include "base/status.h"
#include "io/base64.h"
#include "io/byte_order.h"
#include "io/bytes.h"
#include "io/file.h"
#include "io/formats.h"
#include "io/polygon_soup.h"
#include "io/vtk_blocks.h"
#include "io/xml.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Numbers (of 8 bytes each) that a file may hold, for each of its bytes, and how many in any case. zlib packs constant
   fields 1000 to 1; but points and triangles 5 to 1 at best, so that 100 constant fields on a surface make some 13 */
enum { NUMBERS_PER_BYTE = 32, NUMBERS_AT_LEAST = 1 << 17 };

typedef enum value_type {
    TYPE_INT8,
    TYPE_UINT8,
    TYPE_INT16,
    TYPE_UINT16,
    TYPE_INT32,
    TYPE_UINT32,
    TYPE_INT64,
    TYPE_UINT64,
    TYPE_FLOAT32,
    TYPE_FLOAT64,
    TYPE_COUNT
} value_type;

static const char *const type_names[TYPE_COUNT] = {"Int8",   "UInt8", "Int16",  "UInt16",  "Int32",
                                                   "UInt32", "Int64", "UInt64", "Float32", "Float64"};
static const size_t type_sizes[TYPE_COUNT] = {1, 1, 2, 2, 4, 4, 8, 8, 4, 8};

typedef enum vtp_section {
    SECTION_NONE,
    SECTION_FIELD_DATA,
    SECTION_POINT_DATA,
    SECTION_POINTS,
    SECTION_POLYS,
    SECTION_STRIPS,
    SECTION_CELLS
} vtp_section;

typedef enum vtp_form { FORM_ASCII, FORM_BASE64, FORM_APPENDED } vtp_form;

typedef struct vtp_array {
    vtp_section section;
    value_type type;
    vtp_form form;
    int32_t component_count;
    size_t offset;          /* in the appended section */
    const char *text, *end; /* otherwise the value in the tag */
    char name[PEL_NAME_SIZE];
} vtp_array;

typedef struct vtp_reader {
    const char *path;
    const pel_log *log; /* nullable */
    pel_error *error;
    const char *start, *end; /* the whole file */
    const char *data;        /* the appended section; null = none */
    size_t data_size;
    bool data_is_base64;
    size_t unused;                 /* characters of the appended section that no array took */
    size_t numbers_left;           /* that may be read still */
    bool packed, swapped, is_grid; /* is_grid: an unstructured grid */
    size_t word_size;
    int64_t vertex_count, polygon_count, strip_count, other_count, piece_count, cell_count;
    vtp_array *arrays;
    size_t array_count, array_capacity;
} vtp_reader;

static pel_status fail_with(const vtp_reader *reader, const void *at, const char *what, const char *remedy)
{
    pel_fail(reader->error, PEL_BAD_FORMAT, "%s", what);
    pel_fail_remedy(reader->error, "%s", remedy);
    pel_fail_offset(reader->error, reader->path, (const char *)at - reader->start);
    return PEL_BAD_FORMAT;
}

static pel_status fail_at(const vtp_reader *reader, const void *at, const char *what)
{
    return fail_with(reader, at, what,
                     "write the file again as VTK PolyData (.vtp) of one piece, or convert the surface to PLY");
}

static pel_status read_file_tag(vtp_reader *reader, const pel_xml_tag *tag)
{
    char text[64];
    const bool has_type = pel_xml_attribute(tag, "type", text, sizeof text);
    if (reader->is_grid && (!has_type || strcmp(text, "UnstructuredGrid") != 0))
        return fail_with(reader, tag->start, "this is not a VTK file of an unstructured grid",
                         "save the volume as an unstructured grid (.vtu), a surface as .vtp");
    if (!reader->is_grid && (!has_type || strcmp(text, "PolyData") != 0))
        return fail_with(reader, tag->start, "this is not a VTK PolyData file",
                         "extract the surface in ParaView (Extract Surface) and save it as .vtp");
    reader->swapped = pel_xml_attribute(tag, "byte_order", text, sizeof text) && strcmp(text, PEL_BYTE_ORDER_NAME) != 0;
    reader->packed = pel_xml_attribute(tag, "compressor", text, sizeof text);
    if (reader->packed && strcmp(text, "vtkZLibDataCompressor") != 0)
        return fail_with(reader, tag->start, "the data is not packed by zlib",
                         "save it with the compressor ZLib, or with none");
    bool wide = pel_xml_attribute(tag, "header_type", text, sizeof text) && strcmp(text, "UInt64") == 0;
    reader->word_size = wide ? sizeof(uint64_t) : sizeof(uint32_t);
    return PEL_OK;
}

static bool read_cell_count(const pel_xml_tag *tag, const char *name, int64_t *count)
{
    return !pel_xml_count(tag, name, count) || *count <= INT32_MAX / 3;
}

static pel_status fail_pieces(const vtp_reader *reader, const pel_xml_tag *tag)
{
    return fail_with(reader, tag->start, "there is more than one piece",
                     "merge them in ParaView (Merge Blocks, Extract Surface) and save again");
}

static pel_status read_grid_tag(vtp_reader *reader, const pel_xml_tag *tag)
{
    if (!pel_xml_count(tag, "NumberOfPoints", &reader->vertex_count) ||
        !pel_xml_count(tag, "NumberOfCells", &reader->cell_count) || reader->vertex_count < 1 ||
        reader->vertex_count > INT32_MAX || reader->cell_count < 1 || reader->cell_count > INT32_MAX)
        return fail_with(reader, tag->start, "the number of points or cells is missing or out of range",
                         "save the volume with its cells");
    return ++reader->piece_count > 1 ? fail_pieces(reader, tag) : PEL_OK;
}

static pel_status read_piece_tag(vtp_reader *reader, const pel_xml_tag *tag)
{
    int64_t vertices, lines;
    if (reader->is_grid)
        return read_grid_tag(reader, tag);
    if (!pel_xml_count(tag, "NumberOfPoints", &reader->vertex_count) ||
        !read_cell_count(tag, "NumberOfPolys", &reader->polygon_count) ||
        !read_cell_count(tag, "NumberOfStrips", &reader->strip_count) ||
        !read_cell_count(tag, "NumberOfVerts", &vertices) || !read_cell_count(tag, "NumberOfLines", &lines) ||
        reader->vertex_count < 1 || reader->polygon_count + reader->strip_count < 1 || reader->vertex_count > INT32_MAX)
        return fail_with(reader, tag->start, "the number of points or polygons is missing or out of range",
                         "save the surface with its faces; point clouds and curves cannot be used");
    reader->other_count = vertices + lines;
    return ++reader->piece_count > 1 ? fail_pieces(reader, tag) : PEL_OK;
}

static pel_status read_format(const vtp_reader *reader, const pel_xml_tag *tag, vtp_array *array)
{
    static const char *const names[] = {"ascii", "binary", "appended"};
    char text[32];
    int64_t offset;
    pel_xml_attribute(tag, "format", text, sizeof text);
    for (int form = FORM_ASCII; form <= FORM_APPENDED; form++) {
        if (strcmp(text, names[form]) != 0)
            continue;
        array->form = (vtp_form)form;
        if (form != FORM_APPENDED)
            return PEL_OK;
        if (!pel_xml_count(tag, "offset", &offset))
            break;
        array->offset = (size_t)offset;
        return PEL_OK;
    }
    return fail_at(reader, tag->start,
                   "the format of an array is unknown, or its offset in the appended section is missing");
}

/* takes the text between two tags as an array's, unless it has some */
static void take_text(vtp_reader *reader, const char *at)
{
    vtp_array *array = reader->array_count > 0 ? &reader->arrays[reader->array_count - 1] : NULL;
    if (array == NULL || array->text != NULL || array->form == FORM_APPENDED)
        return;
    const char *end = memchr(at, '<', (size_t)(reader->end - at));
    end = end != NULL ? end : reader->end;
    while (at < end && pel_is_space(*at))
        at++;
    if (at < end) {
        array->text = at;
        array->end = end;
    }
}

static pel_status read_array_tag(vtp_reader *reader, const pel_xml_tag *tag, vtp_section section)
{
    char text[32];
    vtp_array array = {.section = section, .type = TYPE_COUNT, .component_count = 1};
    int64_t count;
    pel_xml_attribute(tag, "type", text, sizeof text);
    for (int i = 0; i < TYPE_COUNT; i++)
        if (strcmp(text, type_names[i]) == 0)
            array.type = (value_type)i;
    if (array.type == TYPE_COUNT)
        return fail_at(reader, tag->start, "an array has an unknown type");
    bool named = pel_xml_attribute(tag, "Name", array.name, sizeof array.name) && array.name[0] != '\0';
    if (!named && section != SECTION_POINTS)
        return fail_at(reader, tag->start, "an array has no name or a very long one");
    if (pel_xml_count(tag, "NumberOfComponents", &count)) {
        if (count < 1 || count > INT16_MAX)
            return fail_at(reader, tag->start, "an array has no components or very many");
        array.component_count = (int32_t)count;
    }
    pel_status status = read_format(reader, tag, &array);
    if (status != PEL_OK)
        return status;
    void *arrays = reader->arrays;
    if (!pel_reserve(&arrays, &reader->array_capacity, reader->array_count + 1, sizeof array))
        return pel_fail_memory(reader->error);
    reader->arrays = arrays;
    reader->arrays[reader->array_count++] = array;
    if (tag->end[-1] != '/')
        take_text(reader, tag->end + 1);
    return PEL_OK;
}

/* the section after a tag, which may begin or end one */
static vtp_section section_after(const pel_xml_tag *tag, vtp_section present)
{
    static const char *const ends[] = {"", "/FieldData", "/PointData", "/Points", "/Polys", "/Strips", "/Cells"};
    bool empty = tag->end > tag->start && tag->end[-1] == '/';
    for (int i = SECTION_FIELD_DATA; i <= SECTION_CELLS; i++) {
        if (pel_xml_is(tag, ends[i]))
            return SECTION_NONE;
        if (pel_xml_is(tag, ends[i] + 1))
            return empty ? SECTION_NONE : (vtp_section)i;
    }
    return present;
}

/* skip arrays that only describe the file */
static bool is_wanted(const pel_xml_tag *tag, vtp_section section)
{
    char name[PEL_NAME_SIZE];
    if (!pel_xml_is(tag, "DataArray") || section == SECTION_NONE)
        return false;
    return section != SECTION_FIELD_DATA ||
           (pel_xml_attribute(tag, "Name", name, sizeof name) && strcmp(name, "TimeValue") == 0);
}

/* the appended section runs from the first underscore to the end tags */
static pel_status find_data(vtp_reader *reader, const pel_xml_tag *tag, const char *at)
{
    static const char last[] = "</VTKFile>";
    char text[16];
    pel_xml_attribute(tag, "encoding", text, sizeof text);
    reader->data_is_base64 = strcmp(text, "base64") == 0;
    if (!reader->data_is_base64 && strcmp(text, "raw") != 0)
        return fail_at(reader, tag->start, "the appended section is neither raw nor base64");
    const char *end = reader->end;
    while (end > at && (end[-1] == '\n' || end[-1] == '\r' || end[-1] == ' '))
        end--;
    if (end - at < (ptrdiff_t)strlen(last) || memcmp(end - strlen(last), last, strlen(last)) != 0)
        return fail_with(reader, end, "the file is cut off", "copy or write the file again");
    const char *mark = memchr(at, '_', (size_t)(end - at));
    if (mark == NULL)
        return fail_at(reader, at, "the appended section is missing");
    reader->data = mark + 1;
    reader->data_size = reader->unused = (size_t)(end - mark - 1);
    return PEL_OK;
}

static pel_status read_head(vtp_reader *reader)
{
    const char *at = reader->start;
    pel_xml_tag tag;
    vtp_section section = SECTION_NONE;
    pel_status status = PEL_OK;
    while (status == PEL_OK && pel_xml_next(&at, reader->end, &tag)) {
        if (reader->word_size == 0 && !pel_xml_is(&tag, "VTKFile") && tag.start[0] != '?' && tag.start[0] != '!')
            break;
        section = section_after(&tag, section);
        if (pel_xml_is(&tag, "VTKFile"))
            status = read_file_tag(reader, &tag);
        else if (pel_xml_is(&tag, "Piece"))
            status = read_piece_tag(reader, &tag);
        else if (is_wanted(&tag, section))
            status = read_array_tag(reader, &tag, section);
        else if (pel_xml_is(&tag, "/InformationKey") && section != SECTION_NONE)
            take_text(reader, at);
        else if (pel_xml_is(&tag, "AppendedData"))
            return find_data(reader, &tag, at);
        else if (pel_xml_is(&tag, "/VTKFile"))
            return PEL_OK;
    }
    if (status != PEL_OK)
        return status;
    if (reader->word_size == 0)
        return fail_at(reader, at, "this is not a VTK file");
    return fail_with(reader, at, "the file is cut off", "copy or write the file again");
}

/* ---- bytes of arrays ---- */

/* the first bytes of an array as a file holds them, at most `limit`, in a new block; one byte at least is allocated */
static pel_status load_bytes(const vtp_reader *reader, const vtp_array *array, size_t limit, unsigned char **bytes,
                             size_t *size)
{
    bool appended = array->form == FORM_APPENDED;
    const char *at = appended ? reader->data + array->offset : array->text;
    size_t available = appended ? reader->data_size - array->offset : (size_t)(array->end - array->text);
    bool raw = appended && !reader->data_is_base64;
    size_t most = raw ? available : available / 4 * 3 + 3;
    *size = most < limit ? most : limit;
    *bytes = pel_allocate(*size + 1, 1);
    if (*bytes == NULL)
        return pel_fail_memory(reader->error);
    if (raw)
        memcpy(*bytes, at, *size);
    else
        *size = pel_base64_decode(at, at + available, *bytes, *size);
    return PEL_OK;
}

/* the words before the data, in this machine's order */
static void order_words(const vtp_reader *reader, unsigned char *bytes, size_t size, size_t word_count)
{
    for (size_t i = 0; reader->swapped && i < word_count && (i + 1) * reader->word_size <= size; i++)
        pel_swap_bytes(bytes + i * reader->word_size, reader->word_size);
}

/* bytes of the file that an array of `size` bytes takes, its words included; 0 = more than there are */
static pel_status find_extent(const vtp_reader *reader, const vtp_array *array, size_t size, size_t *extent)
{
    unsigned char *bytes;
    size_t got, word = reader->word_size, words = reader->packed ? PEL_VTK_BLOCKS_WORDS : 1;
    size_t limit = (size_t)(reader->end - reader->start);
    *extent = 0;
    pel_status status = load_bytes(reader, array, words * word, &bytes, &got);
    if (status != PEL_OK)
        return status;
    order_words(reader, bytes, got, words);
    uint64_t first = got == words * word ? pel_vtk_blocks_word(bytes, word) : UINT64_MAX;
    pel_free(bytes);
    if (!reader->packed) {
        *extent = first == size && size < limit ? word + size : 0;
        return PEL_OK;
    }
    if (first > limit / word)
        return PEL_OK;
    words += (size_t)first;
    status = load_bytes(reader, array, words * word, &bytes, &got);
    if (status != PEL_OK)
        return status;
    order_words(reader, bytes, got, words);
    size_t sum = got == words * word ? got : 0;
    for (size_t i = PEL_VTK_BLOCKS_WORDS; sum > 0 && i < words; i++) {
        uint64_t length = pel_vtk_blocks_word(bytes + i * word, word);
        sum = length <= limit && sum <= limit ? sum + (size_t)length : 0;
    }
    pel_free(bytes);
    *extent = sum;
    return PEL_OK;
}

/* where an array stands, for messages */
static const char *place_of(const vtp_reader *reader, const vtp_array *array)
{
    if (array->form != FORM_APPENDED)
        return array->text != NULL ? array->text : reader->start;
    return reader->data != NULL && array->offset < reader->data_size ? reader->data + array->offset : reader->start;
}

/* the values of an array of `size` bytes, which is not 0, as bytes in a new block */
static pel_status take_bytes(vtp_reader *reader, const vtp_array *array, size_t size, unsigned char **bytes)
{
    unsigned char *stored;
    size_t got, extent, word = reader->word_size;
    *bytes = NULL;
    pel_status status = find_extent(reader, array, size, &extent);
    /* four characters of base64 encode three bytes */
    size_t taken = array->form != FORM_APPENDED ? 0 : reader->data_is_base64 ? extent + extent / 3 : extent;
    if (status == PEL_OK && (extent == 0 || taken > reader->unused))
        return fail_at(reader, place_of(reader, array), "the size of an array differs from that in its header");
    if (status == PEL_OK)
        status = load_bytes(reader, array, extent, &stored, &got);
    if (status != PEL_OK)
        return status;
    reader->unused -= taken;
    size_t words = 1;
    if (reader->packed) {
        order_words(reader, stored, got, 1);
        words = PEL_VTK_BLOCKS_WORDS + (size_t)pel_vtk_blocks_word(stored, word);
        order_words(reader, stored, got, 1);
    }
    order_words(reader, stored, got, words);
    bool whole = got == extent && (!reader->packed || pel_vtk_blocks_check(stored, got, word, size) == extent);
    if (whole)
        *bytes = pel_allocate(size, 1);
    if (!whole)
        status = fail_at(reader, place_of(reader, array), "the size of an array differs from that in its header");
    else if (*bytes == NULL)
        status = pel_fail_memory(reader->error);
    else if (!reader->packed)
        memcpy(*bytes, stored + word, size);
    else
        status = pel_vtk_blocks_unpack(stored, word, *bytes, size, reader->error);
    pel_free(stored);
    if (status == PEL_BAD_FORMAT && whole)
        status = fail_at(reader, place_of(reader, array), "a packed array is damaged");
    return status;
}

#define DECODE(type)                                                                                                   \
    do {                                                                                                               \
        type value;                                                                                                    \
        memcpy(&value, bytes, sizeof value);                                                                           \
        return (double)value;                                                                                          \
    } while (0)

static double decode(const unsigned char *bytes, value_type type)
{
    switch (type) {
    case TYPE_INT8:
        DECODE(int8_t);
    case TYPE_UINT8:
        DECODE(uint8_t);
    case TYPE_INT16:
        DECODE(int16_t);
    case TYPE_UINT16:
        DECODE(uint16_t);
    case TYPE_INT32:
        DECODE(int32_t);
    case TYPE_UINT32:
        DECODE(uint32_t);
    case TYPE_INT64:
        DECODE(int64_t);
    case TYPE_UINT64:
        DECODE(uint64_t);
    case TYPE_FLOAT32:
        DECODE(float);
    default:
        DECODE(double);
    }
}

/* ---- numbers ---- */

static pel_status read_text(const vtp_reader *reader, const vtp_array *array, double *values, size_t count)
{
    const char *at = array->text;
    for (size_t i = 0; i < count; i++) {
        while (at < array->end && pel_is_space(*at))
            at++;
        const char *next = pel_number_parse(at, array->end, &values[i]);
        if (next == NULL || (next < array->end && !pel_is_space(*next)))
            return fail_at(reader, at, "an array has fewer numbers than its header says");
        at = next;
    }
    return PEL_OK;
}

static pel_status read_binary(vtp_reader *reader, const vtp_array *array, double *values, size_t count)
{
    unsigned char *bytes;
    size_t width = type_sizes[array->type];
    if (count > SIZE_MAX / sizeof(double))
        return fail_at(reader, place_of(reader, array), "the size of an array differs from that in its header");
    pel_status status = take_bytes(reader, array, count * width, &bytes);
    for (size_t i = 0; status == PEL_OK && i < count; i++) {
        if (reader->swapped)
            pel_swap_bytes(bytes + i * width, width);
        values[i] = decode(bytes + i * width, array->type);
    }
    pel_free(bytes);
    return status;
}

/* whether the file can hold that many numbers, before allocation */
static bool can_hold(const vtp_reader *reader, const vtp_array *array, int64_t tuple_count)
{
    size_t width = (size_t)array->component_count, room = reader->numbers_left;
    if ((size_t)tuple_count > room / width)
        return false;
    size_t count = (size_t)tuple_count * width;
    if (array->form == FORM_ASCII)
        return array->text == NULL ? count == 0 : (size_t)(array->end - array->text) + 1 >= 2 * count;
    if (array->form == FORM_BASE64)
        return array->text != NULL || count == 0;
    return reader->data != NULL && array->offset < reader->data_size;
}

static pel_status take_reals(vtp_reader *reader, const vtp_array *array, int64_t tuple_count, double **values)
{
    *values = NULL;
    if (!can_hold(reader, array, tuple_count))
        return fail_at(reader, place_of(reader, array),
                       "an array has fewer numbers than its header says, or more than fit into the file");
    size_t count = (size_t)tuple_count * (size_t)array->component_count;
    reader->numbers_left -= count;
    double *taken = pel_allocate(count, sizeof *taken);
    if (taken == NULL)
        return pel_fail_memory(reader->error);
    pel_status status = PEL_OK;
    if (count > 0)
        status = array->form == FORM_ASCII ? read_text(reader, array, taken, count)
                                           : read_binary(reader, array, taken, count);
    if (status == PEL_OK)
        *values = taken;
    else
        pel_free(taken);
    return status;
}

static const vtp_array *find_array(const vtp_reader *reader, vtp_section section, const char *name)
{
    for (size_t i = 0; i < reader->array_count; i++)
        if (reader->arrays[i].section == section && (name == NULL || strcmp(reader->arrays[i].name, name) == 0))
            return &reader->arrays[i];
    return NULL;
}

/* ---- faces ---- */

/* the faces of a section: where each ends among the corners */
typedef struct vtp_faces {
    double *ends, *corners;
    int64_t face_count, corner_count;
} vtp_faces;

static void free_faces(vtp_faces *faces)
{
    pel_free(faces->ends);
    pel_free(faces->corners);
}

static pel_status take_faces(vtp_reader *reader, vtp_section section, int64_t face_count, vtp_faces *faces)
{
    *faces = (vtp_faces){.face_count = face_count};
    if (face_count == 0)
        return PEL_OK;
    const vtp_array *corners = find_array(reader, section, "connectivity");
    const vtp_array *ends = find_array(reader, section, "offsets");
    if (corners == NULL || ends == NULL || corners->component_count != 1 || ends->component_count != 1)
        return fail_at(reader, reader->start, "the polygons are missing");
    pel_status status = take_reals(reader, ends, face_count, &faces->ends);
    double before = 0;
    for (int64_t f = 0; status == PEL_OK && f < face_count; f++) {
        double end = faces->ends[f];
        if (!(end >= before && end <= (double)INT32_MAX && end == floor(end)))
            status = fail_at(reader, place_of(reader, ends), "the offsets of the polygons do not increase");
        before = end;
    }
    if (status != PEL_OK)
        return status;
    faces->corner_count = (int64_t)before;
    return take_reals(reader, corners, faces->corner_count, &faces->corners);
}

/* the index of a vertex, or one past the last if invalid */
static int32_t vertex_at(const vtp_reader *reader, const vtp_faces *faces, int64_t i)
{
    double v = faces->corners[i];
    bool valid = v >= 0 && v < (double)reader->vertex_count && v == floor(v);
    return valid ? (int32_t)v : (int32_t)reader->vertex_count;
}

static bool add_polygons(const vtp_reader *reader, const vtp_faces *faces, pel_polygon_soup *soup)
{
    int64_t at = 0;
    for (int64_t f = 0; f < faces->face_count; f++) {
        int64_t begin = at, end = (int64_t)faces->ends[f];
        for (; at < end; at++)
            if (!pel_polygon_soup_add_corner(soup, vertex_at(reader, faces, at), reader->start))
                return false;
        if (!pel_polygon_soup_end_polygon(soup, (size_t)(end - begin)))
            return false;
    }
    return true;
}

/* every corner from the third on makes a triangle with the two before it, the second one turned around */
static bool add_strips(const vtp_reader *reader, const vtp_faces *faces, pel_polygon_soup *soup)
{
    int64_t begin = 0;
    for (int64_t f = 0; f < faces->face_count; f++) {
        int64_t end = (int64_t)faces->ends[f];
        for (int64_t i = begin; i + 2 < end; i++) {
            int64_t odd = (i - begin) % 2;
            const int32_t triangle[3] = {vertex_at(reader, faces, i), vertex_at(reader, faces, i + 1 + odd),
                                         vertex_at(reader, faces, i + 2 - odd)};
            if (!pel_polygon_soup_add_triangle(soup, triangle, reader->start))
                return false;
        }
        begin = end;
    }
    return true;
}

static pel_status fill_soup(vtp_reader *reader, const double *positions, pel_polygon_soup *soup)
{
    vtp_faces polygons = {0}, strips = {0};
    pel_status status = take_faces(reader, SECTION_POLYS, reader->polygon_count, &polygons);
    if (status == PEL_OK)
        status = take_faces(reader, SECTION_STRIPS, reader->strip_count, &strips);
    bool room = status == PEL_OK && pel_polygon_soup_reserve_vertices(soup, (size_t)reader->vertex_count);
    for (int64_t v = 0; room && v < reader->vertex_count; v++)
        room = pel_polygon_soup_add_vertex(soup, positions + 3 * v);
    room = room && add_polygons(reader, &polygons, soup) && add_strips(reader, &strips, soup);
    if (status == PEL_OK && !room)
        status = pel_fail_memory(reader->error);
    free_faces(&polygons);
    free_faces(&strips);
    return status;
}

static pel_status check_positions(const vtp_reader *reader, const vtp_array *points, const double *positions)
{
    for (int64_t i = 0; i < 3 * reader->vertex_count; i++) {
        if (isfinite(positions[i]))
            continue;
        fail_with(reader, place_of(reader, points), "a coordinate is not finite",
                  "write the file again from a mesh without such values");
        pel_fail_element(reader->error, "vertex", i / 3);
        return PEL_BAD_FORMAT;
    }
    return PEL_OK;
}

static pel_status take_mesh(vtp_reader *reader, pel_mesh **mesh)
{
    const vtp_array *points = find_array(reader, SECTION_POINTS, NULL);
    double *positions = NULL;
    if (reader->piece_count == 0 || points == NULL || points->component_count != 3)
        return fail_at(reader, reader->start, "the points are missing");
    pel_polygon_soup soup;
    pel_polygon_soup_init(&soup, 0);
    pel_status status = take_reals(reader, points, reader->vertex_count, &positions);
    if (status == PEL_OK)
        status = check_positions(reader, points, positions);
    if (status == PEL_OK)
        status = fill_soup(reader, positions, &soup);
    const pel_text_cursor file = {
        .name = reader->path, .begin = reader->start, .at = reader->start, .end = reader->end, .binary = true};
    if (status == PEL_OK)
        status = pel_polygon_soup_finish(&soup, &file, reader->log, mesh, reader->error);
    if (status == PEL_OK && reader->other_count > 0)
        pel_log_line(reader->log, "%lld vertices and lines beside the polygons ignored",
                     (long long)reader->other_count);
    pel_polygon_soup_free(&soup);
    pel_free(positions);
    return status;
}

/* points, and cells as faces with their types */
static pel_status take_grid(vtp_reader *reader, pel_vtk_grid *grid)
{
    const vtp_array *points = find_array(reader, SECTION_POINTS, NULL);
    const vtp_array *types = find_array(reader, SECTION_CELLS, "types");
    vtp_faces cells = {0};
    if (reader->piece_count == 0 || points == NULL || points->component_count != 3 || types == NULL ||
        types->component_count != 1)
        return fail_at(reader, reader->start, "the points or the types of the cells are missing");
    pel_status status = take_reals(reader, points, reader->vertex_count, &grid->points);
    if (status == PEL_OK)
        status = check_positions(reader, points, grid->points);
    if (status == PEL_OK)
        status = take_faces(reader, SECTION_CELLS, reader->cell_count, &cells);
    grid->ends = cells.ends;
    grid->corners = cells.corners;
    if (status == PEL_OK)
        status = take_reals(reader, types, reader->cell_count, &grid->types);
    grid->point_count = reader->vertex_count;
    grid->cell_count = reader->cell_count;
    grid->corner_count = cells.corner_count;
    return status;
}

void pel_vtk_grid_free(pel_vtk_grid *grid)
{
    pel_free(grid->points);
    pel_free(grid->corners);
    pel_free(grid->ends);
    pel_free(grid->types);
}

pel_status pel_vtu_read(pel_text_cursor *scan, pel_vtk_grid *grid, pel_error *error)
{
    vtp_reader reader = {.path = scan->name, .error = error, .start = scan->begin, .end = scan->end, .is_grid = true};
    reader.numbers_left = NUMBERS_PER_BYTE * (size_t)(scan->end - scan->begin) + NUMBERS_AT_LEAST;
    *grid = (pel_vtk_grid){0};
    scan->binary = true;
    pel_status status = read_head(&reader);
    if (status == PEL_OK)
        status = take_grid(&reader, grid);
    pel_free(reader.arrays);
    return status;
}

static pel_status take_fields(vtp_reader *reader, pel_mesh *mesh)
{
    pel_status status = PEL_OK;
    for (size_t i = 0; status == PEL_OK && i < reader->array_count; i++) {
        const vtp_array *array = &reader->arrays[i];
        double *values;
        if (array->section != SECTION_POINT_DATA)
            continue;
        status = take_reals(reader, array, reader->vertex_count, &values);
        if (status == PEL_OK)
            status = pel_mesh_add_field(mesh, array->name, array->component_count, values, reader->error);
        pel_free(values);
    }
    return status;
}

static pel_status take_time(vtp_reader *reader, double *time)
{
    const vtp_array *array = find_array(reader, SECTION_FIELD_DATA, "TimeValue");
    double *values;
    *time = 0;
    if (array == NULL)
        return PEL_OK;
    pel_status status = take_reals(reader, array, 1, &values);
    if (status == PEL_OK)
        *time = values[0];
    pel_free(values);
    return status;
}

static pel_status parse(vtp_reader *reader, pel_mesh **mesh, double *time)
{
    double unused;
    size_t size = (size_t)(reader->end - reader->start);
    reader->numbers_left = NUMBERS_PER_BYTE * size + NUMBERS_AT_LEAST;
    *mesh = NULL;
    pel_status status = read_head(reader);
    if (status == PEL_OK)
        status = take_mesh(reader, mesh);
    if (status == PEL_OK)
        status = take_fields(reader, *mesh);
    if (status == PEL_OK)
        status = take_time(reader, time != NULL ? time : &unused);
    if (status != PEL_OK) {
        pel_mesh_destroy(*mesh);
        *mesh = NULL;
    }
    pel_free(reader->arrays);
    return status;
}

pel_status pel_vtp_parse(const char *name, const void *bytes, size_t size, pel_mesh **mesh, double *time,
                         pel_error *error)
{
    PEL_REFUSE_NULL(name, error);
    PEL_REFUSE_NULL(bytes, error);
    PEL_REFUSE_NULL(mesh, error);
    vtp_reader reader = {.path = name, .error = error, .start = bytes, .end = (const char *)bytes + size};
    return parse(&reader, mesh, time);
}

pel_status pel_vtp_read_mesh(pel_text_cursor *scan, const pel_log *log, pel_mesh **mesh, pel_error *error)
{
    vtp_reader reader = {.path = scan->name, .log = log, .error = error, .start = scan->begin, .end = scan->end};
    return parse(&reader, mesh, NULL);
}

bool pel_vtp_matches(const pel_text_cursor *scan)
{
    const char *at = scan->at;
    for (pel_xml_tag tag; pel_xml_next(&at, scan->end, &tag);)
        if (tag.start[0] != '?' && tag.start[0] != '!')
            return pel_xml_is(&tag, "VTKFile");
    return false;
}

pel_status pel_vtp_read(const char *path, pel_mesh **mesh, double *time, pel_error *error)
{
    PEL_REFUSE_NULL(path, error);
    PEL_REFUSE_NULL(mesh, error);
    char *bytes;
    size_t size;
    *mesh = NULL;
    pel_status status = pel_file_read(path, &bytes, &size, error);
    if (status == PEL_OK)
        status = pel_vtp_parse(path, bytes, size, mesh, time, error);
    pel_free(bytes);
    return status;
}
