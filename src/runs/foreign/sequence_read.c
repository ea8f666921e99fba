/* Positions over time from files: animations of glTF, point caches and folders of meshes.

   A point cache (PC2) is "POINTCACHE2" and a zero byte, then as little-endian numbers of 4 bytes: version 1, number of
   points, start frame, sample rate, number of samples; then the points of all samples as floats. */
#include "base/memory.h"
#include "base/status.h"
#include "foreign/gltf.h"
#include "foreign/usd.h"
#include "io/bytes.h"
#include "io/file.h"
#include "pellicle/import.h"
#include "pellicle/mesh_io.h"
#include "sequence/sequence.h"

#include <dirent.h>
#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* ---- point caches ---- */

enum { HEADER_SIZE = 32 };

static int32_t integer_at(const char *bytes)
{
    return (int32_t)(uint32_t)pel_load_bytes(bytes, 4, false);
}

static double float_at(const char *bytes)
{
    uint32_t word = (uint32_t)pel_load_bytes(bytes, 4, false);
    float number;
    memcpy(&number, &word, sizeof number);
    return (double)number;
}

static pel_status fail_cache(pel_error *error, const char *path, const char *what)
{
    pel_fail(error, PEL_BAD_FORMAT, "%s", what);
    pel_fail_remedy(error, "export the point cache (PC2) again");
    pel_fail_place(error, path, 0, 0);
    return PEL_BAD_FORMAT;
}

static pel_status parse_cache(const char *path, const char *bytes, size_t size, double fps, pel_sequence **sequence,
                              pel_error *error)
{
    static const char word[12] = "POINTCACHE2";
    if (size < HEADER_SIZE || memcmp(bytes, word, sizeof word) != 0 || integer_at(bytes + 12) != 1)
        return fail_cache(error, path, "the file is no point cache of version 1");
    int32_t points = integer_at(bytes + 16), frames = integer_at(bytes + 28);
    double rate = float_at(bytes + 24);
    if (points < 1 || frames < 1 || !(rate > 0 && isfinite(rate)))
        return fail_cache(error, path, "the point cache has no points, no samples or no sample rate");
    if ((size - HEADER_SIZE) / 12 / (size_t)points < (size_t)frames) {
        pel_fail(error, PEL_BAD_FORMAT, "the point cache ends before its %d samples of %d points", (int)frames,
                 (int)points);
        pel_fail_remedy(error, "export it again");
        pel_fail_place(error, path, 0, 0);
        return PEL_BAD_FORMAT;
    }
    pel_status status = pel_sequence_allocate(frames, points, sequence, error);
    for (int32_t f = 0; status == PEL_OK && f < frames; f++)
        (*sequence)->times[f] = f * rate / fps;
    const char *at = bytes + HEADER_SIZE;
    for (size_t i = 0; status == PEL_OK && i < (size_t)frames * (size_t)points; i++)
        for (int k = 0; k < 3; k++, at += 4) {
            double number = float_at(at);
            (*sequence)->positions[i][k] = number;
            if (isfinite(number))
                continue;
            pel_fail(error, PEL_BAD_FORMAT, "point %d of sample %d is not finite", (int)(i % (size_t)points),
                     (int)(i / (size_t)points));
            pel_fail_remedy(error, "export the point cache again");
            pel_fail_place(error, path, 0, 0);
            return PEL_BAD_FORMAT;
        }
    return status;
}

static pel_status read_cache(const char *path, double fps, pel_sequence **sequence, pel_error *error)
{
    char *bytes;
    size_t size;
    pel_status status = pel_file_read(path, &bytes, &size, error);
    if (status == PEL_OK)
        status = parse_cache(path, bytes, size, fps, sequence, error);
    pel_free(bytes);
    return status;
}

/* ---- meshes ---- */

typedef struct name_list {
    char (*names)[NAME_MAX + 1];
    size_t count, capacity;
} name_list;

