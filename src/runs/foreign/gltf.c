#include "foreign/gltf.h"

#include "base/memory.h"
#include "base/room.h"
#include "io/file.h"
#include "io/polygon_soup.h"
#include "mesh/seam.h"
#include "sequence/sequence.h"

#include <math.h>
#include <string.h>

static const char *const again = "export the file again, or as PLY or OBJ";

/* a primitive of a mesh of the scene */
typedef struct primitive {
    const pel_json_node *node;
    int32_t owner; /* its node; -1 = without a scene */
    int32_t skin;  /* of the reader; -1 = none */
    int64_t mode;
    double *rest, *indices; /* (count x 3), (corner_count) or null: 0, 1, 2, ... */
    size_t count, corner_count;
    double **moves;  /* (target_count) of (count x 3); null where a target moves nothing */
    double *weights; /* (target_count) of the file */
    int32_t target_count;
    pel_gltf_influences influences;
    double *positions;  /* (count x 3) in the world */
    int32_t *number_of; /* (count) number + 1 in the soup; 0 = not taken */
} primitive;

typedef struct gltf_reader {
    pel_gltf g;
    pel_gltf_nodes nodes;
    pel_gltf_skin *skins;  /* (counts of skins) those that are used are read */
    primitive *primitives; /* (primitive_count) of triangles */
    size_t primitive_count, primitive_capacity;
    pel_polygon_soup soup;
    size_t mesh_count;  /* meshes taken, those used several times counted each time */
    size_t other_count; /* primitives of points and lines */
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

/* ---- reading primitives ---- */

static pel_status read_target(gltf_reader *reader, const primitive *p, const pel_json_node *target, double **moves,
                              pel_error *error)
{
    const pel_json_node *accessor;
    size_t count = p->count;
    pel_status status = pel_gltf_named(&reader->g, target, "POSITION", PEL_GLTF_ACCESSORS, &accessor, error);
    if (status == PEL_OK && accessor != NULL)
        status = pel_gltf_numbers(&reader->g, accessor, 3, moves, &count, error);
    if (status == PEL_OK && count != p->count)
        return pel_gltf_fail(&reader->g, target, error, again, "a target moves %zu vertices of %zu", count, p->count);
    return status;
}

/* the targets, and their weights by the node or the mesh */
static pel_status read_targets(gltf_reader *reader, primitive *p, const pel_json_node *weights, pel_error *error)
{
    const pel_json_tree *tree = &reader->g.tree;
    const pel_json_node *targets = pel_json_member(tree, p->node, "targets");
    const pel_json_node *weight = pel_json_first(tree, weights);
    const int32_t count = targets != NULL ? targets->count : 0;
    pel_status status = PEL_OK;
    if (!PEL_ALLOCATE_ALL(PEL_ROOM(p->moves, count), PEL_ROOM(p->weights, count)))
        return pel_fail_memory(error);
    for (const pel_json_node *at = pel_json_first(tree, targets); at != NULL && status == PEL_OK;
         at = pel_json_after(tree, at), p->target_count++) {
        status = read_target(reader, p, at, &p->moves[p->target_count], error);
        if (status == PEL_OK && weight != NULL && (weight->kind != PEL_JSON_IS_NUMBER || !isfinite(weight->number)))
            return pel_gltf_fail(&reader->g, weight, error, again, "a weight of a target is no number");
        p->weights[p->target_count] = weight != NULL ? weight->number : 0;
        weight = weight != NULL ? pel_json_after(tree, weight) : NULL;
    }
    return status;
}

static pel_status read_skin(gltf_reader *reader, primitive *p, const pel_json_node *attributes, pel_error *error)
{
    if (p->skin < 0)
        return PEL_OK;
    pel_status status = pel_gltf_influences_read(&reader->g, attributes, p->count, reader->skins[p->skin].joint_count,
                                                 &p->influences, error);
    /* without bones its vertices stand where the node stands */
    if (p->influences.sets == 0)
        p->skin = -1;
    return status;
}

static pel_status read_primitive(gltf_reader *reader, primitive *p, const pel_json_node *weights, pel_error *error)
{
    pel_gltf *g = &reader->g;
    const pel_json_node *attributes = pel_json_member(&g->tree, p->node, "attributes"), *positions, *indices;
    pel_status status = pel_gltf_named(g, attributes, "POSITION", PEL_GLTF_ACCESSORS, &positions, error);
    if (status == PEL_OK)
        status = pel_gltf_named(g, p->node, "indices", PEL_GLTF_ACCESSORS, &indices, error);
    /* without positions a primitive is not drawn */
    if (status != PEL_OK || positions == NULL) {
        p->skin = -1;
        return status;
    }
    status = pel_gltf_numbers(g, positions, 3, &p->rest, &p->count, error);
    p->corner_count = p->count;
    if (status == PEL_OK && indices != NULL)
        status = pel_gltf_indices(g, indices, &p->indices, &p->corner_count, error);
    if (status == PEL_OK)
        status = read_targets(reader, p, weights, error);
    if (status == PEL_OK)
        status = read_skin(reader, p, attributes, error);
    if (status == PEL_OK && !PEL_ALLOCATE_ALL(PEL_ROOM(p->positions, 3 * p->count), PEL_ROOM(p->number_of, p->count)))
        status = pel_fail_memory(error);
    return status;
}

static pel_status add_primitive(gltf_reader *reader, const pel_json_node *node, const pel_json_node *weights,
                                int32_t owner, int32_t skin, pel_error *error)
{
    int64_t mode;
    pel_status status = pel_gltf_integer(&reader->g, node, "mode", TRIANGLES, 0, FAN, &mode, error);
    if (status == PEL_OK && mode < TRIANGLES)
        reader->other_count++;
    if (status != PEL_OK || mode < TRIANGLES)
        return status;
    if (!pel_reserve((void **)&reader->primitives, &reader->primitive_capacity, reader->primitive_count + 1,
                     sizeof *reader->primitives))
        return pel_fail_memory(error);
    primitive *p = &reader->primitives[reader->primitive_count++];
    *p = (primitive){.node = node, .owner = owner, .skin = skin, .mode = mode};
    return read_primitive(reader, p, weights, error);
}

static void free_primitive(primitive *p)
{
    for (int32_t t = 0; t < p->target_count; t++)
        pel_free(p->moves[t]);
    pel_gltf_influences_free(&p->influences);
    PEL_FREE_ALL(p->rest, p->indices, p->moves, p->weights, p->positions, p->number_of);
}

/* ---- poses ---- */

/* the shape by targets, then the place by bones or the node */
static pel_status pose_vertex(const gltf_reader *reader, const primitive *p, size_t v, pel_error *error)
{
    const pel_gltf_node *node = p->owner >= 0 ? &reader->nodes.nodes[p->owner] : NULL;
    const bool is_animated = node != NULL && node->weights != NULL;
    const double *weights = is_animated ? node->weights : p->weights;
    const int32_t weight_count = is_animated ? node->weight_count : p->target_count;
    double x[3] = {p->rest[3 * v], p->rest[3 * v + 1], p->rest[3 * v + 2]}, *placed = p->positions + 3 * v;
    for (int32_t t = 0; t < p->target_count && t < weight_count; t++)
        for (int k = 0; k < 3 && p->moves[t] != NULL; k++)
            x[k] += weights[t] * p->moves[t][3 * v + (size_t)k];
    if (p->skin >= 0)
        pel_gltf_skin_point(&reader->skins[p->skin], &p->influences, p->count, v, x, placed);
    else if (node != NULL)
        pel_place_point(&node->world, x, placed);
    else
        memcpy(placed, x, sizeof x);
    if (isfinite(placed[0]) && isfinite(placed[1]) && isfinite(placed[2]))
        return PEL_OK;
    return pel_gltf_fail(&reader->g, p->node, error, "repair the mesh in the program that wrote it",
                         "a coordinate is not finite");
}

/* all vertices where the nodes have them now */
static pel_status pose_all(gltf_reader *reader, pel_error *error)
{
    pel_status status = pel_gltf_nodes_place(&reader->g, &reader->nodes, error);
    for (int32_t s = 0; s < reader->g.counts[PEL_GLTF_SKINS]; s++)
        pel_gltf_skin_pose(&reader->skins[s], &reader->nodes);
    for (size_t i = 0; i < reader->primitive_count; i++)
        for (size_t v = 0; v < reader->primitives[i].count && status == PEL_OK; v++)
            status = pose_vertex(reader, &reader->primitives[i], v, error);
    return status;
}

static bool mirrors(const gltf_reader *reader, const primitive *p)
{
    if (p->skin >= 0)
        return pel_place_mirrors(&reader->skins[p->skin].bones[(size_t)p->influences.joints[0]]);
    return p->owner >= 0 && pel_place_mirrors(&reader->nodes.nodes[p->owner].world);
}

/* ---- meshes ---- */

static pel_status add_mesh(gltf_reader *reader, const pel_json_node *mesh, int32_t owner, pel_error *error)
{
    pel_gltf *g = &reader->g;
    const pel_json_node *node = owner >= 0 ? reader->nodes.nodes[owner].node : NULL, *skin = NULL;
    const pel_json_node *weights = pel_json_member(&g->tree, node, "weights");
    int64_t number = -1;
    if (weights == NULL)
        weights = pel_json_member(&g->tree, mesh, "weights");
    reader->mesh_count++;
    pel_status status = pel_gltf_work(g, mesh, 1, error);
    if (status == PEL_OK)
        status = pel_gltf_named(g, node, "skin", PEL_GLTF_SKINS, &skin, error);
    if (status == PEL_OK && skin != NULL) {
        status = pel_gltf_integer(g, node, "skin", -1, 0, g->counts[PEL_GLTF_SKINS], &number, error);
        if (status == PEL_OK && reader->skins[number].joint_count == 0)
            status = pel_gltf_skin_read(g, &reader->nodes, skin, &reader->skins[number], error);
    }
    for (const pel_json_node *at = pel_json_first(&g->tree, pel_json_member(&g->tree, mesh, "primitives"));
         at != NULL && status == PEL_OK; at = pel_json_after(&g->tree, at))
        status = add_primitive(reader, at, weights, owner, (int32_t)number, error);
    return status;
}

/* those of the scene in the order of its tree; without scenes every mesh, where it is */
static pel_status add_meshes(gltf_reader *reader, pel_error *error)
{
    pel_gltf *g = &reader->g;
    pel_status status = PEL_OK;
    for (int32_t i = 0; i < reader->nodes.order_count && status == PEL_OK; i++) {
        const int32_t n = reader->nodes.order[i];
        const pel_json_node *mesh;
        status = pel_gltf_named(g, reader->nodes.nodes[n].node, "mesh", PEL_GLTF_MESHES, &mesh, error);
        if (status == PEL_OK && mesh != NULL)
            status = add_mesh(reader, mesh, n, error);
    }
    for (int32_t m = 0; m < g->counts[PEL_GLTF_MESHES] && !reader->nodes.has_scene && status == PEL_OK; m++)
        status = add_mesh(reader, g->lists[PEL_GLTF_MESHES][m], -1, error);
    return status;
}

/* ---- the whole ---- */

static void log_counts(const gltf_reader *reader, const pel_log *log)
{
    if (reader->mesh_count > 1)
        pel_log_line(log, "%zu meshes of the scene joined", reader->mesh_count);
    if (reader->other_count > 0)
        pel_log_line(log, "%zu sets of points or lines ignored", reader->other_count);
}

/* the mesh where the nodes stand in the file; new_number_of as of pel_seams_weld */
static pel_status read_mesh(gltf_reader *reader, const pel_log *log, pel_mesh **mesh, int32_t **new_number_of,
                            pel_error *error)
{
    const pel_text_cursor nowhere = {.name = reader->g.path, .begin = "", .at = "", .end = ""};
    pel_status status = pel_gltf_open(&reader->g, error);
    if (status == PEL_OK)
        status = pel_gltf_nodes_read(&reader->g, &reader->nodes, error);
    reader->skins = pel_allocate((size_t)reader->g.counts[PEL_GLTF_SKINS], sizeof *reader->skins);
    if (status == PEL_OK && reader->skins == NULL)
        status = pel_fail_memory(error);
    if (status == PEL_OK)
        status = add_meshes(reader, error);
    if (status == PEL_OK)
        status = pose_all(reader, error);
    for (size_t i = 0; i < reader->primitive_count && status == PEL_OK; i++)
        status = add_triangles(reader, &reader->primitives[i], mirrors(reader, &reader->primitives[i]), error);
    if (status != PEL_OK)
        return status;
    log_counts(reader, log);
    status = pel_polygon_soup_finish(&reader->soup, &nowhere, log, mesh, error);
    return status == PEL_OK ? pel_seams_weld(*mesh, new_number_of, log, error) : status;
}

/* `copy` receives the places of the mesh's vertices; new_number_of null: none were welded */
static void copy_positions(const gltf_reader *reader, const int32_t *new_number_of, double (*copy)[3])
{
    for (size_t i = 0; i < reader->primitive_count; i++) {
        const primitive *p = &reader->primitives[i];
        for (size_t v = 0; v < p->count; v++) {
            const int32_t number = p->number_of != NULL ? p->number_of[v] - 1 : -1;
            if (number >= 0)
                memcpy(copy[new_number_of != NULL ? new_number_of[number] : number], p->positions + 3 * v,
                       sizeof *copy);
        }
    }
}

/* of all frames together: places of the mesh (1.5 GB); vertices of the file, nodes and channels, which take time */
#define MOST_PLACES 64e6
#define MOST_WORK 256e6

static pel_status count_frames(const gltf_reader *reader, const pel_gltf_animation *animation, double fps,
                               int32_t vertex_count, int32_t *count, pel_error *error)
{
    const double duration = animation->duration, whole = floor(duration * fps * (1 + 1e-9));
    const double rest = duration * fps - whole;
    double work = (double)reader->nodes.order_count + (double)animation->channel_count;
    for (size_t i = 0; i < reader->primitive_count; i++)
        work += (double)reader->primitives[i].count;
    if (!((whole + 2) * vertex_count < MOST_PLACES && (whole + 2) * work < MOST_WORK))
        return pel_gltf_fail(&reader->g, NULL, error, "use fewer frames per second, or a shorter animation",
                             "the animation of %g s at %g frames per second has more than %g places of vertices",
                             duration, fps, MOST_PLACES);
    *count = (int32_t)whole + 1 + (rest > 1e-6);
    return PEL_OK;
}

static pel_status pose_frames(gltf_reader *reader, pel_gltf_animation *animation, double fps,
                              const int32_t *new_number_of, int32_t vertex_count, pel_sequence **sequence,
                              pel_error *error)
{
    int32_t count = 0;
    pel_status status = count_frames(reader, animation, fps, vertex_count, &count, error);
    if (status == PEL_OK)
        status = pel_sequence_allocate(count, vertex_count, sequence, error);
    for (int32_t f = 0; f < count && status == PEL_OK; f++) {
        const double time = f / fps < animation->duration ? f / fps : animation->duration;
        (*sequence)->times[f] = time;
        pel_gltf_animation_pose(animation, time, &reader->nodes);
        status = pose_all(reader, error);
        copy_positions(reader, new_number_of, (*sequence)->positions + (size_t)f * (size_t)vertex_count);
    }
    if (status == PEL_OK)
        pel_sequence_finish(*sequence);
    return status;
}

static pel_status read_sequence(gltf_reader *reader, const char *name, double fps, pel_sequence **sequence,
                                pel_error *error)
{
    pel_gltf_animation animation = {0};
    pel_mesh *mesh = NULL;
    int32_t *new_number_of = NULL;
    pel_status status = read_mesh(reader, NULL, &mesh, &new_number_of, error);
    if (status == PEL_OK)
        status = pel_gltf_animation_read(&reader->g, &reader->nodes, name, &animation, error);
    if (status == PEL_OK)
        status = pose_frames(reader, &animation, fps, new_number_of, mesh->vertex_count, sequence, error);
    if (status != PEL_OK) {
        pel_sequence_destroy(*sequence);
        *sequence = NULL;
    }
    pel_gltf_animation_free(&animation);
    pel_mesh_destroy(mesh);
    pel_free(new_number_of);
    return status;
}

/* ---- files ---- */

/* the result that is asked for: a mesh, or a sequence where mesh is null */
typedef struct wanted {
    const pel_log *log;
    pel_mesh **mesh;
    const char *animation;
    double fps;
    pel_sequence **sequence;
} wanted;

static void free_reader(gltf_reader *reader)
{
    pel_polygon_soup_free(&reader->soup);
    for (size_t i = 0; i < reader->primitive_count; i++)
        free_primitive(&reader->primitives[i]);
    for (int32_t s = 0; reader->skins != NULL && s < reader->g.counts[PEL_GLTF_SKINS]; s++)
        pel_gltf_skin_free(&reader->skins[s]);
    PEL_FREE_ALL(reader->primitives, reader->skins);
    pel_gltf_nodes_free(&reader->nodes);
    pel_gltf_free(&reader->g);
}

static pel_status parse(const char *name, const void *bytes, size_t size, bool is_alone, const wanted *want,
                        pel_error *error)
{
    gltf_reader reader = {.g = {.path = name, .bytes = bytes, .size = size, .is_alone = is_alone}};
    pel_polygon_soup_init(&reader.soup, 0);
    pel_status status = want->mesh != NULL ? read_mesh(&reader, want->log, want->mesh, NULL, error)
                                           : read_sequence(&reader, want->animation, want->fps, want->sequence, error);
    if (status != PEL_OK && want->mesh != NULL) {
        pel_mesh_destroy(*want->mesh);
        *want->mesh = NULL;
    }
    free_reader(&reader);
    return status;
}

static pel_status read_file(const char *path, const wanted *want, pel_error *error)
{
    char *bytes;
    size_t size;
    pel_status status = pel_file_read(path, &bytes, &size, error);
    if (status == PEL_OK)
        status = parse(path, bytes, size, false, want, error);
    pel_free(bytes);
    return status;
}

pel_status pel_gltf_parse(const char *name, const void *bytes, size_t size, const pel_log *log, pel_mesh **mesh,
                          pel_error *error)
{
    *mesh = NULL;
    return parse(name, bytes, size, true, &(wanted){.log = log, .mesh = mesh}, error);
}

pel_status pel_gltf_read(const char *path, const pel_log *log, pel_mesh **mesh, pel_error *error)
{
    *mesh = NULL;
    return read_file(path, &(wanted){.log = log, .mesh = mesh}, error);
}

pel_status pel_gltf_parse_sequence(const char *name, const void *bytes, size_t size, const char *animation, double fps,
                                   pel_sequence **sequence, pel_error *error)
{
    *sequence = NULL;
    return parse(name, bytes, size, true, &(wanted){.animation = animation, .fps = fps, .sequence = sequence}, error);
}

pel_status pel_gltf_read_sequence(const char *path, const char *animation, double fps, pel_sequence **sequence,
                                  pel_error *error)
{
    *sequence = NULL;
    return read_file(path, &(wanted){.animation = animation, .fps = fps, .sequence = sequence}, error);
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
