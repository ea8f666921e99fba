#include "io/bytes.h"
#include "io/ply_header.h"
#include "io/polygon_soup.h"

#include "base/memory.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* where the values of a vertex property go: base[stride * vertex], or nowhere when base is null */
typedef struct sink {
    double *base;
    int32_t stride;
} sink;

typedef struct ply_reader {
    pel_text_cursor *scan;
    pel_ply_header header;
    pel_polygon_soup builder;
    pel_field *fields; /* vertex properties other than x, y, z */
    int32_t field_count;
    int64_t first_bad[PEL_PLY_PROPERTY_LIMIT]; /* (field_count) vertex whose value is not finite; -1 = none */
    sink sinks[PEL_PLY_PROPERTY_LIMIT];        /* of the vertex properties */
    size_t ignored_list_count;                 /* list properties of vertices */
} ply_reader;

static double load_binary(const char *bytes, pel_ply_type type, bool big)
{
    switch (type) {
    case PEL_PLY_INT8:
        return (double)(int8_t)pel_load_bytes(bytes, 1, big);
    case PEL_PLY_UINT8:
        return (double)(uint8_t)pel_load_bytes(bytes, 1, big);
    case PEL_PLY_INT16:
        return (double)(int16_t)pel_load_bytes(bytes, 2, big);
    case PEL_PLY_UINT16:
        return (double)(uint16_t)pel_load_bytes(bytes, 2, big);
    case PEL_PLY_INT32:
        return (double)(int32_t)pel_load_bytes(bytes, 4, big);
    case PEL_PLY_UINT32:
        return (double)(uint32_t)pel_load_bytes(bytes, 4, big);
    case PEL_PLY_FLOAT:
        return pel_load_float(bytes, big);
    default:
        return pel_load_double(bytes, big);
    }
}

/* the next value of either encoding; false if there is none */
static inline bool read_value(ply_reader *reader, pel_ply_type type, double *value)
{
    pel_text_cursor *scan = reader->scan;
    if (reader->header.encoding == PEL_ENCODING_ASCII) {
        pel_text_cursor_skip_spaces(scan);
        return pel_text_cursor_any_number(scan, value);
    }
    const size_t size = pel_ply_type_size(type);
    if ((size_t)(scan->end - scan->at) < size)
        return false;
    *value = load_binary(scan->at, type, reader->header.encoding == PEL_ENCODING_BIG);
    scan->at += size;
    return true;
}

static pel_status fail_value(const ply_reader *reader, const pel_ply_property *property, pel_error *error)
{
    if (reader->header.encoding == PEL_ENCODING_ASCII)
        return pel_text_cursor_fail_number(reader->scan, error, "a number");
    return pel_text_cursor_fail(reader->scan, reader->scan->end, error,
                                "the file seems to be cut off: copy or export it again",
                                "the file ends within property '%s'", property->name);
}

static pel_status read_list_count(ply_reader *reader, const pel_ply_property *property, size_t *count, pel_error *error)
{
    const char *place = reader->scan->at;
    double value;
    if (!read_value(reader, property->count_type, &value))
        return fail_value(reader, property, error);
    /* values take a byte or more each, in either encoding */
    const double room = (double)(reader->scan->end - reader->scan->at);
    if (!(value >= 0 && value <= room && value == floor(value)))
        return pel_text_cursor_fail(reader->scan, place, error, "the file seems to be damaged: copy or export it again",
                                    "list '%s' has %g values, which the rest of the file cannot hold", property->name,
                                    value);
    *count = (size_t)value;
    return PEL_OK;
}

static pel_status skip_values(ply_reader *reader, const pel_ply_property *property, size_t count, pel_error *error)
{
    pel_text_cursor *scan = reader->scan;
    if (reader->header.encoding != PEL_ENCODING_ASCII) {
        const size_t size = pel_ply_type_size(property->type);
        if ((size_t)(scan->end - scan->at) / size < count)
            return fail_value(reader, property, error);
        scan->at += count * size;
        return PEL_OK;
    }
    for (size_t i = 0; i < count; i++) {
        double value;
        if (!read_value(reader, property->type, &value))
            return fail_value(reader, property, error);
    }
    return PEL_OK;
}

