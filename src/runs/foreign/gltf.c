#include "foreign/gltf.h"

#include "base/memory.h"
#include "base/room.h"
#include "io/file.h"
#include "io/polygon_soup.h"
#include "mesh/seam.h"

#include <math.h>
#include <string.h>

static const char *const again = "export the file again, or as PLY or OBJ";

/* a node of the scene with its place in the world: x -> linear x + shift */
typedef struct placed_node {
    const pel_json_node *node;
    double linear[3][3];
    double shift[3];
} placed_node;

typedef struct gltf_reader {
    pel_gltf g;
    pel_polygon_soup soup;
    placed_node *stack; /* nodes still to visit */
    size_t stack_count, stack_capacity;
    bool *seen;         /* (nodes) */
    size_t mesh_count;  /* meshes taken, those used several times counted each time */
    size_t other_count; /* primitives of points and lines */
    size_t skin_count;  /* nodes whose mesh is deformed by bones */
} gltf_reader;

/* ---- triangles ---- */

enum { TRIANGLES = 4, STRIP, FAN };

/* corner i of triangle t; every second triangle of a strip is turned */
static size_t corner_of(int64_t mode, size_t t, size_t i)
{
    if (mode == TRIANGLES)
        return 3 * t + i;
    if (mode == FAN)
        return i == 0 ? 0 : t + i;
    return t % 2 == 1 && i > 0 ? t + 3 - i : t + i;
}

/* a primitive: its positions in the world, and the vertices of its corners */
typedef struct primitive {
    const pel_json_node *node;
    int64_t mode;
    double *positions, *indices; /* (count x 3), (corner_count) or null: 0, 1, 2, ... */
    size_t count, corner_count;
    int32_t *number_of; /* (count) number + 1 in the soup; 0 = not taken yet */
} primitive;

static pel_status take_corner(gltf_reader *reader, const primitive *p, size_t corner, int32_t *vertex, pel_error *error)
{
    const double index = p->indices != NULL ? p->indices[corner] : (double)corner;
    if (index >= (double)p->count)
        return pel_gltf_fail(&reader->g, p->node, error, again, "index %.0f of a mesh with %zu vertices", index,
                             p->count);
    const size_t v = (size_t)index;
    if (p->number_of[v] == 0) {
        if (reader->soup.vertex_count >= INT32_MAX || !pel_polygon_soup_add_vertex(&reader->soup, p->positions + 3 * v))
            return pel_fail_memory(error);
        p->number_of[v] = (int32_t)reader->soup.vertex_count;
    }
    *vertex = p->number_of[v] - 1;
    return PEL_OK;
}

/* two corners at one place */
static bool is_point_or_line(const gltf_reader *reader, const int32_t triangle[3])
{
    const double(*x)[3] = (const double(*)[3])reader->soup.positions;
    for (int i = 0; i < 3; i++) {
        const double *a = x[triangle[i]], *b = x[triangle[(i + 1) % 3]];
        if (a[0] == b[0] && a[1] == b[1] && a[2] == b[2])
            return true;
    }
    return false;
}

static pel_status add_triangles(gltf_reader *reader, const primitive *p, bool is_mirrored, pel_error *error)
{
    const size_t corners = p->corner_count;
    const size_t triangle_count = p->mode == TRIANGLES ? corners / 3 : corners > 2 ? corners - 2 : 0;
    for (size_t t = 0; t < triangle_count; t++) {
        int32_t triangle[3];
        for (size_t i = 0; i < 3; i++) {
            const size_t corner = corner_of(p->mode, t, is_mirrored ? 2 - i : i);
            pel_status status = take_corner(reader, p, corner, &triangle[i], error);
            if (status != PEL_OK)
                return status;
        }
        /* strips turn back over triangles without area */
        if (is_point_or_line(reader, triangle))
            reader->soup.dropped_count++;
        else if (!pel_polygon_soup_add_triangle(&reader->soup, triangle, NULL))
            return pel_fail_memory(error);
    }
    return PEL_OK;
}

