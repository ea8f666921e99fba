/* VTK XML PolyData with all arrays in one appended section:

       <VTKFile> <PolyData> <FieldData/> <Piece> <PointData/> <CellData/> <Points/> <Polys/> </Piece> </PolyData>
       <AppendedData encoding="raw"> _ array array ... </AppendedData> </VTKFile>

   A raw array is a word of 8 bytes with its size, then its bytes; vtk_blocks.h describes packed ones. The arrays are
   laid out in memory first, because the head of the file has their offsets, and then written at once. The triangles
   come last, in a separate block that is reused for the next file if they are the same. Format: Kitware, "VTK XML file
   formats". */
#include "pellicle/results.h"

#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "io/byte_order.h"
#include "io/file.h"
#include "io/vtk_blocks.h"
#include "io/xml.h"

#include <string.h>

/* one array of the file; neither reals nor indices: the ends of the triangles, 3, 6, 9, ... */
typedef struct vtp_array {
    const char *name;
    const double *reals;
    const int32_t *indices;
    size_t tuple_count, component_count;
    bool float64;
    size_t offset; /* in the appended section */
} vtp_array;

/* bytes of the appended section */
typedef struct vtp_section {
    void *bytes;
    size_t size, room;
} vtp_section;

struct pel_vtp_writer {
    /* all arrays of a file in their order: time, fields, points, connectivity, ends */
    void *array_block;
    size_t array_room, array_count;
    vtp_section numbers; /* up to the points */
    vtp_section surface; /* connectivity and ends */
    vtp_section scratch; /* an array before it is packed */
    /* content of the surface section */
    int32_t *triangles; /* (triangle_count x 3); null = nothing */
    int32_t triangle_count;
    bool packed;
    size_t ends_offset; /* in the section */
};

enum { TIME, FIELDS };

/* fields of vertices, then of triangles */
static const pel_vtp_field *field_at(const pel_vtp *vtp, int32_t f)
{
    return f < vtp->field_count ? &vtp->fields[f] : &vtp->cell_fields[f - vtp->field_count];
}

static pel_status check_arguments(const pel_vtp *vtp, pel_error *error)
{
    if (vtp->vertex_count < 1 || vtp->triangle_count < 1 || vtp->triangle_count > INT32_MAX / 3 ||
        vtp->field_count < 0 || vtp->cell_field_count < 0)
        return pel_fail(error, PEL_BAD_ARGUMENT, "%d vertices, %d triangles and %d fields cannot be written",
                        (int)vtp->vertex_count, (int)vtp->triangle_count, (int)vtp->field_count);
    PEL_REFUSE_NULL(vtp->positions, error);
    PEL_REFUSE_NULL(vtp->triangles, error);
    if (vtp->field_count > 0)
        PEL_REFUSE_NULL(vtp->fields, error);
    if (vtp->cell_field_count > 0)
        PEL_REFUSE_NULL(vtp->cell_fields, error);
    for (size_t i = 0; i < 3 * (size_t)vtp->triangle_count; i++)
        if (vtp->triangles[i] < 0 || vtp->triangles[i] >= vtp->vertex_count) {
            pel_fail(error, PEL_BAD_ARGUMENT, "vertex index %d is outside 0..%d", (int)vtp->triangles[i],
                     (int)vtp->vertex_count - 1);
            pel_fail_element(error, "triangle", (int64_t)(i / 3));
            return PEL_BAD_ARGUMENT;
        }
    for (int32_t f = 0; f < vtp->field_count + vtp->cell_field_count; f++) {
        const pel_vtp_field *field = field_at(vtp, f);
        PEL_REFUSE_NULL(field->name, error);
        PEL_REFUSE_NULL(field->values, error);
        if (field->component_count < 1 || field->name[0] == '\0' || strlen(field->name) >= PEL_NAME_SIZE)
            return pel_fail(error, PEL_BAD_ARGUMENT,
                            "field name '%s' is empty or longer than %d characters, or it has no components",
                            field->name, PEL_NAME_SIZE - 1);
    }
    return PEL_OK;
}

static vtp_array *arrays_of(const pel_vtp_writer *writer)
{
    return writer->array_block;
}

