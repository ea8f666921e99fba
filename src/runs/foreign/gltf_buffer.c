#define _XOPEN_SOURCE 700 /* realpath */
#include "foreign/gltf.h"

#include "base/memory.h"
#include "io/base64.h"
#include "io/bytes.h"
#include "io/file.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { HEAD_SIZE = 12, CHUNK_HEAD_SIZE = 8, JSON_CHUNK = 0x4e4f534a, BINARY_CHUNK = 0x004e4942 };

static const char *const again = "export the file again, or as PLY or OBJ";

/* those that change no position, or that we read */
static const char *const known_extensions[] = {
    "KHR_mesh_quantization", "KHR_texture_transform", "KHR_texture_basisu",
    "KHR_lights_punctual",   "KHR_animation_pointer", "KHR_xmp_json_ld",
    "EXT_texture_webp",      "EXT_texture_avif",      "MSFT_texture_dds",
};

pel_status pel_gltf_fail(const pel_gltf *g, const pel_json_node *at, pel_error *error, const char *remedy,
                         const char *format, ...)
{
    char what[300];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(what, sizeof what, format, arguments);
    va_end(arguments);
    if (at != NULL)
        return pel_text_cursor_fail(&g->tree.scan, at->text, error, remedy, "%s", what);
    pel_fail(error, PEL_BAD_FORMAT, "%s", what);
    pel_fail_remedy(error, "%s", remedy);
    pel_fail_place(error, g->path, 0, 0);
    return PEL_BAD_FORMAT;
}

pel_status pel_gltf_work(pel_gltf *g, const pel_json_node *at, size_t amount, pel_error *error)
{
    if (amount > g->most_work - g->work)
        return pel_gltf_fail(g, at, error, "export fewer instances, targets or elements",
                             "the scene takes more than %zu vertices and corners, too many for a file of %zu bytes",
                             g->most_work, g->size);
    g->work += amount;
    return PEL_OK;
}

/* ---- values ---- */

pel_status pel_gltf_integer(const pel_gltf *g, const pel_json_node *object, const char *key, int64_t otherwise,
                            int64_t low, int64_t high, int64_t *number, pel_error *error)
{
    const pel_json_node *node = pel_json_member(&g->tree, object, key);
    *number = otherwise;
    if (node == NULL)
        return PEL_OK;
    const bool is_whole = node->kind == PEL_JSON_IS_NUMBER && node->number == floor(node->number);
    if (!is_whole || node->number < (double)low || node->number > (double)high)
        return pel_gltf_fail(g, node, error, again, "'%s' is no whole number from %lld to %lld", key, (long long)low,
                             (long long)high);
    *number = (int64_t)node->number;
    return PEL_OK;
}

pel_status pel_gltf_named(const pel_gltf *g, const pel_json_node *object, const char *key, pel_gltf_list list,
                          const pel_json_node **element, pel_error *error)
{
    int64_t number;
    *element = NULL;
    pel_status status = pel_gltf_integer(g, object, key, -1, 0, (int64_t)g->counts[list] - 1, &number, error);
    if (status == PEL_OK && number >= 0)
        *element = g->lists[list][number];
    return status;
}

pel_status pel_gltf_list_numbers(const pel_gltf *g, const pel_json_node *array, double *numbers, int32_t most,
                                 int32_t *count, pel_error *error)
{
    *count = 0;
    for (const pel_json_node *at = pel_json_first(&g->tree, array); at != NULL; at = pel_json_after(&g->tree, at)) {
        if (at->kind != PEL_JSON_IS_NUMBER || !isfinite(at->number) || *count == most)
            return pel_gltf_fail(g, at, error, again, "a list has something else than at most %d numbers", (int)most);
        numbers[(*count)++] = at->number;
    }
    return PEL_OK;
}

/* ---- the file ---- */

static pel_status read_chunks(pel_gltf *g, pel_text_cursor *json, pel_error *error)
{
    const uint64_t version = pel_load_bytes(g->bytes + 4, 4, false);
    if (version != 2)
        return pel_gltf_fail(g, NULL, error, "export it as glTF 2.0", "the file has version %llu of GLB, not 2",
                             (unsigned long long)version);
    for (const char *at = g->bytes + HEAD_SIZE, *end = g->bytes + g->size; end - at >= CHUNK_HEAD_SIZE;) {
        const uint64_t size = pel_load_bytes(at, 4, false), kind = pel_load_bytes(at + 4, 4, false);
        at += CHUNK_HEAD_SIZE;
        if (size > (uint64_t)(end - at))
            return pel_gltf_fail(g, NULL, error, "the file seems to be cut off: copy or export it again",
                                 "a chunk of %llu bytes has %td", (unsigned long long)size, end - at);
        if (kind == JSON_CHUNK && json->begin == NULL) {
            *json = (pel_text_cursor){.name = g->path, .begin = g->bytes, .at = at, .end = at + size, .binary = true};
        } else if (kind == BINARY_CHUNK && g->chunk == NULL) {
            g->chunk = at;
            g->chunk_size = (size_t)size;
        }
        at += size;
    }
    if (json->begin == NULL)
        return pel_gltf_fail(g, NULL, error, again, "the file has no chunk of JSON");
    return PEL_OK;
}

