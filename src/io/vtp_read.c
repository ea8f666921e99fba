/* Reads what vtp.c writes, and what VTK and ParaView write in the same way: PolyData of one piece, triangles only, raw
   appended arrays, packed by zlib or not. The head of the file is read tag by tag into a list of arrays, then each
   array that is wanted is taken out of the appended section. All sizes are checked against the bytes that are there
   before memory is asked for, and no byte of the section may be used by two arrays: memory is bounded by the file. */
#include "pellicle/results.h"

#include "base/memory.h"
#include "base/status.h"
#include "io/byte_order.h"
#include "io/file.h"
#include "io/vtk_blocks.h"
#include "io/xml.h"

#include <stdio.h>
#include <string.h>

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
    SECTION_POLYS
} vtp_section;

typedef struct vtp_array {
    vtp_section section;
    value_type type;
    int32_t component_count;
    size_t offset; /* in the appended section */
    char name[PEL_NAME_SIZE];
} vtp_array;

typedef struct vtp_reader {
    const char *path;
    pel_error *error;
    const char *start, *end;   /* the whole file */
    const unsigned char *data; /* the appended section */
    size_t data_size;
    size_t unused; /* bytes of it that no array took */
    bool packed;
    size_t word_size;
    int64_t vertex_count, triangle_count, piece_count;
    vtp_array *arrays;
    size_t array_count, array_capacity;
} vtp_reader;

static pel_status fail_at(const vtp_reader *reader, const void *at, const char *what)
{
    pel_fail(reader->error, PEL_BAD_FORMAT, "%s", what);
    pel_fail_remedy(reader->error, "only whole VTK PolyData files of one piece with triangles and raw appended data "
                                   "are read; write the file again");
    pel_fail_offset(reader->error, reader->path, (const char *)at - reader->start);
    return PEL_BAD_FORMAT;
}

static pel_status read_file_tag(vtp_reader *reader, const pel_xml_tag *tag)
{
    char text[64];
    if (!pel_xml_attribute(tag, "type", text, sizeof text) || strcmp(text, "PolyData") != 0)
        return fail_at(reader, tag->start, "this is no VTK PolyData file");
    if (pel_xml_attribute(tag, "byte_order", text, sizeof text) && strcmp(text, PEL_BYTE_ORDER_NAME) != 0)
        return fail_at(reader, tag->start, "the byte order is not that of this machine");
    reader->packed = pel_xml_attribute(tag, "compressor", text, sizeof text);
    if (reader->packed && strcmp(text, "vtkZLibDataCompressor") != 0)
        return fail_at(reader, tag->start, "the data is not packed by zlib");
    bool wide = pel_xml_attribute(tag, "header_type", text, sizeof text) && strcmp(text, "UInt64") == 0;
    reader->word_size = wide ? sizeof(uint64_t) : sizeof(uint32_t);
    return PEL_OK;
}

static pel_status read_piece_tag(vtp_reader *reader, const pel_xml_tag *tag)
{
    static const char *const absent[3] = {"NumberOfVerts", "NumberOfLines", "NumberOfStrips"};
    int64_t count;
    if (!pel_xml_count(tag, "NumberOfPoints", &reader->vertex_count) ||
        !pel_xml_count(tag, "NumberOfPolys", &reader->triangle_count) || reader->vertex_count < 1 ||
        reader->triangle_count < 1 || reader->vertex_count > INT32_MAX || reader->triangle_count > INT32_MAX / 3)
        return fail_at(reader, tag->start, "the number of points or polygons is missing or out of range");
    for (int i = 0; i < 3; i++)
        if (pel_xml_count(tag, absent[i], &count) && count != 0)
            return fail_at(reader, tag->start, "there are vertices, lines or strips beside the polygons");
    if (++reader->piece_count > 1)
        return fail_at(reader, tag->start, "there is more than one piece");
    return PEL_OK;
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
    if (!pel_xml_attribute(tag, "Name", array.name, sizeof array.name) || array.name[0] == '\0')
        return fail_at(reader, tag->start, "an array has no name or a very long one");
    if (pel_xml_count(tag, "NumberOfComponents", &count)) {
        if (count < 1 || count > INT16_MAX)
            return fail_at(reader, tag->start, "an array has no components or very many");
        array.component_count = (int32_t)count;
    }
    pel_xml_attribute(tag, "format", text, sizeof text);
    if (strcmp(text, "appended") != 0 || !pel_xml_count(tag, "offset", &count))
        return fail_at(reader, tag->start, "an array is not in the appended section");
    array.offset = (size_t)count;
    void *arrays = reader->arrays;
    if (!pel_reserve(&arrays, &reader->array_capacity, reader->array_count + 1, sizeof array))
        return pel_fail_memory(reader->error);
    reader->arrays = arrays;
    reader->arrays[reader->array_count++] = array;
    return PEL_OK;
}