static pel_status list_arrays(pel_vtp_writer *writer, const pel_vtp *vtp, pel_error *error)
{
    size_t vertex_count = (size_t)vtp->vertex_count, triangle_count = (size_t)vtp->triangle_count;
    int32_t field_count = vtp->field_count + vtp->cell_field_count;
    writer->array_count = (size_t)field_count + 4;
    if (!pel_reserve(&writer->array_block, &writer->array_room, writer->array_count, sizeof(vtp_array)))
        return pel_fail_memory(error);
    vtp_array *next = arrays_of(writer);
    *next++ = (vtp_array){"TimeValue", &vtp->time, NULL, 1, 1, true, 0};
    for (int32_t f = 0; f < field_count; f++) {
        const pel_vtp_field *field = field_at(vtp, f);
        size_t count = f < vtp->field_count ? vertex_count : triangle_count;
        *next++ = (vtp_array){field->name, field->values, NULL, count, (size_t)field->component_count, vtp->float64, 0};
    }
    *next++ = (vtp_array){"Points", vtp->positions, NULL, vertex_count, 3, vtp->float64, 0};
    *next++ = (vtp_array){"connectivity", NULL, vtp->triangles, 3 * triangle_count, 1, false, 0};
    *next++ = (vtp_array){"offsets", NULL, NULL, triangle_count, 1, false, 0};
    return PEL_OK;
}

static size_t array_size(const vtp_array *array)
{
    size_t value_size = array->reals != NULL && array->float64 ? sizeof(double) : sizeof(float);
    return array->tuple_count * array->component_count * value_size;
}

static bool grow(vtp_section *section, size_t size)
{
    return pel_reserve(&section->bytes, &section->room, size, 1);
}

/* the array's bytes as in the file, or before packing */
static void encode(const vtp_array *array, unsigned char *out)
{
    size_t count = array->tuple_count * array->component_count;
    if (array->indices != NULL) {
        memcpy(out, array->indices, count * sizeof(int32_t));
    } else if (array->reals == NULL) {
        for (size_t i = 0; i < count; i++) {
            int32_t end = 3 * (int32_t)(i + 1);
            memcpy(out + i * sizeof end, &end, sizeof end);
        }
    } else if (array->float64) {
        memcpy(out, array->reals, count * sizeof(double));
    } else {
        for (size_t i = 0; i < count; i++) {
            float value = (float)array->reals[i];
            memcpy(out + i * sizeof value, &value, sizeof value);
        }
    }
}

/* encodes and packs an array at the end of a section */
static pel_status append_array(pel_vtp_writer *writer, vtp_section *section, vtp_array *array, bool compress,
                               pel_error *error)
{
    size_t size = array_size(array);
    const uint64_t head = size;
    array->offset = section->size;
    if (!grow(section, section->size + (compress ? pel_vtk_blocks_bound(size) : sizeof head + size)) ||
        (compress && !grow(&writer->scratch, size)))
        return pel_fail_memory(error);
    unsigned char *out = (unsigned char *)section->bytes + section->size;
    size_t used = sizeof head + size;
    pel_status status = PEL_OK;
    if (compress) {
        encode(array, writer->scratch.bytes);
        status = pel_vtk_blocks_pack(writer->scratch.bytes, size, out, &used, error);
    } else {
        memcpy(out, &head, sizeof head);
        encode(array, out + sizeof head);
    }
    if (status == PEL_OK)
        section->size += used;
    return status;
}

static bool has_surface(const pel_vtp_writer *writer, const pel_vtp *vtp)
{
    return writer->triangles != NULL && writer->packed == vtp->compress &&
           writer->triangle_count == vtp->triangle_count &&
           memcmp(writer->triangles, vtp->triangles, 3 * (size_t)vtp->triangle_count * sizeof *vtp->triangles) == 0;
}

/* fills the surface section, and records its content only once it is complete */
static pel_status append_surface(pel_vtp_writer *writer, const pel_vtp *vtp, pel_error *error)
{
    vtp_array *connectivity = arrays_of(writer) + writer->array_count - 2, *ends = connectivity + 1;
    pel_free(writer->triangles);
    writer->triangles = NULL;
    writer->surface.size = 0;
    pel_status status = append_array(writer, &writer->surface, connectivity, vtp->compress, error);
    if (status == PEL_OK)
        status = append_array(writer, &writer->surface, ends, vtp->compress, error);
    if (status != PEL_OK)
        return status;
    size_t count = 3 * (size_t)vtp->triangle_count;
    writer->ends_offset = ends->offset;
    writer->triangle_count = vtp->triangle_count;
    writer->packed = vtp->compress;
    writer->triangles = pel_allocate(count, sizeof *writer->triangles);
    if (writer->triangles == NULL)
        return pel_fail_memory(error);
    memcpy(writer->triangles, vtp->triangles, count * sizeof *writer->triangles);
    return PEL_OK;
}

static pel_status lay_out(pel_vtp_writer *writer, const pel_vtp *vtp, pel_error *error)
{
    pel_status status = list_arrays(writer, vtp, error);
    vtp_array *arrays = arrays_of(writer);
    writer->numbers.size = 0;
    for (size_t i = 0; status == PEL_OK && i + 2 < writer->array_count; i++)
        status = append_array(writer, &writer->numbers, &arrays[i], vtp->compress, error);
    if (status == PEL_OK && !has_surface(writer, vtp))
        status = append_surface(writer, vtp, error);
    if (status != PEL_OK)
        return status;
    arrays[writer->array_count - 2].offset = writer->numbers.size;
    arrays[writer->array_count - 1].offset = writer->numbers.size + writer->ends_offset;
    return PEL_OK;
}

