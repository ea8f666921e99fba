#include "base/number.h"
#include "io/bytes.h"
#include "io/formats.h"

#include "base/memory.h"
#include "base/room.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* one scalar property of the vertices */
typedef struct column {
    char name[PEL_NAME_SIZE + 16];
    const double *base;
    int32_t stride;
    bool byte; /* uchar instead of double */
} column;

typedef struct ply_writer {
    pel_file_writer *file;
    pel_encoding encoding;
    column *columns;
    size_t column_count;
    char *record; /* room for one binary vertex */
} ply_writer;

/* viewers expect colours as bytes */
static bool fits_byte(const char *name, const double *values, int32_t count)
{
    static const char *const colours[] = {"red", "green", "blue", "alpha", NULL};
    bool fits = pel_word_is_one_of(name, strlen(name), colours);
    for (int32_t v = 0; v < count && fits; v++)
        fits = values[v] >= 0 && values[v] <= UINT8_MAX && values[v] == floor(values[v]);
    return fits;
}

static bool column_exists(const ply_writer *writer, const char *name)
{
    for (size_t i = 0; i < writer->column_count; i++)
        if (strcmp(writer->columns[i].name, name) == 0)
            return true;
    return false;
}

/* a valid name that is not yet in the header */
static bool name_is_free(const ply_writer *writer, const pel_field *field)
{
    char name[PEL_NAME_SIZE + 16];
    if (field->name[strcspn(field->name, " \t\r\n\v\f#\\")] != '\0')
        return false;
    for (int32_t i = 0; i < field->component_count; i++) {
        snprintf(name, sizeof name, field->component_count > 1 ? "%s_%d" : "%s", field->name, (int)i);
        if (strlen(name) >= PEL_NAME_SIZE || column_exists(writer, name))
            return false;
    }
    return true;
}

static void add_field_columns(ply_writer *writer, const pel_mesh *mesh, const pel_field *field)
{
    const int32_t component_count = field->component_count;
    for (int32_t i = 0; i < component_count; i++) {
        column *added = &writer->columns[writer->column_count++];
        if (component_count > 1)
            snprintf(added->name, sizeof added->name, "%s_%d", field->name, (int)i);
        else
            snprintf(added->name, sizeof added->name, "%s", field->name);
        added->base = field->values + i;
        added->stride = component_count;
        added->byte = component_count == 1 && fits_byte(field->name, field->values, mesh->vertex_count);
    }
}

static bool make_columns(ply_writer *writer, const pel_mesh *mesh, const pel_log *log)
{
    size_t count = 3;
    for (int32_t f = 0; f < mesh->field_count; f++)
        count += (size_t)mesh->fields[f].component_count;
    if (!PEL_ALLOCATE_ALL(PEL_ROOM(writer->columns, count), PEL_ROOM(writer->record, count * sizeof(double))))
        return false;
    for (int i = 0; i < 3; i++) {
        column *axis = &writer->columns[writer->column_count++];
        snprintf(axis->name, sizeof axis->name, "%c", 'x' + i);
        axis->base = &mesh->positions[0][i];
        axis->stride = 3;
    }
    for (int32_t f = 0; f < mesh->field_count; f++) {
        if (name_is_free(writer, &mesh->fields[f]))
            add_field_columns(writer, mesh, &mesh->fields[f]);
        else
            pel_log_line(log, "field '%s' dropped: its name is too long, taken or has characters that PLY cannot hold",
                         mesh->fields[f].name);
    }
    return true;
}

static void write_header(const ply_writer *writer, const pel_mesh *mesh)
{
    static const char *const formats[] = {"ascii", "binary_little_endian", "binary_big_endian"};
    pel_file_writer_printf(writer->file, "ply\nformat %s 1.0\nelement vertex %d\n", formats[writer->encoding],
                           (int)mesh->vertex_count);
    for (size_t i = 0; i < writer->column_count; i++)
        pel_file_writer_printf(writer->file, "property %s %s\n", writer->columns[i].byte ? "uchar" : "double",
                               writer->columns[i].name);
    pel_file_writer_printf(writer->file, "element face %d\nproperty list uchar int vertex_indices\nend_header\n",
                           (int)mesh->triangle_count);
}

static void write_ascii(const ply_writer *writer, const pel_mesh *mesh)
{
    char text[PEL_NUMBER_SIZE + 1];
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        for (size_t i = 0; i < writer->column_count; i++) {
            const column *from = &writer->columns[i];
            size_t length = pel_number_print(text, from->base[(size_t)from->stride * (size_t)v]);
            text[length++] = i + 1 < writer->column_count ? ' ' : '\n';
            pel_file_writer_write(writer->file, text, length);
        }
    }
    for (int32_t t = 0; t < mesh->triangle_count; t++) {
        const int32_t *c = mesh->triangles[t];
        pel_file_writer_printf(writer->file, "3 %d %d %d\n", (int)c[0], (int)c[1], (int)c[2]);
    }
}

static void write_binary(const ply_writer *writer, const pel_mesh *mesh)
{
    const bool big = writer->encoding == PEL_ENCODING_BIG;
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        size_t length = 0;
        for (size_t i = 0; i < writer->column_count; i++) {
            const column *from = &writer->columns[i];
            double value = from->base[(size_t)from->stride * (size_t)v];
            if (from->byte)
                pel_store_bytes(writer->record + length, 1, big, (uint64_t)value);
            else
                pel_store_double(writer->record + length, big, value);
            length += from->byte ? 1 : sizeof value;
        }
        pel_file_writer_write(writer->file, writer->record, length);
    }
    for (int32_t t = 0; t < mesh->triangle_count; t++) {
        char face[13] = {3};
        for (int i = 0; i < 3; i++)
            pel_store_bytes(face + 1 + 4 * i, 4, big, (uint64_t)mesh->triangles[t][i]);
        pel_file_writer_write(writer->file, face, sizeof face);
    }
}

pel_status pel_ply_write(pel_file_writer *file, pel_encoding encoding, const pel_mesh *mesh, const pel_log *log,
                         pel_error *error)
{
    ply_writer writer = {.file = file, .encoding = encoding};
    pel_status status = PEL_OK;
    if (!make_columns(&writer, mesh, log)) {
        status = pel_fail_memory(error);
    } else {
        write_header(&writer, mesh);
        if (encoding == PEL_ENCODING_ASCII)
            write_ascii(&writer, mesh);
        else
            write_binary(&writer, mesh);
    }
    pel_free(writer.columns);
    pel_free(writer.record);
    return status;
}
