/* VTK XML PolyData with all arrays in one appended section:

       <VTKFile> <PolyData> <FieldData/> <Piece> <PointData/> <Points/> <Polys/> </Piece> </PolyData>
       <AppendedData encoding="raw"> _ array array ... </AppendedData> </VTKFile>

   A raw array is a word of 8 bytes with its size, then its bytes; a packed one is what blocks.h describes. The arrays
   are laid out in memory first, because the head of the file names their offsets, and then written in one go.
   Format: Kitware, "VTK XML file formats". */
#include "pellicle/results.h"

#include "base/memory.h"
#include "base/status.h"
#include "io/blocks.h"
#include "io/byte_order.h"
#include "io/file.h"
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

/* all arrays of a file in their order: time, fields, points, connectivity, ends */
typedef struct vtp_layout {
    vtp_array *arrays;
    size_t array_count;
    unsigned char *bytes;   /* the appended section */
    unsigned char *scratch; /* an array before it is packed; null = raw */
    size_t size;
} vtp_layout;

enum { TIME, FIELDS };

static pel_status check_arguments(const pel_vtp *vtp, pel_error *error)
{
    if (vtp->vertex_count < 1 || vtp->triangle_count < 1 || vtp->triangle_count > INT32_MAX / 3 || vtp->field_count < 0)
        return pel_fail(error, PEL_BAD_ARGUMENT, "%d vertices, %d triangles and %d fields cannot be written",
                        (int)vtp->vertex_count, (int)vtp->triangle_count, (int)vtp->field_count);
    for (int32_t f = 0; f < vtp->field_count; f++) {
        const pel_vtp_field *field = &vtp->fields[f];
        if (field->component_count < 1 || field->name[0] == '\0' || strlen(field->name) >= PEL_NAME_SIZE)
            return pel_fail(error, PEL_BAD_ARGUMENT,
                            "field name '%s' is empty or longer than %d characters, or it has no components",
                            field->name, PEL_NAME_SIZE - 1);
    }
    return PEL_OK;
}

static void list_arrays(vtp_layout *layout, const pel_vtp *vtp)
{
    vtp_array *next = layout->arrays;
    size_t vertex_count = (size_t)vtp->vertex_count, triangle_count = (size_t)vtp->triangle_count;
    *next++ = (vtp_array){"TimeValue", &vtp->time, NULL, 1, 1, true, 0};
    for (int32_t f = 0; f < vtp->field_count; f++) {
        const pel_vtp_field *field = &vtp->fields[f];
        *next++ = (vtp_array){
            field->name, field->values, NULL, vertex_count, (size_t)field->component_count, vtp->float64, 0};
    }
    *next++ = (vtp_array){"Points", vtp->positions, NULL, vertex_count, 3, vtp->float64, 0};
    *next++ = (vtp_array){"connectivity", NULL, vtp->triangles, 3 * triangle_count, 1, false, 0};
    *next++ = (vtp_array){"offsets", NULL, NULL, triangle_count, 1, false, 0};
}

static size_t array_size(const vtp_array *array)
{
    size_t value_size = array->reals != NULL && array->float64 ? sizeof(double) : sizeof(float);
    return array->tuple_count * array->component_count * value_size;
}

static pel_status make_room(vtp_layout *layout, const pel_vtp *vtp, pel_error *error)
{
    layout->array_count = (size_t)vtp->field_count + 4;
    layout->arrays = pel_allocate(layout->array_count, sizeof *layout->arrays);
    if (layout->arrays == NULL)
        return pel_fail_memory(error);
    list_arrays(layout, vtp);
    size_t room = 0, largest = 0;
    for (size_t i = 0; i < layout->array_count; i++) {
        size_t size = array_size(&layout->arrays[i]);
        room += vtp->compress ? pel_blocks_bound(size) : sizeof(uint64_t) + size;
        largest = size > largest ? size : largest;
    }
    layout->bytes = pel_allocate(room, 1);
    layout->scratch = vtp->compress ? pel_allocate(largest, 1) : NULL;
    if (layout->bytes == NULL || (vtp->compress && layout->scratch == NULL))
        return pel_fail_memory(error);
    return PEL_OK;
}

static void free_layout(vtp_layout *layout)
{
    pel_free(layout->scratch);
    pel_free(layout->bytes);
    pel_free(layout->arrays);
}

/* the array's bytes as they stand in the file, or before packing */
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

static pel_status append_array(vtp_layout *layout, vtp_array *array, pel_error *error)
{
    uint64_t size = array_size(array);
    unsigned char *out = layout->bytes + layout->size;
    array->offset = layout->size;
    if (layout->scratch == NULL) {
        memcpy(out, &size, sizeof size);
        encode(array, out + sizeof size);
        layout->size += sizeof size + size;
        return PEL_OK;
    }
    size_t packed_size = 0;
    encode(array, layout->scratch);
    pel_status status = pel_blocks_pack(layout->scratch, size, out, &packed_size, error);
    layout->size += packed_size;
    return status;
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

static void write_head(pel_file_writer *writer, const vtp_layout *layout, const pel_vtp *vtp)
{
    const vtp_array *points = &layout->arrays[layout->array_count - 3];
    pel_file_writer_printf(writer,
                           "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"%s\" "
                           "header_type=\"UInt64\"%s>\n<PolyData>\n<FieldData>\n",
                           PEL_BYTE_ORDER_NAME, vtp->compress ? " compressor=\"vtkZLibDataCompressor\"" : "");
    write_array(writer, &layout->arrays[TIME]);
    pel_file_writer_printf(writer,
                           "</FieldData>\n<Piece NumberOfPoints=\"%d\" NumberOfVerts=\"0\" NumberOfLines=\"0\" "
                           "NumberOfStrips=\"0\" NumberOfPolys=\"%d\">\n<PointData>\n",
                           (int)vtp->vertex_count, (int)vtp->triangle_count);
    for (const vtp_array *field = &layout->arrays[FIELDS]; field < points; field++)
        write_array(writer, field);
    pel_file_writer_printf(writer, "</PointData>\n<Points>\n");
    write_array(writer, points);
    pel_file_writer_printf(writer, "</Points>\n<Polys>\n");
    write_array(writer, points + 1);
    write_array(writer, points + 2);
    pel_file_writer_printf(writer, "</Polys>\n</Piece>\n</PolyData>\n<AppendedData encoding=\"raw\">\n_");
}

static pel_status write_file(const char *path, const vtp_layout *layout, const pel_vtp *vtp, pel_error *error)
{
    pel_file_writer writer;
    pel_status status = pel_file_writer_open(&writer, path, error);
    if (status != PEL_OK)
        return status;
    write_head(&writer, layout, vtp);
    pel_file_writer_write(&writer, layout->bytes, layout->size);
    pel_file_writer_printf(&writer, "\n</AppendedData>\n</VTKFile>\n");
    return pel_file_writer_commit(&writer, error);
}

pel_status pel_vtp_write(const char *path, const pel_vtp *vtp, pel_error *error)
{
    pel_status status = check_arguments(vtp, error);
    if (status != PEL_OK)
        return status;
    vtp_layout layout = {0};
    status = make_room(&layout, vtp, error);
    for (size_t i = 0; status == PEL_OK && i < layout.array_count; i++)
        status = append_array(&layout, &layout.arrays[i], error);
    if (status == PEL_OK)
        status = write_file(path, &layout, vtp, error);
    free_layout(&layout);
    return status;
}