/* numbers in names by their value: step_2 before step_10 */
static int compare_names(const void *left, const void *right)
{
    const char *a = left, *b = right;
    while (*a != '\0' && *b != '\0') {
        bool is_number = *a >= '0' && *a <= '9' && *b >= '0' && *b <= '9';
        if (is_number) {
            char *end_a, *end_b;
            unsigned long long x = strtoull(a, &end_a, 10), y = strtoull(b, &end_b, 10);
            if (x != y)
                return x < y ? -1 : 1;
            a = end_a;
            b = end_b;
        } else if (*a != *b) {
            return (unsigned char)*a < (unsigned char)*b ? -1 : 1;
        } else {
            a++;
            b++;
        }
    }
    int order = (*a != '\0') - (*b != '\0');
    return order != 0 ? order : strcmp(left, right);
}

static bool ends_with(const char *name, const char *end)
{
    size_t length = strlen(name), tail = strlen(end);
    return length >= tail && strcmp(name + length - tail, end) == 0;
}

/* a pattern has one *; without a pattern, meshes that this library reads */
static bool matches(const char *name, const char *pattern)
{
    const char *star = pattern != NULL ? strchr(pattern, '*') : NULL;
    if (name[0] == '.' && (pattern == NULL || pattern[0] != '.'))
        return false;
    if (star == NULL)
        return pel_mesh_format_of_path(name) != PEL_FORMAT_AUTO || pel_gltf_is(name);
    size_t head = (size_t)(star - pattern);
    return strlen(name) >= strlen(pattern) - 1 && strncmp(name, pattern, head) == 0 && ends_with(name, star + 1);
}

static pel_status list_names(const char *folder, const char *pattern, name_list *list, pel_error *error)
{
    DIR *open = opendir(folder);
    if (open == NULL) {
        pel_fail(error, PEL_BAD_FILE, "cannot open the folder '%.200s': %s", folder, strerror(errno));
        pel_fail_remedy(error, "check the path");
        return PEL_BAD_FILE;
    }
    pel_status status = PEL_OK;
    for (struct dirent *entry; status == PEL_OK && (entry = readdir(open)) != NULL;) {
        if (!matches(entry->d_name, pattern))
            continue;
        if (!pel_reserve((void **)&list->names, &list->capacity, list->count + 1, sizeof *list->names))
            status = pel_fail_memory(error);
        else
            snprintf(list->names[list->count++], sizeof *list->names, "%s", entry->d_name);
    }
    closedir(open);
    if (status == PEL_OK && list->count == 0) {
        pel_fail(error, PEL_BAD_FILE, "no mesh file in '%.120s'%s%.80s", folder, pattern != NULL ? " matches " : "",
                 pattern != NULL ? pattern : "");
        pel_fail_remedy(error, "give a point cache (.pc2), a folder of meshes, or a pattern such as walk/step_*.obj");
        return PEL_BAD_FILE;
    }
    if (status == PEL_OK)
        qsort(list->names, list->count, sizeof *list->names, compare_names);
    return status;
}

static bool shares_edge(const int32_t a[3], const int32_t b[3])
{
    int shared = 0;
    for (int i = 0; i < 3; i++)
        shared += a[i] == b[0] || a[i] == b[1] || a[i] == b[2];
    return shared >= 2;
}

/* the same triangles; a quadrilateral may have its other diagonal */
static pel_status check_topology(const pel_mesh *first, const char *first_name, const pel_mesh *mesh, const char *path,
                                 pel_error *error)
{
    int32_t differing = -1;
    bool has_counts = mesh->vertex_count == first->vertex_count && mesh->triangle_count == first->triangle_count;
    for (int32_t t = 0; has_counts && differing < 0 && t < mesh->triangle_count; t++)
        if (!shares_edge(mesh->triangles[t], first->triangles[t]))
            differing = t;
    if (has_counts && differing < 0)
        return PEL_OK;
    if (has_counts)
        pel_fail(error, PEL_BAD_FORMAT, "triangle %d has other corners than in '%.80s'", (int)differing, first_name);
    else
        pel_fail(error, PEL_BAD_FORMAT, "the frame has %d vertices and %d triangles, '%.80s' has %d and %d",
                 (int)mesh->vertex_count, (int)mesh->triangle_count, first_name, (int)first->vertex_count,
                 (int)first->triangle_count);
    pel_fail_remedy(error, "export all frames from one mesh, with the same order of vertices and faces");
    pel_fail_place(error, path, 0, 0);
    return PEL_BAD_FORMAT;
}