/* skips one value or list */
static pel_status skip_property(ply_reader *reader, const pel_ply_property *property, pel_error *error)
{
    size_t count = 1;
    pel_status status = PEL_OK;
    if (property->is_list)
        status = read_list_count(reader, property, &count, error);
    return status == PEL_OK ? skip_values(reader, property, count, error) : status;
}

/* refuses a count that the rest of the file cannot hold, before anything is allocated for it */
static pel_status check_element_count(const ply_reader *reader, const pel_ply_element *element, pel_error *error)
{
    const bool ascii = reader->header.encoding == PEL_ENCODING_ASCII;
    int64_t smallest = 0, room = reader->scan->end - reader->scan->at;
    for (int i = 0; i < element->property_count; i++) {
        const pel_ply_property *property = &reader->header.properties[element->first_property + i];
        pel_ply_type first = property->is_list ? property->count_type : property->type;
        smallest += ascii ? 2 : (int64_t)pel_ply_type_size(first);
    }
    /* a number and a blank each; the last blank may be missing */
    room += ascii;
    if (smallest == 0 || element->count <= room / smallest)
        return PEL_OK;
    return pel_text_cursor_fail(reader->scan, ascii ? element->place : reader->scan->end, error,
                                "the file seems to be cut off: copy or export it again",
                                "the header promises %lld elements '%s', more than the file holds",
                                (long long)element->count, element->name);
}

/* Length of the stem when the properties from here on are stem_0, stem_1, ... (two or more), and how many; else 0.
   A property or list that has the stem as its whole name keeps them apart. */
static size_t find_vector(const ply_reader *reader, const pel_ply_element *element, int first, int32_t *count)
{
    const pel_ply_property *properties = &reader->header.properties[element->first_property];
    const char *name = properties[first].name;
    const size_t length = strlen(name);
    char stem[PEL_NAME_SIZE], wanted[PEL_NAME_SIZE + 16];
    *count = 1;
    if (length < 3 || strcmp(name + length - 2, "_0") != 0)
        return 0;
    snprintf(stem, sizeof stem, "%.*s", (int)length - 2, name);
    if (pel_ply_find_property(&reader->header, element, stem) != NULL)
        return 0;
    while (first + *count < element->property_count) {
        snprintf(wanted, sizeof wanted, "%s_%d", stem, (int)*count);
        const pel_ply_property *next = &properties[first + *count];
        if (next->is_list || strcmp(next->name, wanted) != 0)
            break;
        ++*count;
    }
    return *count > 1 ? length - 2 : 0;
}

/* a field for the scalar property, or for the vector that begins with it; returns its number of components, 0 = failed
 */
static int32_t add_field(ply_reader *reader, const pel_ply_element *element, int first)
{
    int32_t component_count;
    size_t stem = find_vector(reader, element, first, &component_count);
    pel_field *field = &reader->fields[reader->field_count];
    field->values = pel_allocate((size_t)element->count * (size_t)component_count, sizeof *field->values);
    if (field->values == NULL)
        return 0;
    const char *name = reader->header.properties[element->first_property + first].name;
    snprintf(field->name, sizeof field->name, "%.*s", (int)(stem > 0 ? stem : strlen(name)), name);
    field->component_count = component_count;
    reader->first_bad[reader->field_count++] = -1;
    for (int32_t i = 0; i < component_count; i++)
        reader->sinks[first + i] = (sink){field->values + i, component_count};
    return component_count;
}

/* the axis of a property name, -1 = none */
static int axis_of(const char *name)
{
    return name[0] >= 'x' && name[0] <= 'z' && name[1] == '\0' ? name[0] - 'x' : -1;
}

