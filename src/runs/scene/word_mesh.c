#define _XOPEN_SOURCE 700 /* realpath */
#include "scene/word_mesh.h"

#include "base/status.h"
#include "pellicle/import.h"
#include "pellicle/mesh_io.h"
#include "pellicle/shape.h"

#include <dirent.h>
#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* files that are listed */
enum { MOST_FILES = 100 };

static const pel_shape_kind closed_shapes[] = {PEL_SHAPE_TORUS, PEL_SHAPE_CYLINDER, PEL_SHAPE_BLEND, PEL_SHAPE_BOX};
enum { CLOSED_COUNT = sizeof closed_shapes / sizeof *closed_shapes };

/* ---- words and paths ---- */

/* %20 for spaces; false if it does not fit, or the path has characters that commands cannot contain */
static bool encode(const char *path, char *word, size_t size)
{
    size_t length = 0;
    for (; *path != '\0'; path++) {
        if (length + 4 > size || *path < ' ' || *path > '~' || *path == '"' || *path == '\\')
            return false;
        if (*path == ' ')
            length += (size_t)snprintf(word + length, 4, "%%20");
        else
            word[length++] = *path;
    }
    word[length] = '\0';
    return true;
}

static bool decode(const char *word, char *path, size_t size)
{
    size_t length = 0;
    for (; *word != '\0'; length++) {
        bool space = strncmp(word, "%20", 3) == 0;
        if (length + 1 >= size)
            return false;
        path[length] = space ? ' ' : *word;
        word += space ? 3 : 1;
    }
    path[length] = '\0';
    return true;
}

static bool is_shape(const char *word)
{
    for (int i = 0; i < CLOSED_COUNT; i++)
        if (strcmp(word, pel_shape_info_of(closed_shapes[i])->name) == 0)
            return true;
    return false;
}

bool pel_word_mesh_is_one(const char *word)
{
    return is_shape(word) || pel_mesh_format_of_path(word) != PEL_FORMAT_AUTO;
}

/* the folder of the scene, "." if its path has none */
static void take_folder(const pel_scene *scene, char folder[PATH_MAX])
{
    const char *slash = strrchr(scene->path, '/');
    int length = slash == scene->path ? 1 : slash != NULL ? (int)(slash - scene->path) : 0;
    snprintf(folder, PATH_MAX, "%.*s", length > 0 ? length : 1, length > 0 ? scene->path : ".");
}

/* ---- creation ---- */

static pel_status create_shape(const char *word, pel_mesh **mesh, char *full, size_t size, pel_error *error)
{
    pel_shape_def def;
    snprintf(full, size, "%s", word);
    pel_status status = pel_shape_def_of_name(word, &def, error);
    if (status == PEL_OK && def.kind == PEL_SHAPE_CYLINDER)
        def.capped = true;
    return status == PEL_OK ? pel_shape_create(&def, mesh, error) : status;
}

static pel_status read_file(const pel_scene *scene, const char *word, pel_mesh **mesh, char *full, size_t size,
                            pel_error *error)
{
    char path[PATH_MAX], folder[PATH_MAX] = "", joined[2 * PATH_MAX], absolute[PATH_MAX];
    if (!decode(word, path, sizeof path))
        return pel_fail(error, PEL_BAD_ARGUMENT, "the path of the mesh is too long");
    if (path[0] != '/')
        take_folder(scene, folder);
    snprintf(joined, sizeof joined, "%s%s%s", folder, folder[0] != '\0' ? "/" : "", path);
    if (realpath(joined, absolute) == NULL) {
        pel_fail(error, PEL_BAD_FILE, "cannot open the mesh '%.150s': %s", path, strerror(errno));
        pel_fail_remedy(error, "check the path; relative paths start at the folder of the scene, %.150s", folder);
        return PEL_BAD_FILE;
    }
    if (!encode(absolute, full, size))
        return pel_fail(error, PEL_BAD_ARGUMENT,
                        "the path of '%.150s' is too long for a command, or has characters other than printable ASCII",
                        path);
    return pel_mesh_import(absolute, NULL, mesh, error);
}

pel_status pel_word_mesh_create(const pel_scene *scene, const char *word, pel_mesh **mesh, char *full, size_t size,
                                pel_error *error)
{
    *mesh = NULL;
    return is_shape(word) ? create_shape(word, mesh, full, size, error)
                          : read_file(scene, word, mesh, full, size, error);
}

/* ---- lists ---- */

static bool is_mesh(const char *name)
{
    return name[0] != '.' && pel_mesh_format_of_path(name) != PEL_FORMAT_AUTO;
}

void pel_word_mesh_list(const pel_scene *scene, void (*take)(void *user, const char *word), void *user)
{
    char folder[PATH_MAX], word[3 * NAME_MAX + 1];
    for (int i = 0; i < CLOSED_COUNT; i++)
        take(user, pel_shape_info_of(closed_shapes[i])->name);
    take_folder(scene, folder);
    DIR *entries = opendir(folder);
    const struct dirent *entry = NULL;
    for (int count = 0; entries != NULL && count < MOST_FILES && (entry = readdir(entries)) != NULL;)
        if (is_mesh(entry->d_name) && encode(entry->d_name, word, sizeof word)) {
            take(user, word);
            count++;
        }
    if (entries != NULL)
        closedir(entries);
}