/* the section after a tag, which may begin or end one */
static vtp_section section_after(const pel_xml_tag *tag, vtp_section present)
{
    static const char *const ends[] = {"", "/FieldData", "/PointData", "/Points", "/Polys"};
    bool empty = tag->end > tag->start && tag->end[-1] == '/';
    for (int i = SECTION_FIELD_DATA; i <= SECTION_POLYS; i++) {
        if (pel_xml_is(tag, ends[i]))
            return SECTION_NONE;
        if (pel_xml_is(tag, ends[i] + 1))
            return empty ? SECTION_NONE : (vtp_section)i;
    }
    return present;
}

/* arrays that only describe the file are left alone */
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
    if (!pel_xml_attribute(tag, "encoding", text, sizeof text) || strcmp(text, "raw") != 0)
        return fail_at(reader, tag->start, "the appended section is not raw");
    const char *end = reader->end;
    while (end > at && (end[-1] == '\n' || end[-1] == '\r' || end[-1] == ' '))
        end--;
    if (end - at < (ptrdiff_t)strlen(last) || memcmp(end - strlen(last), last, strlen(last)) != 0)
        return fail_at(reader, end, "the file is cut off");
    const char *mark = memchr(at, '_', (size_t)(end - at));
    if (mark == NULL)
        return fail_at(reader, at, "the appended section is missing");
    reader->data = (const unsigned char *)mark + 1;
    reader->data_size = (size_t)(end - mark - 1);
    reader->unused = reader->data_size;
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
        else if (pel_xml_is(&tag, "AppendedData"))
            return find_data(reader, &tag, at);
    }
    if (status != PEL_OK)
        return status;
    return fail_at(reader, at, reader->word_size == 0 ? "this is no VTK file" : "the appended section is missing");
}

