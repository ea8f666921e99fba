#include "pellicle/import.h"

#include "base/status.h"
#include "pellicle/mesh_io.h"

#ifndef PELLICLE_ASSIMP

#include "foreign/gltf.h"

pel_status pel_mesh_import(const char *path, const pel_log *log, pel_mesh **mesh, pel_error *error)
{
    PEL_REFUSE_NULL(path, error);
    PEL_REFUSE_NULL(mesh, error);
    return pel_gltf_is(path) ? pel_gltf_read(path, log, mesh, error)
                             : pel_mesh_read(path, PEL_FORMAT_AUTO, log, mesh, error);
}

#else

#include "base/memory.h"
#include "foreign/gltf.h"
#include "io/file.h"
#include "io/polygon_soup.h"

#include <assimp/cimport.h>
#include <assimp/scene.h>

#include <math.h>
#include <string.h>

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
        status = pel_polygon_soup_weld(&state->builder, log, error);
    return status == PEL_OK ? pel_polygon_soup_finish(&state->builder, &nowhere, log, mesh, error) : status;
}

static bool is_foreign(const char *path)
{
    const char *dot = strrchr(path, '.');
    return dot != NULL && pel_mesh_format_of_path(path) == PEL_FORMAT_AUTO && aiIsExtensionSupported(dot) == AI_TRUE;
}

pel_status pel_mesh_import(const char *path, const pel_log *log, pel_mesh **mesh, pel_error *error)
{
    PEL_REFUSE_NULL(path, error);
    PEL_REFUSE_NULL(mesh, error);
    *mesh = NULL;
    if (pel_gltf_is(path))
        return pel_gltf_read(path, log, mesh, error);
    if (!is_foreign(path))
        return pel_mesh_read(path, PEL_FORMAT_AUTO, log, mesh, error);
    pel_status status = pel_file_check(path, error);
    if (status != PEL_OK)
        return status;
    importer state = {.path = path, .scene = aiImportFile(path, 0)};
    pel_polygon_soup_init(&state.builder, 0);
    status = import_scene(&state, log, mesh, error);
    pel_free(state.stack);
    pel_polygon_soup_free(&state.builder);
    aiReleaseImport(state.scene);
    return status;
}

#endif