/* ---- positions ---- */

/* adds a target's displacements, times its weight */
static pel_status add_target(gltf_reader *reader, const primitive *p, const pel_json_node *target, double weight,
                             pel_error *error)
{
    const pel_json_node *accessor;
    double *moves = NULL;
    size_t count;
    pel_status status = pel_gltf_named(&reader->g, target, "POSITION", PEL_GLTF_ACCESSORS, &accessor, error);
    if (status == PEL_OK && accessor != NULL && weight != 0)
        status = pel_gltf_numbers(&reader->g, accessor, 3, &moves, &count, error);
    if (status != PEL_OK || moves == NULL)
        return status;
    if (count != p->count)
        status = pel_gltf_fail(&reader->g, target, error, again, "a target moves %zu vertices of %zu", count, p->count);
    for (size_t i = 0; i < 3 * p->count && status == PEL_OK; i++)
        p->positions[i] += weight * moves[i];
    pel_free(moves);
    return status;
}

/* the shape that the default weights of node or mesh make */
static pel_status add_targets(gltf_reader *reader, const primitive *p, const pel_json_node *weights, pel_error *error)
{
    const pel_json_tree *tree = &reader->g.tree;
    const pel_json_node *target = pel_json_first(tree, pel_json_member(tree, p->node, "targets"));
    const pel_json_node *weight = pel_json_first(tree, weights);
    pel_status status = PEL_OK;
    while (target != NULL && weight != NULL && status == PEL_OK) {
        if (weight->kind != PEL_JSON_IS_NUMBER || !isfinite(weight->number))
            return pel_gltf_fail(&reader->g, weight, error, again, "a weight of a target is no number");
        status = add_target(reader, p, target, weight->number, error);
        target = pel_json_after(tree, target);
        weight = pel_json_after(tree, weight);
    }
    return status;
}

static pel_status place_positions(const gltf_reader *reader, const primitive *p, const placed_node *placed,
                                  pel_error *error)
{
    for (size_t v = 0; v < p->count; v++) {
        double *x = p->positions + 3 * v, local[3];
        memcpy(local, x, sizeof local);
        for (int i = 0; i < 3; i++) {
            x[i] = placed->shift[i];
            for (int k = 0; k < 3; k++)
                x[i] += placed->linear[i][k] * local[k];
            if (!isfinite(x[i]))
                return pel_gltf_fail(&reader->g, p->node, error, "repair the mesh in the program that wrote it",
                                     "a coordinate is not finite");
        }
    }
    return PEL_OK;
}

static pel_status read_primitive(gltf_reader *reader, primitive *p, const pel_json_node *weights,
                                 const placed_node *placed, pel_error *error)
{
    pel_gltf *g = &reader->g;
    const pel_json_node *positions, *indices;
    pel_status status = pel_gltf_named(g, pel_json_member(&g->tree, p->node, "attributes"), "POSITION",
                                       PEL_GLTF_ACCESSORS, &positions, error);
    if (status == PEL_OK)
        status = pel_gltf_named(g, p->node, "indices", PEL_GLTF_ACCESSORS, &indices, error);
    /* without positions a primitive is not drawn */
    if (status != PEL_OK || positions == NULL)
        return status;
    status = pel_gltf_numbers(g, positions, 3, &p->positions, &p->count, error);
    p->corner_count = p->count;
    if (status == PEL_OK && indices != NULL)
        status = pel_gltf_numbers(g, indices, 1, &p->indices, &p->corner_count, error);
    if (status == PEL_OK)
        status = add_targets(reader, p, weights, error);
    if (status == PEL_OK)
        status = place_positions(reader, p, placed, error);
    if (status == PEL_OK) {
        p->number_of = pel_allocate(p->count, sizeof *p->number_of);
        status = p->number_of != NULL ? PEL_OK : pel_fail_memory(error);
    }
    return status;
}

static bool mirrors(const placed_node *placed)
{
    const double(*m)[3] = placed->linear;
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
               m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]) <
           0;
}