/* the values of an array (count tuples) as bytes in a new block */
static pel_status take_bytes(vtp_reader *reader, const vtp_array *array, int64_t tuple_count, unsigned char **bytes)
{
    size_t size = (size_t)tuple_count * (size_t)array->component_count * type_sizes[array->type], used = 0;
    *bytes = NULL;
    if (array->offset >= reader->data_size)
        return fail_at(reader, reader->data, "an array lies outside the appended section");
    const unsigned char *at = reader->data + array->offset;
    size_t available = reader->data_size - array->offset;
    if (reader->packed)
        used = pel_vtk_blocks_check(at, available, reader->word_size, size);
    else if (available >= reader->word_size && size <= available - reader->word_size &&
             pel_vtk_blocks_word(at, reader->word_size) == size)
        used = reader->word_size + size;
    if (used == 0 || used > reader->unused)
        return fail_at(reader, at, "an array has not the size that its head tells");
    reader->unused -= used;
    *bytes = pel_allocate(size, 1);
    if (*bytes == NULL)
        return pel_fail_memory(reader->error);
    if (!reader->packed) {
        memcpy(*bytes, at + reader->word_size, size);
        return PEL_OK;
    }
    pel_status status = pel_vtk_blocks_unpack(at, reader->word_size, *bytes, size, reader->error);
    return status == PEL_BAD_FORMAT ? fail_at(reader, at, "a packed array is damaged") : status;
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

static pel_status take_reals(vtp_reader *reader, const vtp_array *array, int64_t tuple_count, double **values)
{
    unsigned char *bytes;
    *values = NULL;
    pel_status status = take_bytes(reader, array, tuple_count, &bytes);
    if (status == PEL_OK) {
        size_t count = (size_t)tuple_count * (size_t)array->component_count;
        *values = pel_allocate(count, sizeof **values);
        if (*values == NULL)
            status = pel_fail_memory(reader->error);
        for (size_t i = 0; status == PEL_OK && i < count; i++)
            (*values)[i] = decode(bytes + i * type_sizes[array->type], array->type);
    }
    pel_free(bytes);
    return status;
}

static const vtp_array *find_array(const vtp_reader *reader, vtp_section section, const char *name)
{
    for (size_t i = 0; i < reader->array_count; i++)
        if (reader->arrays[i].section == section && (name == NULL || strcmp(reader->arrays[i].name, name) == 0))
            return &reader->arrays[i];
    return NULL;
}

static pel_status take_triangles(vtp_reader *reader, int32_t **triangles)
{
    const vtp_array *corners = find_array(reader, SECTION_POLYS, "connectivity");
    const vtp_array *ends = find_array(reader, SECTION_POLYS, "offsets");
    double *values = NULL, *end_values = NULL;
    *triangles = NULL;
    if (corners == NULL || ends == NULL || corners->component_count != 1 || ends->component_count != 1)
        return fail_at(reader, reader->data, "the polygons are missing");
    size_t triangle_count = (size_t)reader->triangle_count;
    pel_status status = take_reals(reader, ends, reader->triangle_count, &end_values);
    for (size_t t = 0; status == PEL_OK && t < triangle_count; t++)
        if (end_values[t] != 3 * ((double)t + 1))
            status = fail_at(reader, reader->data, "there are polygons that are no triangles");
    if (status == PEL_OK)
        status = take_reals(reader, corners, 3 * reader->triangle_count, &values);
    if (status == PEL_OK && (*triangles = pel_allocate(3 * triangle_count, sizeof **triangles)) == NULL)
        status = pel_fail_memory(reader->error);
    for (size_t i = 0; status == PEL_OK && i < 3 * triangle_count; i++) {
        bool valid = values[i] >= 0 && values[i] < (double)reader->vertex_count;
        (*triangles)[i] = valid ? (int32_t)values[i] : -1;
    }
    pel_free(values);
    pel_free(end_values);
    return status;
}

static pel_status take_mesh(vtp_reader *reader, pel_mesh **mesh)
{
    const vtp_array *points = find_array(reader, SECTION_POINTS, NULL);
    double *positions = NULL;
    int32_t *triangles = NULL;
    if (reader->piece_count == 0 || points == NULL || points->component_count != 3)
        return fail_at(reader, reader->data, "the points are missing");
    pel_status status = take_reals(reader, points, reader->vertex_count, &positions);
    if (status == PEL_OK)
        status = take_triangles(reader, &triangles);
    if (status == PEL_OK)
        status = pel_mesh_create(positions, (int32_t)reader->vertex_count, triangles, (int32_t)reader->triangle_count,
                                 mesh, reader->error);
    if (status == PEL_BAD_ARGUMENT) {
        status = PEL_BAD_FORMAT;
        if (reader->error != NULL)
            reader->error->status = status;
        pel_fail_place(reader->error, reader->path, 0, 0);
        pel_fail_remedy(reader->error, "write the file again from a mesh without such values");
    }
    pel_free(triangles);
    pel_free(positions);
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

pel_status pel_vtp_parse(const char *name, const void *bytes, size_t size, pel_mesh **mesh, double *time,
                         pel_error *error)
{
    double unused;
    vtp_reader reader = {.path = name, .error = error, .start = bytes, .end = (const char *)bytes + size};
    *mesh = NULL;
    pel_status status = read_head(&reader);
    if (status == PEL_OK)
        status = take_mesh(&reader, mesh);
    if (status == PEL_OK)
        status = take_fields(&reader, *mesh);
    if (status == PEL_OK)
        status = take_time(&reader, time != NULL ? time : &unused);
    if (status != PEL_OK) {
        pel_mesh_destroy(*mesh);
        *mesh = NULL;
    }
    pel_free(reader.arrays);
    return status;
}

pel_status pel_vtp_read(const char *path, pel_mesh **mesh, double *time, pel_error *error)
{
    char *bytes;
    size_t size;
    *mesh = NULL;
    pel_status status = pel_file_read(path, &bytes, &size, error);
    if (status == PEL_OK)
        status = pel_vtp_parse(path, bytes, size, mesh, time, error);
    pel_free(bytes);
    return status;
}
