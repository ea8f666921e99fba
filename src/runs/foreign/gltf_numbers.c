#include "foreign/gltf.h"

#include "base/memory.h"
#include "io/bytes.h"

#include <math.h>
#include <string.h>

static const char *const again = "export the file again, or as PLY or OBJ";

enum { BYTE = 5120, UNSIGNED_BYTE, SHORT, UNSIGNED_SHORT, UNSIGNED_INT = 5125, FLOAT };

/* numbers in a buffer: element i begins at bytes + i stride */
typedef struct number_row {
    const char *bytes;
    size_t stride;
    int type;
    int32_t width;
    bool is_normalised;
} number_row;

static size_t size_of(int type)
{
    return type <= UNSIGNED_BYTE ? 1 : type <= UNSIGNED_SHORT ? 2 : 4;
}

/* the number at `bytes`; normalised ones as the specification has them (section 3.6.2.2) */
static double load(const char *bytes, int type, bool is_normalised)
{
    static const double largest[] = {127, 255, 32767, 65535};
    double value = 0;
    if (type == FLOAT)
        return pel_load_float(bytes, false);
    if (type == BYTE)
        value = (double)(int8_t)pel_load_bytes(bytes, 1, false);
    else if (type == SHORT)
        value = (double)(int16_t)pel_load_bytes(bytes, 2, false);
    else
        value = (double)pel_load_bytes(bytes, size_of(type), false);
    if (!is_normalised || type > UNSIGNED_SHORT)
        return value;
    value /= largest[type - BYTE];
    return value < -1 ? -1 : value;
}

/* The place of `count` elements that begin at a view's byte `offset`; checks that the view has them. */
static pel_status find_row(const pel_gltf *g, const pel_json_node *view, int64_t offset, size_t count, bool may_stride,
                           number_row *row, pel_error *error)
{
    int64_t buffer_index, begin, length, stride;
    const size_t element = size_of(row->type) * (size_t)row->width;
    const int64_t most = INT64_C(1) << 52;
    pel_status status =
        pel_gltf_integer(g, view, "buffer", -1, 0, (int64_t)g->counts[PEL_GLTF_BUFFERS] - 1, &buffer_index, error);
    if (status == PEL_OK)
        status = pel_gltf_integer(g, view, "byteOffset", 0, 0, most, &begin, error);
    if (status == PEL_OK)
        status = pel_gltf_integer(g, view, "byteLength", 0, 0, most, &length, error);
    if (status == PEL_OK)
        status = pel_gltf_integer(g, view, "byteStride", 0, 0, 1 << 20, &stride, error);
    if (status != PEL_OK)
        return status;
    if (buffer_index < 0)
        return pel_gltf_fail(g, view, error, again, "a view of a buffer does not say of which");
    const pel_gltf_buffer *buffer = &g->buffers[buffer_index];
    row->stride = may_stride && stride > 0 ? (size_t)stride : element;
    if ((uint64_t)begin > buffer->size || (uint64_t)length > buffer->size - (uint64_t)begin)
        return pel_gltf_fail(g, view, error, again, "a view goes beyond the %zu bytes of its buffer", buffer->size);
    const uint64_t room = (uint64_t)length;
    if ((uint64_t)offset > room || room - (uint64_t)offset < element ||
        (count - 1) > (room - (uint64_t)offset - element) / row->stride)
        return pel_gltf_fail(g, view, error, again, "%zu elements do not fit into the %lld bytes of their view", count,
                             (long long)length);
    row->bytes = buffer->bytes + begin + offset;
    return PEL_OK;
}

static pel_status check_index_type(const pel_gltf *g, const pel_json_node *object, int64_t type, pel_error *error)
{
    if (type == UNSIGNED_BYTE || type == UNSIGNED_SHORT || type == UNSIGNED_INT)
        return PEL_OK;
    return pel_gltf_fail(g, object, error, again, "indices of component type %lld, which are no whole numbers from 0",
                         (long long)type);
}

/* replaces single elements */
static pel_status read_sparse(pel_gltf *g, const pel_json_node *sparse, const number_row *base, double *numbers,
                              size_t count, pel_error *error)
{
    const pel_json_node *indices = pel_json_member(&g->tree, sparse, "indices");
    const pel_json_node *values = pel_json_member(&g->tree, sparse, "values"), *index_view, *value_view;
    int64_t changed, index_offset, value_offset, type;
    number_row at = {.width = 1}, to = *base;
    pel_status status = pel_gltf_integer(g, sparse, "count", 0, 1, (int64_t)count, &changed, error);
    if (status == PEL_OK)
        status = pel_gltf_integer(g, indices, "componentType", 0, BYTE, FLOAT, &type, error);
    if (status == PEL_OK)
        status = check_index_type(g, sparse, type, error);
    if (status == PEL_OK)
        status = pel_gltf_integer(g, indices, "byteOffset", 0, 0, INT32_MAX, &index_offset, error);
    if (status == PEL_OK)
        status = pel_gltf_integer(g, values, "byteOffset", 0, 0, INT32_MAX, &value_offset, error);
    if (status == PEL_OK)
        status = pel_gltf_named(g, indices, "bufferView", PEL_GLTF_VIEWS, &index_view, error);
    if (status == PEL_OK)
        status = pel_gltf_named(g, values, "bufferView", PEL_GLTF_VIEWS, &value_view, error);
    if (status != PEL_OK)
        return status;
    if (changed == 0 || index_view == NULL || value_view == NULL)
        return pel_gltf_fail(g, sparse, error, again, "a sparse accessor lacks its count, indices or values");
    at.type = (int)type;
    status = find_row(g, index_view, index_offset, (size_t)changed, false, &at, error);
    if (status == PEL_OK)
        status = find_row(g, value_view, value_offset, (size_t)changed, false, &to, error);
    for (size_t i = 0; i < (size_t)changed && status == PEL_OK; i++) {
        const size_t element = (size_t)pel_load_bytes(at.bytes + i * at.stride, size_of(at.type), false);
        if (element >= count)
            return pel_gltf_fail(g, sparse, error, again, "a sparse accessor changes element %zu of %zu", element,
                                 count);
        for (size_t k = 0; k < (size_t)to.width; k++)
            numbers[element * (size_t)to.width + k] =
                load(to.bytes + i * to.stride + k * size_of(to.type), to.type, to.is_normalised);
    }
    return status;
}