static pel_status add_primitive(gltf_reader *reader, const pel_json_node *node, const pel_json_node *weights,
                                const placed_node *placed, pel_error *error)
{
    primitive p = {.node = node};
    pel_status status = pel_gltf_integer(&reader->g, node, "mode", TRIANGLES, 0, FAN, &p.mode, error);
    if (status == PEL_OK && p.mode < TRIANGLES) {
        reader->other_count++;
        return PEL_OK;
    }
    if (status == PEL_OK)
        status = read_primitive(reader, &p, weights, placed, error);
    if (status == PEL_OK && p.positions != NULL)
        status = add_triangles(reader, &p, mirrors(placed), error);
    PEL_FREE_ALL(p.positions, p.indices, p.number_of);
    return status;
}

/* ---- nodes ---- */

static pel_status add_mesh(gltf_reader *reader, const placed_node *placed, const pel_json_node *mesh, pel_error *error)
{
    const pel_json_tree *tree = &reader->g.tree;
    const pel_json_node *weights = pel_json_member(tree, placed->node, "weights");
    if (weights == NULL)
        weights = pel_json_member(tree, mesh, "weights");
    reader->mesh_count++;
    pel_status status = pel_gltf_work(&reader->g, mesh, 1, error);
    for (const pel_json_node *at = pel_json_first(tree, pel_json_member(tree, mesh, "primitives"));
         at != NULL && status == PEL_OK; at = pel_json_after(tree, at))
        status = add_primitive(reader, at, weights, placed, error);
    return status;
}

/* x -> R (s x) + t of a quaternion x, y, z, w of any length */
static bool place_by_parts(const double t[3], const double q[4], const double s[3], double local[3][4])
{
    const double length = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    if (!(length > 0))
        return false;
    const double x = q[0] / length, y = q[1] / length, z = q[2] / length, w = q[3] / length;
    const double r[3][3] = {{1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)},
                            {2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)},
                            {2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)}};
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++)
            local[i][k] = r[i][k] * s[k];
        local[i][3] = t[i];
    }
    return true;
}

/* a member with exactly `most` numbers, or as it is when there is none */
static pel_status read_vector(const gltf_reader *reader, const pel_json_node *node, const char *key, double *numbers,
                              int32_t most, bool *is_there, pel_error *error)
{
    int32_t count;
    const pel_json_node *list = pel_json_member(&reader->g.tree, node, key);
    *is_there = list != NULL;
    if (list == NULL)
        return PEL_OK;
    pel_status status = pel_gltf_list_numbers(&reader->g, list, numbers, most, &count, error);
    if (status == PEL_OK && count != most)
        return pel_gltf_fail(&reader->g, list, error, again, "'%s' of a node has not %d numbers", key, (int)most);
    return status;
}

static pel_status read_place(const gltf_reader *reader, const pel_json_node *node, double local[3][4], pel_error *error)
{
    double m[16], t[3] = {0}, q[4] = {0, 0, 0, 1}, s[3] = {1, 1, 1};
    bool has_matrix, has_part;
    pel_status status = read_vector(reader, node, "matrix", m, 16, &has_matrix, error);
    if (status == PEL_OK)
        status = read_vector(reader, node, "translation", t, 3, &has_part, error);
    if (status == PEL_OK)
        status = read_vector(reader, node, "rotation", q, 4, &has_part, error);
    if (status == PEL_OK)
        status = read_vector(reader, node, "scale", s, 3, &has_part, error);
    if (status != PEL_OK)
        return status;
    for (int i = 0; has_matrix && i < 3; i++)
        for (int k = 0; k < 4; k++)
            local[i][k] = m[4 * k + i];
    if (!has_matrix && !place_by_parts(t, q, s, local))
        return pel_gltf_fail(&reader->g, node, error, again, "the rotation of a node has no length");
    return PEL_OK;
}

