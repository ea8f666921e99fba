/* The child of child.h: reads one file through assimp, under limits, and writes the mesh to its standard output. */
#ifdef PELLICLE_ASSIMP
#define _GNU_SOURCE /* realpath, closefrom */
#include "pellicle/import.h"

#include "base/memory.h"
#include "base/status.h"
#include "foreign/child.h"
#include "io/file.h"
#include "io/polygon_soup.h"
#include "mesh/seam.h"

#include <assimp/cfileio.h>
#include <assimp/cimport.h>
#include <assimp/scene.h>

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

/* a node of the scene with its place in the world: x -> linear x + shift */
typedef struct placed_node {
    const struct aiNode *node;
    double linear[3][3];
    double shift[3];
} placed_node;

typedef struct importer {
    const char *path;
    const struct aiScene *scene;
    pel_polygon_soup builder;
    placed_node *stack; /* nodes still to visit */
    size_t stack_count, stack_capacity;
    size_t mesh_count; /* meshes taken, those used several times counted each time */
} importer;

static pel_status fail_import(const importer *state, pel_error *error, const char *what)
{
    pel_fail(error, PEL_BAD_FORMAT, "%s", what[0] != '\0' ? what : "assimp cannot read the file");
    pel_fail_remedy(error, "export the mesh again, preferably as PLY or OBJ");
    pel_fail_place(error, state->path, 0, 0);
    return PEL_BAD_FORMAT;
}

/* the place of a node inside its parent's */
static placed_node place_node(const placed_node *parent, const struct aiNode *node)
{
    const struct aiMatrix4x4 *m = &node->mTransformation;
    const double local[3][4] = {{(double)m->a1, (double)m->a2, (double)m->a3, (double)m->a4},
                                {(double)m->b1, (double)m->b2, (double)m->b3, (double)m->b4},
                                {(double)m->c1, (double)m->c2, (double)m->c3, (double)m->c4}};
    placed_node placed = {.node = node};
    for (int i = 0; i < 3; i++) {
        placed.shift[i] = parent->shift[i];
        for (int k = 0; k < 3; k++) {
            placed.shift[i] += parent->linear[i][k] * local[k][3];
            for (int j = 0; j < 3; j++)
                placed.linear[i][j] += parent->linear[i][k] * local[k][j];
        }
    }
    return placed;
}

static bool mirrors(const placed_node *placed)
{
    const double(*m)[3] = placed->linear;
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
               m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]) <
           0;
}

static pel_status add_corner(importer *state, const placed_node *placed, const struct aiMesh *mesh, unsigned index,
                             pel_error *error)
{
    if (index >= mesh->mNumVertices)
        return fail_import(state, error, "a face uses a vertex that does not exist");
    const struct aiVector3D *local = &mesh->mVertices[index];
    double position[3];
    for (int i = 0; i < 3; i++) {
        position[i] = placed->shift[i] + placed->linear[i][0] * (double)local->x +
                      placed->linear[i][1] * (double)local->y + placed->linear[i][2] * (double)local->z;
        if (!isfinite(position[i]))
            return fail_import(state, error, "a coordinate is not finite");
    }
    return pel_polygon_soup_add_loose_corner(&state->builder, position, NULL) ? PEL_OK : pel_fail_memory(error);
}

static pel_status add_mesh(importer *state, const placed_node *placed, const struct aiMesh *mesh, pel_error *error)
{
    const bool reversed = mirrors(placed);
    state->mesh_count++;
    for (unsigned f = 0; f < mesh->mNumFaces; f++) {
        const struct aiFace *face = &mesh->mFaces[f];
        for (unsigned i = 0; i < face->mNumIndices; i++) {
            unsigned corner = reversed ? face->mNumIndices - 1 - i : i;
            pel_status status = add_corner(state, placed, mesh, face->mIndices[corner], error);
            if (status != PEL_OK)
                return status;
        }
        if (!pel_polygon_soup_end_loose_polygon(&state->builder, face->mNumIndices))
            return pel_fail_memory(error);
    }
    return PEL_OK;
}

static pel_status push_node(importer *state, const placed_node *placed, pel_error *error)
{
    void *stack = state->stack;
    if (!pel_reserve(&stack, &state->stack_capacity, state->stack_count + 1, sizeof *placed))
        return pel_fail_memory(error);
    state->stack = stack;
    state->stack[state->stack_count++] = *placed;
    return PEL_OK;
}