pel_status pel_gltf_count(pel_gltf *g, const pel_json_node *accessor, size_t *count, pel_error *error)
{
    int64_t number;
    pel_status status = pel_gltf_integer(g, accessor, "count", 0, 1, INT32_MAX, &number, error);
    *count = (size_t)number;
    if (status == PEL_OK && number == 0)
        return pel_gltf_fail(g, accessor, error, again, "an accessor has no count");
    return status == PEL_OK ? pel_gltf_work(g, accessor, *count, error) : status;
}

static pel_status read_head(pel_gltf *g, const pel_json_node *accessor, int32_t width, number_row *row,
                            pel_error *error)
{
    static const char *const words[] = {"SCALAR", "VEC2", "VEC3", "VEC4", "MAT4"};
    const char *word = words[width == 16 ? 4 : width - 1];
    const pel_json_node *normalised = pel_json_member(&g->tree, accessor, "normalized");
    int64_t type;
    pel_status status = pel_gltf_integer(g, accessor, "componentType", 0, BYTE, FLOAT, &type, error);
    if (status != PEL_OK)
        return status;
    if (type < BYTE || type == UNSIGNED_INT - 1)
        return pel_gltf_fail(g, accessor, error, again, "an accessor has no component type of glTF");
    if (!pel_json_is(pel_json_member(&g->tree, accessor, "type"), word))
        return pel_gltf_fail(g, accessor, error, again, "an accessor does not have the type %s that its use asks for",
                             word);
    *row = (number_row){.type = (int)type, .width = width};
    row->is_normalised = normalised != NULL && normalised->kind == PEL_JSON_IS_BOOL && normalised->number > 0;
    return PEL_OK;
}

/* Where the numbers are; without a view they are all 0. */
static pel_status find_dense(const pel_gltf *g, const pel_json_node *accessor, number_row *row, size_t count,
                             pel_error *error)
{
    const pel_json_node *view;
    int64_t offset;
    pel_status status = pel_gltf_named(g, accessor, "bufferView", PEL_GLTF_VIEWS, &view, error);
    if (status == PEL_OK)
        status = pel_gltf_integer(g, accessor, "byteOffset", 0, 0, INT64_C(1) << 52, &offset, error);
    if (status != PEL_OK)
        return status;
    if (view != NULL)
        return find_row(g, view, offset, count, true, row, error);
    /* as many as the file could hold */
    if (count > g->size)
        return pel_gltf_fail(g, accessor, error, again, "an accessor of %zu elements has no view of a buffer", count);
    return PEL_OK;
}

static void load_all(const number_row *row, double *numbers, size_t count)
{
    const size_t width = (size_t)row->width, size = size_of(row->type);
    for (size_t i = 0; i < count && row->bytes != NULL; i++)
        for (size_t k = 0; k < width; k++)
            numbers[i * width + k] = load(row->bytes + i * row->stride + k * size, row->type, row->is_normalised);
}

/* the numbers of a row of which only the place is unknown */
static pel_status read_numbers(pel_gltf *g, const pel_json_node *accessor, number_row row, double **numbers,
                               size_t *count, pel_error *error)
{
    const int32_t width = row.width;
    pel_status status = pel_gltf_count(g, accessor, count, error);
    if (status == PEL_OK)
        status = find_dense(g, accessor, &row, *count, error);
    if (status != PEL_OK)
        return status;
    double *made = pel_allocate(*count * (size_t)width, sizeof *made);
    if (made == NULL)
        return pel_fail_memory(error);
    load_all(&row, made, *count);
    const pel_json_node *sparse = pel_json_member(&g->tree, accessor, "sparse");
    if (sparse != NULL)
        status = read_sparse(g, sparse, &row, made, *count, error);
    for (size_t i = 0; i < *count * (size_t)width && status == PEL_OK; i++)
        if (!isfinite(made[i]))
            status = pel_gltf_fail(g, accessor, error, "repair the mesh in the program that wrote it",
                                   "a coordinate is not finite");
    if (status != PEL_OK)
        pel_free(made);
    else
        *numbers = made;
    return status;
}

pel_status pel_gltf_numbers(pel_gltf *g, const pel_json_node *accessor, int32_t width, double **numbers, size_t *count,
                            pel_error *error)
{
    number_row row;
    *numbers = NULL;
    pel_status status = read_head(g, accessor, width, &row, error);
    return status == PEL_OK ? read_numbers(g, accessor, row, numbers, count, error) : status;
}

pel_status pel_gltf_indices(pel_gltf *g, const pel_json_node *accessor, double **indices, size_t *count,
                            pel_error *error)
{
    number_row row;
    *indices = NULL;
    pel_status status = read_head(g, accessor, 1, &row, error);
    if (status == PEL_OK)
        status = check_index_type(g, accessor, row.type, error);
    return status == PEL_OK ? read_numbers(g, accessor, row, indices, count, error) : status;
}