static pel_status read_frame(const char *folder, const name_list *list, int32_t frame, double fps, pel_mesh **first,
                             pel_sequence **sequence, pel_error *error)
{
    char path[PATH_MAX];
    pel_mesh *mesh;
    if (snprintf(path, sizeof path, "%s/%s", folder, list->names[frame]) >= (int)sizeof path)
        return pel_refuse(error, PEL_BAD_FILE, "use a shorter path", "the path of a frame is too long");
    pel_status status = pel_mesh_import(path, NULL, &mesh, error);
    if (status != PEL_OK)
        return status;
    if (*first == NULL) {
        *first = mesh;
        status = pel_sequence_allocate((int32_t)list->count, mesh->vertex_count, sequence, error);
    } else {
        status = check_topology(*first, list->names[0], mesh, path, error);
    }
    if (status == PEL_OK) {
        size_t count = (size_t)mesh->vertex_count;
        (*sequence)->times[frame] = frame / fps;
        memcpy((*sequence)->positions + (size_t)frame * count, mesh->positions, count * sizeof *mesh->positions);
    }
    if (mesh != *first)
        pel_mesh_destroy(mesh);
    return status;
}

static pel_status read_meshes(const char *folder, const char *pattern, double fps, pel_sequence **sequence,
                              pel_error *error)
{
    name_list list = {0};
    pel_mesh *first = NULL;
    pel_status status = list_names(folder, pattern, &list, error);
    for (int32_t f = 0; status == PEL_OK && f < (int32_t)list.count; f++)
        status = read_frame(folder, &list, f, fps, &first, sequence, error);
    pel_mesh_destroy(first);
    pel_free(list.names);
    return status;
}

/* ---- both ---- */

static bool is_folder(const char *path)
{
    struct stat found;
    return stat(path, &found) == 0 && S_ISDIR(found.st_mode);
}

static pel_status read_any(const char *path, const char *animation, double fps, pel_sequence **sequence,
                           pel_error *error)
{
    const char *slash = strrchr(path, '/'), *name = slash != NULL ? slash + 1 : path;
    const bool is_pattern = strchr(name, '*') != NULL, is_many = is_pattern || is_folder(path);
    char folder[PATH_MAX];
    if (!is_many && pel_gltf_is(path))
        return pel_gltf_read_sequence(path, animation, fps, sequence, error);
    if (animation != NULL)
        return pel_refuse(error, PEL_BAD_ARGUMENT, "remove `animation`, or give a .glb or .gltf file",
                          "only a glTF file has named animations");
    if (!is_many && pel_usd_is_path(path))
        return pel_usd_read_sequence(path, sequence, error);
    if (!is_pattern)
        return is_many ? read_meshes(path, NULL, fps, sequence, error) : read_cache(path, fps, sequence, error);
    int length = slash == NULL ? 1 : slash == path ? 1 : (int)(slash - path);
    if (length >= (int)sizeof folder)
        return pel_refuse(error, PEL_BAD_FILE, "use a shorter path", "the path of a sequence is too long");
    snprintf(folder, sizeof folder, "%.*s", length, slash == NULL ? "." : path);
    return read_meshes(folder, name, fps, sequence, error);
}

pel_status pel_sequence_read(const char *path, const char *animation, double fps, pel_sequence **sequence,
                             pel_error *error)
{
    PEL_REFUSE_NULL(path, error);
    PEL_REFUSE_NULL(sequence, error);
    *sequence = NULL;
    if (!(fps > 0 && isfinite(fps)))
        return pel_refuse(error, PEL_BAD_ARGUMENT, "give a number of frames per second above 0", "fps is %g", fps);
    pel_status status = read_any(path, animation, fps, sequence, error);
    if (status == PEL_OK) {
        pel_sequence_finish(*sequence);
        return PEL_OK;
    }
    pel_sequence_destroy(*sequence);
    *sequence = NULL;
    return status;
}