static pel_status prepare_vertices(ply_reader *reader, const pel_ply_element *element, pel_error *error)
{
    const pel_ply_property *properties = &reader->header.properties[element->first_property];
    int axis_count = 0;
    for (int i = 0; i < element->property_count; i++)
        axis_count += axis_of(properties[i].name) >= 0 && !properties[i].is_list;
    if (axis_count != 3)
        return pel_text_cursor_fail(reader->scan, element->place, error, "add the missing property",
                                    "vertices have no properties x, y and z");
    reader->fields = pel_allocate((size_t)element->property_count, sizeof *reader->fields);
    if (reader->fields == NULL || !pel_polygon_soup_reserve_vertices(&reader->builder, (size_t)element->count))
        return pel_fail_memory(error);
    for (int i = 0; i < element->property_count;) {
        int axis = axis_of(properties[i].name);
        int32_t taken = 1;
        if (properties[i].is_list)
            reader->ignored_list_count++;
        else if (axis >= 0)
            reader->sinks[i] = (sink){&reader->builder.positions[0][axis], 3};
        else
            taken = add_field(reader, element, i);
        if (taken == 0)
            return pel_fail_memory(error);
        i += taken;
    }
    return PEL_OK;
}

/* discards the field of this sink, from its first invalid value */
static void note_bad(ply_reader *reader, const double *base, int64_t v)
{
    for (int32_t f = 0; f < reader->field_count; f++) {
        const pel_field *field = &reader->fields[f];
        if (base >= field->values && base < field->values + field->component_count && reader->first_bad[f] < 0)
            reader->first_bad[f] = v;
    }
}

/* fields with NaN or infinities serve nobody, and their mesh may serve without them */
static void drop_bad_fields(ply_reader *reader, const pel_log *log)
{
    int32_t kept = 0;
    for (int32_t f = 0; f < reader->field_count; f++) {
        pel_field *field = &reader->fields[f];
        if (reader->first_bad[f] < 0) {
            reader->fields[kept++] = *field;
            continue;
        }
        pel_log_line(log, "field '%s' is left out: it is not finite at vertex %lld", field->name,
                     (long long)reader->first_bad[f]);
        pel_free(field->values);
    }
    reader->field_count = kept;
}

static pel_status read_vertex(ply_reader *reader, const pel_ply_element *element, int64_t v, pel_error *error)
{
    const pel_ply_property *properties = &reader->header.properties[element->first_property];
    for (int i = 0; i < element->property_count; i++) {
        const sink *to = &reader->sinks[i];
        if (to->base == NULL) {
            pel_status status = skip_property(reader, &properties[i], error);
            if (status != PEL_OK)
                return status;
            continue;
        }
        const char *place = reader->scan->at;
        double value;
        if (!read_value(reader, properties[i].type, &value))
            return fail_value(reader, &properties[i], error);
        if (!isfinite(value) && axis_of(properties[i].name) < 0) {
            note_bad(reader, to->base, v);
            continue;
        }
        if (!isfinite(value))
            return pel_text_cursor_fail(reader->scan, place, error, "repair the mesh in the program that wrote it",
                                        "property '%s' of vertex %lld is %g", properties[i].name, (long long)v, value);
        to->base[to->stride * v] = value;
    }
    return PEL_OK;
}

static pel_status read_vertices(ply_reader *reader, const pel_ply_element *element, pel_error *error)
{
    pel_status status = prepare_vertices(reader, element, error);
    for (int64_t v = 0; v < element->count && status == PEL_OK; v++)
        status = read_vertex(reader, element, v, error);
    reader->builder.vertex_count = status == PEL_OK ? (size_t)element->count : 0;
    return status;
}

/* The face that nearly all files have, a byte 3 and three 32-bit indices, in one go (this halves the time of reading).
   False when it is anything else. */