static pel_status read_json(pel_gltf *g, pel_error *error)
{
    pel_text_cursor json = {.name = g->path};
    pel_status status = PEL_OK;
    if (g->size >= HEAD_SIZE && memcmp(g->bytes, "glTF", 4) == 0) {
        status = read_chunks(g, &json, error);
    } else {
        json.begin = json.at = g->bytes;
        json.end = g->bytes + g->size;
        if (g->size >= 3 && memcmp(g->bytes, "\xef\xbb\xbf", 3) == 0)
            json.at += 3;
    }
    return status == PEL_OK ? pel_json_tree_read(&g->tree, &json, error) : status;
}

static bool is_known(const pel_json_node *name)
{
    static const char material[] = "KHR_materials_";
    for (size_t i = 0; i < sizeof known_extensions / sizeof *known_extensions; i++)
        if (pel_json_is(name, known_extensions[i]))
            return true;
    return name->kind == PEL_JSON_IS_TEXT && name->length > sizeof material &&
           memcmp(name->text, material, sizeof material - 1) == 0;
}

static pel_status check_asset(const pel_gltf *g, pel_error *error)
{
    const pel_json_tree *tree = &g->tree;
    char name[64];
    const pel_json_node *version = pel_json_member(tree, pel_json_member(tree, tree->nodes, "asset"), "version");
    if (!pel_json_unescape(version, name, sizeof name))
        return pel_gltf_fail(g, version, error, again, "the file says no version of glTF ('asset', 'version')");
    if (strncmp(name, "2.", 2) != 0)
        return pel_gltf_fail(g, version, error, "export it as glTF 2.0", "the file has version %s of glTF, not 2.0",
                             name);
    for (const pel_json_node *at = pel_json_first(tree, pel_json_member(tree, tree->nodes, "extensionsRequired"));
         at != NULL; at = pel_json_after(tree, at))
        if (!is_known(at)) {
            if (!pel_json_unescape(at, name, sizeof name))
                snprintf(name, sizeof name, "?");
            return pel_gltf_fail(g, at, error, "export the mesh without this extension, such as without compression",
                                 "the file requires the extension %s, which is not read", name);
        }
    return PEL_OK;
}

static pel_status find_lists(pel_gltf *g, pel_error *error)
{
    static const char *const keys[] = {"scenes",      "nodes",   "meshes",     "accessors",
                                       "bufferViews", "buffers", "animations", "skins"};
    for (int i = 0; i < PEL_GLTF_LIST_COUNT; i++) {
        const pel_json_node *array = pel_json_member(&g->tree, g->tree.nodes, keys[i]);
        if (array == NULL)
            continue;
        if (array->kind != PEL_JSON_IS_ARRAY)
            return pel_gltf_fail(g, array, error, again, "'%s' is no list", keys[i]);
        g->lists[i] = pel_allocate((size_t)array->count, sizeof(pel_json_node *));
        if (g->lists[i] == NULL)
            return pel_fail_memory(error);
        for (const pel_json_node *at = pel_json_first(&g->tree, array); at != NULL; at = pel_json_after(&g->tree, at))
            g->lists[i][g->counts[i]++] = at;
    }
    return PEL_OK;
}

/* ---- buffers ---- */

static int hex_digit(char c)
{
    return pel_is_digit(c) ? c - '0' : c >= 'a' && c <= 'f' ? c - 'a' + 10 : c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
}

/* %20 and the like, in place; false for a zero byte */
static bool decode_percents(char *uri)
{
    char *to = uri;
    for (const char *at = uri; *at != '\0'; at++) {
        const int high = *at == '%' ? hex_digit(at[1]) : -1, low = high >= 0 ? hex_digit(at[2]) : -1;
        *to = low >= 0 ? (char)(16 * high + low) : *at;
        if (*to++ == '\0')
            return false;
        at += low >= 0 ? 2 : 0;
    }
    *to = '\0';
    return true;
}