static pel_status place_node(const gltf_reader *reader, const placed_node *parent, placed_node *placed,
                             pel_error *error)
{
    double local[3][4] = {{0}};
    pel_status status = read_place(reader, placed->node, local, error);
    for (int i = 0; i < 3 && status == PEL_OK; i++) {
        placed->shift[i] = parent->shift[i];
        for (int k = 0; k < 3; k++) {
            placed->shift[i] += parent->linear[i][k] * local[k][3];
            placed->linear[i][k] = 0;
            for (int j = 0; j < 3; j++)
                placed->linear[i][k] += parent->linear[i][j] * local[j][k];
        }
    }
    return status;
}

/* a child of the parent, or a root */
static pel_status push_node(gltf_reader *reader, const placed_node *parent, const pel_json_node *number,
                            pel_error *error)
{
    pel_gltf *g = &reader->g;
    const double index = number->kind == PEL_JSON_IS_NUMBER ? number->number : -1;
    if (!(index >= 0 && index < (double)g->counts[PEL_GLTF_NODES] && index == floor(index)))
        return pel_gltf_fail(g, number, error, again, "there is no such node");
    if (reader->seen[(size_t)index])
        return pel_gltf_fail(g, number, error, again, "node %.0f stands twice in the tree of nodes", index);
    reader->seen[(size_t)index] = true;
    void *stack = reader->stack;
    if (!pel_reserve(&stack, &reader->stack_capacity, reader->stack_count + 1, sizeof *reader->stack))
        return pel_fail_memory(error);
    reader->stack = stack;
    placed_node *placed = &reader->stack[reader->stack_count];
    placed->node = g->lists[PEL_GLTF_NODES][(size_t)index];
    pel_status status = place_node(reader, parent, placed, error);
    reader->stack_count += status == PEL_OK;
    return status;
}

static pel_status push_nodes(gltf_reader *reader, const placed_node *parent, const pel_json_node *list,
                             pel_error *error)
{
    const pel_json_tree *tree = &reader->g.tree;
    const size_t first = reader->stack_count;
    pel_status status = PEL_OK;
    for (const pel_json_node *at = pel_json_first(tree, list); at != NULL && status == PEL_OK;
         at = pel_json_after(tree, at))
        status = push_node(reader, parent, at, error);
    /* the first one is visited first */
    for (size_t i = first, k = reader->stack_count; status == PEL_OK && i + 1 < k; i++, k--) {
        const placed_node one = reader->stack[i];
        reader->stack[i] = reader->stack[k - 1];
        reader->stack[k - 1] = one;
    }
    return status;
}

/* the mesh of a node; then its children in their order */
static pel_status visit_node(gltf_reader *reader, const placed_node *placed, pel_error *error)
{
    pel_gltf *g = &reader->g;
    const pel_json_node *mesh, *extensions = pel_json_member(&g->tree, placed->node, "extensions");
    const pel_json_node *copies = pel_json_member(&g->tree, extensions, "EXT_mesh_gpu_instancing");
    if (copies != NULL)
        return pel_gltf_fail(g, copies, error, "export the copies as nodes",
                             "a node has copies by the extension EXT_mesh_gpu_instancing, which is not read");
    pel_status status = pel_gltf_named(g, placed->node, "mesh", PEL_GLTF_MESHES, &mesh, error);
    reader->skin_count += mesh != NULL && pel_json_member(&g->tree, placed->node, "skin") != NULL;
    if (status == PEL_OK && mesh != NULL)
        status = add_mesh(reader, placed, mesh, error);
    return status == PEL_OK ? push_nodes(reader, placed, pel_json_member(&g->tree, placed->node, "children"), error)
                            : status;
}

/* ---- the whole ---- */

/* without scenes: every mesh, where it is */
static pel_status visit_meshes(gltf_reader *reader, const placed_node *world, pel_error *error)
{
    pel_status status = PEL_OK;
    for (int32_t m = 0; m < reader->g.counts[PEL_GLTF_MESHES] && status == PEL_OK; m++)
        status = add_mesh(reader, world, reader->g.lists[PEL_GLTF_MESHES][m], error);
    return status;
}