static bool load_triangle(ply_reader *reader, const pel_ply_property *property, int32_t vertices[3])
{
    pel_text_cursor *scan = reader->scan;
    if (reader->header.encoding == PEL_ENCODING_ASCII || pel_ply_type_size(property->count_type) != 1 ||
        (property->type != PEL_PLY_INT32 && property->type != PEL_PLY_UINT32) || scan->end - scan->at < 13 ||
        *scan->at != 3)
        return false;
    for (int i = 0; i < 3; i++) {
        uint64_t vertex = pel_load_bytes(scan->at + 1 + 4 * i, 4, reader->header.encoding == PEL_ENCODING_BIG);
        if (vertex >= INT32_MAX)
            return false;
        vertices[i] = (int32_t)vertex;
    }
    scan->at += 13;
    return true;
}

static bool is_index(double value)
{
    return value >= 0 && value < INT32_MAX && value == floor(value);
}

static pel_status fail_index(const ply_reader *reader, const char *place, double value, pel_error *error)
{
    return pel_text_cursor_fail(reader->scan, place, error, "correct the index", "%g is not a vertex index", value);
}

static pel_status read_corners(ply_reader *reader, const pel_ply_property *property, pel_error *error)
{
    size_t count = 0;
    int32_t triangle[3];
    const char *start = reader->scan->at;
    if (load_triangle(reader, property, triangle))
        return pel_polygon_soup_add_triangle(&reader->builder, triangle, start) ? PEL_OK : pel_fail_memory(error);
    pel_status status = read_list_count(reader, property, &count, error);
    for (size_t i = 0; i < count && status == PEL_OK; i++) {
        const char *place = reader->scan->at;
        double value;
        if (!read_value(reader, property->type, &value))
            return fail_value(reader, property, error);
        if (!is_index(value))
            return fail_index(reader, place, value, error);
        if (!pel_polygon_soup_add_corner(&reader->builder, (int32_t)value, place))
            return pel_fail_memory(error);
    }
    if (status == PEL_OK && !pel_polygon_soup_end_polygon(&reader->builder, count))
        status = pel_fail_memory(error);
    return status;
}

/* one list of a tristrip: each index makes a triangle with the two before it, whose winding alternates; -1 begins a new
   strip, and triangles with a vertex twice only lead to the next one */
static pel_status read_strip(ply_reader *reader, const pel_ply_property *property, pel_error *error)
{
    size_t count = 0, in_strip = 0;
    int32_t before[2] = {0};
    pel_status status = read_list_count(reader, property, &count, error);
    for (size_t i = 0; i < count && status == PEL_OK; i++) {
        const char *place = reader->scan->at;
        double value;
        if (!read_value(reader, property->type, &value))
            return fail_value(reader, property, error);
        if (value == -1 || value == (double)UINT32_MAX) {
            in_strip = 0;
            continue;
        }
        if (!is_index(value))
            return fail_index(reader, place, value, error);
        const int32_t last = (int32_t)value;
        const bool turned = in_strip % 2 == 1;
        const int32_t triangle[3] = {before[turned], before[!turned], last};
        if (in_strip >= 2 && before[0] != before[1] && before[0] != last && before[1] != last &&
            !pel_polygon_soup_add_triangle(&reader->builder, triangle, place))
            return pel_fail_memory(error);
        before[0] = before[1];
        before[1] = last;
        in_strip++;
    }
    return status;
}

/* the property of an element with the vertices of its polygons or strips; null with the error */
static const pel_ply_property *find_corners(const ply_reader *reader, const pel_ply_element *element, pel_error *error)
{
    const pel_ply_property *corners = pel_ply_find_property(&reader->header, element, "vertex_indices");
    if (corners == NULL)
        corners = pel_ply_find_property(&reader->header, element, "vertex_index");
    if (corners != NULL && corners->is_list)
        return corners;
    pel_text_cursor_fail(reader->scan, element->place, error, "add the property",
                         "%s have no list property vertex_indices",
                         strcmp(element->name, "face") == 0 ? "faces" : element->name);
    return NULL;
}