/* A file beside this one. Only names that lead into the folder of this file are followed, links included. */
static pel_status read_sibling(pel_gltf *g, const pel_json_node *at, char *uri, pel_gltf_buffer *buffer,
                               pel_error *error)
{
    static const char *const remedy = "export the file as .glb, which is one file";
    const char *slash = strrchr(g->path, '/');
    const int folder = slash != NULL ? (int)(slash - g->path) + 1 : 0;
    if (g->is_alone)
        return pel_gltf_fail(g, at, error, remedy, "the numbers are in another file, '%.100s'", uri);
    if (strstr(uri, "://") != NULL || !decode_percents(uri) || uri[0] == '/')
        return pel_gltf_fail(g, at, error, remedy, "'%.100s' is no file beside this one", uri);
    const size_t size = (size_t)folder + strlen(uri) + 2;
    char *path = pel_allocate(size, 1), *folder_path = pel_allocate((size_t)folder + 2, 1);
    pel_status status = path != NULL && folder_path != NULL ? PEL_OK : pel_fail_memory(error);
    if (status == PEL_OK) {
        snprintf(path, size, "%.*s%s", folder, g->path, uri);
        snprintf(folder_path, (size_t)folder + 2, "%.*s", folder > 0 ? folder : 1, folder > 0 ? g->path : ".");
        status = pel_file_check_inside(folder_path, path, NULL);
        if (status != PEL_OK)
            pel_gltf_fail(g, at, error, remedy, "'%.100s' is not in the folder of this file", uri);
    }
    if (status == PEL_OK)
        status = pel_file_read(path, &buffer->owned, &buffer->size, error);
    buffer->bytes = buffer->owned;
    pel_free(path);
    pel_free(folder_path);
    return status;
}

static pel_status read_data_uri(pel_gltf *g, const pel_json_node *at, const char *uri, pel_gltf_buffer *buffer,
                                pel_error *error)
{
    static const char marker[] = ";base64";
    const char *comma = strchr(uri, ',');
    const ptrdiff_t head = comma != NULL ? comma - uri : 0;
    if (head < (ptrdiff_t)sizeof marker || memcmp(comma + 1 - sizeof marker, marker, sizeof marker - 1) != 0)
        return pel_gltf_fail(g, at, error, again, "a 'data:' address holds something else than base64");
    const size_t length = strlen(comma + 1);
    buffer->owned = pel_allocate(length / 4 * 3 + 3, 1);
    if (buffer->owned == NULL)
        return pel_fail_memory(error);
    buffer->bytes = buffer->owned;
    buffer->size = pel_base64_decode(comma + 1, comma + 1 + length, (unsigned char *)buffer->owned, length / 4 * 3 + 3);
    return PEL_OK;
}

static pel_status read_uri(pel_gltf *g, const pel_json_node *uri, pel_gltf_buffer *buffer, pel_error *error)
{
    char *text = pel_allocate(uri->length + 1, 1);
    if (text == NULL)
        return pel_fail_memory(error);
    pel_status status = PEL_OK;
    if (!pel_json_unescape(uri, text, uri->length + 1))
        status = pel_gltf_fail(g, uri, error, again, "the name of a file of numbers is damaged");
    else if (strncmp(text, "data:", 5) == 0)
        status = read_data_uri(g, uri, text, buffer, error);
    else
        status = read_sibling(g, uri, text, buffer, error);
    pel_free(text);
    return status;
}

static pel_status read_buffer(pel_gltf *g, int32_t index, pel_error *error)
{
    const pel_json_node *node = g->lists[PEL_GLTF_BUFFERS][index], *uri = pel_json_member(&g->tree, node, "uri");
    pel_gltf_buffer *buffer = &g->buffers[index];
    int64_t size;
    pel_status status = pel_gltf_integer(g, node, "byteLength", 0, 0, INT64_C(1) << 52, &size, error);
    if (status == PEL_OK && uri != NULL) {
        status = read_uri(g, uri, buffer, error);
    } else if (status == PEL_OK && index == 0 && g->chunk != NULL) {
        buffer->bytes = g->chunk;
        buffer->size = g->chunk_size;
    }
    if (status == PEL_OK && buffer->size < (uint64_t)size)
        status = pel_gltf_fail(g, node, error, "the file seems to be cut off: copy or export it again",
                               "buffer %d has %zu bytes, not %lld", (int)index, buffer->size, (long long)size);
    return status;
}

/* ---- the whole ---- */

pel_status pel_gltf_open(pel_gltf *g, pel_error *error)
{
    /* a terrain of 100 trees is one tree; a million numbers are nothing */
    const size_t least = 1000000, each = 64;
    g->most_work = g->size < (SIZE_MAX - least) / each ? least + each * g->size : SIZE_MAX;
    pel_status status = read_json(g, error);
    if (status == PEL_OK)
        status = check_asset(g, error);
    if (status == PEL_OK)
        status = find_lists(g, error);
    if (status != PEL_OK)
        return status;
    const int32_t count = g->counts[PEL_GLTF_BUFFERS];
    g->buffers = pel_allocate((size_t)count, sizeof *g->buffers);
    if (g->buffers == NULL)
        return pel_fail_memory(error);
    for (int32_t i = 0; i < count && status == PEL_OK; i++)
        status = read_buffer(g, i, error);
    return status;
}

void pel_gltf_free(pel_gltf *g)
{
    for (int32_t i = 0; i < g->counts[PEL_GLTF_BUFFERS] && g->buffers != NULL; i++)
        pel_free(g->buffers[i].owned);
    pel_free(g->buffers);
    for (int i = 0; i < PEL_GLTF_LIST_COUNT; i++)
        pel_free(g->lists[i]);
    pel_json_tree_free(&g->tree);
}