static pel_status visit_scene(gltf_reader *reader, pel_error *error)
{
    pel_gltf *g = &reader->g;
    const placed_node world = {.linear = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    const pel_json_node *scene;
    pel_status status = pel_gltf_named(g, g->tree.nodes, "scene", PEL_GLTF_SCENES, &scene, error);
    if (status != PEL_OK)
        return status;
    if (scene == NULL && g->counts[PEL_GLTF_SCENES] > 0)
        scene = g->lists[PEL_GLTF_SCENES][0];
    if (scene == NULL)
        return visit_meshes(reader, &world, error);
    reader->seen = pel_allocate((size_t)g->counts[PEL_GLTF_NODES], sizeof *reader->seen);
    if (reader->seen == NULL)
        return pel_fail_memory(error);
    status = push_nodes(reader, &world, pel_json_member(&g->tree, scene, "nodes"), error);
    while (reader->stack_count > 0 && status == PEL_OK) {
        const placed_node placed = reader->stack[--reader->stack_count];
        status = visit_node(reader, &placed, error);
    }
    return status;
}

static void log_counts(const gltf_reader *reader, const pel_log *log)
{
    if (reader->mesh_count > 1)
        pel_log_line(log, "%zu meshes of the scene joined", reader->mesh_count);
    if (reader->other_count > 0)
        pel_log_line(log, "%zu sets of points or lines ignored", reader->other_count);
    if (reader->skin_count > 0)
        pel_log_line(log, "bones ignored: %zu meshes stand as they are without them", reader->skin_count);
}

static pel_status read_all(gltf_reader *reader, const pel_log *log, pel_mesh **mesh, pel_error *error)
{
    const pel_text_cursor nowhere = {.name = reader->g.path, .begin = "", .at = "", .end = ""};
    pel_status status = pel_gltf_open(&reader->g, error);
    if (status == PEL_OK)
        status = visit_scene(reader, error);
    if (status != PEL_OK)
        return status;
    log_counts(reader, log);
    status = pel_polygon_soup_finish(&reader->soup, &nowhere, log, mesh, error);
    return status == PEL_OK ? pel_seams_weld(*mesh, NULL, log, error) : status;
}

static pel_status parse(gltf_reader *reader, const char *name, const void *bytes, size_t size, const pel_log *log,
                        pel_mesh **mesh, pel_error *error)
{
    reader->g.path = name;
    reader->g.bytes = bytes;
    reader->g.size = size;
    pel_polygon_soup_init(&reader->soup, 0);
    pel_status status = read_all(reader, log, mesh, error);
    if (status != PEL_OK) {
        pel_mesh_destroy(*mesh);
        *mesh = NULL;
    }
    pel_polygon_soup_free(&reader->soup);
    PEL_FREE_ALL(reader->seen, reader->stack);
    pel_gltf_free(&reader->g);
    return status;
}

pel_status pel_gltf_parse(const char *name, const void *bytes, size_t size, const pel_log *log, pel_mesh **mesh,
                          pel_error *error)
{
    gltf_reader reader = {.g.is_alone = true};
    *mesh = NULL;
    return parse(&reader, name, bytes, size, log, mesh, error);
}

pel_status pel_gltf_read(const char *path, const pel_log *log, pel_mesh **mesh, pel_error *error)
{
    gltf_reader reader = {.seen = NULL};
    char *bytes;
    size_t size;
    *mesh = NULL;
    pel_status status = pel_file_read(path, &bytes, &size, error);
    if (status == PEL_OK)
        status = parse(&reader, path, bytes, size, log, mesh, error);
    pel_free(bytes);
    return status;
}

bool pel_gltf_is(const char *path)
{
    const char *dot = strrchr(path, '.');
    pel_text_cursor glb, gltf;
    if (dot == NULL)
        return false;
    glb = gltf = (pel_text_cursor){.at = dot + 1, .end = dot + strlen(dot)};
    return (pel_text_cursor_accept(&glb, "glb") && glb.at == glb.end) ||
           (pel_text_cursor_accept(&gltf, "gltf") && gltf.at == gltf.end);
}