/* the meshes of a node, then its children in their order */
static pel_status visit_node(importer *state, const placed_node *placed, pel_error *error)
{
    const struct aiNode *node = placed->node;
    pel_status status = PEL_OK;
    for (unsigned i = 0; i < node->mNumMeshes && status == PEL_OK; i++)
        if (node->mMeshes[i] >= state->scene->mNumMeshes)
            status = fail_import(state, error, "a node uses a mesh that does not exist");
        else
            status = add_mesh(state, placed, state->scene->mMeshes[node->mMeshes[i]], error);
    for (unsigned i = node->mNumChildren; i > 0 && status == PEL_OK; i--) {
        const placed_node child = place_node(placed, node->mChildren[i - 1]);
        status = push_node(state, &child, error);
    }
    return status;
}

static pel_status visit_scene(importer *state, pel_error *error)
{
    const placed_node world = {.linear = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    const placed_node root = place_node(&world, state->scene->mRootNode);
    pel_status status = push_node(state, &root, error);
    while (state->stack_count > 0 && status == PEL_OK) {
        const placed_node placed = state->stack[--state->stack_count];
        status = visit_node(state, &placed, error);
    }
    return status;
}

static pel_status import_scene(importer *state, const pel_log *log, pel_mesh **mesh, pel_error *error)
{
    const pel_text_cursor nowhere = {.name = state->path, .begin = "", .at = "", .end = ""};
    if (state->scene == NULL)
        return fail_import(state, error, aiGetErrorString());
    if (state->scene->mRootNode == NULL)
        return fail_import(state, error, "the scene is empty");
    pel_status status = visit_scene(state, error);
    if (status == PEL_OK && state->mesh_count > 1)
        pel_log_line(log, "%zu meshes of the scene joined", state->mesh_count);
    if (status == PEL_OK)
        status = pel_polygon_soup_finish(&state->builder, &nowhere, log, mesh, error);
    return status == PEL_OK ? pel_seams_weld(*mesh, NULL, log, error) : status;
}

/* ---- files ---- */

/* a whole file in memory */
typedef struct open_file {
    struct aiFile calls;
    char *bytes;
    size_t size, at;
} open_file;

static size_t read_from(struct aiFile *file, char *to, size_t size, size_t count)
{
    open_file *f = (open_file *)(void *)file->UserData;
    const size_t whole = size > 0 ? (f->size - f->at) / size : 0, taken = whole < count ? whole : count;
    memcpy(to, f->bytes + f->at, taken * size);
    f->at += taken * size;
    return taken;
}

static size_t write_nothing(struct aiFile *file, const char *from, size_t size, size_t count)
{
    (void)file, (void)from, (void)size, (void)count;
    return 0;
}

static size_t tell_place(struct aiFile *file)
{
    return ((const open_file *)(void *)file->UserData)->at;
}

static size_t tell_size(struct aiFile *file)
{
    return ((const open_file *)(void *)file->UserData)->size;
}

static aiReturn seek_place(struct aiFile *file, size_t offset, enum aiOrigin origin)
{
    open_file *f = (open_file *)(void *)file->UserData;
    const size_t from = origin == aiOrigin_SET ? 0 : origin == aiOrigin_CUR ? f->at : f->size;
    const size_t to = from + offset;
    /* negative offsets come as numbers that wrap around */
    if (to > f->size)
        return aiReturn_FAILURE;
    f->at = to;
    return aiReturn_SUCCESS;
}

static void flush_nothing(struct aiFile *file)
{
    (void)file;
}

/* the named file, and those that it names in its own folder, links followed */
static bool may_open(const char *named, const char *path)
{
    char folder[PATH_MAX];
    const char *slash = strrchr(named, '/');
    snprintf(folder, sizeof folder, "%.*s", slash != NULL ? (int)(slash - named) + 1 : 1, slash != NULL ? named : ".");
    return strcmp(named, path) == 0 || pel_file_check_inside(folder, path, NULL) == PEL_OK;
}

static struct aiFile *open_named(struct aiFileIO *io, const char *path, const char *mode)
{
    open_file *f = strchr(mode, 'w') == NULL && may_open(io->UserData, path) ? pel_allocate(1, sizeof *f) : NULL;
    if (f == NULL)
        return NULL;
    if (pel_file_read(path, &f->bytes, &f->size, NULL) != PEL_OK) {
        pel_free(f);
        return NULL;
    }
    f->calls = (struct aiFile){.ReadProc = read_from,
                               .WriteProc = write_nothing,
                               .TellProc = tell_place,
                               .FileSizeProc = tell_size,
                               .SeekProc = seek_place,
                               .FlushProc = flush_nothing,
                               .UserData = (char *)(void *)f};
    return &f->calls;
}

static void close_named(struct aiFileIO *io, struct aiFile *file)
{
    open_file *f = (open_file *)(void *)file->UserData;
    (void)io;
    pel_free(f->bytes);
    pel_free(f);
}

/* ---- the process ---- */

static void limit(int resource, uint64_t most)
{
    struct rlimit now;
    if (getrlimit((__rlimit_resource_t)resource, &now) != 0)
        return;
    if (now.rlim_max != RLIM_INFINITY && now.rlim_max < most)
        most = now.rlim_max;
    now.rlim_cur = now.rlim_max = most;
    setrlimit((__rlimit_resource_t)resource, &now);
}

/* it reserves more addresses than the limit of memory permits */
#if defined(__SANITIZE_ADDRESS__)
#define HAS_ADDRESS_SANITIZER
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define HAS_ADDRESS_SANITIZER
#endif
#endif

static void set_limits(const char *path)
{
    struct stat information = {0};
    closefrom(3);
    limit(RLIMIT_CORE, 0);
    limit(RLIMIT_FSIZE, 0);
    limit(RLIMIT_NOFILE, 16);
    limit(RLIMIT_CPU, PEL_CHILD_CPU_SECONDS);
    if (stat(path, &information) != 0)
        information.st_size = 0;
#ifndef HAS_ADDRESS_SANITIZER
    limit(RLIMIT_AS, PEL_CHILD_MEMORY(information.st_size));
#endif
}

/* notes, each with its zero */
typedef struct note_list {
    void *text;
    size_t length, capacity;
} note_list;

static void add_text(void *user, const char *text)
{
    note_list *notes = user;
    const size_t size = strlen(text) + 1;
    if (notes->length > 100000 || !pel_reserve(&notes->text, &notes->capacity, notes->length + size, 1))
        return;
    memcpy((char *)notes->text + notes->length, text, size);
    notes->length += size;
}

static bool put(pel_status status, note_list *notes, const pel_mesh *mesh)
{
    pel_child_head head = {.magic = "", .status = (int32_t)status};
    memcpy(head.magic, PEL_CHILD_MAGIC, sizeof head.magic);
    add_text(notes, "");
    if (notes->length == 0)
        return false;
    head.text_length = (int32_t)notes->length;
    head.vertex_count = mesh != NULL ? mesh->vertex_count : 0;
    head.triangle_count = mesh != NULL ? mesh->triangle_count : 0;
    bool written = fwrite(&head, sizeof head, 1, stdout) == 1 && fwrite(notes->text, notes->length, 1, stdout) == 1;
    if (mesh != NULL)
        written = written &&
                  fwrite(mesh->positions, sizeof *mesh->positions, (size_t)mesh->vertex_count, stdout) ==
                      (size_t)mesh->vertex_count &&
                  fwrite(mesh->triangles, sizeof *mesh->triangles, (size_t)mesh->triangle_count, stdout) ==
                      (size_t)mesh->triangle_count;
    return fflush(stdout) == 0 && written;
}

int pel_mesh_import_child(const char *path)
{
    note_list notes = {0};
    const pel_log log = {add_text, &notes};
    pel_error error = {0};
    pel_mesh *mesh = NULL;
    if (path == NULL || !pel_foreign_is(path))
        return 1;
    char *named = pel_copy_string(path);
    if (named == NULL)
        return 1;
    set_limits(path);
    struct aiFileIO io = {.OpenProc = open_named, .CloseProc = close_named, .UserData = named};
    importer state = {.path = path, .scene = aiImportFileEx(path, 0, &io)};
    pel_polygon_soup_init(&state.builder, 0);
    pel_status status = import_scene(&state, &log, &mesh, &error);
    if (status != PEL_OK) {
        pel_mesh_destroy(mesh);
        mesh = NULL;
        notes.length = 0;
        add_text(&notes, error.what);
        add_text(&notes, error.remedy);
    }
    const bool written = put(status, &notes, mesh);
    pel_mesh_destroy(mesh);
    pel_free(notes.text);
    pel_free(state.stack);
    pel_polygon_soup_free(&state.builder);
    aiReleaseImport(state.scene);
    pel_free(named);
    return written ? 0 : 1;
}

#else
#include "pellicle/import.h"

int pel_mesh_import_child(const char *path)
{
    (void)path;
    return 1;
}
#endif