static void write_array(pel_file_writer *writer, const vtp_array *array)
{
    const char *type = array->reals == NULL ? "Int32" : array->float64 ? "Float64" : "Float32";
    pel_file_writer_printf(writer, "<DataArray type=\"%s\" Name=\"", type);
    pel_xml_write_escaped(writer, array->name);
    pel_file_writer_printf(writer,
                           "\" NumberOfComponents=\"%zu\" NumberOfTuples=\"%zu\" format=\"appended\" "
                           "offset=\"%zu\"/>\n",
                           array->component_count, array->tuple_count, array->offset);
}

static void write_head(pel_file_writer *writer, const vtp_array *arrays, const pel_vtp *vtp)
{
    const vtp_array *cells = arrays + FIELDS + vtp->field_count, *points = cells + vtp->cell_field_count;
    pel_file_writer_printf(writer,
                           "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"%s\" "
                           "header_type=\"UInt64\"%s>\n<PolyData>\n<FieldData>\n",
                           PEL_BYTE_ORDER_NAME, vtp->compress ? " compressor=\"vtkZLibDataCompressor\"" : "");
    write_array(writer, &arrays[TIME]);
    pel_file_writer_printf(writer,
                           "</FieldData>\n<Piece NumberOfPoints=\"%d\" NumberOfVerts=\"0\" NumberOfLines=\"0\" "
                           "NumberOfStrips=\"0\" NumberOfPolys=\"%d\">\n<PointData>\n",
                           (int)vtp->vertex_count, (int)vtp->triangle_count);
    for (const vtp_array *field = arrays + FIELDS; field < cells; field++)
        write_array(writer, field);
    pel_file_writer_printf(writer, "</PointData>\n");
    if (cells < points) {
        pel_file_writer_printf(writer, "<CellData>\n");
        for (const vtp_array *field = cells; field < points; field++)
            write_array(writer, field);
        pel_file_writer_printf(writer, "</CellData>\n");
    }
    pel_file_writer_printf(writer, "<Points>\n");
    write_array(writer, points);
    pel_file_writer_printf(writer, "</Points>\n<Polys>\n");
    write_array(writer, points + 1);
    write_array(writer, points + 2);
    pel_file_writer_printf(writer, "</Polys>\n</Piece>\n</PolyData>\n<AppendedData encoding=\"raw\">\n_");
}

static pel_status write_file(const pel_vtp_writer *made, const char *path, const pel_vtp *vtp, pel_error *error)
{
    pel_file_writer writer;
    pel_status status = pel_file_writer_open(&writer, path, error);
    if (status != PEL_OK)
        return status;
    write_head(&writer, arrays_of(made), vtp);
    pel_file_writer_write(&writer, made->numbers.bytes, made->numbers.size);
    pel_file_writer_write(&writer, made->surface.bytes, made->surface.size);
    pel_file_writer_printf(&writer, "\n</AppendedData>\n</VTKFile>\n");
    return pel_file_writer_commit(&writer, error);
}

pel_status pel_vtp_writer_create(pel_vtp_writer **writer, pel_error *error)
{
    PEL_REFUSE_NULL(writer, error);
    *writer = pel_allocate(1, sizeof **writer);
    return *writer != NULL ? PEL_OK : pel_fail_memory(error);
}

void pel_vtp_writer_destroy(pel_vtp_writer *writer)
{
    if (writer == NULL)
        return;
    PEL_FREE_ALL(writer->triangles, writer->scratch.bytes, writer->surface.bytes, writer->numbers.bytes,
                 writer->array_block, writer);
}

pel_status pel_vtp_writer_write(pel_vtp_writer *writer, const char *path, const pel_vtp *vtp, pel_error *error)
{
    PEL_REFUSE_NULL(writer, error);
    PEL_REFUSE_NULL(path, error);
    PEL_REFUSE_NULL(vtp, error);
    pel_status status = check_arguments(vtp, error);
    if (status == PEL_OK)
        status = lay_out(writer, vtp, error);
    return status == PEL_OK ? write_file(writer, path, vtp, error) : status;
}

pel_status pel_vtp_write(const char *path, const pel_vtp *vtp, pel_error *error)
{
    PEL_REFUSE_NULL(path, error);
    PEL_REFUSE_NULL(vtp, error);
    pel_vtp_writer *writer;
    pel_status status = pel_vtp_writer_create(&writer, error);
    if (status == PEL_OK)
        status = pel_vtp_writer_write(writer, path, vtp, error);
    pel_vtp_writer_destroy(writer);
    return status;
}