/* faces, or with `take` read_strip strips of triangles */
static pel_status read_polygons(ply_reader *reader, const pel_ply_element *element,
                                pel_status (*take)(ply_reader *, const pel_ply_property *, pel_error *),
                                pel_error *error)
{
    const pel_ply_property *properties = &reader->header.properties[element->first_property];
    const pel_ply_property *corners = find_corners(reader, element, error);
    if (corners == NULL)
        return PEL_BAD_FORMAT;
    pel_status status = PEL_OK;
    for (int64_t f = 0; f < element->count && status == PEL_OK; f++)
        for (int i = 0; i < element->property_count && status == PEL_OK; i++)
            status =
                &properties[i] == corners ? take(reader, corners, error) : skip_property(reader, &properties[i], error);
    return status;
}

static pel_status skip_element(ply_reader *reader, const pel_ply_element *element, pel_error *error)
{
    const pel_ply_property *properties = &reader->header.properties[element->first_property];
    pel_status status = PEL_OK;
    for (int64_t e = 0; element->property_count > 0 && e < element->count && status == PEL_OK; e++)
        for (int i = 0; i < element->property_count && status == PEL_OK; i++)
            status = skip_property(reader, &properties[i], error);
    return status;
}

/* the elements in the order of the file; elements after vertices, faces and strips are not read */
static pel_status read_body(ply_reader *reader, pel_error *error)
{
    const pel_ply_header *header = &reader->header;
    const pel_ply_element *vertices = pel_ply_find_element(header, "vertex");
    const pel_ply_element *faces = pel_ply_find_element(header, "face");
    const pel_ply_element *strips = pel_ply_find_element(header, "tristrips");
    if (vertices == NULL || vertices->count == 0)
        return pel_text_cursor_fail(reader->scan, reader->scan->begin, error, "export the mesh again",
                                    "the header promises no vertices");
    const pel_ply_element *last = faces != NULL && faces > vertices ? faces : vertices;
    last = strips != NULL && strips > last ? strips : last;
    reader->scan->binary = header->encoding != PEL_ENCODING_ASCII;
    pel_status status = PEL_OK;
    for (const pel_ply_element *element = header->elements; element <= last && status == PEL_OK; element++) {
        status = check_element_count(reader, element, error);
        if (status != PEL_OK)
            return status;
        if (element == vertices)
            status = read_vertices(reader, element, error);
        else if (element == faces)
            status = read_polygons(reader, element, read_corners, error);
        else if (element == strips)
            status = read_polygons(reader, element, read_strip, error);
        else
            status = skip_element(reader, element, error);
    }
    return status;
}

static pel_status finish(ply_reader *reader, const pel_log *log, pel_mesh **mesh, pel_error *error)
{
    if (reader->ignored_list_count > 0)
        pel_log_line(log, "%zu list properties of vertices ignored", reader->ignored_list_count);
    drop_bad_fields(reader, log);
    pel_status status = pel_polygon_soup_finish(&reader->builder, reader->scan, log, mesh, error);
    if (status != PEL_OK || reader->field_count == 0)
        return status;
    (*mesh)->fields = reader->fields;
    (*mesh)->field_count = reader->field_count;
    reader->fields = NULL;
    reader->field_count = 0;
    return PEL_OK;
}

static void free_reader(ply_reader *reader)
{
    for (int32_t f = 0; f < reader->field_count; f++)
        pel_free(reader->fields[f].values);
    pel_free(reader->fields);
    pel_polygon_soup_free(&reader->builder);
    pel_free(reader);
}

pel_status pel_ply_read(pel_text_cursor *scan, const pel_log *log, pel_mesh **mesh, pel_error *error)
{
    ply_reader *reader = pel_allocate(1, sizeof *reader);
    if (reader == NULL)
        return pel_fail_memory(error);
    reader->scan = scan;
    pel_polygon_soup_init(&reader->builder, 0);
    pel_status status = pel_ply_read_header(scan, &reader->header, error);
    if (status == PEL_OK)
        status = read_body(reader, error);
    if (status == PEL_OK)
        status = finish(reader, log, mesh, error);
    free_reader(reader);
    return status;
}
